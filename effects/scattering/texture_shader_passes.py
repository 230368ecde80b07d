"""G10 by texture shaders: one pass gathers the light of a direction.

    unit 0  S_i, NEAREST: alpha and red are the coordinates of the visible texel
    unit 1  DEPENDENT_AR_TEXTURE_2D: L_d there, NEAREST
    unit 2  the normal map
    unit 3  the albedo

The combiners compute (n.d_i)+, times the albedo, plus a highlight, times unit 1, times the weight. Blending
adds the pass to the sum. S_i is luminance and alpha, two bytes a texel, as the paper counts them.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 3.3 and figure 5; pass sequence A-G10;
NV_texture_shader, section 3.8.13.1.16.
"""

import numpy as np

from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    ONE,
    PRIMARY,
    SECONDARY,
    SPARE0,
    SPARE1,
    TEXTURE1,
    TEXTURE2,
    TEXTURE3,
    blue_of,
    both,
    dot,
    expand,
    final,
    product,
    program,
    shown,
    square,
    stage,
    total,
)
from fixedpipe.effects.passes.draws import NEAREST, unit
from fixedpipe.effects.passes.texture_shaders import ALPHA_RED_STAGE, TEXTURE_STAGE
from fixedpipe.effects.scattering import combiner_bumps, dependent_tests
from fixedpipe.effects.scattering.combiner_bumps import ALBEDO, NORMALS
from fixedpipe.effects.scattering.dependent_tests import PathPasses, rectangle
from fixedpipe.effects.scattering.visibility_textures import coordinates
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.state import PassState
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (
    Technique("G10", "dependent lookups by texture shaders, a pass for each direction", "3.3"),
    Technique("H52", "light scattered once by dependent lookups of texture shaders", "3.2"),
)

_STAGES = (TEXTURE_STAGE, ALPHA_RED_STAGE, TEXTURE_STAGE, TEXTURE_STAGE)


def seen_texture(number):
    """The name of S_i's texture."""
    return f"S_{number}"


def load_seen(setup, number):
    """The command that loads S_i: t in luminance, s in alpha."""
    codes = coordinates(setup.visibility.seen[number], setup.bits)
    image = texture_2d(codes[..., ::-1].astype(np.uint8), InternalFormat.LUMINANCE8_ALPHA8)
    return TexImage(label=f"load S_{number}", texture=seen_texture(number), image=image)


def load(setup, lit, numbers):
    """Commands that load the field's textures and S_i of ``numbers``. Raises ValueError for coordinates of
    other than eight bits.
    """
    if setup.bits != 8:
        raise ValueError(f"S_i has coordinates of {setup.bits} bits; a texture shader reads bytes: give 8.")
    return (*combiner_bumps.load(setup, lit), *(load_seen(setup, i) for i in numbers))


def program_of(field, weight):
    """The combiners: (albedo (n.d)+ + highlight) times unit 1 times the weight."""
    n_d = dot(expand(TEXTURE2), expand(PRIMARY), to=SPARE0)
    diffuse = product(SPARE0, TEXTURE3, to=SPARE0)
    facing = product(blue_of(SPARE0), ONE, to=SPARE0)
    if field.specular:
        general = (
            both(n_d, dot(expand(TEXTURE2), expand(SECONDARY), to=SPARE1)),
            stage(both(diffuse, square(SPARE1, to=SPARE1)), alpha=facing),
            square(SPARE1, to=SPARE1),
            square(SPARE1, to=SPARE1),
            total(SPARE0, SPARE1, to=SPARE0),
        )
    else:
        general = (n_d, stage(diffuse, alpha=facing))
    last = final(product(SPARE0, TEXTURE1), CONSTANT0, alpha=SPARE0)
    return program(*general, last, constant0=(weight,) * 3)


def gathered(setup, number, view, name, into):
    """Bump mapping with a light along d_i, times the light at S_i: one draw, and a Clear if it does not
    add.
    """
    combiner_bumps.check_exponent(setup.field)
    direction = setup.visibility.directions[number]
    mesh, vertex = rectangle(into.panel, **combiner_bumps.vector_arrays(setup, direction, view))
    state = PassState(
        vertex=vertex,
        texture_units=tuple(unit(t, NEAREST) for t in (seen_texture(number), name, NORMALS, ALBEDO)),
        texture_shader=_STAGES,
        register_combiners=program_of(setup.field, into.weight),
        alpha_test=combiner_bumps.LIT_SIDE if setup.field.specular else None,
        blending=into.blending,
    )
    label = f"bump mapping, light from d_{number}, times {name}[S_{number}]"
    drawn = Draw(label=label, mesh=mesh, state=state)
    return (drawn,) if into.add else (*combiner_bumps.cleared(setup.field, into.panel), drawn)


def looked_up(setup, number, name):
    """The work panel becomes the light at S_i: units 0 and 1 alone."""
    mesh, vertex = rectangle(setup.work)
    state = PassState(
        vertex=vertex,
        texture_units=(unit(seen_texture(number), NEAREST), unit(name, NEAREST)),
        texture_shader=_STAGES[:2],
        register_combiners=program(shown(TEXTURE1)),
    )
    return (Draw(label=f"{name}[S_{number}]", mesh=mesh, state=state),)


def keep(setup, name):
    """The work panel's light becomes the texture that is looked up."""
    return (dependent_tests.kept(setup, name),)


WAY = PathPasses(load, combiner_bumps.bumps, keep, gathered, looked_up)
