//! Foil sections in the parameter plane of a surface.

use super::through::{flat, snake};
use crate::arguments::{Magnet, common_surface};
use crate::foil::foil_kind;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Context, Kind, Value};

foil_kind!(
    /// A foil section in the parameter plane of a surface, between 3, 4 or 5 magnets, as a foil curve.
    ///
    /// The section is a true foil in space only if the surface is a scaled plane. On a cylinder
    /// with u the angle and v a length, `metric` = {radius^2, 0, 1} makes the thickness
    /// perpendicular to the chord on the unrolled surface.
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
    FoilSnake {
        /// Three, four or five magnets of one surface.
        magnets (MAGNETS): Magnet<T>,
        /// Metric of the parameter plane: {uu, uv, vv}; default: {1, 0, 1}.
        metric (METRIC): Option<Vec3<T>>,
    }
);

impl<T: Real> Build<T> for FoilSnake<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (magnets, arguments) = self.parts();
        let items: Vec<_> = magnets.iter().map(|m| (m.key, &m.surface)).collect();
        let surface = common_surface(&items, |fault, k| fault.in_item(k).in_field(Self::MAGNETS))?;
        let places: Vec<_> = magnets.iter().map(|m| flat(m.uv)).collect();
        let (path, closed, nesting) = arguments.profile(&places)?;
        let [first, last] = [0, magnets.len() - 1].map(|k| magnets[k].key);
        let tail = |key| if closed { key } else { None };
        let start = if path.layout.is_half() { first } else { tail(first) };
        snake(surface, path, [start, tail(last)], nesting)
    }
}
