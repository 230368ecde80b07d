"""Unpacks trace files: the data come in pieces, and the file is read once, from its beginning to its end.

    begins with    container
    "at"           chunks: a length of 4 bytes, least significant first, and as many bytes of raw Snappy
    1F 8B          gzip
    anything else  a stream of Brotli, which has no mark

Memory stays bounded for any file. A piece has at most LARGEST_CHUNK bytes, and most have 1 MB or less.

Source: apitrace's docs/FORMAT.markdown, lib/trace/trace_file_snappy.cpp and trace_file_read.cpp; the elements
of raw Snappy: google/snappy's format_description.txt.
"""

import zlib
from collections.abc import Iterator
from typing import Any, BinaryIO

SNAPPY_MARK, GZIP_MARK, ZSTANDARD_MARK = b"at", b"\x1f\x8b", b"\x28\xb5\x2f\xfd"
# Bytes of an unpacked chunk of Snappy. Source: apitrace's SNAPPY_CHUNK_SIZE. Assumed: no program writes
# chunks of more than 64 times this size.
USUAL_CHUNK, LARGEST_CHUNK = 1 << 20, 64 << 20
# The most bytes of such a chunk in the file. Source: google/snappy's MaxCompressedLength.
_LARGEST_PACKED = 32 + LARGEST_CHUNK + LARGEST_CHUNK // 6
# A piece of gzip or Brotli has at least so many bytes, and not many more.
_PIECE = 1 << 18
# So many packed bytes are unpacked at a time. If they are damaged, all of their data are lost.
_BLOCK = 512


class TraceError(ValueError):
    """A sentence that says what is wrong with a trace, and at which place in the file."""


def at_byte(place: int) -> str:
    """Words for a place in the file, as a part of a sentence."""
    return f"at byte {place:,} of the file"


def snappy_library() -> Any:
    """The module cramjam. Raises TraceError where it is not installed."""
    try:
        import cramjam
    except ImportError:
        raise TraceError(
            "A trace that is packed by Snappy needs cramjam: pip install 'fixedpipe[replay]'."
        ) from None
    return cramjam


def brotli_library() -> Any:
    """The module brotli. Raises TraceError if it is missing or older than 1.2; older ones have no limit."""
    try:
        import brotli
    except ImportError:
        brotli = None
    if not hasattr(getattr(brotli, "Decompressor", None), "can_accept_more_data"):
        raise TraceError(
            "A trace that is packed by Brotli, as all without a mark are, needs brotli 1.2 or newer: "
            "pip install 'fixedpipe[replay]'."
        )
    return brotli


class _Input:
    """A binary file that is read from its beginning to its end. ``place``: how many bytes are read so far."""

    def __init__(self, file: BinaryIO):
        self._file, self._waiting = file, b""
        self.place = 0

    def read(self, size: int) -> bytes:
        """``size`` bytes, or fewer at the end of the file. Files and pipes may give them one by one."""
        parts, missing = [], size
        while missing and (part := self._waiting[:missing] or self._file.read(missing)):
            self._waiting = self._waiting[len(part) :]
            parts.append(part)
            missing -= len(part)
        self.place += size - missing
        return b"".join(parts)

    def give_back(self, part: bytes) -> None:
        """Put back the bytes that were read last; the next ``read`` returns them again."""
        self._waiting = part + self._waiting
        self.place -= len(part)


def pieces(file: BinaryIO) -> Iterator[tuple[int, bytes]]:
    """The data of a trace file: (where it begins in the file, bytes) for each piece. No piece is empty.

    Raises TraceError for a missing library, and for cut or damaged data, after all pieces before them.
    """
    source = _Input(file)
    mark = source.read(4)
    if not mark:
        raise TraceError("The file is empty, at byte 0; a trace has a version and calls.")
    source.give_back(mark)
    if mark == ZSTANDARD_MARK:
        raise TraceError(
            "The trace is packed by Zstandard, at byte 0 of the file, which is not read here; "
            "`apitrace repack` packs it by Snappy."
        )
    if mark.startswith(SNAPPY_MARK):
        return _snappy_chunks(source)
    return _gathered(_gzip(source) if mark.startswith(GZIP_MARK) else _brotli(source))


def _gathered(parts):
    """Join small parts into pieces. An error is raised after the piece before it."""
    waiting: list[bytes] = []
    place, size, error = 0, 0, None
    while True:
        try:
            part = next(parts, None)
        except TraceError as raised:
            part, error = None, raised
        if waiting and (part is None or size >= _PIECE):
            yield place, b"".join(waiting)
            waiting, size = [], 0
        if part is None:
            break
        if not waiting:
            place = part[0]
        waiting.append(part[1])
        size += len(part[1])
    if error:
        raise error


# ------------------------------------------------------------------------------------------------- gzip


def _gzip(source):
    """The data of gzip streams that follow each other."""
    block, unpacker = b"", zlib.decompressobj(wbits=31)
    while True:
        place = source.place - len(block)
        ended = not block and not (block := source.read(_BLOCK))
        try:
            data = unpacker.decompress(block, _PIECE)
        except zlib.error as error:
            raise TraceError(f"The trace's gzip data are damaged ({error}), {at_byte(place)}.") from None
        if data:
            yield place, data
        block = unpacker.unconsumed_tail
        if unpacker.eof:
            block = unpacker.unused_data or source.read(_BLOCK)
            if not block:
                return
            if not block.startswith(GZIP_MARK[:1]):
                raise TraceError(
                    f"The trace's gzip data end before the file does, {at_byte(source.place - len(block))}."
                )
            unpacker = zlib.decompressobj(wbits=31)
        elif ended and not data:
            raise TraceError(f"The trace's gzip data are cut, {at_byte(source.place)}.")


# ------------------------------------------------------------------------------------------------- Brotli


def _brotli(source):
    brotli = brotli_library()
    unpacker = brotli.Decompressor()
    nothing = TraceError(
        "The file is no trace, at byte 0: it has no mark of Snappy or gzip, and is no stream of Brotli."
    )
    begun = False
    while not unpacker.is_finished():
        place, block, ended = source.place, b"", False
        if unpacker.can_accept_more_data():  # if not, it still has data to return
            block = source.read(_BLOCK)
            ended = not block
        try:
            data = unpacker.process(block, output_buffer_limit=_PIECE)
        except brotli.error:
            damage = TraceError(f"The trace's Brotli data are damaged, {at_byte(place)}.")
            raise damage if begun else nothing from None
        if data:
            begun = True
            yield place, data
        elif ended and not unpacker.is_finished():
            raise TraceError(f"The trace's Brotli data are cut, {at_byte(place)}.") if begun else nothing
    if source.read(1):
        raise TraceError(f"The trace's Brotli data end before the file does, {at_byte(source.place - 1)}.")


# ------------------------------------------------------------------------------------------------- Snappy


def _snappy_chunks(source):
    cramjam = snappy_library()
    source.read(len(SNAPPY_MARK))
    while True:
        place = source.place
        length = source.read(4)
        if not length:
            return
        size = int.from_bytes(length, "little")
        if len(length) < 4:
            raise TraceError(f"The trace's last chunk is cut, {at_byte(place)}.")
        if size == 0:  # for apitrace this is the end
            if source.read(1):
                raise TraceError(
                    f"A chunk of no bytes ends the trace before the file does, {at_byte(place)}."
                )
            return
        if size > _LARGEST_PACKED:
            raise TraceError(f"A chunk says that it has {size:,} bytes, {at_byte(place)}: too many.")
        packed = source.read(size)
        unpacked = _unpacked_size(packed)
        if unpacked > LARGEST_CHUNK:
            raise TraceError(
                f"A chunk unpacks to {unpacked:,} bytes, {at_byte(place)}; {LARGEST_CHUNK:,} are the most."
            )
        if len(packed) < size:
            if data := beginning_of_snappy(packed):
                yield place, data
            raise TraceError(f"The trace's last chunk is cut, {at_byte(place)}.")
        try:
            data = bytes(cramjam.snappy.decompress_raw(packed))
        except cramjam.DecompressionError:
            raise TraceError(f"A chunk's Snappy data are damaged, {at_byte(place)}.") from None
        del packed
        if data:
            yield place, data


def _unpacked_size(packed):
    """The unpacked size in bytes that a chunk states; 0 if it states no number."""
    size = 0
    for k, byte in enumerate(packed[:5]):
        size |= (byte & 0x7F) << 7 * k
        if byte < 0x80:
            return size
    return 0


def beginning_of_snappy(packed: bytes) -> bytes:
    """Unpack raw Snappy data up to the place where they are cut or wrong.

    It takes some microseconds for each element. It is called for the last chunk of a killed program.
    """
    size, at = _unpacked_size(packed), 0
    while at < len(packed) and packed[at] >= 0x80:
        at += 1
    at += 1
    data = bytearray()
    while at < len(packed) and len(data) < size:
        tag = packed[at]
        at += 1
        if tag & 3 == 0:  # literal bytes; if there are more than 60, their number follows the tag
            more = max(0, (tag >> 2) - 59)
            length = 1 + (int.from_bytes(packed[at : at + more], "little") if more else tag >> 2)
            at += more
            data += packed[at : at + length]
            at += length
            continue
        # A copy of earlier bytes; 11, 16 or 32 bits say how far back they are.
        more = (1, 2, 4)[(tag & 3) - 1]
        if at + more > len(packed):
            break
        back = int.from_bytes(packed[at : at + more], "little")
        at += more
        length = 1 + (tag >> 2)
        if tag & 3 == 1:
            back |= (tag >> 5) << 8
            length = 4 + (tag >> 2 & 7)
        if not 0 < back <= len(data):
            break
        for _ in range(length):  # the copy may overlap its source
            data.append(data[-back])
    return bytes(data[:size])
