"""The fuzz: a few hundred frames here, thousands in ``make test-all``; and it finds what is wrong."""

import math
import platform

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.description.describe import describe
from tests import fuzz
from tests.support.processes import output_of
from tests.support.random_frames import random_frame

ON_X86 = platform.machine().lower() in ("x86_64", "amd64")
# A number of frames, the same on every machine: about ten minutes against the specification in all, at twenty
# frames a second. Seeds that no other run of the suite draws.
NATIVE_FRAMES, AVX2_FRAMES, GENERIC_FRAMES, THREADS_FRAMES, CHECKED_FRAMES = 5000, 2500, 2500, 5000, 600
WIDE_FRAMES = 1000
NATIVE_SEED, AVX2_SEED, GENERIC_SEED, THREADS_SEED, CHECKED_SEED, WIDE_SEED = (k * 10**6 for k in range(1, 7))


def test_hundreds_of_frames_are_equal():
    assert fuzz.fuzz(frames=200).specified > 100


def test_frames_of_wide_machines_are_equal():
    assert fuzz.fuzz(frames=150, wide=True).frames == 150


def test_python_threads_draw_at_once():
    assert fuzz.fuzz_threads(3, frames=18, first_seed=10_000).frames >= 18


def test_a_seed_gives_its_frame_again():
    for seed in range(20):
        one, other = random_frame(seed), random_frame(seed)
        assert describe(one.commands) == describe(other.commands)
        meshes = [[c.mesh.positions for c in f.commands if isinstance(c, Draw)] for f in (one, other)]
        assert all(np.array_equal(a, b) for a, b in zip(*meshes, strict=True))


def test_a_wrong_bit_is_found_and_its_frame_made_small(monkeypatch):
    right = fuzz.run_reference

    def wrong(commands, profile, *rest):
        return right(commands, profile.changed(expand_half=120), *rest)

    monkeypatch.setattr(fuzz, "run_reference", wrong)
    monkeypatch.setattr(fuzz, "SHRINKING_SECONDS", math.inf)
    with pytest.raises(fuzz.Mismatch) as found:
        fuzz.fuzz(frames=500)
    mismatch = found.value
    assert len(mismatch.frame.commands) < len(random_frame(mismatch.frame.seed).commands)
    assert any(isinstance(command, Draw) for command in mismatch.frame.commands)
    assert f"python -m tests.fuzz --seed {mismatch.frame.seed}" in str(mismatch)
    assert "the specification" in str(mismatch)
    assert "(row, column)" in str(mismatch)


def test_a_shared_machine_is_compared(monkeypatch):
    machine = fuzz.Machine(fuzz.SHARED_PROFILE, *fuzz.SHARED_SIZES[0], fuzz.SHARED_DEPTH_BITS)
    assert fuzz.check_shared(machine, 0) == 1
    right = fuzz.outcome
    monkeypatch.setattr(fuzz, "outcome", lambda *a: {k: v + 1 for k, v in right(*a).items()})
    with pytest.raises(fuzz.Mismatch, match="drew other frames before"):
        fuzz.check_shared(machine, 0)


def test_the_command_line_checks_one_seed(capsys):
    assert fuzz.main(["--seed", "3"]) == 0
    assert "no difference" in capsys.readouterr().out


def test_frames_that_a_manifest_has_are_not_drawn_again(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(fuzz, "FRAMES_OF_A_CALL", 2)
    some = "--frames", "4", "--first-seed", "20000", "--manifest", str(tmp_path / "m")
    assert fuzz.main(some) == 0
    monkeypatch.setattr(fuzz, "check", lambda frame: pytest.fail("it was drawn again"))
    assert fuzz.main(some) == 0
    assert [line.split(" in ")[0] for line in capsys.readouterr().out.splitlines()] == ["4 frames"] * 2


def run(frames, first_seed, *options, **environment):
    """The fuzz in a process of its own: under another processor, or with every index checked."""
    arguments = "--frames", frames, "--first-seed", first_seed, *options
    said = output_of("tests.fuzz", *arguments, **environment)
    assert "no difference" in said
    print(said)


@pytest.mark.slow
def test_thousands_of_frames_are_equal():
    run(NATIVE_FRAMES, NATIVE_SEED)


@pytest.mark.slow
def test_a_thousand_frames_of_wide_machines_are_equal():
    run(WIDE_FRAMES, WIDE_SEED, "--wide")


@pytest.mark.slow
def test_wide_kernels_stay_inside_their_arrays(tmp_path):
    checked = {"NUMBA_BOUNDSCHECK": "1", "NUMBA_CACHE_DIR": str(tmp_path)}
    run(CHECKED_FRAMES, WIDE_SEED, "--wide", **checked)


@pytest.mark.slow
@pytest.mark.skipif(not ON_X86, reason="AVX2 is an x86 feature")
def test_thousands_of_frames_are_equal_with_avx2(tmp_path):
    haswell = {"NUMBA_CPU_NAME": "haswell", "NUMBA_CPU_FEATURES": "+avx2,+fma"}
    run(AVX2_FRAMES, AVX2_SEED, **haswell, NUMBA_CACHE_DIR=str(tmp_path))


@pytest.mark.slow
def test_thousands_of_frames_are_equal_on_a_plain_processor(tmp_path):
    generic = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
    run(GENERIC_FRAMES, GENERIC_SEED, **generic, NUMBA_CACHE_DIR=str(tmp_path))


@pytest.mark.slow
def test_thousands_of_frames_are_equal_from_several_python_threads():
    run(THREADS_FRAMES, THREADS_SEED, "--python-threads", "4")


@pytest.mark.slow
def test_no_index_is_outside_its_array(tmp_path):
    run(CHECKED_FRAMES, CHECKED_SEED, NUMBA_BOUNDSCHECK="1", NUMBA_CACHE_DIR=str(tmp_path))
