//! The experiment as its result.

use super::{
    drift::drift_curve,
    errors::{self, ModelOutcome, ModelRun},
};
use crate::{
    reference::GROUPS,
    replay::{Aid, Outage},
};
use undrift_nav::sample::{GnssFix, Position, TruthSample};
use undrift_results::{
    Drift, ModelErrors, NisOfParts, Number, Numbers, OutageErrors, Outages, SCHEMA, Say, Statement,
    Track, VERSION, by_name, numbers,
    series::{ROWS, Thinned, to_digits, to_millimetre, to_millisecond},
};

/// Errors in the outages as a result, model by model, on the ground track `track`; `say` makes the sentences.
pub fn result(
    outages: &[Outage],
    results: &[ModelOutcome],
    track: &[TruthSample],
    say: Say<'_>,
) -> Outages {
    let mut result = Outages {
        undrift: VERSION.into(),
        schema: SCHEMA,
        outages: outages.iter().map(Into::into).collect(),
        ..Outages::default()
    };
    result.series.track = thinned_track(track);
    for (name, run) in results {
        let run = match run {
            Ok(run) => run,
            Err(error) => {
                result.failed.insert(name.clone(), error.to_string());
                continue;
            }
        };
        result.order.push(name.clone());
        result.models.insert(name.clone(), run.errors.result(say));
        let sums = &run.summary;
        let nis = NisOfParts {
            position: sums.innovations[Aid::Position].per_dof().into(),
            velocity: sums.innovations[Aid::Velocity].per_dof().into(),
        };
        result.nis_per_dof.insert(name.clone(), nis);
        result.series.drift.insert(name.clone(), drift(run));
        result.series.ways.insert(name.clone(), way(run));
    }
    result
}

impl errors::ModelErrors {
    /// As a result; `say` makes the sentence.
    pub fn result(&self, say: Say<'_>) -> ModelErrors {
        let outage = |outage: &errors::OutageErrors| OutageErrors {
            start_s: outage.start_s.into(),
            max: outage.max.numbers(),
            end: outage.end.numbers(),
            sigma: outage.sigma.numbers(),
            nees: by_group(&outage.nees),
        };
        let finding = self.finding.clone();
        ModelErrors {
            max: self.max.numbers(),
            rms: self.rms.numbers(),
            median: self.median.numbers(),
            end_rms: self.end_rms.numbers(),
            nees: by_group(&self.nees),
            inside_sigma: by_name(GROUPS.iter().enumerate().filter_map(|(group, (name, _))| {
                let shares = self.coverage.shares(group)?;
                Some((*name, shares.map(Number)))
            })),
            left_out: self.left_out as u64,
            per_outage: self.per_outage.iter().map(outage).collect(),
            warning: finding.as_ref().map(|found| say(Statement::Finding(found))),
            finding,
        }
    }
}

fn by_group(values: &[f64; 3]) -> Numbers {
    let named = GROUPS.iter().zip(values);
    let known = named.filter(|(_, value)| value.is_finite());
    by_name(known.map(|((name, _), value)| (*name, *value)))
}

fn drift(run: &ModelRun) -> Drift {
    // Those that began before the solution come first.
    let outages = &run.errors.per_outage[run.errors.left_out..];
    let points = drift_curve(outages).into_iter();
    let rounded =
        points.map(|(time, error)| (Number(to_millisecond(time)), Number(to_digits(error))));
    let (since_cut_s, horizontal_rms_m) = rounded.unzip();
    Drift {
        since_cut_s,
        horizontal_rms_m,
    }
}

/// Places of a model inside all outages that are kept, but for the last of each.
const PLACES: usize = 1000;

/// Where a model was inside the outages, the last place of each always kept.
fn way(run: &ModelRun) -> Track {
    let ways = || run.errors.per_outage.iter().map(|outage| &outage.way);
    let every = ways().map(Vec::len).sum::<usize>().div_ceil(PLACES).max(1);
    let kept = ways().flat_map(|way| {
        let places = way.iter().enumerate();
        let kept = places.filter(move |(at, _)| at % every == 0 || at + 1 == way.len());
        kept.map(|(_, place)| *place)
    });
    let kept: Vec<[f64; 3]> = kept.collect();
    let degrees = |radians: f64| to_millimetre(radians.to_degrees());
    Track {
        time_s: numbers(kept.iter().map(|place| to_millisecond(place[0]))),
        lat_deg: numbers(kept.iter().map(|place| degrees(place[1]))),
        lon_deg: numbers(kept.iter().map(|place| degrees(place[2]))),
        height_m: Vec::new(),
    }
}

/// A ground track of bounded length.
pub fn thinned_track(track: &[TruthSample]) -> Track {
    let mut thinned = Thinned::new(ROWS);
    for sample in track {
        let (lat, lon) = (sample.position.lat, sample.position.lon);
        thinned.add([sample.time, lat.to_degrees(), lon.to_degrees()]);
    }
    Track {
        time_s: thinned.column(0, to_millisecond),
        lat_deg: thinned.column(1, to_millimetre),
        lon_deg: thinned.column(2, to_millimetre),
        height_m: Vec::new(),
    }
}

/// The ground track to draw: the reference, or the fixes without one.
pub fn track(truth: &[TruthSample], gnss: &[GnssFix]) -> Vec<TruthSample> {
    if !truth.is_empty() {
        return truth.to_vec();
    }
    gnss.iter()
        .filter_map(|fix| match fix.position {
            Some((Position::Geodetic(position), _)) => Some(TruthSample {
                time: fix.time,
                position,
                v_n: None,
                rpy: None,
            }),
            _ => None,
        })
        .collect()
}
