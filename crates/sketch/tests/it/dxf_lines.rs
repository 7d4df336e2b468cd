//! Lines of DXF files.

use moldloft_sketch::Drawing;
use moldloft_sketch::dxf::dxf_shapes;
use moldloft_sketch::page_shapes::draw;

#[test]
fn lines_and_polylines() {
    let text = "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n0\n20\n0\n30\n0\n11\n4\n21\n0\n31\n0\n\
                0\nLWPOLYLINE\n70\n1\n10\n4\n20\n0\n10\n4\n20\n3\n10\n0\n20\n3\n0\nENDSEC\n0\nEOF\n";
    let strokes = dxf_shapes(text).unwrap().strokes;
    assert_eq!(strokes.len(), 4);
    let mut drawing = Drawing::default();
    assert_eq!(draw(&mut drawing, &strokes, 1e-6), (4, 4));
    assert_eq!(draw(&mut drawing, &strokes, 1e-6), (0, 0));
    for bad in ["", "x\ny\n", "0\n", "0\nLINE\n10\nabc\n", "0\nSECTION\n0\nLINE\n10\nnan\n"] {
        assert!(dxf_shapes(bad).is_err(), "{bad}");
    }
}
