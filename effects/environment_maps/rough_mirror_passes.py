"""S24 and S25 on boards of the time: a bumped surface mirrors an environment, filtered by roughness.

It takes one pass for each roughness.

A GeForce 3 computes r = 2 N (N.e)/(N.N) - e from a bump map and looks it up in a cube map
(``bumped_reflections``). But no vertex gives these coordinates, so the lookup has no level: the machine reads
the cube map's level 0. A 3D texture of filtered maps cannot take I_1 as its third coordinate either. Each of
the three coordinates is a product with the same texel (f_1, f_2, third), and r needs a one there. So each
level is a texture of its own. I_1, the bump map's alpha, is mip-mapped with the map and weights the levels:

    load   the bump map's levels: (f_1, f_2)/s and 1 as RGB, I_1 over the largest I_1 as alpha
           cube map k of n: the environment as a flat mirror of roughness sigma_k shows it, sigma_0 = 0
    pass k reads cube map k; register combiners make
               weight = (1 - (4 (alpha - c_k))+ - (4 (c_k - alpha))+)+,  c_k = k / 4
           a tent round c_k; tents sum to one. The alpha test leaves out what has no weight, blending adds.

A cube map for roughness sigma holds, along r, the environment filtered by Sigma = sigma^2 J_r J_r^T. J_r is
that of the flat surface in which r is seen. So the map is anisotropic, as S24 is. Roughness of equal size in
all directions spreads r by 2 sigma in the plane of incidence and by 2 sigma cos theta_i across it.
``isotropic`` maps spread by 2 sigma in all directions (S25), as a mip-map would.

The machine does not measure curvature, the change of r from pixel to pixel. In the levels above 0 a pixel's
step is about a texel's. So the change of f over half a texel is added to K before I_1 is taken.

Source: Schilling 1997, section 8; NV_texture_shader, section 3.8.13.1.18; docs/numbers.md, N12.11 (no level).
Inferred: the tents; pass sequences A-S24 and A-S25 of the catalogue.
"""

from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.environment_maps import rough_mirrors
from fixedpipe.effects.environment_maps.bumped_reflections import rows_and_eye
from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.passes.arguments import positive
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE3,
    final,
    negated,
    one_minus,
    program,
    scaled,
    stage,
    total,
)
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, LATER_PASS, draw, unit
from fixedpipe.effects.passes.encoding import dot_product_texels, factor_texels
from fixedpipe.effects.passes.texture_shaders import NO_TEXTURE, TEXTURE_STAGE, dot_product_stages
from fixedpipe.effects.technique import Technique, Variant
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import BlendFactor, ComparisonFunction, InternalFormat, TextureFilter, WrapMode
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import AlphaTest, Blending, Sampler
from fixedpipe.pipeline.textures.images import Texture, texture_2d, texture_cube_map

TECHNIQUES = (
    Technique("S28", "distant water: its mean normal mirrors the moon, its roughness spreads the light", "6"),
    Variant(("S24", "S25"), "on a GeForce 3, a pass for each of five filtered cube maps, weighed by I_1"),
)

# Cube maps, and so passes.  Inferred: tents a quarter of alpha's range wide are what a combiner's largest
# scale, four, makes.
ROUGHNESSES = 5
_STEP = 0.25
TRILINEAR = Sampler(
    TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR, WrapMode.REPEAT, WrapMode.REPEAT
)
_WEIGHED = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ZERO)
_ADD_WEIGHED = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE)
_WITH_WEIGHT = AlphaTest(ComparisonFunction.GREATER, 0.0)


@dataclass(frozen=True)
class Stored:
    """What was loaded: the bump map's name, the cube maps' names from the smoothest on, and the offset and
    the I_1 that are stored as one.
    """

    bumps: str
    cubes: tuple[str, ...]
    offset: float
    roughness: float

    def __post_init__(self):
        if len(self.cubes) != ROUGHNESSES:
            raise ValueError(
                f"{len(self.cubes)} cube maps are named; give {ROUGHNESSES}, the smoothest first."
            )
        positive(self.offset, "The offset that is stored as one")
        positive(self.roughness, "The roughness that is stored as one")


def with_curvature(levels):
    """The pyramids as a tuple of Level. Above level 0, K also has the change of f over half of a texel in
    each direction. The bump map repeats.
    """
    out = [levels[0]]
    for level in levels[1:]:
        across, along = (
            0.25 * (np.roll(level.offsets, -1, axis) - np.roll(level.offsets, 1, axis)) for axis in (1, 0)
        )
        more = rough.products(across) + rough.products(along)
        out.append(replace(level, covariance=level.covariance + more))
    return tuple(out)


def largest(levels):
    """(the largest offset of either sign in level 0, the largest I_1 of all levels), each at least 2^-10."""
    offset = float(np.abs(levels[0].offsets).max())
    roughness = max(float(rough.largest_deviation(level.covariance).max()) for level in levels)
    return max(offset, 2.0**-10), max(roughness, 2.0**-10)


def deviations(roughness):
    """The deviations that the cube maps are for, ``roughness`` being stored as one: a tuple of floats."""
    return tuple(roughness * _STEP * k for k in range(ROUGHNESSES))


def _texture(images):
    """One texture of the levels' images, level 0 first."""
    levels = [texture_2d(image) for image in images]
    first = levels[0]
    ideal = None if first.ideal is None else tuple(level.ideal[0] for level in levels)
    return Texture(
        first.target, first.internal_format, tuple(level.levels[0] for level in levels), ideal, first.bits
    )


def load_bumps(levels, stored, profile):
    """The command that loads the bump map with I_1 in alpha, all levels of both pyramids."""
    images = []
    for level in levels:
        f = np.clip(level.offsets / stored.offset, -1.0, 1.0)
        vectors = np.concatenate([f, np.ones((*f.shape[:2], 1))], axis=-1)
        alpha = np.clip(rough.largest_deviation(level.covariance) / stored.roughness, 0.0, 1.0)
        images.append(dot_product_texels(vectors, alpha, profile))
    return TexImage(
        label="load the bump map's levels, I_1 in alpha", texture=stored.bumps, image=_texture(images)
    )


def rough_cube(cube_levels, frame, deviation, size, *, isotropic=False, most=16):
    """The environment as a flat mirror of one roughness shows it: float64 [6, size, size, 3], at most one.

    cube_levels  as ``rough_mirrors.cube_pyramid``; light of any brightness
    frame        float64 [3, 3]: the surface's e_1, e_2 and n
    deviation    of the offsets in any direction
    isotropic    spread by 2 ``deviation`` all round
    most         probes of the environment for a texel, at most

    Raises ValueError for a deviation that is not finite or below zero, and a size below one.
    """
    if not (np.isfinite(deviation) and deviation >= 0.0):
        raise ValueError(f"The deviation of the offsets is {deviation}; give a number from zero on.")
    toward = cube_maps.directions(size)
    step = 2.0 / size * np.abs(toward).max(axis=-1)[..., None]
    planes = cube_maps.vectors(*(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])))
    along = [(planes[:, k] - planes[:, 2])[:, None, None, :] * step for k in (0, 1)]
    if isotropic:
        upright = np.abs(toward[..., 1:2]) > 0.75
        first = normalize(cross(toward, np.where(upright, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])))
        by_offset = 2.0 * np.stack([first, cross(toward, first)], axis=-2)
    else:
        incoming = toward - 2.0 * dot(toward, frame[2])[..., None] * frame[2]
        by_offset = rough_mirrors.mirrored(incoming, np.zeros((*toward.shape[:-1], 2)), frame)[1]
    covariance = np.zeros(toward.shape) + deviation * deviation * np.array([1.0, 0.0, 1.0])
    beam = rough_mirrors.Beam(
        np.ones(toward.shape[:-1], bool), toward, by_offset, np.stack(along, axis=-2), covariance
    )
    how = rough_mirrors.Antialiasing.ISOTROPIC if isotropic else rough_mirrors.Antialiasing.ANISOTROPIC
    return np.clip(rough_mirrors.shown(beam, cube_levels, how, most), 0.0, 1.0)


def load_cubes(cubes, stored, profile):
    """The commands that load cube maps [6, n, n, 3], from the smoothest on, under ``stored.cubes``.

    Raises ValueError for more or fewer than are named.
    """
    if len(cubes) != len(stored.cubes):
        raise ValueError(f"There are {len(cubes)} cube maps and {len(stored.cubes)} names; give as many.")
    return tuple(
        TexImage(
            label=f"load {name}",
            texture=name,
            image=texture_cube_map(factor_texels(cube, profile), InternalFormat.RGB8),
        )
        for cube, name in zip(cubes, stored.cubes, strict=True)
    )


def _weighing(number):
    """Register combiners: what unit 3 reads, and in alpha the tent of cube map ``number``.

    No more is clamped than (.)+ does, so that the ideal, which has no largest number, makes the same tent.
    """
    at = (0.0, 0.0, 0.0, number * _STEP)
    return program(
        stage(alpha=scaled(4, total(TEXTURE0, negated(CONSTANT0), to=SPARE0)), constant0=at),
        stage(alpha=scaled(4, total(CONSTANT0, negated(TEXTURE0), to=SPARE1)), constant0=at),
        stage(alpha=total(SPARE0, SPARE1, to=SPARE0)),
        final(TEXTURE3, alpha=one_minus(SPARE0)),
    )


def _pass(label, surface, stored, view, number, read, combiners, **settings):
    bumped = replace(
        surface, tangents=stored.offset * surface.tangents, binormals=stored.offset * surface.binormals
    )
    mesh = surface.mesh(surface.texture_coordinates, *rows_and_eye(bumped, view))
    units = (
        read,
        unit(NO_TEXTURE, coordinates=1),
        unit(NO_TEXTURE, coordinates=2),
        unit(stored.cubes[number], EDGE, coordinates=3),
    )
    stages = (TEXTURE_STAGE, *dot_product_stages(0, 0, 0, lookup=Operation.DOT_PRODUCT_REFLECT_CUBE_MAP))
    return draw(label, mesh, view, combiners, units, texture_shader=stages, **settings)


def plain_pass(surface, stored, view, sampler=TRILINEAR):
    """The same without roughness, one draw: r of the bump map in the environment itself. Bumps are filtered
    as ``sampler`` says: averaged as colours are (S09), or by REPEATED not at all.
    """
    label = "reflection: r of the bumped normal, looked up in the cube map"
    return _pass(
        label,
        surface,
        stored,
        view,
        0,
        unit(stored.bumps, sampler),
        program(final(TEXTURE3)),
        depth_test=FIRST_PASS,
    )


def rough_passes(surface, stored, view, sampler=TRILINEAR, *, bias=0.0):
    """A draw for each roughness, which adds its cube map with I_1's weight.

    ``bias``: of the level of the bump map and of its I_1. Below zero is for a surface seen at a flat angle,
    where the level of a pixel's longer edge filters too much across it.
    """
    out, read = [], unit(stored.bumps, sampler, lod_bias=bias)
    for number in range(ROUGHNESSES):
        settings = (
            {"depth_test": LATER_PASS, "blending": _ADD_WEIGHED, "alpha_test": _WITH_WEIGHT}
            if number
            else {"depth_test": FIRST_PASS, "blending": _WEIGHED}
        )
        label = f"add roughness {number} of {ROUGHNESSES}, where I_1 gives it weight"
        out.append(_pass(label, surface, stored, view, number, read, _weighing(number), **settings))
    return tuple(out)
