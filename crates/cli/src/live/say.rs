//! Sentences of a session.

use crate::terminal::{note, warn};
use undrift::engine::Event;
use undrift_live::{Notice, Session};
use undrift_report::say;

/// The sentence of a notice.
pub fn notice(notice: &Notice) -> String {
    match notice {
        Notice::Waiting(why) => format!("waiting: {why}"),
        Notice::Ready(rate) => format!("samples at {rate:.1} Hz; waiting for an alignment"),
        Notice::ClockApart(table, by) => format!(
            "the times of {table} are of another clock than those of the IMU: by when they arrive, {by:+.3} s is added; the filter estimates what is left"
        ),
        Notice::ClockSet(table, by) => {
            format!("the clock of {table} was set: {by:+.3} s is added to its times from here on")
        }
        Notice::ReadAgain(table, why) => format!("the reader of {table} begins again here: {why}"),
        Notice::Resumed(time) => format!("goes on from the checkpoint of {time:.1} s"),
        Notice::NotResumed(why) => {
            format!("does not go on from the checkpoint but is aligned again: {why}")
        }
        Notice::Navigation(event) => say::event(event),
        Notice::Begins => "navigation begins again".into(),
    }
}

/// Prints a sentence, of a time of the logs \[s\].
pub fn print(time: Option<f64>, sentence: &str, is_warning: bool) {
    let text = match time {
        Some(time) => format!("{time:.1} s: {sentence}"),
        None => sentence.to_owned(),
    };
    match is_warning {
        true => warn(text),
        false => note(text),
    }
}

/// Factors on a standard deviation that are worth a word lie outside of this.
const USUAL: std::ops::RangeInclusive<f64> = 0.75..=1.33;

/// Whether it says something to whoever drives.
pub fn is_worth_a_word(notice: &Notice) -> bool {
    let Notice::Navigation(Event::FixErrors(_, errors)) = notice else {
        return true;
    };
    let velocity = errors.velocity_factor;
    let factors = [errors.position_factor, velocity.x, velocity.y, velocity.z];
    !factors.iter().all(|factor| USUAL.contains(factor))
}

/// Whether it is a warning.
pub fn is_warning(notice: &Notice) -> bool {
    match notice {
        Notice::Waiting(_) | Notice::Ready(_) | Notice::Resumed(_) | Notice::Begins => false,
        Notice::ClockApart(..)
        | Notice::ClockSet(..)
        | Notice::ReadAgain(..)
        | Notice::NotResumed(_) => true,
        Notice::Navigation(event) => !matches!(
            event,
            Event::Started(..) | Event::FixErrors(..) | Event::Mounting(..) | Event::Resumed(_)
        ),
    }
}

/// Why a run had no solution.
pub fn without_solution(session: &Session) -> &'static str {
    match session.navigator() {
        None => "the logs were not understood before the sources ended; see what it waited for",
        Some(_) => {
            "no alignment before the sources ended: drive straight ahead with GNSS, or state initial.heading"
        }
    }
}
