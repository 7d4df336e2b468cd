//! Reverse differentiation of hydrostatic figures: weights of figures become weights of what the
//! surfaces are made of.
//!
//! `weights (dJ/dfigure) -> integrals, waterline -> nets of the cells -> points of the surfaces, cell by cell -> Adjoints`
//!
//! The cells are those of forward differentiation by a direction that is zero for none of the
//! inputs but by chance. Integrals are pulled by formulas ([`crate::pulled_strip`]); what halves a
//! cell and where strips end is recorded. Of the surfaces the points of one cell are recorded at a
//! time, or those of all pieces of a loft between the same ends.

use crate::body::{Body, HullSide, fit_limits};
use crate::cell::{CellFrame, PieceEnds, PolynomialCell, Sampling, SurfaceDivision, pulled_points};
use crate::figures::{of_integrals, origin_of};
use crate::hydrostatics::Symmetry;
use crate::integrals::{HalvedCell, HydrostaticIntegrals, Immersed, Wanted};
use crate::pulled_strip::{PulledStrip, pulled_strip};
use crate::strip::{CoordinatePlane, Strip, strips};
use moldloft_num::{Adjoints, DerivativeTape, Dual, Real, Rev, Vec3};
use moldloft_parallel::on_one_thread;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Bytes of the stack of the thread that has the tape of the cells.
const STACK_BYTES: usize = 16 << 20;

/// A body whose figures are differentiated.
#[derive(Clone, Copy, Debug)]
pub struct PulledBody<'a> {
    /// The panels of other skins, after the sides.
    pub panels: &'a [[Vec3; 4]],
    /// About the diagonal.
    pub size: f64,
    /// Relative accuracy of the figures.
    pub accuracy: f64,
    /// True for one half of a body that is symmetric in x = 0.
    pub lengthwise: bool,
    /// See [`crate::hydrostatics`].
    pub symmetry: Symmetry,
}

/// Weights of the points of nets of cells, of each sum: `[sum][cell][point]`.
type NetWeights = Vec<Vec<Vec<Vec3>>>;

/// Adds the derivatives of weighted sums of figures by the nodes of this thread's tape: `weights`
/// are those of each sum, by the figure's name, and the density is 1. The tape records probes
/// ([`DerivativeTape::probe`]); nothing can be recorded after it but what is forgotten. Returns the
/// weights of the corners of the panels.
///
/// `None` when a point of a surface is not finite, loops bound no part of it, or a figure does not
/// exist.
pub fn pull_hydrostatics(
    sides: &[HullSide<'_, Rev>],
    body: PulledBody<'_>,
    weights: &[Vec<(&str, f64)>],
    adjoints: &mut [Adjoints],
) -> Option<Vec<Vec<[Vec3; 4]>>> {
    let divide = |side: &HullSide<'_, Rev>| SurfaceDivision::new(side.surface, side.loops);
    let divisions: Vec<_> = sides.iter().map(divide).collect::<Option<_>>()?;
    DerivativeTape::keep();
    let mut frames: Vec<(usize, CellFrame<'_, Rev>)> = Vec::new();
    let mut cells: Vec<Arc<PolynomialCell<f64>>> = Vec::new();
    for (k, (side, division)) in sides.iter().zip(&divisions).enumerate() {
        // With their derivatives in the direction of the probes; what is recorded is forgotten.
        let dual = |x: Rev| Dual::<1> { re: x.re(), eps: [x.probe(1)] };
        let mut sampling = Sampling::new();
        let mut fit = |frame: &CellFrame<'_, Rev>| {
            let samples = sampling.on(side.surface, frame, dual, DerivativeTape::forget);
            samples.interpolated(frame.border(), side.reversed)
        };
        for (frame, cell) in division.cells(fit_limits(body.size, body.accuracy), &mut fit)? {
            frames.push((k, frame));
            cells.push(Arc::new(cell.re()));
        }
    }
    cells.extend(body.panels.iter().map(|&p| Arc::new(PolynomialCell::of_panel(p))));
    let whole = Body::of_cells(cells, body.size, body.accuracy);
    let nets = on_one_thread(STACK_BYTES, || pulled_nets(&whole, body, weights))??;
    for group in sampled_together(&frames) {
        let weighted =
            |at: &usize| nets.iter().any(|nets| nets[*at].iter().any(|w| *w != Vec3::zero()));
        let group: Vec<usize> = group.into_iter().filter(weighted).collect();
        let Some(&first) = group.first() else { continue };
        let (side, frame) = &frames[first];
        let points = match frame.piece_ends() {
            Some(_) => frame.points_of_pieces(sides[*side].surface),
            None => vec![frame.points(sides[*side].surface)],
        };
        for (adjoints, nets) in adjoints.iter_mut().zip(&nets) {
            for &at in &group {
                let weights = pulled_points(whole.cells()[at].degree(), &nets[at]);
                for (p, w) in points[frames[at].1.piece()].iter().zip(weights) {
                    (0..3).for_each(|axis| adjoints.add(p[axis], w[axis]));
                }
            }
            adjoints.pull_local();
        }
        DerivativeTape::forget();
    }
    // The net of a panel is a, d, b, c.
    let corners = |net: &Vec<Vec3>| [net[0], net[2], net[3], net[1]];
    let of_panels = |nets: &Vec<Vec<Vec3>>| nets[frames.len()..].iter().map(corners).collect();
    Some(nets.iter().map(of_panels).collect())
}

/// The indices of frames, those that share their samples together.
fn sampled_together(frames: &[(usize, CellFrame<'_, Rev>)]) -> Vec<Vec<usize>> {
    let mut groups: BTreeMap<(usize, Option<PieceEnds>, usize), Vec<usize>> = BTreeMap::new();
    for (at, (side, frame)) in frames.iter().enumerate() {
        let ends = frame.piece_ends();
        let own = if ends.is_some() { 0 } else { at };
        groups.entry((*side, ends, own)).or_default().push(at);
    }
    groups.into_values().collect()
}

/// The weights of the nets of all cells. This thread's tape is its own.
fn pulled_nets(
    body: &Body<f64>,
    of: PulledBody<'_>,
    weights: &[Vec<(&str, f64)>],
) -> Option<NetWeights> {
    let mirrored = of.lengthwise.then(|| body.with_mirror_image(0));
    let whole = mirrored.as_ref().unwrap_or(body);
    let origin = origin_of(whole, of.symmetry);
    let accuracy = whole.quadrature_accuracy();
    let found = whole.wanted_integrals(0.0, origin, Wanted::All, accuracy);
    let mut pull = NetPull {
        body,
        cut: CoordinatePlane::new(2, 0.0, whole.size()),
        origin: Vec3::of(origin[0], origin[1], 0.0),
        nets: (weights.iter())
            .map(|_| body.cells().iter().map(|c| vec![Vec3::zero(); c.net().len()]).collect())
            .collect(),
    };
    let sums = pull.figures(&found, of, weights)?;
    for leaf in &found.leaves {
        pull.leaf(leaf, &sums);
        if !DerivativeTape::is_sound() {
            return None;
        }
    }
    Some(pull.nets)
}

/// Weights on their way to the nets.
struct NetPull<'a> {
    body: &'a Body<f64>,
    cut: CoordinatePlane<f64>,
    origin: Vec3,
    nets: NetWeights,
}

impl NetPull<'_> {
    /// The weights of the integrals in each sum; the figures' dependence on the waterline and on
    /// single points is added to the nets.
    fn figures(
        &mut self,
        found: &Immersed<f64>,
        of: PulledBody<'_>,
        weights: &[Vec<(&str, f64)>],
    ) -> Option<Vec<HydrostaticIntegrals<f64>>> {
        DerivativeTape::clear();
        let cells: Vec<_> = (self.body.cells().iter())
            .map(|c| Arc::new(c.with_numbers(DerivativeTape::input)))
            .collect();
        let body = Body::of_cells(cells, self.body.size(), self.body.accuracy());
        let mirrored = of.lengthwise.then(|| body.with_mirror_image(0));
        let whole = mirrored.as_ref().unwrap_or(&body);
        let sums =
            HydrostaticIntegrals::of_numbers(found.sums.numbers().map(DerivativeTape::input));
        let cut = self.taped_cut();
        let mut waterline = Vec::new();
        for leaf in &found.leaves {
            if self.strips(&leaf.cell).iter().any(Strip::is_cut) {
                let cell = Arc::new(whole.cells()[leaf.root].along_path(&leaf.path));
                let mut strips_of_leaf = Vec::new();
                strips(&cell, cut, &mut strips_of_leaf);
                waterline.extend(strips_of_leaf.into_iter().filter(Strip::is_cut));
            }
        }
        let all = Immersed { sums, errors: found.errors, waterline, leaves: Vec::new() };
        let origin = [self.origin.x, self.origin.y].map(Rev::from);
        let figures = of_integrals(whole, origin, cut.level, of.symmetry, 1.0, &all).figures;
        let named = figures.figures();
        let mut pulled = Vec::new();
        for (weights, nets) in weights.iter().zip(&mut self.nets) {
            let mut adjoints = Adjoints::new();
            for (name, weight) in weights {
                let (_, figure) = named.iter().find(|(known, _)| known == name)?;
                adjoints.add(*figure, *weight);
            }
            adjoints.pull();
            if !(DerivativeTape::is_sound() && adjoints.are_sound()) {
                return None;
            }
            let by = |x: Rev| adjoints.of(x);
            pulled.push(HydrostaticIntegrals::of_numbers(sums.numbers().map(by)));
            for (net, cell) in nets.iter_mut().zip(body.cells()) {
                net.iter_mut().zip(cell.net()).for_each(|(w, p)| *w += p.map(by));
            }
        }
        Some(pulled)
    }

    fn taped_cut(&self) -> CoordinatePlane<Rev> {
        let CoordinatePlane { axis, level, epsilon } = self.cut;
        CoordinatePlane { axis, level: Rev::from(level), epsilon }
    }

    fn strips(&self, cell: &Arc<PolynomialCell<f64>>) -> Vec<Strip<f64>> {
        let mut found = Vec::new();
        strips(cell, self.cut, &mut found);
        found
    }

    /// Adds what the integrals over a leaf depend on.
    fn leaf(&mut self, leaf: &HalvedCell<f64>, sums: &[HydrostaticIntegrals<f64>]) {
        let found = self.strips(&leaf.cell);
        if found.is_empty() {
            return;
        }
        let count = self.body.cells().len();
        let (root, image) = (leaf.root % count, leaf.root >= count);
        if let [strip] = &found[..]
            && leaf.path.is_empty()
            && strip.is_all_of(&leaf.cell)
        {
            let pulled = pulled_strip(strip, self.cut, self.origin, sums);
            for (nets, pulled) in self.nets.iter_mut().zip(pulled) {
                for (w, own) in nets[root].iter_mut().zip(pulled.net) {
                    *w += if image { Vec3::of(-own.x, own.y, own.z) } else { own };
                }
            }
            return;
        }
        // Halvings and the ends of strips are recorded, the integrals are not.
        DerivativeTape::clear();
        let inputs = self.body.cells()[root].with_numbers(DerivativeTape::input);
        let cell = match image {
            true => inputs.mapped(|p| Vec3::new(-p.x, p.y, p.z), true),
            false => inputs.clone(),
        };
        let mut found = Vec::new();
        strips(&Arc::new(cell.along_path(&leaf.path)), self.taped_cut(), &mut found);
        let mut adjoints = vec![Adjoints::new(); sums.len()];
        for strip in &found {
            let pulled = pulled_strip(&strip.re(), self.cut, self.origin, sums);
            for (adjoints, PulledStrip { net, ends }) in adjoints.iter_mut().zip(pulled) {
                for (p, w) in strip.cell.net().iter().zip(net) {
                    (0..3).for_each(|axis| adjoints.add(p[axis], w[axis]));
                }
                adjoints.add(strip.from, ends[0]);
                adjoints.add(strip.to, ends[1]);
            }
        }
        for (nets, adjoints) in self.nets.iter_mut().zip(&mut adjoints) {
            adjoints.pull();
            if !adjoints.are_sound() {
                DerivativeTape::refuse();
            }
            for (w, p) in nets[root].iter_mut().zip(inputs.net()) {
                *w += p.map(|x| adjoints.of(x));
            }
        }
    }
}

impl HydrostaticIntegrals<f64> {
    /// With these as weights: the derivatives of what a piece of skin adds to the sum, by its place
    /// and by its vector area.
    pub(crate) fn pulled(&self, p: Vec3, n: Vec3) -> (Vec3, Vec3) {
        let mut of_p = Vec3::of(self.forms[0] * n.x, self.forms[1] * n.y, self.forms[2] * n.z);
        let mut of_n = Vec3::of(
            self.forms[0] * p.x + self.open[0],
            self.forms[1] * p.y + self.open[1],
            self.forms[2] * p.z,
        );
        let area = n.norm();
        if area > 0.0 {
            of_n += n * ((self.wetted + self.area_moment.dot(p)) / area);
            of_p += self.area_moment * area;
        }
        // x column, y column, z column / 2 with column = z n_z.
        let (m, column) = (self.moment, p.z * n.z);
        let arm = m.x * p.x + m.y * p.y;
        of_p += Vec3::of(m.x * column, m.y * column, arm * n.z + m.z * column);
        of_n.z += arm * p.z + 0.5 * m.z * p.z * p.z;
        let [one, x, y, xx, xy, yy] = self.plane;
        of_n.z -= one + p.x * (x + p.x * xx + p.y * xy) + p.y * (y + p.y * yy);
        of_p.x -= n.z * (x + 2.0 * p.x * xx + p.y * xy);
        of_p.y -= n.z * (y + p.x * xy + 2.0 * p.y * yy);
        (of_p, of_n)
    }
}
