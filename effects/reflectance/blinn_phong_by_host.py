"""K05 by the host: the anisotropic Blinn-Phong model with N per texel on a board without dependent lookups.

The register combiners are the parameter stage. They write e = 1 - (h.t/ax)^2 - (h.b/ay)^2, computed as in
``anisotropic_blinn_phong``, to red, green and blue. They write N/128, from the alpha of the binormals'
texture, to alpha. The host reads them, codes N as log2(N)/7, looks up F(N, e) = (sqrt e)^N as a pixel texture
would, and draws the result. A second pass multiplies by k_s. For each polygon, one rectangle is read and one
drawn.

Unlike the color matrix, register combiners take vectors per vertex. So surfaces may be curved, and lights and
viewers near. But their vectors are bytes, and alphas are at least 1/4.

Source: Kautz, Seidel 2000, sections 3.2 and 5; pass sequence A-K05 of the catalogue (K05, K15).
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.geometry.vertex_vectors import half_vectors
from fixedpipe.effects.passes import pixel_texture_copies, software_pixel_texture
from fixedpipe.effects.passes.arguments import member_of
from fixedpipe.effects.passes.combiners import ONE, TEXTURE0, TEXTURE1, alpha_of, constant_product
from fixedpipe.effects.passes.draws import (
    FIRST_PASS,
    MARK,
    MARKED,
    MULTIPLY_DESTINATION,
    REPEATED,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import vector_colors
from fixedpipe.effects.reflectance import pixel_textures
from fixedpipe.effects.reflectance.anisotropic_blinn_phong import combiners
from fixedpipe.effects.reflectance.material_textures import LARGEST_EXPONENT
from fixedpipe.effects.reflectance.pixel_textures import UpTo
from fixedpipe.effects.reflectance.sampled_functions import stored_exponent
from fixedpipe.effects.technique import Variant
from fixedpipe.pipeline.commands import HostStep
from fixedpipe.pipeline.state import PassState

TECHNIQUES = (Variant(("K05", "K15"), "parameters by register combiners, the lookup by the host"),)


def _lobe_and_exponent():
    """Combiners: e in red, green and blue, N/128 in alpha."""
    program = combiners()
    return replace(program, final=replace(program.final, b=ONE, g=alpha_of(TEXTURE1)))


def coordinates(pixels):
    """The pixels that were read, e in red and N/128 in alpha, as a pixel texture's pixels: log2(N)/7 in red,
    e in green (and blue), alpha one.

    ``pixels``: uint8 or float64 [h, w, 4]; the same type is returned. N counts as 1 where it is less.
    """
    one = 255.0 if pixels.dtype == np.uint8 else 1.0
    exponent = np.maximum(LARGEST_EXPONENT / one * pixels[..., 3], 1.0)
    found = np.full_like(pixels, one)
    s = stored_exponent(exponent) * one
    found[..., 0] = np.floor(s + 0.5) if pixels.dtype == np.uint8 else s
    found[..., 1] = found[..., 2] = pixels[..., 0]
    return found


def blinn_phong(
    surface,
    names,
    view,
    light,
    profile,
    *,
    specular=(1.0, 1.0, 1.0),
    sampler=REPEATED,
    with_exponent=True,
    up_to=UpTo.GLOSS,
):
    """K05: k_s F(N, e), which replaces what the polygon covers; a diffuse pass is added afterwards. K06,
    where not ``with_exponent``: k_s sqrt(e).

    Parameters as for ``anisotropic_blinn_phong.specular_pass``; ``up_to``: where it ends.
    """
    member_of(UpTo, up_to, "How far it is drawn")
    panel, tables = view.panel, (pixel_textures.root_table, pixel_textures.power_table)
    table = tables[with_exponent](profile)
    name = f"e, N from ({panel.x}, {panel.y}) on"
    vectors = vector_colors(half_vectors(surface, view, light), profile)
    marked, function = PassState(stencil_test=MARKED), "F(N, e)" if with_exponent else "sqrt(e)"

    def looked_up(pixels):
        found, label = coordinates(pixels[name]), "s = log2(N)/7, t = e"
        if not with_exponent:
            found[..., 0] = pixels[name][..., 0]
            label = "s = e"
        if up_to is not UpTo.COORDINATES:
            found, label = software_pixel_texture.look_up(found, table), function
        return (software_pixel_texture.drawn(label, found, x=panel.x, y=panel.y, state=marked),)

    gloss = draw(
        "times k_s",
        surface.mesh(),
        view,
        constant_product(alpha_of(TEXTURE0), specular),
        (unit(names.tangent, sampler),),
        blending=MULTIPLY_DESTINATION,
    )
    return (
        pixel_texture_copies.begin(view),
        draw(
            "e = 1 - (h.t/ax)^2 - (h.b/ay)^2, N/128 to alpha",
            surface.mesh(colors=vectors),
            view,
            _lobe_and_exponent(),
            (unit(names.tangent, sampler), unit(names.binormal, sampler)),
            depth_test=FIRST_PASS,
            stencil_test=MARK,
        ),
        software_pixel_texture.read_back(name, x=panel.x, y=panel.y, width=panel.width, height=panel.height),
        HostStep(label=f"the host: look up {function}", reads=(name,), commands=looked_up),
        *((gloss,) if up_to is UpTo.GLOSS else ()),
    )
