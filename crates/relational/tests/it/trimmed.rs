//! Trimmed faces: triangles within the promise, exact measures, and their derivatives, against closed forms.

use crate::common::{Scene, run, scene};
use moldloft_num::{Dual4, Real};
use moldloft_registry::{SheetMeasures, TriangleBody, Value};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

fn body(scene: &Scene<f64>, name: &str) -> Arc<TriangleBody<f64>> {
    match scene.value(name) {
        Value::Body(body) => body.clone(),
        _ => panic!("{name} is no body"),
    }
}

fn exact(body: &TriangleBody<f64>) -> SheetMeasures<f64> {
    body.measures().expect("finite measures")
}

/// A strip between helices of radii 3 and 2.5 on one axis, `turns` turns of pitch 1, cut at 5 and 95 % and at 10 and 90 %.
fn strip(turns: f64) -> String {
    format!(
        "AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line ax(O, Z); AbsPoint P(3, 0, 0); AbsPoint Q(2.5, 0, 0.3);
         Helix a(P, ax, {angle}, 1); Helix b(Q, ax, {angle}, 1); RuledSurf S(a, b);
         AbsMagnet p(S, 0.05, 0.1); AbsMagnet q(S, 0.95, 0.1); AbsMagnet r(S, 0.95, 0.9); AbsMagnet s(S, 0.05, 0.9);
         LineSnake pq(p, q); LineSnake qr(q, r); LineSnake rs(r, s); LineSnake sp(s, p);
         TrimSurf T(S, {{pq, qr, rs, sp}});",
        angle = turns * TAU
    )
}

/// Its area: the integrand does not depend on u.
fn strip_area(turns: f64) -> f64 {
    let (n, k, rise) = (2000, TAU * turns, turns);
    let at = |v: f64| {
        let r = 3.0 - 0.5 * v;
        (0.3 * r * k).hypot(0.5 * rise).hypot(0.5 * r * k)
    };
    let step = 0.8 / f64::from(n);
    0.9 * step * (0..n).map(|i| at(0.1 + (f64::from(i) + 0.5) * step)).sum::<f64>()
}

#[test]
fn strips_of_many_turns() {
    for turns in [0.5, 2.0, 4.0, 10.0, 50.0] {
        let part = body(&scene(&strip(turns)), "T");
        let area = strip_area(turns);
        let (panels, measured) = (part.of_triangles.area, exact(&part).area);
        assert!((panels / area - 1.0).abs() < 1e-3, "{turns} turns: {panels} for {area}");
        assert!((measured / area - 1.0).abs() < 1e-8, "{turns} turns: {measured} for {area}");
        let most = 1000.0 * turns + 400.0;
        assert!((part.triangles.len() as f64) < most, "{turns}: {}", part.triangles.len());
    }
}

/// A disc of radius 2 in a plane, and the frame round it.
#[test]
fn discs_and_frames() {
    let text = "AbsPoint A(0, 0, 1); AbsPoint B(10, 0, 1); AbsPoint C(0, 10, 1); AbsPoint D(10, 10, 1); Line l(A, B);
        Line m(C, D); RuledSurf S(l, m); AbsMagnet a(S, 0.5, 0.5); AbsMagnet b(S, 0.7, 0.5); AbsMagnet c(S, 0.5, 0.7);
        ArcSnake round(b, a, c, type = 6); TrimSurf disc(S, {round}); TrimSurf frame(S, {round}, whole = 1);";
    let scene = scene(text);
    for (name, area) in [("disc", 4.0 * PI), ("frame", 100.0 - 4.0 * PI)] {
        let part = body(&scene, name);
        let (panels, measured) = (part.of_triangles.area, exact(&part));
        assert!((panels / area - 1.0).abs() < 1e-3, "{name}: {panels} for {area}");
        assert!((measured.area / area - 1.0).abs() < 1e-9, "{name}: {measured:?} for {area}");
        assert!((measured.volume - area / 3.0).abs() < 1e-8, "{name}: {measured:?}");
        assert!(
            (measured.centroid.x - 5.0).abs() < 1e-8 && (measured.centroid.z - 1.0).abs() < 1e-9
        );
    }
}

/// A zone of a sphere of radius 1 with two poles: all of it, and a band so narrow that its rims are nearer to each other
/// than to their chords.
#[test]
fn zones_of_spheres() {
    for (low, high) in [(0.1, 0.9), (0.4, 0.4 + 5e-4), (0.01, 0.99)] {
        let text = format!(
            "AbsPoint S0(0, 0, -1); AbsPoint E(1, 0, 0); AbsPoint N(0, 0, 1); Arc m(S0, E, N); Line ax(S0, N);
             RevSurf S(m, ax, 0, {TAU}); AbsMagnet p(S, {low}, 0.1); AbsMagnet q(S, {high}, 0.1);
             AbsMagnet r(S, {high}, 0.9); AbsMagnet s(S, {low}, 0.9);
             LineSnake pq(p, q); LineSnake qr(q, r); LineSnake rs(r, s); LineSnake sp(s, p);
             TrimSurf T(S, {{pq, qr, rs, sp}});"
        );
        let part = body(&scene(&text), "T");
        // Archimedes: the area is 2 pi times the height.
        let height = |t: f64| -(t * PI).cos();
        let area = 0.8 * TAU * (height(high) - height(low));
        let (panels, measured) = (part.of_triangles.area, exact(&part).area);
        assert!((panels / area - 1.0).abs() < 1e-3, "{low} {high}: {panels} for {area}");
        assert!((measured / area - 1.0).abs() < 1e-9, "{low} {high}: {measured} for {area}");
    }
}

/// The measures of a part across a kink of its surface, and their derivatives when the trim moves over it.
#[test]
fn parts_across_a_kink() {
    // A roof: two planes that meet at x = 2; its part between x = 1 and x = 3 at y = 0, x = 1 and x = 2.5 at y = 1.
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 2); AbsPoint C(4, 0, 0); Line l(A, B); Line m(B, C); PolyCurve r({l, m});
        AbsPoint O(0, 0, 0); AbsPoint P(0, 1, 0); Line d(O, P); TranSurf S(r, d); AbsMagnet p(S, 0.25, 0);
        AbsMagnet q(S, 0.75, 0); AbsMagnet t(S, 0.625, 1); AbsMagnet s(S, 0.25, 1);
        LineSnake pq(p, q); LineSnake qt(q, t); LineSnake ts(t, s); LineSnake sp(s, p); TrimSurf T(S, {pq, qt, ts, sp});";
    let part = body(&scene(text), "T");
    let area = 2f64.sqrt() * 1.75;
    assert!((exact(&part).area - area).abs() < 1e-12, "{:?}", exact(&part));
    assert!((part.of_triangles.area - area).abs() < 1e-3 * area, "{}", part.of_triangles.area);
    // The z moment jumps at the kink: its derivative with respect to the position of the corner at
    // u = 0.625.
    let moment = |u: f64, seed: bool| -> (f64, f64) {
        let scene = run::<Dual4>(text, &mut |_, x| {
            let here = x == 0.625;
            Dual4::from_parts(|k| {
                if k == 0 { if here { u } else { x } } else { f64::from(here && seed && k == 1) }
            })
        });
        let scene = scene.unwrap_or_else(|fault| panic!("{fault:?}"));
        let Value::Body(body) = scene.value("T") else { panic!() };
        let m = body.measures().unwrap();
        let z = m.centroid.z * m.area;
        (z.re(), z.part(1))
    };
    let step = 1e-5;
    let found = moment(0.625, true).1;
    let difference = (moment(0.625 + step, false).0 - moment(0.625 - step, false).0) / (2.0 * step);
    assert!((found - difference).abs() < 1e-7, "{found} {difference}");
}
