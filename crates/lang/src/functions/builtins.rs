//! Functions of the language that need the run: variables behind their arguments, files, the refinement. Each is a row
//! of the registry with its body here.

use crate::functions::grid_files::RowFormat;
use crate::functions::grid_formats;
use crate::functions::run_call::{RunBody, SequenceUse};
use moldloft_num::Dual4;
use moldloft_registry::{
    CallError, Class, Context, FieldSpec, Foreign, Implementation, Row, Scalar, Value,
};
use std::sync::Arc;

/// Maximum refinement level: intervals are halved this number of times.
pub const MOST_REFINED: u32 = 8;

/// The body of these rows for callers without a run.
struct NeedsRun;

impl NeedsRun {
    fn refused() -> CallError {
        CallError::new("no-run", "this function is part of a program that runs".to_string())
    }
}

impl Foreign for NeedsRun {
    fn call_plain(&self, _: &[Value<f64>], _: &Context) -> Result<Value<f64>, CallError> {
        Err(Self::refused())
    }

    fn call_dual(&self, _: &[Value<Dual4>], _: &Context) -> Result<Value<Dual4>, CallError> {
        Err(Self::refused())
    }
}

/// An argument that is repeated; those behind it are, too.
const fn several(field: FieldSpec) -> FieldSpec {
    FieldSpec { many: true, variadic: true, ..field }
}

const FILE: FieldSpec =
    FieldSpec::new("name", Class::Text, "Name of the file, beside the program.");

const BLOCK: FieldSpec =
    FieldSpec::new("block", Class::Integer, "Number of the block in the file; default 1.")
        .optional();

const ARRAYS: FieldSpec = several(FieldSpec::new(
    "s",
    Class::Any,
    "Curves, surfaces or blocks to write; a list counts as its members.",
));

const BLOCKS: FieldSpec = several(FieldSpec::new(
    "b",
    Class::Any,
    "Blocks, or surfaces in one plane; a list counts as its members.",
));

const FACES: FieldSpec = FieldSpec::new(
    "faces",
    Class::Text,
    "Boundaries of the block before it, such as `k1 = hull wall, i1 in = plane symmetry`: faces (of a surface i1, im, j1, jn), a name and one of the types \"wall\", \"symmetry\", \"farfield\", \"inflow\", \"outflow\", \"periodic\", \"empty\", \"wedge\", \"patch\".",
).optional();

/// Declares the functions: name, class of the value, arguments, documentation, example and body.
macro_rules! functions {
    ($($name:literal $class:ident [$($field:expr),* $(,)?]
        $doc:literal $example:literal |$run:ident, $call:ident| $body:expr;)*) => {
        /// The rows, in the order of the reference.
        pub fn rows() -> Vec<Row> {
            vec![$(Row {
                class: Class::$class,
                ..Row::new($name, Implementation::Foreign(Arc::new(NeedsRun)))
                    .doc($doc)
                    .fields(vec![$($field),*])
                    .example($example)
            }),*]
        }

        /// The body of a function; `None` for other names.
        pub(crate) fn body<T: Scalar>(name: &str) -> Option<RunBody<T>> {
            match name {
                $($name => Some(|$run, $call| $body),)*
                _ => None,
            }
        }
    };
}

functions! {
    "format" Text [
        FieldSpec::new("pattern", Class::Text, "Text with directives as in C: %d %i %f %e %g %s, with flags and widths."),
        several(FieldSpec::new("values", Class::Any, "Numbers, texts and points for the directives.")).optional(),
    ]
        "Formats numbers by C directives; the pattern repeats for the remaining values."
        "assert format(\"%6.2f|%d\", 2.5, 3) == \"  2.50|3\";"
        |run, call| run.formatted(call);

    "open" Integer [
        FILE,
        FieldSpec::new("mode", Class::Text, "\"r\", \"w\" or \"a\"; \"r\" by default.").optional(),
        FieldSpec::new("unit", Class::Integer, "Number of the unit; may be the first argument, as in open(7, name).").optional(),
    ]
        "Opens a text file to read (\"r\"), write (\"w\") or append (\"a\"); open(7, name) chooses the unit."
        "file f = open(\"a.txt\", \"w\"); write(f, 1, {2, 3, 4}); close(f);"
        |run, call| run.open_file(call);

    "close" Nothing [FieldSpec::new("f", Class::Any, "The file, or its unit.")]
        "Closes a file."
        "open(7, \"a.txt\"); close(7);"
        |run, call| run.close_file(call);

    "write" Nothing [
        FieldSpec::new("f", Class::Any, "The file, its unit, or `stdout`."),
        several(FieldSpec::new("values", Class::Any, "Texts, numbers, points and arrays, each from a new line.")).optional(),
    ]
        "Writes values to a file: a point or number on each line, the first index of a grid fastest."
        "write(stdout, \"two points\", {{1, 2, 3}, {4, 5, 6}});"
        |run, call| run.write_values(call);

    "read" Nothing [
        FieldSpec::new("f", Class::Any, "The file, or its unit."),
        several(FieldSpec::new("variables", Class::Any, "Variables, elements and sections to fill, in order.")),
    ]
        "Reads numbers into variables or parts of them; a string takes the rest of the line."
        "open(7, \"a.txt\"); write(7, {1, 2, 3}); close(7); file f = open(\"a.txt\", \"r\"); vector v; read(f, v); assert v.z == 3;"
        |run, call| run.read_values(call);

    "more" Number [FieldSpec::new("c", Class::Any, "The multiple argument, or the file.")]
        "Reports whether a multiple argument, or a file, has unread items."
        "function float total(float x...) { float s = 0; while (more(x)) s += next(x); return s; } assert total(1, 2) == 3;"
        |run, call| run.sequence(call, SequenceUse::More);

    "next" Any [FieldSpec::new("c", Class::Any, "The multiple argument.")]
        "The next item of a multiple argument."
        "function float second(float x...) { next(x); return next(x); } assert second(1, 2) == 2;"
        |run, call| run.sequence(call, SequenceUse::Next);

    "rewind" Nothing [FieldSpec::new("c", Class::Any, "The multiple argument, or the file.")]
        "Returns to the first item of a multiple argument, or to the start of a file."
        "function float first(float x...) { next(x); rewind(x); return next(x); } assert first(1, 2) == 1;"
        |run, call| run.sequence(call, SequenceUse::Rewind);

    "count" Number [FieldSpec::new("c", Class::Any, "Multiple argument, list or mask.")]
        "The number of items of a multiple argument or a list; for a mask, the number of true elements."
        "function float n(float x...) { return count(x); } assert n(5, 6, 7) == 3;"
        |run, call| run.sequence(call, SequenceUse::Count);

    "isset" Number [FieldSpec::new("a", Class::Any, "The variable, element or section.")]
        "Reports whether a variable, or every element of a section, has a value."
        "curve c[3]; c[1:2] = {0, 0, 0}; assert isset(c[2]) and not isset(c);"
        |run, call| run.is_set(call);

    "ieee" Nothing [FieldSpec::new("on", Class::Number, "0: errors again; default 1.").optional()]
        "Lets infinite results and NaN pass from here on, such as that of 1/0, or with 0 makes them errors again."
        "ieee(); float a = 1/0; assert a > 1e308; ieee(0);"
        |run, call| run.ieee(call);

    "check_edges" Nothing [FieldSpec::new("s", Class::Vectors, "The surface.")]
        "Stops with location and gap when the four edges of a surface are not set or do not meet."
        "surface s[3,3] = {0, 0, 0}; check_edges(s);"
        |run, call| run.check_edges(call);

    "refined" Number [FieldSpec::new("n", Class::Integer, "The number of points of the coarse run.")]
        "`n` points, or more when the run is refined: intervals are halved, so that coarse points recur."
        "farray s = uniform(0, 1, refined(5));"
        |run, call| run.refined_count(call);

    "refined_step" Number [FieldSpec::new("ds", Class::Number, "The step of the coarse run.")]
        "A step per index consistent with refined(n): halved at each refinement; for d_tanhx, geometric and geometric2 the first cell of the coarse run is divided in two."
        "farray s = d_tanh(0, 1, refined_step(.01), 0, refined(25));"
        |run, call| run.refined_step(call);

    "refinement" Number []
        "The number of parts of each interval of refined(n): 1, 2, 4, ..."
        "assert refinement() >= 1;"
        |run, call| run.refinement(call);

    "write_p3d" Nothing [
        FILE,
        FieldSpec::new("words", Class::Text, "Variant: \"stream\", \"records\" or \"text\"; \"double\" or \"single\"; \"multi\" or \"single-block\"; \"3d\" or \"2d\"; \"whole\" or \"planes\"; \"little\" or \"big\"; \"iblank\"; \"mark8\". The first of each by default.").optional(),
        several(FieldSpec::new("s", Class::Any, "Arrays to write; an farray of integers after one is its blanking.")),
    ]
        "Writes curves, surfaces or blocks as a Plot3D file."
        "surface s[3,2] = {1, 2, 3}; write_p3d(\"s.x\", \"records single\", s); surface t = read_p3d(\"s.x\"); assert t.d1 == 3;"
        |run, call| run.write_grids(call, &grid_formats::PLOT3D);

    "write_vts" Nothing [FILE, ARRAYS]
        "Writes surfaces as VTK structured grids: one .vts, or several with their .vtm."
        "surface s[3,2] = {1, 2, 3}; write_vts(\"s.vts\", s);"
        |run, call| run.write_grids(call, &grid_formats::VTS);

    "plot" Nothing [
        FieldSpec::new("name", Class::Text, "Name of the file, ending in .png or .svg."),
        FieldSpec::new("view", Class::Text, "\"x\", \"y\", \"z\", \"-x\", \"-y\", \"-z\" or \"iso\"; default: the view with the largest image.").optional(),
        several(FieldSpec::new("s", Class::Any, "Curves, surfaces and blocks to draw.")),
    ]
        "Draws curves, surfaces and blocks to a .png or .svg; plot(name, view, ...) looks from \"x\", \"-y\", \"z\", \"iso\" ..."
        "curve c[30]; c.x = uniform(0, 1, 30); c.y = c.x^2; plot(\"parabola.svg\", c);"
        |run, call| run.write_grids(call, &grid_formats::PICTURE);

    "write_stl" Nothing [
        FILE,
        FieldSpec::new("words", Class::Text, "\"flip\" reverses the normals.").optional(),
        ARRAYS,
    ]
        "Writes surfaces as binary STL, with facets facing out of the body and without the triangles of zero area at poles; \"flip\" reverses the normals."
        "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; write_stl(\"s.stl\", s);"
        |run, call| run.write_grids(call, &grid_formats::STL);

    "write_cgns" Nothing [FILE, ARRAYS, FACES]
        "Writes surfaces, or blocks, as structured CGNS zones with the interfaces where they have the same points; after a block its boundaries."
        "surface s[3,2] = {1, 2, 3}; write_cgns(\"s.cgns\", s);"
        |run, call| run.write_grids(call, &grid_formats::CGNS);

    "write_su2" Nothing [FILE, BLOCKS, FACES]
        "Writes blocks, or surfaces in one plane as a 2-D mesh, as one SU2 mesh, joined where they have the same points; faces of equal name are one marker."
        "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_su2(\"b.su2\", b, \"k1 = floor wall, i1 in j1 jn kn = box outflow\");"
        |run, call| run.write_grids(call, &grid_formats::SU2);

    "write_gmsh" Nothing [FILE, BLOCKS, FACES]
        "Writes blocks, or surfaces in one plane as a 2-D mesh, as one Gmsh mesh 4.1, joined where they have the same points; faces of equal name are one physical surface, or for surfaces one physical curve."
        "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_gmsh(\"b.msh\", b, \"k1 = floor wall, i1 in j1 jn kn = box outflow\");"
        |run, call| run.write_grids(call, &grid_formats::GMSH);

    "write_blockmesh" Nothing [
        FILE,
        FieldSpec::new("words", Class::Text, "\"graded\": few blocks with curved, graded edges; blockMesh interpolates between the edges.").optional(),
        BLOCKS,
        FACES,
    ]
        "Writes blocks, or surfaces in one plane between two empty sides, as a blockMeshDict of OpenFOAM with a block for each cell, so that its points are kept, or, \"graded\", with few blocks whose edges have the points of the grid; faces of equal name are one patch."
        "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_blockmesh(\"blockMeshDict\", b, \"k1 = floor wall, i1 in j1 jn kn = box outflow\");"
        |run, call| run.write_grids(call, &grid_formats::BLOCK_MESH);

    "write_polymesh" Nothing [FILE, BLOCKS, FACES]
        "Writes blocks, or surfaces in one plane between two empty sides, as a polyMesh of OpenFOAM: the files points, faces, owner, neighbour and boundary of the folder `name`; faces of equal name are one patch."
        "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_polymesh(\"constant/polyMesh\", b, \"k1 = floor wall, i1 in j1 jn kn = box outflow\");"
        |run, call| run.write_grids(call, &grid_formats::POLY_MESH);

    "write_ugrid" Nothing [FILE, BLOCKS, FACES]
        "Writes blocks as one UGRID mesh (AFLR3) with the boundary conditions of FUN3D in a .mapbc beside it; the name ends in .b8.ugrid (big-endian), .lb8.ugrid (little-endian) or .ugrid (text). All boundaries have a name and one of the types wall, symmetry, farfield, inflow, outflow."
        "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_ugrid(\"b.b8.ugrid\", b, \"k1 = floor wall, i1 in j1 jn kn = box outflow\");"
        |run, call| run.write_grids(call, &grid_formats::UGRID);

    "write_nmf" Nothing [FILE, BLOCKS, FACES]
        "Writes the connections and boundaries of blocks as a neutral map file, for the Plot3D file of the same blocks; types are called as by FUN3D, a patch by its name."
        "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_nmf(\"b.nmf\", b, \"k1 = floor wall, i1 in j1 jn kn = box outflow\"); write_p3d(\"b.p3d\", b);"
        |run, call| run.write_grids(call, &grid_formats::NEUTRAL_MAP);

    "interfaces" Text [BLOCKS, FACES]
        "The connections and boundaries of blocks, or of surfaces in one plane, as the writers use them, a line for each; folded and left-handed cells, faces that are not joined and symmetry that is not plane are reported."
        "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; block c = b + {1, 0, 0}; print interfaces(b, \"i1 j1 jn k1 kn = box wall\", c, \"in j1 jn k1 kn = box wall\");"
        |run, call| run.interfaces(call);

    "write_csv" Nothing [FILE, several(FieldSpec::new("c", Class::Vectors, "Curves or surfaces to write."))]
        "Writes points as lines of x,y,z under a heading, with all digits."
        "curve c[2] = {1, 2, 3}; write_csv(\"c.csv\", c); assert read_points(\"c.csv\")[2] . {1, 0, 0} == 1;"
        |run, call| run.write_grids(call, &grid_formats::CSV);

    "read_p3d" Any [FILE, BLOCK]
        "A surface or block of a Plot3D file of any variant."
        "surface s[3,2] = {1, 2, 3}; write_p3d(\"s.x\", s); assert read_p3d(\"s.x\", 1).d2 == 2;"
        |run, call| run.read_p3d(call);

    "iblank_p3d" Any [FILE, BLOCK]
        "The blanking of a surface or block of a Plot3D file, a whole number for each point."
        "surface s[2,2] = {1, 2, 3}; farray hole[2,2] = 1; hole[1,1] = 0; write_p3d(\"s.x\", s, hole); assert iblank_p3d(\"s.x\")[1,1] == 0;"
        |run, call| run.iblank_p3d(call);

    "count_p3d" Number [FILE]
        "The number of surfaces and blocks of a Plot3D file."
        "surface s[3,2] = {1, 2, 3}; write_p3d(\"s.x\", s, s); assert count_p3d(\"s.x\") == 2;"
        |run, call| run.count_p3d(call);

    "read_cgns" Any [
        FILE,
        FieldSpec::new("zone", Class::Any, "Number or name of the zone; default 1.").optional(),
    ]
        "A structured zone of a CGNS file (HDF5) as a surface or block."
        "surface s[3,2] = {1, 2, 3}; write_cgns(\"s.cgns\", s); surface t = read_cgns(\"s.cgns\", \"s\"); assert t.d1 == 3;"
        |run, call| run.read_cgns(call);

    "count_cgns" Number [FILE]
        "The number of zones of a CGNS file."
        "surface s[3,2] = {1, 2, 3}; write_cgns(\"s.cgns\", s, s); assert count_cgns(\"s.cgns\") == 2;"
        |run, call| run.count_cgns(call);

    "names_cgns" List [FILE]
        "The names of the zones of a CGNS file, in their order."
        "surface s[3,2] = {1, 2, 3}; write_cgns(\"s.cgns\", s); string names[1] = names_cgns(\"s.cgns\"); print names[1];"
        |run, call| run.names_cgns(call);

    "text_outlines" List [
        FieldSpec::new("text", Class::Text, "The text, of one or more lines."),
        FieldSpec::new("font", Class::Text, "A .ttf, .otf or .ttc file beside the program, or the name of a font of the system."),
        FieldSpec::new("size", Class::Number, "Height of a capital letter; default 1.").optional(),
        FieldSpec::new("align", Class::Text, "\"left\", \"centre\" or \"right\" of the origin; default \"left\".").optional(),
    ]
        "The outlines of a text in the plane z = 0 as closed curves, exact: loops round letters anticlockwise, those round holes clockwise."
        "set s = extruded_region(text_outlines(\"HV\", \"letters.ttf\", size = 7), {0, 0, 2}); SetBody b(s, {-1, -1, -1}, {15, 8, 3}, depth = 5); assert abs(b.volume - 89.84) < 1;"
        |run, call| run.text_outlines(call);

    "read_points" Vectors [FILE]
        "The points of a text with two or three numbers to a line, as a curve."
        "curve c[2] = {1, 2, 3}; write_csv(\"c.csv\", c); curve d = read_points(\"c.csv\");"
        |run, call| run.read_rows(call, RowFormat::Points);

    "read_aerofoil" Vectors [FILE]
        "A section of a coordinate file in Selig's or Lednicer's listing: tail, upper side, nose, lower side, tail."
        "file f = open(\"a.dat\", \"w\"); write(f, \"a wedge\"); for (x = 1:0:-.25) write(f, format(\"%g %g\", x, .1*x)); for (x = .25:1:.25) write(f, format(\"%g %g\", x, -.1*x)); close(f); assert read_aerofoil(\"a.dat\").d1 == 9;"
        |run, call| run.read_rows(call, RowFormat::Aerofoil);
}
