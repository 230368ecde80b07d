"""Figures in processes of their own, and figures that are not drawn again: the files are the same."""

import errno
import json
import os
import re
import shutil
import signal
import subprocess
import sys
from collections import deque
from concurrent.futures import Future
from pathlib import Path
from queue import SimpleQueue

import pytest
from click.testing import CliRunner

from fixedpipe.effects import computed_once, data_files, source_digests
from fixedpipe.effects.cli import main
from fixedpipe.effects.figures import FIGURES, Figure
from fixedpipe.effects.figures.costs import SECONDS, longest_after_the_first
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports import figure_inputs, figure_pool, perceived
from fixedpipe.pipeline.native import queue
from fixedpipe.pipeline.native.prepared_draw import Prepared
from tests.support.few_figures import Few
from tests.support.sample import slow_unless

SMALL = "--profile", "GEFORCE_256", "--size", "8"


def run(*arguments, status=0):
    done = CliRunner().invoke(main, [str(a) for a in arguments])
    assert done.exit_code == status, done.output
    return done


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def once(tmp_path_factory):
    """A folder with two figures, and what was said: drawn once."""
    folder = tmp_path_factory.mktemp("drawn") / "out"
    return folder, run("figures", "K02", "K12", *SMALL, "--jobs", 1, "--out", folder)


@pytest.fixture
def drawn(once, tmp_path):
    """The same in a folder of the test's own."""
    return shutil.copytree(once[0], tmp_path / "out"), once[1]


# ------------------------------------------------------------------------------------------- what is kept


def test_what_did_not_change_is_not_drawn_again(drawn, monkeypatch):
    folder, first = drawn
    before = contents(folder)
    monkeypatch.setattr(figure_pool.Order, "draw", lambda *_: pytest.fail("it was drawn again"))
    second = run("figures", "K12", "K02", *SMALL, "--out", folder)
    assert "2 figures did not change and stay; --again draws all." in second.stderr
    assert "on 1 machine" not in second.stderr and "on 1 machine" in first.stderr
    assert contents(folder) == before


def spoil_picture(folder):
    path = next((folder / "pictures").glob("*.js"))
    path.write_bytes(path.read_bytes()[:-9])


@pytest.mark.parametrize(
    ("spoil", "arguments", "again"),
    [
        (lambda folder: None, ("--again",), {"K02", "K12"}),
        (lambda folder: None, ("--size", "9"), {"K02", "K12"}),
        (lambda folder: None, ("--profile", "GEFORCE_3"), {"K02", "K12"}),
        (lambda folder: None, ("--png", "png"), {"K02", "K12"}),
        (lambda folder: (folder / "K02.json").unlink(), (), {"K02"}),
        (lambda folder: (folder / "K02.json").write_text("[]"), (), {"K02"}),
        (lambda folder: (folder / "records" / "K12.js").unlink(), (), {"K12"}),
        (spoil_picture, (), None),
    ],
)
def test_what_changed_or_is_not_whole_is_drawn_again(drawn, monkeypatch, spoil, arguments, again):
    folder, _ = drawn
    expected = contents(folder)
    spoil(folder)
    monkeypatch.chdir(folder.parent)
    said = run("figures", "K02", "K12", *SMALL, "--jobs", 1, "--out", folder, *arguments).stderr
    written = {line.split(":")[0] for line in said.splitlines() if line.endswith(": writing")}
    assert written == again if again else written
    if not arguments:
        assert contents(folder) == expected


def test_a_check_that_failed_before_fails_again_without_being_drawn(drawn):
    folder, _ = drawn
    run("figures", "K12", *SMALL, "--check", "--out", folder)
    path = folder / "K12.json"
    record = json.loads(path.read_text())
    record["machines"][0]["checks"][0]["passed"] = False
    path.write_text(json.dumps(record))
    again = run("figures", "K12", *SMALL, "--check", "--out", folder, status=1)
    assert "did not change" in again.stderr and "1 acceptance check failed" in again.stderr


def inputs(figure, *what):
    figure_inputs._digest_of_file.cache_clear()
    source_digests.forget()
    return figure_inputs.inputs_of(FIGURES.module_of(figure), what)


@pytest.mark.parametrize(
    ("edited", "changed"),
    [
        ("effects/figures/kautz_seidel_2000/k12_normalization_cube_map.py", {"K12"}),
        ("effects/bump_mapping/normalization_cube_map.py", {"K12"}),
        ("effects/shadows/shadow_volumes.py", set()),
        ("effects/reports/gallery/page.py", set()),
        ("effects/geometry/matrices.py", {"K02", "K12"}),
        ("effects/reports/pictures.py", {"K02", "K12"}),
        ("effects/__init__.py", {"K02", "K12"}),
        ("effects/bibliography.bib", {"K02", "K12"}),
        ("effects/studies/studies.toml", set()),
        ("effects/reports/gallery/gallery.css", set()),
        ("pipeline/opengl/queries.py", set()),
        ("pipeline/traces/decoding.py", set()),
        ("pipeline/ideal/evaluate.py", {"K02", "K12"}),
        ("raster/portable/draw.py", {"K02", "K12"}),
    ],
)
def test_an_edit_changes_the_inputs_of_what_may_depend_on_it(monkeypatch, edited, changed):
    before = {figure: inputs(figure, 8) for figure in ("K02", "K12")}
    read, root = Path.read_bytes, Path(figure_inputs.__file__).parents[2]
    assert (root / edited).is_file()

    def changed_file(path):
        return read(path) + b"\n# more\n" * (path == root / edited)

    monkeypatch.setattr(Path, "read_bytes", changed_file)
    assert {figure for figure in before if inputs(figure, 8) != before[figure]} == changed
    assert inputs("K02", 9) != inputs("K02", 8)
    # What was read of the changed file must not stay for the tests after this one.
    monkeypatch.undo()
    assert inputs("K02", 8) == before["K02"]


def test_a_reference_that_another_run_computed_is_not_computed_again(tmp_path, monkeypatch):
    """Until a source that it follows from is edited; the files are the same to the byte."""
    monkeypatch.setattr("fixedpipe.raster.kernel_folder.results_folder", lambda: tmp_path / "results")
    asked = []
    computed = Figure.reference_picture

    def counted(figure, *given, **changes):
        asked.append(figure.id)
        return computed(figure, *given, **changes)

    monkeypatch.setattr(Figure, "reference_picture", counted)
    order = "figures", "F003-21", "--profile", "NV2A", "--size", 8, "--jobs", 1, "--out"
    run(*order, tmp_path / "one")
    assert asked == ["F003-21"]
    run(*order, tmp_path / "two")
    assert asked == ["F003-21"]
    assert contents(tmp_path / "one") == contents(tmp_path / "two")
    monkeypatch.setattr(computed_once, "digest_of", lambda modules: "edited")
    run(*order, tmp_path / "three")
    assert asked == ["F003-21"] * 2


def test_what_a_data_file_says_of_a_figure_is_among_the_inputs_of_that_figure_alone(monkeypatch):
    before = {figure: inputs(figure, 8) for figure in ("K02", "K12")}
    read = data_files.sections_of

    def changed(path):
        line, own, checks = read(path)["K12"]
        return {**read(path), "K12": (line + 1, own, checks + "# more\n")}

    monkeypatch.setattr(data_files, "sections_of", changed)
    assert {figure for figure in before if inputs(figure, 8) != before[figure]} == {"K12"}


LARGE = [pytest.param(figure, marks=pytest.mark.slow) for figure in ("F001-12", "H30")]


@pytest.mark.parametrize("figure", ["K12", "F004-4", *LARGE])
def test_the_modules_that_drawing_imports_are_among_the_inputs(figure, tmp_path):
    """A process that draws it, and has imported nothing else, has no module that is not there."""
    code = (
        "import sys\n"
        "from fixedpipe.effects.figures import FIGURES\n"
        "from fixedpipe.effects.reports.figure_record import render\n"
        f"figure = FIGURES[{figure!r}]\n"
        "render(figure, figure.machines[:1], 16, 1, False, lambda text: None)\n"
        "names = (n for n, m in sys.modules.items() if not hasattr(m, '__path__'))\n"
        "print(*(name for name in names if name.startswith('fixedpipe.')))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    counted = source_digests.reached((FIGURES.module_of(figure), *figure_inputs.DRAWS))
    assert set(done.stdout.split()) <= counted


# --------------------------------------------------------------------------------------------- processes


def test_two_processes_write_what_one_writes(drawn, tmp_path):
    folder, _ = drawn
    both = run("figures", "K02", "K12", *SMALL, "--jobs", 2, "--out", tmp_path / "both")
    assert "in 2 processes" in both.stderr
    assert {line for line in both.stderr.splitlines() if line.endswith(": writing")} == {
        "K02: writing",
        "K12: writing",
    }
    assert contents(tmp_path / "both") == contents(folder)


@pytest.mark.parametrize("jobs", [1, 3])
@pytest.mark.parametrize("checked", [False, True])
@pytest.mark.parametrize("ready", [(), ("portable",), ("portable", "vector")])
def test_other_processes_compile_what_the_first_figure_does_not_wait_for(
    tmp_path, monkeypatch, jobs, checked, ready
):
    given = []

    class Pool:
        def __init__(self, *_, **begin):
            pass

        def submit(self, function, what):
            given.append((function.__name__, getattr(what, "id", what)))
            done = Future()
            done.set_result(({"id": given[-1][-1]}, 1.0))
            return done

        def shutdown(self, **_):
            pass

    monkeypatch.setattr(figure_pool.background_compiling, "is_ready", ready.__contains__)
    monkeypatch.setattr(figure_pool, "Processes", Pool)
    orders = [figure_pool.Order(i, (), 8, 1, checked, tmp_path, None, None) for i in ("K02", "K12")]
    drawn = list(figure_pool.draw_all(orders, jobs, 1, print, print))
    assert sorted((order.id, record["id"]) for order, record, _ in drawn) == [("K02", "K02"), ("K12", "K12")]
    missing = [engine for engine in ("vector", "portable") if engine not in ready and jobs > 1]
    first, *others, last = given
    assert first == ("_draw_at_once" if missing else "_draw", "K02") and last == ("_draw", "K12")
    assert others == [("make_ready", engine) for engine in missing]


# What is not compiled draws the figure; its checks, in their own sizes, take that long.
@pytest.mark.parametrize("checked", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_the_first_figure_waits_for_no_compiler(tmp_path, monkeypatch, checked):
    monkeypatch.setattr(figure_pool.background_compiling, "is_ready", lambda engine: False)
    monkeypatch.setattr(Prepared, "bands", lambda *_: pytest.fail("it was drawn by the portable engine"))
    monkeypatch.setattr(queue, "draw_frame", lambda *_: pytest.fail("it was drawn by the vector engine"))
    monkeypatch.setattr(figure_pool, "_SAID", SimpleQueue())
    order = figure_pool.Order("K12", ("GEFORCE_256",), 8, 1, checked, tmp_path, None, None)
    assert figure_pool._draw_at_once(order)[0]["id"] == "K12"


# ------------------------------------------------------------------------------------------------- rounds


@pytest.fixture
def two_figures(monkeypatch):
    """F003-7, and F003-21, which has a reference, are all figures that there are."""
    figures = Few({name: FIGURES[name] for name in ("F003-21", "F003-7")})
    monkeypatch.setattr("fixedpipe.effects.figures.FIGURES", figures)


ALL = "figures", "--size", "8", "--jobs", 1, "--out"


def seen_records(monkeypatch, folder):
    """What records are in a folder whenever its page is written: [{id: its machines}], a list that grows."""
    from fixedpipe.effects.reports import figure_files

    seen, write = [], figure_files.write_page

    def look(folder, figures):
        there = (json.loads(path.read_bytes()) for path in sorted(folder.glob("*.json")))
        seen.append({record["id"]: [one["profile"] for one in record["machines"]] for record in there})
        write(folder, figures)

    monkeypatch.setattr(figure_files, "write_page", look)
    return seen


def test_of_all_figures_each_has_a_picture_before_any_has_all(two_figures, monkeypatch, tmp_path):
    seen = seen_records(monkeypatch, tmp_path)
    said = run(*ALL, tmp_path, "--check").stderr
    machines = {name: list(FIGURES[name].machines) for name in ("F003-21", "F003-7")}
    first = {name: names[:1] for name, names in machines.items()}
    assert seen[1] == first and seen[-1] == machines
    assert "has a picture of every figure. What else was asked for goes on" in said
    record = json.loads((tmp_path / "F003-21.json").read_bytes())
    assert all("reference" in one["pictures"] and one["checks"] for one in record["machines"])
    # Named, they are drawn in one round; the files are the same to the byte.
    run("figures", "F003-21", "F003-7", *ALL[1:], tmp_path / "named", "--check")
    named = contents(tmp_path / "named")
    both = contents(tmp_path)
    for path in named.keys() - {Path("index.html")}:
        assert both[path] == named[path]


def test_a_first_round_that_was_made_is_not_made_again(two_figures, monkeypatch, tmp_path):
    draw, drawn = figure_pool.Order.draw, []

    def interrupted(order, *how):
        if not order.is_first:
            raise KeyboardInterrupt
        return draw(order, *how)

    monkeypatch.setattr(figure_pool.Order, "draw", interrupted)
    CliRunner().invoke(main, [*map(str, ALL), str(tmp_path)])
    kept = [json.loads((tmp_path / f"{name}.json").read_bytes()) for name in ("F003-21", "F003-7")]
    assert [len(record["machines"]) for record in kept] == [1, 1]
    assert not any("flip" in record["machines"][0]["difference"] for record in kept)  # it takes seconds

    def counted(order, *how):
        drawn.append((order.id, order.is_first))
        return draw(order, *how)

    monkeypatch.setattr(figure_pool.Order, "draw", counted)
    run(*ALL, tmp_path)
    assert sorted(drawn) == [("F003-21", False), ("F003-7", False)]
    whole = json.loads((tmp_path / "F003-21.json").read_bytes())["machines"][0]
    assert ("flip" in whole["difference"]) == (perceived.flip_evaluator is not None)
    drawn.clear()
    run(*ALL, tmp_path)
    assert not drawn


def test_a_figure_is_drawn_by_one_process_at_a_time():
    tasks = deque((None, None, order_of(name, None)) for name in ("K02", "K12", "K02"))
    tasks.append((None, "vector", None))
    taken = [figure_pool._next(tasks, {"K02"}) for _ in range(3)]
    assert [task and (task[2].id if task[2] else task[1]) for task in taken] == ["K12", "vector", None]
    assert [task[2].id for task in tasks] == ["K02", "K02"]


def test_on_a_disc_that_fills_in_the_second_round_the_rest_is_said(two_figures, monkeypatch, tmp_path):
    draw = figure_pool.Order.draw

    def full(order, *how):
        if order.is_first:
            return draw(order, *how)
        return order.failed(OSError(errno.ENOSPC, "full"))

    monkeypatch.setattr(figure_pool.Order, "draw", full)
    lines = run(*ALL, tmp_path, status=1).stderr.splitlines()[-2:]
    assert sum(line.endswith(": not begun, because the disc is full") for line in lines) == 1


def test_a_record_that_cannot_be_written_is_said_and_the_others_are(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "K12.json").mkdir()
    done = run("figures", "K02", "K12", *SMALL, "--jobs", 2, "--out", tmp_path / "out", status=1)
    assert re.fullmatch(r"K12: Not drawn: .*K12\.json cannot be written: .*", done.stderr.splitlines()[-1])
    assert (tmp_path / "out" / "K02.json").is_file()


def order_of(identifier, folder):
    return figure_pool.Order(identifier, ("GEFORCE_256",), 8, 1, False, folder, None, None)


def exits(order):
    os._exit(3)


def is_killed(order):
    os.kill(os.getpid(), signal.SIGKILL)


def is_told_to_end(order):
    os.kill(os.getpid(), signal.SIGTERM)


# However it ends, the pool is told the same; each way on each number of processes is proved where all is.
ENDS = [
    pytest.param(end, jobs, marks=slow_unless((end, jobs) in ((is_killed, 1), (exits, 2))))
    for end in (exits, is_killed, is_told_to_end)
    for jobs in (1, 2)
]


@pytest.mark.parametrize(("end", "jobs"), ENDS)
def test_a_process_that_ends_by_itself_fails_its_own_figure_alone(tmp_path, monkeypatch, end, jobs):
    orders = [order_of(identifier, tmp_path) for identifier in ("K02", "K12", "K14", "K04")]

    def tasks(orders, jobs):
        return deque((end if order.id == "K12" else figure_pool._draw, order, order) for order in orders)

    monkeypatch.setattr(figure_pool, "_tasks", tasks)
    records = {order.id: record for order, record, _ in figure_pool.draw_all(orders, jobs, 1, print, print)}
    assert records.keys() == {"K02", "K12", "K14", "K04"}
    (failed,) = records["K12"].pop("failures")
    assert re.search(r"ended by itself.*fixedpipe figures K12 --jobs 1", failed["what"])
    assert not records["K12"]["machines"] and (tmp_path / "K12.json").is_file()
    assert all(records[name]["machines"] and not records[name]["failures"] for name in ("K02", "K14", "K04"))


def no_room(path, data):
    try:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    except OSError as error:
        raise Refusal(f"{path} cannot be written: {error.strerror}.") from error


def test_on_a_full_disc_no_other_figure_is_begun_and_what_is_drawn_stays(drawn, monkeypatch):
    folder, _ = drawn
    before = contents(folder)
    monkeypatch.setattr("fixedpipe.effects.reports.figure_files.write_whole", no_room)
    done = run("figures", "K14", "K04", "K02", *SMALL, "--jobs", 1, "--out", folder, status=1)
    first, *others = done.stderr.splitlines()[-4:]
    assert first == "1 of 3 figures are whole. What failed:"
    assert re.fullmatch(r"K14: Not drawn: .* cannot be written: No space left on device\.", others[0])
    assert others[1] == "K04: not begun, because the disc is full"
    assert others[2].endswith("index.html cannot be written: No space left on device.")
    assert contents(folder) == before


def full_after_the_first(order):
    return (order.failed(OSError(errno.ENOSPC, "full")) if order.id == "K12" else order.draw(print)), 1.0


def test_processes_begin_no_other_figure_on_a_full_disc(tmp_path, monkeypatch):
    orders = [order_of(identifier, tmp_path) for identifier in ("K02", "K12", "K14", "K04")]

    def tasks(orders, jobs):
        return deque((full_after_the_first, order, order) for order in orders)

    monkeypatch.setattr(figure_pool, "_tasks", tasks)
    assert [order.id for order, *_ in figure_pool.draw_all(orders, 1, 1, print, print)] == ["K02", "K12"]


def interrupted(folder, interrupt):
    """The exit status of the command that draws all figures, and what was said after ``interrupt(process)``
    was called, as soon as a process of its own said that it draws, until all that write to its standard error
    had ended.

    All figures, so that it has not ended however late the interrupt comes. Where these tests themselves
    ignore interrupts, as what a shell runs in the background does, the command would too, if it did not begin
    by not ignoring them.
    """
    heeding = (
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
        "from fixedpipe.effects.cli import main; main()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", heeding, "figures", "--out", str(folder), "--jobs", "2"],
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        for line in process.stderr:
            if re.match(r"\S+: on ", line):
                break
        interrupt(process)
        said = process.stderr.read()  # to its end: none is left that has it
    return process.returncode, said


def test_ctrl_c_leaves_no_process_and_no_half_file(tmp_path):
    status, said = interrupted(tmp_path, lambda process: os.killpg(process.pid, signal.SIGINT))
    assert status == 130 and said.endswith("fixedpipe: interrupted.\n") and "Traceback" not in said
    assert not list(tmp_path.rglob(".*"))
    for record in tmp_path.glob("*.json"):
        json.loads(record.read_text())


def test_a_command_that_is_killed_leaves_no_process(tmp_path):
    assert interrupted(tmp_path, lambda process: process.kill())[0] == -signal.SIGKILL


def test_the_cheapest_figure_is_first_and_then_the_longest():
    some = [FIGURES[name] for name in ("K12", "F004-6", "F000-1", "F000-5")]
    assert [figure.id for figure in longest_after_the_first(some)] == ["F000-1", "F004-6", "F000-5", "K12"]
    assert SECONDS["F004-6"] > SECONDS["F000-5"] > SECONDS["K12"] > SECONDS["F000-1"]
