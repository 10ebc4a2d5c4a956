//! The drive file with what was found: its own text, changed where that differs.

use super::{
    Tuned,
    axes::{MISALIGNMENT_DEG, SCALE_FACTOR},
    noise::Noise,
};
use std::path::Path;
use toml_edit::{DocumentMut, InlineTable, Item, Table, Value, value};
use undrift_drive::drive::log_tables;
use undrift_noise::ImuModel;

/// The text of a drive file with the noise that was found. `logs` is the folder that its logs are to be looked for
/// from now on, where that is another one.
///
/// # Errors
/// Text that is no TOML.
pub fn tuned(
    text: &str,
    found: &Tuned,
    model: &ImuModel,
    logs: Option<&Path>,
) -> Result<String, toml_edit::TomlError> {
    let mut file: DocumentMut = text.parse()?;
    let mut head = String::new();
    if let Some((key, item)) = file.remove_entry("model")
        && !item.is_table()
    {
        let before = key.leaf_decor().prefix().and_then(|prefix| prefix.as_str());
        head.push_str(kept(before.unwrap_or_default()));
    }
    if let Some(imu) = file.get_mut("imu").and_then(Item::as_table_like_mut) {
        // It is in the noise that was found, but for what changes along the drive.
        if let Some(factors) = found.factors() {
            imu.insert("vibration", value("auto"));
            let mut table = InlineTable::new();
            for (axis, factor) in undrift_noise::model_file::AXES.into_iter().zip(factors) {
                table.insert(axis, Value::from((factor * 1000.0).round() / 1000.0));
            }
            imu.insert("vibration_factors", value(table));
        } else {
            imu.insert("vibration", value("off"));
            imu.remove("vibration_factors");
        }
    }
    let noise = &found.fit.noise;
    let used = &found.prior.used;
    for (table, second) in [("gnss", "velocity"), ("poses", "attitude")] {
        if let Some(fixes) = file.get_mut(table).and_then(Item::as_table_like_mut) {
            let factors = std_factors(noise, used, second);
            if factors.is_empty() {
                fixes.remove("std_factors");
            } else {
                fixes.insert("std_factors", value(factors));
            }
        }
    }
    if let Some(axes) = found.axes.filter(|axes| axes.kept) {
        let states = file.entry("states").or_insert(Item::Table(Table::new()));
        if let Some(states) = states.as_table_like_mut() {
            states.insert("misalignment", value(format!("{MISALIGNMENT_DEG} deg")));
            if axes.scale_factors {
                states.insert("scale_factor", value(SCALE_FACTOR));
            }
        }
    }
    if used[super::noise::RULE] {
        if file.get("vehicle").is_none() {
            file.insert("vehicle", Item::Table(Table::new()));
        }
        if let Some(vehicle) = file.get_mut("vehicle").and_then(Item::as_table_like_mut) {
            let [right, down, slip] = noise.rule;
            vehicle.insert("non_holonomic", value(format!("{right:.3} m/s")));
            vehicle.insert("non_holonomic_down", value(format!("{down:.3} m/s")));
            vehicle.insert("side_slip", value(format!("{slip:.3} s")));
        }
    }
    move_logs(&mut file, logs);
    Ok(format!(
        "{head}{}\n\n# Identified by `undrift tune` in this vehicle.\n[model]\n{}",
        file.to_string().trim_end(),
        inner(model)
    ))
}

/// The text of a drive file as it was, where what was found is worse; `logs` as in [`tuned`].
///
/// # Errors
/// Text that is no TOML.
pub fn unchanged(text: &str, logs: Option<&Path>) -> Result<String, toml_edit::TomlError> {
    let mut file: DocumentMut = text.parse()?;
    move_logs(&mut file, logs);
    Ok(format!(
        "# As it was: what `undrift tune` found is worse than this.\n{file}"
    ))
}

/// The logs of a drive file are in this folder from now on.
fn move_logs(file: &mut DocumentMut, folder: Option<&Path>) {
    let Some(folder) = folder else {
        return;
    };
    for name in log_tables() {
        let table = file.get_mut(name).and_then(Item::as_table_like_mut);
        if let Some(log) = table.and_then(|table| table.get_mut("file"))
            && let Some(path) = log.as_str()
        {
            let decor = log.as_value().map(|log| log.decor().clone());
            let mut moved = Value::from(folder.join(path).to_string_lossy().into_owned());
            if let Some(decor) = decor {
                *moved.decor_mut() = decor;
            }
            *log = Item::Value(moved);
        }
    }
}

/// The comment above the model's key but for its last paragraph, which is on the model, where there are several.
fn kept(comment: &str) -> &str {
    match comment.trim_end().rfind("\n\n") {
        Some(end) => &comment[..end + 1],
        None => comment,
    }
}

/// The model's own file as part of another one, below a head of its own.
fn inner(model: &ImuModel) -> String {
    let text = model.to_toml();
    let is_own = |line: &&str| !line.starts_with("format =") && !line.starts_with("version =");
    let nested = |line: &str| match line.strip_prefix('[') {
        Some(rest) => format!("[model.{rest}\n"),
        None => format!("{line}\n"),
    };
    text.lines().filter(is_own).map(nested).collect()
}

/// The factors on what fixes state of their positions and of the `second` part that they have.
fn std_factors(noise: &Noise, used: &[bool], second: &str) -> InlineTable {
    let factors = noise.factors;
    let all = [
        ("position", factors.white[0]),
        (second, factors.white[1]),
        ("position_correlated", factors.correlated[0]),
        (&format!("{second}_correlated"), factors.correlated[1]),
    ];
    let mut table = InlineTable::new();
    for ((key, factor), used) in all.into_iter().zip(&used[super::noise::FIX..]) {
        if *used {
            table.insert(key, Value::from((factor * 1000.0).round() / 1000.0));
        }
    }
    table
}
