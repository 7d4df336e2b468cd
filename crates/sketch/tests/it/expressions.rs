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
        ("log10(100) + log(exp(2))", 4.0),
        ("hypot(3, 4) + sign(-B.w) + div(7, 2)", 7.0),
        ("cosh(0) + sinh(0) + tanh(0)", 1.0),
        ("max(1, A, B.w, 3)", 5.0),
        ("clamp(B.w, 0, A)", 2.0),
        ("where(A < B.w and not (A == 3), A + 1, 7)", 3.0),
        ("where(A >= B.w || A != 2, A + 1, 7)", 7.0),
    ] {
        let got = value(text).unwrap().unwrap();
        assert!((got - expected).abs() < 1e-14, "{text}: {got}");
    }
    for k in -300..=300 {
        assert_eq!(value(&format!("log10(1e{k})")).unwrap(), Ok(f64::from(k)));
    }
    assert_eq!(value("c+1").unwrap(), Err(NoValue { name: "c".into() }));
    for bad in [
        "",
        "1 +",
        "foo(1)",
        "sin(1,2)",
        "{1,2}",
        "where(1, 2, 3)",
        "(a < b) + 1",
        "where(a < b, a < b, 1)",
        "a < b",
        "\"x\"",
        "not a",
    ] {
        assert!(value(bad).is_err(), "{bad}");
    }
    let renamed = DimensionExpr::parse("W1 + w10*2").unwrap();
    let renamed = renamed.renamed(&|n| (n == "w1").then(|| "a.w1".to_owned()));
    assert_eq!(renamed.text(), "a.w1 + w10*2");
    assert_eq!(DimensionExpr::parse("-3").unwrap().literal(), Some(-3.0));
}
