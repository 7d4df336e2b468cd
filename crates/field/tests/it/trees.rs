//! Random trees of primitives and set operators: whatever they are, their facets are sound.
//!
//! `MOLDLOFT_SOAK` makes the number 10 000.

use crate::common::{axis, cube, facets, sound, v};
use moldloft_field::{Affine, Primitive, Set, bracket, crossing_faces};
use moldloft_num::Vec3;
use moldloft_testing::{Random, rounds};

struct Trees(Random);

impl Trees {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.between(low, high)
    }
    fn below(&mut self, n: usize) -> usize {
        self.0.below(n)
    }
    fn point(&mut self) -> Vec3 {
        v(self.between(-0.7, 0.7), self.between(-0.7, 0.7), self.between(-0.7, 0.7))
    }
    fn direction(&mut self) -> Vec3 {
        self.point() + v(0.01, 0.02, 0.9)
    }

    fn leaf(&mut self) -> Set {
        let at = self.point();
        let a = axis(at, self.direction());
        let r = self.between(0.3, 0.8);
        let primitive = match self.below(6) {
            0 => Primitive::sphere(at, r),
            1 => Primitive::cylinder(a, 0.8 * r),
            2 => Primitive::cone(a, r),
            3 => Primitive::torus(a, r, 0.4 * r),
            4 => Primitive::plane(a.direction, at),
            _ => {
                let low = v(-r, -0.8 * r, -0.6 * r);
                let turn = Affine::rotation(&a, self.between(0.0, 3.0));
                return Set::cuboid(low, -low).unwrap().mapped(&turn).unwrap();
            }
        };
        Set::new(&primitive.unwrap())
    }

    fn tree(&mut self, leaves: usize) -> Set {
        if leaves == 1 {
            return self.leaf();
        }
        let left = 1 + self.below(leaves - 1);
        let (a, b) = (self.tree(left), self.tree(leaves - left));
        match self.below(4) {
            0 => a | b,
            1 => a & b,
            2 => a - b,
            _ => a ^ b,
        }
    }
}

#[test]
fn random_trees_are_closed_manifold_and_oriented() {
    // Edges and corners thinner than a cell are cut off: where several pass through one, and along lines where
    // surfaces meet at a small angle. Their share falls as the cells do, so every tenth tree has finer ones.
    let (mut cells, mut undecided, mut blunt) = ([0; 2], [0; 2], [0; 2]);
    for seed in 0..rounds(30, 10_000) as u64 {
        let fine = usize::from(seed % 10 == 0);
        let depth = [5, 7][fine];
        let mut random = Trees(Random::new(seed * 7919 + 1));
        let leaves = 1 + random.below(6);
        let set = random.tree(leaves);
        let f = facets(&set, &cube(1.2), depth);
        if f.mesh.faces().is_empty() {
            continue;
        }
        sound(&f);
        let (volume, best) = (bracket(&set, &cube(1.2), 5).unwrap().volume(), f.moments().volume());
        // Facets miss features thinner than a cell: up to the volume of a cell for each blunt one.
        let wrong = f.undecided.len() + f.blunt.len();
        let slack = f.step.powi(3) * (1.0 + wrong as f64);
        assert!(
            volume.low - slack <= best && best <= volume.high + slack,
            "seed {seed}: {best} not in {volume:?}"
        );
        for pair in crossing_faces(&f.mesh, None) {
            let near = |face: usize| {
                let corner = f.mesh.positions()[f.mesh.faces()[face][0] as usize];
                let close = |c: Vec3| (0..3).all(|k| (c[k] - corner[k]).abs() < 5.0 * f.step);
                f.undecided.iter().any(|b| close(b.centre()))
            };
            assert!(pair.into_iter().any(near), "seed {seed}: faces {pair:?} cut each other");
        }
        cells[fine] += f.cells;
        undecided[fine] += f.undecided.len();
        blunt[fine] += f.blunt.len();
    }
    let [coarse, fine] = [0, 1].map(|k| undecided[k] as f64 / cells[k] as f64);
    let [coarse_blunt, fine_blunt] = [0, 1].map(|k| blunt[k] as f64 / cells[k] as f64);
    println!("undecided: {undecided:?} of {cells:?} cells, {coarse:.2e} and {fine:.2e}");
    println!("blunt: {blunt:?}, {coarse_blunt:.2e} and {fine_blunt:.2e}");
    assert!(coarse < 1e-3 && fine < 1e-3, "{coarse} {fine}");
    // Over 10 000 trees: 3.4e-3 and 6.3e-4.
    assert!(coarse_blunt < 4e-3 && fine_blunt < 1e-3, "{coarse_blunt} {fine_blunt}");
}
