//! Patterns of C's printf.

use moldloft_lang::parts::{FormatArgument, format};

fn one(pattern: &str, x: f64) -> String {
    format(pattern, &[FormatArgument::Number(x)]).unwrap()
}

#[test]
fn numbers_as_c_writes_them() {
    assert_eq!(one("%12.6f|", std::f64::consts::PI), "    3.141593|");
    assert_eq!(one("%-8.2f|", -1.005), "-1.00   |");
    assert_eq!(one("%+d", 7.0), "+7");
    assert_eq!(one("%05d", -42.0), "-0042");
    assert_eq!(one("%.3e", 12345.678), "1.235e+04");
    assert_eq!(one("%e", 1e-120), "1.000000e-120");
    assert_eq!(one("%g", 0.0001), "0.0001");
    assert_eq!(one("%g", 0.00001), "1e-05");
    assert_eq!(one("%g", 1234567.0), "1.23457e+06");
    assert_eq!(one("%.10g", 2.6339134382131846), "2.633913438");
    assert_eq!(one("%.1f", -0.04), "0.0");
    assert_eq!(one("%s %%", 0.1), "0.1 %");
    assert_eq!(one("%G", 1e300), "1E+300");
    let items =
        [FormatArgument::Number(1.0), FormatArgument::Number(2.0), FormatArgument::Number(3.0)];
    assert_eq!(format("%g ", &items).unwrap(), "1 2 3 ");
    assert_eq!(format("%g, %g; ", &items).unwrap(), "1, 2; 3, ");
    assert_eq!(
        format(
            "%5s|%-5.2s|",
            &[FormatArgument::Text("ab".into()), FormatArgument::Text("abc".into())]
        )
        .unwrap(),
        "   ab|ab   |"
    );
}

#[test]
fn faults() {
    let id = |pattern: &str, items: &[FormatArgument]| {
        format(pattern, items).unwrap_err().id.to_string()
    };
    assert_eq!(id("%q", &[FormatArgument::Number(1.0)]), "wrong-format");
    assert_eq!(id("%", &[]), "wrong-format");
    assert_eq!(id("%d", &[FormatArgument::Number(1.5)]), "wrong-format");
    assert_eq!(id("%f", &[FormatArgument::Text("x".into())]), "wrong-format");
    assert_eq!(id("%9999f", &[FormatArgument::Number(1.0)]), "wrong-format");
    assert_eq!(id("%f", &[]), "missing-argument");
    assert_eq!(id("no", &[FormatArgument::Number(1.0)]), "too-many-arguments");
}
