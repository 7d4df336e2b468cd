//! The hull of Letcher and Shook (1995), Figure 1 and Table 2, from text to numbers.

use moldloft_document::{Document, NoFiles, registry};
use moldloft_num::Vec3;
use moldloft_registry::Value;
use moldloft_testing::ridders;

const HULL: &str = include_str!("hull.sdl");

fn open(text: &str) -> Document {
    Document::from_text(registry(), Box::new(NoFiles), "hull.sdl", text)
}

fn hull() -> Document {
    let document = open(HULL);
    assert!(document.diagnostics().is_empty(), "{:?}", document.diagnostics());
    document
}

fn number(document: &mut Document, text: &str) -> f64 {
    match document.eval(text) {
        Ok(Value::Number(x)) => x,
        other => panic!("{text}: {other:?}"),
    }
}

fn vector(document: &mut Document, text: &str) -> Vec3 {
    match document.eval(text) {
        Ok(Value::Vector(v)) => v,
        other => panic!("{text}: {other:?}"),
    }
}

#[test]
fn the_surface_passes_through_the_papers_points() {
    let mut document = hull();
    for (uv, expected) in [
        ("(.5,.25)", Vec3::of(8.6422, 2.9203, -0.2053)),
        ("(.5,.5)", Vec3::of(15.6002, 4.3938, -0.1043)),
        ("(.5,.75)", Vec3::of(22.7195, 4.4203, 0.2042)),
        ("(0,.25)", Vec3::of(7.2339, 3.1440, 2.9322)),
        ("(1,.25)", Vec3::of(9.7675, 0.0, -1.1976)),
    ] {
        let found = vector(&mut document, &format!("hull{uv}"));
        assert!(found.distance(expected) < 1e-4, "hull{uv} = {found:?}");
    }
}

#[test]
fn the_waterline_ends_where_the_papers_stations_do() {
    let document = hull();
    let waterline = document.sections().into_iter().find(|s| s.axis == 2).expect("one waterline");
    assert_eq!(waterline.value, 0.0);
    let line = &waterline.lines[0].1[0];
    let xs: Vec<f64> = line.points.iter().map(|p| p.x).collect();
    let low = xs.iter().copied().fold(f64::INFINITY, f64::min);
    let high = xs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!((low - 1.781).abs() < 5e-4, "{low}");
    assert!((high - 29.167).abs() < 5e-4, "{high}");
    assert!(line.points.iter().all(|p| p.z.abs() < 1e-12));
    let stations: Vec<_> = document.sections().into_iter().filter(|s| s.axis == 0).collect();
    assert_eq!(stations.len(), 11);
    assert!((stations[10].value - 29.15).abs() < 1e-12);
}

/// What `n` times 10 x 20 panels displace.
fn volume(n: usize) -> f64 {
    let text = HULL.replace("{10, 20}", &format!("{{{}, {}}}", 10 * n, 20 * n));
    assert_ne!(n > 1, text == HULL, "the divisions stand in the text");
    let mut document = open(&text);
    // That of the shape does not depend on them.
    assert!((number(&mut document, "hydrostatics.volume") - 117.453_999_868).abs() < 1e-7);
    document.panel_figures(0.0).unwrap()[0]
}

#[test]
fn the_volume_of_the_panels_converges_at_second_order() {
    let volumes: Vec<f64> = [2, 4, 8, 16].map(volume).to_vec();
    assert!((volumes[3] - 117.45).abs() < 0.1, "{volumes:?}");
    for k in 0..2 {
        let ratio = (volumes[k + 1] - volumes[k]) / (volumes[k + 2] - volumes[k + 1]);
        assert!((3.5..4.6).contains(&ratio), "{ratio} in {volumes:?}");
    }
}

#[test]
fn a_direct_edit_equals_a_run_of_the_edited_text() {
    let mut edited = hull();
    let applied = edited.set(&[("P22.y".into(), 5.3), ("P33.z".into(), 0.25)]).unwrap();
    // Two points, two curves, one surface.
    assert_eq!(applied.evaluated, 5);
    let mut again = open(&edited.text());
    for text in ["hull(.31,.77)", "MC2(.4)", "P33"] {
        assert!(vector_like(&mut edited, text).bits_eq(vector_like(&mut again, text)), "{text}");
    }
    assert_eq!(
        number(&mut edited, "hydrostatics.volume").to_bits(),
        number(&mut again, "hydrostatics.volume").to_bits()
    );
}

fn vector_like(document: &mut Document, text: &str) -> Vec3 {
    match document.eval(text) {
        Ok(Value::Vector(v)) => v,
        Ok(Value::Point(p)) => p.xyz,
        other => panic!("{text}: {other:?}"),
    }
}

#[test]
fn the_same_number_changes_nothing() {
    let mut document = hull();
    assert_eq!(document.set(&[("P22.y".into(), 5.046)]).unwrap().evaluated, 0);
    assert_eq!(document.run().evaluated, 0);
}

#[test]
fn derivatives_of_volume_and_vertices_equal_differences() {
    let mut document = hull();
    let names: Vec<String> =
        ["P22.y", "P12.z", "P31.x", "P14.x", "P24.z"].map(String::from).to_vec();
    let volumes = document.derivatives(&["hydrostatics.volume".into()], &names).unwrap();
    let vertices = document.jacobian(&names).unwrap();
    for (k, name) in names.iter().enumerate() {
        let Value::Number(exact) = volumes[0][k] else { panic!() };
        let start = number(&mut document, name);
        let mut at = |h: f64| {
            document.set(&[(name.clone(), start + h)]).unwrap();
            let volume = number(&mut document, "hydrostatics.volume");
            let positions = document.panelled().unwrap().mesh.positions().to_vec();
            document.set(&[(name.clone(), start)]).unwrap();
            (volume, positions)
        };
        let centred = ridders(|h| at(h).0, 0.0, 1e-2);
        assert!((exact - centred).abs() < 1e-6 * exact.abs().max(1.0), "{name}: {exact} {centred}");
        for vertex in [0, 57, 130, vertices[k].len() - 1] {
            for axis in 0..3 {
                let centred = ridders(|h| at(h).1[vertex][axis], 0.0, 1e-1);
                let exact = vertices[k][vertex][axis];
                assert!(
                    (exact - centred).abs() < 1e-8,
                    "{name} {vertex} {axis}: {exact} {centred}"
                );
            }
        }
    }
}
