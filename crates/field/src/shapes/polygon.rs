//! The inside of a polygon as a formula of half-planes, one for each side, so that its sides are faces and its corners
//! edges of bodies.
//!
//! D. Dobkin, L. Guibas, J. Hershberger, J. Snoeyink, An efficient algorithm for finding the CSG
//! representation of a simple polygon, Computer Graphics 22 (1988): a chain between two rays is cut
//! at a corner whose extended sides do not meet the rest of the chain; at a convex corner the
//! result is the intersection of both parts, otherwise the union. A polygon is two chains between
//! its first and its last corner.

type FlatPoint = [f64; 2];

/// A formula of sides by their numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SideFormula {
    /// The left side of the side with this number.
    Side(usize),
    /// Intersection.
    All(Vec<SideFormula>),
    /// Union.
    Any(Vec<SideFormula>),
}

/// The inside of a polygon as a formula of its sides; side k is from corner k to the next. `None`
/// for a polygon that intersects or touches itself.
pub(crate) fn sides_of(corners: &[FlatPoint]) -> Option<SideFormula> {
    let n = corners.len();
    if n < 3 || turn_sum(corners) == 0.0 || !is_simple(corners) {
        return None;
    }
    if turn_sum(corners) < 0.0 {
        // In reverse order; side k is then the one before corner n - 1 - k.
        let back: Vec<FlatPoint> = corners.iter().rev().copied().collect();
        return Some(renumbered(sides_of(&back)?, &|k| (2 * n - 2 - k) % n));
    }
    let lower = |a: &usize, b: &usize| {
        let ([ax, ay], [bx, by]) = (corners[*a], corners[*b]);
        ax.total_cmp(&bx).then(ay.total_cmp(&by))
    };
    let first = (0..n).min_by(lower)?;
    let last = (0..n).max_by(lower)?;
    let chain = |from: usize, to: usize| {
        let count = (to + n - from) % n;
        let sides: Vec<usize> = (0..count).map(|k| (from + k) % n).collect();
        SideChain { corners, sides: &sides }.formula()
    };
    let both = [chain(first, last)?, chain(last, first)?];
    Some(SideFormula::All(both.into_iter().flat_map(in_all).collect()))
}

/// True if sides meet only at the corner between neighbours.
fn is_simple(corners: &[FlatPoint]) -> bool {
    let n = corners.len();
    let side = |k: usize| [corners[k], corners[(k + 1) % n]];
    let on = |[p, q]: [FlatPoint; 2], at: FlatPoint| {
        let along = [q[0] - p[0], q[1] - p[1]];
        let away = [at[0] - p[0], at[1] - p[1]];
        let t = along[0] * away[0] + along[1] * away[1];
        cross(p, q, at) == 0.0 && t >= 0.0 && t <= along[0] * along[0] + along[1] * along[1]
    };
    let meet = |a: [FlatPoint; 2], b: [FlatPoint; 2]| {
        let sides = [cross(a[0], a[1], b[0]), cross(a[0], a[1], b[1])];
        let others = [cross(b[0], b[1], a[0]), cross(b[0], b[1], a[1])];
        let apart = |[x, y]: [f64; 2]| (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0);
        let through = !apart(sides) && !apart(others) && sides != [0.0; 2];
        through || on(a, b[0]) || on(a, b[1]) || on(b, a[0]) || on(b, a[1])
    };
    (0..n).all(|j| {
        let next = side((j + 1) % n);
        // Neighbours: the second must not overlap the first.
        !(on(side(j), next[1]) || on(next, side(j)[0]))
            && (j + 2..n).filter(|k| (k + 1) % n != j).all(|k| !meet(side(j), side(k)))
    })
}

fn turn_sum(p: &[FlatPoint]) -> f64 {
    let n = p.len();
    let [x, y] = p[0];
    let at = |k: usize| [p[k % n][0] - x, p[k % n][1] - y];
    (0..n).map(|k| (at(k), at(k + 1))).map(|([a, b], [c, d])| a * d - b * c).sum()
}

fn renumbered(of: SideFormula, by: &dyn Fn(usize) -> usize) -> SideFormula {
    let each = |all: Vec<SideFormula>| all.into_iter().map(|f| renumbered(f, by)).collect();
    match of {
        SideFormula::Side(k) => SideFormula::Side(by(k)),
        SideFormula::All(all) => SideFormula::All(each(all)),
        SideFormula::Any(all) => SideFormula::Any(each(all)),
    }
}

fn in_all(of: SideFormula) -> Vec<SideFormula> {
    match of {
        SideFormula::All(all) => all,
        other => vec![other],
    }
}

fn in_any(of: SideFormula) -> Vec<SideFormula> {
    match of {
        SideFormula::Any(all) => all,
        other => vec![other],
    }
}

/// Consecutive sides; the first comes from infinity and the last extends to it.
struct SideChain<'a> {
    corners: &'a [FlatPoint],
    sides: &'a [usize],
}

fn cross(o: FlatPoint, a: FlatPoint, b: FlatPoint) -> f64 {
    (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
}

impl SideChain<'_> {
    fn ends(&self, side: usize) -> [FlatPoint; 2] {
        let n = self.corners.len();
        [self.corners[side], self.corners[(side + 1) % n]]
    }

    fn formula(&self) -> Option<SideFormula> {
        let count = self.sides.len();
        if count <= 1 {
            return self.sides.first().map(|k| SideFormula::Side(*k));
        }
        // From the middle outwards, for few levels.
        let mut cuts: Vec<usize> = (1..count).collect();
        cuts.sort_by_key(|k| (2 * k).abs_diff(count));
        let at = cuts.into_iter().find(|k| self.is_free(*k))?;
        let part = |sides: &[usize]| SideChain { corners: self.corners, sides }.formula();
        let both = [part(&self.sides[..at])?, part(&self.sides[at..])?];
        let ([a, v], [_, b]) = (self.ends(self.sides[at - 1]), self.ends(self.sides[at]));
        Some(match cross(a, v, b) >= 0.0 {
            true => SideFormula::All(both.into_iter().flat_map(in_all).collect()),
            false => SideFormula::Any(both.into_iter().flat_map(in_any).collect()),
        })
    }

    /// True if the sides before and behind corner `at`, extended beyond it, do not meet the rest of
    /// the chain.
    fn is_free(&self, at: usize) -> bool {
        let ([a, v], [_, b]) = (self.ends(self.sides[at - 1]), self.ends(self.sides[at]));
        let ahead = [v[0] - a[0], v[1] - a[1]];
        let back = [v[0] - b[0], v[1] - b[1]];
        let last = self.sides.len() - 1;
        let apart = |k: usize, along: FlatPoint| {
            let [p, q] = self.ends(self.sides[k]);
            let own = [q[0] - p[0], q[1] - p[1]];
            // The side as p + t (q - p) with t from `low` to `high`.
            let low = if k == 0 { f64::NEG_INFINITY } else { 0.0 };
            let high = if k == last { f64::INFINITY } else { 1.0 };
            let det = along[0] * own[1] - along[1] * own[0];
            let away = [p[0] - v[0], p[1] - v[1]];
            let size =
                (along[0] * along[0] + along[1] * along[1]) * (own[0] * own[0] + own[1] * own[1]);
            if det * det <= 1e-24 * size {
                // Parallel: it must not be on the ray.
                let beside = away[0] * along[1] - away[1] * along[0];
                let other = [q[0] - v[0], q[1] - v[1]];
                let ahead = |w: FlatPoint| w[0] * along[0] + w[1] * along[1];
                let square = along[0] * along[0] + along[1] * along[1];
                let far = away[0] * away[0] + away[1] * away[1];
                let on = beside * beside <= 1e-24 * square * (far + square);
                let runs = own[0] * along[0] + own[1] * along[1];
                let beyond = (k == 0 && runs < 0.0) || (k == last && runs > 0.0);
                return !on || (ahead(away) <= 0.0 && ahead(other) <= 0.0 && !beyond);
            }
            let t = (away[0] * along[1] - away[1] * along[0]) / det;
            let s = (away[0] * own[1] - away[1] * own[0]) / det;
            t < low - 1e-12 || t > high + 1e-12 || s < -1e-12
        };
        // The sides at the corner itself meet the rays there alone.
        (0..=last).filter(|k| *k + 1 != at && *k != at).all(|k| apart(k, ahead) && apart(k, back))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holds(of: &SideFormula, corners: &[FlatPoint], p: FlatPoint) -> bool {
        match of {
            SideFormula::Side(k) => cross(corners[*k], corners[(k + 1) % corners.len()], p) > 0.0,
            SideFormula::All(all) => all.iter().all(|f| holds(f, corners, p)),
            SideFormula::Any(all) => all.iter().any(|f| holds(f, corners, p)),
        }
    }

    fn count(of: &SideFormula, seen: &mut Vec<usize>) {
        match of {
            SideFormula::Side(k) => seen.push(*k),
            SideFormula::All(all) | SideFormula::Any(all) => {
                all.iter().for_each(|f| count(f, seen));
            }
        }
    }

    fn inside(corners: &[FlatPoint], [x, y]: FlatPoint) -> bool {
        let n = corners.len();
        let crosses = |k: &usize| {
            let ([a, b], [c, d]) = (corners[*k], corners[(*k + 1) % n]);
            (b > y) != (d > y) && x < a + (y - b) / (d - b) * (c - a)
        };
        (0..n).filter(crosses).count() % 2 == 1
    }

    fn check(corners: &[FlatPoint], random: &mut moldloft_testing::Random) {
        let formula = sides_of(corners).unwrap_or_else(|| panic!("{corners:?}"));
        let mut seen = Vec::new();
        count(&formula, &mut seen);
        seen.sort_unstable();
        assert_eq!(seen, (0..corners.len()).collect::<Vec<_>>());
        let ccw = turn_sum(corners) > 0.0;
        for _ in 0..300 {
            let p = [random.between(-4.0, 4.0), random.between(-4.0, 4.0)];
            // Left is inside of one that runs counter-clockwise.
            let own = if ccw {
                holds(&formula, corners, p)
            } else {
                let back: Vec<FlatPoint> = corners.iter().rev().copied().collect();
                let n = corners.len();
                holds(&renumbered(formula.clone(), &|k| (2 * n - 2 - k) % n), &back, p)
            };
            assert_eq!(own, inside(corners, p), "{corners:?} at {p:?}: {formula:?}");
        }
    }

    #[test]
    fn each_side_stands_once_and_the_inside_is_that_of_a_ray() {
        let mut random = moldloft_testing::Random::new(11);
        for round in 0..400 {
            // A star, a comb, a spiral or a staircase, in either orientation.
            let mut corners: Vec<FlatPoint> = match round % 4 {
                0 => {
                    let n = 3 + random.below(40);
                    (0..n)
                        .map(|k| {
                            let a = (k as f64 + random.between(0.0, 0.8)) / n as f64
                                * std::f64::consts::TAU;
                            let r = random.between(0.3, 3.0);
                            [r * a.cos(), r * a.sin()]
                        })
                        .collect()
                }
                1 => {
                    let n = 1 + random.below(8);
                    let mut all = vec![[-3.0, -3.0], [3.0, -3.0]];
                    for k in 0..2 * n {
                        let x = 3.0 - 6.0 * (k as f64 + 0.5) / (2 * n) as f64;
                        all.push([
                            x,
                            if k % 2 == 0 {
                                random.between(1.0, 3.0)
                            } else {
                                random.between(-2.5, 0.0)
                            },
                        ]);
                    }
                    all
                }
                2 => {
                    let n = 6 + random.below(30);
                    let at = |k: usize, r: f64| {
                        let a = k as f64 * 0.5;
                        let r = r + 0.15 * a / std::f64::consts::TAU * 3.0;
                        [r * a.cos(), r * a.sin()]
                    };
                    let out = (0..n).map(|k| at(k, 0.55));
                    out.chain((0..n).rev().map(|k| at(k, 0.3))).collect()
                }
                _ => {
                    let n = 2 + random.below(6);
                    let mut all = vec![[-3.0, -3.0]];
                    for k in 0..n {
                        let (x, y) = (3.0 - k as f64 * 0.5, -3.0 + (k + 1) as f64 * 0.5);
                        all.extend([[x, y - 0.5], [x, y]]);
                    }
                    all.push([-3.0, -3.0 + n as f64 * 0.5]);
                    all
                }
            };
            if random.chance(50) {
                corners.reverse();
            }
            let start = random.below(corners.len());
            corners.rotate_left(start);
            check(&corners, &mut random);
        }
    }

    #[test]
    fn what_crosses_or_touches_itself_has_none() {
        assert_eq!(sides_of(&[[0.0, 0.0], [1.0, 0.0]]), None);
        assert_eq!(sides_of(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), None);
        assert_eq!(sides_of(&[[0.0, 0.0], [2.0, 0.0], [0.0, 1.0], [2.0, 2.0]]), None);
        // A corner on another side; a side that reverses.
        assert_eq!(sides_of(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]]), None);
        assert_eq!(sides_of(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 2.0]]), None);
    }
}
