//! The exact sentence of each finding.

use super::*;
use undrift_events::{Contradiction, FixMend, Lean, Mismatch, Part, RestartCause, WindowPart};
use undrift_results::findings::{
    FarParameter, LeftOut, Log, LogEnd, NoError, Severity, TemperatureUse, WhyLeftOut,
};

/// Fifteen positions of a jump.
fn jump() -> Contradiction {
    Contradiction {
        part: Part::Position,
        height: false,
        start: 243_311.0,
        end: 243_315.0,
        fixes: 15,
        first: 2.31,
        last: 17.02,
        growth: 3.68,
        largest: 17.02,
        frozen: false,
        accepted_in_the_end: true,
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
            Finding::Temperature(TemperatureUse {
                corrected: 0,
                without: 9,
                without_from: Some(1.0),
                beyond: 0,
                seen_c: None,
            }),
            "the model's temperature correction is not used: the inertial log has no temperature",
        ),
        (
            Finding::Temperature(TemperatureUse {
                corrected: 90,
                without: 10,
                without_from: Some(12.5),
                beyond: 45,
                seen_c: Some([20.0, 31.25]),
            }),
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
            Finding::EndsEarly(LogEnd {
                end: 12.5,
                missing: 300.0,
            }),
            "IMU log: ends at 12.5 s, 300 s before the last fix: it may be cut short",
        ),
        (
            Finding::Mismatch { what: Mismatch::LateVelocities { delay: 0.27, beyond: Some(1.8) } },
            "the velocities of the fixes are 0.27 s late against the turns of the gyros, and positions some 1.80 m off: the receiver's own filter, differences of positions, or wrong stamps",
        ),
        (
            Finding::Mismatch { what: Mismatch::LateAccelerometers(0.2) },
            "the accelerometers are 0.20 s later than the gyros: two clocks or topics, or a low-pass on one of them; shift one of the two, or estimate it with states.accel_delay",
        ),
        (
            Finding::Mismatch { what: Mismatch::HeldPositions(1.6) },
            "the receiver holds its position while it moves slowly, and then steps by up to 1.60 m: switch off its static hold",
        ),
        (
            Finding::Mismatch { what: Mismatch::Nods(0.0541) },
            "the IMU nods by 3.1 deg (RMS) against the way it moves, which no vehicle on wheels does: a loose mount, of which the attitude is; fasten it",
        ),
        (
            Finding::Mismatch { what: Mismatch::MovesAside(3.0) },
            "the vehicle moves 172 deg off the IMU's forward axis: attitude and heading are the IMU's, not the vehicle's; set imu.mounting or imu.axes",
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
            Finding::WrongGravity { ratio: 0.102, exchanged: false },
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
            "IMU log: time stamps are whole seconds and 990 rows repeat one: export times with more decimals, or set imu.shared_stamps = \"spread\", or imu.rate instead of imu.time",
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
            "the GNSS course turns at -1.00 times the rate of the gyros: check the sign of the specific force (reversed: imu.accel_unit = \"-m/s^2\" or \"-g\") and of the gyros (one axis reversed: imu.gyro_unit = \"deg/s, deg/s, -deg/s\"), and imu.axes; `undrift inspect` on the logs tries them",
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
            "the accelerometer's right axis seems to have the wrong sign (in turns GNSS is pushed to the right, the IMU to the left): check the order and signs of imu.accel (one axis reversed: imu.accel_unit = \"g, -g, g\"; `undrift inspect` on the logs tries them)",
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
                accepted_in_the_end: false,
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
            Finding::Disagreement {
                part: WindowPart::Height,
                start,
                end: 72.5,
                inside: 0.404,
                rms: 5.06,
                overall: 0.9,
                more: 2,
            },
            "from 12.5 to 72.5 s the solution and the heights of the fixes disagree: 40 % of the innovations are inside three standard deviations, they are 5.1 standard deviations large; 2 such spans more",
        ),
        (
            Finding::UnexplainedForce { excess: -0.196 },
            "at rest the specific force is 0.196 m/s² less than gravity, beyond the accelerometers' noise model: the filter starts with constant errors of 0.196 m/s²; state them as accel.turn_on in the model",
        ),
        (
            Finding::NoVerticalVelocity { start },
            "the vertical velocity of the fixes is always 0, in motion too: it is taken as not measured from 12.5 s on; \"20 m/s\" as the third number of gnss.velocity_std says so from the first fix on",
        ),
        (
            Finding::SideSlip { start, speed: 0.834 },
            "from 12.5 s on the vehicle moves across its forward axis by up to 0.834 m/s (RMS of a minute): it does not move as wheels do, or the mounting is wrong; the constraint holds as much less, and without [vehicle] profile = \"car\" not at all",
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
    let found = undrift_results::findings::ranked(vec![innovations, held]);
    assert!(
        verdict(&found).starts_with("usable with care: gyro z stays at 0 (as logged) for 20.00 s")
    );
    // The span where it shows most is beside a cause.
    let span = Finding::Disagreement {
        part: WindowPart::Position,
        start: 60.0,
        end: 91.5,
        inside: 0.5,
        rms: 4.0,
        overall: 0.95,
        more: 0,
    };
    let both = undrift_results::findings::ranked(vec![span.clone(), found[0].clone()]);
    assert!(verdict(&both).ends_with(" (worst from 60 to 91.5 s)"));
    let alone = "usable with care: from 60 to 91.5 s the solution and the positions of the fixes disagree: ";
    assert!(verdict(&[span]).starts_with(alone));
    assert_eq!(verdict(&[Finding::Bridged { gaps: 2 }]), "usable");
    let ended = [Finding::Diverged { time: 9.0 }];
    assert_eq!(
        verdict(&ended),
        "not usable: the solution diverged at 9 s and ends there"
    );
}

#[test]
fn a_ratio_of_gravity_or_turns_hints_at_the_unit() {
    let gravity = |ratio: f64| {
        say(&Finding::WrongGravity {
            ratio,
            exchanged: false,
        })
    };
    for (ratio, number, hint) in [
        (0.09, "0.0900", "(the numbers look like g)"),
        (
            0.115,
            "0.115",
            "check imu.accel, imu.accel_unit and imu.data",
        ),
        (
            0.0899,
            "0.0899",
            "(gravity seems to be removed, as from a \"linear acceleration\": log the accelerometers with gravity)",
        ),
        (
            0.0199,
            "0.0199",
            "(gravity seems to be removed, as from a \"linear acceleration\": log the accelerometers with gravity)",
        ),
        (8.5, "8.50", "(the numbers look like m/s^2)"),
        (11.4, "11.4", "(the numbers look like m/s^2)"),
        (100.0, "100", "(the numbers look like mg or cm/s^2)"),
        (115.0, "115", "check imu.accel, imu.accel_unit and imu.data"),
        (3.28, "3.28", "(the numbers look like ft/s^2)"),
        (1.02e5, "102\u{202f}000", "(the numbers look like ug)"),
        (1e-7, "0", "check imu.accel, imu.accel_unit and imu.data"),
        (
            2e-6,
            "2.00e-6",
            "(gravity seems to be removed, as from a \"linear acceleration\": log the accelerometers with gravity)",
        ),
    ] {
        let text = gravity(ratio);
        let start = format!("the accelerometers measure {number} times gravity on average: check ");
        assert!(text.starts_with(&start) && text.ends_with(hint), "{text}");
    }
    let exchanged = say(&Finding::WrongGravity {
        ratio: 0.01,
        exchanged: true,
    });
    assert!(exchanged.contains("exchange the columns"), "{exchanged}");
    for (ratio, hint) in [
        (
            -1.7,
            "the sign of the specific force (reversed: imu.accel_unit = \"-m/s^2\" or \"-g\") and of the gyros (one axis reversed: imu.gyro_unit = \"deg/s, deg/s, -deg/s\"), and imu.axes; `undrift inspect` on the logs tries them",
        ),
        (-0.6, "imu.gyro_unit and imu.axes"),
        (0.017, "imu.gyro_unit (the numbers look like deg/s)"),
        (57.3, "imu.gyro_unit (the numbers look like rad/s)"),
        (
            0.001,
            "imu.gyro_unit (the numbers are a thousand times too large: thousandths are \"mdps\" or \"mrad/s\")",
        ),
        (0.0573, "imu.gyro_unit (the numbers look like mrad/s)"),
        (1.75e-5, "imu.gyro_unit (the numbers look like mdps)"),
        (0.09, "imu.gyro_unit and imu.axes"),
        (0.0599, "imu.gyro_unit (the numbers look like mrad/s)"),
        (0.5, "imu.gyro_unit and imu.axes"),
    ] {
        let text = say(&Finding::WrongTurnRate { ratio });
        assert!(
            text.ends_with(&format!("the rate of the gyros: check {hint}")),
            "{text}"
        );
    }
}

#[test]
fn a_body_that_gravity_does_not_pull_down_says_where_it_does() {
    for (down, towards) in [
        ([0.8, 0.0, 0.6], "tilted by 53° (gravity points forward"),
        ([-0.8, 0.0, 0.6], "tilted by 53° (gravity points backward"),
        ([0.1, 0.9, -0.2], "tilted by 102° (gravity points right"),
        ([0.0, -0.6, 0.8], "tilted by 37° (gravity points down"),
    ] {
        let text = say(&Finding::NotDown { down });
        assert!(text.contains(towards), "{text}");
    }
}

#[test]
fn a_delay_has_its_direction_and_the_leap_seconds() {
    assert_eq!(
        say(&Finding::Late { delay: 0.25 }),
        "GNSS is stamped 0.25 s too early for the turns that the gyros measure: add 0.25 s to gnss.time_offset"
    );
    for (delay, mixed) in [(18.4, true), (-17.6, true), (18.6, false), (17.4, false)] {
        let text = say(&Finding::Late { delay });
        assert_eq!(
            text.ends_with("(GPS time and UTC are mixed)"),
            mixed,
            "{text}"
        );
    }
}

#[test]
fn axes_are_named_by_what_speeds_up_and_what_is_pushed() {
    let wrong = |forward, right, axes: Option<&str>| {
        say(&Finding::WrongAxes {
            forward,
            right,
            axes: axes.map(String::from),
        })
    };
    for (forward, right, faces) in [
        (Some(-1), None, "backwards (yaw 180°)"),
        (Some(2), Some(-1), "to the left (yaw -90°)"),
        (Some(2), None, "to the left (yaw -90°)"),
        (Some(-2), Some(1), "to the right (yaw 90°)"),
        (Some(-2), None, "to the right (yaw 90°)"),
    ] {
        assert_eq!(
            wrong(forward, right, None),
            format!(
                "GNSS shows that the IMU faces {faces}: rotate imu.axes by that angle, or set imu.mounting = \"auto\""
            )
        );
    }
    let columns = ": check the order and signs of imu.accel";
    for (forward, right, text) in [
        (
            Some(2),
            Some(1),
            "the accelerometer's forward and right axes seem exchanged (GNSS accelerates forward, the IMU to the right)",
        ),
        (
            Some(-2),
            Some(-1),
            "the accelerometer's forward and right axes seem exchanged (GNSS accelerates forward, the IMU to the left)",
        ),
    ] {
        assert_eq!(wrong(forward, right, None), format!("{text}{columns}"));
    }
    assert_eq!(
        wrong(Some(-1), Some(2), None),
        format!(
            "the accelerometer's forward axis seems to have the wrong sign (GNSS accelerates forward, the IMU backward){columns} (one axis reversed: imu.accel_unit = \"g, -g, g\"; `undrift inspect` on the logs tries them)"
        )
    );
    // What no such rotation explains.
    assert_eq!(
        wrong(None, Some(1), None),
        "the IMU's axes are not the vehicle's (in turns GNSS is pushed to the right, the IMU forward): check imu.axes and the order and signs of imu.accel"
    );
}

#[test]
fn times_have_at_most_milliseconds_and_counts_their_plural() {
    use super::words::{at, many};
    assert_eq!([at(12.0), at(12.5), at(12.3456)], ["12", "12.5", "12.346"]);
    assert_eq!([at(0.0), at(100.0)], ["0", "100"]);
    assert_eq!(
        [many(1, "fix"), many(2, "fix"), many(0, "gap")],
        ["1 fix", "2 fixes", "0 gaps"]
    );
}

#[test]
fn rejected_fixes_grow_or_fall_and_may_be_larger_amid() {
    let text = say(&Finding::Rejected(Contradiction {
        part: Part::Velocity,
        fixes: 3,
        first: 5.0,
        last: 2.0,
        growth: -0.75,
        largest: 5.3,
        accepted_in_the_end: false,
        ..jump()
    }));
    assert_eq!(
        text,
        "rejected 3 velocities, 243311-243315 s (error fell from 5.0 to 2.0 m/s, at 0.750 m/s², at most 5.3 m/s)"
    );
    let text = say(&Finding::Rejected(Contradiction {
        first: 12_345.0,
        last: 17.0,
        largest: 12_900.0,
        ..jump()
    }));
    assert!(
        text.contains("error fell from 12\u{202f}300 to 17 m") && !text.contains("at most"),
        "{text}"
    );
    let height = Contradiction {
        height: true,
        ..jump()
    };
    let text = say(&Finding::Rejected(height));
    assert!(
        text.starts_with("the height of the fixes jumps by 17.0 m at 243311"),
        "{text}"
    );
    let text = say(&Finding::Rejected(Contradiction {
        accepted_in_the_end: false,
        ..height
    }));
    assert!(text.starts_with("rejected 15 heights"), "{text}");
    let integer = Contradiction {
        end: 243_326.0,
        first: 0.52,
        last: 0.55,
        largest: 0.6,
        ..jump()
    };
    let text = say(&Finding::Rejected(integer));
    assert!(
        text.starts_with("the positions of the fixes jump by 0.52 m at 243311"),
        "{text}"
    );
}

#[test]
fn further_findings_have_their_sentences() {
    let cases = [
        (
            Finding::NotCompared {
                why: NoError::TooSparse,
                truth: [0.0, 50.0],
                started: None,
                ended: 9.0,
            },
            "no errors against the truth: the truth has no two samples within 2 s of each other during the solution (truth 0-50 s, no solution); check the time columns, or set truth.time_offset",
        ),
        (
            Finding::LongGaps {
                gaps: 1,
                first: 20.0,
                longest: 4.5,
            },
            "IMU log: no samples for 4.5 s from 20 s; do not trust the solution there, or leave it out with [span]",
        ),
        (
            Finding::Restart {
                time: 80.0,
                why: RestartCause::RejectedThenAccepted,
                resumed: None,
            },
            "discarded the solution at 80 s: it repeatedly rejected fixes and then accepted them; could not be re-initialised",
        ),
        (
            Finding::RepeatedFixes {
                fixes: 4,
                interval: 0.2,
            },
            "skipped 4 fixes that repeat the previous one: the receiver measures every 0.200 s",
        ),
        (
            Finding::FixJitter { std: 0.012 },
            "time stamps of the fixes jitter by 12 ms; the along-track covariance of the positions was increased accordingly",
        ),
        (
            Finding::ModestVelocity { factor: 0.5 },
            "velocities match the changes of position to 0.50 of their stated standard deviations, which were scaled accordingly; the lasting part of their error is estimated",
        ),
        (
            Finding::VelocityBias {
                bias: [0.1, -0.2, 0.3],
            },
            "velocities differ from the changes of position by a constant 0.10, -0.20, 0.30 m/s north, east, down: one of them is wrong; gnss.use = \"position\" ignores the velocities",
        ),
        (
            Finding::FarParameter(FarParameter {
                parameter: "TimeOffset".into(),
                value: 0.25,
                sigmas: 6.0,
            }),
            "time offset of the positions: the estimate of 250 ms is 6 prior standard deviations from zero; check the setting that it corrects",
        ),
        (
            Finding::OptimisticDrift {
                model: "arma".into(),
                inside: 0.8,
                outside: 1,
                outages: 4,
                tuned: false,
            },
            "only 80 % of the position errors in the outages lie within 3σ as predicted, even with model arma, in 1 of 4 outages less than 90 %: the IMU's noise model is too optimistic for this vehicle (run `undrift tune`), or the lever arm, the axes or the mounting are wrong",
        ),
        (
            Finding::OptimisticModel {
                factor: 2.5,
                tuned: true,
            },
            "innovations are 2.5 times as large as predicted although the fixes are consistent: the lever arm or the axes are wrong, or the drive is unlike those that the noise was tuned on",
        ),
        (
            Finding::RejectedReference { fixes: 12, of: 600 },
            "12 of 600 withheld positions are rejected by the run without outages, so they are no reference",
        ),
        (
            Finding::OutagesLeftOut(LeftOut {
                why: WhyLeftOut::InGap,
                outages: 1,
                of: 9,
                first: 120.5,
            }),
            "1 of 9 outages was excluded (at 120.5 s): begins in a gap of the fixes",
        ),
        (
            Finding::OutagesLeftOut(LeftOut {
                why: WhyLeftOut::NotStarted,
                outages: 3,
                of: 9,
                first: 60.0,
            }),
            "3 of 9 outages were excluded (the first at 60 s): begin before the solution does; start the outages later",
        ),
        (
            Finding::OutagesLeftOut(LeftOut {
                why: WhyLeftOut::NoReference,
                outages: 2,
                of: 9,
                first: 60.0,
            }),
            "2 of 9 outages were excluded (the first at 60 s): no reference at the end",
        ),
        (Finding::NoOutage, "no outage is left to measure in"),
        (
            Finding::MovingAverageSign {
                axes: vec!["gyro_x".into(), "gyro_z".into()],
            },
            "the ARMA of gyro_x, gyro_z has ar near 1 and a negative ma: check the sign of ma, which is subtracted here and added by statsmodels, R and MATLAB (a slow bias under white noise has ma just below ar)",
        ),
        (
            Finding::OutagesLeftOut(LeftOut {
                why: WhyLeftOut::InGap,
                outages: 2,
                of: 2,
                first: 210.0,
            }),
            "no outage is left to measure in: 2 of 2 outages were excluded (the first at 210 s): begin in a gap of the fixes",
        ),
        (
            Finding::NotRun {
                models: vec!["white".into(), "ar".into()],
                all: false,
                why: None,
            },
            "could not be run: white, ar",
        ),
        (
            Finding::NotRun {
                models: vec!["white".into(), "ar".into()],
                all: true,
                why: Some("the vehicle never moved".into()),
            },
            "no model could be run: the vehicle never moved",
        ),
        (
            Finding::OfModel {
                model: "white".into(),
                what: Box::new(Finding::Diverged { time: 9.0 }),
            },
            "white: the solution diverged at 9 s and ends there",
        ),
        (
            Finding::CoversPart {
                from: 699.1,
                to: 700.0,
                log: [100.0, 700.0],
            },
            "the solution covers 699.1-700 s only, of a log from 100 to 700 s",
        ),
        (
            Finding::OptimisticModel {
                factor: 2.5,
                tuned: false,
            },
            "innovations are 2.5 times as large as predicted although the fixes are consistent: the IMU's noise model is too optimistic for this vehicle (run `undrift tune`), or the lever arm or the axes are wrong",
        ),
        (
            Finding::CorrelatedInnovations {
                part: Part::Velocity,
                correlation: 0.75,
                tuned: false,
            },
            "velocity innovations are correlated from fix to fix (autocorrelation 0.75), so attitude and sensor errors are larger than predicted: the IMU's noise model is too optimistic for this vehicle (run `undrift tune`), or the lever arm, the axes or the times are wrong",
        ),
        (
            Finding::SetBack {
                log: Log::Imu,
                line: 7,
                step: 0.5,
            },
            "IMU log: the clock steps back by 0.500 s at row 7, so all later rows are stamped early: add 0.500 s to their times",
        ),
        (
            Finding::HeadingOff {
                start: 10.0,
                end: 30.5,
                angle: 0.1,
                more: 0,
            },
            "the heading disagrees with the GNSS course by up to 5.7 deg, 10-30.5 s: the bias or the scale of the vertical gyro changed, or the IMU was moved; the heading's standard deviation accounts for it",
        ),
        (
            Finding::Constant {
                axis: 3,
                value: 0.0,
                samples: 900,
                vertical: true,
            },
            "accelerometer x is constant (0) in all 900 samples: check imu.accel; if the column is right, the sensor is faulty or too coarse",
        ),
    ];
    for (finding, sentence) in cases {
        assert_eq!(say(&finding), sentence);
    }
    let corrected = |without_from, beyond| {
        say(&Finding::Temperature(TemperatureUse {
            corrected: 90,
            without: 0,
            without_from,
            beyond,
            seen_c: Some([20.0, 30.0]),
        }))
    };
    assert_eq!(
        corrected(None, 0),
        "corrected for temperature (20.0 to 30.0 °C)"
    );
    assert!(corrected(None, 9).contains("; 10 % of it is extrapolated"));
    assert!(corrected(Some(1.0), 0).contains("but not 0.00 % of the samples"));
}

#[test]
fn a_stated_accuracy_is_mended_by_a_factor() {
    let said = |factor, adapted, correlated| {
        say(&Finding::WrongAccuracy {
            part: Part::Velocity,
            factor,
            adapted,
            correlated,
        })
    };
    assert_eq!(
        said(0.25, false, true),
        "stated velocity standard deviations are about 4.0 times too large for the innovations: multiply gnss.velocity_std_factor by 0.25, or set gnss.adapt = true"
    );
    let start =
        "stated velocity standard deviations are about 3.0 times too small for the innovations";
    let mend = ": multiply gnss.velocity_std_factor by 3.00, or set gnss.adapt = true";
    assert_eq!(said(3.0, false, false), format!("{start}{mend}"));
    assert_eq!(said(3.0, true, true), format!("{start}; they were adapted"));
}

#[test]
fn every_mend_of_the_fixes_says_what_is_wrong() {
    for (mend, words) in [
        (
            FixMend::VelocityEastNorth,
            "is east, north, not north, east",
        ),
        (
            FixMend::PositionSwapped,
            "latitude and longitude are exchanged",
        ),
        (
            FixMend::EastReversed,
            "velocity east (or the longitude) has the wrong sign",
        ),
        (
            FixMend::NorthReversed,
            "velocity north (or the latitude) has the wrong sign",
        ),
        (
            FixMend::VelocityReversed,
            "the GNSS velocity has the wrong signs",
        ),
        (FixMend::KilometresPerHour, "is in km/h, not m/s"),
        (FixMend::Knots, "is in knots, not m/s"),
        (FixMend::FeetPerSecond, "is in ft/s, not m/s"),
        (FixMend::CentimetresPerSecond, "is in cm/s, not m/s"),
        (FixMend::MillimetresPerSecond, "is in mm/s, not m/s"),
        (FixMend::PositionInRadians, "are in rad, not deg"),
    ] {
        let text = say(&Finding::WrongVelocity { mend: Some(mend) });
        assert!(text.contains(words), "{text}");
    }
    let unknown = say(&Finding::WrongVelocity { mend: None });
    assert!(
        unknown.starts_with("GNSS positions and velocities disagree"),
        "{unknown}"
    );
    for (axis, name) in [(0, "north"), (1, "east")] {
        let text = say(&Finding::WrongSign { axis });
        assert!(
            text.starts_with(&format!("the velocity {name} appears")),
            "{text}"
        );
    }
}

#[test]
fn a_start_says_where_the_attitude_comes_from() {
    use undrift_events::{Alignment, AttitudeSource, HeadingSource, Mounting};
    use undrift_nav::{Vector3, attitude::from_rpy};
    let of = |source| {
        let angle = 1f64.to_radians();
        alignment(&Alignment {
            source,
            level_std: angle,
            heading_std: 2.0 * angle,
            gyro_bias_std: 0.5 * angle,
            force_excess: None,
        })
    };
    let bounds = "; level ±1.00 deg, heading ±2.0 deg, gyro bias ±0.500 deg/s";
    let rest = |heading| {
        of(AttitudeSource::Rest {
            duration: 12.5,
            heading,
        })
    };
    let motion = |bias_at_rest| {
        of(AttitudeSource::Motion {
            duration: 20.0,
            bias_at_rest,
        })
    };
    assert_eq!(of(AttitudeSource::Given), "attitude as specified");
    assert_eq!(
        rest(HeadingSource::Given),
        format!("levelled during 12.5 s of rest, heading as specified{bounds}")
    );
    assert_eq!(
        rest(HeadingSource::Course),
        format!("levelled during 12.5 s of rest, heading from the GNSS course{bounds}")
    );
    assert_eq!(
        motion(false),
        format!("attitude from 20 s of motion{bounds}")
    );
    assert_eq!(
        motion(true),
        format!("attitude from 20 s of motion, gyro bias from rest{bounds}")
    );
    let degrees = |x: f64, y: f64, z: f64| Vector3::new(x, y, z).map(f64::to_radians);
    let rpy = degrees(1.0, -2.0, 90.0);
    let sits = |straight| {
        mounting(&Mounting {
            q_vb: from_rpy(&rpy),
            std: degrees(0.1, 0.2, 0.3),
            duration: 300.0,
            straight,
        })
    };
    let angles = "roll 1.00, pitch -2.00, yaw 90.00 deg; ±0.10 about forward, ±0.20 about right, ±0.30 deg about down; from 300 s of ";
    assert_eq!(sits(true), format!("{angles}straight driving"));
    assert_eq!(sits(false), format!("{angles}driving"));
    assert_eq!(estimated("it"), "estimated mounting: it");
}

#[test]
fn a_recording_that_is_refused_says_what_to_do() {
    use undrift_results::recording::{Likely, NotStatic};
    let record = |guessed: &[(&'static str, &str)]| -> Vec<(&'static str, String)> {
        let guessed = guessed.iter();
        guessed
            .map(|(option, value)| (*option, (*value).into()))
            .collect()
    };
    assert_eq!(guessed(&record(&[])), None);
    let both = record(&[("--units", "deg/s,g"), ("--columns", "1,2")]);
    assert_eq!(
        guessed(&both).unwrap(),
        "guessed from the values: --units \"deg/s,g\" --columns \"1,2\""
    );
    let turning = || NotStatic::Turning {
        axis: "gyro_x",
        rate: 1.0,
    };
    assert!(refused(&both, &turning()).starts_with("the column names do not show which"));
    let force = |likely, gyro: &str| NotStatic::Force {
        force: 1.0,
        likely,
        gyro_unit: gyro.into(),
    };
    let counts = |accel: &str| NotStatic::Counts {
        axis: "gyro_x",
        unit: "rad/s".into(),
        accel_unit: accel.into(),
        range: [0.0, 9.0],
    };
    let moving = |rest| NotStatic::Moving {
        moving_s: 50.0,
        length_s: 100.0,
        rest,
    };
    let scattering = NotStatic::Scattering {
        axis: "gyro_x",
        scatter: 0.2,
        accel_unit: "g".into(),
    };
    for (problem, mend) in [
        (
            scattering,
            "the numbers look like deg/s: --units \"deg/s,g\"",
        ),
        (turning(), "it turns, or the unit of the gyros is wrong"),
        (
            force(Likely::Unit("g"), ""),
            "; the unit is likely g, or use",
        ),
        (
            force(Likely::Unit("g"), "deg/s"),
            "the unit is likely g: --units \"deg/s,g\" (accel_unit = \"g\"",
        ),
        (force(Likely::GravityRemoved, ""), "gravity was removed"),
        (force(Likely::Increments, ""), "velocity increments"),
        (force(Likely::Unknown, ""), "correct the unit"),
        (counts(""), "--units \"LSB/131 deg/s,LSB/16384 g\""),
        (counts("g"), "--units \"LSB/131 deg/s,g\""),
        (
            moving(Some((1.0, 2.5))),
            "use its longest rest, --span 1,2.5",
        ),
        (moving(None), "it has no rest that is long enough"),
    ] {
        let text = refused(&record(&[("--units", "deg/s,g")]), &problem);
        assert!(
            text.contains(mend) && text.ends_with("use --force to identify it anyway"),
            "{text}"
        );
    }
}

#[test]
fn what_holds_out_a_share_is_less_than_all() {
    for share in [Some(0.0), Some(0.9), None] {
        assert_eq!(hold_out("--hold-out", share), None);
    }
    for share in [-0.1, 0.91, f64::NAN] {
        let text = hold_out("--hold-out", Some(share)).unwrap();
        assert_eq!(
            text,
            format!("--hold-out {share}: must be 0 to 0.9, a share of each drive")
        );
    }
}

#[test]
fn an_end_has_the_cause_that_is_not_the_end_itself() {
    let end = Finding::Diverged { time: 9.0 };
    assert_eq!(ended(9.0, &[]), say(&end));
    assert_eq!(ended(9.0, std::slice::from_ref(&end)), say(&end));
    let found = undrift_results::findings::ranked(vec![
        end.clone(),
        Finding::WrongGravity {
            ratio: 0.1,
            exchanged: false,
        },
    ]);
    let text = ended(9.0, &found);
    assert!(
        text.starts_with("the solution diverged at 9 s and ends there: the accelerometers measure"),
        "{text}"
    );
}

#[test]
fn what_is_wrong_with_poses_has_its_sentence_and_its_mend() {
    use undrift_results::{findings::PosesApart, inspect::PoseFault};
    let said = |fault, mended| say(&Finding::Poses(PosesApart { fault, mended }));
    let slipped = |angle_deg, distance_m| PoseFault::Slipped {
        time: 81.01,
        angle_deg,
        distance_m,
    };
    for (fault, mended, expected) in [
        (
            slipped(15.02, 0.0293),
            false,
            "the marker slipped by 15.0° and 2.93 cm against the IMU at 81.01 s: set [span] start or end there, and use each part by itself",
        ),
        (
            slipped(0.0, 0.0293),
            true,
            "the marker slipped by 2.93 cm against the IMU at 81.01 s: the longest part without is used ([span] start, end)",
        ),
        (
            PoseFault::PositionAxes([2, -1, 3]),
            false,
            "positions and attitudes are of different frames: with the axes y, -x, z for x, y, z of the positions they agree; exchange these columns or their signs",
        ),
        (
            PoseFault::Rate { ratio: 1.02 },
            false,
            "the clock of the poses runs 2.00 % fast: multiply their times by 0.98039, or check the rate of the samples",
        ),
        (
            PoseFault::Shifted {
                time: 81.0,
                distance_m: 0.2314,
            },
            false,
            "the frame of the poses moves by 23.1 cm at 81 s while the IMU does not: set [span] start or end there, and use each part by itself",
        ),
        (
            PoseFault::Jumped {
                time: 81.0,
                end: 87.0,
                angle_deg: 123.0,
                lasting: false,
            },
            false,
            "poses jump by 123° from 81 to 87 s while the IMU does not, as of another body or a lost marker; leave them away, or cut them out",
        ),
    ] {
        assert_eq!(said(fault, mended), expected);
    }
}
