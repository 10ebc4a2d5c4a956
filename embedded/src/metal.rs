//! What a microcontroller's program can learn of itself: stack used, instructions done.

use core::fmt::Display;
use cortex_m::peripheral::{SYST, syst::SystClkSource};
use cortex_m_semihosting::{debug, heprintln};

const PAINT: u32 = 0x5afe_57ac;
/// Below the stack pointer, what the painting itself may use [bytes].
const MARGIN: usize = 64;

unsafe extern "C" {
    /// Where the stack ends and nothing else begins; of cortex-m-rt's linker script.
    static mut _stack_end: u32;
}

/// Runs `work` and returns its result with the stack that it used [bytes], below its caller's frame.
#[inline(never)]
pub fn stack_of<T>(work: impl FnOnce() -> T) -> (T, usize) {
    let bottom = &raw mut _stack_end;
    let top = cortex_m::register::msp::read() as usize;
    let words = (top - MARGIN - bottom as usize) / 4;
    for i in 0..words {
        // SAFETY: between the stack's end and the stack pointer less what this loop may spill there is
        // nothing; interrupts are not in use.
        unsafe { bottom.add(i).write_volatile(PAINT) };
    }
    let result = work();
    // SAFETY: as above; the words are those just written.
    let untouched = (0..words).take_while(|&i| unsafe { bottom.add(i).read_volatile() } == PAINT);
    (result, top - (bottom as usize + 4 * untouched.count()))
}

/// Counts by SysTick, which QEMU's `-icount` drives by the instructions done.
pub struct Counter {
    timer: SYST,
    /// Instructions a tick.
    scale: f64,
}

impl Counter {
    /// Starts the timer and finds what one tick is worth.
    pub fn start(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(0x00ff_ffff);
        timer.clear_current();
        timer.enable_counter();
        let mut counter = Self { timer, scale: 1.0 };
        // A loop of two instructions, run once more than its argument.
        const ROUNDS: u32 = 1_000_000;
        let ((), ticks) = counter.count(|| cortex_m::asm::delay(ROUNDS - 1));
        counter.scale = f64::from(2 * ROUNDS) / ticks;
        counter
    }

    /// Instructions a tick, as measured on a loop of known length.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Runs `work` and returns its result with the instructions it took, to one tick.
    #[inline(never)]
    pub fn count<T>(&mut self, work: impl FnOnce() -> T) -> (T, f64) {
        let before = SYST::get_current();
        let result = work();
        let ticks = before.wrapping_sub(SYST::get_current()) & 0x00ff_ffff;
        (result, f64::from(ticks) * self.scale)
    }
}

impl Drop for Counter {
    fn drop(&mut self) {
        self.timer.disable_counter();
    }
}

/// Ends QEMU: with success, or with the failure on standard error.
pub fn end(result: Result<(), impl Display>) -> ! {
    if let Err(failure) = result {
        fail(failure);
    }
    loop {
        debug::exit(debug::EXIT_SUCCESS);
    }
}

/// Ends QEMU with a failure, which goes to standard error.
pub fn fail(failure: impl Display) -> ! {
    heprintln!("{}", failure);
    loop {
        debug::exit(debug::EXIT_FAILURE);
    }
}
