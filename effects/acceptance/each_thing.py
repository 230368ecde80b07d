"""Whether a picture of a scene shows each thing in the lamp's light, and each thing's shadow.

A share of a whole picture's pixels says little about a thing that is small or far away. So each thing is
asked for by itself, at the pixels that it changes: a share of one is its light or its shadow as rays find it,
a share of none is a picture that leaves it out.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.acceptance import ray_caster, shadow_reference
from fixedpipe.effects.acceptance.agreement import truth_of
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.parts import LEAST_PIXELS
from fixedpipe.effects.acceptance.ray_caster import RayCaster
from fixedpipe.effects.acceptance.shadow_reference import Shot
from fixedpipe.effects.geometry.views import panel_of
from fixedpipe.effects.shadows.lit_scene import AMBIENT

# What a thing changes: its name, "light" or "shadow" and the region's number, to the pixels, and their
# colours with it and without.
Changes: TypeAlias = dict[
    tuple[str, str, int], tuple[NDArray[np.bool_], NDArray[np.float64], NDArray[np.float64]]
]


def _inner(where):
    """Pixels whose eight neighbours are among them too: bool [h, w]. Those at the panel's edge are none."""
    out = where.copy()
    out[0], out[-1], out[:, 0], out[:, -1] = False, False, False, False
    for axis in (0, 1):
        out &= np.roll(out, 1, axis) & np.roll(out, -1, axis)
    return out


def changes_of(shot: Shot, regions: Sequence[NDArray[np.bool_]] = ()) -> Changes:
    """What each thing of a Shot with one lamp changes by its light and by its shadow, by rays.

    Pixels at an edge of what changes are left out. A thing that changes fewer than three others is too.

    regions  each bool [h, w], bottom row first: a thing is asked for in each; none: in the whole picture
    """
    (lamp,) = shot.lamps
    free = shadow_reference.rays(replace(shot, shadows=False), samples=1)[::-1, :, :3]
    truth = truth_of(shot.scene, shot.view, lamp, shot.self_shadows)
    shown, out = truth.shown, {}
    # What no lamp reaches has ambient light alone.
    unlit = np.minimum(np.array([thing.color for thing in shot.scene.objects]) * AMBIENT[:3], 1.0)[
        shown.object
    ]

    def add(what, where, whole, without):
        for number, region in enumerate(regions or (np.ones_like(where),)):
            inner = _inner(where & region)
            if inner.sum() >= LEAST_PIXELS:
                out[(*what, number)] = inner, whole[inner], without[inner]

    triangles, owner = shot.scene.triangles(), shot.scene.object_of_triangle()
    directions, longest = ray_caster.to_light(shown.points.reshape(-1, 3), lamp)
    faces = (shown.normals.reshape(-1, 3) * directions).sum(axis=-1).reshape(truth.lit.shape) > 0.0
    dark = shown.something & faces & ~truth.lit
    for number, thing in enumerate(shot.scene.objects):
        add((thing.name, "light"), truth.lit & (shown.object == number), free, unlit)
        kept = owner != number
        if not thing.throws or not kept.any():
            continue
        renumbered = np.where(kept, np.cumsum(kept) - 1, -1)
        still = RayCaster(triangles[kept]).occluded(
            shown.points[dark],
            directions.reshape(*dark.shape, 3)[dark],
            longest=longest,
            triangles=renumbered[shown.triangle[dark]],
        )
        its = np.zeros(dark.shape, np.bool_)
        its[dark] = ~still
        add((thing.name, "shadow"), its, unlit, free)
    return out


def shares(shown: NDArray[np.float64], changes: Changes) -> dict[tuple[str, str, int], float]:
    """Of each of ``changes_of`` how much a panel's picture [h, w, 3], bottom row first, shows."""
    shown = np.clip(shown, 0.0, 1.0)
    return {of: least_share(shown[where], whole, without) for of, (where, whole, without) in changes.items()}


def checks(data: Any, figure: Any, renderer: Any, panels: Mapping[int, Changes]) -> Iterator[Check]:
    """The Checks of a figure's ``data`` that displayed panels show each thing's light and each shadow.

    ``panels``: by a panel's number its ``changes_of``.
    """
    for on in (Answer.MACHINE, Answer.IDEAL):
        window = renderer.window(on, figure, figure.size)
        least = min(
            share
            for number, changes in panels.items()
            for share in shares(panel_of(window, number), changes).values()
        )
        yield data.check("of what a thing's light or shadow changes, the least share that is seen", least, on)
