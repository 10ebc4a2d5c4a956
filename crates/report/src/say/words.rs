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
