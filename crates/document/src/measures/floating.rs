//! Hydrostatics of a model: figures at given drafts, trims and heels, equilibria, and their derivatives.

use crate::Document;
use moldloft_budget::{Budget, Spent};
use moldloft_diag::Diagnostic;
use moldloft_hydro::{
    Attitude, Body, Equilibrium, FloatError, Flotation, Loading, Status, Symmetry, USUAL_ACCURACY,
    Water, bottom, bounds, equilibrium, flotation, section_area,
};
use moldloft_lang::run::weight::mass_and_centre;
use moldloft_lang::run::whole::{not_finite, open_below_water};
use moldloft_lang::source::fault_location::unplaced;
use moldloft_model::Graph;
use moldloft_num::{Dual4, Real, Vec3};
use moldloft_parallel::prelude::*;
use moldloft_registry::{CallError, Role, Scalar};

/// A hydrostatics request; heel and trim in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloatRequest {
    /// Specification of the immersion.
    pub immersion: Immersion,
    /// The trim, or its initial value if it is free.
    pub trim: f64,
    /// The heel, or its initial value if it is free.
    pub heel: f64,
}

/// Specification of the immersion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Immersion {
    /// Height of the water over the origin, at the given trim and heel.
    Level(f64),
    /// Depth of the lowest point of the upright body below the water, on the centre line in the
    /// middle of its length.
    Draft(f64),
    /// The floating mass; free trim and heel are solved for.
    Mass {
        /// The mass.
        mass: f64,
        /// True to solve for the trim.
        free_trim: bool,
        /// True to solve for the heel.
        free_heel: bool,
    },
}

/// Options common to all requests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlotationOptions {
    /// Mass per volume of the water.
    pub density: f64,
    /// Acceleration of gravity in the model's unit.
    pub gravity: f64,
    /// A centimetre in the model's unit.
    pub centimetre: f64,
    /// Centre of gravity in the body's axes.
    pub centre: Option<[f64; 3]>,
    /// True to count only the modelled side of y = 0.
    pub one_side: bool,
    /// True to take mass and centre of gravity from the weights of the model.
    pub of_weights: bool,
    /// True to accept attitudes with open edges below the water, marked by
    /// [`FloatAnswer::open_edges`]; otherwise they are errors.
    pub flooded: bool,
    /// The relative accuracy of the figures.
    pub accuracy: f64,
}

/// Accuracy of the cells that bound the errors of derivatives, relative to that of the figures.
pub(super) const COARSER: f64 = 100.0;

/// One answer: figures by name, and the state of the solution.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatAnswer {
    /// The figures by name; undefined ones are omitted.
    pub figures: Vec<(&'static str, f64)>,
    /// Derivatives of each figure with respect to the requested parameters.
    pub derivatives: Vec<Vec<f64>>,
    /// Estimates of the errors of these, from coarser cells; empty where water enters.
    pub derivative_bounds: Vec<Vec<f64>>,
    /// Bounds of the errors of the main figures, by name.
    pub bounds: Vec<(&'static str, f64)>,
    /// `given`, `converged` or `not-converged`.
    pub status: &'static str,
    /// Newton steps.
    pub iterations: usize,
    /// Residual of the equilibrium equations.
    pub residual: f64,
    /// True for positive stiffness in heel and trim; `None` without a centre of gravity.
    pub stable: Option<bool>,
    /// True for an angle of loll: the initial attitude was an unstable equilibrium, and this is the
    /// stable one beside it.
    pub lolls: bool,
    /// Open edges below the water.
    pub open_edges: usize,
    /// See [`moldloft_hydro::Hydrostatics::closure_error`].
    pub closure_error: f64,
    /// See [`moldloft_hydro::Hydrostatics::waterplane_error`].
    pub waterplane_error: f64,
    /// Whether panels face outward.
    pub outward: bool,
    /// `both`, `one` or `whole`.
    pub sides: &'static str,
}

impl Document {
    /// Hydrostatics, one answer per request, with derivatives with respect to the parameters or
    /// literals `by`.
    ///
    /// # Errors
    /// Requests without an equilibrium, and unknown names.
    pub fn floating(
        &mut self,
        requests: &[FloatRequest],
        options: FlotationOptions,
        by: &[String],
    ) -> Result<Vec<FloatAnswer>, Vec<Diagnostic>> {
        let symmetry = self.symmetry();
        let bodied = self.bodied(options.accuracy).map_err(|d| vec![d])?;
        let carried = self.carried(&self.plain.graph, options)?;
        let budget = self.budget();
        let mut answers = answers(&bodied.body, &symmetry, requests, options, carried, &budget)?
            .into_iter()
            .map(|solved| Ok(answer(&solved?)))
            .collect::<Result<Vec<FloatAnswer>, FloatError>>()
            .map_err(cannot_float)?;
        for answer in answers.iter_mut().filter(|a| a.open_edges > 0) {
            if !(options.flooded || self.partial()) {
                return Err(vec![open_below_water(&bodied.skin)]);
            }
            answer.bounds.clear();
        }
        if by.is_empty() {
            return Ok(answers);
        }
        self.passes(by, |document, evaluation, count| {
            let panelled = document.panelled().map_err(|d| vec![d])?;
            let graph = &evaluation.graph;
            let carried = document.carried(graph, options)?;
            let all = |accuracy: f64| {
                let body = bodied.skin.body(&panelled.panelling, graph, accuracy);
                let body: Body<Dual4> = body.ok_or_else(|| vec![not_finite()])?;
                self::answers(&body, &symmetry, requests, options, carried, &budget)
            };
            let rough = all(COARSER * options.accuracy)?;
            for ((answer, solved), rough) in
                answers.iter_mut().zip(all(options.accuracy)?).zip(rough)
            {
                let figures = solved.map_err(cannot_float)?.0.flotation.figures();
                // Coarser cells that do not float tell nothing.
                let rough = rough.map_or_else(|_| Vec::new(), |s| s.0.flotation.figures());
                let columns = answer.derivatives.iter_mut().zip(&mut answer.derivative_bounds);
                for ((column, bounds), (name, x)) in columns.zip(figures) {
                    column.extend((0..count).map(|k| x.eps[k]));
                    let other = rough.iter().find(|(other, _)| *other == name);
                    bounds.extend((0..count).map(|k| match other {
                        Some((_, y)) => {
                            (x.eps[k] - y.eps[k]).abs() + options.accuracy * x.eps[k].abs()
                        }
                        None => f64::INFINITY,
                    }));
                }
            }
            Ok(())
        })?;
        for answer in answers.iter_mut().filter(|a| a.open_edges > 0) {
            answer.derivative_bounds.clear();
        }
        Ok(answers)
    }
}

/// A weight of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct WeightItem {
    /// Its name.
    pub name: String,
    /// The group it is listed in; may be empty.
    pub group: String,
    /// Mass, with its margin.
    pub mass: f64,
    /// The margin in percent.
    pub margin: f64,
    /// Its centre.
    pub centre: [f64; 3],
    /// Origin of the mass: estimated, calculated, weighed and so on, as the model states it.
    pub status: String,
}

impl Document {
    /// The weights of the model, in the order of declaration.
    pub fn weights(&self) -> Vec<WeightItem> {
        let objects = self.graph().objects().filter(|o| o.row.role == Role::Weight);
        let item = |o: &moldloft_model::Object<f64>| {
            let (mass, centre) = mass_and_centre(o.value()?)?;
            let argument = |name: &str| o.args.get(o.row.field(name)?);
            let text = |name: &str| match argument(name) {
                Some(moldloft_registry::Value::Text(text)) => text.to_string(),
                _ => String::new(),
            };
            let margin = match argument("margin") {
                Some(moldloft_registry::Value::Number(x)) => *x,
                _ => 0.0,
            };
            let (group, mut status) = (text("group"), text("status"));
            if status.is_empty() {
                status = "estimated".into();
            }
            let (name, centre) = (o.name.to_string(), centre.to_array());
            Some(WeightItem { name, group, mass, margin, centre, status })
        };
        objects.filter_map(item).collect()
    }

    /// Mass and centre of all weights, if these define the floating condition.
    fn carried<T: Scalar>(
        &self,
        graph: &Graph<T>,
        options: FlotationOptions,
    ) -> Result<Option<(T, Vec3<T>)>, Vec<Diagnostic>> {
        if !options.of_weights {
            return Ok(None);
        }
        let (mut mass, mut moment) = (T::zero(), Vec3::zero());
        for object in graph.objects().filter(|o| o.row.role == Role::Weight) {
            if let Some((m, centre)) = object.value().and_then(mass_and_centre) {
                mass += m;
                moment += centre * m;
            }
        }
        if mass.re() > 0.0 {
            return Ok(Some((mass, moment / mass)));
        }
        Err(vec![
            Diagnostic::error("no-weights", "the model has no weights")
                .expected("declarations such as: Weight engine({2, 0, 0.5}, mass = 3);")
                .help("or give the displacement and the centre of gravity"),
        ])
    }
}

fn cannot_float(error: FloatError) -> Vec<Diagnostic> {
    let diagnostic = Diagnostic::error("cannot-float", error.to_string());
    vec![match error {
        FloatError::NoCentre => {
            diagnostic.help("give the centre of gravity, or keep trim and heel")
        }
        FloatError::HalfHeels => diagnostic.help("count both sides"),
        FloatError::Sinks { rim: Some(_), .. } => {
            diagnostic.help("close the hull with a deck, or look at smaller angles")
        }
        FloatError::Sinks { .. } => {
            diagnostic.help("check the units of the displacement and of the density")
        }
        _ => diagnostic,
    }]
}

type Answered<T> = Result<(Equilibrium<T>, bool, &'static str), FloatError>;

/// The answers of all requests; none starts from the solution of another.
fn answers<T: Real>(
    body: &Body<T>,
    symmetry: &str,
    requests: &[FloatRequest],
    options: FlotationOptions,
    carried: Option<(T, Vec3<T>)>,
    budget: &Budget,
) -> Result<Vec<Answered<T>>, Vec<Diagnostic>> {
    let lengthwise = symmetry.contains('x').then(|| body.with_mirror_image(0));
    let body = lengthwise.as_ref().unwrap_or(body);
    let half = symmetry.contains('y');
    let heels = |r: &FloatRequest| {
        r.heel != 0.0 || matches!(r.immersion, Immersion::Mass { free_heel: true, .. })
    };
    // The immersed part of a heeled body is not symmetric: use the whole skin.
    let whole = (half && !options.one_side && requests.iter().any(heels))
        .then(|| body.with_mirror_image(1));
    let one = |request: &FloatRequest| -> Answered<T> {
        let (body, shown) = match &whole {
            Some(whole) if heels(request) => (whole, Symmetry::None),
            _ if half && options.one_side => (body, Symmetry::MirroredOnce),
            _ if half => (body, Symmetry::MirroredTwice),
            _ => (body, Symmetry::None),
        };
        let sides = match (half, options.one_side) {
            (false, _) => "whole",
            (true, true) => "one",
            (true, false) => "both",
        };
        if options.one_side && half && heels(request) {
            return Err(FloatError::HalfHeels);
        }
        let FlotationOptions { density, gravity, centimetre, .. } = options;
        let water = Water { density, gravity, symmetry: shown, centimetre };
        let centre = options.centre.map(|c| Vec3::from(c.map(T::from)));
        let centre = centre.or(carried.map(|c| c.1));
        let (trim, heel) = (T::from(request.trim), T::from(request.heel));
        let given = |level: T| {
            let flotation = flotation(body, water, Attitude { level, trim, heel }, centre);
            let status = Status::Converged;
            let stable = flotation.stable.unwrap_or(true);
            Equilibrium { flotation, status, iterations: 0, residual: 0.0, stable, lolls: false }
        };
        Ok(match request.immersion {
            Immersion::Level(level) => (given(T::from(level)), false, sides),
            Immersion::Draft(draft) => {
                let [x, bottom] = bottom(body);
                let level = Attitude::level_at(trim, heel, x, bottom + draft);
                (given(level), false, sides)
            }
            Immersion::Mass { mass, free_trim, free_heel } => {
                let mass = carried.map_or(T::from(mass), |c| c.0);
                let loading = Loading { mass, centre, free_trim, free_heel };
                let start = Attitude { level: T::zero(), trim, heel };
                (equilibrium(body, water, loading, start)?, true, sides)
            }
        })
    };
    let within = |request| budget.poll().map(|()| one(request));
    let all: Result<Vec<_>, Spent> = requests.par_iter().map(within).collect();
    all.map_err(|spent| vec![unplaced(&CallError::from(spent))])
}

fn answer((solved, sought, sides): &(Equilibrium<f64>, bool, &'static str)) -> FloatAnswer {
    let Flotation { earth, .. } = &solved.flotation;
    let figures = solved.flotation.figures();
    FloatAnswer {
        derivatives: vec![Vec::new(); figures.len()],
        derivative_bounds: vec![Vec::new(); figures.len()],
        figures,
        status: match (sought, solved.status) {
            (false, _) => "given",
            (true, Status::Converged) => "converged",
            (true, Status::NotConverged) => "not-converged",
        },
        iterations: solved.iterations,
        residual: solved.residual,
        bounds: bounds(&solved.flotation),
        stable: solved.flotation.stable,
        lolls: solved.lolls,
        open_edges: earth.open_edges,
        closure_error: earth.closure_error,
        waterplane_error: earth.waterplane_error,
        outward: earth.outward,
        sides,
    }
}

impl Document {
    /// Immersed areas of sections at upright levels, `[station][level]`, with their moments about z
    /// = 0; both halves of a mirrored model.
    ///
    /// # Errors
    /// If there is no skin.
    pub fn section_areas(
        &mut self,
        stations: &[f64],
        levels: &[f64],
        accuracy: f64,
    ) -> Result<Vec<Vec<[f64; 2]>>, Vec<Diagnostic>> {
        let bodied = self.bodied(accuracy).map_err(|d| vec![d])?;
        let symmetry = self.symmetry();
        let lengthwise = symmetry.contains('x').then(|| bodied.body.with_mirror_image(0));
        let body = lengthwise.as_ref().unwrap_or(&bodied.body);
        let sides = if symmetry.contains('y') { 2.0 } else { 1.0 };
        let one = |&x: &f64| {
            let at = |&z: &f64| {
                let [area, moment] = section_area(body, x, z);
                let sign = if area < 0.0 { -sides } else { sides };
                let area = area * sign;
                // The moment about the level is negative; shift it to z = 0.
                [area, z * area - moment.abs() * sides]
            };
            levels.iter().map(at).collect()
        };
        Ok(stations.par_iter().map(one).collect())
    }

    /// Volume, wetted area and waterplane area of the panels below an upright level; both halves of
    /// a mirrored model.
    ///
    /// # Errors
    /// If there are no panels.
    pub fn panel_figures(&mut self, level: f64) -> Result<[f64; 3], Diagnostic> {
        let panelled = self.entire_panels()?;
        let symmetry = self.symmetry();
        let lengthwise =
            symmetry.contains('x').then(|| panelled.mesh.with_mirror_image(0, ".mirror").ok());
        let mesh = lengthwise.flatten();
        let mesh = mesh.as_ref().unwrap_or(&panelled.mesh);
        let shown = if symmetry.contains('y') { Symmetry::MirroredTwice } else { Symmetry::None };
        let body = Body::of_mesh(mesh, USUAL_ACCURACY);
        let h = moldloft_hydro::hydrostatics(&body, level, shown, 1.0);
        Ok([h.volume, h.wetted_area, h.waterplane.map_or(0.0, |w| w.area)])
    }
}
