//! Laws of relabellings and of arc length.

use moldloft_num::{Curve, Dual, Order, Real, Uni2, Vec3};
use moldloft_spline::*;

fn all() -> Vec<ReparametrizationForm<f64>> {
    let mut laws = vec![
        ReparametrizationForm::identity(),
        ReparametrizationForm::spline(3, vec![0.0, 0.1, 0.2, 0.9, 1.0]).unwrap(),
        ReparametrizationForm::spline(1, vec![0.0, 0.4, 1.0]).unwrap(),
        // The ends may stay fixed, the inside may not.
        ReparametrizationForm::spline(3, vec![0.0, 0.0, 0.4, 1.0, 1.0]).unwrap(),
        ReparametrizationForm::table(vec![0.0, 1.0], vec![0.0, 1.0]).unwrap(),
        ReparametrizationForm::table(vec![0.0, 0.1, 0.5, 0.6, 1.0], vec![0.0, 0.5, 0.51, 0.9, 1.0])
            .unwrap(),
    ];
    for q in [1e-3, 0.5, 1.0, 1.0 + 1e-9, 20.0] {
        laws.push(ReparametrizationForm::geometric(q).unwrap());
    }
    for dense in [Dense::Both, Dense::Start, Dense::End] {
        for strength in [0.0, 1e-6, 2.0, 9.0] {
            laws.push(ReparametrizationForm::tanh(dense, strength).unwrap());
        }
        for weight in [0.0, 0.5, 1.0] {
            laws.push(ReparametrizationForm::cosine(dense, weight).unwrap());
        }
    }
    laws
}

#[test]
fn relabels_are_monotone_from_zero_to_one_with_right_slopes() {
    for law in all() {
        assert_eq!((law.at(0.0), law.at(1.0)), (0.0, 1.0), "{law:?}");
        let mut before = 0.0;
        for k in 1..=100 {
            let now = law.at(k as f64 / 100.0);
            assert!(now > before, "{law:?}");
            before = now;
        }
        for t in [0.03, 0.31, 0.77] {
            let jet = law.at(Uni2::parameter(t));
            let vector = |x: f64| Vec3::of(x, 0.0, 0.0);
            let first = crate::common::ridders_vector(|t| vector(law.at(t)), t, 0.01).x;
            let second =
                crate::common::ridders_vector(|t| vector(law.at(Uni2::parameter(t)).t), t, 0.01).x;
            assert!((jet.f - law.at(t)).abs() < 1e-15);
            assert!((jet.t - first).abs() < 1e-8, "{law:?} {} {first}", jet.t);
            assert!((jet.tt - second).abs() < 1e-6, "{law:?} {} {second}", jet.tt);
        }
    }
}

#[test]
fn dense_ends_are_where_they_are_said_to_be() {
    let slopes =
        |law: &ReparametrizationForm<f64>| [0.0, 1.0].map(|t| law.at(Uni2::parameter(t)).t);
    type Make = fn(Dense) -> ReparametrizationForm<f64>;
    let makers: [Make; 2] = [
        |d| ReparametrizationForm::cosine(d, 1.0).unwrap(),
        |d| ReparametrizationForm::tanh(d, 3.0).unwrap(),
    ];
    for make in makers {
        let [start, end] = slopes(&make(Dense::Start));
        assert!(start < 0.1 && end > 1.5);
        let [start, end] = slopes(&make(Dense::End));
        assert!(start > 1.5 && end < 0.1);
        let [start, end] = slopes(&make(Dense::Both));
        assert!(start < 0.4 && end < 0.4);
    }
    let [start, end] = slopes(&ReparametrizationForm::geometric(5.0).unwrap());
    assert!((end / start - 5.0).abs() < 1e-13);
}

#[test]
fn relabels_move_with_their_numbers() {
    let q = Dual::<1>::seeded(1.0, 0);
    // d/dq of (q^t - 1)/(q - 1) at q = 1 is t (t - 1) / 2.
    let slope = ReparametrizationForm::geometric(q).unwrap().at(Dual::from(0.3)).eps[0];
    assert!((slope + 0.105).abs() < 1e-15);
    let values = [Dual::<1>::from(0.0), Dual::seeded(0.4, 0), Dual::from(1.0)];
    let value = ReparametrizationForm::spline(1, values.to_vec());
    assert_eq!(value.unwrap().at(Dual::from(0.25)).eps[0], 0.5);
}

#[test]
fn refuses_what_is_not_monotone() {
    let back = RelabelError::NotMonotone { index: 2, before: 0.6, value: 0.5 };
    assert_eq!(ReparametrizationForm::spline(2, vec![0.0, 0.6, 0.5, 1.0]), Err(back));
    let ends = RelabelError::Ends { first: 0.1, last: 1.0 };
    assert_eq!(ReparametrizationForm::spline(1, vec![0.1, 1.0]), Err(ends));
    assert!(matches!(
        ReparametrizationForm::spline(3, vec![0.0, 1.0]),
        Err(RelabelError::Knots(_))
    ));
    assert!(matches!(
        ReparametrizationForm::cosine(Dense::Both, 1.5),
        Err(RelabelError::Range { .. })
    ));
    assert!(matches!(ReparametrizationForm::geometric(-1.0), Err(RelabelError::Range { .. })));
    assert!(matches!(
        ReparametrizationForm::tanh(Dense::End, f64::NAN),
        Err(RelabelError::Range { .. })
    ));
}

#[test]
fn parabola_as_a_cubic_has_its_exact_length() {
    // y = x^2 for x in [0, 1]: length sqrt(5)/2 + asinh(2)/4, through degree elevation to a cubic.
    let points = [[0.0, 0.0], [0.5, 0.0], [1.0, 1.0]].map(|[x, y]| Vec3::of(x, y, 0.0));
    let cubic = BSplineCurve::<f64>::uniform(2, points.to_vec()).unwrap();
    let cubic = cubic.elevate_degree().unwrap();
    let exact = 5f64.sqrt() / 2.0 + 2f64.asinh() / 4.0;
    for digits in 3..13 {
        let accuracy = 0.1f64.powi(digits);
        assert!((arclen(&cubic, 0.0, 1.0, accuracy) - exact).abs() < accuracy);
        assert!((arclen(&cubic, 1.0, 0.0, accuracy) + exact).abs() < accuracy);
    }
}

#[test]
fn length_and_its_inverse_agree_across_breaks() {
    let mut random = crate::common::Random::new(30);
    let curve = InterpolatingSpline::through(&random.points(7)).unwrap();
    for (a, b) in [(0.0, 1.0), (0.1, 0.93), (0.8, 0.05), (0.4, 0.4)] {
        let s = arclen(&curve, a, b, 1e-12);
        let t = inv_arclen(&curve, a, s, 1e-11).unwrap();
        assert!((t - b).abs() < 1e-10, "{a} {b} {t}");
    }
    let whole = arclen(&curve, 0.5, 1.0, 1e-10);
    let beyond = inv_arclen(&curve, 0.5, whole + 1.0, 1e-10).unwrap_err();
    assert!((beyond.available - whole).abs() < 1e-9);
}

#[test]
fn lengths_move_with_points_and_limits() {
    let mut random = crate::common::Random::new(31);
    let (points, directions) = (random.points(5), random.points(5));
    let spline = |h: f64| {
        InterpolatingSpline::through(&crate::common::moved(&points, &directions, h)).unwrap()
    };
    let dual = InterpolatingSpline::through(&crate::common::seeded(&points, &directions)).unwrap();
    let vector = |x: f64| Vec3::of(x, 0.0, 0.0);
    let (a, b) = (Dual::<1> { re: 0.2, eps: [1.0] }, Dual::<1> { re: 0.9, eps: [-2.0] });
    let length = |h: f64| arclen(&spline(h), 0.2 + h, 0.9 - 2.0 * h, 1e-13);
    let slope = crate::common::ridders_vector(|h| vector(length(h)), 0.0, 0.01).x;
    assert!((arclen(&dual, a, b, 1e-13).eps[0] - slope).abs() < 1e-7);
    let s = Dual::<1> { re: 0.8, eps: [0.5] };
    let inverse = |h: f64| inv_arclen(&spline(h), 0.2 + h, 0.8 + 0.5 * h, 1e-12).unwrap();
    let slope = crate::common::ridders_vector(|h| vector(inverse(h)), 0.0, 0.01).x;
    let exact = inv_arclen(&dual, a, s, 1e-12).unwrap();
    assert!((exact.re() - inverse(0.0)).abs() < 1e-12);
    assert!((exact.eps[0] - slope).abs() < 1e-6, "{} {slope}", exact.eps[0]);
    // Points at equal lengths are equally far apart on a circle.
    let p = [[1.0, 0.0], [0.0, 0.0], [0.0, 1.0]].map(|[x, y]| Vec3::of(x, y, 0.0));
    let circle = CircularArc::<f64>::circle(p[0], p[1], p[2]).unwrap();
    let t = inv_arclen(&circle, 0.0, std::f64::consts::FRAC_PI_2, 1e-13).unwrap();
    assert!((circle.jet(t, Order::Zero)[0] - p[2]).norm() < 1e-12);
}

#[test]
fn tables_pass_through_their_pairs_and_keep_parabolas() {
    let (t, r) = (vec![0.0, 0.2, 0.7, 1.0], vec![0.0, 0.6, 0.65, 1.0]);
    let law = ReparametrizationForm::table(t.clone(), r.clone()).unwrap();
    for (t, r) in t.iter().zip(&r) {
        assert!((law.at(*t) - r).abs() < 1e-15);
    }
    // R = (t + t^2) / 2 has slopes that nothing limits: three-point slopes are exact for parabolas.
    let parabola = |t: f64| 0.5 * (t + t * t);
    let nodes = vec![0.0, 0.3, 0.45, 0.8, 1.0];
    let law =
        ReparametrizationForm::table(nodes.clone(), nodes.into_iter().map(parabola).collect())
            .unwrap();
    for k in 0..=50 {
        let t = f64::from(k) / 50.0;
        assert!((law.at(t) - parabola(t)).abs() < 1e-15, "{t}");
    }
}

#[test]
fn laws_that_stand_still_or_run_back_are_refused() {
    use RelabelError::*;
    let still = ReparametrizationForm::spline(1, vec![0.0, 0.5, 0.5, 1.0]).unwrap_err();
    assert_eq!(still, ZeroSlope { at: 0.5 });
    // A parabola's slope is linear between the knots: one pair of equals makes it touch zero.
    let still = ReparametrizationForm::spline(2, vec![0.0, 0.4, 0.4, 0.8, 1.0]).unwrap_err();
    assert!(matches!(still, ZeroSlope { at } if (at - 1.0 / 3.0).abs() < 1e-15), "{still}");
    assert!(ReparametrizationForm::spline(3, vec![0.0, 0.4, 0.4, 0.8, 1.0]).is_ok());
    assert!(matches!(
        ReparametrizationForm::spline(3, vec![0.0, 0.5, 0.5, 0.5, 0.5, 0.5, 1.0]).unwrap_err(),
        ZeroSlope { .. }
    ));
    let table =
        |t: &[f64], r: &[f64]| ReparametrizationForm::table(t.to_vec(), r.to_vec()).unwrap_err();
    assert_eq!(table(&[0.0, 1.0], &[0.0, 0.9]), Ends { first: 0.0, last: 0.9 });
    assert_eq!(table(&[0.1, 1.0], &[0.0, 1.0]), Ends { first: 0.1, last: 1.0 });
    assert_eq!(table(&[0.0, 1.0], &[0.0, 0.5, 1.0]), Lengths { parameters: 2, values: 3 });
    assert_eq!(table(&[0.0, 0.5, 0.5, 1.0], &[0.0, 0.2, 0.3, 1.0]), Unordered { index: 2 });
    assert_eq!(table(&[0.0, 0.5, 1.0], &[0.0, 0.0, 1.0]), ZeroSlope { at: 0.5 });
    assert!(matches!(table(&[0.0, 0.5, 0.6, 1.0], &[0.0, 0.6, 0.3, 1.0]), NotMonotone { .. }));
    assert!(matches!(table(&[0.0, 0.5, 1.0], &[0.0, f64::NAN, 1.0]), NotMonotone { .. }));
}
