//! Noise models of a sensor axis.

use crate::{
    memory::{finite, not_negative, numbers, read, write},
    status::{Status, call},
    types::{Sensor, UNDRIFT_MAX_ORDER},
};
use undrift_nav::shaping::{self, ShapingError, ShapingFilter};

const _: () = assert!(UNDRIFT_MAX_ORDER == shaping::MAX_ORDER);

impl From<ShapingFilter> for Sensor {
    fn from(filter: ShapingFilter) -> Self {
        Self {
            order: filter.order as u32,
            interval: filter.interval,
            f: filter.f,
            h: filter.h,
            q: filter.q,
            s: filter.s,
            r: filter.r,
            p0: filter.p0,
        }
    }
}

impl Sensor {
    /// As the filter takes it.
    ///
    /// # Errors
    /// An order that is too large, numbers that are not finite, and moments that are no covariance.
    pub fn shaping(&self) -> Result<ShapingFilter, Status> {
        let order = self.order as usize;
        if order > UNDRIFT_MAX_ORDER {
            return Err(Status::TooManyStates);
        }
        let mut filter = ShapingFilter::none(self.interval)?;
        not_negative([&self.r])?;
        filter.order = order;
        filter.r = self.r;
        // What lies beyond the order is left at zero: the filter counts on it.
        for i in 0..order {
            filter.h[i] = self.h[i];
            filter.s[i] = self.s[i];
            for j in 0..order {
                filter.f[i][j] = self.f[i][j];
                filter.q[i][j] = self.q[i][j];
                filter.p0[i][j] = self.p0[i][j];
            }
        }
        finite(filter.h.iter().chain(&filter.s))?;
        for matrix in [&filter.f, &filter.q, &filter.p0] {
            finite(matrix.iter().flatten())?;
        }
        if is_covariance(&joint(&filter), &filter.noise_factor())
            && is_covariance(&filter.p0, &filter.initial_factor())
        {
            Ok(filter)
        } else {
            Err(Status::BadSensor)
        }
    }
}

/// Covariance of `[D w; G w]`.
fn joint(filter: &ShapingFilter) -> [[f64; UNDRIFT_MAX_ORDER + 1]; UNDRIFT_MAX_ORDER + 1] {
    let mut joint = [[0.0; UNDRIFT_MAX_ORDER + 1]; UNDRIFT_MAX_ORDER + 1];
    joint[0][0] = filter.r;
    for i in 0..UNDRIFT_MAX_ORDER {
        joint[0][i + 1] = filter.s[i];
        joint[i + 1][0] = filter.s[i];
        for j in 0..UNDRIFT_MAX_ORDER {
            joint[i + 1][j + 1] = filter.q[i][j];
        }
    }
    joint
}

/// Whether `factor` times its transpose is `p` again, to 1e-9 of the diagonal: a model carried to
/// another rate is one only to rounding.
fn is_covariance<const M: usize>(p: &[[f64; M]; M], factor: &[[f64; M]; M]) -> bool {
    (0..M).all(|i| {
        (0..M).all(|j| {
            let made: f64 = (0..M).map(|k| factor[i][k] * factor[j][k]).sum();
            let size = p[i][i].max(p[j][j]).max(0.0);
            (made - p[i][j]).abs() <= 1e-9 * size
        })
    })
}

/// Hands a made filter to C.
///
/// # Safety
/// `out` is null or points to a sensor.
unsafe fn give(made: Result<ShapingFilter, ShapingError>, out: *mut Sensor) -> Status {
    call(|| {
        // SAFETY: passed on.
        unsafe { write(out, made?.into()) }
    })
}

/// White noise of `density` [unit*sqrt(s)], the angle or velocity random walk; no state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_sensor_white(
    density: f64,
    interval: f64,
    out: *mut Sensor,
) -> Status {
    // SAFETY: out is null or a sensor's.
    unsafe { give(ShapingFilter::white(density, interval), out) }
}

/// A constant that differs from one turn-on to the next with standard deviation `sigma` \[unit\]; one state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_sensor_constant(
    sigma: f64,
    interval: f64,
    out: *mut Sensor,
) -> Status {
    // SAFETY: out is null or a sensor's.
    unsafe { give(ShapingFilter::constant(sigma, interval), out) }
}

/// A random walk of the bias with coefficient `k` [unit/sqrt(s)], from zero; one state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_sensor_random_walk(
    k: f64,
    interval: f64,
    out: *mut Sensor,
) -> Status {
    // SAFETY: out is null or a sensor's.
    unsafe { give(ShapingFilter::random_walk(k, interval), out) }
}

/// A first-order Gauss-Markov process of standard deviation `sigma` \[unit\] and correlation time `tau`
/// \[s\], as a bias instability is commonly modelled; one state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_sensor_gauss_markov(
    sigma: f64,
    tau: f64,
    interval: f64,
    out: *mut Sensor,
) -> Status {
    // SAFETY: out is null or a sensor's.
    unsafe { give(ShapingFilter::gauss_markov(sigma, tau, interval), out) }
}

/// ARMA(p, q), x_t - phi_1 x_(t-1) - ... = a_t - theta_1 a_(t-1) - ..., the standard deviation of a being
/// `sigma` \[unit\]; max(p, q) states. An array of no coefficients may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_sensor_arma(
    phi: *const f64,
    p: usize,
    theta: *const f64,
    q: usize,
    sigma: f64,
    interval: f64,
    out: *mut Sensor,
) -> Status {
    call(|| {
        // SAFETY: each points to as many numbers as it says.
        let ar = unsafe { numbers::<UNDRIFT_MAX_ORDER>(phi, p) }?;
        // SAFETY: as above.
        let ma = unsafe { numbers::<UNDRIFT_MAX_ORDER>(theta, q) }?;
        let made = ShapingFilter::arma(&ar[..p], &ma[..q], sigma, interval)?;
        // SAFETY: out is null or a sensor's.
        unsafe { write(out, made.into()) }
    })
}

/// The sum of two independent errors, as white noise and a bias; `out` may be one of them. A random walk
/// and a constant share one state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_sensor_add(
    one: *const Sensor,
    other: *const Sensor,
    out: *mut Sensor,
) -> Status {
    call(|| {
        // SAFETY: each is null or a sensor.
        let one = unsafe { read(one) }?.shaping()?;
        // SAFETY: as above.
        let other = unsafe { read(other) }?.shaping()?;
        // SAFETY: out is null or a sensor's.
        unsafe { write(out, one.plus(&other)?.into()) }
    })
}

/// The same noise at another sample interval \[s\]: for coefficients found at another rate than the
/// filter's; `out` may be `sensor`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_sensor_at_interval(
    sensor: *const Sensor,
    interval: f64,
    out: *mut Sensor,
) -> Status {
    call(|| {
        // SAFETY: null or a sensor.
        let sensor = unsafe { read(sensor) }?.shaping()?;
        // SAFETY: out is null or a sensor's.
        unsafe { write(out, sensor.at_interval(interval)?.into()) }
    })
}
