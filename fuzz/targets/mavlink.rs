#![no_main]

use undrift::io::format::Format;
use undrift_fuzz::logs::log;

libfuzzer_sys::fuzz_target!(|data: &[u8]| log(Format::Mavlink, data));
