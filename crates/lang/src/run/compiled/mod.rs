//! Compiled code for loops and routines on numbers, arrays and texts: a sequence of operations on registers.
//!
//! `loop or routine -> code -> registers`
//!
//! A loop, or the body of a routine, is compiled when it is met, together with the routines that it
//! calls. Names become registers, element-wise statements on whole arrays passes over the elements; a
//! statement that is neither (lists, objects, files) is one operation of the code: the variables are handed to the interpreter, it executes
//! the statement, and they are taken back. The same happens for most faults, so that the
//! interpreter reports them. Code counts steps as the interpreter does, and checks its limits and
//! cancellation every few hundred steps.
//!
//! Invariant: a run gives the same values, bit by bit, the same diagnostics and the same number of
//! steps with code and without; `tests/it/scalar_code.rs` of the crate `document` compares them.
//! The guards of a region ensure at entry that bindings are those of the compilation.

mod assignments;
mod code;
mod compile;
mod expressions;
mod faults;
mod inlined;
mod joins;
pub(crate) mod kept;
mod kernels;
mod machine;
mod names;
mod passes;
mod registers;
mod texts;
mod vectors;
mod walks;

use crate::run::interpreter::{Flow, Interpreter};
use crate::source::module::{Module, Name};
use code::{CodeRegion, Generation, NamePlace, RegionStart};
use kept::RegionState;
use moldloft_model::Extent;
use moldloft_registry::Scalar;
use moldloft_syntax::sdl::{RoutineId, StmtId};
use registers::RegisterMachine;
use std::collections::HashSet;
use std::sync::Arc;

/// Maximum number of specialisations of a region.
const MOST_OF_ONE: usize = 6;

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// Executes a loop by its code, if it has some; its own step is counted already.
    pub(super) fn loop_by_code(&mut self, m: &Module, stmt: StmtId) -> Option<Flow<T>> {
        self.by_code(m, RegionStart::Loop(stmt))
    }

    /// Executes the body of a routine by its code, if it has some, in the frame of its call.
    pub(super) fn body_by_code(&mut self, m: &Module, routine: RoutineId) -> Option<Flow<T>> {
        self.by_code(m, RegionStart::Body(routine.0))
    }

    fn by_code(&mut self, m: &Module, start: RegionStart) -> Option<Flow<T>> {
        if self.inputs.settings.reference
            || self.run.extent() == Extent::Edit
            || !self.env.scope.given.is_empty()
            || !std::ptr::eq(&**self.modules.get(self.current), m)
        {
            return None;
        }
        let key = (self.current, start);
        let generation = self.generation();
        let mut compiled = 0;
        if let Some(RegionState::Kept(all)) = self.code.regions.get_mut(&key) {
            all.retain(|region| region.generation == generation);
        }
        let region = match self.code.regions.get(&key) {
            Some(RegionState::Never(of)) if *of == generation => return None,
            Some(RegionState::Kept(all)) => {
                compiled = all.len();
                all.iter().find(|region| self.fits(region)).cloned()
            }
            _ => None,
        };
        let region = match region {
            Some(region) => region,
            None => {
                // A routine that gets now this variable, now that one by reference has code for each.
                if compiled >= MOST_OF_ONE {
                    return None;
                }
                match self.compiled(start) {
                    Some(region) => {
                        let region = Arc::new(region);
                        match self.code.regions.get_mut(&key) {
                            Some(RegionState::Kept(all)) => all.push(region.clone()),
                            _ => {
                                let all = vec![region.clone()];
                                self.code.regions.insert(key, RegionState::Kept(all));
                            }
                        }
                        region
                    }
                    None => {
                        if compiled == 0 {
                            self.code.regions.insert(key, RegionState::Never(generation));
                        }
                        return None;
                    }
                }
            }
        };
        let frames = self.env.scope.frames.len();
        let mut machine = RegisterMachine::new(&region, frames);
        self.take_back(&region, &mut machine);
        let flow = self.execute(&region, &mut machine);
        machine.unwind();
        if self.env.stopped {
            machine.poison(&region);
        }
        self.env.scope.frames.truncate(frames);
        self.hand_over(&region, &mut machine);
        for (unit, executed) in region.units.iter().zip(&machine.executed) {
            for (&(module, stmt), _) in
                unit.statements.iter().zip(executed).filter(|(_, done)| **done)
            {
                self.executed.note(module, stmt);
            }
        }
        Some(match flow {
            _ if self.env.stopped => Flow::Stop,
            flow => flow,
        })
    }

    fn generation(&self) -> Generation {
        let scope = &self.env.scope;
        (scope.executed.len(), scope.routines.len(), self.components.len())
    }

    /// True if names have the bindings for which the region was compiled.
    fn fits(&self, region: &CodeRegion<T>) -> bool {
        region.generation == self.generation()
            && (region.entry == 0) == self.env.scope.frame().global
            && region.guards.iter().all(|(name, place, what)| {
                self.guarded(*name, *place == NamePlace::File) == Some(*what)
            })
    }

    fn compiled(&mut self, start: RegionStart) -> Option<CodeRegion<T>> {
        let generation = self.generation();
        let known = self.code.of_file.as_ref().filter(|(of, ..)| *of == generation);
        let (of_file, plain) = match known {
            Some((_, of_file, plain)) => (of_file.clone(), *plain),
            None => {
                let (of_file, plain) = self.declared_by_routines();
                let of_file = Arc::new(of_file);
                self.code.of_file = Some((generation, of_file.clone(), plain));
                (of_file, plain)
            }
        };
        if !plain {
            return None;
        }
        let (modules, scope) = (&*self.modules, &self.env.scope);
        compile::compile(modules, scope, self.current, start, &of_file, generation)
    }

    /// The names that routines declare in the file, and whether they load no file.
    fn declared_by_routines(&self) -> (HashSet<Name>, bool) {
        let mut of_file = HashSet::new();
        let mut plain = true;
        for at in 0..self.modules.len() {
            let m = self.modules.get(at);
            for routine in m.program.routines() {
                let list = m.program[routine.body].to_vec();
                plain &= names::declared(m, &list, &mut |name, _, global| {
                    if global {
                        of_file.insert(name);
                    }
                });
            }
        }
        (of_file, plain)
    }
}
