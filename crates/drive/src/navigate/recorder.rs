//! Outputs of a run while it goes: files, errors against the truth, curves.

use super::{
    Hindsight,
    clock::{Clock, Timing},
    outputs::Outputs,
    recording::Recording,
};
use crate::{
    consistency::{Consistency, ErrorState},
    drive::Drive,
    estimator::{Adjoint, Estimator},
    mounting::Mounting,
    reference::{COMPONENTS, Errors, HORIZONTAL, TruthCursor},
    rejected::Rejected,
    replay::{Observer, ReplayError},
    smooth::{History, Path},
};
use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};
use undrift_io::{
    ReadError,
    skipped::Skipped,
    truth::TruthReader,
    write::{SolutionFile, solution::SolutionRow},
};
use undrift_nav::{
    Quaternion, Vector3,
    attitude::to_rpy,
    covariance::{AXES, NAV},
    filter::Update,
    mechanisation::NavState,
    sample::{GnssFix, TruthSample},
};

/// Time between two values of the NEES \[s\].
const NEES_SPAN: f64 = 1.0;

/// A truth reader that ends at its first error and keeps it.
struct Readable {
    reader: TruthReader,
    error: Option<ReadError>,
    /// First and last time \[s\].
    read: Option<(f64, f64)>,
}

impl Iterator for Readable {
    type Item = TruthSample;

    fn next(&mut self) -> Option<TruthSample> {
        match self.reader.next()? {
            Ok(sample) => {
                let start = self.read.map_or(sample.time, |(start, _)| start);
                self.read = Some((start, sample.time));
                Some(sample)
            }
            Err(e) => {
                self.error = Some(e);
                None
            }
        }
    }
}

/// Outputs of a navigated drive. The default asks for the summary and the findings of a causal run alone.
#[derive(Default)]
pub struct Wanted {
    /// Files that the solution is written to.
    pub files: Vec<SolutionFile>,
    /// How much of the log the solution may know at each instant.
    pub hindsight: Hindsight,
    /// Clock of the solution's times.
    pub clock: Clock,
    /// Whether with the run over time in [`super::Report::recording`].
    pub recording: bool,
    /// Whether with the solution at every sample in [`super::Report::rows`]: 31 numbers each.
    pub rows: bool,
    /// Whether with the fixes that are rejected in [`super::Report::rejected`]: it grows with their number.
    pub rejected: bool,
    /// Counts the samples that are navigated, for progress bars.
    pub samples: Arc<AtomicU64>,
}

/// Keeps what is wanted of a run.
pub(super) struct Recorder {
    outputs: Outputs,
    timing: Timing,
    truth: Option<TruthCursor<Readable>>,
    /// Whether the axes are the vehicle's, as those of the truth.
    pub(super) mounted: bool,
    /// Sums of the squares of the errors, and their numbers.
    squares: [f64; COMPONENTS.len()],
    compared: [u64; COMPONENTS.len()],
    /// While the filter runs for a smoother.
    history: Option<History>,
    /// Sums of the filter's errors against its covariance, and the time of the next \[s\].
    consistency: Consistency,
    next_nees: f64,
    /// Where they are asked for.
    recording: Option<Box<Recording>>,
    rows: Option<Vec<SolutionRow>>,
    rejected: Option<Rejected>,
    samples: Arc<AtomicU64>,
}

/// What a [`Recorder`] has kept at the end.
pub(super) struct Seen {
    pub(super) rmse: Option<(Errors, u64)>,
    pub(super) consistency: Consistency,
    pub(super) recording: Option<Box<Recording>>,
    pub(super) rows: Vec<SolutionRow>,
    pub(super) rejected: Rejected,
    pub(super) truth_read: Option<(f64, f64)>,
    pub(super) truth_skipped: Skipped,
}

impl Recorder {
    pub(super) fn new(wanted: Wanted, truth: Option<TruthReader>) -> Result<Self, ReplayError> {
        Ok(Self {
            outputs: Outputs::new(wanted.files),
            timing: Timing::new(wanted.clock),
            truth: truth.map(|reader| {
                TruthCursor::new(Readable {
                    reader,
                    error: None,
                    read: None,
                })
            }),
            mounted: true,
            squares: [0.0; COMPONENTS.len()],
            compared: [0; COMPONENTS.len()],
            history: (wanted.hindsight == Hindsight::Smooth)
                .then(History::new)
                .transpose()?,
            consistency: Consistency::default(),
            next_nees: f64::NEG_INFINITY,
            recording: wanted.recording.then(Box::default),
            rows: wanted.rows.then(Vec::new),
            rejected: wanted.rejected.then(Rejected::default),
            samples: wanted.samples,
        })
    }

    /// After the replay: goes back through the nodes, if there are some, and over the samples again.
    pub(super) fn smooth(&mut self, drive: &Drive) -> Result<(), ReplayError> {
        self.outputs.fixes_end();
        let Some(smoothed) = self.history.take().map(History::smooth).transpose()? else {
            return Ok(());
        };
        if let Some(smoothed) = smoothed
            && let Some(mut path) = Path::new(&smoothed)
        {
            for sample in drive.open_imu()? {
                path.add(&sample?, |node| {
                    let (error, std) = (node.sensor_error, node.sensor_error_std);
                    let attitude = node.vehicle_attitude();
                    let of_vehicle = of_vehicle(&node.nav, node.nav_std, attitude);
                    let omega_n = || node.nav.q_nb * node.omega_nb_b;
                    let clock = Some(&node.receiver_clock);
                    let Some((nav, nav_std)) = self.timing.put(of_vehicle, clock, omega_n) else {
                        return Ok(());
                    };
                    self.record(&nav, nav_std, error, std).map(drop)
                })?;
            }
        }
        Ok(())
    }

    /// Gives the files their names, if the truth could be read.
    pub(super) fn finish(self) -> Result<Seen, ReplayError> {
        let (mut truth_skipped, mut truth_read) = (Skipped::default(), None);
        if let Some(cursor) = self.truth {
            let truth = cursor.into_inner();
            if let Some(error) = truth.error {
                return Err(error.into());
            }
            truth_skipped = truth.reader.skipped().clone();
            truth_read = truth.read;
        }
        // Last: with an error there is no file.
        self.outputs.finish()?;
        let n = self.compared[HORIZONTAL];
        let rms = |i: usize| (self.squares[i] / self.compared[i] as f64).sqrt();
        Ok(Seen {
            rmse: (n > 0).then(|| (Errors(std::array::from_fn(rms)), n)),
            consistency: self.consistency,
            recording: self.recording,
            rows: self.rows.unwrap_or_default(),
            rejected: self.rejected.unwrap_or_default(),
            truth_read,
            truth_skipped,
        })
    }

    fn record(
        &mut self,
        nav: &NavState,
        nav_std: [f64; NAV],
        e: [f64; AXES],
        error_std: [f64; AXES],
    ) -> Result<Option<TruthSample>, ReplayError> {
        let mut truth = self.truth.as_mut().and_then(|t| t.at(nav.time));
        if let Some(truth) = &mut truth {
            truth.rpy = truth.rpy.filter(|_| self.mounted);
            let errors = Errors::against_truth(nav, truth);
            let known = errors.0.iter().enumerate().filter(|(_, e)| e.is_finite());
            for (i, e) in known {
                self.squares[i] += e * e;
                self.compared[i] += 1;
            }
            if let Some(recording) = &mut self.recording {
                recording.errors(nav.time, &errors);
            }
        }
        if !self.outputs.is_empty() || self.recording.is_some() || self.rows.is_some() {
            let row = solution_row(nav, nav_std, e, error_std);
            self.outputs.write(&row)?;
            if let Some(recording) = &mut self.recording {
                recording.solution(&row);
            }
            if let Some(rows) = &mut self.rows {
                rows.push(row);
            }
        }
        Ok(truth)
    }
}

impl Observer for Recorder {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        self.samples.fetch_add(1, Ordering::Relaxed);
        if self.history.is_some() {
            self.outputs.begin(filter.nav().time);
            return Ok(());
        }
        let Some((nav, nav_std)) = at_sample(&mut self.timing, filter) else {
            return Ok(());
        };
        let truth = self.record(
            &nav,
            nav_std,
            filter.sensor_error(),
            filter.sensor_error_std(),
        )?;
        // The filter is on the IMU's clock.
        if let Some(truth) = truth.filter(|truth| truth.time >= self.next_nees)
            && self.timing.clock != Clock::Gnss
        {
            self.next_nees = truth.time + NEES_SPAN;
            self.consistency.add(&ErrorState::new(filter, &truth, None));
        }
        Ok(())
    }

    fn fix(&mut self, _filter: &dyn Estimator, fix: &GnssFix, _withheld: bool) {
        if let Some(recording) = &mut self.recording {
            recording.reached(fix);
        }
    }

    fn used(&mut self, time: f64) {
        self.outputs.fix(time);
    }

    fn mounted(&mut self, _mounting: &Mounting) {
        self.mounted = true;
    }

    fn node(&mut self, filter: &dyn Estimator, since: Option<&Adjoint>) -> Result<(), ReplayError> {
        if let Some(history) = &mut self.history {
            history.push(filter, since)?;
        }
        Ok(())
    }

    fn updated(&mut self, time: f64, updates: [Option<Update>; 2]) {
        if let Some(recording) = &mut self.recording {
            recording.fix(time, updates);
        }
        if let Some(rejected) = &mut self.rejected {
            rejected.note(time, updates);
        }
    }
}

/// Makes rows of a filter as it goes, of the vehicle's axes and on one clock.
pub struct Rows(Timing);

impl Rows {
    /// Rows with the times of `clock`.
    pub fn new(clock: Clock) -> Self {
        Self(Timing::new(clock))
    }

    /// The row of the filter as it is; `None` where its time is not beyond that of the row before.
    pub fn row(&mut self, filter: &dyn Estimator) -> Option<SolutionRow> {
        let (nav, nav_std) = at_sample(&mut self.0, filter)?;
        Some(solution_row(
            &nav,
            nav_std,
            filter.sensor_error(),
            filter.sensor_error_std(),
        ))
    }
}

/// State and standard deviations at the end of a sample, of the vehicle's axes and on the clock.
fn at_sample(timing: &mut Timing, filter: &dyn Estimator) -> Option<(NavState, [f64; NAV])> {
    let of_vehicle = of_vehicle(filter.nav(), filter.nav_std(), filter.vehicle_attitude());
    let clock = filter.receiver_clock();
    let omega_n = || filter.nav().q_nb * filter.omega_nb_b();
    timing.put(of_vehicle, clock.as_ref(), omega_n)
}

/// State and standard deviations with the attitude of the vehicle's axes and its standard deviations.
fn of_vehicle(
    nav: &NavState,
    mut nav_std: [f64; NAV],
    (q_nv, std): (Quaternion, [f64; 3]),
) -> (NavState, [f64; NAV]) {
    nav_std[6..].copy_from_slice(&std);
    (NavState { q_nb: q_nv, ..*nav }, nav_std)
}

/// The row of a solution at an instant: state, standard deviations as of [`Estimator::nav_std`] [m, m/s, rad], and sensor errors,
/// [`Estimator::sensor_error`] [rad/s, m/s²], with their standard deviations.
pub fn solution_row(
    nav: &NavState,
    nav_std: [f64; NAV],
    e: [f64; AXES],
    error_std: [f64; AXES],
) -> SolutionRow {
    SolutionRow {
        time: nav.time,
        position: nav.position,
        v_n: nav.v_n,
        rpy: to_rpy(&nav.q_nb),
        nav_std,
        gyro_error: Vector3::new(e[0], e[1], e[2]),
        accel_error: Vector3::new(e[3], e[4], e[5]),
        error_std,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::{attitude::from_rpy, earth::Geodetic};

    #[test]
    fn a_row_is_of_the_vehicle_where_the_sensor_is() {
        let rpy = Vector3::new(0.1, 0.2, 0.3);
        let nav = NavState {
            time: 5.0,
            position: Geodetic::from_degrees(45.0, 7.0, 300.0),
            v_n: Vector3::new(1.0, 2.0, 3.0),
            q_nb: Quaternion::identity(),
        };
        let std = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
        let (nav, std) = of_vehicle(&nav, std, (from_rpy(&rpy), [0.7, 0.8, 0.9]));
        let errors = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
        let row = solution_row(&nav, std, errors, errors.map(|e| 10.0 * e));
        assert_eq!(
            (row.time, row.position, row.v_n),
            (5.0, nav.position, nav.v_n)
        );
        assert!((row.rpy - rpy).norm() < 1e-12);
        assert_eq!(row.nav_std, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.7, 0.8, 0.9]);
        assert_eq!(row.gyro_error, Vector3::new(0.1, 0.2, 0.3));
        assert_eq!(row.accel_error, Vector3::new(0.4, 0.5, 0.6));
        assert_eq!(row.error_std, errors.map(|e| 10.0 * e));
    }

    /// Errors north of 3 m and −4 m: 3.54 m of two; no errors without a reference.
    #[test]
    fn errors_are_root_mean_squares_over_the_samples_compared() {
        let recorder = || {
            let wanted = Wanted {
                rows: true,
                ..Wanted::default()
            };
            Recorder::new(wanted, None).unwrap()
        };
        let mut seen = recorder();
        seen.squares[0] = 9.0 + 16.0;
        seen.compared = [2; COMPONENTS.len()];
        let (rmse, compared) = seen.finish().unwrap().rmse.unwrap();
        assert_eq!((rmse.0[0], rmse.0[1], compared), (12.5f64.sqrt(), 0.0, 2));
        let mut alone = recorder();
        let nav = NavState {
            time: 5.0,
            position: Geodetic::from_degrees(45.0, 7.0, 300.0),
            v_n: Vector3::zeros(),
            q_nb: Quaternion::identity(),
        };
        for _ in 0..3 {
            let none = alone.record(&nav, [1.0; NAV], [0.0; AXES], [1.0; AXES]);
            assert!(none.unwrap().is_none());
        }
        let seen = alone.finish().unwrap();
        assert!(seen.rmse.is_none() && seen.recording.is_none());
        assert_eq!(seen.rows.len(), 3);
    }
}
