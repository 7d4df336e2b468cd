//! Foil sections against published ordinates and closed forms.

use super::*;
use moldloft_num::{Curve, Dual, Order};

fn section(family: &str, ratio: f64, closed: bool) -> Section<f64> {
    Section::new(&SectionSpec { family, ratio, closed, ..SectionSpec::default() }).unwrap()
}

/// The half thickness of a form at x, in chords.
fn ordinate(section: &Section<f64>, ratio: f64, x: f64) -> f64 {
    section.at(x.sqrt()).thickness * ratio / 2.0
}

#[test]
fn four_digit_forms_have_the_published_ordinates() {
    let form = section("4-digit", 0.12, false);
    for (x, y) in [
        (0.0125, 1.894),
        (0.025, 2.615),
        (0.05, 3.555),
        (0.1, 4.683),
        (0.2, 5.738),
        (0.3, 6.002),
        (0.4, 5.803),
        (0.5, 5.294),
        (0.6, 4.563),
        (0.8, 2.623),
        (0.95, 0.807),
        (1.0, 0.126),
    ] {
        let found = 100.0 * ordinate(&form, 0.12, x);
        assert!((found - y).abs() < 5.1e-4, "{x}: {found} and {y}");
    }
    assert!((ordinate(&form, 0.12, 0.299_827_873) - 0.060_017_273_088_0).abs() < 1e-13);
    // The radius of the nose is 1.1019 t^2: with y = c s, x = s^2 it is c^2 / 2.
    let c = 0.06 * form.at(1e-9).thickness / 1e-9;
    assert!((c * c / 2.0 - 1.1019 * 0.12 * 0.12).abs() < 1e-6);
    assert!(section("4-digit", 0.12, true).at(1.0).thickness.abs() < 1e-15);
}

#[test]
fn modified_and_sixteen_series_forms_have_the_published_ordinates() {
    let xs = [0.01, 0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0];
    let sixteen = [
        0.014_485_57,
        0.031_374_39,
        0.043_210_02,
        0.067_724_12,
        0.075,
        0.065_868,
        0.031_464,
        0.001_5,
    ];
    let plain = [
        0.017_205_4,
        0.036_178_02,
        0.047_643_78,
        0.06,
        0.054_073_47,
        0.038_096_33,
        0.014_772_24,
        0.001_2,
    ];
    let (form, other) = (section("16", 0.15, false), section("modified", 0.12, false));
    for ((x, a), b) in xs.into_iter().zip(sixteen).zip(plain) {
        assert!((ordinate(&form, 0.15, x) - a).abs() < 1e-8, "16-015 at {x}");
        assert!((ordinate(&other, 0.12, x) - b).abs() < 1e-8, "0012-63 at {x}");
    }
    // Both polynomials meet with equal value, slope and curvature.
    for (index, at) in [(4.0, 0.5), (6.0, 0.3), (6.0, 0.4), (9.0, 0.25), (0.0, 0.6)] {
        let spec = SectionSpec::<f64> {
            family: "modified",
            nose_index: index,
            thickness_at: at,
            closed: false,
            ..SectionSpec::default()
        };
        let form = Section::new(&spec).unwrap();
        let side = |x: f64| {
            let j = form.at(moldloft_num::Uni2::parameter(x).sqrt()).thickness;
            [j.f, j.t, j.tt]
        };
        let (low, high) = (side(at - 1e-9), side(at + 1e-9));
        for (a, b) in low.into_iter().zip(high) {
            assert!((a - b).abs() < 2e-5, "{index} {at}: {low:?} {high:?}");
        }
        assert!((low[0] - 1.0).abs() < 1e-12 && low[1].abs() < 1e-6);
    }
}

#[test]
fn six_series_forms_agree_with_the_published_tables() {
    // Abbott and von Doenhoff 1959, appendix I, as recomputed by PDAS; in per cent of the chord.
    for (family, ratio, table) in [
        ("63", 0.12, [0.9837, 2.9256, 5.3431, 5.9220, 4.4206, 1.9002, 0.2521]),
        ("64", 0.06, [0.4918, 1.4022, 2.5675, 2.9855, 2.3244, 1.0697, 0.1568]),
        ("65", 0.12, [0.9147, 2.6091, 4.9758, 5.9990, 4.9445, 2.3433, 0.3533]),
        ("66", 0.15, [1.1157, 3.0980, 5.9963, 7.4291, 6.9613, 3.5911, 0.5635]),
        ("64A", 0.12, [0.9599, 2.7874, 5.1309, 5.9916, 4.7994, 2.4983, 0.6424]),
        ("67", 0.15, [1.1649, 3.2444, 5.9398, 7.3593, 7.2309, 4.5401, 0.7880]),
    ] {
        let form = section(family, ratio, false);
        for (x, y) in [0.005, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95].into_iter().zip(table) {
            let found = 100.0 * ordinate(&form, ratio, x);
            assert!((found - y).abs() < 4e-3, "{family} at {x}: {found} and {y}");
        }
        let top = (0..=1000).map(|k| form.at(f64::from(k) / 1e3).thickness).fold(0.0, f64::max);
        assert!((top - 1.0).abs() < 4e-3, "{family}: greatest thickness {top}");
    }
}

#[test]
fn the_propeller_section_reproduces_its_table() {
    let form = section("66tmb", 0.1, false);
    for (x, y) in thickness::TMB {
        assert!((form.at(f64::sqrt(x)).thickness - y).abs() < 1e-14);
    }
    // Greatest thickness and its position stay when the tail is closed.
    let closed = section("66tmb", 0.1, true);
    assert!(closed.at(1.0).thickness.abs() < 1e-15);
    assert_eq!(closed.at(0.3).thickness.to_bits(), form.at(0.3).thickness.to_bits());
    // The section area is 0.7207 c t_max (open tail).
    let area = moldloft_num::integrate(0.0, 1.0, 1e-12, |s: f64| {
        let form = form.at(s);
        form.thickness * 2.0 * s
    });
    assert!((area - 0.7207).abs() < 5e-4, "{area}");
}

#[test]
fn the_mean_line_with_uniform_load_is_the_closed_form() {
    let a = 0.8f64;
    let g = -(a * a * (a.ln() / 2.0 - 0.25) + 0.25) / (1.0 - a);
    let h = (0.2f64.powi(2) * 0.2f64.ln() / 2.0 - 0.2f64.powi(2) / 4.0) / 0.2 + g;
    assert!((g + 0.092_970_3).abs() < 1e-7 && (h + 0.303_914_1).abs() < 1e-7);
    let per_lift = |x: f64| {
        let (z, w) = (a - x, 1.0 - x);
        let inner = z * z * z.abs().ln() / 2.0 - w * w * w.ln() / 2.0 + w * w / 4.0 - z * z / 4.0;
        (inner / (1.0 - a) - x * x.ln() + g - h * x) / (2.0 * std::f64::consts::PI * (a + 1.0))
    };
    let top = 0.067_943_4;
    assert!((per_lift(0.515_33) - top).abs() < 5e-8);
    let line = MeanLine::uniform_load(a);
    assert!((line.at(0.515_33).0 - 1.0).abs() < 1e-9);
    for x in [0.001, 0.0125, 0.1, 0.3, 0.5, 0.7, 0.81, 0.95, 0.999] {
        assert!((line.at(x).0 - per_lift(x) / 0.067_943_4).abs() < 1e-6, "{x}");
    }
    assert_eq!((line.at(0.0).0, line.at(1.0).0), (0.0, 0.0));
    // The classic table, which is normalised at x = 0.5.
    for (x, y) in [(0.0125, 0.0907), (0.1, 0.4482), (0.3, 0.8635), (0.7, 0.8892), (0.9, 0.3586)] {
        assert!((line.at(x).0 - y).abs() < 1.2e-3, "{x}: {}", line.at(x).0);
    }
}

#[test]
fn mean_lines_are_smooth_and_one_high() {
    let lines = [
        MeanLine::parabolic(0.4),
        MeanLine::cubic("210").unwrap(),
        MeanLine::cubic("230").unwrap(),
        MeanLine::cubic("231").unwrap(),
        MeanLine::uniform_load(0.0),
        MeanLine::uniform_load(0.5),
        MeanLine::uniform_load(0.8),
        MeanLine::uniform_load(1.0),
        MeanLine::uniform_load_modified(),
    ];
    for line in lines {
        let top = (0..=10_000).map(|k| line.at(f64::from(k) / 1e4).0).fold(0.0, f64::max);
        assert!((top - 1.0).abs() < 1e-6, "{line:?}: {top}");
        assert!(line.at(0.0).0.abs() < 1e-15 && line.at(1.0).0.abs() < 1e-14, "{line:?}");
        for x in [0.03, 0.2, 0.35, 0.6, 0.83, 0.9] {
            let h = 1e-6;
            let centred = (line.at(x + h).0 - line.at(x - h).0) / (2.0 * h);
            assert!((line.at(x).1 - centred).abs() < 1e-7, "{line:?} at {x}");
        }
    }
    // NACA 230: the published factor k1 = 15.957 makes it 0.0184 high for c_l = 0.3.
    let MeanLine::Cubic { scale, .. } = MeanLine::<f64>::cubic("230").unwrap() else { panic!() };
    assert!((15.957 / 6.0 / scale - 0.01838).abs() < 2e-5);
    // The 6A-series line: the tail falls by 0.24521 c_l per chord, less the tilt that brings its
    // end to 0.
    let MeanLine::Straightened { slope, tilt, .. } = MeanLine::<f64>::uniform_load_modified()
    else {
        panic!("the modified line")
    };
    let per_lift = 0.067_943_4 * 0.979_48;
    assert!(((slope - tilt) * per_lift + 0.245_209).abs() < 1e-4);
    // The published tangent ends at 0.0302164 - 0.245209 (1 - 0.87437).
    assert!((tilt * per_lift - 0.000_589).abs() < 1e-5);
}

fn v(x: f64, y: f64) -> Vec3 {
    Vec3::of(x, y, 0.0)
}

#[test]
fn profiles_pass_through_their_ends_and_are_as_thick_as_asked() {
    let section = Arc::new(section("4-digit", 0.12, true));
    let points = [v(1.0, 0.0), v(0.3, 0.1), v(0.0, 0.0), v(0.5, -0.02), v(1.0, 0.0)];
    let profile = |offset| Profile {
        section: section.clone(),
        layout: Layout::new(&points, Metric::Space).unwrap(),
        offset,
    };
    assert!((profile(Offset::Affine).layout.ratio() - 0.12).abs() < 1e-15);
    for offset in [Offset::Affine, Offset::Normal] {
        let profile = profile(offset);
        let at = |t: f64| profile.jet(t, Order::Zero)[0];
        assert_eq!([at(0.0), at(0.5), at(1.0)], [points[0], points[2], points[4]]);
        for t in [0.05, 0.2, 0.4] {
            // Camber 0.04 at 0.4: upper and lower side are on both sides of the mean line.
            let (a, b) = (at(t), at(1.0 - t));
            let x = (1.0 - 2.0 * t) * (1.0 - 2.0 * t);
            let w = (x - 0.4) / if x < 0.4 { 0.4 } else { 0.6 };
            let mean = v(x, 0.04 * (1.0 - w * w));
            assert!(((a + b) * 0.5).distance(mean) < 1e-15, "{t}");
            let thickness = 0.12 * section.at(x.sqrt()).thickness;
            assert!((a.distance(b) - thickness).abs() < 1e-15);
            let slope = v(1.0, -0.08 * w / if x < 0.4 { 0.4 } else { 0.6 });
            let across = (a - b).dot(slope) / slope.norm();
            match offset {
                Offset::Normal => assert!(across.abs() < 1e-15, "{across}"),
                Offset::Affine => assert!((a - b).x.abs() < 1e-15),
            }
        }
    }
}

#[test]
fn a_metric_measures_the_plane() {
    // A cylinder of radius 2: u is an angle, v a length.
    let section = Arc::new(section("4-digit", 0.12, true));
    let flat = [v(0.0, 0.0), v(0.9, 0.3), v(3.0, 1.0)];
    let rolled = flat.map(|p| v(p.x / 2.0, p.y));
    let metric = Metric::Plane([4.0, 0.0, 1.0]);
    for offset in [Offset::Affine, Offset::Normal] {
        let of = |points: &[Vec3], metric| Profile {
            section: section.clone(),
            layout: Layout::new(points, metric).unwrap(),
            offset,
        };
        let (a, b) = (of(&flat, Metric::Space), of(&rolled, metric));
        for t in [0.1, 0.5, 0.9] {
            let (p, q) = (a.jet(t, Order::Zero)[0], b.jet(t, Order::Zero)[0]);
            assert!(p.distance(v(q.x * 2.0, q.y)) < 1e-15);
        }
    }
}

#[test]
fn derivatives_by_every_number_equal_differences() {
    type D = Dual<4>;
    let build = |f: &dyn Fn(usize, f64) -> D, family: &str, mean: &str| {
        let points = [[1.0, 0.1], [0.3, 0.1], [0.0, 0.02], [0.5, -0.03], [1.0, 0.09]];
        let points: Vec<Vec3<D>> =
            points.iter().map(|p| Vec3::new(D::from(p[0]), D::from(p[1]), D::from(0.0))).collect();
        let mut points = points;
        points[1].y = f(0, 0.1);
        let layout = Layout::new(&points, Metric::Space).unwrap();
        let spec = SectionSpec {
            family,
            mean,
            camber_at: f(1, 0.35),
            load: Some(f(1, 0.6)),
            nose_index: f(2, 5.0),
            thickness_at: f(3, 0.42),
            ratio: layout.ratio(),
            closed: true,
        };
        let section = Arc::new(Section::new(&spec).unwrap());
        Profile { section, layout, offset: Offset::Normal }
    };
    for (family, mean) in
        [("4-digit", "parabolic"), ("modified", "a"), ("65", "a"), ("66tmb", "230"), ("64A", "")]
    {
        let exact = build(&|k, x| D::seeded(x, k), family, mean);
        for t in [0.0, 0.07, 0.31, 0.5, 0.72, 0.97] {
            for k in 0..4 {
                let h = 1e-6;
                let moved = |h: f64| {
                    let p = build(&|j, x| D::from(if j == k { x + h } else { x }), family, mean);
                    p.jet(D::from(t), Order::First).map(|x| x.map(|a| a.re))
                };
                let (high, low, here) = (moved(h), moved(-h), exact.jet(D::from(t), Order::First));
                for order in 0..2 {
                    let centred = (high[order] - low[order]) * (0.5 / h);
                    let d = here[order].map(|a| a.eps[k]);
                    assert!(
                        (d - centred).norm() < 2e-7,
                        "{family} {mean} {t} {k} {order}: {d:?} {centred:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn what_makes_no_foil_is_refused() {
    let of = |family: &str, mean: &str| {
        Section::<f64>::new(&SectionSpec { family, mean, ..SectionSpec::default() }).err()
    };
    assert!(matches!(of("68", ""), Some(FoilError::Family { .. })));
    assert!(matches!(of("63", "260"), Some(FoilError::Mean { .. })));
    let spec =
        SectionSpec::<f64> { family: "modified", thickness_at: 0.7, ..SectionSpec::default() };
    assert!(matches!(Section::new(&spec).err(), Some(FoilError::Range { .. })));
    let p = [v(0.0, 0.0), v(0.5, 0.1), v(0.0, 0.0)];
    assert_eq!(Layout::new(&p, Metric::Space), Err(FoilError::NoChord));
    assert_eq!(Layout::new(&p[..2], Metric::Space), Err(FoilError::Points { actual: 2 }));
    assert_eq!(Layout::new(&p, Metric::Plane([1.0, 2.0, 1.0])), Err(FoilError::Metric));
    let rows = |xs: &[f64]| {
        let rows: Vec<Vec3> = xs.iter().map(|&x| v(x, x * (1.0 - x))).collect();
        Section::of_ordinates(&rows).err()
    };
    assert_eq!(rows(&[0.0, 0.5, 1.0]), None);
    assert!(matches!(rows(&[0.1, 0.5, 1.0]), Some(FoilError::Ordinates { index: 0, .. })));
    assert!(matches!(rows(&[0.0, 0.5, 0.4, 1.0]), Some(FoilError::Ordinates { index: 2, .. })));
    assert!(matches!(rows(&[0.0, 1.0]), Some(FoilError::Ordinates { .. })));
}

#[test]
fn every_name_makes_a_section() {
    for family in Section::<f64>::FAMILIES {
        for mean in Section::<f64>::MEANS {
            for closed in [true, false] {
                let spec = SectionSpec::<f64> { family, mean, closed, ..SectionSpec::default() };
                let section = Section::new(&spec).unwrap();
                assert!(!closed || section.is_closed(), "{family} {mean}");
                assert!((0..=20).all(|k| section.at(f64::from(k) / 20.0).thickness >= -1e-15));
            }
        }
    }
}
