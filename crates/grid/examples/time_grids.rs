//! How long a 500 x 500 sheet takes: transfinite interpolation and 200 elliptic sweeps.
use moldloft_grid::*;
use moldloft_num::Vec3;
use std::time::Instant;

fn main() {
    let n = 500;
    let start = Sheet::<f64>::from_fn(n, n, |i, j| {
        let (u, v) = (i as f64 / (n - 1) as f64, j as f64 / (n - 1) as f64);
        let bump = 0.2 * (std::f64::consts::PI * u).sin() * (1.0 - v);
        Vec3::of(u + 0.1 * v * v, v + bump, 0.0)
    });
    let mut best = f64::INFINITY;
    let mut grid = start.clone();
    for _ in 0..30 {
        let t = Instant::now();
        grid = transfinite(&start, Blend::Arc).unwrap();
        best = best.min(t.elapsed().as_secs_f64());
    }
    println!("transfinite by arc length: {:.3} ms", best * 1e3);
    for (name, method) in [("Laplace", Method::Laplace), ("Middlecoff", Method::Middlecoff)] {
        let asked: Vec<usize> =
            std::env::args().skip(1).filter_map(|word| word.parse().ok()).collect();
        for threads in if asked.is_empty() { vec![1, 2] } else { asked } {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut best = f64::INFINITY;
            for _ in 0..3 {
                let t = Instant::now();
                let options = Elliptic {
                    method,
                    sweeps: 200,
                    tolerance: 0.0,
                    omega: 1.0,
                    walls: vec![],
                    on: None,
                };
                pool.install(|| elliptic(&grid, &options)).unwrap();
                best = best.min(t.elapsed().as_secs_f64());
            }
            println!("200 sweeps, {name}, {threads} threads: {best:.3} s");
        }
    }
}
