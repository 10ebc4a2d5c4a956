//! What satellites say of their orbits, by their messages or a file.

use crate::{Ephemeris, Satellite, System, ephemeris::since, galileo::Pages, gps::Subframes};

/// Satellites of a system with a message of their own, at most.
const SATELLITES: usize = 36;

/// The ephemerides of each satellite, and the parts of messages from which the next is put together: the latest of messages, or all of a file.
#[derive(Clone, Debug)]
pub struct Ephemerides {
    gps: [(Subframes, Vec<Ephemeris>); SATELLITES],
    galileo: [(Pages, Vec<Ephemeris>); SATELLITES],
}

impl Default for Ephemerides {
    fn default() -> Self {
        Self {
            gps: std::array::from_fn(|_| Default::default()),
            galileo: std::array::from_fn(|_| Default::default()),
        }
    }
}

impl Ephemerides {
    /// Takes a subframe of a GPS satellite by its PRN: ten words of 30 bits, the parity checked and the polarity of the data set right, as receivers
    /// give them; what is above the 30 bits is not looked at. Subframes 4 and 5, and words that are no subframe, are passed over.
    pub fn gps_subframe(&mut self, prn: u8, words: &[u32; 10]) {
        if let Some((parts, known)) = slot(&mut self.gps, prn) {
            replace(known, parts.take(words));
        }
    }

    /// Takes a page of the I/NAV message of a Galileo satellite, of E1-B or E5b-I: four words with the even half of 120 bits at the top, four with
    /// the odd one. One with a wrong checksum is passed over.
    pub fn galileo_page(&mut self, number: u8, words: &[u32; 8]) {
        if let Some((parts, known)) = slot(&mut self.galileo, number) {
            replace(known, parts.take(words));
        }
    }

    /// Adds a whole ephemeris, as of a file of them, to those of the satellite.
    pub fn insert(&mut self, number: u8, ephemeris: Ephemeris) {
        let known = match ephemeris.system {
            System::Gps => slot(&mut self.gps, number).map(|(_, known)| known),
            System::Galileo => slot(&mut self.galileo, number).map(|(_, known)| known),
        };
        if let Some(known) = known.filter(|_| ephemeris.is_possible()) {
            known.push(ephemeris);
        }
    }

    /// The ephemeris of a satellite whose time is nearest to `time` \[s of the week\], if it serves then.
    pub fn of(&self, satellite: Satellite, time: f64) -> Option<&Ephemeris> {
        let at = usize::from(satellite.number).checked_sub(1)?;
        let known = match satellite.system {
            System::Gps => &self.gps.get(at)?.1,
            System::Galileo => &self.galileo.get(at)?.1,
        };
        let off = |one: &Ephemeris| since(time, one.toe).abs();
        let nearest = known.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.filter(|known| known.serves(time))
    }
}

/// A satellite's message replaces what it said before.
fn replace(known: &mut Vec<Ephemeris>, new: Option<Ephemeris>) {
    if let Some(new) = new.filter(Ephemeris::is_possible) {
        known.clear();
        known.push(new);
    }
}

fn slot<T>(all: &mut [T], number: u8) -> Option<&mut T> {
    all.get_mut(usize::from(number).checked_sub(1)?)
}
