"""H43: Kilgard's bump mapping whole: two lighting passes, a normaliser, a highlight by successive squaring.

The host (``vertex_vectors``) or a vertex program (H44) takes l and h to tangent space at the vertices, and
they are interpolated. As vertex colours they lose length between the vertices. As texture coordinates of the
normalization cube map (K12), which takes the second of two units, they get it back.

1. (n.l)+ times the light's colour and min(1, 8 (l_z)+), plus ambient light; the self-shadow in alpha. 2.
Times the surface's colours, if it has some; only colours are written. 3. k_s (n.h)^E, added by destination
alpha. Neither light reaches places that the surface itself hides.

A general combiner squares, and the final one squares twice more: E = 2, 4 or 8 with two general combiners, 16
with three. No multiplication is left for k_s, so h has the length k_s^(1/E): the cube map of h holds such
vectors.

Source: Kilgard 2000, section 4; Heidrich 2001, section 3; pass sequence A-H43. Assumed: the highlight's
self-shadow by blending.
"""

import math

from fixedpipe.effects.bump_mapping import normalization_cube_map
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    CONSTANT1,
    ONE,
    PRIMARY,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE1,
    alpha_of,
    blue_of,
    dot,
    expand,
    final,
    one_minus,
    product,
    program,
    scaled,
    square,
    stage,
    total,
)
from fixedpipe.effects.passes.draws import (
    ADD_GATED,
    EDGE,
    FIRST_PASS,
    MULTIPLY_DESTINATION,
    REPEATED,
    REPLACE,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import vector_colors
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.state import ColorMask

TECHNIQUES = (
    Technique("H43", "Kilgard's bump mapping: two passes, a normaliser, a highlight by squaring", "3"),
)

# The cube map of h, whose vectors are as long as a root of k_s.
HALF_NAME = "normalization cube map of h"
EXPONENTS = (2, 4, 8, 16)
_COLORS_ALONE = ColorMask(True, True, True, False)


def _checked(exponent):
    if exponent not in EXPONENTS:
        raise ValueError(
            f"The highlight's exponent is {exponent!r}; squaring makes "
            f"{', '.join(map(str, EXPONENTS[:-1]))} and {EXPONENTS[-1]}."
        )
    return exponent


def root(strength, exponent):
    """The length of h whose power is ``strength``, in [0, 1]: roots alone, which IEEE 754 fixes."""
    if not 0.0 <= strength <= 1.0:
        raise ValueError(f"The highlight's strength is {strength!r}; give a number from 0 to 1.")
    for _ in range(_checked(exponent).bit_length() - 1):
        strength = math.sqrt(strength)
    return strength


def load_normalizers(size, profile, specular, exponent):
    """The commands that load the cube maps of l and of h, ``size`` texels along an edge."""
    return (
        normalization_cube_map.load(size, profile),
        normalization_cube_map.load(size, profile, HALF_NAME, root(specular, exponent)),
    )


def diffuse_combiners(light_register, color, ambient):
    """(n.l)+ min(1, 8 (l_z)+) ``color`` + ``ambient``, and the self-shadow in alpha; two general combiners.

    ``light_register``: the register that has l.
    """
    upward = blue_of(expand(light_register))
    # 1 - (1 - 8 l_z)+ is min(1, 8 l_z) where registers have no upper end, too.
    shadow = one_minus(SPARE0)
    return program(
        stage(
            dot(expand(TEXTURE0), expand(light_register), to=SPARE0),
            alpha=scaled(4, total(product(upward, ONE), product(upward, ONE), to=SPARE0)),
        ),
        stage(product(SPARE0, CONSTANT0, to=SPARE1), alpha=product(shadow, ONE, to=SPARE0)),
        final(alpha_of(shadow), SPARE1, plus=CONSTANT1, alpha=shadow),
        constant0=color,
        constant1=ambient,
    )


def specular_combiners(half_register, exponent):
    """(n.h)^``exponent`` with h at the register's length.

    It takes one general combiner for the product, and one for each square that the final combiner does not
    make.
    """
    squarings = _checked(exponent).bit_length() - 3
    product_of_both = dot(expand(TEXTURE0), expand(half_register), to=SPARE0)
    last = square(SPARE0)
    general = (product_of_both, *(square(SPARE0, to=SPARE0) for _ in range(squarings)))
    return program(*general, final(last, ONE if exponent == 2 else last))


def lighting_passes(
    surface,
    vectors,
    normal_map,
    view,
    profile,
    *,
    color,
    ambient=(0.0, 0.0, 0.0),
    color_map=None,
    specular=1.0,
    exponent=8,
    normalized=True,
    sampler=REPEATED,
):
    """The passes: two draws, three with a colour map.

    vectors         (l, h) at the vertices in their frames, float64 [n, 3] each. Vertex colours need length
                    one; cube maps take any length
    normal_map      the name of a texture with normals for EXPAND_NORMAL
    color, ambient  RGB in [0, 1]; ``specular``: k_s, in [0, 1]; ``exponent``: one of ``EXPONENTS``
    color_map       the name of a texture whose colours multiply everything except the highlight
    normalized      whether vectors come from the cube maps that ``load_normalizers`` has loaded; otherwise
                    they are vertex colours

    Raises ValueError for another exponent or strength.
    """
    to_light, half = vectors
    if normalized:
        meshes = tuple(surface.mesh(surface.texture_coordinates, v) for v in vectors)
        names, register = (normalization_cube_map.NAME, HALF_NAME), TEXTURE1
        more = tuple((unit(name, EDGE, coordinates=1),) for name in names)
        how = "from the normalization cube map"
    else:
        lengths = (to_light, root(specular, exponent) * half)
        meshes = tuple(surface.mesh(colors=vector_colors(v, profile)) for v in lengths)
        register, more, how = PRIMARY, ((), ()), "as the vertices' colours"
    bumps = unit(normal_map, sampler)
    diffuse = diffuse_combiners(register, color, ambient)
    shine = specular_combiners(register, exponent)
    out = [
        draw(f"(n.l)+, l {how}", meshes[0], view, diffuse, (bumps, *more[0]), depth_test=FIRST_PASS),
        draw(f"add (n.h)^{exponent}, h {how}", meshes[1], view, shine, (bumps, *more[1]), blending=ADD_GATED),
    ]
    if color_map is not None:
        colors = (unit(color_map, sampler, environment=REPLACE),)
        out.insert(
            1,
            draw(
                "times the surface's colours",
                surface.mesh(),
                view,
                None,
                colors,
                blending=MULTIPLY_DESTINATION,
                color_mask=_COLORS_ALONE,
            ),
        )
    return tuple(out)
