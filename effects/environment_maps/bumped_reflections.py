"""Z08 and Z09: environment-mapped bump mapping, and dirt that takes some of the reflection away.

Z08 on a GeForce 3, one draw:

    unit 0  the normal map
    unit 1  dot product with the first row of [t b n], the eye vector's x in q
    unit 2  with the second row, the eye vector's y in q
    unit 3  with the third row, z in q: the normal's reflection of the eye, r = 2 N (N.e)/(N.N) - e, looked up
            in a cube map (DOT_PRODUCT_REFLECT_CUBE_MAP)

Rows and eye vectors are in the world's axes, like the cube map. All four units are taken, so Z09's dirt is
the normal map's alpha, which the combiners multiply. Alternatively it is a second draw with DST_COLOR, ZERO
(``dirt_pass``).

On a Matrox G400 the bump map holds two signed numbers (du, dv). A 2x2 matrix turns them, and they displace
the coordinates of a sphere map (OFFSET_TEXTURE_2D), which SPHERE_MAP generates for the smooth surface. The
matrix says how much the reflection's (s, t) moves with the normal. It differs from point to point, but it is
state, constant in a draw. So the surface is drawn in parts, each with the matrix of its middle. Nothing is
clamped: coordinates beyond the map's circle read its edge.

Source: Zwicker 2016, "Environment mapped bump mapping" and "'Dirt' texture"; NV_texture_shader, section
3.8.13.1.18; ATI_envmap_bumpmap; pass sequence A-Z08/Z09 of the catalogue.
"""

from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.effects.environment_maps import environments
from fixedpipe.effects.geometry.matrices import rotate
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.vertex_vectors import reflected
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    ONE,
    TEXTURE0,
    TEXTURE3,
    alpha_of,
    final,
    product,
    program,
)
from fixedpipe.effects.passes.draws import (
    EDGE,
    FIRST_PASS,
    LATER_PASS,
    MULTIPLY_DESTINATION,
    REPEATED,
    REPLACE,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import dot_product_texels, factor_texels
from fixedpipe.effects.passes.texture_shaders import (
    NO_TEXTURE,
    TEXTURE_STAGE,
    dot_product_stages,
)
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    Face,
    InternalFormat,
    PrimitiveType,
    TexGenMode,
    TextureEnvironmentMode,
)
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import (
    PassState,
    PolygonState,
    SignedComponents,
    TexGen,
    TextureEnvironment,
    TextureShaderStage,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.textures.pixels import unit_numbers

TECHNIQUES = (
    Technique("Z08", "environment-mapped bump mapping by a cube map", "Combination with env. map"),
    Technique("Z09", "dirt: a texture that takes some of the reflection away", "Env. mapped bump mapping"),
)

CUBE_MAP, SPHERE_MAP, PICTURE = "environment cube map", "environment sphere map", "environment behind"


@dataclass(frozen=True)
class Names:
    """The names of two texture objects: normals with dirt in alpha (or offsets), and dirt alone."""

    normal: str
    dirt: str


def load_environment(size, profile, environment=environments.room):
    """The command that loads an environment (``environments``) as the cube map that reflections look up."""
    return TexImage(
        label="load the environment as a cube map",
        texture=CUBE_MAP,
        image=environments.cube_map(size, profile, environment),
    )


def _dirt_image(dirt, profile):
    return texture_2d(factor_texels(dirt, profile)[..., None], InternalFormat.LUMINANCE8)


def load(normals, dirt, name, profile):
    """Commands that load a normal map with dirt in alpha, and dirt alone; and their Names.

    normals  float64 [rows, columns, 3], bottom row first, in tangent space
    dirt     float64 [rows, columns] in [0, 1]: the share of the reflection that stays; or one number
    """
    dirt = np.broadcast_to(unit_numbers(dirt, "The dirt"), normals.shape[:2])
    names = Names(f"{name} n, dirt", f"{name} dirt")
    return (
        TexImage(
            label=f"load normal map of {name}, dirt in alpha",
            texture=names.normal,
            image=texture_2d(dot_product_texels(normals, dirt, profile)),
        ),
        TexImage(label=f"load dirt of {name}", texture=names.dirt, image=_dirt_image(dirt, profile)),
    ), names


def rows_and_eye(surface, view):
    """Texture coordinates of units 1 to 3, float64 [n, 4] each: a row of [t b n] in world coordinates.

    q holds that component of the vector to the eye. The vector is not normalized, so it is linear.
    """
    if view.infinite_viewer:
        eye = np.broadcast_to(normalize(np.array(view.eye)), surface.positions.shape)
    else:
        eye = np.array(view.eye) - surface.positions
    axes = surface.tangents, surface.binormals, surface.normals, eye
    return tuple(np.stack([axis[:, k] for axis in axes], axis=-1) for k in range(3))


def _tinted(texel, factor, tint):
    """A unit's texel times a constant, times a factor: combiners."""
    return program(final(product(texel, CONSTANT0), factor), constant0=tint)


def reflection_pass(surface, names, view, *, dirt=True, tint=(1.0, 1.0, 1.0), sampler=REPEATED):
    """Z08 and, with ``dirt``, Z09 in one draw; ``tint``: RGB in [0, 1] by which the metal reflects."""
    mesh = surface.mesh(surface.texture_coordinates, *rows_and_eye(surface, view))
    units = (
        unit(names.normal, sampler),
        unit(NO_TEXTURE, coordinates=1),
        unit(NO_TEXTURE, coordinates=2),
        unit(CUBE_MAP, EDGE, coordinates=3),
    )
    stages = (TEXTURE_STAGE, *dot_product_stages(0, 0, 0, lookup=Operation.DOT_PRODUCT_REFLECT_CUBE_MAP))
    label = "reflection: r of the bumped normal, looked up in the cube map"
    return (
        draw(
            f"{label}, times dirt" if dirt else label,
            mesh,
            view,
            _tinted(TEXTURE3, alpha_of(TEXTURE0) if dirt else ONE, tint),
            units,
            depth_test=FIRST_PASS,
            texture_shader=stages,
        ),
    )


def dirt_pass(surface, names, view, sampler=REPEATED, *, alone=False):
    """Z09 as a second draw: the dirt, multiplied into what the framebuffer holds (DST_COLOR, ZERO).

    ``alone``: drawn first and by itself, as a map of the dirt. A texture environment, for any board. Faces
    turned away are culled: where one meets the outline in the same pixel at the same depth, dirt would be
    multiplied twice.
    """
    units = (unit(names.dirt, sampler, environment=REPLACE),)
    return (
        draw(
            "the dirt" if alone else "multiply by the dirt",
            surface.mesh(),
            view,
            None,
            units,
            depth_test=FIRST_PASS if alone else LATER_PASS,
            blending=None if alone else MULTIPLY_DESTINATION,
            polygon=PolygonState(cull_face=Face.BACK),
        ),
    )


# ------------------------------------------------------------------------------------------- behind it


def _corner_directions(view):
    """World directions through the panel's corners, lower left, lower right, upper right and upper left, as
    far as the projection's unit depth: float64 [4, 3].
    """
    (across, up) = (1.0 / view.projection[k][k] for k in (0, 1))
    in_eye = np.array([(x * across, y * up, -1.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    return rotate(np.array(view.modelview)[:3, :3].T, in_eye)


def _background(label, view, read, coordinates, combiners):
    """A rectangle over the whole panel, that neither tests nor writes depth."""
    square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    mesh = Mesh(square, PrimitiveType.QUADS, texture_coordinates=(coordinates,))
    panel = replace(view.vertex, modelview=_IDENTITY, projection=_IDENTITY)
    state = PassState(vertex=panel, texture_units=(read,), register_combiners=combiners)
    return Draw(label=label, mesh=mesh, state=state)


_IDENTITY = tuple(tuple(float(i == j) for j in range(4)) for i in range(4))


def backdrop(view):
    """The environment as the viewer sees it, from the cube map: one draw."""
    combiners = _tinted(TEXTURE0, ONE, (1.0, 1.0, 1.0))
    return (
        _background(
            "the environment behind, from the cube map",
            view,
            unit(CUBE_MAP, EDGE),
            _corner_directions(view),
            combiners,
        ),
    )


def picture_backdrop(view, size, profile, environment=environments.room):
    """The same from a picture of ``size`` texels, for boards without cube maps: a load and a draw."""
    lower_left, lower_right, _, upper_left = _corner_directions(view)
    image = environments.picture(size, size, (lower_left, lower_right, upper_left), profile, environment)
    coordinates = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    return (
        TexImage(label="load a picture of the environment", texture=PICTURE, image=image),
        _background(
            "the environment behind, a picture",
            view,
            unit(PICTURE, EDGE, environment=REPLACE),
            coordinates,
            None,
        ),
    )


# ------------------------------------------------------------------------- G400: offsets of a sphere map

_SIGNED_SAMPLER = replace(REPEATED, signed_components=SignedComponents(True, True, True, True))
_GENERATED = (TexGen(TexGenMode.SPHERE_MAP), TexGen(TexGenMode.SPHERE_MAP), TexGen(), TexGen())


def load_sphere_map(size, view, profile, environment=environments.room):
    """The command that loads the environment as the sphere map of a view."""
    return TexImage(
        label="load the environment as a sphere map",
        texture=SPHERE_MAP,
        image=environments.sphere_map(size, view, profile, environment),
    )


def offset_texels(normals, profile):
    """Signed texels [rows, columns, 4] of an offset map: du = the normal's x in blue, dv = its y in green.

    Source: docs/numbers.md, section 12: s/128 of a two's complement byte. The exact machine's are not whole.
    """
    offsets = np.clip(128.0 * unit_numbers(normals, "The normal map")[..., :2], -128.0, 127.0)
    if not profile.arithmetic.exact:
        offsets = np.floor(offsets + 0.5)
    stored = np.where(offsets < 0.0, offsets + 256.0, offsets)
    texels = np.zeros((*stored.shape[:-1], 4))
    texels[..., 2], texels[..., 1] = stored[..., 0], stored[..., 1]
    return texels / 255.0 if profile.arithmetic.exact else texels.astype(np.uint8)


def load_offsets(normals, dirt, name, profile):
    """Commands that load an offset map and dirt, and their Names; arguments as for ``load``."""
    names = Names(f"{name} offsets", f"{name} dirt")
    dirt = np.broadcast_to(unit_numbers(dirt, "The dirt"), normals.shape[:2])
    return (
        TexImage(
            label=f"load offset map of {name}: (du, dv)",
            texture=names.normal,
            image=texture_2d(offset_texels(normals, profile)),
        ),
        TexImage(label=f"load dirt of {name}", texture=names.dirt, image=_dirt_image(dirt, profile)),
    ), names


def parts(surface, across, along):
    """The surface's triangles in ``across`` by ``along`` parts of its texture space: a list of surfaces."""
    middle = surface.texture_coordinates[surface.triangles].mean(axis=1)
    low, high = surface.texture_coordinates.min(axis=0), surface.texture_coordinates.max(axis=0)
    cell = np.floor((middle - low) / (high - low) * np.array([across, along])).astype(np.int64)
    number = cell[:, 1] * across + cell[:, 0]
    return [replace(surface, triangles=surface.triangles[number == k]) for k in np.unique(number)]


# Assumed: the bumps' leaning, as a sine, over which the matrix is the secant; most of the figures' bumps are
# of this size, and the sphere map's coordinates bend little within it.
_LEAN = 0.125


def _sphere_map_coordinates(normals, to_eye):
    """SPHERE_MAP's (s, t) of what normals reflect towards the eye, in eye coordinates: float64 [..., 2]."""
    r = reflected(to_eye, normals)
    r = r + np.array([0.0, 0.0, 1.0])
    return 0.5 * normalize(r)[..., :2] + 0.5


def offset_matrix(part, view):
    """The matrix by which (du, dv) of a part's bumps displace the sphere map's coordinates at the part's
    middle: (a1, a2, a3, a4), by columns, d(s, t)/d(du) and d(s, t)/d(dv), rounded to multiples of 1/4096.
    """
    turn, vertices = np.array(view.modelview)[:3, :3], np.unique(part.triangles)
    t, b, n = (
        normalize(rotate(turn, axis[vertices]).mean(axis=0))
        for axis in (part.tangents, part.binormals, part.normals)
    )
    to_eye = normalize(rotate(turn, np.array(view.eye) - part.positions[vertices].mean(axis=0)))
    upright = float(np.sqrt(1.0 - _LEAN * _LEAN))
    entries = []
    for axis in (t, b):
        ends = [
            _sphere_map_coordinates(normalize(upright * n + sign * _LEAN * axis), to_eye) for sign in (1, -1)
        ]
        entries.append((ends[0] - ends[1]) / (2.0 * _LEAN))
    return tuple((np.floor(np.concatenate(entries) * 4096.0 + 0.5) / 4096.0).tolist())


# Assumed: a triangle may face the viewer although its vertices' normals turn away, by no more than 17 degrees
# on meshes of 20 slices and more.
_AWAY = -0.3


def offset_passes(surface, names, view, *, across=16, along=12):
    """Z08 on a G400: a draw for each part of the surface that faces the viewer.

    ``across``, ``along``: how many parts the texture space is cut into. Raises ValueError for an infinite
    viewer, as SPHERE_MAP takes the eye for the origin of eye coordinates.
    """
    if view.infinite_viewer:
        raise ValueError(
            "A sphere map needs the eye's position; give fixedpipe.effects.geometry.views.perspective_view."
        )
    out = []
    for number, part in enumerate(parts(surface, across, along)):
        seen = np.unique(part.triangles)
        if dot(part.normals[seen], view.view_vectors(part.positions[seen])).max() <= _AWAY:
            continue
        stages = (
            TEXTURE_STAGE,
            TextureShaderStage(Operation.OFFSET_TEXTURE_2D, offset_texture_matrix=offset_matrix(part, view)),
        )
        units = (
            unit(names.normal, _SIGNED_SAMPLER, environment=TextureEnvironment(TextureEnvironmentMode.NONE)),
            unit(SPHERE_MAP, EDGE, environment=REPLACE, gen=_GENERATED),
        )
        out.append(
            draw(
                f"reflection of part {number}: the sphere map, displaced by the offset map",
                part.mesh(),
                view,
                None,
                units,
                depth_test=FIRST_PASS,
                texture_shader=stages,
            )
        )
    return tuple(out)
