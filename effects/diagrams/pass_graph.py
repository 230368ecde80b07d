"""The textures that a frame's passes read and write, found in its commands, for diagrams of these passes.

A ``Step`` is a run of commands that draw into one panel. It ends with the command that stores the panel: a
copy into a texture, or pixels for the host. Its ``Lookup`` names the picture that a command reads, and the
source of the coordinates. The source is the vertices, the texels of another picture (texture shaders), an
image of the host's (pixel textures), or the host itself. A picture is a texture's name and how often it was
written before. So a texture that every step writes anew is another picture each time.

A host step gets black pixels to give its commands. The pixels decide what it draws, but not which passes it
has.

Source: NV_texture_shader (operations that depend on an earlier unit's texel); SGIX_pixel_texture.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum

import numpy as np

from fixedpipe.pipeline.commands import (
    Accum,
    Clear,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    DrawPixels,
    HostStep,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.enums import Register, TextureShaderOperation

# By texels of an earlier unit: offsets too.
_DEPENDENT = (
    TextureShaderOperation.DEPENDENT_AR_TEXTURE_2D,
    TextureShaderOperation.DEPENDENT_GB_TEXTURE_2D,
    TextureShaderOperation.OFFSET_TEXTURE_2D,
)
_TEXTURE_REGISTERS = (Register.TEXTURE0, Register.TEXTURE1, Register.TEXTURE2, Register.TEXTURE3)


class By(Enum):
    """Where a lookup's coordinates come from, if not from a picture."""

    VERTICES = "vertices"
    IMAGE = "an image"
    HOST = "the host"


@dataclass(frozen=True)
class Picture:
    """The contents of a texture, or of the host's copy: its name, and how often the frame has written it
    before.
    """

    name: str
    version: int


@dataclass(frozen=True)
class Lookup:
    """A picture that a command reads; ``coordinates``: a Picture whose texels they are, or By."""

    picture: Picture
    coordinates: "Picture | By"

    @property
    def dependent(self) -> bool:
        """Whether the place is not the vertices'."""
        return self.coordinates is not By.VERTICES


@dataclass(frozen=True, eq=False)
class Step:
    """Commands that draw into a panel one after the other, and the Pictures that store the result.

    commands  in their order
    lookups   what they read, each once
    kept      Pictures of the panel's content after them; none if nothing is stored
    """

    commands: tuple
    lookups: tuple[Lookup, ...]
    kept: tuple[Picture, ...]

    @property
    def dependent(self) -> tuple[Lookup, ...]:
        """The lookups whose coordinates are not the vertices'."""
        return tuple(lookup for lookup in self.lookups if lookup.dependent)


def _of_units(command, version_of):
    """A Lookup for each texture unit of a Draw."""
    state, out = command.state, []
    shader = state.texture_shader or ()
    for number, unit in enumerate(state.texture_units):
        if unit.texture is None:
            continue
        coordinates: Picture | By = By.VERTICES
        if number < len(shader) and shader[number].operation in _DEPENDENT:
            address = state.texture_units[shader[number].previous_texture_input]
            coordinates = version_of(address.texture)
        out.append(Lookup(version_of(unit.texture), coordinates))
    return tuple(out)


def _of_image(command, version_of):
    """Where an image's pixels are a pixel texture's coordinates."""
    if command.pixel_texture is None:
        return ()
    return tuple(Lookup(version_of(unit.texture), By.IMAGE) for unit in command.state.texture_units)


_LOOKUPS = {Draw: _of_units, DrawPixels: _of_image, CopyPixels: _of_image}


def lookups_of(command, version_of):
    """The Lookups of a command. ``version_of``: a texture's name -> its Picture now."""
    found = _LOOKUPS.get(type(command))
    return () if found is None else found(command, version_of)


def textures_combined(combiners):
    """Numbers of the texture units that RegisterCombiners read, ascending."""
    portions = [half for general in combiners.general for half in (general.rgb, general.alpha)]
    last = combiners.final
    inputs = [each for portion in portions for each in (portion.a, portion.b, portion.c, portion.d)]
    inputs += (last.a, last.b, last.c, last.d, last.e, last.f, last.g)
    read = {each.register for each in inputs}
    return tuple(number for number, register in enumerate(_TEXTURE_REGISTERS) if register in read)


def _scissor(scissor):
    """(x, y, width, height) of a scissor, or None: the whole window."""
    return None if scissor is None else _rectangle(scissor)


def _rectangle(box):
    return box.x, box.y, box.width, box.height


def _drawn_box(command):
    """(x, y, width, height) of the part of the window that a Draw may draw into."""
    return _scissor(command.state.scissor) or _rectangle(command.state.vertex.viewport)


# What commands draw into, and what they read of the window.
_DRAWN = {
    Clear: lambda command: _scissor(command.scissor),
    Accum: lambda command: _scissor(command.scissor),
    Draw: _drawn_box,
    DrawPixels: lambda command: _scissor(command.state.scissor),
    CopyPixels: lambda command: _scissor(command.state.scissor),
}
_KEPT = {
    CopyTexImage: lambda command: command.texture,
    CopyTexSubImage: lambda command: command.texture,
    ReadPixels: lambda command: command.name,
}


class _Walk:
    """The steps of one panel, as commands go by."""

    def __init__(self, box):
        self.box, self.versions, self.shapes = box, {}, {}
        self.steps, self.commands, self.lookups, self.kept = [], [], [], []
        self.temporary = frozenset()
        self.takes = {
            HostStep: self._host,
            TexImage: lambda command: self._write(command.texture),
            **dict.fromkeys(_DRAWN, self._draw),
            **dict.fromkeys(_KEPT, self._keep),
        }

    def take(self, command):
        """One more command."""
        self.takes.get(type(command), lambda command: None)(command)

    def end(self):
        """What was drawn so far is a step."""
        if self.commands:
            lookups = tuple(dict.fromkeys(self.lookups))
            self.steps.append(Step(tuple(self.commands), lookups, tuple(self.kept)))
        self.commands, self.lookups, self.kept = [], [], []

    def _version_of(self, name):
        return Picture(name, self.versions.get(name, 0))

    def _write(self, name):
        self.versions[name] = self.versions.get(name, -1) + 1
        return self._version_of(name)

    def _look_up(self, lookups):
        if self.kept:
            self.end()
        self.lookups += (lookup for lookup in lookups if lookup.picture.name not in self.temporary)

    def _draw(self, command):
        if _DRAWN[type(command)](command) == self.box:
            self._look_up(lookups_of(command, self._version_of))
            self.commands.append(command)

    def _keep(self, command):
        if _rectangle(command) == self.box:
            name = _KEPT[type(command)](command)
            # A texture and the host's pixels of one name and step are one picture.
            if self._version_of(name) not in self.kept:
                self.kept.append(self._write(name))
            self.shapes[name] = command.height, command.width, 4

    def _host(self, step):
        """What the host has read is looked up by it, and what it draws then is drawn; the textures that it
        loads for that are no pictures of the frame's.
        """
        self._look_up(Lookup(self._version_of(name), By.HOST) for name in step.reads)
        drawn = tuple(step.commands({name: np.zeros(self.shapes[name], np.uint8) for name in step.reads}))
        self.temporary = frozenset(getattr(command, "texture", None) for command in drawn)
        for command in drawn:
            self.take(command)
        self.temporary = frozenset()


def steps_of(commands: Iterable, panel) -> tuple[Step, ...]:
    """The Steps of a frame's ``commands`` that draw into a ``views.Panel``, in their order.

    Commands that draw elsewhere, or into the whole window, take no part. If the host reads by the name of a
    texture that the same step stored, it reads that picture.
    """
    walk = _Walk((panel.x, panel.y, panel.width, panel.height))
    for command in commands:
        walk.take(command)
    walk.end()
    return tuple(walk.steps)
