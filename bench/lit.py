"""What lighting adds to a Draw of a hundred vertices, on a lighting unit and by OpenGL's equations."""

import statistics
from functools import cache

import numpy as np

from bench import draws
from bench.draws import EDGE
from bench.measure import Repeated, clock_of
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A
from fixedpipe.pipeline.state import Light, Lighting, Material, PassState, Scissor, VertexState

DRAWS, TURNS = 64, 19
_DIRECTIONAL = Light(position=(0.3, 0.4, 0.8, 0.0))
_LOCAL = Light(position=(0.5, -0.5, 2.0, 1.0), linear_attenuation=0.2, specular=(0.5, 0.5, 0.5, 1.0))
# The machines and their lights.
KINDS = tuple(
    (profile, lights)
    for profile in (NV2A, GEFORCE_256)
    for lights in ((_DIRECTIONAL,), (_DIRECTIONAL, _LOCAL))
)


@cache
def mesh():
    """The square of ``bench.draws`` with normals in place of coordinates."""
    square = draws.mesh(0)
    normals = np.random.default_rng(1).normal(size=(len(square.positions), 3)) * 0.3 + (0.0, 0.0, 1.0)
    return Mesh(square.positions, square.primitive, square.indices, colors=square.colors, normals=normals)


@cache
def state(lights):
    """A pixel of the square, lit with a highlight; without lights, by no lighting."""
    material = Material(specular=(1.0, 1.0, 1.0, 1.0), shininess=20.0)
    lighting = Lighting(lights, material, separate_specular_color=True) if lights else None
    vertex = VertexState(normalize=True, lighting=lighting)
    return PassState(vertex=vertex, scissor=Scissor(EDGE // 2, EDGE // 2, 1, 1))


def frame(lights):
    """``DRAWS`` Draws of one mesh in one state, each an object: a machine lights a repeated one once."""
    return tuple(Draw(label="draw", mesh=mesh(), state=state(lights)) for _ in range(DRAWS))


def measure():
    """name -> microseconds of the processor that lights add to a Draw, a list of ``TURNS``.

    A frame of lit Draws and the same without lighting in turn, on one thread, each again and again.
    """
    from fixedpipe.pipeline.execution.machine import Machine

    found = {}
    for profile, lights in KINDS:
        machine = Machine(profile, EDGE, EDGE, threads=1)
        plain, lit = (Repeated(machine, frame(given), clock_of(1)) for given in ((), lights))
        more = [1e6 / DRAWS * (lit.turn(1) - plain.turn(1)) for _ in range(TURNS + 1)][1:]
        found[f"{profile.name}, {len(lights)}"] = more
    return found


def dearest(found):
    """The name in ``measure``'s result whose median is the largest."""
    return max(found, key=lambda name: statistics.median(found[name]))
