//! Closed forms of floating meshes: boxes, spheres and the Wigley hull, with their rates of convergence.

use crate::{Body, Hydrostatics, Symmetry};
use moldloft_mesh::{Mesh, PatchInfo, Tag, TopologyBuilder};
use moldloft_num::{Dual, Dual4, Real, Vec3};
use moldloft_testing::{Random, soak};
use std::f64::consts::PI;

/// The accuracy of the figures of panels that the water cuts.
const FINE: f64 = 1e-11;

fn floats<T: Real>(level: f64, symmetry: Symmetry) -> (T, Symmetry, f64) {
    (T::from(level), symmetry, 1.025)
}

fn hydrostatics<T: Real>(
    mesh: &Mesh<T>,
    (level, symmetry, density): (T, Symmetry, f64),
) -> Hydrostatics<T> {
    crate::hydrostatics(&Body::of_mesh(mesh, FINE), level, symmetry, density)
}

/// The box 0..2 x 0..1 x 0..3 without its side y = 0; patches bottom, top, side, aft, fore.
fn open_half_box() -> Mesh {
    let mut b = TopologyBuilder::new();
    b.add_vertices(8).unwrap();
    // Vertex bits: x, y, z.
    for (name, face) in [
        ("bottom", [0, 2, 3, 1]),
        ("top", [4, 5, 7, 6]),
        ("side", [2, 6, 7, 3]),
        ("aft", [0, 4, 6, 2]),
        ("fore", [1, 3, 7, 5]),
    ] {
        b.add_faces(PatchInfo::new(name), [face]).unwrap();
    }
    let corner = |k: u32| {
        let bit = |n: u32| f64::from((k >> n) & 1);
        Vec3::of(2.0 * bit(0), bit(1), 3.0 * bit(2))
    };
    Mesh::new(b.build().into(), (0..8).map(corner).collect()).unwrap()
}

/// A surface over the parameter square, (nu - 1) x (nv - 1) panels, every vertex its own, but
/// for the rows that `same` calls equal.
fn grid<T: Real>(nu: usize, nv: usize, at: impl Fn(f64, f64) -> Vec3<T>) -> Mesh<T> {
    let mut b = TopologyBuilder::new();
    b.add_vertices(nu * nv).unwrap();
    b.add_block(PatchInfo::new("grid"), nu, nv, (0..(nu * nv) as u32).collect(), false).unwrap();
    let part = |k: usize, n: usize| k as f64 / (n - 1) as f64;
    let positions =
        (0..nu * nv).map(|k| at(part(k / nv, nu), part(k % nv, nv))).collect::<Vec<_>>();
    Mesh::new(b.build().into(), positions).unwrap()
}

/// A sphere of radius `r` about `c`, `n` panels from pole to pole and `2 n` around, closed by
/// identity.
fn sphere<T: Real>(n: usize, r: T, c: Vec3<T>) -> Mesh<T> {
    let (nu, nv) = (2 * n + 1, n + 1);
    let id = |i: usize, j: usize| match j {
        0 => 0,
        j if j == n => 1,
        _ => (2 + (i % (2 * n)) * (n - 1) + j - 1) as u32,
    };
    let mut b = TopologyBuilder::new();
    let count = 2 + 2 * n * (n - 1);
    b.add_vertices(count).unwrap();
    let ids = (0..nu * nv).map(|k| id(k / nv, k % nv)).collect();
    b.add_block(PatchInfo::new("sphere"), nu, nv, ids, false).unwrap();
    let mut positions = vec![Vec3::zero(); count];
    for k in 0..nu * nv {
        let (i, j) = (k / nv % (2 * n), k % nv);
        let (phi, theta) = (
            std::f64::consts::PI * i as f64 / n as f64,
            std::f64::consts::PI * j as f64 / n as f64,
        );
        let d = Vec3::of(theta.sin() * phi.cos(), theta.sin() * phi.sin(), -theta.cos());
        positions[id(i, j) as usize] = c + d * r;
    }
    Mesh::new(b.build().into(), positions).unwrap()
}

/// The starboard half of the Wigley hull (Wigley 1942): y = (B/2) (1 - (2x/L)^2) (1 - (z/T)^2).
fn wigley<T: Real>(n: usize, length: T, beam: T, draft: T) -> Mesh<T> {
    grid(2 * n + 1, n + 1, |u, v| {
        let (xi, zeta) = (T::from(2.0 * u - 1.0), T::from(1.0 - v));
        let y = beam * 0.5 * (-(xi * xi) + 1.0) * (-(zeta * zeta) + 1.0);
        Vec3::new(length * 0.5 * xi, -y, -(draft * zeta))
    })
}

#[test]
fn a_box_exactly() {
    let half = open_half_box();
    for symmetry in [Symmetry::MirroredTwice, Symmetry::MirroredOnce] {
        let n = if symmetry == Symmetry::MirroredTwice { 2.0 } else { 1.0 };
        let h = hydrostatics(&half, floats(1.2, symmetry));
        assert!((h.volume - n * 2.4).abs() < 1e-14 && h.outward);
        assert!((h.displacement - 1.025 * n * 2.4).abs() < 1e-14);
        assert!((h.wetted_area - n * (2.0 + 1.2 * 4.0)).abs() < 1e-14);
        assert!(h.closure_error < 1e-14 && h.waterplane_error < 1e-14 && h.open_edges == 0);
        let w = h.waterplane.unwrap();
        assert!((w.length - 2.0).abs() < 1e-15 && (w.beam - n).abs() < 1e-15);
        assert!((w.transverse_moment - 2.0 * n.powi(3) / 12.0).abs() < 1e-14);
        assert!((w.longitudinal_moment - n * 8.0 / 12.0).abs() < 1e-14);
        let c = h.coefficients.unwrap();
        for c in [c.block, c.prismatic, c.midship, c.waterplane] {
            assert!((c - 1.0).abs() < 1e-14);
        }
        assert!((h.kb().unwrap() - 0.6).abs() < 1e-15 && (h.draft - 1.2).abs() < 1e-15);
        let y = if n == 2.0 { 0.0 } else { 0.5 };
        assert!(h.buoyancy_centre.unwrap().distance(Vec3::of(1.0, y, 0.6)) < 1e-15);
    }
}

#[test]
fn a_hole_below_the_water_is_seen() {
    let half = open_half_box();
    let open = hydrostatics(&half, floats(1.2, Symmetry::None));
    assert_eq!(open.open_edges, 3);
    let b = |names: &[usize]| {
        let mut b = TopologyBuilder::new();
        b.add_vertices(8).unwrap();
        for &k in names {
            b.add_faces(PatchInfo::new("part"), [half.faces()[k]]).unwrap();
        }
        Mesh::new(b.build().into(), half.positions().to_vec()).unwrap()
    };
    let no_end = hydrostatics(&b(&[0, 1, 2, 3]), floats(1.2, Symmetry::MirroredTwice));
    assert!(no_end.closure_error > 0.1 && no_end.open_edges == 2);
    // The deck is above the water: it may be missing.
    let no_deck = hydrostatics(&b(&[0, 2, 3, 4]), floats(1.2, Symmetry::MirroredTwice));
    assert!(no_deck.closure_error < 1e-14 && no_deck.open_edges == 0);
    assert!((no_deck.volume - 4.8).abs() < 1e-14);
}

#[test]
fn a_floating_sphere_at_second_order() {
    // A sphere of radius 1 whose centre is 0.3 above the water.
    let (r, d) = (1.0f64, 0.7f64);
    let volume = PI * d * d * (3.0 * r - d) / 3.0;
    let area = PI * d * (2.0 * r - d);
    let error = |n| {
        let h = hydrostatics(&sphere(n, r, Vec3::of(4.0, 5.0, 0.3)), floats(0.0, Symmetry::None));
        assert!(h.closure_error < 1e-13 && h.open_edges == 0 && h.outward);
        assert!(h.waterplane_error < 1e-13);
        let w = h.waterplane.unwrap();
        let i = PI / 4.0 * area.powi(2) / (PI * PI);
        let z = h.buoyancy_centre.unwrap().z;
        [
            h.volume - volume,
            w.area - area,
            h.wetted_area - 2.0 * PI * r * d,
            w.transverse_moment - i,
            z + 3.0 * (2.0 * r - d).powi(2) / (4.0 * (3.0 * r - d)) - 0.3,
        ]
    };
    let (coarse, fine) = (error(16), error(64));
    for k in 0..5 {
        let rate = (coarse[k] / fine[k]).abs().log2() / 2.0;
        assert!((1.8..2.3).contains(&rate), "{k}: {coarse:?} {fine:?}");
    }
}

#[test]
fn submerged_and_dry_spheres() {
    let h = hydrostatics(&sphere(32, 1.0, Vec3::of(0.0, 0.0, -5.0)), floats(0.0, Symmetry::None));
    assert!(h.waterplane.is_none() && h.coefficients.is_none() && h.bm_transverse().is_none());
    assert!((h.volume - 4.0 * PI / 3.0).abs() < 0.03 && (h.draft - 6.0).abs() < 1e-12);
    let h = hydrostatics(&sphere(8, 1.0, Vec3::of(0.0, 0.0, 5.0)), floats(0.0, Symmetry::None));
    assert_eq!((h.volume, h.draft, h.buoyancy_centre), (0.0, 0.0, None));
    assert_eq!(h.closure_error, 0.0);
}

#[test]
fn inward_normals_are_reported_and_turned() {
    let h = hydrostatics(&sphere(16, -1.0, Vec3::zero()), floats(0.2, Symmetry::None));
    let o = hydrostatics(&sphere(16, 1.0, Vec3::zero()), floats(0.2, Symmetry::None));
    assert!(!h.outward && o.outward);
    assert!((h.volume - o.volume).abs() < 1e-13);
    assert!((h.waterplane.unwrap().area - o.waterplane.unwrap().area).abs() < 1e-13);
    assert!(h.closure_error < 1e-13 && h.waterplane_error < 1e-13);
}

#[test]
fn the_wigley_hull_at_second_order() {
    let (length, beam, draft) = (10.0, 1.0, 0.625);
    let error = |n| {
        let mesh = wigley(n, length, beam, draft);
        let h = hydrostatics(&mesh, floats(0.0, Symmetry::MirroredTwice));
        assert!(h.outward && h.open_edges == 0 && h.closure_error < 1e-13);
        let (w, c) = (h.waterplane.unwrap(), h.coefficients.unwrap());
        assert!((w.length - length).abs() < 1e-13 && (w.beam - beam).abs() < 1e-14);
        [
            c.block - 4.0 / 9.0,
            c.waterplane - 2.0 / 3.0,
            c.midship - 2.0 / 3.0,
            h.buoyancy_centre.unwrap().z + 0.375 * draft,
            // int (1 - xi^2)^3 = 32/35 and int xi^2 (1 - xi^2) = 4/15 over [-1, 1].
            w.transverse_moment - beam.powi(3) * length / 12.0 * 16.0 / 35.0,
            w.longitudinal_moment - beam * length.powi(3) / 8.0 * 4.0 / 15.0,
        ]
    };
    let (coarse, fine) = (error(10), error(40));
    for k in 0..6 {
        let rate = (coarse[k] / fine[k]).abs().log2() / 2.0;
        assert!((rate - 2.0).abs() < 0.1, "{k}: {coarse:?} {fine:?}");
    }
}

#[test]
fn a_waterline_through_the_panels_is_cut_exactly() {
    // At z = -T/2: y = 3/4 (B/2)(1 - xi^2), and V = B L T (2/3) (2/3 - 11/24) from below.
    let (length, beam, draft) = (10.0, 1.0, 0.625);
    let mesh = wigley(63, length, beam, draft);
    let h = hydrostatics(&mesh, floats(-draft / 2.0, Symmetry::MirroredTwice));
    let volume = beam * length * draft * (2.0 / 3.0) * (2.0 / 3.0 - 11.0 / 24.0);
    assert!((h.volume / volume - 1.0).abs() < 2e-3);
    let w = h.waterplane.unwrap();
    assert!((w.area / (0.75 * 2.0 / 3.0 * length * beam) - 1.0).abs() < 1e-3);
    assert!((w.beam - 0.75 * beam).abs() < 1e-3 && h.closure_error < 1e-12);
}

#[test]
fn lids_are_not_skin() {
    let half = open_half_box();
    let mut b = TopologyBuilder::new();
    b.add_vertices(8).unwrap();
    for (k, face) in half.faces().iter().enumerate() {
        let tag = if k == 1 { Tag::Lid } else { Tag::Wetted };
        b.add_faces(PatchInfo::new("part").tagged(tag), [*face]).unwrap();
    }
    let mesh = Mesh::new(b.build().into(), half.positions().to_vec()).unwrap();
    let h = hydrostatics(&mesh, floats(4.0, Symmetry::MirroredTwice));
    assert!((h.wetted_area - 2.0 * (2.0 + 3.0 * 4.0)).abs() < 1e-13);
}

#[test]
fn derivatives_equal_central_differences() {
    let at = |p: [f64; 4]| {
        let [l, b, d, c] = [0, 1, 2, 3].map(|k| Dual4::seeded(p[k], k));
        let options = (c, Symmetry::MirroredTwice, 1.0);
        hydrostatics(&wigley(12, l, b, d), options).figures()
    };
    let p = [10.0, 1.0, 0.625, -0.1037];
    let exact = at(p);
    for k in 0..4 {
        let h = 1e-5;
        let moved = |s: f64| {
            let mut q = p;
            q[k] += s * h;
            at(q)
        };
        let (plus, minus) = (moved(1.0), moved(-1.0));
        for ((name, value), (up, down)) in exact.iter().zip(plus.iter().zip(&minus)) {
            let centred = (up.1.re - down.1.re) / (2.0 * h);
            let scale = 1.0 + centred.abs();
            assert!(
                (value.eps[k] - centred).abs() < 1e-7 * scale,
                "d {name} / d p{k}: {} against {centred}",
                value.eps[k]
            );
        }
    }
}

#[test]
fn the_derivative_of_the_volume_by_the_level_is_the_waterplane() {
    let level = Dual::<1>::seeded(0.13, 0);
    let options = (level, Symmetry::None, 1.0);
    let h = hydrostatics(&sphere(10, Dual::from(1.0), Vec3::zero()), options);
    let area = h.waterplane.unwrap().area.re;
    // Cut warped panels change their shape a little with the cut.
    assert!((h.volume.eps[0] / area - 1.0).abs() < 1e-3, "{} {area}", h.volume.eps[0]);
}

/// A corner that a plane cuts off a tetrahedron is the share s1 s2 s3 of it, with the centre of a
/// tetrahedron.
#[test]
fn a_corner_of_a_tetrahedron_exactly() {
    let mut random = Random::new(5);
    for _ in 0..if soak() { 5000 } else { 200 } {
        let mut point = || Vec3::from([(); 3].map(|()| random.between(-1.0, 1.0)));
        let mut p: [Vec3; 4] = [(); 4].map(|()| point());
        let whole = (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) / 6.0;
        if whole < 0.0 {
            p.swap(1, 2);
        }
        let whole = whole.abs();
        p.sort_by(|a, b| a.z.total_cmp(&b.z));
        let reversed = (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) < 0.0;
        let level = random.between(p[0].z, p[3].z);
        let faces = [[0, 2, 1, 1], [0, 1, 3, 3], [1, 2, 3, 3], [2, 0, 3, 3]];
        let panels = faces.map(|f| f.map(|k: usize| p[k]));
        let panels = panels.map(|[a, b, c, _]| if reversed { [a, c, b, b] } else { [a, b, c, c] });
        let none: [crate::HullSide<'_, f64>; 0] = [];
        let body = Body::new(&none, panels, Vec::new(), 4.0, FINE).unwrap();
        let h = crate::hydrostatics(&body, level, Symmetry::None, 1.0);
        // The corner below, or that above.
        let alone = match level {
            z if z < p[1].z => Some((p[0], [p[1], p[2], p[3]])),
            z if z > p[2].z => Some((p[3], [p[0], p[1], p[2]])),
            _ => None,
        };
        assert!(h.closure_error < 1e-9 * whole.max(1e-3) / h.volume && h.outward, "{h:?}");
        let Some((top, others)) = alone else { continue };
        let ends = others.map(|q| top + (q - top) * ((level - top.z) / (q.z - top.z)));
        let [a, b, c] = ends.map(|q| q - top);
        let cap = a.cross(b).dot(c).abs() / 6.0;
        let volume = if top.z < level { cap } else { whole - cap };
        assert!((h.volume - volume).abs() < 1e-14, "{} {volume}", h.volume);
        let plane = h.waterplane.unwrap();
        let area = (ends[1] - ends[0]).cross(ends[2] - ends[0]).z.abs() / 2.0;
        assert!(
            (plane.area - area).abs() < 1e-13 && h.waterplane_error * area < 1e-13,
            "{plane:?} {area}"
        );
        if top.z < level && cap > 1e-6 {
            let centre = top + (a + b + c) / 4.0;
            assert!(h.buoyancy_centre.unwrap().distance(centre) < 1e-8);
        }
    }
}
