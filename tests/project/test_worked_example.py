"""The worked example of docs/adding-things.md is drawn, and its checks pass, and fail where they should."""

import importlib
import json
import re
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from fixedpipe.effects import figures, reflectance
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.cli import main
from fixedpipe.effects.collection import Collection
from fixedpipe.effects.figures import Renderer
from fixedpipe.effects.refusal import Refusal
from fixedpipe.pipeline.enums import TextureFilter, WrapMode
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_3
from fixedpipe.pipeline.state import Sampler

PAGE = Path(__file__).parents[2] / "docs" / "adding-things.md"
MODULES = dict(re.findall(r"^```python\n# (effects/[\w/]+\.py)\n(.*?)^```$", PAGE.read_text(), re.M | re.S))


def collected():
    return Collection(figures, "FIGURE", figures.identify, figures.FORM, beside=figures.BESIDE)


@pytest.fixture
def example(tmp_path, monkeypatch):
    """The modules of the page, as if they lay where they say: (folder of the figure, FIGURES with it)."""
    before = set(sys.modules)
    for path, text in MODULES.items():
        module = tmp_path / path
        module.parent.mkdir(parents=True, exist_ok=True)
        module.write_text(text)
    folder = tmp_path / "effects" / "figures" / "lake_2000"
    (folder / "__init__.py").touch()
    for package in (figures, reflectance):
        beside = str(tmp_path / "effects" / package.__name__.rpartition(".")[2])
        monkeypatch.setattr(package, "__path__", [*package.__path__, beside])
    yield folder, collected()
    for name in set(sys.modules) - before:
        if re.search(r"lake_2000|toon_shading", name):
            package, _, module = name.rpartition(".")
            del sys.modules[name]
            vars(sys.modules.get(package, figures)).pop(module, None)


def test_the_example_is_found_drawn_and_checked(example, tmp_path, monkeypatch):
    _, known = example
    assert set(known) - set(figures.FIGURES) == {"X01"}
    monkeypatch.setattr(figures, "FIGURES", known)
    out = tmp_path / "out"
    result = CliRunner().invoke(main, ["figures", "X01", "--check", "--size", "64", "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert "6 acceptance checks passed." in result.output  # the ideal's once for either method
    (record,) = (json.loads(path.read_text()) for path in out.glob("X01*.json"))
    assert {drawn["profile"] for drawn in record["machines"]} == set(known["X01"].machines)
    kept = {path.stem for path in (out / "pictures").glob("*.js")}
    assert all(drawn["pictures"]["machine"]["digest"] in kept for drawn in record["machines"])


def test_without_its_guard_the_table_begins_again_on_the_machine_alone(example, monkeypatch):
    _, known = example
    figure = known["X01"]
    toon_shading = importlib.import_module("fixedpipe.effects.reflectance.toon_shading")
    nearest = TextureFilter.NEAREST
    unguarded = Sampler(nearest, nearest, WrapMode.CLAMP_TO_EDGE, WrapMode.REPEAT)
    monkeypatch.setattr(toon_shading.texel_pass, "__defaults__", (unguarded,))
    renderer = Renderer(GEFORCE_3, figure.method("GEFORCE_3"), execute, execute_ideal)
    ideal, machine = figure.checks(renderer)
    assert ideal.passed and not machine.passed
    said = re.search(r"(\d+) black pixels on the GeForce 3, on the ideal none", PAGE.read_text())
    assert machine.value == int(said[1])
    picture = renderer.window(Answer.IDEAL, figure, figure.size // 2).max(axis=-1)
    edge = np.abs(np.arange(picture.shape[0]) - (picture.shape[0] - 1) / 2)
    middle = np.hypot(*np.meshgrid(edge, edge)) < 0.25 * picture.shape[0] / 2
    assert picture[middle].min() > 0.2


def test_the_first_check_sees_a_table_whose_axes_are_swapped(example, monkeypatch):
    _, known = example
    figure = known["X01"]
    toon_shading = importlib.import_module("fixedpipe.effects.reflectance.toon_shading")
    right, load = toon_shading.tone, toon_shading.load_table

    def swapped(profile):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(toon_shading, "tone", lambda n_l, n_v: right(n_v, n_l))
            return load(profile)

    monkeypatch.setattr(toon_shading, "load_table", swapped)
    renderer = Renderer(GEFORCE_3, figure.method("GEFORCE_3"), execute, execute_ideal)
    assert not figure.checks(renderer)[0].passed


def test_a_figure_is_drawn_wherever_it_is_made(example):
    _, known = example
    figure = replace(known["X01"], id="mine")
    drawn = figure.render("GEFORCE_3", 32)
    assert drawn.image().shape == drawn.difference.image().shape == (32, 32, 4)
    assert "mine on GeForce 3" in repr(drawn)


def test_the_example_under_another_name_is_not_found_without_a_word(example):
    folder, _ = example
    shutil.copy(folder / "x01_toon_sphere.py", folder / "toon.py")
    with pytest.raises(Refusal, match=r"lake_2000\.toon is named by no id"):
        collected()
