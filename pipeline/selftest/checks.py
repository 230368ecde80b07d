"""Frames drawn in several ways and compared with the accepted digests; a sentence for each difference."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from fixedpipe.pipeline.execution.machine import Engine, execute
from fixedpipe.pipeline.native.threads import default_threads
from fixedpipe.pipeline.selftest.digests import Digest, Drawn, accepted, digest_of, drawn_by
from fixedpipe.pipeline.selftest.frame import Frame
from fixedpipe.pipeline.selftest.frames import FRAMES

# The tallest frame has this many bands of rows.
MOST_THREADS = 8


@dataclass(frozen=True)
class EngineChoice:
    """How frames are drawn: by which of ``pipeline.execution.machine.ENGINES``, and on how many threads."""

    engine: Engine | None
    threads: int

    def __str__(self) -> str:
        engine = {None: "the fastest engines", "columns": "the column engine"}.get(
            self.engine, f"the {self.engine} engine"
        )
        return f"{engine}, {self.threads} thread{'s' * (self.threads > 1)}"


@dataclass(frozen=True)
class Check:
    """The result of drawing the frames in one way.

    - ``where``: the environment, in words.
    - ``way``: engine and threads, in words.
    - ``frames``: the number of frames drawn.
    - ``failures``: a sentence for each frame that differs.
    - ``left_out``: a sentence on why nothing was drawn; "" otherwise.
    """

    where: str
    way: str
    frames: int
    failures: tuple[str, ...] = field(default_factory=tuple)
    left_out: str = ""

    @property
    def passed(self) -> bool:
        """Whether nothing differs."""
        return not self.failures

    def __str__(self) -> str:
        what = f"{self.where}: {self.way}" if self.way else self.where
        if self.left_out:
            return f"left out  {what}: {self.left_out}"
        if self.passed:
            return f"equal     {what}: {self.frames} frames"
        return f"DIFFERENT {what}: {len(self.failures)} of {self.frames} frames"


def ways(
    threads: Sequence[int], engines: Sequence[Engine | None] = (None, "portable")
) -> tuple[EngineChoice, ...]:
    """Compiled engines on each number of threads; with several engines the column engine too, on one."""
    columns = (EngineChoice("columns", 1),) if len(engines) > 1 else ()
    return tuple(EngineChoice(engine, count) for engine in engines for count in threads) + columns


def usual_threads() -> tuple[int, ...]:
    """One to the number of processors, but at least to two."""
    return tuple(range(1, min(max(default_threads(), 2), MOST_THREADS) + 1))


def draw(frame: Frame, way: EngineChoice) -> Drawn:
    """The results of a frame that is drawn in this way."""
    window = {"engine": way.engine, "threads": way.threads, **frame.window}
    return drawn_by(execute(frame.commands, frame.profile, *frame.size, **window))


def check_frames(
    where: str,
    asked: Sequence[EngineChoice],
    frames: Iterable[Frame] = FRAMES,
    known: dict[str, Digest] | None = None,
) -> tuple[Check, ...]:
    """A Check for each EngineChoice. ``known``: other digests than those of the package."""
    known = accepted() if known is None else known
    frames = tuple(frames)
    failures: dict[EngineChoice, list[str]] = {way: [] for way in asked}
    for frame in frames:
        for way, sentence in _failures(frame, asked, known.get(frame.name)):
            failures[way].append(f"Frame {frame.name!r}, drawn by {way}, {where}: {sentence}")
    return tuple(Check(where, str(way), len(frames), tuple(failures[way])) for way in asked)


def _failures(frame, asked, digest):
    """(way, difference) for each way to draw a frame that does not give the accepted digest."""
    if digest is None:
        for way in asked:
            yield way, "the package has no digest of it; install fixedpipe again."
        return
    right, wrong = None, []
    for way in asked:
        try:
            drawn = draw(frame, way)
        except Exception as error:  # The self-test reports whatever a broken installation raises.
            yield way, f"nothing was drawn, {type(error).__name__}: {error}"
            continue
        found = digest_of(frame, drawn)
        if found.sha256 == digest.sha256:
            right = (way, drawn) if right is None else right
        else:
            wrong.append((way, drawn, found))
    for way, drawn, found in wrong:
        yield way, _difference(drawn, right) if right else _no_way(digest, found)


def _difference(drawn, right):
    """The first difference of a drawing from a right one, which is (way, Drawn)."""
    way, expected = right
    unequal = np.zeros(expected.depth.shape, bool)
    for name, plane in drawn.planes.items():
        parted = plane != expected.planes[name]
        unequal |= parted if parted.ndim == 2 else parted.any(-1)
    if not unequal.any():
        return f"what was read from it is not what was by {way}, whose bits are those accepted."
    y, x = (int(k) for k in np.argwhere(unequal)[0])
    parts = [
        f"{name} {_told(plane[y, x])} instead of {_told(expected.planes[name][y, x])}"
        for name, plane in drawn.planes.items()
        if (plane[y, x] != expected.planes[name][y, x]).any()
    ]
    count = int(unequal.sum())
    pixels = f"{count} pixel{'s' * (count > 1)}"
    return (
        f"it differs in {pixels} from the drawing by {way}, whose bits are those accepted; the first is "
        f"({x}, {y}) from the top left, {', '.join(parts)}."
    )


def _told(value):
    return "(" + ", ".join(map(str, value)) + ")" if np.ndim(value) else str(value)


def _no_way(digest, found):
    row = digest.first_row_that_differs(found)
    if row is None:
        return "what was read from it is not what was accepted, and no way of drawing it here gives that."
    return f"row {row} from the top is the first that was not accepted so, and no way here gives that one."
