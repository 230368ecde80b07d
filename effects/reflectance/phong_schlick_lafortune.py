"""K24, other reflectance models that fit the scheme: Phong with N per pixel, Schlick, one lobe of Lafortune.

A model fits if it consists of functions of at most two parameters each, and if the parameters are dot
products or results of lookups at dot products. These are the factors, for a directional light and an infinite
viewer:

Phong       c = r.v = 2 (n.l)(n.v) - l.v is a function C of (n.l, n.v), for l.v is constant; F(N, c) = c^N is
            a second one, with N per pixel. The framebuffer stores the first result and N.
Schlick     Z(h.n) A(w) is a function T of (h.t, h.b), for (h.n)^2 = 1 - (h.t)^2 - (h.b)^2 and w is h.t /
            sqrt((h.t)^2 + (h.b)^2); G(n.l) G(n.v) / (n.v) is a function of (n.l, n.v); Fresnel's S(h.v) is
            the vertices'. The framebuffer stores the first factor.
Lafortune   The diagonal matrix C, turned from the pixel's frame into the surface's, is a symmetric matrix M,
            and l M v = D.(l * v) + O.(l x v) with its diagonal D = (M_xx, M_yy, M_zz), the rest
            O = (M_yz, M_xz, M_xy), the products (l * v)_i = l_i v_i and (l x v)_x = l_y v_z + l_z v_y and so
            on. D and O are material textures, the products are the vertices': (a + b)^N is a function of two
            dot products.

With texture shaders (GeForce 3), stages multiply a material texture's vector by texture coordinates and look
two of the products up. Factors that wait in the framebuffer are copied into a texture. With pixel textures
(Octane), vectors must not change over the surface: ``phong_schlick_lafortune_copies``.

Source: Kautz, Seidel 2000, section 3.4 (K24 of the catalogue); NV_texture_shader; SGIX_pixel_texture.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.effects.bump_mapping.diffuse_bump import diffuse_pass
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors, view_vectors
from fixedpipe.effects.passes.arguments import checked_rgb, positive
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    PRIMARY,
    SPARE0,
    TEXTURE0,
    TEXTURE1,
    TEXTURE2,
    TEXTURE3,
    alpha_of,
    final,
    product,
    program,
    scaled,
)
from fixedpipe.effects.passes.draws import (
    ADD,
    ADD_GATED,
    EDGE,
    FIRST_PASS,
    REPEATED,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import dot_product_texels, factor_texels, vector_and_factor_texels
from fixedpipe.effects.passes.texture_shaders import (
    ALPHA_RED_STAGE,
    NO_TEXTURE,
    TEXTURE_STAGE,
    dot_product_stages,
)
from fixedpipe.effects.reflectance import brdfs
from fixedpipe.effects.reflectance.dependent_lookups import copy_screen, screen_unit
from fixedpipe.effects.reflectance.dot_product_lookups import centered_table
from fixedpipe.effects.reflectance.sampled_functions import LARGEST_LOGARITHM, sampled, stored_exponent
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import CombinerScale, DotProductMapping, InternalFormat, TextureTarget
from fixedpipe.pipeline.state import SignedComponents
from fixedpipe.pipeline.textures.images import Texture, texture_2d

TECHNIQUES = (Technique("K24", "other models that fit the framework: Phong, Schlick, Lafortune", "3.4"),)

# Texels of a table along either parameter. Source: figure F004-1 of the catalogue (256^2 tables, LINEAR).
TEXELS = 256
# c = r.v below one half is stored as zero, and 2 c - 1 above: a step of eight bits is then 1/510 of c. The
# highlight ends where it is 2^-N, 1/64 for N = 6; a smaller N shows that edge.
SMALLEST_C = 0.5
# The combiners' largest scale multiplies Schlick's two factors, each stored in [0, 1].
GAIN = 4.0
# Dot products of unit vectors lie in [-1, 1], which tables with a zero in their middle hold.
PERIOD = 2.0
# Texels (x, y) of 16 bits as unit vectors, and the signs of their high bytes for the filter.
HEMISPHERE = DotProductMapping.SIGNED_HILO_HEMISPHERE
FINE = replace(REPEATED, signed_components=SignedComponents(green=True, alpha=True))


# ------------------------------------------------------------------------------- the sampled functions


def phong_c(light_view):
    """C(n.l, n.v) = (2 (n.l)(n.v) - l.v - 1/2) / (1/2), as a function of both in [0, 1].

    ``light_view``: l.v.
    """

    def function(nl, nv):
        c = (2.0 * nl * nv - light_view - SMALLEST_C) / (1.0 - SMALLEST_C)
        # (n.l)+ is zero for all that face away from the light; a light opposite the eye would shine there.
        return np.where(nl > 0.0, c, 0.0)

    return function


def phong_f(exponent, c):
    """F(N, c) = c^N, N given as log2(N) / 7 and c as ``phong_c`` has it; zero where that is zero."""
    return np.where(
        c > 0.0,
        (SMALLEST_C + (1.0 - SMALLEST_C) * c) ** 2.0 ** (LARGEST_LOGARITHM * exponent),
        0.0,
    )


def schlick_peak(roughness, isotropy):
    """The largest value of Z(h.n) A(w), 1 / (r sqrt(p))."""
    for what, value in (("roughness", roughness), ("isotropy", isotropy)):
        if not 0.0 < value <= 1.0:
            raise ValueError(f"Schlick's {what} is {value!r}; give a number above 0 and at most 1.")
    return 1.0 / (roughness * math.sqrt(isotropy))


def schlick_t(roughness, isotropy):
    """T(h.t, h.b) = Z A over its largest value, as a function of both in [-1, 1]."""

    def function(x, y):
        across = x * x + y * y
        w = x / np.sqrt(np.where(across > 0.0, across, 1.0))
        t = np.sqrt(np.maximum(0.0, 1.0 - across))
        value = brdfs.schlick_z(t, roughness) * brdfs.schlick_a(w, isotropy)
        return value / schlick_peak(roughness, isotropy)

    return function


def schlick_o(roughness, largest):
    """G(n.l) G(n.v) / (n.v) over ``largest``, as a function of both in [0, 1]; at n.v = 0 its limit."""

    def function(nl, nv):
        seen = np.maximum(nv, 2.0**-40)
        return brdfs.schlick_g(nl, roughness) * brdfs.schlick_g(seen, roughness) / (seen * largest)

    return function


def schlick_largest(roughness, isotropy):
    """What G(n.l) G(n.v) / (n.v) is stored over: beyond it, at grazing views, it is clamped.

    With it the product of the stored factors, times GAIN, is the model. Raises ValueError where it is less
    than one, for then the factor would be clamped at views along the normal.
    """
    largest = GAIN * 4.0 * math.pi / schlick_peak(roughness, isotropy)
    if largest < 1.0:
        raise ValueError(
            f"Schlick's highlight of roughness {roughness:g} and isotropy {isotropy:g} is "
            f"{1.0 / largest:.3g} times brighter than {GAIN:g} factors of one; give a larger roughness."
        )
    return largest


def fresnel_factor(half, view, reflectance):
    """S(h.v). Raises ValueError where the reflectance at normal incidence is no number in [0, 1]."""
    if not 0.0 <= reflectance <= 1.0:
        raise ValueError(f"Schlick's reflectance is {reflectance!r}; give a number from 0 to 1.")
    return brdfs.schlick_fresnel(dot(half, view), reflectance)


def lafortune_f(exponent):
    """((a + b)+)^N as a function of the two dot products in [-1, 1]."""
    exponent = positive(exponent, "Lafortune's exponent")
    return lambda a, b: np.clip(a + b, 0.0, 1.0) ** exponent


def of_biased(function):
    """A function of numbers in [-1, 1] as one of (number + 1) / 2."""
    return lambda s, t: function(2.0 * s - 1.0, 2.0 * t - 1.0)


def load_function(label, name, function, profile):
    """The command that stores a function of two numbers in [0, 1] as a texture."""
    image = sampled(function, TEXELS, TEXELS, profile=profile)
    return TexImage(label=f"load {label}", texture=name, image=image)


# ------------------------------------------------------------------------------------------- materials


def lobe_matrix(material, coefficients):
    """Lafortune's matrix per texel in the surface's frame: its diagonal D and the rest O.

    ``coefficients``: C_x, C_y, C_z, of magnitudes below one. Returns two float64 [rows, columns, 3].
    """
    if np.shape(coefficients) != (3,) or not all(abs(c) <= 1.0 for c in coefficients):
        raise ValueError(f"Lafortune's coefficients are {coefficients!r}; give three numbers from -1 to 1.")
    frame = material.tangents, material.binormals, material.normals

    def entry(i, j):
        x, y, z = (c * v[..., i] * v[..., j] for c, v in zip(coefficients, frame, strict=True))
        return (x + y) + z

    pairs = ((0, 0), (1, 1), (2, 2)), ((1, 2), (0, 2), (0, 1))
    return tuple(np.stack([entry(i, j) for i, j in three], axis=-1) for three in pairs)


def lobe_vectors(light, view):
    """What D and O are multiplied by, of light and viewing vectors [n, 3]: (l * v, l x v), float64 [n, 3]."""
    turned = ((1, 2), (2, 0), (0, 1))
    mixed = [light[:, i] * view[:, j] + light[:, j] * view[:, i] for i, j in turned]
    return light * view, np.stack(mixed, axis=-1)


@dataclass(frozen=True)
class Names:
    """A material's texture objects.

    normal      n, for the diffuse pass
    fine        n as two words of 16 bits: x and y, from which a dot product makes z (HILO)
    exponent    k_s, and log2(N) / 7 in alpha
    tangent     t, and k_s in alpha
    binormal    b
    diagonal    Lafortune's D, and k_s in alpha
    rest        Lafortune's O
    """

    normal: str
    fine: str
    exponent: str
    tangent: str
    binormal: str
    diagonal: str
    rest: str


def load(material, name, profile, coefficients):
    """Commands that load a material's textures for texture shaders, and their ``Names``."""
    names = Names(*(f"{name} {what}" for what in ("n", "n, HILO", "k_s, N", "t, k_s", "b", "D, k_s", "O")))
    diagonal, rest = lobe_matrix(material, coefficients)
    factors = np.stack([material.k_s, stored_exponent(material.exponent)], axis=-1)

    def stored(vectors, alpha):
        return texture_2d(dot_product_texels(vectors, alpha, profile))

    images = {
        names.normal: ("normal", texture_2d(vector_and_factor_texels(material.normals, 1.0, profile))),
        names.fine: ("normal, 16 bits", _hilo(material.normals)),
        names.exponent: ("k_s, log2(N) / 7", texture_2d(factor_texels(factors, profile))),
        names.tangent: ("tangent, k_s", stored(material.tangents, material.k_s)),
        names.binormal: ("binormal", stored(material.binormals, 1.0)),
        names.diagonal: ("diagonal of Lafortune's matrix, k_s", stored(diagonal, material.k_s)),
        names.rest: ("rest of Lafortune's matrix", stored(rest, 1.0)),
    }
    return tuple(
        TexImage(label=f"load material texture of {name}: {what}", texture=texture, image=image)
        for texture, (what, image) in images.items()
    ), names


def _hilo(normals):
    """Normals [h, w, 3] with positive z as a HILO texture: x in alpha and red, y in green and blue.

    Bytes leave n.l and n.v off by about 1/300, which c = 2 (n.l)(n.v) - l.v doubles and N multiplies.
    Measured on the domes of figure K24: an RMS from Phong's model of 0.023 with bytes, 0.0034 with words.
    """
    x, y = (np.floor(32767.0 * normals[..., k] + 0.5).astype(np.int64) & 0xFFFF for k in (0, 1))
    texels = np.stack([x & 255, y >> 8, y & 255, x >> 8], axis=-1).astype(np.uint8)
    return Texture(TextureTarget.TEXTURE_2D, InternalFormat.HILO16, (texels[None],))


# ------------------------------------------------------------------------------ by texture shaders


def _one_value(cosines):
    """The one l.v that all vertices have. Raises ValueError where they differ."""
    low, high = float(cosines.min()), float(cosines.max())
    # Frames of curved surfaces are rounded, to 2^-20; a step of what is stored of c is 1/510.
    if high - low > 1e-4:
        raise ValueError(
            f"l.v changes from {low:.3g} to {high:.3g} over the surface, and the table of C(n.l, n.v) is "
            "made for one; give a directional light and an infinite viewer."
        )
    return low


def _diffuse(surface, names, view, light, profile, *, background, **colors):
    """The diffuse pass on a cleared panel; destination alpha keeps (n.l)+ itself, for Lafortune's lobe."""
    (pass_,) = diffuse_pass(surface, names.normal, view, light, profile, **colors)
    combiners = pass_.state.register_combiners
    first, second = combiners.general
    second = replace(second, alpha=replace(second.alpha, scale=CombinerScale.NONE))
    combiners = replace(combiners, general=(first, second))
    return (
        view.panel.clear(background),
        replace(pass_, state=replace(pass_.state, register_combiners=combiners)),
    )


def phong_passes(surface, names, view, light, profile, *, specular=(1.0, 1.0, 1.0), **shown):
    """Phong's model with N per pixel: k_s F(N, C(n.l, n.v)), two lookups one after the other.

    Parameters
    ----------
    surface, view, light
        The surface, an infinite viewer and a directional light.
    names
        The material's textures (``load``), N of 6 or more. ``dependent_lookups.load_screen`` has made room on
        this panel.
    specular
        RGB in [0, 1], by which k_s is multiplied.
    shown
        ``background`` of the panel, and ``color`` and ``ambient`` of the diffuse pass.

    Raises ValueError where l.v changes over the surface.
    """
    toward_light, toward_eye = light_vectors(surface, light), view_vectors(surface, view)
    light_view = _one_value(dot(toward_light, toward_eye))
    coordinates = surface.texture_coordinates
    parameters = draw(
        "parameter stage: c = 2 (n.l)(n.v) - l.v in red, N in alpha",
        surface.mesh(coordinates, toward_light, toward_eye),
        view,
        program(final(TEXTURE2, alpha=TEXTURE3)),
        (
            unit(names.fine, FINE),
            unit(NO_TEXTURE, coordinates=1),
            unit("C(n.l, n.v)", EDGE, 2),
            unit(names.exponent),
        ),
        depth_test=FIRST_PASS,
        texture_shader=(TEXTURE_STAGE, *dot_product_stages(0, 0, mapping=HEMISPHERE), TEXTURE_STAGE),
    )
    lookup = draw(
        "specular pass: look up F(N, c), times k_s",
        surface.mesh(coordinates, surface.positions),
        view,
        program(final(TEXTURE1, product(CONSTANT0, TEXTURE2)), constant0=specular),
        (screen_unit(view, 1), unit("F(N, c)", EDGE), unit(names.exponent)),
        blending=ADD,
        texture_shader=(TEXTURE_STAGE, ALPHA_RED_STAGE, TEXTURE_STAGE),
    )
    return (
        load_function("C(n.l, n.v) = 2 (n.l)(n.v) - l.v", "C(n.l, n.v)", phong_c(light_view), profile),
        load_function("F(N, c) = c^N", "F(N, c)", phong_f, profile),
        view.panel.clear((0.0, 0.0, 0.0)),
        parameters,
        copy_screen(view),
        *_diffuse(surface, names, view, light, profile, **shown),
        lookup,
    )


def schlick_passes(
    surface,
    names,
    view,
    light,
    profile,
    *,
    roughness,
    isotropy,
    reflectance,
    specular=(1.0, 1.0, 1.0),
    **shown,
):
    """Schlick's model times k_s: T(h.t, h.b), then times G(n.l) G(n.v) / (n.v) and S(h.v).

    ``roughness``, ``isotropy``, ``reflectance``: r, p and C of ``brdfs.schlick``. The others are those of
    ``phong_passes``; l.v may change. Raises ValueError if the highlight is too bright to be stored.
    """
    toward_light, toward_eye = light_vectors(surface, light), view_vectors(surface, view)
    half, coordinates = half_vectors(surface, view, light), surface.texture_coordinates
    largest = schlick_largest(roughness, isotropy)
    first = draw(
        "first factor: k_s T(h.t, h.b)",
        surface.mesh(coordinates, half / PERIOD),
        view,
        program(final(TEXTURE3, alpha_of(TEXTURE0))),
        (
            unit(names.tangent),
            unit(names.binormal),
            unit(NO_TEXTURE, coordinates=1),
            unit("T(h.t, h.b)", REPEATED, 1),
        ),
        depth_test=FIRST_PASS,
        texture_shader=(TEXTURE_STAGE, TEXTURE_STAGE, *dot_product_stages(0, 1)),
    )
    fresnel = fresnel_factor(half, toward_eye, reflectance)
    # S(h.v) comes first: the product times four may be more than one, where a register ends.
    product_of_three = program(
        product(TEXTURE2, PRIMARY, to=SPARE0),
        scaled(4, product(SPARE0, TEXTURE3, to=SPARE0)),
        final(SPARE0),
    )
    second = draw(
        "specular pass: times S(h.v) G(n.l) G(n.v) / (4 pi (n.v))",
        surface.mesh(
            coordinates,
            toward_light,
            toward_eye,
            surface.positions,
            colors=np.clip(np.multiply.outer(fresnel, np.array(checked_rgb(specular))), 0.0, 1.0),
        ),
        view,
        product_of_three,
        (
            unit(names.fine, FINE),
            unit(NO_TEXTURE, coordinates=1),
            unit("G G / (n.v)", EDGE, 2),
            screen_unit(view, 3),
        ),
        blending=ADD,
        texture_shader=(TEXTURE_STAGE, *dot_product_stages(0, 0, mapping=HEMISPHERE), TEXTURE_STAGE),
    )
    table = centered_table(schlick_t(roughness, isotropy), TEXELS, PERIOD, profile)
    return (
        TexImage(label="load T(h.t, h.b) = Z(h.n) A(w)", texture="T(h.t, h.b)", image=table),
        load_function("G(n.l) G(n.v) / (n.v)", "G G / (n.v)", schlick_o(roughness, largest), profile),
        view.panel.clear((0.0, 0.0, 0.0)),
        first,
        copy_screen(view),
        *_diffuse(surface, names, view, light, profile, **shown),
        second,
    )


def lafortune_passes(surface, names, view, light, profile, *, exponent, specular=(1.0, 1.0, 1.0), **shown):
    """One lobe of Lafortune's model, k_s ((D.(l * v) + O.(l x v))+)^N (n.l)+, in one specular pass.

    ``exponent``: N of the whole surface. The others are those of ``phong_passes``; l.v may change.
    """
    vectors = lobe_vectors(light_vectors(surface, light), view_vectors(surface, view))
    table = centered_table(lafortune_f(exponent), TEXELS, PERIOD, profile)
    return (
        TexImage(label="load ((a + b)+)^N", texture="(a + b)^N", image=table),
        *_diffuse(surface, names, view, light, profile, **shown),
        draw(
            "specular pass: k_s ((D.(l * v) + O.(l x v))+)^N, times (n.l)+",
            surface.mesh(surface.texture_coordinates, *(v / PERIOD for v in vectors)),
            view,
            program(final(TEXTURE3, product(CONSTANT0, alpha_of(TEXTURE0))), constant0=specular),
            (
                unit(names.diagonal),
                unit(names.rest),
                unit(NO_TEXTURE, coordinates=1),
                unit("(a + b)^N", REPEATED, 2),
            ),
            blending=ADD_GATED,
            texture_shader=(TEXTURE_STAGE, TEXTURE_STAGE, *dot_product_stages(0, 1)),
        ),
    )
