//! Pictures of simple sheets: hidden surfaces, equal bytes, refused requests.

use super::*;
use moldloft_mesh::{PatchInfo, TopologyBuilder};

/// A wavy sheet of n x n panels over the unit square.
fn sheet(n: usize) -> Mesh {
    let mut b = TopologyBuilder::new();
    let points = (n + 1) * (n + 1);
    b.add_vertices(points).unwrap();
    let info = PatchInfo::new("sheet").coloured(Some(12));
    b.add_block(info, n + 1, n + 1, (0..points as u32).collect(), false).unwrap();
    let at = |k: usize| {
        let (u, v) = ((k / (n + 1)) as f64 / n as f64, (k % (n + 1)) as f64 / n as f64);
        Vec3::of(u, v, 0.1 * libm::sin(6.0 * u) * libm::cos(5.0 * v))
    };
    Mesh::new(b.build().into(), (0..points).map(at).collect()).unwrap()
}

fn pixels(bytes: &[u8]) -> Vec<[u8; 3]> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut out = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut out).unwrap();
    out.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect()
}

fn small() -> Options {
    let camera = Camera { azimuth_deg: -90.0, elevation_deg: 90.0, view_angle_deg: None };
    Options {
        width: 120,
        height: 100,
        camera,
        axes: false,
        edges: false,
        borders: false,
        ..Options::default()
    }
}

#[test]
fn the_sheet_covers_the_middle_and_no_more() {
    let picture = pixels(&render(&sheet(10), &[], &small()).unwrap());
    let red = picture.iter().filter(|p| p[0] > p[2].saturating_add(30)).count();
    // 88 % of the height squared, of 100 x 100 points.
    assert!((red as f64 - 88.0 * 88.0).abs() < 200.0, "{red}");
    let [r, _, b] = picture[50 * 120 + 60];
    assert!(r > b + 30);
    assert_eq!(picture[0], [0xfc, 0xfd, 0xfe]);
}

#[test]
fn the_nearer_surface_wins_from_both_sides() {
    let mut b = TopologyBuilder::new();
    b.add_vertices(8).unwrap();
    b.add_faces(PatchInfo::new("low").coloured(Some(4)), [[0, 1, 2, 3]]).unwrap();
    b.add_faces(PatchInfo::new("high").coloured(Some(1)), [[4, 5, 6, 7]]).unwrap();
    let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let p = (0..8).map(|k| Vec3::of(square[k % 4].0, square[k % 4].1, (k / 4) as f64)).collect();
    let mesh = Mesh::new(b.build().into(), p).unwrap();
    for (elevation_deg, blue) in [(90.0, true), (-90.0, false)] {
        for view_angle_deg in [None, Some(30.0)] {
            let camera = Camera { azimuth_deg: 0.0, elevation_deg, view_angle_deg };
            let picture = pixels(&render(&mesh, &[], &Options { camera, ..small() }).unwrap());
            let [r, _, b] = picture[50 * 120 + 60];
            assert_eq!(b > r, blue, "{elevation_deg} {view_angle_deg:?}");
        }
    }
}

#[test]
fn same_input_same_bytes() {
    let line = StyledPolyline {
        points: vec![Vec3::zero(), Vec3::of(1.0, 1.0, 0.2)],
        colour: [0; 3],
        width: 1.5,
        on_surface: false,
    };
    let options = Options {
        mirrors: [false, true, false],
        edges: true,
        borders: true,
        axes: true,
        ..small()
    };
    let first = render(&sheet(20), std::slice::from_ref(&line), &options).unwrap();
    assert_eq!(first, render(&sheet(20), &[line], &options).unwrap());
}

#[test]
fn impossible_requests_are_refused() {
    let size = Options { width: 0, ..small() };
    assert!(matches!(render(&sheet(2), &[], &size), Err(PictureError::Size { .. })));
    let size = Options { height: 100_000, ..small() };
    assert!(render(&sheet(2), &[], &size).unwrap_err().to_string().contains("8192"));
    let mesh = sheet(1);
    let mut p = mesh.positions().to_vec();
    p[2].z = f64::INFINITY;
    let broken = Mesh::new(mesh.topology().clone(), p).unwrap();
    let error = render(&broken, &[], &small()).unwrap_err();
    assert_eq!(error, PictureError::NotFinite { patch: "sheet".into(), vertex: 2 });
}

#[test]
fn nothing_and_a_single_point_are_pictures_too() {
    let none = Mesh::new(TopologyBuilder::new().build().into(), vec![]).unwrap();
    assert!(render(&none, &[], &small()).is_ok());
    let points = vec![Vec3::zero(), Vec3::zero()];
    let line = StyledPolyline { points, colour: [0; 3], width: 2.0, on_surface: false };
    for view_angle_deg in [None, Some(20.0)] {
        let camera = Camera { view_angle_deg, ..Camera::default() };
        let line = std::slice::from_ref(&line);
        assert!(render(&none, line, &Options { camera, ..small() }).is_ok());
    }
}

/// A sphere of few panels and its exact equator: nothing of it is drawn beside the panels.
#[test]
fn lines_on_surfaces_stay_within_the_outline() {
    let at = |k: usize, n: usize| std::f64::consts::TAU * k as f64 / n as f64;
    let mut builder = TopologyBuilder::new();
    builder.add_vertices(16).unwrap();
    builder
        .add_faces(PatchInfo::new("wall"), (0..8).map(|k| [k, (k + 1) % 8, 8 + (k + 1) % 8, 8 + k]))
        .unwrap();
    let ring = |z: f64| (0..8).map(move |k| Vec3::of(libm::cos(at(k, 8)), libm::sin(at(k, 8)), z));
    let wall = Mesh::new(builder.build().into(), ring(-1.0).chain(ring(1.0)).collect()).unwrap();
    let camera = Camera { azimuth_deg: 11.25, elevation_deg: 0.0, view_angle_deg: None };
    let options = Options { camera, ..small() };
    let dark = |on_surface: bool| {
        let points = (0..=90).map(|k| Vec3::of(libm::cos(at(k, 90)), libm::sin(at(k, 90)), 0.0));
        let line =
            StyledPolyline { points: points.collect(), colour: [0; 3], width: 1.5, on_surface };
        let with = pixels(&render(&wall, &[line], &options).unwrap());
        let without = pixels(&render(&wall, &[], &options).unwrap());
        // The former background.
        let outside = |p: &[u8; 3]| p.iter().all(|&c| c > 200);
        let beside = with.iter().zip(&without).filter(|(p, q)| outside(q) && p[0] < 100).count();
        (beside, with.iter().filter(|p| p[0] < 100).count())
    };
    let (beside, all) = dark(true);
    assert_eq!(beside, 0);
    assert!(all > 40, "{all}");
    assert!(dark(false).0 > 0);
}

#[test]
fn names_are_written_beside_their_points() {
    let name = |text: &str| PointName { at: Vec3::zero(), text: text.into(), colour: [0xc0, 0, 0] };
    let red = |labels: Vec<PointName>| {
        let picture = pixels(&render(&sheet(2), &[], &Options { labels, ..small() }).unwrap());
        picture.iter().filter(|p| p[0] > 150 && p[1] < 100).count()
    };
    assert_eq!(red(Vec::new()), 0);
    let one = red(vec![name("P")]);
    assert!(one > 5, "{one}");
    // Four positions without overlap; there is none for the fifth name.
    let four = red(vec![name("P"); 4]);
    assert_eq!(red(vec![name("P"); 5]), four);
    assert!(four > one);
    assert_eq!(red(vec![PointName { at: Vec3::of(f64::NAN, 0.0, 0.0), ..name("P") }]), 0);
}

#[test]
fn a_dot_on_a_surface_is_whole() {
    let red = |elevation_deg: f64| {
        let camera = Camera { azimuth_deg: 20.0, elevation_deg, view_angle_deg: None };
        let points = vec![Vec3::of(0.5, 0.5, 0.0); 2];
        let dot = StyledPolyline { points, colour: [0xc0, 0, 0], width: 9.0, on_surface: false };
        let picture = pixels(&render(&sheet(2), &[dot], &Options { camera, ..small() }).unwrap());
        picture.iter().filter(|p| p[0] > 150 && p[1] < 100).count()
    };
    assert!(red(25.0).abs_diff(red(90.0)) < 12, "{} {}", red(25.0), red(90.0));
}
