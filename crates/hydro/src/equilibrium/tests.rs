//! Closed forms of floating boxes: upright, heeled, trimmed.

use super::*;
use crate::tests::ellipsoid;
use moldloft_mesh::{Mesh, PatchInfo, Tag, TopologyBuilder};
use moldloft_num::Dual4;
use std::f64::consts::PI;

/// A closed box of length x breadth x height about (0, 0, 0) with `n` panels along each side, or
/// without its top.
fn box_of<T: Real>(sides: [T; 3], n: usize, decked: bool) -> Body<T> {
    Body::of_mesh(&box_mesh(sides, n, decked), 1e-9)
}

fn box_mesh<T: Real>(sides: [T; 3], n: usize, decked: bool) -> Mesh<T> {
    let (mut positions, mut quads) = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for end in [false, true] {
            if axis == 2 && end && !decked {
                continue;
            }
            let first = positions.len() as u32;
            for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
                let mut p = [T::zero(); 3];
                let share = |k: usize| k as f64 / n as f64 - 0.5;
                p[axis] = sides[axis] * if end { 0.5 } else { -0.5 };
                p[(axis + 1) % 3] = sides[(axis + 1) % 3] * share(i);
                p[(axis + 2) % 3] = sides[(axis + 2) % 3] * share(j);
                positions.push(Vec3::from(p));
            }
            let at = |i: usize, j: usize| first + (i * (n + 1) + j) as u32;
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                quads.push(if end { quad } else { [quad[0], quad[3], quad[2], quad[1]] });
            }
        }
    }
    let mut b = TopologyBuilder::new();
    b.add_vertices(positions.len()).unwrap();
    b.add_faces(PatchInfo::new("box"), quads).unwrap();
    let loose = Mesh::new(b.build().into(), positions).unwrap();
    welded(&loose)
}

/// The mesh with vertices at equal real places made one.
fn welded<T: Real>(mesh: &Mesh<T>) -> Mesh<T> {
    let real = mesh.re();
    let mut number = vec![0u32; real.positions().len()];
    let mut kept: Vec<usize> = Vec::new();
    for (v, p) in real.positions().iter().enumerate() {
        let same = kept.iter().position(|&k| real.positions()[k].distance(*p) < 1e-12);
        number[v] = same.unwrap_or(kept.len()) as u32;
        if same.is_none() {
            kept.push(v);
        }
    }
    let mut b = TopologyBuilder::new();
    b.add_vertices(kept.len()).unwrap();
    let faces = mesh.faces().iter().map(|f| f.map(|v| number[v as usize]));
    b.add_faces(PatchInfo::new("box").tagged(Tag::Wetted), faces).unwrap();
    Mesh::new(b.build().into(), kept.iter().map(|&k| mesh.positions()[k]).collect()).unwrap()
}

const L: f64 = 12.0;
const B: f64 = 4.0;
const H: f64 = 3.0;

fn loading(mass: f64, centre: [f64; 3]) -> Loading<f64> {
    Loading { mass, centre: Some(centre.into()), free_trim: true, free_heel: true }
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance, "{a} is not {b}");
}

#[test]
fn a_barge_floats_upright() {
    let barge = box_of([L, B, H], 4, true);
    let draft = 1.3;
    let mass = 1.025 * L * B * draft;
    let water = Water { density: 1.025, ..Water::default() };
    let solved =
        equilibrium(&barge, water, loading(mass, [0.0; 3]), Attitude::upright(0.0)).unwrap();
    assert_eq!(solved.status, Status::Converged);
    let a = solved.flotation;
    close(a.drafts[1], draft, 1e-12);
    close(a.earth.volume, L * B * draft, 1e-10);
    // BM_T = B^2 / 12 T, BM_L = L^2 / 12 T, KB = T / 2, KG = H / 2.
    let gm = draft / 2.0 + B * B / (12.0 * draft) - H / 2.0;
    close(a.gm.unwrap()[0], gm, 1e-11);
    close(a.gm.unwrap()[1], draft / 2.0 + L * L / (12.0 * draft) - H / 2.0, 1e-10);
    close(a.tpc.unwrap(), 1.025 * L * B / 100.0, 1e-12);
    close(a.mtc.unwrap(), mass * a.gm.unwrap()[1] / (100.0 * L), 1e-10);
    close(a.weight, mass * 9.80665, 1e-9);
    assert_eq!(solved.stable, gm > 0.0);
    assert_eq!(a.freeboard, None);
}

#[test]
fn a_wall_sided_box_rights_itself_by_the_formula() {
    // GZ = (GM + BM tan^2 / 2) sin while neither deck nor bottom come to the water (Scribanti).
    let barge = box_of([L, B, H], 3, true);
    let (draft, kg) = (1.5, 1.2);
    let (bm, gm) = (B * B / (12.0 * draft), draft / 2.0 + B * B / (12.0 * draft) - kg);
    for heel in [-0.5f64, -0.1, 0.05, 0.3, 0.6] {
        let loading =
            Loading { free_heel: false, ..loading(L * B * draft, [0.0, 0.0, kg - H / 2.0]) };
        let start = Attitude { heel, ..Attitude::upright(0.0) };
        let solved = equilibrium(&barge, Water::default(), loading, start).unwrap();
        let gz = (gm + 0.5 * bm * heel.tan().powi(2)) * heel.sin();
        close(solved.flotation.gz.unwrap(), gz, 1e-12);
        close(solved.flotation.attitude.trim, 0.0, 1e-12);
        close(solved.flotation.trim_arm.unwrap(), 0.0, 1e-11);
    }
}

#[test]
fn weight_off_the_middle_trims_and_heels() {
    // Wall-sided: tan(trim) = x_G / (GM_L + BM_L tan^2 / 2), for the box with G in height z; checked
    // through the arms, which vanish, and the closed form in trim alone.
    let barge = box_of([L, B, H], 3, true);
    let draft = 1.5;
    let at = loading(L * B * draft, [0.3, 0.08, -0.2]);
    let solved = equilibrium(&barge, Water::default(), at, Attitude::upright(0.0)).unwrap();
    assert_eq!(solved.status, Status::Converged);
    assert!(solved.stable && solved.iterations < 12, "{}", solved.iterations);
    let a = solved.flotation;
    assert!(a.attitude.trim > 0.0 && a.attitude.heel > 0.0, "the heavy side goes down");
    close(a.gz.unwrap(), 0.0, 1e-12);
    close(a.trim_arm.unwrap(), 0.0, 1e-12);
    close(a.earth.volume, L * B * draft, 1e-11);
    assert!(a.drafts[2] > a.drafts[1] && a.drafts[1] > a.drafts[0]);

    let only = Loading { free_heel: false, ..loading(L * B * draft, [0.3, 0.0, -0.2]) };
    let a = equilibrium(&barge, Water::default(), only, Attitude::upright(0.0)).unwrap().flotation;
    let tan = a.attitude.trim.tan();
    let (bm, kb) = (L * L / (12.0 * draft), draft / 2.0);
    let gm = kb + bm - (H / 2.0 - 0.2);
    close(tan * (gm + 0.5 * bm * tan * tan), 0.3, 1e-10);
}

#[test]
fn a_sphere_in_water() {
    // Half immersed: V = 2 pi r^3 / 3, and GM = -z_G for any sphere: the metacentre is its centre.
    let ball = ellipsoid([1.0; 3], Vec3::zero(), 1e-9);
    let mass = 2.0 * PI / 3.0;
    let at = Loading { free_trim: false, free_heel: false, ..loading(mass, [0.0, 0.0, -0.2]) };
    let a = equilibrium(&ball, Water::default(), at, Attitude::upright(0.0)).unwrap().flotation;
    close(a.attitude.level, 0.0, 1e-10);
    close(a.gm.unwrap()[0], 0.2, 1e-9);
    close(a.buoyancy_centre.unwrap().z, -3.0 / 8.0, 1e-9);
    close(a.earth.volume, mass, 1e-9);
    close(a.earth.waterplane.unwrap().beam, 2.0, 1e-9);
    close(a.earth.waterplane.unwrap().midship_area, PI / 2.0, 1e-9);
}

#[test]
fn an_unstable_equilibrium_is_called_so_and_left() {
    let tall = box_of([3.0, 2.0, 10.0], 2, true);
    let at = |free_heel| Loading { free_heel, ..loading(30.0, [0.0; 3]) };
    let solved = equilibrium(&tall, Water::default(), at(false), Attitude::upright(0.0)).unwrap();
    assert!(solved.status == Status::Converged && !solved.stable);
    assert!(solved.flotation.gm.unwrap()[0] < 0.0);
    let solved = equilibrium(&tall, Water::default(), at(true), Attitude::upright(0.0)).unwrap();
    assert!(solved.status == Status::Converged && solved.stable && solved.lolls, "{solved:?}");
    close(solved.flotation.gz.unwrap(), 0.0, 1e-9);
    close(solved.flotation.attitude.heel, PI / 2.0, 1e-9);
}

#[test]
fn the_angle_of_loll_of_a_box() {
    // 10 x 4, depth 2.5, draught 1, BM 4/3: tan^2 phi = -2 GM / BM while wall-sided. With KG 2.4 the arm overturns
    // at every angle up to 180 degrees, so that it comes to rest upside down.
    let barge = box_of([10.0, 4.0, 2.5], 1, true);
    let wall_sided = |kg: f64| (2.0 * (kg - 0.5 - 4.0 / 3.0) / (4.0 / 3.0)).sqrt().atan();
    for (kg, heel) in
        [(1.9, wall_sided(1.9)), (1.95, wall_sided(1.95)), (2.0, 0.5f64.atan()), (2.4, PI)]
    {
        let at = loading(40.0, [0.0, 0.0, kg - 1.25]);
        let solved = equilibrium(&barge, Water::default(), at, Attitude::upright(0.0)).unwrap();
        assert!(solved.stable && solved.lolls && solved.status == Status::Converged, "{kg}");
        close(solved.flotation.attitude.heel, heel, 1e-10);
    }
}

#[test]
fn what_cannot_float_is_explained() {
    let barge = box_of([L, B, H], 2, true);
    let float = |mass: f64, centre: Option<[f64; 3]>| {
        let loading =
            Loading { mass, centre: centre.map(Vec3::from), free_trim: true, free_heel: false };
        equilibrium(&barge, Water::default(), loading, Attitude::upright(0.0)).unwrap_err()
    };
    assert!(matches!(float(-1.0, None), FloatError::Mass { .. }));
    assert!(matches!(float(f64::NAN, None), FloatError::Mass { .. }));
    assert_eq!(float(1.0, None), FloatError::NoCentre);
    let FloatError::Sinks { mass, most, rim: None } = float(200.0, Some([0.0; 3])) else {
        panic!()
    };
    assert_eq!(mass, 200.0);
    close(most, L * B * H, 1e-10);
    let none = Mesh::new(TopologyBuilder::new().build().into(), vec![]).unwrap();
    let none = Body::of_mesh(&none, 1e-9);
    let none = equilibrium(&none, Water::default(), loading(1.0, [0.0; 3]), Attitude::upright(0.0));
    assert_eq!(none, Err(FloatError::NoBody));
    let half = Water { symmetry: Symmetry::MirroredTwice, ..Water::default() };
    let heels = equilibrium(&barge, half, loading(1.0, [0.0; 3]), Attitude::upright(0.0));
    assert_eq!(heels, Err(FloatError::HalfHeels));
}

#[test]
fn an_open_hull_knows_its_freeboard() {
    let open = box_of([L, B, H], 2, false);
    let draft = 2.0;
    let at = Loading { free_heel: false, ..loading(L * B * draft, [0.0, 0.0, -0.5]) };
    let a = equilibrium(&open, Water::default(), at, Attitude::upright(0.0)).unwrap().flotation;
    close(a.freeboard.unwrap(), H - draft, 1e-12);
    assert_eq!(a.earth.open_edges, 0);
    let heeled = Attitude { heel: 0.7, ..Attitude::upright(0.0) };
    let a = equilibrium(&open, Water::default(), at, heeled).unwrap().flotation;
    assert!(a.freeboard.unwrap() < 0.0 && a.earth.open_edges > 0, "the deck edge is under");
    let sinks = Loading { mass: 1.01 * L * B * H, ..at };
    let sinks = equilibrium(&open, Water::default(), sinks, Attitude::upright(0.0));
    assert!(matches!(sinks, Err(FloatError::Sinks { rim: Some(_), .. })), "{sinks:?}");
    let message = sinks.unwrap_err().to_string();
    assert!(message.contains("without an immersed open edge"), "{message}");
}

#[test]
fn derivatives_of_the_equilibrium_equal_central_differences() {
    // By length, breadth, mass and the centre's x.
    let base = [L, B, 70.0, 0.3];
    let solve = |x: [f64; 4]| {
        let barge = box_of([x[0], x[1], H], 3, true);
        let at = loading(x[2], [x[3], 0.06, -0.2]);
        equilibrium(&barge, Water::default(), at, Attitude::upright(0.0)).unwrap().flotation
    };
    let x: [Dual4; 4] = std::array::from_fn(|k| Dual4::seeded(base[k], k));
    let barge = box_of([x[0], x[1], Dual4::from(H)], 3, true);
    let at = Loading {
        mass: x[2],
        centre: Some(Vec3::new(x[3], 0.06.into(), (-0.2).into())),
        free_trim: true,
        free_heel: true,
    };
    let start = Attitude::upright(Dual4::from(0.0));
    let exact = equilibrium(&barge, Water::default(), at, start).unwrap().flotation;
    for k in 0..4 {
        let h = 1e-5;
        let (mut up, mut down) = (base, base);
        up[k] += h;
        down[k] -= h;
        let (up, down) = (solve(up).figures(), solve(down).figures());
        for ((name, value), (u, d)) in exact.figures().iter().zip(up.iter().zip(&down)) {
            assert_eq!(*name, u.0);
            let difference = (u.1 - d.1) / (2.0 * h);
            let error = (value.eps[k] - difference).abs() / (1.0 + difference.abs());
            assert!(error < 2e-7, "{name} by {k}: {} is not {difference}", value.eps[k]);
        }
    }
}

#[test]
fn attitudes_turn_there_and_back() {
    let a = Attitude { level: 0.3, trim: 0.2, heel: -0.7 };
    let p = Vec3::of(1.0, -2.0, 0.5);
    assert!(a.body_from(a.earth_from(p)).distance(p) < 1e-15);
    assert!(a.earth_from(Vec3::of(0.0, -1.0, 0.0)).z < 0.0, "heel to port sinks port");
    assert!(a.earth_from(Vec3::of(1.0, 0.0, 0.0)).z < 0.0, "trim sinks large x");
    let z = a.water_over(1.7);
    assert!((a.earth_from(Vec3::of(1.7, 0.0, z)).z - 0.3).abs() < 1e-15);
    assert!((Attitude::level_at(0.2, -0.7, 1.7, z) - 0.3).abs() < 1e-15);
}
