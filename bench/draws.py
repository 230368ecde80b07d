"""Draws as real programs send them: each with a mesh and a state that the machine has not seen."""

from dataclasses import replace
from functools import cache

import numpy as np

from bench.measure import Repeated, clock_of
from bench.meshes import grid_triangles
from bench.scenes import SCENES
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import ComparisonFunction, PrimitiveType
from fixedpipe.pipeline.multi_draw import MultiDraw
from fixedpipe.pipeline.state import DepthTest, Scissor, VertexState

EDGE = 512
DRAWS = 64
TURNS = 19
# Vertices along an edge of a mesh: a hundred in all, and 162 triangles.
_ALONG = 10
_TRIANGLES = grid_triangles(_ALONG - 1, _ALONG - 1)
# All fragments of a Draw but those of this pixel are left out by the scissor test.
_BOX = Scissor(EDGE // 2, EDGE // 2, 1, 1)


def mesh(number):
    """A square of 10 x 10 vertices over the whole screen, bent, its colours and two units' coordinates; no
    two numbers give the same.
    """
    random = np.random.default_rng(number)
    across, up = np.meshgrid(np.linspace(-0.9, 0.9, _ALONG), np.linspace(-0.9, 0.9, _ALONG))
    xyz = np.stack([across, up, np.zeros_like(up)], axis=-1).reshape(-1, 3)
    xyz += random.uniform(-0.02, 0.02, xyz.shape)
    colors = np.concatenate([random.uniform(0, 1, (_ALONG**2, 3)), np.ones((_ALONG**2, 1))], axis=1)
    return Mesh(
        xyz,
        PrimitiveType.TRIANGLES,
        indices=_TRIANGLES.reshape(-1),
        colors=colors,
        texture_coordinates=((xyz[:, :2] + 1) / 2,) * 2,
    )


def state(number):
    """Scene c's two units and combiners under a depth test, with a modelview matrix and a constant colour of
    its own.
    """
    bumped = SCENES["c"].draw(EDGE).state
    shift = (number % 997) / 997 * 1e-3
    modelview = ((1.0, 0.0, 0.0, shift), (0.0, 1.0, 0.0, -shift), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    color = ((number % 251) / 251, (number // 251 % 251) / 251, 0.5, 1.0)
    return replace(
        bumped,
        vertex=VertexState(modelview, bumped.vertex.projection),
        register_combiners=replace(bumped.register_combiners, constant_color0=color),
        depth_test=DepthTest(ComparisonFunction.LEQUAL),
        scissor=_BOX,
    )


def draws(turn, *, new_mesh=True, new_state=True):
    """``DRAWS`` Draws of a turn; what is not new is the same object in all turns."""
    same_mesh, same_state = _same()
    return tuple(
        Draw(
            label="draw",
            mesh=mesh(number) if new_mesh else same_mesh,
            state=state(number) if new_state else same_state,
        )
        for number in range(turn * DRAWS, (turn + 1) * DRAWS)
    )


def together(turn):
    """The ``draws`` of a turn, all of them new, as one MultiDraw."""
    single = draws(turn)
    meshes, states = [one.mesh for one in single], [one.state for one in single]
    sizes = [len(one.positions) for one in meshes]
    begins = np.cumsum(sizes) - sizes
    units = range(len(meshes[0].texture_coordinates))
    whole = Mesh(
        np.concatenate([one.positions for one in meshes]),
        meshes[0].primitive,
        indices=np.concatenate([one.indices + begin for one, begin in zip(meshes, begins, strict=True)]),
        counts=tuple([len(one.indices) for one in meshes]),
        colors=np.concatenate([one.colors for one in meshes]),
        texture_coordinates=[
            np.concatenate([one.texture_coordinates[unit] for one in meshes]) for unit in units
        ],
    )
    return MultiDraw(
        label="draws",
        mesh=whole,
        states=states[:1],
        modelview=[one.vertex.modelview for one in states],
        constant_color0=[one.register_combiners.constant_color0 for one in states],
    )


@cache
def _same():
    return mesh(0), state(0)


def measure():
    """name -> microseconds of the processor a Draw on one thread, a list of ``TURNS`` runs of ``DRAWS``.

    The Draws are made before; each is run once. "mesh and state" are new in every Draw; "mesh" and "state"
    are new alone; "the same Draw" is one again and again. "MultiDraw" has the Draws of "mesh and state".
    """
    from fixedpipe.pipeline.execution.machine import Machine

    scene = SCENES["c"]
    machine = Machine(scene.profile, EDGE, EDGE, threads=1)
    machine.run(scene.textures())
    found = {}
    kinds = {"mesh and state": {}, "mesh": {"new_state": False}, "state": {"new_mesh": False}}
    for name, kind in kinds.items():
        runs = [Repeated(machine, draws(turn, **kind), clock_of(1)) for turn in range(TURNS + 1)]
        found[name] = [run.turn(1) for run in runs][1:]
    same = Repeated(machine, draws(0, new_mesh=False, new_state=False)[:1] * DRAWS, clock_of(1))
    found["the same Draw"] = [same.turn(1) for _ in range(TURNS + 1)][1:]
    runs = [Repeated(machine, (together(turn),), clock_of(1)) for turn in range(TURNS + 1)]
    found["MultiDraw"] = [run.turn(1) for run in runs][1:]
    return {name: [1e6 / DRAWS * each for each in seconds] for name, seconds in found.items()}
