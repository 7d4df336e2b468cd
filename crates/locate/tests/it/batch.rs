//! Many nearest points at once.

use crate::common::{Random, Sphere, brute, bumpy};
use moldloft_locate::{
    LocateStatus, NearestCurve, NearestSurface, by_place, nearest_on_curve, nearest_on_surface,
};
use moldloft_num::{Curve, Jet, Order, Surface, SurfaceFormula, Vec3};
use moldloft_spline::{BSplineCurve, BSplineSurface, KnotVector};

/// The twin: a dense net of samples in blocks with boxes of their own, and from the nearest sample
/// of each block that might have the foot a damped Newton iteration of its own kind.
struct Twin<'a> {
    surface: &'a dyn Surface<f64>,
    ts: Vec<f64>,
    grid: Vec<Vec3>,
    /// Box and first sample of each block.
    blocks: Vec<(Vec3, Vec3, usize, usize)>,
}

const BLOCK: usize = 20;

impl<'a> Twin<'a> {
    fn new(surface: &'a dyn Surface<f64>, n: usize) -> Self {
        let ts: Vec<f64> = (0..=n).map(|i| i as f64 / n as f64).collect();
        let mut grid = vec![Vec3::zero(); ts.len() * ts.len()];
        surface.grid(&ts, &ts, &mut grid, None);
        let mut blocks = Vec::new();
        for i in (0..n).step_by(BLOCK) {
            for j in (0..n).step_by(BLOCK) {
                let mut low: Vec3 = Vec3::of(f64::MAX, f64::MAX, f64::MAX);
                let mut high = -low;
                for a in i..=(i + BLOCK).min(n) {
                    for b in j..=(j + BLOCK).min(n) {
                        let x = grid[a * (n + 1) + b];
                        low = Vec3::of(low.x.min(x.x), low.y.min(x.y), low.z.min(x.z));
                        high = Vec3::of(high.x.max(x.x), high.y.max(x.y), high.z.max(x.z));
                    }
                }
                blocks.push((low, high, i, j));
            }
        }
        Self { surface, ts, grid, blocks }
    }

    /// The distance of the nearest point. `sag` is more than any foot can be nearer than the nearest
    /// sample of its block.
    fn distance(&self, p: Vec3, sag: f64) -> f64 {
        let n = self.ts.len();
        let low = |b: &(Vec3, Vec3, usize, usize)| {
            let out = |l: f64, h: f64, x: f64| (l - x).max(x - h).max(0.0);
            let (l, h) = (b.0, b.1);
            Vec3::of(out(l.x, h.x, p.x), out(l.y, h.y, p.y), out(l.z, h.z, p.z)).norm()
        };
        let mut order: Vec<(f64, usize)> =
            self.blocks.iter().enumerate().map(|(k, b)| (low(b), k)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut found: Vec<(f64, usize, usize)> = Vec::new();
        let mut best = f64::INFINITY;
        for (low, k) in order {
            if low > best + sag {
                break;
            }
            let (_, _, i, j) = self.blocks[k];
            let mut here = (f64::INFINITY, 0, 0);
            for a in i..=(i + BLOCK).min(n - 1) {
                for b in j..=(j + BLOCK).min(n - 1) {
                    let d = (self.grid[a * n + b] - p).norm_sq();
                    if d < here.0 {
                        here = (d, a, b);
                    }
                }
            }
            here.0 = here.0.sqrt();
            best = best.min(here.0);
            found.push(here);
        }
        let polish = |&(d, a, b): &(f64, usize, usize)| {
            if d > best + sag { d } else { self.polished(p, [self.ts[a], self.ts[b]]) }
        };
        found.iter().map(polish).fold(f64::INFINITY, f64::min)
    }

    /// Levenberg's iteration on S(u, v) - p, first derivatives only.
    fn polished(&self, p: Vec3, mut q: [f64; 2]) -> f64 {
        let mut damping = 1e-3;
        let mut j = self.surface.jet(q[0], q[1], Order::First);
        let mut d = (j.p - p).norm_sq();
        for _ in 0..200 {
            let r = j.p - p;
            let mut g = [j.u.dot(r), j.v.dot(r)];
            let mut m = [j.u.norm_sq(), j.u.dot(j.v), j.v.norm_sq()];
            for k in 0..2 {
                if q[k] <= 0.0 && g[k] > 0.0 || q[k] >= 1.0 && g[k] < 0.0 {
                    g[k] = 0.0;
                    m[1] = 0.0;
                }
            }
            let (a, c) = (m[0] * (1.0 + damping), m[2] * (1.0 + damping));
            let det = a * c - m[1] * m[1];
            let step = [(g[0] * c - m[1] * g[1]) / det, (g[1] * a - m[1] * g[0]) / det];
            let next = [0, 1].map(|k| (q[k] - step[k]).clamp(0.0, 1.0));
            let other = self.surface.jet(next[0], next[1], Order::First);
            let e = (other.p - p).norm_sq();
            if e < d {
                let small = d - e <= 1e-16 * d;
                (q, j, d) = (next, other, e);
                damping *= 0.3;
                if small {
                    break;
                }
            } else {
                damping = (damping * 4.0).max(1e-6);
                if damping > 1e12 {
                    break;
                }
            }
        }
        d.sqrt()
    }
}

/// Random points above, below and beside the surface, and near it: no other point of it is nearer.
/// `MOLDLOFT_SOAK=1` makes a million points.
#[test]
fn no_foot_is_wrong() {
    let s = bumpy(20, 7);
    let prepared = NearestSurface::new(&s);
    let twin = Twin::new(&s, 340);
    let mut random = Random::new(99);
    let count = moldloft_testing::rounds(10_000, 1_000_000);
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
                let j = s.jet(random.unit(), random.unit(), Order::First);
                j.p + j.normal() * random.between(-0.2, 0.2)
            }
        };
        let found = prepared.nearest(&s, p);
        let x = s.jet(found.at[0], found.at[1], Order::Zero).p;
        assert!((x.distance(p) - found.distance).abs() < 1e-11 && x == found.xyz, "{p:?}");
        assert!(found.status.is_solution());
        let other = twin.distance(p, 0.05);
        if other < found.distance - 1e-9 {
            wrong += 1;
            println!("{p:?}: {found:?}, but {other}");
        }
    }
    assert_eq!(wrong, 0);
}

/// Surfaces that are no cubic pieces: rational, of degree five, and a torus.
#[test]
fn other_surfaces_have_the_nearest_too() {
    let mut random = Random::new(4);
    let k = KnotVector::clamped_uniform(2, 6).unwrap();
    let mut net = |z: f64| -> Vec<Vec3> {
        (0..36)
            .map(|i| Vec3::of((i / 6) as f64, (i % 6) as f64, z * random.between(-1.0, 1.0)))
            .collect()
    };
    let weights = (0..36).map(|i| 1.0 + 0.5 * f64::from(i % 3)).collect();
    let rational = BSplineSurface::new(k.clone(), k, net(1.5), Some(weights)).unwrap();
    let k = KnotVector::clamped_uniform(5, 6).unwrap();
    let high = BSplineSurface::new(k.clone(), k, net(4.0), None).unwrap();
    let mut random = Random::new(8);
    for s in [&rational, &high] {
        let prepared = NearestSurface::new(s);
        let twin = Twin::new(s, 200);
        for _ in 0..300 {
            let p = Vec3::of(
                random.between(-1.0, 6.0),
                random.between(-1.0, 6.0),
                random.between(-3.0, 3.0),
            );
            let found = prepared.nearest(s, p);
            let other = twin.distance(p, 0.05);
            assert!(found.distance < other + 1e-9, "{p:?} {found:?} {other}");
        }
    }
}

#[test]
fn a_sphere_has_its_closed_form_and_its_centre_is_told() {
    let s = Sphere { centre: Vec3::of(1.0, 0.0, 0.0), radius: 2.0 };
    let prepared = NearestSurface::new(&s);
    let mut random = Random::new(3);
    for _ in 0..200 {
        let p = Vec3::of(
            random.between(-2.0, 4.0),
            random.between(-3.0, 3.0),
            random.between(-3.0, 3.0),
        );
        let found = prepared.nearest(&s, p);
        let exact = (p.distance(s.centre) - 2.0).abs();
        assert!((found.distance - exact).abs() < 1e-12, "{p:?} {found:?} {exact}");
    }
    let p = Vec3::of(4.0, 0.0, 4.0);
    let (a, b) = (prepared.nearest(&s, p).at, nearest_on_surface(&s, p, None).at);
    assert!((0..2).all(|k| (a[k] - b[k]).abs() < 1e-9), "{a:?} {b:?}");
    // All points are equally near: one of them comes, in bounded time, with a word of warning.
    let centre = prepared.nearest(&s, s.centre);
    assert!(
        (centre.distance - 2.0).abs() < 1e-12 && centre.status != LocateStatus::Ok,
        "{centre:?}"
    );
    for p in [Vec3::of(f64::NAN, 0.0, 0.0), Vec3::of(0.0, f64::INFINITY, 0.0)] {
        assert_eq!(prepared.nearest(&s, p).status, LocateStatus::Diverged);
    }
}

/// A roof of degree one: the valley's and the ridge's crease has the foot, on neither piece inside.
#[test]
fn creases_and_corners_are_not_overlooked() {
    let k = KnotVector::clamped_uniform(1, 3).unwrap();
    let line = KnotVector::clamped_uniform(1, 2).unwrap();
    let net = [0.0, 1.0, 0.0]
        .iter()
        .zip([0.0, 1.0, 2.0])
        .flat_map(|(&z, x)| [Vec3::of(x, 0.0, z), Vec3::of(x, 1.0, z)]);
    let roof = BSplineSurface::new(k.clone(), line, net.collect(), None).unwrap();
    let p = Vec3::of(1.1, 0.5, 2.0);
    let ridge = (0.1f64 * 0.1 + 1.0).sqrt();
    let found = NearestSurface::new(&roof).nearest(&roof, p);
    assert!((found.distance - ridge).abs() < 1e-14, "{found:?}");
    assert_eq!(found.at[0], 0.5);
    let single = nearest_on_surface(&roof, p, None);
    assert!((single.at[0] - 0.5).abs() < 1e-12, "{single:?}");
    let bent = BSplineCurve::new(
        k,
        vec![Vec3::of(0.0, 0.0, 0.0), Vec3::of(1.0, 0.0, 1.0), Vec3::of(2.0, 0.0, 0.0)],
        None,
    )
    .unwrap();
    let corner = Vec3::of(1.05, 0.0, 1.5);
    let found = NearestCurve::new(&bent).nearest(&bent, corner);
    assert!((found.distance - (0.05f64 * 0.05 + 0.25).sqrt()).abs() < 1e-14, "{found:?}");
    assert_eq!(found.at[0], nearest_on_curve(&bent, corner, None).at[0]);
}

#[test]
fn ties_edges_and_degenerate_shapes_have_their_status() {
    let s = bumpy(6, 2);
    let prepared = NearestSurface::new(&s);
    let beside = prepared.nearest(&s, Vec3::of(-3.0, 1.0, 0.5));
    assert_eq!((beside.status, beside.at[0]), (LocateStatus::EdgeClamped, 0.0));
    // A point above the middle plane of a valley: two feet.
    let k = KnotVector::clamped_uniform(2, 3).unwrap();
    let line = KnotVector::clamped_uniform(1, 2).unwrap();
    let net = [(-1.0, 1.0), (0.0, -1.0), (1.0, 1.0)]
        .iter()
        .flat_map(|&(x, z)| [Vec3::of(x, 0.0, z), Vec3::of(x, 1.0, z)]);
    let valley = BSplineSurface::new(k, line, net.collect(), None).unwrap();
    let found = NearestSurface::new(&valley).nearest(&valley, Vec3::of(0.0, 0.5, 3.0));
    assert!(matches!(found.status, LocateStatus::Multiple { count: 2, .. }), "{found:?}");
    assert!(found.at[0] < 0.5);
    // A surface that is one point, and one that is a line.
    let at = Vec3::of(1.0, 2.0, 3.0);
    let k = KnotVector::clamped_uniform(1, 2).unwrap();
    let point = BSplineSurface::new(k.clone(), k.clone(), vec![at; 4], None).unwrap();
    let found = NearestSurface::new(&point).nearest(&point, Vec3::zero());
    assert!((found.distance - at.norm()).abs() < 1e-15, "{found:?}");
    let ends = [Vec3::zero(), Vec3::zero(), at, at];
    let thin = BSplineSurface::new(k.clone(), k, ends.to_vec(), None).unwrap();
    let found = NearestSurface::new(&thin).nearest(&thin, at * 0.25);
    assert!(found.distance < 1e-12, "{found:?}");
}

#[test]
fn curves_agree_with_a_dense_search() {
    let mut random = Random::new(12);
    let points = (0..9).map(|i| Vec3::of(f64::from(i), random.unit(), random.unit())).collect();
    let c = BSplineCurve::uniform(3, points).unwrap();
    let prepared = NearestCurve::new(&c);
    for _ in 0..300 {
        let p = Vec3::of(
            random.between(-1.0, 9.0),
            random.between(-1.0, 2.0),
            random.between(-1.0, 2.0),
        );
        let found = prepared.nearest(&c, p);
        let n = 20_000;
        let dense = (0..=n).map(|k| c.jet(f64::from(k) / f64::from(n), Order::Zero)[0].distance(p));
        let dense = dense.fold(f64::INFINITY, f64::min);
        assert!(found.distance < dense + 1e-9 && dense < found.distance + 1e-3, "{p:?} {found:?}");
    }
    let lost = prepared.nearest(&c, Vec3::of(0.0, f64::NAN, 0.0));
    assert_eq!(lost.status, LocateStatus::Diverged);
}

#[test]
fn the_single_search_agrees_with_the_batch() {
    let s = bumpy(8, 5);
    let prepared = NearestSurface::new(&s);
    let mut random = Random::new(21);
    for _ in 0..100 {
        let p = Vec3::of(
            random.between(-1.0, 5.0),
            random.between(-1.0, 5.0),
            random.between(-2.0, 3.0),
        );
        let found = prepared.nearest(&s, p);
        let single = nearest_on_surface(&s, p, None);
        let x = s.jet(single.at[0], single.at[1], Order::Zero).p;
        assert!((x.distance(p) - found.distance).abs() < 1e-12, "{p:?} {found:?} {single:?}");
    }
    let (d, _) = brute(&s, Vec3::of(1.0, 1.0, 2.0), 100);
    assert!((prepared.nearest(&s, Vec3::of(1.0, 1.0, 2.0)).distance - d).abs() < 1e-9);
}

#[test]
fn the_order_by_place_has_every_point_once() {
    let mut random = Random::new(31);
    let mut points: Vec<Vec3> =
        (0..500).map(|_| Vec3::of(random.unit(), random.unit(), random.unit())).collect();
    points[7].x = f64::NAN;
    let mut order = by_place(&points);
    let step = |pair: &[u32]| points[pair[0] as usize].distance(points[pair[1] as usize]);
    let steps = order.windows(2).map(step).filter(|d| d.is_finite());
    assert!(steps.sum::<f64>() / 499.0 < 0.25, "neighbours are near each other");
    order.sort_unstable();
    assert!(order.into_iter().eq(0..500));
    assert!(by_place(&[]).is_empty());
}

/// A roof with its ridge from (0, 2, 1) to (4, 2, 1), which is at another v for each u, so that no joint
/// tells of it.
struct Roof;

impl SurfaceFormula for Roof {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        let ridge = u * 0.2 + 0.4;
        let x = u * 4.0;
        if v.re() < ridge.re() {
            let share = v / ridge;
            Vec3::new(x, share * 2.0, share)
        } else {
            let share = (v - ridge) / (-ridge + 1.0);
            Vec3::new(x, share * 2.0 + 2.0, -share + 1.0)
        }
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
}

#[test]
fn above_a_crease_there_is_one_foot() {
    let prepared = NearestSurface::new(&Roof);
    let mut random = Random::new(5);
    for _ in 0..25 {
        let p =
            Vec3::of(random.between(0.5, 3.5), random.between(1.9, 2.1), random.between(1.3, 2.0));
        let exact = Vec3::of(p.x, 2.0, 1.0);
        let found = prepared.nearest(&Roof, p);
        assert!(
            found.xyz.distance(exact) < 1e-11 && found.status == LocateStatus::Ok,
            "{p:?} {found:?}"
        );
        for start in [None, Some([exact.x / 4.0, 0.4 + 0.05 * exact.x])] {
            let found = nearest_on_surface(&Roof, p, start);
            let x = Roof.jet(found.at[0], found.at[1], Order::Zero).p;
            assert!(x.distance(exact) < 1e-11, "{p:?} {found:?}");
            assert_eq!(found.report.status, LocateStatus::Ok, "{p:?} {start:?} {found:?}");
        }
    }
}
