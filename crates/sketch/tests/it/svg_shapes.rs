//! Pictures of SVG as shapes of the page.

use moldloft_sketch::page_curve::PageCurve;
use moldloft_sketch::parts::{PageShapes, SvgTransform, svg_shapes};

#[test]
fn transforms_in_their_order() {
    let both = SvgTransform::NONE.with("translate(10, 20) scale(2)").unwrap();
    let both = both.with(" rotate(90 1 1),matrix(1 0 0 1 3 0)").unwrap();
    let mut shapes = PageShapes::default();
    let mut one = PageShapes::default();
    // (4, 0) is mapped to (7, 0), about (1, 1) to (2, 7), then to (14, 34), whose v is -34.
    one.strokes.push([[4.0, 0.0], [0.0, 0.0]]);
    one.arcs.push(([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 1.0));
    both.put(one.clone(), &mut shapes);
    let [u, v] = shapes.strokes[0][0];
    assert!((u - 14.0).abs() < 1e-12 && (v + 34.0).abs() < 1e-12, "{u} {v}");
    assert!((shapes.arcs[0].1 - 2.0).abs() < 1e-12);
    SvgTransform::NONE.with("scale(1 2)").unwrap().put(one, &mut shapes);
    // A quarter of a circle becomes one of an ellipse, whose corner has the weight cos 45°.
    let [PageCurve::Conic(corner, weight)] = shapes.curves[..] else { panic!("{shapes:?}") };
    assert_eq!(corner, [[1.0, 0.0], [1.0, 2.0], [0.0, 2.0]]);
    assert!((weight - 0.5_f64.sqrt()).abs() < 1e-15);
    for bad in ["scale", "scale(1", "turn(3)", "rotate(1 2)", "scale(a)"] {
        assert!(SvgTransform::NONE.with(bad).is_err(), "{bad}");
    }
}

#[test]
fn shapes_of_a_picture() {
    let text = "<?xml version='1.0'?><!-- < > --><svg xmlns=\"x\"><defs><line x1=\"9\"/></defs>\
        <line x1='0' y1='0' x2='4' y2='-3'/><polygon points='0,0 4,0 4,3'/><g><rect width='2' height='1'/></g>\
        <circle cx='5' cy='5' r='2'/><text x='1'>a</text>\
        <path d='M0 0h10a2 2 0 01 2 2v5q1 1 2 2z'/></svg>";
    let shapes = svg_shapes(text).unwrap();
    assert_eq!((shapes.strokes.len(), shapes.arcs.len(), shapes.rounds.len()), (11, 1, 1));
    assert_eq!(shapes.strokes[0], [[0.0, 0.0], [4.0, 3.0]]);
    let ([start, corner, end], radius) = shapes.arcs[0];
    let near = |p: [f64; 2], q: [f64; 2]| libm::hypot(p[0] - q[0], p[1] - q[1]) < 1e-9;
    assert!(near(start, [10.0, 0.0]) && near(end, [12.0, -2.0]) && near(corner, [12.0, 0.0]));
    assert!((radius - 2.0).abs() < 1e-12);
    assert_eq!(shapes.left_out.values().sum::<usize>(), 1);
    // The quadratic curve as a cubic.
    let cubic = [
        [12.0, -7.0],
        [12.0 + 2.0 / 3.0, -7.0 - 2.0 / 3.0],
        [13.0 + 1.0 / 3.0, -8.0 - 1.0 / 3.0],
        [14.0, -9.0],
    ];
    let [PageCurve::Cubic(found)] = shapes.curves[..] else { panic!("{shapes:?}") };
    assert!(found.into_iter().zip(cubic).all(|(p, q)| near(p, q)), "{found:?}");
    let text = "<svg><g transform='scale(2)'><g transform='translate(1 0)'><line x2='1'/></g>\
        <line x2='1'/></g><line x2='1'/></svg>";
    let ends: Vec<f64> = svg_shapes(text).unwrap().strokes.iter().map(|s| s[1][0]).collect();
    assert_eq!(ends, [4.0, 2.0, 1.0]);
    for bad in [
        "",
        "<a/>",
        "<svg",
        "<svg><line x1=\"a\"/></svg>",
        "<svg><g transform='scale(2'/></svg>",
        "<svg><path d='M 1'/></svg>",
        "<svg><path d='5'/></svg>",
        "<svg><line x1=5/></svg>",
    ] {
        assert!(svg_shapes(bad).is_err(), "{bad}");
    }
}

#[test]
fn elements_drawn_by_reference() {
    // A line of the definitions moved twice, a group with one inside, a symbol, and one that is drawn later.
    let text = "<svg><defs><line id='a' x2='1'/><g id='b' transform='scale(2)'><use href='#a' x='3'/></g>\
        <symbol id='s'><line x2='7'/></symbol></defs><use xlink:href='#a' x='10' y='-5'/>\
        <use href='#b' transform='translate(100 0)'/><use href='#s' y='1'/><use href='#c'/>\
        <line id='c' x1='20' x2='21'/><use href='#none'/><use href='other.svg#a'/></svg>";
    let shapes = svg_shapes(text).unwrap();
    let wanted = [
        [[10.0, 5.0], [11.0, 5.0]],
        [[106.0, 0.0], [108.0, 0.0]],
        [[0.0, -1.0], [7.0, -1.0]],
        [[20.0, 0.0], [21.0, 0.0]],
        [[20.0, 0.0], [21.0, 0.0]],
    ];
    assert_eq!(shapes.strokes, wanted);
    assert_eq!(shapes.left_out.get("use"), Some(&2));
    // References in a circle, and more than anyone draws.
    let circle = "<svg><g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g></svg>";
    assert!(svg_shapes(circle).is_err());
    let mut many = String::from("<svg><line id='n0' x2='1'/>");
    for k in 1..20 {
        let twice = format!("<use href='#n{}'/>", k - 1).repeat(2);
        many.push_str(&format!("<g id='n{k}'>{twice}</g>"));
    }
    assert!(svg_shapes(&(many + "</svg>")).is_err());
}
