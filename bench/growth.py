"""How a scene's cost grows: with the framebuffer, with triangles, with general combiners."""

import statistics
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from bench.measure import Ours, take_turns
from bench.meshes import torus
from bench.scenes import SCENES, Scene, bump
from fixedpipe.pipeline.profiles import GEFORCE_256

EDGES = (256, 512, 1024, 2048, 4096)
# Segments around and across: from 10³ to 10⁶ triangles.
TORI = ((25, 20), (50, 32), (100, 50), (160, 100), (250, 200), (400, 400), (1000, 500))
STAGES = range(1, 9)


@dataclass(frozen=True)
class Curve:
    """A scene drawn with one of its numbers growing.

    name, title   what grows
    points        -> (the number, the scene with it, framebuffer edge in pixels), smallest first
    """

    name: str
    title: str
    points: Callable[[], Iterator[tuple[int, Scene, int]]]


def _by_edge():
    # A GeForce 256 draws 2048 x 2048 pixels at most; this one, which computes the same, has room for more.
    scene = replace(SCENES["c"], profile=GEFORCE_256.changed(max_viewport=max(EDGES)))
    for edge in EDGES:
        yield edge, scene, edge


def _with_mesh(scene, mesh):
    return replace(scene, draw=lambda size: replace(scene.draw(size), mesh=mesh))


def _by_triangles():
    scene = SCENES["e2"]
    for around, across in TORI:
        yield 2 * around * across, _with_mesh(scene, torus(around, across)), scene.size


def _with_combiners(scene, stages):
    def draw(size):
        command = scene.draw(size)
        return replace(command, state=replace(command.state, register_combiners=bump(stages)))

    return replace(scene, draw=draw)


def _by_stages():
    scene = replace(SCENES["c"], profile=GEFORCE_256.changed(max_general_combiners=max(STAGES)))
    for stages in STAGES:
        yield stages, _with_combiners(scene, stages), scene.size


CURVES = {
    curve.name: curve
    for curve in (
        Curve("edge", "scene c, framebuffer edge in pixels", _by_edge),
        Curve("triangles", "scene e2, triangles of the torus", _by_triangles),
        Curve("stages", "scene c, general combiner stages (a machine that has 8)", _by_stages),
    )
}


@dataclass(frozen=True)
class Point:
    """``number``: what grows. ``rate``: in ``unit``, the median. ``milliseconds``: of a frame."""

    number: int
    rate: float
    unit: str
    milliseconds: float


def measure(curve, threads):
    """Yield a curve's Points, each as it is measured."""
    party = Ours(threads)
    for number, scene, size in curve.points():
        party.prepare(scene, size)
        (seconds,) = take_turns([party], turns=5, turn_seconds=0.1, warm_seconds=0.1)
        frame = statistics.median(seconds)
        yield Point(number, scene.work(size) / frame / 1e6, scene.unit, 1e3 * frame)
