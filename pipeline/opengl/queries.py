"""Queries (OpenGL 1.2.1 chapter 6.1): they return the state, in the type that a program asks for.

A query accepts the answer that a trace recorded as an argument, and ignores it. It returns its own answer:
one number, or several.
"""

import math
import re
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from fixedpipe.pipeline.opengl import extensions, tokens
from fixedpipe.pipeline.opengl.arrays import ARRAYS, is_array_enabled
from fixedpipe.pipeline.opengl.capabilities import key_of
from fixedpipe.pipeline.opengl.entry_points import entry, register, resolve
from fixedpipe.pipeline.opengl.fragments import member
from fixedpipe.pipeline.opengl.lighting import (
    LIGHT_COLORS,
    LIGHT_NUMBERS,
    TRACKED,
    clip_plane_number,
    light_number,
    settle_materials,
)
from fixedpipe.pipeline.opengl.occlusion_queries import OCCLUSION_TEST_RESULT_HP, test_result
from fixedpipe.pipeline.opengl.outcomes import GLError, LeftOut, Refused
from fixedpipe.pipeline.opengl.pixels import read_bits
from fixedpipe.pipeline.opengl.state_variables import ARRAY_POINTERS, FRACTIONS, LIMITS, STATE, array_pointer

_STIPPLE_EDGE = 32


# ---------------------------------------------------------------------------------------------- conversions

_LARGEST = 2**31 - 1


class FractionAsInteger(int):
    """A fraction as an integer (table 4.7): another driver has it to the 24 bits of a GLfloat."""


def _integer(value, fraction):
    """A number as an integer (section 6.1.2, table 4.7)."""
    if isinstance(value, bool | int):
        return int(value)
    if math.isnan(value):
        return 0
    if fraction:
        value = ((2.0**32 - 1.0) * value - 1.0) / 2.0
    made = FractionAsInteger if fraction else int
    return made(min(max(math.floor(value + 0.5), -_LARGEST - 1), _LARGEST))


_CONVERSIONS: dict[str, Callable[[Any, bool], Any]] = {
    "Booleanv": lambda value, fraction: bool(value),
    "Integerv": _integer,
    "Floatv": lambda value, fraction: float(value),
    "Doublev": lambda value, fraction: float(value),
    "iv": _integer,
    "fv": lambda value, fraction: float(value),
    "dv": lambda value, fraction: float(value),
    "uiv": lambda value, fraction: _unsigned(value, 4294967295.0),
    "usv": lambda value, fraction: _unsigned(value, 65535.0),
}


def _unsigned(value, largest):
    return math.floor(value * largest + 0.5) if isinstance(value, float) else value


def _answer(value, kind, fraction=False):
    """A value, or a tuple of them, in the type of an entry point whose name ends with ``kind``."""
    convert = _CONVERSIONS[kind]
    if isinstance(value, tuple):
        return tuple([convert(each, fraction) for each in value])
    return convert(value, fraction)


# --------------------------------------------------------------------------------------------- Get, strings


def _state_variable(gl, name):
    variable = STATE.get(name) or LIMITS.get(name)
    if variable is not None:
        return variable(gl)
    if name in ARRAYS:
        return is_array_enabled(gl, name)
    if name == OCCLUSION_TEST_RESULT_HP:
        return test_result(gl)
    return gl.values[key_of(gl, name)]


def _register_get(kind):
    def get(gl, name, *_recorded):
        return _answer(_state_variable(gl, name), kind, name in FRACTIONS)

    register("Get" + kind, get, compiled=False)


for _kind in ("Booleanv", "Integerv", "Floatv", "Doublev"):
    _register_get(_kind)


@entry("GetError", compiled=False)
def get_error(gl):
    """The first error since the last call of GetError."""
    error, gl.error = gl.error, 0
    return error


_STRINGS = {
    tokens.VENDOR: lambda gl: "fixedpipe",
    tokens.RENDERER: lambda gl: gl.profile.name,
    tokens.VERSION: lambda gl: extensions.VERSION,
    tokens.EXTENSIONS: lambda gl: " ".join(extensions.extensions(gl.profile)),
}


@entry("GetString", compiled=False)
def get_string(gl, name):
    """VENDOR, RENDERER, VERSION or EXTENSIONS of the machine."""
    return member(_STRINGS, name)(gl)


@entry("GetStringi", compiled=False)
def get_string_of(gl, name, number):
    """An extension by its number (OpenGL 3.0)."""
    listed = extensions.extensions(gl.profile)
    if name != tokens.EXTENSIONS:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is no list of strings")
    if number >= len(listed) and gl.recorded_result is not None:
        return None  # a recorded program reads the list of its own driver
    if not 0 <= number < len(listed):
        raise GLError(tokens.INVALID_VALUE, f"extension {number} of {len(listed)}")
    return listed[number]


# --------------------------------------------------------------------------------- lights, materials, planes


def register_queries(stem: str, kinds: Iterable[str], find: Callable[..., tuple[Any, bool]]) -> None:
    """Register stem + each of ``kinds``. ``find(gl, *names)`` returns (value, whether it is a fraction)."""
    for kind in kinds:

        def get(gl, *arguments, kind=kind):
            value, fraction = find(gl, *arguments)
            return _answer(value, kind, fraction)

        register(stem + kind, get, compiled=False)


def _light(gl, light, name, *_recorded):
    found = gl.values[("light", light_number(light))]
    if name in LIGHT_COLORS:
        return getattr(found, LIGHT_COLORS[name]), True
    if name in (tokens.POSITION, tokens.SPOT_DIRECTION):
        return (found.position if name == tokens.POSITION else found.spot_direction), False
    return getattr(found, member(LIGHT_NUMBERS, name)), False


def _material(gl, face, name, *_recorded):
    settle_materials(gl)
    keys = {tokens.FRONT: "material front", tokens.BACK: "material back"}
    found = gl.values[member(keys, face)]
    if name == tokens.SHININESS:
        return found.shininess, False
    if name == tokens.COLOR_INDEXES:
        return (0.0, 1.0, 1.0), False
    if name == tokens.AMBIENT_AND_DIFFUSE:
        raise GLError(tokens.INVALID_ENUM, "a material has two colours of that name")
    return getattr(found, member(TRACKED, name)[0]), True


register_queries("GetLight", ("fv", "iv"), _light)
register_queries("GetMaterial", ("fv", "iv"), _material)


@entry("GetPointerv", compiled=False)
def get_pointer(gl, name, *_recorded):
    """The pointer that a program set for an array, for selection or for feedback."""
    if name in (tokens.SELECTION_BUFFER_POINTER, tokens.FEEDBACK_BUFFER_POINTER):
        selecting = name == tokens.SELECTION_BUFFER_POINTER
        buffer = gl.selection.select_buffer if selecting else gl.selection.feedback_buffer
        return None if buffer is None else buffer[1]
    return array_pointer(gl, member(ARRAY_POINTERS, name)).pointer


@entry("GetClipPlane", compiled=False)
def get_clip_plane(gl, plane, *_recorded):
    """A clip plane, in eye coordinates."""
    return gl.values[("clip_plane", clip_plane_number(plane))]


# -------------------------------------------------------------------------------------------- stipples, maps


@entry("PolygonStipple", capture=lambda gl, given: (_stipple(gl, given),))
def polygon_stipple(gl, pattern):
    """Set the pattern of stippled polygons, 32 rows of 32 bits (section 3.5.2)."""
    if isinstance(pattern, Refused):
        raise pattern
    if pattern is not None:
        gl.values.set("polygon_stipple", pattern)


def _stipple(gl, given):
    try:
        bits = read_bits(gl, _STIPPLE_EDGE, _STIPPLE_EDGE, given)
    except Refused as refusal:
        return refusal
    return None if bits is None else np.packbits(bits, axis=1).tobytes()


@entry("GetPolygonStipple", compiled=False)
def get_polygon_stipple(gl, *_recorded):
    """The stipple pattern: 32 rows of four bytes, bottom row first. Pixel store does not apply."""
    return gl.values["polygon_stipple"]


# --------------------------------------------------------------------------------------------- for --check

# Queries whose answers depend on the driver, are addresses, or are pixels; and GetError, which changes the
# error.
_OWN = (
    *("GetError", "GetString", "GetStringi", "GetPointerv", "GetPolygonStipple", "GetTexImage"),
    *("GetCompressedTexImage", "GetHistogram", "GetMinmax", "GetColorTable", "GetConvolutionFilter"),
    *("GetSeparableFilter", "GetBufferPointerv", "GetBufferSubData"),
)
# Tokens for sizes of components in texels, for GetTexLevelParameter, GetColorTableParameter and others.
_SIZES = frozenset(
    value
    for name, value in vars(tokens).items()
    if re.fullmatch(r"[A-Z_]+_(RED|GREEN|BLUE|ALPHA|LUMINANCE|INTENSITY|DEPTH)_SIZE", name)
)


def answer(gl: Any, name: str, arguments: Sequence[Any]) -> tuple[Any, ...] | None:
    """The present answer of a query ``name`` with the arguments of a trace. The state does not change.

    None if another driver's answer may differ (``LIMITS``, strings, addresses, pixels), if the query is an
    error in OpenGL, or if ``name`` is no query. For results of other calls, use ``Context.call``.
    """
    point = resolve(name)
    if point is None or not point.name.startswith(("glGet", "glIs")) or point.name[2:] in _OWN:
        return None
    if gl.begun is not None or any(isinstance(t, int) and (t in LIMITS or t in _SIZES) for t in arguments):
        return None
    try:
        given = point.handler(gl, *arguments)
    except (GLError, Refused, LeftOut, LookupError, TypeError, ValueError, OverflowError, AttributeError):
        return None
    return given if isinstance(given, tuple) else (given,)


# What OpenGL computes: two drivers that add and multiply in single precision differ by some of its last bits.
_COMPUTED = frozenset(
    value
    for name, value in vars(tokens).items()
    if name.endswith("_MATRIX")
    or name.startswith("CURRENT_RASTER_")
    or name in ("POSITION", "SPOT_DIRECTION", "EYE_PLANE")
)
_NEAR = 1e-5  # of the largest number beside it: some 80 last bits of single precision, for chains of products
_SINGLE = 2.0**-24  # of a number: what it loses at most when it is rounded to single precision


def is_computed(name: str, arguments: Sequence[Any]) -> bool:
    """Whether OpenGL computes the answer of a query: a matrix, or what a matrix transformed."""
    return name == "glGetClipPlane" or any(isinstance(t, int) and t in _COMPUTED for t in arguments)


def agrees(answered: tuple[Any, ...], recorded: Any, computed: bool = False) -> bool:
    """Whether a trace's recorded answer, a number or a list, agrees with the result of ``answer``.

    Integers are equal. What a program gave as a number, or as a fraction, has been rounded to single
    precision; what is ``computed`` may lie further away.
    """
    numbers = recorded if isinstance(recorded, list) else [recorded]
    if len(numbers) < len(answered):
        return False
    scale = max((abs(float(value)) for value in answered), default=0.0)
    near = _NEAR * max(scale, 1.0) if computed else 0.0
    return all(_near(mine, other, near) for mine, other in zip(answered, numbers, strict=False))


def _near(mine, other, near):
    if isinstance(mine, float | FractionAsInteger) or isinstance(other, float):
        return abs(float(mine) - float(other)) <= max(near, _SINGLE * abs(float(mine)))
    # GetIntegerv returns a mask of 32 bits as a signed integer.
    return int(mine) & 0xFFFFFFFF == int(other) & 0xFFFFFFFF
