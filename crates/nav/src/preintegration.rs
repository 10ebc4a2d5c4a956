//! Motion integrated once in body axes, so that attitude and sensor biases can be tried out without the samples
//! (preintegration: Forster et al. 2017, IEEE Transactions on Robotics 33, section VI).

use crate::{
    Matrix3, Quaternion, Vector3,
    attitude::{from_rotation_vector, skew},
};

/// Motion over a span, with its derivatives by constant biases: gyro `g` [rad/s], accelerometer `a` [m/s²], both
/// what the sensor reads too much. Not for turns of the Earth or of the navigation frame: spans of seconds, or tactical sensors'
/// minutes.
///
/// ```
/// use undrift_nav::{Vector3, preintegration::Preintegrated};
/// let mut motion = Preintegrated::default();
/// for _ in 0..100 {
///     motion.add(&Vector3::new(0.0, 0.0, 0.002), &Vector3::new(0.01, 0.0, -0.0981), 0.01);
/// }
/// assert!((motion.dt - 1.0).abs() < 1e-12 && (motion.turn.angle() - 0.2).abs() < 1e-12);
/// // What another bias would have made of it, without the samples: 0.1 m/s² too much moved it by 5 cm.
/// let bias = Vector3::new(0.1, 0.0, 0.0);
/// let dpos = motion.dpos + motion.dpos_by_a * bias;
/// assert!((motion.dpos.x - dpos.x - 0.05).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Preintegrated {
    /// Length of the span \[s\].
    pub dt: f64,
    /// Rotation over the span: takes body axes at its end to those at its start.
    pub turn: Quaternion,
    /// Derivative of the turn, as a rotation vector at the end, by the gyro bias \[s\].
    /// By the chain rule the turn with a bias is `turn · exp(turn_by_g · g)`.
    pub turn_by_g: Matrix3,
    /// Specific force integrated in the axes of the start [m/s].
    pub dvel: Vector3,
    /// Derivative of `dvel` by the gyro bias \[m\].
    pub dvel_by_g: Matrix3,
    /// Derivative of `dvel` by the accelerometer bias \[s\].
    pub dvel_by_a: Matrix3,
    /// `dvel` integrated over the span, axes of the start: what the position moves by beyond velocity and gravity \[m\].
    pub dpos: Vector3,
    /// Derivative of `dpos` by the gyro bias \[m s\].
    pub dpos_by_g: Matrix3,
    /// Derivative of `dpos` by the accelerometer bias \[s²\].
    pub dpos_by_a: Matrix3,
}

impl Default for Preintegrated {
    /// A span of no length.
    fn default() -> Self {
        Self {
            dt: 0.0,
            turn: Quaternion::identity(),
            turn_by_g: Matrix3::zeros(),
            dvel: Vector3::zeros(),
            dvel_by_g: Matrix3::zeros(),
            dvel_by_a: Matrix3::zeros(),
            dpos: Vector3::zeros(),
            dpos_by_g: Matrix3::zeros(),
            dpos_by_a: Matrix3::zeros(),
        }
    }
}

impl Preintegrated {
    /// Extends the span by a sample of `dt` \[s\] with its increments of angle \[rad\] and velocity [m/s], body axes. Specific force is taken at the middle of the sample's turn.
    pub fn add(&mut self, dtheta: &Vector3, dvel: &Vector3, dt: f64) {
        // Specific force in the middle of the turn.
        let force = dvel + dtheta.cross(dvel) * 0.5;
        let c = self.turn.to_rotation_matrix().into_inner();
        // Over the increment the velocity grows evenly: its mean is what it was and half of what comes.
        let half = 0.5 * dt;
        let (by_g, moved) = (c * skew(&force) * self.turn_by_g, c * force);
        self.dpos_by_g += self.dvel_by_g * dt - by_g * half;
        self.dpos_by_a += self.dvel_by_a * dt - c * (half * dt);
        self.dpos += self.dvel * dt + moved * half;
        self.dvel_by_g -= by_g;
        self.dvel_by_a -= c * dt;
        self.dvel += moved;
        let turn = from_rotation_vector(dtheta);
        self.turn_by_g =
            turn.to_rotation_matrix().transpose() * self.turn_by_g - Matrix3::identity() * dt;
        self.turn *= turn;
        self.dt += dt;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two thousand increments of a turning, pushed body, read with these biases.
    fn moved(gyro: &Vector3, accel: &Vector3) -> Preintegrated {
        let dt = 1e-3;
        let mut motion = Preintegrated::default();
        for k in 0..2000 {
            let t = dt * f64::from(k);
            let rate = Vector3::new(0.3 * libm::sin(t), -0.2, 0.5 * libm::cos(2.0 * t));
            let force = Vector3::new(1.0, libm::sin(3.0 * t), -9.8);
            motion.add(&((rate - gyro) * dt), &((force - accel) * dt), dt);
        }
        motion
    }

    /// A constant force without turning: half its square of time.
    #[test]
    fn a_steady_push_moves_by_half_its_square_of_time() {
        let mut motion = Preintegrated::default();
        for _ in 0..7 {
            motion.add(&Vector3::zeros(), &Vector3::new(0.6, 0.0, -0.3), 0.3);
        }
        let expected = Vector3::new(2.0, 0.0, -1.0) * (0.5 * 2.1 * 2.1);
        assert!((motion.dpos - expected).norm() < 1e-12, "{}", motion.dpos);
    }

    #[test]
    fn the_derivatives_are_those_of_the_motion() {
        let none = Vector3::zeros();
        let plain = moved(&none, &none);
        assert!((plain.dt - 2.0).abs() < 1e-12);
        let size = 1e-5;
        for i in 0..3 {
            let mut bias = none;
            bias[i] = size;
            let turned = moved(&bias, &none);
            let turn = (plain.turn.inverse() * turned.turn).scaled_axis() / size;
            // To first order in the bias, and in the angle of one sample.
            assert!((turn - plain.turn_by_g.column(i)).norm() < 1e-3, "{turn}");
            let dvel = (turned.dvel - plain.dvel) / size;
            assert!((dvel - plain.dvel_by_g.column(i)).norm() < 2e-2, "{dvel}");
            let dvel = (moved(&none, &bias).dvel - plain.dvel) / size;
            assert!((dvel - plain.dvel_by_a.column(i)).norm() < 1e-3, "{dvel}");
            let dpos = (turned.dpos - plain.dpos) / size;
            assert!((dpos - plain.dpos_by_g.column(i)).norm() < 2e-2, "{dpos}");
            let dpos = (moved(&none, &bias).dpos - plain.dpos) / size;
            assert!((dpos - plain.dpos_by_a.column(i)).norm() < 1e-3, "{dpos}");
        }
    }
}
