//! Sources that fail while the vehicle drives: what is said, and how far off the solution is after it.

use super::*;
use undrift_engine::RestartCause;

/// A row of a log on its way.
#[derive(Clone)]
struct Line {
    /// When it comes \[s\].
    at: f64,
    source: usize,
    /// Its stamp \[s\].
    stamp: f64,
    values: Vec<f64>,
}

/// What a run with a fault gave.
struct Outcome {
    seen: Seen,
    /// Time \[s\], horizontal error over its σ at each row that has a truth.
    errors: Vec<(f64, f64)>,
}

impl Outcome {
    /// Share of the rows from a time \[s\] on that are inside 3 σ.
    fn inside(&self, from: f64) -> f64 {
        let after = self.errors.iter().filter(|(time, _)| *time >= from);
        let (inside, all) = after.fold((0, 0), |(inside, all), (_, error)| {
            (inside + u32::from(*error < 3.0), all + 1)
        });
        f64::from(inside) / f64::from(all.max(1))
    }

    fn events(&self) -> impl Iterator<Item = &Event> {
        self.seen.notices.iter().filter_map(|notice| match notice {
            Notice::Navigation(event) => Some(event),
            _ => None,
        })
    }

    /// What was added to the times of the IMU because its clock was set \[s\].
    fn set(&self) -> Vec<f64> {
        let set = self.seen.notices.iter().filter_map(|notice| match notice {
            Notice::ClockSet(table, by) if table == "imu" => Some(*by),
            _ => None,
        });
        set.collect()
    }
}

/// A drive whose rows are changed on their way; `None` loses one.
fn with_fault(seed: u64, length: f64, change: impl Fn(Line) -> Option<Line>) -> Outcome {
    let folder = folder_of(seed, length);
    let mut arrivals = Vec::new();
    for (source, name) in ["imu.csv", "gnss.csv"].into_iter().enumerate() {
        let text = std::fs::read_to_string(folder.path().join(name)).unwrap();
        let (header, rows) = text.split_once('\n').unwrap();
        arrivals.push((0.0, source, format!("{header}\n")));
        for row in rows.lines() {
            let mut values = row.split(',').map(|value| value.parse().unwrap());
            let stamp: f64 = values.next().unwrap();
            let line = Line {
                // A fix takes a tenth of a second.
                at: stamp + 0.1 * source as f64,
                source,
                stamp,
                values: values.collect(),
            };
            if let Some(line) = change(line) {
                let values = line.values.iter().map(|value| format!(",{value}"));
                let row = format!("{}{}\n", line.stamp, values.collect::<String>());
                arrivals.push((line.at, line.source, row));
            }
        }
    }
    arrivals.sort_by(|a, b| a.0.total_cmp(&b.0));
    let arrivals: Vec<Arrival> = arrivals
        .into_iter()
        .map(|(at, source, row)| Arrival {
            source,
            at: ((1.0 + at) * 1e9) as u64,
            bytes: row.into_bytes(),
        })
        .collect();
    let seen = run(&mut session(folder.path(), None), &arrivals);
    let truth = simulated(seed, length).truth;
    let mut truth = truth.iter().peekable();
    let mut errors = Vec::new();
    for row in &seen.rows {
        while truth
            .next_if(|truth| truth.time < row.time - 5e-3)
            .is_some()
        {}
        let Some(truth) = truth.peek().filter(|truth| truth.time < row.time + 5e-3) else {
            continue;
        };
        let apart = truth.position.ned_to(&row.position);
        let std = row.nav_std[0].hypot(row.nav_std[1]);
        errors.push((row.time, apart.x.hypot(apart.y) / std));
    }
    Outcome { seen, errors }
}

#[test]
fn five_minutes_unplugged_it_is_aligned_again() {
    let lost = |line: &Line| line.source == 0 && (100.0..400.0).contains(&line.at);
    let outcome = with_fault(5, 500.0, |line| (!lost(&line)).then_some(line));
    let again = |event: &&Event| matches!(event, Event::AlignsAgain(_, RestartCause::NoSamples));
    assert!(
        outcome.events().any(|event| again(&event)),
        "{:?}",
        outcome.seen.notices
    );
    let resumed = outcome.events().find_map(|event| match event {
        Event::Resumed(time) => Some(*time),
        _ => None,
    });
    assert!(
        resumed.is_some_and(|time| time < 450.0),
        "{:?}",
        outcome.seen.notices
    );
    let last = outcome.seen.rows.last().unwrap();
    assert!(
        last.time > 499.0 && last.nav_std[0] < 2.0,
        "{:?}",
        last.nav_std
    );
    assert!(outcome.inside(460.0) > 0.95, "{}", outcome.inside(460.0));
}

/// A step forward looks like a gap, one back like samples that come again: when they arrive shows that it is neither.
#[test]
fn a_clock_that_steps_by_a_second_is_followed() {
    for step in [1.0, -1.0] {
        let outcome = with_fault(6, 200.0, |mut line| {
            if line.source == 0 && line.at >= 120.0 {
                line.stamp += step;
            }
            Some(line)
        });
        let set = outcome.set();
        assert!(
            set.len() == 1 && (set[0] + step).abs() < 0.1,
            "{set:?} {:?}",
            outcome.seen.notices
        );
        let last = outcome.seen.rows.last().unwrap();
        assert!((last.time - 199.96).abs() < 0.2, "{}", last.time);
        let others =
            |notice: &Notice| matches!(notice, Notice::ClockSet(table, _) if table != "imu");
        assert!(
            !outcome.seen.notices.iter().any(others),
            "{:?}",
            outcome.seen.notices
        );
        let strange = |event: &Event| matches!(event, Event::Rejected(_) | Event::Doubted(_));
        assert!(!outcome.events().any(strange), "{:?}", outcome.seen.notices);
        assert!(outcome.inside(120.0) > 0.95, "{}", outcome.inside(120.0));
    }
}

/// Off for three seconds, then its clock begins at 0 and its biases are others, by as much as such sensors have them.
#[test]
fn an_imu_that_restarts_with_another_bias_is_followed() {
    let outcome = with_fault(7, 260.0, |mut line| {
        if line.source == 0 && line.at >= 120.0 {
            line.stamp -= 122.98;
            line.values[..3].iter_mut().for_each(|rate| *rate += 0.01);
            line.values[3..].iter_mut().for_each(|force| *force += 0.2);
        }
        let lost = line.source == 0 && (120.0..123.0).contains(&line.at);
        (!lost).then_some(line)
    });
    let set = outcome.set();
    assert!(set.len() == 1 && (set[0] - 122.98).abs() < 0.1, "{set:?}");
    assert!(outcome.seen.rows.last().unwrap().time > 259.0);
    assert!(outcome.inside(200.0) > 0.9, "{}", outcome.inside(200.0));
}

#[test]
fn a_receiver_that_is_stuck_is_not_followed() {
    let stuck = std::sync::Mutex::new(None);
    let outcome = with_fault(8, 200.0, |mut line| {
        if line.source == 1 && (120.0..140.0).contains(&line.stamp) {
            let mut stuck = stuck.lock().unwrap();
            line.values = stuck.get_or_insert(line.values).clone();
        }
        Some(line)
    });
    let frozen = outcome
        .events()
        .any(|event| matches!(event, Event::Rejected(fixes) if fixes.frozen));
    assert!(frozen, "{:?}", outcome.seen.notices);
    assert!(outcome.inside(122.0) > 0.9, "{}", outcome.inside(122.0));
}

#[test]
fn when_both_are_silent_it_goes_on_after_it() {
    let outcome = with_fault(9, 200.0, |line| {
        (!(120.0..130.0).contains(&line.at)).then_some(line)
    });
    let last = outcome.seen.rows.last().unwrap();
    assert!(last.time > 199.0 && last.nav_std[0] < 2.0);
    // Where nothing came there is no row, then the σ has grown.
    let after = outcome
        .seen
        .rows
        .iter()
        .find(|row| row.time > 130.5)
        .unwrap();
    let before = outcome
        .seen
        .rows
        .iter()
        .rfind(|row| row.time < 119.5)
        .unwrap();
    assert!(after.nav_std[0] > before.nav_std[0]);
    assert!(outcome.inside(131.0) > 0.95, "{}", outcome.inside(131.0));
}
