//! Networks with shapes: generated hulls with parallel bodies, flats, chines, tunnels and bulbs.

use crate::fixtures::Lcg;
use moldloft_fair::*;
use moldloft_num::Vec3;

const NOISE: f64 = 0.02;

/// Rounding of second differences on straight runs.
const ROUNDING: f64 = 1e-10;

/// A table of half-breadths: places, offsets where there is a hull, and what is known of it.
struct HullTable {
    stations: Vec<f64>,
    heights: Vec<f64>,
    /// By station and height.
    offsets: Vec<Vec<Option<f64>>>,
    /// The stations between which the body is parallel.
    parallel: [usize; 2],
    /// The height from which the side is flat there, where it is.
    side: Option<usize>,
    /// The height of a chine, where there is one.
    chine: Option<usize>,
}

/// A hull of random size, with a parallel body and more by the number.
fn hull(seed: u64) -> HullTable {
    let mut g = Lcg::new(7_000 + seed);
    let (m, n) = (13 + (seed % 3) as usize * 2, 8 + (seed % 2) as usize);
    let (length, depth, breadth) = (
        20.0 + 80.0 * (g.centred() + 0.5),
        3.0 + 4.0 * (g.centred() + 0.5),
        4.0 + 3.0 * (g.centred() + 0.5),
    );
    let stations: Vec<f64> = (0..m).map(|i| length * i as f64 / (m - 1) as f64).collect();
    let heights: Vec<f64> = (0..n).map(|j| depth * j as f64 / (n - 1) as f64).collect();
    let parallel = [m / 3, 2 * m / 3 + 1];
    let bilge = 2 + (seed % 2) as usize;
    let chined = seed % 4 == 3;
    let (bulb, tunnel) = (seed % 5 == 1, seed % 3 == 2);
    let power = 2.0 + (g.centred() + 0.5);
    let section = |z: f64| -> f64 {
        let turn = heights[bilge];
        if chined {
            let high = if z < turn { 0.0 } else { (z - turn) * 0.1 };
            return (breadth - 0.6 * (turn - z).max(0.0) + high).max(0.5);
        }
        if z >= turn { breadth } else { breadth - turn + (turn * turn - (turn - z).powi(2)).sqrt() }
    };
    let offset = |i: usize, j: usize| -> Option<f64> {
        let (x, z) = (stations[i], heights[j]);
        let [a, b] = parallel.map(|k| stations[k]);
        let out = if x < a {
            (a - x) / a
        } else if x > b {
            (x - b) / (length - b)
        } else {
            0.0
        };
        if tunnel && x > b && j < 2 && i + 3 > m {
            return None;
        }
        let mut y = section(z) * (1.0 - 0.9 * out.powf(power));
        if bulb && x < a {
            let t = (x / a).clamp(0.0, 1.0);
            y += 0.3 * (1.0 - t).powi(2) * t * (1.0 - z / depth).powi(2);
        }
        Some(y)
    };
    let offsets = (0..m).map(|i| (0..n).map(|j| offset(i, j)).collect()).collect();
    let side = (!chined).then_some(bilge);
    HullTable { stations, heights, offsets, parallel, side, chine: chined.then_some(bilge) }
}

/// A network of a table with noise: the network, its lists and names, and the exact points.
struct NoisyHull {
    network: Network,
    lists: Vec<(Vec<usize>, bool)>,
    names: Vec<String>,
    exact: Vec<Vec3<f64>>,
}

fn noisy(table: &HullTable, seed: u64, noise: f64, broken: &[(usize, usize)]) -> NoisyHull {
    let mut g = Lcg::new(90_000 + seed);
    let (m, n) = (table.stations.len(), table.heights.len());
    let (mut exact, mut points, mut places) = (Vec::new(), Vec::new(), vec![None; m * n]);
    for i in 0..m {
        for j in 0..n {
            let Some(y) = table.offsets[i][j] else { continue };
            places[i * n + j] = Some(exact.len());
            let at = Vec3::of(table.stations[i], y, table.heights[j]);
            exact.push(at);
            points.push(at + Vec3::of(0.0, 2.0 * noise * g.centred(), 0.0));
        }
    }
    let way = Motion::Along(Vec3::of(0.0, 1.0, 0.0));
    let limit = Limit::new(way, vec![noise; points.len()]).unwrap();
    let (mut lists, mut names) = (Vec::new(), Vec::new());
    for i in 0..m {
        lists.push(((0..n).filter_map(|j| places[i * n + j]).collect::<Vec<_>>(), false));
        names.push(format!("station {i}"));
    }
    for j in 0..n {
        lists.push(((0..m).filter_map(|i| places[i * n + j]).collect(), false));
        names.push(format!("WL {j}"));
    }
    let line = |k: usize| {
        let own: &Vec<usize> = &lists[k].0;
        let list: Vec<Vec3<f64>> = own.iter().map(|&i| points[i]).collect();
        let radii = vec![noise; own.len()];
        let at = parameters_across(&list, ParameterSpacing::Chord, false, (way, &radii)).unwrap();
        NetworkCurve {
            space: Space::floating(3, own.len()).unwrap(),
            points: own.clone(),
            weights: None,
            marks: (0..own.len()).filter(|&c| broken.contains(&(k, own[c]))).collect(),
            runs: Vec::new(),
            ends: [EndContinuity::Points(1); 2],
            at: Some(at),
        }
    };
    let strands = (0..lists.len()).map(line).collect();
    let network = Network::new(points, strands, limit).unwrap();
    NoisyHull { network, lists, names, exact }
}

fn read(texts: &[String], hull: &NoisyHull) -> Vec<NetworkCondition> {
    let named = NamedCurves { curves: &hull.lists, names: &hull.names };
    texts.iter().flat_map(|text| NetworkCondition::read(text, named).unwrap()).collect()
}

/// Changes of the sign of second differences of a line, between its breaks.
fn bends(network: &Network, k: usize, points: &[Vec3<f64>]) -> usize {
    let strand = &network.strands[k];
    let own: Vec<Vec3<f64>> = strand.points.iter().map(|&i| points[i]).collect();
    let at = strand.at.as_ref().unwrap();
    let second = |c: usize| {
        (own[c + 1].y - own[c].y) / (at[c + 1] - at[c])
            - (own[c].y - own[c - 1].y) / (at[c] - at[c - 1])
    };
    let parts: Vec<usize> = (1..own.len() - 1).collect();
    let changes = |part: &[usize]| {
        let inner = part.iter().filter(|c| !strand.marks.contains(c));
        let all: Vec<f64> = inner.map(|&c| second(c)).filter(|s| s.abs() > ROUNDING).collect();
        all.windows(2).filter(|w| w[0] * w[1] < 0.0).count()
    };
    parts.split(|c| strand.marks.contains(c)).map(changes).sum()
}

#[test]
fn flats_and_runs_of_hulls_are_exact() {
    let draws = moldloft_testing::rounds(5, 50) as u64;
    let goal = NetworkMode::Toward(Goal::Near(NETWORK_BUDGET));
    let (mut worst_run, mut worst_flat, mut more, mut rms) = (0.0f64, 0.0f64, 0, [0.0; 2]);
    for seed in 0..draws {
        let table = hull(seed);
        let (m, n) = (table.stations.len(), table.heights.len());
        let [a, b] = table.parallel;
        // A chine is a break of the stations.
        let plain = noisy(&table, seed, NOISE, &[]);
        let broken: Vec<(usize, usize)> = match table.chine {
            Some(j) => (0..m)
                .filter_map(|i| {
                    let on = |p: &usize| plain.exact[*p].z == table.heights[j];
                    plain.lists[i].0.iter().copied().find(on).map(|p| (i, p))
                })
                .collect(),
            None => Vec::new(),
        };
        let mut made = noisy(&table, seed, NOISE, &broken);
        let mut texts =
            vec![format!("WL 0..WL {} at station {a}..station {b}: straight:1,0,0", n - 1)];
        if let Some(j) = table.side {
            texts.push(format!("WL {j}..WL {} at station {a}..station {b}: flat:0,1,0", n - 1));
        }
        let wanted = read(&texts, &made);
        made.network = made.network.with_conditions(wanted).unwrap();
        let network = &made.network;
        let reported = network.report(Measure::Third, goal).unwrap();
        let faired = &reported.points;
        assert!(reported.certified <= NOISE * (1.0 + 1e-12), "{seed}: {}", reported.certified);
        for j in 0..n {
            let k = m + j;
            let run = network.strands[k].runs[0];
            let ys: Vec<f64> =
                (run[0]..=run[1]).map(|c| faired[network.strands[k].points[c]].y).collect();
            let off = ys.iter().map(|y| (y - ys[0]).abs()).fold(0.0, f64::max);
            worst_run = worst_run.max(off);
            // The curve as well.
            let pair = network.curve_pair(k, faired).unwrap();
            let at = network.strands[k].at.as_ref().unwrap();
            for s in 0..=40 {
                let t = at[run[0]] + (at[run[1]] - at[run[0]]) * f64::from(s) / 40.0;
                let p = shape::sample_at(&pair.space, &pair.after, None, t).point;
                worst_run = worst_run.max((p.y - ys[0]).abs());
            }
            if table.side.is_some_and(|side| j >= side) {
                let y = faired[network.strands[m + table.side.unwrap()].points[run[0]]].y;
                worst_flat = worst_flat.max((ys[0] - y).abs());
            }
        }
        let count =
            |points: &[Vec3<f64>]| -> usize { (0..m + n).map(|k| bends(network, k, points)).sum() };
        let (now, was, true_one) = (count(faired), count(&network.points), count(&made.exact));
        more += now.saturating_sub(true_one);
        let off = |points: &[Vec3<f64>]| {
            let all = points.iter().zip(&made.exact).map(|(p, q)| (*p - *q).norm_sq());
            (all.sum::<f64>() / points.len() as f64).sqrt() / NOISE / draws as f64
        };
        rms = [rms[0] + off(&network.points), rms[1] + off(faired)];
        println!("{seed}: bends {was} -> {now}, true {true_one}");
    }
    println!("runs {worst_run:.1e}, flats {worst_flat:.1e}, {more} bends more; rms {rms:.3?}");
    assert!(worst_run <= 1e-9 && worst_flat <= 1e-9);
    // Fewer than one more in three hulls; without signs it is about ten in each.
    assert!(3 * more as u64 <= draws, "{more} more bends in {draws} hulls");
    assert!(rms[1] < 0.8 * rms[0]);
}

/// Waterlines that bulge everywhere, and sections that do: of each its offsets, and the sign of the
/// curvature of its lines seen from above.
fn bulging(seed: u64) -> HullTable {
    let mut g = Lcg::new(31_000 + seed);
    let mut some = |low: f64, high: f64| low + (high - low) * (g.centred() + 0.5);
    let (m, n) = (9 + (seed % 4) as usize * 3, 5 + (seed % 3) as usize * 2);
    let (length, depth) = (some(8.0, 60.0), some(2.0, 6.0));
    let (bulge, flare, middle) = (some(0.02, 0.6), some(0.0, 0.2), some(0.3, 0.7));
    // Uneven stations.
    let mut stations: Vec<f64> = (0..m).map(|i| i as f64 + some(-0.25, 0.25)).collect();
    let (first, last) = (stations[0], stations[m - 1]);
    stations.iter_mut().for_each(|x| *x = (*x - first) / (last - first) * length);
    let heights: Vec<f64> = (0..n).map(|j| depth * j as f64 / (n - 1) as f64).collect();
    let offset = |x: f64, z: f64| {
        let t = x / length - middle;
        3.0 - 4.0 * bulge * t * t * (1.0 + 0.3 * t) + flare * z - 0.02 * (z / depth).powi(2)
    };
    let row = |&x: &f64| heights.iter().map(|&z| Some(offset(x, z))).collect();
    let offsets = stations.iter().map(row).collect();
    HullTable { stations, heights, offsets, parallel: [0, m - 1], side: None, chine: None }
}

#[test]
fn signs_of_many_lines_are_held_where_a_hull_has_them() {
    let draws = moldloft_testing::rounds(12, 300) as u64;
    let mut worst = 0.0f64;
    for seed in 0..draws {
        let table = bulging(seed);
        let (m, n) = (table.stations.len(), table.heights.len());
        let word = ["concave", "one-way"][(seed % 2) as usize];
        let goals = [Goal::Near(NETWORK_BUDGET), Goal::Fairest, Goal::Budget(0.5)];
        let noise = [0.002, 0.02][(seed / 2 % 2) as usize];
        let mut made = noisy(&table, seed, noise, &[]);
        let wanted = read(&[format!("WL 0..WL {}: {word}", n - 1)], &made);
        made.network = made.network.with_conditions(wanted).unwrap();
        let goal = NetworkMode::Toward(goals[(seed % 3) as usize]);
        let network = &made.network;
        let reported = match network.report(Measure::Third, goal) {
            Ok(reported) => reported,
            // The exact hull is within the tolerances.
            Err(error) => panic!("{seed} ({m} by {n}, {word}, {goal:?}): {error}"),
        };
        assert!(reported.certified <= noise * (1.0 + 1e-12), "{seed}: {}", reported.certified);
        for k in m..m + n {
            let pair = network.curve_pair(k, &reported.points).unwrap();
            for s in shape::samples(&pair.space, &pair.after, None, 8) {
                let [d, dd, ..] = s.derivatives;
                let turn = (d.x * dd.y - d.y * dd.x) / d.norm_sq();
                worst = worst.max(turn / noise);
            }
        }
    }
    println!("the largest turn to the left {worst:.1e} tolerances");
    assert!(worst <= 1e-7, "{worst}");
}
