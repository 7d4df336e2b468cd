use super::through::{flat, snake};
use crate::arguments::{Magnet, Named, common_surface};
use crate::foil::{Arguments, POINTS};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, Context, CurveRef, Fault, Kind, Value};
use std::sync::Arc;

/// A foil section in the parameter plane of a surface, between 3, 4 or 5 magnets, as a foil curve.
///
/// It is a true foil in space only where the surface is a scaled plane; on a cylinder with u its
/// angle and v a length, `metric` = {radius^2, 0, 1} makes thickness perpendicular to the chord as
/// measured on the unrolled surface.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel family magnets",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsMagnet n(S, 0.2, 0.4); AbsMagnet u(S, 0.4, 0.55); AbsMagnet d(S, 0.5, 0.4); \
               AbsMagnet t(S, 0.9, 0.5); FoilSnake root({t, u, n, d, t}); \
               FoilSnake half({n, u, t}, \"16\", metric = {16, 1, 5});"
)]
pub struct FoilSnake<T: Real> {
    /// Three, four or five magnets of one surface.
    #[field(min_items = 3)]
    magnets: Vec<Magnet<T>>,
    /// Thickness form, by its name or number, as for a foil curve.
    #[field(default = "4-digit")]
    family: Named,
    /// Mean line; "" is the usual one of the family.
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
    /// "closed" draws the tail to its magnets, "open" leaves the thickness that the form has there.
    #[field(default = "closed")]
    tail: Arc<str>,
    /// "affine" sets thickness off across the chord, "normal" across the mean line.
    #[field(default = "affine")]
    offset: Arc<str>,
    /// A curve of ordinates (x, half thickness, camber) from nose to tail instead of a family.
    section: Option<CurveRef<T>>,
    /// Ordinates {x, half thickness, camber} from nose to tail instead of a family.
    ordinates: Option<Vec<Vec3<T>>>,
    /// How lengths are measured in the parameter plane: {uu, uv, vv}; {1, 0, 1} when not given.
    metric: Option<Vec3<T>>,
}

impl<T: Real> Build<T> for FoilSnake<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        let items: Vec<_> = self.magnets.iter().map(|m| (m.key, &m.surface)).collect();
        let surface = common_surface(&items, |fault, k| fault.in_item(k).in_field(POINTS))?;
        let points: Vec<_> = self.magnets.iter().map(|m| flat(m.uv)).collect();
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
            metric: self.metric,
        };
        let (path, closed, nesting) = arguments.profile(&points)?;
        let [first, last] = [0, points.len() - 1].map(|k| self.magnets[k].key);
        let tail = |key| if closed { key } else { None };
        let start = if path.layout.is_half() { first } else { tail(first) };
        snake(surface, path, [start, tail(last)], nesting)
    }
}
