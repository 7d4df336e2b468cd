//! Hydrostatics of the part of a mesh below the water: displacement, centres, waterplane, stability, coefficients.
//! Panels that the water cuts are cut exactly.

use crate::clip::below;
use crate::half_edge::{edges, half_edges};
use crate::panel::length;
use crate::sum::chunked_sum;
use crate::{Mesh, Panel};
use moldloft_num::{Real, Vec3};

/// Vertices within this share of the size of a mesh from a plane lie in it.
const SAME_PLACE: f64 = 1e-9;

/// How much of the body the mesh shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Symmetry {
    /// All of it.
    #[default]
    None,
    /// One side of the plane y = 0; the figures are those of both sides.
    MirroredTwice,
    /// One side of the plane y = 0; the figures are those of this side alone.
    MirroredOnce,
}

/// How a body floats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloatOptions<T> {
    /// Height z of the water.
    pub level: T,
    /// What the mesh shows of the body.
    pub symmetry: Symmetry,
    /// Mass per volume of the water, in the caller's units.
    pub density: f64,
}

impl<T: Real> Default for FloatOptions<T> {
    /// Water at z = 0, the whole body, density 1.
    fn default() -> Self {
        Self { level: T::zero(), symmetry: Symmetry::None, density: 1.0 }
    }
}

/// The displaced volume by the divergence theorem with three fields. They agree for a surface that
/// is closed but for its top in the water plane and its side in the symmetry plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeForms<T> {
    /// Integral of (x - x0) n_x, x0 in the middle of the mesh.
    pub x: T,
    /// Integral of (y - y0) n_y, y0 = 0 for a mirrored mesh, else in its middle.
    pub y: T,
    /// Integral of (z - level) n_z: the one used, blind to the open top and side.
    pub z: T,
}

/// Where the water cuts the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waterplane<T> {
    /// Area.
    pub area: T,
    /// Centre of the area, at the level of the water.
    pub centre: Vec3<T>,
    /// Second moment about the longitudinal axis through the centre: the integral of (y - yc)^2.
    pub transverse_moment: T,
    /// Second moment about the transverse axis through the centre: the integral of (x - xc)^2.
    pub longitudinal_moment: T,
    /// The ends of the waterline, its lowest and highest x.
    pub ends: [T; 2],
    /// Extent in x.
    pub length: T,
    /// Extent in y.
    pub beam: T,
    /// Immersed area of the section half-way between the ends.
    pub midship_area: T,
}

/// Ratios of the immersed body to its bounding shapes (Lewis 1988, Principles of Naval
/// Architecture I, 2.3); the length and beam are those of the waterline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FormCoefficients<T> {
    /// Volume / (length beam draft).
    pub block: T,
    /// Volume / (midship area length).
    pub prismatic: T,
    /// Midship area / (beam draft).
    pub midship: T,
    /// Waterplane area / (length beam).
    pub waterplane: T,
}

/// What a body displaces and how stiffly it floats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hydrostatics<T> {
    /// Height z of the water.
    pub level: T,
    /// Displaced volume.
    pub volume: T,
    /// Density times volume.
    pub displacement: T,
    /// Centre of buoyancy; `None` when nothing is displaced.
    pub buoyancy_centre: Option<Vec3<T>>,
    /// Area of the skin below the water.
    pub wetted_area: T,
    /// Depth of the lowest point below the water; zero when all is above.
    pub draft: T,
    /// The cut with the water; `None` when the water does not cut the body.
    pub waterplane: Option<Waterplane<T>>,
    /// Form coefficients; `None` without waterplane.
    pub coefficients: Option<FormCoefficients<T>>,
    /// The volume by three fields, for the asked number of sides.
    pub forms: VolumeForms<T>,
    /// Largest difference between the forms over the volume. Rounding when closed.
    pub closure_error: f64,
    /// Difference between the waterplane area from the skin and from the waterline, over the area.
    pub waterplane_error: f64,
    /// Open edges below the water, not in the symmetry plane: 0 when the skin holds water.
    pub open_edges: usize,
    /// True when the panels' normals point out of the body. When false all figures are those of
    /// the turned mesh.
    pub outward: bool,
}

impl<T: Real> Hydrostatics<T> {
    /// Height of the centre of buoyancy above the lowest point.
    pub fn kb(&self) -> Option<T> {
        Some(self.draft + self.buoyancy_centre?.z - self.level)
    }

    /// Transverse metacentric radius: second moment of the waterplane / volume.
    pub fn bm_transverse(&self) -> Option<T> {
        self.waterplane.map(|w| w.transverse_moment / self.volume)
    }

    /// Longitudinal metacentric radius.
    pub fn bm_longitudinal(&self) -> Option<T> {
        self.waterplane.map(|w| w.longitudinal_moment / self.volume)
    }

    /// Height of the transverse metacentre above the lowest point.
    pub fn km_transverse(&self) -> Option<T> {
        Some(self.kb()? + self.bm_transverse()?)
    }

    /// Height of the longitudinal metacentre above the lowest point.
    pub fn km_longitudinal(&self) -> Option<T> {
        Some(self.kb()? + self.bm_longitudinal()?)
    }

    /// Every figure under the name that tables, JSON and derivatives use, in a fixed order; figures
    /// without meaning (no waterplane) are left out.
    pub fn figures(&self) -> Vec<(&'static str, T)> {
        let mut rows = vec![
            ("volume", self.volume),
            ("displacement", self.displacement),
            ("wetted_area", self.wetted_area),
            ("draft", self.draft),
        ];
        if let Some(c) = self.buoyancy_centre {
            rows.extend([("lcb", c.x), ("tcb", c.y), ("vcb", c.z)]);
        }
        if let Some(w) = self.waterplane {
            rows.extend([
                ("waterplane_area", w.area),
                ("lcf", w.centre.x),
                ("tcf", w.centre.y),
                ("waterplane_it", w.transverse_moment),
                ("waterplane_il", w.longitudinal_moment),
                ("waterline_low_x", w.ends[0]),
                ("waterline_high_x", w.ends[1]),
                ("waterline_length", w.length),
                ("waterline_beam", w.beam),
                ("midship_area", w.midship_area),
            ]);
        }
        if let Some(c) = self.coefficients {
            rows.extend([
                ("cb", c.block),
                ("cp", c.prismatic),
                ("cm", c.midship),
                ("cwp", c.waterplane),
            ]);
        }
        let heights = [
            ("kb", self.kb()),
            ("bmt", self.bm_transverse()),
            ("bml", self.bm_longitudinal()),
            ("kmt", self.km_transverse()),
            ("kml", self.km_longitudinal()),
        ];
        rows.extend(heights.into_iter().filter_map(|(name, value)| Some((name, value?))));
        rows
    }
}

/// Integrals over the immersed skin and the waterline.
#[derive(Clone, Copy)]
struct ImmersedIntegrals<T> {
    forms: [T; 3],
    /// First moments of the volume about (x0, y0, level).
    moment: Vec3<T>,
    wetted: T,
    /// Integrals of 1, x, y, x^2, y^2 over the waterplane, about x0 and y0.
    plane: [T; 5],
    /// The waterplane area from the waterline (Green).
    green: T,
    extent: ImmersedExtent<T>,
}

/// Lowest and highest coordinates by real part.
#[derive(Clone, Copy)]
struct ImmersedExtent<T> {
    lowest: Option<T>,
    waterline: Option<[T; 4]>,
}

impl<T: Real> ImmersedIntegrals<T> {
    fn zero() -> Self {
        let t = T::zero();
        let extent = ImmersedExtent { lowest: None, waterline: None };
        Self { forms: [t; 3], moment: Vec3::zero(), wetted: t, plane: [t; 5], green: t, extent }
    }

    fn add(&mut self, o: Self) {
        for k in 0..3 {
            self.forms[k] += o.forms[k];
        }
        self.moment += o.moment;
        self.wetted += o.wetted;
        for k in 0..5 {
            self.plane[k] += o.plane[k];
        }
        self.green += o.green;
        if let Some(z) = o.extent.lowest {
            self.extent.reach_down(z);
        }
        if let Some([x0, x1, y0, y1]) = o.extent.waterline {
            self.extent.reach_along(x0, y0);
            self.extent.reach_along(x1, y1);
        }
    }

    /// Adds a piece of skin below the water; `origin` is (x0, y0, level).
    fn take(&mut self, piece: Panel<T>, origin: Vec3<T>) {
        piece.quadrature(|p, n| {
            let p = p - origin;
            self.wetted += length(n);
            self.forms[0] += p.x * n.x;
            self.forms[1] += p.y * n.y;
            let column = p.z * n.z;
            self.forms[2] += column;
            // int x dV from the field (0, 0, x z), int z dV from (0, 0, z^2 / 2): with z measured
            // from the water neither sees the open top, nor a side where n_z = 0.
            self.moment += Vec3::new(p.x * column, p.y * column, p.z * column * 0.5);
            // The skin and the waterplane enclose the body and a field f(x, y) e_z has no
            // divergence, so int f dA over the waterplane is - int f n_z dA over the skin.
            let down = -n.z;
            let (x, y) = (p.x * down, p.y * down);
            for (sum, part) in self.plane.iter_mut().zip([down, x, y, p.x * x, p.y * y]) {
                *sum += part;
            }
        });
    }
}

impl<T: Real> ImmersedExtent<T> {
    fn reach_down(&mut self, z: T) {
        self.lowest = Some(self.lowest.map_or(z, |low| low.min(z)));
    }

    fn reach_along(&mut self, x: T, y: T) {
        let [x0, x1, y0, y1] = self.waterline.unwrap_or([x, x, y, y]);
        self.waterline = Some([x0.min(x), x1.max(x), y0.min(y), y1.max(y)]);
    }
}

/// Hydrostatics of the part of the mesh below `z = options.level`.
///
/// The skin (patches that are not lids, water or symmetry planes) is cut exactly at the level. It may
/// be open at the level or above it, and, when mirrored, in the plane y = 0: no lid is needed.
/// Whether it is closed elsewhere below the water is checked and reported, not assumed: see
/// [`Hydrostatics::open_edges`] and [`Hydrostatics::closure_error`]. The figures of closed bilinear
/// panels are exact where panels are not cut; against the smooth body they converge at second
/// order. Panels whose normals all point inward give the same figures, reported as such.
///
/// The extents (draft, waterline) have the derivatives of the corner they are reached at.
pub fn hydrostatics<T: Real>(mesh: &Mesh<T>, options: FloatOptions<T>) -> Hydrostatics<T> {
    let FloatOptions { level, symmetry, density } = options;
    let middle = mesh.bounds().centre();
    let y0 = if symmetry == Symmetry::None { middle.y } else { 0.0 };
    let origin = Vec3::new(middle.x.into(), y0.into(), level);
    let skin = skin_of(mesh);
    let sums = integrals(mesh, &skin, origin);

    let outward = sums.forms[2].re() >= 0.0;
    let side = T::from(if outward { 1.0 } else { -1.0 });
    let sides = T::from(if symmetry == Symmetry::MirroredTwice { 2.0 } else { 1.0 });
    let count = side * sides;
    let [x, y, z] = sums.forms.map(|form| form * count);
    let volume = z;
    let mut buoyancy_centre = (volume.re() > 0.0).then(|| origin + sums.moment * count / volume);
    if let (Some(centre), Symmetry::MirroredTwice) = (&mut buoyancy_centre, symmetry) {
        centre.y = T::zero();
    }
    let draft = sums.extent.lowest.map_or(T::zero(), |z| level - z);
    let waterplane = sums.extent.waterline.map(|extent| {
        let mut plane = floating(sums.plane.map(|p| p * count), extent, origin, symmetry);
        let half_way = (plane.ends[0] + plane.ends[1]) * 0.5;
        plane.midship_area = section_area(mesh, &skin, half_way, level) * sides;
        plane
    });
    let coefficients = waterplane.filter(|w| volume.re() > 0.0 && w.midship_area.re() > 0.0);
    let coefficients = coefficients.map(|w| FormCoefficients {
        block: volume / (w.length * w.beam * draft),
        prismatic: volume / (w.midship_area * w.length),
        midship: w.midship_area / (w.beam * draft),
        waterplane: w.area / (w.length * w.beam),
    });
    let relative = |error: f64, size: f64| if error == 0.0 { 0.0 } else { error / size.abs() };
    let largest = (x - z).re().abs().max((y - z).re().abs());
    let area_error = sums.plane[0].re() - waterline_area(&sums).re();
    Hydrostatics {
        level,
        volume,
        displacement: volume * density,
        buoyancy_centre,
        wetted_area: sums.wetted * sides,
        draft,
        waterplane,
        coefficients,
        forms: VolumeForms { x, y, z },
        closure_error: relative(largest, volume.re()),
        waterplane_error: relative(area_error.abs(), sums.plane[0].re()),
        open_edges: open_edges_below(mesh, level.re(), symmetry != Symmetry::None),
        outward,
    }
}

/// The faces of the patches that bound the body.
fn skin_of<T: Real>(mesh: &Mesh<T>) -> Vec<usize> {
    let skin = mesh.patches().iter().filter(|p| p.info.tag.is_skin());
    skin.flat_map(|p| p.faces.clone()).collect()
}

impl<T: Real> Mesh<T> {
    /// The faces of the patches that bound the body: all but lids, water and symmetry planes.
    pub fn skin_faces(&self) -> Vec<usize> {
        skin_of(self)
    }

    /// The open edges of these patches: the patch, and a pair of vertices.
    pub fn open_skin_edges(&self) -> Vec<(usize, [u32; 2])> {
        let sides = half_edges(self.topology());
        let skin = |face: usize| self.patches()[self.topology().patch_of(face)].info.tag.is_skin();
        let open = edges(&sides).filter(|e| e.len() == 1 && skin(e[0].face()));
        open.map(|e| (self.topology().patch_of(e[0].face()), [e[0].from, e[0].to])).collect()
    }
}

/// The integrals below the water; `origin` is (x0, y0, level).
fn integrals<T: Real>(mesh: &Mesh<T>, skin: &[usize], origin: Vec3<T>) -> ImmersedIntegrals<T> {
    let level = origin.z;
    chunked_sum(
        0..skin.len(),
        ImmersedIntegrals::zero,
        |sum, k| {
            let panel = mesh.panel(skin[k]);
            let Some(cut) = below(&panel, level) else { return };
            for p in cut.corners() {
                sum.extent.reach_down(p.z);
            }
            for (p, q) in cut.waterline() {
                let (a, b) = (p - origin, q - origin);
                sum.green += (a.x * b.y - b.x * a.y) * 0.5;
                sum.extent.reach_along(p.x, p.y);
                sum.extent.reach_along(q.x, q.y);
            }
            cut.pieces(|piece| sum.take(piece, origin));
        },
        |sum, part| sum.add(part),
    )
}

/// The area inside the waterline. The waterline runs along the edge of the skin, which is clockwise
/// seen from above about a hull whose normals point outward; in the symmetry plane y0 = 0, so the
/// closing line adds nothing.
fn waterline_area<T: Real>(sums: &ImmersedIntegrals<T>) -> T {
    if sums.green.re() * sums.plane[0].re() < 0.0 { -sums.green } else { sums.green }
}

/// The waterplane from its integrals about the origin.
fn floating<T: Real>(
    [area, mx, my, mxx, myy]: [T; 5],
    [aft, fore, y_low, y_high]: [T; 4],
    origin: Vec3<T>,
    symmetry: Symmetry,
) -> Waterplane<T> {
    let has_area = area.re() != 0.0;
    let ratio = |m: T| if has_area { m / area } else { T::zero() };
    let dx = ratio(mx);
    let dy = if symmetry == Symmetry::MirroredTwice { T::zero() } else { ratio(my) };
    let beam = match symmetry {
        Symmetry::None => y_high - y_low,
        Symmetry::MirroredTwice => y_high.abs().max(y_low.abs()) * 2.0,
        Symmetry::MirroredOnce => y_high.abs().max(y_low.abs()),
    };
    Waterplane {
        area,
        centre: origin + Vec3::new(dx, dy, T::zero()),
        // Steiner: the moment about the centre is that about the origin less area times arm^2.
        transverse_moment: myy - area * dy * dy,
        longitudinal_moment: mxx - area * dx * dx,
        ends: [aft, fore],
        length: fore - aft,
        beam,
        midship_area: T::zero(),
    }
}

/// The immersed area of the section at `station`, one side: the integral of (z - level) dy along the
/// cut of the skin, to which the water and the symmetry plane add nothing.
fn section_area<T: Real>(mesh: &Mesh<T>, skin: &[usize], station: T, level: T) -> T {
    let ahead = |p: Vec3<T>| p.x.re() >= station.re();
    let area = chunked_sum(
        0..skin.len(),
        T::zero,
        |sum, k| {
            let Some(cut) = below(&mesh.panel(skin[k]), level) else { return };
            let corners = cut.corners();
            let n = corners.len();
            for k in 0..n {
                // Each side that leads ahead starts a piece of the cut, which ends at the next side
                // that leads back.
                let (p, q) = (corners[k], corners[(k + 1) % n]);
                if ahead(p) || !ahead(q) {
                    continue;
                }
                let back = (k + 1..k + n).find(|&m| !ahead(corners[(m + 1) % n]));
                let Some(m) = back else { continue };
                let from = at_station(p, q, station);
                let to = at_station(corners[(m + 1) % n], corners[m % n], station);
                *sum += ((from.z + to.z) * 0.5 - level) * (to.y - from.y);
            }
        },
        |sum, part| *sum += part,
    );
    area.abs()
}

/// Where the line from `aft` to `fore` passes the station.
fn at_station<T: Real>(aft: Vec3<T>, fore: Vec3<T>, station: T) -> Vec3<T> {
    aft + (fore - aft) * ((station - aft.x) / (fore.x - aft.x))
}

/// Open edges that reach below the level and do not lie in the symmetry plane, both to within 1e-9 of
/// the mesh's diagonal (far above rounding, far below any panel).
fn open_edges_below<T: Real>(mesh: &Mesh<T>, level: f64, mirrored: bool) -> usize {
    let epsilon = SAME_PLACE * mesh.bounds().diagonal();
    let position = |v: u32| mesh.positions()[v as usize].re();
    let sides = half_edges(mesh.topology());
    let open =
        edges(&sides).filter(|e| e.len() == 1).map(|e| (position(e[0].from), position(e[0].to)));
    open.filter(|(p, q)| p.z.min(q.z) < level - epsilon)
        .filter(|(p, q)| !(mirrored && p.y.abs().max(q.y.abs()) <= epsilon))
        .count()
}

#[cfg(test)]
mod tests;
