//! fidget's interpreter on a model in its text form: seconds of one thread for octree and mesh.
//!
//! `cargo run --release --bin interpreter MODEL.vm DEPTH` here, best of three; beside it `python benches/implicit_scale.py MODEL.vm DEPTH`.
//! The models are those of fidget's repository (`models/prospero.vm`).

use fidget::context::Context;
use fidget::mesh::{Octree, Settings};
use fidget::vm::VmShape;

/// Seconds that the thread has run, so that other work on the machine does not count.
fn cpu() -> f64 {
    let reported = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    reported.split(' ').next().and_then(|t| t.parse::<f64>().ok()).map_or(f64::NAN, |t| t * 1e-9)
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [file, depth] = &words[..] else {
        eprintln!("a model and a depth are needed");
        return;
    };
    let shape = std::fs::File::open(file).ok().and_then(|mut text| {
        let (context, root) = Context::from_text(&mut text).ok()?;
        VmShape::new(&context, root).ok()?.try_into().ok()
    });
    let (Some(shape), Ok(depth)) = (shape, depth.parse()) else {
        eprintln!("{file} is no model, or {depth} no depth");
        return;
    };
    let settings = Settings { depth, threads: None, ..Settings::default() };
    for _ in 0..3 {
        let start = cpu();
        let Some(octree) = Octree::build(&shape, &settings) else { return };
        let built = cpu() - start;
        let mesh = octree.walk_dual();
        println!(
            "{file}, depth {depth}: {:.3} s, of which octree {built:.3}; {} triangles",
            cpu() - start,
            mesh.triangles.len()
        );
    }
}
