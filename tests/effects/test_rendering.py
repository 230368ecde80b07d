"""A figure in one call: the machine's picture, the ideal's of the same fragments, and their difference."""

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.figures import FIGURES, Difference, difference
from fixedpipe.effects.figures.rendering import delta_of, gain_for
from fixedpipe.pipeline.commands import Clear
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_3, IDEAL, INFINITE_REALITY, OCTANE
from tests.pipeline.framebuffers.test_pictures import decoded

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
    assert drawn.gain == gain_for(delta_of(result.image(), ideal.color)) == drawn.difference.gain
    assert drawn.reference is None and drawn.reference_difference is None


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
    of = drawn.difference
    assert repr(of) == (
        f"<{of.pixels} of 32x16 pixels differ from the ideal, shown x {of.gain}, most at {of.at}>"
    )


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
        assert drawn.difference.identical


def deltas(*sizes):
    """Differences of codes, a pixel each, in one component, of either sign."""
    delta = np.zeros((1, len(sizes), 3), np.int32)
    delta[0, :, 1] = [size * (-1) ** n for n, size in enumerate(sizes)]
    return delta


@pytest.mark.parametrize(
    ("sizes", "bits", "gain"),
    [
        ((0, 0, 0), 8, 128),
        ((1,), 8, 64),  # 128/255 is more than a half
        ((0, 0, 0, 0, 1, 2), 8, 32),
        ((15,), 8, 8),  # 120/255; the next would be 240/255
        ((16,), 8, 4),
        ((127,), 8, 1),
        ((128,), 8, 1),
        ((255,), 8, 1),
        ((1,), 12, 128),
        ((15,), 12, 128),
        ((16,), 12, 64),
        ((4095,), 12, 1),
        ((1,) * 100 + (200,), 8, 64),  # of 101 one may be beyond
        ((1,) * 100 + (200, 200), 8, 1),
        ((0,) * 9999 + (1,) * 5 + (100,), 8, 1),  # of six pixels that differ none may
    ],
)
def test_the_gain_is_the_largest_that_leaves_99_of_100_pixels_in_range(sizes, bits, gain):
    assert gain_for(deltas(*sizes), bits) == gain


def test_a_difference_is_of_codes_and_the_gain_is_of_full_intensity():
    """An ideal within half a code of the machine's colour does not differ; of 12 bits 16 codes are a byte."""
    machine = np.array([[[100, 200, 300, 0], [0, 4095, 7, 4095]]], np.int32)
    ideal = np.array([[[100.49, 199.51, 299.6, 9.0], [-30.0, 5000.0, 23.4, 0.0]]]) / 4095.0
    np.testing.assert_array_equal(delta_of(machine, ideal, 12), [[[0, 0, 0], [0, 0, -16]]])
    shown = difference(machine, ideal, 8.0, 12)
    np.testing.assert_array_equal(shown, [[[128, 128, 128, 255], [128, 128, 120, 255]]])
    assert difference(machine, ideal, bits=12)[0, 1, 2] == 128 - 64  # 64 x 16/4095


def test_what_is_right_to_its_last_bit_is_identical_and_says_so_instead_of_a_picture():
    commands = (Clear(label="clear", color=(0.3, 0.5, 0.7, 1.0)),)
    for profile, bits in ((OCTANE, 8), (INFINITE_REALITY, 12)):
        machine, ideal = execute(commands, profile, 3, 2), execute_ideal(commands, 3, 2)
        found = Difference(delta_of(machine.codes(), ideal.color, bits), np.zeros((2, 3, 3)), bits)
        assert found.identical and found.at is None and found.pixels == 0 and found._repr_png_() is None
        assert repr(found) == "<identical: no code of 3x2 pixels differs from the ideal's, rounded>"
        assert (found.image()[..., :3] == 128).all()


def test_a_difference_has_the_place_of_its_largest_and_its_measures():
    delta, error = np.zeros((4, 5, 3), np.int32), np.zeros((4, 5, 3))
    delta[3, 1, 0], error[3, 1, 0] = 2, 1.6 / 255
    delta[1, 4, 2], error[1, 4, 2] = -2, -2.4 / 255
    delta[0, 0, 1], error[0, 0, 1] = 1, 2.49 / 255  # a code is what is seen
    found = Difference(delta, error)
    assert (found.at, found.pixels, found.identical) == ((4, 1), 3, False)
    assert found.largest == 2.49 / 255
    np.testing.assert_allclose(found.rms, np.sqrt((error * error).mean()))


def test_a_figure_s_reference_is_of_its_values_and_compared_where_it_has_any(drawn):
    asked = []

    def reference(size, **values):
        asked.append((size, values))
        picture = np.zeros((size, 2 * size, 4))
        picture[:, size:] = 0.5, 0.25, 2.0, 1.0  # the left panel has none
        return picture

    figure = replace(FIGURE, reference=reference)
    found = figure.render("GEFORCE_3", SIZE, light=(0.0, 1.0, 0.2), **SPHERES)
    assert found.reference is found.reference
    ((size, values),) = asked
    assert (size, values["light"], values["slices"]) == (SIZE, (0.0, 1.0, 0.2), 6)
    assert values.keys() == FIGURE.parameters.keys()
    compared = found.reference_difference
    assert not compared.delta[:, :SIZE].any() and not compared.error[:, :SIZE].any()
    right = drawn.image()[:, SIZE:, :3].astype(int)
    np.testing.assert_array_equal(compared.delta[:, SIZE:], right - [128, 64, 255])
    exact = right / 255.0 - [0.5, 0.25, 1.0]
    np.testing.assert_allclose(compared.rms, np.sqrt((exact * exact).mean()))
    assert repr(compared).startswith(f"<{SIZE * SIZE} of 32x16 pixels differ from the reference")
    broken = replace(FIGURE, reference=lambda size, **_: np.zeros((size, size, 4)))
    with pytest.raises(ValueError, match=r"reference has the shape \(16, 16, 4\); it must be \(16, 32, 4\)"):
        broken.reference_picture(SIZE)
    unknown = np.ones((SIZE, 2 * SIZE, 4))
    unknown[3, 5, 1] = np.nan
    broken = replace(FIGURE, reference=lambda size, **_: unknown)
    with pytest.raises(ValueError, match="holds nan at column 5, row 3; give finite colours"):
        broken.reference_picture(SIZE)


def test_what_has_twelve_bits_is_kept_in_sixteen(tmp_path):
    figure = FIGURES["F004-2"]
    drawn = figure.render("INFINITE_REALITY", 24)
    drawn.save(tmp_path / "picture.png")
    kept = decoded((tmp_path / "picture.png").read_bytes())
    codes = drawn.codes()[..., :3]
    assert (drawn.bits, kept.dtype, codes.max() > 255, (codes % 16 > 0).any()) == (12, np.uint16, True, True)
    np.testing.assert_array_equal(kept, np.floor(codes * (65535 / 4095) + 0.5))
    np.testing.assert_array_equal(np.floor(kept * (4095 / 65535) + 0.5), codes)
    assert drawn.result._repr_png_() == drawn._repr_png_() == (tmp_path / "picture.png").read_bytes()
    assert drawn.image().dtype == np.uint8
    np.testing.assert_array_equal(drawn.image()[..., :3], np.floor(codes * (255 / 4095) + 0.5))
    np.testing.assert_array_equal(drawn.difference.delta, codes - drawn.ideal.codes(12)[..., :3])


def test_a_changed_parameter_changes_the_picture_and_is_kept_as_it_was_taken(drawn):
    other = FIGURE.render("GEFORCE_3", SIZE, light=[0, 1, 0.2], diffuse=(1.0, 0.0, 0.0), **SPHERES)
    assert other.changes == {"light": (0, 1, 0.2), "diffuse": (1.0, 0.0, 0.0), **SPHERES}
    assert (other.image() != drawn.image()).any()
