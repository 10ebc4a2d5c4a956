//! The sentence of everything that has one.

use crate::{
    demo,
    say::{self, words::worded},
};
use undrift_noise::model_file;
use undrift_results::Statement;

/// The sentences of a drive, by poses or by fixes.
pub fn sentence_of(posed: bool) -> impl Fn(Statement<'_>) -> String {
    move |of| worded(sentence(of), posed)
}

/// The sentence of what was found, for the results that are made with it.
pub fn sentence(of: Statement<'_>) -> String {
    match of {
        Statement::Finding(finding) => say::say(finding),
        Statement::Alignment(how) => say::alignment(how),
        Statement::Mounting { mounting, since } => say::mounted(mounting, since),
        Statement::Record(remark) => say::record(remark),
        Statement::Fit(remark) => say::fit(remark),
        Statement::NotFitted(why) => why.to_string(),
        Statement::Recommended(reason) => model_file::reason(reason),
        Statement::Stationarity(verdict) => say::stationarity(verdict),
        Statement::Demo(demo) => demo::conclusion(demo),
    }
}
