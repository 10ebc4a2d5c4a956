//! What the columns of a table are: by their names, and where they have none by their numbers.

use super::{
    found::{Found, GRID},
    numbers::{are_exchanged, by_numbers, is_force, three_of, time_by_numbers},
    units::{self, Force},
};
use crate::columns::{
    FIX_STEP, IMU_STEP, Meaning, RECEIVED, is_of_unknown_ticks, meanings, ordinary_step,
    time_unit_of,
};
use toml::Value;
use undrift_io::{Opened, ReadError, table::Preview};
use undrift_results::inspect::{Known, Line, Note, Part, PoseFault};

/// By the names of several columns.
pub(super) const NAMES: Known = Known::Name { several: true };

/// Rows that are looked at.
const ROWS: usize = 4000;

/// The tables of a drive file that columns can serve.
pub(super) fn parts(mut opened: Opened, notes: &mut Vec<Note>) -> Result<Vec<Part>, ReadError> {
    Ok(parts_of(opened.preview(ROWS)?, notes))
}

/// The same of a table's beginning.
pub(super) fn parts_of(mut table: Preview, notes: &mut Vec<Note>) -> Vec<Part> {
    // A row that is cut, as the first of a log often is, shows nothing.
    let width = usual_width(&table.rows);
    table
        .rows
        .retain(|row| row.len() == width && row.iter().any(|x| x.is_finite()));
    let mut found = by_names(&table);
    let is_nothing = [&found.gyro, &found.accel, &found.ecef, &found.place].map(all) == [None; 4];
    let posed = || crate::columns::poses(&table);
    let is_grid = grid_of(&table, &found).is_some();
    if is_nothing
        && !is_grid
        && let Some(format) = posed()
    {
        if format.position.is_some() && format.attitude.is_some() {
            return vec![super::poses::part()];
        }
        if format.position.is_none() && format.attitude.is_some() {
            notes.push(Note::Poses(PoseFault::NoPositions));
            return Vec::new();
        }
        if super::poses::is_path(&table, &format) {
            return vec![super::poses::part_of_positions()];
        }
    }
    // Columns of latitudes are never turned into gyros.
    let is_place = found.place[0].or(found.place[1]).is_some() || is_grid;
    if !is_place && [&found.gyro, &found.ecef].map(all) == [None; 2] {
        let by_numbers = by_numbers(&table);
        let shows = [by_numbers.accel[0], by_numbers.place[0], by_numbers.ecef[0]];
        if shows.iter().any(Option::is_some) {
            found = by_numbers;
        }
    }
    let meanings = meanings(&table.names);
    let columns = Columns {
        table,
        meanings,
        found,
    };
    let mut parts = Vec::new();
    if let (Some(gyro), Some(accel)) = (all(&columns.found.gyro), all(&columns.found.accel)) {
        parts.push(Part::new("imu", columns.imu(gyro, accel, notes)));
    }
    if let Some(place) = columns.place_of() {
        let reference = all(&columns.found.attitude).filter(|_| parts.is_empty());
        parts.push(match reference {
            Some(attitude) if !is_flat(place) => Part::new("truth", columns.truth(place, attitude)),
            _ => Part::new("gnss", columns.gnss(place)),
        });
    }
    if let Some(antennas) = columns.found.antennas {
        parts.push(Part::new("heading", columns.heading(antennas)));
    }
    if let Some(field) = all(&columns.found.field) {
        parts.extend(columns.field(field));
    }
    units::share_unit_of_time(&mut parts);
    let names = &columns.table.names;

    if parts.is_empty() {
        notes.push(match names.len() {
            0 => Note::UnknownColumns,
            _ => Note::Columns(names.clone()),
        });
    } else if parts
        .iter()
        .any(|part| part.lines.iter().all(|line| line.key != "time"))
    {
        notes.push(Note::NoTimes);
    }
    parts
}

/// As many fields as most rows have.
fn usual_width(rows: &[Vec<f64>]) -> usize {
    let mut widths: Vec<usize> = rows.iter().map(Vec::len).collect();
    widths.sort_unstable();
    let runs = widths.chunk_by(|a, b| a == b);
    let longest = runs.max_by_key(|run| run.len());
    longest.and_then(|run| run.first()).copied().unwrap_or(0)
}

pub(super) fn all(&[x, y, z]: &[Option<usize>; 3]) -> Option<[usize; 3]> {
    Some([x?, y?, z?])
}

fn by_names(table: &Preview) -> Found {
    let mut found = Found {
        known: Known::Name { several: false },
        ..Found::default()
    };
    let mut received = None;
    let mut accels: Vec<[Option<usize>; 3]> = Vec::new();
    let meanings = meanings(&table.names);
    let latitude = meanings
        .iter()
        .position(|known| matches!(known, Some((Meaning::Latitude, _))));
    let has = |row: &Vec<f64>, place: usize| row.get(place).is_some_and(|x| x.is_finite());
    // Of another sensor in the same table, blank where there are positions.
    let is_apart = |place: usize| {
        let fixes = latitude.map(|lat| table.rows.iter().filter(move |row| has(row, lat)));
        fixes.is_some_and(|mut fixes| {
            fixes.clone().next().is_some() && !fixes.any(|row| has(row, place))
        })
    };
    for (place, meaning) in meanings.into_iter().enumerate() {
        let slot = match meaning {
            Some((Meaning::Accuracy(_) | Meaning::Speed | Meaning::Course, _))
                if is_apart(place) =>
            {
                continue;
            }
            Some((Meaning::Time, _)) if table.names[place] == RECEIVED => &mut received,
            Some((Meaning::Time, _)) => {
                found.times.push(place);
                &mut found.time
            }
            Some((Meaning::Gyro(axis), _)) => &mut found.gyro[axis],
            Some((Meaning::Accel(axis), _)) => {
                match accels.iter_mut().find(|three| three[axis].is_none()) {
                    Some(three) => three[axis] = Some(place),
                    None => accels.push(std::array::from_fn(|k| (k == axis).then_some(place))),
                }
                &mut found.accel[axis]
            }
            Some((Meaning::Latitude, _)) => &mut found.place[0],
            Some((Meaning::Longitude, _)) => &mut found.place[1],
            Some((Meaning::Height, _)) => &mut found.place[2],
            Some((Meaning::Grid(axis), _)) => &mut found.grid[axis],
            Some((Meaning::Zone, _)) => &mut found.zone[0],
            Some((Meaning::Band, _)) => &mut found.zone[1],
            Some((Meaning::Date, _)) => &mut found.date,
            Some((Meaning::Ecef(axis), _)) => &mut found.ecef[axis],
            Some((Meaning::EcefVelocity(axis), _)) => &mut found.ecef_velocity[axis],
            Some((Meaning::Velocity(ned), _)) => &mut found.velocity[ned],
            Some((Meaning::VelocityUp, _)) => {
                found.up = true;
                &mut found.velocity[2]
            }
            Some((Meaning::Speed, _)) => &mut found.polar[0],
            Some((Meaning::Course, _)) => &mut found.polar[1],
            Some((Meaning::Accuracy(of), _)) => &mut found.accuracy[of],
            Some((Meaning::PositionStd(ned), _)) => &mut found.position_std[ned],
            Some((Meaning::VelocityStd(ned), _)) => &mut found.velocity_std[ned],
            Some((Meaning::Attitude(angle), _)) => &mut found.attitude[angle],
            Some((Meaning::AntennaHeading, _)) => &mut found.antennas,
            Some((Meaning::Field(axis), _)) => &mut found.field[axis],
            Some((Meaning::Temperature, _)) | None => continue,
        };
        // The first of its kind.
        slot.get_or_insert(place);
    }
    // Of several accelerations the one that has gravity.
    let forces = accels.iter().filter_map(all);
    let mut with_gravity = forces.filter(|places| is_force(&three_of(&table.rows, *places)));
    if let Some(places) = with_gravity.next() {
        found.accel = places.map(Some);
    }
    // The clock of the sensor itself is the better one.
    found.time = found.time.or(received);
    // A date with the time of day behind it.
    if let (None, Some(date)) = (found.time, found.date)
        && table.times.contains(&date)
    {
        (found.time, found.date) = (found.date, None);
    }
    // Without roll and pitch a heading is that of a receiver.
    let [roll, pitch, heading] = found.attitude;
    if roll.or(pitch).is_none() && found.polar[0].is_some() {
        found.polar[1] = found.polar[1].or(heading);
    }
    found
}

/// Whether gyroscopes and accelerometers have values in rows of their own.
pub(crate) fn apart(rows: &[Vec<f64>], gyro: [usize; 3], accel: [usize; 3]) -> bool {
    let has = |row: &&Vec<f64>, places: [usize; 3]| {
        let mut places = places.iter();
        places.all(|place| row.get(*place).is_some_and(|x| x.is_finite()))
    };
    let count = |gyros: bool, accels: bool| {
        let those = rows
            .iter()
            .filter(|row| has(row, gyro) == gyros && has(row, accel) == accels);
        those.count()
    };
    let (alone, both) = ([count(true, false), count(false, true)], count(true, true));
    let some = |alone: usize| alone + both > 0;
    some(alone[0]) && some(alone[1]) && 5 * (alone[0] + alone[1]) >= rows.len()
}

/// Share of the rows that have the stamp of the row before and other values.
fn shared_stamps(rows: &[Vec<f64>], time: usize, gyro: [usize; 3], accel: [usize; 3]) -> f64 {
    let differ = |pair: &[Vec<f64>]| {
        let is_other = |place: &usize| pair[0].get(*place) != pair[1].get(*place);
        pair[0].get(time) == pair[1].get(time) && gyro.iter().chain(&accel).any(is_other)
    };
    let shared = rows.windows(2).filter(|pair| differ(pair)).count();
    shared as f64 / rows.len().max(1) as f64
}

/// Easting, northing and height of a grid such as UTM; without a height the easting once more.
pub(super) fn grid_of(table: &Preview, found: &Found) -> Option<[usize; 3]> {
    let [east, north] = [found.grid[0]?, found.grid[1]?];
    let far = |place: usize| {
        let row = table.rows.iter().find_map(|row| row.get(place));
        row.is_some_and(|number| number.abs() > GRID)
    };
    (far(east) || far(north) || found.zone[0].is_some()).then_some([
        east,
        north,
        found.place[2].unwrap_or(east),
    ])
}

pub(super) struct Columns {
    pub(super) table: Preview,
    /// Of the columns, by their names.
    meanings: Vec<Option<(Meaning, Option<String>)>>,
    pub(super) found: Found,
}

/// Whether a place has no height: it is then latitude, longitude, latitude.
pub(super) fn is_flat(place: [usize; 3]) -> bool {
    place[0] == place[2]
}

impl Columns {
    /// A column as a drive file names it: by its name where that is its alone, else by its number.
    pub(super) fn name(&self, place: usize) -> Value {
        let name = self.table.names.get(place).filter(|name| {
            !name.is_empty() && self.table.names.iter().filter(|n| n == name).count() == 1
        });
        name.map_or(Value::Integer(place as i64 + 1), |name| {
            name.as_str().into()
        })
    }

    /// The columns of the position: as angles, else Earth-fixed.
    fn place_of(&self) -> Option<[usize; 3]> {
        let flat = || match self.found.place {
            [Some(lat), Some(lon), None] => Some([lat, lon, lat]),
            _ => None,
        };
        let place = all(&self.found.place).or_else(|| all(&self.found.ecef));
        place
            .or_else(flat)
            .or_else(|| grid_of(&self.table, &self.found))
    }

    pub(super) fn three(&self, key: &'static str, places: [usize; 3]) -> Line {
        let known = match self.found.known {
            Known::Name { .. } => NAMES,
            _ => Known::Numbers { several: true },
        };
        Line::new(key, Vec::from(places.map(|place| self.name(place))), known)
    }

    /// The unit that the name of a column states.
    pub(super) fn unit(&self, place: usize) -> Option<String> {
        self.meanings.get(place)?.as_ref()?.1.clone()
    }

    pub(super) fn stamps(&self, place: usize) -> Vec<f64> {
        let value = |row: &Vec<f64>| row.get(place).copied().filter(|x| x.is_finite());
        self.table.rows.iter().filter_map(value).collect()
    }

    /// The times of the rows in which a part has values.
    pub(super) fn stamps_beside(&self, time: usize, part: &[usize]) -> Vec<f64> {
        let value =
            |row: &Vec<f64>, place: usize| row.get(place).copied().filter(|x| x.is_finite());
        let rows = self.table.rows.iter();
        let rows = rows.filter(|row| part.iter().all(|place| value(row, *place).is_some()));
        let beside = Vec::from_iter(rows.filter_map(|row| value(row, time)));
        if beside.is_empty() {
            self.stamps(time)
        } else {
            beside
        }
    }

    /// The column that is the time by its name: of several the first that has one where the columns of the part have values.
    fn time_beside(&self, part: &[usize]) -> Option<usize> {
        let has = |row: &&Vec<f64>, place: &usize| row.get(*place).is_some_and(|x| x.is_finite());
        let rows = self.table.rows.iter();
        let rows = rows.filter(|row| part.iter().all(|place| has(row, place)));
        let beside = |place: &&usize| {
            let there = rows.clone().filter(|row| has(row, place)).count();
            2 * there > rows.clone().count()
        };
        let mut times = self
            .found
            .times
            .iter()
            .filter(|_| self.found.times.len() > 1);
        times.find(beside).copied().or(self.found.time)
    }

    /// The lines of the time of a part with these columns, and the ordinary interval \[s\].
    pub(super) fn time(&self, longest: f64, part: &[usize]) -> (Vec<Line>, Option<f64>) {
        let by_numbers = || {
            Some((
                time_by_numbers(&self.table)?,
                Known::Numbers { several: false },
            ))
        };
        let named = self
            .time_beside(part)
            .map(|place| (place, self.found.known.clone()));
        let Some((place, known)) = named.or_else(by_numbers) else {
            return (Vec::new(), None);
        };
        let stamps = self.stamps_beside(place, part);
        let name = self.table.names.get(place).map_or("", String::as_str);
        if self.unit(place).is_none() && is_of_unknown_ticks(name, &stamps, longest) {
            return (Vec::new(), None);
        }
        let mut lines = vec![Line::new("time", self.name(place), known)];
        if let Some(date) = self.date_of(place) {
            lines.push(Line::new("date", self.name(date), self.found.known.clone()));
        }
        let guess = time_unit_of(name, &stamps, longest);
        let (unit, known) = match (self.unit(place), guess) {
            (Some(unit), _) => (unit, Known::Name { several: false }),
            (None, Some((unit, _))) => (unit.to_owned(), Known::StampStep),
            (None, None) => ("s".to_owned(), Known::Guessed),
        };
        let factor = undrift_nav::units::unit_factor(&unit, undrift_nav::units::Quantity::Time)
            .unwrap_or(1.0);
        if unit != "s" {
            lines.push(Line::new("time_unit", unit, known));
        }
        let step = ordinary_step(&stamps).map(|step| step * factor);
        (lines, step)
    }

    /// The lines of a heading by two antennas.
    fn heading(&self, antennas: usize) -> Vec<Line> {
        let by_name = || Known::Name { several: false };
        let (mut lines, _) = self.time(FIX_STEP, &[antennas]);
        lines.push(Line::new("heading", self.name(antennas), by_name()));
        let unit = self.unit(antennas).filter(|unit| unit != "deg");
        lines.extend(unit.map(|unit| Line::new("heading_unit", unit, by_name())));
        lines
    }

    /// A magnetometer, where its columns have the strength of a field in some unit, or their names state one, and there are times.
    fn field(&self, places: [usize; 3]) -> Option<Part> {
        let (mut lines, _) = self.time(IMU_STEP, &places);
        let by_size = || units::field(&three_of(&self.table.rows, places));
        let (unit, known) = match self.unit(places[0]) {
            Some(unit) => (unit, NAMES),
            None => by_size().map(|(unit, strength)| (unit.to_owned(), Known::Field(strength)))?,
        };
        lines.first()?;
        lines.push(self.three("field", places));
        lines.push(Line::new("field_unit", unit, known));
        Some(Part::new("magnetometer", lines))
    }

    /// The lines of an IMU: columns, units by their names, or by gravity where that contradicts.
    fn imu(&self, gyro: [usize; 3], accel: [usize; 3], notes: &mut Vec<Note>) -> Vec<Line> {
        let [rates, forces] = [gyro, accel].map(|places| three_of(&self.table.rows, places));
        let exchanged = are_exchanged(&rates, &forces);
        let (gyro, accel) = match exchanged {
            true => (accel, gyro),
            false => (gyro, accel),
        };
        let named = |places: [usize; 3]| self.unit(places[0]).filter(|_| !exchanged);
        let (mut lines, interval) = self.time(IMU_STEP, &gyro);
        if lines.is_empty() {
            lines.push(Line::new("rate", "100 Hz", Known::NoTimes));
        }
        let (turns, forces) = match exchanged {
            true => (forces, rates),
            false => (rates, forces),
        };
        let force = units::force(&forces, interval);
        let ((gyro_unit, gyro_why), (accel_unit, accel_why), increments) = match &force {
            Force::Increments((unit, why)) if named(accel).is_none() => {
                let interval = interval.unwrap_or(1.0);
                let rates: Vec<[f64; 3]> = turns.iter().map(|t| t.map(|x| x / interval)).collect();
                let (rate, gyro_why) = units::rate(&rates);
                let angle = if rate == "deg/s" { "deg" } else { "rad" };
                (
                    (angle.to_owned(), gyro_why),
                    ((*unit).to_owned(), why.clone()),
                    true,
                )
            }
            _ => {
                let counts = units::counts(&forces);
                let gyro = match named(gyro) {
                    Some(unit) => (unit, NAMES),
                    None if counts.is_some() && !matches!(force, Force::Rates(_)) => {
                        (units::COUNTS_OF_RATE[0].to_owned(), Known::Counts)
                    }
                    None => {
                        let (unit, why) = units::rate(&turns);
                        (unit.to_owned(), why)
                    }
                };
                let accel = match (named(accel), &force) {
                    (Some(unit), Force::Rates((size, Known::Gravity(median)))) if unit != *size => {
                        notes.push(Note::UnitBySize {
                            named: unit.clone(),
                            size,
                            median: *median,
                        });
                        ((*size).to_owned(), Known::Gravity(*median))
                    }
                    (Some(unit), _) => (unit, NAMES),
                    (None, Force::Rates((unit, why))) => ((*unit).to_owned(), why.clone()),
                    (None, Force::Unknown(why) | Force::Increments((_, why))) => match counts {
                        Some((unit, why)) => (unit.to_owned(), why),
                        None => ("m/s^2".to_owned(), why.clone()),
                    },
                };
                (gyro, accel, false)
            }
        };
        if increments {
            lines.push(Line::new("data", "increments", Known::Increments));
        }
        let blanks = apart(&self.table.rows, gyro, accel);
        if let (Some(time), false) = (self.found.time, blanks) {
            let share = shared_stamps(&self.table.rows, time, gyro, accel);
            if share > 0.5 {
                let known = Known::SharedStamps { share };
                lines.push(Line::new("shared_stamps", "spread", known));
            }
        }
        let columns = |key, places| {
            let mut line = self.three(key, places);
            if exchanged {
                line.known = Known::Exchanged;
            }
            line
        };
        lines.push(columns("gyro", gyro));
        lines.push(Line::new("gyro_unit", gyro_unit, gyro_why));
        lines.push(columns("accel", accel));
        lines.push(Line::new("accel_unit", accel_unit, accel_why));
        if blanks {
            lines.push(Line::new("blanks", "interpolate", Known::Apart));
        }
        lines
    }

    fn truth(&self, place: [usize; 3], attitude: [usize; 3]) -> Vec<Line> {
        let (mut lines, _) = self.time(FIX_STEP, &place);
        lines.extend(self.place(place));
        lines.extend(self.velocity());
        lines.push(self.three("attitude", attitude));
        match self.unit(attitude[0]) {
            Some(unit) if unit == "deg" => {}
            Some(unit) => lines.push(Line::new("attitude_unit", unit, NAMES)),
            None => {
                let angles = three_of(&self.table.rows, attitude);
                let turn = 2.0 * std::f64::consts::PI;
                if angles.iter().flatten().all(|angle| angle.abs() <= turn) {
                    lines.push(Line::new("attitude_unit", "rad", Known::SmallAngles));
                }
            }
        }
        lines
    }
}

#[cfg(test)]
mod tests;
