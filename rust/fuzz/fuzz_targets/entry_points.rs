//! Whatever the input: no panic, and what every entry point promises of its result.

#![no_main]

use libfuzzer_sys::{Corpus, fuzz_target};
use spectral_tv_fuzz::Input;

fuzz_target!(
    init: spectral_tv_fuzz::on_one_thread(),
    |input: Input| -> Corpus {
        match input.run() {
            true => Corpus::Keep,
            false => Corpus::Reject, // not a mesh: nothing to learn from its like
        }
    }
);
