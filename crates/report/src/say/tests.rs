//! The exact sentence of each finding.

use super::*;
use undrift::{
    findings::{Log, NoError, Severity},
    replay::{Contradiction, FixMend, Lean, Part, RestartCause},
};

/// Fifteen positions of a jump.
fn jump() -> Contradiction {
    Contradiction {
        part: Part::Position,
        start: 243_311.0,
        end: 243_315.0,
        fixes: 15,
        first: 2.31,
        last: 17.02,
        growth: 3.68,
        largest: 17.02,
        frozen: false,
        gave_way: true,
    }
}

#[test]
fn every_finding_has_its_sentence() {
    let (start, length) = (12.5, 3.0);
    let accuracy = |part, factor, adapted, correlated| Finding::WrongAccuracy {
        part,
        factor,
        adapted,
        correlated,
    };
    let held = |axis, saturated| Finding::Held {
        axis,
        value: 2.0,
        start,
        length,
        samples: 300,
        saturated,
    };
    for (finding, sentence) in [
        (
            Finding::Diverged { time: 61.25 },
            "the solution diverged at 61.25 s and ends there",
        ),
        (
            Finding::NotCompared {
                why: NoError::NoOverlap,
                truth: [0.0, 50.0],
                started: Some(100.0),
                ended: 200.5,
            },
            "no errors against the truth: the truth does not overlap the solution (truth 0-50 s, solution 100-200.5 s); check the time columns, or set truth.time_offset",
        ),
        (Finding::Bridged { gaps: 1 }, "bridged 1 short gap between samples"),
        (
            Finding::Temperature {
                corrected: 0,
                without: 9,
                without_from: Some(1.0),
                beyond: 0,
                seen_c: None,
            },
            "the model's temperature correction is not used: the inertial log has no temperature",
        ),
        (
            Finding::Temperature {
                corrected: 90,
                without: 10,
                without_from: Some(12.5),
                beyond: 45,
                seen_c: Some([20.0, 31.25]),
            },
            "corrected for temperature (20.0 to 31.2 °C), but not 10.00 % of the samples, from 12.5 s on, which have no temperature within a minute; 50 % of it is extrapolated beyond the temperatures of the model's recording: record a wider range",
        ),
        (
            Finding::LongGaps {
                gaps: 2,
                first: 20.0,
                longest: 4.5,
            },
            "IMU log: 2 gaps without samples, the first at 20 s, the longest 4.5 s; do not trust the solution there, or leave it out with [span]",
        ),
        (
            Finding::WithoutGnss { start, length },
            "longest span without a usable fix: 3.0 s from 12.5 s",
        ),
        (
            Finding::EndsEarly {
                end: 12.5,
                missing: 300.0,
            },
            "IMU log: ends at 12.5 s, 300 s before the last fix: it may be cut short",
        ),
        (
            Finding::NoMounting {
                driving: Some(12.0),
                wander: None,
                std: None,
            },
            "the mounting was not found: only 12 s of driving above 0.7 m/s with a known heading, 30 s are needed; the solution is in the sensor's axes, and no constraint of the vehicle was applied: set imu.mounting or imu.axes",
        ),
        (
            Finding::NoMounting {
                driving: None,
                wander: Some(0.35),
                std: None,
            },
            "the mounting was not found: the direction of motion varies by 20 deg in sensor axes; the solution is in the sensor's axes, and no constraint of the vehicle was applied: set imu.mounting or imu.axes",
        ),
        (
            Finding::BadCovariance { fixes: 3 },
            "rejected 3 fixes whose covariance is not positive definite",
        ),
        (
            Finding::Frozen {
                start,
                length,
                samples: 300,
            },
            "all six IMU axes repeat the same values for 3.00 s from 12.5 s (300 samples): the log or the sensor is frozen",
        ),
        (
            held(2, false),
            "gyro z stays at 2 (as logged) for 3.00 s from 12.5 s (300 samples): the sensor is frozen, disconnected or too coarse",
        ),
        (
            held(4, true),
            "accelerometer y stays at 2 (as logged) for 3.00 s from 12.5 s (300 samples), its largest or smallest value: the sensor is saturated or too coarse",
        ),
        (
            Finding::WrongGravity { ratio: 0.102 },
            "the accelerometers measure 0.102 times gravity on average: check imu.accel_unit (the numbers look like g)",
        ),
        (
            Finding::NotDown {
                down: [0.0, 0.0, -1.0],
            },
            "the IMU seems to be upside down (gravity points up in the body axes): check the signs in imu.axes, or set imu.mounting = \"auto\"",
        ),
        (
            Finding::NotDown {
                down: [0.0, -1.0, 0.0],
            },
            "the IMU seems to be tilted by 90° (gravity points left in the body axes): check imu.axes and the order of imu.accel, or set imu.mounting = \"auto\"",
        ),
        (
            Finding::Constant {
                axis: 2,
                value: 0.0,
                samples: 900,
                vertical: true,
            },
            "gyro z is constant (0) in all 900 samples: check imu.gyro; if the column is right, the sensor is faulty or too coarse",
        ),
        (
            Finding::OutOfOrder {
                log: Log::Imu,
                rows: 60,
                line: 1003,
            },
            "IMU log: 60 rows are out of time order, first at line 1003; sort the file by time",
        ),
        (
            Finding::SharedStamps {
                log: Log::Imu,
                rows: 990,
                interval: 1.0,
            },
            "IMU log: time stamps are whole seconds and 990 rows repeat one: export times with more decimals, or set imu.rate instead of imu.time",
        ),
        (
            Finding::SharedStamps {
                log: Log::Gnss,
                rows: 90,
                interval: 0.1,
            },
            "GNSS log: time stamps are 0.100 s apart and 90 rows repeat one: export times with more decimals",
        ),
        (
            Finding::WrongTurnRate { ratio: -1.0 },
            "the GNSS course turns at -1.00 times the rate of the gyros: check the signs of imu.gyro and imu.axes",
        ),
        (
            Finding::WrongTurnAxis { axis: 0 },
            "turns of the GNSS course show in the gyro about body forward, not in the vertical one: check imu.axes and the order of imu.gyro",
        ),
        (
            Finding::NoTurns,
            "the gyros do not measure the turns of the GNSS course: check imu.gyro and the times of both logs (gnss.time_offset)",
        ),
        (
            Finding::Late { delay: -18.0 },
            "GNSS is stamped 18.00 s too late for the turns that the gyros measure: add -18.00 s to gnss.time_offset (GPS time and UTC are mixed)",
        ),
        (
            Finding::WrongAxes {
                forward: Some(-1),
                right: Some(-2),
                axes: Some("-x,y,-z".into()),
            },
            "GNSS shows that the IMU faces backwards (yaw 180°): set imu.axes = \"-x,y,-z\" or imu.mounting = \"auto\"",
        ),
        (
            Finding::WrongAxes {
                forward: Some(1),
                right: Some(-2),
                axes: None,
            },
            "the accelerometer's right axis seems to have the wrong sign (in turns GNSS is pushed to the right, the IMU to the left): check the order and signs of imu.accel",
        ),
        (
            Finding::WrongVelocity {
                mend: Some(FixMend::Knots),
            },
            "the GNSS velocity is in knots, not m/s: convert the columns of gnss.velocity to m/s",
        ),
        (
            Finding::Restart {
                time: 80.0,
                why: RestartCause::NoSamples,
                resumed: Some(95.2),
            },
            "discarded the solution at 80 s: no inertial samples for more than a minute; re-initialised at 95.2 s",
        ),
        (
            Finding::Rejected(jump()),
            "rejected 15 positions, 243311-243315 s (error grew from 2.3 to 17 m, at 3.68 m/s); then accepted them",
        ),
        (
            Finding::Rejected(Contradiction {
                part: Part::Velocity,
                fixes: 1,
                largest: 0.5,
                gave_way: false,
                frozen: true,
                ..jump()
            }),
            "rejected 1 velocity, 243311 s (error 0.50 m/s): the receiver repeated its fix while the solution moved",
        ),
        (
            Finding::MoreRejected {
                spans: 7,
                accepted: 2,
            },
            "rejected fixes in 7 more spans, then accepted them in 2; --json lists all",
        ),
        (
            Finding::OneSided(Lean {
                part: Part::Position,
                start,
                end: 40.0,
                mean: [1.0, -2.0, 0.5],
            }),
            "from 12.5 to 40.0 s the GNSS position differs from the solution to one side, on average by up to -1.00, 2.00, -0.50 m north, east, down: the fixes drift slowly (multipath, spoofing), or the sensors do",
        ),
        (
            Finding::WrongSign { axis: 2 },
            "the velocity down appears to have the wrong sign (its innovations are -2 times its value): check gnss.velocity and gnss.velocity_axes",
        ),
        (
            Finding::LargeInnovations { start },
            "innovations far exceed their predicted size from 12.5 s on: the solution diverges from the fixes, or the noise model or the stated GNSS accuracy is wrong",
        ),
        (
            accuracy(Part::Position, 2.0, false, true),
            "stated position standard deviations are about 2.0 times too small for the innovations: multiply gnss.position_std_factor by 2.00, or set gnss.adapt = true; but the innovations are correlated from fix to fix, so the noise model, the mounting, the lever arm or the times may be wrong instead",
        ),
        (
            accuracy(Part::Velocity, 0.5, true, false),
            "stated velocity standard deviations are about 2.0 times too large for the innovations; they were adapted",
        ),
        (
            Finding::Skipped {
                log: Log::Imu,
                records: 2,
                kinds: "1 row with NaN or infinity, at line 20: nan\n1 row with a missing field, at line 9: ".into(),
            },
            "IMU log: 1 row with NaN or infinity, at line 20: nan; 1 row with a missing field, at line 9: ",
        ),
        (
            Finding::Gaps {
                log: Log::Odometer,
                gaps: 4,
                start,
                length,
            },
            "odometer log: 4 gaps, the longest 3.000 s from 12.5 s",
        ),
        (
            Finding::Unused {
                log: Log::Barometer,
            },
            "barometer log: no record was used; compare its times with the IMU's, or set barometer.time_offset",
        ),
        (
            Finding::Outliers {
                log: Log::Odometer,
                rejected: 1,
                weakened: 2,
            },
            "odometer: rejected 1 measurement and down-weighted 2, all far from the prediction",
        ),
        (
            Finding::StartedLate { time: 30.0 },
            "navigation started at 30.0 s, after the first outage began: start the outages later",
        ),
        (
            Finding::NoReference { outages: 2 },
            "2 outages without reference samples",
        ),
        (
            Finding::Uneven {
                gaps: 1,
                jitter_rms: 1e-3,
                interval: 0.01,
            },
            "time stamps are unevenly spaced (1 gap, jitter 1.00 ms RMS at an interval of 10.00 ms); they are treated as evenly spaced",
        ),
    ] {
        assert_eq!(say(&finding), sentence);
        let json = serde_json::to_string(&finding).unwrap();
        assert_eq!(serde_json::from_str::<Finding>(&json).unwrap(), finding);
    }
}

#[test]
fn a_value_says_what_it_is_and_what_it_weighs() {
    let finding = Finding::Rejected(jump());
    let value = serde_json::to_value(&finding).unwrap();
    assert_eq!(
        (&value["finding"], &value["fixes"]),
        (&"rejected".into(), &15.into())
    );
    assert_eq!(finding.severity(), Severity::Note);
    assert_eq!(Finding::NoTurns.severity(), Severity::Warning);
    assert_eq!(
        Finding::Diverged { time: 1.0 }.severity(),
        Severity::Unusable
    );
}

#[test]
fn what_fixes_and_samples_show_of_themselves() {
    let sentences = [
        (
            Finding::Spikes {
                axis: 5,
                samples: 2,
                start: 12.5,
            },
            "replaced 2 samples of accelerometer z as implausible, the first at 12.5 s",
        ),
        (
            Finding::RepeatedFixes {
                fixes: 1,
                interval: 1.0,
            },
            "skipped 1 fix that repeats the previous one: the receiver measures every 1.00 s",
        ),
        (
            Finding::RoundedFixes { step: 1.11 },
            "positions are rounded to steps of 1.11 m; their covariance was increased accordingly",
        ),
        (
            Finding::CorrelatedFixes {
                share: 0.9,
                time: 60.0,
            },
            "position errors are correlated over 60 s (90 % of their variance); the correlated part is estimated",
        ),
        (
            Finding::NoisyFixes { factor: 3.0 },
            "positions scatter 3.0 times as much as stated; their standard deviations were scaled accordingly",
        ),
        (
            Finding::HeadingOff {
                start: 10.0,
                end: 30.5,
                angle: -0.1,
                more: 1,
            },
            "the heading disagrees with the GNSS course by up to 5.7 deg, 10-30.5 s, and in 1 more span: the bias or the scale of the vertical gyro changed, or the IMU was moved; the heading's standard deviation accounts for it",
        ),
    ];
    for (finding, sentence) in sentences {
        assert_eq!(say(&finding), sentence);
    }
}

/// A fault of the sensors explains what the solution shows; what is only worth knowing leaves it usable.
#[test]
fn the_verdict_names_the_cause() {
    let held = Finding::Held {
        axis: 2,
        value: 0.0,
        start: 60.0,
        length: 20.0,
        samples: 2000,
        saturated: false,
    };
    let innovations = Finding::LargeInnovations { start: 62.0 };
    let found = undrift::findings::ranked(vec![innovations, held]);
    assert!(
        verdict(&found).starts_with("usable with care: gyro z stays at 0 (as logged) for 20.00 s")
    );
    assert_eq!(verdict(&[Finding::Bridged { gaps: 2 }]), "usable");
    let ended = [Finding::Diverged { time: 9.0 }];
    assert_eq!(
        verdict(&ended),
        "not usable: the solution diverged at 9 s and ends there"
    );
}
