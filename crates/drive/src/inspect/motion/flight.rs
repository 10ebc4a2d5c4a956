//! Whether a craft flies, and as what: it leans into its accelerations, and what a copter or an aircraft does in the air
//! predicts withheld fixes better than nothing does.

use super::{
    At, Inspection, Motion, Wheels,
    accuracy::{self, Judged},
};
use crate::{
    drive::{Drive, Logs as Files},
    estimator::Estimator,
    navigate::{Hindsight, settings},
    outages::{Logs, run},
    replay::{Observer, ReplayError, replay},
    vehicle::Profile,
};
use nalgebra::Vector2;
use undrift_base::parallel;
use undrift_io::ReadError;
use undrift_nav::{Vector3, mechanisation::NavState, sample::ImuSample};
use undrift_noise::BiasModel;
use undrift_results::inspect::{Flight, Note};

/// Length of the windows of motion \[s\], and how many are needed.
const WINDOW: f64 = 1.0;
const LEAST: usize = 60;
/// Horizontal acceleration [m/s², RMS] and speed [m/s] that a test takes.
const ACCELERATES: f64 = 0.3;
const MOVES: f64 = 2.0;
/// Share of its horizontal acceleration that the accelerometers across its vertical axis feel: all on the ground and on
/// water, where the ground pushes; little in the air, where a craft accelerates by leaning.
const FELT: f64 = 0.5;
/// Speed of which wings need more, most of the time [m/s]: what hovers is no aircraft.
const WINGS: f64 = 8.0;
/// Withheld spans: the first so long after the first fix in each of two runs, from one to the next, and length \[s\].
const STARTS: [f64; 2] = [40.0, 60.0];
const EVERY: f64 = 40.0;
const LENGTH: f64 = 20.0;
/// Spans that are needed.
const SPANS: usize = 6;
/// Logarithm of the likelihood that a profile has to gain, in all and for each span.
const GAIN: (f64, f64) = (4.0, 0.2);
/// Share of the sum of squared drifts that it may have of that without it.
const DRIFT: f64 = 0.7;

/// What flies, where the fixes show it; a note where it flies and neither profile helps.
pub(super) fn found(
    inspections: &mut [Inspection],
    places: [At; 2],
    files: Files,
    motion: Motion,
) -> Option<Flight> {
    if motion.wheels == Wheels::Shown {
        return None;
    }
    let drive = accuracy::so_far(inspections, places, files, motion)?;
    let logs = Logs::load(&drive, Hindsight::Causal).ok()?;
    let (felt, fast) = leans(&logs)?;
    if felt > FELT {
        return None;
    }
    let flight = likeliest(&logs, fast);
    if flight.is_none() {
        inspections[places[0].0].found.push(Note::Flies);
    }
    flight
}

/// Position, velocity and attitude once a window, with whole fixes.
#[derive(Default)]
struct Watch(Vec<NavState>);

impl Observer for Watch {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        let nav = filter.nav();
        if self
            .0
            .last()
            .is_none_or(|last| nav.time >= last.time + WINDOW)
        {
            self.0.push(*nav);
        }
        Ok(())
    }
}

/// What [`felt`] finds of the logs.
fn leans(logs: &Logs) -> Option<(f64, bool)> {
    let settings = settings(&logs.drive, BiasModel::Arma).ok()?;
    let mut watch = Watch::default();
    let mut imu = logs.imu.iter().copied().map(Ok::<_, ReadError>);
    let mut aiding = logs.aiding.iter().copied().map(Ok::<_, ReadError>);
    replay(&mut imu, &mut aiding, &settings, &mut watch).ok()?;
    felt(&watch.0, &logs.imu)
}

/// Share of the horizontal accelerations that the accelerometers across the body's vertical axis feel, and whether it is mostly as fast
/// as wings need; `None` where it accelerates too little to show it.
fn felt(way: &[NavState], imu: &[ImuSample]) -> Option<(f64, bool)> {
    let mut samples = imu.iter().peekable();
    let (mut windows, mut fast) = (Vec::new(), 0);
    for pair in way.windows(2) {
        let (start, end) = (pair[0].time, pair[1].time);
        let mut sum = Vector3::zeros();
        while let Some(sample) = samples.next_if(|sample| sample.time <= end + 1e-6) {
            if sample.time > start + 1e-6 {
                sum += sample.dvel;
            }
        }
        let long = end - start > 1.5 * WINDOW;
        if long || pair[1].v_n.norm() < MOVES {
            continue;
        }
        fast += usize::from(pair[1].v_n.norm() > WINGS);
        let yaw = pair[1].q_nb.euler_angles().2;
        let turn = nalgebra::Rotation2::new(-yaw);
        let gained = turn * (pair[1].v_n - pair[0].v_n).xy();
        windows.push((gained / (end - start), sum.xy() / (end - start)));
    }
    if windows.len() < LEAST {
        return None;
    }
    let count = windows.len() as f64;
    let accel = windows.iter().map(|one| one.0).sum::<Vector2<f64>>() / count;
    let force = windows.iter().map(|one| one.1).sum::<Vector2<f64>>() / count;
    let (mut along, mut all) = (0.0, 0.0);
    for (a, f) in &windows {
        along += (a - accel).dot(&(f - force));
        all += (a - accel).norm_squared();
    }
    (all > ACCELERATES * ACCELERATES * count).then(|| (along / all, 2 * fast > windows.len()))
}

/// The profile under which withheld fixes are likeliest, where it gains more than chance and drifts less.
fn likeliest(logs: &Logs, fast: bool) -> Option<Flight> {
    let all = [None, Some(Flight::Copter), Some(Flight::Aircraft)];
    let crafts = if fast { &all[..] } else { &all[..2] };
    let with = |drive: &Drive, craft: Option<Flight>| match craft {
        None => drive.clone(),
        Some(Flight::Copter) => drive.clone().with_vehicle(Profile::Copter),
        Some(Flight::Aircraft) => drive.clone().with_vehicle(Profile::Aircraft),
    };
    let tried: Vec<_> = parallel::map(crafts.len(), |k| {
        let Ok(one) = settings(&with(&logs.drive, crafts[k]), BiasModel::Arma) else {
            return Vec::new();
        };
        let withheld = |start| accuracy::withheld(logs, &one, [start, EVERY, LENGTH]);
        let models: Vec<_> = STARTS.into_iter().filter_map(withheld).collect();
        accuracy::errors(run(&logs.imu, &logs.aiding, &[], &models, &|_| ()))
    });
    let judged = accuracy::judged(&tried);
    let (nothing, _) = judged.first().filter(|(one, _)| one.spans >= SPANS)?;
    let least = GAIN.0.max(GAIN.1 * nothing.spans as f64);
    let better = |one: &Judged| {
        one.likelihood - nothing.likelihood > least && one.drift < DRIFT * nothing.drift
    };
    let better = judged.iter().filter(|(one, _)| better(one));
    let (_, run) = better.max_by(|(a, _), (b, _)| a.likelihood.total_cmp(&b.likelihood))?;
    crafts[*run]
}
