//! Prints what the filter costs on this microcontroller: memory, stack and instructions.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod figures {
    use cortex_m_semihosting::hprintln;
    use undrift_embedded::{
        MINUTE,
        metal::{Counter, end, fail, stack_of},
        models,
        record::Record,
        run::{self, Failure},
    };
    use undrift_nav::filter::Filter;

    /// Seconds of the record that the stack is watched through: painting it takes its time.
    const WATCHED: f64 = 3.0;

    /// Largest and summed cost of one kind of call.
    #[derive(Default)]
    struct Cost {
        stack: usize,
        instructions: f64,
        calls: u32,
    }

    impl Cost {
        fn of<T>(&mut self, counter: &mut Counter, watched: bool, work: impl FnOnce() -> T) -> T {
            if watched {
                let (result, stack) = stack_of(work);
                self.stack = self.stack.max(stack);
                result
            } else {
                let (result, instructions) = counter.count(work);
                self.instructions += instructions;
                self.calls += 1;
                result
            }
        }

        fn print(&self, what: &str) {
            let each = self.instructions / f64::from(self.calls.max(1));
            hprintln!(
                "  {:<16} stack {:>6} B  {:>9.0} instructions",
                what,
                self.stack,
                each
            );
        }
    }

    fn measure<const N: usize>(
        counter: &mut Counter,
        model: &str,
        sensors: fn(f64) -> Result<models::Sensors, undrift_nav::shaping::ShapingError>,
    ) -> Result<(), Failure> {
        let record = Record::new(MINUTE).ok_or(Failure::NoRecord)?;
        let start = || {
            let sensors = sensors(record.interval).map_err(Failure::Model)?;
            run::begin::<N>(&record, sensors)
        };
        let [mut init, mut predict, mut position, mut velocity] =
            core::array::from_fn(|_| Cost::default());
        init.of(counter, true, start)?;
        let mut filter = init.of(counter, false, start)?;
        let mut fixes = record.fixes().peekable();
        for sample in record.samples() {
            let watched = sample.time < WATCHED;
            while let Some(fix) = fixes.next_if(|fix| fix.time < sample.time) {
                let lever = record.lever_arm;
                position.of(counter, watched, || {
                    run::position(&mut filter, &fix, &lever)
                })?;
                velocity.of(counter, watched, || {
                    run::velocity(&mut filter, &fix, &lever)
                })?;
            }
            predict.of(counter, watched, || filter.predict(&sample));
        }
        hprintln!(
            "{} states ({}), filter {} B",
            N,
            model,
            size_of::<Filter<N>>()
        );
        init.print("start");
        predict.print("predict");
        position.print("update position");
        velocity.print("update velocity");
        Ok(())
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let Some(peripherals) = cortex_m::Peripherals::take() else {
            fail("the timer is taken");
        };
        let mut counter = Counter::start(peripherals.SYST);
        hprintln!("one tick is {:.2} instructions", counter.scale());
        let counter = &mut counter;
        end(measure::<{ models::RANDOM_WALK_STATES }>(
            counter,
            "white and random walk",
            models::random_walk,
        )
        .and_then(|()| {
            measure::<{ models::ARMA_STATES }>(counter, "ARMA(2,2) and a constant", models::arma)
        }))
    }

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo) -> ! {
        fail(info)
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("for a microcontroller only");
}
