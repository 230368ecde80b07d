"""The OpenGL state that a program of ARB_vertex_program may read: the rows of a binding, and their numbers.

``rows`` returns the rows of four numbers that a binding such as ``state.matrix.mvp.row[0..2]`` names.
``numbers`` returns a row's present value. Source: ARB_vertex_program, "Program Parameters".
"""

import re
from math import cos, radians, sqrt
from typing import Any

import numpy as np

from fixedpipe.pipeline.opengl.lighting import CLIP_PLANES, LIGHTS, settle_materials
from fixedpipe.pipeline.opengl.matrices import PROGRAM_MATRICES, inverse, multiplied, top
from fixedpipe.pipeline.opengl.outcomes import Refused

# A row of four numbers: its kind, then the numbers and names that identify it.
Row = tuple[Any, ...]

_COLORS = ("ambient", "diffuse", "specular")
_FACE = r"(?:\.(?P<face>front|back))?"
_COLOR = rf"\.(?P<color>{'|'.join(_COLORS)})"
_PLANES = {"s": 0, "t": 1, "r": 2, "q": 3}
# A pattern for each kind of binding that is one row.
_SINGLE = {
    "material": re.compile(rf"material{_FACE}\.(?P<name>ambient|diffuse|specular|emission|shininess)"),
    "light": re.compile(
        r"light\[(?P<number>\d+)\]\.(?P<name>ambient|diffuse|specular|position|attenuation|spot\.direction|half)"
    ),
    "model": re.compile(r"lightmodel\.ambient"),
    "scene": re.compile(rf"lightmodel{_FACE}\.scenecolor"),
    "product": re.compile(rf"lightprod\[(?P<number>\d+)\]{_FACE}{_COLOR}"),
    "texgen": re.compile(r"texgen(?:\[(?P<number>\d+)\])?\.(?P<name>eye|object)\.(?P<place>[strq])"),
    "fog color": re.compile(r"fog\.color"),
    "fog": re.compile(r"fog\.params"),
    "clip": re.compile(r"clip\[(?P<number>\d+)\]\.plane"),
    "point": re.compile(r"point\.size"),
    "attenuation": re.compile(r"point\.attenuation"),
}
_MATRIX = re.compile(
    r"matrix\.(?P<name>modelview|projection|mvp|texture|program)(?:\[(?P<number>\d+)\])?"
    r"(?:\.(?P<change>inverse|transpose|invtrans))?(?:\.row\[(?P<first>\d)(?:\.\.(?P<last>\d))?\])?"
)
_ZERO = (0.0, 0.0, 0.0, 0.0)
_MATRICES = {"texture": 4, "program": PROGRAM_MATRICES}  # how many; there is one of each other matrix
_LIMITS = {"light": LIGHTS, "product": LIGHTS, "clip": CLIP_PLANES, "texgen": 4}


def rows(binding: str) -> list[Row]:
    """The rows of a binding, given without its prefix ``state.``.

    Raises ValueError for a text that is no binding, or that names a state which is not supported here.
    """
    if found := _MATRIX.fullmatch(binding):
        return _matrix_rows(found, binding)
    for kind, pattern in _SINGLE.items():
        if found := pattern.fullmatch(binding):
            parts = found.groupdict()
            if "number" in parts:
                number = int(parts["number"] or 0)
                if number >= _LIMITS[kind]:
                    raise ValueError(f"state.{binding}: {number} is not below {_LIMITS[kind]}")
                parts["number"] = number
            return [(kind, *parts.values())]
    raise ValueError(f"state.{binding} is not read here")


def _matrix_rows(found, binding):
    name, number = found["name"], int(found["number"] or 0)
    if number >= _MATRICES.get(name, 1):
        raise ValueError(f"state.{binding}: there is no such matrix here")
    first = int(found["first"] or 0)
    last = int(found["last"]) if found["last"] else first if found["first"] else 3
    if not first <= last <= 3:
        raise ValueError(f"state.{binding}: rows {first} to {last} of 0 to 3")
    return [("matrix", name, number, found["change"], row) for row in range(first, last + 1)]


def numbers(gl: Any, row: Row) -> tuple[float, ...]:
    """The four numbers of a row. Raises Refused if a matrix has no inverse."""
    kind, *which = row
    return tuple(map(float, _READ[kind](gl, *which)))


def _material(gl, face, name):
    settle_materials(gl)
    material = gl.values[f"material {face or 'front'}"]
    return (material.shininess, 0.0, 0.0, 1.0) if name == "shininess" else getattr(material, name)


def _light(gl, number, name):
    light = gl.values[("light", number)]
    if name == "attenuation":
        constant, linear = light.constant_attenuation, light.linear_attenuation
        return constant, linear, light.quadratic_attenuation, light.spot_exponent
    if name == "spot.direction":
        return *light.spot_direction, cos(radians(light.spot_cutoff))
    if name == "half":
        return *_normalized(np.add(_normalized(light.position[:3]), (0.0, 0.0, 1.0))), 1.0
    return getattr(light, name)


def _normalized(vector):
    x, y, z = map(float, vector)
    return np.array([x, y, z]) / (sqrt((x * x + y * y) + z * z) or 1.0)


def _scene(gl, face):
    ambient, emission, diffuse = (_material(gl, face, name) for name in ("ambient", "emission", "diffuse"))
    model = gl.values["model_ambient"]
    return *(a * b + e for a, b, e in zip(ambient[:3], model[:3], emission[:3], strict=True)), diffuse[3]


def _product(gl, number, face, color):
    light, material = getattr(gl.values[("light", number)], color), _material(gl, face, color)
    return *(a * b for a, b in zip(light[:3], material[:3], strict=True)), material[3]


def _texgen(gl, number, name, place):
    held = gl.values[("texture generation", number)][_PLANES[place]]
    return held.eye_plane if name == "eye" else held.object_plane


def _fog(gl):
    start, end = gl.values["fog_start"], gl.values["fog_end"]
    with np.errstate(divide="ignore"):
        return gl.values["fog_density"], start, end, np.float64(1.0) / (end - start)


def _point(gl):
    names = ("point_size", "point_size_min", "point_size_max", "point_fade_threshold")
    return [gl.values[name] for name in names]


def _matrix(gl, name, number, change, row):
    if name == "mvp":
        matrix = multiplied(top(gl, "projection"), top(gl, "modelview"))
    else:
        matrix = top(gl, (f"{name} matrix", number) if name in _MATRICES else name)
    if change in ("inverse", "invtrans"):
        matrix = inverse(matrix)
        if matrix is None:
            raise Refused("a program reads the inverse of a matrix that has none")
    rows = np.array(matrix)
    return (rows.T if change in ("transpose", "invtrans") else rows)[row]


_READ = {
    "literal": lambda gl, *components: components,
    "env": lambda gl, number: gl.values["program parameters"][number],
    "local": lambda gl, number: gl.shared.local_parameters.get((gl.values["vertex program"], number), _ZERO),
    "material": _material,
    "light": _light,
    "model": lambda gl: gl.values["model_ambient"],
    "scene": _scene,
    "product": _product,
    "texgen": _texgen,
    "fog color": lambda gl: gl.values["fog_color"],
    "fog": _fog,
    "clip": lambda gl, number: gl.values[("clip_plane", number)],
    "point": _point,
    "attenuation": lambda gl: (*gl.values["point_attenuation"], 1.0),
    "matrix": _matrix,
}
