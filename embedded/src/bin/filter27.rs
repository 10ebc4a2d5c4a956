//! The filter of 27 states alone, for its share of the flash: built, not run.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod metal {
    use undrift_embedded::{minimal::minimal, models};

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let _ = minimal::<{ models::ARMA_STATES }>(models::arma);
        loop {
            cortex_m::asm::wfi();
        }
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo) -> ! {
        loop {}
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
