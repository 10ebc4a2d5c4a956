//! The undrift command: one file per verb.

mod demo;
mod identify;
mod inspect;
mod model;
mod montecarlo;
mod navigate;
mod outages;
mod print;
mod report;
mod tables;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Make cheap inertial sensors trustworthy: navigate a log with any noise model of its IMU, and
/// measure how far the solution drifts when GNSS is cut.
#[derive(Parser)]
#[command(name = "undrift", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Demo(demo::Arguments),
    Identify(identify::Arguments),
    Inspect(inspect::Arguments),
    Model(model::Arguments),
    Montecarlo(montecarlo::Arguments),
    Navigate(navigate::Arguments),
    Outages(outages::Arguments),
    Report(report::Arguments),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().verb {
        Verb::Demo(arguments) => demo::run(&arguments),
        Verb::Identify(arguments) => identify::run(&arguments),
        Verb::Inspect(arguments) => inspect::run(&arguments),
        Verb::Model(arguments) => model::run(&arguments),
        Verb::Montecarlo(arguments) => montecarlo::run(&arguments),
        Verb::Navigate(arguments) => navigate::run(&arguments),
        Verb::Outages(arguments) => outages::run(&arguments),
        Verb::Report(arguments) => report::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("undrift: {error:#}");
            ExitCode::FAILURE
        }
    }
}
