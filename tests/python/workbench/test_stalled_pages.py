"""Pages that do not read cost other pages and the disk nothing, and are told when they are back."""

from __future__ import annotations

import asyncio
import contextlib
import functools
import json
import os
import random
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

from moldloft.errors import Error
from moldloft.workbench import hub as hub_module
from moldloft.workbench.frames import head_of
from moldloft.workbench.hub import Hub
from moldloft.workbench.outbox import BEHIND, MOST_BYTES, Outbox

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

LINE = "param float w = 2 in [1, 3];\nAbsPoint A(0, 0, 0);\nAbsPoint B(w, 0, 0);\nLine l(A, B);\n"


def played(play: Callable[[], Awaitable[None]]) -> None:
    async def run() -> None:
        await asyncio.wait_for(play(), 120)

    asyncio.run(run())


async def never(_: str | bytes) -> None:
    await asyncio.Event().wait()


async def passed() -> None:
    """Lets what is ready run."""
    for _ in range(20):
        await asyncio.sleep(0)


def test_the_newest_state_is_sent_once() -> None:
    sent: list[str | bytes] = []
    gate = asyncio.Event()

    async def send(data: str | bytes) -> None:
        await gate.wait()
        sent.append(data)

    async def play() -> None:
        out = Outbox(send)
        for word in ("a", "b"):
            out.put(word)
        for k in range(100):
            out.put_newest("state", functools.partial("state {}".format, k))
        out.put("c")
        gate.set()
        await passed()
        assert sent == ["a", "b", "state 99", "c"]
        out.close()

    played(play)


def test_a_page_that_takes_nothing_is_dropped() -> None:
    async def play() -> None:
        gone: list[str] = []
        late = Outbox(never, gone.append, patience=0.01)
        late.put("x")
        while not gone:
            await asyncio.sleep(0.01)
        assert "took nothing" in gone[0]
        # Much at once is no reason: the page may read it.
        many = Outbox(never, gone.append)
        for _ in range(3):
            many.put(b"x" * (MOST_BYTES // 2))
        await passed()
        assert len(gone) == 1
        # It is one when nothing has been taken for a while.
        many._since -= 2
        many.put(b"x" * MOST_BYTES)
        assert gone[1:] == ["8 MB waited for it"] and not many._waiting

    played(play)


def test_room_is_announced() -> None:
    taken = asyncio.Event()
    rooms: list[bool] = []

    async def send(_: str | bytes) -> None:
        await taken.wait()

    async def play() -> None:
        out = Outbox(send, room=lambda: rooms.append(out.behind))
        out.put(b"x" * (BEHIND + 1))
        assert out.behind
        taken.set()
        await passed()
        assert rooms == [False]

    played(play)


class Page:
    """A page that reads; what it is answered by its ids."""

    def __init__(self, hub: Hub) -> None:
        self.hub, self.answers, self.count = hub, dict[int, dict[str, Any]](), 0
        self.objects: list[dict[str, Any]] = []
        self.news = asyncio.Event()
        self.tab = hub.join(self.take)
        hello = hub.hello(self.tab)
        self.text, self.version = hello["text"], hello["version"]

    async def take(self, data: str | bytes) -> None:
        message = head_of(data) if isinstance(data, bytes) else json.loads(data)
        if isinstance(data, bytes):
            self.objects = message.get("objects", self.objects)
        if isinstance(message.get("id"), int):
            self.answers[message["id"]] = message
        self.news.set()

    async def ask(self, kind: Any, **fields: Any) -> dict[str, Any]:
        self.count += 1
        number = self.count
        await self.hub.hear(self.tab, {"kind": kind, "id": number, **fields})
        while number not in self.answers:
            self.news.clear()
            await self.news.wait()
        return self.answers[number]

    async def append(self, line: str) -> dict[str, Any]:
        changes = [len(self.text), [0, *("\n" + line).split("\n")]]
        update = {"changes": changes, "clientID": "p"}
        reply = await self.ask("push", version=self.version, updates=[update])
        if reply["ok"]:
            self.text += "\n" + line
            self.version += 1
        return reply


def test_no_page_waits_for_another(
    model_file: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = model_file(LINE)
    monkeypatch.setattr(hub_module, "Outbox", functools.partial(Outbox, patience=3600))

    async def play() -> None:
        hub = Hub(path)
        hub.start()
        try:
            stalled = [hub.join(never) for _ in range(3)]
            page = Page(hub)
            for tab in stalled:
                await hub.hear(tab, {"kind": "open", "id": 1})
            await page.ask("open")
            for k in range(40):
                assert (await page.append(f"# edit {k} {'z' * 20_000}"))["ok"]
                await page.ask("set", values={"w": 1 + k / 40})
            assert json.loads(hub.main.draft.path.read_text())["text"] == page.text
            assert (await page.ask("save"))["kind"] == "saved"
            assert path.read_text() == page.text
            # Of the engine's answers a few wait, and of each state the newest.
            assert all(len(tab.outbox._waiting) <= 12 for tab in stalled)
        finally:
            await hub.stop()

    played(play)


def test_pages_that_are_behind_make_room(
    model_file: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hub_module, "MOST_TABS", 3)
    monkeypatch.setattr(hub_module, "Outbox", functools.partial(Outbox, patience=3600))

    async def play() -> None:
        hub = Hub(model_file(LINE))
        hub.start()
        try:
            stalled = [hub.join(never) for _ in range(3)]
            with pytest.raises(Error, match="3 pages are open"):
                hub.join(never)
            stalled[1].outbox.put(b"z" * (BEHIND + 1))
            new = hub.join(never)
            assert set(hub.tabs) == {stalled[0].number, stalled[2].number, new.number}
            with pytest.raises(Error, match="3 pages are open"):
                hub.join(never)
        finally:
            await hub.stop()

    played(play)


def test_a_page_that_was_dropped_is_told(
    model_file: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = model_file(LINE)
    monkeypatch.setattr(hub_module, "Outbox", functools.partial(Outbox, patience=0.01))

    async def play() -> None:
        hub = Hub(path)
        hub.start()
        try:
            ended = asyncio.Event()
            tab = hub.join(never, ended.set)
            await hub.hear(tab, {"kind": "nonsense", "id": 1})
            await ended.wait()
            assert not hub.tabs
            back = hub.join(never, before=tab.number)
            assert "took nothing" in hub.hello(back)["dropped"]
            assert hub.hello(hub.join(never, before=tab.number))["dropped"] == ""
        finally:
            await hub.stop()

    played(play)


@pytest.mark.parametrize(
    "request_",
    [
        {"kind": "set"},
        {"kind": "set", "values": [1]},
        {"kind": "set", "values": {"w": float("nan")}},
        {"kind": "rename", "name": "\ud800"},
        {"kind": "section", "axis": {"a": 1}},
        {"kind": "push"},
        {"kind": "pull"},
        {"kind": 7},
        {},
    ],
    ids=str,
)
def test_every_request_is_answered_by_its_id(
    model_file: Callable[..., Path], request_: dict[str, Any]
) -> None:
    async def play() -> None:
        hub = Hub(model_file(LINE))
        hub.start()
        try:
            page = Page(hub)
            kind = request_.get("kind")
            answer = await page.ask(kind, **{k: v for k, v in request_.items() if k != "kind"})
            assert answer.get("error") or answer["kind"] in ("pushed", "pulled")
        finally:
            await hub.stop()

    played(play)


# The server itself, as a browser meets it.


def served(path: Path) -> tuple[subprocess.Popen[str], int, str]:
    """The workbench of a model: its process, port and cookie."""
    process = subprocess.Popen(
        [sys.executable, "-m", "moldloft", "view", str(path), "--no-browser"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert process.stdout is not None
    said = ""
    while not (found := re.search(r"http://127\.0\.0\.1:(\d+)/#t=(\S+)", said)):
        line = process.stdout.readline()
        if not line:
            pytest.skip(said)
        said += line
    port = int(found[1])
    home = f"http://127.0.0.1:{port}"
    request = urllib.request.Request(f"{home}/token", found[2].encode(), {"Origin": home})
    with urllib.request.urlopen(request) as response:
        cookie = response.headers["set-cookie"].split(";")[0]
    return process, port, cookie


def stalled_page(port: int, cookie: str) -> socket.socket:
    """A page that joins and never reads."""
    connection = socket.create_connection(("127.0.0.1", port))
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    host = f"127.0.0.1:{port}"
    connection.sendall(
        f"GET /ws HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nCookie: {cookie}\r\n"
        "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode()
    )
    return connection


def joined_page(port: int, cookie: str) -> Any:
    """A page that reads what it is sent."""
    client = pytest.importorskip("websockets.sync.client")
    return client.connect(
        f"ws://127.0.0.1:{port}/ws",
        additional_headers={"Cookie": cookie},
        origin=f"http://127.0.0.1:{port}",
        max_size=None,
    )


def answered(page: Any, number: int) -> dict[str, Any]:
    """The answer to the request of a number."""
    while True:
        data = page.recv(timeout=60)
        message = head_of(data) if isinstance(data, bytes) else json.loads(data)
        if message.get("id") == number:
            return dict(message)


def memory_of(pid: int) -> int:
    """Megabytes of a process and its children."""
    own = int(Path(f"/proc/{pid}/status").read_text().split("VmRSS:")[1].split()[0]) // 1024
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return own + sum(memory_of(int(child)) for child in children)


@pytest.mark.skipif(sys.platform != "linux", reason="memory of a process from /proc")
def test_many_stalled_pages_and_a_looping_one_cost_the_others_nothing(
    model_file: Callable[..., Path],
) -> None:
    path = model_file(LINE, "many.sdl")
    process, port, cookie = served(path)
    stalled = [stalled_page(port, cookie) for _ in range(32)]
    stop = threading.Event()

    def loop() -> None:
        number = 0
        while not stop.is_set():
            # It is dropped when it is too far behind, and joins again.
            with contextlib.suppress(Exception), joined_page(port, cookie) as page:
                while not stop.is_set():
                    number += 1
                    kind = ("hover", "sync", "measure")[number % 3]
                    page.send(json.dumps({"kind": kind, "id": number, "offset": 3}))

    looping = threading.Thread(target=loop)
    looping.start()
    text, waits = LINE, []
    try:
        with joined_page(port, cookie) as page:
            for k in range(60):
                line = f"# edit {k} {'z' * 30_000}"
                update = {"changes": [len(text), [0, "", line]], "clientID": "p"}
                began = time.perf_counter()
                page.send(
                    json.dumps({"kind": "push", "id": k + 1, "version": k, "updates": [update]})
                )
                assert answered(page, k + 1)["ok"]
                waits.append(time.perf_counter() - began)
                text += f"\n{line}"
            page.send(json.dumps({"kind": "save", "id": 1000}))
            assert answered(page, 1000)["kind"] == "saved"
            assert path.read_text() == text
            assert memory_of(process.pid) < 300
    finally:
        stop.set()
        process.send_signal(signal.SIGKILL)
        process.wait()
        process.stdout.close()  # type: ignore[union-attr]
        looping.join(timeout=60)
        for connection in stalled:
            connection.close()
    if SOAK:
        assert sorted(waits)[int(0.95 * len(waits))] < 0.1


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_nothing_is_lost_beside_stalled_pages_when_the_server_is_killed(
    model_file: Callable[..., Path],
) -> None:
    chance = random.Random(11)
    for round_ in range(200 if SOAK else 1):
        path = model_file(LINE, f"killed{round_}.sdl")
        process, port, cookie = served(path)
        stalled = [stalled_page(port, cookie) for _ in range(4)]
        accepted = LINE
        try:
            with joined_page(port, cookie) as page:
                # Requests that are none are answered, and the connection stays.
                for bad in ("nonsense", "[" * 10_000, "7", b"\0"):
                    page.send(bad)
                # Each stalled page would have 6 MB by now.
                count = chance.randrange(1, 40) if SOAK else 200
                for k in range(count):
                    line = f"# edit {k} {'z' * 30_000}"
                    update = {"changes": [len(accepted), [0, "", line]], "clientID": "p"}
                    request = {"kind": "push", "id": k + 1, "version": k, "updates": [update]}
                    page.send(json.dumps(request))
                    assert answered(page, k + 1)["ok"]
                    accepted += f"\n{line}"
                if not SOAK:
                    page.send(json.dumps({"kind": "save", "id": 1000}))
                    assert answered(page, 1000)["kind"] == "saved"
                    assert path.read_text() == accepted
                    page.send(json.dumps({"kind": "push", "id": 2000, "version": count, "updates": [
                        {"changes": [len(accepted), [0, "", "# last"]], "clientID": "p"}
                    ]}))  # fmt: skip
                    assert answered(page, 2000)["ok"]
                    accepted += "\n# last"
        finally:
            process.send_signal(signal.SIGKILL)
            process.wait()
            process.stdout.close()  # type: ignore[union-attr]
            for connection in stalled:
                connection.close()
        again = Hub(path)
        assert again.main.text == accepted
        again.main.draft.close(keep=False)
