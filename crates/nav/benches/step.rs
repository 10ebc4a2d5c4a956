//! Time of one sample through the filter by number of states, and the structured covariance step
//! against the dense product F P Fᵀ + Q of the same size.

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::SMatrix;
use std::hint::black_box;
use undrift_nav::{
    Quaternion, Vector3,
    earth::Geodetic,
    filter::{Filter, InitialStd},
    mechanisation::NavState,
    parameters::Parameters,
    sample::{ImuSample, Position},
    shaping::ShapingFilter,
};

const DT: f64 = 0.005;

fn filter<const N: usize>() -> Filter<N> {
    let order = (N - 9) / 6;
    let phi = [0.999, -0.1, 0.05, 0.01];
    let sensor = match order {
        0 => ShapingFilter::white(5e-4, DT),
        n => ShapingFilter::arma(&phi[..n], &[0.9], 5e-3, DT),
    }
    .expect("a valid model");
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: Vector3::new(15.0, 1.0, 0.0),
        q_nb: Quaternion::identity(),
    };
    let std = InitialStd {
        position: Vector3::repeat(1.0),
        velocity: Vector3::repeat(0.1),
        attitude: Vector3::repeat(0.02),
    };
    Filter::new(nav, &std, [sensor; 6], Parameters::none()).expect("a valid start")
}

fn sample() -> ImuSample {
    ImuSample {
        time: 0.0,
        dt: DT,
        dtheta: Vector3::new(1e-4, -2e-4, 5e-4),
        dvel: Vector3::new(1e-3, -2e-3, -9.8 * DT),
    }
}

fn by_size<const N: usize>(c: &mut Criterion) {
    let sample = sample();
    let mut f = filter::<N>();
    c.bench_function(&format!("predict/{N}"), |b| {
        b.iter(|| f.predict(black_box(&sample)))
    });

    let mut f = filter::<N>();
    let fix = Position::Geodetic(f.nav().position);
    let r = undrift_nav::Matrix3::identity();
    c.bench_function(&format!("update/{N}"), |b| {
        b.iter(|| {
            let observed = f.observe_position(black_box(&fix), &Vector3::new(0.3, 0.1, -1.0));
            f.update(&observed, &r)
        })
    });

    let a = SMatrix::<f64, N, N>::from_fn(|i, j| if i == j { 1.0 } else { 1e-4 * (i + j) as f64 });
    let mut p = SMatrix::<f64, N, N>::identity();
    let q = SMatrix::<f64, N, N>::identity() * 1e-12;
    c.bench_function(&format!("dense F P Fᵀ + Q/{N}"), |b| {
        b.iter(|| {
            p = black_box(&a) * p * a.transpose() + q;
            p *= 0.99; // keeps the numbers from growing
        })
    });
}

fn benches(c: &mut Criterion) {
    by_size::<9>(c);
    by_size::<15>(c);
    by_size::<21>(c);
    by_size::<33>(c);
}

criterion_group! {
    name = all;
    config = Criterion::default().sample_size(30).measurement_time(std::time::Duration::from_secs(2)).warm_up_time(std::time::Duration::from_millis(500));
    targets = benches
}
criterion_main!(all);
