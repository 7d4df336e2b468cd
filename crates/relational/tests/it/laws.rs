//! Laws that every row of this crate obeys, tried on its own example: a new kind without docs, help
//! or example fails here, and so does one whose derivatives, grid or edges are wrong.

use crate::common::{Scene, run, scene};
use moldloft_num::trace::{Edge, Key, Named, Piece, Root, Trace};
use moldloft_num::{Dual4, Order, Real, Vec3};
use moldloft_registry::{Class, Row, Scalar, SurfaceRef, Value};
use moldloft_testing::ridders;

fn rows() -> Vec<Row> {
    // Those that sweep a point need a model: they have their tests in `lang`.
    moldloft_relational::rows().into_iter().filter(|row| row.sweep.is_none()).collect()
}

/// The objects of the row's kind in its own example.
fn own<'s, T: Scalar>(row: &Row, scene: &'s Scene<T>) -> Vec<&'s Value<T>> {
    scene.0.iter().filter(|o| o.row.name == row.name).map(|o| &o.value).collect()
}

/// Parameters away from the breaks of the examples, and the ends.
const TS: [f64; 6] = [0.0, 0.13, 0.41, 0.58, 0.87, 1.0];
const INNER: [f64; 3] = [0.13, 0.41, 0.87];

#[test]
fn every_row_is_documented_and_shows_itself() {
    for row in rows() {
        let name = &row.name;
        assert!(row.summary().len() > 20, "{name} says too little of itself");
        for field in row.fields.iter() {
            assert!(field.help.ends_with('.'), "{name}.{} needs a sentence", field.name);
        }
        assert!(!own(&row, &scene(&row.example)).is_empty(), "the example of {name} has none");
        let capital = name.starts_with(char::is_uppercase);
        assert_eq!(capital, row.kind, "{name}: kinds are capitalised, functions are not");
        if let Some(columns) = row.columns {
            for column in columns.split_whitespace().filter(|c| *c != "relabel") {
                assert!(row.field(column).is_some(), "{name} has no field for {column}");
            }
        }
        assert_eq!(row.kind, row.columns.is_some(), "{name}: kinds say their columns");
    }
}

#[test]
fn names_are_unique() {
    moldloft_registry::Registry::new(rows());
}

fn close(what: &str, exact: Vec3, by: impl Fn(f64) -> Vec3, accuracy: f64) {
    for axis in 0..3 {
        let centred = ridders(|h| by(h)[axis], 0.0, 0.02);
        let size = exact.norm().max(1.0);
        let d = (exact[axis] - centred).abs();
        assert!(d <= accuracy * size, "{what}, axis {axis}: {} and {centred}", exact[axis]);
    }
}

#[test]
fn jets_equal_central_differences() {
    for row in rows() {
        let scene = scene(&row.example);
        for value in own(&row, &scene) {
            let name = &row.name;
            match value {
                Value::Curve(c) => {
                    for t in INNER {
                        let [_, d, dd] = c.jet(t, Order::Second);
                        close(name, d, |h| c.jet(t + h, Order::Zero)[0], 1e-8);
                        close(name, dd, |h| c.jet(t + h, Order::First)[1], 1e-7);
                        if let Some([_, d, dd]) = c.on_surface(t, Order::Second) {
                            let at = |t, order| c.on_surface(t, order).unwrap();
                            close(name, d, |h| at(t + h, Order::Zero)[0], 1e-8);
                            close(name, dd, |h| at(t + h, Order::First)[1], 1e-7);
                        }
                    }
                }
                Value::Surface(s) => {
                    for (u, v) in INNER.iter().flat_map(|&u| INNER.map(|v| (u, v))) {
                        let jet = s.jet(u, v, Order::Second);
                        let at = |u, v| s.jet(u, v, Order::First);
                        close(name, jet.u, |h| at(u + h, v).p, 1e-8);
                        close(name, jet.v, |h| at(u, v + h).p, 1e-8);
                        close(name, jet.uu, |h| at(u + h, v).u, 1e-7);
                        close(name, jet.uv, |h| at(u, v + h).u, 1e-7);
                        close(name, jet.vv, |h| at(u, v + h).v, 1e-7);
                    }
                }
                Value::Relabel(r) => {
                    let at = |t: f64| Vec3::from(r.jet(t, Order::Second));
                    assert_eq!((at(0.0).x, at(1.0).x), (0.0, 1.0), "{name}");
                    for t in INNER {
                        let exact = Vec3::of(at(t).y, at(t).z, 0.0);
                        let both = |h: f64| Vec3::of(at(t + h).x, at(t + h).y, 0.0);
                        close(name, exact, both, 1e-7);
                        assert!(exact.x > 0.0, "{name} stands still at {t}");
                    }
                }
                Value::Solid(s) => {
                    for (u, v, w) in [(0.13, 0.41, 0.87), (0.41, 0.87, 0.13), (0.87, 0.87, 0.41)] {
                        let jet = s.jet(u, v, w);
                        assert!(jet.p.distance(s.eval(u, v, w)) < 1e-13, "{name}");
                        close(name, jet.u, |h| s.eval(u + h, v, w), 1e-8);
                        close(name, jet.v, |h| s.eval(u, v + h, w), 1e-8);
                        close(name, jet.w, |h| s.eval(u, v, w + h), 1e-8);
                    }
                }
                Value::Field(f) => {
                    let p = Vec3::of(0.3, -1.2, 0.8);
                    let (value, gradient) = f.value_and_gradient(p);
                    assert_eq!(value, f.value(p));
                    for axis in 0..3 {
                        let along = |h: f64| {
                            let mut q = p.to_array();
                            q[axis] += h;
                            f.value(q.into())
                        };
                        assert!(
                            (gradient[axis] - ridders(along, 0.0, 0.02)).abs() < 1e-9,
                            "{name}"
                        );
                    }
                }
                _ => {}
            }
        }
    }
}

/// Numbers that characterise a value.
fn samples<T: Scalar>(value: &Value<T>) -> Vec<T> {
    let points: Vec<Vec3<T>> = match value {
        Value::Point(p) => {
            let mut all = vec![p.xyz];
            all.extend(p.on_curve.as_ref().map(|place| Vec3::new(place.1, T::zero(), T::zero())));
            all.extend(p.on_surface.as_ref().map(|w| Vec3::new(w.1[0], w.1[1], T::zero())));
            all
        }
        Value::Curve(c) => TS.iter().flat_map(|&t| c.jet(T::from(t), Order::Second)).collect(),
        Value::Surface(s) => {
            let mut points = vec![Vec3::zero(); TS.len() * TS.len()];
            let mut normals = points.clone();
            s.grid(&TS, &TS, &mut points, Some(&mut normals));
            points.extend(normals);
            let jet = s.jet(T::from(0.3), T::from(0.8), Order::Second);
            points.extend([jet.p, jet.u, jet.v, jet.uu, jet.uv, jet.vv]);
            points
        }
        Value::Solid(s) => {
            let mut points = vec![Vec3::zero(); TS.len() * 9];
            s.grid(&TS, &[0.0, 0.3, 1.0], &[0.0, 0.7, 1.0], &mut points);
            let jet = s.jet(T::from(0.3), T::from(0.8), T::from(0.6));
            points.extend([jet.p, jet.u, jet.v, jet.w]);
            points
        }
        Value::Plane(p) => vec![p.point, p.normal],
        Value::Relabel(r) => {
            let jet = |t: &f64| r.jet(T::from(*t), Order::Second);
            let outside = [-0.2, 1.3];
            TS.iter().chain(&outside).map(|t| Vec3::from(jet(t))).collect()
        }
        Value::Frame(f) => vec![f.origin, f.axes[0], f.axes[1], f.axes[2]],
        Value::Vectors(a) => a.points(),
        Value::Field(f) => {
            let (value, gradient) = f.value_and_gradient(Vec3::of(0.5, -1.0, 0.25));
            vec![gradient, Vec3::new(value, T::zero(), T::zero())]
        }
        Value::Numbers(a) => return a.items.clone(),
        Value::List(items) => return items.iter().flat_map(samples).collect(),
        Value::Contours(c) => {
            // Distance of a point from each section.
            let p = Vec3::of(0.3, -1.2, 0.8);
            return c.values.iter().map(|&value| c.family.height(value, p)).collect();
        }
        Value::Number(x) => return vec![*x],
        // Vertices of the rim: the number of inner ones may vary. Vertices spaced by curvature
        // slide along it, so that those at given parameters are compared, and the measures of the
        // surface itself.
        Value::Body(m) => match &m.border {
            Some(border) => {
                let even = (0..=5).map(|k| T::from(f64::from(k) / 5.0)).collect::<Vec<_>>();
                let at = vec![even; border.0.curves().len()];
                let (body, _) = border.0.divided(&at).expect("an example that can be divided");
                let measures = border.0.measures().expect("an example with measures");
                let mut points: Vec<Vec3<T>> = body.points.iter().take(8).copied().collect();
                points.push(measures.centroid);
                points.push(Vec3::new(measures.area, measures.volume, T::zero()));
                points
            }
            None => m.points.iter().take(8).copied().collect(),
        },
        other => panic!("no samples of {other:?}"),
    };
    points.into_iter().flat_map(Vec3::to_array).collect()
}

fn own_samples<T: Scalar>(row: &Row, scene: &Scene<T>) -> Vec<T> {
    own(row, scene).into_iter().flat_map(samples).collect()
}

/// Every literal of an example that can vary continuously is followed by dual numbers and by
/// central differences.
#[test]
fn derivatives_by_every_number_equal_central_differences() {
    for row in rows() {
        let name = &row.name;
        let mut count = 0;
        run::<f64>(&row.example, &mut |k, x| {
            count = k + 1;
            x
        })
        .unwrap();
        let plain = own_samples(&row, &scene(&row.example));
        let mut tried = 0;
        for first in (0..count).step_by(4) {
            let dual = run(&row.example, &mut |k, x| match k.checked_sub(first) {
                Some(direction @ 0..4) => Dual4::seeded(x, direction),
                _ => Dual4::from(x),
            });
            let dual = own_samples(&row, &dual.unwrap());
            for (a, b) in plain.iter().zip(&dual) {
                assert_eq!(a.to_bits(), b.re.to_bits(), "{name}: the real part differs");
            }
            for literal in first..(first + 4).min(count) {
                let moved = |h: f64| {
                    let scene = run(&row.example, &mut |k, x| if k == literal { x + h } else { x });
                    Some(own_samples(&row, &scene.ok()?))
                };
                // Degrees, types and counts cannot vary.
                let step = 0.01;
                if moved(step).is_none() || moved(-step).is_none() {
                    continue;
                }
                tried += 1;
                let direction = literal - first;
                let size = dual.iter().fold(1.0f64, |m, x| m.max(x.eps[direction].abs()));
                let mut ladder = std::collections::HashMap::new();
                for (at, x) in dual.iter().enumerate() {
                    let along =
                        |h: f64| ladder.entry(h.to_bits()).or_insert_with(|| moved(h).unwrap())[at];
                    let centred = ridders(along, 0.0, step);
                    let d = (x.eps[direction] - centred).abs();
                    assert!(
                        d <= 2e-7 * size,
                        "{name}, literal {literal}, sample {at}: {} and {centred}",
                        x.eps[direction]
                    );
                }
            }
        }
        let varies = row.fields.iter().any(|f| f.class != Class::Integer);
        assert!(!varies || tried > 0, "no number of {name} was tried");
    }
}

fn grid_equals_jets<T: Real>(name: &str, surface: &SurfaceRef<T>, accuracy: f64) {
    let us = [0.0, 0.37, 0.37, 0.2, 1.0, -0.1];
    // More than one chunk, a jump back, and parameters outside [0, 1].
    let mut vs: Vec<f64> = (0..=70).map(|j| f64::from(j) / 70.0).collect();
    vs.extend([0.25, 0.9, 0.1, 1.2, -0.2]);
    let mut points = vec![Vec3::zero(); us.len() * vs.len()];
    let (mut normals, mut only) = (points.clone(), points.clone());
    surface.grid(&us, &vs, &mut points, Some(&mut normals));
    surface.grid(&us, &vs, &mut only, None);
    for (i, &u) in us.iter().enumerate() {
        for (j, &v) in vs.iter().enumerate() {
            let k = i * vs.len() + j;
            let jet = surface.jet(T::from(u), T::from(v), Order::First);
            let near = |a: Vec3<T>, b: Vec3<T>| {
                (0..3).all(|axis| {
                    let (a, b) = (a[axis], b[axis]);
                    (0..T::PARTS).all(|p| {
                        let size = 1.0 + a.part(p).abs() + jet.u.re().norm() + jet.v.re().norm();
                        (a.part(p) - b.part(p)).abs() <= accuracy * size
                    })
                })
            };
            assert!(near(jet.p, points[k]), "{name} at {u}, {v}: {:?} {:?}", jet.p, points[k]);
            assert!(near(jet.p, only[k]), "{name} at {u}, {v}, points only");
            // If a surface is nearly singular its normal is dominated by rounding.
            let area = jet.u.re().cross(jet.v.re()).norm();
            if area > 1e-3 {
                assert!(
                    near(jet.normal(), normals[k]),
                    "{name} at {u}, {v}: {:?} {:?}",
                    jet.normal(),
                    normals[k]
                );
            }
        }
    }
}

#[test]
fn grids_equal_jets() {
    for row in rows().into_iter().filter(|r| r.class == Class::Surface) {
        for value in own(&row, &scene(&row.example)) {
            let Value::Surface(s) = value else { unreachable!() };
            grid_equals_jets(&row.name, s, 1e-13);
        }
        let dual = run(&row.example, &mut |k, x| Dual4::seeded(x, k % 4)).unwrap();
        for value in own(&row, &dual) {
            let Value::Surface(s) = value else { unreachable!() };
            grid_equals_jets(&row.name, s, 1e-12);
        }
    }
    let hull = scene(crate::common::HULL);
    grid_equals_jets("hull", hull.surface("hull"), 1e-13);
}

#[test]
fn curve_grids_equal_jets() {
    for row in rows() {
        for value in own(&row, &scene(&row.example)) {
            let Value::Curve(c) = value else { continue };
            let mut out = [Vec3::zero(); TS.len()];
            c.grid(&TS, &mut out);
            for (t, p) in TS.into_iter().zip(out) {
                assert!(p.distance(c.jet(t, Order::Zero)[0]) < 1e-13, "{} at {t}", row.name);
            }
        }
    }
}

/// The position that a chain of pieces has at its own parameter `t`.
fn on_pieces(scene: &Scene<f64>, pieces: &[Piece<f64>], t: f64) -> Vec3 {
    let mut begin = 0.0;
    let at = pieces.iter().position(|p| t <= p.until).expect("the last piece ends at 1");
    if at > 0 {
        begin = pieces[at - 1].until;
    }
    let piece = &pieces[at];
    let share = (t - begin) / (piece.until - begin);
    let t = piece.from.t + (piece.to.t - piece.from.t) * share;
    on_root(scene, piece.root, t)
}

fn on_root(scene: &Scene<f64>, root: Root, t: f64) -> Vec3 {
    let value = |key: Key| &scene.0[key.0 as usize].value;
    match root {
        Root::Curve(key) => match value(key) {
            Value::Curve(c) => c.jet(t, Order::Zero)[0],
            other => panic!("the root is {other:?}"),
        },
        Root::Edge(key, k) => match value(key) {
            Value::Surface(s) => boundary(s, k as usize, t),
            other => panic!("the root is {other:?}"),
        },
        Root::Segment(a, b) => {
            let [a, b] = [a, b].map(|key| place(scene, key));
            a * (1.0 - t) + b * t
        }
        Root::Governed(a, b, law) => {
            let [a, b] = [a, b].map(|key| place(scene, key));
            let Value::Relabel(law) = value(law) else { panic!("no law") };
            let t = law.jet(t, Order::Zero)[0];
            a * (1.0 - t) + b * t
        }
    }
}

fn boundary(s: &SurfaceRef<f64>, k: usize, t: f64) -> Vec3 {
    let (u, v) = [(t, 0.0), (1.0, t), (t, 1.0), (0.0, t)][k];
    s.jet(u, v, Order::Zero).p
}

fn is_at(scene: &Scene<f64>, key: Option<Key>, p: Vec3, what: &str) {
    if let Some(key) = key {
        assert!(p.distance(place(scene, key)) < 1e-13, "{what}: the point is elsewhere");
    }
}

/// Position of a point: an object, a corner of a surface or an end of a curve.
fn place(scene: &Scene<f64>, key: Key) -> Vec3 {
    let value = |key: Key| &scene.0[key.0 as usize].value;
    match key.named() {
        Named::Corner(surface, k) => match value(surface) {
            Value::Surface(s) => boundary(s, [0, 0, 1, 3][k], [0.0, 1.0, 1.0, 1.0][k]),
            other => panic!("a corner of {other:?}"),
        },
        Named::End(curve, k) => match value(curve) {
            Value::Curve(c) => c.end(k as f64),
            other => panic!("an end of {other:?}"),
        },
        Named::Joint(curve, k) => match value(curve) {
            Value::Curve(c) => c.end(c.joints()[k]),
            other => panic!("a joint of {other:?}"),
        },
        _ => match value(key) {
            Value::Point(p) => p.xyz,
            other => panic!("the point is {other:?}"),
        },
    }
}

#[test]
fn curves_run_where_they_say() {
    for row in rows() {
        let scene = scene(&row.example);
        for value in own(&row, &scene) {
            let Value::Curve(c) = value else { continue };
            let name = &row.name;
            let [from, to] = c.end_points();
            is_at(&scene, from, c.end(0.0), name);
            is_at(&scene, to, c.end(1.0), name);
            let pieces = c.pieces();
            for t in TS {
                let p = c.jet(t, Order::Zero)[0];
                assert!(p.distance(on_pieces(&scene, &pieces, t)) < 1e-13, "{name} at {t}");
            }
            if let Some(surface) = &c.surface {
                let w = c.on_surface(0.3, Order::Zero).unwrap()[0];
                let p = surface.jet(w.x, w.y, Order::Zero).p;
                assert!(p.distance(c.jet(0.3, Order::Zero)[0]) < 1e-13, "{name} on its surface");
            }
        }
    }
}

#[test]
fn edges_run_along_the_boundary() {
    let more = [
        crate::common::HULL,
        // A full turn with a pole at each end.
        "AbsPoint O(0, 0, 0); AbsPoint X(3, 0, 0); Line axis(O, X); AbsPoint M(1, 2, 0);
         BCurve c({O, M, X}, degree = 2); RevSurf egg(c, axis);",
        // All masters begin in one point.
        "AbsPoint O(0, 0, 0); AbsPoint A(3, 0, 0); AbsPoint B(3, 2, 0); AbsPoint C(2, 3, 1);
         Line a(O, A); Line b(O, B); Line c(O, C); CLoftSurf fan({a, b, c}); RuledSurf r(a, c);",
        // Snakes along edges, and parts of them as masters.
        "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3);
         AbsPoint E(0, 4, 0); AbsPoint F(4, 5, 0); Line l(A, B); Line m(C, D); RuledSurf S(l, m);
         EdgeSnake e(4, S); AbsRing p(e, 0.25); AbsRing q(e, 0.75); SubSnake s(q, p); Line n(E, F);
         RuledSurf T(s, n); UVSnake g(S, \"v\", 1); RuledSurf V(g, n);",
    ];
    let examples = rows().into_iter().filter(|r| r.class == Class::Surface);
    let texts = examples.map(|r| r.example.into_owned()).chain(more.map(String::from));
    for text in texts {
        let scene = scene(&text);
        for object in &scene.0 {
            let Value::Surface(s) = &object.value else { continue };
            let name = format!("{} {}", object.row.name, object.name);
            let edges = s.edges();
            for (k, edge) in edges.edges.iter().enumerate() {
                for t in TS {
                    let p = boundary(s, k, t);
                    match edge {
                        Edge::Own => {}
                        Edge::Pieces(pieces) => {
                            let q = on_pieces(&scene, pieces, t);
                            assert!(p.distance(q) < 1e-13, "{name}, edge {k} at {t}");
                        }
                        Edge::SameAs(other) => {
                            let q = boundary(s, *other as usize, t);
                            assert!(p.distance(q) < 1e-13, "{name}, edge {k} at {t}");
                        }
                        Edge::Pole(point) => {
                            assert!(p.distance(boundary(s, k, 0.0)) < 1e-13, "{name}, pole {k}");
                            is_at(&scene, *point, p, &name);
                        }
                    }
                }
            }
            for (corner, (u, v)) in
                edges.corners.into_iter().zip([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
            {
                is_at(&scene, corner, s.jet(u, v, Order::Zero).p, &name);
            }
        }
    }
}

#[test]
fn joins_are_told_by_identity() {
    let scene = scene(
        "AbsPoint O(0, 0, 0); AbsPoint X(3, 0, 0); Line axis(O, X); AbsPoint M(1, 2, 0);
         BCurve c({O, M, X}, degree = 2); RevSurf egg(c, axis); EdgeSnake back(3, egg);
         EdgeSnake nose(4, egg); AbsBead a(c, 0.25); AbsBead b(c, 0.5); SubCurve part(b, a);
         AbsBead d(part, 0.5); SubCurve less(a, b);",
    );
    let root = Root::Curve(scene.key("c"));
    let edges = scene.surface("egg").edges();
    assert!(matches!(&edges.edges[0], Edge::Pieces(p) if p[0].root == root));
    assert_eq!(edges.edges[2], Edge::SameAs(0));
    assert_eq!(edges.edges[3], Edge::Pole(Some(scene.key("O"))));
    assert_eq!(edges.corners[1], Some(scene.key("X")));
    assert!(matches!(scene.curve("back").trace(), Trace::Pieces(p) if p[0].root == root));
    assert_eq!(scene.curve("nose").trace(), Trace::Point(Some(scene.key("O"))));
    let Trace::Pieces(part) = scene.curve("part").trace() else { panic!("an alias") };
    assert_eq!((part[0].root, part[0].from.t, part[0].to.t), (root, 0.5, 0.25));
    assert_eq!(part[0].from.point, Some(scene.key("b")));
}
