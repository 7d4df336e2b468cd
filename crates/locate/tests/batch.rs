//! Many nearest points at once: none wrong.

mod common;

use common::{Random, Sphere, brute, bumpy};
use moldloft_locate::{NearestSurface, nearest_on_surface};
use moldloft_num::{Order, Surface, Vec3};
use std::time::Instant;

/// Random points above, below and beside the surface, and near it: no other point of it is nearer.
/// The twin is a fine grid with a coordinate search; `MOLDLOFT_SOAK=1` asks for a million points.
#[test]
fn no_foot_is_wrong() {
    let s = bumpy(20, 7);
    let prepared = NearestSurface::new(&s);
    let mut random = Random(99);
    // A net of samples with their places: the brute force starts from the nearest ones.
    let soak = std::env::var("MOLDLOFT_SOAK").is_ok();
    let count = if soak { 1_000_000 } else { 3_000 };
    let n = 340;
    let ts: Vec<f64> = (0..=n).map(|i| f64::from(i) / f64::from(n)).collect();
    let mut grid = vec![Vec3::zero(); ts.len() * ts.len()];
    s.grid(&ts, &ts, &mut grid, None);
    let mut wrong = 0;
    for k in 0..count {
        let p = match k % 3 {
            0 => Vec3::of(
                random.between(-2.0, 11.5),
                random.between(-2.0, 11.5),
                random.between(-3.0, 4.0),
            ),
            1 => Vec3::of(
                random.between(0.0, 9.5),
                random.between(0.0, 9.5),
                random.between(0.0, 1.0),
            ),
            _ => {
                let j = s.jet(random.next(), random.next(), Order::First);
                j.p + j.normal() * random.between(-0.2, 0.2)
            }
        };
        let ([u, v], d) = prepared.nearest(&s, p);
        let x = s.jet(u, v, Order::Zero).p;
        assert!((x.distance(p) - d).abs() < 1e-11, "{p:?}");
        // No sample is nearer: cheap, and for all; the polished twin for some.
        let sample = if soak && k % 50 != 0 {
            f64::INFINITY
        } else {
            grid.iter().map(|g| (*g - p).norm_sq()).fold(f64::INFINITY, f64::min).sqrt()
        };
        let twin = if k % 100 == 0 { brute(&s, p, 200).0 } else { f64::INFINITY };
        if sample.min(twin) < d - 1e-9 {
            wrong += 1;
            println!("{p:?}: {d} at {u} {v}, but {sample} or {twin}");
        }
    }
    assert_eq!(wrong, 0);
    let start = Instant::now();
    let points: Vec<Vec3> = (0..20_000)
        .map(|_| {
            let j = s.jet(random.next(), random.next(), Order::First);
            j.p + j.normal() * 0.004
        })
        .collect();
    let made = start.elapsed();
    let start = Instant::now();
    let sum: f64 = points.iter().map(|p| prepared.nearest(&s, *p).1).sum();
    let near = start.elapsed().as_secs_f64() / 20_000.0;
    let far: Vec<Vec3> = (0..20_000)
        .map(|_| {
            Vec3::of(
                random.between(-2.0, 11.5),
                random.between(-2.0, 11.5),
                random.between(-3.0, 4.0),
            )
        })
        .collect();
    let start = Instant::now();
    let sum2: f64 = far.iter().map(|p| prepared.nearest(&s, *p).1).sum();
    let wide = start.elapsed().as_secs_f64() / 20_000.0;
    println!("{made:?} {sum} {sum2}: near {:.2} us, anywhere {:.2} us", near * 1e6, wide * 1e6);
}

#[test]
fn shapes_that_are_no_splines_use_the_general_search() {
    let s = Sphere { centre: Vec3::of(1.0, 0.0, 0.0), radius: 2.0 };
    let prepared = NearestSurface::new(&s);
    let p = Vec3::of(4.0, 0.0, 4.0);
    assert!((prepared.nearest(&s, p).1 - 3.0).abs() < 1e-12);
    assert_eq!(prepared.nearest(&s, p).0, nearest_on_surface(&s, p, None).at);
}
