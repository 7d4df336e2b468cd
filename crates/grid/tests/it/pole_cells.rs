//! Cells with edges or faces without length: the remaining cell has the volume, and outward faces.

use moldloft_grid::{HEX_FACES, PoleCell};
use moldloft_num::Vec3;

/// Six times the volume of a tetrahedron.
fn six([a, b, c, d]: [Vec3; 4]) -> f64 {
    (b - a).cross(c - a).dot(d - a)
}

/// The volume by tetrahedra to the centre, faces outward and cut into triangles at their centres.
fn volume(points: &[Vec3], faces: &[Vec<usize>]) -> f64 {
    let mut sum = 0.0;
    for face in faces {
        let middle = face.iter().fold(Vec3::zero(), |s, &n| s + points[n]) / face.len() as f64;
        for k in 0..face.len() {
            let (a, b) = (points[face[k]], points[face[(k + 1) % face.len()]]);
            sum += six([Vec3::zero(), a, b, middle]) / 6.0;
        }
    }
    sum
}

/// The faces of a cell, outward, by VTK's rules.
fn faces(cell: PoleCell) -> Vec<Vec<usize>> {
    match cell {
        PoleCell::Hexahedron(n) => {
            HEX_FACES.iter().map(|face| face.iter().map(|&c| n[c]).collect()).collect()
        }
        PoleCell::Wedge([a, b, c, d, e, f]) => {
            vec![vec![a, b, c], vec![d, f, e], vec![a, d, e, b], vec![b, e, f, c], vec![c, f, d, a]]
        }
        PoleCell::Pyramid([a, b, c, d, e]) => {
            vec![vec![d, c, b, a], vec![a, b, e], vec![b, c, e], vec![c, d, e], vec![d, a, e]]
        }
        PoleCell::Tetrahedron([a, b, c, d]) => {
            vec![vec![c, b, a], vec![a, b, d], vec![b, c, d], vec![c, a, d]]
        }
    }
}

/// Each edge, each face, and faces with edges of a cube collapsed: the remaining cell has the
/// volume of the collapsed hexahedron, and outward faces.
#[test]
fn what_is_left_of_a_cube_has_its_volume() {
    let cube: Vec<Vec3> = [
        [0.0, 0.0, 0.0],
        [1.0, 0.1, 0.0],
        [1.2, 1.0, 0.0],
        [0.0, 1.0, 0.1],
        [0.0, 0.1, 1.0],
        [1.0, 0.0, 1.1],
        [1.1, 1.0, 1.0],
        [0.1, 1.0, 1.0],
    ]
    .map(Vec3::from)
    .to_vec();
    let mut kinds = [0; 4];
    for face in HEX_FACES {
        for turn in 0..4 {
            let at = |k: usize| face[(turn + k) % 4];
            let other = HEX_FACES.iter().find(|f| f.iter().all(|c| !face.contains(c))).unwrap();
            let drawn: [Vec<[usize; 2]>; 4] = [
                vec![],
                // Two opposite edges of the face: a wedge.
                vec![[at(0), at(1)], [at(3), at(2)]],
                // The whole face: a pyramid.
                vec![[at(0), at(1)], [at(0), at(2)], [at(0), at(3)]],
                // And an edge of the opposite one: a tetrahedron.
                vec![
                    [at(0), at(1)],
                    [at(0), at(2)],
                    [at(0), at(3)],
                    [other[turn], other[(turn + 1) % 4]],
                ],
            ];
            for (kind, pairs) in drawn.iter().enumerate() {
                let mut cell = [0, 1, 2, 3, 4, 5, 6, 7];
                for [to, from] in pairs {
                    cell[*from] = cell[*to];
                }
                let found = PoleCell::of(cell).unwrap();
                kinds[kind] += 1;
                let is = match found {
                    PoleCell::Hexahedron(_) => 0,
                    PoleCell::Wedge(_) => 1,
                    PoleCell::Pyramid(_) => 2,
                    PoleCell::Tetrahedron(_) => 3,
                };
                assert_eq!(is, kind, "{cell:?}");
                let whole: Vec<Vec<usize>> = HEX_FACES
                    .iter()
                    .map(|face| {
                        let mut around: Vec<usize> = face.iter().map(|&c| cell[c]).collect();
                        around.dedup();
                        if around.first() == around.last() {
                            around.pop();
                        }
                        around
                    })
                    .filter(|around| around.len() > 2)
                    .collect();
                let (a, b) = (volume(&cube, &faces(found)), volume(&cube, &whole));
                assert!(a > 0.1 && (a - b).abs() < 1e-12, "{found:?} {a} {b}");
            }
        }
    }
    assert_eq!(kinds, [24; 4]);
    assert_eq!(PoleCell::of([0, 0, 2, 3, 4, 5, 6, 7]), None);
}
