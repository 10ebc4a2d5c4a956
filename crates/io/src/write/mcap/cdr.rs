//! Plain CDR, little-endian: what ROS 2 serialises messages to. OMG DDSI-RTPS 2.5, section 10.

/// A message being serialised; numbers begin at multiples of their size.
#[derive(Debug, Default)]
pub(super) struct Cdr(Vec<u8>);

/// Plain CDR, little-endian, no options.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

impl Cdr {
    /// Begins a message in place of the one before.
    pub(super) fn begin(&mut self) -> &mut Self {
        self.0.clear();
        self.0.extend(ENCAPSULATION);
        self
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }

    fn number<const N: usize>(&mut self, number: [u8; N]) -> &mut Self {
        let content = self.0.len() - ENCAPSULATION.len();
        let padded = ENCAPSULATION.len() + content.next_multiple_of(N);
        self.0.resize(padded, 0);
        self.0.extend(number);
        self
    }

    pub(super) fn u8(&mut self, value: u8) -> &mut Self {
        self.number([value])
    }

    pub(super) fn u16(&mut self, value: u16) -> &mut Self {
        self.number(value.to_le_bytes())
    }

    pub(super) fn u32(&mut self, value: u32) -> &mut Self {
        self.number(value.to_le_bytes())
    }

    pub(super) fn i32(&mut self, value: i32) -> &mut Self {
        self.number(value.to_le_bytes())
    }

    pub(super) fn f64s<'a>(&mut self, values: impl IntoIterator<Item = &'a f64>) -> &mut Self {
        for value in values {
            self.number(value.to_le_bytes());
        }
        self
    }

    /// A short text; its length counts the zero at its end.
    pub(super) fn text(&mut self, text: &str) -> &mut Self {
        self.u32(text.len() as u32 + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
        self
    }
}
