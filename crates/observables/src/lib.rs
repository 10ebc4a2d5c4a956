//! What a GNSS receiver observes of GPS on L1 and Galileo on E1, before it makes a fix of it: [`Ephemerides`] from the satellites'
//! navigation messages, places and clocks of satellites by them, and the way of the antenna between two [`Epoch`]s by the
//! [carrier phase](displacement).
//!
//! Not an RTK or PPP engine: phases are only differenced in time, so that their whole number of wavelengths cancels. Two epochs need
//! no base station and no ambiguities, and give the way between them to millimetres.
//!
//! SI units and radians, Earth-centred Earth-fixed axes (`e`) unless `ned`; times are GPS seconds of the week. Algorithms of
//! satellites: IS-GPS-200, 20.3.3.4.3.
//!
//! ```
//! use undrift_observables::{Ephemerides, Epoch, displacement};
//! use undrift_nav::{Vector3, earth::Geodetic};
//! // Without ephemerides nothing is known of the satellites.
//! let epoch = |time| Epoch { time, observations: Vec::new() };
//! let here = Geodetic::from_degrees(47.0, 8.0, 400.0);
//! let way = displacement(&Ephemerides::default(), &epoch(100.0), &epoch(100.2), &here, &Vector3::zeros());
//! assert!(way.is_none());
//! ```

mod bits;
mod displacement;
mod ephemerides;
mod ephemeris;
mod galileo;
mod gps;

pub use displacement::{Displacement, displacement};
pub use ephemerides::Ephemerides;
pub use ephemeris::{Ephemeris, SPEED_OF_LIGHT, System, since};

/// Frequency of GPS L1 and Galileo E1 \[Hz\].
pub const L1_FREQUENCY: f64 = 1_575.42e6;
/// Wavelength of GPS L1 and Galileo E1 \[m\].
pub const L1_WAVELENGTH: f64 = SPEED_OF_LIGHT / L1_FREQUENCY;

/// A satellite of a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Satellite {
    /// Its system.
    pub system: System,
    /// Its number there, from 1: the PRN of GPS.
    pub number: u8,
}

/// What was observed of one satellite at one epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Which.
    pub satellite: Satellite,
    /// Pseudorange \[m\], by the clock of the receiver.
    pub pseudorange: f64,
    /// Carrier phase \[cycles\], growing with the range; `None` where the receiver does not vouch for it and its half cycles.
    pub phase: Option<f64>,
    /// Standard deviation of the phase \[cycles\] as the receiver states it.
    pub phase_std: f64,
    /// Doppler shift \[Hz\], positive of a satellite that comes nearer.
    pub doppler: f64,
    /// How long the phase has been tracked without a slip \[s\].
    pub lock: f64,
    /// Whether half a cycle was subtracted from the phase.
    pub half_subtracted: bool,
}

/// Observations of one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Epoch {
    /// The receiver's clock \[s\]: GPS seconds of a week, going on past its end.
    pub time: f64,
    /// One a satellite.
    pub observations: Vec<Observation>,
}
