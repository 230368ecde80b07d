"""S02, footprint assembly: square probes cover a pixel's footprint in a texture.

A unit that does mip-mapping adds the probes up.

A pixel's two edges in the texture are r_1 = (du/dx, dv/dx) and r_2 = (du/dy, dv/dy), in texels. Probes lie
along the longer of them, d. Their edge is about the footprint's short side w. Their number is |d| / w: the
exact quotient rounded up, or a power of two, so that a shift divides the sum.

The module uses additions, products, quotients and square roots alone, and finds powers of two by comparison.
So its bits are the same on every computer.

Source: Schilling 1997, section 2; Schilling, Knittel, Strasser 1996; pass sequence A-S02 of the catalogue
(from memory there: the sides by diagonals, the rule for too many probes).
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.technique import Technique

TECHNIQUES = (Technique("S02", "footprint assembly: square probes along a footprint's longer edge", "2"),)


@dataclass(frozen=True)
class Probes:
    """The probes of footprints [...].

    direction  float64 [..., 2]: d, along which they lie, texels
    count      int64 [...]: N, from 1
    edge       float64 [...]: the edge of a probe, texels, at least one; its base-two logarithm is the level
    """

    direction: np.ndarray
    count: np.ndarray
    edge: np.ndarray

    def offsets(self, k):
        """Where probe ``k`` of each footprint lies from the middle, float64 [..., 2]: (2k + 1 - N) / 2N d."""
        n = self.count[..., None].astype(np.float64)
        return (2.0 * k + 1.0 - n) / (2.0 * n) * self.direction


def _length(vectors):
    return np.sqrt(vectors[..., 0] * vectors[..., 0] + vectors[..., 1] * vectors[..., 1])


def probes(across, up, most=8, *, exact=False, diagonals=True):
    """The Probes of footprints.

    across, up  float64 [..., 2]: r_1 and r_2, texels
    most        probes of a footprint, from 1; a power of two unless ``exact``
    exact       N is the least that covers |d| with edges of w; False: the nearest power of two, by logarithm
    diagonals   w is the least of |r_1|, |r_2| and the diagonals |r_1 + r_2| and |r_1 - r_2|; False: only the
                edges, which are far too wide for a footprint that lies across both

    Where N is cut off, or the texture is magnified, probes grow: the edge is |d| / N then, and never under a
    texel. Raises ValueError for footprints that are not finite, of other shapes, or for a count that is none.
    """
    across, up = np.asarray(across, np.float64), np.asarray(up, np.float64)
    if across.shape != up.shape or across.shape[-1:] != (2,):
        raise ValueError(
            f"A footprint is two vectors (u, v); these have shapes {across.shape} and {up.shape}."
        )
    if not (np.isfinite(across).all() and np.isfinite(up).all()):
        raise ValueError("A footprint's edges are not finite; divide by a w that is not zero.")
    if most < 1 or (not exact and most & (most - 1)):
        raise ValueError(f"At most {most} probes are asked for; give 1, 2, 4, 8 or 16.")
    first, second = _length(across), _length(up)
    longer = first >= second
    direction = np.where(longer[..., None], across, up)
    long = np.where(longer, first, second)
    short = np.where(longer, second, first)
    if diagonals:
        short = np.minimum(short, np.minimum(_length(across + up), _length(across - up)))
    # Neither side is less than a texel, which is all that a probe can tell.
    short = np.maximum(short, 1.0)
    quotient = np.maximum(long / short, 1.0)
    count = np.ones(quotient.shape, np.int64)
    if exact:
        count = np.minimum(np.ceil(np.minimum(quotient, most)), most).astype(np.int64)
    else:
        n = 1
        while n < most:
            # From sqrt(2) n on, 2 n is nearer: compared as squares.
            count = np.where(quotient * quotient >= 2.0 * n * n, 2 * n, count)
            n *= 2
    cut = quotient > most
    return Probes(direction, count, np.where(cut, np.maximum(long / count, 1.0), short))


def isotropic(across, up):
    """One probe as mip-mapping takes it: Probes with N = 1, its edge the longer of |r_1| and |r_2|."""
    found = probes(across, up, 1)
    edge = np.maximum(
        np.maximum(_length(np.asarray(across, np.float64)), _length(np.asarray(up, np.float64))), 1.0
    )
    return Probes(found.direction, found.count, edge)
