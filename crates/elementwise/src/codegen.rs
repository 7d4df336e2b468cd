//! Makes a program of a tape's instructions: which are taken together in one order, and where the results
//! of the others are kept.
//!
//! A product used by one sum only is computed by the sum's instruction, and a sum used only by
//! another sum is merged into that one. Everything else is stored in a slot, as few as possible.

use crate::tape::{Code, Instr, Src};
use crate::vm::{Operand, RowLocation, Sign, Term, VmInstruction, VmProgram};

/// Data about an instruction.
#[derive(Clone, Copy, Debug)]
struct InstrInfo {
    uses: u16,
    /// True for roots and checked instructions: their results are kept.
    own: bool,
    /// True when the order of another instruction computes it, too.
    absorbed: bool,
    /// Location of its result.
    home: Option<RowLocation>,
    /// The instruction whose order reads the result last.
    last: u16,
    step: EmittedOp,
}

/// An operand of a product or sum, without a register yet.
#[derive(Clone, Copy, Debug)]
enum PendingTerm {
    Own(Src),
    Scaled(Src, u16),
    Product(Src, Src),
    ScaledProduct(Src, u16, Src),
}

/// Form of an instruction that is not merged into another one.
#[derive(Clone, Copy, Debug)]
enum EmittedOp {
    /// Unchanged.
    Plain,
    Term(PendingTerm),
    Sum(PendingTerm, Sign, PendingTerm),
    Sums(Src, [(Sign, PendingTerm); 2]),
    Shifted(PendingTerm, Sign, u16),
    From(u16, PendingTerm),
}

/// Memory for planning.
#[derive(Debug, Default)]
pub struct Planner {
    nodes: Vec<InstrInfo>,
    /// Slots that are not in use.
    free: Vec<u16>,
    /// The slots of the sources, and the last instruction that reads each.
    sources: Vec<(Option<u16>, u16)>,
    /// Operands of the current instruction.
    read: Vec<Src>,
    /// Slots of constants of the current order.
    filled: Vec<u16>,
}

impl Planner {
    /// Fills in the orders of the program that computes the roots; `check` is true of instructions whose
    /// results must be finite.
    pub fn plan<T>(
        &mut self,
        code: &[Instr],
        roots: &[Src],
        check: impl Fn(usize) -> bool,
        program: &mut VmProgram<T>,
    ) {
        let n = code.len();
        let none = InstrInfo {
            uses: 0,
            own: false,
            absorbed: false,
            home: None,
            last: u16::MAX,
            step: EmittedOp::Plain,
        };
        self.nodes.clear();
        self.nodes.resize(n, none);
        self.free.clear();
        self.sources.clear();
        for root in roots {
            if let Src::Reg(k) = *root {
                self.nodes[k as usize].own = true;
            }
        }
        for k in (0..n).rev() {
            // Uses by used instructions; roots and checked instructions are always used.
            self.nodes[k].own |= check(k);
            if !self.is_wanted(k) {
                continue;
            }
            for operand in code[k].operands() {
                if let Src::Reg(p) = operand {
                    let uses = &mut self.nodes[*p as usize].uses;
                    *uses = uses.saturating_add(1);
                }
            }
        }
        // In reverse order, so that an instruction precedes those merged into it.
        for k in (0..n).rev() {
            if self.is_wanted(k) && !self.nodes[k].absorbed {
                let step = self.step(code, k);
                self.nodes[k].step = step;
                self.for_each_read(code, k, |this, src| match src {
                    Src::Reg(p) => {
                        let last = &mut this.nodes[p as usize].last;
                        *last = if *last == u16::MAX { k as u16 } else { *last };
                    }
                    Src::Plane(p) => {
                        let p = p as usize;
                        if this.sources.len() <= p {
                            this.sources.resize(p + 1, (None, u16::MAX));
                        }
                        let last = &mut this.sources[p].1;
                        *last = if *last == u16::MAX { k as u16 } else { *last };
                    }
                    Src::Const(_) => {}
                });
            }
        }
        program.orders.clear();
        program.slots = 0;
        for k in 0..n {
            if !self.is_wanted(k) || self.nodes[k].absorbed {
                continue;
            }
            self.read.clear();
            self.filled.clear();
            let order = self.order(code[k], self.nodes[k].step, check(k), program);
            // An operand read for the last time is free: an instruction reads a block before it
            // writes the same.
            self.let_go(k);
            let root = roots.iter().position(|r| *r == Src::Reg(k as u16));
            let home = match root {
                Some(out) => RowLocation::Out(out as u16),
                None => RowLocation::Slot(self.slot(program)),
            };
            self.nodes[k].home = Some(home);
            program.orders.push((order, home));
            if self.nodes[k].uses == 0
                && let RowLocation::Slot(slot) = home
            {
                self.free.push(slot);
            }
        }
    }

    fn is_wanted(&self, k: usize) -> bool {
        self.nodes[k].uses > 0 || self.nodes[k].own
    }

    /// The instruction whose result an operand is, when nothing else uses it.
    fn alone(&self, src: Src) -> Option<usize> {
        let Src::Reg(p) = src else { return None };
        let node = &self.nodes[p as usize];
        (node.uses == 1 && !node.own).then_some(p as usize)
    }

    /// The factors of a product that can be computed within the instruction that uses it; otherwise
    /// also an instruction of its own, when it absorbs one.
    fn product(&self, code: &[Instr], k: usize) -> Option<(PendingTerm, Option<usize>)> {
        let Instr { code: Code::Mul, of: [a, b] } = code[k] else { return None };
        let scaled = |src: Src| {
            let p = self.alone(src)?;
            match code[p] {
                Instr { code: Code::Mul, of: [Src::Const(_), Src::Const(_)] } => None,
                Instr { code: Code::Mul, of: [Src::Const(c), x] }
                | Instr { code: Code::Mul, of: [x, Src::Const(c)] } => Some((p, x, c)),
                _ => None,
            }
        };
        Some(match (a, b) {
            (Src::Const(_), Src::Const(_)) => return None,
            (Src::Const(c), x) | (x, Src::Const(c)) => (PendingTerm::Scaled(x, c), None),
            _ => match (scaled(a), scaled(b)) {
                (Some((p, x, c)), _) => (PendingTerm::ScaledProduct(x, c, b), Some(p)),
                (None, Some((p, x, c))) => (PendingTerm::ScaledProduct(x, c, a), Some(p)),
                (None, None) => (PendingTerm::Product(a, b), None),
            },
        })
    }

    /// The term of a sum's operand, with products used only by it merged.
    fn part(&mut self, code: &[Instr], src: Src) -> PendingTerm {
        let product = self.alone(src).and_then(|p| Some((p, self.product(code, p)?)));
        match product {
            Some((p, (part, inner))) => {
                self.nodes[p].absorbed = true;
                if let Some(q) = inner {
                    self.nodes[q].absorbed = true;
                }
                part
            }
            None => PendingTerm::Own(src),
        }
    }

    /// Form of an instruction, with those merged into it.
    fn step(&mut self, code: &[Instr], k: usize) -> EmittedOp {
        let Instr { code: what, of: [a, b] } = code[k];
        let sign = match what {
            Code::Add => Sign::Plus,
            Code::Sub => Sign::Minus,
            Code::Mul => {
                return match self.product(code, k) {
                    Some((part, inner)) => {
                        if let Some(q) = inner {
                            self.nodes[q].absorbed = true;
                        }
                        EmittedOp::Term(part)
                    }
                    None => EmittedOp::Plain,
                };
            }
            _ => return EmittedOp::Plain,
        };
        match (a, b, sign) {
            (Src::Const(_), Src::Const(_), _) => return EmittedOp::Plain,
            (x, Src::Const(c), _) | (Src::Const(c), x, Sign::Plus) => {
                return EmittedOp::Shifted(self.part(code, x), sign, c);
            }
            (Src::Const(c), x, Sign::Minus) => return EmittedOp::From(c, self.part(code, x)),
            _ => {}
        }
        // (x + y) + z, where x is a row.
        let inner = |this: &Self, src: Src| {
            let p = this.alone(src)?;
            let sign = match code[p].code {
                Code::Add => Sign::Plus,
                Code::Sub => Sign::Minus,
                _ => return None,
            };
            let [x, y] = code[p].of;
            let is_row = |src: Src| match src {
                Src::Const(_) => false,
                _ => this.alone(src).is_none_or(|q| this.product(code, q).is_none()),
            };
            let constant = matches!(x, Src::Const(_)) || matches!(y, Src::Const(_));
            match (is_row(x), is_row(y), sign) {
                _ if constant => None,
                (true, ..) => Some((p, x, sign, y)),
                (false, true, Sign::Plus) => Some((p, y, sign, x)),
                _ => None,
            }
        };
        let chained = inner(self, a).map(|found| (found, b)).or_else(|| {
            let found = inner(self, b).filter(|_| sign == Sign::Plus)?;
            Some((found, a))
        });
        match chained {
            Some(((p, x, first, y), z)) => {
                self.nodes[p].absorbed = true;
                let (y, z) = (self.part(code, y), self.part(code, z));
                EmittedOp::Sums(x, [(first, y), (sign, z)])
            }
            None => {
                let (a, b) = (self.part(code, a), self.part(code, b));
                EmittedOp::Sum(a, sign, b)
            }
        }
    }

    /// Calls for each source and result that an instruction's order reads.
    fn for_each_read(&mut self, code: &[Instr], k: usize, mut f: impl FnMut(&mut Self, Src)) {
        let mut part = |this: &mut Self, part: PendingTerm| match part {
            PendingTerm::Own(x) | PendingTerm::Scaled(x, _) => f(this, x),
            PendingTerm::Product(x, y) | PendingTerm::ScaledProduct(x, _, y) => {
                f(this, x);
                f(this, y);
            }
        };
        match self.nodes[k].step {
            EmittedOp::Plain => {
                for src in code[k].operands() {
                    part(self, PendingTerm::Own(*src));
                }
            }
            EmittedOp::Term(x) | EmittedOp::Shifted(x, ..) | EmittedOp::From(_, x) => part(self, x),
            EmittedOp::Sum(x, _, y) => {
                part(self, x);
                part(self, y);
            }
            EmittedOp::Sums(x, [(_, y), (_, z)]) => {
                part(self, PendingTerm::Own(x));
                part(self, y);
                part(self, z);
            }
        }
    }

    fn slot<T>(&mut self, program: &mut VmProgram<T>) -> u16 {
        self.free.pop().unwrap_or_else(|| {
            program.slots += 1;
            (program.slots - 1) as u16
        })
    }

    /// Frees the slots that were read for the last time.
    fn let_go(&mut self, k: usize) {
        for src in &self.read {
            match *src {
                Src::Reg(p) => {
                    let node = &mut self.nodes[p as usize];
                    if node.last == k as u16
                        && let Some(RowLocation::Slot(slot)) = node.home
                    {
                        self.free.push(slot);
                        // Read twice, freed once.
                        node.last = u16::MAX;
                    }
                }
                Src::Plane(p) => {
                    let (slot, last) = &mut self.sources[p as usize];
                    if *last == k as u16
                        && let Some(slot) = slot
                    {
                        self.free.push(*slot);
                        *last = u16::MAX;
                    }
                }
                Src::Const(_) => {}
            }
        }
        self.free.append(&mut self.filled);
    }

    /// The row of a source, constant or kept result; a source is brought there when it is read first.
    fn row<T>(&mut self, src: Src, program: &mut VmProgram<T>) -> RowLocation {
        self.read.push(src);
        match src {
            Src::Reg(p) => {
                let home = self.nodes[p as usize].home;
                home.expect("what is not absorbed is kept before it is read")
            }
            Src::Plane(p) => {
                if let Some(slot) = self.sources[p as usize].0 {
                    return RowLocation::Slot(slot);
                }
                let slot = self.slot(program);
                self.sources[p as usize].0 = Some(slot);
                program.orders.push((VmInstruction::Source(p), RowLocation::Slot(slot)));
                RowLocation::Slot(slot)
            }
            Src::Const(c) => {
                let slot = self.slot(program);
                self.filled.push(slot);
                program.orders.push((VmInstruction::Fill(c), RowLocation::Slot(slot)));
                RowLocation::Slot(slot)
            }
        }
    }

    fn term<T>(&mut self, part: PendingTerm, program: &mut VmProgram<T>) -> Term {
        match part {
            PendingTerm::Own(x) => Term::Row(self.row(x, program)),
            PendingTerm::Scaled(x, c) => Term::Scaled(self.row(x, program), c),
            PendingTerm::Product(x, y) => Term::Product(self.row(x, program), self.row(y, program)),
            PendingTerm::ScaledProduct(x, c, y) => {
                Term::ScaledProduct(self.row(x, program), c, self.row(y, program))
            }
        }
    }

    fn operand<T>(&mut self, src: Src, program: &mut VmProgram<T>) -> Operand {
        match src {
            Src::Const(c) => Operand::Const(c),
            _ => Operand::Row(self.row(src, program)),
        }
    }

    /// The order that carries a step out.
    fn order<T>(
        &mut self,
        Instr { code, of: [a, b] }: Instr,
        step: EmittedOp,
        check: bool,
        program: &mut VmProgram<T>,
    ) -> VmInstruction {
        match step {
            EmittedOp::Term(x) => VmInstruction::Term(self.term(x, program)),
            EmittedOp::Sum(x, sign, y) => {
                VmInstruction::Sum(self.term(x, program), sign, self.term(y, program))
            }
            EmittedOp::Sums(x, [(first, y), (second, z)]) => {
                let x = self.row(x, program);
                let (y, z) = (self.term(y, program), self.term(z, program));
                VmInstruction::Sums(x, [(first, y), (second, z)])
            }
            EmittedOp::Shifted(x, sign, c) => {
                VmInstruction::Shifted(self.term(x, program), sign, c)
            }
            EmittedOp::From(c, x) => VmInstruction::From(c, self.term(x, program)),
            EmittedOp::Plain => match code {
                Code::Unary(f) => VmInstruction::Unary(f, self.operand(a, program), check),
                Code::Binary(f) => {
                    let of = [a, b].map(|src| self.operand(src, program));
                    VmInstruction::Binary(f, of, check)
                }
                Code::Neg => VmInstruction::Neg(self.row(a, program)),
                Code::Abs => VmInstruction::Abs(self.row(a, program)),
                Code::Sqrt => VmInstruction::Sqrt(self.row(a, program)),
                // Both operands are constants.
                Code::Add | Code::Sub => {
                    let sign = if code == Code::Add { Sign::Plus } else { Sign::Minus };
                    let [x, y] = [a, b].map(|src| Term::Row(self.row(src, program)));
                    VmInstruction::Sum(x, sign, y)
                }
                Code::Mul => {
                    let [x, y] = [a, b].map(|src| self.row(src, program));
                    VmInstruction::Term(Term::Product(x, y))
                }
                Code::Div => match (a, b) {
                    (x, Src::Const(c)) => VmInstruction::Part(self.row(x, program), c, check),
                    (Src::Const(c), x) => VmInstruction::Over(c, self.row(x, program), check),
                    _ => {
                        let [x, y] = [a, b].map(|src| self.row(src, program));
                        VmInstruction::Ratio(x, y, check)
                    }
                },
            },
        }
    }
}
