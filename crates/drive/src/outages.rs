//! The experiment: GNSS cut many times on one drive, each bias model run through it, the drift
//! reported as in the source paper's Table 4.
//!
//! ```
//! # use undrift_drive as undrift;
//! use undrift::{BiasModel, Drive, ImuModel, Logs, Schedule, navigate::Hindsight, reference::HORIZONTAL};
//! # use undrift_simulate::{GnssNoise, Trajectory, simulate};
//! # let model = ImuModel::preset("adis16465").ok_or("no such preset")?;
//! # let noise = model.shaping(BiasModel::GaussMarkov, 0.02)?;
//! # let log = simulate(&Trajectory::car(200.0, 1), 50.0, Some(&noise), &GnssNoise::default(), 1)?;
//! # let (imu, fixes) = (&log.imu, &log.gnss);
//!
//! let drive = Drive {
//!     model: ImuModel::preset("adis16465"),
//!     ..Drive::from_samples(imu, fixes)
//! };
//! let logs = Logs::load(&drive, Hindsight::Causal)?;
//! // Two outages of 10 s after the first two minutes. Without a truth the withheld fixes are the reference.
//! let cuts = logs.plan(&Schedule::Count { start: 120.0, count: 2 }, 10.0)?;
//! let models = [BiasModel::White, BiasModel::Arma];
//! for (name, run) in logs.run(&models, &cuts, Hindsight::Causal, &|_| ())?.runs {
//!     println!("{name}: {:.2} m", run?.errors.rms.0[HORIZONTAL]);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod compared;
mod drift;
mod errors;
mod experiment;
mod findings;
mod left_out;
mod logs;
mod result;
mod run;
mod schedule;

pub use crate::rejected::{Reference, Rejected, withheld};
pub use compared::ComparedModel;
pub use drift::drift_curve;
pub use errors::{ModelErrors, ModelOutcome, ModelRun, OutageErrors};
pub use experiment::{Experiment, UNCUT};
pub use left_out::WhyLeftOut;
pub use logs::Logs;
pub use result::{result, thinned_track, track};
pub use run::{run, run_against};
pub use schedule::{FIRST, Schedule, ScheduleError, schedule};
pub use undrift_results::is_clear_lead;

use undrift_noise::BiasModel;

/// The models that are compared on a drive by default: white noise alone and the source paper's form are
/// for experiments.
pub const USUAL_MODELS: [BiasModel; 4] = [
    BiasModel::GaussMarkov,
    BiasModel::RandomWalk,
    BiasModel::Ar,
    BiasModel::Arma,
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replay::Outage;

    #[test]
    fn schedules() {
        let every = Schedule::Every {
            start: 60.0,
            every: 24.0,
            count: Some(15),
        };
        let error = |plan: &Schedule, last| schedule(plan, 10.0, 0.0, last).unwrap_err();
        let outages = schedule(&every, 10.0, 0.0, 437.2).unwrap();
        assert_eq!(outages.len(), 15);
        assert_eq!(
            outages[14],
            Outage {
                start: 396.0,
                end: 406.0
            }
        );
        let count = Schedule::Count {
            start: 60.0,
            count: 15,
        };
        let outages = schedule(&count, 10.0, 100.0, 700.0).unwrap();
        assert_eq!((outages[0].start, outages[14].end), (160.0, 700.0));
        let too_many = Schedule::Every {
            start: 60.0,
            every: 24.0,
            count: Some(17),
        };
        assert_eq!(
            error(&too_many, 437.2),
            ScheduleError::TooFew {
                fits: 16,
                count: 17
            }
        );
        assert!(schedule(&Schedule::At(vec![5.0, 8.0]), 10.0, 0.0, 100.0).is_err());
        assert!(schedule(&Schedule::At(vec![95.0]), 10.0, 0.0, 100.0).is_err());
        assert!(schedule(&Schedule::At(vec![f64::NAN]), 10.0, 0.0, 100.0).is_err());
        assert!(schedule(&count, 0.0, 0.0, 100.0).is_err());
        for start in [f64::NAN, f64::INFINITY, -1.0] {
            let late = Schedule::Every {
                start,
                every: 24.0,
                count: None,
            };
            assert!(schedule(&late, 10.0, 0.0, 100.0).is_err());
        }
        // So many that they would not fit into memory either.
        let dense = Schedule::Every {
            start: 0.0,
            every: 1e-300,
            count: None,
        };
        assert_eq!(
            error(&dense, 100.0),
            ScheduleError::Overlap {
                count: usize::MAX,
                length: 10.0
            }
        );
        let dense = Schedule::Count {
            start: 0.0,
            count: usize::MAX,
        };
        assert_eq!(error(&dense, 100.0), ScheduleError::TooMany);
        let dense = Schedule::Count {
            start: 0.0,
            count: 12,
        };
        assert_eq!(
            error(&dense, 100.0),
            ScheduleError::Overlap {
                count: 12,
                length: 10.0
            }
        );
        let none = Schedule::Every {
            start: 0.0,
            every: 20.0,
            count: Some(0),
        };
        assert!(schedule(&none, 10.0, 0.0, 100.0).is_err());
    }

    #[test]
    fn an_outage_is_open_at_its_start_and_closed_at_its_end() {
        let outage = Outage {
            start: 100.0,
            end: 110.0,
        };
        assert!(!outage.contains(100.0) && outage.contains(100.2));
        assert!(outage.contains(110.0) && !outage.contains(110.2));
    }
}
