//! Common parts of panel codes: the skin, on one side of its symmetry planes, and its vertices
//! numbered consecutively from 1.

use crate::error::check_positions;
use crate::{WriteError, text};
use moldloft_mesh::{Mesh, Tag, is_triangle};

/// Distance of vertices from the plane of symmetry or the water, relative to the size, within which
/// they are in it.
const SNAP: f64 = 1e-9;

/// Options of a panel code's file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PanelFileOptions {
    /// The mesh is one side of the symmetry plane x = 0.
    pub mirror_x: bool,
    /// The mesh is one side of the symmetry plane y = 0.
    pub mirror_y: bool,
    /// Lids are written among the panels of the skin.
    pub lids: bool,
}

/// The panels to write. Panels keep the order of patches and of the faces in each.
pub(crate) struct SolverPanels {
    /// Positions of the used vertices, in the order of the mesh's numbers.
    pub points: Vec<[f64; 3]>,
    /// Corners as indices of `points`, counter-clockwise seen from the water; a triangle repeats
    /// its last.
    pub faces: Vec<[u32; 4]>,
    /// For each sequence of faces of one patch: its name and their number.
    pub patches: Vec<(String, usize)>,
}

impl SolverPanels {
    /// The skin of a mesh, that is all patches but lids, water and symmetry planes.
    ///
    /// Corners within 1e-9 of the mesh's diagonal from a symmetry plane are moved into it, so that
    /// the halves meet and no sliver is left.
    ///
    /// # Errors
    /// Positions that are not finite; a half that crosses its symmetry plane.
    pub fn of(mesh: &Mesh, options: PanelFileOptions) -> Result<Self, WriteError> {
        check_positions(mesh, f64::MAX)?;
        let mirrors = [options.mirror_x, options.mirror_y];
        let snap = SNAP * mesh.bounds().diagonal();
        let place = |v: u32| {
            let mut p = mesh.positions()[v as usize].to_array();
            for axis in 0..2 {
                if mirrors[axis] && p[axis].abs() <= snap {
                    p[axis] = 0.0;
                }
            }
            p
        };
        let chosen = || {
            let kept = |tag: &Tag| tag.is_skin() || options.lids && *tag == Tag::Lid;
            mesh.patches().iter().filter(move |p| kept(&p.info.tag))
        };
        for axis in (0..2).filter(|&axis| mirrors[axis]) {
            let mut seen = 0.0;
            for patch in chosen() {
                for &v in mesh.faces()[patch.faces.clone()].iter().flatten() {
                    let side = place(v)[axis];
                    if seen * side < 0.0 {
                        let (axis, patch) = (['x', 'y'][axis], patch.info.name.clone());
                        return Err(WriteError::BothSides { axis, patch });
                    }
                    if side != 0.0 {
                        seen = side.signum();
                    }
                }
            }
        }
        let mut used = vec![false; mesh.positions().len()];
        for patch in chosen() {
            let corners = mesh.faces()[patch.faces.clone()].iter().flatten();
            corners.for_each(|&v| used[v as usize] = true);
        }
        let mut number = vec![0u32; used.len()];
        let mut points = Vec::new();
        for v in (0..used.len()).filter(|&v| used[v]) {
            number[v] = points.len() as u32;
            points.push(place(v as u32));
        }
        let (mut faces, mut patches) = (Vec::new(), Vec::new());
        for patch in chosen() {
            let own = &mesh.faces()[patch.faces.clone()];
            faces.extend(own.iter().map(|f| f.map(|v| number[v as usize])));
            patches.push((patch.info.name.clone(), own.len()));
        }
        Ok(Self { points, faces, patches })
    }

    /// The lines of the vertices: `number x y z`, from 1.
    pub fn node_lines(&self, out: &mut String) {
        for (k, p) in (1..).zip(&self.points) {
            let [x, y, z] = p.map(text::real);
            text::append(out, format_args!("{k} {x} {y} {z}\n"));
        }
    }
}

/// The corners of a face with numbers from 1, three of them for a triangle.
pub(crate) fn corners(face: [u32; 4]) -> ([u32; 4], usize) {
    (face.map(|v| v + 1), if is_triangle(face) { 3 } else { 4 })
}

/// A title on one line.
pub(crate) fn title(text: &str) -> String {
    text.replace(|c: char| c.is_control(), " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::two_patches;
    use crate::{aqwa, hams, hydrostar, nemoh};
    use moldloft_num::Vec3;

    fn text(bytes: Result<Vec<u8>, WriteError>) -> String {
        String::from_utf8(bytes.unwrap()).unwrap()
    }

    fn half() -> PanelFileOptions {
        PanelFileOptions { mirror_y: true, ..PanelFileOptions::default() }
    }

    #[test]
    fn each_code_has_its_own_triangles_and_flags() {
        let mesh = two_patches();
        let mar = text(nemoh::write(&mesh, half()));
        assert!(mar.starts_with("2 1\n1 0 0 0\n2 0.1 1 -0.5\n"), "{mar}");
        assert!(mar.contains("\n0 0. 0. 0.\n1 3 4 2\n") && mar.ends_with("\n0 0 0 0\n"), "{mar}");
        assert!(mar.contains("\n5 6 7 7\n") || mar.contains("6 6\n"), "a triangle repeats: {mar}");
        let hst = text(hydrostar::write(&mesh, "a hull", half()));
        assert!(hst.contains("SYMMETRY 1\n") && hst.contains("\n1 1 3 4 2\n"), "{hst}");
        let pnl = text(hams::write(&mesh, half()));
        assert_eq!(pnl.lines().nth(3), Some("    4 8 0 1"), "{pnl}");
        assert!(pnl.contains("\n1 4 1 3 4 2\n") && pnl.contains(" 3 "), "{pnl}");
        let both = PanelFileOptions { mirror_x: true, mirror_y: true, lids: false };
        assert!(text(hydrostar::write(&mesh, "", both)).contains("SYMMETRY 2\n"));
    }

    #[test]
    fn lids_go_where_the_code_wants_them() {
        let mesh = two_patches();
        let lids = text(hams::write_lids(&mesh, half()).map(Option::unwrap));
        assert!(lids.contains("Waterplane") && lids.contains("\n1 3 1 2 3\n"), "{lids}");
        let none = mesh.immersed(-10.0).unwrap();
        assert_eq!(hams::write_lids(&none, half()), Ok(None));
        let with = text(nemoh::write(&mesh, PanelFileOptions { lids: true, ..half() }));
        assert_eq!(with.lines().count(), text(nemoh::write(&mesh, half())).lines().count() + 2);
    }

    #[test]
    fn what_a_code_cannot_say_is_refused_by_name() {
        let mesh = two_patches();
        let x = PanelFileOptions { mirror_x: true, ..PanelFileOptions::default() };
        for error in [nemoh::write(&mesh, x), hydrostar::write(&mesh, "", x)] {
            let error = error.unwrap_err().to_string();
            assert!(error.contains("cannot hold symmetry in x = 0"), "{error}");
        }
        let both = PanelFileOptions { mirror_y: true, ..x };
        let error = hams::write(&mesh, both).unwrap_err().to_string();
        assert!(error.contains("cannot hold symmetry in x = 0 and y = 0"), "{error}");
        let error = aqwa::write(&mesh, "", half()).unwrap_err();
        assert!(matches!(error, WriteError::AboveWater { ref patch, .. } if patch == "aft"));
        let mut p = mesh.positions().to_vec();
        p[1].x = f64::NAN;
        let broken = Mesh::new(mesh.topology().clone(), p).unwrap();
        for error in [
            nemoh::write(&broken, half()),
            hydrostar::write(&broken, "", half()),
            hams::write(&broken, half()),
            aqwa::write(&broken, "", half()),
            crate::ply::write(&broken),
            crate::gltf::write(&broken, "", 1.0, |_, _| [0; 3]),
        ] {
            assert!(matches!(error, Err(WriteError::NotFinite { vertex: 1, .. })), "{error:?}");
        }
    }

    #[test]
    fn aqwa_has_its_columns() {
        let mesh = two_patches();
        let down = mesh.positions().iter().map(|&p| p - Vec3::of(0.0, 0.0, 1.0)).collect();
        let mesh = Mesh::new(mesh.topology().clone(), down).unwrap();
        let dat = text(aqwa::write(&mesh, "a hull", half()));
        assert!(dat.lines().all(|line| line.len() <= 80), "{dat}");
        let node = dat.lines().find(|l| l.starts_with("     1    4")).unwrap();
        assert_eq!(node.as_bytes()[20..].chunks(10).count(), 3);
        let x: Vec<f64> = [20, 30, 40].map(|k| node[k..k + 10].trim().parse().unwrap()).into();
        assert!((x[1] - 1.0 / 3.0).abs() < 1e-7 && x[2] == -1.75, "{node:?}");
        assert!(dat.contains("      SYMX\n") && !dat.contains("SYMY"));
        assert!(dat.contains("     1QPPL DIFF   15(1)(    1)(    3)(    4)(    2)\n"), "{dat}");
        assert!(dat.contains("     1TPPL DIFF   15(1)("), "{dat}");
        let far = mesh.positions().iter().map(|&p| p - Vec3::of(1e10, 0.0, 0.0)).collect();
        let far = Mesh::new(mesh.topology().clone(), far).unwrap();
        assert!(matches!(aqwa::write(&far, "", half()), Err(WriteError::TooWide { .. })));
    }
}
