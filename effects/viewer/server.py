"""The viewer's server: one page and one WebSocket, only for this computer.

It listens on 127.0.0.1. Every address begins with a secret token. The server checks Host and Origin, so no
other page of the same browser can read or control it, and no other host name works. It reads and writes no
file.
"""

import asyncio
import json
import secrets
import socket
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.viewer.conversation import Conversation
from fixedpipe.effects.viewer.page import page
from fixedpipe.effects.viewer.studio import Studio
from fixedpipe.effects.viewer.views import View

HOST = "127.0.0.1"
MOST_WINDOWS = 8
MOST_MESSAGE = 1 << 16  # the most bytes of a window's message
# The most answers that wait for a window. If there are more, the window does not read them, and is closed.
_MOST_WAITING = 200
# Status codes with which a WebSocket closes. Source: RFC 6455, section 7.4.1 (1008, 1013: IANA's registry).
_NOT_ALLOWED, _TRY_LATER = 1008, 1013
_NOTHING = "There is nothing here. Open the whole address that fixedpipe view printed.\n"


class Server:
    """Serves the Views of a Studio.

    start  the View that a window shows first
    port   the port; 0: any free port
    token  the token in the address; None: a new one
    once   whether to end when the last window is closed

    Raises Refusal if the port cannot be used, or the token is short or has other characters than letters,
    digits, - and _.
    """

    def __init__(
        self, studio: Studio, start: View, port: int = 0, token: str | None = None, once: bool = False
    ):
        self.studio, self.start, self.once = studio, start, once
        self.token = _checked(token) if token is not None else secrets.token_urlsafe(18)
        self._socket = _listening(port)
        self.port: int = self._socket.getsockname()[1]
        self._windows: set[Conversation] = set()
        self._uvicorn: uvicorn.Server | None = None

    @property
    def address(self) -> str:
        """The address of the page."""
        return f"http://{HOST}:{self.port}/{self.token}/"

    @property
    def windows(self) -> int:
        """How many windows are open."""
        return len(self._windows)

    def application(self) -> Starlette:
        """The ASGI application."""
        return Starlette(
            routes=[
                Route("/{token}/", self._page, methods=["GET"]),
                WebSocketRoute("/{token}/live", self._live),
            ],
            exception_handlers={404: self._nothing, 405: self._nothing},
        )

    def run(self, ready: Callable[[], None] = lambda: None) -> None:
        """Serve until Ctrl-C or ``end``, or with ``once`` until the last window is closed. First it calls
        ``ready``; the port is open already.
        """
        config = uvicorn.Config(
            self.application(),
            log_level="warning",
            access_log=False,
            lifespan="off",
            ws="websockets-sansio",
            ws_max_size=MOST_MESSAGE,
            ws_per_message_deflate=False,  # pictures are deflated already, or need not be
            server_header=False,
            timeout_graceful_shutdown=1,
        )
        self._uvicorn = uvicorn.Server(config)
        ready()
        try:
            self._uvicorn.run(sockets=[self._socket])
        finally:
            for window in tuple(self._windows):
                window.close()
            self._socket.close()

    def end(self) -> None:
        """Stop serving. Any thread may call this."""
        if self._uvicorn is not None:
            self._uvicorn.should_exit = True

    # ------------------------------------------------------------------------------- allowed requests

    def _refused(self, asked: HTTPConnection) -> bool:
        """Whether a request is refused: it has another host name or no token, or is from another page."""
        names = {f"{name}:{self.port}" for name in (HOST, "localhost")}
        host, origin = asked.headers.get("host", ""), asked.headers.get("origin")
        isolated = asked.headers.get("sec-fetch-site", "none") not in ("same-origin", "none")
        wrong_origin = origin is not None and origin not in {f"http://{name}" for name in names}
        is_page = asked.scope["type"] == "http"
        token = str(asked.path_params.get("token", ""))
        return (
            host not in names
            or wrong_origin
            or (not is_page and origin is None)
            or (not is_page and isolated)
            or not secrets.compare_digest(token.encode(), self.token.encode())
        )

    async def _nothing(self, request: Request, error: Exception) -> Response:
        return PlainTextResponse(_NOTHING, 404, _headers())

    async def _page(self, request: Request) -> Response:
        if self._refused(request):
            return PlainTextResponse(_NOTHING, 404, _headers())
        text, policy = page(f"/{self.token}/live")
        return HTMLResponse(text, headers=_headers() | {"Content-Security-Policy": policy})

    # ---------------------------------------------------------------------------------------- windows

    async def _live(self, live: WebSocket) -> None:
        if self._refused(live):
            await live.close(_NOT_ALLOWED)  # before accept, so the answer is HTTP 403
            return
        await live.accept()
        if len(self._windows) >= MOST_WINDOWS:
            await live.close(_TRY_LATER, f"There are {MOST_WINDOWS} windows already; close one.")
            return
        loop, waiting = asyncio.get_running_loop(), asyncio.Queue[Any]()

        def deliver(message: dict[str, Any], data: bytes | None) -> None:
            with suppress(RuntimeError):  # the loop has ended
                loop.call_soon_threadsafe(waiting.put_nowait, (message, data))

        window = Conversation(self.studio, self.start, deliver)
        self._windows.add(window)
        sending = asyncio.create_task(_send(live, waiting))
        try:
            window.greet()
            while waiting.qsize() < _MOST_WAITING:
                message = await _heard(live)
                window.hear(message)
            await live.close(_NOT_ALLOWED, "This window does not read its answers.")
        except (WebSocketDisconnect, RuntimeError):  # either side has closed it
            pass
        finally:
            sending.cancel()
            window.close()
            self._windows.discard(window)
            if self.once and not self._windows:
                self.end()


async def _heard(live: WebSocket) -> Any:
    """A message as JSON values. None if it is no JSON; ``Conversation.hear`` answers that with a sentence."""
    text = await live.receive()
    if text["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(text.get("code", 1000))
    try:
        return json.loads(text.get("text") or "")
    except (ValueError, RecursionError):
        return None


async def _send(live: WebSocket, waiting: "asyncio.Queue[Any]") -> None:
    with suppress(WebSocketDisconnect, RuntimeError):
        while True:
            message, data = await waiting.get()
            if message["say"] != "picture":
                await live.send_text(json.dumps(message))
            if data is not None:
                await live.send_bytes(data)


def _headers() -> dict[str, str]:
    return {
        "Cache-Control": "no-store",
        "Referrer-Policy": "no-referrer",
        "X-Content-Type-Options": "nosniff",
        "Cross-Origin-Opener-Policy": "same-origin",
        "Cross-Origin-Resource-Policy": "same-origin",
    }


def _checked(token: str) -> str:
    if len(token) < 16 or not token.isascii() or not token.replace("-", "").replace("_", "").isalnum():
        raise Refusal(
            f"The token {token[:40]!r} is no secret; give 16 or more letters, digits, - and _, or leave it "
            "out."
        )
    return token


def _listening(port: int) -> socket.socket:
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((HOST, port))
        listening.listen(16)
    except OSError as error:
        listening.close()
        raise Refusal(
            f"Port {port} of {HOST} cannot be used: {error.strerror}. Give another --port, or leave it out."
        ) from None
    return listening
