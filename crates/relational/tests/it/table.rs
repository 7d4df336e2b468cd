//! Tables of tracked solutions: smooth ones to rounding, corners left to the search.

use moldloft_relational::parts::Table;

/// A smooth path near the edge of a surface is read to rounding everywhere; one with a corner is
/// solved near the corner only.
#[test]
fn smooth_ways_need_no_search() {
    let way = |t: f64| [0.97 + 0.02 * (3.0 * t).sin(), 0.4 + 0.3 * (2.0 * t).cos(), 7.0 * t];
    let same = |a: &[f64; 3], b: &[f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() <= 1e-14);
    let table = Table::new(&[0.0, 1.0], |t| Some(way(t)), same);
    assert!(table.stretches().count() <= 8);
    for k in 0..=1000 {
        let t = f64::from(k) / 1000.0;
        let (found, exact) = (table.at(t).unwrap(), way(t));
        assert!((0..3).all(|k| (found[k] - exact[k]).abs() <= 2e-14), "{t} {found:?} {exact:?}");
    }
    assert!(table.at(-0.1).is_none() && table.at(1.1).is_none());
    let bent = |t: f64| Some([(t - 0.3).abs()]);
    let table = Table::new(&[0.0, 1.0], bent, |a, b| (a[0] - b[0]).abs() <= 1e-14);
    let open: Vec<_> = table.stretches().filter(|s| s.2).collect();
    assert!(open.len() == 1 && open[0].0 < 0.3 && open[0].1 > 0.3);
    assert!(table.at(0.3).is_none() && table.at(0.5).is_some());
}
