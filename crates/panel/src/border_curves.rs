//! Borders of sheets of triangles as patches without panels, one for each curve of a border, so
//! that divisions propagate across it and its vertices are those of the neighbours.
//!
//! Such a patch is the curve itself at any v, with one division along v: its edges v = 0 and v = 1 are
//! one line, and u = 0 and u = 1 are points.

use moldloft_model::Object;
use moldloft_num::trace::{Edge, Edges, Trace};
use moldloft_num::{CurveJet, Fineness, Order, Real, SurfJet, Surface};
use moldloft_registry::{
    Border, BorderCurve, CallError, CurveRef, DivisionDensity, Scalar, SurfaceRef,
    TriangulatedBorder, Value,
};
use std::sync::Arc;

/// A hem among the drafts.
#[derive(Clone, Debug)]
pub(crate) struct BorderCounts {
    /// Number in its sheet.
    pub index: u32,
    /// Divisions that are stated.
    pub stated: Option<u32>,
    /// Divisions when nothing else determines them.
    pub usual: u32,
    /// Default spacing.
    pub density: Option<Arc<DivisionDensity>>,
}

/// The border of an object that has one.
pub(crate) fn border<T: Scalar>(object: &Object<T>) -> Option<&Arc<dyn TriangulatedBorder<T>>> {
    match object.value()? {
        Value::Body(facets) => Some(&facets.border.as_ref()?.0),
        _ => None,
    }
}

/// The border of an object with triangles as near to its surface as this.
///
/// # Errors
/// When that takes too many triangles.
pub(crate) fn finer(
    object: &Object<f64>,
    fineness: Option<&Fineness>,
) -> Result<Option<Border<f64>>, CallError> {
    let finer = fineness.zip(border(object)).map(|(f, border)| border.within(f)).transpose();
    finer.map_err(|fault| {
        let found = format!("{} of `{}`", fault.found.as_deref().unwrap_or("more"), object.name);
        fault.found(found)
    })
}

/// A hem as a patch; `None` for a curve that no neighbour can name.
pub(crate) fn line<T: Real>(border_curve: &BorderCurve<T>) -> Option<SurfaceRef<T>> {
    let curve = &border_curve.curve;
    let known = !curve.pieces().is_empty() || matches!(curve.trace(), Trace::Point(_));
    known.then(|| SurfaceRef::new(DegeneratePatch(curve.clone()), curve.depth))
}

struct DegeneratePatch<T: Real>(CurveRef<T>);

impl<T: Real> Surface<T> for DegeneratePatch<T> {
    fn jet(&self, u: T, _: T, order: Order) -> SurfJet<T> {
        let [p, d, dd]: CurveJet<T> = self.0.jet(u, order);
        SurfJet { p, u: d, uu: dd, ..SurfJet::default() }
    }

    fn edges(&self) -> Edges<T> {
        let [from, to] = self.0.end_points();
        let along = match self.0.trace() {
            Trace::Point(point) => Edge::Pole(point),
            _ => Edge::Pieces(self.0.pieces()),
        };
        Edges {
            edges: [along, Edge::Pole(to), Edge::SameAs(0), Edge::Pole(from)],
            corners: [from, to, to, from],
        }
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
    moldloft_num::surface_one_by_one!(T: grid, line, scattered);
}
