use moldloft_sketch::*;
#[test]
fn shell() {
    let file = std::env::var("SKT").unwrap_or("/tmp/a.skt".into());
    let text = std::fs::read_to_string(file).unwrap();
    // programs separated by lines of ====
    for (k, part) in text.split("====\n").enumerate() {
        println!("---- {k}");
        let mut s = Session::new();
        for line in part.lines() {
            if let Some(rest) = line.strip_prefix("@grad ") {
                let names: Vec<String> = rest.split_whitespace().map(String::from).collect();
                let name = s.active_object().unwrap().name.clone();
                match s.gradient(&name, &names) {
                    Ok(g) => println!("grad {:?} {:?}", g.volume, g.area),
                    Err(e) => println!("grad error {e}"),
                }
                continue;
            }
            if line == "@m" {
                let name = s.active_object().unwrap().name.clone();
                let o = s.objects().into_iter().find(|o| o.name == name).unwrap();
                println!(
                    "{name}: volume {:?} area {:?} centroid {:?}",
                    o.volume, o.area, o.centroid
                );
                if let Some(b) = &o.solid {
                    let m = b.mesh(1e-3);
                    let vol: f64 = m
                        .faces()
                        .iter()
                        .map(|f| {
                            let p = |k: usize| m.positions()[f[k] as usize];
                            let t = |a: usize, c: usize, d: usize| p(a).dot(p(c).cross(p(d))) / 6.0;
                            t(0, 1, 2) + if f[2] != f[3] { t(0, 2, 3) } else { 0.0 }
                        })
                        .sum();
                    println!("   mesh volume {vol}");
                    println!(
                        "   v {} e {} f {} trims {} mesh closed {}",
                        b.vertices.len(),
                        b.edges.len(),
                        b.faces.len(),
                        b.trims.len(),
                        m.report().closed
                    );
                }
                continue;
            }
            if let Some(rest) = line.strip_prefix("@a ") {
                let want: f64 = rest.parse().unwrap();
                let got = s.objects()[0].area.unwrap_or(f64::NAN);
                if !((got - want).abs() < 1e-9 * want.abs().max(1.0)) {
                    println!("area {got} want {want}");
                }
                continue;
            }
            if line == "@rt" {
                let name = s.active_object().unwrap().name.clone();
                let t = script(s.object(&name).unwrap());
                let mut f = Session::new();
                for r in f.run_text(&t) {
                    if r.is_error() {
                        println!("rt error {}", r.text);
                    }
                }
                println!("round trip {}", f.object(&name) == s.object(&name));
                if f.object(&name) != s.object(&name) {
                    println!("{t}\n>>>\n{}", f.object(&name).map(script).unwrap_or_default());
                }
                continue;
            }
            let t = std::time::Instant::now();
            for r in s.run_line(line) {
                if r.severity != moldloft_diag::Severity::Note || line.starts_with("MEAS") {
                    println!("  {:?} {:?}: {} [{:?}]", r.severity, r.code, r.text, r.next);
                } else if line.starts_with("CUT")
                    || line.starts_with("UNION")
                    || line.starts_with("COMMON")
                    || line.starts_with("REV")
                    || line.starts_with("PATT")
                {
                    println!("  {} ({} ms)", r.text, t.elapsed().as_millis());
                }
            }
        }
    }
}
