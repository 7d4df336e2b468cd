//! Classes of values, and their conversions.

use std::fmt;

/// Class of a value or argument. Classes are data: a bead is a point with a curve, so it is
/// accepted wherever a point is expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Class {
    /// Anything.
    Any,
    /// A number.
    Number,
    /// A whole number.
    Integer,
    /// A text.
    Text,
    /// A vector {a, b, c}.
    Vector,
    /// A row or grid of numbers (`farray`).
    Numbers,
    /// A row or grid of vectors (the language's `curve` and `surface`).
    Vectors,
    /// A point in space.
    Point,
    /// A point on a curve.
    Bead,
    /// A point on a surface.
    Magnet,
    /// A point on a snake.
    Ring,
    /// A parametric curve.
    Curve,
    /// A straight line from one end of a curve to the other: an axis.
    Axis,
    /// A curve on a surface.
    Snake,
    /// A parametric surface.
    Surface,
    /// A parametric solid.
    Solid,
    /// A plane.
    Plane,
    /// Element of mirroring or projection: a plane, line, point or "x=0", "y=0", "z=0".
    MirrorArgument,
    /// Side of a patch on a surface: a snake, or a magnet for a side without length.
    Side,
    /// A curve, or a bead on it as the start of a search.
    Along,
    /// A snake, or a ring on it as the start of a search.
    AlongSnake,
    /// A surface, or a magnet on it as the start of a search.
    Onto,
    /// Target of an intersection or projection: a plane, a surface (or a magnet on it), a curve (or
    /// a bead on it), a point, or the zero set of a field.
    Target,
    /// A frame of three axes.
    Frame,
    /// A family of plane sections.
    Contours,
    /// A law that redistributes a parameter.
    Relabel,
    /// An implicit function of space.
    Field,
    /// A set of points, solid where implicit functions are negative.
    Set,
    /// A body of triangles.
    Mesh,
    /// A list.
    List,
    /// A grid of three dimensions: layers of surfaces.
    Block,
    /// Members by name.
    Record,
    /// No value: the result of a function that writes or checks.
    Nothing,
}

impl Class {
    /// All classes of values, in the order of the reference.
    pub const ALL: [Class; 32] = [
        Class::Any,
        Class::Number,
        Class::Integer,
        Class::Text,
        Class::Vector,
        Class::Numbers,
        Class::Vectors,
        Class::Point,
        Class::Bead,
        Class::Magnet,
        Class::Ring,
        Class::Curve,
        Class::Axis,
        Class::Snake,
        Class::Surface,
        Class::Solid,
        Class::Plane,
        Class::MirrorArgument,
        Class::Side,
        Class::Along,
        Class::AlongSnake,
        Class::Onto,
        Class::Target,
        Class::Frame,
        Class::Contours,
        Class::Relabel,
        Class::Field,
        Class::Set,
        Class::Mesh,
        Class::List,
        Class::Block,
        Class::Record,
    ];

    /// The class's name, as in the reference.
    pub fn name(self) -> &'static str {
        match self {
            Class::Any => "value",
            Class::Number => "number",
            Class::Integer => "integer",
            Class::Text => "text",
            Class::Vector => "vector",
            Class::Numbers => "farray",
            Class::Vectors => "curve or surface",
            Class::Point => "point",
            Class::Bead => "bead",
            Class::Magnet => "magnet",
            Class::Ring => "ring",
            Class::Curve => "curve",
            Class::Axis => "line",
            Class::Snake => "snake",
            Class::Surface => "surface",
            Class::Solid => "solid",
            Class::Plane => "plane",
            Class::MirrorArgument => "mirror",
            Class::Side => "side",
            Class::Along => "curve or bead",
            Class::AlongSnake => "snake or ring",
            Class::Onto => "surface or magnet",
            Class::Target => "target",
            Class::Frame => "frame",
            Class::Contours => "contours",
            Class::Relabel => "relabel",
            Class::Field => "field",
            Class::Set => "set",
            Class::Mesh => "mesh",
            Class::List => "list",
            Class::Block => "block",
            Class::Record => "record",
            Class::Nothing => "nothing",
        }
    }

    /// The name with its article, for messages: "a curve".
    pub fn with_article(self) -> &'static str {
        match self {
            Class::Any => "a value",
            Class::Number => "a number",
            Class::Integer => "a whole number",
            Class::Text => "a text",
            Class::Vector => "a vector",
            Class::Numbers => "an farray",
            Class::Vectors => "a curve or surface of points",
            Class::Point => "a point",
            Class::Bead => "a bead (a point on a curve)",
            Class::Magnet => "a magnet (a point on a surface)",
            Class::Ring => "a ring (a point on a snake)",
            Class::Curve => "a curve",
            Class::Axis => "a line",
            Class::Snake => "a snake (a curve on a surface)",
            Class::Surface => "a surface",
            Class::Solid => "a solid",
            Class::Plane => "a plane",
            Class::MirrorArgument => "a plane, line or point to mirror in",
            Class::Side => "a snake or a magnet",
            Class::Along => "a curve or a bead",
            Class::AlongSnake => "a snake or a ring",
            Class::Onto => "a surface or a magnet",
            Class::Target => "a plane, surface, magnet, curve, bead, point or field",
            Class::Frame => "a frame",
            Class::Contours => "contours",
            Class::Relabel => "a relabel",
            Class::Field => "a field",
            Class::Set => "a set",
            Class::Mesh => "a mesh",
            Class::List => "a list",
            Class::Block => "a block (layers of surfaces)",
            Class::Record => "a record",
            Class::Nothing => "nothing",
        }
    }

    /// True if a value of class `found` is accepted where this class is expected.
    pub fn accepts(self, found: Class) -> bool {
        use Class::*;
        match self {
            Any => true,
            _ if self == found || found == Any => true,
            Number => found == Integer,
            Integer => found == Number,
            Vector => matches!(found, Point | Bead | Magnet | Ring),
            Point => matches!(found, Bead | Magnet | Ring | Vector),
            Bead | Magnet => found == Ring,
            Curve => found == Snake,
            Axis => matches!(found, Curve | Snake),
            Side => matches!(found, Snake | Magnet | Ring),
            Along => matches!(found, Curve | Snake | Bead | Ring),
            AlongSnake => matches!(found, Snake | Ring),
            Onto => matches!(found, Surface | Magnet | Ring),
            Target => matches!(
                found,
                Plane
                    | Text
                    | Surface
                    | Magnet
                    | Ring
                    | Curve
                    | Snake
                    | Bead
                    | Point
                    | Vector
                    | Field
            ),
            Vectors | Block => found == List,
            Numbers => found == List,
            List => matches!(found, Numbers | Vectors),
            Plane => found == Text,
            // A plane is converted to the half-space behind it, a number to a constant.
            Field => matches!(found, Plane | Number | Integer),
            Set => matches!(found, Field | Plane),
            // A point is converted to a frame there, with the axes of the world.
            Frame => matches!(found, Point | Bead | Magnet | Ring | Vector),
            MirrorArgument => {
                matches!(found, Plane | Point | Bead | Magnet | Ring | Vector | Curve | Text)
            }
            _ => false,
        }
    }

    /// True for the classes of shapes that are panelled or displayed, which take divisions.
    pub fn dimension(self) -> Option<usize> {
        match self {
            Class::Point | Class::Bead | Class::Magnet | Class::Ring => Some(0),
            Class::Curve | Class::Snake => Some(1),
            Class::Surface => Some(2),
            Class::Solid => Some(3),
            _ => None,
        }
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_magnets_beads_and_points() {
        for wanted in [Class::Ring, Class::Magnet, Class::Bead, Class::Point] {
            assert!(wanted.accepts(Class::Ring));
        }
        assert!(!Class::Ring.accepts(Class::Magnet));
        assert!(!Class::Bead.accepts(Class::Magnet));
        assert!(Class::Curve.accepts(Class::Snake) && !Class::Snake.accepts(Class::Curve));
    }
}
