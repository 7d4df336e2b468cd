//! Lofts of circular arcs through three curves.

use super::column::{Column, Columns};
use super::masters::Masters;
use moldloft_num::trace::{Edge, Edges};
use moldloft_num::{Jet, Real};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, SurfaceRef, Value};
use moldloft_spline::{ArcError, CircularArc};

/// A surface of circular arcs by three curves: at each u the arc, of a type as for `Arc`, by the
/// three points of the curves at u.
///
/// If the three points are collinear, types 1, 3 and 4 are straight for a second point between the
/// others and have no finite radius for one outside, and types 5 and 6 have no plane: such u are an
/// error that names u.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "relabel type c1 c2 c3",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(0, 1, 1); AbsPoint C(0, 2, 0); AbsPoint D(4, 0, 0.5); \
               AbsPoint E(4, 1.5, 2); AbsPoint F(4, 2.5, 0); AbsPoint G(2, 1, 2); Line a(A, D); \
               BCurve b({B, G, E}, 2); Line c(C, F); ArcLoftSurf roof(a, b, c); \
               ArcLoftSurf sector(a, b, c, 2); ArcLoftSurf tangent(a, b, c, 3); \
               ArcLoftSurf late(a, b, c, 4); ArcLoftSurf half(a, c, b, 5); ArcLoftSurf pipe(a, b, c, 6);"
)]
pub struct ArcLoftSurf<T: Real> {
    /// The curve of the first points.
    c1: CurveRef<T>,
    /// The curve of the second points.
    c2: CurveRef<T>,
    /// The curve of the third points.
    c3: CurveRef<T>,
    /// One of the six types of `Arc`.
    #[field(default = 1, min = 1, max = 6)]
    r#type: u32,
}

/// The parameters at which a new loft is tried.
const TRIALS: usize = 64;

impl<T: Real> Build<T> for ArcLoftSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { c1, c2, c3, r#type } = self;
        let loft = ArcLoft { masters: Masters::new(vec![c1, c2, c3], Self::C1)?, kind: r#type };
        let at = |k: usize| k as f64 / TRIALS as f64;
        let bad: Vec<usize> = (0..=TRIALS).filter(|&k| loft.trouble(at(k)).is_some()).collect();
        if let [first, .., last] | [first @ last] = bad[..] {
            let (what, expected) = loft.trouble(at(first)).expect("a bad parameter");
            let range = if first == last {
                format!("at u = {}", at(first))
            } else {
                format!("between u = {} and u = {}", at(first), at(last))
            };
            return Err(CallError::new("collinear-points", format!("{what} {range}"))
                .expected(expected)
                .found(format!("no such arc at {} of {} parameters", bad.len(), TRIALS + 1))
                .help("move the second curve out of the line of the others")
                .in_field(Self::C2));
        }
        Ok(Value::Surface(SurfaceRef::new(Columns(loft), context.nesting)))
    }
}

struct ArcLoft<T: Real> {
    masters: Masters<T>,
    kind: u32,
}

impl<T: Real> ArcLoft<T> {
    /// The error of the arc at `u`, and the expected condition.
    fn trouble(&self, u: f64) -> Option<(&'static str, &'static str)> {
        let points = self.masters.at(T::from(u));
        let [p, q, r] = [0, 1, 2].map(|k| points[k].re());
        if p == q && q == r {
            // An end in a point.
            return None;
        }
        match CircularArc::of_type(self.kind, [p, q, r])? {
            Err(ArcError::AtCentre) => Some(("a point is at the centre", "points off the centre")),
            Err(ArcError::Collinear) => {
                Some(("the three points are in line", "points that span a plane"))
            }
            Err(ArcError::NotFinite { .. }) => Some(("a point is not finite", "finite points")),
            Ok(_) => {
                // The angle of the arc approaches a full turn for a second point outside.
                let (a, b) = match self.kind {
                    1 => (q - p, r - q),
                    3 => (q - p, r - p),
                    4 => (r - q, r - p),
                    _ => return None,
                };
                let (sine, cosine) = (a.cross(b).norm(), a.dot(b));
                let flat = sine <= 1e-9 * a.norm() * b.norm();
                (flat && cosine < 0.0)
                    .then_some(("the radius is unbounded", "a second point between the others"))
            }
        }
    }
}

impl<T: Real> Column for ArcLoft<T> {
    type Scalar = T;
    type Across<S: Real> = CircularArc<S>;

    fn across<J: Jet<T>>(&self, u: J) -> Option<CircularArc<J>> {
        let points = self.masters.at(u);
        let [p, q, r] = [points[0], points[1], points[2]];
        match CircularArc::of_type(self.kind, [p, q, r])? {
            Ok(arc) => Some(arc),
            // An end in a point.
            Err(_) => CircularArc::through(p, (p + r) * J::from(0.5), r).ok(),
        }
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.masters.breaks(), Vec::new()]
    }

    fn edge_made_of(&self, k: usize) -> Vec<moldloft_num::trace::Key> {
        // The end of an arc or of a section need not be on a master.
        match k % 2 {
            0 => Vec::new(),
            _ => self.masters.edge_made_of(k),
        }
    }

    /// Edges follow the masters on which arcs begin and end; a full circle closes the surface.
    fn edges(&self) -> Edges<T> {
        let mut edges = self.masters.edges();
        let curves = self.masters.curves();
        match self.kind {
            2 => {
                edges.edges[2] = Edge::Own;
                edges.corners[2..].fill(None);
            }
            5 => {
                edges.edges[2] = super::masters::along(&curves[1]);
                let [d, c] = curves[1].end_points();
                (edges.corners[2], edges.corners[3]) = (c, d);
            }
            6 => {
                edges.edges[2] = Edge::SameAs(0);
                (edges.corners[3], edges.corners[2]) = (edges.corners[0], edges.corners[1]);
            }
            _ => {}
        }
        edges
    }
}
