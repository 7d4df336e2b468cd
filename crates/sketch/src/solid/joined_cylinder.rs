//! Round faces on one cylinder: where parts of faces of different bodies meet they are one face.

use super::arrangement::{ArrangedFace, SurfaceSide};
use super::coincidence::Kink;
use super::curve::SmoothPiece;
use super::facet_source::{FacetSource, moves};
use super::meeting::{RoundCylinder, round_cylinder};
use super::surface::FaceSurface;
use moldloft_num::{Real, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

/// Tolerance of one cylinder, relative to its radius and extent.
const ONE_CYLINDER: f64 = 1e-10;

/// Angle in radians from which an arc is a whole circle.
const WHOLE_CIRCLE: f64 = TAU - 1e-9;

/// By face, the cylinder that it is on and whether its outside is away from the axis; faces that are alone on theirs
/// are left out.
pub(super) fn shared_cylinders<T: Real>(
    sources: &[FacetSource<T>],
    scale: f64,
) -> BTreeMap<(usize, u32), SurfaceSide> {
    let mut found: Vec<(RoundCylinder<T>, Vec<(usize, u32, bool)>)> = Vec::new();
    for (operand, source) in sources.iter().enumerate() {
        for (tag, surface) in source.surfaces.iter().enumerate() {
            let Some(own) = round_cylinder(surface) else { continue };
            let half = T::from(0.5);
            let [p, du, dv] = surface.jet(half, half).map(Vec3::re);
            let radial = p - own.axis.point.re();
            let away = (du.cross(dv).dot(radial) > 0.0) == source.borders[tag].1;
            let member = (operand, tag as u32, away);
            match found.iter_mut().find(|(one, _)| one_cylinder(one, &own, scale)) {
                Some((_, members)) => members.push(member),
                None => found.push((own, vec![member])),
            }
        }
    }
    let shared = found.into_iter().filter(|(_, members)| members.len() > 1).enumerate();
    let sides = shared.flat_map(|(number, (_, members))| {
        let side = move |away| SurfaceSide { surface: number, positive: away };
        members.into_iter().map(move |(operand, tag, away)| ((operand, tag), side(away)))
    });
    sides.collect()
}

/// The edges, by operand and tag, between faces of one body on one of these cylinders: they stay.
pub(super) fn seams<T: Real>(
    sources: &[FacetSource<T>],
    shared: &BTreeMap<(usize, u32), SurfaceSide>,
) -> BTreeSet<(usize, u32)> {
    let mut out = BTreeSet::new();
    for (operand, source) in sources.iter().enumerate() {
        for (tag, (_, beside)) in source.edges.iter().enumerate() {
            let [a, b] = beside[..] else { continue };
            let side = |face| shared.get(&(operand, face));
            if side(a).is_some() && side(a) == side(b) {
                out.insert((operand, tag as u32));
            }
        }
    }
    out
}

fn one_cylinder<T: Real>(a: &RoundCylinder<T>, b: &RoundCylinder<T>, scale: f64) -> bool {
    let tolerance = ONE_CYLINDER * a.radius.re();
    let (p, d) = (a.axis.point.re(), a.axis.direction.re());
    let apart = (b.axis.point.re() - p).cross(d).norm();
    let turned = d.cross(b.axis.direction.re()).norm() * scale;
    (a.radius - b.radius).re().abs() <= tolerance && apart <= tolerance && turned <= tolerance
}

/// The cylinder of a face that parts of several faces make, with the extents of all of them; and the parts of the scalar
/// in which they move differently.
pub(super) fn joined_surface<T: Real>(
    face: &ArrangedFace,
    sources: &[FacetSource<T>],
) -> Option<(FaceSurface<T>, Vec<Kink>)> {
    if face.plane || face.sources.len() < 2 {
        return None;
    }
    let surface = |&(operand, tag): &(usize, u32)| &sources[operand].surfaces[tag as usize];
    let first = surface(&face.sources[0]);
    let base = round_cylinder(first)?;
    let FaceSurface::Ruled { near: SmoothPiece::Conic { centre, a, b, sweep }, far } = *first
    else {
        return None;
    };
    let SmoothPiece::Conic { centre: end, .. } = far else { return None };
    let (mut extent, mut kinks) =
        (PatchExtent { levels: [0.0, 1.0], angles: [0.0, sweep.re()] }, Vec::new());
    let way = (end - centre).re();
    let level = |p: Vec3| way.dot(p - centre.re()) / way.norm_sq();
    let angle = |p: Vec3| libm::atan2(b.re().dot(p - centre.re()), a.re().dot(p - centre.re()));
    for other in face.sources[1..].iter().map(surface) {
        let own = round_cylinder(other)?;
        kinks.extend((1..T::PARTS).filter(|k| parts_from(&base, &own, *k)).map(|part| {
            let at = other.jet(T::from(0.5), T::from(0.5))[0].re();
            Kink { part, at, volume: true }
        }));
        let corner = |u: f64, v: f64| other.jet(T::from(u), T::from(v))[0].re();
        for v in [0.0, 1.0] {
            extent.levels[0] = extent.levels[0].min(level(corner(0.0, v)));
            extent.levels[1] = extent.levels[1].max(level(corner(0.0, v)));
        }
        let FaceSurface::Ruled { near: SmoothPiece::Conic { sweep, .. }, .. } = other else {
            return None;
        };
        let (middle, half) = (angle(corner(0.5, 0.0)), sweep.re().abs() / 2.0);
        extent.add_arc(middle, half);
    }
    let [from, to] = extent.angles;
    let whole = (to - from).abs() >= WHOLE_CIRCLE;
    let (from, to) = if whole { (from, from + TAU.copysign(to - from)) } else { (from, to) };
    let kept = extent.angles == [0.0, sweep.re()];
    let arc = |v: f64| {
        let centre = centre + (end - centre) * T::from(v);
        if kept {
            return SmoothPiece::Conic { centre, a, b, sweep };
        }
        let (c, s) = (T::from(libm::cos(from)), T::from(libm::sin(from)));
        let (a, b) = (a * c + b * s, b * c - a * s);
        SmoothPiece::Conic { centre, a, b, sweep: T::from(to - from) }
    };
    let [low, high] = extent.levels;
    Some((FaceSurface::Ruled { near: arc(low), far: arc(high) }, kinks))
}

/// Part of a cylinder: along the axis by the first face's length, and by angles from its start in its sense.
struct PatchExtent {
    levels: [f64; 2],
    angles: [f64; 2],
}

impl PatchExtent {
    /// Makes it hold an arc, turned by whole turns to where least is added.
    fn add_arc(&mut self, middle: f64, half: f64) {
        let [from, to] = self.angles;
        let sign = if to < from { -1.0 } else { 1.0 };
        let [low, high] = if sign < 0.0 { [to, from] } else { [from, to] };
        let with = |turns: i32| {
            let at = middle + TAU * f64::from(turns);
            [low.min(at - half), high.max(at + half)]
        };
        let all = (-2..=2).map(with);
        let [low, high] =
            all.min_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0]))).unwrap_or([low, high]);
        let high = high.min(low + TAU);
        // Equal ends stay what they are.
        let near = |x: f64, old: f64| if (x - old).abs() <= ONE_CYLINDER { old } else { x };
        let ends = if sign < 0.0 { [high, low] } else { [low, high] };
        self.angles = [near(ends[0], from), near(ends[1], to)];
    }
}

/// True if two equal cylinders move differently in a part.
fn parts_from<T: Real>(a: &RoundCylinder<T>, b: &RoundCylinder<T>, k: usize) -> bool {
    let apart = b.axis.point - a.axis.foot(b.axis.point);
    let turned = a.axis.direction.cross(b.axis.direction);
    let lengths = apart.to_array().into_iter().chain(turned.to_array());
    lengths.chain([a.radius - b.radius]).any(|x| moves(x.part(k), 1.0))
}
