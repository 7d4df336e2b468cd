//! The picture of each sketch with its planes and dimensions, as SVG into a folder:
//! `cargo run -p moldloft-sketch --example pictures -- docs/images`.

use moldloft_sketch::SketchSession;

fn main() -> std::io::Result<()> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".into());
    for (name, text) in [
        ("dam", include_str!("../../../examples/sketch/dam.skt")),
        ("lock_wall", include_str!("../../../examples/sketch/lock_wall.skt")),
        ("bracket", include_str!("../../../examples/sketch/bracket.skt")),
        ("shed", include_str!("../../../examples/sketch/shed.skt")),
    ] {
        let mut session = SketchSession::new();
        session.run_text(text);
        for reply in session.run_text("SHOW PLANES\nEXPORT SVG picture") {
            if let Some(file) = reply.file {
                std::fs::write(format!("{folder}/sketch-{name}.svg"), file.bytes)?;
            }
        }
    }
    Ok(())
}
