"""The subjects that can be viewed: figures, a script's frame, a frame of a trace.

A subject knows which machines draw it and which parameters can be changed, and makes its commands.
``mesh_subject`` has the subject for a user's mesh.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from json import dumps
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.parameters import Parameter
from fixedpipe.effects.refusal import Refusal, choose, refusals
from fixedpipe.effects.viewer.controls import control, is_file
from fixedpipe.effects.viewer.views import MOST_PIXELS, View, machine_of, machines
from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.profiles.profile import Profile

Commands = tuple[Command, ...]


class Subject(Protocol):
    """The subject of a window.

    id, title  its name, and a title of a few words
    machines   keys of the machines that draw it, its own first
    panels     labels of its panels, from left to right
    """

    id: str
    title: str
    machines: tuple[str, ...]
    panels: tuple[str, ...]

    def about(self, machine: str) -> dict[str, Any]:
        """Its texts, its size, and its controls on a machine, as JSON values."""

    def dimensions(self, view: View) -> tuple[int, int]:
        """Width and height of the frame in pixels."""

    def commands(self, view: View, profile: Profile) -> Commands:
        """The whole frame for a machine, or for the ideal that is compared with it. Raises ValueError."""

    def reference(self, view: View) -> NDArray[np.float64] | None:
        """The reference that it approximates, float64 [h, w, 4], top row first; alpha is 0 at pixels without
        a reference. None: it has no reference.
        """

    def script(self, view: View) -> tuple[list[str], list[str]]:
        """(lines of Python that import, lines that define width, height and ``commands_of``)."""

    def spoken(self, view: View) -> str:
        """The arguments of ``fixedpipe figures`` for the same picture; empty if there are none."""


def check_size(width: int, height: int, profile: Profile) -> None:
    """Raise Refusal if a picture is larger than a window shows, or than the machine draws."""
    largest = profile.framebuffers.max_viewport
    if width * height > MOST_PIXELS:
        raise Refusal(f"{width}x{height} pixels are more than a window shows; choose a smaller size.")
    if max(width, height) > largest:
        raise Refusal(
            f"{width}x{height} pixels are more than the {profile.name} draws, {largest}x{largest}; choose a "
            "smaller size."
        )


@dataclass(frozen=True, eq=False)
class FigureSubject:
    """A figure.

    given  {name: text} of the parameters that the command line sets. Only it may name files
    size   a panel's height in pixels, for views without a size
    """

    figure: Figure
    given: Mapping[str, str] = field(default_factory=dict)
    size: int = 0
    path: str = ""  # of the file, if the figure is a user's

    @property
    def id(self) -> str:
        """The figure's id."""
        return self.figure.id

    @property
    def title(self) -> str:
        """The figure's title."""
        return self.figure.title

    @property
    def machines(self) -> tuple[str, ...]:
        """The keys of the figure's machines."""
        return tuple(key for key in self.figure.machines if key in machines())

    @property
    def panels(self) -> tuple[str, ...]:
        """The labels of the figure's panels."""
        return self.figure.panels

    def _size(self, view: View) -> int:
        return view.size or self.size or self.figure.size

    def _method(self, view: View) -> Method:
        with refusals():
            return self.figure.method(view.machine)

    def _parameters(self, method: Method) -> dict[str, Parameter]:
        known = self.figure.parameters_of(method)
        return {name: parameter for name, parameter in known.items() if parameter.offered}

    def about(self, machine: str) -> dict[str, Any]:
        """The caption, what a viewer must see, the size and the controls."""
        method = self._method(View(self.id, machine))
        shown = []
        for name, parameter in self._parameters(method).items():
            text = self.given.get(name, parameter.kind.show(parameter.default))
            made = control(name, parameter, text)
            shown.append(made | {"form": "fixed", "gesture": ""} if is_file(parameter) else made)
        return {
            "caption": self.figure.caption_with(bool(self.given)),
            "must_see": self.figure.must_see,
            "method": method.name,
            "size": self.size or self.figure.size,
            "sizable": True,
            "reference": self.figure.reference is not None,
            "controls": shown,
        }

    def dimensions(self, view: View) -> tuple[int, int]:
        """Width and height in pixels of all panels in a row."""
        return self.figure.dimensions(self._size(view))

    def changes(self, view: View) -> dict[str, Any]:
        """The parameters' values by name. The view's values replace those of the command line.

        Raises Refusal for a value that a parameter cannot have, and for a file that the command line does not
        name.
        """
        method, found = self._method(view), {}
        known = self._parameters(method)
        for name, text in {**self.given, **dict(view.values)}.items():
            if name in self.given and name not in known:
                continue  # another machine's method has this parameter
            with refusals():
                parameter = self.figure.offer(name, method)
                if is_file(parameter) and text != self.given.get(name):
                    raise Refusal(
                        f"{self.id}'s {name} is a file, which a page cannot choose; name it where the viewer "
                        f"is started: --set {name}=FILE."
                    )
                found[name] = parameter.parse(text, f"{self.id}'s {name}")
        with refusals():
            return self.figure.accepted(method, found)

    def commands(self, view: View, profile: Profile) -> Commands:
        """The commands of the figure's scene with these values."""
        return self.figure.commands(profile, self._size(view), self._method(view), **self.changes(view))

    def reference(self, view: View) -> NDArray[np.float64] | None:
        """The figure's reference."""
        return self.figure.reference_picture(self._size(view), self._method(view), **self.changes(view))

    def _settings(self, view: View) -> dict[str, str]:
        """The values, as texts, that differ from the figure's own values on the view's machine."""
        known = self._parameters(self._method(view))
        every = {**self.given, **dict(view.values)}
        own = {name: parameter.kind.show(parameter.default) for name, parameter in known.items()}
        return {name: text for name, text in every.items() if name in own and text != own[name]}

    def script(self, view: View) -> tuple[list[str], list[str]]:
        """Lines of Python that draw by the figure's ``commands``."""
        method = self._method(view)
        imports = ["from fixedpipe.effects.figures import FIGURES"]
        lines = [f"figure = FIGURES[{dumps(self.id)}]"]
        if self.path:
            imports = ["from fixedpipe.effects.reports.own_figures import own_figure"]
            lines = [f"figure = own_figure({self.path!r})"]
        values, size = self.changes(view), self._size(view)
        changes = [
            f"    {dumps(name)}: {values[name] if _is_plain(values[name]) else dumps(text)},"
            for name, text in self._settings(view).items()
        ]
        lines += [
            f"method = figure.method({dumps(view.machine)})  # {method.name}",
            *(["changes = {", *changes, "}"] if changes else ["changes = {}"]),
            f"width, height = figure.dimensions({size})",
            "",
            "",
            "def commands_of(machine):",
            '    """The frame for a machine, or for IDEAL."""',
            f"    return figure.commands(machine, {size}, method, **changes)",
        ]
        return imports, lines

    def spoken(self, view: View) -> str:
        """The arguments of ``fixedpipe figures``, inspect and other commands for the same picture."""
        from shlex import quote

        said = [quote(self.path or self.id), "--profile", view.machine, "--size", str(self._size(view))]
        for name, text in self._settings(view).items():
            said += ["--set", quote(f"{name}={text}")]
        return " ".join(said)


def _is_plain(value: Any) -> bool:
    """Whether ``repr`` of a value is Python code for it: numbers, None, and tuples of them."""
    if type(value) is tuple:
        return all(map(_is_plain, value))
    return value is None or type(value) in (bool, int, float)


@dataclass(frozen=True, eq=False)
class FrameSubject:
    """A frame without parameters: a script's or a trace's.

    make      a function that returns the frame's commands for a machine's Profile
    size      width and height in pixels
    own       key of the machine that draws it if the user chooses none
    imports, defining
              lines of Python that define ``commands_of``, a function of a machine
    """

    id: str
    title: str
    make: Any
    size: tuple[int, int]
    own: str
    imports: tuple[str, ...]
    defining: tuple[str, ...]
    panels: tuple[str, ...] = ("",)

    @property
    def machines(self) -> tuple[str, ...]:
        """The keys of all machines. Those that cannot draw the frame refuse it in a sentence."""
        return (self.own, *(key for key in machines() if key != self.own))

    def about(self, machine: str) -> dict[str, Any]:
        """The data for a page. There are no controls, because the frame has no parameters."""
        machine_of(machine)
        return {
            "caption": self.title,
            "must_see": "",
            "method": "",
            "size": self.size[1],
            "sizable": False,
            "reference": False,
            "controls": [],
        }

    def dimensions(self, view: View) -> tuple[int, int]:
        """The frame's width and height. Raises Refusal for another size."""
        if view.size not in (0, self.size[1]):
            raise Refusal(f"{self.id} has {self.size[0]}x{self.size[1]} pixels; leave its size as it is.")
        return self.size

    def commands(self, view: View, profile: Profile) -> Commands:
        """The frame's commands. Raises Refusal if the view sets a parameter."""
        if view.values:
            raise Refusal(f"{self.id} is a frame without parameters; leave {view.values[0][0]} out.")
        return tuple(self.make(profile))

    def reference(self, view: View) -> None:
        """None: there is no reference."""

    def script(self, view: View) -> tuple[list[str], list[str]]:
        """Lines of Python that make the frame from its script or trace."""
        return list(self.imports), [*self.defining, f"width, height = {self.size}"]

    def spoken(self, view: View) -> str:
        """The arguments of ``fixedpipe inspect`` and passes for the same frame."""
        from shlex import quote

        return f"{quote(self.id)} --profile {view.machine}"


class Subjects:
    """The subjects of a viewer, by id: those that were named, and with ``figures`` all figures of the
    package.
    """

    def __init__(self, named: Iterable[Subject], figures: bool):
        self.named = {subject.id: subject for subject in named}
        self.figures = figures

    @property
    def first(self) -> Subject:
        """The subject that a window shows if the user chooses none."""
        return next(iter(self.named.values()))

    def __getitem__(self, subject_id: str) -> Subject:
        """The subject of an id. Raises Refusal if there is none."""
        if subject_id in self.named:
            return self.named[subject_id]
        if self.figures:
            choose("figure", subject_id, FIGURES)
            return _figure_subject(subject_id)
        return choose("frame", subject_id, self.named)

    def listed(self) -> list[str]:
        """The ids of all subjects, in the catalogue's order. This imports no figure's module."""
        return list(dict.fromkeys([*self.named, *(FIGURES if self.figures else ())]))


@lru_cache(maxsize=256)
def _figure_subject(subject_id: str) -> FigureSubject:
    return FigureSubject(FIGURES[subject_id])
