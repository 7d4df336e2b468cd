//! Every reader of foreign files, from bytes: a shape or an error with its place, and no more memory than the file asks for.

#![no_main]

use libfuzzer_sys::fuzz_target;
use moldloft::io::{cgns, gdf, obj, off, plot3d, ply, points, section, stl};

fuzz_target!(|bytes: &[u8]| {
    // The first byte chooses, so that one corpus serves all.
    let Some((&which, rest)) = bytes.split_first() else { return };
    match which % 9 {
        0 => drop(gdf::read(rest)),
        1 => drop(obj::read(rest)),
        2 => drop(stl::read(rest)),
        3 => drop(points::read(rest)),
        4 => drop(section::read_aerofoil(rest)),
        5 => drop(cgns::read(rest)),
        6 => drop(ply::read(rest)),
        7 => drop(off::read(rest)),
        _ => {
            // What was read is written and read as the same.
            let Ok((blocks, variant)) = plot3d::read(rest) else { return };
            let Ok(written) = plot3d::write(&blocks, variant) else { return };
            let (again, _) = plot3d::read(&written).expect("what is written can be read");
            assert_eq!(again.len(), blocks.len());
        }
    }
});
