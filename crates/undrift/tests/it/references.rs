//! What outages are measured against, which of them count, and what the verdict has of `navigate`'s.

use undrift::{
    BiasModel, Drive, ImuModel, Logs, Schedule, Setup, Trajectory,
    findings::{Finding, Severity, verdict},
    nav::{
        Vector3,
        sample::{GnssFix, ImuSample, Position},
    },
    navigate::{Hindsight, Wanted},
    navigate_drive,
    outages::{Experiment, WhyLeftOut},
    replay::Aid,
    results::Outages,
    simulate,
    simulate::{Barometer, GnssNoise},
    vehicle::Profile,
};

fn model() -> ImuModel {
    ImuModel::preset("adis16465").unwrap()
}

/// A car at 50 Hz with fixes of 0.5 m once a second.
fn logs(seconds: f64) -> (Vec<ImuSample>, Vec<GnssFix>) {
    let noise = model().shaping(BiasModel::GaussMarkov, 0.02).unwrap();
    let receiver = GnssNoise {
        position_std: [0.5, 0.5, 1.0],
        velocity_std: [0.05; 3],
        ..GnssNoise::default()
    };
    let car = Trajectory::car(seconds, 1);
    let log = simulate(&car, 50.0, Some(&noise), &receiver, 1).unwrap();
    (log.imu, log.gnss)
}

fn drive(imu: &[ImuSample], fixes: &[GnssFix]) -> Drive {
    Setup::default().drive(imu, fixes, &model())
}

fn cut(drive: &Drive, at: &[f64], hindsight: Hindsight) -> (Logs, Experiment) {
    let logs = Logs::load(drive, hindsight).unwrap();
    let cuts = logs.plan(&Schedule::At(at.to_vec()), 10.0).unwrap();
    let experiment = logs.run(&[BiasModel::Arma], &cuts, hindsight, &|_| ());
    (logs, experiment.unwrap())
}

fn result(drive: &Drive, at: &[f64], hindsight: Hindsight) -> Outages {
    let (logs, experiment) = cut(drive, at, hindsight);
    logs.result("drive.toml".as_ref(), &experiment, &|of| format!("{of:?}"))
}

/// Every 37th fix is 10 m off.
fn with_wrong(fixes: &[GnssFix]) -> Vec<GnssFix> {
    let moved = |(k, fix): (usize, &GnssFix)| {
        let mut fix = *fix;
        if let Some((Position::Geodetic(at), _)) = &mut fix.position
            && k % 37 == 20
        {
            *at = at.displaced(&Vector3::new(8.0, -6.0, 0.0));
        }
        fix
    };
    fixes.iter().enumerate().map(moved).collect()
}

/// Fixes that are wrong by 10 m do not count as drift, forward and smoothed; they are counted.
#[test]
fn fixes_that_the_run_without_outages_rejects_are_no_reference() {
    let (imu, fixes) = logs(300.0);
    let (right, wrong) = (drive(&imu, &fixes), drive(&imu, &with_wrong(&fixes)));
    // The fixes 94, 131, 168, 205 and 242 are wrong, the second second of it inside each outage.
    let at = [90.0, 127.0, 164.0, 201.0, 238.0];
    for hindsight in [Hindsight::Causal, Hindsight::Smooth] {
        let [right, wrong] = [&right, &wrong].map(|drive| result(drive, &at, hindsight));
        let drift = |of: &Outages| of.models["arma"].max["horizontal_m"].0;
        assert!(
            drift(&wrong) < 1.5 * drift(&right) + 0.5,
            "{} {}",
            drift(&wrong),
            drift(&right)
        );
        assert_eq!((right.withheld, right.rejected), (50, 0));
        assert_eq!((wrong.withheld, wrong.rejected), (50, 5));
        let said = Finding::RejectedReference { fixes: 5, of: 50 };
        assert!(wrong.findings.contains(&said), "{:?}", wrong.findings);
    }
}

/// An outage in a gap of the fixes is left out with the reason, and the rest is as if it had not been asked for.
#[test]
fn an_outage_that_cannot_be_judged_spoils_no_other() {
    let (imu, mut fixes) = logs(240.0);
    fixes.retain(|fix| !(150.0..175.0).contains(&fix.time));
    let drive = drive(&imu, &fixes);
    let with = result(&drive, &[100.0, 145.0, 160.0, 200.0], Hindsight::Causal);
    let without = result(&drive, &[100.0, 200.0], Hindsight::Causal);
    assert_eq!(with.models, without.models);
    assert_eq!(with.outages, without.outages);
    assert!(with.models["arma"].rms["horizontal_m"].0.is_finite());
    let why: Vec<WhyLeftOut> = with.left_out.iter().map(|cut| cut.why).collect();
    assert_eq!(why, [WhyLeftOut::NoReference, WhyLeftOut::InGap]);
    // None is left: no result, and no "usable".
    let none = result(&drive, &[160.0], Hindsight::Causal);
    assert!(none.models.is_empty() && none.failed.is_empty());
    assert_eq!(verdict(&none.findings).0, Severity::Unusable);
}

/// Whatever `navigate` finds of a drive, `outages` reports too: with gyros called rad/s that are deg/s, with a solution that
/// begins late, with nothing wrong.
#[test]
fn the_verdict_of_outages_contains_that_of_navigate() {
    let (imu, fixes) = logs(240.0);
    let mut wrong_unit = imu.clone();
    wrong_unit.iter_mut().for_each(|sample| {
        sample.dtheta *= 0.5;
    });
    let late: Vec<GnssFix> = fixes
        .iter()
        .filter(|fix| fix.time > 150.0)
        .copied()
        .collect();
    for (imu, fixes, at) in [
        (&imu, &fixes, 120.0),
        (&wrong_unit, &fixes, 120.0),
        (&imu, &late, 190.0),
    ] {
        let drive = drive(imu, fixes);
        let navigated = navigate_drive(&drive, BiasModel::Arma, Wanted::default()).unwrap();
        let alone = navigated.findings();
        let (logs, experiment) = cut(&drive, &[at], Hindsight::Causal);
        let both = logs.findings(&experiment);
        for finding in &alone {
            assert!(both.contains(finding), "{finding:?} is not in {both:?}");
        }
        assert!(verdict(&both).0 >= verdict(&alone).0);
    }
}

/// The last model without a constraint or a sensor is that of a drive which has none of it; what was not used has no row.
#[test]
fn each_constraint_and_sensor_is_left_out_by_itself() {
    let (imu, fixes) = logs(240.0);
    let car = Trajectory::car(240.0, 1);
    let heights = Barometer::default().measure(&car, 1).unwrap();
    let heights = Vec::from_iter(heights);
    let gnss_only = drive(&imu, &fixes).with_vehicle(Profile::Car);
    let whole = gnss_only.clone().with_barometer(&heights);
    let run = |drive: &Drive, without| {
        let logs = Logs::load(drive, Hindsight::Causal).unwrap();
        let cuts = logs.plan(&Schedule::At(vec![90.0, 130.0, 170.0, 210.0]), 20.0);
        let models = [BiasModel::White.into(), BiasModel::Arma.into()];
        let done = &|_| ();
        let experiment = logs.compare(&models, &cuts.unwrap(), Hindsight::Causal, without, done);
        logs.result("drive.toml".as_ref(), &experiment.unwrap(), &|of| {
            format!("{of:?}")
        })
    };
    let all = run(&whole, true);
    let names: Vec<&str> = all.without.keys().map(String::as_str).collect();
    assert_eq!(names, ["barometer", "non_holonomic", "zero_velocity"]);
    let mut sliding = whole.clone();
    sliding.constraints = sliding.constraints.without(Aid::NonHolonomic);
    let sliding = run(&sliding, false);
    assert_eq!(all.without["non_holonomic"], sliding.models["arma"]);
    assert_eq!(all.models, run(&whole, false).models);
    let rms = |of: &Outages, key: &str| of.models["arma"].rms[key].0;
    assert!(2.0 * rms(&all, "horizontal_m") < rms(&sliding, "horizontal_m"));
    let height = [
        &all.without["barometer"].rms["down_m"].0,
        &rms(&run(&gnss_only, false), "down_m"),
    ]
    .map(|m| *m);
    assert!((height[0] / height[1] - 1.0).abs() < 1e-3, "{height:?}");
    assert!(
        run(&gnss_only, true)
            .without
            .keys()
            .all(|key| key != "barometer")
    );
}
