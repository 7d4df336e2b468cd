//! Statements that read like the declaration of an object and insert the contents of a file: one row each.

/// A statement that inserts a file under a name.
#[derive(Clone, Copy, Debug)]
pub struct InsertedFile {
    /// The word it begins with.
    pub name: &'static str,
    /// Syntax.
    pub signature: &'static str,
    /// Description; the first line is a summary.
    pub doc: &'static str,
    /// Its arguments, each with a line of help.
    pub arguments: &'static [(&'static str, &'static str)],
    /// An example; after a line `# name.suffix` a file of that name follows.
    pub example: &'static str,
    pub(crate) content: Content,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    Component,
    Sketch,
}

/// All such statements, in the order of the reference.
pub const INSERTED_FILES: [InsertedFile; 2] = [
    InsertedFile {
        name: "Component",
        signature: "Component name(\"file\", parent = object, parameter = value, ...)",
        doc: "\
A file of objects inserted under a name, on parents of the model's own.

The arguments replace the file's own declarations of these names: its points and curves, its `param`s.
Parents needed by those alone are not made. The file sees no other name of the model, and runs by itself
as well, on its own parents. Its objects are `name.tip`, its parameters `name.span`: design parameters
of the model.",
        arguments: &[
            ("file", "the file, relative to the one that inserts it"),
            ("parent", "an object of the model in place of one of the file's"),
            ("parameter", "a value in place of one of the file's parameters or variables"),
        ],
        example: "\
# keel.sdl
param float span = 2 in [0.5, 4];
AbsPoint K1(0, 0, 0); AbsPoint K2(1, 0, 0); Line root(K1, K2, visible = 0);
AbsBead fore(root, 0.25); RelPoint tip(fore, 0, 0, -span);
# boat.sdl
AbsPoint A(0, 0, 1); AbsPoint B(8, 0, 1); Line hull(A, B);
Component keel(\"keel.sdl\", root = hull, span = 3);
RelPoint bulb(keel.tip, 0, 0, -0.5);",
        content: Content::Component,
    },
    InsertedFile {
        name: "Sketch",
        signature: "Sketch name(\"file.skt\", DIMENSION = value, ...)",
        doc: "\
The solid of a sketch under a name, with other values for its dimensions.

Its dimensions and variables are members: `name.CREST`. Its faces are surfaces of the model and its body a
solid: `name.body`. The same file may be inserted several times, each time with values of its own.",
        arguments: &[
            ("file", "the sketch, relative to the file that inserts it"),
            ("DIMENSION", "a value in place of one of the sketch's named dimensions or variables"),
        ],
        example: "\
Sketch low(\"dam.skt\", CREST = 20);
Sketch high(\"dam.skt\", CREST = 32);
print(high.body.volume - low.body.volume);",
        content: Content::Sketch,
    },
];

/// The statement that begins with `word`.
pub(crate) fn inserted_file(word: &str) -> Option<&'static InsertedFile> {
    INSERTED_FILES.iter().find(|row| row.name == word)
}
