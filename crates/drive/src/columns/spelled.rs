//! Names of columns as programs spell them, in the spelling that [`super::meaning`] reads.

/// Chinese and Japanese words for what a log has, the longer before their parts.
const WORDS: [(&str, &str); 21] = [
    ("片上时间", "time"),
    ("时间", "time"),
    ("時間", "time"),
    ("時刻", "time"),
    ("日期", "date"),
    ("角速度", "gyro"),
    ("加速度", "acc"),
    ("纬度", "lat"),
    ("緯度", "lat"),
    ("经度", "lon"),
    ("經度", "lon"),
    ("経度", "lon"),
    ("高度", "height"),
    ("海拔", "height"),
    ("航向", "course"),
    ("地速", "speed"),
    ("磁场", "mag"),
    ("磁場", "mag"),
    ("温度", "temperature"),
    ("溫度", "temperature"),
    ("()", ""),
];

/// A name, small: words of other scripts translated, the number of an instance (`IMU_ATTI(0):accelX`) and Android's `TYPE_` left away,
/// and of two words in brackets the first without them (`Accelerometer (x) [m/s2]`).
pub(super) fn plain(name: &str) -> String {
    let mut name = name.trim().to_lowercase();
    if !name.is_ascii() || name.contains("()") {
        for (word, ours) in WORDS {
            name = name.replace(word, ours);
        }
    }
    if let Some(rest) = name.strip_prefix("type_") {
        name = rest.to_owned();
    }
    let parted = |name: &str| -> Option<String> {
        let (before, rest) = name.split_once('(')?;
        let (inside, behind) = rest.split_once(')')?;
        let number = !inside.is_empty() && inside.bytes().all(|byte| byte.is_ascii_digit());
        if number && behind.starts_with(':') {
            Some(format!("{before}{behind}"))
        } else {
            behind
                .contains(['[', '('])
                .then(|| format!("{before}{inside}{behind}"))
        }
    };
    parted(&name).unwrap_or(name)
}
