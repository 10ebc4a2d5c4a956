//! Lasting errors of the fixes, estimated from some time on.

use crate::values::near;
