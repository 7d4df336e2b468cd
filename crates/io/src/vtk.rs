//! VTK's XML formats: `.vtp` for panels, `.vts` for a structured patch or block, `.vtm` for several,
//! `.vtu` for all hexahedra of a volume mesh in one.
//!
//! Arrays stand behind the XML as raw little-endian bytes, each after its length in 64 bits
//! ("VTK File Formats", vtk.org, section "XML File Formats").

use crate::error::{check_blocks, check_positions};
use crate::text::{put, word, xml};
use crate::{Strands, WriteError};
use moldloft_mesh::{Blocks, HexBlock, Mesh, is_triangle};
use moldloft_num::Vec3;

/// A file to be written beside others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedFile {
    /// File name, without folder.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// The bytes behind the XML, and where each array starts.
#[derive(Default)]
struct Appended(Vec<u8>);

impl Appended {
    /// Adds an array and returns its offset.
    fn add(&mut self, bytes: &[u8]) -> usize {
        let offset = self.0.len();
        self.0.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
        self.0.extend_from_slice(bytes);
        offset
    }

    fn add_reals(&mut self, values: impl Iterator<Item = f64>) -> usize {
        self.add(&values.flat_map(|x| (x + 0.0).to_le_bytes()).collect::<Vec<_>>())
    }

    fn add_integers(&mut self, values: impl Iterator<Item = i64>) -> usize {
        self.add(&values.flat_map(i64::to_le_bytes).collect::<Vec<_>>())
    }

    /// The whole file around a data set element.
    fn file(self, kind: &str, body: &str) -> Vec<u8> {
        let mut out = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\">\n{body}<AppendedData \
             encoding=\"raw\">\n_"
        )
        .into_bytes();
        out.extend_from_slice(&self.0);
        out.extend_from_slice(b"\n</AppendedData>\n</VTKFile>\n");
        out
    }
}

fn array(kind: &str, name: &str, components: usize, offset: usize) -> String {
    format!(
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
         format=\"appended\" offset=\"{offset}\"/>\n"
    )
}

/// A field array of strings: the bytes of each, ended by zero.
fn strings<'a>(name: &str, values: impl ExactSizeIterator<Item = &'a str>) -> String {
    let mut out = format!(
        "<Array type=\"String\" Name=\"{name}\" NumberOfTuples=\"{}\" format=\"ascii\">\n",
        values.len()
    );
    for value in values {
        for byte in value.bytes().filter(|&b| b != 0) {
            put!(out, "{byte} ");
        }
        out.push_str("0\n");
    }
    out + "</Array>\n"
}

/// Numbers at points.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// The name of the array.
    pub name: String,
    /// Numbers per point.
    pub components: usize,
    /// The numbers, point by point. NaN stands for none.
    pub values: Vec<f64>,
}

/// The fields of a structured patch, point (i, j) of its block at `i * nv + j`.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchFields {
    /// The patch's name.
    pub patch: String,
    /// Its fields.
    pub fields: Vec<Field>,
}

/// The `PointData` element of arrays already added.
fn point_data(arrays: &str) -> String {
    if arrays.is_empty() { String::new() } else { format!("<PointData>\n{arrays}</PointData>\n") }
}

/// The fields of patches as fields of the mesh's vertices. A vertex of several patches has the mean
/// of their numbers; one of none that has the field, NaN.
fn by_vertex(mesh: &Mesh, fields: &[PatchFields]) -> Vec<Field> {
    let count = mesh.positions().len();
    let mut out: Vec<(Field, Vec<u32>)> = Vec::new();
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
                out.push((Field { name, components: parts, values }, vec![0; count]));
                out.len() - 1
            });
            let (sum, times) = &mut out[at];
            // A pole stands several times in its block.
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
    let mean = |(mut field, times): (Field, Vec<u32>)| {
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
    polydata_with(mesh, &Strands::default(), &[])
}

/// As [`polydata`], with points as vertex cells and polylines as line cells, whose `patch` is -1. The
/// fields of patches are point arrays; where patches meet they are the mean of both.
///
/// # Errors
/// As [`polydata`].
pub fn polydata_with(
    mesh: &Mesh,
    strands: &Strands,
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
    let (dots, wires) = (&strands.dots, &strands.wires);
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
        // Points of strands lie on no surface.
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

/// An element of cells, unless there are none.
fn cells(name: &str, none: bool, [connectivity, offsets]: [usize; 2]) -> String {
    if none {
        return String::new();
    }
    let (a, b) =
        (array("Int64", "connectivity", 1, connectivity), array("Int64", "offsets", 1, offsets));
    format!("<{name}>\n{a}{b}</{name}>\n")
}

/// The `.vts` file of one grid, whose vertices come u fastest, then v, as those of the fields.
fn structured(
    positions: &[Vec3],
    size: [usize; 3],
    vertices: impl Iterator<Item = u32>,
    label: &str,
    name: &str,
    fields: &[Field],
) -> Vec<u8> {
    let points = vertices.flat_map(|v| positions[v as usize].to_array());
    let mut data = Appended::default();
    let points = data.add_reals(points);
    let mut arrays = String::new();
    for field in fields {
        let offset = data.add_reals(field.values.iter().copied());
        arrays += &array("Float64", &xml(&field.name), field.components, offset);
    }
    let [nu, nv, nw] = size.map(|n| n - 1);
    let extent = format!("0 {nu} 0 {nv} 0 {nw}");
    let body = format!(
        "<StructuredGrid WholeExtent=\"{extent}\">\n<FieldData>\n{}</FieldData>\n\
         <Piece Extent=\"{extent}\">\n{}<Points>\n{}</Points>\n</Piece>\n</StructuredGrid>\n",
        strings(label, [name].into_iter()),
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
    let grids = crate::plot3d::blocks(mesh)?;
    let one = |&(name, b): &(&str, &moldloft_mesh::Block)| {
        let vertices = (0..b.nv).flat_map(|j| (0..b.nu).map(move |i| b.at(i, j)));
        let own = fields.iter().filter(|f| f.patch == name).flat_map(|f| &f.fields);
        let fit = own.filter(|f| f.values.len() == f.components * b.vertices.len());
        // Ours run along v first.
        let turned = |f: &Field| {
            let one = |(i, j): (usize, usize)| {
                let at = (i * b.nv + j) * f.components;
                f.values[at..at + f.components].iter().copied()
            };
            let places = (0..b.nv).flat_map(|j| (0..b.nu).map(move |i| (i, j)));
            Field { values: places.flat_map(one).collect(), ..f.clone() }
        };
        let own: Vec<Field> = fit.map(turned).collect();
        let size = [b.nu, b.nv, 1];
        let bytes = structured(mesh.positions(), size, vertices, "patch_name", name, &own);
        (name.to_string(), bytes)
    };
    Ok(indexed(grids.iter().map(one).collect(), stem))
}

/// The vertices of a block, u fastest, then v.
fn vertices(block: &HexBlock) -> impl Iterator<Item = u32> + '_ {
    let [nu, nv, nw] = block.size;
    let across = (0..nw).flat_map(move |k| (0..nv).map(move |j| (j, k)));
    across.flat_map(move |(j, k)| (0..nu).map(move |i| block.at([i, j, k])))
}

/// The blocks of a volume mesh as files, named as those of [`structured_files`].
///
/// # Errors
/// [`WriteError::NoGrid`] when there are no blocks; positions that are not finite.
pub fn block_files(blocks: &Blocks, stem: &str) -> Result<Vec<NamedFile>, WriteError> {
    check_blocks(blocks, f64::MAX)?;
    let one = |b: &HexBlock| {
        let bytes = structured(blocks.positions(), b.size, vertices(b), "block_name", &b.name, &[]);
        (b.name.clone(), bytes)
    };
    Ok(indexed(blocks.blocks().iter().map(one).collect(), stem))
}

/// Grids of points as files, named as those of [`structured_files`].
pub(crate) fn lattices(blocks: &[crate::Lattice], stem: &str) -> Vec<NamedFile> {
    let one = |(k, b): (usize, &crate::Lattice)| {
        let points: Vec<Vec3> = (0..b.count())
            .map(|at| Vec3::of(b.planes[0][at], b.planes[1][at], b.planes[2][at]))
            .collect();
        let name = format!("grid {}", k + 1);
        let vertices = 0..points.len() as u32;
        (name.clone(), structured(&points, b.size, vertices, "grid_name", &name, &[]))
    };
    indexed(blocks.iter().enumerate().map(one).collect(), stem)
}

/// One grid as `stem.vts`, or several with their index first.
fn indexed(grids: Vec<(String, Vec<u8>)>, stem: &str) -> Vec<NamedFile> {
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

/// VTK's number for a hexahedron.
const VTK_HEXAHEDRON: u8 = 12;

/// VTK's order of the corners of a hexahedron, by ours (u, v, w are bits 0, 1, 2 of a corner).
const VTK_CORNERS: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// The `.vtu` file: all hexahedra over common points, with the cell array `block` (index of the
/// block) and the field array `block_name`. Cells at poles repeat points.
///
/// # Errors
/// [`WriteError::NoGrid`] when there are no blocks; positions that are not finite.
pub fn unstructured(blocks: &Blocks) -> Result<Vec<u8>, WriteError> {
    check_blocks(blocks, f64::MAX)?;
    let cells = || blocks.blocks().iter().flat_map(|b| b.cells().map(move |place| b.cell(place)));
    let count = blocks.cell_count();
    let mut used = vec![false; blocks.positions().len()];
    cells().flatten().for_each(|v| used[v as usize] = true);
    let points = blocks.positions().iter().zip(&used);
    let points = points.map(|(&p, &u)| if u { p } else { Vec3::zero() });
    let mut data = Appended::default();
    let points = data.add_reals(points.flat_map(Vec3::to_array));
    let corners = cells().flat_map(|cell| VTK_CORNERS.map(|c| i64::from(cell[c])));
    let connectivity = data.add_integers(corners);
    let offsets = data.add_integers((1..=count as i64).map(|k| 8 * k));
    let types = data.add(&vec![VTK_HEXAHEDRON; count]);
    let owners = blocks.blocks().iter().enumerate();
    let owner =
        data.add_integers(owners.flat_map(|(k, b)| std::iter::repeat_n(k as i64, b.cell_count())));
    let body = format!(
        "<UnstructuredGrid>\n<FieldData>\n{}</FieldData>\n<Piece NumberOfPoints=\"{}\" \
         NumberOfCells=\"{count}\">\n<CellData Scalars=\"block\">\n{}</CellData>\n<Points>\n{}\
         </Points>\n<Cells>\n{}{}{}</Cells>\n</Piece>\n</UnstructuredGrid>\n",
        strings("block_name", blocks.blocks().iter().map(|b| b.name.as_str())),
        blocks.positions().len(),
        array("Int64", "block", 1, owner),
        array("Float64", "Points", 3, points),
        array("Int64", "connectivity", 1, connectivity),
        array("Int64", "offsets", 1, offsets),
        array("UInt8", "types", 1, types),
    );
    Ok(data.file("UnstructuredGrid", &body))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::two_patches;
    use moldloft_mesh::{PatchInfo, TopologyBuilder};

    /// The reals of the array at an offset.
    fn reals(file: &[u8], offset: usize) -> Vec<f64> {
        let mark = b"encoding=\"raw\">\n_";
        let data = file.windows(mark.len()).position(|w| w == mark).unwrap() + mark.len() + offset;
        let size = u64::from_le_bytes(file[data..data + 8].try_into().unwrap()) as usize;
        let bytes = &file[data + 8..data + 8 + size];
        bytes.chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
    }

    #[test]
    fn points_stand_behind_the_xml() {
        let mesh = two_patches();
        let file = polydata(&mesh).unwrap();
        let points = reals(&file, 0);
        assert_eq!(points.len(), 27);
        assert_eq!(points[3..6], [0.1, 1.0, -0.5]);
        assert!(file.windows(10).any(|w| w == b"patch_name"));
    }

    #[test]
    fn grids_become_files() {
        let mesh = two_patches();
        let error = structured_files(&mesh, "hull", &[]).unwrap_err();
        assert_eq!(error, WriteError::NoGrid { patches: vec!["lid".into()] });
        let mut b = TopologyBuilder::new();
        b.add_vertices(6).unwrap();
        for name in ["fore & aft", "b/c"] {
            b.add_block(PatchInfo::new(name), 3, 2, (0..6).collect(), false).unwrap();
        }
        let grid = Mesh::new(b.build().into(), mesh.positions()[..6].to_vec()).unwrap();
        let files = structured_files(&grid, "hull", &[]).unwrap();
        let names: Vec<_> = files.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["hull.vtm", "hull-1-fore___aft.vts", "hull-2-b_c.vts"]);
        assert!(String::from_utf8(files[0].bytes.clone()).unwrap().contains("fore &amp; aft"));
        // u fastest: the second point is vertex 2.
        assert_eq!(reals(&files[1].bytes, 0)[3..6], [1.0, 0.0, 0.0]);
    }

    /// Two patches of six vertices that share a column: their numbers stand in their own files as
    /// they are, and in the common one as means.
    #[test]
    fn fields_of_patches_are_point_arrays() {
        let mut b = TopologyBuilder::new();
        b.add_vertices(9).unwrap();
        b.add_block(PatchInfo::new("fore"), 2, 3, (0..6).collect(), false).unwrap();
        b.add_block(PatchInfo::new("aft"), 2, 3, (3..9).collect(), true).unwrap();
        let positions = (0..9).map(|k| Vec3::of((k / 3) as f64, (k % 3) as f64, 0.0)).collect();
        let mesh = Mesh::new(b.build().into(), positions).unwrap();
        let field = |name: &str, components, values: Vec<f64>| Field {
            name: name.into(),
            components,
            values,
        };
        let of = |patch: &str, fields| PatchFields { patch: patch.into(), fields };
        let fore = field("bend", 1, (0..6).map(f64::from).collect());
        let aft = field("bend", 1, vec![13.0, f64::NAN, 15.0, 1.0, 1.0, 1.0]);
        let arrow = field("arrow", 3, (0..18).map(f64::from).collect());
        let wrong = field("wrong", 1, vec![1.0]);
        let all = [of("fore", vec![fore, wrong]), of("aft", vec![aft, arrow]), of("mast", vec![])];
        let whole = polydata_with(&mesh, &Strands::default(), &all).unwrap();
        let text = String::from_utf8_lossy(&whole).into_owned();
        let offset = |text: &str, name: &str| -> usize {
            let at = text.find(&format!("Name=\"{name}\"")).unwrap();
            let (_, rest) = text[at..].split_once("offset=\"").unwrap();
            rest.split('"').next().unwrap().parse().unwrap()
        };
        let bend = reals(&whole, offset(&text, "bend"));
        assert_eq!(bend, [0.0, 1.0, 2.0, 8.0, 4.0, 10.0, 1.0, 1.0, 1.0]);
        let arrow = reals(&whole, offset(&text, "arrow"));
        assert!(arrow[..9].iter().all(|x| x.is_nan()) && arrow[9..12] == [0.0, 1.0, 2.0]);
        assert!(!text.contains("wrong"));
        let files = structured_files(&mesh, "hull", &all).unwrap();
        let text = String::from_utf8_lossy(&files[1].bytes).into_owned();
        // u fastest in the file, v in the block.
        let bend = reals(&files[1].bytes, offset(&text, "bend"));
        assert_eq!(bend, [0.0, 3.0, 1.0, 4.0, 2.0, 5.0]);
        assert!(!text.contains("arrow"));
    }

    #[test]
    fn blocks_become_files() {
        let blocks = crate::fixtures::two_bricks();
        let files = block_files(&blocks, "grid").unwrap();
        let names: Vec<_> = files.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["grid.vtm", "grid-1-fore.vts", "grid-2-aft.vts"]);
        // u fastest.
        assert_eq!(reals(&files[2].bytes, 0)[..6], [1.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
        let whole = unstructured(&blocks).unwrap();
        assert_eq!(reals(&whole, 0).len(), 3 * 16);
        let text = String::from_utf8_lossy(&whole);
        assert!(text.contains("NumberOfPoints=\"16\" NumberOfCells=\"3\""));
        let none = Blocks::new(vec![], vec![]).unwrap();
        assert!(unstructured(&none).is_err() && block_files(&none, "x").is_err());
    }
}
