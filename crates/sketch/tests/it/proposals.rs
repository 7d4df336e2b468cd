//! Types proposed with probabilities, and written from a probability on.

use moldloft_sketch::*;
use moldloft_testing::{Random, rounds};

/// A block on the page, its corners off by `noise`.
fn block(r: &mut Random, noise: f64) -> SketchSession {
    let mut s = SketchSession::new();
    s.run_line("SKETCH A; AXES 345 40 90");
    let axes = [345.0_f64, 40.0, 90.0].map(|a| [a.to_radians().cos(), a.to_radians().sin()]);
    let size = [r.between(60.0, 200.0), r.between(40.0, 150.0), r.between(40.0, 200.0)];
    for k in 0..8_usize {
        let at = [0, 1].map(|j| {
            let sum: f64 =
                (0..3).map(|a| if k >> a & 1 == 1 { size[a] * axes[a][j] } else { 0.0 }).sum();
            sum + noise * r.signed()
        });
        s.run_line(&format!("POINT {} {} {}", k + 1, at[0], at[1]));
    }
    for k in 0..8 {
        for a in [1, 2, 4].into_iter().filter(|a| k & a == 0) {
            s.run_line(&format!("LINE {} {}", k + 1, (k | a) + 1));
        }
    }
    s
}

fn types(s: &SketchSession) -> Vec<Option<Free>> {
    s.active_object().unwrap().drawing.lines.values().map(|l| l.free).collect()
}

#[test]
fn certainty_decides_which_types_are_written() {
    let mut r = Random::new(41);
    let (mut left_out, mut written, mut wrong) = (0, 0, 0);
    for _ in 0..rounds(12, 300) {
        let noise = r.between(1.0, 9.0);
        let mut s = block(&mut r, noise);
        s.run_line("TYPE 3 AS Z");
        let mut all = SketchSession::new();
        all.run_text(&script(s.active_object().unwrap()));
        let proposals = s.active_object().unwrap().drawing.type_proposals();
        assert!(proposals.iter().all(|p| p.line != LineId(3)), "a typed line has no proposal");
        for p in &proposals {
            let sum: f64 = p.alternatives.iter().map(|a| a.1).sum();
            assert!((0.0..=1.0).contains(&p.probability), "{p:?}");
            assert!(sum <= 1.0 - p.probability + 1e-12, "{p:?}");
            assert!(p.alternatives.iter().all(|a| a.0 != Some(p.free)), "{p:?}");
        }
        all.run_line("TYPE AUTO");
        let every = types(&all);
        s.run_line("SET CERTAINTY 0.95");
        let replies = s.run_line("TYPE AUTO");
        let lines = &s.active_object().unwrap().drawing.lines;
        assert_eq!(lines[&LineId(3)].free, Some(Free::along(CoordinateAxis::Z)));
        assert_eq!(lines[&LineId(3)].source, LineTypeSource::User);
        for p in &proposals {
            let free = lines[&p.line].free;
            if p.probability >= 0.95 {
                assert_eq!(free, Some(p.free), "{p:?}");
                assert_eq!(free, every[p.line.0 as usize - 1]);
                written += 1;
                let axis = [1, 2, 4].iter().position(|a| {
                    let l = &lines[&p.line];
                    (l.p.0 - 1) ^ (l.q.0 - 1) == *a
                });
                wrong += usize::from(p.free != Free::along(CoordinateAxis::ALL[axis.unwrap()]));
            } else {
                assert_eq!(free, None, "{p:?}");
                left_out += 1;
                let said = replies
                    .iter()
                    .find(|r| r.about.kind == "proposed-type" && r.about.lines == [p.line]);
                assert_eq!(said.unwrap().about.value, Some(p.probability));
            }
        }
        // The file keeps the setting, and lines without a type.
        let text = script(s.active_object().unwrap());
        let mut again = SketchSession::new();
        again.run_text(&text);
        assert_eq!(script(again.active_object().unwrap()), text);
        assert!(text.contains("SET CERTAINTY 0.95"));
    }
    println!("{written} written, {wrong} of them wrong, {left_out} left out");
    assert!(written > 4 * left_out && left_out > 0 && wrong * 50 < written);
}

#[test]
fn certainty_is_a_probability() {
    let mut s = SketchSession::new();
    s.run_line("SKETCH A");
    for bad in ["SET CERTAINTY 1.5", "SET CERTAINTY -1", "SET CERTAINTY 0.5 0.6"] {
        assert!(s.run_line(bad)[0].is_error(), "{bad}");
    }
    assert!(!s.run_line("SET CERTAINTY 1").iter().any(CommandReply::is_error));
    // A number of that name is a number.
    s.run_line("VARIABLE CERTAINTY 3; SET CERTAINTY 5");
    assert_eq!(s.active_object().unwrap().drawing.certainty, 1.0);
}

#[test]
fn proposals_are_in_the_data() {
    let mut s = block(&mut Random::new(2), 4.0);
    s.run_line("SET CERTAINTY 1; TYPE AUTO");
    let data = s.objects();
    assert!(data[0].lines.iter().all(|l| l.free.is_empty() && l.proposal.is_some()));
    let text = data[0].to_json().to_string();
    assert!(text.contains("\"proposal\":{\"type\":\"X\",\"probability\":0."), "{text}");
}
