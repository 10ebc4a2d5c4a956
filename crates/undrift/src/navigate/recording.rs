//! What a run was like over time, for plots.

use crate::{
    consistency::COMPONENT_NAMES,
    engine::derived::antenna,
    estimator::STAMP_ROUNDING,
    findings::WITHOUT_GNSS,
    reference::{COMPONENTS, Errors},
    replay::MOST_EVENTS,
    results::{Curve, Fixes, NavigateSeries, Track, by_name},
    series::{Envelope, ROWS, Thinned, to_digits, to_millimetre, to_millisecond},
};
use std::collections::BTreeMap;
use undrift_io::write::solution::SolutionRow;
use undrift_nav::{
    covariance::{AXES, NAV},
    filter::{Outcome, Update},
    sample::GnssFix,
};

/// Names of the six sensor axes' errors with their units.
const SENSORS: &[&str] = COMPONENT_NAMES.split_at(NAV).1;
/// Velocity and attitude.
const MOTION: &[&str] = DEVIATIONS.split_at(3).1;
/// The standard deviations of the nine navigation errors.
const DEVIATIONS: [&str; NAV] = [
    "north_m",
    "east_m",
    "down_m",
    "vn_mps",
    "ve_mps",
    "vd_mps",
    "roll_deg",
    "pitch_deg",
    "yaw_deg",
];
/// Fixes of one kind that are kept.
const FIXES: usize = 1000;
const INNOVATIONS: [&str; 4] = ["north", "east", "down", "nis"];

/// The solution, its standard deviations, the innovations and the errors over time, of bounded size.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Time \[s\], latitude, longitude \[deg\], height \[m\].
    track: Thinned<4>,
    motion: [Envelope; MOTION.len()],
    deviations: [Envelope; NAV],
    sensors: [Envelope; AXES],
    sensor_deviations: [Envelope; AXES],
    errors: [Envelope; COMPONENTS.len()],
    /// Of position and velocity: whitened innovations and NIS over its degrees of freedom, and NIS
    /// over the same of what was left out.
    innovations: [[Envelope; INNOVATIONS.len()]; 2],
    left_out: [Envelope; 2],
    /// Time \[s\], latitude, longitude \[deg\] and standard deviations north and east \[m\] of the fixes used,
    /// and of those rejected.
    fixes: [Thinned<5>; 2],
    /// A position that the filter has not judged yet.
    pending: Option<[f64; 5]>,
    /// Spans without a fix used: start and end \[s\].
    without_gnss: Vec<(f64, f64)>,
    last_used: Option<f64>,
    /// Times of the last sample \[s\].
    ended: f64,
}

impl Default for Recording {
    fn default() -> Self {
        Self {
            track: Thinned::new(ROWS),
            motion: Default::default(),
            deviations: Default::default(),
            sensors: Default::default(),
            sensor_deviations: Default::default(),
            errors: Default::default(),
            innovations: Default::default(),
            left_out: Default::default(),
            fixes: [Thinned::new(FIXES), Thinned::new(FIXES)],
            pending: None,
            without_gnss: Vec::new(),
            last_used: None,
            ended: f64::NEG_INFINITY,
        }
    }
}

impl Recording {
    /// Adds the solution at a sample.
    pub(super) fn solution(&mut self, row: &SolutionRow) {
        let place = &row.position;
        let (lat, lon) = (place.lat.to_degrees(), place.lon.to_degrees());
        self.track.add([row.time, lat, lon, place.height]);
        let attitude = row.rpy.map(f64::to_degrees);
        add(
            &mut self.motion,
            row.time,
            row.v_n.iter().chain(&attitude).copied(),
        );
        // Tilts about north and east turned to the vehicle's axes, as if they were independent.
        let [pn, pe, pd, vn, ve, vd, tilt_n, tilt_e, yaw] = row.nav_std;
        let (sin, cos) = row.rpy.z.sin_cos();
        let (roll, pitch) = (
            (cos * tilt_n).hypot(sin * tilt_e),
            (sin * tilt_n).hypot(cos * tilt_e),
        );
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::to_degrees);
        let deviations = [pn, pe, pd, vn, ve, vd, roll, pitch, yaw];
        add(&mut self.deviations, row.time, deviations);
        let sensors = row.gyro_error.iter().chain(&row.accel_error).copied();
        add(&mut self.sensors, row.time, sensors);
        add(&mut self.sensor_deviations, row.time, row.error_std);
        self.ended = row.time;
    }

    /// Adds errors against the truth.
    pub(super) fn errors(&mut self, time: f64, errors: &Errors) {
        add(&mut self.errors, time, errors.0);
    }

    /// Notes a fix that the filter is going to judge.
    pub(super) fn reached(&mut self, fix: &GnssFix) {
        self.pending = antenna(fix)
            .zip(fix.position)
            .map(|(place, (_, covariance))| {
                let (lat, lon) = (place.lat.to_degrees(), place.lon.to_degrees());
                let std = |axis: usize| covariance[(axis, axis)].sqrt();
                [fix.time, lat, lon, std(0), std(1)]
            });
    }

    /// Adds what became of a fix.
    pub(super) fn fix(&mut self, time: f64, updates: [Option<Update>; 2]) {
        if let Some((position, place)) = updates[0].as_ref().zip(self.pending.take())
            && (place[0] - time).abs() < STAMP_ROUNDING
        {
            self.fixes[usize::from(position.outcome == Outcome::Rejected)].add(place);
        }
        let mut used = false;
        for (part, update) in updates.iter().enumerate() {
            let Some(update) = update else { continue };
            let nis = update.nis / update.dof.max(1) as f64;
            if update.outcome == Outcome::Rejected {
                self.left_out[part].add(time, nis);
                continue;
            }
            used = true;
            let [north, east, down] = update.whitened;
            add(&mut self.innovations[part], time, [north, east, down, nis]);
        }
        if used {
            self.span(time);
            self.last_used = Some(time);
        }
    }

    /// Notes a span without a fix that ends now, if it was a long one.
    fn span(&mut self, time: f64) {
        if let Some(last) = self.last_used.filter(|last| time - last > WITHOUT_GNSS)
            && self.without_gnss.len() < MOST_EVENTS
        {
            self.without_gnss.push((last, time));
        }
    }

    /// All of it; what nothing was added to is missing.
    pub fn series(&self) -> NavigateSeries {
        let innovations = |part: usize| {
            let mut curves = named(&INNOVATIONS, &self.innovations[part]);
            if !self.left_out[part].is_empty() {
                curves.insert("left_out_nis".into(), self.left_out[part].curve());
            }
            curves
        };
        let open = self
            .last_used
            .filter(|last| self.ended - last > WITHOUT_GNSS)
            .map(|last| (last, self.ended));
        let rounded =
            |(from, to): &(f64, f64)| (to_millisecond(*from).into(), to_millisecond(*to).into());
        let track = &self.track;
        NavigateSeries {
            track: Track {
                time_s: track.column(0, to_millisecond),
                lat_deg: track.column(1, to_millimetre),
                lon_deg: track.column(2, to_millimetre),
                height_m: track.column(3, to_millisecond),
            },
            motion: named(MOTION, &self.motion),
            std: named(&DEVIATIONS, &self.deviations),
            sensor_error: named(SENSORS, &self.sensors),
            sensor_error_std: named(SENSORS, &self.sensor_deviations),
            error: named(&COMPONENTS, &self.errors),
            innovations: [("position", 0), ("velocity", 1)]
                .map(|(name, part)| (name.to_owned(), innovations(part)))
                .into(),
            without_gnss_s: self.without_gnss.iter().chain(&open).map(rounded).collect(),
            fixes: fixes(&self.fixes[0]),
            rejected_fixes: fixes(&self.fixes[1]),
        }
    }
}

fn fixes(rows: &Thinned<5>) -> Fixes {
    Fixes {
        time_s: rows.column(0, to_millisecond),
        lat_deg: rows.column(1, to_millimetre),
        lon_deg: rows.column(2, to_millimetre),
        std_north_m: rows.column(3, to_digits),
        std_east_m: rows.column(4, to_digits),
    }
}

fn add(series: &mut [Envelope], time: f64, values: impl IntoIterator<Item = f64>) {
    for (series, value) in series.iter_mut().zip(values) {
        series.add(time, value);
    }
}

fn named(names: &[&str], series: &[Envelope]) -> BTreeMap<String, Curve> {
    let named = names.iter().zip(series);
    let known = named.filter(|(_, series)| !series.is_empty());
    by_name(known.map(|(name, series)| (*name, series.curve())))
}
