//! Surfaces that share edges, faired together with continuous tangents and curvature across them.
//!
//! A shared edge is one row of points of both nets, so that the surfaces never part. On clamped knots
//! the first and second derivative across the edge are linear in three rows on each side; with D, D'
//! those of one surface towards the other and E, E' of the other away from it,
//!
//! ```text
//! E = b D                     tangent planes agree (G1)
//! E' = b^2 D' + c D           curvatures agree too (G2)
//! ```
//!
//! at every control point along the edge, hence everywhere on it. b and c are one number each for an
//! edge, read from the surfaces as given by least squares; with them fixed the conditions are linear.

use super::network::PlacedNet;
use super::seam::SeamCondition;
use crate::optimum::Bend;
use crate::{EndContinuity, FairError, Limit, Network, Space};
use moldloft_num::{Real, Vec3};

/// The part of the size of a net within which points of two edges are the same.
const SAME: f64 = 1e-9;

/// One of the surfaces: the control net of a tensor-product spline.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchNet {
    /// Its spaces along u and v.
    pub spaces: [Space; 2],
    /// Its control points, (i, j) at `i * v.count() + j`.
    pub points: Vec<Vec3<f64>>,
    /// Weights, which stay.
    pub weights: Option<Vec<f64>>,
    /// Limits of the moves of control points.
    pub limit: Limit,
    /// Conditions of its rims, at both ends of u, then of v; see [`Network::with_rims`].
    pub rims: [[EndContinuity; 2]; 2],
    /// Knuckle lines along u and along v; see [`Network::with_breaks`].
    pub breaks: [Vec<usize>; 2],
}

impl PatchNet {
    /// A sheet with free rims and without breaks.
    pub fn new(spaces: [Space; 2], points: Vec<Vec3<f64>>, limit: Limit) -> Self {
        let (rims, breaks) = ([[EndContinuity::Free; 2]; 2], [Vec::new(), Vec::new()]);
        Self { spaces, points, weights: None, limit, rims, breaks }
    }

    /// The places of the row of points that is `depth` rows away from an edge, along the edge.
    fn row(&self, edge: NetEdge, depth: usize) -> Vec<usize> {
        let [nu, nv] = self.spaces.each_ref().map(Space::count);
        let from = |n: usize| if edge.end == 0 { depth } else { n - 1 - depth };
        match edge.direction {
            0 => (0..nv).map(|j| from(nu) * nv + j).collect(),
            _ => (0..nu).map(|i| i * nv + from(nv)).collect(),
        }
    }

    fn edges(&self) -> impl Iterator<Item = NetEdge> + '_ {
        let all = (0..4).map(|k| NetEdge { direction: k / 2, end: k % 2 });
        all.filter(|e| !self.spaces[e.direction].is_closed())
    }

    /// How the derivatives by the parameter across an edge hang on rows of points counted from it,
    /// in the direction into the sheet.
    fn across(&self, edge: NetEdge) -> [Vec<f64>; 2] {
        let space = &self.spaces[edge.direction];
        let (start, end) = space.domain();
        let (k, t) = space.locate(if edge.end == 0 { start } else { end });
        let basis = space.basis(k, t);
        let unit = space.mean_span();
        let mut out = [1, 2].map(|order: i32| {
            let sign = if edge.end == 1 && order == 1 { -1.0 } else { 1.0 };
            let row = basis.rows[order as usize].iter();
            row.map(|x| x * sign * unit.powi(order)).collect::<Vec<f64>>()
        });
        if edge.end == 1 {
            out.iter_mut().for_each(|row| row.reverse());
        }
        out
    }
}

/// An edge of a net, at the start or end of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NetEdge {
    /// The parameter that is constant on it: 0 for u, 1 for v.
    pub direction: usize,
    /// 0 at its start, 1 at its end.
    pub end: usize,
}

/// An edge that two surfaces share, or a surface with itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seam {
    /// Numbers of the surfaces, from 0.
    pub sheets: [usize; 2],
    /// The edge of each.
    pub edges: [NetEdge; 2],
    /// True if the second edge has the opposite direction.
    pub reversed: bool,
    /// The continuity across the seam: [`EndContinuity::Position`], [`EndContinuity::Tangent`] or
    /// [`EndContinuity::Curvature`].
    pub keeps: EndContinuity,
}

impl Seam {
    /// The edges shared by sheets, found by identical control points.
    pub fn found(sheets: &[PatchNet], keeps: EndContinuity) -> Vec<Seam> {
        let mut all: Vec<(usize, NetEdge, Vec<Vec3<f64>>)> = Vec::new();
        for (k, sheet) in sheets.iter().enumerate() {
            for edge in sheet.edges() {
                let row = sheet.row(edge, 0).into_iter().map(|i| sheet.points[i]).collect();
                all.push((k, edge, row));
            }
        }
        let size = sheets.iter().map(|s| size(&s.points)).fold(0.0, f64::max);
        let mut seams = Vec::new();
        for (n, (k, edge, row)) in all.iter().enumerate() {
            // An edge that is a point joins nothing.
            if row.iter().all(|p| p.distance(row[0]) <= SAME * size) {
                continue;
            }
            for (l, other, far) in &all[n + 1..] {
                if row.len() != far.len() {
                    continue;
                }
                let near = |turned: bool| {
                    (0..row.len()).all(|i| {
                        let j = if turned { row.len() - 1 - i } else { i };
                        row[i].distance(far[j]) <= SAME * size
                    })
                };
                if let Some(reversed) = [false, true].into_iter().find(|&turned| near(turned)) {
                    let (sheets, edges) = ([*k, *l], [*edge, *other]);
                    seams.push(Seam { sheets, edges, reversed, keeps });
                }
            }
        }
        seams
    }
}

fn size(points: &[Vec3<f64>]) -> f64 {
    let first = points.first().copied().unwrap_or_default();
    points.iter().map(|p| p.distance(first)).fold(0.0, f64::max)
}

impl Network {
    /// Surfaces with common edges: a point on a seam is one point of all its sheets. Each sheet
    /// keeps its corners that are on no seam, two by two points each, and the conditions of its
    /// rims.
    ///
    /// The surfaces come out of [`Network::sheet`]; local passes and sweeps cannot keep more than the
    /// position of seams.
    ///
    /// # Errors
    /// [`FairError::Seam`] when edges do not fit; [`FairError::TurnsBack`] when one sheet runs back over
    /// the other; others as for [`Network::net`].
    pub fn joined(sheets: &[PatchNet], seams: &[Seam]) -> Result<Self, FairError> {
        let starts: Vec<usize> = sheets
            .iter()
            .scan(0, |at, s| {
                let start = *at;
                *at += s.points.len();
                Some(start)
            })
            .collect();
        let count = sheets.iter().map(|s| s.points.len()).sum();
        let nets = sheets.iter().map(net).collect::<Result<Vec<_>, _>>()?;
        let mut same: Vec<usize> = (0..count).collect();
        for (number, seam) in seams.iter().enumerate() {
            check(sheets, seam).map_err(|why| FairError::Seam { number, why })?;
            let row = |k: usize| {
                let start = starts[seam.sheets[k]];
                sheets[seam.sheets[k]].row(seam.edges[k], 0).into_iter().map(move |i| start + i)
            };
            let mut far: Vec<usize> = row(1).collect();
            if seam.reversed {
                far.reverse();
            }
            for (i, j) in row(0).zip(far) {
                let (a, b) = (root(&same, i), root(&same, j));
                same[a.max(b)] = a.min(b);
            }
        }
        // Places in the order of their first sheet.
        let mut place = vec![usize::MAX; count];
        let (mut points, mut radii) = (Vec::new(), Vec::<f64>::new());
        let mut motion = None;
        for (start, sheet) in starts.iter().zip(sheets) {
            motion.get_or_insert(sheet.limit.motion);
            for (i, (p, r)) in sheet.points.iter().zip(&sheet.limit.radii).enumerate() {
                let first = root(&same, start + i);
                if place[first] == usize::MAX {
                    place[first] = points.len();
                    points.push(*p);
                    radii.push(*r);
                }
                place[start + i] = place[first];
                let radius = &mut radii[place[first]];
                *radius = radius.min(*r);
            }
        }
        let limit = Limit { motion: motion.unwrap_or(crate::Motion::Ball), radii };
        let mut patches = Vec::new();
        let mut strands: Vec<crate::NetworkCurve> = Vec::new();
        let mut kept = Vec::new();
        for (k, (net, [corners, rims])) in nets.into_iter().enumerate() {
            let own = starts[k]..starts[k] + sheets[k].points.len();
            let places: Vec<usize> = place[own].to_vec();
            let on_seam = seam_points(&sheets[k], k, seams);
            kept.extend(corners.iter().filter(|i| !on_seam[**i]).map(|&i| places[i]));
            kept.extend(rims.iter().map(|&i| places[i]));
            for strand in &net.strands {
                let mut own = strand.clone();
                own.points.iter_mut().for_each(|i| *i = places[*i]);
                // The seam itself is one curve of both sheets.
                let twin = |s: &crate::NetworkCurve| {
                    s.points == own.points || s.points.iter().rev().eq(&own.points)
                };
                if !strands.iter().any(twin) {
                    strands.push(own);
                }
            }
            patches.push(PlacedNet { net, places });
        }
        kept.sort_unstable();
        kept.dedup();
        let mut network = Network::new(points, strands, limit)?;
        network.kept = kept;
        for seam in seams {
            let side = |k: usize| {
                let sheet = &sheets[seam.sheets[k]];
                let factors = sheet.across(seam.edges[k]);
                let depth = factors[0].len();
                let start = starts[seam.sheets[k]];
                let rows: Vec<Vec<usize>> =
                    (0..depth).map(|d| sheet.row(seam.edges[k], d)).collect();
                let mut along: Vec<Vec<usize>> = (0..rows[0].len())
                    .map(|j| rows.iter().map(|row| place[start + row[j]]).collect())
                    .collect();
                if k == 1 && seam.reversed {
                    along.reverse();
                }
                (along, factors)
            };
            let ((a, fa), (b, fb)) = (side(0), side(1));
            let across = SeamCondition { rows: [a, b], factors: [fa, fb], keeps: seam.keeps };
            network.seams.extend(across.conditions(&network.points)?);
            network.across.push(across);
        }
        network.patches = patches;
        network.check()?;
        Ok(network)
    }

    /// The control points of one of the joined surfaces.
    pub fn sheet<T: Copy>(&self, k: usize, points: &[T]) -> Vec<T> {
        self.patches[k].places.iter().map(|&i| points[i]).collect()
    }

    /// Points of the sheets one after the other, as points of the network.
    pub fn gathered<T: Copy>(&self, sheets: &[T]) -> Vec<T> {
        let mut out: Vec<Option<T>> = vec![None; self.points.len()];
        let all = self.patches.iter().flat_map(|p| &p.places);
        for (&place, x) in all.zip(sheets) {
            out[place].get_or_insert(*x);
        }
        out.into_iter().flatten().collect()
    }

    /// How the conditions of seams bend with the points given, which carry derivatives.
    pub(crate) fn bends<T: Real>(&self, given: &[Vec3<T>]) -> Result<Vec<Bend<T>>, FairError> {
        let mut out = Vec::new();
        for across in &self.across {
            out.extend(across.bends(given, out.len())?);
        }
        Ok(out)
    }
}

fn root(same: &[usize], mut i: usize) -> usize {
    while same[i] != i {
        i = same[i];
    }
    i
}

/// The net of a sheet, and what stays fixed in it: corners, then rims and breaks.
#[allow(clippy::type_complexity)]
fn net(sheet: &PatchNet) -> Result<(Network, [Vec<usize>; 2]), FairError> {
    let (points, limit) = (sheet.points.clone(), sheet.limit.clone());
    let mut net = Network::net(sheet.spaces.clone(), points, sheet.weights.clone(), limit)?;
    let corners = std::mem::take(&mut net.kept);
    let net = net.with_breaks(&sheet.breaks[0], &sheet.breaks[1])?.with_rims(sheet.rims)?;
    let rims = net.kept.clone();
    Ok((net, [corners, rims]))
}

/// True for points of a sheet within two rows of a seam of it.
fn seam_points(sheet: &PatchNet, number: usize, seams: &[Seam]) -> Vec<bool> {
    let mut on = vec![false; sheet.points.len()];
    for seam in seams {
        for k in 0..2 {
            if seam.sheets[k] == number {
                for depth in 0..2 {
                    sheet.row(seam.edges[k], depth).into_iter().for_each(|i| on[i] = true);
                }
            }
        }
    }
    on
}

/// Refuses edges that cannot be joined.
fn check(sheets: &[PatchNet], seam: &Seam) -> Result<(), String> {
    let count = sheets.len();
    if let Some(k) = seam.sheets.iter().find(|&&k| k >= count) {
        return Err(format!("there is no surface {}", k + 1));
    }
    let [a, b] = [0, 1].map(|k| (&sheets[seam.sheets[k]], seam.edges[k]));
    for (sheet, edge) in [a, b] {
        let space = &sheet.spaces[edge.direction.min(1)];
        if edge.direction > 1 || edge.end > 1 || space.is_closed() {
            return Err("the surface has no such edge".to_owned());
        }
        if seam.keeps.kept() >= 2 && (!space.is_clamped() || space.degree() < 2) {
            return Err("tangents across an edge need clamped knots of degree 2 or more".to_owned());
        }
        if seam.keeps.kept() >= 2 && sheet.weights.is_some() {
            return Err(
                "for rational surfaces only the position of a seam can be preserved".to_owned()
            );
        }
    }
    let along = |(sheet, edge): (&PatchNet, NetEdge)| sheet.spaces[1 - edge.direction].clone();
    let (near, far) = (along(a), along(b));
    if near.count() != far.count() {
        return Err(format!(
            "one edge has {} control points, the other {}",
            near.count(),
            far.count()
        ));
    }
    let unit = |space: &Space| -> Vec<f64> {
        let (start, end) = space.domain();
        space.knots().iter().map(|t| (t - start) / (end - start)).collect()
    };
    let mut knots = [unit(&near), unit(&far)];
    if seam.reversed {
        knots[1] = knots[1].iter().rev().map(|t| 1.0 - t).collect();
    }
    let apart = knots[0].iter().zip(&knots[1]).any(|(s, t)| (s - t).abs() > 1e-9);
    if near.degree() != far.degree() || knots[0].len() != knots[1].len() || apart {
        return Err("the edges differ in degree or knots".to_owned());
    }
    let row = |(sheet, edge): (&PatchNet, NetEdge)| sheet.row(edge, 0);
    let mut others = row(b);
    if seam.reversed {
        others.reverse();
    }
    let size = size(&a.0.points).max(size(&b.0.points));
    for (j, (i, k)) in row(a).into_iter().zip(others).enumerate() {
        let gap = a.0.points[i].distance(b.0.points[k]);
        if gap > SAME * size {
            return Err(format!("control point {} of the edges is {gap:e} apart", j + 1));
        }
        let weight = |s: &PatchNet, i: usize| s.weights.as_ref().map_or(1.0, |w| w[i]);
        if weight(a.0, i) != weight(b.0, k) {
            return Err(format!("control point {} of the edges has two weights", j + 1));
        }
    }
    Ok(())
}
