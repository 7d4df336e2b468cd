//! TEXT: a cross section of letters.

use super::CommandError;
use super::args::Args;
use super::features::new_name;
use super::session::SketchSession;
use super::treatments::OwnNumbers;
use super::words::CommandTokenKind;
use crate::feature::{Feature, FeatureKind, SectionText};
use crate::{CoordinateAxis, DimensionExpr, SketchObject};
use moldloft_font::{Font, HorizontalAlign, TextLayout, VerticalAlign, font_file};
use std::sync::Arc;

impl SketchSession {
    /// `TEXT name line … FONT font [SIZE h] [AT p q] [ANGLE d] [LEFT|…] [BASELINE|…] [PLANE XY] [MIRRORED]`.
    pub(super) fn text(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let name = new_name(args.name("a name for the section")?, args)?;
        let mut lines = Vec::new();
        while let Some(token) = args.peek().filter(|t| t.kind == CommandTokenKind::Text) {
            lines.push(token.text.clone());
            args.skip();
        }
        if lines.is_empty() {
            return Err(args.wants("a text in quotation marks"));
        }
        if !args.take("FONT") {
            return Err(args.wants("FONT and the name of a font"));
        }
        let font = args.name("a .ttf, .otf or .ttc file, or the name of a font")?;
        let size = match args.take("SIZE") {
            true => args.value(None)?,
            false => DimensionExpr::number(1.0),
        };
        let at = match args.take_short("AT") {
            true => [args.value(None)?, args.value(None)?],
            false => [0.0; 2].map(DimensionExpr::number),
        };
        let angle = match args.take("ANGLE") {
            true => args.value(None)?,
            false => DimensionExpr::number(0.0),
        };
        let mut layout = TextLayout::default();
        let along = [
            ("LEFT", HorizontalAlign::Left),
            ("CENTRE", HorizontalAlign::Centre),
            ("RIGHT", HorizontalAlign::Right),
        ];
        if let Some((_, align)) = along.into_iter().find(|(word, _)| args.take(word)) {
            layout.horizontal = align;
        }
        let across = [
            ("BASELINE", VerticalAlign::Baseline),
            ("BOTTOM", VerticalAlign::Bottom),
            ("MIDDLE", VerticalAlign::Middle),
            ("TOP", VerticalAlign::Top),
        ];
        if let Some((_, align)) = across.into_iter().find(|(word, _)| args.take(word)) {
            layout.vertical = align;
        }
        let mut axis = CoordinateAxis::Z;
        if args.take("PLANE") {
            let planes =
                [("XY", CoordinateAxis::Z), ("XZ", CoordinateAxis::Y), ("YZ", CoordinateAxis::X)];
            let found = planes.into_iter().find(|(word, _)| args.take_short(word));
            axis = found.ok_or_else(|| args.wants("XY, XZ or YZ"))?.1;
        }
        let mirrored = args.take("MIRRORED");
        args.end()?;
        let bytes = self.files.font(&font_file(&font)).map_err(|why| {
            CommandError::text(
                format!("the font {font} cannot be read: {why}"),
                "name a .ttf, .otf or .ttc file beside the sketch, or an installed font",
            )
        })?;
        let outlines = Font::new(&bytes, Some(&font))
            .and_then(|font| font.outlines(&lines.join("\n"), &layout))
            .map_err(|why| CommandError::text(format!("{font}: {why}"), why.help()))?;
        let mut own = OwnNumbers::new(SketchObject::new(&name, Some(axis)));
        let [p, q] = at;
        let text = SectionText {
            lines,
            font,
            layout,
            loops: Arc::new(outlines),
            axis,
            mirrored,
            size: own.add("SIZE", size)?,
            at: [own.add("TEXTP", p)?, own.add("TEXTQ", q)?],
            angle: own.add("TURN", angle)?,
        };
        let feature = Feature { kind: FeatureKind::Text(Box::new(text)), operands: Vec::new() };
        self.make_with(feature, own.made, &name, |_| None)
    }
}
