//! Lofts of foil sections.

use super::column::{Column, Columns};
use super::masters::Masters;
use crate::foil::{FoilArguments, foil_kind};
use moldloft_num::trace::{Edge, Edges};
use moldloft_num::{Jet, Real};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, SurfaceRef, Value};
use moldloft_spline::foil::Profile;

foil_kind!(
    /// Foil sections between points of three, four or five curves: at each u a section, as in
    /// `FoilCurve`. A wing, a keel, a blade.
    ///
    /// With three curves (nose, thickness, tail) v goes from nose to tail; with four (upper tail,
    /// thickness, nose, lower tail) or five (a lower thickness before the lower tail) from the
    /// upper tail to the nose at v = 1/2, and back. Sections of the 6-series have the form of the
    /// thickness ratio at u. If all curves meet in a point, the wing ends in it; elsewhere nose and
    /// tail must be distinct.
    #[derive(Kind)]
    #[kind(
        class = Surface,
        columns = "relabel family curves",
        example = "AbsPoint N(0, 0, 0); AbsPoint U(0.4, 0.12, 0); AbsPoint T(1, 0, 0.01); \
                   AbsPoint O(0.5, 0, 3); AbsPoint V(0.7, 0.05, 3); AbsPoint W(1.1, -0.03, 3); \
                   AbsPoint D(0.4, -0.05, 0); AbsPoint E(0.7, -0.04, 3); Line nose(N, O); Line up(U, V); \
                   Line tail(T, W); Line low(D, E); FoilLoftSurf wing({tail, up, nose, low, tail}); \
                   FoilLoftSurf half({nose, up, tail}, \"modified\", nose_index = 4); \
                   FoilLoftSurf sharp({tail, up, nose, tail}, \"16\", offset = \"normal\");"
    )]
    FoilLoftSurf {
        /// Three, four or five curves.
        curves (CURVES): CurveRef<T>,
    }
);

/// The parameters at which a new loft is tried.
const TRIALS: usize = 32;

impl<T: Real> Build<T> for FoilLoftSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let (curves, section) = self.parts();
        let masters = Masters::new(curves, Self::CURVES)?;
        let at = |u: f64| section.lifted(&masters.at(T::from(u)));
        let first = at(0.0)?;
        for k in 0..=TRIALS {
            let u = k as f64 / TRIALS as f64;
            if let Err(fault) = at(u) {
                return Err(fault.help(format!("that is so at u = {u}")));
            }
        }
        let (half, closed) = (first.layout.is_half(), first.section.is_closed());
        let across = first.second_order_breaks();
        let loft = FoilLoft { masters, section, half, closed, across };
        Ok(Value::Surface(SurfaceRef::new(Columns(loft), context.nesting)))
    }
}

struct FoilLoft<T: Real> {
    masters: Masters<T>,
    section: FoilArguments<T>,
    half: bool,
    /// True when the tail is drawn to its curves.
    closed: bool,
    /// The breaks of the section.
    across: Vec<f64>,
}

impl<T: Real> Column for FoilLoft<T> {
    type Scalar = T;
    type Across<S: Real> = Profile<S>;

    fn across<J: Jet<T>>(&self, u: J) -> Option<Profile<J>> {
        self.section.lifted(&self.masters.at(u)).ok()
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.masters.breaks(), self.across.clone()]
    }

    fn edge_made_of(&self, k: usize) -> Vec<moldloft_num::trace::Key> {
        // The end of an arc or of a section need not be on a master.
        match k % 2 {
            0 => Vec::new(),
            _ => self.masters.edge_made_of(k),
        }
    }

    /// Edges are nose and tail if the section ends there.
    fn edges(&self) -> Edges<T> {
        let mut edges = self.masters.edges();
        if !self.closed {
            edges.edges[2] = Edge::Own;
            edges.corners[2..].fill(None);
            if !self.half {
                edges.edges[0] = Edge::Own;
                edges.corners[..2].fill(None);
            }
        }
        edges
    }
}
