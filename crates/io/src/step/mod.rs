//! STEP files (ISO 10303-21) of boundary representations: application protocols 242, 214 and 203.
//!
//! Common elements of faces are written once: a vertex, an edge with its curve, and on B-spline
//! surfaces its curves in parameters. Each part is a product of its own; several make an assembly.
//! The file also has names, colours, layers, the unit of length, the uncertainty and the error of
//! fits.

mod part21;
mod shape;

use crate::WriteError;
use moldloft_brep::Brep;
use part21::{Part21, list, real, text};
use shape::Shapes;
pub(crate) use shape::check;

/// Header of a file besides its shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct StepHeader<'a> {
    /// The name of the model.
    pub title: &'a str,
    /// The unit of length in metres.
    pub metres: f64,
    /// The version of the program that writes.
    pub version: &'a str,
    /// The application protocol.
    pub protocol: Protocol,
}

/// An application protocol.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Protocol {
    /// AP242, managed model based 3D engineering.
    #[default]
    Ap242,
    /// AP214, automotive design.
    Ap214,
    /// AP203, configuration controlled design.
    Ap203,
}

impl Protocol {
    /// The schema's name, the context, its short name and its year.
    fn words(self) -> [&'static str; 4] {
        match self {
            Self::Ap242 => [
                "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }",
                "managed model based 3d engineering",
                "ap242_managed_model_based_3d_engineering",
                "2014",
            ],
            Self::Ap214 => [
                "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }",
                "core data for automotive mechanical design processes",
                "automotive_design",
                "2000",
            ],
            Self::Ap203 => [
                "CONFIG_CONTROL_DESIGN",
                "configuration controlled 3d designs of mechanical parts and assemblies",
                "config_control_design",
                "1994",
            ],
        }
    }
}

/// The file.
///
/// # Errors
/// A model without faces and wires; numbers that are not finite; degrees above 25, weights that are not positive,
/// knots repeated more than the degree: readers drop such entities without a word.
pub fn write(brep: &Brep, header: &StepHeader<'_>) -> Result<Vec<u8>, WriteError> {
    check(brep, "step")?;
    let mut file = Part21::default();
    let context = RepresentationContext::new(&mut file, header, brep);
    let mut shapes = Shapes::new(brep, context.flat);
    let mut products = Vec::new();
    for part in &brep.parts {
        let items = shapes.part(&mut file, part);
        let (words, error) = if brep.exact() {
            ("exact".to_string(), None)
        } else {
            (format!("fitted within {}", real(brep.error())), Some(brep.error()))
        };
        products.push(context.product(&mut file, &part.name, &items, &words, error));
    }
    for part in &brep.faceted {
        if header.protocol != Protocol::Ap242 {
            let what = "a body of triangles (AP242 has them)";
            return Err(WriteError::CannotHold { format: "step", what });
        }
        let items = shapes.facets(&mut file, part);
        let words = match part.error {
            Some(error) => format!(
                "{} triangles, no surfaces; their centres are within {} of the shape",
                part.triangles.len(),
                real(error)
            ),
            None => format!("{} triangles, no surfaces", part.triangles.len()),
        };
        products.push(context.product(&mut file, &part.name, &items, &words, part.error));
    }
    if products.len() > 1 {
        context.assembly(&mut file, header.title, &products, brep);
    }
    shapes.presentation(&mut file, context.space);
    Ok(file.finished(header, brep.error(), brep.exact(), brep.faceted.len()))
}

/// References of all representations.
struct RepresentationContext {
    product: usize,
    definition: usize,
    /// The contexts of space and of parameters.
    space: usize,
    flat: usize,
    length: usize,
    axis: usize,
}

/// A product in the file: its definition, its representation and its axis.
struct Product {
    definition: usize,
    representation: usize,
    name: String,
}

/// Items of a part.
pub(crate) struct RepresentationItems {
    /// Solids, models of shells, or curves.
    pub items: Vec<usize>,
    pub kind: &'static str,
}

impl RepresentationContext {
    fn new(file: &mut Part21, header: &StepHeader<'_>, brep: &Brep) -> Self {
        let [_, words, short, year] = header.protocol.words();
        let application = file.add(format!("APPLICATION_CONTEXT({})", text(words)));
        file.add(format!(
            "APPLICATION_PROTOCOL_DEFINITION('international standard','{short}',{year},#{application})"
        ));
        let product = file.add(format!("PRODUCT_CONTEXT('',#{application},'mechanical')"));
        let definition = file
            .add(format!("PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"));
        let length = length_unit(file, header.metres);
        let angle = file.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))".into());
        let solid = file.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())".into());
        let uncertainty = file.add(format!(
            "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),#{length},'distance_accuracy_value','largest distance between edges and the surfaces they bound')",
            real(uncertainty(brep))
        ));
        let space = file.add(format!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{uncertainty}))GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid}))REPRESENTATION_CONTEXT('','3D'))"
        ));
        let flat = file.add(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()REPRESENTATION_CONTEXT('','2D'))"
                .into(),
        );
        let axis =
            shape::axis(file, [0.0; 3].into(), [0.0, 0.0, 1.0].into(), [1.0, 0.0, 0.0].into());
        Self { product, definition, space, flat, length, axis }
    }

    fn product(
        &self,
        file: &mut Part21,
        name: &str,
        items: &RepresentationItems,
        words: &str,
        error: Option<f64>,
    ) -> Product {
        let all: Vec<usize> = [self.axis].into_iter().chain(items.items.iter().copied()).collect();
        // Sets of curves have no axis.
        let all =
            if items.kind.ends_with("WIREFRAME_SHAPE_REPRESENTATION") { &all[1..] } else { &all };
        let name_text = text(name);
        let representation =
            file.add(format!("{}({name_text},{},#{})", items.kind, list(all), self.space));
        let definition = self.definition(file, name, words, representation);
        if let Some(error) = error {
            self.accuracy(file, definition, error);
        }
        Product { definition, representation, name: name.into() }
    }

    fn definition(
        &self,
        file: &mut Part21,
        name: &str,
        about: &str,
        representation: usize,
    ) -> usize {
        let (name, about) = (text(name), text(about));
        let product = file.add(format!("PRODUCT({name},{name},{about},(#{}))", self.product));
        file.add(format!("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{product}))"));
        let formation = file.add(format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
        let definition =
            file.add(format!("PRODUCT_DEFINITION('design','',#{formation},#{})", self.definition));
        let shape = file.add(format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"));
        file.add(format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})"));
        definition
    }

    /// The error of the fits as a property that readers show.
    fn accuracy(&self, file: &mut Part21, definition: usize, error: f64) {
        let general = file.add("GENERAL_PROPERTY('','accuracy',$)".into());
        let property = file.add(format!("PROPERTY_DEFINITION('accuracy','',#{definition})"));
        file.add(format!("GENERAL_PROPERTY_ASSOCIATION('',$,#{general},#{property})"));
        let item = file.add(format!(
            "MEASURE_REPRESENTATION_ITEM('deviation',LENGTH_MEASURE({}),#{})",
            real(error),
            self.length
        ));
        let representation = file.add(format!("REPRESENTATION('',(#{item}),#{})", self.space));
        file.add(format!("PROPERTY_DEFINITION_REPRESENTATION(#{property},#{representation})"));
    }

    fn assembly(&self, file: &mut Part21, title: &str, products: &[Product], brep: &Brep) {
        let placements: Vec<usize> = products
            .iter()
            .map(|_| {
                let [o, z, x] = [[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]].map(Into::into);
                shape::axis(file, o, z, x)
            })
            .collect();
        let all: Vec<usize> = [self.axis].into_iter().chain(placements.iter().copied()).collect();
        let representation = file.add(format!(
            "SHAPE_REPRESENTATION({},{},#{})",
            text(title),
            list(&all),
            self.space
        ));
        let exact = brep.exact() && brep.faceted.is_empty();
        let words = if exact { "exact" } else { "fitted" };
        let parent = self.definition(file, title, words, representation);
        for (k, (product, placement)) in products.iter().zip(&placements).enumerate() {
            let name = text(&product.name);
            let use_of = file.add(format!(
                "NEXT_ASSEMBLY_USAGE_OCCURRENCE('{}',{name},'',#{parent},#{},$)",
                k + 1,
                product.definition
            ));
            let shape = file.add(format!("PRODUCT_DEFINITION_SHAPE('','',#{use_of})"));
            let moved =
                file.add(format!("ITEM_DEFINED_TRANSFORMATION('','',#{},#{placement})", self.axis));
            let relation = file.add(format!(
                "(REPRESENTATION_RELATIONSHIP('','',#{},#{representation})REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{moved})SHAPE_REPRESENTATION_RELATIONSHIP())",
                product.representation
            ));
            file.add(format!("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},#{shape})"));
        }
    }
}

/// The stated uncertainty: a little more than the gap, and no less than rounding.
fn uncertainty(brep: &Brep) -> f64 {
    let most = |p: &moldloft_num::Vec3| p.to_array().iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let faceted = brep.faceted.iter().flat_map(|part| &part.positions);
    let size = brep.vertices.iter().chain(faceted).map(most).fold(0.0, f64::max);
    let least = 1e-9 * if size > 0.0 { size } else { 1.0 };
    // Two digits, rounded up.
    let wanted = (1.5 * brep.gap).max(least);
    let ten = libm::pow(10.0, libm::floor(libm::log10(wanted)));
    (wanted / ten * 10.0).ceil() / 10.0 * ten
}

fn length_unit(file: &mut Part21, metres: f64) -> usize {
    const SI: [(f64, &str); 3] = [(1.0, "$"), (1e-2, ".CENTI."), (1e-3, ".MILLI.")];
    if let Some((_, prefix)) = SI.iter().find(|(size, _)| (size - metres).abs() < 1e-12 * size) {
        return file.add(format!("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({prefix},.METRE.))"));
    }
    let name = if (metres - 0.3048).abs() < 1e-12 { "FOOT" } else { "INCH" };
    let metre = file.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))".into());
    let size =
        file.add(format!("LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),#{metre})", real(metres)));
    let dimensions = file.add("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)".into());
    file.add(format!(
        "(CONVERSION_BASED_UNIT('{name}',#{size})LENGTH_UNIT()NAMED_UNIT(#{dimensions}))"
    ))
}
