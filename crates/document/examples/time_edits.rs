//! Times a model of 10 000 objects: opening, a parameter, an edit of the text, a direct edit.
//!
//! `cargo run --release -p moldloft-lang --example time_edits`

use moldloft_document::{Document, NoFiles, registry};
use std::fmt::Write;
use std::time::Instant;

/// 1250 groups of 8 objects that are built on one another; every group follows the parameter
/// through one number only where `k` is 0.
fn program() -> String {
    let mut text = String::from("param float beam = 5 in [3, 7];\n");
    for k in 0..1250 {
        let x = k as f64 * 0.5;
        let y = if k == 0 { "beam" } else { "2.5" };
        writeln!(text, "AbsPoint A{k}({x}, 0, 1.25);").unwrap();
        writeln!(text, "AbsPoint B{k}({x}, {y}, 0.5);").unwrap();
        writeln!(text, "AbsPoint C{k}({x}, 1.25, -0.75);").unwrap();
        writeln!(text, "RelPoint D{k}(C{k}, 0, -1, -0.25);").unwrap();
        writeln!(text, "BCurve M{k}({{A{k}, B{k}, C{k}, D{k}}}, degree = 3, visible = 0);")
            .unwrap();
        writeln!(text, "AbsBead E{k}(M{k}, 0.5);").unwrap();
        writeln!(text, "MirrPoint F{k}(E{k}, \"y=0\");").unwrap();
        writeln!(text, "Line L{k}(E{k}, F{k});").unwrap();
    }
    text
}

fn median(mut f: impl FnMut(usize), n: usize) -> f64 {
    let mut times: Vec<f64> = (0..n)
        .map(|k| {
            let start = Instant::now();
            f(k);
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[n / 2] * 1e3
}

fn main() {
    let text = program();
    let open = || Document::from_text(registry(), Box::new(NoFiles), "large.sdl", &text);
    let mut document = open();
    assert!(document.diagnostics().is_empty(), "{:?}", document.diagnostics().first());
    println!("objects {}", document.graph().len());
    println!("open          {:8.3} ms", median(|_| drop(open()), 5));
    let mut reached = 0;
    let time = median(
        |k| reached = document.set(&[("A7.z".into(), 1.0 + k as f64 * 1e-3)]).unwrap().evaluated,
        101,
    );
    println!("direct edit   {time:8.4} ms, {reached} objects evaluated");
    let time = median(
        |k| reached = document.set(&[("beam".into(), 4.0 + k as f64 * 1e-2)]).unwrap().evaluated,
        21,
    );
    println!("parameter     {time:8.3} ms, {reached} objects evaluated");
    let texts: Vec<String> =
        (0..21).map(|k| text.replace("AbsPoint A9(4.5", &format!("AbsPoint A9(4.5{k}"))).collect();
    let time = median(|k| reached = document.set_text(&texts[k]).evaluated, 21);
    println!("edit of text  {time:8.3} ms, {reached} objects evaluated");
}
