//! Plot3D out: grids of points in the variant that the caller chose.

use super::variant::{FORMAT, Laid, Variant};
use crate::text::real;
use crate::{StructuredGrid, WriteError};

/// The file of these blocks.
///
/// # Errors
/// No blocks; coordinates that are not finite or beyond single precision, cells too thin for it; several blocks in a
/// single-block file; blocks that are no plane surfaces in a 2-D file; sizes beyond 31 bits.
pub fn write(blocks: &[StructuredGrid], variant: Variant) -> Result<Vec<u8>, WriteError> {
    let single = !variant.double && variant.laid != Laid::Formatted;
    StructuredGrid::check(blocks, if single { f64::from(f32::MAX) } else { f64::MAX })?;
    if single {
        StructuredGrid::check_single(blocks, FORMAT)?;
    }
    let cannot = |what| WriteError::CannotHold { format: FORMAT, what };
    if !variant.multi && blocks.len() != 1 {
        return Err(cannot("several blocks in a single-block file"));
    }
    for block in blocks {
        let flat = block.size[2] == 1 && block.planes[2].iter().all(|z| *z == 0.0);
        if !variant.three && !flat {
            return Err(cannot("z in a 2-D file"));
        }
        if variant.iblank && block.iblank.as_ref().is_some_and(|b| b.len() != block.count()) {
            return Err(cannot("blanking of some points only"));
        }
    }
    let mut out = Out { variant, bytes: Vec::new() };
    let integer = |n: usize| {
        i32::try_from(n).map_err(|_| WriteError::TooLarge { what: "points of a block", count: n })
    };
    let axes = if variant.three { 3 } else { 2 };
    let mut sizes = Vec::new();
    for block in blocks {
        for n in &block.size[..axes] {
            sizes.push(integer(*n)?);
        }
    }
    if variant.multi {
        out.record(&[RecordPart::Integers(&[integer(blocks.len())?])])?;
    }
    out.record(&[RecordPart::Integers(&sizes)])?;
    for block in blocks {
        let ones;
        let blank = match &block.iblank {
            Some(blank) => blank,
            None => {
                ones = vec![1; block.count()];
                &ones
            }
        };
        let [ni, nj, nk] = block.size;
        let (step, layers) = if variant.planes { (ni * nj, nk) } else { (block.count(), 1) };
        for layer in 0..layers {
            let range = layer * step..(layer + 1) * step;
            let mut parts: Vec<RecordPart> = block.planes[..axes]
                .iter()
                .map(|plane| RecordPart::Reals(&plane[range.clone()]))
                .collect();
            if variant.iblank {
                parts.push(RecordPart::Integers(&blank[range.clone()]));
            }
            out.record(&parts)?;
        }
    }
    Ok(out.bytes)
}

enum RecordPart<'a> {
    Integers(&'a [i32]),
    Reals(&'a [f64]),
}

struct Out {
    variant: Variant,
    bytes: Vec<u8>,
}

impl Out {
    fn put<const N: usize>(&mut self, little: [u8; N]) {
        let mut bytes = little;
        if self.variant.big_endian {
            bytes.reverse();
        }
        self.bytes.extend_from_slice(&bytes);
    }

    fn mark(&mut self, length: usize) -> Result<(), WriteError> {
        if self.variant.laid != Laid::Unformatted {
            return Ok(());
        }
        if self.variant.mark == 8 {
            self.put((length as u64).to_le_bytes());
            return Ok(());
        }
        let length = i32::try_from(length)
            .map_err(|_| WriteError::TooLarge { what: "bytes of a record", count: length })?;
        self.put(length.to_le_bytes());
        Ok(())
    }

    fn record(&mut self, parts: &[RecordPart]) -> Result<(), WriteError> {
        if self.variant.laid == Laid::Formatted {
            for part in parts {
                self.text(part);
            }
            return Ok(());
        }
        let width = if self.variant.double { 8 } else { 4 };
        let length = |part: &RecordPart| match part {
            RecordPart::Integers(all) => 4 * all.len(),
            RecordPart::Reals(all) => width * all.len(),
        };
        let length = parts.iter().map(length).sum();
        self.mark(length)?;
        for part in parts {
            match part {
                RecordPart::Integers(all) => all.iter().for_each(|x| self.put(x.to_le_bytes())),
                // Adding zero turns -0 into 0.
                RecordPart::Reals(all) if self.variant.double => {
                    all.iter().for_each(|x| self.put((x + 0.0).to_le_bytes()));
                }
                RecordPart::Reals(all) => {
                    all.iter().for_each(|x| self.put((*x as f32 + 0.0).to_le_bytes()))
                }
            }
        }
        self.mark(length)
    }

    fn text(&mut self, part: &RecordPart) {
        let words: Vec<String> = match part {
            RecordPart::Integers(all) => all.iter().map(|x| x.to_string()).collect(),
            RecordPart::Reals(all) => all.iter().map(|x| real(*x)).collect(),
        };
        for line in words.chunks(6) {
            self.bytes.extend_from_slice(line.join(" ").as_bytes());
            self.bytes.push(b'\n');
        }
    }
}
