//! Nodes of CGNS files, from zones with their interfaces and boundaries.

use crate::hdf5::{self, Hdf5Array, Hdf5Attribute, Hdf5Element, Hdf5Group, Hdf5Object};
use crate::{StructuredGrid, WriteError};
use std::borrow::Cow;
use std::collections::HashSet;

/// A part of a face of a block: block, face in the order u = 0, u = 1, v = 0, ..., first and last node (i, j, k) from 0.
pub type FacePart = (usize, usize, [usize; 3], [usize; 3]);

/// A periodic joint: the centre and the angles of a rotation, in radians, and a translation.
pub type PeriodicJoint = ([f64; 3], [f64; 3], [f64; 3]);

/// Both sides of a joint; for each axis of the first, the axis of the second, from 1, negative if
/// opposite; and the position of the second relative to the first, if periodic.
pub type BlockJoint = (FacePart, FacePart, [i32; 3], Option<PeriodicJoint>);

/// Content of a file.
pub(super) struct CgnsFile<'a> {
    pub title: &'a str,
    /// Unit of length; empty if unknown.
    pub length: &'a str,
    /// Indices of a point: 2 of surfaces, 3 of blocks.
    pub dimensions: usize,
    pub families: Vec<CgnsFamily<'a>>,
    pub zones: Vec<CgnsZone<'a>>,
    pub joints: Vec<BlockJoint>,
}

pub(super) struct CgnsFamily<'a> {
    pub name: Cow<'a, str>,
    /// A BCType of SIDS.
    pub condition: &'static str,
    pub tag: Option<&'a str>,
}

pub(super) struct CgnsZone<'a> {
    pub name: String,
    pub grid: Cow<'a, StructuredGrid>,
    /// Its family's number.
    pub family: Option<usize>,
    pub boundaries: Vec<CgnsBoundary>,
}

pub(super) struct CgnsBoundary {
    pub name: String,
    pub part: FacePart,
    pub condition: CgnsCondition,
}

#[derive(Clone, Copy)]
pub(super) enum CgnsCondition {
    /// A BCType of SIDS.
    Type(&'static str),
    /// That of the family of this number.
    Family(usize),
}

/// Units of length that SIDS has a name for.
const LENGTHS: [(&str, &str); 5] =
    [("m", "Meter"), ("cm", "Centimeter"), ("mm", "Millimeter"), ("ft", "Foot"), ("in", "Inch")];

/// Maximum number of characters of a node's name.
const NAME_LENGTH: usize = 32;

/// Bytes of the attributes of a name or label, and of a type.
const NAME_BYTES: usize = NAME_LENGTH + 1;
const TYPE_BYTES: usize = 3;

/// Names of the nodes of a base besides zones and families.
const RESERVED_NAMES: [&str; 3] = ["DataClass", "DimensionalUnits", "UnitOfLength"];

/// A group of HDF5 and its data.
struct CgnsNode {
    name: String,
    label: &'static str,
    data: Option<Hdf5Array>,
    children: Vec<CgnsNode>,
}

impl CgnsNode {
    fn new(name: impl Into<String>, label: &'static str, data: Option<Hdf5Array>) -> Self {
        Self { name: name.into(), label, data, children: Vec::new() }
    }

    fn text(name: impl Into<String>, label: &'static str, text: &str) -> Self {
        let bytes = ascii(text);
        Self::new(name, label, Some(Hdf5Array::characters(vec![bytes.len()], bytes)))
    }

    fn member(self) -> (String, Hdf5Object) {
        let kind = self.data.as_ref().map_or("MT", |data| element_type(data.element));
        let text = |text: &str, width: usize| Hdf5Attribute::Text(text.to_string(), width);
        let attributes = vec![
            ("name", text(&self.name, NAME_BYTES)),
            ("label", text(self.label, NAME_BYTES)),
            ("type", text(kind, TYPE_BYTES)),
            ("flags", Hdf5Attribute::Integers(vec![1])),
        ];
        let data = self.data.map(|data| (" data".to_string(), Hdf5Object::Array(data)));
        let children = self.children.into_iter().map(Self::member);
        let members = data.into_iter().chain(children).collect();
        (self.name, Hdf5Object::Group(Hdf5Group { attributes, members }))
    }
}

fn element_type(element: Hdf5Element) -> &'static str {
    match element {
        Hdf5Element::Byte => "C1",
        Hdf5Element::Integer => "I4",
        Hdf5Element::Single => "R4",
        Hdf5Element::Double => "R8",
    }
}

fn ascii(text: &str) -> Vec<u8> {
    text.chars().map(|c| if c.is_ascii() { c as u8 } else { b'?' }).collect()
}

/// A text padded with zeros to a number of bytes.
fn padded(text: &str, bytes: usize) -> Hdf5Object {
    let mut characters = ascii(text);
    characters.resize(bytes, 0);
    Hdf5Object::Array(Hdf5Array::characters(vec![bytes], characters))
}

/// A name for a node that none in `taken` has, without slashes.
fn unique(name: &str, taken: &mut HashSet<String>) -> String {
    let sound = |c: char| (c.is_ascii_graphic() || c == ' ') && !"/\\?".contains(c);
    let base: String =
        name.trim().chars().map(|c| if sound(c) { c } else { '_' }).take(NAME_LENGTH).collect();
    let base = if base.is_empty() { "unnamed".to_string() } else { base };
    let mut found = base.clone();
    let mut count = 1;
    while taken.contains(&found) || found == "." || found == ".." {
        count += 1;
        let end = format!("~{count}");
        found = format!("{}{end}", &base[..base.len().min(NAME_LENGTH - end.len())]);
    }
    taken.insert(found.clone());
    found
}

impl CgnsFile<'_> {
    /// The bytes of the file.
    ///
    /// # Errors
    /// More points along an index, or more zones than a file can number.
    pub fn write(self) -> Result<Vec<u8>, WriteError> {
        let version = Hdf5Array::singles(&[3.3]);
        let version = CgnsNode::new("CGNSLibraryVersion", "CGNSLibraryVersion_t", Some(version));
        let attribute =
            |name, text: &str, width| (name, Hdf5Attribute::Text(text.to_string(), width));
        let root = Hdf5Group {
            attributes: vec![
                attribute("name", "HDF5 MotherNode", NAME_BYTES),
                attribute("label", "Root Node of HDF5 File", NAME_BYTES),
                attribute("type", "MT", TYPE_BYTES),
            ],
            members: vec![
                (" format".into(), padded("IEEE_LITTLE_32", 15)),
                (" hdf5version".into(), padded("HDF5 Version 1.8.0", NAME_BYTES)),
                version.member(),
                self.base()?.member(),
            ],
        };
        hdf5::write(root)
    }

    fn base(self) -> Result<CgnsNode, WriteError> {
        let mut taken: HashSet<String> = HashSet::from(["CGNSLibraryVersion".to_string()]);
        let title = unique(self.title, &mut taken);
        let sizes = Hdf5Array::integers(vec![2], &[self.dimensions as i32, 3]);
        let mut base = CgnsNode::new(title, "CGNSBase_t", Some(sizes));
        base.children = units(self.length);

        let mut taken: HashSet<String> = RESERVED_NAMES.map(str::to_string).into();
        let zones: Vec<String> =
            self.zones.iter().map(|zone| unique(&zone.name, &mut taken)).collect();
        let families: Vec<String> =
            self.families.iter().map(|family| unique(&family.name, &mut taken)).collect();
        for (family, name) in self.families.iter().zip(&families) {
            let mut node = CgnsNode::new(name, "Family_t", None);
            node.children.push(CgnsNode::text("FamilyBC", "FamilyBC_t", family.condition));
            let tag = family.tag.map(|tag| CgnsNode::text("Tag", "Descriptor_t", tag));
            node.children.extend(tag);
            base.children.push(node);
        }
        for (number, zone) in self.zones.into_iter().enumerate() {
            let mut node = zone_node(&zones[number], &zone, &families, self.dimensions)?;
            node.children.extend(connections(&self.joints, number, &zones, self.dimensions));
            node.children.extend(boundaries(&zone, &families, self.dimensions));
            base.children.push(node);
        }
        Ok(base)
    }
}

/// The unit of lengths: one of SIDS, a user-defined or an unknown one.
fn units(length: &str) -> Vec<CgnsNode> {
    if length.is_empty() {
        return vec![CgnsNode::text("DataClass", "DataClass_t", "NormalizedByUnknownDimensional")];
    }
    let known = LENGTHS.iter().find(|(own, _)| *own == length).map(|(_, word)| *word);
    let words = ["Null", known.unwrap_or("UserDefined"), "Null", "Null", "Null"];
    let rows: String = words.map(|word| format!("{word:NAME_LENGTH$}")).concat();
    let rows = Hdf5Array::characters(vec![words.len(), NAME_LENGTH], rows.into_bytes());
    let mut nodes = vec![
        CgnsNode::text("DataClass", "DataClass_t", "Dimensional"),
        CgnsNode::new("DimensionalUnits", "DimensionalUnits_t", Some(rows)),
    ];
    if known.is_none() {
        nodes.push(CgnsNode::text("UnitOfLength", "Descriptor_t", length));
    }
    nodes
}

fn zone_node(
    name: &str,
    zone: &CgnsZone<'_>,
    families: &[String],
    dimensions: usize,
) -> Result<CgnsNode, WriteError> {
    let grid = &zone.grid;
    let size = &grid.size[..dimensions];
    let mut sizes = Vec::with_capacity(3 * dimensions);
    for n in size {
        let what = "points along an index";
        sizes.push(i32::try_from(*n).map_err(|_| WriteError::TooLarge { what, count: *n })?);
    }
    sizes.extend_from_within(..);
    sizes[dimensions..].iter_mut().for_each(|n| *n -= 1);
    sizes.resize(3 * dimensions, 0);
    let mut node =
        CgnsNode::new(name, "Zone_t", Some(Hdf5Array::integers(vec![3, dimensions], &sizes)));
    node.children.push(CgnsNode::text("ZoneType", "ZoneType_t", "Structured"));
    let family = zone.family.map(|of| CgnsNode::text("FamilyName", "FamilyName_t", &families[of]));
    node.children.extend(family);
    let mut points = CgnsNode::new("GridCoordinates", "GridCoordinates_t", None);
    for (letter, plane) in ["X", "Y", "Z"].into_iter().zip(&grid.planes) {
        let extents = size.iter().rev().copied().collect();
        let values: Vec<f64> = plane.iter().map(|x| x + 0.0).collect();
        let array = Hdf5Array::doubles(extents, &values);
        let mut axis = CgnsNode::new(format!("Coordinate{letter}"), "DataArray_t", Some(array));
        let exponents = Hdf5Array::singles(&[0.0, 1.0, 0.0, 0.0, 0.0]);
        axis.children.push(CgnsNode::new(
            "DimensionalExponents",
            "DimensionalExponents_t",
            Some(exponents),
        ));
        points.children.push(axis);
    }
    node.children.push(points);
    Ok(node)
}

/// The first and last index of a range, from 1.
fn range(name: &str, [from, to]: [[usize; 3]; 2], dimensions: usize) -> CgnsNode {
    let ends: Vec<i32> =
        [from, to].iter().flat_map(|at| &at[..dimensions]).map(|k| *k as i32 + 1).collect();
    let ends = Hdf5Array::integers(vec![2, dimensions], &ends);
    CgnsNode::new(name, "IndexRange_t", Some(ends))
}

/// A joint from the other side.
fn reversed((own, donor, transform, periodic): &BlockJoint) -> BlockJoint {
    let mut back = [0; 3];
    for (axis, number) in transform.iter().enumerate() {
        back[number.unsigned_abs() as usize - 1] = (axis as i32 + 1) * number.signum();
    }
    let periodic =
        periodic.map(|(centre, angles, shift)| (centre, angles.map(|x| -x), shift.map(|x| -x)));
    (*donor, *own, back, periodic)
}

/// Interfaces of a zone, each as seen from it: those inside of it twice.
fn connections(
    joints: &[BlockJoint],
    zone: usize,
    names: &[String],
    dimensions: usize,
) -> Option<CgnsNode> {
    let own = joints.iter().filter(|joint| joint.0.0 == zone).copied();
    let others = joints.iter().filter(|joint| joint.1.0 == zone).map(reversed);
    let mut group = CgnsNode::new("ZoneGridConnectivity", "ZoneGridConnectivity_t", None);
    for (number, (own, donor, transform, periodic)) in own.chain(others).enumerate() {
        let name = format!("join{}", number + 1);
        let mut node = CgnsNode::text(name, "GridConnectivity1to1_t", &names[donor.0]);
        // The own range rises, the donor's follows it.
        let (mut ends, mut donor_ends) = ([own.2, own.3], [donor.2, donor.3]);
        for (axis, number) in transform.iter().enumerate() {
            if ends[0][axis] > ends[1][axis] {
                let other = number.unsigned_abs() as usize - 1;
                for (pair, axis) in [(&mut ends, axis), (&mut donor_ends, other)] {
                    let [first, last] = pair;
                    std::mem::swap(&mut first[axis], &mut last[axis]);
                }
            }
        }
        node.children.push(range("PointRange", ends, dimensions));
        node.children.push(range("PointRangeDonor", donor_ends, dimensions));
        let transform = Hdf5Array::integers(vec![dimensions], &transform[..dimensions]);
        node.children.push(CgnsNode::new("Transform", "\"int[IndexDimension]\"", Some(transform)));
        node.children.extend(periodic.as_ref().map(movement));
        group.children.push(node);
    }
    (!group.children.is_empty()).then_some(group)
}

/// Position of the donor relative to the zone's own side (SIDS 8.5).
fn movement((centre, angles, translation): &PeriodicJoint) -> CgnsNode {
    let mut periodic = CgnsNode::new("Periodic", "Periodic_t", None);
    let parts =
        [("RotationCenter", centre), ("RotationAngle", angles), ("Translation", translation)];
    for (name, values) in parts {
        let values = Hdf5Array::singles(&values.map(|x| x as f32 + 0.0));
        periodic.children.push(CgnsNode::new(name, "DataArray_t", Some(values)));
    }
    let mut property =
        CgnsNode::new("GridConnectivityProperty", "GridConnectivityProperty_t", None);
    property.children.push(periodic);
    property
}

fn boundaries(zone: &CgnsZone<'_>, families: &[String], dimensions: usize) -> Option<CgnsNode> {
    let mut group = CgnsNode::new("ZoneBC", "ZoneBC_t", None);
    for boundary in &zone.boundaries {
        let (condition, family) = match boundary.condition {
            CgnsCondition::Type(condition) => (condition, None),
            CgnsCondition::Family(of) => ("FamilySpecified", Some(&families[of])),
        };
        let mut node = CgnsNode::text(&boundary.name, "BC_t", condition);
        let (_, _, from, to) = boundary.part;
        node.children.push(range("PointRange", [from, to], dimensions));
        let family = family.map(|name| CgnsNode::text("FamilyName", "FamilyName_t", name));
        node.children.extend(family);
        group.children.push(node);
    }
    (!group.children.is_empty()).then_some(group)
}
