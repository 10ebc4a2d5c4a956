//! The report of GNSS outages: the source paper's Table 4, the way driven, and the drift of each model.

mod drift;
mod way;
mod without;

use super::{
    Block, Cell, Section, Table,
    numbers::{get, short},
    parts::{
        COMPONENTS, Run, model_colour, named, of_which, points, prefixed, spoken_list, text,
        verdict_of, warnings,
    },
};
use crate::{
    date,
    plain::{self, Mark},
    say::words::worded,
};
use drift::drift;
use undrift_base::order_statistics::quantile;
use undrift_results::{
    ModelErrors, Numbers, Outages,
    findings::{Severity, verdict},
    is_clear_lead,
};
pub(crate) use way::{models_way, way};

const HORIZONTAL: &str = "horizontal_m";

/// One model of one experiment.
struct Model<'a> {
    name: String,
    /// Without the name of the run.
    key: &'a str,
    /// Which run it is of.
    run: usize,
    errors: &'a ModelErrors,
    drift: Vec<(f64, f64)>,
    colour: usize,
    /// Whether its run can be concluded from.
    usable: bool,
}

impl Model<'_> {
    /// Its name in a sentence, in quotes where it would fall apart there.
    fn spoken(&self) -> String {
        if self.name.contains([',', ' ']) {
            format!("\"{}\"", self.name)
        } else {
            self.name.clone()
        }
    }

    /// Largest horizontal error of each outage \[m\].
    fn largest(&self) -> Vec<f64> {
        largest(self.errors).collect()
    }

    fn rms(&self) -> f64 {
        get(&self.errors.rms, HORIZONTAL)
    }
}

/// The sections.
pub fn sections(runs: &[Run<'_, Outages>]) -> Vec<Section> {
    let models = models(runs);
    let sections = [
        summary(runs, &models),
        drift(&models),
        models_way(runs),
        tables(runs, &models),
    ];
    sections.into_iter().flatten().collect()
}

fn models<'a>(runs: &[Run<'a, Outages>]) -> Vec<Model<'a>> {
    let mut models = Vec::new();
    for (at, (run, result)) in runs.iter().enumerate() {
        // Models that the order leaves out come last.
        let rest = result.models.keys().filter(|k| !result.order.contains(k));
        for key in result.order.iter().chain(rest) {
            let Some(errors) = result.models.get(key) else {
                continue;
            };
            let drift = result.series.drift.get(key);
            models.push(Model {
                name: prefixed(run, key),
                key,
                run: at,
                errors,
                drift: drift.map_or(Vec::new(), |d| {
                    points(&d.since_cut_s, &d.horizontal_rms_m, 1.0)
                }),
                colour: model_colour(key, models.len()),
                usable: verdict(&result.findings).0 < Severity::Unusable,
            });
        }
    }
    models
}

fn summary(runs: &[Run<'_, Outages>], models: &[Model<'_>]) -> Option<Section> {
    let of_run = |(name, run): &Run<'_, Outages>| -> Vec<String> {
        let failed = run.failed.iter();
        let failed = failed.map(|(model, why)| format!("{model} could not be run: {why}"));
        // Of other versions' results alone: it is among the warnings.
        let doubtful = run.models.iter().filter_map(|(model, errors)| {
            let why = errors.warning.as_ref()?;
            let is_reason = |said: &String| said.ends_with(why.as_str());
            (!run.warnings.iter().any(is_reason)).then(|| format!("run as {model}, {why}"))
        });
        let all = failed.chain(doubtful).chain(run.warnings.iter().cloned());
        all.map(|warning| of_which(name, &warning)).collect()
    };
    let warned: Vec<String> = runs.iter().flat_map(of_run).collect();
    let done = runs
        .iter()
        .map(|(name, run)| text([what_was_done(name, run)]));
    let verdicts = runs
        .iter()
        .map(|(name, run)| Some(verdict_of(name, &run.findings)));
    let beside = runs
        .iter()
        .flat_map(|(name, run)| without::sentences(name, run));
    let found = findings(models).into_iter().chain(beside);
    let blocks = verdicts.chain([text(found), warnings(&warned)]);
    Section::new("GNSS outages", blocks.chain(done).flatten())
}

fn what_was_done(name: &str, run: &Outages) -> String {
    let drive = &run.drive;
    let rate = short(drive.rate_hz.0);
    let what = match (&drive.simulated, &drive.imu, &drive.gnss) {
        (Some(simulated), Some(imu), Some(gnss)) => {
            format!("On {simulated}, simulated ({imu} at {rate} Hz, {gnss}),")
        }
        (None, Some(imu), Some(gnss)) => format!("On {imu} at {rate} Hz with {gnss},"),
        _ => "On the drive,".into(),
    };
    let lengths: Vec<f64> = run.outages.iter().map(|o| o.length_s.0).collect();
    let lengths = between(&lengths);
    let solution = match (run.smooth, run.look_ahead) {
        (true, _) => "smoothed solution",
        (false, true) => "solution, which knew the errors of all fixes from the start,",
        (false, false) => "solution, of what came before each instant only,",
    };
    let reference = match run.reference.as_str() {
        "gnss" => "the withheld fixes",
        _ => "the truth",
    };
    let rejected = match run.rejected {
        0 => String::new(),
        n => format!(
            " but for {n} of {} that the run without outages rejects",
            run.withheld
        ),
    };
    let model = match (compared_as(run), drive.model.as_deref().unwrap_or_default()) {
        (Some(form), _) => format!("; each noise model is run as {form}"),
        (None, "") => String::new(),
        (None, model) => {
            let quote = if model.starts_with("the ") { "" } else { "\"" };
            let forms = run.models.len();
            format!("; the noise model is {quote}{model}{quote}, run in {forms} forms")
        }
    };
    let cuts = run.outages.len();
    let first = run.outages.first().map_or(f64::NAN, |cut| cut.start_s.0);
    let date = date::of_drive(drive, first);
    let date = date.map_or(String::new(), |date| {
        format!(" Start of the first: {date}.")
    });
    named(
        name,
        &format!(
            "{what} GNSS was cut {cuts} times for {lengths}. During the outages the {solution} was compared with {reference}{rejected}{model}.{date}"
        ),
    )
}

/// The bias model that several noise models are run as, where these are compared.
fn compared_as(run: &Outages) -> Option<&str> {
    let first = run.noise_models.values().next()?;
    Some(first.bias_model.as_str())
}

/// Lengths \[s\] in words.
fn between(lengths: &[f64]) -> String {
    let [least, median, most] = [0.0, 0.5, 1.0].map(|share| quantile(lengths, share));
    match most - least > 0.05 {
        true => format!("{} to {} s", seconds(least), seconds(most)),
        false => format!("{} s", seconds(median)),
    }
}

/// Seconds without needless digits.
fn seconds(value: f64) -> String {
    if !value.is_finite() {
        return short(value);
    }
    format!("{value:.1}").trim_end_matches(".0").to_owned()
}

/// How much more than the least still counts as the same drift.
const ALIKE: f64 = 1.01;

/// Which model drifts least, and how sure that is.
fn findings(models: &[Model<'_>]) -> Vec<String> {
    let mut ranked: Vec<&Model<'_>> = models.iter().filter(|m| m.rms().is_finite()).collect();
    let finished = !ranked.is_empty();
    ranked.retain(|m| m.usable);
    ranked.sort_by(|a, b| a.rms().total_cmp(&b.rms()));
    let Some(best) = ranked.first().copied() else {
        return vec![match finished {
            true => "No conclusion: the result is not usable.".into(),
            false => "No model has an error inside every outage.".into(),
        }];
    };
    let alike = ranked.partition_point(|m| m.rms() <= ALIKE * best.rms());
    let (first, rest) = ranked.split_at(alike);
    let names = spoken_list(&first.iter().map(|m| m.spoken()).collect::<Vec<_>>());
    let together = if alike > 1 { ", equal within 1 %," } else { "" };
    let (least, with) = match ranked.len() {
        1 => ("Horizontal drift", names),
        _ => ("Least horizontal drift", format!("{names}{together} with")),
    };
    let with = match ranked.len() {
        1 => format!("{with} has"),
        _ => with,
    };
    let mut found = vec![format!(
        "{least}: {with} {} m (RMS over the outages of the largest error of each).",
        short(best.rms())
    )];
    if let Some(second) = rest.first() {
        let (wins, of) = wins(best.errors, second.errors);
        let clear = is_clear_lead(wins, of);
        found.push(format!(
            "Next is {} with {} m; {} drifted less in {wins} of {of} outages, {} than expected by chance.",
            second.spoken(),
            short(second.rms()),
            best.spoken(),
            if clear { "more" } else { "no more" }
        ));
    }
    if let Some(worst) = rest.last().filter(|_| rest.len() > 1) {
        found.push(format!(
            "Most: {} with {} m, {} times the least.",
            worst.spoken(),
            short(worst.rms()),
            short(worst.rms() / best.rms())
        ));
    }
    found
}

/// Largest horizontal error of each outage \[m\].
fn largest(errors: &ModelErrors) -> impl Iterator<Item = f64> {
    let outages = errors.per_outage.iter();
    outages.map(|outage| get(&outage.max, HORIZONTAL))
}

/// In how many outages the horizontal drift is less with the one than with the other, and in how many it differs.
fn wins(one: &ModelErrors, other: &ModelErrors) -> (usize, usize) {
    let pairs = largest(one).zip(largest(other));
    let differ = Vec::from_iter(pairs.filter(|(a, b)| a != b));
    (differ.iter().filter(|(a, b)| a < b).count(), differ.len())
}

/// A statistic of a model's errors over the outages, by component.
type Statistic = fn(&ModelErrors) -> &Numbers;

/// For a terminal: what the report concludes, then table 4, maximum, root mean square and median of each model's largest
/// errors.
pub fn plain(result: &Outages, mark: Mark) -> String {
    let models = models(&[(String::new(), result)]);
    let mut found = vec![cuts(result)];
    if !models.is_empty() {
        found.extend(findings(&models));
        found.extend(without::sentences("", result));
    }
    found.retain(|line| !line.is_empty());
    let models: Vec<&Model<'_>> = models.iter().collect();
    let statistics: [(&str, Statistic); 3] = [
        ("maximum", |m| &m.max),
        ("RMS", |m| &m.rms),
        ("median", |m| &m.median),
    ];
    let tables = statistics.iter().filter_map(|(name, of)| {
        let mut table = table_of("", "", &models, *of)?;
        table.head[0] = (*name).into();
        Some(Block::Table(table))
    });
    let mut blocks = Vec::from_iter(text([found.join("\n")]));
    let tables = Vec::from_iter(tables);
    if !tables.is_empty() {
        blocks.push(Block::Text("Errors inside the outages:".into()));
        blocks.extend(tables);
        blocks.extend(consistency(&models).map(Block::Table));
        blocks.extend(without::table("", result).map(Block::Table));
    }
    worded(
        plain::plain(blocks.into_iter().map(Some), mark),
        result.drive.posed,
    )
}

/// How many outages of which length, and the reference.
fn cuts(run: &Outages) -> String {
    let lengths: Vec<f64> = run.outages.iter().map(|o| o.length_s.0).collect();
    if lengths.is_empty() {
        return String::new();
    }
    let reference = match (run.reference.as_str(), run.rejected) {
        ("gnss", 0) => "the withheld fixes".into(),
        ("gnss", rejected) => format!(
            "the withheld fixes but for {rejected} of {} that the run without outages rejects",
            run.withheld
        ),
        _ => "the truth".to_owned(),
    };
    let count = match run.left_out.len() {
        0 => lengths.len().to_string(),
        left_out => format!("{} of {}", lengths.len(), lengths.len() + left_out),
    };
    let form = compared_as(run).map_or(String::new(), |form| {
        format!("; noise models run as {form}, the run without outages with the first of them")
    });
    format!(
        "{count} outages of {}, reference: {reference}{form}",
        between(&lengths)
    )
}

/// What the table of [`consistency`] has.
const COVERED: &str = "Share of errors within 1, 2 and 3 predicted standard deviations [%] (68, 95, 99.7 if the covariance is correct), and NEES per degree of freedom at the end of the outages (1 if correct):";

/// How well each model's covariance covers its errors inside the outages.
fn consistency(models: &[&Model<'_>]) -> Option<Table> {
    let models_named: &dyn Fn(&&&Model<'_>) -> Cell = &|m| (&m.name).into();
    let mut table = Table::from_rows("consistency", COVERED, models, &[("model", models_named)]);
    for group in ["position", "velocity", "attitude"] {
        let shares = |m: &&Model<'_>| m.errors.inside_sigma.get(group).copied();
        if models.iter().all(|m| shares(m).is_none()) {
            continue;
        }
        for (i, head) in ["1σ", "2σ", "3σ"].into_iter().enumerate() {
            let cell = |m: &&Model<'_>| {
                let share = shares(m).map_or(f64::NAN, |shares| shares[i].0);
                Cell::number(100.0 * share, 1)
            };
            table.add(format!("{group} {head}"), models.iter().map(cell));
        }
        let nees = |m: &&Model<'_>| Cell::number(get(&m.errors.nees, group), 2);
        table.add("NEES".into(), models.iter().map(nees));
    }
    (table.head.len() > 1).then_some(table)
}

/// Table 4: maximum, root mean square and median of each model's largest errors.
fn tables(runs: &[Run<'_, Outages>], models: &[Model<'_>]) -> Option<Section> {
    let statistics: [(&str, &str, Statistic); 4] = [
        (
            "rms",
            "RMS over the outages of the largest error of each.",
            |m| &m.rms,
        ),
        ("maximum", "Largest error in any outage.", |m| &m.max),
        (
            "median",
            "Median over the outages of the largest error of each.",
            |m| &m.median,
        ),
        (
            "at-the-end",
            "RMS over the outages of the error at the end.",
            |m| &m.end_rms,
        ),
    ];
    let models: Vec<&Model<'_>> = models.iter().collect();
    let of_models = statistics
        .into_iter()
        .filter_map(|(name, caption, of)| table_of(name, caption, &models, of));
    let without = runs
        .iter()
        .filter_map(|(name, run)| without::table(name, run));
    let all = of_models.chain(consistency(&models)).chain(without);
    let blocks = all.map(Block::Table);
    Section::new("Errors inside the outages", blocks)
}

fn table_of(name: &str, caption: &str, models: &[&Model<'_>], of: Statistic) -> Option<Table> {
    let name = format!("errors-{name}");
    let models_named: &dyn Fn(&&&Model<'_>) -> Cell = &|m| (&m.name).into();
    let mut table = Table::from_rows(&name, caption, models, &[("model", models_named)]);
    for (key, head) in COMPONENTS {
        let values: Vec<f64> = models.iter().map(|m| get(of(m.errors), key)).collect();
        if values.iter().any(|v| v.is_finite()) {
            table.add(head.into(), values.iter().map(|v| short(*v).into()));
            let ranked = models.iter().zip(values);
            let ranked: Vec<f64> = ranked
                .map(|(m, v)| if m.usable { v } else { f64::NAN })
                .collect();
            table.mark_least(table.head.len() - 1, &ranked);
        }
    }
    (table.head.len() > 1).then_some(table)
}

#[cfg(test)]
mod tests;
