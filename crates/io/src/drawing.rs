//! Lines drawings: the body plan, the waterlines and the buttocks of a hull as SVG.
//!
//! Sheets are in millimetres at a stated scale, so they print true. The body plan shows the
//! sections of the fore body on the right of the centre line and those of the after body on the
//! left; waterlines are drawn in x-y, buttocks in x-z.

use crate::text::{put, xml};
use std::fmt::Write as _;

/// A step may be shorter than the required one by this, relatively.
const ROUNDING: f64 = 1e-12;

/// An intersection of the model with a plane of constant coordinate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaneCut {
    /// Shown beside the line; may be empty.
    pub name: String,
    /// The coordinate that is constant: 0 for x (sections), 1 for y (buttocks), 2 for z.
    pub axis: usize,
    /// Its value.
    pub value: f64,
    /// The lines, points in model coordinates.
    pub polylines: Vec<Vec<[f64; 3]>>,
    /// Line width in millimetres; `None` for the drawing's own.
    pub width_mm: Option<f64>,
}

/// View of the hull.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// Sections in the y-z plane.
    BodyPlan,
    /// Waterlines in the x-y plane.
    Waterlines,
    /// Buttocks in the x-z plane.
    Buttocks,
}

impl View {
    /// The axis whose contours the view shows in true shape.
    fn axis(self) -> usize {
        match self {
            Self::BodyPlan => 0,
            Self::Buttocks => 1,
            Self::Waterlines => 2,
        }
    }

    /// Title on a sheet.
    fn title(self) -> &'static str {
        match self {
            Self::BodyPlan => "body plan",
            Self::Waterlines => "waterlines",
            Self::Buttocks => "buttocks",
        }
    }

    /// The view's name as one word, for names of layers and files.
    fn word(self) -> String {
        self.title().replace(' ', "-")
    }

    /// Names of the sheet's horizontal and vertical coordinate.
    fn labels(self) -> [&'static str; 2] {
        match self {
            Self::BodyPlan => ["y", "z"],
            Self::Waterlines => ["x", "y"],
            Self::Buttocks => ["x", "z"],
        }
    }
}

/// Options of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawingOptions {
    /// Title of the sheet.
    pub title: String,
    /// Name of the model's unit.
    pub unit: String,
    /// Millimetres in one model unit; 1000 for metres.
    pub unit_mm: f64,
    /// The n of the scale 1 : n; `None` for the largest round scale that fits `width_mm`.
    pub scale: Option<f64>,
    /// Maximum width of the drawing itself, in millimetres.
    pub width_mm: f64,
    /// True when the bow is at low x.
    pub bow_at_low_x: bool,
    /// Station that divides the fore from the after body; `None` for the middle of the sections.
    pub midship: Option<f64>,
    /// Width of the contours in millimetres.
    pub line_mm: f64,
    /// Width of the grid lines in millimetres.
    pub grid_mm: f64,
}

impl Default for DrawingOptions {
    /// Metres, bow at low x, contours of 0.35 mm and grid of 0.13 mm (ISO 128 widths), 260 mm wide.
    fn default() -> Self {
        Self {
            title: String::new(),
            unit: "m".into(),
            unit_mm: 1000.0,
            scale: None,
            width_mm: 260.0,
            bow_at_low_x: true,
            midship: None,
            line_mm: 0.35,
            grid_mm: 0.13,
        }
    }
}

/// Space around the drawing for labels, and below it for the scale bar, in millimetres.
const MARGIN: f64 = 16.0;
const FOOT: f64 = 16.0;

/// The sheet: the contours of the view as lines; a grid of round numbers with labels; the centre
/// line and z = 0 in heavy lines; names on the lines; the scale in words and as a bar. A point that
/// is not finite ends a line.
pub fn draw(view: View, contours: &[PlaneCut], options: &DrawingOptions) -> Vec<u8> {
    let lines = projected(view, contours, options);
    let sheet = SheetLayout::around(&lines, options);
    let mut out = String::new();
    sheet.head(&mut out, view, options);
    sheet.grid(&mut out, view, options);
    for line in &lines {
        sheet.line(&mut out, line, options);
    }
    for line in &lines {
        sheet.name(&mut out, line);
    }
    sheet.foot(&mut out, options);
    out.push_str("</svg>\n");
    out.into_bytes()
}

/// The lines plan: profile, half-breadth plan below it and body plan beside it on one sheet at one
/// scale, with a common grid, so that stations, waterlines and buttocks are aligned between the
/// views.
pub fn draw_plan(contours: &[PlaneCut], options: &DrawingOptions) -> Vec<u8> {
    let [profile, plan, body] = [View::Buttocks, View::Waterlines, View::BodyPlan]
        .map(|view| (view, projected(view, contours, options)));
    let mut layouts =
        [&profile, &plan, &body].map(|(_, lines)| SheetLayout::around(lines, options));
    let empty = [&profile, &plan, &body].map(|(_, lines)| lines.is_empty());
    let step = layouts.iter().zip(empty).filter(|(_, empty)| !empty).map(|(l, _)| l.step);
    let step = step.fold(f64::NAN, f64::max);
    let step = if step.is_nan() { layouts[0].step } else { step };
    // Stations are in line below each other, waterlines beside each other.
    for (pair, low) in [([0, 1], 0), ([0, 2], 2)] {
        let of = |k: usize| if empty[k] { None } else { Some(layouts[k].edges) };
        let [one, two] = pair.map(|k| of(k).or(of(pair[0])).or(of(pair[1])));
        let (Some(one), Some(two)) = (one, two) else { continue };
        let low_edge = step * libm::floor(one[low].min(two[low]) / step);
        let high_edge = step * libm::ceil(one[low + 1].max(two[low + 1]) / step);
        for k in pair {
            layouts[k].edges[low] = low_edge;
            layouts[k].edges[low + 1] = high_edge;
        }
    }
    for (layout, low) in [(1, 2), (2, 0)] {
        let edges = &mut layouts[layout].edges;
        edges[low] = step * libm::floor(edges[low] / step);
        edges[low + 1] = step * libm::ceil(edges[low + 1] / step);
    }
    let across = |layout: &SheetLayout| layout.edges[1] - layout.edges[0];
    let full_size = (across(&layouts[0]) + across(&layouts[2])) * options.unit_mm;
    let room = (options.width_mm - 3.0 * MARGIN).max(MARGIN);
    let scale = options.scale.unwrap_or_else(|| round_up(full_size / room));
    for layout in &mut layouts {
        (layout.step, layout.scale, layout.mm) = (step, scale, options.unit_mm / scale);
    }
    let [[left, upper], [_, lower], [right, _]] = layouts.each_ref().map(SheetLayout::size);
    let (width, height) = (left + right - MARGIN, upper - FOOT + lower);
    let mut out = String::new();
    open(&mut out, [width, height], &xml(&options.title));
    let places = [[0.0, 0.0], [0.0, upper - FOOT], [left - MARGIN, 0.0]];
    for (((view, lines), layout), [x, y]) in [profile, plan, body].iter().zip(&layouts).zip(places)
    {
        put!(out, "<g id=\"{}\" transform=\"translate({x:.2} {y:.2})\">\n", view.word());
        layout.grid(&mut out, *view, options);
        lines.iter().for_each(|line| layout.line(&mut out, line, options));
        lines.iter().for_each(|line| layout.name(&mut out, line));
        out.push_str("</g>\n");
    }
    put!(out, "<g transform=\"translate(0 {:.2})\">\n", upper - FOOT);
    layouts[1].foot(&mut out, options);
    out.push_str("</g>\n</svg>\n");
    out.into_bytes()
}

/// The head of a sheet of `size` millimetres.
fn open(out: &mut String, [width, height]: [f64; 2], title: &str) {
    put!(
        *out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.2}mm\" \
         height=\"{height:.2}mm\" viewBox=\"0 0 {width:.2} {height:.2}\" \
         font-family=\"Helvetica, Arial, sans-serif\" font-size=\"2.5\">\n<title>{title}</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"{MARGIN}\" y=\"7\" font-size=\"4\">{title}</text>\n"
    );
}

/// A line on the drawing plane, in model units.
struct DrawingLine {
    name: String,
    /// Position of the name.
    label: Option<[f64; 2]>,
    /// Distance above that position, in millimetres: above the end of a line, or at its middle.
    lift_mm: f64,
    width: Option<f64>,
    points: Vec<[f64; 2]>,
}

fn projected(view: View, contours: &[PlaneCut], options: &DrawingOptions) -> Vec<DrawingLine> {
    let shown = || contours.iter().filter(|c| c.axis == view.axis());
    let (low, high) = shown().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| {
        (low.min(c.value), high.max(c.value))
    });
    let midship = options.midship.unwrap_or(0.5 * (low + high));
    let mut lines = Vec::new();
    for contour in shown() {
        // Fore body to the right: the side of y of the section is mirrored as needed; a section at
        // midships belongs to the fore body.
        let fore =
            if options.bow_at_low_x { contour.value <= midship } else { contour.value >= midship };
        let side = if fore { 1.0 } else { -1.0 };
        let flat = |p: &[f64; 3]| match view {
            View::BodyPlan => [side * p[1].abs(), p[2]],
            View::Waterlines => [p[0], p[1]],
            View::Buttocks => [p[0], p[2]],
        };
        for polyline in &contour.polylines {
            let runs = polyline.split(|p| p.iter().any(|x| !x.is_finite()));
            for run in runs.filter(|run| run.len() > 1) {
                let points: Vec<[f64; 2]> = run.iter().map(flat).collect();
                let label = match view {
                    // Sections and buttocks part at their higher ends.
                    View::BodyPlan | View::Buttocks => {
                        let ends = points.first().zip(points.last());
                        ends.map(|(a, b)| if a[1] >= b[1] { *a } else { *b })
                    }
                    // Waterlines meet at their ends: one after the other names its line a bit
                    // further along, about the middle.
                    View::Waterlines => {
                        let along = 0.35 + 0.06 * (lines.len() % 6) as f64;
                        points.get((points.len() as f64 * along) as usize).copied()
                    }
                };
                let (name, width) = (contour.name.clone(), contour.width_mm);
                let lift_mm = if view == View::Waterlines { -0.6 } else { 0.8 };
                lines.push(DrawingLine { name, label, lift_mm, width, points });
            }
        }
    }
    lines
}

/// The next of 1, 2, 2.5, 5, 10 times a power of ten that is not below `x`.
fn round_up(x: f64) -> f64 {
    if !(x > 0.0 && x.is_finite()) {
        return 1.0;
    }
    let power = libm::pow(10.0, libm::floor(libm::log10(x)));
    let steps = [1.0, 2.0, 2.5, 5.0, 10.0, 20.0];
    steps.into_iter().map(|s| s * power).find(|&s| s >= x * (1.0 - ROUNDING)).unwrap_or(x)
}

struct SheetLayout {
    /// Model coordinates of the drawing's edges, on grid lines: left, right, bottom, top.
    edges: [f64; 4],
    /// Millimetres on paper per model unit.
    mm: f64,
    /// The n of 1 : n.
    scale: f64,
    /// Grid spacing in model units.
    step: f64,
}

impl SheetLayout {
    fn around(lines: &[DrawingLine], options: &DrawingOptions) -> Self {
        let mut edges = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        for [x, y] in lines.iter().flat_map(|l| &l.points) {
            edges = [edges[0].min(*x), edges[1].max(*x), edges[2].min(*y), edges[3].max(*y)];
        }
        if edges[0] > edges[1] {
            edges = [0.0, 1.0, 0.0, 1.0];
        }
        let size = (edges[1] - edges[0]).max(edges[3] - edges[2]).max(f64::MIN_POSITIVE);
        let step = round_up(size / 12.0);
        for (k, edge) in edges.iter_mut().enumerate() {
            let cells = *edge / step;
            *edge = step * if k % 2 == 0 { libm::floor(cells) } else { libm::ceil(cells) };
        }
        if edges[0] == edges[1] {
            edges[1] += step;
        }
        if edges[2] == edges[3] {
            edges[3] += step;
        }
        let full_size = (edges[1] - edges[0]) * options.unit_mm;
        let scale = options.scale.unwrap_or_else(|| round_up(full_size / options.width_mm));
        Self { edges, mm: options.unit_mm / scale, scale, step }
    }

    fn x(&self, x: f64) -> f64 {
        MARGIN + (x - self.edges[0]) * self.mm
    }

    fn y(&self, y: f64) -> f64 {
        MARGIN + (self.edges[3] - y) * self.mm
    }

    fn size(&self) -> [f64; 2] {
        [self.x(self.edges[1]) + MARGIN, self.y(self.edges[2]) + MARGIN + FOOT]
    }

    fn head(&self, out: &mut String, view: View, options: &DrawingOptions) {
        let title = xml(&options.title);
        let view = view.title();
        let title = if title.is_empty() { view.into() } else { format!("{title}: {view}") };
        open(out, self.size(), &title);
    }

    fn grid(&self, out: &mut String, view: View, options: &DrawingOptions) {
        let [left, right, bottom, top] = self.edges;
        let (thin, heavy) = (options.grid_mm, 2.0 * options.grid_mm);
        put!(*out, "<g class=\"grid\" stroke=\"#9ab\" stroke-width=\"{thin}\" fill=\"none\">\n");
        let ticks = |from: f64, to: f64| {
            let first = libm::round(from / self.step) as i64;
            let last = libm::round(to / self.step) as i64;
            (first..=last).map(|k| k as f64 * self.step)
        };
        let weight = |value: f64| {
            if value == 0.0 {
                format!(" stroke=\"#456\" stroke-width=\"{heavy}\"")
            } else {
                String::new()
            }
        };
        for x in ticks(left, right) {
            let (at, style) = (self.x(x), weight(x));
            put!(*out, "<path d=\"M{at:.3} {:.3}V{:.3}\"{style}/>\n", self.y(top), self.y(bottom));
        }
        for y in ticks(bottom, top) {
            let (at, style) = (self.y(y), weight(y));
            put!(*out, "<path d=\"M{:.3} {at:.3}H{:.3}\"{style}/>\n", self.x(left), self.x(right));
        }
        put!(*out, "</g>\n<g class=\"labels\" fill=\"#456\">\n");
        let label = |value: f64| {
            // Both halves of a body plan count the half-breadth from the centre line.
            let text = format!("{:.6}", value + 0.0);
            text.trim_end_matches('0').trim_end_matches('.').to_string()
        };
        let [across, up] = view.labels();
        for x in ticks(left, right) {
            let shown = if view == View::BodyPlan { x.abs() } else { x };
            let (at, below) = (self.x(x), self.y(bottom) + 4.0);
            put!(
                *out,
                "<text x=\"{at:.2}\" y=\"{below:.2}\" text-anchor=\"middle\">{}</text>\n",
                label(shown)
            );
        }
        for y in ticks(bottom, top) {
            let (at, beside) = (self.y(y) + 0.9, self.x(left) - 1.5);
            put!(
                *out,
                "<text x=\"{beside:.2}\" y=\"{at:.2}\" text-anchor=\"end\">{}</text>\n",
                label(y)
            );
        }
        let (x, y) = (self.x(right) + 3.0, self.y(bottom) + 4.0);
        put!(*out, "<text x=\"{x:.2}\" y=\"{y:.2}\" font-style=\"italic\">{across}</text>\n");
        let (x, y) = (self.x(left) - 1.5, self.y(top) - 2.5);
        put!(
            *out,
            "<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"end\" font-style=\"italic\">{up}</text>\n</g>\n"
        );
    }

    fn line(&self, out: &mut String, line: &DrawingLine, options: &DrawingOptions) {
        let width = line.width.unwrap_or(options.line_mm);
        out.push_str("<path d=\"");
        for (k, [x, y]) in line.points.iter().enumerate() {
            put!(*out, "{}{:.3} {:.3}", if k == 0 { 'M' } else { 'L' }, self.x(*x), self.y(*y));
        }
        put!(
            *out,
            "\" fill=\"none\" stroke=\"#124\" stroke-width=\"{width}\" stroke-linejoin=\"round\" \
             stroke-linecap=\"round\"/>\n"
        );
    }

    /// The name of a line on a white halo (a text of its own, as not every viewer supports
    /// `paint-order`), so it interrupts the lines behind it.
    fn name(&self, out: &mut String, line: &DrawingLine) {
        let Some([x, y]) = line.label.filter(|_| !line.name.is_empty()) else { return };
        let (x, y, name) = (self.x(x), self.y(y) - line.lift_mm, xml(&line.name));
        for style in ["fill=\"#fff\" stroke=\"#fff\" stroke-width=\"0.6\"", "fill=\"#124\""] {
            put!(
                *out,
                "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"1.8\" text-anchor=\"middle\" {style}>\
                 {name}</text>\n"
            );
        }
    }

    /// The scale in words and as a bar of five round parts.
    fn foot(&self, out: &mut String, options: &DrawingOptions) {
        let part = round_up(self.step / 2.0);
        let y = self.size()[1] - 8.0;
        let unit = xml(&options.unit);
        let _ =
            writeln!(out, "<g id=\"scale\" stroke=\"#124\" stroke-width=\"0.13\" fill=\"#124\">");
        for k in 0..5 {
            let (x, width) = (MARGIN + k as f64 * part * self.mm, part * self.mm);
            let fill = if k % 2 == 0 { "#124" } else { "#fff" };
            put!(
                *out,
                "<rect x=\"{x:.3}\" y=\"{y:.2}\" width=\"{width:.3}\" height=\"1.4\" fill=\"{fill}\"/>\n"
            );
        }
        for (k, anchor) in [(0, "start"), (5, "middle")] {
            let (x, y) = (MARGIN + k as f64 * part * self.mm, y - 1.0);
            let value = format!("{:.6}", k as f64 * part);
            let value = value.trim_end_matches('0').trim_end_matches('.');
            let unit = if k == 5 { format!(" {unit}") } else { String::new() };
            put!(
                *out,
                "<text x=\"{x:.2}\" y=\"{y:.2}\" stroke=\"none\" text-anchor=\"{anchor}\">{value}{unit}</text>\n"
            );
        }
        let x = MARGIN + 5.0 * part * self.mm + 14.0;
        let scale = (self.scale * 1000.0).round() / 1000.0;
        put!(
            *out,
            "<text x=\"{x:.2}\" y=\"{:.2}\" stroke=\"none\" font-size=\"3\">scale 1 : {scale}</text>\n</g>\n",
            y + 1.4
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sections() -> Vec<PlaneCut> {
        let frame = |x: f64, b: f64| PlaneCut {
            name: format!("x={x}"),
            axis: 0,
            value: x,
            polylines: vec![vec![[x, 0.0, -1.0], [x, b, 0.0], [x, b, 1.0]]],
            width_mm: (x == 0.0).then_some(0.7),
        };
        vec![frame(0.0, 1.0), frame(5.0, 2.0), frame(10.0, 1.5)]
    }

    #[test]
    fn fore_body_right_after_body_left() {
        let svg = String::from_utf8(draw(View::BodyPlan, &sections(), &DrawingOptions::default()))
            .unwrap();
        // 4 m wide at 1 : 20 is 200 mm; the centre line is at 16 + 100.
        assert!(svg.contains("scale 1 : 20"), "{svg}");
        let starts: Vec<&str> = svg
            .match_indices("fill=\"none\" stroke=\"#124\"")
            .map(|(k, _)| {
                let from = svg[..k].rfind("d=\"M").unwrap();
                &svg[from + 4..k - 2]
            })
            .collect();
        assert_eq!(starts.len(), 3);
        let ends: Vec<f64> = starts
            .iter()
            .map(|d| d.rsplit('L').next().unwrap().split(' ').next().unwrap().parse().unwrap())
            .collect();
        let centre: f64 = starts[0].split(' ').next().unwrap().parse().unwrap();
        assert_eq!(ends.map_offsets(centre), [50.0, 100.0, -75.0]);
        assert!(svg.contains("stroke-width=\"0.7\""));
    }

    trait Offsets {
        fn map_offsets(&self, centre: f64) -> Vec<f64>;
    }

    impl Offsets for Vec<f64> {
        fn map_offsets(&self, centre: f64) -> Vec<f64> {
            self.iter().map(|x| x - centre).collect()
        }
    }

    #[test]
    fn empty_and_broken_input_still_draws() {
        let nothing = draw(View::Buttocks, &[], &DrawingOptions::default());
        assert!(nothing.ends_with(b"</svg>\n"));
        let broken = PlaneCut {
            name: "<&>".into(),
            axis: 2,
            polylines: vec![vec![[0.0; 3], [1.0, f64::NAN, 0.0], [2.0, 0.0, 0.0], [3.0, 1.0, 0.0]]],
            ..PlaneCut::default()
        };
        let svg = draw(View::Waterlines, &[broken], &DrawingOptions::default());
        let svg = String::from_utf8(svg).unwrap();
        assert!(!svg.contains("NaN") && svg.contains("&lt;&amp;&gt;"));
    }

    #[test]
    fn the_views_of_a_plan_are_in_line() {
        let mut cuts = sections();
        let line = |axis: usize, value: f64, ends: [[f64; 3]; 2]| PlaneCut {
            axis,
            value,
            polylines: vec![ends.to_vec()],
            ..PlaneCut::default()
        };
        cuts.push(line(1, 0.5, [[0.5, 0.5, -0.9], [9.5, 0.5, 0.8]]));
        cuts.push(line(2, 0.0, [[1.0, 0.1, 0.0], [9.0, 1.7, 0.0]]));
        let svg = String::from_utf8(draw_plan(&cuts, &DrawingOptions::default())).unwrap();
        // 10 m and 4 m side by side in 260 mm less three margins: 1 : 100.
        assert_eq!(svg.matches("scale 1 : 100").count(), 1, "{svg}");
        let of = |view: &str| {
            let from = svg.find(&format!("<g id=\"{view}\" transform=\"translate(")).unwrap();
            let (head, rest) = svg[from..].split_once(")\">").unwrap();
            let numbers = |text: &str| -> Vec<f64> {
                text.split(|c: char| !c.is_ascii_digit() && c != '.' && c != '-')
                    .filter_map(|x| x.parse().ok())
                    .collect()
            };
            let shift = numbers(head.rsplit('(').next().unwrap());
            let path = rest.split("fill=\"none\" stroke=\"#124\"").next().unwrap();
            let first = numbers(path.rsplit("d=\"").next().unwrap());
            first.chunks(2).map(|p| [p[0] + shift[0], p[1] + shift[1]]).collect::<Vec<_>>()
        };
        let (profile, plan, body) = (of("buttocks"), of("waterlines"), of("body-plan"));
        let near = |a: f64, b: f64| assert!((a - b).abs() < 0.01, "{a} {b} {svg}");
        // A metre is 10 mm: stations below each other, heights beside each other.
        near(plan[0][0] - profile[0][0], 5.0);
        near(profile[0][1] - profile[1][1], 17.0);
        // The section begins at z = -1, the buttock at -0.9.
        near(body[0][1] - profile[0][1], 1.0);
        assert!(body[0][0] > profile[1][0] && plan[0][1] > profile[0][1]);
        // Nothing to draw, and one view alone, are sheets, too.
        for cuts in [&[][..], &cuts[..1], &cuts[3..]] {
            let svg = String::from_utf8(draw_plan(cuts, &DrawingOptions::default())).unwrap();
            assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf"));
        }
    }

    #[test]
    fn round_numbers() {
        for (x, expected) in [(0.9, 1.0), (1.0, 1.0), (1.1, 2.0), (2.2, 2.5), (26.0, 50.0)] {
            assert!((round_up(x) - expected).abs() < 1e-12, "{x}");
        }
        assert_eq!(round_up(0.0), 1.0);
    }
}
