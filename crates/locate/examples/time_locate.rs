//! Times nearest points and intersections on the 20 x 20 bicubic surface of the comparisons:
//! `cargo run --release -p moldloft-locate --example time_locate [near|anywhere|plane|surface]`.

#[path = "../tests/it/common.rs"]
#[allow(dead_code, unused_imports)]
mod common;

use common::{Random, bumpy};
use moldloft_locate::branches::{Branches, CutSurface};
use moldloft_locate::march::Crossing;
use moldloft_locate::{NearestSurface, by_place};
use moldloft_num::{Order, Plane, Surface, Vec3};
use std::time::Instant;

/// Seconds of this thread's processor time, which other programs do not add to; of the clock where
/// the system does not tell.
fn seconds(begin: Instant) -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let ns = text.and_then(|t| t.split(' ').next()?.parse::<f64>().ok());
    ns.map_or_else(|| begin.elapsed().as_secs_f64(), |ns| ns * 1e-9)
}

/// Number of repetitions of an intersection for one figure.
const REPEATS: usize = 20;

/// Number of such figures, of which the minimum is taken: other load on the machine only adds time.
const RUNS: usize = 8;

fn main() {
    let begin = Instant::now();
    let only = std::env::args().nth(1);
    let wanted = |name: &str| only.as_ref().is_none_or(|o| name.contains(o.as_str()));
    let s = bumpy(20, 7);
    let start = Instant::now();
    let prepared = NearestSurface::new(&s);
    println!("prepared in {:?}, {} cells", start.elapsed(), prepared.cells());
    let mut random = Random::new(99);
    let near: Vec<Vec3> = (0..50_000)
        .map(|_| {
            let j = s.jet(random.unit(), random.unit(), Order::First);
            j.p + j.normal() * 0.004
        })
        .collect();
    let wide: Vec<Vec3> = (0..50_000)
        .map(|_| {
            let [x, y] = [(); 2].map(|()| random.between(-2.0, 11.5));
            Vec3::of(x, y, random.between(-3.0, 4.0))
        })
        .collect();
    for (name, points) in [("near", near), ("anywhere", wide)] {
        if !wanted(name) {
            continue;
        }
        let points: Vec<Vec3> = by_place(&points).into_iter().map(|k| points[k as usize]).collect();
        // The minimum of several runs: other load on the machine only adds time.
        let run = |_| {
            let start = seconds(begin);
            let sum: f64 = points.iter().map(|p| prepared.nearest(&s, *p).distance).sum();
            ((seconds(begin) - start) / points.len() as f64, sum)
        };
        let (each, sum) = (0..7).map(run).fold((f64::INFINITY, 0.0), |a, b| (a.0.min(b.0), b.1));
        println!("{name}: {:.2} us a point (sum of distances {sum})", each * 1e6);
    }
    let other = bumpy(20, 8);
    let z = Plane { point: Vec3::of(0.0, 0.0, 0.5), normal: Vec3::of(0.0, 0.0, 1.0) };
    let [first, second] = [CutSurface::new(&s), CutSurface::new(&other)];
    for (name, crossing, second) in [
        ("a plane", Crossing::with_plane(&s, z), None),
        ("a second such surface", Crossing::with_surface(&s, &other), Some(&second)),
    ] {
        if !wanted(name) {
            continue;
        }
        let timed = |work: &dyn Fn() -> Branches| {
            let (mut least, mut found) = (f64::INFINITY, Branches::default());
            for _ in 0..RUNS {
                let start = seconds(begin);
                for _ in 0..REPEATS {
                    found = work();
                }
                least = least.min((seconds(begin) - start) / REPEATS as f64);
            }
            (least * 1e3, found)
        };
        let (ms, found) = timed(&|| crossing.branches_in(&first, second));
        let (cold, _) = timed(&|| crossing.branches());
        let stations: usize = found.branches.iter().map(|b| b.stations.len()).sum();
        println!(
            "{name}: {} branches of {stations} points, complete {}: {ms:.2} ms prepared, {cold:.2} ms not",
            found.branches.len(),
            found.complete
        );
    }
}
