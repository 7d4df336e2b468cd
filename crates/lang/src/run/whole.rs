//! Numbers of the whole model in its own program: `hydrostatics.volume`, `mesh.area`,
//! `mesh_quality.aspect`.
//!
//! They are those of the visible surfaces and bodies declared so far; reading one evaluates these.
//! The orientation of the surfaces follows from the panels of the run with plain numbers; a run
//! with derivatives uses the same.

use crate::model_file::header;
use crate::run::interpreter::Interpreter;
pub use crate::run::whole_groups::WHOLE_GROUPS;
use crate::source::fault_location::unplaced;
use crate::source::module::Module;
pub use crate::value::member::not_finite;
use moldloft_diag::{Diagnostic, Span};
use moldloft_hydro::{Body, Hydrostatics, Symmetry, USUAL_ACCURACY, hydrostatics};
use moldloft_mesh::{Mesh, measure, worst_quality};
use moldloft_model::Graph;
use moldloft_num::trace::Key;
use moldloft_num::{Real, Vec3};
use moldloft_panel::{Panelling, Skin};
use moldloft_registry::{Class, Scalar, Value};
use moldloft_syntax::sdl::ExprId;
use std::any::Any;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// The numbers of hydrostatics by their names.
pub fn named<T: Real>(h: &Hydrostatics<T>) -> Vec<(&'static str, Value<T>)> {
    let mut all: Vec<_> =
        h.figures().into_iter().map(|(name, x)| (name, Value::Number(x))).collect();
    let mut vector = |name, v: Option<Vec3<T>>| all.extend(v.map(|v| (name, Value::Vector(v))));
    vector("buoyancy_centre", h.buoyancy_centre);
    vector("waterplane_centre", h.waterplane.as_ref().map(|w| w.centre));
    all
}

/// The numbers of the panels of a whole model: measures, or with the group `mesh_quality` those of
/// its worst panels.
pub fn panel_numbers<T: Real>(group: &str, mesh: &Mesh<T>) -> Vec<(&'static str, Value<T>)> {
    if group == "mesh_quality" {
        let worst = worst_quality(mesh).into_iter();
        return worst.map(|(name, x)| (name, Value::Number(x))).collect();
    }
    let measures = measure(mesh);
    let numbers = [("area", measures.area), ("volume", measures.volume)];
    let centres =
        [("area_centre", Some(measures.area_centre)), ("centroid", measures.centroid)].into_iter();
    let centres = centres.filter_map(|(name, centre)| Some((name, Value::Vector(centre?))));
    numbers.into_iter().map(|(name, x)| (name, Value::Number(x))).chain(centres).collect()
}

/// The hydrostatics of a body in water at z = 0; `symmetry` holds the letters of the planes that mirror it.
///
/// # Errors
/// When the skin is open below the water and `partial` figures are not allowed.
pub fn body_numbers<T: Real>(
    body: &Body<T>,
    skin: &Skin,
    symmetry: &str,
    partial: bool,
) -> Result<Vec<(&'static str, Value<T>)>, Diagnostic> {
    let lengthwise = symmetry.contains('x').then(|| body.with_mirror_image(0));
    let body = lengthwise.as_ref().unwrap_or(body);
    let shown = if symmetry.contains('y') { Symmetry::MirroredTwice } else { Symmetry::None };
    let found = hydrostatics(body, T::zero(), shown, 1.0);
    match found.open_edges {
        1.. if !partial => Err(open_below_water(skin)),
        _ => Ok(named(&found)),
    }
}

/// Error: the skin is open below the water, so it encloses no volume.
pub fn open_below_water(skin: &Skin) -> Diagnostic {
    const MOST_NAMES: usize = 3;
    let named = skin.open().iter().take(MOST_NAMES).map(|name| format!("`{name}`"));
    let mut names = named.collect::<Vec<_>>().join(", ");
    if skin.open().len() > MOST_NAMES {
        names += ", ...";
    }
    Diagnostic::error("open-below-water", "the skin is open below the water")
        .expected("a skin that is closed up to the water")
        .found(format!("edges that nothing closes: of {names}"))
        .help("close it with a bottom, a transom or a deck, hide surfaces that are no skin, or allow partial figures \
               (`--keep-going`, `Model.partial = True`)")
}

/// The number of that name in a group.
pub fn one_of<T: Real>(
    numbers: Vec<(&'static str, Value<T>)>,
    group: &str,
    number: &str,
) -> Result<Value<T>, Diagnostic> {
    if let Some((_, value)) = numbers.iter().find(|(name, _)| *name == number) {
        return Ok(value.clone());
    }
    let known: Vec<&str> = numbers.iter().map(|(name, _)| *name).collect();
    Err(Diagnostic::error("unknown-member", format!("{group} has no `{number}`"))
        .expected(known.join(", "))
        .suggest(number, known.iter().copied()))
}

/// The panels and the skin of the objects of these names, as the plain run found them last.
#[derive(Default)]
struct Skins(Mutex<HashMap<Vec<Arc<str>>, Arc<(Panelling, Skin)>>>);

/// More of them are not kept.
const MOST_SKINS: usize = 64;

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// `hydrostatics.volume` and similar members; `None` where the name has another meaning.
    pub fn whole_member(
        &mut self,
        m: &Module,
        base: ExprId,
        word: &str,
        span: Span,
    ) -> Option<Result<Value<T>, Diagnostic>> {
        let symbol = m.program.as_name(base)?;
        let group = m.program.name(symbol).to_string();
        if !WHOLE_GROUPS.contains(&&*group)
            || self.env.scope.lookup(m.names[symbol.0 as usize]).is_some()
            || self.run.find(&group).is_some()
        {
            return None;
        }
        let numbers = self.whole_numbers(&group, span);
        Some(numbers.and_then(|all| one_of(all, &group, word)).map_err(|d| d.or_at(span)))
    }

    fn whole_numbers(
        &mut self,
        group: &str,
        span: Span,
    ) -> Result<Vec<(&'static str, Value<T>)>, Diagnostic> {
        let graph = self.run.graph();
        let count = graph.objects().count();
        let bounds = |class: Class| matches!(class, Class::Surface | Class::Mesh | Class::Any);
        let shown = graph.objects().filter(|o| o.head.shown() && bounds(o.row.class));
        let (keys, names): (Vec<Key>, Vec<Arc<str>>) =
            shown.map(|o| (o.key, o.name.clone())).unzip();
        for key in keys {
            self.read(Value::Object(key), span)?;
        }
        if let Some((at, known, numbers)) = &self.measured
            && *at == count
            && known == group
        {
            return Ok(numbers.clone());
        }
        let graph = self.run.graph();
        let symmetry = header::text(graph, "symmetry");
        let skins: Arc<Skins> = graph.context().kept.of();
        let mut skins = skins.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(graph) = (graph as &dyn Any).downcast_ref::<Graph<f64>>() {
            let panelling = Panelling::new(graph).map_err(|fault| unplaced(&fault))?;
            let mesh = panelling.own_mesh().ok_or_else(no_mesh)?;
            let mirrors: Vec<u8> =
                (0..3u8).filter(|&k| symmetry.contains(['x', 'y', 'z'][usize::from(k)])).collect();
            let skin = Skin::new(&panelling, &mesh, graph, &mirrors);
            if skins.len() >= MOST_SKINS {
                skins.clear();
            }
            skins.insert(names.clone(), Arc::new((panelling, skin)));
        }
        let found = skins.get(&names).cloned().ok_or_else(no_mesh)?;
        drop(skins);
        let (panelling, skin) = &*found;
        let numbers = if group != "hydrostatics" {
            panel_numbers(group, &panelling.mesh(graph).ok_or_else(no_mesh)?)
        } else {
            let body = skin.body(panelling, graph, USUAL_ACCURACY).ok_or_else(not_finite)?;
            body_numbers(&body, skin, &symmetry, false)?
        };
        self.measured = Some((count, group.to_string(), numbers.clone()));
        Ok(numbers)
    }
}

fn no_mesh() -> Diagnostic {
    Diagnostic::error("no-mesh", "the model has no panels")
        .help("declare a surface, and show it (visible = 1)")
}
