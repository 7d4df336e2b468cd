//! Edges that are one by construction: what is made of the same things and lies in one place joins, what
//! only lies in one place is an error that states the line to write, and nothing else joins.

use crate::common::{Random, ids, open, reported, rounds, sound};
use moldloft_document::{Document, Panelled};
use moldloft_num::{Order, Vec3};
use moldloft_registry::{SurfaceRef, Value};
use std::fmt::Write;
use std::sync::Arc;

fn panelled(document: &mut Document) -> Arc<Panelled> {
    document.panelled().unwrap_or_else(|d| panic!("{}", d.message))
}

fn surface(document: &Document, name: &str) -> SurfaceRef<f64> {
    let graph = document.graph();
    match graph.find(name).and_then(|key| graph.get(key)).and_then(|o| o.value()) {
        Some(Value::Surface(surface)) => surface.clone(),
        other => panic!("{name}: {other:?}"),
    }
}

/// An edge of a patch: points along it and the vertices of the mesh at its divisions.
struct Edge {
    name: String,
    points: Vec<Vec3>,
    vertices: Vec<u32>,
}

const TRIALS: usize = 24;

/// The edges of all patches that have a length.
fn edges(document: &Document, p: &Panelled) -> Vec<Edge> {
    let mut all = Vec::new();
    for patch in p.mesh.patches() {
        let Some(block) = &patch.block else { continue };
        let surface = surface(document, &patch.info.name);
        let (nu, nv) = (block.nu, block.nv);
        for k in 0..4 {
            let at = |t: f64| [(t, 0.0), (1.0, t), (t, 1.0), (0.0, t)][k];
            let place = |i: usize| {
                let (u, v) = at(i as f64 / TRIALS as f64);
                surface.jet(u, v, Order::Zero).p
            };
            let points: Vec<Vec3> = (0..=TRIALS).map(place).collect();
            let length: f64 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
            if length < 1e-9 {
                continue;
            }
            let vertices = match k {
                0 => (0..nu).map(|i| block.at(i, 0)).collect(),
                1 => (0..nv).map(|j| block.at(nu - 1, j)).collect(),
                2 => (0..nu).map(|i| block.at(i, nv - 1)).collect(),
                _ => (0..nv).map(|j| block.at(0, j)).collect(),
            };
            let name = format!("{}.{}", patch.info.name, ["v0", "u1", "v1", "u0"][k]);
            all.push(Edge { name, points, vertices });
        }
    }
    all
}

/// Every two edges that lie in one place have the same vertices, and no others have; the pairs.
fn same_place_is_same_vertices(document: &mut Document, text: &str) -> Vec<(String, String)> {
    let p = panelled(document);
    let all = edges(document, &p);
    let mut joined = Vec::new();
    for (k, a) in all.iter().enumerate() {
        for b in &all[..k] {
            let apart = |turned: bool| {
                let at = |i: usize| b.points[if turned { TRIALS - i } else { i }];
                (0..=TRIALS).map(|i| a.points[i].distance(at(i))).fold(0.0, f64::max)
            };
            let same = |turned: bool| {
                let mut other = b.vertices.clone();
                if turned {
                    other.reverse();
                }
                a.vertices == other
            };
            let coincide = apart(false).min(apart(true)) < 1e-9;
            let one = same(false) || same(true);
            assert_eq!(
                coincide,
                one,
                "{} and {}: {} apart\n{:?}\n{text}",
                a.name,
                b.name,
                apart(false).min(apart(true)),
                p.panelling.remarks()
            );
            if one {
                joined.push((b.name.clone(), a.name.clone()));
            }
        }
    }
    joined
}

/// A program without faults whose edges in one place are one, and none of them open but `open`.
fn closes(text: &str, open_loops: usize) -> Document {
    let mut d = sound(text);
    same_place_is_same_vertices(&mut d, text);
    let p = panelled(&mut d);
    let report = p.mesh.report();
    assert!(p.panelling.remarks().is_empty(), "{:?}\n{text}", p.panelling.remarks());
    assert!(report.manifold && report.oriented, "{report:?}\n{text}");
    assert_eq!(report.open_loops.len(), open_loops, "{text}");
    assert_eq!(d.junctions().unwrap().len(), 0, "{text}");
    d
}

#[test]
fn a_hull_with_a_chine_closes_along_it() {
    let text = "AbsPoint k1(0,0,.5); AbsPoint c1(.2,.05,.9); AbsPoint s1(0,.1,1.8);
        AbsPoint k2(5,0,-.6); AbsPoint c2(5,1.3,-.2); AbsPoint s2(5,1.7,1.3);
        AbsPoint k3(10,0,.2); AbsPoint c3(10,1.2,.4); AbsPoint s3(10,1.5,1.2);
        Line b1(k1,c1); Line b2(k2,c2); Line b3(k3,c3); Line t1(c1,s1); Line t2(c2,s2); Line t3(c3,s3);
        CLoftSurf bottom({b1,b2,b3}, divisions={6,20}); CLoftSurf topside({t1,t2,t3}, divisions={6,20});";
    let mut d = closes(text, 1);
    let p = panelled(&mut d);
    let edges = p.panelling.patch_edges(d.graph());
    let of = |patch: &str, k: u8| {
        edges.iter().find(|e| &*e.patch == patch && e.edge == k).expect("an edge").clone()
    };
    let (chine, other) = (of("bottom", 1), of("topside", 3));
    assert_eq!(chine.stretches.len(), 1);
    assert_eq!(chine.stretches[0].id, other.stretches[0].id);
    assert_eq!((chine.vertices, chine.stretches[0].range), (other.vertices, [0.0, 1.0]));
    assert_ne!(of("bottom", 3).stretches[0].id, chine.stretches[0].id);
}

const AXES: &str =
    "AbsPoint O(0,0,0); AbsPoint X(1,0,0); AbsPoint Y(0,1,0); AbsPoint Z(0,0,2); Line ax(O,Z);";

/// Bodies and shells that a designer builds without thinking of joins: a text, and the open loops.
const ORDINARY: &[(&str, usize)] = &[
    // A can of three patches, whole and by halves.
    ("AbsPoint A(1,0,0); AbsPoint B(1,0,2); Line a(O,A); Line b(A,B); Line c(B,Z);
      RevSurf s1(a,ax,divisions={3,16}); RevSurf s2(b,ax,divisions={4,16}); RevSurf s3(c,ax);", 0),
    ("AbsPoint A(1,0,0); AbsPoint B(1,0,2); Line a(O,A); Line b(A,B); Line c(B,Z);
      RevSurf s1(a,ax,0,acos(-1),divisions={3,16}); RevSurf s2(b,ax,0,acos(-1)); RevSurf s3(c,ax,0,acos(-1));", 1),
    ("AbsPoint X2(2,0,0); Arc me(Z,O,X2,type=2); RevSurf q(me,ax,0,acos(-1)); RevSurf r(me,ax,acos(-1),2*acos(-1));", 1),
    // Extrusions side by side.
    ("AbsPoint b(1,0,0); AbsPoint c(1,1,0); Line l(O,b); Line k(b,c); Line up(O,Z);
      TranSurf s(l,up,divisions={3,3}); TranSurf t(k,up,divisions={3,3});", 1),
    // Nets that share a column of points; a net and the curve of its last column.
    ("AbsPoint b(1,0,.3); AbsPoint c(2,0,0); AbsPoint d(0,1,0); AbsPoint e(1,1,.5); AbsPoint f(2,1,0);
      AbsPoint g(0,2,0); AbsPoint h(1,2,.2); AbsPoint i(2,2,0);
      BSurf s({O,b,d,e,g,h},3,2,2,1); BSurf t({b,c,e,f,h,i},3,2,2,1);", 1),
    ("AbsPoint b(1,0,.3); AbsPoint d(0,1,0); AbsPoint e(1,1,.5); AbsPoint g(0,2,0); AbsPoint h(1,2,.2);
      BSurf s({O,b,d,e,g,h},3,2,2,1); BCurve k({b,e,h},2); AbsPoint x(2,0,0); AbsPoint y(2,2,0);
      Line l(x,y); RuledSurf r(k,l);", 1),
    // The same curve from the other end.
    ("AbsPoint b(1,0,.3); AbsPoint c(2,0,0); AbsPoint d(0,1,0); AbsPoint f(2,1,0); BCurve k({O,b,c},2);
      Line kk(d,f); BCurve kr({c,b,O},2); RuledSurf s(k,kk,divisions={4,2}); AbsPoint x(0,-1,0);
      AbsPoint y(2,-1,0); Line l(y,x); RuledSurf t(kr,l,divisions={4,2});", 1),
    // A lid to a point, along the edge of a cap.
    ("AbsPoint M(2,0,0); Arc me(Z,O,M,type=2); RevSurf s(me,ax); EdgeSnake eq(2,s); Line p(O,O); RuledSurf disc(eq,p);", 0),
    // A ring swept along a closed path.
    ("AbsPoint q(5,0,0); AbsPoint q2(0,5,0); Arc path(q,O,q2,type=6); AbsPoint a(6,0,0); AbsPoint b(5,0,1);
      Arc k(a,q,b,type=6); SweepSurf s(k,path);", 0),
    // Turned sectors, a copy beside its original.
    ("Line l(O,X); RevSurf s(l,ax,0,2*acos(-1)/5); RotatSurf s2(s,ax,2*acos(-1)/5);
      RotatSurf s3(s,ax,4*acos(-1)/5); RotatSurf s4(s3,ax,2*acos(-1)/5); RotatSurf s5(s4,ax,2*acos(-1)/5);", 1),
    ("Line l(O,X); Line up(O,Y); TranSurf s(l,up); CopySurf t(s,O,Y);", 1),
    // A deck between a side and its image, however the image of the sheer is had.
    ("YPlane cp(0); AbsPoint a(0,0,1); AbsPoint b(2,1.2,1); AbsPoint c(4,1,1); AbsPoint d(0,0,0);
      AbsPoint e(2,0,-1); AbsPoint f(4,0,0); BCurve sh({a,b,c},2); BCurve ke({d,e,f},2);
      RuledSurf o(sh,ke,divisions={10,4}); MirrSurf i(o,cp); MirrCurve ms(sh,cp); RuledSurf deck(sh,ms);", 1),
    ("YPlane cp(0.5); AbsPoint a(0,0.5,1); AbsPoint b(2,1.2,1); AbsPoint c(4,1,1); AbsPoint d(0,0.5,0);
      AbsPoint e(2,0.5,-1); AbsPoint f(4,.5,0); BCurve sh({a,b,c},2); BCurve ke({d,e,f},2);
      RuledSurf o(sh,ke,divisions={10,4}); MirrSurf i(o,cp); EdgeSnake eo(1,o); MirrCurve ms(eo,cp);
      RuledSurf deck(eo,ms);", 1),
    ("AbsPoint a(0,0,1); AbsPoint b(2,1.2,1); AbsPoint c(4,1,1); AbsPoint d(0,0,0);
      AbsPoint e(2,0,-1); AbsPoint f(4,0,0); BCurve sh({a,b,c},2); BCurve ke({d,e,f},2);
      RuledSurf o(sh,ke,divisions={10,4}); MirrSurf i(o,\"y=0\"); MirrPoint b2(b,\"y=0\"); MirrPoint c2(c,\"y=0\");
      BCurve ms({a,b2,c2},2); RuledSurf deck(sh,ms); Line right(c,f); Line left(c2,f); RuledSurf transom(right,left);", 0),
    // A plate, its offset and the four strips between them.
    ("AbsPoint d(1,1,.3); Line l(O,X); Line k(Y,d); RuledSurf s(l,k,divisions={4,4}); OffsetSurf o(s,.1);
      EdgeSnake e1(1,s); EdgeSnake f1(1,o); RuledSurf r1(e1,f1); EdgeSnake e2(2,s); EdgeSnake f2(2,o);
      RuledSurf r2(e2,f2); EdgeSnake e3(3,s); EdgeSnake f3(3,o); RuledSurf r3(e3,f3); EdgeSnake e4(4,s);
      EdgeSnake f4(4,o); RuledSurf r4(e4,f4);", 0),
    // Parts of a surface whose sides were not given, next to a neighbour of the whole.
    ("AbsPoint b(2,0,0); AbsPoint c(0,2,0); AbsPoint d(2,2,1); Line l(O,b); Line k(c,d); RuledSurf s(l,k,visible=0);
      UVSnake w(s,\"u\",.4); EdgeSnake e2(2,s); EdgeSnake e4(4,s); SubSurf A({e4,w}); SubSurf B({w,e2});
      AbsPoint f(0,4,0); AbsPoint g(2,4,0); Line n(f,g); RuledSurf C(k,n);", 1),
    // An eighth of a ball, mirrored three times.
    ("AbsPoint M(2,0,0); Arc me(Z,O,M,type=2); RevSurf q(me,ax,0,acos(-1)/2,divisions={5,5}); MirrSurf q2(q,\"x=0\");
      MirrSurf q3(q,\"y=0\"); MirrSurf q4(q2,\"y=0\"); MirrSurf r(q,\"z=0\"); MirrSurf r2(q2,\"z=0\");
      MirrSurf r3(q3,\"z=0\"); MirrSurf r4(q4,\"z=0\");", 0),
];

#[test]
fn ordinary_bodies_close() {
    for (text, open_loops) in ORDINARY {
        closes(&format!("{AXES}\n{text}"), *open_loops);
    }
}

/// Points P0.. of a random edge, and others Q0.. and R0.. beside them.
fn points(random: &mut Random, count: usize) -> String {
    let mut text = String::new();
    for (row, name) in ["P", "Q", "R"].into_iter().enumerate() {
        for i in 0..count {
            let mut at = |base: f64| base + random.decimal(-0.3, 0.3);
            let side = [0.0, 1.5, -1.5][row];
            let (x, y, z) = (at(1.0 + 2.0 * i as f64), at(3.0 + side), at(0.0));
            let _ = writeln!(text, "AbsPoint {name}{i}({x}, {y}, {z});");
        }
    }
    text
}

fn row(name: &str, count: usize, backwards: bool) -> String {
    let mut all: Vec<String> = (0..count).map(|i| format!("{name}{i}")).collect();
    if backwards {
        all.reverse();
    }
    all.join(", ")
}

/// What is drawn across or along the points: its curve and its loft.
#[derive(Clone, Copy)]
struct Law {
    curve: fn(&str) -> String,
    loft: fn(&str) -> String,
    /// A net of two rows of so many points.
    net: Option<fn(&str, usize) -> String>,
    /// The fewest and the most points.
    counts: [usize; 2],
}

const LAWS: [Law; 6] = [
    Law {
        curve: |p| format!("BCurve({{{p}}}, 2)"),
        loft: |m| format!("BLoftSurf({{{m}}}, 2)"),
        net: Some(|p, n| format!("BSurf({{{p}}}, 2, {n}, 1, 2)")),
        counts: [3, 5],
    },
    Law {
        curve: |p| format!("BCurve({{{p}}})"),
        loft: |m| format!("BLoftSurf({{{m}}})"),
        net: Some(|p, n| format!("BSurf({{{p}}}, 2, {n}, 1, 3)")),
        counts: [4, 6],
    },
    Law {
        curve: |p| format!("CCurve({{{p}}})"),
        loft: |m| format!("CLoftSurf({{{m}}})"),
        net: None,
        counts: [3, 5],
    },
    Law {
        curve: |p| format!("XCurve(1, {{{p}}})"),
        loft: |m| format!("XLoftSurf(1, {{{m}}})"),
        net: None,
        counts: [3, 5],
    },
    Law {
        curve: |p| format!("Line({p})"),
        loft: |m| format!("RuledSurf({m})"),
        net: Some(|p, n| format!("BSurf({{{p}}}, 2, {n}, 1, 1)")),
        counts: [2, 2],
    },
    Law {
        curve: |p| format!("Arc({p}, type=1)"),
        loft: |m| format!("ArcLoftSurf({m}, type=1)"),
        net: None,
        counts: [3, 3],
    },
];

/// A declaration of a call under a name.
fn named(call: &str, name: &str) -> String {
    let (kind, rest) = call.split_once('(').expect("a call");
    format!("{kind} {name}({rest};\n")
}

const MAKERS: usize = 16;

/// A patch called `name` that has the edge of `law` through the points P, made in way `way`, with the other
/// side along the points of `far`; `None` where that way has none.
fn maker(
    way: usize,
    law: Law,
    name: &str,
    far: &str,
    n: usize,
    random: &mut Random,
) -> Option<String> {
    let mut text = String::new();
    let backwards = random.chance(50);
    let curve = |text: &mut String, points: &str, of: &str| {
        let _ = write!(text, "{}", named(&(law.curve)(points), of));
    };
    let masters = |text: &mut String, from: &str, to: &str, backwards: bool| -> String {
        let mut all = Vec::new();
        for i in 0..n {
            let _ = writeln!(text, "Line {name}m{i}({from}{i}, {to}{i});");
            all.push(format!("{name}m{i}"));
        }
        if backwards {
            all.reverse();
        }
        all.join(", ")
    };
    match way {
        // The edge is a curve: of a strip, a Coons patch, a surface of revolution, an extrusion, a sweep.
        0 => {
            curve(&mut text, &row("P", n, backwards), &format!("{name}c"));
            curve(&mut text, &row(far, n, backwards), &format!("{name}d"));
            let (a, b) = if random.chance(50) { ("c", "d") } else { ("d", "c") };
            let _ = writeln!(text, "RuledSurf {name}({name}{a}, {name}{b});");
        }
        1 => {
            curve(&mut text, &row("P", n, false), &format!("{name}c"));
            curve(&mut text, &row(far, n, false), &format!("{name}d"));
            let l = n - 1;
            let _ = writeln!(
                text,
                "Line {name}e(P{l}, {far}{l}); Line {name}f(P0, {far}0);
                 BlendSurf {name}({name}c, {name}e, {name}d, {name}f);"
            );
        }
        2 => {
            curve(&mut text, &row("P", n, backwards), &format!("{name}c"));
            let _ = writeln!(
                text,
                "AbsPoint {name}o(-9, 0, 3); AbsPoint {name}x(9, 0, 4); Line {name}a({name}o, {name}x);
                 RevSurf {name}({name}c, {name}a, 0, {});",
                if far == "Q" { 0.4 } else { -0.5 }
            );
        }
        3 => {
            curve(&mut text, &row("P", n, backwards), &format!("{name}c"));
            let end = if backwards { n - 1 } else { 0 };
            let _ = writeln!(
                text,
                "Line {name}w(P{end}, {far}{end}); TranSurf {name}({name}c, {name}w);"
            );
        }
        // It runs across masters that end, or begin, in the points.
        4 | 5 => {
            let (from, to) = if way == 4 { ("P", far) } else { (far, "P") };
            let list = masters(&mut text, from, to, backwards);
            let _ = write!(text, "{}", named(&(law.loft)(&list), name));
        }
        // A row of a net.
        6 => {
            let net = law.net?;
            let all = format!("{}, {}", row("P", n, backwards), row(far, n, backwards));
            let _ = write!(text, "{}", named(&net(&all, n), name));
        }
        // The edge of a hidden surface, as a snake.
        7 => {
            let list = masters(&mut text, "P", far, backwards);
            let hidden =
                named(&(law.loft)(&list), &format!("{name}h")).replace(");", ", visible = 0);");
            curve(&mut text, &row(far, n, backwards), &format!("{name}d"));
            let _ = writeln!(
                text,
                "{hidden}EdgeSnake {name}e(4, {name}h); RuledSurf {name}({name}e, {name}d);"
            );
        }
        // A part of a surface up to the edge.
        8 => {
            let list = masters(&mut text, "P", far, backwards);
            let hidden =
                named(&(law.loft)(&list), &format!("{name}h")).replace(");", ", visible = 0);");
            let _ = writeln!(
                text,
                "{hidden}EdgeSnake {name}e(4, {name}h); UVSnake {name}w({name}h, \"u\", 0.6);
                 SubSurf {name}({{{name}e, {name}w}});"
            );
        }
        9 => {
            let list = masters(&mut text, "P", far, backwards);
            let hidden =
                named(&(law.loft)(&list), &format!("{name}h")).replace(");", ", visible = 0);");
            let _ = writeln!(
                text,
                "{hidden}UVSnake {name}a({name}h, \"v\", 0); UVSnake {name}b({name}h, \"v\", 1);
                 AbsRing {name}p({name}a, 0.7); AbsRing {name}q({name}b, 0.7);
                 AbsRing {name}r({name}a, 0); AbsRing {name}s({name}b, 0);
                 SubSnake {name}c({name}r, {name}p); SubSnake {name}d({name}s, {name}q);
                 SubSurf {name}({{{name}c, {name}d}});"
            );
        }
        // The image of an image.
        10 => {
            let list = masters(&mut text, "P", far, backwards);
            let hidden =
                named(&(law.loft)(&list), &format!("{name}h")).replace(");", ", visible = 0);");
            let _ = writeln!(
                text,
                "{hidden}MirrSurf {name}i({name}h, \"y=0\", visible = 0); MirrSurf {name}({name}i, \"y=0\");"
            );
        }
        // Through the images of images of the points.
        11 => {
            for i in 0..n {
                let _ = writeln!(
                    text,
                    "MirrPoint {name}i{i}(P{i}, \"y=0\"); MirrPoint {name}j{i}({name}i{i}, \"y=0\");"
                );
            }
            let list = masters(&mut text, &format!("{name}j"), far, backwards);
            let _ = write!(text, "{}", named(&(law.loft)(&list), name));
        }
        // Turned and turned back.
        12 => {
            let list = masters(&mut text, "P", far, backwards);
            let hidden =
                named(&(law.loft)(&list), &format!("{name}h")).replace(");", ", visible = 0);");
            let angle = random.decimal(0.2, 3.0);
            let _ = writeln!(
                text,
                "AbsPoint {name}o(-9, 0, 3); AbsPoint {name}x(9, 0, 4); Line {name}a({name}o, {name}x);
                 {hidden}RotatSurf {name}t({name}h, {name}a, {angle}, visible = 0);
                 RotatSurf {name}({name}t, {name}a, -{angle});"
            );
        }
        13 => {
            curve(&mut text, &row("P", n, backwards), &format!("{name}c"));
            curve(&mut text, &row(far, n, backwards), &format!("{name}d"));
            let _ = writeln!(
                text,
                "MirrCurve {name}i({name}c, \"z=0\"); MirrCurve {name}j({name}i, \"z=0\");
                 RuledSurf {name}({name}j, {name}d);"
            );
        }
        // The only curve of a chain.
        14 => {
            curve(&mut text, &row("P", n, backwards), &format!("{name}c"));
            curve(&mut text, &row(far, n, backwards), &format!("{name}d"));
            let _ = writeln!(
                text,
                "PolyCurve {name}i({{{name}c}}); BLoftSurf {name}({{{name}i, {name}d}}, 1);"
            );
        }
        // The whole of a curve, from bead to bead.
        _ => {
            curve(&mut text, &row("P", n, backwards), &format!("{name}c"));
            curve(&mut text, &row(far, n, !backwards), &format!("{name}d"));
            let _ = writeln!(
                text,
                "AbsBead {name}p({name}c, 1); AbsBead {name}q({name}c, 0); SubCurve {name}s({name}p, {name}q);
                 CLoftSurf {name}({{{name}s, {name}d}});"
            );
        }
    }
    Some(text)
}

/// Random pairs and triples of patches that have an edge in common by construction, made in every two of the
/// ways: what lies in one place is one, and nothing else is.
#[test]
fn edges_made_alike_are_one() {
    let mut random = Random::new(14);
    let mut pairs = 0;
    let rounds = rounds(10_000);
    let mut made = std::collections::BTreeSet::new();
    while pairs < rounds {
        let law_at = random.below(LAWS.len());
        let law = LAWS[law_at];
        let [least, most] = law.counts;
        let n = least + random.below(most - least + 1);
        let (a, b) = (random.below(MAKERS), random.below(MAKERS));
        let mut text = points(&mut random, n);
        let Some(first) = maker(a, law, "p", "Q", n, &mut random) else { continue };
        let Some(second) = maker(b, law, "q", "R", n, &mut random) else { continue };
        text.push_str(&first);
        text.push_str(&second);
        // A strip to the far side of the first makes three.
        if random.chance(30) {
            let _ = write!(text, "{}", named(&(law.curve)(&row("Q", n, false)), "far"));
            text.push_str("AbsPoint S0(0, 9, 1); AbsPoint S1(9, 9, 2); Line third(S0, S1); RuledSurf r(far, third);");
        }
        let mut d = open(&text);
        if d.has_errors() {
            // An arc may not reach, a patch may fold: not what is tried here.
            continue;
        }
        let joined = same_place_is_same_vertices(&mut d, &text);
        let common = joined.iter().any(|(x, y)| {
            let of = |name: &str, edge: &String| edge.split('.').next() == Some(name);
            (of("p", x) && of("q", y)) || (of("q", x) && of("p", y))
        });
        assert!(common, "ways {a} and {b} of law {law_at}: {joined:?}\n{text}");
        made.insert((law_at, a.min(b), a.max(b)));
        pairs += 1;
    }
    assert!(made.len() >= 60.min(rounds / 2), "{} kinds of pair", made.len());
}

/// The connectivity of joined edges is that of all values of the parameters, and the joins stay exact.
#[test]
fn joins_stay_when_parameters_move() {
    let mut random = Random::new(41);
    for _ in 0..rounds(100) {
        let law = LAWS[random.below(LAWS.len() - 1)];
        let n = law.counts[0];
        let mut text =
            String::from("param float h = 0.1 in [-1, 1]; param float w = 0.2 in [0, 1];\n");
        text.push_str(
            &points(&mut random, n)
                .replace(", 3.", ", w + 3.")
                .replace("AbsPoint P1(3", "AbsPoint P1(h + 3"),
        );
        let (a, b) = (random.below(MAKERS), random.below(MAKERS));
        let Some(first) = maker(a, law, "p", "Q", n, &mut random) else { continue };
        let Some(second) = maker(b, law, "q", "R", n, &mut random) else { continue };
        text.push_str(&first);
        text.push_str(&second);
        let mut d = open(&text);
        if d.has_errors() {
            continue;
        }
        let at_home = panelled(&mut d).panelling.topology().vertex_count();
        let joined = same_place_is_same_vertices(&mut d, &text);
        for _ in 0..rounds(100).min(100) {
            let values = [("h".into(), random.between(-0.2, 0.2)), ("w".into(), random.unit())];
            if d.set(&values).is_err() {
                continue;
            }
            let p = panelled(&mut d);
            // An open sheet may turn to face the other way.
            assert_eq!(p.panelling.topology().vertex_count(), at_home, "{text}");
            assert!(p.panelling.remarks().is_empty(), "{:?}\n{text}", p.panelling.remarks());
            assert_eq!(same_place_is_same_vertices(&mut d, &text), joined);
        }
    }
}

#[test]
fn equal_numbers_join_nothing_but_are_reported() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(4, 1, 0);
        AbsPoint A2(0, 0, 0); AbsPoint B2(4, 0, 0); AbsPoint E(0, -1, 0); AbsPoint F(4, -1, 0);
        Line ab(A, B); Line ab2(B2, A2); Line cd(C, D); Line ef(F, E);
        RuledSurf top(ab, cd); RuledSurf low(ef, ab2, divisions = {6, 3});";
    let mut d = sound(text);
    assert!(panelled(&mut d).mesh.report().open_loops.len() > 1);
    let found = d.junctions().unwrap();
    let [only] = &found[..] else { panic!("{found:?}") };
    assert!(only.is_error() && &*only.id == "edges-not-joined", "{only:?}");
    assert_eq!(
        only.message,
        "edge v = 0 of `top` and edge v = 1 of `low` coincide along 8 panels (4.000000 long, from \
         (0, 0, 0)) but are not joined"
    );
    // The line that it states joins them.
    let line = only.help.iter().find_map(|h| h.split('`').nth(1)).expect("a line").to_string();
    assert_eq!(line, "Join j(top.v0, low.v1);");
    let mut d = sound(&format!("{text}\n{line}"));
    assert_eq!(panelled(&mut d).mesh.report().open_loops.len(), 1);
    assert_eq!(d.junctions().unwrap().len(), 0);
    // One of two points at one place may be moved: then the join says how far.
    let apart = format!("{text}\n{line}").replace("B2(4, 0, 0)", "B2(4, 0, 0.25)");
    let d = open(&apart);
    assert_eq!(ids(&d), ["edges-apart"]);
    assert!(
        reported(&d)[0].contains("0.25 at t = 1 of the first, at (4, 0, 0)"),
        "{:?}",
        reported(&d)
    );
    let near = apart.replace("low.v1);", "low.v1, tolerance = 0.3);");
    let mut d = sound(&near);
    let p = panelled(&mut d);
    assert!(p.panelling.remarks().is_empty(), "{:?}", p.panelling.remarks());
    assert_eq!(p.mesh.report().open_loops.len(), 1);
}

#[test]
fn a_join_takes_a_whole_edge() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(4, 1, 0);
        Line ab(A, B); Line cd(C, D); RuledSurf top(ab, cd); EdgeSnake e(1, top); AbsRing r(e, 0); AbsRing s(e, 0.5);
        AbsRing t(e, 1); SubSnake half(r, s); SubSnake rest(s, t);";
    let d = open(&format!("{text} Join j(rest, half);"));
    assert_eq!(ids(&d), ["not-an-edge"]);
    assert!(reported(&d)[0].contains("a part of an edge"), "{:?}", reported(&d));
    let d = open(&format!("{text} Join j(top.v2, half);"));
    assert_eq!(ids(&d), ["unknown-member"]);
}

#[test]
fn corners_have_names() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(4, 1, 0.5);
        Line ab(A, B); Line cd(C, D); RuledSurf s(ab, cd); OffsetSurf o(s, 0.25);
        Line post(s.c00, o.c00); Line side(s.c10, o.c10); RuledSurf web(post, side); EdgeSnake e(1, s);
        EdgeSnake f(1, o); RuledSurf strip(e, f);";
    let mut d = sound(text);
    let joined = same_place_is_same_vertices(&mut d, text);
    assert!(joined.contains(&("web.v0".into(), "strip.u0".into())), "{joined:?}");
    assert_eq!(crate::common::number(&mut d, "s.c11.z"), 0.5);
    let length = crate::common::number(&mut d, "s.u1.length");
    assert!((length - 1.25f64.sqrt()).abs() < 1e-12, "{length}");
}

/// The area and the volume of a prism over a polygon with knuckles at its corners are exact at any divisions.
#[test]
fn prisms_have_their_exact_area() {
    let mut random = Random::new(7);
    for round in 0..rounds(500) {
        let n = 3 + random.below(7);
        let corners: Vec<[f64; 2]> = (0..n)
            .map(|k| {
                let angle = (k as f64 + 0.6 * random.unit()) * std::f64::consts::TAU / n as f64;
                let r = random.between(0.5, 3.0);
                [r * angle.cos(), r * angle.sin()]
            })
            .collect();
        let height = random.decimal(0.5, 3.0);
        let mut text = String::new();
        for (k, [x, y]) in corners.iter().enumerate() {
            let _ =
                writeln!(text, "AbsPoint a{k}({x}, {y}, 0); RelPoint b{k}(a{k}, 0, 0, {height});");
        }
        let cycle = |name: &str| {
            let mut all = row(name, n, false);
            let _ = write!(all, ", {name}0");
            all
        };
        let (nu, nv) = (n + random.below(20), 1 + random.below(4));
        let kind = round % 4;
        match kind {
            0 | 1 => {
                for k in 0..n {
                    let next = (k + 1) % n;
                    let _ = writeln!(text, "Line l{k}(a{k}, a{next}); Line m{k}(b{k}, b{next});");
                }
                let _ = writeln!(text, "PolyCurve p({{{}}}); Line up(a0, b0);", row("l", n, false));
                if kind == 0 {
                    let _ = writeln!(text, "TranSurf t(p, up, divisions = {{{nu}, {nv}}});");
                } else {
                    let _ = writeln!(
                        text,
                        "PolyCurve q({{{}}}); RuledSurf t(p, q, divisions = {{{nu}, {nv}}});",
                        row("m", n, false)
                    );
                }
            }
            2 => {
                let _ = writeln!(
                    text,
                    "BCurve p({{{}}}, 1); Line up(a0, b0); TranSurf t(p, up, divisions = {{{nu}, {nv}}});",
                    cycle("a")
                );
            }
            _ => {
                // Across the masters, and from the other side.
                for k in 0..n {
                    let _ = writeln!(text, "Line l{k}(a{k}, b{k});");
                }
                let _ = writeln!(
                    text,
                    "BLoftSurf t({{{}}}, 1, divisions = {{{nv}, {nu}}});",
                    cycle("l")
                );
            }
        }
        let mut d = sound(&text);
        let p = panelled(&mut d);
        assert!(p.panelling.remarks().is_empty(), "{:?}\n{text}", p.panelling.remarks());
        let around: f64 = (0..n)
            .map(|k| {
                let ([a, b], [c, d]) = (corners[k], corners[(k + 1) % n]);
                (c - a).hypot(d - b)
            })
            .sum();
        let at = |v: u32| p.mesh.positions()[v as usize];
        let half = |f: &[u32; 4]| {
            let triangle = |a, b, c| (at(b) - at(a)).cross(at(c) - at(a)).norm() / 2.0;
            triangle(f[0], f[1], f[2]) + triangle(f[0], f[2], f[3])
        };
        let area: f64 = p.mesh.topology().faces().iter().map(half).sum();
        assert!(
            (area - around * height).abs() < 1e-12 * area,
            "{area} for {}\n{text}",
            around * height
        );
        let loops = p.mesh.report().open_loops.len();
        assert_eq!(loops, 2, "a tube\n{text}");
    }
}

/// Masters whose knuckles are at unlike parameters: both are rows, and too few divisions are reported.
#[test]
fn unlike_knuckles_are_all_rows() {
    let text = |divisions: &str| {
        format!(
            "AbsPoint a(0,0,0); AbsPoint b(1,0,1); AbsPoint c(2,0,0); AbsPoint d(3,0,1);
             AbsPoint e(0,2,0); AbsPoint f(1.4,2,1); AbsPoint g(3,2,0);
             BCurve p({{a,b,c,d}},1); BCurve q({{e,f,g}},1); RuledSurf s(p,q,divisions={{{divisions}}});"
        )
    };
    for n in [4, 5, 7, 12] {
        let mut d = sound(&text(&format!("{n}, 3")));
        let p = panelled(&mut d);
        assert!(p.panelling.remarks().is_empty());
        let block = p.mesh.patches()[0].block.clone().expect("a grid");
        let at = |i: usize, j: usize| p.mesh.positions()[block.at(i, j) as usize];
        let edge = |j: usize| (0..=n).map(|i| at(i, j)).collect::<Vec<_>>();
        let s = surface(&d, "s");
        for knuckle in [1.0 / 3.0, 0.5, 2.0 / 3.0] {
            for (j, v) in [(0, 0.0), (1, 1.0 / 3.0), (3, 1.0)] {
                let place = s.jet(knuckle, v, Order::Zero).p;
                assert!(edge(j).iter().any(|q| q.distance(place) < 1e-12), "{knuckle} of {n}");
            }
        }
    }
    let mut d = open(&text("3, 3"));
    let p = panelled(&mut d);
    assert_eq!(p.panelling.remarks().len(), 1, "{:?}", p.panelling.remarks());
}

/// A strut on a body of revolution over a poly-curve, the seam under the strut: both sides of the part cross the joint at
/// one parameter, to rounding.
#[test]
fn a_seam_joins_beside_its_cut_at_all_values() {
    let text = "float x0 = 3.5; param float chord = 20 in [14, 24];
        AbsPoint n(0, 0, 0); AbsPoint n1(0, 0, 1); AbsPoint t1(28, 0, 1); AbsPoint t(28, 0, 0);
        AbsPoint m1(5, 0, 1); AbsPoint m2(20, 0, 1); AbsPoint q(26, 0, 0.8);
        BCurve nose({n, n1, m1}, degree = 2); Line mid(m1, m2); BCurve tail({m2, q, t}, degree = 2);
        PolyCurve profile({nose, mid, tail}, breaks = {0.2, 0.75}); Line axis(n, t);
        RevSurf torpedo(profile, axis, 0, 2*PI, visible = 0);
        AbsPoint f0(x0, 0, 3); AbsPoint f1(x0 + 0.3*chord, -0.4, 3); AbsPoint f2(x0 + 0.3*chord, 0.4, 3);
        AbsPoint f3(x0 + chord, 0, 3);
        BCurve inner({f0, f1, f3}, degree = 2); BCurve outer({f0, f2, f3}, degree = 2);
        EdgeSnake e0(1, torpedo); EdgeSnake e1(3, torpedo);
        XYZRing lead0(e0, \"x\", x0); XYZRing trail0(e0, \"x\", x0 + chord);
        XYZRing lead1(e1, \"x\", x0); XYZRing trail1(e1, \"x\", x0 + chord);
        ProjSnake root_a(inner, lead0, \"z=0\", ends = {lead0, trail0});
        ProjSnake root_b(outer, lead1, \"z=0\", ends = {lead0, trail0});
        AbsRing a0(e0, 0); AbsRing a1(e0, 1); AbsRing b0(e1, 0); AbsRing b1(e1, 1);
        SubSnake a_fore(a0, lead0); SubSnake a_aft(trail0, a1);
        SubSnake b_fore(b0, lead1); SubSnake b_aft(trail1, b1);
        PolySnake way_a({a_fore, root_a, a_aft}, breaks = {0.2, 0.8});
        PolySnake way_b({b_fore, root_b, b_aft}, breaks = {0.2, 0.8});
        SubSurf hull({way_a, torpedo.u1, way_b, torpedo.u0}, divisions = {48, 24});
        RuledSurf strut_in(root_a, inner, divisions = {\"auto\", 8});
        RuledSurf strut_out(root_b, outer, divisions = {\"auto\", 8});
        RuledSurf lid(inner, outer, divisions = {\"auto\", 4});";
    let mut document = sound(text);
    let faces = panelled(&mut document).mesh.faces().len();
    // Values at which both sides differ by rounding, then others.
    let steps = rounds(400).max(10);
    let even = (0..=steps).map(|k| 14.0 + 10.0 * k as f64 / steps as f64);
    for chord in [18.2, 19.325, 20.15, 20.375, 16.5].into_iter().chain(even) {
        document.set(&[("chord".into(), chord)]).unwrap();
        let p = panelled(&mut document);
        let report = p.mesh.report();
        let open: usize = report.open_loops.len();
        assert_eq!((report.components, open), (1, 0), "chord {chord}");
        assert_eq!(p.mesh.faces().len(), faces, "chord {chord}");
    }
}
