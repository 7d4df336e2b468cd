//! A body: the cells of its skin, its open rims, and bounds on the distance between cells and
//! surfaces.

use crate::attitude::Attitude;
use crate::bernstein::halves;
use crate::cell::{FitLimits, PolynomialCell, cells_of};
use crate::folds::fold;
use crate::integrals::{HalvedCell, HydrostaticIntegrals, Immersed, Wanted, immersed};
use crate::moments::BodyMoments;
use crate::strip::NEGLIGIBLE;
use crate::trimmed::TrimLoops;
use moldloft_mesh::Mesh;
use moldloft_num::{Box3, Real, Surface, Vec3};
use std::any::Any;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// Default relative accuracy of figures.
pub const USUAL_ACCURACY: f64 = 1e-6;

/// Accuracy of quadrature and interpolation, relative to that of figures, which combine several
/// integrals.
const SHARE: f64 = 1e-2;

/// Relative error at which rounding exceeds the gain of finer rules.
const FINEST: f64 = 1e-11;

/// Rounding error of a coordinate, in units of the rounding of the largest one.
const COORDINATE_ROUNDINGS: f64 = 2.0;

/// Tolerance of rims in a plane, relative to the size of the body: far above rounding, far below a
/// panel.
const SAME_PLACE: f64 = 1e-9;

/// A surface that bounds a body.
#[derive(Clone, Copy)]
pub struct HullSide<'a, T: Real> {
    /// The surface.
    pub surface: &'a dyn Surface<T>,
    /// True when its outward normal is -S_u x S_v.
    pub reversed: bool,
    /// True for each of the edges v = 0, u = 1, v = 1, u = 0 that is not joined.
    pub open_edges: [bool; 4],
    /// The loops of the part that bounds the body; `None` for the whole surface.
    pub loops: Option<&'a TrimLoops<'a, T>>,
}

/// The skin of a body as polynomial cells.
#[derive(Clone, Debug)]
pub struct Body<T> {
    cells: Vec<Arc<PolynomialCell<T>>>,
    /// Control points of the open edges of the skin.
    rims: Vec<Vec<Vec3<T>>>,
    /// See [`Self::folds`].
    folds: Vec<(usize, Vec3)>,
    /// Numbers of cells up to the end of each side; cells of panels follow.
    ends: Vec<usize>,
    size: f64,
    accuracy: f64,
    /// Made when first asked for, as [`Self::real`] is.
    moments: OnceLock<Arc<BodyMoments<T>>>,
    real: OnceLock<Arc<Body<f64>>>,
}

/// Areas, volume and centres of a whole skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMeasures<T> {
    /// Area of the skin.
    pub area: T,
    /// Centre of the skin's area.
    pub area_centre: Vec3<T>,
    /// Enclosed volume; meaningful for a closed skin.
    pub volume: T,
    /// Centre of the volume.
    pub centroid: Vec3<T>,
    /// The volume of an open skin is that of the cone from this point.
    pub middle: Vec3,
    /// Estimates of the errors of area and volume.
    pub bounds: [f64; 2],
    /// The largest component of the integral of the normal: zero for a closed skin.
    pub open: f64,
}

/// Area, volume and centres of one surface; `None` if a point is not finite.
pub fn surface_measures<T: Real>(
    surface: &dyn Surface<T>,
    accuracy: f64,
) -> Option<BodyMeasures<T>> {
    part_measures(surface, None, accuracy)
}

/// Area, volume and centres of a surface, or of its part within loops; `None` if a point is not finite, or loops bound
/// no part.
pub fn part_measures<T: Real>(
    surface: &dyn Surface<T>,
    loops: Option<&TrimLoops<'_, T>>,
    accuracy: f64,
) -> Option<BodyMeasures<T>> {
    let steps: Vec<f64> = (0..=6).map(|k| f64::from(k) / 6.0).collect();
    let mut points = vec![Vec3::zero(); steps.len() * steps.len()];
    surface.grid(&steps, &steps, &mut points, None);
    if !points.iter().all(|p| p.is_finite()) {
        return None;
    }
    let size = Box3::around(points.iter().map(|p| p.re())).diagonal();
    let side = HullSide { surface, reversed: false, open_edges: [false; 4], loops };
    Some(Body::new(&[side], [], Vec::new(), size, accuracy)?.measures())
}

/// The tolerances of the cells of a body of that size.
pub(crate) fn fit_limits(size: f64, accuracy: f64) -> FitLimits {
    FitLimits {
        distance: 1e-2 * SHARE * accuracy * size,
        area: 0.1 * SHARE * accuracy * size * size,
        relative: (SHARE * accuracy).max(1e-11),
    }
}

/// The corner of a part of a cell that is lowest.
struct LowestPlace<T> {
    value: T,
    root: usize,
    /// The halvings of the cell.
    path: Vec<[u8; 2]>,
    corner: usize,
}

fn along<T: Real>(p: Vec3<T>, direction: Vec3<f64>) -> T {
    p.x * direction.x + p.y * direction.y + p.z * direction.z
}

impl<T: Real> Body<T> {
    /// The body bounded by surfaces and by panels of other skins. `size` is approximately its
    /// diagonal. `None` if a point of a surface is not finite, or loops bound no part of it.
    pub fn new(
        sides: &[HullSide<'_, T>],
        panels: impl IntoIterator<Item = [Vec3<T>; 4]>,
        rims: Vec<Vec<Vec3<T>>>,
        size: f64,
        accuracy: f64,
    ) -> Option<Self> {
        let limits = fit_limits(size, accuracy);
        let mut body = Self { rims, ..Self::of_cells(Vec::new(), size, accuracy) };
        for (k, side) in sides.iter().enumerate() {
            let cells = cells_of(side.surface, side.loops, side.reversed, limits)?;
            for edge in (0..4).filter(|&edge| side.open_edges[edge]) {
                let rim = cells.iter().filter(|c| c.on_edge(edge));
                body.rims.extend(rim.map(|c| c.edge(edge)));
            }
            if T::PARTS == 1 {
                body.folds.extend(fold(&cells).map(|at| (k, at)));
            }
            body.cells.extend(cells.into_iter().map(Arc::new));
            body.ends.push(body.cells.len());
        }
        body.cells.extend(panels.into_iter().map(|p| Arc::new(PolynomialCell::of_panel(p))));
        Some(body)
    }

    /// The body bounded by the panels of a mesh, exactly; the open edges of the mesh are its rims.
    pub fn of_mesh(mesh: &Mesh<T>, accuracy: f64) -> Self {
        let size = mesh.bounds().diagonal();
        let at = |v: u32| mesh.positions()[v as usize];
        let panels = mesh.skin_faces().into_iter().map(|f| mesh.faces()[f].map(at));
        let rims = mesh.open_skin_edges().into_iter().map(|(_, e)| e.map(at).to_vec()).collect();
        let cells = panels.map(|p| Arc::new(PolynomialCell::of_panel(p))).collect();
        Self { rims, ..Self::of_cells(cells, size, accuracy) }
    }

    /// The body of cells, without rims.
    pub(crate) fn of_cells(cells: Vec<Arc<PolynomialCell<T>>>, size: f64, accuracy: f64) -> Self {
        let (rims, folds, ends) = (Vec::new(), Vec::new(), Vec::new());
        let (moments, real) = (OnceLock::new(), OnceLock::new());
        Self { cells, rims, folds, ends, size, accuracy, moments, real }
    }

    /// True for a body without cells.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Approximate diagonal.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Relative accuracy of the figures.
    pub fn accuracy(&self) -> f64 {
        self.accuracy
    }

    /// The sides, by their index, that turn over themselves, each with a place at which it does;
    /// found without derivatives, where the body was made of its sides.
    pub fn folds(&self) -> &[(usize, Vec3)] {
        &self.folds
    }

    /// The number of polynomial cells.
    pub fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// The area of some cells below z = `level`: of a side of [`Self::side_cells`], or of panels.
    pub fn wetted_area(&self, cells: Range<usize>, level: T) -> T {
        let accuracy = self.quadrature_accuracy();
        let origin = [T::zero(); 2];
        let cells = &self.cells[cells];
        let none = HydrostaticIntegrals::zero();
        immersed(cells, &none, level, origin, self.size, accuracy, Wanted::Skin).sums.wetted
    }

    /// The cells of each side in turn, for a body made of sides; those of panels follow.
    pub fn side_cells(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let starts = std::iter::once(&0).chain(&self.ends);
        starts.zip(&self.ends).map(|(start, end)| *start..*end)
    }

    pub(crate) fn cells(&self) -> &[Arc<PolynomialCell<T>>] {
        &self.cells
    }

    /// Bounding box of the control points, which contains the skin.
    pub fn bounds(&self) -> Box3 {
        Box3::around(self.cells.iter().flat_map(|c| c.net().iter().map(|p| p.re())))
    }

    /// The body under an affine map; `turned` is true for a reflection.
    pub fn mapped(&self, map: impl Fn(Vec3<T>) -> Vec3<T>, turned: bool) -> Self {
        Self {
            cells: self.cells.iter().map(|c| Arc::new(c.mapped(&map, turned))).collect(),
            rims: self.rims.iter().map(|r| r.iter().map(|&p| map(p)).collect()).collect(),
            folds: Vec::new(),
            ends: self.ends.clone(),
            size: self.size,
            accuracy: self.accuracy,
            moments: OnceLock::new(),
            real: OnceLock::new(),
        }
    }

    /// The body in earth axes.
    pub fn turned(&self, attitude: Attitude<T>) -> Self {
        match attitude.rotation() {
            Some(place) => self.mapped(place, false),
            None => self.clone(),
        }
    }

    /// The body together with its mirror image in the plane through zero of `axis`.
    pub fn with_mirror_image(&self, axis: usize) -> Self {
        let mirrored = |p: Vec3<T>| {
            let mut q = p.to_array();
            q[axis] = -q[axis];
            Vec3::from(q)
        };
        let image = self.mapped(mirrored, true);
        let mut both = self.clone();
        (both.moments, both.real) = (OnceLock::new(), OnceLock::new());
        both.cells.extend(image.cells);
        both.rims.extend(image.rims);
        both
    }

    /// The body without derivatives, made once.
    pub(crate) fn real(&self) -> &Body<f64> {
        match (self as &dyn Any).downcast_ref() {
            Some(body) => body,
            None => self.real.get_or_init(|| Arc::new(self.re())),
        }
    }

    /// The body without derivatives.
    pub fn re(&self) -> Body<f64> {
        Body {
            cells: self.cells.iter().map(|c| Arc::new(c.re())).collect(),
            rims: self.rims.iter().map(|r| r.iter().map(|p| p.re()).collect()).collect(),
            folds: self.folds.clone(),
            ends: self.ends.clone(),
            size: self.size,
            accuracy: self.accuracy,
            moments: OnceLock::new(),
            real: OnceLock::new(),
        }
    }

    /// Area, volume and centres of the whole skin.
    pub fn measures(&self) -> BodyMeasures<T> {
        let bounds = self.bounds();
        let centre = bounds.centre();
        if self.cells.is_empty() {
            let zero = Vec3::zero();
            let t = T::zero();
            return BodyMeasures {
                area: t,
                area_centre: zero,
                volume: t,
                centroid: zero,
                middle: centre,
                bounds: [0.0; 2],
                open: 0.0,
            };
        }
        // All of it is submerged, and moments are about its middle.
        let moved = self.mapped(|p| p - Vec3::lifted(centre), false);
        let above = T::from(2.0 * self.size + bounds.diagonal());
        let accuracy = moved.quadrature_accuracy();
        let all = moved.wanted_integrals(above, [T::zero(); 2], Wanted::Skin, accuracy);
        let Immersed { sums, errors, .. } = &all;
        let fit = self.fit_errors(&bounds);
        let volume = (sums.forms[0] + sums.forms[1]) * 0.5;
        // The field (0, 0, z - level) with its origin at the level, moved back to the middle.
        let vertical = sums.forms[2] - sums.plane[0] * above;
        let volume = volume * (2.0 / 3.0) + vertical / 3.0;
        let about = |m: Vec3<T>, whole: T| {
            if whole.re() == 0.0 { Vec3::zero() } else { m / whole }
        };
        let mut moment = sums.moment;
        // Closed: the water plane vanishes, so the column's moments are those of the volume.
        moment.z += volume * above;
        let mut area_moment = sums.area_moment;
        area_moment.z += sums.wetted * above;
        let open = [sums.open[0], sums.open[1], sums.plane[0]].map(|x| x.re().abs());
        BodyMeasures {
            area: sums.wetted,
            area_centre: about(area_moment, sums.wetted) + Vec3::lifted(centre),
            volume,
            centroid: about(moment, volume) + Vec3::lifted(centre),
            middle: centre,
            bounds: [errors[2] + fit[2], errors[0] + fit[0]],
            open: open.into_iter().fold(0.0, f64::max),
        }
    }

    /// The relative accuracy of integrals for figures of this accuracy.
    pub(crate) fn quadrature_accuracy(&self) -> f64 {
        (SHARE * self.accuracy).max(FINEST)
    }

    /// The `wanted` integrals below `level` about (x0, y0), to a relative accuracy.
    pub(crate) fn wanted_integrals(
        &self,
        level: T,
        origin: [T; 2],
        wanted: Wanted,
        accuracy: f64,
    ) -> Immersed<T> {
        let none = HydrostaticIntegrals::zero();
        immersed(&self.cells, &none, level, origin, self.size, accuracy, wanted)
    }

    /// The `wanted` integrals at an attitude about (x0, y0) in earth axes, to a relative accuracy;
    /// without the leaves of cells that are wholly below the water.
    pub(crate) fn immersed_at(
        &self,
        attitude: Attitude<T>,
        origin: [T; 2],
        wanted: Wanted,
        accuracy: f64,
    ) -> Immersed<T> {
        let moments = self
            .moments
            .get_or_init(|| Arc::new(BodyMoments::new(&self.cells, self.bounds().centre())));
        let area = (wanted != Wanted::Displacement).then_some(accuracy);
        let below = moments.below(attitude, origin, NEGLIGIBLE * self.size, area);
        let rotation = attitude.rotation();
        let turned = |k: usize| match &rotation {
            Some(place) => Arc::new(self.cells[k].mapped(place, false)),
            None => self.cells[k].clone(),
        };
        let cells: Vec<_> = below.across.into_iter().map(turned).collect();
        let level = attitude.level;
        let mut all = immersed(&cells, &below.sums, level, origin, self.size, accuracy, wanted);
        all.errors[2] += below.area_error;
        all
    }

    /// The lowest and the highest control point along an axis.
    pub(crate) fn heights(&self, up: Vec3) -> [f64; 2] {
        let heights = self.cells.iter().flat_map(|c| c.net().iter().map(|p| p.re().dot(up)));
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], z| [a.min(z), b.max(z)])
    }

    /// The rims without the skin.
    pub(crate) fn rims_alone(&self) -> Self {
        Self { rims: self.rims.clone(), ..Self::of_cells(Vec::new(), self.size, self.accuracy) }
    }

    /// Errors due to the distance between cells and surfaces, rounding of coordinates included: of
    /// volume, its first moments, area, and of the waterplane's area, first and second moments.
    pub(crate) fn fit_errors(&self, bounds: &Box3) -> [f64; 6] {
        let reach = bounds.diagonal();
        let far = bounds.centre().norm() + 0.5 * reach;
        let rounding = COORDINATE_ROUNDINGS * f64::EPSILON * far;
        let mut errors = [0.0; 6];
        for cell in &self.cells {
            let [fit_u, fit_v] = cell.fit.map(|fit| fit + rounding);
            let [u, v] = cell.lengths();
            // Derivatives of the remainder, of degree 10, over the lengths across.
            let strip = fit_u * v.max(fit_u) + fit_v * u.max(fit_v);
            let volume = (fit_u + fit_v) * u * v;
            let parts = [volume, volume * reach, 4.0 * strip, 4.0 * strip];
            for (e, x) in errors.iter_mut().zip(parts) {
                *e += x;
            }
        }
        errors[4] = errors[3] * reach;
        errors[5] = errors[4] * reach;
        errors
    }

    /// The minimum of `p . direction` over the skin: exact to rounding, with the derivatives of the
    /// point where it is attained.
    pub fn lowest(&self, direction: Vec3<f64>) -> Option<T> {
        if T::TAPED {
            // A tape has the corner that is lowest, not the search for it.
            let place = self.real().lowest_place(|p| along(p, direction))?;
            let cell = self.cells[place.root].along_path(&place.path);
            return Some(along(cell.net()[place.corner], direction));
        }
        Some(self.lowest_place(|p| along(p, direction))?.value)
    }

    fn lowest_place(&self, along: impl Fn(Vec3<T>) -> T) -> Option<LowestPlace<T>> {
        let least = |c: &PolynomialCell<T>| {
            c.net().iter().map(|&p| along(p).re()).fold(f64::INFINITY, f64::min)
        };
        let mut best: Option<LowestPlace<T>> = None;
        let mut stack: Vec<(f64, HalvedCell<T>)> = (self.cells.iter().enumerate())
            .map(|(root, c)| (least(c), HalvedCell { cell: c.clone(), root, path: Vec::new() }))
            .collect();
        stack.sort_by(|a, b| b.0.total_cmp(&a.0));
        let near = 1e-14 * self.size;
        let mut steps = 0;
        while let Some((bound, HalvedCell { cell, root, path })) = stack.pop() {
            if best.as_ref().is_some_and(|b| bound >= b.value.re() - near) {
                continue;
            }
            steps += 1;
            let [du, dv] = cell.degree();
            for corner in [0, dv, du * (dv + 1), du * (dv + 1) + dv] {
                let value = along(cell.net()[corner]);
                if best.as_ref().is_none_or(|b| value.re() < b.value.re()) {
                    best = Some(LowestPlace { value, root, path: path.clone(), corner });
                }
            }
            let [u, v] = cell.lengths();
            if u.max(v) <= 1e-9 * self.size || steps > 20_000 {
                continue;
            }
            let axis = u8::from(v > u);
            let mut parts: Vec<_> = (0u8..)
                .zip(cell.split(usize::from(axis)))
                .map(|(half, c)| {
                    let path = [&path[..], &[[axis, half]]].concat();
                    (least(&c), HalvedCell { cell: Arc::new(c), root, path })
                })
                .collect();
            parts.sort_by(|a, b| b.0.total_cmp(&a.0));
            stack.extend(parts);
        }
        best
    }

    /// The number of rims that reach below the level, without those in the plane y = 0 for a half
    /// body.
    pub fn open_below(&self, level: f64, half: bool) -> usize {
        let near = self.near();
        let low = |r: &&Vec<Vec3<T>>| r.iter().any(|p| p.z.re() < level - near);
        self.rims_of(half).filter(low).count()
    }

    /// The distance within which a rim is in a plane.
    fn near(&self) -> f64 {
        SAME_PLACE * self.size
    }

    /// The open rims, without those in the plane y = 0 for a half body.
    fn rims_of(&self, half: bool) -> impl Iterator<Item = &Vec<Vec3<T>>> {
        let near = self.near();
        self.rims.iter().filter(move |r| !half || r.iter().any(|p| p.y.re().abs() > near))
    }

    /// The height of the lowest open rim over the level, without those in the plane y = 0 for a
    /// half body; 0 for a rim at the level.
    pub fn freeboard(&self, level: T, half: bool) -> Option<T> {
        let height = self.lowest_rim(half)? - level;
        Some(if height.re().abs() <= self.near() {
            T::linear(0.0, &[(1.0, height)])
        } else {
            height
        })
    }

    /// The lowest z of the open rims, without those in the plane y = 0 for a half body.
    pub fn lowest_rim(&self, half: bool) -> Option<T> {
        let least = |r: &[Vec3<T>]| r.iter().map(|p| p.z.re()).fold(f64::INFINITY, f64::min);
        let mut best: Option<T> = None;
        let mut stack: Vec<(Vec<Vec3<T>>, u32)> =
            self.rims_of(half).map(|r| (r.clone(), 0)).collect();
        while let Some((row, depth)) = stack.pop() {
            if best.is_some_and(|b| least(&row) >= b.re() - 1e-14 * self.size) {
                continue;
            }
            for p in [row[0], row[row.len() - 1]] {
                if best.is_none_or(|b| p.z.re() < b.re()) {
                    best = Some(p.z);
                }
            }
            if depth < 40 && row.len() > 2 {
                stack.extend(halves(&row).map(|half| (half, depth + 1)));
            }
        }
        best
    }
}
