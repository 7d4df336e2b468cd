//! Facts of shapes: breaks and kinks against jumps found by bisection; facts and batches forwarded
//! by images.

use crate::common::{run, scene};
use moldloft_num::{Curve, Dual, Order, Pace, Rational, SurfJet, Surface, Vec3};
use moldloft_registry::{Class, Context, Given, Scalar, SurfaceRef, Value, bind_arguments};
use moldloft_testing::soak;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// So near to 0 and 1 derivatives may have no bound.
const MARGIN: f64 = 1e-5;

/// A change of a derivative within this interval of the parameter, relative to its size, is a jump.
const WIDTH: f64 = 1e-11;
const JUMP: f64 = 1e-5;

/// Accuracy of a break that was found.
const FOUND: f64 = 1e-8;

/// Jumps of a function, by bisection of equal cells; changes small relative to `least` are
/// rounding.
fn jumps(f: impl Fn(f64) -> Vec3, least: f64, cells: usize) -> Vec<f64> {
    // No break of an example is at a multiple of this.
    let at = |k: usize| MARGIN + (1.0 - 2.0 * MARGIN) * k as f64 / (cells as f64 + 1e-3);
    let values: Vec<Vec3> = (0..=cells).map(|k| f(at(k))).collect();
    let size = values.iter().fold(least, |size, v| size.max(v.norm()));
    let mut found = Vec::new();
    for k in 0..cells {
        let (mut low, mut high) = ((at(k), values[k]), (at(k + 1), values[k + 1]));
        while high.0 - low.0 > WIDTH && low.1.distance(high.1) > JUMP * size {
            let middle = 0.5 * (low.0 + high.0);
            let middle = (middle, f(middle));
            if middle.1.distance(low.1) > middle.1.distance(high.1) {
                high = middle;
            } else {
                low = middle;
            }
        }
        if low.1.distance(high.1) > JUMP * size {
            found.push(0.5 * (low.0 + high.0));
        }
    }
    found
}

/// The jumps that are not among the stated ones.
fn unstated(found: Vec<f64>, stated: &[f64]) -> Vec<f64> {
    found.into_iter().filter(|t| !stated.iter().any(|s| (s - t).abs() <= FOUND)).collect()
}

#[test]
fn derivatives_of_examples_jump_at_stated_breaks_alone() {
    let cells = if soak() { 97 } else { 5 };
    let (mut wrong, mut curves, mut surfaces) = (Vec::new(), 0, 0);
    // Those that sweep a point need a model.
    for row in moldloft_relational::rows().into_iter().filter(|row| row.sweep.is_none()) {
        let scene = scene(&row.example);
        for object in scene.0.iter().filter(|o| o.row.name == row.name) {
            let mut report =
                |what: String| wrong.push(format!("{} {}: {what}", row.name, object.name));
            match &object.value {
                Value::Curve(curve) => {
                    curves += 1;
                    let speed = curve.jet(0.37, Order::First)[1].norm();
                    for (order, stated) in [(1, curve.kinks()), (2, curve.breaks())] {
                        let f = |t: f64| curve.jet(t, Order::Second)[order];
                        for t in unstated(jumps(f, speed, cells), &stated) {
                            report(format!("derivative {order} jumps at {t}"));
                        }
                    }
                }
                Value::Surface(surface) => {
                    surfaces += 1;
                    let (kinks, breaks) = (surface.kinks(), surface.breaks());
                    for w in [0.23, 0.71] {
                        let by_u = |u: f64| surface.jet(u, w, Order::Second);
                        let by_v = |v: f64| surface.jet(w, v, Order::Second);
                        let middle = by_u(0.37);
                        let least = middle.u.norm().max(middle.v.norm());
                        let found = [
                            ("S_u", jumps(|u| by_u(u).u, least, cells), &kinks[0]),
                            ("S_v", jumps(|v| by_v(v).v, least, cells), &kinks[1]),
                            ("S_uu", jumps(|u| by_u(u).uu, least, cells), &breaks[0]),
                            ("S_vv", jumps(|v| by_v(v).vv, least, cells), &breaks[1]),
                        ];
                        for (which, found, stated) in found {
                            for t in unstated(found, stated) {
                                report(format!("{which} jumps at {t} beside {w}"));
                            }
                        }
                    }
                }
                _ => {}
            }
        }
    }
    println!("{curves} curves, {surfaces} surfaces");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A surface that counts how it is evaluated, and states facts of every kind.
struct Counted {
    jets: Arc<AtomicUsize>,
    batches: Arc<AtomicUsize>,
}

impl Counted {
    fn at(u: f64, v: f64) -> SurfJet<f64> {
        SurfJet {
            p: Vec3::new(u + 0.2 * v * v, v + 1.0, 1.0 + u * u * 0.5),
            u: Vec3::new(1.0, 0.0, u),
            v: Vec3::new(0.4 * v, 1.0, 0.0),
            uu: Vec3::new(0.0, 0.0, 1.0),
            uv: Vec3::zero(),
            vv: Vec3::new(0.4, 0.0, 0.0),
        }
    }
}

impl Surface<f64> for Counted {
    fn jet(&self, u: f64, v: f64, _: Order) -> SurfJet<f64> {
        self.jets.fetch_add(1, Ordering::Relaxed);
        Self::at(u, v)
    }
    fn grid(&self, us: &[f64], vs: &[f64], points: &mut [Vec3], normals: Option<&mut [Vec3]>) {
        self.batches.fetch_add(us.len() * vs.len(), Ordering::Relaxed);
        let places = us.iter().flat_map(|u| vs.iter().map(move |v| Self::at(*u, *v)));
        let jets: Vec<SurfJet<f64>> = places.collect();
        for (p, jet) in points.iter_mut().zip(&jets) {
            *p = jet.p;
        }
        for (n, jet) in normals.into_iter().flatten().zip(&jets) {
            *n = jet.normal();
        }
    }
    fn line(&self, u: f64, vs: &[f64], _: Order) -> Vec<SurfJet<f64>> {
        self.batches.fetch_add(vs.len(), Ordering::Relaxed);
        vs.iter().map(|v| Self::at(u, *v)).collect()
    }
    fn scattered(&self, uv: &[[f64; 2]], out: &mut [Vec3]) {
        self.batches.fetch_add(uv.len(), Ordering::Relaxed);
        for (p, [u, v]) in out.iter_mut().zip(uv) {
            *p = Self::at(*u, *v).p;
        }
    }
    fn breaks(&self) -> [Vec<f64>; 2] {
        [vec![0.25, 0.5], vec![0.125, 0.75]]
    }
    fn joints(&self) -> [Vec<f64>; 2] {
        [vec![0.25, 0.375, 0.5], vec![0.125, 0.625, 0.75]]
    }
    fn kinks(&self) -> [Vec<f64>; 2] {
        [vec![0.5], vec![0.75]]
    }
    fn crossings(&self, path: &dyn Fn(f64) -> [f64; 2], _: &[f64]) -> Vec<f64> {
        vec![0.5 * (path(0.25)[0] + path(0.5)[1])]
    }
    fn rational(&self) -> Rational<2> {
        Rational::paced([Pace::Angle(1.0), Pace::Even])
    }
    fn closed(&self) -> [bool; 2] {
        [false; 2]
    }
}

/// Images of a surface, and their further arguments.
const IMAGES: [(&str, &str, bool); 6] = [
    ("MirrSurf", "\"y=0\"", true),
    ("RotatSurf", "axis, 0.7", true),
    ("CopySurf", "A, B, 2, -0.5, 1", true),
    ("ProjSurf", "\"z=0\"", true),
    // A bilinear displacement changes the rational form.
    ("RelSurf", "P, Q, R, S", false),
    ("RelSurf", "B, Q, R, A", false),
];

/// Shapes that images take besides the surface.
const BESIDE: &str = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 3); Line axis(A, B); AbsPoint P(0, 1, 0); \
                      AbsPoint Q(1, 1, 0.5); AbsPoint R(1.5, 2.5, 0.5); AbsPoint S(0, 2, 2);";

/// The image of a surface.
fn image(name: &str, base: &SurfaceRef<f64>, rest: &str) -> SurfaceRef<f64> {
    let scene = scene(BESIDE);
    let one = |text: &str| match text.parse() {
        Ok(x) => Value::Number(x),
        Err(_) if text.starts_with('"') => Value::text(text.trim_matches('"')),
        Err(_) => scene.value(text).clone(),
    };
    let mut positional = vec![Value::Surface(base.clone())];
    positional.extend(rest.split(", ").map(one));
    let row = moldloft_relational::rows().into_iter().find(|row| row.name == name).unwrap();
    let given = Given { positional, named: Vec::new() };
    let (args, _) = bind_arguments(&row, given, |_| Class::Any).unwrap();
    match f64::call(&row, &args, &Context::default()) {
        Ok(Value::Surface(image)) => image,
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn images_hand_on_facts_and_batches() {
    let ts = [0.0, 0.1, 0.4, 0.55, 0.9, 1.0];
    let uv: Vec<[f64; 2]> = ts.iter().flat_map(|u| ts.iter().map(move |v| [*u, *v])).collect();
    for (name, rest, rational) in IMAGES {
        let (jets, batches) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicUsize::new(0)));
        let base = Counted { jets: jets.clone(), batches: batches.clone() };
        let base = SurfaceRef::new(base, 0);
        let image = image(name, &base, rest);
        assert_eq!(image.breaks(), base.breaks(), "{name}");
        assert_eq!(image.joints(), base.joints(), "{name}");
        assert_eq!(image.kinks(), base.kinks(), "{name}");
        assert_eq!(image.closed(), base.closed(), "{name}");
        let path = |t: f64| [t * t, 0.3 + 0.4 * t];
        assert_eq!(
            image.crossings(&path, &[0.0, 1.0]),
            base.crossings(&path, &[0.0, 1.0]),
            "{name}"
        );
        assert_eq!(image.rational().paces == base.rational().paces, rational, "{name}");

        // Batches equal single points, and cost as much as a batch of the base.
        let single: Vec<Vec3> = uv.iter().map(|[u, v]| image.jet(*u, *v, Order::Zero).p).collect();
        let lines: Vec<Vec<SurfJet<f64>>> = ts
            .iter()
            .map(|u| ts.iter().map(|v| image.jet(*u, *v, Order::Second)).collect())
            .collect();
        jets.store(0, Ordering::Relaxed);
        batches.store(0, Ordering::Relaxed);
        let mut out = vec![Vec3::zero(); uv.len()];
        image.scattered(&uv, &mut out);
        assert_eq!(out, single, "{name}");
        let mut normals = out.clone();
        image.grid(&ts, &ts, &mut out, None);
        assert_eq!(out, single, "{name}");
        let all: Vec<_> = ts.iter().map(|u| image.line(*u, &ts, Order::Second)).collect();
        assert_eq!(all, lines, "{name}");
        image.grid(&ts, &ts, &mut out, Some(&mut normals));
        assert_eq!(out, single, "{name}");
        for (n, jet) in normals.iter().zip(lines.iter().flatten()) {
            assert!(n.distance(jet.normal()) <= 1e-14, "{name}");
        }
        assert_eq!(jets.load(Ordering::Relaxed), 0, "{name}");
        assert_eq!(batches.load(Ordering::Relaxed), 4 * uv.len(), "{name}");
    }
}

/// Lofts through five curves, and the masters at which their pieces end.
const LOFTS: [(&str, &str, &[usize]); 6] = [
    ("s", "CLoftSurf s({a, b, c, d, e});", &[0, 2, 4]),
    ("n", "CLoftSurf n({a, b, c, d, e}, ends = \"natural\");", &[0, 1, 2, 3, 4]),
    ("t", "CLoftSurf t({a, b, c, d, e}, degree = 1);", &[0, 1, 2, 3, 4]),
    ("x", "XLoftSurf x(1, {a, b, c, d, e});", &[0, 2, 4]),
    ("m", "CLoftSurf o({a, b, c, d, e}); MirrSurf m(o, \"y=0\");", &[0, 2, 4]),
    // One cubic, and one parabola.
    ("r", "CLoftSurf r({a, b, c, d}); CLoftSurf p({a, b, c}, ends = \"bessel\");", &[]),
];

fn lofts() -> String {
    let lofts: String = LOFTS.iter().map(|(_, text, _)| *text).collect();
    format!(
        "AbsPoint A(0, 0, 2); AbsPoint B(1, 0, -1); AbsPoint C(4, 2, 2); AbsPoint D(4, 1.5, -1); \
         AbsPoint E(4, 0, -1.5); AbsPoint F(8, 1.5, 2); AbsPoint G(8, 0, -0.5); AbsPoint H(9, 1, 2); \
         AbsPoint I(9.5, 0, 0); AbsPoint J(10, 1, 2); AbsPoint K(10.5, 0, 1); Line a(A, B); \
         BCurve b({{C, D, E}}); Line c(F, G); Line d(H, I); Line e(J, K); {lofts}"
    )
}

#[test]
fn pieces_of_lofts_are_between_their_masters() {
    let scene = scene(&lofts());
    let surface = |name: &str| scene.surface(name);
    let master =
        |at: usize, u: f64| scene.curve(["a", "b", "c", "d", "e"][at]).jet(u, Order::Zero)[0];
    let (us, shares) = ([0.0, 0.3, 1.0], [0.0, 0.25, 1.0]);
    assert!(surface("p").between_joints(&us, &shares).is_none());
    for (name, _, ends) in LOFTS {
        let points = surface(name).between_joints(&us, &shares);
        assert_eq!(points.is_none(), ends.is_empty(), "{name}");
        let Some(points) = points else { continue };
        assert_eq!(points.len(), us.len() * (ends.len() - 1) * shares.len(), "{name}");
        let columns = points.chunks((ends.len() - 1) * shares.len());
        for (column, &u) in columns.zip(&us) {
            for (piece, ends) in column.chunks(shares.len()).zip(ends.windows(2)) {
                let [from, to] = [ends[0], ends[1]].map(|at| {
                    let p = master(at, u);
                    if name == "m" { Vec3::new(p.x, -p.y, p.z) } else { p }
                });
                assert!(piece[0].distance(from) < 1e-13 && piece[2].distance(to) < 1e-13, "{name}");
                if name == "t" {
                    assert!(piece[1].distance(from + (to - from) * 0.25) < 1e-13);
                }
                if name == "x" {
                    // x is linear in v.
                    let (first, last) = (master(0, u).x, master(4, u).x);
                    let v = (piece[1].x - first) / (last - first);
                    let on = surface(name).jet(u, v, Order::Zero).p;
                    assert!(piece[1].distance(on) < 1e-13);
                }
            }
        }
    }
}

#[test]
fn pieces_of_lofts_move_with_their_joints() {
    let (us, shares) = ([0.3, 0.8], [0.0, 0.25, 0.9]);
    // Of the coordinates; options follow.
    let scale = |k: usize| if k < 33 { f64::from(k as u32 * 37 % 11) - 5.0 } else { 0.0 };
    let moved = |h: f64| run::<f64>(&lofts(), &mut |k, x| x + h * scale(k)).unwrap();
    let seeded = |k: usize, x: f64| Dual::<4> { re: x, eps: [scale(k), 0.0, 0.0, 0.0] };
    let dual = run::<Dual<4>>(&lofts(), &mut |k, x| seeded(k, x)).unwrap();
    let h = 1e-5;
    let (before, after) = (moved(-h), moved(h));
    for (name, ..) in LOFTS.iter().filter(|(.., ends)| !ends.is_empty()) {
        let points = dual.surface(name).between_joints(&us, &shares).unwrap();
        let beside = [&before, &after].map(|s| s.surface(name).between_joints(&us, &shares));
        let [before, after] = beside.map(Option::unwrap);
        for (p, (a, b)) in points.iter().zip(before.iter().zip(&after)) {
            let exact = (*b - *a) * (0.5 / h);
            let found = p.map(|x| x.eps[0]);
            assert!(found.distance(exact) < 1e-7 * exact.norm(), "{name}: {found:?} {exact:?}");
        }
    }
}
