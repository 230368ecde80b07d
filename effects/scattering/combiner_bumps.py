"""G33: bumps and Phong in one pass of register combiners: albedo (n.l)+ + k_s ((n.h)+)^8.

The primary colour holds l, the secondary h, whose length is the eighth root of k_s. The first general
combiner computes both dot products. The second multiplies the first result by the albedo and squares the
other. The final combiner squares twice more and adds. If n.l is not positive, or the texel is in shadow,
alpha is 0, and the alpha test leaves the panel's black. So there is no highlight there. Without highlights,
alpha and its test are not needed.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 6; part of pass sequence A-G09. Assumed: the exponent 8
and the alpha test; the paper prints no program.
"""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.bump_mapping.diffuse_bump import eighth_root
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.passes.combiners import (
    ONE,
    PRIMARY,
    SECONDARY,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE1,
    blue_of,
    both,
    dot,
    expand,
    final,
    product,
    program,
    square,
    stage,
)
from fixedpipe.effects.passes.draws import NEAREST, unit
from fixedpipe.effects.passes.encoding import factor_texels, vector_colors, vector_texels
from fixedpipe.effects.scattering.dependent_tests import rectangle
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Clear, Draw, TexImage
from fixedpipe.pipeline.enums import ComparisonFunction
from fixedpipe.pipeline.state import AlphaTest, PassState
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (Technique("G33", "bumps and Phong in one pass of a GeForce", "6"),)

NORMALS, ALBEDO, LIT_ALBEDO = "normal map", "albedo", "albedo where the light is not shadowed"
# Where alpha, (n.l)+, is 0 nothing is drawn.
LIT_SIDE = AlphaTest(ComparisonFunction.GREATER, 0.0)


def check_exponent(field):
    """Refuse a height field's highlights of another exponent than the combiners'."""
    if field.specular and field.exponent != 8.0:
        raise ValueError(
            f"The highlight's exponent is {field.exponent:g}, and squaring three times makes 8; give 8, or "
            "k_s = 0."
        )


def load(setup, lit):
    """Commands that load the normal map and two textures of the albedo, one with the light's shadow."""
    field, profile = setup.field, setup.profile
    shadow = np.asarray(lit, np.float64)[..., None]
    shadowed = np.concatenate([field.albedo * shadow, shadow], axis=-1)
    images = (
        (NORMALS, vector_texels(field.normals, profile)),
        (ALBEDO, factor_texels(field.albedo, profile)),
        (LIT_ALBEDO, factor_texels(shadowed, profile)),
    )
    return tuple(TexImage(label=f"load the {name}", texture=name, image=texture_2d(i)) for name, i in images)


def vector_arrays(setup, light, view):
    """Vertex colours of a rectangle: l, and h as long as the eighth root of k_s."""
    light = np.asarray(light, np.float64)
    arrays = {"colors": vector_colors(np.tile(light, (4, 1)), setup.profile)}
    if setup.field.specular:
        half = normalize(light + np.asarray(view, np.float64)) * eighth_root(setup.field.specular)
        arrays["secondary_colors"] = vector_colors(np.tile(half, (4, 1)), setup.profile)
    return arrays


def program_of(shines):
    """The combiners: albedo (n.l)+, with a highlight where the field ``shines``."""
    diffuse = product(SPARE0, TEXTURE1, to=SPARE0)
    lit = product(blue_of(SPARE0), TEXTURE1, to=SPARE0)
    n_l = dot(expand(TEXTURE0), expand(PRIMARY), to=SPARE0)
    if not shines:
        return program(n_l, stage(diffuse, alpha=lit), final(SPARE0, ONE, alpha=SPARE0))
    fourth = square(SPARE1)
    return program(
        both(n_l, dot(expand(TEXTURE0), expand(SECONDARY), to=SPARE1)),
        stage(both(diffuse, square(SPARE1, to=SPARE1)), alpha=lit),
        final(fourth, fourth, plus=SPARE0, alpha=SPARE0),
    )


def bumps(setup, light, view, lit):
    """The work panel becomes bump mapping: one command, and a Clear before it where there are highlights."""
    check_exponent(setup.field)
    mesh, _ = rectangle(setup.work, **vector_arrays(setup, light, view))
    state = _bump_state(setup.work, ALBEDO if lit is None else LIT_ALBEDO, bool(setup.field.specular))
    return (
        *cleared(setup.field, setup.work),
        Draw(label=f"bump mapping, light from {named(light)}", mesh=mesh, state=state),
    )


# One object for the states of all paths, which differ in their vertices alone: a machine looks at it once.
@lru_cache(maxsize=64)
def _bump_state(panel, albedo, shines):
    return PassState(
        vertex=rectangle(panel)[1],
        texture_units=(unit(NORMALS, NEAREST), unit(albedo, NEAREST)),
        register_combiners=program_of(shines),
        alpha_test=LIT_SIDE if shines else None,
    )


def cleared(field, panel):
    """The Clear that a pass with an alpha test needs before it."""
    if not field.specular:
        return ()
    return (Clear(label="black where no light falls", color=(0.0,) * 4, scissor=panel.scissor),)


def named(vector):
    """A direction in a label."""
    return "(" + ", ".join(f"{c:.2f}" for c in vector) + ")"
