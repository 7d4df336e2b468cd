//! Letters of lines as spellings of sets of axes.

use moldloft_sketch::{CoordinateAxis, Free, Letters, Naming};

#[test]
fn letters_are_spellings_of_sets() {
    let standard = Letters::default();
    let y_up = Letters { up: CoordinateAxis::Y, ..standard };
    let seed = Letters { naming: Naming::Seed, ..standard };
    for (letters, h, p, f) in
        [(standard, "XY", "YZ", "XZ"), (y_up, "XZ", "YZ", "XY"), (seed, "XY", "XZ", "YZ")]
    {
        for (letter, set) in [("H", h), ("P", p), ("f", f)] {
            let free = letters.free(letter, None).unwrap();
            assert_eq!(free.spelling(), set);
            assert_eq!(letters.free(set, None), Some(free));
            assert!(letters.letter(free, None).eq_ignore_ascii_case(letter));
        }
    }
    assert_eq!(standard.free("F", Some(CoordinateAxis::Z)).unwrap().spelling(), "XY");
    assert_eq!(standard.free("Q", None), None);
    assert_eq!(Free::OBLIQUE.axes().count(), 3);
    assert_eq!(
        Free::across(CoordinateAxis::X).swapped(CoordinateAxis::X, CoordinateAxis::Y),
        Free::across(CoordinateAxis::Y)
    );
    assert_eq!(Free::along(CoordinateAxis::Y).single(), Some(CoordinateAxis::Y));
}
