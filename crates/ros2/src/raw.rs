//! Messages as they are serialised, encapsulation and all.

use rustdds::{
    RepresentationIdentifier,
    bytes::Bytes,
    no_key::{Decode, DefaultDecoder, DeserializerAdapter, SerializerAdapter},
};
use std::convert::Infallible;

/// A message: two bytes that say how it is serialised, two of options, its fields.
pub(crate) type Raw = Vec<u8>;

/// Leaves messages as they are.
pub(crate) struct AsIs;

/// See [`AsIs`].
#[derive(Clone)]
pub(crate) struct Copy;

impl DeserializerAdapter<Raw> for AsIs {
    type Error = Infallible;
    type Decoded = Raw;

    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        const KNOWN: [RepresentationIdentifier; 2] = [
            RepresentationIdentifier::CDR_LE,
            RepresentationIdentifier::CDR_BE,
        ];
        &KNOWN
    }

    fn transform_decoded(decoded: Raw) -> Raw {
        decoded
    }
}

impl Decode<'_, Raw> for Copy {
    type Error = Infallible;

    fn decode_bytes(
        self,
        fields: &[u8],
        encoding: RepresentationIdentifier,
    ) -> Result<Raw, Infallible> {
        let [kind, order] = encoding.to_bytes();
        Ok([&[kind, order, 0, 0], fields].concat())
    }
}

impl DefaultDecoder<Raw> for AsIs {
    type Decoder = Copy;
    const DECODER: Copy = Copy;
}

impl SerializerAdapter<Raw> for AsIs {
    type Error = Infallible;

    /// That of [`undrift_io::write::mcap::Messages`].
    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }

    fn to_bytes(message: &Raw) -> Result<Bytes, Infallible> {
        // The encapsulation is written again.
        Ok(Bytes::copy_from_slice(message.get(4..).unwrap_or_default()))
    }
}
