"""The language server in a large workspace: diagnostics after a keystroke, rename over files.

    python benches/language_server.py [FILES] [LINES]

Writes FILES programs (200) of LINES lines each (250), which load one library, opens one, types
in it, and renames a function of the library.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path


class Editor:
    def __init__(self, folder: Path) -> None:
        program = Path(sys.executable).parent / "moldloft-lsp"
        self.child = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.number = 0
        uri = folder.as_uri()
        folders = [{"uri": uri, "name": "models"}]
        self.ask("initialize", {"capabilities": {}, "workspaceFolders": folders})
        self.tell("initialized", {})

    def send(self, message: dict[str, object]) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        assert self.child.stdin is not None
        self.child.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        self.child.stdin.flush()

    def tell(self, method: str, params: object) -> None:
        self.send({"method": method, "params": params})

    def next(self) -> dict[str, object]:
        assert self.child.stdout is not None
        length = 0
        while line := self.child.stdout.readline().strip():
            if line.startswith(b"Content-Length:"):
                length = int(line.split(b":")[1])
        message: dict[str, object] = json.loads(self.child.stdout.read(length))
        return message

    def ask(self, method: str, params: object) -> object:
        self.number += 1
        self.send({"id": self.number, "method": method, "params": params})
        while (message := self.next()).get("id") != self.number:
            pass
        if "error" in message:
            raise SystemExit(f"{method}: {message['error']}")
        return message["result"]

    def published(self, uri: str) -> object:
        while True:
            message = self.next()
            if message.get("method") == "textDocument/publishDiagnostics":
                params = message["params"]
                assert isinstance(params, dict)
                if params["uri"] == uri:
                    return params["diagnostics"]


def program(number: int, lines: int) -> str:
    head = [
        'load "library.sdl"',
        f"param float width{number} = 2 in [1, 3];",
        f"AbsPoint P0(0, width{number}, 0);",
    ]
    body = []
    for k in range(1, lines // 3):
        body.append(f"float a{k} = half({k}) + width{number};")
        body.append(f"AbsPoint P{k}({k}, a{k}, 0.5*a{k});  # station {k}")
        body.append(f"Line L{k}(P{k - 1}, P{k});")
    return "\n".join(head + body) + "\n"


def main() -> None:
    files = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    lines = int(sys.argv[2]) if len(sys.argv) > 2 else 250
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        (folder / "library.sdl").write_text(
            "# Half of a number.\nfunction float half(float whole) { return whole/2; }\n"
        )
        for k in range(files - 1):
            (folder / f"model{k}.sdl").write_text(program(k, lines))
        editor = Editor(folder)
        path = folder / "model0.sdl"
        uri = path.as_uri()
        text = path.read_text()
        item = {"uri": uri, "languageId": "sdl", "version": 1, "text": text}
        editor.tell("textDocument/didOpen", {"textDocument": item})
        assert editor.published(uri) == []
        times = []
        for k in range(40):
            line = 3 + 3 * (k % 20)
            place = {"line": line, "character": 6}
            change = {"range": {"start": place, "end": place}, "text": "q" if k % 2 == 0 else ""}
            if k % 2:
                change["range"] = {
                    "start": {"line": 3 + 3 * ((k - 1) % 20), "character": 6},
                    "end": {"line": 3 + 3 * ((k - 1) % 20), "character": 7},
                }
            document = {"uri": uri, "version": 2 + k}
            begin = time.perf_counter()
            editor.tell(
                "textDocument/didChange", {"textDocument": document, "contentChanges": [change]}
            )
            editor.published(uri)
            times.append(1e3 * (time.perf_counter() - begin))
        times.sort()
        print(f"{files} files, {files * lines} lines")
        print(
            f"diagnostics after a keystroke: median {statistics.median(times):.1f} ms, "
            f"95 % {times[int(0.95 * len(times))]:.1f} ms (asked 100)"
        )
        at = {"textDocument": {"uri": uri}, "position": {"line": 3, "character": 13}}
        for which in ("first, reading all files", "again"):
            begin = time.perf_counter()
            edits = editor.ask("textDocument/rename", {**at, "newName": "halved"})
            passed = 1e3 * (time.perf_counter() - begin)
            assert isinstance(edits, dict)
            count = sum(len(e) for e in edits["changes"].values())
            print(
                f"rename, {which}: {passed:.0f} ms, {count} places, "
                f"{len(edits['changes'])} files (asked 1000)"
            )
        editor.ask("shutdown", None)
        editor.tell("exit", None)
        editor.child.wait()


if __name__ == "__main__":
    main()
