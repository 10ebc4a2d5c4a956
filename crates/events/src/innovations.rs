//! Sums of innovations.

#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::filter::{Outcome, Update};

/// Statistics of the innovations of one kind of measurement: whether the covariances explain how far measurements are from the
/// solution (Bar-Shalom, Li & Kirubarajan, section 5.4).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Innovations {
    /// Number of updates; rejected measurements are not among them.
    pub updates: u64,
    /// Sum of the normalised innovations squared over them [–].
    pub nis_sum: f64,
    /// Sum of their degrees of freedom: what `nis_sum` is on average when the model is right.
    pub dof_sum: u64,
    /// Number of measurements used with less weight than stated.
    pub weakened: u64,
    /// Number of measurements rejected.
    pub rejected: u64,
    /// Sums of the products of whitened innovations with those of the update before, of the squares,
    /// and their number: for their autocorrelation.
    lagged: (f64, f64, u64),
    /// Whitened innovation of the last update, if it was used.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub last: Option<[f64; 3]>,
}

impl Innovations {
    /// Counts an update, rejected ones too.
    ///
    /// ```
    /// use undrift_events::Innovations;
    /// use undrift_nav::filter::{Outcome, Update};
    /// let update = |nis, outcome| Update { nis, dof: 3, whitened: [0.0; 3], score: 0.0, information: 0.0, outcome };
    /// let mut innovations = Innovations::default();
    /// innovations.add(update(2.0, Outcome::Used));
    /// innovations.add(update(4.0, Outcome::Weakened(2.0)));
    /// innovations.add(update(500.0, Outcome::Rejected)); // Counted, but not in the sums.
    /// assert_eq!((innovations.updates, innovations.weakened, innovations.rejected), (2, 1, 1));
    /// assert_eq!((innovations.nis_sum, innovations.dof_sum), (6.0, 6));
    /// ```
    pub fn add(&mut self, update: Update) {
        match update.outcome {
            Outcome::Rejected => {
                self.rejected += 1;
                self.last = None;
                return;
            }
            Outcome::Weakened(_) => self.weakened += 1,
            Outcome::Used => {}
        }
        self.updates += 1;
        self.nis_sum += update.nis;
        self.dof_sum += update.dof as u64;
        if let Some(last) = self.last {
            for (now, before) in update.whitened.iter().zip(last) {
                self.lagged.0 += now * before;
                self.lagged.1 += 0.5 * (now * now + before * before);
            }
            self.lagged.2 += update.dof as u64;
        }
        self.last = Some(update.whitened);
    }

    /// NIS per degree of freedom: about 1 where stated and predicted covariances are right, above where they are too small. `None` without
    /// updates.
    ///
    /// ```
    /// use undrift_events::Innovations;
    /// use undrift_nav::filter::{Outcome, Update};
    /// let mut sums = Innovations::default();
    /// assert_eq!(sums.per_dof(), None);
    /// let update = Update {
    ///     nis: 12.0, dof: 3, whitened: [2.0; 3], score: 0.0, information: 1.0, outcome: Outcome::Used,
    /// };
    /// sums.add(update);
    /// assert_eq!(sums.per_dof(), Some(4.0)); // Standard deviations half of what they should be.
    /// sums.add(Update { outcome: Outcome::Rejected, ..update });
    /// assert_eq!((sums.updates, sums.rejected), (1, 1));
    /// ```
    pub fn per_dof(&self) -> Option<f64> {
        (self.dof_sum > 0).then(|| self.nis_sum / self.dof_sum as f64)
    }

    /// Autocorrelation of the whitened innovations from one update to the next [–], and the limit that it stays
    /// below 19 times out of 20 when the model is right, `1.96/√n`. Errors of fixes that last for seconds show here first.
    ///
    /// ```
    /// use undrift_events::Innovations;
    /// use undrift_nav::filter::{Outcome, Update};
    /// let update = Update { nis: 3.0, dof: 3, whitened: [1.0; 3], score: 0.0, information: 1.0, outcome: Outcome::Used };
    /// let mut sums = Innovations::default();
    /// assert_eq!(sums.autocorrelation(), None);
    /// (0..100).for_each(|_| sums.add(update)); // Always the same: an error that lasts.
    /// let (correlation, limit) = sums.autocorrelation().expect("pairs");
    /// assert!((correlation - 1.0).abs() < 1e-12 && (limit - 1.96 / (3.0 * 99.0_f64).sqrt()).abs() < 1e-12);
    /// ```
    pub fn autocorrelation(&self) -> Option<(f64, f64)> {
        let (products, squares, n) = self.lagged;
        (n > 0 && squares > 0.0).then(|| (products / squares, 1.96 / (n as f64).sqrt()))
    }
}
