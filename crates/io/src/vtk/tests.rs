//! Arrays behind the XML, indices of several files, fields of patches.

use super::*;
use crate::fixtures::two_patches;
use crate::{LinesAndPoints, WriteError};
use moldloft_mesh::{Blocks, Mesh, PatchInfo, TopologyBuilder};
use moldloft_num::Vec3;

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

/// Two patches of six vertices that share a column: their values are unchanged in their own files,
/// and means in the common one.
#[test]
fn fields_of_patches_are_point_arrays() {
    let mut b = TopologyBuilder::new();
    b.add_vertices(9).unwrap();
    b.add_block(PatchInfo::new("fore"), 2, 3, (0..6).collect(), false).unwrap();
    b.add_block(PatchInfo::new("aft"), 2, 3, (3..9).collect(), true).unwrap();
    let positions = (0..9).map(|k| Vec3::of((k / 3) as f64, (k % 3) as f64, 0.0)).collect();
    let mesh = Mesh::new(b.build().into(), positions).unwrap();
    let field = |name: &str, components, values: Vec<f64>| VtkArray {
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
    let whole = polydata_with(&mesh, &LinesAndPoints::default(), &all).unwrap();
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
