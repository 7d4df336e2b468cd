//! Vertices by number, the faces between them and their patches. Positions have no influence:
//! joined vertices share a number.

use crate::MeshError;
use moldloft_num::Vec3;
use std::ops::Range;

/// Role of a patch for a flow solver or a builder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Tag {
    /// Skin of the body, the default.
    #[default]
    Wetted,
    /// A lid inside the body, such as the interior free surface of an irregular-frequency run.
    Lid,
    /// Part of the water surface outside the body.
    Waterline,
    /// Part of a symmetry plane.
    Symmetry,
    /// Any other role, by name; counted as skin.
    Other(String),
}

impl Tag {
    /// The word for the tag in files and tables.
    pub fn word(&self) -> &str {
        match self {
            Self::Wetted => "wetted",
            Self::Lid => "lid",
            Self::Waterline => "waterline",
            Self::Symmetry => "symmetry",
            Self::Other(name) => name,
        }
    }

    /// The role for a word; an unknown word is a role defined by the user.
    pub fn named(word: &str) -> Self {
        match word {
            "wetted" => Self::Wetted,
            "lid" => Self::Lid,
            "waterline" => Self::Waterline,
            "symmetry" => Self::Symmetry,
            other => Self::Other(other.into()),
        }
    }

    /// The role among several words: the first known one, otherwise the first; wetted if there are
    /// no words.
    pub fn among<'w>(words: impl IntoIterator<Item = &'w str>) -> Self {
        let mut own = None;
        for tag in words.into_iter().map(Self::named) {
            match tag {
                Self::Other(_) => own = own.or(Some(tag)),
                role => return role,
            }
        }
        own.unwrap_or_default()
    }

    /// True for patches that bound the body itself: all roles except lids, water and symmetry
    /// planes.
    pub fn is_skin(&self) -> bool {
        matches!(self, Self::Wetted | Self::Other(_))
    }
}

/// Name and role of a patch.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PatchInfo {
    /// Name, unique within a model; ensured by the caller.
    pub name: String,
    /// Role of the patch.
    pub tag: Tag,
    /// Further names given by the user, roles included; may be empty.
    pub tags: Vec<String>,
    /// Colour index 0 to 15 of the sixteen-colour palette of model files, if one was given.
    pub colour: Option<u8>,
    /// The entity kind it came from, such as `CLoftSurf`; empty when unknown.
    pub kind: String,
}

impl PatchInfo {
    /// A wetted patch with a name, without colour.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// The same patch with another role.
    pub fn tagged(self, tag: Tag) -> Self {
        Self { tag, ..self }
    }

    /// True when it has the tag, as its role or as a name given by the user.
    pub fn is(&self, tag: &str) -> bool {
        self.tag.word() == tag || self.tags.iter().any(|t| t == tag)
    }

    /// The same patch with a colour index.
    pub fn coloured(self, colour: Option<u8>) -> Self {
        Self { colour, ..self }
    }

    /// The same patch with an entity kind.
    pub fn of_kind(self, kind: impl Into<String>) -> Self {
        Self { kind: kind.into(), ..self }
    }
}

/// The structured grid of vertices behind a patch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// Vertices along u.
    pub nu: usize,
    /// Vertices along v.
    pub nv: usize,
    /// Vertex (i, j) at `[i * nv + j]`; a pole repeats one vertex.
    pub vertices: Vec<u32>,
    /// True when the panels are reversed, so that their normals are against S_u x S_v.
    pub reversed: bool,
}

impl Block {
    /// The vertex at u index `i`, v index `j`.
    pub fn at(&self, i: usize, j: usize) -> u32 {
        self.vertices[i * self.nv + j]
    }
}

/// A named range of faces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Patch {
    /// Name and role.
    pub info: PatchInfo,
    /// Its faces, as a range of indices into [`Topology::faces`].
    pub faces: Range<usize>,
    /// Its structured grid, when it has one.
    pub block: Option<Block>,
}

/// Numbered vertices, the faces between them, and the patches of the faces.
///
/// Every face has three or four different corners, all of them below [`Topology::vertex_count`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    vertex_count: usize,
    faces: Vec<[u32; 4]>,
    patches: Vec<Patch>,
}

/// The most faces of a mesh, so that 32 bits can name every corner of every face.
const MAX_FACES: usize = 1 << 30;

/// True when the face is a triangle: its last index is repeated.
#[inline(always)]
pub fn is_triangle(face: [u32; 4]) -> bool {
    face[2] == face[3]
}

impl Topology {
    /// Number of vertices, including unused ones.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Corners of each face, counter-clockwise seen from outside; a triangle repeats its last index.
    pub fn faces(&self) -> &[[u32; 4]] {
        &self.faces
    }

    /// The patches in the order in which they were added, with consecutive faces.
    pub fn patches(&self) -> &[Patch] {
        &self.patches
    }

    /// Position of a face in its patch: (i, j) of its corner of lowest u and v, if the patch has a
    /// block.
    pub fn place_of(&self, face: usize) -> Option<[usize; 2]> {
        let patch = self.patches.get(self.patch_of(face))?;
        let block = patch.block.as_ref()?;
        let at = face - patch.faces.start;
        let (nu, nv) = (block.nu - 1, block.nv - 1);
        if patch.faces.len() == nu * nv {
            return Some([at / nv, at % nv]);
        }
        // Some panels of the grid have no area and are no faces.
        let quads = (0..nu).flat_map(|i| (0..nv).map(move |j| [i, j]));
        let faces = quads.filter(|&[i, j]| {
            let corners =
                [block.at(i, j), block.at(i + 1, j), block.at(i + 1, j + 1), block.at(i, j + 1)];
            simplified(corners).is_some()
        });
        (patch.faces.len() < nu * nv).then(|| faces.into_iter().nth(at)).flatten()
    }

    /// Index of the patch that owns a face.
    pub fn patch_of(&self, face: usize) -> usize {
        self.patches.partition_point(|p| p.faces.end <= face)
    }

    /// The same patches with every quad split into two triangles along its shorter diagonal (from
    /// the first corner if both are equal). `positions` are real parts, one per vertex.
    pub fn triangulated(&self, positions: &[Vec3]) -> Self {
        let mut faces = Vec::with_capacity(self.faces.len() * 2);
        let mut patches = Vec::with_capacity(self.patches.len());
        for patch in &self.patches {
            let start = faces.len();
            for &[a, b, c, d] in &self.faces[patch.faces.clone()] {
                if c == d {
                    faces.push([a, b, c, d]);
                    continue;
                }
                let length_sq =
                    |p: u32, q: u32| (positions[p as usize] - positions[q as usize]).norm_sq();
                if length_sq(a, c) <= length_sq(b, d) {
                    faces.extend([[a, b, c, c], [a, c, d, d]]);
                } else {
                    faces.extend([[a, b, d, d], [b, c, d, d]]);
                }
            }
            patches.push(Patch { faces: start..faces.len(), ..patch.clone() });
        }
        Self { vertex_count: self.vertex_count, faces, patches }
    }
}

/// Builds a [`Topology`] patch by patch.
#[derive(Clone, Debug, Default)]
pub struct TopologyBuilder {
    topology: Topology,
}

impl TopologyBuilder {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Continues from an existing topology.
    pub fn extending(topology: Topology) -> Self {
        Self { topology }
    }

    /// Adds `count` vertices and returns their indices.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] beyond 32-bit numbers.
    pub fn add_vertices(&mut self, count: usize) -> Result<Range<u32>, MeshError> {
        let total = self.topology.vertex_count.saturating_add(count);
        let end = u32::try_from(total).map_err(|_| MeshError::TooLarge { count: total })?;
        let start = self.topology.vertex_count as u32;
        self.topology.vertex_count = total;
        Ok(start..end)
    }

    /// Adds a structured patch of `nu` by `nv` vertices, with (i, j) at `[i * nv + j]`. The normals
    /// of its panels are along S_u x S_v, or against it when `reversed`. Panels with a repeated
    /// corner become triangles; those without area by identity are omitted.
    ///
    /// # Errors
    /// A wrong shape or an unknown vertex.
    pub fn add_block(
        &mut self,
        info: PatchInfo,
        nu: usize,
        nv: usize,
        vertices: Vec<u32>,
        reversed: bool,
    ) -> Result<(), MeshError> {
        if nu < 2 || nv < 2 || nu.checked_mul(nv) != Some(vertices.len()) {
            let actual = vertices.len();
            return Err(MeshError::BlockShape { patch: info.name, shape: [nu, nv], actual });
        }
        let block = Block { nu, nv, vertices, reversed };
        let quads = (0..nu - 1).flat_map(|i| (0..nv - 1).map(move |j| (i, j))).map(|(i, j)| {
            let [a, b, c, d] =
                [block.at(i, j), block.at(i + 1, j), block.at(i + 1, j + 1), block.at(i, j + 1)];
            if reversed { [a, d, c, b] } else { [a, b, c, d] }
        });
        self.push(info, quads)?;
        if let Some(last) = self.topology.patches.last_mut() {
            last.block = Some(block);
        }
        Ok(())
    }

    /// Adds an unstructured patch. Corners are counter-clockwise seen from outside; a triangle
    /// repeats a corner. Faces without area by identity are omitted.
    ///
    /// # Errors
    /// An unknown vertex.
    pub fn add_faces(
        &mut self,
        info: PatchInfo,
        faces: impl IntoIterator<Item = [u32; 4]>,
    ) -> Result<(), MeshError> {
        self.push(info, faces.into_iter())
    }

    /// As [`Self::add_faces`], for faces made from a block that is kept beside them.
    pub(crate) fn add_faces_of(
        &mut self,
        info: PatchInfo,
        faces: impl Iterator<Item = [u32; 4]>,
        block: Option<Block>,
    ) -> Result<(), MeshError> {
        self.push(info, faces)?;
        if let Some(last) = self.topology.patches.last_mut() {
            last.block = block;
        }
        Ok(())
    }

    fn push(
        &mut self,
        info: PatchInfo,
        faces: impl Iterator<Item = [u32; 4]>,
    ) -> Result<(), MeshError> {
        let Topology { vertex_count: count, faces: all, patches } = &mut self.topology;
        let start = all.len();
        for face in faces {
            if let Some(&vertex) = face.iter().find(|&&v| v as usize >= *count) {
                all.truncate(start);
                return Err(MeshError::UnknownVertex { patch: info.name, vertex, count: *count });
            }
            all.extend(simplified(face));
        }
        if all.len() > MAX_FACES {
            let count = all.len();
            all.truncate(start);
            return Err(MeshError::TooLarge { count });
        }
        patches.push(Patch { info, faces: start..all.len(), block: None });
        Ok(())
    }

    /// The finished topology.
    pub fn build(self) -> Topology {
        self.topology
    }
}

/// The face with repeated corners removed, triangles ending in a repeated index; `None` when fewer
/// than three corners remain or opposite corners coincide.
fn simplified(face: [u32; 4]) -> Option<[u32; 4]> {
    let [a, b, c, d] = face;
    if a == c || b == d {
        // A quad folded on itself has no area; a triangle may repeat any *neighbouring* corner.
        return None;
    }
    match (a == b, b == c, c == d, d == a) {
        (false, false, false, false) => Some(face),
        (true, false, false, false) => Some([b, c, d, d]),
        (false, true, false, false) => Some([a, c, d, d]),
        (false, false, true, false) => Some(face),
        (false, false, false, true) => Some([a, b, c, c]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_become_triangles_and_folded_faces_vanish() {
        assert_eq!(simplified([1, 2, 3, 4]), Some([1, 2, 3, 4]));
        assert_eq!(simplified([1, 1, 3, 4]), Some([1, 3, 4, 4]));
        assert_eq!(simplified([1, 2, 2, 4]), Some([1, 2, 4, 4]));
        assert_eq!(simplified([1, 2, 3, 3]), Some([1, 2, 3, 3]));
        assert_eq!(simplified([1, 2, 3, 1]), Some([1, 2, 3, 3]));
        assert_eq!(simplified([1, 2, 1, 4]), None);
        assert_eq!(simplified([1, 1, 3, 3]), None);
        assert_eq!(simplified([1, 1, 1, 4]), None);
    }

    #[test]
    fn blocks_are_checked() {
        let mut b = TopologyBuilder::new();
        b.add_vertices(4).unwrap();
        let shape = b.add_block(PatchInfo::new("a"), 2, 3, vec![0, 1, 2, 3], false);
        assert!(matches!(shape, Err(MeshError::BlockShape { actual: 4, .. })));
        let shape = b.add_block(PatchInfo::new("a"), 1, 4, vec![0, 1, 2, 3], false);
        assert!(matches!(shape, Err(MeshError::BlockShape { .. })));
        let unknown = b.add_faces(PatchInfo::new("a"), [[0, 1, 2, 3], [0, 1, 2, 4]]);
        assert!(matches!(unknown, Err(MeshError::UnknownVertex { vertex: 4, count: 4, .. })));
        assert!(b.add_vertices(usize::MAX).is_err());
        let t = b.build();
        assert!(t.faces().is_empty() && t.patches().is_empty());
    }

    #[test]
    fn quads_split_along_the_shorter_diagonal() {
        let mut b = TopologyBuilder::new();
        b.add_vertices(4).unwrap();
        b.add_faces(PatchInfo::new("kite"), [[0, 1, 2, 3]]).unwrap();
        let kite = [
            Vec3::of(0.0, 0.0, 0.0),
            Vec3::of(1.0, 0.4, 0.0),
            Vec3::of(2.0, 0.0, 0.0),
            Vec3::of(1.0, -0.4, 0.0),
        ];
        let t = b.build().triangulated(&kite);
        assert_eq!(t.faces(), [[0, 1, 3, 3], [1, 2, 3, 3]]);
        assert_eq!(t.patches()[0].faces, 0..2);
    }

    #[test]
    fn the_owner_of_a_face_skips_empty_patches() {
        let mut b = TopologyBuilder::new();
        b.add_vertices(3).unwrap();
        b.add_faces(PatchInfo::new("none"), []).unwrap();
        b.add_faces(PatchInfo::new("one"), [[0, 1, 2, 2]]).unwrap();
        assert_eq!(b.build().patch_of(0), 1);
    }
}
