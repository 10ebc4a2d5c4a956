//! Errors of fixes beyond their stated standard deviations: too small a deviation, correlation in time, positions in steps, jitter of the
//! stamps, a bias of the velocity.

#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{
    Matrix3, Vector3,
    filter::Lasting,
    parameters::{Parameter, Parameters, Prior},
    sample::GnssFix,
};

/// The time-correlated part of a position's error: a Gauss-Markov process beside white noise. Both together have the
/// variance that the fixes state.
///
/// ```
/// use undrift_events::fix_errors::{Correlated, FixErrors};
/// use undrift_nav::Matrix3;
/// // 90 % of the variance lasts for about a minute, as with multipath and atmosphere.
/// let errors = FixErrors { correlated: Some(Correlated { share: 0.9, time: 60.0 }), ..FixErrors::default() };
/// let (white, std) = errors.split(&Matrix3::from_diagonal_element(4.0)); // 2 m stated.
/// assert!((white[(0, 0)] - 0.4).abs() < 1e-12 && (std.x - 3.6_f64.sqrt()).abs() < 1e-12); // [m²], [m]
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Correlated {
    /// Share of the variance, 0 to 1 [–].
    pub share: f64,
    /// Correlation time τ \[s\]: the autocorrelation falls as `exp(−t/τ)`.
    pub time: f64,
}

impl Correlated {
    /// Prior of its state, in units of its standard deviation.
    fn prior(&self) -> Prior {
        Prior {
            time: self.time,
            ..Prior::constant(1.0)
        }
    }
}

/// Factors on standard deviations [–], beyond what the fixes show of themselves, as learned from a drive.
/// [`FixErrors::scaled`] applies them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct StdFactors {
    /// Factors on the white part of position and of velocity.
    pub white: [f64; 2],
    /// Factors on the time-correlated part of position and of velocity, where they have one.
    pub correlated: [f64; 2],
}

impl StdFactors {
    /// Changes nothing.
    pub const ONE: Self = Self {
        white: [1.0; 2],
        correlated: [1.0; 2],
    };
}

/// Whether errors of position fixes are treated as correlated in time; taken for white they make the solution far too certain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum Correlation {
    /// As the fixes show it themselves.
    #[default]
    Auto,
    /// Never: all of it is white noise.
    Off,
    /// This share and correlation time.
    Given(Correlated),
}

/// What is stated of the errors of fixes; the rest they show themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct FromFixes {
    /// Whether and how the positions' errors are correlated in time.
    pub correlation: Correlation,
    /// Factors on the standard deviations that the fixes show.
    pub factors: StdFactors,
}

impl Default for FromFixes {
    fn default() -> Self {
        Self {
            correlation: Correlation::Auto,
            factors: StdFactors::ONE,
        }
    }
}

/// Errors of fixes beyond their stated standard deviations. The default changes nothing: factors of 1, white errors.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct FixErrors {
    /// Factor on the stated standard deviations of the position [–].
    pub position_factor: f64,
    /// Factor on that of the height, beside the one of the position [–]: receivers find heights in another way.
    pub height_factor: f64,
    /// Factors on the stated standard deviations of the velocity, north, east, down [–]; of a pose the first is that of the attitude.
    pub velocity_factor: Vector3,
    /// The time-correlated part of the position's error.
    pub correlated: Option<Correlated>,
    /// The time-correlated part of the velocity's error, of a pose of the attitude's: share of the variance with the factor applied, and
    /// correlation time.
    pub velocity_correlated: Option<Correlated>,
    /// Step in which positions come, north, east, down \[m\], as of degrees rounded to six digits; 0 without.
    pub step: Vector3,
    /// Standard deviation of the stamps \[s\]: a moving antenna is elsewhere by then.
    pub jitter: f64,
    /// Bias of the velocity, measured less true, north, east, down [m/s]: it widens the covariance and is not taken out.
    pub velocity_bias: Vector3,
    /// Whether the fixes have shown these errors themselves; the covariances are then taken to be right with them.
    pub known: bool,
}

impl Default for FixErrors {
    fn default() -> Self {
        Self {
            position_factor: 1.0,
            height_factor: 1.0,
            velocity_factor: Vector3::repeat(1.0),
            correlated: None,
            velocity_correlated: None,
            step: Vector3::zeros(),
            jitter: 0.0,
            velocity_bias: Vector3::zeros(),
            known: false,
        }
    }
}

impl FixErrors {
    /// These errors with what is stated in place of what the fixes showed: the correlation where it is off or given, then the
    /// factors of [`FixErrors::scaled`].
    ///
    /// ```
    /// use undrift_events::fix_errors::{Correlated, Correlation, FixErrors, FromFixes};
    /// let shown = FixErrors { correlated: Some(Correlated { share: 0.9, time: 40.0 }), ..FixErrors::default() };
    /// let white = FromFixes { correlation: Correlation::Off, ..FromFixes::default() };
    /// assert!(shown.under(&white).correlated.is_none());
    /// assert_eq!(shown.under(&FromFixes::default()), shown); // Nothing is stated: as shown.
    /// ```
    pub fn under(mut self, stated: &FromFixes) -> Self {
        match stated.correlation {
            Correlation::Auto => {}
            Correlation::Off => self.correlated = None,
            Correlation::Given(given) => self.correlated = Some(given),
        }
        self.scaled(&stated.factors)
    }

    /// Factors on the standard deviations of the position, north, east, down.
    fn position_factors(&self) -> Vector3 {
        self.position_factor * Vector3::new(1.0, 1.0, self.height_factor)
    }

    /// What a filter estimates of the lasting parts of position and velocity, whose fixes were taken to be wrong by `before`
    /// and state `position` \[m²\].
    pub fn lasting(&self, before: &Self, position: &Matrix3) -> [Option<Lasting>; 2] {
        let parts = [
            (
                self.correlated,
                self.position_factors(),
                before.correlated,
                before.position_factors(),
            ),
            (
                self.velocity_correlated,
                self.velocity_factor,
                before.velocity_correlated,
                before.velocity_factor,
            ),
        ];
        let shared = [self.split(position).1, Vector3::zeros()];
        let std = |part: Correlated, factor: Vector3| factor * part.share.sqrt();
        core::array::from_fn(|k| {
            let (part, factor, was, before) = parts[k];
            part.map(|part| Lasting {
                prior: part.prior(),
                grown: was.map_or(Vector3::repeat(1.0), |was| {
                    std(part, factor).component_div(&std(was, before))
                }),
                shared: shared[k],
            })
        })
    }

    /// The fix with covariances that cover these errors: the stated ones times the factors, a step's uniform error (step²/12), the
    /// velocity's bias as if it were random, and along the velocity what it moves within the jitter of the stamps. The
    /// time-correlated parts are within the stated variance and change nothing here.
    ///
    /// ```
    /// use undrift_events::fix_errors::FixErrors;
    /// use undrift_nav::{Vector3, earth::Geodetic, sample::GnssFix};
    /// let place = Geodetic::from_degrees(45.0, 7.0, 300.0);
    /// let fix = GnssFix::at(0.0, place, [1.0; 3]).with_velocity([20.0, 0.0, 0.0], [0.1; 3]);
    /// let errors = FixErrors { position_factor: 2.0, jitter: 0.05, ..FixErrors::default() };
    /// let (_, covariance) = errors.apply(&fix).position.expect("as before");
    /// assert!((covariance[(0, 0)] - (4.0 + 1.0)).abs() < 1e-12, "north: 2 m, and 20 m/s for 0.05 s");
    /// assert!((covariance[(1, 1)] - 4.0).abs() < 1e-12, "east");
    /// ```
    pub fn apply(&self, fix: &GnssFix) -> GnssFix {
        let mut fix = *fix;
        let velocity = fix.velocity.map(|(v, _)| v);
        if let Some((_, covariance)) = &mut fix.velocity {
            *covariance = covariance
                .component_mul(&(self.velocity_factor * self.velocity_factor.transpose()));
            *covariance += self.velocity_bias * self.velocity_bias.transpose();
        }
        if let Some((_, covariance)) = &mut fix.attitude {
            let factor = self.velocity_factor.x;
            *covariance *= factor * factor;
        }
        if let Some((_, covariance)) = &mut fix.position {
            let factors = self.position_factors();
            *covariance = covariance.component_mul(&(factors * factors.transpose()));
            // Of a value rounded to steps the error is uniform.
            *covariance += Matrix3::from_diagonal(&self.step.map(|step| step * step / 12.0));
            if let Some(v) = velocity {
                *covariance += v * v.transpose() * (self.jitter * self.jitter);
            }
        }
        fix
    }

    /// These errors with the standard deviations of their white and correlated parts multiplied by the factors; shares change
    /// accordingly.
    ///
    /// ```
    /// use undrift_events::fix_errors::{Correlated, FixErrors, StdFactors};
    /// let correlated = Some(Correlated { share: 0.5, time: 60.0 });
    /// let errors = FixErrors { correlated, ..FixErrors::default() };
    /// // Twice the white part: four parts of the variance against one.
    /// let louder = errors.scaled(&StdFactors { white: [2.0, 1.0], ..StdFactors::ONE });
    /// assert!((louder.correlated.expect("as before").share - 0.2).abs() < 1e-12);
    /// assert!((louder.position_factor - 2.5_f64.sqrt()).abs() < 1e-12);
    /// ```
    pub fn scaled(&self, factors: &StdFactors) -> Self {
        let mut errors = *self;
        let parts = [&mut errors.correlated, &mut errors.velocity_correlated];
        let mut grown = [1.0; 2];
        for (k, part) in parts.into_iter().enumerate() {
            let share = part.map_or(0.0, |part| part.share);
            let white = (1.0 - share) * factors.white[k] * factors.white[k];
            let correlated = share * factors.correlated[k] * factors.correlated[k];
            grown[k] = (white + correlated).sqrt();
            if let Some(part) = part {
                part.share = correlated / (white + correlated);
            }
        }
        errors.position_factor *= grown[0];
        errors.velocity_factor *= grown[1];
        errors
    }

    /// `parameters` with the states that the time-correlated parts need: [`Parameter::PositionError`] and [`Parameter::VelocityError`].
    ///
    /// ```
    /// use undrift_events::fix_errors::{Correlated, FixErrors};
    /// use undrift_nav::parameters::{Parameter, Parameters};
    /// let errors = FixErrors { correlated: Some(Correlated { share: 0.9, time: 40.0 }), ..FixErrors::default() };
    /// let parameters = errors.with_states(Parameters::none());
    /// assert_eq!(parameters.states(), 3); // Of the positions, north, east, down.
    /// assert_eq!(parameters.prior(Parameter::PositionError).map(|prior| prior.time), Some(40.0)); // [s]
    /// ```
    pub fn with_states(&self, mut parameters: Parameters) -> Parameters {
        for (kind, part) in [
            (Parameter::PositionError, self.correlated),
            (Parameter::VelocityError, self.velocity_correlated),
        ] {
            if let Some(part) = part {
                parameters = parameters.with(kind, part.prior());
            }
        }
        parameters
    }

    /// White part of a position's `covariance` \[m²\], and the standard deviation of the correlated part, axis by axis \[m\].
    ///
    /// ```
    /// use undrift_events::fix_errors::{Correlated, FixErrors};
    /// use undrift_nav::Matrix3;
    /// // 2 m of standard deviation, three quarters of the variance lasting: 1 m is white, √3 m lasts.
    /// let errors = FixErrors { correlated: Some(Correlated { share: 0.75, time: 60.0 }), ..FixErrors::default() };
    /// let (white, correlated) = errors.split(&(Matrix3::identity() * 4.0));
    /// assert_eq!((white[(0, 0)], correlated.x), (1.0, 3f64.sqrt()));
    /// ```
    pub fn split(&self, covariance: &Matrix3) -> (Matrix3, Vector3) {
        split(self.correlated, covariance)
    }

    /// White part of a velocity's `covariance` [m²/s²], or a pose's attitude's \[rad²\], and the standard deviation of the correlated part, axis
    /// by axis [m/s, rad].
    pub fn split_velocity(&self, covariance: &Matrix3) -> (Matrix3, Vector3) {
        split(self.velocity_correlated, covariance)
    }

    /// Standard deviations of the correlated parts of a position \[m\] and a velocity [m/s], from their covariances, axis by axis.
    pub fn correlated_std(&self, position: &Matrix3, velocity: &Matrix3) -> [Vector3; 2] {
        [self.split(position).1, self.split_velocity(velocity).1]
    }
}

/// Without a correlated part all of it is white. Correlations between axes are shared in
/// proportion.
fn split(correlated: Option<Correlated>, covariance: &Matrix3) -> (Matrix3, Vector3) {
    let share = correlated.map_or(0.0, |correlated| correlated.share);
    let std = covariance.diagonal().map(|r| (share * r).max(0.0).sqrt());
    (covariance * (1.0 - share), std)
}

#[cfg(test)]
mod tests;
