//! The track as KML 2.2: a line for each span with and without GNSS, in green and red.
//!
//! Lines lie on the ground, since KML counts absolute altitudes from the sea level and the heights
//! here are above the ellipsoid; the coordinates have them nevertheless.

use std::io::{self, Write};

use super::SolutionOptions;
use super::block::Block;
use super::solution::SolutionRow;
use super::spans::{Spans, Step};
use super::text::{write_place, xml};

/// Writes rows as KML.
#[derive(Debug)]
pub struct KmlWriter<W: Write> {
    block: Block<W>,
    spans: Spans,
}

impl<W: Write> KmlWriter<W> {
    pub(super) fn new(out: W, options: &SolutionOptions, every: f64) -> Self {
        let mut block = Block::new(out);
        let mut head = String::from(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\">\n<Document>\n",
        );
        head += &format!("<name>{}</name>\n", xml(&options.name));
        // Colours are alpha, blue, green, red.
        for (id, colour) in [("gnss", "ff2ca02c"), ("no-gnss", "ff2827d6")] {
            head += &format!(
                "<Style id=\"{id}\"><LineStyle><color>{colour}</color><width>4</width></LineStyle></Style>\n"
            );
        }
        block.bytes.extend_from_slice(head.as_bytes());
        Self {
            block,
            spans: Spans::new(every),
        }
    }

    pub(super) fn write(&mut self, row: &SolutionRow, outage: bool) -> io::Result<()> {
        let block = &mut self.block;
        self.spans.push(row, outage, |step| tell(block, step))
    }

    pub(super) fn into_inner(mut self) -> io::Result<W> {
        let block = &mut self.block;
        self.spans.finish(|step| tell(block, step))?;
        block.bytes.extend_from_slice(b"</Document>\n</kml>\n");
        self.block.into_inner()
    }
}

fn tell<W: Write>(block: &mut Block<W>, step: Step<'_>) -> io::Result<()> {
    let buf = &mut block.bytes;
    match step {
        Step::Begin(row, outage) => {
            let (name, style) = if outage {
                ("Without GNSS", "no-gnss")
            } else {
                ("With GNSS", "gnss")
            };
            let head = format!(
                "<Placemark><name>{name} from {:.1} s</name><styleUrl>#{style}</styleUrl>\n<LineString><tessellate>1</tessellate><coordinates>\n",
                row.time
            );
            buf.extend_from_slice(head.as_bytes());
            write_place(buf, &row.position);
        }
        Step::Point(row) => {
            buf.push(b'\n');
            write_place(buf, &row.position);
        }
        Step::End(..) => {
            buf.extend_from_slice(b"\n</coordinates></LineString></Placemark>\n");
        }
    }
    block.spill()
}
