//! Surfaces with common edges: continuity across these, and refusals.

use crate::fixtures::*;
use moldloft_fair::{
    Bound, EndContinuity, FairError, Limit, Measure, NetEdge, Network, PatchNet, Seam, Space, rows,
};
use moldloft_num::{Dual4, Order, Real, Surface, Vec3};
use moldloft_registry::{
    CallError, Class, Context, Given, Registry, Scalar, Value, Vectors, bind_arguments,
};
use std::sync::Arc;

/// A bent hull side, cut at `cut` along u: the nets of both parts, with noise of up to `noise`.
fn halves(noise: f64) -> [Vec<Vec3<f64>>; 2] {
    let mut random = Lcg::new(5);
    let all: Vec<Vec<Vec3<f64>>> = (0..16)
        .map(|i| {
            (0..8)
                .map(|j| {
                    // Evenly spaced before the cut at row 9, wider after it.
                    let x = if i <= 9 { f64::from(i) } else { 9.0 + 1.5 * f64::from(i - 9) } / 9.0
                        - 1.0;
                    let z = f64::from(j) / 7.0;
                    let y = (1.2 - x * x) * (0.3 + z - 0.4 * z * z);
                    Vec3::of(x, y + noise * random.centred(), z)
                })
                .collect()
        })
        .collect();
    [all[..10].concat(), all[9..].concat()]
}

fn spaces(counts: [usize; 2]) -> [Space; 2] {
    counts.map(|n| Space::clamped(3, n).unwrap())
}

fn sheets(noise: f64, tolerance: f64) -> Vec<PatchNet> {
    let [a, b] = halves(noise);
    let of = |points: Vec<Vec3<f64>>, m: usize| {
        let limit = Limit::ball(points.len(), tolerance).unwrap();
        PatchNet::new(spaces([m, 8]), points, limit)
    };
    vec![of(a, 10), of(b, 7)]
}

/// Bending of a surface across the seam: the second fundamental form and the metric, at one point.
fn forms(s: &dyn Surface<f64>, u: f64, v: f64) -> (Vec3<f64>, [f64; 3]) {
    let j = s.jet(u, v, Order::Second);
    let n = j.u.cross(j.v).normalized().unwrap();
    // In an orthonormal frame with its first axis along the seam, which both sides share.
    let e1 = j.v.normalized().unwrap();
    let e2 = n.cross(e1);
    let (a, b) = (j.u.dot(e1), j.u.dot(e2));
    let c = j.v.norm();
    // u = a e1 + b e2, v = c e1.
    let (uu, uv, vv) = (j.uu.dot(n), j.uv.dot(n), j.vv.dot(n));
    let k11 = vv / (c * c);
    let k12 = (uv / c - a * k11) / b;
    let k22 = (uu - a * a * k11 - 2.0 * a * b * k12) / (b * b);
    (n, [k11, k12, k22])
}

#[test]
fn tangents_and_curvature_run_on_across_a_seam() {
    let sheets = sheets(4e-3, 2e-2);
    for (keeps, planes, bends) in [
        (EndContinuity::Position, false, false),
        (EndContinuity::Tangent, true, false),
        (EndContinuity::Curvature, true, true),
    ] {
        let seams = Seam::found(&sheets, keeps);
        assert_eq!(seams.len(), 1);
        let wanted = [NetEdge { direction: 0, end: 1 }, NetEdge { direction: 0, end: 0 }];
        assert_eq!((seams[0].edges, seams[0].reversed), (wanted, false));
        let network = Network::joined(&sheets, &seams).unwrap();
        assert_eq!(network.points.len(), 80 + 56 - 8);
        let best = network.optimum(Measure::Third, Bound::ControlPoints, vec![], 1e-9).unwrap();
        assert!(best.certificate.relative() < 1e-6);
        let moved = best.points.iter().zip(&network.points).map(|(p, q)| p.distance(*q));
        assert!(moved.fold(0.0, f64::max) <= 2e-2);
        let surface = |k: usize| {
            let net = Network::net(
                sheets[k].spaces.clone(),
                sheets[k].points.clone(),
                None,
                sheets[k].limit.clone(),
            );
            net.unwrap().surface(&network.sheet(k, &best.points)).unwrap()
        };
        let (fore, aft) = (surface(0), surface(1));
        let (mut turn, mut bend) = (0.0f64, 0.0f64);
        for k in 0..=20 {
            let v = f64::from(k) / 20.0;
            assert!(
                fore.jet(1.0, v, Order::Zero).p.distance(aft.jet(0.0, v, Order::Zero).p) < 1e-14
            );
            let ((n, a), (m, b)) = (forms(&fore, 1.0, v), forms(&aft, 0.0, v));
            turn = turn.max(n.distance(m));
            bend = bend.max((0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max));
        }
        assert_eq!(turn < 1e-8, planes, "{keeps:?} {turn:e}");
        assert_eq!(bend < 1e-6, bends, "{keeps:?} {bend:e}");
        // The corners off the seam stay to the bit, those on it may move.
        for i in [0, 7] {
            assert!(best.points[i].bits_eq(network.points[i]));
        }
        assert!(network.certified(&best.points) <= 2e-2 + 1e-12);
        assert!(network.sampled(&best.points) <= network.certified(&best.points));
        let bezier = network.optimum(Measure::Third, Bound::Bezier, vec![], 1e-9).unwrap();
        assert!(bezier.certificate.value < best.certificate.value);
        assert!(network.certified(&bezier.points) <= 2e-2 + 1e-12);
        assert_eq!(network.passes(1, 1).is_ok(), keeps == EndContinuity::Position);
    }
}

/// The seam may be any edge, in either direction; a third sheet joins the second.
#[test]
fn seams_are_found_wherever_they_are() {
    let straight = sheets(4e-3, 2e-2);
    let value = |sheets: &[PatchNet]| {
        let seams = Seam::found(sheets, EndContinuity::Curvature);
        let network = Network::joined(sheets, &seams).unwrap();
        let best = network.optimum(Measure::Second, Bound::ControlPoints, vec![], 1e-11).unwrap();
        (seams, best.certificate.value)
    };
    let (_, wanted) = value(&straight);
    // The second sheet in other orientations: v along the hull backwards, u upwards or downwards.
    for down in [false, true] {
        let mut turned = straight.clone();
        let [nu, nv] = [7, 8];
        let points = &straight[1].points;
        turned[1].points = (0..nv)
            .flat_map(|j| (0..nu).map(move |i| (nu - 1 - i, if down { nv - 1 - j } else { j })))
            .map(|(i, j)| points[i * nv + j])
            .collect();
        turned[1].spaces.reverse();
        let (seams, got) = value(&turned);
        assert_eq!(seams[0].edges[1], NetEdge { direction: 1, end: 1 });
        assert_eq!(seams[0].reversed, down);
        assert!((got / wanted - 1.0).abs() < 1e-8, "{got} {wanted}");
    }
    let mut three = straight.clone();
    let far: Vec<Vec3<f64>> = straight[0]
        .points
        .iter()
        .map(|p| Vec3::of(2.0 * straight[1].points[48].x - p.x - 1.0 + 0.0, p.y, p.z))
        .collect();
    three.push(PatchNet { points: far, ..straight[0].clone() });
    // Its first row is not the last of the second: nothing to join there.
    assert_eq!(Seam::found(&three, EndContinuity::Curvature).len(), 1);
}

#[test]
fn what_cannot_be_joined_is_refused() {
    let sheets = sheets(4e-3, 2e-2);
    let seam = Seam::found(&sheets, EndContinuity::Curvature)[0];
    let said = |sheets: &[PatchNet], seam: Seam| match Network::joined(sheets, &[seam]) {
        Err(FairError::Seam { number: 0, why }) => why,
        other => panic!("{other:?}"),
    };
    assert!(said(&sheets, Seam { sheets: [0, 2], ..seam }).contains("no surface 3"));
    let wrong = Seam { edges: [NetEdge { direction: 0, end: 0 }, seam.edges[1]], ..seam };
    assert!(said(&sheets, wrong).contains("apart"));
    let across = Seam { edges: [NetEdge { direction: 1, end: 0 }, seam.edges[1]], ..seam };
    assert!(said(&sheets, across).contains("10 control points, the other 8"));
    let mut low = sheets.clone();
    low[1].spaces[1] = Space::clamped(4, 8).unwrap();
    assert!(said(&low, seam).contains("degree or knots"));
    let mut rational = sheets.clone();
    rational[0].weights = Some(vec![1.0; 80]);
    assert!(said(&rational, seam).contains("rational"));
    assert!(Network::joined(&rational, &[Seam { keeps: EndContinuity::Position, ..seam }]).is_ok());
    // A sheet that folds back over the other.
    let mut back = sheets.clone();
    let points = &sheets[0].points;
    back[1] = sheets[0].clone();
    back[1].points =
        (0..10).flat_map(|i| (0..8).map(move |j| (9 - i) * 8 + j)).map(|k| points[k]).collect();
    back[1].points.iter_mut().skip(8).for_each(|p| p.y += 0.1);
    assert_eq!(Network::joined(&back, &[seam]).unwrap_err(), FairError::TurnsBack);
    // A knuckle that no tolerance of that size takes away.
    let mut bent = self::sheets(0.0, 1e-3);
    bent[1].points.iter_mut().skip(8).for_each(|p| p.y += 0.5 * (p.x - 0.0));
    let network = Network::joined(&bent, &[seam]).unwrap();
    let refused = network.optimum(Measure::Second, Bound::ControlPoints, vec![], 1e-9);
    assert!(matches!(refused, Err(FairError::Contradiction { .. })), "{refused:?}");
}

fn call<T: Scalar>(
    grids: [Vec<Vec3<T>>; 2],
    tolerance: T,
    named: Vec<(&str, Value<T>)>,
) -> Result<Value<T>, CallError> {
    let registry = Registry::new(rows());
    let row = registry.get("FairPatches").unwrap();
    let grid =
        |points: Vec<Vec3<T>>| Value::Vectors(Arc::new(Vectors::grid(points.len() / 8, 8, points)));
    let positional = vec![Value::list(grids.map(grid)), Value::Number(tolerance)];
    let (args, _) = bind_arguments(row, Given { positional, named }, |_| Class::Any)?;
    T::call(row, &args, &Context::default())
}

fn place<T: Scalar>(value: &Value<T>, k: usize, u: f64, v: f64) -> Vec3<T> {
    let Value::List(items) = value else { panic!("{value:?}") };
    let Value::Surface(s) = &items[k] else { panic!() };
    s.jet(T::from(u), T::from(v), Order::Zero).p
}

#[test]
fn patches_have_exact_derivatives() {
    let plain = halves(4e-3);
    let at = |grids: [Vec<Vec3<f64>>; 2], tolerance: f64| {
        place(&call(grids, tolerance, vec![]).unwrap(), 1, 0.13, 0.4)
    };
    // A point of the first surface near the seam, one on it (in both), the tolerance.
    let moved = |k: usize, by: f64| {
        let mut grids = plain.clone();
        match k {
            0 => grids[0][8 * 7 + 3].y += by,
            1 => [0, 1].into_iter().for_each(|s| {
                let i = if s == 0 { 72 + 4 } else { 4 };
                grids[s][i].y += by;
            }),
            _ => return at(grids, 2e-2 + by),
        }
        at(grids, 2e-2)
    };
    let mut dual =
        plain.clone().map(|g| g.into_iter().map(Vec3::lifted).collect::<Vec<Vec3<Dual4>>>());
    let seed = |p: &mut Vec3<Dual4>, k: usize| p.y = Dual4::seeded(p.y.re(), k);
    seed(&mut dual[0][8 * 7 + 3], 0);
    seed(&mut dual[0][76], 1);
    seed(&mut dual[1][4], 1);
    let exact = call(dual, Dual4::seeded(2e-2, 2), vec![]).unwrap();
    let exact = place(&exact, 1, 0.13, 0.4);
    assert!(exact.re().bits_eq(at(plain.clone(), 2e-2)));
    for k in 0..3 {
        let h = 1e-6;
        let difference = (moved(k, h) - moved(k, -h)) * (0.5 / h);
        let got = exact.map(|x| x.eps[k]);
        assert!(
            got.distance(difference) < 1e-5 * (1.0 + difference.norm()),
            "{k} {got:?} {difference:?}"
        );
        assert!(got.norm() > 1e-4, "{k}");
    }
}

#[test]
fn patches_say_what_is_wrong() {
    let fault = |named| call::<f64>(halves(4e-3), 2e-2, named).unwrap_err();
    let wrong = fault(vec![("seams", Value::text("smooth"))]);
    assert_eq!((wrong.id, wrong.field()), ("unknown-name", Some(5)));
    let wrong = fault(vec![("as", Value::text("points"))]);
    assert_eq!((wrong.id, wrong.field()), ("unknown-name", Some(3)));
    let wrong = fault(vec![("degree", Value::Number(7.0))]);
    assert_eq!(wrong.id, "too-few-items");
    let mut bent = halves(0.0);
    bent[1].iter_mut().skip(8).for_each(|p| p.y += 0.5 * p.x);
    let wrong = call::<f64>(bent, 1e-3, vec![]).unwrap_err();
    assert_eq!((wrong.id, wrong.field()), ("contradiction", Some(5)));
    // A tolerance of zero leaves all as it is.
    let still = call::<f64>(halves(4e-3), 0.0, vec![("as", Value::text("control"))]).unwrap();
    assert!(place(&still, 0, 1.0, 0.0).bits_eq(halves(4e-3)[0][72]));
}
