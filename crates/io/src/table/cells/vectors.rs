//! Cells with several numbers in them: `[0.1, 0.2, 9.8]`, `"30.44, 114.47"`, `POINT (114.47 30.44)`.

use super::Beginning;
use crate::number;

/// Numbers that a cell has at most.
const MOST: usize = 9;
/// Largest latitude \[deg\].
const POLE: f64 = 90.0;

/// The columns of such cells.
#[derive(Clone, Debug, Default)]
pub(super) struct Vectors(Vec<Vector>);

#[derive(Clone, Debug)]
struct Vector {
    place: usize,
    /// What the names of its numbers end with; one for each.
    endings: Vec<String>,
    /// The numbers are longitude and latitude.
    is_place: bool,
}

impl Vectors {
    pub(super) fn detect(table: &Beginning) -> Self {
        let of_column = |place: usize| {
            let mut all = table.column(place).filter(|cell| !cell.is_empty());
            let (first, of_point) = numbers_of(all.next()?)?;
            let count = first.len();
            let alike = all.all(|cell| numbers_of(cell).is_some_and(|(n, _)| n.len() == count));
            let endings: Vec<String> = match (count, of_point) {
                (2 | 3, true) => vec!["longitude".into(), "latitude".into(), "height".into()],
                (2, false) => {
                    let longitude_first = first.first().is_some_and(|x| x.abs() > POLE);
                    let mut both = vec!["latitude".into(), "longitude".into()];
                    if longitude_first {
                        both.reverse();
                    }
                    both
                }
                (3, false) => ["x", "y", "z"].map(str::to_owned).into(),
                _ => (1..=count).map(|number| number.to_string()).collect(),
            };
            let is_place = count == 2 || of_point;
            alike.then_some(Vector {
                place,
                endings: endings.into_iter().take(count).collect(),
                is_place,
            })
        };
        let width = table.rows.first().map_or(0, Vec::len);
        Self((0..width).filter_map(of_column).collect())
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Names of the columns behind the last.
    pub(super) fn names(&self, names: &[String]) -> Vec<String> {
        let of_vector = |vector: &Vector| {
            let name = names.get(vector.place).cloned().unwrap_or_default();
            // The unit stays behind the name.
            let (stem, unit) = match name.find(['[', '(']) {
                Some(at) => (name[..at].trim_end().to_owned(), name[at..].to_owned()),
                None => (name, String::new()),
            };
            let place = vector.is_place;
            let named = move |ending: &String| match place {
                true => ending.clone(),
                false if unit.is_empty() => format!("{stem}_{ending}"),
                false => format!("{stem}_{ending} {unit}"),
            };
            Vec::from_iter(vector.endings.iter().map(named))
        };
        self.0.iter().flat_map(of_vector).collect()
    }

    /// The numbers of a row, each as a cell.
    pub(super) fn numbers(&self, cells: &[Vec<u8>]) -> Vec<Vec<u8>> {
        let of_vector = |vector: &Vector| {
            let cell = cells.get(vector.place).map_or(&[][..], Vec::as_slice);
            let texts = Vec::from_iter(texts(inside(cell).0).map(<[u8]>::to_vec));
            let count = vector.endings.len();
            match texts.len() == count {
                true => texts,
                false => vec![Vec::new(); count],
            }
        };
        self.0.iter().flat_map(of_vector).collect()
    }
}

/// The numbers of a cell with several, and whether they are those of a point, longitude first; `None` of any other.
pub(super) fn numbers_of(cell: &[u8]) -> Option<(Vec<f64>, bool)> {
    let (inside, in_brackets, of_point) = {
        let (text, brackets) = inside(cell);
        (text, brackets, cell.starts_with(b"POINT"))
    };
    // One decimal comma makes no two numbers.
    let between = inside.windows(2).any(|pair| {
        matches!(pair, [b',' | b';', b' '])
            || pair[0] == b' ' && (pair[1].is_ascii_digit() || pair[1] == b'-')
    });
    let count = |of: u8| inside.iter().filter(|byte| **byte == of).count();
    // Numbers with points have no decimal commas; one point alone may follow thousands.
    let points = count(b',') == 1 && count(b'.') == 2;
    if !(in_brackets || between || points || count(b',') > 1 || count(b';') > 0) {
        return None;
    }
    let numbers: Option<Vec<f64>> = texts(inside).map(number::parse_finite).collect();
    let numbers = numbers.filter(|numbers| (2..=MOST).contains(&numbers.len()))?;
    Some((numbers, of_point))
}

/// What is between the brackets of a cell, and whether there are any.
fn inside(cell: &[u8]) -> (&[u8], bool) {
    let cell = cell.strip_prefix(b"POINT").unwrap_or(cell).trim_ascii();
    let cell = cell.strip_prefix(b"Z").unwrap_or(cell).trim_ascii();
    match cell {
        [b'[', inside @ .., b']'] | [b'(', inside @ .., b')'] => (inside.trim_ascii(), true),
        _ => (cell, false),
    }
}

fn texts(inside: &[u8]) -> impl Iterator<Item = &[u8]> {
    inside
        .split(|byte| matches!(byte, b',' | b';' | b' ' | b'\t'))
        .filter(|text| !text.is_empty())
}
