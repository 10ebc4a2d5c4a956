use std::io::{Cursor, Read, Write};

use super::*;
use crate::Opened;
use crate::format::Format;
use crate::skipped::SkipKind;

fn options(columns: &[Column]) -> TableOptions {
    TableOptions {
        columns: columns
            .iter()
            .map(|column| ("imu.gyro".to_owned(), column.clone()))
            .collect(),
        ..TableOptions::default()
    }
}

fn named(names: &[&str]) -> TableOptions {
    let columns: Vec<Column> = names.iter().map(|&n| Column::Name(n.into())).collect();
    options(&columns)
}

fn numbered(numbers: &[usize]) -> TableOptions {
    let columns: Vec<Column> = numbers.iter().map(|&n| Column::Number(n)).collect();
    options(&columns)
}

fn from(bytes: &[u8], options: &TableOptions) -> Result<Table, ReadError> {
    Opened::stream(Path::new("imu.csv"), Cursor::new(bytes.to_vec()))?.table(options)
}

type NumberedRows = Vec<(u64, Vec<f64>)>;

fn drain(table: &mut Table) -> Result<NumberedRows, ReadError> {
    let mut rows = Vec::new();
    let mut row = vec![0.0; table.columns.len()];
    while let Some(line) = table.next_row(&mut row)? {
        rows.push((line, row.clone()));
    }
    Ok(rows)
}

fn rows(text: &str, options: &TableOptions) -> (NumberedRows, Skipped) {
    let mut table = from(text.as_bytes(), options).unwrap();
    (drain(&mut table).unwrap(), table.skipped().clone())
}

fn message(text: &str, options: &TableOptions) -> String {
    match from(text.as_bytes(), options) {
        Err(error) => error.to_string(),
        Ok(mut table) => drain(&mut table).unwrap_err().to_string(),
    }
}

#[test]
fn columns_by_name_in_the_wanted_order_whatever_the_delimiter() {
    for text in [
        "t,a,b\n1,2,3\n4,5,6",
        "\u{feff}t;a;b\r\n1;2;3\r\n4;5;6\r\n",
        "t\ta\tb\n1\t2\t3\n4\t5\t6\n",
        "  t  a b\n 1   2 3 \n 4 5\t6\n",
        "\"t\",\"a\",\"b\"\n\"1\",\"2\",\"3\"\n\"4\",5,\"6\"\n",
    ] {
        let (rows, skipped) = rows(text, &named(&["b", "t"]));
        assert_eq!(rows, [(2, vec![3.0, 1.0]), (3, vec![6.0, 4.0])], "{text}");
        assert!(skipped.is_empty());
    }
}

#[test]
fn columns_by_number_with_and_without_header() {
    let wanted = numbered(&[3, 1, 3]);
    assert_eq!(rows("1,2,3\n", &wanted).0, [(1, vec![3.0, 1.0, 3.0])]);
    assert_eq!(
        rows("a,b,c\n1,2,3\n", &wanted).0,
        [(2, vec![3.0, 1.0, 3.0])]
    );
    // Text in a column that nobody wants makes no header of a row.
    assert_eq!(rows("1,ok,3\n4,ok,6\n", &wanted).0.len(), 2);
    assert_eq!(rows("# t a b\n1 2 3\n", &wanted).0.len(), 1);
    let pipes = TableOptions {
        delimiter: Some(b'|'),
        ..numbered(&[2])
    };
    assert_eq!(rows("1|2\n", &pipes).0, [(1, vec![2.0])]);
}

#[test]
fn a_comment_before_the_data_is_the_header() {
    let wanted = named(&["gx"]);
    let text = "# made by hand\n%t, gx, flag\n1, 2, ok\n# 9, 9, 9\n3, 4, ok\n";
    assert_eq!(rows(text, &wanted).0, [(3, vec![2.0]), (5, vec![4.0])]);
    assert_eq!(rows("# t gx\n1,2\n", &wanted).0, [(2, vec![2.0])]);
}

#[test]
fn missing_columns_are_named_with_what_there_is() {
    assert_eq!(
        message("# x\nt_s,gx_radps\n1,2\n", &named(&["t_s", "gx"])),
        "imu.csv line 2: no column \"gx\" (key imu.gyro); the file has: t_s, gx_radps"
    );
    assert!(message("1,2\n", &named(&["gx"])).contains("no header"));
    assert!(message("a,b\n1,2\n", &numbered(&[5])).contains("no column 5, there are 2"));
    assert!(message("1,2\n", &numbered(&[0])).contains("the first column is 1"));
    assert!(message("a,a\n1,2\n", &named(&["a"])).contains("columns 1 and 2"));
}

#[test]
fn files_without_data() {
    for text in ["\n\n", "# only\n", "a,b\n", "\u{feff}"] {
        let wanted = if text == "a,b\n" {
            named(&["a"])
        } else {
            numbered(&[1])
        };
        assert!(message(text, &wanted).contains("no data"), "{text:?}");
    }
    let text = message("a,b\nx,1\ny,2\n", &named(&["a"]));
    assert!(
        text.contains("2 rows with text") && text.contains("line 2"),
        "{text}"
    );
}

#[test]
fn bad_rows_are_skipped_and_counted() {
    let text = "a,b\n1,2\nx,2\n3\n4,\nnan,5\n\n  \n# note\n6,7,extra\n8,9";
    let (good, skipped) = rows(text, &named(&["a", "b"]));
    let lines: Vec<u64> = good.iter().map(|row| row.0).collect();
    assert_eq!(lines, [2, 10, 11]);
    assert_eq!(skipped.count(SkipKind::Text), 1);
    assert_eq!(skipped.count(SkipKind::MissingField), 2);
    assert_eq!(skipped.count(SkipKind::NotFinite), 1);
    assert!(skipped.to_string().contains("line 3: \"x\""), "{skipped}");

    let keeping = TableOptions {
        keep_not_finite: true,
        ..named(&["a", "b"])
    };
    assert_eq!(rows(text, &keeping).0.len(), 5);
}

#[test]
fn endless_lines_are_skipped() {
    let long = "7".repeat(3_000_000);
    let (good, skipped) = rows(&format!("{long}\n1,2\n{long},\n3,4"), &numbered(&[1, 2]));
    assert_eq!(good.len(), 2);
    assert_eq!(skipped.count(SkipKind::TooLong), 2);
}

#[test]
fn a_row_buffer_of_the_wrong_length_is_refused() {
    let mut table = from(b"1,2\n", &numbered(&[1, 2])).unwrap();
    assert!(table.next_row(&mut [0.0]).is_err());
    assert_eq!(table.next_row(&mut [0.0; 2]).unwrap(), Some(1));
}

/// A stream that fails after some bytes.
struct Failing(Cursor<Vec<u8>>);

impl Read for Failing {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        match self.0.read(into)? {
            0 => Err(std::io::Error::other("disk gone")),
            n => Ok(n),
        }
    }
}

#[test]
fn what_was_read_before_an_input_error_is_kept() {
    let failing = |text: &str| {
        let stream = Failing(Cursor::new(text.as_bytes().to_vec()));
        Opened::stream(Path::new("imu.csv"), stream)?.table(&numbered(&[1]))
    };
    // The 12 may be the beginning of 123: not used.
    let mut table = failing("10\n11\n12").unwrap();
    assert_eq!(drain(&mut table).unwrap().len(), 2);
    let text = table.skipped().to_string();
    assert_eq!(text, "file ends early, after line 2: disk gone");
    let error = failing("12").err().unwrap();
    assert!(error.to_string().contains("disk gone"), "{error}");
}

#[test]
fn a_cut_gzip_file_ends_early() {
    let mut text = String::from("t,a\n");
    for k in 0..50_000 {
        text += &format!("{k},{}\n", k * 7919 % 10_007);
    }
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(text.as_bytes()).unwrap();
    let mut bytes = encoder.finish().unwrap();
    bytes.truncate(bytes.len() / 2);
    let path = std::env::temp_dir().join(format!("undrift-io-cut-{}.csv.gz", std::process::id()));
    std::fs::write(&path, bytes).unwrap();
    let mut table = Opened::open(&path)
        .unwrap()
        .table(&named(&["t", "a"]))
        .unwrap();
    let rows = drain(&mut table).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert!((10_000..40_000).contains(&rows.len()), "{}", rows.len());
    assert!(
        rows.iter()
            .enumerate()
            .all(|(k, (_, row))| row[0] == k as f64)
    );
    assert_eq!(table.skipped().count(SkipKind::EndsEarly), 1);
}

/// Times of rows `time,value` and their skipped rows.
fn times(text: &str, date: Option<Column>, scale: f64) -> (Vec<f64>, u64) {
    let stamp = Stamp {
        place: 0,
        column: String::new(),
        scale,
        date: date.map(|column| ("imu.date".to_owned(), column)),
    };
    let options = TableOptions {
        stamp: Some(stamp),
        ..numbered(&[1, 2])
    };
    let mut table = from(text.as_bytes(), &options).unwrap();
    let (mut out, mut row) = (Vec::new(), [0.0; 2]);
    while let Ok(Some(_)) = table.next_row(&mut row) {
        out.push(row[0] * scale);
    }
    (out, table.skipped().total())
}

/// 8 July 2025 19:34:00 UTC is second 243 258 of its GPS week, 18 leap seconds included: by
/// `date -u -d 2025-07-08T19:34:00 +%s` = 1 752 003 240, less 315 964 800 of the GPS epoch, modulo 604 800.
const TUESDAY: f64 = 243_258.0;

#[test]
fn dates_are_times() {
    let text = "time,value\n2025-07-08T19:34:00.250Z,1\n2025-07-08 19:34:01,2\n2025/07/08 21:34:02.5+02:00,3\n\
                2025-07-08T14:04:03-0530,4\n2025-07-08 19:34:04 UTC,5\n2025-07-08t21:34:05+02,6\n";
    let expected = [0.25, 1.0, 2.5, 3.0, 4.0, 5.0].map(|s| TUESDAY + s);
    // In whatever unit numbers in the column would be.
    for scale in [1.0, 1e-3] {
        let (found, skipped) = times(text, None, scale);
        assert_eq!((found.len(), skipped), (6, 0));
        for (found, expected) in found.iter().zip(expected) {
            // One rounding of the quotient and one of the product.
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }
    // Without a header too; what is no date is skipped.
    let rows =
        "2025-07-08T19:34:00Z,1\n2025-13-08T19:34:00Z,1\n2025-07-08T19:34:01Z,1\n2025-07-08,1\n";
    assert_eq!(times(rows, None, 1.0), (vec![TUESDAY, TUESDAY + 1.0], 2));
    // Counting on past the end of the week, and over the leap second of 2016.
    let week = "2025-07-12T23:59:41Z,1\n2025-07-12T23:59:43Z,1\n";
    assert_eq!(times(week, None, 1.0).0, [604_799.0, 604_801.0]);
    let leap = "2016-12-31T23:59:59Z,1\n2016-12-31T23:59:60Z,1\n2017-01-01T00:00:00Z,1\n";
    let found = times(leap, None, 1.0).0;
    assert_eq!([found[1] - found[0], found[2] - found[1]], [1.0, 1.0]);
}

#[test]
fn times_of_day_count_on_and_take_their_date_from_a_column() {
    let text = "23:59:59.5,1\n00:00:00.5,2\n23:59:59.75,3\n00:00:01,4\n";
    let (found, _) = times(text, None, 1.0);
    assert_eq!(found, [86_399.5, 86_400.5, 86_399.75, 86_401.0]);
    let text = "t,v,d\n19:34:00.5,1,2025-07-08\n19:34:01,2,2025/07/08\n19:34:02,3,\n70443,4,2025-07-08\n19:34:04,5,8.7.25\n";
    let (found, skipped) = times(text, Some(Column::Number(3)), 1.0);
    assert_eq!(found, [0.5, 1.0, 3.0].map(|s| TUESDAY + s));
    assert_eq!(skipped, 2);
    let memory = super::Columns::new("x".as_ref(), vec![("t".into(), vec![1.0])]).unwrap();
    let options = TableOptions {
        stamp: Some(Stamp {
            place: 0,
            column: String::new(),
            scale: 1.0,
            date: Some(("imu.date".into(), Column::Number(1))),
        }),
        ..numbered(&[1])
    };
    let refused = Table::new("x".as_ref(), super::TableSource::Columns(memory), &options);
    assert!(refused.err().unwrap().to_string().contains("imu.date"));
}

#[test]
fn a_first_line_may_name_the_separator() {
    for (line, byte) in [
        ("sep=,", ","),
        ("sep=;", ";"),
        ("SEP=;;;;", ";"),
        ("\"sep=,\"", ","),
        ("\u{feff}sep=\t", "\t"),
        ("sep=|", "|"),
    ] {
        let table = "t,a,b\n1,2,3\n4,5,6\n".replace(',', byte);
        let text = format!("{line}\r\n{table}");
        let (rows, skipped) = rows(&text, &named(&["b", "t"]));
        assert!(skipped.is_empty(), "{line}");
        assert_eq!(rows, [(3, vec![3.0, 1.0]), (4, vec![6.0, 4.0])], "{line}");
        let mut opened =
            Opened::stream(Path::new("imu.csv"), Cursor::new(text.into_bytes())).unwrap();
        assert_eq!(opened.preview(5).unwrap().names, ["t", "a", "b"], "{line}");
    }
}

#[test]
fn a_column_of_sentences_leaves_a_table_a_table() {
    let sum = |text: &str| text.bytes().fold(0, |sum, byte| sum ^ byte);
    let sentence = |k: u32| {
        let text = format!("GPGGA,2209{k:02}.00,4007.0,N,10508.0,W,1,9,0.9,1600.0,M,-20.0,M,,");
        format!("${text}*{:02X}", sum(&text))
    };
    let format = |text: &str| {
        let stream = Cursor::new(text.as_bytes().to_vec());
        let opened = Opened::stream(Path::new("gps.csv"), stream).unwrap();
        opened.format()
    };
    let rows = |row: &dyn Fn(u32) -> String| (10..20).map(row).collect::<String>();
    let header = "t,frame,lat,lon,height,raw\n";
    let quoted = rows(&|k| format!("{k},gps,40.1,-105.1,1600,\"{}\"\n", sentence(k)));
    assert_eq!(format(&format!("{header}{quoted}")), Format::Csv);
    let plain = rows(&|k| format!("{k},gps,40.1,-105.1,1600,{}\n", sentence(k)));
    assert_eq!(format(&format!("{header}{plain}")), Format::Csv);
    // Nothing but sentences, behind a time or under a line of words.
    let stamped = rows(&|k| format!("{k},{}\n", sentence(k)));
    assert_eq!(format(&format!("t,raw\n{stamped}")), Format::Nmea);
    let bare = rows(&|k| format!("{}\n", sentence(k)));
    assert_eq!(format(&format!("GPS log, started\n{bare}")), Format::Nmea);
}

#[test]
fn times_of_a_counter_go_on_where_it_starts_again() {
    let stamp = |k: u64| (4_294_967_296 - 25_000 + 10_000 * k) % 4_294_967_296;
    let text: String = (0..6).map(|k| format!("{},{k}\n", stamp(k))).collect();
    let mut wanted = TableOptions::default();
    wanted.want_time("imu", &Column::Number(1), None, 1e-6);
    wanted.want("imu.gyro", &[Column::Number(2)]);
    let (rows, skipped) = rows(&text, &wanted);
    let times: Vec<f64> = rows.iter().map(|(_, row)| row[0]).collect();
    let expected: Vec<f64> = (0..6)
        .map(|k| 4_294_942_296.0 + 1e4 * f64::from(k))
        .collect();
    assert_eq!(times, expected);
    let restarts = skipped.restarts().unwrap();
    assert_eq!(
        (restarts.line, restarts.count, restarts.length),
        (4, 1, 4_294_967_296.0)
    );
    assert!(skipped.is_empty());
}

#[test]
fn what_a_program_says_before_its_rows_is_passed_over() {
    let table = "t,a,b,c,d,e\n1,2,3,4,0,0\n5,6,7,8,0,0\n";
    let expected = [(0, vec![3.0, 1.0]), (1, vec![7.0, 5.0])];
    for words in [
        "Ready!\n",
        "IMU found, calibrating\nDATA_START\n",
        "\nhello\n\n# note\n",
    ] {
        let text = format!("{words}{table}");
        let first = text.lines().count() as u64 - 1;
        let numbered = expected.clone().map(|(k, row)| (first + k, row));
        let (found, skipped) = rows(&text, &named(&["b", "t"]));
        assert_eq!(found, numbered, "{words}");
        assert_eq!(skipped.count(SkipKind::Text), skipped.total());
        // Without a header by number.
        let bare = text.replace("t,a,b,c,d,e\n", "");
        let (found, _) = rows(&bare, &numbered_columns());
        assert_eq!(
            found,
            expected.clone().map(|(k, row)| (first - 1 + k, row)),
            "{words}"
        );
        let mut opened =
            Opened::stream(Path::new("imu.csv"), Cursor::new(text.into_bytes())).unwrap();
        let preview = opened.preview(5).unwrap();
        assert_eq!((preview.names.len(), preview.rows.len()), (6, 2), "{words}");
    }
    // A line of units is no leading line of words, and a header with too few columns stays the header.
    let (found, skipped) = rows("t,a,b\ns,g,g\n1,2,3\n", &named(&["b", "t"]));
    assert_eq!((found.len(), skipped.count(SkipKind::Text)), (1, 1));
    assert!(message("t,a\n1,2,3\n", &named(&["a"])).contains("the header has 2"));
}

fn numbered_columns() -> TableOptions {
    numbered(&[3, 1])
}

#[test]
fn names_in_latin_1_are_read() {
    let text = b"t,w [\xb0/s],f [m/s\xb2]\n1,2,3\n";
    let mut table = from(text, &named(&["w [\u{b0}/s]", "f [m/s\u{b2}]"])).unwrap();
    assert_eq!(drain(&mut table).unwrap(), [(2, vec![2.0, 3.0])]);
    let mut opened = Opened::stream(Path::new("imu.csv"), Cursor::new(text.to_vec())).unwrap();
    assert_eq!(opened.preview(5).unwrap().names[1], "w [\u{b0}/s]");
}

#[test]
fn objects_of_json_have_names() {
    let lines = "{\"t\": 1, \"g\": {\"x\": \"2.5\"}}\n{\"t\": 2, \"g\": {\"x\": 3}}\n";
    let array = "[\n {\"t\": 1, \"g\": {\"x\": \"2.5\"}},\n {\"t\": 2, \"g\": {\"x\": 3}}\n]\n";
    for text in [lines, array] {
        let mut table = from(text.as_bytes(), &named(&["t", "g.x"])).unwrap();
        let mut row = [0.0; 2];
        let mut rows = Vec::new();
        while table.next_row(&mut row).unwrap().is_some() {
            rows.push(row);
        }
        assert_eq!(rows, [[1.0, 2.5], [2.0, 3.0]], "{text}");
    }
}

/// Rows of another sensor have blanks in all columns that are wanted: that is no defect.
#[test]
fn rows_without_anything_that_is_wanted_are_passed_over() {
    let text = "t,a,b,lat\n1,2,3,\n2,,,48\n3,4,,\n4,,,49\n5,6,7,\n";
    let mut wanted = named(&["t", "a", "b"]);
    wanted.of_one_sensor = true;
    wanted.stamp = Some(Stamp {
        place: 0,
        column: "t".into(),
        scale: 1.0,
        date: None,
    });
    let (found, skipped) = rows(text, &wanted);
    assert_eq!(found, [(2, vec![1.0, 2.0, 3.0]), (6, vec![5.0, 6.0, 7.0])]);
    assert_eq!(
        (skipped.total(), skipped.count(SkipKind::MissingField)),
        (1, 1)
    );
    let kept = TableOptions {
        keep_not_finite: true,
        ..wanted.clone()
    };
    let (found, skipped) = rows(text, &kept);
    assert_eq!((found.len(), skipped.total()), (3, 0));
    // Unless there is nothing else.
    let error = message("t,a,b,lat\n1,,,3\n2,,,4\n", &wanted);
    assert!(error.contains("2 rows with a missing field"), "{error}");
}
