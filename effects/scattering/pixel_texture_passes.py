"""G08 and G32 on the Octane: bump mapping by the color matrix, lookups by pixel textures.

1. The normals' image is drawn through a color matrix with l, which also undoes 2x - 1; the maximum with black
   is (n.l)+. The albedo's image multiplies it. A highlight is the same image drawn through a color matrix
   with h and a table that raises to Phong's power. It is added where the matrix's fourth row, n.l, is
   positive.
2. S_i is drawn with a pixel texture, and multiplies the framebuffer by L_d[S_i[p]].
3. The product goes into the accumulation buffer with the weight. Or CopyPixels adds it to a sum on the
   screen; its pixel transfer has the weight in full precision, so no byte rounds it.

S_i's coordinates have 8 bits, or the 12 of the Octane's pixel groups; in the latter case textures also have
12.

Source: Heidrich, Daubert, Kautz, Seidel 2000, sections 3.3 and 6; pass sequence A-G08; Heidrich, Seidel 1999
(Phong by normal maps); SGIX_pixel_texture. Assumed: the maximum and the alpha test; the paper does not say
how it removes negative products.
"""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.passes.draws import (
    ADD,
    AT_LEAST_ZERO,
    MULTIPLY_DESTINATION,
    NEAREST,
    REPLACE,
    at_pixel,
    unit,
)
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.passes.host_images import HostImage, dot_product_transfer
from fixedpipe.effects.passes.pixel_texture_copies import tabulated, unchanged
from fixedpipe.effects.scattering import dependent_tests
from fixedpipe.effects.scattering.combiner_bumps import named
from fixedpipe.effects.scattering.dependent_tests import Into, PathPasses
from fixedpipe.effects.scattering.visibility_textures import coordinates
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Clear, CopyPixels, DrawPixels, TexImage
from fixedpipe.pipeline.enums import ComparisonFunction
from fixedpipe.pipeline.pixel_transfer import PixelImage, PixelTransfer
from fixedpipe.pipeline.state import AlphaTest, PassState, PixelTexture
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (
    Technique("G08", "dependent tests on an Octane: color matrix and pixel textures", "3.3, 6"),
    Technique("G32", "Phong shading of bumps by an image of normals, color matrix and table", "6"),
    Technique("H51", "light scattered once by pixel textures", "3.2"),
)

_POSITIVE = AlphaTest(ComparisonFunction.GREATER, 0.0)


def load(setup, lit, numbers):
    """The command that loads the light's shadow as a texture; the commands that draw other images carry
    them.
    """
    shadow = factor_texels(np.asarray(lit, np.float64)[..., None].repeat(3, axis=-1), setup.profile)
    return (TexImage(label="load the light's shadow", texture="shadow", image=texture_2d(shadow)),)


def _drawn(setup, label, image, *, blending=None, transfer=None, **settings):
    work, more = setup.work, {} if transfer is None else {"transfer": transfer}
    lookup = {k: settings.pop(k) for k in ("pixel_texture",) if k in settings}
    return DrawPixels(
        label=label,
        image=image,
        state=PassState(scissor=work.scissor, blending=blending, **settings),
        position=at_pixel(work.x, work.y),
        **more,
        **lookup,
    )


def bumps(setup, light, view, lit):
    """The work panel becomes bump mapping: three commands, a fourth for highlights, one for the shadow."""
    field, work = setup.field, setup.work
    normals = HostImage.of(field.normals, setup.profile)
    image = PixelImage(normals.values, "RGB")
    light = np.asarray(light, np.float64)
    out = [
        Clear(label="black", color=(0.0,) * 4, scissor=work.scissor),
        _drawn(
            setup,
            f"n through the color matrix with l = {named(light)}: (n.l)+",
            image,
            transfer=dot_product_transfer(light, normals.scale, None, biased=False),
            blending=AT_LEAST_ZERO,
        ),
        _drawn(
            setup,
            "times the albedo",
            PixelImage(field.albedo, "RGB"),
            blending=MULTIPLY_DESTINATION,
        ),
    ]
    if field.specular:
        half = normalize(light + np.asarray(view, np.float64))
        out.append(_highlight(setup, image, normals.scale, light, half))
    if lit is not None:
        out.append(
            dependent_tests.textured(
                "times the light's shadow", work, "shadow", blending=MULTIPLY_DESTINATION
            )
        )
    return tuple(out)


@lru_cache(maxsize=8)
def _raised(specular, power):
    """A table's function: k_s x^power, by products, so that the bits are the same everywhere."""

    def function(index):
        result = np.full(index.shape, specular)
        for _ in range(power):
            result = result * index
        return result

    return function


def _highlight(setup, image, scale, light, half):
    power = round(setup.field.exponent)
    raised = _raised(setup.field.specular, power)
    (n_h,), (n_l,) = (
        dot_product_transfer(v, scale, None, biased=False).color_matrix[:1] for v in (half, light)
    )
    transfer = PixelTransfer(
        color_matrix=(n_h, n_h, n_h, n_l),
        post_color_matrix_color_table=tabulated(setup.profile, raised, raised, raised, unchanged),
    )
    return _drawn(
        setup,
        f"plus n through the color matrix with h, and a table: k_s ((n.h)+)^{power}",
        image,
        transfer=transfer,
        blending=ADD,
        alpha_test=_POSITIVE,
    )


def seen_image(setup, number):
    """S_i as the image that is drawn: s in red, t in green."""
    codes = coordinates(setup.visibility.seen[number], setup.bits)
    image = np.zeros((*codes.shape[:2], 3), np.uint8 if setup.bits == 8 else np.float64)
    image[..., :2] = codes if setup.bits == 8 else codes / float((1 << setup.bits) - 1)
    return PixelImage(image, "RGB")


def looked_up(setup, number, name, *, blending=None):
    """S_i drawn with a pixel texture: the work panel becomes, or is multiplied by, the light at S_i."""
    drawn = _drawn(
        setup,
        f"S_{number} with a pixel texture: {name}[S_{number}]",
        seen_image(setup, number),
        blending=blending,
        texture_units=(unit(name, NEAREST, environment=REPLACE),),
        pixel_texture=PixelTexture(),
    )
    return (drawn,)


def gathered(setup, number, view, name, into):
    """Bump mapping with a light along d_i, times the light at S_i by a pixel texture; a copy to another
    panel.
    """
    work = setup.work
    out = (
        *bumps(setup, setup.visibility.directions[number], view, None),
        *looked_up(setup, number, name, blending=MULTIPLY_DESTINATION),
    )
    if into == Into(work):
        return out
    copy = CopyPixels(
        label=f"the product times {into.weight:.4g}, added to the sum",
        x=work.x,
        y=work.y,
        width=work.width,
        height=work.height,
        state=PassState(scissor=into.panel.scissor, blending=into.blending),
        position=at_pixel(into.panel.x, into.panel.y),
        transfer=PixelTransfer(scale=(into.weight,) * 3 + (1.0,)),
    )
    return (*out, copy)


def keep(setup, name):
    """The work panel's light becomes the texture that is looked up."""
    return (dependent_tests.kept(setup, name),)


WAY = PathPasses(load, bumps, keep, gathered, looked_up)
