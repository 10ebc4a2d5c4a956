//! The tables beside the two logs: odometer, barometer, vehicle and states, right and wrong.

use super::log::{Case, Log, says};

const WHEEL: &str = "[odometer]\nfile = \"wheel.csv\"\ntime = \"t\"\nspeed = \"v\"\nspeed_unit = \"km/h\"\nspeed_std = \"0.05 m/s\"\n";
const BARO: &str =
    "[barometer]\nfile = \"baro.csv\"\ntime = \"t\"\nheight = \"h\"\nstd = \"0.5 m\"\n";

/// A drive with these tables at its end, and the logs of a wheel 1 % too fast and of a height 40 m off.
fn drive(name: &str, tables: &str) -> Case {
    let mut log = Log::good();
    log.drive += tables;
    let number = |field: &String| field.parse::<f64>().unwrap();
    let (mut wheel, mut baro) = ("t,v,n,s\n".to_owned(), "t,h,p\n".to_owned());
    let mut metres = 0.0;
    for row in log.truth.iter().step_by(10) {
        let v = number(&row.fields[4]).hypot(number(&row.fields[5]));
        metres += 0.2 * v;
        let ticks = (100.0 * metres).floor();
        wheel += &format!("{:.2},{:.5},{ticks},0.1\n", row.time, v * 3.6 * 1.01);
        let height = number(&row.fields[3]) + 40.0;
        let pressure = 1013.25 * (1.0 - height / 44_330.8).powf(5.255_88);
        baro += &format!("{:.2},{height:.3},{pressure:.4}\n", row.time);
    }
    let case = log.write(&format!("scalars_{name}"));
    case.put("wheel.csv", wheel.as_bytes());
    case.put("baro.csv", baro.as_bytes());
    case
}

#[test]
fn both_are_used_and_their_errors_found() {
    let (outcome, _) = drive("good", &format!("{WHEEL}{BARO}")).solution();
    assert_eq!(outcome.stderr, "");
    says(
        &outcome.stdout,
        &[
            "odometer: ",
            "barometer: ",
            "odometer scale factor: 0.9",
            "barometric height error: 4",
        ],
    );
    let ticks = WHEEL.replace(
        "speed = \"v\"\nspeed_unit = \"km/h\"",
        "ticks = \"n\"\nticks_per_metre = 101",
    );
    let pressure = BARO.replace("height = \"h\"", "pressure = \"p\"");
    let (outcome, _) = drive("ticks", &format!("{ticks}{pressure}")).solution();
    says(
        &outcome.stdout,
        &["odometer scale factor: -", "barometric height error: 4"],
    );
    // Outages leave them alone.
    let case = drive("outages", &format!("{WHEEL}{BARO}"));
    let outcome = case.outages(&["--length", "10", "--at", "50"]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
}

#[test]
fn logs_that_are_damaged_or_of_another_time() {
    let case = drive("late", &format!("{WHEEL}time_offset = \"1 h\"\n"));
    let (outcome, _) = case.solution();
    says(
        &outcome.stderr,
        &[
            "odometer log: no record was used",
            "set odometer.time_offset",
        ],
    );
    let case = drive("damaged", WHEEL);
    case.put(
        "wheel.csv",
        b"t,v\n40,54\n40.2,x\n40.4,nan\n40.6,9999\n41,54\n",
    );
    let (outcome, _) = case.solution();
    says(
        &outcome.stderr,
        &[
            "odometer log: 1 row with text where a number belongs, at line 3: \"x\"",
            "1 row with NaN or infinity, at line 4",
            "1 row with a value out of range, at line 5",
        ],
    );
    let case = drive("none", WHEEL);
    case.put("wheel.csv", b"t,v\n40,9999\n");
    says(
        &case.refusal(),
        &["wheel.csv: no usable value", "out of range"],
    );
}

#[test]
fn mistakes_in_their_tables() {
    let wheel = |from: &str, to: &str| {
        assert!(WHEEL.contains(from));
        WHEEL.replace(from, to)
    };
    let baro = |from: &str, to: &str| {
        assert!(BARO.contains(from));
        BARO.replace(from, to)
    };
    let vehicle = |line: &str| format!("[vehicle]\n{line}\n");
    let states = |line: &str| format!("[states]\n{line}\n");
    let cases: &[(String, &[&str])] = &[
        (
            wheel("\"wheel.csv\"", "\"whell.csv\""),
            &["whell.csv", "no such file"],
        ),
        (
            wheel("file = \"wheel.csv\"\n", ""),
            &["line 22, odometer.file: missing"],
        ),
        (
            wheel("time = \"t\"\n", ""),
            &["line 22, odometer.time: missing: the time column"],
        ),
        (
            wheel("\"v\"", "\"speed\""),
            &[
                "wheel.csv line 1: no column \"speed\" (key odometer.speed); the file has: t, v, n, s",
            ],
        ),
        (
            wheel("speed = \"v\"\n", ""),
            &["odometer.speed: missing", "or ticks"],
        ),
        (
            wheel("speed_unit = \"km/h\"\n", ""),
            &["odometer.speed_unit: missing: the unit of the column, \"m/s\" or \"km/h\""],
        ),
        (
            wheel("\"km/h\"", "\"km\""),
            &[
                "line 26, odometer.speed_unit: \"km\": that is the unit of a length; expected a velocity",
            ],
        ),
        (
            wheel("0.05 m/s", "-0.05 m/s"),
            &["line 27, odometer.speed_std: must be a positive standard deviation"],
        ),
        (
            wheel("\"0.05 m/s\"", "0.05"),
            &["odometer.speed_std: the number needs a unit"],
        ),
        (
            wheel("speed_std", "speed_std_column = \"s\"\nspeed_std"),
            &["odometer.speed_std_column: set speed_std or speed_std_column, not both"],
        ),
        (
            wheel("speed_std = \"0.05 m/s\"", "speed_std_column = \"sigma\""),
            &["no column \"sigma\" (key odometer.speed_std_column)"],
        ),
        (
            wheel("speed_std", "ticks = \"n\"\nspeed_std"),
            &["odometer.ticks: set speed or ticks, not both"],
        ),
        (
            wheel("speed = \"v\"", "ticks = \"n\""),
            &["odometer.ticks_per_metre: missing: ticks per metre"],
        ),
        (
            wheel("speed_std", "ticks_per_metre = -3\nspeed_std"),
            &["odometer.ticks_per_metre: must be a positive number"],
        ),
        (
            wheel("speed_std", "scale_std = -0.1\nspeed_std"),
            &["odometer.scale_std: must be a positive number"],
        ),
        (
            wheel("speed_std", "scale_std = \"1 m\"\nspeed_std"),
            &["odometer.scale_std: \"1 m\": that is the unit of a length; expected a number"],
        ),
        (
            wheel("speed_std", "time_unit = \"m\"\nspeed_std"),
            &["odometer.time_unit: \"m\": that is the unit of a length"],
        ),
        (
            wheel("speed_std", "time_offset = 3\nspeed_std"),
            &["odometer.time_offset: the number needs a unit"],
        ),
        (
            baro("\"h\"", "\"height\""),
            &[
                "baro.csv line 1: no column \"height\" (key barometer.height); the file has: t, h, p",
            ],
        ),
        (
            baro("height = \"h\"\n", ""),
            &["barometer.height: missing", "or pressure"],
        ),
        (
            baro("std", "pressure = \"p\"\nstd"),
            &["barometer.pressure: set height or pressure, not both"],
        ),
        (
            baro(
                "height = \"h\"",
                "pressure = \"p\"\npressure_unit = \"bar\"",
            ),
            &["barometer.pressure_unit: \"bar\" is not one of \"hPa\", \"mbar\", \"kPa\", \"Pa\""],
        ),
        (
            baro("height = \"h\"", "pressure = \"p\"\npressure_unit = \"Pa\""),
            &["baro.csv: no usable value", "out of range"],
        ),
        (
            baro("std", "height_unit = \"hPa\"\nstd"),
            &[
                "barometer.height_unit: \"hPa\": unknown unit",
                "expected a length",
            ],
        ),
        (
            baro("0.5 m", "0 m"),
            &["barometer.std: must be a positive standard deviation"],
        ),
        (
            baro("std", "std_column = \"x\"\nstd"),
            &["barometer.std_column: set std or std_column, not both"],
        ),
        (
            baro("std", "bias_std = \"-1 m\"\nstd"),
            &["barometer.bias_std: must be a positive standard deviation, or \"off\""],
        ),
        (
            baro("std", "bias_walk = \"1 m/s\"\nstd"),
            &[
                "barometer.bias_walk: \"1 m/s\": that is the unit of a velocity; expected a random walk of a length such as \"m/sqrt(h)\"",
            ],
        ),
        (
            baro(
                "std",
                "bias_std = \"off\"\nbias_walk = \"1 m/sqrt(h)\"\nstd",
            ),
            &["barometer.bias_walk: has no effect while bias_std is \"off\""],
        ),
        (
            vehicle("profile = \"boat\""),
            &[
                "line 23, vehicle.profile: \"boat\" is not one of \"none\", \"car\", \"aircraft\", \"pedestrian\", \"copter\"",
            ],
        ),
        (
            vehicle("axle = \"1 deg\""),
            &["vehicle.axle: \"1 deg\": that is the unit of an angle"],
        ),
        (
            vehicle("odometer_wheel = 1"),
            &["vehicle.odometer_wheel: the number needs a unit: write \"1 m\""],
        ),
        (
            vehicle("non_holonomic = true"),
            &[
                "vehicle.non_holonomic: must be a velocity with its unit such as \"1 m/s\", not a boolean",
            ],
        ),
        (
            vehicle("non_holonomic = \"0.1 m\""),
            &[
                "vehicle.non_holonomic: \"0.1 m\": that is the unit of a length; expected a velocity",
            ],
        ),
        (
            vehicle("air_velocity = \"1 m/s^2\""),
            &[
                "vehicle.air_velocity: \"1 m/s^2\": that is the unit of an acceleration; expected a velocity",
            ],
        ),
        (
            vehicle("profile = \"aircraft\"\nrotor_drag = \"0.2 m/s^2\""),
            &[
                "vehicle.rotor_drag: is for copters, \"air_velocity\" for aircraft: switch one of them \"off\"",
            ],
        ),
        (
            vehicle("wind_std = \"6 m/s\""),
            &["vehicle.wind_std: has no effect without \"air_velocity\" or \"rotor_drag\""],
        ),
        (
            vehicle("zero_velocity = \"-1 m/s\""),
            &["vehicle.zero_velocity: must be a positive standard deviation, or \"off\""],
        ),
        (
            vehicle("zero_angular_rate = \"1 m/s\""),
            &["vehicle.zero_angular_rate: \"1 m/s\": that is the unit of a velocity"],
        ),
        (
            vehicle("course = \"3\""),
            &["vehicle.course: \"3\": the unit is missing"],
        ),
        (
            vehicle("course_min_speed = \"3 s\""),
            &["vehicle.course_min_speed: \"3 s\": that is the unit of a time"],
        ),
        (
            vehicle("mounting_std = \"0 deg\""),
            &["vehicle.mounting_std: must be a positive standard deviation, or \"off\""],
        ),
        (
            vehicle("axle_std = \"1 s\""),
            &["vehicle.axle_std: \"1 s\": that is the unit of a time"],
        ),
        (
            states("scale_factor = -1"),
            &["line 23, states.scale_factor: must be a positive number"],
        ),
        (
            states("misalignment = \"1 m\""),
            &["states.misalignment: \"1 m\": that is the unit of a length; expected an angle"],
        ),
        (
            states("lever_arm = 0.1"),
            &["states.lever_arm: the number needs a unit"],
        ),
        (
            states("time_offset = \"-1 ms\""),
            &["states.time_offset: must be a positive standard deviation, or \"off\""],
        ),
    ];
    for (k, (tables, parts)) in cases.iter().enumerate() {
        let message = drive(&format!("wrong_{k}"), tables).refusal();
        says(&message, parts);
        assert_eq!(message.lines().count(), 1, "{message}");
    }
    let mut log = Log::good();
    log.set("velocity_std =", "gate = \"yes\"\nvelocity_std =");
    says(
        &log.write("gate_word").refusal(),
        &["drive.toml line 15, gnss.gate: must be true or false"],
    );
}
