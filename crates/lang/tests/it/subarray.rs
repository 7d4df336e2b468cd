//! Sections of arrays, and sections of these.

use moldloft_lang::parts::{ArraySection, Selection, picked, put};
use moldloft_registry::ArrayShape;

#[test]
fn sections_of_sections() {
    let shape = ArrayShape::Grid(4, 5);
    let items: Vec<usize> = (0..20).collect();
    let column = ArraySection::Grid(Selection::whole(4), Selection::at(2));
    assert_eq!(picked(&items, shape, column), [2, 7, 12, 17]);
    let back = Selection { start: 3, step: -2, count: 2, keeps: true };
    let part = column.of(ArraySection::Row(back)).unwrap();
    assert_eq!(picked(&items, shape, part), [17, 7]);
    assert_eq!(part.shape(), Some(ArrayShape::Row(2)));
    let block = ArraySection::Grid(back, Selection { start: 1, step: 3, count: 2, keeps: true });
    assert_eq!(picked(&items, shape, block), [16, 19, 6, 9]);
    assert!(column.of(column).is_none());
    let mut copy = items.clone();
    put(&mut copy, shape, block, &[0, 0, 0, 1]);
    assert_eq!((copy[16], copy[19], copy[6], copy[9], copy[7]), (0, 0, 0, 1, 7));
    assert!(part.meets(column) && !part.meets(block));
    let face = ArraySection::Block(Selection::at(1), Selection::whole(5), Selection::whole(3));
    let edge = face.of(ArraySection::Grid(back, Selection::at(2))).unwrap();
    assert_eq!(edge, ArraySection::Block(Selection::at(1), back, Selection::at(2)));
    assert_eq!(
        (face.shape(), edge.shape()),
        (Some(ArrayShape::Grid(5, 3)), Some(ArrayShape::Row(2)))
    );
    assert!(edge.meets(face) && face.of(face).is_none());
    let rows =
        ArraySection::Grid(Selection { start: 1, ..Selection::whole(2) }, Selection::whole(5));
    assert_eq!(picked(&items, shape, rows), (5..15).collect::<Vec<_>>());
}
