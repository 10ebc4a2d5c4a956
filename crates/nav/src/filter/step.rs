//! A sample's step, checked: the one place where its gap and range are judged.

use super::{Filter, FilterError};
use crate::{mechanisation::Increments, sample::ImuSample};
use core::fmt;

/// Longest interval of a sample that a step accepts \[s\]: a sample that spans a gap says nothing of the motion within it. A gap is taken by
/// [`Filter::inflate_over_gap`].
pub const LONGEST_STEP: f64 = 10.0;

/// Why a sample was refused; the filter is then unchanged, except after [`StepError::Diverged`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepError {
    /// The sample's time is not finite, or its length is not above 0 and at most [`LONGEST_STEP`].
    Invalid {
        /// End of the sample \[s\].
        time: f64,
        /// Length of the sample \[s\].
        dt: f64,
    },
    /// An increment is not finite.
    NotFinite,
    /// It does not begin at the time of the filter, to half its length: samples were lost, or came twice.
    Gap {
        /// Time of the filter \[s\].
        reached: f64,
        /// End of the sample \[s\].
        time: f64,
        /// Length of the sample \[s\].
        dt: f64,
    },
    /// The sample's increments would move the solution out of the range that [`Filter::check`] asks for.
    OutOfRange,
    /// The solution has diverged: start a new filter.
    Diverged,
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Invalid { time, dt } => write!(
                f,
                "invalid sample: dt = {dt} s at t = {time} s; dt must be above 0 and at most {LONGEST_STEP} s"
            ),
            Self::NotFinite => f.write_str("a sample has a value that is not finite"),
            Self::Gap { reached, time, .. } if time <= reached => write!(
                f,
                "time goes backwards: the filter has reached {reached} s, the sample ends at {time} s"
            ),
            Self::Gap { reached, time, dt } => write!(
                f,
                "the sample of dt = {dt} s that ends at {time} s does not begin at the time of the filter, {reached} s; \
                 to carry it across a gap pass dt = {}, or start a new filter",
                time - reached
            ),
            Self::OutOfRange => f.write_str(
                "gyro and accel would move the solution out of range: check their units, rad/s and m/s²",
            ),
            Self::Diverged => FilterError::Diverged.fmt(f),
        }
    }
}

impl core::error::Error for StepError {}

impl<const N: usize> Filter<N> {
    /// Carries the filter over one whole sample, checked as [`Filter::accepts_step`] says: the everyday call.
    /// Where a measurement falls within the sample, the same in parts: [`Filter::begin_step`],
    /// [`Filter::advance_to`] the measurement, update, and [`Filter::advance`] to 1.
    ///
    /// # Errors
    /// A sample that is refused, the filter as it was; [`StepError::Diverged`] of a solution that has ended.
    pub fn step(&mut self, sample: &ImuSample) -> Result<(), StepError> {
        self.begin_step(sample)?;
        self.advance(1.0);
        self.check().map_err(|_| StepError::Diverged)
    }

    /// Moves to the end of the sample taken up before, if it is not done, and takes up the next one, without moving
    /// into it.
    ///
    /// # Errors
    /// As [`Filter::accepts_step`]; the filter is then as it was.
    ///
    /// A fix that holds inside a sample is used at its own time:
    ///
    /// ```
    /// use undrift_nav::{Matrix3, Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// use undrift_nav::{filter::{Filter, Gate, InitialStd}, parameters::Parameters};
    /// use undrift_nav::{sample::{ImuSample, Position}, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::zeros(), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(5.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let sensors = [ShapingFilter::white(1e-3, 0.01)?; 6];
    /// # let mut filter = Filter::<9>::new(nav, &std, sensors, Parameters::none())?;
    /// # let fix = Position::Geodetic(place);
    /// filter.begin_step(&ImuSample::from_rates(0.01, 0.01, [0.0; 3], [0.0, 0.0, -9.81]))?;
    /// filter.advance_to(0.004, 1e-6); // The fix holds 4 ms into the sample.
    /// assert_eq!(filter.reached(), 0.01);
    /// let observed = filter.observe_position(&fix, &Vector3::zeros());
    /// filter.update(&observed, &Matrix3::identity(), &Gate::OPEN)?;
    /// filter.advance(1.0); // The rest of the sample.
    /// assert_eq!(filter.nav().time, 0.01);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn begin_step(&mut self, sample: &ImuSample) -> Result<(), StepError> {
        self.accepts_step(sample)?;
        self.advance(1.0);
        self.begin(sample);
        Ok(())
    }

    /// Where the next sample begins \[s\]: the end of the one taken up, or the present time.
    pub fn reached(&self) -> f64 {
        self.sample_end().unwrap_or(self.nav().time)
    }

    /// Whether a sample can be the next: its numbers are finite, it begins at the time of the filter to half its length,
    /// and the solution after it is in range as far as is seen without taking it up.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn accepts_step(&self, sample: &ImuSample) -> Result<(), StepError> {
        let &ImuSample { time, dt, .. } = sample;
        if !(dt > 0.0 && dt <= LONGEST_STEP && time.is_finite()) {
            return Err(StepError::Invalid { time, dt });
        }
        let mut increments = sample.dtheta.iter().chain(&sample.dvel);
        if !increments.all(|value| value.is_finite()) {
            return Err(StepError::NotFinite);
        }
        let reached = self.reached();
        if libm::fabs(time - dt - reached) > 0.5 * dt {
            return Err(StepError::Gap { reached, time, dt });
        }
        let mut nav = *self.nav();
        nav.step(&Increments::from_raw(
            dt,
            sample.dtheta,
            sample.dvel,
            self.previous.as_ref(),
        ));
        if !nav.is_valid() {
            return Err(StepError::OutOfRange);
        }
        Ok(())
    }
}
