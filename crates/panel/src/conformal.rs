//! Nets of patches with knuckles of the whole as rows.
//!
//! The net of straight lines between the divisions of the edges is displaced: its vertices on the way from the beginning
//! of a knuckle to its end are moved onto it, those of the border stay, and the others follow by transfinite interpolation.
//! A line from an edge to the opposite one is a row; one to an edge beside it turns once.

use crate::knuckles::{KnuckleLine, Knuckles, rate_across};
use moldloft_num::{Real, Surface};

/// Distance of a division from the end of a line, in parameters, within which it is that.
const SAME_DIVISION: f64 = 1e-7;

/// Least area of the triangle at a corner of a cell, relative to the cell: less is a fold. Where a curved knuckle turns
/// along it from a column into a row, the angle of one cell is a little more than two right angles.
const FLATTEST: f64 = -0.3;

/// The points (u, v) of a patch and the displacements that are known.
struct Displacements<T> {
    divisions: [usize; 2],
    moved: Vec<Option<[T; 2]>>,
    /// The rows and columns on which all are known in the end, ascending.
    lines: [Vec<usize>; 2],
}

/// Displaces the net of a patch, whose edges have their divisions at `edges`, so that the lines are rows; `None` where
/// they cannot be.
pub(crate) fn conform<T: Real>(
    surface: &dyn Surface<T>,
    knuckles: &Knuckles,
    edges: &[Vec<T>; 4],
    uv: &mut [[T; 2]],
) -> Option<()> {
    let divisions = [edges[0].len() - 1, edges[3].len() - 1];
    let mut net = Displacements::new(divisions);
    // Knuckles of the patch's own stay.
    for (direction, stops) in knuckles.straight.iter().enumerate() {
        for at in stops {
            let sides = if direction == 0 { [0, 2] } else { [3, 1] };
            let [a, b] = sides.map(|k| division(&edges[k], *at));
            let row = a.filter(|a| b == Some(*a))?;
            (0..=divisions[1 - direction]).try_for_each(|across| {
                let (i, j) = if direction == 0 { (row, across) } else { (across, row) };
                net.set(i, j, [T::zero(); 2])
            })?;
            net.lines[direction].push(row);
        }
    }
    let planes = surface.inner_planes();
    for line in &knuckles.across {
        let way = way(line, edges, divisions)?;
        let place = |at: usize| uv[net.index(way[at].0, way[at].1)];
        let (from, to) = (place(0), place(way.len() - 1));
        let d = line.across(from, to);
        let plain = d.map(T::re);
        let steps = (way.len() - 1) as f64;
        let moves = (1..way.len() - 1).map(|at| {
            let here = place(at);
            let share = at as f64 / steps;
            let base = if line.turns() {
                [0, 1].map(|k| from[k] + (to[k] - from[k]) * share)
            } else {
                here
            };
            let s = line.distance(&planes, base.map(T::re), plain)?;
            let at_line = |s: T| [0, 1].map(|k| base[k] + d[k] * s);
            let s = rate_across(surface, at_line(T::from(s)), plain.map(T::from)) + s;
            let target = at_line(s);
            Some([0, 1].map(|k| target[k] - here[k]))
        });
        let moves: Vec<[T; 2]> = moves.collect::<Option<_>>()?;
        for (&(i, j), moved) in way[1..].iter().zip(moves) {
            net.set(i, j, moved)?;
        }
        net.add_lines(&way);
    }
    net.fill(uv);
    Some(())
}

/// True for a net without folds.
pub(crate) fn is_sound([nu, nv]: [usize; 2], uv: &[[f64; 2]]) -> bool {
    let cells = (0..nu).flat_map(|i| (0..nv).map(move |j| i * (nv + 1) + j));
    cells.map(|k| [k, k + nv + 1, k + nv + 2, k + 1]).all(|corners| {
        let at = |k: usize| uv[corners[k % 4]];
        let triangle = |k: usize| {
            let (a, b, c) = (at(k + 3), at(k), at(k + 1));
            (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
        };
        let area = triangle(0) + triangle(2);
        area > 0.0 && (0..4).all(|k| triangle(k) >= FLATTEST * area)
    })
}

/// The division of an edge at a parameter.
fn division<T: Real>(edge: &[T], at: f64) -> Option<usize> {
    edge.iter().position(|t| (t.re() - at).abs() < SAME_DIVISION)
}

/// The vertices of the net from the beginning of a line to its end.
fn way<T: Real>(
    line: &KnuckleLine,
    edges: &[Vec<T>; 4],
    [nu, nv]: [usize; 2],
) -> Option<Vec<(usize, usize)>> {
    let vertex = |(k, t): (u8, f64)| {
        let at = division(&edges[usize::from(k)], t)?;
        Some(match k {
            0 => (at, 0),
            1 => (nu, at),
            2 => (at, nv),
            _ => (0, at),
        })
    };
    let [first, last] = line.ends;
    let (a, b) = (vertex(first)?, vertex(last)?);
    // From an edge v = const the line leaves along v.
    let turn = if first.0 % 2 == 0 { (a.0, b.1) } else { (b.0, a.1) };
    let straight = |(i, j): (usize, usize), (k, l): (usize, usize)| {
        let steps = i.abs_diff(k) + j.abs_diff(l);
        let step = |x: usize, y: usize, s: usize| match y >= x {
            true => x + s.min(y - x),
            false => x - s.min(x - y),
        };
        (0..steps).map(move |s| (step(i, k, s), step(j, l, s)))
    };
    if !line.turns() && turn != b {
        return None;
    }
    let mut way: Vec<_> = straight(a, turn).chain(straight(turn, b)).collect();
    way.push(b);
    Some(way)
}

impl<T: Real> Displacements<T> {
    fn new([nu, nv]: [usize; 2]) -> Self {
        let border = |i: usize, j: usize| i == 0 || i == nu || j == 0 || j == nv;
        let nodes = (0..=nu).flat_map(|i| (0..=nv).map(move |j| (i, j)));
        let moved = nodes.map(|(i, j)| border(i, j).then_some([T::zero(); 2])).collect();
        Self { divisions: [nu, nv], moved, lines: [vec![0, nu], vec![0, nv]] }
    }

    fn index(&self, i: usize, j: usize) -> usize {
        i * (self.divisions[1] + 1) + j
    }

    /// Sets the displacement of a vertex; `None` where another one is known.
    fn set(&mut self, i: usize, j: usize, moved: [T; 2]) -> Option<()> {
        let [nu, nv] = self.divisions;
        let border = i == 0 || i == nu || j == 0 || j == nv;
        let at = self.index(i, j);
        if border {
            return Some(());
        }
        // A row of the patch's own and a line along v cross where neither is displaced along v.
        let same =
            |known: [T; 2]| (0..2).all(|k| known[k].re() == moved[k].re() || known[k].re() == 0.0);
        if self.moved[at].is_some_and(|known| !same(known)) {
            return None;
        }
        self.moved[at] = Some(moved);
        Some(())
    }

    /// The rows and columns of a way.
    fn add_lines(&mut self, way: &[(usize, usize)]) {
        for pair in way.windows(2) {
            let (direction, at) =
                if pair[0].0 == pair[1].0 { (0, pair[0].0) } else { (1, pair[0].1) };
            self.lines[direction].push(at);
        }
    }

    /// Displaces all points.
    fn fill(mut self, uv: &mut [[T; 2]]) {
        for lines in &mut self.lines {
            lines.sort_unstable();
            lines.dedup();
        }
        let [nu, nv] = self.divisions;
        for direction in 0..2 {
            for &line in &self.lines[direction].clone() {
                let count = [nv, nu][direction];
                let at = |k: usize| if direction == 0 { (line, k) } else { (k, line) };
                let along: Vec<usize> =
                    (0..=count).map(at).map(|(i, j)| self.index(i, j)).collect();
                self.fill_line(&along, uv, 1 - direction);
            }
        }
        let [rows, columns] = self.lines.clone();
        for i in rows.windows(2) {
            for j in columns.windows(2) {
                self.fill_block([i[0], i[1]], [j[0], j[1]], uv);
            }
        }
        for (place, moved) in uv.iter_mut().zip(&self.moved) {
            let Some(moved) = moved else { continue };
            for k in 0..2 {
                if !(moved[k].is_constant() && moved[k].re() == 0.0) {
                    place[k] += moved[k];
                }
            }
        }
    }

    /// The position of a point between two others along u or v.
    fn share(uv: &[[T; 2]], axis: usize, from: usize, at: usize, to: usize) -> T {
        (uv[at][axis] - uv[from][axis]) / (uv[to][axis] - uv[from][axis])
    }

    /// Fills a line between the vertices on it that are known.
    fn fill_line(&mut self, along: &[usize], uv: &[[T; 2]], axis: usize) {
        let known: Vec<usize> =
            (0..along.len()).filter(|&k| self.moved[along[k]].is_some()).collect();
        for pair in known.windows(2) {
            let (from, to) = (along[pair[0]], along[pair[1]]);
            let (Some(a), Some(b)) = (self.moved[from], self.moved[to]) else { continue };
            for &at in &along[pair[0] + 1..pair[1]] {
                let s = Self::share(uv, axis, from, at, to);
                self.moved[at] = Some([0, 1].map(|k| a[k] + (b[k] - a[k]) * s));
            }
        }
    }

    /// Fills a block within four lines (Coons 1967).
    fn fill_block(&mut self, [i0, i1]: [usize; 2], [j0, j1]: [usize; 2], uv: &[[T; 2]]) {
        let corner = |i: usize, j: usize| self.index(i, j);
        let (sw, se, ne, nw) = (corner(i0, j0), corner(i1, j0), corner(i1, j1), corner(i0, j1));
        for i in i0 + 1..i1 {
            for j in j0 + 1..j1 {
                let at = self.index(i, j);
                let (west, east) = (self.index(i0, j), self.index(i1, j));
                let (south, north) = (self.index(i, j0), self.index(i, j1));
                let x = Self::share(uv, 0, west, at, east);
                let y = Self::share(uv, 1, south, at, north);
                let of = |p: usize| self.moved[p].unwrap_or([T::zero(); 2]);
                let mix = |a: T, b: T, s: T| a + (b - a) * s;
                let moved = [0, 1].map(|k| {
                    let part = |p: usize| of(p)[k];
                    mix(part(west), part(east), x) + mix(part(south), part(north), y)
                        - mix(mix(part(sw), part(se), x), mix(part(nw), part(ne), x), y)
                });
                self.moved[at] = Some(moved);
            }
        }
    }
}
