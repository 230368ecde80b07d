"""S24 and S25 on the machine that the paper proposes: a bumped plane mirrors an environment, in one pass.

The lookup is filtered by the plane's roughness.

    unit 0   bumps: f_1 and f_2 over ``bump_scale`` as signed bytes, and one; mip-mapped
    unit 1   D of each level over ``rough_scale``, three bytes; mip-mapped
    unit 2   the dot product that is s
    unit 3   the dot product that is t: the environment there, over pixel and roughness

At a vertex a row is (ds/df_1, ds/df_2) times the scale of the bumps, and the s of the plane without bumps. So
the lookup starts at the plane's own reflection and is linear in the bumps. The environment is a picture by
central projection (``Ahead``), whose coordinates are quotients.

Source: Schilling 1997, sections 2 and 8 (proposed); decisions 0020 and 0021; pass sequences A-S24 and A-S25
of the catalogue. Assumed: the division into stages, and the map's projection.
"""

from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.environment_maps.rough_mirrors import mirrored
from fixedpipe.effects.geometry.vectors import cross, dot, normalize, unit_vector
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPEATED, REPLACE, draw, unit
from fixedpipe.effects.technique import Variant
from fixedpipe.pipeline.commands import Mesh, TexImage
from fixedpipe.pipeline.enums import (
    DotProductMapping,
    InternalFormat,
    PrimitiveType,
    TextureEnvironmentMode,
    TextureFilter,
)
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import SignedComponents, TextureEnvironment, TextureShaderStage
from fixedpipe.pipeline.textures.images import Texture, texture_2d

TECHNIQUES = (Variant(("S24", "S25"), "on the machine that the paper proposes"),)

BUMPS, ROUGHNESS, ENVIRONMENT = "bumps", "roughness", "environment ahead"
_NONE = TextureEnvironment(TextureEnvironmentMode.NONE)
_TRILINEAR = replace(REPEATED, min_filter=TextureFilter.LINEAR_MIPMAP_LINEAR)
_ENVIRONMENT = replace(EDGE, min_filter=TextureFilter.LINEAR_MIPMAP_LINEAR)


@dataclass(frozen=True)
class Ahead:
    """A central projection of the directions ahead: its axis, its up vector, and the tangent of half its
    angle.
    """

    axis: tuple[float, float, float] = (0.0, 0.0, -1.0)
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    reach: float = 1.0

    def __post_init__(self):
        if not (np.isfinite(self.reach) and self.reach > 0.0):
            raise ValueError(f"The projection's reach is {self.reach}; give a tangent above zero.")

    @property
    def frame(self):
        """The unit vectors to the right, up and ahead: float64 [3, 3]."""
        ahead = unit_vector(self.axis, "The projection's axis")
        right = normalize(cross(ahead, unit_vector(self.up, "The projection's upward direction")))
        return np.stack([right, cross(right, ahead), ahead])

    def directions(self, width, height):
        """Directions of the texels' middles, bottom row first, float64 [height, width, 3], not normalised."""
        right, up, ahead = self.frame
        s, t = (2.0 * (np.arange(n) + 0.5) / n - 1.0 for n in (width, height))
        across = (self.reach * s)[None, :, None] * right
        return across + (self.reach * t)[:, None, None] * up + ahead

    def coordinates(self, toward, changes):
        """(s, t) of directions [n, 3], float64 [n, 2], and their changes, [n, 2, k], for changes [n, k, 3] of
        the directions.

        Raises ValueError if a direction does not lead ahead.
        """
        *across, ahead = self.frame
        depth = dot(toward, ahead)
        if not (depth > 0.0).all():
            raise ValueError(
                "A mirrored ray does not lead ahead, where the environment's picture is; turn its axis, or "
                "end the plane where rays still do."
            )
        half, found, moved = 0.5 / self.reach, [], []
        for axis in across:
            place = dot(toward, axis)
            found.append(0.5 + half * place / depth)
            slope = dot(changes, axis) * depth[:, None] - dot(changes, ahead) * place[:, None]
            moved.append(half * slope / (depth * depth)[:, None])
        return np.stack(found, axis=1), np.stack(moved, axis=1)


def _checked(scale, what):
    if not (np.isfinite(scale) and scale > 0.0):
        raise ValueError(f"The scale of {what} is {scale}; give a number above zero.")
    return float(scale)


def _texture(levels):
    """Texels [rows, columns, 3] of each level as one texture."""
    images = [texture_2d(texels, InternalFormat.RGB8) for texels in levels]
    first = images[0]
    ideal = None if first.ideal is None else tuple(image.ideal[0] for image in images)
    return Texture(
        first.target, first.internal_format, tuple(image.levels[0] for image in images), ideal, first.bits
    )


def load(levels, environment, bump_scale, rough_scale):
    """Commands that load the pyramids, a tuple of ``roughness_pyramids.Level``, and the environment, RGB in
    [0, 1], float64 [rows, columns, 3].

    bump_scale   the offset that is stored as one; larger ones are clamped
    rough_scale  the deviation that is one
    """
    _checked(bump_scale, "the bumps")
    bumps = []
    for level in levels:
        signed = np.clip(np.floor(127.0 * level.offsets / bump_scale + 0.5), -127.0, 127.0).astype(np.int64)
        one = np.full((*signed.shape[:2], 1), 127)
        bumps.append((np.concatenate([signed, one], axis=2) & 255).astype(np.uint8))
    stored = [rough.deviation_bytes(level.deviations, rough_scale) for level in levels]
    colors = np.floor(255.0 * np.clip(environment, 0.0, 1.0) + 0.5).astype(np.uint8)
    return (
        TexImage(label="load bumps", texture=BUMPS, image=_texture(bumps)),
        TexImage(label="load roughness", texture=ROUGHNESS, image=_texture(stored)),
        TexImage(
            label="load environment",
            texture=ENVIRONMENT,
            image=texture_2d(colors, InternalFormat.RGB8, mipmaps=True),
        ),
    )


def plane_mesh(view, mirror, u, v, ahead, bump_scale):
    """The plane at rising distances u along e_1 and v along e_2 from the mirror's origin, world units, with
    coordinates of the bumps and both rows of dot products.

    Raises ValueError if a mirrored ray does not lead ahead.
    """
    first, second, _ = mirror.frame
    at_u, at_v = (c.ravel() for c in np.meshgrid(u, v))
    points = np.asarray(mirror.origin, np.float64) + at_u[:, None] * first + at_v[:, None] * second
    toward, changes = mirrored(-view.view_vectors(points), np.zeros((len(points), 2)), mirror.frame)
    places, moved = ahead.coordinates(toward, changes)
    one = np.ones((len(points), 1))
    rows = (np.concatenate([moved[:, k] * bump_scale, places[:, k : k + 1], one], axis=1) for k in range(2))
    bumps = np.stack([at_u, at_v], axis=1) / mirror.period
    corner = (np.arange(len(v) - 1)[:, None] * len(u) + np.arange(len(u) - 1)).ravel()
    quads = np.stack([corner, corner + 1, corner + len(u) + 1, corner + len(u)], axis=1)
    return Mesh(points, PrimitiveType.QUADS, indices=quads.ravel(), texture_coordinates=(bumps, *rows))


def reflection(mesh, view, bump_scale, rough_scale, *, probes=8, filtered=True, depth_test=FIRST_PASS):
    """The pass over a ``plane_mesh``.

    probes    most probes along the ellipse's longer axis (S24); 1: one probe at that axis's level (S25)
    filtered  whether roughness filters the environment; if not, it is read at level 0
    """
    reads = {"previous_texture_input": 0, "dot_product_mapping": DotProductMapping.SIGNED_IDENTITY}
    last = {}
    if filtered:
        scale = _checked(rough_scale, "the roughness") / _checked(bump_scale, "the bumps")
        last = {"roughness": 1, "roughness_scale": scale}
    stages = (
        TextureShaderStage(Operation.TEXTURE_2D),
        TextureShaderStage(Operation.TEXTURE_2D),
        TextureShaderStage(Operation.DOT_PRODUCT, **reads),
        TextureShaderStage(Operation.DOT_PRODUCT_TEXTURE_2D, **reads, **last),
    )
    signed = replace(_TRILINEAR, signed_components=SignedComponents(True, True, True, True))
    sampler = replace(_ENVIRONMENT, max_probes=probes) if filtered else EDGE
    units = (
        unit(BUMPS, signed, environment=_NONE),
        unit(ROUGHNESS, _TRILINEAR, environment=_NONE),
        unit(None, environment=_NONE, coordinates=1),
        unit(ENVIRONMENT, sampler, coordinates=2, environment=REPLACE),
    )
    return draw("mirrored environment", mesh, view, None, units, depth_test=depth_test, texture_shader=stages)
