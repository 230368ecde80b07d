"""``fixedpipe inspect``: a figure's or a script's pixel in words, as JSON and as a page; what it refuses."""

import csv
import html
import json
import re
import sys

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.cli import main
from fixedpipe.effects.figures import FIGURES
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.inspection.maps import frame_maps
from fixedpipe.pipeline.inspection.pixel import ReplayedPixel
from fixedpipe.pipeline.inspection.recording import record
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, PROFILES

SCRIPT = """
import numpy as np
from fixedpipe.pipeline import Draw, Mesh, PassState
corners = np.array([[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]])
commands = (Draw(label="all of it", mesh=Mesh(corners), state=PassState()),)
profile, width, height = "GEFORCE_256", 8, 8
"""


def said(*arguments):
    """(exit status, what it prints)."""
    result = CliRunner().invoke(main, ["inspect", *arguments])
    return result.exit_code, result.output


def test_a_figure_s_pixel_is_told(tmp_path):
    figure = FIGURES["F004-4"]
    shown = execute(figure.commands(GEFORCE_256, 64), GEFORCE_256, *figure.dimensions(64)).framebuffer
    files = {name: tmp_path / f"pixel.{name}" for name in ("json", "html")}
    options = [option for name, file in files.items() for option in (f"--{name}", str(file))]
    status, text = said("F004-4", "--size", "64", "--pixel", "40,34")
    assert status == 0
    assert "general combiner 0, RGB portion: spare0 = 4 * (expand(tex0) . expand(col0))" in text
    assert "adds most to the error" in text and "added by mapping" in text
    guided = execute_ideal(
        figure.commands(IDEAL, 64),
        *figure.dimensions(64),
        guide=execute(figure.commands(GEFORCE_256, 64), GEFORCE_256, *figure.dimensions(64), record=True),
    )
    color = " ".join(f"{255 * value:.2f}" for value in guided.color[34, 40])
    line = f"The guided ideal's color in the end, not rounded: {color}"
    assert line in text
    status, _ = said("F004-4", "--size", "64", "--pixel", "40,34", *options)
    assert status == 0
    read = json.loads(files["json"].read_text())
    assert read["final"]["color"] == shown.color[34, 40].tolist()
    page = html.unescape(files["html"].read_text())
    assert "specular pass" in page and line in page


def test_a_figure_s_registers_are_told():
    status, text = said("F004-4", "--size", "48", "--registers", "--command", "5")
    assert status == 0
    line = next(line for line in text.splitlines() if line.startswith("general combiner 1    spare0.r"))
    assert "of 512" in line and "%" in line
    assert "command 5: specular pass" in text and "command 4" not in text


def test_a_figure_s_maps_are_told(tmp_path):
    pytest.importorskip("matplotlib")
    picture = tmp_path / "map.png"
    status, text = said("F004-4", "--size", "48", "--map", "clamps", "--out", str(picture))
    assert status == 0
    assert "how many components of general combiners a clamp changed" in text
    assert "command 11: specular pass" in text and "greatest 12" in text
    assert re.search(r"reached \d\d\.\d+ %, above zero \d\d\.\d+ %, least 0,", text)
    (_, last) = re.findall(r"greatest 12 at pixel (\d+),(\d+)\n", text)
    x, y = map(int, last)
    figure = FIGURES["F004-4"]
    maps = frame_maps(figure.commands(GEFORCE_256, 48), GEFORCE_256, *figure.dimensions(48), "clamps")
    assert maps[-1].values[y, x] == np.nanmax(maps[-1].values) == 12.0
    with Image.open(picture) as image:
        assert image.format == "PNG"


def numbers(text, what):
    """The numbers of a line that begins with some words."""
    return [
        float(word.rstrip("%"))
        for word in next(line for line in text.splitlines() if line.startswith(what))
        .removeprefix(what)
        .split()
    ]


def test_what_a_figure_s_error_is_made_of_is_told():
    status, text = said("F004-4", "--size", "32", "--attribution")
    assert status == 0
    own, combiner = numbers(text, "as it is"), numbers(text, "bits: combiner")
    assert combiner[-1] == pytest.approx(100 * (1 - combiner[0] / own[0]), abs=0.1)
    assert numbers(text, "all bits and the half")[-1] > 99
    assert f"Most of it goes with bits: combiner alone: {combiner[-1]:.1f}%." in text


def test_a_change_alone_tells_the_error_before_and_after(tmp_path):
    status, text = said("F004-4", "--size", "32", "--bits", "combiner=12", "--bits", "texture=12")
    assert status == 0
    assert numbers(text, "changed")[0] < numbers(text, "as it is")[0] / 2
    assert "combiner=8, registers of 9 bits with the sign, is the GeForce 256 itself." in text
    status, text = said("F004-4", "--size", "32", "--constant", "0=1,0,0,1", "--without", "blending")
    assert status == 0 and numbers(text, "changed") != numbers(text, "as it is")
    name = next(c.texture for c in FIGURES["F004-4"].commands(GEFORCE_256, 32) if type(c) is TexImage)
    Image.new("RGB", (8, 8), (128, 128, 255)).save(tmp_path / "flat.png")
    status, text = said("F004-4", "--size", "32", "--texture", f"{name}={tmp_path / 'flat.png'}")
    assert status == 0 and numbers(text, "changed") != numbers(text, "as it is")


def test_what_a_stage_does_to_the_error_is_told():
    status, text = said("F004-4", "--size", "32", "--attribution", "--stages")
    assert status == 0
    own, first = numbers(text, "as it is"), numbers(text, "general combiner 0")
    assert first[-1] == pytest.approx(100 * (1 - first[0] / own[0]), abs=0.1) and first[-1] > 50
    status, text = said("F004-4", "--size", "32", "--replace", "general combiner 0=IDEAL")
    assert status == 0 and numbers(text, "changed") == first[:-1]
    status, text = said("F004-4", "--size", "32", "--attribution", "--stages", "--command", "5")
    assert status == 0 and own[0] > numbers(text, "general combiner 0")[0] > first[0]
    clamp = "GENERAL_COMBINER@general combiner 0"
    status, text = said("F004-4", "--size", "32", "--without", clamp, "--command", "5")
    assert status == 0 and numbers(text, "as it is") == own


@pytest.mark.parametrize(
    "options",
    [
        ("--registers", "--command", "5"),
        ("--map", "overdraw"),
        ("--attribution", "--stages", "--command", "5"),
        ("--row", "0"),
        ("--bits", "combiner=12"),
    ],
)
def test_what_is_printed_is_written_as_json_and_as_csv(tmp_path, options):
    files = [tmp_path / name for name in ("rows.json", "rows.csv")]
    status, text = said("F004-4", "--size", "32", *options, "--json", str(files[0]), "--csv", str(files[1]))
    assert status == 0
    assert said("F004-4", "--size", "32", *options)[1] in text
    rows = json.loads(files[0].read_text())
    table = list(csv.DictReader(files[1].read_text().splitlines()))
    assert len(rows) > 1
    assert [{k: "" if v is None else str(v) for k, v in row.items()} for row in rows] == table


def test_rows_have_the_numbers_that_are_printed(tmp_path):
    file = tmp_path / "rows.json"
    _, text = said("F004-4", "--size", "32", "--attribution", "--json", str(file))
    for row in json.loads(file.read_text()):
        columns = [row[k] for k in ("shown", "red", "green", "blue", "largest", "computed")]
        columns += [100 * row["goes"]] * (row["what"] != "as it is")
        assert numbers(text, f"{row['what']:28}") == [
            float(f"{value:.{3 if k < 6 else 1}f}") for k, value in enumerate(columns)
        ]


def test_a_row_has_the_machine_s_colors_beside_the_ideal_s(tmp_path):
    file, figure = tmp_path / "row.json", FIGURES["F004-4"]
    status, text = said("F004-4", "--size", "32", "--row", "16", "--json", str(file))
    assert status == 0
    given = figure.commands(GEFORCE_256, 32), GEFORCE_256, *figure.dimensions(32)
    result = execute(*given, record=True)
    ideal = execute_ideal(given[0], *given[2:], guide=result).color[16, :, :3]
    rows = json.loads(file.read_text())
    assert [row["x"] for row in rows] == list(range(64))
    names = ("red", "green", "blue")
    assert [[row[name] for name in names] for row in rows] == result.framebuffer.color[16, :, :3].tolist()
    meant = np.array([[row[f"ideal {name}"] for name in names] for row in rows])
    np.testing.assert_array_equal(meant, 255 * ideal)
    reds = result.framebuffer.color[16, :, 0]
    expected = [reds.min(), reds.max(), 255 * ideal[:, 0].min(), 255 * ideal[:, 0].max()]
    expected += [np.abs(reds - 255 * ideal[:, 0]).max(), len(set(reds.tolist()))]
    assert numbers(text, "red") == [float(f"{value:.3f}") for value in expected]


def test_a_row_is_drawn_as_lines_and_equal_components_once(tmp_path):
    pytest.importorskip("matplotlib")
    script = tmp_path / "frame.py"
    script.write_text(SCRIPT)  # white all over
    heights = []
    for what in ((str(script),), ("F004-4", "--size", "8")):
        status, _ = said(*what, "--row", "3", "--plot", str(tmp_path / "row.png"))
        assert status == 0
        with Image.open(tmp_path / "row.png") as picture:
            heights.append(picture.height)
    assert heights == [round(110 * 3.5), round(110 * 8.5)]


def test_a_plot_without_matplotlib_is_refused_in_a_sentence(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    status, text = said("F004-4", "--size", "8", "--row", "3", "--plot", str(tmp_path / "row.png"))
    assert status == 2 and "--plot needs matplotlib; install fixedpipe[plots]" in text


def test_a_brief_history_has_the_stage_that_adds_most_and_the_first_clamp(tmp_path):
    file = tmp_path / "pixel.json"
    of = "F004-4", "--size", "64", "--pixel", "40,34"
    whole, brief = said(*of)[1], said(*of, "--brief")[1]
    assert said(*of, "--json", str(file))[0] == 0
    fragments = [f for touched in json.loads(file.read_text())["touched"] for f in touched["fragments"]]
    marked = [{f["worst"], f["first_clamped"]} - {None} for f in fragments]
    for mark in ("adds most to the error", "the first clamp"):
        assert brief.count(mark) == whole.count(mark) > 0
    stages = [line for line in brief.splitlines() if re.match(r" {4}\w", line)]
    assert len(stages) == sum(map(len, marked)) and all("<- " in line for line in stages)


def test_maps_of_texels_have_the_textures_sizes(tmp_path):
    picture = tmp_path / "texels.png"
    status, text = said("F004-4", "--size", "32", "--map", "texels", "--command", "5", "--out", str(picture))
    assert status == 0 and "brushing t/ax, unit 0, level 0" in text and "unit 1, level 0" in text
    with Image.open(picture) as image:
        assert image.height > image.width / 4


def test_a_pixel_of_a_changed_frame_is_told(tmp_path):
    codes = []
    for change in ((), ("--bits", "combiner=12")):
        file = tmp_path / "pixel.json"
        status, _ = said("F004-4", "--size", "64", "--pixel", "40,34", "--json", str(file), *change)
        assert status == 0
        codes.append(json.loads(file.read_text())["final"]["color"])
    assert codes[0] != codes[1]


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--bits", "combiner"), "--bits is 'combiner'; give it as in --bits combiner=12."),
        (("--bits", "fog=12"), "There is no part 'fog' with a width"),
        (("--bits", "combiner=3"), "4 to 16 bits"),
        (("--without", "rain"), "The GeForce 256 has no clamp 'rain' to leave out; it has: VERTEX_COLOR"),
        (("--constant", "1=0.5,0.5"), "--constant is '1=0.5,0.5'; give it as in --constant 1=0.5,0.5,0.5,1."),
        (("--constant", "3=0,0,0,0"), "There is no constant colour 3"),
        (("--texture", "a=b.png"), "b.png"),
        (("--texture", "a=pyproject.toml"), "pyproject.toml"),
        (("--attribution", "--command", "3"), "--command"),
        (("--replace", "combiner"), "--replace is 'combiner'; give it as in --replace \"general combiner 0"),
        (("--replace", "final combiner=FLOAT"), "--replace is 'final combiner=FLOAT'"),
        (("--replace", "general combiner 8=IDEAL"), "No Draw of it has a stage 'general combiner 8'"),
        (("--without", "MAPPING@final combiner"), '"FINAL_COMBINER@final combiner"'),
        (("--replace", "final combiner=IDEAL", "--registers"), "leave --registers out"),
        (("--stages",), "Give one of"),
        (("--stages", "--registers"), "--stages belongs to --attribution; give that too."),
        (("--attribution", "--stages", "--command", "99"), "There is no command 99"),
        (
            ("--attribution", "--registers"),
            "Give one of --pixel, --row, --registers, --map and --attribution",
        ),
        ((), "Give one of --pixel, --row, --registers, --map and --attribution"),
    ],
)
def test_a_change_that_is_none_is_said(options, sentence):
    status, text = said("F004-4", "--size", "16", *options)
    assert status == 2 and sentence in text


def test_a_script_s_pixel_is_told(tmp_path):
    script = tmp_path / "frame.py"
    script.write_text(SCRIPT)
    status, text = said(str(script), "--pixel", "3,3", "--profile", "NV2A")
    assert status == 0
    assert "command 0, Draw: all of it" in text and "on NV2A" in text


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("1 / 0", "raised ZeroDivisionError: division by zero"),
        ("x = 1\n\ndef f():\n    return 1 / 0\n\nf()", ", line 4, raised ZeroDivisionError"),
        ("width = height = 8", "does not define commands"),
        ("commands, width, height = (), 8, 8", "does not define profile"),
        ("commands, width, height, profile = (), 8, 8, 'NONE'", "There is no profile 'NONE'"),
        ("commands, width, height, profile = (1,), 8, 8, 'NV2A'", "is no command"),
        (SCRIPT.replace("8, 8", "0, 8"), "0"),
        ("commands, width, height = 1, 8, 8\nprofile = 'NV2A'", "commands is 1; give a list of commands"),
        ("raise SystemExit(3)", "raised SystemExit: 3"),
    ],
)
def test_what_is_wrong_with_a_script_is_said(tmp_path, source, sentence):
    script = tmp_path / "frame.py"
    script.write_text(source)
    status, text = said(str(script), "--pixel", "3,3")
    assert (status, sentence in text) == (2, True), text


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (
            ("F004-4",),
            "Or give only a change: --bits, --without, --replace, --constant or --texture. You gave none.",
        ),
        (("F004-4", "--pixel", "3,3", "--registers"), "You gave --pixel and --registers."),
        (("F004-4", "--map", "nono"), "There is no map 'nono'; there are: clamps,"),
        (("F004-4", "--registers", "--out", "x.png"), "--out would be ignored"),
        (("F004-4", "--registers", "--html", "x.html"), "--html would be ignored"),
        (
            ("F004-4", "--pixel", "3,3", "--csv", "x.csv"),
            "--csv would be ignored: a pixel's history is no table",
        ),
        (("F004-4", "--size", "32", "--registers", "--command", "1"), "No fragment was made by command 1."),
        (("F004-4", "--pixel", "3"), "--pixel is '3'; give two whole numbers, as 120,48."),
        (("F004-4", "--size", "32", "--pixel", "64,3"), "Pixel (64, 3) lies outside"),
        (("F004-44", "--pixel", "3,3"), "There is no figure 'F004-44'. Did you mean F004-4?"),
        (("F004-4", "--pixel", "3,3", "--profile", "IDEAL"), "IDEAL is no machine"),
        (("F004-4", "--pixel", "3,3", "--profile", "G400"), "F004-4"),
        (("F004-4", "--size", "32", "--pixel", "3,3", "--command", "99"), "There is no command 99"),
        (("F004-4", "--size", "32", "--pixel", "3,3", "--command", "1"), "did not touch this pixel"),
        (("F004-4", "--size", "32", "--pixel", "3,3", "--surface", "p"), "no pbuffer 'p'"),
        (("none.py", "--pixel", "3,3"), "none.py cannot be read: No such file or directory."),
        (("none.py", "--pixel", "3,3", "--size", "9"), "--size and --set are a figure's"),
        (("F004-4", "--size", "32", "--pixel", "3,3", "--json", "/dev/null/x.json"), "cannot be written"),
    ],
)
def test_what_cannot_be_told_is_refused(arguments, sentence):
    status, text = said(*arguments)
    assert (status, sentence in text) == (2, True), text


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", FIGURES)
def test_every_figure_can_be_looked_into(name):
    figure = FIGURES[name]
    for key in figure.machines:
        # The least size that every figure can have.
        profile, size = PROFILES[key], figure.dimensions(64)
        frame = record(figure.commands(profile, 64), profile, *size)
        for x, y in ((size[0] // 4, size[1] // 2), (size[0] // 2, size[1] // 3)):
            replayed = ReplayedPixel(frame, x, y)
            list(replayed.run(lambda: lambda stage, /, **columns: None))
            replayed.check()
