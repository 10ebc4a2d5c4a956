//! The tables, in Markdown.

use super::{Run, units};
use undrift::noise::{
    ImuModel, allan::Term, identify::Axis, model_file::AxisModel, normality, spectrum::Density,
};
use undrift::results::Statement;
use undrift_report::{say, sentence};

pub fn print(runs: &[Run], sheet: &ImuModel) {
    for run in runs {
        println!("## {}\n", run.name);
        noise_terms(run);
        models(run);
        distributions(run);
        disturbances(run);
    }
    white_noise(runs);
    scales(runs);
    data_sheet(runs, sheet);
}

fn header(columns: &[&str]) {
    println!("| {} |", columns.join(" | "));
    println!("|{}", "---|".repeat(columns.len()));
}

/// A number to three digits.
fn three(value: f64) -> String {
    let digits = 2 - value.abs().max(1e-9).log10().floor() as i32;
    if !value.is_finite() {
        "∞".into()
    } else if (-1..=4).contains(&digits) {
        format!("{value:.*}", digits.max(0) as usize)
    } else {
        format!("{value:.2e}")
    }
}

fn term(term: &Term, unit: f64) -> String {
    if term.value > 0.0 {
        format!(
            "{} ± {}",
            three(term.value / unit),
            three(term.standard_error / unit)
        )
    } else {
        format!("– (< {})", three(term.upper_95 / unit))
    }
}

fn noise_terms(run: &Run) {
    println!("Terms of the Allan deviation and its Gauss-Markov fit:\n");
    header(&[
        "axis",
        "white noise N",
        "bias instability B",
        "random walk K",
        "least deviation, at",
        "Gauss-Markov σ",
        "τ [s]",
    ]);
    for (_, name, axis) in run.axes() {
        let (u, terms) = (units(name), &axis.allan_terms);
        let least = axis
            .allan
            .points
            .iter()
            .min_by(|a, b| a.deviation.total_cmp(&b.deviation));
        let least = least.map_or("–".into(), |p| {
            format!(
                "{} {}, {} s",
                three(p.deviation / u.one_rate),
                u.rate,
                three(p.tau_s)
            )
        });
        let process = axis.allan_gauss_markov.as_ref();
        println!(
            "| {name} | {} {} | {} {} | {} {} | {least} | {} | {} |",
            term(&terms.white, u.one_walk),
            u.walk,
            term(&terms.bias_instability, u.one_rate),
            u.rate,
            // √3600 seconds in √h.
            term(&terms.random_walk, u.one_rate / 60.0),
            u.rate_walk,
            process.map_or("–".into(), |g| format!(
                "{} {}",
                three(g.sigma / u.one_rate),
                u.rate
            )),
            process.map_or("–".into(), |g| three(g.tau_c_s)
                + if g.at_limit { " (limit)" } else { "" }),
        );
    }
    println!();
}

/// The parameters of a model in the units of its axis.
fn parameters(model: &AxisModel, name: &str) -> String {
    let u = units(name);
    let mut parts = Vec::new();
    if let Some(white) = model.white {
        parts.push(format!("N {} {}", three(white / u.one_walk), u.walk));
    }
    for process in &model.instability {
        parts.push(format!(
            "σ {} {}, τ {} s",
            three(process.sigma / u.one_rate),
            u.rate,
            three(process.tau_s)
        ));
    }
    if let Some(walk) = model.random_walk {
        parts.push(format!(
            "K {} {}",
            three(walk * 60.0 / u.one_rate),
            u.rate_walk
        ));
    }
    if let Some(arma) = &model.arma {
        let list = |values: &[f64]| {
            let values: Vec<String> = values.iter().map(|v| format!("{v:.5}")).collect();
            values.join(", ")
        };
        parts.push(format!("φ {}; θ {}", list(&arma.ar), list(&arma.ma)));
    }
    parts.join("; ")
}

fn models(run: &Run) {
    println!("Recommended models, and the drift they leave on the half that was not fitted:\n");
    header(&[
        "axis",
        "recommended model",
        "its parameters",
        "1 s",
        "10 s",
        "60 s",
        "white noise alone, 60 s",
        "ARMA(1,1), 60 s",
    ]);
    for (_, name, axis) in run.axes() {
        let (u, chosen) = (units(name), axis.recommended());
        let drift = |horizon: f64, score: &[undrift::noise::drift_score::HorizonScore]| {
            let at = score.iter().find(|s| (s.horizon_s - horizon).abs() < 0.02);
            at.map_or("–".into(), |s| three(s.rms / u.one_integral))
        };
        let other = |wanted: &str| {
            let candidate = axis.candidates.iter().find(|c| c.name == wanted);
            candidate.map_or("–".into(), |c| drift(60.0, &c.score))
        };
        println!(
            "| {name} | {} | {} | {} | {} | {} {} | {} | {} |",
            chosen.name,
            parameters(&chosen.model, name),
            drift(1.0, &chosen.score),
            drift(10.0, &chosen.score),
            drift(60.0, &chosen.score),
            u.integral,
            other("white"),
            other("ARMA(1,1)"),
        );
    }
    println!();
}

fn distributions(run: &Run) {
    println!("Distribution and stationarity:\n");
    header(&[
        "axis",
        "standard deviation",
        "quantisation step",
        "skewness",
        "excess kurtosis",
        "correlation at lags 1, 2",
        "lines [Hz]",
        "outliers",
    ]);
    for (i, name, axis) in run.axes() {
        let (u, normal) = (units(name), &axis.normality);
        // As recorded: what bridges an outlier does not lie on the grid.
        let grid = normality::quantisation(&run.record.samples[i]);
        let deviation = run.deviation(i);
        let step = grid.map_or("–".into(), |q| {
            format!(
                "{} ({:.2} σ)",
                three(q.step / u.one_rate),
                q.step / deviation
            )
        });
        println!(
            "| {name} | {} {} | {step} | {:+.3} | {:+.3} | {:+.3}, {:+.3} | {} | {} |",
            three(deviation / u.one_rate),
            u.rate,
            normal.skewness,
            normal.kurtosis_excess,
            axis.acf[1],
            axis.acf[2],
            lines(axis),
            axis.outliers.len()
        );
    }
    println!();
    for (_, name, axis) in run.axes() {
        println!("* {name}: {}", say::stationarity(&axis.stationarity));
        let of_fit = axis.recommended().remarks.iter().map(Statement::Fit);
        for found in axis.remarks.iter().map(Statement::Record).chain(of_fit) {
            println!("  Warning: {}", sentence(found));
        }
    }
    println!();
}

fn lines(axis: &Axis) -> String {
    let lines: Vec<String> = axis.lines.iter().map(|l| three(l.frequency_hz)).collect();
    match lines.len() {
        0 => "–".into(),
        1..=5 => lines.join(", "),
        n => format!("{}, … ({n})", lines[..4].join(", ")),
    }
}

fn disturbances(run: &Run) {
    let found = run.disturbances();
    if found.is_empty() {
        println!("No sample lies beyond eight robust standard deviations.\n");
        return;
    }
    println!("Disturbances, samples beyond eight robust standard deviations:\n");
    header(&["from [s]", "to [s]", "samples", "axes", "largest [σ]"]);
    for d in &found {
        let axes: Vec<String> = run
            .axes()
            .filter_map(|(i, name, _)| {
                let count = d.samples.iter().filter(|s| s.0 == i).count();
                (count > 0).then(|| format!("{name} {count}"))
            })
            .collect();
        println!(
            "| {:.2} | {:.2} | {} | {} | {:.1} |",
            d.from_s,
            d.to_s,
            d.samples.len(),
            axes.join(", "),
            d.largest
        );
    }
    println!();
}

fn white_noise(runs: &[Run]) {
    println!("## White noise from run to run\n");
    let [one, two, four] = runs else { return };
    for run in runs {
        if let Some(line) = run.line_hz() {
            println!("* {}: line of accel.x at {line:.4} Hz (nominal)", run.name);
        }
    }
    let faster = match (two.line_hz(), four.line_hz()) {
        (Some(two), Some(four)) => two / four,
        _ => f64::NAN,
    };
    println!("\nRate of run4 over that of run2, if the line is the same: {faster:.4}.\n");
    header(&[
        "axis",
        "N, run1",
        "run2",
        "run4",
        "fitted from [s]",
        "run1 / run2",
        "run4 / run2",
        "the same, rate of the line",
        "density 1-10 Hz, run4 / run2",
        "σ, run4 / run2",
        "run4 as recorded / cleaned, N",
        "σ",
        "cleaned / its longest quiet stretch, density",
    ]);
    for (i, name, axis) in two.axes() {
        let (Some(first), Some(last)) = (one.axis(i), four.axis(i)) else {
            continue;
        };
        let white = |a: &Axis| a.allan_terms.white.value;
        let all = [first, axis, last];
        let values = all.map(|a| three(white(a) / units(name).one_walk));
        let starts = all.map(|a| three(a.allan_terms.from_s));
        let ratio = white(last) / white(axis);
        let recorded = four.as_recorded(i);
        println!(
            "| {name} [{}] | {} | {} | {:.3} | {ratio:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} |",
            units(name).walk,
            values.join(" | "),
            starts.join(", "),
            white(first) / white(axis),
            ratio / faster.sqrt(),
            flat(&last.psd) / flat(&axis.psd),
            four.deviation(i) / two.deviation(i),
            recorded.map_or(f64::NAN, |(white, _)| white) / white(last),
            recorded.map_or(f64::NAN, |(_, deviation)| deviation) / four.deviation(i),
            four.quiet_density(i)
                .map_or(f64::NAN, |quiet| flat(&last.psd) / flat(&quiet)),
        );
    }
    println!();
}

/// Root of the mean density from 1 to 10 Hz, where no filter and no drift shows.
fn flat(psd: &Density) -> f64 {
    let bins = psd.frequency_hz.iter().zip(&psd.density);
    let inside = bins.filter(|(f, _)| (1.0..10.0).contains(*f));
    let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (_, d)| (sum + d, count + 1.0));
    f64::sqrt(sum / count)
}

fn scales(runs: &[Run]) {
    println!("## The slow part at several block lengths\n");
    println!("ARMA(1,1) of block averages, carried back to the full rate:\n");
    header(&[
        "run, axis",
        "block",
        "white noise N",
        "σ",
        "τ [s]",
        "± ln τ",
    ]);
    for run in runs {
        for (_, name, axis) in run.axes() {
            let u = units(name);
            for fit in axis.scales.iter().flat_map(|s| &s.scales) {
                let Some(slow) = fit.lifted else {
                    println!(
                        "| {}, {name} | {} | no slow part | | | |",
                        run.name, fit.block
                    );
                    continue;
                };
                println!(
                    "| {}, {name} | {} | {} {} | {} {} | {} | {} |",
                    run.name,
                    fit.block,
                    three(slow.white / u.one_walk),
                    u.walk,
                    three(slow.sigma / u.one_rate),
                    u.rate,
                    three(slow.tau_s),
                    three(fit.relative_errors.tau_s),
                );
            }
        }
    }
    println!();
}

fn data_sheet(runs: &[Run], sheet: &ImuModel) {
    println!("## Beside the data sheet\n");
    header(&[
        "axis",
        "N / data sheet",
        "least deviation / (0.664 × its bias instability)",
    ]);
    for (i, (name, model)) in sheet.axes().iter().enumerate() {
        let found: Vec<&Axis> = runs.iter().filter_map(|r| r.axis(i)).collect();
        let list = |value: &dyn Fn(&Axis) -> f64| {
            let values: Vec<String> = found.iter().map(|a| three(value(a))).collect();
            values.join(", ")
        };
        let white = model.white.unwrap_or(f64::NAN);
        let flat = 0.664 * model.instability.first().map_or(f64::NAN, |p| p.sigma);
        let least = |a: &Axis| {
            let deviations = a.allan.points.iter().map(|p| p.deviation);
            deviations.fold(f64::INFINITY, f64::min) / flat
        };
        println!(
            "| {name} | {} | {} |",
            list(&|a| a.allan_terms.white.value / white),
            list(&least)
        );
    }
}
