"""Volumes as files: raw values, and NRRD files with their headers.

The header's number of values decides how much is read. Source: the NRRD format's definition
(teem.sourceforge.net/nrrd/format.html).
"""

import bz2
import math
import re
import warnings
import zlib
from pathlib import Path

import numpy as np

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.user_pictures.picture_files import text_values
from fixedpipe.effects.user_pictures.reading import VOXELS, check_count, whole

_WHOLE_NRRD = "Write it again, or give its values as a raw file with --dims."
_ENCODINGS = ("raw", "txt", "text", "ascii", "gz", "gzip", "bz2", "bzip2")
_RAW, *_TEXT = _ENCODINGS[:4]
# Bytes: of a header, which has some lines; that are unpacked at a time; that are skipped of what is unpacked.
_HEADER, _PIECE, _MOST_SKIPPED = 1 << 20, 1 << 20, 1 << 26
# What may follow the last value: the end of a line, as editors and writers leave it.
_MOST_BLANKS = 16


def read_raw_volume(path, dims, dtype, skip):
    """Values of a raw file, [slices, rows, columns]. ``dims``: columns, rows and slices; ``dtype``: a value's
    type; ``skip``: bytes before the first.

    Raises Refusal for dimensions that are none or not the file's, and a file that cannot be read.
    """
    try:
        counts = tuple(int(c) for c in dims.split(","))
    except ValueError:
        counts = ()
    if len(counts) != 3 or min(counts) < 2:
        raise Refusal(f"The dimensions are {dims!r}; give three whole numbers from 2, as 256,256,110.")
    check_count(f"The volume of --dims {dims}", counts, "voxels", VOXELS)
    dtype = np.dtype(dtype)
    needed = math.prod(counts) * dtype.itemsize
    try:
        size = path.stat().st_size
        if skip >= size:
            raise Refusal(f"{path} has {size} bytes, and --skip {skip} leaves none; give fewer.")
        if size - skip != needed:
            before = f" after the {skip} skipped" if skip else ""
            raise Refusal(
                f"{path} has {size - skip} bytes{before}; {dims} values of {dtype.name} are {needed}. Give "
                "other --dims, --type or --skip."
            )
        values = np.fromfile(path, dtype, math.prod(counts), offset=skip)
    except OSError as error:
        raise Refusal(f"{path} cannot be read: {error.strerror}.") from error
    return values.reshape(counts[::-1])


def read_nrrd(path):
    """Values of an NRRD file, [slices, rows, columns], and the spacing of its voxels. Raises Refusal where it
    has none.
    """
    try:
        import nrrd
    except ImportError as error:
        raise Refusal("NRRD files need the extra `volumes`: pip install 'fixedpipe[volumes]'.") from error
    with whole(path, "has damaged data, or too few of them", _WHOLE_NRRD), path.open("rb") as file:
        header, begin = _header_of(path, file, nrrd)
        values = _values(path, begin, header)
    return values, _nrrd_spacing(path, header)


def _lines_of(file):
    """The lines of an NRRD header as texts, and the header's size in bytes with the blank line after it.

    Names of fields are in small letters, because they are compared so.
    """
    lines, size = [], 0
    data = file.read(_HEADER)
    for line in data.splitlines(keepends=True):
        size += len(line)
        text = line.decode("ascii", "ignore").rstrip()
        if not text:
            break
        field, colon, value = text.partition(":")
        named = colon and not value.startswith("=") and not text.startswith("#")
        lines.append(f"{field.lower()}:{value}" if named else text)
    return lines, size


def _name_of_data(lines):
    """What an NRRD header's lines say of where the values are; None where they say nothing."""
    for line in lines:
        field, _, name = line.partition(":")
        if field.strip() in ("data file", "datafile"):
            return name.strip().removeprefix("=").strip()
    return None


def data_file_of(path):
    """The file that an NRRD header names for its values, as a path; None if they follow in the file itself,
    or if it is no NRRD file.
    """
    try:
        with path.open("rb") as file:
            name = _name_of_data(_lines_of(file)[0]) if file.read(4) == b"NRRD" else None
    except (OSError, ValueError):  # what cannot be read is said by whoever reads it
        return None
    return None if name is None else path.parent / name


def _header_of(path, file, nrrd):
    """The fields of an NRRD file, and where its header ends. Raises Refusal."""
    if file.read(4) != b"NRRD":
        raise Refusal(f"{path} does not begin with NRRD and is no NRRD file. {_WHOLE_NRRD}")
    file.seek(0)
    lines, size = _lines_of(file)
    name = _name_of_data(lines) or ""
    if re.match(r"LIST\b", name) or re.search(r"%\d*d.*\s-?\d+\s+-?\d+\s+-?\d+", name):
        raise Refusal(
            f"{path} has its values in several files ({name}), which are not read. Join them, and name the "
            "one file, or none."
        )
    with whole(path, "has a damaged NRRD header", _WHOLE_NRRD), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        header = nrrd.read_header(lines)
    for field in ("dimension", "type", "encoding", "sizes"):
        if field not in header:
            raise Refusal(f"{path} has an NRRD header without {field!r}. {_WHOLE_NRRD}")
    for field in ("type", "encoding", "endian"):
        if field in header:
            header[field] = header[field].lower()
    return header, size


def _values(path, begin, header):
    """Values of an NRRD file whose header ends at ``begin``: [slices, rows, columns], or as many axes as it
    has. Raises Refusal where its header names values that cannot be read, or a file that it may not.
    """
    from nrrd.reader import _TYPEMAP_NRRD2NUMPY as TYPES

    kind, encoding = header["type"], header["encoding"]
    if kind not in TYPES or kind == "block":
        raise Refusal(
            f"{path} holds values of type {kind!r}; give whole numbers of 8 to 64 bits, float or double."
        )
    if encoding not in _ENCODINGS:
        raise Refusal(f"{path} has the encoding {encoding!r}; there are {', '.join(_ENCODINGS)}.")
    sizes = [int(n) for n in header["sizes"]]
    if not sizes or min(sizes) < 1 or header["dimension"] != len(sizes):
        raise Refusal(
            f"{path} has the sizes {' '.join(map(str, sizes)) or 'of nothing'} and {header['dimension']} "
            "dimensions; a volume has three sizes, each at least 2."
        )
    check_count(path, sizes, "voxels", VOXELS)
    dtype = np.dtype(TYPES[kind])
    if dtype.itemsize > 1 and encoding not in _TEXT:
        if header.get("endian") not in ("little", "big"):
            raise Refusal(
                f"{path} does not say the order of its bytes; its header lacks 'endian: little' or big."
            )
        dtype = dtype.newbyteorder("<" if header["endian"] == "little" else ">")
    source = _file_of_values(path, header)
    skip = header.get("byte skip", header.get("byteskip", 0))
    lines = header.get("line skip", header.get("lineskip", 0))
    if skip < (-1 if encoding == _RAW else 0) or lines < 0:
        raise Refusal(f"{path} skips {min(skip, lines)} bytes or lines before its values, and has fewer.")
    needed = f"{'x'.join(map(str, sizes))} of type {kind} are {math.prod(sizes) * dtype.itemsize}"
    with source.open("rb") as file:
        file.seek(begin if source == path else 0)
        while lines and file.readline(_HEADER):
            lines -= 1
        if encoding in _TEXT:
            file.seek(skip, 1)
            values = text_values(file, dtype, math.prod(sizes), source)
        elif encoding == _RAW:
            values = _raw_values(source, file, skip, needed, math.prod(sizes), dtype)
        else:
            values = _unpacked_values(source, file, encoding, skip, needed, math.prod(sizes), dtype)
    return values.reshape(sizes[::-1])


def _raw_values(source, file, skip, needed, count, dtype):
    """So many values of a file, which may end with blanks. Raises Refusal where it ends otherwise."""
    size = source.stat().st_size
    begin = size - count * dtype.itemsize if skip == -1 else file.tell() + skip
    there = max(0, size - max(begin, 0))
    values = np.fromfile(source, dtype, count, offset=begin) if begin >= 0 else ()
    file.seek(begin + count * dtype.itemsize if begin >= 0 else 0)
    if len(values) < count or not _are_blanks(file.read(_MOST_BLANKS + 1)):
        raise Refusal(f"{source} has {there} bytes of values; {needed}. {_WHOLE_NRRD}")
    return values


def _unpacked_values(source, file, encoding, skip, needed, count, dtype):
    """The values of a compressed file, unpacked as far as they are needed."""
    if skip > _MOST_SKIPPED:
        raise Refusal(f"{source} skips {skip} unpacked bytes; up to {_MOST_SKIPPED} are. {_WHOLE_NRRD}")
    data, at = np.empty(count * dtype.itemsize, np.uint8), 0
    for piece in _pieces(file, encoding):
        skipped = min(skip, len(piece))
        skip -= skipped
        piece = piece[skipped:]
        kept = min(len(piece), len(data) - at)
        data[at : at + kept] = np.frombuffer(piece[:kept], np.uint8)
        at += kept
        if not _are_blanks(piece[kept:]):
            raise Refusal(f"{source} has more values than it names: {needed} bytes. {_WHOLE_NRRD}")
    if at < len(data):
        raise Refusal(f"{source} has damaged data, or too few of them: {at} bytes of values; {needed}.")
    return data.view(dtype)


def _are_blanks(data):
    return len(data) <= _MOST_BLANKS and not data.strip(b" \t\r\n\0\x1a")


def _pieces(file, encoding):
    """What gzip or bzip2 streams one after the other unpack to, a few bytes at a time; what follows them and
    is none is left out.
    """
    of_gzip = encoding.startswith("gz")
    begin = b"\x1f\x8b" if of_gzip else b"BZh"
    packed = file.read(_PIECE)
    while packed.startswith(begin):
        unpacker = zlib.decompressobj(zlib.MAX_WBITS | 16) if of_gzip else bz2.BZ2Decompressor()
        while not unpacker.eof:
            yield unpacker.decompress(packed, _PIECE)
            # zlib gives back what it has not looked at, bz2 keeps it.
            packed = unpacker.unconsumed_tail if of_gzip else b""
            if not unpacker.eof and not packed and (of_gzip or unpacker.needs_input):
                packed = file.read(_PIECE)
                if not packed:
                    return
        packed = unpacker.unused_data
        packed += file.read(_PIECE) if len(packed) < len(begin) else b""


def _file_of_values(path, header):
    """The file that holds an NRRD file's values. Raises Refusal where its header names one elsewhere: what
    comes with a volume lies in its folder, and a header from elsewhere opens no other file.
    """
    name = header.get("data file", header.get("datafile"))
    if name is None:
        return path
    folder, named = path.parent.resolve(), Path(path.parent / name)
    if not named.resolve().is_relative_to(folder):
        raise Refusal(f"{path} names {name} for its values; only files in or below its own folder are read.")
    if not named.is_file():
        raise Refusal(f"{path} names {name} for its values, and there is no such file beside it.")
    return named


def _nrrd_spacing(path, header):
    """Spacings of an NRRD header's axes, which may be negative; equal where it has none.

    What is there but is no number is given back as it is, for ``volume_of`` to refuse.
    """
    try:
        axes = header.get("space directions")
        if axes is not None:
            return tuple(np.sqrt((np.asarray(axes, float) ** 2).sum(axis=-1)).tolist())
        spacing = header.get("spacings")
        return (1.0, 1.0, 1.0) if spacing is None else tuple(abs(float(s)) for s in spacing)
    except (TypeError, ValueError) as error:
        raise Refusal(f"{path} has axes that are no three vectors; give the voxels' --spacing.") from error
