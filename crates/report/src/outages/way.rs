//! Where GNSS was cut, and where the models went.

use crate::{
    Figure, Panel, PlotAxis, Section, Series,
    numbers::get,
    parts::{Clock, Run, grouped, model_colour, model_pattern, on_the_ground, origin},
};
use undrift_results::{Outages, Track};

/// A way over the ground: time, and there east and north.
type Way = Vec<(f64, (f64, f64))>;

/// The ground track with its outages, one panel for each drive.
pub(crate) fn way(runs: &[Run<'_, Outages>]) -> Option<Section> {
    section(runs, false)
}

/// The same with every model's way through the outages.
pub(crate) fn models_way(runs: &[Run<'_, Outages>]) -> Option<Section> {
    section(runs, true)
}

fn section(runs: &[Run<'_, Outages>], models: bool) -> Option<Section> {
    let mut drawn: Vec<&Run<'_, Outages>> = Vec::new();
    for run in runs {
        let (track, cuts) = (&run.1.series.track, &run.1.outages);
        let same =
            |other: &&Run<'_, Outages>| other.1.series.track == *track && other.1.outages == *cuts;
        if !track.time_s.is_empty() && !drawn.iter().any(same) {
            drawn.push(run);
        }
    }
    let ways = models && drawn.iter().any(|(_, run)| !run.series.ways.is_empty());
    let panels = drawn.iter().map(|(name, run)| panel(name, run, ways));
    let caption = match ways {
        true => {
            "Ground track from the start, to scale; without GNSS in orange, and each model's way through the outages: zoom in to tell them apart. Models whose ways are apart by less than 5 % of their drift are one line."
        }
        false => "Ground track from the start, to scale; without GNSS in orange.",
    };
    let figure = Figure::block("trajectory", caption, drawn.len().min(2), panels);
    let cuts = drawn
        .iter()
        .map(|(_, run)| run.outages.len())
        .sum::<usize>();
    Some(Section::new("Where GNSS was cut", figure)?.noted(format!("{cuts} outages")))
}

fn panel(name: &str, run: &Outages, ways: bool) -> Panel {
    let track = &run.series.track;
    let origin = origin(track);
    let clock = Clock::starting(run.outages.first().map_or(0.0, |cut| cut.start_s.0));
    let on_clock = |track: &Track| -> Way {
        let way = on_the_ground(track, origin.as_ref()).into_iter();
        way.map(|(time, place)| (clock.at(time), place)).collect()
    };
    let points = on_clock(track);
    let panel = Panel::new(name, PlotAxis::new("east [m]"), PlotAxis::new("north [m]"));
    // A simulated drive was nowhere.
    let real = origin.filter(|_| run.drive.simulated.is_none());
    let panel = panel.to_scale().georeferenced(real);
    let mut panel = panel.over_time(clock.zero());
    panel.add(Series::line("driven", 1, Vec::new()).on_map(&points));
    for (at, cut) in run.outages.iter().enumerate() {
        let from = clock.at(cut.start_s.0);
        let to = from + cut.length_s.0;
        let inside = points.iter().filter(|(t, _)| from <= *t && *t <= to);
        let name = if at == 0 { "without GNSS" } else { "" };
        let inside: Way = inside.copied().collect();
        panel.add(Series::thick(name, 6, Vec::new()).on_map(&inside));
    }
    if ways {
        let starts = run.outages.iter().map(|cut| clock.at(cut.start_s.0));
        for line in of_models(run, on_clock, &Vec::from_iter(starts)) {
            panel.add(line);
        }
    }
    let start = points.first().map(|p| p.1);
    panel.add(Series::dots("start", 0, Vec::from_iter(start)));
    panel
}

/// How far two models' ways may be apart, in shares of their drift, and still be drawn as one.
const ONE_WAY: f64 = 0.05;

/// The models' ways, broken between the outages.
fn of_models(run: &Outages, on_clock: impl Fn(&Track) -> Way, starts: &[f64]) -> Vec<Series> {
    let known = run.order.iter().enumerate();
    let ways = known.filter_map(|(at, name)| {
        let way = broken(on_clock(run.series.ways.get(name)?), starts);
        let drift = run
            .models
            .get(name)
            .map(|errors| get(&errors.rms, "horizontal_m"));
        Some((name.as_str(), model_colour(name, at), way, drift?))
    });
    let ways: Vec<(&str, usize, Way, f64)> = ways.collect();
    let groups = grouped(ways.len(), |a, b| {
        let ((_, _, a, drift), (_, _, b, other)) = (&ways[a], &ways[b]);
        let near = |p: &(f64, f64), q: &(f64, f64)| {
            let apart = (p.0 - q.0).hypot(p.1 - q.1);
            apart.is_nan() || apart <= ONE_WAY * drift.min(*other)
        };
        a.len() == b.len() && a.iter().zip(b).all(|(p, q)| near(&p.1, &q.1))
    });
    let line = |group: Vec<usize>| {
        let names: Vec<&str> = group.iter().map(|at| ways[*at].0).collect();
        let (name, colour, way, _) = &ways[group[group.len() - 1]];
        let line = Series::line(&names.join(" = "), *colour, Vec::new()).on_map(way);
        line.pattern(model_pattern(name))
    };
    groups.into_iter().map(line).collect()
}

/// A way with a gap before each outage.
fn broken(way: Way, starts: &[f64]) -> Way {
    let mut starts = starts.iter().peekable();
    let mut out = Way::with_capacity(way.len() + starts.len());
    for (time, place) in way {
        let mut begins = false;
        while starts.next_if(|start| **start <= time).is_some() {
            begins = true;
        }
        if let Some((last, _)) = out.last().copied().filter(|_| begins) {
            out.push((f64::midpoint(last, time), (f64::NAN, f64::NAN)));
        }
        out.push((time, place));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::earth::Geodetic;
    use undrift_results::{Cut, ModelErrors, Numbers};

    #[test]
    fn a_simulated_drive_has_no_place() {
        let mut run = Outages::default();
        run.series.track.lat_deg.push(45.0.into());
        run.series.track.lon_deg.push(7.0.into());
        let real = panel("", &run, false).origin;
        assert_eq!(real, Some(Geodetic::from_degrees(45.0, 7.0, 0.0)));
        run.drive.simulated = Some("a car".into());
        assert_eq!(panel("", &run, false).origin, None);
    }

    #[test]
    fn models_on_one_way_are_one_line_broken_between_outages() {
        let origin = Geodetic::from_degrees(45.0, 7.0, 0.0);
        let way = |apart: f64| {
            let mut track = Track::default();
            for time in [10.0, 11.0, 20.0, 21.0] {
                track.time_s.push(time.into());
                track.lat_deg.push(45.0.into());
                // An east of 1e-5 degrees is 0.79 m.
                track.lon_deg.push((7.0 + 1e-5 * (time + apart)).into());
            }
            track
        };
        let rms = Numbers::from([("horizontal_m".to_owned(), 10.0.into())]);
        let errors = ModelErrors {
            rms,
            ..ModelErrors::default()
        };
        let ways = [("white", 0.0), ("ar", 9.0), ("arma", 0.5)];
        let cut = |start: f64| Cut {
            start_s: start.into(),
            length_s: 1.0.into(),
        };
        let mut run = Outages {
            outages: vec![cut(10.0), cut(20.0)],
            order: ways.map(|(name, _)| name.to_owned()).into(),
            ..Outages::default()
        };
        for (name, apart) in ways {
            run.series.ways.insert(name.into(), way(apart));
            run.models.insert(name.into(), errors.clone());
        }
        let lines = of_models(
            &run,
            |track| on_the_ground(track, Some(&origin)),
            &[10.0, 20.0],
        );
        let names: Vec<&str> = lines.iter().map(|line| line.name.as_str()).collect();
        assert_eq!(names, ["white = arma", "ar"]);
        assert_eq!(lines[0].times, [10.0, 11.0, 15.5, 20.0, 21.0]);
        assert!(lines[0].x[2].is_nan() && lines[0].colour == model_colour("arma", 2));
        assert_ne!(lines[0].dash, lines[1].dash);
    }
    /// A drive of a metre a second to the east along the equator from 1000 s on, cut from 1002 to 1004 s and from 1008 s on.
    fn driven() -> Outages {
        let metre = 1.0 / 6_378_137f64.to_radians();
        let cut = |start: f64| Cut {
            start_s: start.into(),
            length_s: 2.0.into(),
        };
        let mut run = Outages {
            outages: vec![cut(1002.0), cut(1008.0)],
            ..Outages::default()
        };
        for second in 0..=10 {
            let track = &mut run.series.track;
            track.time_s.push((1000.0 + f64::from(second)).into());
            track.lat_deg.push(0.0.into());
            track.lon_deg.push((f64::from(second) * metre).into());
        }
        run
    }

    #[test]
    fn the_way_is_marked_where_gnss_was_cut() {
        let run = driven();
        let panel = panel("a", &run, false);
        let legend: Vec<&str> = panel.series.iter().map(|series| &*series.name).collect();
        assert_eq!(legend, ["driven", "without GNSS", "", "start"]);
        assert_eq!((panel.clock, panel.to_scale), (Some(1002.0), true));
        for (at, expected) in [
            (
                0,
                vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0],
            ),
            // Both ends of an outage.
            (1, vec![2.0, 3.0, 4.0]),
            (2, vec![8.0, 9.0, 10.0]),
        ] {
            let series = &panel.series[at];
            assert_eq!(series.x.len(), expected.len());
            for ((x, time), expected) in series.x.iter().zip(&series.times).zip(expected) {
                assert!((x - expected).abs() < 1e-6, "{x} {expected}");
                assert!((time - (expected - 2.0)).abs() < 1e-9, "{time}");
            }
        }
        assert_eq!(
            (&panel.series[3].x[..], &panel.series[3].y[0][..]),
            (&[0.0][..], &[0.0][..])
        );
    }

    #[test]
    fn drives_with_one_way_and_the_same_outages_are_drawn_once() {
        let run = driven();
        let mut other = driven();
        other.outages.pop();
        let named = |name: &str| name.to_owned();
        let runs = [(named("a"), &run), (named("b"), &run), (named("c"), &other)];
        let section = way(&runs).unwrap();
        assert_eq!(section.note, "3 outages");
        let figure = crate::tests::figure_of([&section], "trajectory");
        let titles: Vec<&str> = figure.panels.iter().map(|panel| &*panel.title).collect();
        assert_eq!((titles, figure.columns), (vec!["a", "c"], 2));
        assert!(!figure.caption.contains("each model's way"));
        // A drive without a track has no way.
        assert!(way(&[(named("a"), &Outages::default())]).is_none());
        let mut with = driven();
        with.series
            .ways
            .insert("arma".into(), with.series.track.clone());
        with.order = vec!["arma".into()];
        let rms = Numbers::from([("horizontal_m".to_owned(), 1.0.into())]);
        let errors = ModelErrors {
            rms,
            ..ModelErrors::default()
        };
        with.models.insert("arma".into(), errors);
        let section = models_way(&[(named(""), &with)]).unwrap();
        let figure = crate::tests::figure_of([&section], "trajectory");
        assert!(figure.caption.contains("each model's way"));
        let arma = figure.panels[0]
            .series
            .iter()
            .find(|series| series.name == "arma");
        // Where the second outage begins, the line is broken.
        let gaps = arma.unwrap().x.iter().filter(|x| x.is_nan()).count();
        assert_eq!(gaps, 2);
    }

    #[test]
    fn ways_are_one_line_within_a_twentieth_of_the_lesser_drift() {
        let metre = 1.0 / 6_378_137f64.to_radians();
        let lines = |apart: f64, drift: f64| {
            let mut run = Outages {
                order: vec!["white".into(), "arma".into()],
                ..Outages::default()
            };
            for (name, east, drift) in [("white", 0.0, 100.0), ("arma", apart, drift)] {
                let way = Track {
                    time_s: vec![1.0.into()],
                    lat_deg: vec![0.0.into()],
                    lon_deg: vec![(east * metre).into()],
                    ..Track::default()
                };
                run.series.ways.insert(name.into(), way);
                let rms = Numbers::from([("horizontal_m".to_owned(), drift.into())]);
                run.models.insert(
                    name.into(),
                    ModelErrors {
                        rms,
                        ..ModelErrors::default()
                    },
                );
            }
            let origin = Geodetic::from_degrees(0.0, 0.0, 0.0);
            of_models(&run, |track| on_the_ground(track, Some(&origin)), &[]).len()
        };
        assert_eq!([lines(0.49, 10.0), lines(0.51, 10.0)], [1, 2]);
        assert_eq!([lines(4.9, 200.0), lines(5.1, 200.0)], [1, 2]);
    }
}
