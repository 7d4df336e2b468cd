//! Times what a viewer waits for when a parameter is moved: from the request to the reply with the new scene.
//!
//! `cargo run --release -p moldloft-session --example time_changes [MOVES [MODEL ...]]`

use moldloft_document::NoFiles;
use moldloft_session::{Reply, Session};
use serde_json::json;
use std::time::Instant;

const MODELS: [&str; 8] = [
    "sailboat/hull.sdl",
    "sailboat/yacht.sdl",
    "wing/wing.sdl",
    "submarine/submarine.sdl",
    "wingbody/wingbody.sdl",
    "platform/platform.sdl",
    "propeller/propeller.sdl",
    "gallery/merchant.sdl",
];

fn main() {
    let mut arguments = std::env::args().skip(1);
    let moves: usize = arguments.next().map_or(41, |n| n.parse().expect("a count of moves"));
    let mut models: Vec<String> = arguments.collect();
    if models.is_empty() {
        models = MODELS.map(String::from).into();
    }
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    for name in models {
        let text = std::fs::read_to_string(format!("{folder}/{name}")).expect("an example");
        let mut session = Session::new(Box::new(NoFiles), &name, &text);
        let start = Instant::now();
        let first = Reply::of(&session.answer(&json!({"kind": "open"}).to_string()));
        println!("{name}: open {:.1} ms", start.elapsed().as_secs_f64() * 1e3);
        for p in first.head["params"].as_array().into_iter().flatten() {
            let (Some(low), Some(high)) = (p["range"][0].as_f64(), p["range"][1].as_f64()) else {
                continue;
            };
            let parameter = p["name"].as_str().expect("a name");
            let mut bytes = 0;
            let mut times: Vec<f64> = (0..moves)
                .map(|k| {
                    let share = 0.3 + 0.4 * ((7 * k) % moves) as f64 / moves as f64;
                    let x = low + (high - low) * share;
                    let x = if p["whole"] == true { x.round() } else { x };
                    let request = json!({"kind": "set", "values": {parameter: x}}).to_string();
                    let start = Instant::now();
                    bytes = session.answer(&request).len();
                    start.elapsed().as_secs_f64() * 1e3
                })
                .collect();
            times.sort_by(f64::total_cmp);
            let at = |share: f64| times[((moves - 1) as f64 * share) as usize];
            println!(
                "  {parameter:20} lowest {:7.2}  median {:7.2}  95 % {:7.2} ms  {:6} kB",
                times[0],
                at(0.5),
                at(0.95),
                bytes / 1024
            );
            session.answer(&json!({"kind": "reset"}).to_string());
        }
    }
}
