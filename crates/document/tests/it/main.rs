//! Tests of documents, in one program: `cargo test -p moldloft-document --test it incremental::`.

mod array_language;
mod blocks;
mod common;
mod components;
mod contours;
mod diagnostics;
mod faults;
mod functions;
mod fused;
mod hull;
mod identities;
mod incremental;
mod joins;
mod language;
mod laws;
mod model_files;
mod mutations;
mod programs;
mod relabels;
mod scale;
mod sdl_programs;
mod segments;
mod sets;
mod sketches;
mod solve;
mod sweeps;
