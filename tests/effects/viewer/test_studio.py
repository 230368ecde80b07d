"""What a window is given of a view: the machine's codes, the ideal's, the history and the script."""

import json
import subprocess
import sys
import zipfile
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from click.testing import CliRunner

from fixedpipe.effects.cli import main
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.viewer import studio as studio_module
from fixedpipe.effects.viewer.keeping import file_stem, golden_kept, picture_kept, script
from fixedpipe.effects.viewer.mesh_subject import mesh_subject
from fixedpipe.effects.viewer.studio import Studio, Superseded, changed
from fixedpipe.effects.viewer.subjects import FigureSubject, FrameSubject, Subjects
from fixedpipe.effects.viewer.views import View, machines
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.framebuffers.pictures import to_codes
from fixedpipe.pipeline.golden.digests import digest
from fixedpipe.pipeline.golden.pixels import pixels_of_png
from fixedpipe.pipeline.profiles import PROFILES

SIZE = 48
SPHERES = View("F004-4", "GEFORCE_256", SIZE)
BIASES = View("F003-21", "GEFORCE_3", SIZE)


@pytest.fixture(scope="module")
def studio():
    return Studio(Subjects([FigureSubject(FIGURES["F004-4"])], figures=True))


def rendered(view, **changes):
    return FIGURES[view.id].render(view.machine, view.size, **changes)


@pytest.mark.parametrize("view", [SPHERES, BIASES, BIASES.on("INFINITE_REALITY"), SPHERES.on("NV2A")])
def test_the_codes_are_the_figures_own(studio, view):
    drawn, own = studio.machine(view), rendered(view)
    assert drawn.bits == own.bits
    np.testing.assert_array_equal(drawn.codes[..., :3], own.codes()[..., :3])
    assert (drawn.codes[..., 3] == 255).all()


def test_values_widths_and_clamps_change_what_is_drawn_as_elsewhere(studio):
    own = studio.machine(SPHERES)
    lit = studio.machine(changed(SPHERES, light="1,1,1"))
    expected = rendered(SPHERES, light=(1.0, 1.0, 1.0)).image()
    np.testing.assert_array_equal(lit.codes[..., :3], expected[..., :3])
    narrow = replace(SPHERES, bits=(("combiner", 5), ("framebuffer", 5)), without=("GENERAL_COMBINER",))
    machine = narrow.profile()
    frame = FIGURES["F004-4"].commands(machine, SIZE)
    found = studio.machine(narrow)
    np.testing.assert_array_equal(
        found.codes[..., :3], execute(frame, machine, 2 * SIZE, SIZE).codes()[..., :3]
    )
    assert (own.bits, found.bits) == (8, 5)
    assert len({own.sha256, lit.sha256, found.sha256}) == 3


def test_a_part_of_the_frame_is_what_the_machine_held_then_with_its_command_in_words(studio):
    commands = FIGURES["F003-21"].commands("GEFORCE_3", SIZE)
    run = CliRunner().invoke(main, ["passes", "F003-21", "--size", str(SIZE), "--all"])
    for number in (0, len(commands) // 2, len(commands) - 1):
        found = studio.machine(replace(BIASES, upto=number))
        machine = Machine(PROFILES["GEFORCE_3"], 3 * SIZE, SIZE)
        machine.run(commands[: number + 1])
        np.testing.assert_array_equal(found.codes[..., :3], machine.drawn().image()[..., :3])
        said = found.facts["command"]
        assert said["number"] == number and "\n".join(said["words"]) in run.output
    whole = studio.machine(replace(BIASES, upto=len(commands) - 1))
    np.testing.assert_array_equal(whole.codes, studio.machine(BIASES).codes)
    with pytest.raises(Refusal, match=f"the last is {len(commands) - 1}"):
        studio.machine(replace(BIASES, upto=len(commands)))


@pytest.mark.parametrize("view", [SPHERES, BIASES.on("INFINITE_REALITY")])
def test_the_ideal_and_the_numbers_are_a_renderings(studio, view):
    drawn, ideal, numbers = studio.guided(view)
    own = rendered(view)
    np.testing.assert_array_equal(drawn.codes[..., :3], own.codes()[..., :3])
    np.testing.assert_array_equal(ideal.codes[..., :3], to_codes(own.ideal.color[..., :3], own.bits))
    difference = own.difference
    assert numbers["rms"] == pytest.approx(difference.rms, rel=1e-12)
    assert (numbers["pixels"], numbers["gain"]) == (difference.pixels, difference.gain)
    assert drawn.facts["sha256"] == digest(own.image())


def test_the_ideal_of_a_part_is_guided_by_that_part(studio):
    _, part, _ = studio.guided(replace(SPHERES, upto=4))
    _, whole, _ = studio.guided(SPHERES)
    assert (part.codes != whole.codes).any()
    right = part.codes[:, SIZE:, :3]
    assert not right.any(), "the second panel is not drawn yet"


def test_a_reference_has_alpha_where_it_is(studio):
    picture, exact = studio.reference(BIASES)
    np.testing.assert_array_equal(picture.codes[..., 3] == 255, exact[..., 3] > 0)
    own = FIGURES["F003-21"].reference_picture(SIZE)
    np.testing.assert_array_equal(picture.codes[..., :3], to_codes(own[..., :3], 8))
    assert studio.reference(replace(BIASES, upto=3)) is None
    assert studio.reference(SPHERES) is None


def test_a_pixels_history_is_that_of_inspect(studio, tmp_path):
    out = tmp_path / "history.json"
    arguments = ["inspect", "F004-4", "--pixel", "20,30", "--size", str(SIZE), "--json", str(out)]
    assert CliRunner().invoke(main, arguments).exit_code == 0
    found = studio.history(SPHERES, (20, 30))
    assert json.loads(json.dumps(found["json"])) == json.loads(out.read_text())
    assert "<script" not in found["html"]
    with pytest.raises(Refusal, match="96"):
        studio.history(SPHERES, (96, 0))


def test_registers_are_those_of_inspect(studio, tmp_path):
    out = tmp_path / "registers.json"
    arguments = ["inspect", "F004-4", "--registers", "--size", str(SIZE), "--json", str(out)]
    assert CliRunner().invoke(main, arguments).exit_code == 0
    assert studio.registers(SPHERES) == json.loads(out.read_text())


@pytest.mark.parametrize(
    "view",
    [
        changed(SPHERES, light="0.2,0.5,0.8", alpha_x="0.4"),
        replace(SPHERES, bits=(("combiner", 6),), without=("GENERAL_COMBINER",)),
        replace(changed(BIASES, shading="MASK", offsets="0,0/3,4/14,4"), upto=20),
        View("sphere", "GEFORCE_256", SIZE, (("alpha_x", "0.5"), ("view", "1,0.4,1"))),
    ],
)
def test_the_script_draws_the_same_codes(studio, view, tmp_path):
    subjects = Subjects([mesh_subject("sphere", "ward")], figures=True)
    of = studio if view.id != "sphere" else Studio(subjects)
    path = tmp_path / "frame.py"
    path.write_text(script(of, view))
    subprocess.run([sys.executable, str(path)], cwd=tmp_path, check=True)
    (picture,) = tmp_path.glob("*.png")
    drawn = of.machine(view)
    shown = pixels_of_png(picture.read_bytes())
    np.testing.assert_array_equal(shown, drawn.codes[..., :3])
    np.testing.assert_array_equal(pixels_of_png(picture_kept(of, view).data), shown)
    inspected = CliRunner().invoke(main, ["inspect", str(path), "--pixel", "10,10", "--brief"])
    assert inspected.exit_code in (0, 2) and "raised" not in inspected.output


def test_a_golden_test_passes_in_a_project_and_fails_for_another_picture(studio, tmp_path):
    kept = golden_kept(studio, changed(SPHERES, light="0.2,0.5,0.8"))
    with zipfile.ZipFile(BytesIO(kept.data)) as file:
        assert all(not name.startswith("/") and ".." not in name for name in file.namelist())
        file.extractall(tmp_path)
    (tmp_path / "pytest.ini").write_text("[pytest]\ntestpaths = tests\n")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    first = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert first.returncode == 0, first.stdout + first.stderr
    frame = next(tmp_path.glob("tests/*_frame.py"))
    frame.write_text(frame.read_text().replace("0.2, 0.5, 0.8", "0.3, 0.5, 0.8"))
    second = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert second.returncode == 1 and "differ" in second.stdout


def test_a_file_is_only_what_the_command_line_names(tmp_path):
    figure = next(f for f in FIGURES.values() if "height_field" in f.parameters)
    free = Studio(Subjects([FigureSubject(figure)], figures=False))
    view = View(figure.id, figure.machines[0], SIZE)
    for hostile in ("/etc/passwd", "../secret.png", "sample:gravel"):
        with pytest.raises(Refusal, match="which a page cannot choose"):
            free.machine(changed(view, height_field=hostile))
    given = FigureSubject(figure, {"height_field": "sample:gravel"})
    named = Studio(Subjects([given], figures=False))
    assert named.machine(view).sha256 != free.machine(view).sha256
    control = next(c for c in named.about(view)["controls"] if c["name"] == "height_field")
    assert control["form"] == "fixed"


@pytest.mark.parametrize(
    ("view", "said"),
    [
        (View("F004-44", "GEFORCE_256"), "Did you mean F004-4"),
        (View("../../etc/passwd", "GEFORCE_256"), "There is no figure"),
        (View("F004-4", "IDEAL"), "There is no machine"),
        (View("F004-4", "OPENGL_1_2", SIZE), "cannot be drawn on OPENGL_1_2"),
        (View("F004-4", "GEFORCE_256", 2048), "more than a window shows"),
        (replace(SPHERES, bits=(("combiner", 3),)), "4 to 16 bits"),
        (replace(SPHERES, without=("NOTHING",)), "no clamp"),
        (changed(SPHERES, light="nan,0,0"), "light is"),
        (changed(SPHERES, colour="1"), "no parameter 'colour'"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_a_sentence(studio, view, said):
    with pytest.raises(Refusal) as refused:
        studio.machine(view)
    assert said in str(refused.value)


def test_a_picture_that_nobody_wants_is_given_up(studio):
    asked = []

    def stop():
        asked.append(True)
        return len(asked) > 2

    with pytest.raises(Superseded):
        studio.machine(SPHERES, stop)
    with pytest.raises(Superseded):
        studio.guided(SPHERES, lambda: True)


def test_a_frame_without_parameters_says_so():
    commands = FIGURES["F004-4"].commands("GEFORCE_256", SIZE)
    frame = FrameSubject("my.py", "my.py", lambda of: commands, (2 * SIZE, SIZE), "GEFORCE_256", (), ())
    studio = Studio(Subjects([frame], figures=False))
    view = View("my.py", "GEFORCE_256")
    np.testing.assert_array_equal(studio.machine(view).codes[..., :3], rendered(SPHERES).image()[..., :3])
    with pytest.raises(Refusal, match="without parameters"):
        studio.machine(changed(view, light="1,1,1"))
    with pytest.raises(Refusal, match="leave its size"):
        studio.machine(replace(view, size=64))
    assert studio.about(view)["controls"] == []


@pytest.mark.parametrize(("most", "kept"), [(10**6, 6), (30, 4), (0, 2)])
def test_fewer_frames_are_kept_where_they_have_many_commands(monkeypatch, most, kept):
    monkeypatch.setattr(studio_module, "_MOST_COMMANDS", most)
    made = []

    def commands(of):
        made.append(of)
        return FIGURES["F004-4"].commands("GEFORCE_256", SIZE)[:1] * 15

    frame = FrameSubject("my.py", "my.py", commands, (2 * SIZE, SIZE), "GEFORCE_256", (), ())
    studio = Studio(Subjects([frame], figures=False))
    views = [View("my.py", machine) for machine in list(machines())[:8]]
    for view in (*views, *views[: -kept - 1 : -1]):
        studio.commands(view)
    assert len(made) == len(views)  # the newest ones were asked for again
    studio.commands(views[-kept - 1])
    assert len(made) == len(views) + 1


@pytest.mark.parametrize("name", ["../../x", "a/b\\c.py", "\u2028", "-", "F004-4"])
def test_a_kept_files_name_is_no_path(name):
    stem = file_stem(View(name, "GEFORCE_256"))
    assert stem and not set(stem) & set("/\\. \u2028") and not stem.startswith("-")
