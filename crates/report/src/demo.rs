//! The report of the demo: how much less the recommended model drifts, every model beside it, and what is not better.

use super::{
    Block, Cell, Figure, Panel, PlotAxis, Section, Series, Table, identify,
    numbers::short,
    outages, paper,
    parts::{Run, points, prefixed, quartiles, spoken_list, text},
    plain::{self, Mark},
};
use undrift_results::{
    CutLength, Demo, DemoModel, Drive, Estimate, Number, OutageSeries, Outages, PooledErrors,
    Usability,
    demo::{BOUND, PAPER, PAPER_EXACT, RECOMMENDED, REST, UNCALIBRATED, WHITE},
};

/// What each model is.
const ABOUT: [(&str, &str); 13] = [
    (WHITE, "white noise alone, no bias state"),
    (
        PAPER,
        "the source paper's equations (3)-(9) to the letter, σ the white noise of a sample",
    ),
    (
        PAPER_EXACT,
        "the source paper's ARMA(1,1) with φ = 1, by exact likelihood, run with its moving average",
    ),
    (
        "power spectrum",
        "white, flicker noise and random walk from the slopes of the spectrum (IEEE Std 952)",
    ),
    (
        "autocorrelation",
        "Gauss-Markov process from the autocorrelation of averages (Brown & Hwang; Nassar)",
    ),
    (
        "Allan",
        "white noise and random walk of the Allan variance (IEEE Std 952)",
    ),
    (
        "Gauss-Markov",
        "Gauss-Markov process of the lowest point of the Allan deviation (Gonzalez et al.)",
    ),
    (
        "composite",
        "the tightest white noise and Gauss-Markov process above the Allan variance (Xing & Gebre-Egziabher)",
    ),
    ("AR", "autoregressive model of the samples by Burg's method"),
    (
        "data sheet",
        "Gauss-Markov process of the data sheet's bias instability, 100 s",
    ),
    (RECOMMENDED, "the model that `identify` recommends"),
    (
        UNCALIBRATED,
        "the recommended model on samples whose turn-on constants, 3 °/s and 50 mg (1σ), nobody removed",
    ),
    (
        BOUND,
        "the simulation's own noise on samples without any constant: what no model can know, no model to choose",
    ),
];

/// The sections.
pub(crate) fn sections(runs: &[Run<'_, Demo>]) -> Vec<Section> {
    let mut sections = Vec::new();
    for (name, demo) in runs {
        let of_demo = [head(demo), drift(demo), paper::section(demo), rows(demo)];
        for mut section in of_demo.into_iter().flatten() {
            section.title = prefixed(name, &section.title);
            sections.push(section);
        }
    }
    let identified: Vec<_> = runs
        .iter()
        .map(|(name, demo)| (name.clone(), &demo.identification))
        .collect();
    sections.extend(identify::sections(&identified));
    sections
}

/// The demo for a terminal: the conclusion, every model, what is not better.
pub fn plain(demo: &Demo, mark: Mark) -> String {
    let lengths = demo.lengths.iter().map(|of| {
        let mut table = drifts(demo, of);
        table.head[0] = format!("{} s, {} outages", seconds(of.length_s), of.cuts);
        table.captioned("")
    });
    let conclusion = Block::Verdict(Usability::Usable, demo.conclusion.clone());
    let blocks = [Some(conclusion), text([CAPTION.into()])];
    let blocks = blocks.into_iter().chain(lengths);
    let not_better = text([not_better(demo).join("\n")]);
    plain::plain(blocks.chain([bounds(demo).block(), not_better]), mark)
}

const CAPTION: &str = "RMS over the outages of the largest horizontal error; how many times less that is than of white noise in the same outages. In brackets 95 % intervals by bootstrap over the outages. ≈ where the least drift of all is not beyond chance less.";

const BOUNDS: &str =
    "No model to choose but a bound: the simulation's own noise, on samples without any constant.";

fn head(demo: &Demo) -> Option<Section> {
    let sensor = match demo.recorded {
        true => "The sensor's errors are stretches of a real static recording",
        false => {
            "The sensor's white noise and random walks are those of three real recordings of an ADIS16405"
        }
    };
    let (drives, seed) = (drives(demo), demo.seed);
    let what = format!(
        "{sensor}, its turn-on constants 3 °/s and 50 mg (1σ). One static recording was identified. Simulated: {drives} of 15 min with fixes of centimetres at 5 Hz, seed {seed}, GNSS was cut from 200 s on. All models but \"{UNCALIBRATED}\" and \"{BOUND}\" navigate on the same samples, less the means over {REST:.0} s of rest before the drive at a known attitude."
    );
    let about = ABOUT
        .iter()
        .filter(|(name, _)| demo.models.iter().any(|m| m.name == *name));
    let about = Table::from_rows(
        "rows",
        "The models.",
        about,
        &[
            ("model", &|(name, _)| (*name).into()),
            ("what it is", &|(_, what)| (*what).into()),
        ],
    );
    let tables = demo.lengths.iter().map(|of| drifts(demo, of).block());
    let conclusion = Block::Verdict(Usability::Usable, demo.conclusion.clone());
    let blocks = [Some(conclusion)].into_iter().chain(tables);
    let blocks = blocks.chain([
        bounds(demo).block(),
        text(not_better(demo)),
        text([what]),
        about.block(),
    ]);
    Section::new("How much less drift", blocks.flatten())
}

/// Where GNSS was cut, and how the models drift in the longest outages.
fn drift(demo: &Demo) -> Option<Section> {
    let cut = Outages {
        drive: Drive {
            simulated: Some(String::new()),
            ..Drive::default()
        },
        outages: demo.cuts.clone(),
        series: OutageSeries {
            track: demo.track.clone(),
            ..OutageSeries::default()
        },
        ..Outages::default()
    };
    let track = outages::way(&[(String::new(), &cut)]);
    let blocks = track.into_iter().flat_map(|section| section.blocks);
    let longest = demo.lengths.last().into_iter();
    let longest = longest.flat_map(|of| [curves(demo, of), spread(demo, of)]);
    Section::new("Drift without GNSS", blocks.chain(longest.flatten()))
}

fn curves(demo: &Demo, of: &CutLength) -> Option<Block> {
    let mut panel = Panel::new(
        "",
        PlotAxis::new("time since the cut [s]"),
        PlotAxis::new("horizontal error, RMS [m]"),
    );
    let mut others = "other methods";
    let in_order = demo.models.iter().filter(|m| m.name != PAPER);
    let known = in_order.filter_map(|m| Some((m, of.models.get(&m.name)?)));
    for (model, errors) in known {
        let drift = &errors.drift;
        let points = points(&drift.since_cut_s, &drift.horizontal_rms_m, 1.0);
        let name = model.name.as_str();
        panel.add(match name {
            WHITE => Series::line(name, 0, points),
            RECOMMENDED => Series::thick(name, 7, points),
            BOUND => Series::dashed(name, 1, points),
            _ => Series::thin(std::mem::take(&mut others), 4, points),
        });
    }
    let literal = of
        .models
        .get(PAPER)
        .and_then(|e| e.horizontal_m.value.get());
    let literal = literal.map_or(String::new(), |m| {
        format!(
            " Not drawn: the source paper's equations to the letter, {} m.",
            short(m)
        )
    });
    let caption = format!(
        "Horizontal error since the cut, RMS over the {} outages of {} s; the bound, no model to choose, in grey.{literal}",
        of.cuts,
        seconds(of.length_s)
    );
    Figure::block("drift", &caption, 1, [panel])
}

/// How the largest errors of the models to choose scatter over the outages.
fn spread(demo: &Demo, of: &CutLength) -> Option<Block> {
    let shown = demo.models.iter().filter(|m| m.name != PAPER && !m.bound);
    let boxes = shown.filter_map(|m| {
        let largest = of.models.get(&m.name)?.largest_m.iter().map(|e| e.0);
        Some((m.name.as_str(), quartiles(&Vec::from_iter(largest))?))
    });
    let boxes: Vec<(&str, [f64; 5])> = boxes.collect();
    let names = boxes.iter().map(|(name, _)| *name);
    let y = PlotAxis::new("largest horizontal error [m]");
    let mut panel = Panel::new("", PlotAxis::categories(names), y);
    let all = (0..).map(f64::from).zip(boxes.iter().map(|b| b.1));
    panel.add(Series::boxes("", 7, all.collect()));
    let caption = format!(
        "Largest horizontal error of each outage of {} s: box from the first to the third quartile with the median, whiskers to the extremes.",
        seconds(of.length_s)
    );
    Figure::block("spread", &caption, 1, [panel])
}

/// The drift of each model in the outages of one length.
fn drifts(demo: &Demo, of: &CutLength) -> Table {
    let least = clear_least(of, demo);
    let known = demo.models.iter().filter(|m| !m.bound);
    let known = known.filter_map(|m| Some((m.name.as_str(), of.models.get(&m.name)?)));
    type Row<'a> = (&'a str, &'a PooledErrors);
    let length = seconds(of.length_s);
    let is_first = demo.lengths.first().is_some_and(|first| first == of);
    let caption = if is_first { CAPTION } else { "As above." };
    Table::from_rows(
        &format!("drift-{length}"),
        &format!("Outages of {length} s, {} in all. {caption}", of.cuts),
        known,
        &[
            ("model", &|row: &Row<'_>| row.0.into()),
            ("drift [m]", &|row| {
                Cell::from(estimate(row.1.horizontal_m)).strong_if(least == Some(row.0))
            }),
            ("times less than white", &|row| match row.0 {
                WHITE => "".into(),
                _ => estimate(row.1.less_than_white).into(),
            }),
            ("", &|row| match row.1.over_least.is_one() {
                true => "≈".into(),
                false => "".into(),
            }),
        ],
    )
}

/// The drift of the bounds in the outages of each length.
fn bounds(demo: &Demo) -> Table {
    let models = demo.models.iter().filter(|m| m.bound);
    let models: Vec<&DemoModel> = models.collect();
    let name: &dyn Fn(&&&DemoModel) -> Cell = &|m| (&m.name).into();
    let mut table = Table::from_rows("bound", BOUNDS, &models, &[("model", name)]);
    for of in &demo.lengths {
        let cells = models.iter().map(|m| -> Cell {
            let errors = of.models.get(&m.name);
            errors.map_or("–".into(), |e| estimate(e.horizontal_m).into())
        });
        table.add(format!("{} s: drift [m]", seconds(of.length_s)), cells);
    }
    table
}

/// The model with the least drift, if it is beyond chance.
fn clear_least<'a>(of: &CutLength, demo: &'a Demo) -> Option<&'a str> {
    let near = demo.models.iter().filter(|model| {
        let errors = of.models.get(&model.name);
        !model.bound && errors.is_some_and(|e| e.over_least.is_one())
    });
    match near.collect::<Vec<_>>().as_slice() {
        [one] => Some(one.name.as_str()),
        _ => None,
    }
}

/// "5 drives".
fn drives(demo: &Demo) -> String {
    match demo.drives {
        1 => "1 drive".into(),
        n => format!("{n} drives"),
    }
}

/// Whole seconds.
fn seconds(length: Number) -> String {
    format!("{:.0}", length.0)
}

/// "1.90 (1.62 to 2.20)".
fn estimate(of: Estimate) -> String {
    let [low, high] = of.interval.map(|end| short(end.0));
    match of.value.get() {
        Some(value) => format!("{} ({low} to {high})", short(value)),
        None => "–".into(),
    }
}

/// How many times less the recommended model drifts than white noise, in one sentence.
pub(crate) fn conclusion(demo: &Demo) -> String {
    let lengths = demo.lengths.iter().filter_map(|of| {
        let less = of.models.get(RECOMMENDED)?.less_than_white;
        let [low, high] = less.interval;
        let (value, length) = (less.value.get()?, seconds(of.length_s));
        let how = if less.is_one() {
            format!("as far in {length} s ({} times less", short(value))
        } else if value > 1.0 {
            format!("{} times less in {length} s (", short(value))
        } else {
            format!("farther in {length} s ({} times less", short(value))
        };
        let comma = if how.ends_with('(') { "" } else { ", " };
        Some(format!(
            "{how}{comma}95 %: {} to {})",
            short(low.0),
            short(high.0)
        ))
    });
    let sensor = match demo.recorded {
        true => "with the noise of a real recording",
        false => "with noise as real recordings have it",
    };
    format!(
        "Without GNSS the recommended noise model drifts, compared with white noise, {}: {}, {sensor}, both on samples less their mean error over {REST:.0} s of rest.",
        spoken_list(&Vec::from_iter(lengths)),
        drives(demo)
    )
}

/// What is not better, in sentences.
fn not_better(demo: &Demo) -> Vec<String> {
    let near = |of: &CutLength| {
        let others = demo.models.iter().filter(|m| {
            let errors = of.models.get(&m.name);
            m.name != RECOMMENDED && !m.bound && errors.is_some_and(|e| e.over_least.is_one())
        });
        let names = Vec::from_iter(others.map(|m| m.name.clone()));
        let own = of.models.get(RECOMMENDED)?.over_least;
        let length = seconds(of.length_s);
        Some(match (own.is_one(), names.is_empty()) {
            (true, true) => format!("in {length} s: none"),
            (true, false) => format!("in {length} s: {}", spoken_list(&names)),
            (false, _) => format!(
                "in {length} s: the recommended model itself is not, it drifts {} times the least",
                estimate(own)
            ),
        })
    };
    let near = Vec::from_iter(demo.lengths.iter().filter_map(near));
    let mut notes = vec![format!(
        "Not better than others: within chance of the least drift are, beside the recommended model, {}.",
        near.join("; ")
    )];
    let without = demo.models.iter().filter(|m| !m.without.is_empty());
    let without = without.map(|m| {
        let axes: Vec<String> = m.without.iter().map(|a| identify::spoken(a)).collect();
        format!("{} ({})", m.name, axes.join(", "))
    });
    let without = Vec::from_iter(without);
    if !without.is_empty() {
        notes.push(format!(
            "White noise alone where the method has no model: {}.",
            without.join("; ")
        ));
    }
    let failed = demo.lengths.iter().flat_map(|of| &of.models);
    notes.extend(failed.filter_map(|(name, errors)| {
        Some(format!(
            "{name} could not be run: {}.",
            errors.failed.as_ref()?
        ))
    }));
    notes
}

/// All components, of the longest outages and of those of the source paper.
fn rows(demo: &Demo) -> Option<Section> {
    let tables = demo.lengths.iter().map(|of| {
        let length = seconds(of.length_s);
        let caption = format!(
            "Outages of {length} s: RMS over all {} of the largest error of each.",
            of.cuts
        );
        let errors = |model: &DemoModel| of.models.get(&model.name).map(|e| &e.rms);
        Block::Table(paper::components(
            &format!("errors-{length}"),
            &caption,
            demo.models.iter().map(|m| (m.name.as_str(), errors(m))),
        ))
    });
    Section::new("Errors inside the outages", tables)
}

#[cfg(test)]
mod tests;
