//! The hydrostatics of a model, as named numbers.

use crate::Document;
use crate::measures::bodied::Bodied;
use moldloft_diag::{Diagnostic, Severity};
use moldloft_hydro::{Attitude, Hydrostatics, Symmetry, USUAL_ACCURACY, hydrostatics};
use moldloft_lang::run::whole::{not_finite, open_below_water};
use moldloft_mesh::{InnerSkin, Mesh, inner_skins};
use moldloft_num::Vec3;
use moldloft_panel::Skin;
use std::sync::Arc;

/// Floating condition of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HydrostaticsOptions {
    /// Height z of the water.
    pub level: f64,
    /// True for a mesh of one side of y = 0 that represents both.
    pub mirrored: bool,
    /// Mass per volume of the water.
    pub density: f64,
}

impl Default for HydrostaticsOptions {
    fn default() -> Self {
        Self { level: 0.0, mirrored: false, density: 1.0 }
    }
}

impl HydrostaticsOptions {
    fn symmetry(&self) -> Symmetry {
        if self.mirrored { Symmetry::MirroredTwice } else { Symmetry::None }
    }
}

/// The wetted area of a patch of the skin.
#[derive(Clone, Debug, PartialEq)]
pub struct WettedPatch {
    /// The object that it belongs to.
    pub object: String,
    /// The tags of the patch.
    pub tags: Vec<String>,
    /// Area below the water.
    pub area: f64,
}

impl Document {
    /// The hydrostatics of the model.
    ///
    /// # Errors
    /// If there is no skin; unless an incomplete model is allowed, if the skin is open below the
    /// water, bodies overlap, or a plate is inside a body.
    pub fn hydrostatics(
        &mut self,
        options: &HydrostaticsOptions,
    ) -> Result<Hydrostatics<f64>, Diagnostic> {
        let bodied = self.bodied(USUAL_ACCURACY)?;
        let found = hydrostatics(&bodied.body, options.level, options.symmetry(), options.density);
        match found.open_edges {
            1.. if !self.partial() => Err(open_below_water(&bodied.skin)),
            _ => Ok(found),
        }
    }

    /// Refuses a model whose skin is open below a level or includes both sides of a mirror plane,
    /// since no body displaces water. If partial figures are allowed, returns a warning for an open
    /// skin.
    ///
    /// # Errors
    /// As [`Document::hydrostatics`].
    pub fn closed_below(&mut self, level: f64) -> Result<Option<Diagnostic>, Diagnostic> {
        let mirrored = self.symmetry().contains('y');
        let bodied = self.bodied(USUAL_ACCURACY)?;
        if bodied.body.open_below(level, mirrored) == 0 {
            return Ok(None);
        }
        let mut fault = open_below_water(&bodied.skin);
        if !self.partial() {
            return Err(fault);
        }
        fault.severity = Severity::Warning;
        Ok(Some(fault))
    }

    /// The wetted area of each patch of the skin in an attitude, with the patch's tags; images of a
    /// symmetric model are included.
    ///
    /// # Errors
    /// As [`Document::hydrostatics`], but for open edges.
    pub fn wetted_areas(
        &mut self,
        attitude: Attitude<f64>,
        accuracy: f64,
    ) -> Result<Vec<WettedPatch>, Diagnostic> {
        let bodied = self.bodied(accuracy)?;
        let panelled = self.panelled()?;
        let symmetry = self.symmetry();
        let signs = |axis: char| if symmetry.contains(axis) { vec![1.0, -1.0] } else { vec![1.0] };
        let parts = bodied.skin.parts(&panelled.mesh, &bodied.body);
        let mut areas = vec![0.0; parts.len()];
        // The image of a patch has the attitude with the opposite turn.
        for lengthwise in signs('x') {
            for across in signs('y') {
                let Attitude { level, trim, heel } = attitude;
                let turned = Attitude { level, trim: lengthwise * trim, heel: across * heel };
                let body = bodied.body.turned(turned);
                for (area, (_, cells)) in areas.iter_mut().zip(&parts) {
                    *area += body.wetted_area(cells.clone(), level);
                }
            }
        }
        let tags = |name: &str| {
            let patch = panelled.mesh.patches().iter().find(|patch| patch.info.name == name);
            patch.map_or_else(Vec::new, |patch| patch.info.tags.clone())
        };
        let made = |((name, _), area): ((String, _), f64)| WettedPatch {
            tags: tags(&name),
            object: self.owner(&name).unwrap_or(&name).to_string(),
            area,
        };
        Ok(parts.into_iter().zip(areas).map(made).collect())
    }

    /// The skin of all shown surfaces and bodies, cached until the model changes.
    ///
    /// # Errors
    /// If the panels exceed the limit, or a surface is not finite; unless an incomplete model is
    /// allowed, if bodies overlap or a plate is inside a body.
    pub(crate) fn bodied(&mut self, accuracy: f64) -> Result<Arc<Bodied>, Diagnostic> {
        // The skin of an incomplete model looks like that of a complete one.
        self.entire().map_err(|mut faults| faults.swap_remove(0))?;
        if !self.partial()
            && let Some(mut fault) = self.inner_skins()?.into_iter().next()
        {
            fault.severity = Severity::Error;
            return Err(fault.help("m.partial = True, or --keep-going, counts them as they are"));
        }
        let clock = self.plain.graph.last_change();
        if let Some(known) = &self.bodied
            && known.clock == clock
            && known.accuracy == accuracy
        {
            return Ok(known.clone());
        }
        let panelled = self.panelled()?;
        let mirrors = self.mirrors();
        self.one_side_alone(&panelled.mesh)?;
        let graph = &self.plain.graph;
        let skin = Skin::new(&panelled.panelling, &panelled.mesh, graph, &mirrors);
        let body = skin.body(&panelled.panelling, graph, accuracy).ok_or_else(not_finite)?;
        let bodied = Arc::new(Bodied { clock, accuracy, skin, body });
        self.bodied = Some(bodied.clone());
        Ok(bodied)
    }

    /// The patches of the skin measured by their panels; see [`Skin::on_panels`].
    ///
    /// # Errors
    /// If the panels exceed the limit, or a surface is not finite.
    pub fn on_panels(&mut self) -> Result<Vec<String>, Diagnostic> {
        let accuracy = self.bodied.as_ref().map_or(USUAL_ACCURACY, |known| known.accuracy);
        Ok(self.bodied(accuracy)?.skin.on_panels().to_vec())
    }

    /// Warnings about surfaces of the skin that turn over themselves: areas and volumes count the
    /// fold more than once.
    ///
    /// # Errors
    /// If the skin is not that of a body: see [`Document::hydrostatics`].
    pub fn folded_surfaces(&mut self) -> Result<Vec<Diagnostic>, Diagnostic> {
        let accuracy = self.bodied.as_ref().map_or(USUAL_ACCURACY, |known| known.accuracy);
        let bodied = self.bodied(accuracy)?;
        let report = |(side, at): &(usize, Vec3)| {
            let name = bodied.skin.side(*side);
            let place = format!("({:.6}, {:.6}, {:.6})", at.x, at.y, at.z);
            let message = format!(
                "`{name}` turns over itself, at {place}: areas count the fold more than once"
            );
            let advice = "move its sides apart there, change their parametrisation, or cut it before the \
                fold";
            let fault = Diagnostic::warning("folded-surface", message).help(advice).object(name);
            let object = self.graph().find(name).and_then(|key| self.graph().get(key));
            match object.and_then(|o| self.declared_at(&self.plain, o)) {
                Some(span) => fault.at(span),
                None => fault,
            }
        };
        Ok(bodied.body.folds().iter().map(report).collect())
    }

    /// Warnings about plates of the skin inside a body, and about bodies that overlap and whose
    /// common volume counts twice; cached until the panels change.
    ///
    /// # Errors
    /// If the panels exceed the limit.
    pub fn inner_skins(&mut self) -> Result<Vec<Diagnostic>, Diagnostic> {
        let panelled = self.panelled()?;
        if let Some((of, found)) = &self.inner_skins
            && Arc::ptr_eq(of, &panelled)
        {
            return Ok(found.clone());
        }
        let found = self.found_inside(&panelled.mesh);
        self.inner_skins = Some((panelled, found.clone()));
        Ok(found)
    }

    fn found_inside(&self, mesh: &Mesh) -> Vec<Diagnostic> {
        let name = |patch: usize| mesh.patches()[patch].info.name.as_str();
        let report = |inner: &InnerSkin| {
            let (skin, around, at) = (name(inner.patch), name(inner.around), inner.at);
            let place = format!("at ({}, {}, {})", at.x, at.y, at.z);
            let (id, message, help) = match inner.open {
                true => (
                    "inner-plate",
                    format!("`{skin}` is inside the body of `{around}`, {place}"),
                    "hide it (visible = 0), or tag it as not part of the skin",
                ),
                false => (
                    "bodies-overlap",
                    format!(
                        "the bodies of `{skin}` and `{around}` overlap, {place}: their common volume counts twice"
                    ),
                    "cut both along their intersection (IntSnake), or unite their panels: m.united(), --united",
                ),
            };
            let mut fault = Diagnostic::warning(id, message).help(help).object(skin);
            let object = self.graph().find(skin).and_then(|key| self.graph().get(key));
            if let Some(span) = object.and_then(|o| self.declared_at(&self.plain, o)) {
                fault = fault.at(span);
            }
            fault
        };
        // A set or a sketch has cavities, whose patches are those of one object; others are stated.
        let own = |inner: &&InnerSkin| {
            let [skin, around] = [inner.patch, inner.around].map(|patch| self.owner(name(patch)));
            let stated = skin.and_then(|name| self.graph().get(self.graph().find(name)?));
            let stated = stated.is_some_and(|object| object.head.cavity());
            !(inner.cavity && skin.is_some() && (stated || skin == around))
        };
        inner_skins(mesh, &self.mirrors()).iter().filter(own).map(report).collect()
    }

    /// The object of a patch, whose name is that of the object or begins with it and a dot.
    fn owner<'a>(&self, patch: &'a str) -> Option<&'a str> {
        let ends = patch.match_indices('.').map(|(k, _)| k).chain([patch.len()]);
        ends.map(|end| &patch[..end]).rfind(|name| self.graph().find(name).is_some())
    }

    /// Rejects a mirrored model with shapes on both sides of the symmetry plane: these would count
    /// twice.
    fn one_side_alone(&self, mesh: &Mesh) -> Result<(), Diagnostic> {
        let size = mesh.bounds().diagonal();
        for axis in self.mirrors() {
            let k = usize::from(axis);
            let mut reach: [(f64, &str); 2] = [(0.0, ""); 2];
            for patch in mesh.patches().iter().filter(|p| p.info.tag.is_skin()) {
                for &v in mesh.faces()[patch.faces.clone()].iter().flatten() {
                    let x = mesh.positions()[v as usize][k];
                    if x < reach[0].0 {
                        reach[0] = (x, &patch.info.name);
                    }
                    if x > reach[1].0 {
                        reach[1] = (x, &patch.info.name);
                    }
                }
            }
            let [(low, below), (high, above)] = reach;
            if low.abs().min(high) <= 1e-9 * size {
                continue;
            }
            let plane = ["x = 0", "y = 0", "z = 0"][k];
            let mut fault = Diagnostic::error(
                "mirrored-twice",
                format!("the model is mirrored in {plane} and shows both sides of it"),
            )
            .expected("one half of the symmetric model")
            .found(format!("`{below}` reaches {low}, `{above}` reaches {high}"))
            .help("hide one side, or leave the symmetry out");
            for (name, first) in [(above, true), (below, false)] {
                let object = self.graph().find(name).and_then(|key| self.graph().get(key));
                let span = object.and_then(|o| self.declared_at(&self.plain, o));
                fault = match span {
                    Some(span) if first => fault.at(span),
                    Some(span) => fault.note_at(span, "the other side"),
                    None => fault,
                };
            }
            return Err(fault);
        }
        Ok(())
    }

    /// The normal axes of the symmetry planes of the model.
    pub(crate) fn mirrors(&self) -> Vec<u8> {
        let letters = self.symmetry();
        (0..3u8).filter(|&k| letters.contains(['x', 'y', 'z'][usize::from(k)])).collect()
    }
}
