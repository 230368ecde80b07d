"""Two threads that draw for a window: one while the user moves something, one when the user rests.

The newest request wins. A newer request replaces a waiting one, and a drawing that would take long is ended
between two commands. So requests never queue up.
"""

import sys
import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.viewer.studio import Studio, Superseded, numbers_of
from fixedpipe.effects.viewer.views import View

# After so many seconds without a newer request the user rests. Assumed: this is longer than the time between
# two moves of a pointer, and too short to notice.
REST = 0.12
# After so many seconds a picture that is not needed any more is dropped. A shorter one is finished; otherwise
# a user who moves the pointer steadily would never see a picture.
_PATIENCE = 0.5


@dataclass(frozen=True)
class Request:
    """A request of a window.

    serial  its number, which every answer repeats
    view    the View to draw
    other   key of a second machine, which draws the same; empty: none
    wants   any of "ideal" and "reference"; they are drawn when the user rests
    """

    serial: int
    view: View
    other: str = ""
    wants: frozenset[str] = frozenset()


# (what, serial, content): "picture" with (name, Picture); "numbers" with a dict; "failed" or "refused" with a
# sentence; "answer" with the value that an aside returned. The serial of an aside is its number.
Tell = Callable[[str, int, Any], None]


class Worker:
    """Draws for one window, and reports the results by ``tell``, which its threads call."""

    def __init__(self, studio: Studio, tell: Tell):
        self._studio, self._tell = studio, tell
        self._changed = threading.Condition()
        self._asked: Request | None = None
        self._drawn: Request | None = None  # the last request that the machine has drawn
        self._followed: Request | None = None
        self._asked_at = 0.0
        self._asides: dict[str, tuple[int, Callable[[], Any]]] = {}
        self._closed = False
        self._threads = [
            threading.Thread(target=self._run, args=(step,), daemon=True, name=f"fixedpipe view {name}")
            for name, step in (("draws", self._draw), ("follows", self._follow))
        ]
        for thread in self._threads:
            thread.start()

    def ask(self, request: Request) -> None:
        """Draw this request, and drop earlier ones."""
        with self._changed:
            self._asked, self._asked_at = request, time.monotonic()
            self._changed.notify_all()

    def aside(self, kind: str, number: int, make: Callable[[], Any]) -> None:
        """Answer with the value that ``make`` returns. It replaces a waiting answer of the same kind."""
        with self._changed:
            self._asides[kind] = number, make
            self._changed.notify_all()

    def close(self, wait: bool = False) -> None:
        """End the threads, and drop what they draw. ``wait``: whether to wait until they have ended."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        if wait:
            for thread in self._threads:
                thread.join()

    def _run(self, step):
        while not self._closed:
            step()

    # Each thread repeats its step. A step waits for work, and does it.

    def _draw(self):
        with self._changed:
            self._changed.wait_for(lambda: self._closed or self._asked is not self._drawn)
            request = self._asked
        if not self._closed and request is not None:
            self._guarded(request.serial, lambda: self._machines(request))
            with self._changed:
                self._drawn = request
                self._changed.notify_all()

    def _machines(self, request):
        begin = time.monotonic()

        def stop():
            late = time.monotonic() - begin > _PATIENCE
            return self._closed or (late and self._asked is not request)

        self._tell("picture", request.serial, ("machine", self._studio.machine(request.view, stop)))
        if request.other and not (self._closed or self._asked is not request):
            beside = request.view.on(request.other)
            self._tell("picture", request.serial, ("other", self._studio.machine(beside, stop)))

    def _follow(self):
        with self._changed:
            self._changed.wait_for(lambda: self._closed or self._asides or self._waits())
            aside = self._asides.pop(next(iter(self._asides))) if self._asides else None
            request, rested = self._drawn, time.monotonic() - self._asked_at
        if self._closed:
            return
        if aside is not None:
            number, make = aside
            self._guarded(number, lambda: self._tell("answer", number, make()), "refused")
        elif rested < REST:
            time.sleep(REST - rested)
        elif request is not None:
            done = self._guarded(request.serial, lambda: self._ideal_and_reference(request))
            with self._changed:
                self._followed = request if done else self._followed

    def _waits(self):
        """Whether ideal and reference of a drawn request are still to be drawn. The caller has the lock."""
        return self._drawn is self._asked and self._drawn is not self._followed

    def _ideal_and_reference(self, request):
        def stop():
            return self._closed or self._asked is not request or bool(self._asides)

        studio, serial, view = self._studio, request.serial, request.view
        if not request.wants:
            return
        drawn, numbers = None, {}
        if "ideal" in request.wants:
            try:
                drawn, ideal, numbers["difference"] = studio.guided(view, stop)
                self._tell("picture", serial, ("ideal", ideal))
            except Refusal as error:
                numbers["no_ideal"] = str(error)
        if drawn is not None:
            numbers |= {"sha256": drawn.facts["sha256"], "shown": drawn.sha256}
            self._tell("numbers", serial, numbers)
        if stop():
            raise Superseded
        if "reference" in request.wants:
            drawn = studio.machine(view, stop) if drawn is None else drawn
            found = studio.reference(view)
            if found is not None:
                picture, exact = found
                numbers["reference_difference"] = numbers_of(drawn, exact, "reference")
                self._tell("picture", serial, ("reference", picture))
            self._tell("numbers", serial, numbers)

    def _guarded(self, number, act, failed="failed"):
        """Call ``act``, and report an error as a sentence. Returns False if the work was superseded."""
        try:
            act()
        except Superseded:
            return False
        except ValueError as error:  # refusals, and states that a machine lacks; their text is a sentence
            self._tell(failed, number, str(error))
        except Exception as error:
            traceback.print_exc(file=sys.stderr)
            said = f"fixedpipe failed: {type(error).__name__}. The terminal that runs the viewer says more."
            self._tell(failed, number, said)
        return True
