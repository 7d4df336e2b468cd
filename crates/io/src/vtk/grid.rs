//! Structured patches and grids of points as VTK structured grids.

use super::xml::{Appended, NamedFile, PatchFields, VtkArray, array, point_data, strings};
use crate::error::check_positions;
use crate::plot3d::structured_patches;
use crate::text::{put, word, xml};
use crate::{StructuredGrid, WriteError};
use moldloft_mesh::{Block, Mesh};
use moldloft_num::Vec3;

/// The `.vts` file of one grid, whose vertices come u fastest, then v, as those of the fields. The
/// label is the name of a field array and the text that it holds.
pub(super) fn structured(
    positions: &[Vec3],
    size: [usize; 3],
    vertices: impl Iterator<Item = u32>,
    label: Option<(&str, &str)>,
    fields: &[VtkArray],
) -> Vec<u8> {
    let points = vertices.flat_map(|v| positions[v as usize].to_array());
    let mut data = Appended::default();
    let points = data.add_reals(points);
    let mut arrays = String::new();
    for field in fields {
        let offset = data.add_reals(field.values.iter().copied());
        arrays += &array("Float64", &xml(&field.name), field.components, offset);
    }
    let label = label.map(|(array, name)| strings(array, [name].into_iter()));
    let label = label.map(|array| format!("<FieldData>\n{array}</FieldData>\n"));
    let [nu, nv, nw] = size.map(|n| n - 1);
    let extent = format!("0 {nu} 0 {nv} 0 {nw}");
    let body = format!(
        "<StructuredGrid WholeExtent=\"{extent}\">\n{}<Piece Extent=\"{extent}\">\n{}<Points>\n{}</Points>\n</Piece>\n</StructuredGrid>\n",
        label.unwrap_or_default(),
        point_data(&arrays),
        array("Float64", "Points", 3, points),
    );
    data.file("StructuredGrid", &body)
}

/// The structured patches as files: `stem.vts` for one; for several `stem.vtm`, which is first and
/// names the others, and `stem-1-name.vts`, `stem-2-name.vts` and so on. Fields are point arrays.
///
/// # Errors
/// [`WriteError::NoGrid`] when some patch has no grid; positions that are not finite.
pub fn structured_files(
    mesh: &Mesh,
    stem: &str,
    fields: &[PatchFields],
) -> Result<Vec<NamedFile>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let grids = structured_patches(mesh)?;
    let one = |&(name, b): &(&str, &Block)| {
        let vertices = (0..b.nv).flat_map(|j| (0..b.nu).map(move |i| b.at(i, j)));
        let own = fields.iter().filter(|f| f.patch == name).flat_map(|f| &f.fields);
        let fit = own.filter(|f| f.values.len() == f.components * b.vertices.len());
        // The order of Moldloft has v fastest.
        let turned = |f: &VtkArray| {
            let one = |(i, j): (usize, usize)| {
                let at = (i * b.nv + j) * f.components;
                f.values[at..at + f.components].iter().copied()
            };
            let places = (0..b.nv).flat_map(|j| (0..b.nu).map(move |i| (i, j)));
            VtkArray { values: places.flat_map(one).collect(), ..f.clone() }
        };
        let own: Vec<VtkArray> = fit.map(turned).collect();
        let size = [b.nu, b.nv, 1];
        let bytes = structured(mesh.positions(), size, vertices, Some(("patch_name", name)), &own);
        (name.to_string(), bytes)
    };
    Ok(indexed(grids.iter().map(one).collect(), stem))
}

/// Grids of points as `.vts` files, with a name each: `stem.vts` for one; for several `stem.vtm`,
/// which is first and names the others.
///
/// # Errors
/// No grids; coordinates that are not finite.
pub fn grid_files(
    blocks: &[StructuredGrid],
    names: &[String],
    stem: &str,
) -> Result<Vec<NamedFile>, WriteError> {
    StructuredGrid::check(blocks, f64::MAX)?;
    let one = |(block, name): (&StructuredGrid, &String)| {
        (name.clone(), of_points(block, Some(("grid_name", name)), &[]))
    };
    Ok(indexed(blocks.iter().zip(names).map(one).collect(), stem))
}

/// One grid of points as a `.vts` file, with fields in the order i fastest. Fields of other lengths
/// are refused.
///
/// # Errors
/// Coordinates that are not finite; fields that are not of the grid.
pub fn grid_with_fields(
    block: &StructuredGrid,
    fields: &[VtkArray],
) -> Result<Vec<u8>, WriteError> {
    StructuredGrid::check([block], f64::MAX)?;
    if fields.iter().any(|f| f.values.len() != f.components * block.count()) {
        return Err(WriteError::CannotHold { format: "VTK", what: "a field of another size" });
    }
    Ok(of_points(block, None, fields))
}

fn of_points(block: &StructuredGrid, label: Option<(&str, &str)>, fields: &[VtkArray]) -> Vec<u8> {
    let points: Vec<Vec3> = block.points().collect();
    structured(&points, block.size, 0..points.len() as u32, label, fields)
}

/// One grid as `stem.vts`, or several with their index first.
pub(super) fn indexed(grids: Vec<(String, Vec<u8>)>, stem: &str) -> Vec<NamedFile> {
    let named = |name: String, bytes| NamedFile { name, bytes };
    if grids.len() == 1 {
        return grids.into_iter().map(|(_, bytes)| named(format!("{stem}.vts"), bytes)).collect();
    }
    let mut index = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" \
         byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<vtkMultiBlockDataSet>\n",
    );
    let mut files = Vec::new();
    for (k, (name, bytes)) in grids.into_iter().enumerate() {
        let safe: String = word(&name)
            .chars()
            .map(|c| if c.is_alphanumeric() || "._-".contains(c) { c } else { '_' })
            .take(80)
            .collect();
        let file = format!("{stem}-{}-{safe}.vts", k + 1);
        let (name, quoted) = (xml(&name), xml(&file));
        put!(index, "<DataSet index=\"{k}\" name=\"{name}\" file=\"{quoted}\"/>\n");
        files.push(named(file, bytes));
    }
    index.push_str("</vtkMultiBlockDataSet>\n</VTKFile>\n");
    files.insert(0, named(format!("{stem}.vtm"), index.into_bytes()));
    files
}
