//! CGNS files read: their zones as surfaces and blocks.

use crate::functions::run_call::RunCall;
use crate::run::interpreter::Interpreter;
use crate::source::module::Module;
use crate::value::variables::Called as _;
use moldloft_diag::{Diagnostic, nearest};
use moldloft_io::{NamedGrid, cgns};
use moldloft_registry::{Scalar, Value};
use moldloft_syntax::sdl::ExprId;

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// The zones of a file, and its name.
    fn zones(&mut self, m: &Module, file: ExprId) -> Result<(String, Vec<NamedGrid>), Diagnostic> {
        let (path, bytes) = self.bytes_of(m, file)?;
        let span = m.program[file].span;
        let zones = self.apart(bytes.len(), span, move || cgns::read(&bytes))?;
        let zones = zones.map_err(|e| {
            Diagnostic::error("cannot-read", format!("cannot read `{path}`: {e}")).at(span)
        })?;
        Ok((path.to_string(), zones))
    }

    /// `read_cgns("wing.cgns")`, `read_cgns("wing.cgns", 2)`, `read_cgns("wing.cgns", "upper")`.
    pub(crate) fn read_cgns(&mut self, call: &RunCall<'_>) -> Result<Value<T>, Diagnostic> {
        let m = call.m;
        let (path, zones) = self.zones(m, call.first())?;
        let at = match call.at(1) {
            None => Some(0),
            Some(arg) => match self.operand(m, arg)? {
                Value::Text(name) => {
                    let spelled = |zone: &NamedGrid| {
                        zone.name == *name || zone.name.strip_prefix("Z_") == Some(&*name)
                    };
                    let Some(at) = zones.iter().position(spelled) else {
                        let names: Vec<&str> =
                            zones.iter().map(|zone| zone.name.as_str()).collect();
                        let near = nearest(&name, names.iter().copied());
                        let message = format!("`{path}` has no zone \"{name}\"");
                        return Err(Diagnostic::error("outside", message)
                            .at(m.program[arg].span)
                            .expected(names.join(", "))
                            .found(format!("\"{name}\""))
                            .maybe_help(near.map(|near| format!("did you mean \"{near}\"?"))));
                    };
                    Some(at)
                }
                Value::Number(x) => {
                    let x = x.re();
                    let whole = x.fract() == 0.0 && x >= 1.0 && x <= zones.len() as f64;
                    whole.then(|| x as usize - 1)
                }
                other => {
                    return Err(Diagnostic::error("wrong-type", "expected a zone of the file")
                        .at(m.program[arg].span)
                        .expected("its number or its name")
                        .found(other.called()));
                }
            },
        };
        match at.and_then(|at| zones.get(at)) {
            Some(zone) => Ok(self.grid_value(&zone.grid)),
            None => Err(Diagnostic::error("outside", format!("`{path}` has no such zone"))
                .at(m.program[call.at(1).unwrap_or(call.first())].span)
                .expected(format!("a zone from 1 to {}", zones.len()))),
        }
    }

    /// `count_cgns("wing.cgns")`.
    pub(crate) fn count_cgns(&mut self, call: &RunCall<'_>) -> Result<Value<T>, Diagnostic> {
        let (_, zones) = self.zones(call.m, call.first())?;
        Ok(Value::Number(T::from(zones.len() as f64)))
    }

    /// `names_cgns("wing.cgns")`.
    pub(crate) fn names_cgns(&mut self, call: &RunCall<'_>) -> Result<Value<T>, Diagnostic> {
        let (_, zones) = self.zones(call.m, call.first())?;
        Ok(Value::list(zones.iter().map(|zone| Value::text(&zone.name))))
    }
}
