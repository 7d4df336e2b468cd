//! WAMIT's geometric data files, of low and of high order.
//!
//! Lines: a title; `ULEN GRAV`; `ISX ISY`; `NPAN`; then the corners of the panels, free format.
//! The corners of a panel are counter-clockwise seen from the water (WAMIT User Manual, 6.1), which
//! is this house's own orientation; a triangle repeats a corner. `ISX` = 1 means that x = 0 is a
//! plane of symmetry, `ISY` = 1 that y = 0 is, and only one half, or quarter, is listed.

use crate::solver::{SolverPanels, title};
use crate::text::{TextLine, pointed, put, quoted, real, utf8};
use crate::{FilePosition, PanelFileOptions, ReadError, WriteError};
use moldloft_mesh::{Mesh, PatchInfo, TopologyBuilder};
use moldloft_num::{Order, Vec3};
use moldloft_spline::{Basis, KnotVector};

const FORMAT: &str = "GDF";

/// Content of the header.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// First line.
    pub title: String,
    /// Length by which WAMIT makes its results dimensionless, in the model's unit.
    pub length: f64,
    /// Acceleration of gravity in the model's unit per second squared.
    pub gravity: f64,
    /// x = 0 is a symmetry plane; one side is listed.
    pub mirror_x: bool,
    /// y = 0 is a symmetry plane; one side is listed.
    pub mirror_y: bool,
}

impl Default for Header {
    /// Length 1, gravity 9.80665 (ISO 80000-3), no symmetry.
    fn default() -> Self {
        let (length, gravity) = (1.0, 9.80665);
        Self { title: "panels".into(), length, gravity, mirror_x: false, mirror_y: false }
    }
}

impl Header {
    /// The first three lines, which the low and the high order share.
    pub(crate) fn lines(&self) -> String {
        let (length, gravity) = (real(self.length), real(self.gravity));
        let (x, y) = (u8::from(self.mirror_x), u8::from(self.mirror_y));
        format!("{}\n{length} {gravity}\n{x} {y}\n", title(&self.title))
    }
}

/// The file of the mesh's skin, without patches that are water or symmetry planes, and with lids
/// only if `lids` is set.
///
/// Corners within 1e-9 of the mesh's diagonal from a symmetry plane are written with an exact zero.
///
/// # Errors
/// Positions that are not finite, and a half that crosses its symmetry plane.
pub fn write(mesh: &Mesh, header: &Header, lids: bool) -> Result<Vec<u8>, WriteError> {
    let options = PanelFileOptions { mirror_x: header.mirror_x, mirror_y: header.mirror_y, lids };
    let panels = SolverPanels::of(mesh, options)?;
    let mut out = String::with_capacity(200 + 240 * panels.faces.len());
    put!(out, "{}", header.lines());
    put!(out, "{}\n", panels.faces.len());
    for face in &panels.faces {
        for v in face {
            let [x, y, z] = panels.points[*v as usize].map(real);
            put!(out, "{x} {y} {z}\n");
        }
    }
    Ok(out.into_bytes())
}

/// A B-spline patch with clamped uniform knots on [-1, 1].
#[derive(Clone, Debug, PartialEq)]
pub struct SplinePatch {
    /// The surface that contains the patch.
    pub name: String,
    /// Degrees in u and v.
    pub degree: [usize; 2],
    /// Spans in u and v.
    pub spans: [usize; 2],
    /// Control points, v fastest.
    pub points: Vec<Vec3>,
    /// The largest deviation found from the surface; rounding if the form is exact.
    pub deviation: f64,
}

impl SplinePatch {
    /// The knots of uniform spans of [-1, 1], end knots included.
    ///
    /// # Panics
    /// When the degree is 0 or above the largest one, or there are no spans.
    pub fn uniform_knots(degree: usize, spans: usize) -> KnotVector {
        let inner = (1..spans).map(|k| -1.0 + (2 * k) as f64 / spans as f64);
        let ends = |x: f64| std::iter::repeat_n(x, degree + 1);
        let knots = ends(-1.0).chain(inner).chain(ends(1.0)).collect();
        KnotVector::new(degree, knots).expect("even knots ascend")
    }

    /// The knots of u (0) or v (1).
    pub fn knots(&self, axis: usize) -> KnotVector {
        Self::uniform_knots(self.degree[axis], self.spans[axis])
    }

    /// Points on a grid of parameters in [-1, 1], v fastest.
    pub fn grid(&self, us: &[f64], vs: &[f64]) -> Vec<Vec3> {
        let width = self.degree[1] + self.spans[1];
        let of = |axis: usize, t: &[f64]| -> Vec<Basis<f64>> {
            let knots = self.knots(axis);
            t.iter().map(|&t| knots.basis(t, Order::Zero)).collect()
        };
        let (us, vs) = (of(0, us), of(1, vs));
        let place = |a: &Basis<f64>, b: &Basis<f64>| {
            let mut sum = Vec3::zero();
            for (i, &x) in a.rows[0].iter().enumerate() {
                for (j, &y) in b.rows[0].iter().enumerate() {
                    sum += self.points[(a.first + i) * width + b.first + j] * (x * y);
                }
            }
            sum
        };
        us.iter().flat_map(|a| vs.iter().map(move |b| place(a, b))).collect()
    }

    /// Turns u round.
    pub fn turn(&mut self) {
        let width = self.degree[1] + self.spans[1];
        let rows = self.points.chunks(width).rev();
        self.points = rows.flatten().copied().collect();
    }
}

/// The high-order file (IGDEF = 1): for each patch its spans `NUG NVG`, orders `KUG KVG` (degree +
/// 1), the knots in u and in v, and the control points, u fastest (WAMIT User Manual 7.6).
pub fn write_patches(patches: &[SplinePatch], header: &Header) -> Vec<u8> {
    let mut out = header.lines();
    put!(out, "{} 1\n", patches.len());
    for patch in patches {
        let ([m, n], [p, q]) = (patch.spans, patch.degree);
        put!(out, "{m} {n}\n{} {}\n", p + 1, q + 1);
        for axis in [0, 1] {
            let knots: Vec<String> =
                patch.knots(axis).as_slice().iter().map(|&x| pointed(x)).collect();
            put!(out, "{}\n", knots.join(" "));
        }
        let width = q + n;
        for k in 0..patch.points.len() {
            let height = p + m;
            let [x, y, z] = patch.points[k % height * width + k / height].to_array().map(pointed);
            put!(out, "{x} {y} {z}\n");
        }
    }
    out.into_bytes()
}

/// The header and the panels. Corners at bit-equal positions become one vertex; panels without area
/// are omitted.
///
/// # Errors
/// Words that are no numbers, and fewer or more corners than the file promises.
pub fn read(bytes: &[u8]) -> Result<(Header, Mesh), ReadError> {
    let text = utf8(bytes, FORMAT)?;
    let mut lines =
        (1..).zip(text.lines()).map(|(number, text)| TextLine { format: FORMAT, number, text });
    let mut line = |what: &str| {
        lines.next().ok_or_else(|| ReadError {
            format: FORMAT,
            place: FilePosition::Byte(bytes.len()),
            expected: what.into(),
            found: "the end of the file".into(),
        })
    };
    let title = line("a title")?.text.trim().to_string();
    let scales = line("ULEN and GRAV")?;
    let mut words = scales.words();
    let length = scales.real(words.next(), "the length ULEN")?;
    let gravity = scales.real(words.next(), "the gravity GRAV")?;
    let symmetry = line("ISX and ISY")?;
    let mut words = symmetry.words();
    let mut flag = |what: &str| match symmetry.integer(words.next(), what)? {
        0 => Ok(false),
        1 => Ok(true),
        other => Err(symmetry.error(format!("0 or 1 for {what}"), other.to_string())),
    };
    let (mirror_x, mirror_y) = (flag("ISX")?, flag("ISY")?);
    let counts = line("the number of panels")?;
    let panels = counts.integer(counts.words().next(), "the number of panels")?;
    let panels = usize::try_from(panels)
        .ok()
        .filter(|n| *n <= bytes.len() / 24)
        .ok_or_else(|| counts.error("a number of panels that fits the file", panels.to_string()))?;

    let mut numbers: Vec<f64> = Vec::new();
    let mut last = counts.number;
    for line in lines {
        last = line.number;
        for word in line.words() {
            if numbers.len() == 12 * panels {
                return Err(line.error(format!("the end after {panels} panels"), quoted(word)));
            }
            numbers.push(line.real(Some(word), "a coordinate")?);
        }
    }
    if numbers.len() != 12 * panels {
        return Err(ReadError {
            format: FORMAT,
            place: FilePosition::Line(last),
            expected: format!("{} coordinates of {panels} panels", 12 * panels),
            found: numbers.len().to_string(),
        });
    }
    let positions: Vec<Vec3> =
        numbers.chunks_exact(3).map(|p| Vec3::of(p[0], p[1], p[2])).collect();
    let build = || {
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(positions.len())?;
        let faces = (0..panels as u32).map(|k| [4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3]);
        builder.add_faces(PatchInfo::new("panels"), faces)?;
        Mesh::new(builder.build().into(), positions)?.welded()
    };
    let mesh = build().map_err(|e| ReadError::mesh(FORMAT, FilePosition::Line(last), e))?;
    Ok((Header { title, length, gravity, mirror_x, mirror_y }, mesh))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::two_patches;
    use moldloft_mesh::measure;

    #[test]
    fn panels_come_back() {
        let mesh = two_patches();
        let header = Header { title: "a hull".into(), mirror_y: true, ..Header::default() };
        let bytes = write(&mesh, &header, false).unwrap();
        let text = String::from_utf8(bytes.clone()).unwrap();
        assert!(text.starts_with("a hull\n1 9.80665\n0 1\n4\n0 0 0\n1 0 0\n"), "{text}");
        let (read_header, back) = read(&bytes).unwrap();
        assert_eq!(read_header, header);
        assert_eq!(back.faces().len(), 4);
        let skin = measure(&mesh).area - moldloft_mesh::measure_patch(&mesh, 2).area;
        assert!((measure(&back).area - skin).abs() < 1e-15);
        let (_, with_lid) = read(&write(&mesh, &header, true).unwrap()).unwrap();
        assert_eq!(with_lid.faces().len(), 5);
    }

    #[test]
    fn a_half_stays_on_its_side() {
        let mesh = two_patches();
        let header = Header { mirror_y: true, ..Header::default() };
        let moved = |y: f64| {
            let mut p = mesh.positions().to_vec();
            p[0].y = y;
            Mesh::new(mesh.topology().clone(), p).unwrap()
        };
        // A tiny excess is rounding; a millimetre is not.
        let bytes = write(&moved(-1e-12), &header, false).unwrap();
        assert!(String::from_utf8(bytes).unwrap().contains("\n4\n0 0 0\n"));
        let error = write(&moved(-1e-3), &header, false).unwrap_err();
        assert!(matches!(error, WriteError::BothSides { axis: 'y', .. }));
        let error = write(&moved(f64::NAN), &header, false).unwrap_err();
        assert_eq!(error, WriteError::NotFinite { patch: "fore body".into(), vertex: 0 });
    }

    #[test]
    fn broken_files_are_explained() {
        let cases = [
            ("", "a title"),
            ("t\n1 x\n", "the gravity GRAV"),
            ("t\n1 9.8\n0 2\n", "0 or 1 for ISY"),
            ("t\n1 9.8\n0 0\n999999999\n", "fits the file"),
            ("t\n1 9.8\n0 0\n-1\n", "fits the file"),
            ("t\n1 9.8\n0 0\n1\n0 0 0 1 0 0 1 1 0 0 1\n", "12 coordinates"),
            ("t\n1 9.8\n0 0\n1\n0 0 0 1 0 0 1 1 0 0 1 nan\n", "a coordinate"),
            ("t\n1 9.8\n0 0\n1\n0 0 0 1 0 0 1 1 0 0 1 0\n7", "the end after 1 panels"),
        ];
        for (text, expected) in cases {
            let error = read(text.as_bytes()).unwrap_err();
            assert!(error.expected.contains(expected), "{text:?}: {error}");
        }
        assert!(read(b"\xff\xfe").is_err());
        let fortran = b"t\n1.D0 9.8\n0 0\n1\n0 0 0, 1 0 0\n 1.0D+0 1 0 0 1 0\n";
        assert_eq!(measure(&read(fortran).unwrap().1).area, 1.0);
    }
}
