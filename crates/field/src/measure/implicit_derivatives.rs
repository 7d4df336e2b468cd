//! Motion of facets with parameters: vertices and moments as numbers with derivatives.

use super::curved::Curved;
use super::moved::moved;
use crate::facet::types::LeafIncidence;
use crate::{Facets, FieldError, Leaf, Moments, Primitive, Set};
use moldloft_mesh::Mesh;
use moldloft_num::{Real, Vec3};

/// Facets with coordinates that carry derivatives; the real parts are those of the plain ones.
#[derive(Clone, Debug)]
pub struct Lifted<T: Real> {
    /// The mesh, with the topology of the plain one.
    pub mesh: Mesh<T>,
    /// The body's moments.
    pub moments: Moments<T>,
}

/// The primitives of a set in plain numbers, and in numbers that carry derivatives.
pub struct Lifter<T: Real> {
    pairs: Vec<(Primitive<f64>, Primitive<T>)>,
    corners: Option<[Vec3<T>; 2]>,
}

impl<T: Real> Lifter<T> {
    /// For a set within a box with corners that carry derivatives.
    pub fn new(set: &Set<T>, corners: Option<[Vec3<T>; 2]>) -> Self {
        Self::of(set, &set.re(), corners)
    }

    /// As [`Lifter::new`], given the plain set from which the facets were made. External primitives
    /// must be the same objects, since they are matched by identity.
    pub fn of(set: &Set<T>, plain: &Set<f64>, corners: Option<[Vec3<T>; 2]>) -> Self {
        let pairs = plain.traversal().into_iter().zip(set.traversal()).collect();
        Self { pairs, corners }
    }

    /// The primitive of a leaf with derivatives: one of the set, its complement or the argument of
    /// its sheet, or a face of the box.
    pub(crate) fn primitive(&self, leaf: &Leaf) -> Option<Primitive<T>> {
        let wanted = &leaf.primitive;
        for (plain, lifted) in &self.pairs {
            for (p, q) in [(plain, lifted), (plain.of_sheet(), lifted.of_sheet())] {
                if p.same(wanted) {
                    return Some(q.clone());
                }
                if (-p).same(wanted) {
                    return Some(-q);
                }
            }
        }
        // A face of the box: +-(coordinate - constant).
        let g = wanted.gradient(Vec3::zero());
        let axis = (0..3).find(|&k| g.slope[k].abs() == 1.0 && g.slope.norm() == 1.0)?;
        let offset = match &self.corners {
            Some([_, high]) if g.slope[axis] > 0.0 => -high[axis],
            Some([low, _]) => low[axis],
            None => T::from(g.value),
        };
        (offset.re() == g.value).then(|| Primitive::linear(Vec3::lifted(g.slope), offset))
    }

    /// The vertices of facets; see [`Facets::lifted`].
    ///
    /// # Errors
    /// Facets of another set.
    pub fn positions(&self, facets: &Facets) -> Result<Vec<Vec3<T>>, FieldError> {
        let primitives = self.primitives(facets)?;
        Ok(moved(facets.mesh.positions(), &facets.surfaces, &primitives))
    }

    /// Points on surfaces of the set, with derivatives.
    ///
    /// # Errors
    /// Surfaces that are not the set's.
    pub fn moved_on(
        &self,
        points: &[Vec3],
        on: &LeafIncidence,
    ) -> Result<Vec<Vec3<T>>, FieldError> {
        let primitives = self.primitives_on(on)?;
        Ok(moved(points, &on.surfaces, &primitives))
    }

    /// The primitives of the points' leaves.
    ///
    /// # Errors
    /// Surfaces that are not the set's.
    pub(crate) fn primitives_on(
        &self,
        on: &LeafIncidence,
    ) -> Result<Vec<Option<Primitive<T>>>, FieldError> {
        self.those_of(&on.leaves, on.surfaces.iter().flatten().copied())
    }

    /// The primitives of the leaves that show.
    ///
    /// # Errors
    /// Facets of another set.
    pub(crate) fn primitives(
        &self,
        facets: &Facets,
    ) -> Result<Vec<Option<Primitive<T>>>, FieldError> {
        let shown = facets.patch_leaves.iter().map(|&leaf| leaf as u32);
        self.those_of(&facets.leaves, facets.surfaces.iter().flatten().copied().chain(shown))
    }

    /// The primitives of those leaves that are in use.
    fn those_of(
        &self,
        leaves: &[Leaf],
        in_use: impl Iterator<Item = u32>,
    ) -> Result<Vec<Option<Primitive<T>>>, FieldError> {
        let mut used = vec![false; leaves.len()];
        in_use.for_each(|leaf| used[leaf as usize] = true);
        let foreign = FieldError::Degenerate { what: "set: it is not the one of these facets" };
        let each = leaves.iter().zip(used).map(|(leaf, used)| match used {
            true => self.primitive(leaf).map(Some).ok_or_else(|| foreign.clone()),
            false => Ok(None),
        });
        each.collect()
    }
}

impl Facets {
    /// The facets of `set`, which is the set that they were made of in numbers that carry
    /// derivatives.
    ///
    /// A vertex moves by the shortest vector that keeps it on all its surfaces (the implicit function
    /// theorem): on one, along the normal by -df/|f'|; on two, across their edge; on three, as the
    /// corner does.
    ///
    /// # Errors
    /// [`FieldError::Degenerate`] when the set is not of the same parts.
    pub fn lifted<T: Real>(&self, set: &Set<T>) -> Result<Lifted<T>, FieldError> {
        self.lifted_by(&Lifter::new(set, None))
    }

    /// As [`Facets::lifted`].
    ///
    /// # Errors
    /// As [`Facets::lifted`].
    pub fn lifted_by<T: Real>(&self, lifter: &Lifter<T>) -> Result<Lifted<T>, FieldError> {
        let primitives = lifter.primitives(self)?;
        let positions = moved(self.mesh.positions(), &self.surfaces, &primitives);
        let moments = Curved::new(&self.flat()).moments(&positions, &primitives, self.about);
        let foreign = FieldError::Degenerate { what: "set: it is not the one of these facets" };
        let mesh = Mesh::new(self.mesh.topology().clone(), positions).map_err(|_| foreign)?;
        Ok(Lifted { mesh, moments })
    }
}
