//! Dragging: adjusts numbers of the text so that a point of the model follows the pointer.
//! The point is an expression of the model; its derivatives with respect to numbers of the text are
//! exact. The numbers follow by the least change ([`moldloft_document::follow`]) from their values
//! at the start of the drag.

use moldloft_document::follow::{Conditions, FollowSearch, FollowingNumber, follow};
use moldloft_document::{Document, round_to};
use moldloft_num::Vec3;
use moldloft_registry::{Class, Value};

/// A drag in progress.
#[derive(Clone, Debug)]
pub struct Drag {
    /// The object.
    pub object: String,
    /// The point as an expression.
    pub expression: String,
    /// The numbers that move it.
    pub handles: Vec<Handle>,
    /// True for a point on a curve or surface by its own parameters: the curve or surface moves
    /// only if the user chooses so.
    carried: bool,
    /// Its initial position.
    start: Vec3,
    /// Every number changed so far, with its value before the drag.
    moved: Vec<(String, f64)>,
}

/// Relation of a number to the dragged object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandleKind {
    /// A number of the object itself.
    Own,
    /// A number in the expression of one of its numbers, such as 5.046 in `5.046 * beam`.
    Coefficient,
    /// A parameter.
    Parameter,
    /// An integer in such an expression: usually part of a rule, as in `beam / 2`.
    WholeCoefficient,
}

/// A number that moves the point.
#[derive(Clone, Debug)]
pub struct Handle {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: HandleKind,
    /// Derivative of the point with respect to it.
    pub direction: Vec3,
    /// Its value.
    pub value: f64,
    /// Its range.
    pub range: Option<(f64, f64)>,
}

/// Result of a step.
#[derive(Clone, Debug)]
pub struct Reached {
    /// Position of the point.
    pub place: Vec3,
    /// Remaining distance to the target, along the directions of the view.
    pub left: f64,
    /// The adjusted numbers.
    pub values: Vec<(String, f64)>,
    /// The adjusted numbers at a bound of their range.
    pub ended: Vec<String>,
}

/// Maximum number of steps per position of the pointer.
const MOST_STEPS: usize = 12;

/// Minimum visible fraction of the motion due to a number, in the plane of the view.
const SEEN: f64 = 0.05;

/// Fraction of the motion below which no further number is added.
const FOLLOWED: f64 = 1e-3;

/// The dragged point as conditions on the numbers.
struct Aim<'a> {
    document: &'a mut Document,
    expression: &'a str,
    names: &'a [String],
    target: Vec3,
    basis: &'a [Vec3],
}

impl Conditions for Aim<'_> {
    fn at(&mut self, x: &[f64]) -> Result<Vec<f64>, String> {
        let values: Vec<(String, f64)> =
            self.names.iter().cloned().zip(x.iter().copied()).collect();
        self.document
            .set(&values)
            .map_err(|d| d.first().map_or(String::new(), |d| d.message.clone()))?;
        let place = place(self.document, self.expression)?;
        Ok(self.basis.iter().map(|b| b.dot(place - self.target)).collect())
    }

    fn slopes(&mut self) -> Result<Vec<Vec<f64>>, String> {
        let directions = directions(self.document, self.expression, self.names)?;
        Ok(self.basis.iter().map(|b| directions.iter().map(|d| b.dot(*d)).collect()).collect())
    }
}

impl Drag {
    /// Starts the drag of a point of an object and finds the numbers that move it.
    ///
    /// # Errors
    /// The reason why it cannot be dragged.
    pub fn begin(document: &mut Document, object: &str, at: &[f64]) -> Result<Self, String> {
        let expression = match at {
            [] => object.to_string(),
            _ => {
                let at: Vec<String> = at.iter().map(f64::to_string).collect();
                format!("{object}({})", at.join(", "))
            }
        };
        let start = place(document, &expression)?;
        let mut names: Vec<(String, HandleKind)> = Vec::new();
        if at.is_empty() {
            for (name, literal) in numbers_of(document, object) {
                if literal {
                    names.push((name, HandleKind::Own));
                } else {
                    let found = document.coefficients(&name).into_iter();
                    names.extend(found.map(|c| {
                        let whole = c.value.fract() == 0.0;
                        let kind = if whole {
                            HandleKind::WholeCoefficient
                        } else {
                            HandleKind::Coefficient
                        };
                        (c.name, kind)
                    }));
                }
            }
        }
        let params = document.params().iter().filter(|p| !p.is_int);
        names.extend(params.map(|p| (p.name.clone(), HandleKind::Parameter)));
        let by: Vec<String> = names.iter().map(|(name, _)| name.clone()).collect();
        let found = directions(document, &expression, &by)?;
        let handles: Vec<Handle> = names
            .into_iter()
            .zip(found)
            .filter(|(_, d)| d.is_finite() && d.norm() > 0.0)
            .filter_map(|((name, kind), direction)| {
                let (value, range) = document.number_state(&name)?;
                Some(Handle { name, kind, direction, value, range })
            })
            .collect();
        if handles.is_empty() {
            return Err(format!("`{object}` cannot be dragged: no number of this text moves it"));
        }
        let own = handles.iter().any(|h| h.kind == HandleKind::Own);
        let carried = own
            && document
                .graph()
                .find(object)
                .and_then(|key| document.graph().get(key))
                .is_some_and(|o| matches!(o.row.class, Class::Bead | Class::Magnet | Class::Ring));
        Ok(Self { object: object.into(), expression, handles, carried, start, moved: Vec::new() })
    }

    /// The numbers to adjust for a motion: those of the object itself whose effect is visible, and
    /// the chosen ones. Without chosen ones the rest of the motion is followed by coefficients in
    /// expressions of the object, then by the parameters that cover most of it within their ranges,
    /// then by integer coefficients.
    pub fn followers(&self, target: Vec3, basis: &[Vec3], chosen: &[String]) -> Vec<String> {
        let seen = |h: &Handle| -> Vec<f64> { basis.iter().map(|b| b.dot(h.direction)).collect() };
        let motion: Vec<f64> = basis.iter().map(|b| b.dot(target - self.start)).collect();
        let mut left = Left { whole: norm(&motion), motion, followed: Vec::new() };
        let mut names = Vec::new();
        let of = |kind: HandleKind| self.handles.iter().filter(move |h| h.kind == kind);
        for h in of(HandleKind::Own) {
            if left.take(&seen(h), h.direction.norm()) {
                names.push(h.name.clone());
            }
        }
        if !chosen.is_empty() {
            names.extend(
                chosen.iter().filter(|c| self.handles.iter().any(|h| h.name == **c)).cloned(),
            );
            names.dedup();
            return names;
        }
        if self.carried {
            return names;
        }
        for kind in [HandleKind::Coefficient, HandleKind::Parameter, HandleKind::WholeCoefficient] {
            let width = |h: &Handle| h.range.map_or(h.value.abs().max(1e-3), |(a, b)| b - a);
            let mut rest: Vec<&Handle> = of(kind).collect();
            while !left.is_followed() && !rest.is_empty() {
                let pull = |h: &&Handle| left.pull(&seen(h)) * width(h);
                let at = (0..rest.len())
                    .max_by(|a, b| pull(&rest[*a]).total_cmp(&pull(&rest[*b])))
                    .unwrap_or_default();
                let best = rest.remove(at);
                if left.pull(&seen(best)) > 0.0 && left.take(&seen(best), best.direction.norm()) {
                    names.push(best.name.clone());
                }
            }
        }
        names
    }

    /// Moves the point as near to `target` as the numbers of [`Drag::followers`] permit.
    ///
    /// # Errors
    /// The reason why nothing moves.
    pub fn to(
        &mut self,
        document: &mut Document,
        target: Vec3,
        basis: &[Vec3],
        chosen: &[String],
        grain: f64,
    ) -> Result<Reached, String> {
        let names = self.followers(target, basis, chosen);
        for name in &names {
            self.keep(document, name)?;
        }
        // Numbers adjusted for an earlier motion are reset.
        let back: Vec<(String, f64)> =
            self.moved.iter().filter(|(n, _)| !names.contains(n)).cloned().collect();
        let value = |document: &Document, name: &str| document.number_state(name).map(|(x, _)| x);
        if back.iter().any(|(n, x)| value(document, n) != Some(*x)) {
            document
                .set(&back)
                .map_err(|d| d.first().map_or(String::new(), |d| d.message.clone()))?;
        }
        if names.is_empty() {
            let moves = basis.iter().any(|b| b.dot(target - self.start).abs() > grain);
            if moves {
                return Err(format!(
                    "`{}` does not move that way in this view: no number of the text does that",
                    self.object
                ));
            }
            let place = place(document, &self.expression)?;
            return Ok(Reached { place, left: 0.0, values: Vec::new(), ended: Vec::new() });
        }
        let home = |name: &String| self.moved.iter().find(|(n, _)| n == name).map(|(_, x)| *x);
        let mut followers = Vec::new();
        let mut begin = Vec::new();
        for name in &names {
            let (x, range) = document.number_state(name).ok_or("gone")?;
            followers.push(FollowingNumber { home: home(name).unwrap_or(x), range, weight: 1.0 });
            begin.push(x);
        }
        let mut aim = Aim { document, expression: &self.expression, names: &names, target, basis };
        let equal = vec![1.0; basis.len()];
        let enough = (1e-3 * grain).max(1e-12 * (1.0 + target.norm()));
        let how = FollowSearch {
            importance: &equal,
            alike: true,
            no_effect: &[],
            enough,
            steps: MOST_STEPS,
        };
        let found = follow(&mut aim, &followers, &begin, how)?;
        let still = found.x == begin && found.left.iter().any(|l| l.abs() > grain);
        if let Some(why) = found.refused.filter(|_| still) {
            return Err(why);
        }
        let place = match self.rounded(document, &names, grain) {
            Some(place) => place,
            None => place(document, &self.expression)?,
        };
        let left = basis.iter().map(|b| b.dot(target - place)).map(|x| x * x).sum::<f64>().sqrt();
        let mut values = Vec::new();
        let mut ended = Vec::new();
        for name in names {
            let Some((x, range)) = document.number_state(&name) else { continue };
            if range.is_some_and(|(low, high)| x <= low || x >= high) {
                ended.push(name.clone());
            }
            values.push((name, x));
        }
        Ok(Reached { place, left, values, ended })
    }

    /// Rounds the numbers to one screen pixel; a number that changed by less keeps its value.
    fn rounded(&self, document: &mut Document, names: &[String], grain: f64) -> Option<Vec3> {
        if grain.is_nan() || grain <= 0.0 {
            return None;
        }
        let directions = directions(document, &self.expression, names).ok()?;
        let mut values = Vec::new();
        for (name, direction) in names.iter().zip(directions) {
            let (now, range) = document.number_state(name)?;
            let (_, begin) = self.moved.iter().find(|(n, _)| n == name)?;
            let worth = grain / direction.norm().max(f64::MIN_POSITIVE);
            let rounded = round_to(now, worth);
            let rounded = range.map_or(rounded, |(a, b)| rounded.clamp(a, b));
            let value = if (now - begin).abs() < 0.5 * worth { *begin } else { rounded };
            values.push((name.clone(), value));
        }
        document.set(&values).ok()?;
        place(document, &self.expression).ok()
    }

    /// Stores the value of a number before the drag, so that [`Drag::changed`] can compare.
    ///
    /// # Errors
    /// If there is no such number.
    pub fn keep(&mut self, document: &Document, name: &str) -> Result<(), String> {
        if !self.moved.iter().any(|(n, _)| n == name) {
            let (value, _) = document.number_state(name).ok_or(format!("no number `{name}`"))?;
            self.moved.push((name.into(), value));
        }
        Ok(())
    }

    /// The numbers that differ from their values before the drag, with their current values.
    pub fn changed(&self, document: &Document) -> Vec<(String, f64)> {
        let now = |name: &str| document.number_state(name).map(|(x, _)| x);
        let changed = self.moved.iter().filter_map(|(name, before)| {
            let x = now(name).filter(|x| x != before)?;
            Some((name.clone(), x))
        });
        changed.collect()
    }
}

/// Remaining motion in the plane of the view, and an orthonormal basis of the directions followed
/// so far.
struct Left {
    whole: f64,
    motion: Vec<f64>,
    followed: Vec<Vec<f64>>,
}

impl Left {
    fn is_followed(&self) -> bool {
        norm(&self.motion) <= FOLLOWED * self.whole
    }

    /// Part of the remaining motion that a number with the visible effect `seen` can follow.
    fn pull(&self, seen: &[f64]) -> f64 {
        let along: f64 = seen.iter().zip(&self.motion).map(|(a, b)| a * b).sum::<f64>().abs();
        if along > SEEN * norm(seen) * norm(&self.motion) { along } else { 0.0 }
    }

    /// Adds a direction, `length` long in space, if it is visible and linearly independent.
    fn take(&mut self, seen: &[f64], length: f64) -> bool {
        let new = self.without(seen);
        if norm(seen) < SEEN * length || norm(&new) < SEEN * norm(seen) {
            return false;
        }
        let size = norm(&new);
        self.followed.push(new.iter().map(|x| x / size).collect());
        self.motion = self.without(&self.motion);
        true
    }

    fn without(&self, v: &[f64]) -> Vec<f64> {
        let mut v = v.to_vec();
        for q in &self.followed {
            let dot: f64 = v.iter().zip(q).map(|(a, b)| a * b).sum();
            v.iter_mut().zip(q).for_each(|(a, b)| *a -= dot * b);
        }
        v
    }
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn place(document: &mut Document, expression: &str) -> Result<Vec3, String> {
    let value = document.eval(expression);
    position(value.map_err(|d| d.first().map_or("no value".into(), |d| d.message.clone()))?)
        .ok_or_else(|| format!("`{expression}` is not a position"))
}

fn directions(
    document: &mut Document,
    expression: &str,
    by: &[String],
) -> Result<Vec<Vec3>, String> {
    let derived = document.derivatives(&[expression.to_string()], by);
    let mut derived =
        derived.map_err(|d| d.first().map_or("no derivative".into(), |d| d.message.clone()))?;
    let column = derived.pop().unwrap_or_default();
    Ok(column.into_iter().map(|v| position(v).unwrap_or(Vec3::zero())).collect())
}

fn position(value: Value<f64>) -> Option<Vec3> {
    match value {
        Value::Point(p) => Some(p.xyz),
        Value::Vector(v) => Some(v),
        _ => None,
    }
    .filter(|p| p.is_finite())
}

/// The numbers of an object by name; true for those that the text states as literals.
fn numbers_of(document: &Document, object: &str) -> Vec<(String, bool)> {
    let graph = document.graph();
    let Some(found) = graph.find(object).and_then(|key| graph.get(key)) else { return Vec::new() };
    let mut names = Vec::new();
    for (field, arg) in found.row.fields.iter().zip(&found.args) {
        let base = format!("{object}.{}", field.name);
        match arg {
            Value::Number(_) => names.push(base),
            Value::Vector(_) => names.extend(["x", "y", "z"].map(|c| format!("{base}.{c}"))),
            _ => {}
        }
    }
    names
        .into_iter()
        .map(|name| (document.settable(&name).is_ok(), name))
        .map(|(l, n)| (n, l))
        .collect()
}

/// Names of the numbers of an object that a drag may change.
pub fn own_numbers(document: &Document, object: &str) -> Vec<String> {
    numbers_of(document, object)
        .into_iter()
        .filter(|(_, literal)| *literal)
        .map(|(n, _)| n)
        .collect()
}
