//! The formatter: canonical text means the same as its source, and formatting it again changes nothing.
#![no_main]

use libfuzzer_sys::fuzz_target;
use moldloft::diag::FileId;
use moldloft::syntax::sdl::{format, parse};

fuzz_target!(|text: &str| {
    let Ok(once) = format(text) else { return };
    let (source, _) = parse(text, FileId(0));
    let (canonical, faults) = parse(once.as_str(), FileId(0));
    assert!(faults.is_empty());
    assert_eq!(source.dump(), canonical.dump());
    assert_eq!(format(&once), Ok(once.clone()));
});
