"""Pages of the site that are generated when it is built.

A page for each kind, function and diagnostic, the index of terms, the list of changes, and the sources
that pages link to, so that the site is complete when it is opened from a folder.
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

#: The editor's grammar, and the token class in the site for each of its scopes.
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
    """Highlighting of programs in the pages, with the keywords of the editor's grammar."""

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
    """Registers the lexer: Pygments finds lexers by their modules."""
    place = ModuleType("moldloft_site_lexer")
    place.SdlLexer = SdlLexer  # type: ignore[attr-defined]
    place.__all__ = ["SdlLexer"]  # type: ignore[attr-defined]
    sys.modules[place.__name__] = place
    LEXERS["SdlLexer"] = (place.__name__, SdlLexer.name, ("sdl",), ("*.sdl",), ())
    return config


#: Set by `make site`: all examples are also interactive pages.
LIVING = bool(os.environ.get("MOLDLOFT_LIVING"))

_LINK = re.compile(r"\]\(((?:\.\./)+[^)#\s]+)(#[^)]*)?\)")


def _target(page: str, link: str) -> str | None:
    """The path in the repository that a page of the site links to, if that is outside `docs`."""
    path = (ROOT / "docs" / page).parent.joinpath(link).resolve()
    if not path.is_relative_to(ROOT) or path.is_relative_to(ROOT / "docs"):
        return None
    return path.relative_to(ROOT).as_posix()


def on_files(files: Any, config: Any) -> Any:
    """Adds the generated pages, the linked sources and the changes to the site."""
    from mkdocs.structure.files import File

    reference, pictures = _reference()
    pages = {**reference, **_diagnostics(), "changes.md": _changes()}
    for name, content in {**pages, **pictures}.items():
        files.append(File.generated(config, name, content=content))

    linked = set()
    for file in files.documentation_pages():
        for link, _ in _LINK.findall(file.content_string):
            target = _target(file.src_uri, link)
            if target and (ROOT / target).is_file():
                linked.add(target)
    for target in sorted(linked):
        text = (ROOT / target).read_text(encoding="utf-8")
        files.append(File.generated(config, f"source/{target}.txt", content=text))
    return files


def _late(boost: float) -> str:
    """The head of a generated page, which the search lists after guides.

    The titles of these pages are short words, and match many queries by their first letters.
    """
    return f"---\nsearch:\n  boost: {boost}\n---\n\n"


def _reference() -> tuple[dict[str, str], dict[str, bytes]]:
    """The reference: its index, a page for each kind and function, the index of terms, and pictures.

    Pictures take a minute; they are drawn with the living pages.
    """
    from moldloft.cli.doc import pictures
    from moldloft.cli.reference_page import entry_pages, index_page, terms_page
    from moldloft.language import reference
    from moldloft.library import routines

    rows, libraries = reference(), routines()
    drawn = dict(pictures([*rows, *libraries])) if LIVING else {}
    pages = entry_pages(rows, lambda row: row["name"] in drawn, libraries)
    found = {f"reference/{name}.md": _late(0.01) + text for name, text in pages.items()}
    found["reference.md"] = index_page(rows, libraries)
    found["terms.md"] = terms_page([*rows, *libraries])
    return found, {f"kinds/{name}.png": image for name, image in drawn.items()}


def _changes() -> str:
    """The list of changes, with links as from a page of `docs`."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    return re.sub(r"\]\((?!https?:|#)(docs/)?", lambda m: "](" if m[1] else "](../", text)


_SECTION = re.compile(r"^## (\S+)\n\n(.*?)(?=^## |\Z)", re.M | re.S)


def _diagnostics() -> dict[str, str]:
    """A page for each diagnostic, from its section in docs/diagnostics.md."""
    text = (ROOT / "docs" / "diagnostics.md").read_text(encoding="utf-8")
    back = "[All diagnostics](../diagnostics.md)"
    return {
        f"diagnostics/{name}.md": f"{_late(0.2)}# {name}\n\n{body.strip()}\n\n{back}\n"
        for name, body in _SECTION.findall(text)
    }


def _index_of_diagnostics(markdown: str) -> str:
    """The list of diagnostics, each with the first sentence of its meaning."""
    head = markdown.partition("\n## ")[0]
    lines = [head, "", "| id | meaning |", "| --- | --- |"]
    for name, body in _SECTION.findall(markdown):
        meaning = " ".join(body.partition("\n\n")[0].split())
        first = re.match(r".*?[.](?= [A-Z`]|$)", meaning)
        shown = (first[0] if first else meaning).replace("|", "\\|")
        lines.append(f"| [{name}](diagnostics/{name}.md) | {shown} |")
    return "\n".join(lines) + "\n"


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Links the indexes to the pages of their entries, and sources to their copies in the site."""
    here = page.file.src_uri
    if here == "diagnostics.md":
        markdown = _index_of_diagnostics(markdown)
    up = "../" * here.count("/")
    markdown = markdown.replace(
        "(https://moldloft.github.io/moldloft/terms.html)", f"({up}terms.md)"
    )

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


#: Script that the theme loads from another server for search in a site opened from a folder.
_SHIM = re.compile(r'(<script src=")https://unpkg\.com/iframe-worker/shim(")')


def on_post_page(output: str, page: Any, config: Any) -> str:
    """Loads the script for search in a folder from the site itself."""
    up = "../" * page.url.count("/")
    return _SHIM.sub(rf"\g<1>{up}iframe-worker.js\g<2>", output)


def on_post_template(output_content: str, template_name: str, config: Any) -> str:
    """The same for the page of unknown addresses."""
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
