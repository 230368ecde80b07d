"""A backyard: its things, the light that their bumps send back, and the sky that each place sees.

World coordinates are metres, y up. Every flat part has a height field that repeats over it.
``light_transport`` computes its light in the part's own frame, sun and sky separately. Nothing of the scene
enters a height field (section 3 of the paper: no other geometry inside its convex hull). So rays compute the
shadows of things on each other, and the sky that things hide.

Assumed: all sizes and colours; the paper shows the picture and gives no numbers of the scene.
"""

from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np

from fixedpipe.effects.acceptance.ray_caster import RayCaster
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.geometry.vectors import cross, dot, from_frame, in_frame, normalize
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import environment_light, made_fields, turning_sun, visibility
from fixedpipe.effects.scattering.height_field import height_field
from fixedpipe.effects.scenes.objects_and_lamps import Object, Scene

# Radiance towards the zenith, at the horizon and of the ground that lies about, where a white surface that
# faces the sun sends back SUN.
ZENITH, HORIZON, GROUND = (0.28, 0.44, 0.74), (0.66, 0.72, 0.78), (0.36, 0.33, 0.28)
SUN = (1.25, 1.17, 1.0)
# What hides the sky from a place is as bright as this, a guess of walls in sun and in shadow.
HIDDEN = (0.24, 0.20, 0.17)
# Rays that ask for the sky from a vertex.
_SKY_RAYS = 48
# How far things that throw shadows lie inside what is seen of them: so a volume's caps are behind surfaces.
_INSET = 0.01


@dataclass(frozen=True, eq=False)
class Part:
    """What is drawn in one piece.

    surface  in world coordinates; a flat part's texture coordinates count periods of its field
    field    the name of its height field, or "" where it is smooth and round
    color    RGB albedo, if the part is smooth
    """

    name: str
    surface: Surface
    field: str = ""
    color: tuple[float, float, float] = (1.0, 1.0, 1.0)


def sky(directions):
    """The environment's radiance along world directions [..., 3]: RGB, float64 [..., 3]."""
    up = np.asarray(directions, np.float64)[..., 1:2]
    over = np.minimum(up * 1.6, 1.0)
    above = np.array(HORIZON) * (1.0 - over) + np.array(ZENITH) * over
    return np.where(up >= 0.0, above, np.array(GROUND))


def _rectangle(corner, along, up, period, cells):
    """A flat rectangle: its corner, its two edges, the period of its field and the edge of its cells in
    metres.
    """
    corner, along, up = (np.array(v, np.float64) for v in (corner, along, up))
    width, height = (float(np.sqrt(dot(v, v))) for v in (along, up))
    columns, rows = (max(1, round(edge / cells)) for edge in (width, height))
    flat = surfaces.plane(columns, rows)
    s, t = flat.texture_coordinates.T
    tangent, binormal = along / width, up / height
    normal = cross(tangent, binormal)
    count = len(s)
    return Surface(
        positions=corner + s[:, None] * along + t[:, None] * up,
        normals=np.tile(normal, (count, 1)),
        tangents=np.tile(tangent, (count, 1)),
        binormals=np.tile(binormal, (count, 1)),
        texture_coordinates=np.stack([s * (width / period), t * (height / period)], axis=-1),
        triangles=flat.triangles,
    )


def _box(name, center, size, angle, field, period, cells):
    """The faces of an upright box that may be seen: four sides and the top. ``size``: along x, y and z."""
    turn = rotation("y", angle)
    (cx, cy, cz), (w, h, d) = center, (edge / 2.0 for edge in size)
    corners = {"front": (-w, -h, d), "right": (w, -h, d), "back": (w, -h, -d), "left": (-w, -h, -d)}
    edges = {"front": (2 * w, 0, 0), "right": (0, 0, -2 * d), "back": (-2 * w, 0, 0), "left": (0, 0, 2 * d)}
    faces = {side: (corner, edges[side], (0.0, 2.0 * h, 0.0)) for side, corner in corners.items()}
    faces["top"] = ((-w, h, d), (2 * w, 0, 0), (0, 0, -2 * d))
    return tuple(
        Part(
            f"{name}, {side}",
            _rectangle(corner, along, up, period, cells).rotated(turn).moved(cx, cy, cz),
            field,
        )
        for side, (corner, along, up) in faces.items()
    )


def _solid(name, center, size, angle=0.0, below=0.0):
    """What throws a box's shadow: the box, a little smaller, going on ``below`` its foot."""
    w, h, d = (edge - 2.0 * _INSET for edge in size)
    body = surfaces.box(w, h + below, d).rotated(rotation("y", angle))
    return Object(name, body.moved(center[0], center[1] - below / 2.0, center[2]), (1.0, 1.0, 1.0))


def _bin(segments, inset=0.0):
    """A round bin with a lid, its foot at the origin."""
    points = [(0.0, 0.0), (0.25, 0.0), (0.29, 0.62), (0.31, 0.63), (0.31, 0.67), (0.26, 0.72), (0.05, 0.76)]
    points += [(0.05, 0.79), (0.0, 0.795)]
    shape = [(max(r - inset, 0.0) if r == 0.0 else r - inset, y) for r, y in points]
    return surfaces.lathe(shape, segments)


# name: (centre, size along x, y, z, degrees about y, field, metres a period)
BOXES = {
    "house": ((0.0, 1.45, -3.15), (7.6, 2.9, 0.3), 0.0, "bricks", 0.9),
    "side wall": ((3.25, 0.6, -1.2), (0.24, 1.2, 3.6), 0.0, "bricks", 0.9),
    "coping": ((3.25, 1.23, -1.2), (0.32, 0.07, 3.6), 0.0, "slabs", 0.6),
    "door": ((-1.35, 1.06, -2.985), (0.9, 2.12, 0.06), 0.0, "planks", 0.45),
    "lintel": ((-1.35, 2.15, -2.97), (1.2, 0.18, 0.1), 0.0, "slabs", 1.2),
    "step": ((-1.35, 0.075, -2.72), (1.3, 0.15, 0.5), 0.0, "slabs", 0.65),
    "left shutter": ((0.75, 1.72, -2.985), (0.45, 0.95, 0.05), 0.0, "planks", 0.45),
    "right shutter": ((1.95, 1.72, -2.985), (0.45, 0.95, 0.05), 0.0, "planks", 0.45),
    "sill": ((1.35, 1.2, -2.96), (1.0, 0.08, 0.14), 0.0, "slabs", 1.0),
    "window's head": ((1.35, 2.24, -2.97), (1.0, 0.12, 0.1), 0.0, "slabs", 1.0),
    "fence": ((-3.3, 0.85, -0.9), (0.06, 1.7, 4.2), 0.0, "planks", 0.6),
    "crate": ((0.35, 0.3, -2.15), (0.75, 0.6, 0.6), 14.0, "planks", 0.6),
    "small crate": ((0.42, 0.775, -2.2), (0.42, 0.35, 0.42), -17.0, "planks", 0.42),
    "bed": ((-2.35, 0.17, -0.2), (0.9, 0.34, 2.0), 0.0, "bricks", 0.9),
    "kerb": ((1.05, 0.04, 0.6), (0.1, 0.08, 5.6), 0.0, "slabs", 0.8),
}
# Where the camera is, and what it looks at.
EYE, CENTER = (0.75, 1.8, 4.6), (-0.1, 0.98, -2.2)
BIN = (1.75, 0.0, -2.35)
# The window's pane, smooth as the bin and the paving are.
GLASS = (0.10, 0.13, 0.16)


@lru_cache(maxsize=4)
def parts(detail):
    """Everything that is seen: a tuple of Part. ``detail``: size of a cell in metres; the sky is evaluated at
    its corners.
    """
    out = [
        Part("floor", _rectangle((-3.6, 0.0, 3.4), (4.65, 0, 0), (0, 0, -6.4), 0.8, detail), "slabs"),
        Part("floor", _rectangle((1.05, 0.0, -2.2), (2.6, 0, 0), (0, 0, -0.8), 0.8, detail), "slabs"),
        Part("gravel", _rectangle((1.05, 0.0, 3.4), (2.6, 0, 0), (0, 0, -5.6), 0.5, detail), "gravel"),
        Part("pane", _rectangle((0.95, 1.22, -2.998), (0.8, 0, 0), (0, 0.98, 0), 1.0, detail), color=GLASS),
    ]
    for name, (center, size, angle, field, period) in BOXES.items():
        out += _box(name, center, size, angle, field, period, detail)
    soil = _rectangle((-2.68, 0.345, 0.68), (0.66, 0, 0), (0, 0, -1.76), 0.6, detail)
    segments = 16 if detail > 0.5 else 48
    out += [Part("soil", soil, "gravel"), Part("bin", _bin(segments).moved(*BIN), color=(0.30, 0.40, 0.36))]
    return tuple(part for part in out if _faces_the_eye(part.surface))


def _faces_the_eye(surface):
    return bool((dot(surface.normals, np.array(EYE) - surface.positions) > 0.0).any())


@cache
def throwing():
    """What throws shadows: a Scene of closed surfaces."""
    solids = [_solid(name, box[0], box[1], box[2], 0.1) for name, box in BOXES.items()]
    return Scene((*solids, Object("bin", _bin(24, _INSET).moved(*BIN), (1.0, 1.0, 1.0))))


@lru_cache(maxsize=4)
def _casters():
    """Rays among what throws shadows, over the floor."""
    floor = _rectangle((-40.0, 0.0, 40.0), (80.0, 0, 0), (0, 0, -80.0), 1.0, 80.0)
    ground = Object("floor", floor, (1.0, 1.0, 1.0), closed=False)
    scene = Scene((*throwing().objects, ground))
    return RayCaster(scene.triangles(), scene.object_of_triangle())


def in_sun(points, normals, light):
    """Whether the sun reaches points [n, 3], rays alone: bool [n]."""
    return ~_casters().occluded(points + 0.02 * normals, np.broadcast_to(light, points.shape))


def _around():
    found = sphere.spiral(2 * _SKY_RAYS)
    return found[found[:, 2] > 0.0]


def sky_light(surface):
    """The sky's light at each vertex over that of an unblocked vertex, by rays: RGB, float64 [n, 3]."""
    local = _around()
    normals, points = surface.normals, surface.positions + 0.02 * surface.normals
    free, seen = np.zeros((len(points), 3)), np.zeros((len(points), 3))
    for x, y, z in local.tolist():
        away = from_frame(np.array([x, y, z]), surface.tangents, surface.binormals, normals)
        light = z * sky(away)
        hidden = _casters().occluded(points, away) & (away[:, 1] > 0.0)
        free += light
        seen += np.where(hidden[:, None], z * np.array(HIDDEN), light)
    return np.minimum(seen / free, 1.0)


@lru_cache(maxsize=4)
def sky_lights(detail):
    """``sky_light`` of each of the ``parts``, a tuple."""
    return tuple(sky_light(part.surface) for part in parts(detail))


@cache
def field_of(name, edge):
    """A height field by its name, ``edge`` texels wide and high."""
    if name == "slabs":
        return slabs(edge)
    if name == "bricks":
        return made_fields.bricks(edge, edge, count=4, depth=0.022)
    if name == "planks":
        return made_fields.planks(edge, edge, depth=0.06)
    return made_fields.gravel(edge, edge, depth=1.0)


def slabs(edge):
    """Paving without bumps: its colours and joints alone, one slab a period."""
    place = (np.arange(edge) + 0.5) / edge
    s, t = np.meshgrid(place, place)
    inside = 0.5 - np.maximum(np.abs(s - 0.5), np.abs(t - 0.5))
    speckled = made_fields.gravel(edge, edge, cells=16).albedo.mean(axis=2)
    grey = np.array([0.56, 0.54, 0.50]) * (0.9 + 0.25 * (speckled - 0.3))[..., None]
    return height_field(np.zeros((edge, edge)), np.where((inside < 0.012)[..., None], 0.55 * grey, grey))


@lru_cache(maxsize=8)
def _visibility(name, edge, directions):
    return visibility.precompute(field_of(name, edge), sphere.spiral(directions))


@lru_cache(maxsize=8)
def _known(name, edge, directions):
    """What of a field no light changes."""
    return turning_sun.prepared(field_of(name, edge), _visibility(name, edge, directions))


@lru_cache(maxsize=64)
def radiance(name, edge, frame, light, directions, bounces):
    """The light of the sun and of the sky that a part's field sends back: two float64 [edge, edge, 3]. It is
    without scattering if ``bounces`` is 0, and with it otherwise.

    frame  the part's (tangent, binormal, normal) in the world, tuples; light: towards the sun
    """
    local = in_frame(np.array(light), *(np.array(axis) for axis in frame))
    by_sun = turning_sun.sunlit(_known(name, edge, directions), local, SUN, bounces)
    return by_sun, by_sky(name, edge, frame, directions, bounces)


@lru_cache(maxsize=64)
def by_sky(name, edge, frame, directions, bounces):
    """The sky's share, which no light changes."""
    field, seen = field_of(name, edge), _visibility(name, edge, directions)
    return environment_light.sky_alone(field, seen, frame, sky, bounces)


def _looked_up(table, s, t):
    """Bilinear in a table that repeats, [rows, columns, 3] at [n]: float64 [n, 3]."""
    rows, columns = table.shape[:2]
    x, y = s * columns - 0.5, t * rows - 0.5
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    f, g = (x - i)[:, None], (y - j)[:, None]
    low = table[j % rows, i % columns] * (1.0 - f) + table[j % rows, (i + 1) % columns] * f
    high = table[(j + 1) % rows, i % columns] * (1.0 - f) + table[(j + 1) % rows, (i + 1) % columns] * f
    return low * (1.0 - g) + high * g


def seen_by_rays(everything, origins, directions, light, lights, shares):
    """The colours along rays [n, 3] by the software renderer (A-G34), and whether a ray meets anything.

    everything  the parts
    lights      for each part (sun, sky) from ``radiance``; None: the part is smooth
    shares      for each part the result of ``sky_light``

    The colours are RGB, float64 [n, 3].
    """
    corners = [part.surface.positions[part.surface.triangles] for part in everything]
    counts = [len(c) for c in corners]
    caster = RayCaster(np.concatenate(corners), np.repeat(np.arange(len(everything)), counts))
    hits = caster.nearest(origins, directions)
    found, first = hits.triangle >= 0, np.cumsum([0, *counts])
    out = np.zeros((len(origins), 3))
    owner = np.where(found, caster.objects[hits.triangle], -1)
    for number, part in enumerate(everything):
        mine = np.flatnonzero(owner == number)
        if not len(mine):
            continue
        surface = part.surface
        vertices = surface.triangles[hits.triangle[mine] - first[number]]
        weights = hits.barycentrics[mine][..., None]

        def between(values, vertices=vertices, weights=weights):
            return (values[vertices] * weights).sum(axis=1)

        normals, share = normalize(between(surface.normals)), between(shares[number])
        points = origins[mine] + hits.distance[mine][:, None] * directions[mine]
        if lights[number] is None:
            facing = np.maximum(dot(normals, light), 0.0)[:, None]
            sun, above = facing * np.array(SUN) * part.color, sky(normals) * part.color
        else:
            place = between(surface.texture_coordinates)
            sun, above = (_looked_up(table, *place.T) for table in lights[number])
        out[mine] = share * above + sun * in_sun(points, normals, light)[:, None]
    return out, found


def frame_of(surface):
    """A flat surface's frame, as ``radiance`` takes it. It is rounded, and zeros have no sign, so that parts
    with one orientation share it.
    """
    axes = (surface.tangents[0], surface.binormals[0], surface.normals[0])
    return tuple(tuple(round(float(c), 9) + 0.0 for c in normalize(axis)) for axis in axes)
