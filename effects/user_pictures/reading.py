"""Parts of all readers of a user's files: how much is read, the sentence of a refusal, and the line of a
result.
"""

import errno
import logging
import math
import os
from contextlib import contextmanager, suppress
from contextvars import ContextVar

import numpy as np

from fixedpipe.effects.refusal import Refusal

# Of a picture; a height field of so many takes some 900 MB while it is fitted to a map.  Measured.
PIXELS = 40_000_000
# Of a volume: 512 x 512 x 512, which are 1.1 GB where they are of 64 bits.
VOXELS = 135_000_000
# Of a BRDF's lights and views, each of three numbers: a grid of 64, where `fixedpipe brdf --grid` ends.
SAMPLES = 17_000_000

_own_limit: ContextVar[int | None] = ContextVar("own_limit", default=None)
_fills: ContextVar[bool] = ContextVar("fills", default=False)
_LOG = logging.getLogger("fixedpipe.reading")


@contextmanager
def limit(count):
    """Inside, files are read up to so many pixels, voxels or samples; None: PIXELS, VOXELS and SAMPLES."""
    before = _own_limit.set(count)
    try:
        yield
    finally:
        _own_limit.reset(before)


@contextmanager
def filling():
    """Inside, missing values of a picture's file are filled (``without_missing``), not refused."""
    before = _fills.set(True)
    try:
        yield
    finally:
        _fills.reset(before)


def without_missing(name, values, missing, called):
    """(values, notes) of a file, [rows, columns(, components)], with missing values filled while ``filling``.

    ``missing``: which are missing, bool of their shape. They become means of the known values in squares of
    2, 4, 8 ... pixels, the smallest that have any, interpolated between the squares' middles. ``called``: the
    text of a missing value. Raises Refusal if some are missing without ``filling``, or all are.
    """
    lacking = int(missing.sum())
    if not lacking:
        return values, ()
    if not _fills.get():
        raise Refusal(
            f"{name} has {lacking} value{'s' * (lacking > 1)} of {called}, which stand for what was not "
            "measured; fill them before. bump, brdf, scatter and roughness do so with --fill."
        )
    if lacking == missing.size:
        raise Refusal(f"{name} has no value but {called}, so there is none to fill with. Give another file.")
    sums, counts = [np.where(missing, 0.0, values)], [(~missing).astype(np.float64)]
    while not counts[-1].all():
        sums.append(_by_squares(sums[-1]))
        counts.append(_by_squares(counts[-1]))
    means = sums.pop() / counts.pop()
    while sums:
        rows, columns = sums[-1].shape[:2]
        wider = _between(_between(means, 0)[:rows], 1)[:, :columns]
        total, known = sums.pop(), counts.pop()
        means = np.divide(total, known, out=wider, where=known > 0.0)
    found = means if values.dtype.kind == "f" else np.rint(means)
    filled = np.where(missing, found, values).astype(values.dtype)
    return filled, (f"{lacking} of {missing.size} values filled by the mean of those around",)


def _by_squares(values):
    """Sums over squares of two by two, [rows, columns, ...]; zero beyond the edges."""
    rows, columns = values.shape[:2]
    whole = np.zeros((rows + rows % 2, columns + columns % 2, *values.shape[2:]))
    whole[:rows, :columns] = values
    return (whole[::2, ::2] + whole[1::2, ::2]) + (whole[::2, 1::2] + whole[1::2, 1::2])


def _between(means, axis):
    """Twice as many along an axis, a quarter and three quarters of the way between neighbours; float64."""
    means = np.moveaxis(means, axis, 0)
    out = np.empty((2 * len(means), *means.shape[1:]))
    out[::2] = 0.75 * means + 0.25 * np.concatenate([means[:1], means[:-1]])
    out[1::2] = 0.75 * means + 0.25 * np.concatenate([means[1:], means[-1:]])
    return np.moveaxis(out, 0, axis)


def check_count(name, counts, what, usual):
    """Raises Refusal where a file names more values than are read, before any of them is.

    counts  along each axis
    what    they are: pixels, voxels or samples
    usual   how many are read without a ``limit``
    """
    count, most = math.prod(counts), _own_limit.get() or usual
    if count > most:
        raise Refusal(
            f"{name} has {' x '.join(map(str, counts))} {what}, {_millions(count)} million; up to "
            f"{_millions(most)} million are read. Give fewer, or more memory with --limit "
            f"{-(-count // 1_000_000)}."
        )


def _millions(count):
    return f"{count / 1e6:.10g}"


@contextmanager
def whole(name, what, cure):
    """Any exception of a reader of arbitrary bytes becomes a Refusal: the file, its fault, the reason, what
    to do.

    what  "is a damaged NPZ file", as what follows the file's name; ``cure``: a sentence
    """
    try:
        yield
    except Refusal:
        raise
    except MemoryError as error:
        raise Refusal(f"{name} needs more memory than there is. Give a smaller one.") from error
    except OSError as error:
        # The system's; decoders raise OSError too, with words of their own, and seek to where no file is.
        if error.errno not in (None, errno.EINVAL):
            raise Refusal(f"{name} cannot be read: {error.strerror}.") from error
        raise Refusal(f"{name} {what}. {cure}") from error
    except Exception as error:
        raise Refusal(f"{name} {what}. {cure}") from error


@contextmanager
def silent():
    """What libraries in C write to the error stream is nowhere: a Refusal says it."""
    kept = None
    with suppress(OSError):  # no such stream
        kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 2)
        os.close(nowhere)
    try:
        yield
    finally:
        if kept is not None:
            os.dup2(kept, 2)
            os.close(kept)


def understood(name, picture, notes=()):
    """Log a line about how a picture's file was read: columns x rows, type, least and greatest value.

    picture  [rows, columns] or [rows, columns, components]
    notes    what else was made of it
    """
    if picture.ndim < 2 or not picture.size or not _LOG.isEnabledFor(logging.INFO):
        return
    rows, columns = picture.shape[:2]
    components = f" of {picture.shape[2]} components" if picture.ndim > 2 and picture.shape[2] > 1 else ""
    shown = picture[..., : 3 if picture.shape[2] > 2 else 1] if picture.ndim > 2 else picture  # without alpha
    said = f"{picture.dtype.name}, {_short(shown.min())} to {_short(shown.max())}"
    _LOG.info(", ".join((f"{name}: {columns} x {rows}{components}", said, *notes)))


def _short(number):
    return f"{number:.7g}" if isinstance(number, np.floating) else str(int(number))
