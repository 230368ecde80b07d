"""On what the bench measures, what it asks for there, and what it makes of runs. Nothing measures a time."""

import dataclasses
import json
import os
import select
import sys
from contextlib import suppress

import numpy as np
import pytest

from bench import __main__ as command_line
from bench import (
    draws,
    figures,
    goals,
    history,
    ideals,
    limits,
    lit,
    processor,
    starting,
    tables,
    tex_images,
    wide,
)
from bench.peers import llvmpipe, mesa
from bench.scenes import SCENES
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.pixel_transfer import INITIAL_TRANSFER
from fixedpipe.pipeline.profiles import GEFORCE_256, OCTANE
from fixedpipe.pipeline.validation.validate import validate

HANGS = 600.0
_AVX2 = "fpu sse2 avx avx2 fma bmi1 bmi2 f16c"
_AVX512 = f"{_AVX2} avx512f avx512bw avx512cd avx512dq avx512vl"


def _cpuinfo(vendor="AuthenticAMD", family=26, model=2, name="AMD EPYC", flags=_AVX512):
    lines = [
        "processor\t: 0",
        f"vendor_id\t: {vendor}",
        f"cpu family\t: {family}",
        f"model\t\t: {model}",
        f"model name\t: {name}",
        f"flags\t\t: {flags}",
    ]
    return "\n".join(lines) + "\n\nprocessor\t: 1\nmodel name\t: another\n"


ZEN_5 = processor.read(_cpuinfo())
XEON = processor.read(_cpuinfo("GenuineIntel", 6, 207, "Intel(R) Xeon(R)"))
HASWELL = processor.read(_cpuinfo("GenuineIntel", 6, 60, "Intel(R) Core(TM) i7-4770", _AVX2))


# ----------------------------------------------------------------------------------------- processor


def test_a_processor_is_what_its_first_core_says():
    assert (ZEN_5.name, ZEN_5.family, ZEN_5.model, ZEN_5.kind) == ("AMD EPYC", 26, 2, "Zen 5")
    assert ZEN_5.extensions == ("SSE2", "AVX", "AVX2", "AVX-512")
    assert str(ZEN_5).endswith("of AMD EPYC (family 26, model 2), AVX-512")
    assert (XEON.kind, HASWELL.kind) == ("other", "other")
    assert HASWELL.extensions == ("SSE2", "AVX", "AVX2")
    # AMD's family 25 is no Zen 5, and another's family 26 neither.
    assert processor.read(_cpuinfo(family=25)).kind == "other"
    assert processor.read(_cpuinfo(vendor="GenuineIntel")).kind == "other"


def test_a_level_counts_only_with_all_of_its_parts_and_those_before_it():
    without_vl = processor.read(_cpuinfo(flags=_AVX512.replace(" avx512vl", "")))
    assert without_vl.extensions == ("SSE2", "AVX", "AVX2")
    assert processor.read(_cpuinfo(flags=_AVX512.replace(" fma", ""))).extensions == ("SSE2", "AVX")


def test_a_system_that_says_nothing_is_no_error(monkeypatch, tmp_path):
    monkeypatch.setattr(processor, "CPUINFO", tmp_path / "none")
    found = processor.read()
    assert (found.family, found.extensions, found.kind) == (None, (), "other")
    assert found.cores >= 1
    assert json.loads(json.dumps(found.as_json()))["family"] is None
    assert processor.Disturbance(tmp_path / "none").share() is None


def test_versions_and_the_commit_are_told():
    assert {"Python", "numba", "llvmlite", "numpy"} == set(processor.versions())
    assert processor.versions()["numpy"] == np.__version__


def test_what_others_computed_is_all_that_was_busy_but_our_own(monkeypatch, tmp_path):
    monkeypatch.setattr(processor, "_own_cores", lambda: {0, 1})
    monkeypatch.setattr(os, "sysconf", lambda name: 100)
    own = iter([(1.0, 0.0, 0.0, 0.0, 0.0), (3.0, 0.5, 0.5, 0.0, 0.0)])
    monkeypatch.setattr(os, "times", lambda: next(own))
    stat = tmp_path / "stat"
    stat.write_text(
        "cpu  9 9 9 9 9 9 9 9 9 9\ncpu0 5 5 5 5 5 5 5 5 0 0\ncpu1 5 5 5 5 5 5 5 5 7 7\ncpu2 1 1 1 1\n"
    )
    meter = processor.Disturbance(stat)
    # Of two cores' 10 s 4.5 were busy, of which the host took one; 3 s were our own.
    stat.write_text("cpu0 105 55 55 255 55 5 5 5 0 0\ncpu1 105 55 5 255 5 5 5 105 9 9\ncpu2 999 0 0 0\n")
    assert meter.share() == pytest.approx((4.5 - 3.0) / 10.0)


# -------------------------------------------------------------------------------- goals


def test_every_scene_and_figure_has_its_goal_on_every_kind_of_processor():
    scenes = {
        "a": 2.0,
        "a2": 2.0,
        "b": 2.0,
        "b2": 2.0,
        "c": 2.0,
        "d": 2.0,
        "e2": 2.5,
        "f2": 1.5,
        "f3": 1.5,
        "g": 3.0,
        "h": 2.0,
        "i": 1.2,
    }
    both = {
        "teximage": 15,
        "lit": 50,
        "wide": 8.5,
        "cold": 25,
        "cached": 1.2,
        "help": 0.1,
        "scaling": 1.8,
        "memory": 400,
        "factors": 5,
        "probes": 0.5,
    }
    zen_5 = both | {
        "draws": 15,
        "passes": 15,
        "states": 120,
        "frames": 300,
        "first": 20,
        "ideal": 0.33,
        "all": 60,
    }
    other = both | {
        "draws": 30,
        "passes": 30,
        "states": 200,
        "frames": 120,
        "first": 30,
        "ideal": 0.66,
        "all": 120,
    }
    zen_5["fresh"], other["fresh"] = 180, 360
    assert goals.goals(XEON) == goals.goals(HASWELL, "avx2") == scenes | other
    assert goals.goals(ZEN_5, "avx2") == scenes | zen_5
    # What was asked of it before stays.
    assert goals.goals(ZEN_5) == scenes | zen_5 | {"b": 2.2, "b2": 2.2}
    assert goals.goals(XEON, "generic") == other
    assert scenes.keys() == SCENES.keys() - {"e", "t"}
    assert zen_5.keys() == other.keys() == figures.FIGURES.keys()


def test_which_goals_hold_is_said():
    assert goals.applied(ZEN_5) == "Goals: those for Zen 5."
    assert "Intel Xeon" in goals.applied(HASWELL)


# -------------------------------------------------------------------------------- --cpu


def test_a_limit_that_the_processor_lacks_is_refused_with_what_it_has(monkeypatch, capsys):
    unknown = processor.read("")
    monkeypatch.setattr(processor, "read", lambda: HASWELL)
    with pytest.raises(SystemExit) as exit_:
        command_line.main(["a", "--cpu", "avx512"])
    assert exit_.value.code == 2
    assert (
        "--cpu avx512 needs AVX-512, and Intel(R) Core(TM) i7-4770 has SSE2, AVX, AVX2; give avx2 or generic."
        in capsys.readouterr().err
    )
    assert limits.refusal("avx2", HASWELL) is None
    assert limits.refusal("avx2", unknown).endswith("as far as the system says; leave it out.")


def test_a_limited_run_is_a_process_of_its_own_with_kernels_of_its_own(monkeypatch, tmp_path):
    monkeypatch.delenv(limits.VARIABLE, raising=False)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(processor, "read", lambda: ZEN_5)
    monkeypatch.setattr(limits, "_dispatched", lambda: ["X86_V3", "X86_V4", "AVX512_ICL"])
    ran = []

    class Ended:
        returncode = 7

    def run(command, env):
        ran.append((command, env))
        return Ended

    monkeypatch.setattr(limits.subprocess, "run", run)
    found = {}
    for name in limits.LIMITS:
        assert command_line.main(["a", "--cpu", name]) == 7
        command, found[name] = ran.pop()
        assert command == [sys.executable, "-m", "bench", "a", "--cpu", name]
        assert found[name][limits.VARIABLE] == name
        assert found[name]["NUMBA_CACHE_DIR"] == str(tmp_path / f"cpu-{name}")
    numba = {name: env.get("NUMBA_CPU_NAME") for name, env in found.items()}
    assert numba == {"avx512": None, "avx2": "haswell", "generic": "generic"}
    off = {name: env.get("NPY_DISABLE_CPU_FEATURES") for name, env in found.items()}
    assert off == {"avx512": None, "avx2": "X86_V4 AVX512_ICL", "generic": "X86_V3 X86_V4 AVX512_ICL"}


@pytest.mark.parametrize(
    ("name", "width", "has"), [("avx512", "256", None), ("avx2", "256", "avx"), ("generic", "128", "sse2")]
)
def test_the_peer_is_limited_as_ours_is(name, width, has, monkeypatch):
    monkeypatch.setenv(limits.VARIABLE, name)
    monkeypatch.setattr(mesa, "missing", list)
    given = {}

    def start(self, variables, *, text, folder):
        given.update(variables)

    monkeypatch.setattr(mesa.MesaProcess, "__init__", start)
    llvmpipe.Llvmpipe(2)
    assert (given["LP_NATIVE_VECTOR_WIDTH"], given.get("GALLIUM_OVERRIDE_CPU_CAPS")) == (width, has)
    monkeypatch.delenv(limits.VARIABLE)
    given.clear()
    llvmpipe.Llvmpipe(2)
    assert not {"LP_NATIVE_VECTOR_WIDTH", "GALLIUM_OVERRIDE_CPU_CAPS"} & given.keys()


# -------------------------------------------------------------------------------- figures


def test_every_figure_has_a_unit_and_a_direction():
    assert {f.name: (f.unit, f.most, f.is_long) for f in figures.FIGURES.values()} == {
        "passes": ("µs", True, False),
        "states": ("µs", True, False),
        "draws": ("µs", True, False),
        "teximage": ("µs", True, False),
        "lit": ("µs", True, False),
        "frames": ("frames/s", False, False),
        "wide": ("Mfragments/s", False, False),
        "first": ("s", True, False),
        "cold": ("s", True, False),
        "cached": ("s", True, False),
        "help": ("s", True, False),
        "ideal": ("s", True, False),
        "scaling": ("times", False, False),
        "memory": ("MB", True, False),
        "factors": ("s", True, False),
        "probes": ("times", False, False),
        "all": ("s", True, True),
        "fresh": ("s", True, True),
    }


def test_a_goal_is_the_most_or_the_least():
    assert figures.FIGURES["cold"].is_met(25, goal=25)
    assert not figures.FIGURES["cold"].is_met(25.1, goal=25)
    assert figures.FIGURES["scaling"].is_met(1.8, goal=1.8)
    assert not figures.FIGURES["scaling"].is_met(1.79, goal=1.8)


def test_what_was_repeated_is_its_median_with_its_spread():
    found = figures.Measured.median([2.0, 4.0, 3.0], {"best": [2.0]})
    assert found == figures.Measured(3.0, {"best": 2.0}, 0.5)


def test_draws_are_of_a_hundred_vertices_each_in_a_state_of_its_own_and_draw_one_pixel():
    scene = SCENES["c"]
    machine = Machine(scene.profile, draws.EDGE, draws.EDGE, threads=1)
    machine.run(scene.textures())
    turn = draws.draws(1)
    validate((*scene.textures(), *turn), GEFORCE_256, draws.EDGE, draws.EDGE)
    assert len(turn) == 64
    assert all(isinstance(draw, Draw) and len(draw.mesh.positions) == 100 for draw in turn)
    assert len({draw.mesh.positions.tobytes() for draw in turn}) == 64
    assert len({draw.state for draw in (*turn, *draws.draws(0))}) == 128
    # Every Draw covers its one pixel, whose fragment the triangles' common edge cannot double.
    assert machine.run(turn).fragments == 64
    for turn in (1, 2):
        assert {id(draw.mesh) for draw in draws.draws(turn, new_mesh=False)} == {id(draws._same()[0])}
        assert {id(draw.state) for draw in draws.draws(turn, new_state=False)} == {id(draws._same()[1])}


def test_tex_images_go_through_every_step_and_no_two_are_the_same():
    first, second = tex_images.tex_images(0), tex_images.tex_images(1)
    validate((*first, *second), OCTANE, tex_images.EDGE, tex_images.EDGE)
    assert len(first) == 64
    assert len({command.pixels.values.tobytes() for command in (*first, *second)}) == 128
    assert len({command.transfer for command in (*first, *second)}) == 128
    for command in first:
        assert command.pixels.values.shape == (16, 16, 3)
        for name in (
            "scale", "bias", "color_table", "post_convolution_color_table", "color_matrix",
            "post_color_matrix_scale", "post_color_matrix_bias", "post_color_matrix_color_table",
        ):  # fmt: skip
            assert getattr(command.transfer, name) != getattr(INITIAL_TRANSFER, name)
    assert OCTANE.arithmetic.clamps_color_matrix


def test_lit_draws_are_the_same_but_for_their_lights():
    for profile, lights in lit.KINDS:
        plain, shone = lit.state(()), lit.state(lights)
        assert dataclasses.replace(shone, vertex=plain.vertex) == plain
        for lights_of_frame in ((), lights):
            frame = lit.frame(lights_of_frame)
            assert len({id(command) for command in frame}) == lit.DRAWS  # a repeated Draw is prepared once
            validate(frame, profile, lit.EDGE, lit.EDGE)
    assert {(profile.name, len(lights)) for profile, lights in lit.KINDS} == {
        (name, count) for name in ("NV2A", "GeForce 256") for count in (1, 2)
    }


def test_the_figures_whose_ideals_are_timed_can_be_drawn_on_their_machines():
    from fixedpipe.effects.figures import FIGURES

    assert all(machine in FIGURES[name].machines for name, machine in ideals.FIGURES.items())


def test_frames_of_twelve_bits_are_those_of_both_engines():
    for name in wide.MEASURED:
        scene = SCENES[name]
        kernels, columns = (machine.run(scene.frame(wide.EDGE, 1)) for machine in wide.machines(scene))
        assert kernels.framebuffer.color_bits == wide.BITS
        assert (kernels.framebuffer.color == columns.framebuffer.color).all()


def test_long_figures_are_measured_only_where_they_are_named():
    options = command_line._arguments([])
    assert {"all", "fresh"} & set(options.names) == set()
    assert command_line._arguments(["all"]).names == ["all"]


def test_a_module_that_fails_is_an_error_with_what_it_printed():
    with pytest.raises(OSError, match=r"python -m bench\.no_such ended with 1: .*No module named"):
        starting.run_module("bench.no_such")


def test_a_module_is_given_the_environment_and_its_output_read():
    seconds, output = starting.run_module("site", PYTHONUSERBASE="/some/base")
    assert "USER_BASE: '/some/base'" in output
    assert seconds > 0


def test_commands_start_with_the_kernels_and_the_folder_that_they_are_timed_with(monkeypatch):
    ran = []

    def run_module(*arguments, **variables):
        *command, out = arguments
        ran.append((command, out, variables.get("NUMBA_CACHE_DIR"), os.path.exists(out)))
        return float(len(ran)), ""

    monkeypatch.setattr(starting, "run_module", run_module)
    monkeypatch.setattr(starting, "first", lambda command: list(command))
    one = ["fixedpipe.effects.cli", "figures", "F004-4", "--profile", "GEFORCE_256", "--out"]
    assert starting.cold("F004-4") == one
    assert starting.cached("F004-4", times=2) == [2.0, 3.0]
    assert starting.every_figure() == (4.0, 5.0)
    assert starting.every_figure_cold() == 6.0
    all_of_them = ["fixedpipe.effects.cli", "figures", "--check", "--out"]
    assert [command for command, *_ in ran] == [one] * 3 + [all_of_them] * 3
    outs, caches = [out for _, out, _, _ in ran], [cache for _, _, cache, _ in ran]
    # Only the second of every figure's runs finds the folder of the one before it.
    assert len(set(outs)) == 5 and outs[3] == outs[4]
    assert not any(was_there for *_, was_there in ran)
    assert [cache is not None for cache in caches] == [False, False, False, False, False, True]
    assert not any(os.path.exists(cache) for cache in caches if cache)


_WRITES = """
import os, pathlib, subprocess, sys, time
late = "import os, pathlib, time; time.sleep(500); pathlib.Path(os.environ['TOLD'] + '.late').touch()"
child = subprocess.Popen([sys.executable, "-c", late])
out = pathlib.Path(sys.argv[1])
out.mkdir()
pathlib.Path(os.environ["TOLD"]).write_text(f"{os.environ['NUMBA_CACHE_DIR']} {os.getpid()} {child.pid}")
(out / "F1.json").write_text("{}")
(out / "index.html").write_text("")
time.sleep(500)
"""


def _wait_for_the_end_of(pid):
    """Another's process that was told to end: the kernel may take its time."""
    with suppress(ProcessLookupError):
        end = os.pidfd_open(pid)
        try:
            assert select.select([end], [], [], HANGS)[0], f"process {pid} still runs"
        finally:
            os.close(end)


@pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="waits for the end of a process that is no child")
def test_the_first_picture_is_waited_for_and_then_all_processes_are_ended(monkeypatch, tmp_path):
    (tmp_path / "writes_a_picture.py").write_text(_WRITES)
    told = tmp_path / "told"
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("TOLD", str(told))
    assert starting.first(("writes_a_picture",)) > 0.0
    cache, *processes = told.read_text().split()
    assert not os.path.exists(cache)  # it was empty, and is gone
    for process in processes:  # they would end by themselves, and say so
        _wait_for_the_end_of(int(process))
    assert not (tmp_path / "told.late").exists()


def test_a_command_that_ends_without_a_picture_is_an_error():
    with pytest.raises(OSError, match=r"without a picture: .*No module named"):
        starting.first(("bench.no_such",))


def test_a_picture_is_there_once_its_record_and_the_page_are(tmp_path):
    (tmp_path / "index.html").write_text("")
    assert not starting.is_there(tmp_path)
    (tmp_path / "F004-4.json").write_text("{}")
    assert starting.is_there(tmp_path)
    assert not starting.is_there(tmp_path / "none")


# -------------------------------------------------------------------------------- history


def _run(date, ratio=2.0, ours=100.0, passes=50.0, spread=0.02, where=ZEN_5, **more):
    scene = {
        "scene": "b",
        "size": 1024,
        "threads": 2,
        "unit": "Mfragments/s",
        "ours": ours,
        "peer": ratio and ours / ratio,
        "ratio": ratio,
        "goal": 2.2,
        "aim": 400,
        "spread": spread,
    }
    figure = {
        "figure": "passes",
        "title": "a pass",
        "unit": "µs",
        "measured": passes,
        "goal": 60,
        "relation": "at most",
        "reached": passes <= 60,
        "spread": 0.01,
        "details": {"best": 40.0},
    }
    return {
        "date": date,
        "commit": "0123456789ab",
        "processor": where.as_json(),
        "cpu": None,
        "versions": {"numba": "0.68.1"},
        "threads": 2,
        "peer": "llvmpipe (256 bits), Mesa 22.3.6",
        "others": 0.01,
        "scenes": [scene],
        "figures": [figure],
    } | more


def _history(tmp_path, *runs):
    file = tmp_path / "history.jsonl"
    for run in runs:
        history.append(file, run | {"roofline": None})
    return file


def test_a_run_is_a_line_and_runs_are_read_by_date(tmp_path):
    file = _history(tmp_path, _run("2026-02-01T00:00Z"), _run("2026-01-01T00:00Z"))
    assert len(file.read_text().splitlines()) == 2
    runs = history.read(file)
    assert [run["date"][:7] for run in runs] == ["2026-01", "2026-02"]
    assert runs[0] == _run("2026-01-01T00:00Z")


@pytest.mark.parametrize(
    ("line", "sentence"),
    [("{}", "line 2 is no run of the bench: it lacks date"), ("x", "line 2 is not JSON")],
)
def test_a_line_that_is_no_run_is_named(line, sentence, tmp_path):
    file = _history(tmp_path, _run("2026-01-01T00:00Z"))
    file.write_text(file.read_text() + line)
    with pytest.raises(ValueError, match=sentence):
        history.read(file)


DATES = [f"2026-01-0{day}T00:00Z" for day in range(1, 5)]


def test_a_slow_down_is_a_tenth_of_the_median_of_former_runs():
    former = [_run(date, ratio) for date, ratio in zip(DATES, (2.0, 9.0, 2.0), strict=False)]
    (found,) = history.slower([*former, _run(DATES[3], 1.8, passes=55.5)])
    assert (found.name, found.unit) == ("b", "times llvmpipe")
    assert found.change() == pytest.approx(0.1)
    assert history.sentence(found) == (
        "b is 10% slower: 1.8 times llvmpipe where the median of 3 former runs is 2 "
        f"(AMD EPYC (family 26, model 2), {ZEN_5.cores} cores, 2 threads, 1024²)."
    )
    # 50 of 55.5 µs are nine tenths of the speed and a bit; of 55.6 less.
    assert not history.slower([*former, _run(DATES[3], 1.81, passes=55.5)])
    (found,) = history.slower([*former, _run(DATES[3], 2.5, passes=55.6)])
    assert (found.name, found.most) == ("passes", True)


def test_only_ratios_to_the_same_peer_are_compared():
    other = {"peer": "swiftshader by zink (SwiftShader), 2.1 Mesa 22.3.6"}
    runs = [_run(DATES[0], 9.0, passes=1.0, **other), _run(DATES[1])]
    assert [one.name for one in history.compared(runs)] == ["passes"]
    (found, _) = history.slower([*runs, _run(DATES[2], 1.0, **other)])
    assert (found.name, found.unit) == ("b", "times swiftshader")
    text = tables.markdown([runs[0]])
    assert "(Zen 5), as it is, beside swiftshader | 2 |" in text
    assert "| ours | aim | swiftshader | ratio |" in text


def test_where_a_peer_was_there_its_slow_day_is_no_slow_down():
    assert not history.slower([_run(DATES[0]), _run(DATES[1], ours=50.0)])
    without = [_run(DATES[0], None), _run(DATES[1], None, ours=50.0)]
    assert [(one.name, one.unit) for one in history.slower(without)] == [("b", "Mfragments/s")]


@pytest.mark.parametrize("other", [{"where": XEON}, {"cpu": "avx2"}, {"threads": 1}])
def test_only_runs_on_the_same_processor_limit_and_threads_are_compared(other):
    runs = [_run(DATES[0], 9.0, **other), _run(DATES[1])]
    assert not history.compared(runs)
    assert len(history.compared([*runs, _run(DATES[2])])) == 2


def test_a_disturbed_slow_down_is_to_be_measured_again():
    (found,) = history.slower([_run(DATES[0]), _run(DATES[1], 1.0, spread=0.3)])
    assert history.sentence(found).endswith("Its turns differ by 30%: measure it again on a quiet machine.")


def test_the_exit_status_says_whether_something_became_slower(tmp_path, capsys):
    file = _history(tmp_path, _run(DATES[0]), _run(DATES[1], 1.95))
    assert command_line.main(["history", str(file)]) == 0
    shown = capsys.readouterr()
    assert shown.out.splitlines()[1] == "2 numbers have former runs to compare with; 0 lost a tenth or more."
    history.append(file, _run(DATES[2], 1.5))
    assert command_line.main(["history", str(file)]) == 1
    assert capsys.readouterr().err.startswith("b is 24% slower: 1.5 times llvmpipe")


def test_the_page_shows_every_number_and_names_what_became_slower(tmp_path):
    file = _history(tmp_path, _run(DATES[0], where=XEON), _run(DATES[1]), _run(DATES[2], 1.5))
    page, picture = tmp_path / "speed.html", tmp_path / "speed.png"
    assert command_line.main(["history", str(file), "--plot", str(page)]) == 1
    text = page.read_text()
    assert text.count("<svg") == 4
    assert "b is 25% slower" in text
    assert "Intel(R) Xeon(R)" in text
    assert command_line.main(["history", str(file), "--plot", str(picture)]) == 1
    assert picture.read_bytes()[:4] == b"\x89PNG"


def test_a_page_of_another_kind_is_refused(tmp_path, capsys):
    file = _history(tmp_path, _run(DATES[0]))
    with pytest.raises(SystemExit):
        command_line.main(["history", str(file), "--plot", str(tmp_path / "speed.doc")])
    assert "ends with .doc; give .html, .png, .svg or .pdf." in capsys.readouterr().err


def test_a_measurement_appends_itself(tmp_path, monkeypatch):
    measured = figures.Measured(0.08, {}, 0.01)
    own = figures.FIGURES["help"]
    monkeypatch.setitem(
        command_line.FIGURES, "help", own.__class__(**vars(own) | {"measure": lambda n: measured})
    )
    file = tmp_path / "history.jsonl"
    for _ in range(2):
        assert command_line.main(["help", "--history", str(file)]) == 0
    first, second = history.read(file)
    assert first["figures"] == second["figures"]
    assert (first["figures"][0]["measured"], first["processor"]["cores"]) == (0.08, processor.read().cores)


# -------------------------------------------------------------------------------- tables


def test_the_tables_have_every_run_and_mark_what_misses_its_goal(tmp_path, capsys):
    files = []
    for number, run in enumerate((_run(DATES[0]), _run(DATES[1], 3.0, where=XEON, cpu="avx2", others=0.5))):
        files.append(tmp_path / f"{number}.json")
        files[-1].write_text(json.dumps(run))
    assert command_line.main(["tables", *map(str, files)]) == 0
    text = capsys.readouterr().out
    assert text.splitlines()[:5] == [
        "| processor | threads | date | b |",
        "| --- | --- | --- | --- |",
        "| AMD EPYC (Zen 5), as it is | 2 | 2026-01-01 | **2.00** |",
        "| Intel(R) Xeon(R), limited to AVX2 | 2 | 2026-01-02 | 3.00 |",
        "| asked for |  |  | 2.2 |",
    ]
    assert "| passes | 50 (best 40) | ≤ 60 | µs | yes | 1% |" in text
    assert "Others took 50% of the cores' time." in text
    assert "Spread 2% or less." in text


@pytest.mark.parametrize(
    ("command", "advice"), [(tables.main, "give files that"), (history.main, "writes one")]
)
def test_a_file_that_is_not_there_is_named(tmp_path, capsys, command, advice):
    with pytest.raises(SystemExit):
        command([str(tmp_path / "none.json")])
    said = capsys.readouterr().err
    assert "none.json: No such file or directory; " in said and advice in said and "Errno" not in said


def test_the_tables_go_between_the_pages_marks(tmp_path, capsys):
    file, page = tmp_path / "run.json", tmp_path / "page.md"
    file.write_text(json.dumps(_run(DATES[0])))
    page.write_text(f"before\n{tables.BEGIN}\nold\n{tables.END}\nafter\n")
    for _ in range(2):
        assert command_line.main(["tables", str(file), "--into", str(page)]) == 0
    text = page.read_text()
    assert text.startswith(f"before\n{tables.BEGIN}\n\n| processor")
    assert text.endswith(f"\n{tables.END}\nafter\n")
    assert "old" not in text
    page.write_text("no marks\n")
    with pytest.raises(SystemExit):
        command_line.main(["tables", str(file), "--into", str(page)])
    assert "has no lines" in capsys.readouterr().err
