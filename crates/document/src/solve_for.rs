//! Target values for numbers of the model: chosen parameters are adjusted with exact derivatives.
//!
//! `hydrostatics.volume = 130 and hydrostatics.lcb = 5.9 by beam, depth and draft`: of all values
//! within the ranges that give these numbers, those of the least weighted change ([`follow`]). An
//! unreachable target is an error that states the reachable range.

use crate::document::Document;
use crate::follow::{Conditions, FollowSearch, Followed, FollowingNumber, follow};
use moldloft_diag::Diagnostic;
use moldloft_registry::Value;

/// A number of the model and its target.
#[derive(Clone, Debug, PartialEq)]
pub struct WantedNumber {
    /// The number as an expression.
    pub expression: String,
    /// The target value.
    pub value: f64,
}

/// A parameter, or a number of an object, that may change.
#[derive(Clone, Debug, PartialEq)]
pub struct Adjustable {
    /// Its name.
    pub name: String,
    /// Weight of its change over its range.
    pub weight: f64,
    /// The value from which its change is measured; by default the current one.
    pub home: Option<f64>,
}

/// An adjusted number.
#[derive(Clone, Debug, PartialEq)]
pub struct Adjustment {
    /// Its name.
    pub name: String,
    /// Its value before.
    pub before: f64,
    /// Its value now.
    pub after: f64,
    /// Its fraction of the weighted change, 0 to 1.
    pub share: f64,
}

/// Result of an adjustment.
#[derive(Clone, Debug, PartialEq)]
pub struct SolvedNumbers {
    /// The adjusted numbers.
    pub adjustments: Vec<Adjustment>,
    /// The values of the targets' expressions.
    pub reached: Vec<f64>,
    /// Number of steps.
    pub steps: usize,
}

/// Tolerance of a target, relative to its value or to the effect of the numbers on it.
const ACCURACY: f64 = 1e-8;

/// Maximum number of steps of one search.
const MOST_STEPS: usize = 40;

/// Rounding of the adjusted numbers, relative to their ranges.
const DIGITS: f64 = 1e-11;

/// Extent of the search for the ends of a reachable range, in multiples of the linear prediction.
const BEYOND: f64 = 3.0;

/// Weight of the target whose range is searched for, relative to the other targets, which are held.
const GIVES_WAY: f64 = 1e-3;

/// Relative tolerance within which the other targets are held.
const HELD: f64 = 1e-4;

struct Wish<'a> {
    document: &'a mut Document,
    names: &'a [String],
    expressions: &'a [String],
    values: Vec<f64>,
}

impl Conditions for Wish<'_> {
    fn at(&mut self, x: &[f64]) -> Result<Vec<f64>, String> {
        let assignments: Vec<(String, f64)> =
            self.names.iter().cloned().zip(x.iter().copied()).collect();
        let said = |d: Vec<Diagnostic>| d.first().map_or(String::new(), |d| d.message.clone());
        self.document.set(&assignments).map_err(said)?;
        let numbers = self.document.numbers(self.expressions).map_err(said)?;
        Ok(numbers.iter().zip(&self.values).map(|(x, value)| x - value).collect())
    }

    fn slopes(&mut self) -> Result<Vec<Vec<f64>>, String> {
        let said = |d: Vec<Diagnostic>| d.first().map_or(String::new(), |d| d.message.clone());
        let rows = self.document.derivatives(self.expressions, self.names).map_err(said)?;
        let number = |v: &Value<f64>| if let Value::Number(x) = v { *x } else { f64::NAN };
        Ok(rows.iter().map(|row| row.iter().map(number).collect()).collect())
    }
}

impl Document {
    /// Brings numbers of the model to `targets` by the least weighted change of the numbers `by`
    /// within their ranges, and sets these as [`Document::set`] does.
    ///
    /// # Errors
    /// `out-of-reach` with the reachable range if the targets cannot be met, and errors in names
    /// and expressions; the model is then unchanged.
    pub fn solve_for(
        &mut self,
        targets: &[WantedNumber],
        by: &[Adjustable],
    ) -> Result<SolvedNumbers, Vec<Diagnostic>> {
        self.complete()?;
        let expressions: Vec<String> = targets.iter().map(|t| t.expression.clone()).collect();
        let names: Vec<String> = by.iter().map(|a| a.name.clone()).collect();
        let followers = self.followers(targets, by)?;
        self.numbers(&expressions)?;
        let overrides = self.overrides.clone();
        let begin: Vec<f64> =
            names.iter().map(|n| self.number_state(n).map_or(0.0, |s| s.0)).collect();
        let mut wish = Wish {
            document: self,
            names: &names,
            expressions: &expressions,
            values: targets.iter().map(|t| t.value).collect(),
        };
        let mut found = search(&mut wish, &followers, &begin);
        if let Ok(found) = &mut found {
            wish.round(&followers, found);
        }
        match found {
            Ok(found) if missed(targets, &found).is_none() => {
                let reached = found.left.iter().zip(targets).map(|(l, t)| t.value + l).collect();
                let cost = |k: usize| {
                    let f = &followers[k];
                    let change = f.weight * (found.x[k] - f.home) / width(f);
                    change * change
                };
                let total: f64 = (0..names.len()).map(cost).sum();
                let one = |(k, name): (usize, &String)| Adjustment {
                    name: name.clone(),
                    before: followers[k].home,
                    after: found.x[k],
                    share: if total > 0.0 { cost(k) / total } else { 0.0 },
                };
                let adjustments = names.iter().enumerate().map(one).collect();
                Ok(SolvedNumbers { adjustments, reached, steps: found.steps })
            }
            found => {
                let fault = wish.refusal(targets, &followers, &begin, found);
                let back: Vec<(String, f64)> = names.iter().cloned().zip(begin).collect();
                let _ = self.set(&back);
                if self.overrides != overrides {
                    self.overrides = overrides;
                    self.run();
                }
                Err(vec![fault])
            }
        }
    }

    /// The values of numeric expressions.
    fn numbers(&mut self, expressions: &[String]) -> Result<Vec<f64>, Vec<Diagnostic>> {
        let mut numbers = Vec::with_capacity(expressions.len());
        for text in expressions {
            match self.eval(text)? {
                Value::Number(x) => numbers.push(x),
                other => {
                    use moldloft_lang::value::variables::Called as _;
                    let message = format!("`{text}` is not a number");
                    let fault = Diagnostic::error("not-a-number", message)
                        .expected("an expression with a number as value, such as `hull.volume`")
                        .found(other.called());
                    return Err(vec![fault]);
                }
            }
        }
        Ok(numbers)
    }

    /// The value and range of a parameter or of a number of an object.
    pub fn number_state(&self, name: &str) -> Option<(f64, Option<(f64, f64)>)> {
        if let Some(p) = self.params().iter().find(|p| p.name == name) {
            return Some((p.value, p.range));
        }
        self.object_number(name)
    }

    fn followers(
        &self,
        targets: &[WantedNumber],
        by: &[Adjustable],
    ) -> Result<Vec<FollowingNumber>, Vec<Diagnostic>> {
        let mut faults = Vec::new();
        for target in targets.iter().filter(|t| !t.value.is_finite()) {
            let message = format!("`{}` cannot be {}", target.expression, target.value);
            faults.push(Diagnostic::error("not-finite", message).expected("a finite number"));
        }
        if targets.is_empty() || by.is_empty() {
            let missing = if targets.is_empty() { "no target" } else { "nothing that may change" };
            let fault = Diagnostic::error("nothing-to-solve", format!("there is {missing}"));
            faults.push(fault.expected("targets, and the parameters that may change"));
        }
        let mut followers = Vec::new();
        for (k, a) in by.iter().enumerate() {
            let param = self.params().iter().find(|p| p.name == a.name);
            if param.is_none()
                && let Err(fault) = self.settable(&a.name)
            {
                faults.push(fault);
                continue;
            }
            let wrong = if param.is_some_and(|p| p.is_int) {
                Some("is a whole number and cannot follow smoothly")
            } else if by[..k].iter().any(|b| b.name == a.name) {
                Some("is given twice")
            } else if !(a.weight.is_finite() && a.weight > 0.0) {
                Some("has a weight that is not positive")
            } else {
                None
            };
            if let Some(wrong) = wrong {
                let message = format!("`{}` {wrong}", a.name);
                faults.push(Diagnostic::error("cannot-follow", message));
            }
            let Some((value, range)) = self.number_state(&a.name) else { continue };
            let home = a.home.filter(|h| h.is_finite()).unwrap_or(value);
            followers.push(FollowingNumber { home, range, weight: a.weight });
        }
        if faults.is_empty() { Ok(followers) } else { Err(faults) }
    }
}

fn width(f: &FollowingNumber) -> f64 {
    match f.range {
        Some((low, high)) if high > low => high - low,
        _ if f.home != 0.0 => f.home.abs(),
        _ => 1.0,
    }
}

/// Searches from the current values, and if that fails from the middle of the ranges.
fn search(
    wish: &mut Wish<'_>,
    followers: &[FollowingNumber],
    begin: &[f64],
) -> Result<Followed, String> {
    let equal = vec![1.0; wish.values.len()];
    let no_effect = no_effect(&wish.values);
    let how = FollowSearch {
        importance: &equal,
        alike: false,
        no_effect: &no_effect,
        enough: 0.0,
        steps: MOST_STEPS,
    };
    let first = follow(wish, followers, begin, how);
    let values = wish.values.clone();
    let off = |f: &Followed| -> f64 {
        let one = |((l, v), r): ((&f64, &f64), &f64)| (l / v.abs().max(*r).max(1e-300)).abs();
        f.left.iter().zip(&values).zip(&f.reach).map(one).fold(0.0, f64::max)
    };
    if first.as_ref().is_ok_and(|f| off(f) <= ACCURACY) {
        return first;
    }
    let middle: Vec<f64> = followers
        .iter()
        .zip(begin)
        .map(|(f, x)| f.range.map_or(*x, |(low, high)| 0.5 * (low + high)))
        .collect();
    let second = follow(wish, followers, &middle, how);
    match (first, second) {
        (Ok(a), Ok(b)) => {
            let better = if off(&b) < off(&a) { b } else { a };
            wish.at(&better.x)?;
            Ok(better)
        }
        (Err(_), Ok(b)) => Ok(b),
        (a, _) => a,
    }
}

/// Effects that are within the tolerance of the targets.
fn no_effect(values: &[f64]) -> Vec<f64> {
    values.iter().map(|v| ACCURACY * v.abs()).collect()
}

/// The target with the largest miss, if any is missed.
fn missed(targets: &[WantedNumber], found: &Followed) -> Option<usize> {
    let off = |k: usize| {
        let scale = targets[k].value.abs().max(found.reach.get(k).copied().unwrap_or(0.0));
        if found.left[k] == 0.0 { 0.0 } else { (found.left[k] / scale).abs() }
    };
    let worst = (0..targets.len()).max_by(|a, b| off(*a).total_cmp(&off(*b)))?;
    // NaN compares as missed.
    if off(worst) <= ACCURACY { None } else { Some(worst) }
}

impl Wish<'_> {
    /// Rounds the numbers to the digits that matter.
    fn round(&mut self, followers: &[FollowingNumber], found: &mut Followed) {
        let rounded: Vec<f64> = followers
            .iter()
            .zip(&found.x)
            .map(|(f, x)| {
                if *x == f.home {
                    return *x;
                }
                let x = round_to(*x, DIGITS * width(f));
                f.range.map_or(x, |(low, high)| x.clamp(low, high))
            })
            .collect();
        match self.at(&rounded) {
            Ok(left) => (found.x, found.left) = (rounded, left),
            Err(_) => {
                let _ = self.at(&found.x);
            }
        }
    }

    /// The error for missed targets: the reachable range of the worst one with the others held.
    fn refusal(
        &mut self,
        targets: &[WantedNumber],
        followers: &[FollowingNumber],
        begin: &[f64],
        found: Result<Followed, String>,
    ) -> Diagnostic {
        let names = self.names.join(", ");
        let worst = found.as_ref().ok().and_then(|f| missed(targets, f)).unwrap_or(0);
        let t = &targets[worst];
        let message = format!("`{}` = {} is out of reach of {names}", t.expression, t.value);
        let fault = Diagnostic::error("out-of-reach", message);
        let found = match found {
            Ok(found) => found,
            Err(why) => return fault.found(why),
        };
        if found.reach[worst] == 0.0 {
            return fault
                .found(format!("no effect of {names} on it"))
                .help("choose parameters that change it");
        }
        let fault = match &found.refused {
            Some(why) if !why.is_empty() => fault.note(format!("on the way there: {why}")),
            _ => fault,
        };
        let held: Vec<&str> = (0..targets.len())
            .filter(|k| *k != worst)
            .map(|k| targets[k].expression.as_str())
            .collect();
        let held =
            if held.is_empty() { String::new() } else { format!(" with {} held", held.join(", ")) };
        let bounded = followers.iter().all(|f| f.range.is_some());
        let ends = if bounded { self.ends(worst, followers, begin, &found.reach) } else { None };
        match ends {
            Some((low, high)) => fault
                .expected(format!("a value from {} to {}{held}", short(low), short(high)))
                .found(t.value.to_string())
                .help("widen a range, or let further parameters follow"),
            None if bounded => fault
                .found(format!("{} at the smallest residual", short(t.value + found.left[worst])))
                .help("these targets contradict each other within the ranges: give one up, widen a range, or let further parameters follow"),
            None => fault
                .found(format!("{} where the search ended", short(t.value + found.left[worst])))
                .help("give the parameters ranges, or begin nearer to it"),
        }
    }

    /// Minimum and maximum found for a target, with the others held.
    fn ends(
        &mut self,
        at: usize,
        followers: &[FollowingNumber],
        begin: &[f64],
        reach: &[f64],
    ) -> Option<(f64, f64)> {
        let wished = self.values.clone();
        let importance: Vec<f64> =
            (0..wished.len()).map(|k| if k == at { GIVES_WAY } else { 1.0 }).collect();
        let no_effect = no_effect(&wished);
        let how = FollowSearch {
            importance: &importance,
            alike: false,
            no_effect: &no_effect,
            enough: 0.0,
            steps: MOST_STEPS,
        };
        let mut ends = [None; 2];
        for (end, sign) in ends.iter_mut().zip([-1.0, 1.0]) {
            let step = BEYOND * reach[at].max(wished[at].abs());
            self.values[at] = wished[at] + sign * step;
            let mut x = begin.to_vec();
            // The second search starts from the result of the first.
            for _ in 0..2 {
                let Ok(found) = follow(self, followers, &x, how) else { break };
                x = found.x;
                let held = found
                    .left
                    .iter()
                    .zip(&wished)
                    .zip(reach)
                    .enumerate()
                    .all(|(k, ((l, v), r))| k == at || l.abs() <= HELD * v.abs().max(*r));
                *end = held.then(|| self.values[at] + found.left[at]);
            }
        }
        self.values = wished;
        match ends {
            [Some(a), Some(b)] => Some((a.min(b), a.max(b))),
            _ => None,
        }
    }
}

fn short(x: f64) -> String {
    round_to(x, 1e-6 * x.abs()).to_string()
}

/// `x` rounded to a multiple of a power of ten not larger than `worth`.
pub fn round_to(x: f64, worth: f64) -> f64 {
    if !(worth > 0.0 && worth.is_finite() && x.is_finite()) {
        return x;
    }
    // -log10(worth), rounded up.
    let spelled = format!("{worth:e}");
    let power = spelled.split_once('e').and_then(|(_, power)| power.parse::<i32>().ok());
    let Some(decimals) = power.map(|p| -p).filter(|d| (-15..=15).contains(d)) else { return x };
    // By way of decimal text, so that the result is the nearest float to the decimal number.
    if decimals >= 0 {
        return format!("{x:.*}", decimals as usize).parse().map_or(x, |y: f64| y + 0.0);
    }
    let unit = 10f64.powi(-decimals);
    (x / unit).round() * unit + 0.0
}
