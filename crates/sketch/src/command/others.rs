//! Numbers of other objects in expressions: in an object that has no such name, `A.W` is the number W of the object A.

use super::session::{SessionState, SketchSession};
use crate::identifier::identifier;
use crate::solid::feature::{ForeignNames, foreign, foreign_known};
use crate::{DimensionExpr, DimensionLayout, SketchObject, numbers};
use moldloft_num::Real;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Numbers of other objects by the names that an object reads.
pub(crate) type OtherNumbers = BTreeMap<String, f64>;

impl SessionState {
    /// Numbers of other objects that the expressions of one refer to. An object with a reference
    /// back to this one has none.
    pub fn others(&self, object: &SketchObject) -> OtherNumbers {
        self.others_with(object, &BTreeMap::new())
    }

    /// Numbers of other objects, some of them replaced.
    pub fn others_with<T: Real>(
        &self,
        object: &SketchObject,
        given: &BTreeMap<String, T>,
    ) -> BTreeMap<String, T> {
        let mut known = BTreeMap::from([(key(object), BTreeMap::new())]);
        self.read_by(object, given, &mut known, &mut ForeignNames::new())
    }

    fn read_by<T: Real>(
        &self,
        object: &SketchObject,
        given: &BTreeMap<String, T>,
        known: &mut BTreeMap<String, BTreeMap<String, T>>,
        names: &mut ForeignNames,
    ) -> BTreeMap<String, T> {
        let mut found = BTreeMap::new();
        for name in foreign_known(object, names).iter() {
            let Some((of, number)) = name.split_once('.') else { continue };
            if !known.contains_key(of) {
                let Some(other) = self.called(of) else { continue };
                // In progress: excludes circular references.
                known.insert(of.to_owned(), BTreeMap::new());
                let mut read = self.read_by(other, given, known, names);
                let prefix = format!("{of}.");
                let own = given.iter().filter_map(|(n, x)| Some((n.strip_prefix(&prefix)?, *x)));
                read.extend(own.map(|(n, x)| (n.to_owned(), x)));
                known.insert(of.to_owned(), numbers(other, &read));
            }
            if let Some(value) = known[of].get(number) {
                found.insert(name.clone(), *value);
            }
        }
        found
    }

    /// The object of a name in an expression, one around the feature that is being read if there is no other.
    pub fn called(&self, name: &str) -> Option<&SketchObject> {
        let around = self.outside.iter().rev().map(|o| &o.0);
        let mut all = std::iter::once(&self.objects).chain(around).flat_map(|o| o.values());
        all.find(|o| key(o) == name).map(|o| &**o)
    }
}

impl SketchSession {
    /// The value that a name in the expressions of an object has now: of its own numbers, or of another object's.
    pub(super) fn known_number(
        &self,
        object: &SketchObject,
        layout: &DimensionLayout<f64>,
        name: &str,
    ) -> Option<f64> {
        let own = layout.values.get(name).copied();
        own.or_else(|| {
            let (of, number) = name.split_once('.').filter(|_| !object.has_name(name))?;
            let other = self.state.called(of)?;
            numbers(other, &self.state.others(other)).get(number).copied()
        })
    }

    /// Objects that read numbers of one, with the names.
    pub(super) fn readers(&self, name: &str) -> Vec<(String, Vec<String>)> {
        let prefix = format!("{}.", identifier(name).to_ascii_lowercase());
        let all = self.state.objects.values();
        all.filter(|o| !o.name.eq_ignore_ascii_case(name))
            .map(|o| {
                let read = foreign(o).into_iter().filter(|n| n.starts_with(&prefix));
                (o.name.clone(), read.collect::<Vec<_>>())
            })
            .filter(|(_, read)| !read.is_empty())
            .collect()
    }

    /// Gives the numbers of an object that has another name now the new names in other objects.
    pub(super) fn rename_read(&mut self, old: &str, new: &str) {
        let prefix = format!("{}.", identifier(old).to_ascii_lowercase());
        let new = identifier(new);
        for (reader, _) in self.readers(old) {
            let Some(object) = self.state.objects.get_mut(&reader.to_lowercase()) else { continue };
            let own = Arc::clone(object);
            let renamed = |name: &str| {
                let rest = name.strip_prefix(&prefix).filter(|_| !own.has_name(name))?;
                Some(format!("{new}.{rest}"))
            };
            for expression in expressions_of(Arc::make_mut(object)) {
                *expression = expression.renamed(&renamed);
            }
        }
    }
}

/// The name of an object in expressions, folded.
fn key(object: &SketchObject) -> String {
    identifier(&object.name).to_ascii_lowercase()
}

fn expressions_of(object: &mut SketchObject) -> impl Iterator<Item = &mut DimensionExpr> {
    let values = object.variables.values_mut().map(|v| &mut v.value);
    let values = values.chain(object.dimensions.values_mut().filter_map(|d| d.value.as_mut()));
    let feature = object.feature.iter_mut().map(Arc::make_mut);
    let values = values.chain(feature.flat_map(|f| f.kind.numbers_mut()));
    let sizes = object.curves.values_mut().flat_map(|c| c.sizes_mut());
    values.chain(sizes).chain(object.reference.iter_mut().flat_map(|r| &mut r.at))
}
