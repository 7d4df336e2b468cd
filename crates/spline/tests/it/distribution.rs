//! The figures and laws of distributions.

use moldloft_num::{Dual, Real};
use moldloft_spline::distribution::*;

type Law = fn(f64, f64, f64, f64, usize) -> Result<Vec<f64>, DistributionError>;

fn near(a: f64, b: f64, accuracy: f64) {
    assert!((a - b).abs() <= accuracy, "{a} against {b}");
}

fn laws() -> [(&'static str, Law, [f64; 2], usize); 12] {
    let cos: Law = |s, e, _, _, n| cosine(s, e, n);
    let geo: Law = |s, e, a, _, n| geometric(s, e, a, n);
    [
        ("cosine", cos, [0.0, 0.0], 30),
        ("geometric", geo, [0.01, 0.0], 25),
        ("geometric wide", geo, [0.2, 0.0], 11),
        ("geometric2", geometric2, [0.001, 0.02], 40),
        ("geometric2 wide", geometric2, [0.2, 0.1], 12),
        ("d_sinh", d_sinh, [0.01, 0.0], 25),
        ("d_sinh end", d_sinh, [0.0, 0.05], 25),
        ("d_tanh", d_tanh, [0.07, 0.01], 60),
        ("d_tanh strong", d_tanh, [1e-6, 1e-3], 101),
        ("d_tanh end", d_tanh, [0.0, 0.15], 11),
        ("d_tanhx", d_tanhx, [0.07, 0.01], 60),
        ("d_tanhx end", d_tanhx, [0.0, 0.01], 25),
    ]
}

#[test]
fn tanh_figures() {
    // Spacings, n, second number, middle (or 13th-style) number with its index, last cell, growth.
    for (ds, n, first, (index, middle), last, growth) in [
        ([0.07, 0.01], 60, 0.06545082086504, (30, 0.7203569807627), 0.00990584197073, 1.1380126),
        ([0.01, 0.0], 25, 0.010670039957658, (13, 0.26827619924789), 0.074274095963786, 1.1358486),
        ([0.05, 0.0], 20, 0.050196593781449, (10, 0.46395932174911), 0.053984373790931, 1.0076044),
        ([0.001, 0.1], 51, 0.0010449842892089, (26, 1.0 / 11.0), 0.094701257610166, 1.1145752),
        (
            [1e-6, 1e-3],
            101,
            1.0911664370413e-6,
            (51, 0.030653430031716),
            0.0010899782786742,
            1.1877119,
        ),
        ([0.2, 0.2], 21, 0.14792613860768, (11, 0.5), 0.14792613860768, 1.6765393),
        ([0.15, 0.0], 11, 0.14051337918321, (6, 0.57699243911071), 0.080771483919979, 1.1270755),
        ([0.05, 0.05], 21, 0.05, (11, 0.5), 0.05, 1.0),
        ([0.1, 0.0], 11, 0.1, (6, 0.5), 0.1, 1.0),
    ] {
        let s = d_tanh(0.0, 1.0, ds[0], ds[1], n).unwrap();
        near(s[1], first, 1e-13 * first.max(0.01));
        near(s[index - 1], middle, 2e-14);
        near(s[n - 1] - s[n - 2], last, 1e-14);
        let cells: Vec<f64> = s.windows(2).map(|w| w[1] - w[0]).collect();
        let ratios = cells.windows(2).map(|c| (c[1] / c[0]).max(c[0] / c[1]));
        near(ratios.fold(1.0, f64::max), growth, 6e-8);
    }
}

#[test]
fn exact_cell_figures() {
    // The last figure is from 40-digit arithmetic.
    for (ds, n, (index, middle), last) in [
        ([0.07, 0.01], 60, (30, 0.7267385332822), 0.01),
        ([0.01, 0.0], 25, (13, 0.2596415159779), 0.0758964215795),
        ([0.05, 0.0], 20, (10, 0.4631578405813), 0.054096899400101),
    ] {
        let s = d_tanhx(0.0, 1.0, ds[0], ds[1], n).unwrap();
        assert_eq!(s[1], ds[0]);
        near(s[index - 1], middle, 1e-13);
        near(s[n - 1] - s[n - 2], last, 1e-13);
    }
}

#[test]
fn other_figures() {
    let s = geometric(0.0, 1.0, 0.01, 25).unwrap();
    near((s[2] - s[1]) / s[1], 1.1085107373725, 1e-12);
    near(s[12], 0.2250965120735, 1e-13);
    near(s[24] - s[23], 0.1069098686887, 1e-13);
    let s = geometric(0.0, 1.0, 0.01, 11).unwrap();
    near((s[2] - s[1]) / s[1], 1.4739368134521, 1e-12);
    let s = d_sinh(0.0, 1.0, 0.01, 0.0, 25).unwrap();
    near(s[1], 0.010031966216568, 1e-15);
    near(s[12], 0.183317939755508, 1e-14);
    near(s[24] - s[23], 0.129632969328503, 1e-14);
    let s = cosine(0.0, 1.0, 9).unwrap();
    for (x, want) in s.iter().zip([0.0, 0.0380602337, 0.1464466094, 0.3086582838, 0.5]) {
        near(*x, want, 1e-10);
    }
    assert_eq!(redist(&[0.0, 1.0, 4.0], 5).unwrap(), [0.0, 0.5, 1.0, 2.5, 4.0]);
    assert_eq!(redist(&s, 9).unwrap(), s);
}

#[test]
fn ends_are_exact_and_all_rise() {
    for (name, law, [a, b], n) in laws() {
        for (start, end) in [(0.0, 1.0), (0.3, 1.3), (-0.1, -1.1)] {
            let s = law(start, end, a, b, n).unwrap();
            assert_eq!((s.len(), s[0], s[n - 1]), (n, start, end), "{name}");
            let direction: f64 = end - start;
            assert!(s.windows(2).all(|w| (w[1] - w[0]) * direction > 0.0), "{name}");
        }
    }
}

#[test]
fn turning_the_ends_round_mirrors() {
    for (name, law, [a, b], n) in laws() {
        if name.starts_with("geometric") && !name.starts_with("geometric2") {
            continue;
        }
        let (s, m) = (law(0.0, 1.0, a, b, n).unwrap(), law(0.0, 1.0, b, a, n).unwrap());
        for i in 0..n {
            near(s[i], 1.0 - m[n - 1 - i], 1e-14);
        }
    }
    let skew = (0.01f64 / 0.07).sqrt();
    let s = d_tanh(0.0, 1.0, 0.07, 0.01, 61).unwrap();
    near(s[30], 1.0 / (1.0 + skew), 1e-15);
}

#[test]
fn nothing_happens_where_tan_becomes_tanh() {
    // B = 1 at a spacing of 0.05.
    for one_sided in [false, true] {
        let at = |ds: f64| d_tanh(0.0, 1.0, ds, if one_sided { 0.0 } else { ds }, 21).unwrap();
        let (wide, even, fine) = (at(0.05 + 1e-15), at(0.05), at(0.05 - 1e-15));
        for i in 0..21 {
            near(even[i], i as f64 / 20.0, 2e-15);
            near(wide[i], even[i], 1e-14);
            near(fine[i], even[i], 1e-14);
        }
    }
}

#[test]
fn geometric_cells_are_the_asked_ones() {
    let s = geometric2(2.0, -1.0, 0.01, 0.05, 41).unwrap();
    near(2.0 - s[1], 0.01, 1e-15);
    near(s[39] + 1.0, 0.05, 1e-15);
    let cells: Vec<f64> = s.windows(2).map(|w| w[0] - w[1]).collect();
    let ratio = cells[1] / cells[0];
    assert!(cells.windows(2).all(|c| c[1] / c[0] < ratio * 1.01 && c[0] / c[1] < ratio * 1.01));
}

#[test]
fn derivatives_by_limits_and_spacings_are_central_differences() {
    type D = Dual<4>;
    let dual: [fn(D, D, D, D, usize) -> Result<Vec<D>, DistributionError>; 12] = [
        |s, e, _, _, n| cosine(s, e, n),
        |s, e, a, _, n| geometric(s, e, a, n),
        |s, e, a, _, n| geometric(s, e, a, n),
        geometric2,
        geometric2,
        d_sinh,
        d_sinh,
        d_tanh,
        d_tanh,
        d_tanh,
        d_tanhx,
        d_tanhx,
    ];
    for ((name, law, [a, b], n), dual) in laws().into_iter().zip(dual) {
        let x = [0.1, 1.2, a, b];
        let seeds: [D; 4] = std::array::from_fn(|k| D::seeded(x[k], k));
        let exact = dual(seeds[0], seeds[1], seeds[2], seeds[3], n).unwrap();
        let plain = law(x[0], x[1], x[2], x[3], n).unwrap();
        for k in 0..4 {
            let h = 1e-5 * x[k].abs();
            if h == 0.0 {
                continue;
            }
            let at = |h: f64| {
                let mut y = x;
                y[k] += h;
                law(y[0], y[1], y[2], y[3], n).unwrap()
            };
            let (low, high) = (at(-h), at(h));
            for i in 0..n {
                assert_eq!(exact[i].re().to_bits(), plain[i].to_bits(), "{name} {i}");
                let centred = (high[i] - low[i]) / (2.0 * h);
                let size = 1.0 + exact[i].eps[k].abs();
                let error = (exact[i].eps[k] - centred).abs();
                // Rounding of the difference, then its curvature.
                assert!(
                    error < 1e-14 / h + 1e-6 * size,
                    "{name} {i} {k}: {centred} {:?}",
                    exact[i]
                );
            }
        }
    }
}

#[test]
fn refuses_with_the_numbers() {
    let few = DistributionError::TooFew { expected: 2, actual: 1 };
    assert_eq!(uniform(0.0, 1.0, 1), Err(few));
    let spacing = DistributionError::Spacing { spacing: -0.1 };
    assert_eq!(d_tanh(0.0, 1.0, -0.1, 0.1, 9), Err(spacing));
    assert!(matches!(d_tanh(0.0, 1.0, f64::NAN, 0.1, 9), Err(DistributionError::Spacing { .. })));
    assert!(matches!(cosine(f64::NAN, 1.0, 9), Err(DistributionError::Limits { .. })));
    assert!(matches!(d_tanh(1.0, 1.0, 0.1, 0.1, 9), Err(DistributionError::Limits { .. })));
    let both = DistributionError::TwoSided { spacings: [0.1, 0.2] };
    assert_eq!(d_sinh(0.0, 1.0, 0.1, 0.2, 9), Err(both));
    for refused in [
        d_sinh(0.0, 1.0, 0.3, 0.0, 9),
        geometric(0.0, 1.0, 1.0, 9),
        geometric2(0.0, 1.0, 0.6, 0.4, 9),
        d_tanhx(0.0, 1.0, 0.6, 0.4, 9),
    ] {
        let error = refused.unwrap_err();
        assert!(matches!(error, DistributionError::Unreachable { cells: 8, .. }), "{error}");
    }
}
