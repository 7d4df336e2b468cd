//! Panels as VTK polygons, with points, polylines and the fields of patches.

use super::xml::{Appended, PatchFields, VtkArray, array, point_data, strings};
use crate::error::check_positions;
use crate::text::xml;
use crate::{LinesAndPoints, WriteError};
use moldloft_mesh::{Mesh, is_triangle};
use moldloft_num::Vec3;

/// The fields of patches as fields of the mesh's vertices. A vertex of several patches has the mean
/// of their values; one without a value has NaN.
fn by_vertex(mesh: &Mesh, fields: &[PatchFields]) -> Vec<VtkArray> {
    let count = mesh.positions().len();
    let mut out: Vec<(VtkArray, Vec<u32>)> = Vec::new();
    for own in fields {
        let patch = mesh.patches().iter().find(|p| p.info.name == own.patch);
        let Some(block) = patch.and_then(|p| p.block.as_ref()) else { continue };
        for field in &own.fields {
            let parts = field.components;
            if field.values.len() != parts * block.vertices.len() {
                continue;
            }
            let at = out.iter().position(|(f, _)| f.name == field.name && f.components == parts);
            let at = at.unwrap_or_else(|| {
                let (name, values) = (field.name.clone(), vec![0.0; parts * count]);
                out.push((VtkArray { name, components: parts, values }, vec![0; count]));
                out.len() - 1
            });
            let (sum, times) = &mut out[at];
            // A pole occurs several times in its block.
            let mut seen: Vec<(u32, usize)> =
                block.vertices.iter().enumerate().map(|(k, &v)| (v, k)).collect();
            seen.sort_unstable();
            seen.dedup_by_key(|(v, _)| *v);
            for (vertex, k) in seen {
                let values = &field.values[k * parts..(k + 1) * parts];
                if values.iter().all(|x| x.is_finite()) {
                    let vertex = vertex as usize;
                    times[vertex] += 1;
                    for (s, x) in sum.values[vertex * parts..].iter_mut().zip(values) {
                        *s += x;
                    }
                }
            }
        }
    }
    let mean = |(mut field, times): (VtkArray, Vec<u32>)| {
        for (values, &n) in field.values.chunks_mut(field.components).zip(&times) {
            values.iter_mut().for_each(|x| *x = if n == 0 { f64::NAN } else { *x / f64::from(n) });
        }
        field
    };
    out.into_iter().map(mean).collect()
}

/// The `.vtp` file: panels with the cell array `patch` (index of the patch), a cell array `tag NAME`
/// of ones and zeros for each tag that some patch was given, and the field arrays `patch_name` and
/// `patch_tag`, one string per patch.
///
/// # Errors
/// Positions that are not finite.
pub fn polydata(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    polydata_with(mesh, &LinesAndPoints::default(), &[])
}

/// As [`polydata`], with points as vertex cells and polylines as line cells, whose `patch` is -1.
/// The fields of patches are point arrays, averaged where patches meet.
///
/// # Errors
/// As [`polydata`].
pub fn polydata_with(
    mesh: &Mesh,
    loose: &LinesAndPoints,
    fields: &[PatchFields],
) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let mut used = vec![false; mesh.positions().len()];
    mesh.faces().iter().flatten().for_each(|&v| used[v as usize] = true);
    // Vertices of no face may hold anything; they keep their numbers and become zero.
    let points =
        mesh.positions().iter().zip(&used).map(|(&p, &u)| if u { p } else { Vec3::zero() });
    let corners = |face: [u32; 4]| if is_triangle(face) { 3 } else { 4 };
    let mut data = Appended::default();
    let (dots, wires) = (&loose.dots, &loose.wires);
    let wired = wires.iter().flat_map(|(_, line)| line.iter().copied());
    let more = dots.iter().map(|(_, p)| *p).chain(wired);
    let count =
        mesh.positions().len() + dots.len() + wires.iter().map(|w| w.1.len()).sum::<usize>();
    let points = data.add_reals(points.chain(more).flat_map(Vec3::to_array));
    let first = mesh.positions().len() as i64;
    let verts = [
        data.add_integers((0..dots.len() as i64).map(|k| first + k)),
        data.add_integers((0..dots.len() as i64).map(|k| k + 1)),
    ];
    let lines = [
        data.add_integers(first + dots.len() as i64..count as i64),
        data.add_integers(wires.iter().scan(0, |end, w| {
            *end += w.1.len() as i64;
            Some(*end)
        })),
    ];
    let connectivity = data.add_integers(
        mesh.faces().iter().flat_map(|f| f[..corners(*f)].iter().map(|&v| i64::from(v))),
    );
    let offsets = data.add_integers(mesh.faces().iter().scan(0, |end, &f| {
        *end += corners(f) as i64;
        Some(*end)
    }));
    let owners = mesh.patches().iter().enumerate();
    let loose = dots.len() + wires.len();
    let owner = owners.flat_map(|(k, p)| p.faces.clone().map(move |_| k as i64));
    let patch = data.add_integers(std::iter::repeat_n(-1, loose).chain(owner));
    let mut names: Vec<&String> = mesh.patches().iter().flat_map(|p| &p.info.tags).collect();
    names.sort_unstable();
    names.dedup();
    let mut tags = String::new();
    for name in names {
        let has = |info: &moldloft_mesh::PatchInfo| i64::from(info.tags.contains(name));
        let cells = mesh.patches().iter().flat_map(|p| p.faces.clone().map(|_| has(&p.info)));
        let offset = data.add_integers(std::iter::repeat_n(0, loose).chain(cells));
        tags += &array("Int64", &xml(&format!("tag {name}")), 1, offset);
    }
    let mut arrays = String::new();
    for field in by_vertex(mesh, fields) {
        // Loose points and polylines are not on a surface.
        let none = std::iter::repeat_n(f64::NAN, field.components * (count - first as usize));
        let offset = data.add_reals(field.values.iter().copied().chain(none));
        arrays += &array("Float64", &xml(&field.name), field.components, offset);
    }
    let body = format!(
        "<PolyData>\n<FieldData>\n{}{}</FieldData>\n<Piece NumberOfPoints=\"{}\" \
         NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n{}\
         <CellData Scalars=\"patch\">\n{}{tags}</CellData>\n<Points>\n{}</Points>\n{}{}<Polys>\n{}{}</Polys>\n\
         </Piece>\n</PolyData>\n",
        strings("patch_name", mesh.patches().iter().map(|p| p.info.name.as_str())),
        strings("patch_tag", mesh.patches().iter().map(|p| p.info.tag.word())),
        count,
        dots.len(),
        wires.len(),
        mesh.faces().len(),
        point_data(&arrays),
        array("Int64", "patch", 1, patch),
        array("Float64", "Points", 3, points),
        cells("Verts", dots.is_empty(), verts),
        cells("Lines", wires.is_empty(), lines),
        array("Int64", "connectivity", 1, connectivity),
        array("Int64", "offsets", 1, offsets),
    );
    Ok(data.file("PolyData", &body))
}

/// An element of cells; empty without cells.
fn cells(name: &str, none: bool, [connectivity, offsets]: [usize; 2]) -> String {
    if none {
        return String::new();
    }
    let (a, b) =
        (array("Int64", "connectivity", 1, connectivity), array("Int64", "offsets", 1, offsets));
    format!("<{name}>\n{a}{b}</{name}>\n")
}
