//! Reference trajectories from delimited text, or from logs that say themselves what they hold.

use std::sync::Arc;

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::TruthSample;

use crate::ReadError;
use crate::entry::{Entry, Wanted, What};
use crate::epoch::{Epoch, Weeks};
use crate::fix::{VelocityAxes, on_earth};
use crate::format::Format;
use crate::opened::Memory;
use crate::reader::{Kind, Plan, Reader, Row, TableRow, Want};
use crate::skipped::{SkipKind, Skipped};
use crate::table::{Column, TableOptions, check_time_scale, three};

/// Where the columns of a reference trajectory are and what they mean.
#[derive(Clone, Debug)]
pub struct TruthFormat {
    /// Time column.
    pub time: Column,
    /// Column of dates, where that of times has times of day.
    pub date: Option<Column>,
    /// Factor from the time column to seconds.
    pub time_scale: f64,
    /// Added to the time after scaling \[s\].
    pub time_offset: f64,
    /// GPS week, where the time is the second of it: times count on from the week of the first row.
    pub week: Option<Column>,
    /// Latitude, longitude, and height above the ellipsoid \[m\]; or Earth-centred, Earth-fixed x, y, z \[m\].
    pub position: [Column; 3],
    /// It is Earth-centred, Earth-fixed.
    pub ecef: bool,
    /// Factor from the columns of latitude and longitude to radians.
    pub angle_scale: f64,
    /// Velocity [m/s].
    pub velocity: Option<[Column; 3]>,
    /// Its axes.
    pub velocity_axes: VelocityAxes,
    /// Roll, pitch, yaw.
    pub attitude: Option<[Column; 3]>,
    /// Factor from the columns of the attitude to radians.
    pub attitude_scale: f64,
    /// The byte between fields; `None` finds out.
    pub delimiter: Option<u8>,
    /// First and last time \[s\] to give out, after the offset.
    pub span: Option<(f64, f64)>,
}

impl TruthFormat {
    /// Time in seconds, angles in degrees, position only.
    pub fn degrees(time: Column, position: [Column; 3]) -> Self {
        let radians = 1f64.to_radians();
        Self {
            time,
            date: None,
            time_scale: 1.0,
            time_offset: 0.0,
            week: None,
            position,
            ecef: false,
            angle_scale: radians,
            velocity: None,
            velocity_axes: VelocityAxes::Down,
            attitude: None,
            attitude_scale: radians,
            delimiter: None,
            span: None,
        }
    }
}

/// Which reference solution of a log.
#[derive(Clone, Debug)]
pub struct TruthLog {
    /// Format of the file.
    pub format: Format,
    /// Its stream; `None` for the only one.
    pub stream: Option<String>,
    /// Added to the times \[s\].
    pub time_offset: f64,
    /// First and last time \[s\] to give out, after the offset.
    pub span: Option<(f64, f64)>,
}

/// Layout of a reference.
#[derive(Clone, Debug)]
pub enum TruthSource {
    /// Delimited text, Parquet or columns in memory.
    Table(Box<TruthFormat>),
    /// Log that says itself what it holds.
    Log(TruthLog),
    /// Samples in memory, [`Memory::Truth`].
    Samples {
        /// Added to their times \[s\].
        time_offset: f64,
    },
}

impl TruthSource {
    /// What is added to the file's times \[s\].
    pub fn time_offset(&mut self) -> &mut f64 {
        match self {
            Self::Table(format) => &mut format.time_offset,
            Self::Log(log) => &mut log.time_offset,
            Self::Samples { time_offset } => time_offset,
        }
    }
}

impl From<TruthFormat> for TruthSource {
    fn from(format: TruthFormat) -> Self {
        Self::Table(Box::new(format))
    }
}

impl From<TruthLog> for TruthSource {
    fn from(log: TruthLog) -> Self {
        Self::Log(log)
    }
}

/// Reads reference samples.
pub type TruthReader = Reader<Truth>;

/// Reference samples as a kind of record.
pub struct Truth {
    source: TruthSource,
    weeks: Weeks,
}

impl Kind for Truth {
    type Options = TruthSource;
    type Values = TruthSample;
    type Record = TruthSample;
    const PATIENCE: u32 = 100;

    fn plan(options: &TruthSource) -> Result<Plan<Self>, ReadError> {
        let (source, span) = match options {
            TruthSource::Log(log) => {
                let wanted = Wanted::Poses(log.stream.clone());
                (Want::Log(log.format, wanted), log.span)
            }
            TruthSource::Table(format) => (Want::Table(format.columns()?), format.span),
            TruthSource::Samples { .. } => (Want::Records, None),
        };
        let kind = Self {
            source: options.clone(),
            weeks: Weeks::default(),
        };
        Ok(Plan { kind, source, span })
    }

    fn of_row(&mut self, row: TableRow, skipped: &mut Skipped) -> Option<(f64, TruthSample)> {
        let TruthSource::Table(format) = &self.source else {
            return None;
        };
        let week = format.week.as_ref().and(row.numbers.last().copied());
        let weeks = self.weeks.since_first(week);
        placed(format.sample(row.numbers, weeks), row.line, skipped)
    }

    fn of_entry(&mut self, entry: Entry, skipped: &mut Skipped) -> Option<(f64, TruthSample)> {
        let (What::Pose(mut pose), TruthSource::Log(log)) = (entry.what, &self.source) else {
            return None;
        };
        pose.time += log.time_offset;
        placed(pose, entry.at, skipped)
    }

    fn held(memory: &Memory) -> Option<Arc<[TruthSample]>> {
        match memory {
            Memory::Truth(samples) => Some(samples.clone()),
            _ => None,
        }
    }

    fn of_record(
        &mut self,
        sample: &TruthSample,
        number: u64,
        skipped: &mut Skipped,
    ) -> Option<(f64, TruthSample)> {
        let TruthSource::Samples { time_offset } = self.source else {
            return None;
        };
        let vectors = sample.v_n.iter().chain(&sample.rpy).flatten();
        let mut numbers = [sample.time].into_iter().chain(vectors.copied());
        if let Some(bad) = numbers.find(|value| !value.is_finite()) {
            skipped.add(SkipKind::NotFinite, number, bad);
            return None;
        }
        let sample = TruthSample {
            time: sample.time + time_offset,
            ..*sample
        };
        placed(sample, number, skipped)
    }

    fn record(
        &mut self,
        row: &Row<TruthSample>,
        _: &mut Skipped,
    ) -> Result<Option<TruthSample>, ReadError> {
        Ok(Some(row.values))
    }

    fn epoch(&self) -> Option<Epoch> {
        self.weeks.epoch()
    }

    fn nothing(&self, _: &Skipped) -> ReadError {
        ReadError::nameless("no usable sample")
    }
}

/// A sample whose place can be one; counted where not.
fn placed(sample: TruthSample, line: u64, skipped: &mut Skipped) -> Option<(f64, TruthSample)> {
    match on_earth(sample.position) {
        Ok(_) => Some((sample.time, sample)),
        Err((kind, detail)) => {
            skipped.add(kind, line, detail);
            None
        }
    }
}

impl TruthFormat {
    /// Time, position, then velocity, attitude and week where asked for.
    fn columns(&self) -> Result<TableOptions, ReadError> {
        check_time_scale(self.time_scale, "truth.time")?;
        let mut wanted = TableOptions::finite(self.delimiter);
        wanted.want_time("truth", &self.time, self.date.as_ref(), self.time_scale);
        let key = if self.ecef {
            "truth.ecef"
        } else {
            "truth.position"
        };
        let place = wanted.want(key, &self.position);
        if !self.ecef {
            wanted.want_angles(place, self.angle_scale, false);
        }
        wanted.want("truth.velocity", self.velocity.iter().flatten());
        wanted.want("truth.attitude", self.attitude.iter().flatten());
        wanted.want("truth.week", &self.week);
        Ok(wanted)
    }

    /// The sample of a row, `weeks` \[s\] after the week of the first.
    fn sample(&self, row: &[f64], weeks: f64) -> TruthSample {
        let position = three(row, 1);
        let position = match self.ecef {
            true => Geodetic::from_ecef(&position),
            false => Geodetic {
                lat: position.x * self.angle_scale,
                lon: position.y * self.angle_scale,
                height: position.z,
            },
        };
        let turn = self
            .velocity_axes
            .to_ned(Some(position))
            .unwrap_or_default();
        let v_n = self.velocity.as_ref().map(|_| three(row, 4));
        let attitude_at = if v_n.is_some() { 7 } else { 4 };
        let attitude = self.attitude.as_ref().map(|_| three(row, attitude_at));
        TruthSample {
            time: three(row, 0).x * self.time_scale + weeks + self.time_offset,
            position,
            v_n: v_n.map(|v_n| turn * v_n),
            rpy: attitude.map(|rpy| rpy * self.attitude_scale),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Opened;
    use crate::skipped::SkipKind;
    use std::io::Cursor;
    use std::path::Path;
    use undrift_nav::Vector3;

    fn group(from: usize) -> [Column; 3] {
        [0, 1, 2].map(|k| Column::Number(from + k))
    }

    fn all(text: &str, format: &TruthFormat) -> (Vec<TruthSample>, Skipped) {
        let source = Box::new(Cursor::new(text.as_bytes().to_vec()));
        let opened = Opened::stream(Path::new("truth.csv"), source).unwrap();
        let mut reader = TruthReader::new(opened, &format.clone().into()).unwrap();
        let samples = reader.by_ref().map(Result::unwrap).collect();
        (samples, reader.skipped().clone())
    }

    #[test]
    fn optional_groups_and_units() {
        let position_only = TruthFormat::degrees(Column::Number(1), group(2));
        let text = "1,45,90,7,1,2,3,10,20,180\n2,0,0,0,1,2,3,0,0,0\n2,46,90,7,1,2,3,10,20,180\n";
        let (samples, skipped) = all(text, &position_only);
        assert_eq!((samples.len(), skipped.count(SkipKind::OutOfRange)), (2, 1));
        assert_eq!(samples[0].position, Geodetic::from_degrees(45.0, 90.0, 7.0));
        assert_eq!((samples[0].v_n, samples[0].rpy), (None, None));
        let full = TruthFormat {
            velocity: Some(group(5)),
            velocity_axes: VelocityAxes::Up,
            attitude: Some(group(8)),
            time_offset: 10.0,
            ..position_only.clone()
        };
        let (samples, _) = all(text, &full);
        assert_eq!(samples[1].time, 12.0);
        assert_eq!(samples[1].v_n, Some(Vector3::new(1.0, 2.0, -3.0)));
        let rpy = samples[1].rpy.unwrap();
        // One rounding of the factor π/180 and one of the product.
        assert!((rpy.z - std::f64::consts::PI).abs() < 1e-15 * 4.0);
        // On the equator at 90° east, where x, y, z are west, up, north.
        let earth_fixed = TruthFormat {
            ecef: true,
            velocity: Some(group(5)),
            velocity_axes: VelocityAxes::Ecef,
            ..position_only.clone()
        };
        let (samples, _) = all("1,0,6378237,0,1,2,3,0,0,0\n", &earth_fixed);
        assert!((samples[0].position.height - 100.0).abs() < 1e-9);
        let velocity = samples[0].v_n.unwrap() - Vector3::new(3.0, -1.0, -2.0);
        assert!(velocity.amax() < 1e-9, "{velocity}");
        let attitude_only = TruthFormat {
            attitude: Some(group(8)),
            ..position_only
        };
        assert_eq!(all(text, &attitude_only).0[1].rpy, Some(rpy));
    }

    #[test]
    fn the_offset_is_added_to_the_times_of_a_log_and_of_a_table() {
        let record = |k: u32| {
            let mut values = [0.0; 17];
            let (lat, lon) = (45f64.to_radians(), 90f64.to_radians());
            values[..4].copy_from_slice(&[100.0 + f64::from(k), lat, lon, 7.0]);
            values.map(f64::to_le_bytes)
        };
        let bytes: Vec<u8> = (0..5).flat_map(record).flatten().collect();
        let log = TruthLog {
            format: Format::Sbet,
            stream: None,
            time_offset: -2.5,
            span: None,
        };
        let opened = Opened::stream(Path::new("truth.sbet"), Box::new(Cursor::new(bytes)));
        let reader = TruthReader::new(opened.unwrap(), &log.into()).unwrap();
        let times: Vec<f64> = reader.map(|sample| sample.unwrap().time).collect();
        assert_eq!(times, [97.5, 98.5, 99.5, 100.5, 101.5]);

        let table = TruthFormat {
            time_offset: -2.5,
            ..TruthFormat::degrees(Column::Number(1), group(2))
        };
        let (samples, _) = all("100,45,90,7\n101,45,90,7\n", &table);
        assert_eq!([samples[0].time, samples[1].time], [97.5, 98.5]);
    }
}
