//! Notes about the joins of patches.

use moldloft_num::Vec3;

/// A patch between two contradictory counts, and its link to the next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChainStep {
    /// The patch.
    pub patch: String,
    /// `'u'` or `'v'`: the parameter of the count.
    pub along: char,
    /// Link to the next patch; empty for the last.
    pub shares: String,
}

/// A note to the user about joins.
#[derive(Clone, Debug, PartialEq)]
pub enum PanelNote {
    /// Two given counts contradict each other along a chain of patches, so panels do not join
    /// somewhere between them.
    Divisions {
        /// The patches from one to the other.
        chain: Vec<ChainStep>,
        /// The counts stated for the first and the last.
        divisions: [u32; 2],
    },
    /// The counts of the pieces of an edge do not add up to that of its patch, so panels do not
    /// join there.
    Pieces {
        /// The patch.
        patch: String,
        /// The parameter along the edge.
        along: char,
        /// Its count.
        divisions: u32,
        /// The pieces of the edge with their counts.
        pieces: Vec<(String, u32)>,
    },
    /// A shared vertex has different positions on both patches.
    Apart {
        /// The patches.
        patches: [String; 2],
        /// Distance of the two positions.
        distance: f64,
        /// Position.
        at: Vec3,
    },
    /// The corner of a patch is in the middle of an edge of another without being its vertex, or
    /// coincides with a different vertex of it.
    Junction {
        /// The patch with the corner, and the patch with the edge.
        patches: [String; 2],
        /// (u, v) of the corner.
        corner: [u8; 2],
        /// Edge 0..4 (v = 0, u = 1, v = 1, u = 0) and the parameter along it.
        edge: (u8, f64),
        /// The edge of the first patch along that edge, and the parameters of its ends on the latter.
        part: Option<(u8, [f64; 2])>,
        /// True when the edge has a vertex there.
        twin: bool,
        /// Position.
        at: Vec3,
    },
    /// Two edges of patches coincide but are not joined.
    Unjoined {
        /// The patches; the same one twice for a patch that closes.
        patches: [String; 2],
        /// Their edges 0..4 (v = 0, u = 1, v = 1, u = 0).
        edges: [u8; 2],
        /// Number of panels of the first edge that are on the second.
        panels: usize,
        /// Their length.
        length: f64,
        /// True if both edges coincide from end to end.
        whole: bool,
        /// Start.
        at: Vec3,
    },
    /// A declared join of an edge with a part of another edge, but the ends are not points of that
    /// edge.
    PartEnds {
        /// The join.
        join: String,
        /// The end that is not a point of the other edge, if only one is not.
        end: Option<String>,
    },
    /// The border of a sheet of triangles intersects itself or has no area with the divisions of
    /// its neighbours, so the sheet is not joined to them.
    Border {
        /// The sheet.
        patch: String,
        /// The divisions of the curves of its border.
        divisions: Vec<usize>,
    },
    /// A knuckle of a patch's original surface crosses its panels, which cut it off.
    Knuckle {
        /// The patch.
        patch: String,
        /// (u, v) of a point on the knuckle.
        uv: [f64; 2],
        /// Position.
        at: Vec3,
        /// The area of the panels, and that of the surface.
        area: Option<[f64; 2]>,
    },
    /// Panels that are farther from their surface than the tolerance.
    Coarse {
        /// The patch.
        patch: String,
        /// Maximum distance.
        distance: f64,
        /// The tolerance.
        tolerance: f64,
    },
    /// Triangles of a sheet without stated divisions that miss more of its area than promised.
    MissedArea {
        /// The sheet.
        patch: String,
        /// The area of the triangles, and that of the sheet.
        area: [f64; 2],
    },
    /// Triangles of a body that no tolerance divides, and that are not its surface.
    Undivided {
        /// The body.
        patch: String,
        /// Differences of their area and volume from those of the body, relative to these.
        missed: [f64; 2],
    },
    /// Number of further contradictions.
    More(usize),
}

impl PanelNote {
    /// A stable word for its kind.
    pub fn id(&self) -> &'static str {
        match self {
            PanelNote::Divisions { .. } | PanelNote::Pieces { .. } | PanelNote::More(_) => {
                "divisions-contradict"
            }
            PanelNote::Apart { .. } => "edges-apart",
            PanelNote::Junction { .. } => "corner-not-joined",
            PanelNote::Unjoined { .. } => "edges-not-joined",
            PanelNote::PartEnds { .. } => "part-not-named",
            PanelNote::Border { .. } => "border-not-joined",
            PanelNote::Knuckle { .. } => "knuckle-across-panels",
            PanelNote::Coarse { .. }
            | PanelNote::MissedArea { .. }
            | PanelNote::Undivided { .. } => "coarse-panels",
        }
    }

    /// True if it leaves the mesh of a closed shape open.
    pub fn is_error(&self) -> bool {
        !matches!(
            self,
            PanelNote::Apart { .. }
                | PanelNote::Border { .. }
                | PanelNote::Knuckle { .. }
                | PanelNote::Coarse { .. }
                | PanelNote::MissedArea { .. }
                | PanelNote::Undivided { .. }
        )
    }

    /// The remedy.
    pub fn help(&self) -> String {
        let text = match self {
            PanelNote::Unjoined { patches: [a, b], edges: [k, l], whole: true, .. } => {
                return format!(
                    "write `Join j({a}.{}, {b}.{});`, or build both on the same curve or points",
                    edge_name(*k),
                    edge_name(*l)
                );
            }
            PanelNote::Unjoined { .. } => {
                "let both edges run along parts of one curve, between beads on it"
            }
            PanelNote::Divisions { .. } => {
                "state the count once and leave it out (or write 0) elsewhere on the chain"
            }
            PanelNote::Pieces { .. } => {
                "leave out (or write 0 for) the count of the patch or of one of the pieces"
            }
            PanelNote::Apart { .. } => {
                "let both surfaces use the same curve, or a snake of one as the edge of the other"
            }
            PanelNote::Junction {
                patches: [a, b],
                part: Some((k, [from, to])),
                edge: (l, _),
                twin: false,
                ..
            } => {
                let (own, other) = (edge_name(*k), edge_name(*l));
                let name: String =
                    a.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
                let [from, to] = [from, to].map(|t| (t * 1e7).round() / 1e7);
                return format!(
                    "write `AbsBead {name}_a({b}.{other}, {from}); AbsBead {name}_b({b}.{other}, {to}); \
                     SubCurve {name}_part({name}_a, {name}_b); Join {name}_join({a}.{own}, {name}_part);`"
                );
            }
            PanelNote::Junction { twin: false, .. } => {
                "`Join` the neighbours' edges with parts of that edge, between beads or rings on it: \
                 `AbsBead b(curve, t); SubCurve part(a, b); Join j(patch.v0, part);`"
            }
            PanelNote::Junction { .. } => {
                "build both patches on the same point and the same curves: patches are joined by shared objects, not by coordinates"
            }
            PanelNote::PartEnds { .. } => {
                "build the shorter patch on beads, rings or ends of the longer edge, or name the part: \
                 `AbsBead b(curve, t); SubCurve part(a, b); Join j(patch.v0, part);`"
            }
            PanelNote::Border { .. } => "give it, or its neighbours, more divisions",
            PanelNote::Knuckle { .. } => {
                "make two parts of it that meet at a snake along the knuckle, such as UVSnake or EdgeSnake"
            }
            PanelNote::Coarse { .. } => {
                "a larger tolerance, or two surfaces that meet at the knuckle, the pole or the end of the fold"
            }
            PanelNote::MissedArea { .. } => {
                "give its neighbours more divisions, or state `rim`, `nu` and `nv`; `.area` is that of the surface"
            }
            PanelNote::Undivided { .. } => {
                "a greater depth of a set makes finer triangles; files of exact faces, such as STEP, need none"
            }
            PanelNote::More(_) => "fix those that are reported first",
        };
        text.to_string()
    }

    /// The object at which it is reported.
    pub fn object(&self) -> Option<&str> {
        match self {
            PanelNote::Divisions { chain, .. } => chain.last().map(|step| step.patch.as_str()),
            PanelNote::PartEnds { join, .. } => Some(join),
            PanelNote::Pieces { patch, .. }
            | PanelNote::Border { patch, .. }
            | PanelNote::Knuckle { patch, .. }
            | PanelNote::Coarse { patch, .. }
            | PanelNote::MissedArea { patch, .. }
            | PanelNote::Undivided { patch, .. } => Some(patch),
            PanelNote::Apart { patches, .. } => Some(&patches[1]),
            PanelNote::Junction { patches, .. } | PanelNote::Unjoined { patches, .. } => {
                Some(&patches[0])
            }
            PanelNote::More(_) => None,
        }
    }
}

/// The member of a surface that is its edge 0..4.
fn edge_name(edge: u8) -> &'static str {
    ["v0", "u1", "v1", "u0"][usize::from(edge) % 4]
}

/// Tells of a chain of patches whose ends have different divisions.
fn tell_chain(
    f: &mut std::fmt::Formatter,
    chain: &[ChainStep],
    [m, n]: [u32; 2],
) -> std::fmt::Result {
    let (Some(a), Some(b)) = (chain.first(), chain.last()) else { return Ok(()) };
    write!(
        f,
        "`{}` has {m} divisions along {} and `{}` has {n} along {}, but panels run on \
         from one to the other: ",
        a.patch, a.along, b.patch, b.along
    )?;
    // The ends and the turns of a long chain suffice.
    let tells = |k: usize| {
        k < 6 || k + 6 >= chain.len() || (k < 60 && chain[k].along != chain[k - 1].along)
    };
    let mut quiet = 0;
    for (k, step) in chain.iter().enumerate() {
        if !tells(k) {
            quiet += 1;
            continue;
        }
        if quiet > 0 {
            write!(f, "({quiet} more patches), ")?;
            quiet = 0;
        }
        write!(f, "`{}` along {}", step.patch, step.along)?;
        if k > 0 && step.along != chain[k - 1].along {
            write!(f, " (the chain turns here)")?;
        }
        if k + 1 < chain.len() {
            write!(f, ", joined by {} to ", step.shares)?;
        }
    }
    Ok(())
}

impl std::fmt::Display for PanelNote {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            PanelNote::Divisions { chain, divisions } => tell_chain(f, chain, *divisions),
            PanelNote::Pieces { patch, along, divisions, pieces } => {
                write!(
                    f,
                    "`{patch}` has {divisions} divisions along {along}, but the pieces of its edge "
                )?;
                let list: Vec<String> = pieces.iter().map(|(p, n)| format!("{n} ({p})")).collect();
                write!(f, "have {}", list.join(" + "))
            }
            PanelNote::Apart { patches: [a, b], distance, at } => write!(
                f,
                "`{a}` and `{b}` share an edge but are {distance:.3e} apart at ({}, {}, {})",
                at.x, at.y, at.z
            ),
            PanelNote::Junction {
                patches: [a, b], corner: [u, v], edge: (k, t), twin, at, ..
            } => {
                let edge = ["v = 0", "u = 1", "v = 1", "u = 0"][usize::from(*k) % 4];
                let along = if k % 2 == 0 { 'u' } else { 'v' };
                let how = if *twin { "meets" } else { "is in the middle of" };
                write!(
                    f,
                    "the corner (u, v) = ({u}, {v}) of `{a}` {how} edge {edge} of `{b}` at {along} = \
                     {t:.6} but is not joined to it, at ({}, {}, {})",
                    at.x, at.y, at.z
                )
            }
            PanelNote::Unjoined { patches: [a, b], edges: [k, l], panels, length, at, .. } => {
                let edge = |k: u8| ["v = 0", "u = 1", "v = 1", "u = 0"][usize::from(k) % 4];
                write!(
                    f,
                    "edge {} of `{a}` and edge {} of `{b}` coincide along {panels} panels \
                     ({length:.6} long, from ({}, {}, {})) but are not joined",
                    edge(*k),
                    edge(*l),
                    at.x,
                    at.y,
                    at.z
                )
            }
            PanelNote::PartEnds { join, end: Some(end) } => write!(
                f,
                "`{join}` joins an edge to a part of another, but {end} is no point of the longer edge: coordinates join nothing"
            ),
            PanelNote::PartEnds { join, end: None } => write!(
                f,
                "`{join}` joins an edge to a part of another, but neither end is a point of the longer edge: coordinates join nothing"
            ),
            PanelNote::Border { patch, divisions } => {
                let counts: Vec<String> = divisions.iter().map(usize::to_string).collect();
                write!(
                    f,
                    "the border of `{patch}` crosses itself or has no area with {} divisions, so it \
                     joins nothing",
                    counts.join(" + ")
                )
            }
            PanelNote::Knuckle { patch, uv: [u, v], at, area } => {
                write!(
                    f,
                    "a knuckle runs across the panels of `{patch}` at (u, v) = ({u:.6}, {v:.6}), ({}, {}, {}): they cut it off",
                    at.x, at.y, at.z
                )?;
                let Some([panels, surface]) = area else { return Ok(()) };
                write!(
                    f,
                    "; the area of the panels is {panels:.9}, that of the surface {surface:.9}"
                )
            }
            PanelNote::Coarse { patch, distance, tolerance } => write!(
                f,
                "panels of `{patch}` are {distance:.2e} from the surface, farther than the tolerance {tolerance:.2e}"
            ),
            PanelNote::MissedArea { patch, area: [panels, surface] } => write!(
                f,
                "the triangles of `{patch}` have an area of {panels:.6e}, {:+.1e} of that of the surface, {surface:.6e}",
                (panels - surface) / surface
            ),
            PanelNote::Undivided { patch, missed: [area, volume] } => write!(
                f,
                "the triangles of `{patch}` stay as they are, no tolerance divides them: their area misses that \
                 of the body by {area:.1e}, their volume by {volume:.1e} of it"
            ),
            PanelNote::More(n) => write!(f, "{n} more contradictions among divisions"),
        }
    }
}
