"""The self-test's frames: the specification draws them so, and their digests are what the package has."""

import ast

import pytest

from fixedpipe.pipeline.native import queue
from fixedpipe.pipeline.native.threads import Threads
from fixedpipe.pipeline.selftest.checks import MOST_THREADS, EngineChoice, draw, ways
from fixedpipe.pipeline.selftest.digests import accepted, digest_of, from_text, to_text
from fixedpipe.pipeline.selftest.frames import FRAMES
from fixedpipe.raster.primitives.bins import BAND_HEIGHT
from tests.accept_selftest import ACCEPTED, UNSPECIFIED, drawn_alike, specified

NAMES = [frame.name for frame in FRAMES]


def test_every_frame_has_one_accepted_digest():
    assert list(accepted()) == NAMES
    assert len(set(NAMES)) == len(NAMES)
    assert to_text(accepted().values()) == ACCEPTED.read_text()
    assert set(UNSPECIFIED) < set(NAMES)


@pytest.mark.parametrize("frame", [f for f in FRAMES if f.name not in UNSPECIFIED], ids=lambda f: f.name)
def test_the_specification_draws_the_accepted_bits(frame):
    assert specified(frame) == accepted()[frame.name]


@pytest.mark.parametrize("frame", FRAMES, ids=lambda f: f.name)
def test_every_engine_on_any_number_of_threads_draws_the_accepted_bits(frame):
    digest, others = drawn_alike(frame)
    assert not others
    assert digest == accepted()[frame.name]


@pytest.mark.parametrize("engine", [None, "portable"])
def test_most_frames_are_shared_by_all_threads_that_are_asked_for(engine, monkeypatch):
    """A frame too small for a second thread would prove nothing of threads."""
    shared = []
    run = Threads.run
    monkeypatch.setattr(
        queue.Threads, "run", lambda self, share: shared.append(self.count) or run(self, share)
    )
    most = {}
    for frame in FRAMES:
        shared.clear()
        draw(frame, EngineChoice(engine, MOST_THREADS))
        most[frame.name] = max(shared, default=1)
    bands = {frame.name: -(-frame.size[1] // BAND_HEIGHT) for frame in FRAMES}
    shared_by_all = [name for name in NAMES if most[name] == min(bands[name], MOST_THREADS)]
    assert most["bands"] == MOST_THREADS
    assert len(shared_by_all) > 2 / 3 * len(FRAMES), shared_by_all


FOLDER = ACCEPTED.parent
# What is exact in every version: arrays, whole numbers, and the square root, which IEEE 754 rounds correctly.
EXACT = {"array", "int64", "uint8", "prod", "sqrt"}


@pytest.mark.parametrize(
    "path", sorted({*FOLDER.glob("*_frames.py"), FOLDER / "shapes.py"}), ids=lambda p: p.name
)
def test_what_is_handed_to_machines_asks_no_library_for_what_another_version_gives_otherwise(path):
    tree = ast.parse(path.read_text())
    imported = [n for n in ast.walk(tree) if isinstance(n, ast.Import | ast.ImportFrom)]
    modules = {getattr(n, "module", None) or n.names[0].name for n in imported}
    used = {
        n.attr
        for n in ast.walk(tree)
        if isinstance(n, ast.Attribute) and isinstance(n.value, ast.Name) and n.value.id == "np"
    }
    used |= {a.name for n in imported if getattr(n, "module", None) == "math" for a in n.names}
    assert used <= EXACT
    assert not modules & {"random", "scipy"}


def test_a_file_that_holds_no_digests_is_refused_in_a_sentence():
    with pytest.raises(ValueError, match="does not hold the self-test's digests"):
        from_text('{"frame": 1}')


def test_digests_tell_rows():
    frame = FRAMES[0]
    drawn = draw(frame, ways((1,))[0])
    digest = digest_of(frame, drawn)
    drawn.color[3, 7, 1] ^= 1
    changed = digest_of(frame, drawn)
    assert changed.sha256 != digest.sha256
    assert digest.first_row_that_differs(changed) == 3
