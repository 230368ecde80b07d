"""K15, dependent lookups by pixel textures on the Octane: the Banks model (K03), the anisotropic Blinn-Phong
model (K05, K06) and Ward's model (K09), every copy a command.

The parameter stage loads a material texture through the color matrix, which holds a light, viewing or
halfway vector, and draws the polygon; color masks put each parameter into a channel of the framebuffer, and
blending multiplies and adds parameters. A lookup copies the framebuffer onto itself (CopyPixels): its pixel
transfer moves the channels that hold the parameters to red and green, which become s and t, and sets alpha,
which becomes q, to one; the texel replaces a channel or is multiplied with it by blending. So every channel,
alpha too, can hold a parameter.

The paper has pixels read to host memory and drawn again (section 5), which is what DrawPixels needs; the
extension lets copies do the same, and then nothing leaves the board. ``through_host`` makes the paper's
commands of these: bit for bit the same picture, four bytes a pixel each way.

The color matrix holds one vector: a directional light, an infinite viewer and a flat surface are needed, as
the paper says. The stencil buffer marks the polygon's pixels, so that copies of the panel leave others alone.
The result replaces what the polygon covers; a diffuse pass is added afterwards.

``bits``: 8, or on the Octane 12, of the textures; the framebuffer's width is ``execute``'s ``color_bits``.

Source: Kautz, Seidel 2000, sections 3.1 to 3.3, 4.2 and 5; SGIX_pixel_texture; pass sequences A-K03, A-K05,
A-K06, A-K08 and A-K09 of the catalogue (K15: its cost).
"""

import math
from functools import lru_cache

import numpy as np

from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors, view_vectors
from fixedpipe.effects.passes.draws import (
    ADD,
    EDGE,
    FIRST_PASS,
    LATER_PASS,
    MARK,
    MARKED,
    MULTIPLY_DESTINATION,
    REPEATED,
    REPLACE,
    SUBTRACT_FROM_SOURCE,
    checked_rgb,
    one_of,
    positive,
)
from fixedpipe.effects.reflectance import brdfs
from fixedpipe.effects.reflectance.sampled_functions import (
    LARGEST_M,
    LARGEST_S_NL,
    power,
    sampled,
    stored_exponent,
)
from fixedpipe.pipeline.commands import Clear, CopyPixels, Draw, DrawPixels, HostStep, ReadPixels, TexImage
from fixedpipe.pipeline.enums import InternalFormat, PixelCopyType
from fixedpipe.pipeline.pixel_transfer import PixelImage, PixelTransfer
from fixedpipe.pipeline.state import (
    ColorMask,
    ColorTable,
    PassState,
    PixelTexture,
    RasterPosition,
    TextureUnit,
)

RED = ColorMask(green=False, blue=False, alpha=False)
GREEN = ColorMask(red=False, blue=False, alpha=False)
BLUE = ColorMask(red=False, green=False, alpha=False)
ALPHA = ColorMask(red=False, green=False, blue=False)
GREEN_BLUE = ColorMask(red=False, alpha=False)
BLUE_ALPHA = ColorMask(red=False, green=False)
NOT_RED = ColorMask(red=False)
RGB = ColorMask(alpha=False)
RGBA = ColorMask()

# Rows of a colour matrix: what a component of the result is made of.
FROM_RED, FROM_GREEN, FROM_BLUE, FROM_ALPHA = (tuple(row) for row in np.eye(4).tolist())
NOTHING = (0.0, 0.0, 0.0, 0.0)

_FORMATS = {8: InternalFormat.RGBA8, 12: InternalFormat.RGBA12}

# R(s) = sqrt(1 - s) falls with infinite slope at s = 1: 2048 texels, the Octane's most, leave an error of
# sqrt(1/2 / 2048) = 0.016 between the last two, which codes of eight bits never meet (erratum E004.16).
ROOT_TEXELS = 2048
# F(N, e): Source: pass sequence A-K05.
EXPONENT_TEXELS, BASE_TEXELS = 64, 256
# E(m, d), steep in m: within half a texel of m = 0, the highlight's middle, it is E(0, d), off by less than
# 8 / 2048. Assumed: so many fit; the catalogue names no size.
M_TEXELS, D_TEXELS = 1024, 128
# Ward's S(p) is stored over its largest value, 8, and clamped beyond: p < 1/64. Source: A-K09, P18.
LARGEST_S = 8.0


# ------------------------------------------------------------------------------------- parameter stage


def _same(index):
    return index


def _square(index):
    """The square of d where the index is (d + 1) / 2."""
    return (2.0 * index - 1.0) ** 2


@lru_cache(maxsize=8)
def _color_table(functions, size):
    """A table after the color matrix: a function for each of R, G, B and A, of an index in [0, 1]."""
    index = np.arange(size) / (size - 1.0)
    return ColorTable(tuple(zip(*(function(index).tolist() for function in functions), strict=True)))


def _table_size(profile):
    # The Octane's largest, for each value of twelve bits; finer where nothing else is rounded.
    return min(profile.max_color_table_size, 1 << 14)


def _tabulated(profile, *functions):
    return _color_table(functions, _table_size(profile))


def _clamped(profile):
    """What makes (.)+ of the color matrix's results: on machines what they are stored in is not negative."""
    return _tabulated(profile, *[_same] * 4) if profile.exact else None


def flat_vector(vectors, what):
    """The one vector [3] that all vertices have. Raises ValueError, naming ``what``, where they differ."""
    spread = float(np.abs(vectors - vectors[0]).max())
    if not spread <= 1e-6:
        raise ValueError(
            f"The {what} changes by {spread:.2g} over the surface, and a color matrix holds one; give a flat "
            "surface, a directional light and an infinite viewer, or draw polygon after polygon."
        )
    return vectors[0]


def dot_with(vector, scale=1.0):
    """A row of the color matrix: the dot product of a texel's RGB with a vector, times ``scale``."""
    return (*(scale * float(c) for c in vector), 0.0)


def _format(bits):
    return _FORMATS[one_of(tuple(_FORMATS), bits, "The textures' bits")]


def _image(values, alpha=1.0):
    """Floats [h, w, 3], or [h, w] for R, G and B alike, as an image; alpha is one, or floats [h, w]."""
    values = values[..., None] if values.ndim == 2 else values
    image = np.empty((*values.shape[:2], 4))
    image[..., :3], image[..., 3] = values, alpha
    return PixelImage(image)


def load_products(label, name, values, rows, profile, bits=8, *, alpha=1.0):
    """The command that loads float vectors [h, w, 3], and alphas, through a color matrix whose rows make dot
    products; negative ones are 0.
    """
    transfer = PixelTransfer(color_matrix=tuple(rows), post_color_matrix_color_table=_clamped(profile))
    return TexImage(
        label=label,
        texture=name,
        pixels=_image(values, alpha),
        internal_format=_format(bits),
        transfer=transfer,
    )


def load_squares(label, name, vectors, half, profile, bits=8, *, scale=1.0):
    """The command that loads (v.h)^2 scale into R, G, B and A: products biased to (d + 1)/2 for the sake of
    their sign, squared by the table after the color matrix. Beyond 1 they are 1.
    """
    transfer = PixelTransfer(
        color_matrix=(dot_with(half, math.sqrt(scale)),) * 4,
        post_color_matrix_scale=(0.5,) * 4,
        post_color_matrix_bias=(0.5,) * 4,
        post_color_matrix_color_table=_tabulated(profile, *[_square] * 4),
    )
    return TexImage(
        label=label, texture=name, pixels=_image(vectors), internal_format=_format(bits), transfer=transfer
    )


def begin(view):
    """The command that unmarks the panel's pixels."""
    return Clear(label="no pixel is the polygon's yet", stencil=0, scissor=view.panel.scissor)


def polygon(label, surface, view, texture=None, *, first=False, mask=RGBA, blending=None, sampler=REPEATED):
    """Draw the polygon with a texture, or white; the ``first`` time its pixels are marked."""
    units = () if texture is None else (TextureUnit(texture, sampler, environment=REPLACE),)
    state = PassState(
        vertex=view.vertex,
        texture_units=units,
        scissor=view.panel.scissor,
        stencil_test=MARK if first else None,
        depth_test=FIRST_PASS if first else LATER_PASS,
        blending=blending,
        color_mask=mask,
    )
    return Draw(label=label, mesh=surface.mesh(), state=state)


# -------------------------------------------------------------------------------- copies and lookups


def copied(label, view, rows, profile, *, mask=RGB, blending=None):
    """Copy the marked pixels of the panel onto themselves through a color matrix; negative results are 0."""
    return _copy(label, view, (*rows, NOTHING), mask, blending, table=_clamped(profile))


def looked_up(label, view, table, s, t=NOTHING, *, mask=RGB, blending=None):
    """A pixel texture: marked pixels become the texels of ``table`` at (s, t), rows of a color matrix."""
    unit = TextureUnit(table, EDGE, environment=REPLACE)
    return _copy(label, view, (s, t, NOTHING, NOTHING), mask, blending, (unit,), PixelTexture())


def _copy(label, view, rows, mask, blending, units=(), pixel_texture=None, table=None):
    panel = view.panel
    return CopyPixels(
        label=label,
        x=panel.x,
        y=panel.y,
        width=panel.width,
        height=panel.height,
        state=PassState(texture_units=units, stencil_test=MARKED, blending=blending, color_mask=mask),
        position=RasterPosition(position=(float(panel.x), float(panel.y), 0.0, 1.0), window=True),
        # Alpha is one whatever the framebuffer's holds: q divides s and t.
        transfer=PixelTransfer(
            color_matrix=tuple(map(tuple, rows)),
            post_color_matrix_bias=(0.0, 0.0, 0.0, 1.0),
            post_color_matrix_color_table=table,
        ),
        pixel_texture=pixel_texture,
    )


def through_host(commands, type="UNSIGNED_BYTE"):
    """The commands with every copy of colours made by way of the host's memory: ReadPixels, and DrawPixels of
    what was read with the copy's pixel transfer and pixel texture.

    ``type``: of ReadPixels; FLOAT keeps a framebuffer's twelve bits.
    """
    out = []
    for number, command in enumerate(commands):
        out += _by_host(command, f"copy {number}: {command.label}", type) if _copies(command) else (command,)
    return tuple(out)


def _copies(command):
    return isinstance(command, CopyPixels) and command.type is PixelCopyType.COLOR


def _by_host(copy, name, type):
    box = {"x": copy.x, "y": copy.y, "width": copy.width, "height": copy.height}
    same = {k: getattr(copy, k) for k in ("label", "state", "position", "zoom", "transfer", "pixel_texture")}

    def drawn(pixels):
        return (DrawPixels(image=PixelImage(pixels[name]), **same),)

    return (
        ReadPixels(label="read to host memory", name=name, type=type, read_buffer=copy.read_buffer, **box),
        HostStep(label=f"the host: {copy.label}", reads=(name,), commands=drawn),
    )


def _colored(color):
    """Rows that make a colour of one value: times the colour's components."""
    return [(c, 0.0, 0.0, 0.0) for c in checked_rgb(color)]


# -------------------------------------------------------------------------------------------- models


def banks(
    surface,
    material,
    view,
    light,
    profile,
    *,
    specular=(1.0, 1.0, 1.0),
    bits=8,
    sampler=REPEATED,
    exponent=1.0,
):
    """K03: k_s (n.l)+ (R((v.t)^2) R((l.t)^2) - (v.t)(l.t))+ with R(s) = sqrt(1 - s) looked up twice.

    The product (v.t)(l.t) has a sign and framebuffers have none: its halves (v.t l.t)+ and (-v.t l.t)+ are
    made by multiplying the halves of either factor, four products in the four channels. The last copy's
    color matrix subtracts the first and adds the second. Four copies, two of them lookups.

    Parameters
    ----------
    surface, view, light
        A flat surface (``meshes``), an infinite viewer and a directional light (``views``).
    material
        A ``material_textures.Material``; its alphas take no part.
    specular
        RGB in [0, 1], by which k_s is multiplied.
    bits
        8 or 12: of the textures.
    exponent
        To which the bracket is raised, positive: 1 as the paper prints, or Banks's own (erratum E004.2), by a
        lookup and so a copy more.

    Raises ValueError where the vectors change over the surface.
    """
    toward_light = flat_vector(light_vectors(surface, light), "light vector")
    toward_eye = flat_vector(view_vectors(surface, view), "viewing vector")

    def halves(vector, order):
        return [dot_with(vector, sign) for sign in order]

    drawn = {"surface": surface, "view": view, "sampler": sampler}
    raised, exponent = (), positive(exponent, "The bracket's exponent")
    if exponent != 1.0:
        table = sampled(lambda b: b**exponent, ROOT_TEXELS, profile=profile, bits=bits)
        raised = (
            TexImage(label=f"load b^{exponent:g}", texture="power", image=table),
            looked_up(f"look up the bracket's power {exponent:g}", view, "power", FROM_RED),
        )
    return (
        TexImage(
            label="load R(s) = sqrt(1 - s)",
            texture="R",
            image=sampled(brdfs.banks_r, ROOT_TEXELS, profile=profile, bits=bits),
        ),
        begin(view),
        load_products(
            "load t through v: halves of v.t",
            "v.t",
            material.tangents,
            halves(toward_eye, (1, -1, 1, -1)),
            profile,
            bits,
        ),
        polygon("(v.t)+, (-v.t)+, (v.t)+, (-v.t)+", texture="v.t", first=True, **drawn),
        load_products(
            "load t through l: halves of l.t",
            "l.t",
            material.tangents,
            halves(toward_light, (1, -1, -1, 1)),
            profile,
            bits,
        ),
        polygon(
            "times (l.t)+, (-l.t)+, (-l.t)+, (l.t)+", texture="l.t", blending=MULTIPLY_DESTINATION, **drawn
        ),
        copied(
            "(v.t l.t)+ to green, (-v.t l.t)+ to blue",
            view,
            (NOTHING, (1.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 1.0)),
            profile,
            mask=GREEN_BLUE,
        ),
        load_squares("load t through v: (v.t)^2", "(v.t)^2", material.tangents, toward_eye, profile, bits),
        polygon("(v.t)^2 to alpha", texture="(v.t)^2", mask=ALPHA, **drawn),
        looked_up("look up R((v.t)^2), to red", view, "R", FROM_ALPHA, mask=RED),
        load_squares("load t through l: (l.t)^2", "(l.t)^2", material.tangents, toward_light, profile, bits),
        polygon("(l.t)^2 to alpha", texture="(l.t)^2", mask=ALPHA, **drawn),
        looked_up(
            "look up R((l.t)^2), times red", view, "R", FROM_ALPHA, mask=RED, blending=MULTIPLY_DESTINATION
        ),
        copied("R R - (v.t l.t)+ + (-v.t l.t)+", view, ((1.0, -1.0, 1.0, 0.0),) * 3, profile, mask=RGBA),
        *raised,
        *_times_normal_light(material, toward_light, profile, bits, **drawn),
        *_times_gloss(material.k_s, specular, profile, bits, **drawn),
    )


def _times_normal_light(material, toward_light, profile, bits, *, gain=1.0, mask=RGB, **drawn):
    what = "(n.l)+" if gain == 1.0 else f"min(1, {gain:g} (n.l)+)"
    return (
        load_products(
            f"load n through l: {what}",
            "n.l",
            material.normals,
            [dot_with(toward_light, gain)] * 4,
            profile,
            bits,
        ),
        polygon(f"times {what}", texture="n.l", mask=mask, blending=MULTIPLY_DESTINATION, **drawn),
    )


def _times_gloss(k_s, specular, profile, bits, *, what="k_s", **drawn):
    rows = [*_colored(specular), FROM_RED]
    return (
        load_products(f"load {what}", "k_s", k_s, rows, profile, bits),
        polygon(f"times {what}", texture="k_s", mask=RGB, blending=MULTIPLY_DESTINATION, **drawn),
    )


def power_table(profile, bits=8):
    """F's texture: log2(N) / 7 along its columns, e along its rows."""
    return sampled(power, EXPONENT_TEXELS, BASE_TEXELS, profile=profile, bits=bits)


def root_table(profile, bits=8):
    """The texture of sqrt(e), F(N, e) at N = 1 (K06)."""
    return sampled(np.sqrt, ROOT_TEXELS, profile=profile, bits=bits)


def blinn_phong(
    surface,
    material,
    view,
    light,
    profile,
    *,
    specular=(1.0, 1.0, 1.0),
    bits=8,
    sampler=REPEATED,
    with_exponent=True,
    gated=False,
    stage=None,
):
    """K05: k_s F(N, e) with F(N, e) = (sqrt e)^N looked up, e = 1 - (h.t/ax)^2 - (h.b/ay)^2 and N per texel;
    K06, where not ``with_exponent``: k_s sqrt(e), a one-dimensional lookup.

    e is made in three passes, as ``imaging_subset`` makes Eq. 1 (K08). The image of N, coded as log2(N) / 7,
    takes its place in red by a color mask, and the lookup reads s from red and t from green. One copy. Alphas
    below 1/4 are allowed.

    ``gated``: times min(1, 4 (n.l)+), as ``diffuse_bump`` gates the register combiners' pass. ``stage``:
    None; or "coordinates" or "lookup": end before or after the lookup. The other parameters are those of
    ``banks``.
    """
    one_of((None, "coordinates", "lookup"), stage, "The stage")
    half = flat_vector(half_vectors(surface, view, light), "halfway vector")
    scaled_t = material.tangents / material.alpha_x[..., None]
    scaled_b = material.binormals / material.alpha_y[..., None]
    drawn = {"surface": surface, "view": view, "sampler": sampler}
    if with_exponent:
        table = TexImage(label="load F(N, e) = (sqrt e)^N", texture="F", image=power_table(profile, bits))
        lookup = (
            load_products(
                "load log2(N) / 7",
                "N",
                stored_exponent(material.exponent),
                [FROM_RED] * 4,
                profile,
                bits,
            ),
            polygon("N to red", texture="N", mask=RED, **drawn),
            looked_up("look up F(N, e)", view, "F", FROM_RED, FROM_GREEN),
        )
    else:
        table = TexImage(label="load sqrt(e)", texture="F", image=root_table(profile, bits))
        lookup = (looked_up("look up sqrt(e)", view, "F", FROM_GREEN),)
    gate = ()
    if gated:
        toward_light = flat_vector(light_vectors(surface, light), "light vector")
        gate = _times_normal_light(material, toward_light, profile, bits, gain=4.0, **drawn)
    shaded = (*_times_gloss(material.k_s, specular, profile, bits, **drawn), *gate)
    if stage is not None:
        lookup, shaded = lookup if stage == "lookup" else lookup[:-1], ()
    return (
        table,
        begin(view),
        load_squares("load t/ax through h: (h.t/ax)^2", "(h.t)^2", scaled_t, half, profile, bits),
        polygon("(h.t/ax)^2", texture="(h.t)^2", first=True, **drawn),
        load_squares("load b/ay through h: (h.b/ay)^2", "(h.b)^2", scaled_b, half, profile, bits),
        polygon("plus (h.b/ay)^2", texture="(h.b)^2", mask=RGB, blending=ADD, **drawn),
        polygon("e: one minus it", mask=RGB, blending=SUBTRACT_FROM_SOURCE, **drawn),
        *lookup,
        *shaded,
    )


def diffuse(
    surface, material, view, light, profile, *, color, ambient=(0.0, 0.0, 0.0), bits=8, sampler=REPEATED
):
    """K10 by the color matrix: (n.l)+ color + ambient, RGB in [0, 1] each, added to what the polygon covers.

    The table after the color matrix multiplies by the colour and adds the ambient term.
    """
    toward_light = flat_vector(light_vectors(surface, light), "light vector")
    index = np.arange(_table_size(profile)) / (_table_size(profile) - 1.0)
    color, ambient = checked_rgb(color), checked_rgb(ambient, "The ambient light's colour")
    columns = [c * index + a for c, a in zip((*color, 1.0), (*ambient, 0.0), strict=True)]
    transfer = PixelTransfer(
        color_matrix=(dot_with(toward_light),) * 4,
        post_color_matrix_color_table=ColorTable(tuple(map(tuple, np.stack(columns, axis=-1).tolist()))),
    )
    loading = TexImage(
        label="load n through l: (n.l)+ color + ambient",
        texture="diffuse",
        pixels=_image(material.normals),
        internal_format=_format(bits),
        transfer=transfer,
    )
    added = polygon("plus diffuse", surface, view, "diffuse", mask=RGB, blending=ADD, sampler=sampler)
    return (loading, added)


def ward(
    surface,
    material,
    view,
    light,
    profile,
    *,
    specular=(1.0, 1.0, 1.0),
    bits=8,
    sampler=REPEATED,
    largest_s=LARGEST_S,
    largest_m=LARGEST_M,
):
    """K09: k_s / (4 pi ax ay) S(p) E(m, d) (n.l)+ with S(p) = 1/sqrt(p) and E(m, d) = exp(-2 m / (1 + d))
    looked up; p = (l.n)(v.n), m = (h.t/ax)^2 + (h.b/ay)^2, d = h.n.

    p is spaced by its root, which is the product of the factors' roots and so of tables after the color
    matrix. S is stored over ``largest_s``, m over ``largest_m``; beyond they are clamped. The third copy
    takes ``largest_s`` back but for a factor of 2, which leaves room for S(p) (n.l)+; the next texture has
    that factor, divided by its largest value where it exceeds one, and a fourth copy then takes that back.
    Two copies are lookups. The smaller ``largest_s``, the more codes S has: 2 is enough for p >= 1/4. A bump
    that faces away from the eye, which cannot be seen, counts as p = 0.

    The other parameters are those of ``banks``. Raises ValueError likewise.
    """
    toward_light = flat_vector(light_vectors(surface, light), "light vector")
    toward_eye = flat_vector(view_vectors(surface, view), "viewing vector")
    half = flat_vector(half_vectors(surface, view, light), "halfway vector")
    scaled_t = material.tangents / material.alpha_x[..., None]
    scaled_b = material.binormals / material.alpha_y[..., None]
    largest_s, largest_m = positive(largest_s, "The largest S"), positive(largest_m, "The largest m")
    gloss = brdfs.ward_scale(material.alpha_x, material.alpha_y, material.k_s)
    most = max(1.0, LARGEST_S_NL * float(gloss.max()))
    drawn = {"surface": surface, "view": view, "sampler": sampler}
    roots = _tabulated(profile, np.sqrt, _same, _same, _same)

    def factor(name, vector, other):
        """sqrt(n.vector) in red, beside it ``other``."""
        transfer = PixelTransfer(
            color_matrix=(dot_with(vector), other, NOTHING, NOTHING), post_color_matrix_color_table=roots
        )
        return TexImage(
            label=f"load n through {name}",
            texture=name,
            pixels=_image(material.normals),
            internal_format=_format(bits),
            transfer=transfer,
        )

    restored = ()
    if most > 1.0:
        restored = (
            copied(
                f"times {most:.3g}",
                view,
                [_scaled(row, most) for row in (FROM_RED, FROM_GREEN, FROM_BLUE)],
                profile,
            ),
        )
    return (
        TexImage(
            label=f"load S(p) / {largest_s:g} over sqrt(p)",
            texture="S",
            image=sampled(
                lambda u: np.minimum(brdfs.ward_s(u * u) / largest_s, 1.0),
                ROOT_TEXELS,
                profile=profile,
                bits=bits,
            ),
        ),
        TexImage(
            label=f"load E(m / {largest_m:g}, d)",
            texture="E",
            image=sampled(
                lambda m, d: brdfs.ward_e(largest_m * m, d), M_TEXELS, D_TEXELS, profile=profile, bits=bits
            ),
        ),
        begin(view),
        factor("l", toward_light, dot_with(half)),
        polygon("sqrt((l.n)+) to red, d = h.n to green", texture="l", first=True, **drawn),
        factor("v", toward_eye, NOTHING),
        polygon("times sqrt((v.n)+): sqrt(p)", texture="v", mask=RED, blending=MULTIPLY_DESTINATION, **drawn),
        looked_up("look up S(p), to blue", view, "S", FROM_RED, mask=BLUE),
        load_squares(
            "load t/ax through h: (h.t/ax)^2", "(h.t)^2", scaled_t, half, profile, bits, scale=1.0 / largest_m
        ),
        polygon("(h.t/ax)^2 to red", texture="(h.t)^2", mask=RED, **drawn),
        load_squares(
            "load b/ay through h: (h.b/ay)^2", "(h.b)^2", scaled_b, half, profile, bits, scale=1.0 / largest_m
        ),
        polygon("plus (h.b/ay)^2: m", texture="(h.b)^2", mask=RED, blending=ADD, **drawn),
        looked_up(
            "look up E(m, d), times blue",
            view,
            "E",
            FROM_RED,
            FROM_GREEN,
            mask=BLUE,
            blending=MULTIPLY_DESTINATION,
        ),
        *_times_normal_light(material, toward_light, profile, bits, mask=BLUE, **drawn),
        copied(
            f"S(p) E(m, d) (n.l)+ / {LARGEST_S_NL:g}: times {largest_s / LARGEST_S_NL:g}",
            view,
            [_scaled(FROM_BLUE, largest_s / LARGEST_S_NL)] * 3,
            profile,
        ),
        *_times_gloss(
            gloss * (LARGEST_S_NL / most), specular, profile, bits, what="k_s / (4 pi ax ay)", **drawn
        ),
        *restored,
    )


def _scaled(row, factor):
    return tuple(factor * c for c in row)
