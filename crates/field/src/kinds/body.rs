//! Facets of a set as a body of triangles.

use super::read::{SetArgument, fault};
use super::region::region;
use crate::facet::sheets::Mixed;
use crate::facet::{FacetOptions, Facets, Resolution};
use crate::{FacetMemo, FieldError, Leaf, Lifter, Set, facet_mixed};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Context, Group, Kind, Point, TriangleBody, Value};
use std::sync::Arc;

/// Facets of that resolution, which stop when the model does or a set has taken its time.
pub fn options(resolution: Resolution, context: &Context) -> FacetOptions {
    FacetOptions { budget: context.budget.for_set(), ..FacetOptions::new(resolution) }
}

/// The surface of a set as triangles: a mesh like any other.
///
/// Each visible primitive gives a patch of panels, named after its set or field (`part.pipe`), with
/// its colour, and its material as a tag. Solids are closed, oriented and manifold; faces of the
/// box close a solid that it cuts (`part.cap -x`). Sheets are open, wires are polylines and points
/// are points. The members `volume` and `centroid` are corrected for the distance of the triangles
/// from the surface.
#[derive(Kind)]
#[kind(
    forward,
    previewed,
    class = Mesh,
    example = "set ball = set(sphere({0, 0, 0}, 1)); SetBody b(ball, depth = 4);"
)]
pub struct SetBody<T: Real> {
    /// The set.
    set: SetArgument<T>,
    /// Low corner of the box; default: bounds of the set, if bounded.
    #[field(default)]
    low: Option<Point<T>>,
    /// High corner of the box.
    #[field(default)]
    high: Option<Point<T>>,
    /// Number of halvings of the longest side of the box; the cells have 2^-depth of its length.
    /// Default: 6, without an accuracy.
    #[field(default, min = 1, max = 16)]
    depth: Option<u32>,
    /// Maximum distance of triangle centres from the surface, reached by refinement, estimated.
    #[field(default)]
    accuracy: Option<T>,
    /// Largest distance from the surface when triangles are merged, in units of length. Default: no
    /// merging.
    #[field(default)]
    simplify: Option<T>,
}

impl<T: Real> Build<T> for SetBody<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let resolution = match (self.depth, self.accuracy) {
            (Some(_), Some(_)) => {
                return Err(CallError::new("argument-twice", "depth and accuracy are both given")
                    .expected("one of them")
                    .in_field(Self::ACCURACY));
            }
            (Some(depth), None) => Resolution::Depth(depth),
            (None, Some(accuracy)) => Resolution::Accuracy(accuracy.re()),
            (None, None) => Resolution::Level(6),
        };
        let set = &self.set.0;
        let plain = set.re();
        if plain.is_nothing() {
            return Err(CallError::new("empty-set", "the set is empty").in_field(Self::SET));
        }
        let region = region(&plain, &self.low, &self.high, [Self::SET, Self::HIGH])?;
        let lifter = Lifter::of(set, &plain, region.corners);
        let simplify = self.simplify.map(T::re);
        let made = |resolution, simplify| {
            facets_of(&plain, &region.over, &options(resolution, context), &context.kept.of())
                .and_then(|pieces| match simplify {
                    Some(accuracy) => pieces.simplified(accuracy),
                    None => Ok(pieces),
                })
                .and_then(|pieces| pieces.body(&lifter))
        };
        // A part that coarser cells do not resolve is shown as it is.
        if let Some(coarser) = coarser(resolution, context.coarser)
            && let Ok(body) = made(coarser, None)
            && body.flaws.is_empty()
            && !body.triangles.is_empty()
        {
            return Ok(Value::Body(Arc::new(body)));
        }
        let body = made(resolution, simplify).map_err(|e| fault(&e))?;
        if body.triangles.is_empty() && body.wires.is_empty() && body.dots.is_empty() {
            if let Some(flaw) = body.flaws.iter().find(|f| f.name == "unresolved") {
                let remark = &flaw.remark;
                return Err(CallError::new(
                    "thin-part",
                    format!("no part of the set is visible: {}", remark.message),
                )
                .expected("a set that is thicker than the cells")
                .help(remark.advice)
                .in_field(Self::SET));
            }
            return Err(CallError::new("empty-set", "the set has no surface in the box")
                .expected("a set whose surface passes through the box")
                .in_field(Self::SET));
        }
        Ok(Value::Body(Arc::new(body)))
    }
}

/// Coarsest level of a preview.
const COARSEST_PREVIEW: u32 = 3;

/// The resolution with cells larger by a number of halvings; `None` if none are.
fn coarser(resolution: Resolution, halvings: u32) -> Option<Resolution> {
    let less = |level: u32| level.saturating_sub(halvings).max(COARSEST_PREVIEW.min(level));
    let coarser = match resolution {
        Resolution::Depth(depth) => Resolution::Depth(less(depth)),
        Resolution::Level(level) => Resolution::Level(less(level)),
        // The distance of a chord from its curve grows with the square of the length.
        Resolution::Accuracy(accuracy) => {
            Resolution::Accuracy(accuracy * 4_f64.powi(halvings.min(16) as i32))
        }
    };
    (coarser != resolution).then_some(coarser)
}

/// The facets of a set: of solids only, or of all dimensions.
#[derive(Clone)]
pub enum Pieces {
    /// Facets of a set without sheets.
    Solid(Arc<Facets>),
    /// Facets of a set with sheets.
    Mixed(Arc<Mixed>),
}

/// The facets of a set within a box, from the memo when they are there.
///
/// # Errors
/// As [`crate::facet`].
fn facets_of(
    set: &Set,
    over: &moldloft_num::Box3,
    options: &FacetOptions,
    memo: &FacetMemo,
) -> Result<Pieces, FieldError> {
    if set.leaves().iter().any(|leaf| leaf.primitive.is_sheet()) {
        Ok(Pieces::Mixed(Arc::new(facet_mixed(set, over, options)?)))
    } else {
        Ok(Pieces::Solid(memo.facet(set, over, options)?))
    }
}

/// Names that were used, so that each is given once.
#[derive(Default)]
struct UniqueNames(std::collections::HashMap<String, usize>);

impl UniqueNames {
    fn of(&mut self, name: &str) -> String {
        let count = self.0.entry(name.to_string()).or_insert(0);
        *count += 1;
        if *count == 1 { name.to_string() } else { format!("{name}.{count}") }
    }
}

impl Pieces {
    /// The body with fewer triangles of its solids; see [`Facets::simplified`].
    ///
    /// # Errors
    /// An accuracy that is not above zero.
    pub fn simplified(self, accuracy: f64) -> Result<Self, FieldError> {
        Ok(match self {
            Pieces::Solid(facets) => Pieces::Solid(Arc::new(facets.simplified(accuracy)?)),
            Pieces::Mixed(mixed) => {
                let solid = mixed.solid.simplified(accuracy)?;
                let (sheets, wires) = (mixed.sheets.clone(), mixed.wires.clone());
                let (points, leaves) = (mixed.points.clone(), mixed.leaves.clone());
                Pieces::Mixed(Arc::new(Mixed { solid, sheets, wires, points, leaves }))
            }
        })
    }

    /// A body whose coordinates carry the derivatives of the set.
    ///
    /// # Errors
    /// A lifter of another set.
    pub fn body<T: Real>(&self, lifter: &Lifter<T>) -> Result<TriangleBody<T>, FieldError> {
        let solid: &Facets = match self {
            Pieces::Solid(facets) => facets,
            Pieces::Mixed(mixed) => &mixed.solid,
        };
        let lifted = solid.lifted_by(lifter)?;
        let mut points: Vec<Vec3<T>> = lifted.mesh.positions().to_vec();
        let mut triangles: Vec<[u32; 3]> = Vec::new();
        let mut groups = Vec::new();
        let mut names = UniqueNames::default();
        let mut take = |mesh: &moldloft_mesh::Mesh, start: u32, leaves: &[&Leaf]| {
            for (patch, leaf) in mesh.patches().iter().zip(leaves) {
                let first = triangles.len();
                let faces = &mesh.faces()[patch.faces.clone()];
                triangles.extend(faces.iter().map(|f| [f[0], f[1], f[2]].map(|v| v + start)));
                groups.push(Group {
                    name: names.of(&patch.info.name),
                    kind: patch.info.kind.clone(),
                    colour: patch.info.colour,
                    tags: patch.info.tags.clone(),
                    tolerance: leaf.attributes.tolerance,
                    triangles: first..triangles.len(),
                });
            }
        };
        let shown: Vec<&Leaf> = solid.patch_leaves.iter().map(|&l| &solid.leaves[l]).collect();
        take(&solid.mesh, 0, &shown);
        let (mut wires, mut dots) = (Vec::new(), Vec::new());
        if let Pieces::Mixed(mixed) = self {
            let leaves = &mixed.leaves;
            for sheet in &mixed.sheets {
                take(&sheet.mesh, points.len() as u32, &[&leaves[sheet.leaf]]);
                points.extend(lifter.moved_on(sheet.mesh.positions(), &sheet.on)?);
            }
            for wire in &mixed.wires {
                let mut line = lifter.moved_on(&wire.points, &wire.on)?;
                line.extend(line.first().copied().filter(|_| wire.closed));
                wires.push(line);
            }
            for dot in &mixed.points {
                dots.extend(lifter.moved_on(&[dot.point], &dot.on)?);
            }
        }
        let mut body = TriangleBody::new(points, triangles);
        let m = lifted.moments;
        body.of_triangles.volume = m.volume();
        if m.volume().re() > 0.0 {
            body.of_triangles.centroid = m.centroid();
        }
        Ok(TriangleBody { groups, wires, dots, flaws: super::flaws::flaws(solid), ..body })
    }
}
