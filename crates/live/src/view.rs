//! What shows the solution in its own way rather than as rows of a format: the page, Foxglove, what a program brings along.

use undrift_io::{epoch::Epoch, write::solution::SolutionRow};

/// Shows the solution while it is made. A viewer that is slow, or gone, delays nothing.
pub trait View {
    /// Rows follow, whose times count from `epoch` where that is known.
    fn ready(&mut self, epoch: Option<Epoch>);

    /// Shows a row, whose newest fix is so much older \[s\].
    fn row(&mut self, row: &SolutionRow, since_fix: Option<f64>);

    /// Shows a sentence, of a time of the solution \[s\] where it has one.
    fn notice(&mut self, time: Option<f64>, sentence: &str, is_warning: bool);

    /// How many rows were not taken in time.
    fn dropped(&self) -> u64;
}
