use super::Ended;
use crate::arguments::Named;
use crate::foil::Arguments;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, Context, CurveRef, Fault, Kind, Point, Value};
use std::sync::Arc;

/// A foil section: thickness form and mean line of a NACA family, or ordinates of one's own,
/// between 3, 4 or 5 points.
///
/// Three points are nose, thickness point and tail of half a section, which runs from nose to tail.
/// Four are tail, thickness point, nose and lower tail of a symmetric section; five have a lower
/// thickness point before the lower tail, and half of what the two thickness points add up to is
/// the camber. These run from the tail along the upper side to the nose, at t = 1/2, and back. Only
/// the distance of a thickness point from the chord counts: it is half the nominal thickness.
///
/// The parameter is the square root of the way along the chord, so that the nose is smooth; the
/// speed vanishes nowhere. Forms: NACA Reports 460, 492, 537 and 824, TM X-3069 (6-series, for the
/// thickness ratio that the points have), Brockett 1966 (66tmb).
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel family points",
    example = "AbsPoint N(0, 0, 0); AbsPoint U(0.3, 0.1, 0); AbsPoint D(0.5, -0.02, 0.01); \
               AbsPoint T(1, 0.01, 0); FoilCurve naca4412({T, U, N, D, T}, offset = \"normal\"); \
               FoilCurve half({N, U, T}, \"16\"); FoilCurve own({N, U, T}, ordinates = {{0, 0, 0}, {0.3, 1, 0}, {1, 0, 0}});"
)]
pub struct FoilCurve<T: Real> {
    /// Three, four or five points.
    #[field(min_items = 3)]
    points: Vec<Point<T>>,
    /// Thickness form: "4-digit", "modified", "5-digit", "16", "63", "64", "65", "66", "63A",
    /// "64A", "65A" or "66tmb", or its number in this list.
    #[field(default = "4-digit")]
    family: Named,
    /// Mean line: "flat", "parabolic", "210" to "250", "221" to "241", "a" or "a modified"; "" is
    /// the usual one of the family.
    #[field(default = "")]
    mean: Arc<str>,
    /// Place of the greatest camber of the parabolic mean line, in chords.
    #[field(default = 0.4)]
    camber_at: T,
    /// Extent a of the uniform load of the mean line "a"; 0.8 for 66tmb, else 1, when not given.
    load: Option<T>,
    /// Nose index of the modified form: 6 is the plain nose, 0 a sharp one.
    #[field(default = 6)]
    nose_index: T,
    /// Place of the greatest thickness of the modified form, from 0.2 to 0.6.
    #[field(default = 0.3)]
    thickness_at: T,
    /// "closed" draws the tail to its points, "open" leaves the thickness that the form has there.
    #[field(default = "closed")]
    tail: Arc<str>,
    /// "affine" sets thickness off across the chord, "normal" across the mean line.
    #[field(default = "affine")]
    offset: Arc<str>,
    /// A curve of ordinates (x, half thickness, camber) from nose to tail instead of a family.
    section: Option<CurveRef<T>>,
    /// Ordinates {x, half thickness, camber} from nose to tail instead of a family.
    ordinates: Option<Vec<Vec3<T>>>,
}

impl<T: Real> Build<T> for FoilCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        let points: Vec<_> = self.points.iter().map(|p| p.xyz).collect();
        let arguments = Arguments {
            family: self.family,
            mean: self.mean,
            camber_at: self.camber_at,
            load: self.load,
            nose_index: self.nose_index,
            thickness_at: self.thickness_at,
            tail: self.tail,
            offset: self.offset,
            section: self.section,
            ordinates: self.ordinates,
            metric: None,
        };
        let (curve, closed, nesting) = arguments.profile(&points)?;
        let [first, last] = [0, points.len() - 1].map(|k| self.points[k].key);
        let tail = |key| if closed { key } else { None };
        let start = if curve.layout.is_half() { first } else { tail(first) };
        Ok(Value::Curve(CurveRef::new(Ended { curve, ends: [start, tail(last)] }, nesting)))
    }
}
