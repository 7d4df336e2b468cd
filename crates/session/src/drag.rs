//! Dragging: the numbers that bring a place of the model to where the hand is.
//!
//! The place is an expression of the model; its derivatives by numbers of the text are exact. The numbers follow by the
//! least change ([`moldloft_document::follow`]), from what they were when the drag began.

use moldloft_document::follow::{Conditions, FollowSearch, FollowingNumber, follow};
use moldloft_document::{Document, round_to};
use moldloft_num::Vec3;
use moldloft_registry::{Class, Value};

/// A drag under way.
#[derive(Clone, Debug)]
pub struct Drag {
    /// The object.
    pub object: String,
    /// The place as an expression.
    pub expression: String,
    /// What moves it.
    pub handles: Vec<Handle>,
    /// True for what is on a curve or surface by its own numbers: only a choice takes that along.
    carried: bool,
    /// Where it was.
    start: Vec3,
    /// Every number that was moved, and its value before.
    moved: Vec<(String, f64)>,
}

/// What a number is to the object that is dragged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandleKind {
    /// A number of the object itself.
    Own,
    /// A number in the expression of one of its numbers, such as 5.046 in `5.046 * beam`.
    Coefficient,
    /// A parameter.
    Parameter,
    /// A whole number in such an expression: mostly part of a rule, as in `beam / 2`.
    WholeCoefficient,
}

/// A number that moves the place.
#[derive(Clone, Debug)]
pub struct Handle {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: HandleKind,
    /// The derivative of the place by it.
    pub direction: Vec3,
    /// Its value.
    pub value: f64,
    /// Its range.
    pub range: Option<(f64, f64)>,
}

/// What came of a step.
#[derive(Clone, Debug)]
pub struct Reached {
    /// Where the place is.
    pub place: Vec3,
    /// What is left of the way, along the directions that count.
    pub left: f64,
    /// The numbers that follow.
    pub values: Vec<(String, f64)>,
    /// Those of them that are at an end of their range.
    pub ended: Vec<String>,
}

/// Steps for one place of the hand.
const MOST_STEPS: usize = 12;

/// A number moves the place in the picture when at least this share of its motion is seen there.
const SEEN: f64 = 0.05;

/// A part of the motion that is smaller than this share needs no further number.
const FOLLOWED: f64 = 1e-3;

/// The dragged place, as conditions on the numbers.
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
    /// What is to be dragged, and what moves it.
    ///
    /// # Errors
    /// Why it cannot be dragged.
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

    /// The numbers that follow a motion: those of the object itself, as far as the view shows what they do, and the
    /// chosen ones. Where none are chosen, for what is left of the motion the coefficients in its expressions, then the
    /// parameters that take most of it within their ranges, then whole coefficients.
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

    /// Moves the place as near to `target` as [`Drag::followers`] take it.
    ///
    /// # Errors
    /// Why nothing moves.
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
        // What followed another motion goes back.
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
        let how = FollowSearch { importance: &equal, alike: true, enough, steps: MOST_STEPS };
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

    /// Rounds the numbers to what a picture point is worth; one that has hardly moved stays as it was.
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

    /// Remembers what a number was before the drag, so that its end finds what has changed.
    ///
    /// # Errors
    /// That there is no such number.
    pub fn keep(&mut self, document: &Document, name: &str) -> Result<(), String> {
        if !self.moved.iter().any(|(n, _)| n == name) {
            let (value, _) = document.number_state(name).ok_or(format!("no number `{name}`"))?;
            self.moved.push((name.into(), value));
        }
        Ok(())
    }

    /// The numbers that are not what they were before the drag, and their values.
    pub fn changed(&self, document: &Document) -> Vec<(String, f64)> {
        let now = |name: &str| document.number_state(name).map(|(x, _)| x);
        let changed = self.moved.iter().filter_map(|(name, before)| {
            let x = now(name).filter(|x| x != before)?;
            Some((name.clone(), x))
        });
        changed.collect()
    }
}

/// What is left of a motion in the picture, and the directions that are followed, at right angles to each other.
struct Left {
    whole: f64,
    motion: Vec<f64>,
    followed: Vec<Vec<f64>>,
}

impl Left {
    fn is_followed(&self) -> bool {
        norm(&self.motion) <= FOLLOWED * self.whole
    }

    /// How far a number that moves the place by `seen` follows what is left.
    fn pull(&self, seen: &[f64]) -> f64 {
        let along: f64 = seen.iter().zip(&self.motion).map(|(a, b)| a * b).sum::<f64>().abs();
        if along > SEEN * norm(seen) * norm(&self.motion) { along } else { 0.0 }
    }

    /// Follows a direction of that length in space, if the picture shows it and it is a new one.
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
        .ok_or_else(|| format!("`{expression}` is not at a place"))
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

/// The numbers of an object by their names, and whether the text states them as numbers.
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

/// The numbers of an object that a hand may change, by their names.
pub fn own_numbers(document: &Document, object: &str) -> Vec<String> {
    numbers_of(document, object)
        .into_iter()
        .filter(|(_, literal)| *literal)
        .map(|(n, _)| n)
        .collect()
}
