//! Tokens of SDL.

use super::interner::{Interner, Symbol};

/// Kind of a token. Contextual keywords (`param`, `in`, `assert`, `field`, `set`, `block`,
/// `record`) are `Ident`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    // Words: `Ident`, then the reserved ones in the order of `RESERVED`.
    Ident,
    TypeWord,
    Load,
    If,
    Then,
    Else,
    While,
    For,
    Foreach,
    Break,
    Continue,
    Return,
    Subroutine,
    Function,
    Returned,
    Global,
    And,
    Or,
    Not,
    Print,
    Number,
    Text,
    LParen,
    RParen,
    LBracket,
    RBracket,
    LBrace,
    RBrace,
    Comma,
    Semi,
    Colon,
    Ellipsis,
    /// A dot with a name glued to it, itself glued to an operand's end.
    MemberDot,
    /// Any other dot.
    Dot,
    Cross,
    Plus,
    Minus,
    Star,
    Slash,
    Caret,
    Amp,
    AmpAmp,
    Pipe,
    Bang,
    Assign,
    PlusAssign,
    MinusAssign,
    StarAssign,
    SlashAssign,
    CaretAssign,
    EqEq,
    NotEq,
    Lt,
    Gt,
    Le,
    Ge,
    /// Characters that mean nothing; already reported.
    Bad,
    End,
}

use Kind::*;

/// The reserved words. Their symbols are 0, 1, 2, … in every program.
pub(crate) const RESERVED: [(&str, Kind); 28] = [
    ("int", TypeWord),
    ("float", TypeWord),
    ("string", TypeWord),
    ("file", TypeWord),
    ("vector", TypeWord),
    ("farray", TypeWord),
    ("curve", TypeWord),
    ("surface", TypeWord),
    ("pcurve", TypeWord),
    ("psurface", TypeWord),
    ("load", Load),
    ("if", If),
    ("then", Then),
    ("else", Else),
    ("while", While),
    ("for", For),
    ("foreach", Foreach),
    ("break", Break),
    ("continue", Continue),
    ("return", Return),
    ("subroutine", Subroutine),
    ("function", Function),
    ("returned", Returned),
    ("global", Global),
    ("and", And),
    ("or", Or),
    ("not", Not),
    ("print", Print),
];

/// Contextual keywords; their symbols follow those of [`RESERVED`].
const CONTEXTUAL: [&str; 12] =
    ["param", "in", "assert", "field", "set", "block", "record", "x", "y", "z", "d1", "d2"];

/// The words of the language: reserved ones, and contextual keywords of statements.
pub fn keywords() -> impl Iterator<Item = &'static str> {
    let components = CONTEXTUAL.len() - 5;
    RESERVED.iter().map(|(word, _)| *word).chain(CONTEXTUAL[..components].iter().copied())
}

/// The words that can begin a declaration.
pub fn declaring_words() -> impl Iterator<Item = &'static str> {
    let types = RESERVED.iter().filter(|(_, kind)| *kind == TypeWord).map(|(word, _)| *word);
    types.chain(["param", "field", "set", "block", "record"])
}

/// True for a contextual keyword.
pub fn is_contextual(word: &str) -> bool {
    CONTEXTUAL[..CONTEXTUAL.len() - 5].contains(&word)
}

pub(crate) const PARAM: Symbol = Symbol(28);
pub(crate) const IN: Symbol = Symbol(29);
pub(crate) const ASSERT: Symbol = Symbol(30);
pub(crate) const FIELD: Symbol = Symbol(31);
pub(crate) const SET: Symbol = Symbol(32);
pub(crate) const BLOCK: Symbol = Symbol(33);
pub(crate) const RECORD: Symbol = Symbol(34);

/// True for one of the component suffixes `x y z d1 d2`.
pub(crate) fn is_component(symbol: Symbol) -> bool {
    (35..=39).contains(&symbol.0)
}

/// An interner that knows the words above.
pub(crate) fn interner() -> Interner {
    let mut interner = Interner::new();
    for (word, _) in RESERVED {
        interner.intern(word);
    }
    for word in CONTEXTUAL {
        interner.intern(word);
    }
    interner
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Token {
    pub kind: Kind,
    /// True if there is a line end between the previous token and this one.
    pub new_line: bool,
    pub start: u32,
    pub end: u32,
    /// The symbol of a word, the literal of a number, the text of a string.
    pub payload: u32,
}

impl Token {
    pub(crate) fn is_word(self) -> bool {
        (self.kind as u8) <= Print as u8
    }

    pub(crate) fn symbol(self) -> Symbol {
        Symbol(self.payload)
    }

    pub(crate) fn is_ident(self, symbol: Symbol) -> bool {
        self.kind == Ident && self.payload == symbol.0
    }
}

/// A comment from `#` to the end of its line, without the line end and blanks before it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Comment {
    pub start: u32,
    pub end: u32,
    /// Index of the token that follows.
    pub before: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_of_words_are_fixed() {
        let words = interner();
        for (at, (word, _)) in RESERVED.iter().enumerate() {
            assert_eq!(words.find(word), Some(Symbol(at as u32)));
        }
        let fixed = [
            ("param", PARAM),
            ("in", IN),
            ("assert", ASSERT),
            ("field", FIELD),
            ("set", SET),
            ("block", BLOCK),
            ("record", RECORD),
        ];
        for (word, symbol) in fixed {
            assert_eq!(words.find(word), Some(symbol));
        }
        assert!(
            ["x", "y", "z", "d1", "d2"].iter().all(|word| is_component(words.find(word).unwrap()))
        );
    }
}
