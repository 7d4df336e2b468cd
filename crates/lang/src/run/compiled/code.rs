//! Code of a region: operations on registers, and their source positions.

use crate::functions::elementary::Elementary;
use crate::functions::format::FormatPattern;
use crate::source::module::{Module, Name, RoutineAt};
use moldloft_diag::Span;
use moldloft_elementwise::{Src, Tape};
use moldloft_num::Real;
use moldloft_syntax::sdl::{ExprId, StmtId, Symbol, Type};
use smallvec::SmallVec;
use std::sync::Arc;

/// Order relation of a condition: the set of the orders of two values for which it holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Relation {
    Lt = 1,
    Gt = 2,
    Eq = 4,
    Le = 5,
    Ge = 6,
    /// Also of values without an order.
    Ne = 11,
}

impl Relation {
    /// Compares without a branch.
    #[inline(always)]
    pub fn holds<V: PartialOrd>(self, a: V, b: V) -> bool {
        let (less, greater, equal) = (u8::from(a < b), u8::from(a > b), u8::from(a == b));
        let none = 1 - (less | greater | equal);
        self as u8 & (less | greater << 1 | equal << 2 | none << 3) != 0
    }
}

/// Mark of a variable without a declaration.
pub(super) const UNDECLARED: u32 = 0;

/// The marks that a call copies in one piece.
pub(super) const FEW: usize = 4;

/// Set in the number of an array: it is one of the file's, not of the call's.
pub(super) const OF_FILE: u16 = 1 << 15;

/// An operation. Registers are counted from the first of the current call, positions in the code
/// from the first of its unit.
#[derive(Clone, Copy, Debug)]
pub(super) enum ScalarOp {
    /// A statement begins; it is counted and noted as executed.
    Step(u16),
    /// A statement begins, and the next operation does it for the statement that follows.
    Steps(u16),
    /// `if`, as the next two operations do it: a condition, and a statement that follows if it holds.
    Branch {
        statement: u16,
        relation: Relation,
        a: u16,
        b: u16,
        to: u16,
    },
    Copy {
        to: u16,
        a: u16,
    },
    /// Three registers.
    CopyVector {
        to: u16,
        a: u16,
    },
    Add {
        to: u16,
        a: u16,
        b: u16,
    },
    /// `to = a + b` and, as the next operation would do it, its conversion to an integer.
    AddThenWhole {
        to: u16,
        a: u16,
        b: u16,
        whole: u16,
    },
    Sub {
        to: u16,
        a: u16,
        b: u16,
    },
    Mul {
        to: u16,
        a: u16,
        b: u16,
    },
    /// `to = a*b` and, as the next operation would do it, `sum = to + c`.
    MulThenAdd {
        to: u16,
        a: u16,
        b: u16,
        sum: u16,
        c: u16,
    },
    Div {
        to: u16,
        a: u16,
        b: u16,
    },
    Power {
        to: u16,
        a: u16,
        b: u16,
    },
    Square {
        to: u16,
        a: u16,
    },
    /// A power with a literal integer exponent.
    PowerWhole {
        to: u16,
        a: u16,
        k: i16,
    },
    Negate {
        to: u16,
        a: u16,
    },
    Magnitude {
        to: u16,
        a: u16,
    },
    Not {
        to: u16,
        a: u16,
    },
    Compare {
        relation: Relation,
        to: u16,
        a: u16,
        b: u16,
    },
    /// A function of one number; the result must be finite.
    Apply {
        to: u16,
        a: u16,
        f: u16,
    },
    Apply2 {
        to: u16,
        a: u16,
        b: u16,
        f: u16,
    },
    /// `mod`, small whole numbers first.
    Remainder {
        to: u16,
        a: u16,
        b: u16,
        f: u16,
    },
    /// `Apply2` without a look at the result.
    Combine {
        to: u16,
        a: u16,
        b: u16,
        f: u16,
    },
    /// The result of several `Combine` must be finite.
    Finite {
        a: u16,
    },
    Jump {
        to: u16,
    },
    JumpUnless {
        a: u16,
        to: u16,
    },
    JumpIfNot {
        relation: Relation,
        a: u16,
        b: u16,
        to: u16,
    },
    /// An element of a row, or of a grid when there is a second subscript.
    Load {
        to: u16,
        array: u16,
        i: u16,
        j: u16,
    },
    Store {
        array: u16,
        i: u16,
        j: u16,
        a: u16,
    },
    /// A vector, three registers from `to`, of a curve or a surface.
    LoadVector {
        to: u16,
        array: u16,
        i: u16,
        j: u16,
    },
    StoreVector {
        array: u16,
        i: u16,
        j: u16,
        a: u16,
    },
    /// One component of an element.
    StorePart {
        array: u16,
        i: u16,
        j: u16,
        a: u16,
        part: u8,
    },
    /// `a.d1`, `a.d2`.
    Extent {
        to: u16,
        array: u16,
        k: u16,
    },
    /// Conversion to an integer; a fault for values that an int cannot represent.
    Whole {
        to: u16,
        a: u16,
    },
    /// Assignment to a variable whose type depends on the executed path.
    Assign {
        variable: u16,
        to: u16,
        a: u16,
    },
    /// The variable must have been declared, and rightly.
    Live {
        variable: u16,
    },
    LiveArray {
        array: u16,
    },
    /// The array must have a value.
    HasValue {
        array: u16,
    },
    Declare {
        variable: u16,
        origin: u16,
    },
    /// `farray a[m]`, `farray a[m,n]`, a curve or a surface; no second register for a row.
    DeclareArray {
        array: u16,
        m: u16,
        n: u16,
        origin: u16,
    },
    CopyText {
        to: u16,
        a: u16,
    },
    /// The two change places.
    MoveText {
        to: u16,
        a: u16,
    },
    JoinTexts {
        to: u16,
        a: u16,
        b: u16,
    },
    CompareTexts {
        relation: Relation,
        to: u16,
        a: u16,
        b: u16,
    },
    FormatText {
        to: u16,
        format: u16,
    },
    /// A text has got its first value.
    DeclareText {
        array: u16,
        origin: u16,
    },
    /// A variable of the file, read and written by a routine.
    LoadFile {
        to: u16,
        of_file: u16,
    },
    StoreFile {
        of_file: u16,
        a: u16,
    },
    WholeFile {
        of_file: u16,
        a: u16,
    },
    AssignFile {
        variable: u16,
        of_file: u16,
        a: u16,
    },
    LiveFile {
        variable: u16,
    },
    /// From, to, step in the registers from `at`: then the number of iterations replaces `to`.
    ForBegin {
        at: u16,
    },
    /// The condition of a `while`, and its turn: that of the next two operations.
    WhileTest {
        relation: Relation,
        a: u16,
        b: u16,
        exit: u16,
    },
    WhileNext {
        test: u16,
    },
    /// The number of the iteration is kept if it may be read.
    ForTest {
        at: u16,
        variable: u16,
        register: u16,
        origin: u16,
        exit: u16,
        kept: bool,
    },
    ForNext {
        at: u16,
        test: u16,
    },
    /// A `foreach` begins: it walks through the elements that the array has now, which stay in an array of its own.
    WalkBegin {
        array: u16,
        from: u16,
    },
    /// The numbers of the turn are put into the registers from `at`, unless it is `NO_LABEL`.
    WalkTest {
        at: u16,
        array: u16,
        variable: u16,
        register: u16,
        origin: u16,
        exit: u16,
    },
    WalkNext {
        test: u16,
    },
    WalkEnd {
        array: u16,
    },
    /// Number for names of the iteration, if the variable may have none.
    Label {
        at: u16,
        variable: u16,
    },
    /// A turn of another loop begins; its numbers are kept unless `at` is `NO_LABEL`, and `label` is
    /// the register of its name's number, or `NO_LABEL`.
    Turn {
        at: u16,
        label: u16,
    },
    Call {
        to: u16,
        site: u16,
    },
    /// Inlined call.
    Called,
    Return {
        a: u16,
    },
    ReturnVector {
        a: u16,
    },
    /// `return;`, or the end of a routine.
    Leave,
    End,
    /// A statement that the interpreter executes.
    Interpret {
        site: u16,
    },
    /// A condition that the interpreter evaluates.
    Condition {
        to: u16,
        site: u16,
    },
    /// An element-wise statement.
    Kernel {
        kernel: u16,
    },
}

/// For turns without a number, and for a subscript or a dimension that is not there.
pub(super) const NO_LABEL: u16 = u16::MAX;

#[derive(Clone, Debug)]
pub(super) struct CodeVariable {
    pub name: Name,
    /// Its register, that of the first component of a vector.
    pub register: u16,
    /// The type; `None` for a number whose type depends on the executed path.
    pub ty: Option<Type>,
    /// Binding at the start of the region.
    pub captured: Option<Captured>,
    /// True when statements of the region declare it.
    pub declared: bool,
}

/// Binding of a name at compilation, which is required at entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Captured {
    /// A number or a vector.
    Variable(Type),
    Param(usize),
    Array(Type),
    /// A variable of the file that was passed by reference.
    OfFile(Name),
    /// A variable of another call that was passed by reference.
    Passed(Type),
    PassedArray(Type),
    Nothing,
}

/// An array of numbers or vectors of a unit, or a text.
#[derive(Clone, Debug)]
pub(super) struct CodeArray {
    /// `None` for the sequence of a `foreach`, and for a text until the end of its statement.
    pub name: Option<Name>,
    /// An farray, a curve, a surface or a string.
    pub ty: Type,
    pub captured: bool,
    pub declared: bool,
    /// A text that is written in the program.
    pub text: Option<Arc<str>>,
}

/// An active loop: the register of its number, followed by that of its iteration.
#[derive(Clone, Copy, Debug)]
pub(super) struct ActiveLoop {
    pub at: u16,
    pub labelled: bool,
}

/// A call, or an operation of the interpreter.
#[derive(Clone, Debug)]
pub(super) struct CodeSite {
    pub stmt: StmtId,
    pub expr: ExprId,
    pub span: Span,
    pub loops: Box<[ActiveLoop]>,
    /// For a call: the unit, the arguments, whether a value is needed.
    pub unit: usize,
    pub args: Box<[CodeArgument]>,
    pub valued: bool,
    pub moves: CallMoves,
}

/// What a call puts into the registers of the called unit.
#[derive(Clone, Debug, Default)]
pub(super) struct CallMoves {
    /// From which register to which.
    pub numbers: Box<[(u16, u16)]>,
    /// From which array to which, and the number of the formal argument.
    pub arrays: Box<[(u16, u16, u16)]>,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum CodeArgument {
    Number {
        from: u16,
    },
    Vector {
        from: u16,
    },
    Array {
        from: u16,
    },
    /// A variable of the file, by reference: the routine's code knows it.
    OfFile,
}

/// A call of `format`: its pattern, if that is a literal, or the register of it.
#[derive(Debug)]
pub(super) struct CodeFormat {
    pub literal: Option<FormatPattern>,
    pub pattern: u16,
    pub args: Box<[CodeArgument]>,
}

/// Source of a fault at a position of the code.
#[derive(Clone, Copy, Debug)]
pub(super) enum CodeNote {
    /// The result is not finite.
    Finite(&'static str, Span),
    /// The interpreter evaluates the expression, which gives the error.
    Expression(ExprId),
    /// The interpreter evaluates the target of an assignment, which gives the error.
    Target(ExprId),
    /// The interpreter executes the assignment, which may be no fault.
    Assignment(StmtId),
    /// An int does not hold the value.
    Convert(Span),
    /// The interpreter declares the variable of the statement, which gives the error.
    Declaration(StmtId, u32),
    /// The argument does not fit the parameter.
    Argument(Span, Span),
    /// The name may mean nothing here.
    Name(Symbol, Span),
}

/// The code of a statement, or of one variable of a declaration.
#[derive(Clone, Copy, Debug)]
pub(super) struct CodeRange {
    pub start: u16,
    pub end: u16,
    pub span: Span,
    /// Position of faults without their own.
    pub fault: Span,
    /// The variable or array that is poisoned by a fault, and its declaration.
    pub poison: Option<(Poisonable, u16)>,
}

/// Variables that a failed declaration leaves undefined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Poisonable {
    Variable(u16),
    Array(u16),
}

/// Subscript of a section, by the registers of its numbers.
#[derive(Clone, Copy, Debug)]
pub(super) enum CodeSubscript {
    Whole,
    At(u16),
    /// From, to, step.
    Range([Option<u16>; 3]),
}

/// An array, or a section of it.
#[derive(Clone, Debug)]
pub(super) struct CodeSection {
    pub array: u16,
    pub subscripts: Option<Box<[CodeSubscript]>>,
}

/// The array that a statement writes to.
#[derive(Clone, Debug)]
pub(super) enum KernelTarget {
    /// All of it, or one component of its vectors.
    Section(CodeSection, Option<u8>),
    /// It is declared with the value's shape.
    Declared { array: u16, origin: u16 },
}

/// An element-wise statement.
pub(super) struct ArrayKernel<T: Real> {
    pub tape: Tape<T>,
    pub leaves: Vec<CodeSection>,
    /// The leaf of each source, and the component of its vectors.
    pub planes: Vec<(u16, u8)>,
    /// Constants, and the registers that they are read from.
    pub inputs: Vec<(u16, u16)>,
    pub roots: SmallVec<[Src; 3]>,
    /// Expressions whose values count as steps.
    pub charges: Vec<Span>,
    pub target: KernelTarget,
}

/// The code of a loop, of a routine, or nothing but the variables of the file.
pub(super) struct CodeUnit<T: Real> {
    pub module: usize,
    pub m: Arc<Module>,
    pub routine: Option<RoutineAt>,
    pub code: Vec<ScalarOp>,
    pub variables: Vec<CodeVariable>,
    pub arrays: Vec<CodeArray>,
    /// The formal arguments: variables and arrays; `None` for those passed by reference.
    pub formals: Vec<Option<Poisonable>>,
    /// The formal arguments that are variables of the file: their names, declarations, and whose they are.
    pub references: Vec<(Name, Span, Name)>,
    /// The number of registers of a call.
    pub registers: usize,
    /// Registers with a value at the start of a call.
    pub constants: Vec<(u16, T)>,
    pub sites: Vec<CodeSite>,
    pub formats: Vec<CodeFormat>,
    pub kernels: Vec<ArrayKernel<T>>,
    pub notes: Vec<(u16, CodeNote)>,
    pub ranges: Vec<CodeRange>,
    /// Code of subscripts and dimensions, with the expression to evaluate again after a fault in
    /// it: the interpreter determines the first of several faults.
    pub inner: Vec<(u16, u16, CodeNote)>,
    /// Positions of declarations, with types.
    pub origins: Vec<(Span, Type)>,
    /// Declarations of arrays that take any shape.
    pub unfixed: Vec<u16>,
    /// The statements, each with its module: a unit may contain inlined code of other routines.
    pub statements: Vec<(usize, StmtId)>,
    /// The marks of the variables when a call begins.
    pub marks: Vec<u32>,
    /// The first of them.
    pub few_marks: [u32; FEW],
    /// The type of the value that the routine returns.
    pub result: Option<Type>,
}

impl<T: Real> CodeUnit<T> {
    pub fn new(module: usize, m: Arc<Module>, routine: Option<RoutineAt>) -> Self {
        let result = routine.and_then(|at| m.program[at.routine].result).map(|(ty, _)| ty);
        Self {
            module,
            m,
            result,
            routine,
            code: Vec::new(),
            variables: Vec::new(),
            arrays: Vec::new(),
            formals: Vec::new(),
            references: Vec::new(),
            registers: 0,
            constants: Vec::new(),
            sites: Vec::new(),
            formats: Vec::new(),
            kernels: Vec::new(),
            notes: Vec::new(),
            ranges: Vec::new(),
            inner: Vec::new(),
            origins: Vec::new(),
            unfixed: Vec::new(),
            statements: Vec::new(),
            marks: Vec::new(),
            few_marks: [UNDECLARED; FEW],
        }
    }

    /// The innermost statement at a position of the code.
    pub fn range(&self, at: usize) -> CodeRange {
        let holds = |range: &&CodeRange| (range.start as usize..range.end as usize).contains(&at);
        let inner = self.ranges.iter().filter(holds).min_by_key(|range| range.end - range.start);
        *inner.expect("all code belongs to a statement")
    }

    /// The variable that a failed declaration at a position leaves undefined.
    pub fn poison(&self, at: usize) -> Option<(Poisonable, u16)> {
        let holds = |range: &&CodeRange| (range.start as usize..range.end as usize).contains(&at);
        self.ranges.iter().filter(holds).find_map(|range| range.poison)
    }

    /// Source of a fault at a position.
    pub fn note(&self, at: usize) -> Option<CodeNote> {
        let holds = |(start, end, _): &&(u16, u16, CodeNote)| {
            (*start as usize..*end as usize).contains(&at)
        };
        let outer = self.inner.iter().filter(holds).max_by_key(|(start, end, _)| end - start);
        outer.map(|(.., note)| *note).or_else(|| {
            self.notes.iter().find(|(place, _)| *place as usize == at).map(|(_, note)| *note)
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum RegionStart {
    Loop(StmtId),
    Body(u32),
}

/// The code of a loop or a routine's body and of all routines that it calls.
pub(super) struct CodeRegion<T: Real> {
    /// The first holds the variables of the file.
    pub units: Vec<CodeUnit<T>>,
    /// The unit that is executed: the first itself at file level, else the second.
    pub entry: usize,
    /// Names with their required bindings: in the innermost frame, or in the file.
    pub guards: Vec<(Name, NamePlace, Captured)>,
    pub functions: Vec<(&'static str, Elementary<T>)>,
    /// Loaded modules at compilation.
    pub generation: Generation,
}

/// Scope in which a name is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NamePlace {
    Frame,
    File,
}

/// Numbers of modules run, routines known, and active components.
pub(super) type Generation = (usize, usize, usize);
