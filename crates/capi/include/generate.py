"""The header of the C interface, from the functions of ``src/lib.rs``.

``python crates/capi/include/generate.py > crates/capi/include/moldloft.h``
"""

from __future__ import annotations

import re
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "src" / "lib.rs"

TYPES = {
    "u8": "char",
    "u32": "uint32_t",
    "i32": "int32_t",
    "usize": "size_t",
    "f64": "double",
    "mlf_model": "mlf_model",
    "mlf_shape": "mlf_shape",
}

HEAD = """/* The C interface of Moldloft: models in the process of another program.
 *
 * Generated from crates/capi/src/lib.rs by crates/capi/include/generate.py: do not edit.
 *
 * Functions return a code; mlf_v1_message copies the words of the last error of this thread.
 * Texts are UTF-8, pointer and length, without a terminating zero. Arrays are the caller's, and
 * no pointer is kept. A model or shape is used by one thread at a time; freed once.
 */
#ifndef MOLDLOFT_H
#define MOLDLOFT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
"""

TAIL = """
#ifdef __cplusplus
}
#endif

#endif
"""


def c_type(rust: str) -> str:
    """A type of C, ready to stand before a name."""
    stars = ""
    while match := re.match(r"\*(mut|const) ", rust):
        stars = ("*" if match[1] == "mut" else "const *") + stars
        rust = rust[match.end() :]
    base = TYPES[rust]
    if stars.startswith("const "):
        return f"const {base} {stars[len('const ') :]}"
    return f"{base} {stars}"


def comment(lines: list[str]) -> str:
    """Documentation as a comment."""
    text = "\n".join(f" * {line}".rstrip() for line in lines)
    return "/*" + text[2:] + " */" if len(lines) == 1 else f"/*{text[2:]}\n */"


def header() -> str:
    """The whole header."""
    text = SOURCE.read_text(encoding="utf-8")
    out = [HEAD]
    docs: list[str] = []
    lines = iter(text.splitlines())
    for line in lines:
        if line.startswith("/// "):
            docs.append(line[4:])
        elif match := re.match(r"pub const (MLF_\w+): i32 = (\d+);", line):
            out.append(f"{comment(docs)}\n#define {match[1]} {match[2]}\n")
            docs = []
        elif match := re.match(r"pub struct (mlf_\w+)", line):
            out.append(f"{comment(docs)}\ntypedef struct {match[1]} {match[1]};\n")
            docs = []
        elif line.startswith('pub extern "C" fn '):
            while "{" not in line:
                line += " " + next(lines).strip()
            match = re.match(r'pub extern "C" fn (\w+)\((.*?),? ?\)(?: -> (\w+))? \{', line)
            assert match, line
            arguments = []
            for argument in filter(None, match[2].split(", ")):
                name, kind = argument.strip().split(": ")
                before = c_type(kind)
                space = "" if before.endswith(("*", " ")) else " "
                arguments.append(f"{before}{space}{name}")
            result = TYPES[match[3]] if match[3] else "void"
            inner = ", ".join(arguments) or "void"
            out.append(f"{comment(docs)}\n{result} {match[1]}({inner});\n")
            docs = []
        elif line and not line.startswith(("#[", "//")):
            docs = []
    return "\n".join(out) + TAIL


if __name__ == "__main__":
    print(header(), end="")
