//! The fuzz targets without libFuzzer: each over texts and files of its kind and thousands of
//! damaged copies, in the ordinary tests, with the stable compiler. `fuzz/` itself is guided by
//! coverage; its findings belong in `fuzz/corpus`, which is run here.

use moldloft::mesh::Mesh;
use moldloft_testing::{Random, rounds};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

macro_rules! targets {
    ($($name:ident: $path:literal),* $(,)?) => {
        $(
            #[allow(unused_attributes, missing_docs)]
            #[path = $path]
            mod $name;
        )*
        const TARGETS: &[(&str, fn(&[u8]))] = &[$((stringify!($name), $name::run)),*];
    };
}

targets! {
    document: "../../../../fuzz/fuzz_targets/document.rs",
    engine_messages: "../../../../fuzz/fuzz_targets/engine_messages.rs",
    expressions: "../../../../fuzz/fuzz_targets/expressions.rs",
    lsp_frames: "../../../../fuzz/fuzz_targets/lsp_frames.rs",
    model_file: "../../../../fuzz/fuzz_targets/model_file.rs",
    readers: "../../../../fuzz/fuzz_targets/readers.rs",
    sdl_format: "../../../../fuzz/fuzz_targets/sdl_format.rs",
    sdl_parse: "../../../../fuzz/fuzz_targets/sdl_parse.rs",
    sdl_run: "../../../../fuzz/fuzz_targets/sdl_run.rs",
    sketch: "../../../../fuzz/fuzz_targets/sketch.rs",
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The files below a folder whose names end so.
fn files(folder: &str, ending: &str) -> Vec<Vec<u8>> {
    let mut found = Vec::new();
    let mut open = vec![root().join(folder)];
    while let Some(folder) = open.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        let mut entries: Vec<PathBuf> = entries.flatten().map(|e| e.path()).collect();
        entries.sort();
        for path in entries {
            if path.is_dir() {
                open.push(path);
            } else if path.to_string_lossy().ends_with(ending) {
                found.push(std::fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// Originals of the damaged copies.
fn seeds(target: &str) -> Vec<Vec<u8>> {
    let texts = |all: &[&str]| all.iter().map(|t| t.as_bytes().to_vec()).collect::<Vec<_>>();
    let mut found = files(&format!("fuzz/corpus/{target}"), "");
    found.extend(match target {
        "expressions" => texts(&[
            "w + 2*sin(w)^2", "A", "l(0.5).x", "s(0.25, 0.75)", "m.length + s.area", "a[2:4] + {1, 2, 3}",
            "where(a > 0.5, a, -a)", "max(a, 0)", "{1, {2, 3}, \"x\"}", "|B - A| < 3 and not (w == 2)",
            "interp({0, 1}, {2, 3}, a)", "derivatives", "distance(l, m)", "hydrostatics.volume", "a[1:5:2] .* a",
        ]),
        "engine_messages" => texts(&[
            "{\"kind\":\"ping\",\"id\":1}",
            "{\"kind\":\"text\",\"id\":2,\"text\":\"AbsPoint A(0, 0, 0);\"}\n{\"kind\":\"set\",\"name\":\"w\",\"value\":2.5}",
            "{\"kind\":\"splice\",\"from\":0,\"to\":3,\"insert\":\"x\"}\n{\"kind\":\"subscribe\",\"names\":[\"l\"],\"id\":1}",
            "{\"kind\":\"ask\",\"ask\":\"hover\",\"offset\":12}\n{\"kind\":\"drag\",\"name\":\"B\",\"to\":[1,2,3]}",
            "{\"kind\":\"pick\",\"x\":0.5,\"y\":0.5}\n{\"kind\":\"export\",\"format\":\"stl\"}",
        ]),
        "lsp_frames" => texts(&[
            "Content-Length: 49\r\n\r\n{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"m\",\"params\":{}}",
            "content-length:2\r\nContent-Type: x\r\n\r\n[]nonsense\r\n\r\nContent-Length: 4\r\n\r\nnull",
            "Content-Length: 2\n\n{}Content-Length: 99999999999999999999\r\n\r\n{",
            "Content-Length: 41\r\n\r\n[{\"jsonrpc\":\"2.0\",\"method\":\"a\"},{\"id\":7}]",
        ]),
        "readers" => readers_seeds(),
        "model_file" => {
            let programs = files("examples", ".sdl");
            programs.iter().filter_map(|text| model_file_of(text)).collect()
        }
        "sketch" => files("examples", ".skt"),
        "document" => small(files("examples", ".sdl"), 3_000),
        "sdl_run" => small(files("tests/corpus", ".sdl"), 8_000),
        _ => files("tests/corpus", ".sdl").into_iter().chain(files("examples", ".sdl")).collect(),
    });
    assert!(!found.is_empty(), "nothing to begin with for {target}");
    found
}

/// Texts that run quickly.
fn small(all: Vec<Vec<u8>>, bytes: usize) -> Vec<Vec<u8>> {
    all.into_iter().filter(|text| text.len() <= bytes).collect()
}

fn model_file_of(text: &[u8]) -> Option<Vec<u8>> {
    use moldloft::document::{Document, ModelFormat, NoFiles, registry};
    let text = std::str::from_utf8(text).ok().filter(|text| text.len() < 4_000)?;
    let document = Document::from_text(registry(), Box::new(NoFiles), "seed.sdl", text);
    Some(document.convert(ModelFormat::ModelFile).ok()?.into_bytes())
}

/// Small files of each format; the first byte chooses the reader.
fn readers_seeds() -> Vec<Vec<u8>> {
    let triangle = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    let mut binary = vec![0u8; 80];
    binary.extend(1u32.to_le_bytes());
    binary.extend([0u8; 50]);
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let mut binary_ply =
        ply.split("0 0 0").next().unwrap().replace("ascii", "binary_little_endian").into_bytes();
    binary_ply
        .extend([0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes).concat());
    binary_ply.push(3);
    binary_ply.extend([0u32, 1, 2].map(u32::to_le_bytes).concat());
    let plain: [(u8, &[u8]); 12] = [
        (0, b"hull\n1.0 9.81\n0 1\n1\n0 0 0 1 0 0 1 0 -1 0 0 -1\n"),
        (1, b"o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2//1 4//1 3//1\nf -1 -2 -3 -4\n"),
        (2, triangle.as_bytes()),
        (2, &binary),
        (3, b"x,y,z\n0,0,0\n1,0.5,2\n"),
        (3, b"# stations\n0 0 0\n\n1.5e0 2 -3\n"),
        (4, b"NACA 0012\n1.0 0.0013\n0.5 0.0529\n0.0 0.0\n0.5 -0.0529\n1.0 -0.0013\n"),
        (6, ply.as_bytes()),
        (6, &binary_ply),
        (7, b"OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n4 0 1 3 2 0.5 0.5 0.5\n"),
        (8, b"1\n2 2 1\n0 1 0 1\n0 0 1 1\n0 0 0 0\n"),
        (8, b"2 2\n0 1 0 1 0 0 1 1 0 0 0 0\n"),
    ];
    plain.iter().map(|(which, bytes)| [&[*which], *bytes].concat()).collect()
}

/// A damaged copy: bytes, numbers, words, lines and ends of texts changed, doubled, exchanged, left out.
fn damaged(random: &mut Random, seeds: &[Vec<u8>]) -> Vec<u8> {
    const EXTREMES: [&str; 14] = [
        "0",
        "-1",
        "1e308",
        "-1e308",
        "1e-320",
        "nan",
        "inf",
        "9007199254740993",
        "99999999999",
        "2147483648",
        "-0",
        "\u{7f}",
        "\"",
        "{",
    ];
    let mut bytes = seeds[random.below(seeds.len())].clone();
    for _ in 0..1 + random.below(4) {
        if bytes.is_empty() {
            break;
        }
        let at = random.below(bytes.len());
        let end = (at + 1 + random.below(40)).min(bytes.len());
        match random.below(9) {
            0 => bytes[at] = random.bits() as u8,
            1 => bytes[at] ^= 1 << random.below(8),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let part = bytes[at..end].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, part);
            }
            4 => bytes.truncate(at),
            5 => {
                // A number or a word becomes an extreme.
                let word = |b: &u8| b.is_ascii_alphanumeric() || b"._-".contains(b);
                let start = bytes[..at].iter().rposition(|b| !word(b)).map_or(0, |k| k + 1);
                let stop =
                    bytes[at..].iter().position(|b| !word(b)).map_or(bytes.len(), |k| at + k);
                let new = EXTREMES[random.below(EXTREMES.len())].bytes();
                bytes.splice(start..stop.max(start), new);
            }
            6 => {
                let other = &seeds[random.below(seeds.len())];
                let from = random.below(other.len().max(1));
                let part = other[from..(from + 200).min(other.len())].to_vec();
                bytes.splice(at..end, part);
            }
            7 => {
                // Two lines are exchanged.
                let mut lines: Vec<&[u8]> = bytes.split(|b| *b == b'\n').collect();
                let (a, b) = (random.below(lines.len()), random.below(lines.len()));
                lines.swap(a, b);
                bytes = lines.join(&b'\n');
            }
            _ => bytes.extend(b" ".repeat(random.below(5))),
        }
    }
    bytes
}

/// Runs a target over its seeds and damaged copies; whatever panics is printed whole.
fn hold(target: &str, quick: usize, long: usize) {
    let (_, run) = TARGETS.iter().find(|(name, _)| *name == target).expect("a target");
    let seeds = seeds(target);
    // For an input that ends the process, such as by memory: the file that holds the last one.
    let keep = std::env::var_os("MOLDLOFT_FUZZ_KEEP");
    let check = |bytes: &[u8]| {
        if let Some(path) = &keep {
            std::fs::write(path, bytes).unwrap();
        }
        let outcome = catch_unwind(AssertUnwindSafe(|| run(bytes)));
        assert!(outcome.is_ok(), "{target}: {:?}", String::from_utf8_lossy(bytes));
    };
    seeds.iter().for_each(|seed| check(seed));
    for seed in 0..rounds(quick, long) as u64 {
        check(&damaged(&mut Random::new(seed), &seeds));
    }
}

#[test]
fn every_target_of_the_folder_is_run_here() {
    let mut there: Vec<String> = std::fs::read_dir(root().join("fuzz/fuzz_targets"))
        .unwrap()
        .flatten()
        .map(|e| e.path().file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    there.sort();
    assert_eq!(there, TARGETS.iter().map(|(name, _)| *name).collect::<Vec<_>>());
}

#[test]
fn texts_and_formatting() {
    hold("sdl_parse", 3_000, 300_000);
    hold("sdl_format", 1_500, 150_000);
}

#[test]
fn model_files() {
    hold("model_file", 2_000, 200_000);
}

#[test]
fn expressions() {
    hold("expressions", 1_000, 100_000);
}

#[test]
fn readers() {
    hold("readers", 20_000, 2_000_000);
}

#[test]
fn requests_of_a_page() {
    hold("engine_messages", 400, 40_000);
}

#[test]
fn sketches() {
    hold("sketch", 300, 30_000);
}

#[test]
fn documents() {
    hold("document", 100, 10_000);
}

#[test]
fn programs() {
    hold("sdl_run", 60, 6_000);
}

/// A mesh that was read is consistent: its faces refer to existing vertices.
#[test]
fn meshes_that_are_read_are_whole() {
    let seeds = readers_seeds();
    let whole = |mesh: &Mesh<f64>| {
        let count = mesh.positions().len();
        mesh.faces().iter().all(|face| face.iter().all(|&v| (v as usize) < count))
    };
    for seed in 0..rounds(5_000, 500_000) as u64 {
        let bytes = damaged(&mut Random::new(seed), &seeds);
        let Some((_, rest)) = bytes.split_first() else { continue };
        let read = [
            moldloft::io::gdf::read(rest).ok().map(|(_, mesh)| mesh),
            moldloft::io::obj::read(rest).ok().map(|found| found.mesh),
            moldloft::io::stl::read(rest).ok().map(|found| found.mesh),
            moldloft::io::ply::read(rest).ok().map(|found| found.mesh),
            moldloft::io::off::read(rest).ok().map(|found| found.mesh),
        ];
        assert!(read.iter().flatten().all(whole), "{:?}", String::from_utf8_lossy(rest));
    }
}
