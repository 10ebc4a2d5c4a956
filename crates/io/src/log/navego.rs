//! NaveGo's structures in a MATLAB file of level 5, `save -v6` or `-v7`: as NaveGo's `ins_gnss.m`
//! describes them. One variable is held in memory at a time, of 512 MiB at most.
//!
//! Streams are variables. What one holds is known by its fields, vectors of one length:
//!
//! * `t` \[s\], `fb` [m/s²], `wb` [rad/s]: inertial samples, forward-right-down; `fb` is the specific
//!   force, −9.8 m/s² down at rest.
//! * `t`, `lat`, `lon` \[rad\], `h` \[m\]: fixes, with `vel` north-east-down [m/s] if it is there, and the
//!   standard deviations `stdm` north-east-down \[m\] and `stdv` [m/s], one row for all or one each; what
//!   is missing, zero or not finite is unknown. `larm`, the antenna's place in the body \[m\], is shown
//!   with the stream and has to be configured.
//! * The same with `roll`, `pitch`, `yaw` \[rad\], or else `DCMnb_m`: a reference solution.
//! * `t` and `vel` alone: velocities, which are not read by themselves.
//!
//! Matrices may have the vectors as rows or as columns. `DCMnb_m` holds in each row the matrix from
//! navigation to body axes, column by column.

mod mat;
mod rows;
#[cfg(test)]
mod tests;

use self::mat::{Variable, Variables};
use self::rows::rows;
use crate::ReadError;
use crate::entry::{Entries, Entry, Stream, StreamKind, Wanted, What};
use crate::error::{NAMES_SHOWN, the_file_has};
use crate::skipped::SkipKind;
use crate::source::Source;

/// Whether a file that starts so is a MATLAB file of level 5, or of 7.3, which is refused later.
pub(crate) fn detect(start: &[u8]) -> bool {
    start.starts_with(mat::LEVEL_5) || start.starts_with(mat::HDF5)
}

pub(super) fn entries(source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    let (name, kind, key) = wanted.one_stream()?;
    let error = |problem: String| ReadError::nameless(problem).key(key.clone());
    let mut variables = Variables::open(source)?;
    let mut there = Vec::new();
    let is_named = name.is_some();
    let mut found = None;
    // What is damaged behind the variable that is wanted does not matter.
    let mut broken = None;
    while let Some(variable) = variables.next().unwrap_or_else(|problem| {
        broken = Some(problem);
        None
    }) {
        let this_kind = kind_of(&variable);
        let is_wanted = match name {
            Some(name) => variable.name == *name,
            None => this_kind == kind,
        };
        if is_wanted && this_kind != kind {
            let problem = format!("{} is no {}", variable.name, fields_of(kind));
            return Err(error(problem));
        }
        if there.len() <= NAMES_SHOWN {
            there.push(variable.name.clone());
        }
        if !is_wanted {
            continue;
        }
        if let Some((first, _)) = &found {
            let problem = format!("{first} and {} are both {}", variable.name, fields_of(kind));
            return Err(error(problem).mend("choose one with topic"));
        }
        let name = variable.name.clone();
        let rows = rows(variable, kind).map_err(|problem| error(format!("{name}: {problem}")))?;
        found = Some((name, rows));
        if is_named {
            break;
        }
    }
    let Some((_, (count, row))) = found else {
        let problem = match (broken, name) {
            (Some(problem), _) => return Err(error(problem)),
            (None, Some(name)) => format!("no variable {name}"),
            (None, None) => format!("no {}", fields_of(kind)),
        };
        let mut mend = the_file_has(&there, NAMES_SHOWN);
        if !there.is_empty() && there.len() <= NAMES_SHOWN {
            let all = there.iter().map(|name| format!("m[\"{name}\"]"));
            let all = Vec::from_iter(all).join(", ");
            mend += &format!(
                "; columns of numbers become a table in Python: `import numpy, scipy.io; m = scipy.io.loadmat(\"FILE.mat\", squeeze_me=True); numpy.savetxt(\"log.csv\", numpy.column_stack([{all}]), delimiter=\",\")`"
            );
        }
        return Err(error(problem).mend(mend));
    };
    let rows = (0..count).map(move |index| Entry {
        at: index as u64 + 1,
        what: row(index),
    });
    let early = broken.map(|problem| Entry {
        at: count.max(1) as u64,
        what: What::Skipped(SkipKind::EndsEarly, problem),
    });
    Ok(Entries::dated(
        rows.chain(early).map(|entry| Ok((entry, None))),
    ))
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    let mut variables = Variables::open(source)?;
    let mut streams = Vec::new();
    while let Ok(Some(variable)) = variables.next() {
        let kind = kind_of(&variable);
        streams.push(Stream {
            kind,
            about: about(&variable),
            messages: variable.field("t").map_or(0, mat::Numbers::len) as u64,
            name: variable.name,
        });
    }
    if streams.is_empty() {
        return Err(ReadError::nameless("has no variable that can be read"));
    }
    Ok(streams)
}

/// What a variable holds, by the fields that it has.
fn kind_of(variable: &Variable) -> StreamKind {
    let has = |names: &[&str]| names.iter().all(|name| variable.field(name).is_some());
    if !has(&["t"]) {
        StreamKind::Other
    } else if has(&["fb", "wb"]) {
        StreamKind::Imu
    } else if has(&["lat", "lon", "h"]) {
        if has(&["roll", "pitch", "yaw"]) || has(&["DCMnb_m"]) {
            StreamKind::Poses
        } else {
            StreamKind::Fixes
        }
    } else if has(&["vel"]) {
        StreamKind::Velocity
    } else {
        StreamKind::Other
    }
}

fn fields_of(kind: StreamKind) -> &'static str {
    match kind {
        StreamKind::Imu => "structure with t, fb, wb",
        StreamKind::Fixes => "structure with t, lat, lon, h",
        StreamKind::Poses => "structure with t, lat, lon, h, roll, pitch, yaw",
        StreamKind::Velocity => "structure with t, vel",
        StreamKind::LocalPoses
        | StreamKind::Headings
        | StreamKind::Fields
        | StreamKind::Observations
        | StreamKind::Other => "structure that is read",
    }
}

fn about(variable: &Variable) -> String {
    let Some(fields) = &variable.fields else {
        return variable.about.clone();
    };
    let names: Vec<&str> = fields.iter().map(|(name, _)| name.as_str()).collect();
    let shown = names.get(..NAMES_SHOWN).unwrap_or(&names).join(", ");
    let arm = variable.field("larm").filter(|arm| arm.len() == 3);
    let arm = arm.map_or(String::new(), |arm| {
        let [x, y, z] = arm.some::<3>(0, 1);
        format!("; larm {x}, {y}, {z} m")
    });
    format!("{} with {shown}{arm}", variable.about)
}
