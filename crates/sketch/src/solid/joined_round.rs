//! Round faces on one cylinder, cone, sphere or torus: where parts of faces of different bodies meet they are one face.

use super::arrangement::{ArrangedFace, SurfaceSide};
use super::coincidence::Kink;
use super::curve::SmoothPiece;
use super::facet_source::FacetSource;
use super::revolved::{Meridian, RevolvedSurface, moves};
use super::surface::FaceSurface;
use moldloft_num::{Axis, Real, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

/// Tolerance of one surface, relative to its radius and extent.
const ONE_SURFACE: f64 = 1e-10;

/// Angle in radians from which an arc is a whole circle.
const WHOLE_CIRCLE: f64 = TAU - 1e-9;

/// By face, the surface that it is on and whether its outside is away from the axis, or from the centre of its section;
/// faces that are alone on theirs are left out.
pub(super) fn shared_surfaces<T: Real>(
    sources: &[FacetSource<T>],
    scale: f64,
) -> BTreeMap<(usize, u32), SurfaceSide> {
    let mut found: Vec<(RevolvedSurface<T>, Vec<(usize, u32, bool)>)> = Vec::new();
    for (operand, source) in sources.iter().enumerate() {
        for (tag, surface) in source.surfaces.iter().enumerate() {
            let Some(own) = RevolvedSurface::of(surface) else { continue };
            let half = T::from(0.5);
            let [p, du, dv] = surface.jet(half, half).map(Vec3::re);
            let away = (du.cross(dv).dot(own.away(p)) > 0.0) == source.borders[tag].1;
            let member = (operand, tag as u32, away);
            match found.iter_mut().find(|(one, _)| one_surface(one, &own, scale)) {
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

/// The edges, by operand and tag, between faces of one body on one of these surfaces: they stay.
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

/// True if two surfaces are one with one axis, so that both have parameters in one frame.
fn one_surface<T: Real>(a: &RevolvedSurface<T>, b: &RevolvedSurface<T>, scale: f64) -> bool {
    let (p, d) = (a.axis.point.re(), a.axis.direction.re());
    let by = b.axis.point.re() - p;
    let turned = d.cross(b.axis.direction.re()).norm() * scale;
    let close = |x: f64, y: f64, size: f64| (x - y).abs() <= ONE_SURFACE * size;
    match (a.meridian.re(), b.meridian.re()) {
        (Meridian::Line { radius, slope }, Meridian::Line { radius: s, slope: own }) => {
            let size = radius.max(s);
            let along = d.dot(b.axis.direction.re()).signum();
            by.cross(d).norm().max(turned) <= ONE_SURFACE * size
                && close(radius + slope * d.dot(by), s, size)
                && close(slope * scale, own * along * scale, size)
        }
        (Meridian::Circle { big, small }, Meridian::Circle { big: c, small: s }) => {
            by.norm().max(turned) <= ONE_SURFACE * small
                && close(big, c, small)
                && close(small, s, small)
        }
        _ => false,
    }
}

/// The surface of a face that parts of several faces make, with the extents of all of them; and the parts of the scalar
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
    let base = RevolvedSurface::of(first)?;
    let frame = PatchFrame::of(first, &base)?;
    let (mut extent, mut kinks) = (frame.extent(first)?, Vec::new());
    for other in face.sources[1..].iter().map(surface) {
        let own = RevolvedSurface::of(other)?;
        kinks.extend((1..T::PARTS).filter(|k| parts_from(&base, &own, *k)).map(|part| {
            let at = other.jet(T::from(0.5), T::from(0.5))[0].re();
            Kink { part, at, volume: true }
        }));
        extent = extent.with(&frame.extent(other)?);
    }
    Some((frame.patch(&extent), kinks))
}

/// The parameters of a patch in which the extents of others on its surface are found: angles about the axis from its
/// start, and along the meridian a share of its length or an angle.
enum PatchFrame<T> {
    /// A cylinder or cone: the arc v = 0, the way of its centre to that of v = 1, and the size of that.
    Straight { centre: Vec3<T>, arms: [Vec3<T>; 2], sweep: f64, way: Vec3<T>, scale: T },
    /// A sphere or torus: the axis through its centre, the circle v, the direction of that from the axis and the distance.
    Bent { axis: Axis<T>, profile: [Vec3<T>; 3], sweeps: [f64; 2], out: Vec3, big: f64 },
}

impl<T: Real> PatchFrame<T> {
    fn of(surface: &FaceSurface<T>, round: &RevolvedSurface<T>) -> Option<PatchFrame<T>> {
        match *surface {
            FaceSurface::Ruled { near: SmoothPiece::Conic { centre, a, b, sweep }, far } => {
                let (end, scale) = match far {
                    SmoothPiece::Conic { centre, a: p, .. } => (centre, p.dot(a) / a.norm_sq()),
                    SmoothPiece::Cubic([p, ..]) => (p, T::zero()),
                };
                let (arms, way) = ([a, b], end - centre);
                Some(PatchFrame::Straight { centre, arms, sweep: sweep.re(), way, scale })
            }
            FaceSurface::Turned { profile, sweep, .. } => {
                let SmoothPiece::Conic { centre, a, b, sweep: bend } = profile else { return None };
                let Meridian::Circle { big, .. } = round.meridian else { return None };
                let middle = profile.at(T::from(0.5));
                let out = (middle - round.axis.foot(middle)).re().normalized()?;
                let (profile, sweeps) = ([centre, a, b], [sweep.re(), bend.re()]);
                Some(PatchFrame::Bent { axis: round.axis, profile, sweeps, out, big: big.re() })
            }
            _ => None,
        }
    }

    /// The parameters of a point of the surface.
    fn place(&self, p: Vec3) -> [f64; 2] {
        match self {
            PatchFrame::Straight { centre, arms: [a, b], way, .. } => {
                let (by, way) = (p - centre.re(), way.re());
                let angle = libm::atan2(b.re().dot(by), a.re().dot(by));
                [angle, way.dot(by) / way.norm_sq()]
            }
            PatchFrame::Bent { axis, profile: [_, a, b], out, big, .. } => {
                let (d, by) = (axis.direction.re(), p - axis.point.re());
                let flat = by - d * d.dot(by);
                let turn = libm::atan2(d.cross(*out).dot(flat), out.dot(flat));
                // Turned back into the plane of the profile.
                let own = *out * (flat.norm() - big) + d * d.dot(by);
                [turn, libm::atan2(b.re().dot(own), a.re().dot(own))]
            }
        }
    }

    /// The extent of a patch on the surface.
    fn extent(&self, patch: &FaceSurface<T>) -> Option<PatchExtent> {
        let point = |u: f64, v: f64| self.place(patch.jet(T::from(u), T::from(v))[0].re());
        let middle = point(0.5, 0.5);
        match (self, patch) {
            (PatchFrame::Straight { sweep, .. }, FaceSurface::Ruled { near, .. }) => {
                let SmoothPiece::Conic { sweep: own, .. } = near else { return None };
                let angles = ArcRange::about(middle[0], own.re().abs(), *sweep);
                // Shares of the meridian are linear in each other.
                let ends = [0.0, 1.0].map(|v| point(0.5, v)[1]);
                let along = ArcRange { low: ends[0].min(ends[1]), high: ends[0].max(ends[1]) };
                Some(PatchExtent { angles, along, bent: false })
            }
            (
                PatchFrame::Bent { sweeps: [turn, bend], .. },
                FaceSurface::Turned {
                    profile: SmoothPiece::Conic { sweep: own, .. }, sweep, ..
                },
            ) => Some(PatchExtent {
                angles: ArcRange::about(middle[0], sweep.re().abs(), *turn),
                along: ArcRange::about(middle[1], own.re().abs(), *bend),
                bent: true,
            }),
            _ => None,
        }
    }

    /// The patch of an extent.
    fn patch(&self, extent: &PatchExtent) -> FaceSurface<T> {
        match self {
            PatchFrame::Straight { centre, arms: [a, b], sweep, way, scale } => {
                let [from, to] = extent.angles.ends(*sweep);
                let arc = |v: f64| {
                    let share = T::from(v);
                    let at = *centre + *way * share;
                    let size = T::one() + (*scale - T::one()) * share;
                    if size.re() <= ONE_SURFACE {
                        return SmoothPiece::Cubic([at; 4]);
                    }
                    let (c, s) = (T::from(libm::cos(from)), T::from(libm::sin(from)));
                    let (a, b) = ((*a * c + *b * s) * size, (*b * c - *a * s) * size);
                    SmoothPiece::Conic { centre: at, a, b, sweep: T::from(to - from) }
                };
                let [near, far] = [arc(extent.along.low), arc(extent.along.high)];
                match near {
                    // An apex is the end of its rulings.
                    SmoothPiece::Cubic(_) => FaceSurface::Ruled { near: far, far: near },
                    SmoothPiece::Conic { .. } => FaceSurface::Ruled { near, far },
                }
            }
            PatchFrame::Bent { axis, profile: [centre, a, b], sweeps, .. } => {
                let [from, to] = extent.angles.ends(sweeps[0]);
                let [start, end] = extent.along.ends(sweeps[1]);
                let [c, s] = [libm::cos(start), libm::sin(start)].map(T::from);
                let turn = |p: Vec3<T>| axis.rotated(p, T::from(from));
                let middle = turn(*centre);
                let arm = |r: Vec3<T>| turn(*centre + r) - middle;
                let profile = SmoothPiece::Conic {
                    centre: middle,
                    a: arm(*a * c + *b * s),
                    b: arm(*b * c - *a * s),
                    sweep: T::from(end - start),
                };
                let (centre, axis, sweep) = (axis.point, axis.direction, T::from(to - from));
                FaceSurface::Turned { centre, axis, profile, sweep }
            }
        }
    }
}

/// A range of angles in radians, or of shares.
#[derive(Clone, Copy)]
struct ArcRange {
    low: f64,
    high: f64,
}

impl ArcRange {
    /// An arc by its middle and size; that of a sweep from 0 is exact.
    fn about(middle: f64, size: f64, sweep: f64) -> ArcRange {
        let (low, high) = (middle - size / 2.0, middle + size / 2.0);
        let known = [0.0, sweep];
        let near = |x: f64| {
            let known = known.iter().find(|k| (*k - x).abs() <= ONE_SURFACE);
            known.copied().unwrap_or(x)
        };
        ArcRange { low: near(low), high: near(high) }
    }

    /// The least that holds an arc too, turned by whole turns.
    fn with_arc(self, other: ArcRange) -> ArcRange {
        let turned = |turns: i32| {
            let by = TAU * f64::from(turns);
            ArcRange { low: self.low.min(other.low + by), high: self.high.max(other.high + by) }
        };
        let size = |r: &ArcRange| r.high - r.low;
        let best = (-2..=2).map(turned).min_by(|a, b| size(a).total_cmp(&size(b)));
        let mut out = best.unwrap_or(self);
        if size(&out) >= WHOLE_CIRCLE {
            out.high = out.low + TAU;
        }
        let near = |x: f64, own: f64| if (x - own).abs() <= ONE_SURFACE { own } else { x };
        ArcRange { low: near(out.low, self.low), high: near(out.high, self.high) }
    }

    /// Start and end in the sense of a sweep.
    fn ends(self, sweep: f64) -> [f64; 2] {
        if sweep < 0.0 { [self.high, self.low] } else { [self.low, self.high] }
    }
}

/// Part of a round surface in the parameters of a frame.
struct PatchExtent {
    angles: ArcRange,
    along: ArcRange,
    /// True if the meridian is a circle.
    bent: bool,
}

impl PatchExtent {
    fn with(&self, other: &PatchExtent) -> PatchExtent {
        let along = match self.bent {
            true => self.along.with_arc(other.along),
            false => ArcRange {
                low: self.along.low.min(other.along.low),
                high: self.along.high.max(other.along.high),
            },
        };
        PatchExtent { angles: self.angles.with_arc(other.angles), along, bent: self.bent }
    }
}

/// True if two surfaces that are one move differently in a part.
fn parts_from<T: Real>(a: &RevolvedSurface<T>, b: &RevolvedSurface<T>, k: usize) -> bool {
    let by = b.axis.point - a.axis.point;
    let apart = b.axis.point - a.axis.foot(b.axis.point);
    let turned = a.axis.direction.cross(b.axis.direction);
    let differ = |lengths: &[T]| lengths.iter().any(|x| moves(x.part(k), 1.0));
    match (a.meridian, b.meridian) {
        (Meridian::Line { radius, slope }, Meridian::Line { radius: s, slope: own }) => {
            let along = a.axis.direction.re().dot(b.axis.direction.re()).signum();
            let level = a.axis.direction.dot(by);
            differ(&apart.to_array())
                || differ(&turned.to_array())
                || differ(&[radius + slope * level - s, slope - own * along])
        }
        (Meridian::Circle { big, small }, Meridian::Circle { big: c, small: s }) => {
            // The axis of a sphere does not matter.
            let torus = big.re() > 0.0;
            differ(&by.to_array())
                || differ(&[big - c, small - s])
                || (torus && differ(&turned.to_array()))
        }
        _ => true,
    }
}
