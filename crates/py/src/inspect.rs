//! Logs into drives: what the logs are, and a drive file that reads them.

use crate::{
    columns::{self, Named},
    drive::Drive,
    error::{Failure, error},
    work,
};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use undrift::{
    drive,
    inspect::{self as inspection, Inspection},
    io::Memory,
    vehicle::Profile,
};
use undrift_report::inspect as report;

/// Describes logs, each a file, or columns in memory under a name: a drive of them, its drive file, and the description.
#[pyfunction]
pub fn inspect(
    py: Python<'_>,
    logs: Vec<(PathBuf, Option<Named<'_>>)>,
    vehicle: Option<&str>,
) -> PyResult<(Drive, String, String)> {
    let profile = vehicle.map(profile).transpose()?;
    let held = |(path, named): (PathBuf, Option<Named<'_>>)| {
        let columns = named.map(|named| columns::columns(&path, named));
        Ok((path, columns.transpose()?.map(Memory::Columns)))
    };
    let logs = logs.into_iter().map(held).collect::<PyResult<Vec<_>>>()?;
    work::run(py, || drive_of(logs, profile))?.map_err(error)
}

fn profile(name: &str) -> PyResult<Profile> {
    let known = Profile::ALL.into_iter().find(|known| known.name() == name);
    known.ok_or_else(|| {
        let names = Profile::ALL.map(Profile::name).join(", ");
        error(format!("unknown vehicle \"{name}\"; available: {names}"))
    })
}

fn drive_of(
    logs: Vec<(PathBuf, Option<Memory>)>,
    vehicle: Option<Profile>,
) -> Result<(Drive, String, String), Failure> {
    let inspect = |(path, held): (PathBuf, Option<Memory>)| match held {
        Some(held) => inspection::inspect_held(&path, held),
        None => inspection::inspect(&path),
    };
    let found = logs.into_iter().map(inspect);
    let mut found = found.collect::<Result<Vec<_>, _>>()?;
    let motion = inspection::motion(&mut found);
    complete(&found)?;
    let model = inspection::model(&found);
    let home = Path::new("");
    let text = inspection::drive_file(&model, &found, home, vehicle, motion, &report::comment);
    let logs = inspection::logs(&found, home);
    let file = PathBuf::from("<drive>");
    let mut drive = drive::Drive::with_logs(&text, "<drive>", home, logs)?;
    drive.guessed_rate = inspection::guessed_rate(&found);
    drive.pose_faults = inspection::pose_faults(&found);
    let described = report::lead(&found).into_iter();
    let described = Vec::from_iter(described.chain(found.iter().map(report::text)));
    Ok((Drive { drive, file }, text, described.join("\n")))
}

/// A drive needs an IMU and fixes or poses.
fn complete(found: &[Inspection]) -> Result<(), Failure> {
    let fixes = inspection::fixes_table(found);
    for (table, what) in [("imu", "inertial samples"), (fixes, "positions")] {
        let mut parts = found.iter().flat_map(|log| &log.parts);
        match parts.find(|part| part.table == table) {
            Some(part) => {
                if let Some(problem) = &part.problem {
                    return Err(format!("the {what} cannot be read: {problem}").into());
                }
            }
            None => {
                let names = found.iter().map(|log| log.file.display().to_string());
                let names = Vec::from_iter(names).join(" and ");
                let mend = report::unknown_log(found, table);
                let mend = mend.unwrap_or_else(|| {
                    "specify their log too, inspect(imu, gnss) or inspect(imu, poses)".into()
                });
                return Err(format!("no {what} in {names}: {mend}").into());
            }
        }
    }
    Ok(())
}
