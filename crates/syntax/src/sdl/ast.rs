//! The syntax tree: small nodes in tables, referred to by typed ids.

use super::interner::Symbol;
use moldloft_diag::Span;
use std::marker::PhantomData;

/// A number in the text. A sign directly before a number belongs to it (`{-1, 2}`), unless `^`, `.`
/// or `.*` follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Literal {
    /// The value, finite.
    pub value: f64,
    /// True if it is spelled with digits only.
    pub is_int: bool,
    /// Position in the parsed text, sign included.
    pub span: Span,
    /// True if the value was set after parsing.
    pub edited: bool,
    /// True if a negative value must be written in parentheses here (before `^`, `.` and `.*`).
    pub(crate) wrap_negative: bool,
}

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);
    )*};
}

ids! {
    /// A number of the text, see [`Literal`].
    LiteralId;
    /// A quoted text, its escapes resolved.
    TextId;
    /// An expression.
    ExprId;
    /// A statement.
    StmtId;
    /// A subroutine or function.
    RoutineId;
}

/// A run of neighbours in one of the program's tables; `program[list]` is the slice.
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct NodeList<T> {
    pub(crate) start: u32,
    pub(crate) count: u32,
    marker: PhantomData<fn() -> T>,
}

impl<T> Clone for NodeList<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for NodeList<T> {}

impl<T> NodeList<T> {
    pub(crate) fn new(start: usize, count: usize) -> Self {
        NodeList { start: start as u32, count: count as u32, marker: PhantomData }
    }

    /// Number of elements.
    pub fn len(self) -> usize {
        self.count as usize
    }

    /// True if empty.
    pub fn is_empty(self) -> bool {
        self.count == 0
    }
}

/// A name and its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ident {
    /// The name.
    pub symbol: Symbol,
    /// Position.
    pub span: Span,
}

/// An operator between two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BinaryOp {
    /// `+`
    Add,
    /// `-`: difference of numbers, vectors or sets
    Sub,
    /// `*`
    Mul,
    /// `/`
    Div,
    /// `^`: power of numbers, symmetric difference of sets
    Caret,
    /// `.`: dot product
    Dot,
    /// `.*`: cross product
    Cross,
    /// `|` between operands: union of sets
    Union,
    /// `&`: intersection of sets
    Intersection,
    /// `or`, `||`
    Or,
    /// `and`, `&&`
    And,
    /// `<`
    Lt,
    /// `>`
    Gt,
    /// `<=`
    Le,
    /// `>=`
    Ge,
    /// `==`
    Eq,
    /// `!=`
    Ne,
}

impl BinaryOp {
    /// The operator as it is written.
    pub fn spelling(self) -> &'static str {
        match self {
            BinaryOp::Add => "+",
            BinaryOp::Sub => "-",
            BinaryOp::Mul => "*",
            BinaryOp::Div => "/",
            BinaryOp::Caret => "^",
            BinaryOp::Dot => ".",
            BinaryOp::Cross => ".*",
            BinaryOp::Union => "|",
            BinaryOp::Intersection => "&",
            BinaryOp::Or => "or",
            BinaryOp::And => "and",
            BinaryOp::Lt => "<",
            BinaryOp::Gt => ">",
            BinaryOp::Le => "<=",
            BinaryOp::Ge => ">=",
            BinaryOp::Eq => "==",
            BinaryOp::Ne => "!=",
        }
    }
}

/// An operator before its operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum UnaryOp {
    /// `+`
    Plus,
    /// `-`
    Minus,
    /// `not`, `!`
    Not,
}

impl UnaryOp {
    /// The operator as it is written.
    pub fn spelling(self) -> &'static str {
        match self {
            UnaryOp::Plus => "+",
            UnaryOp::Minus => "-",
            UnaryOp::Not => "not",
        }
    }
}

/// A link of a flat operator chain, see [`ExprKind::Chain`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChainItem {
    /// An operand.
    Operand(ExprId),
    /// A sign before the next operand.
    Prefix(UnaryOp, Span),
    /// An operator between operands.
    Infix(BinaryOp, Span),
}

/// An argument of a call or an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arg {
    /// The name in `name = value`.
    pub name: Option<Ident>,
    /// The value.
    pub value: ExprId,
}

/// One subscript.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subscript {
    /// Nothing, or `:` alone: the whole dimension.
    Whole,
    /// `i`: one index, drops the dimension.
    At(ExprId),
    /// `from:to:step`, each part optional.
    Range {
        /// First index.
        from: Option<ExprId>,
        /// Last index, included.
        to: Option<ExprId>,
        /// Step.
        step: Option<ExprId>,
    },
}

/// An expression with its span.
#[derive(Clone, Copy, Debug)]
pub struct Expr {
    /// Kind.
    pub kind: ExprKind,
    /// Position.
    pub span: Span,
}

/// The kinds of expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExprKind {
    /// A number.
    Number(LiteralId),
    /// A quoted text.
    Text(TextId),
    /// A name.
    Name(Symbol),
    /// `(e)`: the same as `e`.
    Paren(ExprId),
    /// `{a, b, …}` of any length, also empty: a vector, a curve or a list, by its elements and its use.
    List(NodeList<ExprId>),
    /// `|e|`
    Magnitude(ExprId),
    /// A sign or `not`.
    Unary {
        /// The operator.
        op: UnaryOp,
        /// Operand.
        operand: ExprId,
    },
    /// Two operands whose grouping is the same whatever their values are.
    Binary {
        /// The operator.
        op: BinaryOp,
        /// Left operand.
        left: ExprId,
        /// Right operand.
        right: ExprId,
    },
    /// A chain with `^` among other operators or signs, whose grouping depends on whether a set takes part:
    /// [`Program::grouped`](super::Program::grouped) gives either order.
    Chain(NodeList<ChainItem>),
    /// `base[subscripts]`
    Index {
        /// Indexed expression.
        base: ExprId,
        /// One to three subscripts, or the values of loop variables in a name made in loops.
        subs: NodeList<Subscript>,
    },
    /// `base.name`
    Member {
        /// Left of the dot.
        base: ExprId,
        /// The member's name, never reserved. It ends where the expression ends.
        name: Symbol,
        /// True if it can also be a dot product of `base` with the variable `name`: for every name
        /// except the components `x y z d1 d2`. A member of `base` takes precedence.
        or_dot: bool,
    },
    /// `callee(args)`
    Call {
        /// Called expression.
        callee: ExprId,
        /// The arguments, positional ones first.
        args: NodeList<Arg>,
    },
    /// Text that could not be understood; reported.
    Error,
}

/// The type in a declaration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Type {
    /// `int`
    Int,
    /// `float`
    Float,
    /// `string`
    String,
    /// `file`
    File,
    /// `vector`
    Vector,
    /// `farray`
    Farray,
    /// `curve`
    Curve,
    /// `surface`
    Surface,
    /// `pcurve`
    Pcurve,
    /// `psurface`
    Psurface,
    /// `field`
    Field,
    /// `set`
    Set,
    /// `block`
    Block,
    /// `function` or `subroutine` before an argument: a routine is passed.
    Routine,
    /// `T name[]`: a list of values of a type.
    List(ItemType),
    /// A record, of the type that its value states.
    Record,
    /// Any other word: a class of objects, or a misspelled type.
    Other(Symbol),
}

/// The types whose values form declared lists: those that are no rows of numbers or points already.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ItemType {
    /// Rows of points.
    Curve,
    /// Grids of points.
    Surface,
    /// Grids of three dimensions.
    Block,
    /// Rows of numbers.
    Farray,
    /// Parametric curves.
    Pcurve,
    /// Parametric surfaces.
    Psurface,
    /// Implicit functions.
    Field,
    /// Sets of points.
    Set,
    /// Texts.
    String,
    /// Records of the type of this name.
    Other(Symbol),
    /// Records.
    Record,
}

impl ItemType {
    /// The type of an item.
    pub fn ty(self) -> Type {
        match self {
            ItemType::Curve => Type::Curve,
            ItemType::Surface => Type::Surface,
            ItemType::Block => Type::Block,
            ItemType::Farray => Type::Farray,
            ItemType::Pcurve => Type::Pcurve,
            ItemType::Psurface => Type::Psurface,
            ItemType::Field => Type::Field,
            ItemType::Set => Type::Set,
            ItemType::String => Type::String,
            ItemType::Other(symbol) => Type::Other(symbol),
            ItemType::Record => Type::Record,
        }
    }
}

impl Type {
    /// The type of lists of such values; `None` for numbers and vectors, whose rows are an farray and a curve.
    pub fn list(self) -> Option<Type> {
        Some(Type::List(match self {
            Type::Curve => ItemType::Curve,
            Type::Surface => ItemType::Surface,
            Type::Block => ItemType::Block,
            Type::Farray => ItemType::Farray,
            Type::Pcurve => ItemType::Pcurve,
            Type::Psurface => ItemType::Psurface,
            Type::Field => ItemType::Field,
            Type::Set => ItemType::Set,
            Type::String => ItemType::String,
            Type::Other(symbol) => ItemType::Other(symbol),
            Type::Record => ItemType::Record,
            Type::Int | Type::Float | Type::File | Type::Vector | Type::Routine | Type::List(_) => {
                return None;
            }
        }))
    }

    /// The ten types of the 1992 language, in the order of their reserved words.
    pub(crate) const CLASSIC: [Type; 10] = [
        Type::Int,
        Type::Float,
        Type::String,
        Type::File,
        Type::Vector,
        Type::Farray,
        Type::Curve,
        Type::Surface,
        Type::Pcurve,
        Type::Psurface,
    ];
}

/// The length of a declared list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListLength {
    /// `name[]`: that of the values assigned to it.
    Open,
    /// `name[n][]`, `name[n][l, m]`.
    Of(ExprId),
}

/// One variable of a declaration: `name[m, n] = value`, or a list: `name[] = value`, `name[k][m, n]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Declarator {
    /// The variable.
    pub name: Ident,
    /// The length of the list that it is, when its brackets say that it is one.
    pub list: Option<ListLength>,
    /// Its dimensions, none to three; for a list those of its items.
    pub dims: NodeList<ExprId>,
    /// Its first value.
    pub value: Option<ExprId>,
}

/// Operator of an assignment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AssignOp {
    /// `=`
    Set,
    /// `+=` and its like.
    With(BinaryOp),
}

/// A statement with its span.
#[derive(Clone, Copy, Debug)]
pub struct Stmt {
    /// Kind.
    pub kind: StmtKind,
    /// Position, the `;` included.
    pub span: Span,
}

/// The kinds of statements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StmtKind {
    /// `{ … }`; also the empty statement.
    Block(NodeList<StmtId>),
    /// `load "path";`
    Load(TextId),
    /// A subroutine or function.
    Routine(RoutineId),
    /// `record name { declarations }`
    Record {
        /// The name of the type.
        name: Ident,
        /// The declarations of its members, with their first values.
        members: NodeList<StmtId>,
    },
    /// `[global] type name…;`
    Declare {
        /// True after `global`.
        global: bool,
        /// The type and its position.
        ty: (Type, Span),
        /// The variables.
        items: NodeList<Declarator>,
    },
    /// `param [type] name = value [in [low, high]];`
    Param {
        /// The type, by default `float`.
        ty: Option<(Type, Span)>,
        /// Its name.
        name: Ident,
        /// Its default value.
        value: ExprId,
        /// Its range.
        range: Option<(ExprId, ExprId)>,
    },
    /// `Kind name(args);`, an object or a named subroutine call.
    Object {
        /// The entity kind or subroutine.
        kind: Ident,
        /// The new object's name.
        name: Ident,
        /// The arguments.
        args: NodeList<Arg>,
    },
    /// `target = value;` and its like. The target is a name with subscripts and members.
    Assign {
        /// Target.
        target: ExprId,
        /// Operator.
        op: AssignOp,
        /// Value.
        value: ExprId,
    },
    /// A call for its effect.
    Call(ExprId),
    /// `if (condition) then else otherwise`
    If {
        /// The condition.
        condition: ExprId,
        /// Done if it holds.
        then: StmtId,
        /// Done if not.
        otherwise: Option<StmtId>,
    },
    /// `while (condition) body`
    While {
        /// The condition.
        condition: ExprId,
        /// The body.
        body: StmtId,
    },
    /// `for (variable = from:to:step) body`, both ends included.
    ForRange {
        /// The loop variable.
        variable: Ident,
        /// First value.
        from: ExprId,
        /// Last value.
        to: ExprId,
        /// Step, 1 if not written.
        step: Option<ExprId>,
        /// The body.
        body: StmtId,
    },
    /// `for (start; condition; step) body`
    For {
        /// Done once before.
        start: Option<StmtId>,
        /// Asked before each turn; holds if not written.
        condition: Option<ExprId>,
        /// Done after each turn.
        step: Option<StmtId>,
        /// The body.
        body: StmtId,
    },
    /// `foreach (variable in list) body`
    Foreach {
        /// The loop variable.
        variable: Ident,
        /// Sequence of the loop.
        list: ExprId,
        /// The body.
        body: StmtId,
    },
    /// `print values;`
    Print(NodeList<ExprId>),
    /// `assert condition, message;`
    Assert {
        /// Condition.
        condition: ExprId,
        /// Message if it does not hold.
        message: Option<ExprId>,
    },
    /// `break;`
    Break,
    /// `continue;`
    Continue,
    /// `return value;`
    Return(Option<ExprId>),
    /// Text that could not be understood; reported.
    Error,
}

/// A formal argument: `[returned] type name[[]] [= value] [...]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Formal {
    /// True if it is passed by reference.
    pub returned: bool,
    /// Its type and position.
    pub ty: (Type, Span),
    /// Its name.
    pub name: Ident,
    /// True if it takes all remaining arguments.
    pub multiple: bool,
    /// Its default value.
    pub default: Option<ExprId>,
}

/// A subroutine, or a function with a result type.
#[derive(Clone, Copy, Debug)]
pub struct Routine {
    /// Result type of a function; `None` for a subroutine.
    pub result: Option<(Type, Span)>,
    /// Its name.
    pub name: Ident,
    /// Its arguments.
    pub formals: NodeList<Formal>,
    /// Its statements.
    pub body: NodeList<StmtId>,
    /// The span from its first word to its closing brace.
    pub span: Span,
}
