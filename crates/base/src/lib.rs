//! What the computations of undrift share and no subject owns: [`order_statistics`], the [`number`]s of results, [`hash`]es, work on all
//! cores ([`parallel`]), stopping it from outside ([`interrupt`]), and names near a misspelt one ([`nearby`]). It knows no sensor, no log and no result.

pub mod hash;
pub mod interrupt;
pub mod nearby;
pub mod number;
pub mod order_statistics;
pub mod parallel;
