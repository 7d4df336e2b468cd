//! Participants of a panelling: visible surfaces, hidden originals of images, borders of sheets.

use crate::border_curves::{self, BorderCounts};
use crate::knuckles::Knuckles;
use moldloft_model::{Graph, Object};
use moldloft_num::trace::{Edges, Key};
use moldloft_num::{Fineness, Order, SurfJet};
use moldloft_registry::{CallError, Scalar, SurfaceRef, Value};
use std::collections::HashMap;
use std::sync::Arc;

/// The points of edge 0..4 of a patch's grid, or (4) all of them.
pub(crate) fn indices([nu, nv]: [usize; 2], part: u8) -> impl Iterator<Item = usize> {
    let ((i0, i1), (j0, j1)) = match part {
        0 => ((0, nu), (0, 0)),
        1 => ((nu, nu), (0, nv)),
        2 => ((0, nu), (nv, nv)),
        3 => ((0, 0), (0, nv)),
        _ => ((0, nu), (0, nv)),
    };
    (i0..=i1).flat_map(move |i| (j0..=j1).map(move |j| i * (nv + 1) + j))
}

/// Maximum length of a chain of images whose first surface is searched.
const MOST_IMAGES: usize = 1000;

pub(crate) fn surface_of<T: Scalar>(object: &Object<T>) -> Option<&SurfaceRef<T>> {
    match object.value()? {
        Value::Surface(surface) => Some(surface),
        _ => None,
    }
}

/// The divisions of a surface: its own, or those of its original for an image without divisions;
/// the default where neighbours would decide.
pub fn divisions<T: Scalar>(graph: &Graph<T>, object: &Object<T>) -> [u32; 2] {
    let mut at = object;
    while !at.head.divided
        && let Some((key, _)) = surface_of(at).and_then(|s| s.image_of())
        && let Some(original) = graph.get(key)
    {
        at = original;
    }
    at.head.own_divisions()
}

/// The knuckles of a surface, which its images share.
pub(crate) type SharedKnuckles = Arc<Knuckles>;

/// The knuckles of surfaces; an image breaks where its original does.
struct KnuckleFinder<'g> {
    graph: &'g Graph<f64>,
    /// The knuckles of an earlier state, with the graph's last change at that time.
    before: Option<(&'g HashMap<Key, SharedKnuckles>, u64)>,
    found: HashMap<Key, SharedKnuckles>,
}

impl<'g> KnuckleFinder<'g> {
    fn of(&mut self, object: &'g Object<f64>, surface: &SurfaceRef<f64>) -> SharedKnuckles {
        // Down to the surface that is no image; a ring of images ends where it began.
        let (mut at, mut shape, mut steps) = (object, surface, 0);
        while let Some((key, _)) = shape.image_of()
            && let Some(original) = self.graph.get(key)
            && let Some(surface) = surface_of(original)
            && steps < MOST_IMAGES
        {
            (at, shape, steps) = (original, surface, steps + 1);
        }
        if let Some(known) = self.found.get(&at.key) {
            return known.clone();
        }
        let earlier = self.before.filter(|(_, clock)| at.changed_at <= *clock);
        let earlier = earlier.and_then(|(known, _)| known.get(&at.key));
        let made = earlier.cloned().unwrap_or_else(|| Arc::new(Knuckles::of(&**shape)));
        self.found.insert(at.key, made.clone());
        made
    }
}

/// A surface to be panelled, or the hem of a sheet.
pub(crate) struct Draft<'g> {
    pub object: &'g Object<f64>,
    pub surface: SurfaceRef<f64>,
    pub border_curve: Option<BorderCounts>,
    pub edges: Edges<f64>,
    pub knuckles: SharedKnuckles,
    /// The draft of which it is the image, and the number of the map.
    pub image: Option<(usize, u32)>,
    /// False for a hidden surface with a visible image.
    pub meshed: bool,
    pub reversed: bool,
    /// True for a face of a cavity.
    pub cavity: bool,
    /// The least divisions along u and v where panels are to be near to surfaces, in place of stated ones.
    pub fine: Option<[u32; 2]>,
}

impl Draft<'_> {
    /// The divisions that are stated along u and v.
    pub fn stated(&self) -> [Option<u32>; 2] {
        if self.fine.is_some() {
            return [None; 2];
        }
        match &self.border_curve {
            Some(border_curve) => [border_curve.stated, None],
            None => self.object.head.stated_divisions(),
        }
    }

    /// The divisions when nothing else determines them.
    pub fn usual(&self) -> [u32; 2] {
        if let Some(fine) = self.fine {
            return fine;
        }
        match &self.border_curve {
            Some(border_curve) => [border_curve.usual, 1],
            None => self.object.head.own_divisions(),
        }
    }

    /// Its identity, in any graph.
    pub fn identity(&self) -> (Arc<str>, Option<u32>) {
        (self.object.name.clone(), self.border_curve.as_ref().map(|h| h.index))
    }
}

/// The participating surfaces, in the order of declaration, followed by hidden ones and the hems of
/// sheets. `before`: the knuckles of an earlier state of the graph, with its last change at that
/// time. `fineness`: the required accuracy of panels, if given.
///
/// # Errors
/// When the accuracy takes too many triangles.
pub(crate) fn drafts<'g>(
    graph: &'g Graph<f64>,
    before: Option<(&'g HashMap<Key, SharedKnuckles>, u64)>,
    fineness: Option<&Fineness>,
) -> Result<Vec<Draft<'g>>, CallError> {
    let mut drafts: Vec<Draft> = Vec::new();
    let mut finder = KnuckleFinder { graph, before, found: HashMap::new() };
    let mut draft = |object: &'g Object<f64>, meshed| {
        let surface = surface_of(object)?.clone();
        let (mut edges, reversed) = (surface.edges(), reversed(graph, object));
        // Corners without point objects are named after themselves.
        for (k, corner) in edges.corners.iter_mut().enumerate() {
            *corner = corner.or_else(|| object.key.corner(k));
        }
        let knuckles = finder.of(object, &surface);
        let border_curve = None;
        let fine = fineness.map(|f| {
            let asked = fine_divisions(&surface, f);
            let stated = object.head.stated_divisions();
            [0, 1].map(|k| asked[k].max(stated[k].unwrap_or(1)))
        });
        Some(Draft {
            object,
            surface,
            border_curve,
            edges,
            knuckles,
            image: None,
            meshed,
            reversed,
            cavity: is_cavity(graph, object),
            fine,
        })
    };
    let mut by_key = HashMap::new();
    for object in graph.objects().filter(|o| o.head.shown()) {
        if let Some(d) = draft(object, true) {
            by_key.insert(object.key, drafts.len());
            drafts.push(d);
        }
    }
    // Hidden originals of images take part without panels, so that the images still join.
    let mut maps: HashMap<String, u32> = HashMap::new();
    let mut at = 0;
    while at < drafts.len() {
        let original = drafts[at].surface.image_of().and_then(|(key, _)| graph.get(key));
        if let Some(object) = original {
            if let std::collections::hash_map::Entry::Vacant(slot) = by_key.entry(object.key)
                && let Some(d) = draft(object, false)
            {
                slot.insert(drafts.len());
                drafts.push(d);
            }
            let next = maps.len() as u32;
            let map = map_identity(drafts[at].object, object.key);
            let map = *maps.entry(map).or_insert(next);
            drafts[at].image = by_key.get(&object.key).map(|&original| (original, map));
        }
        at += 1;
    }
    for object in graph.objects().filter(|o| o.head.shown()) {
        let Some(border) = border_curves::border(object) else { continue };
        let finer = border_curves::finer(object, fineness)?;
        let curves = finer.as_ref().map_or(border.curves(), |finer| finer.0.curves());
        for (index, border_curve) in curves.iter().enumerate() {
            let Some(surface) = border_curves::line(border_curve) else { continue };
            let counts = BorderCounts {
                index: index as u32,
                stated: border_curve.stated,
                usual: border_curve.usual,
                density: border_curve.density.clone(),
            };
            drafts.push(Draft {
                object,
                edges: surface.edges(),
                surface,
                border_curve: Some(counts),
                knuckles: Default::default(),
                image: None,
                meshed: false,
                reversed: false,
                cavity: false,
                fine: finer.is_some().then_some([border_curve.usual, 1]),
            });
        }
    }
    Ok(drafts)
}

/// True if panels are opposite to the natural normal: by declaration, or because the surface is a
/// mirror image, whose natural normal is reversed.
fn reversed(graph: &Graph<f64>, object: &Object<f64>) -> bool {
    let mut turned = false;
    let mut at = Some(object);
    while let Some(object) = at {
        turned ^= object.head.reversed();
        at = surface_of(object).and_then(|s| s.image_of()).and_then(|(key, turns)| {
            turned ^= turns;
            graph.get(key)
        });
    }
    turned
}

/// True for a face of a cavity, and for an image of one.
fn is_cavity(graph: &Graph<f64>, object: &Object<f64>) -> bool {
    let image = surface_of(object).and_then(|s| s.image_of());
    let original = image.and_then(|(key, _)| graph.get(key));
    object.head.cavity() || original.is_some_and(|original| is_cavity(graph, original))
}

/// The map of an image: its kind and its arguments other than the original.
fn map_identity(object: &Object<f64>, original: Key) -> String {
    let rest: Vec<_> = object
        .args
        .iter()
        .filter(|arg| !matches!(arg, Value::Object(key) if *key == original))
        .collect();
    format!("{}{rest:?}", object.row.name)
}

/// Approximate number of stations along u and along v at which the divisions of a surface are
/// determined.
const FINE_PLACES: usize = 24;

/// Maximum number of divisions of a surface along u or v by a fineness.
const MAX_FINE: f64 = 20_000.0;

/// The even divisions along u and v that bring panels as near to a surface as this.
fn fine_divisions(surface: &SurfaceRef<f64>, fineness: &Fineness) -> [u32; 2] {
    let breaks = surface.breaks();
    let places = |k: usize| -> Vec<f64> {
        let mut ends = vec![0.0];
        ends.extend(breaks[k].iter().copied().filter(|b| *b > 0.0 && *b < 1.0));
        ends.push(1.0);
        let parts = (FINE_PLACES / (ends.len() - 1)).max(2);
        let middle = |i: usize| (i as f64 + 0.5) / parts as f64;
        ends.windows(2)
            .flat_map(|w| (0..parts).map(move |i| w[0] + (w[1] - w[0]) * middle(i)))
            .collect()
    };
    let (us, vs) = (places(0), places(1));
    let mut most = [0.0f64; 2];
    for &u in &us {
        let line: Vec<SurfJet<f64>> = surface.line(u, &vs, Order::Second);
        for [a, b] in line.iter().filter_map(|jet| fineness.metric(jet)) {
            most = [most[0].max(a), most[1].max(b)];
        }
    }
    most.map(|m| m.sqrt().min(MAX_FINE).ceil().max(1.0) as u32)
}
