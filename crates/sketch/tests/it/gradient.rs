//! Derivatives of a body by its dimensions against closed forms.

use moldloft_sketch::SketchSession;

#[test]
fn a_dam_by_its_dimensions() {
    let mut s = SketchSession::new();
    s.run_text(include_str!("../../../../examples/sketch/dam.skt"));
    let names: Vec<String> =
        ["Crest", "run", "LENGTH1", "HEIGHT", "PARAPET"].map(String::from).to_vec();
    let g = s.gradient("dam", &names).unwrap();
    // V = LENGTH (CREST (HEIGHT + PARAPET) + RUN HEIGHT / 2), RUN = 0.75 HEIGHT.
    let expected = [50.0 * 90.0, 50.0 * 36.0, 3384.0, 50.0 * (16.0 + 27.0 + 27.0), 800.0];
    for (k, (got, want)) in g.volume.iter().zip(expected).enumerate() {
        assert!((got - want).abs() < 1e-8, "{}: {got}", names[k]);
    }
    let h = s.gradient("dam", &["HEIGHT".into()]).unwrap();
    assert!((h.volume[0] - 3500.0).abs() < 1e-8, "{:?}", h.volume);
    let swept = s.sweep("dam", "height", &[72.0, 60.0]).unwrap();
    assert_eq!(swept[0].mass.unwrap().volume, 169_200.0);
    let (up, down) = (72.0 + 1e-4, 72.0 - 1e-4);
    let pair = s.sweep("dam", "height", &[up, down]).unwrap();
    let slope = (pair[0].mass.unwrap().volume - pair[1].mass.unwrap().volume) / (up - down);
    assert!((slope - h.volume[0]).abs() < 1e-3);
    assert_eq!(s.gradient("dam", &["nothing".into()]), Err("nothing".into()));
    assert!(s.sweep("dam", "nothing", &[1.0]).is_err());
}
