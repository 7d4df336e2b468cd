//! 3MF: triangles with names and colours, for printers and slicers.
//!
//! A zip archive of one XML model ("3D Manufacturing Format, Core Specification" 1.3, 3MF Consortium);
//! its parts are compressed by deflate ("APPNOTE.TXT", PKWARE, 4.3; RFC 1951).

use crate::WriteError;
use crate::error::check_positions;
use crate::text::{put, real, xml};
use moldloft_mesh::{Mesh, Patch};

/// The file. Quads are split along their shorter diagonal. Each triangle has the colour and the name of its
/// patch as its material. A mesh that is not closed is an object of type "surface".
///
/// `unit` is the length unit's name by the specification: micron, millimeter, centimeter, inch, foot, meter.
///
/// # Errors
/// Positions that are not finite.
pub fn write(
    mesh: &Mesh,
    name: &str,
    unit: &str,
    colour: impl Fn(&Patch, usize) -> [u8; 3],
) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let closed = mesh.report().closed;
    let mesh = mesh.triangulated();
    let mut used = vec![false; mesh.positions().len()];
    mesh.faces().iter().flatten().for_each(|&v| used[v as usize] = true);
    let mut number = vec![0u32; used.len()];
    let mut next = 0;
    let mut out = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"{unit}\" xml:lang=\"en-US\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<resources>\n\
         <basematerials id=\"1\">\n"
    );
    for (k, patch) in mesh.patches().iter().enumerate() {
        let [r, g, b] = colour(patch, k);
        let name = xml(&patch.info.name);
        put!(out, "<base name=\"{name}\" displaycolor=\"#{r:02X}{g:02X}{b:02X}\"/>\n");
    }
    let kind = if closed { "model" } else { "surface" };
    put!(
        out,
        "</basematerials>\n<object id=\"2\" type=\"{kind}\" name=\"{}\" pid=\"1\" pindex=\"0\">\n<mesh>\n<vertices>\n",
        xml(name)
    );
    for (v, p) in mesh.positions().iter().enumerate().filter(|&(v, _)| used[v]) {
        number[v] = next;
        next += 1;
        let [x, y, z] = p.to_array().map(real);
        put!(out, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>\n");
    }
    out.push_str("</vertices>\n<triangles>\n");
    for (k, patch) in mesh.patches().iter().enumerate() {
        for face in &mesh.faces()[patch.faces.clone()] {
            let [a, b, c, _] = face.map(|v| number[v as usize]);
            // Triangles of two equal corners are forbidden.
            if a != b && b != c && c != a {
                put!(out, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\" pid=\"1\" p1=\"{k}\"/>\n");
            }
        }
    }
    out.push_str(
        "</triangles>\n</mesh>\n</object>\n</resources>\n<build>\n<item objectid=\"2\"/>\n</build>\n</model>\n",
    );
    let types = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Types \
        xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\"><Default Extension=\"rels\" \
        ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/><Default Extension=\"model\" \
        ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
    let relations = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Relationships \
        xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship \
        Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
        Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";
    archive(&[
        ("[Content_Types].xml", types.as_bytes()),
        ("_rels/.rels", relations.as_bytes()),
        ("3D/3dmodel.model", out.as_bytes()),
    ])
}

/// The table of CRC-32 (ISO 3309, reflected polynomial 0xEDB88320).
fn crc_table() -> [u32; 256] {
    std::array::from_fn(|k| {
        (0..8).fold(k as u32, |c, _| if c & 1 == 1 { 0xEDB8_8320 ^ c >> 1 } else { c >> 1 })
    })
}

fn crc(table: &[u32; 256], bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |c, b| table[((c ^ u32::from(*b)) & 255) as usize] ^ c >> 8)
}

/// Level of compression, 0 to 10: about an eighth of the size in little time.
const LEVEL: u8 = 6;

/// A zip archive of compressed files. Its date is the first of 1980, so that equal models give equal bytes.
fn archive(files: &[(&str, &[u8])]) -> Result<Vec<u8>, WriteError> {
    let table = crc_table();
    let (mut out, mut directory) = (Vec::new(), Vec::new());
    let too_large = |count: usize| WriteError::TooLarge { what: "bytes", count };
    let size_of = |n: usize| u32::try_from(n).map_err(|_| too_large(n));
    for (name, bytes) in files {
        let offset = size_of(out.len())?;
        let packed = miniz_oxide::deflate::compress_to_vec(bytes, LEVEL);
        // Version 2.0, no flags, deflate, time and date, checksum, both sizes, length of the name, no extras.
        let mut common = Vec::new();
        for x in [20u16, 0, 8, 0, 0x21] {
            common.extend_from_slice(&x.to_le_bytes());
        }
        for x in [crc(&table, bytes), size_of(packed.len())?, size_of(bytes.len())?] {
            common.extend_from_slice(&x.to_le_bytes());
        }
        for x in [name.len() as u16, 0] {
            common.extend_from_slice(&x.to_le_bytes());
        }
        out.extend_from_slice(b"PK\x03\x04");
        out.extend_from_slice(&common);
        out.extend_from_slice(name.as_bytes());
        out.extend_from_slice(&packed);
        directory.extend_from_slice(b"PK\x01\x02\x14\x00");
        directory.extend_from_slice(&common);
        // No comment, first disk, plain attributes.
        directory.extend_from_slice(&[0; 10]);
        directory.extend_from_slice(&offset.to_le_bytes());
        directory.extend_from_slice(name.as_bytes());
    }
    let (begin, length) = (size_of(out.len())?, size_of(directory.len())?);
    out.append(&mut directory);
    out.extend_from_slice(b"PK\x05\x06\x00\x00\x00\x00");
    for x in [files.len() as u16; 2] {
        out.extend_from_slice(&x.to_le_bytes());
    }
    for x in [length, begin] {
        out.extend_from_slice(&x.to_le_bytes());
    }
    out.extend_from_slice(&[0, 0]);
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::two_patches;

    #[test]
    fn the_checksum_is_the_known_one() {
        // The check value of CRC-32: that of the digits 1 to 9.
        assert_eq!(crc(&crc_table(), b"123456789"), 0xCBF4_3926);
    }

    /// The model, which is the last file of the archive.
    fn last_part(bytes: &[u8]) -> String {
        let at = bytes.windows(4).rposition(|w| w == b"PK\x03\x04").unwrap();
        let number = |k: usize| u32::from_le_bytes(bytes[at + k..at + k + 4].try_into().unwrap());
        let begin = at + 30 + usize::from(bytes[at + 26]);
        let packed = &bytes[begin..begin + number(18) as usize];
        let whole = miniz_oxide::inflate::decompress_to_vec(packed).unwrap();
        assert_eq!(whole.len(), number(22) as usize);
        assert_eq!(crc(&crc_table(), &whole), number(14));
        assert!(packed.len() < whole.len() / 2);
        String::from_utf8(whole).unwrap()
    }

    #[test]
    fn patches_are_materials() {
        let bytes =
            write(&two_patches(), "hull & keel", "meter", |_, k| [k as u8, 0, 255]).unwrap();
        let text = last_part(&bytes);
        assert!(bytes.starts_with(b"PK\x03\x04") && text.contains("unit=\"meter\""));
        assert!(text.contains("name=\"hull &amp; keel\"") && text.contains("type=\"surface\""));
        assert!(text.contains("<base name=\"aft\" displaycolor=\"#0100FF\"/>"));
        assert!(text.contains("p1=\"2\""));
    }
}
