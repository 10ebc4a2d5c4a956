//! Decompression of Zstandard: by libzstd, in WebAssembly, where C has no place, by a decoder written in Rust.

use std::io::{self, BufRead, Read};

/// Decompresses all frames of a stream.
///
/// # Errors
/// If no decoder can be made.
#[cfg(not(target_family = "wasm"))]
pub(crate) fn decoder<R: BufRead>(packed: R) -> io::Result<impl Read> {
    zstd::Decoder::with_buffer(packed)
}

/// Decompresses all frames of a stream.
///
/// # Errors
/// None.
#[cfg(target_family = "wasm")]
pub(crate) fn decoder<R: BufRead>(packed: R) -> io::Result<impl Read> {
    Ok(frames::Frames::new(packed))
}

#[cfg(any(test, target_family = "wasm"))]
pub(crate) mod frames {
    use super::{BufRead, Read, io};
    use ruzstd::decoding::{
        BlockDecodingStrategy, FrameDecoder,
        errors::{FrameDecoderError, ReadFrameHeaderError},
    };

    /// Frames one after the other, skippable ones left out, checksums verified.
    pub(crate) struct Frames<R> {
        packed: R,
        decoder: FrameDecoder,
        in_frame: bool,
    }

    impl<R: BufRead> Frames<R> {
        pub(crate) fn new(packed: R) -> Self {
            Self {
                packed,
                decoder: FrameDecoder::new(),
                in_frame: false,
            }
        }

        /// Goes on to the next frame.
        fn begin(&mut self) -> io::Result<()> {
            match self.decoder.reset(&mut self.packed) {
                Ok(()) => self.in_frame = true,
                Err(FrameDecoderError::ReadFrameHeaderError(ReadFrameHeaderError::SkipFrame {
                    length,
                    ..
                })) => {
                    let length = u64::from(length);
                    let mut skipped = self.packed.by_ref().take(length);
                    if io::copy(&mut skipped, &mut io::sink())? < length {
                        return Err(io::ErrorKind::UnexpectedEof.into());
                    }
                }
                Err(error) => return Err(io::Error::other(error)),
            }
            Ok(())
        }
    }

    impl<R: BufRead> Read for Frames<R> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            loop {
                if !self.in_frame {
                    if self.packed.fill_buf()?.is_empty() {
                        return Ok(0);
                    }
                    self.begin()?;
                    continue;
                }
                while self.decoder.can_collect() == 0 && !self.decoder.is_finished() {
                    let block = BlockDecodingStrategy::UptoBlocks(1);
                    let decoded = self.decoder.decode_blocks(&mut self.packed, block);
                    decoded.map_err(io::Error::other)?;
                }
                let n = self.decoder.read(buffer)?;
                if n > 0 || buffer.is_empty() {
                    return Ok(n);
                }
                let stated = self.decoder.get_checksum_from_data();
                if stated.is_some() && stated != self.decoder.get_calculated_checksum() {
                    return Err(io::Error::other("its checksum is wrong"));
                }
                self.in_frame = false;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn packed(content: &[u8]) -> Vec<u8> {
        let mut encoder = zstd::Encoder::new(Vec::new(), 3).unwrap();
        encoder.include_checksum(true).unwrap();
        encoder.write_all(content).unwrap();
        encoder.finish().unwrap()
    }

    fn unpacked(packed: &[u8]) -> io::Result<Vec<u8>> {
        let mut content = Vec::new();
        frames::Frames::new(packed).read_to_end(&mut content)?;
        Ok(content)
    }

    /// Larger than a block of 128 KiB, and neither constant nor incompressible.
    fn content() -> Vec<u8> {
        let rows =
            (0..40_000_u32).map(|k| format!("{k},{}\n", k.wrapping_mul(2_654_435_761) >> 12));
        rows.collect::<String>().into_bytes()
    }

    #[test]
    fn the_decoder_of_webassembly_reads_what_libzstd_writes() {
        let content = content();
        assert_eq!(unpacked(&packed(&content)).unwrap(), content);
        assert_eq!(unpacked(&[]).unwrap(), b"");
        assert_eq!(unpacked(&packed(b"")).unwrap(), b"");
    }

    #[test]
    fn frames_follow_each_other_and_skippable_ones_are_skipped() {
        let skippable = [0x50, 0x2a, 0x4d, 0x18, 3, 0, 0, 0, b'a', b'b', b'c'];
        let all = [packed(b"first "), skippable.to_vec(), packed(b"second")].concat();
        assert_eq!(unpacked(&all).unwrap(), b"first second");
        assert!(unpacked(&skippable[..9]).is_err());
    }

    #[test]
    fn damaged_and_cut_frames_are_errors() {
        let whole = packed(&content());
        for end in (1..whole.len()).step_by(whole.len() / 50) {
            assert!(unpacked(&whole[..end]).is_err(), "{end}");
        }
        let mut wrong_sum = whole.clone();
        *wrong_sum.last_mut().unwrap() ^= 1;
        assert!(unpacked(&wrong_sum).is_err());
    }
}
