//! Prints the minute's states, once a second, for both models: the number of states, then the numbers
//! of `run::states` to the last digit. The same program on a microcontroller and on a host.
#![cfg_attr(target_os = "none", no_std, no_main)]

use undrift_embedded::{
    MINUTE, models,
    record::Record,
    run::{self, Failure},
};
use undrift_nav::filter::Filter;

fn print_states<const N: usize>(record: &Record, sensors: models::Sensors) -> Result<(), Failure> {
    let mut filter: Filter<N> = run::begin(record, sensors)?;
    run::navigate(record, &mut filter, |filter| {
        print!("{N}");
        for number in run::states(filter) {
            print!(" {number:.16e}");
        }
        println!();
    })
}

fn run() -> Result<(), Failure> {
    let record = Record::new(MINUTE).ok_or(Failure::NoRecord)?;
    let sensors = models::random_walk(record.interval).map_err(Failure::Model)?;
    print_states::<{ models::RANDOM_WALK_STATES }>(&record, sensors)?;
    let sensors = models::arma(record.interval).map_err(Failure::Model)?;
    print_states::<{ models::ARMA_STATES }>(&record, sensors)
}

#[cfg(target_os = "none")]
use cortex_m_semihosting::{hprint as print, hprintln as println};

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    undrift_embedded::metal::end(run())
}

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(info: &core::panic::PanicInfo) -> ! {
    undrift_embedded::metal::fail(info)
}

#[cfg(not(target_os = "none"))]
fn main() {
    if let Err(failure) = run() {
        eprintln!("{failure}");
        std::process::exit(1);
    }
}
