"""G10 in its restricted form, on a Matrox G400: a texture moves another's coordinates.

    unit 0  S'_i, signed bytes: q - p in texels, in blue and green
    unit 1  L_d at p + (q - p): OFFSET_TEXTURE_2D, whose 2x2 matrix makes texture coordinates of texels

An offset is s / 128 for a signed byte s, and the matrix has 128 / size. So offsets are whole texels, exactly.
The board has no dot product per fragment, so bumps are lit at vertices. Each texel is a square of one pixel
with the bumps' normal, lit by OpenGL's equations and coloured by the albedo. Unit 1 multiplies the square's
colour, in one pass for each direction.

This has disadvantages against a lookup at coordinates:

- S'_i is relative to a texel, so no two texels share it.
- Signed bytes reach 127 texels, so a field has at most 127 along an edge.
- 127 also leads beyond the field, which means "none is seen".
- The squares take four vertices for each texel, where one quad would be enough.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 3.3 (the restricted kind is named); pass sequence
A-G10; ATI_envmap_bumpmap. Assumed: how bumps are lit; the paper does not use the board.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.geometry.height_fields import texel_centers
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.passes.draws import MODULATE, NEAREST, unit
from fixedpipe.effects.passes.encoding import colors_of, factor_texels
from fixedpipe.effects.passes.texture_shaders import TEXTURE_STAGE
from fixedpipe.effects.scattering import dependent_tests
from fixedpipe.effects.scattering.combiner_bumps import named
from fixedpipe.effects.scattering.dependent_tests import (
    UP,
    PathPasses,
    added_as_texture,
    rectangle,
    share_of,
)
from fixedpipe.effects.technique import Variant
from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ColorMaterialParameter,
    Face,
    PrimitiveType,
    TextureEnvironmentMode,
)
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import (
    ColorMaterial,
    Light,
    Lighting,
    Material,
    PassState,
    SignedComponents,
    TextureEnvironment,
    TextureShaderStage,
    VertexState,
)
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (Variant(("G10",), "by offsets of a texture's coordinates, on a G400"),)

# The most texels along an edge; and the offset that leads beyond them all.
MOST_TEXELS = 127
_SIGNED = replace(NEAREST, signed_components=SignedComponents(True, True, True, True))
_PASSES_ON = TextureEnvironment(TextureEnvironmentMode.NONE)


def seen_texture(number):
    """The name of S'_i's texture."""
    return f"S'_{number}"


def offset_texels(seen):
    """S'_i: q - p as signed bytes, uint8 [rows, columns, 4]: across in blue, up in green.

    seen  int [rows, columns]: ``Visibility.seen`` for one direction

    Raises ValueError for more texels along an edge than a signed byte reaches.
    """
    rows, columns = seen.shape
    if max(rows, columns) > MOST_TEXELS:
        raise ValueError(
            f"The height field has {columns}x{rows} texels, and an offset is a signed byte, which reaches "
            f"{MOST_TEXELS}; give at most so many along each edge."
        )
    texels = np.zeros((rows, columns, 4), np.uint8)
    for channel, offset in (
        (2, seen % columns - np.arange(columns)),
        (1, seen // columns - np.arange(rows)[:, None]),
    ):
        texels[..., channel] = np.where(seen < 0, MOST_TEXELS, offset) % 256
    return texels


def load(setup, lit, numbers):
    """Commands that load S'_i of ``numbers``; the rest is in the squares. Raises ValueError for coordinates
    of other than eight bits, and as ``offset_texels``.
    """
    if setup.bits != 8:
        raise ValueError(f"S_i has coordinates of {setup.bits} bits; offsets are bytes: give 8.")
    seen = setup.visibility.seen
    return tuple(
        TexImage(label=f"load S'_{i}", texture=seen_texture(i), image=texture_2d(offset_texels(seen[i])))
        for i in numbers
    )


def _towards_z(view, vectors):
    """Vectors mirrored so that ``view`` is z, where OpenGL has a viewer that is far away."""
    u = np.asarray(view, np.float64) - np.array(UP)
    square = dot(u, u)
    return vectors if square == 0.0 else vectors - (2.0 * dot(vectors, u) / square)[..., None] * u


def _squares(setup, view, shown):
    """A square of a pixel for each texel that is ``shown``, with the normal, the albedo and the texel's
    centre in two sets of texture coordinates at its four corners.
    """
    field = setup.field
    texel = np.array([1.0 / field.columns, 1.0 / field.rows])
    s, t = (place[shown] for place in texel_centers(field.columns, field.rows))
    place = np.stack([s, t], axis=-1)
    corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]) * texel
    albedo = colors_of(factor_texels(field.albedo[shown], setup.profile))
    place4 = place.repeat(4, axis=0)
    return Mesh(
        2.0 * (place[:, None] + corners).reshape(-1, 2) - 1.0,
        PrimitiveType.QUADS,
        colors=albedo.repeat(4, axis=0),
        normals=_towards_z(view, field.normals[shown]).repeat(4, axis=0),
        texture_coordinates=(place4, place4 * np.array(share_of(setup))),
    )


def _lit(setup, panel, light, view):
    """The vertex state: OpenGL's lighting by one light of 1."""
    field = setup.field
    source = Light(position=(*_towards_z(view, np.asarray(light, np.float64)).tolist(), 0.0))
    lighting = Lighting(
        lights=(source,),
        front=Material(specular=(field.specular,) * 3 + (1.0,), shininess=field.exponent),
        model_ambient=(0.0, 0.0, 0.0, 1.0),
        color_material=ColorMaterial(Face.FRONT, ColorMaterialParameter.DIFFUSE),
    )
    return VertexState(viewport=panel.viewport, lighting=lighting)


def _drawn(setup, label, light, view, shown, **settings):
    """A Clear, and the squares that are ``shown``."""
    work = setup.work
    state = PassState(vertex=_lit(setup, work, light, view), **settings)
    return (
        Clear(label="black", color=(0.0,) * 4, scissor=work.scissor),
        Draw(label=label, mesh=_squares(setup, view, shown), state=state),
    )


def bumps(setup, light, view, lit):
    """The work panel becomes bump mapping: a Clear, and a square for each texel that is not in shadow."""
    shown = np.ones(setup.field.heights.shape, bool) if lit is None else lit
    return _drawn(setup, f"squares with the bumps' normals, light from {named(light)}", light, view, shown)


def _lookup(setup, number, name):
    """The two units and their stages, of PassState."""
    columns, rows = setup.looked_up_size
    offset = TextureShaderStage(
        Operation.OFFSET_TEXTURE_2D, offset_texture_matrix=(128.0 / columns, 0.0, 0.0, 128.0 / rows)
    )
    units = (
        unit(seen_texture(number), _SIGNED, environment=_PASSES_ON),
        unit(name, NEAREST, coordinates=1, environment=MODULATE),
    )
    return {"texture_units": units, "texture_shader": (TEXTURE_STAGE, offset)}


def gathered(setup, number, view, name, into):
    """The same with a light along d_i, times the light that the offsets S'_i lead to: a Clear and a draw."""
    drawn = _drawn(
        setup,
        f"squares, light from d_{number}, times {name} at p + S'_{number}",
        setup.visibility.directions[number],
        view,
        np.ones(setup.field.heights.shape, bool),
        **_lookup(setup, number, name),
    )
    return (*drawn, *added_as_texture(setup, into))


def looked_up(setup, number, name):
    """The work panel becomes the light at p + S'_i: one quad, white."""
    mesh, vertex = rectangle(setup.work)
    (place,) = mesh.texture_coordinates
    sets = place, place * np.array(share_of(setup))
    mesh = Mesh(mesh.positions, mesh.primitive, texture_coordinates=sets)
    state = PassState(vertex=vertex, **_lookup(setup, number, name))
    return (Draw(label=f"{name} at p + S'_{number}", mesh=mesh, state=state),)


def keep(setup, name):
    """The work panel's light becomes the texture that is looked up."""
    return (dependent_tests.kept(setup, name),)


WAY = PathPasses(load, bumps, keep, gathered, looked_up)
