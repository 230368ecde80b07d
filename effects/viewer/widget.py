"""The viewer in a notebook: ``FIGURES["F004-4"].view()``. The same page uses the widget's messages."""

from collections.abc import Mapping
from typing import Any

import anywidget
import traitlets

from fixedpipe.effects.figures.figure import Figure
from fixedpipe.effects.refusal import Refusal, refusals
from fixedpipe.effects.viewer.conversation import Conversation
from fixedpipe.effects.viewer.page import module
from fixedpipe.effects.viewer.studio import Picture, Studio
from fixedpipe.effects.viewer.subjects import FigureSubject, Subjects
from fixedpipe.effects.viewer.views import View, to_object, view_of


class Viewer(anywidget.AnyWidget):
    """A window that shows one figure.

    ``state``: the present View, {"id", "machine", "size", "values", "bits", "without", "upto"}, as
    ``views.to_object`` writes it. The user's gestures change it. If code assigns to it, the window changes;
    if the new state cannot be drawn, the window shows a sentence.
    """

    state = traitlets.Dict().tag(sync=True)
    _esm = traitlets.Unicode().tag(sync=True)

    def __init__(self, figure: Figure, start: View, threads: int | None = None):
        self._studio = Studio(Subjects([FigureSubject(figure)], figures=False), threads)
        with refusals():
            self._studio.about(start)
        self._conversation: Conversation | None = None
        self._start = start
        super().__init__(state=to_object(start), _esm=module())
        self.on_msg(self._heard)

    def _heard(self, _, content: Any, buffers: Any) -> None:
        if self._conversation is None:
            self._conversation = Conversation(self._studio, self._start, self._said)
        self._conversation.hear(content)

    def _said(self, message: dict[str, Any], data: bytes | None) -> None:
        self.send(message, None if data is None else [data])

    def picture(self) -> Picture:
        """The machine's picture of ``state``: its codes, uint8 or uint16 [h, w, 4]. Raises Refusal."""
        return self._studio.machine(view_of(self.state))

    def close(self) -> None:
        """End the window and its threads."""
        if getattr(self, "_conversation", None) is not None:
            self._conversation.close()
        super().close()


def view_figure(
    figure: Figure,
    machine: str | None = None,
    size: int | None = None,
    threads: int | None = None,
    values: Mapping[str, Any] | None = None,
) -> Viewer:
    """A Viewer of a figure. The arguments are those of ``Figure.view``. Raises Refusal."""
    key = machine or figure.machines[0]
    with refusals():
        method, texts = figure.method(key), {}
        for name, value in (values or {}).items():
            parameter = figure.offer(name, method)
            texts[name] = parameter.kind.show(parameter.accept(value, f"{figure.id}'s {name}"))
    if size is not None and (isinstance(size, bool) or not isinstance(size, int) or size < 1):
        raise Refusal(f"The size is {size!r}; give a panel's height in pixels.")
    return Viewer(figure, View(figure.id, key, size or 0, tuple(sorted(texts.items()))), threads)
