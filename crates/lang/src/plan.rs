//! Makes a program of a tape's instructions: which results stay in registers, and where the others are
//! kept.
//!
//! A result that one other instruction alone uses is computed as a part of it, as far as the machine's
//! two registers reach (Sethi and Ullman 1970); the rest is stored, in as few slots as possible.

use crate::fused::{Code, Instr, Src};
use crate::machine::{Op, Operand, Order, Program, Reg, Row, Sign};

/// The registers of the machine.
const REGISTERS: u8 = 2;

/// Instructions are parts of others at most so deep, since they are walked through by recursion.
const DEEPEST: u8 = 60;

/// What is known of an instruction.
#[derive(Clone, Copy, Debug)]
struct Node {
    uses: u16,
    /// The instruction that it is a part of, directly.
    part_of: Option<u16>,
    /// Registers that it takes.
    registers: u8,
    /// How deep its parts go.
    depth: u8,
    /// Where its result is kept.
    home: Option<Row>,
    /// The kept instruction that reads the result last.
    last: u16,
}

/// Memory for planning.
#[derive(Debug, Default)]
pub(crate) struct Planner {
    nodes: Vec<Node>,
    /// Slots that are not in use.
    free: Vec<u16>,
    /// Kept results that the instruction under way reads.
    read: Vec<u16>,
}

impl Planner {
    /// Fills in the orders of the program that computes the roots; `check` gives the number of the check
    /// of an instruction that has one.
    pub fn plan<T>(
        &mut self,
        code: &[Instr],
        roots: &[Src],
        check: impl Fn(usize) -> Option<u16>,
        program: &mut Program<T>,
    ) {
        let n = code.len();
        let none =
            Node { uses: 0, part_of: None, registers: 1, depth: 0, home: None, last: u16::MAX };
        self.nodes.clear();
        self.nodes.resize(n, none);
        self.free.clear();
        let root_of = |k: usize| roots.iter().position(|r| *r == Src::Reg(k as u16));
        for k in (0..n).rev() {
            // Uses by what is itself used; roots and checked instructions always are.
            let node = &mut self.nodes[k];
            node.uses = node.uses.saturating_add(u16::from(root_of(k).is_some()));
            if node.uses == 0 && check(k).is_none() {
                continue;
            }
            for operand in code[k].operands() {
                if let Src::Reg(p) = operand {
                    let used = &mut self.nodes[*p as usize].uses;
                    *used = used.saturating_add(1);
                }
            }
        }
        for k in 0..n {
            if self.nodes[k].uses > 0 || check(k).is_some() {
                self.take_parts(code, k, |p| root_of(p).is_none());
            }
        }
        // What keeps its result reads the results that its parts do.
        for k in (0..n).rev() {
            if self.nodes[k].uses == 0 && check(k).is_none() {
                continue;
            }
            let mut reader = k as u16;
            while let Some(whole) = self.nodes[reader as usize].part_of {
                reader = whole;
            }
            for operand in code[k].operands() {
                if let Src::Reg(p) = operand
                    && self.nodes[*p as usize].part_of.is_none()
                {
                    let last = &mut self.nodes[*p as usize].last;
                    *last = if *last == u16::MAX { reader } else { reader.max(*last) };
                }
            }
        }
        program.orders.clear();
        program.slots = 0;
        for k in 0..n {
            let node = self.nodes[k];
            if node.part_of.is_some() || node.uses == 0 && check(k).is_none() {
                continue;
            }
            let out = root_of(k).map(|out| Row::Out(out as u16));
            self.read.clear();
            match code[k].code {
                Code::Unary(f) => {
                    self.value(code, code[k].of[0], program);
                    let to = self.keep(k, out, program);
                    program.orders.push(Order::Unary(f, to, check(k)));
                    self.let_go(k);
                }
                Code::Binary(f) => {
                    self.value(code, code[k].of[0], program);
                    // Its other operand is read after this is written.
                    let to = self.keep(k, out, program);
                    let y = self.operand(code[k].of[1]);
                    program.orders.push(Order::Binary(f, to, y, check(k)));
                    self.let_go(k);
                }
                _ => {
                    self.compute(code, k, Reg::A, program);
                    self.let_go(k);
                    self.keep(k, out, program);
                }
            }
            if self.nodes[k].uses == 0
                && let Some(Row::Slot(slot)) = self.nodes[k].home
            {
                self.free.push(slot);
            }
        }
    }

    /// Makes parts of an instruction of those whose results it alone uses.
    fn take_parts(&mut self, code: &[Instr], k: usize, free: impl Fn(usize) -> bool) {
        let part = |nodes: &[Node], src: &Src| -> Option<u16> {
            let Src::Reg(p) = *src else { return None };
            let (node, at) = (nodes[p as usize], p as usize);
            let function = matches!(code[at].code, Code::Unary(_) | Code::Binary(_));
            (node.uses == 1 && node.depth < DEEPEST && !function && free(at)).then_some(p)
        };
        let (first, second) = match code[k].code {
            // Functions take their second operand from memory.
            Code::Binary(_) => (part(&self.nodes, &code[k].of[0]), None),
            _ => {
                let mut all = code[k].operands().iter().map(|src| part(&self.nodes, src));
                (all.next().flatten(), all.next().flatten())
            }
        };
        let registers = |p: Option<u16>| p.map_or(0, |p| self.nodes[p as usize].registers);
        let both = [registers(first), registers(second)];
        // Two that take as many registers each take one more together.
        let together = if both[0] == both[1] { both[0] + 1 } else { both[0].max(both[1]) };
        let second = second.filter(|_| together <= REGISTERS);
        let parts = [first, second];
        let depth = parts.iter().flatten().map(|p| self.nodes[*p as usize].depth + 1).max();
        for p in parts.into_iter().flatten() {
            self.nodes[p as usize].part_of = Some(k as u16);
        }
        let node = &mut self.nodes[k];
        node.registers = match (first, second) {
            (Some(_), Some(_)) => together,
            _ => both[usize::from(first.is_none())].max(1),
        };
        node.depth = depth.unwrap_or(0);
    }

    /// The place for a result, which is in register A.
    fn keep<T>(&mut self, k: usize, out: Option<Row>, program: &mut Program<T>) -> Row {
        let to = out.unwrap_or_else(|| {
            Row::Slot(self.free.pop().unwrap_or_else(|| {
                program.slots += 1;
                (program.slots - 1) as u16
            }))
        });
        self.nodes[k].home = Some(to);
        program.orders.push(Order::Store(to));
        to
    }

    /// Frees the slots that were read for the last time.
    fn let_go(&mut self, k: usize) {
        for &p in &self.read {
            let node = &mut self.nodes[p as usize];
            if node.last == k as u16
                && let Some(Row::Slot(slot)) = node.home
            {
                self.free.push(slot);
                // Read twice, freed once.
                node.last = u16::MAX;
            }
        }
    }

    /// A source, constant or kept result.
    fn operand(&mut self, src: Src) -> Operand {
        match src {
            Src::Plane(p) => Operand::Row(Row::Plane(p)),
            Src::Const(c) => Operand::Const(c),
            Src::Reg(p) => {
                self.read.push(p);
                let home = self.nodes[p as usize].home;
                Operand::Row(home.expect("what is no part is kept before it is read"))
            }
        }
    }

    /// The part that an operand of an instruction is.
    fn part(&self, src: Src) -> Option<usize> {
        match src {
            Src::Reg(p) if self.nodes[p as usize].part_of.is_some() => Some(p as usize),
            _ => None,
        }
    }

    /// Orders that bring a value into register A.
    fn value<T>(&mut self, code: &[Instr], src: Src, program: &mut Program<T>) {
        match self.part(src) {
            Some(p) => self.compute(code, p, Reg::A, program),
            None => {
                let x = self.operand(src);
                program.orders.push(Order::Load(Reg::A, x));
            }
        }
    }

    /// Orders that compute an instruction's result in a register; in B only what needs no other.
    fn compute<T>(&mut self, code: &[Instr], k: usize, reg: Reg, program: &mut Program<T>) {
        let Instr { code: what, of: [a, b] } = code[k];
        let op = match what {
            Code::Add => Op::Add,
            Code::Sub => Op::Sub,
            Code::Mul => Op::Mul,
            Code::Div => Op::Div,
            Code::Neg | Code::Abs | Code::Sqrt => {
                match self.part(a) {
                    Some(p) => self.compute(code, p, reg, program),
                    None => {
                        let x = self.operand(a);
                        program.orders.push(Order::Load(reg, x));
                    }
                }
                program.orders.push(match what {
                    Code::Neg => Order::Neg(reg),
                    Code::Abs => Order::Abs(reg),
                    _ => Order::Sqrt(reg),
                });
                return;
            }
            Code::Unary(_) | Code::Binary(_) => unreachable!("functions are no parts"),
        };
        let commutes = matches!(op, Op::Add | Op::Mul);
        match (self.part(a), self.part(b)) {
            (None, None) => {
                let (x, y) = (self.operand(a), self.operand(b));
                match (x, y) {
                    (Operand::Row(x), Operand::Row(y)) => {
                        program.orders.push(Order::Rows(reg, op, x, y));
                    }
                    (Operand::Row(x), Operand::Const(c)) => {
                        program.orders.push(Order::RowConst(reg, op, x, c));
                    }
                    (Operand::Const(c), Operand::Row(x)) if commutes => {
                        program.orders.push(Order::RowConst(reg, op, x, c));
                    }
                    (Operand::Const(c), Operand::Row(x)) => {
                        program.orders.push(Order::ConstRow(reg, op, c, x));
                    }
                    (x, y) => {
                        program.orders.push(Order::Load(reg, x));
                        program.orders.push(Order::By(reg, op, y));
                    }
                }
            }
            (Some(p), None) => {
                self.compute(code, p, reg, program);
                let y = self.operand(b);
                program.orders.push(Order::By(reg, op, y));
            }
            (None, Some(q)) => {
                self.compute(code, q, reg, program);
                let x = self.operand(a);
                program.orders.push(match commutes {
                    true => Order::By(reg, op, x),
                    false => Order::From(reg, op, x),
                });
            }
            (Some(p), Some(q)) => {
                debug_assert_eq!(reg, Reg::A);
                // What needs both registers first.
                let turned = self.nodes[q].registers > self.nodes[p].registers;
                let (first, second) = if turned { (q, p) } else { (p, q) };
                self.compute(code, first, Reg::A, program);
                self.compute(code, second, Reg::B, program);
                join(&mut program.orders, op, turned && !commutes);
            }
        }
    }
}

/// a = a op b, or a = b op a; a product in b that is added or taken away is not computed by itself.
fn join(orders: &mut Vec<Order>, op: Op, turned: bool) {
    let sign = match op {
        Op::Add => Some(Sign::Plus),
        Op::Sub if !turned => Some(Sign::Minus),
        _ => None,
    };
    let last = orders.last().copied();
    let merged = match (sign, last) {
        (Some(sign), Some(Order::Rows(Reg::B, Op::Mul, x, y))) => Order::Product(sign, x, y),
        (Some(sign), Some(Order::RowConst(Reg::B, Op::Mul, x, c))) => {
            Order::ProductConst(sign, x, c)
        }
        (Some(sign), Some(Order::By(Reg::B, Op::Mul, x))) => Order::Times(sign, x),
        _ => {
            orders.push(if turned { Order::JoinFrom(op) } else { Order::Join(op) });
            return;
        }
    };
    orders.pop();
    orders.push(merged);
}
