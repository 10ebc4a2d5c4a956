//! Logs as if they came while the vehicle drives: each piece of a file when the records that it completes hold.

use crate::{Arrival, NANOS, session};
use std::{
    io::{self, Read},
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};
use undrift_drive::drive::Drive;
use undrift_io::{Opened, ReadError};

/// Bytes that are read at once: pieces end at multiples of it.
const PIECE: usize = 64;
/// Time of the first arrival \[ns\]: the beginning, with room before it.
const START: f64 = 1e9;

/// Reads bytes a piece at a time, and says how far.
struct Pieces {
    bytes: Arc<[u8]>,
    at: Arc<AtomicUsize>,
}

impl Read for Pieces {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let from = self.at.load(Ordering::Relaxed);
        let to = (from + PIECE.min(buffer.len())).min(self.bytes.len());
        if let (Some(into), Some(part)) = (buffer.get_mut(..to - from), self.bytes.get(from..to)) {
            into.copy_from_slice(part);
        }
        self.at.store(to, Ordering::Relaxed);
        Ok(to - from)
    }
}

/// The arrivals of a drive's own logs, in order of time: `logs` are its tables with the number of their source, of which `bytes` has
/// what its file holds, decompressed.
///
/// # Errors
/// If a log cannot be read.
pub fn arrivals(
    drive: &Drive,
    bytes: &[Arc<[u8]>],
    logs: &[(String, usize)],
) -> Result<Vec<Arrival>, ReadError> {
    let mut pieces = Vec::new();
    for (number, bytes) in bytes.iter().enumerate() {
        // Where a record is complete, and its time.
        let mut marks = Vec::new();
        for (table, _) in logs.iter().filter(|(_, source)| *source == number) {
            marks.extend(marks_of(drive, table, bytes)?);
        }
        marks.sort_by(|a: &(usize, f64), b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let (mut from, mut latest) = (0, f64::NEG_INFINITY);
        for (k, (end, time)) in marks.iter().enumerate() {
            latest = latest.max(*time);
            if marks.get(k + 1).is_some_and(|(next, _)| next == end) {
                continue;
            }
            pieces.push((
                latest,
                number,
                bytes.get(from..*end).unwrap_or_default().to_vec(),
            ));
            from = *end;
        }
        let rest = bytes.get(from..).unwrap_or_default();
        if !rest.is_empty() && latest.is_finite() {
            pieces.push((latest, number, rest.to_vec()));
        }
    }
    // Fixes before the samples that end with them, as in a log.
    pieces.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    let first = pieces.first().map_or(0.0, |(time, ..)| *time);
    let arrival = |(time, source, bytes): (f64, usize, Vec<u8>)| Arrival {
        source,
        at: (START + NANOS * (time - first)).round() as u64,
        bytes,
    };
    Ok(pieces.into_iter().map(arrival).collect())
}

/// Where each record of a log is complete, and its time \[s\].
fn marks_of(drive: &Drive, table: &str, bytes: &Arc<[u8]>) -> Result<Vec<(usize, f64)>, ReadError> {
    let at = Arc::new(AtomicUsize::new(0));
    let pieces = Pieces {
        bytes: bytes.clone(),
        at: at.clone(),
    };
    let opened = Opened::live(table.as_ref(), bytes, pieces)?;
    let records = session::records(drive, table, opened)?;
    records
        .map(|record| Ok((at.load(Ordering::Relaxed), record?.time())))
        .collect()
}

/// Gives arrivals at a pace: 1 is their own, 0 as fast as they are taken.
pub struct Paced<I> {
    arrivals: I,
    pace: f64,
    begin: Instant,
    first: Option<u64>,
}

impl<I: Iterator<Item = Result<Arrival, ReadError>>> Paced<I> {
    /// The arrivals at a pace.
    pub fn new(arrivals: I, pace: f64) -> Self {
        Self {
            arrivals,
            pace,
            begin: Instant::now(),
            first: None,
        }
    }
}

impl<I: Iterator<Item = Result<Arrival, ReadError>>> Iterator for Paced<I> {
    type Item = Result<Arrival, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.arrivals.next()?;
        if let Ok(arrival) = &next
            && self.pace > 0.0
        {
            let since = arrival
                .at
                .saturating_sub(*self.first.get_or_insert(arrival.at));
            let due = Duration::from_secs_f64(since as f64 / NANOS / self.pace);
            thread::sleep(due.saturating_sub(self.begin.elapsed()));
        }
        Some(next)
    }
}
