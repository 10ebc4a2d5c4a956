use super::*;

#[test]
fn numbers_by_their_names() {
    let lever_arm = Vector3::new(1.0, 2.0, 3.0);
    let aiding = |name| Aiding::scalar(name, 4.0, lever_arm);
    assert_eq!(aiding("course"), Some(Aiding::Course(4.0)));
    let speed = 4.0;
    assert_eq!(
        aiding("odometer"),
        Some(Aiding::Odometer { speed, lever_arm })
    );
    assert_eq!(aiding("barometer"), Some(Aiding::Barometer(4.0)));
    assert_eq!(aiding("position"), None);
}
