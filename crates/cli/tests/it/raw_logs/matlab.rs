//! NaveGo's structures in a MATLAB file of level 5, not compressed.

use super::log::{Log, Sample};
use std::{
    fs,
    path::{Path, PathBuf},
};

fn element(kind: u32, content: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    pack!(out; kind, content.len() as u32);
    out.extend(content);
    out.resize(out.len().next_multiple_of(8), 0);
    out
}

fn matrix(class: u32, shape: [usize; 2], name: &str, rest: &[u8]) -> Vec<u8> {
    let (mut flags, mut dimensions) = (Vec::new(), Vec::new());
    pack!(flags; class, 0u32);
    shape.iter().for_each(|n| pack!(dimensions; *n as i32));
    let head = [
        element(6, &flags),
        element(5, &dimensions),
        element(1, name.as_bytes()),
    ];
    element(14, &[&head.concat(), rest].concat())
}

/// A structure of matrices of doubles with `width` columns each.
fn structure(name: &str, fields: &[(&str, usize, Vec<f64>)]) -> Vec<u8> {
    let names = fields.iter().flat_map(|(name, ..)| {
        let mut name = name.as_bytes().to_vec();
        name.resize(8, 0);
        name
    });
    let mut rest = [
        element(5, &8i32.to_le_bytes()),
        element(1, &Vec::from_iter(names)),
    ]
    .concat();
    for (_, width, rows) in fields {
        let height = rows.len() / width;
        let mut bytes = Vec::new();
        for k in 0..rows.len() {
            pack!(bytes; rows[k % height * width + k / height]);
        }
        rest.extend(matrix(6, [height, *width], "", &element(9, &bytes)));
    }
    matrix(2, [1, 1], name, &rest)
}

pub fn navego(log: &Log, folder: &Path) -> Vec<PathBuf> {
    let of =
        |value: fn(&Sample) -> &[f64]| log.samples.iter().flat_map(|s| value(s).to_vec()).collect();
    let imu = structure(
        "imu",
        &[
            (
                "t",
                1,
                log.samples.iter().map(|sample| sample.time).collect(),
            ),
            ("fb", 3, of(|sample| sample.accel.as_slice())),
            ("wb", 3, of(|sample| sample.gyro.as_slice())),
        ],
    );
    let place = |k: usize| log.fixes.iter().map(move |fix| fix.place[k]);
    let std = |k: usize| {
        log.fixes
            .iter()
            .flat_map(|fix| fix.std[k].as_slice().to_vec())
            .collect()
    };
    let velocity: Vec<f64> = log
        .fixes
        .iter()
        .filter_map(|fix| fix.velocity)
        .flat_map(|v| v.as_slice().to_vec())
        .collect();
    let mut fields = vec![
        ("t", 1, log.fixes.iter().map(|fix| fix.time).collect()),
        ("lat", 1, place(0).map(f64::to_radians).collect()),
        ("lon", 1, place(1).map(f64::to_radians).collect()),
        ("h", 1, place(2).collect()),
        ("stdm", 3, std(0)),
    ];
    if !velocity.is_empty() {
        fields.extend([("vel", 3, velocity), ("stdv", 3, std(1))]);
    }
    let gnss = structure("gnss", &fields);
    let mut head = format!("{:124}", "MATLAB 5.0 MAT-file").into_bytes();
    head.extend(b"\x00\x01IM");
    let file = folder.join("drive.mat");
    fs::write(&file, [head, imu, gnss].concat()).unwrap();
    vec![file]
}
