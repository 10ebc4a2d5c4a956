//! Pages of Galileo's integrity navigation message (I/NAV), on E1-B and E5b-I: Galileo OS SIS ICD 2.1, 4.3.

use crate::{Ephemeris, System, bits::Bits};

/// Words 1 to 5 of a satellite as they came last.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pages([Option<[u32; 4]>; 5]);

impl Pages {
    /// Takes a page: 128 bits with its even half at the top, 128 with the odd one. The ephemeris, where words 1 to 4 are of the same issue.
    pub(crate) fn take(&mut self, words: &[u32; 8]) -> Option<Ephemeris> {
        let page = Bits { words, width: 32 };
        let odd = 128;
        // Even before odd, both nominal, with the checksum of both.
        let halves = [page.unsigned(0, 2), page.unsigned(odd, 2)];
        if halves != [0b00, 0b10] || checksum(&page) != page.unsigned(odd + 82, 24) {
            return None;
        }
        // 112 bits of the even half, 16 of the odd one.
        let last = page.unsigned(98, 16) << 16 | page.unsigned(odd + 2, 16);
        let data = [
            page.unsigned(2, 32),
            page.unsigned(34, 32),
            page.unsigned(66, 32),
            last,
        ];
        let number = page.unsigned(2, 6) as usize;
        *self.0.get_mut(number.wrapping_sub(1))? = Some(data);
        let [
            Some(first),
            Some(second),
            Some(third),
            Some(fourth),
            Some(fifth),
        ] = &self.0
        else {
            return None;
        };
        ephemeris([first, second, third, fourth, fifth].map(|words| Bits { words, width: 32 }))
    }
}

/// CRC-24Q over the 114 bits of the even half and the first 82 of the odd one.
fn checksum(page: &Bits) -> u32 {
    (0..114).chain(128..128 + 82).fold(0, |sum, at| {
        let carry = (sum >> 23) & 1 ^ page.unsigned(at, 1);
        ((sum << 1) ^ (carry * 0x86_4cfb)) & 0xff_ffff
    })
}

/// The ephemeris of words 1 to 5; `None` where they are of different issues.
fn ephemeris([first, second, third, fourth, fifth]: [Bits; 5]) -> Option<Ephemeris> {
    let issues = [&first, &second, &third, &fourth].map(|word| word.unsigned(6, 10));
    if issues != [issues[0]; 4] {
        return None;
    }
    // Signal health and data validity on E1-B, accuracy.
    let healthy =
        fifth.unsigned(69, 2) == 0 && fifth.unsigned(72, 1) == 0 && third.unsigned(120, 8) != 255;
    let minute = 60.0;
    Some(Ephemeris {
        system: System::Galileo,
        issue: issues[0] as u16,
        healthy,
        serves_for: 4.0 * 3600.0,
        toe: minute * first.scaled(16, 14, 0),
        toc: minute * fourth.scaled(54, 14, 0),
        af: [
            fourth.signed(68, 31, -34),
            fourth.signed(99, 21, -46),
            fourth.signed(120, 6, -59),
        ],
        group_delay: fifth.signed(57, 10, -32),
        sqrt_a: first.scaled(94, 32, -19),
        e: first.scaled(62, 32, -33),
        m0: first.angle(30, 32, -31),
        delta_n: third.angle(40, 16, -43),
        omega: second.angle(80, 32, -31),
        omega0: second.angle(16, 32, -31),
        omega_dot: third.angle(16, 24, -43),
        i0: second.angle(48, 32, -31),
        i_dot: second.angle(112, 14, -43),
        cu: [third.signed(56, 16, -29), third.signed(72, 16, -29)],
        cr: [third.signed(88, 16, -5), third.signed(104, 16, -5)],
        ci: [fourth.signed(22, 16, -29), fourth.signed(38, 16, -29)],
    })
}
