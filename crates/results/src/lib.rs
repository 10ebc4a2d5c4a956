//! The one shape of every result: plain structs, written as JSON under one head,
//! `{"undrift": version, "kind": "navigate", "schema": 1, …}`, and read back from it. Filled from what
//! the verbs found; tables, reports, fleets and other languages read these and nothing else.
//!
//! What is missing in a file that is read stays empty; a number that is null is NaN.

mod any;
mod curve;
pub mod demo;
mod drive;
pub mod error_state;
mod errors;
pub mod findings;
mod fleet;
mod identify;
pub mod inspect;
mod keyed;
mod known;
mod lead;
mod montecarlo;
mod navigate;
mod number;
mod outages;
pub mod recording;
mod say;
pub mod series;
mod text;
mod tune;
pub mod usability;

pub use any::{ReportFiles, Results};
pub use curve::{Curve, Track};
pub use demo::{
    CutLength, Demo, DemoModel, Estimate, OneOne, Paper, PaperSolution, PooledErrors, ScanPoint,
};
pub use drive::{Drive, Start, name, names, parts_used};
pub use errors::COMPONENTS;
pub use findings::Finding;
pub use fleet::{
    Bin, Effect, Fleet, FleetEffects, FleetGroup, FleetLabel, FleetLog, FleetMeasure, FleetOutlier,
    FleetPart, LeftOut, Level, Slope, Trouble, Warned,
};
pub use identify::{
    Adf, Allan, ArmaOrigin, Axis, AxisDoubt, AxisPool, AxisSeries, AxisTemperature, BoxJenkins,
    Candidate, Differing, GridFit, Histogram, Identify, NotFitted, Omission, Omitted, Order,
    OrderRow, OrderTest, Origin, PanditWuOrders, ParameterInterval, Pool, PooledRecord, Psd,
    RecordShare, Residuals, TurnOn, Used,
};
pub use keyed::{Key, Keyed};
pub use known::{known_finding, known_findings};
pub use lead::is_clear_lead;
pub use montecarlo::{Group, MonteCarlo, MonteCarloDrive, MonteCarloModel, NisKind, Verdict};
pub use navigate::{
    FixErrors, Fixes, Navigate, NavigateSeries, Nis, Parameter, StdFactors, Summary,
};
pub use number::{Number, Numbers, by_name, numbers};
pub use outages::{
    Cut, Drift, LeftOutCut, ModelErrors, NisOfParts, NoiseModelRun, OutageErrors, OutageSeries,
    Outages,
};
pub use say::{Say, Statement};
pub use text::text;
pub use tune::{Tune, TunedAxes, TunedDrift, TunedNees, TunedParameter, TunedVibration};
pub use usability::Usability;

pub use undrift_noise::{allan::Term, identify::Detrend};

pub use undrift_events::{Aid, ScalarLog};

pub use undrift_events::{
    Contradiction, CovarianceHealth, Implausible, Innovations, Lean, Part, Restart,
};

/// Version of the schema of results.
pub const SCHEMA: u32 = 1;

/// Version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
