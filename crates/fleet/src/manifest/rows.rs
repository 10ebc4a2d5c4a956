//! A table of logs, a row each: comma-separated values after RFC 4180, or with semicolons or tabs.

/// Rows of text under a header.
pub(super) struct LogTable {
    pub header: Vec<String>,
    /// Each with its line in the file, counted from 1.
    pub rows: Vec<(usize, Vec<String>)>,
}

/// Splits a text into rows; empty lines are skipped. `Err` has the line and what is wrong there.
pub(super) fn read(text: &str) -> Result<LogTable, (usize, String)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let first = text.lines().next().unwrap_or_default();
    let often = |c: &char| first.matches(*c).count();
    // Of several that are as frequent, the last.
    let delimiter = ['\t', ';', ','].into_iter().max_by_key(often);
    let mut rows = split(text, delimiter.unwrap_or(','))?.into_iter();
    let Some((_, header)) = rows.next() else {
        return Err((
            1,
            "the table is empty; its first row names the columns".into(),
        ));
    };
    let rows: Vec<_> = rows.collect();
    let uneven = rows.iter().find(|(_, row)| row.len() != header.len());
    if let Some((line, row)) = uneven {
        let message = format!(
            "{} fields under {} column names; put fields that contain the delimiter into quotes",
            row.len(),
            header.len()
        );
        return Err((*line, message));
    }
    Ok(LogTable { header, rows })
}

/// Rows, each with the line that it begins in.
type Numbered = Vec<(usize, Vec<String>)>;

fn split(text: &str, delimiter: char) -> Result<Numbered, (usize, String)> {
    let mut rows = Vec::new();
    let (mut row, mut field) = (Vec::new(), String::new());
    let (mut line, mut start) = (1, 1);
    // Line of the quote that is open.
    let mut quoted: Option<usize> = None;
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        line += usize::from(c == '\n');
        match c {
            '"' if quoted.is_some() && chars.peek() == Some(&'"') => {
                field.push('"');
                chars.next();
            }
            '"' if quoted.is_some() => quoted = None,
            c if quoted.is_some() => field.push(c),
            '"' if field.trim().is_empty() => {
                field.clear();
                quoted = Some(line);
            }
            c if c == delimiter => row.push(take(&mut field)),
            '\n' => {
                row.push(take(&mut field));
                finish(&mut rows, start, std::mem::take(&mut row));
                start = line;
            }
            c => field.push(c),
        }
    }
    if let Some(line) = quoted {
        return Err((line, "a quote is opened but not closed".into()));
    }
    row.push(take(&mut field));
    finish(&mut rows, start, row);
    Ok(rows)
}

fn take(field: &mut String) -> String {
    std::mem::take(field).trim().to_owned()
}

fn finish(rows: &mut Vec<(usize, Vec<String>)>, line: usize, row: Vec<String>) {
    if row.iter().any(|field| !field.is_empty()) {
        rows.push((line, row));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_delimiters_and_line_ends() {
        let rows = read("\u{feff}unit; note\r\n\r\nSN1;\"a \"\"b\"\";\nc\"\r\n SN2 ;\n").unwrap();
        assert_eq!(rows.header, ["unit", "note"]);
        let cells = |row: [&str; 2]| row.map(str::to_owned).to_vec();
        assert_eq!(
            rows.rows,
            [(3, cells(["SN1", "a \"b\";\nc"])), (5, cells(["SN2", ""]))]
        );
    }

    #[test]
    fn what_is_no_table_is_refused_with_its_line() {
        let wrong = |text| read(text).err().unwrap();
        assert_eq!(wrong("").0, 1);
        assert_eq!(wrong("a,b\n1,2\n1,2,3\n").0, 3);
        assert_eq!(wrong("a,b\n1,\"2\n3,4\n").0, 2);
    }
}
