//! Where GNSS was cut, and where the models went.

use crate::{
    Figure, Panel, PlotAxis, Section, Series,
    numbers::get,
    parts::{Clock, Run, grouped, model_colour, model_pattern, on_the_ground, origin},
};
use undrift::results::{Outages, Track};

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
    let figure = Figure::of("trajectory", caption, drawn.len().min(2), panels);
    let cuts = drawn
        .iter()
        .map(|(_, run)| run.outages.len())
        .sum::<usize>();
    Some(Section::of("Where GNSS was cut", figure)?.noted(format!("{cuts} outages")))
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
    use undrift::nav::earth::Geodetic;
    use undrift::results::{Cut, ModelErrors, Numbers};

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
}
