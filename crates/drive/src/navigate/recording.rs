//! Curves of a run over time, for plots.

use crate::{
    consistency::COMPONENT_NAMES,
    engine::derived::antenna,
    estimator::STAMP_ROUNDING,
    findings::WITHOUT_GNSS,
    reference::{COMPONENTS, Errors},
    replay::{MOST_EVENTS, Windows},
};
use std::collections::BTreeMap;
use undrift_io::write::solution::SolutionRow;
use undrift_nav::{
    covariance::{AXES, NAV},
    filter::{Outcome, Update},
    sample::GnssFix,
};
use undrift_results::{
    Curve, Fixes, NavigateSeries, Track, by_name,
    series::{Envelope, ROWS, Thinned, to_digits, to_millimetre, to_millisecond},
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
    /// Whitened innovations of position and velocity and NIS over its degrees of freedom, and NIS
    /// over its degrees of freedom of what was rejected.
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

    /// Adds whether a fix was used, down-weighted or rejected.
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

    /// The curves as a result, with the windows in which solution and fixes disagree; what nothing was added to is missing.
    pub fn series(&self, windows: &Windows) -> NavigateSeries {
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
            disagreements_s: windows.spans().map(|span| rounded(&span)).collect(),
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

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::{
        Matrix3, Vector3,
        earth::Geodetic,
        sample::{FixQuality, Position},
    };
    use undrift_results::Number;

    fn only(curve: &Curve) -> f64 {
        let [Number(value)] = curve.value[..] else {
            panic!("{curve:?}");
        };
        value
    }

    #[track_caller]
    fn assert_near(found: f64, expected: f64) {
        // Six digits are kept.
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
    }

    /// Numbers that are all different, at a heading of 30 deg.
    #[test]
    fn a_solution_is_recorded_in_degrees_about_the_vehicles_axes() {
        let (tilt_n, tilt_e) = (0.02, 0.01);
        let row = SolutionRow {
            v_n: Vector3::new(1.0, 2.0, 3.0),
            rpy: Vector3::new(4.0, 5.0, 30.0).map(f64::to_radians),
            nav_std: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, tilt_n, tilt_e, 0.03],
            gyro_error: Vector3::new(1e-3, 2e-3, 3e-3),
            accel_error: Vector3::new(0.04, 0.05, 0.06),
            error_std: [1e-4, 2e-4, 3e-4, 4e-4, 5e-4, 6e-4],
            ..SolutionRow::at(7.0, Geodetic::from_degrees(45.0, -7.0, 300.0))
        };
        let mut recording = Recording::default();
        recording.solution(&row);
        let series = recording.series(&Windows::default());
        let track = &series.track;
        let all = [
            &track.time_s,
            &track.lat_deg,
            &track.lon_deg,
            &track.height_m,
        ];
        for (numbers, expected) in all.into_iter().zip([7.0, 45.0, -7.0, 300.0]) {
            assert_eq!(numbers[..], [Number(expected)]);
        }
        for (name, value) in [
            ("vn_mps", 1.0),
            ("ve_mps", 2.0),
            ("vd_mps", 3.0),
            ("roll_deg", 4.0),
            ("pitch_deg", 5.0),
            ("yaw_deg", 30.0),
        ] {
            assert_near(only(&series.motion[name]), value);
        }
        assert_eq!(series.motion.len(), 6);
        // Forward is 30 deg east of north: roll is about it, pitch about what is right of it.
        let (sin, cos) = (0.5, 0.75f64.sqrt());
        let about = |n: f64, e: f64| ((n * tilt_n).powi(2) + (e * tilt_e).powi(2)).sqrt();
        for (name, value) in [
            ("north_m", 0.1),
            ("east_m", 0.2),
            ("down_m", 0.3),
            ("vn_mps", 0.4),
            ("ve_mps", 0.5),
            ("vd_mps", 0.6),
            ("roll_deg", about(cos, sin).to_degrees()),
            ("pitch_deg", about(sin, cos).to_degrees()),
            ("yaw_deg", 0.03f64.to_degrees()),
        ] {
            assert_near(only(&series.std[name]), value);
        }
        let sensors = row.gyro_error.iter().chain(&row.accel_error);
        for ((name, value), std) in SENSORS.iter().zip(sensors).zip(row.error_std) {
            assert_near(only(&series.sensor_error[*name]), *value);
            assert_near(only(&series.sensor_error_std[*name]), std);
        }
        assert!(series.error.is_empty() && series.without_gnss_s.is_empty());
    }

    fn fix(time: f64) -> GnssFix {
        let place = Geodetic::from_degrees(45.0, 7.0, 300.0);
        let covariance = Matrix3::from_diagonal(&Vector3::new(4.0, 9.0, 16.0));
        GnssFix {
            attitude: None,
            mean_velocity: None,
            time,
            position: Some((Position::Geodetic(place), covariance)),
            velocity: None,
            quality: FixQuality::Unknown,
        }
    }

    fn update(outcome: Outcome) -> Option<Update> {
        Some(Update {
            nis: 6.0,
            dof: 3,
            whitened: [1.0, 2.0, 1.0],
            score: 0.0,
            information: 0.0,
            outcome,
        })
    }

    #[test]
    fn fixes_are_recorded_by_what_became_of_them() {
        let mut recording = Recording::default();
        for (time, outcome) in [
            (1.0, Outcome::Used),
            (2.0, Outcome::Weakened(2.0)),
            (3.0, Outcome::Rejected),
        ] {
            recording.reached(&fix(time));
            recording.fix(time, [update(outcome), None]);
        }
        // A velocity of a fix says nothing of its position; nor does an update of another time.
        recording.reached(&fix(4.0));
        recording.fix(4.0, [None, update(Outcome::Rejected)]);
        recording.reached(&fix(5.0));
        recording.fix(5.1, [update(Outcome::Used), None]);
        recording.reached(&fix(6.0));
        recording.fix(6.0 + 0.5 * STAMP_ROUNDING, [update(Outcome::Used), None]);
        let series = recording.series(&Windows::default());
        let times = |fixes: &Fixes| fixes.time_s.iter().map(|t| t.0).collect::<Vec<_>>();
        assert_eq!(times(&series.fixes), [1.0, 2.0, 6.0]);
        assert_eq!(times(&series.rejected_fixes), [3.0]);
        let of = &series.fixes;
        let all = [&of.lat_deg, &of.lon_deg, &of.std_north_m, &of.std_east_m];
        assert_eq!(all.map(|numbers| numbers[0].0), [45.0, 7.0, 2.0, 3.0]);
        let position = &series.innovations["position"];
        assert_eq!(position["left_out_nis"].time_s, [Number(3.0)]);
        assert_eq!(only(&position["left_out_nis"]), 2.0);
        for (name, value) in [("north", 1.0), ("east", 2.0), ("down", 1.0), ("nis", 2.0)] {
            assert_eq!(position[name].value, [Number(value); 4]);
        }
        let velocity = &series.innovations["velocity"];
        assert_eq!((velocity.len(), only(&velocity["left_out_nis"])), (1, 2.0));
    }

    /// More than five seconds are a span; what is rejected does not end one, the end of the log does.
    #[test]
    fn spans_without_a_fix_are_those_between_fixes_used() {
        let mut recording = Recording::default();
        let used = Outcome::Used;
        for (time, outcome) in [
            (10.0, used),
            (10.0 + WITHOUT_GNSS, used),
            (17.0, Outcome::Rejected),
            (21.0, used),
        ] {
            recording.fix(time, [update(outcome), None]);
        }
        let place = Geodetic::from_degrees(45.0, 7.0, 300.0);
        let spans = |recording: &Recording| -> Vec<(f64, f64)> {
            let spans = recording
                .series(&Windows::default())
                .without_gnss_s
                .into_iter();
            spans.map(|(from, to)| (from.0, to.0)).collect()
        };
        recording.solution(&SolutionRow::at(21.0 + WITHOUT_GNSS, place));
        assert_eq!(spans(&recording), [(15.0, 21.0)]);
        recording.solution(&SolutionRow::at(27.0, place));
        assert_eq!(spans(&recording), [(15.0, 21.0), (21.0, 27.0)]);
        recording.fix(27.5, [None, update(used)]);
        assert_eq!(spans(&recording), [(15.0, 21.0), (21.0, 27.5)]);
        for k in 0..2 * MOST_EVENTS {
            recording.fix(100.0 + 6.0 * k as f64, [update(used), None]);
        }
        assert_eq!(recording.without_gnss.len(), MOST_EVENTS);
    }

    #[test]
    fn errors_are_recorded_by_component() {
        let mut recording = Recording::default();
        recording.errors(2.0, &Errors(std::array::from_fn(|i| i as f64 - 3.0)));
        let series = recording.series(&Windows::default());
        for (i, name) in COMPONENTS.into_iter().enumerate() {
            assert_eq!(only(&series.error[name]), i as f64 - 3.0);
        }
    }
}
