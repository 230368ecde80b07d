"""--set, and fixedpipe parameters: variants of figures never pass for the figure."""

import json
import re

import numpy as np
import pytest
from click.testing import CliRunner

from fixedpipe.effects.cli import main
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.reports.figure_record import variant_name
from tests.effects.reports import kept

SMALL = ("--set", "slices=6", "--set", "stacks=4", "--size", "16", "--profile", "GEFORCE_3")


def run(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments])


def picture_of(folder, name):
    """The codes of the first machine's picture."""
    return kept.codes(folder, kept.record(folder, name)["machines"][0]["pictures"]["machine"])


def test_a_variant_is_what_render_draws_and_says_what_was_changed(tmp_path):
    done = run("figures", "F004-4", *SMALL, "--set", "light=0,1,0.2", "--out", tmp_path)
    assert done.exit_code == 0, done.output
    name = "F004-4+slices=6+stacks=4+light=0,1,0.2"
    assert {path.name for path in tmp_path.iterdir()} == {
        *("index.html", "plain.html", "catalogue", "pictures", "records"),
        f"{name}.json",
    }
    drawn = FIGURES["F004-4"].render("GEFORCE_3", 16, slices=6, stacks=4, light=(0, 1, 0.2))
    record = kept.record(tmp_path, name)
    written = kept.codes(tmp_path, record["machines"][0]["pictures"]["machine"])
    np.testing.assert_array_equal(written, drawn.image()[..., :3])
    changed = " ".join(f"--set {part}" for part in ("slices=6", "stacks=4", "light=0,1,0.2"))
    assert record["command"] == f"fixedpipe figures F004-4 --profile GEFORCE_3 --size 16 {changed}"
    assert record["id"] == name
    assert record["figure"] == "F004-4"
    assert record["set"] == {"slices": 6, "stacks": 4, "light": [0.0, 1.0, 0.2]}
    assert "must_see" not in record
    assert record["caption"] == f"The figure with its own values: {FIGURES['F004-4'].caption}"
    captions = [p["caption"] for p in record["machines"][0]["pictures"].values()]
    assert all("slices = 6; stacks = 4; light = 0,1,0.2" in caption for caption in captions)
    assert "F004-4 itself has light=0.4,0.3,0.87. The direction towards the light" in done.output


def test_the_ideal_draws_a_variant_too_and_leaves_the_figures_own_files(tmp_path):
    small = ("--size", "16", "--profile", "IDEAL", "--out", tmp_path)
    assert run("figures", "K14", *small).exit_code == 0
    own = kept.record(tmp_path, "K14")
    assert run("figures", "K14", "--set", "cells=8", *small).exit_code == 0
    assert kept.record(tmp_path, "K14") == own
    written = picture_of(tmp_path, "K14+cells=8")
    ideal = FIGURES["K14"].render("IDEAL", 16, cells=8).image()[..., :3]
    np.testing.assert_array_equal(written, ideal)
    assert (written != picture_of(tmp_path, "K14")).any()


def test_a_gallery_has_a_card_for_the_figure_and_one_for_each_variant(tmp_path):
    small = ("--size", "16", "--profile", "GEFORCE_256", "--out", tmp_path)
    assert run("figures", "K14", *small).exit_code == 0
    own = (tmp_path / "K14.json").read_bytes()
    assert run("figures", "K14", "--set", "cells=8", *small).exit_code == 0
    assert (tmp_path / "K14.json").read_bytes() == own
    page = (tmp_path / "plain.html").read_text()
    assert page.index('<section id="K14">') < page.index('<section id="K14+cells=8">')
    figure, variant = page.split("<section")[1:]
    assert "Must be seen:" in figure
    assert "Must be seen:" not in variant
    assert "A variant of K14:</b> cells = 8." in variant


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({}, "F004-4"),
        ({"alpha_x": 0.15, "light": (1.0, 1.0, -1.0)}, "F004-4+alpha_x=0.15+light=1,1,-1"),
        (
            {"light": (0.1234567890123, 0.1234567890124, 1.0)},
            "F004-4+light=0.1234567890123,0.1234567890124,1",
        ),
    ],
)
def test_a_variant_is_named_by_what_was_changed(changes, name):
    assert variant_name(FIGURES["F004-4"], changes) == name


def test_of_long_or_odd_values_names_of_files_have_the_beginning_and_a_digest():
    figure = FIGURES["K13"]
    first = variant_name(figure, {"lights": ((1.0, 0.0, 0.0),) * 3})
    assert first == variant_name(figure, {"lights": ((1.0, 0.0, 0.0),) * 3})
    assert first != variant_name(figure, {"lights": ((0.0, 1.0, 0.0),) * 3})
    assert first.startswith("K13+")
    assert "/" not in first
    assert re.fullmatch(r"K04\+model=R_-[0-9a-f]{8}", variant_name(FIGURES["K04"], {"model": "R*"}))
    assert len(first) <= 100


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("F004-4", "--set", "alphax=1"), "F004-4 has no parameter 'alphax'. Did you mean alpha_x?"),
        (("F004-4", "--set", "alpha_x"), "--set is 'alpha_x'; give NAME=VALUE, as alpha_x=0.15."),
        (("F004-4", "--set", "=0.15"), "--set is '=0.15'; give NAME=VALUE"),
        (("F004-4", "--set", "alpha_x="), "F004-4's alpha_x is ''; give a number from 0.05 to 1, as 0.25."),
        (("F004-4", "--set", "alpha_x=nan"), "F004-4's alpha_x is 'nan'; give a number"),
        (("F004-4", "--set", "light=1,1"), "F004-4's light is '1,1'; give three numbers from"),
        (("F004-4", "--set", "slices=6", "--set", "slices=7"), "--set names slices twice; give it once."),
        (("--set", "alpha_x=0.15"), "--set changes a figure; name it, as in fixedpipe figures F004-4 --set"),
        (
            ("F004-4", "--check", "--set", "alpha_x=0.15"),
            "--check holds for a figure's own values; leave out --check, or --set.",
        ),
        (("F004-4", "F003-6", "--set", "alpha_x=0.15"), "F003-6 has no parameter 'alpha_x'. There are: "),
        (("F003-10", "--set", "texels=2"), "F003-10 has no parameter 'texels' on OPENGL_1_2; it has on "),
        (("F003-15", "--set", "measured=1"), "F003-15's measured is for its checks alone"),
        (("F003-17", "--set", "a=1"), "F003-17 has no parameters, so 'a' cannot be changed."),
    ],
)
def test_a_wrong_set_is_refused_before_anything_is_written(tmp_path, arguments, sentence):
    done = run("figures", *arguments, "--out", tmp_path / "out")
    assert done.exit_code == 2
    assert sentence in done.output
    assert not (tmp_path / "out").exists()


def test_passes_and_precision_are_of_the_variant():
    done = run("passes", "K14", "--set", "light=0,0,1")
    assert "on GeForce 256: register combiners, with light=0,0,1" in done.output
    wrong = run("passes", "K14", "--set", "light=0,0,0")
    assert wrong.exit_code == 2
    assert "K14's light is '0,0,0'; give three numbers" in wrong.output
    tables = [
        run("precision", "K14", "--size", "16", "--bits", "6", *more).output
        for more in ((), ("--set", "diffuse=0,0,0"))
    ]
    assert "register combiners, with diffuse=0,0,0\n16x16 pixels" in tables[1]
    numbers = [[line for line in table.splitlines() if line.strip().startswith("6 ")] for table in tables]
    assert numbers[0] != numbers[1]


def test_parameters_are_printed_with_value_unit_range_and_sentence(tmp_path):
    path = tmp_path / "p.json"
    done = run("parameters", "F004-8", "--json", path)
    assert done.exit_code == 0
    assert (
        "alpha_x=0.2\n    0.25 on GEFORCE_256\n    The highlight's width along the tangents: the smaller, "
    ) in done.output
    assert "map_size=256 (texels)\n" in done.output
    assert "    Give a power of two from 4 to 1024.\n" in done.output
    rows = {row["name"]: row for row in json.loads(path.read_text())}
    assert list(rows) == list(FIGURES["F004-8"].parameters)
    assert rows["alpha_x"]["on"] == {"GEFORCE_256": "0.25"}
    assert rows["spread"] == {
        "name": "spread",
        "default": "6",
        "unit": "degrees",
        "allowed": "a number from 0 to 45",
        "does": "The strokes' directions vary by so much to either side.",
        "of": "",
        "on": {},
    }


def test_parameters_of_one_way_alone_name_its_machines():
    done = run("parameters", "F003-10")
    assert "texels=4\n    4 on GEFORCE_3, INFINITE_REALITY\n" in done.output


def test_parameters_that_checks_alone_change_are_not_offered():
    assert "measured" not in run("parameters", "F003-15").output


def test_a_figure_without_parameters_says_so():
    done = run("parameters", "F003-17")
    assert done.exit_code == 0
    assert done.output == "F003-17 has no parameters: Depth image seen from the light.\n"


def test_the_example_of_parameters_changes_a_value_that_there_is():
    assert "fixedpipe figures F004-2 --set map_size=128\n" in run("parameters", "F004-2").output
    assert "It has an effect only together with height_field." in run("parameters", "F004-7").output
    assert "For example: fixedpipe" not in run("parameters", "F004-7").output


def test_parameters_of_no_figure_are_refused_with_the_nearest():
    done = run("parameters", "F004--4")
    assert done.exit_code == 2
    assert "There is no figure 'F004--4'. Did you mean F004-4?" in done.output


def test_a_variant_by_the_ideal_is_no_picture_of_the_figure_either(tmp_path):
    done = run("figures", "K14", "--profile", "IDEAL", "--set", "cells=8", "--size", "16", "--out", tmp_path)
    assert done.exit_code == 0, done.output
    drawn = FIGURES["K14"].render("IDEAL", 16, cells=8)
    np.testing.assert_array_equal(picture_of(tmp_path, "K14+cells=8"), drawn.image()[..., :3])
    (machine,) = kept.record(tmp_path, "K14+cells=8")["machines"]
    assert machine["pictures"]["machine"]["caption"].endswith("; cells = 8")
