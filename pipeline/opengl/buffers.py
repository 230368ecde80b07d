"""Buffer objects (ARB_vertex_buffer_object, ARB_pixel_buffer_object): memory that OpenGL holds.

A program writes into a mapped buffer without a call of OpenGL. apitrace records this as calls of memcpy,
which this module also carries out.
"""

from collections.abc import Iterable
from functools import singledispatch
from itertools import count
from typing import Any

import numpy as np

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.entry_points import ENTRY_POINTS, EntryPoint, entry
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused

# OpenGL has no limits. These keep a damaged trace from using all memory; no card of the time held more.
MAX_BUFFER_SIZE = 1 << 28
_MAX_NAMES = 1 << 20

_TARGETS = (
    tokens.ARRAY_BUFFER,
    tokens.ELEMENT_ARRAY_BUFFER,
    tokens.PIXEL_PACK_BUFFER_ARB,
    tokens.PIXEL_UNPACK_BUFFER_ARB,
)
_USAGES = {
    *(tokens.STREAM_DRAW, tokens.STREAM_READ, tokens.STREAM_COPY),
    *(tokens.STATIC_DRAW, tokens.STATIC_READ, tokens.STATIC_COPY),
    *(tokens.DYNAMIC_DRAW, tokens.DYNAMIC_READ, tokens.DYNAMIC_COPY),
}
_ACCESSES = {tokens.READ_ONLY, tokens.WRITE_ONLY, tokens.READ_WRITE}
_MAP_READ, _MAP_WRITE = 1, 2  # MapBufferRange's bits

_versions = count(1)


class Buffer:
    """A buffer object.

    - ``data``: uint8 [size].
    - ``version``: a number for these contents; no other contents of any buffer have it.
    - ``usage``, ``access``, ``mapped``: the values that GetBufferParameter returns.
    - ``address``: the address of the mapped buffer in the recorded program; 0 outside traces.
    """

    __slots__ = ("_contents", "access", "address", "data", "mapped", "usage", "version")

    def __init__(self):
        self.data = np.zeros(0, np.uint8)
        self.version = next(_versions)
        self.usage = tokens.STATIC_DRAW
        self.access = tokens.READ_WRITE
        self.mapped = False
        self.address = 0
        self._contents: bytes | None = None

    def changed(self) -> None:
        """Note that the contents of ``data`` have changed."""
        self.version = next(_versions)
        self._contents = None

    def contents(self) -> bytes:
        """A copy of ``data``. Until ``data`` changes, it is always the same object."""
        if self._contents is None:
            self._contents = self.data.tobytes()
        return self._contents


class BufferBindings:
    """The buffer bound to each target, and the addresses of mapped buffers."""

    def __init__(self):
        self._bound: dict[int, Buffer | None] = dict.fromkeys(_TARGETS)
        self._names: dict[int, int] = dict.fromkeys(_TARGETS, 0)
        self.mapped: dict[int, Buffer] = {}

    def __getitem__(self, target: int) -> Buffer | None:
        return self._bound[target]

    def name(self, target: int) -> int:
        """The name of the bound buffer, or 0."""
        return self._names[target]

    def bind(self, target: int, name: int, buffer: Buffer | None) -> None:
        """Bind a buffer, or none."""
        self._bound[target], self._names[target] = buffer, name if buffer is not None else 0

    def unbind(self, buffer: Buffer) -> None:
        """Remove a deleted buffer from all targets."""
        for target, bound in self._bound.items():
            if bound is buffer:
                self.bind(target, 0, None)

    def values(self, *targets: int) -> tuple[Any, ...]:
        """The bindings of these targets, as PushClientAttrib saves them."""
        return tuple([(target, self._names[target], self._bound[target]) for target in targets])

    def restore(self, values: Iterable[tuple[int, int, Buffer | None]]) -> None:
        """Set the bindings that ``values`` returned."""
        for target, name, buffer in values:
            self.bind(target, name, buffer)


@singledispatch
def as_memory(given: Any, dtype: Any = np.uint8) -> np.ndarray | None:
    """Client memory as uint8 [n], from bytes, an array, or a list of numbers of ``dtype``.

    None for an address without contents, and for a null pointer.
    """
    return np.frombuffer(given, np.uint8)


@as_memory.register(int)
@as_memory.register(type(None))
def _no_memory(given, dtype=np.uint8):
    return None


@as_memory.register(str)
def _memory_of_text(given, dtype=np.uint8):
    return np.frombuffer(given.encode("latin-1"), np.uint8)


@as_memory.register(list)
@as_memory.register(tuple)
def _memory_of_numbers(given, dtype=np.uint8):
    return np.array(given, dtype).reshape(-1).view(np.uint8)


@as_memory.register(np.ndarray)
def _memory_of_array(given, dtype=np.uint8):
    return np.ascontiguousarray(given).reshape(-1).view(np.uint8)


def memory_at(gl, target: int, pointer: Any, dtype: Any = np.uint8) -> np.ndarray | None:
    """The memory from a call's pointer on, uint8 [n]; None if there is none.

    If a buffer is bound to ``target``, a number is an offset into it. Raises GLError if the buffer is mapped.
    """
    buffer = gl.buffers[target]
    if buffer is None or not (pointer is None or isinstance(pointer, int)):
        return as_memory(pointer, dtype)
    if buffer.mapped:
        raise GLError(tokens.INVALID_OPERATION, "a mapped buffer is read")
    offset = pointer or 0
    return buffer.data[offset:] if 0 <= offset <= len(buffer.data) else None


def _bound(gl, target):
    """The buffer bound to a target. Raises GLError."""
    if target not in _TARGETS:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)} is no target of buffers here")
    buffer = gl.buffers[target]
    if buffer is None:
        raise GLError(tokens.INVALID_OPERATION, f"no buffer is bound to {tokens.name_of(target)}")
    return buffer


@entry("GenBuffers", compiled=False)
def gen_buffers(gl, number, names=None):
    """Return unused names, or use the names of the recorded program."""
    if number < 0:
        raise GLError(tokens.INVALID_VALUE)
    if number > _MAX_NAMES:
        raise GLError(tokens.OUT_OF_MEMORY)
    if names is None:
        first = max(gl.shared.buffers, default=0) + 1
        names = list(range(first, first + number))
    for name in names:
        gl.shared.buffers.setdefault(name, None)
    return names


@entry("DeleteBuffers", compiled=False)
def delete_buffers(gl, number, names):
    """Delete buffers. Arrays that use them keep the contents."""
    if number < 0:
        raise GLError(tokens.INVALID_VALUE)
    for name in (names if isinstance(names, list | tuple | np.ndarray) else (names,))[:number]:
        buffer = gl.shared.buffers.pop(int(name), None)
        if buffer is not None:
            gl.buffers.unbind(buffer)
            gl.buffers.mapped.pop(buffer.address, None)


@entry("IsBuffer", compiled=False)
def is_buffer(gl, name):
    """Whether a name belongs to a buffer that was bound at least once."""
    return gl.shared.buffers.get(name) is not None


@entry("BindBuffer", compiled=False)
def bind_buffer(gl, target, name):
    """Bind a buffer. The first call with its name creates it."""
    if target not in _TARGETS:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)} is no target of buffers here")
    if name and gl.shared.buffers.get(name) is None:
        gl.shared.buffers[name] = Buffer()
    gl.buffers.bind(target, name, gl.shared.buffers[name] if name else None)


@entry("BufferData", compiled=False)
def buffer_data(gl, target, size, data, usage):
    """Set a buffer's size and contents. If the contents are equal to the old ones, its version stays."""
    buffer = _bound(gl, target)
    if usage not in _USAGES:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(usage)} is no usage")
    if size < 0:
        raise GLError(tokens.INVALID_VALUE)
    if size > MAX_BUFFER_SIZE:
        raise GLError(tokens.OUT_OF_MEMORY, f"a buffer has at most {MAX_BUFFER_SIZE} bytes here")
    _unmap(gl, buffer)
    buffer.usage, buffer.access = usage, tokens.READ_WRITE
    given = as_memory(data, np.float32)
    if (
        given is not None
        and len(given) >= size == len(buffer.data)
        and np.array_equal(given[:size], buffer.data)
    ):
        return
    buffer.data = np.zeros(size, np.uint8)
    if given is not None:
        buffer.data[: len(given)] = given[:size]
    buffer.changed()


@entry("BufferSubData", compiled=False)
def buffer_sub_data(gl, target, offset, size, data):
    """Replace a part of a buffer's contents."""
    buffer = _part(gl, target, offset, size)
    given = as_memory(data, np.float32)
    if given is None:
        raise Refused("the data were not recorded")
    _write(buffer, offset, given[:size])


@entry("GetBufferSubData", compiled=False)
def get_buffer_sub_data(gl, target, offset, size, data=None):
    """A part of a buffer's contents, as bytes. If ``data`` is a writable array, it is filled, too."""
    part = _part(gl, target, offset, size).data[offset : offset + size]
    if isinstance(data, np.ndarray) and data.flags.writeable:
        data.reshape(-1).view(np.uint8)[:size] = part
    return part.tobytes()


def _part(gl, target, offset, size):
    """The bound buffer. Raises GLError if it does not have this part, or is mapped."""
    buffer = _bound(gl, target)
    if offset < 0 or size < 0 or offset + size > len(buffer.data):
        raise GLError(tokens.INVALID_VALUE, f"the buffer has {len(buffer.data)} bytes")
    if buffer.mapped:
        raise GLError(tokens.INVALID_OPERATION, "the buffer is mapped")
    return buffer


def _write(buffer, offset, given):
    part = buffer.data[offset : offset + len(given)]
    if not np.array_equal(part, given):
        part[:] = given
        buffer.changed()


@entry("MapBuffer", compiled=False)
def map_buffer(gl, target, access):
    """Map a buffer. Returns uint8 [size] to write into, or the recorded address."""
    buffer = _bound(gl, target)
    if access not in _ACCESSES:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(access)} is no access")
    return _map(gl, buffer, access, 0, len(buffer.data))


@entry("MapBufferRange", compiled=False)
def map_buffer_range(gl, target, offset, length, access):
    """Map a part of a buffer (ARB_map_buffer_range), as ``map_buffer`` does."""
    buffer = _part(gl, target, offset, length)
    both = access & (_MAP_READ | _MAP_WRITE)
    accesses = {_MAP_READ: tokens.READ_ONLY, _MAP_WRITE: tokens.WRITE_ONLY}
    return _map(gl, buffer, accesses.get(both, tokens.READ_WRITE), offset, length)


def _map(gl, buffer, access, offset, length):
    if buffer.mapped:
        raise GLError(tokens.INVALID_OPERATION, "the buffer is mapped already")
    buffer.mapped, buffer.access = True, access
    if isinstance(gl.recorded_result, int) and gl.recorded_result:
        buffer.address = gl.recorded_result - offset
        gl.buffers.mapped[buffer.address] = buffer
        return gl.recorded_result
    part = buffer.data[offset : offset + length]
    part.setflags(write=access != tokens.READ_ONLY)
    return part


@entry("FlushMappedBufferRange", compiled=False)
def flush_mapped_buffer_range(gl, target, offset, length):
    """Note that a mapped part was written. UnmapBuffer notes the same for the whole buffer."""
    if not _bound(gl, target).mapped:
        raise GLError(tokens.INVALID_OPERATION, "the buffer is not mapped")


@entry("UnmapBuffer", compiled=False)
def unmap_buffer(gl, target):
    """End a buffer's mapping. If it was mapped for writing, its contents count as changed."""
    buffer = _bound(gl, target)
    if not buffer.mapped:
        raise GLError(tokens.INVALID_OPERATION, "the buffer is not mapped")
    # In a trace, calls of memcpy have already made the changes.
    if buffer.access != tokens.READ_ONLY and not buffer.address:
        buffer.changed()
    _unmap(gl, buffer)
    return True


def _unmap(gl, buffer):
    gl.buffers.mapped.pop(buffer.address, None)
    buffer.mapped, buffer.address = False, 0


def memcpy(gl, destination, source, size):
    """Write into a mapped buffer. apitrace records this call when the program writes there itself."""
    for address, buffer in gl.buffers.mapped.items():
        if address <= destination < address + len(buffer.data):
            given = as_memory(source)
            if given is None:
                raise Refused("the data were not recorded")
            _write(
                buffer, destination - address, given[: min(size, address + len(buffer.data) - destination)]
            )
            return
    gl.tally.add("no effect", "memcpy into memory that no buffer has")


ENTRY_POINTS["memcpy"] = EntryPoint("memcpy", memcpy, compiled=False, inside=True, capture=None)
