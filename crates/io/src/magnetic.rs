//! Reads magnetic fields: three columns of a table, the messages of a log that says itself what it holds, or readings in memory.

use std::sync::Arc;

use undrift_nav::{Matrix3, Vector3, sample::MagneticField};

use crate::ReadError;
use crate::entry::{Entry, Wanted, What};
use crate::fix::is_usable_std;
use crate::format::Format;
use crate::gaps::{Gap, GapSummary, GapWatch};
use crate::opened::Memory;
use crate::reader::{Kind, Plan, Reader, Row, TableRow, Want};
use crate::skipped::{SkipKind, Skipped};
use crate::table::{Column, TableOptions};

/// Strengths that a field near a vehicle can have, hard iron included \[T\].
const STRENGTHS: std::ops::RangeInclusive<f64> = 1e-6..=1e-3;

/// Where the readings of a log are and what they mean.
#[derive(Clone, Debug)]
pub struct MagneticFormat {
    /// Where they are.
    pub source: MagneticSource,
    /// Added to the time after scaling \[s\].
    pub time_offset: f64,
    /// Factor of each axis of the file to tesla.
    pub scale: Vector3,
    /// From the axes of the file to those of the body.
    pub rotation: Matrix3,
    /// Standard deviation of the white noise, each axis \[T\].
    pub std: f64,
    /// First and last time \[s\] to give out, after the offset.
    pub span: Option<(f64, f64)>,
}

/// Where readings are.
#[derive(Clone, Debug)]
pub enum MagneticSource {
    /// Columns of a table.
    Table {
        /// Time column.
        time: Column,
        /// Column of dates, where that of times has times of day.
        date: Option<Column>,
        /// Factor from the time column to seconds.
        time_scale: f64,
        /// Columns x, y, z.
        field: [Column; 3],
        /// The byte between fields; `None` finds out.
        delimiter: Option<u8>,
    },
    /// A log of this format, of the stream with this name or of the only one; its readings are in tesla.
    Log(Format, Option<String>),
    /// Readings in memory, as they are, with their own standard deviations.
    Held,
}

impl MagneticFormat {
    /// Readings from `source` in tesla and body axes, with the standard deviation `std` \[T\].
    pub fn new(source: MagneticSource, std: f64) -> Self {
        Self {
            source,
            time_offset: 0.0,
            scale: Vector3::repeat(1.0),
            rotation: Matrix3::identity(),
            std,
            span: None,
        }
    }
}

/// Reads magnetic fields.
pub type MagneticReader = Reader<Fields>;

/// Magnetic fields as a kind of record.
pub struct Fields {
    format: MagneticFormat,
    gaps: GapWatch,
}

impl Reader<Fields> {
    /// The usual interval and the gaps of the rows met so far.
    pub fn gaps(&self) -> GapSummary {
        self.kind().gaps.summary()
    }
}

impl Kind for Fields {
    type Options = MagneticFormat;
    /// The field \[T\] in the axes of the file, and its standard deviation \[T\].
    type Values = (Vector3, f64);
    type Record = MagneticField;
    const PATIENCE: u32 = 100;

    fn plan(format: &MagneticFormat) -> Result<Plan<Self>, ReadError> {
        let source = match &format.source {
            MagneticSource::Held => Want::Records,
            MagneticSource::Log(log, stream) => Want::Log(*log, Wanted::Fields(stream.clone())),
            MagneticSource::Table {
                time,
                date,
                time_scale,
                field,
                delimiter,
            } => {
                let mut wanted = TableOptions::finite(*delimiter);
                wanted.want_time("magnetometer", time, date.as_ref(), *time_scale);
                wanted.want("magnetometer.field", field);
                Want::Table(wanted)
            }
        };
        Ok(Plan {
            kind: Self {
                format: format.clone(),
                gaps: GapWatch::default(),
            },
            source,
            span: format.span,
        })
    }

    fn of_row(&mut self, row: TableRow, _: &mut Skipped) -> Option<(f64, (Vector3, f64))> {
        let &[stamp, x, y, z, ..] = row.numbers else {
            return None;
        };
        let scale = match self.format.source {
            MagneticSource::Table { time_scale, .. } => time_scale,
            _ => 1.0,
        };
        let field = Vector3::new(x, y, z).component_mul(&self.format.scale);
        let time = stamp * scale + self.format.time_offset;
        Some((time, (field, self.format.std)))
    }

    fn of_entry(&mut self, entry: Entry, _: &mut Skipped) -> Option<(f64, (Vector3, f64))> {
        let What::Field(read) = entry.what else {
            return None;
        };
        let field = read.field.component_mul(&self.format.scale);
        let time = read.time + self.format.time_offset;
        Some((time, (field, self.format.std)))
    }

    fn held(memory: &Memory) -> Option<Arc<[MagneticField]>> {
        match memory {
            Memory::Fields(fields) => Some(fields.clone()),
            _ => None,
        }
    }

    fn of_record(
        &mut self,
        reading: &MagneticField,
        number: u64,
        skipped: &mut Skipped,
    ) -> Option<(f64, (Vector3, f64))> {
        if !reading.is_finite() {
            skipped.add(SkipKind::NotFinite, number, reading.time);
            return None;
        }
        let time = reading.time + self.format.time_offset;
        Some((time, (reading.field, reading.std)))
    }

    fn record(
        &mut self,
        row: &Row<(Vector3, f64)>,
        skipped: &mut Skipped,
    ) -> Result<Option<MagneticField>, ReadError> {
        if let Some(length) = row.dt {
            self.gaps.add(Gap {
                start: row.time - length,
                length,
                line: row.line,
            });
        }
        let (field, std) = row.values;
        if !STRENGTHS.contains(&field.norm()) {
            let detail = format!("{} uT", field.norm() * 1e6);
            skipped.add(SkipKind::OutOfRange, row.line, detail);
            return Ok(None);
        }
        if !is_usable_std(std) {
            skipped.add(SkipKind::Uncertainty, row.line, std);
            return Ok(None);
        }
        Ok(Some(MagneticField {
            time: row.time,
            field: self.format.rotation * field,
            std,
        }))
    }

    fn nothing(&self, _: &Skipped) -> ReadError {
        ReadError::nameless("no usable magnetic field")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Opened;
    use std::io::Cursor;
    use std::path::Path;

    fn columns(scale: f64) -> MagneticFormat {
        let source = MagneticSource::Table {
            time: Column::Name("t".into()),
            date: None,
            time_scale: 1e-3,
            field: ["mx", "my", "mz"].map(|name| Column::Name(name.into())),
            delimiter: None,
        };
        MagneticFormat {
            scale: Vector3::repeat(scale),
            ..MagneticFormat::new(source, 0.5e-6)
        }
    }

    fn all(text: &str, format: &MagneticFormat) -> (Vec<MagneticField>, Skipped) {
        let source = Box::new(Cursor::new(text.as_bytes().to_vec()));
        let opened = Opened::stream(Path::new("mag.csv"), source).unwrap();
        let mut reader = MagneticReader::new(opened, format).unwrap();
        let fields = reader.by_ref().map(Result::unwrap).collect();
        (fields, reader.skipped().clone())
    }

    #[test]
    fn units_axes_and_what_is_no_field() {
        let format = MagneticFormat {
            rotation: Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0),
            time_offset: 2.0,
            ..columns(1e-7)
        };
        // Milligauss; a sensor that is off, and one that is saturated.
        let text =
            "t,mx,my,mz\n0,10,200,-400\n100,0,0,0\n200,30000,0,0\n300,10,nan,5\n400,20,200,-400\n";
        let (fields, skipped) = all(text, &format);
        assert_eq!(fields.len(), 2);
        assert_eq!(fields[0].time, 2.0);
        assert!((fields[0].field - Vector3::new(20e-6, 1e-6, 40e-6)).norm() < 1e-12);
        assert_eq!(skipped.count(SkipKind::OutOfRange), 2);
        assert_eq!(skipped.count(SkipKind::NotFinite), 1);
    }

    #[test]
    fn readings_in_memory_keep_their_standard_deviations() {
        let reading = |time: f64, std: f64| MagneticField {
            time,
            field: Vector3::new(20e-6, 0.0, 44e-6),
            std,
        };
        let held = [reading(0.0, 1e-6), reading(1.0, 2e-6), reading(2.0, -1.0)];
        let memory = Memory::Fields(held.into());
        let opened = Opened::memory(Path::new("<mag>"), memory, &Default::default()).unwrap();
        let format = MagneticFormat::new(MagneticSource::Held, 9.0);
        let mut reader = MagneticReader::new(opened, &format).unwrap();
        let seen: Vec<f64> = reader.by_ref().map(|r| r.unwrap().std).collect();
        assert_eq!(seen, [1e-6, 2e-6]);
        assert_eq!(reader.skipped().count(SkipKind::Uncertainty), 1);
    }
}
