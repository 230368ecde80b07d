"""H26 to H28: a mirror weighted by Fresnel's factor, alone, with diffuse light, and as a coat over it.

    H26  F(n.v) L_m
    H27  F(n.v) L_m + L_d
    H28  F(n.v) L_m + (1 - F(n.v)) L_d

    1. a table of 256 alphas F(n.v), n.v computed at the vertices, into destination alpha; colours masked
    2. the mirror, times destination alpha (DST_ALPHA, ZERO); alpha masked
    3. the layer below: added (H27), or times one minus destination alpha (H28); alpha masked

With two units, 1 and 2 are one draw. The table's texel is F in all four components; the second unit
multiplies it by the environment map, and its alpha remains for 3.

Source: Heidrich 2001, section 1.5; pass sequence A-H26/H27/H28 of the catalogue.
"""

from dataclasses import replace

from fixedpipe.effects.environment_maps.mirror_passes import FRONT
from fixedpipe.effects.environment_maps.reflections import generated, world_from_eye
from fixedpipe.effects.geometry.vertex_vectors import dot_products
from fixedpipe.effects.passes.draws import (
    ADD,
    EDGE,
    FIRST_PASS,
    MODULATE,
    REPLACE,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.reflectance.fresnel import fresnel
from fixedpipe.effects.reflectance.sampled_functions import positions
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import BlendFactor, InternalFormat, TexGenMode
from fixedpipe.pipeline.state import Blending, ColorMask
from fixedpipe.pipeline.textures.images import texture_1d

TECHNIQUES = (
    Technique("H26", "a mirror times Fresnel's factor, by way of destination alpha", "1.5"),
    Technique("H27", "a mirror times Fresnel's factor, added to diffuse light", "1.5"),
    Technique("H28", "a mirror times Fresnel's factor as a transparent coat over diffuse light", "1.5"),
)

# Source: pass sequence A-H26.
TEXELS = 256
ONLY_ALPHA, ONLY_RGB = ColorMask(False, False, False, True), ColorMask(True, True, True, False)
TIMES_ALPHA = Blending(BlendFactor.DST_ALPHA, BlendFactor.ZERO)
# What lies under a coat: source * (1 - F) + destination.
UNDER_COAT = Blending(BlendFactor.ONE_MINUS_DST_ALPHA, BlendFactor.ONE)


def load_table(name, index, profile, texels=TEXELS):
    """The command that loads F(n.v) over n.v in [0, 1] as a texture ``name`` of one row.

    ``index``: the index of refraction, above 0. Raises ValueError for others.
    """
    values = fresnel(positions(texels), index)
    image = texture_1d(factor_texels(values, profile)[..., None], InternalFormat.INTENSITY8)
    return TexImage(label=f"load {name}", texture=name, image=image)


def cube_unit(texture, view):
    """A texture unit that reads a cube map by REFLECTION_MAP's vectors, in the world's axes."""
    gen = generated(TexGenMode.REFLECTION_MAP)
    return unit(texture, EDGE, environment=REPLACE, gen=gen, matrix=world_from_eye(view))


def sphere_unit(texture):
    """A texture unit that reads a sphere map by SPHERE_MAP's coordinates."""
    return unit(texture, EDGE, environment=REPLACE, gen=generated(TexGenMode.SPHERE_MAP, 2))


def _facing(surface, view):
    """The surface with n.v at its vertices as texture coordinates [n, 1]."""
    return surface.mesh(dot_products((surface.normals, view.view_vectors(surface.positions))))


def mirror_passes(surface, view, table, mirror):
    """H26 in two draws on one unit.

    table   the name of what ``load_table`` loads
    mirror  the texture unit that reads the environment map: ``cube_unit``'s or ``sphere_unit``'s
    """
    factor = unit(table, EDGE, environment=REPLACE)
    return (
        draw(
            f"{table} into destination alpha",
            _facing(surface, view),
            view,
            None,
            (factor,),
            depth_test=FIRST_PASS,
            color_mask=ONLY_ALPHA,
            polygon=FRONT,
        ),
        draw(
            f"{mirror.texture}, times destination alpha",
            surface.mesh(),
            view,
            None,
            (mirror,),
            blending=TIMES_ALPHA,
            color_mask=ONLY_RGB,
            polygon=FRONT,
        ),
    )


def folded_mirror_pass(surface, view, table, mirror):
    """H26 in one draw on two units, F in destination alpha; arguments as for ``mirror_passes``."""
    units = unit(table, EDGE, environment=REPLACE), replace(mirror, environment=MODULATE)
    label = f"{table}, times {mirror.texture}"
    return (draw(label, _facing(surface, view), view, None, units, depth_test=FIRST_PASS, polygon=FRONT),)


def diffuse_pass(surface, view, colors, *, coat):
    """H27's and H28's third pass: diffuse light, the vertices' colours [n, 3], added.

    ``coat``: times one minus F; else whole.
    """
    return draw(
        "diffuse light, times one minus destination alpha" if coat else "diffuse light, added",
        surface.mesh(colors=colors),
        view,
        None,
        blending=UNDER_COAT if coat else ADD,
        color_mask=ONLY_RGB,
        polygon=FRONT,
    )


def under_coat_pass(mesh, view, read):
    """The texels of a texture unit, seen through the coat: times one minus destination alpha, added.

    ``mesh``: with the unit's texture coordinates, of the positions that the mirror's passes drew.
    """
    label = f"{read.texture}, times one minus destination alpha"
    return draw(label, mesh, view, None, (read,), blending=UNDER_COAT, color_mask=ONLY_RGB, polygon=FRONT)
