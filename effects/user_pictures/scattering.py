"""A user's heights as a height field that scatters light, drawn without and with scattering, side by side."""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.geometry.surfaces import Surface, plane
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPEATED, REPLACE, draw, unit
from fixedpipe.effects.scattering import (
    dependent_tests,
    host_lookup_passes,
    light_transport,
    offset_texture_passes,
    pixel_texture_passes,
    texture_shader_passes,
)
from fixedpipe.effects.scattering.dependent_tests import DIRECT, RESULT, Accumulation, PathPasses, Setup
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.height_field import check_light, height_field
from fixedpipe.effects.scattering.visibility import precompute
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.validation.validate import validate

WITHOUT = "light without scattering"
# From where the relief is seen; its half edge is one.
EYE, MIDDLE = (0.0, -2.9, 2.9), (0.0, -0.06, 0.0)
FIELD_OF_VIEW, DEPTH = 29.0, 2.0


@dataclass(frozen=True)
class Drawn:
    """How machines draw scattered light.

    title        in a few words, with the catalogue's ids
    way          its ``dependent_tests.PathPasses``
    most_texels  along an edge of the height field, a power of two: by its coordinates' bits
    needs        the features that a machine needs, in words
    """

    title: str
    way: PathPasses
    most_texels: int
    needs: str


# The best that a machine has is taken.
DRAWN = (
    Drawn("pixel textures (G08)", pixel_texture_passes.WAY, 128, "a colour matrix and pixel textures"),
    Drawn("texture shaders (G10)", texture_shader_passes.WAY, 128, "texture shaders with register combiners"),
    Drawn(
        "register combiners, lookups by the host (G09)",
        host_lookup_passes.WAY,
        128,
        "two general combiners and two texture units",
    ),
    Drawn("offset textures (G10)", offset_texture_passes.WAY, 64, "offset textures"),
)


def _can_draw(found, profile):
    """Whether a machine takes these passes: of a small height field."""
    heights = np.zeros((4, 4))
    heights[:, :2] = 0.3
    field = height_field(heights)
    try:
        frame = commands(field, spread(field, 16), (0.0, 0.0, 1.0), profile, 16, found=found, paths=16)
        validate(frame, profile, 32, 16)
    except ValueError:
        return False
    return True


def way_of(profile):
    """The first of DRAWN by which a machine can draw. Raises ValueError, with the machines that can."""
    for found in DRAWN:
        if _can_draw(found, profile):
            return found
    able = [key for key, known in PROFILES.items() if any(_can_draw(found, known) for found in DRAWN)]
    raise ValueError(
        f"The {profile.name} has no way to look light up where texels say, which takes "
        f"{', or '.join(found.needs for found in DRAWN)}. Give one of {', '.join(able)}."
    )


def field_of(heights, found, texels, scale, albedo):
    """The height field of a user's heights.

    heights  ``maps.HeightField``; its edges are faded into each other, as the field repeats
    found    of DRAWN
    texels   along both edges, a power of two; None: as many as the heights have and the way allows
    scale    of the highest point over the lowest, in edges of the field
    albedo   a number from 0 to 1, or a ``maps.Photograph``

    Raises ValueError as ``height_field.height_field`` does, and for texels that are no power of two or more
    than the way's coordinates can distinguish.
    """
    if texels is None:
        own = max(heights.heights.shape)
        texels = min(found.most_texels, 1 << max(2, (own - 1).bit_length()))
    if texels < 4 or texels & (texels - 1):
        raise ValueError(f"The height field is to have {texels} texels along an edge; give a power of two.")
    if texels > found.most_texels:
        raise ValueError(
            f"The height field is to have {texels} texels along an edge; {found.title} allow up to "
            f"{found.most_texels}. Give --texels {found.most_texels} or less."
        )
    if not scale > 0.0:
        raise ValueError(f"The height scale is {scale!r}, so the field is flat; give a number above 0.")
    colors = albedo.fitted(texels, texels, repeated=True) if hasattr(albedo, "fitted") else albedo
    if not isinstance(albedo, float | int):
        colors = np.clip(colors, 0.0, 1.0)  # what resampling rounds beyond one
    return height_field(heights.fitted(texels, texels, scale, repeated=True), colors)


def check_panel(field, size):
    """Raises ValueError for a field of more texels than a panel of ``size`` pixels, where its light is
    gathered.
    """
    if field.columns > size:
        raise ValueError(
            f"The height field has {field.columns} texels along an edge and a panel {size} pixels, where its "
            f"light is gathered; give --size {field.columns} or more, or fewer --texels."
        )


def spread(field, directions, progress=None):
    """The texels that a field's texels see along ``directions`` directions over the sphere.

    ``progress``: as for ``visibility.precompute``. Raises ValueError for fewer than one.
    """
    return precompute(field, spiral(directions), progress=progress)


def _relief(field):
    """One period as a mesh, a vertex at each texel's centre, x and y from -1 to 1."""
    flat = plane(field.columns, field.rows)
    rows, columns = np.arange(field.rows + 1) % field.rows, np.arange(field.columns + 1) % field.columns
    positions = flat.positions.copy()
    positions[:, 2] = 2.0 * field.heights[np.ix_(rows, columns)].ravel()
    half = np.array([0.5 / field.columns, 0.5 / field.rows])
    places = flat.texture_coordinates + half
    return Surface(positions, flat.normals, flat.tangents, flat.binormals, places, flat.triangles)


def _shown(label, surface, panel, texture):
    view = perspective_view(panel, EYE, MIDDLE, FIELD_OF_VIEW, DEPTH)
    units = (unit(texture, REPEATED, environment=REPLACE),)
    return panel.clear(BACKGROUND), draw(label, surface.mesh(), view, None, units, depth_test=FIRST_PASS)


def commands(
    field,
    visibility,
    light,
    profile,
    size,
    *,
    found=None,
    paths=1,
    bounces=1,
    exposure=1.0,
    seed=0,
    accumulation=Accumulation.ACCUMULATION_BUFFER,
):
    """Commands for a framebuffer of 2 ``size`` x ``size``: the field without scattered light on the left, and
    with it on the right.

    light         towards it, above the horizon
    found         of DRAWN; None: the machine's
    paths         of directions that are summed
    bounces       reflections after the first
    exposure      what all light is multiplied by, above 0 and up to 1
    seed          of the paths' later directions, a whole number
    accumulation  where the paths are summed

    Raises ValueError for a light below the horizon, for counts below one, and for a field of more texels
    than the panel has pixels.
    """
    found = found or way_of(profile)
    light, texels = tuple(check_light(light).tolist()), field.columns
    check_panel(field, size)
    work, total = Panel(0, 0, texels, texels), Panel(texels, 0, texels, texels)
    setup = Setup(field, visibility, profile, work, total)
    numbers = light_transport.sequences(visibility.count, bounces, max(paths, visibility.count), seed)
    # So many of all directions: the first of them alone would be near the zenith.
    numbers = numbers[np.arange(paths) * len(numbers) // paths]
    surface, panels = _relief(field), row_of_panels(2, size)
    direct = dependent_tests.textured(
        "direct light alone", work, DIRECT, dependent_tests.share_of(setup), weight=exposure
    )
    return (
        *dependent_tests.paths_drawn(
            found.way, setup, numbers, light, accumulation=accumulation, exposure=exposure
        ),
        direct,
        dependent_tests.copy_of(setup, work, WITHOUT),
        *_shown("the field without scattering", surface, panels[0], WITHOUT),
        *_shown("the field with scattering", surface, panels[1], RESULT),
    )


def gain(image):
    """How much brighter the right half of a drawn picture is than the left, in percent: uint8 [h, w, 4]."""
    left, right = (image[:, k * len(image) : (k + 1) * len(image), :3].astype(np.float64) for k in (0, 1))
    return 100.0 * (float(right.mean()) / max(float(left.mean()), 1e-9) - 1.0)
