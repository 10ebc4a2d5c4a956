//! Results into a document: one told, several of a kind compared, several kinds one after the other.

use super::{Block, Document, Section, fleet, identify, montecarlo, navigate, outages};
use std::path::PathBuf;
use undrift::io::ReadError;
use undrift::results::{Demo, Fleet, Identify, MonteCarlo, Navigate, Outages, Results};

/// The report of results, each a file's path (empty for a single one without) and its text: JSON as
/// the verbs write it.
///
/// # Errors
/// A file that is no result.
pub fn of_results(results: &[(PathBuf, String)]) -> Result<Document, ReadError> {
    let read = |(path, text): &(PathBuf, String)| Ok((path.clone(), Results::read(path, text)?));
    Ok(document(
        &results.iter().map(read).collect::<Result<Vec<_>, _>>()?,
    ))
}

/// The report of results, each with its file's path (empty for a single one without).
pub fn document(results: &[(PathBuf, Results)]) -> Document {
    let names = names(results);
    let mut versions: Vec<&str> = results.iter().map(|(_, result)| result.version()).collect();
    versions.dedup();
    let all = All::of(results, &names);
    let mut sections = Vec::new();
    let kinds = all.kinds();
    let several = kinds.len() > 1;
    let mut add = |what: &str, more: Vec<Section>| {
        sections.extend(more.into_iter().map(|section| Section {
            title: if several {
                format!("{what}: {}", section.title)
            } else {
                section.title
            },
            ..section
        }));
    };
    if !all.demos.is_empty() {
        add("Demo", demo(&all.demos));
    }
    if !all.identified.is_empty() {
        add("Identification", identify::sections(&all.identified));
    }
    if !all.navigated.is_empty() {
        add("Navigation", navigate::sections(&all.navigated));
    }
    if !all.cut.is_empty() {
        add("Outages", outages::sections(&all.cut));
    }
    if !all.fleets.is_empty() {
        add("Fleet", fleet::sections(&all.fleets));
    }
    if !all.simulated.is_empty() {
        add("Monte Carlo", montecarlo::sections(&all.simulated));
    }
    Document {
        title: all.title(&kinds),
        subtitle: format!("undrift {}", versions.join(", ")),
        sections,
    }
}

/// Results by kind, each with its name.
#[derive(Default)]
struct All<'a> {
    identified: Vec<(String, &'a Identify)>,
    navigated: Vec<(String, &'a Navigate)>,
    cut: Vec<(String, &'a Outages)>,
    simulated: Vec<(String, &'a MonteCarlo)>,
    demos: Vec<(String, &'a Demo)>,
    fleets: Vec<(String, &'a Fleet)>,
}

impl<'a> All<'a> {
    fn of(results: &'a [(PathBuf, Results)], names: &[String]) -> Self {
        let mut all = Self::default();
        for ((_, result), name) in results.iter().zip(names) {
            let name = name.clone();
            match result {
                Results::Identify(one) => all.identified.push((name, one)),
                Results::Navigate(one) => all.navigated.push((name, one)),
                Results::Outages(one) => all.cut.push((name, one)),
                Results::MonteCarlo(one) => all.simulated.push((name, one)),
                Results::Demo(one) => all.demos.push((name, one)),
                Results::Fleet(one) => all.fleets.push((name, one)),
            }
        }
        // One of its kind needs no name.
        fn anonymous<T>(runs: &mut [(String, &T)]) {
            if let [(name, _)] = runs {
                name.clear();
            }
        }
        anonymous(&mut all.identified);
        anonymous(&mut all.navigated);
        anonymous(&mut all.cut);
        anonymous(&mut all.simulated);
        anonymous(&mut all.demos);
        anonymous(&mut all.fleets);
        all
    }

    /// What there is, in words.
    fn kinds(&self) -> Vec<(&'static str, usize)> {
        [
            ("The source paper's experiment, simulated", self.demos.len()),
            ("Sensor noise", self.identified.len()),
            ("Navigation", self.navigated.len()),
            ("GNSS outages", self.cut.len()),
            ("Many logs", self.fleets.len()),
            ("Filter consistency", self.simulated.len()),
        ]
        .into_iter()
        .filter(|(_, count)| *count > 0)
        .collect()
    }

    fn title(&self, kinds: &[(&str, usize)]) -> String {
        let whose = |file: Option<&String>| file.filter(|f| !f.is_empty()).cloned();
        let of = match kinds {
            [(_, 1)] => {
                let record = self
                    .identified
                    .first()
                    .and_then(|(_, i)| whose(Some(&i.record)));
                let drive = self
                    .navigated
                    .first()
                    .and_then(|(_, n)| whose(n.drive.file.as_ref()));
                let cut = self
                    .cut
                    .first()
                    .and_then(|(_, o)| whose(o.drive.file.as_ref()));
                record.or(drive).or(cut).map(|name| format!(": {name}"))
            }
            [(_, several)] => Some(format!(", {several} results compared")),
            _ => None,
        };
        let names: Vec<&str> = kinds.iter().map(|(name, _)| *name).collect();
        names.join(", ") + &of.unwrap_or_default()
    }
}

/// The demo: what the paper did, one after the other.
fn demo(demos: &[(String, &Demo)]) -> Vec<Section> {
    let mut intro: Vec<Block> = demos
        .iter()
        .map(|(name, demo)| {
            let prefix = if name.is_empty() {
                String::new()
            } else {
                format!("{name}: ")
            };
            let identified = if demo.identification.is_some() {
                "The noise of the sensors was identified from a simulated static record. The models found "
            } else {
                "The simulation's own noise models "
            };
            Block::Text(format!(
                "{prefix}{identified}were run through the GNSS outages of a simulated drive, seed {}.",
                demo.seed
            ))
        })
        .collect();
    let notes = demos
        .iter()
        .map(|(_, demo)| &demo.note)
        .filter(|n| !n.is_empty());
    let mut told: Vec<&String> = notes.collect();
    told.dedup();
    intro.extend(told.into_iter().map(|note| Block::Text(note.clone())));
    let identified: Vec<(String, &Identify)> = demos
        .iter()
        .filter_map(|(name, demo)| Some((name.clone(), demo.identification.as_ref()?)))
        .collect();
    let cut: Vec<(String, &Outages)> = demos.iter().map(|(n, d)| (n.clone(), &d.outages)).collect();
    let mut sections = vec![Section {
        title: "The experiment".into(),
        blocks: intro,
    }];
    sections.extend(outages::sections(&cut));
    if !identified.is_empty() {
        sections.extend(identify::sections(&identified));
    }
    sections
}

/// Names of the results: those of their files without the ending, with folders where they are the same.
fn names(results: &[(PathBuf, Results)]) -> Vec<String> {
    let stem = |path: &PathBuf| {
        path.file_stem()
            .map_or(String::new(), |s| s.to_string_lossy().into_owned())
    };
    results
        .iter()
        .enumerate()
        .map(|(at, (path, _))| {
            let name = stem(path);
            let same = results
                .iter()
                .filter(|(other, _)| stem(other) == name)
                .count();
            let full = path.display().to_string();
            let alike = results.iter().filter(|(other, _)| other == path).count();
            match (same, alike) {
                (0 | 1, _) => name,
                (_, 0 | 1) => full,
                _ => format!("{full} ({})", at + 1),
            }
        })
        .collect()
}
