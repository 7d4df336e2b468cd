//! Messages between an engine process and its parent: frames on standard input and output.
//! `u32 length (little endian), length bytes`. The engine defines the content: requests and replies
//! of a session, or messages of the language server.

use std::io::{self, Read, Write};

/// Maximum length of a frame, in bytes.
pub const LONGEST_FRAME: u32 = 1 << 30;

/// Reads the next frame; `None` at a regular end of input. Memory grows with the bytes received,
/// not with the announced length.
///
/// # Errors
/// If the input ends within a frame, or a frame is longer than [`LONGEST_FRAME`].
///
/// ```
/// use moldloft_budget::{read_frame, write_frame};
///
/// let mut pipe = Vec::new();
/// write_frame(&mut pipe, b"ping")?;
/// let mut input = pipe.as_slice();
/// assert_eq!(read_frame(&mut input)?.as_deref(), Some(&b"ping"[..]));
/// assert_eq!(read_frame(&mut input)?, None);
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn read_frame(input: &mut impl Read) -> io::Result<Option<Vec<u8>>> {
    let mut length = Vec::with_capacity(4);
    input.by_ref().take(4).read_to_end(&mut length)?;
    let Ok(length) = <[u8; 4]>::try_from(length.as_slice()) else {
        return if length.is_empty() { Ok(None) } else { Err(io::ErrorKind::UnexpectedEof.into()) };
    };
    let length = u32::from_le_bytes(length);
    if length > LONGEST_FRAME {
        return Err(io::ErrorKind::InvalidData.into());
    }
    let mut frame = Vec::new();
    input.by_ref().take(length.into()).read_to_end(&mut frame)?;
    if frame.len() < length as usize {
        Err(io::ErrorKind::UnexpectedEof.into())
    } else {
        Ok(Some(frame))
    }
}

/// Writes a frame.
///
/// # Errors
/// If the reader has closed the pipe, or there are more bytes than [`LONGEST_FRAME`].
pub fn write_frame(output: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    let length = u32::try_from(bytes.len()).ok().filter(|length| *length <= LONGEST_FRAME);
    let length = length.ok_or(io::ErrorKind::InvalidInput)?;
    output.write_all(&length.to_le_bytes())?;
    output.write_all(bytes)?;
    output.flush()
}
