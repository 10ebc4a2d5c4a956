use super::*;
use nalgebra::SMatrix;

const N: usize = NAV + AXES;
type Square = SMatrix<f64, N, N>;

/// Numbers between −1 and 1.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

fn step(seed: u64, time: f64, span: f64, channel: Channel) -> LinearStep<N> {
    let mut next = numbers(seed);
    let nav = std::array::from_fn(|_| std::array::from_fn(|_| next()));
    LinearStep {
        time,
        span,
        nav,
        shift: [0.0; N],
        left: std::array::from_fn(|_| next()),
        inputs: inputs(&nav, span),
        shape: std::array::from_fn(|_| next().abs()),
        channel,
        size: 3,
        h: std::array::from_fn(|_| std::array::from_fn(|_| next())),
        innovation: [next(), next(), next()],
        noise: [[1.0; MOST]; MOST],
        weakened: 1.0,
        correction: std::array::from_fn(|_| next()),
    }
}

/// The whole transition of a step.
fn whole(step: &LinearStep<N>) -> Square {
    Square::from_fn(|i, j| match i {
        0..NAV => step.nav[i][j],
        _ => f64::from(u8::from(i == j)) * step.left[i],
    })
}

#[test]
fn two_steps_made_into_one_are_their_product() {
    let (first, second, third) = (
        step(1, 10.1, 0.1, Channel::Position),
        step(2, 10.15, 0.05, Channel::Velocity),
        step(3, 10.4, 0.25, Channel::Other),
    );
    let two = first.then(&second);
    let three = two.then(&third);
    let near = |a: Square, b: Square| (a - b).amax() < 1e-12;
    assert!(near(whole(&two), whole(&second) * whole(&first)));
    assert!(near(
        whole(&three),
        whole(&third) * whole(&second) * whole(&first)
    ));
    // What the updates on the way took out arrives with the steps after them.
    let taken = |step: &LinearStep<N>| nalgebra::SVector::<f64, N>::from(step.correction);
    let shift = whole(&second) * taken(&first);
    let further = whole(&third) * (shift + taken(&second));
    for i in 0..N {
        assert!((two.shift[i] - shift[i]).abs() < 1e-12);
        assert!((three.shift[i] - further[i]).abs() < 1e-12);
    }
    for i in 0..AXES {
        let mean = (0.1 * first.shape[i] + 0.05 * second.shape[i]) / 0.15;
        assert!((two.shape[i] - mean).abs() < 1e-12);
    }
    assert!((two.span - 0.15).abs() < 1e-12 && (three.span - 0.4).abs() < 1e-12);
    // The update is that at the end.
    assert_eq!(
        (two.time, two.channel, two.h, two.innovation),
        (10.15, Channel::Velocity, second.h, second.innovation)
    );
    assert_eq!(two.correction, second.correction);
}

#[test]
fn noise_comes_in_by_the_transitions_own_columns() {
    let span = 0.5;
    let nav: [[f64; N]; NAV] = step(4, 1.0, span, Channel::Other).nav;
    let found = inputs(&nav, span);
    for axis in 0..3 {
        for i in 0..3 {
            // A gyro turns the attitude, and that by the force the velocity.
            assert!((found[axis].attitude[i] - nav[6 + i][NAV + axis] / span).abs() < 1e-12);
            let velocity: f64 = (0..3)
                .map(|j| nav[3 + i][6 + j] / span * nav[6 + j][NAV + axis] / span)
                .sum();
            assert!((found[axis].velocity[i] - velocity).abs() < 1e-12);
            assert!(
                (found[3 + axis].velocity[i] - nav[3 + i][NAV + 3 + axis] / span).abs() < 1e-12
            );
        }
        assert_eq!(found[3 + axis].attitude, Vector3::zeros());
    }
    let nothing = inputs(&nav, 0.0);
    assert!(
        nothing
            .iter()
            .all(|input| input.velocity == Vector3::zeros() && input.attitude == Vector3::zeros())
    );
}

#[test]
fn steps_that_end_with_fixes_are_joined_up_to_a_quarter_of_a_second() {
    use Channel::{NonHolonomic, Other, Position, Velocity};
    let steps: Vec<LinearStep<N>> = [
        (0.1, Position),
        (0.1, Velocity),
        (0.05, Other),
        (0.1, NonHolonomic),
        (0.2, Position),
        (0.1, Other),
        (0.1, Position),
    ]
    .into_iter()
    .zip(1..)
    .map(|((span, channel), k)| step(k, k as f64, span, channel))
    .collect();
    let joined = without_fixes(&steps);
    let ends: Vec<Option<usize>> = joined
        .iter()
        .map(|of| of.as_ref().map(|(last, _)| *last))
        .collect();
    // 0.1 + 0.1 + 0.05 s; 0.2 + 0.1 s are too long; the last fix has none after it.
    assert_eq!(ends, [Some(2), None, None, None, None, None, None]);
    let (_, sum) = joined[0].as_ref().unwrap();
    let exact = whole(&steps[2]) * whole(&steps[1]) * whole(&steps[0]);
    assert!((whole(sum) - exact).amax() < 1e-12);
}

#[test]
fn noise_beyond_the_model_is_none_below_it() {
    let followed = Followed {
        white: [4.0, 4.0, 4.0, 1.0, 1.0, 1.0],
        interval: 0.5,
        factors: [1.0, 2.0, 1.0, 1.0, 1.0, 3.0],
    };
    let found = followed.beyond(&[6.0, 6.0, 3.0, 1.0, 3.0, 10.0]);
    assert_eq!(found, [1.0, 0.25, 0.0, 0.0, 1.0, 0.5]);
}
