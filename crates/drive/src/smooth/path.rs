//! The smoothed solution between the nodes.

use super::{Node, Smoothed};
use undrift_nav::{
    Vector3,
    mechanisation::{Increments, NavState, RawIncrements},
    parameters::jerk,
    sample::ImuSample,
};

/// Times closer than this \[s\] are the same.
const SAME: f64 = 1e-6;

/// The smoothed solution at every sample, from the nodes and a second pass over the log: between two nodes the samples are integrated
/// from the first, and the difference at the second is spread over the span.
pub struct Path<'a> {
    smoothed: &'a Smoothed,
    /// The node that the present span starts at.
    node: usize,
    /// Integrated from there.
    nav: NavState,
    previous: Option<RawIncrements>,
    /// What the low-pass of [`jerk`] keeps [m/s²].
    slow_force: Option<Vector3>,
    /// Ends of the samples of the span so far.
    pending: Vec<NavState>,
}

impl<'a> Path<'a> {
    /// Starts at the first node; `None` without nodes.
    pub fn new(smoothed: &'a Smoothed) -> Option<Self> {
        Some(Self {
            nav: smoothed.nodes.first()?.nav,
            smoothed,
            node: 0,
            previous: None,
            slow_force: None,
            pending: Vec::new(),
        })
    }

    /// Adds the next sample; gives `out` the solution at the ends of all samples that a node now
    /// closes, in order, as a node of its own.
    ///
    /// # Errors
    /// What `out` returns.
    pub fn add<E>(
        &mut self,
        sample: &ImuSample,
        mut out: impl FnMut(Node) -> Result<(), E>,
    ) -> Result<(), E> {
        let raw = RawIncrements {
            dt: sample.dt,
            dtheta: sample.dtheta,
            dvel: sample.dvel,
        };
        let previous = self.previous.replace(raw);
        let force = sample.dvel / sample.dt;
        let jerk = jerk(self.slow_force.get_or_insert(force), &force, sample.dt);
        while self.nav.time < sample.time - SAME {
            let Some(next) = self.smoothed.nodes.get(self.node + 1) else {
                return Ok(());
            };
            let error = self
                .smoothed
                .sensor_error(&self.smoothed.nodes[self.node], sample, &jerk);
            let less = |raw: RawIncrements| RawIncrements {
                dt: raw.dt,
                dtheta: raw.dtheta - Vector3::new(error[0], error[1], error[2]) * raw.dt,
                dvel: raw.dvel - Vector3::new(error[3], error[4], error[5]) * raw.dt,
            };
            let now = less(raw);
            let whole =
                Increments::from_raw(now.dt, now.dtheta, now.dvel, previous.map(less).as_ref());
            let until = if next.nav.time < sample.time - SAME {
                next.nav.time
            } else {
                sample.time
            };
            let from = self.nav.time.max(sample.time - sample.dt);
            self.nav
                .step(&whole.part(((until - from) / sample.dt).max(0.0)));
            self.nav.time = until;
            if until == sample.time {
                self.pending.push(self.nav);
            }
            if until >= next.nav.time - SAME {
                self.close(&mut out)?;
            }
        }
        Ok(())
    }

    /// The next node is reached: what is missing there is spread over the span.
    fn close<E>(&mut self, out: &mut impl FnMut(Node) -> Result<(), E>) -> Result<(), E> {
        let (from, to) = (
            &self.smoothed.nodes[self.node],
            &self.smoothed.nodes[self.node + 1],
        );
        let dr = to.nav.position.offset_to(&self.nav.position);
        let dv = self.nav.v_n - to.nav.v_n;
        let psi = -(self.nav.q_nb * to.nav.q_nb.inverse()).scaled_axis();
        let span = (to.nav.time - from.nav.time).max(SAME);
        for nav in self.pending.drain(..) {
            let w = ((nav.time - from.nav.time) / span).clamp(0.0, 1.0);
            let mix = |a: f64, b: f64| a + w * (b - a);
            // The cubic with the right value and slope at both ends.
            let drift = dr * (w * w * (3.0 - 2.0 * w)) + dv * (span * w * w * (w - 1.0));
            out(Node {
                nav: nav.without_error(&drift, &(dv * w), &(psi * w)),
                nav_std: core::array::from_fn(|i| mix(from.nav_std[i], to.nav_std[i])),
                q_bv: to.q_bv,
                vehicle_std: core::array::from_fn(|i| mix(from.vehicle_std[i], to.vehicle_std[i])),
                predicted: to.predicted,
                estimates: from
                    .estimates
                    .iter()
                    .zip(&to.estimates)
                    .map(|(a, b)| mix(*a, *b))
                    .collect(),
                sensor_error: core::array::from_fn(|i| {
                    mix(from.sensor_error[i], to.sensor_error[i])
                }),
                sensor_error_std: core::array::from_fn(|i| {
                    mix(from.sensor_error_std[i], to.sensor_error_std[i])
                }),
                omega_nb_b: from.omega_nb_b,
                late: 0.0,
                receiver_clock: to.receiver_clock,
            })?;
        }
        self.nav = to.nav;
        self.node += 1;
        Ok(())
    }
}
