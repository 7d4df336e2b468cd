//! Parts of a creased surface, at any angle to its creases: measures against sums over lines cut at the creases, and
//! derivatives against differences.

use crate::{BodyMeasures, surface_measures};
use moldloft_num::{Dual, InnerPlane, Jet, Real, SurfaceFormula, Vec3, find_root};
use moldloft_testing::{Random, rounds};

/// A sheet over the square with creases at u = a and v = b, of which a part is seen between four curved sides.
#[derive(Clone, Copy, Debug)]
struct CreasedPart<T> {
    crease: [T; 2],
    /// How steeply the sheet rises from its creases, and how much it is bent.
    rise: [T; 2],
    bent: T,
    /// The corners of the part, (0, 0), (1, 0), (0, 1), (1, 1), and how far its sides bulge.
    corners: [[T; 2]; 4],
    bulge: [T; 2],
}

/// A number for each field, by a map from another part's.
fn mapped<A: Copy, B>(part: &CreasedPart<A>, f: impl Fn(A) -> B + Copy) -> CreasedPart<B> {
    CreasedPart {
        crease: part.crease.map(f),
        rise: part.rise.map(f),
        bent: f(part.bent),
        corners: part.corners.map(|c| c.map(f)),
        bulge: part.bulge.map(f),
    }
}

impl<T: Real> CreasedPart<T> {
    fn inside<J: Jet<T>>(&self, s: J, t: J) -> [J; 2] {
        let [p, q, r, w] = self.corners;
        let across = |k: usize| {
            let low = (-s + 1.0).scaled(p[k]) + s.scaled(q[k]);
            let high = (-s + 1.0).scaled(r[k]) + s.scaled(w[k]);
            low * (-t + 1.0) + high * t
        };
        let hump = |x: J| x * (-x + 1.0);
        [across(0) + hump(t).scaled(self.bulge[0]), across(1) + hump(s).scaled(self.bulge[1])]
    }
}

impl<T: Real> SurfaceFormula for CreasedPart<T> {
    type Scalar = T;
    fn at<J: Jet<T>>(&self, s: J, t: J) -> Vec3<J> {
        let [u, v] = self.inside(s, t);
        let [a, b] = self.crease;
        let rise = Real::abs(u - J::fixed(a)).scaled(self.rise[0])
            + Real::abs(v - J::fixed(b)).scaled(self.rise[1]);
        Vec3::new(u, v, rise + (u * v * v).scaled(self.bent))
    }

    fn inner_planes(&self) -> Vec<InnerPlane<'_>> {
        let place = |[s, t]: [f64; 2]| self.inside(T::from(s), T::from(t)).map(|x| x.re());
        let lines = self.crease.map(|x| vec![x.re()]);
        vec![InnerPlane {
            place: Box::new(place),
            joints: lines.clone(),
            kinks: lines,
            closed: [false; 2],
        }]
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
}

fn part(random: &mut Random) -> CreasedPart<f64> {
    let mut near =
        |x: f64, y: f64| [x + random.between(-0.12, 0.12), y + random.between(-0.12, 0.12)];
    let mut corners = [near(0.2, 0.2), near(0.8, 0.2), near(0.2, 0.8), near(0.8, 0.8)];
    // Turned about the middle.
    let angle = random.between(-3.0, 3.0);
    let (c, s) = (angle.cos(), angle.sin());
    for p in &mut corners {
        let [x, y] = p.map(|x| x - 0.5);
        *p = [0.5 + c * x - s * y, 0.5 + s * x + c * y];
    }
    let mut two = |low: f64, high: f64| [random.between(low, high), random.between(low, high)];
    CreasedPart {
        crease: two(0.25, 0.75),
        rise: two(-0.6, 0.6),
        bent: two(-0.4, 0.4)[0],
        bulge: two(-0.25, 0.25),
        corners,
    }
}

/// The area by Gauss's rule along many lines of t, each cut where it meets a crease.
fn area_by_lines(part: &CreasedPart<f64>) -> f64 {
    const LINES: usize = 1600;
    let gauss = moldloft_num::gauss_rule(8);
    let mut sum = 0.0;
    for line in 0..LINES {
        for &(share, weight) in moldloft_num::gauss_rule(3) {
            let s = (line as f64 + share) / LINES as f64;
            let mut ends = vec![0.0, 1.0];
            for axis in 0..2 {
                let beyond = |t: f64| part.inside(s, t)[axis] - part.crease[axis];
                for k in 0..32 {
                    let (low, high) = (k as f64 / 32.0, (k + 1) as f64 / 32.0);
                    ends.extend(find_root(beyond, low, high).ok());
                }
            }
            ends.sort_by(f64::total_cmp);
            for w in ends.windows(2) {
                for &(x, y) in gauss {
                    let t = w[0] + (w[1] - w[0]) * x;
                    let jet = moldloft_num::Surface::jet(part, s, t, moldloft_num::Order::First);
                    let area = jet.u.cross(jet.v).norm();
                    sum += area * y * (w[1] - w[0]) * weight / LINES as f64;
                }
            }
        }
    }
    sum
}

fn measured<T: Real>(part: &CreasedPart<T>, accuracy: f64) -> BodyMeasures<T> {
    surface_measures(part, accuracy).expect("finite places")
}

#[test]
fn parts_across_creases_are_measured_to_the_accuracy() {
    let mut random = Random::new(41);
    for case in 0..rounds(40, 2000) {
        let part = part(&mut random);
        let right = area_by_lines(&part);
        for accuracy in [1e-4, 1e-6, 1e-8] {
            let found = measured(&part, accuracy);
            let off = (found.area - right).abs();
            // The lines' own error, where creases meet the border.
            assert!(off <= found.bounds[0] + 3e-7 * right, "{case} {off} {found:?}\n{part:?}");
            assert!(found.bounds[0] <= accuracy * right, "{case} {found:?}\n{part:?}");
        }
    }
}

#[test]
fn their_derivatives_are_those_of_differences() {
    let mut random = Random::new(42);
    for case in 0..rounds(12, 400) {
        let part = part(&mut random);
        // By the creases' places, the rises and a corner.
        type Change = fn(&mut CreasedPart<Dual<1>>, Dual<1>);
        let changes: [Change; 5] = [
            |p, h| p.crease[0] += h,
            |p, h| p.crease[1] += h,
            |p, h| p.rise[0] += h,
            |p, h| p.corners[3][0] += h,
            |p, h| p.bulge[1] += h,
        ];
        for (k, change) in changes.iter().enumerate() {
            let at = |h: Dual<1>| {
                let mut moved = mapped(&part, Dual::<1>::from);
                change(&mut moved, h);
                moved
            };
            let value = |h: f64, accuracy: f64| {
                let moved = mapped(&at(Dual::from(h)), |x| x.re);
                let found = measured(&moved, accuracy);
                [found.area, found.area_centre.z]
            };
            const STEP: f64 = 1e-3;
            let [far, near] = [2.0, 1.0].map(|n| {
                let (high, low) = (value(n * STEP, 1e-10), value(-n * STEP, 1e-10));
                [0, 1].map(|k| (high[k] - low[k]) / (2.0 * n * STEP))
            });
            let differences = [0, 1].map(|k| near[k] + (near[k] - far[k]) / 3.0);
            for accuracy in [1e-4, 1e-6, 1e-8] {
                let found = measured(&at(Dual::seeded(0.0, 0)), accuracy);
                let slopes = [found.area, found.area_centre.z].map(|x| x.eps[0]);
                for (slope, difference) in slopes.iter().zip(differences) {
                    let off = (slope - difference).abs();
                    let allowed = 1e-6 * (1.0 + difference.abs()) + accuracy;
                    assert!(
                        off <= allowed,
                        "{case} {k} {accuracy}: {slope} {difference}\n{part:?}"
                    );
                }
            }
        }
    }
}
