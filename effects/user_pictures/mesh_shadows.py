"""A user's mesh on a floor, under a lamp, with its shadow by an algorithm of document 000 or 003.

Each algorithm is the passes of its own module: ``shadow_maps`` (Z10), ``alpha_coded_shadows`` (H36 to H38),
``shadow_volumes`` (Z23, Z24).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.effects.acceptance.agreement import Agreement, compare, lit_mask, truth_of
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import look_at, rotation
from fixedpipe.effects.geometry.vectors import cross, dot, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, perspective_view
from fixedpipe.effects.passes.arguments import one_of
from fixedpipe.effects.scenes.objects_and_lamps import (
    FLOOR_HALF_WIDTH,
    Lamp,
    Object,
    Scene,
    lamp_around,
)
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
# distance of the camera, 6.1 units, whose planes are then 2.2 and 9.9 units away.
_FLATTEST = 0.001
# How far away a lamp may be, world units. Inferred: a frustum has hundredths of degrees
# (``lamp_around``), and at this distance the scene fills a tenth of one.
_FARTHEST = 3000.0
# Polygon offset's factor. Measured: at 1.1 the still life keeps specks, at 2 none or one (F003-10).
_OFFSET_FACTOR = 2.0
# Distance of a map's shadow that may be missing: measured, what the offset hides (F003-10).
_OFFSET_HIDES = 0.05
_BITS = 8
# Squares of the floor in a unit of the world; lights are computed at their corners.
_CELLS = 20 / (2.0 * FLOOR_HALF_WIDTH)
# How far the widest floor reaches. Assumed: on a wider one the mesh is small, and a map's texels are large.
_WIDEST = 4.0 * FLOOR_HALF_WIDTH
# The direction to the eye: from the front, from above.
TOWARD = (0.6, 3.48, 7.6)
_FIELD_OF_VIEW = 31.0
# How much of the picture's and of the floor's half width the mesh and its shadow take at most.
_FILLS = 0.92
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

    A mesh that is wound inside out, so that it encloses a negative volume, is turned outside out. Raises
    ValueError for a mesh so flat that it would lie in the floor, where depths cannot tell which is above.
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
    """Raises ValueError, with the first open edge, if shadow volumes are requested for an open surface."""
    if ALGORITHMS[algorithm].volumes:
        try:
            shadow_volumes.closed_surface(surface, name)
        except ValueError as error:
            maps = ", ".join(key for key, way in ALGORITHMS.items() if way.map)
            raise ValueError(f"{error} Or give an algorithm with a map: {maps}.") from error


@dataclass(frozen=True, eq=False)
class Stage:
    """A mesh on its floor under a lamp, and its viewer.

    ``scene``, ``lamp``: as in ``shadow_maps``. ``eye`` looks at ``center``; the whole scene lies within
    ``radius`` of it. ``whole``: whether the whole shadow is on the floor and in the picture.
    """

    scene: Scene
    lamp: Lamp
    eye: tuple[float, float, float]
    center: tuple[float, float, float]
    radius: float
    whole: bool

    def view(self, size):
        """The View, a square of ``size`` pixels."""
        return perspective_view(
            Panel(0, 0, size, size), self.eye, self.center, _FIELD_OF_VIEW, radius=self.radius
        )


def stage(surface, position, name="mesh", toward=TOWARD):
    """The Stage of a surface that ``stood_on_floor`` placed.

    position  where the lamp is
    toward    direction to the eye, which is so far away that the mesh and its shadow are in the picture

    The floor is so large that the shadow is on it, up to 10.4 units from the middle. Rays light a mesh on
    both sides, and so do the machines, because the front of a sheet, or of a part that is inside out, is
    unknown. Raises ValueError for a lamp that lights nothing, or is too far for a frustum, and for an eye
    that is not above the floor, or straight above.
    """
    _check_lamp(position)
    toward = unit_vector(toward, "The direction to the eye")
    if not 0.0 < toward[1] < 1.0 - 1e-6:
        raise ValueError("The direction to the eye is straight up, or not above the floor; give another.")
    shadow = _shadow_on_floor(surface.positions, position)
    shown = surface.positions if shadow is None else np.concatenate([surface.positions, shadow])
    eye, center = _camera(shown, toward)
    body = Object(name, surface, MESH_COLOR, 0.4, closed=is_closed(surface), two_sided=True)
    least = FLOOR_HALF_WIDTH * np.array([[-1.0, 0.0, -1.0], [1.0, 0.0, 1.0]])
    held = least if shadow is None else shadow
    wide = [least, held / _FILLS, _lower_corners(eye, center) / _FILLS]
    # In the map is what throws the shadow; the lamp encloses the floor below it alone, so texels are small.
    lamp = lamp_around(Scene((_ground(held), body)), position)
    ground = _ground(np.concatenate(wide))
    depths = -(dot(ground.surface.positions, lamp.modelview[2][:3]) + lamp.modelview[2][3])
    if depths.min() > 0.0:
        # A place beyond the far plane would have no depth in a map.
        lamp = replace(lamp, far=max(lamp.far, _rounded_up(float(depths.max()))))
    else:  # a map has nothing to say of what is behind the lamp
        ground = _ground(held)
    scene = Scene((replace(ground, throws=False), body))
    corners = np.concatenate([scene.objects[0].surface.positions, scene.corners()])
    radius = _rounded_up(float(np.sqrt(((corners - center) ** 2).sum(axis=1)).max()))
    return Stage(scene, lamp, eye, center, radius, whole=shadow is not None)


def _ground(places):
    """The floor below places [n, 3], no wider than the widest."""
    low, high = (
        [_rounded_up(float(c)) for c in end]
        for end in np.clip([places.min(axis=0), places.max(axis=0)], -_WIDEST, _WIDEST)
    )
    across, along = (high[axis] - low[axis] for axis in (0, 2))
    cells = (math.ceil(across * _CELLS), math.ceil(along * _CELLS))
    square = surfaces.plane(*cells, across / 2.0, along / 2.0).rotated(rotation("x", -90.0))
    middle = ((low[0] + high[0]) / 2.0, 0.0, (low[2] + high[2]) / 2.0)
    return Object("floor", square.moved(*middle), FLOOR_COLOR, closed=False)


def _check_lamp(position):
    if not position[1] > 0.0:
        raise ValueError(f"The lamp at {tuple(position)} is not above the floor, y = 0; give a y above it.")
    if max(map(abs, position)) > _FARTHEST:
        raise ValueError(
            f"The lamp at {tuple(position)} is farther than {_FARTHEST:g} units; give a nearer place in the "
            "same direction, from where rays are as good as parallel."
        )


def _rounded_up(length):
    """To a hundredth of a unit, so that it has the same bits everywhere."""
    return math.ceil(100.0 * length) / 100.0


def _shadow_on_floor(positions, lamp):
    """Where rays from the lamp through positions [n, 3] meet the floor, [n, 3]; None where one does not, or
    not on the widest floor.
    """
    below = lamp[1] - positions[:, 1:2]
    if float(below.min()) <= 0.0:
        return None
    found = positions + (positions - lamp) * (positions[:, 1:2] / below)
    return found if float(np.abs(found).max()) <= _FILLS * _WIDEST else None


def _camera(points, toward):
    """(eye, what it looks at): the middle of points [n, 3], from where they all are in the picture."""
    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    center = tuple(round(float(c), 2) for c in middle)
    right, up = np.array(look_at(tuple(middle + toward), tuple(middle)))[:2, :3]
    away = points - center
    across = np.maximum(np.abs(dot(away, right)), np.abs(dot(away, up)))
    distance = float((dot(away, toward) + across / (_FILLS * _half_tangent())).max())
    return tuple(_rounded_up(float(c)) for c in np.array(center) + toward * distance), center


def _half_tangent():
    return math.tan(math.radians(_FIELD_OF_VIEW) / 2.0)


def _lower_corners(eye, center):
    """Where the picture's two lower corners are on the floor, [2, 3]."""
    right, up, back = np.array(look_at(eye, center))[:3, :3]
    rays = _half_tangent() * (np.array([[-1.0], [1.0]]) * right - up) - back
    return np.array(eye) - rays * (eye[1] / rays[:, 1:2])


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
    needs    the features that a machine needs, in words
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


def commands(algorithm, stage, profile, size, *, edge, background, shading=SceneShading.LIT):
    """The frame: a square of ``size`` pixels. ``algorithm``: a key of ALGORITHMS; ``edge``: its map's, in
    texels. Shadow volumes need a closed surface (``check_closed``).
    """
    way = ALGORITHMS[one_of(tuple(ALGORITHMS), algorithm, "The algorithm")]
    return way.draw(stage.scene, stage.view(size), stage.lamp, profile, edge, background, shading)


def hidden_distance(algorithm, lamp):
    """How near, in world units, what throws a shadow may be for the algorithm to miss it: its bias."""
    way = ALGORITHMS[algorithm]
    if way.steps:
        return way.steps / (2.0**_BITS - 1.0) * (lamp.far - lamp.near)
    return _OFFSET_HIDES if way.map else 0.0


def can_draw(algorithm, profile):
    """Whether a machine can draw the algorithm's passes: they are validated for a small picture of a box."""
    box, size = stage(stood_on_floor(surfaces.box()), (-3.0, 6.0, 4.0)), 16
    try:
        frame = commands(algorithm, box, profile, size, edge=size, background=(0.0, 0.0, 0.0))
        validate(frame, profile, size, size)
    except ValueError:
        return False
    return True


def machines_with(algorithm):
    """Keys in ``fixedpipe.pipeline.profiles.PROFILES`` of the machines that can draw it."""
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


def drawn(algorithm, stage, profile, size, edge, threads=None):
    """The picture, and its mask compared with rays: ``Drawn``. ``edge``: of the map, in texels."""
    scene, lamp, view = stage.scene, stage.lamp, stage.view(size)
    picture, masked = (
        drawing.drawn(
            commands(algorithm, stage, profile, size, edge=edge, background=BACKGROUND, shading=shading),
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
