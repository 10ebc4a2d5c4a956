#![no_main]

use undrift::io::Opened;
use undrift::io::imu::{ImuFormat, ImuReader};
use undrift::io::table::{Column, Table, TableOptions};
use undrift_fuzz::{imu, with_file};

libfuzzer_sys::fuzz_target!(
    // The reader catches the panics of the Parquet crate on damaged files: libFuzzer's own hook
    // would abort before. What is not caught still aborts; run its input without this hook to see it.
    init: {
        std::panic::set_hook(Box::new(|_| {}));
    },
    |data: &[u8]| {
        with_file(data, |path| {
            let three = |from: usize| [from, from + 1, from + 2].map(Column::Number);
            let format = ImuFormat::new(Some(Column::Number(1)), three(2), three(2));
            imu(ImuReader::open(path, &format));
            let preview = Opened::open(path).and_then(|mut opened| opened.preview(0));
            for name in preview.unwrap_or_default().names {
                let options = TableOptions {
                    columns: vec![("key".to_owned(), Column::Name(name))],
                    ..TableOptions::default()
                };
                read(Opened::open(path).and_then(|opened| opened.table(&options)));
            }
        });
    }
);

fn read(table: Result<Table, undrift::io::ReadError>) {
    let mut row = [f64::NAN];
    if let Ok(mut table) = table {
        while let Ok(Some(_)) = table.next_row(&mut row) {
            assert!(row[0].is_finite());
        }
    }
}
