//! Results into a document: one reported, several of a kind compared, several kinds one after the other.

use super::{
    Document, Section, demo, fleet, identify, montecarlo, navigate, outages,
    parts::{Run, prefixed},
    read::read,
    say::words::worded,
    tune,
};
use std::path::PathBuf;
use undrift_io::ReadError;
use undrift_results::Results;

/// The report of results, each a file's path (empty for a single one without) and its text: JSON as
/// the verbs write it.
///
/// # Errors
/// A file that is no result.
pub fn of_results(results: &[(PathBuf, String)]) -> Result<Document, ReadError> {
    let named = |(path, text): &(PathBuf, String)| Ok((path.clone(), read(path, text)?));
    Ok(document(
        &results.iter().map(named).collect::<Result<Vec<_>, _>>()?,
    ))
}

/// The report of results, each with its file's path (empty for a single one without).
pub fn document(results: &[(PathBuf, Results)]) -> Document {
    let mut versions: Vec<&str> = results.iter().map(|(_, result)| result.version()).collect();
    versions.dedup();
    let (mut demos, mut identified, mut navigated) = (Vec::new(), Vec::new(), Vec::new());
    let (mut cut, mut fleets, mut simulated) = (Vec::new(), Vec::new(), Vec::new());
    let mut tuned = Vec::new();
    for ((_, result), name) in results.iter().zip(names(results)) {
        match result {
            Results::Identify(one) => identified.push((name, one)),
            Results::Navigate(one) => navigated.push((name, &**one)),
            Results::Outages(one) => cut.push((name, &**one)),
            Results::MonteCarlo(one) => simulated.push((name, one)),
            Results::Demo(one) => demos.push((name, &**one)),
            Results::Fleet(one) => fleets.push((name, one)),
            Results::Tune(one) => tuned.push((name, one)),
        }
    }
    let experiment = "Drift without GNSS, model by model";
    let simulations = "Filter consistency";
    let chapters = [
        chapter(experiment, "Demo", demos, demo::sections),
        chapter(
            "Sensor noise",
            "Identification",
            identified,
            identify::sections,
        ),
        chapter("Noise in the vehicle", "Tuning", tuned, tune::sections),
        chapter("Navigation", "Navigation", navigated, navigate::sections),
        chapter("GNSS outages", "Outages", cut, outages::sections),
        chapter("Many logs", "Fleet", fleets, fleet::sections),
        chapter(simulations, "Monte Carlo", simulated, montecarlo::sections),
    ];
    let mut chapters: Vec<Chapter> = chapters.into_iter().flatten().collect();
    if chapters.len() > 1 {
        for chapter in &mut chapters {
            for section in &mut chapter.sections {
                section.title = prefixed(chapter.what, &section.title);
            }
        }
    }
    let titles: Vec<&str> = chapters.iter().map(|chapter| chapter.title).collect();
    let of = match (results, chapters.len()) {
        ([(_, result)], _) => logs(result).map(|name| format!(": {name}")),
        (several, 1) => Some(format!(", {} results compared", several.len())),
        _ => None,
    };
    let mut document = Document {
        title: titles.join(", ") + &of.unwrap_or_default(),
        subtitle: format!("undrift {}", versions.join(", ")),
        sections: chapters.into_iter().flat_map(|c| c.sections).collect(),
    };
    if results.iter().all(|(_, result)| is_posed(result)) {
        document.each_text(&mut |text| *text = worded(std::mem::take(text), true));
    }
    document
}

/// Whether a result is of drives by poses.
fn is_posed(result: &Results) -> bool {
    match result {
        Results::Navigate(one) => one.drive.posed,
        Results::Outages(one) => one.drive.posed,
        Results::Tune(one) => one.drives.iter().any(|drive| drive.posed),
        _ => false,
    }
}

/// The results of one kind.
struct Chapter {
    /// What they are, in the document's title.
    title: &'static str,
    /// What their sections are called beside those of another kind.
    what: &'static str,
    sections: Vec<Section>,
}

fn chapter<'a, T>(
    title: &'static str,
    what: &'static str,
    mut runs: Vec<Run<'a, T>>,
    sections: fn(&[Run<'a, T>]) -> Vec<Section>,
) -> Option<Chapter> {
    // One of its kind needs no name.
    if let [(name, _)] = runs.as_mut_slice() {
        name.clear();
    }
    (!runs.is_empty()).then(|| Chapter {
        title,
        what,
        sections: sections(&runs),
    })
}

/// The record or drive that a result is of.
fn logs(result: &Results) -> Option<&str> {
    let name = match result {
        Results::Identify(identified) => &identified.record,
        Results::Navigate(navigated) => navigated.drive.file.as_ref()?,
        Results::Outages(cut) => cut.drive.file.as_ref()?,
        Results::Tune(tuned) => tuned.drives.first()?.file.as_ref()?,
        _ => return None,
    };
    Some(name.as_str()).filter(|name| !name.is_empty())
}

/// Names of the results: those of their files without the ending, with folders where they are the same.
fn names(results: &[(PathBuf, Results)]) -> Vec<String> {
    let stem = |path: &PathBuf| {
        path.file_stem()
            .map_or(String::new(), |s| s.to_string_lossy().into_owned())
    };
    let name = |(at, (path, _)): (usize, &(PathBuf, Results))| {
        let count = |same: &dyn Fn(&PathBuf) -> bool| results.iter().filter(|r| same(&r.0)).count();
        let name = stem(path);
        if count(&|other| stem(other) == name) < 2 {
            name
        } else if count(&|other| other == path) < 2 {
            path.display().to_string()
        } else {
            format!("{} ({})", path.display(), at + 1)
        }
    };
    results.iter().enumerate().map(name).collect()
}

#[cfg(test)]
mod tests;
