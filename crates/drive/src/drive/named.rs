//! Which files a drive file names.

use super::{ScalarLog, Section, magnetometer, parse};

/// The files that a drive file's text names, by their tables: "imu", "gnss" and so on, and "model", which
/// may be a preset as well. Of a text that is not a valid drive file, those that can be found.
///
/// ```
/// # use undrift_drive as undrift;
/// let text = "model = \"imu.toml\"\n[imu]\nfile = \"flight.bin\"\n[gnss]\nfile = \"flight.bin\"\n";
/// let named = undrift::drive::files_named(text);
/// assert!(named.contains(&("imu", "flight.bin".to_owned())) && named.contains(&("model", "imu.toml".to_owned())));
/// ```
pub fn files_named(text: &str) -> Vec<(&'static str, String)> {
    let Ok(table) = parse(text, "") else {
        return Vec::new();
    };
    let top = Section::top(table.get_ref(), text, "");
    let mut named: Vec<_> = log_tables()
        .filter_map(|log| Some((log, top.section(log).ok()?.text("file").ok()??.to_owned())))
        .collect();
    let model = top.text("model").ok().flatten();
    named.extend(model.map(|name| ("model", name.to_owned())));
    named
}

/// The files that a drive file's text names beside its log of fixes, those of `observations`.
///
/// ```
/// # use undrift_drive as undrift;
/// let text = "[gnss]\nfile = \"rover.pos\"\nobservations = [\"rover.obs\", \"rover.nav\"]\n";
/// assert_eq!(undrift::drive::files_beside(text), ["rover.obs", "rover.nav"]);
/// ```
pub fn files_beside(text: &str) -> Vec<String> {
    let Ok(table) = parse(text, "") else {
        return Vec::new();
    };
    let gnss = Section::top(table.get_ref(), text, "").section("gnss");
    let names = gnss.and_then(|gnss| gnss.texts("observations"));
    let names = names.unwrap_or_default().into_iter();
    names.map(str::to_owned).collect()
}

/// Names of the tables of a drive file that name a log.
pub fn log_tables() -> impl Iterator<Item = &'static str> {
    let scalars = ScalarLog::ALL.map(ScalarLog::name);
    let logs = ["imu", "gnss", "poses"].into_iter();
    logs.chain(scalars).chain([magnetometer::TABLE, "truth"])
}
