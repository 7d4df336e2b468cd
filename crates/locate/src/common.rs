//! Common points of three shapes: surfaces, planes, zero sets of implicit functions.
//!
//! With m surfaces, which come first, the unknowns are their parameters, 2 m of them. The search for
//! all such points halves the pieces of the surfaces while they may meet each other and the planes,
//! until they are so flat that Newton's method from the middle finds the one point there can be.

use crate::march::Other;
use crate::newton::{NewtonResult, UnknownBounds, newton};
use crate::pieces::{BezierPatch, meet};
use crate::report::{LocateReport, Roots, Solution};
use crate::roots::{FLAT, RootCollector, TANGENT, from_all, taken};
use crate::tree::SurfaceTree;
use moldloft_num::{Order, Surface, Vec3, slope_scale};
use smallvec::SmallVec;

/// Three shapes, the surfaces first; N is twice the number of surfaces.
pub struct Three<'a, const N: usize>(pub [Other<'a>; 3]);

impl<const N: usize> Three<'_, N> {
    fn surfaces(&self) -> impl Iterator<Item = &dyn Surface<f64>> {
        self.0.iter().filter_map(|shape| match shape {
            Other::Surface(surface) => Some(*surface),
            _ => None,
        })
    }

    /// For each unknown, true if closed.
    fn closed(&self) -> [bool; N] {
        let mut all = self.surfaces().flat_map(|surface| surface.closed());
        std::array::from_fn(|_| all.next().unwrap_or(false))
    }

    /// Residuals of the equations, and their derivatives with respect to the unknowns.
    fn residual(&self, q: [f64; N]) -> ([f64; N], [[f64; N]; N]) {
        let (mut r, mut m) = ([0.0; N], [[0.0; N]; N]);
        let mut row = 0;
        let mut first = None;
        for (k, shape) in self.0.iter().enumerate() {
            match (*shape, first) {
                (Other::Surface(surface), None) => {
                    first = Some(surface.jet(q[0], q[1], Order::First));
                }
                (Other::Surface(surface), Some(j)) => {
                    let s = surface.jet(q[2 * k], q[2 * k + 1], Order::First);
                    let gap = (j.p - s.p).to_array();
                    let columns = [j.u, j.v, -s.u, -s.v].map(Vec3::to_array);
                    for axis in 0..3 {
                        r[row] = gap[axis];
                        m[row][0] = columns[0][axis];
                        m[row][1] = columns[1][axis];
                        m[row][2 * k] = columns[2][axis];
                        m[row][2 * k + 1] = columns[3][axis];
                        row += 1;
                    }
                }
                (other, Some(j)) => {
                    let (value, normal) = level(other, j.p);
                    r[row] = value;
                    m[row][0] = normal.dot(j.u);
                    m[row][1] = normal.dot(j.v);
                    row += 1;
                }
                (_, None) => {}
            }
        }
        (r, m)
    }

    /// The volume that the three unit normals span: 1 where they are perpendicular, 0 where the
    /// shapes have a direction in common.
    fn volume(&self, q: [f64; N]) -> f64 {
        let mut x = Vec3::zero();
        let mut normals = [Vec3::zero(); 3];
        for (k, shape) in self.0.iter().enumerate() {
            normals[k] = match *shape {
                Other::Surface(surface) => {
                    let j = surface.jet(q[2 * k], q[2 * k + 1], Order::First);
                    if k == 0 {
                        x = j.p;
                    }
                    j.normal()
                }
                other => level(other, x).1.normalized().unwrap_or_default(),
            };
        }
        normals[0].cross(normals[1]).dot(normals[2]).abs()
    }

    fn place(&self, q: [f64; N]) -> Vec3 {
        self.surfaces().next().map_or_else(Vec3::zero, |s| s.jet(q[0], q[1], Order::Zero).p)
    }

    fn walk(&self, start: [f64; N], size: f64) -> NewtonResult<N> {
        newton(start, &self.closed().map(UnknownBounds::parameter), size, |q| self.residual(q))
    }

    /// The common point to which Newton's method converges from a start. Without a start, or if
    /// that fails, the one of all common points nearest to the start in parameter space (by default
    /// to the middle), or to the point `near` if given.
    ///
    /// # Errors
    /// The report if there is no solution.
    pub fn point(
        &self,
        start: Option<[f64; N]>,
        near: Option<Vec3>,
    ) -> Result<Solution<N>, LocateReport> {
        let trees: SmallVec<[SurfaceTree; 3]> = self.surfaces().map(SurfaceTree::new).collect();
        let size = trees.iter().map(|t| t.size).fold(f64::INFINITY, f64::min);
        if let Some(q) = start {
            let walk = self.walk(q, size).within(&self.closed());
            if let Some(found) = taken(&walk, &q, self.volume(walk.at)) {
                return Ok(found);
            }
        }
        let all = self.all(&trees, size);
        let from = start.unwrap_or([0.5; N]);
        from_all(all, start.as_ref().map(<[f64; N]>::as_slice), |all| match near {
            None => all.nearest_to(&from),
            Some(p) => {
                let away = |k: &usize| all.roots[*k].xyz.distance(p);
                let count = all.roots.len();
                (0..count).min_by(|a, b| away(a).total_cmp(&away(b)).then(a.cmp(b)))
            }
        })
    }

    fn all(&self, trees: &[SurfaceTree], size: f64) -> Roots<N> {
        let mut search = RootCollector::<N>::new(size, &[0.5; N], self.closed());
        let mut stack: Vec<SmallVec<[BezierPatch; 3]>> =
            trees[0].patches.iter().map(|p| SmallVec::from_slice(&[*p])).collect();
        while let Some(cell) = stack.pop() {
            // One patch of each surface, as far as they meet.
            if cell.len() < trees.len() {
                for k in trees[cell.len()].meeting(&cell[0].bounds()) {
                    let mut next = cell.clone();
                    next.push(trees[cell.len()].patches[k as usize]);
                    stack.push(next);
                }
                continue;
            }
            if search.exhausted() {
                break;
            }
            if !self.may_meet(&cell) {
                continue;
            }
            let lengths: SmallVec<[[f64; 2]; 3]> = cell.iter().map(BezierPatch::lengths).collect();
            let longest = |l: &[f64; 2]| l[0].max(l[1]);
            let flat = cell.iter().zip(&lengths).all(|(p, l)| p.bend() <= FLAT * l[0].min(l[1]));
            let most = lengths.iter().map(longest).fold(0.0, f64::max);
            let tiny = most < 1e-6 * size;
            if flat || tiny {
                let middle: [f64; N] = std::array::from_fn(|k| cell[k / 2].middle()[k % 2]);
                let ranges: [[f64; 2]; N] = std::array::from_fn(|k| cell[k / 2].uv[k % 2]);
                let walk = self.walk(middle, size);
                let facts = |q: [f64; N]| (self.place(q), self.volume(q) < TANGENT);
                search.offer(&walk, ranges, facts);
                let left = (0..N).any(|k| {
                    let [a, b] = ranges[k];
                    walk.at[k] < a - 2.0 * (b - a) || walk.at[k] > b + 2.0 * (b - a)
                });
                if tiny || self.volume(middle) > 0.2 && (walk.found || left) {
                    continue;
                }
            }
            let k = (0..cell.len()).find(|&k| longest(&lengths[k]) == most).unwrap_or(0);
            for half in cell[k].halves(usize::from(lengths[k][1] > lengths[k][0])) {
                let mut next = cell.clone();
                next[k] = half;
                stack.push(next);
            }
        }
        search.finish()
    }

    fn may_meet(&self, cell: &[BezierPatch]) -> bool {
        let boxes: SmallVec<[moldloft_num::Box3; 3]> =
            cell.iter().map(BezierPatch::bounds).collect();
        let apart = (1..cell.len()).any(|k| (0..k).any(|l| !meet(&boxes[k], &boxes[l])));
        if apart {
            return false;
        }
        self.0.iter().all(|shape| match *shape {
            Other::Plane(plane) => {
                let patch = &cell[0];
                let d = patch.net.map(|p| plane.distance(p));
                let low = d.iter().copied().fold(f64::INFINITY, f64::min);
                let high = d.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                low <= patch.slack && high >= -patch.slack
            }
            Other::Level(field) => {
                field.bounds(&boxes[0]).is_none_or(|[low, high]| low <= 0.0 && high >= 0.0)
            }
            Other::Surface(_) => true,
        })
    }
}

/// The value of a plane or an implicit function as a length, and its gradient.
fn level(shape: Other<'_>, x: Vec3) -> (f64, Vec3) {
    match shape {
        Other::Plane(plane) => (plane.distance(x), plane.normal),
        Other::Level(field) => {
            let (f, g) = field.value_and_gradient(x);
            let scale = slope_scale(g);
            (f * scale, g * scale)
        }
        Other::Surface(_) => (0.0, Vec3::zero()),
    }
}
