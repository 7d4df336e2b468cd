//! glTF 2.0 in one binary file (`.glb`): a node, mesh and material per patch, with its name and
//! colour (Khronos 2021, glTF 2.0 specification).
//!
//! glTF has y up and metres, so the root node turns z up into y up and scales by the model's unit;
//! the positions themselves are the model's, in single precision.

use crate::WriteError;
use crate::error::{check_positions, check_single};
use crate::text::{json, put};
use moldloft_mesh::{Mesh, Patch};
use moldloft_num::Vec3;

/// The file. Quads are split along their shorter diagonal; no normals are stored, so viewers shade
/// each facet flat. `colour` gives the sRGB colour of a patch by its index, `metres` the length of the
/// model's unit.
///
/// # Errors
/// Positions that are not finite in single precision; files beyond 4 GB.
pub fn write(
    mesh: &Mesh,
    name: &str,
    metres: f64,
    colour: impl Fn(&Patch, usize) -> [u8; 3],
) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::from(f32::MAX))?;
    let triangles = mesh.triangulated();
    let origin = origin(mesh);
    check_single(mesh, origin, "glTF")?;
    let mut data: Vec<u8> = Vec::new();
    let (mut nodes, mut meshes, mut materials) = (String::new(), String::new(), String::new());
    let (mut accessors, mut views, mut children) = (String::new(), String::new(), String::new());
    let mut shown = 0;
    for (k, patch) in triangles.patches().iter().enumerate().filter(|(_, p)| !p.faces.is_empty()) {
        let faces = &triangles.faces()[patch.faces.clone()];
        let corners = || faces.iter().flat_map(|f| f[..3].iter().copied());
        // A patch has its own vertices, in ascending order of the mesh's numbers.
        let mut own: Vec<u32> = corners().collect();
        own.sort_unstable();
        own.dedup();
        let (mut low, mut high) = ([f32::MAX; 3], [f32::MIN; 3]);
        let start = data.len();
        for &v in &own {
            let p = (mesh.positions()[v as usize] - origin).to_array().map(|x| x as f32 + 0.0);
            for axis in 0..3 {
                low[axis] = low[axis].min(p[axis]);
                high[axis] = high[axis].max(p[axis]);
                data.extend_from_slice(&p[axis].to_le_bytes());
            }
        }
        let middle = data.len();
        for v in corners() {
            // Found, because `own` was made of the same corners.
            let index = own.partition_point(|&o| o < v) as u32;
            data.extend_from_slice(&index.to_le_bytes());
        }
        let comma = if shown == 0 { "" } else { "," };
        let (points, indices) = (2 * shown, 2 * shown + 1);
        put!(
            views,
            "{comma}{{\"buffer\":0,\"byteOffset\":{start},\"byteLength\":{},\"target\":34962}},\
             {{\"buffer\":0,\"byteOffset\":{middle},\"byteLength\":{},\"target\":34963}}",
            middle - start,
            data.len() - middle
        );
        put!(
            accessors,
            "{comma}{{\"bufferView\":{points},\"componentType\":5126,\"count\":{},\"type\":\"VEC3\",\
             \"min\":{},\"max\":{}}},{{\"bufferView\":{indices},\"componentType\":5125,\"count\":{},\
             \"type\":\"SCALAR\"}}",
            own.len(),
            list(low),
            list(high),
            3 * faces.len()
        );
        let word = json(&patch.info.name);
        put!(
            meshes,
            "{comma}{{\"name\":{word},\"primitives\":[{{\"attributes\":{{\"POSITION\":{points}}},\
             \"indices\":{indices},\"material\":{shown}}}]}}"
        );
        let tag = json(patch.info.tag.word());
        put!(
            nodes,
            ",{{\"name\":{word},\"mesh\":{shown},\"extras\":{{\"tag\":{tag},\"kind\":{}}}}}",
            json(&patch.info.kind)
        );
        let linear = colour(patch, k).map(linear);
        put!(
            materials,
            "{comma}{{\"name\":{word},\"doubleSided\":true,\"pbrMetallicRoughness\":{{\
             \"baseColorFactor\":[{},{},{},1],\"metallicFactor\":0.1,\"roughnessFactor\":0.6}}}}",
            linear[0],
            linear[1],
            linear[2]
        );
        put!(children, "{comma}{}", shown + 1);
        shown += 1;
    }
    let root = format!(
        "{{\"name\":{},\"matrix\":[{m},0,0,0,0,0,-{m},0,0,{m},0,0,{},{},{},1]{}}}",
        json(name),
        origin.x * metres + 0.0,
        origin.z * metres + 0.0,
        -origin.y * metres + 0.0,
        // An empty list of children is not allowed.
        if shown == 0 { String::new() } else { format!(",\"children\":[{children}]") },
        m = metres
    );
    let mut text = format!(
        "{{\"asset\":{{\"version\":\"2.0\",\"generator\":\"moldloft\"}},\"scene\":0,\"scenes\":\
         [{{\"nodes\":[0]}}],\"nodes\":[{root}{nodes}]"
    );
    if shown > 0 {
        put!(
            text,
            ",\"meshes\":[{meshes}],\"materials\":[{materials}],\"accessors\":[{accessors}],\
             \"bufferViews\":[{views}],\"buffers\":[{{\"byteLength\":{}}}]",
            data.len()
        );
    }
    text.push('}');
    container(text.into_bytes(), data)
}

/// Origin of the file's coordinates: the model's origin, or a rounded point near the model if it is
/// so far away that single precision would lose digits. The file's root translates everything back.
fn origin(mesh: &Mesh) -> Vec3 {
    let bounds = mesh.bounds();
    let far = bounds.low.to_array().into_iter().chain(bounds.high.to_array());
    let far = far.fold(0.0f64, |m, x| m.max(x.abs()));
    if !(far > FAR * bounds.diagonal()) || !far.is_finite() {
        return Vec3::zero();
    }
    // A multiple of a power of two with at most 24 digits, so that it is a number of single precision.
    let exponent = ((far.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    let step = 2f64.powi(exponent - 23);
    bounds.centre().map(|x| (x / step).round() * step)
}

/// A model this many times its size away from the origin gets an origin of its own.
const FAR: f64 = 16.0;

/// The container: a header of 12 bytes, then the chunks of text and data, each a multiple of four.
fn container(mut text: Vec<u8>, data: Vec<u8>) -> Result<Vec<u8>, WriteError> {
    while !text.len().is_multiple_of(4) {
        text.push(b' ');
    }
    let chunk = |n: usize| if n == 0 { 0 } else { 8 + n };
    let size = 12 + chunk(text.len()) + chunk(data.len());
    let total = u32::try_from(size)
        .map_err(|_| WriteError::TooLarge { what: "bytes of a file", count: size })?;
    let mut out = Vec::with_capacity(size);
    out.extend_from_slice(b"glTF");
    out.extend_from_slice(&2u32.to_le_bytes());
    out.extend_from_slice(&total.to_le_bytes());
    for (kind, bytes) in [(b"JSON", &text), (b"BIN\0", &data)] {
        if !bytes.is_empty() {
            out.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
            out.extend_from_slice(kind);
            out.extend_from_slice(bytes);
        }
    }
    Ok(out)
}

fn list(x: [f32; 3]) -> String {
    // Display of a float is never in exponent form, which JSON would take too.
    format!("[{},{},{}]", x[0], x[1], x[2])
}

/// An 8-bit sRGB channel as linear light, as glTF requires (IEC 61966-2-1), to three digits.
fn linear(channel: u8) -> f64 {
    let c = f64::from(channel) / 255.0;
    let light = if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) };
    libm::round(light * 1000.0) / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_mesh::{PatchInfo, TopologyBuilder};

    /// A twisted square of that side, far from the origin.
    fn square(side: f64) -> Mesh {
        let at = |x: f64, y: f64, z: f64| {
            Vec3::of(6e6 + 0.23 + x * side, 5e6 + 0.11 + y * side, z * side)
        };
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(4).unwrap();
        builder.add_faces(PatchInfo::new("s"), vec![[0, 1, 2, 3]]).unwrap();
        let corners = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(1.0, 1.0, 0.5), at(0.0, 1.0, 0.0)];
        Mesh::new(builder.build().into(), corners.to_vec()).unwrap()
    }

    #[test]
    fn a_model_far_away_keeps_its_shape() {
        let mesh = square(0.1);
        let origin = origin(&mesh);
        assert!(origin.to_array().iter().all(|x| f64::from(*x as f32) == *x), "{origin:?}");
        let near = |p: Vec3| (p - origin).map(|x| f64::from(x as f32));
        let p = mesh.positions();
        for (a, b) in [(0, 1), (1, 2), (2, 3), (3, 0), (0, 2)] {
            let (exact, kept) = (p[a].distance(p[b]), near(p[a]).distance(near(p[b])));
            assert!((kept / exact - 1.0).abs() < 1e-6, "{exact} {kept}");
        }
        assert!(write(&mesh, "far", 1.0, |_, _| [0; 3]).is_ok());
        let small = write(&square(1e-7), "far", 1.0, |_, _| [0; 3]);
        assert!(matches!(small, Err(WriteError::Single { .. })));
    }
}
