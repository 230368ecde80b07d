"""The command line: what it writes, and that what cannot be done ends with one sentence and exit status 2."""

import csv
import json
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

import fixedpipe.effects.figures
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.cli import _COMMANDS, main
from fixedpipe.effects.cli.precision import CLAMPS
from fixedpipe.effects.figures import FIGURES, Method
from fixedpipe.effects.figures.costs import SECONDS
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports import files
from fixedpipe.effects.reports.files import writable_file, write_whole
from fixedpipe.effects.reports.gallery import pages
from fixedpipe.effects.technique import INDEX
from fixedpipe.effects.user_pictures import bumped_mesh, inputs
from fixedpipe.effects.user_pictures.bumped_mesh import MATERIALS, MESHES, machines_with
from fixedpipe.pipeline.enums import Clamp
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.golden.digests import digest
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.native.threads import default_threads
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, PROFILES
from fixedpipe.pipeline.profiles.known import EVIDENCE_TAGS
from fixedpipe.pipeline.profiles.sections import SECTION_OF, SECTIONS
from fixedpipe.raster.kernel import CACHE_FOLDER
from tests.effects.reports import kept
from tests.support.few_figures import Few

ROOT = Path(__file__).parents[3]
COLUMNS = {"COLUMNS": "200"}


def run(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments], env=COLUMNS)


def refusal_of(*arguments):
    """The sentence on stderr of a command that must be refused."""
    result = run(*arguments)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    sentence = result.stderr.strip().splitlines()[-1]
    assert sentence.startswith("fixedpipe: ")
    return sentence


@pytest.fixture
def photo(tmp_path):
    """A small PNG with hills in it."""
    x = np.arange(16)
    hills = ((x[:, None] * 5 + x[None, :] * 11) % 23 * 11).astype(np.uint8)
    path = tmp_path / "hills.png"
    Image.fromarray(hills).save(path)
    return path


def bump(photo, out, *more):
    return ("bump", photo, "--out", out, "--size", 24, "--mesh", "plane", "--light", "1,2,3", *more)


# ----------------------------------------------------------------------------------------- start and help


def test_without_arguments_it_says_what_to_do_next():
    result = run()
    assert result.exit_code == 0
    assert "fixedpipe figures" in result.stdout


def test_help_names_every_subcommand():
    result = run("--help")
    for name in _COMMANDS:
        assert name in result.stdout
        assert run(name, "--help").exit_code == 0


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        *([name, "--help"] for name in ("figures", "bump", "shadows", "conformance", "combiners", "study")),
        [],
    ],
)
def test_help_imports_no_array_library_and_no_compiler(arguments):
    code = (
        "import sys\nfrom fixedpipe.effects.cli import main\n"
        f"main({arguments}, standalone_mode=False)\n"
        "print([m for m in ('numpy', 'numba', 'rich', 'PIL', 'imageio') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip().endswith("[]")


def test_an_unknown_subcommand_ends_with_status_2():
    assert run("render").exit_code == 2


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("parametres",), "fixedpipe: There is no command 'parametres'. Did you mean parameters?"),
        (("--fast",), "fixedpipe: No such option '--fast'."),
        (("bump",), "fixedpipe: Missing argument 'PHOTO'."),
        (("bump", "a.png", "--size", "0", "--out", "b.png"), "fixedpipe: Invalid value for '--size'"),
        (("bump", "a.txt", "--out", "b.png"), "fixedpipe: There is no file 'a.txt'."),
    ],
)
def test_every_refusal_begins_with_one_prefix(arguments, sentence):
    result = run(*arguments)
    assert result.exit_code == 2
    assert result.stderr.splitlines()[-1].startswith(sentence)
    assert "Error" not in result.stderr and result.stdout == ""


RC, PS = "!!RC1.0\n{ rgb { spare0 = col0; } }\nout.rgb = spare0;\n", "ps.1.1\ntex t0\nmov r0, t0\n"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("figures", "--list", "K12"), "leave ID|FILE.py out"),
        (("figures", "--list", "--check", "--json", "a.json"), "leave --check and --json out"),
        (("conformance", "--list", "folder"), "leave FOLDER out"),
        (("study", "--json", "a.json"), "--json would be ignored"),
        (("study", "--out", "a", "--profile", "NV2A"), "--profile and --out would be ignored"),
        (("combiners", "rc.txt", "--target", "1=TEXTURE_CUBE_MAP"), "--target would be ignored"),
        (
            ("combiners", "ps.txt", "--target", "0=TEXTURE_CUBE_MAP", "--target", "0=TEXTURE_2D"),
            "gives unit 0 two targets",
        ),
    ],
)
def test_what_would_be_ignored_is_refused(tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rc.txt").write_text(RC)
    (tmp_path / "ps.txt").write_text(PS)
    assert words in refusal_of(*arguments)
    assert {path.name for path in tmp_path.iterdir()} == {"rc.txt", "ps.txt"}


def test_options_that_are_looked_at_are_not_refused(tmp_path):
    (tmp_path / "ps.txt").write_text(PS)
    twice = ("--target", "0=TEXTURE_CUBE_MAP") * 2
    assert run("combiners", tmp_path / "ps.txt", *twice).exit_code == 0


# ------------------------------------------------------------------------------------------------ figures


def test_the_list_names_every_figure():
    result = run("figures", "--list")
    assert INDEX in result.stderr
    assert [line.split()[0] for line in result.stdout.splitlines()[::2]] == list(FIGURES)


def test_a_figure_is_written_with_a_record_pictures_and_a_gallery(tmp_path):
    results, out = tmp_path / "results.json", tmp_path / "out"
    arguments = "F004-4", "--profile", "GEFORCE_256", "--size", 20, "--out", out, "--json", results
    result = run("figures", *arguments)
    assert result.exit_code == 0, result.output
    assert {path.name for path in out.iterdir()} == {
        *("F004-4.json", "index.html", "plain.html", "catalogue", "pictures", "records"),
    }
    size = sum(path.stat().st_size for path in out.rglob("*") if path.is_file())
    assert result.stdout.endswith(f"1 figure in {out}, {size / 1e6:.1f} MB; open {out / 'index.html'}\n")

    record = kept.record(out, "F004-4")
    assert json.loads(results.read_text()) == [record]
    figure = FIGURES["F004-4"]
    color = execute(figure.commands(GEFORCE_256, 20), GEFORCE_256, 40, 20).framebuffer.color
    (drawn,) = record["machines"]
    assert drawn["sha256"] == digest(color)
    assert (drawn["profile"], record["width"], record["height"]) == ("GEFORCE_256", 40, 20)
    assert {"caption", "source", "parameters"} <= record.keys() and "provenance" in drawn
    np.testing.assert_array_equal(kept.codes(out, drawn["pictures"]["machine"]), color[..., :3])

    page = (out / "index.html").read_text() + (out / "plain.html").read_text()
    assert "F004-4.json" in page and drawn["pictures"]["machine"]["digest"] in page
    assert 'src="http' not in page
    assert str(tmp_path) not in page + (out / "F004-4.json").read_text()


def test_kernels_in_the_cache_are_read_without_what_compiles(tmp_path):
    code = f"""
import sys
from fixedpipe.effects.cli import main
arguments = ["F004-4", "--profile", "GEFORCE_256", "--size", "8", "--out", {str(tmp_path)!r}]
main(["figures", *arguments], standalone_mode=False)
print("numba.np.arraymath" in sys.modules)
"""
    # A cache of its own, in which no other process writes at the same time: one that does may undo what the
    # first of the two adds.
    written = shutil.ignore_patterns("*.tmp.*")  # as Numba calls a file that is not whole yet
    shutil.copytree(CACHE_FOLDER, tmp_path / "kernels" / CACHE_FOLDER.name, ignore=written)
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    outputs = [
        subprocess.run(
            [sys.executable, "-c", code],
            cwd=ROOT,
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for _ in range(2)  # the first may have to compile
    ]
    assert outputs[1].splitlines()[-1] == "False"


def test_the_difference_is_middle_grey_where_machine_and_ideal_are_equal(tmp_path):
    arguments = "F004-4", "--profile", "GEFORCE_256", "--size", 24
    assert run("figures", *arguments, "--out", tmp_path / "out", "--png", tmp_path).exit_code == 0
    machine, ideal, difference = (
        np.asarray(Image.open(tmp_path / f"F004-4-GEFORCE_256{view}.png")).astype(int)
        for view in ("", "-ideal", "-difference")
    )
    background = (machine == machine[0, 0]).all(axis=-1) & (ideal == machine[0, 0]).all(axis=-1)
    assert background.any()
    assert (difference[background] == 128).all()
    assert ((difference < 128) == (machine < ideal)).all() and ((difference > 128) == (machine > ideal)).all()


def test_any_number_of_threads_gives_the_same_record(tmp_path):
    records = []
    for threads in (1, 2):
        assert run("figures", "K02", "--size", 130, "--out", tmp_path, "--threads", threads).exit_code == 0
        records.append(json.loads((tmp_path / "K02.json").read_text()))
    assert records[0] == records[1]


def with_check(monkeypatch, value):
    """Give K12 one cheap acceptance check, ``value`` <= 0.5."""
    check = Check("a measured thing", value, at_most=0.5, on=Answer.MACHINE, reason="half is enough")
    figure = replace(
        FIGURES["K12"],
        methods=(Method("register combiners", FIGURES["K12"].methods[0].scene, ("GEFORCE_256",)),),
        parts=(),
        acceptance=lambda figure, renderer: (check,),
    )
    monkeypatch.setattr("fixedpipe.effects.figures.FIGURES", Few({**FIGURES, "K12": figure}))


@pytest.mark.parametrize(
    ("value", "status", "verdict"), [(0.25, 0, "ok"), (0.75, 1, "FAILED"), (float("nan"), 1, "FAILED")]
)
def test_a_failed_check_is_printed_with_its_bound_and_sets_exit_status_1(
    tmp_path, monkeypatch, value, status, verdict
):
    with_check(monkeypatch, value)
    result = run("figures", "K12", "--check", "--size", 16, "--out", tmp_path)
    assert result.exit_code == status
    line = next(line for line in result.stdout.splitlines() if "a measured thing" in line)
    assert line.split()[1] == verdict
    assert f"{value:.4g} <= 0.5" in line and "half is enough" in line
    assert "a measured thing" in (tmp_path / "plain.html").read_text()


def test_checks_that_raise_are_said_and_the_other_figures_are_drawn(tmp_path, monkeypatch):
    with_check(monkeypatch, 0.25)
    broken = replace(FIGURES["K02"], acceptance=lambda figure, renderer: {}["no such panel"])
    monkeypatch.setattr(
        "fixedpipe.effects.figures.FIGURES", Few(K02=broken, K12=fixedpipe.effects.figures.FIGURES["K12"])
    )
    result = run(
        "figures", "--check", "--profile", "GEFORCE_256", "--size", 16, "--jobs", 1, "--out", tmp_path
    )
    assert result.exit_code == 1
    assert "1 acceptance check passed" in result.stdout
    assert result.stderr.splitlines()[-2:] == [
        "1 of 2 figures are whole. What failed:",
        "K02: Not checked on the GeForce 256: KeyError: 'no such panel'",
    ]
    assert {path.name for path in tmp_path.glob("*.json")} == {"K02.json", "K12.json"}
    record = json.loads((tmp_path / "K02.json").read_text())
    assert len(record["machines"]) == 1 and "no such panel" in record["failures"][0]["trace"]
    assert not any("<=" in line for line in result.stdout.splitlines())  # what passed is not printed


def test_a_check_that_failed_is_shown_though_another_machine_drew_the_same_bits(tmp_path, monkeypatch):
    def acceptance(figure, renderer):
        value = float(renderer.profile is PROFILES["NV2A"])
        return (Check("not on the NV2A", value, at_most=0.5, on=Answer.MACHINE, reason="it is another"),)

    methods = (Method("twice the same", FIGURES["K12"].methods[0].scene, ("GEFORCE_3", "NV2A")),)
    figure = replace(FIGURES["K12"], methods=methods, parts=(), acceptance=acceptance)
    monkeypatch.setattr("fixedpipe.effects.figures.FIGURES", Few(K12=figure))
    assert run("figures", "--check", "--size", 16, "--out", tmp_path).exit_code == 1
    page = (tmp_path / "plain.html").read_text()
    assert "NV2A (NV2A): the same bits as GeForce 3." in page
    assert "1 of 2 acceptance checks failed" in page and "<td>NV2A</td>" in page


def few_figures(monkeypatch, seconds):
    """K02, K12 and F004-7 are all figures that there are, with these costs."""
    monkeypatch.setattr(
        "fixedpipe.effects.figures.FIGURES", Few({name: FIGURES[name] for name in ("F004-7", "K02", "K12")})
    )
    monkeypatch.setattr("fixedpipe.effects.figures.costs.SECONDS", seconds)


def test_the_cheapest_figure_is_drawn_first_and_one_of_unknown_cost_last(tmp_path, monkeypatch):
    few_figures(monkeypatch, {"K02": 7.0, "K12": 3.0})
    results = tmp_path / "results.json"
    arguments = (
        "--profile",
        "GEFORCE_3",
        "--size",
        8,
        "--jobs",
        1,
        "--out",
        tmp_path / "out",
        "--json",
        results,
    )
    result = run("figures", *arguments)
    drawn = [line.split(":")[0] for line in result.stderr.splitlines() if ": writing" in line]
    assert drawn == ["K12", "K02", "F004-7"]
    assert [record["id"] for record in json.loads(results.read_text())] == ["F004-7", "K02", "K12"]


def test_a_figure_that_fails_is_said_and_all_others_are_drawn(tmp_path, monkeypatch):
    def refused(*arguments, **parameters):
        raise ValueError("no more")

    few_figures(monkeypatch, {"K02": 1.0, "K12": 3.0})
    own = FIGURES["K02"].methods[0]
    methods = replace(own, machines=("GEFORCE_256",)), Method("never", refused, ("GEFORCE_3",))
    monkeypatch.setitem(fixedpipe.effects.figures.FIGURES, "K02", replace(FIGURES["K02"], methods=methods))
    machines = "--profile", "GEFORCE_256", "--profile", "GEFORCE_3"
    for again in range(2):  # what failed is drawn again
        result = run("figures", *machines, "--size", 8, "--jobs", 1, "--out", tmp_path)
        assert result.exit_code == 1
        assert "K02: on the GeForce 3" in result.stderr
        assert ("K12: on the GeForce 3" in result.stderr) is (again == 0)
        assert result.stderr.splitlines()[-2:] == [
            "2 of 3 figures are whole. What failed:",
            "K02: Not drawn on the GeForce 3: no more",
        ]
        record = json.loads((tmp_path / "K02.json").read_text())
        assert [m["profile"] for m in record["machines"]] == ["GEFORCE_256"]
        assert record["failures"] == [
            {
                "profile": "GEFORCE_3",
                "name": "GeForce 3",
                "task": "drawn",
                "what": "no more",
                "trace": None,
                "full_disc": False,
            }
        ]
        page = (tmp_path / "plain.html").read_text()
        assert 'id="K12"' in page and 'id="K02"' in page and "Not drawn on the GeForce 3: no more" in page


def test_the_paper_s_machine_and_another_are_drawn_where_they_can(tmp_path, monkeypatch):
    few = Few({name: FIGURES[name] for name in ("F004-7", "K12")})
    monkeypatch.setattr("fixedpipe.effects.figures.FIGURES", few)
    machines = "--profile", "paper", "--profile", "NV2A"
    assert run("figures", *machines, "--size", 8, "--jobs", 1, "--out", tmp_path).exit_code == 0
    for name, figure in few.items():
        record = kept.record(tmp_path, name)
        others = ["NV2A"] * ("NV2A" in figure.machines)
        assert [m["profile"] for m in record["machines"]] == [figure.machines[0], *others]
        words = shlex.split(record["command"])
        assert [words[i + 1] for i, word in enumerate(words) if word == "--profile"] == [
            m["profile"] for m in record["machines"]
        ]
    assert "K12 cannot be drawn on TEXRAM" in refusal_of(
        "figures", "K12", "--profile", "TEXRAM", "--out", tmp_path
    )


@pytest.mark.parametrize(
    ("seconds", "arguments", "plan"),
    [
        (
            {"K02": 100.0, "K12": 50.0},
            ("--check",),
            "checks, the cheapest first: about 2 minutes on one core",
        ),
        ({"K02": 100.0, "K12": 50.0}, (), ", the cheapest first: less than 2 minutes on one core"),
        ({"K02": 10.0, "K12": 5.5}, ("--check",), "about 16 seconds on one core"),
        ({"K02": 100.0}, ("--check",), "with acceptance checks, the cheapest first.\n"),
        ({"K02": 100.0, "K12": 50.0}, ("--check", "--size", "8"), "acceptance checks, the cheapest first.\n"),
    ],
)
def test_what_is_coming_is_said_first(tmp_path, monkeypatch, seconds, arguments, plan):
    few_figures(monkeypatch, seconds)
    monkeypatch.setattr("fixedpipe.effects.reports.figure_record.render", stopped)
    said = run("figures", "K02", "K12", *arguments, "--jobs", 1, "--out", tmp_path).stderr
    machines = [FIGURES[name].machines for name in ("K02", "K12")]
    different, drawings = len({*machines[0], *machines[1]}), len(machines[0]) + len(machines[1])
    assert f"2 figures on {different} machines, {drawings} drawings" in said
    assert plan in said


def stopped(*arguments):
    raise Refusal("stopped")


def test_costs_are_of_figures_that_there_are():
    assert SECONDS.keys() == FIGURES.keys()


def test_the_gallery_keeps_figures_of_earlier_runs(tmp_path):
    for figure in ("K12", "K02"):
        assert run("figures", figure, "--size", 8, "--out", tmp_path).exit_code == 0
    page = (tmp_path / "plain.html").read_text()
    assert page.index('id="K02"') < page.index('id="K12"')


def test_a_damaged_record_is_refused_by_name(tmp_path):
    (tmp_path / "K02.json").write_text('{"id": "K02"}')
    with pytest.raises(Refusal, match=r"K02\.json is not what fixedpipe wrote"):
        pages(tmp_path, FIGURES)


@pytest.mark.parametrize(
    ("name", "words"), [("F004-33", "Did you mean F004-3?"), ("x", f"F000-3 and {len(FIGURES) - 3} more.")]
)
def test_an_unknown_figure_is_refused_in_a_line(tmp_path, name, words):
    sentence = refusal_of("figures", name, "--out", tmp_path / "out")
    assert name in sentence and words in sentence and len(sentence) < 100
    assert not (tmp_path / "out").exists()


def test_an_unknown_profile_is_refused_with_the_names_there_are(tmp_path):
    sentence = refusal_of("figures", "K12", "--profile", "VOODOO", "--out", tmp_path)
    assert all(name in sentence for name in PROFILES)


def test_the_ideal_draws_every_figure_once_and_is_compared_with_nothing(tmp_path, monkeypatch):
    few = Few({name: FIGURES[name] for name in ("F004-7", "K12")})
    monkeypatch.setattr("fixedpipe.effects.figures.FIGURES", few)
    assert run("figures", "--profile", "IDEAL", "--size", 16, "--jobs", 1, "--out", tmp_path).exit_code == 0
    ideal = execute_ideal(few["K12"].commands(IDEAL, 16), *few["K12"].dimensions(16)).image()
    (drawn,) = kept.record(tmp_path, "K12")["machines"]
    assert (drawn["profile"], drawn["sha256"], drawn["difference"]) == ("IDEAL", digest(ideal), None)
    assert drawn["pictures"].keys() == {"machine"} and drawn["passes"] == []
    np.testing.assert_array_equal(kept.codes(tmp_path, drawn["pictures"]["machine"]), ideal[..., :3])
    assert all(f"{name}.json" in (tmp_path / "plain.html").read_text() for name in few)
    sentence = refusal_of("figures", "K12", "--check", "--profile", "IDEAL", "--out", tmp_path)
    assert "compares machines with IDEAL" in sentence


@pytest.mark.parametrize(
    "command",
    [
        ("bump", "hills.png", "--mesh", "plane"),
        ("shadows", "mesh.obj"),
        ("volume", "sample:engine", "--slices", 32),
    ],
)
def test_a_user_s_picture_is_drawn_by_the_ideal(photo, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    Path("mesh.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    pictures = []
    for profile in ("IDEAL", "FUTURE"):
        result = run(*command, "--profile", profile, "--size", 24, "--out", "a.png")
        assert result.exit_code == 0, result.output
        pictures.append(np.asarray(Image.open("a.png")).astype(int))
        assert ("by the ideal, in float64" in result.stdout) is (profile == "IDEAL")
    assert len(np.unique(pictures[0])) > 20
    assert np.abs(pictures[0] - pictures[1]).mean() < 3.0


def test_no_message_about_the_ideal_has_a_name_of_python_s(photo, tmp_path):
    result = run("passes", "F004-4", "--profile", "IDEAL", "--size", 16)
    assert result.exit_code == 0 and "diffuse pass" in result.stdout
    for arguments in (("precision", "F004-4"), ("study", "P9")):
        sentence = refusal_of(*arguments, "--profile", "IDEAL")
        assert "IDEAL is no machine" in sentence and "execute_ideal" not in sentence
        assert "IDEAL" not in sentence.split("give one of")[1]
    assert "IDEAL" not in refusal_of("precision", "F004-4", "--profile", "VOODOO")


def test_a_machine_of_all_figures_draws_those_it_can(tmp_path, monkeypatch):
    few = Few({name: FIGURES[name] for name in ("F004-7", "K12")})
    monkeypatch.setattr("fixedpipe.effects.figures.FIGURES", few)
    assert run("figures", "--profile", "TEXRAM", "--size", 8, "--out", tmp_path).exit_code == 0
    assert {path.name for path in tmp_path.glob("*.json")} == {"F004-7.json"}


def test_a_size_that_the_machine_has_no_framebuffer_for_is_refused(tmp_path):
    assert "2048" in refusal_of("figures", "K12", "--size", 5000, "--out", tmp_path / "out")
    assert list((tmp_path / "out").iterdir()) == []


def test_an_output_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "taken").write_text("a file")
    assert "cannot be written to" in refusal_of("figures", "K12", "--out", tmp_path / "taken")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("taken/o.png", "taken cannot be written to"),
        (f"{'n' * 300}.png", "too long"),
        ("a\0b.png", "null byte"),
    ],
)
def test_a_picture_that_cannot_be_written_is_refused_before_it_is_drawn(photo, tmp_path, name, words):
    (tmp_path / "taken").write_text("a file")
    assert words in refusal_of(*bump(photo, tmp_path / name))
    assert {path.name for path in tmp_path.iterdir()} == {"hills.png", "taken"}


@pytest.mark.parametrize("name", ["n" * 251 + ".png", "é" * 125 + ".png", "n." + "b" * 253, ".n" + "n" * 253])
def test_a_name_as_long_as_the_file_system_takes_is_written(tmp_path, name):
    write_whole(writable_file(tmp_path / name), b"all of it")
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [(name, b"all of it")]


@pytest.mark.parametrize("size", ["0", "-5", "x", "1.5"])
def test_a_size_that_is_no_positive_number_ends_with_status_2(photo, tmp_path, size):
    for command in (("figures", "K14", "--out", tmp_path / "out"), bump(photo, tmp_path / "out.png")):
        result = run(*command, "--size", size)
        assert result.exit_code == 2
        assert "--size" in result.stderr
    assert run("figures", "K14", "--threads", "0", "--out", tmp_path / "out").exit_code == 2
    assert [path.name for path in tmp_path.iterdir()] == ["hills.png"]


def test_no_figure_is_drawn_when_one_of_them_is_too_large(tmp_path):
    sentence = refusal_of("figures", "K14", "F004-3", "--size", 700, "--out", tmp_path / "out")
    assert "F004-3" in sentence and "--size 682 or less" in sentence
    assert list((tmp_path / "out").iterdir()) == []


def test_an_interrupted_file_is_not_left_behind(tmp_path, monkeypatch):
    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "chmod", interrupted)
    with pytest.raises(KeyboardInterrupt):
        files.write_whole(tmp_path / "picture.png", b"half")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(
    not hasattr(os, "geteuid") or os.geteuid() == 0, reason="the superuser may write everywhere"
)
def test_an_output_folder_without_permission_is_refused(tmp_path):
    tmp_path.chmod(0o500)
    assert "Permission denied" in refusal_of("figures", "K12", "--out", tmp_path)


def test_a_results_file_that_is_a_folder_is_refused_before_anything_is_rendered(tmp_path):
    assert "is a folder" in refusal_of("figures", "K12", "--out", tmp_path / "out", "--json", tmp_path)
    assert list((tmp_path / "out").iterdir()) == []


def test_a_file_is_written_whole_or_not_at_all(tmp_path, monkeypatch):
    path = tmp_path / "picture.png"
    path.write_bytes(b"before")

    def full(*arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(Refusal, match="No space left"):
        files.write_whole(path, b"after")
    assert path.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [path]


# ------------------------------------------------------------------------------------ passes and profiles


def test_passes_names_every_command_of_a_figure():
    result = run("passes", "F004-2")
    assert result.exit_code == 0
    for command in FIGURES["F004-2"].commands(GEFORCE_256):
        assert command.label in result.stdout


def test_passes_fold_what_is_repeated_for_every_polygon():
    folded = run("passes", "F004-4", "--profile", "OCTANE", "--size", 24).stdout.splitlines()
    assert len(folded) < 200
    again = [line for line in folded if " again, " in line]
    commands = FIGURES["F004-4"].commands(PROFILES["OCTANE"], 24, FIGURES["F004-4"].method("OCTANE"))
    assert re.fullmatch(
        r"5 to \d+\. the 4 commands above again, \d+ times, with other numbers in them", again[0]
    )
    folded_away = sum(
        int(t) * int(p or 1) for line in again for p, t in re.findall(r"the (\d*).* (\d+) times", line)
    )
    titles = [line for line in folded if re.match(r"\d+\. [A-Z]", line)]
    assert len(titles) + folded_away == len(commands)
    assert f" to {len(commands) - 1}. the 2 commands" in again[-1]


def test_passes_of_an_unknown_figure_are_refused_with_the_likely_one():
    assert "Did you mean F004-3?" in refusal_of("passes", "F004-33")
    assert "Did you mean F004-3?" in refusal_of("passes", "f004-3")


@pytest.mark.parametrize("columns", ["80", "120"])
def test_profiles_lists_the_machines_in_lines_that_fit(columns):
    result = CliRunner().invoke(main, ["profiles"], env={"COLUMNS": columns})
    assert result.exit_code == 0
    assert max(map(len, result.stdout.splitlines())) <= int(columns)
    for name, profile in PROFILES.items():
        (line,) = [line for line in result.stdout.splitlines() if line.split()[:1] == [name]]
        assert profile.description.split()[0] in line
        assert f" {profile.textures.max_texture_units} " in line
    assert "fixedpipe profiles NAME" in result.stdout


def test_profiles_of_a_machine_are_whole_lines_where_no_terminal_shows_them():
    lines = run("profiles", "GEFORCE_256").stdout.splitlines()
    (line,) = [line for line in lines if line.strip().startswith("max_cube_map_texture_size:")]
    assert line.endswith("512 (Assumed: 512; a MAX_CUBE_MAP_TEXTURE_SIZE query would settle it)")


def test_profiles_says_what_each_driver_changes_and_how_it_is_known():
    shown = " ".join(run("profiles", "GEFORCE_256", "GEFORCE_3").output.split())
    assert 'Driver "Release 5", June 2000:' in shown
    assert "combine_functions without DOT3_RGB, DOT3_RGBA. Source: ARB_texture_env_combine" in shown
    assert "shadow_functions without NEVER, LESS, EQUAL, GREATER, NOTEQUAL, ALWAYS. Source:" in shown
    assert "depths_as_colors no; texture_shader_operations without TEXTURE_3D" in shown
    assert "depth_texture_modes none; " in shown and "max_3d_texture_size 0; " in shown
    assert 'Driver "a driver of 2002", spring 2002, once ARB_shadow was approved: as below.' in shown
    assert "Driver" not in run("profiles", "OCTANE").output


def test_profiles_shows_every_field_of_every_machine_with_its_tag():
    result = run("profiles", *PROFILES)
    assert result.exit_code == 0
    for name, profile in PROFILES.items():
        assert name in result.stdout
        assert profile.description in result.stdout
    for field in SECTION_OF:
        assert result.stdout.count(field) >= len(PROFILES)
    headings = result.stdout.splitlines()
    for section in SECTIONS:
        assert sum(line.strip() == section.replace("_", " ") for line in headings) == len(PROFILES)
    # Evidence that is the same for every value of a machine is said once.
    tags = sum(result.stdout.count(tag) for tag in EVIDENCE_TAGS)
    said = [{fact.evidence for fact in profile.facts.values()} for profile in PROFILES.values()]
    assert tags >= sum(len(SECTION_OF) if len(values) > 1 else 1 for values in said)
    assert all(
        text in " ".join(result.stdout.split()) for values in said if len(values) == 1 for text in values
    )


# --------------------------------------------------------------------------------------------------- bump


def test_polygons_and_negative_indices_of_an_obj_file_are_read(photo, tmp_path):
    made = []
    for face in ("f 1 2 3 4 5", "f -5 -4 -3 -2 -1"):
        (tmp_path / "mesh.obj").write_text(f"v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv 0 2 0\nv -1 1 0\n{face}\n")
        assert run(*bump(photo, tmp_path / "out.png", "--mesh", tmp_path / "mesh.obj")).exit_code == 0
        made.append((tmp_path / "out.png").read_bytes())
    assert made[0] == made[1]


def test_a_photograph_becomes_a_picture(photo, tmp_path):
    out = tmp_path / "bumpy.png"
    result = run(*bump(photo, out))
    assert result.exit_code == 0, result.output
    with Image.open(out) as picture:
        assert picture.size == (24, 24)
        assert len(np.unique(np.asarray(picture))) > 20
    assert "fragments" in result.stdout


@pytest.mark.parametrize(("material", "ways"), [("stone", bumped_mesh.WAYS), ("gold", bumped_mesh.WAYS[:2])])
def test_every_machine_that_can_draws_the_same_bumps(photo, tmp_path, material, ways):
    pictures, machines = {}, machines_with(*ways)
    assert set(machines) == set(PROFILES) or ways != bumped_mesh.WAYS
    for machine in machines:
        result = run("bump", photo, "--out", tmp_path / "a.png", "--size", 32, "--mesh", "plane",
                     "--profile", machine, "--material", material, "--map-size", 16)  # fmt: skip
        assert result.exit_code == 0, result.output
        way = next(way for way in bumped_mesh.WAYS if machine in machines_with(way))
        assert way.title in result.stdout
        pictures[machine] = np.asarray(Image.open(tmp_path / "a.png")).astype(int)
    for machine, picture in pictures.items():
        # Flat triangles have one halfway vector each; of a plane's neighbours they hardly differ.
        assert np.abs(picture - pictures["IDEAL"]).mean() < 2.5, machine
    assert pictures["IDEAL"].max() > 150


def test_a_machine_that_cannot_draw_is_told_which_can(photo, tmp_path, monkeypatch):
    able = machines_with(*bumped_mesh.WAYS[:2])
    assert {"GEFORCE_256", "GEFORCE_3", "NV2A", "OCTANE", "INFINITE_REALITY", "OPENGL_1_2_IMAGING"} <= {*able}
    more = ("--profile", "G400", "--material", "gold")
    sentence = refusal_of(*bump(photo, tmp_path / "out.png", *more))
    assert "too narrow for the Matrox G400" in sentence and sentence.endswith(f"one of {', '.join(able)}.")
    assert run(*bump(photo, tmp_path / "out.png", *more, "--alpha-x", 0.71, "--alpha-y", 0.71)).exit_code == 0
    monkeypatch.setattr(bumped_mesh, "WAYS", bumped_mesh.WAYS[:2])
    sentence = refusal_of(*bump(photo, tmp_path / "out.png", *more))
    assert "The Matrox G400 cannot draw bumps with a highlight, which takes two general" in sentence
    assert sentence.endswith(f"Give one of {', '.join(able)}.")


def test_a_mesh_of_too_many_flat_triangles_is_refused(photo, tmp_path, monkeypatch):
    monkeypatch.setattr(bumped_mesh, "_MOST_FLAT_TRIANGLES", 100)
    sentence = refusal_of(*bump(photo, tmp_path / "out.png", "--profile", "OCTANE"))
    assert "2048 triangles in front" in sentence and "GEFORCE_3" in sentence


def test_png_tiff_and_npy_of_the_same_heights_give_the_same_picture(photo, tmp_path):
    heights = np.asarray(Image.open(photo))
    np.save(tmp_path / "hills.npy", heights)
    Image.fromarray(heights.astype(np.float32) * 3.5 + 100.0).save(tmp_path / "hills.tiff")
    made = []
    for name in ("hills.png", "hills.npy", "hills.tiff"):
        assert run(*bump(tmp_path / name, tmp_path / "out.png")).exit_code == 0
        made.append((tmp_path / "out.png").read_bytes())
    assert made[0] == made[1] == made[2]


@pytest.mark.parametrize("kind", ["1", "P", "LA", "RGB", "RGBA", "CMYK", "I;16"])
def test_every_kind_of_picture_is_read(photo, tmp_path, kind):
    grey = Image.open(photo)
    picture = (
        Image.fromarray(np.asarray(grey).astype(np.uint16) * 257) if kind == "I;16" else grey.convert(kind)
    )
    path = tmp_path / ("picture.tiff" if kind in ("CMYK", "I;16") else "picture.png")
    picture.save(path)
    result = run(*bump(path, tmp_path / "out.png"))
    assert result.exit_code == 0, result.output
    (understood,) = result.stderr.splitlines()
    assert understood.startswith(f"{path}: 16 x 16") and "0 to " in understood
    if kind not in ("1", "P"):
        assert run(*bump(photo, tmp_path / "grey.png")).exit_code == 0
        assert (tmp_path / "out.png").read_bytes() == (tmp_path / "grey.png").read_bytes()


def test_heights_of_any_magnitude_are_scaled_alike(photo, tmp_path):
    heights, made = np.asarray(Image.open(photo)).astype(np.float64) - 120.0, []
    for factor in (1.0, 2.0**1016, 2.0**-1040):
        np.save(tmp_path / "hills.npy", heights * factor)
        assert run(*bump(tmp_path / "hills.npy", tmp_path / "out.png")).exit_code == 0
        made.append((tmp_path / "out.png").read_bytes())
    assert made[0] == made[1] == made[2]


@pytest.mark.parametrize("sample", inputs.SAMPLES)
def test_every_sample_is_read_from_an_installed_package(sample):
    pytest.importorskip(inputs.SAMPLES[sample][0])
    picture = inputs.read_picture(f"sample:{sample}")
    assert min(picture.shape[:2]) >= 256 and picture.ndim == 2


def test_what_is_wrong_with_an_obj_files_texture_coordinates_is_said(photo, tmp_path):
    corners = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
    for coordinates, words in (
        ("vt 1 0\nvt 0 0\nvt 0 1\nvt 1 1\n", "2 triangles have mirrored texture coordinates (numbers 0, 1)"),
        ("vt 1 0\nvt 1 0\nvt 1 1\nvt 1 1\n", "2 triangles have no area in texture space"),
        ("vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n", ""),
    ):
        (tmp_path / "mesh.obj").write_text(f"{corners}{coordinates}f 1/1 2/2 3/3 4/4\n")
        result = run(*bump(photo, tmp_path / "out.png", "--mesh", tmp_path / "mesh.obj"))
        assert result.exit_code == 0
        assert words in result.stderr
        assert bool(words) == ("texture" in result.stderr)
        assert "spherical" not in result.stderr


def test_texture_coordinates_that_a_file_does_not_give_are_not_called_its_own(photo, tmp_path):
    (tmp_path / "mesh.obj").write_text(
        "v -1 -1 1\nv 1 -1 1\nv 0 1 1\nv 0 0 -1\nf 1 2 3\nf 2 1 4\nf 3 2 4\nf 1 3 4\n"
    )
    result = run(*bump(photo, tmp_path / "out.png", "--mesh", tmp_path / "mesh.obj"))
    assert result.exit_code == 0
    made = "mesh.obj: spherical texture coordinates, because the file does not give every corner its own: "
    assert made in result.stderr


def test_an_obj_file_is_a_mesh(photo, tmp_path):
    (tmp_path / "mesh.obj").write_text("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n")
    assert run(*bump(photo, tmp_path / "out.png", "--mesh", tmp_path / "mesh.obj")).exit_code == 0


def test_the_help_of_bump_names_every_mesh_material_and_sample():
    text = " ".join(run("bump", "--help").stdout.split())
    for name in (*MESHES, *MATERIALS, *(f"sample:{sample}" for sample in inputs.SAMPLES)):
        assert name in text


def test_material_parameters_change_the_picture(photo, tmp_path):
    made = set()
    for more in ((), ("--material", "gold"), ("--height-scale", 0.2), ("--alpha-x", 0.3), ("--map-size", 8)):
        assert run(*bump(photo, tmp_path / "out.png", *more)).exit_code == 0
        made.add((tmp_path / "out.png").read_bytes())
    assert len(made) == 5


def truncated(path, photo):
    path.write_bytes(photo.read_bytes()[:-40])


def not_an_image(path, photo):
    path.write_bytes(b"this is no picture at all")


def empty(path, photo):
    path.write_bytes(b"")


def array_of_objects(path, photo):
    np.save(path, np.array([{}, []], dtype=object), allow_pickle=True)


def array_of_text(path, photo):
    np.save(path, np.array([["a", "b"], ["c", "d"]]))


def array_with_nan(path, photo):
    np.save(path, np.array([[1.0, np.nan], [2.0, 3.0]]))


def array_of_one_axis(path, photo):
    np.save(path, np.arange(5.0))


def array_without_rows(path, photo):
    np.save(path, np.zeros((0, 4)))


def truncated_array(path, photo):
    np.save(path, np.arange(64.0).reshape(8, 8))
    path.write_bytes(path.read_bytes()[:-100])


def truncated_jpeg(path, photo):
    Image.open(photo).save(path)
    path.write_bytes(path.read_bytes()[:300])


def truncated_tiff(path, photo):
    Image.open(photo).save(path)
    path.write_bytes(path.read_bytes()[:100])


def array_of_complex(path, photo):
    np.save(path, np.ones((4, 4), complex))


def array_of_seven_components(path, photo):
    np.save(path, np.ones((4, 4, 7)))


def folder(path, photo):
    path.mkdir()


def constant(path, photo):
    np.save(path, np.full((4, 4), 7.0))


@pytest.mark.parametrize(
    ("name", "spoil", "words"),
    [
        ("a.png", truncated, "cannot be read"),
        ("a.png", not_an_image, "no picture that is read here"),
        ("a.tiff", not_an_image, "no picture that is read here"),
        ("a.png", empty, "is empty"),
        ("a.npy", not_an_image, "is no NPY file"),
        ("a.npy", empty, "is empty"),
        ("a.npy", truncated_array, "has 512 bytes, and 412 are there"),
        ("a.npy", array_of_objects, "Python's objects"),
        ("a.npy", array_of_text, "array of numbers"),
        ("a.npy", array_with_nan, "NaN"),
        ("a.npy", array_of_one_axis, "shape (5,)"),
        ("a.npy", array_without_rows, "shape (0, 4)"),
        ("a.npy", constant, "two different heights"),
        ("a.jpg", truncated_jpeg, "cannot be read"),
        ("a.tiff", truncated_tiff, "cannot be read"),
        ("a.npy", array_of_complex, "array of numbers"),
        ("a.npy", array_of_seven_components, "shape (4, 4, 7)"),
        ("a.png", folder, "is no file"),
    ],
)
def test_a_picture_that_cannot_be_used_is_refused(photo, tmp_path, name, spoil, words):
    spoil(tmp_path / name, photo)
    assert words in refusal_of(*bump(tmp_path / name, tmp_path / "out.png"))
    assert not (tmp_path / "out.png").exists()


OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (OBJ + "f 1 2 9\n", "line 4: vertex index 9 does not exist"),
        (OBJ + "f 1 2\n", "line 4: a face has 2 corners"),
        ("v 0 0 nan\n", "line 1: a vertex must be finite"),
        ("v 0 zero 0\n", "line 1: a vertex must be numbers"),
        ("v 0 -1e300 0\n", "line 1: a vertex must be finite numbers of at most 1e+30"),
        (OBJ + "f 1 2 99999999999999999999\n", "line 4: vertex index 99999999999999999999 does not exist"),
        (OBJ + "f -1 -2 -4\n", "line 4: vertex index before the first does not exist"),
        (OBJ + "f 0 1 2\n", "line 4: vertex index 0 does not exist"),
        (OBJ, "has no faces"),
        ("v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n", "no triangle with an area"),
    ],
)
def test_an_obj_file_that_cannot_be_used_is_refused_with_its_line(photo, tmp_path, text, words):
    (tmp_path / "mesh.obj").write_text(text)
    assert words in refusal_of(*bump(photo, tmp_path / "out.png", "--mesh", tmp_path / "mesh.obj"))
    assert not (tmp_path / "out.png").exists()


def test_an_obj_file_of_no_text_is_refused(photo, tmp_path):
    (tmp_path / "mesh.obj").write_bytes(b"\xff\xfe\x00\x80")
    sentence = refusal_of(*bump(photo, tmp_path / "out.png", "--mesh", tmp_path / "mesh.obj"))
    assert "has no faces (lines that begin with f)" in sentence


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (("--light", "1,2"), "give three numbers"),
        (("--light", "0,0,0"), "not all zero"),
        (("--light", "1,nan,2"), "give three numbers"),
        (("--light", "up"), "give three numbers"),
        (("--mesh", "cone"), "plane, sphere, torus"),
        (("--mesh", "missing.obj"), "missing.obj cannot be read"),
        (("--material", "cheese"), "gold"),
        (("--alpha-x", "0.1"), "alpha_x is 0.1"),
        (("--height-scale", "nan"), "relief is nan"),
        (("--map-size", "100"), "power of two"),
        (("--profile", "VOODOO"), "GEFORCE_256"),
    ],
)
def test_an_option_that_cannot_be_used_is_refused(photo, tmp_path, more, words):
    assert words in refusal_of(*bump(photo, tmp_path / "out.png", *more))
    assert not (tmp_path / "out.png").exists()


@pytest.mark.parametrize("name", ["missing.png", "sample:teapot"])
def test_a_photograph_that_is_not_there_is_refused(tmp_path, name):
    assert name.removeprefix("sample:") in refusal_of(*bump(name, tmp_path / "out.png"))


def test_a_picture_that_is_not_named_png_is_refused(photo, tmp_path):
    assert "out.png" in refusal_of(*bump(photo, tmp_path / "out.jpg"))


def test_a_sample_of_a_package_that_is_not_installed_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert "fixedpipe[samples]" in refusal_of(*bump("sample:gravel", tmp_path / "out.png"))


# ---------------------------------------------------------------------------------------- the first start


@pytest.mark.slow
def test_compiling_is_announced_on_the_first_start_only(tmp_path):
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "kernels")}
    command = [
        sys.executable,
        "-c",
        "from fixedpipe.effects.cli import main; main()",
        "figures",
        "K12",
        "--size",
        "16",
    ]
    announced, counted = [], []
    for _ in range(2):
        done = subprocess.run(
            [*command, "--out", str(tmp_path / "out")],
            env=environment,
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=True,
        )
        announced.append(done.stderr.startswith("Compiling the kernels"))
        # First this process's kernels, while the figure is drawn; then those of the one that it waits for.
        for said in done.stderr.partition("Done. Kernels for the next command")[::2]:
            lines = re.findall(r"^compiling kernel (\d+) of (\d+): \w+$", said, re.MULTILINE)
            counted.append([int(number) for number, of in lines if int(number) <= int(of)])
            assert len(counted[-1]) == len(lines)
    assert announced == [True, False]
    assert all(numbers == sorted(numbers) for numbers in counted)
    assert counted[0] and (counted[1] or default_threads() == 1)
    assert counted[2:] == [[], []]


def test_bounds_of_a_program_are_told(tmp_path):
    text = (
        "!!RC1.0\n{ rgb { spare0 = expand(tex0) . expand(col0); } }\nout.rgb = spare0.rgb;\nout.a = col0.a;\n"
    )
    (tmp_path / "dot.rc").write_text(text)
    result = run("combiners", tmp_path / "dot.rc", "--profile", "GEFORCE_256", "--bounds")
    assert result.exit_code == 0, result.output
    line = next(line for line in result.output.splitlines() if "spare0.r" in line)
    assert line.split()[-4:] == ["-1.004", "1.000", "-3.000", "3.024"]
    assert "--bounds are a machine's numbers; give --profile" in refusal_of(
        "combiners", tmp_path / "dot.rc", "--bounds"
    )


def test_precision_prints_a_row_for_each_width_and_clamp():
    result = run("precision", "F004-4", "--size", "8", "--bits", "4,8")
    assert result.exit_code == 0, result.output
    rows = {line.split()[0]: line.split()[1:] for line in result.output.splitlines() if line.strip()}
    assert len(rows["4"]) == len(rows["8"]) == 4
    assert float(rows["4"][0]) > 4 * float(rows["8"][0])
    assert rows["VERTEX_COLOR"][2:] == ["colours", "of", "vertices;", "changes", "nothing"]
    assert rows["MAPPING"][2:] == ["inputs", "of", "combiners"]
    assert rows["none"][2:] == rows["VERTEX_COLOR"][:2] != rows["MAPPING"][:2]
    assert "combiner=8, registers of 9 bits with the sign, is the GeForce 256 itself" in result.output


def test_precision_says_what_each_clamp_clamps():
    assert [clamp.name for clamp in Clamp] == list(CLAMPS)


HALVES = """
import numpy as np
from fixedpipe.pipeline import Draw, Mesh, PassState
corners = np.array([[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]])
mesh = Mesh(corners, colors=np.tile([0.5, 0.25, 0.125, 1.0], (3, 1)))
commands = (Draw(label="all of it", mesh=mesh, state=PassState()),)
profile, width, height = "GEFORCE_256", 8, 4
"""


@pytest.fixture
def halves(tmp_path):
    """A script whose frame is 8x4 pixels of one colour: (0.5, 0.25, 0.125)."""
    script = tmp_path / "halves.py"
    script.write_text(HALVES)
    return script


def test_precision_is_of_a_script_s_frame_too(halves):
    result = run("precision", halves, "--bits", "8")
    assert result.exit_code == 0, result.output
    assert f"{halves}\n8x4 pixels" in result.output
    rows = {line.split()[0]: line.split()[1:] for line in result.output.splitlines() if line.strip()}
    # 0.5, 0.25 and 0.125 of 255 are 127.5, 63.75 and 31.875: off by 1/2, 1/4 and 1/8 where they are rounded.
    assert rows["8"][0] == f"{math.sqrt((1 / 4 + 1 / 16 + 1 / 64) / 3):.3f}"
    assert "a script says its own width" in refusal_of("precision", halves, "--size", 8)


def test_precision_writes_the_numbers_that_it_prints(tmp_path):
    files = [tmp_path / name for name in ("rows.json", "rows.csv")]
    result = run("precision", "F004-4", "--size", 8, "--bits", "4,8", "--json", files[0], "--csv", files[1])
    assert result.exit_code == 0, result.output
    printed = {line.split()[0]: line.split()[1:] for line in result.output.splitlines() if line.strip()}
    rows = json.loads(files[0].read_text())
    of_four = [row for row in rows if row["bits"] == 4]
    assert [row["without"] for row in of_four] == [None, "its own"]
    numbers = [f"{row[name]:.3f}" for row in of_four for name in ("shown", "computed")]
    assert numbers == printed["4"]
    (clamp,) = [row for row in rows if row["without"] == "MAPPING"]
    assert clamp["bits"] is None and f"{clamp['computed']:.3f}" == printed["MAPPING"][1]
    table = list(csv.DictReader(files[1].read_text().splitlines()))
    assert [{k: "" if v is None else str(v) for k, v in row.items()} for row in rows] == table


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--bits", "8,x"), "give whole numbers from 4 to 16"),
        (("--bits", "3"), "may have 4 to 16 bits"),
        (("--of", "colour"), "there are: combiner, texture, framebuffer, filter_fraction, subpixel"),
        (("--profile", "IDEAL"), "IDEAL is no machine, and its numbers have no width to change"),
        (("--profile", "VOODOO"), "SCHILLING, FUTURE."),
    ],
)
def test_precision_refuses_what_it_cannot_measure(arguments, said):
    result = run("precision", "F004-4", *arguments)
    assert result.exit_code == 2
    assert said in result.output
