//! Satellites that a simulated receiver sees: also for the tests of other crates.

// Each of them uses a part of this.
#![allow(dead_code)]

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_nav::{Vector3, earth::EARTH_RATE, earth::Geodetic};
use undrift_observables::{
    Ephemerides, Ephemeris, Epoch, L1_WAVELENGTH, Observation, SPEED_OF_LIGHT, Satellite, System,
};

/// Twenty-four satellites in six planes, what is known of them, and the receiver's noise.
pub struct Sky {
    pub ephemerides: Ephemerides,
    orbits: Vec<(u8, Ephemeris)>,
    generator: Xoshiro256PlusPlus,
    /// Standard deviation of a phase \[m\].
    pub noise: f64,
    /// Standard deviation of a Doppler shift [m/s].
    pub doppler_noise: f64,
    /// Cycles by which each phase has slipped.
    pub slipped: [f64; 40],
}

impl Sky {
    /// Orbits around `toe` \[s of the week\], eccentric and with corrections and clocks of usual size.
    pub fn new(toe: f64, seed: u64) -> Self {
        let mut ephemerides = Ephemerides::default();
        let orbit = |k: u8| {
            let (plane, place) = (f64::from(k % 6), f64::from(k / 6));
            let ephemeris = Ephemeris {
                system: System::Gps,
                healthy: true,
                serves_for: 7200.0,
                toe,
                toc: toe,
                af: [1e-5 * f64::from(k), 3e-12 * f64::from(k), 0.0],
                group_delay: -5e-9,
                sqrt_a: 5153.7,
                e: 0.004 + 0.001 * plane,
                m0: place * 1.57 + plane * 0.42,
                delta_n: 4.5e-9,
                omega: 0.7 * place,
                omega0: plane * 1.047 + EARTH_RATE * toe,
                omega_dot: -8e-9,
                i0: 0.96,
                i_dot: 1e-10,
                cu: [1e-6, 5e-6],
                cr: [250.0, -20.0],
                ci: [1e-7, -1e-7],
                ..Ephemeris::default()
            };
            (k + 1, ephemeris)
        };
        let orbits: Vec<_> = (0..24).map(orbit).collect();
        for (number, ephemeris) in &orbits {
            ephemerides.insert(*number, *ephemeris);
        }
        Self {
            ephemerides,
            orbits,
            generator: Xoshiro256PlusPlus::seed_from_u64(seed),
            noise: 0.003,
            doppler_noise: 0.05,
            slipped: [0.0; 40],
        }
    }

    /// What an antenna at `place`, moving by `v_n` [m/s], sees at `time` \[s\], its clock fast by `clock` \[s\] and drifting by 1e-7.
    pub fn epoch(&mut self, time: f64, place: &Geodetic, v_n: &Vector3, clock: f64) -> Epoch {
        let here = place.to_ecef();
        let axes = place.ned_from_ecef();
        let mut observations = Vec::new();
        for (number, orbit) in &self.orbits {
            // The range from where the satellite was when the signal left, and the Earth then.
            let seen_at = |time: f64, here: Vector3| {
                let mut flight = 0.07;
                for _ in 0..6 {
                    let (_, clock) = orbit.at(time - flight);
                    let (satellite, _) = orbit.at(time - flight + clock);
                    let (sin, cos) = (EARTH_RATE * flight).sin_cos();
                    let turned = Vector3::new(
                        cos * satellite.x + sin * satellite.y,
                        cos * satellite.y - sin * satellite.x,
                        satellite.z,
                    );
                    flight = (turned - here).norm() / SPEED_OF_LIGHT;
                }
                let (_, clock) = orbit.at(time - flight);
                let (satellite, clock) = orbit.at(time - flight + clock);
                let (sin, cos) = (EARTH_RATE * flight).sin_cos();
                let line = Vector3::new(
                    cos * satellite.x + sin * satellite.y,
                    cos * satellite.y - sin * satellite.x,
                    satellite.z,
                ) - here;
                (line, line.norm() - SPEED_OF_LIGHT * clock)
            };
            let (line, range) = seen_at(time, here);
            let sin_elevation = -(axes * line).z / line.norm();
            if sin_elevation < 0.05 {
                continue;
            }
            let later = seen_at(time + 0.5, here + axes.tr_mul(v_n) * 0.5).1;
            let earlier = seen_at(time - 0.5, here - axes.tr_mul(v_n) * 0.5).1;
            let rate = later - earlier + SPEED_OF_LIGHT * 1e-7;
            let air = 2.3 / (sin_elevation + 0.003);
            let pseudorange = range + SPEED_OF_LIGHT * clock + air;
            let mut noise = || -> f64 { StandardNormal.sample(&mut self.generator) };
            let cycles = self.slipped[usize::from(*number)] + 1000.0 * f64::from(*number);
            observations.push(Observation {
                satellite: Satellite {
                    system: System::Gps,
                    number: *number,
                },
                pseudorange: pseudorange + noise(),
                phase: Some((pseudorange + self.noise * noise()) / L1_WAVELENGTH + cycles),
                phase_std: 0.01,
                doppler: -(rate + self.doppler_noise * noise()) / L1_WAVELENGTH,
                lock: 60.0,
                half_subtracted: false,
            });
        }
        Epoch {
            time: time + clock,
            observations,
        }
    }
}
