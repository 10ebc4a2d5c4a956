//! Files that are no logs, known by their beginning, so that a message can state what they are instead of
//! quoting them.

use crate::ReadError;
use crate::source::without_byte_order_mark;
use std::path::Path;

/// What a file is, and what to do about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Foreign {
    /// "an HTML page"
    pub what: &'static str,
    /// What to do; without a full stop.
    pub mend: &'static str,
}

const fn foreign(what: &'static str, mend: &'static str) -> Foreign {
    Foreign { what, mend }
}

const EMPTY: Foreign = foreign("empty (0 bytes)", "copy or record it again");
const HTML: Foreign = foreign(
    "an HTML page",
    "download the file itself: this is a login or error page, or a preview",
);
const POINTER: Foreign = foreign("a Git LFS pointer", "fetch the content with `git lfs pull`");
const ARCHIVE: Foreign = foreign("an archive", "extract it first");
const IMAGE: Foreign = foreign("an image", "use the log that it was made from");
const RINEX: Foreign = foreign(
    "a RINEX file of raw observations",
    "give the log with the receiver's positions (NMEA, UBX, .pos), and list RINEX files in gnss.observations",
);
const DRIVE: Foreign = foreign("a drive file", "give its logs instead");
const MODEL: Foreign = foreign("a model file", "give a log here");
const SHEET: Foreign = foreign(
    "a ZIP archive or a workbook",
    "extract it, or save the sheet as CSV",
);
const EXCEL: Foreign = foreign("an Excel workbook (.xlsx)", "save the sheet as CSV");
const FIT: Foreign = foreign(
    "a list of the messages of a FIT file (FitCSVTool)",
    "convert the FIT file with GPSBabel, `gpsbabel -i garmin_fit -f FILE.fit -o gpx -F track.gpx`",
);
const TELEMETRY: Foreign = foreign(
    "a list of the messages of a telemetry log",
    "give the .tlog file itself, or the log of the autopilot (.bin)",
);
const DUMP: Foreign = foreign(
    "a list of the messages of a log of ArduPilot",
    "give the log itself (.bin)",
);
const PICKLE: Foreign = foreign(
    "an array of numpy that is not one table of numbers",
    "save one in Python: `numpy.savetxt(\"log.csv\", rows, delimiter=\",\")`",
);
const BINARY: Foreign = foreign(
    "binary data of an unknown format",
    "convert it to CSV or another supported format (docs/formats.md)",
);

/// Bytes that such files begin with.
const MARKS: [(&[u8], Foreign); 19] = [
    (b"\x93NUMPY", PICKLE),
    (
        b"%PDF-",
        foreign("a PDF document", "export the table as CSV"),
    ),
    (b"PK\x03\x04", SHEET),
    (b"PK\x05\x06", SHEET),
    (
        b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
        foreign("an old workbook or document", "save the sheet as CSV"),
    ),
    (b"Rar!\x1a\x07", ARCHIVE),
    (b"7z\xbc\xaf\x27\x1c", ARCHIVE),
    (
        b"\xfd7zXZ\0",
        foreign("compressed by xz", "decompress it, or use gzip or zstd"),
    ),
    (
        b"BZh",
        foreign("compressed by bzip2", "decompress it, or use gzip or zstd"),
    ),
    (b"\x89PNG\r\n\x1a\n", IMAGE),
    (b"\xff\xd8\xff", IMAGE),
    (b"GIF8", IMAGE),
    (b"\x7fELF", foreign("a program", "give a log here")),
    (
        b"\x89HDF\r\n\x1a\n",
        foreign(
            "an HDF5 file",
            "save as MATLAB version 7 or earlier, or as CSV",
        ),
    ),
    (b"version https://git-lfs", POINTER),
    (b"<!doctype html", HTML),
    (b"<html", HTML),
    (
        b"<?xml",
        foreign(
            "an XML file, and neither GPX nor a track of KML with times",
            "convert it with GPSBabel, `gpsbabel -i FORMAT -f FILE -o gpx -F track.gpx`, FORMAT kml or gtrnctr (TCX)",
        ),
    ),
    (b"format = \"undrift-imu\"", MODEL),
];

/// What a file that begins so is, if it is known to be no log; `start` is decompressed, and not the start of any
/// format that is read.
pub fn known(start: &[u8]) -> Option<Foreign> {
    if start.is_empty() {
        return Some(EMPTY);
    }
    let text = without_byte_order_mark(start).trim_ascii_start();
    let begins = |mark: &[u8]| {
        let begin = |bytes: &[u8]| {
            bytes
                .get(..mark.len())
                .is_some_and(|b| b.eq_ignore_ascii_case(mark))
        };
        begin(start) || begin(text)
    };
    let has = |name: &[u8]| start.windows(name.len()).any(|part| part == name);
    if start.starts_with(b"PK\x03\x04") && (has(b"[Content_Types].xml") || has(b"xl/workbook")) {
        return Some(EXCEL);
    }
    if let Some((_, foreign)) = MARKS.iter().find(|(mark, _)| begins(mark)) {
        return Some(*foreign);
    }
    if start.get(257..262) == Some(b"ustar") {
        return Some(ARCHIVE);
    }
    if begins(b"Type,Local Number,Message,") {
        return Some(FIT);
    }
    let first = first_line(start);
    let has = |name: &[u8]| first.windows(name.len()).any(|part| part == name);
    if has(b",mavlink_") {
        return Some(TELEMETRY);
    }
    if has(b" {TimeUS : ") || has(b" {time_boot_ms : ") {
        return Some(DUMP);
    }
    if has(b"RINEX VERSION / TYPE") {
        return Some(RINEX);
    }
    let line_is = |wanted: &[u8]| {
        start
            .split(|byte| *byte == b'\n')
            .take(400)
            .any(|line| line.trim_ascii() == wanted)
    };
    if line_is(b"[imu]") || line_is(b"[gnss]") {
        return Some(DRIVE);
    }
    let json = match text {
        [b'{', ..] => true,
        [b'[', rest @ ..] => matches!(rest.trim_ascii_start(), [b'{' | b'[' | b'"', ..]),
        _ => false,
    };
    let of_lines = crate::table::are_json_lines(start);
    (json && !of_lines).then_some(foreign(
        "JSON",
        "convert it to CSV, to lines of an object each, or to an object of columns",
    ))
}

/// What a file that is to be a text of rows is instead, by the same beginning.
pub(crate) fn not_rows(start: &[u8]) -> Option<Foreign> {
    let utf_16 = start.starts_with(&[0xff, 0xfe]) || start.starts_with(&[0xfe, 0xff]);
    let first = first_line(start);
    if utf_16 || start.is_empty() {
        return None;
    }
    let sample = String::from_utf8_lossy(&first[..first.len().min(4096)]);
    let all = sample.chars().count();
    let is_odd =
        |c: &char| c.is_control() && !c.is_whitespace() || *c == char::REPLACEMENT_CHARACTER;
    let odd = sample.chars().filter(is_odd).count();
    (sample.contains('\0') || 10 * odd > 3 * all).then_some(BINARY)
}

fn first_line(start: &[u8]) -> &[u8] {
    start
        .split(|byte| *byte == b'\n')
        .next()
        .unwrap_or_default()
}

impl Foreign {
    /// That a log was expected in its place.
    pub(crate) fn in_place_of_a_log(self, name: &Path) -> ReadError {
        let Self { what, mend } = self;
        let log = match self {
            EMPTY => "",
            _ => ", not a log",
        };
        ReadError::new(name, format!("is {what}{log}")).mend(mend)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_are_no_logs_are_known_by_their_beginning() {
        let rinex = format!(
            "{:20}{:40}RINEX VERSION / TYPE\n",
            "     3.04", "OBSERVATION DATA"
        );
        let tar = [&[b'a'; 257][..], b"ustar\0"].concat();
        for (start, what) in [
            (&b""[..], "empty"),
            (b"\n <!DOCTYPE html>\n<html>", "an HTML page"),
            (b"\xef\xbb\xbf<HTML><body>", "an HTML page"),
            (b"%PDF-1.7\n%\xe2", "a PDF"),
            (b"PK\x03\x04\x14\0", "a ZIP archive or a workbook"),
            (
                b"PK\x03\x04\x14\0\x06\0[Content_Types].xml \xa2",
                "an Excel workbook",
            ),
            (b"\x89PNG\r\n\x1a\n\0", "an image"),
            (
                b"version https://git-lfs.github.com/spec/v1\noid",
                "a Git LFS pointer",
            ),
            (b"{\"t\": [1, 2]}", "JSON"),
            (b"[\n {\"t\": 1}]", "JSON"),
            (
                b"model = \"adis16405\"\n[imu]\nfile = \"a\"\n",
                "a drive file",
            ),
            (b"format = \"undrift-imu\"\n", "a model file"),
            (
                b"Type,Local Number,Message,Field 1,Value 1\n",
                "a list of the messages of a FIT",
            ),
            (
                b"2024-05-06T12:00:00,FD,1C,0,mavlink_raw_imu_t,time_usec,5\n",
                "a list of the messages of a telemetry",
            ),
            (
                b"2024-05-06 12:00:00.00: IMU {TimeUS : 12, I : 0}\n",
                "a list of the messages of a log of ArduPilot",
            ),
            (rinex.as_bytes(), "a RINEX file"),
            (&tar, "an archive"),
        ] {
            let found = known(start).unwrap_or_else(|| panic!("{what} is unknown"));
            assert!(found.what.starts_with(what), "{found:?}");
        }
        for log in [
            "t,gx,gy,gz\n1,2,3,4\n",
            "1 2 3\n",
            "# [imu] and a comment\n1,2\n",
            "[s],[rad/s]\n1,2\n",
        ] {
            assert_eq!(known(log.as_bytes()), None, "{log}");
            assert_eq!(not_rows(log.as_bytes()), None, "{log}");
        }
    }

    #[test]
    fn what_is_no_text_of_rows() {
        // An odd character in a header is damage, not another format.
        assert_eq!(not_rows(b"t,\xb0C,g\x1bx\n1,2,3\n"), None);
        assert_eq!(not_rows(b"\xff\xfet\0,\0"), None);
        assert_eq!(not_rows(b"t,a\0,b\n1,2,3\n"), Some(BINARY));
        let noise: Vec<u8> = (0..900u32)
            .map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8 | 0x80)
            .collect();
        assert_eq!(not_rows(&noise), Some(BINARY));
    }
}
