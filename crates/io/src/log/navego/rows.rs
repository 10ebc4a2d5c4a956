//! The rows of a structure's vectors as entries.

use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position, TruthSample};

use super::mat::{Numbers, Variable};
use crate::entry::{Entry, Fix, ImuReading, StreamKind, What};
use crate::fix::{independent, is_a_fix, shown};
use crate::skipped::SkipKind;

impl Numbers {
    /// How many vectors there are: the longer side.
    pub(super) fn len(&self) -> usize {
        self.rows.max(self.columns)
    }

    /// Three components of one of `count` vectors, whether they are rows or columns.
    pub(super) fn three(&self, index: usize, count: usize) -> [f64; 3] {
        self.some(index, count)
    }

    fn some<const N: usize>(&self, index: usize, count: usize) -> [f64; N] {
        let as_rows = self.rows == count && self.columns == N;
        std::array::from_fn(|i| match as_rows {
            true => self.at(index, i),
            false => self.at(i, index),
        })
    }

    /// A component of a vector along either side.
    fn one(&self, index: usize) -> f64 {
        if self.columns == 1 {
            self.at(index, 0)
        } else {
            self.at(0, index)
        }
    }

    /// Whether it is `count` vectors of this width.
    fn is(&self, count: usize, width: usize) -> bool {
        let sides = (self.rows, self.columns);
        sides == (count, width) || sides == (width, count)
    }
}

/// A structure row by row.
pub(super) struct Rows {
    count: usize,
    next: usize,
    time: Numbers,
    kind: Kind,
}

enum Kind {
    Imu {
        force: Numbers,
        rate: Numbers,
    },
    Fixes {
        place: [Numbers; 3],
        velocity: Option<Numbers>,
        std: Option<Numbers>,
        velocity_std: Option<Numbers>,
    },
    Poses {
        place: [Numbers; 3],
        velocity: Option<Numbers>,
        attitude: Attitude,
    },
}

enum Attitude {
    Angles([Numbers; 3]),
    Matrices(Numbers),
}

impl Rows {
    /// `Err` says which field is not what it has to be.
    pub(super) fn new(mut variable: Variable, kind: StreamKind) -> Result<Self, String> {
        let time = variable.take("t").ok_or("no field t")?;
        let count = time.len();
        if !time.is(count, 1) {
            return Err(format!("t is {}×{}", time.rows, time.columns));
        }
        let mut field = |name: &str, width: usize| match variable.take(name) {
            Some(numbers) if numbers.is(count, width) => Ok(Some(numbers)),
            // An empty one is absent.
            Some(numbers) if numbers.len() > 0 => {
                let (rows, columns) = (numbers.rows, numbers.columns);
                Err(format!("{name} is {rows}×{columns}, t has {count} values"))
            }
            _ => Ok(None),
        };
        let needed = |name: &str, found: Option<Numbers>| found.ok_or(format!("no field {name}"));
        let kind = if kind == StreamKind::Imu {
            Kind::Imu {
                force: needed("fb", field("fb", 3)?)?,
                rate: needed("wb", field("wb", 3)?)?,
            }
        } else {
            let place = [
                needed("lat", field("lat", 1)?)?,
                needed("lon", field("lon", 1)?)?,
                needed("h", field("h", 1)?)?,
            ];
            let velocity = field("vel", 3)?;
            if kind == StreamKind::Poses {
                let angles = [field("roll", 1)?, field("pitch", 1)?, field("yaw", 1)?];
                let attitude = match angles {
                    [Some(roll), Some(pitch), Some(yaw)] => Attitude::Angles([roll, pitch, yaw]),
                    _ => Attitude::Matrices(needed("DCMnb_m", field("DCMnb_m", 9)?)?),
                };
                Kind::Poses {
                    place,
                    velocity,
                    attitude,
                }
            } else {
                let mut std = |name: &str| match variable.take(name) {
                    Some(std) if std.is(1, 3) || std.is(count, 3) => Ok(Some(std)),
                    Some(std) if std.len() > 0 => {
                        Err(format!("{name} is {}×{}", std.rows, std.columns))
                    }
                    _ => Ok(None),
                };
                Kind::Fixes {
                    place,
                    velocity,
                    std: std("stdm")?,
                    velocity_std: std("stdv")?,
                }
            }
        };
        Ok(Self {
            count,
            next: 0,
            time,
            kind,
        })
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    fn row(&self, index: usize) -> What {
        let time = self.time.one(index);
        if !time.is_finite() {
            return What::Skipped(SkipKind::NotFinite, format!("t = {time}"));
        }
        let vector = |numbers: &Numbers| Vector3::from(numbers.three(index, self.count));
        let finite = |v: &Vector3| v.iter().all(|value| value.is_finite());
        match &self.kind {
            Kind::Imu { force, rate } => {
                let (gyro, accel) = (vector(rate), vector(force));
                if !(finite(&gyro) && finite(&accel)) {
                    let detail = format!("wb {:?}, fb {:?}", gyro.as_slice(), accel.as_slice());
                    return What::Skipped(SkipKind::NotFinite, detail);
                }
                What::Imu(ImuReading { time, gyro, accel })
            }
            Kind::Fixes {
                place,
                velocity,
                std,
                velocity_std,
            } => {
                let place = match place_of(place, index) {
                    Ok(place) => place,
                    Err(detail) => return What::Skipped(SkipKind::OutOfRange, detail),
                };
                let covariance = |std: &Option<Numbers>| {
                    let std = std.as_ref()?;
                    let std = if std.is(self.count, 3) {
                        std.three(index, self.count)
                    } else {
                        std.three(0, 1)
                    };
                    independent(&Vector3::from(std))
                };
                let velocity = velocity.as_ref().map(vector).filter(finite);
                What::Fix(Fix {
                    time,
                    position: Some((Position::Geodetic(place), covariance(std))),
                    velocity: velocity.map(|velocity| (velocity, covariance(velocity_std))),
                    quality: FixQuality::Unknown,
                })
            }
            Kind::Poses {
                place,
                velocity,
                attitude,
            } => {
                let position = match place_of(place, index) {
                    Ok(place) => place,
                    Err(detail) => return What::Skipped(SkipKind::OutOfRange, detail),
                };
                let rpy = match attitude {
                    Attitude::Angles(angles) => {
                        Vector3::from(angles.each_ref().map(|angle| angle.one(index)))
                    }
                    Attitude::Matrices(matrices) => angles(&matrices.some(index, self.count)),
                };
                What::Pose(TruthSample {
                    time,
                    position,
                    v_n: velocity.as_ref().map(vector).filter(finite),
                    rpy: Some(rpy).filter(finite),
                })
            }
        }
    }
}

impl Iterator for Rows {
    type Item = Entry;

    fn next(&mut self) -> Option<Entry> {
        let index = self.next;
        if index >= self.count {
            return None;
        }
        self.next += 1;
        Some(Entry {
            at: self.next as u64,
            what: self.row(index),
        })
    }
}

/// `Err` says what stands there instead of a place.
fn place_of(place: &[Numbers; 3], index: usize) -> Result<Geodetic, String> {
    let [lat, lon, height] = place.each_ref().map(|numbers| numbers.one(index));
    let place = Geodetic { lat, lon, height };
    if is_a_fix(&place) {
        return Ok(place);
    }
    Err(shown(&place))
}

/// Roll, pitch and yaw of a matrix from navigation to body axes, column by column.
fn angles(c_bn: &[f64; 9]) -> Vector3 {
    let [c11, _, _, c12, _, _, c13, c23, c33] = *c_bn;
    Vector3::new(c23.atan2(c33), -c13.clamp(-1.0, 1.0).asin(), c12.atan2(c11))
}
