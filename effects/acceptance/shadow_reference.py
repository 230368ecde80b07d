"""Pictures of a scene's shadows without any shadow algorithm: the references of the shadow figures.

Rays find what is visible at sixteen places of a pixel, and whether the lamp reaches it. One place, the
middle, is enough for a pixel whose neighbours show the same thing in the same light and nearly its colour.
The light there is OpenGL's: computed at the vertices of the triangle (the lighting of
``fixedpipe.effects.shadows.lit_scene``), then interpolated as OpenGL does, in float64. So a machine's picture
differs where its shadows err, and where edges are stairs because a pixel has one sample.

Rays meet flat triangles. Where light grazes a round surface, a triangle may face away although its vertices'
normals do not. Rays then leave it dark, and a map with a bias lights it.
"""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.acceptance import ray_caster
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, View
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, Object, Scene
from fixedpipe.effects.shadows.lit_scene import AMBIENT, LAMP_COLOR, SHININESS, SceneShading
from fixedpipe.pipeline.commands import Clear, Command
from fixedpipe.pipeline.ideal.evaluate import execute_ideal

# Samples along a pixel's edge: a regular grid of four by four.
SAMPLES = 4
# Rows of pixels that are cast at a time; they bound the memory (Measured: 40 MB a thread at 512 pixels) and
# change no picture.
_ROWS = 8
# Colours of neighbours that are nearer than this need no more samples than their middles: where light only
# bends, a pixel's mean is its middle's but for less. Measured: of F003-18's pixels, 35
# are off by more than 1/255, the worst by 2/255.
_NEARLY = 1.0 / 64.0


@dataclass(frozen=True, eq=False)
class Shot:
    """What one panel of a figure shows.

    scene         the objects that are seen and throw shadows
    view          the camera, on a panel of any place and size: its width and height are the picture's
    lamps         what lights: one, or the points of an area light, whose mean it is
    background    RGB in [0, 1] of pixels that show no object
    shading       its materials, or SceneShading.MASK: how much of the lamps reaches a sample
    parts         where slices of the view have other colours: (clip planes of eye coordinates, the scene with
                  its colours) of each; the first whose planes keep a sample colours it
    self_shadows  False: no object's shadow falls on itself
    shadows       False: everything that faces the lamp is lit, as without any shadow algorithm
    in_shadow     the share of all light, ambient light included, that a shadow leaves where one pass draws
                  both; None: a shadow leaves all ambient light and none of the lamp's
    reached       (points [n, 3]) -> bool [n]: where a lamp lights at all, or None: everywhere
    """

    scene: Scene
    view: View
    lamps: tuple[Lamp, ...]
    background: tuple[float, float, float] = BACKGROUND
    shading: SceneShading = SceneShading.LIT
    parts: tuple[tuple[tuple[tuple[float, ...], ...], Scene], ...] = ()
    self_shadows: bool = True
    shadows: bool = True
    in_shadow: float | None = None
    reached: Callable[[NDArray[np.float64]], NDArray[np.bool_]] | None = None


def rays(shot: Shot, *, samples: int = SAMPLES, threads: int | None = None) -> NDArray[np.float64]:
    """The picture of a Shot: RGBA float64 [height, width, 4], top row first, 1.0 = full, alpha one.

    samples  samples along a pixel's edge, from 1
    threads  how many threads; None: one per processor. The bits are the same for any number

    With one lamp, a pixel that resembles its neighbours (``_differing``) has one sample, its middle. With n
    lamps, each of a pixel's samples tests n / samples^2 lamps, and together they test every lamp.

    Raises ValueError without a lamp, and if ``samples`` is not a whole number from 1.
    """
    if not shot.lamps:
        raise ValueError("A picture without a lamp has no shadows; give one lamp or more.")
    if samples != int(samples) or samples < 1:
        raise ValueError(f"The samples along a pixel's edge are {samples!r}; give a whole number from 1.")
    width, height = shot.view.panel.width, shot.view.panel.height
    caster = ray_caster.scene_caster(shot.scene)
    scenes = [scene for _, scene in shot.parts] or [shot.scene]
    light = [_Lighting(scene, shot) for scene in scenes]
    out = np.ones((height, width, 4))

    def cast(samples: int, chosen: NDArray[np.bool_]) -> NDArray[np.int64]:
        """The chosen pixels' colours into ``out``, and what is seen in each's first sample."""
        fine = replace(shot.view, panel=Panel(0, 0, samples * width, samples * height))
        seen = np.zeros((height, width), np.int64)

        def strip(first: int) -> None:
            here = np.s_[first : first + _ROWS]
            repeated = chosen[here].repeat(samples, axis=0).repeat(samples, axis=1)
            places = np.nonzero(repeated.ravel())[0] + samples * first * fine.panel.width
            colors, kinds = _samples(shot, caster, light, fine, places, samples)
            grid = np.zeros((*repeated.shape, 3))
            grid[repeated] = colors
            mean = grid.reshape(-1, samples, width, samples, 3).mean(axis=(1, 3))
            out[here][chosen[here], :3] = mean[chosen[here]]
            if samples == 1:
                seen[here] = kinds.reshape(-1, width)

        with ThreadPoolExecutor(threads or os.cpu_count() or 1, "fixedpipe-rays") as pool:
            list(pool.map(strip, range(0, height, _ROWS)))
        return seen

    everywhere = np.ones((height, width), np.bool_)
    if len(shot.lamps) > 1 or samples == 1:
        cast(samples, everywhere)
    else:
        seen = cast(1, everywhere)
        cast(samples, _differing(seen, out))
    return out[::-1]


def _differing(seen: NDArray[np.int64], colors: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Pixels beside one, in eight directions, that shows another thing, or has light where it has shadow, or
    a colour that is not nearly the same: bool [h, w]. In the others sixteen samples are their middle one's.
    """
    out = np.zeros(seen.shape, np.bool_)
    for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1)):
        before = np.s_[: len(seen) - dy, max(-dx, 0) : seen.shape[1] - max(dx, 0)]
        after = np.s_[dy:, max(dx, 0) : seen.shape[1] - max(-dx, 0)]
        apart = (seen[before] != seen[after]) | (
            np.abs(colors[before] - colors[after]).max(axis=-1) > _NEARLY
        )
        out[before] |= apart
        out[after] |= apart
    return out


def row(size: int, pictures: Sequence[NDArray[np.float64] | Shot | None]) -> NDArray[np.float64]:
    """A row of square panels: RGBA float64 [size, len(pictures) * size, 4], top row first. A Shot is cast;
    None has no reference, its alpha is zero.
    """
    none = np.zeros((size, size, 4))
    kept: dict[int, NDArray[np.float64]] = {}
    out = []
    for picture in pictures:
        if isinstance(picture, Shot):
            # A Shot that several panels show is cast once.
            picture = kept[id(picture)] = kept[id(picture)] if id(picture) in kept else rays(picture)
        out.append(none if picture is None else picture)
    return np.concatenate(out, axis=1)


def _column(values, count: int) -> NDArray[np.float64]:
    return np.repeat(np.array(values, np.float64), count, axis=0)


class _Lighting:
    """The light at the corners of a scene's triangles.

    unlit  float64 [triangles, 3]: without the lamp
    lit    float64 [lamps, sides, triangles, 3 corners, 3]: the lamp's; sides: the front, and the back where
           some object has two
    """

    def __init__(self, scene: Scene, shot: Shot):
        counts = [len(thing.surface.triangles) for thing in scene.objects]
        self.two_sided = any(thing.two_sided for thing in scene.objects)
        if shot.shading is SceneShading.MASK:
            total = sum(counts)
            self.unlit, self.two_sided = np.zeros((total, 3)), False
            self.lit = np.broadcast_to(1.0, (len(shot.lamps), 1, total, 3, 3))
            return
        self.unlit = _column([np.array(AMBIENT[:3]) * thing.color for thing in scene.objects], counts)
        self.lit = np.stack(
            [
                np.stack(
                    [
                        np.concatenate(
                            [_light_at_corners(thing, shot.view, lamp, side) for thing in scene.objects]
                        )
                        for side in ((1.0, -1.0) if self.two_sided else (1.0,))
                    ]
                )
                for lamp in shot.lamps
            ]
        )

    def whole(self, lamp, side, triangles, weights) -> NDArray[np.float64]:
        """The lamp's light at places of triangles: float64 [n, 3], not above one."""
        return np.einsum("nk,nkc->nc", weights, self.lit[lamp, side, triangles])


def corner_light(shot: Shot) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Light at the corners of a Shot's triangles: without the lamps, float64 [triangles, 3], and each lamp's
    on the front, float64 [lamps, triangles, 3 corners, 3].
    """
    light = _Lighting(shot.scene, shot)
    return light.unlit, light.lit[:, 0]


def _light_at_corners(thing: Object, view: View, lamp: Lamp, side: float) -> NDArray[np.float64]:
    """What the lamp gives at a thing's vertices, by its triangles: float64 [n, 3 corners, 3]; ``side`` -1:
    on the back of what has two.

    Source: OpenGL 1.2.1, section 2.13.1, of ``lit_scene.lit_lighting``.
    """
    surface = thing.surface
    normals = (side if thing.two_sided else 1.0) * surface.normals
    towards = normalize(ray_caster.to_light(surface.positions, lamp)[0])
    facing = np.maximum(dot(normals, towards), 0.0)
    halfway = normalize(towards + view.view_vectors(surface.positions))
    shine = np.where(facing > 0.0, np.maximum(dot(normals, halfway), 0.0) ** SHININESS, 0.0)
    strength = facing[:, None] * np.array(thing.color) + thing.specular * shine[:, None]
    return np.minimum(np.array(LAMP_COLOR[:3]) * strength, 1.0)[surface.triangles]


def _samples(shot, caster, light, fine, places, samples) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """RGB of some samples, ``places``: numbers of the pixels of the view ``fine``: float64 [n, 3]; and the
    number of what each sees, another where it is lit: int64 [n].
    """
    origins, directions = ray_caster.primary_rays(fine, places)
    hits = caster.nearest(origins, directions, 1.0)
    colors = np.empty((len(origins), 3))
    colors[:] = shot.background
    seen = np.nonzero(hits.triangle >= 0)[0]
    triangles, weights = hits.triangle[seen], hits.barycentrics[seen]
    points = origins[seen] + hits.distance[seen, None] * directions[seen]
    normals = caster.normals[triangles]
    behind = dot(normals, directions[seen]) > 0.0
    normals = np.where(behind[:, None], -normals, normals)
    y, x = np.divmod(places[seen], fine.panel.width)
    turn = (y % samples) * samples + x % samples
    part = _parts_of(shot, points)
    each = len(light[0].lit)
    rounds = -(-each // samples**2)
    whole, direct = np.zeros((2, len(seen), 3))
    asked, reached = np.zeros((2, len(seen)))
    for k in range(rounds):
        number = turn + k * samples**2 if each > 1 else np.zeros(len(seen), np.int64)
        for lamp in np.unique(number[number < each]):
            here = np.nonzero(number == lamp)[0]
            where = points[here]
            arrives = _arrives(shot, caster, shot.lamps[lamp], where, normals[here], triangles[here])
            given = np.empty((len(here), 3))
            for index, lighting in enumerate(light):
                of = part[here] == index
                at = here[of]
                side = behind[at].astype(np.int64) if lighting.two_sided else 0
                given[of] = lighting.whole(lamp, side, triangles[at], weights[at])
            whole[here] += given
            direct[here] += given * arrives[:, None]
            asked[here] += 1.0
            reached[here] += arrives
    share = (reached / np.maximum(asked, 1.0))[:, None]
    asked = np.maximum(asked, 1.0)[:, None]
    unlit = np.choose(part[:, None], [lighting.unlit[triangles] for lighting in light])
    lit = unlit + direct / asked
    if shot.in_shadow is not None:
        lit = np.minimum(unlit + whole / asked, 1.0) * (shot.in_shadow + (1.0 - shot.in_shadow) * share)
    colors[seen] = np.minimum(lit, 1.0)
    kinds = np.full(len(origins), -1)
    kinds[seen] = 2 * caster.objects[triangles] + (reached > 0.0)
    return colors, kinds


def _arrives(shot, caster, lamp, points, normals, triangles) -> NDArray[np.bool_]:
    if not shot.shadows:
        return np.ones(len(points), np.bool_)
    own = None if shot.self_shadows else caster.objects[triangles]
    out = ray_caster.lit_points(caster, points, normals, lamp, triangles=triangles, objects=own)
    return out if shot.reached is None else out & shot.reached(points)


def _parts_of(shot, points) -> NDArray[np.int64]:
    """The part that colours points [n, 3]; the last where no part's planes keep one."""
    out = np.full(len(points), max(len(shot.parts) - 1, 0))
    eye = np.array(shot.view.modelview)
    at = points @ eye[:3, :3].T + eye[:3, 3]
    for number in range(len(shot.parts) - 1, -1, -1):
        inside = np.ones(len(points), np.bool_)
        for plane in shot.parts[number][0]:
            inside &= at @ np.array(plane[:3]) + plane[3] >= 0.0
        out[inside] = number
    return out


def overlaid(picture: NDArray[np.float64], commands: Sequence[Command]) -> NDArray[np.float64]:
    """A picture RGBA [h, w, 4] with ``commands`` drawn over it by the float64 ideal. These are lines and
    letters of a figure that its scene does not hide.
    """
    height, width = picture.shape[:2]
    black, white = (
        execute_ideal((Clear(label="ground", color=(*c, c[0])), *commands), width, height).color[..., :3]
        for c in ((0.0,) * 3, (1.0,) * 3)
    )
    free = np.clip(white - black, 0.0, 1.0)
    out = picture.copy()
    out[..., :3] = picture[..., :3] * free + black
    return out
