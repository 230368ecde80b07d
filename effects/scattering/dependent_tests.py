"""G11 on machines: paths of bump mapping and dependent lookups, drawn texel by pixel, and their sum.

The height field's square fills a panel with one pixel for each texel. ``PathPasses`` are a machine's ways to
draw the two parts of a path. One is bump mapping. The other is bump mapping times a lookup of the light that
texels send back, at the texel seen along d_i. This module makes paths of them, in the order of pass sequence
A-G11.

Radiances are in units of the light that a white surface facing the lamp sends back. A path's step has the
weight W = 4 (``light_transport``), so each step may multiply the light by W; textures hold 1 at most. So the
light is divided by W after every step, and the lookup is unchanged. Instead, the direct light that is added
there is divided by 4, 16, 64. Each term of the sum lies in [0, 1]. The whole weight, W^K over the number of
paths, is applied to the sum once.

This costs precision: in a path of four lookups, the last direct light but one has steps of 1/16. ``rounds``
preserves the precision: the sum over all directions becomes the light of the next lookup. It works for
diffuse surfaces, because they send light equally in all directions.

Source: Heidrich, Daubert, Kautz, Seidel 2000, sections 3.2 and 3.3; pass sequences A-G08 to A-G11.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import lru_cache
from typing import Any

import numpy as np

from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.passes.arguments import member_of
from fixedpipe.effects.passes.draws import ADD, MODULATE, NEAREST, REPLACE, unit
from fixedpipe.effects.passes.pixel_texture_copies import texture_format
from fixedpipe.effects.scattering.height_field import HeightField, check_light
from fixedpipe.effects.scattering.light_transport import WEIGHT
from fixedpipe.effects.scattering.visibility import Visibility, free_view
from fixedpipe.effects.scattering.visibility_textures import looked_up_size
from fixedpipe.effects.technique import Variant
from fixedpipe.pipeline.commands import (
    Accum,
    Clear,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    HostStep,
    Mesh,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.enums import AccumOperation, InternalFormat, PrimitiveType
from fixedpipe.pipeline.state import PassState, VertexState
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (Variant(("G06", "G11"), "on machines, pass by pass, in three kinds of sums"),)

# Names of textures: the light that is looked up, direct light, a term of the sum, and the result.
LIGHT, DIRECT, TERM, RESULT = "L_d", "direct light", "term of the sum", "scattered light"
UP = (0.0, 0.0, 1.0)
_CORNERS = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


class Accumulation(Enum):
    """Where the paths' terms are summed."""

    FRAMEBUFFER = "framebuffer"  # by blending, the weight before it
    ACCUMULATION_BUFFER = "accumulation buffer"  # Accum, which has the weight
    HOST = "host"  # ReadPixels, and floats


@dataclass(frozen=True, eq=False)
class Setup:
    """The scene of the passes, and its panels.

    field, visibility  a HeightField and its texels' Visibility
    profile            the machine, or the ideal
    work, total        panels with one pixel for each texel, which do not overlap: one for single passes, the
                       other for the sum in the framebuffer
    bits               8 or 12: of S_i's coordinates, and of the textures that hold light

    Raises ValueError for panels of another size, and for ``bits`` too few to tell the texels apart.
    """

    field: HeightField
    visibility: Visibility
    profile: Any
    work: Panel
    total: Panel
    bits: int = 8

    def __post_init__(self):
        texels = self.field.columns, self.field.rows
        for panel in (self.work, self.total):
            if (panel.width, panel.height) != texels:
                raise ValueError(
                    f"The height field has {texels[0]}x{texels[1]} texels and a panel {panel.width}x"
                    f"{panel.height} pixels; give panels of a pixel for each texel."
                )
        for edge in texels:
            looked_up_size(edge, self.bits)  # refuses too many texels

    @property
    def format(self) -> InternalFormat:
        """Of textures that keep light."""
        return texture_format(self.bits)

    @property
    def looked_up_size(self) -> tuple[int, int]:
        """Columns and rows of the textures that are looked up."""
        field = self.field
        return looked_up_size(field.columns, self.bits), looked_up_size(field.rows, self.bits)

    def sees(self, number: int) -> bool:
        """Whether any texel sees another along a direction; otherwise this direction has no lookup."""
        return bool((self.visibility.seen[number] >= 0).any())


@dataclass(frozen=True)
class PathPasses:
    """A machine's ways to draw the parts of a path. Each function returns commands.

    load       (setup, lit, numbers): load the field's textures, and S_i of the directions ``numbers``
    bumps      (setup, light, view, lit): the work panel becomes bump mapping with a light of 1. ``lit``: as
               for ``load``; None: without shadow
    keep       (setup, name): later lookups find the work panel's light under this name
    gathered   (setup, number, view, name, into): bump mapping with a light along d_i, times the light at S_i
               under ``name``, goes into the panel ``into``
    looked_up  (setup, number, name): the work panel becomes the light at S_i under ``name``
    by_host    whether the host looks up, so that each light needs its own name
    """

    load: Callable
    bumps: Callable
    keep: Callable
    gathered: Callable
    looked_up: Callable
    by_host: bool = False


@dataclass(frozen=True)
class Into:
    """Where a pass's colours go: a panel, their factor, and whether they are added."""

    panel: Panel
    weight: float = 1.0
    add: bool = False

    @property
    def blending(self):
        """The pass's blending."""
        return ADD if self.add else None


# ------------------------------------------------------------------------------------------- rectangles


def rectangle(panel, share=(1.0, 1.0), **arrays):
    """A quad that fills a panel, and the vertex state that it takes; texture coordinates from 0 to ``share``
    in one set. ``arrays``: more of Mesh.
    """
    coordinates = (_CORNERS * 0.5 + 0.5) * np.array(share)
    mesh = Mesh(_CORNERS, PrimitiveType.QUADS, texture_coordinates=(coordinates,), **arrays)
    return mesh, VertexState(viewport=panel.viewport)


def textured(label, panel, texture, share=(1.0, 1.0), *, weight=1.0, blending=None):
    """Draw a texture times ``weight`` over a panel, a texel for each pixel."""
    plain = weight == 1.0
    colors = None if plain else np.tile((weight, weight, weight, 1.0), (4, 1))
    mesh, _ = rectangle(panel, share, colors=colors)
    environment = REPLACE if plain else MODULATE
    return Draw(label=label, mesh=mesh, state=_texture_state(panel, texture, environment, blending))


# One object for equal states: a machine looks at a state once, and a hundred paths have the same.
@lru_cache(maxsize=256)
def _texture_state(panel, texture, environment, blending):
    return PassState(
        vertex=rectangle(panel)[1],
        texture_units=(unit(texture, NEAREST, environment=environment),),
        blending=blending,
    )


def kept(setup, name):
    """Copy the work panel's light into the corner of a texture that is larger and black elsewhere."""
    work = setup.work
    return CopyTexSubImage(
        label=f"keep the light as {name}",
        texture=name,
        x=work.x,
        y=work.y,
        width=work.width,
        height=work.height,
    )


def copy_of(setup, panel, name):
    """Copy a panel's picture into a texture of its size."""
    return CopyTexImage(
        label=f"copy it to the texture {name}",
        texture=name,
        internal_format=setup.format,
        x=panel.x,
        y=panel.y,
        width=panel.width,
        height=panel.height,
    )


def added_as_texture(setup, into):
    """The work panel's light into another panel, with a weight, by a texture and the colour of its quad."""
    if into == Into(setup.work):
        return ()
    return (
        copy_of(setup, setup.work, TERM),
        textured(
            f"the term times {into.weight:.4g}",
            into.panel,
            TERM,
            weight=into.weight,
            blending=into.blending,
        ),
    )


def black(setup, name):
    """The command that makes a black texture for lookups; ``kept`` fills its corner."""
    columns, rows = setup.looked_up_size
    image = texture_2d(np.zeros((rows, columns, 4)), setup.format)
    return TexImage(label=f"black, where {name} comes: what is not seen", texture=name, image=image)


def share_of(setup):
    """How much of a texture that is looked up the field fills, across and up."""
    columns, rows = setup.looked_up_size
    return setup.field.columns / columns, setup.field.rows / rows


# ------------------------------------------------------------------------------------------------- sums


def _byte_above(weight):
    """The next byte's fraction: weights of colours are bytes, and so none of the sum's is rounded."""
    return math.ceil(weight * 255.0) / 255.0


def _summed(way, setup, terms, weight, accumulation, what):
    """Commands that make ``weight`` times the sum of terms, and the panel where it comes.

    terms  tuples (commands before, number of the direction, view, name of the light)
    """
    work, out = setup.work, []
    if accumulation is Accumulation.FRAMEBUFFER:
        # More than 1 is not to be had: so many times a part.
        times = math.ceil(weight)
        part = _byte_above(weight / times)
        out.append(Clear(label="nothing summed yet", color=(0.0,) * 4, scissor=setup.total.scissor))
        for before, number, view, name in terms:
            gathered = way.gathered(setup, number, view, name, Into(setup.total, part, add=True))
            out += (*before, *gathered, *(gathered[-1],) * (times - 1))
        whole = weight / times / part
        if whole < 1.0:
            out += (
                copy_of(setup, setup.total, TERM),
                textured(f"the sum times {whole:.4g}", setup.total, TERM, weight=whole),
            )
        return out, setup.total
    if accumulation is Accumulation.ACCUMULATION_BUFFER:
        out.append(Clear(label="nothing summed yet", accumulation=(0.0,) * 4, scissor=work.scissor))
        for before, number, view, name in terms:
            out += (
                *before,
                *way.gathered(setup, number, view, name, Into(work)),
                Accum(
                    label=f"plus the term times {weight:.4g}",
                    operation=AccumOperation.ACCUM,
                    value=weight,
                    scissor=work.scissor,
                ),
            )
        out.append(Accum(label="the sum", operation=AccumOperation.RETURN, scissor=work.scissor))
        return out, work
    names = []
    for before, number, view, name in terms:
        names.append(f"{what}: term {len(names)}")
        out += (
            *before,
            *way.gathered(setup, number, view, name, Into(work)),
            ReadPixels(
                label="the term to the host",
                name=names[-1],
                type="UNSIGNED_BYTE" if setup.bits == 8 else "FLOAT",
                x=work.x,
                y=work.y,
                width=work.width,
                height=work.height,
            ),
        )
    out.append(Clear(label="nothing summed yet", color=(0.0,) * 4, scissor=work.scissor))
    if names:
        out.append(_host_sum(setup, names, weight))
    return out, work


def _host_sum(setup, names, weight):
    panel = setup.work

    def summed(pixels):
        total = np.zeros((panel.height, panel.width, 3))
        for name in names:
            read = pixels[name]
            total += read[..., :3] if read.dtype == np.float64 else read[..., :3] / 255.0
        image = texture_2d(total * weight, setup.format)
        return (
            TexImage(label="load the sum", texture=TERM, image=image),
            textured("the sum, made by the host", panel, TERM),
        )

    return HostStep(label="the host sums floats", reads=tuple(names), commands=summed)


# ------------------------------------------------------------------------------------------------ paths


def _path(way, setup, number, path, light, view, lit):
    """The first term of a path as ``_summed`` takes it, or None where its first lookup sees nothing."""
    directions, diffuse = setup.visibility.directions, not setup.field.specular
    length = next((k for k, i in enumerate(path) if not setup.sees(i)), len(path))
    if not length:
        return None
    views = [view, *(tuple((-directions[i]).tolist()) for i in path)]

    def direct(towards):
        return () if diffuse else (*way.bumps(setup, light, towards, lit), *way.keep(setup, DIRECT))

    out, name, share = list(direct(views[length])), DIRECT, share_of(setup)
    divisor = WEIGHT ** (len(path) - length)

    def named(k):
        return f"{LIGHT} {number}.{k}" if way.by_host else LIGHT

    if divisor > 1.0 or not diffuse:
        name, label = named(length), f"direct light / {divisor:g}"
        if divisor > 1.0:
            out.append(textured(label, setup.work, DIRECT, share, weight=1.0 / divisor))
        out += way.keep(setup, name)
    for k in range(length - 1, 0, -1):
        divisor = WEIGHT ** (len(path) - k)
        out += (
            *direct(views[k]),
            *way.gathered(setup, path[k], views[k], name, Into(setup.work)),
            textured(
                f"plus direct light / {divisor:g}",
                setup.work,
                DIRECT,
                share,
                weight=1.0 / divisor,
                blending=ADD,
            ),
        )
        name = named(k)
        out += way.keep(setup, name)
    return tuple(out), path[0], view, name


def _checked(setup, light, lit, accumulation, exposure):
    member_of(Accumulation, accumulation, "The accumulation")
    if not 0.0 < exposure <= 1.0:
        raise ValueError(f"The exposure is {exposure!r}; give a number above 0 and up to 1.")
    light = tuple(check_light(light).tolist())
    lit = free_view(setup.field, light) if lit is None else np.asarray(lit, bool)
    return light, np.broadcast_to(lit, setup.field.heights.shape)


def _begun(way, setup, light, view, lit, numbers):
    return [
        *way.load(setup, lit, sorted(i for i in set(numbers) if setup.sees(i))),
        *(black(setup, name) for name in (LIGHT, DIRECT)),
        *way.bumps(setup, light, view, lit),
        *way.keep(setup, DIRECT),
    ]


def paths_drawn(
    way,
    setup,
    paths,
    light,
    *,
    view=UP,
    lit=None,
    accumulation=Accumulation.ACCUMULATION_BUFFER,
    exposure=1.0,
):
    """Commands that draw ``light_transport.scattered`` on the same paths, and keep it times ``exposure`` as
    the texture RESULT, of the field's size; DIRECT is left with direct light in its corner.

    way       a machine's
    paths     int [paths, K], as ``light_transport.sequences`` makes them
    light     towards it, [3], above the horizon
    view      towards the viewer
    lit       bool [rows, columns]: where the light is not shadowed; None: by rays
    exposure  so that nothing exceeds 1, as a framebuffer holds it

    Raises ValueError for paths without a lookup, and for arguments out of their ranges.
    """
    light, lit = _checked(setup, light, lit, accumulation, exposure)
    paths = np.asarray(paths, np.int64)
    if paths.ndim != 2 or not paths.size:
        raise ValueError(f"The paths have shape {paths.shape}; give [paths, K], one or more of each.")
    out = _begun(way, setup, light, view, lit, paths.ravel().tolist())
    terms = [_path(way, setup, n, path, light, view, lit) for n, path in enumerate(paths.tolist())]
    weight = exposure * WEIGHT ** paths.shape[1] / len(paths)
    drawn, panel = _summed(way, setup, [t for t in terms if t], weight, accumulation, "paths")
    out += drawn
    if setup.field.specular:
        # The paths left direct light of another view.
        return (*out, *_again(way, setup, light, view, lit, panel, exposure))
    return (*out, *_finished(setup, panel, exposure))


def _again(way, setup, light, view, lit, panel, exposure):
    """Direct light towards the viewer anew, beside a sum that is put away while it is drawn."""
    return (
        copy_of(setup, panel, RESULT),
        *way.bumps(setup, light, view, lit),
        *way.keep(setup, DIRECT),
        textured("the sum again", panel, RESULT),
        *_finished(setup, panel, exposure),
    )


def _finished(setup, panel, exposure):
    added = textured("plus direct light", panel, DIRECT, share_of(setup), weight=exposure, blending=ADD)
    return (added, copy_of(setup, panel, RESULT))


def rounds_drawn(
    way,
    setup,
    light,
    count,
    *,
    lit=None,
    accumulation=Accumulation.ACCUMULATION_BUFFER,
    exposure=1.0,
    weight=WEIGHT,
):
    """Commands that draw ``light_transport.bounces``: ``count`` reflections after the first.

    Each reflection gathers the sum of the one before from all directions. The last is kept times ``exposure``
    as RESULT.

    weight  of all directions together, 4 for those of the sphere

    Other arguments as for ``paths_drawn``. Raises ValueError also for a field with highlights, because its
    light differs from direction to direction.
    """
    light, lit = _checked(setup, light, lit, accumulation, exposure)
    if setup.field.specular:
        raise ValueError(
            "The height field has highlights; draw paths of it, or give one without: specular=0."
        )
    if count < 1:
        raise ValueError(f"{count} further reflections are to be drawn; give 1 or more.")
    numbers = [i for i in range(setup.visibility.count) if setup.sees(i)]
    out, name = _begun(way, setup, light, UP, lit, numbers), DIRECT
    if exposure < 1.0 and count > 1:
        out.append(
            textured("direct light times the exposure", setup.work, DIRECT, share_of(setup), weight=exposure)
        )
        name = f"{LIGHT} 0" if way.by_host else LIGHT
        out += way.keep(setup, name)
    for n in range(1, count + 1):
        share = weight / setup.visibility.count * (exposure if name == DIRECT else 1.0)
        terms = [((), i, UP, name) for i in numbers]
        drawn, panel = _summed(way, setup, terms, share, accumulation, f"reflection {n}")
        out += (*drawn, *_finished(setup, panel, exposure))
        if n < count:
            name = f"{LIGHT} {n}" if way.by_host else LIGHT
            out += (textured("the sum is looked up next", setup.work, RESULT), *way.keep(setup, name))
    return tuple(out)
