//! Attitude: unit quaternion `q_nb` (body to navigation), Euler angles, rotation vectors.
//!
//! ```
//! use undrift_nav::{Vector3, attitude};
//! // Nose east and 5° up: yaw 90°, pitch 5°.
//! let q_nb = attitude::from_rpy(&Vector3::new(0.0, 5f64.to_radians(), 90f64.to_radians()));
//! let forward_n = q_nb * Vector3::x();
//! assert!(forward_n.y > 0.99 && forward_n.z < 0.0); // East, and up, since the third axis is down.
//! // A turn to the right by 1°, in body axes, is multiplied from the right.
//! let turned = q_nb * attitude::from_rotation_vector(&Vector3::new(0.0, 0.0, 1f64.to_radians()));
//! assert!(attitude::to_rpy(&turned).z > 90f64.to_radians());
//! ```

use crate::{Matrix3, Quaternion, Vector3};
use libm::{asin, atan2, cos, sin, sqrt};

/// `q_nb` of `rpy`, which is roll, pitch, yaw \[rad\]: yaw about down first, then pitch about right, then roll about forward. Yaw 0
/// is north and grows eastwards; a positive pitch is nose up, a positive roll right side down. Groves eq. 2.22 (transposed).
///
/// ```
/// use undrift_nav::{Vector3, attitude::{from_rpy, to_rpy}};
/// let rpy = Vector3::new(0.1, -0.2, 3.0); // Right side down, nose down, nearly south.
/// assert!((to_rpy(&from_rpy(&rpy)) - rpy).norm() < 1e-12);
/// assert!((from_rpy(&rpy) * Vector3::x()).z > 0.0, "nose down: forward has a part down");
/// ```
#[inline]
pub fn from_rpy(rpy: &Vector3) -> Quaternion {
    Quaternion::from_euler_angles(rpy.x, rpy.y, rpy.z)
}

/// Roll, pitch, yaw \[rad\] of `q_nb`: roll and yaw in (−π, π], pitch in [−π/2, π/2]. Groves eq. 2.23.
/// At a pitch of ±90° roll and yaw have no meaning of their own; what is returned is finite but arbitrary.
#[inline]
pub fn to_rpy(q_nb: &Quaternion) -> Vector3 {
    let q = q_nb.quaternion();
    let (w, x, y, z) = (q.w, q.i, q.j, q.k);
    let sin_pitch = (2.0 * (w * y - x * z)).clamp(-1.0, 1.0);
    Vector3::new(
        atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
        asin(sin_pitch),
        atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
    )
}

/// Rotation about the axis of `phi` by its length \[rad\]: the inverse of the quaternion's logarithm, exact for any length, by series
/// where it is small so that no digit is lost. Groves eq. E.30.
///
/// ```
/// use undrift_nav::{Vector3, attitude::from_rotation_vector};
/// let quarter = from_rotation_vector(&Vector3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2));
/// assert!((quarter * Vector3::x() - Vector3::y()).norm() < 1e-15); // About down: north goes to east.
/// ```
#[inline]
pub fn from_rotation_vector(phi: &Vector3) -> Quaternion {
    let half_sq = phi.norm_squared() / 4.0;
    // cos(a) and sin(a)/a with a = |φ|/2. The series' next terms are below 1e-17 for a² < 1e-4.
    let (c, sinc) = if half_sq < 1e-4 {
        let a2 = half_sq;
        (
            1.0 - a2 / 2.0 * (1.0 - a2 / 12.0 * (1.0 - a2 / 30.0)),
            1.0 - a2 / 6.0 * (1.0 - a2 / 20.0 * (1.0 - a2 / 42.0)),
        )
    } else {
        let a = sqrt(half_sq);
        (cos(a), sin(a) / a)
    };
    let v = phi * (sinc / 2.0);
    Quaternion::new_unchecked(nalgebra::Quaternion::new(c, v.x, v.y, v.z))
}

/// Cross-product matrix `[v×]`, so that `skew(a) * b = a × b`; antisymmetric, so `skew(a)ᵀ = skew(−a)`.
#[inline]
pub fn skew(v: &Vector3) -> Matrix3 {
    Matrix3::new(0.0, -v.z, v.y, v.z, 0.0, -v.x, -v.y, v.x, 0.0)
}

/// Right Jacobian J_r of a rotation vector: `exp(φ + δ) ≈ exp(φ) exp(J_r δ)`; the left one is that of −φ. Chirikjian 2012, section 10.6.
///
/// ```
/// use undrift_nav::{Vector3, attitude::{from_rotation_vector, right_jacobian}};
/// let (phi, delta) = (Vector3::new(0.5, -1.0, 0.3), Vector3::new(1e-6, 2e-6, -1e-6));
/// let exact = from_rotation_vector(&(phi + delta));
/// let split = from_rotation_vector(&phi) * from_rotation_vector(&(right_jacobian(&phi) * delta));
/// assert!(exact.angle_to(&split) < 1e-11); // Second order in δ.
/// ```
pub fn right_jacobian(phi: &Vector3) -> Matrix3 {
    let (theta_sq, cross) = (phi.norm_squared(), skew(phi));
    let (first, second) = if theta_sq < 1e-6 {
        (0.5 - theta_sq / 24.0, 1.0 / 6.0 - theta_sq / 120.0)
    } else {
        let theta = sqrt(theta_sq);
        (
            (1.0 - cos(theta)) / theta_sq,
            (theta - sin(theta)) / (theta_sq * theta),
        )
    };
    Matrix3::identity() - cross * first + cross * cross * second
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn euler_round_trip_and_meaning() {
        let rpy = Vector3::new(0.3, -0.4, 2.5);
        assert!((to_rpy(&from_rpy(&rpy)) - rpy).norm() < 1e-14);
        // Yaw 90°: forward points east. Pitch up: forward points up, which is −down.
        let east = from_rpy(&Vector3::new(0.0, 0.0, core::f64::consts::FRAC_PI_2)) * Vector3::x();
        assert!((east - Vector3::y()).norm() < 1e-15);
        let up = from_rpy(&Vector3::new(0.0, 0.1, 0.0)) * Vector3::x();
        assert!(up.z < 0.0);
    }

    #[test]
    fn rotation_vector_series_meets_closed_form() {
        for scale in [1e-9, 1e-3, 0.019_9, 0.020_1, 1.0, 3.0] {
            let phi = Vector3::new(0.6, -0.64, 0.48) * scale;
            let exact = Quaternion::from_scaled_axis(phi);
            let ours = from_rotation_vector(&phi);
            assert!((exact.coords - ours.coords).norm() < 4e-16, "{scale}");
        }
    }

    #[test]
    fn right_jacobian_takes_a_small_change_to_the_right() {
        let delta = Vector3::new(1e-6, -2e-6, 1.5e-6);
        for scale in [0.0, 1e-4, 0.9e-3, 1.1e-3, 0.5, 2.5] {
            let phi = Vector3::new(0.6, -0.64, 0.48) * scale;
            let change =
                from_rotation_vector(&phi).inverse() * from_rotation_vector(&(phi + delta));
            let miss = change.scaled_axis() - right_jacobian(&phi) * delta;
            // Of second order in δ.
            assert!(miss.norm() < 1e-11, "{scale}: {miss}");
        }
    }

    #[test]
    fn skew_is_the_cross_product() {
        let (a, b) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(-4.0, 0.5, 2.0));
        assert_eq!(skew(&a) * b, a.cross(&b));
    }
}
