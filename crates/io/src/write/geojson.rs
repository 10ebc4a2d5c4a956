//! The track as GeoJSON, RFC 7946: a `LineString` of longitude, latitude and height above the
//! ellipsoid for each span with and without GNSS, told by the property `gnss`.

use std::io::{self, Write};

use super::SolutionOptions;
use super::block::Block;
use super::solution::SolutionRow;
use super::spans::{Spans, Step};
use super::text::{json, write_place};
use super::write_fixed;

/// Writes rows as GeoJSON.
#[derive(Debug)]
pub struct GeoJsonWriter<W: Write> {
    block: Block<W>,
    spans: Spans,
    /// Time at which the line began \[s\].
    start: f64,
    /// Before the next feature.
    separator: &'static str,
}

impl<W: Write> GeoJsonWriter<W> {
    pub(super) fn new(out: W, options: &SolutionOptions, every: f64) -> Self {
        let mut block = Block::new(out);
        let head = format!(
            "{{\"type\":\"FeatureCollection\",\"name\":{},\"features\":[",
            json(&options.name)
        );
        block.bytes.extend_from_slice(head.as_bytes());
        Self {
            block,
            spans: Spans::new(every),
            start: 0.0,
            separator: "\n",
        }
    }

    pub(super) fn write(&mut self, row: &SolutionRow, outage: bool) -> io::Result<()> {
        let (block, start, separator) = (&mut self.block, &mut self.start, &mut self.separator);
        self.spans
            .push(row, outage, |step| tell(block, start, separator, step))
    }

    pub(super) fn into_inner(mut self) -> io::Result<W> {
        let (block, start, separator) = (&mut self.block, &mut self.start, &mut self.separator);
        self.spans
            .finish(|step| tell(block, start, separator, step))?;
        block.bytes.extend_from_slice(b"\n]}\n");
        self.block.into_inner()
    }
}

fn tell<W: Write>(
    block: &mut Block<W>,
    start: &mut f64,
    separator: &mut &'static str,
    step: Step<'_>,
) -> io::Result<()> {
    let buf = &mut block.bytes;
    match step {
        Step::Begin(row, _) => {
            *start = row.time;
            buf.extend_from_slice(separator.as_bytes());
            *separator = ",\n";
            buf.extend_from_slice(
                b"{\"type\":\"Feature\",\"geometry\":{\"type\":\"LineString\",\"coordinates\":[\n[",
            );
            write_place(buf, &row.position);
            buf.push(b']');
        }
        Step::Point(row) => {
            buf.extend_from_slice(b",\n[");
            write_place(buf, &row.position);
            buf.push(b']');
        }
        Step::End(row, outage) => {
            let head = format!("\n]}},\"properties\":{{\"gnss\":{},\"start_s\":", !outage);
            buf.extend_from_slice(head.as_bytes());
            write_fixed(buf, *start, 3);
            buf.extend_from_slice(b",\"end_s\":");
            write_fixed(buf, row.time, 3);
            buf.extend_from_slice(b"}}");
        }
    }
    block.spill()
}
