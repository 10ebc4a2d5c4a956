//! Inertial samples from a table of rates or increments, or from a log that says itself what it holds.
//!
//! A sample stamped t covers the interval since the sample before, (t_prev, t]. A rate is taken
//! as the mean over that interval, so the increment is rate · dt. After a gap the interval is the
//! real difference of the stamps; whoever integrates decides how to bridge it.
//!
//! A row of increments holds what its own nominal interval collected, also after a gap. There, where
//! dt is beyond 1.5 nominal intervals, the increments are scaled by dt / nominal: then increment / dt
//! is the mean rate, as it is for a log of rates. The nominal interval is 1 / `rate_hz`, else the
//! running median of the intervals. Where the increments of one row after another would have to be
//! scaled, the rate is another than was thought, and the file is refused.

mod bursts;
mod format;
mod thermal;

pub use format::{ImuFormat, ImuSource, TemperatureColumn};
pub use thermal::{HOLD_S, Thermal, ThermalAxis, ThermalSummary};

use std::sync::Arc;

use undrift_nav::Vector3;
use undrift_nav::sample::ImuSample;

use crate::ReadError;
use crate::axis_faults::{AxisFaults, AxisWatch};
use crate::entry::{Entry, Wanted, What};
use crate::gaps::{GAP_INTERVALS, GapWatch};
pub use crate::gaps::{Gap, GapSummary};
use crate::log::JoinedRows;
use crate::opened::Memory;
use crate::reader::{Kind, Plan, Reader, Row, TableRow, Want};
use crate::skipped::{SkipKind, Skipped};
use crate::table::TableOptions;
use bursts::Bursts;
use thermal::ThermalWatch;

/// Values beyond this come from no sensor, in SI, rates or increments: they would overflow on the way.
const MAX_VALUE: f64 = 1e9;

/// Rates that differ by less, relative to their size, are one value.
const ROUNDING: f64 = 1e-12;

/// Gaps in a row that mean another sampling rate, in a log of increments.
const GAPS_IN_A_ROW: u32 = 100;

/// Reads inertial samples.
pub type ImuReader = Reader<Imu>;

/// Inertial samples as a kind of record.
pub struct Imu {
    format: ImuFormat,
    gaps: GapWatch,
    axes: AxisWatch,
    given: bool,
    gaps_in_a_row: u32,
    /// Temperature of the last sample given out [°C], NaN where it has none.
    temperature_c: f64,
    thermal: Option<ThermalWatch>,
    /// Rows of gyros and accelerometers that are apart.
    apart: Option<JoinedRows>,
    /// Rows that share a stamp.
    bursts: Option<Bursts>,
    /// The last sample in memory, and its rates.
    held: Option<ImuSample>,
    rates: [f64; 6],
}

/// A row without its time.
#[derive(Clone, Copy)]
pub struct Values {
    /// Gyro and accelerometer as in the file.
    gyro: Vector3,
    accel: Vector3,
    /// Temperature [°C]; NaN where there is none.
    temperature_c: f64,
}

impl Reader<Imu> {
    /// The usual interval and the gaps of the samples given out so far.
    pub fn gaps(&self) -> GapSummary {
        self.kind().gaps.summary()
    }

    /// What the axes show without any model, of the samples given out so far.
    pub fn axis_faults(&self) -> AxisFaults {
        self.kind().axes.faults()
    }

    /// Temperature of the sample given out last [°C]; NaN where it has none.
    pub fn temperature_c(&self) -> f64 {
        self.kind().temperature_c
    }

    /// How many of the samples given out so far were corrected for temperature, where that was asked for.
    pub fn thermal(&self) -> Option<ThermalSummary> {
        Some(self.kind().thermal.as_ref()?.summary)
    }
}

impl Kind for Imu {
    type Options = ImuFormat;
    type Values = Values;
    type Record = ImuSample;
    const PATIENCE: u32 = 100;

    fn plan(format: &ImuFormat) -> Result<Plan<Self>, ReadError> {
        format.check()?;
        let source = match &format.source {
            ImuSource::Log(kind, stream) => Want::Log(*kind, Wanted::Imu(stream.clone())),
            ImuSource::Samples => Want::Records,
            ImuSource::Table {
                time,
                gyro,
                accel,
                delimiter,
            } => {
                let mut wanted = TableOptions::finite(*delimiter);
                wanted.of_one_sensor = true;
                if let Some(time) = time {
                    wanted.want_time("imu", time, format.date.as_ref(), format.time_scale);
                }
                if let Some(temperature) = &format.temperature {
                    let place = wanted.want("imu.temperature", [&temperature.column]);
                    wanted.optional = Some(place);
                }
                wanted.want("imu.gyro", gyro);
                wanted.want("imu.accel", accel);
                wanted.keep_not_finite = format.apart;
                Want::Table(wanted)
            }
        };
        let kind = Self {
            format: format.clone(),
            gaps: GapWatch::default(),
            axes: AxisWatch::default(),
            given: false,
            gaps_in_a_row: 0,
            temperature_c: f64::NAN,
            rates: [0.0; 6],
            held: None,
            apart: format.apart.then(JoinedRows::new),
            bursts: format.spread_shared_stamps.then(Bursts::default),
            thermal: format
                .thermal
                .as_ref()
                .map(|axes| ThermalWatch::new(axes, format.rotation)),
        };
        Ok(Plan {
            kind,
            source,
            span: format.span,
        })
    }

    #[inline]
    fn of_row(&mut self, row: TableRow, skipped: &mut Skipped) -> Option<(f64, Values)> {
        let (rest, &[gx, gy, gz, ax, ay, az]) = row.numbers.split_last_chunk()?;
        let (temperature_c, rest) = match &self.format.temperature {
            Some(column) => {
                let (number, rest) = rest.split_last()?;
                (number - column.zero, rest)
            }
            None => (f64::NAN, rest),
        };
        let stamp = match rest {
            [stamp] => stamp * self.format.time_scale,
            _ => row.index as f64 / self.format.rate_hz?,
        };
        let (gyro, accel) = (Vector3::new(gx, gy, gz), Vector3::new(ax, ay, az));
        if let Some(apart) = &mut self.apart {
            apart.row(row.line, stamp, gyro, accel);
            return self.joined(row.line, skipped);
        }
        let values = Values {
            gyro,
            accel,
            temperature_c,
        };
        if let Some(bursts) = &mut self.bursts {
            bursts.row(row.line, stamp, values, skipped);
            let (stamp, values) = bursts.next()?;
            return self.plausible(stamp, values, row.line, skipped);
        }
        self.plausible(stamp, values, row.line, skipped)
    }

    fn late(
        &mut self,
        line: u64,
        skipped: &mut Skipped,
    ) -> Result<Option<(f64, Values)>, ReadError> {
        // An implausible row is counted, and the next one is asked for.
        while let Some((stamp, values)) = self.bursts.as_mut().and_then(Bursts::last) {
            if let Some(found) = self.plausible(stamp, values, line, skipped) {
                return Ok(Some(found));
            }
        }
        match self.apart.as_mut().and_then(JoinedRows::error) {
            Some(error) => Err(error),
            None => Ok(self.joined(line, skipped)),
        }
    }

    fn of_entry(&mut self, entry: Entry, skipped: &mut Skipped) -> Option<(f64, Values)> {
        let What::Imu(reading) = entry.what else {
            return None;
        };
        let stamp = reading.time * self.format.time_scale;
        let values = Values {
            gyro: reading.gyro,
            accel: reading.accel,
            temperature_c: reading.temperature_c,
        };
        self.plausible(stamp, values, entry.at, skipped)
    }

    fn held(memory: &Memory) -> Option<Arc<[ImuSample]>> {
        match memory {
            Memory::Samples(samples) => Some(samples.clone()),
            _ => None,
        }
    }

    fn of_record(
        &mut self,
        sample: &ImuSample,
        number: u64,
        skipped: &mut Skipped,
    ) -> Option<(f64, Values)> {
        let &ImuSample {
            time,
            dt,
            dtheta,
            dvel,
        } = sample;
        let mut numbers = [time, dt]
            .into_iter()
            .chain(dtheta.iter().chain(&dvel).copied());
        if let Some(bad) = numbers.find(|value| !value.is_finite()) {
            skipped.add(SkipKind::NotFinite, number, bad);
            return None;
        }
        if dt <= 0.0 {
            skipped.add(SkipKind::OutOfRange, number, format_args!("dt = {dt} s"));
            return None;
        }
        // A value that is held comes back from its increments with a rounding.
        let (gyro, accel) = (dtheta / dt, dvel / dt);
        for (last, rate) in self.rates.iter_mut().zip(gyro.iter().chain(&accel)) {
            if (rate - *last).abs() > ROUNDING * last.abs() {
                *last = *rate;
            }
        }
        let [gx, gy, gz, ax, ay, az] = self.rates;
        let values = Values {
            gyro: Vector3::new(gx, gy, gz),
            accel: Vector3::new(ax, ay, az),
            temperature_c: f64::NAN,
        };
        self.held = Some(*sample);
        self.plausible(time, values, number, skipped)
    }

    fn needs_interval(&self) -> bool {
        self.format.rate_hz.is_none() && !matches!(self.format.source, ImuSource::Samples)
    }

    #[inline]
    fn record(
        &mut self,
        row: &Row<Values>,
        skipped: &mut Skipped,
    ) -> Result<Option<ImuSample>, ReadError> {
        if let Some(error) = self.apart.as_mut().and_then(JoinedRows::error) {
            return Err(error);
        }
        let stated = self.format.rate_hz.map(|rate| 1.0 / rate);
        let own = self.held.map(|sample| sample.dt);
        // A sample in memory that goes on where the one before ended has its own length; across a gap its mean rate holds.
        let follows = |dt: f64| row.dt.is_none_or(|since| (since - dt).abs() <= 0.5 * dt);
        let Some(dt) = own.filter(|dt| follows(*dt)).or(row.dt).or(stated) else {
            let problem = "only one row of data";
            return Err(ReadError::nameless(problem).mend("record or export it again"));
        };
        let covered = match own {
            Some(own) => own,
            None => self.covered_by_increments(row.line, dt)?,
        };
        // The first interval given out is either made up or reaches back before the span.
        if self.given {
            self.gaps.add(Gap {
                start: row.time - dt,
                length: dt,
                line: row.line,
            });
        }
        let mut sample = self.sample(row, dt, covered);
        self.temperature_c = row.values.temperature_c;
        if let Some(thermal) = &mut self.thermal {
            let (gyro, accel) = thermal.bias(row.time, row.values.temperature_c);
            sample.dtheta -= gyro * dt;
            sample.dvel -= accel * dt;
        }
        // Increments that were collected in next to no time cannot be scaled to a gap.
        let finite = |increment: &Vector3| increment.as_slice().iter().all(|x| x.is_finite());
        if !(finite(&sample.dtheta) && finite(&sample.dvel)) {
            skipped.add(SkipKind::OutOfRange, row.line, format_args!("{dt} s"));
            return Ok(None);
        }
        self.given = true;
        let [gx, gy, gz] = row.values.gyro.into();
        let [ax, ay, az] = row.values.accel.into();
        self.axes.add(row.time, [gx, gy, gz, ax, ay, az]);
        Ok(Some(sample))
    }

    fn nothing(&self, _: &Skipped) -> ReadError {
        ReadError::nameless("no usable inertial sample")
    }
}

impl Imu {
    /// The next sample of rows of gyros and accelerometers that are apart.
    fn joined(&mut self, line: u64, skipped: &mut Skipped) -> Option<(f64, Values)> {
        let reading = self.apart.as_mut()?.next(skipped)?;
        let values = Values {
            gyro: reading.gyro,
            accel: reading.accel,
            temperature_c: f64::NAN,
        };
        self.plausible(reading.time, values, line, skipped)
    }

    /// A row as it is, with the offset of its time, unless its values cannot be any.
    #[inline]
    fn plausible(
        &self,
        stamp: f64,
        values: Values,
        line: u64,
        skipped: &mut Skipped,
    ) -> Option<(f64, Values)> {
        let format = &self.format;
        // Component by component: an iterator over six numbers costs more than the row's other checks, where it is not inlined.
        let larger = |most: f64, v: &Vector3, scale: &Vector3| {
            let [x, y, z] = [v.x * scale.x, v.y * scale.y, v.z * scale.z];
            most.max(x.abs()).max(y.abs()).max(z.abs())
        };
        let largest = larger(0.0, &values.gyro, &format.gyro_scale);
        let largest = larger(largest, &values.accel, &format.accel_scale);
        if largest > MAX_VALUE {
            skipped.add(SkipKind::OutOfRange, line, largest);
            return None;
        }
        Some((stamp + format.time_offset, values))
    }

    /// The part of the interval `dt` \[s\] that the increments of a row were collected in \[s\]: the
    /// nominal interval after a gap, else all of it.
    ///
    /// # Errors
    /// After [`GAPS_IN_A_ROW`] of them.
    fn covered_by_increments(&mut self, line: u64, dt: f64) -> Result<f64, ReadError> {
        if !self.format.increments {
            return Ok(dt);
        }
        let stated = self.format.rate_hz.map(|rate| 1.0 / rate);
        let Some(nominal) = stated.or_else(|| self.gaps.nominal()) else {
            return Ok(dt);
        };
        if dt <= GAP_INTERVALS * nominal {
            self.gaps_in_a_row = 0;
            return Ok(dt);
        }
        self.gaps_in_a_row += 1;
        if self.gaps_in_a_row < GAPS_IN_A_ROW {
            return Ok(nominal);
        }
        let problem = format!(
            "{GAPS_IN_A_ROW} consecutive increments {dt:.4} s apart at a rate of {:.2} Hz: the time that each covers is unknown",
            1.0 / nominal
        );
        Err(ReadError::nameless(problem)
            .at(line)
            .key("imu.rate")
            .mend("correct the rate, or split the file where the rate changes"))
    }

    /// The sample of a row whose increments, if it has increments, were collected in `covered` \[s\].
    fn sample(&self, row: &Row<Values>, dt: f64, covered: f64) -> ImuSample {
        let format = &self.format;
        let is_increment = format.increments || self.held.is_some();
        let length = if is_increment { dt / covered } else { dt };
        let (gyro, accel) = match &self.held {
            Some(sample) => (&sample.dtheta, &sample.dvel),
            None => (&row.values.gyro, &row.values.accel),
        };
        let body = |value: &Vector3, scale: &Vector3, offset: &Vector3| {
            format.rotation * value.component_mul(&(scale * length)) - offset * dt
        };
        ImuSample {
            time: row.time,
            dt,
            dtheta: body(gyro, &format.gyro_scale, &format.gyro_offset),
            dvel: body(accel, &format.accel_scale, &format.accel_offset),
        }
    }
}

#[cfg(test)]
mod tests;
