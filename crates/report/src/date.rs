//! Dates in words.

use undrift_results::Drive;

/// An instant `yyyy-mm-ddThh:mm:ss.sssZ` as people read it.
pub fn utc(iso: &str) -> String {
    iso.replace('T', " ").replace('Z', " UTC")
}

/// Source of a date, by its name in results.
pub fn clock(name: &str) -> &str {
    match name {
        "gnss" => "from the GNSS receiver",
        "utc" => "from dates in UTC or Unix times",
        "host" => "from the clock of the recording device",
        "receipt" => "from the clock of the recording device at receipt",
        "no-zone" => "local or UTC: no time zone in the file, read as UTC",
        "stated" => "from the drive file",
        other => other,
    }
}

/// A time of a drive \[s\] as a date, with its source, or that the logs hold no date. `None` for data without a drive file.
pub fn of_drive(drive: &Drive, time: f64) -> Option<String> {
    if drive.file.is_none() || !time.is_finite() {
        return None;
    }
    let start = drive.start.as_ref();
    let dated = start.and_then(|start| Some((start.at(time)?, clock(&start.clock))));
    Some(dated.map_or_else(
        || "no date in the logs: times are those of their own clock".into(),
        |(iso, clock)| format!("{} ({clock})", utc(&iso)),
    ))
}

/// A time of a drive \[s\] as UTC to a second, if its date is known.
pub fn of_axis(drive: &Drive, time: f64) -> Option<String> {
    let iso = drive.start.as_ref()?.at(time)?;
    Some(utc(&format!("{}Z", iso.get(..19)?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_results::Start;

    #[test]
    fn a_date_names_its_clock() {
        for (name, words) in [
            ("gnss", "from the GNSS receiver"),
            ("utc", "from dates in UTC or Unix times"),
            ("host", "from the clock of the recording device"),
            (
                "receipt",
                "from the clock of the recording device at receipt",
            ),
            (
                "no-zone",
                "local or UTC: no time zone in the file, read as UTC",
            ),
            ("stated", "from the drive file"),
            ("new", "new"),
        ] {
            assert_eq!(clock(name), words);
        }
    }

    #[test]
    fn a_drive_with_a_file_has_a_date_or_says_that_it_has_none() {
        let mut drive = Drive {
            start: Some(Start {
                time_s: 10.0.into(),
                utc: String::new(),
                unix_s: 1e9.into(),
                clock: "utc".into(),
            }),
            ..Drive::default()
        };
        assert_eq!(of_drive(&drive, 11.0), None);
        drive.file = Some("drive.toml".into());
        assert_eq!(
            of_drive(&drive, 11.25).as_deref(),
            Some("2001-09-09 01:46:41.250 UTC (from dates in UTC or Unix times)")
        );
        assert_eq!(of_drive(&drive, f64::NAN), None);
        assert_eq!(
            of_axis(&drive, 11.25).as_deref(),
            Some("2001-09-09 01:46:41 UTC")
        );
        drive.start = None;
        assert_eq!(
            of_drive(&drive, 11.0).as_deref(),
            Some("no date in the logs: times are those of their own clock")
        );
        assert_eq!(of_axis(&drive, 11.0), None);
    }
}
