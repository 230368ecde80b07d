"""K22, plain multitexturing: how close unsigned texture environments come to Eq. 1, and what a sign costs.

With the symmetric matrix M = t t^T / ax^2 + b b^T / ay^2 of each texel,

    Eq. 1 = k_s (1 - h^T M h)+ = k_s (1 - sum of m_ii h_i^2 - sum of 2 m_ij h_i h_j)+.

Three of the six products are squares and have no sign. Textures hold m_ii / 4, vertex colours h_i^2, and an
unsigned board multiplies and adds them. The other three have a sign, which neither a texel nor a vertex
colour can carry. ``unsigned_passes`` leaves them out. No unsigned method is better: with t and b themselves,
each of the six products needs a sign and must then be squared, while Eq. 1 is linear in M. The missing terms
turn the lobe. So strokes along the texture's axes are right, and strokes along either diagonal give the same
round highlight.

``signed_passes`` has the sign nevertheless, with two unsigned halves of each factor and a framebuffer that is
inverted in between. A product takes four draws. A subtracted term must be scaled down, to leave room for the
terms that are added again. So the paper's judgement, that unsigned environments and two textures are too
little, is about one pass. A board with any number of passes could have Eq. 1. ``bumped_diffuse_passes``
computes K10's dot product from such halves.

M is linear in the textures, so it may be interpolated first. It has none of the rings of figure 2, except
those of (.)+. Eight bits are few for M if alpha is small: at 0.25 Eq. 1 has a sixteenth of M's range.

No environment sums the channels of a colour. Only INTERPOLATE adds a product to an earlier unit's result, and
it reduces that result's weight. So each product is a draw here, and one of two units is idle.

Source: Kautz, Seidel 2000, section 5 (K22 of the catalogue; its line in section 2.6);
ARB_texture_env_combine. The quadratic form: Inferred, from Eq. 1.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.geometry.vertex_vectors import half_vectors
from fixedpipe.effects.passes.arguments import checked_rgb
from fixedpipe.effects.passes.draws import (
    ADD,
    FIRST_PASS,
    INVERT_DESTINATION,
    LATER_PASS,
    MODULATE,
    MULTIPLY_DESTINATION,
    MULTIPLY_DESTINATION_TWICE,
    REPEATED,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.technique import Technique, Variant
from fixedpipe.pipeline.commands import Saturate, TexImage
from fixedpipe.pipeline.enums import (
    CombineFunction,
    CombineOperand,
    CombineSource,
    InternalFormat,
    TextureEnvironmentMode,
)
from fixedpipe.pipeline.state import Combine, TextureEnvironment
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (
    Technique("K22", "plain multitexturing, which the paper finds too limited", "5"),
    Variant(("K10",), "by unsigned texture environments"),
)

# What a stored one is worth: entries of M up to it, alpha from 0.5 on. RGB_SCALE goes no higher.
LARGEST = 4.0
_SQUARES = ((0, 0), (1, 1), (2, 2))
_CROSSES = ((0, 1), (0, 2), (1, 2))
_AXES = "xyz"

_MODULATE_BY_FOUR = TextureEnvironment(
    TextureEnvironmentMode.COMBINE,
    rgb=Combine(
        CombineFunction.MODULATE,
        (CombineSource.TEXTURE, CombineSource.PREVIOUS),
        (CombineOperand.SRC_COLOR, CombineOperand.SRC_COLOR),
        scale=LARGEST,
    ),
)


@dataclass(frozen=True)
class ProductNames:
    """The names of a material's texture objects: k_s, and the products that are not zero everywhere.

    ``squares``: (i, name) of m_ii / 4. ``crosses``: (i, j, sign, name) of (sign m_ij)+ / 2.
    """

    k_s: str
    squares: tuple[tuple[int, str], ...]
    crosses: tuple[tuple[int, int, int, str], ...]


def quadratic_form(material, i, j):
    """m_ij of M: float64 [rows, columns]."""
    t, b = material.scaled_tangents, material.scaled_binormals
    return t[..., i] * t[..., j] + b[..., i] * b[..., j]


def load(material, name, profile):
    """Commands that load the textures that the passes multiply, and their names.

    Raises ValueError for a material with an entry of M above ``LARGEST``: an alpha below 0.5.
    """
    commands = []

    def luminance(what, values):
        image = texture_2d(factor_texels(values, profile)[..., None], InternalFormat.LUMINANCE8)
        commands.append(TexImage(label=f"load {what} of {name}", texture=f"{name} {what}", image=image))
        return f"{name} {what}"

    k_s, squares, crosses = luminance("k_s", material.k_s), [], []
    for i, _ in _SQUARES:
        entry = quadratic_form(material, i, i)
        if entry.max() > LARGEST:
            raise ValueError(
                f"The material's alpha goes down to {min(material.alpha_x.min(), material.alpha_y.min()):g}; "
                "the products are stored over 4, so give at least 0.5."
            )
        if entry.any():
            squares.append((i, luminance(f"m_{_AXES[i]}{_AXES[i]} / 4", entry / LARGEST)))
    for i, j in _CROSSES:
        entry = quadratic_form(material, i, j)
        for sign, word in ((1, ""), (-1, "-")):
            half = np.maximum(0.0, sign * entry)
            if half.any():
                what = f"({word}m_{_AXES[i]}{_AXES[j]})+ / 2"
                crosses.append((i, j, sign, luminance(what, 2.0 * half / LARGEST)))
    return tuple(commands), ProductNames(k_s, tuple(squares), tuple(crosses))


def _grey(values):
    return np.repeat(values[:, None], 3, axis=1)


class _Passes:
    """Draws of one surface into its framebuffer; the first of them replaces."""

    def __init__(self, surface, view):
        self.surface, self.view, self.out = surface, view, []

    def add(self, label, colors=None, units=(), blending=ADD):
        first = not self.out
        self.out.append(
            draw(
                label,
                self.surface.mesh(colors=colors),
                self.view,
                None,
                units,
                depth_test=FIRST_PASS if first else LATER_PASS,
                blending=None if first else blending,
            )
        )

    def saturate(self, label):
        self.out.append(Saturate(label=label, scissor=self.view.panel.scissor))

    def add_squares(self, names, half, environment, sampler):
        for i, texture in names.squares:
            units = (unit(texture, sampler, environment=environment),)
            self.add(f"m_{_AXES[i]}{_AXES[i]} h_{_AXES[i]}^2", _grey(half[:, i] * half[:, i]), units)

    def add_crosses(self, names, half, sign, sampler):
        """The products whose sign is ``sign``: both factors' halves of one sign, and of the other."""
        for i, j, sign_of_texel, texture in names.crosses:
            product = np.maximum(0.0, sign * sign_of_texel * half[:, i] * half[:, j])
            units = (unit(texture, sampler, environment=MODULATE),)
            minus = "-" if sign * sign_of_texel < 0 else ""
            label = f"2 |m_{_AXES[i]}{_AXES[j]}| ({minus}h_{_AXES[i]} h_{_AXES[j]})+"
            self.add(f"plus {label}", _grey(product), units)

    def finish(self, names, specular, sampler):
        """k_s (1 - destination), of what the framebuffer holds, which is one at most."""
        self.saturate("at most one")
        colors = np.tile(np.array(checked_rgb(specular)), (len(self.surface.positions), 1))
        units = (unit(names.k_s, sampler, environment=MODULATE),)
        self.add("k_s times one minus that", colors, units, INVERT_DESTINATION)
        return tuple(self.out)


def unsigned_passes(surface, names, view, light, profile, *, specular=(1.0, 1.0, 1.0), sampler=REPEATED):
    """k_s (1 - sum of m_ii h_i^2)+: three draws for a flat material, four for bumps; they replace.

    ``specular``: RGB in [0, 1], by which k_s is multiplied.
    """
    passes = _Passes(surface, view)
    passes.add_squares(names, half_vectors(surface, view, light), _MODULATE_BY_FOUR, sampler)
    return passes.finish(names, specular, sampler)


def signed_passes(surface, names, view, light, profile, *, specular=(1.0, 1.0, 1.0), sampler=REPEATED):
    """Eq. 1 whole: eleven draws for a flat material of all orientations, up to twenty for bumps.

    Sums are kept over 4 until the last product is in: (squares + positive products) / 4 is inverted, the
    negative products are added, that is inverted again and doubled twice. A board of 8 bits has a quarter of
    its steps left. For a flat material saturation does no harm: a fragment has positive or negative products,
    never both, and the squares' sum is at most 4.
    """
    half, passes = half_vectors(surface, view, light), _Passes(surface, view)
    passes.add_squares(names, half, MODULATE, sampler)
    passes.add_crosses(names, half, 1, sampler)
    passes.add("one minus that", blending=INVERT_DESTINATION)
    passes.add_crosses(names, half, -1, sampler)
    passes.add("one minus that", blending=INVERT_DESTINATION)
    passes.saturate("(.)+: the framebuffer does not fall below zero")
    for _ in range(2):
        passes.add("twice that", blending=MULTIPLY_DESTINATION_TWICE)
    return passes.finish(names, specular, sampler)


def diffuse_pass(surface, names, view, light, profile, *, color, ambient=(0.0, 0.0, 0.0), sampler=REPEATED):
    """The smooth surface's (n.l)+ at the vertices, times color, plus ambient, all times k_s: added."""
    vectors = surface.to_local(light.light_vectors(surface.positions))
    color, ambient = checked_rgb(color), checked_rgb(ambient, "The ambient light's colour")
    lit = np.maximum(0.0, vectors[:, 2:]) * np.array(color) + np.array(ambient)
    units = (unit(names.k_s, sampler, environment=MODULATE),)
    return (draw("k_s (color (n.l)+ + ambient)", surface.mesh(colors=lit), view, None, units, blending=ADD),)


# ------------------------------------------------------------------------------- (n.l)+ of a normal map


def load_normals(normals, name, profile):
    """Commands that load the two unsigned halves of a normal map's components, and their names by (component,
    sign). Halves that are zero everywhere are left out. ``normals``: float64 [rows, columns, 3].
    """
    commands, names = [], {}
    for i, axis in enumerate(_AXES):
        for sign, word in ((1, ""), (-1, "-")):
            half = np.maximum(0.0, sign * normals[..., i])
            if half.any():
                texture = f"{name} ({word}n_{axis})+"
                names[i, sign] = texture
                image = texture_2d(factor_texels(half, profile)[..., None], InternalFormat.LUMINANCE8)
                commands.append(TexImage(label=f"load {texture}", texture=texture, image=image))
    return tuple(commands), names


def bumped_diffuse_passes(
    surface, names, view, light, profile, *, color, ambient=(0.0, 0.0, 0.0), sampler=REPEATED
):
    """K10's color (n.l)+ + ambient without a sign: a draw for each product of two halves, up to fourteen with
    what inverts and colours. They replace what the framebuffer holds where depths are equal.

    Positive products sum to one at most, and negative ones as well, so nothing saturates; (.)+ is the
    framebuffer's. ``names``: from ``load_normals``. The surface has been drawn, so that depths are there.
    """
    toward, passes = surface.to_local(light.light_vectors(surface.positions)), []

    def add(label, colors, texture=None, blending=ADD):
        units = () if texture is None else (unit(texture, sampler, environment=MODULATE),)
        passes.append(draw(label, surface.mesh(colors=colors), view, None, units, blending=blending))

    def add_products(sign):
        for (i, of_texel), texture in names.items():
            half = _grey(np.maximum(0.0, sign * of_texel * toward[:, i]))
            label = f"plus ({'-' * (of_texel < 0)}n_{_AXES[i]})+ ({'-' * (sign * of_texel < 0)}l_{_AXES[i]})+"
            add(label, half, texture)

    black, white = np.zeros((len(toward), 3)), None
    add("black", black, blending=None)
    add_products(1)
    add("one minus that", white, blending=INVERT_DESTINATION)
    add_products(-1)
    add("one minus that", white, blending=INVERT_DESTINATION)
    clamp = Saturate(label="(.)+: the framebuffer does not fall below zero", scissor=view.panel.scissor)
    passes.append(clamp)
    colors = np.tile(np.array(checked_rgb(color)), (len(toward), 1))
    add("times the color", colors, blending=MULTIPLY_DESTINATION)
    add("plus ambient", black + np.array(checked_rgb(ambient, "The ambient light's colour")))
    return tuple(passes)
