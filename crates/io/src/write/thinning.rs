//! Thinning of a solution's rows, for the writers of files here and the outputs of live runs (Foxglove, ROS 2).

/// Lets the first row of each cell of a grid in time through; two such rows may be closer than a cell is long.
#[derive(Debug)]
pub struct Thinning {
    every: f64,
    last: Option<i64>,
}

impl Thinning {
    /// `every` \[s\]; 0 lets all through.
    pub fn new(every: f64) -> Self {
        Self { every, last: None }
    }

    /// Whether the row at `time` \[s\] is the first of its cell.
    pub fn takes(&mut self, time: f64) -> bool {
        // A millionth of a cell: stamps on the grid stay in their cell when divided.
        let cell = (time / self.every + 1e-6).floor() as i64;
        self.every == 0.0 || self.last.replace(cell) != Some(cell)
    }
}
