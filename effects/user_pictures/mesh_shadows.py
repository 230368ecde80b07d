"""A user's mesh on a floor, under a lamp, with its shadow by an algorithm of document 000 or 003.

Each algorithm is the passes of its own module: ``shadow_maps`` (Z10), ``alpha_coded_shadows`` (H36 to H38),
``shadow_volumes`` (Z23, Z24).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.effects.acceptance.agreement import Agreement, compare, lit_mask, truth_of
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import cross, dot
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, perspective_view
from fixedpipe.effects.passes.arguments import one_of
from fixedpipe.effects.scenes.objects_and_lamps import FLOOR_HALF_WIDTH, Object, Scene, floor, lamp_around
from fixedpipe.effects.shadows import alpha_coded_shadows, shadow_maps, shadow_volumes
from fixedpipe.effects.shadows.lit_scene import SceneShading, map_edge
from fixedpipe.effects.user_pictures import drawing
from fixedpipe.effects.user_pictures.drawing import Drawing
from fixedpipe.pipeline.enums import BlendEquation
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.validation.validate import validate

# Which of the mesh's axes points up.
AXES = ("x", "y", "z")
# The mesh's largest extent on the floor, world units. Assumed: it fills the camera's picture.
_EXTENT = 2.4
# The least height for a length of one. Inferred: 0.0024 units, twelve steps of 16 bits of depth at the
# distance of the camera, whose planes are 3.9 and 12.9 units away.
_FLATTEST = 0.001
# How far away a lamp may be, world units. Inferred: a frustum has hundredths of degrees
# (``lamp_around``), and at this distance the scene fills a tenth of one.
_FARTHEST = 3000.0
# Polygon offset's factor. Measured: at 1.1 the still life keeps specks, at 2 none or one (F003-10).
_OFFSET_FACTOR = 2.0
# Distance of a map's shadow that may be missing: measured, what the offset hides (F003-10).
_OFFSET_HIDES = 0.05
_BITS = 8
_CELLS = 20
FLOOR_COLOR, MESH_COLOR = (0.62, 0.60, 0.56), (0.74, 0.40, 0.20)
MAP = "shadow map"


def _upright(surface, up):
    """The surface with the axis ``up`` turned to y; handedness is kept."""
    turn = (AXES.index(one_of(AXES, up, "The axis that points up")) - 1) % 3
    if not turn:
        return surface
    names = ("positions", "normals", "tangents", "binormals")
    return replace(surface, **{name: np.roll(getattr(surface, name), -turn, axis=1) for name in names})


def stood_on_floor(surface, up="y"):
    """The surface in the middle of the floor y = 0, its axis ``up`` upward, its largest extent 2.4 units.

    What is wound inside out, so that it encloses a negative volume, is turned outside out. Raises ValueError
    for a mesh so flat that it would lie in the floor, where depths cannot tell which is above.
    """
    surface = _upright(surface, up)
    low, high = surface.positions.min(axis=0), surface.positions.max(axis=0)
    extents = high - low
    if extents[1] < _FLATTEST * extents.max():
        raise ValueError(
            f"The mesh is {extents[1]:g} high along {up} and {extents.max():g} long, and would lie in the "
            "floor; give another axis as --up."
        )
    foot = np.array([0.5 * (low[0] + high[0]), low[1], 0.5 * (low[2] + high[2])])
    positions = (surface.positions - foot) * (_EXTENT / (high - low).max())
    a, b, c = positions[surface.triangles].transpose(1, 0, 2)
    placed = replace(surface, positions=positions)
    if float(dot(a, cross(b, c)).sum()) < 0.0 and is_closed(placed):
        return replace(placed, normals=-placed.normals, triangles=placed.triangles[:, ::-1])
    return placed


def is_closed(surface):
    """Whether the surface bounds a volume, as shadow volumes need it."""
    try:
        shadow_volumes.closed_surface(surface)
    except ValueError:
        return False
    return True


def check_closed(algorithm, surface, name):
    """Raises ValueError, with the first open edge, where shadow volumes are asked of an open surface."""
    if ALGORITHMS[algorithm].volumes:
        try:
            shadow_volumes.closed_surface(surface, name)
        except ValueError as error:
            maps = ", ".join(key for key, way in ALGORITHMS.items() if way.map)
            raise ValueError(f"{error} Or give an algorithm with a map: {maps}.") from error


def scene_of(surface, name="mesh"):
    """A Scene of the surface, placed by ``stood_on_floor``, and the floor. Rays light a mesh on both sides,
    and so do the machines: nobody knows which side of a sheet, or of a part that is inside out, is meant.
    """
    return Scene(
        (
            Object("floor", floor(FLOOR_HALF_WIDTH, _CELLS), FLOOR_COLOR, closed=False),
            Object(name, surface, MESH_COLOR, 0.4, closed=is_closed(surface), two_sided=True),
        )
    )


def lamp_at(scene, position):
    """A lamp at ``position`` whose frustum encloses the scene. Raises ValueError for a place that lights
    nothing, or is too far for a frustum.
    """
    if not position[1] > 0.0:
        raise ValueError(f"The lamp at {tuple(position)} is not above the floor, y = 0; give a y above it.")
    if max(map(abs, position)) > _FARTHEST:
        raise ValueError(
            f"The lamp at {tuple(position)} is farther than {_FARTHEST:g} units; give a nearer place in the "
            "same direction, from where rays are as good as parallel."
        )
    return lamp_around(scene, position)


def camera(panel):
    """The camera: from the front, from above."""
    return perspective_view(panel, (0.6, 4.3, 7.6), (0.0, 0.82, 0.0), field_of_view=31.0, radius=4.5)


def _depth_map(scene, view, lamp, profile, edge, background, shading):
    window = view.panel.width, view.panel.height
    return (
        *shadow_maps.store_map(scene, lamp, MAP, edge, window, factor=_OFFSET_FACTOR),
        view.panel.clear(background),
        *shadow_maps.modulated_passes(scene, view, lamp, MAP, profile, shading),
    )


def _alpha_coded(passes, scene, view, lamp, profile, edge, background, shading, **settings):
    """``passes``: one of ``alpha_coded_shadows``'s."""
    coding = alpha_coded_shadows.Coding(_BITS)
    common = {"shading": shading, **settings}
    return (
        coding.ramp(profile),
        *alpha_coded_shadows.store_map(scene, lamp, view.panel, edge, profile, coding, **common),
        *passes(scene, view, lamp, profile, coding, background=background, **common),
    )


def _multitexture(scene, view, lamp, profile, *rest):
    passes = (
        alpha_coded_shadows.with_combiners
        if profile.combiners.max_general_combiners
        else alpha_coded_shadows.with_environments
    )
    return _alpha_coded(passes, scene, view, lamp, profile, *rest)


def _single_texture(scene, view, lamp, profile, *rest):
    subtract = BlendEquation.FUNC_REVERSE_SUBTRACT in profile.fragments.blend_equations
    return _alpha_coded(
        alpha_coded_shadows.with_one_unit, scene, view, lamp, profile, *rest, subtract=subtract
    )


def _volumes(passes):
    def draw(scene, view, lamp, profile, edge, background, shading):
        return (view.panel.clear(background), *passes(scene, view, lamp, profile, shading))

    return draw


@dataclass(frozen=True)
class Algorithm:
    """One of the ways to shadows.

    title    in a few words, with the catalogue's ids
    draw     (scene, view, lamp, profile, map edge, background, shading) -> commands
    needs    what a machine must have, in words
    map      whether there is a map, with an edge in texels
    steps    how many steps of alpha the map's depths are moved away from the light; 0: PolygonOffset does it
    volumes  whether it extrudes closed surfaces
    """

    title: str
    draw: Callable
    needs: str
    map: bool = True
    steps: float = 0.0
    volumes: bool = False


_STEPS = alpha_coded_shadows.BIAS + 2.0
ALGORITHMS = {
    "depth-map": Algorithm("shadow map with a depth texture (Z10)", _depth_map, "depth textures"),
    "alpha-multitexture": Algorithm(
        "alpha-coded shadow map, two texture units (H37)",
        _multitexture,
        "two texture units whose difference it can form",
        steps=_STEPS,
    ),
    "alpha-single": Algorithm(
        "alpha-coded shadow map, one texture unit (H38)",
        _single_texture,
        "destination alpha, and pixel transfer that scales it",
        steps=_STEPS,
    ),
    "z-pass": Algorithm(
        "shadow volumes, z-pass (Z23)",
        _volumes(shadow_volumes.z_pass),
        "a stencil buffer",
        map=False,
        volumes=True,
    ),
    "z-fail": Algorithm(
        "shadow volumes, z-fail (Z24)",
        _volumes(shadow_volumes.z_fail),
        "a stencil buffer",
        map=False,
        volumes=True,
    ),
}


def commands(algorithm, scene, lamp, profile, size, *, edge, background, shading=SceneShading.LIT):
    """The frame: a square of ``size`` pixels. ``algorithm``: a key of ALGORITHMS; ``edge``: its map's, in
    texels. Shadow volumes are those of what is closed (``check_closed``).
    """
    way = ALGORITHMS[one_of(tuple(ALGORITHMS), algorithm, "The algorithm")]
    view = camera(Panel(0, 0, size, size))
    return way.draw(scene, view, lamp, profile, edge, background, shading)


def hidden_distance(algorithm, lamp):
    """How near, in world units, what throws a shadow may be for the algorithm to miss it: its bias."""
    way = ALGORITHMS[algorithm]
    if way.steps:
        return way.steps / (2.0**_BITS - 1.0) * (lamp.far - lamp.near)
    return _OFFSET_HIDES if way.map else 0.0


def can_draw(algorithm, profile):
    """Whether a machine can draw the algorithm's passes: they are validated for a small picture of a box."""
    box, size = scene_of(stood_on_floor(surfaces.box())), 16
    lamp = lamp_at(box, (-3.0, 6.0, 4.0))
    try:
        frame = commands(algorithm, box, lamp, profile, size, edge=size, background=(0.0, 0.0, 0.0))
        validate(frame, profile, size, size)
    except ValueError:
        return False
    return True


def machines_with(algorithm):
    """Keys in ``fixedpipe.pipeline.profiles.PROFILES`` of what can draw it."""
    return tuple(key for key, profile in PROFILES.items() if can_draw(algorithm, profile))


def check_machine(algorithm, key):
    """Raises ValueError, with the machines that can, where that one of PROFILES cannot draw the algorithm."""
    if not can_draw(algorithm, PROFILES[key]):
        needs, able = ALGORITHMS[algorithm].needs, ", ".join(machines_with(algorithm))
        raise ValueError(f"{key} cannot draw {algorithm}, which takes {needs}. Give one of {able}.")


def checked_map_edge(size, profile, edge=None):
    """Texels along a map's edge; None: up to four for each of a picture's ``size`` pixels. Raises ValueError
    where they are no power of two, or more than the machine's textures have.
    """
    largest = profile.textures.max_texture_size
    edge = edge or min(map_edge(size, 4), largest)
    if edge & (edge - 1) or edge > largest:
        raise ValueError(
            f"The map's edge is {edge} texels; give a power of two up to {largest}, the {profile.name}'s "
            "largest."
        )
    return edge


@dataclass(frozen=True, eq=False)
class Drawn:
    """A mesh's shadow: the picture's ``Drawing``, how its mask agrees with rays, and whether the viewer is in
    the shadow, where z-pass counts wrong.
    """

    picture: Drawing
    agreement: Agreement
    viewer_in_shadow: bool


def drawn(algorithm, scene, lamp, profile, size, edge, threads=None):
    """The picture, and its mask compared with rays: ``Drawn``. ``edge``: of the map, in texels."""
    view = camera(Panel(0, 0, size, size))
    picture, masked = (
        drawing.drawn(
            commands(
                algorithm, scene, lamp, profile, size, edge=edge, background=BACKGROUND, shading=shading
            ),
            profile,
            size,
            size,
            threads,
        )
        for shading in SceneShading
    )
    truth = truth_of(scene, view, lamp)
    mask = lit_mask(masked.color[::-1])
    understood = {"contact": hidden_distance(algorithm, lamp), "grazing": 0.1}
    if ALGORITHMS[algorithm].map:
        understood["map_edge"] = edge
    found = compare(mask, truth, **understood)
    return Drawn(picture, found, _in_shadow(truth.caster, view.eye, lamp))


def _in_shadow(caster, point, lamp):
    """Whether something is between a point and the lamp, for a RayCaster of the scene."""
    direction = np.array(lamp.position) - np.array(point)
    return bool(caster.occluded(np.array([point]), direction[None], longest=1.0)[0])
