//! Bodies of parts within loops: closed forms, other parts of the same surface, differences.

use crate::{
    Attitude, Body, BodyMeasures, HullSide, TrimCurve, Water, flotation, surface_measures,
};
use moldloft_num::{Curve, CurveJet, Dual, Jet, Order, Real, Surface, SurfaceFormula, Vec3};
use moldloft_testing::{Random, rounds};
use std::f64::consts::PI;
use std::marker::PhantomData;

/// A closed curve in a parameter plane, an ellipse with waves; or a straight stretch.
#[derive(Clone, Copy, Debug)]
enum TrimmingWave<T> {
    Wave { centre: [T; 2], radii: [T; 2], height: T, waves: f64, turn: f64 },
    Straight([T; 2], [T; 2]),
}

impl<T: Real> TrimmingWave<T> {
    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        match *self {
            Self::Wave { centre, radii, height, waves, turn } => {
                let angle = t * (2.0 * PI) + turn;
                let r = (angle * waves).sin().scaled(height) + 1.0;
                let at = |k: usize, x: J| (r * x).scaled(radii[k]) + J::fixed(centre[k]);
                Vec3::new(at(0, angle.cos()), at(1, angle.sin()), J::zero())
            }
            Self::Straight(a, b) => {
                let at = |k: usize| t.scaled(b[k] - a[k]) + J::fixed(a[k]);
                Vec3::new(at(0), at(1), J::zero())
            }
        }
    }
}

impl<T: Real> Curve<T> for TrimmingWave<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        moldloft_num::curve_jet_of!(self, Self::at, t, order)
    }
    moldloft_num::curve_one_by_one!(T);
    moldloft_num::curve_facts!(smooth, open, not_rational);
    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        Some(self.jet(t, order))
    }
}

fn square<T: Real>(low: [f64; 2], high: [f64; 2]) -> [TrimmingWave<T>; 4] {
    let p = [low, [high[0], low[1]], high, [low[0], high[1]]].map(|p| p.map(T::from));
    // Each in a direction of its own.
    [
        TrimmingWave::Straight(p[0], p[1]),
        TrimmingWave::Straight(p[2], p[1]),
        TrimmingWave::Straight(p[2], p[3]),
        TrimmingWave::Straight(p[0], p[3]),
    ]
}

fn chained<'a, T: Real>(square: &'a [TrimmingWave<T>; 4]) -> Vec<TrimCurve<'a, T>> {
    let of = |(k, curve): (usize, &'a TrimmingWave<T>)| TrimCurve { curve, backwards: k % 2 == 1 };
    square.iter().enumerate().map(of).collect()
}

fn ahead(curve: &TrimmingWave<f64>) -> TrimCurve<'_, f64> {
    TrimCurve { curve, backwards: false }
}

fn alone<T: Real>(curve: &TrimmingWave<T>) -> Vec<TrimCurve<'_, T>> {
    vec![TrimCurve { curve, backwards: false }]
}

fn wave(random: &mut Random, centre: [f64; 2], most: f64) -> TrimmingWave<f64> {
    TrimmingWave::Wave {
        centre,
        radii: [random.between(0.3 * most, most), random.between(0.3 * most, most)],
        height: random.between(0.0, 0.25),
        waves: random.below(6) as f64,
        turn: random.between(0.0, 6.0),
    }
}

fn moved<T: Real>(wave: TrimmingWave<f64>, by: T) -> TrimmingWave<T> {
    let TrimmingWave::Wave { centre, radii, height, waves, turn } = wave else { unreachable!() };
    TrimmingWave::Wave {
        centre: [by * 0.3 + centre[0], by * -0.2 + centre[1]],
        radii: [by + radii[0], by * 0.5 + radii[1]],
        height: by * 0.1 + height,
        waves,
        turn,
    }
}

/// The unit ball turned about an axis, between the angles 0 and pi, and a whole turn.
struct TiltedBall {
    tilt: f64,
}

impl SurfaceFormula for TiltedBall {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        let (a, b) = (u * PI, v * (2.0 * PI));
        let (x, y, z) = (a.sin() * b.cos(), a.sin() * b.sin(), -a.cos());
        let (c, s) = (self.tilt.cos(), self.tilt.sin());
        Vec3::new(x, y * c - z * s, y * s + z * c)
    }
    moldloft_num::surface_facts!(smooth, open, not_rational);
}

fn side<'a, T: Real>(
    surface: &'a dyn Surface<T>,
    loops: &'a [Vec<TrimCurve<'a, T>>],
    reversed: bool,
) -> HullSide<'a, T> {
    HullSide { surface, reversed, open_edges: [false; 4], loops: Some(loops) }
}

const WATER: Water =
    Water { density: 1.0, gravity: 1.0, symmetry: crate::Symmetry::None, centimetre: 0.01 };

#[test]
fn a_ball_of_two_faces_at_any_level() {
    let mut random = Random::new(71);
    for round in 0..rounds(12, 400) {
        let ball = TiltedBall { tilt: random.between(-3.0, 3.0) };
        let frame = square([0.0; 2], [1.0; 2]);
        let centre = [random.between(0.35, 0.65), random.between(0.35, 0.65)];
        let rim = wave(&mut random, centre, 0.25);
        let [inner, outer] = [vec![alone(&rim)], vec![chained(&frame), alone(&rim)]];
        let sides = [side(&ball, &inner, true), side(&ball, &outer, true)];
        let body = Body::new(&sides, [], Vec::new(), 3.0, 1e-8).unwrap();
        for _ in 0..3 {
            let h = random.between(0.05, 1.95);
            let at = Attitude {
                level: h - 1.0,
                trim: random.between(-1.0, 1.0),
                heel: random.between(-1.0, 1.0),
            };
            let found = flotation(&body, WATER, at, None);
            let exact = [PI * h * h * (3.0 - h) / 3.0, 2.0 * PI * h, PI * h * (2.0 - h)];
            let plane = found.earth.waterplane.unwrap();
            let all = [found.earth.volume, found.earth.wetted_area, plane.area];
            for (k, error) in [0, 2, 3].into_iter().enumerate() {
                let off = (all[k] - exact[k]).abs();
                assert!(off <= found.errors[error] + 1e-10, "{round}: {k} {off} {found:?}");
                assert!(off <= 1e-7 * exact[k], "{round}: {k} {off} of {}", exact[k]);
                assert!(found.errors[error] <= 1e-6, "{round}: {k} {:?}", found.errors);
            }
        }
    }
}

/// A plane, and a roof over it with its ridge at u = 0.5, of the given slope.
struct CreasedRoof(f64);

impl SurfaceFormula for CreasedRoof {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        Vec3::new(u, v, Real::abs(u - 0.5) * -self.0)
    }
    fn breaks(&self) -> [Vec<f64>; 2] {
        [vec![0.5], Vec::new()]
    }
    moldloft_num::surface_facts!(joints_at_breaks, kinks_at_breaks, breaks_along_lines);
    moldloft_num::surface_facts!(open, not_rational);
}

#[test]
fn parts_across_a_ridge() {
    let mut random = Random::new(5);
    for round in 0..rounds(20, 1000) {
        let roof = CreasedRoof(random.between(0.0, 3.0));
        let (a, b) = (random.between(0.05, 0.45), random.between(0.05, 0.45));
        let centre = [random.between(a, 1.0 - a), random.between(b, 1.0 - b)];
        let part = TrimmingWave::Wave {
            centre,
            radii: [a, b],
            height: 0.0,
            waves: 1.0,
            turn: random.between(0.0, 6.0),
        };
        let holes = [0.2, -0.2].map(|x| TrimmingWave::Wave {
            centre: [centre[0] + 2.0 * x * a, centre[1]],
            radii: [0.3 * a, 0.5 * b],
            height: 0.0,
            waves: 0.0,
            turn: 1.0,
        });
        let loops = vec![alone(&part), alone(&holes[0]), alone(&holes[1])];
        let body = Body::new(&[side(&roof, &loops, false)], [], Vec::new(), 1.0, 1e-8).unwrap();
        let found = body.measures();
        let exact = PI * a * b * 0.7 * (1.0 + roof.0 * roof.0).sqrt();
        let off = (found.area - exact).abs();
        assert!(off <= found.bounds[0] + 1e-12, "{round}: {off} {found:?} {exact}");
        assert!(off <= 1e-8 * exact, "{round}: {off} of {exact}");
        let low = body.lowest(Vec3::of(1.0, 0.0, 0.0)).unwrap();
        assert!((low - (centre[0] - a)).abs() < 1e-9, "{round}: {low}");
        let low = body.lowest(Vec3::of(0.0, -1.0, 0.0)).unwrap();
        assert!((low + centre[1] + b).abs() < 1e-9, "{round}: {low}");
    }
}

/// A bent sheet.
struct BentSheet<T>(PhantomData<T>);

impl<T: Real> SurfaceFormula for BentSheet<T> {
    type Scalar = T;
    fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        Vec3::new(u, v, u * u * 0.3 + (v * 3.0).sin() * 0.2)
    }
    moldloft_num::surface_facts!(smooth, open, not_rational);
}

fn sheet_within<T: Real>(rim: TrimmingWave<T>) -> BodyMeasures<T> {
    let (sheet, loops) = (BentSheet(PhantomData), vec![alone(&rim)]);
    let body = Body::new(&[side(&sheet, &loops, false)], [], Vec::new(), 1.0, 1e-9);
    body.unwrap().measures()
}

#[test]
fn derivatives_of_moving_rims() {
    let mut random = Random::new(9);
    for round in 0..rounds(6, 100) {
        let rim = wave(&mut random, [0.5, 0.5], 0.3);
        let found = sheet_within(moved(rim, Dual::<1> { re: 0.0, eps: [1.0] }));
        let at = |x: f64| sheet_within(moved(rim, x));
        let by = |of: &dyn Fn(f64) -> f64| moldloft_testing::ridders(of, 0.0, 0.01);
        let slopes = [by(&|x| at(x).area), by(&|x| at(x).area_centre.z)];
        for (a, b) in [found.area.eps[0], found.area_centre.z.eps[0]].into_iter().zip(slopes) {
            assert!((a - b).abs() < 1e-6 * (1.0 + b.abs()), "{round}: {a} {b}");
        }
    }
}

#[test]
fn a_part_to_the_border_is_the_surface() {
    let ball = TiltedBall { tilt: 0.4 };
    let frame = square([0.0; 2], [1.0; 2]);
    let loops = vec![chained(&frame)];
    let body = Body::new(&[side(&ball, &loops, true)], [], Vec::new(), 3.0, 1e-8).unwrap();
    let (part, whole) = (body.measures(), surface_measures(&ball, 1e-8).unwrap());
    assert!((part.area - whole.area).abs() < 1e-8);
    assert!((part.volume + whole.volume).abs() < 1e-8);
    // A loop that is not closed bounds no part.
    let [a, b, ..] = &frame;
    let open = [vec![ahead(a), ahead(b)]];
    assert!(Body::new(&[side(&ball, &open, true)], [], Vec::new(), 3.0, 1e-8).is_none());
}

/// A tube of radius 1 about the z axis, of height 2, which is closed along u.
struct ClosedTube;

impl SurfaceFormula for ClosedTube {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        let a = u * (2.0 * PI);
        Vec3::new(a.cos(), a.sin(), v * 2.0)
    }
    moldloft_num::surface_facts!(smooth, not_rational);
    fn closed(&self) -> [bool; 2] {
        [true, false]
    }
}

#[test]
fn a_part_across_the_seam() {
    let hole = TrimmingWave::Wave {
        centre: [1.0, 0.5],
        radii: [0.1, 0.2],
        height: 0.0,
        waves: 0.0,
        turn: 0.3,
    };
    let loops = vec![alone(&hole)];
    let body = Body::new(&[side(&ClosedTube, &loops, false)], [], Vec::new(), 3.0, 1e-9).unwrap();
    let found = body.measures();
    let exact = PI * 0.1 * 0.2 * (2.0 * PI * 2.0);
    assert!((found.area - exact).abs() < 1e-9 * exact, "{found:?}");
    // The chord's excess: x = cos(2 pi u) over an ellipse.
    let reach = 2.0 * PI * 0.1;
    let mean =
        2.0 * moldloft_num::gauss_rule(19).iter().fold(0.0, |sum, &(s, weight)| {
            let x = 2.0 * s - 1.0;
            sum + weight * (reach * x).cos() * (1.0 - x * x).sqrt()
        }) * 2.0
            / PI;
    assert!((found.area_centre.x - mean).abs() < 1e-4, "{} {mean}", found.area_centre.x);
    let low = body.lowest(Vec3::of(0.0, 1.0, 0.0)).unwrap();
    assert!((low + reach.sin()).abs() < 1e-9);
}
