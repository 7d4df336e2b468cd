"""The workbench without a browser: texts, the hub, the engine process, what the server refuses."""

from __future__ import annotations

import asyncio
import json
import math
import os
import random
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

from conftest import SAILBOAT
from moldloft.errors import Error
from moldloft.storage import put
from moldloft.workbench.address import proof
from moldloft.workbench.draft import Draft
from moldloft.workbench.engine import Engine
from moldloft.workbench.frames import head_of
from moldloft.workbench.hub import Hub, Tab
from moldloft.workbench.recent import note_opened
from moldloft.workbench.text import applied, change_set, encoded, read

LINE = "param float w = 2 in [1, 3];\nAbsPoint A(0, 0, 0);\nAbsPoint B(w, 0, 0);\nLine l(A, B);\n"


# Texts.


def test_change_sets_make_one_text_of_another() -> None:
    pool = ["a", "b", "\n", "é", "𝄞", " ", "7"]
    rng = random.Random(5)
    for _ in range(300):
        old = "".join(rng.choices(pool, k=rng.randrange(12)))
        new = "".join(rng.choices(pool, k=rng.randrange(12)))
        assert applied(old, change_set(old, new)) == new, (old, new)


@pytest.mark.parametrize("wrong", [[3], [99], [[1]], [-1, 5], ["x"], [[1, 2], 3], [4, [9, ""]]])
def test_change_sets_of_other_texts_are_refused(wrong: list[Any]) -> None:
    with pytest.raises((ValueError, TypeError)):
        applied("abcd", wrong) if wrong != [[1]] else applied("abcd", [*wrong])


def test_files_keep_their_line_ends_mode_and_link(tmp_path: Path) -> None:
    path = tmp_path / "model.sdl"
    path.write_bytes(b"\xef\xbb\xbfone\r\ntwo\r\n")
    path.chmod(0o640)
    link = tmp_path / "link.sdl"
    link.symlink_to(path)
    stored = read(link)
    assert stored.text == "one\ntwo\n"
    put(link, encoded("one\nzwei\n", stored))
    assert path.read_bytes() == b"\xef\xbb\xbfone\r\nzwei\r\n"
    assert link.is_symlink() and path.stat().st_mode & 0o777 == 0o640
    assert not [p for p in tmp_path.iterdir() if p.name.endswith(".part")]


def test_a_draft_has_one_owner(tmp_path: Path) -> None:
    model = tmp_path / "model.sdl"
    model.write_text(LINE)
    first = Draft(model)
    first.keep("text", "digest")
    assert first.path.stat().st_mode & 0o777 == 0o600
    with pytest.raises(Error, match="another workbench"):
        Draft(model)
    first.close(keep=True)
    again = Draft(model)
    assert again.left() == {"text": "text", "digest": "digest"}
    again.close(keep=False)
    assert not again.path.exists()


# The hub and its engine.


class Page:
    """A page without a browser: it keeps what it was sent."""

    def __init__(self, hub: Hub) -> None:
        self.hub = hub
        self.said: list[dict[str, Any]] = []
        self.heads: list[dict[str, Any]] = []
        self.objects: list[dict[str, Any]] = []
        self.text = ""
        self.version = 0
        self.count = 0
        self.news = asyncio.Event()
        self.tab: Tab = hub.join(self.take)
        hello = hub.hello(self.tab)
        self.text, self.version = hello["text"], hello["version"]

    async def take(self, data: str | bytes) -> None:
        if isinstance(data, bytes):
            head = head_of(data)
            self.objects = head.get("objects", self.objects)
            self.heads.append(head)
        else:
            message = json.loads(data)
            self.said.append(message)
            if message["kind"] == "updates" and not message["file"]:
                for update in message["updates"]:
                    self.text = applied(self.text, update["changes"])
                self.version = message["from"] + len(message["updates"])
        self.news.set()

    async def until(self, true: Callable[[], Any], seconds: float = 30) -> Any:
        async def wait() -> Any:
            while not (found := true()):
                self.news.clear()
                await self.news.wait()
            return found

        return await asyncio.wait_for(wait(), seconds)

    async def ask(self, kind: str, **fields: Any) -> dict[str, Any]:
        self.count += 1
        number = self.count
        await self.hub.hear(self.tab, {"kind": kind, "id": number, **fields})

        def answer() -> dict[str, Any] | None:
            return next((m for m in [*self.heads, *self.said] if m.get("id") == number), None)

        found: dict[str, Any] = await self.until(answer)
        return found

    async def type(self, new: str) -> dict[str, Any]:
        update = {"changes": change_set(self.text, new), "clientID": "page"}
        return await self.ask("push", version=self.version, updates=[update])


def workbench(path: Path, play: Callable[[Hub], Awaitable[None]], **options: Any) -> None:
    """Runs a play on the hub of a model."""

    async def run() -> None:
        hub = Hub(path, **options)
        hub.start()
        try:
            await play(hub)
        finally:
            await hub.stop()

    asyncio.run(run())


def test_what_is_typed_is_on_disk_before_the_page_hears_so(model_file: Callable[..., Path]) -> None:
    path = model_file(LINE)

    async def play(hub: Hub) -> None:
        page = Page(hub)
        assert (await page.ask("open"))["params"][0]["value"] == 2.0
        reply = await page.type(LINE.replace("w = 2", "w = 2.5"))
        assert reply["ok"] and page.version == 1
        kept = json.loads(hub.main.draft.path.read_text())
        assert "w = 2.5" in kept["text"]
        await page.until(lambda: [h for h in page.heads if h.get("version") == 1])
        # Old versions are refused, and the page brings itself up to date.
        stale = await page.ask("push", version=0, updates=[{"changes": [1], "clientID": "p"}])
        assert stale["ok"] is False and stale["version"] == 1
        assert (await page.ask("pull", version=0))["updates"][0]["clientID"] == "page"
        assert (await page.ask("save"))["kind"] == "saved"
        assert "w = 2.5" in path.read_text() and not hub.main.dirty

    workbench(path, play)
    assert [p.name for p in path.parent.iterdir()] == [path.name]


def test_sliders_do_not_wait_for_a_slow_disk(
    model_file: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = model_file(LINE)
    ready, keep = threading.Event(), Draft.keep

    def slow(draft: Draft, text: str, digest: str) -> None:
        assert ready.wait(60)
        keep(draft, text, digest)

    async def play(hub: Hub) -> None:
        page = Page(hub)
        await page.ask("open")
        typing = asyncio.ensure_future(page.type(LINE + "AbsPoint C(0, 1, 0);\n"))
        await page.until(lambda: any(o["name"] == "C" for o in page.objects))
        for width in (1.5, 2.5, 3):
            head = await page.ask("set", values={"w": width})
            assert head["params"][0]["value"] == width
        # The text is in the model, and not on disk: the page does not count it as kept.
        assert page.version == 0 and not typing.done() and not hub.main.draft.path.exists()
        ready.set()
        assert (await typing)["ok"] and page.version == 1
        assert "C(0, 1, 0)" in json.loads(hub.main.draft.path.read_text())["text"]

    monkeypatch.setattr(Draft, "keep", slow)
    workbench(path, play)


def test_a_draft_that_cannot_be_written_is_reported(
    model_file: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = model_file(LINE)

    def full(draft: Draft, text: str, digest: str) -> None:
        raise OSError(28, "No space left on device")

    async def play(hub: Hub) -> None:
        page = Page(hub)
        with monkeypatch.context() as patch:
            patch.setattr(Draft, "keep", full)
            reply = await page.type(LINE + "# one\n")
            assert reply["ok"] and "draft cannot be written: [Errno 28]" in reply["error"]
        assert "error" not in await page.type(LINE + "# one\n# two\n")
        assert json.loads(hub.main.draft.path.read_text())["text"].endswith("# two\n")

    workbench(path, play)


def test_two_tabs_see_the_same(model_file: Callable[..., Path]) -> None:
    async def play(hub: Hub) -> None:
        one, two = Page(hub), Page(hub)
        await one.ask("open")
        await two.ask("open")
        await one.ask("set", values={"w": 3})
        head = await two.until(
            lambda: next(
                (h for h in two.heads if h.get("params") and h["params"][0]["value"] == 3), None
            )
        )
        # The point and the line, not the other point.
        assert sorted(i["name"] for i in head["items"]) == ["B", "l"]
        await one.type(LINE + "AbsPoint C(0, 1, 0);\n")
        await two.until(lambda: any(o["name"] == "C" for o in two.objects))
        assert one.text == two.text == hub.main.text

    workbench(model_file(LINE), play)


def test_a_file_that_changes_outside_is_followed_or_asked_about(
    model_file: Callable[..., Path],
) -> None:
    path = model_file(LINE)

    async def play(hub: Hub) -> None:
        page = Page(hub)
        path.write_text(LINE + "# outside\n")
        await page.until(lambda: page.text.endswith("# outside\n"))
        assert not hub.main.dirty
        await page.type("# mine\n" + page.text)
        path.write_text(LINE + "# again\n")
        conflict = await page.until(lambda: [m for m in page.said if m["kind"] == "conflict"])
        assert conflict[0]["theirs"].endswith("# again\n")
        assert page.text.startswith("# mine") and path.read_text().endswith("# again\n")
        # Saving asks before it writes over the other's work.
        assert (await page.ask("save"))["kind"] == "conflict"
        assert path.read_text().endswith("# again\n")
        assert (await page.ask("save", force=True))["kind"] == "saved"
        assert path.read_text().startswith("# mine")

    workbench(path, play)


def test_an_engine_that_is_killed_loses_nothing(
    model_file: Callable[..., Path], soak: bool
) -> None:
    async def play(hub: Hub) -> None:
        page = Page(hub)
        await page.ask("open")
        text = page.text
        for k in range(100 if soak else 3):
            # While another is on its way there is none, and 0 would be the tests themselves.
            while hub.engine.pid is None:
                await asyncio.sleep(0.01)
            os.kill(hub.engine.pid, signal.SIGKILL)
            text += f"AbsPoint P{k}(0, 0, {k});\n"
            assert (await page.type(text))["ok"]
            await page.until(lambda k=k: any(o["name"] == f"P{k}" for o in page.objects))
            assert hub.main.text == text
        assert not [h for h in page.heads if h.get("internal")]

    workbench(model_file(LINE), play)


@pytest.mark.parametrize(
    "bomb",
    [
        "for (i = 1:10000000) AbsPoint p(i, 0, 0);",
        "set s = set(sphere({0,0,0}, 1)); SetBody b(s, {-2,-2,-2}, {2,2,2}, depth = 12);",
        "set s = set(sphere({0,0,0}, 1)); for (i = 1:60) s = s & (s | set(sphere({i/60.,0,0}, 1)));"
        " SetBody b(s, {-2,-2,-2}, {2,2,2}, depth = 6);",
    ],
)
def test_a_model_without_bounds_takes_nothing_with_it(
    model_file: Callable[..., Path], bomb: str
) -> None:
    async def play(hub: Hub) -> None:
        page = Page(hub)
        await page.ask("open")
        bad = f"{page.text}{bomb}\n"
        assert (await page.type(bad))["ok"]
        assert hub.main.text == bad and json.loads(hub.main.draft.path.read_text())["text"] == bad
        good = LINE + "AbsPoint P(1, 2, 3);\n"
        assert (await page.type(good))["ok"]
        await page.until(lambda: any(o["name"] == "P" for o in page.objects), 240)
        assert hub.main.text == good

    workbench(model_file(LINE), play, memory=300 << 20, budget=3.0)


def test_a_stop_that_comes_late_stops_nothing_else() -> None:
    async def play() -> None:
        engine = Engine("model.sdl", None, budget=60)
        await engine.start(LINE)
        try:
            await engine.ask(b'{"kind": "open", "tab": 1, "id": 1}')
            await engine._send(b'{"kind":"cancel"}')
            await asyncio.sleep(0.1)
            text = f"{LINE}AbsPoint P(1, 2, 3);\n"
            request = {"kind": "text", "tab": 1, "id": 2, "version": 1, "text": text}
            head = head_of(await engine.ask(json.dumps(request).encode()))
            assert [o["name"] for o in head["objects"]] == ["A", "B", "l", "P"]
        finally:
            await engine.end()

    asyncio.run(play())


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_an_engine_ends_with_its_server(model_file: Callable[..., Path]) -> None:
    path = model_file("float x = 1; while (1) x = x + 1;\n")
    code = (
        "import asyncio, os, sys; from pathlib import Path\n"
        "from moldloft.workbench.engine import Engine\n"
        "async def run():\n"
        "    engine = Engine('model.sdl', None, budget=600)\n"
        "    await engine.start(Path(sys.argv[1]).read_text())\n"
        "    print(engine.pid, flush=True)\n"
        '    await engine.ask(b\'{"kind": "open", "tab": 1, "id": 1}\')\n'
        "asyncio.run(run())\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code, str(path)], stdout=subprocess.PIPE, text=True
    ) as server:
        assert server.stdout
        engine = int(server.stdout.readline())
        time.sleep(0.5)
        server.kill()
        server.wait()
    end = time.monotonic() + 20
    while time.monotonic() < end:
        try:
            os.kill(engine, 0)
        except ProcessLookupError:
            return
        state = Path(f"/proc/{engine}/stat")
        if state.exists() and state.read_text().rpartition(")")[2].split()[0] == "Z":
            return
        time.sleep(0.1)
    os.kill(engine, signal.SIGKILL)
    raise AssertionError("the engine outlives its server")


def test_a_model_without_end_is_stopped_and_the_text_can_be_changed(
    model_file: Callable[..., Path],
) -> None:
    async def play(hub: Hub) -> None:
        page = Page(hub)
        await page.ask("open")
        await page.type(LINE + "int k = 0;\nwhile (k < 1) { k = 0; }\n")
        said = await page.until(
            lambda: (
                [
                    h
                    for h in page.heads
                    if any(d["severity"] == "error" for d in h.get("diagnostics", []))
                ]
                or [m for m in page.said if m.get("state") == "lost"]
            )
        )
        assert said
        await page.type(LINE)
        await page.until(
            lambda: page.heads[-1].get("version") == hub.main.version and page.heads[-1].get("rev")
        )
        assert (await page.ask("evaluate", expressions=["l.length"]))["values"][0]["value"] == 2.0

    workbench(model_file(LINE), play, budget=1.5)


def test_a_server_that_is_killed_keeps_the_draft(model_file: Callable[..., Path]) -> None:
    path = model_file(LINE)

    async def first(hub: Hub) -> None:
        page = Page(hub)
        await page.type(LINE + "# unsaved\n")

    workbench(path, first)
    assert path.read_text() == LINE

    async def second(hub: Hub) -> None:
        page = Page(hub)
        assert hub.main.recovered and page.text.endswith("# unsaved\n")
        # The page is given the file's text, and makes it a step of its history.
        reply = await page.ask("revert")
        await page.type(reply["text"])
        assert hub.main.text == LINE and not hub.main.dirty

    workbench(path, second)


def test_requests_that_are_none_are_refused(model_file: Callable[..., Path]) -> None:
    async def play(hub: Hub) -> None:
        page = Page(hub)
        for kind in ("text", "splice", "close", "nonsense", "__init__"):
            assert (await page.ask(kind, text="gone"))["kind"] == "refused"
        for updates in (
            "x",
            [{}],
            [{"changes": "x", "clientID": 1}],
            [{"changes": [9999], "clientID": "a"}],
        ):
            reply = await page.ask("push", version=0, updates=updates)
            assert reply["ok"] is False
        assert hub.main.text == LINE
        files = await page.ask("export", format="stl", stem="../../etc/passwd")
        assert "error" in files or all("/" not in f["name"] for f in files["files"])

    workbench(model_file(LINE), play)


def test_of_many_slider_moves_the_newest_counts(model_file: Callable[..., Path]) -> None:
    async def play(hub: Hub) -> None:
        page = Page(hub)
        await page.ask("open")
        for k in range(200):
            await hub.hear(page.tab, {"kind": "set", "id": 1000 + k, "values": {"w": 1 + k / 100}})
        last = await page.until(lambda: next((h for h in page.heads if h.get("id") == 1199), None))
        assert last["params"][0]["value"] == 2.99
        answered = [h for h in page.heads if 1000 <= h.get("id", 0) < 1200]
        assert len(answered) < 100

    workbench(model_file(LINE), play)


def test_a_move_ends_what_is_measured(model_file: Callable[..., Path]) -> None:
    text = "param float r = 1 in [0.5, 2];\nset ball = set(sphere({0, 0, 0}, r));\n"
    corners = "{-2, -2, -2}, {2, 2, 2}"

    async def play(hub: Hub) -> None:
        page = Page(hub)
        await page.ask("open")
        tab = page.tab
        await page.ask("watch", expressions=["2*r"])
        # Seconds of work at the greater depth.
        deep = f"volume_bracket(ball, {corners}, 8)"
        await hub.hear(tab, {"kind": "watch", "id": 900, "expressions": [deep]})
        await page.until(lambda: any(h.get("id") == 900 for h in page.heads), 240)
        for k in (1, 2):
            await hub.hear(tab, {"kind": "measure", "id": 900 + k})
        while hub._running != "measure":
            await asyncio.sleep(0)
        await hub.hear(tab, {"kind": "measure", "id": 910})
        await hub.hear(tab, {"kind": "set", "id": 911, "values": {"r": 1.5}})
        await page.until(lambda: any(h.get("id") == 911 for h in page.heads), 240)
        stopped = next(h for h in page.heads if h.get("id") in (901, 902))
        assert "watched" not in stopped and page.heads[-1]["params"][0]["value"] == 1.5
        # Those that waited are superseded, not computed for a shape that is gone.
        waited = {m["id"] for m in page.said if m["kind"] == "superseded"}
        assert 910 in waited and len(waited & {901, 902, 910}) == 2
        # What comes after the move is of the shape as it is.
        await page.ask("watch", expressions=["2*r"])
        [row] = (await page.ask("measure"))["watched"]
        assert row["value"] == 3.0 and not row.get("error")
        less = deep.replace("8)", "6)")
        low, high = (await page.ask("evaluate", expressions=[less]))["values"][0]["value"]["first"]
        assert low < 4 / 3 * math.pi * 1.5**3 < high

    workbench(model_file(text), play)


# The server.


def server_app(hub: Hub, port: int = 4321) -> Any:
    pytest.importorskip("starlette", reason="the extra `view` is not installed")
    from moldloft.workbench.server import Server

    try:
        server = Server(hub, 0)
    except Error as error:
        pytest.skip(str(error))
    server.port = port
    # Nothing listens: applications are called without a socket.
    server._socket.close()
    return server


def test_a_page_opens_only_what_was_opened_before(
    model_file: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    path, other, gone = (model_file(LINE, f"{name}.sdl") for name in ("a", "b", "c"))
    for each in (gone, other, path):
        note_opened(each)
    gone.unlink()

    async def play(hub: Hub) -> None:
        page = Page(hub)
        listed = await page.ask("recent")
        assert [each["path"] for each in listed["files"]] == [str(other)]
        hub.beside = lambda path: f"http://{path.name}"
        opened = await page.ask("open_recent", path=str(other))
        assert opened["url"] == "http://b.sdl"
        for wrong in ("/etc/passwd", str(gone), str(path), None, 3):
            refused = await page.ask("open_recent", path=wrong)
            assert refused["kind"] == "refused" and "no longer" in refused["error"]

    workbench(path, play)


def test_answers_do_not_wait_for_acknowledgements(model_file: Callable[..., Path]) -> None:
    pytest.importorskip("starlette", reason="the extra `view` is not installed")
    from moldloft.workbench.server import Server

    async def play(hub: Hub) -> None:
        server, seen = Server(hub, 0), asyncio.Queue[int]()

        async def taken(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            connection = writer.get_extra_info("socket")
            seen.put_nowait(connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))
            writer.close()

        async with await asyncio.start_server(taken, sock=server._socket):
            _, writer = await asyncio.open_connection("127.0.0.1", server.port)
            assert await asyncio.wait_for(seen.get(), 10) != 0
            writer.close()
            await writer.wait_closed()

    workbench(model_file(LINE), play)


def request(
    app: Any,
    method: str = "GET",
    path: str = "/",
    body: bytes = b"",
    kind: str = "http",
    **headers: str,
) -> tuple[int, dict[str, str], bytes]:
    """What an ASGI application answers to a raw request."""
    given = {"host": "127.0.0.1:4321", **{k.replace("_", "-"): v for k, v in headers.items()}}
    scope = {
        "type": kind,
        "method": method,
        "path": path,
        "raw_path": path.encode(),
        "query_string": b"",
        "root_path": "",
        "headers": [(k.encode(), v.encode()) for k, v in given.items() if v],
        "scheme": "http" if kind == "http" else "ws",
        "client": ("127.0.0.1", 1),
        "server": ("127.0.0.1", 4321),
        "http_version": "1.1",
        "subprotocols": [],
        "asgi": {"version": "3.0"},
    }
    sent: list[dict[str, Any]] = []

    async def run() -> None:
        first = (
            {"type": "websocket.connect"}
            if kind == "websocket"
            else {"type": "http.request", "body": body, "more_body": False}
        )
        messages = [first, {"type": "websocket.disconnect", "code": 1000}]

        async def receive() -> dict[str, Any]:
            return messages.pop(0) if messages else {"type": "http.disconnect"}

        async def send(message: dict[str, Any]) -> None:
            sent.append(message)

        await app(scope, receive, send)

    asyncio.run(run())
    if kind == "websocket":
        accepted = any(m["type"] == "websocket.accept" for m in sent)
        return (101 if accepted else sent[0].get("code", 0)), {}, b""
    head = {k.decode().lower(): v.decode() for k, v in sent[0]["headers"]}
    return sent[0]["status"], head, b"".join(m.get("body", b"") for m in sent[1:])


HOME = "http://127.0.0.1:4321"


def test_only_this_page_is_served(model_file: Callable[..., Path]) -> None:
    async def play(hub: Hub) -> None:
        pass

    path = model_file(LINE)
    hub = Hub(path)
    try:
        server = server_app(hub)
        app = server.app()
        assert request(app)[0] == 200
        assert request(app, host="localhost:4321")[0] == 200
        for host in ("evil.com", "127.0.0.1.evil.com", "127.0.0.1:9999", "[::1]:4321", ""):
            assert request(app, host=host)[0] == 403, host
        for origin in (
            "http://evil.com",
            "null",
            "http://127.0.0.1:9999",
            "https://127.0.0.1:4321",
        ):
            assert request(app, origin=origin)[0] == 403, origin
            assert request(app, kind="websocket", path="/ws", origin=origin)[0] == 4403, origin
        assert request(app, sec_fetch_site="cross-site")[0] == 403
        # From another page of this machine one comes to the frame alone.
        near = {"sec_fetch_site": "same-site", "sec_fetch_mode": "navigate"}
        assert request(app, **near)[0] == 200
        assert request(app, sec_fetch_site="same-site")[0] == 403
        assert request(app, path="/assets/x.js", **near)[0] == 403
        assert request(app, "POST", "/token", b"wrong", origin=HOME, **near)[0] == 403
        # An upgrade and a post must say where they come from.
        assert request(app, kind="websocket", path="/ws")[0] == 4403
        assert request(app, "POST", "/token", server._token.encode())[0] == 403
        # The token buys one strict cookie; without it there is no socket.
        assert request(app, "POST", "/token", b"wrong", origin=HOME)[0] == 403
        assert request(app, "POST", "/token", b"x" * 5000, origin=HOME)[0] == 403
        token = server._token.encode()
        status, head, _ = request(app, "POST", "/token", token, origin=HOME)
        cookie = head["set-cookie"]
        assert status == 204 and "HttpOnly" in cookie and "SameSite=strict" in cookie
        assert "moldloft-" in cookie
        assert request(app, kind="websocket", path="/ws", origin=HOME)[0] == 4401
        value = cookie.split(";")[0]
        assert request(app, kind="websocket", path="/ws", origin=HOME, cookie=value)[0] == 101
        # A used token is worth nothing, but to the browser that has the cookie.
        assert server._token.encode() != token
        assert request(app, "POST", "/token", token, origin=HOME)[0] == 403
        assert request(app, "POST", "/token", token, origin=HOME, cookie=value)[0] == 204
        assert request(app, "POST", "/token", server._token.encode(), origin=HOME)[0] == 204
    finally:
        hub.main.draft.close(keep=False)


def test_pages_of_the_last_server_are_known_by_their_secret(
    model_file: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    path = model_file(LINE)
    hub = Hub(path)
    try:
        server_app(hub)
        mine = hub.secret
    finally:
        hub.main.draft.close(keep=False)
    kept = next((tmp_path / "state").rglob("addresses.json"))
    assert kept.stat().st_mode & 0o077 == 0 and mine in kept.read_text(encoding="utf-8")
    hub = Hub(path)
    try:
        server = server_app(hub)
        app = server.app()
        challenge = request(app, path="/challenge")[2].decode()
        assert mine not in challenge and hub.secret not in (mine, challenge)
        # Neither the secret itself, nor one of another model, nor a proof for another port.
        for body in (
            mine,
            proof("other", 4321, challenge),
            proof(hub.secret, 4321, challenge),
            proof(mine, 9999, challenge),
            proof(mine, 4321, "other"),
        ):
            assert request(app, "POST", "/token", body.encode(), origin=HOME)[0] == 403
        right = proof(mine, 4321, challenge).encode()
        assert request(app, "POST", "/token", right)[0] == 403
        status, head, _ = request(app, "POST", "/token", right, origin=HOME)
        value = head["set-cookie"].split(";")[0]
        assert status == 204
        assert request(app, kind="websocket", path="/ws", origin=HOME, cookie=value)[0] == 101
        # A challenge is met once, and there is none for a page that is known.
        assert request(app, "POST", "/token", right, origin=HOME)[0] == 403
        assert request(app, path="/challenge")[2].decode() != challenge
        assert request(app, path="/challenge", cookie=value)[2] == b""
    finally:
        hub.main.draft.close(keep=False)


def test_the_page_says_what_it_may_do(model_file: Callable[..., Path]) -> None:
    hub = Hub(model_file(LINE))
    try:
        app = server_app(hub).app()
        _, head, page = request(app)
        policy = head["content-security-policy"]
        for part in ("default-src 'self'", "frame-ancestors 'none'", "object-src 'none'"):
            assert part in policy
        assert "unsafe" not in policy and "access-control-allow-origin" not in head
        assert head["x-content-type-options"] == "nosniff"
        nonce = policy.split("'nonce-")[1].split("'")[0]
        assert nonce.encode() in page and b"__NONCE__" not in page
        # Nothing but the page's own files.
        for path in (
            "/assets/../server.py",
            "/assets/.env",
            "/model.sdl",
            "/.git/config",
            "/assets/",
        ):
            assert request(app, path=path)[0] == 404, path
        script = page.split(b'src="')[1].split(b'"')[0].decode()
        status, head, data = request(app, path=script)
        assert status == 200 and "immutable" in head["cache-control"]
        assert len(data) < 1_200_000
    finally:
        hub.main.draft.close(keep=False)


HOSTILE = '<img src=x onerror="document.title=1">'


def test_a_page_in_a_file_carries_names_as_data(
    model_file: Callable[..., Path], tmp_path: Path
) -> None:
    from moldloft.workbench.export import exported_page

    text = (
        LINE
        + f"# {HOSTILE} </script><script>alert(1)</script> $& \u2028\n"
        + f"print({json.dumps(HOSTILE)});\n"
    )
    try:
        page = exported_page(model_file(text), values={"w": 3}, living=False).decode()
    except Error as error:
        pytest.skip(str(error))
    assert page.count("<script") == 2 and HOSTILE not in page and "alert(1)</script>" not in page
    assert "http://" not in page.split("<script")[0] and "Content-Security-Policy" in page
    data = json.loads(page.split('id="moldloft-model">')[1].split("</script>")[0])
    assert data["hello"]["text"] == text


def test_what_is_missing_is_said(cli: Any, tmp_path: Path) -> None:
    done = cli("view", "nothing.sdl", "--no-browser", status=1)
    assert "nothing.sdl" in done.stderr
    done = cli("export", "--html", SAILBOAT / "hull.sdl", "--set", "nobody=3", status=1)
    assert "nobody" in done.stderr or "make web" in done.stderr
    cli("export", SAILBOAT / "hull.sdl", status=2)


@pytest.fixture
def soak() -> bool:
    return os.environ.get("MOLDLOFT_SOAK") == "1"
