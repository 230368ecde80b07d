"""G09 on a GeForce 256: bumps and Phong in one pass of combiners, lookups by the host.

1. L_d by ``combiner_bumps`` (G33), read back by ReadPixels.
2. The host replaces each texel p by L_d[S_i[p]], as a pixel texture would, and loads the result.
3. The second reflection by the same combiners with a light along d_i, times that texture by blending.
4. The result goes into the accumulation buffer, or to the host as a term of a sum of floats. Or a texture
   adds it on the screen, with the quad's colour as its weight.

Source: Heidrich, Daubert, Kautz, Seidel 2000, sections 3.3 and 6; pass sequence A-G09.
"""

import numpy as np

from fixedpipe.effects.passes.draws import MULTIPLY_DESTINATION
from fixedpipe.effects.passes.software_pixel_texture import look_up
from fixedpipe.effects.scattering import combiner_bumps, dependent_tests
from fixedpipe.effects.scattering.dependent_tests import PathPasses, added_as_texture, textured
from fixedpipe.effects.scattering.visibility_textures import coordinates, padded
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import HostStep, ReadPixels, TexImage
from fixedpipe.pipeline.enums import TextureFilter
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (
    Technique("G09", "dependent tests on a GeForce 256: the host does the lookups", "3.3, 6"),
    Technique("H53", "light scattered once, the lookups by the host", "3.2.1"),
)

LOOKED_UP = "L_d at S_i"


def load(setup, lit, numbers):
    """Commands that load the field's textures; S_i stays with the host. Raises ValueError for coordinates of
    other than eight bits.
    """
    if setup.bits != 8:
        raise ValueError(f"S_i has coordinates of {setup.bits} bits; the host's pixels are bytes: give 8.")
    return combiner_bumps.load(setup, lit)


def keep(setup, name):
    """The work panel's light goes to the host under this name. Direct light is stored as a texture, which is
    added later. It also goes to the host for lookups, because without highlights it is the same in all
    directions.
    """
    work = setup.work
    read = ReadPixels(
        label=f"{name} to the host", name=name, x=work.x, y=work.y, width=work.width, height=work.height
    )
    if name != dependent_tests.DIRECT:
        return (read,)
    texture = dependent_tests.kept(setup, name)
    return (texture,) if setup.field.specular else (texture, read)


def found(setup, number, light):
    """L_d[S_i]: the light that the host looks up for every texel, from the pixels of ReadPixels, [rows,
    columns, 4].
    """
    codes = coordinates(setup.visibility.seen[number], setup.bits)
    pixels = np.full((*codes.shape[:2], 4), 255, np.uint8)
    pixels[..., :2] = codes
    if light.dtype == np.float64:
        pixels = pixels / 255.0
    return look_up(pixels, texture_2d(padded(light, bits=setup.bits)), TextureFilter.NEAREST)


def looked_up(setup, number, name, *, blending=None):
    """The work panel becomes, or is multiplied by, the light that the host finds at S_i."""

    def drawn(pixels):
        texels = found(setup, number, pixels[name])
        return (
            TexImage(label=f"load {name}[S_{number}]", texture=LOOKED_UP, image=texture_2d(texels)),
            textured(f"{name}[S_{number}]", setup.work, LOOKED_UP, blending=blending),
        )

    return (HostStep(label=f"the host looks up {name} at S_{number}", reads=(name,), commands=drawn),)


def gathered(setup, number, view, name, into):
    """Bump mapping with a light along d_i, times the light that the host finds at S_i."""
    return (
        *combiner_bumps.bumps(setup, setup.visibility.directions[number], view, None),
        *looked_up(setup, number, name, blending=MULTIPLY_DESTINATION),
        *added_as_texture(setup, into),
    )


WAY = PathPasses(load, combiner_bumps.bumps, keep, gathered, looked_up, by_host=True)
