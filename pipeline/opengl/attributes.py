"""PushAttrib, PopAttrib and the client's two groups (OpenGL 1.2.1 section 6.1.9, tables 6.5 to 6.19).

A group consists of the values that were declared with its bit. Two tables handle the state that is not stored
as values: current values and textures' parameters, and the client's arrays.
"""

from functools import lru_cache
from typing import Any

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.capabilities import NOTIFIED
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.lighting import settle_materials
from fixedpipe.pipeline.opengl.outcomes import GLError
from fixedpipe.pipeline.opengl.values import VALUES, declare
from fixedpipe.pipeline.opengl.vertex_array_objects import bind_object

# Both stacks hold 16 groups (table 6.24). One more is a stack overflow.
STACK_DEPTH = 16

declare("attribute stack", ())
declare("client attribute stack", ())


@lru_cache(maxsize=256)
def _keys(mask):
    """The values that belong to any group of a mask."""
    return tuple([key for key, value in VALUES.items() if value.groups & mask])


# For a server's group: functions that return, and set again, the state that is not stored as values.
_BESIDE_VALUES = {
    tokens.CURRENT_BIT: (
        lambda gl: gl.current.values(),
        lambda gl, saved: gl.current.restore(saved),
    ),
    tokens.TEXTURE_BIT: (
        lambda gl: _texturing().bound_parameters(gl),
        lambda gl, saved: _texturing().restore_parameters(gl, saved),
    ),
}
_STORES = ("pack", "unpack")
_PIXEL_BUFFERS = (tokens.PIXEL_PACK_BUFFER_ARB, tokens.PIXEL_UNPACK_BUFFER_ARB)
_ARRAY_BUFFERS = (tokens.ARRAY_BUFFER, tokens.ELEMENT_ARRAY_BUFFER)


def _restore_stores(gl, saved):
    stores, buffers = saved
    for key, store in zip(_STORES, stores, strict=True):
        gl.values.set(key, store)
    gl.buffers.restore(buffers)


def _restore_arrays(gl, saved):
    arrays, buffers, bound = saved
    if bound not in gl.arrays.objects:
        return  # the object was deleted, and is not made again
    bind_object(gl, bound)
    gl.arrays.restore(arrays)
    gl.buffers.restore(buffers)


# For a client's group. It includes the buffers that are bound for it (ARB_vertex_buffer_object).
_CLIENT_GROUPS = {
    tokens.CLIENT_PIXEL_STORE_BIT: (
        lambda gl: ([gl.values[key] for key in _STORES], gl.buffers.values(*_PIXEL_BUFFERS)),
        _restore_stores,
    ),
    tokens.CLIENT_VERTEX_ARRAY_BIT: (
        lambda gl: (gl.arrays.values(), gl.buffers.values(*_ARRAY_BUFFERS), gl.arrays.bound),
        _restore_arrays,
    ),
}


def _texturing():
    from fixedpipe.pipeline.opengl import texturing

    return texturing


def _push(gl, stack, saved):
    kept = gl.values[stack]
    if len(kept) >= STACK_DEPTH:
        raise GLError(tokens.STACK_OVERFLOW)
    gl.values.set(stack, (*kept, saved))


def _pop(gl, stack) -> Any:
    kept = gl.values[stack]
    if not kept:
        raise GLError(tokens.STACK_UNDERFLOW)
    gl.values.set(stack, kept[:-1])
    return kept[-1]


def _saved(gl, groups, mask):
    return [(restore, save(gl)) for bit, (save, restore) in groups.items() if mask & bit]


def _attributes(gl, mask):
    keys = _keys(mask & 0xFFFFFFFF)
    return keys, tuple([gl.values[key] for key in keys]), _saved(gl, _BESIDE_VALUES, mask)


def _set_attributes(gl, attributes):
    keys, saved, beside = attributes
    settle_materials(gl)  # the group of enables may end COLOR_MATERIAL, and does not contain materials
    for key, value in zip(keys, saved, strict=True):
        if key in NOTIFIED and gl.values[key] is not value:
            NOTIFIED[key](gl, value)
        gl.values.set(key, value)
    for restore, kept in beside:
        restore(gl, kept)


@entry("PushAttrib")
def push_attrib(gl, mask):
    """Save the groups of a mask."""
    _push(gl, "attribute stack", _attributes(gl, mask))


@entry("PopAttrib")
def pop_attrib(gl):
    """Restore the groups that the last PushAttrib saved."""
    _set_attributes(gl, _pop(gl, "attribute stack"))


def copy_attributes(source: Any, target: Any, mask: int) -> None:
    """Give one Context the groups of a mask that another one has, as glXCopyContext does."""
    settle_materials(source)
    _set_attributes(target, _attributes(source, mask))


@entry("PushClientAttrib", compiled=False)
def push_client_attrib(gl, mask):
    """Save the client's groups of a mask."""
    _push(gl, "client attribute stack", _saved(gl, _CLIENT_GROUPS, mask))


@entry("PopClientAttrib", compiled=False)
def pop_client_attrib(gl):
    """Restore the groups that the last PushClientAttrib saved."""
    for restore, kept in _pop(gl, "client attribute stack"):
        restore(gl, kept)
