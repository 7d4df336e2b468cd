use moldloft_sketch::SketchSession;
fn main() {
    let file = std::env::args().nth(1).unwrap();
    let text = std::fs::read_to_string(file).unwrap();
    let mut s = SketchSession::new();
    for line in text.lines() {
        let t = std::time::Instant::now();
        for r in s.run_line(line) {
            println!("{:?} {}", r.severity, r.text);
        }
        if t.elapsed().as_millis() > 50 {
            println!("   {line}: {:?}", t.elapsed());
        }
    }
}
