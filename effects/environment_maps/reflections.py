"""H20, H21, H58, H59: reflections from environment maps of three kinds, by generated coordinates.

    cube map        one lookup by the reflected vector (REFLECTION_MAP); the texture matrix undoes the
                    camera's rotation, so the map is the world's and serves every view
    parabolic map   two discs of directions z <= 0 and z > 0; the texture matrix undoes the rotation and
                    divides by 1 - z or 1 + z, through q. Two units look both up, and one disc's alpha, which
                    is one inside, selects. With one unit the second disc is drawn over the first, where the
                    alpha test passes
    sphere map      SPHERE_MAP: a picture of a mirror ball, right only for the view that it was made for

Between vertices, an iterated vector is shorter than one. Near the opposite pole of a disc its divisor is then
too large. So the middle of a coarse facet reads inside the disc, and shows a dot. Therefore the disc whose
alpha selects is the one whose opposite pole faces away from the eye (``over``), where reflections graze.

Boards without cube maps have no REFLECTION_MAP; there the host writes the reflected vectors at the vertices.
A cube map that was filtered beforehand (``prefilter``) is looked up in the same way, for diffuse light by
NORMAL_MAP.

Source: Heidrich 2001, sections 1.2, 1.3 and 1.5; Heidrich, Seidel 1998 (parabolic maps); EXT_texture_cube_map
(REFLECTION_MAP, NORMAL_MAP); pass sequences A-H20, A-H21 and A-H58/H59 of the catalogue.
"""

import numpy as np

from fixedpipe.effects.geometry import cube_maps, parabolic_maps
from fixedpipe.effects.geometry.matrices import product
from fixedpipe.effects.geometry.vertex_vectors import reflected
from fixedpipe.effects.passes.combiners import (
    SPARE0,
    TEXTURE0,
    TEXTURE1,
    alpha_of,
    one_minus,
    program,
    shown,
    total,
)
from fixedpipe.effects.passes.combiners import product as times
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, LATER_PASS, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import ComparisonFunction, InternalFormat, TexGenMode
from fixedpipe.pipeline.state import AlphaTest, TexGen
from fixedpipe.pipeline.textures.images import texture_2d, texture_cube_map

TECHNIQUES = (
    Technique("H20", "cube maps: environment maps that serve every view", "1.3"),
    Technique("H21", "parabolic maps: two discs, chosen by alpha", "1.3"),
    Technique("H57", "environment maps instead of radiance of four dimensions", "1.2"),
    Technique("H58", "sphere maps, which serve one view", "1.3"),
    Technique("H59", "an environment map without Fresnel's factor: smooth metal", "1.5"),
)

_INSIDE = AlphaTest(ComparisonFunction.GREATER, 0.5)


def load_cube(name, cube, profile):
    """The command that loads a cube map of floats [6, n, n, 3] in [0, 1] as bytes."""
    image = texture_cube_map(factor_texels(cube_maps.checked(cube), profile), InternalFormat.RGB8)
    return TexImage(label=f"load {name}", texture=name, image=image)


def load_discs(names, discs, profile, margin=2):
    """The commands that load two discs [2, n, n, 3] that leave ``margin`` texels to each edge of their maps;
    alpha is one in the discs.
    """
    size = discs.shape[1]
    alpha = parabolic_maps.inside(size, parabolic_maps.margin(size, margin)).astype(np.float64)
    return tuple(
        TexImage(
            label=f"load {name}",
            texture=name,
            image=texture_2d(factor_texels(np.concatenate([disc, alpha[..., None]], axis=-1), profile)),
        )
        for name, disc in zip(names, discs, strict=True)
    )


def world_from_eye(view):
    """The texture matrix that undoes the camera's rotation."""
    turn = view.modelview
    return (*((turn[0][k], turn[1][k], turn[2][k], 0.0) for k in range(3)), (0.0, 0.0, 0.0, 1.0))


def generated(mode, count=3):
    """Generation of the first ``count`` coordinates in a mode."""
    return (*(TexGen(mode) for _ in range(count)), *(TexGen() for _ in range(4 - count)))


def cube_pass(surface, view, texture, *, by=TexGenMode.REFLECTION_MAP, label=None, **settings):
    """One draw: the cube map looked up by the reflected vector, or by the normal (NORMAL_MAP).

    ``settings``: of ``draws.draw``; the texel replaces what comes in.
    """
    read = unit(texture, EDGE, environment=REPLACE, gen=generated(by), matrix=world_from_eye(view))
    word = "normal" if by is TexGenMode.NORMAL_MAP else "reflected vector"
    settings = {"depth_test": FIRST_PASS, **settings}
    return draw(label or f"{texture}, by the {word}", surface.mesh(), view, None, (read,), **settings)


def sphere_pass(surface, view, texture, **settings):
    """One draw: the sphere map looked up by SPHERE_MAP's coordinates."""
    read = unit(texture, EDGE, environment=REPLACE, gen=generated(TexGenMode.SPHERE_MAP, 2))
    settings = {"depth_test": FIRST_PASS, **settings}
    return draw(f"{texture}, by SPHERE_MAP", surface.mesh(), view, None, (read,), **settings)


def disc_pass(surface, view, name, disc, size):
    """One draw of one disc, 0 or 1, by generated vectors; arguments as ``parabolic_pass``'s."""
    matrix = product(parabolic_maps.matrix(disc, parabolic_maps.margin(size)), world_from_eye(view))
    read = unit(name, EDGE, environment=REPLACE, gen=generated(TexGenMode.REFLECTION_MAP), matrix=matrix)
    return draw(f"{name} alone", surface.mesh(), view, None, (read,), depth_test=FIRST_PASS)


def over(view):
    """Which disc's alpha chooses: the second where the eye is at positive z, else the first."""
    return int(view.eye[2] > 0.0)


def parabolic_pass(surface, view, names, size, **settings):
    """One draw with two units, generated vectors, and combiners that mix by one disc's alpha (``over``).

    ``size``: the discs' texels along an edge.
    """
    reach, turn = parabolic_maps.margin(size), world_from_eye(view)
    units = tuple(
        unit(
            name,
            EDGE,
            gen=generated(TexGenMode.REFLECTION_MAP),
            matrix=product(parabolic_maps.matrix(disc, reach), turn),
        )
        for disc, name in enumerate(names)
    )
    above, below = (TEXTURE1, TEXTURE0) if over(view) else (TEXTURE0, TEXTURE1)
    inside = alpha_of(above)
    mixed = total(times(above, inside), times(below, one_minus(inside)), to=SPARE0)
    settings = {"depth_test": FIRST_PASS, **settings}
    combiners = program(mixed, shown(SPARE0))
    return draw(
        f"both discs, mixed by the {('first', 'second')[over(view)]}'s alpha",
        surface.mesh(),
        view,
        combiners,
        units,
        **settings,
    )


def reflected_vectors(surface, view):
    """Reflected vectors at the vertices, of length one, in world coordinates: float64 [n, 3]."""
    return reflected(view.view_vectors(surface.positions), surface.normals)


def parabolic_passes(surface, view, names, size, vectors=None, margin=2):
    """Two draws with one unit: a disc, then the other where its alpha is one (``over``).

    ``vectors``: the host's, of length one, float64 [n, 3]; None: ``reflected_vectors``.
    """
    mesh = surface.mesh(reflected_vectors(surface, view) if vectors is None else vectors)
    reach = parabolic_maps.margin(size, margin)

    def one(disc, **settings):
        read = unit(names[disc], EDGE, environment=REPLACE, matrix=parabolic_maps.matrix(disc, reach))
        return draw(f"{names[disc]}, by the host's vectors", mesh, view, None, (read,), **settings)

    above = over(view)
    return one(1 - above, depth_test=FIRST_PASS), one(above, depth_test=LATER_PASS, alpha_test=_INSIDE)
