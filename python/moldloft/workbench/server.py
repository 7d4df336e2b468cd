"""The server: this machine's browsers only, one page, one socket.

Every request is checked for its Host and Origin, so that no page from elsewhere reaches it under
another name; the model is behind a token that the page exchanges for a strict cookie.
"""

from __future__ import annotations

import asyncio
import hmac
import json
import secrets
import socket
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

from moldloft.errors import Error
from moldloft.workbench.address import Address, keep_address, kept_address, proof
from moldloft.workbench.hub import Hub, Tab
from moldloft.workbench.page import page_files
from moldloft.workbench.recent import note_opened

__all__ = ["Server"]

LONGEST_MESSAGE = 16 << 20
IDLE_PING = 30.0
#: Bytes that the system takes for a page.
SEND_BUFFER = 1 << 20

_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".wasm": "application/wasm",
}

_POLICY = (
    "default-src 'self'; connect-src 'self' ws://{host}; img-src 'self' blob: data:; "
    "style-src 'self' 'nonce-{nonce}'; object-src 'none'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'"
)


class Guard:
    """Rejects requests that do not come from the page of this server.

    Parameters
    ----------
    app
        The protected application.
    port
        The port that Host and Origin must name.
    """

    def __init__(self, app: Any, port: int) -> None:
        self._app = app
        self._hosts = {f"127.0.0.1:{port}", f"localhost:{port}"}
        self._origins = {f"http://{host}" for host in self._hosts}

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """ASGI."""
        # A page that does not read has no use for a farewell, which would wait for it.
        transport = getattr(getattr(send, "__self__", None), "transport", None)
        scope["moldloft.abort"] = getattr(transport, "abort", lambda: None)
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        given: dict[str, list[str]] = {}
        for name, value in scope["headers"]:
            given.setdefault(name.decode("latin-1"), []).append(value.decode("latin-1"))
        if self._allowed(scope, given):
            await self._app(scope, receive, send)
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 4403})
        else:
            await Response("refused", status_code=403)(scope, receive, send)

    def _allowed(self, scope: Any, given: dict[str, list[str]]) -> bool:
        origins = given.get("origin", [])
        reads = scope["type"] == "http" and scope["method"] in ("GET", "HEAD")
        site = given.get("sec-fetch-site", ["none"])
        # The page of another model of this machine may go to the frame of this one, which tells
        # nothing without a token.
        navigates = reads and scope["path"] == "/" and given.get("sec-fetch-mode") == ["navigate"]
        sites = ("same-origin", "none", "same-site") if navigates else ("same-origin", "none")
        return (
            len(given.get("host", [])) == 1
            and given["host"][0] in self._hosts
            and all(origin in self._origins for origin in origins)
            and (reads or len(origins) == 1)
            and site[0] in sites
        )


class Server:
    """The workbench of one model.

    Parameters
    ----------
    hub
        The model.
    port
        The port; when 0 that of the model's last server, if it is free, else any free one.
    announce
        Is given the next address when one has been used.
    """

    def __init__(
        self, hub: Hub, port: int = 0, announce: Callable[[str], None] = lambda url: None
    ) -> None:
        self.hub = hub
        self._announce = announce
        self._files = page_files()
        # By its protocol asyncio knows that answers are not to wait for acknowledgements of those
        # before them, which come after 40 ms.
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        # What the system keeps for a page that does not read; unset it grows to several times that.
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
        kept = kept_address(hub.path)
        self._bind(port, kept.port)
        self.port: int = self._socket.getsockname()[1]
        self._token = secrets.token_urlsafe(32)
        self._cookie = f"moldloft-{self.port}"
        self._session = secrets.token_urlsafe(32)
        self._before, hub.secret = kept.secret, secrets.token_urlsafe(32)
        keep_address(hub.path, Address(self.port, hub.secret))
        self._challenge = secrets.token_urlsafe(32)
        self._others: dict[Path, tuple[Server, asyncio.Task[None]]] = {}
        hub.beside = self._beside

    def _bind(self, port: int, preferred: int) -> None:
        """Bind to a port; when that is 0 to the preferred one, and else to any free one."""
        try:
            self._socket.bind(("127.0.0.1", port or preferred))
        except OSError as error:
            if port:
                reason = (error.strerror or str(error)).lower()
                raise Error(f"cannot listen on port {port}: {reason}; choose another one") from None
            self._socket.bind(("127.0.0.1", 0))

    @property
    def url(self) -> str:
        """Address of the page; the token follows the #, which no log records."""
        return f"http://127.0.0.1:{self.port}/#t={self._token}"

    def _beside(self, path: Path) -> str:
        """The address of the page of another model, which is served as long as this one."""
        server, task = self._others.get(path, (None, None))
        if server is None or task is None or task.done():
            hub = Hub(path, self.hub.library, budget=self.hub.budget, memory=self.hub.memory)
            server = Server(hub, announce=self._announce)
            self._others[path] = server, asyncio.ensure_future(server.run())
        return server.url

    def app(self) -> Any:
        """The ASGI application."""
        routes = [
            Route("/", self._index),
            Route("/assets/{name}", self._asset),
            Route("/token", self._exchange, methods=["POST"]),
            Route("/challenge", self._challenged),
            WebSocketRoute("/ws", self._talk),
        ]
        return Guard(Starlette(routes=routes), self.port)

    async def run(self, ready: Callable[[], None] = lambda: None) -> None:
        """Serve until cancelled."""
        import uvicorn

        config = uvicorn.Config(
            self.app(),
            log_level="critical",
            access_log=False,
            server_header=False,
            date_header=False,
            # Compressing takes a hundred times as long as sending.
            ws_per_message_deflate=False,
            ws_max_size=LONGEST_MESSAGE,
            ws_max_queue=32,
            ws_ping_interval=IDLE_PING,
            limit_concurrency=96,
            timeout_keep_alive=10,
            timeout_graceful_shutdown=1,
            lifespan="off",
        )
        server = uvicorn.Server(config)
        self.hub.start()
        note_opened(self.hub.path)
        serving = asyncio.ensure_future(server.serve(sockets=[self._socket]))
        try:
            while not server.started and not serving.done():
                await asyncio.sleep(0.01)
            ready()
            await serving
        finally:
            server.should_exit = True
            for _, task in self._others.values():
                task.cancel()
            await asyncio.gather(*(t for _, t in self._others.values()), return_exceptions=True)
            await self.hub.stop()

    def _headers(self, **more: str) -> dict[str, str]:
        return {
            "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "no-referrer",
            "Cross-Origin-Opener-Policy": "same-origin",
            "Cross-Origin-Resource-Policy": "same-origin",
            **{name.replace("_", "-"): value for name, value in more.items()},
        }

    async def _index(self, request: Request) -> Response:
        nonce = secrets.token_urlsafe(16)
        page = self._files["/index.html"].replace(b"__NONCE__", nonce.encode())
        policy = _POLICY.format(host=request.headers["host"], nonce=nonce)
        headers = self._headers(Content_Security_Policy=policy, Cache_Control="no-store")
        return Response(page, media_type=_TYPES[".html"], headers=headers)

    async def _asset(self, request: Request) -> Response:
        name = request.path_params["name"]
        data = self._files.get(f"/assets/{name}")
        if data is None:
            return Response("not found", status_code=404, headers=self._headers())
        ending = name[name.rfind(".") :]
        # Names have the hash of their content.
        headers = self._headers(
            Cache_Control="public, max-age=31536000, immutable",
            Content_Security_Policy="default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; "
            "connect-src 'self'",
        )
        kind = _TYPES.get(ending, "application/octet-stream")
        return Response(data, media_type=kind, headers=headers)

    async def _exchange(self, request: Request) -> Response:
        body = b""
        async for chunk in request.stream():
            body += chunk
            if len(body) > 200:
                return Response("refused", status_code=403, headers=self._headers())
        response = Response(status_code=204, headers=self._headers())
        if self._known(request.cookies):
            return response
        proved = proof(self._before, self.port, self._challenge)
        if hmac.compare_digest(body, proved.encode()):
            self._challenge = secrets.token_urlsafe(32)
        elif hmac.compare_digest(body, self._token.encode()):
            # A token buys one cookie: who reads it later, in a history or over a shoulder, has
            # nothing.
            self._token = secrets.token_urlsafe(32)
            self._announce(self.url)
        else:
            return Response("refused", status_code=403, headers=self._headers())
        response.set_cookie(self._cookie, self._session, httponly=True, samesite="strict", path="/")
        return response

    async def _challenged(self, request: Request) -> Response:
        """The challenge for a page of the previous server; empty for a known page."""
        known = self._known(request.cookies)
        return Response(
            "" if known else self._challenge, headers=self._headers(Cache_Control="no-store")
        )

    def _known(self, cookies: Mapping[str, str]) -> bool:
        """True if the browser has a session."""
        given = cookies.get(self._cookie, "")
        return hmac.compare_digest(given.encode(), self._session.encode())

    async def _talk(self, socket: WebSocket) -> None:
        if not self._known(socket.cookies):
            await socket.close(4401)
            return
        await socket.accept()
        abort = socket.scope["moldloft.abort"]

        async def send(data: str | bytes) -> None:
            if isinstance(data, str):
                await socket.send_text(data)
            else:
                await socket.send_bytes(data)

        try:
            before = int(socket.query_params.get("before", "0"))
        except ValueError:
            before = 0
        try:
            tab = self.hub.join(send, abort, before=before)
        except Error as error:
            await socket.send_text(json.dumps({"kind": "full", "error": str(error)}))
            await socket.close(4429)
            return
        try:
            await self._listen(socket, tab)
        finally:
            self.hub.leave(tab)

    async def _listen(self, socket: WebSocket, tab: Tab) -> None:
        """Receives messages of a page until it disconnects."""
        tab.outbox.put(json.dumps(self.hub.hello(tab)))
        while (received := await socket.receive())["type"] != "websocket.disconnect":
            await tab.outbox.heard()
            try:
                message = json.loads(received.get("text") or "")
            except (ValueError, RecursionError) as error:
                self.hub.refuse(tab, None, f"not a request: {error}")
                continue
            if isinstance(message, dict):
                await self.hub.hear(tab, message)
            else:
                self.hub.refuse(tab, None, "not a request: expected an object of JSON")
