//! Solids by transfinite blending of six faces.

use super::layers::on;
use moldloft_num::trace::{Faces, Turn};
use moldloft_num::{Box3, Jet, Order, Real, SolidFormula, Vec3};
use moldloft_registry::{Build, CallError, Context, FieldId, Kind, SolidRef, SurfaceRef, Value};

/// A solid between six faces u = 0, u = 1, v = 0, v = 1, w = 0, w = 1: their transfinite blend, the three
/// ruled solids less the three of edges plus that of the corners (Gordon and Hall 1973).
///
/// The parameters of a face are the solid's other two, in order: (v, w), (u, w), (u, v). A surface
/// of another orientation has a number in `turns`: 1 if its u is the second of the two, plus 2 if
/// its u and plus 4 if its v is opposite to the solid's. Faces must meet along the twelve edges.
#[derive(Kind)]
#[kind(
    class = Solid,
    columns = "surfaces",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0); \
               AbsPoint E(0, 0, 2); AbsPoint F(2, 0, 3); AbsPoint G(0, 2, 2); AbsPoint H(2.5, 2, 2); \
               AbsPoint M(1, -0.5, 0); BCurve ab({A, M, B}, 2); Line cd(C, D); Line ef(E, F); Line gh(G, H); \
               Line ac(A, C); Line bd(B, D); Line eg(E, G); Line fh(F, H); Line ae(A, E); Line bf(B, F); \
               Line cg(C, G); Line dh(D, H); BlendSurf west({ac, cg, eg, ae}); \
               BlendSurf east({bf, fh, dh, bd}); BlendSurf south({ab, bf, ef, ae}); \
               BlendSurf north({cd, dh, gh, cg}); BlendSurf low({ab, bd, cd, ac}); \
               BlendSurf high({ef, fh, gh, eg}); \
               BlendSolid S({west, east, south, north, low, high}, turns = {0, 1, 0, 0, 0, 0});"
)]
pub struct BlendSolid<T: Real> {
    /// The six faces u = 0, u = 1, v = 0, v = 1, w = 0, w = 1.
    #[field(min_items = 6)]
    surfaces: Vec<SurfaceRef<T>>,
    /// Orientation of each surface, 0 to 7; default: all 0.
    turns: Option<Vec<usize>>,
}

impl<T: Real> Build<T> for BlendSolid<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let six = |found: usize, what: &str, field: FieldId| {
            CallError::new(
                "wrong-length",
                format!("a solid has 6 faces, but here are {found} {what}"),
            )
            .expected(format!("6 {what}"))
            .found(found.to_string())
            .in_field(field)
        };
        let surfaces: [SurfaceRef<T>; 6] = self
            .surfaces
            .try_into()
            .map_err(|s: Vec<_>| six(s.len(), "surfaces", Self::SURFACES))?;
        let given = self.turns.unwrap_or_else(|| vec![0; 6]);
        let given: [usize; 6] =
            given.try_into().map_err(|t: Vec<_>| six(t.len(), "turns", Self::TURNS))?;
        if let Some(k) = given.iter().position(|&t| t > 7) {
            return Err(CallError::new("out-of-range", format!("no turn {}", given[k]))
                .expected("a number from 0 to 7")
                .found(given[k].to_string())
                .in_item(k)
                .in_field(Self::TURNS));
        }
        let solid = CoonsSolid { surfaces, turns: given.map(|t| Turn(t as u8)) };
        solid.check()?;
        Ok(Value::Solid(SolidRef::new(solid, context.nesting)))
    }
}

struct CoonsSolid<T: Real> {
    surfaces: [SurfaceRef<T>; 6],
    turns: [Turn; 6],
}

/// The other two axes of `axis`.
const fn others(axis: usize) -> [usize; 2] {
    match axis {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    }
}

/// Maximum distance between edges at a common edge, relative to the size of the solid.
const MEETING: f64 = 1e-9;

/// The parameters at which edges are compared.
const TRIALS: [f64; 9] = [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];

impl<T: Real> CoonsSolid<T> {
    /// The position on face 0..6, in its orientation, at two of the three parameters.
    fn turned<J: Jet<T>>(&self, face: usize, turn: Turn, at: [J; 3]) -> Vec3<J> {
        let [a, b] = others(face / 2);
        let [u, v] = turn.place(at[a], at[b]);
        self.surfaces[face].at(u, v)
    }

    fn face<J: Jet<T>>(&self, face: usize, at: [J; 3]) -> Vec3<J> {
        self.turned(face, self.turns[face], at)
    }

    /// The largest distance between two faces, in their orientations, along their common edge.
    fn gap(&self, [a, b]: [usize; 2], [s, t]: [Turn; 2]) -> (f64, [f64; 3]) {
        let along = 3 - a / 2 - b / 2;
        let mut worst = (0.0, [0.0; 3]);
        for x in TRIALS {
            let mut at = [T::zero(); 3];
            at[a / 2] = T::from((a % 2) as f64);
            at[b / 2] = T::from((b % 2) as f64);
            at[along] = T::from(x);
            let (p, q) = (self.turned(a, s, at).re(), self.turned(b, t, at).re());
            let gap = p.distance(q);
            if gap > worst.0 || gap.is_nan() {
                worst = (gap, at.map(|x| x.re()));
            }
        }
        worst
    }

    fn check(&self) -> Result<(), CallError> {
        let corner = |c: usize| {
            let at = [0, 1, 2].map(|axis| T::from((c >> axis & 1) as f64));
            [4 + (c >> 2), 2 + (c >> 1 & 1)].map(|face| self.face(face, at).re())
        };
        let tolerance = MEETING * Box3::around((0..8).flat_map(corner)).diagonal();
        let pairs = (0..6).flat_map(|a| (a + 1..6).map(move |b| [a, b]));
        let mut worst = (0.0, [0; 2], [0.0; 3]);
        for pair in pairs.filter(|[a, b]| a / 2 != b / 2) {
            let (gap, at) = self.gap(pair, pair.map(|k| self.turns[k]));
            if gap > tolerance && gap > worst.0 || gap.is_nan() {
                worst = (gap, pair, at);
            }
        }
        let (gap, [a, b], [u, v, w]) = worst;
        if gap == 0.0 {
            return Ok(());
        }
        let name = |face: usize| format!("{} = {}", ["u", "v", "w"][face / 2], face % 2);
        let message = format!("the faces {} and {} do not meet", name(a), name(b));
        let fault = CallError::new("open-edge", message)
            .expected("faces that meet along all edges")
            .found(format!("a gap of {gap:.3e} at (u, v, w) = ({u}, {v}, {w})"))
            .related(self.surfaces[a].key, "is the one face")
            .related(self.surfaces[b].key, "is the other")
            .in_item(b)
            .in_field(BlendSolid::<T>::SURFACES);
        let mut turns = Vec::new();
        Err(if self.search(&mut turns, tolerance) {
            let list: Vec<String> = turns.iter().map(|t| t.0.to_string()).collect();
            fault.help(format!("they do with turns = {{{}}}", list.join(", ")))
        } else {
            fault.help("let neighbouring faces have common edges")
        })
    }

    /// Turns with which all faces meet, beginning with those chosen already.
    fn search(&self, turns: &mut Vec<Turn>, tolerance: f64) -> bool {
        let face = turns.len();
        if face == 6 {
            return true;
        }
        for turn in Turn::ALL {
            let before = (0..face).filter(|k| k / 2 != face / 2);
            let mut gaps = before.map(|k| self.gap([k, face], [turns[k], turn]).0);
            if gaps.all(|gap| gap <= tolerance) {
                turns.push(turn);
                if self.search(turns, tolerance) {
                    return true;
                }
                turns.pop();
            }
        }
        false
    }
}

/// The linear weights of the low and the high side.
fn shares<J: Real>(t: J) -> [J; 2] {
    [-t + 1.0, t]
}

impl<T: Real> SolidFormula for CoonsSolid<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, u: J, v: J, w: J) -> Vec3<J> {
        let at = [u, v, w];
        let share = at.map(shares);
        let ends = [J::zero(), J::one()];
        let mut sum = Vec3::zero();
        for face in 0..6 {
            sum += self.face(face, at) * share[face / 2][face % 2];
        }
        // The edges along each axis, as the faces of the first other axis have them.
        for axis in 0..3 {
            let [p, q] = others(axis);
            for (a, b) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let mut there = at;
                (there[p], there[q]) = (ends[a], ends[b]);
                sum += self.face(2 * p + a, there) * -(share[p][a] * share[q][b]);
            }
        }
        for c in 0..8 {
            let bit = |axis: usize| c >> axis & 1;
            let corner = self.face(4 + bit(2), [ends[bit(0)], ends[bit(1)], ends[bit(2)]]);
            sum += corner * (share[0][bit(0)] * share[1][bit(1)] * share[2][bit(2)]);
        }
        sum
    }

    fn grid(&self, us: &[f64], vs: &[f64], ws: &[f64], points: &mut [Vec3<T>]) {
        // Each face once on its own grid; edges and corners are at its rim.
        let grids = [us, vs, ws];
        let with_ends: Vec<Vec<f64>> =
            grids.iter().map(|g| g.iter().copied().chain([0.0, 1.0]).collect()).collect();
        let tables: Vec<Vec<Vec3<T>>> = (0..6)
            .map(|face| {
                let [a, b] = others(face / 2);
                let mut table = Vec::with_capacity(with_ends[a].len() * with_ends[b].len());
                for &s in &with_ends[a] {
                    for &t in &with_ends[b] {
                        let [u, v] = self.turns[face].place(s, t);
                        table.push(self.surfaces[face].jet(u.into(), v.into(), Order::Zero).p);
                    }
                }
                table
            })
            .collect();
        let counts = grids.map(<[f64]>::len);
        let on = |face: usize, at: [usize; 3]| {
            let [a, b] = others(face / 2);
            tables[face][at[a] * (counts[b] + 2) + at[b]]
        };
        let share: Vec<Vec<[T; 2]>> =
            grids.iter().map(|g| g.iter().map(|&t| shares(T::from(t))).collect()).collect();
        let mut out = points.iter_mut();
        for i in 0..counts[0] {
            for j in 0..counts[1] {
                for k in 0..counts[2] {
                    let at = [i, j, k];
                    let share = [share[0][i], share[1][j], share[2][k]];
                    let end = |axis: usize, side: usize| counts[axis] + side;
                    let mut sum = Vec3::zero();
                    for face in 0..6 {
                        sum += on(face, at) * share[face / 2][face % 2];
                    }
                    for axis in 0..3 {
                        let [p, q] = others(axis);
                        for (a, b) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                            let mut there = at;
                            (there[p], there[q]) = (end(p, a), end(q, b));
                            sum += on(2 * p + a, there) * -(share[p][a] * share[q][b]);
                        }
                    }
                    for c in 0..8 {
                        let bit = |axis: usize| c >> axis & 1;
                        let there = [0, 1, 2].map(|axis| end(axis, bit(axis)));
                        let weight = share[0][bit(0)] * share[1][bit(1)] * share[2][bit(2)];
                        sum += on(4 + bit(2), there) * weight;
                    }
                    if let Some(x) = out.next() {
                        *x = sum;
                    }
                }
            }
        }
    }

    fn faces(&self) -> Faces<T> {
        let mut faces = Faces::own();
        for (k, face) in faces.faces.iter_mut().enumerate() {
            *face = on(&self.surfaces[k], self.turns[k]);
        }
        faces
    }
}
