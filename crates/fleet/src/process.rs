//! One log into its outcome.

use super::{
    FleetOutcome, Job, OutagePlan, OutcomeRow, RecordSettings, Say, Task, inputs,
    outcome::{Field, IDENTIFY, NAVIGATE, OUTAGES, TUNE},
};
use std::{
    any::Any,
    error::Error,
    panic::{AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
};
use undrift_drive::{
    drive::{Drive, read_text},
    findings::{self, Finding, Log},
    identify,
    navigate::{self, Hindsight, Wanted},
    outages::{Logs, ScheduleError},
    record,
    reference::COMPONENTS,
    replay::Outage,
    temperature,
};
use undrift_io::{Opened, imu::ImuSource};
use undrift_noise::{BiasModel, ImuModel, model_file::AXES};
use undrift_results::{self as results, Cut, ModelErrors, Number, Numbers, Statement};
use undrift_tune::{
    self as tune,
    noise::{WALK, WHITE},
    tune,
};

/// Works a job out. The outcome depends on the job and the files that it names alone; whatever goes
/// wrong is in [`FleetOutcome::failed`]. On all cores of the pool that it is called in.
pub fn process(job: &Job, say: Say) -> FleetOutcome {
    let mut outcome = FleetOutcome::new(job);
    let (home, data) = job.folders();
    let folders = [data, home, PathBuf::from(&job.folder)];
    let failed = isolated(|| {
        // Reported here: the readers of these files name their neighbours, too, which are no part of the job.
        if let Some((_, path)) = inputs(job).iter().find(|(_, path)| !path.exists()) {
            return Err(JobError::NoFile(path.clone()).into());
        }
        match &job.task {
            Task::Navigate {
                bias_models,
                smooth,
            } => navigate(job, bias_models, *smooth, &mut outcome, say),
            Task::Outages {
                bias_models,
                plan,
                smooth,
            } => outages(job, bias_models, plan, *smooth, &mut outcome, say),
            Task::Tune => tuned(job, &mut outcome),
            Task::Identify(settings) => identify(job, settings, &mut outcome, say),
        }
    });
    outcome.failed = failed.err().map(|error| reasons(&*error));
    if outcome.failed.is_none() && outcome.rows.is_empty() {
        let first = outcome.failed_parts.iter().next();
        let why = first.map(|(part, why)| format!("{part}: {why}"));
        outcome.failed = Some(why.unwrap_or_else(|| JobError::NoResult.to_string()));
    }
    if outcome.failed.is_some() {
        outcome.rows.clear();
    }
    // Where the files lie is no part of what they hold.
    let texts = outcome
        .failed
        .iter_mut()
        .chain(outcome.failed_parts.values_mut())
        .chain(&mut outcome.warnings)
        .chain(outcome.findings.iter_mut().filter_map(|found| match found {
            Finding::Skipped { kinds, .. } => Some(kinds),
            _ => None,
        }));
    for text in texts {
        *text = without_folders(text, &folders);
    }
    let say = |found: &Finding| say(Statement::Finding(found));
    let sentences = outcome.findings.iter().map(say);
    outcome.warnings.splice(0..0, sentences);
    for row in &mut outcome.rows {
        row.note = row.finding.as_ref().map(say).or(row.note.take());
    }
    outcome
}

/// Why a job has no outcome.
#[derive(Debug, thiserror::Error)]
enum JobError {
    /// A file of it is missing.
    #[error("{}: no such file", .0.display())]
    NoFile(PathBuf),
    /// It has neither a result nor an error.
    #[error("there is no result")]
    NoResult,
    /// A fault in the program: a panic, with its message.
    #[error("internal error: {0}")]
    Panic(String),
}

type Failure = Box<dyn Error + Send + Sync>;

/// Why something has no result, with all causes that the text does not have already.
fn reasons(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let more = error.to_string();
        if !text.contains(&more) {
            text = format!("{text}: {more}");
        }
        cause = error.source();
    }
    text
}

/// Does something; a panic is no more than an error.
fn isolated(work: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
    let message = |panic: Box<dyn Any + Send>| match panic.downcast::<String>() {
        Ok(text) => *text,
        Err(other) => (*other.downcast_ref::<&str>().unwrap_or(&"")).to_owned(),
    };
    catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|panic| Err(JobError::Panic(message(panic)).into()))
}

/// A text in which files go by their names relative to the folders.
fn without_folders(text: &str, folders: &[PathBuf]) -> String {
    let mut text = text.to_owned();
    for folder in folders {
        let mut folder = folder.display().to_string();
        if folder.is_empty() {
            continue;
        }
        if !folder.ends_with('/') {
            folder.push('/');
        }
        let mut out = String::new();
        let mut rest = text.as_str();
        while let Some((before, after)) = rest.split_once(folder.as_str()) {
            out += before;
            // Inside of another path it is not the folder.
            let inside = |c: char| c.is_alphanumeric() || "._-/".contains(c);
            if out.ends_with(inside) {
                out += &folder;
            }
            rest = after;
        }
        text = out + rest;
    }
    text
}

/// The drive with the model that the job asks for; the temperature of its inertial log.
fn load(job: &Job, outcome: &mut FleetOutcome) -> Result<Drive, Failure> {
    let (home, data) = job.folders();
    let (text, _) = read_text(&job.path())?;
    let mut drive = Drive::from_toml(&text, job.file(), &home, &data)?;
    if let Some(name) = &job.model {
        let model = ImuModel::resolve(name, Path::new(&job.folder))?;
        drive.model = Some(model);
    }
    let model = drive.model.as_ref().map(|model| model.name.clone());
    outcome.sensor = outcome.sensor.take().or(model);
    if outcome.temperature_c.is_none() && matches!(drive.imu.1.source, ImuSource::Table { .. }) {
        outcome.temperature_c = temperature::mean(&drive.imu.0)?;
    }
    Ok(drive)
}

/// The numbers of a result in their columns.
fn values<R>(fields: &[Field<R>], result: &R) -> Vec<Option<f64>> {
    fields.iter().map(|(_, of)| of(result).get()).collect()
}

/// Errors by component; of no reference they are empty.
fn components(errors: Option<&Numbers>) -> impl Iterator<Item = Option<f64>> {
    COMPONENTS.iter().map(move |name| errors?.get(*name)?.get())
}

fn outages(
    job: &Job,
    kinds: &[BiasModel],
    plan: &OutagePlan,
    smooth: bool,
    outcome: &mut FleetOutcome,
    say: Say,
) -> Result<(), Failure> {
    let drive = load(job, outcome)?;
    let hindsight = Hindsight::asked(false, smooth);
    let logs = Logs::load(&drive, hindsight)?;
    let schedule = plan.schedule().ok_or(ScheduleError::Zero)?;
    let cuts = logs.plan(&schedule, plan.length_s)?;
    let experiment = logs.run(kinds, &cuts, hindsight, &|_| {})?;
    outcome.findings = logs.findings(&experiment);
    for (name, run) in &experiment.runs {
        let found = match run {
            Ok(run) => run.errors.result(say),
            Err(error) => {
                outcome.failed_parts.insert(name.clone(), reasons(error));
                continue;
            }
        };
        outcome
            .rows
            .extend(outage_rows(name, &experiment.cuts, found));
    }
    Ok(())
}

/// A row for each outage of a model.
fn outage_rows(name: &str, cuts: &[Outage], found: ModelErrors) -> Vec<OutcomeRow> {
    let per_outage = cuts.iter().map(Cut::from).zip(found.per_outage);
    let row = |(of, which)| {
        let mut values = values(&OUTAGES, &of);
        values.extend(components(Some(&of.1.max)));
        values.extend(components(Some(&of.1.end)));
        OutcomeRow {
            part: name.to_owned(),
            outage: Some(which),
            finding: found.finding.clone(),
            values,
            ..OutcomeRow::default()
        }
    };
    per_outage.zip(1..).map(row).collect()
}

fn navigate(
    job: &Job,
    kinds: &[BiasModel],
    smooth: bool,
    outcome: &mut FleetOutcome,
    say: Say,
) -> Result<(), Failure> {
    let drive = load(job, outcome)?;
    for kind in kinds {
        let wanted = Wanted {
            hindsight: Hindsight::asked(false, smooth),
            ..Wanted::default()
        };
        let name = kind.name().to_owned();
        let result = match navigate::navigate(&drive, *kind, wanted) {
            Ok(report) => report.result(*kind, results::Drive::default(), say),
            Err(error) => {
                outcome.findings.extend(error.findings());
                outcome.failed_parts.insert(name, reasons(&error));
                continue;
            }
        };
        let mut values = values(&NAVIGATE, &result);
        values.extend(components(result.rms_error.as_ref()));
        for finding in result.findings {
            if !outcome.findings.contains(&finding) {
                outcome.findings.push(finding);
            }
        }
        let diverged = result.summary.diverged;
        outcome.rows.push(OutcomeRow {
            part: name,
            finding: diverged.map(|time| Finding::Diverged { time }),
            values,
            ..OutcomeRow::default()
        });
    }
    Ok(())
}

/// A row for each axis, null where the drive does not determine it, and one for the drift of each length.
fn tuned(job: &Job, outcome: &mut FleetOutcome) -> Result<(), Failure> {
    let drive = load(job, outcome)?;
    let (tuned, _) = tune(&[drive], &tune::Options::default(), &|_| true)?;
    outcome
        .sensor
        .get_or_insert_with(|| tuned.start.name.clone());
    let row = |part: String, values: [f64; TUNE.len()]| OutcomeRow {
        part,
        values: values.map(|value| Number(value).get()).to_vec(),
        ..OutcomeRow::default()
    };
    // The result has factors where the white noise follows the vibration; logs are compared by its density.
    let densities = tuned.densities();
    for (axis, name) in AXES.iter().enumerate() {
        let found = |i: usize, value: f64| match tuned.fit.determines(&tuned.prior, i) {
            true => value,
            false => f64::NAN,
        };
        let white = found(WHITE + axis, densities[axis]);
        let walk = found(WALK + axis, tuned.fit.noise.walk[axis]);
        let louder = white / tuned.start.white[axis];
        let values = [f64::NAN, white, walk, louder, f64::NAN, f64::NAN];
        outcome.rows.push(row((*name).to_owned(), values));
    }
    for judged in &tuned.judged {
        let [before, after] = judged.rms();
        let part = format!("{} s", judged.length);
        let values = [judged.length, f64::NAN, f64::NAN, f64::NAN, before, after];
        outcome.rows.push(row(part, values));
    }
    Ok(())
}

fn identify(
    job: &Job,
    settings: &RecordSettings,
    outcome: &mut FleetOutcome,
    say: Say,
) -> Result<(), Failure> {
    let path = job.path();
    let record = record::read(Opened::open(&path)?, &settings.format())?;
    if let (None, Some(values)) = (outcome.temperature_c, &record.temperature) {
        let known = || values.iter().filter(|t| t.is_finite());
        outcome.temperature_c = Some(known().sum::<f64>() / known().count() as f64);
    }
    let skipped = (Log::Recording, &record.skipped);
    outcome.findings.extend(findings::of_skipped(&[skipped]));
    let timing = record.timing.as_ref();
    outcome.findings.extend(findings::of_timing(timing));
    let settings = settings.identification();
    let mut prepared = identify::prepare(record, &settings)?;
    if let Some(problem) = prepared.not_static.take() {
        return Err(problem.into());
    }
    let identified = identify::recordings(&[prepared], &settings, || {})?;
    let result = identified.result(&job.log, say);
    for (name, _) in &identified.axes {
        let Some(axis) = result.axes.get(*name) else {
            continue;
        };
        if let Some(error) = &axis.error {
            outcome
                .failed_parts
                .insert((*name).to_owned(), error.clone());
            continue;
        }
        let warnings = axis.warnings.iter();
        outcome
            .warnings
            .extend(warnings.map(|w| format!("{name}: {w}")));
        outcome.rows.push(OutcomeRow {
            part: (*name).to_owned(),
            note: Some(axis.chosen.name.clone()),
            values: values(&IDENTIFY, axis),
            ..OutcomeRow::default()
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error() {
        let formatted = isolated(|| panic!("{} is wrong", 3)).unwrap_err();
        assert_eq!(formatted.to_string(), "internal error: 3 is wrong");
        let plain = isolated(|| panic!("plain")).unwrap_err();
        assert_eq!(plain.to_string(), "internal error: plain");
        assert!(isolated(|| Ok(())).is_ok());
    }

    #[test]
    fn files_go_by_their_names() {
        let folders = ["/data/a", "logs", ""].map(PathBuf::from);
        for (text, wanted) in [
            ("/data/a/imu.csv line 3: bad", "imu.csv line 3: bad"),
            ("\"logs/x\" and (logs/y)", "\"x\" and (y)"),
            ("my/logs/x, catalogs/y", "my/logs/x, catalogs/y"),
            ("/mnt/data/a/x", "/mnt/data/a/x"),
        ] {
            assert_eq!(without_folders(text, &folders), wanted);
        }
    }

    #[test]
    fn an_outage_has_a_row_with_what_its_model_is_to_be_doubted_for() {
        use undrift_results::OutageErrors;
        let cuts = [(10.0, 40.0), (100.0, 160.0)].map(|(start, end)| Outage { start, end });
        let errors = |size: f64| -> Numbers {
            let sized = COMPONENTS.iter().enumerate();
            sized
                .map(|(i, name)| ((*name).to_owned(), Number(size + i as f64)))
                .collect()
        };
        let outage = |size: f64, cut: &Outage| OutageErrors {
            start_s: cut.start.into(),
            max: errors(size),
            end: errors(0.5 * size),
            ..OutageErrors::default()
        };
        let doubt = Finding::Diverged { time: 50.0 };
        let found = ModelErrors {
            per_outage: vec![outage(10.0, &cuts[0]), outage(20.0, &cuts[1])],
            finding: Some(doubt.clone()),
            ..ModelErrors::default()
        };
        let rows = outage_rows("arma", &cuts, found);
        assert_eq!(rows.len(), 2);
        for (k, (row, size)) in rows.iter().zip([10.0, 20.0]).enumerate() {
            assert_eq!(
                (row.part.as_str(), row.outage),
                ("arma", Some(k as u32 + 1))
            );
            assert_eq!(row.finding.as_ref(), Some(&doubt));
            let n = COMPONENTS.len();
            assert_eq!(row.values.len(), OUTAGES.len() + 2 * n);
            let own = &row.values[..OUTAGES.len()];
            for expected in [cuts[k].start, cuts[k].end - cuts[k].start] {
                assert!(own.contains(&Some(expected)), "{own:?}");
            }
            for i in 0..n {
                let at = OUTAGES.len() + i;
                assert_eq!(row.values[at], Some(size + i as f64));
                assert_eq!(row.values[at + n], Some(0.5 * size + i as f64));
            }
        }
        assert!(components(None).all(|value| value.is_none()));
    }

    #[test]
    fn an_error_is_reported_with_the_causes_that_it_does_not_say() {
        #[derive(Debug, thiserror::Error)]
        #[error("{text}")]
        struct Layer {
            text: &'static str,
            source: Option<Box<Layer>>,
        }
        let deepest = Layer {
            text: "disk full",
            source: None,
        };
        let middle = Layer {
            text: "cannot write",
            source: Some(Box::new(deepest)),
        };
        let top = Layer {
            text: "a.csv: cannot write",
            source: Some(Box::new(middle)),
        };
        assert_eq!(reasons(&top), "a.csv: cannot write: disk full");
    }
}
