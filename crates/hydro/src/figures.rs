//! The hydrostatic figures of a body below a water plane z = level.

use crate::attitude::Attitude;
use crate::body::Body;
use crate::hydrostatics::{FormCoefficients, Hydrostatics, Symmetry, VolumeForms, Waterplane};
use crate::integrals::{Immersed, Wanted};
use crate::section::{section_area, waterline_extent};
use crate::strip::CoordinatePlane;
use moldloft_num::{Real, Vec3};

/// Figures with additional quantities for stability.
pub(crate) struct Floating<T> {
    pub figures: Hydrostatics<T>,
    /// The integral of x y over the waterplane about its centre.
    pub product_moment: T,
    /// See [`crate::Flotation::errors`].
    pub errors: [f64; 6],
}

/// The integrals below a level about (x0, y0, level), of one or both sides.
pub(crate) struct Displaced<T> {
    pub volume: T,
    pub moment: Vec3<T>,
    pub plane: [T; 6],
}

/// Volume, moments and waterplane at an attitude about (x0, y0) in earth axes; `count` is 1, or 2
/// for both sides of a half body, and negative for normals that point inward. Volume and moments
/// have the relative `accuracy`.
pub(crate) fn displaced<T: Real>(
    body: &Body<T>,
    attitude: Attitude<T>,
    origin: [T; 2],
    count: f64,
    accuracy: f64,
) -> Displaced<T> {
    let sums = body.immersed_at(attitude, origin, Wanted::Displacement, accuracy).sums;
    let times = |x: T| x * count;
    Displaced {
        volume: times(sums.forms[2]),
        moment: sums.moment.map(times),
        plane: sums.plane.map(times),
    }
}

/// The figures of the upright body at z = `level`; see [`Hydrostatics`].
pub fn hydrostatics<T: Real>(
    body: &Body<T>,
    level: T,
    symmetry: Symmetry,
    density: f64,
) -> Hydrostatics<T> {
    floating(body, Attitude::upright(level), symmetry, density).figures
}

/// Figures of the body at an attitude. The skin may be open at the level, above it and, for a
/// half body, in the plane y = 0. Normals that all point inward give the same figures and are
/// reported.
pub(crate) fn floating<T: Real>(
    body: &Body<T>,
    attitude: Attitude<T>,
    symmetry: Symmetry,
    density: f64,
) -> Floating<T> {
    let turned = body.turned(attitude);
    let origin = origin_of(&turned, symmetry).map(T::from);
    let all = body.immersed_at(attitude, origin, Wanted::All, body.quadrature_accuracy());
    of_integrals(&turned, origin, attitude.level, symmetry, density, &all)
}

/// The origin of the integrals, in the water plane.
pub(crate) fn origin_of<T: Real>(body: &Body<T>, symmetry: Symmetry) -> [f64; 2] {
    let middle = body.bounds().centre();
    [middle.x, if symmetry == Symmetry::None { middle.y } else { 0.0 }]
}

/// The figures from the integrals about (x0, y0, level).
pub(crate) fn of_integrals<T: Real>(
    body: &Body<T>,
    [x0, y0]: [T; 2],
    level: T,
    symmetry: Symmetry,
    density: f64,
    all: &Immersed<T>,
) -> Floating<T> {
    let half = symmetry != Symmetry::None;
    let origin = Vec3::new(x0, y0, level);
    let sums = &all.sums;
    let outward = sums.forms[2].re() >= 0.0;
    let sides = if symmetry == Symmetry::MirroredTwice { 2.0 } else { 1.0 };
    let count = if outward { sides } else { -sides };
    let [x, y, z] = sums.forms.map(|form| form * count);
    let volume = z;
    let mut buoyancy_centre =
        (volume.re() > 0.0).then(|| origin + sums.moment * T::from(count) / volume);
    if let (Some(centre), Symmetry::MirroredTwice) = (&mut buoyancy_centre, symmetry) {
        centre.y = T::zero();
    }
    let lowest = body.lowest(Vec3::of(0.0, 0.0, 1.0));
    let draft = lowest.map_or(T::zero(), |low| (level - low).max(T::zero()));
    let cut = CoordinatePlane::new(2, level, body.size());
    let mut product_moment = T::zero();
    let waterplane = waterline_extent(&all.waterline, cut).map(|extent| {
        let plane = sums.plane.map(|p| p * count);
        let (mut found, product) = waterplane(plane, extent, origin, symmetry);
        product_moment = product;
        let half_way = (found.ends[0] + found.ends[1]) * 0.5;
        found.midship_area = section_area(body, half_way, level)[0].abs() * sides;
        found
    });
    let coefficients = waterplane.filter(|w| volume.re() > 0.0 && w.midship_area.re() > 0.0);
    let coefficients = coefficients.map(|w| FormCoefficients {
        block: volume / (w.length * w.beam * draft),
        prismatic: volume / (w.midship_area * w.length),
        midship: w.midship_area / (w.beam * draft),
        waterplane: w.area / (w.length * w.beam),
    });
    let relative = |error: f64, size: f64| if error == 0.0 { 0.0 } else { error / size.abs() };
    let largest = (x - z).re().abs().max((y - z).re().abs());
    let green = sums.green.re().abs();
    let fit = body.fit_errors(&body.bounds());
    let mut errors: [f64; 6] = std::array::from_fn(|k| (all.errors[k] + fit[k]) * sides);
    // Rims that only nearly meet leave slits, whose share differs from form to form.
    errors[0] += largest;
    errors[1] += largest * body.size();
    let figures = Hydrostatics {
        level,
        volume,
        displacement: volume * density,
        buoyancy_centre,
        wetted_area: sums.wetted * sides,
        draft,
        waterplane,
        coefficients,
        forms: VolumeForms { x, y, z },
        closure_error: relative(largest, volume.re()),
        waterplane_error: relative((sums.plane[0].re().abs() - green).abs(), sums.plane[0].re()),
        open_edges: body.open_below(level.re(), half),
        outward,
    };
    Floating { figures, product_moment, errors }
}

/// The waterplane from integrals about the origin, and the product moment about its centre.
fn waterplane<T: Real>(
    [area, mx, my, mxx, mxy, myy]: [T; 6],
    [x_low, x_high, y_low, y_high]: [T; 4],
    origin: Vec3<T>,
    symmetry: Symmetry,
) -> (Waterplane<T>, T) {
    let has_area = area.re() != 0.0;
    let ratio = |m: T| if has_area { m / area } else { T::zero() };
    let dx = ratio(mx);
    let both = symmetry == Symmetry::MirroredTwice;
    let dy = if both { T::zero() } else { ratio(my) };
    let beam = match symmetry {
        Symmetry::None => y_high - y_low,
        Symmetry::MirroredTwice => y_high.abs().max(y_low.abs()) * 2.0,
        Symmetry::MirroredOnce => y_high.abs().max(y_low.abs()),
    };
    // Parallel axis theorem: the moment about the centre is that about the origin minus area times
    // distances.
    let plane = Waterplane {
        area,
        centre: origin + Vec3::new(dx, dy, T::zero()),
        transverse_moment: myy - area * dy * dy,
        longitudinal_moment: mxx - area * dx * dx,
        ends: [x_low, x_high],
        length: x_high - x_low,
        beam,
        midship_area: T::zero(),
    };
    (plane, if both { T::zero() } else { mxy - area * dx * dy })
}
