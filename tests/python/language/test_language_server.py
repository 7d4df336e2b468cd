"""The language server of the package: ``moldloft lsp`` and the program ``moldloft-lsp``."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import moldloft

SCRIPTS = Path(sys.executable).parent


class Client:
    """An editor's side of the protocol."""

    def __init__(self, words: list[str], folder: Path) -> None:
        self.process = subprocess.Popen(
            words,
            cwd=folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        self.asked = 0

    def ended(self) -> tuple[int, bytes]:
        """Its status and what it complained of."""
        assert self.process.stdout is not None and self.process.stderr is not None
        status = self.process.wait(20)
        with self.process.stdout, self.process.stderr:
            return status, self.process.stderr.read()

    def send(self, method: str, params: Any, **more: Any) -> None:
        body = json.dumps({"jsonrpc": "2.0", "method": method, "params": params, **more}).encode()
        assert self.process.stdin is not None
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        self.process.stdin.flush()

    def receive(self) -> dict[str, Any]:
        assert self.process.stdout is not None
        length = 0
        while line := self.process.stdout.readline().strip():
            name, value = line.split(b":")
            if name.lower() == b"content-length":
                length = int(value)
        assert length, "the server has gone"
        message: dict[str, Any] = json.loads(self.process.stdout.read(length))
        return message

    def ask(self, method: str, params: Any) -> Any:
        self.asked += 1
        self.send(method, params, id=self.asked)
        while (message := self.receive()).get("id") != self.asked:
            pass
        return message["result"]

    def published(self) -> list[dict[str, Any]]:
        while (message := self.receive()).get("method") != "textDocument/publishDiagnostics":
            pass
        found: list[dict[str, Any]] = message["params"]["diagnostics"]
        return found


@pytest.mark.parametrize("program", ["moldloft lsp", "moldloft-lsp --stdio"])
def test_an_editor_is_served(program: str, tmp_path: Path) -> None:
    # A stranger's folder: nothing of it is run.
    for name in ("numpy", "moldloft", "json", "argparse"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('a stranger was run')\n")
    word, *rest = program.split()
    client = Client([str(SCRIPTS / word), *rest], tmp_path)
    answer = client.ask("initialize", {"capabilities": {}, "rootUri": tmp_path.as_uri()})
    assert answer["serverInfo"] == {"name": "moldloft-lsp", "version": moldloft.__version__}
    client.send("initialized", {})
    item = {"uri": (tmp_path / "a.sdl").as_uri(), "languageId": "sdl", "version": 1}
    text = "float width = 3;\nfloat other = nosuch;\n"
    client.send("textDocument/didOpen", {"textDocument": {**item, "text": text}})
    assert [one["code"] for one in client.published()] == ["unknown-name"]
    where = {"textDocument": {"uri": item["uri"]}, "position": {"line": 0, "character": 7}}
    assert "width" in json.dumps(client.ask("textDocument/hover", where))
    assert client.ask("shutdown", None) is None
    client.send("exit", None)
    assert client.process.stdin is not None
    client.process.stdin.close()
    assert client.ended() == (0, b"")


def test_an_editor_that_says_all_in_one_breath_is_answered(tmp_path: Path) -> None:
    client = Client([str(SCRIPTS / "moldloft"), "lsp"], tmp_path)
    client.send("initialize", {"capabilities": {}}, id="a")
    client.send("initialized", {})
    client.send("shutdown", None, id="b")
    client.send("exit", None)
    assert client.process.stdin is not None
    client.process.stdin.close()
    assert [client.receive()["id"] for _ in range(2)] == ["a", "b"]
    assert client.ended() == (0, b"")


def test_an_editor_that_goes_without_goodbye_is_a_failure(tmp_path: Path) -> None:
    client = Client([str(SCRIPTS / "moldloft"), "lsp"], tmp_path)
    client.ask("initialize", {"capabilities": {}})
    assert client.process.stdin is not None
    client.process.stdin.close()
    assert client.ended()[0] == 1


def test_arguments(tmp_path: Path) -> None:
    program = str(SCRIPTS / "moldloft-lsp")
    done = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == f"moldloft-lsp {moldloft.__version__}"
    done = subprocess.run([program, "--port"], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "Traceback" not in done.stderr
    words = [str(SCRIPTS / "moldloft"), "lsp", "--where"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert Path(done.stdout.strip()).name.startswith("moldloft-lsp")
