//! Names of files near one that is not there.

use std::path::Path;
use undrift_base::nearby::{edits, question};

/// Entries of a folder that are looked at.
const MOST: usize = 10_000;

/// "did you mean imu.csv.gz?", from the folder of a file that is not there; `None` without a near name.
pub fn names(path: &Path) -> Option<String> {
    let wanted = path.file_name()?.to_string_lossy().into_owned();
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut near: Vec<(usize, String)> = std::fs::read_dir(folder)
        .ok()?
        .take(MOST)
        .filter_map(|entry| {
            let name = entry.ok()?.file_name().to_string_lossy().into_owned();
            Some((distance(&wanted, &name)?, name))
        })
        .collect();
    near.sort();
    question(&Vec::from_iter(near.iter().map(|(_, name)| name.as_str())))
}

/// How far a name is from the wanted one, small first; `None` for too far.
fn distance(wanted: &str, name: &str) -> Option<usize> {
    let (wanted, name) = (wanted.to_lowercase(), name.to_lowercase());
    let more = |long: &str, short: &str| {
        long.strip_prefix(short)
            .is_some_and(|rest| rest.starts_with('.'))
    };
    // imu.csv and imu.csv.gz, whatever the length of what is missing.
    if wanted == name || more(&name, &wanted) || more(&wanted, &name) {
        return Some(0);
    }
    let edits = edits(&wanted, &name)?;
    (edits <= wanted.chars().count().max(3) / 3).then_some(edits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_and_far() {
        for (wanted, name, near) in [
            ("imu.csv", "imu.csv.gz", Some(0)),
            ("imu.csv.gz", "imu.csv", Some(0)),
            ("IMU.csv", "imu.csv", Some(0)),
            ("imv.csv", "imu.csv", Some(1)),
            ("truht.csv", "truth.csv", Some(1)),
            ("drvie.toml", "drive.toml", Some(1)),
            ("imu.csv", "gnss.csv", None),
            ("imu.csv", "nav.csv", None),
            ("a", "b", Some(1)),
            ("", "imu.csv", None),
        ] {
            assert_eq!(distance(wanted, name), near, "{wanted} {name}");
        }
    }

    #[test]
    fn the_nearest_come_first() {
        let folder = std::env::temp_dir().join(format!("undrift-io-{}-near", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for name in ["imu.csv", "imu2.csv", "truth.csv"] {
            std::fs::write(folder.join(name), "").unwrap();
        }
        let said = names(&folder.join("imv.csv"));
        std::fs::remove_dir_all(&folder).unwrap();
        assert_eq!(said.unwrap(), "did you mean imu.csv or imu2.csv?");
        assert_eq!(names(Path::new("no/such/folder/imu.csv")), None);
    }
}
