//! Which columns of a table are a receiver's position, velocity and accuracy, and in which units.

use super::{
    LEVEL_VELOCITY_STD, POSITION_STD, VELOCITY_STD,
    columns::{Columns, NAMES, all, is_flat},
    numbers::three_of,
};
use crate::columns::{FIX_STEP, SEMICIRCLES, ordinary_step};
use crate::drive::{DEGREES_MINUTES, UTM};
use undrift_base::order_statistics::upper_median;
use undrift_io::angle::{are_degrees_minutes, of_degrees_minutes};
use undrift_nav::{
    Vector3,
    earth::Geodetic,
    units::{Quantity, unit_factor},
};
use undrift_results::inspect::{Known, Line};

/// Integers of 1e-7 and 1e-6 degrees.
const INTEGERS: &str = "LSB/1e7 deg";
const MILLIONTHS: &str = "LSB/1e6 deg";
/// Speeds in m/s, km/h and knots beside positions that were taken to be ten times finer than they are, over those of the positions.
const TENFOLD: [f64; 3] = [10.0, 36.0, 19.44];
/// Whole numbers from here on, as standard deviations of fixes, are mm or mm/s.
const LARGE_STD: f64 = 50.0;
/// Standard deviations of positions without a height, which is taken as that of the ellipsoid and does not follow the
/// ground.
const FLAT_STD: &str = "3, 3, 50 m";

/// Northings of the band S, 32° to 40° north \[m\]: as southern ones they are at the end of South America.
const BAND_S: std::ops::Range<f64> = 3.54e6..4.43e6;

/// Whole heights beyond this are of millimetres \[m\].
const HIGHEST: f64 = 20_000.0;

/// Time over which speeds are compared with the positions \[s\].
const STRETCH: f64 = 4.0;

/// Most that a speed in the right unit differs from that of the positions.
const ALIKE: std::ops::Range<f64> = 0.7..1.4;

impl Columns {
    /// The lines of a place: columns and their units.
    pub(super) fn place(&self, place: [usize; 3]) -> Vec<Line> {
        let flat = is_flat(place);
        let grid = self.is_grid();
        if all(&self.found.place).is_none() && !flat && !grid {
            return vec![self.three("ecef", place)];
        }
        let mut lines = vec![self.three("position", place)];
        if flat {
            let columns = [place[0], place[1]].map(|place| self.name(place));
            lines[0].value = Vec::from(columns).into();
            lines.push(Line::new("height", "0 m", Known::NoHeights));
        }
        if grid {
            lines.push(self.grid_unit(place));
            return lines;
        }
        let angles = three_of(&self.table.rows, place);
        let small = angles.iter().all(|[lat, lon, _]| {
            lat.abs() <= std::f64::consts::FRAC_PI_2 && lon.abs() <= std::f64::consts::PI
        });
        match self.unit(place[0]) {
            Some(unit) if unit == "deg" => {}
            Some(unit) => lines.push(Line::new("position_unit", unit, NAMES)),
            None if self.are_degrees_minutes(place) => {
                let known = Known::Numbers { several: true };
                lines.push(Line::new("position_unit", DEGREES_MINUTES, known));
            }
            None if self.are_semicircles(place) => {
                lines.push(Line::new("position_unit", SEMICIRCLES, NAMES));
            }
            None if self.are_integers(place) => {
                lines.push(match self.integer_unit(place) {
                    INTEGERS => Line::new("position_unit", INTEGERS, Known::Integers),
                    unit => Line::new("position_unit", unit, Known::Numbers { several: true }),
                });
            }
            None if small && !angles.is_empty() => {
                lines.push(Line::new("position_unit", "rad", Known::SmallPlaces));
            }
            None => {}
        }
        lines
    }

    /// Whether the place is an easting and northing: no latitude, longitude or Earth-fixed column was found.
    fn is_grid(&self) -> bool {
        self.found.place[0].is_none() && self.found.ecef[0].is_none()
    }

    /// The zone of eastings and northings, by its columns.
    fn grid_unit(&self, place: [usize; 3]) -> Line {
        let [zone, band] = self.found.zone;
        let text = |place: Option<usize>| -> &str {
            let text = place.and_then(|place| self.table.texts.get(place));
            text.map_or("", |text| text.trim())
        };
        let zone = text(zone);
        let number = zone.trim_end_matches(|c: char| !c.is_ascii_digit());
        let behind = zone.get(number.len()..).unwrap_or_default().trim();
        let row = self.table.rows.first();
        let northing = row.and_then(|row| row.get(place[1])).copied();
        let is_band = !text(band).is_empty() || northing.is_some_and(|n| BAND_S.contains(&n));
        let letter = format!("{behind}{}", text(band)).to_ascii_uppercase();
        let hemisphere = match letter.as_str() {
            "S" | "SOUTH" if !is_band => "S",
            "NORTH" | "SOUTH" => &letter[..1],
            "C" | "D" | "E" | "F" | "G" | "H" | "J" | "K" | "L" | "M" => "S",
            band if band.len() == 1 && ("N".."Y").contains(&band) => "N",
            _ => "",
        };
        match number.parse::<u8>() {
            Ok(number) if !hemisphere.is_empty() => {
                let unit = format!("{UTM} {number}{hemisphere}");
                Line::new("position_unit", unit, NAMES)
            }
            _ => Line::new("position_unit", UTM, Known::NotInLog),
        }
    }

    /// The unit of the heights: receivers that count 1e-7 degrees count millimetres.
    fn height_unit(&self, place: [usize; 3]) -> Option<Line> {
        match self.unit(place[2]) {
            Some(unit) if unit == "m" => None,
            Some(unit) => Some(Line::new("height_unit", unit, NAMES)),
            None => (self.are_integers(place) && self.are_millimetres(place[2]))
                .then(|| Line::new("height_unit", "mm", Known::Integers)),
        }
    }

    /// Whether whole heights are of millimetres: those of metres seldom differ by more than one from row to row.
    fn are_millimetres(&self, height: usize) -> bool {
        let heights = self.stamps(height);
        let steps = heights.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let steps = Vec::from_iter(steps.filter(|step| *step > 0.0));
        let large = steps.iter().filter(|step| **step > 1.0).count();
        let high = heights.iter().any(|height| height.abs() > HIGHEST);
        heights.iter().all(|height| height.fract() == 0.0) && (high || 2 * large >= steps.len())
    }

    /// The unit of latitudes and longitudes that are integers: by their size, else by the speeds beside them.
    fn integer_unit(&self, place: [usize; 3]) -> &'static str {
        let places = three_of(&self.table.rows, place);
        let certain = places
            .iter()
            .any(|[lat, lon, _]| lat.abs() > 90e6 || lon.abs() > 180e6);
        let speeds = match (self.found.polar[0], all(&self.found.velocity)) {
            (Some(speed), _) => vec![speed],
            (None, Some(velocity)) => vec![velocity[0], velocity[1]],
            (None, None) => return INTEGERS,
        };
        let unit = self.unit(speeds[0]);
        let factor = unit.and_then(|unit| unit_factor(&unit, Quantity::Velocity).ok());
        let fine = unit_factor(INTEGERS, Quantity::Angle).unwrap_or_default();
        let ratio = self.speed_by_positions(place, &speeds, fine);
        let is_tenfold = |ratio: f64| match factor {
            Some(factor) => ALIKE.contains(&(ratio * factor / TENFOLD[0])),
            None => TENFOLD.iter().any(|of| ALIKE.contains(&(ratio / of))),
        };
        match !certain && ratio.is_some_and(is_tenfold) {
            true => MILLIONTHS,
            false => INTEGERS,
        }
    }

    /// Whether latitudes and longitudes are semicircles, by the names that they have in Garmin's FIT.
    fn are_semicircles(&self, place: [usize; 3]) -> bool {
        let is_name = self
            .table
            .names
            .get(place[0])
            .is_some_and(|name| name == "position_lat");
        is_name && self.stamps(place[0]).iter().any(|lat| lat.abs() > 360.0)
    }

    /// Whether latitudes and longitudes are integers of parts of a degree.
    fn are_integers(&self, place: [usize; 3]) -> bool {
        let places = three_of(&self.table.rows, place);
        let angles = places.iter().flat_map(|place| place.iter().take(2));
        let whole = angles.clone().all(|number| number.fract() == 0.0);
        let beyond = places
            .iter()
            .any(|[lat, lon, _]| lat.abs() > 360.0 || lon.abs() > 360.0);
        let within = places
            .iter()
            .all(|[lat, lon, _]| lat.abs() <= 90e7 && lon.abs() <= 180e7);
        whole && beyond && within && !self.are_semicircles(place)
    }

    /// Whether latitudes and longitudes are degrees times 100 and minutes.
    fn are_degrees_minutes(&self, place: [usize; 3]) -> bool {
        let places = three_of(&self.table.rows, place);
        !places.is_empty()
            && places
                .iter()
                .all(|[lat, lon, _]| are_degrees_minutes(*lat, *lon))
    }

    /// Whether velocities beside places that are counted are integers too: mm/s.
    fn are_thousandths(&self, place: [usize; 3], velocity: [usize; 3]) -> bool {
        let velocities = three_of(&self.table.rows, velocity);
        let mut numbers = velocities.iter().flatten();
        self.are_integers(place)
            && !velocities.is_empty()
            && numbers.all(|number| number.fract() == 0.0)
    }

    /// The lines of a velocity along axes.
    pub(super) fn velocity(&self) -> Vec<Line> {
        let Some(velocity) = all(&self.found.velocity) else {
            let Some(velocity) = all(&self.found.ecef_velocity) else {
                return Vec::new();
            };
            let axes = Line::new("velocity_axes", "ecef", NAMES);
            return vec![self.three("velocity", velocity), axes];
        };
        let mut lines = vec![self.three("velocity", velocity)];
        if self.found.up {
            let known = lines[0].known.clone();
            lines.push(Line::new("velocity_axes", "north,east,up", known));
        }
        lines
    }

    pub(super) fn gnss(&self, place: [usize; 3]) -> Vec<Line> {
        let (mut lines, _) = self.time(FIX_STEP, &place);
        lines.extend(self.place(place));
        if all(&self.found.place).is_some() {
            lines.extend(self.height_unit(place));
        }
        let [across, up, fast] = self.found.accuracy;
        // Accuracies across and up are along no axis of the Earth.
        let is_level = all(&self.found.place).is_some() || self.is_grid();
        let accuracy = across.filter(|_| is_level);
        let accuracy = accuracy.map(|across| [across, across, up.unwrap_or(across)]);
        let std = all(&self.found.position_std).or(accuracy);
        lines.extend(match std {
            _ if is_flat(place) => vec![Line::new("position_std", FLAT_STD, Known::NoHeights)],
            Some(std) => self.stds(
                "position_std",
                std,
                Quantity::Length,
                self.are_integers(place),
            ),
            None => vec![Line::new("position_std", POSITION_STD, Known::NoColumns)],
        });
        let velocity = self.velocity();
        let mut is_level = velocity.is_empty();
        let (velocity, unit) = match self.found.polar {
            // Their unit takes a look at the numbers.
            [Some(speed), Some(course)] if is_level && !self.table.rows.is_empty() => {
                let unit = self.speed_unit(place, speed);
                let vertical = self.vertical(speed, unit.as_ref());
                let polar = [("speed", speed), ("course", course)].into_iter();
                let named = polar.chain(vertical.map(|place| ("vertical_velocity", place)));
                let line =
                    |(key, place)| Line::new(key, self.name(place), self.found.known.clone());
                let mut lines = Vec::from_iter(named.map(line));
                if vertical.is_some() && self.found.up {
                    lines.push(Line::new("velocity_axes", "north,east,up", NAMES));
                }
                is_level = vertical.is_none();
                (lines, unit)
            }
            _ => {
                let unit = self.found.velocity[0].and_then(|place| self.unit(place));
                let counts = all(&self.found.velocity)
                    .filter(|velocity| unit.is_none() && self.are_thousandths(place, *velocity));
                let unit = match (unit, counts) {
                    (None, Some(_)) => Some(Line::new("velocity_unit", "mm/s", Known::Integers)),
                    (unit, _) => unit
                        .filter(|unit| unit != "m/s")
                        .map(|unit| Line::new("velocity_unit", unit, NAMES)),
                };
                (velocity, unit)
            }
        };
        if velocity.is_empty() {
            return lines;
        }
        lines.extend(velocity);
        lines.extend(unit);
        let std = all(&self.found.velocity_std).or(fast.map(|fast| [fast; 3]));
        lines.extend(match std.filter(|_| !is_level) {
            Some(std) => self.stds(
                "velocity_std",
                std,
                Quantity::Velocity,
                self.are_integers(place),
            ),
            None => {
                let level = if is_level {
                    LEVEL_VELOCITY_STD
                } else {
                    VELOCITY_STD
                };
                vec![Line::new("velocity_std", level, Known::NoColumns)]
            }
        });
        lines
    }

    /// The lines of standard deviations in columns; those of a receiver that counts are in thousandths.
    fn stds(&self, key: &'static str, std: [usize; 3], of: Quantity, counts: bool) -> Vec<Line> {
        let (columns, factor) = match key {
            "position_std" => ("position_std_columns", "position_std_factor"),
            _ => ("velocity_std_columns", "velocity_std_factor"),
        };
        let mut lines = vec![self.three(columns, std)];
        let named = self
            .unit(std[0])
            .and_then(|unit| unit_factor(&unit, of).ok());
        let whole = three_of(&self.table.rows, std)
            .iter()
            .flatten()
            .all(|number| number.fract() == 0.0);
        // Of metres they would say that there is no fix.
        let mut sizes: Vec<f64> = three_of(&self.table.rows, std)
            .iter()
            .map(|std| std[0])
            .collect();
        let large = !sizes.is_empty() && upper_median(&mut sizes) >= LARGE_STD;
        match named {
            Some(1.0) => {}
            Some(scale) if scale.fract() == 0.0 => {
                lines.push(Line::new(factor, scale as i64, NAMES));
            }
            Some(scale) => lines.push(Line::new(factor, scale, NAMES)),
            None if counts && whole => lines.push(Line::new(factor, 0.001, Known::Integers)),
            None if large && whole => lines.push(Line::new(factor, 0.001, Known::Thousandths)),
            None => {}
        }
        lines
    }

    /// The column of dates of these times: where others are named behind the same word, `gps_Date` and `gps_Time`, it is theirs.
    pub(super) fn date_of(&self, time: usize) -> Option<usize> {
        let source = |place: &usize| {
            let name = self.table.names.get(*place)?;
            name.rsplit_once([':', '_', '.', '/'])
                .map(|(source, _)| source)
        };
        let date = self.found.date?;
        let mut times = self.found.times.iter();
        let is_of_another = times.any(|other| source(other) == source(&date));
        (source(&time) == source(&date) || !is_of_another).then_some(date)
    }

    /// The column of a vertical velocity beside a speed, where its unit is that of the speed.
    fn vertical(&self, speed: usize, found: Option<&Line>) -> Option<usize> {
        let place = self.found.velocity[2]?;
        let metric = || found.is_none().then(|| "m/s".to_owned());
        let unit = self.unit(speed).or_else(metric);
        (self.unit(place).is_none() || self.unit(place) == unit).then_some(place)
    }

    /// The unit of a speed: by its name, else that in which it fits the positions.
    fn speed_unit(&self, place: [usize; 3], speed: usize) -> Option<Line> {
        let line =
            |unit: &str, known| (unit != "m/s").then(|| Line::new("velocity_unit", unit, known));
        if let Some(unit) = self.unit(speed) {
            return line(&unit, NAMES);
        }
        let by_positions = self.speed_by_positions(place, &[speed], self.degrees(place)?)?;
        let away = |unit: &&'static str| {
            let factor = unit_factor(unit, Quantity::Velocity).unwrap_or(f64::NAN);
            (factor * by_positions).ln().abs()
        };
        let units = ["m/s", "km/h", "kn", "mph", "cm/s", "mm/s"];
        let unit = units
            .into_iter()
            .min_by(|a, b| away(a).total_cmp(&away(b)))?;
        if !ALIKE.contains(&away(&unit).exp()) {
            return None;
        }
        line(unit, Known::Numbers { several: false })
    }

    /// The factor from latitudes and longitudes to radians.
    fn degrees(&self, place: [usize; 3]) -> Option<f64> {
        let unit = match self.unit(place[0]) {
            None if self.are_integers(place) => self.integer_unit(place).to_owned(),
            None if self.are_semicircles(place) => SEMICIRCLES.to_owned(),
            unit => unit.unwrap_or("deg".to_owned()),
        };
        unit_factor(&unit, Quantity::Angle).ok()
    }

    /// How many times as large the speeds, of one column or along two axes, are as those that the positions show \[m/s\], where these
    /// are angles by so much.
    fn speed_by_positions(&self, place: [usize; 3], speeds: &[usize], degrees: f64) -> Option<f64> {
        let (lines, step) = self.time(FIX_STEP, &place);
        let time = lines.first().and(self.found.time)?;
        let scale = step? / ordinary_step(&self.stamps_beside(time, &place))?;
        let packed = self.unit(place[0]).is_none() && self.are_degrees_minutes(place);
        let grid = self.is_grid();
        let fix = |row: &Vec<f64>| {
            let at = |k: usize| row.get(k).copied().filter(|number| number.is_finite());
            let squares = speeds.iter().map(|k| Some(at(*k)?.powi(2)));
            let speed = squares.sum::<Option<f64>>()?.sqrt();
            if grid {
                let flat = Vector3::new(at(place[0])?, at(place[1])?, 0.0);
                return Some((at(time)? * scale, flat, speed));
            }
            let [lat, lon] = [at(place[0])?, at(place[1])?].map(|angle| match packed {
                true => of_degrees_minutes(angle) * degrees,
                false => angle * degrees,
            });
            let height = 0.0;
            Some((
                at(time)? * scale,
                Geodetic { lat, lon, height }.to_ecef(),
                speed,
            ))
        };
        let fixes: Vec<_> = self.table.rows.iter().filter_map(fix).collect();
        // Over so many fixes, as far as the rounding of the positions is far below it.
        let ratio = |pair: &[(f64, Vector3, f64)]| {
            let (first, last) = (pair.first()?, pair.last()?);
            let moved = (last.1 - first.1).norm();
            let mean = pair.iter().map(|fix| fix.2).sum::<f64>() / pair.len() as f64;
            (moved > 2.0 && last.0 > first.0).then(|| moved / (last.0 - first.0) / mean)
        };
        let span = fixes.last()?.0 - fixes.first()?.0;
        let width = (STRETCH * (fixes.len() - 1) as f64 / span) as usize + 1;
        let windows = fixes.windows(width.max(5));
        let mut ratios: Vec<f64> = windows.filter_map(ratio).collect();
        ratios.retain(|ratio| ratio.is_finite());
        (ratios.len() >= 10).then(|| 1.0 / upper_median(&mut ratios))
    }
}
