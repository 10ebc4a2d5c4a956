//! What a run finds out about its logs and its solution: how the findings are collected. What they are, and how much they
//! weigh, is [`undrift_results::findings`].

mod axes;
mod collect;
mod tuned;

pub use axes::of_axes;
pub use collect::{
    WITHOUT_GNSS, of_accuracy, of_correlation, of_disagreement, of_ends, of_fixes, of_health,
    of_order, of_rate, of_sensor, of_skipped, of_temperature, of_timing, too_slow, with_axes,
    with_rate,
};
pub use tuned::{IN_VEHICLE, is_tuned, of_model};
pub use undrift_results::findings::{
    Finding, LeftOut, Log, LogEnd, NoError, Severity, TemperatureUse, WhyLeftOut, is_doubtful,
    is_jump, ranked, verdict,
};
