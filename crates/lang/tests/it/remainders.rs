//! The quick remainder of small whole numbers.

use moldloft_lang::parts::small_remainder;
use moldloft_num::remainder;

#[test]
fn small_remainders_are_the_general_ones() {
    for a in (0..3000).map(f64::from).chain([0.5, 1e9, 1_073_741_823.0, 1e15, f64::NAN, -7.0]) {
        for b in (0..70).map(f64::from).chain([0.5, 97.0, 1e9, 1_073_741_823.0, -3.0]) {
            if let Some(rest) = small_remainder(a, b) {
                assert_eq!(rest.to_bits(), remainder(a, b).to_bits(), "{a} {b}");
            }
        }
    }
    assert_eq!(small_remainder(1_073_741_823.0, 10.0), Some(3.0));
    assert!(
        [(0.5, 2.0), (3.0, 0.0), (-3.0, 2.0), (1e15, 3.0)]
            .iter()
            .all(|&(a, b)| small_remainder(a, b).is_none())
    );
}
