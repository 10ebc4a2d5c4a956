//! A recorded drive in few bytes, read in place; the layout is that of its maker,
//! crates/undrift/examples/embedded_minute.rs.

use undrift_nav::{
    Vector3, attitude, earth::Geodetic, filter::InitialStd, mechanisation::NavState,
    sample::ImuSample,
};

const NUMBERS: usize = 33;
const HEADER: usize = 16 + 8 * NUMBERS;
const SAMPLE: usize = 12;
const FIX: usize = 8 * 13;

/// A record and what its header says.
#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    /// Sample interval [s].
    pub interval: f64,
    /// One count of an angle increment [rad] and of a velocity increment [m/s].
    pub counts: [f64; 2],
    /// A first guess of position, velocity and attitude, at time 0.
    pub start: NavState,
    /// Its standard deviations.
    pub std: InitialStd,
    /// Lever arm from IMU to antenna, body axes [m].
    pub lever_arm: Vector3,
    /// Where the IMU really is at the end.
    pub end: NavState,
    samples: &'a [u8],
    fixes: &'a [u8],
}

/// Position and velocity of the antenna.
#[derive(Clone, Copy, Debug)]
pub struct Fix {
    /// Time [s].
    pub time: f64,
    /// Position.
    pub position: Geodetic,
    /// Velocity north, east, down [m/s].
    pub v_n: Vector3,
    /// Standard deviations of the position north, east, down [m].
    pub position_std: Vector3,
    /// Standard deviations of the velocity north, east, down [m/s].
    pub velocity_std: Vector3,
}

impl<'a> Record<'a> {
    /// Reads the header; `None` if the bytes are no such record or too few.
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        let (header, body) = bytes.split_at_checked(HEADER)?;
        let (front, numbers) = header.split_at_checked(16)?;
        if !front.starts_with(b"undrift1") {
            return None;
        }
        let (samples, fixes) = (size(front, 8)?, size(front, 12)?);
        let (samples, rest) = body.split_at_checked(samples.checked_mul(SAMPLE)?)?;
        let fixes = rest.get(..fixes.checked_mul(FIX)?)?;
        let [interval, angle, velocity, rest @ ..] = numbers_of::<NUMBERS>(numbers);
        let end = interval * (samples.len() / SAMPLE) as f64;
        Some(Self {
            interval,
            counts: [angle, velocity],
            start: state(0.0, &rest, 0),
            std: InitialStd {
                position: vector(&rest, 9),
                velocity: vector(&rest, 12),
                attitude: vector(&rest, 15),
            },
            lever_arm: vector(&rest, 18),
            end: state(end, &rest, 21),
            samples,
            fixes,
        })
    }

    /// The inertial samples.
    pub fn samples(&self) -> impl Iterator<Item = ImuSample> {
        let Self {
            interval, counts, ..
        } = *self;
        let (chunks, _) = self.samples.as_chunks::<SAMPLE>();
        chunks.iter().enumerate().map(move |(k, bytes)| {
            let (pairs, _) = bytes.as_chunks::<2>();
            let mut counted = [0.0; 6];
            for (slot, pair) in counted.iter_mut().zip(pairs) {
                *slot = f64::from(i16::from_le_bytes(*pair));
            }
            ImuSample {
                time: (k + 1) as f64 * interval,
                dt: interval,
                dtheta: vector(&counted, 0) * counts[0],
                dvel: vector(&counted, 3) * counts[1],
            }
        })
    }

    /// The fixes.
    pub fn fixes(&self) -> impl Iterator<Item = Fix> {
        let (chunks, _) = self.fixes.as_chunks::<FIX>();
        chunks.iter().map(|bytes| {
            let [time, lat, lon, height, rest @ ..] = numbers_of::<13>(bytes);
            Fix {
                time,
                position: Geodetic { lat, lon, height },
                v_n: vector(&rest, 0),
                position_std: vector(&rest, 3),
                velocity_std: vector(&rest, 6),
            }
        })
    }
}

fn size(bytes: &[u8], at: usize) -> Option<usize> {
    let number = bytes.get(at..)?.first_chunk::<4>()?;
    usize::try_from(u32::from_le_bytes(*number)).ok()
}

/// As many numbers as there are bytes for, then zeros.
fn numbers_of<const M: usize>(bytes: &[u8]) -> [f64; M] {
    let (chunks, _) = bytes.as_chunks::<8>();
    let mut numbers = [0.0; M];
    for (slot, bytes) in numbers.iter_mut().zip(chunks) {
        *slot = f64::from_le_bytes(*bytes);
    }
    numbers
}

fn vector(numbers: &[f64], at: usize) -> Vector3 {
    let number = |i: usize| numbers.get(at + i).copied().unwrap_or(0.0);
    Vector3::new(number(0), number(1), number(2))
}

fn state(time: f64, numbers: &[f64], at: usize) -> NavState {
    let place = vector(numbers, at);
    NavState {
        time,
        position: Geodetic {
            lat: place.x,
            lon: place.y,
            height: place.z,
        },
        v_n: vector(numbers, at + 3),
        q_nb: attitude::from_rpy(&vector(numbers, at + 6)),
    }
}
