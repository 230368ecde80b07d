"""Which textures the passes of a frame read and leave, found in its commands, for diagrams of what runs.

A ``Step`` is a run of commands that draw into one panel, to the command that keeps what it shows: a copy into
a texture, or pixels for the host. Its ``Lookup`` says which picture a command reads and where the coordinates
come from: the vertices, the texels of another picture (texture shaders), an image of the host's (pixel
textures), or the host itself. A picture is a texture's name and how often it has been written before, so that
a texture that is kept anew for every step is another picture each time.

Host steps are asked for their commands with black pixels: what they draw depends on the pixels, but which
passes they are does not.

Source: NV_texture_shader (operations that depend on an earlier unit's texel); SGIX_pixel_texture.
"""

from collections.abc import Iterable
from dataclasses import dataclass, fields, is_dataclass
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

_DRAWS = (Draw, DrawPixels, CopyPixels, Clear, Accum)
_KEEPS = (CopyTexImage, CopyTexSubImage, ReadPixels)
# By texels of an earlier unit: offsets too.
_DEPENDENT = (
    TextureShaderOperation.DEPENDENT_AR_TEXTURE_2D,
    TextureShaderOperation.DEPENDENT_GB_TEXTURE_2D,
    TextureShaderOperation.OFFSET_TEXTURE_2D,
)
_TEXTURE_REGISTERS = (Register.TEXTURE0, Register.TEXTURE1, Register.TEXTURE2, Register.TEXTURE3)


class By(Enum):
    """Who gives the coordinates of a lookup, where no picture does."""

    VERTICES = "vertices"
    IMAGE = "an image"
    HOST = "the host"


@dataclass(frozen=True)
class Picture:
    """What a texture, or the host, holds: its name, and how often the frame has written it before."""

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
    """Commands that draw into a panel one after the other, and what is kept of it.

    commands  in their order
    lookups   what they read, each once
    kept      Pictures that are the panel's content after them; none where nothing is kept
    """

    commands: tuple
    lookups: tuple[Lookup, ...]
    kept: tuple[Picture, ...]

    @property
    def dependent(self) -> tuple[Lookup, ...]:
        """The lookups whose coordinates are not the vertices'."""
        return tuple(lookup for lookup in self.lookups if lookup.dependent)


def lookups_of(command, version_of):
    """The Lookups of a drawing command. ``version_of``: a texture's name -> its Picture now."""
    if isinstance(command, DrawPixels) and command.pixel_texture is not None:
        return tuple(Lookup(version_of(u.texture), By.IMAGE) for u in command.state.texture_units)
    if not isinstance(command, Draw):
        return ()
    state, out = command.state, []
    for number, unit in enumerate(state.texture_units):
        if unit.texture is None:
            continue
        stage = state.texture_shader[number] if number < len(state.texture_shader or ()) else None
        coordinates: Picture | By = By.VERTICES
        if stage is not None and stage.operation in _DEPENDENT:
            coordinates = version_of(_address_of(state, number))
        out.append(Lookup(version_of(unit.texture), coordinates))
    return tuple(out)


def _address_of(state, number):
    """The name of the texture whose texels address a dependent unit's."""
    return state.texture_units[state.texture_shader[number].previous_texture_input].texture


def textures_combined(combiners):
    """Numbers of the texture units that register combiners read, ascending."""
    found = set()

    def walk(value):
        if isinstance(value, Register):
            if value in _TEXTURE_REGISTERS:
                found.add(_TEXTURE_REGISTERS.index(value))
        elif is_dataclass(value):
            for each in fields(value):
                # What is written is not read.
                if not each.name.endswith("output"):
                    walk(getattr(value, each.name))
        elif isinstance(value, tuple):
            for each in value:
                walk(each)

    walk(combiners)
    return tuple(sorted(found))


def _box(command):
    """(x, y, width, height) of what a command draws into or reads, or None: the whole window."""
    if isinstance(command, _KEEPS):
        return command.x, command.y, command.width, command.height
    scissor = command.scissor if isinstance(command, Clear | Accum) else command.state.scissor
    return None if scissor is None else (scissor.x, scissor.y, scissor.width, scissor.height)


class _Walk:
    """The steps of one panel, as commands go by."""

    def __init__(self, box):
        self.box, self.versions, self.read = box, {}, {}
        self.steps, self.commands, self.lookups, self.kept = [], [], [], []

    def version_of(self, name):
        return Picture(name, self.versions.get(name, 0))

    def write(self, name):
        self.versions[name] = self.versions.get(name, -1) + 1
        return self.version_of(name)

    def end(self):
        if self.commands:
            lookups = tuple(dict.fromkeys(self.lookups))
            self.steps.append(Step(tuple(self.commands), lookups, tuple(self.kept)))
        self.commands, self.lookups, self.kept = [], [], []

    def take(self, command, temporary=()):
        if isinstance(command, HostStep):
            self._host(command)
        elif isinstance(command, TexImage):
            self.write(command.texture)
        elif isinstance(command, _KEEPS):
            if _box(command) == self.box:
                name = command.name if isinstance(command, ReadPixels) else command.texture
                same = self.version_of(name)
                picture = same if same in self.kept else self.write(name)
                if isinstance(command, ReadPixels):
                    self.read[picture] = command
                if picture not in self.kept:
                    self.kept.append(picture)
        elif isinstance(command, _DRAWS) and _box(command) == self.box:
            if self.kept:
                self.end()
            self.commands.append(command)
            found = lookups_of(command, self.version_of)
            self.lookups += (lookup for lookup in found if lookup.picture.name not in temporary)

    def _host(self, step):
        """What the host has read is looked up by it, and what it draws then is drawn."""
        pixels = {}
        for name in step.reads:
            command = self.read[self.version_of(name)]
            pixels[name] = np.zeros((command.height, command.width, 4), np.uint8)
        if self.kept:
            self.end()
        self.lookups += (Lookup(self.version_of(name), By.HOST) for name in step.reads)
        drawn = tuple(step.commands(pixels))
        temporary = {command.texture for command in drawn if isinstance(command, TexImage)}
        for command in drawn:
            self.take(command, temporary)


def steps_of(commands: Iterable, panel) -> tuple[Step, ...]:
    """The Steps of a frame's ``commands`` that draw into a ``views.Panel``, in their order.

    Commands that draw elsewhere, or without a scissor, take no part. What the host reads by the name of a
    texture that was kept in the same step is that picture.
    """
    walk = _Walk((panel.x, panel.y, panel.width, panel.height))
    for command in commands:
        walk.take(command)
    walk.end()
    return tuple(walk.steps)
