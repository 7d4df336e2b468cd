//! Parts of surfaces between snakes and magnets.

use super::corners;
use super::masters::along;
use crate::arguments::{Side, Snake, common_surface};
use crate::curve::Segment;
use crate::seam;
use crate::snake::{edge_trace, on_surface};
use moldloft_num::period::within;
use moldloft_num::trace::{Edge, Edges, Key, Mark, Root, Trace};
use moldloft_num::{
    Bi1, InnerPlane, Jet, Order, Real, SurfJet, Surface, Vec3, lift_curve, line_crossings,
    surface_jet_of,
};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, FieldId, Kind, SurfacePart, SurfaceRef, Value,
};

/// The part of a surface between snakes and magnets on it: S(u, v) = P(w(u, v)), with P the surface
/// and w a patch of its parameter plane.
///
/// Two sides w1, w2 are edges v = 0 and v = 1: w = (1 - v) w1(u) + v w2(u). Four sides are the
/// edges v = 0, u = 1, v = 1, u = 0 in this order, each in increasing parameter (the third and the
/// fourth are therefore opposite to a walk round the patch); w is the bilinear Coons patch (Coons
/// 1967). Three sides: the same, with the edge u = 0 reduced to the point at which the first and
/// the third begin. A magnet is a side of zero length. Sides that do not meet are errors, never
/// reversed; so are folded patches. Two sides that each begin and end at one point, or at the seam
/// of a closed surface, bound a closed band; a closed snake and a magnet inside it, a cap.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "sides",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsMagnet p(S, 0.1, 0.2); AbsMagnet q(S, 0.9, 0.1); AbsMagnet r(S, 0.8, 0.9); \
               AbsMagnet s(S, 0.2, 0.7); AbsMagnet t(S, 0.5, 0.3); BSnake south({p, t, q}); \
               LineSnake east(q, r); LineSnake north(s, r); LineSnake west(p, s); \
               LineSnake middle(p, r); SubSurf part({south, east, north, west}); \
               SubSurf half({south, north}, visible = 0); SubSurf fan({south, r}, visible = 0); \
               SubSurf three({south, east, middle}, visible = 0);"
)]
pub struct SubSurf<T: Real> {
    /// Two, three or four snakes and magnets of one surface.
    #[field(min_items = 2)]
    sides: Vec<Side<T>>,
}

/// Maximum distance in u or v between ends at a corner: far below a panel, far above rounding.
const MEETING: f64 = 1e-6;

impl<T: Real> Build<T> for SubSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let sides = self.sides;
        if !(2..=4).contains(&sides.len()) {
            return Err(CallError::new("wrong-length", "a sub-surface has 2, 3 or 4 sides")
                .expected("2, 3 or 4 snakes and magnets")
                .found(sides.len().to_string())
                .in_field(Self::SIDES));
        }
        let keys = |side: &Side<T>| match side {
            Side::Snake(snake) => snake.curve.key,
            Side::Magnet(magnet) => magnet.key,
        };
        let items: Vec<_> = sides.iter().map(|side| (keys(side), side.surface())).collect();
        let surface = common_surface(&items, |fault, k| fault.in_item(k).in_field(Self::SIDES))?;
        if sides.iter().all(|side| matches!(side, Side::Magnet(_))) {
            return Err(CallError::new("no-area", "a sub-surface needs a side with length")
                .expected("at least one snake")
                .found("magnets only")
                .in_field(Self::SIDES));
        }
        let shape = match <[Side<T>; 2]>::try_from(sides) {
            Ok(ends) => SubPatch::cap(surface, ends),
            Err(sides) => {
                check_corners(&sides, Self::SIDES)?;
                let (south, north) = (&sides[0], &sides[2]);
                let corners = [end(south, 0.0), end(south, 1.0), end(north, 0.0), end(north, 1.0)];
                let turns = [SeamTurns::default(), SeamTurns::default()];
                SubPatch { surface, layout: SideLayout::Round(sides), turns, corners }
            }
        };
        shape.check_folds()?;
        let part = shape.part();
        Ok(Value::Surface(SurfaceRef::new(shape, context.nesting).with_part_of(part)))
    }
}

/// Sides of a patch and their arrangement.
// A patch has one of them: a box would save nothing.
#[allow(clippy::large_enum_variant)]
enum SideLayout<T: Real> {
    /// Edges v = 0 and v = 1.
    Between([Side<T>; 2]),
    /// Edges v = 0, u = 1, v = 1 and, unless it is a point, u = 0.
    Round(Vec<Side<T>>),
}

pub struct SubPatch<T: Real> {
    surface: SurfaceRef<T>,
    layout: SideLayout<T>,
    /// The turns by which the edges v = 0 and v = 1 go on across seams, of a patch between two sides.
    turns: [SeamTurns; 2],
    /// The corners of the patch: the ends of the edge v = 0, then those of v = 1.
    corners: [Vec3<T>; 4],
}

/// The point (u, v, 0) of the surface at the parameter `t` of a side.
fn place<T: Real, J: Jet<T>>(side: &Side<T>, t: J) -> Vec3<J> {
    match side {
        Side::Snake(snake) => lift_curve(&snake.path(t.value(), J::ORDER), t),
        Side::Magnet(magnet) => {
            let [u, v] = magnet.uv;
            Vec3::new(J::fixed(u), J::fixed(v), J::zero())
        }
    }
}

/// True for a side that ends in the point in which it begins, by identity.
fn closes_by_name<T: Real>(side: &Side<T>) -> bool {
    let Side::Snake(Snake { curve, .. }) = side else { return true };
    let one = |curve: &CurveRef<T>| matches!(curve.end_points(), [Some(a), Some(b)] if a == b);
    let whole = curve.part_of.as_ref().is_some_and(|part| {
        let [from, to] = part.1.map(|t| t.re());
        (to - from).abs() == 1.0 && one(&part.0)
    });
    one(curve) || whole
}

/// A crossing of the seam of a closed surface by a side.
struct SeamCrossing {
    t: f64,
    /// Its parameters there, continued from its beginning.
    at: [f64; 2],
    /// The turns to add before and after it.
    before: [f64; 2],
    after: [f64; 2],
}

/// The whole turns that continue the parameters of a side beyond the seams of a closed surface, where they jump.
#[derive(Default)]
struct SeamTurns {
    crossings: Vec<SeamCrossing>,
    /// Turns at the beginning.
    base: [f64; 2],
}

/// Distance in t within which a parameter may be on either side of a seam.
const NEAR_SEAM: f64 = 1e-7;

impl SeamTurns {
    /// The turns of both sides of a patch; those of the second side begin nearest to the first.
    fn of_band<T: Real>(surface: &SurfaceRef<T>, sides: &[Side<T>; 2]) -> [Self; 2] {
        let closed = surface.closed();
        if closed == [false; 2] {
            return [Self::default(), Self::default()];
        }
        let [first, mut last] = sides.each_ref().map(|side| Self::of(side, closed));
        let place = |k: usize, t: f64| {
            let turns: &Self = [&first, &last][k];
            let w = end(&sides[k], t).re().to_array();
            let by = turns.shift(t, [w[0], w[1]]);
            [w[0] + by[0], w[1] + by[1]]
        };
        let mut base = [0.0; 2];
        for a in 0..2 {
            let ways = [0, 1].map(|k| place(k, 1.0)[a] - place(k, 0.0)[a]);
            let jumps = !(first.crossings.is_empty() && last.crossings.is_empty());
            let round = ways[0].round() != 0.0 && ways[0].round() == ways[1].round();
            if closed[a] && jumps && round {
                base[a] = (place(0, 0.0)[a] - place(1, 0.0)[a]).round();
            }
        }
        last.base = base;
        for crossing in &mut last.crossings {
            for a in 0..2 {
                crossing.at[a] += base[a];
                crossing.before[a] += base[a];
                crossing.after[a] += base[a];
            }
        }
        [first, last]
    }

    fn of<T: Real>(side: &Side<T>, closed: [bool; 2]) -> Self {
        let Side::Snake(snake) = side else { return Self::default() };
        let mut all = Self::default();
        let mut turns = [0.0; 2];
        let breaks = snake.curve.breaks();
        for t in breaks.into_iter().filter(|t| *t > NEAR_SEAM && *t < 1.0 - NEAR_SEAM) {
            let [a, b] = [-1.0, 1.0].map(|s| end(side, t + s * NEAR_SEAM).re().to_array());
            let jump = [0, 1].map(|k| if closed[k] { (a[k] - b[k]).round() } else { 0.0 });
            if jump == [0.0; 2] {
                continue;
            }
            let before = turns;
            turns = [0, 1].map(|k| turns[k] + jump[k]);
            let at = [0, 1].map(|k| {
                let x = a[k] + before[k];
                if jump[k] == 0.0 { x } else { x.round() }
            });
            all.crossings.push(SeamCrossing { t, at, before, after: turns });
        }
        all
    }

    /// The turns to add to the parameters `w` at `t`.
    fn shift(&self, t: f64, w: [f64; 2]) -> [f64; 2] {
        let mut turns = self.base;
        for crossing in &self.crossings {
            if t > crossing.t + NEAR_SEAM {
                turns = crossing.after;
            } else if t >= crossing.t - NEAR_SEAM {
                let off = |by: [f64; 2]| {
                    (0..2).map(|k| (w[k] + by[k] - crossing.at[k]).abs()).fold(0.0, f64::max)
                };
                let later = off(crossing.after) < off(crossing.before);
                turns = if later { crossing.after } else { crossing.before };
            }
        }
        turns
    }
}

fn end<T: Real>(side: &Side<T>, t: f64) -> Vec3<T> {
    place(side, T::from(t))
}

fn check_corners<T: Real>(sides: &[Side<T>], field: FieldId) -> Result<(), CallError> {
    let ends: Vec<[Vec3<f64>; 2]> =
        sides.iter().map(|side| [0.0, 1.0].map(|t| end(side, t).re())).collect();
    let apart = |p: Vec3<f64>, q: Vec3<f64>| (p.x - q.x).abs().max((p.y - q.y).abs());
    let says = |p: Vec3<f64>| format!("(u, v) = ({}, {})", p.x, p.y);
    corners::check(&ends, MEETING, apart, says, field)
}

/// Steps per direction of the test for folds.
const TRIALS: usize = 8;

impl<T: Real> SubPatch<T> {
    /// The patch between two sides of a surface.
    pub fn cap(surface: SurfaceRef<T>, sides: [Side<T>; 2]) -> Self {
        let turns = SeamTurns::of_band(&surface, &sides);
        Self { surface, layout: SideLayout::Between(sides), turns, corners: [Vec3::zero(); 4] }
    }

    /// The parent surface.
    pub fn surface(&self) -> &SurfaceRef<T> {
        &self.surface
    }

    /// The surface and the sides on it; `None` for a patch that continues beyond its seams.
    fn part(&self) -> Option<SurfacePart<T>> {
        let snake = |side: &Side<T>| match side {
            Side::Snake(snake) => Some(snake.curve.clone()),
            Side::Magnet(_) => None,
        };
        let straight = |sides: &[Side<T>; 2], t: f64| {
            let [from, to] = [0, 1].map(|k| end(&sides[k], t));
            let apart = |x: T, y: T| x.re() != y.re();
            let path = Segment { from, to };
            (apart(from.x, to.x) || apart(from.y, to.y)).then(|| on_surface(&self.surface, path))
        };
        let plain = |turns: &SeamTurns| turns.crossings.is_empty() && turns.base == [0.0; 2];
        let sides = match &self.layout {
            SideLayout::Between(_) if !self.turns.iter().all(plain) => return None,
            SideLayout::Between(sides) => {
                [snake(&sides[0]), straight(sides, 1.0), snake(&sides[1]), straight(sides, 0.0)]
            }
            SideLayout::Round(sides) => {
                [Some(&sides[0]), Some(&sides[1]), Some(&sides[2]), sides.get(3)]
                    .map(|side| side.and_then(snake))
            }
        };
        Some(SurfacePart { surface: self.surface.clone(), sides })
    }

    /// The parameters on the surface.
    pub fn inside<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        self.blended(u, v, self.along_u(u), self.along_v(v))
    }

    /// Parameters on the edges v = 0 and v = 1.
    fn along_u<J: Jet<T>>(&self, u: J) -> [Vec3<J>; 2] {
        match &self.layout {
            SideLayout::Between(sides) => [0, 1].map(|k| self.turned(&sides[k], k, u)),
            SideLayout::Round(sides) => [place(&sides[0], u), place(&sides[2], u)],
        }
    }

    /// The point at `t` of side `k` of a patch between two sides.
    fn turned<J: Jet<T>>(&self, side: &Side<T>, k: usize, t: J) -> Vec3<J> {
        let mut w = place(side, t);
        if !self.turns[k].crossings.is_empty() || self.turns[k].base != [0.0; 2] {
            let plain = w.map(|x| x.value().re());
            let [u, v] = self.turns[k].shift(t.value().re(), [plain.x, plain.y]);
            w.x = w.x + u;
            w.y = w.y + v;
        }
        w
    }

    /// Parameters on the edges u = 0 and u = 1 of a patch with sides there.
    fn along_v<J: Jet<T>>(&self, v: J) -> [Vec3<J>; 2] {
        match &self.layout {
            SideLayout::Between(_) => [Vec3::zero(); 2],
            SideLayout::Round(sides) => {
                let west = match sides.get(3) {
                    Some(west) => place(west, v),
                    None => self.corners[0].map(J::fixed),
                };
                [west, place(&sides[1], v)]
            }
        }
    }

    /// Parameters inside, from those on the edges at its u and v.
    fn blended<J: Jet<T>>(
        &self,
        u: J,
        v: J,
        [south, north]: [Vec3<J>; 2],
        [west, east]: [Vec3<J>; 2],
    ) -> Vec3<J> {
        let (a, b) = (-u + 1.0, -v + 1.0);
        let across = south * b + north * v;
        if matches!(self.layout, SideLayout::Between(_)) {
            return across;
        }
        let [p, q, r, s] = self.corners.map(|p| p.map(J::fixed));
        let along = west * a + east * u;
        let (low, high) = (p * a + q * u, r * a + s * u);
        across + along - (low * b + high * v)
    }

    fn position<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        let w = self.inside(u, v);
        self.surface.at(w.x, w.y)
    }
}

/// Maximum difference of the other parameter between the ends of a side that meet at a seam.
const AT_SEAM: f64 = 1e-9;

impl<T: Real> SubPatch<T> {
    /// True if both sides are closed: at one point, or around the seam of a closed surface.
    pub fn is_closed(&self) -> bool {
        let SideLayout::Between(sides) = &self.layout else { return false };
        let round = seam::joined_sides(&self.surface);
        let spans = [0, 1]
            .map(|k| [0.0, 1.0].map(|t| self.turned(&sides[k], k, T::from(t)).re().to_array()));
        let way = |k: usize, a: usize| spans[k][1][a] - spans[k][0][a];
        let meets = |a: usize| {
            let (first, last) = (way(0, a), way(1, a));
            let turn = if round[a] { first.round().clamp(-1.0, 1.0) } else { 0.0 };
            (first - turn).abs().max((last - turn).abs()) <= AT_SEAM
        };
        let on_edge = |x: f64| x == 0.0 || x == 1.0;
        // From the seam to the seam, which is one line.
        let at_seam = |k: usize| {
            (0..2).any(|a| {
                round[a] && spans[k].iter().all(|w| on_edge(w[a])) && way(k, a).abs() == 1.0
            })
        };
        meets(0) && meets(1) && (0..2).all(|k| closes_by_name(&sides[k]) || at_seam(k))
    }

    /// Error for a patch with a folded parameter plane: det(w_u, w_v) must not change its sign.
    pub fn check_folds(&self) -> Result<(), CallError> {
        let mut all = Vec::with_capacity((TRIALS + 1) * (TRIALS + 1));
        let at = |k: usize| T::from(k as f64 / TRIALS as f64);
        let sides: Vec<_> = (0..=TRIALS)
            .map(|k| {
                let (s, t) = Bi1::parameters(at(k), at(k));
                (self.along_u(s), self.along_v(t))
            })
            .collect();
        for (i, j) in (0..=TRIALS).flat_map(|i| (0..=TRIALS).map(move |j| (i, j))) {
            let (u, v) = (i as f64 / TRIALS as f64, j as f64 / TRIALS as f64);
            let (s, t) = Bi1::parameters(at(i), at(j));
            let w = self.blended(s, t, sides[i].0, sides[j].1);
            let det = w.x.u.re() * w.y.v.re() - w.x.v.re() * w.y.u.re();
            all.push((det, u, v));
        }
        let by_size = |a: &&(f64, f64, f64), b: &&(f64, f64, f64)| a.0.total_cmp(&b.0);
        let (Some(low), Some(high)) = (all.iter().min_by(by_size), all.iter().max_by(by_size))
        else {
            return Ok(());
        };
        // The opposite orientation of the surface is not a fold: then all signs are negative.
        let sum: f64 = all.iter().map(|x| x.0).sum();
        let (worst, best) = if sum < 0.0 { (high, -low.0) } else { (low, high.0) };
        let against = if sum < 0.0 { -worst.0 } else { worst.0 };
        if against >= -1e-6 * best {
            return Ok(());
        }
        let (u, v) = (worst.1, worst.2);
        let at = self.inside(T::from(u), T::from(v)).re();
        Err(CallError::new("folded-patch", format!("the sub-surface is folded at u = {u}, v = {v}"))
            .expected("sides that bound an area without crossing each other")
            .found(format!(
                "a Jacobian of {against:.3e} there, at (u, v) = ({}, {}) of the surface, and up to {best:.3e} elsewhere",
                at.x, at.y
            ))
            .help("run opposite sides in the same direction, without crossings")
            .in_field(SubSurf::<T>::SIDES))
    }
}

impl<T: Real> Surface<T> for SubPatch<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        surface_jet_of!(self, Self::position, u, v, order)
    }

    /// As for single points, with the sides evaluated once per row and column.
    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        normals: Option<&mut [Vec3<T>]>,
    ) {
        if let Some(normals) = normals {
            let rows: Vec<_> =
                us.iter().map(|&u| Bi1::parameters(T::from(u), T::zero()).0).collect();
            let columns: Vec<_> =
                vs.iter().map(|&v| Bi1::parameters(T::zero(), T::from(v)).1).collect();
            let along_v: Vec<_> = columns.iter().map(|&v| self.along_v(v)).collect();
            for (i, &u) in rows.iter().enumerate() {
                let along_u = self.along_u(u);
                for (j, &v) in columns.iter().enumerate() {
                    let w = self.blended(u, v, along_u, along_v[j]);
                    let x = self.surface.at(w.x, w.y);
                    let jet = SurfJet {
                        p: x.map(|a| a.f),
                        u: x.map(|a| a.u),
                        v: x.map(|a| a.v),
                        ..SurfJet::default()
                    };
                    points[i * vs.len() + j] = jet.p;
                    normals[i * vs.len() + j] = jet.normal();
                }
            }
            return;
        }
        let along_v: Vec<_> = vs.iter().map(|&v| self.along_v(T::from(v))).collect();
        for (i, &u) in us.iter().enumerate() {
            let along_u = self.along_u(T::from(u));
            for (j, &v) in vs.iter().enumerate() {
                let w = self.blended(T::from(u), T::from(v), along_u, along_v[j]);
                points[i * vs.len() + j] = self.surface.jet(w.x, w.y, Order::Zero).p;
            }
        }
    }

    /// As for single points; the surface is evaluated at all points at once.
    fn scattered(&self, uv: &[[f64; 2]], out: &mut [Vec3<T>]) {
        let inside = |&[u, v]: &[f64; 2]| self.inside(T::from(u), T::from(v));
        if T::PARTS == 1 {
            let places: Vec<[f64; 2]> =
                uv.iter().map(inside).map(|w| [w.x.re(), w.y.re()]).collect();
            return self.surface.scattered(&places, out);
        }
        for (out, uv) in out.iter_mut().zip(uv) {
            let w = inside(uv);
            *out = self.surface.jet(w.x, w.y, Order::Zero).p;
        }
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        self.merged(|curve| curve.breaks())
    }

    fn kinks(&self) -> [Vec<f64>; 2] {
        self.merged(|curve| curve.kinks())
    }

    /// Crossings with lines of the patch and of the surface across it.
    fn crossings(&self, path: &dyn Fn(f64) -> [f64; 2], spans: &[f64]) -> Vec<f64> {
        let own = line_crossings(&self.breaks(), path, spans);
        let mut finer = spans.to_vec();
        finer.extend(&own);
        finer.sort_by(f64::total_cmp);
        finer.dedup();
        let inside = |t: f64| {
            let [u, v] = path(t);
            let w = self.inside(T::from(u), T::from(v));
            [w.x.re(), w.y.re()]
        };
        let mut all = self.surface.crossings(&inside, &finer);
        all.extend(own);
        all
    }

    /// Inner planes of the surface, as those of a part of it.
    fn inner_planes(&self) -> Vec<InnerPlane<'_>> {
        let inside = |[u, v]: [f64; 2]| {
            let w = self.inside(T::from(u), T::from(v));
            [w.x.re(), w.y.re()]
        };
        let closed = self.surface.closed();
        let own = InnerPlane {
            place: Box::new(inside),
            joints: self.surface.joints(),
            kinks: self.surface.kinks(),
            closed,
        };
        let through = move |w| within(closed, inside(w));
        let outer = self.surface.inner_planes().into_iter().map(|plane| plane.through(through));
        std::iter::once(own).chain(outer).collect()
    }

    /// A side by default: the surface and the end points of the straight line in its parameter
    /// plane.
    fn edge_made_of(&self, k: usize) -> Vec<Key> {
        let SideLayout::Between([first, last]) = &self.layout else { return Vec::new() };
        if k.is_multiple_of(2) {
            return Vec::new();
        }
        let end = usize::from(k == 1);
        [self.surface.key, ends(first)[end], ends(last)[end]].into_iter().flatten().collect()
    }

    fn edges(&self) -> Edges<T> {
        match &self.layout {
            SideLayout::Between([first, last]) => {
                let ([a, b], [d, c]) = (ends(first), ends(last));
                let across = |p: Option<Key>, q: Option<Key>, end: f64| {
                    let pole = p.is_some() && p == q;
                    if pole { Edge::Pole(p) } else { self.implied([first, last], [p, q], end) }
                };
                let east = if self.is_closed() { Edge::SameAs(3) } else { across(b, c, 1.0) };
                Edges {
                    edges: [edge(first), east, edge(last), across(a, d, 0.0)],
                    corners: [a, b, c, d],
                }
            }
            SideLayout::Round(sides) => {
                let known: Vec<Option<Key>> = corners::of(sides.len())
                    .iter()
                    .map(|&[(a, s), (b, t)]| ends(&sides[a])[s].or(ends(&sides[b])[t]))
                    .collect();
                let [b, c, d, a] = [known[0], known[1], known[2], known[known.len() - 1]];
                let west = sides.get(3).map_or(Edge::Pole(a), edge);
                Edges {
                    edges: [edge(&sides[0]), edge(&sides[1]), edge(&sides[2]), west],
                    corners: [a, b, c, d],
                }
            }
        }
    }

    fn joints(&self) -> [Vec<f64>; 2] {
        self.merged(|curve| curve.joints())
    }

    moldloft_num::surface_facts!(open, not_rational);
    moldloft_num::surface_one_by_one!(T: line);
}

impl<T: Real> SubPatch<T> {
    /// Parameters collected from the sides, opposite ones together.
    fn merged(&self, of: impl Fn(&CurveRef<T>) -> Vec<f64>) -> [Vec<f64>; 2] {
        let places = |side: &Side<T>| match side {
            Side::Snake(snake) => of(&snake.curve),
            Side::Magnet(_) => Vec::new(),
        };
        let both = |a: Option<&Side<T>>, b: Option<&Side<T>>| {
            let mut all: Vec<f64> = [a, b].into_iter().flatten().flat_map(places).collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            all
        };
        match &self.layout {
            SideLayout::Between([a, b]) => [both(Some(a), Some(b)), Vec::new()],
            SideLayout::Round(s) => [both(Some(&s[0]), Some(&s[2])), both(Some(&s[1]), s.get(3))],
        }
    }

    /// A default side: straight in the parameter plane between the ends `end` of two given sides,
    /// or a part of the surface's edge if it is on one.
    fn implied(&self, sides: [&Side<T>; 2], points: [Option<Key>; 2], end: f64) -> Edge<T> {
        let [p, q] = [0, 1].map(|k| self.turned(sides[k], k, T::from(end)));
        for (k, on) in [0.0, 1.0, 1.0, 0.0].into_iter().enumerate() {
            let split = |w: Vec3<T>| if k % 2 == 0 { (w.y, w.x) } else { (w.x, w.y) };
            let ((across_p, from), (across_q, to)) = (split(p), split(q));
            if across_p.re() != on || across_q.re() != on || from.re() == to.re() {
                continue;
            }
            let Some(key) = self.surface.key else { continue };
            let mark = |t: T, point: Option<Key>| Mark { t, point };
            let part = edge_trace(&self.surface, k).part(
                Root::Edge(key, k as u8),
                mark(from, points[0]),
                mark(to, points[1]),
            );
            if let Trace::Pieces(pieces) = part {
                return Edge::Pieces(pieces);
            }
        }
        Edge::Own
    }
}

fn edge<T: Real>(side: &Side<T>) -> Edge<T> {
    match side {
        Side::Snake(Snake { curve, .. }) => along(curve),
        Side::Magnet(magnet) => Edge::Pole(magnet.key),
    }
}

fn ends<T: Real>(side: &Side<T>) -> [Option<Key>; 2] {
    match side {
        Side::Snake(Snake { curve, .. }) => curve.end_points(),
        Side::Magnet(magnet) => [magnet.key; 2],
    }
}
