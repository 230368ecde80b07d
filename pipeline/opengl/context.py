"""A rendering context: it takes OpenGL's calls, and makes the commands that a machine runs.

    gl = Context(GEFORCE_256, 640, 480)
    gl.Clear(tokens.COLOR_BUFFER_BIT)
    gl.Begin(tokens.TRIANGLES)
    ...
    result = Machine(GEFORCE_256, 640, 480).run(gl.take_commands())

A call that is an error in OpenGL is ignored, as in OpenGL, and counted. A call that cannot be carried out
here is refused with a sentence, and counted. Later calls are carried out.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fixedpipe.pipeline.commands import Command, Draw, Mesh
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.arrays import ClientArrays
from fixedpipe.pipeline.opengl.buffers import BufferBindings
from fixedpipe.pipeline.opengl.current import Current, finish_primitive
from fixedpipe.pipeline.opengl.entry_points import EntryPoint, resolve
from fixedpipe.pipeline.opengl.lists import ListNames
from fixedpipe.pipeline.opengl.meshes import Meshes
from fixedpipe.pipeline.opengl.outcomes import GLError, LeftOut, Refused, Tally
from fixedpipe.pipeline.opengl.read_back import Behind
from fixedpipe.pipeline.opengl.selection import Selection, select
from fixedpipe.pipeline.opengl.values import Values
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.state import PassState


@dataclass
class Shared:
    """The objects of contexts in a share group, by their names (sections 3.8.11 and 5.4)."""

    textures: dict[int, Any] = field(default_factory=dict)
    lists: dict[int, tuple[tuple[EntryPoint, tuple[Any, ...]], ...]] = field(default_factory=dict)
    list_names: ListNames = field(default_factory=ListNames)
    buffers: dict[int, Any] = field(default_factory=dict)
    programs: dict[int, Any] = field(default_factory=dict)
    local_parameters: dict[tuple[int, int], tuple[float, ...]] = field(default_factory=dict)
    framebuffers: dict[int, Any] = field(default_factory=dict)
    renderbuffers: dict[int, Any] = field(default_factory=dict)


@dataclass
class Drawable:
    """A window or pbuffer. A machine of its own draws into it.

    - ``double``: whether it has a back buffer.
    - ``stored``: {number of a texture object: the version of it that this drawable's machine has}.
    """

    width: int
    height: int
    double: bool = True
    stored: dict[int, int] = field(default_factory=dict)


class Context:
    """OpenGL's state machine for ``profile``, drawing into a window of ``width`` x ``height`` pixels.

    Every entry point is a method, without its prefix gl: ``gl.Vertex3f(0, 0, 0)``. ``call`` takes its name.
    """

    def __init__(self, profile: Profile, width: int, height: int, *, shared: Shared | None = None):
        self.profile = profile
        self.drawable = Drawable(width, height)
        self.window = self.drawable  # framebuffer 0, even while a framebuffer object is bound
        self.shared = shared if shared is not None else Shared()
        self.tally = Tally()
        self.error = 0  # the error that GetError returns
        self.called = ""  # the name of the present call
        self.recorded_result: Any = None  # the call's result in the recording; None outside traces
        self.behind: Behind | None = None  # the machine, if calls may read its results in mid-frame
        self.samples_passed: dict[int, int] = {}  # the counts of occlusion queries, by name
        self.commands: list[Command] = []
        self.drawing = True  # False: nobody wants commands any more, only the state
        self.current = Current()
        self.buffers = BufferBindings()
        self.arrays = ClientArrays()
        self.meshes = Meshes()
        self.selection = Selection()
        self.begun: list[Any] | None = None  # between Begin and End, the vertices so far
        self.begun_mode = 0
        self.begun_materials: list[Any] | None = (
            None  # materials that changed since Begin (material_changes.py)
        )
        self.list: list[tuple[EntryPoint, tuple[Any, ...]]] | None = None  # the display list being compiled
        self.list_name = self.list_mode = 0
        self.nesting = self.listed_calls = 0  # depth of nested CallLists, and how many calls they made
        self.values = Values(self)
        self._state: PassState | None = None
        self._state_generation = -1
        self._resolved: dict[str, EntryPoint | None] = {}

    # ---------------------------------------------------------------------------------------------- calls

    def call(self, name: str, arguments: tuple[Any, ...] | list[Any] = (), result: Any = None) -> Any:
        """Carry out a call of the entry point ``name`` ("glVertex3f"), and return its result.

        ``result`` is the result in the recording. It is used if only the recorded program's driver could know
        it, such as the address of a mapped buffer.
        """
        try:
            point = self._resolved[name]
        except KeyError:
            point = self._resolved[name] = resolve(name)
        self.called = name
        if point is None:
            self.tally.add("unknown", name)
            return None
        self.recorded_result = result
        try:
            if point.capture is not None:
                arguments = self._answer(point.capture, arguments)
            if self.list is not None and point.compiled:
                # The list holds copies, so that later changes by the caller do not affect it.
                self.list.append((point, tuple([_kept(argument) for argument in arguments])))
                if self.list_mode == tokens.COMPILE:
                    return None
            return self.execute(point, arguments)
        except GLError as error:
            self.record_error(error)
        except Refused as refusal:
            self.tally.add("refused", f"{name}: {refusal}")
        except LeftOut as reason:
            self.tally.add("left out", f"{name}: {reason}")
        return None

    def execute(self, point: EntryPoint, arguments: tuple[Any, ...] | list[Any]) -> Any:
        """Carry out a call whose client memory has been read. Display lists use this, too."""
        if self.begun is not None and not point.inside:
            raise GLError(tokens.INVALID_OPERATION, f"{point.name} is called between Begin and End")
        return self._answer(point.handler, arguments)

    def _answer(self, function: Any, arguments: tuple[Any, ...] | list[Any]) -> Any:
        try:
            return function(self, *arguments)
        except (TypeError, ValueError, IndexError, KeyError, OverflowError, AttributeError) as error:
            # A damaged trace may have other values in place of a call's arguments.
            raise Refused(f"its arguments cannot be read ({type(error).__name__}: {error})") from error

    def record_error(self, error: GLError) -> None:
        """Count an error. The first one is stored for GetError."""
        self.error = self.error or error.kind
        said = f"{self.called}: {tokens.name_of(error.kind)}"
        self.tally.add("error", f"{said}, {error}" if str(error) else said)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or resolve("gl" + name) is None:
            raise AttributeError(f"OpenGL has no entry point gl{name} here.")
        full = "gl" + name

        def entry_point(*arguments: Any) -> Any:
            return self.call(full, arguments)

        return entry_point

    # ------------------------------------------------------------------------------------------- commands

    def state(self) -> PassState:
        """The state that a Draw would have now. Equal states are the same object."""
        if self._state is None or self._state_generation != self.values.generation:
            self._state = self.values.section("pass")
            self._state_generation = self.values.generation
        return self._state

    def take_commands(self) -> tuple[Command, ...]:
        """The commands since the last call of this method. The Context no longer has them."""
        commands = tuple(self.commands)
        self.commands.clear()
        return commands

    def draw(self, mode: int, columns: dict[str, Any], indices: Any = None) -> None:
        """Draw a primitive of ``mode`` (a token) whose vertices are ``columns``, a Mesh's arguments by name.

        Vertices of an incomplete primitive at the end are left out. Raises LeftOut if a number is infinite or
        NaN, and GLError for an unknown mode.
        """
        finish_primitive(self, mode, columns, indices)

    def leaves_out_draws(self) -> bool:
        """Whether primitives change nothing: nobody wants commands, and none are selected or fed back."""
        return not self.drawing and self.values["render_mode"] == tokens.RENDER

    def select(self, mesh: Mesh) -> None:
        """Do what a draw of ``mesh`` does in selection or feedback."""
        select(self, mesh)

    def emit_draw(self, mesh: Mesh, state: PassState) -> None:
        """Add a Draw. First store the textures that the state reads, if the machine has other versions."""
        self.store_textures(state)
        self.tally.add("drawn", self.called)
        self.commands.append(Draw(label=f"{self.called} (call {self.tally.call})", mesh=mesh, state=state))

    def store_textures(self, state: PassState) -> None:
        """Add a TexImage for each texture of ``state`` whose present version the drawable's machine lacks."""
        from fixedpipe.pipeline.opengl.texturing import store_textures

        store_textures(self, state)


def _kept(argument):
    """An argument, or a copy of it if the caller could change it."""
    return argument.copy() if isinstance(argument, list | np.ndarray) else argument
