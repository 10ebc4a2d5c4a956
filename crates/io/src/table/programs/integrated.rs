//! Sentences of integrated receivers that are not NMEA's: GTIMU with GPFPD (Newton-M2 and its kin), GPCHC (CGI-410). Rates in deg/s, forces in g,
//! velocities east, north, up.

use super::{below, lines};

/// A sentence's name, and where its rates with forces and its position with the velocity begin; `None` of what it does not have. Week and second
/// are behind the name.
type Places = (&'static str, Option<usize>, Option<usize>);

const SENTENCES: [Places; 3] = [
    ("$GTIMU", Some(3), None),
    ("$GPFPD", None, Some(6)),
    ("$GPCHC", Some(6), Some(12)),
];
const HEADER: &str = "date,tow,gx_dps,gy_dps,gz_dps,ax_g,ay_g,az_g,lat,lon,alt,ve,vn,vu";

/// Numbers of each kind.
const SIX: usize = 6;

pub(super) fn is_there(start: &[u8]) -> bool {
    let row = |line: &str| {
        let name = line.split(',').next()?;
        SENTENCES.iter().find(|(known, ..)| *known == name)
    };
    let rows = Vec::from_iter(lines(start).take(200).filter_map(row));
    rows.len() > 2 && rows.iter().any(|(_, imu, _)| imu.is_some())
}

pub(super) fn table(text: &[u8]) -> Option<String> {
    let row = |line: &str| {
        let sentence = line.split('*').next()?;
        let fields = Vec::from_iter(sentence.split(','));
        let (_, imu, place) = SENTENCES
            .iter()
            .find(|(name, ..)| fields.first() == Some(name))?;
        let six = |from: &Option<usize>| match from {
            Some(from) => Some(fields.get(*from..from + SIX)?.join(",")),
            None => Some(",".repeat(SIX - 1)),
        };
        let (week, second) = (fields.get(1)?, fields.get(2)?);
        Some(format!("{week},{second},{},{}", six(imu)?, six(place)?))
    };
    below(HEADER, lines(text).filter_map(row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_and_positions_share_their_clock() {
        let imu = "$GTIMU,2168,370484.000,-0.1,0.2,-0.3,0.01,0.02,0.99,41.0*48\n";
        let text = imu.repeat(3)
            + "$GPFPD,2168,370484.000,353.4,0.4,0.1,28.1,112.9,36.0,0.1,-0.2,-0.4,0.9,11,10,04*4E\n"
            + "$GPCHC,2168,370485.00,353.4,0.4,0.1,1,2,3,4,5,6,28.1,112.9,36.0,7,8,9,10,11,12,42,1,4*4E\n";
        assert!(is_there(text.as_bytes()));
        let table = table(text.as_bytes()).unwrap();
        let rows = Vec::from_iter(table.lines());
        assert_eq!(
            rows[1],
            "2168,370484.000,-0.1,0.2,-0.3,0.01,0.02,0.99,,,,,,"
        );
        assert_eq!(
            rows[4],
            "2168,370484.000,,,,,,,28.1,112.9,36.0,0.1,-0.2,-0.4"
        );
        assert_eq!(rows[5], "2168,370485.00,1,2,3,4,5,6,28.1,112.9,36.0,7,8,9");
        assert!(!is_there(b"$GPGGA,1\n$GPRMC,2\n"));
    }
}
