//! Volume, centroid and inertia: certified brackets, and best values within them.
//!
//! Best values are those of curved facets, which have the most digits if they show the whole set.
//! If a part is thinner than their cells, or their volume is outside the bracket, the certified
//! cells are better. With blunt edges, as in the cusp between a cylinder and a tangent plane,
//! facets may agree with each other on a wrong value: then a narrower bracket decides, and the
//! uncertainty is reported.

use super::certified::{Certified, Effort, certified};
use super::curved::Curved;
use super::moments::Moments;
use crate::expr::interval::Interval;
use crate::facet::memo::FacetMemo;
use crate::facet::sheets::solid_part;
use crate::facet::types::TriangleView;
use crate::facet::{FacetOptions, Facets, Resolution};
use crate::{FieldError, Lifter, Primitive, Set};
use moldloft_budget::Budget;
use moldloft_num::{Box3, Real, Vec3};
use moldloft_registry::Remark;
use std::sync::Arc;

/// Boxes may be halved this often at most.
const DEEPEST: u32 = 12;
const MOST_CELLS: usize = 30_000_000;
/// Cells of the bracket that every best value is checked by.
const CHECK: usize = 3000;
/// Number of cells for best values without facets.
const THIN: usize = 120_000;
/// Coarsest and finest level of facets for best values, and their maximum number of cells.
const LEVELS: [u32; 2] = [5, 9];
const MOST_FACET_CELLS: usize = 400_000;
/// Finest level for parts that are thin along a line only, such as a rod: the number of cells stays
/// small.
const FINEST: u32 = 15;
/// Default agreement of two best values, relative to the box's volume.
const USUAL: f64 = 1e-8;

/// Certified brackets of the moments of a set within a box, from boxes halved at most `depth` times
/// along each axis; convergence is of second order, including edges and thin walls.
///
/// # Errors
/// A box without volume, a depth above 12.
///
/// # Example
/// ```
/// use moldloft_field::{Primitive, Set, bracket};
/// use moldloft_num::{Box3, Vec3};
///
/// let ball = Set::new(&Primitive::sphere(Vec3::zero(), 1.0)?);
/// let over = Box3 { low: Vec3::of(-1.1, -1.1, -1.1), high: Vec3::of(1.1, 1.1, 1.1) };
/// let volume = bracket(&ball, &over, 6)?.volume();
/// assert!(volume.contains(4.0 / 3.0 * std::f64::consts::PI) && volume.width() < 0.01);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn bracket(set: &Set, over: &Box3, depth: u32) -> Result<Moments<Interval>, FieldError> {
    Ok(certified(set, over, &effort(depth)?, &Budget::default())?.bracket)
}

fn effort(depth: u32) -> Result<Effort, FieldError> {
    if depth > DEEPEST {
        let boxes = |d: u32| 4f64.powi(d as i32);
        return Err(FieldError::TooFine { boxes: boxes(depth), limit: boxes(DEEPEST) });
    }
    Ok(Effort { accuracy: 0.0, cells: MOST_CELLS, depth })
}

/// Options of integrals.
#[derive(Clone, Default)]
pub struct IntegralOptions {
    /// Maximum number of halvings of the bracket's boxes; the default suffices for a few thousand
    /// boxes.
    pub depth: Option<u32>,
    /// Maximum proved distance of the volume from its best value.
    pub accuracy: Option<f64>,
    /// Maximum number of cells for that accuracy; default 400 000.
    pub cells: Option<usize>,
    /// Agreement of the volumes of two levels of facets; default: 1e-8 of the box's volume.
    pub agreement: Option<f64>,
    /// Limits of memory and time.
    pub budget: Arc<Budget>,
}

impl IntegralOptions {
    /// With a bracket of boxes halved this number of times.
    pub fn to_depth(depth: u32) -> Self {
        Self { depth: Some(depth), ..Self::default() }
    }

    /// With a volume proved to be within this distance of its best value.
    pub fn to_accuracy(accuracy: f64) -> Self {
        Self { accuracy: Some(accuracy), ..Self::default() }
    }
}

/// A bracket and the best value inside it.
#[derive(Clone, Debug, PartialEq)]
pub struct BracketedMass<T: Real = f64> {
    /// Proved.
    pub bracket: Moments<Interval>,
    /// Within the bracket.
    pub best: Moments<T>,
    /// Proved bound on the distance of the exact volume from the best one.
    pub uncertain: f64,
    /// Difference of the best volumes of two levels of facets, including possible misses: an
    /// estimate of the error, not a bound; 0 if they agree as requested.
    pub estimate: f64,
}

impl<T: Real> BracketedMass<T> {
    fn of(bracket: Moments<Interval>, best: Moments<T>, estimate: f64) -> Self {
        let (range, volume) = (bracket.volume(), best.volume().re());
        let uncertain = (range.high - volume).max(volume - range.low).max(0.0);
        Self { bracket, best, uncertain, estimate: estimate.min(uncertain) }
    }

    /// Warning about a volume, and values derived from it, that misses the requested accuracy
    /// (default: six digits).
    pub fn doubt(&self, accuracy: Option<f64>) -> Option<Remark> {
        let enough = accuracy.unwrap_or(1e-6 * self.best.volume().re().abs());
        (self.estimate > enough).then(|| Remark {
            id: "volume-uncertain",
            message: format!("the volume is accurate to {:.1e} only", self.uncertain),
            advice: "edges thinner than its cells limit the accuracy; `volume_bracket` with a greater depth is narrower, \
                     and a greater `accuracy` accepts this result",
        })
    }
}

/// The moments of a set within a box: a proved bracket, and the best value inside it.
///
/// # Errors
/// As [`bracket`] and [`crate::facet`]; [`FieldError::NotReached`] when the accuracy would need more cells than
/// allowed.
pub fn mass(
    set: &Set,
    over: &Box3,
    measure: &IntegralOptions,
) -> Result<BracketedMass, FieldError> {
    mass_of(set, over, None, measure, &FacetMemo::default())
}

/// As `mass`, for a set and a box whose numbers may carry derivatives; facets are taken from the
/// memo.
///
/// # Errors
/// As [`mass`].
pub fn mass_of<T: Real>(
    set: &Set<T>,
    over: &Box3,
    corners: Option<[Vec3<T>; 2]>,
    measure: &IntegralOptions,
    memo: &FacetMemo,
) -> Result<BracketedMass<T>, FieldError> {
    let plain = set.re();
    let solid = solid_part(&plain);
    let budget = &measure.budget;
    let wanted = match (measure.depth, measure.accuracy) {
        (_, Some(accuracy)) => {
            let width = 2.0 * crate::error::positive("accuracy", accuracy)?;
            Effort { cells: measure.cells.unwrap_or(Effort::to(width).cells), ..Effort::to(width) }
        }
        (Some(depth), None) => effort(depth)?,
        (None, None) => Effort::of_cells(CHECK),
    };
    let checked = certified(&solid, over, &wanted, budget)?;
    let width = checked.bracket.volume().width();
    if let Some(accuracy) = measure.accuracy
        && width > 2.0 * accuracy
    {
        return Err(FieldError::NotReached {
            asked: accuracy,
            reached: 0.5 * width,
            cells: checked.cells,
        });
    }
    let bracket = checked.bracket;
    let lifter = Lifter::of(set, &plain, corners);
    let from_cells = |cells: &Certified, bracket: &Moments<Interval>| {
        let leaves = cells.leaves();
        let lifted: Vec<Option<Primitive<T>>> =
            leaves.iter().map(|l| lifter.primitive(l)).collect();
        within(cells.best_by(&|leaf| lifted[leaf as usize].clone()), bracket)
    };
    // Bodies of planes are known to rounding.
    let size = (0..3).map(|k| over.high[k] - over.low[k]).product::<f64>();
    let exact = width <= 1e-3 * measure.agreement.unwrap_or(USUAL * size);
    if exact && corners.is_none() {
        return Ok(BracketedMass::of(bracket, from_cells(&checked, &bracket), 0.0));
    }
    let faceted = by_facets(&solid, over, &lifter, measure, memo, &bracket)?;
    if let Some(Faceted { moments, settled: true, .. }) = faceted {
        return Ok(BracketedMass::of(bracket, within(moments, &bracket), 0.0));
    }
    // Parts that facets do not show, or not as well as requested.
    let thin = match checked.cells >= THIN {
        true => checked,
        false => certified(&solid, over, &Effort::of_cells(THIN), budget)?,
    };
    let bracket = narrower(bracket, &thin);
    let (range, agreement) = (bracket.volume(), measure.agreement.unwrap_or(USUAL * size));
    let half = 0.5 * range.width();
    // Values that agree are taken where the narrower bracket holds them, too.
    if let Some(Faceted { moments, change, .. }) = faceted
        && range.contains(moments.volume().re())
        && change < half
    {
        let estimate = if change <= agreement { 0.0 } else { change };
        return Ok(BracketedMass::of(bracket, within(moments, &bracket), estimate));
    }
    let estimate = if half <= agreement { 0.0 } else { half };
    Ok(BracketedMass::of(bracket, from_cells(&thin, &bracket), estimate))
}

/// The numbers of both brackets.
fn narrower(mut bracket: Moments<Interval>, other: &Certified) -> Moments<Interval> {
    for (a, b) in bracket.terms.iter_mut().zip(&other.bracket.terms) {
        *a = a.meet(*b);
    }
    bracket
}

/// The best values with their real parts inside the bracket.
fn within<T: Real>(mut best: Moments<T>, bracket: &Moments<Interval>) -> Moments<T> {
    for (x, range) in best.terms.iter_mut().zip(&bracket.terms) {
        let inside = x.re().clamp(range.low, range.high);
        let old = *x;
        *x = T::from_parts(|k| if k == 0 { inside } else { old.part(k) });
    }
    best
}

/// Moments by facets.
struct Faceted<T: Real> {
    moments: Moments<T>,
    /// Difference of the volumes of the last two levels, and the possible misses of the last.
    change: f64,
    /// True if these agree as well as requested, and no edge is blunt.
    settled: bool,
}

/// Moments from facets that are made finer until two agree; `None` when these do not show the set.
fn by_facets<T: Real>(
    solid: &Set,
    over: &Box3,
    lifter: &Lifter<T>,
    measure: &IntegralOptions,
    memo: &FacetMemo,
    bracket: &Moments<Interval>,
) -> Result<Option<Faceted<T>>, FieldError> {
    let size = (0..3).map(|k| over.high[k] - over.low[k]).product::<f64>();
    let agreement = match measure.agreement {
        Some(a) => crate::error::positive("accuracy", a)?,
        None => USUAL * size,
    };
    let mut before: Option<(Arc<Facets>, f64)> = None;
    let mut change = f64::INFINITY;
    let mut complete = false;
    for level in LEVELS[0]..=FINEST {
        let options = FacetOptions {
            sharp: true,
            budget: measure.budget.clone(),
            ..FacetOptions::new(Resolution::Level(level))
        };
        let facets = match memo.facet(solid, over, &options) {
            // The coarser levels are the result.
            Err(FieldError::TooFine { .. }) if before.is_some() => break,
            Err(FieldError::TooFine { .. }) => return Ok(None),
            made => made?,
        };
        let places = facets.unresolved.iter().filter(|u| u.missed);
        let (missed, held) = places.fold((0, 0.0), |(n, v), u| (n + 1, v + u.volume));
        let next = 4 * (facets.cells + missed);
        let last = level == FINEST || next > MOST_FACET_CELLS;
        let volume = facets.moments().volume();
        change = before.as_ref().map_or(f64::INFINITY, |(_, v)| (volume - v).abs());
        let enough = change <= agreement;
        before = Some((facets, volume));
        complete = missed == 0;
        if missed > 0 && last {
            // Proved bound of the missed volume.
            change += held;
            break;
        }
        if missed == 0 && (enough || level >= LEVELS[1] || next > MOST_FACET_CELLS) {
            break;
        }
    }
    let Some((facets, volume)) = before else { return Ok(None) };
    let v = bracket.volume();
    // Facets that the bracket refutes show something else.
    let far = (v.low - volume).max(volume - v.high);
    if far > 1e-9 * v.high.max(1e-12 * size) + agreement {
        return Ok(None);
    }
    if facets.mesh.faces().is_empty() {
        let zero = Moments { about: facets.about, terms: [T::zero(); 10] };
        let nothing = Faceted { moments: zero, change: 0.0, settled: true };
        return Ok((complete && (v.high <= agreement || v.low <= 0.0)).then_some(nothing));
    }
    let settled = complete && change <= agreement && facets.blunt.is_empty();
    Ok(Some(Faceted { moments: facets.lifted_by(lifter)?.moments, change, settled }))
}

impl Facets {
    /// The moments of the body, of sixth order in the size of the facets away from its edges, and
    /// of fourth order with small factors along them.
    pub fn moments(&self) -> Moments<f64> {
        let primitives: Vec<Option<Primitive>> =
            self.leaves.iter().map(|l| Some(l.primitive.clone())).collect();
        Curved::new(&self.flat()).moments(self.mesh.positions(), &primitives, self.about)
    }

    /// The area of the set's surface, of the same order as [`Facets::moments`], without faces of
    /// the box.
    pub fn area(&self) -> f64 {
        let primitives: Vec<Option<Primitive>> =
            self.leaves.iter().map(|l| Some(l.primitive.clone())).collect();
        let own = |leaf: u32| (leaf as usize) < self.own_leaves;
        Curved::new(&self.flat()).area(self.mesh.positions(), &primitives, own)
    }

    /// The triangles with the leaves that they and their corners are on.
    pub(crate) fn flat(&self) -> TriangleView<'_> {
        let ranges = self.mesh.patches().iter().zip(&self.patch_leaves);
        TriangleView {
            positions: self.mesh.positions(),
            faces: self.mesh.faces(),
            patches: ranges.map(|(p, &leaf)| (leaf as u32, p.faces.clone())).collect(),
            leaves: &self.leaves,
            surfaces: &self.surfaces,
        }
    }
}
