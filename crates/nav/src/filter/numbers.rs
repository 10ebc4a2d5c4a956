//! A filter as numbers: to keep one, and to go on with it elsewhere.

use super::Filter;
use crate::{
    Quaternion, Vector3,
    mechanisation::{Increments, RawIncrements},
    parameters::Coupling,
    shaping::ShapingFilter,
};

/// Called with each number of a filter in turn; it may read the number or replace it.
pub type Each<'a> = dyn FnMut(&mut f64) + 'a;

impl<const N: usize> Filter<N> {
    /// Calls `each` with every number that changes while the filter runs, always in the same order: to store them, or to put stored
    /// ones into a filter of the same models and parameters, which then continues as the first would have.
    ///
    /// ```
    /// use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, sample::ImuSample, shaping::ShapingFilter};
    /// # let nav = NavState {
    /// #     time: 0.0, position: Geodetic::from_degrees(47.0, 8.0, 400.0), v_n: Vector3::zeros(), q_nb: Quaternion::identity(),
    /// # };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(1.0), attitude: Vector3::repeat(0.1) };
    /// let sensors = [ShapingFilter::white(1e-3, 0.01)?; 6];
    /// let mut first = Filter::<9>::new(nav, &std, sensors, Parameters::none())?;
    /// let mut second = first.clone();
    /// first.step(&ImuSample::from_rates(0.01, 0.01, [0.0; 3], [0.0, 0.0, -9.8]))?;
    ///
    /// let mut kept = Vec::new();
    /// first.numbers(&mut |number| kept.push(*number));
    /// let mut next = kept.into_iter();
    /// second.numbers(&mut |number| *number = next.next().unwrap());
    /// assert_eq!(second.nav(), first.nav());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn numbers(&mut self, each: &mut Each) {
        each(&mut self.nav.time);
        each(&mut self.nav.position.lat);
        each(&mut self.nav.position.lon);
        each(&mut self.nav.position.height);
        vector(&mut self.nav.v_n, each);
        let mut q = *self.nav.q_nb.quaternion();
        q.coords.iter_mut().for_each(&mut *each);
        self.nav.q_nb = Quaternion::new_unchecked(q);
        self.c_nb.iter_mut().for_each(&mut *each);
        self.x.iter_mut().for_each(&mut *each);
        self.p.iter_mut().for_each(&mut *each);
        let mut before = self.previous.unwrap_or(RawIncrements {
            dt: 0.0,
            dtheta: Vector3::zeros(),
            dvel: Vector3::zeros(),
        });
        let there = flag(self.previous.is_some(), each);
        each(&mut before.dt);
        vector(&mut before.dtheta, each);
        vector(&mut before.dvel, each);
        self.previous = there.then_some(before);
        let (mut now, mut done) = self.current.unwrap_or((
            Increments {
                dt: 0.0,
                rotation: Vector3::zeros(),
                dvel: Vector3::zeros(),
            },
            0.0,
        ));
        let there = flag(self.current.is_some(), each);
        each(&mut now.dt);
        vector(&mut now.rotation, each);
        vector(&mut now.dvel, each);
        each(&mut done);
        self.current = there.then_some((now, done));
        each(&mut self.end);
        vector(&mut self.omega_ib_b, each);
        vector(&mut self.force_b, each);
        vector(&mut self.slow_force, each);
        self.slow
            .iter_mut()
            .for_each(|slow| vector(slow, &mut *each));
        if self.coupling.is_none() {
            // As of a sample of zeros: the same, with all its places.
            let behind = self.sensors.states();
            let zeros = Vector3::zeros();
            self.coupling = Coupling::new(&self.parameters, behind, [&zeros; 3]);
        }
        self.coupling.factors(each);
        each(&mut self.start);
        self.turns = flag(self.turns, each);
    }
}

impl ShapingFilter {
    /// Calls `each` with every number of the model, order and interval first, always in the same order.
    pub fn numbers(&mut self, each: &mut Each) {
        let mut order = self.order as f64;
        each(&mut order);
        self.order = order as usize;
        each(&mut self.interval);
        let matrices = self.f.iter_mut().chain(&mut self.q).chain(&mut self.p0);
        matrices.flatten().for_each(&mut *each);
        self.h.iter_mut().chain(&mut self.s).for_each(&mut *each);
        each(&mut self.r);
    }
}

fn vector(of: &mut Vector3, each: &mut Each) {
    of.iter_mut().for_each(each);
}

/// Whether something is there, as a number: 1 if so.
fn flag(there: bool, each: &mut Each) -> bool {
    let mut number = f64::from(u8::from(there));
    each(&mut number);
    number != 0.0
}
