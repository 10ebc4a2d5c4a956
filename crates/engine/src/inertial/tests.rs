use super::{super::summary::MOST_EVENTS, *};
use alloc::vec::Vec;

/// A number between −1 and 1 that does not repeat soon.
fn noise(k: usize, axis: usize) -> f64 {
    ((k * AXES + axis) as f64 * 78.233).sin()
}

/// Two minutes at 100 Hz, altered: what comes out, and what is noted.
fn run(value: impl Fn(usize, usize) -> f64) -> (Vec<Checked>, Summary) {
    run_after(Summary::default(), value)
}

/// The same after what was noted before.
fn run_after(mut summary: Summary, value: impl Fn(usize, usize) -> f64) -> (Vec<Checked>, Summary) {
    let turn = undrift_nav::attitude::from_rpy(&Vector3::new(0.3, -0.2, 2.0));
    let rotation = turn.to_rotation_matrix().into_inner();
    let mut inertial = Inertial::new(rotation);
    let mut out = Vec::new();
    for k in 0..12_000 {
        let of = |from: usize| Vector3::from_fn(|i, _| value(k, from + i)) * 0.01;
        let sample = ImuSample {
            time: 0.01 * (k + 1) as f64,
            dt: 0.01,
            dtheta: rotation * of(0),
            dvel: rotation * of(3),
        };
        out.extend(inertial.next(sample, true, &mut summary));
    }
    out.extend(inertial.last(true, &mut summary));
    assert_eq!(out.len(), 12_000);
    (out, summary)
}

#[test]
fn what_is_sound_stays_as_it_is() {
    let (out, summary) = run(noise);
    assert!(out.iter().all(|checked| checked.doubt.is_none()));
    assert!(summary.sample_faults.is_empty());
    // Rounded coarsely, at rest: values repeat.
    let (out, _) = run(|k, axis| (0.6 * noise(k, axis)).round() * 0.01);
    assert!(out.iter().all(|checked| checked.doubt.is_none()));
}

#[test]
fn a_spike_is_replaced_by_its_neighbours() {
    let value = |k, axis| {
        if (k, axis) == (5000, 2) {
            35.0
        } else {
            0.01 * noise(k, axis)
        }
    };
    let (out, summary) = run(value);
    let doubted: Vec<usize> = (0..out.len()).filter(|k| out[*k].doubt.is_some()).collect();
    assert_eq!(doubted, [5000]);
    assert!(out[5000].sample.dtheta.norm() < 0.01 * 0.05);
    assert_eq!(summary.sample_faults.len(), 1);
    assert_eq!(summary.sample_faults[0].axis, 2);
}

#[test]
fn a_frozen_axis_is_in_doubt_by_what_it_usually_does() {
    let (from, to) = (6000, 9000);
    let value = |k: usize, axis: usize| {
        let k = if axis == 2 && (from..to).contains(&k) {
            from
        } else {
            k
        };
        0.2 * (0.002 * k as f64).sin() + 0.01 * noise(k, axis)
    };
    let (out, summary) = run(value);
    let doubted = out.iter().filter(|checked| checked.doubt.is_some()).count();
    // Half a second goes by before it is known.
    assert!((2945..=2955).contains(&doubted), "{doubted}");
    let total: f64 = out
        .iter()
        .filter_map(|checked| checked.doubt)
        .map(|doubt| doubt[0].trace())
        .sum();
    // 0.2/√2 rad/s, at least what a vehicle may do, over 30 s, independent after 5 s.
    let std = (0.2 / 2f64.sqrt()).max(RATE);
    let expected = std * std * 5.0 * (2.0 * 30.0 - 5.0);
    assert!(
        (0.7..1.4).contains(&(total / expected)),
        "{}",
        total / expected
    );
    let fault = summary.sample_faults[0];
    assert_eq!((fault.axis, summary.sample_faults.len()), (2, 1));
    assert!((fault.start - 60.01).abs() < 0.02 && (fault.end - 90.0).abs() < 0.02);
}

#[test]
fn an_axis_is_in_doubt_by_as_much_where_no_more_faults_are_noted() {
    let value = |k: usize, axis: usize| {
        let k = if axis == 2 { k.min(6000) } else { k };
        let burst = axis == 3 && k > 3000 && k % 1000 < 30;
        if burst { 40.0 } else { noise(k, axis) }
    };
    let mut full = Summary::default();
    for k in 0..MOST_EVENTS {
        full.spike(5, k as f64 - 2000.0);
    }
    assert_eq!(full.sample_faults.len(), MOST_EVENTS);
    let ((out, noted), (after, full)) = (run(value), run_after(full, value));
    assert!(noted.sample_faults.len() > 1 && full.sample_faults.len() == MOST_EVENTS);
    for (one, other) in out.iter().zip(&after) {
        assert_eq!(one.doubt, other.doubt, "{}", one.sample.time);
    }
}

#[test]
fn a_saturated_axis_is_in_doubt() {
    let value = |k: usize, axis: usize| {
        let burst = axis == 0 && k > 3000 && k % 1000 < 30;
        if burst { 4.0 } else { 0.1 * noise(k, axis) }
    };
    let (out, summary) = run(value);
    let doubted = out.iter().filter(|checked| checked.doubt.is_some()).count();
    // Nine bursts, the first from its second sample on.
    assert_eq!(doubted, 29 + 8 * 30);
    assert_eq!(summary.sample_faults.len(), 9);
}

/// An axis of numbers between −1 and 1 that has once reached ±6, a value at a time.
fn known_axis() -> (AxisWatch, f64) {
    let mut axis = Inertial::new(Matrix3::identity()).axes[0];
    let mut time = 0.0;
    for k in 0..2000 {
        time += 0.01;
        let value = match k {
            1000 => 6.0,
            1010 => -6.0,
            _ => noise(k, 0),
        };
        assert!(!axis.is_stuck((time, 0.01), value));
        axis.learn(0.01, value);
    }
    (axis, time)
}

/// How many samples of one value it takes until it is stuck.
fn samples_until_stuck(value: f64) -> usize {
    let (mut axis, time) = known_axis();
    (1..1000)
        .find(|k| axis.is_stuck((time + 0.01 * *k as f64, 0.01), value))
        .unwrap()
}

#[test]
fn an_axis_is_saturated_at_the_ends_of_what_it_has_read() {
    // No value ever came twice: five times the usual number is five.
    for end in [6.0, 6.1, 30.0] {
        assert_eq!(
            (samples_until_stuck(end), samples_until_stuck(-end)),
            (5, 5)
        );
    }
    // Inside its range, however far out, it has to last for half a second.
    for inside in [5.9, 3.5, 0.5] {
        assert_eq!(
            (samples_until_stuck(inside), samples_until_stuck(-inside)),
            (51, 51)
        );
    }
}

#[test]
fn what_an_axis_usually_does_is_its_mean_and_variance() {
    let mut axis = AxisWatch::default();
    // 3 and 7 in turn, of which the first counts as the mean.
    for k in 0..5_000 {
        axis.learn(0.01, if k % 2 == 0 { 3.0 } else { 7.0 });
    }
    assert!((axis.mean - 5.0).abs() < 1e-3, "{}", axis.mean);
    // The mean on the way is off by 1/k: of five thousand two thousandths.
    assert!((axis.variance - 4.0).abs() < 0.02, "{}", axis.variance);
    assert!((axis.known - 50.0).abs() < 1e-6);
    // Over a minute the past is forgotten by e.
    axis.known = 60.0;
    let (mean, span) = (axis.mean, 6000);
    for _ in 0..span {
        axis.learn(0.01, mean + 1.0);
    }
    let expected = 1.0 - (1.0 - 0.01f64 / 60.0).powi(span);
    assert!((axis.mean - mean - expected).abs() < 1e-9);
}

#[test]
fn a_spike_is_far_from_neighbours_that_agree() {
    let is = |seen: u64, step: f64, around: [f64; 2], value: f64| {
        let mut axis = AxisWatch {
            seen,
            step,
            ..AxisWatch::default()
        };
        axis.is_spike(1.0, around, value)
    };
    let known = LEAST_VALUES;
    // Further than the least of 1, and than 25 usual steps.
    assert!(is(known, 0.01, [0.0, 0.0], 1.01) && !is(known, 0.01, [0.0, 0.0], 0.99));
    assert!(is(known, 0.1, [1.0, 1.0], -1.51) && !is(known, 0.1, [1.0, 1.0], -1.49));
    // Of neighbours that are apart by less than three tenths of that.
    assert!(is(known, 0.01, [-0.59, 0.59], 4.0) && !is(known, 0.01, [-0.61, 0.61], 4.0));
    assert!(!is(known - 1, 0.01, [0.0, 0.0], 5.0));
}

/// Nine in ten distances are smaller than the step.
#[test]
fn the_step_is_a_quantile_of_nine_in_ten() {
    let mut axis = AxisWatch::default();
    let (mut sum, mut count) = (0.0, 0);
    for k in 0..20_000 {
        // Distances that are uniform from 0 to 1.
        let off = (k as f64 * 0.618_033_988_75).fract();
        axis.is_spike(1e9, [0.0, 0.0], off);
        if k > 2000 {
            (sum, count) = (sum + axis.step, count + 1);
        }
    }
    let mean = sum / f64::from(count);
    // By steps of a twentieth it scatters about that.
    assert!((mean - 0.9).abs() < 0.03, "{mean}");
}

/// Samples at 100 Hz of an IMU that reads these, from a watch that knows its axes; what comes out.
fn through(
    values: &[[f64; AXES]],
    dts: &[f64],
    moves: bool,
    prepare: impl Fn(&mut Inertial),
) -> (Vec<Checked>, Inertial) {
    let mut summary = Summary::default();
    let mut inertial = Inertial::new(Matrix3::identity());
    prepare(&mut inertial);
    let (mut out, mut time) = (Vec::new(), 0.0);
    for (values, dt) in values.iter().zip(dts) {
        time += dt;
        let of = |from: usize| Vector3::from_column_slice(&values[from..from + 3]) * *dt;
        let sample = ImuSample {
            time,
            dt: *dt,
            dtheta: of(0),
            dvel: of(3),
        };
        out.extend(inertial.next(sample, moves, &mut summary));
    }
    out.extend(inertial.last(moves, &mut summary));
    assert_eq!(
        inertial.last(moves, &mut summary).map(|of| of.sample.time),
        None
    );
    (out, inertial)
}

fn known(inertial: &mut Inertial) {
    for axis in &mut inertial.axes {
        (axis.seen, axis.step) = (LEAST_VALUES, 0.02);
    }
}

#[test]
fn a_replaced_spike_is_in_doubt_by_the_usual_steps_and_its_neighbours_distance() {
    let at = |k: usize| {
        let mut values: [f64; AXES] = core::array::from_fn(|axis| 0.001 * noise(k, axis));
        values[0] = [0.1, 4.0, 0.3, 0.2][k];
        values[4] = [0.0, 0.0, 90.0, 2.0][k];
        values
    };
    let values: Vec<[f64; AXES]> = (0..4).map(at).collect();
    let (out, _) = through(&values, &[0.01; 4], true, known);
    let doubt = |k: usize| out[k].doubt.unwrap();
    assert!(out[0].doubt.is_none() && out[3].doubt.is_none());
    // (5 · 0.02 + 0.2) rad/s over 0.01 s, about one axis.
    let spread = |std: f64| (std * 0.01) * (std * 0.01);
    let [turn, gain] = doubt(1);
    assert!(
        (turn[(0, 0)] / spread(0.3) - 1.0).abs() < 1e-9
            && (turn.sum() / turn[(0, 0)] - 1.0).abs() < 1e-9
    );
    assert_eq!(gain, Matrix3::zeros());
    assert!((out[1].sample.dtheta.x - 0.2 * 0.01).abs() < 1e-12);
    // Accelerometer y between 0 and 2, after a step that was beyond the usual one.
    let [turn, gain] = doubt(2);
    let step = 0.02 * (1.0 + 0.9 * STEP_GAIN);
    assert!((gain[(1, 1)] / spread(2.0 + 5.0 * step) - 1.0).abs() < 1e-9);
    assert_eq!(turn, Matrix3::zeros());
    assert!((out[2].sample.dvel.y - 1.0 * 0.01).abs() < 1e-12);
    // The next sample's neighbour is the replacement, 0.2, not the spike, 4.
    assert!((out[2].sample.dtheta.x - 0.3 * 0.01).abs() < 1e-12);
}

#[test]
fn a_sample_beyond_a_gap_is_no_neighbour() {
    let values: Vec<[f64; AXES]> = (0..3)
        .map(|k| {
            let mut values = [0.001; AXES];
            values[2] = [0.1, 9.0, 0.1][k];
            values
        })
        .collect();
    for (after, is_spike) in [(0.0149, true), (0.0151, false)] {
        let (out, _) = through(&values, &[0.01, 0.01, after], true, known);
        assert_eq!(out[1].doubt.is_some(), is_spike, "{after}");
    }
    // Nor are the first and the last sample between two.
    let ends = [[9.0; AXES], [0.1; AXES], [9.0; AXES]];
    let (out, _) = through(&ends, &[0.01; 3], true, known);
    assert!(out[0].doubt.is_none() && out[2].doubt.is_none());
}

#[test]
fn a_sensor_that_repeats_all_its_values_at_rest_has_no_noise() {
    let values = [[0.5; AXES]; 620];
    for (moves, noiseless) in [(false, true), (true, false)] {
        let (_, inertial) = through(&values, &[0.01; 620], moves, |_| ());
        assert_eq!(inertial.noiseless, noiseless);
    }
    // Five seconds of it.
    let (_, short) = through(&values[..499], &[0.01; 499], false, |_| ());
    assert!(!short.noiseless);
    // One axis that changes is enough.
    let mut alive = values;
    for (k, values) in alive.iter_mut().enumerate() {
        values[5] = noise(k, 5);
    }
    assert!(!through(&alive, &[0.01; 620], false, |_| ()).1.noiseless);
}

#[test]
fn values_are_the_same_to_a_part_in_ten_to_the_twelve() {
    assert!(is_same(3.0, 3.0 + 3.9e-12) && !is_same(3.0, 3.0 + 4.1e-12));
    assert!(is_same(0.0, -0.9e-12) && !is_same(0.0, -1.1e-12) && !is_same(-2.0, 2.0));
}
