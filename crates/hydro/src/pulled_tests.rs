//! Gradients of figures by reverse differentiation against those by forward differentiation.

use crate::body::{Body, HullSide};
use crate::figures::hydrostatics;
use crate::hydrostatics::Symmetry;
use crate::pulled::{PulledBody, pull_hydrostatics};
use moldloft_num::{Adjoints, DerivativeTape, Dual, Real, Rev, Vec3};
use moldloft_spline::{BSplineSurface, KnotVector};

const NET: [usize; 2] = [6, 5];

/// The coordinates of the net of one side of a hull: keel to deck along v, stern to bow along u.
fn coordinates(flat: bool) -> Vec<f64> {
    let mut all = Vec::new();
    for i in 0..NET[0] {
        for j in 0..NET[1] {
            let (x, s) = (i as f64 / (NET[0] - 1) as f64, j as f64 / (NET[1] - 1) as f64);
            let full = if flat { 1.0 } else { 4.0 * x * (1.0 - x) };
            all.extend([
                6.0 * x + 0.1 * s,
                full * s * (1.0 + 0.1 * x),
                1.6 * s - 1.1 + 0.2 * x * x,
            ]);
        }
    }
    all
}

fn side<T: Real>(x: &[T]) -> BSplineSurface<T> {
    let knots = NET.map(|n| KnotVector::clamped_uniform(3, n).unwrap());
    let points = x.chunks(3).map(|c| Vec3::new(c[0], c[1], c[2])).collect();
    let [u, v] = knots;
    BSplineSurface::new(u, v, points, None).unwrap()
}

/// A cover of one plate behind the stern, as panels.
const PANELS: [[[f64; 3]; 4]; 1] =
    [[[-0.4, 0.0, -0.9], [-0.3, 0.4, -0.8], [-0.3, 0.5, 0.2], [-0.4, 0.0, 0.3]]];

fn figures(x: &[f64], at: usize, of: PulledBody<'_>) -> Vec<(&'static str, f64, f64)> {
    let seeded = |(k, x): (usize, &f64)| Dual::<1> { re: *x, eps: [f64::from(k == at)] };
    let surface = side(&x.iter().enumerate().map(seeded).collect::<Vec<_>>());
    let side = HullSide { surface: &surface, reversed: true, open_edges: [false; 4], loops: None };
    let panels = of.panels.iter().map(|p| p.map(Vec3::lifted));
    let body = Body::new(&[side], panels, Vec::new(), of.size, of.accuracy).unwrap();
    let body = if of.lengthwise { body.with_mirror_image(0) } else { body };
    let found = hydrostatics(&body, Dual::from(0.0), of.symmetry, 1.0).figures();
    found.into_iter().map(|(name, y)| (name, y.re, y.eps[0])).collect()
}

/// The gradients of all figures, and the weights of the corners of the panels.
fn pulled(x: &[f64], of: PulledBody<'_>, names: &[&str]) -> (Vec<Vec<f64>>, Vec<Vec<[Vec3; 4]>>) {
    DerivativeTape::clear();
    DerivativeTape::probe();
    let inputs: Vec<Rev> = x.iter().map(|&x| DerivativeTape::input(x)).collect();
    let surface = side(&inputs);
    let side = HullSide { surface: &surface, reversed: true, open_edges: [false; 4], loops: None };
    let weights: Vec<_> = names.iter().map(|name| vec![(*name, 1.0)]).collect();
    let mut adjoints = vec![Adjoints::new(); names.len()];
    let panels = pull_hydrostatics(&[side], of, &weights, &mut adjoints).unwrap();
    let rows = adjoints.iter_mut().map(|adjoints| {
        adjoints.pull();
        inputs.iter().map(|x| adjoints.of(*x)).collect()
    });
    let rows = rows.collect();
    assert!(DerivativeTape::is_sound() && adjoints.iter().all(Adjoints::are_sound));
    (rows, panels)
}

fn compare(x: &[f64], of: PulledBody<'_>) -> f64 {
    let forward: Vec<_> = (0..x.len()).map(|at| figures(x, at, of)).collect();
    let names: Vec<&str> = forward[0].iter().map(|(name, _, _)| *name).collect();
    let (rows, _) = pulled(x, of, &names);
    let mut worst: f64 = 0.0;
    for (k, (name, row)) in names.iter().zip(&rows).enumerate() {
        let size = forward.iter().map(|f| f[k].2.abs()).fold(1e-3, f64::max);
        for (at, (found, exact)) in row.iter().zip(forward.iter().map(|f| f[k].2)).enumerate() {
            let off = (found - exact).abs() / size;
            assert!(off < 1e-9, "{name} by {at}: {found} {exact}");
            worst = worst.max(off);
        }
    }
    worst
}

fn body<'a>(panels: &'a [[Vec3; 4]], symmetry: Symmetry, lengthwise: bool) -> PulledBody<'a> {
    PulledBody { panels, size: 7.0, accuracy: 1e-6, lengthwise, symmetry }
}

#[test]
fn gradients_of_all_figures_are_those_of_forward_mode() {
    let panels = PANELS.map(|p| p.map(|[x, y, z]| Vec3::of(x, y, z)));
    for flat in [false, true] {
        let x = coordinates(flat);
        for of in [
            body(&[], Symmetry::MirroredTwice, false),
            body(&panels, Symmetry::MirroredOnce, false),
            body(&[], Symmetry::None, true),
        ] {
            let worst = compare(&x, of);
            assert!(worst < 1e-9, "{worst}");
        }
    }
}

#[test]
fn corners_of_panels_have_weights() {
    let panels = PANELS.map(|p| p.map(|[x, y, z]| Vec3::of(x, y, z)));
    let x = coordinates(false);
    let of = body(&panels, Symmetry::MirroredTwice, false);
    let names = ["volume", "wetted_area", "lcb", "waterplane_it"];
    let (_, weights) = pulled(&x, of, &names);
    let value = |panels: &[[Vec3; 4]], k: usize| {
        let found = figures(&x, usize::MAX, PulledBody { panels, ..of });
        found.iter().find(|(name, _, _)| *name == names[k]).unwrap().1
    };
    for (k, weights) in weights.iter().enumerate() {
        for corner in 0..4 {
            for axis in 0..3 {
                let moved = |h: f64| {
                    let mut panels = panels;
                    let mut p = panels[0][corner].to_array();
                    p[axis] += h;
                    panels[0][corner] = p.into();
                    value(&panels, k)
                };
                let exact = (moved(1e-4) - moved(-1e-4)) / 2e-4;
                let found = weights[0][corner][axis];
                assert!(
                    (found - exact).abs() < 1e-6,
                    "{} {corner} {axis}: {found} {exact}",
                    names[k]
                );
            }
        }
    }
}

#[test]
fn figures_that_do_not_exist_have_no_gradient() {
    let x: Vec<f64> = coordinates(false).chunks(3).flat_map(|c| [c[0], c[1], c[2] - 5.0]).collect();
    DerivativeTape::clear();
    DerivativeTape::probe();
    let inputs: Vec<Rev> = x.iter().map(|&x| DerivativeTape::input(x)).collect();
    let surface = side(&inputs);
    let side = HullSide { surface: &surface, reversed: true, open_edges: [false; 4], loops: None };
    let weights = [vec![("waterplane_area", 1.0)]];
    let of = body(&[], Symmetry::MirroredTwice, false);
    assert!(pull_hydrostatics(&[side], of, &weights, &mut [Adjoints::new()]).is_none());
}
