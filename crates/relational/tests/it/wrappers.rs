//! Shapes made from shapes: over random inputs their facts agree with differences of their points,
//! their batches with single points.
//!
//! The inputs are those of the rows' examples with their curves and surfaces replaced by others
//! near them: of degrees 1 to 3, with kinks, rational, relabelled, images and parts.

use crate::common::{Object, Scene, attempt};
use moldloft_num::{Curve, Order, Surface, Vec3};
use moldloft_registry::{Class, CurveRef, Row, SurfaceRef, Value};
use moldloft_testing::{Random, rounds};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Random deviation of an input from that of the example, relative to its size.
const NOISE: f64 = 0.08;

/// Largest difference of a batch from single points, relative to their size.
const ROUNDING: f64 = 1e-12;

/// A change within this interval of a path, relative to its size, is a jump.
const WIDTH: f64 = 1e-10;
const JUMP: f64 = 1e-4;

/// Accuracy of the place of a jump.
const FOUND: f64 = 1e-7;

fn takes_shapes(row: &Row) -> bool {
    row.sweep.is_none()
        && matches!(row.class, Class::Curve | Class::Snake | Class::Surface)
        && row.fields.iter().any(|field| {
            [Class::Curve, Class::Snake, Class::Surface, Class::Bead, Class::Magnet]
                .into_iter()
                .any(|class| field.class != Class::Any && field.class.accepts(class))
        })
}

/// A writer of declarations with names of its own.
struct Writer<'a> {
    random: &'a mut Random,
    text: String,
    count: usize,
}

impl Writer<'_> {
    fn declare(&mut self, kind: &str, args: &str) -> String {
        self.count += 1;
        let name = format!("z{}", self.count);
        let _ = writeln!(self.text, "{kind} {name}({args});");
        name
    }

    fn point(&mut self, p: Vec3) -> String {
        self.declare("AbsPoint", &format!("{:?}, {:?}, {:?}", p.x, p.y, p.z))
    }

    fn near(&mut self, p: Vec3, size: f64) -> Vec3 {
        let random = &mut self.random;
        p + Vec3::new(random.signed(), random.signed(), random.signed()) * (NOISE * size)
    }

    /// Points along a curve: its ends, and near it.
    fn along(&mut self, curve: &CurveRef<f64>, count: usize, size: f64) -> Vec<Vec3> {
        let at = |k: usize| curve.jet(k as f64 / (count - 1) as f64, Order::Zero)[0];
        let inner: Vec<Vec3> = (1..count - 1).map(|k| self.near(at(k), size)).collect();
        [vec![at(0)], inner, vec![at(count - 1)]].concat()
    }

    fn points(&mut self, all: &[Vec3]) -> String {
        let names: Vec<String> = all.iter().map(|p| self.point(*p)).collect();
        format!("{{{}}}", names.join(", "))
    }

    fn relabel(&mut self) -> String {
        let middle = self.random.between(0.35, 0.65);
        self.declare("Relabel", &format!("{{0, {middle:?}, 1}}, 2"))
    }

    /// A curve with the ends of `curve`: its kind and arguments.
    fn curve(&mut self, curve: &CurveRef<f64>, size: f64) -> (&'static str, String) {
        let count = 4 + self.random.below(3);
        let points = self.along(curve, count, size);
        let list = self.points(&points);
        match self.random.below(7) {
            0 => ("BCurve", format!("{list}, {}", 1 + self.random.below(3))),
            1 => ("CCurve", list),
            2 => {
                let middle = count / 2;
                let first = self.points(&points[..=middle]);
                let last = self.points(&points[middle..]);
                let first = self.declare("BCurve", &format!("{first}, 2"));
                let last = self.declare("BCurve", &format!("{last}, 1"));
                ("PolyCurve", format!("{{{first}, {last}}}"))
            }
            3 => {
                let across = |p: &Vec3| Vec3::new(p.x, -p.y, p.z);
                let image: Vec<Vec3> = points.iter().map(across).collect();
                let list = self.points(&image);
                let image = self.declare("BCurve", &format!("{list}, 2"));
                ("MirrCurve", format!("{image}, \"y=0\""))
            }
            4 => {
                let weights: Vec<String> =
                    points.iter().map(|_| format!("{:?}", self.random.between(0.6, 1.6))).collect();
                ("NURBCurve", format!("{list}, 2, weights = {{{}}}", weights.join(", ")))
            }
            5 => {
                let relabel = self.relabel();
                ("BCurve", format!("{list}, 2, relabel = {relabel}"))
            }
            _ => {
                let whole = self.declare("BCurve", &format!("{list}, 2"));
                let ends = [1.0, 0.0].map(|t| self.declare("AbsBead", &format!("{whole}, {t:?}")));
                let back = self.declare("SubCurve", &ends.join(", "));
                let ends = [1.0, 0.0].map(|t| self.declare("AbsBead", &format!("{back}, {t:?}")));
                ("SubCurve", ends.join(", "))
            }
        }
    }

    /// A surface near `surface`: its kind and arguments.
    fn surface(&mut self, surface: &SurfaceRef<f64>, size: f64) -> (&'static str, String) {
        let [nu, nv] = [0, 1].map(|_| 3 + self.random.below(3));
        let at = |i: usize, j: usize| {
            let [u, v] = [i as f64 / (nu - 1) as f64, j as f64 / (nv - 1) as f64];
            surface.jet(u, v, Order::Zero).p
        };
        let mut net = Vec::new();
        for j in 0..nv {
            for i in 0..nu {
                let corner = (i == 0 || i == nu - 1) && (j == 0 || j == nv - 1);
                net.push(if corner { at(i, j) } else { self.near(at(i, j), size) });
            }
        }
        let [du, dv] = [0, 1].map(|_| 1 + self.random.below(3));
        match self.random.below(4) {
            0 => {
                let rows: Vec<String> = net
                    .chunks(nu)
                    .map(|row| {
                        let list = self.points(row);
                        self.declare("BCurve", &format!("{list}, {du}"))
                    })
                    .collect();
                ("CLoftSurf", format!("{{{}}}", rows.join(", ")))
            }
            1 => {
                let image: Vec<Vec3> = net.iter().map(|p| Vec3::new(p.x, -p.y, p.z)).collect();
                let list = self.points(&image);
                let base = self.declare("BSurf", &format!("{list}, {nu}, {nv}, {du}, {dv}"));
                ("MirrSurf", format!("{base}, \"y=0\""))
            }
            2 => {
                let list = self.points(&net);
                let weights: Vec<String> =
                    net.iter().map(|_| format!("{:?}", self.random.between(0.6, 1.6))).collect();
                let weights = weights.join(", ");
                ("NURBSurf", format!("{list}, {nu}, {nv}, {du}, {dv}, weights = {{{weights}}}"))
            }
            _ => {
                let list = self.points(&net);
                ("BSurf", format!("{list}, {nu}, {nv}, {du}, {dv}"))
            }
        }
    }
}

/// The example of a row with some of its curves and surfaces replaced.
fn varied(row: &Row, example: &Scene<f64>, random: &mut Random) -> String {
    let mut writer = Writer { random, text: String::new(), count: 0 };
    for statement in row.example.split_inclusive(';') {
        let words: Vec<&str> =
            statement.split(['(', ' ', '\n']).filter(|w| !w.is_empty()).collect();
        let kept = words.len() < 2 || words[0] == row.name || writer.random.chance(35);
        let object = example.0.iter().find(|o| !kept && o.name == words[1]);
        let made = match object.map(|o| &o.value) {
            Some(Value::Curve(c)) if c.surface.is_none() => {
                let ends = [0.0, 1.0].map(|t| c.jet(t, Order::Zero)[0]);
                let middle = c.jet(0.5, Order::Zero)[0];
                let size = middle.distance(ends[0]) + middle.distance(ends[1]);
                Some(writer.curve(c, size))
            }
            Some(Value::Surface(s)) => {
                let corner = |u, v| s.jet(u, v, Order::Zero).p;
                let size = corner(0.0, 0.0).distance(corner(1.0, 1.0));
                Some(writer.surface(s, size.max(corner(1.0, 0.0).distance(corner(0.0, 1.0)))))
            }
            _ => None,
        };
        match made {
            Some((kind, args)) => {
                let _ = writeln!(writer.text, "{kind} {}({args});", words[1]);
            }
            None => {
                let _ = writeln!(writer.text, "{}", statement.trim());
            }
        }
    }
    writer.text
}

/// Jumps of a function between the parameters of two paths, by bisection.
fn jumps(f: &dyn Fn(f64) -> Vec3, least: f64, cells: usize) -> Vec<f64> {
    let at = |k: usize| 1e-4 + (1.0 - 2e-4) * k as f64 / (cells as f64 + 1e-3);
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

/// The members of a list that no other has.
fn beyond(these: &[f64], those: &[f64]) -> Vec<f64> {
    these.iter().copied().filter(|t| !those.iter().any(|s| (s - t).abs() <= FOUND)).collect()
}

/// Ascending interior parameters, each list within the next.
fn nested(lists: [&[f64]; 3], which: &str, wrong: &mut Vec<String>) {
    for list in lists {
        if !list.windows(2).all(|w| w[0] < w[1]) || list.iter().any(|t| !(0.0 < *t && *t < 1.0)) {
            wrong.push(format!("{which} are not ascending within 0 to 1: {list:?}"));
        }
    }
    for (part, whole) in [(lists[0], lists[1]), (lists[1], lists[2])] {
        let other = beyond(part, whole);
        if !other.is_empty() {
            wrong.push(format!("{which}: kinks, breaks and joints are not nested: {other:?}"));
        }
    }
}

fn check_curve(curve: &CurveRef<f64>, random: &mut Random, wrong: &mut Vec<String>) {
    let (kinks, breaks, joints) = (curve.kinks(), curve.breaks(), curve.joints());
    nested([&kinks, &breaks, &joints], "lists", wrong);
    let ts: Vec<f64> = [0.0, 1.0].into_iter().chain((0..9).map(|_| random.unit())).collect();
    let single: Vec<Vec3> = ts.iter().map(|t| curve.jet(*t, Order::Zero)[0]).collect();
    let size = single.iter().fold(1e-3, |size: f64, p| size.max(p.norm()));
    let mut batch = vec![Vec3::zero(); ts.len()];
    curve.grid(&ts, &mut batch);
    for ((t, p), q) in ts.iter().zip(&single).zip(&batch) {
        if p.distance(*q) > ROUNDING * size {
            wrong.push(format!("at {t} the batch differs by {:e}", p.distance(*q)));
        }
    }
    if curve.closed() && single[0].distance(single[1]) > 1e-7 * size {
        wrong.push("it is closed, and its ends differ".into());
    }
    let speed = curve.jet(0.37, Order::First)[1].norm();
    for (order, stated) in [(1, &kinks), (2, &breaks)] {
        let f = |t: f64| curve.jet(t, Order::Second)[order];
        for t in beyond(&jumps(&f, speed, rounds(7, 61)), stated) {
            wrong.push(format!("derivative {order} jumps at {t}"));
        }
    }
    difference(&|t| curve.jet(t, Order::Second), &breaks, random, wrong);
}

/// Derivatives against differences of points at a parameter away from breaks.
fn difference(
    jet: &dyn Fn(f64) -> [Vec3; 3],
    breaks: &[f64],
    random: &mut Random,
    wrong: &mut Vec<String>,
) {
    let t = random.between(0.05, 0.95);
    let h = 1e-4;
    if breaks.iter().any(|b| (b - t).abs() < 3.0 * h) {
        return;
    }
    let [before, here, after] = [t - h, t, t + h].map(jet);
    for k in 0..2 {
        let found = (after[k] - before[k]) * (0.5 / h);
        // The error of the difference is h² / 6 times a third derivative, which differences bound.
        let bend = (after[k + 1] - here[k + 1] * 2.0 + before[k + 1]).norm();
        let bound = bend + 1e-6 * (here[k + 1].norm() + here[k].norm()).max(1e-3);
        if found.distance(here[k + 1]) > bound {
            wrong.push(format!(
                "derivative {} at {t} is {:?}, by differences {found:?}",
                k + 1,
                here[k + 1]
            ));
        }
    }
}

fn check_surface(surface: &SurfaceRef<f64>, random: &mut Random, wrong: &mut Vec<String>) {
    let (kinks, breaks, joints) = (surface.kinks(), surface.breaks(), surface.joints());
    for k in 0..2 {
        nested([&kinks[k], &breaks[k], &joints[k]], ["u", "v"][k], wrong);
    }
    let mut list =
        || -> Vec<f64> { [0.0, 1.0].into_iter().chain((0..3).map(|_| random.unit())).collect() };
    let (us, vs) = (list(), list());
    let uv: Vec<[f64; 2]> = us.iter().flat_map(|u| vs.iter().map(move |v| [*u, *v])).collect();
    let single: Vec<_> = uv.iter().map(|[u, v]| surface.jet(*u, *v, Order::Second)).collect();
    let size = single.iter().fold(1e-3, |size: f64, jet| size.max(jet.p.norm()));
    let mut points = vec![Vec3::zero(); uv.len()];
    let mut normals = points.clone();
    let mut batches = Vec::new();
    surface.scattered(&uv, &mut points);
    batches.push(("scattered", points.clone()));
    surface.grid(&us, &vs, &mut points, None);
    batches.push(("grid", points.clone()));
    surface.grid(&us, &vs, &mut points, Some(&mut normals));
    batches.push(("grid with normals", points.clone()));
    for (name, points) in batches {
        for ((p, jet), at) in points.iter().zip(&single).zip(&uv) {
            if p.distance(jet.p) > ROUNDING * size {
                wrong.push(format!("{name} differs by {:e} at {at:?}", p.distance(jet.p)));
            }
        }
    }
    for ((normal, jet), at) in normals.iter().zip(&single).zip(&uv) {
        // Near singular points the direction is no rounding matter.
        let cross = jet.u.cross(jet.v).norm();
        if cross > 1e-3 * (jet.u.norm() * jet.v.norm()).max(1e-3 * size * size)
            && normal.distance(jet.normal()) > 1e-8
        {
            wrong.push(format!("normal differs by {:e} at {at:?}", normal.distance(jet.normal())));
        }
    }
    for (u, jets) in us.iter().zip(single.chunks(vs.len())) {
        for (jet, line) in jets.iter().zip(surface.line(*u, &vs, Order::Second)) {
            let pairs = [(jet.p, line.p), (jet.u, line.u), (jet.v, line.v)];
            let second = [(jet.uu, line.uu), (jet.uv, line.uv), (jet.vv, line.vv)];
            for (a, b) in pairs.into_iter().chain(second) {
                if a.distance(b) > 1e-9 * (size + a.norm()) {
                    wrong.push(format!("line at u = {u} differs by {:e}", a.distance(b)));
                }
            }
        }
    }
    for (k, closed) in surface.closed().into_iter().enumerate() {
        let across = |w: f64, t: f64| if k == 0 { [w, t] } else { [t, w] };
        let gap = [0.13, 0.5, 0.87].map(|t| {
            let [a, b] =
                [0.0, 1.0].map(|w| across(w, t)).map(|[u, v]| surface.jet(u, v, Order::Zero).p);
            a.distance(b)
        });
        if closed && gap.into_iter().fold(0.0, f64::max) > 1e-7 * size {
            wrong.push(format!("closed along {}, with a gap of {gap:?}", ["u", "v"][k]));
        }
    }
    check_lines(surface, random, size, wrong);
}

/// Jumps along lines of the parameter plane: u = const, v = const and a slanting one.
fn check_lines(surface: &SurfaceRef<f64>, random: &mut Random, size: f64, wrong: &mut Vec<String>) {
    let (kinks, breaks) = (surface.kinks(), surface.breaks());
    let cells = rounds(5, 31);
    let w = random.between(0.1, 0.9);
    let [from, to] = [0.0, 1.0].map(|u| [u, random.between(0.05, 0.95)]);
    let lines = [
        ("u", [0.0, w], [1.0, w], kinks[0].clone(), breaks[0].clone()),
        ("v", [w, 0.0], [w, 1.0], kinks[1].clone(), breaks[1].clone()),
        ("slanting", from, to, Vec::new(), Vec::new()),
    ];
    for (name, from, to, kinks, breaks) in lines {
        let along = [to[0] - from[0], to[1] - from[1]];
        // Breaks of a base at an angle to the parameters of a part.
        let path = |t: f64| [0, 1].map(|k| from[k] + along[k] * t);
        let crossed = surface.crossings(&path, &[0.0, 1.0]);
        let [kinks, breaks] = [kinks, breaks].map(|own| {
            let mut all = [own, crossed.clone()].concat();
            all.sort_by(f64::total_cmp);
            all
        });
        let jet = |t: f64| {
            let j = surface.jet(from[0] + along[0] * t, from[1] + along[1] * t, Order::Second);
            let [a, b] = along;
            [j.p, j.u * a + j.v * b, j.uu * (a * a) + j.uv * (2.0 * a * b) + j.vv * (b * b)]
        };
        for (order, stated) in [(1, &kinks), (2, &breaks)] {
            for t in beyond(&jumps(&|t| jet(t)[order], size, cells), stated) {
                wrong.push(format!("derivative {order} jumps along {name} {from:?} {to:?} at {t}"));
            }
        }
        difference(&jet, &breaks, random, wrong);
    }
}

#[test]
fn facts_and_batches_of_wrappers_agree_with_their_points() {
    let (mut wrong, mut tally) = (Vec::new(), BTreeMap::<String, [usize; 2]>::new());
    let mut random = Random::new(41);
    let wanted = std::env::var("MOLDLOFT_WRAPPER").ok();
    for row in moldloft_relational::rows().iter().filter(|row| takes_shapes(row)) {
        if wanted.as_ref().is_some_and(|wanted| *wanted != row.name) {
            continue;
        }
        let example = attempt(&row.example).expect("an example");
        let counts = tally.entry(row.name.to_string()).or_default();
        for _ in 0..rounds(2, 60) {
            let text = varied(row, &example, &mut random);
            let Ok(scene) = attempt(&text) else {
                counts[1] += 1;
                continue;
            };
            counts[0] += 1;
            let mine = |o: &&Object<f64>| o.row.name == row.name;
            for object in scene.0.iter().filter(mine) {
                let mut found = Vec::new();
                match &object.value {
                    Value::Curve(curve) => {
                        check_curve(curve, &mut random, &mut found);
                    }
                    Value::Surface(surface) => check_surface(surface, &mut random, &mut found),
                    _ => {}
                }
                if !found.is_empty() {
                    wrong.push(format!(
                        "{} {}:\n{text}{}",
                        row.name,
                        object.name,
                        found.join("\n")
                    ));
                }
            }
        }
    }
    println!("made and refused: {tally:?}");
    let made: usize = tally.values().map(|[made, _]| made).sum();
    assert!(wrong.is_empty(), "{} of {made}\n{}", wrong.len(), wrong.join("\n\n"));
}
