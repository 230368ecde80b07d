"""What the self-test says of a machine that does not draw the accepted bits."""

import subprocess
from dataclasses import replace

import pytest

from fixedpipe.pipeline.selftest import checks, processes, processors, quick, run
from fixedpipe.pipeline.selftest.checks import Check, EngineChoice, check_frames, ways
from fixedpipe.pipeline.selftest.digests import accepted
from fixedpipe.pipeline.selftest.frames import FRAMES
from fixedpipe.pipeline.selftest.processes import checks_elsewhere, checks_of, to_json
from fixedpipe.pipeline.selftest.processors import PROCESSORS, Processor

FEW = FRAMES[:2]
ASKED = ways((1, 2))


@pytest.fixture
def wrong_portable(monkeypatch):
    """The portable engine turns a bit of one pixel, on two threads."""
    draw = checks.draw

    def drawn(frame, way):
        made = draw(frame, way)
        if way == EngineChoice("portable", 2):
            made.color[5, 9, 1] ^= 4
        return made

    monkeypatch.setattr(checks, "draw", drawn)


def test_all_ways_are_equal():
    made = check_frames("here", ASKED, FEW)
    assert [check.way for check in made] == [
        "the fastest engines, 1 thread",
        "the fastest engines, 2 threads",
        "the portable engine, 1 thread",
        "the portable engine, 2 threads",
        "the column engine, 1 thread",
    ]
    assert all(check.passed and check.frames == len(FEW) for check in made)
    assert str(made[0]) == "equal     here: the fastest engines, 1 thread: 2 frames"


def test_a_bit_that_differs_is_told_with_frame_engine_threads_and_pixel(wrong_portable):
    *_, made, _ = check_frames("here", ASKED, FEW)
    assert str(made) == "DIFFERENT here: the portable engine, 2 threads: 2 of 2 frames"
    sentence = made.failures[0]
    assert sentence.startswith(f"Frame '{FEW[0].name}', drawn by the portable engine, 2 threads, here: ")
    assert "it differs in 1 pixel from the drawing by the fastest engines, 1 thread" in sentence
    assert "the first is (9, 5) from the top left, colour (" in sentence


def test_where_no_way_is_right_the_row_is_told():
    known = accepted()
    rows = known[FEW[0].name].rows
    known[FEW[0].name] = replace(known[FEW[0].name], sha256="0", rows=rows[:16] + "none" + rows[20:])
    made = check_frames("here", ASKED, FEW, known)
    assert all(len(check.failures) == 1 for check in made)
    assert "row 4 from the top is the first that was not accepted so" in made[0].failures[0]


def test_what_an_engine_raises_is_told(monkeypatch):
    def drawn(frame, way):
        raise OSError("the kernel is missing")

    monkeypatch.setattr(checks, "draw", drawn)
    (made,) = check_frames("here", ASKED[:1], FEW)
    assert "nothing was drawn, OSError: the kernel is missing" in made.failures[0]


def test_a_frame_without_a_digest_is_told():
    (made,) = check_frames("here", ASKED[:1], FEW[:1], {})
    assert "the package has no digest of it" in made.failures[0]


def test_checks_travel_as_a_line():
    made = (Check("here", "a way", 3, ("a sentence",)), Check("there", "", 0, left_out="no such thing."))
    assert checks_of(to_json(made)) == made
    assert str(made[1]) == "left out  there: no such thing."


def test_a_process_of_its_own_draws_the_same():
    made = checks_elsewhere("elsewhere", (1,), processors.numpy_without_extensions())
    assert all(check.passed for check in made), [check.failures for check in made]
    assert {check.frames for check in made} == {len(FRAMES)}


def test_a_process_that_ends_badly_is_a_failure(monkeypatch):
    ended = subprocess.CompletedProcess([], 7, "", "Illegal instruction\n")
    monkeypatch.setattr(processes.subprocess, "run", lambda *a, **k: ended)
    (made,) = checks_elsewhere("elsewhere", (1,), {})
    assert made.failures == ("The process elsewhere ended with status 7: Illegal instruction",)


def test_processors_are_asked_for_where_this_one_has_their_features(monkeypatch):
    asked = []
    monkeypatch.setattr(run, "checks_elsewhere", lambda *given: asked.append(given) or ())
    monkeypatch.setattr(run, "check_frames", lambda *given: ())
    monkeypatch.setattr(run, "processors", lambda: PROCESSORS)
    monkeypatch.setattr(run, "processor_features", lambda: dict.fromkeys(PROCESSORS[2].needs, True))
    made = list(run.run_selftest(cpus=True))
    named = [where.split(",")[0] for where, *_ in asked if where.startswith("compiled")]
    assert named == ["compiled for generic", "compiled for nehalem", "compiled for haswell"]
    assert asked[-1][2]["NUMBA_CPU_NAME"] == "haswell"
    assert asked[-1][1] == range(1, 9)
    assert [check.where.split(",")[0] for check in made if check.left_out] == [
        "compiled for skylake-avx512",
        "compiled for znver4",
    ]
    assert "this processor has no adx, avx512bw" in str(made[-2])


def test_a_processor_names_what_lacks():
    assert Processor("a", ("x", "y")).lacking({"x": True, "y": False}) == ["y"]


def test_the_quick_form_is_kept_where_all_is_equal_and_not_where_it_is_not(monkeypatch, tmp_path):
    made = []
    results = [(Check("here", "a way", 1, ("it differs.",)),), (Check("here", "a way", 1),)]
    monkeypatch.setattr(quick, "CACHE_FOLDER", tmp_path)
    monkeypatch.setattr(quick, "check_frames", lambda *given: made.append(given) or results[len(made) - 1])
    assert quick.failures() == ("it differs.",)
    assert quick.failures() == ()
    assert quick.failures() == ()
    assert len(made) == 2
    monkeypatch.setattr(quick, "numpy_extensions", lambda: ["ANOTHER"])
    with pytest.raises(IndexError):
        quick.failures()


def test_the_quick_form_draws_every_frame_on_one_thread_and_on_several(monkeypatch, tmp_path):
    made = []
    monkeypatch.setattr(quick, "CACHE_FOLDER", tmp_path)
    monkeypatch.setattr(quick, "check_frames", lambda *given: made.extend(given[1]) or check_frames(*given))
    assert quick.failures() == ()
    assert [way.engine for way in made] == [None, None]
    assert made[0].threads == 1 < made[1].threads
