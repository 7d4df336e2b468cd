//! Lofts, sweeps, fillets and patches with known numbers, and their errors.

use crate::common::{fault, scene};
use moldloft_num::trace::Edge;
use moldloft_num::{Order, Vec3};
use moldloft_registry::SurfaceRef;
use std::f64::consts::PI;

fn at(s: &SurfaceRef<f64>, u: f64, v: f64) -> Vec3 {
    s.jet(u, v, Order::Zero).p
}

fn near(p: Vec3, x: f64, y: f64, z: f64, accuracy: f64) {
    assert!(p.distance(Vec3::of(x, y, z)) <= accuracy, "{p:?} and {:?}", (x, y, z));
}

const GRID: [f64; 5] = [0.0, 0.2, 0.5, 0.9, 1.0];

fn places() -> impl Iterator<Item = (f64, f64)> {
    GRID.into_iter().flat_map(|u| GRID.into_iter().map(move |v| (u, v)))
}

#[test]
fn an_arc_loft_is_a_cone() {
    let scene = scene(
        "AbsPoint A(1, 0, 0); AbsPoint B(0, 1, 0); AbsPoint C(-1, 0, 0); AbsPoint D(2, 0, 3);
         AbsPoint E(0, 2, 3); AbsPoint F(-2, 0, 3); Line a(A, D); Line b(B, E); Line c(C, F);
         ArcLoftSurf cone(a, b, c); AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 3); Line axis(O, Z);
         ArcLoftSurf round(a, axis, b, 6);",
    );
    let cone = scene.surface("cone");
    for (u, v) in places() {
        let (r, angle) = (1.0 + u, PI * v);
        near(at(cone, u, v), r * angle.cos(), r * angle.sin(), 3.0 * u, 1e-14);
        near(
            at(scene.surface("round"), u, v),
            r * (2.0 * angle).cos(),
            r * (2.0 * angle).sin(),
            3.0 * u,
            1e-14,
        );
    }
    assert_eq!(scene.surface("round").edges().edges[2], Edge::SameAs(0));
}

#[test]
fn arc_lofts_name_where_points_are_in_line() {
    let fault = fault(
        "AbsPoint A(0, 0, 0); AbsPoint B(-1, 1, 0); AbsPoint C(2, 0, 0); AbsPoint D(0, 0, 4);
         AbsPoint E(-1, -1, 4); AbsPoint F(2, 0, 4); Line a(A, D); Line b(B, E); Line c(C, F);
         ArcLoftSurf S(a, b, c);",
    );
    assert_eq!(
        (fault.id, fault.message.as_str()),
        ("collinear-points", "the radius is unbounded at u = 0.5")
    );
}

#[test]
fn an_explicit_loft_is_linear_in_its_axis() {
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 1, 0); AbsPoint C(2, 8, 0); AbsPoint D(4, 64, 0);
         AbsPoint E(0, 0, 1); AbsPoint F(1, 1, 1); AbsPoint G(2, 8, 1); AbsPoint H(4, 64, 1);
         Line a(A, E); Line b(B, F); Line c(C, G); Line d(D, H); XLoftSurf S(1, {a, b, c, d});",
    );
    // y = x^3 through four points, not-a-knot: one cubic.
    for (u, v) in places() {
        let x = 4.0 * v;
        near(at(scene.surface("S"), u, v), x, x * x * x, u, 1e-13);
    }
    let fault = fault(
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 1, 0); AbsPoint C(2, 8, 0); AbsPoint E(0, 0, 1);
         AbsPoint F(2.5, 1, 1); AbsPoint G(2, 8, 1); Line a(A, E); Line b(B, F); Line c(C, G);
         XLoftSurf S(1, {a, b, c});",
    );
    assert_eq!((fault.id, fault.item()), ("not-monotone", Some(2)));
    assert!(fault.message.contains("u = 0.75"), "{}", fault.message);
}

#[test]
fn a_clamped_loft_has_its_slopes() {
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 1, 0); AbsPoint C(3, 0, 0); AbsPoint D(0, 0, 1);
         AbsPoint E(1, 2, 1); AbsPoint F(3, 0, 1); Line a(A, D); Line b(B, E); Line c(C, F);
         CLoftSurf S({a, b, c}, ends = \"clamped\", start = {0, 2, 0.5}, end = {1, 0, 0});",
    );
    for u in GRID {
        let s = scene.surface("S");
        near(s.jet(u, 0.0, Order::First).v, 0.0, 2.0, 0.5, 1e-13);
        near(s.jet(u, 1.0, Order::First).v, 1.0, 0.0, 0.0, 1e-13);
    }
}

#[test]
fn a_quarter_cylinder_is_a_nurbs() {
    let scene = scene(
        "AbsPoint A(1, 0, 0); AbsPoint B(1, 1, 0); AbsPoint C(0, 1, 0); AbsPoint D(1, 0, 2);
         AbsPoint E(1, 1, 2); AbsPoint F(0, 1, 2);
         NURBSurf S({A, B, C, D, E, F}, nu = 2, nv = 3, degree_u = 1, degree_v = 2,
                    weights = {1, 0.7071067811865476, 1, 1, 0.7071067811865476, 1},
                    knots_v = {-1, -1, -1, 3, 3, 3});",
    );
    let s = scene.surface("S");
    for (u, v) in places() {
        let p = at(s, u, v);
        assert!((p.x.hypot(p.y) - 1.0).abs() < 1e-15 && (p.z - 2.0 * u).abs() < 1e-15);
    }
    assert_eq!(s.edges().corners[2], Some(scene.key("F")));
}

#[test]
fn a_sweep_along_a_circle_is_a_torus() {
    let circle =
        "AbsPoint A(5, 0, 0); AbsPoint O(0, 0, 0); AbsPoint Y(0, 1, 0); Arc path(A, O, Y, 6);
         AbsPoint B(6, 0, 0); AbsPoint Z(5, 0, 1); Arc profile(B, A, Z, 6);";
    for frame in ["", ", \"up\"", ", \"up\", up = {0, 0, 2}"] {
        let scene = scene(&format!("{circle} SweepSurf torus(profile, path{frame});"));
        let torus = scene.surface("torus");
        for (u, v) in places() {
            let (a, b) = (2.0 * PI * u, 2.0 * PI * v);
            let r = 5.0 + a.cos();
            near(at(torus, u, v), r * b.cos(), r * b.sin(), a.sin(), 1e-9);
        }
        assert_eq!(torus.edges().edges[1], Edge::SameAs(3));
        assert!(matches!(torus.edges().edges[0], Edge::Pieces(_)));
    }
}

/// A minimal frame turns about the tangent of a helix against Frenet's by the integral of the
/// torsion.
#[test]
fn the_minimal_frame_of_a_helix() {
    // A helix of radius 1 and pitch 2 pi c as a fine interpolating spline would have its own error;
    // a cubic has torsion, too: x = (t, t^2, t^3), whose frames come from a fine integration here.
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(0.3333333333333333, 0, 0);
         AbsPoint C(0.6666666666666666, 0.3333333333333333, 0); AbsPoint D(1, 1, 1);
         BCurve path({A, B, C, D}); AbsPoint P(0, 1, 0); AbsPoint Q(0, 0, 1); Line profile(P, Q);
         SweepSurf S(profile, path);",
    );
    let tangent = |t: f64| Vec3::of(1.0, 2.0 * t, 3.0 * t * t).normalized().unwrap();
    // r' = -(r . T') T by Runge and Kutta, 4th order, 4000 steps.
    let turn = |t: f64, r: Vec3| {
        let h = 1e-6;
        let d = (tangent(t + h) - tangent(t - h)) / (2.0 * h);
        tangent(t) * -r.dot(d)
    };
    let n = 4000;
    let h = 1.0 / f64::from(n);
    let mut r = Vec3::of(0.0, 1.0, 0.0);
    for k in 0..n {
        let t = f64::from(k) * h;
        let k1 = turn(t, r);
        let k2 = turn(t + h / 2.0, r + k1 * (h / 2.0));
        let k3 = turn(t + h / 2.0, r + k2 * (h / 2.0));
        let k4 = turn(t + h, r + k3 * h);
        r += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
    }
    let s = scene.surface("S");
    let found = at(s, 0.0, 1.0) - Vec3::of(1.0, 1.0, 1.0);
    assert!(found.distance(r) < 2e-8, "{found:?} {r:?}");
    assert!(at(s, 0.7, 0.0).distance(scene.curve("profile").jet(0.7, Order::Zero)[0]) < 1e-13);
}

#[test]
fn twist_and_scale_are_laws() {
    let scene = scene(
        "AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 2); Line path(O, Z); AbsPoint X(1, 0, 0); Line profile(O, X);
         SweepSurf S(profile, path, twist = {0, 1.5}, scale = {1, 0.5}); SweepSurf cone(profile, path, scale = {1, 0});
         SweepSurf plain(profile, path);",
    );
    for (u, v) in places() {
        let (r, angle) = (u * (1.0 - 0.5 * v), 1.5 * v);
        near(at(scene.surface("S"), u, v), r * angle.cos(), r * angle.sin(), 2.0 * v, 1e-14);
        near(at(scene.surface("plain"), u, v), u, 0.0, 2.0 * v, 1e-14);
    }
    let plain = scene.surface("plain").edges();
    assert!(matches!(plain.edges[3], Edge::Pieces(_)) && plain.corners[3] == Some(scene.key("Z")));
    assert_eq!(scene.surface("cone").edges().edges[2], Edge::Pole(Some(scene.key("Z"))));
}

#[test]
fn sweeps_say_where_the_path_fails() {
    let base = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(1, 1, 0); AbsPoint Z(0, 0, 1);
         Line profile(A, Z); Line l(A, B); CCurve bent({A, B, C}, 1); AbsPoint S(1, 0, 0); Line dot(B, S);
         Line upright(A, Z);";
    for (text, id, field) in [
        ("SweepSurf S(profile, bent);", "corner-in-path", 1),
        ("SweepSurf S(profile, dot);", "zero-tangent", 1),
        ("SweepSurf S(l, upright, \"up\");", "no-frame", 1),
        ("SweepSurf S(profile, l, \"down\");", "unknown-frame", 2),
        ("SweepSurf S(profile, l, up = {0, 0, 1});", "unused-argument", 3),
        ("SweepSurf S(profile, l, twist = {});", "too-few-items", 4),
    ] {
        let fault = fault(&format!("{base} {text}"));
        assert_eq!((fault.id, fault.field().unwrap()), (id, field), "{text} {fault:?}");
    }
}

const CORNER: &str = "AbsPoint A(0, -2, 0); AbsPoint B(4, -2, 0); AbsPoint C(0, 0, 0); AbsPoint D(4, 0, 0);
    AbsPoint E(0, 0, 2); AbsPoint F(4, 0, 2); Line a(A, B); Line c(C, D); Line e(E, F); RuledSurf floor(a, c);
    RuledSurf wall(c, e); UVSnake low(floor, \"v\", 0.5); UVSnake high(wall, \"v\", 0.5);";

#[test]
fn a_fillet_is_tangent_and_nearly_round() {
    let scene = scene(&format!(
        "{CORNER} FilletSurf S(low, high, 1.1715728752538097, 1.1715728752538097);
         FilletSurf back(high, low); FilletSurf G2(low, high, continuity = 2);"
    ));
    let s = scene.surface("S");
    for u in GRID {
        near(at(s, u, 0.0), 4.0 * u, -1.0, 0.0, 1e-15);
        near(at(s, u, 1.0), 4.0 * u, 0.0, 1.0, 1e-15);
        let (low, high) = (s.jet(u, 0.0, Order::First).v, s.jet(u, 1.0, Order::First).v);
        assert!(low.x.abs() < 1e-15 && low.z.abs() < 1e-15 && low.y > 0.0);
        assert!(high.x.abs() < 1e-15 && high.y.abs() < 1e-15 && high.z > 0.0);
        for v in GRID {
            // The circle about (-1, 1) of radius 1: a cubic comes within 2.8e-4 (Goldapp 1991).
            let p = at(s, u, v);
            assert!(((p.y + 1.0).hypot(p.z - 1.0) - 1.0).abs() < 2.8e-4);
        }
        let bent = scene.surface("G2").jet(u, 0.0, Order::Second);
        // The floor is flat.
        assert!(bent.vv.norm() < 1e-12);
    }
    assert!(matches!(&s.edges().edges[0], Edge::Pieces(p) if p[0].from.t == 0.0));
    near(at(scene.surface("back"), 0.5, 0.0), 2.0, 0.0, 1.0, 1e-15);
}

/// The normal curvature across is that of both cylinders.
#[test]
fn a_curved_fillet_takes_on_curvature() {
    let scene = scene(
        "AbsPoint A(1, 0, 0); AbsPoint O(0, 0, 0); AbsPoint B(0, 1, 0); AbsPoint Z(0, 0, 3); Arc c(A, O, B, 6);
         Line l(O, Z); TranSurf pipe(c, l); AbsPoint F(3, 0, 0); Arc rim(F, O, B, 6); RuledSurf floor(rim, c);
         AbsMagnet g(pipe, 0, 0.3); AbsMagnet h(pipe, 1, 0.2); LineSnake k(g, h); UVSnake low(floor, \"v\", 0.6);
         FilletSurf S(k, low, continuity = 2);",
    );
    let (s, pipe) = (scene.surface("S"), scene.surface("pipe"));
    for u in [0.0, 0.3, 1.0] {
        let jet = s.jet(u, 0.0, Order::Second);
        let w = scene.curve("k").on_surface(u, Order::Zero).unwrap()[0];
        let parent = pipe.jet(w.x, w.y, Order::First);
        let n = parent.normal();
        assert!(jet.normal().cross(n).norm() < 1e-12);
        // For a unit cylinder: minus the square of the circumferential part.
        let radial = Vec3::<f64>::of(n.x, n.y, 0.0);
        let round = Vec3::of(-radial.y, radial.x, 0.0);
        let expected = -jet.v.dot(round).powi(2) / jet.v.norm_sq();
        let found = jet.vv.dot(n) / jet.v.norm_sq();
        assert!((found - expected).abs() < 1e-10, "{found} {expected}");
    }
}

#[test]
fn fillets_that_turn_back_are_refused() {
    for (text, id, field) in [
        ("FilletSurf S(low, high, 9);", "fillet-turns-back", 2),
        ("FilletSurf S(low, high, direction1 = \"along\");", "unknown-direction", 5),
        ("FilletSurf S(low, high, closed = 1);", "not-closed", 7),
        (
            "AbsMagnet p(wall, 1, 0.2); AbsMagnet q(wall, 0, 0.6); LineSnake x(p, q); FilletSurf S(x, low, direction1 = \"u\");",
            "fillet-turns-back",
            0,
        ),
        (
            "AbsPoint Z(2, 0, 2); Line d(E, Z); AbsPoint Y(0, 0, 2); Line dot(E, Y); RuledSurf tip(c, dot); UVSnake t(tip, \"v\", 1); FilletSurf S(t, low);",
            "no-tangent",
            0,
        ),
    ] {
        let fault = fault(&format!("{CORNER} {text}"));
        assert_eq!((fault.id, fault.field().unwrap()), (id, field), "{text} {fault:?}");
    }
}

/// A ring round a pipe on a floor: directions that follow parameter lines close it.
#[test]
fn a_closed_fillet_is_one_line_at_its_ends() {
    let scene = scene(
        "AbsPoint A(1, 0, 0); AbsPoint O(0, 0, 0); AbsPoint B(0, 1, 0); AbsPoint Z(0, 0, 3); Arc c(A, O, B, 6);
         Line l(O, Z); TranSurf pipe(c, l); AbsPoint F(3, 0, 0); Arc rim(F, O, B, 6); RuledSurf floor(rim, c);
         UVSnake high(pipe, \"v\", 0.2); UVSnake low(floor, \"v\", 0.7); FilletSurf S(low, high, closed = 1);",
    );
    let s = scene.surface("S");
    assert_eq!(s.edges().edges[1], Edge::SameAs(3));
    for (u, v) in places() {
        let p = at(s, u, v);
        let r = p.x.hypot(p.y);
        let along = at(s, 0.0, v);
        assert!((r - along.x).abs() < 1e-12 && (p.z - along.z).abs() < 1e-12);
    }
}

#[test]
fn coons_patches_of_straight_and_curved_sides() {
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(4, 3, 1); AbsPoint D(0, 3, 0); AbsPoint M(2, 0, 2);
         Line ab(A, B); Line bc(B, C); Line dc(D, C); Line ad(A, D); BlendSurf flat({ab, bc, dc, ad});
         BCurve arch({A, M, B}, 2); BlendSurf S({arch, bc, dc, ad}); AbsPoint top(2, 1.5, 5);
         BlendCenter dome({arch, bc, dc, ad}, top); Line ac(A, C); BlendSurf fan({ab, bc, ac});",
    );
    for (u, v) in places() {
        near(at(scene.surface("flat"), u, v), 4.0 * u, 3.0 * v, u * v, 1e-14);
        let lift = 4.0 * u * (1.0 - u) * (1.0 - v);
        near(at(scene.surface("S"), u, v), 4.0 * u, 3.0 * v, u * v + lift, 1e-14);
    }
    near(at(scene.surface("dome"), 0.5, 0.5), 2.0, 1.5, 5.0, 1e-14);
    for t in GRID {
        for (u, v) in [(t, 0.0), (1.0, t), (t, 1.0), (0.0, t)] {
            let d = at(scene.surface("dome"), u, v).distance(at(scene.surface("S"), u, v));
            assert!(d < 1e-14);
        }
        near(at(scene.surface("fan"), 0.0, t), 0.0, 0.0, 0.0, 1e-15);
    }
    assert_eq!(scene.surface("fan").edges().edges[3], Edge::Pole(Some(scene.key("A"))));
}

#[test]
fn coons_patches_must_meet_at_their_corners() {
    let base = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(4, 3, 1); AbsPoint D(0, 3, 0); AbsPoint E(0, 3, 1e-3);
         Line ab(A, B); Line bc(B, C); Line dc(D, C); Line ad(A, D); Line ae(A, E); Line cd(C, D);";
    let open = fault(&format!("{base} BlendSurf S({{ab, bc, dc, ae}});"));
    assert_eq!((open.id, open.item()), ("open-corner", Some(3)));
    let turned = fault(&format!("{base} BlendSurf S({{ab, bc, cd, ad}});"));
    assert_eq!(turned.help[0], "they do when these sides are reversed: 3");
    assert_eq!(fault(&format!("{base} BlendSurf S({{ab, bc, cd, ad, ab}});")).id, "wrong-length");
    assert_eq!(fault(&format!("{base} BlendSurf S({{ab, bc}});")).id, "too-few-items");
}

#[test]
fn images_of_surfaces() {
    let scene = scene(
        "AbsPoint A(1, 2, 0); AbsPoint B(2, 1, 0.5); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3);
         BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line z(O, Z);
         RotatSurf turned(S, z, 1.5707963267948966); AbsPoint T(10, 0, 0); CopySurf copy(S, O, T, 2, 3, -1);
         ProjSurf flat(S, \"z=0\"); AbsPoint P(1, 2, 1); AbsPoint Q(0, 0, 3); RelSurf moved(S, P, C, E, Q);",
    );
    for (u, v) in places() {
        let p = at(scene.surface("S"), u, v);
        near(at(scene.surface("turned"), u, v), -p.y, p.x, p.z, 1e-14);
        near(at(scene.surface("copy"), u, v), 10.0 + 2.0 * p.x, 3.0 * p.y, -p.z, 1e-14);
        near(at(scene.surface("flat"), u, v), p.x, p.y, 0.0, 1e-15);
        near(at(scene.surface("moved"), u, v) - p, 0.0, 0.0, 1.0 - u, 1e-14);
    }
    assert_eq!(scene.surface("turned").image_of(), Some((scene.key("S"), false)));
    assert_eq!(scene.surface("copy").image_of(), Some((scene.key("S"), true)));
}

#[test]
fn folded_sub_surfaces_are_refused() {
    let base = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0); AbsPoint D(4, 3, 0); Line a(A, B); Line b(C, D);
         RuledSurf S(a, b); AbsMagnet p(S, 0.1, 0.1); AbsMagnet q(S, 0.9, 0.1); AbsMagnet r(S, 0.9, 0.9); AbsMagnet s(S, 0.1, 0.9);
         LineSnake pq(p, q); LineSnake sr(s, r); LineSnake rs(r, s); LineSnake qr(q, r); LineSnake ps(p, s);";
    let crossed = fault(&format!("{base} SubSurf c({{pq, rs}});"));
    assert_eq!(crossed.id, "folded-patch", "{crossed:?}");
    // Against the run of the surface all over is not a fold.
    scene(&format!(
        "{base} SubSurf c({{sr, pq}}); SubSurf d({{ps, sr, qr, pq}}); SubSurf e({{pq, r}});"
    ));
    let bent = fault(&format!(
        "{base} AbsMagnet m(S, 0.5, 2.6); BSnake up({{p, m, q}}, 2); SubSurf c({{up, sr}});"
    ));
    assert_eq!(bent.id, "folded-patch");
    assert!(bent.found.as_ref().unwrap().contains("Jacobian of -"), "{bent:?}");
}
