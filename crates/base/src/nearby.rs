//! Names near one that is unknown.

/// Names that are shown.
const SHOWN: usize = 3;
/// Longest name that is compared \[bytes\].
const LONGEST: usize = 255;

/// "did you mean gyro_unit?", of the known names that are one that is unknown in another case or misspelt; `None`
/// without such.
pub fn known<'a>(unknown: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let near = |name: &&str| name.eq_ignore_ascii_case(unknown) || misspelt(unknown, name);
    let mut near = Vec::from_iter(known.into_iter().filter(near));
    near.sort_unstable_by_key(|name| (edits(unknown, name), *name));
    near.dedup();
    question(&near)
}

/// "did you mean imu.csv or imu2.csv?" of the first names, nearest first; `None` without any.
pub fn question(nearest: &[&str]) -> Option<String> {
    let names = Vec::from_iter(nearest.iter().take(SHOWN).copied()).join(" or ");
    (!names.is_empty()).then(|| format!("did you mean {names}?"))
}

/// Whether a name is another with a letter wrong, or two of six and more.
pub fn misspelt(name: &str, known: &str) -> bool {
    let most = (known.len() / 3).min(2);
    known.len() > 3 && edits(name, known).is_some_and(|edits| edits <= most)
}

/// Least number of characters to insert, drop, replace or exchange with their neighbour; `None` for a name too long to be compared.
pub fn edits(a: &str, b: &str) -> Option<usize> {
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
    fn edits_of_names() {
        assert_eq!(edits("kitten", "sitting"), Some(3));
        assert_eq!(edits(&"a".repeat(300), "b"), None);
    }
}
