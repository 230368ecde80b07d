"""What can be viewed: figures, a frame that a script makes, a frame of a trace.

A subject says which machines draw it, what may be changed of it, and gives its commands. ``mesh_subject`` has
the one that is a mesh of a user's own.
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
    """What a window shows.

    id, title  in a few words
    machines   keys of the machines that draw it, its own first
    panels     labels of its panels, from left to right
    """

    id: str
    title: str
    machines: tuple[str, ...]
    panels: tuple[str, ...]

    def about(self, machine: str) -> dict[str, Any]:
        """JSON values: its texts, its size, and its controls on a machine."""

    def dimensions(self, view: View) -> tuple[int, int]:
        """Width and height of the frame in pixels."""

    def commands(self, view: View, profile: Profile) -> Commands:
        """The whole frame for a machine, or for the ideal beside the view's. Raises ValueError."""

    def reference(self, view: View) -> NDArray[np.float64] | None:
        """What it approximates, float64 [h, w, 4], top row first, alpha 0 where none; None: nothing is."""

    def script(self, view: View) -> tuple[list[str], list[str]]:
        """Lines of Python that import, and that define width, height and commands of ``profile``."""

    def spoken(self, view: View) -> str:
        """What asks for the same after ``fixedpipe figures``; empty where nothing does."""


def check_size(width: int, height: int, profile: Profile) -> None:
    """Raise Refusal for a picture that is larger than a window shows, or than the machine draws."""
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

    given  (name, text) of parameters as the command line set them: files among them are named there alone
    size   a panel's height where a view says none
    """

    figure: Figure
    given: Mapping[str, str] = field(default_factory=dict)
    size: int = 0
    path: str = ""  # of a figure's file of a user's own

    @property
    def id(self) -> str:
        """The figure's."""
        return self.figure.id

    @property
    def title(self) -> str:
        """The figure's."""
        return self.figure.title

    @property
    def machines(self) -> tuple[str, ...]:
        """The figure's."""
        return tuple(key for key in self.figure.machines if key in machines())

    @property
    def panels(self) -> tuple[str, ...]:
        """The figure's."""
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
        """Caption, what must be visible, size and controls."""
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
        """Of panels in a row."""
        return self.figure.dimensions(self._size(view))

    def changes(self, view: View) -> dict[str, Any]:
        """The parameters' values by name: those of the command line, and over them the view's.

        Raises Refusal for a value that is none, and for a file that the command line does not name.
        """
        method, found = self._method(view), {}
        known = self._parameters(method)
        for name, text in {**self.given, **dict(view.values)}.items():
            if name in self.given and name not in known:
                continue  # a parameter of another machine's way
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
        """The figure's scene with the values."""
        return self.figure.commands(profile, self._size(view), self._method(view), **self.changes(view))

    def reference(self, view: View) -> NDArray[np.float64] | None:
        """The figure's."""
        return self.figure.reference_picture(self._size(view), self._method(view), **self.changes(view))

    def _settings(self, view: View) -> dict[str, str]:
        """Texts of the values that differ from the figure's own on the view's machine."""
        known = self._parameters(self._method(view))
        every = {**self.given, **dict(view.values)}
        own = {name: parameter.kind.show(parameter.default) for name, parameter in known.items()}
        return {name: text for name, text in every.items() if name in own and text != own[name]}

    def script(self, view: View) -> tuple[list[str], list[str]]:
        """By the figure's ``commands``."""
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
        """Options of ``fixedpipe figures``, inspect and others."""
        from shlex import quote

        said = [quote(self.path or self.id), "--profile", view.machine, "--size", str(self._size(view))]
        for name, text in self._settings(view).items():
            said += ["--set", quote(f"{name}={text}")]
        return " ".join(said)


def _is_plain(value: Any) -> bool:
    """Whether Python's text of a value is the value: numbers and tuples of them."""
    if type(value) is tuple:
        return all(map(_is_plain, value))
    return value is None or type(value) in (bool, int, float)


@dataclass(frozen=True, eq=False)
class FrameSubject:
    """A frame that is what it is: a script's or a trace's.

    make      (a machine's Profile) -> the frame's commands
    size      width and height, pixels
    own       key of the machine that draws it where nothing is chosen
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
        """All; those that cannot hold the frame refuse it in a sentence."""
        return (self.own, *(key for key in machines() if key != self.own))

    def about(self, machine: str) -> dict[str, Any]:
        """It has no parameters."""
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
        """Its own; it has no other size."""
        if view.size not in (0, self.size[1]):
            raise Refusal(f"{self.id} has {self.size[0]}x{self.size[1]} pixels; leave its size as it is.")
        return self.size

    def commands(self, view: View, profile: Profile) -> Commands:
        """Its own."""
        if view.values:
            raise Refusal(f"{self.id} is a frame without parameters; leave {view.values[0][0]} out.")
        return tuple(self.make(profile))

    def reference(self, view: View) -> None:
        """None."""

    def script(self, view: View) -> tuple[list[str], list[str]]:
        """By what made it."""
        return list(self.imports), [*self.defining, f"width, height = {self.size}"]

    def spoken(self, view: View) -> str:
        """As inspect and passes take it."""
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
        """What a window shows where nothing is chosen."""
        return next(iter(self.named.values()))

    def __getitem__(self, subject_id: str) -> Subject:
        """Raises Refusal for an id that there is not."""
        if subject_id in self.named:
            return self.named[subject_id]
        if self.figures:
            choose("figure", subject_id, FIGURES)
            return _figure_subject(subject_id)
        return choose("frame", subject_id, self.named)

    def listed(self) -> list[str]:
        """The ids of all, in the catalogue's order. No figure's module is imported for it."""
        return list(dict.fromkeys([*self.named, *(FIGURES if self.figures else ())]))


@lru_cache(maxsize=256)
def _figure_subject(subject_id: str) -> FigureSubject:
    return FigureSubject(FIGURES[subject_id])
