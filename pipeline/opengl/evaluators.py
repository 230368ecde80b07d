"""Evaluators: polynomials that make vertices (OpenGL 1.2.1 section 5.1).

Assumed: they are computed in float64, as sums of control points times Bernstein polynomials. Drivers used
float32, and Horner's rule or forward differences. The results here were not compared with a driver's.
"""

from functools import cache
from math import comb
from typing import Any

import numpy as np

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.capabilities import capability
from fixedpipe.pipeline.opengl.current import columns_read, filled, finish_primitive, vertex
from fixedpipe.pipeline.opengl.entry_points import entry, register
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.values import declare

# Source: OpenGL 1.2.1 section 5.1: at least 8. Inferred: Mesa and NVIDIA's drivers had more.
MAX_EVAL_ORDER = 30
# A mesh of more points is refused, because it would take gigabytes.
_MAX_POINTS = 1 << 20


class Map:
    """A map of one or two dimensions. Two Maps are never equal.

    - ``domain``: (u1, u2) or (u1, u2, v1, v2).
    - ``points``: float64 [order, k] or [u order, v order, k].
    """

    def __init__(self, domain: tuple[float, ...], points: np.ndarray):
        self.domain = domain
        self.points = points
        points.setflags(write=False)


# For each dimension: the map's token, its number of components, and its column. The last of a column wins.
_NAMES = ("COLOR_4", "INDEX", "NORMAL", *[f"TEXTURE_COORD_{n}" for n in (1, 2, 3, 4)], "VERTEX_3", "VERTEX_4")
_SIZES = (4, 1, 3, 1, 2, 3, 4, 3, 4)
_COLUMNS = ("colors", "", "normals", *["texture_coordinates"] * 4, "positions", "positions")
_INITIAL = {"colors": (1.0, 1.0, 1.0, 1.0), "": (1.0,), "normals": (0.0, 0.0, 1.0)}
# {token: (dimensions, components, column)}
MAPS = {
    getattr(tokens, f"MAP{dimensions}_{name}"): (dimensions, size, column)
    for dimensions in (1, 2)
    for name, size, column in zip(_NAMES, _SIZES, _COLUMNS, strict=True)
}


def _declare():
    for token, (dimensions, size, column) in MAPS.items():
        capability(token, tokens.EVAL_BIT)
        point = np.array(_INITIAL.get(column, (0.0, 0.0, 0.0, 1.0)))[:size]
        declare(("map", token), Map((0.0, 1.0) * dimensions, point.reshape((1,) * dimensions + (size,))))
    capability(tokens.AUTO_NORMAL, tokens.EVAL_BIT)
    declare("map_grid1", (1, 0.0, 1.0), tokens.EVAL_BIT)
    declare("map_grid2", (1, 0.0, 1.0, 1, 0.0, 1.0), tokens.EVAL_BIT)


_declare()


# --------------------------------------------------------------------------------------------------- maps


def _map_of(gl, target, dimensions):
    found = MAPS.get(target)
    if found is None or found[0] != dimensions:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)} is no map of {dimensions} dimensions")
    if gl.values["active_texture"]:  # Source: section F.2.13
        raise GLError(tokens.INVALID_OPERATION, "the active texture unit is not 0")
    return found


def _check(domain, stride, size, order):
    if domain[0] == domain[1]:
        raise GLError(tokens.INVALID_VALUE, "the domain of a map is empty")
    if stride < size or not 1 <= order <= MAX_EVAL_ORDER:
        raise GLError(tokens.INVALID_VALUE, f"order {order} and stride {stride} of points of {size} numbers")


def _numbers(points, count):
    """The numbers of control points, float64 [count]. They are read when the call is made."""
    if points is None or isinstance(points, int):
        raise Refused("its control points were not recorded")
    numbers = np.asarray(points, np.float64).reshape(-1)
    if len(numbers) < count:
        raise Refused(f"it has {len(numbers)} numbers, where {count} are read")
    return np.ascontiguousarray(numbers[:count])


def _capture_map1(gl, target, u1, u2, stride, order, points):
    _, size, _ = _map_of(gl, target, 1)
    domain = float(u1), float(u2)
    _check(domain, stride, size, order)
    numbers = _numbers(points, stride * (order - 1) + size)
    blocks = np.ndarray((order, size), np.float64, numbers, 0, (8 * stride, 8))
    return target, Map(domain, blocks.copy())


@entry("Map1f", "Map1d", capture=_capture_map1)
def map1(gl, target, made):
    """Define a map of one dimension."""
    gl.values.set(("map", target), made)


def _capture_map2(gl, target, u1, u2, u_stride, u_order, v1, v2, v_stride, v_order, points):
    _, size, _ = _map_of(gl, target, 2)
    domain = float(u1), float(u2), float(v1), float(v2)
    _check(domain[:2], u_stride, size, u_order)
    _check(domain[2:], v_stride, size, v_order)
    numbers = _numbers(points, u_stride * (u_order - 1) + v_stride * (v_order - 1) + size)
    strides = 8 * u_stride, 8 * v_stride, 8
    blocks = np.ndarray((u_order, v_order, size), np.float64, numbers, 0, strides)
    return target, Map(domain, blocks.copy())


@entry("Map2f", "Map2d", capture=_capture_map2)
def map2(gl, target, made):
    """Define a map of two dimensions."""
    gl.values.set(("map", target), made)


@entry("MapGrid1f", "MapGrid1d")
def map_grid1(gl, count, u1, u2):
    """Define the grid of EvalMesh1 and EvalPoint1."""
    if count <= 0:
        raise GLError(tokens.INVALID_VALUE)
    gl.values.set("map_grid1", (int(count), float(u1), float(u2)))


@entry("MapGrid2f", "MapGrid2d")
def map_grid2(gl, u_count, u1, u2, v_count, v1, v2):
    """Define the grid of EvalMesh2 and EvalPoint2."""
    if u_count <= 0 or v_count <= 0:
        raise GLError(tokens.INVALID_VALUE)
    gl.values.set("map_grid2", (int(u_count), float(u1), float(u2), int(v_count), float(v1), float(v2)))


# --------------------------------------------------------------------------------------------- polynomials


@cache
def _binomials(degree):
    return [float(comb(degree, i)) for i in range(degree + 1)]


def bernstein(degree: int, t: np.ndarray) -> np.ndarray:
    """The Bernstein polynomials of a degree at places ``t``, float64 [degree + 1, n]; 0^0 is 1.

    It uses only sums and products, in a fixed order, so every computer gives the same bits.
    """
    weights = np.ones((degree + 1, len(t)))
    rising, falling = np.ones(len(t)), np.ones(len(t))
    for i, binomial in enumerate(_binomials(degree)):
        weights[i] *= rising * binomial
        weights[degree - i] *= falling
        rising, falling = rising * t, falling * (1.0 - t)
    return weights


def bernstein_slopes(degree: int, t: np.ndarray) -> np.ndarray:
    """The derivatives of the Bernstein polynomials at places ``t``, float64 [degree + 1, n]."""
    slopes = np.zeros((degree + 1, len(t)))
    if degree:
        lower = degree * bernstein(degree - 1, t)
        slopes[1:] += lower
        slopes[:-1] -= lower
    return slopes


def _within(places, low, high):
    return (np.asarray(places, np.float64) - low) / (high - low)


@np.errstate(all="ignore")  # draws with infinities and NaN are left out later
def _evaluated1(gl, u) -> dict[str, np.ndarray]:
    """The columns that the enabled maps make at places ``u``."""
    columns = {}
    for token, found in _enabled(gl, 1):
        points = found.points
        columns[MAPS[token][2]] = _sum(bernstein(len(points) - 1, _within(u, *found.domain)), points)
    return columns


@np.errstate(all="ignore")
def _evaluated2(gl, u, v) -> dict[str, np.ndarray]:
    """The columns that the enabled maps make at all pairs of places ``u`` and ``v``; u varies faster."""
    columns = {}
    normals = None
    for token, found in _enabled(gl, 2):
        column = MAPS[token][2]
        by_u, by_v = _weights(bernstein, found, u, v)
        columns[column] = _sum_of_both(by_u, by_v, found.points)
        if column == "positions" and gl.values[("enabled", tokens.AUTO_NORMAL)]:
            normals = _normals(found, columns[column], u, v, by_u, by_v)
    if normals is not None:
        columns["normals"] = normals
    return columns


def _weights(polynomials, found, u, v):
    u1, u2, v1, v2 = found.domain
    orders = found.points.shape
    return polynomials(orders[0] - 1, _within(u, u1, u2)), polynomials(orders[1] - 1, _within(v, v1, v2))


def _sum(weights, points):
    """The sum of points [order, ...] times weights [order, n]: [n, ...]. Unlike a matrix product, it adds in
    order.
    """
    shape = (-1,) + (1,) * (points.ndim - 1)
    total = weights[0].reshape(shape) * points[0]
    for weight, point in zip(weights[1:], points[1:], strict=True):
        total = total + weight.reshape(shape) * point
    return total


def _sum_of_both(by_u, by_v, points):
    along_u = _sum(by_u, points)  # [u, order of v, k]
    both = _sum(by_v, along_u.swapaxes(0, 1))  # [v, u, k]
    return both.reshape(-1, both.shape[2])


def _normals(found, positions, u, v, by_u, by_v):
    """Unit normals of a surface. If the two tangents are parallel, the normal is zero."""
    slopes_u, slopes_v = _weights(bernstein_slopes, found, u, v)
    u1, u2, v1, v2 = found.domain
    along_u = _sum_of_both(slopes_u, by_v, found.points) / (u2 - u1)
    along_v = _sum_of_both(by_u, slopes_v, found.points) / (v2 - v1)
    if positions.shape[1] == 4:
        # The quotient rule for (x, y, z)/w, times w^2, which does not change the direction.
        w = positions[:, 3:]
        along_u, along_v = [s[:, :3] * w - positions[:, :3] * s[:, 3:] for s in (along_u, along_v)]
    normal = np.cross(along_u, along_v)
    x, y, z = normal.T
    length = np.sqrt((x * x + y * y) + z * z)[:, None]
    return np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)


def _enabled(gl, dimensions):
    """The maps in effect: for each column, the one with most components. None without a map of vertices."""
    chosen: dict[str, tuple[int, Map]] = {}
    for token, (of, _, column) in MAPS.items():
        if of == dimensions and column and gl.values[("enabled", token)]:
            chosen[column] = token, gl.values[("map", token)]
    return list(chosen.values()) if "positions" in chosen else []


# ----------------------------------------------------------------------------------------------- vertices


def _give_vertex(gl, columns: dict[str, np.ndarray]):
    """Add a vertex with evaluated values. These do not become current values."""
    if "positions" not in columns or gl.begun is None:
        return
    now = gl.current
    before = now.values()
    if "colors" in columns:
        now.color = tuple(columns["colors"][0].tolist())
    if "normals" in columns:
        now.normal = tuple(columns["normals"][0].tolist())
    if "texture_coordinates" in columns:
        first = filled(columns["texture_coordinates"][0].tolist())
        now.texture_coordinates = (first, *now.texture_coordinates[1:])
    vertex(gl, columns["positions"][0].tolist())
    now.restore(before)


def _register_eval_coordinates():
    def one(gl, u):
        _give_vertex(gl, _evaluated1(gl, [u[0] if isinstance(u, list | tuple | np.ndarray) else u]))

    def two(gl, u, v):
        _give_vertex(gl, _evaluated2(gl, [u], [v]))

    def two_of_vector(gl, both):
        two(gl, both[0], both[1])

    for suffix in ("f", "d", "fv", "dv"):
        register(f"EvalCoord1{suffix}", one, inside=True)
        register(f"EvalCoord2{suffix}", two_of_vector if suffix.endswith("v") else two, inside=True)


_register_eval_coordinates()


@np.errstate(all="ignore")
def _grid(places, count, low, high):
    """Places of a grid by their numbers. Numbers 0 and ``count`` give exactly the ends of the grid."""
    places = np.asarray(places)
    at = places * ((high - low) / count) + low
    return np.where(places == count, high, np.where(places == 0, low, at))


@entry("EvalPoint1", inside=True)
def eval_point1(gl, i):
    """Do what EvalCoord1 does, at a place of the grid."""
    _give_vertex(gl, _evaluated1(gl, _grid([i], *gl.values["map_grid1"])))


@entry("EvalPoint2", inside=True)
def eval_point2(gl, i, j):
    """Do what EvalCoord2 does, at a place of the grid."""
    grid = gl.values["map_grid2"]
    _give_vertex(gl, _evaluated2(gl, _grid([i], *grid[:3]), _grid([j], *grid[3:])))


def _numbers_between(first, last):
    if last - first >= _MAX_POINTS:
        raise Refused(f"it has {last - first + 1} points in a row; at most {_MAX_POINTS} are drawn here")
    return np.arange(first, last + 1)


@entry("EvalMesh1")
def eval_mesh1(gl, mode, first, last):
    """Draw a part of the grid as points or as a line."""
    primitives = {tokens.POINT: tokens.POINTS, tokens.LINE: tokens.LINE_STRIP}
    if mode not in primitives:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(mode)} is no mode of this mesh")
    places = _numbers_between(first, last)
    columns = _evaluated1(gl, _grid(places, *gl.values["map_grid1"]))
    _draw(gl, primitives[mode], columns, len(places), None)


@entry("EvalMesh2")
def eval_mesh2(gl, mode, u_first, u_last, v_first, v_last):
    """Draw a part of the grid: as points, as lines along both directions, or as strips of quads."""
    if mode not in (tokens.POINT, tokens.LINE, tokens.FILL):
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(mode)} is no mode of this mesh")
    i, j = _numbers_between(u_first, u_last), _numbers_between(v_first, v_last)
    across, up = len(i), len(j)
    if across * up > _MAX_POINTS:
        raise Refused(f"it has {across * up} points; at most {_MAX_POINTS} are drawn here")
    grid = gl.values["map_grid2"]
    u, v = _grid(i, *grid[:3]), _grid(j, *grid[3:])
    columns = _evaluated2(gl, u, v)
    vertices = np.arange(across * up).reshape(up, across)
    if mode == tokens.POINT:
        _draw(gl, tokens.POINTS, columns, across * up, None)
    elif mode == tokens.LINE:
        _draw(gl, tokens.LINE_STRIP, columns, across * up, vertices)
        _draw(gl, tokens.LINE_STRIP, columns, across * up, vertices.T)
    elif up > 1:
        strips = np.stack([vertices[:-1], vertices[1:]], axis=2).reshape(up - 1, 2 * across)
        _draw(gl, tokens.QUAD_STRIP, columns, across * up, strips)


def _draw(gl, mode, columns: dict[str, np.ndarray], count, strips):
    """Draw evaluated vertices, or strips of them. Attributes without a map have their current values.

    ``strips``: vertex numbers, int [strips, length]; None: draw the vertices in order.
    """
    least = {tokens.POINTS: 1, tokens.LINE_STRIP: 2, tokens.QUAD_STRIP: 4}[mode]
    if "positions" not in columns or (strips is not None and (strips.shape[1] < least or not len(strips))):
        return
    needs, now = columns_read(gl), gl.current

    def column(name, current):
        return columns[name] if name in columns else np.broadcast_to(current, (count, *np.shape(current)))

    drawn: dict[str, Any] = {"positions": columns["positions"], "colors": column("colors", now.color)}
    if "normals" in needs:
        drawn["normals"] = column("normals", now.normal)
    sets = [
        column("", coordinates) for coordinates in now.texture_coordinates[: needs["texture_coordinates"]]
    ]
    if sets and "texture_coordinates" in columns:
        sets[0] = columns["texture_coordinates"]
    drawn["texture_coordinates"] = tuple(sets)
    for name, current in (
        ("secondary_colors", now.secondary_color),
        ("fog_coordinates", now.fog_coordinate),
        ("weights", now.weight),
    ):
        if name in needs:
            drawn[name] = column(name, current)
    if "edge_flags" in needs and not now.edge_flag:
        drawn["edge_flags"] = column("edge_flags", False)
    if strips is None:
        finish_primitive(gl, mode, drawn)
    else:
        finish_primitive(gl, mode, drawn, strips.reshape(-1), (strips.shape[1],) * len(strips))
