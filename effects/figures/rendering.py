"""A figure drawn on a machine: its picture, the ideal picture of the same fragments, and their difference."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.framebuffers.pictures import Pictured, to_codes
from fixedpipe.pipeline.framebuffers.result import Result
from fixedpipe.pipeline.ideal.result import IdealResult
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.profiles.profile import Profile

if TYPE_CHECKING:
    from fixedpipe.effects.figures.figure import Figure, Method

# Gains of a difference's picture, and the share of the range about middle grey that 99 of 100 of the pixels
# that differ stay within.
GAINS = tuple(2**n for n in range(8))
_FILLED, _PERCENT = 0.5, 99.0


def gain_for(delta: NDArray[np.int32], bits: int = 8) -> int:
    """The largest power of two, 1 to 128, with which 99 of 100 of the pixels that differ are neither white
    nor black: their differences times the gain are at most half of full intensity. 1 if even that is too
    large; 128 if nothing differs.

    ``delta``: differences of codes of ``bits`` bits, [h, w, 3].
    """
    sizes = _largest_component(delta)
    sizes = sizes[sizes > 0]
    if not sizes.size:
        return GAINS[-1]
    usual = float(np.percentile(sizes, _PERCENT, method="higher")) / (2**bits - 1)
    return max((gain for gain in GAINS if gain * usual <= _FILLED), default=GAINS[0])


def difference(
    machine: NDArray[Any], ideal: NDArray[np.float64], gain: float | None = None, bits: int = 8
) -> NDArray[np.uint8]:
    """(machine - ideal) made visible: uint8 [h, w, 4], middle grey where they are equal, lighter where the
    machine is lighter.

    machine  its codes of ``bits`` bits a component, integers [h, w, 3 or 4]: ``Rendering.codes()``, or where
             it has bytes ``image()``
    ideal    float64 [h, w, 3 or 4], 1.0 = full, rows in the same order; it is rounded to the machine's codes,
             so that a machine that is right to its last bit does not differ
    gain     how many times as large the differences are shown; None: as ``gain_for`` says
    """
    return _shown(delta_of(machine, ideal, bits), gain, bits)


def delta_of(machine: NDArray[Any], ideal: NDArray[np.float64], bits: int = 8) -> NDArray[np.int32]:
    """The machine's codes minus the ideal rounded to the machine's format: int32 [h, w, 3]; as
    ``difference`` takes them.
    """
    return np.asarray(machine[..., :3], np.int32) - to_codes(ideal[..., :3], bits)


def _shown(delta: NDArray[np.int32], gain: float | None, bits: int) -> NDArray[np.uint8]:
    gain = gain_for(delta, bits) if gain is None else gain
    shown = gain * delta * (255.0 / (2**bits - 1))
    shown += 128.0
    shown += 0.5
    np.floor(shown, out=shown)
    out = np.full((*delta.shape[:2], 4), 255, np.uint8)
    out[..., :3] = np.clip(shown, 0, 255, out=shown)
    return out


def _largest_component(values: NDArray[Any]) -> NDArray[Any]:
    """The largest of a pixel's three, without sign: [h, w] of [h, w, 3]."""
    sizes = np.abs(values)
    return np.maximum(np.maximum(sizes[..., 0], sizes[..., 1]), sizes[..., 2])


@dataclass(frozen=True, eq=False, repr=False)
class Difference(Pictured):
    """(machine - something better) made visible. A notebook shows it, and ``save`` writes it; if nothing
    differs, a notebook says so in words. Arrays have their top row first.

    delta  the machine's codes minus the other's, rounded to the machine's format: int32 [h, w, 3]
    error  the same, but the other is not rounded, 1.0 = full: float64 [h, w, 3]
    bits   of a component of the machine's colours
    of     the other's name: "ideal" or "reference"
    where  the pixels that are compared: bool [h, w]; None: all. In the others ``delta`` and ``error`` are 0
    """

    delta: NDArray[np.int32]
    error: NDArray[np.float64]
    bits: int = 8
    of: str = "ideal"
    where: NDArray[np.bool_] | None = None

    @cached_property
    def identical(self) -> bool:
        """Whether no code differs."""
        return not self.delta.any()

    @cached_property
    def gain(self) -> int:
        """By which factor ``image()`` multiplies the difference: ``gain_for``."""
        return gain_for(self.delta, self.bits)

    @cached_property
    def pixels(self) -> int:
        """How many pixels differ, in one component or more."""
        red, green, blue = (self.delta[..., k] for k in range(3))
        return int(np.count_nonzero(red | green | blue))

    @cached_property
    def at(self) -> tuple[int, int] | None:
        """Column and row, counted from the left and the top, of the pixel that differs most: by codes, then
        unrounded, then the first in reading order. None where nothing differs.
        """
        if self.identical:
            return None
        codes = _largest_component(self.delta)
        rows, columns = np.nonzero(codes == codes.max())
        first = int(_largest_component(self.error[rows, columns]).argmax())
        return int(columns[first]), int(rows[first])

    @cached_property
    def rms(self) -> float:
        """Root of the mean square of ``error`` over the pixels compared, 1.0 = full."""
        squares = self.error * self.error
        compared = squares if self.where is None else squares[self.where]
        return float(np.sqrt(compared.mean())) if compared.size else 0.0

    @cached_property
    def largest(self) -> float:
        """The largest of ``error``, without sign, 1.0 = full."""
        return float(np.abs(self.error).max())

    def image(self) -> NDArray[np.uint8]:
        """Uint8 [h, w, 4]: middle grey where codes are equal, which is everywhere where ``identical``."""
        return _shown(self.delta, self.gain, self.bits)

    def _repr_png_(self) -> bytes | None:
        """None where nothing differs, so that a notebook prints the sentence of ``repr``."""
        return None if self.identical else super()._repr_png_()

    def __repr__(self) -> str:
        height, width = self.delta.shape[:2]
        if self.identical:
            return f"<identical: no code of {width}x{height} pixels differs from the {self.of}'s, rounded>"
        return (
            f"<{self.pixels} of {width}x{height} pixels differ from the {self.of}, shown x {self.gain}, "
            f"most at {self.at}>"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Rendering(Pictured):
    """A figure as a machine draws it (``Figure.render``). All arrays have their top row first.

    A notebook shows the machine's picture; ``save`` writes it.

    figure   the Figure
    profile  the machine
    method   the figure's method that drew it
    size     a panel's height, pixels
    changes  the parameters with other values than the figure's, by name
    result   the machine's Result; the IdealResult if the machine is the ideal
    threads  as for ``execute``, for the ideal too
    """

    figure: "Figure"
    profile: Profile
    method: "Method"
    size: int
    changes: Mapping[str, Any]
    result: Result | IdealResult
    threads: int | None = None

    def image(self) -> NDArray[np.uint8]:
        """The machine's picture as bytes, uint8 [h, w, 4]. Components of other widths become the nearest
        byte.
        """
        return self.result.image()

    @property
    def bits(self) -> int:
        """The bits of a component of the picture. The ideal's picture is rounded to 8."""
        return 8 if isinstance(self.result, IdealResult) else self.result.bits

    def codes(self) -> NDArray[np.int32]:
        """The machine's colours unchanged, int32 [h, w, 4], 0 .. 2**bits - 1."""
        return self.result.codes()

    def deep_image(self) -> NDArray[np.uint8 | np.uint16]:
        """``image()``, or of more than 8 bits a component uint16, 65535 = full: what ``save`` writes."""
        return self.result.deep_image()

    @cached_property
    def ideal(self) -> IdealResult:
        """The ideal picture of the same fragments, float64, computed at the first use."""
        if isinstance(self.result, IdealResult):
            return self.result
        from fixedpipe.pipeline.ideal.evaluate import execute_ideal

        commands = self.figure.commands(IDEAL, self.size, self.method, **self.changes)
        dimensions = self.figure.dimensions(self.size)
        return execute_ideal(commands, *dimensions, guide=self.result, threads=self.threads)

    @cached_property
    def difference(self) -> Difference:
        """(machine - ideal) made visible: a Difference of codes."""
        return Difference(delta_of(self.codes(), self.ideal.color, self.bits), self.error, self.bits)

    @property
    def gain(self) -> int:
        """By which factor the picture of ``difference`` multiplies it."""
        return self.difference.gain

    @cached_property
    def error(self) -> NDArray[np.float64]:
        """machine - ideal, RGB, both clamped to [0, 1]: float64 [h, w, 3], 1.0 = full."""
        return self._exact() - np.clip(self.ideal.color[..., :3], 0.0, 1.0)

    @cached_property
    def reference(self) -> NDArray[np.float64] | None:
        """What the figure's algorithm approximates, of the same values of parameters: RGBA float64 [h, w, 4],
        1.0 = full, alpha 0 where there is none; None where the figure has no reference.
        """
        return self.figure.reference_picture(self.size, self.method, **self.changes)

    @cached_property
    def reference_difference(self) -> Difference | None:
        """(machine - reference) made visible: a Difference of codes; None where there is no reference."""
        return None if self.reference is None else self.compared_with(self.reference)

    def compared_with(self, reference: NDArray[np.float64]) -> Difference:
        """(machine - reference) made visible, of any reference: RGBA float64 [h, w, 4], 1.0 = full, alpha 0
        where there is none.
        """
        where = reference[..., 3] > 0.0
        error = self._exact() - np.clip(reference[..., :3], 0.0, 1.0)
        delta = delta_of(self.codes(), reference, self.bits)
        error[~where], delta[~where] = 0.0, 0
        return Difference(delta, error, self.bits, "reference", where)

    def _exact(self) -> NDArray[np.float64]:
        """The picture's RGB, clamped: float64 [h, w, 3], 1.0 = full; of the ideal without any rounding."""
        if isinstance(self.result, IdealResult):
            return np.clip(self.result.color[..., :3], 0.0, 1.0)
        return self.codes()[..., :3] / (2.0**self.bits - 1.0)

    def __repr__(self) -> str:
        width, height = self.figure.dimensions(self.size)
        changed = "".join(f", {name}={value!r}" for name, value in self.changes.items())
        return f"<{self.figure.id} on {self.profile.name}, {width}x{height} pixels{changed}>"
