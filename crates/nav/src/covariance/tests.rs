use super::*;
use crate::{
    attitude::from_rpy,
    earth::Geodetic,
    mechanisation::{Increments, NavState},
    parameters::{Parameter, Parameters, Prior},
};

/// To the last bit: no product may be fused, whatever the processor has.
#[test]
fn four_lanes_give_the_same_numbers() {
    const N: usize = 9 + 16 + 3;
    let dt = 0.01;
    let model = |order: usize| match order {
        0 => ShapingFilter::white(1e-3, dt),
        n => ShapingFilter::arma(&[0.9, -0.2, 0.1, 0.05, 0.02, 0.01][..n], &[], 2e-2, dt),
    };
    let sensors = Sensors::new([0, 1, 2, 3, 4, 6].map(|order| model(order).unwrap()));
    let parameters = Parameters::none().with(Parameter::GyroScale, Prior::default());
    let mut nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: Vector3::new(15.0, 1.0, 0.1),
        q_nb: from_rpy(&Vector3::new(0.1, -0.2, 1.0)),
    };
    let increments = Increments {
        dt,
        rotation: Vector3::new(1e-4, -2e-3, 5e-3),
        dvel: Vector3::new(0.01, -0.02, -0.098),
    };
    let coupling = Coupling::new(
        &parameters,
        sensors.states(),
        [
            &(increments.rotation / dt),
            &(increments.dvel / dt),
            &Vector3::new(1.0, -0.5, 2.0),
        ],
    );
    let mut wide = [[0.0; N]; N];
    for (i, row) in wide.iter_mut().enumerate() {
        row[i] = 0.1 + i as f64;
    }
    let mut plain = wide;
    for k in 0..200 {
        let step = nav.step(&increments);
        let transition = Transition::new(&step, &nav.q_nb.to_rotation_matrix().into_inner());
        let part = if k % 7 == 0 { Part::Inner } else { Part::Last };
        sensors.propagate(&mut wide, &transition, &coupling, dt, part);
        sensors.propagate_inlined(&mut plain, &transition, &coupling, dt, part);
        assert_eq!(wide, plain, "step {k}");
    }
}
