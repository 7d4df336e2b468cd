//! Rays: where a line meets the surfaces of primitives, and where it enters and leaves a set.
//!
//! On a line a polynomial primitive is a polynomial of the parameter. Up to degree 4 its roots are
//! separated by those of its derivatives, which have closed forms up to the cubic's quadratic; others are
//! isolated by interval halving on value and slope. Every root is then polished by bisection and
//! secants.

use crate::expr::interval::Interval;
use crate::expr::tape::{ExprInstruction, ExprTape, NO_LEAF};
use crate::set::Compiled;
use crate::set::body::SurfacedSet;
use crate::{Leaf, Membership, Primitive, Set};
use moldloft_num::{Real, Vec3, find_root};
use smallvec::SmallVec;

/// A half-line or a piece of a line: start + t direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Point at t = 0.
    pub start: Vec3,
    /// Displacement for a unit of t.
    pub direction: Vec3,
    /// The end of the range of t, from 0; finite.
    pub length: f64,
}

/// An intersection of a ray with a set.
#[derive(Clone, Debug, PartialEq)]
pub struct Hit {
    /// The parameter.
    pub t: f64,
    /// The point.
    pub point: Vec3,
    /// Index of the leaf in [`Set::leaves`].
    pub leaf: usize,
    /// Unit normal, from solid to air; zero if undefined.
    pub normal: Vec3,
    /// True when the ray enters the solid; false when it leaves the solid or passes through a
    /// sheet.
    pub enters: bool,
}

impl Ray {
    /// The point at `t`.
    pub fn at(&self, t: f64) -> Vec3 {
        self.start + self.direction * t
    }
}

/// A polynomial by its coefficients, lowest first.
type Polynomial = SmallVec<[f64; 5]>;

/// The primitive along a ray, when it is a polynomial of degree 4 at most.
fn polynomial(tape: &ExprTape<f64>, ray: &Ray) -> Option<Polynomial> {
    let mut values: Vec<Polynomial> = Vec::with_capacity(tape.code.len());
    let zip = |a: &Polynomial, b: &Polynomial, sign: f64| -> Polynomial {
        let part = |p: &Polynomial, k: usize| p.get(k).copied().unwrap_or(0.0);
        (0..a.len().max(b.len())).map(|k| part(a, k) + sign * part(b, k)).collect()
    };
    let product = |a: &Polynomial, b: &Polynomial| -> Option<Polynomial> {
        let mut out = Polynomial::from_elem(0.0, a.len() + b.len() - 1);
        for (i, x) in a.iter().enumerate() {
            for (j, y) in b.iter().enumerate() {
                out[i + j] += x * y;
            }
        }
        while out.len() > 1 && out[out.len() - 1] == 0.0 {
            out.pop();
        }
        (out.len() <= 5).then_some(out)
    };
    for code in &tape.code {
        let of = |a: u32| &values[a as usize];
        let value = match *code {
            ExprInstruction::Real(c) => SmallVec::from_slice(&[c]),
            ExprInstruction::Plane(n, d) => {
                SmallVec::from_slice(&[n.dot(ray.start) + d, n.dot(ray.direction)])
            }
            ExprInstruction::Unary(crate::Unary::Neg, a) => of(a).iter().map(|x| -x).collect(),
            ExprInstruction::PlusReal(a, c) => {
                let mut p = of(a).clone();
                p[0] += c;
                p
            }
            ExprInstruction::TimesReal(a, c) => of(a).iter().map(|x| x * c).collect(),
            ExprInstruction::OverReal(a, c) => of(a).iter().map(|x| x / c).collect(),
            ExprInstruction::Power(a, n) => {
                let mut p = SmallVec::from_slice(&[1.0]);
                for _ in 0..n {
                    p = product(&p, of(a))?;
                }
                p
            }
            ExprInstruction::Add(a, b) => zip(of(a), of(b), 1.0),
            ExprInstruction::Sub(a, b) => zip(of(a), of(b), -1.0),
            ExprInstruction::Mul(a, b) => product(of(a), of(b))?,
            _ => return None,
        };
        values.push(value);
    }
    values.pop()
}

fn horner(p: &[f64], t: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

/// The roots of a polynomial in [`low`, `high`], ascending: between the roots of its derivative it
/// is monotone, so there is at most one in each piece; at a double root the derivative's root is
/// the result.
fn polynomial_roots(p: &[f64], low: f64, high: f64) -> Vec<f64> {
    let degree = p.iter().rposition(|c| *c != 0.0).unwrap_or(0);
    if degree == 0 {
        return Vec::new();
    }
    if degree == 1 {
        let t = -p[0] / p[1];
        return if (low..=high).contains(&t) { vec![t] } else { Vec::new() };
    }
    let slope: Vec<f64> = (1..=degree).map(|k| p[k] * k as f64).collect();
    let turning = polynomial_roots(&slope, low, high);
    let size = |t: f64| p.iter().rev().fold(0.0, |sum, c| sum * t.abs() + c.abs());
    let mut cuts = vec![low];
    cuts.extend(&turning);
    cuts.push(high);
    let mut roots: Vec<f64> = Vec::new();
    for pair in cuts.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        if let Ok(t) = find_root(|t| horner(p, t), a, b) {
            roots.push(t);
        }
    }
    // A double root is a turning point whose value is rounding.
    let touching =
        turning.into_iter().filter(|&t| horner(p, t).abs() <= 8.0 * f64::EPSILON * size(t));
    roots.extend(touching);
    roots.sort_by(f64::total_cmp);
    // Two roots of one contact differ by up to the square root of rounding.
    let mut kept: Vec<f64> = Vec::new();
    for t in roots {
        if kept.last().is_none_or(|old| (t - old).abs() > 1e-12 * (1.0 + t.abs())) {
            kept.push(t);
        }
    }
    kept
}

/// The ranges of value and of slope along a piece of the ray.
fn along(f: &Primitive, ray: &Ray, t: Interval) -> (Interval, Interval) {
    let sides = |t: Interval| {
        [0, 1, 2].map(|k| Interval::point(ray.start[k]) + t * Interval::point(ray.direction[k]))
    };
    let mut room = crate::expr::tape::RangeRoom::default();
    let range = f.tape().mean_value(&sides(t), &mut room);
    let slope = (0..3).fold(Interval::ZERO, |sum, k| sum + range.slope[k].scaled(ray.direction[k]));
    // The mean-value form once more, along the ray alone.
    let middle = Interval::point(t.middle());
    let value = f.tape().range(&sides(middle), &mut room.ranges);
    (range.value.meet(value + slope * (t - middle)), slope)
}

/// Pieces shorter than this part of the ray are not halved again.
const SHORTEST: f64 = 1e-10;
/// The most pieces of one ray: a function that is zero along it has no end of roots.
const MOST_PIECES: usize = 200_000;

/// The parameters at which a primitive is zero along a ray, ascending.
///
/// Complete up to degree 4 to rounding. For others, pieces that cannot hold a root are proved so;
/// roots closer together than 1e-10 of the ray may count as one.
///
/// # Example
/// ```
/// use moldloft_field::{Primitive, Ray, roots};
/// use moldloft_num::Vec3;
///
/// let ball = Primitive::sphere(Vec3::zero(), 1.0)?;
/// let ray = Ray { start: Vec3::of(-2.0, 0.0, 0.0), direction: Vec3::of(1.0, 0.0, 0.0), length: 9.0 };
/// assert_eq!(roots(&ball, &ray), [1.0, 3.0]);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn roots(f: &Primitive, ray: &Ray) -> Vec<f64> {
    if let Some(p) = polynomial(f.tape(), ray) {
        return polynomial_roots(&p, 0.0, ray.length);
    }
    let value = |t: f64| f.value(ray.at(t));
    let mut out: Vec<f64> = Vec::new();
    let mut stack = vec![Interval::new(0.0, ray.length)];
    let mut pieces = 0;
    while let Some(t) = stack.pop() {
        pieces += 1;
        if pieces > MOST_PIECES {
            break;
        }
        let (range, slope) = along(f, ray, t);
        if !range.contains(0.0) {
            continue;
        }
        let monotone = !slope.contains(0.0);
        let tiny = t.width() <= SHORTEST * ray.length;
        if monotone || tiny {
            match find_root(value, t.low, t.high) {
                Ok(root) => out.push(root),
                // A touch: the range still holds zero although the ends agree.
                Err(_) if tiny && !monotone => out.push(t.middle()),
                Err(_) => {}
            }
            continue;
        }
        let middle = t.middle();
        stack.push(Interval::new(middle, t.high));
        stack.push(Interval::new(t.low, middle));
    }
    out.sort_by(f64::total_cmp);
    // Pieces share their ends, and where the function touches zero it is rounding for a while.
    let scale = value(0.0).abs().max(value(ray.length).abs());
    let one = |a: f64, b: f64| {
        let near = b - a <= 4.0 * SHORTEST * ray.length;
        let flat = || value(0.5 * (a + b)).abs() <= 1e-14 * scale;
        near || b - a <= 1e-6 * ray.length && flat()
    };
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for t in out {
        match kept.last_mut() {
            Some(last) if one(last.1, t) => last.1 = t,
            _ => kept.push((t, t)),
        }
    }
    kept.into_iter().map(|(a, b)| 0.5 * (a + b)).collect()
}

/// A set prepared for many rays.
pub struct Caster {
    body: SurfacedSet,
}

impl Caster {
    /// Makes a set ready.
    pub fn new(set: &Set) -> Self {
        Self { body: set.as_body() }
    }

    /// The primitives, as [`Set::leaves`].
    pub fn leaves(&self) -> &[Leaf] {
        &self.body.compiled.leaves
    }

    /// As [`Set::hits`].
    pub fn hits(&self, ray: &Ray) -> Vec<Hit> {
        self.until(ray, usize::MAX)
    }

    /// As [`Set::first_hit`].
    pub fn first(&self, ray: &Ray) -> Option<Hit> {
        self.until(ray, 1).pop()
    }

    /// The first hits, `most` at most.
    fn until(&self, ray: &Ray, most: usize) -> Vec<Hit> {
        let Compiled { leaves, tape, .. } = &self.body.compiled;
        let mut candidates: Vec<(f64, usize)> = Vec::new();
        for (k, leaf) in leaves.iter().enumerate() {
            // A sheet is where its inside is zero.
            candidates.extend(roots(leaf.primitive.of_sheet(), ray).into_iter().map(|t| (t, k)));
        }
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut values = Vec::new();
        let mut inside =
            |a: f64, b: f64| tape.eval::<f64>(&ray.at(0.5 * (a + b)), &mut values) < 0.0;
        let mut hits = Vec::new();
        let mut from = 0.0;
        for (k, &(t, leaf)) in candidates.iter().enumerate() {
            // Several primitives may be zero at one position: the first that is on the set's
            // surface counts.
            let group = |s: f64| (s - t).abs() <= 1e-12 * ray.length;
            if k > 0 && group(candidates[k - 1].0) && hits.last().is_some_and(|h: &Hit| group(h.t))
            {
                continue;
            }
            let to = candidates[k..].iter().map(|c| c.0).find(|s| !group(*s)).unwrap_or(ray.length);
            let point = ray.at(t);
            let before = inside(from, t);
            let after = inside(t, to);
            let on_surface = || {
                let here = candidates.iter().filter(|c| group(c.0));
                let known: Vec<Primitive> = here.map(|c| leaves[c.1].primitive.clone()).collect();
                self.body.member(point, 0.0, &known) == Membership::Surface
            };
            let shows =
                before != after || (!before && leaves[leaf].primitive.is_sheet() && on_surface());
            if candidates[k + 1..].first().is_none_or(|next| !group(next.0)) {
                from = t;
            }
            if shows {
                // Of several primitives at one position, the one that decides beside it.
                let g = leaves[leaf].primitive.gradient(point);
                let normal = g.slope.normalized().unwrap_or_default();
                hits.push(Hit { t, point, leaf, normal, enters: after && !before });
                if hits.len() == most {
                    break;
                }
            }
        }
        hits
    }
}

impl Set<f64> {
    /// Intersections of a ray with the surface of the set, in order: from air to solid, from solid
    /// to air, or through a sheet.
    pub fn hits(&self, ray: &Ray) -> Vec<Hit> {
        Caster::new(self).hits(ray)
    }

    /// The first crossing of a ray with the surface; from within the solid, the exit.
    pub fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        Caster::new(self).first(ray)
    }
}

impl Set<f64> {
    /// The unit normal of the set at a point of its surface, from solid to air.
    pub fn normal(&self, p: Vec3) -> Vec3 {
        let compiled = self.compiled();
        let mut values = Vec::new();
        compiled.tape.eval::<f64>(&p, &mut values);
        let leaf = compiled.tape.leaf[compiled.tape.winner(&values, Real::re)];
        if leaf == NO_LEAF {
            return Vec3::zero();
        }
        compiled.leaves[leaf as usize].primitive.gradient(p).slope.normalized().unwrap_or_default()
    }
}
