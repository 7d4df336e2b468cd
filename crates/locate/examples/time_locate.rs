//! Times nearest points and intersections on the 20 x 20 bicubic surface of the comparisons:
//! `cargo run --release -p moldloft-locate --example time_locate`.

#[path = "../tests/common/mod.rs"]
mod common;

use common::{Random, bumpy};
use moldloft_locate::NearestSurface;
use moldloft_num::{Order, Surface, Vec3};
use std::time::Instant;

fn main() {
    let s = bumpy(20, 7);
    let start = Instant::now();
    let prepared = NearestSurface::new(&s);
    println!("prepared in {:?}, {} cells", start.elapsed(), prepared.cells());
    let mut random = Random(99);
    let near: Vec<Vec3> = (0..50_000)
        .map(|_| {
            let j = s.jet(random.next(), random.next(), Order::First);
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
        // The least of several runs: what else the machine does only adds.
        let run = |_| {
            let start = Instant::now();
            let sum: f64 = points.iter().map(|p| prepared.nearest(&s, *p).distance).sum();
            (start.elapsed().as_secs_f64() / points.len() as f64, sum)
        };
        let (each, sum) = (0..7).map(run).fold((f64::INFINITY, 0.0), |a, b| (a.0.min(b.0), b.1));
        println!("{name}: {:.2} us a point (sum of distances {sum})", each * 1e6);
    }
}
