//! Every variant written and read, damaged files, and the limits of a variant.

use super::*;
use crate::{FilePosition, StructuredGrid, WriteError};

fn blocks(three: bool, many: bool, deep: bool) -> Vec<StructuredGrid> {
    let one = |m: usize, n: usize, k: usize, shift: f64| {
        let count = m * n * k;
        let plane =
            |c: usize| -> Vec<f64> {
                (0..count)
                    .map(|p| {
                        if c == 2 && !three { 0.0 } else { shift + 0.5 * p as f64 - 3.0 * c as f64 }
                    })
                    .collect()
            };
        let iblank = Some((0..count as i32).map(|p| p % 3 - 1).collect());
        StructuredGrid { size: [m, n, k], planes: [plane(0), plane(1), plane(2)], iblank }
    };
    let k = if deep && three { 4 } else { 1 };
    let mut all = vec![one(5, 3, k, 0.25)];
    if many {
        all.push(one(2, 7, k, -8.0));
    }
    all
}

fn variants() -> Vec<Variant> {
    let mut all = Vec::new();
    for laid in [Laid::Formatted, Laid::Stream, Laid::Unformatted] {
        for bits in 0..128u32 {
            let bit = |k: u32| bits >> k & 1 == 1;
            let variant = Variant {
                laid,
                double: bit(0),
                multi: bit(1),
                three: bit(2),
                iblank: bit(3),
                big_endian: bit(4),
                mark: if bit(5) { 8 } else { 4 },
                planes: bit(6),
            };
            // Not supported by the layout.
            let text = laid == Laid::Formatted && (!variant.double || variant.big_endian);
            let marks = laid != Laid::Unformatted && (variant.mark == 8 || variant.planes);
            let flat_planes = variant.planes && !variant.three;
            if !(text || marks || flat_planes) {
                all.push(variant);
            }
        }
    }
    all
}

#[test]
fn every_variant_is_recognised_and_comes_back() {
    let mut tried = 0;
    for variant in variants() {
        for deep in [false, true] {
            if variant.planes && !deep {
                continue;
            }
            let mut given = blocks(variant.three, variant.multi, deep);
            if !variant.iblank {
                given.iter_mut().for_each(|b| b.iblank = None);
            }
            let bytes = write(&given, variant).unwrap();
            let (back, found) = read(&bytes).unwrap_or_else(|e| panic!("{variant}: {e}"));
            assert_eq!(found, variant, "{variant} was taken for {found}");
            assert_eq!(back, given, "{variant}");
            assert_eq!(write(&back, found).unwrap(), bytes);
            tried += 1;
        }
    }
    assert!(tried > 120, "{tried}");
}

#[test]
fn cut_off_and_damaged_files_are_refused() {
    for variant in variants() {
        let given = blocks(variant.three, variant.multi, variant.planes);
        let bytes = write(&given, variant).unwrap();
        for end in [0, 3, 9, bytes.len() / 2, bytes.len() - 1] {
            let cut = &bytes[..end];
            // Text may lose its last line end and nothing else.
            if variant.laid == Laid::Formatted && end == bytes.len() - 1 {
                continue;
            }
            match read(cut) {
                Err(error) => assert!(!error.expected.is_empty() && !error.found.is_empty()),
                Ok((_, found)) => panic!("{variant} cut at {end} was taken for {found}"),
            }
        }
    }
    let text = b"1\n2 2 1\n0.5 1.5 0.5 1.5\n0.25 0.25 1.5 1.5\n0.5 0.5 0.5\n";
    let error = read(text).unwrap_err().to_string();
    assert!(error.contains("12 coordinates") && error.contains("11 numbers"), "{error}");
    let bytes = write(
        &blocks(true, true, false),
        Variant { laid: Laid::Unformatted, ..Variant::default() },
    )
    .unwrap();
    let error = read(&bytes[..bytes.len() - 60]).unwrap_err().to_string();
    assert!(error.contains("a record of"), "{error}");
    let stream = write(&blocks(true, true, false), Variant::default()).unwrap();
    let error = read(&stream[..stream.len() - 8]).unwrap_err().to_string();
    assert!(error.contains("bytes of coordinates"), "{error}");
    for damaged in crate::fixtures::damaged(&stream).take(400) {
        let _ = read(&damaged);
    }
    for damaged in crate::fixtures::damaged(text).take(400) {
        let _ = read(&damaged);
    }
    assert!(read(b"").is_err() && read(b"1 1000000000 1000000000 1").is_err());
    assert!(read(b"900000000*1").is_err());
}

#[test]
fn what_is_no_number_is_told_with_its_place() {
    let mut given = blocks(true, true, false);
    given[1].planes[1][3] = 12345.678;
    for laid in [Laid::Stream, Laid::Unformatted] {
        let mut bytes = write(&given, Variant { laid, ..Variant::default() }).unwrap();
        let marked = 12345.678f64.to_le_bytes();
        let at = bytes.windows(8).position(|eight| eight == marked).unwrap();
        bytes[at..at + 8].copy_from_slice(&f64::NAN.to_le_bytes());
        let error = read(&bytes).unwrap_err();
        assert_eq!(error.place, FilePosition::Block(2));
        assert_eq!(error.found, "y = NaN at point [2,2,1]");
    }
    for (word, expected) in
        [("nan", "a finite number"), ("1e999", "a finite number"), ("abc", "a number")]
    {
        let text = format!("1\n2 2 1\n1 2 3 4\n1 {word} 1 1\n0 0 0 0\n");
        let error = read(text.as_bytes()).unwrap_err();
        assert_eq!((error.place, error.expected.as_str()), (FilePosition::Line(4), expected));
        assert_eq!(error.found, format!("`{word}`"));
    }
}

#[test]
fn fortran_text_with_repeats_and_doubles() {
    let text = b" 2, 2\n 0.0D0 1.0D+00 2*0.5\n 2*0.0, 2*1.E0\n";
    let (blocks, variant) = read(text).unwrap();
    assert_eq!((variant.multi, variant.three), (false, false));
    assert_eq!(blocks[0].planes[0], [0.0, 1.0, 0.5, 0.5]);
    assert_eq!(blocks[0].planes[1], [0.0, 0.0, 1.0, 1.0]);
}

#[test]
fn records_in_several_parts() {
    // gfortran splits records beyond 2 GiB; here, each record of coordinates into two.
    let given = blocks(true, false, false);
    let one = Variant { laid: Laid::Unformatted, multi: false, iblank: true, ..Variant::default() };
    let whole = write(&given, one).unwrap();
    let data = &whole[24..whole.len() - 4];
    let (head, tail) = data.split_at(100);
    let mut split = whole[..20].to_vec();
    for (lead, part, trail) in
        [(-100i32, head, 100i32), (tail.len() as i32, tail, -(tail.len() as i32))]
    {
        split.extend(lead.to_le_bytes());
        split.extend_from_slice(part);
        split.extend(trail.to_le_bytes());
    }
    assert_eq!(read(&split).unwrap().0, given);
}

#[test]
fn sizes_of_files() {
    let n = 60 * 20;
    let body = StructuredGrid {
        size: [60, 20, 1],
        planes: [vec![0.5; n], vec![0.25; n], vec![1.5; n]],
        iblank: None,
    };
    let size = |variant: Variant| write(std::slice::from_ref(&body), variant).unwrap().len();
    let records = Variant { laid: Laid::Unformatted, ..Variant::default() };
    assert_eq!(size(Variant::default()), 28816);
    assert_eq!(size(records), 28840);
    assert_eq!(size(Variant { multi: false, ..records }), 28828);
    assert_eq!(size(Variant { iblank: true, ..records }), 28840 + 4800);
}

#[test]
fn what_a_variant_cannot_hold_is_refused() {
    let deep = blocks(true, true, true);
    let single = Variant { multi: false, ..Variant::default() };
    assert!(matches!(write(&deep, single), Err(WriteError::CannotHold { .. })));
    let flat = Variant { three: false, ..Variant::default() };
    assert!(matches!(write(&deep, flat), Err(WriteError::CannotHold { .. })));
    assert!(matches!(write(&[], flat), Err(WriteError::NoGrid { .. })));
    let mut huge = blocks(true, false, false);
    huge[0].planes[1][3] = 1e200;
    let floats = Variant { double: false, ..Variant::default() };
    assert!(matches!(write(&huge, floats), Err(WriteError::NotFinite { vertex: 3, .. })));
}

#[test]
fn layers_too_thin_for_single_precision_are_refused_by_place() {
    // Layers at a wall at x = 1 whose first is 1e-8; numbers there are 1.2e-7 apart.
    let grid = |first: f64| StructuredGrid {
        size: [2, 1, 3],
        planes: [
            vec![1.0, 1.0, 1.0 + first, 1.0 + first, 1.1, 1.1],
            vec![0.0, 1.0, 0.0, 1.0, 0.0, 1.0],
            vec![0.0; 6],
        ],
        iblank: None,
    };
    let single = Variant { double: false, ..Variant::default() };
    let error = write(&[grid(1e-3), grid(1e-8)], Variant { multi: true, ..single }).unwrap_err();
    let text = error.to_string();
    assert!(
        text.contains(
            "(1, 1, 1) and (1, 1, 2) of block 2 would be 0.000e0 apart, where they are 1.000e-8"
        ),
        "{text}"
    );
    write(&[grid(1e-5)], single).unwrap();
    write(&[grid(1e-8)], Variant { double: true, ..single }).unwrap();
}

/// A solution file as a flow solver writes it, in one of the three layouts.
fn solution_file(
    sizes: &[[usize; 3]],
    axes: usize,
    laid: Laid,
    multi: bool,
    double: bool,
) -> Vec<u8> {
    let number = |x: f64| match double {
        true => x.to_le_bytes().to_vec(),
        false => (x as f32).to_le_bytes().to_vec(),
    };
    let header = sizes.iter().flat_map(|s| s[..axes].iter().map(|n| *n as i32));
    let conditions = [0.84, 3.06, 1.1e7, 0.0];
    let values = |size: &[usize; 3]| {
        let count: usize = size.iter().product::<usize>() * (axes + 2);
        (0..count).map(|k| 0.5 + 0.01 * k as f64).collect::<Vec<_>>()
    };
    if laid == Laid::Formatted {
        let mut text = if multi { format!("{}\n", sizes.len()) } else { String::new() };
        text += &header.map(|n| n.to_string()).collect::<Vec<_>>().join(" ");
        for size in sizes {
            for row in [conditions.to_vec(), values(size)] {
                text += "\n";
                text += &row.iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(" ");
            }
        }
        return text.into_bytes();
    }
    let mut records = Vec::new();
    if multi {
        records.push((sizes.len() as i32).to_le_bytes().to_vec());
    }
    records.push(header.flat_map(i32::to_le_bytes).collect());
    for size in sizes {
        records.push(conditions.iter().flat_map(|x| number(*x)).collect());
        records.push(values(size).iter().flat_map(|x| number(*x)).collect());
    }
    let marked = |record: Vec<u8>| {
        let mark = (record.len() as u32).to_le_bytes().to_vec();
        if laid == Laid::Stream { record } else { [&mark[..], &record, &mark].concat() }
    };
    records.into_iter().flat_map(marked).collect()
}

#[test]
fn solution_files_are_named() {
    let two = [[5, 4, 3], [7, 3, 3]];
    for laid in [Laid::Unformatted, Laid::Stream, Laid::Formatted] {
        for (sizes, multi) in [(&two[..1], false), (&two[..1], true), (&two[..], true)] {
            for axes in [2, 3] {
                let flat: Vec<_> =
                    sizes.iter().map(|s| [s[0], s[1], if axes == 3 { s[2] } else { 1 }]).collect();
                for double in [false, true] {
                    let error = read(&solution_file(&flat, axes, laid, multi, double)).unwrap_err();
                    let text = error.to_string();
                    assert!(text.contains("solution (q) file"), "{laid:?} {axes} {multi}: {text}");
                }
            }
        }
    }
}
