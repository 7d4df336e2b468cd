"""What the site needs besides the pages: sources that pages link to, and the list of changes.

Links that leave `docs` are those to sources; the files are put into the site, so that it is whole
when it is opened from a folder.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar

from pygments.lexer import RegexLexer, bygroups
from pygments.lexers import LEXERS
from pygments.token import Comment, Keyword, Name, Number, Operator, String, Text

ROOT = Path(__file__).resolve().parents[1]

#: What the editor's highlighting calls the words of the language, and what they are in the site.
_GRAMMAR = ROOT / "editors" / "vscode" / "syntaxes" / "sdl.tmLanguage.json"
_CLASSES = {
    "keyword.control.sdl": Keyword,
    "keyword.operator.word.sdl": Operator.Word,
    "storage.modifier.sdl": Keyword.Declaration,
    "storage.type.sdl": Keyword.Type,
    "constant.language.sdl": Name.Constant,
}


def _words() -> list[tuple[str, Any]]:
    grammar = json.loads(_GRAMMAR.read_text(encoding="utf-8"))
    rows = grammar["repository"]["word"]["patterns"]
    return [(row["match"], _CLASSES[row["name"]]) for row in rows]


class SdlLexer(RegexLexer):
    """Highlighting of programs in the pages, with the words of the editor's."""

    name = "Moldloft SDL"
    aliases = ("sdl",)
    filenames = ("*.sdl",)
    mimetypes = ()
    tokens: ClassVar[dict[str, Any]] = {
        "root": [
            (r"#[^\n]*", Comment.Single),
            (r'"(?:\\.|[^"\\\n])*"?', String),
            (r"(?<![\w\])}|])(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?", Number),
            (
                r"\b([A-Z]\w*)(\s+)([A-Za-z_]\w*)(?=\s*\()",
                bygroups(Name.Class, Text, Name.Variable),
            ),
            *_words(),
            (r"[A-Za-z_]\w*(?=\s*\()", Name.Function),
            (r"\w+", Name),
            (r"[-+*/^%=<>!&|]+", Operator),
            (r"\s+|.", Text),
        ]
    }


def on_config(config: Any) -> Any:
    """Makes the lexer known: Pygments finds lexers by the modules that they are in."""
    place = ModuleType("moldloft_site_lexer")
    place.SdlLexer = SdlLexer  # type: ignore[attr-defined]
    place.__all__ = ["SdlLexer"]  # type: ignore[attr-defined]
    sys.modules[place.__name__] = place
    LEXERS["SdlLexer"] = (place.__name__, SdlLexer.name, ("sdl",), ("*.sdl",), ())
    return config


#: `make site` sets it: all examples stand in the site as pages that one can turn and change.
LIVING = bool(os.environ.get("MOLDLOFT_LIVING"))

_LINK = re.compile(r"\]\(((?:\.\./)+[^)#\s]+)(#[^)]*)?\)")


def _target(page: str, link: str) -> str | None:
    """The path in the repository that a page of the site links to, if that is outside `docs`."""
    path = (ROOT / "docs" / page).parent.joinpath(link).resolve()
    if not path.is_relative_to(ROOT) or path.is_relative_to(ROOT / "docs"):
        return None
    return path.relative_to(ROOT).as_posix()


def on_files(files: Any, config: Any) -> Any:
    """Adds the linked sources and the changes to the site."""
    from mkdocs.structure.files import File

    linked = set()
    for file in files.documentation_pages():
        for link, _ in _LINK.findall(file.content_string):
            target = _target(file.src_uri, link)
            if target and (ROOT / target).is_file():
                linked.add(target)
    for target in sorted(linked):
        text = (ROOT / target).read_text(encoding="utf-8")
        files.append(File.generated(config, f"source/{target}.txt", content=text))
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    files.append(File.generated(config, "changes.md", content=changes))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Turns links to sources into links to their copies in the site."""
    here = page.file.src_uri
    up = "../" * here.count("/")

    def moved(found: re.Match[str]) -> str:
        target = _target(here, found[1])
        if target is None:
            return found[0]
        if target == "CHANGELOG.md":
            return f"]({up}changes.md)"
        if not (ROOT / target).is_file():
            return f"](https://github.com/moldloft/moldloft/tree/main/{target})"
        source = f"]({up}source/{target}.txt)"
        if not LIVING or (living := _living(target)) is None:
            return source
        words = "open it: turn it, change its parameters" if here == "gallery.md" else "open it"
        return f'{source} · <a href="{up}gallery/{living}">{words}</a>'

    return _LINK.sub(moved, markdown)


def _living(target: str) -> str | None:
    """The name of the page on which an example lives."""
    found = re.fullmatch(r"examples/(\w+)/(\w+)\.sdl", target)
    if found is None:
        return None
    return f"{found[2]}.html" if found[1] == "gallery" else f"{found[1]}-{found[2]}.html"


#: What the theme loads from another server when the site is opened from a folder; without it there is no search there.
_SHIM = re.compile(r'(<script src=")https://unpkg\.com/iframe-worker/shim(")')


def on_post_page(output: str, page: Any, config: Any) -> str:
    """Takes the script for searching in a folder from the site itself."""
    up = "../" * page.url.count("/")
    return _SHIM.sub(rf"\g<1>{up}iframe-worker.js\g<2>", output)


def on_post_template(output_content: str, template_name: str, config: Any) -> str:
    """The same for the page about addresses that do not exist."""
    return _SHIM.sub(r"\g<1>/iframe-worker.js\g<2>", output_content)


def on_post_build(config: Any) -> None:
    """Writes the pages of all examples."""
    if not LIVING:
        return
    folder = Path(config.site_dir) / "gallery"
    folder.mkdir(exist_ok=True)
    for path in sorted((ROOT / "examples").glob("*/*.sdl")):
        living = _living(path.relative_to(ROOT).as_posix())
        if living is None:
            continue
        page = folder / living
        command = [sys.executable, "-m", "moldloft", "export", "--html", str(path), "-o", str(page)]
        engine = ROOT / "python" / "moldloft" / "workbench" / "wasm" / "engine.wasm.xz"
        subprocess.run(command + ([] if engine.exists() else ["--still"]), check=True)
