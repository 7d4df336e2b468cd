//! Time of a 500 x 500 grid: transfinite interpolation and 200 elliptic sweeps, by the clock and,
//! if the system supports it, by processor time of all threads.
use moldloft_grid::*;
use moldloft_num::Vec3;
use std::time::Instant;

/// Processor time of this program so far, in seconds.
fn processor() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // After the name in brackets; user and system time are the twelfth and thirteenth field, in
    // hundredths of a second.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: u64 = fields.get(11)?.parse::<u64>().ok()? + fields.get(12)?.parse::<u64>().ok()?;
    Some(ticks as f64 / 100.0)
}

fn main() {
    let n = 500;
    let start = SurfaceGrid::<f64>::from_fn(n, n, |i, j| {
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
            let (mut best, mut work) = (f64::INFINITY, f64::INFINITY);
            for _ in 0..5 {
                let (t, before) = (Instant::now(), processor());
                let options = Elliptic {
                    method,
                    sweeps: 200,
                    tolerance: 0.0,
                    omega: 1.0,
                    walls: vec![],
                    periodic: None,
                    on: None,
                };
                pool.install(|| elliptic(&grid, &options)).unwrap();
                best = best.min(t.elapsed().as_secs_f64());
                if let (Some(before), Some(after)) = (before, processor()) {
                    work = work.min(after - before);
                }
            }
            println!(
                "200 sweeps, {name}, {threads} threads: {best:.3} s by the clock, {work:.2} s of processors"
            );
        }
    }
}
