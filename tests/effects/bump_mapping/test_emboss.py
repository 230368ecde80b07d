"""K13: embossing against the height's derivative, and the highlight's closed forms on the ideal."""

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import emboss
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import G400, GEFORCE_256, IDEAL, MULTITEXTURE, NV2A, OPENGL_1_2
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState

SIZE = 32
# Of each form: its passes, what it multiplies the difference by, and whether that is added to n.l.
FORMS = {
    "one unit": (emboss.one_unit_passes, emboss.ONE_UNIT_GAIN, False),
    "two units": (emboss.two_unit_passes, emboss.TWO_UNITS_GAIN, False),
    "combiners": (emboss.combiner_passes, emboss.COMBINERS_GAIN, True),
}
BOARDS = {"one unit": OPENGL_1_2, "two units": MULTITEXTURE, "combiners": GEFORCE_256}
LIGHT = normalize(np.array([-0.5, 0.3, 0.8]))


def waves(relief, size=SIZE):
    """One smooth bump: heights and both slopes, float64 [size, size]."""
    s, t = height_fields.texel_centers(size, size)
    a, b = 2.0 * np.pi * s, 2.0 * np.pi * t
    heights = relief * (0.25 * (2.0 + np.cos(a) + np.cos(b)))
    return heights, -0.5 * np.pi * relief * np.sin(a), -0.5 * np.pi * relief * np.sin(b)


def square(profile, heights, light, form, size=SIZE, **options):
    """A square with a texel for each pixel."""
    panel = Panel(0, 0, size, size)
    loading, height_map = emboss.load(heights, "heights", profile)
    passes = FORMS[form][0](
        surfaces.plane(), height_map, orthographic_view(panel), Light(tuple(light)), profile,
        **{"color": (1.0, 1.0, 1.0), **options},
    )  # fmt: skip
    return (panel.clear((0.0, 0.0, 0.0)), *loading, *passes)


def ideal(*arguments, size=SIZE, **options):
    commands = square(IDEAL, *arguments, size=size, **options)
    return execute_ideal(commands, size, size).color[::-1, :, :3]


def test_emboss_coordinates_are_the_extensions():
    """NV_texgen_emboss's formulas, component by component, for frames of any orientation."""
    random = np.random.Generator(np.random.PCG64(1))
    n, l, ct = (normalize(random.standard_normal((50, 3))) for _ in range(3))  # noqa: E741 (the extension's)
    pct, ks, kt = random.uniform(0.0, 1.0, (50, 2)), 0.03, 0.05
    b = np.stack(
        [
            n[:, 1] * ct[:, 2] - ct[:, 1] * n[:, 2],
            n[:, 2] * ct[:, 0] - ct[:, 2] * n[:, 0],
            n[:, 0] * ct[:, 1] - ct[:, 0] * n[:, 1],
        ],
        axis=-1,
    )
    bn = b / np.sqrt((b * b).sum(axis=-1, keepdims=True))
    t = np.stack(
        [
            bn[:, 1] * n[:, 2] - n[:, 1] * bn[:, 2],
            bn[:, 2] * n[:, 0] - n[:, 2] * bn[:, 0],
            bn[:, 0] * n[:, 1] - n[:, 0] * bn[:, 1],
        ],
        axis=-1,
    )
    expected = np.stack([pct[:, 0] + ks * (l * bn).sum(-1), pct[:, 1] - kt * (l * t).sum(-1)], axis=-1)
    assert emboss.emboss_coordinates(n, ct, l, pct, (ks, kt)) == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("surface", [surfaces.plane(), surfaces.sphere(8, 5), surfaces.torus(8, 6)])
def test_the_second_reading_moves_away_from_the_light(surface):
    vectors = np.broadcast_to(LIGHT, surface.positions.shape)
    moved = emboss.emboss_coordinates(
        surface.normals, surface.binormals, vectors, surface.texture_coordinates, (1.0, 1.0)
    )
    along = np.stack([dot(vectors, surface.tangents), dot(vectors, surface.binormals)], axis=-1)
    assert moved - surface.texture_coordinates == pytest.approx(-along, abs=1e-6)
    assert cross(surface.tangents, surface.binormals) == pytest.approx(surface.normals, abs=1e-5)


@pytest.mark.parametrize("form", FORMS)
def test_what_is_embossed_is_the_derivative_along_the_light_to_first_order(form):
    """Half the relief halves the distance of the readings, and the error with it, beside the map's texels."""
    _, _, added = FORMS[form]
    errors = []
    for relief in (0.08, 0.04):
        heights, slope_s, slope_t = waves(relief, 256)
        image = ideal(heights, LIGHT, form, size=256)[..., 0]
        term = image - LIGHT[2] if added else image / LIGHT[2] - 1.0
        derivative = -(slope_s * LIGHT[0] + slope_t * LIGHT[1])
        errors.append(np.sqrt(np.mean((term - derivative) ** 2) / np.mean(derivative**2)))
    assert errors[0] < 0.2
    assert errors[1] / errors[0] == pytest.approx(0.5, abs=0.15)


@pytest.mark.parametrize("form", FORMS)
def test_a_light_right_above_shades_nothing(form):
    heights, *_ = waves(0.1)
    image = ideal(heights, (0.0, 0.0, 1.0), form)
    assert np.ptp(image) < 1e-12 and image[0, 0, 0] == pytest.approx(1.0)


@pytest.mark.parametrize("form", FORMS)
def test_grooves_along_the_light_are_not_seen(form):
    """Flat where the slope along the light is zero."""
    grooves = np.broadcast_to(waves(0.1)[0].mean(axis=1, keepdims=True), (SIZE, SIZE))
    along, across = (ideal(grooves, light, form)[..., 0] for light in ((0.6, 0.0, 0.8), (0.0, 0.6, 0.8)))
    assert np.ptp(along) < 1e-12
    assert np.ptp(across) > 0.05


@pytest.mark.parametrize(("form", "level"), [("one unit", 0.5), ("two units", 0.25), ("combiners", 0.5)])
def test_a_highlight_on_level_ground_is_the_smooth_surfaces(form, level):
    """Light and viewer above: n.h = 1; the two units' environments give half of it."""
    image = ideal(np.ones((4, 4)), (0.0, 0.0, 1.0), form, color=(0.25, 0.1, 0.0), specular=0.5)
    assert image[0, 0] == pytest.approx(np.array([0.25, 0.1, 0.0]) + level, abs=1e-12)


@pytest.mark.parametrize("form", FORMS)
def test_the_highlight_is_embossed_along_the_halfway_vector(form):
    heights, slope_s, slope_t = waves(0.04, 64)
    dull, shining = (
        ideal(heights, LIGHT, form, size=64, color=(0.2, 0.2, 0.2), specular=specular)[..., 0]
        for specular in (0.0, 0.5)
    )
    half = normalize(LIGHT + np.array([0.0, 0.0, 1.0]))
    derivative = -(slope_s * half[0] + slope_t * half[1])
    highlight = shining - dull
    assert np.corrcoef(highlight.ravel(), derivative.ravel())[0, 1] > 0.95


def test_the_dark_side_has_neither_light_nor_highlight():
    for form in FORMS:
        assert ideal(np.ones((4, 4)), (0.3, 0.0, -0.95), form, specular=1.0).max() == 0.0


@pytest.mark.parametrize("form", FORMS)
def test_the_boards_draw_what_the_ideal_draws_within_their_bytes(form):
    """A byte of H0 and H1 each, times the gain."""
    heights, *_ = waves(0.08)
    profile, gain = BOARDS[form], FORMS[form][1]
    commands = square(profile, heights, LIGHT, form, color=(0.8, 0.6, 0.4), ambient=(0.1, 0.1, 0.1))
    image = execute(commands, profile, SIZE, SIZE).framebuffer.color[::-1, :, :3] / 255.0
    exact = ideal(heights, LIGHT, form, color=(0.8, 0.6, 0.4), ambient=(0.1, 0.1, 0.1))
    assert np.abs(image - exact).max() <= (2.0 * gain + 1.5) / 255.0


@pytest.mark.parametrize(
    ("form", "profile", "draws"),
    [("one unit", OPENGL_1_2, 4), ("two units", G400, 3), ("combiners", NV2A, 2)],
)
def test_a_highlight_and_diffuse_light_take_this_many_draws(form, profile, draws):
    commands = square(profile, waves(0.1)[0], LIGHT, form, specular=0.5)
    validate(commands, profile, SIZE, SIZE, 24)
    assert len(commands) - 2 == draws


@pytest.mark.parametrize(("form", "profile"), [("two units", OPENGL_1_2), ("combiners", MULTITEXTURE)])
def test_a_board_refuses_the_passes_of_a_better_one(form, profile):
    with pytest.raises(UnsupportedState):
        validate(square(profile, waves(0.1)[0], LIGHT, form), profile, SIZE, SIZE, 24)


@pytest.mark.parametrize("heights", [np.zeros((4, 4)), np.array([[0.1, -0.1]]), np.array([[np.nan, 1.0]])])
def test_heights_below_zero_or_all_zero_are_refused(heights):
    with pytest.raises(ValueError, match=r"give some above zero|holds NaN or infinity"):
        emboss.load(heights, "heights", GEFORCE_256)
