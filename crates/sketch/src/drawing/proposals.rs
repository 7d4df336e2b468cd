//! Types of lines proposed from the whole drawing, with their probabilities.

use crate::drawing::noise::Verdict;
use crate::{CoordinateAxis, Drawing, Free, LineId, LineTypeSource};

/// The type of a line by the judgement of the whole drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct TypeProposal {
    /// The line.
    pub line: LineId,
    /// Its likeliest type.
    pub free: Free,
    /// Probability of the type, 0 to 1.
    pub probability: f64,
    /// Other types with their probabilities, the likeliest first; `None` for inclined lines without a type.
    pub alternatives: Vec<(Option<Free>, f64)>,
}

impl Drawing {
    /// The likeliest types of the lines that the user has not typed, by number.
    pub fn type_proposals(&self) -> Vec<TypeProposal> {
        let mut typed = self.clone();
        typed.type_all();
        let verdicts = self.verdicts();
        let one = |(&id, line): (&LineId, &crate::DrawnLine)| {
            let given = self.lines.get(&id)?;
            let locked = given.source == LineTypeSource::User && given.free.is_some();
            let free = line.free.filter(|_| !locked)?;
            let others = verdicts.get(&id).map(|v| self.others(v, free)).unwrap_or_default();
            let sum: f64 = others.iter().map(|o| o.1).sum();
            let left = 1.0 - line.confidence;
            let mut alternatives: Vec<(Option<Free>, f64)> = others
                .into_iter()
                .map(|(free, weight)| (free, if sum > 0.0 { left * weight / sum } else { 0.0 }))
                .filter(|o| o.1 > 0.0)
                .collect();
            alternatives.sort_by(|a, b| b.1.total_cmp(&a.1));
            Some(TypeProposal { line: id, free, probability: line.confidence, alternatives })
        };
        typed.lines.iter().filter_map(one).collect()
    }

    /// Types other than a given one, with the weight of the evidence of the strokes.
    fn others(&self, verdict: &Verdict, free: Free) -> Vec<(Option<Free>, f64)> {
        let axes = CoordinateAxis::ALL.into_iter().filter(|a| self.section != Some(*a));
        let mut out: Vec<(Option<Free>, f64)> =
            axes.map(|a| (Some(Free::along(a)), verdict.axes[a.index()])).collect();
        let inclined = (1.0 - verdict.axes.iter().sum::<f64>()).max(0.0);
        out.push((self.section.map(Free::across), inclined));
        out.retain(|o| o.0 != Some(free) && (o.0.is_some() || free.single().is_some()));
        out
    }

    /// Types every line that the user has not typed and whose likeliest type has at least the
    /// probability [`Drawing::certainty`]; others have no type. Returns the lines taken as oblique, and
    /// the proposals for those without a type.
    pub fn type_certain(&mut self) -> (Vec<LineId>, Vec<TypeProposal>) {
        let left: Vec<TypeProposal> = match self.certainty > 0.0 {
            true => self.type_proposals(),
            false => vec![],
        };
        let left: Vec<TypeProposal> =
            left.into_iter().filter(|p| p.probability < self.certainty).collect();
        let mut oblique = self.type_all();
        for proposal in &left {
            if let Some(line) = self.lines.get_mut(&proposal.line) {
                (line.free, line.confidence) = (None, 0.0);
                line.source = LineTypeSource::Auto;
            }
        }
        oblique.retain(|id| left.iter().all(|p| p.line != *id));
        (oblique, left)
    }
}
