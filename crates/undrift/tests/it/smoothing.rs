//! The smoother on simulated drives: how dense the nodes are does not matter, its errors are as
//! large as it says, and the path between nodes is continuous.

use undrift::{
    nav::{sample::TruthSample, shaping::ShapingFilter},
    reference::{Errors, TruthCursor},
    replay::{Measurement, Outage, Settings, replay},
    simulate::{GnssNoise, Simulation, Trajectory, simulate},
    smooth::{History, Node, Path, Smoothed},
    vehicle::Profile,
};

const RATE: f64 = 50.0;

fn sensors() -> [ShapingFilter; 6] {
    let sensor = |white: f64, sigma: f64, turn_on: f64| {
        ShapingFilter::white(white, 1.0 / RATE)
            .and_then(|w| w.plus(&ShapingFilter::gauss_markov(sigma, 200.0, 1.0 / RATE)?))
            .and_then(|w| w.plus(&ShapingFilter::constant(turn_on, 1.0 / RATE)?))
            .unwrap()
    };
    let (gyro, accel) = (sensor(3e-4, 2e-4, 5e-3), sensor(2e-3, 5e-3, 0.1));
    [gyro, gyro, gyro, accel, accel, accel]
}

fn drive(seed: u64) -> Simulation {
    let car = Trajectory::car(300.0, seed);
    simulate(&car, RATE, Some(&sensors()), &GnssNoise::default(), seed).unwrap()
}

fn settings(nodes: f64) -> Settings {
    let outage = |start: f64| Outage {
        start,
        end: start + 30.0,
    };
    Settings {
        lever_arm: GnssNoise::default().lever_arm,
        outages: vec![outage(120.0), outage(200.0)],
        nodes: Some(nodes),
        ..Settings::new(sensors())
    }
}

fn smoothed(simulation: &Simulation, settings: &Settings) -> Smoothed {
    let mut nodes = History::new().unwrap();
    replay(
        &mut simulation.imu.iter().copied().map(Ok),
        &mut simulation
            .gnss
            .iter()
            .copied()
            .map(Measurement::Gnss)
            .map(Ok),
        settings,
        &mut nodes,
    )
    .unwrap();
    nodes.smooth().unwrap().unwrap()
}

fn near(nodes: &[Node], time: f64) -> Option<&Node> {
    let at = nodes.partition_point(|n| n.nav.time < time - 1e-6);
    nodes.get(at).filter(|n| (n.nav.time - time).abs() < 1e-6)
}

#[test]
fn how_dense_the_nodes_are_does_not_matter() {
    let simulation = drive(3);
    let (dense, sparse) = (
        smoothed(&simulation, &settings(1.0 / RATE)),
        smoothed(&simulation, &settings(1.0)),
    );
    assert!(dense.nodes.len() > 10 * sparse.nodes.len());
    for node in &sparse.nodes {
        let twin = near(&dense.nodes, node.nav.time).unwrap();
        let dr = node.nav.position.offset_to(&twin.nav.position).norm();
        let dv = (node.nav.v_n - twin.nav.v_n).norm();
        let turn = node.nav.q_nb.angle_to(&twin.nav.q_nb);
        // The same sums in another order; the covariances span twelve orders of magnitude.
        assert!(dr < 1e-4 * node.nav_std[0], "{dr}");
        assert!(dv < 1e-4 * node.nav_std[3], "{dv}");
        assert!(turn < 1e-4 * node.nav_std[8], "{turn}");
        for (a, b) in node.nav_std.iter().zip(twin.nav_std) {
            assert!((a / b - 1.0).abs() < 1e-5);
        }
    }
}

#[test]
#[ignore = "slow: 12 drives smoothed"]
fn smoothed_errors_are_as_large_as_stated_and_smaller_than_the_filters() {
    // Outages of 30 s inside; the middle of each is where the smoother gains most.
    let mut scaled = Vec::new();
    let (mut ours, mut forward) = (0.0, 0.0);
    for seed in 0..12 {
        let simulation = drive(seed);
        let result = smoothed(&simulation, &settings(1.0));
        let mut truth = TruthCursor::new(simulation.truth.iter().copied());
        for node in &result.nodes {
            let Some(truth) = truth.at(node.nav.time) else {
                continue;
            };
            let e = Errors::against_truth(&node.nav, &truth).0;
            // Every thirty seconds: nearly independent.
            if (node.nav.time % 30.0) < 0.5 {
                for (error, std) in [
                    (e[0], 0),
                    (e[1], 1),
                    (e[2], 2),
                    (e[4], 3),
                    (e[5], 4),
                    (e[6], 5),
                ] {
                    scaled.push(error / node.nav_std[std]);
                }
                scaled.push(e[9].to_radians() / node.nav_std[8]);
            }
        }
        let middle = |s: &Smoothed| {
            let node = near(&s.nodes, 140.0).unwrap();
            let truth = truth_at(&simulation.truth, 140.0);
            Errors::against_truth(&node.nav, &truth).0[3]
        };
        ours += middle(&result);
        forward += {
            // The log cut off at 140 s: its last node is the filter.
            let mut cut = simulation.clone();
            cut.imu.retain(|s| s.time < 140.0 + 1e-6);
            middle(&smoothed(&cut, &settings(1.0)))
        };
    }
    let mean_square = scaled.iter().map(|x| x * x).sum::<f64>() / scaled.len() as f64;
    // 12 drives × 8 epochs × 7 components; some are correlated within an epoch and a drive: as if a
    // fifth were independent, 4 standard errors of √(2/n).
    let n = scaled.len() as f64 / 5.0;
    assert!(scaled.len() > 500, "{}", scaled.len());
    assert!(
        (mean_square - 1.0).abs() < 4.0 * (2.0 / n).sqrt(),
        "{mean_square}"
    );
    // 20 s into an outage.
    assert!(ours < 0.3 * forward, "{ours} {forward}");
}

fn truth_at(truth: &[TruthSample], time: f64) -> TruthSample {
    truth[truth.partition_point(|t| t.time < time - 1e-6)]
}

#[test]
fn the_path_between_nodes_is_continuous_and_right() {
    let simulation = drive(5);
    let mut with_car = settings(1.0);
    with_car.constraints = Profile::Car.constraints();
    let dense = smoothed(
        &simulation,
        &Settings {
            nodes: Some(1.0 / RATE),
            ..with_car.clone()
        },
    );
    let sparse = smoothed(&simulation, &with_car);
    let mut path = Path::new(&sparse).unwrap();
    let mut rows: Vec<Node> = Vec::new();
    for sample in &simulation.imu {
        let done: Result<(), ()> = path.add(sample, |node| {
            rows.push(node);
            Ok(())
        });
        done.unwrap();
    }
    // Every sample between the first and the last node, once.
    let (first, last) = (
        sparse.nodes[0].nav.time,
        sparse.nodes[sparse.nodes.len() - 1].nav.time,
    );
    let inside = |t: f64| t > first + 1e-6 && t <= last + 1e-6;
    assert_eq!(
        rows.len(),
        simulation.imu.iter().filter(|s| inside(s.time)).count()
    );
    let mut largest: f64 = 0.0;
    for row in &rows {
        let exact = near(&dense.nodes, row.nav.time).unwrap();
        let dr = row.nav.position.offset_to(&exact.nav.position).norm();
        largest = largest.max(dr / exact.nav_std[0]);
    }
    // Integration against the exact smoother at every sample.
    assert!(largest < 0.1, "{largest}");
    let jump = |a: &Node, b: &Node| {
        let dt = b.nav.time - a.nav.time;
        let moved = a.nav.position.offset_to(&b.nav.position);
        (moved - (a.nav.v_n + b.nav.v_n) * (0.5 * dt)).norm()
    };
    let worst = rows
        .windows(2)
        .map(|w| jump(&w[0], &w[1]))
        .fold(0.0, f64::max);
    assert!(worst < 0.01, "{worst}");
}
