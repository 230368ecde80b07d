"""A BRDF in the binary form of the MERL database, which renderers read: isotropic, by half angles.

A file has three int32, 90, 90 and 180. For each of red, green and blue, 90 x 90 x 180 float64 follow,
little-endian. The axes are the half vector's angle from the normal, in steps that are finer at the highlight,
the difference's angle, and the difference's azimuth from 0 to 180 degrees. A number times 1/1500, 1.15/1500
or 1.66/1500 is f_r of red, green or blue per steradian. It is -1 if light or view would lie below the
horizon.

Source: Matusik, Pfister, Brand, McMillan 2003; the database's reader (sizes, scales, the square root of the
half vector's angle). Inferred: each number is f_r in the middle of its cell.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.geometry.vectors import cosine, sine

HALF, DIFFERENCE, AZIMUTH = 90, 90, 180
SCALES = (1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0)
# What stands where light or view is below the horizon.
BELOW = -1.0
BYTES = 3 * 4 + 3 * 8 * HALF * DIFFERENCE * AZIMUTH
# Angles differ in their last bit between processors; rounded to a multiple of this they do not.
_ANGLE_STEP = 2.0**-20


def directions():
    """Lights and views in the middle of the table's cells: two float64 [90 * 90 * 180, 3]; some lie below the
    horizon.
    """
    step = (np.arange(HALF) + 0.5) / HALF
    half = 0.5 * math.pi * step * step
    difference = 0.5 * math.pi * (np.arange(DIFFERENCE) + 0.5) / DIFFERENCE
    azimuth = math.pi * (np.arange(AZIMUTH) + 0.5) / AZIMUTH
    half, difference, azimuth = (
        axis.ravel() for axis in np.meshgrid(half, difference, azimuth, indexing="ij")
    )
    # The difference in the half vector's frame, then turned about y by the half vector's angle.
    x, y, z = sine(difference) * cosine(azimuth), sine(difference) * sine(azimuth), cosine(difference)
    towards, views = (
        np.stack(
            [
                cosine(half) * (sign * x) + sine(half) * z,
                sign * y,
                cosine(half) * z - sine(half) * (sign * x),
            ],
            axis=-1,
        )
        for sign in (1.0, -1.0)
    )
    return towards, views


def table(brdf):
    """The table of an isotropic BRDF, an object with ``at``: float64 [3, 90, 90, 180], in the file's
    order.
    """
    towards, views = directions()
    above = (towards[:, 2] > 0.0) & (views[:, 2] > 0.0)
    out = np.full((3, len(towards)), BELOW)
    found = brdf.at(towards[above], views[above])
    for k, scale in enumerate(SCALES):
        out[k, above] = np.maximum(found[:, k], 0.0) / scale
    return out.reshape(3, HALF, DIFFERENCE, AZIMUTH)


def data(numbers):
    """The bytes of a MERL file of a ``table``."""
    sizes = np.array([HALF, DIFFERENCE, AZIMUTH], "<i4")
    return sizes.tobytes() + np.ascontiguousarray(numbers, "<f8").tobytes()


def read(contents):
    """The ``table`` of a MERL file's bytes. Raises ValueError for other sizes, or other bytes."""
    sizes = np.frombuffer(contents[:12], "<i4").tolist() if len(contents) >= 12 else []
    if sizes != [HALF, DIFFERENCE, AZIMUTH] or len(contents) != BYTES:
        raise ValueError(
            f"{len(contents)} bytes that begin with the sizes {sizes} are no MERL file of {HALF}, "
            f"{DIFFERENCE}, {AZIMUTH}, which has {BYTES}."
        )
    return np.frombuffer(contents[12:], "<f8").reshape(3, HALF, DIFFERENCE, AZIMUTH)


def _angles(towards, views):
    """The half vector's angle from the normal, the difference's, and its azimuth from 0 to pi: three float64
    [n], of directions [n, 3].
    """
    towards, views = np.asarray(towards, np.float64), np.asarray(views, np.float64)
    half = towards + views
    half = half / np.sqrt((half * half).sum(axis=-1))[:, None]
    # The light turned so that the half vector is the zenith: about z, then about y.
    turn = np.arctan2(half[:, 1], half[:, 0])
    x = np.cos(turn) * towards[:, 0] + np.sin(turn) * towards[:, 1]
    y = np.cos(turn) * towards[:, 1] - np.sin(turn) * towards[:, 0]
    tilt = np.arccos(np.clip(half[:, 2], -1.0, 1.0))
    x, z = np.cos(tilt) * x - np.sin(tilt) * towards[:, 2], np.sin(tilt) * x + np.cos(tilt) * towards[:, 2]
    return tilt, np.arccos(np.clip(z, -1.0, 1.0)), np.arctan2(y, x) % math.pi


def _places(towards, views, sizes):
    """Where directions lie among cells: three float64 [n], a cell's number at its lower edge."""
    tilt, difference, azimuth = _angles(towards, views)
    return (
        np.sqrt(tilt / (0.5 * math.pi)) * sizes[0],
        difference / (0.5 * math.pi) * sizes[1],
        azimuth / math.pi * sizes[2],
    )


def looked_up(numbers, towards, views):
    """f_r of directions [n, 3] each, above the horizon, by the table's nearest number, as in the database's
    reader: float64 [n, 3].
    """
    at = tuple(
        np.clip(place.astype(np.int64), 0, size - 1)
        for place, size in zip(_places(towards, views, numbers.shape[1:]), numbers.shape[1:], strict=True)
    )
    return np.stack([numbers[k][at] * SCALES[k] for k in range(3)], axis=-1)


@dataclass(frozen=True, eq=False)
class MeasuredBRDF:
    """A ``table``'s BRDF, linear between the middles of cells: float64 [3, 90, 90, 180].

    Numbers below zero, where light or view is below the horizon or nothing was measured, do not count. Raises
    ValueError for NaN and infinity, and for another shape.
    """

    numbers: NDArray[np.float64]

    def __post_init__(self):
        numbers = np.asarray(self.numbers, np.float64)
        if numbers.shape != (3, HALF, DIFFERENCE, AZIMUTH):
            raise ValueError(
                f"The table has shape {numbers.shape}; give {(3, HALF, DIFFERENCE, AZIMUTH)}, as read gives."
            )
        if not np.isfinite(numbers).all():
            raise ValueError("The table holds NaN or infinity; give finite numbers, -1 where none is known.")

    def at(self, towards, views):
        """f_r of directions [n, 3] each, above the horizon: float64 [n, 3], zero without a measurement."""
        sizes = self.numbers.shape[1:]
        lows, shares = [], []
        for k, place in enumerate(_places(towards, views, sizes)):
            place = np.floor(place / _ANGLE_STEP + 0.5) * _ANGLE_STEP - 0.5
            # The azimuth goes round; the other two end at their first and last cell.
            place = place if k == 2 else np.clip(place, 0.0, sizes[k] - 1.0)
            low = np.floor(place).astype(np.int64)
            lows.append(low)
            shares.append(place - low)
        out, known = np.zeros((len(lows[0]), 3)), np.zeros((len(lows[0]), 3))
        for corner in range(8):
            bits = [corner >> k & 1 for k in range(3)]
            weight = 1.0
            for bit, share in zip(bits, shares, strict=True):
                weight = weight * (share if bit else 1.0 - share)
            half, difference = (np.minimum(lows[k] + bits[k], sizes[k] - 1) for k in (0, 1))
            azimuth = (lows[2] + bits[2]) % sizes[2]
            for k in range(3):
                value = self.numbers[k][half, difference, azimuth]
                there = np.where(value >= 0.0, weight, 0.0)
                out[:, k] += there * value
                known[:, k] += there
        return out / np.where(known > 0.0, known, 1.0) * np.array(SCALES)
