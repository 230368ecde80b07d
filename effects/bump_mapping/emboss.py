"""K13, embossing: bumps by the difference of two readings of one height map.

The second reading lies a little farther from the light. Where the surface faces the light, the height grows
that way. So the second reading minus the first is, to first order, the directional derivative -dh/dl, which
makes (n.l)+ differ from the smooth surface's. No vector is stored, and no dot product is computed per
fragment. A light right above the surface shades nothing, because a height map cannot tell this case from
level ground.

The coordinates of the second reading are those of NV_texgen_emboss, computed at the vertices as that
extension's hardware would. The extension takes the direction in which t grows from a unit's own coordinates.
So its B is -tangent, its T the binormal, and both coordinates move away from the light.

Three boards, with H0 and H1 the two readings, D the lit colour and S the highlight of the smooth surface at
the vertices:

    one unit              D (1 - H0); plus D H1
    two units, unsigned   H1 + (1 - H0) - 1/2; times 2 D
    register combiners    (n.l + 4 (H1 - H0))+ times a colour: the added term needs signs

A highlight is embossed in the same way, with the halfway vector in place of the light.

Source: Kautz, Seidel 2000, section 2 (K13 of the catalogue; pass sequence A-K13); NV_texgen_emboss; for the
passes, McReynolds and others 1998, from the catalogue's memory of it.
"""

from dataclasses import dataclass
from numbers import Real

import numpy as np

from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.passes.arguments import checked_rgb
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    CONSTANT1,
    PRIMARY,
    SPARE0,
    TEXTURE0,
    TEXTURE1,
    blue_of,
    expand,
    final,
    less_half,
    negated,
    product,
    program,
    scaled,
    signed,
    square,
    stage,
    total,
)
from fixedpipe.effects.passes.draws import (
    ADD,
    ADD_GATED,
    FIRST_PASS,
    LATER_PASS,
    MODULATE,
    MULTIPLY_DESTINATION_TWICE,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import factor_texels, vector_colors
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import (
    BlendFactor,
    CombineFunction,
    CombineOperand,
    CombineSource,
    InternalFormat,
    TextureEnvironmentMode,
)
from fixedpipe.pipeline.state import Blending, Combine, TextureEnvironment
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (Technique("K13", "embossing: bumps as the difference of two readings of a height map", "2"),)

# How much the boards multiply H1 - H0 by; the second reading moves by the relief over it, and what is added
# to one, or to n.l, is -dh/dl on each.
ONE_UNIT_GAIN, TWO_UNITS_GAIN, COMBINERS_GAIN = 1.0, 2.0, 4.0

ADD_TIMES_ALPHA = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE)

_ALPHA = Combine(CombineFunction.REPLACE, (CombineSource.PRIMARY_COLOR,), (CombineOperand.SRC_ALPHA,))
# C (1 - texel), with a texture environment colour of zero.
_INVERTED = TextureEnvironment(TextureEnvironmentMode.BLEND)
_ONE_MINUS_TEXEL = TextureEnvironment(
    TextureEnvironmentMode.COMBINE,
    rgb=Combine(CombineFunction.REPLACE, (CombineSource.TEXTURE,), (CombineOperand.ONE_MINUS_SRC_COLOR,)),
    alpha=_ALPHA,
)
_ADD_SIGNED = TextureEnvironment(
    TextureEnvironmentMode.COMBINE,
    rgb=Combine(
        CombineFunction.ADD_SIGNED,
        (CombineSource.TEXTURE, CombineSource.PREVIOUS),
        (CombineOperand.SRC_COLOR, CombineOperand.SRC_COLOR),
    ),
    alpha=_ALPHA,
)


@dataclass(frozen=True)
class HeightMap:
    """A height map's texture object and its relief: the height that is stored as one, in edges of the map."""

    texture: str
    relief: float


def load(heights, name, profile):
    """The command that loads a height field and its ``HeightMap``.

    ``heights``: numbers [rows, columns], bottom row first, in edges of the map. None is below zero, and at
    least one is above; the highest is stored as one. Raises ValueError for others.
    """
    heights = height_fields.numbers(heights)
    low, relief = float(heights.min()), float(heights.max())
    if not (low >= 0.0 and 0.0 < relief < np.inf):
        raise ValueError(f"The heights range over {low:g}..{relief:g}; give some above zero and none below.")
    image = texture_2d(factor_texels(heights / relief, profile)[..., None], InternalFormat.LUMINANCE8)
    return (TexImage(label=f"load {name}", texture=name, image=image),), HeightMap(name, relief)


def emboss_coordinates(normals, next_tangents, vectors, coordinates, constants):
    """What EMBOSS_MAP_NV generates: s and t of the second reading, float64 [n, 2].

    Parameters
    ----------
    normals, vectors
        N and L: float64 [n, 3], normals and unit vectors to the light in the same coordinates.
    next_tangents
        CT: float64 [n, 3], along which t grows and s does not: the surface's binormals.
    coordinates
        PCT: float64 [n, 2], the first unit's s and t; its q is one.
    constants
        (Ks, Kt), the EMBOSS_CONSTANT_NV: how far a vector along the surface moves s and t.

    Source: NV_texgen_emboss, section 2.10.4.
    """
    along_b = normalize(cross(normals, next_tangents))
    along_t = cross(along_b, normals)
    return np.stack(
        [
            coordinates[:, 0] + constants[0] * dot(vectors, along_b),
            coordinates[:, 1] - constants[1] * dot(vectors, along_t),
        ],
        axis=-1,
    )


def _coordinates(surface, height_map, vectors, gain):
    """Both readings' coordinates: the surface's own, and those moved away from ``vectors`` (world)."""
    constant = height_map.relief / gain
    coordinates = surface.texture_coordinates
    moved = emboss_coordinates(surface.normals, surface.binormals, vectors, coordinates, (constant, constant))
    return coordinates, moved


def _light_vectors(surface, light):
    return np.asarray(light.light_vectors(surface.positions))


def _half_vectors(surface, view, light):
    return normalize(_light_vectors(surface, light) + view.view_vectors(surface.positions))


def _lit(surface, light, color, ambient):
    """The smooth surface's colours at the vertices: color (n.l)+ + ambient, float64 [n, 3]."""
    n_l = np.maximum(0.0, dot(surface.normals, _light_vectors(surface, light)))
    color, ambient = checked_rgb(color), checked_rgb(ambient, "The ambient light's colour")
    return np.minimum(1.0, n_l[:, None] * np.array(color) + np.array(ambient))


def _shines(specular):
    """Whether there is a highlight. Raises ValueError where its strength is no number in [0, 1]."""
    if not (isinstance(specular, Real) and 0.0 <= specular <= 1.0):
        raise ValueError(f"The highlight's strength is {specular!r}; give one number from 0, for none, to 1.")
    return specular > 0.0


def _highlight(surface, view, light, specular):
    """The smooth surface's highlight at the vertices: specular (n.h)^16 where n.l > 0, float64 [n]."""
    power = np.maximum(0.0, dot(surface.normals, _half_vectors(surface, view, light)))
    for _ in range(4):
        power = power * power
    lit = dot(surface.normals, _light_vectors(surface, light)) > 0.0
    return specular * np.where(lit, power, 0.0)


def _difference_passes(what, surface, height_map, vectors, colors, view, *, first):
    """The colors times 1 + H1 - H0 with one unit: two draws, the second added; ``first``: they replace."""
    own, moved = _coordinates(surface, height_map, vectors, ONE_UNIT_GAIN)
    texture = height_map.texture
    return (
        draw(
            f"{what} (1 - H0)",
            surface.mesh(own, colors=colors),
            view,
            None,
            (unit(texture, environment=_INVERTED),),
            depth_test=FIRST_PASS if first else LATER_PASS,
            blending=None if first else ADD,
        ),
        draw(
            f"plus {what} H1, the height away from the {'light' if first else 'halfway vector'}",
            surface.mesh(moved, colors=colors),
            view,
            None,
            (unit(texture, environment=MODULATE),),
            blending=ADD,
        ),
    )


def one_unit_passes(
    surface, height_map, view, light, profile, *, color, ambient=(0.0, 0.0, 0.0), specular=0.0
):
    """Embossing with one texture unit and blending that only adds: two draws, or four with a highlight.

    ``color``, ``ambient``: RGB in [0, 1]; ``specular``: a white highlight's, in [0, 1], 0: none. The BLEND
    environment inverts the map. No bias is needed, because D and S take its place.
    """
    lit, vectors = _lit(surface, light, color, ambient), _light_vectors(surface, light)
    out = _difference_passes("lit color", surface, height_map, vectors, lit, view, first=True)
    if _shines(specular):
        halfway = _half_vectors(surface, view, light)
        grey = np.repeat(_highlight(surface, view, light, specular)[:, None], 3, axis=1)
        out += _difference_passes("highlight", surface, height_map, halfway, grey, view, first=False)
    return out


def two_unit_passes(
    surface, height_map, view, light, profile, *, color, ambient=(0.0, 0.0, 0.0), specular=0.0
):
    """Embossing with two units and unsigned environments: two draws, or three with a highlight.

    Parameters as for ``one_unit_passes``. The highlight's draw adds S (1/2 + H1 - H0), so it is half as
    bright where the surface is level.
    """
    texture = height_map.texture
    units = (
        unit(texture, environment=_ONE_MINUS_TEXEL),
        unit(texture, coordinates=1, environment=_ADD_SIGNED),
    )

    def readings(vectors, colors=None):
        coordinates = _coordinates(surface, height_map, vectors, TWO_UNITS_GAIN)
        return surface.mesh(*coordinates, colors=colors)

    lit = surface.mesh(colors=_lit(surface, light, color, ambient))
    out = (
        draw(
            "1/2 + H1 - H0",
            readings(_light_vectors(surface, light)),
            view,
            None,
            units,
            depth_test=FIRST_PASS,
        ),
        draw("times twice the lit color", lit, view, None, blending=MULTIPLY_DESTINATION_TWICE),
    )
    if _shines(specular):
        alpha = _highlight(surface, view, light, specular)[:, None]
        colors = np.concatenate([np.ones((len(alpha), 3)), alpha], axis=-1)
        mesh = readings(_half_vectors(surface, view, light), colors)
        label = "plus the highlight times 1/2 + H1 - H0, H1 away from the halfway vector"
        out += (draw(label, mesh, view, None, units, blending=ADD_TIMES_ALPHA),)
    return out


# 4 (H1 - H0) in spare 0.
_DIFFERENCE = scaled(4, total(TEXTURE1, negated(TEXTURE0), to=SPARE0))


def diffuse_combiners(color, ambient):
    """(n.l + 4 (H1 - H0))+ color + ambient with n.l in the primary colour; alpha: four times that, a gate."""
    return program(
        _DIFFERENCE,
        stage(
            total(signed(SPARE0), expand(PRIMARY), to=SPARE0),
            alpha=scaled(4, total(signed(blue_of(SPARE0)), expand(blue_of(PRIMARY)), to=SPARE0)),
        ),
        final(SPARE0, CONSTANT0, plus=CONSTANT1, alpha=SPARE0),
        constant0=color,
        constant1=ambient,
    )


def specular_combiners(specular):
    """((2 c x - 1)+)^4 of x = n.h + 4 (H1 - H0), with n.h in the primary colour and c such that x = 1 gives
    ``specular``.

    A highlight about as sharp as one of exponent 16; E times F squares once, A times B again.
    """
    c = 0.5 + 0.5 * float(np.sqrt(np.sqrt(specular)))
    c_x = total(product(signed(SPARE0), CONSTANT0), product(expand(PRIMARY), CONSTANT0), to=SPARE0)
    return program(
        _DIFFERENCE,
        scaled(2, less_half(c_x)),
        final(square(SPARE0), square(SPARE0)),
        constant0=(c, c, c),
    )


def combiner_passes(
    surface, height_map, view, light, profile, *, color, ambient=(0.0, 0.0, 0.0), specular=0.0
):
    """Embossing by register combiners: one draw, or two with a highlight.

    Parameters as for ``one_unit_passes``. Destination alpha keeps min(1, 4 (n.l)+), which gates the
    highlight.
    """
    units = (unit(height_map.texture), unit(height_map.texture, coordinates=1))

    def readings(vectors):
        coordinates = _coordinates(surface, height_map, vectors, COMBINERS_GAIN)
        cosines = np.repeat(dot(surface.normals, vectors)[:, None], 3, axis=1)
        return surface.mesh(*coordinates, colors=vector_colors(cosines, profile))

    lit = readings(_light_vectors(surface, light))
    label = "(n.l + 4 (H1 - H0))+"
    out = (draw(label, lit, view, diffuse_combiners(color, ambient), units, depth_test=FIRST_PASS),)
    if _shines(specular):
        shining = readings(_half_vectors(surface, view, light))
        label = "plus a highlight of n.h + 4 (H1 - H0), H1 away from the halfway vector"
        out += (draw(label, shining, view, specular_combiners(specular), units, blending=ADD_GATED),)
    return out
