//! Numbers as text.

/// The shortest text that reads back as the same double, written as a float of the language.
///
/// Rules: a float always shows that it is one (`1.0`, `2.5e-7`, never `1`); exponents are used below 1e-5 and from
/// 1e16 on; minus zero prints as `0.0`. Infinities and NaN have no spelling in any of our texts and must not come here;
/// they print as `inf` and `nan`, which no reader accepts.
///
/// ```
/// use moldloft_syntax::number::float;
/// assert_eq!([float(1.0), float(0.1), float(-2.5e-7), float(1e16), float(-0.0)], ["1.0", "0.1", "-2.5e-7", "1e16", "0.0"]);
/// ```
pub fn float(value: f64) -> String {
    if value == 0.0 {
        return "0.0".to_owned();
    }
    if value.is_nan() {
        return "nan".to_owned();
    }
    format!("{value:?}")
}

/// The shortest text that reads back as the same double, written as integer or float: `1`, `0.1`,
/// `2.5e-7`.
///
/// ```
/// use moldloft_syntax::number::plain;
/// assert_eq!([plain(1.0), plain(-12.5), plain(1e21), plain(-0.0)], ["1", "-12.5", "1e21", "0"]);
/// ```
pub fn plain(value: f64) -> String {
    let mut text = float(value);
    if text.ends_with(".0") {
        text.truncate(text.len() - 2);
    }
    text
}

/// True if the value can be written with digits only and read back without loss: an integer below
/// 1e15.
pub fn is_whole(value: f64) -> bool {
    value.abs() < 1e15 && value == value.trunc()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_back_bit_for_bit() {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        for _ in 0..100_000 {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            let value = f64::from_bits(state);
            if value.is_finite() && value != 0.0 {
                assert_eq!(float(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
                assert_eq!(plain(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
                assert!(float(value).contains(['.', 'e']));
            }
        }
    }
}
