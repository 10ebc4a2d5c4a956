//! Identification on 200 000 samples of the source paper's ARMA(1,1), one thread where it is one.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;
use undrift_nav::shaping::ShapingFilter;
use undrift_noise::{
    allan::{DeviationKind, Grid, deviations},
    arma::{FitOptions, Mean, fit, log_likelihood},
    correlation::autocorrelation,
    stationarity::{Deterministic, KpssLags, Lags, adf, kpss},
    synthesis::NoiseGenerator,
    whiteness::portmanteau,
};

const SAMPLES: usize = 200_000;

fn generator() -> NoiseGenerator {
    let filter = ShapingFilter::arma(&[0.99995], &[0.9994], 0.006, 0.01).expect("a valid model");
    NoiseGenerator::new(&filter, 1)
}

fn record(samples: usize) -> Vec<f64> {
    let mut record = vec![0.0; samples];
    generator().fill(&mut record);
    record
}

fn likelihoods(c: &mut Criterion) {
    let record = record(SAMPLES);
    let mut group = c.benchmark_group("likelihood");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    for (name, ar, ma) in [
        ("ARMA(1,1)", &[0.99995][..], &[0.9994][..]),
        ("ARMA(2,1)", &[1.19, -0.19999], &[0.9994]),
        ("ARMA(4,3)", &[1.2, -0.5, 0.3, -0.1], &[0.6, -0.2, -0.1]),
    ] {
        group.bench_function(name, |b| {
            b.iter(|| log_likelihood(black_box(&record), ar, ma, Mean::Known(0.0), false))
        });
    }
}

fn fits(c: &mut Criterion) {
    let record = record(20_000);
    let mut group = c.benchmark_group("fit to 20 000 samples");
    group.sample_size(10);
    for (p, q) in [(1, 1), (2, 1), (4, 3)] {
        group.bench_function(format!("ARMA({p},{q})"), |b| {
            b.iter(|| fit(black_box(&record), p, q, &FitOptions::default()))
        });
    }
}

fn allan(c: &mut Criterion) {
    let record = record(SAMPLES);
    let mut group = c.benchmark_group("overlapping Allan deviation");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    group.bench_function("octaves", |b| {
        b.iter(|| {
            deviations(
                black_box(&record),
                100.0,
                DeviationKind::Overlapping,
                Grid::Octave,
            )
        })
    });
    // By FFT: a little more than with the length.
    let short = &record[..5_000];
    group.throughput(Throughput::Elements(short.len() as u64));
    group.bench_function("every τ of 5 000 samples", |b| {
        b.iter(|| {
            deviations(
                black_box(short),
                100.0,
                DeviationKind::Overlapping,
                Grid::All,
            )
        })
    });
}

fn statistics(c: &mut Criterion) {
    let record = record(SAMPLES);
    let x = || black_box(record.as_slice());
    let mut group = c.benchmark_group("statistics");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    let constant = Deterministic::Constant;
    group.bench_function("ADF, 20 lags", |b| {
        b.iter(|| adf(x(), constant, Lags::Fixed(20)))
    });
    group.bench_function("KPSS, 81 lags", |b| {
        b.iter(|| kpss(x(), constant, KpssLags::Legacy))
    });
    group.bench_function("autocorrelation, 20 lags", |b| {
        b.iter(|| autocorrelation(x(), 20))
    });
    group.bench_function("Ljung-Box, 20 lags", |b| {
        b.iter(|| portmanteau(x(), &[20], 0))
    });
    group.bench_function("synthesis", |b| {
        b.iter_batched_ref(
            || (generator(), vec![0.0; SAMPLES]),
            |(generator, out)| generator.fill(out),
            BatchSize::LargeInput,
        )
    });
}

criterion_group! {
    name = all;
    config = Criterion::default().sample_size(20).measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(300));
    targets = likelihoods, fits, allan, statistics
}
criterion_main!(all);
