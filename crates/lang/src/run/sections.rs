//! Subscripts during a run, and the places that assignments write to.

use crate::run::interpreter::{Interpreter, silent};
use crate::source::module::Module;
use crate::source::scope::Binding;
use crate::value::chosen::{Chosen, Selected, along, index_array};
use crate::value::subarray::{ArraySection, PathStep, Place, Selection};
use crate::value::variables;
use crate::value::variables::Called as _;
use moldloft_diag::{Diagnostic, Span};
use moldloft_registry::{ArrayShape, Scalar, Value};
use moldloft_syntax::sdl::{ExprId, ExprKind, NodeList, Subscript};
use smallvec::SmallVec;

enum Subscripted {
    Section(ArraySection),
    Chosen(Chosen),
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    pub fn index(
        &mut self,
        m: &Module,
        id: ExprId,
        base: ExprId,
        subs: NodeList<Subscript>,
    ) -> Result<Value<T>, Diagnostic> {
        if let Some(text) = self.spelled(m, id)? {
            if let Some(value) = self.spelled_value(&text) {
                return Ok(value);
            }
            return Err(self.no_such_object(&text));
        }
        // A part of a variable passed by reference is read without a copy of the whole.
        if let Some(symbol) = m.program.as_name(base)
            && let Some(place) = self.env.scope.place_of(m.names[symbol.0 as usize])
            && (place.section.is_some() || !place.path.is_empty())
        {
            let (place, chosen) = self.indexed(m, place, base, subs)?;
            let Some(Binding::Variable { value, .. }) =
                self.env.scope.root(&place).map(|b| &b.what)
            else {
                return Err(silent());
            };
            let value = variables::at_place(value, &place)?;
            return match chosen {
                Some(chosen) => chosen.of(&value),
                None => has_value(m, id, value),
            };
        }
        let value = self.expr(m, base)?;
        let value = match self.opened(value) {
            list @ Value::List(_) => list,
            other => self.read(other, m.program[base].span)?,
        };
        let Some(extents) = variables::extents(&value) else {
            let class = value.called();
            return Err(Diagnostic::error("not-indexable", format!("{class} has no elements"))
                .expected("a row, grid or list before [")
                .found(class));
        };
        if let ([ni, nj, nk], 1) = (&extents[..], subs.len()) {
            // A single subscript of a block takes layers.
            let size = [*ni, *nj, *nk];
            let section = self.layers(m, base, size, subs)?;
            return variables::part(&value, section);
        }
        match self.section(m, base, &extents, |_| variables::shape_text(&value), subs)? {
            Subscripted::Section(section) => has_value(m, id, variables::part(&value, section)?),
            Subscripted::Chosen(chosen) => chosen.of(&value),
        }
    }

    /// A section of a place, or the place and its elements selected by masks or index arrays.
    fn indexed(
        &mut self,
        m: &Module,
        place: Place,
        base: ExprId,
        subs: NodeList<Subscript>,
    ) -> Result<(Place, Option<Chosen>), Diagnostic> {
        let Some(Binding::Variable { value, .. }) = self.env.scope.root(&place).map(|b| &b.what)
        else {
            return Err(silent());
        };
        let value = variables::inside(value, &place.path).ok_or_else(silent)?;
        if let (Value::List(items), None, [Subscript::At(sub)]) =
            (value, place.section, &m.program[subs])
        {
            let count = items.len();
            let index = self.operand(m, *sub)?;
            if let Value::Number(x) = index {
                let x = x.re();
                let span = m.program[*sub].span;
                let shape = |this: &Self| match this.env.scope.root(&place).map(|b| &b.what) {
                    Some(Binding::Variable { value, .. }) => variables::shape_at(value, &place),
                    _ => String::new(),
                };
                let k = position(x, count, span).map_err(|d| self.of_array(m, base, d, shape))?;
                return Ok((place.at(PathStep::Item(k as u32))?, None));
            }
        }
        let Some(Binding::Variable { value, .. }) = self.env.scope.root(&place).map(|b| &b.what)
        else {
            return Err(silent());
        };
        let value = variables::inside(value, &place.path).ok_or_else(silent)?;
        let extents = match place.section {
            Some(section) => {
                let (extents, count) = section.extents();
                extents[..count].to_vec()
            }
            None => match variables::extents(value) {
                Some(extents) => extents,
                None if matches!(value, Value::Unset) => {
                    let text = m.program.slice(m.program[base].span).to_string();
                    let declared = self.env.scope.root(&place).map_or(Span::UNKNOWN, |b| b.span);
                    let message = format!("`{text}` has no value yet");
                    return Err(
                        Diagnostic::error("no-value", message).note_at(declared, "declared here")
                    );
                }
                None => Vec::new(),
            },
        };
        if extents.is_empty() {
            let class = match place.section {
                Some(_) => "a single element",
                None => value.called(),
            };
            return Err(Diagnostic::error("not-indexable", format!("{class} has no elements"))
                .expected("a row, grid or list before [")
                .found(class));
        }
        if let ([ni, nj, nk], 1) = (&extents[..], subs.len()) {
            let section = self.layers(m, base, [*ni, *nj, *nk], subs)?;
            return Ok((place.indexed(section)?, None));
        }
        let shape = |this: &Self| {
            let root = this.env.scope.root(&place).map(|bound| &bound.what);
            match root {
                Some(Binding::Variable { value, .. }) => variables::shape_at(value, &place),
                _ => String::new(),
            }
        };
        match self.section(m, base, &extents, shape, subs)? {
            Subscripted::Section(section) => Ok((place.indexed(section)?, None)),
            Subscripted::Chosen(chosen) => Ok((place, Some(chosen))),
        }
    }

    /// The section of a block that a single subscript means: layers.
    fn layers(
        &mut self,
        m: &Module,
        base: ExprId,
        [ni, nj, nk]: [usize; 3],
        subs: NodeList<Subscript>,
    ) -> Result<ArraySection, Diagnostic> {
        match self.section(m, base, &[nk], |_| format!("a block of {nk} layers"), subs)? {
            Subscripted::Section(ArraySection::Row(k)) => {
                Ok(ArraySection::Block(Selection::whole(ni), Selection::whole(nj), k))
            }
            _ => Err(Diagnostic::error("wrong-subscripts", "masks choose from arrays, not blocks")
                .expected("numbers and ranges")),
        }
    }

    /// The subscripts as positions, checked against the extents of their base; `shape` describes it
    /// in errors.
    fn section(
        &mut self,
        m: &Module,
        base: ExprId,
        extents: &[usize],
        shape: impl Fn(&Self) -> String,
        subs: NodeList<Subscript>,
    ) -> Result<Subscripted, Diagnostic> {
        if let ([Subscript::At(sub)], [rows, columns]) = (&m.program[subs], extents) {
            // A mask of a grid, or an index of its lines.
            let index = self.operand(m, *sub)?;
            if let Some(index) = index_array(&index) {
                let chosen = Chosen::by(&index, ArrayShape::Grid(*rows, *columns));
                return chosen.map(Subscripted::Chosen).map_err(|d| d.or_at(m.program[*sub].span));
            }
        }
        if extents.len() != subs.len() {
            return Err(Diagnostic::error("wrong-subscripts", "wrong number of subscripts")
                .expected(format!("{} subscripts", extents.len()))
                .found(format!("{} subscripts", subs.len()))
                .note(format!("`{}` is {}", m.program.slice(m.program[base].span), shape(self))));
        }
        let mut parts: SmallVec<[Selected; 3]> = SmallVec::new();
        for (&sub, &extent) in m.program[subs].iter().zip(extents) {
            let part =
                self.selection(m, sub, extent).map_err(|d| self.of_array(m, base, d, &shape))?;
            parts.push(part);
        }
        let regular: Option<SmallVec<[Selection; 3]>> = parts
            .iter()
            .map(|part| match part {
                Selected::Regular(selection) => Some(*selection),
                Selected::Chosen(_) => None,
            })
            .collect();
        if let Some(section) = regular.and_then(|parts| ArraySection::of_parts(&parts)) {
            return Ok(Subscripted::Section(section));
        }
        if parts.len() > 2 {
            return Err(Diagnostic::error(
                "wrong-subscripts",
                "masks choose from arrays, not blocks",
            )
            .expected("numbers and ranges"));
        }
        Ok(match &parts[..] {
            [Selected::Chosen(a)] => Subscripted::Chosen(Chosen::of_row(a.clone())),
            [a, b, ..] => Subscripted::Chosen(Chosen::of_grid(a, b, extents[1])),
            _ => return Err(silent()),
        })
    }

    /// A fault in a subscript, with the array that it is about.
    fn of_array(
        &self,
        m: &Module,
        base: ExprId,
        d: Diagnostic,
        shape: impl Fn(&Self) -> String,
    ) -> Diagnostic {
        // A fault in a subscript of the subscript says already which array it is about.
        if d.id != "outside" || !d.secondary.is_empty() || !d.notes.is_empty() {
            return d;
        }
        let name = m.program.as_name(base).and_then(|symbol| {
            let bound = self.env.scope.lookup(m.names[symbol.0 as usize])?;
            Some((m.program.name(symbol), bound.span))
        });
        match name {
            Some((name, declared)) => {
                d.note_at(declared, format!("`{name}` is declared here: {}", shape(self)))
            }
            None => d.note(format!("the array is {}", shape(self))),
        }
    }

    fn selection(
        &mut self,
        m: &Module,
        sub: Subscript,
        extent: usize,
    ) -> Result<Selected, Diagnostic> {
        let bound = |this: &mut Self, expr: Option<ExprId>, default: f64| match expr {
            Some(expr) => this.number(m, expr).map(|x| (x.re(), m.program[expr].span)),
            None => Ok((default, Span::UNKNOWN)),
        };
        let inside = |(x, span): (f64, Span)| position(x, extent, span);
        let (from, to, step) = match sub {
            Subscript::Whole => return Ok(Selected::Regular(Selection::whole(extent))),
            Subscript::At(expr) => {
                let span = m.program[expr].span;
                return match self.operand(m, expr)? {
                    Value::Number(x) => {
                        let at = position(x.re(), extent, span)?;
                        Ok(Selected::Regular(Selection::at(at)))
                    }
                    other => match index_array(&other) {
                        Some(index) => {
                            along(&index, extent).map(Selected::Chosen).map_err(|d| d.or_at(span))
                        }
                        None => Err(Diagnostic::error("wrong-type", "expected a number")
                            .at(span)
                            .expected("a number, a mask or an array of positions")
                            .found(other.called())),
                    },
                };
            }
            Subscript::Range { from, to, step } => {
                let step = bound(self, step, 1.0)?.0;
                // A descending range begins at the last element.
                let ends = [1.0, extent as f64];
                let ends = if step < 0.0 { [ends[1], ends[0]] } else { ends };
                let from = bound(self, from, ends[0])?;
                let to = bound(self, to, ends[1])?;
                (inside(from)?, inside(to)?, step)
            }
        };
        Selection::range(from, to, step).map(Selected::Regular).ok_or_else(|| {
            Diagnostic::error("empty-range", "empty range")
                .expected("lo:hi with lo <= hi, or a negative step")
                .found(format!("{}:{}:{step}", from + 1, to + 1))
        })
    }

    /// The variable, section and component that a returned argument names.
    pub fn place(&mut self, m: &Module, id: ExprId) -> Result<Place, Diagnostic> {
        match self.target(m, id)? {
            (place, None) => Ok(place),
            (_, Some(_)) => {
                Err(Diagnostic::error("not-assignable", "elements chosen by a mask or an index")
                    .at(m.program[id].span)
                    .expected("a variable, or a range of it")
                    .help("assign them from a variable afterwards"))
            }
        }
    }

    /// The variable, section and component of an assignment's target, and its elements selected by
    /// masks or index arrays.
    pub fn target(
        &mut self,
        m: &Module,
        id: ExprId,
    ) -> Result<(Place, Option<Chosen>), Diagnostic> {
        let span = m.program[id].span;
        match m.program[id].kind {
            ExprKind::Paren(inner) => self.target(m, inner),
            ExprKind::Name(symbol) => {
                let name = m.names[symbol.0 as usize];
                let place = self.env.scope.place_of(name);
                Ok((place.ok_or_else(|| self.unknown_name(m, symbol, span))?, None))
            }
            ExprKind::Member { base, name, .. } => {
                let (place, chosen) = self.target(m, base)?;
                if let (Some(place), None) = (self.member_place(m, id, name, place)?, &chosen) {
                    return Ok((place, None));
                }
                let component = ["x", "y", "z"].iter().position(|c| *c == m.program.name(name));
                match component {
                    Some(c) if place.component.is_none() => {
                        Ok((Place { component: Some(c), ..place }, chosen))
                    }
                    _ => Err(Diagnostic::error("not-assignable", "this cannot be assigned to")
                        .at(span)
                        .expected("a variable, with subscripts or .x .y .z")),
                }
            }
            ExprKind::Index { base, subs } => {
                let place = self.place(m, base)?;
                match self.env.scope.root(&place).map(|bound| (&bound.what, bound.span)) {
                    Some((Binding::Variable { .. }, _)) => {
                        self.indexed(m, place, base, subs).map_err(|d| d.or_at(span))
                    }
                    Some((Binding::Poisoned, _)) | None => Err(silent()),
                    Some((_, declared)) => Err(not_a_variable(m, base, declared).at(span)),
                }
            }
            _ => Err(Diagnostic::error("not-assignable", "this cannot be assigned to")
                .at(span)
                .expected("a variable, with subscripts or .x .y .z")),
        }
    }
}

/// The position, from 0, that an index names.
fn position(x: f64, extent: usize, span: Span) -> Result<usize, Diagnostic> {
    if x.fract() == 0.0 && x >= 1.0 && x <= extent as f64 {
        return Ok(x as usize - 1);
    }
    let expected = match extent {
        0 => "no index: it is empty".to_string(),
        _ => format!("a whole number from 1 to {extent}"),
    };
    Err(Diagnostic::error("outside", format!("index {x} is outside the array"))
        .at(span)
        .expected(expected)
        .found(x.to_string()))
}

/// The value, if it is one: items of lists may not have been assigned yet.
fn has_value<T: Scalar>(m: &Module, id: ExprId, value: Value<T>) -> Result<Value<T>, Diagnostic> {
    if !matches!(value, Value::Unset) {
        return Ok(value);
    }
    let span = m.program[id].span;
    let text = m.program.slice(span).trim();
    Err(Diagnostic::error("no-value", format!("`{text}` has no value yet")).at(span))
}

/// Error for an assignment to an object or parameter.
fn not_a_variable(m: &Module, base: ExprId, declared: Span) -> Diagnostic {
    let text = m.program.slice(m.program[base].span);
    Diagnostic::error("not-assignable", format!("`{text}` cannot be assigned to"))
        .found("an object or parameter")
        .note_at(declared, "declared here")
        .help("objects are named once; change their data, or use a variable")
}
