use super::*;

/// Outages of 20 s between fixes from 100 s to 210 s: 80 s of room from 10 s after the first fix on.
fn of(plan: &Schedule) -> Result<Vec<f64>, ScheduleError> {
    let outages = schedule(plan, 20.0, 100.0, 210.0)?;
    assert!(
        outages
            .iter()
            .all(|outage| outage.end == outage.start + 20.0)
    );
    Ok(outages.iter().map(|outage| outage.start).collect())
}

fn count(start: f64, count: usize) -> Schedule {
    Schedule::Count { start, count }
}

fn every(every: f64, count: Option<usize>) -> Schedule {
    let start = 10.0;
    Schedule::Every {
        start,
        every,
        count,
    }
}

#[test]
fn so_many_lie_evenly_from_the_start_to_the_last_fix() {
    assert_eq!(of(&count(10.0, 1)), Ok(vec![110.0]));
    assert_eq!(of(&count(10.0, 2)), Ok(vec![110.0, 190.0]));
    assert_eq!(
        of(&count(10.0, 5)),
        Ok(vec![110.0, 130.0, 150.0, 170.0, 190.0])
    );
    assert_eq!(of(&count(0.0, 3)), Ok(vec![100.0, 145.0, 190.0]));
    // Six of 20 s are 4 s too close.
    let overlap = ScheduleError::Overlap {
        count: 6,
        length: 20.0,
    };
    assert_eq!(of(&count(10.0, 6)), Err(overlap));
    assert_eq!(of(&count(10.0, 0)), Err(ScheduleError::Zero));
    assert_eq!(of(&count(10.0, 100_001)), Err(ScheduleError::TooMany));
}

#[test]
fn one_a_span_is_as_many_as_end_with_the_fixes() {
    assert_eq!(of(&every(40.0, None)), Ok(vec![110.0, 150.0, 190.0]));
    assert_eq!(of(&every(40.1, None)), Ok(vec![110.0, 150.1]));
    assert_eq!(of(&every(81.0, None)), Ok(vec![110.0]));
    // One after the other without a gap.
    assert_eq!(of(&every(20.0, None)).unwrap().len(), 5);
    let overlap = |count| ScheduleError::Overlap {
        count,
        length: 20.0,
    };
    assert_eq!(of(&every(19.9, None)), Err(overlap(5)));
    assert_eq!(of(&every(40.0, Some(2))), Ok(vec![110.0, 150.0]));
    assert_eq!(of(&every(40.0, Some(3))), Ok(vec![110.0, 150.0, 190.0]));
    assert_eq!(
        of(&every(40.0, Some(4))),
        Err(ScheduleError::TooFew { fits: 3, count: 4 })
    );
    assert_eq!(of(&every(40.0, Some(0))), Err(ScheduleError::Zero));
    assert_eq!(of(&every(40.0, Some(100_001))), Err(ScheduleError::TooMany));
    for bad in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(of(&every(bad, None)), Err(ScheduleError::Every(bad)));
    }
}

#[test]
fn no_more_than_a_hundred_thousand_are_laid_out() {
    let lay = |room: f64| {
        let plan = Schedule::Every {
            start: 0.0,
            every: 1.0,
            count: None,
        };
        schedule(&plan, 1.0, 0.0, room + 1.0).map(|outages| outages.len())
    };
    assert_eq!(lay(99_999.0), Ok(100_000));
    assert_eq!(lay(100_000.0), Err(ScheduleError::TooMany));
}

#[test]
fn only_one_that_fits_is_too_few_for_two_and_not_an_overlap() {
    let plan = Schedule::Every {
        start: 85.0,
        every: 10.0,
        count: Some(2),
    };
    assert_eq!(of(&plan), Err(ScheduleError::TooFew { fits: 1, count: 2 }));
}

#[test]
fn a_start_needs_room_for_one_before_the_last_fix() {
    assert_eq!(of(&count(90.0, 1)), Ok(vec![190.0]));
    let no_room = ScheduleError::NoRoom {
        length: 20.0,
        start: 90.5,
        end: 110.0,
    };
    assert_eq!(of(&count(90.5, 1)), Err(no_room));
    let after = ScheduleError::StartAfterFixes {
        start: 110.0,
        end: 110.0,
    };
    assert_eq!(of(&count(110.0, 1)), Err(after));
    assert!(matches!(
        of(&count(109.9, 1)),
        Err(ScheduleError::NoRoom { .. })
    ));
    assert_eq!(of(&count(-0.1, 1)), Err(ScheduleError::Start(-0.1)));
    assert!(matches!(
        of(&count(f64::NAN, 1)),
        Err(ScheduleError::Start(_))
    ));
    for length in [0.0, -1.0, f64::INFINITY] {
        let error = schedule(&count(0.0, 1), length, 100.0, 210.0).unwrap_err();
        assert_eq!(error, ScheduleError::Length(length));
    }
}

#[test]
fn given_times_are_put_in_order_and_have_to_lie_within_the_fixes() {
    let at = |times: &[f64]| of(&Schedule::At(times.to_vec()));
    assert_eq!(at(&[150.0, 100.0, 190.0]), Ok(vec![100.0, 150.0, 190.0]));
    // A microsecond for rounding.
    assert!(at(&[190.000_000_9]).is_ok());
    for time in [190.000_002, 99.9] {
        let beyond = ScheduleError::BeyondFixes {
            length: 20.0,
            time,
            first: 100.0,
            last: 210.0,
        };
        assert_eq!(at(&[150.0, time]), Err(beyond));
    }
    assert!(at(&[f64::NAN]).is_err());
    assert!(at(&[120.0, 140.0]).is_ok());
    let overlap = ScheduleError::Overlap {
        count: 2,
        length: 20.0,
    };
    assert_eq!(at(&[120.0, 139.9]), Err(overlap));
    let plan = Schedule::At(vec![100.0]);
    let longer = ScheduleError::LongerThanFixes {
        length: 111.0,
        span: 110.0,
    };
    assert_eq!(schedule(&plan, 111.0, 100.0, 210.0), Err(longer));
    assert!(schedule(&plan, 110.0, 100.0, 210.0).is_ok());
}

#[test]
fn times_are_asked_for_before_a_span_and_a_span_before_a_number() {
    let times = Some(vec![5.0]);
    let asked = Schedule::asked(times, Some(40.0), Some(2), Some(10.0));
    assert_eq!(asked, Some(Schedule::At(vec![5.0])));
    assert_eq!(
        Schedule::asked(None, Some(40.0), Some(2), Some(10.0)),
        Some(every(40.0, Some(2)))
    );
    assert_eq!(
        Schedule::asked(None, Some(40.0), None, Some(10.0)),
        Some(every(40.0, None))
    );
    assert_eq!(
        Schedule::asked(None, None, Some(2), Some(10.0)),
        Some(count(10.0, 2))
    );
    assert_eq!(Schedule::asked(None, None, None, Some(10.0)), None);
}

/// A third of the time without GNSS; the first outage after a minute, sooner in a short log.
#[test]
fn the_usual_outages_fill_the_log() {
    let usual = |length, start, span| Schedule::usual(length, start, span);
    let every = |start: f64, every: f64| Schedule::Every {
        start,
        every,
        count: None,
    };
    assert_eq!(usual(10.0, None, 600.0), every(60.0, 30.0));
    assert_eq!(usual(10.0, None, 90.0), every(30.0, 30.0));
    assert_eq!(usual(30.0, Some(5.0), 90.0), every(5.0, 90.0));
    // A number without a start begins after a minute.
    let asked = Schedule::asked(None, None, Some(2), None);
    let (start, count) = (FIRST, 2);
    assert_eq!(asked, Some(Schedule::Count { start, count }));
}
