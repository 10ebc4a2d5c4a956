//! Names of files near one that is not there.

use std::path::Path;

/// Entries of a folder that are looked at.
const MOST: usize = 10_000;
/// Names that are shown.
const SHOWN: usize = 3;
/// Longest name that is compared \[bytes\].
const LONGEST: usize = 255;

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
    let names: Vec<String> = near.into_iter().take(SHOWN).map(|(_, name)| name).collect();
    (!names.is_empty()).then(|| format!("did you mean {}?", names.join(" or ")))
}

/// "did you mean gyro_unit?", of the known names that are one that is unknown in another case or misspelt; `None`
/// without such.
pub fn known<'a>(unknown: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let near = |name: &&str| name.eq_ignore_ascii_case(unknown) || misspelt(unknown, name);
    let mut near = Vec::from_iter(known.into_iter().filter(near));
    near.sort_unstable_by_key(|name| (edits(unknown, name), *name));
    near.dedup();
    let names = Vec::from_iter(near.into_iter().take(SHOWN)).join(" or ");
    (!names.is_empty()).then(|| format!("did you mean {names}?"))
}

/// Whether a name is another with a letter wrong, or two of six and more.
pub fn misspelt(name: &str, known: &str) -> bool {
    let most = (known.len() / 3).min(2);
    known.len() > 3 && edits(name, known).is_some_and(|edits| edits <= most)
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

/// Least number of characters to insert, drop, replace or exchange with their neighbour.
fn edits(a: &str, b: &str) -> Option<usize> {
    (a.len().max(b.len()) <= LONGEST).then(|| strsim::osa_distance(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_names_near_an_unknown_one() {
        let columns = ["t", "gx", "gyro_unit", "gnss"];
        for (unknown, mend) in [
            ("gyro_units", Some("did you mean gyro_unit?")),
            ("gnns", Some("did you mean gnss?")),
            ("GX", Some("did you mean gx?")),
            ("accelerometer", None),
            ("gy", None),
        ] {
            assert_eq!(known(unknown, columns).as_deref(), mend);
        }
        assert!(misspelt("gyro_units", "gyro_unit") && misspelt("tiem", "time"));
        assert!(!misspelt("position_unit", "position_std") && !misspelt("x", "y"));
    }

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
        assert_eq!(edits("kitten", "sitting"), Some(3));
        assert_eq!(edits(&"a".repeat(300), "b"), None);
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
