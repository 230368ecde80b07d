"""K24 by pixel textures, on the Octane: Phong with N per pixel, Schlick and one lobe of Lafortune.

Each is a few copies of the panel. ``phong_schlick_lafortune`` has the functions, and the same by texture
shaders.

Source: Kautz, Seidel 2000, section 3.4; SGIX_pixel_texture.
"""

import numpy as np

from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors, view_vectors
from fixedpipe.effects.passes.arguments import checked_rgb
from fixedpipe.effects.passes.draws import ADD, MULTIPLY_DESTINATION
from fixedpipe.effects.passes.pixel_texture_copies import (
    ALPHA,
    BLUE,
    FROM_ALPHA,
    FROM_BLUE,
    FROM_GREEN,
    FROM_RED,
    GREEN,
    RGB,
    begin,
    copied,
    dot_with,
    flat_vector,
    load_products,
    looked_up,
    polygon,
)
from fixedpipe.effects.reflectance.phong_schlick_lafortune import (
    GAIN,
    fresnel_factor,
    lafortune_f,
    load_function,
    lobe_matrix,
    lobe_vectors,
    of_biased,
    phong_c,
    phong_f,
    schlick_largest,
    schlick_o,
    schlick_t,
)
from fixedpipe.effects.reflectance.sampled_functions import stored_exponent
from fixedpipe.effects.technique import Variant
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.pixel_transfer import PixelImage, PixelTransfer
from fixedpipe.pipeline.state import ColorMask

TECHNIQUES = (Variant(("K24",), "on the Octane, by pixel textures"),)

RED_GREEN = ColorMask(blue=False, alpha=False)


def _load_signed(label, name, vectors, vector, profile):
    """The command that loads float vectors [h, w, 3] through a color matrix: (product + 1) / 2."""
    alpha = np.ones((*vectors.shape[:2], 1))
    return TexImage(
        label=label,
        texture=name,
        pixels=PixelImage(np.concatenate([vectors, alpha], axis=-1)),
        transfer=PixelTransfer(
            color_matrix=(dot_with(vector),) * 4,
            post_color_matrix_scale=(0.5,) * 4,
            post_color_matrix_bias=(0.5,) * 4,
        ),
    )


def _load_cosines(material, toward_light, toward_eye, profile):
    """The command that loads (n.l)+ into red and (n.v)+ into green."""
    rows = [dot_with(toward_light), dot_with(toward_eye)] * 2
    return load_products("load n through l and v", "n.l, n.v", material.normals, rows, profile)


def _after_copies(material, view, profile, surface, toward_light, *, specular, color, ambient, lit=False):
    """What follows a model's value: times (n.l)+ if ``lit``, times k_s, plus the diffuse reflection."""
    everywhere, drawn = np.ones((1, 1)), {"surface": surface, "view": view}
    cosine = ()
    if lit:
        rows = [dot_with(toward_light)] * 4
        cosine = (
            load_products("load n through l: (n.l)+", "n.l", material.normals, rows, profile),
            polygon("times (n.l)+", texture="n.l", mask=RGB, blending=MULTIPLY_DESTINATION, **drawn),
        )
    gloss = [(c, 0.0, 0.0, 0.0) for c in (*checked_rgb(specular), 1.0)]
    diffuse = [dot_with(toward_light, c) for c in (*checked_rgb(color), 1.0)]
    added = [(c, 0.0, 0.0, 0.0) for c in (*checked_rgb(ambient, "The ambient light's colour"), 1.0)]
    return (
        *cosine,
        load_products("load k_s", "k_s", material.k_s, gloss, profile),
        polygon("times k_s", texture="k_s", mask=RGB, blending=MULTIPLY_DESTINATION, **drawn),
        load_products("load n through l: diffuse reflection", "diffuse", material.normals, diffuse, profile),
        polygon("plus the diffuse reflection", texture="diffuse", mask=RGB, blending=ADD, **drawn),
        load_products("load the ambient", "ambient", everywhere, added, profile),
        polygon("plus the ambient", texture="ambient", mask=RGB, blending=ADD, **drawn),
    )


def _flat_vectors(surface, view, light):
    return (
        flat_vector(light_vectors(surface, light), "light vector"),
        flat_vector(view_vectors(surface, view), "viewing vector"),
    )


def phong_copies(
    surface, material, view, light, profile, *, specular=(1.0, 1.0, 1.0), background, color, ambient
):
    """``phong_passes`` by pixel textures: two lookups, each a copy of the panel.

    ``surface``: flat. ``material``: a ``material_textures.Material``. The others are those of
    ``phong_passes``. Raises ValueError where vectors change over the surface.
    """
    toward_light, toward_eye = _flat_vectors(surface, view, light)
    light_view = float(dot(toward_light, toward_eye))
    exponent = stored_exponent(material.exponent)
    return (
        load_function("C(n.l, n.v) = 2 (n.l)(n.v) - l.v", "C(n.l, n.v)", phong_c(light_view), profile),
        load_function("F(N, c) = c^N", "F(N, c)", phong_f, profile),
        view.panel.clear(background),
        begin(view),
        _load_cosines(material, toward_light, toward_eye, profile),
        polygon("(n.l)+ to red, (n.v)+ to green", surface, view, "n.l, n.v", first=True),
        looked_up(
            "look up c = 2 (n.l)(n.v) - l.v, to blue", view, "C(n.l, n.v)", FROM_RED, FROM_GREEN, mask=BLUE
        ),
        load_products("load log2(N) / 7", "N", exponent, [FROM_RED] * 4, profile),
        polygon("N to alpha", surface, view, "N", mask=ALPHA),
        looked_up("look up F(N, c)", view, "F(N, c)", FROM_ALPHA, FROM_BLUE),
        *_after_copies(
            material, view, profile, surface, toward_light, specular=specular, color=color, ambient=ambient
        ),
    )


def schlick_copies(
    surface,
    material,
    view,
    light,
    profile,
    *,
    roughness,
    isotropy,
    reflectance,
    specular=(1.0, 1.0, 1.0),
    background,
    color,
    ambient,
):
    """``schlick_passes`` by pixel textures: both factors meet in blue, and a last copy multiplies them by
    four and by S(h.v).
    """
    toward_light, toward_eye = _flat_vectors(surface, view, light)
    half = flat_vector(half_vectors(surface, view, light), "halfway vector")
    fresnel = float(fresnel_factor(half, toward_eye, reflectance))
    largest = schlick_largest(roughness, isotropy)
    return (
        load_function(
            "T(h.t, h.b) = Z(h.n) A(w)", "T(h.t, h.b)", of_biased(schlick_t(roughness, isotropy)), profile
        ),
        load_function("G(n.l) G(n.v) / (n.v)", "G G / (n.v)", schlick_o(roughness, largest), profile),
        view.panel.clear(background),
        begin(view),
        _load_signed("load t through h", "h.t", material.tangents, half, profile),
        polygon("h.t, biased, to red", surface, view, "h.t", first=True),
        _load_signed("load b through h", "h.b", material.binormals, half, profile),
        polygon("h.b, biased, to green", surface, view, "h.b", mask=GREEN),
        looked_up("look up T(h.t, h.b), to blue", view, "T(h.t, h.b)", FROM_RED, FROM_GREEN, mask=BLUE),
        _load_cosines(material, toward_light, toward_eye, profile),
        polygon("(n.l)+ to red, (n.v)+ to green", surface, view, "n.l, n.v", mask=RED_GREEN),
        looked_up(
            "look up G(n.l) G(n.v) / (n.v), times blue",
            view,
            "G G / (n.v)",
            FROM_RED,
            FROM_GREEN,
            mask=BLUE,
            blending=MULTIPLY_DESTINATION,
        ),
        copied(
            "times four, times S(h.v)",
            view,
            ((0.0, 0.0, GAIN * fresnel, 0.0),) * 3,
            profile,
        ),
        *_after_copies(
            material, view, profile, surface, toward_light, specular=specular, color=color, ambient=ambient
        ),
    )


def lafortune_copies(
    surface, material, view, light, profile, *, coefficients, exponent,
    specular=(1.0, 1.0, 1.0), background, color, ambient,
):  # fmt: skip
    """``lafortune_passes`` by pixel textures: D and O through the color matrix, one lookup."""
    toward_light, toward_eye = _flat_vectors(surface, view, light)
    both = lobe_vectors(toward_light[None], toward_eye[None])
    diagonal, rest = lobe_matrix(material, coefficients)
    return (
        load_function("(a + b)^N", "(a + b)^N", of_biased(lafortune_f(exponent)), profile),
        view.panel.clear(background),
        begin(view),
        _load_signed("load D through l * v", "D", diagonal, both[0][0], profile),
        polygon("a = D.(l * v), biased, to red", surface, view, "D", first=True),
        _load_signed("load O through l x v", "O", rest, both[1][0], profile),
        polygon("b = O.(l x v), biased, to green", surface, view, "O", mask=GREEN),
        looked_up("look up (a + b)^N", view, "(a + b)^N", FROM_RED, FROM_GREEN),
        *_after_copies(
            material,
            view,
            profile,
            surface,
            toward_light,
            specular=specular,
            color=color,
            ambient=ambient,
            lit=True,
        ),
    )
