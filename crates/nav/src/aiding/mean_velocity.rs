//! Mean velocity over the time since an instant: GNSS displacement by the carrier phase.

use super::Observation;
use crate::{
    Matrix3, Quaternion, Vector3, attitude::skew, earth::LocalEarth, filter::Filter,
    mechanisation::NavState, parameters::Parameter, sample::MeanVelocity,
};
use nalgebra::SMatrix;

/// What the inertial samples say of the motion since an instant, whatever corrects the velocity meanwhile.
///
/// ```
/// use undrift_nav::{Quaternion, Vector3, aiding::Stretch, earth::Geodetic, mechanisation::NavState};
/// let at = |time: f64| NavState {
///     time,
///     position: Geodetic::from_degrees(47.0, 8.0, 400.0),
///     v_n: Vector3::new(2.0 * time, 0.0, 0.0), // Speeds up by 2 m/s².
///     q_nb: Quaternion::identity(),
/// };
/// let mut stretch = Stretch::new(&at(3.0));
/// stretch.add(&at(3.0), &at(3.3));
/// stretch.add(&at(3.3), &at(4.0));
/// // The mean over the second is that of its middle, 1 m/s less than at its end.
/// assert!((stretch.lag(4.0) - Vector3::new(1.0, 0.0, 0.0)).norm() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stretch {
    /// Its start \[s\].
    pub start: f64,
    /// ∫ (t − start) v̇ dt, north, east, down \[m\].
    moment: Vector3,
    /// ∫ v̇ dt, north, east, down [m/s].
    gained: Vector3,
    /// Attitude at its start, `q_nb`.
    q_nb: Quaternion,
}

impl Stretch {
    /// Starts at a navigation state.
    pub fn new(nav: &NavState) -> Self {
        Self {
            start: nav.time,
            moment: Vector3::zeros(),
            gained: Vector3::zeros(),
            q_nb: nav.q_nb,
        }
    }

    /// Adds the motion from one navigation state to the next, of a constant acceleration.
    pub fn add(&mut self, before: &NavState, after: &NavState) {
        let middle = 0.5 * (before.time + after.time) - self.start;
        let gained = after.v_n - before.v_n;
        self.moment += gained * middle;
        self.gained += gained;
    }

    /// By how much the velocity at `time` \[s\], the end of what was added, exceeds the mean since the start, north, east, down [m/s].
    pub fn lag(&self, time: f64) -> Vector3 {
        self.moment / (time - self.start)
    }
}

impl<const N: usize> Filter<N> {
    /// Observation of the mean velocity over ground `v_n` [m/s, north-east-down] of the antenna at `lever_b` [m, body axes, from the IMU, as
    /// configured] over the `stretch` T that ends now. The prediction is `v − a̅ + (C₁ l − C₀ l)/T`: the present velocity, less what the inertial
    /// samples say that it exceeds the mean by, and the way of the lever arm.
    ///
    /// Rows `[0, I, −[f̅×] + [(C₁ l − C₀ l)×]/T, −[l^n×] C_b^n H_g, −T/2 C_b^n H_a]`, f̅ = a̅ − g T/2: what attitude and accelerometers were wrong by
    /// within T is in the present velocity more than in the mean. In [`Observation::extra`] is the white noise of the accelerometers over
    /// T, N² T/3.
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, aiding::Stretch, earth::Geodetic, mechanisation::NavState, sample::ImuSample};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let mut filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// let mut stretch = Stretch::new(filter.nav());
    /// for k in 1..=20 {
    ///     let before = *filter.nav();
    ///     filter.step(&ImuSample::from_rates(0.01 * f64::from(k), 0.01, [0.0; 3], [3.0, 0.0, -9.8073]))?;
    ///     stretch.add(&before, filter.nav());
    /// }
    /// // From 20 to 20.6 m/s in 0.2 s.
    /// let observed = filter.observe_mean_velocity(&Vector3::new(20.3, 0.0, 0.0), &Vector3::zeros(), &stretch);
    /// assert!(observed.innovation.norm() < 1e-3); // [m/s]
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe_mean_velocity(
        &self,
        v_n: &Vector3,
        lever_b: &Vector3,
        stretch: &Stretch,
    ) -> Observation<3, N> {
        let time = self.nav().time;
        let over = time - stretch.start;
        let c = self.c_nb();
        let lever_b = self.lever_arm(lever_b);
        let turned = (c - stretch.q_nb.to_rotation_matrix().matrix()) / over;
        let lever_way = turned * lever_b;
        let lag = stretch.lag(time);
        let gravity = LocalEarth::at(&self.nav().position).gravity;
        let force = lag - Vector3::new(0.0, 0.0, gravity * 0.5 * over);
        let mut h = SMatrix::<f64, 3, N>::zeros();
        h.fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&Matrix3::identity());
        h.fixed_view_mut::<3, 3>(0, 6)
            .copy_from(&(skew(&lever_way) - skew(&force)));
        // The gyros' white noise over T is smaller than a sample's: negligible.
        self.rate_columns(&mut h, &(-skew(&(c * lever_b)) * c));
        let mut extra = Matrix3::zeros();
        for axis in 0..3 {
            let column = c.column(axis) * (-0.5 * over);
            self.error_columns(&mut h, 3 + axis, &column, self.coupling());
            let sensor = self.sensors().axis(3 + axis);
            let noise = sensor.r * sensor.interval * over / 3.0;
            extra += c.column(axis) * c.column(axis).transpose() * noise;
        }
        if let Some(at) = self.parameter_start(Parameter::LeverArm) {
            h.fixed_view_mut::<3, 3>(0, at).copy_from(&turned);
        }
        // A receiver may filter its own velocities, and be late with them; its phases are of the epoch.
        if let Some(at) = self.parameter_start(Parameter::TimeOffset) {
            // Later by dt, the way is longer by the velocity at its end and shorter by that at its start.
            self.time_columns(&mut h, at, &(-stretch.gained / over));
        }
        Observation {
            innovation: self.nav().v_n - lag + lever_way - v_n,
            h,
            extra,
        }
    }

    /// Observation of a mean velocity along one `direction`, north, east, down, of those that few satellites show
    /// ([`MeanVelocity::directions`]): the same, with what the solution's place changes in it, `B (p − p₀)`. Row
    /// `direction · [−B, I, …]`.
    pub fn observe_mean_velocity_along(
        &self,
        direction: &Vector3,
        mean: &MeanVelocity,
        lever_b: &Vector3,
        stretch: &Stretch,
    ) -> Observation<1, N> {
        let off = mean.place.offset_to(&self.antenna_position(lever_b));
        let v_n = mean.v_n + mean.by_place * off;
        let mut all = self.observe_mean_velocity(&v_n, lever_b, stretch);
        all.h
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&-mean.by_place);
        let along = direction.transpose();
        Observation {
            innovation: along * all.innovation,
            h: along * all.h,
            extra: along * all.extra * direction,
        }
    }
}
