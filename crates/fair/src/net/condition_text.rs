//! Conditions of networks as texts: `WL 2: straight=3-9`, `WL 2..WL 5 at station 4..station 8: flat`.

use crate::curve::shape_condition::ShapeCondition;
use crate::net::shapes::NetworkCondition;
use moldloft_num::Vec3;

/// Grammar of conditions of networks, for messages.
const GRAMMAR: &str = "a line, several as `WL 2..WL 5`, or where others cross them, as \
                       `WL 2..WL 5 at station 4..station 8`; a colon; and flat, flat:0,1,0 with its normal, \
                       tangent=start:0,1,0, tangent=end:0,1,0, or a shape of a curve such as convex=4-10, \
                       straight:1,0,0, arc=5-9, within=0,1,0:4.6";

/// Curves with the names used in texts.
#[derive(Clone, Copy, Debug)]
pub struct NamedCurves<'a> {
    /// The points of each curve.
    pub curves: &'a [(Vec<usize>, bool)],
    /// Their names; if empty, `curve 1`, `curve 2` and so on.
    pub names: &'a [String],
}

impl NamedCurves<'_> {
    /// Name of a curve.
    pub fn name(&self, curve: usize) -> String {
        self.names.get(curve).cloned().unwrap_or_else(|| format!("curve {}", curve + 1))
    }

    /// The curve called `name`, `curve 3`, or by a number from 1.
    ///
    /// # Errors
    /// A text with the expected form.
    pub fn find(&self, name: &str) -> Result<usize, String> {
        let name = name.trim();
        if let Some(k) = self.names.iter().position(|own| own == name) {
            return Ok(k);
        }
        let number = name.strip_prefix("curve ").unwrap_or(name).trim().parse::<usize>();
        let count = self.curves.len();
        match number {
            Ok(k) if (1..=count).contains(&k) => Ok(k - 1),
            _ => Err(format!(
                "expected a curve of the network, {} to {}, found `{name}`",
                self.name(0),
                self.name(count.saturating_sub(1))
            )),
        }
    }

    /// One curve or several in the order of the network, `WL 2..WL 5`.
    fn some(&self, text: &str) -> Result<Vec<usize>, String> {
        if text.trim() == "all" {
            return Ok((0..self.curves.len()).collect());
        }
        if let Some((first, last)) = text.split_once("..") {
            let (a, b) = (self.find(first)?, self.find(last)?);
            return Ok((a.min(b)..=a.max(b)).collect());
        }
        Ok(vec![self.find(text)?])
    }
}

impl NetworkCondition {
    /// Reads conditions in the notation of command and language: one for each curve, or one for a
    /// flat.
    ///
    /// # Errors
    /// A text with the expected form.
    ///
    /// # Example
    /// ```
    /// use moldloft_fair::{NamedCurves, NetworkCondition, ShapeCondition};
    /// let curves = [(vec![0, 1, 2, 3], false), (vec![4, 1, 5, 6], false), (vec![7, 2, 8, 9], false)];
    /// let names = ["WL 1", "station 1", "station 2"].map(String::from);
    /// let named = NamedCurves { curves: &curves, names: &names };
    /// let made = NetworkCondition::read("WL 1 at station 1..station 2: straight:1,0,0", named);
    /// let [NetworkCondition::Curve { curve: 0, shape }] = &made.unwrap()[..] else { panic!() };
    /// assert!(matches!(shape, ShapeCondition::Straight { between: [1, 2], .. }));
    /// assert!(NetworkCondition::read("WL 3: convex", named).is_err());
    /// ```
    pub fn read(text: &str, named: NamedCurves<'_>) -> Result<Vec<Self>, String> {
        let wrong = || format!("expected {GRAMMAR}; found `{text}`");
        let (lines, shape) = text.split_once(": ").ok_or_else(wrong)?;
        let shape = shape.trim();
        let (lines, crossing) = match lines.split_once(" at ") {
            Some((lines, crossing)) => (named.some(lines)?, Some(named.some(crossing)?)),
            None => (named.some(lines)?, None),
        };
        let met = |i: usize| {
            let on = |k: &usize| named.curves[*k].0.contains(&i);
            crossing.as_ref().is_none_or(|all| all.iter().any(on))
        };
        let vector = |what: &str| -> Result<Vec3<f64>, String> {
            let all: Result<Vec<f64>, _> = what.split(',').map(|x| x.trim().parse()).collect();
            match all.map_err(|_| wrong())?[..] {
                [x, y] => Ok(Vec3::of(x, y, 0.0)),
                [x, y, z] => Ok(Vec3::of(x, y, z)),
                _ => Err(wrong()),
            }
        };
        if let Some(rest) = shape.strip_prefix("flat") {
            let normal = match rest.strip_prefix(':') {
                Some(normal) => Some(vector(normal)?),
                None if rest.is_empty() => None,
                None => return Err(wrong()),
            };
            let mut points: Vec<usize> = Vec::new();
            for &k in &lines {
                points.extend(named.curves[k].0.iter().filter(|&&i| met(i)));
            }
            points.sort_unstable();
            points.dedup();
            if points.len() < 2 {
                return Err(format!(
                    "`{text}`: expected two points or more, found {}",
                    points.len()
                ));
            }
            return Ok(vec![Self::Flat { points, normal }]);
        }
        if let Some(rest) = shape.strip_prefix("tangent=") {
            let (end, direction) = rest.split_once(':').ok_or_else(wrong)?;
            let at_end = match end.trim() {
                "start" => false,
                "end" => true,
                _ => return Err(wrong()),
            };
            let direction = vector(direction)?;
            return Ok(lines
                .iter()
                .map(|&curve| Self::Tangent { curve, at_end, direction })
                .collect());
        }
        let mut out = Vec::new();
        for &curve in &lines {
            let own = &named.curves[curve].0;
            let mut shape = ShapeCondition::read(shape, own.len())
                .map_err(|_| wrong())
                .map_err(|e| format!("{}: {e}", named.name(curve)))?;
            if crossing.is_some() {
                let places: Vec<usize> = (0..own.len()).filter(|&c| met(own[c])).collect();
                let [first, .., last] = places[..] else { continue };
                if last - first + 1 != places.len() {
                    return Err(format!(
                        "`{text}`: the points of {} there are not neighbours",
                        named.name(curve)
                    ));
                }
                shape = shape.renumbered(|k| if k == 0 { first } else { last });
            }
            out.push(Self::Curve { curve, shape });
        }
        if out.is_empty() {
            return Err(format!("`{text}`: no curve has two points there"));
        }
        Ok(out)
    }
}
