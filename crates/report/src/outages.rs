//! The report of GNSS outages: the source paper's Table 4, the way driven, and the drift of each model.

mod drift;
mod way;

use super::{
    Block, Cell, Section, Table,
    parts::{cell, get, mark_least, model_colour, named, short, table, text, warnings, zip},
};
use crate::say;
use drift::drift;
use undrift::{
    demo::WHITE_CALIBRATED,
    noise::order_statistics::quantile,
    results::{ModelErrors, Numbers, Outages},
};
use way::way;

/// Components of Table 4 with the heads of their columns.
const COLUMNS: [(&str, &str); 10] = [
    ("north_m", "N [m]"),
    ("east_m", "E [m]"),
    ("down_m", "D [m]"),
    ("horizontal_m", "horizontal [m]"),
    ("vn_mps", "vN [m/s]"),
    ("ve_mps", "vE [m/s]"),
    ("vd_mps", "vD [m/s]"),
    ("roll_deg", "roll [°]"),
    ("pitch_deg", "pitch [°]"),
    ("yaw_deg", "yaw [°]"),
];
const HORIZONTAL: &str = "horizontal_m";

/// An experiment with its name; the name of a single one is empty.
pub type Run<'a> = (String, &'a Outages);

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
}

impl Model<'_> {
    /// Whether it is no model to choose but a bound.
    fn is_bound(&self) -> bool {
        self.key == WHITE_CALIBRATED
    }

    /// Largest horizontal error of each outage \[m\].
    fn largest(&self) -> Vec<f64> {
        let outages = self.errors.per_outage.iter();
        outages.map(|o| get(&o.max, HORIZONTAL)).collect()
    }

    /// Its name in a sentence, in quotes where it would fall apart there.
    fn spoken(&self) -> String {
        if self.name.contains([',', ' ']) {
            format!("\"{}\"", self.name)
        } else {
            self.name.clone()
        }
    }

    fn rms(&self) -> f64 {
        get(&self.errors.rms, HORIZONTAL)
    }
}

/// The sections.
pub fn sections(runs: &[Run<'_>]) -> Vec<Section> {
    let models = models(runs);
    let mut sections = vec![summary(runs, &models)];
    sections.extend(drift(&models));
    sections.extend(tables(&models));
    sections.extend(way(runs));
    sections
}

fn models<'a>(runs: &[Run<'a>]) -> Vec<Model<'a>> {
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
                name: if run.is_empty() {
                    key.clone()
                } else {
                    format!("{run}: {key}")
                },
                key,
                run: at,
                errors,
                drift: drift.map_or(Vec::new(), |d| zip(&d.since_cut_s, &d.horizontal_rms_m)),
                colour: model_colour(key, models.len()),
            });
        }
    }
    models
}

fn summary(runs: &[Run<'_>], models: &[Model<'_>]) -> Section {
    let mut told = Vec::new();
    for (name, run) in runs {
        let prefix = if name.is_empty() {
            String::new()
        } else {
            format!("in {name}: ")
        };
        let failed = run
            .failed
            .iter()
            .map(|(model, why)| format!("{model} could not be run: {why}"));
        let said = run.models.iter().filter_map(|(model, errors)| {
            Some(format!("run as {model}, {}", errors.warning.as_ref()?))
        });
        told.extend(
            failed
                .chain(said)
                .chain(run.warnings.iter().cloned())
                .map(|warning| format!("{prefix}{warning}")),
        );
    }
    let mut blocks = Vec::from_iter(warnings(&told));
    for (name, run) in runs {
        blocks.extend(text(&[what_was_done(name, run)]));
    }
    blocks.extend(text(&findings(models)));
    Section {
        title: "GNSS outages".into(),
        blocks,
    }
}

fn what_was_done(name: &str, run: &Outages) -> String {
    let drive = &run.drive;
    let what = match (&drive.simulated, &drive.imu, &drive.gnss) {
        (Some(simulated), Some(imu), Some(gnss)) => {
            format!(
                "On {simulated}, simulated ({imu} at {} Hz, {gnss}),",
                short(drive.rate_hz.0)
            )
        }
        (None, Some(imu), Some(gnss)) => {
            format!("On {imu} at {} Hz with {gnss},", short(drive.rate_hz.0))
        }
        _ => "On the drive,".into(),
    };
    let lengths: Vec<f64> = run.outages.iter().map(|o| o.length_s.0).collect();
    let model = drive.model.as_deref().filter(|m| !m.is_empty());
    let differ = quantile(&lengths, 1.0) - quantile(&lengths, 0.0) > 0.05;
    let lengths = if differ {
        format!(
            "{} to {}",
            seconds(quantile(&lengths, 0.0)),
            seconds(quantile(&lengths, 1.0))
        )
    } else {
        seconds(quantile(&lengths, 0.5))
    };
    let sentence = format!(
        "{what} GNSS was cut {} times for {lengths} s. Inside the outages the {} was compared with {}{}.",
        run.outages.len(),
        if run.smooth {
            "smoothed solution"
        } else {
            "solution"
        },
        if run.reference == "gnss" {
            "the fixes withheld from it"
        } else {
            "the truth"
        },
        model.map_or(String::new(), |m| format!(
            "; the noise model is {}, run in {} forms",
            if m.starts_with("the ") {
                m.to_owned()
            } else {
                format!("\"{m}\"")
            },
            run.models.len()
        )),
    );
    named(name, &sentence)
}

/// Seconds without needless digits.
fn seconds(value: f64) -> String {
    if !value.is_finite() {
        return short(value);
    }
    let text = format!("{value:.1}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// How much more than the least still counts as the same drift.
const ALIKE: f64 = 1.01;

/// Which model drifts least, and how sure that is.
fn findings(models: &[Model<'_>]) -> Vec<String> {
    let mut ranked: Vec<&Model<'_>> = models.iter().filter(|m| m.rms().is_finite()).collect();
    ranked.retain(|m| !m.is_bound());
    ranked.sort_by(|a, b| a.rms().total_cmp(&b.rms()));
    let Some(best) = ranked.first().copied() else {
        return vec!["No model has an error inside every outage.".into()];
    };
    let alike = ranked.partition_point(|m| m.rms() <= ALIKE * best.rms());
    let (first, rest) = ranked.split_at(alike);
    let names =
        |models: &[&Model<'_>]| listed(&models.iter().map(|m| m.spoken()).collect::<Vec<_>>());
    let mut told = vec![
        if alike > 1 {
            format!(
                "The least horizontal drift is that of {}, alike within 1 %: {} m",
                names(first),
                short(best.rms())
            )
        } else {
            format!(
                "The least horizontal drift is that of {}: {} m",
                best.spoken(),
                short(best.rms())
            )
        } + ", the root mean square over the outages of each one's largest error.",
    ];
    if let Some(second) = rest.first() {
        let pairs = best.largest().into_iter().zip(second.largest());
        let pairs: Vec<(f64, f64)> = pairs.filter(|(a, b)| a != b).collect();
        let wins = pairs.iter().filter(|(a, b)| a < b).count();
        told.push(format!(
            "Next is {} with {} m; {} drifted less than it in {wins} of {} outages{}.",
            second.spoken(),
            short(second.rms()),
            best.spoken(),
            pairs.len(),
            if is_clear(wins, pairs.len()) {
                ", more than chance gives"
            } else {
                ", no more than chance gives"
            }
        ));
    }
    if let Some(worst) = rest.last().filter(|_| rest.len() > 1) {
        told.push(format!(
            "The most is that of {}: {} m, {} times as much as the least.",
            worst.spoken(),
            short(worst.rms()),
            short(worst.rms() / best.rms())
        ));
    }
    told
}

/// "a, b and c".
fn listed(names: &[String]) -> String {
    match names.split_last() {
        Some((last, before)) if !before.is_empty() => format!("{} and {last}", before.join(", ")),
        _ => names.concat(),
    }
}

/// Whether so many wins of so many are rarer than 5 % by chance: sign test, both sides.
fn is_clear(wins: usize, of: usize) -> bool {
    use statrs::distribution::{Binomial, DiscreteCDF};
    let Ok(chance) = Binomial::new(0.5, of as u64) else {
        return false;
    };
    let fewer = wins.min(of - wins) as u64;
    2.0 * chance.cdf(fewer) < 0.05 && 2 * wins > of
}

/// Table 4: maximum, root mean square and median of each model's largest errors.
fn tables(models: &[Model<'_>]) -> Option<Section> {
    type Pick = fn(&ModelErrors) -> &Numbers;
    let kinds: [(&str, &str, Pick); 4] = [
        (
            "rms",
            "Root mean square over the outages of each one's largest error.",
            |m| &m.rms,
        ),
        ("maximum", "Largest error inside any outage.", |m| &m.max),
        (
            "median",
            "Median over the outages of each one's largest error.",
            |m| &m.median,
        ),
        (
            "at-the-end",
            "Root mean square over the outages of the error at the end.",
            |m| &m.end_rms,
        ),
    ];
    let (bounds, models): (Vec<_>, Vec<_>) = models.iter().partition(|m| m.is_bound());
    let mut blocks: Vec<Block> = kinds
        .into_iter()
        .filter_map(|(name, caption, pick)| table_of(name, caption, &models, pick))
        .map(Block::Table)
        .collect();
    let (_, _, rms) = kinds[0];
    let bound = table_of("bound", say::WHITE_CALIBRATED, &bounds, rms).map(Block::Table);
    blocks.extend(bound);
    (!blocks.is_empty()).then(|| Section {
        title: "Errors inside the outages".into(),
        blocks,
    })
}

fn table_of(
    name: &str,
    caption: &str,
    models: &[&Model<'_>],
    pick: fn(&ModelErrors) -> &Numbers,
) -> Option<Table> {
    let columns: Vec<&(&str, &str)> = COLUMNS
        .iter()
        .filter(|(key, _)| models.iter().any(|m| get(pick(m.errors), key).is_finite()))
        .collect();
    if columns.is_empty() {
        return None;
    }
    let mut table = table(&format!("errors-{name}"), caption, &["model"]);
    table
        .head
        .extend(columns.iter().map(|(_, head)| (*head).to_owned()));
    for model in models.iter() {
        let mut row: Vec<Cell> = vec![model.name.clone().into()];
        row.extend(
            columns
                .iter()
                .map(|(key, _)| cell(get(pick(model.errors), key))),
        );
        table.rows.push(row);
    }
    for (at, (key, _)) in columns.iter().enumerate() {
        let values: Vec<f64> = models.iter().map(|m| get(pick(m.errors), key)).collect();
        mark_least(&mut table, at + 1, &values);
    }
    Some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift::results::Number;

    #[test]
    fn a_clear_lead_is_rarer_than_chance() {
        // Binomial(15, ½): P(≥ 12) = 1.76 %, both sides 3.5 %; P(≥ 11) = 5.9 %.
        assert!(is_clear(12, 15) && !is_clear(11, 15) && !is_clear(3, 15));
        assert!(!is_clear(0, 0));
    }

    #[test]
    fn the_least_stands_out() {
        let errors = |e: f64| ModelErrors {
            rms: Numbers::from([(HORIZONTAL.to_owned(), Number(e))]),
            ..ModelErrors::default()
        };
        let (a, b) = (errors(2.0), errors(1.0));
        let model = |name: &str, errors| Model {
            name: name.into(),
            key: "",
            run: 0,
            errors,
            drift: Vec::new(),
            colour: 0,
        };
        // Built in place: models borrow their errors.
        let models = [model("a", &a), model("b", &b)];
        let table = table_of("rms", "", &[&models[0], &models[1]], |m| &m.rms).unwrap();
        assert!(!table.rows[0][1].strong && table.rows[1][1].strong);
        assert!(findings(&models)[0].contains("that of b: 1.00 m"));

        // What is a bound is neither best nor in the models' tables.
        let c = errors(0.1);
        let bound = Model {
            key: WHITE_CALIBRATED,
            ..model("c", &c)
        };
        let models = [model("a", &a), model("b", &b), bound];
        assert!(findings(&models)[0].contains("that of b: 1.00 m"));
        let blocks = tables(&models).unwrap().blocks;
        let [Block::Table(rms), Block::Table(bound)] = &blocks[..] else {
            panic!("{} blocks", blocks.len());
        };
        assert_eq!((rms.rows.len(), bound.rows.len()), (2, 1));
        assert!(bound.rows[0].iter().all(|cell| !cell.strong));
    }
}
