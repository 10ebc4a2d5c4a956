//! The hot loops, for counting instructions: `hot CRATE/TASK COUNT` does a task so many times over.
//! `tools/instruction-budgets` runs it.

mod engine;
mod io;
mod nav;
mod noise;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(name), Some(count)) = (arguments.next(), arguments.next()) else {
        return Err("usage: hot CRATE/TASK COUNT".into());
    };
    let count = count.parse()?;
    match name.split_once('/') {
        Some(("engine", task)) => engine::run(task, count),
        Some(("nav", task)) => nav::run(task, count),
        Some(("noise", task)) => noise::run(task, count),
        Some(("io", task)) => io::run(task, count),
        _ => Err(format!("no task {name}").into()),
    }
}
