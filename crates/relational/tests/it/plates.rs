//! Surfaces beside others, plates, foil lofts, tangent patches, joins and fits with known numbers,
//! and their errors.

use crate::common::{fault, scene};
use moldloft_num::trace::{Edge, Root};
use moldloft_num::{Order, Vec3};
use moldloft_registry::{SurfaceRef, Value};

fn at(s: &SurfaceRef<f64>, u: f64, v: f64) -> Vec3 {
    s.jet(u, v, Order::Zero).p
}

fn near(p: Vec3, q: Vec3, accuracy: f64) {
    assert!(p.distance(q) <= accuracy, "{p:?} and {q:?}");
}

const GRID: [f64; 6] = [0.0, 0.11, 0.25, 0.5, 0.9, 1.0];

fn places() -> impl Iterator<Item = (f64, f64)> {
    GRID.into_iter().flat_map(|u| GRID.into_iter().map(move |v| (u, v)))
}

/// A ball of radius 2: a half circle from pole to pole turned about x.
const BALL: &str =
    "AbsPoint O(0, 0, 0); AbsPoint P(2, 0, 0); AbsPoint Q(-2, 0, 0); AbsPoint R(0, 2, 0);
    Line axis(Q, P); Arc half(P, Q, R, type = 5); RevSurf ball(half, axis);";

#[test]
fn beside_a_ball_is_a_ball() {
    let scene = scene(&format!("{BALL} OffsetSurf more(ball, 0.5); OffsetSurf less(ball, -1.5);"));
    let ball = scene.surface("ball");
    // The natural normal points outward or inward all over.
    let out = {
        let jet = ball.jet(0.3, 0.2, Order::First);
        jet.normal().dot(jet.p).signum()
    };
    for (name, d) in [("more", 0.5), ("less", -1.5)] {
        let beside = scene.surface(name);
        for (u, v) in places() {
            let p = at(ball, u, v);
            // At the poles the normal is the limit.
            near(at(beside, u, v), p * ((2.0 + out * d) / 2.0), 1e-12);
        }
        let edges = beside.edges().edges;
        assert_eq!(edges[2], Edge::SameAs(0), "{name}");
        assert_eq!((&edges[1], &edges[3]), (&Edge::Pole(None), &Edge::Pole(None)), "{name}");
    }
    let inward = if out > 0.0 { -2.5 } else { 2.5 };
    let fault = fault(&format!("{BALL} OffsetSurf gone(ball, {inward});"));
    assert_eq!(fault.id, "cusp");
    let expected = fault.expected.as_deref().unwrap();
    let radius: f64 = expected.split_whitespace().find_map(|word| word.parse().ok()).unwrap();
    assert!((radius - 2.0).abs() < 1e-6, "{fault:?}");
}

#[test]
fn beside_a_cone_its_tip_has_no_normal() {
    let fault = fault(
        "AbsPoint O(0, 0, 0); AbsPoint P(2, 0, 0); AbsPoint Q(2, 1, 0); Line axis(O, P); Line side(O, Q);
         Line other(Q, P); PolyCurve kink({side, other}, {0.5}); AbsPoint A(0, 0, 1); AbsPoint B(1, 0, 1);
         Line a(O, P); Line b(O, P); RuledSurf flat(a, b); OffsetSurf none(flat, 0.1);",
    );
    assert_eq!(fault.id, "no-normal");
}

#[test]
fn a_foil_loft_has_the_section_of_each_place() {
    let text = "AbsPoint N(0, 0, 0); AbsPoint U(0.3, 0.06, 0); AbsPoint T(1, 0, 0); AbsPoint M(1, 0, 4);
        AbsPoint V(1.15, 0.03, 4); AbsPoint S(1.5, 0, 4); Line nose(N, M); Line up(U, V); Line tail(T, S);
        FoilLoftSurf wing({tail, up, nose, tail}); AbsPoint tip(2, 0, 8); Line a(N, tip); Line b(U, tip);
        Line c(T, tip); FoilLoftSurf fin({a, b, c}, \"65A\"); FoilCurve root({T, U, N, T});
        FoilCurve top({S, V, M, S});";
    let scene = scene(text);
    let wing = scene.surface("wing");
    for t in GRID {
        near(at(wing, 0.0, t), scene.curve("root").jet(t, Order::Zero)[0], 1e-15);
        near(at(wing, 1.0, t), scene.curve("top").jet(t, Order::Zero)[0], 1e-15);
    }
    // NACA 0012 everywhere: half thickness 0.06 chords at x = 0.3 (NACA Report 460).
    let chord = 1.0 - 0.5 * 0.5;
    let x = 0.3f64;
    let y = 0.6
        * (0.2969 * x.sqrt() - 0.1260 * x - 0.3516 * x * x + 0.2843 * x.powi(3)
            - 0.1036 * x.powi(4));
    let p = at(wing, 0.5, 0.5 * (1.0 - x.sqrt()));
    near(p, Vec3::of(0.5 + chord * x, chord * y, 2.0), 1e-12);
    // Both sides end at the tail: one root for both edges, so panels join there.
    let root = Root::Segment(scene.key("T"), scene.key("S"));
    for k in [0, 2] {
        let Edge::Pieces(pieces) = &wing.edges().edges[k] else { panic!("along the tail") };
        assert_eq!(pieces[0].root, root);
    }
    // A tip without size.
    let fin = scene.surface("fin");
    assert_eq!(fin.edges().edges[1], Edge::Pole(Some(scene.key("tip"))));
    for v in GRID {
        near(at(fin, 1.0, v), Vec3::of(2.0, 0.0, 8.0), 0.0);
    }
    let fault = fault("AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(1, 1, 0); AbsPoint D(0, 1, 0);
        AbsPoint E(0.5, 0.5, 1); Line a(A, C); Line b(B, D); Line up(E, A); FoilLoftSurf w({a, up, b});");
    assert_eq!(fault.id, "coincident-points");
    assert!(fault.help[0].contains("u = 0.5"), "{fault:?}");
}

#[test]
fn tangent_patches_keep_the_tangent_planes() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0.5); AbsPoint C(0, 3, 0.2); AbsPoint D(4, 3, 0);
        AbsPoint G(2, 1, 0.6); BCurve a({A, G, B}, 2); AbsPoint H(2, 3.5, 1); BCurve b({C, H, D}, 2);
        RuledSurf floor(a, b); EdgeSnake low(3, floor); BlendPoint I({C, A}, {1.5, -0.5});
        BlendPoint J({D, B}, {1.5, -0.5}); AbsPoint E(0, 6, 2); AbsPoint F(4, 6, 1.5);
        BCurve west({C, I, E}, 2); BCurve east({D, J, F}, 2); AbsPoint K(2, 6, 3); BCurve high({E, K, F}, 2);
        TanBoundary S({low, east, high, west}); BlendSurf plain({low, east, high, west});
        TanBoundary free({low, east, high, west}, free = {1});";
    let scene = scene(text);
    let (patch, floor) = (scene.surface("S"), scene.surface("floor"));
    let sides = ["low", "east", "high", "west"].map(|n| scene.curve(n));
    for t in GRID {
        for (k, (u, v)) in [(t, 0.0), (1.0, t), (t, 1.0), (0.0, t)].into_iter().enumerate() {
            for name in ["S", "free"] {
                near(at(scene.surface(name), u, v), sides[k].jet(t, Order::Zero)[0], 1e-13);
            }
        }
        let n = floor.jet(t, 1.0, Order::First).normal();
        let slope = patch.jet(t, 0.0, Order::First).v;
        assert!(n.dot(slope).abs() < 1e-13 * slope.norm(), "{t}");
        // The neighbours' slopes at the corners.
        if t == 0.0 || t == 1.0 {
            let side = sides[if t == 0.0 { 3 } else { 1 }];
            near(slope, side.jet(0.0, Order::First)[1], 1e-13);
        }
    }
    let bilinear = scene.surface("plain").jet(0.5, 0.0, Order::First);
    let n = floor.jet(0.5, 1.0, Order::First).normal();
    assert!(n.dot(bilinear.v.normalized().unwrap()).abs() > 1e-3, "the test shows nothing");
    // A side that leaves the plane.
    let fault = fault(&text.replace("BCurve west({C, I, E}, 2)", "Line west(C, E)"));
    assert_eq!((fault.id, fault.item()), ("not-tangent", Some(0)));
    assert!(fault.help[0].contains("TanPoint"), "{fault:?}");
    assert_eq!(crate::common::fault(&text.replace("free = {1}", "free = {5}")).id, "out-of-range");
}

/// A tangent patch is the plane or the cubic that it is bounded by.
#[test]
fn a_tangent_patch_of_a_plane_is_plane() {
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0); AbsPoint D(4, 3, 0);
         Line a(A, B); Line b(C, D); RuledSurf floor(a, b); EdgeSnake s1(1, floor); EdgeSnake s2(2, floor);
         EdgeSnake s3(3, floor); EdgeSnake s4(4, floor); TanBoundary S({s1, s2, s3, s4});",
    );
    for (u, v) in places() {
        near(at(scene.surface("S"), u, v), Vec3::of(4.0 * u, 3.0 * v, 0.0), 1e-14);
    }
}

#[test]
fn a_cone_and_a_cylinder_are_developed() {
    // Homothetic curves: rulings join equal parameters, and meet in the centre.
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(2, 3, 0); AbsPoint C(4, 0, 1); AbsPoint D(5, 1, 2); CCurve l({A, B, C, D});
         AbsPoint O(0, 0, 0); AbsPoint P(1, -2, 6); CopyCurve k(l, O, P, 0.5, 0.5, 0.5); DevSurf cone(l, k);
         DevSurf first(l, k, \"c1\"); DevSurf second(l, k, \"c2\"); CopyCurve m(l, O, P); DevSurf tube(l, m);",
    );
    let [l, k, m] = ["l", "k", "m"].map(|n| scene.curve(n));
    for (u, v) in places() {
        let [p, q, r] = [l, k, m].map(|c| c.jet(u, Order::Zero)[0]);
        for name in ["cone", "first", "second"] {
            near(at(scene.surface(name), u, v), p.lerp(q, v), 1e-11);
        }
        near(at(scene.surface("tube"), u, v), p.lerp(r, v), 1e-11);
    }
    let edges = scene.surface("first").edges().edges;
    let Edge::Pieces(pieces) = &edges[0] else { panic!("along l") };
    assert_eq!(pieces[0].root, Root::Curve(scene.key("l")));
    assert_eq!(scene.surface("cone").edges().edges[0], Edge::Own);
}

/// The Gaussian curvature is zero: the normal is one along each ruling, in fans, too.
#[test]
fn plates_are_not_stretched() {
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(2, 0.75, 0); AbsPoint C(4, 0, 0); AbsPoint D(0.5, 0, 2);
         AbsPoint E(2, 1.5, 2.25); AbsPoint F(4.5, 0.25, 2); BCurve l({A, B, C}); BCurve m({D, E, F});
         DevSurf plate(l, m); AbsPoint G(0, 0, 0); AbsPoint H(2, 0.2, 0); AbsPoint I(6, 2.5, 0.5);
         AbsPoint J(-0.5, 0.3, 2); AbsPoint K(3.5, 0.2, 2); AbsPoint L(6.5, 2.2, 2.5); BCurve chine({G, H, I});
         BCurve sheer({J, K, L}); DevSurf side(chine, sheer);",
    );
    let mut fans = 0;
    for name in ["plate", "side"] {
        let s = scene.surface(name);
        let breaks = &s.breaks()[0];
        for k in 0..=40 {
            let u = f64::from(k) / 40.0;
            if breaks.iter().any(|b| (b - u).abs() < 1e-3) {
                continue;
            }
            let normals: Vec<Vec3> =
                [0.02, 0.5, 0.98].map(|v| s.jet(u, v, Order::First).normal()).to_vec();
            for n in &normals[1..] {
                near(*n, normals[0], 1e-9);
            }
            // Rulings are straight lines between both curves.
            let low = s.jet(u, 0.0, Order::First);
            let high = s.jet(u, 1.0, Order::First);
            let still = [low.u, high.u].iter().filter(|d| d.norm() < 1e-12).count();
            fans += still;
        }
    }
    assert!(fans > 0, "no fan was tried");
}

#[test]
fn plates_that_do_not_exist_are_refused() {
    // Skew lines have no common tangent plane.
    let skew = fault(
        "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(0, 4, 2); Line a(A, B);
         Line b(C, D); DevSurf none(a, b);",
    );
    assert_eq!(skew.id, "no-rulings");
    assert!(skew.found.is_some() && !skew.help.is_empty(), "{skew:?}");
    // Bows against each other: the plate would pass its edge of regression.
    let crossed = fault(
        "AbsPoint A(0, 0, 0); AbsPoint B(2, 3, 0); AbsPoint C(4, 0, 0); AbsPoint D(4, 0, 2);
         AbsPoint E(2, 3, 2); AbsPoint F(0, 0, 2); BCurve a({A, B, C}, 2); BCurve b({D, E, F}, 2);
         DevSurf none(a, b);",
    );
    assert!(["rulings-cross", "no-rulings"].contains(&crossed.id), "{crossed:?}");
    // A fan about an end of the curve whose parameter is u.
    let text = "AbsPoint G(0, 0, 0); AbsPoint H(2, 0.2, 0); AbsPoint I(6, 2.5, 0.5);
         AbsPoint J(-0.5, 0.3, 2); AbsPoint K(3.5, 0.2, 2); AbsPoint L(6.5, 2.2, 2.5); BCurve c({G, H, I});
         BCurve d({J, K, L}); DevSurf side(c, d, ALONG);";
    let refused = crate::common::fault(&text.replace("ALONG", "\"c1\""));
    assert_eq!(refused.id, "fan-needed");
    let made = crate::common::scene(&text.replace("ALONG", "\"c2\""));
    for u in GRID {
        near(at(made.surface("side"), u, 1.0), made.curve("d").jet(u, Order::Zero)[0], 1e-15);
    }
    // Curves of opposite curvature: rulings would have to reverse along one of them.
    let back = crate::common::fault(
        "AbsPoint G(0, 0, 0); AbsPoint H(3, 0.4, -0.2); AbsPoint I(6, 2.5, 0.5);
         AbsPoint J(-0.5, 0.3, 2); AbsPoint K(3, 2.3, 1.8); AbsPoint L(6.5, 3.2, 2.5); BCurve c({G, H, I});
         BCurve d({J, K, L}); DevSurf side(c, d);",
    );
    assert_eq!(back.id, "no-rulings");
}

#[test]
fn joined_surfaces_are_run_through_in_turn() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2);
        AbsPoint E(2, 2, 2); AbsPoint F(4, 1, 3); Line a(A, B); Line b(D, E); RuledSurf R(a, b);
        Line c(B, C); Line d(E, F); RuledSurf S(c, d); PolySurf both({R, S}, breaks = {0.25});
        PolySurf even({R, S});";
    let scene = scene(text);
    let (r, s) = (scene.surface("R"), scene.surface("S"));
    for (u, v) in places() {
        let p = if u < 0.25 { at(r, u / 0.25, v) } else { at(s, (u - 0.25) / 0.75, v) };
        near(at(scene.surface("both"), u, v), p, 1e-14);
    }
    let Edge::Pieces(pieces) = &scene.surface("even").edges().edges[0] else {
        panic!("along both")
    };
    assert_eq!((pieces.len(), pieces[0].until), (2, 0.5));
    for (old, new, help) in [
        ("Line c(B, C); Line d(E, F)", "Line c(C, B); Line d(F, E)", "reverse"),
        ("Line c(B, C); Line d(E, F)", "Line c(E, F); Line d(B, C)", "v of piece 2"),
        ("Line c(B, C)", "Line c(A, C)", "common curve"),
    ] {
        let fault = fault(&text.replace(old, new));
        assert_eq!((fault.id, fault.item()), ("gap", Some(1)), "{new}");
        assert!(fault.help[0].contains(help), "{fault:?}");
    }
}

#[test]
fn fits_reproduce_what_they_can() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); AbsPoint E(0, 0, 3);
        AbsPoint F(1, 1, 3); AbsPoint G(3, 1, 4); AbsPoint H(4, 0, 4); BCurve a({A, B, C, D}); BCurve b({E, F, G, H});
        RuledSurf S(a, b); BFitSurf fit(S, 3, 1, 5, 2); NUBFitSurf knots(S, 3, 2, {0, 0.3, 1}, {0, 1});
        Arc c(A, B, D); Arc d(E, F, H); RuledSurf R(c, d); BFitSurf coarse(R, 3, 1, 4, 2);
        BFitSurf fine(R, 3, 1, 12, 2);";
    let scene = scene(text);
    for (u, v) in places() {
        for name in ["fit", "knots"] {
            near(at(scene.surface(name), u, v), at(scene.surface("S"), u, v), 1e-12);
        }
    }
    let residual = |name: &str| match scene.value(name) {
        Value::Surface(s) => s.found.as_ref().expect("a report").residual,
        _ => unreachable!(),
    };
    let (coarse, fine) = (residual("coarse"), residual("fine"));
    assert!(residual("fit") < 1e-12 && coarse > 1e-3 && fine < 1e-2 * coarse, "{coarse} {fine}");
    assert_eq!(scene.surface("fit").edges().corners[2], Some(scene.key("H")));
    let fault = fault(&text.replace("coarse(R, 3, 1, 4, 2)", "coarse(R, 3, 1, 4, 2, 0.000001)"));
    assert_eq!(fault.id, "no-fit");
    let few = crate::common::fault(&text.replace("fit(S, 3, 1, 5, 2)", "fit(S, 3, 1, 3, 2)"));
    assert!(["no-spline", "out-of-range", "no-fit"].contains(&few.id), "{few:?}");
}

/// A ball in the corner of two planes: a quarter of a cylinder.
#[test]
fn a_ball_in_a_corner_leaves_a_cylinder() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0); AbsPoint D(4, 3, 0);
        AbsPoint E(0, 2, -1); AbsPoint F(4, 2, -1); AbsPoint G(0, 2, 3); AbsPoint H(4, 2, 3); Line a(A, B);
        Line b(C, D); RuledSurf floor(a, b); Line c(E, F); Line d(G, H); RuledSurf wall(c, d);
        RollFillet S(floor, wall, 0.5, side2 = 1); RollFillet cone(floor, wall, 0.5, radii = {0.25, 0.75});";
    let scene = scene(text);
    let fillet = scene.surface("S");
    // The normals are z and -y: the centre is on y = 1.5, z = 0.5.
    let turned = at(fillet, 0.0, 0.0).x > 2.0;
    for (u, v) in places() {
        let angle = 0.5 * std::f64::consts::PI * v;
        let x = if turned { 4.0 * (1.0 - u) } else { 4.0 * u };
        near(
            at(fillet, u, v),
            Vec3::of(x, 1.5 + 0.5 * angle.sin(), 0.5 - 0.5 * angle.cos()),
            1e-12,
        );
        // The planes are normal to the path of the centre, so x is the same; the radius is from 1/4
        // to 3/4.
        let r = 0.25 + 0.5 * u;
        let p = Vec3::of(x, 2.0 - r + r * angle.sin(), r - r * angle.cos());
        near(at(scene.surface("cone"), u, v), p, 1e-12);
    }
    // Tangent to both also where the radius changes.
    for (v, normal) in [(0.0, Vec3::of(0.0, 0.0, 1.0)), (1.0, Vec3::of(0.0, 1.0, 0.0))] {
        let n = scene.surface("cone").jet(0.3, v, Order::First).normal();
        assert!((n.dot(normal).abs() - 1.0).abs() < 1e-12, "{v} {n:?}");
    }
    for (old, new, id) in [
        ("0.5, side2 = 1", "9, side2 = 1", "no-ball"),
        ("0.5, side2 = 1", "0, side2 = 1", "out-of-range"),
        ("side2 = 1", "side2 = 0", "out-of-range"),
        ("radii = {0.25, 0.75}", "radii = {0.25, -1}", "out-of-range"),
        ("radii = {0.25, 0.75}", "radii = {0.5, 5}", "no-ball"),
    ] {
        let fault = fault(&text.replace(old, new));
        assert_eq!(fault.id, id, "{new}: {fault:?}");
        assert!(fault.expected.is_some() && fault.found.is_some(), "{fault:?}");
    }
}

/// A ball between a cylinder and a plane across it rolls round: part of a torus, which closes.
#[test]
fn a_ball_rolls_round_a_mast() {
    let text = "AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line axis(O, Z); AbsPoint A(1, 0, -1); AbsPoint B(1, 0, 3);
        Line side(A, B); RevSurf mast(side, axis); AbsPoint C(-4, -4, 0); AbsPoint D(4, -4, 0);
        AbsPoint E(-4, 4, 0); AbsPoint F(4, 4, 0); Line c(C, D); Line d(E, F); RuledSurf deck(c, d);";
    let normal = |name: &str| {
        let scene = scene(text);
        let jet = scene.surface(name).jet(0.4, 0.3, Order::First);
        if name == "mast" {
            jet.normal().dot(Vec3::of(jet.p.x, jet.p.y, 0.0)) > 0.0
        } else {
            jet.normal().z > 0.0
        }
    };
    let [first, second] = ["deck", "mast"].map(|name| if normal(name) { 1 } else { -1 });
    let make = |radius: f64| {
        format!("{text} RollFillet S(deck, mast, {radius}, side1 = {first}, side2 = {second});")
    };
    let scene = scene(&make(0.5));
    let fillet = scene.surface("S");
    for (u, v) in places() {
        let p = at(fillet, u, v);
        // On the ring torus of radii 1.5 and 0.5 about z.
        let ring = (p.x.hypot(p.y) - 1.5).hypot(p.z - 0.5);
        assert!((ring - 0.5).abs() < 1e-11, "{u} {v} {p:?}");
    }
    assert_eq!(fillet.edges().edges[1], Edge::SameAs(3));
    // Contacts: on the deck a circle of radius 1.5, on the mast one at half the height above the
    // deck.
    let touching = crate::common::scene(&format!(
        "{} ContactSnake ring(S, 1); ContactSnake foot(S, 2);",
        make(0.5)
    ));
    for k in 0..=20 {
        let t = f64::from(k) / 20.0;
        for (name, v) in [("ring", 0.0), ("foot", 1.0)] {
            let snake = touching.curve(name);
            let [x, d, _] = snake.jet(t, Order::First);
            near(x, at(touching.surface("S"), t, v), 1e-12);
            let (radius, height) = if v == 0.0 { (1.5, 0.0) } else { (1.0, 0.5) };
            assert!((x.x.hypot(x.y) - radius).abs() < 1e-12 && (x.z - height).abs() < 1e-12);
            assert!((d.norm() - std::f64::consts::TAU * radius).abs() < 1e-6, "{d:?}");
            let w = snake.on_surface(t, Order::Zero).unwrap()[0];
            let parent = snake.surface.as_deref().unwrap();
            near(parent.jet(w.x, w.y, Order::Zero).p, x, 1e-15);
        }
    }
    // Inside the mast a ball larger than it cannot roll.
    let inside =
        format!("{text} RollFillet S(deck, mast, 0.4, side1 = {first}, side2 = {});", -second);
    assert!(crate::common::attempt(&inside).is_ok());
    let fault = fault(&inside.replace("0.4", "1.2"));
    assert!(["fillet-turns-back", "no-ball"].contains(&fault.id), "{fault:?}");
}

/// A ball under an arched floor that is bent more than the ball.
#[test]
fn a_ball_that_does_not_fit_turns_back() {
    let text = "AbsPoint A(0, 0, 3); AbsPoint B(1.5, 0, -3); AbsPoint C(3, 0, 3); AbsPoint D(0, 4, 3);
        AbsPoint E(1.5, 4, -3); AbsPoint F(3, 4, 3); BCurve a({A, B, C}, 2); BCurve b({D, E, F}, 2);
        RuledSurf trough(a, b); AbsPoint G(-1, 3, -2); AbsPoint H(4, 3, -2); AbsPoint I(-1, 3, 5);
        AbsPoint J(4, 3, 5); Line c(G, H); Line d(I, J); RuledSurf wall(c, d); RollFillet S(trough, wall, R);";
    let large = fault(&text.replace("wall, R", "wall, 0.6"));
    assert_eq!(large.id, "fillet-turns-back", "{large:?}");
    assert!(large.expected.as_deref().unwrap().contains("radius of curvature"));
}

#[test]
fn partial_relabels_take_a_part() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(4, 2, 1); Relabel r({0.25, 0.75}, 1, partial = 1); Line l(A, B, relabel = r);
        Relabel s({0, 0.2, 0.5}, 2, partial = 1); Line m(A, B, relabel = s); AbsPoint C(0, 3, 0); AbsPoint D(4, 3, 1);
        Line n(C, D); RuledSurf half(m, n, relabel = s); RuledSurf whole(m, n);";
    let scene = scene(text);
    let line = |t: f64| Vec3::of(4.0 * t, 2.0 * t, t);
    for t in GRID {
        near(scene.curve("l").jet(t, Order::Zero)[0], line(0.25 + 0.5 * t), 1e-15);
        let r = 0.4 * t * (1.0 - t) + 0.5 * t * t;
        near(at(scene.surface("half"), 0.3, t), at(scene.surface("whole"), 0.3, r), 1e-14);
    }
    // It ends where the whole does only on one side.
    let [l, m] = ["l", "m"].map(|name| scene.key(name));
    assert_eq!(scene.curve("l").end_points(), [l.end(0), l.end(1)]);
    assert_eq!(scene.curve("m").end_points(), [Some(scene.key("A")), m.end(1)]);
    let edges = scene.surface("half").edges();
    assert!(matches!(edges.edges[0], Edge::Pieces(_)) && edges.edges[2] == Edge::Own);
    let fault = fault(&text.replace("1, partial = 1", "1"));
    assert_eq!(fault.id, "wrong-ends");
    assert!(fault.help.iter().any(|h| h.contains("partial")));
    assert_eq!(crate::common::fault(&format!("{text} InvRelabel i(r);")).id, "wrong-ends");
}

#[test]
fn a_trimmed_plane_has_the_area_of_its_loops() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(4, 2, 0); Line l(A, B);
        Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.2, 0.2); AbsMagnet q(S, 0.7, 0.2); AbsMagnet r(S, 0.7, 0.8);
        AbsMagnet s(S, 0.2, 0.8); LineSnake pq(p, q); LineSnake rq(r, q); LineSnake rs(r, s); LineSnake ps(p, s);
        TrimSurf part(S, {pq, rq, rs, ps}); TrimSurf rest(S, {ps, pq, rq, rs}, whole = 1); AbsMagnet a(S, 0.4, 0.4);
        AbsMagnet b(S, 0.5, 0.4); AbsMagnet c(S, 0.4, 0.5); ArcSnake round(b, a, c, type = 6);
        TrimSurf frame(S, {pq, rq, rs, ps, round}, rim = 40); AbsMagnet x(S, 0.9, 0.5); AbsMagnet y(S, 0.8, 0.4);
        LineSnake qx(q, x); LineSnake xr(x, r); RuledSurf T(m, l); AbsMagnet z(T, 0.5, 0.5); AbsMagnet w(T, 0.7, 0.5);
        LineSnake zw(z, w);";
    let scene = scene(text);
    let mesh = |name: &str| match scene.value(name) {
        Value::Body(m) => m.clone(),
        _ => panic!("{name}"),
    };
    // 0.5 x 0.6 of 4 x 2.
    for (name, area) in [("part", 2.4), ("rest", 5.6)] {
        let m = mesh(name);
        let found = m.of_triangles.area;
        assert!((found - area).abs() < 1e-13, "{name} {found}");
        // All triangles face the natural normal.
        for t in &m.triangles {
            let [a, b, c] = t.map(|k| m.points[k as usize]);
            assert!((b - a).cross(c - a).z > 0.0, "{name}");
        }
    }
    near(mesh("part").of_triangles.centroid, Vec3::of(1.8, 1.0, 0.0), 1e-13);
    // The hole is an ellipse of half axes 0.4 and 0.2, as a polygon of 40 corners.
    let polygon = 40.0 * 0.5 * 0.4 * 0.2 * (std::f64::consts::TAU / 40.0).sin();
    assert!((mesh("frame").of_triangles.area - 2.4 + polygon).abs() < 1e-12);
    for (loops, id) in [
        ("{pq, rs, ps}", "gap"),
        ("{pq, rq}", "gap"),
        ("{pq, rq, zw}", "wrong-surface"),
        ("{round, pq, rq, rs, ps}", "crossed-loops"),
    ] {
        let fault = fault(&format!("{text} TrimSurf bad(S, {loops});"));
        assert_eq!(fault.id, id, "{loops}: {fault:?}");
        assert!(
            fault.expected.is_some() && !fault.help.is_empty() || id == "wrong-surface",
            "{fault:?}"
        );
    }
}

/// Laid flat, all lengths and angles stay: the first fundamental form is the same.
#[test]
fn expanded_plates_keep_their_lengths() {
    let scene = scene(
        "AbsPoint G(0, 0, 0); AbsPoint H(2, 0.2, 0); AbsPoint I(6, 2.5, 0.5); AbsPoint J(-0.5, 0.3, 2);
         AbsPoint K(3.5, 0.2, 2); AbsPoint L(6.5, 2.2, 2.5); BCurve c({G, H, I}); BCurve d({J, K, L});
         DevSurf side(c, d); ExpandedSurf plate(side); AbsPoint A(1, 0, 0); AbsPoint B(0, 1, 0); Arc a(A, G, B, 2);
         AbsPoint Z(0, 0, 3); Line up(G, Z); TranSurf tube(a, up); ExpandedSurf sheet(tube);
         AbsPoint O(0, 0, 2); CopyCurve e(a, O, O, 0.5, 0.5, 0.5); RuledSurf cone(a, e); ExpandedSurf fan(cone);",
    );
    for (bent, laid) in [("side", "plate"), ("tube", "sheet"), ("cone", "fan")] {
        let (s, p) = (scene.surface(bent), scene.surface(laid));
        let skip = &s.breaks()[0];
        for (u, v) in places().filter(|(u, _)| skip.iter().all(|b| (b - u).abs() > 1e-6)) {
            let (a, b) = (s.jet(u, v, Order::First), p.jet(u, v, Order::First));
            let form = |j: &moldloft_num::SurfJet<f64>| [j.u.dot(j.u), j.u.dot(j.v), j.v.dot(j.v)];
            for (x, y) in form(&a).into_iter().zip(form(&b)) {
                assert!((x - y).abs() < 1e-8 * (1.0 + x.abs()), "{laid} {u} {v}: {x} {y}");
            }
            assert!(b.p.z.abs() < 1e-14 && (v != 0.5 || b.normal().z > 0.99), "{laid} {u} {v}");
        }
        // No ruling jumps where fans begin or end.
        for b in skip {
            for v in [0.0, 1.0] {
                let [low, high] = [b - 1e-9, b + 1e-9].map(|u| at(p, u, v));
                assert!(low.distance(high) < 1e-7, "{laid} at {b}");
            }
        }
    }
    // A quarter of a cylinder of radius 1 and height 3.
    let sheet = scene.surface("sheet");
    let width = at(sheet, 0.0, 0.0).distance(at(sheet, 1.0, 0.0));
    assert!((width - 0.5 * std::f64::consts::PI).abs() < 1e-13, "{width}");
    for (text, says) in [
        ("BCurve n({A, B, C}, 2); RevSurf S(n, axis, 0, 1);", "not straight"),
        ("Line n(A, D); RuledSurf S(axis, n);", "turns along"),
    ] {
        let text = format!(
            "AbsPoint A(0, 1, 0); AbsPoint B(1, 2, 0); AbsPoint C(2, 1, 0); AbsPoint D(3, 1, 2);
             AbsPoint O(0, 0, 0); AbsPoint X(3, 0, 0); Line axis(O, X); {text} ExpandedSurf flat(S);"
        );
        let fault = fault(&text);
        assert_eq!(fault.id, "not-developable");
        assert!(fault.message.contains(says), "{fault:?}");
    }
}

#[test]
fn centroids_of_solids() {
    // A slanted block: its centroid is that of its corners; two of them weigh by volume.
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(2, 1, 0); AbsPoint E(1, 0, 3);
         Line l(A, B); Line m(C, D); RuledSurf S(l, m); Line up(A, E); TranSolid block(S, up); RuledSurf R(m, l);
         TranSolid left(R, up); CentroidPoint p({block}); CentroidPoint q({left}); AbsPoint F(0, 0, -6);
         Line down(A, F); TranSolid low(R, down); CentroidPoint both({block, low});",
    );
    near(scene.point("p").xyz, Vec3::of(1.5, 0.5, 1.5), 1e-11);
    near(scene.point("q").xyz, Vec3::of(1.5, 0.5, 1.5), 1e-11);
    // Volumes 6 and 12.
    near(scene.point("both").xyz, Vec3::of(3.5 / 3.0, 0.5, -1.5), 1e-11);
}

#[test]
fn a_fixed_frame_only_moves_the_profile() {
    // Also along a path with a corner, where no other frame can go.
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 1); AbsPoint C(3, 2, 0.5); Line l(A, B); Line m(B, C);
        PolyCurve path({l, m}); AbsPoint P(0, 0.5, 0); AbsPoint Q(0.1, 0.3, 0.6); AbsPoint R(0, -0.5, 0.2);
        BCurve profile({P, Q, R}); SweepSurf S(profile, path, \"fixed\"); TranSurf T(profile, path);
        SweepSurf half(profile, path, \"fixed\", scale = {1, 0.5});";
    let scene = scene(text);
    for (u, v) in places() {
        near(at(scene.surface("S"), u, v), at(scene.surface("T"), u, v), 1e-14);
        let (way, shape) = (scene.curve("path").jet(v, Order::Zero)[0], scene.curve("profile"));
        let scaled = way + shape.jet(u, Order::Zero)[0] * (1.0 - 0.5 * v);
        near(at(scene.surface("half"), u, v), scaled, 1e-14);
    }
    let upright = fault(&text.replace("\"fixed\");", "\"fixed\", up = {0, 0, 1});"));
    assert_eq!(upright.id, "unused-argument");
    assert_eq!(fault(&text.replace(", \"fixed\");", ");")).id, "corner-in-path");
}
