//! Times a bicubic surface of 20 x 20 control points: the tensor grid of 1000 x 1000 parameters,
//! and a million scattered ones; and a loft through three quadratic curves, 51 x 101 points with
//! normals, each column built once.

use moldloft_num::{Curve, Dual4, Order, Real, SurfJet, Surface, Uni1, Vec3};
use moldloft_spline::{BSplineCurve, BSplineSurface, InterpolatingSpline, KnotVector};
use std::hint::black_box;
use std::time::Instant;

fn surface<T: Real>() -> BSplineSurface<T> {
    let knots = KnotVector::clamped_uniform(3, 20).expect("20 points make a cubic");
    let point = |i: usize, j: usize| {
        let (x, y) = (i as f64 / 19.0, j as f64 / 19.0);
        Vec3::of(x, y, 0.2 * libm::sin(7.0 * x) * libm::cos(5.0 * y))
    };
    let points = (0..400).map(|k| point(k / 20, k % 20)).collect();
    BSplineSurface::new(knots.clone(), knots, points, None).expect("a full net")
}

/// The median of 15 runs, in milliseconds.
fn time(name: &str, mut run: impl FnMut()) {
    let mut all: Vec<f64> = (0..15)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    all.sort_by(f64::total_cmp);
    println!("{name:44} {:8.3} ms (best {:.3})", all[7], all[0]);
}

fn times<T: Real>(scalar: &str) {
    let s = surface::<T>();
    let n = 1000;
    let ts: Vec<f64> = (0..n).map(|k| k as f64 / (n - 1) as f64).collect();
    let mut points = vec![Vec3::<T>::zero(); n * n];
    let mut normals = points.clone();
    time(&format!("{scalar}: grid"), || s.grid(&ts, &ts, black_box(&mut points), None));
    time(&format!("{scalar}: grid with normals"), || {
        s.grid(&ts, &ts, black_box(&mut points), Some(&mut normals));
    });
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let uv: Vec<[f64; 2]> = (0..n * n).map(|_| [random(), random()]).collect();
    s.scattered(&uv, &mut points);
    time(&format!("{scalar}: scattered"), || s.scattered(&uv, black_box(&mut points)));
    let mut jets = vec![SurfJet::<T>::default(); n * n];
    time(&format!("{scalar}: scattered with derivatives"), || {
        s.scattered_first(&uv, black_box(&mut jets));
    });
    time(&format!("{scalar}: scattered with normals"), || {
        let batches = jets.chunks_mut(256).zip(uv.chunks(256));
        for ((jets, uv), normals) in batches.zip(normals.chunks_mut(256)) {
            s.scattered_first(uv, jets);
            for (n, j) in normals.iter_mut().zip(jets) {
                *n = j.normal();
            }
        }
    });
    time(&format!("{scalar}: one by one"), || {
        for (x, &[u, v]) in points.iter_mut().zip(&uv) {
            *x = s.jet(T::from(u), T::from(v), Order::Zero).p;
        }
    });
}

fn loft<T: Real>(scalar: &str) {
    let masters = [0.0, 15.0, 30.0].map(|x| {
        let y = [3.0, 4.0, 3.0 + 0.02 * x, 0.0];
        let points = (0..4).map(|k| Vec3::of(x, y[k] * (31.0 - x) / 30.0, 2.5 - k as f64));
        BSplineCurve::<T>::uniform(2, points.collect()).expect("four points make a quadratic")
    });
    let us: Vec<f64> = (0..51).map(|k| k as f64 / 50.0).collect();
    let vs: Vec<f64> = (0..101).map(|k| k as f64 / 100.0).collect();
    let mut points = vec![Vec3::<T>::zero(); 51 * 101];
    let mut normals = points.clone();
    let mut jets = vec![[Vec3::<Uni1<T>>::zero(); 3]; 101];
    time(&format!("{scalar}: loft 51 x 101 with normals"), || {
        for (i, &u) in us.iter().enumerate() {
            let column = masters.each_ref().map(|m| {
                let [p, d, _] = m.jet(u.into(), Order::First);
                let part = |k: usize| Uni1 { f: p[k], t: d[k] };
                Vec3::new(part(0), part(1), part(2))
            });
            let loft = InterpolatingSpline::through(&column).expect("distinct masters");
            loft.pieces().jets_many(&vs, Order::First, &mut jets);
            let places = points[i * 101..].iter_mut().zip(&mut normals[i * 101..]);
            for ((point, normal), jet) in places.zip(&jets) {
                *point = jet[0].map(|x| x.f);
                let (su, sv) = (jet[0].map(|x| x.t), jet[1].map(|x| x.f));
                let n = su.cross(sv);
                *normal = n * (T::one() / n.norm());
            }
        }
        black_box((&mut points, &mut normals));
    });
}

fn main() {
    loft::<f64>("f64");
    loft::<Dual4>("Dual4");
    times::<f64>("f64");
    times::<Dual4>("Dual4");
}
