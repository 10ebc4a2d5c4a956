//! In how many sets of seeds the demo's conclusion holds: each has another static record, other drives, other
//! switch-ons.
//!
//! `cargo run --release -p undrift-lab --bin demo_seeds -- [SETS] [FIRST SEED]`

use undrift::{
    base::order_statistics::{median, quantile},
    demo::{self, CUTS, DRIVES, Experiment, RECOMMENDED, Source},
};

type Failure = Box<dyn std::error::Error>;

/// What one set shows of the outages of one length.
struct Seen {
    /// White noise over the recommended model, and its interval.
    ratio: f64,
    interval: [f64; 2],
    /// The recommended model is within chance of the least drift.
    near_least: bool,
    /// It over the bound.
    over_bound: f64,
}

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let sets: u64 = arguments.next().map_or(Ok(20), |n| n.parse())?;
    let first: u64 = arguments.next().map_or(Ok(1001), |n| n.parse())?;
    let mut lengths: Vec<Vec<Seen>> = CUTS.iter().map(|_| Vec::new()).collect();
    for seed in first..first + sets {
        let experiment = Experiment {
            seed,
            drives: DRIVES,
            source: Source::Simulated,
            paper: false,
        };
        let demo = demo::run(experiment, |_, _, _| {})?;
        print!("{seed:5}");
        for (seen, rows) in lengths.iter_mut().zip(&demo.lengths) {
            let row = |name: &str| {
                let at = demo.models.iter().position(|(of, _)| *of == name);
                at.and_then(|at| rows.get(at)).ok_or("a model is missing")
            };
            let recommended = row(RECOMMENDED)?;
            let less = recommended.less_than_white;
            let [low, high] = less.interval;
            print!("  {:5.2} ({low:.2} to {high:.2})", less.value);
            seen.push(Seen {
                ratio: less.value,
                interval: less.interval,
                near_least: recommended.over_least.is_one(),
                over_bound: recommended.horizontal.value / row(demo::BOUND)?.horizontal.value,
            });
        }
        println!();
    }
    println!(
        "\nof {sets} sets: white / recommended above 1; above 1 with its whole interval; intervals that"
    );
    println!(
        "hold the median of all sets; recommended within chance of the least; recommended / bound"
    );
    for (cuts, seen) in CUTS.iter().zip(&lengths) {
        let ratios: Vec<f64> = seen.iter().map(|s| s.ratio).collect();
        let middle = median(&ratios);
        let count = |of: &dyn Fn(&Seen) -> bool| seen.iter().filter(|s| of(s)).count();
        let over: Vec<f64> = seen.iter().map(|s| s.over_bound).collect();
        println!(
            "{:4} s: {}; {}; {}; {}; {:.3}; ratio {middle:.2}, {:.2} to {:.2}",
            cuts.length,
            count(&|s| s.ratio > 1.0),
            count(&|s| s.interval[0] > 1.0),
            count(&|s| s.interval[0] <= middle && middle <= s.interval[1]),
            count(&|s| s.near_least),
            median(&over),
            quantile(&ratios, 0.0),
            quantile(&ratios, 1.0),
        );
    }
    Ok(())
}
