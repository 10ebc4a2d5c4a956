//! Arrays of two dimensions that `numpy.save` writes, `.npy`: each row a row, without names.

const MAGIC: &[u8] = b"\x93NUMPY";

pub(super) fn is_there(start: &[u8]) -> bool {
    start.starts_with(MAGIC)
}

pub(super) fn table(bytes: &[u8]) -> Option<String> {
    let version = bytes.get(MAGIC.len())?;
    let (length, from) = match version {
        1 => (
            u64::from(u16::from_le_bytes(bytes.get(8..10)?.try_into().ok()?)),
            10,
        ),
        _ => (
            u64::from(u32::from_le_bytes(bytes.get(8..12)?.try_into().ok()?)),
            12,
        ),
    };
    let (header, data) = bytes
        .get(from..)?
        .split_at_checked(usize::try_from(length).ok()?)?;
    let header = std::str::from_utf8(header).ok()?;
    let behind = |key: &str| Some(header.split_once(key)?.1.trim_start_matches([':', ' ']));
    let kind = behind("'descr'")?.split('\'').nth(1)?;
    let by_columns = behind("'fortran_order'")?.starts_with("True");
    let shape = behind("'shape'")?.strip_prefix('(')?.split_once(')')?.0;
    let shape = shape
        .split(',')
        .map(|size| size.trim().parse::<usize>().ok());
    let (rows, columns) = match *Vec::from_iter(shape).as_slice() {
        [Some(rows), Some(columns)] => (rows, columns),
        _ => return None,
    };
    let number = number(kind)?;
    let size: usize = kind.get(2..)?.parse().ok()?;
    let mut text = String::new();
    for row in 0..rows {
        for column in 0..columns {
            let at = match by_columns {
                true => column * rows + row,
                false => row * columns + column,
            };
            // What is cut off ends the rows.
            let Some(bytes) = data.get(at * size..(at + 1) * size) else {
                return Some(text);
            };
            let end = if column + 1 == columns { '\n' } else { ',' };
            text += &format!("{}{end}", number(bytes));
        }
    }
    Some(text)
}

/// How the numbers of a kind are read.
fn number(kind: &str) -> Option<fn(&[u8]) -> f64> {
    fn of<const N: usize>(bytes: &[u8]) -> [u8; N] {
        bytes.try_into().unwrap_or([0; N])
    }
    Some(match kind {
        "<f8" => |bytes| f64::from_le_bytes(of(bytes)),
        "<f4" => |bytes| f64::from(f32::from_le_bytes(of(bytes))),
        "<i8" => |bytes| i64::from_le_bytes(of(bytes)) as f64,
        "<i4" => |bytes| f64::from(i32::from_le_bytes(of(bytes))),
        "<i2" => |bytes| f64::from(i16::from_le_bytes(of(bytes))),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn saved(kind: &str, order: &str, data: &[u8]) -> Vec<u8> {
        let header =
            format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': (2, 3), }}\n");
        let length = u16::try_from(header.len()).unwrap().to_le_bytes();
        [MAGIC, &[1, 0], &length, header.as_bytes(), data].concat()
    }

    #[test]
    fn rows_by_either_order() {
        let doubles = [1.5_f64, 2.0, 3.0, 4.0, 5.0, -6.25];
        let bytes = doubles.map(f64::to_le_bytes).concat();
        let whole = saved("<f8", "False", &bytes);
        assert!(is_there(&whole));
        assert_eq!(table(&whole).unwrap(), "1.5,2,3\n4,5,-6.25\n");
        let by_columns = saved("<f8", "True", &bytes);
        assert_eq!(table(&by_columns).unwrap(), "1.5,3,5\n2,4,-6.25\n");
        let shorts = [1_i16, 2, 3, 4, 5, -6].map(i16::to_le_bytes).concat();
        assert_eq!(
            table(&saved("<i2", "False", &shorts)).unwrap(),
            "1,2,3\n4,5,-6\n"
        );
        assert_eq!(table(&saved("|O", "False", &shorts)), None);
    }
}
