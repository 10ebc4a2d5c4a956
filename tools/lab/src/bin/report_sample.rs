//! Writes sample reports with every kind of block and plot: `report_sample DIR`. The browser tests
//! read them.

use std::{f64::consts::TAU, path::PathBuf};
use undrift_report::{
    Block, Cell, Document, Figure, Panel, PlotAxis as Axis, Section, Series, Table, figures, html,
};

const HOSTILE: &str = "</script><img src=x onerror=alert(1)><!--<script>\"'&";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let dir: PathBuf = std::env::args_os()
        .nth(1)
        .ok_or("usage: report_sample DIR")?
        .into();
    std::fs::create_dir_all(&dir)?;
    let kinds = kinds();
    for (name, document) in [
        ("kinds", &kinds),
        ("hostile", &hostile()),
        ("large", &large()),
    ] {
        std::fs::write(
            dir.join(name).with_extension("html"),
            html::render(document),
        )?;
    }
    figures::write(&kinds, &dir.join("figures"))?;
    figures::write(&hostile(), &dir.join("figures-hostile"))?;
    Ok(())
}

/// Repeatable noise, about normal.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    move || {
        (0..12)
            .map(|_| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 11) as f64 / (1u64 << 53) as f64
            })
            .sum::<f64>()
            - 6.0
    }
}

fn figure(name: &str, caption: &str, columns: usize, panels: Vec<Panel>) -> Block {
    Block::Figure(Figure {
        name: name.into(),
        caption: caption.into(),
        columns,
        panels,
    })
}

fn kinds() -> Document {
    let model = |name: &str, rms: f64, worst: f64, best: bool| {
        let rms = Cell::number(rms, 2);
        vec![
            name.into(),
            if best { rms.strong() } else { rms },
            Cell::number(worst, 2),
        ]
    };
    let table = Block::Table(Table {
        name: "drift".into(),
        caption: "Horizontal error at the end of 24 outages of 60 s.".into(),
        head: ["Model", "RMS [m]", "Worst [m]"].map(String::from).to_vec(),
        rows: vec![
            model("White noise", 41.83, 96.2, false),
            model("Random walk", 23.9, 61.75, false),
            model("Gauss–Markov", 18.42, 44.0, false),
            model("AR(3)", 12.07, 31.66, true),
            model("AR(6), not converged", f64::NAN, f64::NAN, false),
        ],
    });
    Document {
        title: "Drive through the old town".into(),
        subtitle: "ZED-F9R, ICM-20948, 30 min, 24 outages of 60 s".into(),
        sections: vec![
            Section {
                title: "Summary".into(),
                blocks: vec![
                    Block::Text(
                        "Among four models of the gyro's noise the autoregression of order 3 drifts least: 12.1 m RMS at the end of a minute without GNSS, 35 % less than a Gauss–Markov process.".into(),
                    ),
                    Block::Warning("The log has a gap of 3.2 s at 612 s; the outage there was left out.".into()),
                    table,
                ],
                ..Section::default()
            },
            Section {
                title: "Drift".into(),
                blocks: vec![
                    figure("drive", "The drive, and the horizontal error since the cut.", 2, vec![trajectory(), drift()]),
                    figure("time", "Two panels of one time: zoom one, and both follow. Outages are shaded.", 1, vec![velocity(), bias()]),
                ],
                ..Section::default()
            },
            Section {
                title: "Noise".into(),
                blocks: vec![
                    figure("allan", "Allan deviation of the gyro's axes with the band of 95 %.", 1, vec![allan()]),
                    figure("acf", "Autocorrelation of the residuals, and the errors of the models.", 2, vec![acf(), boxes(), bars(), dots()]),
                    Block::Table(wide_table()),
                ],
                ..Section::default()
            },
        ],
    }
}

fn trajectory() -> Panel {
    let at = |i: usize| {
        let s = i as f64 / 2000.0 * TAU;
        (
            900.0 * s.sin() + 90.0 * (7.0 * s).cos(),
            320.0 * (2.0 * s).sin() + 60.0 * (5.0 * s).sin(),
        )
    };
    let mut panel = Panel::new("Track", Axis::new("east [m]"), Axis::new("north [m]")).to_scale();
    panel.add(Series::thin("reference", 1, (0..=2000).map(at).collect()));
    // Three outages: a line with gaps.
    let cut = |i: usize| {
        let (x, y) = at(i);
        (
            x,
            if (i / 150).is_multiple_of(4) {
                y
            } else {
                f64::NAN
            },
        )
    };
    panel.add(Series::thick("outages", 6, (0..=2000).map(cut).collect()));
    panel
}

fn drift() -> Panel {
    let mut panel = Panel::new(
        "Drift",
        Axis::new("time since the cut [s]"),
        Axis::logarithmic("horizontal error [m]"),
    );
    let curve = |a: f64, b: f64| {
        (0..=240)
            .map(|i| i as f64 * 0.25)
            .map(|t| (t, 0.3 + a * t + b * t * t))
            .collect::<Vec<_>>()
    };
    let spread: Vec<_> = curve(0.02, 0.003)
        .iter()
        .map(|&(t, e)| (t, e / 1.8, e * 1.7))
        .collect();
    panel.add(Series::band("AR(3), 10–90 %", 7, &spread));
    panel.add(Series::line("White noise", 1, curve(0.1, 0.0102)));
    panel.add(Series::line("Random walk", 5, curve(0.06, 0.0056)));
    panel.add(Series::dashed("Gauss–Markov", 4, curve(0.05, 0.0042)));
    panel.add(Series::thick("AR(3)", 7, curve(0.02, 0.003)));
    panel
}

fn velocity() -> Panel {
    let mut panel = Panel::new(
        "Velocity",
        Axis::new("time [s]"),
        Axis::new("velocity [m/s]"),
    );
    panel.shade(120.0, 180.0);
    panel.shade(400.0, 460.0);
    let mut eps = noise(1);
    // 1e5 samples; a gap of missing values.
    let line = (0..100_000).map(|i| {
        let t = i as f64 * 0.01;
        (
            t,
            if (612.0..615.2).contains(&t) {
                f64::NAN
            } else {
                12.0 + 6.0 * (t / 40.0).sin() + 0.5 * eps()
            },
        )
    });
    panel.add(Series::thin("north", 7, line.collect()));
    panel.add(Series::line(
        "east",
        6,
        (0..2000)
            .map(|i| i as f64 * 0.5)
            .map(|t| (t, 5.0 * (t / 70.0).cos()))
            .collect(),
    ));
    panel
}

fn bias() -> Panel {
    let mut panel = Panel::new(
        "Gyro bias",
        Axis::new("time [s]"),
        Axis::new("bias [deg/h]"),
    );
    panel.shade(120.0, 180.0);
    panel.shade(400.0, 460.0);
    let mut eps = noise(2);
    let mut value = 0.0;
    let walk: Vec<(f64, f64)> = (0..2000)
        .map(|i| {
            value += 0.4 * eps();
            (i as f64 * 0.5, value)
        })
        .collect();
    let band: Vec<_> = walk
        .iter()
        .map(|&(t, v)| {
            let s = 4.0 + 12.0 * (-t / 100.0).exp();
            (t, v - s, v + s)
        })
        .collect();
    panel.add(Series::band("±2σ", 4, &band));
    panel.add(Series::line("gyro z", 4, walk));
    panel
}

fn allan() -> Panel {
    let mut panel = Panel::new(
        "",
        Axis::logarithmic("averaging time [s]"),
        Axis::logarithmic("Allan deviation [deg/h]"),
    );
    for (axis, (name, colour)) in [("gyro x", 7), ("gyro y", 6), ("gyro z", 4)]
        .into_iter()
        .enumerate()
    {
        let scale = 1.0 + 0.35 * axis as f64;
        let curve: Vec<(f64, f64)> = (0..60)
            .map(|i| 10f64.powf(-2.0 + i as f64 * 0.1))
            .map(|tau| {
                (
                    tau,
                    scale
                        * ((25.0 / tau.sqrt()).powi(2)
                            + 4.0f64.powi(2)
                            + (0.12 * tau.sqrt()).powi(2))
                        .sqrt(),
                )
            })
            .collect();
        let band: Vec<_> = curve
            .iter()
            .map(|&(tau, s)| {
                let d = 0.01 * tau.powf(0.42);
                (tau, s * (1.0 - d).max(0.2), s * (1.0 + d))
            })
            .collect();
        panel.add(Series::band("", colour, &band));
        panel.add(Series::line(name, colour, curve));
    }
    panel.add(Series::dashed(
        "data sheet",
        0,
        vec![(0.01, 270.0), (10.0, 8.5)],
    ));
    panel
}

fn acf() -> Panel {
    let mut panel = Panel::new(
        "Autocorrelation",
        Axis::new("lag"),
        Axis::new("correlation").within(-0.4..1.05),
    );
    let mut eps = noise(3);
    panel.add(Series::band(
        "95 %",
        1,
        &[(-0.5, -0.08, 0.08), (40.5, -0.08, 0.08)],
    ));
    panel.add(Series::bars(
        "residuals",
        7,
        (0..=40)
            .map(|k| {
                (
                    f64::from(k),
                    if k == 0 {
                        1.0
                    } else {
                        0.9f64.powi(k) * (f64::from(k) * 0.5).cos() * 0.4 + 0.03 * eps()
                    },
                )
            })
            .collect(),
    ));
    panel
}

const MODELS: [&str; 4] = ["White noise", "Random walk", "Gauss–Markov", "AR(3)"];

fn boxes() -> Panel {
    let mut panel = Panel::new(
        "Error at the end",
        Axis::categories(MODELS),
        Axis::logarithmic("horizontal error [m]"),
    );
    let of = |k: f64| {
        [42.0, 24.0, 18.0, 12.0]
            .iter()
            .enumerate()
            .map(|(i, m)| (i as f64, [0.2, 0.6, 0.9, 1.3, 2.4].map(|q| q * m * k)))
            .collect()
    };
    panel.add(Series::boxes("30 s", 3, of(0.3)));
    panel.add(Series::boxes("60 s", 7, of(1.0)));
    panel
}

fn bars() -> Panel {
    let mut panel = Panel::new("RMS", Axis::categories(MODELS), Axis::new("RMS [m]"));
    for (name, colour, k) in [("30 s", 3, 0.3), ("60 s", 7, 1.0), ("120 s", 6, 2.7)] {
        panel.add(Series::bars(
            name,
            colour,
            [42.0, 24.0, 18.0, 12.0]
                .iter()
                .enumerate()
                .map(|(i, m)| (i as f64, m * k))
                .collect(),
        ));
    }
    panel
}

fn dots() -> Panel {
    let mut panel = Panel::new(
        "Residuals",
        Axis::new("fitted [mg]"),
        Axis::new("residual [mg]").within(-2.0..2.0),
    );
    let (mut a, mut b) = (noise(5), noise(6));
    panel.add(Series::dots(
        "accelerometer x",
        5,
        (0..300).map(|_| (3.0 + a(), 0.8 * b())).collect(),
    ));
    panel.add(Series::line("zero", 0, vec![(0.0, 0.0), (6.0, 0.0)]));
    panel
}

fn wide_table() -> Table {
    Table {
        name: "parameters".into(),
        caption: "Parameters of every axis.".into(),
        head: [
            "Axis",
            "N [deg/√h]",
            "B [deg/h]",
            "K [deg/h/√s]",
            "Correlation time [s]",
            "Temperature [deg/h/°C]",
            "Bias [deg/h]",
            "Comment",
        ]
        .map(String::from)
        .to_vec(),
        rows: ["gyro_x", "gyro_y", "gyro_z"]
            .iter()
            .enumerate()
            .map(|(i, axis)| {
                let k = 1.0 + 0.35 * i as f64;
                vec![
                    (*axis).into(),
                    Cell::number(0.42 * k, 3),
                    Cell::number(4.1 * k, 2),
                    Cell::number(0.12 * k, 3),
                    Cell::number(310.0 / k, 0),
                    Cell::number(-0.81 * k, 2),
                    Cell::number(12.4 - 20.0 * k, 1),
                    "order chosen by AICc".into(),
                ]
            })
            .collect(),
    }
}

/// Text that would be markup or code, values that are not finite, panels with nothing in them.
fn hostile() -> Document {
    let axis = || Axis::new(HOSTILE);
    let mut odd = Panel::new(HOSTILE, axis(), axis());
    odd.shade(f64::NAN, 3.0);
    odd.add(Series::line(
        HOSTILE,
        7,
        vec![
            (0.0, 1.0),
            (1.0, f64::NAN),
            (2.0, f64::INFINITY),
            (f64::NAN, 2.0),
            (3.0, 2.0),
            (4.0, 1.0),
        ],
    ));
    odd.add(Series::line("empty", 6, Vec::new()));
    odd.add(Series::dots(
        "=HYPERLINK(\"x\"),\ttab\nline",
        5,
        vec![(1e9, 1e9)],
    ));
    let mut none = Panel::new("nothing but NaN", axis(), Axis::logarithmic("y"));
    none.add(Series::line("NaN", 1, vec![(f64::NAN, f64::NAN); 3]));
    none.add(Series::line(
        "not positive",
        2,
        vec![(0.0, -1.0), (1.0, 0.0)],
    ));
    let mut one = Panel::new("one point, a constant", axis(), Axis::new("y"));
    one.add(Series::dots("point", 4, vec![(5.0, 5.0)]));
    let mut constant = Panel::new("constant", axis(), Axis::new("y"));
    constant.add(Series::line(
        "constant",
        4,
        (0..10)
            .map(|i| (1e9 + f64::from(i) * 1e-3, -9.80665))
            .collect(),
    ));
    let mut names = Panel::new(
        "long names",
        Axis::categories([
            HOSTILE,
            "a name that is longer than its place",
            "c",
            "d",
            "another long name here",
        ]),
        Axis::new("y"),
    );
    names.add(Series::bars(
        "bars",
        3,
        vec![(0.0, -1.0), (1.0, 2.0), (2.0, f64::NAN), (4.0, 1e-3)],
    ));
    names.add(Series::boxes(
        "boxes",
        4,
        vec![
            (0.0, [1.0, 2.0, f64::NAN, 3.0, 4.0]),
            (3.0, [1.0, 1.0, 1.0, 1.0, 1.0]),
        ],
    ));
    let mut still = Panel::new("still", Axis::new("east [m]"), Axis::new("north [m]")).to_scale();
    still.add(Series::line("at rest", 0, vec![(0.0, 0.0); 5]));
    let empty = Panel::new("", Axis::new(""), Axis::new(""));
    let huge = || {
        vec![
            (-f64::MAX, 5e-324),
            (0.0, -f64::MAX),
            (1e-310, 1.0),
            (f64::MAX, f64::MAX),
        ]
    };
    let mut extreme = Panel::new("extreme", axis(), axis());
    extreme.add(Series::line("huge", 1, huge()));
    let mut decades = Panel::new(
        "extreme decades",
        Axis::logarithmic("x"),
        Axis::logarithmic("y").within(0.0..1.0),
    );
    decades.add(Series::line("huge", 1, huge()));
    decades.add(Series::bars("bars", 2, huge()));
    let mut map = Panel::new("extreme map", axis(), axis()).to_scale();
    map.add(Series::line("huge", 1, huge()));
    let tiny = {
        let mut panel = Panel::new(
            "tiny",
            Axis::logarithmic("f [Hz]"),
            Axis::logarithmic("PSD"),
        );
        panel.add(Series::line(
            "psd",
            7,
            (1..50)
                .map(|i| (f64::from(i) * 1e-3, 1e-14 / f64::from(i)))
                .collect(),
        ));
        panel
    };
    Document {
        title: HOSTILE.into(),
        subtitle: HOSTILE.into(),
        sections: vec![
            Section {
                title: HOSTILE.into(),
                blocks: vec![
                    Block::Text(HOSTILE.into()),
                    Block::Warning(HOSTILE.into()),
                    Block::Table(Table {
                        name: format!("../../{HOSTILE}"),
                        caption: HOSTILE.into(),
                        head: vec![HOSTILE.into(), "b".into()],
                        rows: vec![
                            vec![HOSTILE.into(), "=1+1".into()],
                            vec![Cell::number(f64::NAN, 2)],
                            Vec::new(),
                        ],
                    }),
                    Block::Table(Table::default()),
                    figure(
                        &format!("../{HOSTILE}"),
                        HOSTILE,
                        2,
                        vec![
                            odd, none, one, constant, names, still, empty, tiny, extreme, decades,
                            map,
                        ],
                    ),
                    figure("no-panels", "", 0, Vec::new()),
                ],
                ..Section::default()
            },
            Section::default(),
        ],
    }
}

/// As much as a long report holds: 12 figures of 6 series of 4000 points.
fn large() -> Document {
    let figures = (0..12).map(|f| {
        let mut panel = Panel::new("", Axis::new("time [s]"), Axis::new("velocity error [m/s]"));
        for s in 0..6 {
            let mut eps = noise(100 + 6 * f + s);
            let mut value = 0.0;
            let walk = (0..4000).map(|i| {
                value = 0.99 * value + 0.1 * eps();
                (f64::from(i) * 0.45, value)
            });
            panel.add(Series::thin(
                &format!("model {s}"),
                s as usize,
                walk.collect(),
            ));
        }
        Section {
            title: format!("Run {f}"),
            blocks: vec![figure(
                &format!("run{f}"),
                "Errors over time.",
                1,
                vec![panel],
            )],
            ..Section::default()
        }
    });
    Document {
        title: "Large".into(),
        subtitle: String::new(),
        sections: figures.collect(),
    }
}
