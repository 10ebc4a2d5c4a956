//! Pointers from C, checked as far as they can be; what is read and written is copied, so alignment
//! matters for the filter alone.

use crate::status::Status;

/// A copy of what `from` points to.
///
/// # Safety
/// `from` is null or points to a `T`.
pub(crate) unsafe fn read<T: Copy>(from: *const T) -> Result<T, Status> {
    if from.is_null() {
        return Err(Status::NullPointer);
    }
    // SAFETY: not null, so it points to a T; every T here is made of numbers, for which any bits will do.
    Ok(unsafe { from.read_unaligned() })
}

/// Checks that `at` points to something whose tag is this one, `tag` being where it has it.
///
/// # Safety
/// `at` is null or points to memory of a `T`'s size, within which `tag` leads to a number.
pub(crate) unsafe fn check_tag<T>(
    at: *const T,
    tag: impl FnOnce(*const T) -> *const u64,
    expected: u64,
) -> Result<(), Status> {
    if at.is_null() {
        return Err(Status::NullPointer);
    }
    if !at.is_aligned() {
        return Err(Status::Misaligned);
    }
    // SAFETY: aligned memory of a T's size; only the tag is looked at, and any bits make one.
    if unsafe { tag(at).read() } != expected {
        return Err(Status::NotInitialised);
    }
    Ok(())
}

/// A copy of what `from` points to, or `instead` if it is null.
///
/// # Safety
/// As [`read`].
pub(crate) unsafe fn read_or<T: Copy>(from: *const T, instead: T) -> T {
    // SAFETY: passed on.
    unsafe { read(from) }.unwrap_or(instead)
}

/// Puts `value` where `to` points to.
///
/// # Safety
/// `to` is null or points to memory for a `T`.
pub(crate) unsafe fn write<T: Copy>(to: *mut T, value: T) -> Result<(), Status> {
    if to.is_null() {
        return Err(Status::NullPointer);
    }
    // SAFETY: not null, so there is memory for a T.
    unsafe { to.write_unaligned(value) };
    Ok(())
}

/// The first `M` of the `count` numbers at `from`, the rest zero; more are too many.
///
/// # Safety
/// `from` points to `count` numbers, or is null.
pub(crate) unsafe fn numbers<const M: usize>(
    from: *const f64,
    count: usize,
) -> Result<[f64; M], Status> {
    if count > M {
        return Err(Status::TooManyStates);
    }
    let mut copy = [0.0; M];
    for (i, slot) in copy.iter_mut().enumerate().take(count) {
        // SAFETY: null, or i is below the count that there are.
        *slot = unsafe { read(if from.is_null() { from } else { from.add(i) }) }?;
    }
    Ok(copy)
}

/// That every number is finite.
pub(crate) fn finite<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> Result<(), Status> {
    if numbers.into_iter().all(|number| number.is_finite()) {
        Ok(())
    } else {
        Err(Status::NotFinite)
    }
}

/// That every number is finite and not negative.
pub(crate) fn not_negative<'a>(
    numbers: impl IntoIterator<Item = &'a f64> + Clone,
) -> Result<(), Status> {
    finite(numbers.clone())?;
    if numbers.into_iter().all(|number| *number >= 0.0) {
        Ok(())
    } else {
        Err(Status::OutOfRange)
    }
}
