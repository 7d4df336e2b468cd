//! Placement of texts in a picture without overlap.

use moldloft_sketch::parts::apart;

#[test]
fn texts_stand_apart() {
    let mut taken = Vec::new();
    let places = [(); 3].map(|()| apart([10.0, 50.0], "BASE 8", &mut taken));
    assert_eq!(places, [[10.0, 50.0], [10.0, 65.0], [10.0, 35.0]]);
    assert_eq!(apart([60.0, 50.0], "TOE 12", &mut taken), [60.0, 50.0]);
    // Without free space a text is at its preferred position.
    for _ in 0..20 {
        apart([10.0, 50.0], "BASE 8", &mut taken);
    }
    assert_eq!(apart([10.0, 50.0], "BASE 8", &mut taken), [10.0, 50.0]);
}
