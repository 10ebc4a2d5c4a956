//! Kalibr's `imu.yaml` as a model: its four numbers are densities N of white noise and K of the random walk of the bias, in continuous
//! time ([IMU Noise Model](https://github.com/ethz-asl/kalibr/wiki/IMU-Noise-Model)), the same for the three axes of a sensor.

use super::{FORMAT, ModelError, VERSION};

/// Keys, the tables and keys of a model file for them, and their units.
const KEYS: [(&str, &str, &str, &str); 4] = [
    (
        "gyroscope_noise_density",
        "gyro",
        "white_noise",
        "rad/s/sqrt(Hz)",
    ),
    (
        "gyroscope_random_walk",
        "gyro",
        "random_walk",
        "rad/s^2/sqrt(Hz)",
    ),
    (
        "accelerometer_noise_density",
        "accel",
        "white_noise",
        "m/s^2/sqrt(Hz)",
    ),
    (
        "accelerometer_random_walk",
        "accel",
        "random_walk",
        "m/s^3/sqrt(Hz)",
    ),
];

/// The text of the model file that such a text is; `None` of any other.
///
/// # Errors
/// If one of the numbers is missing or not above zero.
pub(super) fn as_model(text: &str, file: &str) -> Result<Option<String>, ModelError> {
    let find = |key: &str| {
        let mut lines = text.lines().enumerate();
        lines.find_map(|(line, text)| {
            let value = text.trim_start().strip_prefix(key)?.trim_start();
            let value = value.strip_prefix(':')?.split('#').next()?;
            Some((line + 1, value.trim()))
        })
    };
    if KEYS.iter().filter(|(key, ..)| find(key).is_some()).count() < 2 {
        return Ok(None);
    }
    let error = |line, key: &str, message: &str| ModelError::Entry {
        file: file.to_owned(),
        line,
        key: key.to_owned(),
        message: message.to_owned(),
    };
    let mut model =
        format!("format = \"{FORMAT}\"\nversion = {VERSION}\nname = \"imu.yaml of Kalibr\"\n");
    model += "source = \"densities in continuous time, as stated for Kalibr\"\n";
    let mut table = "";
    for (key, of, ours, unit) in KEYS {
        let missing = "missing: add it; Kalibr's imu.yaml has noise densities and random walks";
        let (line, value) = find(key).ok_or_else(|| error(None, key, missing))?;
        let number: Option<f64> = value.parse().ok();
        let number = number.filter(|number| number.is_finite() && *number > 0.0);
        let number = number.ok_or_else(|| error(Some(line), key, "write a number above zero"))?;
        if table != of {
            table = of;
            model += &format!("[{of}]\n");
        }
        model += &format!("{ours} = \"{number} {unit}\"\n");
    }
    Ok(Some(model))
}

#[cfg(test)]
mod tests {
    use super::super::ImuModel;

    const YAML: &str = "#Accelerometers\naccelerometer_noise_density: 1.86e-03   # [ m / s^2 / sqrt(Hz) ]\naccelerometer_random_walk: 4.33e-04\ngyroscope_noise_density: 1.87e-04\ngyroscope_random_walk:   2.66e-05\nrostopic: /imu0\nupdate_rate: 200.0\n";

    #[test]
    fn the_four_numbers_are_those_of_all_axes() {
        let nested = format!("imu0:\n{}", YAML.replace('\n', "\n  "));
        for text in [YAML, &nested] {
            let model = ImuModel::from_toml(text, "imu.yaml").unwrap();
            for (axes, white, walk) in [
                (&model.gyro, 1.87e-4, 2.66e-5),
                (&model.accel, 1.86e-3, 4.33e-4),
            ] {
                for axis in axes {
                    assert!((axis.white.unwrap() / white - 1.0).abs() < 1e-12);
                    assert!((axis.random_walk.unwrap() / walk - 1.0).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn what_lacks_a_number_is_refused_at_its_line() {
        let of = |text: &str| {
            ImuModel::from_toml(text, "imu.yaml")
                .unwrap_err()
                .to_string()
        };
        let negative = of(&YAML.replace("4.33e-04", "-1"));
        assert!(
            negative.contains("imu.yaml line 3") && negative.contains("above zero"),
            "{negative}"
        );
        let missing = of(&YAML.replace("gyroscope_random_walk", "walk"));
        assert!(
            missing.contains("gyroscope_random_walk: missing"),
            "{missing}"
        );
    }
}
