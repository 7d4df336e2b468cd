//! Volume grids: joined meshes, the figures of checkMesh, elliptic smoothing.

use crate::walls::geometric;
use moldloft_budget::{Budget, Spent};
use moldloft_grid::*;
use moldloft_num::Vec3;
use std::f64::consts::PI;

fn cubes(count: usize, move_to: &[([usize; 3], [f64; 3])]) -> HexMesh {
    let mut grid = VolumeGrid::<f64>::from_fn([count + 1, 2, 2], |i, j, k| {
        Vec3::of(i as f64, j as f64, k as f64)
    });
    for ([i, j, k], p) in move_to {
        grid.set(*i, *j, *k, Vec3::from(*p));
    }
    HexMesh::of_blocks(&[grid], &[])
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 2e-9 * (1.0 + b.abs()), "{a} against {b}");
}

/// OpenFOAM's checkMesh (version 1912) on the same cells.
#[test]
fn figures_of_check_mesh() {
    let check = cubes(1, &[]).check();
    near(check.skewness, 0.0);
    near(check.aspect, 1.0);
    near(check.jacobian.0, 1.0);
    let top: Vec<_> = [(0, 0), (1, 0), (0, 1), (1, 1)]
        .map(|(i, j)| ([i, j, 1], [i as f64 + 1.0, j as f64, 1.0]))
        .to_vec();
    let sheared = cubes(1, &top).check();
    near(sheared.skewness, 1.0);
    near(sheared.aspect, 2.0);
    near(sheared.jacobian.0, 0.5f64.sqrt());
    let long: Vec<_> = [(0, 0), (1, 0), (0, 1), (1, 1)]
        .map(|(j, k)| ([2, j, k], [5.0, j as f64, k as f64]))
        .to_vec();
    let check = cubes(2, &long).check();
    near(check.aspect, 4.0);
    near(check.weight, 0.2);
    near(check.volume_ratio, 0.25);
    let moved: Vec<_> = [(0, 0), (1, 0), (0, 1), (1, 1)]
        .map(|(j, k)| ([2, j, k], [2.0, j as f64 + 1.0, k as f64]))
        .to_vec();
    let check = cubes(2, &moved).check();
    near(check.non_orthogonality[0], 26.565_051_177_077_99);
    near(check.skewness, 1.0);
    near(check.aspect, 2.0);
    near(check.weight, 0.5);
    let leaning = [([1, 1, 0], [1.5, 1.0, 0.0]), ([1, 1, 1], [1.5, 1.0, 1.0])];
    let check = cubes(2, &leaning).check();
    assert!((check.non_orthogonality[0] - 21.370_622_27).abs() < 1e-8);
    assert!((check.skewness - 0.555_555_556).abs() < 1e-9);
    near(check.aspect, 1.5);
    assert!((check.weight - 0.380_434_783).abs() < 1e-9);
    near(check.volume_ratio, 0.6);
    assert!((check.jacobian.0 - 0.894_427).abs() < 1e-6);
    let check = cubes(2, &[([1, 1, 1], [1.4, 1.4, 1.4])]).check();
    assert!((check.non_orthogonality[0] - 8.694_979_802).abs() < 1e-8);
    assert!((check.skewness - 0.173_341_211).abs() < 1e-9);
    assert!((check.aspect - 1.188_686_194).abs() < 1e-9);
    assert!((check.weight - 0.460_837_918).abs() < 1e-9);
    assert!((check.volume_ratio - 0.846_153_846).abs() < 1e-9);
    // As accepted by checkMesh: an inverted corner.
    let check = cubes(1, &[([1, 1, 1], [0.4, 0.4, 0.4])]).check();
    assert!((check.skewness - 0.864_073_045).abs() < 1e-9);
    assert!((check.aspect - 1.489_675_038).abs() < 1e-9);
    assert!((check.jacobian.0 + 0.969_094).abs() < 1e-6);
    assert!(check.pyramid > 0.0 && (check.volume[0] - 0.55).abs() < 1e-12);
}

/// Two blocks in a row and a left-handed one: nodes are shared, patches named, normals outward.
#[test]
fn blocks_join_where_they_coincide() {
    let unit = |x: f64, flip: bool| {
        VolumeGrid::<f64>::from_fn([3, 4, 5], |i, j, k| {
            let i = if flip { 2 - i } else { i };
            Vec3::of(x + i as f64 * 0.5, j as f64 / 3.0, k as f64 / 4.0)
        })
    };
    let wall = Some(("wall".to_string(), "wall".to_string()));
    let mut names: FaceNames = Default::default();
    names[4] = wall.clone();
    let mesh = HexMesh::of_blocks(&[unit(0.0, false), unit(1.0, true)], &[names.clone(), names]);
    assert_eq!(mesh.points.len(), 5 * 4 * 5);
    assert_eq!(mesh.cells.len(), 2 * 2 * 3 * 4);
    let faces = |name: &str| mesh.patches.iter().find(|p| p.name == name).unwrap().faces.len();
    assert_eq!((faces("wall"), faces("defaultFaces")), (12, 12 + 24 + 32));
    let check = mesh.check();
    assert!((check.volume[0] - 1.0 / 24.0).abs() < 1e-12 && check.skewness < 1e-12);
    assert_eq!(check.counts[2], 80);
    // The divergence theorem over the boundary: twice three times the volume 2.
    let mut sum = 0.0;
    for quad in mesh.patches.iter().flat_map(|p| &p.faces) {
        let [a, b, c, d] = quad.map(|id| mesh.points[id]);
        let area = (c - a).cross(d - b) * 0.5;
        sum += area.dot((a + b + c + d) * 0.25);
    }
    assert!((sum - 6.0).abs() < 1e-12, "{sum}");
}

/// A bump in a cube: without walls the first cells and angles are far off, with them exact.
#[test]
fn volume_walls_are_met() {
    let (n, s) = (13, 0.02);
    let v = geometric(1.0, s, n);
    let start = VolumeGrid::<f64>::from_fn([n, n, n], |i, j, k| {
        let (x, y) = (i as f64 / (n - 1) as f64, j as f64 / (n - 1) as f64);
        let low = 0.15 * (PI * x).sin() * (PI * y).sin();
        Vec3::of(x, y, low + (1.0 - low) * v[k])
    });
    let wall = FaceWall { face: GridFace { axis: 2, last: false }, spacing: s };
    let mut options = EllipticVolume {
        keep_spacing: true,
        sweeps: 1500,
        tolerance: 1e-9,
        omega: 1.0,
        walls: vec![wall],
    };
    let free = Budget::default();
    let done = elliptic_volume_until(&start, &options, &free).unwrap();
    println!("{} sweeps, {:?}, {}", done.sweeps, done.walls, done.jacobian);
    assert!(done.converged && done.jacobian > 0.85);
    let mut worst = [0.0f64; 2];
    for i in 1..n - 1 {
        for j in 1..n - 1 {
            let out = done.grid.at(i, j, 1) - done.grid.at(i, j, 0);
            let along = done.grid.at(i + 1, j, 0) - done.grid.at(i - 1, j, 0);
            worst[0] = worst[0].max((out.norm() / s - 1.0).abs());
            worst[1] = worst[1].max((out.dot(along) / out.norm() / along.norm()).abs());
        }
    }
    assert!(worst[0] < 1e-5 && worst[1] < 1e-5, "{worst:?}");
    for face in GridFace::ALL {
        assert_eq!(done.grid.face(face), start.face(face));
    }
    options.walls.clear();
    options.sweeps = 20;
    let plain = elliptic_volume_until(&start, &options, &free).unwrap();
    assert!(!plain.converged || plain.sweeps <= 20);
    let set = Budget::default();
    set.cancel();
    assert_eq!(
        elliptic_volume_until(&start, &options, &set).unwrap_err(),
        GridError::Spent(Spent::Cancelled)
    );
}

/// A shell between spheres, r = 2^s along radial lines: a solution of the equations without controls, approached at
/// second order.
#[test]
fn shells_converge_at_second_order() {
    let error = |n: usize| {
        let exact = VolumeGrid::<f64>::from_fn([n, n, n], |i, j, k| {
            let u = |i: usize| i as f64 / (n - 1) as f64;
            // The gnomonic-free part: a wedge of a cylinder, conformal in the plane, even along z.
            let (a, r) = (0.4 + u(i), (u(j) * 1.0).exp());
            Vec3::of(r * a.cos(), r * a.sin(), u(k))
        });
        let start = VolumeGrid::<f64>::from_fn([n, n, n], |i, j, k| {
            let edge = [i, j, k].iter().any(|x| *x == 0 || *x == n - 1);
            let p = exact.at(i, j, k);
            if edge { p } else { p + Vec3::of(0.02, -0.01, 0.01) }
        });
        let options = EllipticVolume {
            keep_spacing: false,
            sweeps: 2000,
            tolerance: 1e-12,
            omega: 1.3,
            walls: vec![],
        };
        let done = elliptic_volume_until(&start, &options, &Budget::default()).unwrap();
        assert!(done.converged);
        done.grid.points().zip(exact.points()).map(|(p, q)| p.distance(q)).fold(0.0, f64::max)
    };
    let [a, b] = [7, 13].map(error);
    println!("{a:e} {b:e}");
    assert!((a / b).log2() > 1.7, "{a:e} {b:e}");
}
