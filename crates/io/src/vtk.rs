//! VTK's XML formats: `.vtp` for panels, `.vts` for a structured patch, `.vtm` for several.
//!
//! Arrays stand behind the XML as raw little-endian bytes, each after its length in 64 bits
//! ("VTK File Formats", vtk.org, section "XML File Formats").

use crate::WriteError;
use crate::error::check_positions;
use crate::text::{put, word, xml};
use moldloft_mesh::{Block, Mesh, is_triangle};
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

/// The `.vtp` file: panels with the cell array `patch` (index of the patch) and the field arrays
/// `patch_name` and `patch_tag`, one string per patch.
///
/// # Errors
/// Positions that are not finite.
pub fn polydata(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let mut used = vec![false; mesh.positions().len()];
    mesh.faces().iter().flatten().for_each(|&v| used[v as usize] = true);
    // Vertices of no face may hold anything; they keep their numbers and become zero.
    let points =
        mesh.positions().iter().zip(&used).map(|(&p, &u)| if u { p } else { Vec3::zero() });
    let corners = |face: [u32; 4]| if is_triangle(face) { 3 } else { 4 };
    let mut data = Appended::default();
    let points = data.add_reals(points.flat_map(Vec3::to_array));
    let connectivity = data.add_integers(
        mesh.faces().iter().flat_map(|f| f[..corners(*f)].iter().map(|&v| i64::from(v))),
    );
    let offsets = data.add_integers(mesh.faces().iter().scan(0, |end, &f| {
        *end += corners(f) as i64;
        Some(*end)
    }));
    let owners = mesh.patches().iter().enumerate();
    let patch = data.add_integers(owners.flat_map(|(k, p)| p.faces.clone().map(move |_| k as i64)));
    let body = format!(
        "<PolyData>\n<FieldData>\n{}{}</FieldData>\n<Piece NumberOfPoints=\"{}\" \
         NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n\
         <CellData Scalars=\"patch\">\n{}</CellData>\n<Points>\n{}</Points>\n<Polys>\n{}{}</Polys>\n\
         </Piece>\n</PolyData>\n",
        strings("patch_name", mesh.patches().iter().map(|p| p.info.name.as_str())),
        strings("patch_tag", mesh.patches().iter().map(|p| p.info.tag.word())),
        mesh.positions().len(),
        mesh.faces().len(),
        array("Int64", "patch", 1, patch),
        array("Float64", "Points", 3, points),
        array("Int64", "connectivity", 1, connectivity),
        array("Int64", "offsets", 1, offsets),
    );
    Ok(data.file("PolyData", &body))
}

/// The `.vts` file of one grid, u running fastest.
fn structured(positions: &[Vec3], block: &Block, name: &str) -> Vec<u8> {
    let points = (0..block.nv)
        .flat_map(|j| (0..block.nu).map(move |i| block.at(i, j)))
        .flat_map(|v| positions[v as usize].to_array());
    let mut data = Appended::default();
    let points = data.add_reals(points);
    let extent = format!("0 {} 0 {} 0 0", block.nu - 1, block.nv - 1);
    let body = format!(
        "<StructuredGrid WholeExtent=\"{extent}\">\n<FieldData>\n{}</FieldData>\n\
         <Piece Extent=\"{extent}\">\n<Points>\n{}</Points>\n</Piece>\n</StructuredGrid>\n",
        strings("patch_name", [name].into_iter()),
        array("Float64", "Points", 3, points),
    );
    data.file("StructuredGrid", &body)
}

/// The structured patches as files: `stem.vts` for one; for several `stem.vtm`, which is first and
/// names the others, and `stem-1-name.vts`, `stem-2-name.vts` and so on.
///
/// # Errors
/// [`WriteError::NoGrid`] when some patch has no grid; positions that are not finite.
pub fn structured_files(mesh: &Mesh, stem: &str) -> Result<Vec<NamedFile>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let blocks = crate::plot3d::blocks(mesh)?;
    let named = |name: String, bytes| NamedFile { name, bytes };
    if let [(name, block)] = blocks.as_slice() {
        return Ok(vec![named(format!("{stem}.vts"), structured(mesh.positions(), block, name))]);
    }
    let mut index = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" \
         byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<vtkMultiBlockDataSet>\n",
    );
    let mut files = Vec::new();
    for (k, (name, block)) in blocks.iter().enumerate() {
        let safe: String = word(name)
            .chars()
            .map(|c| if c.is_alphanumeric() || "._-".contains(c) { c } else { '_' })
            .take(80)
            .collect();
        let file = format!("{stem}-{}-{safe}.vts", k + 1);
        let (name, quoted) = (xml(name), xml(&file));
        put!(index, "<DataSet index=\"{k}\" name=\"{name}\" file=\"{quoted}\"/>\n");
        files.push(named(file, structured(mesh.positions(), block, &name)));
    }
    index.push_str("</vtkMultiBlockDataSet>\n</VTKFile>\n");
    files.insert(0, named(format!("{stem}.vtm"), index.into_bytes()));
    Ok(files)
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
        let error = structured_files(&mesh, "hull").unwrap_err();
        assert_eq!(error, WriteError::NoGrid { patches: vec!["lid".into()] });
        let mut b = TopologyBuilder::new();
        b.add_vertices(6).unwrap();
        for name in ["fore & aft", "b/c"] {
            b.add_block(PatchInfo::new(name), 3, 2, (0..6).collect(), false).unwrap();
        }
        let grid = Mesh::new(b.build().into(), mesh.positions()[..6].to_vec()).unwrap();
        let files = structured_files(&grid, "hull").unwrap();
        let names: Vec<_> = files.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["hull.vtm", "hull-1-fore___aft.vts", "hull-2-b_c.vts"]);
        assert!(String::from_utf8(files[0].bytes.clone()).unwrap().contains("fore &amp; aft"));
        // u fastest: the second point is vertex 2.
        assert_eq!(reals(&files[1].bytes, 0)[3..6], [1.0, 0.0, 0.0]);
    }
}
