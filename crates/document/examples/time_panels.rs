//! Times the panels of a program after a change of each of its parameters, with its divisions raised.
//!
//! `cargo run --release -p moldloft-lang --example time_panels -- FILE [TIMES] [PARAMETER] [CHANGES]`

use moldloft_document::{Document, NoFiles, registry};
use std::time::Instant;

/// The text with `{n, m}` after `divisions =` multiplied, where both are numbers.
fn finer(text: &str, times: f64) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find("divisions = {") {
        let (before, after) = rest.split_at(at + "divisions = {".len());
        out.push_str(before);
        let end = after.find('}').unwrap_or(0);
        let numbers: Option<Vec<usize>> =
            after[..end].split(',').map(|n| n.trim().parse().ok()).collect();
        match numbers {
            Some(all) => {
                let all: Vec<String> =
                    all.iter().map(|n| (*n as f64 * times).round().to_string()).collect();
                out.push_str(&all.join(", "));
            }
            None => out.push_str(&after[..end]),
        }
        rest = &after[end..];
    }
    out + rest
}

/// The parameters with their ranges, as the lines `param float name = value in [low, high];` say.
fn parameters(text: &str) -> Vec<(String, [f64; 2])> {
    let read = |line: &str| {
        let rest = line.strip_prefix("param float ")?;
        let (name, rest) = rest.split_once(" = ")?;
        let range = rest.split_once("in [")?.1.split_once(']')?.0;
        let (low, high) = range.split_once(',')?;
        Some((name.to_owned(), [low.trim().parse().ok()?, high.trim().parse().ok()?]))
    };
    text.lines().filter_map(read).collect()
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let Some(path) = args.get(1) else {
        println!("a file is missing");
        return;
    };
    let text = std::fs::read_to_string(path).expect("a readable file");
    let times = args.get(2).map_or(1.0, |n| n.parse().expect("a number"));
    let changes: usize = args.get(4).map_or(15, |n| n.parse().expect("a number"));
    let mut document =
        Document::from_text(registry(), Box::new(NoFiles), "model.sdl", &finer(&text, times));
    assert!(!document.has_errors(), "{:?}", document.diagnostics().first());
    let panels = document.panelled().expect("a mesh").mesh.topology().faces().len();
    println!("{path}, divisions x {times}: {panels} panels");
    for (name, [low, high]) in parameters(&text) {
        if args.get(3).is_some_and(|only| *only != name && *only != "all") {
            continue;
        }
        let (mut all, mut model) = (Vec::new(), Vec::new());
        for k in 0..changes {
            let share = 0.35 + 0.3 * k as f64 / changes as f64;
            let start = Instant::now();
            document.set(&[(name.clone(), low + share * (high - low))]).expect("a parameter");
            model.push(start.elapsed().as_secs_f64() * 1e3);
            document.panelled().expect("a mesh");
            all.push(start.elapsed().as_secs_f64() * 1e3);
        }
        all.sort_by(f64::total_cmp);
        model.sort_by(f64::total_cmp);
        let m = changes / 2;
        println!(
            "{name:<18} {:8.2} ms, least {:8.2}; shapes {:8.2}, least {:8.2}",
            all[m], all[0], model[m], model[0]
        );
    }
}
