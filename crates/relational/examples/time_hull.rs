//! Times the grid of the paper's hull, 51 x 101 points with normals, on one thread: in plain
//! numbers, with four derivatives at once, and point by point.
//!
//! `cargo run --release -p moldloft-relational --example time_hull`

#[path = "../tests/it/common.rs"]
#[allow(dead_code, unused_imports)]
mod common;

use common::{HULL, run, scene};
use moldloft_num::{Dual4, Order, Real, Surface, Vec3};
use std::hint::black_box;
use std::time::Instant;

fn main() {
    let plain = scene(HULL);
    // Four coordinates of P21 and P22 are followed.
    let seeded = |k: usize, x: f64| match k {
        14..=17 => Dual4::seeded(x, k - 14),
        _ => Dual4::from(x),
    };
    let dual = run(HULL, &mut { seeded }).expect("the hull builds");
    let a = grid_time(&**plain.surface("hull"));
    let b = grid_time(&**dual.surface("hull"));
    let c = median(31, || {
        for i in 0..=50 {
            for j in 0..=100 {
                let (u, v) = (f64::from(i) / 50.0, f64::from(j) / 100.0);
                black_box(plain.surface("hull").jet(u, v, Order::First).normal());
            }
        }
    });
    println!("hull 51 x 101 with normals");
    println!("  f64 grid    {a:8.1} us");
    println!("  Dual4 grid  {b:8.1} us  ({:.2} times)", b / a);
    println!("  f64 by jets {c:8.1} us");
}

fn grid_time<T: Real>(surface: &dyn Surface<T>) -> f64 {
    let us: Vec<f64> = (0..=50).map(|i| f64::from(i) / 50.0).collect();
    let vs: Vec<f64> = (0..=100).map(|j| f64::from(j) / 100.0).collect();
    let mut points = vec![Vec3::zero(); us.len() * vs.len()];
    let mut normals = points.clone();
    median(501, || {
        surface.grid(black_box(&us), &vs, &mut points, Some(&mut normals));
        black_box((&points, &normals));
    })
}

/// The median time of a call, in microseconds.
fn median(times: usize, mut f: impl FnMut()) -> f64 {
    let mut all: Vec<f64> = (0..times)
        .map(|_| {
            let start = Instant::now();
            f();
            start.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    all.sort_by(f64::total_cmp);
    all[times / 2]
}
