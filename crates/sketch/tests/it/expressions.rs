//! Expressions of dimensions.

use moldloft_sketch::{DimensionExpr, NoValue};

#[test]
fn values_and_names() {
    let value = |text: &str| {
        let names = |n: &str| match n {
            "a" => Some(2.0),
            "b.w" => Some(5.0),
            _ => None,
        };
        DimensionExpr::parse(text).map(|e| e.eval::<f64>(&names))
    };
    for (text, expected) in [
        ("-A^2", -4.0),
        ("2^3^2", 512.0),
        ("(1+2)*3/4-1", 1.25),
        ("sqrt(B.w*5)", 5.0),
        ("sin(30)", 0.5),
        ("atan(1)", 45.0),
        ("(-A)^3", -8.0),
        ("pi/PI", 1.0),
        ("min(A, 3) + max(1, B.w)", 7.0),
        ("atan2(1, -1)", 135.0),
        ("mod(-1, 3) + floor(2.7)", 4.0),
    ] {
        let got = value(text).unwrap().unwrap();
        assert!((got - expected).abs() < 1e-14, "{text}: {got}");
    }
    assert_eq!(value("c+1").unwrap(), Err(NoValue { name: "c".into() }));
    for bad in ["", "1 +", "foo(1)", "sin(1,2)", "{1,2}", "a < b", "\"x\"", "not a"] {
        assert!(value(bad).is_err(), "{bad}");
    }
    let renamed = DimensionExpr::parse("W1 + w10*2").unwrap();
    let renamed = renamed.renamed(&|n| (n == "w1").then(|| "a.w1".to_owned()));
    assert_eq!(renamed.text(), "a.w1 + w10*2");
    assert_eq!(DimensionExpr::parse("-3").unwrap().literal(), Some(-3.0));
}
