//! Words that sentences share.

/// A time of a log \[s\], to the millisecond where it has that.
pub(super) fn at(time: f64) -> String {
    let text = format!("{time:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A count and a noun in its number: "1 fix", "2 fixes".
pub(super) fn many(n: u64, what: &str) -> String {
    let plural = if what.ends_with('x') { "es" } else { "s" };
    format!("{n} {what}{}", if n == 1 { "" } else { plural })
}

/// Phrases and words of fixes by a receiver, and what poses have in their place.
const PHRASES: [(&str, &str); 5] = [
    (
        "(RTK on a wrong integer, another base or receiver, multipath?)",
        "(another body, a lost marker, a closed loop?)",
    ),
    (
        "(above sea level against above the ellipsoid?)",
        "(another body, a lost marker, a closed loop?)",
    ),
    ("position and velocity of", "position and attitude of"),
    ("GNSS outages", "Spans without poses"),
    ("GNSS was cut", "poses were cut"),
];
const WORDS: [(&str, &str); 7] = [
    ("fix", "pose"),
    ("fixes", "poses"),
    ("fixes'", "poses'"),
    ("GNSS", "poses"),
    ("receiver", "tracker"),
    ("receiver's", "tracker's"),
    ("antenna", "marker"),
];

/// A text as it is, or of a drive by poses.
pub(crate) fn worded(text: String, posed: bool) -> String {
    if !posed {
        return text;
    }
    let text = PHRASES
        .iter()
        .fold(text, |text, (gnss, poses)| text.replace(gnss, poses));
    // Words stand between spaces, with their punctuation; names of files have more than that.
    let word = |of: &str| {
        let word = of.trim_matches([',', '.', ';', ':', '(', ')', '\n']);
        let other = WORDS.iter().find(|(gnss, _)| *gnss == word);
        other.map_or_else(|| of.to_owned(), |(_, poses)| of.replacen(word, poses, 1))
    };
    let words = text.split_inclusive([' ', '\n']).map(|of| {
        let (word_of, end) = of.split_at(of.trim_end_matches([' ', '\n']).len());
        word(word_of) + end
    });
    words.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_by_poses_has_no_gnss() {
        let said = "12 fixes used; without GNSS: the fixes' clock (the receiver's) of fixes.csv\nGNSS, a fix. GNSS was cut";
        let posed = "12 poses used; without poses: the poses' clock (the tracker's) of fixes.csv\nposes, a pose. poses were cut";
        assert_eq!(worded(said.into(), true), posed);
        assert_eq!(worded(said.into(), false), said);
        assert_eq!(
            worded("prefix fixed GNSS-like".into(), true),
            "prefix fixed GNSS-like"
        );
    }
}
