//! Networks whose stations have points near each other, where a waterline and a buttock meet: these
//! turn the curve when they move apart.

use crate::fixtures::Lcg;
use moldloft_fair::*;
use moldloft_num::{Dual4, Real, Vec3};

/// Stations, waterlines and buttocks of a random hull with noise of the tolerance.
fn crossed(seed: u64, motion: Motion) -> Network {
    let mut g = Lcg::new(4_000 + seed);
    let mut some = |low: f64, high: f64| low + (high - low) * (g.centred() + 0.5);
    let (m, n) = (7 + (seed % 3) as usize, 6);
    let (length, breadth) = (some(8.0, 20.0), some(1.5, 3.0));
    let tolerance = some(0.005, 0.02);
    let offset = |x: f64, z: f64| {
        let t = 2.0 * x / length - 1.0;
        breadth * (1.0 - 0.7 * t * t) * (0.2 + z).sqrt()
    };
    let (mut points, mut places): (Vec<Vec3<f64>>, Vec<Vec<usize>>) = (Vec::new(), Vec::new());
    let mut stations = Vec::new();
    for i in 0..m {
        let x = length * i as f64 / (m - 1) as f64;
        let mut heights: Vec<f64> = (0..n).map(|j| 0.3 * j as f64).collect();
        // Of two buttocks, at some tolerances from a waterline.
        heights.push(heights[1] + tolerance * some(0.5, 6.0));
        heights.push(heights[4] - tolerance * some(0.5, 6.0));
        let first = points.len();
        for &z in &heights {
            let noise = Vec3::of(0.0, some(-tolerance, tolerance), 0.0);
            points.push(Vec3::of(x, offset(x, z), z) + noise);
        }
        let mut own: Vec<usize> = (first..points.len()).collect();
        places.push(own.clone());
        own.sort_by(|&a, &b| points[a].z.total_cmp(&points[b].z));
        stations.push(own);
    }
    let along = (0..n + 2).map(|j| places.iter().map(|own| own[j]).collect());
    let lists: Vec<Vec<usize>> = stations.iter().cloned().chain(along).collect();
    let radii = vec![tolerance; points.len()];
    let line = |own: &Vec<usize>| {
        let list: Vec<Vec3<f64>> = own.iter().map(|&i| points[i]).collect();
        let limits = (motion, &radii[..own.len()]);
        NetworkCurve {
            space: Space::floating(3, own.len()).unwrap(),
            points: own.clone(),
            weights: None,
            marks: Vec::new(),
            runs: Vec::new(),
            ends: [EndContinuity::Points(0); 2],
            at: Some(parameters_across(&list, ParameterSpacing::Chord, false, limits).unwrap()),
        }
    };
    let strands = lists.iter().map(line).collect();
    let limit = Limit::new(motion, radii).unwrap();
    Network::new(points, strands, limit).unwrap()
}

/// The largest distance of a curve from its original, in tolerances, by samples.
fn farthest(network: &Network, points: &[Vec3<f64>]) -> f64 {
    let mut far = 0.0f64;
    for k in 0..network.strands.len() {
        let pair = network.curve_pair(k, points).unwrap();
        for s in 0..=600 {
            let t = f64::from(s) / 600.0;
            let at = |control: &[Vec3<f64>]| shape::sample_at(&pair.space, control, None, t).point;
            far = far.max((at(&pair.after) - at(&pair.before)).norm());
        }
    }
    far / network.limit.radii[0]
}

#[test]
fn curves_that_swing_beyond_their_bound_are_named() {
    let draws = moldloft_testing::rounds(4, 100) as u64;
    let mut named = 0;
    for seed in 0..draws {
        let mut network = crossed(seed, Motion::Along(Vec3::of(0.0, 1.0, 0.0)));
        for goal in [Goal::Fairest, Goal::Near(NETWORK_BUDGET), Goal::Budget(0.5)] {
            let mode = NetworkMode::Toward(goal);
            network.bound = Bound::ControlPoints;
            let made = network.report(Measure::Third, mode).unwrap();
            let far = farthest(&network, &made.points);
            named += usize::from(!made.swings.is_empty() && goal == Goal::Fairest);
            assert!(far <= SWING * (1.0 + 1e-6) || !made.swings.is_empty(), "{seed}: {far}");
            network.bound = Bound::Bezier;
            let made = network.report(Measure::Third, mode).unwrap();
            assert!(made.swings.is_empty(), "{seed} {goal:?}: {:?}", made.swings);
            assert!(farthest(&network, &made.points) <= 1.0 + 1e-6);
        }
    }
    assert!(2 * named as u64 >= draws, "{named}");
}

/// Derivatives under limits between points agree with differences, of one side where these are kinks.
#[test]
fn derivatives_go_through_limits_between_points() {
    let draws = moldloft_testing::rounds(3, 60) as u64;
    let (mut equal, mut kinks, mut refused) = (0, 0, 0);
    for seed in 0..draws {
        let mut network = crossed(seed, Motion::Along(Vec3::of(0.0, 1.0, 0.0)));
        network.bound = Bound::Bezier;
        let tolerance = network.limit.radii[0];
        let moving = network.strands[1].points[3];
        let goal = Goal::Budget(0.8);
        let ats: Vec<Option<Vec<f64>>> = network.strands.iter().map(|s| s.at.clone()).collect();
        let plain = |by_point: f64, by_tolerance: f64| -> Vec<f64> {
            let mut points = network.points.clone();
            points[moving].y += by_point;
            let limit =
                Limit::new(network.limit.motion, vec![tolerance + by_tolerance; points.len()]);
            let mut own = network.clone();
            (own.points, own.limit) = (points.clone(), limit.unwrap());
            let radii = own.limit.radii.clone();
            let (made, _) =
                own.toward_with(Measure::Third, goal, 1e-13, &points, &radii, &ats).unwrap();
            made.iter().map(|p| p.y).collect()
        };
        let mut points: Vec<Vec3<Dual4>> =
            network.points.iter().map(|&p| Vec3::lifted(p)).collect();
        points[moving].y = Dual4::seeded(network.points[moving].y, 0);
        let tolerances = vec![Dual4::seeded(tolerance, 1); points.len()];
        let lifted: Vec<Option<Vec<Dual4>>> = ats
            .iter()
            .map(|at| at.as_ref().map(|at| at.iter().map(|&t| Dual4::from(t)).collect()))
            .collect();
        let made = network.toward_with(Measure::Third, goal, 1e-13, &points, &tolerances, &lifted);
        let made = match made {
            Ok((made, _)) => made,
            Err(FairError::NoDerivative(why)) => {
                assert!(why.contains("decided"), "{why}");
                refused += 1;
                continue;
            }
            Err(other) => panic!("{other:?}"),
        };
        let here = plain(0.0, 0.0);
        let h = 1e-4 * tolerance;
        for (direction, ways) in [[(-h, 0.0), (h, 0.0)], [(0.0, -h), (0.0, h)]].iter().enumerate() {
            let [low, high] = ways.map(|(p, t)| plain(p, t));
            let (mut two, mut one) = (0.0f64, [0.0f64; 2]);
            for (i, p) in made.iter().enumerate() {
                let got = p.y.eps[direction];
                assert!(p.y.re().to_bits() == here[i].to_bits());
                two = two.max((got - (high[i] - low[i]) / (2.0 * h)).abs());
                one[0] = one[0].max((got - (here[i] - low[i]) / h).abs());
                one[1] = one[1].max((got - (high[i] - here[i]) / h).abs());
            }
            if two < 1e-3 {
                equal += 1;
            } else if one.iter().any(|&off| off < 2e-3) {
                kinks += 1;
            } else {
                panic!("{seed} {direction}: {two:.2e} {one:?}");
            }
        }
    }
    println!("{equal} equal, {kinks} kinks, {refused} refused");
    assert!(equal > draws as usize, "{equal} {kinks} {refused}");
}

#[test]
fn a_swing_has_its_curve_and_place() {
    let network = crossed(0, Motion::Along(Vec3::of(0.0, 1.0, 0.0)));
    // Two neighbours apart by their tolerances.
    let own = network.strands[3].points.clone();
    let tolerance = network.limit.radii[0];
    let mut moved = network.points.clone();
    moved[own[1]].y -= tolerance;
    moved[own[2]].y += tolerance;
    let far = farthest(&network, &moved);
    let named = network.swings(&moved).unwrap();
    let worst = named.iter().find(|s| s.curve == 3).expect("the curve swings");
    assert!(worst.share >= far * (1.0 - 1e-9) && far > SWING, "{far} {worst:?}");
    assert!(own[..6].contains(&worst.point), "{worst:?}");
}
