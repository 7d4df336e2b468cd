//! Times array statements inside a running program, beside the same loop compiled in one piece.
//!
//! `cargo run --release -p moldloft-lang --example time_statements [points…]`
//!
//! The least time of many short runs, by the clock, so that other work on the machine counts little; a
//! statement's is the difference of a program that repeats it and one that repeats an empty statement.

use moldloft_document::{Document, NoFiles, registry};
use pulp::{Arch, Simd, WithSimd};
use std::time::{Duration, Instant};

const BEZIER: &str = "c = p0*(1 - u)^3 + 3*p1*u*(1 - u)^2 + 3*p2*u^2*(1 - u) + p3*u^3;";

/// Statements of other shapes: a line, a product of rows, a normal, a root, numbers alone.
const OTHERS: [(&str, &str); 6] = [
    ("line", "c = p1 + u*(p2 - p1);"),
    ("curves", "c = d*u + e*(1 - u);"),
    ("cross", "c = (d .* e)/(1 + u);"),
    ("unit", "c = d/|d + e|;"),
    ("numbers", "f = 3*u^2 - 2*u^3 + u*(1 - u)/(1 + u);"),
    ("sine", "f = sin(u)*u;"),
];

/// The least time of a call by the clock, in seconds.
fn least(mut work: impl FnMut(), seconds: f64) -> f64 {
    let (start, mut best) = (Instant::now(), f64::INFINITY);
    while start.elapsed() < Duration::from_secs_f64(seconds) {
        let begun = Instant::now();
        work();
        best = best.min(begun.elapsed().as_secs_f64());
    }
    best
}

/// Seconds for one execution of a statement on `n` points.
fn statement(text: &str, n: usize) -> f64 {
    let repeats = (8_000_000 / n).clamp(16, 20_000);
    let head = format!(
        "vector p0 = {{0, 0, 0}}, p1 = {{1, 2, 0}}, p2 = {{3, 2, 1}}, p3 = {{4, 0, 1}};\n\
         farray u = uniform(0, 1, {n}), f[{n}]; curve c[{n}], d = p0 + u*{{1, 2, 3}}, e = {{u, u, 1 - u}};\n"
    );
    let whole = |inside: &str| {
        let text = format!("{head}for (k = 1:{repeats}) {{ {inside} }}");
        let mut document = Document::from_text(registry(), Box::new(NoFiles), "t.sdl", &text);
        assert!(document.diagnostics().is_empty(), "{:?}", document.diagnostics().first());
        least(|| _ = document.set_text(&text), 0.7)
    };
    (whole(text) - whole(";")) / repeats as f64
}

/// The Bezier curve as one loop for the processor's registers.
struct Compiled<'a> {
    u: &'a [f64],
    out: &'a mut [Vec<f64>; 3],
}

impl WithSimd for Compiled<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        const POINTS: [[f64; 3]; 4] =
            [[0.0, 0.0, 0.0], [1.0, 2.0, 0.0], [3.0, 2.0, 1.0], [4.0, 0.0, 1.0]];
        let points = std::hint::black_box(POINTS);
        let (u, _) = S::as_simd_f64s(self.u);
        let [x, y, z] = self.out;
        let outs = [x, y, z].map(|row| S::as_mut_simd_f64s(row).0);
        let (one, three) = (simd.splat_f64s(1.0), simd.splat_f64s(3.0));
        let points = points.map(|p| p.map(|x| simd.splat_f64s(x)));
        for i in 0..u.len() {
            let u = u[i];
            let v = simd.sub_f64s(one, u);
            let (u2, v2) = (simd.mul_f64s(u, u), simd.mul_f64s(v, v));
            let weights = [
                simd.mul_f64s(v, v2),
                simd.mul_f64s(simd.mul_f64s(three, u), v2),
                simd.mul_f64s(simd.mul_f64s(three, u2), v),
                simd.mul_f64s(u, u2),
            ];
            for k in 0..3 {
                let mut sum = simd.mul_f64s(points[0][k], weights[0]);
                for j in 1..4 {
                    sum = simd.add_f64s(sum, simd.mul_f64s(points[j][k], weights[j]));
                }
                outs[k][i] = sum;
            }
        }
    }
}

fn compiled(n: usize) -> f64 {
    let u: Vec<f64> = (0..n).map(|k| k as f64 / n as f64).collect();
    let mut out = [(); 3].map(|()| vec![0.0; n]);
    let (arch, repeats) = (Arch::new(), (1_000_000 / n).max(4));
    let all = || {
        for _ in 0..repeats {
            arch.dispatch(Compiled { u: &u, out: &mut out });
            std::hint::black_box(&mut out);
        }
    };
    least(all, 0.7) / repeats as f64
}

fn main() {
    let mut sizes: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    if sizes.is_empty() {
        sizes = vec![60, 1_000, 10_000, 100_000, 1_000_000];
    }
    println!("ns a point\n{:>9} {:>8} {:>9} {:>6}", "points", "Bezier", "compiled", "ratio");
    for &n in &sizes {
        let point = 1e9 / n as f64;
        let (ours, compiled) = (statement(BEZIER, n) * point, compiled(n) * point);
        println!("{n:9} {ours:8.2} {compiled:9.2} {:6.2}", ours / compiled);
    }
    for (name, text) in OTHERS {
        print!("{name:>9}");
        for &n in &sizes {
            print!(" {:8.2}", statement(text, n) * 1e9 / n as f64);
        }
        println!("  {text}");
    }
}
