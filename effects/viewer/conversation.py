"""The messages between a window and the viewer. The way on which they travel does not matter here.

A window says: draw this; I have shown picture 7; what happened to this pixel? The viewer says: these frames
can be seen; this is the picture; this is the answer.
"""

import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from typing import Any

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.viewer.encoding import Sent, encoded
from fixedpipe.effects.viewer.keeping import Kept, golden_kept, picture_kept, script_kept
from fixedpipe.effects.viewer.studio import Studio
from fixedpipe.effects.viewer.views import View, machine_of, machines, to_object, view_of
from fixedpipe.effects.viewer.worker import Request, Worker

# The most pictures that are sent to a window and not shown yet: the window shows one while the other travels.
IN_FLIGHT = 2
# Connections with fewer bytes a second get deflated pictures; after so many of them raw ones are tried again.
# Measured: deflate handles some 50 MB/s on one core of an AMD EPYC; a slower connection gains by it.
_SLOW, _TRY_AGAIN = 20e6, 40
_FEW = 1 << 16  # a message of fewer bytes does not show how fast the connection is

# (header or message as JSON values, bytes or None): an answer, or the whole message of a picture.
Deliver = Callable[[dict[str, Any], bytes | None], None]


class Conversation:
    """A conversation with one window. ``deliver`` sends to it; several threads call it, one at a time."""

    def __init__(self, studio: Studio, start: View, deliver: Deliver):
        self._studio, self._start, self._deliver = studio, start, deliver
        self._lock = threading.RLock()
        self._worker = Worker(studio, self._tell)
        self._waiting: OrderedDict[str, tuple[int, Any]] = OrderedDict()  # by name: (serial, Picture)
        self._shown: dict[str, Sent] = {}  # by name: the picture that the window has
        self._flying: dict[int, tuple[float, int]] = {}  # number of a picture: time of sending, bytes
        self._number = self._deflate = 0
        self._serial = -1
        self.counted = {"pictures": 0, "bytes": 0, "dropped": 0}
        self._heard = {
            "hello": lambda message, number: self.greet(),
            "draw": self._draw,
            "shown": self._was_shown,
            "about": self._about,
            "history": self._history,
            "registers": self._registers,
            "script": self._script,
            "picture": self._picture,
            "golden": self._golden,
        }

    def greet(self) -> None:
        """Send the list of frames, and which one is shown first. The next pictures are whole ones."""
        with self._lock:
            self._shown.clear()
            self._flying.clear()
            self._send(
                {
                    "say": "hello",
                    "start": to_object(self._start),
                    "subjects": self._studio.subjects.listed(),
                    "machines": {key: profile.name for key, profile in machines().items()},
                }
            )

    def hear(self, message: Any) -> None:
        """Carry out a window's message. If it cannot be done, send a sentence that says why."""
        said = message if isinstance(message, Mapping) else {}
        number = said.get("number")
        number = number if type(number) is int else -1
        try:
            act = self._heard.get(str(said.get("do")))
            if act is None:
                raise Refusal(f"There is no such message; give one of {', '.join(self._heard)} as do.")
            act(said, number)
        except ValueError as error:
            with self._lock:
                self._send({"say": "refused", "number": number, "words": str(error)})

    def close(self, wait: bool = False) -> None:
        """End the window's threads."""
        self._worker.close(wait)

    # ------------------------------------------------------------------------- messages from the window

    def _draw(self, message, number):
        wants = message.get("wants", [])
        if type(wants) is not list or not set(map(str, wants)) <= {"ideal", "reference"}:
            raise Refusal("wants is a list of what follows at rest: ideal, reference.")
        other = message.get("other", "")
        if other:
            machine_of(str(other))
        self._serial = number
        self._worker.ask(Request(number, view_of(message.get("view")), str(other), frozenset(wants)))

    def _was_shown(self, message, number):
        with self._lock:
            sent, size = self._flying.pop(number, (None, 0))
            if sent is not None and size >= _FEW:
                rate = size / max(time.monotonic() - sent, 1e-6)
                self._deflate = _TRY_AGAIN if rate < _SLOW else self._deflate
            if message.get("lost"):  # the window lacks the base, so the next picture is whole
                self._shown.clear()
            self._pump()

    def _about(self, message, number):
        view = view_of(message.get("view"))
        with self._lock:
            self._send({"say": "answer", "number": number, "value": self._studio.about(view)})

    def _history(self, message, number):
        view, at = view_of(message.get("view")), message.get("at")
        if type(at) is not list or len(at) != 2 or not all(type(each) is int for each in at):
            raise Refusal("at is a pixel: a list of column and row, counted from the left top.")
        self._worker.aside("history", number, lambda: self._studio.history(view, (at[0], at[1])))

    def _registers(self, message, number):
        view = view_of(message.get("view"))
        self._worker.aside("registers", number, lambda: self._studio.registers(view))

    def _script(self, message, number):
        view = view_of(message.get("view"))
        self._worker.aside("script", number, lambda: script_kept(self._studio, view))

    def _picture(self, message, number):
        view = view_of(message.get("view"))
        self._worker.aside("picture", number, lambda: picture_kept(self._studio, view))

    def _golden(self, message, number):
        view = view_of(message.get("view"))
        self._worker.aside("golden", number, lambda: golden_kept(self._studio, view))

    # --------------------------------------------------------------------------- messages to the window

    def _tell(self, what, number, content):
        """Send a result. The worker's threads call this."""
        with self._lock:
            if what == "picture":
                name, picture = content
                self.counted["dropped"] += name in self._waiting
                self._waiting[name] = number, picture
                self._pump()
            elif what == "answer" and isinstance(content, Kept):
                self._send({"say": "kept", "number": number, "name": content.name}, content.data)
            else:
                is_sentence = what in ("failed", "refused")
                self._send({"say": what, "number": number, "words" if is_sentence else "value": content})

    def _pump(self):
        """Send waiting pictures, up to IN_FLIGHT at a time."""
        while self._waiting and len(self._flying) < IN_FLIGHT:
            name, (serial, picture) = self._waiting.popitem(last=False)
            self._number += 1
            header = {"say": "picture", "number": self._number, "serial": serial, "name": name}
            data = encoded(picture, self._shown.get(name), header, self._deflate > 0)
            self._deflate = max(0, self._deflate - 1)
            self._shown[name] = Sent(self._number, picture)
            self._flying[self._number] = time.monotonic(), len(data)
            self.counted["pictures"] += 1
            self.counted["bytes"] += len(data)
            self._deliver({"say": "picture"}, data)

    def _send(self, message, data=None):
        self._deliver(message, data)
