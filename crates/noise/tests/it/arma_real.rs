//! The real z gyro: the global optimum at the full rate has no bias in it, block averages do.

use crate::common::{number, record, reference};
use undrift_noise::arma::{FitOptions, fit};

#[test]
#[ignore = "slow: fits on a recording of hours"]
fn the_real_gyro_at_several_scales() {
    let Some(reference) = reference() else { return };
    let file = "adis16405-static/run1.csv.gz";
    let Some(axes) = record(file) else { return };
    // Gyros x, y, z first [deg/s].
    let z: Vec<f64> = axes[2].iter().map(|v| v.to_radians()).collect();
    let expected = &reference["real_adis16405_imu1_gz"];
    for block in [1, 10, 100, 500] {
        let means: Vec<f64> = z
            .chunks_exact(block)
            .map(|c| c.iter().sum::<f64>() / block as f64)
            .collect();
        let model = fit(&means, 1, 1, &FitOptions::default()).unwrap();
        let entry = &expected[&format!("block{block}")];
        let gap = model.log_likelihood - number(&entry["loglik"]);
        println!("block {block}: {gap:+.4} {:?} {:?}", model.ar, model.ma);
        // The folder's tolerance for fitted likelihoods, of up to 3.5 million.
        assert!(gap.abs() < 1e-3, "{block} {gap}");
        let off = model.ar[0] - number(&entry["phi"]);
        let errors = model.standard_errors.as_ref().unwrap();
        // Within 1e-5 of the optimum: √(2e-5) standard errors, and the reference's own stop.
        assert!(off.abs() < 0.02 * errors[0], "{block} {off}");
    }
}
