//! How facets move when parameters change: their vertices and moments as numbers with derivatives.

use crate::{Facets, FieldError, Gradient, Moments, Primitive, Set};
use moldloft_mesh::Mesh;
use moldloft_num::{Real, Vec3};
use smallvec::SmallVec;

/// Facets whose numbers carry derivatives; the real parts are those of the plain ones to rounding.
#[derive(Clone, Debug)]
pub struct Lifted<T: Real> {
    /// The mesh, on the plain one's topology.
    pub mesh: Mesh<T>,
    /// The body's moments.
    pub moments: Moments<T>,
}

impl Facets {
    /// The facets of `set`, the same as the one they were made of but with numbers that carry
    /// derivatives.
    ///
    /// A vertex moves by the shortest vector that keeps it on all its surfaces (the implicit function
    /// theorem): on one, along the normal by -df/|f'|; on two, across their edge; on three, as the
    /// corner does.
    ///
    /// # Errors
    /// [`FieldError::Degenerate`] when the set is not of the same parts.
    pub fn lifted<T: Real>(&self, set: &Set<T>) -> Result<Lifted<T>, FieldError> {
        let foreign = FieldError::Degenerate { what: "set: it is not the one of these facets" };
        let primitives = self.primitives_of(set).ok_or(foreign.clone())?;
        let mut values = Vec::new();
        let mut positions = Vec::with_capacity(self.surfaces.len());
        for (p, surfaces) in self.mesh.positions().iter().zip(&self.surfaces) {
            let p = Vec3::lifted(*p);
            let rows: SmallVec<[(Vec3<T>, T); 3]> = surfaces
                .iter()
                .map(|&leaf| {
                    let tape = primitives[leaf as usize].tape();
                    let g = tape.eval::<Gradient<T>>(&p, &mut values);
                    (g.slope, g.value)
                })
                .collect();
            positions.push(p + shortest(&rows));
        }
        let moments = self.moments_of(&positions, &primitives.iter().collect::<Vec<_>>());
        let mesh = Mesh::new(self.mesh.topology().clone(), positions).map_err(|_| foreign)?;
        Ok(Lifted { mesh, moments })
    }

    /// The primitives of `set` in the order of these leaves, the box's faces after them.
    fn primitives_of<T: Real>(&self, set: &Set<T>) -> Option<Vec<Primitive<T>>> {
        let caps = self.leaves.len().checked_sub(self.own_leaves)?;
        let places = set.re().compiled().places;
        let all = set.traversal();
        if places.len() != all.len() {
            return None;
        }
        let mut out: Vec<Option<Primitive<T>>> = vec![None; self.own_leaves];
        for (primitive, place) in all.into_iter().zip(places) {
            let slot = out.get_mut(place as usize)?;
            if slot.is_none() {
                if !primitive.re().same(&self.leaves[place as usize].primitive) {
                    return None;
                }
                *slot = Some(primitive);
            }
        }
        let mut out = out.into_iter().collect::<Option<Vec<_>>>()?;
        for cap in &self.leaves[self.leaves.len() - caps..] {
            let g = cap.primitive.gradient(Vec3::zero());
            out.push(Primitive::linear(Vec3::lifted(g.slope), T::from(g.value)));
        }
        Some(out)
    }
}

/// The shortest s with n . s = -f for the rows (n, f); rows that repeat a direction are left out.
fn shortest<T: Real>(rows: &[(Vec3<T>, T)]) -> Vec3<T> {
    let mut kept: SmallVec<[(Vec3<T>, T); 3]> = SmallVec::new();
    // By Gram and Schmidt, each row less its part in those before.
    for &(n, f) in rows {
        let (mut m, mut g) = (n, f);
        for &(q, h) in &kept {
            let part = n.dot(q);
            m -= q * part;
            g -= h * part;
        }
        let size = m.norm_sq();
        if size.re() > 1e-12 * n.norm_sq().re() && kept.len() < 3 {
            let length = size.sqrt();
            kept.push((m / length, g / length));
        }
    }
    let mut step = Vec3::zero();
    for (q, h) in kept {
        step -= q * h;
    }
    step
}
