//! Glyphs of a text at their places: advances, kerning, lines, alignment.

use crate::bezier::{Bezier, Point};
use crate::region::{OutlineFault, OutlineLoop, region};
use ttf_parser::gpos::{PairAdjustment, PositioningSubtable};
use ttf_parser::{Face, GlyphId, OutlineBuilder, Tag, name_id};

/// Maximum number of characters of a text.
const MOST_CHARACTERS: usize = 300;

/// A font.
pub struct Font<'a> {
    face: Face<'a>,
    /// Height of a capital letter in units of the font.
    capital: f64,
}

/// Horizontal position of the lines of a text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HorizontalAlign {
    /// Lines begin at the origin.
    #[default]
    Left,
    /// Their middles are above and below it.
    Centre,
    /// They end there.
    Right,
}

/// Vertical position of a text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VerticalAlign {
    /// The first baseline contains the origin.
    #[default]
    Baseline,
    /// The last baseline contains it.
    Bottom,
    /// It is in the middle between the last baseline and the tops of the first line's capital letters.
    Middle,
    /// It is at the tops of the first line's capital letters.
    Top,
}

/// Position of a text relative to the origin, and the distance of its lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextLayout {
    /// Along the lines.
    pub horizontal: HorizontalAlign,
    /// Across the lines.
    pub vertical: VerticalAlign,
    /// Distance of baselines, relative to that which the font states.
    pub line_spacing: f64,
    /// True if pairs of letters are moved together or apart as the font states.
    pub kerning: bool,
}

impl Default for TextLayout {
    fn default() -> Self {
        let (horizontal, vertical) = Default::default();
        TextLayout { horizontal, vertical, line_spacing: 1.0, kerning: true }
    }
}

/// Reason why a text has no outlines.
#[derive(Clone, Debug, PartialEq)]
pub enum FontError {
    /// The bytes are not a TrueType or OpenType font.
    NoFont(String),
    /// A collection has no font of this name; those that it has.
    NotInCollection(Vec<String>),
    /// The font has no capital letters, whose height is the unit.
    NoCapitals,
    /// The font has no glyph of a character.
    NoGlyph(char),
    /// A character of a script that needs shaping, or is not written from left to right.
    Script(char),
    /// A control character.
    Control(char),
    /// A glyph without outlines, such as an image.
    NoOutline(char),
    /// The outlines of a character do not close, or run along one another.
    Outline(char),
    /// Nothing of the text is visible.
    Blank,
    /// More characters than this.
    TooLong(usize),
}

impl std::fmt::Display for FontError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            FontError::NoFont(why) => write!(f, "not a TrueType or OpenType font: {why}"),
            FontError::NotInCollection(names) => {
                write!(f, "no font of that name in the file, which has {}", names.join(", "))
            }
            FontError::NoCapitals => {
                write!(f, "the font has no capital letters, whose height is the size of a text")
            }
            FontError::NoGlyph(c) => write!(f, "the font has no glyph of {c:?}"),
            FontError::Script(c) => {
                write!(
                    f,
                    "{c:?} belongs to a script that is not set letter by letter from the left"
                )
            }
            FontError::Control(c) => write!(f, "{c:?} is a control character"),
            FontError::NoOutline(c) => write!(f, "the glyph of {c:?} is an image"),
            FontError::Outline(c) => {
                write!(f, "the outlines of {c:?} do not close, or run along one another")
            }
            FontError::Blank => write!(f, "nothing of the text is visible"),
            FontError::TooLong(most) => write!(f, "a text of more than {most} characters"),
        }
    }
}

impl FontError {
    /// The remedy.
    pub fn help(&self) -> &'static str {
        match self {
            FontError::NoFont(_) => "name a .ttf, .otf or .ttc file",
            FontError::NotInCollection(_) => "give one of these names",
            FontError::Control(_) | FontError::Blank => "give letters, figures or signs",
            FontError::TooLong(_) => "divide the text",
            FontError::Script(_) => {
                "draw it with a program that shapes it, and IMPORT its outlines"
            }
            _ => "take another font",
        }
    }
}

/// Collects the curves of a glyph.
struct Pen {
    shift: Point,
    scale: f64,
    character: usize,
    here: Point,
    curves: Vec<Vec<(Bezier, usize)>>,
}

impl Pen {
    fn point(&self, x: f32, y: f32) -> Point {
        [(f64::from(x) + self.shift[0]) * self.scale, (f64::from(y) + self.shift[1]) * self.scale]
    }

    fn put(&mut self, curve: Bezier) {
        self.here = curve.ends()[1];
        let character = self.character;
        if let Some(last) = self.curves.last_mut() {
            last.push((curve, character));
        }
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.here = self.point(x, y);
        self.curves.push(Vec::new());
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.put(Bezier::Line([self.here, self.point(x, y)]));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.put(Bezier::Quadratic([self.here, self.point(x1, y1), self.point(x, y)]));
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let points = [self.here, self.point(x1, y1), self.point(x2, y2), self.point(x, y)];
        self.put(Bezier::Cubic(points));
    }

    fn close(&mut self) {
        let start = self.curves.last().and_then(|c| c.first()).map(|c| c.0.ends()[0]);
        if let Some(start) = start.filter(|s| *s != self.here) {
            self.put(Bezier::Line([self.here, start]));
        }
    }
}

/// The file of a font as a program names it: a name without the ending of a font file is that of a font of the system.
pub fn font_file(name: &str) -> String {
    let lower = name.to_ascii_lowercase();
    let file = [".ttf", ".otf", ".ttc", ".otc"].iter().any(|end| lower.ends_with(end));
    if file { name.to_owned() } else { format!("{SYSTEM_FONT}{name}") }
}

/// Begins the names of fonts of the system where files are named.
pub const SYSTEM_FONT: &str = "font:";

impl<'a> Font<'a> {
    /// The font of a file; of a collection, the one of a name, or the first.
    ///
    /// # Errors
    /// Bytes that are no font; a name that no font of a collection has; a font without capital letters.
    pub fn new(bytes: &'a [u8], name: Option<&str>) -> Result<Font<'a>, FontError> {
        let count = ttf_parser::fonts_in_collection(bytes).unwrap_or(1);
        let parse = |k: u32| Face::parse(bytes, k).map_err(|e| FontError::NoFont(e.to_string()));
        let face = match name.filter(|_| count > 1) {
            None => parse(0)?,
            Some(name) => {
                let mut all = Vec::new();
                let mut found = None;
                for k in 0..count {
                    let face = parse(k)?;
                    let own = names(&face);
                    if own.iter().any(|n| n.eq_ignore_ascii_case(name)) && found.is_none() {
                        found = Some(face);
                    }
                    all.extend(own.into_iter().next_back());
                }
                found.ok_or(FontError::NotInCollection(all))?
            }
        };
        // Of a letter without curves and overshoot.
        let letter = |c: char| {
            let bounds = face.glyph_bounding_box(face.glyph_index(c)?)?;
            Some(f64::from(bounds.y_max))
        };
        let stated = face.capital_height().map(f64::from).filter(|h| *h > 0.0);
        let capital = stated.or_else(|| "HIEX".chars().find_map(letter));
        let capital = capital.filter(|h| *h > 0.0).ok_or(FontError::NoCapitals)?;
        Ok(Font { face, capital })
    }

    /// The loops round the letters of a text, in heights of a capital letter.
    ///
    /// Letters are set from the left, one glyph for each character, at the advances and with the kerning of the font.
    /// `\n` begins a line.
    ///
    /// # Errors
    /// Characters that the font does not have or that cannot be set so.
    pub fn outlines(&self, text: &str, layout: &TextLayout) -> Result<Vec<OutlineLoop>, FontError> {
        let characters: Vec<char> = text.chars().collect();
        if characters.len() > MOST_CHARACTERS {
            return Err(FontError::TooLong(MOST_CHARACTERS));
        }
        let lines: Vec<&[char]> = characters.split(|c| *c == '\n').collect();
        let face = &self.face;
        let pitch = f64::from(face.ascender()) - f64::from(face.descender());
        let pitch = (pitch + f64::from(face.line_gap())) * layout.line_spacing;
        let deep = pitch * (lines.len() - 1) as f64;
        let mut y = match layout.vertical {
            VerticalAlign::Baseline => 0.0,
            VerticalAlign::Bottom => deep,
            VerticalAlign::Middle => 0.5 * (deep - self.capital),
            VerticalAlign::Top => -self.capital,
        };
        let mut curves = Vec::new();
        let mut first = 0;
        for line in lines {
            let glyphs = line.iter().map(|c| self.glyph(*c)).collect::<Result<Vec<_>, _>>()?;
            let places = self.places(&glyphs, layout.kerning);
            let long = places[glyphs.len()];
            let start = match layout.horizontal {
                HorizontalAlign::Left => 0.0,
                HorizontalAlign::Centre => -0.5 * long,
                HorizontalAlign::Right => -long,
            };
            for (k, glyph) in glyphs.iter().enumerate() {
                let shift = [start + places[k], y];
                let scale = 1.0 / self.capital;
                let here = [0.0; 2];
                let mut pen = Pen { shift, scale, character: first + k, here, curves: vec![] };
                if face.outline_glyph(*glyph, &mut pen).is_none() {
                    let image = face.glyph_raster_image(*glyph, u16::MAX).is_some()
                        || face.glyph_svg_image(*glyph).is_some();
                    if image {
                        return Err(FontError::NoOutline(line[k]));
                    }
                }
                curves.append(&mut pen.curves);
            }
            first += line.len() + 1;
            y -= pitch;
        }
        let loops = region(&curves)
            .map_err(|OutlineFault { character, .. }| FontError::Outline(characters[character]))?;
        if loops.is_empty() { Err(FontError::Blank) } else { Ok(loops) }
    }

    fn glyph(&self, c: char) -> Result<GlyphId, FontError> {
        if c.is_control() {
            return Err(FontError::Control(c));
        }
        if shaped(c) {
            return Err(FontError::Script(c));
        }
        self.face.glyph_index(c).filter(|g| g.0 != 0).ok_or(FontError::NoGlyph(c))
    }

    /// Where glyphs begin along a line, and where the line ends.
    fn places(&self, glyphs: &[GlyphId], kerning: bool) -> Vec<f64> {
        let mut places = vec![0.0];
        for (k, glyph) in glyphs.iter().enumerate() {
            let advance = f64::from(self.face.glyph_hor_advance(*glyph).unwrap_or(0));
            let next = glyphs.get(k + 1).filter(|_| kerning);
            let by = next.map_or(0.0, |next| f64::from(self.kern(*glyph, *next)));
            places.push(places[k] + advance + by);
        }
        places
    }

    /// Change of the advance between two glyphs: of the table GPOS, of older fonts the table kern.
    fn kern(&self, left: GlyphId, right: GlyphId) -> i16 {
        let tables = self.face.tables();
        let kern = Tag::from_bytes(b"kern");
        if let Some(gpos) = tables.gpos {
            let latin = gpos.scripts.find(Tag::from_bytes(b"latn"));
            let script = latin.or_else(|| gpos.scripts.find(Tag::from_bytes(b"DFLT")));
            let language = script.and_then(|s| s.default_language);
            let features = language.into_iter().flat_map(|l| l.feature_indices);
            let features = features.filter_map(|k| gpos.features.get(k));
            let lookups: Vec<u16> =
                features.filter(|f| f.tag == kern).flat_map(|f| f.lookup_indices).collect();
            if !lookups.is_empty() {
                let of = |k: u16| {
                    let lookup = gpos.lookups.get(k)?;
                    let all = (0..lookup.subtables.len())
                        .filter_map(|j| lookup.subtables.get::<PositioningSubtable>(j));
                    // The first subtable that knows the pair counts.
                    all.into_iter().find_map(|table| pair(&table, left, right))
                };
                return lookups.into_iter().filter_map(of).sum();
            }
        }
        let old = tables.kern.into_iter().flat_map(|k| k.subtables);
        let old = old.filter(|t| t.horizontal && !t.has_cross_stream && !t.variable);
        old.filter_map(|t| t.glyphs_kerning(left, right)).sum()
    }
}

fn pair(table: &PositioningSubtable<'_>, left: GlyphId, right: GlyphId) -> Option<i16> {
    let PositioningSubtable::Pair(pair) = table else { return None };
    let index = pair.coverage().get(left)?;
    let values = match pair {
        PairAdjustment::Format1 { sets, .. } => sets.get(index)?.get(right)?,
        PairAdjustment::Format2 { classes, matrix, .. } => {
            matrix.get((classes.0.get(left), classes.1.get(right)))?
        }
    };
    Some(values.0.x_advance)
}

/// The names of a font: family, and family with style.
fn names(face: &Face<'_>) -> Vec<String> {
    let wanted = [name_id::FAMILY, name_id::TYPOGRAPHIC_FAMILY, name_id::FULL_NAME];
    let all = face.names();
    let of = |id: u16| all.into_iter().filter(move |n| n.name_id == id).find_map(|n| n.to_string());
    wanted.into_iter().filter_map(of).collect()
}

/// The names by which a font of a file is found, for each font that the bytes hold; empty if they are no font.
///
/// Family, typographic family and full name; of the family's names only where the style is the regular one.
pub fn font_names(bytes: &[u8]) -> Vec<Vec<String>> {
    let count = ttf_parser::fonts_in_collection(bytes).unwrap_or(1);
    let of = |k: u32| {
        let face = Face::parse(bytes, k).ok()?;
        let mut own = names(&face);
        let regular =
            face.is_regular() || !(face.is_bold() || face.is_italic() || face.is_oblique());
        if !regular && own.len() > 1 {
            own.drain(..own.len() - 1);
        }
        Some(own)
    };
    (0..count).filter_map(of).collect()
}

/// True for characters of scripts whose letters join, move or run from the right, and for marks.
fn shaped(c: char) -> bool {
    let code = u32::from(c);
    let ranges = [
        (0x0300, 0x036F),
        (0x0590, 0x109F),
        (0x1100, 0x11FF),
        (0x1700, 0x18AF),
        (0x1900, 0x1CFF),
        (0x1DC0, 0x1DFF),
        (0x200B, 0x200F),
        (0x202A, 0x202E),
        (0x2060, 0x206F),
        (0x20D0, 0x20FF),
        (0xA800, 0xABFF),
        (0xFB1D, 0xFDFF),
        (0xFE00, 0xFE0F),
        (0xFE20, 0xFE2F),
        (0xFE70, 0xFEFF),
        (0x10800, 0x11FFF),
        (0xE0000, 0xE0FFF),
    ];
    ranges.iter().any(|(low, high)| (*low..=*high).contains(&code))
}
