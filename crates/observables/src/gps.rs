//! Subframes of GPS's legacy navigation message (LNAV), IS-GPS-200, 20.3.3.

use crate::{Ephemeris, System, bits::Bits};

/// First bits of the first word of a subframe.
const PREAMBLE: u32 = 0x8b;

/// Subframes 1, 2, 3 of a satellite as they came last.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Subframes([Option<[u32; 10]>; 3]);

/// Data of a subframe.
fn bits(words: &[u32; 10]) -> Bits<'_> {
    Bits { words, width: 24 }
}

/// Place of a bit of a word, both counted from 1 as in IS-GPS-200.
fn at(word: usize, bit: usize) -> usize {
    (word - 1) * 24 + bit - 1
}

impl Subframes {
    /// Takes ten words of 30 bits; the ephemeris, where subframes 1, 2 and 3 are of the same issue.
    pub(crate) fn take(&mut self, words: &[u32; 10]) -> Option<Ephemeris> {
        let words = words.map(|word| word << 2);
        let number = bits(&words).unsigned(at(2, 20), 3);
        let own = bits(&words).unsigned(at(1, 1), 8) == PREAMBLE;
        let slot = self.0.get_mut((number as usize).wrapping_sub(1));
        *slot.filter(|_| own)? = Some(words);
        let [Some(first), Some(second), Some(third)] = &self.0 else {
            return None;
        };
        ephemeris([first, second, third].map(bits))
    }
}

/// The ephemeris of subframes 1, 2, 3; `None` where they are of different issues.
fn ephemeris([first, second, third]: [Bits; 3]) -> Option<Ephemeris> {
    let issue = second.unsigned(at(3, 1), 8);
    if third.unsigned(at(10, 1), 8) != issue || first.unsigned(at(8, 1), 8) != issue {
        return None;
    }
    let healthy = first.unsigned(at(3, 17), 6) == 0 && first.unsigned(at(3, 13), 4) != 15;
    let longer = second.unsigned(at(10, 17), 1) == 1;
    Some(Ephemeris {
        system: System::Gps,
        issue: issue as u16,
        healthy,
        serves_for: if longer { 3.0 } else { 2.0 } * 3600.0,
        toe: second.scaled(at(10, 1), 16, 4),
        toc: first.scaled(at(8, 9), 16, 4),
        af: [
            first.signed(at(10, 1), 22, -31),
            first.signed(at(9, 9), 16, -43),
            first.signed(at(9, 1), 8, -55),
        ],
        group_delay: first.signed(at(7, 17), 8, -31),
        sqrt_a: second.scaled(at(8, 17), 32, -19),
        e: second.scaled(at(6, 17), 32, -33),
        m0: second.angle(at(4, 17), 32, -31),
        delta_n: second.angle(at(4, 1), 16, -43),
        omega: third.angle(at(7, 17), 32, -31),
        omega0: third.angle(at(3, 17), 32, -31),
        omega_dot: third.angle(at(9, 1), 24, -43),
        i0: third.angle(at(5, 17), 32, -31),
        i_dot: third.angle(at(10, 9), 14, -43),
        cu: [
            second.signed(at(6, 1), 16, -29),
            second.signed(at(8, 1), 16, -29),
        ],
        cr: [
            third.signed(at(7, 1), 16, -5),
            second.signed(at(3, 9), 16, -5),
        ],
        ci: [
            third.signed(at(3, 1), 16, -29),
            third.signed(at(5, 1), 16, -29),
        ],
    })
}
