"""A figure as data: its subject, its source, how each machine draws it, and its checks as code.

A figure's scene is one tuple of commands that draws a row of equal panels. So it can be printed, validated,
rendered on any machine and compared. A ``Method`` is for machines that must draw it in another way.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from importlib import import_module
from importlib.util import find_spec
from inspect import signature
from numbers import Integral
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Concatenate, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.must_see import sentences
from fixedpipe.effects.figures.displayed_checks import displayed_checks
from fixedpipe.effects.figures.parameters import Parameter
from fixedpipe.effects.figures.rendering import Rendering
from fixedpipe.effects.geometry.views import panel_width
from fixedpipe.effects.refusal import Refusal, nearest
from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.framebuffers.result import Result
from fixedpipe.pipeline.ideal.result import IdealResult
from fixedpipe.pipeline.interned_commands import in_common
from fixedpipe.pipeline.profiles import IDEAL, PROFILES
from fixedpipe.pipeline.profiles.profile import Profile

if TYPE_CHECKING:
    from fixedpipe.pipeline.execution.machine import Watch

# Parameters of a scene that leave the highlight alone.
DARK = {"diffuse": (0.0, 0.0, 0.0), "ambient": (0.0, 0.0, 0.0), "background": (0.0, 0.0, 0.0)}
# Machines with two or more general combiners; the first is the one that the paper used.
COMBINER_MACHINES = ("GEFORCE_256", "GEFORCE_3", "NV2A", "FUTURE")
# Machines with a colour matrix, colour tables and subtractive blending.
IMAGING_MACHINES = ("OCTANE", "INFINITE_REALITY", "OPENGL_1_2_IMAGING")
# Those of them with eight bits of colour, for figures that load thousands of polygons: with twelve F004-4
# takes 20 s (Measured).
IMAGING_MACHINES_8 = ("OCTANE", "OPENGL_1_2_IMAGING")
# Diagrams (fixedpipe.effects.diagrams.drawing) need nothing that a machine lacks; these stand for the others.
DIAGRAM_MACHINES = ("OPENGL_1_2", "GEFORCE_256")

# (profile, size, **parameters) -> commands for a framebuffer of the figure's dimensions.
Scene: TypeAlias = Callable[Concatenate[Profile, int, ...], tuple[Command, ...]]
# (figure, renderer) -> its Checks, in a tuple or one after the other.
Acceptance: TypeAlias = Callable[["Figure", "Renderer"], Iterable[Check]]
# (size, **parameters) -> RGBA float64 [height, width, 4] of the figure's dimensions, top row first, 1.0 =
# full; alpha 0 where a panel has no reference.
Reference: TypeAlias = Callable[Concatenate[int, ...], NDArray[np.float64]]
# As of ``execute`` and ``execute_ideal`` of ``fixedpipe.pipeline``.
Execute: TypeAlias = Callable[[tuple[Command, ...], Profile, int, int], Result]
ExecuteIdeal: TypeAlias = Callable[[tuple[Command, ...], int, int], IdealResult]


@dataclass(frozen=True, eq=False)
class Method:
    """One way to draw a figure.

    name        in the words of a caption: "register combiners"
    scene       draws it: a Scene
    machines    keys in ``fixedpipe.pipeline.profiles.PROFILES`` of the machines that draw it so
    values      where it differs from the figure's own: a parameter's name to its value
    parameters  what this way alone has
    """

    name: str
    scene: Scene
    machines: tuple[str, ...]
    values: Mapping[str, Any] = field(default_factory=dict)
    parameters: Mapping[str, Parameter] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", MappingProxyType(dict(self.values)))
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))


@dataclass(frozen=True, kw_only=True, eq=False)
class Figure:
    """A figure as data.

    id           the catalogue's: F<document>-<number>, or a technique's
    title        what it is, in a few words
    caption      what is shown
    must_see     what must be visible for the figure to be right
    source       key in docs/bibliography.bib; "" if no paper has the figure
    techniques   the catalogue's ids of the techniques used
    panels       a label of each panel, from left to right. The machine does not draw the labels; pages and
                 sheets that show the figure do
    parts        labels of the Draws that must be visible, as ``parts_check`` tests
    compared     numbers, from 1, of the panels whose pixels a check compares with the reference's
    shown_by     for each sentence of ``must_see`` the names of the checks that fail where it is untrue, in a
                 tuple. Of a check in a data file, the name is the table's, with its fields
    size         default height of a panel, pixels
    aspect       a panel's width to its height, as whole numbers: (8, 5)
    parameters   its Parameters by name; ``commands`` takes other values by these names
    methods      the ways to draw it, the paper's first. A machine is in one of them at most
    acceptance   its checks: an Acceptance
    reference    a Reference: what its algorithm approximates, computed without that algorithm; None if the
                 ideal of the same commands is the reference
    """

    id: str
    title: str
    caption: str
    must_see: str
    source: str
    techniques: tuple[str, ...]
    panels: tuple[str, ...] = ("",)
    parts: tuple[str, ...] = ()
    compared: tuple[int, ...] = ()
    shown_by: tuple[tuple[str, ...], ...] = ()
    size: int = 512
    aspect: tuple[int, int] = (1, 1)
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    methods: tuple[Method, ...]
    acceptance: Acceptance
    reference: Reference | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        if len(self.panels) > 1 and not all(self.panels):
            raise ValueError(f"{self.id} has {len(self.panels)} panels; give each a label: {self.panels}.")
        if not (len(self.aspect) == 2 and all(isinstance(n, int) and n >= 1 for n in self.aspect)):
            raise ValueError(f"{self.id}'s aspect is {self.aspect!r}; give width and height, whole numbers.")
        if self.compared and (
            self.reference is None or not {*self.compared} <= {*range(1, self.columns + 1)}
        ):
            raise ValueError(
                f"{self.id} compares the panels {self.compared} with its reference; name panels from 1 to "
                f"{self.columns}, and give it a reference."
            )
        if self.shown_by and len(self.shown_by) != len(sentences(self.must_see)):
            raise ValueError(
                f"{self.id} says for {len(self.shown_by)} sentences which checks show them, and its must-see "
                f"has {len(sentences(self.must_see))}; give each sentence its checks."
            )
        for name, parameter in self.parameters.items():
            if not isinstance(parameter, Parameter):
                raise ValueError(
                    f"{self.id}'s parameter {name} is {parameter!r}; declare what it is by a word of "
                    "fixedpipe.effects.figures.parameters."
                )
        for method in self.methods:
            try:
                signature(method.scene).bind(None, None, **self.values_of(method))
            except TypeError as error:
                raise ValueError(
                    f"{self.id}'s parameters are {', '.join(self.parameters_of(method)) or 'none'}, and its "
                    f"way by {method.name} takes others ({error}). Declare each that the scene takes, and no "
                    "other."
                ) from None
        if len(set(self.machines)) < len(self.machines) or not set(self.machines) <= set(PROFILES):
            raise ValueError(f"{self.id} names a machine twice, or one that is not known: {self.machines}.")

    @property
    def columns(self) -> int:
        """How many panels there are, side by side."""
        return len(self.panels)

    @property
    def machines(self) -> tuple[str, ...]:
        """Keys in ``fixedpipe.pipeline.profiles.PROFILES`` of machines that can draw it, its own first."""
        return tuple(key for method in self.methods for key in method.machines)

    @property
    def values(self) -> Mapping[str, Any]:
        """The parameters' own values, by name."""
        return {name: parameter.default for name, parameter in self.parameters.items()}

    def method(self, machine: str) -> Method:
        """The Method of a machine, by the machine's key; the ideal, which can do all, has the first
        machine's.

        Raises ValueError where it cannot.
        """
        if machine in PROFILES and PROFILES[machine].arithmetic.exact:
            return self.methods[0]
        for method in self.methods:
            if machine in method.machines:
                return method
        raise ValueError(f"{self.id} cannot be drawn on {machine}; it can on {', '.join(self.machines)}.")

    def method_for(self, profile: Profile) -> Method:
        """The Method of a machine. A changed machine has that of its original, and the ideal has the figure's
        first.

        Raises ValueError where it cannot.
        """
        origin: Profile | None = profile
        while origin is not None:
            for key, known in PROFILES.items():
                if origin == known:
                    return self.method(key)
            origin = origin.changed_from or origin.ancestor
        raise ValueError(
            f"{profile.name} is made from no machine that is known, so {self.id} has no way to be drawn on "
            f"it; give one of its methods, as method=FIGURES[{self.id!r}].methods[0]."
        )

    def parameters_of(self, method: Method) -> Mapping[str, Parameter]:
        """What may be changed where it is drawn in that way, with the defaults that it then has."""
        every = {**self.parameters, **method.parameters}
        return {name: replace(p, default=method.values.get(name, p.default)) for name, p in every.items()}

    def values_of(self, method: Method) -> Mapping[str, Any]:
        """The values of ``parameters_of``."""
        return {name: parameter.default for name, parameter in self.parameters_of(method).items()}

    def parameter(self, name: str, method: Method) -> Parameter:
        """What may be changed under that name where the figure is drawn in that way.

        Raises ValueError, which names what there is, for another name.
        """
        known = self.parameters_of(method)
        if name in known:
            return known[name]
        offered = [key for key, parameter in known.items() if parameter.offered]
        if not offered:
            raise ValueError(f"{self.id} has no parameters, so {name!r} cannot be changed.")
        others = [key for m in self.methods if name in m.parameters for key in m.machines]
        there = f" on {', '.join(method.machines)}; it has on {', '.join(others)}" if others else ""
        raise ValueError(
            f"{self.id} has no parameter {name!r}{there}.{nearest(name, offered)} "
            f"There are: {', '.join(offered)}."
        )

    def offer(self, name: str, method: Method) -> Parameter:
        """``parameter``, where users may set it.

        Raises ValueError where checks alone do, with the reason, and as ``parameter``.
        """
        found = self.parameter(name, method)
        if not found.offered:
            raise ValueError(f"{self.id}'s {name} is for its checks alone: {found.does}")
        return found

    def accepted(self, method: Method, changes: Mapping[str, Any]) -> dict[str, Any]:
        """Other values of parameters as the method's scene takes them.

        Raises ValueError for a name or a value that is none, and for one that would be ignored.
        """
        taken = {
            name: self.parameter(name, method).accept(value, f"{self.id}'s {name}")
            for name, value in changes.items()
        }
        for name in taken:
            of = self.parameter(name, method).of
            if of and taken.get(of) is None:
                raise ValueError(f"{self.id}'s {name} would be ignored: it is of {of}; give {of} too.")
        return taken

    def said(self, method: Method, changes: Mapping[str, Any]) -> str:
        """Accepted values as the command line takes them: "alpha_x=0.15 light=1,1,1"."""
        known = self.parameters_of(method)
        return " ".join(f"{name}={known[name].kind.show(value)}" for name, value in changes.items())

    def caption_with(self, changed: bool) -> str:
        """The caption; where something was ``changed``, it says that it is the unchanged figure's."""
        return f"The figure with its own values: {self.caption}" if changed else self.caption

    def dimensions(self, size: int | None = None) -> tuple[int, int]:
        """Width and height of the framebuffer in pixels for panels of ``size``.

        Raises ValueError for a size that is no whole number from 1.
        """
        edge = self.size if size is None else size
        if isinstance(edge, bool) or not isinstance(edge, Integral) or edge < 1:
            raise ValueError(
                f"The size of {self.id} is {size!r}; give a panel's height in whole pixels, from 1."
            )
        return self.columns * self.panel_width(int(edge)), int(edge)

    def panel_width(self, size: int) -> int:
        """Of a panel ``size`` pixels high, in pixels."""
        return panel_width(size, self.aspect)

    def commands(
        self, profile: Profile | str, size: int | None = None, method: Method | None = None, **changes: Any
    ) -> tuple[Command, ...]:
        """The scene with the figure's own parameters, some replaced.

        profile  the machine, as a value or a key of ``PROFILES``: one that can draw the figure, such a
                 machine changed, or the ideal
        size     a panel's height in pixels; None: the figure's own
        method   one of ``methods``; None: the machine's (the ideal's: the first)
        changes  other values of parameters, by name

        Raises ValueError for a machine that cannot draw it, and for an unknown machine, size, method,
        parameter or parameter's value. The sentence says what there is.
        """
        machine = self._machine(profile)
        if method is None:
            method = self.method_for(machine)
        elif not isinstance(method, Method):
            raise ValueError(
                f"The method is {method!r}; leave it out, and {self.id} is drawn as the machine draws it, or "
                f"give one of FIGURES[{self.id!r}].methods."
            )
        _, edge = self.dimensions(size)
        changes = self.accepted(method, changes)
        if not changes:
            return _own_scene(self, method, machine, edge)
        try:
            return method.scene(machine, edge, **self._scene_values(method, changes))
        except ValueError as error:
            raise ValueError(f"{self.id} with {self.said(method, changes)}: {error}") from error

    def render(
        self,
        profile: Profile | str,
        size: int | None = None,
        *,
        method: Method | None = None,
        threads: int | None = None,
        watch: Callable[[tuple[Command, ...]], "Watch"] | None = None,
        **changes: Any,
    ) -> Rendering:
        """The figure drawn on a machine, and the ideal of the same fragments: a Rendering.

        profile, size, method, changes  as for ``commands``. ``IDEAL`` gives the ideal's own picture
        threads                         how many threads; None: one per processor. The bits are the same for
                                        any number
        watch                           a function from the commands to the function that ``execute`` calls
                                        after each; for a machine only

        Raises ValueError as ``commands`` does, for a parameter that only checks change, and for state that
        the machine lacks (UnsupportedState).
        """
        from fixedpipe.pipeline.execution.machine import execute
        from fixedpipe.pipeline.ideal.evaluate import execute_ideal

        machine = self._machine(profile)
        commands = self.commands(machine, size, method, **changes)
        way = self.method_for(machine) if method is None else method
        changes = self.accepted(way, changes)
        for name in changes:
            self.offer(name, way)
        width, height = self.dimensions(size)
        result: Result | IdealResult
        if machine.arithmetic.exact:
            result = execute_ideal(commands, width, height, threads=threads)
        else:
            # The run that records what the ideal is guided by draws the picture as well.
            seen = False if watch is None else watch(commands)
            result = execute(commands, machine, width, height, threads=threads, record=True, trace=seen)
        return Rendering(self, machine, way, height, changes, result, threads)

    def view(
        self,
        profile: str | None = None,
        size: int | None = None,
        *,
        threads: int | None = None,
        **changes: Any,
    ) -> Any:
        """The figure in a notebook, drawn live: a widget with sliders, machines, passes and pixels, as the
        page of ``fixedpipe view`` (docs/viewer.md). Its ``state`` describes what is shown, and changes it.

        profile  key of the machine; None: the figure's own
        size     a panel's height in pixels; None: the figure's own
        threads  as for ``render``
        changes  other values of parameters, by name

        Raises Refusal, a ValueError, as ``render`` does, and where anywidget is not installed.
        """
        if find_spec("anywidget") is None:
            raise Refusal("A figure in a notebook needs anywidget; install fixedpipe[view].")
        # By name: the viewer stands above figures, and knows them.
        widget = import_module("fixedpipe.effects.viewer.widget")
        return widget.view_figure(self, profile, size, threads, changes)

    def reference_picture(
        self, size: int | None = None, method: Method | None = None, **changes: Any
    ) -> NDArray[np.float64] | None:
        """What the algorithm approximates, by ``reference``, of the figure's parameters and the method's own:
        RGBA float64 [height, width, 4], top row first, 1.0 = full, alpha 0 where a panel has none. None where
        the figure has no reference. It is not to be written to. With the
        figure's own values it is computed once for all machines.

        size     a panel's height in pixels; None: the figure's own
        method   one of ``methods``, whose values of parameters it takes; None: the first
        changes  other values of parameters, by name

        Raises ValueError as ``commands`` does.
        """
        if self.reference is None:
            return None
        method = self.methods[0] if method is None else method
        width, height = self.dimensions(size)
        values = self._scene_values(method, self.accepted(method, changes))
        named = (*self.parameters, *method.parameters)
        of = self.reference, height, repr([(name, values[name]) for name in named])
        for *made_of, picture in () if changes else tuple(_REFERENCES):
            if made_of == [*of]:
                return picture
        picture = self.reference(height, **{name: values[name] for name in named})
        if picture.shape != (height, width, 4):
            raise ValueError(
                f"{self.id}'s reference has the shape {picture.shape}; it must be {(height, width, 4)}."
            )
        if not np.isfinite(picture).all():
            y, x, channel = np.argwhere(~np.isfinite(picture))[0].tolist()
            raise ValueError(
                f"{self.id}'s reference holds {picture[y, x, channel]} at column {x}, row {y}; give finite "
                "colours, and alpha 0 where there is none."
            )
        picture.flags.writeable = False
        if not changes:  # a text says all of the figure's own values, and not of an array that a user gives
            _REFERENCES.append((*of, picture))
        return picture

    def _scene_values(self, method: Method, changes: Mapping[str, Any]) -> dict[str, Any]:
        """All that the scene is given: what is changed before what that brings, and that before its own."""
        values, known = dict(self.values_of(method)), self.parameters_of(method)
        for name, value in changes.items():
            values |= {n: v for n, v in known[name].brings(value).items() if n in values}
        return values | dict(changes)

    def _machine(self, profile: object) -> Profile:
        return profile if isinstance(profile, Profile) else self._machine_called(profile)

    def _machine_called(self, profile: object) -> Profile:
        there = f"{self.id} can be drawn on {', '.join(self.machines)}, and as IDEAL"
        if not isinstance(profile, str):
            raise ValueError(f"The machine is {profile!r}; give its name or its Profile. {there}.")
        if profile not in PROFILES:
            raise ValueError(f"There is no machine {profile!r}.{nearest(profile, PROFILES)} {there}.")
        return PROFILES[profile]

    def checks(self, renderer: "Renderer") -> tuple[Check, ...]:
        """The figure's acceptance checks, rendered by a ``Renderer``: a tuple of Check."""
        return tuple(self.each_check(renderer))

    def each_check(self, renderer: "Renderer") -> Iterator[Check]:
        """``checks``, each measured when it is needed: those of every displayed picture
        (``displayed_checks``), then the figure's own.
        """
        yield from displayed_checks(self, renderer)
        yield from self.acceptance(self, renderer)


# The figures' own scenes that were made last: figure, method, machine, size and commands. A machine's picture
# and its checks are of the same one, and the ideal's on one machine after the other.
_MADE: deque[tuple[Figure, Method, Profile, int, tuple[Command, ...]]] = deque(maxlen=3)


# References with figures' own values that were computed last: function, height, values and picture. All
# machines of a method have the same.
_REFERENCES: deque[tuple[Reference, int, str, NDArray[np.float64]]] = deque(maxlen=3)


def _own_scene(figure: Figure, method: Method, machine: Profile, edge: int) -> tuple[Command, ...]:
    """A figure's commands with its own parameters. Machines share those that are equal."""
    others: tuple[Command, ...] = ()
    for made in tuple(_MADE):
        if (made[0], made[1], made[3]) == (figure, method, edge):
            if made[2] is machine:
                return made[4]
            others = made[4]
    commands = in_common(method.scene(machine, edge, **figure.values_of(method)), others)
    _MADE.append((figure, method, machine, edge, commands))
    return commands


@dataclass(frozen=True, eq=False)
class Renderer:
    """Gives checks the pictures that they measure: a machine, its Method, and ``execute`` and
    ``execute_ideal`` of ``fixedpipe.pipeline``.

    Checks measure windows, not pictures: [y, x] are window coordinates, so row 0 is at the bottom and y grows
    upwards as in the equations. They are drawn once, and are read-only. ``kept``: the ideal's, which machines
    that draw in the same way share.
    """

    profile: Profile
    method: Method
    execute: Execute
    execute_ideal: ExecuteIdeal
    kept: dict[object, NDArray[np.float64]] = field(default_factory=dict)
    _of_the_machine: dict[object, NDArray[np.float64]] = field(default_factory=dict, init=False)

    def machine_window(self, figure: Figure, size: int, /, **changes: Any) -> NDArray[np.float64]:
        """RGB float64 [size, columns * size, 3] of the machine's window, 1.0 = full."""

        def draw() -> NDArray[np.float64]:
            commands = figure.commands(self.profile, size, self.method, **changes)
            framebuffer = self.execute(commands, self.profile, *figure.dimensions(size)).framebuffer
            return framebuffer.color[::-1, :, :3] / (2.0**framebuffer.color_bits - 1.0)

        return self._once(self._of_the_machine, draw, figure, size, changes)

    def window(self, answer: Answer, figure: Figure, size: int, /, **changes: Any) -> NDArray[np.float64]:
        """That answer's window, ``machine_window`` or ``ideal_window``: RGB float64 [size, columns * size,
        3].
        """
        draw = {Answer.MACHINE: self.machine_window, Answer.IDEAL: self.ideal_window}[answer]
        return draw(figure, size, **changes)

    def ideal_window(self, figure: Figure, size: int, /, **changes: Any) -> NDArray[np.float64]:
        """RGB float64 [size, columns * size, 3] of the free ideal's window."""

        def draw() -> NDArray[np.float64]:
            commands = figure.commands(IDEAL, size, self.method, **changes)
            return self.execute_ideal(commands, *figure.dimensions(size)).color[::-1, :, :3]

        return self._once(self.kept, draw, figure, size, changes)

    def _once(
        self,
        windows: dict[object, NDArray[np.float64]],
        draw: Callable[[], NDArray[np.float64]],
        figure: Figure,
        size: int,
        changes: Mapping[str, Any],
    ) -> NDArray[np.float64]:
        """What ``draw`` gave, of ``windows``."""
        key = figure, self.method, size, repr(sorted(changes.items()))
        if key not in windows:
            window = windows[key] = draw()
            window.flags.writeable = False
        return windows[key]
