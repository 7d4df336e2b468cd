//! Patches between boundary curves: bilinear Coons patches, and with a given centre.

use super::corners;
use super::masters::along;
use moldloft_num::trace::{Edge, Edges, Key};
use moldloft_num::{Box3, Jet, Real, SurfaceFormula, Vec3};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, FieldId, Kind, Point, SurfaceRef, Value,
};

/// A patch between four curves, its edges v = 0, u = 1, v = 1 and u = 0, each in increasing
/// parameter: the bilinear Coons patch P_u + P_v - P_uv (Coons 1967).
///
/// With three curves the edge u = 0 is the point at which the first and the third begin. Curves
/// that do not meet at the corners are errors; they are never reversed.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "curves",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 1); AbsPoint C(5, 4, 0); AbsPoint D(0, 3, 1); \
               AbsPoint E(2, -1, 2); AbsPoint F(2, 4, -1); BCurve south({A, E, B}, 2); Line east(B, C); \
               BCurve north({D, F, C}, 2); Line west(A, D); BlendSurf S({south, east, north, west}); \
               Line slope(A, C); BlendSurf three({south, east, slope});"
)]
pub struct BlendSurf<T: Real> {
    /// The four (or three) boundary curves.
    #[field(min_items = 3)]
    curves: Vec<CurveRef<T>>,
}

impl<T: Real> Build<T> for BlendSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let boundary = CoonsBoundary::new(self.curves, Self::CURVES)?;
        let patch = CoonsPatch { boundary, lift: None };
        Ok(Value::Surface(SurfaceRef::new(patch, context.nesting)))
    }
}

/// A patch between four curves that passes through a given centre point: the Coons patch plus 16 u
/// (1 - u) v (1 - v) times the vector from its centre to the point.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "curves centre",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 1); AbsPoint C(5, 4, 0); AbsPoint D(0, 3, 1); \
               AbsPoint E(2, -1, 2); AbsPoint F(2, 4, -1); BCurve south({A, E, B}, 2); Line east(B, C); \
               BCurve north({D, F, C}, 2); Line west(A, D); AbsPoint top(2, 2, 3); \
               BlendCenter S({south, east, north, west}, top);"
)]
pub struct BlendCenter<T: Real> {
    /// The four (or three) boundary curves.
    #[field(min_items = 3)]
    curves: Vec<CurveRef<T>>,
    /// The point at u = v = 0.5.
    centre: Point<T>,
}

impl<T: Real> Build<T> for BlendCenter<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let boundary = CoonsBoundary::new(self.curves, Self::CURVES)?;
        let half = T::from(0.5);
        let lift = Some((self.centre.xyz - boundary.coons(half, half)) * T::from(16.0));
        let patch = CoonsPatch { boundary, lift };
        Ok(Value::Surface(SurfaceRef::new(patch, context.nesting)))
    }
}

/// Three or four curves round a patch, which meet.
pub struct CoonsBoundary<T: Real> {
    pub curves: Vec<CurveRef<T>>,
    /// The positions at (0, 0), (1, 0), (1, 1), (0, 1).
    pub corners: [Vec3<T>; 4],
}

/// Maximum distance between ends at a corner, relative to the size of the patch: the tolerance for
/// one point in joins of panels.
const MEETING: f64 = 1e-9;

impl<T: Real> CoonsBoundary<T> {
    /// # Errors
    /// `wrong-length` and `open-corner`, in field `field`.
    pub fn new(curves: Vec<CurveRef<T>>, field: FieldId) -> Result<Self, CallError> {
        if !(3..=4).contains(&curves.len()) {
            return Err(CallError::new("wrong-length", "a patch has 3 or 4 sides")
                .expected("3 or 4 curves")
                .found(curves.len().to_string())
                .in_field(field));
        }
        let ends: Vec<[Vec3<f64>; 2]> =
            curves.iter().map(|c| [0.0, 1.0].map(|t| c.end(t).re())).collect();
        let inner = curves.iter().map(|c| c.jet(T::from(0.5), moldloft_num::Order::Zero)[0].re());
        let size = Box3::around(ends.iter().flatten().copied().chain(inner)).diagonal();
        let says = |p: Vec3<f64>| format!("({}, {}, {})", p.x, p.y, p.z);
        corners::check(&ends, MEETING * size, |p, q| p.distance(q), says, field)?;
        let (south, north) = (&curves[0], &curves[2]);
        let corners = [south.end(0.0), south.end(1.0), north.end(1.0), north.end(0.0)];
        Ok(Self { curves, corners })
    }

    /// The position on side 0..4 at `t`.
    pub fn side<J: Jet<T>>(&self, k: usize, t: J) -> Vec3<J> {
        match self.curves.get(k) {
            Some(curve) => curve.at(t),
            None => self.corners[0].map(J::fixed),
        }
    }

    /// The bilinear Coons patch.
    pub fn coons<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        let (a, b) = (-u + 1.0, -v + 1.0);
        let across = self.side(0, u) * b + self.side(2, u) * v;
        let along = self.side(3, v) * a + self.side(1, v) * u;
        let [p, q, r, s] = self.corners.map(|p| p.map(J::fixed));
        across + along - ((p * a + q * u) * b + (s * a + r * u) * v)
    }

    pub fn breaks(&self) -> [Vec<f64>; 2] {
        self.merged(|curve| curve.breaks())
    }

    pub fn joints(&self) -> [Vec<f64>; 2] {
        self.merged(|curve| curve.joints())
    }

    fn merged(&self, of: impl Fn(&CurveRef<T>) -> Vec<f64>) -> [Vec<f64>; 2] {
        [(0, 2), (1, 3)].map(|(a, b)| {
            let both = [self.curves.get(a), self.curves.get(b)];
            let mut all: Vec<f64> = both.into_iter().flatten().flat_map(&of).collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            all
        })
    }

    pub fn edges(&self) -> Edges<T> {
        let ends: Vec<[Option<Key>; 2]> = self.curves.iter().map(|c| c.end_points()).collect();
        let known: Vec<Option<Key>> = corners::of(ends.len())
            .iter()
            .map(|&[(a, s), (b, t)]| ends[a][s].or(ends[b][t]))
            .collect();
        let [b, c] = [known[0], known[1]];
        let (d, a) = if ends.len() == 3 { (known[2], known[2]) } else { (known[2], known[3]) };
        let edge = |k: usize| self.curves.get(k).map_or(Edge::Pole(a), along);
        Edges { edges: [edge(0), edge(1), edge(2), edge(3)], corners: [a, b, c, d] }
    }
}

struct CoonsPatch<T: Real> {
    boundary: CoonsBoundary<T>,
    /// 16 times the vector from the middle of the Coons patch to the centre.
    lift: Option<Vec3<T>>,
}

impl<T: Real> SurfaceFormula for CoonsPatch<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        let p = self.boundary.coons(u, v);
        match self.lift {
            None => p,
            Some(lift) => {
                let bump = u * (-u + 1.0) * v * (-v + 1.0);
                p + lift.map(|x| bump.scaled(x))
            }
        }
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        self.boundary.breaks()
    }

    fn joints(&self) -> [Vec<f64>; 2] {
        self.boundary.joints()
    }

    fn edges(&self) -> Edges<T> {
        self.boundary.edges()
    }

    moldloft_num::surface_facts!(kinks_at_breaks, breaks_along_lines, open, not_rational);
}
