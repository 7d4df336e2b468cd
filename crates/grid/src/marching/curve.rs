//! Marching off a curve: in its plane, or on a surface that the grid stays on (a collar).

use super::crossing::{BoundaryPart, edges_cross, first_crossing, lowered};
use super::front::{self, EDGE_SHARE, Front, MarchStep};
use super::line::{BlockTridiagonal, LineEnd, Matrix, smoothed};
use super::marched::Marched;
use super::outcome::{MarchFailure, MarchPlace};
use super::report::{self, Worst};
use super::settings::{Hyperbolic, MarchBoundary};
use crate::{GridError, SurfaceGrid};
use moldloft_budget::Budget;
use moldloft_num::{Real, Vec3};

/// A surface that a grid stays on while it is marched.
pub trait Support<T: Real>: Sync {
    /// The nearest point of the surface to each point, and the unit normal there.
    fn project(&self, points: &[Vec3<T>]) -> Vec<(Vec3<T>, Vec3<T>)>;
}

struct MarchPlane<T> {
    normal: Vec3<T>,
}

impl<T: Real> Support<T> for MarchPlane<T> {
    fn project(&self, points: &[Vec3<T>]) -> Vec<(Vec3<T>, Vec3<T>)> {
        points.iter().map(|p| (*p, self.normal)).collect()
    }
}

/// The grid marched off a curve, to the left of its direction as seen against the plane's normal: line s\[k,\] of
/// the value is layer k.
///
/// # Errors
/// As [`super::hyperbolic`]; [`GridError::EdgesApart`] when a periodic curve does not close.
pub fn hyperbolic_curve<T: Real>(
    curve: &[Vec3<T>],
    normal: Vec3<T>,
    options: &Hyperbolic<T>,
) -> Result<Marched<T>, GridError> {
    let unit = normal
        .normalized()
        .ok_or(GridError::NoNormal { at: MarchPlace { surface: None, at: [1, 1] } })?;
    hyperbolic_curve_until(curve, &MarchPlane { normal: unit }, options, &Budget::default())
}

/// As [`hyperbolic_curve`], in a plane or on any other support, to the left as seen against its normal; ends when
/// `budget` is spent.
///
/// # Errors
/// Also [`GridError::Spent`].
pub fn hyperbolic_curve_until<T: Real>(
    curve: &[Vec3<T>],
    support: &dyn Support<T>,
    options: &Hyperbolic<T>,
    budget: &Budget,
) -> Result<Marched<T>, GridError> {
    let n = curve.len();
    if n < 3 {
        return Err(GridError::TooFew { expected: 3, actual: [n, 1] });
    }
    if let Some(k) = curve.iter().position(|p| !p.is_finite()) {
        return Err(GridError::NotFinite { at: [k + 1, 1] });
    }
    report::check_heights(&options.heights)?;
    let closed =
        options.sides[0] == MarchBoundary::Periodic || options.sides[1] == MarchBoundary::Periodic;
    let mut wall = curve.to_vec();
    if closed {
        report::check_seam(&[(curve[0].re(), curve[n - 1].re(), [n, 1])], curve)?;
        wall.pop();
        if wall.len() < 3 {
            return Err(GridError::TooFew { expected: 4, actual: [n, 1] });
        }
    }
    let ends = [options.sides[0], options.sides[1]];
    let front = CurveFront { wall, support, closed, ends };
    let outcome = front::march(&front, options, budget)?;
    let angles = front.wall_angles(&outcome.layers);
    let (layers, report) = report::settled(&front, options, outcome, angles)?;
    let seam = usize::from(closed);
    let width = front.wall.len() + seam;
    let points = layers.iter().flat_map(|l| (0..width).map(move |j| l[j % l.len()]));
    let grid = SurfaceGrid::of_points(layers.len(), width, points);
    Ok(Marched { layers: vec![grid], report })
}

struct CurveFront<'a, T: Real> {
    /// The unique points.
    wall: Vec<Vec3<T>>,
    support: &'a dyn Support<T>,
    closed: bool,
    ends: [MarchBoundary; 2],
}

struct CurveNode<T> {
    next: Vec3<T>,
    last: Vec3<T>,
    /// Lengths of the edges to them.
    lengths: [T; 2],
    /// The unit bisector, pointing to the grid's side.
    normal: Vec3<T>,
    /// Sine and cosine of half the angle on the grid's side.
    sine: T,
    cosine: T,
}

impl<T: Real> CurveNode<T> {
    /// The mean length of the edges.
    fn length(&self) -> T {
        (self.lengths[0] + self.lengths[1]) * 0.5
    }

    /// A corner so sharp that its motion is prescribed: more than 240 degrees on the grid's side.
    fn sharp(&self) -> bool {
        self.cosine.re() < -0.5
    }
}

/// Half angles whose sine is less count as this: a cusp's is zero.
pub(super) const LEAST_SINE: f64 = 1e-4;

/// The half angle, by its cosine, below which a corner counts as acute: 80 degrees.
pub(super) const ACUTE: f64 = 0.173_648_177_666_930_33;

impl<T: Real> CurveFront<'_, T> {
    fn neighbours(&self, r: &[Vec3<T>], k: usize) -> [Vec3<T>; 2] {
        let n = r.len();
        let next = match k + 1 < n {
            true => r[k + 1],
            false if self.closed => r[0],
            false => self.ends[1].beyond(r[k], r[k - 1]),
        };
        let last = match k > 0 {
            true => r[k - 1],
            false if self.closed => r[n - 1],
            false => self.ends[0].beyond(r[0], r[1]),
        };
        [next, last]
    }

    fn nodes(&self, r: &[Vec3<T>], up: &[Vec3<T>]) -> Vec<CurveNode<T>> {
        (0..r.len())
            .map(|k| {
                let [next, last] = self.neighbours(r, k);
                let (p, m) = (next - r[k], last - r[k]);
                let lengths = [p.norm(), m.norm()];
                let (p, m) = (p / lengths[0], m / lengths[1]);
                let along = p - m;
                let twice = along.norm();
                // A plate without thickness has no bisector: its end is left straight ahead.
                let normal = match twice.re() > 1e-9 {
                    true => up[k].cross(along) / twice,
                    false => -p,
                };
                let sine = (twice * 0.5).max(T::from(LEAST_SINE));
                CurveNode { next, last, lengths, normal, sine, cosine: normal.dot(p) }
            })
            .collect()
    }

    fn ups(&self, r: &[Vec3<T>]) -> Vec<Vec3<T>> {
        self.support.project(r).into_iter().map(|(_, up)| up).collect()
    }

    /// Zeroes the component of steps normal to the plane of an end.
    fn keep_planes(&self, from: &[Vec3<T>], to: &mut [Vec3<T>]) {
        if self.closed {
            return;
        }
        let last = to.len() - 1;
        for (end, k) in [(0, 0), (1, last)] {
            let kept = self.ends[end].kept();
            let mut p = to[k].to_array();
            for c in (0..3).filter(|c| kept[*c]) {
                p[c] = from[k][c];
            }
            to[k] = p.into();
        }
    }

    /// The cells between the first two layers: distance of the upper from the wall, and the deviation of the
    /// lines from the bisectors, in radians.
    fn wall_angles(&self, layers: &[Vec<Vec3<T>>]) -> Vec<(f64, f64)> {
        let Some(first) = layers.get(1) else { return Vec::new() };
        let nodes = self.nodes(&self.wall, &self.ups(&self.wall));
        let each = nodes.iter().zip(self.wall.iter().zip(first)).map(|(node, (a, b))| {
            let line = (*b - *a).re();
            let normal = node.normal.re();
            let angle = libm::atan2(line.cross(normal).norm(), line.dot(normal));
            let concave = node.cosine.re() > 0.0;
            (line.norm() * if concave { node.sine.re() } else { 1.0 }, angle)
        });
        each.collect()
    }
}

impl<T: Real> Front<T> for CurveFront<'_, T> {
    fn wall(&self) -> &[Vec3<T>] {
        &self.wall
    }

    fn cell_place(&self, cell: usize) -> (MarchPlace, usize) {
        (self.place(cell), cell)
    }

    fn place(&self, k: usize) -> MarchPlace {
        MarchPlace { surface: None, at: [k + 1, 1] }
    }

    fn first_layer(&self, height: T) -> Result<Option<Vec<Vec3<T>>>, MarchFailure> {
        let nodes = self.nodes(&self.wall, &self.ups(&self.wall));
        let mut layer = Vec::with_capacity(nodes.len());
        let mut fits = true;
        for (k, node) in nodes.iter().enumerate() {
            let mut travel = height;
            if node.cosine.re() > 1e-3 {
                travel = height / node.sine;
                fits &= report::fits_corner(
                    [node.sine.re(), node.cosine.re()],
                    node.lengths[0].re().min(node.lengths[1].re()),
                    height.re(),
                )
                .map_err(|cause| MarchFailure {
                    layer: 2,
                    at: self.place(k),
                    wall: self.wall[k].re(),
                    cause,
                })?;
            }
            layer.push(self.wall[k] + node.normal * travel);
        }
        if !fits {
            return Ok(None);
        }
        let mut layer: Vec<_> = self.support.project(&layer).into_iter().map(|(p, _)| p).collect();
        self.keep_planes(&self.wall, &mut layer);
        Ok(Some(layer))
    }

    fn step_limit(&self, r: &[Vec3<T>], _: bool) -> (f64, usize) {
        let n = r.len();
        let count = if self.closed { n } else { n - 1 };
        let edges = (0..count).map(|k| (r[(k + 1) % n].re().distance(r[k].re()), k));
        let shortest =
            edges.fold((f64::INFINITY, 0), |best, edge| if edge.0 < best.0 { edge } else { best });
        (EDGE_SHARE * shortest.0, shortest.1)
    }

    fn has_long_steps(&self) -> bool {
        false
    }

    fn mean_edge(&self, r: &[Vec3<T>]) -> f64 {
        let n = r.len();
        let count = if self.closed { n } else { n - 1 };
        let edges = (0..count).map(|k| r[(k + 1) % n].re().distance(r[k].re()));
        edges.sum::<f64>() / count as f64
    }

    fn step(&self, step: MarchStep<'_, T>, _: &Budget) -> Vec<Vec3<T>> {
        let MarchStep { r, before, d, s, last, smoothed: state, cap, dissipation, first } = step;
        let n = r.len();
        let half = T::from(0.5);
        let ups = self.ups(r);
        let nodes = self.nodes(r, &ups);
        // Volumes: of the layer to come where that is wider, smoothed.
        let plain: Vec<T> = {
            let q: Vec<Vec3<T>> = (0..n).map(|k| r[k] + nodes[k].normal * d).collect();
            let each = nodes.iter().enumerate().map(|(k, node)| {
                let volume = d * node.length() * node.sine;
                if node.sharp() {
                    return volume;
                }
                let [next, last] = self.neighbours(&q, k);
                let (a, b) = (node.next - node.last, next - last);
                // At acute corners volumes stay: there lines are pushed apart.
                let least = if node.cosine.re() > ACUTE { 1.0 } else { 0.3 };
                volume * (a.dot(b) / a.norm_sq()).max(T::from(least)).min(T::from(2.0))
            });
            each.collect()
        };
        let reach: Vec<T> =
            nodes.iter().map(|node| s * d * 2.0 / (node.length() * node.length())).collect();
        let ends = (!self.closed).then_some([LineEnd::Open; 2]);
        let mut volumes = smoothed(&reach, &plain, ends);
        let spans: Vec<(T, T)> = (0..n)
            .map(|k| {
                let [next, last] = self.neighbours(before, k);
                let now = nodes[k].lengths[0] + nodes[k].lengths[1];
                (now, (next - before[k]).norm() + (last - before[k]).norm())
            })
            .collect();
        if let Some(cap) = cap {
            for k in 0..n {
                let mut share = volumes[k] / plain[k];
                let (now, then) = spans[k];
                if then.re() <= now.re() * 1.0001 {
                    share = share.max(state[k] * (1.0 / cap)).min(state[k] * cap);
                }
                state[k] = share;
                volumes[k] = share * plain[k];
            }
        }
        let shift = report::shift(s, last);
        let mut system = BlockTridiagonal::unit(n);
        for (k, node) in nodes.iter().enumerate() {
            let length = node.length() * node.sine;
            let h = volumes[k] / length;
            if node.sharp() {
                system.right[k] = node.normal * h;
                continue;
            }
            // Uneven spacing turns the central difference off the bisector: it counts as the layers rise.
            let central = ups[k].cross(node.next - node.last);
            let e = central * (shift / central.norm()) + node.normal * (T::one() - shift);
            let e = e / e.norm();
            let along = e.cross(ups[k]);
            let aspect = h / length;
            let mut epsilon = if first {
                T::zero()
            } else {
                let concave = if node.cosine.re() > 0.0 {
                    T::one() / (node.sine * node.sine)
                } else {
                    T::one()
                };
                let converge = report::convergence(spans[k].1 / spans[k].0, shift);
                shift * converge * concave * aspect * dissipation
            };
            if node.cosine.re() > ACUTE {
                let ripe = s * node.cosine / node.sine / (node.length() * 0.3);
                epsilon *= ripe.min(T::one());
            }
            let mut pull = (node.next + node.last - r[k] * T::from(2.0)) * epsilon;
            pull -= ups[k] * pull.dot(ups[k]);
            let back = pull.dot(e);
            if back.re() < 0.0 {
                pull -= e * back;
            }
            system.right[k] = e * h + pull;
            // C^-1 A: symmetric, with the eigenvalues plus and minus h over the length.
            let (t, e) = (along.to_array(), e.to_array());
            let term: Matrix<T> = std::array::from_fn(|a| {
                std::array::from_fn(|b| (t[a] * e[b] + e[a] * t[b]) * aspect * half)
            });
            let implicit = epsilon * 2.0;
            let (mut low, mut high) = (term, term);
            for a in 0..3 {
                for b in 0..3 {
                    low[a][b] = -low[a][b];
                }
                low[a][a] -= implicit;
                high[a][a] -= implicit;
                system.middle[k][a][a] += implicit * 2.0;
            }
            let open_end = |end: usize| !self.closed && k == [0, n - 1][end];
            if open_end(0) {
                self.ends[0].close(&mut system.middle[k], &low, &mut high);
            } else if open_end(1) {
                self.ends[1].close(&mut system.middle[k], &high, &mut low);
            }
            if !open_end(0) {
                system.low[k] = low;
            }
            if !open_end(1) {
                system.high[k] = high;
            }
        }
        let moved = system.solved(self.closed);
        let next: Vec<Vec3<T>> = r.iter().zip(&moved).map(|(p, d)| *p + *d).collect();
        let mut next: Vec<_> = self.support.project(&next).into_iter().map(|(p, _)| p).collect();
        self.keep_planes(r, &mut next);
        next
    }

    fn crossing(&self, layers: &[Vec<Vec3<T>>]) -> Option<[usize; 2]> {
        let n = self.wall.len();
        let count = if self.closed { n } else { n - 1 };
        let last = layers.len() - 1;
        let front = lowered(layers);
        let at =
            |layer: usize, k: usize| if layer == last { front[k] } else { layers[layer][k].re() };
        let edge = |[a, b]: [[usize; 2]; 2]| BoundaryPart {
            corners: [at(a[0], a[1]), at(b[0], b[1]), at(b[0], b[1])],
            foot: [a[1], b[1], b[1], b[1]],
        };
        let along =
            |layer: usize| (0..count).map(move |k| [[layer, k], [layer, (k + 1) % n]]).map(edge);
        let ends: &[usize] = if self.closed { &[] } else { &[0, n - 1] };
        let sides = ends.iter().flat_map(|&k| (0..last).map(move |l| [[l, k], [l + 1, k]]));
        let parts: Vec<BoundaryPart> = along(last).chain(sides.map(edge)).chain(along(0)).collect();
        let ups = self.ups(&layers[last]);
        let found = first_crossing(&parts, parts.len() - count, |a, b| {
            edges_cross(a, b, ups[a.foot[0]].re())
        });
        found.map(|pair| pair.map(|part| parts[part].foot[0]))
    }

    fn worst_cell(&self, below: &[Vec3<T>], above: &[Vec3<T>]) -> Worst {
        let n = below.len();
        let count = if self.closed { n } else { n - 1 };
        let ups = self.ups(below);
        let mut worst = Worst::none();
        for k in 0..count {
            let l = (k + 1) % n;
            let corners = [below[k], below[l], above[l], above[k]].map(|p| p.re());
            worst.take(k, report::quad(corners, ups[k].re()));
        }
        worst
    }
}
