//! Pages compressed by Zstandard where the Parquet crate has no decoder of it, in WebAssembly: the crate reads them as they are,
//! and they are decompressed here.

use std::io::Read;
use std::sync::Arc;

use parquet::basic::Compression;
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::serialized_reader::SerializedPageReader;

use super::Bytes;
use crate::zstandard;

/// No page is larger than this \[bytes\]; those of the usual writers have one megabyte.
const MOST: u64 = 256 << 20;

/// The pages of a column of a row group.
pub(super) struct ZstdPages(SerializedPageReader<Bytes>);

/// Whether a column has such pages.
pub(super) fn has_them(column: &ColumnChunkMetaData) -> bool {
    matches!(column.compression(), Compression::ZSTD(_))
}

impl ZstdPages {
    pub(super) fn new(bytes: Bytes, column: &ColumnChunkMetaData, rows: usize) -> Result<Self> {
        let column = column.clone().into_builder();
        let column = column.set_compression(Compression::UNCOMPRESSED).build()?;
        SerializedPageReader::new(Arc::new(bytes), &column, rows, None).map(Self)
    }
}

fn unpacked(packed: &[u8]) -> Result<Vec<u8>> {
    let mut out = Vec::new();
    if packed.is_empty() {
        return Ok(out);
    }
    let decoder = zstandard::frames::Frames::new(packed);
    match decoder.take(MOST + 1).read_to_end(&mut out) {
        Ok(n) if n as u64 <= MOST => Ok(out),
        Ok(_) => Err(ParquetError::General("a page is too large".into())),
        Err(error) => Err(error.into()),
    }
}

/// The page with its content decompressed; of version 2 the levels before it are not compressed.
fn unpack(mut page: Page) -> Result<Page> {
    match &mut page {
        Page::DataPage { buf, .. } | Page::DictionaryPage { buf, .. } => {
            *buf = unpacked(buf)?.into();
        }
        Page::DataPageV2 {
            buf,
            def_levels_byte_len,
            rep_levels_byte_len,
            is_compressed,
            ..
        } => {
            let levels = *def_levels_byte_len as usize + *rep_levels_byte_len as usize;
            if *is_compressed && levels <= buf.len() {
                let (levels, values) = buf.split_at(levels);
                *buf = [levels, &unpacked(values)?].concat().into();
            }
        }
    }
    Ok(page)
}

impl Iterator for ZstdPages {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl PageReader for ZstdPages {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        self.0.get_next_page()?.map(unpack).transpose()
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.0.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.0.skip_next_page()
    }
}
