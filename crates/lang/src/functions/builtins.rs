//! Built-in functions that need the interpreter: names, arguments and examples; their
//! implementation is in `context`.

use crate::functions::block_files::BOUNDARY_KINDS;
use crate::functions::grid_formats::{self, GridFormat};

/// Maximum refinement level: intervals are halved this number of times.
pub const MOST_REFINED: u32 = 8;

/// A built-in function, with its texts for the reference and the editor.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// Its name.
    pub name: &'static str,
    pub(crate) action: Action,
    /// Description in one line.
    pub doc: &'static str,
    /// Description of the result.
    pub returns: &'static str,
    /// Name, class and meaning of each argument; a `?` after the name marks an optional argument.
    pub help: &'static [(&'static str, &'static str, &'static str)],
    /// A complete program that calls it.
    pub example: &'static str,
}

impl Builtin {
    /// The call: `name(a, [b], ...)`, with optional arguments in brackets, and dots if the last
    /// ones may be repeated.
    pub fn signature(&self) -> String {
        let mut arguments: Vec<String> = Vec::new();
        for (name, ..) in self.help {
            arguments.push(match name.strip_suffix('?') {
                Some(name) => format!("[{name}]"),
                None => (*name).to_string(),
            });
        }
        if self.help.iter().any(|(_, class, _)| class.ends_with('…')) {
            arguments.push("...".to_string());
        }
        format!("{}({})", self.name, arguments.join(", "))
    }

    /// Minimum and maximum number of arguments.
    pub fn arity(&self) -> (usize, usize) {
        let least = self.help.iter().filter(|(name, ..)| !name.ends_with('?')).count();
        let several = self.help.iter().any(|(_, class, _)| class.ends_with('…'));
        (least, if several { usize::MAX } else { self.help.len() })
    }

    /// The names of its arguments.
    pub fn argument_names(&self) -> impl Iterator<Item = &'static str> {
        self.help.iter().map(|(name, ..)| name.trim_end_matches('?'))
    }

    /// The allowed words of a text argument.
    pub fn words(&self, argument: usize) -> impl Iterator<Item = &'static str> {
        let words: &[&str] = match (self.action, argument) {
            (Action::WriteGrids(format), 1..) if format.joins => &BOUNDARY_KINDS,
            (Action::Interfaces, 1..) => &BOUNDARY_KINDS,
            (Action::WriteGrids(format), 1) => format.words,
            (Action::Open, 1..) => &["r", "w", "a"],
            _ => &[],
        };
        words.iter().copied()
    }

    /// True for an argument that names a file.
    pub fn names_file(&self, argument: usize) -> bool {
        argument == 0 && self.help.first().is_some_and(|(name, ..)| *name == "name")
    }
}

/// Implementation of a built-in function.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Action {
    Format,
    Open,
    Close,
    Write,
    Read,
    More,
    Next,
    Rewind,
    Count,
    IsSet,
    Ieee,
    CheckEdges,
    Refined,
    RefinedStep,
    Refinement,
    WriteGrids(&'static GridFormat),
    Interfaces,
    ReadPlot3d,
    BlankingPlot3d,
    CountPlot3d,
    ReadCgns,
    CountCgns,
    NamesCgns,
    ReadRows(RowFormat),
}

/// Arguments of writers of meshes of blocks.
const BLOCKS_AND_FACES: &[(&str, &str, &str)] = &[
    ("name", "text", "Name of the file, beside the program."),
    ("b", "block or surface …", "Blocks, or surfaces in one plane; a list counts as its members."),
    (
        "faces?",
        "text",
        "Boundaries of the block before it, such as \"k1 = hull wall, i1 in = plane symmetry\" (of a surface i1, im, j1, jn): faces, a name and one of the types wall, symmetry, farfield, inflow, outflow, periodic, empty, wedge, patch.",
    ),
];

/// All built-in functions, in the order of the reference.
pub const BUILTINS: &[Builtin] = &[
    Builtin {
        name: "format",
        action: Action::Format,
        doc: "Formats numbers by C directives; the pattern repeats for the remaining values.",
        returns: "text",
        help: &[
            (
                "pattern",
                "text",
                "Text with directives as in C: %d %i %f %e %g %s, with flags and widths.",
            ),
            ("values?", "value …", "Numbers, texts and points for the directives."),
        ],
        example: "assert format(\"%6.2f|%d\", 2.5, 3) == \"  2.50|3\";",
    },
    Builtin {
        name: "open",
        action: Action::Open,
        doc: "Opens a text file to read (\"r\"), write (\"w\") or append (\"a\"); open(7, name) chooses the unit.",
        returns: "file",
        help: &[
            ("name", "text", "Name of the file, beside the program."),
            ("mode?", "text", "\"r\", \"w\" or \"a\"; \"r\" by default."),
            (
                "unit?",
                "integer",
                "Number of the unit; may be the first argument, as in open(7, name).",
            ),
        ],
        example: "file f = open(\"a.txt\", \"w\"); write(f, 1, {2, 3, 4}); close(f);",
    },
    Builtin {
        name: "close",
        action: Action::Close,
        doc: "Closes a file.",
        returns: "nothing",
        help: &[("f", "file", "The file, or its unit.")],
        example: "open(7, \"a.txt\"); close(7);",
    },
    Builtin {
        name: "write",
        action: Action::Write,
        doc: "Writes values to a file: a point or number on each line, the first index of a grid fastest.",
        returns: "nothing",
        help: &[
            ("f", "file", "The file, its unit, or `stdout`."),
            ("values?", "value …", "Texts, numbers, points and arrays, each from a new line."),
        ],
        example: "write(stdout, \"two points\", {{1, 2, 3}, {4, 5, 6}});",
    },
    Builtin {
        name: "read",
        action: Action::Read,
        doc: "Reads numbers into variables or parts of them; a string takes the rest of the line.",
        returns: "nothing",
        help: &[
            ("f", "file", "The file, or its unit."),
            ("variables", "variable …", "Variables, elements and sections to fill, in order."),
        ],
        example: "open(7, \"a.txt\"); write(7, {1, 2, 3}); close(7); file f = open(\"a.txt\", \"r\"); vector v; read(f, v); assert v.z == 3;",
    },
    Builtin {
        name: "more",
        action: Action::More,
        doc: "Reports whether a multiple argument, or a file, has unread items.",
        returns: "number",
        help: &[("c", "argument or file", "The multiple argument, or the file.")],
        example: "function float total(float x...) { float s = 0; while (more(x)) s += next(x); return s; } assert total(1, 2) == 3;",
    },
    Builtin {
        name: "next",
        action: Action::Next,
        doc: "The next item of a multiple argument.",
        returns: "value",
        help: &[("c", "argument", "The multiple argument.")],
        example: "function float second(float x...) { next(x); return next(x); } assert second(1, 2) == 2;",
    },
    Builtin {
        name: "rewind",
        action: Action::Rewind,
        doc: "Returns to the first item of a multiple argument, or to the start of a file.",
        returns: "nothing",
        help: &[("c", "argument or file", "The multiple argument, or the file.")],
        example: "function float first(float x...) { next(x); rewind(x); return next(x); } assert first(1, 2) == 1;",
    },
    Builtin {
        name: "count",
        action: Action::Count,
        doc: "The number of items of a multiple argument or a list; for a mask, the number of true elements.",
        returns: "number",
        help: &[("c", "argument, list or mask", "Multiple argument, list or mask.")],
        example: "function float n(float x...) { return count(x); } assert n(5, 6, 7) == 3;",
    },
    Builtin {
        name: "isset",
        action: Action::IsSet,
        doc: "Reports whether a variable, or every element of a section, has a value.",
        returns: "number",
        help: &[("a", "variable", "The variable, element or section.")],
        example: "curve c[3]; c[1:2] = {0, 0, 0}; assert isset(c[2]) and not isset(c);",
    },
    Builtin {
        name: "ieee",
        action: Action::Ieee,
        doc: "Lets infinite results and NaN pass from here on, such as that of 1/0, or with 0 makes them errors again.",
        returns: "nothing",
        help: &[("on?", "number", "0: errors again; default 1.")],
        example: "ieee(); float a = 1/0; assert a > 1e308; ieee(0);",
    },
    Builtin {
        name: "check_edges",
        action: Action::CheckEdges,
        doc: "Stops with location and gap when the four edges of a surface are not set or do not meet.",
        returns: "nothing",
        help: &[("s", "surface", "The surface.")],
        example: "surface s[3,3] = {0, 0, 0}; check_edges(s);",
    },
    Builtin {
        name: "refined",
        action: Action::Refined,
        doc: "`n` points, or more when the run is refined: intervals are halved, so that coarse points recur.",
        returns: "number",
        help: &[("n", "integer", "The number of points of the coarse run.")],
        example: "farray s = uniform(0, 1, refined(5));",
    },
    Builtin {
        name: "refined_step",
        action: Action::RefinedStep,
        doc: "A step per index consistent with refined(n): halved at each refinement; for d_tanhx, geometric and geometric2 the first cell of the coarse run is divided in two.",
        returns: "number",
        help: &[("ds", "number", "The step of the coarse run.")],
        example: "farray s = d_tanh(0, 1, refined_step(.01), 0, refined(25));",
    },
    Builtin {
        name: "refinement",
        action: Action::Refinement,
        doc: "The number of parts of each interval of refined(n): 1, 2, 4, ...",
        returns: "number",
        help: &[],
        example: "assert refinement() >= 1;",
    },
    Builtin {
        name: "write_p3d",
        action: Action::WriteGrids(&grid_formats::PLOT3D),
        doc: "Writes curves, surfaces or blocks as a Plot3D file.",
        returns: "nothing",
        help: &[
            ("name", "text", "Name of the file, beside the program."),
            (
                "words?",
                "text",
                "Variant: \"stream\", \"records\" or \"text\"; \"double\" or \"single\"; \"multi\" or \"single-block\"; \"3d\" or \"2d\"; \"whole\" or \"planes\"; \"little\" or \"big\"; \"iblank\"; \"mark8\". The first of each by default.",
            ),
            (
                "s",
                "curve, surface or block …",
                "Arrays to write; an farray of integers after one is its blanking.",
            ),
        ],
        example: "surface s[3,2] = {1, 2, 3}; write_p3d(\"s.x\", \"records single\", s); surface t = read_p3d(\"s.x\"); assert t.d1 == 3;",
    },
    Builtin {
        name: "write_vts",
        action: Action::WriteGrids(&grid_formats::VTS),
        doc: "Writes surfaces as VTK structured grids: one .vts, or several with their .vtm.",
        returns: "nothing",
        help: &[
            ("name", "text", "Name of the file, beside the program."),
            ("s", "curve, surface or block …", "Arrays to write; a list counts as its members."),
        ],
        example: "surface s[3,2] = {1, 2, 3}; write_vts(\"s.vts\", s);",
    },
    Builtin {
        name: "plot",
        action: Action::WriteGrids(&grid_formats::PICTURE),
        doc: "Draws curves, surfaces and blocks to a .png or .svg; plot(name, view, ...) looks from \"x\", \"-y\", \"z\", \"iso\" ...",
        returns: "nothing",
        help: &[
            ("name", "text", "Name of the file, ending in .png or .svg."),
            (
                "view?",
                "text",
                "\"x\", \"y\", \"z\", \"-x\", \"-y\", \"-z\" or \"iso\"; default: the view with the largest image.",
            ),
            ("s", "curve, surface or block …", "Curves, surfaces and blocks to draw."),
        ],
        example: "curve c[30]; c.x = uniform(0, 1, 30); c.y = c.x^2; plot(\"parabola.svg\", c);",
    },
    Builtin {
        name: "write_stl",
        action: Action::WriteGrids(&grid_formats::STL),
        doc: "Writes surfaces as binary STL, with facets facing out of the body and without the triangles of zero area at poles; \"flip\" reverses the normals.",
        returns: "nothing",
        help: &[
            ("name", "text", "Name of the file, beside the program."),
            ("words?", "text", "\"flip\" reverses the normals."),
            ("s", "curve, surface or block …", "Arrays to write; a list counts as its members."),
        ],
        example: "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; write_stl(\"s.stl\", s);",
    },
    Builtin {
        name: "write_cgns",
        action: Action::WriteGrids(&grid_formats::CGNS),
        doc: "Writes surfaces, or blocks, as structured CGNS zones with the interfaces where they have the same points; after a block its boundaries.",
        returns: "nothing",
        help: &[
            ("name", "text", "Name of the file, beside the program."),
            ("s", "curve, surface or block …", "Arrays to write; a list counts as its members."),
            (
                "faces?",
                "text",
                "Boundaries of the block before it, such as \"k1 = hull wall, i1 in = plane symmetry\": faces, a name and one of the types wall, symmetry, farfield, inflow, outflow, periodic, patch.",
            ),
        ],
        example: "surface s[3,2] = {1, 2, 3}; write_cgns(\"s.cgns\", s);",
    },
    Builtin {
        name: "write_su2",
        action: Action::WriteGrids(&grid_formats::SU2),
        doc: "Writes blocks, or surfaces in one plane as a 2-D mesh, as one SU2 mesh, joined where they have the same points; faces of equal name are one marker.",
        returns: "nothing",
        help: BLOCKS_AND_FACES,
        example: "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_su2(\"b.su2\", b, \"k1 = floor wall, i1 in j1 jn kn = box outflow\");",
    },
    Builtin {
        name: "write_gmsh",
        action: Action::WriteGrids(&grid_formats::GMSH),
        doc: "Writes blocks, or surfaces in one plane as a 2-D mesh, as one Gmsh mesh 4.1, joined where they have the same points; faces of equal name are one physical surface, or for surfaces one physical curve.",
        returns: "nothing",
        help: BLOCKS_AND_FACES,
        example: "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_gmsh(\"b.msh\", b, \"k1 = floor wall, i1 in j1 jn kn = box outflow\");",
    },
    Builtin {
        name: "write_blockmesh",
        action: Action::WriteGrids(&grid_formats::BLOCK_MESH),
        doc: "Writes blocks, or surfaces in one plane between two empty sides, as a blockMeshDict of OpenFOAM with a block for each cell, so that its points are kept, or, \"graded\", with few blocks whose edges have the points of the grid; faces of equal name are one patch.",
        returns: "nothing",
        help: &[
            ("name", "text", "Name of the file, beside the program."),
            (
                "words?",
                "text",
                "\"graded\": few blocks with curved, graded edges; blockMesh interpolates between the edges.",
            ),
            (
                "b",
                "block or surface …",
                "Blocks, or surfaces in one plane; a list counts as its members.",
            ),
            (
                "faces?",
                "text",
                "Boundaries of the block before it, such as \"k1 = hull wall, i1 in = plane symmetry\" (of a surface i1, im, j1, jn).",
            ),
        ],
        example: "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_blockmesh(\"blockMeshDict\", b, \"k1 = floor wall, i1 in j1 jn kn = box outflow\");",
    },
    Builtin {
        name: "write_polymesh",
        action: Action::WriteGrids(&grid_formats::POLY_MESH),
        doc: "Writes blocks, or surfaces in one plane between two empty sides, as a polyMesh of OpenFOAM: the files points, faces, owner, neighbour and boundary of the folder `name`; faces of equal name are one patch.",
        returns: "nothing",
        help: BLOCKS_AND_FACES,
        example: "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_polymesh(\"constant/polyMesh\", b, \"k1 = floor wall, i1 in j1 jn kn = box outflow\");",
    },
    Builtin {
        name: "write_ugrid",
        action: Action::WriteGrids(&grid_formats::UGRID),
        doc: "Writes blocks as one UGRID mesh (AFLR3) with the boundary conditions of FUN3D in a .mapbc beside it; the name ends in .b8.ugrid (big-endian), .lb8.ugrid (little-endian) or .ugrid (text). All boundaries have a name and one of the types wall, symmetry, farfield, inflow, outflow.",
        returns: "nothing",
        help: BLOCKS_AND_FACES,
        example: "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_ugrid(\"b.b8.ugrid\", b, \"k1 = floor wall, i1 in j1 jn kn = box outflow\");",
    },
    Builtin {
        name: "write_nmf",
        action: Action::WriteGrids(&grid_formats::NEUTRAL_MAP),
        doc: "Writes the connections and boundaries of blocks as a neutral map file, for the Plot3D file of the same blocks; types are called as by FUN3D, a patch by its name.",
        returns: "nothing",
        help: BLOCKS_AND_FACES,
        example: "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_nmf(\"b.nmf\", b, \"k1 = floor wall, i1 in j1 jn kn = box outflow\"); write_p3d(\"b.p3d\", b);",
    },
    Builtin {
        name: "interfaces",
        action: Action::Interfaces,
        doc: "The connections and boundaries of blocks, or of surfaces in one plane, as the writers use them, a line for each; folded and left-handed cells, faces that are not joined and symmetry that is not plane are reported.",
        returns: "text",
        help: &[BLOCKS_AND_FACES[1], BLOCKS_AND_FACES[2]],
        example: "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; block c = b + {1, 0, 0}; print interfaces(b, \"i1 j1 jn k1 kn = box wall\", c, \"in j1 jn k1 kn = box wall\");",
    },
    Builtin {
        name: "write_csv",
        action: Action::WriteGrids(&grid_formats::CSV),
        doc: "Writes points as lines of x,y,z under a heading, with all digits.",
        returns: "nothing",
        help: &[
            ("name", "text", "Name of the file, beside the program."),
            ("c", "curve or surface …", "Curves or surfaces to write."),
        ],
        example: "curve c[2] = {1, 2, 3}; write_csv(\"c.csv\", c); assert read_points(\"c.csv\")[2] . {1, 0, 0} == 1;",
    },
    Builtin {
        name: "read_p3d",
        action: Action::ReadPlot3d,
        doc: "A surface or block of a Plot3D file of any variant.",
        returns: "surface or block",
        help: &[
            ("name", "text", "Name of the file, beside the program."),
            ("block?", "integer", "Number of the block in the file; default 1."),
        ],
        example: "surface s[3,2] = {1, 2, 3}; write_p3d(\"s.x\", s); assert read_p3d(\"s.x\", 1).d2 == 2;",
    },
    Builtin {
        name: "iblank_p3d",
        action: Action::BlankingPlot3d,
        doc: "The blanking of a surface or block of a Plot3D file, a whole number for each point.",
        returns: "farray or block",
        help: &[
            ("name", "text", "Name of the file, beside the program."),
            ("block?", "integer", "Number of the block in the file; default 1."),
        ],
        example: "surface s[2,2] = {1, 2, 3}; farray hole[2,2] = 1; hole[1,1] = 0; write_p3d(\"s.x\", s, hole); assert iblank_p3d(\"s.x\")[1,1] == 0;",
    },
    Builtin {
        name: "count_p3d",
        action: Action::CountPlot3d,
        doc: "The number of surfaces and blocks of a Plot3D file.",
        returns: "number",
        help: &[("name", "text", "Name of the file, beside the program.")],
        example: "surface s[3,2] = {1, 2, 3}; write_p3d(\"s.x\", s, s); assert count_p3d(\"s.x\") == 2;",
    },
    Builtin {
        name: "read_cgns",
        action: Action::ReadCgns,
        doc: "A structured zone of a CGNS file (HDF5) as a surface or block.",
        returns: "surface or block",
        help: &[
            ("name", "text", "Name of the file, beside the program."),
            ("zone?", "integer or text", "Number or name of the zone; default 1."),
        ],
        example: "surface s[3,2] = {1, 2, 3}; write_cgns(\"s.cgns\", s); surface t = read_cgns(\"s.cgns\", \"s\"); assert t.d1 == 3;",
    },
    Builtin {
        name: "count_cgns",
        action: Action::CountCgns,
        doc: "The number of zones of a CGNS file.",
        returns: "number",
        help: &[("name", "text", "Name of the file, beside the program.")],
        example: "surface s[3,2] = {1, 2, 3}; write_cgns(\"s.cgns\", s, s); assert count_cgns(\"s.cgns\") == 2;",
    },
    Builtin {
        name: "names_cgns",
        action: Action::NamesCgns,
        doc: "The names of the zones of a CGNS file, in their order.",
        returns: "text list",
        help: &[("name", "text", "Name of the file, beside the program.")],
        example: "surface s[3,2] = {1, 2, 3}; write_cgns(\"s.cgns\", s); string names[1] = names_cgns(\"s.cgns\"); print names[1];",
    },
    Builtin {
        name: "read_points",
        action: Action::ReadRows(RowFormat::Points),
        doc: "The points of a text with two or three numbers to a line, as a curve.",
        returns: "curve",
        help: &[("name", "text", "Name of the file, beside the program.")],
        example: "curve c[2] = {1, 2, 3}; write_csv(\"c.csv\", c); curve d = read_points(\"c.csv\");",
    },
    Builtin {
        name: "read_aerofoil",
        action: Action::ReadRows(RowFormat::Aerofoil),
        doc: "A section of a coordinate file in Selig's or Lednicer's listing: tail, upper side, nose, lower side, tail.",
        returns: "curve",
        help: &[("name", "text", "Name of the file, beside the program.")],
        example: "file f = open(\"a.dat\", \"w\"); write(f, \"a wedge\"); for (x = 1:0:-.25) write(f, format(\"%g %g\", x, .1*x)); for (x = .25:1:.25) write(f, format(\"%g %g\", x, -.1*x)); close(f); assert read_aerofoil(\"a.dat\").d1 == 9;",
    },
];

/// Formats that `read_...` reads as a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RowFormat {
    Points,
    Aerofoil,
}
