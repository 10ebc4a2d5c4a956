use super::{loops::Recurse, *};
use crate::vector::{Task, vectorised};

fn noise(n: usize) -> Vec<f64> {
    let mut s = 1u64;
    (0..n)
        .map(|_| {
            s = s
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (s >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        })
        .collect()
}

/// The sums by their definition, one sample after the other.
fn plainly(x: &[f64], centre: f64, phi: &[f64], theta: &[f64]) -> Accumulated {
    let (n, r) = (x.len(), phi.len().max(theta.len()));
    let recursion = |u: &dyn Fn(usize) -> f64| {
        let mut a = vec![0.0; n];
        for t in 0..n {
            let past: f64 = (1..=theta.len().min(t))
                .map(|j| theta[j - 1] * a[t - j])
                .sum();
            a[t] = u(t) + past;
        }
        a
    };
    let autoregression = |x: &dyn Fn(usize) -> f64, t: usize| {
        let past: f64 = (1..=phi.len().min(t)).map(|i| phi[i - 1] * x(t - i)).sum();
        x(t) - past
    };
    let a = recursion(&|t| autoregression(&|t| x[t] - centre, t));
    let o = recursion(&|t| autoregression(&|_| 1.0, t));
    let g = recursion(&|t| f64::from(t == 0));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum();
    let lags = |of: &[f64]| (0..r).map(|i| dot(&of[i..], &g)).collect();
    Accumulated {
        squares: dot(&a, &a),
        ones_squares: dot(&o, &o),
        ones_cross: dot(&o, &a),
        state_cross: lags(&a),
        ones_state: lags(&o),
        state_lags: lags(&g),
        last_impulse: (0..r).map(|k| g[n - 1 - k]).collect(),
    }
}

#[test]
fn pieces_make_the_plain_sums() {
    for (phi, theta) in [
        (&[0.99995][..], &[0.9994][..]),
        (&[0.3], &[-0.7]),
        (&[0.999, 0.0005], &[1.99, -0.9901]),
        (&[0.5, 0.2, -0.1, 0.05], &[0.3, -0.2, 0.8]),
        (&[0.5], &[0.1, 0.2, 0.1, -0.3, 0.2, 0.1, 0.05]),
        (&[], &[0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.4]),
        (&[1.2, -0.5], &[]),
        (&[], &[]),
    ] {
        for n in [700, 3 * BLOCK, 5 * BLOCK + 77] {
            let x = noise(n);
            let point = (phi.to_vec(), theta.to_vec());
            let twice = accumulate(&x, 0.1, &[point.clone(), point], true);
            assert_eq!(twice[0], twice[1]);
            let (ours, plain) = (&twice[0], plainly(&x, 0.1, phi, theta));
            let near = |a: f64, b: f64, size: f64| {
                // Rounding of recursions with gain at most 1e4 over 5e3 samples.
                assert!(
                    (a - b).abs() <= 1e-10 * size,
                    "{a} {b} {phi:?} {theta:?} {n}"
                );
            };
            near(ours.squares, plain.squares, plain.squares);
            near(ours.ones_squares, plain.ones_squares, plain.ones_squares);
            let ones = plain.ones_squares.sqrt();
            let record = plain.squares.sqrt();
            near(ours.ones_cross, plain.ones_cross, ones * record);
            for i in 0..plain.state_lags.len() {
                let impulse = plain.state_lags[0].sqrt();
                near(ours.state_cross[i], plain.state_cross[i], impulse * record);
                near(ours.ones_state[i], plain.ones_state[i], impulse * ones);
                near(ours.state_lags[i], plain.state_lags[i], impulse * impulse);
                near(ours.last_impulse[i], plain.last_impulse[i], impulse);
            }
            // Without ones nothing else changes.
            let known = accumulate(&x, 0.1, &[(phi.to_vec(), theta.to_vec())], false);
            assert_eq!(known[0].state_cross, ours.state_cross);
            assert_eq!(known[0].ones_cross, 0.0);
        }
    }
}

#[test]
fn both_ways_of_compiling_agree() {
    let mut fused = noise(PIECE * LANES);
    fused.extend([0.0; LANES]);
    let mut rows: Vec<Row> = fused
        .chunks_exact(LANES)
        .map(|c| c.try_into().unwrap())
        .collect();
    let mut plain = rows.clone();
    vectorised(Recurse {
        theta: &[0.9],
        rows: &mut rows,
    });
    Recurse {
        theta: &[0.9],
        rows: &mut plain,
    }
    .run::<false>();
    for (a, b) in rows.iter().flatten().zip(plain.iter().flatten()) {
        // Rounding of sums of about ten terms below 1.
        assert!((a - b).abs() < 1e-14);
    }
}
