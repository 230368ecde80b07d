"""A figure in one call: the machine's picture, the ideal's of the same fragments, and their difference."""

import io

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.figures import DIFFERENCE_GAIN, FIGURES, difference
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_3, IDEAL, OCTANE

SIZE = 16
SPHERES = {"slices": 6, "stacks": 4}
FIGURE = FIGURES["F004-4"]


@pytest.fixture(scope="module")
def drawn():
    return FIGURE.render("GEFORCE_3", SIZE, light=(0.0, 1.0, 0.2), **SPHERES)


def test_a_rendering_has_the_machine_s_picture_and_the_ideal_s_of_the_same_fragments(drawn):
    commands = FIGURE.commands(GEFORCE_3, SIZE, light=(0.0, 1.0, 0.2), **SPHERES)
    result = execute(commands, GEFORCE_3, 2 * SIZE, SIZE, record=True)
    np.testing.assert_array_equal(drawn.image(), result.image())
    commands = FIGURE.commands(IDEAL, SIZE, FIGURE.methods[0], light=(0.0, 1.0, 0.2), **SPHERES)
    ideal = execute_ideal(commands, 2 * SIZE, SIZE, guide=result)
    np.testing.assert_array_equal(drawn.ideal.color, ideal.color)
    assert drawn.ideal is drawn.ideal
    np.testing.assert_array_equal(drawn.difference.image(), difference(result.image(), ideal.color))
    exact = result.image()[..., :3] / 255.0 - np.clip(ideal.color[..., :3], 0.0, 1.0)
    np.testing.assert_allclose(drawn.error, exact, atol=1e-12)
    assert DIFFERENCE_GAIN == 8.0


def test_the_ideal_is_guided_where_a_test_of_depths_would_decide_otherwise():
    figure = FIGURES["H37"]
    drawn = figure.render("GEFORCE_256", 32)
    commands = figure.commands(IDEAL, 32)
    guided, free = (execute_ideal(commands, 96, 32, guide=g).color for g in (drawn.result, None))
    assert (guided != free).any()
    np.testing.assert_array_equal(drawn.ideal.color, guided)


def test_its_arrays_have_their_top_row_first(drawn):
    """The light is above: the spheres' upper halves are the brighter ones, in every array."""
    upper, lower = slice(0, SIZE // 2), slice(SIZE // 2, None)
    for image in (drawn.image()[..., :3], drawn.ideal.color[..., :3], drawn.ideal.image()[..., :3]):
        assert image[upper].mean() > 1.5 * image[lower].mean()


def test_a_notebook_shows_it_and_a_file_keeps_it(drawn, tmp_path):
    shown = np.asarray(Image.open(io.BytesIO(drawn._repr_png_())))
    np.testing.assert_array_equal(shown, drawn.image()[..., :3])
    drawn.save(tmp_path / "machine.png")
    drawn.ideal.save(tmp_path / "ideal.png")
    drawn.difference.save(tmp_path / "difference.png")
    for name, image in (("machine", drawn), ("ideal", drawn.ideal), ("difference", drawn.difference)):
        kept = np.asarray(Image.open(tmp_path / f"{name}.png"))
        np.testing.assert_array_equal(kept, image.image()[..., :3])
    assert repr(drawn) == ("<F004-4 on GeForce 3, 32x16 pixels, light=(0.0, 1.0, 0.2), slices=6, stacks=4>")
    assert repr(drawn.difference) == "<a difference of 32x16 pixels>"


def test_the_machine_is_its_name_its_profile_or_a_changed_one():
    by_name = FIGURE.render("OCTANE", SIZE, **SPHERES).image()
    np.testing.assert_array_equal(FIGURE.render(OCTANE, SIZE, **SPHERES).image(), by_name)
    coarse = FIGURE.render(OCTANE.with_precision(texture_bits=4), SIZE, **SPHERES)
    assert coarse.method is FIGURE.method("OCTANE")
    assert (coarse.image() != by_name).any()


def test_of_the_ideal_it_gives_the_ideal_s_own_picture():
    for ideal in (IDEAL, "IDEAL"):
        drawn = FIGURE.render(ideal, SIZE, **SPHERES)
        free = execute_ideal(FIGURE.commands(IDEAL, SIZE, **SPHERES), 2 * SIZE, SIZE)
        np.testing.assert_array_equal(drawn.image(), free.image())
        assert drawn.ideal is drawn.result
        assert not drawn.error.any()
        # Of colours between two bytes, half a byte times the gain.
        assert np.abs(drawn.difference.image()[..., :3].astype(int) - 128).max() <= DIFFERENCE_GAIN / 2


def test_a_changed_parameter_changes_the_picture_and_is_kept_as_it_was_taken(drawn):
    other = FIGURE.render("GEFORCE_3", SIZE, light=[0, 1, 0.2], diffuse=(1.0, 0.0, 0.0), **SPHERES)
    assert other.changes == {"light": (0, 1, 0.2), "diffuse": (1.0, 0.0, 0.0), **SPHERES}
    assert (other.image() != drawn.image()).any()
