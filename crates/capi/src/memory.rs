//! Pointers of the caller, codes and messages.

use crate::{MLF_ARGUMENT, MLF_BUFFER, MLF_INTERNAL, MLF_MODEL, MLF_OK};
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};

thread_local! {
    static MESSAGE: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Why a call failed.
pub struct StatusError {
    code: i32,
    message: String,
}

impl StatusError {
    pub fn argument(message: &str) -> Self {
        Self { code: MLF_ARGUMENT, message: message.into() }
    }

    pub fn model(message: String) -> Self {
        Self { code: MLF_MODEL, message: message.trim_end().into() }
    }
}

/// Runs a call: its code, its message kept for the thread.
pub fn called(work: impl FnOnce() -> Result<(), StatusError>) -> i32 {
    let fault = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => return MLF_OK,
        Ok(Err(fault)) => fault,
        Err(_) => StatusError { code: MLF_INTERNAL, message: "an error inside the library".into() },
    };
    set_message(fault.message);
    fault.code
}

pub fn set_message(message: String) {
    MESSAGE.with(|slot| *slot.borrow_mut() = message);
}

/// Copies the message; its length.
pub fn words(buffer: *mut u8, size: usize) -> usize {
    MESSAGE.with(|slot| {
        let message = slot.borrow();
        if let Ok(out) = array_mut(buffer, size.min(message.len())) {
            out.copy_from_slice(&message.as_bytes()[..out.len()]);
        }
        message.len()
    })
}

/// An array of the caller's, to read.
pub fn array<'a, T>(start: *const T, count: usize) -> Result<&'a [T], StatusError> {
    if count == 0 {
        return Ok(&[]);
    }
    check(start.cast(), align_of::<T>())?;
    // SAFETY: the caller passes `count` elements, by the contract of the header; not null, aligned.
    Ok(unsafe { std::slice::from_raw_parts(start, count) })
}

/// An array of the caller's, to write.
pub fn array_mut<'a, T>(start: *mut T, count: usize) -> Result<&'a mut [T], StatusError> {
    if count == 0 {
        return Ok(&mut []);
    }
    check(start.cast(), align_of::<T>())?;
    // SAFETY: as above, and no other call uses it meanwhile.
    Ok(unsafe { std::slice::from_raw_parts_mut(start, count) })
}

fn check(start: *const u8, alignment: usize) -> Result<(), StatusError> {
    if start.is_null() {
        return Err(StatusError::argument("a pointer is null"));
    }
    if start.align_offset(alignment) != 0 {
        return Err(StatusError::argument("a pointer is not aligned"));
    }
    Ok(())
}

/// A text of the caller's; blanks at its end, with which Fortran fills, are left out.
pub fn text_of<'a>(start: *const u8, length: usize) -> Result<&'a str, StatusError> {
    let bytes = array(start, length)?;
    let text = std::str::from_utf8(bytes);
    let text = text.map_err(|_| StatusError::argument("a text is not UTF-8"))?;
    Ok(text.trim_end_matches([' ', '\0']))
}

/// Copies elements to the caller's array and stores their number.
pub fn copied<T: Copy>(
    all: &[T],
    out: *mut T,
    room: usize,
    count: *mut usize,
) -> Result<(), StatusError> {
    array_mut(count, 1)?[0] = all.len();
    if all.len() > room {
        let message = format!("the buffer holds {room} items, but {} are needed", all.len());
        return Err(StatusError { code: MLF_BUFFER, message });
    }
    array_mut(out, all.len())?.copy_from_slice(all);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_code_and_buffers_are_not_overrun() {
        assert_eq!(called(|| panic!("asked for")), MLF_INTERNAL);
        let mut few = [b'.'; 8];
        let needed = words(few.as_mut_ptr(), 5);
        assert_eq!((needed, &few), (27, b"an er..."));
        assert_eq!(words(std::ptr::null_mut(), 0), 27);
        let mut count = 0;
        let mut out = [0u8; 2];
        let copy = || copied(&[1u8, 2, 3], out.as_mut_ptr(), 2, &raw mut count);
        assert_eq!(called(copy), MLF_BUFFER);
        assert_eq!((count, out), (3, [0; 2]));
        assert_eq!(called(|| text_of(std::ptr::null(), 3).map(drop)), MLF_ARGUMENT);
        assert_eq!(called(|| text_of([0xffu8].as_ptr(), 1).map(drop)), MLF_ARGUMENT);
        assert!(matches!(text_of(b"hull  ".as_ptr(), 6), Ok("hull")));
    }
}
