"""The fixture ``golden`` of a test: it compares pictures with the accepted ones, and collects failures."""

import itertools
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.golden.allowances import Allowance, allowance_of
from fixedpipe.pipeline.golden.candidates import (
    ALLOWED,
    CHANGED,
    MISSING,
    NEW,
    PASSED,
    Candidate,
    golden_pixels,
    remove_candidate,
    write_candidate,
)
from fixedpipe.pipeline.golden.differences import Pixels, bounds, difference, kinds_differ
from fixedpipe.pipeline.golden.pixels import pixels_of
from fixedpipe.pipeline.golden.store import (
    GoldenPicture,
    StoreError,
    golden_of,
    plain_key,
    read_store,
    variant_key,
)
from fixedpipe.pipeline.multi_draw import with_draws

_NAME = re.compile(r"[^/\\\x00-\x1f\x7f:]{1,80}")


@dataclass(frozen=True)
class Place:
    """Where a test's pictures are kept.

    - ``root``: the project's folder.
    - ``store``: the module's file, below ``root`` or not.
    - ``module``: the module by pytest's name: tests/test_sphere.py.
    - ``test``: the test in it: test_lit[wide].
    - ``keep``: whether PNG files are kept.
    - ``record``: whether a new picture may be recorded.
    - ``variant``: the platform or driver of the pictures, if given.
    - ``repetition``: the number of this run of a repeated test, from 0 on.
    """

    root: Path
    store: Path
    module: str
    test: str
    keep: bool = True
    record: bool = False
    variant: str | None = None
    repetition: int = 0


@dataclass
class Golden:
    """Compares the pictures of a test with golden ones.

    A difference raises nothing. The test goes on, and fails at its end with all differences. A test's first
    picture without a ``name`` has the test's own name; the later ones are numbered in their order, from 2 on.
    """

    place: Place
    must_differ: bool = False
    asked: dict[str, str] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)
    allowed: dict[str, str] = field(default_factory=dict)  # how pictures differ within their allowance
    recorded: list[str] = field(default_factory=list)  # failures, if the run did not record them

    # ---------------------------------------------------------------------------------------------- pictures

    def __call__(
        self,
        picture: Any,
        name: str | None = None,
        *,
        variant: str | None = None,
        at_most: tuple[int, int] | None = None,
        ignore: Sequence[Sequence[int]] | NDArray[np.bool_] | None = None,
        reason: str | None = None,
    ) -> bool:
        """Whether a picture equals the golden one of this name, pixel by pixel.

        - ``picture``: see ``fixedpipe.pipeline.golden.pixels.pixels_of``; uint8 or uint16.
        - ``name``: of letters that a file's name can have; None: the test's own, and then 2, 3, … in order.
        - ``variant``: the platform or driver that drew it; None: --golden-variant's. Its golden picture is
          its own, or the plain one while there is none.
        - ``at_most``, ``ignore``, ``reason``: the allowed differences, see ``allowance_of``.

        Raises ValueError for a value that is no picture, name, variant or allowance. A picture that differs
        makes the test fail at its end.
        """
        variant = self.place.variant if variant is None else variant
        key, pixels = self._key(name, variant), pixels_of(picture)
        allowance = allowance_of(pixels, at_most, ignore, reason)
        if allowance and self.must_differ:
            raise ValueError(
                "A test whose pictures must differ takes no allowance; leave out at_most and ignore."
            )
        return self._judge(key, pixels, golden_of(pixels), allowance)

    def frame(
        self,
        commands: Iterable[Any],
        profile: Any,
        width: int,
        height: int,
        name: str | None = None,
        **machine: Any,
    ) -> Any:
        """Draw a frame, compare its picture and the planes after every command, and return the Result.

        The arguments are those of ``execute``; ``machine`` are its keywords. The test fails also where the
        picture is golden but a command leaves other colours, depths or stencil values than before. A frame
        has no variants, because fixedpipe draws the same bits on every platform.
        """
        from fixedpipe.pipeline.golden.frames import drawn_with_digests, made_by, with_stages

        key, commands = self._key(name), with_draws(commands)
        given = commands, profile, width, height
        result, passes = drawn_with_digests(*given, **machine)
        pixels = pixels_of(result)
        golden = golden_of(pixels, passes, made_by(profile))
        known = read_store(self.place.store).get(key)
        if known is None or not _equal(known, golden):
            golden = golden_of(pixels, with_stages(passes, *given, **machine), golden.made)
        self._judge(key, pixels, golden)
        return result

    # --------------------------------------------------------------------------------------------- relations

    def equal(self, first: Any, second: Any) -> bool:
        """Whether two pictures are equal in every component of every pixel."""
        return self._relation(first, second, lambda found: found is None, "must be equal")

    def differs(self, first: Any, second: Any) -> bool:
        """Whether two pictures differ, in their pixels or in their size, type or components."""
        a, b = pixels_of(first), pixels_of(second)
        apart = bool(kinds_differ(a, b)) or difference(a, b) is not None
        if not apart:
            self.failures.append("two pictures must differ, and all their pixels are equal")
        return apart

    def at_most(
        self, first: Any, second: Any, max_diff: int | tuple[int, int], pixels: int | tuple[int, int]
    ) -> bool:
        """Whether at most ``pixels`` pixels differ, each by at most ``max_diff`` in a component.

        Each is the most that is allowed, or a pair (least, most), both inclusive, as in the web platform's
        fuzzy reftests. With a least number above 0 equal pictures fail.
        """
        diff, count = bounds(max_diff, "max_diff"), bounds(pixels, "pixels")

        def fits(found):
            largest, differing = (0, 0) if found is None else (found.largest, found.count)
            return diff[0] <= largest <= diff[1] and count[0] <= differing <= count[1]

        wish = f"may differ by {diff[0]} to {diff[1]} in {count[0]} to {count[1]} pixels"
        return self._relation(first, second, fits, wish)

    def _relation(self, first, second, fits, wish):
        a, b = pixels_of(first), pixels_of(second)
        apart = kinds_differ(a, b)
        found = None if apart else difference(a, b)
        if not apart and fits(found):
            return True
        told = apart or (found.told("in the second") if found else "all their pixels are equal")
        self.failures.append(f"two pictures {wish}: {told}")
        return False

    # ------------------------------------------------------------------------------------------------ judging

    def told(self, key: str) -> str:
        """A picture's whole name, with its module."""
        return f"{self.place.module}::{key}"

    def _key(self, name, variant=None):
        if name is not None and (
            not isinstance(name, str) or not _NAME.fullmatch(name) or name.strip() != name
        ):
            raise ValueError(
                f"golden(…, name={name!r}): a name has 1 to 80 characters, no slash, colon or control "
                "character, and no space at its ends. Choose another."
            )
        test = self.place.test
        key = variant_key(test if name is None else f"{test}::{name}", variant)
        if name is None:
            numbers = itertools.count(2)
            while key in self.asked:
                key = variant_key(f"{test}::{next(numbers)}", variant)
        elif key in self.asked:
            raise ValueError(
                f"{test} has two pictures named {name!r}; give each a name of its own: golden(picture, "
                "name=…)."
            )
        self.asked[key] = MISSING  # until the picture is judged
        return key

    def _judge(
        self, key: str, pixels: Pixels, golden: GoldenPicture, allowance: Allowance | None = None
    ) -> bool:
        store = read_store(self.place.store)
        against = key if key in store else plain_key(key)
        known = store.get(against)
        if known is None:
            self.asked[key] = NEW
            told = self.recorded if self.place.record else self.failures
            told.append(f"{self.told(key)} has no golden picture: {golden}{self._renamed(golden)}")
            self._propose(key, NEW, golden, None, pixels)
            return self.place.record
        equal = _equal(known, golden)
        if equal == self.must_differ:
            self.asked[key] = CHANGED
            if equal:
                self.failures.append(
                    f"{self.told(key)} must differ from its golden picture, and is equal to it"
                )
                return False
            within, told = self._difference(against, known, golden, pixels, allowance)
            if not within:
                if against != key:
                    told += f"\n  compared with {against}, since this variant has no golden picture yet"
                self.failures.append(f"{self.told(key)}: {told}")
                self._propose(key, CHANGED, golden, known.sha256, pixels, told, against)
                return False
            self.asked[key], self.allowed[key] = ALLOWED, told
        else:
            self.asked[key] = PASSED
        if not self.place.repetition:  # A later repetition must not remove the candidate of an earlier one.
            remove_candidate(self.place.root, self.told(key))
        return True

    def _difference(self, key, known, golden, pixels, allowance):
        """(whether a picture differs within its allowance, sentences on the differences)."""
        lines, within = [], False
        if str(known) != str(golden):
            lines.append(f"was {known}, is {golden}")
        elif known.sha256 == golden.sha256:
            lines.append("the picture is the golden one, but not what its commands left on the way")
        else:
            shown = Candidate("", self._store(), key, CHANGED, golden, known.sha256, "")
            try:
                expected = golden_pixels(self.place.root, shown)
                if expected is None:
                    needed = ", which what is allowed is judged by" if allowance else ""
                    lines.append(f"its pixels differ (no PNG file of the golden picture is kept{needed})")
                elif allowance:
                    within, said = allowance.judge(expected, pixels)
                    lines.append(said)
                else:
                    lines.append(str(difference(expected, pixels)))
            except StoreError as error:
                lines.append(f"its pixels differ ({error})")
        if known.passes and golden.passes:
            from fixedpipe.pipeline.golden.frames import parted

            lines.append(parted(known.passes, golden.passes))
        return within, "\n  ".join(line for line in lines if line)

    def _renamed(self, golden):
        """A sentence that names another picture of the module with the same pixels: a renamed test's."""
        same = [name for name, g in read_store(self.place.store).items() if g.sha256 == golden.sha256]
        return f"\n  {same[0]} has the same pixels; was the test renamed?" if same else ""

    def _store(self):
        try:
            return self.place.store.relative_to(self.place.root).as_posix()
        except ValueError:
            return self.place.store.as_posix()

    def _propose(self, key, status, golden, expected, pixels, told="", against=""):
        against = "" if against == key else against
        candidate = Candidate(
            self.told(key), self._store(), key, status, golden, expected, told, self.place.keep, against
        )
        try:
            write_candidate(self.place.root, candidate, pixels)
        except StoreError as error:
            self.failures.append(f"{self.told(key)}: what was drawn cannot be kept for a look: {error}")


def _equal(known, golden):
    """Whether the pixels are equal and, if both are frames, also the planes after every command."""
    first, second = ([(p.label, p.kind, p.planes) for p in g.passes] for g in (known, golden))
    return known.sha256 == golden.sha256 and (first == second or not first or not second)
