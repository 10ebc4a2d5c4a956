//! Numbers in a row of bits.

/// Words with the data at their top: 24 bits each of GPS, 32 of Galileo.
pub(crate) struct Bits<'a> {
    pub(crate) words: &'a [u32],
    pub(crate) width: usize,
}

impl Bits<'_> {
    /// `length` bits from bit `first` on, counted from 0. Beyond the end are zeros.
    pub(crate) fn unsigned(&self, first: usize, length: usize) -> u32 {
        (first..first + length).fold(0, |value, at| {
            let word = self.words.get(at / self.width).copied().unwrap_or(0);
            value << 1 | (word >> (31 - at % self.width)) & 1
        })
    }

    /// The same in two's complement, times two to the power of `exponent`.
    pub(crate) fn signed(&self, first: usize, length: usize, exponent: i32) -> f64 {
        let value = self.unsigned(first, length) << (32 - length);
        f64::from(value.cast_signed() >> (32 - length)) * 2f64.powi(exponent)
    }

    /// Without a sign, times two to the power of `exponent`.
    pub(crate) fn scaled(&self, first: usize, length: usize, exponent: i32) -> f64 {
        f64::from(self.unsigned(first, length)) * 2f64.powi(exponent)
    }

    /// A signed number of semicircles \[rad\].
    pub(crate) fn angle(&self, first: usize, length: usize, exponent: i32) -> f64 {
        self.signed(first, length, exponent) * std::f64::consts::PI
    }
}
