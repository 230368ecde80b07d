"""Volumes as files: raw values, and NRRD files with their headers."""

import math
import warnings
from pathlib import Path

import numpy as np

from fixedpipe.effects.refusal import Refusal

# Values of a volume. Assumed: a host of today has memory for these and their bytes, 1024 along each edge.
MOST_VALUES = 1 << 30
_WHOLE_NRRD = "Write it again, or give its values as a raw file with --dims."
_ENCODINGS = ("raw", "txt", "text", "ascii", "gz", "gzip", "bz2", "bzip2")
_RAW, *_TEXT = _ENCODINGS[:4]


def _too_many(what, counts):
    """A Refusal of more values than are read."""
    return Refusal(
        f"{what} {'x'.join(map(str, counts))} values; up to {MOST_VALUES} (1024x1024x1024) are read, since "
        "all are held in memory. Give a part of the volume, or a coarser one."
    )


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
    if math.prod(counts) > MOST_VALUES:
        raise _too_many(f"The dimensions {dims} are", counts)
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
    try:
        with path.open("rb") as file, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if file.read(4) != b"NRRD":
                raise Refusal(f"{path} does not begin with NRRD and is no NRRD file. {_WHOLE_NRRD}")
            file.seek(0)
            header = _header_of(path, file, nrrd)
            _check_values(path, file, header)
            file.seek(0)
            values, header = nrrd.read(str(path), index_order="C")
    except Refusal:
        raise
    except OSError as error:
        raise Refusal(f"{path} cannot be read: {error.strerror or 'the data are damaged'}.") from error
    # A decoder fed arbitrary bytes raises whatever it stumbles over.
    except Exception as error:
        raise Refusal(f"{path} has damaged data, or too few of them. {_WHOLE_NRRD}") from error
    return values, _nrrd_spacing(path, header)


def data_file_of(path):
    """The file that an NRRD header names for its values, as a path; None where they follow in the file
    itself, or it is none.
    """
    try:
        for line in path.read_bytes()[: 1 << 16].split(b"\n\n")[0].splitlines():
            field, colon, name = line.decode("ascii", "ignore").partition(":")
            if colon and field.strip() in ("data file", "datafile"):
                return path.parent / name.strip().removeprefix("=").strip()
    except (OSError, ValueError):  # what cannot be read is said by whoever reads it
        pass
    return None


def _header_of(path, file, nrrd):
    """The fields of an NRRD file, which is left where the header ends. Raises Refusal."""
    try:
        header = nrrd.read_header(file)
    except Exception as error:
        raise Refusal(f"{path} has a damaged NRRD header. {_WHOLE_NRRD}") from error
    for field in ("dimension", "type", "encoding", "sizes"):
        if field not in header:
            raise Refusal(f"{path} has an NRRD header without {field!r}. {_WHOLE_NRRD}")
    return header


def _check_values(path, file, header):
    """Raises Refusal where an NRRD header names values that cannot be read, or a file that it may not."""
    from nrrd.reader import _TYPEMAP_NRRD2NUMPY as TYPES

    kind, encoding = header["type"], header["encoding"].lower()
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
    if math.prod(sizes) > MOST_VALUES:
        raise _too_many(f"{path} has", sizes)
    itemsize = np.dtype(TYPES[kind]).itemsize
    if itemsize > 1 and encoding not in _TEXT and header.get("endian") not in ("little", "big"):
        raise Refusal(
            f"{path} does not say the order of its bytes; its header lacks 'endian: little' or big."
        )
    values = _file_of_values(path, header)
    skip = header.get("byte skip", header.get("byteskip", 0))
    lines = header.get("line skip", header.get("lineskip", 0))
    if skip < -1 or lines < 0:
        raise Refusal(
            f"{path} skips {min(skip, lines)} bytes or lines before its values; that many there are not."
        )
    if encoding == _RAW and skip >= 0 and not lines:
        before = skip + (file.tell() if values == path else 0)
        there, needed = max(0, values.stat().st_size - before), math.prod(sizes) * itemsize
        if there != needed:
            raise Refusal(
                f"{values} has {there} bytes of values; {'x'.join(map(str, sizes))} of type {kind} are "
                f"{needed}. {_WHOLE_NRRD}"
            )


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
