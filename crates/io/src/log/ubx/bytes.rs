//! Little-endian numbers of a payload; `None` beyond its end.

fn array<const N: usize>(payload: &[u8], at: usize) -> Option<[u8; N]> {
    payload.get(at..)?.first_chunk().copied()
}

pub(super) fn u1(payload: &[u8], at: usize) -> Option<u8> {
    payload.get(at).copied()
}

pub(super) fn u2(payload: &[u8], at: usize) -> Option<u16> {
    array(payload, at).map(u16::from_le_bytes)
}

pub(super) fn u4(payload: &[u8], at: usize) -> Option<u32> {
    array(payload, at).map(u32::from_le_bytes)
}

pub(super) fn i1(payload: &[u8], at: usize) -> Option<i8> {
    array(payload, at).map(i8::from_le_bytes)
}

pub(super) fn i4(payload: &[u8], at: usize) -> Option<i32> {
    array(payload, at).map(i32::from_le_bytes)
}

pub(super) fn r4(payload: &[u8], at: usize) -> Option<f32> {
    array(payload, at).map(f32::from_le_bytes)
}

pub(super) fn r8(payload: &[u8], at: usize) -> Option<f64> {
    array(payload, at).map(f64::from_le_bytes)
}
