//! A filter as numbers: to keep one, and to go on with it elsewhere.

use super::Filter;
use crate::{
    Quaternion, Vector3,
    mechanisation::{Increments, RawIncrements},
    parameters::Coupling,
    shaping::ShapingFilter,
};

/// What is called with each number; it may change it.
pub type Each<'a> = dyn FnMut(&mut f64) + 'a;

impl<const N: usize> Filter<N> {
    /// Calls `each` with every number that changes while the filter runs, always in the same order: it keeps them, or puts
    /// kept ones in place in a filter of the same models and parameters, which then goes on as the other would.
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
        if self.coupling.is_none() {
            // As of a sample of zeros: the same, with all its places.
            let behind = self.sensors.states();
            let zeros = Vector3::zeros();
            self.coupling = Coupling::new(&self.parameters, behind, [&zeros; 3]);
        }
        self.coupling.factors(each);
        each(&mut self.start);
    }
}

impl ShapingFilter {
    /// Calls `each` with every number of the filter, always in the same order.
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
