//! Where first derivatives jump: shapes that name fewer kinks than breaks are smooth at the others.

use crate::common::{Random, open, rounds};
use moldloft_document::{Document, registry};
use moldloft_num::{Curve, Order, Surface, Vec3};
use moldloft_registry::Value;
use std::fmt::Write;

/// So far before and after a break derivatives are compared, and by this share of their size they may differ.
const ASIDE: f64 = 1e-9;
const NEAR: f64 = 1e-5;

/// Closed cylinders: two round ones, one with an edge at its seam, one of four sides.
const CYLINDERS: &str = "AbsPoint O(0, 0, 0); AbsPoint X(4, 0, 0); Line axis(O, X);
    AbsPoint c(0, 0, 1); AbsPoint d(0, 1, 0); Arc ring1(c, O, d, type = 6); TranSurf on1(ring1, axis);
    AbsPoint e(0, 0, 2); AbsPoint f(0, 2, 0); Arc ring2(e, O, f, type = 6); TranSurf on2(ring2, axis);
    AbsPoint p(0, 0, 5); AbsPoint q(0, 3, 2); AbsPoint r(0, -3, 2);
    BCurve drop({p, q, r, p}); TranSurf on3(drop, axis);
    AbsPoint s(0, 0, -5); BCurve prism({p, q, s, r, p}, type = 1); TranSurf on4(prism, axis);";

/// A foil on cylinder `on` about the place `at` round it.
fn foil(random: &mut Random, name: &str, on: usize, at: f64) -> String {
    let (du, dv) = (random.between(0.02, 0.2), random.between(0.02, 0.2));
    let mut text = String::new();
    for (k, (u, v)) in [(-du, -dv), (-0.02, 0.02), (du, dv), (0.02, -0.02)].into_iter().enumerate()
    {
        let _ = write!(text, "AbsMagnet {name}{k}(on{on}, {}, {}); ", at + u, 0.5 + v);
    }
    let family = *random.pick(&["66tmb", "4-digit", "65", "modified"]);
    let _ = writeln!(
        text,
        "FoilSnake {name}({{{name}0, {name}1, {name}2, {name}3, {name}0}}, family = \"{family}\");"
    );
    text
}

fn smooth([a, b]: [Vec3; 2]) -> bool {
    (a - b).norm() <= NEAR * a.norm().max(b.norm())
}

fn apart(all: &[f64], some: &[f64]) -> Vec<f64> {
    let inside = all.iter().filter(|t| **t > ASIDE && **t < 1.0 - ASIDE);
    inside.filter(|t| !some.iter().any(|s| (s - **t).abs() <= ASIDE)).copied().collect()
}

/// What is wrong with the kinks of a document's shapes, and how many breaks are no kinks.
fn faults(document: &Document) -> (Vec<String>, usize) {
    let (mut wrong, mut seen) = (Vec::new(), 0);
    for object in document.graph().objects() {
        let places = [0.03, 0.21, 0.5, 0.68, 0.97];
        match object.value() {
            Some(Value::Curve(curve)) => {
                for t in apart(&curve.breaks(), &curve.kinks()) {
                    seen += 1;
                    if !smooth([-ASIDE, ASIDE].map(|h| curve.jet(t + h, Order::First)[1])) {
                        wrong.push(format!("{} at {t}", object.name));
                    }
                }
            }
            Some(Value::Surface(surface)) => {
                for (axis, (all, some)) in surface.breaks().iter().zip(&surface.kinks()).enumerate()
                {
                    for t in apart(all, some) {
                        seen += 1;
                        let jet = |h: f64, w: f64| {
                            let [u, v] = if axis == 0 { [t + h, w] } else { [w, t + h] };
                            let jet = surface.jet(u, v, Order::First);
                            [jet.u, jet.v]
                        };
                        let jumps = |&w: &f64| {
                            let (a, b) = (jet(-ASIDE, w), jet(ASIDE, w));
                            (0..2).any(|k| !smooth([a[k], b[k]]))
                        };
                        if places.iter().any(jumps) {
                            wrong.push(format!("{} at {} = {t}", object.name, ["u", "v"][axis]));
                        }
                    }
                }
            }
            _ => {}
        }
    }
    (wrong, seen)
}

#[test]
fn examples_have_no_kinks_but_those_they_name() {
    for row in registry().rows().filter(|row| row.kind) {
        let (wrong, _) = faults(&open(&row.example));
        assert!(wrong.is_empty(), "{}: {}", row.name, wrong.join("; "));
    }
    // The blades of a propeller are lofts through foils, its hub is bounded by them.
    let propeller = include_str!("../../../../examples/propeller/propeller.sdl");
    let mut random = Random::new(5);
    for _ in 0..rounds(60) {
        let mut text = String::from(propeller);
        for name in ["pitch", "skew", "chord", "thickness", "camber"] {
            let factor = random.between(0.9, 1.05);
            text = text.replace(&format!("{name} = 1 in"), &format!("{name} = {factor} in"));
        }
        let (wrong, seen) = faults(&open(&text));
        assert!(wrong.is_empty() && seen > 1000, "{seen}: {}", wrong.join("; "));
    }
}

#[test]
fn nor_have_lofts_through_foils_on_cylinders_over_their_seams() {
    let mut random = Random::new(3);
    let mut seen = 0;
    for round in 0..rounds(400) {
        let mut text = String::from(CYLINDERS);
        // Near the seam in every second round.
        let at = if round % 2 == 0 { random.between(-0.1, 0.1) } else { random.between(0.0, 1.0) };
        let pair = *random.pick(&[[1, 2], [1, 3], [3, 1], [2, 4], [4, 2]]);
        for (name, on) in ["a", "b"].into_iter().zip(pair) {
            text += &foil(&mut random, name, on, at);
        }
        text += "CLoftSurf skin({a, b}); RuledSurf plain({a, b}); Line tip(a0, a0); CLoftSurf top({a, b, tip});";
        let document = open(&text);
        let (wrong, some) = faults(&document);
        assert!(wrong.is_empty(), "{text}\n{}", wrong.join("; "));
        seen += some;
    }
    assert!(seen > 100, "{seen}");
}
