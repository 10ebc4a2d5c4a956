//! Bounded queues between the solution and those who read it.

use std::{
    collections::VecDeque,
    io::{self, Write},
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

/// Rows that wait for a reader at most.
const MOST: usize = 4096;

/// What waits for one reader.
#[derive(Default)]
pub struct Queue {
    waiting: Mutex<Waiting>,
    changed: Condvar,
}

#[derive(Default)]
struct Waiting {
    rows: VecDeque<Arc<[u8]>>,
    dropped: u64,
    closed: bool,
    /// Its reader is gone.
    left: bool,
}

impl Queue {
    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a row, and drops the oldest where too many wait; whether there is a reader.
    fn give(&self, row: Arc<[u8]>) -> bool {
        let mut waiting = self.lock();
        if waiting.rows.len() >= MOST {
            waiting.rows.pop_front();
            waiting.dropped += 1;
        }
        waiting.rows.push_back(row);
        self.changed.notify_one();
        !waiting.left
    }

    /// The next row, waited for; `None` once it is closed and empty.
    pub fn next(&self) -> Option<Arc<[u8]>> {
        let mut waiting = self.lock();
        loop {
            if let Some(row) = waiting.rows.pop_front() {
                return Some(row);
            }
            if waiting.closed {
                return None;
            }
            let changed = self.changed.wait(waiting);
            waiting = changed.unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// All rows that wait, after at most so long; `None` once it is closed and empty.
    pub fn take(&self, wait: Duration) -> Option<VecDeque<Arc<[u8]>>> {
        let mut waiting = self.lock();
        if waiting.rows.is_empty() && !waiting.closed {
            let changed = self.changed.wait_timeout(waiting, wait);
            waiting = changed.unwrap_or_else(PoisonError::into_inner).0;
        }
        let rows = std::mem::take(&mut waiting.rows);
        (!rows.is_empty() || !waiting.closed).then_some(rows)
    }

    /// Its reader is gone.
    pub fn leave(&self) {
        self.lock().left = true;
    }

    /// Writes rows until it is closed.
    ///
    /// # Errors
    /// If they are not taken: then nobody reads any more.
    pub fn pour(&self, mut into: impl Write) -> io::Result<()> {
        let poured = (|| {
            while let Some(row) = self.next() {
                into.write_all(&row)?;
                into.flush()?;
            }
            Ok(())
        })();
        self.lock().left = poured.is_err();
        poured
    }
}

/// Gives rows to all who read.
#[derive(Default)]
pub struct Broadcast {
    queues: Mutex<Vec<Arc<Queue>>>,
    /// Rows that readers who are gone did not take.
    dropped: AtomicU64,
}

impl Broadcast {
    fn lock(&self) -> MutexGuard<'_, Vec<Arc<Queue>>> {
        self.queues.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A reader more, who gets `head` first.
    pub fn join(&self, head: Vec<u8>) -> Arc<Queue> {
        let queue = Arc::new(Queue::default());
        if !head.is_empty() {
            queue.give(head.into());
        }
        self.lock().push(queue.clone());
        queue
    }

    /// Gives a row to all.
    pub fn give(&self, row: Vec<u8>) {
        let row: Arc<[u8]> = row.into();
        self.lock().retain(|queue| {
            let read = queue.give(row.clone());
            if !read {
                self.dropped
                    .fetch_add(queue.lock().dropped, Ordering::Relaxed);
            }
            read
        });
    }

    /// Rows that were not taken in time.
    pub fn dropped(&self) -> u64 {
        let waiting = self
            .lock()
            .iter()
            .map(|queue| queue.lock().dropped)
            .sum::<u64>();
        waiting + self.dropped.load(Ordering::Relaxed)
    }

    /// Nothing more comes.
    pub fn close(&self) {
        for queue in self.lock().iter() {
            queue.lock().closed = true;
            queue.changed.notify_all();
        }
    }
}
