//! Names of files that a program may write.

use moldloft_lang::parts::inside;

#[test]
fn names_stay_inside() {
    assert_eq!(inside("a/./b.x").unwrap(), "a/b.x");
    assert_eq!(inside("a\\b.x").unwrap(), "a/b.x");
    for bad in ["/a", "../a", "a/../../b", "", ".", "a/", "C:/a", "a\nb"] {
        assert_eq!(inside(bad).unwrap_err().id, "outside-folder", "{bad:?}");
    }
}
