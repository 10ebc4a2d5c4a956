use super::*;

#[test]
fn units_of_time() {
    let every = |step: f64| -> Vec<f64> { (0..20).map(|k| 7.0 + step * f64::from(k)).collect() };
    for (step, unit) in [
        (0.01, "s"),
        (0.001, "s"),
        (1.0, "ms"),
        (10.0, "ms"),
        (1000.0, "us"),
        (2.5e6, "ns"),
    ] {
        assert_eq!(time_unit(&every(step), IMU_STEP).unwrap().0, unit, "{step}");
    }
    for (step, unit) in [
        (0.2, "s"),
        (1.0, "s"),
        (200.0, "ms"),
        (1e5, "us"),
        (2e8, "ns"),
    ] {
        assert_eq!(time_unit(&every(step), FIX_STEP).unwrap().0, unit, "{step}");
    }
    assert_eq!(time_unit(&[1.0], IMU_STEP), None);
    // Days of a spreadsheet at 100 Hz and 1 Hz, to the microsecond; fractions of a day.
    let days = |step: f64, first: f64| -> Vec<f64> {
        let day = |k: i32| first + (step * f64::from(k) / 86_400.0 * 1e9).round() / 1e9;
        (0..50).map(day).collect()
    };
    for (step, longest) in [
        (0.01, IMU_STEP),
        (0.2, IMU_STEP),
        (1.0, FIX_STEP),
        (10.0, FIX_STEP),
    ] {
        for first in [45_992.125, 739_806.5, 0.25] {
            let unit = time_unit(&days(step, first), longest);
            assert_eq!(unit, Some(("d", 86_400.0)), "{step} {first}");
        }
    }
    // Seconds that were scaled as nanoseconds are nothing.
    assert_ne!(time_unit(&[0.0, 1e-11], IMU_STEP), Some(("d", 86_400.0)));
    // Bursts of rows microseconds apart, as a program reads them from a port, are seconds.
    let bursts = (0..50).map(|k| f64::from(k / 5) * 0.05 + f64::from(k % 5) * 1e-5);
    assert_eq!(
        time_unit(&bursts.collect::<Vec<_>>(), IMU_STEP),
        Some(("s", 1.0))
    );
}

#[test]
fn names_of_many_programs() {
    use Meaning::*;
    let rows: [(&str, Option<Meaning>, Option<&str>); 56] = [
        ("ax_mm_s2", Some(Accel(0)), Some("mm/s^2")),
        ("lla[0]", Some(Latitude), None),
        ("lla[2]", Some(Height), None),
        ("altHAE", Some(Height), None),
        ("GCrs", Some(Course), None),
        ("Geschwindigkeit (km/h)", Some(Speed), Some("km/h")),
        ("Kurs (°)", Some(Course), Some("deg")),
        ("ms", Some(Time), Some("ms")),
        ("acel_x", Some(Accel(0)), None),
        ("velocidade angular z (rad/s)", Some(Gyro(2)), Some("rad/s")),
        ("locationTimestamp_since1970(s)", Some(Time), Some("s")),
        ("gx_dps", Some(Gyro(0)), Some("deg/s")),
        ("AZ_g", Some(Accel(2)), Some("g")),
        ("gyro_y", Some(Gyro(1)), None),
        ("t_s", Some(Time), Some("s")),
        ("#timestamp [ns]", Some(Time), Some("ns")),
        ("w_RS_S_x [rad s^-1]", Some(Gyro(0)), Some("rad/s")),
        ("a_RS_S_z [m s^-2]", Some(Accel(2)), Some("m/s^2")),
        ("angular_velocity.x", Some(Gyro(0)), None),
        ("linear_acceleration.y", Some(Accel(1)), None),
        ("AccX", Some(Accel(0)), None),
        ("Gyroscope Z (deg/s)", Some(Gyro(2)), Some("deg/s")),
        ("q", Some(Gyro(1)), None),
        ("Latitude", Some(Latitude), None),
        ("lon_deg", Some(Longitude), Some("deg")),
        ("height(m)", Some(Height), Some("m")),
        ("alt_m", Some(Height), Some("m")),
        ("vn_mps", Some(Velocity(0)), Some("m/s")),
        ("vel_e", Some(Velocity(1)), None),
        ("velocity_down", Some(Velocity(2)), None),
        ("vu", Some(VelocityUp), None),
        ("sdn(m)", Some(PositionStd(0)), Some("m")),
        ("std_east", Some(PositionStd(1)), None),
        ("north_std_m", Some(PositionStd(0)), Some("m")),
        ("sdvn", Some(VelocityStd(0)), None),
        ("ve_std_mps", Some(VelocityStd(1)), Some("m/s")),
        ("svd_mps", Some(VelocityStd(2)), Some("m/s")),
        ("speed", Some(Speed), None),
        ("roll_deg", Some(Attitude(0)), Some("deg")),
        ("heading", Some(Attitude(2)), None),
        ("temp", Some(Temperature), None),
        ("board_C", Some(Temperature), Some("degC")),
        ("T_degC", Some(Temperature), Some("degC")),
        ("Date", Some(Date), None),
        ("UTC_time", Some(Time), None),
        ("ecefX", Some(Ecef(0)), None),
        ("y-ecef(m)", Some(Ecef(1)), Some("m")),
        ("ecef_z_m", Some(Ecef(2)), Some("m")),
        ("vx_ecef", Some(EcefVelocity(0)), None),
        ("ecefVZ", Some(EcefVelocity(2)), None),
        ("magx", Some(Field(0)), None),
        ("mag_y (uT)", Some(Field(1)), None),
        ("magnetic_field.z", Some(Field(2)), None),
        ("", None, None),
        ("é", None, None),
        ("x", None, None),
    ];
    for (name, expected, unit) in rows {
        let found = meaning(name);
        assert_eq!(found.as_ref().map(|f| f.0), expected, "{name}");
        assert_eq!(found.and_then(|f| f.1).as_deref(), unit, "{name}");
    }
}

#[test]
fn times_by_many_names() {
    for (name, unit) in [
        ("millis", Some("ms")),
        ("micros()", Some("us")),
        ("elapsed_ms", Some("ms")),
        ("Elapsed Time", None),
        ("SampleTimeFine", None),
        ("Time since start in ms (from the first sample)", Some("ms")),
        ("Time since start in ms", Some("ms")),
        ("TimeUS", Some("us")),
        ("timestamp_usec", Some("us")),
        ("seconds_elapsed", None),
        ("ts", None),
    ] {
        let expected = (Meaning::Time, unit.map(str::to_owned));
        assert_eq!(meaning(name), Some(expected), "{name}");
    }
    // Ticks that are no unit: 100 Hz of an MTi, 120 Hz of a DOT.
    let every = |step: f64| -> Vec<f64> { (0..20).map(|k| 7.0 + step * f64::from(k)).collect() };
    let ticks = |step| {
        time_unit_of("SampleTimeFine", &every(step), IMU_STEP)
            .unwrap()
            .0
    };
    assert_eq!((ticks(100.0), ticks(8333.0)), ("0.1 ms/LSB", "us"));
    assert_eq!(time_unit_of("t", &every(10.0), IMU_STEP).unwrap().0, "ms");
}

#[test]
fn alpha_beside_omega_is_the_specific_force() {
    let of = |names: &str| {
        let names: Vec<String> = names.split(' ').map(str::to_owned).collect();
        let accel = |of: Option<(Meaning, _)>| matches!(of, Some((Meaning::Accel(_), _)));
        Vec::from_iter(meanings(&names).into_iter().map(accel))
    };
    let kalibr = "timestamp omega_x omega_y omega_z alpha_x alpha_y alpha_z";
    assert_eq!(of(kalibr), [false, false, false, false, true, true, true]);
    // An angular acceleration beside another specific force, or alone.
    let both = "omega_x omega_y omega_z alpha_x alpha_y alpha_z ax ay az";
    let last = [false, false, false, false, false, false, true, true, true];
    assert_eq!(of(both), last);
    assert_eq!(of("gx gy gz alpha_x alpha_y alpha_z"), [false; 6]);
}

#[test]
fn every_ending_and_spelling_is_the_unit_that_it_says() {
    use Quantity::*;
    let (degree, g) = (std::f64::consts::PI / 180.0, 9.806_65);
    let endings = [
        ("_radps", AngularRate, 1.0),
        ("_rad_s", AngularRate, 1.0),
        ("_degps", AngularRate, degree),
        ("_deg_s", AngularRate, degree),
        ("_dps", AngularRate, degree),
        ("_mps2", Acceleration, 1.0),
        ("_m_s2", Acceleration, 1.0),
        ("_mps", Velocity, 1.0),
        ("_m_s", Velocity, 1.0),
        ("_mm_s2", Acceleration, 1e-3),
        ("_cm_s2", Acceleration, 1e-2),
        ("_mg", Acceleration, 1e-3 * g),
        ("_g", Acceleration, g),
        ("_deg", Angle, degree),
        ("_rad", Angle, 1.0),
        ("_sec", Time, 1.0),
        ("_msec", Time, 1e-3),
        ("_usec", Time, 1e-6),
        ("_nsec", Time, 1e-9),
        ("_ms", Time, 1e-3),
        ("_us", Time, 1e-6),
        ("_ns", Time, 1e-9),
        ("_s", Time, 1.0),
        ("_m", Length, 1.0),
        ("_hz", Frequency, 1.0),
        ("_dege7", Angle, 1e-7 * degree),
        ("_deg_1e7", Angle, 1e-7 * degree),
        ("_1e7", Angle, 1e-7 * degree),
        ("_e7", Angle, 1e-7 * degree),
        ("_dege6", Angle, 1e-6 * degree),
        ("_1e6", Angle, 1e-6 * degree),
        ("_e6", Angle, 1e-6 * degree),
        ("_mm_s", Velocity, 1e-3),
        ("_mmps", Velocity, 1e-3),
        ("_cm_s", Velocity, 1e-2),
        ("_km_h", Velocity, 1.0 / 3.6),
        ("_kmh", Velocity, 1.0 / 3.6),
        ("_kph", Velocity, 1.0 / 3.6),
        // The statute mile of 5280 feet, the international foot of 0.3048 m.
        ("_mph", Velocity, 5280.0 * 0.3048 / 3600.0),
        ("_days", Time, 86_400.0),
        ("_fps", Velocity, 0.3048),
        ("_ft_s", Velocity, 0.3048),
        ("_feet", Length, 0.3048),
        ("_ft", Length, 0.3048),
        ("_kts", Velocity, 1852.0 / 3600.0),
        ("_knots", Velocity, 1852.0 / 3600.0),
        ("_kn", Velocity, 1852.0 / 3600.0),
        ("_mm", Length, 1e-3),
        ("_cm", Length, 1e-2),
        ("_mradps", AngularRate, 1e-3),
        ("_mrad_s", AngularRate, 1e-3),
        ("_mdps", AngularRate, 1e-3 * degree),
        ("_mdeg_s", AngularRate, 1e-3 * degree),
        ("_dph", AngularRate, degree / 3600.0),
        ("_degph", AngularRate, degree / 3600.0),
        ("_deg_h", AngularRate, degree / 3600.0),
        ("_degs", AngularRate, degree),
        ("_rads", AngularRate, 1.0),
        ("_mps_2", Acceleration, 1.0),
        ("_ms2", Acceleration, 1.0),
        ("_mss", Acceleration, 1.0),
    ];
    let temperatures = ["_kelvin", "_celsius", "_degc", "_c"];
    let spellings = [
        ("dps", AngularRate, degree),
        ("°/s", AngularRate, degree),
        ("degrees/s", AngularRate, degree),
        ("rad s^-1", AngularRate, 1.0),
        ("rad·s^-1", AngularRate, 1.0),
        ("rps", AngularRate, 1.0),
        ("m s^-2", Acceleration, 1.0),
        ("m/s2", Acceleration, 1.0),
        ("m/s²", Acceleration, 1.0),
        ("mps2", Acceleration, 1.0),
        ("m/s/s", Acceleration, 1.0),
        ("m s^-1", Velocity, 1.0),
        ("mps", Velocity, 1.0),
        ("°", Angle, degree),
        ("degrees", Angle, degree),
        ("µs", Time, 1e-6),
        ("usec", Time, 1e-6),
        ("msec", Time, 1e-3),
        ("milliseconds", Time, 1e-3),
        ("sec", Time, 1.0),
        ("seconds", Time, 1.0),
        ("days", Time, 86_400.0),
        ("millisecond", Time, 1e-3),
        ("microsecond", Time, 1e-6),
        ("microseconds", Time, 1e-6),
        ("nanosecond", Time, 1e-9),
        ("nanoseconds", Time, 1e-9),
    ];
    for (ending, _) in SUFFIXES {
        let known = endings.iter().any(|row| row.0 == ending) || temperatures.contains(&ending);
        assert!(known, "{ending}: what is it?");
    }
    let names = endings.map(|(ending, quantity, si)| (format!("x{ending}"), quantity, si));
    let bracketed = spellings.map(|(unit, quantity, si)| (format!("x [{unit}]"), quantity, si));
    for (name, quantity, si) in names.into_iter().chain(bracketed) {
        let (stem, unit) = split_unit(&name);
        assert_eq!(stem, "x");
        let factor = unit_factor(&unit.unwrap(), quantity);
        let factor = factor.unwrap_or_else(|error| panic!("{name}: {error}"));
        // Roundings of the factor.
        assert!((factor / si - 1.0).abs() < 1e-15, "{name}: {factor}");
    }
}

#[test]
fn names_of_other_programs_and_languages() {
    let rate = Some("rad/s".to_owned());
    for (name, expected) in [
        ("gx_mdps", (Meaning::Gyro(0), Some("mdps".to_owned()))),
        ("AcX", (Meaning::Accel(0), None)),
        ("GyZ", (Meaning::Gyro(2), None)),
        ("xacc", (Meaning::Accel(0), None)),
        ("RAW_IMU.ygyro", (Meaning::Gyro(1), None)),
        ("field.angular_velocity.x", (Meaning::Gyro(0), None)),
        ("field.header.stamp", (Meaning::Time, None)),
        ("imu0/linear_acceleration/z", (Meaning::Accel(2), None)),
        ("gyro[1]", (Meaning::Gyro(1), None)),
        ("gFx", (Meaning::Accel(0), None)),
        (
            "x-axis (deg/s)",
            (Meaning::Gyro(0), Some("deg/s".to_owned())),
        ),
        ("Z (g)", (Meaning::Accel(2), Some("g".to_owned()))),
        ("Drehrate x (rad/s)", (Meaning::Gyro(0), rate.clone())),
        ("Vitesse angulaire y [rad/s]", (Meaning::Gyro(1), rate)),
        ("Beschleunigung z", (Meaning::Accel(2), None)),
        ("Länge (°)", (Meaning::Longitude, Some("deg".to_owned()))),
        ("Höhe (m)", (Meaning::Height, Some("m".to_owned()))),
        (
            "altitude_above_seaLevel(feet)",
            (Meaning::Height, Some("feet".to_owned())),
        ),
        ("hour + minute + second", (Meaning::Time, None)),
    ] {
        assert_eq!(meaning(name), Some(expected), "{name}");
    }
    for name in [
        "pid.p",
        "motor.x",
        "gps.h",
        "field.header.frame_id",
        "field.orientation.x",
        "x (m)",
        "xa",
    ] {
        assert_eq!(meaning(name), None, "{name}");
    }
}

#[test]
fn parts_of_a_time_are_no_times_of_their_own() {
    let names = ["day", "hour", "min", "sec", "day + hour + min + sec"].map(str::to_owned);
    let found = meanings(&names);
    assert!(found[..4].iter().all(Option::is_none), "{found:?}");
    assert_eq!(found[4], Some((Meaning::Time, None)));
    let alone = meanings(&["day".to_owned(), "sec".to_owned()]);
    assert!(alone.iter().all(Option::is_some), "{alone:?}");
}

#[test]
fn ticks_of_a_clock_are_a_time_where_their_steps_show_a_usual_unit() {
    let stamps = |step: f64| -> Vec<f64> { (0..100).map(|k| step * f64::from(k)).collect() };
    let unit = |name: &str, step: f64, longest: f64| {
        let found = time_unit_of(name, &stamps(step), longest);
        let unknown = is_of_unknown_ticks(name, &stamps(step), longest);
        (found.map(|(unit, _)| unit), unknown)
    };
    // 100 Hz in ms and us; 0.1 ms and a crystal of 32768 Hz would be 10 Hz and 3 kHz.
    assert_eq!(unit("Ticks", 10.0, IMU_STEP), (Some("ms"), false));
    assert_eq!(unit("tick", 1e4, IMU_STEP), (Some("us"), false));
    assert_eq!(unit("ticks", 100.0, IMU_STEP), (None, true));
    assert_eq!(unit("ticks", 327.68, IMU_STEP), (None, true));
    // Windows' and .NET's, by their size.
    for since in [133_444_736e9, 638_355_968e9] {
        let stamps = Vec::from_iter((0..100).map(|k| since + 2e5 * f64::from(k)));
        let found = time_unit_of("Ticks", &stamps, IMU_STEP);
        assert_eq!(found, Some(("0.1 us/LSB", 1e-7)));
    }
    // Fixes each second.
    assert_eq!(unit("ticks", 1000.0, FIX_STEP), (Some("ms"), false));
    assert_eq!(unit("ticks", 32_768.0, FIX_STEP), (None, true));
    // What is called a time is one.
    assert_eq!(unit("time", 100.0, IMU_STEP), (Some("ms"), false));
}

/// Names of DatCon, Betaflight, PX4's ulog2csv, GoPro, PlotJuggler, Android, OxTS and WitMotion.
#[test]
fn names_as_other_programs_spell_them() {
    let known =
        |name: &str| meaning(name).map(|(meaning, unit)| (meaning, unit.unwrap_or_default()));
    for (name, expected, unit) in [
        ("IMU_ATTI(0):accelX", Meaning::Accel(0), ""),
        ("IMU_ATTI(0):gyroZ", Meaning::Gyro(2), ""),
        ("gyroADC[1]", Meaning::Gyro(1), "deg/s"),
        ("accSmooth[2]", Meaning::Accel(2), ""),
        ("gyro_rad[0]", Meaning::Gyro(0), ""),
        ("accelerometer_m_s2[1]", Meaning::Accel(1), "m/s^2"),
        ("Accelerometer (y) [m/s2]", Meaning::Accel(1), "m/s^2"),
        ("GPS (Lat.) [deg]", Meaning::Latitude, "deg"),
        ("GPS (2D speed) [m/s]", Meaning::Speed, "m/s"),
        ("/gps/fix/latitude", Meaning::Latitude, ""),
        ("GX01_GYRO.Gyroscope (z) [rad/s]", Meaning::Gyro(2), "rad/s"),
        ("TYPE_GYROSCOPE.x", Meaning::Gyro(0), ""),
        ("UncalAccel.MeasurementZ", Meaning::Accel(2), ""),
        ("AngleRateX (deg/s)", Meaning::Gyro(0), "deg/s"),
        ("角速度Y(°/s)", Meaning::Gyro(1), "deg/s"),
        ("GPS地速(km/h)", Meaning::Speed, "km/h"),
        ("纬度(°)", Meaning::Latitude, "deg"),
        ("片上时间()", Meaning::Time, ""),
    ] {
        assert_eq!(known(name), Some((expected, unit.to_owned())), "{name}");
    }
    // An autopilot's own solution.
    assert_eq!(meaning("IMU_ATTI(0):Latitude"), None);
    assert!(is_of_another_quantity("AngleHeading (deg)"));
    assert!(!is_of_another_quantity("X (deg/s)") && !is_of_another_quantity("x_deg"));
}
