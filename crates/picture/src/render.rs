//! The picture of a mesh and some lines as a PNG file. The same input gives the same bytes; no display is needed.

use crate::camera::{Aimed, Camera, ScreenPoint};
use crate::lettering::{self, PointName};
use crate::palette::{Gamma, patch_colour};
use crate::raster::{PanelSides, Raster, ShadedVertex, length};
use moldloft_mesh::{Mesh, Tag, is_triangle, sagittas};
use moldloft_num::{Box3, Vec3};
use std::fmt;

/// A polyline in the model, such as a contour or a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct StyledPolyline {
    /// Its points.
    pub points: Vec<Vec3>,
    /// sRGB colour.
    pub colour: [u8; 3],
    /// Width in picture points.
    pub width: f32,
    /// True for a line on the panelled surface, such as a contour: parts outside the outline of the
    /// panels are not drawn.
    pub on_surface: bool,
}

/// Appearance of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PatchStyle {
    /// sRGB colour.
    pub colour: [u8; 3],
    /// True to draw the line slightly nearer, so that it covers a coincident surface.
    pub raised: bool,
}

/// Options of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Picture points across.
    pub width: usize,
    /// Picture points down.
    pub height: usize,
    /// The camera.
    pub camera: Camera,
    /// Draw the rims of the patches.
    pub borders: bool,
    /// Draw the sides of the panels; they fade where panels are only a few pixels wide.
    pub edges: bool,
    /// Shade across panels as if the surface were smooth, except at creases above 40 degrees.
    pub smooth: bool,
    /// Also show the mirror images in these of the planes x = 0, y = 0, z = 0, and the images of
    /// the images.
    pub mirrors: [bool; 3],
    /// Draw the directions of the axes in the corner.
    pub axes: bool,
    /// Colours of the background, top and bottom.
    pub background: [[u8; 3]; 2],
    /// Appearance of the patches, in order, instead of their own colours.
    pub looks: Option<Vec<PatchStyle>>,
    /// Names beside points, the most important first; not on mirror images.
    pub labels: Vec<PointName>,
}

impl Default for Options {
    /// 1600 x 1000, smooth with panel sides and axes, on a light background.
    fn default() -> Self {
        Self {
            width: 1600,
            height: 1000,
            camera: Camera::default(),
            borders: true,
            edges: true,
            smooth: true,
            mirrors: [false; 3],
            axes: true,
            background: [[0xfc, 0xfd, 0xfe], [0xe2, 0xe8, 0xee]],
            looks: None,
            labels: Vec::new(),
        }
    }
}

/// Reason why there is no picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PictureError {
    /// A side of the picture is 0 or above [`PictureError::LARGEST`].
    Size {
        /// Requested width in pixels.
        width: usize,
        /// Requested height in pixels.
        height: usize,
    },
    /// A vertex is not at a finite position.
    NotFinite {
        /// A patch that uses it.
        patch: String,
        /// The vertex.
        vertex: u32,
    },
    /// Cancelled by the caller.
    Ended,
    /// The encoder failed.
    Encoding(String),
}

impl PictureError {
    /// Maximum number of pixels along a side.
    pub const LARGEST: usize = 8192;
}

impl fmt::Display for PictureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size { width, height } => write!(
                f,
                "a picture of {width} x {height} points; each side must be 1 to {}",
                Self::LARGEST
            ),
            Self::NotFinite { patch, vertex } => {
                write!(f, "vertex {vertex} of patch `{patch}` is not at a finite position")
            }
            Self::Ended => write!(f, "the work was ended"),
            Self::Encoding(text) => write!(f, "the picture cannot be encoded: {text}"),
        }
    }
}

impl std::error::Error for PictureError {}

/// Number of panels or sides drawn between two checks for cancellation; each covers at most the
/// picture.
const AT_ONCE: usize = 16;

/// Colour of the rims of patches.
const RIM: [u8; 3] = [0x2b, 0x33, 0x3f];

/// The picture of a mesh and some lines, as the bytes of a PNG file. The camera shows all of them.
///
/// # Errors
/// An impossible size, positions that are not finite.
pub fn render(
    mesh: &Mesh,
    lines: &[StyledPolyline],
    options: &Options,
) -> Result<Vec<u8>, PictureError> {
    render_while(mesh, lines, options, &|| true)
}

/// As [`render`]; stops when `go_on`, which is called every few panels and lines, returns false.
///
/// # Errors
/// As [`render`], and [`PictureError::Ended`].
pub fn render_while(
    mesh: &Mesh,
    lines: &[StyledPolyline],
    options: &Options,
    go_on: &dyn Fn() -> bool,
) -> Result<Vec<u8>, PictureError> {
    let goes_on = || if go_on() { Ok(()) } else { Err(PictureError::Ended) };
    let (width, height) = (options.width, options.height);
    let possible = 1..=PictureError::LARGEST;
    if !possible.contains(&width) || !possible.contains(&height) {
        return Err(PictureError::Size { width, height });
    }
    for patch in mesh.patches() {
        let mut corners = mesh.faces()[patch.faces.clone()].iter().flatten();
        if let Some(&vertex) = corners.find(|&&v| !mesh.positions()[v as usize].is_finite()) {
            return Err(PictureError::NotFinite { patch: patch.info.name.clone(), vertex });
        }
    }
    let sides = images(options.mirrors);
    let corners = mesh.faces().iter().flatten().map(|&v| mesh.positions()[v as usize]);
    let ends = lines.iter().flat_map(|l| l.points.iter().copied().filter(|p| p.is_finite()));
    let all: Vec<Vec3> =
        corners.chain(ends).flat_map(|p| sides.iter().map(move |&side| image(p, side))).collect();
    let aimed = Aimed::at(&options.camera, &all, 2.0 * width as f64, 2.0 * height as f64);

    let [top, bottom] = options.background;
    let gamma = Gamma::new();
    let mut raster = Raster::new(2 * width, 2 * height, top, bottom, Gamma::new());
    let diagonal = Box3::around(all.iter().copied()).diagonal();
    goes_on()?;
    let sagitta = sagittas(mesh).into_iter().fold(0.0, f64::max);
    let lift = f64::max(1e-3 * diagonal, 2.0 * sagitta);
    goes_on()?;
    let painter = Painter { mesh, aimed: &aimed, gamma: &gamma, options, lift };
    for &side in &sides {
        painter.panels(&mut raster, side, &goes_on)?;
    }
    let rims = if options.borders { mesh.topology().borders() } else { Vec::new() };
    goes_on()?;
    for &side in &sides {
        // The depths, in diagonals: maximum distance behind panels, and in front of them.
        let mut stroke = |p: Vec3, q: Vec3, half_width: f32, depths: [f64; 2], colour: [u8; 3]| {
            let (p, q) = (image(p, side), image(q, side));
            let middle = (p + q) * 0.5;
            let depths = depths.map(|depth| {
                if depth.is_infinite() {
                    return f32::INFINITY;
                }
                let nearer = aimed.see(middle + aimed.towards(middle) * (depth * diagonal));
                nearer.near - aimed.see(middle).near
            });
            raster.line(aimed.see(p), aimed.see(q), half_width, depths, colour);
        };
        for (number, ends) in rims.iter().enumerate() {
            if number % AT_ONCE == 0 {
                goes_on()?;
            }
            let [p, q] = ends.map(|v| mesh.positions()[v as usize]);
            // At the plane of symmetry the surface continues.
            let within = |k: usize| options.mirrors[k] && p[k] == 0.0 && q[k] == 0.0;
            if !(0..3).any(within) {
                stroke(p, q, 0.75, [4e-4, f64::INFINITY], RIM);
            }
        }
        for line in lines {
            // A line on the surface is within the sagitta of its panels; near the outline the
            // panels turn away from it.
            let before = if line.on_surface { 2e-2 } else { f64::INFINITY };
            goes_on()?;
            for ends in line.points.windows(2).filter(|w| w.iter().all(|p| p.is_finite())) {
                // A dot is a disc across the line of sight: a surface through its middle would hide half of it.
                let breadth = f64::from(line.width) / width.min(height) as f64;
                let hidden = if ends[0] == ends[1] { breadth.min(0.1) } else { 2e-3 };
                stroke(ends[0], ends[1], line.width, [hidden, before], line.colour);
            }
        }
    }
    let labels: Vec<(&PointName, [f32; 2])> = options
        .labels
        .iter()
        .filter(|label| label.at.is_finite())
        .map(|label| (label, aimed.see(label.at)))
        .map(|(label, seen)| (label, [seen.x, seen.y]))
        .collect();
    lettering::write(&mut raster, &labels, 2.0 * width as f32, 2.0 * height as f32);
    if options.axes {
        axes(&mut raster, &aimed, width, height);
    }
    encoded(&raster.halved(), width, height)
}

/// The signs of the coordinates in a model and its mirror images.
fn images(mirrors: [bool; 3]) -> Vec<[f64; 3]> {
    let mut all = vec![[1.0; 3]];
    for k in (0..3).filter(|k| mirrors[*k]) {
        for at in 0..all.len() {
            let mut other = all[at];
            other[k] = -1.0;
            all.push(other);
        }
    }
    all
}

fn image(p: Vec3, signs: [f64; 3]) -> Vec3 {
    Vec3::of(p.x * signs[0], p.y * signs[1], p.z * signs[2])
}

struct Painter<'a> {
    mesh: &'a Mesh,
    aimed: &'a Aimed,
    gamma: &'a Gamma,
    options: &'a Options,
    /// Offset of raised patches.
    lift: f64,
}

impl Painter<'_> {
    /// Draws all panels of an image.
    fn panels(
        &self,
        raster: &mut Raster,
        signs: [f64; 3],
        goes_on: &dyn Fn() -> Result<(), PictureError>,
    ) -> Result<(), PictureError> {
        let side: f64 = signs.iter().product();
        let positions: Vec<Vec3> = self.mesh.positions().iter().map(|&p| image(p, signs)).collect();
        let seen: Vec<ScreenPoint> = positions.iter().map(|&p| self.aimed.see(p)).collect();
        let mut normals = vec![Vec3::zero(); positions.len()];
        for (index, patch) in self.mesh.patches().iter().enumerate() {
            if signs != [1.0; 3] && patch.info.tag == Tag::Symmetry {
                continue;
            }
            let faces = &self.mesh.faces()[patch.faces.clone()];
            // Area-weighted normals at the vertices, of this patch alone: seams stay sharp.
            faces.iter().flatten().for_each(|&v| normals[v as usize] = Vec3::zero());
            let turned = |face: [u32; 4]| {
                let [a, b, c, d] = face.map(|v| positions[v as usize]);
                (c - a).cross(d - b) * side
            };
            for &face in faces {
                let normal = turned(face);
                let corners = if is_triangle(face) { 3 } else { 4 };
                face[..corners].iter().for_each(|&v| normals[v as usize] += normal);
            }
            let look = self.options.looks.as_ref().and_then(|all| all.get(index).copied());
            let colour = look.map_or_else(|| patch_colour(patch, index), |look| look.colour);
            let base = self.gamma.linear(colour);
            let raised = look.is_some_and(|look| look.raised);
            let outlines = self.outlines(faces, &seen);
            for (number, &face) in faces.iter().enumerate() {
                if number % AT_ONCE == 0 {
                    goes_on()?;
                }
                let Some(normal) = turned(face).normalized() else { continue };
                let corners = face.map(|v| {
                    let v = v as usize;
                    // cos 40 degrees: a sharper turn is a crease.
                    let shared = normals[v].normalized().filter(|n| n.dot(normal) > 0.766);
                    let n = shared.filter(|_| self.options.smooth).unwrap_or(normal);
                    let at = if raised { self.raised(positions[v]) } else { seen[v] };
                    ShadedVertex { at, light: self.light(base, n, normal, positions[v]) }
                });
                self.panel(raster, corners, is_triangle(face), outlines);
            }
        }
        Ok(())
    }

    /// Image of a raised point: at its position, but nearer.
    fn raised(&self, p: Vec3) -> ScreenPoint {
        let nearer = self.aimed.see(p + self.aimed.towards(p) * self.lift);
        ScreenPoint { near: nearer.near, ..self.aimed.see(p) }
    }

    /// Strength of the outlines of a patch's panels, 0 to 1; 0 for a patch too fine to show them,
    /// since those of a few larger panels would appear as stains.
    fn outlines(&self, faces: &[[u32; 4]], seen: &[ScreenPoint]) -> f32 {
        if !self.options.edges {
            return 0.0;
        }
        let sum: f32 = faces.iter().map(|f| breadth(f.map(|v| seen[v as usize]))).sum();
        ((sum / faces.len().max(1) as f32 - 4.5) / 3.0).clamp(0.0, 1.0)
    }

    fn panel(
        &self,
        raster: &mut Raster,
        [a, b, c, d]: [ShadedVertex; 4],
        triangle: bool,
        outlines: f32,
    ) {
        // Lines closer than about 3 points would only darken the surface.
        let apart = (breadth([a.at, b.at, c.at, d.at]) - 4.0) / 10.0;
        let strength = 0.62 * outlines * apart.clamp(0.0, 1.0);
        let sides =
            |shown| (strength > 0.0).then_some(PanelSides { shown, half_width: 0.55, strength });
        if triangle {
            raster.triangle([a, b, c], sides([true; 3]));
        } else {
            raster.triangle([a, b, c], sides([true, true, false]));
            raster.triangle([a, c, d], sides([false, true, true]));
        }
    }

    /// The light that a surface of normal `n` (of its panel: `flat`) sends to the viewer.
    fn light(&self, base: [f32; 3], n: Vec3, flat: Vec3, p: Vec3) -> [f32; 3] {
        let eye = self.aimed.towards(p);
        // The back of a surface is the inside: lit from its own side, a little darker.
        let inside = flat.dot(eye) < 0.0;
        let n = if inside { -n } else { n };
        let key = self.aimed.world([-0.45, 0.7, 0.55]);
        let key = key.normalized().unwrap_or(eye);
        let sky = 0.5 + 0.5 * n.z;
        let diffuse = 0.30 + 0.14 * sky + 0.34 * n.dot(eye).max(0.0) + 0.46 * n.dot(key).max(0.0);
        let half = (key + eye).normalized().unwrap_or(eye);
        let gloss = 0.10 * libm::pow(n.dot(half).max(0.0), 40.0);
        let (dim, gloss) = if inside { (0.72, 0.0) } else { (1.0, gloss) };
        base.map(|c| c * (dim * diffuse) as f32 + gloss as f32)
    }
}

/// Width of a panel in the picture, across its longest side.
fn breadth([a, b, c, d]: [ScreenPoint; 4]) -> f32 {
    let cross = (c.x - a.x) * (d.y - b.y) - (c.y - a.y) * (d.x - b.x);
    let sides = [(a, b), (b, c), (c, d), (d, a)].map(|(p, q)| length(q.x - p.x, q.y - p.y));
    0.5 * cross.abs() / sides.into_iter().fold(1.0, f32::max)
}

/// The directions of x, y and z in the lower left corner.
fn axes(raster: &mut Raster, aimed: &Aimed, width: usize, height: usize) {
    let size = 2.0 * (width.min(height) as f64) * 0.045;
    let open = [0.0, f32::INFINITY];
    let (x0, y0) = (1.9 * size, 2.0 * height as f64 - 1.9 * size);
    let at =
        |x: f64, y: f64| ScreenPoint { x: (x0 + x) as f32, y: (y0 - y) as f32, near: f32::MAX };
    // Strokes of the letters in a square of side 2 about the origin.
    let letters: [&[[f64; 4]]; 3] = [
        &[[-0.7, -1.0, 0.7, 1.0], [-0.7, 1.0, 0.7, -1.0]],
        &[[-0.7, 1.0, 0.0, 0.0], [0.7, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, -1.0]],
        &[[-0.7, 1.0, 0.7, 1.0], [0.7, 1.0, -0.7, -1.0], [-0.7, -1.0, 0.7, -1.0]],
    ];
    let colours = [[0xc0, 0x44, 0x3c], [0x35, 0x8a, 0x50], [0x36, 0x63, 0xb0]];
    let unit = [Vec3::of(1.0, 0.0, 0.0), Vec3::of(0.0, 1.0, 0.0), Vec3::of(0.0, 0.0, 1.0)];
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| aimed.turned(unit[a])[2].total_cmp(&aimed.turned(unit[b])[2]));
    for k in order {
        let [right, up, _] = aimed.turned(unit[k]);
        raster.line(at(0.0, 0.0), at(size * right, size * up), 1.6, open, colours[k]);
        let reach = libm::hypot(right, up).max(0.25);
        let (cx, cy) = (right * (1.0 + 0.28 / reach) * size, up * (1.0 + 0.28 / reach) * size);
        let letter = 0.11 * size;
        for [x1, y1, x2, y2] in letters[k] {
            let (p, q) =
                (at(cx + letter * x1, cy + letter * y1), at(cx + letter * x2, cy + letter * y2));
            raster.line(p, q, 1.2, open, colours[k]);
        }
    }
}

/// The PNG file of pixels, three bytes each, row by row from the top.
///
/// # Errors
/// The error of the encoder.
///
/// # Panics
/// When there are not `3 * width * height` bytes.
pub fn encoded(rgb: &[u8], width: usize, height: usize) -> Result<Vec<u8>, PictureError> {
    let failed = |e: png::EncodingError| PictureError::Encoding(e.to_string());
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(rgb).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests;
