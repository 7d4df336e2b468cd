//! Words for units in model files.

use moldloft_lang::model_file::units::parsed;

#[test]
fn one_unit_of_a_dimension() {
    let words = |text: &str| parsed(text).map(|u| u.iter().map(|u| u.0).collect::<Vec<_>>());
    assert_eq!(words("m t kN"), Ok(vec!["m", "t", "kN"]));
    assert_eq!(words("ft, lb, sec"), Ok(vec!["ft", "lb"]));
    assert_eq!(words(""), Ok(vec![]));
    assert_eq!(words("furlong"), Err("furlong".into()));
    assert_eq!(words("m ft"), Err("ft".into()));
    assert_eq!(words("Ft KG"), Ok(vec!["ft", "kg"]));
}
