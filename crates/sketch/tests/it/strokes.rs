//! Strokes of a hand, whose paths are known, as lines, arcs, circles, ellipses and splines.

use crate::stroke_hands::{Drawn, FAMILIES, Place, Way, drawn, normal};
use moldloft_sketch::*;
use moldloft_testing::{Random, rounds};
use std::f64::consts::{PI, TAU};

fn samples_of(drawn: &Drawn) -> Vec<PenSample> {
    let one = |s: &[f64; 3]| PenSample { at: [s[1], s[2]], time: Some(s[0]), pressure: Some(0.5) };
    drawn.samples.iter().map(one).collect()
}

fn plain(points: &[Place]) -> Vec<PenSample> {
    points.iter().map(|p| PenSample { at: *p, ..PenSample::default() }).collect()
}

fn away(a: Place, b: Place) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// The pieces as they should be, begun at each piece in turn for a closed path; pieces that continue the first one
/// of a closed path are a part of it.
fn expected(drawn: &Drawn) -> Vec<(&'static str, bool)> {
    let kinds = drawn.ways.iter().map(Way::word);
    kinds.zip(drawn.smooth.iter().copied()).collect()
}

/// True if number, kinds and joints of all pieces are right.
fn right(drawn: &Drawn, fit: &StrokeFit) -> bool {
    let mut want = expected(drawn);
    let got: Vec<(&str, bool)> = fit.pieces.iter().map(|p| (p.kind.word(), p.smooth)).collect();
    if fit.closed != drawn.closed || got.len() != want.len() {
        return false;
    }
    let turns = if drawn.closed { want.len() } else { 1 };
    (0..turns).any(|_| {
        want.rotate_left(usize::from(drawn.closed));
        want == got
    })
}

/// Greatest distance of the true path from the pieces.
fn off_path(drawn: &Drawn, fit: &StrokeFit) -> f64 {
    let dense: Vec<Place> = fit.pieces.iter().flat_map(dense).collect();
    let off = |p: Place| dense.iter().map(|q| away(p, *q)).fold(f64::INFINITY, f64::min);
    let path = drawn.ways.iter().flat_map(|w| (0..=20).map(|k| w.at(f64::from(k) / 20.0)));
    path.map(off).fold(0.0, f64::max)
}

fn dense(piece: &StrokePiece) -> Vec<Place> {
    let n = 200;
    let part = |k: i32| f64::from(k) / f64::from(n);
    let p = &piece.points;
    match (piece.kind, piece.centre, piece.half_axes) {
        (StrokeKind::Line, ..) => (0..=n).map(|k| mix(p[0], p[1], part(k))).collect(),
        (StrokeKind::Spline, ..) => (p.windows(4).step_by(3))
            .flat_map(|q| {
                (0..=n).map(|k| {
                    let (s, w) = (part(k), 1.0 - part(k));
                    let b = [w * w * w, 3.0 * w * w * s, 3.0 * w * s * s, s * s * s];
                    [0, 1].map(|x| (0..4).map(|i| b[i] * q[i][x]).sum::<f64>())
                })
            })
            .collect(),
        (_, Some(c), half) => {
            let r = piece.radius.unwrap_or(0.0);
            let [a, b] = half.unwrap_or([[r, 0.0], [0.0, r]]);
            let at = |t: f64| [0, 1].map(|k| c[k] + t.cos() * a[k] + t.sin() * b[k]);
            let turns = (0..=5 * n).map(|k| at(TAU * part(k) / 5.0));
            // Of an arc only the part through its middle: from its ends on, by distance.
            let all: Vec<Place> = turns.collect();
            if p.is_empty() {
                return all;
            }
            let near = |q: Place| {
                (0..all.len()).min_by(|&i, &j| away(all[i], q).total_cmp(&away(all[j], q))).unwrap()
            };
            let [s, m, e] = [p[0], p[1], p[2]].map(near);
            let len = all.len();
            let ahead = |from: usize, to: usize| (to + len - from) % len;
            let (from, count) =
                if ahead(s, m) <= ahead(s, e) { (s, ahead(s, e)) } else { (e, ahead(e, s)) };
            (0..=count).map(|k| all[(from + k) % len]).collect()
        }
        other => panic!("{other:?}"),
    }
}

fn mix(a: Place, b: Place, s: f64) -> Place {
    [0, 1].map(|k| a[k] + s * (b[k] - a[k]))
}

/// Fractions of strokes that are wholly right, by noise and family: a little below those of 250, 100 and 100 strokes each.
const RATES: [(f64, [f64; 12]); 3] = [
    (0.3, [0.98, 0.96, 0.98, 0.97, 0.97, 0.98, 0.60, 0.94, 0.96, 0.96, 0.97, 0.97]),
    (1.0, [0.91, 0.91, 0.94, 0.92, 0.92, 0.95, 0.40, 0.90, 0.86, 0.78, 0.91, 0.94]),
    (2.5, [0.90, 0.56, 0.72, 0.90, 0.91, 0.82, 0.12, 0.86, 0.44, 0.08, 0.90, 0.90]),
];

#[test]
fn ordinary_strokes_are_divided_as_they_are_meant() {
    let count = rounds(15, 1000);
    for (noise, least) in RATES {
        for (family, least) in FAMILIES.into_iter().zip(least) {
            let mut r = Random::new(20 + (10.0 * noise) as u64);
            let (mut good, mut worst, mut noises) = (0, 0.0_f64, 0.0);
            for _ in 0..count {
                let stroke = drawn(&mut r, family, noise);
                let fit = fit_stroke(&samples_of(&stroke)).unwrap();
                noises += fit.noise / count as f64;
                if right(&stroke, &fit) {
                    good += 1;
                    worst = worst.max(off_path(&stroke, &fit));
                }
            }
            let rate = good as f64 / count as f64;
            println!("{noise} {family}: {rate:.3}, at most {worst:.1} off, noise {noises:.2}");
            // Of a small sample less is asked: three standard deviations.
            let spread = 3.0 * (least * (1.0 - least) / count as f64).sqrt();
            assert!(rate >= least - spread, "{noise} {family}: {rate}");
            assert!(worst <= 9.0 + 6.0 * noise, "{noise} {family}: {worst}");
            assert!(
                (0.5 * noise..1.5 * noise + 0.8).contains(&noises),
                "{noise} {family}: {noises}"
            );
        }
    }
}

#[test]
fn sizes_and_places_do_not_matter() {
    let mut r = Random::new(5);
    for family in FAMILIES {
        for _ in 0..rounds(2, 40) {
            let stroke = drawn(&mut r, family, 0.5);
            let samples = samples_of(&stroke);
            let fit = fit_stroke(&samples).unwrap();
            for scale in [1e-7, 1e7] {
                let moved: Vec<PenSample> = (samples.iter())
                    .map(|s| PenSample { at: s.at.map(|x| scale * (x + 30.0)), ..*s })
                    .collect();
                let found = fit_stroke(&moved).unwrap();
                let kinds = |f: &StrokeFit| f.pieces.iter().map(|p| p.kind).collect::<Vec<_>>();
                assert_eq!(kinds(&found), kinds(&fit), "{family}");
                assert!((found.noise / scale - fit.noise).abs() < 1e-6 * fit.noise);
            }
        }
    }
}

#[test]
fn parameters_are_those_of_the_path() {
    let mut r = Random::new(8);
    for k in 0..rounds(20, 400) {
        let circle = drawn(&mut r, "circle", 1.0);
        let fit = fit_stroke(&samples_of(&circle)).unwrap();
        if let [one] = &fit.pieces[..]
            && let (Some(radius), Some(centre)) = (one.radius, one.centre)
        {
            let Way::Arc(c, wanted, ..) = circle.ways[0] else { panic!() };
            assert!((radius - wanted).abs() < 3.0, "{k}: {radius} for {wanted}");
            assert!(away(c, centre) < 3.0, "{k}");
        }
        let ellipse = drawn(&mut r, "ellipse", 1.0);
        let fit = fit_stroke(&samples_of(&ellipse)).unwrap();
        if let [one] = &fit.pieces[..]
            && let Some(half) = one.half_axes
        {
            let Way::Ellipse(_, wanted, ..) = ellipse.ways[0] else { panic!() };
            for (h, w) in half.iter().zip(wanted) {
                let found = h[0].hypot(h[1]);
                assert!((found - w).abs() < 5.0, "{k}: {found} for {w}");
            }
        }
    }
}

#[test]
fn exact_samples_give_exact_shapes() {
    let square = [[0.0, 0.0], [300.0, 0.0], [300.0, 200.0], [0.0, 200.0], [0.0, 0.0]];
    let points: Vec<Place> = (square.windows(2))
        .flat_map(|w| (0..40).map(|k| mix(w[0], w[1], f64::from(k) / 40.0)))
        .chain([[0.0, 0.0]])
        .collect();
    let fit = fit_stroke(&plain(&points)).unwrap();
    assert!(fit.closed && fit.pieces.len() == 4);
    for piece in &fit.pieces {
        for p in &piece.points {
            let off = square.iter().map(|q| away(*p, *q)).fold(f64::INFINITY, f64::min);
            assert!(off < 1e-9, "{p:?}");
        }
    }
    let circle: Vec<Place> = (0..=120)
        .map(|k| TAU * f64::from(k) / 120.0)
        .map(|t| [5.0 + 3.0 * t.cos(), 3.0 * t.sin()])
        .collect();
    let fit = fit_stroke(&plain(&circle)).unwrap();
    assert_eq!(fit.pieces[0].kind, StrokeKind::Circle);
    assert!((fit.pieces[0].radius.unwrap() - 3.0).abs() < 1e-6);
    // Two places are a line.
    let fit = fit_stroke(&plain(&[[1.0, 2.0], [4.0, 6.0]])).unwrap();
    let ends = [[1.0, 2.0], [4.0, 6.0]];
    assert!((0..2).all(|k| away(fit.pieces[0].points[k], ends[k]) < 1e-12));
}

#[test]
fn samples_that_are_no_stroke_are_refused() {
    let none = Err(StrokeFault::NoLength);
    assert_eq!(fit_stroke(&[]), none);
    assert_eq!(fit_stroke(&plain(&[[1.0, 2.0]])), none);
    assert_eq!(fit_stroke(&plain(&[[1.0, 2.0]; 500])), none);
    let bad = plain(&[[0.0, 0.0], [1.0, f64::NAN], [2.0, 0.0]]);
    assert_eq!(fit_stroke(&bad), Err(StrokeFault::NotFinite(1)));
    let huge = plain(&[[-1e308, 0.0], [1e308, 0.0]]);
    assert_eq!(fit_stroke(&huge), none);
    // The pen above the paper draws nothing; late samples are put in order.
    let at = |u: f64, time: f64, pressure: f64| PenSample {
        at: [u, 0.0],
        time: Some(time),
        pressure: Some(pressure),
    };
    let samples = [at(9.0, 3.0, 0.0), at(2.0, 2.0, 0.4), at(0.0, 0.0, 0.3), at(1.0, 1.0, 0.5)];
    assert_eq!(pen_positions(&samples).unwrap(), [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]);
    assert_eq!(pen_positions(&[at(0.0, 0.0, 0.0)]), Err(StrokeFault::NoLength));
}

#[test]
fn any_samples_give_finite_pieces() {
    let mut r = Random::new(77);
    for k in 0..rounds(60, 3000) {
        let n = 2 + r.below(60);
        let step = r.pick(&[0.0, 1e-12, 1.0, 100.0]).to_owned();
        let mut at = [0.0, 0.0];
        let points: Vec<Place> = (0..n)
            .map(|_| {
                at = at.map(|x| x + step * normal(&mut r) + f64::from(r.below(2) as u32));
                at
            })
            .collect();
        let Ok(fit) = fit_stroke(&plain(&points)) else { continue };
        assert!(!fit.pieces.is_empty(), "{k}");
        for piece in &fit.pieces {
            let numbers = piece.points.iter().flatten().chain(piece.centre.iter().flatten());
            assert!(numbers.copied().chain(piece.radius).all(f64::is_finite), "{k}: {piece:?}");
            assert!(piece.residual.is_finite(), "{k}: {piece:?}");
        }
        for pair in fit.pieces.windows(2) {
            assert_eq!(pair[0].points.last(), pair[1].points.first(), "{k}");
        }
    }
}

#[test]
fn a_hundred_thousand_samples_are_a_stroke() {
    let mut r = Random::new(3);
    let points: Vec<Place> = (0..100_000)
        .map(|k| {
            let p = if k < 50_000 { [0.006, 0.0] } else { [0.0, 0.006] };
            let k = f64::from(k);
            let s = (k - 50_000.0).max(0.0);
            let base = [if p[0] > 0.0 { k * 0.006 } else { 300.0 }, s * 0.006];
            [base[0] + 0.2 * normal(&mut r), base[1] + 0.2 * normal(&mut r)]
        })
        .collect();
    let fit = fit_stroke(&plain(&points)).unwrap();
    assert_eq!(fit.pieces.len(), 2);
    assert!(away(fit.pieces[0].points[1], [300.0, 0.0]) < 0.5, "{:?}", fit.pieces);
}

fn typed(samples: &[PenSample]) -> String {
    let samples = pen_positions(samples).unwrap();
    SketchCommand::Stroke { samples }.to_string()
}

fn script_of(s: &SketchSession) -> String {
    script(s.active_object().unwrap())
}

/// A section with a stroke, and the same from the commands in the journal.
#[test]
fn the_journal_has_points_and_lines() {
    let mut r = Random::new(31);
    for family in FAMILIES {
        for _ in 0..rounds(1, 40) {
            let stroke = drawn(&mut r, family, 0.6);
            let mut s = SketchSession::new();
            s.run_line("SKETCH A 2D XZ");
            let replies = s.run_line(&typed(&samples_of(&stroke)));
            assert!(replies.iter().all(|r| !r.is_error()), "{family}: {replies:?}");
            let commands = s.journal()[1].clone();
            assert!(!commands.contains("STROKES"), "{commands}");
            let mut again = SketchSession::new();
            let replies = again.run_text(&format!("SKETCH A 2D XZ\n{commands}"));
            assert!(replies.iter().all(|r| !r.is_error()), "{family}: {replies:?}");
            assert_eq!(script_of(&again), script_of(&s), "{family}");
        }
    }
}

/// Closed outlines drawn in one stroke become solids of nearly the area drawn.
#[test]
fn outlines_become_solids() {
    let mut r = Random::new(12);
    for (family, share) in [("circle", 0.98), ("ellipse", 0.95), ("slot", 0.85), ("half disc", 0.9)]
    {
        let count = rounds(8, 200);
        let mut good = 0;
        for _ in 0..count {
            let stroke = drawn(&mut r, family, 0.6);
            let area: f64 = {
                let path: Vec<Place> = (stroke.ways.iter())
                    .flat_map(|w| (0..400).map(|k| w.at(f64::from(k) / 400.0)))
                    .collect();
                let n = path.len();
                let cross = |k: usize| {
                    let (p, q) = (path[k], path[(k + 1) % n]);
                    p[0] * q[1] - p[1] * q[0]
                };
                (0..n).map(cross).sum::<f64>().abs() / 2.0
            };
            let mut s = SketchSession::new();
            s.run_text("SKETCH A 2D XZ");
            s.run_line(&typed(&samples_of(&stroke)));
            s.run_text("ACCEPT ALL; GENERATE FACES; EXTRUDE 1");
            let volume = s.objects()[0].volume;
            good += usize::from(volume.is_some_and(|v| (v / area - 1.0).abs() < 0.06));
        }
        println!("{family}: {good} of {count} solids");
        assert!(good as f64 >= share * count as f64 - 1.5, "{family}: {good} of {count}");
    }
}

#[test]
fn a_stroke_ends_at_points_of_the_drawing() {
    let mut s = SketchSession::new();
    s.run_text("SKETCH A 2D XZ; POINT 1 10 20; POINT 2 310 22; LINE 1 2");
    let way = [[12.0, 22.0], [11.0, 220.0], [309.0, 219.0], [309.5, 24.0]];
    let points: Vec<Place> = (way.windows(2))
        .flat_map(|w| (0..30).map(|k| mix(w[0], w[1], f64::from(k) / 30.0)))
        .chain([way[3]])
        .collect();
    s.run_line(&typed(&plain(&points)));
    let drawing = &s.active_object().unwrap().drawing;
    assert_eq!((drawing.points.len(), drawing.lines.len()), (4, 4), "{drawing:?}");
    s.run_text("ACCEPT ALL; EXTRUDE 10");
    assert!(s.objects()[0].volume.is_some());
}

#[test]
fn a_picture_of_a_solid_refuses_curves_by_name() {
    let arc: Vec<Place> =
        (0..60).map(|k| 0.05 * f64::from(k)).map(|t| [90.0 * t.cos(), 90.0 * t.sin()]).collect();
    let mut s = SketchSession::new();
    s.run_line("SKETCH A");
    let reply = s.run_line(&typed(&plain(&arc))).pop().unwrap();
    assert!(reply.is_error() && reply.text.contains("an arc"), "{reply:?}");
    assert!(s.active_object().unwrap().drawing.points.is_empty());
    // A corner that the pen rounds is drawn as a corner, with a remark.
    let rounded: Vec<Place> = (0..40)
        .map(|k| [5.0 * f64::from(k), 0.0])
        .chain((0..30).map(|k| {
            let t = -0.5 * PI + 0.5 * PI * f64::from(k) / 30.0;
            [200.0 + 60.0 * t.cos(), 60.0 + 60.0 * t.sin()]
        }))
        .chain((0..40).map(|k| [260.0, 60.0 + 5.0 * f64::from(k)]))
        .collect();
    let replies = s.run_line(&typed(&plain(&rounded)));
    assert!(replies.iter().any(|r| r.text.contains("drawn sharp")), "{replies:?}");
    assert_eq!(s.active_object().unwrap().drawing.points.len(), 3);
    let mut t = SketchSession::new();
    t.run_line("SKETCH A 2D XZ");
    t.run_line(&typed(&plain(&rounded)));
    let object = t.active_object().unwrap();
    assert_eq!((object.curves.len(), object.drawing.points.len()), (1, 3), "{}", script(object));
    let refused = t.run_line("STROKES SAMPLES 1 2").pop().unwrap();
    assert_eq!((refused.is_error(), refused.code), (true, Some(300)));
}
