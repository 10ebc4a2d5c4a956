//! Poses in a local frame by the names of their columns.

use super::{Meaning, meanings};
use super::{RECEIVED, letters, spelled, split_unit, time_unit_of};
use undrift_io::poses::{AttitudeColumns, PoseFormat, QuaternionOrder};
use undrift_io::table::{Column, Preview};
use undrift_nav::units::{Quantity, unit_factor};

/// Longest ordinary step of a log of poses \[s\]: cameras and trackers have 1 Hz and more. Milliseconds at 500 Hz are longer.
const POSE_STEP: f64 = 1.5;

/// Words for a position, for the rotation of a quaternion, and for angles.
const POSITIONS: [&str; 9] = [
    "p",
    "pos",
    "position",
    "positions",
    "t",
    "trans",
    "translation",
    "loc",
    "location",
];
const ROTATIONS: [&str; 10] = [
    "q",
    "quat",
    "quaternion",
    "orientation",
    "rotation",
    "rot",
    "attitude",
    "att",
    "ori",
    "o",
];
const ANGLES: [&str; 3] = ["roll", "pitch", "yaw"];
const STDS: [&str; 4] = ["std", "stddev", "sigma", "sd"];
/// Words beside these that say where a pose is from, or in which frame; of EuRoC `RS` and `R`.
const PLACES: [&str; 33] = [
    "field",
    "msg",
    "message",
    "data",
    "header",
    "pose",
    "poses",
    "transform",
    "body",
    "rigid",
    "rigidbody",
    "marker",
    "object",
    "target",
    "mocap",
    "vicon",
    "optitrack",
    "qualisys",
    "vrpn",
    "odom",
    "odometry",
    "camera",
    "cam",
    "slam",
    "vio",
    "gt",
    "ground",
    "truth",
    "groundtruth",
    "world",
    "map",
    "rs",
    "r",
];

/// What a column has of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// Along x, y, z (0, 1, 2).
    Position(usize),
    PositionStd(usize),
    /// x, y, z, w (0 to 3).
    Quaternion(usize),
    /// Of a quaternion whose parts have numbers, from 0 on.
    Numbered(usize),
    /// Roll, pitch, yaw.
    Angle(usize),
}

/// How a table of poses is read by the names of its columns, and by its first rows where no name states the unit of the
/// times or angles; lengths without a unit are metres. `None` without times, or with neither position nor attitude. A
/// part that several columns could be, as of several bodies, is left to the user.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::columns::poses;
/// use undrift_io::table::Preview;
/// let names = ["time", "pose.position.x", "pose.position.y", "pose.position.z"];
/// let table = Preview { names: names.map(str::to_owned).to_vec(), ..Preview::default() };
/// let format = poses(&table).unwrap();
/// assert!(format.position.is_some() && format.attitude.is_none());
/// ```
pub fn poses(table: &Preview) -> Option<PoseFormat> {
    let parts: Vec<Option<(Part, Option<String>)>> =
        table.names.iter().map(|name| part(name)).collect();
    let place = |wanted: Part| -> Option<usize> {
        let is = |of: &Option<(Part, _)>| of.as_ref().is_some_and(|(part, _)| *part == wanted);
        let mut places = (0..parts.len()).filter(|place| parts.get(*place).is_some_and(is));
        places.next().filter(|_| places.next().is_none())
    };
    let unit = |place: usize| parts.get(place)?.as_ref()?.1.as_deref();
    let columns = |wanted: fn(usize) -> Part| -> Option<[usize; 3]> {
        let places = [0, 1, 2].map(|k| place(wanted(k)));
        let all: Vec<usize> = places.into_iter().flatten().collect();
        all.try_into().ok()
    };
    let (time, time_scale) = time(table)?;
    let position = columns(Part::Position).or_else(|| level(table));
    let length = |places: [usize; 3]| {
        let unit = unit(places[0]).unwrap_or("m");
        unit_factor(unit, Quantity::Length).unwrap_or(1.0)
    };
    let position_scale = position.map_or(1.0, length);
    // One factor is of both.
    let position_std = columns(Part::PositionStd)
        .filter(|std| position.is_some() && length(*std) == position_scale);
    let quaternion = |wanted: fn(usize) -> Part, first: usize| -> Option<Vec<usize>> {
        (first..first + 4).map(|k| place(wanted(k))).collect()
    };
    let by_letters = quaternion(Part::Quaternion, 0).map(|places| (places, false, false));
    // Of numbers from 0 the first is the scalar part by habit, from 1 the last.
    let from_zero = || quaternion(Part::Numbered, 0).map(|places| (places, true, true));
    let from_one = || quaternion(Part::Numbered, 1).map(|places| (places, false, true));
    let found = by_letters.or_else(from_zero).or_else(from_one);
    let of = |places: &[usize]| -> Vec<Column> {
        places.iter().map(|place| column(table, *place)).collect()
    };
    let mut quaternion_order = QuaternionOrder::Stated;
    let attitude = match found {
        Some((places, w_first, guessed)) => {
            if guessed {
                quaternion_order = QuaternionOrder::Guessed;
            }
            let columns = of(&places).try_into().ok()?;
            Some(AttitudeColumns::Quaternion { columns, w_first })
        }
        None => columns(Part::Angle).map(|places| AttitudeColumns::Euler {
            columns: places.map(|place| column(table, place)),
            scale: angle_scale(table, places, unit(places[0])),
        }),
    };
    if position.is_none() && attitude.is_none() {
        return None;
    }
    let three = |places: [usize; 3]| places.map(|place| column(table, place));
    let date = meanings(&table.names)
        .iter()
        .position(|of| matches!(of, Some((Meaning::Date, _))));
    Some(PoseFormat {
        date: date.map(|place| column(table, place)),
        time_scale,
        position_scale,
        position_std: position_std.map(three),
        quaternion_order,
        ..PoseFormat::new(column(table, time), position.map(three), attitude)
    })
}

/// East, north and up, which a frame is that has z up.
fn level(table: &Preview) -> Option<[usize; 3]> {
    let names = Vec::from_iter(
        table
            .names
            .iter()
            .map(|name| split_unit(&name.to_lowercase()).0.to_owned()),
    );
    let at = |of: fn(Meaning) -> bool| {
        let is = |name: &String| super::meaning(name).is_some_and(|(meaning, _)| of(meaning));
        names.iter().position(is)
    };
    let up = || {
        names
            .iter()
            .position(|name| matches!(name.as_str(), "up" | "u" | "z"))
    };
    Some([
        at(|of| of == Meaning::Grid(0))?,
        at(|of| of == Meaning::Grid(1))?,
        at(|of| of == Meaning::Height).or_else(up)?,
    ])
}

/// The column of a place: by its name, if that is the only one of it.
fn column(table: &Preview, place: usize) -> Column {
    let name = table.names.get(place).filter(|name| {
        !name.is_empty() && table.names.iter().filter(|other| other == name).count() == 1
    });
    name.map_or(Column::Number(place + 1), |name| Column::Name(name.clone()))
}

/// The column of times and its factor to seconds. Of several the stamp of a message's header is it, and not when that was received.
fn time(table: &Preview) -> Option<(usize, f64)> {
    let found = meanings(&table.names);
    let is_stamp = |place: &usize| {
        let name = table.names.get(*place).map(|name| letters(name));
        name.is_some_and(|name| name.ends_with("headerstamp"))
    };
    let is_received = |place: &usize| {
        let name = table.names.get(*place).map(|name| letters(name));
        name.is_some_and(|name| name == RECEIVED)
    };
    let is_time = |place: &usize| matches!(found.get(*place), Some(Some((Meaning::Time, _))));
    let all = || 0..table.names.len();
    let place = (all().find(is_stamp))
        .or_else(|| all().find(|place| is_time(place) && !is_received(place)))
        .or_else(|| all().find(is_time))
        .or_else(|| table.times.first().copied())?;
    let named = found.get(place).and_then(|of| of.as_ref()?.1.clone());
    let named = named.and_then(|unit| unit_factor(&unit, Quantity::Time).ok());
    let value = |row: &Vec<f64>| row.get(place).copied().filter(|x| x.is_finite());
    let stamps: Vec<f64> = table.rows.iter().filter_map(value).collect();
    let name = table.names.get(place).map_or("", String::as_str);
    let by_steps = || time_unit_of(name, &stamps, POSE_STEP).map(|(_, factor)| factor);
    Some((place, named.or_else(by_steps).unwrap_or(1.0)))
}

/// Factor of angles to radians: by the unit that a name states, else radians where none is more than a turn.
fn angle_scale(table: &Preview, places: [usize; 3], unit: Option<&str>) -> f64 {
    if let Some(factor) = unit.and_then(|unit| unit_factor(unit, Quantity::Angle).ok()) {
        return factor;
    }
    let turn = 2.0 * std::f64::consts::PI;
    let angles = table
        .rows
        .iter()
        .flat_map(|row| places.map(|place| row.get(place)));
    let mut angles = angles
        .flatten()
        .filter(|angle| angle.is_finite())
        .peekable();
    match angles.peek().is_some() && angles.all(|angle| angle.abs() <= turn) {
        true => 1.0,
        false => 1f64.to_radians(),
    }
}

/// What a column has of a pose by its name, and the unit that it states.
fn part(name: &str) -> Option<(Part, Option<String>)> {
    let (name, index) = without_index(name.trim());
    let small = name.to_lowercase();
    let (stem, unit) = split_unit(&small);
    // As long as the stem, in which letters are small.
    let mut words = words(name.get(..stem.len()).unwrap_or(stem));
    words.extend(index);
    let part = of_words(words)?;
    let unit = unit
        .map(|unit| spelled(&unit))
        .filter(|unit| !matches!(unit.as_str(), "" | "-" | "1"));
    let fits = unit.as_deref().is_none_or(|unit| match part {
        Part::Position(_) | Part::PositionStd(_) => unit_factor(unit, Quantity::Length).is_ok(),
        Part::Angle(_) => unit_factor(unit, Quantity::Angle).is_ok(),
        Part::Quaternion(_) | Part::Numbered(_) => false,
    });
    fits.then_some((part, unit))
}

/// `position[0]` as its name and the index, a word of its own.
fn without_index(name: &str) -> (&str, Option<String>) {
    let cut = name
        .strip_suffix(']')
        .and_then(|name| name.rsplit_once('['));
    match cut {
        Some((before, index)) if index.len() == 1 && index.bytes().all(|b| b.is_ascii_digit()) => {
            (before, Some(index.to_owned()))
        }
        _ => (name, None),
    }
}

/// The words of a name in small letters: `pose.positionX` are three.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for letter in name.chars() {
        let begins = before.is_ascii_lowercase() && letter.is_ascii_uppercase();
        if begins || !letter.is_ascii_alphanumeric() {
            words.push(String::new());
        }
        if let (Some(word), true) = (words.last_mut(), letter.is_ascii_alphanumeric()) {
            word.push(letter.to_ascii_lowercase());
        }
        before = letter;
    }
    words.retain(|word| !word.is_empty());
    words
}

fn of_words(mut words: Vec<String>) -> Option<Part> {
    // `x_position` as `position_x`.
    if words.len() > 1 && words.first().is_some_and(|word| axis(word).is_some()) {
        words.rotate_left(1);
    }
    // `px` and `q0` are two words; a place may have a number.
    let words: Vec<String> = words.iter().flat_map(|word| apart(word)).collect();
    let is = |known: &[&str]| words.iter().any(|word| known.contains(&word.as_str()));
    let is_known = |word: &String| {
        let known = [
            &POSITIONS[..],
            &ROTATIONS,
            &ANGLES,
            &STDS,
            &PLACES,
            &["euler", "angle"],
        ];
        known.concat().contains(&word.as_str()) || word.bytes().all(|b| b.is_ascii_digit())
    };
    let (last, before) = words.split_last()?;
    if let Some(angle) = ANGLES.iter().position(|name| name == last) {
        let known = before.iter().all(is_known) && !is(&STDS);
        return known.then_some(Part::Angle(angle));
    }
    // `x_std`.
    let (last, before) = match (STDS.contains(&last.as_str()), before.split_last()) {
        (true, Some((axis, before))) => (axis, before),
        _ => (last, before),
    };
    if !before.iter().all(is_known) || is(&ANGLES) {
        return None;
    }
    let rotation = before.iter().any(|word| ROTATIONS.contains(&word.as_str()));
    let number = last
        .parse::<usize>()
        .ok()
        .filter(|number| last.len() == 1 && *number <= 4);
    match (axis(last), number) {
        (Some(axis), _) if rotation => (!is(&STDS)).then_some(Part::Quaternion(axis)),
        (Some(axis @ 0..=2), _) if is(&STDS) => Some(Part::PositionStd(axis)),
        (Some(axis @ 0..=2), _) => Some(Part::Position(axis)),
        (None, Some(number)) if rotation => Some(Part::Numbered(number)),
        (None, Some(number @ 0..=2)) if is(&POSITIONS) => Some(Part::Position(number)),
        _ => None,
    }
}

/// x, y, z, w (0 to 3).
fn axis(word: &str) -> Option<usize> {
    ["x", "y", "z", "w"].iter().position(|axis| *axis == word)
}

/// The parts of a word that is a quantity and an axis or number behind it, `qw`, or a place with a number; else itself.
fn apart(word: &str) -> Vec<String> {
    let without_number = word.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let number = word.get(without_number.len()..).unwrap_or_default();
    let is = |known: &[&str], word: &str| known.contains(&word);
    if !number.is_empty() && (is(&PLACES, without_number) || is(&ROTATIONS, without_number)) {
        return vec![without_number.to_owned(), number.to_owned()];
    }
    let stem = word.strip_suffix(['x', 'y', 'z', 'w']);
    let quantity = |stem: &&str| is(&POSITIONS, stem) || is(&ROTATIONS, stem) || is(&STDS, stem);
    match stem.filter(quantity) {
        Some(stem) => vec![stem.to_owned(), word[stem.len()..].to_owned()],
        None => vec![word.to_owned()],
    }
}

#[cfg(test)]
mod tests;
