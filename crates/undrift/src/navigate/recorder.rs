//! What is kept of a run while it goes: files, errors against the truth, curves.

use super::{Outputs, Recording, solution_row};
use crate::{
    consistency::{Consistency, ErrorState},
    reference::{COMPONENTS, Errors, TruthCursor},
    replay::{Observer, ReplayError},
    smooth::History,
};
use undrift_io::{ReadError, truth::TruthReader, write::solution::SolutionRow};
use undrift_nav::{
    covariance::{AXES, NAV},
    filter::{Filter, Update},
    mechanisation::NavState,
    sample::{GnssFix, TruthSample},
    tape::Tape,
};

/// From one NEES to the next [s].
const NEES_SPAN: f64 = 1.0;

/// A truth reader that ends at its first error and keeps it.
pub(super) struct Readable {
    pub(super) reader: TruthReader,
    pub(super) error: Option<ReadError>,
    /// First and last time [s].
    pub(super) read: Option<(f64, f64)>,
}

impl Iterator for Readable {
    type Item = TruthSample;

    fn next(&mut self) -> Option<TruthSample> {
        match self.reader.next()? {
            Ok(sample) => {
                let start = self.read.map_or(sample.time, |(start, _)| start);
                self.read = Some((start, sample.time));
                Some(sample)
            }
            Err(e) => {
                self.error = Some(e);
                None
            }
        }
    }
}

pub(super) struct Recorder {
    pub(super) outputs: Outputs,
    pub(super) truth: Option<TruthCursor<Readable>>,
    pub(super) squares: [f64; COMPONENTS.len()],
    pub(super) compared: u64,
    /// While the filter runs for a smoother.
    pub(super) history: Option<History>,
    /// Of the filter's errors against its covariance, and when next [s].
    pub(super) consistency: Consistency,
    pub(super) next_nees: f64,
    /// Where they are asked for.
    pub(super) recording: Option<Box<Recording>>,
    pub(super) rows: Option<Vec<SolutionRow>>,
}

impl Recorder {
    pub(super) fn record(
        &mut self,
        nav: &NavState,
        nav_std: [f64; NAV],
        e: [f64; AXES],
        error_std: [f64; AXES],
    ) -> Result<Option<TruthSample>, ReplayError> {
        let truth = self.truth.as_mut().and_then(|t| t.at(nav.time));
        if let Some(truth) = &truth {
            let errors = Errors::against_truth(nav, truth);
            for (sum, e) in self.squares.iter_mut().zip(errors.0) {
                *sum += e * e;
            }
            self.compared += 1;
            if let Some(recording) = &mut self.recording {
                recording.errors(nav.time, &errors);
            }
        }
        if !self.outputs.is_empty() || self.recording.is_some() || self.rows.is_some() {
            let row = solution_row(nav, nav_std, e, error_std);
            self.outputs.write(&row)?;
            if let Some(recording) = &mut self.recording {
                recording.solution(&row);
            }
            if let Some(rows) = &mut self.rows {
                rows.push(row);
            }
        }
        Ok(truth)
    }
}

impl Observer for Recorder {
    fn sample<const N: usize>(&mut self, filter: &Filter<N>) -> Result<(), ReplayError> {
        if self.history.is_some() {
            self.outputs.begin(filter.nav().time);
            return Ok(());
        }
        let truth = self.record(
            filter.nav(),
            filter.nav_std(),
            filter.sensor_error(),
            filter.sensor_error_std(),
        )?;
        if let Some(truth) = truth.filter(|truth| truth.time >= self.next_nees) {
            self.next_nees = truth.time + NEES_SPAN;
            self.consistency.add(&ErrorState::new(filter, &truth, None));
        }
        Ok(())
    }

    fn used(&mut self, time: f64) {
        self.outputs.fix(time);
    }

    fn node<const N: usize>(
        &mut self,
        filter: &Filter<N>,
        since: Option<&Tape<N>>,
    ) -> Result<(), ReplayError> {
        if let Some(history) = &mut self.history {
            history.push(filter, since)?;
        }
        Ok(())
    }

    fn fix<const N: usize>(&mut self, _: &Filter<N>, _: &GnssFix, _: bool) {}

    fn updated(&mut self, time: f64, updates: [Option<Update>; 2]) {
        if let Some(recording) = &mut self.recording {
            recording.fix(time, updates);
        }
    }
}
