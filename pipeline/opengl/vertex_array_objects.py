"""Vertex array objects (ARB_vertex_array_object, APPLE_vertex_array_object): arrays' state by name.

An object has the pointers, which arrays are enabled, and the buffer of indices. The context has the array
buffer that the next pointer takes, the client's active unit and locks. Object 0 is the state without objects.
Contexts do not share objects.

No machine's driver of 1997 to 2001 listed ARB's extension. Programs of that time are recorded through
libraries that use it. It is client state alone, so every machine draws what it draws.
"""

from typing import Any

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.arrays import initial_pointers
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.outcomes import GLError
from fixedpipe.pipeline.opengl.parameters import numbers_of

# A damaged trace may ask for any number of names.
_MOST_NAMES = 1 << 16
_NO_INDICES = ((tokens.ELEMENT_ARRAY_BUFFER, 0, None),)


def bind_object(gl: Any, name: int) -> None:
    """Exchange the arrays' state for that of the object ``name``, which comes into being here."""
    arrays = gl.arrays
    if name == arrays.bound:
        return
    arrays.objects[arrays.bound] = (
        arrays.pointers,
        arrays.enabled,
        gl.buffers.values(tokens.ELEMENT_ARRAY_BUFFER),
    )
    held = arrays.objects.get(name)
    arrays.pointers, arrays.enabled, indices = held or (initial_pointers(), set(), _NO_INDICES)
    gl.buffers.restore(indices)
    arrays.bound = name
    arrays.objects.setdefault(name, None)


@entry("GenVertexArrays", compiled=False)
def gen_vertex_arrays(gl, number, names=None):
    """Give unused names, or take those of the recorded program."""
    if number < 0:
        raise GLError(tokens.INVALID_VALUE, f"{number} vertex array objects")
    if number > _MOST_NAMES:
        raise GLError(tokens.OUT_OF_MEMORY, f"{number} names of vertex array objects")
    if names is None:
        first = max(gl.arrays.names, default=0) + 1
        names = list(range(first, first + number))
    gl.arrays.names.update(map(int, numbers_of(names)[:number]))
    return names


def _bind(gl, name, of_client):
    bind_object(gl, int(name))
    if name:
        gl.arrays.names.add(int(name))
        (gl.arrays.of_buffers.discard if of_client else gl.arrays.of_buffers.add)(int(name))


@entry("BindVertexArray", compiled=False)
def bind_vertex_array(gl, name):
    """Bind an object by a name that GenVertexArrays gave; 0: none. Its arrays lie in buffers."""
    if name and name not in gl.arrays.names:
        raise GLError(tokens.INVALID_OPERATION, f"GenVertexArrays gave no name {name}")
    _bind(gl, name, False)


@entry("BindVertexArrayAPPLE", compiled=False)
def bind_vertex_array_of_client(gl, name):
    """Apple's takes any name, and its arrays may lie in client memory."""
    _bind(gl, name, True)


@entry("DeleteVertexArrays", compiled=False)
def delete_vertex_arrays(gl, number, names):
    """Delete objects; where one is bound, none is then."""
    if number < 0:
        raise GLError(tokens.INVALID_VALUE, f"{number} vertex array objects")
    arrays = gl.arrays
    for name in map(int, numbers_of(names)[:number]):
        if not name:
            continue
        if name == arrays.bound:
            bind_object(gl, 0)
        arrays.names.discard(name)
        arrays.of_buffers.discard(name)
        arrays.objects.pop(name, None)


@entry("IsVertexArray", compiled=False)
def is_vertex_array(gl, name):
    """Whether a name is that of an object that was bound once."""
    return bool(name) and name in gl.arrays.objects
