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
pub struct FlotationOptions {
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
    /// The mass that floats and the centre of gravity are those of the model's weights.
    pub of_weights: bool,
    /// Attitudes in which the skin is open below the water are answered, marked by
    /// [`FloatAnswer::open_edges`], where they are errors otherwise.
    pub flooded: bool,
    /// The relative accuracy of the figures.
    pub accuracy: f64,
}

/// One answer: figures by name, and how they came about.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatAnswer {
    /// The figures by name, those without meaning left out.
    pub figures: Vec<(&'static str, f64)>,
    /// For each figure its derivatives by the asked parameters.
    pub derivatives: Vec<Vec<f64>>,
    /// Bounds of the errors of the main figures, by name.
    pub bounds: Vec<(&'static str, f64)>,
    /// `given`, `converged` or `not-converged`.
    pub status: &'static str,
    /// Newton steps.
    pub iterations: usize,
    /// What is left of the equations of rest.
    pub residual: f64,
    /// Whether all small turns are righted; `None` without a centre of gravity.
    pub stable: Option<bool>,
    /// Whether this is the attitude that a body finds which is unstable where the search began.
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
    /// Hydrostatics, one answer per request, with derivatives by the parameters or literals
    /// `by`.
    ///
    /// # Errors
    /// What cannot float so, and unknown names.
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
            let body = bodied.skin.body(&panelled.panelling, graph, options.accuracy);
            let body: Body<Dual4> = body.ok_or_else(|| vec![not_finite()])?;
            let carried = document.carried(graph, options)?;
            let all = self::answers(&body, &symmetry, requests, options, carried, &budget)?;
            for (answer, solved) in answers.iter_mut().zip(all) {
                let figures = solved.map_err(cannot_float)?.0.flotation.figures();
                for (column, (_, x)) in answer.derivatives.iter_mut().zip(figures) {
                    column.extend((0..count).map(|k| x.eps[k]));
                }
            }
            Ok(())
        })?;
        Ok(answers)
    }
}

/// A weight of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct WeightItem {
    /// Its name.
    pub name: String,
    /// The group it is listed in, empty for none.
    pub group: String,
    /// Mass, with its margin.
    pub mass: f64,
    /// The margin in percent.
    pub margin: f64,
    /// Its centre.
    pub centre: [f64; 3],
    /// How the mass is known.
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

    /// The mass and the centre of all weights, where these float.
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

/// The answers of all requests, each from canonical data: none starts from another's.
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
    // A heeled body is no longer symmetric in the water: it is shown whole.
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
    /// The immersed area of sections below upright levels: `[station][level]`, with the moment of each area about
    /// z = 0; both sides of a mirrored model.
    ///
    /// # Errors
    /// When there is no skin.
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
                // About the level it is negative below; about z = 0 the level is added.
                [area, z * area - moment.abs() * sides]
            };
            levels.iter().map(at).collect()
        };
        Ok(stations.par_iter().map(one).collect())
    }

    /// What the panels displace below an upright level: volume, wetted area, waterplane area; of both sides of a
    /// mirrored model.
    ///
    /// # Errors
    /// When there are no panels.
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
