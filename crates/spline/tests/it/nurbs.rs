//! Shapes as NURBS: exact ones come back, fits keep their bounds.

use moldloft_num::{Curve, CurveFormula, Jet, Order, Surface, SurfaceFormula, Vec3};
use moldloft_spline::nurbs::{FitOptions, NotFitted, Nurbs, of_curve, of_surface};
use moldloft_spline::{BSplineCurve, BSplineSurface, CircularArc, KnotVector};
use moldloft_testing::Random as Rng;

fn point(rng: &mut Rng) -> Vec3 {
    Vec3::of(rng.between(-2.0, 2.0), rng.between(-1.0, 1.0), rng.between(0.0, 3.0))
}

/// Random clamped knots, some of them repeated.
fn knots(rng: &mut Rng, degree: usize) -> KnotVector {
    let mut inner = Vec::new();
    for _ in 0..rng.below(5) {
        let knot = rng.between(0.05, 0.95);
        for _ in 0..1 + rng.below(degree) {
            inner.push(knot);
        }
    }
    inner.sort_by(f64::total_cmp);
    let mut all = vec![0.0; degree + 1];
    all.extend(inner);
    all.extend(vec![1.0; degree + 1]);
    KnotVector::new(degree, all).unwrap()
}

fn weights(rng: &mut Rng, n: usize) -> Option<Vec<f64>> {
    (rng.below(2) == 0).then(|| (0..n).map(|_| rng.between(0.4, 2.0)).collect())
}

/// The largest distance from a curve at many parameters.
fn off_curve(curve: &dyn Curve<f64>, nurbs: &Nurbs<1>) -> f64 {
    let s: Vec<f64> = (0..=997).map(|k| f64::from(k) / 997.0).collect();
    let made = nurbs.grid(std::array::from_ref(&s));
    let truth = s.iter().map(|&s| curve.jet(nurbs.paces[0].parameter(s), Order::Zero)[0]);
    truth.zip(made).map(|(a, b)| a.distance(b)).fold(0.0, f64::max)
}

fn off_surface(surface: &dyn Surface<f64>, nurbs: &Nurbs<2>) -> f64 {
    let s: Vec<f64> = (0..=83).map(|k| f64::from(k) / 83.0).collect();
    let made = nurbs.grid(&[s.clone(), s.clone()]);
    let [u, v] = nurbs.paces;
    let truth = s.iter().flat_map(|&a| s.iter().map(move |&b| (a, b)));
    let truth = truth.map(|(a, b)| surface.jet(u.parameter(a), v.parameter(b), Order::Zero).p);
    truth.zip(made).map(|(a, b)| a.distance(b)).fold(0.0, f64::max)
}

#[test]
fn splines_come_back_with_their_own_control_points() {
    let mut rng = Rng::new(7);
    for _ in 0..120 {
        let degree = 1 + rng.below(7);
        let knots = knots(&mut rng, degree);
        let n = knots.points();
        let points: Vec<Vec3> = (0..n).map(|_| point(&mut rng)).collect();
        let weights = weights(&mut rng, n);
        let curve = BSplineCurve::new(knots.clone(), points.clone(), weights.clone()).unwrap();
        let made = of_curve(&curve, &FitOptions::within(1e-6)).unwrap();
        assert!(made.exact && made.error < 1e-10, "{knots:?} {}", made.error);
        let off = off_curve(&curve, &made);
        assert!(off <= made.error, "{off:e} {:e}", made.error);
        // A random knot is recovered, without others.
        assert_eq!(made.degrees, [degree]);
        let gap = |a: &f64, b: &f64| (a - b).abs();
        assert!(made.knots[0].iter().zip(knots.as_slice()).all(|(a, b)| gap(a, b) < 1e-15));
        assert!(made.points.iter().zip(&points).all(|(a, b)| a.distance(*b) < 1e-9));
        let ratio = weights.as_ref().map_or(1.0, |w| w[0]);
        let made_weights = made.weights.clone().unwrap_or_else(|| vec![1.0; n]);
        for (k, w) in made_weights.iter().enumerate() {
            let truth = weights.as_ref().map_or(1.0, |w| w[k]) / ratio;
            assert!((w / made_weights[0] - truth).abs() < 1e-10);
        }
    }
}

#[test]
fn surfaces_come_back_too() {
    let mut rng = Rng::new(11);
    for _ in 0..25 {
        let degrees = [1 + rng.below(4), 1 + rng.below(4)];
        let [u, v] = degrees.map(|d| knots(&mut rng, d));
        let n = u.points() * v.points();
        let points: Vec<Vec3> = (0..n).map(|_| point(&mut rng)).collect();
        let weights = weights(&mut rng, n);
        let surface = BSplineSurface::new(u.clone(), v.clone(), points, weights).unwrap();
        let made = of_surface(&surface, &FitOptions::within(1e-6)).unwrap();
        assert!(made.exact);
        assert_eq!(made.counts(), [u.points(), v.points()]);
        let off = off_surface(&surface, &made);
        assert!(off <= made.error && made.error < 1e-10, "{off:e} {:e}", made.error);
        for k in 0..4 {
            let edge = made.edge(k);
            let t = 0.3;
            let at = [[t, 0.0], [1.0, t], [t, 1.0], [0.0, t]][k];
            assert!(edge.at([t]).distance(made.at(at)) < 1e-12);
        }
    }
}

#[test]
fn arcs_are_rational_quadratics() {
    let [a, b] = [Vec3::of(1.0, 0.0, 0.5), Vec3::of(0.0, 1.0, 0.5)];
    let centre = Vec3::of(0.0, 0.0, 0.5);
    let arcs = [
        (CircularArc::circle(a, centre, b).unwrap(), 9),
        (CircularArc::about(a, centre, b).unwrap(), 3),
        (CircularArc::through(a, b, Vec3::of(-0.6, -0.8, 0.5)).unwrap(), 7),
        (CircularArc::through(a, (a + b) * 0.5, b).unwrap(), 2),
    ];
    for (arc, count) in arcs {
        let made = of_curve(&arc, &FitOptions::within(1e-6)).unwrap();
        assert!(made.exact && made.counts() == [count], "{made:?}");
        assert!(off_curve(&arc, &made) < 1e-14 * 8.0);
    }
}

#[test]
fn parts_and_reversals_are_the_same_curve() {
    let mut rng = Rng::new(3);
    for _ in 0..40 {
        let degree = 1 + rng.below(5);
        let knots = knots(&mut rng, degree);
        let n = knots.points();
        let points = (0..n).map(|_| point(&mut rng)).collect();
        let curve = BSplineCurve::new(knots, points, weights(&mut rng, n)).unwrap();
        let whole = of_curve(&curve, &FitOptions::within(1e-6)).unwrap();
        let (a, b) = (rng.between(0.0, 0.4), rng.between(0.5, 1.0));
        for (a, b) in [(a, b), (0.0, b), (a, 1.0), (0.0, 1.0)] {
            let part = whole.part(a, b);
            assert_eq!(part.knots[0].len(), part.points.len() + degree + 1);
            for t in [0.0, 0.21, 0.5, 0.83, 1.0] {
                let truth = curve.jet(a + (b - a) * t, Order::Zero)[0];
                assert!(part.at([t]).distance(truth) < 1e-11);
                assert!(part.reversed().at([1.0 - t]).distance(truth) < 1e-11);
            }
        }
    }
}

/// A helix whose rise has a kink of its second derivative in the middle.
struct Bent;

impl CurveFormula for Bent {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, t: J) -> Vec3<J> {
        let late = t + (-0.5);
        let bend = if late.re() > 0.0 { late * late } else { J::fixed(0.0) };
        Vec3::new((t * 5.0).cos(), (t * 5.0).sin(), t + bend)
    }
    fn breaks(&self) -> Vec<f64> {
        vec![0.5]
    }

    moldloft_num::curve_facts!(broken, open, not_rational);
}

struct Wave;

impl SurfaceFormula for Wave {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        Vec3::new(u * 4.0, v * 2.0, (u * 3.0).sin() * (v * 2.0 + 0.3).cos() * (u * v).exp())
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
}

#[test]
fn fits_keep_their_bounds() {
    for accuracy in [1e-2, 1e-4, 1e-6, 1e-8] {
        let options = FitOptions::within(accuracy);
        let made = of_curve(&Bent, &options).unwrap();
        assert!(!made.exact && made.degrees == [3] && made.error <= accuracy * 1.0001);
        let off = off_curve(&Bent, &made);
        assert!(off <= made.error && off > 1e-3 * made.error, "{off:e} {:e}", made.error);
        if accuracy >= 1e-6 {
            let made = of_surface(&Wave, &options).unwrap();
            let off = off_surface(&Wave, &made);
            assert!(
                off <= made.error && off > 1e-3 * made.error && made.error <= accuracy * 1.0001
            );
            // The error falls with the fourth power of the spans.
            assert!(made.points.len() < 9000, "{:?}", made.counts());
        }
    }
}

#[test]
fn what_cannot_be_fitted_is_an_error_with_its_place() {
    struct Jump;
    impl Curve<f64> for Jump {
        fn jet(&self, t: f64, _: Order) -> [Vec3; 3] {
            [Vec3::of(t, if t < 0.37 { 0.0 } else { 1.0 }, 0.0), Vec3::zero(), Vec3::zero()]
        }

        moldloft_num::curve_facts!(smooth, open, not_rational);
        moldloft_num::curve_one_by_one!(f64);
    }
    match of_curve(&Jump, &FitOptions::within(1e-6)) {
        Err(NotFitted::Error { reached, at }) => {
            assert!(reached > 0.1 && (at[0] - 0.37).abs() < 1e-3, "{reached} {at:?}");
        }
        other => panic!("{other:?}"),
    }
    struct Nothing;
    impl Curve<f64> for Nothing {
        fn jet(&self, t: f64, _: Order) -> [Vec3; 3] {
            [Vec3::of(t, f64::NAN, 0.0), Vec3::zero(), Vec3::zero()]
        }

        moldloft_num::curve_facts!(smooth, open, not_rational);
        moldloft_num::curve_one_by_one!(f64);
    }
    assert_eq!(of_curve(&Nothing, &FitOptions::within(1e-6)), Err(NotFitted::NotFinite));
    let line =
        BSplineCurve::<f64>::uniform(1, vec![Vec3::zero(), Vec3::of(1.0, 0.0, 0.0)]).unwrap();
    assert_eq!(of_curve(&line, &FitOptions::within(0.0)), Err(NotFitted::Accuracy(0.0)));
}
