//! A simulated car drive of five minutes through the filter, without files: samples and fixes merged,
//! gates, updates and all.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::time::Duration;
use undrift::{
    nav::sample::{GnssFix, ImuSample},
    noise::{BiasModel, ImuModel},
    replay::{Measurement, Settings, replay},
    simulate::{GnssFixes, GnssNoise, IdealImu, SensorErrors, Trajectory},
};

const RATE_HZ: f64 = 100.0;

fn drive(c: &mut Criterion) {
    let car = Trajectory::car(300.0, 1);
    let model = ImuModel::preset("adis16405").expect("a preset");
    let truth = model
        .shaping(BiasModel::GaussMarkov, 1.0 / RATE_HZ)
        .expect("a valid model");
    let mut errors = SensorErrors::new(&truth, RATE_HZ, 1).expect("a valid model");
    let imu: Vec<ImuSample> = IdealImu::new(&car, RATE_HZ)
        .map(|(ideal, _)| errors.apply(&ideal))
        .collect();
    let receiver = GnssNoise::default();
    let fixes: Vec<GnssFix> = GnssFixes::new(&car, &receiver, 1)
        .expect("a valid receiver")
        .collect();

    let mut group = c.benchmark_group("replay");
    group.throughput(Throughput::Elements(imu.len() as u64));
    for kind in [BiasModel::White, BiasModel::GaussMarkov, BiasModel::Arma] {
        let filters = model.shaping(kind, 1.0 / RATE_HZ).expect("a valid model");
        let settings = Settings {
            lever_arm: receiver.lever_arm,
            ..Settings::new(filters)
        };
        group.bench_function(kind.name(), |b| {
            b.iter(|| {
                let mut samples = imu.iter().map(|sample| Ok(*sample));
                let mut aiding = fixes.iter().map(|fix| Ok(Measurement::Gnss(*fix)));
                replay(&mut samples, &mut aiding, &settings, &mut ())
            })
        });
    }
}

criterion_group! {
    name = all;
    config = Criterion::default().sample_size(10).measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(300));
    targets = drive
}
criterion_main!(all);
