"""The client state of vertex arrays (OpenGL 1.2.1 section 2.8): their pointers, and which are enabled."""

from typing import Any

import numpy as np

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.array_memory import (
    DTYPES,
    FRACTIONS,
    TEXTURE,
    ArrayPointer,
    Kind,
    client_memory,
    name_of_kind,
)
from fixedpipe.pipeline.opengl.buffers import as_memory
from fixedpipe.pipeline.opengl.current import COORDINATE_SETS, texture_unit_number
from fixedpipe.pipeline.opengl.entry_points import entry, no_effect, register
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused

_KINDS: dict[int, Kind] = {
    tokens.VERTEX_ARRAY: "positions",
    tokens.NORMAL_ARRAY: "normals",
    tokens.COLOR_ARRAY: "colors",
    tokens.SECONDARY_COLOR_ARRAY: "secondary_colors",
    tokens.FOG_COORD_ARRAY: "fog_coordinates",
    tokens.EDGE_FLAG_ARRAY: "edge_flags",
    tokens.VERTEX_WEIGHT_ARRAY_EXT: "weights",
    tokens.INDEX_ARRAY: "color_indices",  # kept, and never read: there are no colour-index windows here
    # NV_vertex_array_range changes how memory is fetched, and not what is drawn.
    tokens.VERTEX_ARRAY_RANGE_NV: "vertex_array_range",
    tokens.VERTEX_ARRAY_RANGE_WITHOUT_FLUSH_NV: "vertex_array_range_without_flush",
}
# Vertex attributes by number: the conventional arrays (NV_vertex_program). 8 and more are coordinates.
_ATTRIBUTE_ARRAYS: dict[int, Kind] = dict(
    enumerate(("positions", "weights", "normals", "colors", "secondary_colors", "fog_coordinates"))
)
_ATTRIBUTE_ARRAYS |= {8 + unit: (TEXTURE, unit) for unit in range(COORDINATE_SETS)}
_KINDS |= {tokens.VERTEX_ATTRIB_ARRAY0_NV + number: kind for number, kind in _ATTRIBUTE_ARRAYS.items()}
# The tokens of EnableClientState. Enable takes them too (EXT_vertex_array).
ARRAYS = frozenset({*_KINDS, tokens.TEXTURE_COORD_ARRAY})

_REALS = {tokens.FLOAT, tokens.DOUBLE}
_SIGNED = {tokens.SHORT, tokens.INT, *_REALS}
# Sizes and types (table 2.4; EXT_secondary_color, EXT_fog_coord, EXT_vertex_weighting).
_ALLOWED: dict[str, tuple[tuple[int, ...], set[int]]] = {
    "positions": ((2, 3, 4), _SIGNED),
    "normals": ((3,), {tokens.BYTE, *_SIGNED}),
    "colors": ((3, 4), set(DTYPES)),
    "secondary_colors": ((3,), set(DTYPES)),
    "color_indices": ((1,), {tokens.UNSIGNED_BYTE, *_SIGNED}),
    "fog_coordinates": ((1,), _REALS),
    "edge_flags": ((1,), {tokens.UNSIGNED_BYTE}),
    "weights": ((1,), {tokens.FLOAT}),
    TEXTURE: ((1, 2, 3, 4), _SIGNED),
}


def initial_pointers() -> dict[Kind, ArrayPointer]:
    """The initial pointer of each kind of array: it has no memory (table 6.6)."""
    initial: dict[Kind, int] = {"positions": 4, "normals": 3, "colors": 4, "secondary_colors": 3}
    initial |= dict.fromkeys(("color_indices", "fog_coordinates", "edge_flags", "weights"), 1)
    initial |= {(TEXTURE, unit): 4 for unit in range(COORDINATE_SETS)}
    return {
        kind: ArrayPointer(kind, size, tokens.FLOAT, 0, None, None, 0, None) for kind, size in initial.items()
    }


class ClientArrays:
    """The client state of vertex arrays.

    - ``pointers``: the last pointer for each kind of array.
    - ``enabled``: the kinds of enabled arrays.
    - ``unit``: the coordinate set that TexCoordPointer sets (ClientActiveTexture).
    - ``locked``: (first, count) of LockArrays, or None.
    - ``bound``: the vertex array object that has these pointers and enables; 0: none.
    - ``objects``: the state of the other objects by name; None: it was never set. The bound object has an
      earlier state there.
    - ``names``: the names in use; ``of_buffers``: the names of objects whose arrays must be in buffers.
    """

    def __init__(self):
        self.pointers = initial_pointers()
        self.enabled: set[Kind] = set()
        self.unit = 0
        self.locked: tuple[int, int] | None = None
        self.bound = 0
        self.objects: dict[int, tuple[Any, ...] | None] = {0: None}
        self.names: set[int] = set()
        self.of_buffers: set[int] = set()

    def values(self) -> tuple[Any, ...]:
        """The state that PushClientAttrib saves: all but the objects that are not bound."""
        return dict(self.pointers), frozenset(self.enabled), self.unit, self.locked

    def restore(self, values: tuple[Any, ...]) -> None:
        """Set the state that ``values`` returned, in the bound object."""
        pointers, enabled, self.unit, self.locked = values
        self.pointers, self.enabled = dict(pointers), set(enabled)

    def kind_of(self, token: int) -> Kind:
        """The kind of array that a token of ``ARRAYS`` names. Raises GLError."""
        if token == tokens.TEXTURE_COORD_ARRAY:
            return TEXTURE, self.unit
        if token not in _KINDS:
            raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(token)} is no array")
        return _KINDS[token]

    def read(self) -> dict[Kind, ArrayPointer]:
        """The enabled arrays."""
        pointers = self.pointers
        return {kind: pointers[kind] for kind in self.enabled if kind in pointers}


def set_array_enabled(gl, token: int, enabled: bool) -> None:
    """Enable or disable an array by its token."""
    kind = gl.arrays.kind_of(token)
    if enabled:
        gl.arrays.enabled.add(kind)
    else:
        gl.arrays.enabled.discard(kind)


def is_array_enabled(gl, token: int) -> bool:
    """Whether an array is enabled."""
    return gl.arrays.kind_of(token) in gl.arrays.enabled


@entry("EnableClientState", compiled=False)
def enable_client_state(gl, token):
    """Enable an array."""
    set_array_enabled(gl, token, True)


@entry("DisableClientState", compiled=False)
def disable_client_state(gl, token):
    """Disable an array."""
    set_array_enabled(gl, token, False)


@entry("ClientActiveTexture", compiled=False)
def client_active_texture(gl, texture):
    """Choose the coordinate set that TexCoordPointer sets (ARB_multitexture)."""
    gl.arrays.unit = texture_unit_number(texture)


# ---------------------------------------------------------------------------------------------- pointers


def _set_pointer(gl, kind, size, type_, stride, pointer, offset=0):
    """Set the pointer of an array. ``offset``: of its first element, in bytes from ``pointer``."""
    sizes, types = _ALLOWED[name_of_kind(kind)]
    bgra = size == tokens.BGRA and kind in ("colors", "secondary_colors") and type_ == tokens.UNSIGNED_BYTE
    if size not in sizes and not bgra:
        raise GLError(tokens.INVALID_VALUE, f"{size} components a vertex")
    if type_ not in types:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(type_)} is no type of this array")
    if stride < 0:
        raise GLError(tokens.INVALID_VALUE, f"the stride is {stride}")
    of_client = not (pointer is None or isinstance(pointer, int))
    buffer = None if of_client else gl.buffers[tokens.ARRAY_BUFFER]
    if buffer is None and gl.arrays.bound in gl.arrays.of_buffers and (of_client or pointer):
        raise GLError(tokens.INVALID_OPERATION, "a vertex array object's arrays lie in buffers")
    memory = client_memory(pointer, DTYPES[type_], not stride) if of_client else None
    offset += 0 if of_client else pointer or 0
    gl.arrays.pointers[kind] = ArrayPointer(kind, size, type_, stride, pointer, memory, offset, buffer)


@entry("VertexPointer", compiled=False)
def vertex_pointer(gl, size, type_, stride, pointer):
    """Set the pointer to positions."""
    _set_pointer(gl, "positions", size, type_, stride, pointer)


@entry("NormalPointer", compiled=False)
def normal_pointer(gl, type_, stride, pointer):
    """Set the pointer to normals."""
    _set_pointer(gl, "normals", 3, type_, stride, pointer)


@entry("ColorPointer", compiled=False)
def color_pointer(gl, size, type_, stride, pointer):
    """Set the pointer to colours. The size BGRA means four bytes, blue first (EXT_vertex_array_bgra)."""
    _set_pointer(gl, "colors", size, type_, stride, pointer)


@entry("SecondaryColorPointer", compiled=False)
def secondary_color_pointer(gl, size, type_, stride, pointer):
    """Set the pointer to secondary colours (EXT_secondary_color)."""
    _set_pointer(gl, "secondary_colors", size, type_, stride, pointer)


@entry("IndexPointer", compiled=False)
def index_pointer(gl, type_, stride, pointer):
    """Set the pointer to colour indices. Nothing reads them."""
    _set_pointer(gl, "color_indices", 1, type_, stride, pointer)


@entry("FogCoordPointer", compiled=False)
def fog_coordinate_pointer(gl, type_, stride, pointer):
    """Set the pointer to fog coordinates (EXT_fog_coord)."""
    _set_pointer(gl, "fog_coordinates", 1, type_, stride, pointer)


@entry("EdgeFlagPointer", compiled=False)
def edge_flag_pointer(gl, stride, pointer):
    """Set the pointer to edge flags."""
    _set_pointer(gl, "edge_flags", 1, tokens.UNSIGNED_BYTE, stride, pointer)


@entry("TexCoordPointer", compiled=False)
def texture_coordinate_pointer(gl, size, type_, stride, pointer):
    """Set the pointer to texture coordinates of the client's active set."""
    _set_pointer(gl, (TEXTURE, gl.arrays.unit), size, type_, stride, pointer)


@entry("VertexWeightPointer", compiled=False)
def vertex_weight_pointer(gl, size, type_, stride, pointer):
    """Set the pointer to weights (EXT_vertex_weighting)."""
    _set_pointer(gl, "weights", size, type_, stride, pointer)


def _attribute_kind(number):
    """The kind of array of a vertex attribute. Raises Refused and GLError."""
    if not 0 <= number < 8 + COORDINATE_SETS:
        raise GLError(tokens.INVALID_VALUE, f"{number} is no vertex attribute")
    kind = _ATTRIBUTE_ARRAYS.get(number)
    if kind is None:
        raise Refused(f"an array of attribute {number} is not read here")
    return kind


@entry("VertexAttribPointerNV", compiled=False)
def attribute_pointer(gl, number, size, type_, stride, pointer):
    """Set the pointer to a vertex attribute: it is the conventional array of the same number."""
    kind = _attribute_kind(number)
    sizes, types = _ALLOWED[name_of_kind(kind)]
    if size not in sizes or type_ not in types:
        told = f"{size} components of {tokens.name_of(type_)}"
        raise Refused(f"attribute {number} has {told}, which its conventional array has not")
    _set_pointer(gl, kind, size, type_, stride, pointer)


@entry("VertexAttribPointer", compiled=False)
def generic_attribute_pointer(gl, number, size, type_, normalized, stride, pointer):
    """Set the pointer to a vertex attribute (ARB_vertex_program): the conventional array of the same number.

    ``normalized``: whether integers become fractions. It must agree with the conventional array.
    """
    kind = _attribute_kind(number)
    are_fractions = name_of_kind(kind) in FRACTIONS
    if type_ not in _REALS and bool(normalized) != are_fractions:
        does = "makes fractions of integers" if are_fractions else "takes integers as they are"
        raise Refused(f"attribute {number}'s conventional array {does}, and this one does not")
    attribute_pointer(gl, number, size, type_, stride, pointer)


@entry("EnableVertexAttribArray", compiled=False)
def enable_attribute_array(gl, number):
    """Enable the array of a vertex attribute."""
    gl.arrays.enabled.add(_attribute_kind(number))


@entry("DisableVertexAttribArray", compiled=False)
def disable_attribute_array(gl, number):
    """Disable the array of a vertex attribute."""
    gl.arrays.enabled.discard(_attribute_kind(number))


def _register_with_counts():
    """Register the calls of EXT_vertex_array. They also say how many elements do not change between draws."""
    kinds = ("Vertex", "Normal", "Color", "Index", "TexCoord", "EdgeFlag")
    handlers = (
        *(vertex_pointer, normal_pointer, color_pointer),
        *(index_pointer, texture_coordinate_pointer, edge_flag_pointer),
    )
    for kind, handler in zip(kinds, handlers, strict=True):

        def with_count(gl, *arguments, handler=handler):
            *layout, count, pointer = arguments
            if count < 0:
                raise GLError(tokens.INVALID_VALUE)
            handler(gl, *layout, pointer)

        register(f"{kind}PointerEXT", with_count, compiled=False)


_register_with_counts()
no_effect(*[f"Index{suffix}{v}" for suffix in ("s", "i", "f", "d", "ub") for v in ("", "v")], inside=True)


# Table 2.5: components of coordinates, colours, normals and positions; "b": colours of four bytes.
_INTERLEAVED = {
    tokens.V2F: "v2",
    tokens.V3F: "v3",
    tokens.C4UB_V2F: "b4 v2",
    tokens.C4UB_V3F: "b4 v3",
    tokens.C3F_V3F: "c3 v3",
    tokens.N3F_V3F: "n3 v3",
    tokens.C4F_N3F_V3F: "c4 n3 v3",
    tokens.T2F_V3F: "t2 v3",
    tokens.T4F_V4F: "t4 v4",
    tokens.T2F_C4UB_V3F: "t2 b4 v3",
    tokens.T2F_C3F_V3F: "t2 c3 v3",
    tokens.T2F_N3F_V3F: "t2 n3 v3",
    tokens.T2F_C4F_N3F_V3F: "t2 c4 n3 v3",
    tokens.T4F_C4F_N3F_V4F: "t4 c4 n3 v4",
}
# Arrays that InterleavedArrays disables if the format lacks them (OpenGL 1.4 names the last two).
_DISABLED = {"normals", "colors", "edge_flags", "color_indices", "secondary_colors", "fog_coordinates"}
_LETTERS = {"v": "positions", "n": "normals", "c": "colors", "b": "colors"}


@entry("InterleavedArrays", compiled=False)
def interleaved_arrays(gl, layout, stride, pointer):
    """Set and enable the arrays of one of 14 formats, and disable those that it lacks."""
    if layout not in _INTERLEAVED:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(layout)} is no format of interleaved arrays")
    if stride < 0:
        raise GLError(tokens.INVALID_VALUE, f"the stride is {stride}")
    parts = [(part[0], int(part[1])) for part in _INTERLEAVED[layout].split()]
    sizes = [4 if letter == "b" else 4 * components for letter, components in parts]
    if not (pointer is None or isinstance(pointer, int | bytes)):
        pointer = as_memory(pointer, np.float32)
    arrays, offset = gl.arrays, 0
    arrays.enabled -= {*_DISABLED, (TEXTURE, arrays.unit)}
    for (letter, components), size in zip(parts, sizes, strict=True):
        kind = (TEXTURE, arrays.unit) if letter == "t" else _LETTERS[letter]
        type_ = tokens.UNSIGNED_BYTE if letter == "b" else tokens.FLOAT
        _set_pointer(gl, kind, components, type_, stride or sum(sizes), pointer, offset)
        arrays.enabled.add(kind)
        offset += size


@entry("LockArrays", compiled=False)
def lock_arrays(gl, first, count):
    """Promise that arrays do not change (EXT_compiled_vertex_array). Draws still read them each time."""
    if gl.arrays.locked is not None:
        raise GLError(tokens.INVALID_OPERATION, "the arrays are locked already")
    if first < 0 or count <= 0:
        raise GLError(tokens.INVALID_VALUE)
    gl.arrays.locked = first, count


@entry("UnlockArrays", compiled=False)
def unlock_arrays(gl):
    """Take the promise back."""
    if gl.arrays.locked is None:
        raise GLError(tokens.INVALID_OPERATION, "the arrays are not locked")
    gl.arrays.locked = None


@entry("TestFence", compiled=False)
def test_fence(gl, name):
    """Whether what came before a fence is done (NV_fence, APPLE_fence): it is."""
    gl.tally.add("no effect", gl.called)
    return True


no_effect(
    "VertexArrayRange", "FlushVertexArrayRange", "PixelDataRange", "FlushPixelDataRange", compiled=False
)
no_effect("GenFences", "DeleteFences", "SetFence", "FinishFence", "IsFence", "GetFenceiv", compiled=False)
