//! What satellites say of their orbits, put together from their messages.

use crate::{Ephemeris, Satellite, System, galileo::Pages, gps::Subframes};

/// Satellites of a system with a message of their own, at most.
const SATELLITES: usize = 36;

/// The latest ephemeris of each satellite, and the parts of messages from which the next is put together.
#[derive(Clone, Debug)]
pub struct Ephemerides {
    gps: [(Subframes, Option<Ephemeris>); SATELLITES],
    galileo: [(Pages, Option<Ephemeris>); SATELLITES],
}

impl Default for Ephemerides {
    fn default() -> Self {
        Self {
            gps: [Default::default(); SATELLITES],
            galileo: [Default::default(); SATELLITES],
        }
    }
}

impl Ephemerides {
    /// Takes a subframe of a GPS satellite by its PRN: ten words of 30 bits, the parity checked and the polarity of the data set right, as receivers
    /// give them; what is above the 30 bits is not looked at. Subframes 4 and 5, and words that are no subframe, are passed over.
    pub fn gps_subframe(&mut self, prn: u8, words: &[u32; 10]) {
        if let Some((parts, latest)) = slot(&mut self.gps, prn) {
            *latest = parts.take(words).filter(Ephemeris::is_possible).or(*latest);
        }
    }

    /// Takes a page of the I/NAV message of a Galileo satellite, of E1-B or E5b-I: four words with the even half of 120 bits at the top, four with
    /// the odd one. One with a wrong checksum is passed over.
    pub fn galileo_page(&mut self, number: u8, words: &[u32; 8]) {
        if let Some((parts, latest)) = slot(&mut self.galileo, number) {
            *latest = parts.take(words).filter(Ephemeris::is_possible).or(*latest);
        }
    }

    /// Takes a whole ephemeris, as of a file of them.
    pub fn insert(&mut self, number: u8, ephemeris: Ephemeris) {
        let latest = match ephemeris.system {
            System::Gps => slot(&mut self.gps, number).map(|(_, latest)| latest),
            System::Galileo => slot(&mut self.galileo, number).map(|(_, latest)| latest),
        };
        if let Some(latest) = latest {
            *latest = Some(ephemeris).filter(Ephemeris::is_possible).or(*latest);
        }
    }

    /// The latest ephemeris of a satellite, if it serves at `time` \[s of the week\].
    pub fn of(&self, satellite: Satellite, time: f64) -> Option<&Ephemeris> {
        let at = usize::from(satellite.number).checked_sub(1)?;
        let latest = match satellite.system {
            System::Gps => &self.gps.get(at)?.1,
            System::Galileo => &self.galileo.get(at)?.1,
        };
        latest.as_ref().filter(|known| known.serves(time))
    }
}

fn slot<T>(all: &mut [T], number: u8) -> Option<&mut T> {
    all.get_mut(usize::from(number).checked_sub(1)?)
}
