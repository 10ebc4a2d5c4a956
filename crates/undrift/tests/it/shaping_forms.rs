//! ARMA(1,1) in innovations form and its AR(1) + white decomposition are one model: they navigate
//! alike to rounding. Without the cross-covariance of bias and measurement noise they do not.

use undrift::{
    align::AlignSettings,
    estimator::Estimator,
    nav::{Vector3, attitude::to_rpy, shaping::ShapingFilter},
    replay::{Measurement, Observer, Outage, ReplayError, Settings, replay},
    simulate::{GnssNoise, Simulation, Trajectory, simulate},
};

const RATE: f64 = 100.0;

/// Navigation states and standard deviations at every sample.
#[derive(Default)]
struct Record(Vec<([f64; 9], [f64; 9])>);

impl Observer for Record {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        let nav = filter.nav();
        let origin = undrift::simulate::Trajectory::rest(1.0).start;
        let (r, rpy) = (origin.offset_to(&nav.position), to_rpy(&nav.q_nb));
        let v = nav.v_n;
        self.0.push((
            [r.x, r.y, r.z, v.x, v.y, v.z, rpy.x, rpy.y, rpy.z],
            filter.nav_std(),
        ));
        Ok(())
    }
}

/// Innovations form and decomposition of the same ARMA(1,1). docs/theory.md: driving variance S σ², white
/// variance W σ² with S = (1−φθ)(φ−θ)/φ and W = θ/φ.
fn two_forms(phi: f64, theta: f64, sigma: f64) -> [ShapingFilter; 2] {
    let interval = 1.0 / RATE;
    let innovations = ShapingFilter::arma(&[phi], &[theta], sigma, interval).unwrap();
    let mut sum = ShapingFilter::white(sigma * (theta / phi * interval).sqrt(), interval).unwrap();
    let mut coloured = ShapingFilter::ar(&[phi], 0.0, interval).unwrap();
    let q = (1.0 - phi * theta) * (phi - theta) / phi * sigma * sigma;
    coloured.q[0][0] = q;
    coloured.p0[0][0] = q / (1.0 - phi * phi);
    sum = sum.plus(&coloured).unwrap();
    [innovations, sum]
}

fn navigate(simulation: &Simulation, gyro: ShapingFilter, accel: ShapingFilter) -> Record {
    let truth = simulation.truth[RATE as usize];
    let settings = Settings {
        align: AlignSettings {
            attitude: Some((truth.rpy.unwrap(), Vector3::new(0.02, 0.02, 0.05))),
            ..AlignSettings::default()
        },
        outages: vec![Outage {
            start: 120.0,
            end: 150.0,
        }],
        // The linear filter alone: products of errors go by the states of a form.
        gating: false,
        ..Settings::new([gyro, gyro, gyro, accel, accel, accel])
    };
    let mut record = Record::default();
    replay(
        &mut simulation.imu.iter().copied().map(Ok),
        &mut simulation
            .gnss
            .iter()
            .copied()
            .map(Measurement::Gnss)
            .map(Ok),
        &settings,
        &mut record,
    )
    .unwrap();
    record
}

/// Largest difference of any navigation state, in standard deviations.
fn difference(a: &Record, b: &Record) -> f64 {
    assert!(a.0.len() == b.0.len() && a.0.len() > 15_000);
    let mut worst = 0.0f64;
    for ((x, std), (y, _)) in a.0.iter().zip(&b.0) {
        for i in 0..9 {
            worst = worst.max((x[i] - y[i]).abs() / std[i]);
        }
    }
    worst
}

#[test]
fn innovations_form_is_its_decomposition() {
    let gyro = two_forms(0.9995, 0.97, 0.2f64.to_radians());
    let accel = two_forms(0.999, 0.95, 0.05);
    let sensors = [gyro[0], gyro[0], gyro[0], accel[0], accel[0], accel[0]];
    let gnss = GnssNoise {
        rate_hz: 2.0,
        ..GnssNoise::default()
    };
    let simulation = simulate(&Trajectory::car(200.0, 4), RATE, Some(&sensors), &gnss, 4).unwrap();

    let innovations = navigate(&simulation, gyro[0], accel[0]);
    let decomposed = navigate(&simulation, gyro[1], accel[1]);
    let alike = difference(&innovations, &decomposed);

    let without_cross = |mut filter: ShapingFilter| {
        filter.s = Default::default();
        filter
    };
    let dropped = navigate(&simulation, without_cross(gyro[0]), without_cross(accel[0]));
    let apart = difference(&innovations, &dropped);
    println!("decomposition {alike:.2e} σ apart, without cross terms {apart:.2} σ");
    assert!(alike < 1e-6, "{alike}");
    // Ten thousand times the tolerance above: another model.
    assert!(apart > 0.01, "{apart}");
}
