//! Grids against closed forms, and the same bits at any number of threads.

use moldloft_grid::*;
use moldloft_num::{Dual4, Order, Real, SurfJet, Surface, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// The grid of `f` at all points, and the same with its inside cleared.
fn emptied(grid: &SurfaceGrid<f64>) -> SurfaceGrid<f64> {
    SurfaceGrid::<f64>::from_fn(grid.m, grid.n, |i, j| {
        let edge = i == 0 || j == 0 || i + 1 == grid.m || j + 1 == grid.n;
        if edge { grid.at(i, j) } else { Vec3::of(9.0, -7.0, 5.0) }
    })
}

fn largest(a: &SurfaceGrid<f64>, b: &SurfaceGrid<f64>) -> f64 {
    a.points().zip(b.points()).map(|(p, q)| p.distance(q)).fold(0.0, f64::max)
}

fn laplace(sweeps: usize, omega: f64) -> Elliptic<'static, f64> {
    Elliptic {
        method: Method::Laplace,
        sweeps,
        tolerance: 1e-14,
        omega,
        walls: vec![],
        periodic: None,
        on: None,
    }
}

fn stretch(x: f64) -> f64 {
    (libm::exp(2.0 * x) - 1.0) / (libm::exp(2.0) - 1.0)
}

#[test]
fn stretched_squares_and_ruled_surfaces_are_exact() {
    let (m, n) = (21, 15);
    let u = |i: usize| stretch(i as f64 / (m - 1) as f64);
    let v = |j: usize| 1.0 - stretch(1.0 - j as f64 / (n - 1) as f64);
    let square = SurfaceGrid::<f64>::from_fn(m, n, |i, j| Vec3::of(u(i), v(j), 0.0));
    let grid = transfinite(&emptied(&square), Blend::Arc).unwrap();
    assert!(largest(&grid, &square) <= 2.3e-16, "{:e}", largest(&grid, &square));
    let annulus = SurfaceGrid::<f64>::from_fn(m, n, |i, j| {
        let (r, a) = (1.0 + 2.0 * u(i), FRAC_PI_2 * j as f64 / (n - 1) as f64);
        Vec3::of(r * a.cos(), r * a.sin(), 0.0)
    });
    for blend in [Blend::Arc, Blend::Soni2] {
        let grid = transfinite(&emptied(&annulus), blend).unwrap();
        assert!(largest(&grid, &annulus) <= 7e-16 * 3.0);
    }
    // A cone from its tip: the pole takes the distribution of the base.
    let cone = SurfaceGrid::<f64>::from_fn(m, n, |i, j| {
        let a = PI * v(j);
        Vec3::of(3.0 * u(i), u(i) * a.cos(), u(i) * a.sin())
    });
    let grid = transfinite(&emptied(&cone), Blend::Arc).unwrap();
    assert!(largest(&grid, &cone) <= 2e-15, "{:e}", largest(&grid, &cone));
    let linear =
        SurfaceGrid::<f64>::from_fn(5, 9, |i, j| Vec3::of(i as f64, j as f64, (i * j) as f64));
    let grid = transfinite(&emptied(&linear), Blend::Linear).unwrap();
    assert!(largest(&grid, &linear) < 1e-14);
}

#[test]
fn edges_stay_to_the_bit_and_cubic_blending_joins_smoothly() {
    let wavy = SurfaceGrid::<f64>::from_fn(17, 23, |i, j| {
        let (u, v) = (i as f64 / 16.0, j as f64 / 22.0);
        Vec3::of(u + 0.1 * (3.0 * v).sin(), v * v + 0.2 * u * (1.0 - u), 0.3 * (4.0 * u * v).cos())
    });
    for blend in [Blend::Arc, Blend::Linear, Blend::Hermite, Blend::Soni2] {
        let grid = transfinite(&emptied(&wavy), blend).unwrap();
        for edge in GridSide::ALL {
            assert_eq!(grid.edge(edge), wavy.edge(edge));
        }
        assert!(grid.points().all(|p| p.is_finite()));
    }
    // Two halves of a surface whose edges continue smoothly: with cubic blending the grid lines
    // pass the seam without a kink, at a rate of convergence.
    let whole = |k: usize, u: f64, v: f64| {
        let (u, s) = (u + k as f64, 0.2 * v * v);
        Vec3::of(u, v + 0.3 * (1.0 - v) * (1.3 * u).sin() + s * u * u, 0.0)
    };
    let kink = |n: usize, blend: Blend| {
        let half = |k: usize| {
            let at = |i: usize, j: usize| whole(k, i as f64 / n as f64, j as f64 / n as f64);
            transfinite(&emptied(&SurfaceGrid::<f64>::from_fn(n + 1, n + 1, at)), blend).unwrap()
        };
        let (a, b) = (half(0), half(1));
        let slope = |j: usize| (b.at(1, j) - b.at(0, j) - (a.at(n, j) - a.at(n - 1, j))) * n as f64;
        (1..n).map(|j| slope(j).norm()).fold(0.0, f64::max)
    };
    assert!(kink(160, Blend::Hermite) < 0.6 * kink(80, Blend::Hermite));
    assert!(kink(160, Blend::Arc) > 10.0 * kink(160, Blend::Hermite));
}

#[test]
fn leaps_are_found_with_corner_and_gap() {
    let square = SurfaceGrid::<f64>::from_fn(9, 9, |i, j| Vec3::of(i as f64, j as f64, 0.0));
    let mut gap = square.clone();
    // The corner was set with s[1,]; s[,1] was meant to begin elsewhere.
    for i in 1..8 {
        gap.set(i, 8, Vec3::of(i as f64, 40.0, 0.0));
    }
    let error = transfinite(&gap, Blend::Arc).unwrap_err();
    let GridError::EdgesApart { corner, gap } = error else { panic!("{error}") };
    assert_eq!((corner.edge, corner.at), (GridSide::LastJ, [1, 9]));
    assert!((gap - 33f64.hypot(0.0)).abs() < 2.0);
    // An edge that was never set.
    let mut unset = square.clone();
    for j in 1..8 {
        unset.set(8, j, Vec3::zero());
    }
    assert!(matches!(transfinite(&unset, Blend::Arc), Err(GridError::EdgesApart { .. })));
    let mut bad = square.clone();
    bad.set(0, 3, Vec3::of(f64::NAN, 0.0, 0.0));
    assert_eq!(transfinite(&bad, Blend::Arc), Err(GridError::NotFinite { at: [1, 4] }));
    let thin = SurfaceGrid::<f64>::from_fn(1, 5, |_, j| Vec3::of(0.0, j as f64, 0.0));
    assert!(matches!(transfinite(&thin, Blend::Arc), Err(GridError::TooFew { .. })));
    // Four curves.
    let line = |a: [f64; 2], b: [f64; 2], n: usize| -> Vec<Vec3> {
        let at = |k: usize| k as f64 / (n - 1) as f64;
        (0..n)
            .map(|k| Vec3::of(a[0] + (b[0] - a[0]) * at(k), a[1] + (b[1] - a[1]) * at(k), 0.0))
            .collect()
    };
    let mut edges = [
        line([0.0, 0.0], [0.0, 1.0], 5),
        line([2.0, 0.0], [2.0, 1.0], 5),
        line([0.0, 0.0], [2.0, 0.0], 4),
        line([0.0, 1.0], [2.0, 1.0], 4),
    ];
    assert!(framed(&edges).is_ok());
    edges[3] = line([0.0, 1.0], [2.0, 1.25], 4);
    let error = framed(&edges).unwrap_err();
    let GridError::EdgesApart { corner, gap } = error else { panic!("{error}") };
    assert_eq!(
        (corner.edge, corner.other, corner.at, gap),
        (GridSide::LastI, GridSide::LastJ, [4, 5], 0.25)
    );
}

#[test]
fn blocks_from_six_faces() {
    let [ni, nj, nk] = [7, 6, 5];
    // Stretched differently in each direction, and sheared: linear in each direction.
    let at = |i: usize, j: usize, k: usize| {
        let (u, v, w) = (stretch(i as f64 / 6.0), j as f64 / 5.0, stretch(k as f64 / 4.0));
        Vec3::of(u + 0.2 * v, v * (1.0 + 0.5 * w), w * 2.0 + 0.1 * u)
    };
    let faces: Faces<f64> = [
        SurfaceGrid::<f64>::from_fn(nj, nk, |j, k| at(0, j, k)),
        SurfaceGrid::<f64>::from_fn(nj, nk, |j, k| at(ni - 1, j, k)),
        SurfaceGrid::<f64>::from_fn(ni, nk, |i, k| at(i, 0, k)),
        SurfaceGrid::<f64>::from_fn(ni, nk, |i, k| at(i, nj - 1, k)),
        SurfaceGrid::<f64>::from_fn(ni, nj, |i, j| at(i, j, 0)),
        SurfaceGrid::<f64>::from_fn(ni, nj, |i, j| at(i, j, nk - 1)),
    ];
    let layers = transfinite_block(&faces).unwrap();
    for (k, layer) in layers.iter().enumerate() {
        let exact = SurfaceGrid::<f64>::from_fn(ni, nj, |i, j| at(i, j, k));
        assert!(largest(layer, &exact) < 1e-15 * 8.0, "{k} {:e}", largest(layer, &exact));
    }
    let mut torn = faces.clone();
    torn[3].set(2, 0, Vec3::of(0.0, 0.0, 0.0));
    let error = transfinite_block(&torn).unwrap_err();
    assert!(matches!(error, GridError::FacesApart { faces: [4, 5], at: [3, 1], .. }), "{error}");
    let mut wrong = faces;
    wrong[1] = SurfaceGrid::<f64>::from_fn(nj, nk + 1, |j, k| at(0, j, k));
    assert!(matches!(
        transfinite_block(&wrong),
        Err(GridError::FaceSizes { face: 2, expected: [6, 5], actual: [6, 6] })
    ));
}

#[test]
fn laplace_makes_squares_even_and_annuli_geometric() {
    let square = SurfaceGrid::<f64>::from_fn(12, 9, |i, j| Vec3::of(i as f64, j as f64, 0.0));
    let mut start = square.clone();
    for i in 1..11 {
        for j in 1..8 {
            let bump = 0.4 * ((i * 7 + j * 3) % 5) as f64;
            start.set(i, j, square.at(i, j) + Vec3::of(bump, -0.6 * bump, 0.0));
        }
    }
    let smoothed = elliptic(&start, &laplace(2000, 1.3)).unwrap();
    assert!(largest(&smoothed.grid, &square) < 1e-11 * 12.0);
    assert!(smoothed.sweeps < 2000 && smoothed.change <= 1e-14);
    let error = |n: usize| {
        let ring = SurfaceGrid::<f64>::from_fn(n + 1, n + 1, |i, j| {
            let (r, a) = (1.0 + 3.0 * i as f64 / n as f64, FRAC_PI_2 * j as f64 / n as f64);
            Vec3::of(0.3, r * a.cos(), r * a.sin())
        });
        // The radial edges run geometrically, as the solution does.
        let exact = SurfaceGrid::<f64>::from_fn(n + 1, n + 1, |i, j| {
            let (r, a) = (4f64.powf(i as f64 / n as f64), FRAC_PI_2 * j as f64 / n as f64);
            Vec3::of(0.3, r * a.cos(), r * a.sin())
        });
        let start = SurfaceGrid::<f64>::from_fn(n + 1, n + 1, |i, j| {
            let edge = j == 0 || j == n;
            if edge { exact.at(i, j) } else { ring.at(i, j) }
        });
        largest(&elliptic(&start, &laplace(4000, 1.5)).unwrap().grid, &exact)
    };
    let (coarse, fine) = (error(10), error(20));
    assert!(fine < 5e-3 && (3.5..4.5).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
}

#[test]
fn middlecoff_keeps_the_clustering_of_the_edges() {
    let n = 16;
    let stretched = SurfaceGrid::<f64>::from_fn(n + 1, n + 1, |i, j| {
        Vec3::of(i as f64 / n as f64, stretch(j as f64 / n as f64), 0.0)
    });
    let options = Elliptic { method: Method::Middlecoff, ..laplace(3000, 1.2) };
    let mut start = stretched.clone();
    for i in 1..n {
        for j in 1..n {
            start.set(i, j, Vec3::of(i as f64 / n as f64, j as f64 / n as f64, 0.0));
        }
    }
    let kept = elliptic(&start, &options).unwrap();
    assert!(largest(&kept.grid, &stretched) < 1e-11, "{:e}", largest(&kept.grid, &stretched));
}

#[test]
fn sorenson_gives_walls_their_spacing_and_right_angles() {
    let (m, n) = (33, 21);
    // A channel over a bump.
    let start = SurfaceGrid::<f64>::from_fn(m, n, |i, j| {
        let (u, v) = (3.0 * i as f64 / (m - 1) as f64, j as f64 / (n - 1) as f64);
        let bump = 0.15 * libm::exp(-(u - 1.5) * (u - 1.5) * 8.0);
        Vec3::of(u, bump + (1.0 - bump) * v, 0.0)
    });
    let wall = Wall { edge: GridSide::FirstJ, spacing: vec![0.02], angle: FRAC_PI_2 };
    let options = |method: Method, walls: Vec<Wall<f64>>| Elliptic {
        method,
        sweeps: 1500,
        tolerance: 1e-10,
        omega: 1.0,
        walls,
        periodic: None,
        on: None,
    };
    let off = |grid: &SurfaceGrid<f64>| {
        let mut worst = [0.0f64; 2];
        for i in 4..m - 4 {
            let along = grid.at(i + 1, 0) - grid.at(i - 1, 0);
            let out = grid.at(i, 1) - grid.at(i, 0);
            worst[0] = worst[0].max((out.norm() / 0.02 - 1.0).abs());
            worst[1] = worst[1].max((along.dot(out) / along.norm() / out.norm()).abs());
        }
        worst
    };
    let plain = off(&elliptic(&start, &options(Method::Laplace, vec![])).unwrap().grid);
    let done = elliptic(&start, &options(Method::Sorenson, vec![wall])).unwrap();
    let held = off(&done.grid);
    println!("spacing and angle off by {plain:?} without, {held:?} with wall terms");
    assert!(plain[0] > 0.5 && held[0] < 1e-5, "{held:?}");
    assert!(held[1] < 1e-5, "{held:?}");
    assert!(done.converged && done.walls[0].error() < 1e-5, "{:?}", done.walls);
    assert!(folded_cells(&done.grid).is_empty());
}

/// Half an annulus from 1 to 6 with both arcs as walls: cells of 0.005 at right angles on either.
#[test]
fn two_walls_converge() {
    let (m, n) = (31, 41);
    let start = SurfaceGrid::<f64>::from_fn(m, n, |i, j| {
        let a = PI - PI * i as f64 / (m - 1) as f64;
        let (u, d) = (2.0 * j as f64 / (n - 1) as f64 - 1.0, 3.65f64);
        let r = 3.5 + 2.5 * (d * u).tanh() / d.tanh();
        Vec3::of(r * a.cos(), r * a.sin(), 0.0)
    });
    let first = start.at(0, 1).distance(start.at(0, 0));
    let wall = |edge| Wall { edge, spacing: vec![first], angle: FRAC_PI_2 };
    let walls = vec![wall(GridSide::FirstJ), wall(GridSide::LastJ)];
    let options = Elliptic {
        method: Method::Sorenson,
        sweeps: 4000,
        tolerance: 1e-9,
        omega: 1.0,
        walls,
        periodic: None,
        on: None,
    };
    let done = elliptic(&start, &options).unwrap();
    println!("{} sweeps, cell {first}, {:?}", done.sweeps, done.walls);
    assert!(done.converged && done.sweeps < 3000);
    for (j, beside) in [(0, 1), (n - 1, n - 2)] {
        for i in 1..m - 1 {
            let out = done.grid.at(i, beside) - done.grid.at(i, j);
            let along = done.grid.at(i + 1, j) - done.grid.at(i - 1, j);
            assert!((out.norm() / first - 1.0).abs() < 1e-5);
            assert!((out.dot(along) / out.norm() / along.norm()).abs() < 1e-5);
        }
    }
    // A handful of sweeps is not enough, and the report says so.
    let few = elliptic(&start, &Elliptic { sweeps: 10, ..options }).unwrap();
    assert!(!few.converged && few.history.len() == 10);
}

/// Grids that are solutions of Laplace's equations: conformal images of a ring, geometric in the radius; the error
/// falls with the square of the cell.
#[test]
fn conformal_grids_converge_at_second_order() {
    let maps: [(&str, fn(f64, f64) -> [f64; 2]); 3] = [
        ("annulus", |a, r| [r * a.cos(), r * a.sin()]),
        ("ellipse", |a, r| [(r + 0.3 / r) * a.cos(), (r - 0.3 / r) * a.sin()]),
        ("Joukowski", |a, r| {
            let (x, y) = (1.2 * r * a.cos() - 0.1, 1.2 * r * a.sin() + 0.1);
            let square = x * x + y * y;
            [x + x / square, y - y / square]
        }),
    ];
    for (name, map) in maps {
        let error = |m: usize, n: usize| {
            let exact = SurfaceGrid::<f64>::from_fn(m, n, |i, j| {
                let (u, v) = (i as f64 / (m - 1) as f64, j as f64 / (n - 1) as f64);
                let [x, y] = map(2.0 - 1.5 * u, (v * 1.0).exp());
                Vec3::of(x, y, 0.0)
            });
            let start = transfinite(&emptied(&exact), Blend::Arc).unwrap();
            let done = elliptic(&start, &laplace(4000, 1.5)).unwrap();
            largest(&done.grid, &exact)
        };
        let [a, b, c] = [(9, 7), (17, 13), (33, 25)].map(|(m, n)| error(m, n));
        println!("{name}: {a:e} {b:e} {c:e}");
        assert!((a / b).log2() > 1.8 && (b / c).log2() > 1.9, "{name}: {a:e} {b:e} {c:e}");
    }
}

#[test]
fn folded_starts_unfold() {
    let n = 12;
    let mut start = SurfaceGrid::<f64>::from_fn(n + 1, n + 1, |i, j| {
        Vec3::of(i as f64, j as f64 + 0.1 * i as f64, 0.0)
    });
    for i in 3..8 {
        for j in 3..8 {
            start.set(i, j, start.at(10 - i, 10 - j));
        }
    }
    let folded = folded_cells(&start);
    assert!(folded.len() > 5);
    let done = elliptic(&start, &laplace(300, 1.0)).unwrap();
    assert!(folded_cells(&done.grid).is_empty());
}

struct Ball;

impl<T: Real> Surface<T> for Ball {
    fn jet(&self, u: T, v: T, _: Order) -> SurfJet<T> {
        // A patch of the unit sphere around the equator.
        let (a, b) = (u * 1.5 - 0.75, v * 1.5 - 0.75);
        let (sa, ca, sb, cb) = (a.sin(), a.cos(), b.sin(), b.cos());
        SurfJet {
            p: Vec3::new(ca * cb, sa * cb, sb),
            u: Vec3::new(-(sa * cb), ca * cb, T::zero()) * T::from(1.5),
            v: Vec3::new(-(ca * sb), -(sa * sb), cb) * T::from(1.5),
            ..SurfJet::default()
        }
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
    moldloft_num::surface_one_by_one!(T: grid, line, scattered);
}

#[test]
fn points_stay_on_their_surface() {
    let n = 14;
    let uv = |i: usize, j: usize| {
        let (u, v) = (i as f64 / n as f64, j as f64 / n as f64);
        let inside = i > 0 && j > 0 && i < n && j < n;
        if inside { [u * u, (v + 0.2 * u * v * (1.0 - v)).min(1.0)] } else { [u, v] }
    };
    let at = |i: usize, j: usize| {
        let [u, v] = uv(i, j);
        Surface::<f64>::jet(&Ball, u, v, Order::Zero).p
    };
    let start = SurfaceGrid::<f64>::from_fn(n + 1, n + 1, at);
    let plane =
        |c: usize| (0..(n + 1) * (n + 1)).map(|k| uv(k / (n + 1), k % (n + 1))[c]).collect();
    let options = Elliptic { on: Some((&Ball, [plane(0), plane(1)])), ..laplace(800, 1.2) };
    let done = elliptic(&start, &options).unwrap();
    assert!(done.grid.points().all(|p| (p.norm() - 1.0).abs() < 1e-14));
    assert!(done.change < 1e-9);
    // Symmetric as the edges are: the middle point is in the middle.
    assert!((done.grid.at(7, 7) - Vec3::of(1.0, 0.0, 0.0)).norm() < 1e-7);
}

#[test]
fn the_same_bits_at_any_number_of_threads() {
    let n = 190;
    let wavy = SurfaceGrid::<f64>::from_fn(n, n + 7, |i, j| {
        let (u, v) = (i as f64 / (n - 1) as f64, j as f64 / (n + 6) as f64);
        Vec3::of(u + 0.2 * v * v, v + 0.1 * (5.0 * u).sin(), 0.1 * u * v)
    });
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let grid = transfinite(&wavy, Blend::Arc).unwrap();
            let options = Elliptic { method: Method::Middlecoff, ..laplace(7, 1.1) };
            elliptic(&grid, &options).unwrap().grid
        })
    };
    let bits = |s: &SurfaceGrid<f64>| -> Vec<u64> {
        s.planes.iter().flatten().map(|x| x.to_bits()).collect()
    };
    let one = bits(&run(1));
    assert!(one == bits(&run(2)) && one == bits(&run(5)));
}

#[test]
fn derivatives_flow_through_sweeps() {
    // d/dh of the smoothed grid over a bump of height h.
    fn grid<T: Real>(h: T) -> SurfaceGrid<T> {
        let start = SurfaceGrid::<T>::from_fn(11, 9, |i, j| {
            let (u, v) = (i as f64 / 10.0, j as f64 / 8.0);
            let bump = h * (u * (1.0 - u));
            Vec3::new(T::from(u + 0.1 * v), bump + (-bump + 1.0) * v, h * (u * v))
        });
        let grid = transfinite(&start, Blend::Arc).unwrap();
        let options = Elliptic {
            method: Method::Sorenson,
            sweeps: 60,
            tolerance: 0.0,
            omega: 1.1,
            walls: vec![Wall {
                edge: GridSide::FirstJ,
                spacing: vec![h * 0.1],
                angle: T::from(1.4),
            }],
            periodic: None,
            on: None,
        };
        elliptic(&grid, &options).unwrap().grid
    }
    let dual = grid(Dual4::from_parts(|k| [0.4, 1.0, 0.0, 0.0, 0.0][k]));
    let (high, low) = (grid(0.4 + 1e-5), grid(0.4 - 1e-5));
    for c in 0..3 {
        for (k, x) in dual.planes[c].iter().enumerate() {
            let difference = (high.planes[c][k] - low.planes[c][k]) / 2e-5;
            assert!((x.part(1) - difference).abs() < 1e-7, "{c} {k}: {} {difference}", x.part(1));
        }
    }
}

#[test]
fn metrics_of_known_cells() {
    let one = |f: &dyn Fn(f64, f64) -> Vec3, metric: QualityMetric| {
        quality(&SurfaceGrid::<f64>::from_fn(2, 2, |i, j| f(i as f64, j as f64)), metric)[0]
    };
    let square = |u: f64, v: f64| Vec3::of(u, v, 0.0);
    for (metric, value) in [
        (QualityMetric::ScaledJacobian, 1.0),
        (QualityMetric::Skew, 0.0),
        (QualityMetric::Aspect, 1.0),
        (QualityMetric::EdgeRatio, 1.0),
        (QualityMetric::GrowthI, 1.0),
        (QualityMetric::Warp, 0.0),
        (QualityMetric::Turn, 0.0),
        (QualityMetric::Area, 1.0),
    ] {
        assert!((one(&square, metric) - value).abs() < 1e-15, "{metric:?}");
    }
    let h = 0.5f64.sqrt();
    let rhombus = |u: f64, v: f64| Vec3::of(u + h * v, h * v, 0.0);
    assert!((one(&rhombus, QualityMetric::ScaledJacobian) - h).abs() < 1e-15);
    assert!((one(&rhombus, QualityMetric::Skew) - 0.5).abs() < 1e-15);
    let rectangle = |u: f64, v: f64| Vec3::of(0.0, 2.0 * u, v);
    assert_eq!(one(&rectangle, QualityMetric::EdgeRatio), 2.0);
    assert_eq!(one(&rectangle, QualityMetric::Aspect), 2.0);
    let lift = |u: f64, v: f64| Vec3::of(u, v, if u == v { 0.1 } else { -0.1 });
    let area = one(&lift, QualityMetric::Area);
    assert!((one(&lift, QualityMetric::Warp) - 0.1 / area.sqrt()).abs() < 1e-15);
    // Widths 1, 3, 9 along i; a bend of 30 degrees along j.
    let grid = SurfaceGrid::<f64>::from_fn(4, 3, |i, j| {
        let x = [0.0, 1.0, 4.0, 13.0][i];
        let a = PI / 6.0;
        let y = [0.0, 1.0, 1.0 + a.cos()][j];
        Vec3::of(x, y, if j == 2 { a.sin() } else { 0.0 })
    });
    let growth = quality(&grid, QualityMetric::GrowthI);
    assert!(growth.iter().all(|g| (g - 3.0).abs() < 1e-14) && growth.len() == 6);
    assert!(quality(&grid, QualityMetric::GrowthJ).iter().all(|g| (g - 1.0).abs() < 1e-14));
    assert!(quality(&grid, QualityMetric::Turn).iter().all(|g| (g - PI / 6.0).abs() < 1e-14));
    // A pole: triangles, not folded.
    let fan = SurfaceGrid::<f64>::from_fn(3, 5, |i, j| {
        let a = 0.3 * j as f64;
        Vec3::of(i as f64 * a.cos(), i as f64 * a.sin(), 0.0)
    });
    assert!(folded_cells(&fan).is_empty());
    let skew = quality(&fan, QualityMetric::Skew);
    assert!((skew[0] - (1.0 - 0.3 / (PI / 3.0))).abs() < 1e-14, "{}", skew[0]);
    assert!(quality(&fan, QualityMetric::ScaledJacobian)[0] > 0.29);
    assert!(
        quality(
            &SurfaceGrid::<f64>::from_fn(1, 4, |_, j| Vec3::of(j as f64, 0.0, 0.0)),
            QualityMetric::Area
        )
        .is_empty()
    );
}

/// A ring between two circles, its cut anywhere.
fn ring(m: usize, n: usize, cut: f64) -> SurfaceGrid<f64> {
    SurfaceGrid::from_fn(m, n, |i, j| {
        let angle = cut + std::f64::consts::TAU * (i % (m - 1)) as f64 / (m - 1) as f64;
        let share = j as f64 / (n - 1) as f64;
        let radius = 1.0 + 3.0 * share;
        Vec3::of(0.8 * share + radius * libm::cos(angle), radius * libm::sin(angle), 0.0)
    })
}

#[test]
fn the_cut_of_a_ring_leaves_no_trace() {
    // The smoothed ring is the same wherever its cut is: points of one cut are those of another.
    let (m, n, shift) = (37, 13, 9);
    for (edges, sweeps) in [(PeriodicEdges::I, 4000), (PeriodicEdges::J, 4000)] {
        let smooth = |cut: f64| {
            let start = ring(m, n, cut);
            let start = if edges == PeriodicEdges::I { start } else { start.transposed() };
            let options = Elliptic { periodic: Some(edges), ..laplace(sweeps, 1.2) };
            let done = elliptic(&start, &options).unwrap();
            assert!(done.converged, "{}", done.change);
            if edges == PeriodicEdges::I { done.grid } else { done.grid.transposed() }
        };
        let one = smooth(0.0);
        let other = smooth(std::f64::consts::TAU * shift as f64 / (m - 1) as f64);
        let mut worst: f64 = 0.0;
        let mut moved: f64 = 0.0;
        for i in 0..m {
            for j in 0..n {
                let p = one.at((i + shift) % (m - 1), j);
                worst = worst.max(p.distance(other.at(i, j)));
                moved = moved.max(one.at(i, j).distance(ring(m, n, 0.0).at(i, j)));
            }
        }
        assert!(worst < 1e-10, "{worst:e}");
        assert!(moved > 0.01);
        // With the cut held there is a kink.
        let fixed = elliptic(&ring(m, n, 0.7), &laplace(4000, 1.2)).unwrap().grid;
        let free = elliptic(
            &ring(m, n, 0.7),
            &Elliptic { periodic: Some(PeriodicEdges::I), ..laplace(4000, 1.2) },
        );
        assert!(largest(&fixed, &free.unwrap().grid) > 0.01);
    }
}

#[test]
fn periodic_edges_are_the_same_line() {
    let mut grid = ring(9, 5, 0.0);
    grid.set(8, 2, grid.at(8, 2) + Vec3::of(0.0, 1e-3, 0.0));
    let options = Elliptic { periodic: Some(PeriodicEdges::I), ..laplace(10, 1.0) };
    match elliptic(&grid, &options) {
        Err(GridError::NotPeriodic { at: [9, 3], gap }) => assert!((gap - 1e-3).abs() < 1e-12),
        other => panic!("{other:?}"),
    }
}
