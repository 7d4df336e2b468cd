//! Hydrostatics of a model: figures at given drafts, trims and heels, equilibria, and their derivatives.

use crate::Document;
use moldloft_diag::Diagnostic;
use moldloft_mesh::{
    Afloat, Attitude, FloatError, Loading, Mesh, Solved, Status, Symmetry, Water, afloat, bottom,
    equilibrium,
};
use moldloft_num::{Dual4, Real, Vec3};
use rayon::prelude::*;

/// A hydrostatics request; heel and trim in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloatRequest {
    /// What is given of the immersion.
    pub immersion: Immersion,
    /// The trim, or where its search begins.
    pub trim: f64,
    /// The heel, or where its search begins.
    pub heel: f64,
}

/// What is given of the immersion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Immersion {
    /// Height of the water over the origin, at the given trim and heel.
    Level(f64),
    /// Depth of the lowest point of the upright body below the water, on the centre line in the
    /// middle of its length.
    Draft(f64),
    /// The mass that floats; trim and heel are sought where they are free.
    Mass {
        /// The mass.
        mass: f64,
        /// Whether the trim is sought.
        free_trim: bool,
        /// Whether the heel is sought.
        free_heel: bool,
    },
}

/// What all requests have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AfloatOptions {
    /// Mass per volume of the water.
    pub density: f64,
    /// Acceleration of gravity in the model's unit.
    pub gravity: f64,
    /// A centimetre in the model's unit.
    pub centimetre: f64,
    /// Centre of gravity in the body's axes.
    pub centre: Option<[f64; 3]>,
    /// Only the modelled side of y = 0 counts.
    pub one_side: bool,
}

/// One answer: figures by name, and how they came about.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatAnswer {
    /// The figures by name, those without meaning left out.
    pub figures: Vec<(&'static str, f64)>,
    /// For each figure its derivatives by the asked parameters.
    pub derivatives: Vec<Vec<f64>>,
    /// `given`, `converged` or `not-converged`.
    pub status: &'static str,
    /// Newton steps.
    pub iterations: usize,
    /// What is left of the equations of rest.
    pub residual: f64,
    /// Whether small turns about the free axes are righted.
    pub stable: Option<bool>,
    /// Open edges below the water.
    pub open_edges: usize,
    /// See [`moldloft_mesh::Hydrostatics::closure_error`].
    pub closure_error: f64,
    /// See [`moldloft_mesh::Hydrostatics::waterplane_error`].
    pub waterplane_error: f64,
    /// Whether panels face outward.
    pub outward: bool,
    /// `both`, `one` or `whole`.
    pub sides: &'static str,
}

impl Document {
    /// Hydrostatics, one answer per request, with derivatives by the parameters or literals
    /// `by`.
    ///
    /// # Errors
    /// What cannot float so, and unknown names.
    pub fn floating(
        &mut self,
        requests: &[FloatRequest],
        options: AfloatOptions,
        by: &[String],
    ) -> Result<Vec<FloatAnswer>, Vec<Diagnostic>> {
        let symmetry = self.symmetry();
        let panelled = self.panelled().map_err(|d| vec![d])?;
        let mesh = panelled.mesh.clone();
        let mut answers = answers(&mesh, &symmetry, requests, options)
            .into_iter()
            .map(|solved| Ok(answer(&solved?)))
            .collect::<Result<Vec<FloatAnswer>, FloatError>>()
            .map_err(cannot_float)?;
        if by.is_empty() {
            return Ok(answers);
        }
        self.passes(by, |document, evaluation, count| {
            let panelled = document.panelled().map_err(|d| vec![d])?;
            let mesh = panelled.panelling.mesh(&evaluation.graph);
            let mesh: Mesh<Dual4> =
                mesh.ok_or_else(|| vec![crate::measures::expressions::no_mesh()])?;
            let all = self::answers(&mesh, &symmetry, requests, options);
            for (answer, solved) in answers.iter_mut().zip(all) {
                let figures = solved.map_err(cannot_float)?.0.afloat.figures();
                for (column, (_, x)) in answer.derivatives.iter_mut().zip(figures) {
                    column.extend((0..count).map(|k| x.eps[k]));
                }
            }
            Ok(())
        })?;
        Ok(answers)
    }
}

fn cannot_float(error: FloatError) -> Vec<Diagnostic> {
    let diagnostic = Diagnostic::error("cannot-float", error.to_string());
    vec![match error {
        FloatError::NoCentre => {
            diagnostic.help("give the centre of gravity, or keep trim and heel")
        }
        FloatError::HalfHeels => diagnostic.help("count both sides"),
        FloatError::Sinks { .. } => {
            diagnostic.help("check the units of the displacement and of the density")
        }
        _ => diagnostic,
    }]
}

type Answered<T> = Result<(Solved<T>, bool, &'static str), FloatError>;

/// The answers of all requests, each from canonical data: none starts from another's.
fn answers<T: Real>(
    mesh: &Mesh<T>,
    symmetry: &str,
    requests: &[FloatRequest],
    options: AfloatOptions,
) -> Vec<Answered<T>> {
    let image = |mesh: &Mesh<T>, axis| mesh.with_mirror_image(axis, ".mirror").ok();
    let lengthwise = if symmetry.contains('x') { image(mesh, 0) } else { None };
    let mesh = lengthwise.as_ref().unwrap_or(mesh);
    let half = symmetry.contains('y');
    let heels = |r: &FloatRequest| {
        r.heel != 0.0 || matches!(r.immersion, Immersion::Mass { free_heel: true, .. })
    };
    // A heeled body is no longer symmetric in the water: it is shown whole.
    let whole =
        if half && !options.one_side && requests.iter().any(heels) { image(mesh, 1) } else { None };
    let one = |request: &FloatRequest| -> Answered<T> {
        let (mesh, shown) = match &whole {
            Some(whole) if heels(request) => (whole, Symmetry::None),
            _ if half && options.one_side => (mesh, Symmetry::MirroredOnce),
            _ if half => (mesh, Symmetry::MirroredTwice),
            _ => (mesh, Symmetry::None),
        };
        let sides = match (half, options.one_side) {
            (false, _) => "whole",
            (true, true) => "one",
            (true, false) => "both",
        };
        if options.one_side && half && heels(request) {
            return Err(FloatError::HalfHeels);
        }
        let AfloatOptions { density, gravity, centimetre, .. } = options;
        let water = Water { density, gravity, symmetry: shown, centimetre };
        let centre = options.centre.map(|c| Vec3::from(c.map(T::from)));
        let (trim, heel) = (T::from(request.trim), T::from(request.heel));
        let given = |level: T| {
            let afloat = afloat(mesh, water, Attitude { level, trim, heel }, centre);
            let status = Status::Converged;
            Solved { afloat, status, iterations: 0, residual: 0.0, stable: true }
        };
        Ok(match request.immersion {
            Immersion::Level(level) => (given(T::from(level)), false, sides),
            Immersion::Draft(draft) => {
                let [x, bottom] = bottom(mesh);
                let level = Attitude::level_at(trim, heel, x, bottom + draft);
                (given(level), false, sides)
            }
            Immersion::Mass { mass, free_trim, free_heel } => {
                let loading = Loading { mass: T::from(mass), centre, free_trim, free_heel };
                let start = Attitude { level: T::zero(), trim, heel };
                (equilibrium(mesh, water, loading, start)?, true, sides)
            }
        })
    };
    requests.par_iter().map(one).collect()
}

fn answer((solved, sought, sides): &(Solved<f64>, bool, &'static str)) -> FloatAnswer {
    let Afloat { earth, .. } = &solved.afloat;
    let figures = solved.afloat.figures();
    FloatAnswer {
        derivatives: vec![Vec::new(); figures.len()],
        figures,
        status: match (sought, solved.status) {
            (false, _) => "given",
            (true, Status::Converged) => "converged",
            (true, Status::NotConverged) => "not-converged",
        },
        iterations: solved.iterations,
        residual: solved.residual,
        stable: (*sought && solved.afloat.gm.is_some()).then_some(solved.stable),
        open_edges: earth.open_edges,
        closure_error: earth.closure_error,
        waterplane_error: earth.waterplane_error,
        outward: earth.outward,
        sides,
    }
}
