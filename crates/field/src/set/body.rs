//! A set as a body: its regular part, whatever the formula evaluates to on its surfaces.
//!
//! Leaves with one zero set (f, -f, parts face to face) are one surface, and change sides together. Near a point a body
//! takes only the combinations of sides that exist there: those of the cells into which the tangent planes of the surfaces
//! through the point cut its surroundings and, where several touch, of the gaps between them in the order of their
//! curvatures (Tilove, Set membership classification, IEEE Trans. Computers 29 (1980), with cells for its neighbourhoods).
//! A face is surface where the body differs on its two sides; others are hidden.

use super::{Compiled, Leaf, Membership, Set};
use crate::Primitive;
use crate::expr::algebra::Unary;
use crate::expr::form::Form;
use crate::expr::primitive::Op;
use crate::expr::tape::{ExprInstruction, ExprTape, NO_LEAF};
use crate::query::separation::solid_within;
use moldloft_num::{Axis, Vec3};
use rustc_hash::FxHashMap;

/// Numbers of two surfaces that differ by less, of 1 and their own size, are those of one surface.
const ONE_SURFACE: f64 = 1e-13;
/// Normals at a smaller angle are those of one tangent plane.
const ONE_PLANE: f64 = 1e-7;
/// Distance from a point at which touching surfaces are compared, relative to 1 and the point's
/// size.
const COMPARED_AT: f64 = 1e-4;
/// Heights that differ by less there, of 1 and the point's size, are equal.
const EQUAL_HEIGHT: f64 = 1e-14;
/// Combinations of sides of up to this many surfaces are all tried in a box.
const MOST_FREE: usize = 5;

/// Relation of a leaf to its surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LeafSide {
    pub(crate) surface: u32,
    /// True when it is solid where the surface's function is positive.
    pub(crate) flipped: bool,
    sheet: bool,
}

impl LeafSide {
    /// State of the leaf for the `side` of its surface's function.
    fn of(self, side: Membership) -> Membership {
        let side = match (self.sheet, side) {
            (_, Membership::Surface) => return Membership::Surface,
            (true, _) => Membership::Air,
            (false, side) => side,
        };
        if self.flipped { opposite(side) } else { side }
    }
}

fn opposite(side: Membership) -> Membership {
    match side {
        Membership::Solid => Membership::Air,
        Membership::Surface => Membership::Surface,
        Membership::Air => Membership::Solid,
    }
}

fn of_sign(value: f64) -> Membership {
    if value < 0.0 { Membership::Solid } else { Membership::Air }
}

/// A set with its surfaces, which decides for all queries whether a face is on the boundary.
///
/// # Example
/// ```
/// use moldloft_field::{Membership, Set};
/// use moldloft_num::Vec3;
///
/// let cube = |x: f64| Set::cuboid(Vec3::of(x, 0.0, 0.0), Vec3::of(x + 1.0, 1.0, 1.0)).unwrap();
/// let two = (cube(0.0) | cube(1.0)).as_body();
/// assert_eq!(two.member(Vec3::of(1.0, 0.5, 0.5), 1e-9, &[]), Membership::Solid);
/// assert_eq!(two.member(Vec3::of(2.0, 0.5, 0.5), 1e-9, &[]), Membership::Surface);
/// ```
pub struct SurfacedSet {
    pub(crate) compiled: Compiled<f64>,
    /// One function for each surface.
    pub(crate) surfaces: Vec<Primitive>,
    pub(crate) sides: Vec<LeafSide>,
}

/// A surface through a point.
struct ActiveSurface {
    surface: usize,
    /// Its unit normal, out of the function's solid side.
    normal: Vec3,
    /// The length of its gradient.
    slope: f64,
    value: f64,
}

impl SurfacedSet {
    pub(crate) fn of(set: &Set) -> Self {
        let compiled = set.compiled();
        let (surfaces, sides) = surfaces_of(&compiled.leaves);
        Self { compiled, surfaces, sides }
    }

    /// State of the set's tape for given sides of its surfaces.
    pub(crate) fn state(
        &self,
        tape: &ExprTape<f64>,
        side: impl Fn(usize) -> Membership,
    ) -> Membership {
        let mut states: Vec<Membership> = Vec::with_capacity(tape.code.len());
        for (code, &leaf) in tape.code.iter().zip(&tape.leaf) {
            states.push(match code {
                _ if leaf != NO_LEAF => {
                    let own = self.sides[leaf as usize];
                    own.of(side(own.surface as usize))
                }
                ExprInstruction::Union(a, b) => states[*a as usize].min(states[*b as usize]),
                ExprInstruction::Common(a, b) => states[*a as usize].max(states[*b as usize]),
                ExprInstruction::Real(c) => of_sign(*c),
                // Inside of a leaf.
                _ => Membership::Surface,
            });
        }
        states.last().copied().unwrap_or(Membership::Air)
    }

    /// State of the set's tape in a box, if it is the same on all sides of the remaining surfaces:
    /// all of them are hidden there.
    pub(crate) fn one_state(&self, tape: &ExprTape<f64>) -> Option<Membership> {
        let mut free: Vec<u32> = Vec::new();
        for &leaf in tape.leaf.iter().filter(|l| **l != NO_LEAF) {
            let own = self.sides[leaf as usize];
            if own.sheet {
                return None;
            }
            if !free.contains(&own.surface) {
                free.push(own.surface);
            }
            if free.len() > MOST_FREE {
                return None;
            }
        }
        let state = |cell: usize| {
            self.state(tape, |surface| {
                let at = free.iter().position(|f| *f as usize == surface).unwrap_or(0);
                if cell >> at & 1 == 0 { Membership::Solid } else { Membership::Air }
            })
        };
        let first = state(0);
        let same =
            first != Membership::Surface && (1..1 << free.len()).all(|cell| state(cell) == first);
        same.then_some(first)
    }

    /// State of a point. A surface passes through it if it is within `tolerance`, by |f| / |f'|, or
    /// if it belongs to one of the primitives `known`.
    pub fn member(&self, p: Vec3, tolerance: f64, known: &[Primitive]) -> Membership {
        let (mut sides, active) = self.sides_at(p, tolerance, known);
        let mut found: Option<Membership> = None;
        self.cells(p, &active, &mut sides, &mut |sides| {
            let state = self.state(&self.compiled.tape, |k| sides[k]);
            let same = found.is_none_or(|f| f == state);
            found = Some(if same { state } else { Membership::Surface });
            found != Some(Membership::Surface)
        });
        found.unwrap_or(Membership::Air)
    }

    /// The sides of all surfaces at a point, and those through it.
    fn sides_at(
        &self,
        p: Vec3,
        tolerance: f64,
        known: &[Primitive],
    ) -> (Vec<Membership>, Vec<ActiveSurface>) {
        let mut sides = Vec::with_capacity(self.surfaces.len());
        let mut active: Vec<ActiveSurface> = Vec::new();
        for (surface, f) in self.surfaces.iter().enumerate() {
            let g = f.gradient(p);
            let slope = g.slope.norm();
            let near = g.value == 0.0 || g.value.abs() <= tolerance * slope;
            let given = || known.iter().any(|k| is_one_surface(k, f));
            if !near && !given() {
                sides.push(of_sign(g.value));
                continue;
            }
            // Without a normal both sides are there.
            sides.push(Membership::Surface);
            if let Some(normal) = g.slope.normalized() {
                active.push(ActiveSurface { surface, normal, slope, value: g.value });
            }
        }
        (sides, active)
    }

    /// The surfaces through a point on which the body ends there, and its sheets.
    pub(crate) fn shown_at(&self, p: Vec3, tolerance: f64) -> Vec<&Primitive> {
        let (mut sides, active) = self.sides_at(p, tolerance, &[]);
        let mut cells: Vec<(Vec<Membership>, Membership)> = Vec::new();
        self.cells(p, &active, &mut sides, &mut |sides| {
            let own: Vec<Membership> = active.iter().map(|a| sides[a.surface]).collect();
            if !cells.iter().any(|c| c.0 == own) {
                cells.push((own, self.state(&self.compiled.tape, |k| sides[k])));
            }
            true
        });
        let beyond = |k: usize| {
            cells.iter().any(|(own, state)| {
                let turned = |other: &Vec<Membership>| {
                    (0..own.len()).all(|j| (j == k) == (own[j] != other[j]))
                };
                *state == Membership::Surface
                    || cells.iter().any(|(other, beside)| turned(other) && beside != state)
            })
        };
        let shown = (0..active.len()).filter(|k| self.is_sheet(active[*k].surface) || beyond(*k));
        shown.map(|k| &self.surfaces[active[k].surface]).collect()
    }

    /// The value that decides at a point, and the number of its leaf.
    pub(crate) fn winner(&self, p: Vec3) -> (f64, Option<usize>) {
        self.compiled.winner(p)
    }

    fn is_sheet(&self, surface: usize) -> bool {
        self.sides.iter().any(|s| s.sheet && s.surface as usize == surface)
    }

    /// Calls `take` with the sides of all surfaces in every cell about a point, until it gives false. Sheets count as active
    /// on both of their sides.
    fn cells(
        &self,
        p: Vec3,
        active: &[ActiveSurface],
        sides: &mut [Membership],
        take: &mut dyn FnMut(&[Membership]) -> bool,
    ) {
        let active: Vec<&ActiveSurface> =
            active.iter().filter(|a| !self.is_sheet(a.surface)).collect();
        if active.is_empty() {
            take(sides);
            return;
        }
        // By tangent planes.
        let mut planes: Vec<(Vec3, Vec<&ActiveSurface>)> = Vec::new();
        for a in &active {
            let alike = |n: &Vec3| n.cross(a.normal).norm() <= ONE_PLANE;
            match planes.iter_mut().find(|(n, _)| alike(n)) {
                Some((_, group)) => group.push(a),
                None => planes.push((a.normal, vec![a])),
            }
        }
        let size = 1.0 + p.norm();
        let step = COMPARED_AT * size;
        for (k, (n, group)) in planes.iter().enumerate() {
            for along in sectors(&planes, k, group.len() > 1) {
                for (_, (_, others)) in planes.iter().enumerate().filter(|(j, _)| *j != k) {
                    for a in others {
                        sides[a.surface] = of_sign(a.normal.dot(along));
                    }
                }
                // Height of each above the tangent plane, at a small distance.
                let mut heights: Vec<(f64, &ActiveSurface)> = group
                    .iter()
                    .map(|a| {
                        let bend = match group.len() {
                            1 => 0.0,
                            _ => {
                                let h = self.surfaces[a.surface].hessian(p).second;
                                along.dot(Vec3::from(h.map(|row| row.dot(along))))
                            }
                        };
                        let rise = a.value + 0.5 * bend * step * step;
                        (-rise / (a.slope * a.normal.dot(*n)), *a)
                    })
                    .collect();
                heights.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.surface.cmp(&b.1.surface)));
                for gap in 0..=heights.len() {
                    for (i, (height, a)) in heights.iter().enumerate() {
                        // Below the sheets from `gap` on, above those before.
                        let above = (i < gap) == (a.normal.dot(*n) > 0.0);
                        let ties = |other: Option<&(f64, &ActiveSurface)>| {
                            other.is_some_and(|o| (o.0 - height).abs() <= EQUAL_HEIGHT * size)
                        };
                        // In a gap between two that cannot be distinguished either may be first.
                        let unknown = (i + 1 == gap && ties(heights.get(gap)))
                            || (i == gap && gap > 0 && ties(heights.get(gap - 1)));
                        sides[a.surface] = match unknown {
                            true => Membership::Surface,
                            false => of_sign(if above { 1.0 } else { -1.0 }),
                        };
                    }
                    if !take(sides) {
                        return;
                    }
                }
            }
        }
    }
}

/// Directions in tangent plane `k`, at least one in each sector into which the others cut it.
fn sectors(planes: &[(Vec3, Vec<&ActiveSurface>)], k: usize, several: bool) -> Vec<Vec3> {
    let n = planes[k].0;
    let u = n.perpendicular();
    let u = u.normalized().unwrap_or(u);
    let v = n.cross(u);
    let mut ends: Vec<f64> = Vec::new();
    for (_, (m, _)) in planes.iter().enumerate().filter(|(j, _)| *j != k) {
        let line = n.cross(*m);
        let angle = libm::atan2(line.dot(v), line.dot(u)).rem_euclid(std::f64::consts::PI);
        ends.extend([angle, angle + std::f64::consts::PI]);
    }
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| (*a - *b).abs() <= 1e-9);
    if ends.is_empty() {
        ends.push(0.1);
    }
    // For touching surfaces the order may change within a sector: irregular fractions, because of
    // symmetric ones.
    let shares: &[f64] = match (several, ends.len()) {
        (false, _) => &[0.5],
        (true, 1) => &[0.031, 0.157, 0.281, 0.409, 0.533, 0.661, 0.787, 0.911],
        (true, _) => &[0.037, 0.267, 0.511, 0.743, 0.961],
    };
    let mut out = Vec::with_capacity(ends.len() * shares.len());
    for (i, &start) in ends.iter().enumerate() {
        let end = ends.get(i + 1).copied().unwrap_or(ends[0] + std::f64::consts::TAU);
        for share in shares {
            let (sin, cos) = libm::sincos(start + share * (end - start));
            out.push(u * cos + v * sin);
        }
    }
    out
}

/// The numbers of a closed form that say which surface it is, whatever side of it is solid; and whether that side is the
/// form's usual one.
fn surface_numbers(f: &Primitive) -> Option<(u8, [f64; 8], bool)> {
    let up = |v: Vec3| {
        let first = v.to_array().into_iter().find(|c| c.abs() > 1e-9).unwrap_or(1.0);
        if first < 0.0 { -v } else { v }
    };
    let line = |a: &Axis<f64>| {
        let d = up(a.direction.normalized()?);
        Some((a.point - d * d.dot(a.point), d))
    };
    let within = solid_within(f)?;
    Some(match f.form() {
        Form::Plane(p) => {
            let n = p.normal.normalized()?;
            let m = up(n);
            let same = m.dot(n) > 0.0;
            (1, [m.x, m.y, m.z, m.dot(p.point), 0.0, 0.0, 0.0, 0.0], within == same)
        }
        Form::Sphere { centre: c, radius } => {
            (2, [c.x, c.y, c.z, *radius, 0.0, 0.0, 0.0, 0.0], within)
        }
        Form::Cylinder { axis, radius } => {
            let (c, d) = line(axis)?;
            (3, [c.x, c.y, c.z, d.x, d.y, d.z, *radius, 0.0], within)
        }
        Form::Cone { axis, angle } => {
            let (c, d) = (axis.point, line(axis)?.1);
            (4, [c.x, c.y, c.z, d.x, d.y, d.z, *angle, 0.0], within)
        }
        Form::Torus { axis, major, minor } => {
            let (c, d) = (axis.point, line(axis)?.1);
            (5, [c.x, c.y, c.z, d.x, d.y, d.z, *major, *minor], within)
        }
        _ => return None,
    })
}

fn near_numbers(a: &[f64; 8], b: &[f64; 8]) -> bool {
    let size = a.iter().chain(b).fold(1.0f64, |m, x| m.max(x.abs()));
    a.iter().zip(b).all(|(x, y)| (x - y).abs() <= ONE_SURFACE * size)
}

pub(crate) fn is_one_surface(a: &Primitive, b: &Primitive) -> bool {
    let (a, b) = (a.of_sheet(), b.of_sheet());
    if a.same(b) || (-a).same(b) || a.same(&-b) {
        return true;
    }
    match (surface_numbers(a), surface_numbers(b)) {
        (Some((k, p, _)), Some((l, q, _))) => k == l && near_numbers(&p, &q),
        _ => false,
    }
}

/// The surfaces of leaves, and how each leaf follows from its own.
pub(crate) fn surfaces_of(leaves: &[Leaf]) -> (Vec<Primitive>, Vec<LeafSide>) {
    /// Weights of the numbers in the sum by which surfaces are looked up: of no two ordinary surfaces alike.
    const WEIGHTS: [f64; 8] = [1.0, 0.737, 1.319, 0.551, 1.173, 0.871, 0.643, 1.471];
    /// The width of a class of sums, of 1 and their size.
    const CLASS: f64 = 1e-9;
    let mut surfaces: Vec<Primitive> = Vec::new();
    let mut numbers: Vec<(u8, [f64; 8], bool)> = Vec::new();
    let mut by_class: FxHashMap<(u8, i64), Vec<u32>> = FxHashMap::default();
    let mut by_tape: FxHashMap<u64, Vec<(u32, bool)>> = FxHashMap::default();
    let mut sides = Vec::with_capacity(leaves.len());
    for leaf in leaves {
        let f = leaf.primitive.of_sheet();
        let sheet = leaf.primitive.is_sheet();
        let outer = sheet && matches!(leaf.primitive.operation(), Op::Unary(Unary::Neg, _));
        if let Some(found) = surface_numbers(f) {
            let (kind, own, usual) = found;
            let sum: f64 = own.iter().zip(WEIGHTS).map(|(x, w)| x * w).sum();
            let size = own.iter().fold(1.0f64, |m, x| m.max(x.abs()));
            // A class of sizes by powers of 2, so that the width follows the size.
            let width = CLASS * libm::exp2(libm::ceil(libm::log2(size)));
            let class = libm::floor(sum / width) as i64;
            let known = [class, class - 1, class + 1].into_iter().find_map(|c| {
                by_class
                    .get(&(kind, c))?
                    .iter()
                    .copied()
                    .find(|&s| near_numbers(&numbers[s as usize].1, &own))
            });
            let surface = known.unwrap_or_else(|| {
                surfaces.push(f.clone());
                numbers.push(found);
                by_class.entry((kind, class)).or_default().push(surfaces.len() as u32 - 1);
                surfaces.len() as u32 - 1
            });
            let flipped = if sheet { outer } else { usual != numbers[surface as usize].2 };
            sides.push(LeafSide { surface, flipped, sheet });
            continue;
        }
        // Any other expression is its own surface, as is its complement.
        let minus = -f;
        let known = [(f, false), (&minus, true)].into_iter().find_map(|(g, turned)| {
            let list = by_tape.get(&g.0.fingerprint)?;
            let found = list.iter().find(|(s, _)| surfaces[*s as usize].same(g))?;
            Some((found.0, turned))
        });
        let (surface, turned) = known.unwrap_or_else(|| {
            surfaces.push(f.clone());
            numbers.push((0, [0.0; 8], true));
            by_tape.entry(f.0.fingerprint).or_default().push((surfaces.len() as u32 - 1, false));
            (surfaces.len() as u32 - 1, false)
        });
        sides.push(LeafSide { surface, flipped: if sheet { outer } else { turned }, sheet });
    }
    (surfaces, sides)
}

impl Set<f64> {
    /// The set with its surfaces, for many queries about its boundary.
    pub fn as_body(&self) -> SurfacedSet {
        SurfacedSet::of(self)
    }
}
