use super::*;
use undrift_nav::{
    Matrix3,
    attitude::{from_rpy, to_rpy},
};

/// A sensor that heads for 30 deg in a vehicle 5 deg to the right of it.
#[test]
fn the_vehicles_attitude_is_the_sensors_turned_by_the_mounting() {
    let yaw = |deg: f64| from_rpy(&Vector3::new(0.0, 0.0, deg.to_radians()));
    let node = Node {
        nav: NavState {
            time: 1.0,
            position: Geodetic::from_degrees(45.0, 7.0, 300.0),
            v_n: Vector3::zeros(),
            q_nb: yaw(30.0),
        },
        nav_std: [1.0; NAV],
        q_bv: yaw(5.0),
        vehicle_std: [0.1, 0.2, 0.3],
        predicted: Predicted([Matrix3::identity(); 3]),
        estimates: Vec::new(),
        sensor_error: [0.0; AXES],
        sensor_error_std: [0.0; AXES],
        omega_nb_b: Vector3::zeros(),
        late: 0.0,
        receiver_clock: ReceiverClock::default(),
    };
    let (q_nv, std) = node.vehicle_attitude();
    assert!((to_rpy(&q_nv).z.to_degrees() - 35.0).abs() < 1e-9);
    assert_eq!(std, [0.1, 0.2, 0.3]);
}
/// Heading east with the antenna 1.5 m ahead of the IMU, of which half a metre is estimated; the fix holds 0.1 s later.
#[test]
fn the_antenna_is_ahead_of_the_imu_and_where_the_fix_holds() {
    use undrift_nav::{parameters::Prior, shaping::ShapingFilter};
    let white = ShapingFilter::white(1e-3, 0.01).unwrap();
    let smoothed = Smoothed {
        nodes: Vec::new(),
        start: Vec::new(),
        sensors: Sensors::new([white; AXES]),
        parameters: Parameters::none().with(Parameter::LeverArm, Prior::constant(1.0)),
    };
    let position = Geodetic::from_degrees(45.0, 7.0, 300.0);
    let node = Node {
        nav: NavState {
            time: 1.0,
            position,
            v_n: Vector3::new(3.0, 4.0, 0.0),
            q_nb: from_rpy(&Vector3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2)),
        },
        nav_std: [1.0; NAV],
        q_bv: Quaternion::identity(),
        vehicle_std: [0.0; 3],
        predicted: Predicted([Matrix3::identity(); 3]),
        estimates: vec![0.5, 0.0, 0.0],
        sensor_error: [0.0; AXES],
        sensor_error_std: [0.0; AXES],
        // To the right: the antenna goes south.
        omega_nb_b: Vector3::new(0.0, 0.0, 0.2),
        late: 0.1,
        receiver_clock: ReceiverClock::default(),
    };
    let (found, velocity) = smoothed.antenna(&node, &Vector3::new(1.0, 0.0, 0.0));
    assert!(
        (velocity - Vector3::new(2.7, 4.0, 0.0)).norm() < 1e-12,
        "{velocity}"
    );
    let offset = position.ned_to(&found);
    // A metre of a sphere of six million: rounding of the latitude.
    assert!(
        (offset - Vector3::new(0.27, 1.9, 0.0)).norm() < 1e-6,
        "{offset}"
    );
}
