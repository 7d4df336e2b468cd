//! Numbers that follow, against conditions of optimality and closed forms.

use moldloft_document::follow::{Conditions, FollowSearch, FollowingNumber, follow};

/// Conditions given by functions and their derivatives.
struct Given<F, D> {
    values: F,
    slopes: D,
    x: Vec<f64>,
}

impl<F: Fn(&[f64]) -> Vec<f64>, D: Fn(&[f64]) -> Vec<Vec<f64>>> Conditions for Given<F, D> {
    fn at(&mut self, x: &[f64]) -> Result<Vec<f64>, String> {
        self.x = x.to_vec();
        Ok((self.values)(x))
    }

    fn slopes(&mut self) -> Result<Vec<Vec<f64>>, String> {
        Ok((self.slopes)(&self.x))
    }
}

/// Numbers of a linear congruence, from 0 to 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn free(home: f64) -> FollowingNumber {
    FollowingNumber { home, range: None, weight: 1.0 }
}

const USUAL: FollowSearch<'static> =
    FollowSearch { importance: &[1.0, 1.0], alike: false, no_effect: &[], enough: 0.0, steps: 40 };

#[test]
fn a_linear_condition_is_met_by_the_nearest_point() {
    // x + 2 y = 10 from (0, 0) with changes counted over ranges of 8 and 8: (2, 4).
    let mut given = Given {
        values: |x: &[f64]| vec![x[0] + 2.0 * x[1] - 10.0],
        slopes: |_: &[f64]| vec![vec![1.0, 2.0]],
        x: vec![],
    };
    let within = |home, low, high| FollowingNumber { home, range: Some((low, high)), weight: 1.0 };
    let both = [within(0.0, -4.0, 4.0), within(0.0, -4.0, 4.0)];
    let found = follow(&mut given, &both, &[0.0, 0.0], USUAL).unwrap();
    assert!((found.x[0] - 2.0).abs() < 1e-6 && (found.x[1] - 4.0).abs() < 1e-6, "{:?}", found.x);
    assert!(found.left[0].abs() < 1e-8);
    // Three times as dear, the first changes nine times less beside the second.
    let dear = [FollowingNumber { weight: 3.0, ..free(1.0) }, free(1.0)];
    let found = follow(&mut given, &dear, &[1.0, 1.0], USUAL).unwrap();
    let (a, b) = (found.x[0] - 1.0, found.x[1] - 1.0);
    assert!((a + 2.0 * b - 7.0).abs() < 1e-8 && (9.0 * a - b / 2.0).abs() < 1e-6, "{a} {b}");
    // At the end of its range the other one pays all.
    let narrow = [within(0.0, -4.0, 4.0), within(0.0, -4.5, 3.5)];
    let found = follow(&mut given, &narrow, &[0.0, 0.0], USUAL).unwrap();
    assert!((found.x[0] - 3.0).abs() < 1e-6 && found.x[1] == 3.5, "{:?}", found.x);
    // Out of reach: the least miss is at both ends.
    let small = [within(0.0, -1.0, 1.0), within(0.0, -1.0, 1.0)];
    let found = follow(&mut given, &small, &[0.0, 0.0], USUAL).unwrap();
    assert_eq!(found.x, [1.0, 1.0]);
    assert!((found.left[0] + 7.0).abs() < 1e-12);
}

#[test]
fn random_conditions_are_met_by_a_least_change() {
    let many = if std::env::var("MOLDLOFT_SOAK").is_ok_and(|v| v == "1") { 20_000 } else { 300 };
    let mut r = Numbers(5);
    let (mut met, mut missed, mut worst, mut steepest) = (0, 0, 0.0f64, 0.0f64);
    for case in 0..many {
        // Products of three numbers, as areas and volumes are.
        let c: Vec<f64> = (0..8).map(|_| 0.2 + r.next()).collect();
        let values = |x: &[f64]| {
            vec![
                c[0] * x[0] * x[1] * x[2] + c[1] * x[0] * x[0],
                c[2] * x[0] + c[3] * x[1] * x[2] + c[4] * x[1] * x[1],
            ]
        };
        let slopes = |x: &[f64]| {
            vec![
                vec![
                    c[0] * x[1] * x[2] + 2.0 * c[1] * x[0],
                    c[0] * x[0] * x[2],
                    c[0] * x[0] * x[1],
                ],
                vec![c[2], c[3] * x[2] + 2.0 * c[4] * x[1], c[3] * x[1]],
            ]
        };
        let home: Vec<f64> = (0..3).map(|_| 1.0 + r.next()).collect();
        let goal: Vec<f64> = (0..3).map(|_| 1.0 + r.next()).collect();
        let target = values(&goal);
        let followers: Vec<FollowingNumber> = home
            .iter()
            .map(|h| FollowingNumber { home: *h, range: Some((1.0, 2.0)), weight: 0.5 + r.next() })
            .collect();
        let mut given = Given {
            values: |x: &[f64]| values(x).iter().zip(&target).map(|(a, b)| a - b).collect(),
            slopes,
            x: vec![],
        };
        let found = follow(&mut given, &followers, &home, USUAL).unwrap();
        assert!(found.x.iter().all(|x| (1.0..=2.0).contains(x)), "case {case}: {:?}", found.x);
        let off = found.left.iter().zip(&target).map(|(l, t)| (l / t).abs()).fold(0.0, f64::max);
        if off > 1e-8 {
            missed += 1;
            continue;
        }
        met += 1;
        worst = worst.max(off);
        // Along the conditions, and away from the ends, no direction lessens the change.
        let inside = found.x.iter().all(|x| *x > 1.0 + 1e-6 && *x < 2.0 - 1e-6);
        if inside {
            let [a, b] = [&slopes(&found.x)[0], &slopes(&found.x)[1]];
            let along =
                [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            let size = along.iter().map(|x| x * x).sum::<f64>().sqrt();
            let slope: f64 = (0..3)
                .map(|k| followers[k].weight.powi(2) * (found.x[k] - home[k]) * along[k] / size)
                .sum();
            steepest = steepest.max(slope.abs());
        }
    }
    println!("{met} met, {missed} missed, off {worst:.1e}, slope {steepest:.1e}");
    assert!(missed * 200 <= many && steepest < 0.05);
}

#[test]
fn what_cannot_be_solved_or_added_is_refused() {
    use moldloft_document::{Adjustable, WantedNumber};
    let text = "param float a = 2 in [1, 5]; param float b = 3 in [1, 5]; AbsPoint P(a * b, a, 0);";
    let mut document = crate::common::sound(text);
    let want = |value| vec![WantedNumber { expression: "P.x".into(), value }];
    let by = |names: &[&str]| -> Vec<Adjustable> {
        let one = |n: &&str| Adjustable { name: (*n).to_owned(), weight: 1.0, home: None };
        names.iter().map(one).collect()
    };
    for (targets, names, id) in [
        (want(6.5), by(&[]), "nothing-to-solve"),
        (vec![], by(&["a"]), "nothing-to-solve"),
        (want(6.5), by(&["a", "a"]), "cannot-follow"),
        (want(100.0), by(&["a"]), "out-of-reach"),
        (want(f64::NAN), by(&["a"]), "not-finite"),
    ] {
        let faults = document.solve_for(&targets, &names).unwrap_err();
        assert_eq!(faults[0].id, id, "{faults:?}");
    }
    for (statement, id) in [
        ("AbsPoint Q(", "not-a-statement"),
        ("print 2;", "not-a-statement"),
        ("AbsPoint P(1, 2, 3);", "duplicate-name"),
        ("Line l(P, Nowhere);", "cannot-add"),
    ] {
        let fault = document.add(statement).unwrap_err();
        assert_eq!(fault.id, id, "{statement}: {fault:?}");
    }
    assert_eq!(document.text(), text);
}

/// A number that the parameters move by less than its tolerance does not hold them: an ordinary
/// hull that is alike fore and aft has such a centre of buoyancy, by rounding.
#[test]
fn a_number_without_effect_beyond_its_tolerance_holds_nothing() {
    use moldloft_document::{Adjustable, WantedNumber};
    let text = "param float a = 2 in [1, 5]; param float b = 3 in [1, 5];
        AbsPoint P(a * b, 3.95 + 1e-10 * (a - b), 0);";
    let mut document = crate::common::open(text);
    let by = ["a", "b"].map(|n| Adjustable { name: n.into(), weight: 1.0, home: None });
    let wish = |expression: &str, value| WantedNumber { expression: expression.into(), value };
    for (k, area) in [2.0, 6.0, 20.0].into_iter().enumerate() {
        // As the numbers are where a = 5 and b = 1 or the other way round: both values are met.
        let off = if k % 2 == 0 { 4e-10 } else { -4e-10 };
        let found = document.solve_for(&[wish("P.x", area), wish("P.y", 3.95 + off)], &by).unwrap();
        assert!((found.reached[0] / area - 1.0).abs() < 1e-8, "{found:?}");
        assert!((found.reached[1] / (3.95 + off) - 1.0).abs() < 1e-8, "{found:?}");
    }
    let refused = document.solve_for(&[wish("P.x", 6.0), wish("P.y", 4.0)], &by).unwrap_err();
    assert!(refused[0].found.as_ref().unwrap().contains("no effect"), "{refused:?}");
}
