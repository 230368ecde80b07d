"""S13 to S15 on machines: offset vectors added to the normal at every fragment, and the lighting from it.

Light and viewer are far away, so light is a function of the normal's direction alone. A cube map of this
function, looked up at n', needs no normalization of the frame or of n' (``load_light``).

    dot products, GeForce 3   f_u, f_v and one as signed bytes (SIGNED_IDENTITY), times three rows [s_u s_v n]
                              of the frame that the vertices have: n', looked up in the cube map. Rows go
                              straight from vertex to vertex.
    S13 by combiners          the future board: directions of s_u and s_v as colours, n from a normalization
                              cube map, lengths by PASS_THROUGH; roots and quotients give the directions their
                              length back, then each has its own: seven stages, the seventh looks n' up.
    S14 by combiners          the same without lengths: six stages.
    S15 by combiners          n and m x n, which is as linear as n where m is one for the object, as colours;
                              e_1, e_2 = n x e_1 = (m (n.n) - n (n.m)) / |m x n| and n' by eight stages, all
                              times |n_I|.
    n'.l as it is, combiners  offsets and one times the light in the frame's own axes: nothing is normalized,
                              and n' is as long as it comes out (E001.15).
    offsets, G400 and TEXRAM  a map of light by normals in two numbers, displaced by (g_1, g_2) through a
                              matrix for each part of the surface.

If offsets exceed one, combiners divide n' by a factor, because only its direction matters.

Source: Schilling 1997, sections 7.1 to 7.3; pass sequences A-S13 to A-S15 of the catalogue. Assumed: the
division into stages; light by a map of directions.
"""

from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.effects.bump_mapping import blinn, normalization_cube_map
from fixedpipe.effects.bump_mapping.offset_vectors import checked_scale
from fixedpipe.effects.geometry.cube_maps import directions
from fixedpipe.effects.geometry.matrices import rotate
from fixedpipe.effects.geometry.vectors import cross, dot, normalize, unit_vector
from fixedpipe.effects.passes import combiners as words
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    CONSTANT1,
    NOTHING,
    ONE,
    PRIMARY,
    SECONDARY,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE1,
    TEXTURE2,
    TEXTURE3,
    alpha_of,
    blue_of,
    both,
    expand,
    final,
    negated,
    product,
    program,
    quotient,
    scaled,
    shown,
    signed,
    square_root,
    stage,
    total,
)
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPEATED, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels, vector_colors, vector_texels
from fixedpipe.effects.passes.texture_shaders import (
    NO_TEXTURE,
    PASS_THROUGH_STAGE,
    TEXTURE_STAGE,
    dot_product_stages,
)
from fixedpipe.effects.technique import Variant
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import DotProductMapping, InternalFormat, TextureEnvironmentMode
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import SignedComponents, TextureEnvironment, TextureShaderStage
from fixedpipe.pipeline.textures.images import texture_2d, texture_cube_map

TECHNIQUES = (Variant(("S13", "S14", "S15"), "on machines, by dot products, combiners and displacement"),)

LIGHT, LIGHT_IN_PLANE = "light by normals", "light by normals, in a plane"
_SIGNED = replace(REPEATED, signed_components=SignedComponents(True, True, True, True))
_CUBE_STAGE = TextureShaderStage(Operation.TEXTURE_CUBE_MAP)


# ------------------------------------------------------------------------------------------------- light


@dataclass(frozen=True)
class Lighting:
    """A distant light, seen from +z: the light that each normal's direction sends to the viewer.

    light           the direction to the light
    color, ambient  RGB: the factors of (n.l)+ and of the light that is there without it
    specular        of (n.h)+ to the power of ``exponent``, a whole number
    """

    light: tuple[float, float, float]
    color: tuple[float, float, float]
    ambient: tuple[float, float, float]
    specular: float
    exponent: int

    def radiance(self, normals):
        """RGB of unit normals [..., 3]: float64 [..., 3], not clamped."""
        light = unit_vector(self.light, "The light's direction")
        half = normalize(light + np.array([0.0, 0.0, 1.0]))
        lit = np.maximum(dot(normals, light), 0.0)[..., None]
        shine = blinn.integer_power(np.maximum(dot(normals, half), 0.0), self.exponent)[..., None]
        # No highlight where the surface turns away from the light, and no edge of it there.
        shine = shine * np.minimum(1.0, 8.0 * lit)
        return np.asarray(self.ambient) + np.asarray(self.color) * lit + self.specular * shine


def load_light(size, profile, lighting):
    """The command that loads light as a function of the normal, a cube map ``size`` texels along an edge."""
    values = np.clip(lighting.radiance(directions(size)), 0.0, 1.0)
    image = texture_cube_map(factor_texels(values, profile), InternalFormat.RGB8)
    return TexImage(label="load light by normals", texture=LIGHT, image=image)


def shown_light(surface, values, profile, view, name):
    """Commands that show light from the host as a plain texture: RGB [rows, columns, 3] over the surface's
    texture coordinates from 0 to 1. Rows and columns are powers of two.
    """
    image = texture_2d(factor_texels(np.clip(values, 0.0, 1.0), profile), InternalFormat.RGB8)
    units = (unit(name, EDGE, environment=REPLACE),)
    return (
        TexImage(label=f"load {name}", texture=name, image=image),
        draw(name, surface.mesh(), view, None, units, depth_test=FIRST_PASS),
    )


# --------------------------------------------------------------------------- dot products of texture shaders


def signed_texels(offsets, scale, profile):
    """Offsets [rows, columns, 2] over ``scale``, and one: texels [rows, columns, 3] of signed components.

    Source: docs/numbers.md, N12.7: s/127 of a two's complement byte. The exact machine's are not whole.
    """
    values = np.clip(np.asarray(offsets, np.float64) / checked_scale(scale), -1.0, 1.0) * 127.0
    values = np.concatenate([values, np.full((*values.shape[:-1], 1), 127.0)], axis=-1)
    if not profile.arithmetic.exact:
        values = np.floor(values + 0.5)
    stored = np.where(values < 0.0, values + 256.0, values)
    return stored / 255.0 if profile.arithmetic.exact else stored.astype(np.uint8)


def load_signed(offsets, scale, name, profile):
    """The command that loads a bump map of signed bytes for ``dot_product_pass``."""
    image = texture_2d(signed_texels(offsets, scale, profile), InternalFormat.RGB8)
    return TexImage(label=f"load {name}: offsets as signed bytes", texture=name, image=image)


def rows(frame, scale):
    """Texture coordinates of three dot products: float64 [n, 3] each, rows of [s_u s_v n] of a Frame."""
    scale = checked_scale(scale)
    return tuple(
        np.stack([scale * frame.first[:, k], scale * frame.second[:, k], frame.normal[:, k]], axis=-1)
        for k in range(3)
    )


def dot_product_pass(surface, frame, name, scale, view):
    """n' by dot products with the vertices' Frame, and light looked up at it, in one draw."""
    mesh = surface.mesh(surface.texture_coordinates, *rows(frame, scale))
    units = (
        unit(name, _SIGNED),
        unit(NO_TEXTURE, coordinates=1),
        unit(NO_TEXTURE, coordinates=2),
        unit(LIGHT, EDGE, coordinates=3),
    )
    stages = dot_product_stages(
        0,
        0,
        0,
        lookup=Operation.DOT_PRODUCT_TEXTURE_CUBE_MAP,
        mapping=DotProductMapping.SIGNED_IDENTITY,
    )
    return (
        draw(
            "light at n' = n + f_u s_u + f_v s_v, by dot products", mesh, view, program(shown(TEXTURE3)),
            units, depth_test=FIRST_PASS, texture_shader=(TEXTURE_STAGE, *stages),
        ),
    )  # fmt: skip


# -------------------------------------------------------------------------------------------- combiners


def load_biased(offsets, scale, name, profile):
    """The command that loads a bump map for combiners: the first number in red, green and blue, the second in
    alpha, two bytes a texel.
    """
    stored = vector_texels(
        np.clip(np.asarray(offsets, np.float64) / checked_scale(scale), -1.0, 1.0), profile
    )
    image = texture_2d(stored, InternalFormat.LUMINANCE8_ALPHA8)
    return TexImage(label=f"load {name}: offsets as biased bytes", texture=name, image=image)


_FIRST, _SECOND = expand(TEXTURE0), alpha_of(expand(TEXTURE0))


def _factors(scale):
    """Constants by which offsets and the normal are multiplied, so that none exceeds one."""
    offsets, normal = min(scale, 1.0), min(1.0 / scale, 1.0)
    return {"constant0": (normal,) * 3 + (0.0,), "constant1": (offsets,) * 3 + (0.0,)}


def _sum_and_lookup(normal, texture_unit, scale):
    """The stage that adds the offset in SPARE0 to the normal, and looks light up at the sum."""
    added = total(product(normal, CONSTANT0), product(signed(SPARE0), CONSTANT1), to=SPARE0)
    return stage(added, lookup=texture_unit, **_factors(scale))


def _colored(surface, first, second, profile, *coordinates):
    return replace(
        surface.mesh(surface.texture_coordinates, *coordinates, colors=vector_colors(first, profile)),
        secondary_colors=vector_colors(second, profile),
    )


def natural_combiners(scale, lengths=True):
    """S13, or without ``lengths`` S14: seven stages, or six. Primary and secondary: directions of s_u and
    s_v, of any length; unit 1: n; unit 2: their lengths, in colours and in alpha; unit 3: light.
    """
    first, second = expand(PRIMARY), expand(SECONDARY)
    stages = [
        both(words.dot(first, first, to=SPARE0), words.dot(second, second, to=SPARE1)),
        stage(quotient(ONE, SPARE0, to=SPARE0), quotient(ONE, blue_of(SPARE1), to=SPARE0)),
        stage(square_root(SPARE0, to=SPARE0), square_root(SPARE0, to=SPARE0)),
        # Each offset over its direction's length.
        both(product(_FIRST, SPARE0, to=SPARE1), product(_SECOND, alpha_of(SPARE0), to=SPARE0)),
    ]
    if lengths:
        stages.append(
            both(
                product(signed(SPARE1), TEXTURE2, to=SPARE1),
                product(signed(SPARE0), alpha_of(TEXTURE2), to=SPARE0),
            )
        )
    stages.append(total(product(signed(SPARE1), first), product(signed(SPARE0), second), to=SPARE0))
    return program(*stages, _sum_and_lookup(expand(TEXTURE1), 3, scale), shown(TEXTURE3))


def natural_pass(surface, directions_of, sizes, name, scale, view, profile):
    """S13 in one draw on the future board; where ``sizes`` is None S14.

    directions_of  a Frame at the vertices whose vectors have the right directions, of length one or less
    sizes          float64 [n, 2]: lengths of s_u and s_v over the normal's, by which no direction of n'
    changes
    """
    most = 1.0 if sizes is None else float(sizes.max())
    shares = np.ones((len(surface.positions), 2)) if sizes is None else sizes / most
    frame = directions_of
    mesh = _colored(surface, frame.first, frame.second, profile, frame.normal, shares[:, [0, 0, 0, 1]])
    units = (
        unit(name),
        unit(normalization_cube_map.NAME, EDGE, coordinates=1),
        unit(NO_TEXTURE, coordinates=2),
        unit(LIGHT, EDGE, coordinates=1),
    )
    what = "S14, unit vectors" if sizes is None else "S13, lengths apart from directions"
    return (
        draw(
            f"light at n': {what}", mesh, view, natural_combiners(scale * most, sizes is not None), units,
            depth_test=FIRST_PASS,
            texture_shader=(TEXTURE_STAGE, _CUBE_STAGE, PASS_THROUGH_STAGE, _CUBE_STAGE),
        ),
    )  # fmt: skip


def main_direction_combiners(main, scale):
    """S15 in eight stages. Primary: n_I; secondary: m x n_I; unit 1: light."""
    normal, across = expand(PRIMARY), expand(SECONDARY)
    toward = tuple(0.5 + 0.5 * float(c) for c in main)
    return program(
        # n.n and c.c with c = m x n.
        both(words.dot(normal, normal, to=TEXTURE1), words.dot(across, across, to=TEXTURE2)),
        # 1 / |c|, and in alpha |n| / |c|.
        stage(quotient(ONE, TEXTURE2, to=SPARE1), quotient(blue_of(TEXTURE1), blue_of(TEXTURE2), to=SPARE0)),
        stage(square_root(SPARE1, to=SPARE1), square_root(SPARE0, to=SPARE0)),
        # m (n.n) - n (n.m).
        stage(
            both(
                product(TEXTURE1, expand(CONSTANT0), to=TEXTURE1),
                words.dot(normal, expand(CONSTANT0), to=TEXTURE2),
            ),
            NOTHING,
            constant0=(*toward, 0.0),
        ),
        total(signed(TEXTURE1), product(negated(TEXTURE2), normal), to=TEXTURE1),
        both(product(_SECOND, SPARE1, to=TEXTURE2), product(_FIRST, alpha_of(SPARE0), to=TEXTURE3)),
        total(product(signed(TEXTURE2), signed(TEXTURE1)), product(signed(TEXTURE3), across), to=SPARE0),
        _sum_and_lookup(normal, 1, scale),
        shown(TEXTURE1),
    )


def main_direction_pass(surface, normals, main, name, scale, view, profile):
    """S15 in one draw on the future board: normals [n, 3] are interpolated, ``main`` is one for the
    object.
    """
    main = unit_vector(main, "The main direction")
    mesh = _colored(surface, normals, cross(main, normals), profile)
    units = (unit(name), unit(LIGHT, EDGE))
    return (
        draw(
            "light at n': S15, the frame at every fragment", mesh, view,
            main_direction_combiners(main, scale), units, depth_test=FIRST_PASS,
        ),
    )  # fmt: skip


def load_with_one(offsets, scale, name, profile):
    """The command that loads a bump map for ``plain_pass``: two biased bytes and one."""
    values = np.clip(np.asarray(offsets, np.float64) / checked_scale(scale), -1.0, 1.0)
    values = np.concatenate([values, np.ones((*values.shape[:-1], 1))], axis=-1)
    image = texture_2d(vector_texels(values, profile), InternalFormat.RGB8)
    return TexImage(label=f"load {name}: offsets and one", texture=name, image=image)


def plain_pass(surface, frame, name, scale, view, profile, *, lighting):
    """(n'.l)+ without normalization, in one draw of two combiners. No highlight."""
    light = unit_vector(lighting.light, "The light's direction")
    parts = [scale * dot(frame.first, light), scale * dot(frame.second, light), dot(frame.normal, light)]
    # Colours hold [-1, 1]: halved until they do, and scaled back.
    factor = next(f for f in (1, 2, 4) if scale <= f or f == 4)
    mesh = surface.mesh(colors=vector_colors(np.stack(parts, axis=-1) / factor, profile))
    combiners = program(
        scaled(factor, both(words.dot(expand(TEXTURE0), expand(PRIMARY), to=SPARE0), NOTHING)),
        final(SPARE0, CONSTANT0, plus=CONSTANT1),
        constant0=lighting.color,
        constant1=lighting.ambient,
    )
    return (draw("n'.l, not normalized", mesh, view, combiners, (unit(name),), depth_test=FIRST_PASS),)


# --------------------------------------------------------------------------------- G400, TEXRAM: offsets


def on_disc(normals, unit_length=True):
    """Places of normals [..., 3], seen from +z, on a map of light: float64 [..., 2] in [0, 1].

    ``unit_length``: True: the place of the direction, by a paraboloid: x/(1 + z). False: x and y themselves.
    There n' is not normalized, so offsets move places equally everywhere.
    """
    normals = np.asarray(normals, np.float64)
    if not unit_length:
        return 0.5 + 0.45 * normals[..., :2]
    normals = normalize(normals)
    # What is turned away lies beyond the rim, and is clamped there.
    return 0.5 + 0.45 * (normals[..., :2] / np.maximum(1.0 + normals[..., 2:], 0.5))


def normals_on_disc(place, unit_length=True):
    """The normals whose place that is: float64 [..., 3]; beyond the rim its own."""
    p = (np.asarray(place, np.float64) - 0.5) / 0.45
    square = (p * p).sum(axis=-1, keepdims=True)
    p = p / np.sqrt(np.maximum(square, 1.0))
    square = np.minimum(square, 1.0)
    if unit_length:
        return np.concatenate([2.0 * p, 1.0 - square], axis=-1) / (1.0 + square)
    return np.concatenate([p, np.sqrt(1.0 - square)], axis=-1)


def load_light_in_plane(size, profile, lighting, unit_length=True):
    """The command that loads light by ``on_disc``, ``size`` texels along an edge."""
    edge = (np.arange(size) + 0.5) / size
    places = np.stack(np.meshgrid(edge, edge), axis=-1)
    values = np.clip(lighting.radiance(normals_on_disc(places, unit_length)), 0.0, 1.0)
    name = _plane_name(unit_length)
    image = texture_2d(factor_texels(values, profile), InternalFormat.RGB8)
    return TexImage(label=f"load {name}", texture=name, image=image)


def _plane_name(unit_length):
    return LIGHT_IN_PLANE if unit_length else f"{LIGHT_IN_PLANE}, as long as they are"


def load_offsets(offsets, scale, name, profile):
    """The command that loads a bump map for OFFSET_TEXTURE_2D: (du, dv) in blue and green.

    Source: docs/numbers.md, N12.4: s/128 of a two's complement byte.
    """
    stored = signed_texels(offsets, scale, profile)
    texels = np.zeros((*stored.shape[:2], 3), stored.dtype)
    texels[..., 2], texels[..., 1] = stored[..., 0], stored[..., 1]
    image = texture_2d(texels, InternalFormat.RGB8)
    return TexImage(label=f"load {name}: offsets (du, dv)", texture=name, image=image)


# Assumed: the offset, in units of slope, over which a matrix is the secant: about what bumps have.
_STEP = 0.3


def offset_matrix(normal, first, second, scale, unit_length=True):
    """The matrix by which stored (du, dv) move one normal's place in the map: (a1, a2, a3, a4), d(s, t)/d(du)
    and d(s, t)/d(dv), rounded to multiples of 1/4096. A stored one is ``scale`` times 127/128.
    """
    entries = []
    for axis in (first, second):
        ends = [on_disc(normal + sign * _STEP * axis, unit_length) for sign in (1.0, -1.0)]
        entries.append((ends[0] - ends[1]) / (2.0 * _STEP) * (scale * 128.0 / 127.0))
    return tuple((np.floor(np.concatenate(entries) * 4096.0 + 0.5) / 4096.0).tolist())


def parts(surface, across, along):
    """The surface's triangles in ``across`` by ``along`` parts of its texture space, by their middles: a list
    of surfaces.
    """
    middle = surface.texture_coordinates[surface.triangles].mean(axis=1)
    low, high = middle.min(axis=0), middle.max(axis=0)
    cells = np.array([across, along])
    cell = np.minimum(np.floor((middle - low) / (high - low) * cells), cells - 1).astype(np.int64)
    number = cell[:, 1] * across + cell[:, 0]
    return [replace(surface, triangles=surface.triangles[number == k]) for k in np.unique(number)]


def offset_passes(surface, frame, name, scale, view, *, across, along, unit_length=True):
    """n' on a G400 or TEXRAM: light by normals, displaced; a draw for each part that faces the viewer.

    ``frame``: at the vertices. ``across``, ``along``: how many parts the texture space is cut into.
    ``unit_length``: whether n' is normalized.
    """
    turn = np.array(view.modelview)[:3, :3]
    at_eye = [rotate(turn, v) for v in (frame.normal, frame.first, frame.second)]
    places = on_disc(at_eye[0], unit_length)
    out = []
    for number, part in enumerate(parts(surface, across, along)):
        seen = np.unique(part.triangles)
        if at_eye[0][seen, 2].max() <= -0.3:
            continue
        middle = [v[seen].mean(axis=0) for v in at_eye]
        matrix = offset_matrix(*middle, scale, unit_length)
        units = (
            unit(name, _SIGNED, environment=TextureEnvironment(TextureEnvironmentMode.NONE)),
            unit(_plane_name(unit_length), EDGE, environment=REPLACE, coordinates=1),
        )
        stages = (
            TEXTURE_STAGE,
            TextureShaderStage(Operation.OFFSET_TEXTURE_2D, offset_texture_matrix=matrix),
        )
        out.append(
            draw(
                f"part {number}: light by normals, displaced", part.mesh(part.texture_coordinates, places),
                view, None, units, depth_test=FIRST_PASS, texture_shader=stages,
            )
        )  # fmt: skip
    return tuple(out)
