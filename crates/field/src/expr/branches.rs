//! Jumps of functions that are not faces of the body: the cut of `atan2` and the steps of
//! `remainder`.
//!
//! In a box across one jump a leaf is `f1` on one side of it and `f2` on the other, both smooth:
//! the body there is `(c & f1) | (-c & f2)` with an expression `c` that is zero at the jump. A jump
//! with the same body on both sides is then not a face.

use crate::expr::algebra::Unary;
use crate::expr::interval::Interval;
use crate::expr::tape::{ExprInstruction, ExprTape, NO_LEAF};
use std::f64::consts::PI;

/// A jump in a box: the instruction, and its replacements on both sides.
enum FieldJump {
    /// The angle of (x, y) across y = 0, x < 0, from above and from below.
    Cut { y: u32, x: u32 },
    /// x - n y and x - (n + 1) y, which meet where the second is zero.
    Step { x: u32, y: u32, turns: f64, falling: bool },
}

impl ExprTape<f64> {
    /// True when it holds functions that jump.
    pub(crate) fn has_jumps(&self) -> bool {
        let jumps = |c: &ExprInstruction<f64>| {
            matches!(c, ExprInstruction::Atan2(..) | ExprInstruction::Mod(..))
        };
        self.code.iter().any(jumps)
    }

    /// The first jump inside a leaf, with its index among the instructions.
    fn jump(&self, ranges: &[Interval]) -> Option<(usize, FieldJump)> {
        let of = |k: u32| ranges[k as usize];
        self.code.iter().enumerate().find_map(|(k, code)| match *code {
            ExprInstruction::Atan2(y, x) => {
                let across = of(y).contains(0.0) && of(x).high < 0.0;
                across.then_some((k, FieldJump::Cut { y, x }))
            }
            ExprInstruction::Mod(x, y) => {
                if of(y).contains(0.0) || of(x).turns(of(y)).is_some() {
                    return None;
                }
                let ratio = of(x) * of(y).reciprocal();
                let (low, high) = (ratio.low.floor(), ratio.high.floor());
                let two = high - low == 1.0;
                let falling = of(y).high < 0.0;
                two.then_some((k, FieldJump::Step { x, y, turns: low, falling }))
            }
            _ => None,
        })
    }

    /// The tape with the first jump in a box replaced by its two sides, given the range of every
    /// instruction there; `None` without a jump, or if the box contains several.
    pub(crate) fn parted(&self, ranges: &[Interval]) -> Option<Self> {
        let (at, jump) = self.jump(ranges)?;
        let mut code: Vec<ExprInstruction<f64>> = Vec::with_capacity(2 * self.code.len() + 8);
        let mut leaf: Vec<u32> = Vec::with_capacity(code.capacity());
        let mut push = |instruction: ExprInstruction<f64>, of: u32| {
            code.push(instruction);
            leaf.push(of);
            code.len() as u32 - 1
        };
        // New index of each instruction on the first side and on the second.
        let mut places: Vec<[u32; 2]> = Vec::with_capacity(self.code.len());
        // Expression that is zero at the jump, and whether it is negative on the first side.
        let (mut place, mut below) = (0u32, false);
        for (k, instruction) in self.code.iter().enumerate() {
            let own = self.leaf[k];
            if k == at {
                let both = match jump {
                    FieldJump::Cut { y, x } => {
                        let [y, x] = [y, x].map(|k| places[k as usize][0]);
                        let minus =
                            [y, x].map(|k| push(ExprInstruction::Unary(Unary::Neg, k), NO_LEAF));
                        let angle = push(ExprInstruction::Atan2(minus[0], minus[1]), NO_LEAF);
                        (place, below) = (y, false);
                        [PI, -PI].map(|turn| push(ExprInstruction::PlusReal(angle, turn), NO_LEAF))
                    }
                    FieldJump::Step { x, y, turns, falling } => {
                        let [x, y] = [x, y].map(|k| places[k as usize][0]);
                        let rest = [turns, turns + 1.0].map(|n| {
                            let less = push(ExprInstruction::TimesReal(y, n), NO_LEAF);
                            push(ExprInstruction::Sub(x, less), NO_LEAF)
                        });
                        (place, below) = (rest[1], !falling);
                        rest
                    }
                };
                places.push(both);
            } else {
                let moved = |side: usize| instruction.renumbered(|k| places[k as usize][side]);
                let apart = instruction
                    .operands()
                    .into_iter()
                    .flatten()
                    .any(|k| places[k as usize][0] != places[k as usize][1]);
                let first = push(moved(0), own);
                let second = if apart { push(moved(1), own) } else { first };
                places.push([first, second]);
            }
            // A leaf on which the sides differ is joined of both.
            let [first, second] = places[k];
            if own != NO_LEAF && first != second {
                // The jump counts as a face of the leaf; a copy is for uses inside.
                let face = push(ExprInstruction::PlusReal(place, 0.0), own);
                let minus = push(ExprInstruction::Unary(Unary::Neg, face), own);
                let faces = if below { [face, minus] } else { [minus, face] };
                let parts = [0, 1]
                    .map(|k| push(ExprInstruction::Common(faces[k], [first, second][k]), NO_LEAF));
                let joined = push(ExprInstruction::Union(parts[0], parts[1]), NO_LEAF);
                places[k] = [joined; 2];
            }
        }
        Some(self.with_code(code, leaf))
    }
}

#[cfg(test)]
mod tests {
    use crate::Primitive;
    use crate::Set;
    use crate::expr::interval::sides;
    use moldloft_num::{Box3, Vec3};

    #[test]
    fn a_parted_tape_is_the_same_set() {
        let [x, y, z] = Primitive::<f64>::axes();
        let turn = y.atan2(&x);
        let teeth = z.remainder(&Primitive::real(0.7)).unwrap();
        let back = z.remainder(&Primitive::real(-0.7)).unwrap();
        let fields = [
            &turn - &z,
            (&turn - &z).remainder(&Primitive::real(std::f64::consts::TAU)).unwrap() - 3.0,
            &teeth - 0.3,
            &back + 0.3,
            (&x + 1.2) - &turn * 0.01,
        ];
        let mut random = moldloft_testing::Random::new(5);
        let mut parted = 0;
        for f in fields {
            let set = Set::new(&f) & Set::new(&(&x - 9.0));
            let tape = set.compiled().tape;
            for _ in 0..300 {
                let low = Vec3::of(
                    random.between(-2.0, 1.0),
                    random.between(-0.4, 0.1),
                    random.between(-2.0, 2.0),
                );
                let over = Box3 { low, high: low + Vec3::of(0.3, 0.3, 0.3) };
                let mut ranges = Vec::new();
                tape.range(&sides(&over), &mut ranges);
                let Some(other) = tape.parted(&ranges) else { continue };
                parted += 1;
                for _ in 0..20 {
                    let p =
                        Vec3::from([0, 1, 2].map(|k| random.between(over.low[k], over.high[k])));
                    let [a, b] = [&*tape, &other].map(|t| t.eval::<f64>(&p, &mut Vec::new()));
                    assert_eq!(a < 0.0, b < 0.0, "{a} {b} at {p:?}");
                }
            }
        }
        assert!(parted > 50, "{parted}");
    }
}
