"""K12, the normalization cube map: unit vectors from interpolated ones.

Interpolation shortens the vectors of vertices. A cube map that stores, for every direction, the unit vector
in that direction restores the length. It takes a texture unit, so with two units a pass of K07 has only one
material texture. The framebuffer then adds the two squares.

Source: Kautz, Seidel 2000, section 5; Kilgard 2000, section 4 (K12 of the catalogue; pass sequence A-K12);
the faces' orientation: EXT_texture_cube_map, table 3.8.
"""

from fixedpipe.effects.bump_mapping.diffuse_bump import diffuse_combiners
from fixedpipe.effects.geometry.cube_maps import directions
from fixedpipe.effects.passes.combiners import (
    ONE,
    SPARE0,
    TEXTURE0,
    TEXTURE1,
    alpha_of,
    constant_product,
    dot,
    expand,
    final,
    program,
    scaled,
    signed,
    square,
)
from fixedpipe.effects.passes.draws import (
    ADD,
    EDGE,
    FIRST_PASS,
    INVERT_DESTINATION,
    LATER_PASS,
    MULTIPLY_DESTINATION,
    draw,
    keep_positive,
    unit,
)
from fixedpipe.effects.passes.encoding import vector_texels
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.textures.images import texture_cube_map

TECHNIQUES = (Technique("K12", "a normalization cube map: interpolated vectors get their length back", "5"),)

NAME = "normalization cube map"


def load(size, profile, name=NAME, length=1.0):
    """The command that loads the cube map, ``size`` texels along an edge; its vectors are of ``length``."""
    image = texture_cube_map(vector_texels(length * directions(size), profile), InternalFormat.RGB8)
    return TexImage(label=f"load the {name}", texture=name, image=image)


def diffuse_pass(
    surface, vectors, normal_map, view, *,
    color, ambient=(0.0, 0.0, 0.0), depth_test=FIRST_PASS, blending=None,
):  # fmt: skip
    """K10 with light vectors from the cube map.

    ``vectors``: float64 [n, 3], from the vertices to the light in their local frames, of any length. Left at
    their full length they are linear over a flat polygon, and the direction is then right at every fragment.
    """
    mesh = surface.mesh(surface.texture_coordinates, vectors)
    combiners = diffuse_combiners(color, ambient, light_register=TEXTURE1)
    units = (unit(normal_map), unit(NAME, EDGE, coordinates=1))
    label = "diffuse pass: (n.l)+, l from the normalization cube map"
    return (draw(label, mesh, view, combiners, units, depth_test=depth_test, blending=blending),)


def _squared_dot_product():
    """(4 T'.h)^2 with h from the cube map."""
    return program(
        scaled(4, dot(expand(TEXTURE0), expand(TEXTURE1), to=SPARE0)),
        square(signed(SPARE0), to=SPARE0),
        final(SPARE0),
    )


def specular_passes(surface, vectors, names, view, *, specular=(1.0, 1.0, 1.0)):
    """Eq. 1 with halfway vectors from the cube map: five draws, the squares added in the framebuffer.

    ``vectors``: float64 [n, 3], halfway vectors at the vertices in their local frames, of any length.
    """
    mesh = surface.mesh(surface.texture_coordinates, vectors)
    square, cube_map = _squared_dot_product(), unit(NAME, EDGE, coordinates=1)
    white = constant_product(ONE, (1.0, 1.0, 1.0))
    k_s = constant_product(alpha_of(TEXTURE0), specular)
    tangent, binormal = unit(names.tangent), unit(names.binormal)
    return (
        draw("(h.t/ax)^2", mesh, view, square, (tangent, cube_map), depth_test=FIRST_PASS),
        draw("add (h.b/ay)^2", mesh, view, square, (binormal, cube_map), blending=ADD),
        draw("subtract from one", mesh, view, white, blending=INVERT_DESTINATION),
        keep_positive(mesh, view),
        draw("multiply by k_s", mesh, view, k_s, (tangent,), blending=MULTIPLY_DESTINATION),
    )


def commands(
    surface, to_light, halfway, names, view, *, color, specular=(1.0, 1.0, 1.0), ambient=(0.0, 0.0, 0.0)
):
    """The five specular passes, then the diffuse pass added: both with vectors from the cube map."""
    diffuse = diffuse_pass(
        surface,
        to_light,
        names.normal,
        view,
        color=color,
        ambient=ambient,
        depth_test=LATER_PASS,
        blending=ADD,
    )
    return (*specular_passes(surface, halfway, names, view, specular=specular), *diffuse)
