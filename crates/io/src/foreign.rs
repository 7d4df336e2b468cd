//! Common parts of the readers of other programs' meshes: points, polygons in named groups,
//! warnings.

use crate::{FilePosition, ReadError};
use moldloft_mesh::{Mesh, PatchInfo, TopologyBuilder};
use moldloft_num::Vec3;

/// A mesh written by another program.
#[derive(Clone, Debug, PartialEq)]
pub struct ForeignMesh {
    /// Points and faces; each run of faces of one group is a patch. Polygons of more than four
    /// corners are triangle fans around their first corner.
    pub mesh: Mesh,
    /// Warnings about omitted or doubtful parts of the file.
    pub remarks: Vec<String>,
}

/// A mesh that is being read.
#[derive(Debug, Default)]
pub(crate) struct MeshInProgress {
    pub points: Vec<Vec3>,
    groups: Vec<(String, Vec<[u32; 4]>)>,
    faces: usize,
    remarks: Vec<String>,
}

impl MeshInProgress {
    /// The faces that follow belong to a group.
    pub fn group(&mut self, name: &str) {
        self.groups.push((name.into(), Vec::new()));
    }

    /// A polygon of three corners or more.
    pub fn polygon(&mut self, corners: &[u32]) {
        if self.groups.is_empty() {
            self.group("default");
        }
        let Some((_, faces)) = self.groups.last_mut() else { return };
        let before = faces.len();
        match *corners {
            [a, b, c, d] => faces.push([a, b, c, d]),
            [first, ref rest @ ..] => {
                faces.extend(rest.windows(2).map(|w| [first, w[0], w[1], w[1]]));
            }
            [] => {}
        }
        self.faces += faces.len() - before;
    }

    /// Says something of the file.
    pub fn remark(&mut self, text: impl Into<String>) {
        self.remarks.push(text.into());
    }

    /// Warns of the number of omitted items, unless 0.
    pub fn left_out(&mut self, count: usize, what: &str) {
        if count > 0 {
            self.remark(format!(
                "{count} {what} {} left out",
                if count == 1 { "is" } else { "are" }
            ));
        }
    }

    /// The mesh; with `weld`, points at equal positions are one.
    pub fn built(
        mut self,
        format: &'static str,
        place: FilePosition,
        weld: bool,
    ) -> Result<ForeignMesh, ReadError> {
        let points = std::mem::take(&mut self.points);
        let groups = std::mem::take(&mut self.groups);
        let build = || {
            let mut builder = TopologyBuilder::new();
            builder.add_vertices(points.len())?;
            for (name, faces) in groups.into_iter().filter(|(_, faces)| !faces.is_empty()) {
                builder.add_faces(PatchInfo::new(name), faces)?;
            }
            let mesh = Mesh::new(builder.build().into(), points)?;
            if weld { mesh.welded() } else { Ok(mesh) }
        };
        let mesh = build().map_err(|e| ReadError::mesh(format, place, e))?;
        self.left_out(
            self.faces - mesh.faces().len(),
            "faces of fewer than three distinct corners",
        );
        Ok(ForeignMesh { mesh, remarks: self.remarks })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{obj, off, ply, stl};

    type Read = fn(&[u8]) -> Result<ForeignMesh, ReadError>;

    const FACET: &str = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const PLY: &str = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";

    /// A binary STL with a number of triangles that differs from its count.
    fn binary(count: u32, triangles: usize, more: usize) -> Vec<u8> {
        let mut bytes = vec![b' '; 80];
        bytes.extend(count.to_le_bytes());
        for k in 0..triangles {
            let x = k as f32;
            let numbers = [0.0, 0.0, 1.0, x, 0.0, 0.0, x + 1.0, 0.0, 0.0, x, 1.0, 0.0];
            bytes.extend(numbers.map(f32::to_le_bytes).concat());
            bytes.extend([0; 2]);
        }
        bytes.extend(vec![7; more]);
        bytes
    }

    /// A binary PLY of one triangle in either order of bytes.
    fn binary_ply(big: bool) -> Vec<u8> {
        let order = if big { "big" } else { "little" };
        let mut bytes = format!(
            "ply\r\nformat binary_{order}_endian 1.0\r\ncomment x\r\n{PLY}property uchar red\nelement face 1\n\
             property list uint8 int32 vertex_index\nproperty list uchar float texcoord\nend_header\r\n"
        )
        .into_bytes();
        let word = |x: [u8; 4]| if big { [x[3], x[2], x[1], x[0]] } else { x };
        for p in [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
            bytes.extend(p.map(|x| word(x.to_le_bytes())).concat());
            bytes.push(200);
        }
        bytes.push(3);
        bytes.extend([0, 1, 2].map(|k: i32| word(k.to_le_bytes())).concat());
        bytes.push(0);
        bytes
    }

    /// Files of other programs, as reported by users, with the number of faces and warnings.
    #[test]
    fn files_of_other_programs_are_read() {
        let head =
            |text: &str| [b"solid x".as_slice(), &binary(2, 2, 0)[7..], text.as_bytes()].concat();
        let ascii = |rest: &str| format!("ply\nformat ascii 1.0\n{PLY}{rest}").into_bytes();
        let body = "0 0 0\n1 0 0\n0 1 0\n";
        let cases: Vec<(&str, Read, Vec<u8>, usize, usize)> = vec![
            ("binary STL that begins with solid", stl::read, head(""), 2, 0),
            ("count left at the greatest", stl::read, binary(u32::MAX, 3, 0), 3, 1),
            ("count left at 0", stl::read, binary(0, 3, 0), 3, 1),
            ("bytes after the last triangle", stl::read, binary(2, 2, 10), 2, 1),
            ("count whose bytes are letters", stl::read, binary(0x0a0d_2020, 1, 0), 0, 0),
            (
                "STL in capitals",
                stl::read,
                format!("SOLID A\n{}ENDSOLID", FACET.to_uppercase()).into(),
                1,
                0,
            ),
            (
                "STL with CR alone",
                stl::read,
                format!("solid a\n{FACET}endsolid").replace('\n', "\r").into(),
                1,
                0,
            ),
            (
                "STL name in Latin-1",
                stl::read,
                [b"solid \xe9\n", FACET.as_bytes(), b"endsolid"].concat(),
                1,
                0,
            ),
            ("STL cut short between facets", stl::read, format!("solid a\n{FACET}").into(), 1, 1),
            (
                "texture number beyond",
                obj::read,
                format!("{TRIANGLE}vt 0 0\nf 1/9 2/9 3/9\n").into(),
                1,
                0,
            ),
            ("continued line", obj::read, format!("{TRIANGLE}f 1 \\\n2 3\n").into(), 1, 0),
            (
                "colours behind coordinates",
                obj::read,
                "v 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nf 1 2 3\n".into(),
                1,
                0,
            ),
            ("vertices behind faces", obj::read, format!("f 1 2 3\n{TRIANGLE}").into(), 1, 0),
            (
                "a heptagon",
                obj::read,
                format!("{TRIANGLE}{TRIANGLE}v 2 2 0\nf 1 2 3 4 5 6 7\n").into(),
                5,
                0,
            ),
            (
                "polylines and surfaces",
                obj::read,
                format!("{TRIANGLE}l 1 2\nsurf 0 1 0 1 1 2 3\nf 1 2 3\n").into(),
                1,
                2,
            ),
            (
                "vertex_index",
                ply::read,
                ascii(&format!(
                    "element face 1\nproperty list uchar int vertex_index\nend_header\n{body}3 0 1 2\n"
                )),
                1,
                0,
            ),
            (
                "int lists",
                ply::read,
                ascii(&format!(
                    "element face 1\nproperty list int int vertex_indices\nend_header\n{body}3 0 1 2"
                )),
                1,
                0,
            ),
            ("points alone", ply::read, ascii(&format!("end_header\n{body}")), 0, 0),
            (
                "strips",
                ply::read,
                ascii(&format!(
                    "element tristrips 1\nproperty list int int vertex_indices\nend_header\n{body}7 0 1 2 -1 2 1 0\n"
                )),
                2,
                0,
            ),
            (
                "edges",
                ply::read,
                ascii(&format!(
                    "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n{body}0 1\n"
                )),
                0,
                1,
            ),
            (
                "comment in two lines",
                ply::read,
                ascii(&format!("Created by X\nend_header\n{body}")),
                0,
                1,
            ),
            (
                "more numbers than properties",
                ply::read,
                ascii(&format!(
                    "element face 1\nproperty list uchar int vertex_indices\nend_header\n{body}3 0 1 2 255 0 0\n"
                )),
                1,
                1,
            ),
            ("little endian", ply::read, binary_ply(false), 1, 0),
            ("big endian", ply::read, binary_ply(true), 1, 0),
            (
                "counts in the line of OFF",
                off::read,
                format!("OFF3 1 0\n{body}3 0 1 2\n").into(),
                1,
                0,
            ),
            (
                "colours in OFF",
                off::read,
                "COFF\n# x\n3 1\n\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n0 1 0 1 0 0 1\n3 0 1 2 255 0 0\n"
                    .into(),
                1,
                0,
            ),
            ("OFF without its name", off::read, format!("3 1 0\n{body}3 0 1 2\n").into(), 1, 0),
        ];
        for (name, read, bytes, faces, remarks) in cases {
            match read(&bytes) {
                Ok(found) => {
                    let counted = (found.mesh.faces().len(), found.remarks.len());
                    assert_eq!(counted, (faces, remarks), "{name}: {:?}", found.remarks);
                }
                // Only where there is nothing to read.
                Err(error) => assert_eq!(faces, 0, "{name}: {error}"),
            }
        }
    }

    #[test]
    fn what_is_no_mesh_is_refused_with_its_place() {
        let ascii = |rest: &str| format!("ply\nformat ascii 1.0\n{rest}").into_bytes();
        let faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
        let line = FilePosition::Line;
        let cases: Vec<(Read, Vec<u8>, FilePosition)> = vec![
            (stl::read, b"".to_vec(), FilePosition::Byte(0)),
            (stl::read, binary(9, 2, 0), FilePosition::Byte(80)),
            (stl::read, b"solid a\nfacet\nvertex 0 0\n".to_vec(), line(3)),
            (stl::read, b"solid a\nfacet\nvertex 0 0 nan\n".to_vec(), line(3)),
            (obj::read, format!("{TRIANGLE}f 0 1 2\n").into(), line(4)),
            (obj::read, format!("{TRIANGLE}f 1 2 9\n\n").into(), line(4)),
            (obj::read, format!("{TRIANGLE}f 1 2\n").into(), line(4)),
            (obj::read, format!("{TRIANGLE}f 1 2 -4\n").into(), line(4)),
            (ply::read, b"ply".to_vec(), line(1)),
            (ply::read, b"ply\nformat ascii 1.0\n".to_vec(), line(3)),
            (
                ply::read,
                ascii("element vertex 2147483648\nproperty float x\nend_header\n0\n"),
                line(3),
            ),
            (
                ply::read,
                ascii("element vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n"),
                line(3),
            ),
            (ply::read, ascii("element face 1\nproperty int a\nend_header\n0\n"), line(3)),
            (ply::read, ascii(&format!("{PLY}{faces}3 0 1 3\n")), line(13)),
            (ply::read, ascii(&format!("{PLY}{faces}3 0 1\n")), line(14)),
            (ply::read, ascii(&format!("{PLY}end_header\n0 0 0\n0 nan 0\n1 1 1")), line(9)),
            (ply::read, binary_ply(false)[..binary_ply(false).len() - 30].to_vec(), line(4)),
            (obj::read, b"\xff\xfev\0 \0".to_vec(), FilePosition::Byte(0)),
            (off::read, b"OFF BINARY\n".to_vec(), line(1)),
            (off::read, b"4OFF\n1 0 0\n".to_vec(), line(1)),
            (off::read, b"OFF\n99999999999 1 0\n0 0 0\n".to_vec(), line(3)),
            (off::read, b"OFF\n1 1 0\n0 0 0\n3 0 0 7\n".to_vec(), line(4)),
            (off::read, b"OFF\n1 1 0\n0 0 0\n9 0 0\n".to_vec(), line(4)),
        ];
        for (read, bytes, place) in cases {
            let text = String::from_utf8_lossy(&bytes).into_owned();
            match read(&bytes) {
                Ok(_) => panic!("read: {text}"),
                Err(error) => assert_eq!(error.place, place, "{error}: {text}"),
            }
        }
    }

    /// Numbers that are the same in every run (Marsaglia 2003, Xorshift RNGs).
    struct Chance(u64);

    impl Chance {
        fn below(&mut self, count: usize) -> usize {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 % count.max(1) as u64) as usize
        }
    }

    const SCRAPS: [&str; 14] = [
        "0",
        "-1",
        "1e309",
        "nan",
        "4294967295",
        "99999999999999999999",
        "\n",
        "\r",
        " ",
        "\\\n",
        "list",
        "vertex",
        "f 1 2 3",
        "\u{feff}",
    ];

    /// A copy with some parts changed, doubled or removed, or with a scrap inserted.
    fn damaged(seed: &[u8], chance: &mut Chance) -> Vec<u8> {
        let mut bytes = seed.to_vec();
        for _ in 0..=chance.below(4) {
            let at = chance.below(bytes.len());
            let end = (at + chance.below(12)).min(bytes.len());
            match chance.below(5) {
                0 => bytes.truncate(at),
                1 => drop(bytes.splice(at..end, [])),
                2 => drop(bytes.splice(at..at, SCRAPS[chance.below(SCRAPS.len())].bytes())),
                3 => {
                    drop(bytes.splice(at..at, seed[at.min(seed.len())..].iter().copied().take(20)))
                }
                _ => bytes.iter_mut().skip(at).take(1).for_each(|b| *b = chance.below(256) as u8),
            }
        }
        bytes
    }

    #[test]
    fn damaged_files_have_an_answer() {
        let seeds: Vec<(Read, Vec<u8>)> = vec![
            (stl::read, binary(3, 3, 0)),
            (stl::read, format!("solid a\n{FACET}{FACET}endsolid a\n").into()),
            (obj::read, format!("o x\n{TRIANGLE}f 1/1 2/2/2 3//3\nf -1 -2 -3\nl 1 2\n").into()),
            (ply::read, binary_ply(false)),
            (ply::read, binary_ply(true)),
            (ply::read, format!("ply\nformat ascii 1.0\n{PLY}element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n4 0 1 2 0\n").into()),
            (off::read, "COFF # x\n3 2 0\n0 0 0 1\n1 0 0\n0 1 0\n3 0 1 2 9\n4 0 1 2 0\n".into()),
        ];
        let rounds = if std::env::var("MOLDLOFT_SOAK").is_ok() { 500_000 } else { 2_000 };
        let mut chance = Chance(0x9e37_79b9_7f4a_7c15);
        let (mut read, mut refused) = (0u32, 0u32);
        for _ in 0..rounds {
            for (reader, seed) in &seeds {
                let bytes = damaged(seed, &mut chance);
                match reader(&bytes) {
                    Ok(found) => {
                        read += 1;
                        let points = found.mesh.positions();
                        assert!(points.iter().all(|p| p.is_finite()), "{bytes:?}");
                        let mut corners = found.mesh.faces().iter().flatten();
                        assert!(corners.all(|&v| (v as usize) < points.len()), "{bytes:?}");
                        // No more than a file of this size can say.
                        assert!(
                            points.len() <= bytes.len() && found.mesh.faces().len() <= bytes.len()
                        );
                    }
                    Err(error) => {
                        refused += 1;
                        let said = error.to_string();
                        assert!(said.len() < 300 && !said.contains('\u{1b}'), "{said}");
                    }
                }
            }
        }
        assert!(read > rounds / 10 && refused > rounds / 10, "{read} {refused}");
    }

    #[test]
    fn what_is_written_comes_back() {
        let mesh = crate::fixtures::two_patches();
        let back = off::read(&off::write(&mesh).unwrap()).unwrap();
        assert_eq!(back.mesh.faces().len(), mesh.faces().len());
        let back = ply::read(&ply::write(&mesh).unwrap()).unwrap();
        let area = |mesh: &Mesh| moldloft_mesh::measure(mesh).area;
        assert!((area(&back.mesh) - area(&mesh.triangulated())).abs() < 1e-12);
    }
}
