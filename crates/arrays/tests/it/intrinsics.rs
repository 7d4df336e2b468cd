//! Reductions, moves, shapes, curvatures, meetings and grids of the language.

use crate::common::*;
use moldloft_num::Vec3;
use moldloft_registry::{Array, Scalar, Value};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

fn vector(x: f64, y: f64, z: f64) -> Value<f64> {
    Value::Vector(Vec3::of(x, y, z))
}

fn one(name: &str, args: &[Value<f64>]) -> f64 {
    numbers(&ok(name, args))[0]
}

#[test]
fn reductions() {
    let a = farray(&[3.0, 1.0, 4.0, 1.0, 4.0]);
    let call = |name: &str| one(name, std::slice::from_ref(&a));
    assert_eq!([call("prod"), call("argmin"), call("argmax")], [48.0, 2.0, 3.0]);
    assert_eq!(one("dot", &[a.clone(), a.clone()]), 43.0);
    close(call("norm"), 43f64.sqrt(), 1e-15);
    let c = curve(&[[0.0; 3], [3.0, 4.0, 0.0], [3.0, 4.0, 1.0]]);
    assert_eq!(one("length", std::slice::from_ref(&c)), 6.0);
    assert_eq!(one("len", std::slice::from_ref(&c)), 3.0);
    assert_eq!(
        [one("len", &[text("wing")]), one("len", &[Value::list([number(1.0)])])],
        [4.0, 1.0]
    );
    assert_eq!(numbers(&ok("cumlen", std::slice::from_ref(&c))), [0.0, 5.0, 6.0]);
    assert_eq!(numbers(&ok("bbox_max", std::slice::from_ref(&c))), [3.0, 4.0, 1.0]);
    let l = points(&ok("centroid", &[c]))[0];
    assert!(l.distance(Vec3::of(10.5 / 6.0, 14.0 / 6.0, 0.5 / 6.0)) < 1e-15);
    let s = surface(3, 2, |i, j| [[0.0, 1.0, 3.0][i], j as f64, 0.0]);
    assert!(points(&ok("centroid", &[s]))[0].distance(Vec3::of(1.5, 0.5, 0.0)) < 1e-15);
    assert_eq!(refused("argmin", &[farray(&[])]).0, "empty");
    assert_eq!(refused("dot", &[a.clone(), farray(&[1.0])]), ("shapes-differ", Some(1), None));
    assert_eq!(one("len", &[a]), 5.0);
    assert_eq!(refused("len", &[number(1.0)]).0, "wrong-class");
}

#[test]
fn texts() {
    let said = |name: &str, args: &[&str]| {
        let args: Vec<Value<f64>> = args.iter().map(|word| text(word)).collect();
        ok(name, &args)
    };
    let is = |value: Value<f64>, wanted: &str| assert!(value.same(&text(wanted)), "{value:?}");
    is(ok("cut", &[text("wing.dat"), number(6.0)]), "dat");
    is(ok("cut", &[text("äbc"), number(2.0), number(2.0)]), "b");
    is(ok("cut", &[text("abc"), number(4.0)]), "");
    is(said("replace", &["a-b-c", "-", "+"]), "a+b+c");
    is(said("trim", &["  a b "]), "a b");
    is(said("upper", &["naca"]), "NACA");
    is(said("lower", &["NACA"]), "naca");
    let Value::List(parts) = said("split", &["a,b,,c", ","]) else { panic!() };
    assert_eq!(parts.len(), 4);
    let Value::List(words) = said("split", &["  a  b "]) else { panic!() };
    assert_eq!(words.len(), 2);
    assert_eq!(one("find", &[text("äb.c"), text(".")]), 3.0);
    assert_eq!(one("find", &[text("abc"), text("x")]), 0.0);
    for (word, x) in [("-2.5e3", -2500.0), (" 7 ", 7.0), ("1.5D2", 150.0), (".5", 0.5)] {
        assert_eq!(one("number", &[text(word)]), x);
    }
    for word in ["", "x", "inf", "nan", "1e999", "1 2"] {
        assert_eq!(refused("number", &[text(word)]).0, "not-a-number", "{word}");
    }
    assert_eq!(refused("cut", &[text("abc"), number(5.0)]), ("outside", Some(1), None));
    assert_eq!(refused("replace", &[text("abc"), text(""), text("x")]).0, "empty");
}

#[test]
fn layers_stacked_are_a_block() {
    let s = surface(3, 2, |i, j| [i as f64, j as f64, 0.0]);
    let up = surface(3, 2, |i, j| [i as f64, j as f64, 1.0]);
    let block = ok("stack", &[s.clone(), up]);
    assert!(matches!(&block, Value::Block(layers) if layers.len() == 2));
    assert_eq!(one("folds", std::slice::from_ref(&block)), 0.0);
    let other = surface(2, 2, |i, j| [i as f64, j as f64, 0.0]);
    assert_eq!(refused("stack", &[s, other]), ("shapes-differ", Some(0), Some(1)));
}

#[test]
fn shapes() {
    assert_eq!(numbers(&ok("list", &[1.0, 4.0, 9.0].map(number))), [1.0, 4.0, 9.0]);
    assert_eq!(numbers(&ok("list", &[number(7.0)])), [7.0]);
    assert_eq!(points(&ok("points", &[vector(1.0, 2.0, 3.0)])).len(), 1);
    let c = curve(&[[0.0; 3], [1.0, 0.0, 0.0]]);
    let d = curve(&[[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.5, 2.0, 0.0]]);
    let joined = points(&ok("join", &[c.clone(), d.clone(), c.clone()]));
    assert_eq!(joined.len(), 6);
    assert_eq!(points(&ok("join", std::slice::from_ref(&c))).len(), 2);
    assert_eq!(numbers(&ok("join", &[farray(&[1.0, 2.0]), farray(&[2.0, 3.0])])), [1.0, 2.0, 3.0]);
    let mixed = [farray(&[1.0]), c.clone()];
    assert_eq!(refused("join", &mixed), ("wrong-class", Some(0), Some(1)));
    let s = ok("stack", &[c.clone(), c.clone(), c.clone()]);
    assert_eq!(
        [one("d1", std::slice::from_ref(&s)), one("d2", std::slice::from_ref(&s))],
        [3.0, 2.0]
    );
    assert_eq!(refused("stack", &[c.clone(), d]), ("shapes-differ", Some(0), Some(1)));
    let g = surface(2, 3, |i, j| [i as f64, j as f64, 0.0]);
    let t = ok("swap", std::slice::from_ref(&g));
    assert_eq!(points(&t)[1], Vec3::of(1.0, 0.0, 0.0));
    assert_eq!(points(&ok("swap", &[t])), points(&g));
    let back = ok("reverse", &[g.clone(), number(2.0)]);
    assert_eq!(points(&back)[0], Vec3::of(0.0, 2.0, 0.0));
    assert_eq!(points(&ok("reverse", std::slice::from_ref(&g)))[0], Vec3::of(1.0, 0.0, 0.0));
    assert_eq!(refused("reverse", &[c, number(2.0)]), ("out-of-range", Some(1), None));
    let spread = numbers(&ok("spread_i", &[farray(&[1.0, 2.0]), number(3.0)]));
    assert_eq!(spread, [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    let spread = numbers(&ok("spread_j", &[farray(&[1.0, 2.0]), number(2.0)]));
    assert_eq!(spread, [1.0, 2.0, 1.0, 2.0]);
    assert_eq!(refused("spread_i", &[g, number(2.0)]).0, "wrong-shape");
    assert_eq!(refused("d2", &[farray(&[1.0])]).0, "wrong-shape");
    let million = farray(&[0.0; 1000]);
    assert_eq!(refused("spread_i", &[million, number(1e6)]).0, "too-large");
}

#[test]
fn moves() {
    let x = vector(1.0, 0.0, 0.0);
    let z = vector(0.0, 0.0, 1.0);
    let turned = points(&ok("rotate", &[x.clone(), z.clone(), number(FRAC_PI_2)]))[0];
    assert!(turned.distance(Vec3::of(0.0, 1.0, 0.0)) <= 1e-16);
    let mut p = vector(0.3, -1.2, 0.4);
    let axis = vector(1.0, 2.0, -0.5);
    for _ in 0..360 {
        p = ok("rotate", &[p, vector(0.1, 0.2, 0.3), axis.clone(), number(PI / 180.0)]);
    }
    assert!(points(&p)[0].distance(Vec3::of(0.3, -1.2, 0.4)) < 1e-13);
    let m = points(&ok("mirror", &[p.clone(), vector(0.0, 1.0, 0.0), vector(0.0, 2.0, 0.0)]))[0];
    assert!((m.y - (2.0 + 1.2)).abs() < 1e-13);
    assert_eq!(numbers(&ok("scale", &[vector(1.0, 2.0, 3.0), number(2.0)])), [2.0, 4.0, 6.0]);
    assert_eq!(
        numbers(&ok("scale", &[vector(1.0, 2.0, 3.0), vector(1.0, -1.0, 0.5)])),
        [1.0, -2.0, 1.5]
    );
    assert_eq!(
        refused("rotate", &[x.clone(), vector(0.0, 0.0, 0.0), number(1.0)]),
        ("no-direction", Some(1), None)
    );
    assert_eq!(
        refused("rotate", &[x.clone(), z.clone(), z.clone()]),
        ("missing-argument", Some(3), None)
    );
    assert_eq!(refused("translate", &[number(1.0), z]).0, "wrong-class");
    // Points on the axis stay: a pole.
    let meridian = curve(&[[0.0; 3], [1.0, 1.0, 0.0], [2.0, 0.5, 0.0]]);
    let s = points(&ok("revolve", &[meridian, number(0.0), number(PI), number(7.0)]));
    assert!(s[..7].iter().all(|p| *p == Vec3::zero()));
    assert!(s[7..14].iter().all(|p| (p.y.hypot(p.z) - 1.0).abs() < 1e-15 && p.x == 1.0));
    // Along a helix the frame stays normal, and turns back by the torsion.
    let helix = |t: f64| [t.cos(), t.sin(), 0.5 * t];
    let c: Vec<[f64; 3]> = (0..200).map(|k| helix(0.05 * f64::from(k))).collect();
    let t = points(&ok("tangents", &[curve(&c)]));
    let n = points(&ok("frame", &[curve(&c)]));
    assert!(
        t.iter().zip(&n).all(|(t, n)| t.dot(*n).abs() < 1e-14 && (n.norm() - 1.0).abs() < 1e-14)
    );
    let normal = |k: usize| Vec3::of(-c[k][0], -c[k][1], 0.0);
    let angle = |k: usize| {
        let p = normal(k) - t[k] * normal(k).dot(t[k]);
        n[k].cross(p).dot(t[k]).atan2(n[k].dot(p))
    };
    // Torsion 0.5 / 1.25 per length, length sqrt(1.25) per radian.
    let turned = (angle(120) - angle(20)).rem_euclid(2.0 * PI);
    close(turned, (5.0 * 0.4 * 1.25f64.sqrt()).rem_euclid(2.0 * PI), 2e-3);
}

#[test]
fn curvatures() {
    let arc = |k: usize| [2.0 * (0.2 * k as f64).cos(), 0.0, 2.0 * (0.2 * k as f64).sin()];
    let c = curve(&(0..8).map(arc).collect::<Vec<_>>());
    assert!(numbers(&ok("curvatures", &[c])).iter().all(|k| (k - 0.5).abs() < 1e-14));
    let helix = |k: usize| {
        let t = 0.05 * k as f64;
        [t.cos(), t.sin(), 0.5 * t]
    };
    let c = curve(&(0..40).map(helix).collect::<Vec<_>>());
    let t = numbers(&ok("torsion", &[c]));
    assert!(t.iter().all(|t| (t - 0.4).abs() < 1e-3), "{:?}", &t[..3]);
    // Sphere of radius 2 from its pole, cylinder, plane.
    let error = |n: usize| {
        let ball = surface(n, n, |i, j| {
            let (a, b) = (1.5 * i as f64 / (n - 1) as f64, 2.0 * j as f64 / (n - 1) as f64);
            [2.0 * a.cos(), 2.0 * a.sin() * b.cos(), 2.0 * a.sin() * b.sin()]
        });
        let k = numbers(&ok("gauss", std::slice::from_ref(&ball)));
        let h = numbers(&ok("mean", std::slice::from_ref(&ball)));
        let normals = points(&ok("normals", std::slice::from_ref(&ball)));
        let radial = points(&ball);
        // The pole's normal is the mean of its neighbours'.
        let off = (n..n * n).map(|k| 1.0 - (normals[k].dot(radial[k]) * 0.5).abs());
        assert!(off.fold(0.0, f64::max) < 1e-6 + 20.0 / (n as f64).powi(6));
        let k = k.iter().fold(0.0f64, |m, k| m.max((k - 0.25).abs()));
        k.max(h.iter().fold(0.0, |m, h| m.max((h.abs() - 0.5).abs())))
    };
    let (coarse, fine) = (error(15), error(30));
    assert!(fine < 0.02 && coarse / fine > 2.5, "{coarse:e} {fine:e}");
    let tube = surface(9, 12, |i, j| {
        let a = 0.2 * j as f64;
        [i as f64, 3.0 * a.cos(), 3.0 * a.sin()]
    });
    assert!(numbers(&ok("gauss", std::slice::from_ref(&tube))).iter().all(|k| k.abs() < 1e-12));
    assert!(numbers(&ok("mean", &[tube])).iter().all(|h| (h.abs() - 1.0 / 6.0).abs() < 1e-2));
    assert_eq!(
        refused("gauss", &[surface(2, 5, |i, j| [i as f64, j as f64, 0.0])]).0,
        "too-few-items"
    );
    assert_eq!(refused("curvatures", &[curve(&[[0.0; 3]; 2])]).0, "too-few-items");
}

fn hill(m: usize, n: usize) -> Value<f64> {
    surface(m, n, |i, j| {
        let (u, v) = (i as f64 / (m - 1) as f64, j as f64 / (n - 1) as f64);
        [2.0 * u, v, 0.3 * (2.0 * u).sin() + 0.2 * v * v]
    })
}

/// No cell of it is nearly the best, where metrics have kinks.
fn sheared(m: usize, n: usize) -> Value<f64> {
    surface(m, n, |i, j| {
        let (u, v) = (i as f64 / (m - 1) as f64, j as f64 / (n - 1) as f64);
        [
            2.0 * u * (1.0 + 0.3 * u) + 0.7 * v + 0.2 * u * v,
            v + 0.1 * v * v,
            0.3 * u * u * v + 0.2 * v,
        ]
    })
}

#[test]
fn meetings() {
    let circle = |k: usize| {
        let a = PI * k as f64 / 40.0;
        [a.cos(), a.sin(), 0.0]
    };
    let arc = ok("makecc", &[curve(&(0..41).map(circle).collect::<Vec<_>>()), text("notaknot")]);
    close(one("closest", &[vector(0.0, 3.0, 0.5), arc.clone()]), 0.5, 1e-9);
    let many = ok("closest", &[curve(&[[2.0, -0.5, 0.0], [-3.0, 0.001, 0.0]]), arc.clone()]);
    assert_eq!(numbers(&many)[0], 0.0);
    let line = ok("makelc", &[curve(&[[0.0, -1.0, 0.0], [0.0, 2.0, 0.0]])]);
    let met = points(&ok("intersect", &[arc.clone(), line.clone()]));
    assert!(met.len() == 1 && met[0].distance(Vec3::of(0.0, 1.0, 0.0)) < 1e-6);
    let beside = ok("makelc", &[curve(&[[0.0, -1.0, 1.0], [0.0, 2.0, 1.0]])]);
    assert_eq!(refused("intersect", &[arc.clone(), beside]).0, "no-solution");
    let ground = ok("makecs", &[hill(9, 7), text("notaknot"), text("index")]);
    let mast = ok("makelc", &[curve(&[[0.7, 0.4, -1.0], [0.7, 0.4, 2.0]])]);
    let p = points(&ok("intersect", &[mast, ground.clone()]))[0];
    close(p.z, 0.3 * 0.7f64.sin() + 0.2 * 0.16, 1e-4);
    let wall =
        ok("makels", &[surface(2, 2, |i, j| [0.9, -0.1 + 1.2 * i as f64, -1.0 + 2.0 * j as f64])]);
    let seam = points(&ok("intersect", &[ground.clone(), wall]));
    assert!(seam.len() > 4 && seam.iter().all(|p| (p.x - 0.9).abs() < 1e-11));
    close(seam[0].distance(seam[seam.len() - 1]), (1.0f64 + 0.04).sqrt(), 1e-4);
    let above = surface(3, 3, |i, j| [0.2 + 0.4 * i as f64, 0.2 + 0.3 * j as f64, 2.0]);
    let down = ok("project", &[above.clone(), ground.clone(), vector(0.0, 0.0, -1.0)]);
    assert!(
        points(&down).iter().zip(points(&above)).all(|(p, q)| (p.x - q.x).hypot(p.y - q.y) < 1e-12)
    );
    let near = points(&ok("project", &[down.clone(), ground.clone(), text("closest")]));
    assert!(near.iter().zip(points(&down)).all(|(p, q)| p.distance(q) < 1e-9));
    let outside = [vector(9.0, 0.0, 1.0), ground.clone(), vector(0.0, 0.0, 1.0)];
    assert_eq!(refused("project", &outside), ("no-solution", Some(0), Some(0)));
    let word = [vector(0.0, 0.0, 1.0), ground, text("down")];
    assert_eq!(refused("project", &word), ("unknown-word", Some(2), None));
    assert_eq!(refused("intersect", &[arc, number(1.0)]), ("wrong-class", Some(1), None));
}

fn landed<T: Scalar>(args: &[Value<T>], ask: &str) -> Value<T> {
    let ground = call("makecs", &[args[0].clone(), Value::text("notaknot"), Value::text("index")]);
    let ground = ground.unwrap();
    match ask {
        "closest" => call("project", &[args[1].clone(), ground, Value::text("closest")]).unwrap(),
        "along" => call("project", &[args[1].clone(), ground, args[2].clone()]).unwrap(),
        _ => {
            let line = call("makelc", &[args[3].clone()]).unwrap();
            match ask {
                "pierce" => call("intersect", &[line, ground]).unwrap(),
                _ => call("closest", &[args[1].clone(), line]).unwrap(),
            }
        }
    }
}

#[test]
fn derivatives_of_meetings() {
    let args = [
        hill(6, 5),
        curve(&[[0.4, 0.3, 0.6], [1.2, 0.7, 0.9]]),
        vector(0.1, 0.05, -1.0),
        curve(&[[0.6, 0.3, -1.0], [0.7, 0.4, 2.0]]),
    ];
    for ask in ["closest", "along", "pierce", "foot"] {
        law(&args, &[0, 1, 2, 3], 2e-6, |a| landed(a, ask), |a| landed(a, ask));
    }
}

/// A grid with stretched edges; its inside is not set.
fn frame(m: usize, n: usize) -> Value<f64> {
    surface(m, n, |i, j| {
        let (u, v) = (i as f64 / (m - 1) as f64, j as f64 / (n - 1) as f64);
        let inside = i > 0 && j > 0 && i + 1 < m && j + 1 < n;
        if inside {
            return [9.0, 9.0, 9.0];
        }
        [0.6 * u + 0.4 * u * u + 0.2 * v, v + 0.1 * (3.0 * u).sin() * (1.0 - v), 0.0]
    })
}

#[test]
fn the_figure_of_transfinite_interpolation() {
    let d = |a: f64, b: f64, n: f64| numbers(&ok("d_tanh", &[0.0, 1.0, a, b, n].map(number)));
    let (low, high, side) = (d(0.01, 0.2, 11.0), d(0.2, 0.01, 11.0), d(0.1, 0.01, 8.0));
    let s = surface(11, 8, |i, j| match j {
        0 => [low[i], side[j], 0.0],
        7 => [high[i], side[j], 0.0],
        _ => [if i == 0 { 0.0 } else { 1.0 }, side[j], 0.0],
    });
    let grid = points(&ok("tfi", &[s, text("arc")]));
    let p = grid[5 * 8 + 3];
    close(p.x, 0.59621412, 5.1e-9);
    close(p.y, 0.65163484, 5.1e-9);
    for j in 0..8 {
        assert!((1..11).all(|i| grid[i * 8 + j].x > grid[(i - 1) * 8 + j].x));
    }
}

#[test]
fn grids_of_the_language() {
    let s = frame(9, 7);
    let grid = ok("tfi", std::slice::from_ref(&s));
    let edges = [
        curve(&points(&s)[..7].iter().map(|p| p.to_array()).collect::<Vec<_>>()),
        curve(&points(&s)[56..].iter().map(|p| p.to_array()).collect::<Vec<_>>()),
        curve(&points(&s).iter().step_by(7).map(|p| p.to_array()).collect::<Vec<_>>()),
        curve(&points(&s).iter().skip(6).step_by(7).map(|p| p.to_array()).collect::<Vec<_>>()),
    ];
    let same = ok("tfi", &[Value::list(edges.clone()), text("arc")]);
    assert_eq!(points(&same), points(&grid));
    let mut apart = edges.clone();
    apart[3] = ok("translate", &[edges[3].clone(), vector(0.0, 0.5, 0.0)]);
    assert_eq!(refused("tfi", &[Value::list(apart)]), ("edges-apart", Some(0), None));
    assert_eq!(refused("tfi", &[Value::list(edges[..3].to_vec())]).0, "wrong-shape");
    let mut short = edges.clone();
    short[1] = curve(&[[0.0; 3], [1.0, 0.0, 0.0]]);
    assert_eq!(refused("tfi", &[Value::list(short)]), ("shapes-differ", Some(0), Some(1)));
    assert_eq!(refused("tfi", &[s.clone(), text("bent")]), ("unknown-word", Some(1), None));
    assert_eq!(refused("tfi", &[farray(&[1.0])]).0, "wrong-class");
    // A box of six faces.
    let face = |m: usize, n: usize, at: &dyn Fn(f64, f64) -> [f64; 3]| {
        surface(m, n, |i, j| at(i as f64, j as f64))
    };
    let faces = [
        face(3, 4, &|j, k| [0.0, j, k]),
        face(3, 4, &|j, k| [1.0, j, k]),
        face(2, 4, &|i, k| [i, 0.0, k]),
        face(2, 4, &|i, k| [i, 2.0, k]),
        face(2, 3, &|i, j| [i, j, 0.0]),
        face(2, 3, &|i, j| [i, j, 3.0]),
    ];
    let Value::Block(layers) = ok("tfi", &[Value::list(faces)]) else { panic!() };
    assert_eq!(layers.len(), 4);
    assert!(points(&layers[2]).iter().all(|p| p.z == 2.0));
    // Smoothing.
    for method in ["laplace", "middlecoff"] {
        let args = [grid.clone(), number(300.0), number(1e-10), text(method)];
        let done = ok("elliptic", &args);
        assert_eq!(points(&done)[..7], points(&grid)[..7]);
        assert_eq!(one("folds", &[done]), 0.0);
    }
    let args = |more: &[Value<f64>]| {
        let mut args = vec![grid.clone(), number(300.0), number(1e-10)];
        args.extend(more.iter().cloned());
        args
    };
    assert_eq!(refused("elliptic", &args(&[text("newton")])), ("unknown-word", Some(3), None));
    assert_eq!(
        refused("elliptic", &args(&[text("sorenson")])),
        ("missing-argument", Some(5), None)
    );
    let walls = [text("sorenson"), Value::Unset, text("j1 north"), number(0.05)];
    assert_eq!(refused("elliptic", &args(&walls)), ("unknown-word", Some(5), None));
    let walls = [text("laplace"), Value::Unset, text("j1"), number(0.05)];
    assert_eq!(refused("elliptic", &args(&walls)), ("unused-argument", Some(3), None));
    let walls = [text("sorenson"), Value::Unset, text("j1"), number(0.1)];
    assert_eq!(one("folds", &[ok("elliptic", &args(&walls))]), 0.0);
    // A third of the cell that the fixed sides begin with folds the cell beside them.
    let walls = [text("sorenson"), Value::Unset, text("j1"), number(0.05)];
    assert_eq!(refused("elliptic", &args(&walls)).0, "folded-grid");
    // A start that stays folded for want of sweeps is refused, unless it is wanted.
    let mut folded = points(&grid);
    folded.swap(3 * 7 + 3, 5 * 7 + 3);
    let folded = Value::Vectors(Arc::new(moldloft_registry::Vectors::grid(9, 7, folded)));
    assert!(one("folds", std::slice::from_ref(&folded)) > 0.0);
    assert_eq!(refused("elliptic", &[folded.clone(), number(0.0)]).0, "folded-grid");
    let allowed = [
        folded.clone(),
        number(0.0),
        number(0.0),
        text("laplace"),
        Value::Unset,
        Value::Unset,
        Value::Unset,
        number(FRAC_PI_2),
        number(1.0),
        Value::Unset,
        text("allow"),
    ];
    assert_eq!(points(&ok("elliptic", &allowed)), points(&folded));
    let healed = ok("elliptic", &[folded, number(200.0)]);
    assert_eq!(one("folds", &[healed]), 0.0);
    // A curved grid stays on its own spline surface, or on one that is named.
    let ball = surface(8, 9, |i, j| {
        let (a, b) = (0.3 + 0.1 * i as f64, 0.1 * j as f64 * (1.0 + 0.05 * i as f64));
        [a.cos(), a.sin() * b.cos(), a.sin() * b.sin()]
    });
    let smooth = points(&ok("elliptic", &[ball.clone(), number(100.0)]));
    assert!(smooth.iter().all(|p| (p.norm() - 1.0).abs() < 2e-5));
    let on = ok("makecs", &[ball.clone(), text("notaknot"), text("index")]);
    let named =
        points(&ok("elliptic", &[ball, number(100.0), number(1e-8), text("laplace"), on.clone()]));
    assert!(smooth.iter().zip(&named).all(|(p, q)| p.distance(*q) < 1e-6));
    assert_eq!(
        refused("elliptic", &[grid.clone(), number(9.0), number(0.0), text("laplace"), on]),
        ("off-surface", Some(4), None)
    );
    let Value::Text(report) = ok("report", std::slice::from_ref(&grid)) else { panic!() };
    assert!(report.starts_with("grid [9,7], 0 folded cells") && report.lines().count() == 11);
    assert_eq!(refused("quality", &[grid, text("size")]), ("unknown-word", Some(1), None));
}

#[test]
fn derivatives_of_moves_and_grids() {
    let c = curve(&[[0.0; 3], [1.0, 0.2, 0.1], [2.0, 0.9, 0.4], [2.5, 1.5, 1.0], [2.4, 2.0, 1.7]]);
    let v = vector(0.3, 0.7, -0.4);
    let angle = number(0.6);
    for (name, args, active) in [
        ("rotate", vec![c.clone(), v.clone(), v.clone(), angle.clone()], vec![0, 1, 2, 3]),
        ("mirror", vec![c.clone(), v.clone(), v.clone()], vec![0, 1, 2]),
        ("revolve", vec![c.clone(), angle.clone(), number(2.0), number(5.0)], vec![0, 1, 2]),
        ("frame", vec![c.clone(), v.clone()], vec![0, 1]),
        ("tangents", vec![c.clone()], vec![0]),
        ("curvatures", vec![c.clone()], vec![0]),
        ("torsion", vec![c.clone()], vec![0]),
        ("cumlen", vec![c.clone()], vec![0]),
        ("centroid", vec![hill(4, 5)], vec![0]),
        ("norm", vec![c.clone()], vec![0]),
        ("gauss", vec![hill(6, 7)], vec![0]),
        ("mean", vec![hill(6, 7)], vec![0]),
        ("normals", vec![hill(6, 7)], vec![0]),
        ("tfi", vec![frame(6, 7)], vec![0]),
        ("tfi", vec![frame(6, 7), text("hermite")], vec![0]),
        ("tfi", vec![frame(6, 7), text("soni2")], vec![0]),
        ("quality", vec![sheared(4, 5), text("sj")], vec![0]),
        ("quality", vec![sheared(4, 5), text("warp")], vec![0]),
        ("quality", vec![sheared(4, 5), text("area")], vec![0]),
        ("quality", vec![sheared(4, 5), text("growth_i")], vec![0]),
        ("elliptic", vec![hill(6, 7), number(20.0), number(0.0), text("middlecoff")], vec![0]),
    ] {
        println!("{name}");
        law(&args, &active, 5e-6, |a| call(name, a).unwrap(), |a| call(name, a).unwrap());
    }
}

#[test]
fn grids_of_numbers_are_no_rows() {
    let grid = Value::Numbers(Arc::new(Array::grid(2, 2, vec![0.0, 0.3, 0.6, 1.0])));
    let line = ok("makelc", &[curve(&[[0.0; 3], [1.0, 0.0, 0.0]])]);
    assert_eq!(refused("distc", &[line, grid.clone()]), ("wrong-shape", Some(1), None));
    assert_eq!(refused("argmin", &[grid]).0, "wrong-shape");
}

#[test]
fn marched_grids() {
    let line = curve(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]]);
    let grid = points(&ok("hyperbolic", &[line.clone(), farray(&[0.0, 0.5, 1.5])]));
    assert!(grid[8..].iter().all(|p| (p.y - 1.5).abs() < 1e-12 && p.z.abs() < 1e-12));
    let Value::Block(layers) =
        ok("hyperbolic", &[hill(6, 5), farray(&[0.0, 0.05]), text("j1 symmetry y, jn symmetry y")])
    else {
        panic!()
    };
    assert!(points(&layers[1]).iter().step_by(5).all(|p| p.y == 0.0));
    assert_eq!(
        refused("hyperbolic", &[line.clone(), farray(&[0.0, -1.0])]),
        ("not-monotone", Some(1), None)
    );
    let sides = [line, farray(&[0.0, 1.0]), text("j1 pole")];
    assert_eq!(refused("hyperbolic", &sides), ("unknown-word", Some(2), None));
    assert_eq!(refused("hyperbolic", &[number(1.0), farray(&[0.0, 1.0])]).0, "wrong-class");
}
