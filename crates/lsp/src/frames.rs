//! Messages on a stream: a head with the length, a blank line, JSON.

use serde_json::Value;
use std::io::{self, BufRead, Write};

/// The longest message.
const LONGEST: usize = 64 << 20;

/// The next message; `None` at the end of the stream.
///
/// # Errors
/// When the stream breaks off or holds no message.
pub fn read(input: &mut impl BufRead) -> io::Result<Option<Value>> {
    let broken = |what: &str| io::Error::new(io::ErrorKind::InvalidData, what.to_string());
    let mut length = None;
    loop {
        let mut line = String::new();
        if input.read_line(&mut line)? == 0 {
            return match length {
                None => Ok(None),
                Some(_) => Err(broken("the message breaks off")),
            };
        }
        let line = line.trim_end();
        if line.is_empty() {
            break;
        }
        if let Some((name, value)) = line.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            let n: usize =
                value.trim().parse().map_err(|_| broken("the length is not a number"))?;
            if n > LONGEST {
                return Err(broken("the message is too long"));
            }
            length = Some(n);
        }
    }
    let length = length.ok_or_else(|| broken("the message has no Content-Length"))?;
    let mut bytes = vec![0; length];
    input.read_exact(&mut bytes)?;
    serde_json::from_slice(&bytes).map(Some).map_err(|e| broken(&e.to_string()))
}

/// Writes a message.
///
/// # Errors
/// When the stream is closed.
pub fn write(output: &mut impl Write, message: &Value) -> io::Result<()> {
    let text = message.to_string();
    write!(output, "Content-Length: {}\r\n\r\n{text}", text.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_is_written_is_read() {
        let mut bytes = Vec::new();
        write(&mut bytes, &json!({"é": [1, 2]})).unwrap();
        write(&mut bytes, &json!(null)).unwrap();
        let mut input = &bytes[..];
        assert_eq!(read(&mut input).unwrap(), Some(json!({"é": [1, 2]})));
        assert_eq!(read(&mut input).unwrap(), Some(json!(null)));
        assert_eq!(read(&mut input).unwrap(), None);
        for bad in ["Content-Length: 5\r\n\r\n{}", "x\r\n\r\n{}", "Content-Length: 2\r\n\r\n{]"] {
            assert!(read(&mut bad.as_bytes()).is_err(), "{bad}");
        }
    }
}
