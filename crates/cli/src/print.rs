//! What the verbs share in warning of their results.

use crate::terminal;
use undrift::findings::{self, Finding};

/// Notes whether a result can be trusted.
pub fn judge(found: &[Finding]) {
    if findings::is_doubtful(found) {
        terminal::doubt();
    }
}
