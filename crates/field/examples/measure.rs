//! Times and quality of the T-piece: bulk evaluation, brackets, facets, fewer triangles. Run with `--release`.

#[path = "../tests/it/common.rs"]
mod common;

use moldloft_num::Vec3;
use std::sync::OnceLock;
use std::time::Instant;

fn best(n: usize, mut f: impl FnMut()) -> f64 {
    let time = |f: &mut dyn FnMut()| {
        let start = Instant::now();
        f();
        start.elapsed().as_secs_f64()
    };
    (0..n).map(|_| time(&mut f)).fold(f64::INFINITY, f64::min)
}

/// Seconds that the thread has run, so that other work on the machine does not count; of the clock where the
/// system does not tell.
fn cpu() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    let reported = std::fs::read_to_string("/proc/thread-self/schedstat");
    let nanoseconds = reported.ok().and_then(|t| t.split(' ').next()?.parse::<f64>().ok());
    nanoseconds
        .map_or_else(|| START.get_or_init(Instant::now).elapsed().as_secs_f64(), |t| t * 1e-9)
}

/// The mean of some runs, in seconds of the thread.
fn mean(n: usize, mut f: impl FnMut()) -> f64 {
    let start = cpu();
    (0..n).for_each(|_| f());
    (cpu() - start) / n as f64
}

fn main() {
    let set = common::t_piece();
    let n = 1 << 18;
    let points: Vec<Vec3> = (0..n)
        .map(|k| {
            let part = |a: f64| 8.0 * (k as f64 * a).fract() - 4.0;
            Vec3::of(part(0.819_172_513), part(0.671_043_607), part(0.549_700_478))
        })
        .collect();
    let mut out = vec![0.0; n];
    let bulk = best(7, || set.values(&points, &mut out));
    println!("bulk: {:.2} ns per point", bulk / n as f64 * 1e9);
    for depth in [6, 7, 8] {
        let Ok(m) = moldloft_field::mass(
            &set,
            &common::cube(4.0),
            &moldloft_field::IntegralOptions::to_depth(depth),
        ) else {
            continue;
        };
        let v = m.bracket.volume();
        println!("volume, depth {depth}: {:.6} in [{:.4}, {:.4}]", m.best.volume(), v.low, v.high);
    }
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let Ok(pool) = pool else { continue };
        for depth in [6, 7, 8] {
            let mut faces = 0;
            let time = best(7, || {
                let f = pool.install(|| common::facets(&set, &common::cube(4.0), depth));
                faces = f.mesh.faces().len();
            });
            println!("{threads} threads, depth {depth}: {:.1} ms, {faces} triangles", time * 1e3);
        }
    }
    // About 37 000 triangles, to compare with others at that number.
    let like = common::cube(4.16);
    if let Ok(one) = rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        let time = one.install(|| mean(10, || drop(common::facets(&set, &like, 7))));
        let name = format!("like libfive's, {:.1} ms of one thread", time * 1e3);
        reported(&name, &common::facets(&set, &like, 7));
    }
    for depth in [6, 7, 8] {
        let f = common::facets(&set, &common::cube(4.0), depth);
        reported(&format!("depth {depth}"), &f);
        if depth > 6 {
            for accuracy in [3e-4, 2e-4, 1.5e-4] {
                let mut simple = None;
                let time = best(1, || simple = f.simplified(accuracy).ok());
                if let Some(simple) = simple {
                    reported(
                        &format!("  simplified to {accuracy:.1e} in {:.0} ms", time * 1e3),
                        &simple,
                    );
                }
            }
        }
    }
}

fn reported(name: &str, f: &moldloft_field::Facets) {
    let all = f.centre_distances();
    let rms = (all.iter().map(|d| d * d).sum::<f64>() / all.len() as f64).sqrt();
    println!(
        "{name}: {} triangles, centre rms {rms:.2e}, worst vertex {:.1e}, {} crossing pairs, {} undecided of {} cells",
        all.len(),
        f.worst_vertex(),
        moldloft_field::crossing_faces(&f.mesh, None).len(),
        f.undecided.len(),
        f.cells
    );
}
