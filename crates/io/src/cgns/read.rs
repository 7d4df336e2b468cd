//! Names and points of the zones of CGNS files.

use crate::hdf5::{Hdf5File, Link, StoredNumbers, StoredObject};
use crate::{FilePosition, NamedGrid, ReadError, StructuredGrid};

fn fault(zone: usize, expected: impl Into<String>, found: impl Into<String>) -> ReadError {
    ReadError {
        format: "CGNS",
        place: FilePosition::Block(zone),
        expected: expected.into(),
        found: found.into(),
    }
}

/// The children of a node with a label.
fn labelled(file: &Hdf5File<'_>, node: StoredObject, label: &str) -> Result<Vec<Link>, ReadError> {
    let mut found = Vec::new();
    for link in file.children(node)? {
        let Some(to) = link.to else { continue };
        if link.name.starts_with(' ') {
            continue;
        }
        if file.text(to, "label")?.as_deref() == Some(label) {
            found.push(link);
        }
    }
    Ok(found)
}

/// The numbers of a node; `None` for a node without numbers.
fn data(file: &Hdf5File<'_>, node: StoredObject) -> Result<Option<StoredNumbers>, ReadError> {
    for link in file.children(node)? {
        if link.name == " data"
            && let Some(to) = link.to
        {
            return file.numbers(to).map(Some);
        }
    }
    Ok(None)
}

/// All zones of a file, in the order of creation if the file records it, else by name; those of
/// several bases in sequence. Boundaries, solutions and interfaces are omitted.
///
/// # Errors
/// [`ReadError`] for other files (those in the old ADF among them), unstructured zones, zones without Cartesian
/// coordinates, coordinates in other files or compressed.
pub fn read(bytes: &[u8]) -> Result<Vec<NamedGrid>, ReadError> {
    // The four bytes before it are "@(#)", in most files with the highest bit of each set.
    if bytes.get(4..).is_some_and(|rest| rest.starts_with(b"ADF Database")) {
        return Err(fault(0, "CGNS in HDF5", "CGNS in ADF (`adf2hdf` converts it)"));
    }
    let file = Hdf5File::open(bytes)?;
    let mut zones = Vec::new();
    let bases = labelled(&file, file.root(), "CGNSBase_t")?;
    if bases.is_empty() {
        return Err(fault(0, "a node CGNSBase_t", "an HDF5 file without"));
    }
    for base in bases {
        for link in labelled(&file, base.to.expect("labelled nodes are here"), "Zone_t")? {
            let number = zones.len() + 1;
            let node = link.to.expect("labelled nodes are here");
            zones.push(NamedGrid { grid: zone(&file, node, number)?, name: link.name });
        }
    }
    Ok(zones)
}

fn zone(
    file: &Hdf5File<'_>,
    node: StoredObject,
    number: usize,
) -> Result<StructuredGrid, ReadError> {
    let here = |expected: &str, found: String| fault(number, expected, found);
    for kind in labelled(file, node, "ZoneType_t")? {
        let text = data(file, kind.to.expect("labelled nodes are here"))?;
        let text: String = text.iter().flat_map(|t| &t.values).map(|c| *c as u8 as char).collect();
        if text.trim_end_matches(['\0', ' ']) != "Structured" {
            return Err(here("a structured zone", format!("zone type {text}")));
        }
    }
    let sizes = data(file, node)?.ok_or_else(|| here("sizes of the zone", "none".into()))?;
    let dimensions = match sizes.extents[..] {
        [3, d @ 1..=3] => d,
        _ => return Err(here("sizes of 1 to 3 indices", format!("{:?} numbers", sizes.extents))),
    };
    let mut size = [1usize; 3];
    for (n, x) in size.iter_mut().zip(&sizes.values[..dimensions]) {
        if !(*x >= 1.0 && *x <= 1e9) {
            return Err(here("a number of points", x.to_string()));
        }
        *n = *x as usize;
    }
    let grids = labelled(file, node, "GridCoordinates_t")?;
    let named = grids.iter().find(|link| link.name == "GridCoordinates").or(grids.first());
    let Some(grid) = named else {
        return Err(here("GridCoordinates", "none in this file".into()));
    };
    let grid = grid.to.expect("labelled nodes are here");
    let rind = rind(file, grid, dimensions).map_err(|found| here("rind planes", found))?;
    let arrays = labelled(file, grid, "DataArray_t")?;
    let count = size.iter().try_fold(1usize, |all, n| all.checked_mul(*n));
    let Some(count) = count.filter(|count| (*count as u64) <= 1 << 32) else {
        return Err(here("fewer points", format!("{size:?}")));
    };
    let mut planes: [Vec<f64>; 3] = Default::default();
    let mut known = 0;
    for (plane, axis) in planes.iter_mut().zip(["CoordinateX", "CoordinateY", "CoordinateZ"]) {
        let Some(link) = arrays.iter().find(|link| link.name == axis) else {
            continue;
        };
        known += 1;
        let values = data(file, link.to.expect("labelled nodes are here"))?;
        let Some(values) = values else {
            return Err(here("coordinates in this file", format!("{axis} without numbers")));
        };
        let stored: Vec<usize> =
            (0..3).map(|d| size[d].saturating_add(rind[d][0] + rind[d][1])).collect();
        let expected: Vec<usize> = stored[..dimensions].iter().rev().copied().collect();
        if values.extents != expected {
            return Err(here(
                &format!("{axis} of the zone's points, {expected:?}"),
                format!("{:?}", values.extents),
            ));
        }
        plane.reserve(count);
        for k in 0..size[2] {
            for j in 0..size[1] {
                let row = ((k + rind[2][0]) * stored[1] + j + rind[1][0]) * stored[0] + rind[0][0];
                plane.extend(values.values[row..row + size[0]].iter().map(|x| x + 0.0));
            }
        }
    }
    if known == 0 {
        let found: Vec<&str> = arrays.iter().map(|link| link.name.as_str()).collect();
        return Err(here("CoordinateX, CoordinateY, CoordinateZ", found.join(", ")));
    }
    for plane in &mut planes {
        plane.resize(count, 0.0);
    }
    Ok(StructuredGrid { size, planes, iblank: None })
}

/// The planes beyond each end of each index.
fn rind(
    file: &Hdf5File<'_>,
    grid: StoredObject,
    dimensions: usize,
) -> Result<[[usize; 2]; 3], String> {
    let mut planes = [[0; 2]; 3];
    let nodes = labelled(file, grid, "Rind_t").map_err(|e| e.to_string())?;
    let Some(node) = nodes.first() else { return Ok(planes) };
    let values = data(file, node.to.expect("labelled nodes are here"));
    let values = values.map_err(|e| e.to_string())?.ok_or("none")?.values;
    if values.len() != 2 * dimensions || values.iter().any(|x| !(0.0..=1e6).contains(x)) {
        return Err(format!("{values:?}"));
    }
    for (k, x) in values.iter().enumerate() {
        planes[k / 2][k % 2] = *x as usize;
    }
    Ok(planes)
}
