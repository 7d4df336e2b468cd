//! Points, curves, snakes and frames whose numbers are known.

use crate::common::{fault, scene};
use moldloft_num::trace::{Root, Trace};
use moldloft_num::{Order, Vec3};
use moldloft_registry::{CurveRef, Value};
use moldloft_spline::arclen;
use std::f64::consts::PI;

fn at(c: &CurveRef<f64>, t: f64) -> Vec3 {
    c.jet(t, Order::Zero)[0]
}

fn near(p: Vec3, x: f64, y: f64, z: f64, accuracy: f64) {
    assert!(p.distance(Vec3::of(x, y, z)) <= accuracy, "{p:?} and {:?}", (x, y, z));
}

#[test]
fn frames_place_their_points() {
    let scene = scene(
        "AbsPoint O(1, 2, 3); AbsPoint X(1, 5, 3); AbsPoint Y(0, 2, 3); ThreePointFrame f(O, X, Y);
         FramePoint a(O, f, 1, 2, 4); FramePoint b(frame = f, a = 1); FramePoint c(O, X, 1, 2, 4);
         FramePoint d(O, f, 2, 1.5707963267948966, 1, 1); FramePoint e(O, f, 2, 0, 0.5235987755982989, 2);
         PolarPoint g(O, f, 2, 0, 0.5235987755982989); FramePoint h(c = 5);
         RPYFrame yawed(O, 0, 0, 1.5707963267948966); FramePoint i(O, yawed, 1, 0, 0);
         RPYFrame rolled(O, 1.5707963267948966, 0, 1.5707963267948966); FramePoint j(O, rolled, 0, 1, 0);
         RPYFrame pitched(O, 0, 1.5707963267948966); FramePoint k(O, pitched, 1, 0, 0);",
    );
    let (s, c) = (1.0, 3f64.sqrt());
    for (name, x, y, z) in [
        // x of f is the world's y, y of f its -x.
        ("a", -1.0, 3.0, 7.0),
        ("b", 1.0, 3.0, 3.0),
        // A point in place of a frame: the axes of the world.
        ("c", 2.0, 4.0, 7.0),
        ("d", -1.0, 2.0, 4.0),
        ("e", 1.0, 2.0 + c, 3.0 + s),
        ("g", 1.0, 2.0 + c, 3.0 + s),
        ("h", 0.0, 0.0, 5.0),
        ("i", 1.0, 3.0, 3.0),
        // Yaw first, then roll about the new x: y of the frame points up.
        ("j", 1.0, 2.0, 4.0),
        // A positive pitch puts the nose down in axes with z up.
        ("k", 1.0, 2.0, 2.0),
    ] {
        near(scene.point(name).xyz, x, y, z, 1e-14);
    }
}

#[test]
fn points_made_from_others() {
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0); AbsPoint D(4, 3, 0);
         Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.5, 0.5);
         OffsetPoint up(p, 2); AbsBead b(l, 0.25); TanPoint t(b, 2.5); RotatPoint r(D, l, 1.5707963267948966);
         CopyPoint c(D, B, C, 2, 3, 1); BlendPoint fourth({A, B, D}, {1, -1, 1}); BlendPoint mean({A, B, C, D});
         CentroidPoint q({A, B, C}); CentroidPoint bent({l, m}); CentroidPoint flat({S});
         AbsPoint E(8, 0, 0); Line n(A, E); CentroidPoint two({l, n}); TanPlane touching(p);
         NormalPlane across(b); PlaneThroughPoint parallel(D, across); ProjPoint f(E, parallel);
         Arc half(B, A, C, 2); Line axis(A, C); Arc ring(A, B, D); CentroidPoint arc({half});",
    );
    for (name, x, y, z) in [
        ("up", 2.0, 1.5, 2.0),
        ("t", 3.5, 0.0, 0.0),
        ("r", 4.0, 0.0, 3.0),
        ("c", 0.0, 12.0, 0.0),
        ("fourth", 0.0, 3.0, 0.0),
        ("mean", 2.0, 1.5, 0.0),
        ("q", 4.0 / 3.0, 1.0, 0.0),
        ("bent", 2.0, 1.5, 0.0),
        ("flat", 2.0, 1.5, 0.0),
        ("two", 10.0 / 3.0, 0.0, 0.0),
        ("f", 4.0, 0.0, 0.0),
        // A quarter of a circle of radius 4: 2 r / pi from both axes.
        ("arc", 8.0 / PI, 8.0 / PI, 0.0),
    ] {
        near(scene.point(name).xyz, x, y, z, 1e-11);
    }
    let Value::Plane(touching) = scene.value("touching") else { panic!("a plane") };
    assert_eq!(touching.normal, Vec3::of(0.0, 0.0, 1.0));
}

#[test]
fn at_a_pole_the_normal_is_the_limit() {
    let scene = scene(
        "AbsPoint S(0, 0, -2); AbsPoint N(0, 0, 2); AbsPoint X(1, 0, 0); Arc meridian(S, N, X, 5);
         Line axis(S, N); RevSurf globe(meridian, axis); AbsMagnet south(globe, 0, 0.3);
         AbsMagnet north(globe, 1, 0.7); AbsMagnet side(globe, 0.5, 0);
         OffsetPoint below(south, 1); OffsetPoint above(north, 1); OffsetPoint beside(side, 1);",
    );
    let sign = scene.point("beside").xyz.x - 2.0;
    assert!((sign.abs() - 1.0).abs() < 1e-14);
    near(scene.point("below").xyz, 0.0, 0.0, -2.0 - sign, 1e-9);
    near(scene.point("above").xyz, 0.0, 0.0, 2.0 + sign, 1e-9);
}

#[test]
fn lengths_place_beads() {
    let scene = scene(
        "AbsPoint A(2, 0, 0); AbsPoint O(0, 0, 0); AbsPoint B(0, 2, 0); Arc c(A, O, B, 6);
         ArcLenBead b(c, 3.141592653589793); ArcLenBead d(b, -1.5707963267948966); Line l(A, B);
         CopyBead e(d, l); AbsBead start(c, 0); AbsBead end(l, 1);",
    );
    near(scene.point("b").xyz, 0.0, 2.0, 0.0, 1e-11);
    near(scene.point("d").xyz, 2f64.sqrt(), 2f64.sqrt(), 0.0, 1e-11);
    near(scene.point("e").xyz, 1.75, 0.25, 0.0, 1e-11);
    // A bead at the end of a curve is the point object there.
    assert_eq!(scene.point("start").key, Some(scene.key("A")));
    assert_eq!(scene.point("end").key, Some(scene.key("B")));
    let long = fault(
        "AbsPoint A(0, 0, 0); AbsPoint B(3, 4, 0); Line l(A, B); AbsBead b(l, 0.5); ArcLenBead c(b, 2.6);",
    );
    assert_eq!((long.id, long.field()), ("beyond-end", Some(1)));
    assert!(long.expected.as_deref().unwrap().contains("2.5"), "{long:?}");
}

#[test]
fn helices_and_conics_are_what_they_should_be() {
    let scene = scene(
        "AbsPoint A(2, 0, 1); AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 5); Line axis(O, Z);
         Helix h(A, axis, 12.566370614359172, 3); AbsPoint X(3, 0, 0); AbsPoint Y(0, 2, 0);
         Conic e(O, X, Y); Conic b(O, X, Y, 0, 1, 2); Conic p(O, X, Y, -1, 1, 3);",
    );
    let h = scene.curve("h");
    // Two turns of radius 2 that rise by 3 each.
    near(at(h, 1.0), 2.0, 0.0, 7.0, 1e-14);
    near(at(h, 0.125), 0.0, 2.0, 1.75, 1e-14);
    let length = arclen(&**h, 0.0, 1.0, 1e-12);
    assert!((length - 2.0 * ((4.0 * PI).powi(2) + 9.0).sqrt()).abs() < 1e-11);
    for t in [0.0, 0.1, 0.37, 0.9] {
        let p = at(scene.curve("e"), t);
        assert!(((p.x / 3.0).powi(2) + (p.y / 2.0).powi(2) - 1.0).abs() < 1e-14);
        let p = at(scene.curve("b"), t);
        assert!(((p.x / 3.0).powi(2) - (p.y / 2.0).powi(2) - 1.0).abs() < 1e-14);
        let p = at(scene.curve("p"), t);
        assert!((p.x / 3.0 - (p.y / 2.0).powi(2)).abs() < 1e-14);
    }
    // The perimeter of the ellipse: 4 a E(e), here by Ramanujan's second formula, good to 1e-9.
    let perimeter = arclen(&**scene.curve("e"), 0.0, 1.0, 1e-12);
    let l = ((3.0 - 2.0) / (3.0 + 2.0f64)).powi(2);
    let formula = PI * 5.0 * (1.0 + 3.0 * l / (10.0 + (4.0 - 3.0 * l).sqrt()));
    assert!((perimeter - formula).abs() < 1e-7, "{perimeter} {formula}");
}

#[test]
fn foils_begin_and_end_at_their_points() {
    let scene = scene(
        "AbsPoint N(0, 0, 0); AbsPoint U(0.3, 0.06, 0); AbsPoint T(1, 0, 0); AbsPoint D(0.5, -0.06, 0);
         FoilCurve half({N, U, T}); FoilCurve full({T, U, N, T}); FoilCurve five({T, U, N, D, T});
         FoilCurve open({T, U, N, T}, tail = \"open\"); FoilCurve sixteen({N, U, T}, 4);
         FoilCurve named({N, U, T}, \"16\"); Arc o(N, U, T);
         FoilCurve own({N, U, T}, ordinates = {{0, 0, 0}, {0.25, 1, 0}, {0.5, 0.8, 0}, {1, 0, 0}});",
    );
    let (n, t) = (Some(scene.key("N")), Some(scene.key("T")));
    assert_eq!(scene.curve("half").end_points(), [n, t]);
    assert_eq!(scene.curve("full").end_points(), [t, t]);
    let open = scene.key("open");
    assert_eq!(scene.curve("open").end_points(), [open.end(0), open.end(1)]);
    // NACA 0012: 6.002 % at 30 %, and with the open tail 0.126 % at the tail.
    near(at(scene.curve("half"), 0.3f64.sqrt()), 0.3, 0.060_01, 0.0, 1.1e-5);
    near(at(scene.curve("open"), 0.0), 1.0, 0.00126, 0.0, 1e-15);
    for s in [0.1, 0.5, 0.8] {
        let (a, b) = (at(scene.curve("full"), s), at(scene.curve("five"), s));
        assert!(a.distance(b) < 1e-16);
        assert_eq!(at(scene.curve("sixteen"), s), at(scene.curve("named"), s));
    }
    assert_eq!(at(scene.curve("full"), 0.5), Vec3::zero());
    near(at(scene.curve("own"), 0.5), 0.25, 0.06, 0.0, 1e-16);
    // The nose is smooth: the speed does not vanish there, and is upright.
    let nose = scene.curve("full").jet(0.5, Order::First)[1];
    assert!(nose.x.abs() < 1e-15 && nose.y < -0.3);
}

#[test]
fn chains_run_along_their_pieces() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1);
        BCurve c({A, B, C}); BCurve e({D, B, A}); CCurve l({C, B, D}); PolyCurve both({c, l});
        PolyCurve late({c, l}, {0.75}); PolyCurve more({both, e}); AbsBead b(c, 0.5); AbsBead f(c, 1);
        SubCurve part(b, f); PolyCurve tail({part, l});";
    let scene = scene(text);
    let (both, late) = (scene.curve("both"), scene.curve("late"));
    near(at(both, 0.25), at(scene.curve("c"), 0.5).x, at(scene.curve("c"), 0.5).y, 0.25, 1e-15);
    assert_eq!(at(late, 0.75), at(scene.curve("l"), 0.0));
    assert_eq!(at(late, 1.0), at(scene.curve("l"), 1.0));
    let Trace::Pieces(pieces) = scene.curve("tail").trace() else { panic!("an alias") };
    let (c, l) = (Root::Curve(scene.key("c")), Root::Curve(scene.key("l")));
    assert_eq!([pieces[0].root, pieces[1].root], [c, l]);
    assert_eq!((pieces[0].from.t, pieces[0].to.t, pieces[0].until), (0.5, 1.0, 0.5));
    // The joint is one point object on both sides: the bead at the end of c is C.
    assert_eq!(pieces[0].to.point, Some(scene.key("C")));
    assert_eq!(pieces[1].from.point, Some(scene.key("C")));
    let Trace::Pieces(pieces) = scene.curve("more").trace() else { panic!("an alias") };
    let untils: Vec<f64> = pieces.iter().map(|p| p.until).collect();
    assert_eq!(untils, [0.25, 0.5, 1.0]);

    let gap = fault(&format!("{text} PolyCurve c2({{c, e}});"));
    assert_eq!((gap.id, gap.field().map(|field| (field, gap.item()))), ("gap", Some((0, Some(1)))));
    assert_eq!(gap.related.len(), 2);
    let turned = fault(&format!("{text} BCurve r({{D, B, C}}); PolyCurve c2({{c, r}});"));
    assert_eq!(turned.help, ["piece 2 ends there: reverse it"]);
}

#[test]
fn parts_of_parts_are_parts_of_the_whole() {
    let mut text = String::from(
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c0({A, B, C});",
    );
    for k in 1..=200 {
        let of = k - 1;
        text += &format!(
            "AbsBead a{k}(c{of}, 0.01); AbsBead b{k}(c{of}, 0.98); SubCurve c{k}(a{k}, b{k});"
        );
    }
    let scene = scene(&text);
    assert_eq!(scene.curve("c200").depth, scene.curve("c1").depth);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..200 {
        (low, high) = (low + 0.01 * (high - low), low + 0.98 * (high - low));
    }
    let expected = at(scene.curve("c0"), 0.5 * (low + high));
    assert!(at(scene.curve("c200"), 0.5).distance(expected) < 1e-14);
}

#[test]
fn curves_made_from_others() {
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); Arc circle(B, A, C, 6);
         AbsPoint P(3, 0, 0); AbsPoint Q(4, 1, 0); Line l(A, B); RelCurve moved(l, P, Q);
         CopyCurve big(circle, A, P, 2, 2, 2); Line axis(A, C); RotatCurve up(l, axis, 1.5707963267948966);
         OffsetCurve out(circle, 0.5, \"z=0\"); OffsetCurve in(circle, -0.5, \"z=0\");
         AbsBead b(circle, 0); AbsBead d(circle, 0.75); AbsBead e(circle, 0.25);
         BSubCurve fast({b, d, e}, 2); XCurve x(\"x\", {A, B, Q}); NURBCurve n({A, B, Q}, 2);
         BFitCurve same(n, 2, 3); NUBFitCurve knotted(n, 2, {0, 0.4, 1});",
    );
    near(at(scene.curve("moved"), 0.5), 3.5, 0.5, 0.0, 1e-15);
    near(at(scene.curve("big"), 0.25), 3.0, 4.0, 0.0, 1e-14);
    near(at(scene.curve("up"), 1.0), 0.0, 0.0, -2.0, 1e-15);
    for t in [0.0, 0.2, 0.6, 1.0] {
        // The right-hand side of a clockwise circle is outside.
        assert!((at(scene.curve("out"), t).norm() - 2.5).abs() < 1e-14);
        let jet = scene.curve("in").jet(t, Order::Second);
        assert!((jet[0].norm() - 1.5).abs() < 1e-14);
        assert!((jet[1].norm() - 3.0 * PI).abs() < 1e-12);
        assert!((jet[2].norm() - 6.0 * PI * PI).abs() < 1e-6);
    }
    // b(t) = 2 t (1-t) 0.75 + t^2 0.25 at t = 0.5.
    near(
        at(scene.curve("fast"), 0.5),
        2.0 * (0.875 * PI).cos(),
        2.0 * (0.875 * PI).sin(),
        0.0,
        1e-14,
    );
    let p = at(scene.curve("x"), 0.3);
    assert!((p.x - 1.2).abs() < 1e-15);
    for t in [0.0, 0.3, 1.0] {
        let p = at(scene.curve("n"), t);
        assert!(at(scene.curve("same"), t).distance(p) < 1e-14);
        assert!(at(scene.curve("knotted"), t).distance(p) < 1e-14);
    }
}

#[test]
fn snakes_on_a_plane_are_the_curves_of_the_same_kinds() {
    // A square of side 1: the parameter plane in space.
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(1, 1, 0);
         Line l(A, B); Line m(C, D); RuledSurf S(l, m);
         AbsPoint p(0.2, 0.3, 0); AbsPoint q(0.5, 0.45, 0); AbsPoint r(0.9, 0.2, 0);
         AbsMagnet P(S, 0.2, 0.3); AbsMagnet Q(S, 0.5, 0.45); AbsMagnet R(S, 0.9, 0.2);
         Arc arc(p, q, r); ArcSnake arcS(P, Q, R); CCurve c({p, q, r}); CSnake cS({P, Q, R});
         NURBCurve n({p, q, r}, 2, weights = {1, 2, 1}); NURBSnake nS({P, Q, R}, 2, weights = {1, 2, 1});
         FoilCurve f({p, q, r}, \"66tmb\"); FoilSnake fS({P, Q, R}, \"66tmb\");
         Conic e(p, q, r, 0, 2); ConicSnake eS(P, Q, R, 0, 2);
         CopySnake copy(arcS, S); AbsPoint u(0.1, 0.1, 0); AbsPoint v(0.7, 0.8, 0);
         AbsMagnet U(S, 0.1, 0.1); AbsMagnet V(S, 0.7, 0.8); RelCurve rel(arc, u, v); RelSnake relS(arcS, U, V);
         AbsBead b1(arc, 0.1); AbsBead b2(arc, 0.8); AbsBead b3(arc, 0.9); BSubCurve sub({b1, b2, b3});
         AbsRing r1(arcS, 0.1); AbsRing r2(arcS, 0.8); AbsRing r3(arcS, 0.9); BSubSnake subS({r1, r2, r3});",
    );
    for name in ["arc", "c", "n", "f", "e", "rel", "sub"] {
        for t in [0.0, 0.15, 0.5, 0.85, 1.0] {
            let (a, b) = (scene.curve(name), scene.curve(&format!("{name}S")));
            let (a, b) = (a.jet(t, Order::Second), b.jet(t, Order::Second));
            for k in 0..3 {
                assert!((a[k] - b[k]).norm() < 1e-12, "{name} at {t}: {:?} {:?}", a[k], b[k]);
            }
        }
    }
    assert_eq!(at(scene.curve("copy"), 0.3), at(scene.curve("arcS"), 0.3));
}

#[test]
fn a_chain_across_a_seam_is_refused() {
    let text = "AbsPoint A(1, 0, 0); AbsPoint B(1, 0, 2); AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 2);
        Line l(A, B); Line axis(O, Z); RevSurf S(l, axis); AbsMagnet p(S, 0.1, 0.5); AbsMagnet q(S, 0.5, 1);
        AbsMagnet r(S, 0.5, 0); AbsMagnet s(S, 0.9, 0.5); LineSnake a(p, q); LineSnake b(r, s);";
    scene(text);
    let seam = fault(&format!("{text} PolySnake c({{a, b}});"));
    assert_eq!(seam.id, "gap");
    assert!(seam.message.contains("jumps in the parameter plane"), "{seam:?}");
}

#[test]
fn a_snake_on_a_part_of_a_surface_knows_the_knots_of_the_whole() {
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(1, 1, 0.25); AbsPoint D(0.25, 0, 2);
         AbsPoint E(1, 0.5, 2); AbsPoint F(1.5, 1, 2.25); CCurve a({A, B, C}, degree = 1);
         CCurve b({D, E, F}, degree = 1); RuledSurf S(a, b); AbsMagnet p(S, 0.1, 0.2);
         AbsMagnet q(S, 0.9, 0.1); AbsMagnet r(S, 0.8, 0.9); AbsMagnet s(S, 0.2, 0.7);
         LineSnake south(p, q); LineSnake north(s, r); SubSurf part({south, north});
         AbsMagnet x(part, 0.1, 0.2); AbsMagnet y(part, 0.95, 0.9); LineSnake w(x, y);
         MirrSurf image(part, \"y=0\"); CopyMagnet xx(x, image); CopyMagnet yy(y, image);
         LineSnake ww(xx, yy);",
    );
    for name in ["w", "ww"] {
        let snake = scene.curve(name);
        let breaks = snake.breaks();
        // The corners of both masters, and those of the sides.
        assert!(!breaks.is_empty());
        let (mut low, mut worst) = (0.0, 0.0f64);
        for high in breaks.iter().copied().chain([1.0]) {
            // Inside a stretch, the two sides of the middle agree on the slope.
            let mid = 0.5 * (low + high);
            let slope = |t: f64| snake.jet(t, Order::First)[1];
            for k in 1..20 {
                let t = low + (high - low) * f64::from(k) / 20.0;
                let h = 1e-7;
                worst = worst.max((slope(t + h) - slope(t - h)).norm() / slope(mid).norm());
            }
            low = high;
        }
        assert!(worst < 1e-5, "{name} {worst}");
    }
}

/// The parallel of a Bézier curve whose last points are one, by the polynomial D of c'(t) = (1 - t)^m D(t).
fn parallel_at_a_multiple_end(t: f64, degree: usize, distance: f64) -> Vec3 {
    let p = [Vec3::of(0.0, 0.0, 0.0), Vec3::of(1.0, 2.0, 0.0), Vec3::of(4.0, 2.0, 0.0)];
    let binomial = |k: usize| (0..k).fold(1.0, |b, j| b * (degree - j) as f64 / (j + 1) as f64);
    let mut c = Vec3::zero();
    for k in 0..=degree {
        let share = t.powi(k as i32) * (1.0 - t).powi((degree - k) as i32);
        c += p[k.min(2)] * (binomial(k) * share);
    }
    let along = (p[1] - p[0]) * (1.0 - t) + (p[2] - p[1]) * ((degree - 1) as f64 * t);
    let sideways = along.cross(Vec3::of(0.0, 0.0, 1.0));
    c + sideways * (distance / sideways.norm())
}

#[test]
fn parallels_of_curves_with_multiple_ends_have_the_limit_there() {
    for (degree, names) in
        [(3, ["A, B, C, C", "C, C, B, A"]), (4, ["A, B, C, C, C", "C, C, C, B, A"])]
    {
        // To the outside of the bend, seen from both ends.
        for (names, distance) in names.into_iter().zip([-0.25, 0.25]) {
            let scene = scene(&format!(
                "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(4, 2, 0);
                 BCurve c({{{names}}}, {degree}); OffsetCurve o(c, {distance}, \"z=0\");"
            ));
            let forward = distance < 0.0;
            let exact = |t: f64| {
                parallel_at_a_multiple_end(if forward { t } else { 1.0 - t }, degree, -0.25)
            };
            for t in [0.0, 1e-9, 0.3, 0.8, 1.0 - 1e-9, 1.0] {
                let jet = scene.curve("o").jet(t, Order::Second);
                assert!(jet[0].distance(exact(t)) < 1e-12, "{names} {t}: {jet:?}");
                let slope = moldloft_testing::ridders_vector(exact, t, 0.05);
                assert!(jet[1].distance(slope) < 1e-6, "{names} {t}: {jet:?} {slope:?}");
                let bend = |t: f64| moldloft_testing::ridders_vector(exact, t, 0.02);
                let bend = moldloft_testing::ridders_vector(bend, t, 0.02);
                assert!(
                    jet[2].distance(bend) < 2e-4 * (1.0 + bend.norm()),
                    "{names} {t}: {jet:?} {bend:?}"
                );
            }
        }
    }
    // For a straight curve any distance is valid; inside a bend the curvature is unbounded.
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(3, 0, 0); BCurve c({A, B, C, C}, 3);
         OffsetCurve right(c, 0.25, \"z=0\"); OffsetCurve left(c, -0.25, \"z=0\"); BCurve d({A, A, A, C}, 3);
         OffsetCurve up(d, 0.5, \"z=0\");",
    );
    near(at(scene.curve("right"), 1.0), 3.0, -0.25, 0.0, 1e-15);
    near(at(scene.curve("left"), 1.0), 3.0, 0.25, 0.0, 1e-15);
    near(at(scene.curve("up"), 0.0), 0.0, -0.5, 0.0, 1e-15);
    const BENT: &str = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(4, 2, 0); ";
    for (text, id) in [
        ("BCurve c({A, B, C, C}, 3); OffsetCurve o(c, 0.25, \"z=0\");", "cusp"),
        ("BCurve c({A, A, B, C}, 3); OffsetCurve o(c, 0.25, \"z=0\");", "cusp"),
        ("BCurve c({A, B, A}); OffsetCurve o(c, 0.1, \"z=0\");", "no-tangent"),
        ("BCurve c({A, B, A}); TanCurve o(c, 0.1);", "no-tangent"),
        ("BCurve c({A, B, A}); ArcLenRelabel o(c);", "zero-slope"),
    ] {
        assert_eq!(fault(&format!("{BENT}{text}")).id, id, "{text}");
    }
}

#[test]
fn each_fault_of_the_new_kinds_has_its_id_and_its_place() {
    const BASE: &str = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(2, 0, 0);
        AbsPoint D(0, 1, 0); AbsPoint E(1, 1, 0); Line l(A, B); Line m(D, E); RuledSurf S(l, m);
        RuledSurf T(m, l); AbsMagnet p(S, 0.2, 0.2); AbsMagnet q(S, 0.8, 0.2); AbsMagnet r(S, 0.8, 0.8);
        AbsMagnet x(T, 0.5, 0.5); AbsBead b(l, 0.5); AbsBead c(m, 0.5); BCurve k({A, D, B});
        AbsPoint Z(1, 0, 0); Line dot(B, Z); AbsBead on(dot, 0.5);";
    scene(BASE);
    for (text, id, field, item) in [
        ("ThreePointFrame f(A, B, C);", "collinear-points", 2, None),
        ("FramePoint f(A, S, 1);", "wrong-class", 1, None),
        ("FramePoint f(A, B, 1, 1, 1, 3);", "out-of-range", 5, None),
        ("TanPoint f(on, 1);", "no-tangent", 0, None),
        ("NormalPlane f(on);", "no-tangent", 0, None),
        ("BlendPoint f({A, B}, {1});", "wrong-length", 1, None),
        ("CentroidPoint f({A, l});", "mixed-classes", 0, Some(1)),
        ("CentroidPoint f({dot});", "no-size", 0, None),
        ("ArcLenBead f(S, 1);", "wrong-class", 0, None),
        ("ArcLenBead f(dot, 1);", "no-length", 0, None),
        ("ArcLenRing f(l, 1);", "wrong-class", 0, None),
        ("CopyMagnet f(b, S);", "wrong-class", 0, None),
        ("XCurve f(\"w\", {A, B});", "unknown-axis", 0, None),
        ("XCurve f(\"x\", {A, C, B});", "not-monotone", 1, Some(2)),
        ("XCurve f(\"x\", {A, B}, \"clamped\");", "unknown-ends", 2, None),
        ("NURBCurve f({A, B, C}, 2, {0, 0, 1, 1});", "no-spline", 2, None),
        ("NURBCurve f({A, B, C}, 2, {0, 0, 0, 1, 0.5, 1});", "no-spline", 2, None),
        ("NURBCurve f({A, B, C}, 2, weights = {1, 0, 1});", "no-spline", 3, Some(1)),
        ("NURBCurve f({A, B, C}, 2, weights = {1, 1});", "no-spline", 3, None),
        ("FoilCurve f({A, D, B}, \"68\");", "unknown-name", 1, None),
        ("FoilCurve f({A, D, B}, 14);", "unknown-name", 1, None),
        ("FoilCurve f({A, D, B}, mean = \"260\");", "unknown-name", 2, None),
        ("FoilCurve f({A, D, B}, camber_at = 1.5);", "out-of-range", 3, None),
        ("FoilCurve f({A, D, B}, \"63\", load = 1.5);", "out-of-range", 4, None),
        ("FoilCurve f({A, D, B}, \"modified\", thickness_at = 0.1);", "out-of-range", 6, None),
        ("FoilCurve f({A, D, B}, tail = \"round\");", "unknown-name", 7, None),
        ("FoilCurve f({B, D, Z});", "coincident-points", 0, None),
        ("FoilCurve f({A, B, C, D, E, Z});", "wrong-length", 0, None),
        ("FoilCurve f({A, D, B}, ordinates = {{0, 0, 0}, {1, 0, 0}});", "no-section", 10, Some(2)),
        ("FoilSnake f({p, q, r}, metric = {1, 2, 1});", "out-of-range", 11, None),
        ("FoilSnake f({p, q, x});", "wrong-surface", 0, Some(2)),
        ("ArcSnake f(p, q, x);", "wrong-surface", 2, None),
        ("CSnake f({p, q, x});", "wrong-surface", 0, Some(2)),
        ("PolyCurve f({l, m}, {0.5, 0.6});", "wrong-length", 1, None),
        ("PolyCurve f({l, k}, {1.5});", "not-ascending", 1, Some(0)),
        ("PolyCurve f({l, m});", "gap", 0, Some(1)),
        ("BSubCurve f({b, c});", "wrong-curve", 0, Some(1)),
        ("Helix f(A, dot, 1, 1);", "zero-length-axis", 1, None),
        ("OffsetCurve f(k, 1, \"z=0\");", "cusp", 1, None),
        ("OffsetCurve f(k, 0.1, \"q=0\");", "unknown-plane", 2, None),
        ("OffsetCurve f(dot, 0.1, \"z=0\");", "no-tangent", 0, None),
        ("BFitCurve f(k, 3, 3);", "no-fit", 2, None),
        ("NUBFitCurve f(k, 3, {0, 0.5});", "out-of-range", 2, None),
        ("NUBFitCurve f(k, 3, {0, 0.6, 0.5, 1});", "no-fit", 2, None),
        ("CCurve z({A, D, B, E, C}); BFitCurve f(z, 2, 3, 0.001);", "no-fit", 3, None),
    ] {
        let fault = fault(&format!("{BASE} {text}"));
        let place = fault.field().map(|field| (field, fault.item()));
        assert_eq!((fault.id, place), (id, Some((field, item))), "{text}\n{fault:?}");
        assert!(!fault.message.ends_with('.'), "{text}: {}", fault.message);
    }
}
