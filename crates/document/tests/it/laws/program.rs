//! Random models.

use crate::laws::recipes;
use moldloft_document::registry;
use moldloft_registry::Class;
use moldloft_testing::Xorshift;
use std::fmt::Write;

/// A program that grows by random statements.
pub struct Program<'r> {
    pub random: &'r mut Xorshift,
    pub text: String,
    pub count: usize,
    pub points: Vec<String>,
    pub curves: Vec<String>,
    pub surfaces: Vec<String>,
    pub planes: Vec<String>,
}

impl Program<'_> {
    pub fn number(&mut self, low: f64, high: f64) -> String {
        format!("{:?}", self.random.decimal(low, high))
    }

    pub fn name(&mut self, stem: &str) -> String {
        self.count += 1;
        format!("{stem}{}", self.count)
    }

    /// Declares an object and returns its name.
    pub fn object(&mut self, kind: &str, args: &str) -> String {
        let name = self.name("o");
        writeln!(self.text, "{kind} {name}({args});").unwrap();
        name
    }

    pub fn point(&mut self) -> String {
        self.random.pick(&self.points).clone()
    }

    /// Three different points.
    pub fn points<const N: usize>(&mut self) -> [String; N] {
        let mut left = self.points.clone();
        std::array::from_fn(|_| left.swap_remove(self.random.below(left.len())))
    }

    pub fn curve(&mut self) -> String {
        self.random.pick(&self.curves).clone()
    }

    /// Different curves: a loft of one curve alone is not a surface, and the speed of a snake that
    /// turns on it has a kink.
    pub fn curves<const N: usize>(&mut self) -> [String; N] {
        let mut left = self.curves.clone();
        std::array::from_fn(|_| left.swap_remove(self.random.below(left.len())))
    }

    pub fn surface(&mut self) -> String {
        self.random.pick(&self.surfaces).clone()
    }

    /// A gently bent surface over 0 <= x <= 4 w, 0 <= y <= 2, near z = 0, for searches.
    pub fn sheet(&mut self) -> String {
        let masters: Vec<String> = (0..3)
            .map(|k| {
                let points: Vec<String> = (0..3)
                    .map(|j| {
                        let z = self.number(-0.2, 0.2);
                        self.object("AbsPoint", &format!("{}*w, {j}, {z}", 2 * k))
                    })
                    .collect();
                let points = points.join(", ");
                self.object("BCurve", &format!("{{{points}}}, degree = 2, visible = 0"))
            })
            .collect();
        self.object("BLoftSurf", &format!("{{{}}}, degree = 2, visible = 0", masters.join(", ")))
    }

    /// A curve above the middle of a sheet.
    pub fn strand(&mut self) -> String {
        let points: Vec<String> = (0..3)
            .map(|k| {
                let (y, z) = (self.number(0.6, 1.4), self.number(0.6, 1.2));
                self.object("AbsPoint", &format!("{}*w, {y}, {z}", k + 1))
            })
            .collect();
        self.object("BCurve", &format!("{{{}}}, degree = 2", points.join(", ")))
    }

    pub fn magnet(&mut self, surface: &str) -> String {
        let (u, v) = (self.number(0.1, 0.9), self.number(0.1, 0.9));
        self.object("AbsMagnet", &format!("{surface}, {u}, {v}"))
    }

    pub fn bead(&mut self, curve: &str) -> String {
        let t = self.number(0.1, 0.9);
        self.object("AbsBead", &format!("{curve}, {t}"))
    }

    pub fn snake(&mut self, surface: &str) -> String {
        let (a, b, c) = (self.magnet(surface), self.magnet(surface), self.magnet(surface));
        match self.random.below(3) {
            0 => self.object("LineSnake", &format!("{a}, {b}")),
            1 => self.object("BSnake", &format!("{{{a}, {b}, {c}}}, degree = 2")),
            _ => {
                let value = self.number(0.1, 0.9);
                let which = self.random.pick(&["u", "v"]);
                self.object("UVSnake", &format!("{surface}, \"{which}\", {value}"))
            }
        }
    }

    pub fn ring(&mut self, snake: &str) -> String {
        let t = self.number(0.1, 0.9);
        self.object("AbsRing", &format!("{snake}, {t}"))
    }

    /// Something to mirror in or project to, and whether it is drawn at random.
    pub fn mirror(&mut self) -> String {
        match self.random.below(4) {
            0 => format!("\"{}=0\"", self.random.pick(&["x", "y", "z"])),
            1 => self.random.pick(&self.planes).clone(),
            2 => self.point(),
            _ => {
                let [a, b] = self.points();
                self.object("Line", &format!("{a}, {b}"))
            }
        }
    }

    /// A frame at a point.
    pub fn frame(&mut self) -> String {
        let (point, [roll, pitch, yaw]) = (self.point(), self.coordinates());
        self.object("RPYFrame", &format!("{point}, {roll}, {pitch}, {yaw}"))
    }

    /// Divisions of a surface, as an argument.
    pub fn divisions(&mut self) -> String {
        format!("divisions = {{{}, {}}}", 2 + self.random.below(3), 2 + self.random.below(3))
    }

    /// Three coordinates.
    pub fn coordinates(&mut self) -> [String; 3] {
        std::array::from_fn(|_| self.number(-3.0, 3.0))
    }

    /// An object of a kind, with all that it needs; false for a kind without a recipe.
    pub fn kind(&mut self, kind: &str) -> bool {
        let Some(args) = recipes::arguments(self, kind) else { return false };
        let name = self.object(kind, &args);
        match registry().get(kind).expect("a kind of the registry").class {
            Class::Point | Class::Bead | Class::Magnet | Class::Ring => self.points.push(name),
            Class::Curve | Class::Snake => self.curves.push(name),
            Class::Surface => self.surfaces.push(name),
            Class::Plane => {
                // A plane shows itself in what is projected to it.
                let point = self.point();
                self.object("ProjPoint", &format!("{point}, {name}"));
                self.planes.push(name);
            }
            Class::Relabel => {
                // A law shows itself in what it redistributes.
                let [a, b] = self.points();
                let l = self.object("Line", &format!("{a}, {b}, relabel = {name}"));
                let (c, d) = (self.curve(), self.divisions());
                self.object("RuledSurf", &format!("{l}, {c}, relabel = {name}, {d}"));
            }
            Class::Frame => {
                // So does a frame.
                let point = self.point();
                self.object("FramePoint", &format!("{point}, {name}, 0.3, -1.2, 0.7"));
            }
            _ => {}
        }
        true
    }
}

/// So many kinds are in one model at most: more would make every draw fail somewhere.
const KINDS_AT_ONCE: usize = 24;

/// How many successive seeds have all kinds.
pub fn parts() -> usize {
    // A join needs two edges in one place; tests of joins have it.
    registry().rows().filter(|r| r.kind && r.name != "Join").count().div_ceil(KINDS_AT_ONCE)
}

/// A random model with a share of the kinds of the registry; models of successive seeds have all.
pub fn model(seed: u64) -> String {
    let mut random = Xorshift::new(seed);
    let text = String::from("param float w = 1.25 in [0.5, 2];\nparam float h = 0.5*w + 0.25;\n");
    let mut p = Program {
        random: &mut random,
        text,
        count: 0,
        points: Vec::new(),
        curves: Vec::new(),
        surfaces: Vec::new(),
        planes: Vec::new(),
    };
    for k in 0..9 {
        // Spread out, so that few points are in line or near each other.
        let at = [k % 3, k / 3, (k * 5) % 7]
            .map(|g| p.random.decimal(-0.3, 0.3) + f64::from(g) * 1.5 - 1.5);
        let name = p.object("AbsPoint", &format!("{:?}, {:?} + 0.1*h, {:?}", at[0], at[1], at[2]));
        p.points.push(name);
    }
    for kind in ["XPlane", "Line", "BCurve", "CCurve", "CLoftSurf"] {
        assert!(p.kind(kind), "{kind}");
    }
    // The kinds come in turn, so that successive seeds have them all, and in random order.
    let (registry, parts) = (registry(), parts());
    let kinds = registry.rows().filter(|r| r.kind && r.name != "Join").map(|r| &*r.name);
    let mut kinds: Vec<&str> = kinds.skip(seed as usize % parts).step_by(parts).collect();
    while !kinds.is_empty() {
        let kind = kinds.swap_remove(p.random.below(kinds.len()));
        assert!(p.kind(kind), "the generator of random models has no recipe for the kind {kind}");
    }
    // The program's own arithmetic on what it reads.
    let (c, s) = (p.curve(), p.surface());
    writeln!(p.text, "farray law = d_tanh(0, 1, 0.1*w, 0.2, 5); curve row = distc({c}, law);")
        .unwrap();
    writeln!(p.text, "AbsPoint last1(row[3].x, row[2].y*h, length({c}));").unwrap();
    writeln!(p.text, "AbsPoint last2({s}(0.3*w, 0.4).z, abs({s}.area - 3)^1.5, {c}.length/w);")
        .unwrap();
    p.text
}
