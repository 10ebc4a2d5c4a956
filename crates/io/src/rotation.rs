//! Attitudes as logs write them, quaternions and matrices, as unit quaternions.

use undrift_nav::{Matrix3, Quaternion, Vector3};

use crate::skipped::{SkipKind, Unfit};

/// By how much the length of a quaternion may differ from 1, and that of a column of a rotation matrix: digits that
/// were cut make 0.0002 where there are four.
pub(crate) const LENGTH: f64 = 0.02;

/// The attitude of a quaternion; `Ok(None)` of four zeros, which programs write that have none.
///
/// # Errors
/// If its length is not 1 within [`LENGTH`].
pub(crate) fn of_quaternion(w: f64, [x, y, z]: [f64; 3]) -> Result<Option<Quaternion>, Unfit> {
    let mut quaternion = Quaternion::identity().into_inner();
    (quaternion.w, quaternion.i, quaternion.j, quaternion.k) = (w, x, y, z);
    let length = quaternion.norm();
    if length == 0.0 {
        return Ok(None);
    }
    // NaN is not within it.
    if (length - 1.0).abs() <= LENGTH {
        return Ok(Some(Quaternion::new_normalize(quaternion)));
    }
    let detail = format!("quaternion w {w}, x {x}, y {y}, z {z} of norm {length:.3}");
    Err((SkipKind::OutOfRange, detail))
}

/// The attitude of a rotation matrix.
///
/// # Errors
/// If its columns are not of length 1 and perpendicular within [`LENGTH`], or are left-handed.
pub(crate) fn of_matrix(matrix: &Matrix3) -> Result<Quaternion, Unfit> {
    let off = (matrix.transpose() * matrix - Matrix3::identity()).amax();
    // A length is off by half as much as its square.
    if off <= 2.0 * LENGTH && matrix.determinant() > 0.0 {
        let columns = [0, 1, 2].map(|k| Vector3::from(matrix.column(k)));
        let rotation = Quaternion::from_basis_unchecked(&columns);
        return Ok(Quaternion::new_normalize(rotation.into_inner()));
    }
    let detail = match off <= 2.0 * LENGTH {
        true => "a left-handed matrix".to_owned(),
        false => format!("a matrix that is no rotation: off by {off:.3}"),
    };
    Err((SkipKind::OutOfRange, detail))
}
