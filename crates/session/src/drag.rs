//! Dragging: the numbers that bring a place of the model to where the hand is.
//!
//! The place is an expression of the model; its derivatives by numbers of the text are exact. A step is a
//! damped least-squares solution, each number scaled by the width of its range; the true place is
//! evaluated after it, and what is left is done by the next.

use moldloft_document::Document;
use moldloft_num::Vec3;
use moldloft_registry::Value;

/// A drag under way.
#[derive(Clone, Debug)]
pub struct Drag {
    /// The object.
    pub object: String,
    /// The place as an expression.
    pub expression: String,
    /// The numbers of the object itself that move it.
    pub own: Vec<String>,
    /// Every number that was moved, and its value before.
    pub moved: Vec<(String, f64)>,
}

/// A number that moves the place.
#[derive(Clone, Debug)]
pub struct Handle {
    /// Its name.
    pub name: String,
    /// True for a number of the object itself.
    pub own: bool,
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
    /// The numbers.
    pub values: Vec<(String, f64)>,
}

/// Steps for one place of the hand.
const ROUNDS: usize = 4;

/// Damping for numbers of the object itself, and for parameters, which may be insensitive.
const DAMPING: [f64; 2] = [1e-12, 1e-3];

impl Drag {
    /// What is to be dragged, and what moves it.
    ///
    /// # Errors
    /// Why it cannot be dragged.
    pub fn begin(
        document: &mut Document,
        object: &str,
        at: &[f64],
    ) -> Result<(Self, Vec<Handle>), String> {
        let expression = match at {
            [] => object.to_string(),
            _ => {
                let at: Vec<String> = at.iter().map(f64::to_string).collect();
                format!("{object}({})", at.join(", "))
            }
        };
        let own = if at.is_empty() { own_numbers(document, object) } else { Vec::new() };
        let mut drag = Self { object: object.into(), expression, own, moved: Vec::new() };
        drag.place(document)?;
        let params: Vec<String> = document.params().iter().map(|p| p.name.clone()).collect();
        let names: Vec<String> = drag.own.iter().cloned().chain(params).collect();
        let directions = drag.directions(document, &names)?;
        let count = drag.own.len();
        let handles: Vec<Handle> = names
            .into_iter()
            .zip(directions)
            .enumerate()
            .filter(|(_, (_, d))| d.is_finite() && d.norm() > 0.0)
            .filter_map(|(k, (name, direction))| {
                let (value, range) = state(document, &name)?;
                Some(Handle { own: k < count, direction, value, range, name })
            })
            .collect();
        drag.own.retain(|n| handles.iter().any(|h| h.name == *n));
        if handles.is_empty() {
            return Err(format!("`{object}` cannot be dragged: no number of this text moves it"));
        }
        Ok((drag, handles))
    }

    /// Moves the place as near to `target` as the numbers take it.
    ///
    /// # Errors
    /// Why nothing moves.
    pub fn to(
        &mut self,
        document: &mut Document,
        target: Vec3,
        basis: &[Vec3],
        names: &[String],
        grain: f64,
    ) -> Result<Reached, String> {
        let names = if names.is_empty() { self.own.clone() } else { names.to_vec() };
        if names.is_empty() {
            return Err("choose a parameter to move".into());
        }
        let direct = names.iter().all(|n| self.own.contains(n));
        for name in &names {
            self.keep(document, name)?;
        }
        let left = |place: Vec3| basis.iter().map(|b| b.dot(target - place)).collect::<Vec<_>>();
        let size = |r: &[f64]| r.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut place = self.place(document)?;
        let mut refused = None;
        for _ in 0..ROUNDS {
            let residual = left(place);
            if size(&residual) <= (1e-3 * grain).max(1e-12 * (1.0 + target.norm())) {
                break;
            }
            let states: Vec<_> =
                names.iter().map(|n| state(document, n)).collect::<Option<_>>().ok_or("gone")?;
            let directions = self.directions(document, &names)?;
            let widths: Vec<f64> =
                states.iter().map(|(_, r)| r.map_or(1.0, |(a, b)| b - a)).collect();
            let rows: Vec<Vec<f64>> = directions
                .iter()
                .zip(&widths)
                .map(|(d, w)| basis.iter().map(|b| b.dot(*d) * w).collect())
                .collect();
            let Some(step) = damped(&rows, &residual, DAMPING[usize::from(!direct)]) else { break };
            let before: Vec<f64> = states.iter().map(|(x, _)| *x).collect();
            let mut share = 1.0;
            let mut better = false;
            for _ in 0..5 {
                let next = states.iter().zip(&step).zip(&widths).zip(&names);
                let values: Vec<(String, f64)> = next
                    .map(|((((x, range), s), w), name)| {
                        let new = x + share * s * w;
                        (name.clone(), range.map_or(new, |(a, b)| new.clamp(a, b)))
                    })
                    .collect();
                match document.set(&values) {
                    Ok(_) => match self.place(document) {
                        Ok(now) if size(&left(now)) < size(&residual) => {
                            place = now;
                            better = true;
                        }
                        _ => refused = None,
                    },
                    Err(diagnostics) => refused = diagnostics.first().map(|d| d.message.clone()),
                }
                if better {
                    break;
                }
                share *= 0.5;
            }
            if !better {
                let back: Vec<_> = names.iter().cloned().zip(before).collect();
                let _ = document.set(&back);
                break;
            }
        }
        let place = self.rounded(document, &names, grain).unwrap_or(place);
        let reached = size(&left(place));
        let values: Vec<(String, f64)> =
            names.iter().filter_map(|n| Some((n.clone(), state(document, n)?.0))).collect();
        match refused {
            Some(why) if values.iter().zip(&self.moved).all(|(a, b)| a == b) => Err(why),
            _ => Ok(Reached { place, left: reached, values }),
        }
    }

    /// Rounds the numbers to what a picture point is worth; one that has hardly moved stays as it was.
    fn rounded(&self, document: &mut Document, names: &[String], grain: f64) -> Option<Vec3> {
        if grain.is_nan() || grain <= 0.0 {
            return None;
        }
        let directions = self.directions(document, names).ok()?;
        let mut values = Vec::new();
        for (name, direction) in names.iter().zip(directions) {
            let (now, range) = state(document, name)?;
            let (_, begin) = self.moved.iter().find(|(n, _)| n == name)?;
            let worth = grain / direction.norm().max(f64::MIN_POSITIVE);
            let rounded = round_to(now, worth);
            let rounded = range.map_or(rounded, |(a, b)| rounded.clamp(a, b));
            let value = if (now - begin).abs() < 0.5 * worth { *begin } else { rounded };
            values.push((name.clone(), value));
        }
        document.set(&values).ok()?;
        self.place(document).ok()
    }

    /// Remembers what a number was before the drag, so that its end finds what has changed.
    ///
    /// # Errors
    /// That there is no such number.
    pub fn keep(&mut self, document: &Document, name: &str) -> Result<(), String> {
        if !self.moved.iter().any(|(n, _)| n == name) {
            let (value, _) = state(document, name).ok_or(format!("no number `{name}`"))?;
            self.moved.push((name.into(), value));
        }
        Ok(())
    }

    /// The numbers that are not what they were before the drag, and their values.
    pub fn changed(&self, document: &Document) -> Vec<(String, f64)> {
        let now = |name: &str| state(document, name).map(|(x, _)| x);
        let changed = self.moved.iter().filter_map(|(name, before)| {
            let x = now(name).filter(|x| x != before)?;
            Some((name.clone(), x))
        });
        changed.collect()
    }

    fn place(&self, document: &mut Document) -> Result<Vec3, String> {
        let value = document.eval(&self.expression);
        position(value.map_err(|d| d.first().map_or("no value".into(), |d| d.message.clone()))?)
            .ok_or_else(|| format!("`{}` is not at a place", self.object))
    }

    fn directions(&self, document: &mut Document, by: &[String]) -> Result<Vec<Vec3>, String> {
        let derived = document.derivatives(std::slice::from_ref(&self.expression), by);
        let mut derived =
            derived.map_err(|d| d.first().map_or("no derivative".into(), |d| d.message.clone()))?;
        let column = derived.pop().unwrap_or_default();
        Ok(column.into_iter().map(|v| position(v).unwrap_or(Vec3::zero())).collect())
    }
}

fn position(value: Value<f64>) -> Option<Vec3> {
    match value {
        Value::Point(p) => Some(p.xyz),
        Value::Vector(v) => Some(v),
        _ => None,
    }
    .filter(|p| p.is_finite())
}

/// A number near `x` with as few digits as `worth` allows: a multiple of a power of ten.
pub fn round_to(x: f64, worth: f64) -> f64 {
    if !(worth > 0.0 && worth.is_finite() && x.is_finite()) {
        return x;
    }
    let decimals = (-libm::log10(worth)).ceil();
    if !(-15.0..=15.0).contains(&decimals) {
        return x;
    }
    // Through its decimal spelling, so that the nearest number to it comes out.
    if decimals >= 0.0 {
        return format!("{x:.*}", decimals as usize).parse().map_or(x, |y: f64| y + 0.0);
    }
    let unit = 10f64.powi(-decimals as i32);
    (x / unit).round() * unit + 0.0
}

/// The numbers of an object that a hand may change, by their names.
pub fn own_numbers(document: &Document, object: &str) -> Vec<String> {
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
    names.retain(|name| document.settable(name).is_ok());
    names
}

/// The value and range of a parameter or a number of an object.
pub fn state(document: &Document, name: &str) -> Option<(f64, Option<(f64, f64)>)> {
    if let Some(p) = document.params().iter().find(|p| p.name == name) {
        return Some((p.value, p.range));
    }
    let graph = document.graph();
    let dots = name.char_indices().rev().filter(|(_, c)| *c == '.').map(|(k, _)| name.split_at(k));
    let (object, path) =
        dots.filter_map(|(o, path)| Some((graph.get(graph.find(o)?)?, &path[1..]))).next()?;
    let (field, component) = path.split_once('.').map_or((path, None), |(f, c)| (f, Some(c)));
    let at = object.row.field(field)?;
    let row = &object.row.fields[at];
    let range = row.min.zip(row.max).filter(|(a, b)| a.is_finite() && b.is_finite());
    let value = match (&object.args[at], component) {
        (Value::Number(x), None) => *x,
        (Value::Vector(v), Some("x")) => v.x,
        (Value::Vector(v), Some("y")) => v.y,
        (Value::Vector(v), Some("z")) => v.z,
        _ => return None,
    };
    Some((value, range))
}

/// The step y of least |rows^T y - residual|^2 + damping |y|^2; `None` when nothing moves anything.
fn damped(rows: &[Vec<f64>], residual: &[f64], damping: f64) -> Option<Vec<f64>> {
    let n = rows.len();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let trace: f64 = rows.iter().map(|r| dot(r, r)).sum();
    if trace.is_nan() || trace <= 0.0 {
        return None;
    }
    let mut a: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut row: Vec<f64> = (0..n).map(|j| dot(&rows[i], &rows[j])).collect();
            row[i] += damping * trace;
            row.push(dot(&rows[i], residual));
            row
        })
        .collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))?;
        a.swap(k, pivot);
        if a[k][k] == 0.0 {
            return None;
        }
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            for j in k..=n {
                a[i][j] -= factor * a[k][j];
            }
        }
    }
    let mut y = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| a[k][j] * y[j]).sum();
        y[k] = (a[k][n] - known) / a[k][k];
    }
    y.iter().all(|x| x.is_finite()).then_some(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_to_what_matters() {
        assert_eq!(round_to(1.200_000_000_000_2, 0.02), 1.2);
        assert_eq!(round_to(1234.4, 30.0), 1230.0);
        assert_eq!(round_to(-0.004, 0.02), 0.0);
        assert_eq!(round_to(0.123_456, 0.0), 0.123_456);
    }

    #[test]
    fn the_step_is_that_of_least_squares() {
        // Two directions in the plane: exact without damping.
        let y = damped(&[vec![2.0, 0.0], vec![1.0, 1.0]], &[3.0, 1.0], 0.0).unwrap();
        assert!((y[0] - 1.0).abs() < 1e-12 && (y[1] - 1.0).abs() < 1e-12);
        // One number along one axis: the other part is left.
        let y = damped(&[vec![0.0, 4.0]], &[7.0, 2.0], 0.0).unwrap();
        assert!((y[0] - 0.5).abs() < 1e-12);
        assert!(damped(&[vec![0.0, 0.0]], &[1.0, 1.0], 1e-3).is_none());
    }
}
