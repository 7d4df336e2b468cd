//! Objects that follow others: a body that is made of objects of the session takes over their changes.

use super::CommandError;
use super::session::{SessionState, SketchSession};
use super::subject::ReplySubject;
use crate::feature::{EdgeChoice, FaceChoice, Feature, FeatureKind};
use crate::identifier::identifier;
use crate::{DimensionExpr, SketchObject};
use std::collections::BTreeSet;
use std::sync::Arc;

impl SketchSession {
    /// The object of a name that a feature is to be made of; in the text of a feature also one around it.
    pub(super) fn operand(&self, name: &str) -> Result<Arc<SketchObject>, CommandError> {
        let key = name.to_lowercase();
        let around = self.state.outside.iter().rev().map(|o| &o.0);
        let found = std::iter::once(&self.state.objects).chain(around).find_map(|o| o.get(&key));
        found.map(Arc::clone).ok_or_else(|| self.unknown(name))
    }

    /// True if a feature of the name `target` follows the operand of a name. In the text of a feature, those inside are
    /// its parts.
    pub(super) fn follows(&self, operand: &str, target: &str) -> bool {
        match self.state.outside.is_empty() {
            true => !operand.eq_ignore_ascii_case(target),
            false => !self.state.objects.contains_key(&operand.to_lowercase()),
        }
    }

    /// Refuses an object that would follow itself.
    pub(super) fn no_circle(&self, made: &SketchObject) -> Result<(), CommandError> {
        let own = made.name.to_lowercase();
        let mut ways: Vec<Vec<String>> = made.followed().into_iter().map(|n| vec![n]).collect();
        while let Some(way) = ways.pop() {
            let Some(last) = way.last() else { continue };
            if *last == own {
                let names = way[..way.len() - 1].join(", ");
                return Err(CommandError::text(
                    format!("{names} would be made of {0}, and {0} of it", made.name),
                    "give the result another name INTO",
                )
                .about(ReplySubject::of("object-twice").names(&way)));
            }
            let object = self.state.objects.get(last).filter(|_| way.len() <= MAX_CHAIN);
            for next in object.iter().flat_map(|o| o.followed()) {
                ways.push(way.iter().cloned().chain([next]).collect());
            }
        }
        Ok(())
    }

    /// Gives the objects that follow changed ones their present states. Those that had bodies are checked later.
    pub(super) fn follow(&mut self, before: &SessionState) {
        if !self.state.outside.is_empty() {
            return;
        }
        // Each round reaches the followers of followers; there are no circles.
        let mut changed: BTreeSet<String> = BTreeSet::new();
        for _ in 0..self.state.objects.len() {
            let objects = &self.state.objects;
            let live = |name: &str| objects.get(name).map(Arc::clone);
            let new: Vec<(String, Arc<SketchObject>)> = (objects.iter())
                .filter_map(|(key, object)| Some((key.clone(), object.refreshed(&live)?)))
                .collect();
            if new.is_empty() {
                break;
            }
            changed.extend(new.iter().map(|(key, _)| key.clone()));
            self.state.objects.extend(new);
        }
        for key in changed {
            if self.had_body(before, &key) {
                self.unchecked.entry(key).or_insert(false);
            }
        }
    }

    /// Objects of the session that follow one, directly or not.
    pub(super) fn followers(&self, name: &str) -> Vec<String> {
        let mut found = vec![name.to_lowercase()];
        let mut done = 0;
        while let Some(of) = found.get(done).cloned() {
            done += 1;
            for (key, object) in &self.state.objects {
                if object.followed().contains(&of) && !found.contains(key) {
                    found.push(key.clone());
                }
            }
        }
        let name = |key: &String| self.state.objects.get(key).map(|o| o.name.clone());
        found[1..].iter().filter_map(name).collect()
    }

    /// Refuses a new name that a part of a follower has: in the text of that one both would be one.
    pub(super) fn no_part(&self, old: &str, new: &str) -> Result<(), CommandError> {
        fn has(object: &SketchObject, name: &str) -> bool {
            let mut operands = object.feature.iter().flat_map(|f| &f.operands);
            operands.any(|o| {
                !o.follows && (o.object.name.eq_ignore_ascii_case(name) || has(&o.object, name))
            })
        }
        for name in self.followers(old) {
            if self.object(&name).is_some_and(|o| has(o, new)) {
                return Err(CommandError::text(
                    format!("a part of {name} is called {new}"),
                    "choose another name",
                )
                .about(ReplySubject::of("name-not-free").names([&name])));
            }
        }
        Ok(())
    }

    /// Gives the followers of an object its new name, also in the names of its faces.
    pub(super) fn rename_followed(&mut self, old: &str, new: &Arc<SketchObject>) {
        let prefixes = [old, &new.name].map(|n| format!("{}.", identifier(n)));
        let followers = self.followers(old);
        for key in followers.iter().map(|n| n.to_lowercase()) {
            if let Some(object) = self.state.objects.get_mut(&key) {
                rename_in(Arc::make_mut(object), &old.to_lowercase(), new, &prefixes);
            }
        }
        for object in self.state.objects.values_mut() {
            rename_place(object, old, &new.name, &prefixes);
        }
    }

    /// Owner of a number that does not belong to the active object: the folded name of the owner,
    /// and the name of the number there.
    pub(super) fn followed_number(&self, name: &str) -> Option<(String, String)> {
        let mut at = (self.state.active.clone()?, name.to_owned());
        let here = at.clone();
        for _ in 0..MAX_CHAIN {
            let object = self.state.objects.get(&at.0)?;
            let path = match (object.alias(&at.1), object.has_name(&at.1)) {
                (Some(path), _) => path.to_owned(),
                (None, false) => at.1.clone(),
                (None, true) => break,
            };
            let (of, number) = path.split_once('.')?;
            let other = self.state.called(&of.to_ascii_lowercase())?;
            let key = other.name.to_lowercase();
            self.state.objects.get(&key)?;
            at = (key, number.to_owned());
        }
        (at != here).then_some(at)
    }
}

/// Objects that follow each other in a chain are fewer than this.
const MAX_CHAIN: usize = 1000;

fn rename_in(
    object: &mut SketchObject,
    old: &str,
    new: &Arc<SketchObject>,
    prefixes: &[String; 2],
) {
    let stands: Vec<String> = object
        .variables
        .values()
        .filter_map(|v| object.alias(&v.name))
        .map(str::to_owned)
        .collect();
    for variable in object.variables.values_mut() {
        let text = variable.value.text();
        if let Some(rest) =
            text.strip_prefix(&prefixes[0]).filter(|_| stands.iter().any(|s| s == text))
        {
            variable.value = DimensionExpr::name(&format!("{}{rest}", prefixes[1]));
        }
    }
    let Some(feature) = &mut object.feature else { return };
    let feature = Arc::make_mut(feature);
    for operand in &mut feature.operands {
        if !operand.follows {
            rename_in(Arc::make_mut(&mut operand.object), old, new, prefixes);
        } else if operand.object.name.to_lowercase() == old {
            operand.object = Arc::clone(new);
            if operand.prefix == prefixes[0] {
                operand.prefix.clone_from(&prefixes[1]);
            }
        }
    }
    faces_of(feature).into_iter().for_each(|face| rename_face(face, prefixes));
}

fn rename_face(face: &mut FaceChoice, prefixes: &[String; 2]) {
    if let FaceChoice::Named(name) = face {
        let parts: Vec<String> = (name.split('+'))
            .map(|part| match part.find(&prefixes[0]) {
                Some(k) if k == 0 || part.as_bytes()[k - 1] == b'.' => {
                    part.replacen(&prefixes[0], &prefixes[1], 1)
                }
                _ => part.to_owned(),
            })
            .collect();
        *name = parts.join("+");
    }
}

/// Renames the body of a section's face, also of the parts of features.
fn rename_place(object: &mut Arc<SketchObject>, old: &str, new: &str, prefixes: &[String; 2]) {
    let named = |o: &SketchObject| {
        let on = o.on.as_ref();
        on.is_some_and(|on| {
            on.body.eq_ignore_ascii_case(old) || on.face.to_string().contains(&prefixes[0])
        })
    };
    fn any(object: &SketchObject, found: &dyn Fn(&SketchObject) -> bool) -> bool {
        let operands = object.feature.iter().flat_map(|f| &f.operands);
        found(object) || operands.filter(|o| !o.follows).any(|o| any(&o.object, found))
    }
    if !any(object, &named) {
        return;
    }
    let object = Arc::make_mut(object);
    if let Some(on) = &mut object.on {
        rename_face(&mut on.face, prefixes);
        if on.body.eq_ignore_ascii_case(old) {
            new.clone_into(&mut on.body);
        }
    }
    if let Some(feature) = &mut object.feature {
        for operand in Arc::make_mut(feature).operands.iter_mut().filter(|o| !o.follows) {
            rename_place(&mut operand.object, old, new, prefixes);
        }
    }
}

fn faces_of(feature: &mut Feature) -> Vec<&mut FaceChoice> {
    match &mut feature.kind {
        FeatureKind::Blend { edges, .. } => (edges.iter_mut())
            .flat_map(|edge| match edge {
                EdgeChoice::Of(face) => vec![face],
                EdgeChoice::Between(a, b) => vec![a, b],
                _ => vec![],
            })
            .collect(),
        FeatureKind::OnFace { face, .. } => vec![face],
        FeatureKind::Shell { open: faces, .. } | FeatureKind::Draft { faces, .. } => {
            faces.iter_mut().collect()
        }
        _ => vec![],
    }
}
