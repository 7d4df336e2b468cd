//! Marching off several surfaces as one front, against closed forms and symmetries.

use crate::walls::geometric;
use moldloft_grid::{
    FailureCause, GridError, Hyperbolic, JoinFault, MarchBoundary, MarchedBlocks, OpenFrontEdges,
    StopReason, SurfaceGrid, VolumeGrid, hyperbolic, hyperbolic_surfaces,
};
use moldloft_num::{Dual4, Real, Vec3};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_4, PI};

/// The six faces of a cube of edge 2, with equal angles between lines seen from its centre, mapped.
fn cubed<T: Real>(n: usize, map: impl Fn(Vec3) -> Vec3<T>) -> Vec<SurfaceGrid<T>> {
    let face = |k: usize| {
        let (axis, sign) = (k / 2, if k.is_multiple_of(2) { 1.0 } else { -1.0 });
        SurfaceGrid::from_fn(n, n, |i, j| {
            let at = |k: usize| (FRAC_PI_4 * (2.0 * k as f64 / (n - 1) as f64 - 1.0)).tan();
            let mut p = [0.0; 3];
            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (sign, at(i), sign * at(j));
            map(p.into())
        })
    };
    (0..6).map(face).collect()
}

/// One of the eight orders of a grid's points: four turns, and the same with the indices exchanged.
fn reordered(grid: &SurfaceGrid<f64>, order: usize) -> SurfaceGrid<f64> {
    let mut grid = grid.clone();
    if order & 4 == 4 {
        grid = grid.transposed();
    }
    let (m, n) = (grid.m, grid.n);
    SurfaceGrid::from_fn(m, n, |i, j| {
        let i = if order & 1 == 1 { m - 1 - i } else { i };
        grid.at(i, if order & 2 == 2 { n - 1 - j } else { j })
    })
}

/// A point to a billionth: surfaces give their common points to rounding.
fn key(p: Vec3) -> [i64; 3] {
    p.to_array().map(|x| (x * 1e9).round() as i64)
}

/// The lines off the wall, by their first point; lines off a common point are identical.
fn lines(blocks: &[VolumeGrid<f64>]) -> HashMap<[i64; 3], Vec<Vec3>> {
    let mut lines: HashMap<[i64; 3], Vec<Vec3>> = HashMap::new();
    for block in blocks {
        let [m, n, count] = block.size;
        for (i, j) in (0..m * n).map(|k| (k / n, k % n)) {
            let line: Vec<Vec3> = (0..count).map(|k| block.at(i, j, k)).collect();
            let known = lines.entry(key(line[0])).or_insert_with(|| line.clone());
            assert!(*known == line, "two lines off {:?}", line[0]);
        }
    }
    lines
}

/// The least triple product of unit edges at the corners of all cells, right-handed or all left-handed.
fn least(blocks: &[VolumeGrid<f64>]) -> f64 {
    let mut least = f64::INFINITY;
    for block in blocks {
        let [m, n, l] = block.size;
        let hand = if block.at(1, 1, 1) == block.at(0, 1, 1) { 1.0 } else { hand(block) };
        for at in (0..8 * (m - 1) * (n - 1) * (l - 1)).map(|k| (k % 8, k / 8)) {
            let (corner, cell) = at;
            let (i, j, k) = (cell / ((n - 1) * (l - 1)), cell / (l - 1) % (n - 1), cell % (l - 1));
            let (a, b, c) = (corner >> 2, corner >> 1 & 1, corner & 1);
            let p = |x: usize, y: usize, z: usize| block.at(i + x, j + y, k + z);
            let sign = |x: usize| if x == 0 { 1.0 } else { -1.0 };
            let here = p(a, b, c);
            let edges = [
                (p(1 - a, b, c) - here) * sign(a),
                (p(a, 1 - b, c) - here) * sign(b),
                (p(a, b, 1 - c) - here) * sign(c),
            ];
            let scale: f64 = edges.iter().map(|e| e.norm()).product();
            // Corners at poles do not count.
            if scale > 0.0 {
                least = least.min(hand * edges[0].cross(edges[1]).dot(edges[2]) / scale);
            }
        }
    }
    least
}

/// 1 or -1: the sign of the volume of the cell in the middle of the first layer.
fn hand(block: &VolumeGrid<f64>) -> f64 {
    let (i, j) = (block.size[0] / 2 - 1, block.size[1] / 2 - 1);
    let p = |a: usize, b: usize, c: usize| block.at(i + a, j + b, c);
    let here = p(0, 0, 0);
    (p(1, 1, 0) - here).cross(p(0, 1, 0) - p(1, 0, 0)).dot(p(0, 0, 1) - here).signum()
}

fn march(surfaces: &[SurfaceGrid<f64>], heights: Vec<f64>) -> MarchedBlocks<f64> {
    let free = OpenFrontEdges::all(surfaces.len(), MarchBoundary::Free);
    hyperbolic_surfaces(surfaces, &free, &Hyperbolic::new(heights)).unwrap()
}

/// The first cells have their height, and no cell is folded.
fn check(marched: &MarchedBlocks<f64>, first: f64) {
    let [low, high] = marched.report.first_cell;
    assert!(low > 0.99 * first && high < 1.01 * first, "{low} {high} of {first}");
    let least = least(&marched.blocks);
    assert!(least > 0.0, "{least}");
    assert!((least - marched.report.jacobian).abs() < 1e-12);
}

#[test]
fn spheres_of_six_surfaces() {
    let error = |n: usize, last: f64| {
        let marched = march(&cubed(n, |p| p / p.norm()), geometric(last, 1e-2, 25));
        check(&marched, 1e-2);
        assert!(marched.report.jacobian > 0.8, "{:?}", marched.report);
        let lines = lines(&marched.blocks);
        assert_eq!(lines.len(), 6 * (n - 1) * (n - 1) + 2);
        let off = lines.values().map(|line| (line[24].norm() - 1.0 - last).abs() / last);
        off.fold(0.0, f64::max)
    };
    for (last, most) in [(0.2, 0.02), (1.0, 0.06), (10.0, 0.09)] {
        let errors = [9, 17].map(|n| error(n, last));
        println!("{last}: {errors:?} of the height");
        assert!(errors.iter().all(|error| *error < most), "{errors:?}");
    }
}

/// Uneven spacings, flat and long bodies: the order of the surfaces, their directions and a turn of
/// all points do not change the nodes.
#[test]
fn ellipsoids_do_not_depend_on_the_order_of_surfaces() {
    let mut state = 7u64;
    let mut random = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as f64 / (1u64 << 31) as f64
    };
    let cases = if std::env::var_os("MOLDLOFT_SOAK").is_some() { 60 } else { 3 };
    for case in 0..cases {
        let n = 7 + 2 * (case % 3);
        let axes: Vec3 = Vec3::of(1.0, 0.4 + random(), 0.4 + random());
        let skew = 0.3 * (random() - 0.5);
        let surfaces = cubed(n, |p| {
            let u = p / p.norm();
            Vec3::of(u.x * axes.x + skew * u.y * u.y, u.y * axes.y, u.z * axes.z)
        });
        let heights = geometric(0.5 + 2.0 * random(), 5e-3, 15);
        let marched = march(&surfaces, heights.clone());
        check(&marched, 5e-3);
        let plain = lines(&marched.blocks);
        let mut order: Vec<usize> = (0..6).collect();
        for k in (1..6).rev() {
            order.swap(k, (random() * (k + 1) as f64) as usize);
        }
        let (a, b) = (2.0 * PI * random(), 2.0 * PI * random());
        let turn = |p: Vec3| {
            let p = Vec3::of(a.cos() * p.x - a.sin() * p.y, a.sin() * p.x + a.cos() * p.y, p.z);
            Vec3::of(b.cos() * p.x - b.sin() * p.z, p.y, b.sin() * p.x + b.cos() * p.z)
        };
        let mut mixed: Vec<SurfaceGrid<f64>> = Vec::new();
        for k in order {
            mixed.push(reordered(&surfaces[k], (random() * 8.0) as usize));
        }
        // The first surface gives the side.
        if outward(&mixed[0]) < 0.0 {
            mixed[0] = mixed[0].transposed();
        }
        let again = march(&mixed, heights.clone());
        check(&again, 5e-3);
        for (start, line) in lines(&again.blocks) {
            for (p, q) in line.iter().zip(&plain[&start]) {
                assert!(p.distance(*q) < 1e-6, "{p:?} {q:?}");
            }
        }
        let turned: Vec<SurfaceGrid<f64>> =
            mixed.iter().map(|s| SurfaceGrid::from_fn(s.m, s.n, |i, j| turn(s.at(i, j)))).collect();
        let turned = march(&turned, heights);
        for (block, plain) in turned.blocks.iter().zip(&again.blocks) {
            for (p, q) in block.points().zip(plain.points()) {
                assert!(p.distance(turn(q)) < 1e-6);
            }
        }
    }
}

/// Positive when the normal s_i x s_j points away from the origin.
fn outward(s: &SurfaceGrid<f64>) -> f64 {
    let (i, j) = (s.m / 2, s.n / 2);
    (s.at(i + 1, j) - s.at(i - 1, j)).cross(s.at(i, j + 1) - s.at(i, j - 1)).dot(s.at(i, j))
}

/// Cubes with sharp and rounded edges, and the inside of one: nodes of three edges.
#[test]
fn cubes_outside_and_inside() {
    for power in [3.0, 6.0, f64::INFINITY] {
        let surfaces = cubed(13, |p| {
            let size = match power.is_finite() {
                true => {
                    p.to_array().iter().map(|x| x.abs().powf(power)).sum::<f64>().powf(1.0 / power)
                }
                false => 1.0,
            };
            p / size
        });
        let marched = march(&surfaces, geometric(2.0, 1e-2, 25));
        check(&marched, 1e-2);
        // A sharp corner's cell has its line on the diagonal.
        assert!(marched.report.jacobian > if power.is_finite() { 0.6 } else { 0.57 });
    }
    let inside: Vec<SurfaceGrid<f64>> =
        cubed(13, |p| p).iter().map(SurfaceGrid::transposed).collect();
    let marched = march(&inside, geometric(0.15, 1e-2, 9));
    check(&marched, 1e-2);
    // The first layer is a cube: planes at the height.
    for line in lines(&marched.blocks).values() {
        let most = line[1].to_array().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        assert!((most - 0.99).abs() < 1e-4, "{:?}", line[1]);
    }
}

/// A plane of `count` patches round one node: heights are means, within a tenth of the layer's.
#[test]
fn nodes_of_any_number_of_edges_stay_in_planes() {
    for count in [3, 4, 5, 6] {
        let corner = |k: usize| {
            let a = 2.0 * PI * k as f64 / count as f64;
            Vec3::of(a.cos(), a.sin(), 0.0)
        };
        let patch = |k: usize| {
            let (a, b) = (corner(k), corner(k + 1));
            let far = (a + b) * (0.5 + 0.2 / (a + b).norm());
            SurfaceGrid::from_fn(7, 7, |i, j| {
                let (u, v) = (i as f64 / 6.0, j as f64 / 6.0);
                a * (u * (1.0 - v)) + b * (v * (1.0 - u)) + far * (u * v)
            })
        };
        let surfaces: Vec<SurfaceGrid<f64>> = (0..count).map(patch).collect();
        let heights = geometric(0.2, 1e-2, 12);
        let marched = march(&surfaces, heights.clone());
        check(&marched, 1e-2);
        for (start, line) in lines(&marched.blocks) {
            for (p, height) in line.iter().zip(&heights) {
                assert!((p.z - height).abs() <= 0.1 * height, "{count}: {start:?} {p:?} {height}");
            }
        }
    }
}

fn plate(m: usize, n: usize, from: [f64; 2], to: [f64; 2]) -> SurfaceGrid<f64> {
    SurfaceGrid::from_fn(m, n, |i, j| {
        let (u, v) = (i as f64 / (m - 1) as f64, j as f64 / (n - 1) as f64);
        let (x, y) = (from[0] + u * (to[0] - from[0]), from[1] + v * (to[1] - from[1]));
        Vec3::of(x, y, 0.1 * (x * x - 0.5 * y * y))
    })
}

#[test]
fn a_plate_cut_in_four_is_the_plate() {
    let whole = [plate(13, 17, [-1.0, -1.0], [0.5, 1.0])];
    let parts: Vec<SurfaceGrid<f64>> = [
        plate(7, 9, [-1.0, -1.0], [-0.25, 0.0]),
        plate(7, 9, [-0.25, -1.0], [0.5, 0.0]),
        plate(7, 9, [-1.0, 0.0], [-0.25, 1.0]),
        plate(7, 9, [-0.25, 0.0], [0.5, 1.0]),
    ]
    .iter()
    .zip([0, 6, 4, 3])
    .map(|(part, order)| reordered(part, order))
    .collect();
    let heights = geometric(0.6, 1e-3, 20);
    let [whole, parts] = [&whole[..], &parts].map(|s| march(s, heights.clone()));
    check(&parts, 1e-3);
    let near = |p: Vec3| {
        let all = whole.blocks[0].points().map(|q| q.distance(p));
        all.fold(f64::INFINITY, f64::min)
    };
    let off = parts.blocks.iter().flat_map(VolumeGrid::points).map(near).fold(0.0, f64::max);
    assert!(off < 1e-7, "{off}");
    // One surface alone takes the factored step: the same equations but for the product of the factors.
    let alone = hyperbolic(&plate(13, 17, [-1.0, -1.0], [0.5, 1.0]), &Hyperbolic::new(heights));
    let last = alone.unwrap().layers.remove(19);
    let joined = whole.blocks[0].layers().remove(19);
    let off = joined.points().zip(last.points()).map(|(p, q)| p.distance(q)).fold(0.0, f64::max);
    println!("the plate alone differs by {off:.2e}");
    assert!(off < 0.02);
}

#[test]
fn free_edges_splay() {
    let flat = |from: f64, to: f64| {
        SurfaceGrid::from_fn(9, 9, |i, j| {
            Vec3::of(from + (to - from) * i as f64 / 8.0, j as f64 / 8.0, 0.0)
        })
    };
    let surfaces = [flat(0.0, 1.0), flat(1.0, 2.0)];
    let heights = geometric(0.5, 1e-2, 15);
    let width = |splay: f64| {
        let edges = OpenFrontEdges::all(2, MarchBoundary::Splay(splay));
        let marched =
            hyperbolic_surfaces(&surfaces, &edges, &Hyperbolic::new(heights.clone())).unwrap();
        check(&marched, 1e-2);
        let last = marched.blocks[1].layers().remove(14);
        for p in last.points() {
            assert!((p.z - 0.5).abs() < 0.05, "{p:?}");
        }
        last.at(8, 4).x
    };
    let [none, some, more] = [0.0, 0.25, 0.5].map(width);
    println!("widths {none} {some} {more}");
    assert!((none - 2.0).abs() < 1e-12 && some > 2.02 && more > some);
}

#[test]
fn half_bodies_stay_in_their_plane() {
    let whole = cubed(13, |p| Vec3::of(1.5 * p.x, p.y, 0.7 * p.z) / p.norm());
    // z > 0: half of four faces, and the one above.
    let half: Vec<SurfaceGrid<f64>> = whole
        .iter()
        .filter_map(|s| {
            let inside: Vec<[usize; 2]> = (0..s.m * s.n)
                .map(|k| [k / s.n, k % s.n])
                .filter(|[i, j]| s.at(*i, *j).z > -1e-9)
                .collect();
            let [from, to] = [inside.first()?, inside.last()?];
            (inside.len() > s.m).then(|| {
                SurfaceGrid::from_fn(to[0] + 1 - from[0], to[1] + 1 - from[1], |i, j| {
                    let p = s.at(from[0] + i, from[1] + j);
                    if p.z.abs() < 1e-9 { Vec3::of(p.x, p.y, 0.0) } else { p }
                })
            })
        })
        .collect();
    assert_eq!(half.len(), 5);
    let heights = geometric(3.0, 1e-3, 25);
    let edges = OpenFrontEdges::all(5, MarchBoundary::Symmetry(2));
    let marched = hyperbolic_surfaces(&half, &edges, &Hyperbolic::new(heights.clone())).unwrap();
    check(&marched, 1e-3);
    let all: Vec<Vec3> = lines(&march(&whole, heights).blocks).into_values().flatten().collect();
    let mut count = 0;
    for line in lines(&marched.blocks).values() {
        if line[0].z == 0.0 {
            assert!(line.iter().all(|p| p.z == 0.0));
            count += 1;
        }
        let near = all.iter().map(|p| p.distance(line[24])).fold(f64::INFINITY, f64::min);
        assert!(near < 1e-6, "{near} at {:?}", line[0]);
    }
    assert_eq!(count, 48);
}

/// Thickness of a symmetric section at x from 0 to 1, closed at both ends.
fn thickness(x: f64) -> f64 {
    let law =
        0.2969 * x.sqrt() - 0.126 * x - 0.3516 * x * x + 0.2843 * x.powi(3) - 0.1036 * x.powi(4);
    if x == 0.0 || x == 1.0 { 0.0 } else { 0.6 * law }
}

/// Half a wing of elliptic planform, whose sections shrink to a point at the tip, as upper and lower surface or as
/// one round the leading edge.
fn wing(m: usize, n: usize, side: impl Fn(usize) -> (f64, f64)) -> SurfaceGrid<f64> {
    SurfaceGrid::from_fn(m, n, |i, j| {
        let (x, sign) = side(i);
        let a = 0.5 * PI * j as f64 / (n - 1) as f64;
        let chord = if j + 1 == n { 0.0 } else { a.cos() };
        Vec3::of((x - 0.4) * chord, 1.5 * a.sin(), sign * chord * thickness(x))
    })
}

#[test]
fn wings_with_collapsed_tips() {
    let (m, n) = (21, 13);
    let x = |k: usize| 0.5 * (1.0 - (PI * k as f64 / (m - 1) as f64).cos());
    let upper = wing(m, n, |i| (x(i), 1.0));
    let lower = wing(m, n, |i| (x(i), -1.0));
    let round = wing(2 * m - 1, n, |i| {
        let k = (i as isize - (m as isize - 1)).unsigned_abs();
        (x(k), if i < m { -1.0 } else { 1.0 })
    });
    let mut edges = OpenFrontEdges::all(2, MarchBoundary::Free);
    edges.stated = vec![[None, None, Some(MarchBoundary::Symmetry(1)), None]; 2];
    let options = Hyperbolic::new(geometric(5.0, 1e-3, 31));
    let two = hyperbolic_surfaces(&[upper, lower], &edges, &options).unwrap();
    println!("{:?}", two.report);
    check(&two, 1e-3);
    edges.stated.pop();
    let one = hyperbolic_surfaces(&[round], &edges, &options).unwrap();
    check(&one, 1e-3);
    let found = lines(&two.blocks);
    for (start, line) in lines(&one.blocks) {
        let other = &found[&start];
        assert!(line.iter().zip(other).all(|(p, q)| p.distance(*q) < 1e-6));
        assert!(line[0].y > 0.0 || line.iter().all(|p| p.y == 0.0));
    }
}

/// A tip pinched shut along its chord: at both ends of the fold two cells are all around the node.
#[test]
fn pinched_tips_are_refused() {
    let half = |sign: f64| {
        SurfaceGrid::from_fn(9, 9, |i, j| {
            let (u, v) = (i as f64 / 8.0, j as f64 / 8.0);
            Vec3::of(u, v, sign * u * (1.0 - u) * (1.0 - v * v))
        })
    };
    let mut edges = OpenFrontEdges::all(2, MarchBoundary::Free);
    edges.stated = vec![[None, None, Some(MarchBoundary::Symmetry(1)), None]; 2];
    let found = fault(&[half(1.0), half(-1.0)], &edges);
    assert!(matches!(found, JoinFault::TwoCells { .. }), "{found}");
}

/// A ball with two poles whose seam and collapsed edges are found.
#[test]
fn poles_and_seams_are_found() {
    let (m, n) = (17, 25);
    let ball = SurfaceGrid::from_fn(m, n, |i, j| {
        let (a, b) =
            (PI * i as f64 / (m - 1) as f64, 2.0 * PI * (j % (n - 1)) as f64 / (n - 1) as f64);
        let r = if i == 0 || i == m - 1 { 0.0 } else { a.sin() };
        Vec3::of(-a.cos(), r * b.cos(), r * b.sin()) * -1.0
    });
    let heights = geometric(2.0, 1e-2, 21);
    let marched = march(std::slice::from_ref(&ball), heights.clone());
    check(&marched, 1e-2);
    for p in marched.blocks[0].layers()[20].points() {
        assert!((p.norm() - 3.0).abs() < 0.15, "{p:?}");
    }
    let block = &marched.blocks[0];
    for k in 0..21 {
        assert!((0..n).all(|j| block.at(0, j, k) == block.at(0, 0, k)));
        assert!((0..m).all(|i| block.at(i, 0, k) == block.at(i, n - 1, k)));
    }
    // Cut in quarters, every other one turned.
    let quarters: Vec<SurfaceGrid<f64>> = (0..4)
        .map(|q| reordered(&SurfaceGrid::from_fn(m, 7, |i, j| ball.at(i, 6 * q + j)), q % 2 * 6))
        .collect();
    let parts = march(&quarters, heights);
    check(&parts, 1e-2);
    let whole = lines(&marched.blocks);
    for (start, line) in lines(&parts.blocks) {
        assert!(line.iter().zip(&whole[&start]).all(|(p, q)| p.distance(*q) < 1e-6));
    }
}

fn fault(surfaces: &[SurfaceGrid<f64>], edges: &OpenFrontEdges) -> JoinFault {
    match hyperbolic_surfaces(surfaces, edges, &Hyperbolic::new(vec![0.0, 0.01, 0.02])) {
        Err(GridError::Join(fault)) => *fault,
        other => panic!("{other:?}"),
    }
}

#[test]
fn surfaces_that_are_no_front_are_refused_by_name() {
    let flat = |m: usize, n: usize, from: [f64; 2], to: [f64; 2]| {
        SurfaceGrid::from_fn(m, n, |i, j| {
            let (u, v) = (i as f64 / (m - 1) as f64, j as f64 / (n - 1) as f64);
            Vec3::of(from[0] + u * (to[0] - from[0]), from[1] + v * (to[1] - from[1]), 0.0)
        })
    };
    let free = |count: usize| OpenFrontEdges::all(count, MarchBoundary::Free);
    let left = flat(5, 5, [0.0, 0.0], [1.0, 1.0]);
    // Half as many points along the common edge, and points between.
    for other in [3, 4] {
        let right = flat(5, other, [1.0, 0.0], [2.0, 1.0]);
        let found = fault(&[left.clone(), right], &free(2));
        assert!(matches!(found, JoinFault::Hanging { .. }), "{found}");
        assert!(found.to_string().contains("of surface"));
    }
    // An edge that ends inside another surface.
    let wall = SurfaceGrid::from_fn(5, 3, |i, j| Vec3::of(i as f64 / 4.0, 0.5, j as f64));
    assert!(matches!(fault(&[left.clone(), wall], &free(2)), JoinFault::Hanging { .. }));
    // Three surfaces at one edge.
    let right = flat(5, 5, [1.0, 0.0], [2.0, 1.0]);
    let up = SurfaceGrid::from_fn(5, 5, |i, j| Vec3::of(1.0, j as f64 / 4.0, i as f64));
    let three = fault(&[left.clone(), right.clone(), up], &free(3));
    assert!(matches!(three, JoinFault::ThreeMeet { .. }), "{three}");
    // A gap of a hundredth of a cell, and one of a fifth.
    let gap = |by: f64| flat(5, 5, [1.0 + by, 0.0], [2.0, 1.0]);
    let apart = fault(&[left.clone(), gap(0.0025)], &free(2));
    assert!(matches!(apart, JoinFault::Apart { gap, .. } if (gap - 0.0025).abs() < 1e-12));
    let slot = hyperbolic_surfaces(
        &[left.clone(), gap(0.05)],
        &free(2),
        &Hyperbolic::new(vec![0.0, 0.01, 0.02]),
    );
    assert!(slot.is_ok(), "{slot:?}");
    // A band with half a turn.
    let band = SurfaceGrid::<f64>::from_fn(33, 5, |i, j| {
        let a = 2.0 * PI * i as f64 / 32.0;
        let w = 0.1 * (j as f64 - 2.0);
        let r = 1.0 + w * (0.5 * a).cos();
        Vec3::of(r * a.cos(), r * a.sin(), w * (0.5 * a).sin())
    });
    let moebius = fault(&[band], &free(1));
    assert!(matches!(moebius, JoinFault::NotOrientable { .. }), "{moebius}");
    // Two surfaces that have a corner in common.
    let corner = flat(5, 5, [1.0, 1.0], [2.0, 2.0]);
    assert!(matches!(fault(&[left.clone(), corner], &free(2)), JoinFault::Pinched { .. }));
    // A condition on a joined edge, a plane of symmetry that the edges are not in, a pole that is none.
    let mut edges = free(2);
    edges.stated[0][1] = Some(MarchBoundary::Constant(0));
    let pair = [left.clone(), right];
    assert!(matches!(fault(&pair, &edges), JoinFault::NotOpen { surface: 1, .. }));
    let planes = OpenFrontEdges::all(2, MarchBoundary::Symmetry(1));
    assert!(matches!(fault(&pair, &planes), JoinFault::NotPlane { axis: 1, .. }));
    edges.stated[0] = [Some(MarchBoundary::Pole), None, None, None];
    assert!(matches!(fault(&pair, &edges), JoinFault::Open { surface: 1, .. }));
    // Two equal points at an edge.
    let mut doubled = left;
    doubled.set(0, 2, doubled.at(0, 1));
    assert!(matches!(fault(&[doubled], &free(1)), JoinFault::Coincident { .. }));
    assert!(matches!(fault(&[], &free(0)), JoinFault::Count { surfaces: 0, .. }));
}

/// Two plates that face each other: separate fronts of one march.
#[test]
fn fronts_of_two_surfaces_meet() {
    let surfaces = [0.0, 1.0].map(|z| {
        SurfaceGrid::from_fn(7, 9, |i, j| {
            let (u, v) = (i as f64 / 6.0, j as f64 / 8.0);
            if z == 0.0 { Vec3::of(u, v, z) } else { Vec3::of(v, u, z + 0.01 * u) }
        })
    });
    let free = OpenFrontEdges::all(2, MarchBoundary::Free);
    let mut options = Hyperbolic::new(geometric(0.8, 0.02, 17));
    let error = hyperbolic_surfaces(&surfaces, &free, &options).unwrap_err();
    let GridError::March(failure) = error else { panic!("{error}") };
    let FailureCause::LayersMeet { other, .. } = failure.cause else { panic!("{failure}") };
    assert_eq!([failure.at.surface, other.surface], [Some(1), Some(2)]);
    assert!(failure.to_string().contains("of surface 2"), "{failure}");
    options.stop.keep = true;
    let kept = hyperbolic_surfaces(&surfaces, &free, &options).unwrap();
    check(&kept, 0.02);
    assert!(matches!(kept.report.stopped, Some(StopReason::Failure(_))));
    let reached = kept.blocks[0].layers().pop().unwrap().at(3, 3).z;
    assert!(reached > 0.35 && reached < 0.51, "{reached}");
}

#[test]
fn derivatives_are_those_of_the_front() {
    fn last<T: Real>(h: T) -> Vec<SurfaceGrid<T>> {
        let surfaces = cubed(5, |p| {
            let u = p / p.norm();
            Vec3::new(T::from(u.x), h * (u.y * 5.0), T::from(0.6 * u.z))
        });
        let heights = geometric(1.0, 2e-2, 9).into_iter().map(T::from).collect();
        let free = OpenFrontEdges::all(6, MarchBoundary::Free);
        let marched = hyperbolic_surfaces(&surfaces, &free, &Hyperbolic::new(heights)).unwrap();
        marched.blocks.iter().map(|block| block.layers().remove(8)).collect()
    }
    let seed = Dual4::from_parts(|k| [0.2, 1.0, 0.0, 0.0, 0.0][k]);
    let [high, low] = [1e-5, -1e-5].map(|step| last(0.2 + step));
    for (k, dual) in last(seed).iter().enumerate() {
        for (c, plane) in dual.planes.iter().enumerate() {
            for (at, x) in plane.iter().enumerate() {
                let difference = (high[k].planes[c][at] - low[k].planes[c][at]) / 2e-5;
                assert!((x.part(1) - difference).abs() < 1e-4, "{} {difference}", x.part(1));
            }
        }
    }
}
