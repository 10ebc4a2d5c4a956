//! Body axes that turn: a filter of the sensor's axes goes on in those of the vehicle.
//!
//! Position, velocity and misalignment are of the navigation frame and stay. What is a vector of the body turns with
//! it: `ε_v = C_b^v ε_b`, state by state where the three axes of a triad have states of one meaning (order and output
//! vector). Scale factors and misalignment of the sensor axes are a matrix M, `ε = M u`, which becomes `C M Cᵀ`.

use super::Filter;
use crate::{
    Quaternion, Vector3,
    parameters::{Coupling, Parameter, jerk},
    shaping::MAX_ORDER,
};

/// Elements of the matrix of scale factors and misalignment, as (row, column).
const ELEMENTS: [(usize, usize); 9] = [
    (0, 0),
    (1, 1),
    (2, 2),
    (0, 1),
    (0, 2),
    (1, 0),
    (1, 2),
    (2, 0),
    (2, 1),
];

impl<const N: usize> Filter<N> {
    /// Turns the body axes: `q_vb` takes the axes so far to those from now on. The solution stays the same one, in other
    /// axes, and so does its covariance, with two exceptions. A triad whose axes have states of another meaning keeps its
    /// estimated errors, but not what is known of them: their covariance is that before the first sample. Elements of the
    /// matrix of scale factors and misalignment that are no states are lost, and those that are get their share of
    /// the prior's variance again.
    ///
    /// To be called between samples; a [`Tape`](crate::tape::Tape) does not know of it.
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, attitude, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::zeros(), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let mut filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// // The IMU turns out to sit in the vehicle with its forward axis 90° to the right of the vehicle's.
    /// let q_vb = attitude::from_rpy(&Vector3::new(0.0, 0.0, 90f64.to_radians()));
    /// let before = *filter.nav();
    /// filter.turn(&q_vb);
    /// // Forward of the vehicle is what was left of the sensor.
    /// let forward = filter.nav().q_nb * Vector3::x();
    /// assert!((forward - before.q_nb * -Vector3::y()).norm() < 1e-12 && filter.nav().position == before.position);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn turn(&mut self, q_vb: &Quaternion) {
        let c = q_vb.to_rotation_matrix().into_inner();
        let raw = self.readings();
        self.nav.q_nb *= q_vb.inverse();
        self.nav.q_nb.renormalize();
        self.c_nb = self.nav.q_nb.to_rotation_matrix().into_inner();
        for triad in [0, 3] {
            let axes =
                [0, 1, 2].map(|i| (*self.sensors.axis(triad + i), self.sensors.start(triad + i)));
            let order = axes[0].0.order;
            let alike = |i: usize| axes[i].0.order == order && axes[i].0.h == axes[0].0.h;
            if alike(1) && alike(2) {
                for k in 0..order {
                    let places = axes.map(|(_, start)| start + k);
                    self.mix(&places, &|i, j| c[(i, j)]);
                }
            } else {
                self.forget_triad(triad, &c);
            }
        }
        use Parameter::{
            AccelMisalignment, AccelScale, GyroMisalignment, GyroScale, HardIron, LeverArm,
            TrimVelocity,
        };
        for (scale, misalignment) in [
            (GyroScale, GyroMisalignment),
            (AccelScale, AccelMisalignment),
        ] {
            self.turn_matrix(scale, misalignment, &c);
        }
        for kind in [LeverArm, HardIron, TrimVelocity] {
            if let Some(at) = self.parameter_start(kind) {
                self.mix(&[at, at + 1, at + 2], &|i, j| c[(i, j)]);
            }
        }
        self.symmetrise();
        for vector in [
            &mut self.omega_ib_b,
            &mut self.force_b,
            &mut self.slow_force,
        ] {
            *vector = c * *vector;
        }
        if let Some(previous) = &mut self.previous {
            previous.dtheta = c * previous.dtheta;
            previous.dvel = c * previous.dvel;
        }
        if let Some((current, _)) = &mut self.current {
            current.rotation = c * current.rotation;
            current.dvel = c * current.dvel;
        }
        if !self.coupling.is_none() {
            let [rate, force] = raw.map(|vector| c * vector);
            let behind = self.sensors.states();
            let jerk = jerk(&mut self.slow_force, &force, 0.0);
            self.coupling = Coupling::new(&self.parameters, behind, [&rate, &force, &jerk]);
        }
    }

    /// Makes a parameter unknown again: no correction to its configured value, of this standard deviation [its unit],
    /// free of correlation.
    ///
    /// For a drive in which it has changed on the way: an antenna that was moved, a tyre that was replaced.
    ///
    /// ```
    /// use undrift_nav::parameters::{Parameter, Prior};
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// let estimated = Parameters::none().with(Parameter::OdometerScale, Prior::constant(0.01));
    /// let mut filter = Filter::<10>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], estimated)?;
    /// filter.renew(Parameter::OdometerScale, 0.03); // Other tyres.
    /// let (scale, std) = filter.parameter(Parameter::OdometerScale).expect("estimated");
    /// assert_eq!((scale[0], std[0]), (0.0, 0.03));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn renew(&mut self, kind: Parameter, std: f64) {
        let Some(at) = self.parameter_start(kind) else {
            return;
        };
        for i in at..at + kind.width() {
            self.x[i] = 0.0;
            self.forget(i);
            self.p[(i, i)] = std * std;
        }
    }

    /// Takes the errors of the heading and of the hard iron for independent of all others: at rest nothing shows the heading but the Earth's
    /// rate, and that only to gyros whose bias is as constant as modelled.
    pub fn isolate_heading(&mut self) {
        let iron = self.parameter_start(Parameter::HardIron);
        let apart = |i: usize| i == 8 || iron.is_some_and(|at| (at..at + 3).contains(&i));
        for i in 0..N {
            for j in 0..i {
                if apart(i) != apart(j) {
                    self.p[(i, j)] = 0.0;
                    self.p[(j, i)] = 0.0;
                }
            }
        }
    }

    /// Rate and specific force of the present sample as the sensor reads them [rad/s, m/s²].
    fn readings(&self) -> [Vector3; 2] {
        let error = self.sensors.predicted_error(&self.x, &self.coupling);
        [
            self.omega_ib_b + Vector3::new(error[0], error[1], error[2]),
            self.force_b + Vector3::new(error[3], error[4], error[5]),
        ]
    }

    /// The states at these places, at most nine, become `t` times themselves.
    fn mix(&mut self, places: &[usize], t: &dyn Fn(usize, usize) -> f64) {
        let mixed = |before: &[f64; 9], i: usize| -> f64 {
            (0..places.len()).map(|j| t(i, j) * before[j]).sum()
        };
        let mut before = [0.0; 9];
        for (slot, place) in before.iter_mut().zip(places) {
            *slot = self.x[*place];
        }
        for (i, place) in places.iter().enumerate() {
            self.x[*place] = mixed(&before, i);
        }
        for rows in [true, false] {
            for k in 0..N {
                let at = |place: usize| if rows { (place, k) } else { (k, place) };
                for (slot, place) in before.iter_mut().zip(places) {
                    *slot = self.p[at(*place)];
                }
                for (i, place) in places.iter().enumerate() {
                    self.p[at(*place)] = mixed(&before, i);
                }
            }
        }
    }

    /// A triad of unlike axes: its estimated errors turn, each state's mean given them; their covariance is the prior's.
    fn forget_triad(&mut self, triad: usize, c: &crate::Matrix3) {
        let error = self.sensor_error();
        let error = c * Vector3::new(error[triad], error[triad + 1], error[triad + 2]);
        for i in 0..3 {
            let (axis, at) = (*self.sensors.axis(triad + i), self.sensors.start(triad + i));
            for k in at..at + axis.order {
                self.forget(k);
            }
            let mut ph = [0.0; MAX_ORDER];
            let mut variance = 0.0;
            for k in 0..axis.order {
                for l in 0..axis.order {
                    self.p[(at + k, at + l)] = axis.p0[k][l];
                    ph[k] += axis.p0[k][l] * axis.h[l];
                }
                variance += axis.h[k] * ph[k];
            }
            for k in 0..axis.order {
                self.x[at + k] = if variance > 0.0 {
                    ph[k] * error[i] / variance
                } else {
                    0.0
                };
            }
        }
    }

    /// M becomes C M Cᵀ, as far as its elements are states.
    fn turn_matrix(&mut self, scale: Parameter, misalignment: Parameter, c: &crate::Matrix3) {
        let starts = [scale, misalignment].map(|kind| {
            let prior = self.parameters.prior(kind)?;
            Some((self.parameter_start(kind)?, prior.std * prior.std))
        });
        // Place, prior variance, and element of each state.
        let mut places = [0; 9];
        let mut states = [(0.0, (0, 0)); 9];
        let mut count = 0;
        for (k, element) in ELEMENTS.into_iter().enumerate() {
            let (block, offset) = if k < 3 { (0, k) } else { (1, k - 3) };
            if let Some((start, variance)) = starts[block] {
                places[count] = start + offset;
                states[count] = (variance, element);
                count += 1;
            }
        }
        let t = |i: usize, j: usize| {
            let ((a, b), (d, e)) = (states[i].1, states[j].1);
            c[(a, d)] * c[(b, e)]
        };
        self.mix(&places[..count], &t);
        for i in 0..count {
            let kept: f64 = (0..count).map(|j| t(i, j) * t(i, j) * states[j].0).sum();
            self.p[(places[i], places[i])] += (states[i].0 - kept).max(0.0);
        }
    }

    /// No covariance of a state with any.
    fn forget(&mut self, state: usize) {
        for k in 0..N {
            self.p[(state, k)] = 0.0;
            self.p[(k, state)] = 0.0;
        }
    }

    fn symmetrise(&mut self) {
        for i in 0..N {
            for j in 0..i {
                let mean = 0.5 * (self.p[(i, j)] + self.p[(j, i)]);
                self.p[(i, j)] = mean;
                self.p[(j, i)] = mean;
            }
        }
    }
}
