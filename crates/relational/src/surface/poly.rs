//! Surfaces side by side as one.

use crate::arguments::NamedOption;
use crate::snake::edge_trace;
use moldloft_num::trace::{Edge, Edges, Key, Piece, Trace};
use moldloft_num::{Order, Real, SurfJet, Surface};
use moldloft_registry::{Build, CallError, Context, Kind, SurfaceRef, Value};
use smallvec::SmallVec;

/// Adjacent surfaces as one: piece k of N has u from (k - 1) / N to k / N (v, with `along` = "v"),
/// or between the given breaks.
///
/// Each piece begins where the one before ends: edge u = 1 of the one is edge u = 0 of the other,
/// point by point at equal v, within the model's tolerance. A piece is never reversed. Meshes join
/// along the pieces' own edges.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "surfaces",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(2, 2, 2); AbsPoint F(4, 1, 3); AbsPoint G(1, 2, 0.5); BCurve a({A, G, B}, 2); \
               Line b(D, E); RuledSurf R(a, b); Line c(B, C); Line d(E, F); RuledSurf S(c, d); \
               PolySurf both({R, S}); PolySurf early({R, S}, breaks = {0.375}); AbsPoint H(0, 1, 4); \
               AbsPoint I(2, 3, 4); Line e(H, I); RuledSurf T(b, e); PolySurf up({R, T}, \"v\");"
)]
pub struct PolySurf<T: Real> {
    /// The surfaces, in order.
    #[field(min_items = 1)]
    surfaces: Vec<SurfaceRef<T>>,
    /// The parameter along which the pieces are joined: "u" or "v".
    #[field(default = "u")]
    along: NamedOption,
    /// Parameters of the seams, ascending between 0 and 1; default: equal intervals.
    breaks: Option<Vec<T>>,
}

impl<T: Real> Build<T> for PolySurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surfaces, along, breaks } = self;
        if surfaces.is_empty() {
            return Err(CallError::new("too-few-items", "a join needs at least 1 surface")
                .expected("at least 1 surface")
                .found("0")
                .in_field(Self::SURFACES));
        }
        let by_u = along.among(&["u", "v"], Self::ALONG)? == "u";
        let ends = crate::curve::shares(surfaces.len(), breaks, Self::BREAKS)?;
        let sides = PiecewiseSurface { surfaces, by_u };
        for k in 1..sides.surfaces.len() {
            sides.check_seam(k, context.tolerance)?;
        }
        let edges = sides.edges(&ends);
        Ok(Value::Surface(SurfaceRef::new(
            CompositeSurface { sides, ends, edges },
            context.nesting,
        )))
    }
}

/// Number of points at which each seam is compared.
const TRIALS: usize = 32;

struct PiecewiseSurface<T: Real> {
    surfaces: Vec<SurfaceRef<T>>,
    by_u: bool,
}

impl<T: Real> PiecewiseSurface<T> {
    /// The edges of each piece: low and high across the join, begin and end along it.
    fn numbers(&self) -> [usize; 4] {
        if self.by_u { [0, 2, 3, 1] } else { [3, 1, 0, 2] }
    }

    /// A point on the start (0) or end (1) of a piece.
    fn place(&self, k: usize, end: f64, t: f64) -> moldloft_num::Vec3 {
        let (u, v) = if self.by_u { (end, t) } else { (t, end) };
        self.surfaces[k].jet(T::from(u), T::from(v), Order::Zero).p.re()
    }

    /// The widest gap between an end of piece `k` - 1 and an end of piece `k`, and where.
    fn gap(&self, k: usize, [from, to]: [f64; 2], turned: bool) -> (f64, f64) {
        let mut widest = (0.0f64, 0.0);
        for i in 0..=TRIALS {
            let t = i as f64 / TRIALS as f64;
            let other = if turned { 1.0 - t } else { t };
            let gap = self.place(k - 1, from, t).distance(self.place(k, to, other));
            // Written so that NaN counts.
            if gap.is_nan() || gap > widest.0 {
                widest = (gap, t);
            }
        }
        widest
    }

    fn check_seam(&self, k: usize, tolerance: f64) -> Result<(), CallError> {
        let (widest, at) = self.gap(k, [1.0, 0.0], false);
        if widest <= tolerance {
            return Ok(());
        }
        let [along, across] = if self.by_u { ["u", "v"] } else { ["v", "u"] };
        let text = format!("piece {} does not begin where piece {k} ends", k + 1);
        let fault = CallError::new("gap", text)
            .expected(format!(
                "edge {along} = 1 of piece {k} to be edge {along} = 0 of piece {}",
                k + 1
            ))
            .found(format!("a gap of {widest} at {across} = {at}, with a tolerance of {tolerance}"))
            .related(self.surfaces[k - 1].key, "ends on one side of the gap")
            .related(self.surfaces[k].key, "begins on the other")
            .in_item(k)
            .in_field(PolySurf::<T>::SURFACES);
        let meets =
            |from: f64, to: f64, turned: bool| self.gap(k, [from, to], turned).0 <= tolerance;
        let turned = Self { surfaces: self.surfaces.clone(), by_u: !self.by_u };
        Err(if turned.gap(k, [1.0, 0.0], false).0 <= tolerance {
            fault.help(format!("they meet along {across}: `along = \"{across}\"`"))
        } else if meets(1.0, 0.0, true) {
            fault.help(format!("they meet when {across} of piece {} is reversed", k + 1))
        } else if meets(1.0, 1.0, false) || meets(1.0, 1.0, true) {
            fault.help(format!("piece {} ends there: reverse its {along}", k + 1))
        } else {
            fault.help("make the pieces from a common curve")
        })
    }

    /// The trace of an edge of a piece; `None` if it is not shared.
    fn pieces(&self, k: usize, edge: usize) -> Option<SmallVec<[Piece<T>; 1]>> {
        match edge_trace(&self.surfaces[k], edge) {
            Trace::Pieces(pieces) => Some(pieces),
            _ => None,
        }
    }

    fn edges(&self, ends: &[T]) -> Edges<T> {
        let [low, high, begin, end] = self.numbers();
        let last = self.surfaces.len() - 1;
        let chain = |edge: usize| -> Option<SmallVec<[Piece<T>; 1]>> {
            let mut all = SmallVec::new();
            for k in 0..=last {
                let pieces = self.pieces(k, edge)?;
                let width = ends[k + 1] - ends[k];
                let count = pieces.len();
                all.extend(pieces.into_iter().enumerate().map(|(j, piece)| Piece {
                    until: if j + 1 == count { ends[k + 1] } else { ends[k] + width * piece.until },
                    ..piece
                }));
            }
            Some(all)
        };
        let along = |edge: usize| chain(edge).map_or(Edge::Own, Edge::Pieces);
        let across = |k: usize, edge: usize| match edge_trace(&self.surfaces[k], edge) {
            Trace::Pieces(pieces) => Edge::Pieces(pieces),
            Trace::Point(point) => Edge::Pole(point),
            Trace::Own(_) => Edge::Own,
        };
        let mut edges = Edges::own();
        for (edge, value) in [
            (low, along(low)),
            (high, along(high)),
            (begin, across(0, begin)),
            (end, across(last, end)),
        ] {
            edges.edges[edge] = value;
        }
        // One surface along the whole of an edge keeps its poles and seams.
        let of = |k: usize| self.surfaces[k].edges();
        if last == 0 {
            edges.edges = of(0).edges.map(|edge| match edge {
                Edge::Own => Edge::Own,
                other => other,
            });
            edges.corners = of(0).corners;
            return edges;
        }
        let corner = |k: usize, c: usize| -> Option<Key> { of(k).corners[c] };
        edges.corners = if self.by_u {
            [corner(0, 0), corner(last, 1), corner(last, 2), corner(0, 3)]
        } else {
            [corner(0, 0), corner(0, 1), corner(last, 2), corner(last, 3)]
        };
        edges
    }
}

struct CompositeSurface<T: Real> {
    sides: PiecewiseSurface<T>,
    /// The parameters at which pieces begin and end, 0 and 1 included.
    ends: Vec<T>,
    edges: Edges<T>,
}

impl<T: Real> CompositeSurface<T> {
    /// The piece in charge at `t`, the parameter in it, and that one's rate.
    fn local(&self, t: T) -> (usize, T, T) {
        let inner = &self.ends[1..self.ends.len() - 1];
        let k = inner.partition_point(|end| end.re() <= t.re());
        let width = self.ends[k + 1] - self.ends[k];
        (k, (t - self.ends[k]) / width, T::one() / width)
    }

    /// Lines of the parts, and those at which they join.
    fn with_joints(&self, of: impl Fn(&SurfaceRef<T>) -> [Vec<f64>; 2]) -> [Vec<f64>; 2] {
        let (mut along, mut across) = (Vec::new(), Vec::new());
        for (k, surface) in self.sides.surfaces.iter().enumerate() {
            let (from, to) = (self.ends[k].re(), self.ends[k + 1].re());
            let [u, v] = of(surface);
            let (own, other) = if self.sides.by_u { (u, v) } else { (v, u) };
            along.extend(own.into_iter().map(|b| from + (to - from) * b));
            along.push(to);
            across.extend(other);
        }
        along.pop();
        across.sort_by(f64::total_cmp);
        across.dedup();
        if self.sides.by_u { [along, across] } else { [across, along] }
    }
}

impl<T: Real> Surface<T> for CompositeSurface<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        let (k, s, rate) = self.local(if self.sides.by_u { u } else { v });
        let surface = &self.sides.surfaces[k];
        if self.sides.by_u {
            let jet = surface.jet(s, v, order);
            SurfJet { u: jet.u * rate, uv: jet.uv * rate, uu: jet.uu * (rate * rate), ..jet }
        } else {
            let jet = surface.jet(u, s, order);
            SurfJet { v: jet.v * rate, uv: jet.uv * rate, vv: jet.vv * (rate * rate), ..jet }
        }
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        self.with_joints(|surface| surface.breaks())
    }

    fn joints(&self) -> [Vec<f64>; 2] {
        self.with_joints(|surface| surface.joints())
    }

    fn kinks(&self) -> [Vec<f64>; 2] {
        self.with_joints(|surface| surface.kinks())
    }

    fn edges(&self) -> Edges<T> {
        self.edges.clone()
    }

    moldloft_num::surface_facts!(breaks_along_lines, open, not_rational);
    moldloft_num::surface_one_by_one!(T: grid, line, scattered);
}
