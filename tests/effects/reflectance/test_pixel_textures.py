"""Banks, Blinn-Phong and Ward by pixel textures on the Octane, against the models in float64."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view, perspective_view
from fixedpipe.effects.passes import pixel_texture_copies
from fixedpipe.effects.passes.draws import NEAREST
from fixedpipe.effects.reflectance import brdfs, pixel_textures
from fixedpipe.effects.reflectance.material_textures import Material
from fixedpipe.effects.reflectance.sampled_functions import positions, sampled
from fixedpipe.pipeline.commands import CopyPixels
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, OCTANE
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState

SIZE = 32
LIGHT, VIEW = normalize(np.array([0.5, 0.3, 0.8])), np.array([0.0, 0.0, 1.0])
PANEL = Panel(0, 0, SIZE, SIZE)


def material(seed=1):
    """Frames, alphas, k_s and exponents that differ from texel to texel; everything faces light and eye."""
    random = np.random.Generator(np.random.PCG64(seed))
    shape = (SIZE, SIZE)
    normals = normalize(random.uniform(-0.4, 0.4, (*shape, 3)) + np.array([0.0, 0.0, 1.0]))
    tangents = normalize(cross(random.standard_normal((*shape, 3)), normals))
    return Material(
        normals,
        tangents,
        cross(normals, tangents),
        random.uniform(0.2, 1.0, shape),
        random.uniform(0.5, 1.0, shape),
        random.uniform(0.2, 1.0, shape),
        2.0 ** random.integers(1, 6, shape),
    )


def expected(name, m):
    """The model at each texel, which is a pixel's centre: float64 [SIZE, SIZE]."""
    half = brdfs.half_vector(LIGHT, VIEW)
    frame = m.normals, m.tangents
    if name == "banks":
        return brdfs.banks(LIGHT, VIEW, *frame, m.k_s)
    if name == "ward":
        return brdfs.ward(LIGHT, VIEW, *frame, m.binormals, m.alpha_x, m.alpha_y, m.k_s)
    exponent = 1.0 if name == "root" else m.exponent
    lobe = half, m.tangents, m.binormals, m.alpha_x, m.alpha_y
    return brdfs.anisotropic_blinn_phong(*lobe, m.k_s, exponent)


def drawn(name, m, profile, **more):
    """The model's commands for a square that fills the window, a texel for each pixel."""
    if name == "root":
        more["with_exponent"] = False
    effect = getattr(pixel_textures, {"root": "blinn_phong"}.get(name, name))
    view = orthographic_view(PANEL)
    light = Light(tuple(LIGHT))
    commands = effect(surfaces.plane(), m, view, light, profile, sampler=NEAREST, **more)
    return (PANEL.clear((0.0, 0.0, 0.0)), *commands)


def on_octane(commands, bits=8):
    result = execute(commands, OCTANE, SIZE, SIZE, color_bits=bits)
    assert result.undefined == 0  # every group's alpha is one
    return result.framebuffer.color[::-1, :, :3] / (2.0**bits - 1.0)


def root_mean_square(a):
    return float(np.sqrt((a * a).mean()))


# Bits of textures and framebuffer, and bounds of the error's RMS and maximum in codes: Measured, with a third
# of slack. Reasons: every texture, product and copy rounds by half a code at most, some ten times. The
# Blinn-Phong table's 64 x 256 texels are joined linearly, N doubling every nine of them, and the exponent
# multiplies e's error by up to N/2 = 16. sqrt(e) has an infinite slope at zero: half a code off there is
# up to sqrt(1/2 code). Ward's S over 8 has few codes, and the copy that takes the 8 back multiplies their
# error.
BOUNDS = {
    ("banks", 8): (0.75, 3.0),
    ("banks", 12): (0.85, 4.0),
    ("blinn_phong", 8): (1.1, 10.0),
    ("blinn_phong", 12): (7.0, 150.0),
    ("root", 8): (0.75, np.sqrt(0.5 / 255) * 255),
    ("root", 12): (1.3, np.sqrt(0.5 / 4095) * 4095),
    ("ward", 8): (0.9, 5.0),
    ("ward", 12): (2.3, 18.0),
}


@pytest.mark.parametrize(("name", "bits"), list(BOUNDS))
def test_a_model_on_the_octane_is_the_float_model_within_codes(name, bits):
    m, one = material(), 2.0**bits - 1.0
    picture = on_octane(drawn(name, m, OCTANE, bits=bits), bits)
    error = (picture - np.clip(expected(name, m), 0.0, 1.0)[..., None]) * one
    most, largest = BOUNDS[name, bits]
    assert root_mean_square(error) <= most
    assert np.abs(error).max() <= largest


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 22))
@pytest.mark.parametrize(("name", "bits"), list(BOUNDS))
def test_a_model_on_the_octane_keeps_its_bounds_on_other_frames(name, bits, seed):
    m, (most, largest) = material(seed), BOUNDS[name, bits]
    picture = on_octane(drawn(name, m, OCTANE, bits=bits), bits)
    error = (picture - np.clip(expected(name, m), 0.0, 1.0)[..., None]) * (2.0**bits - 1.0)
    assert root_mean_square(error) <= most
    assert np.abs(error).max() <= 1.5 * largest  # the largest of 1024 differs from material to material


# The ideal rounds nothing but the index of the color table, of 2^14 entries: half an entry of d's range of
# two is 6e-5. Tables' texels are joined linearly, and within half a texel of an end they are constant.
@pytest.mark.parametrize(
    ("name", "largest"), [("banks", 5e-4), ("ward", 1e-3), ("root", 0.0157), ("blinn_phong", 0.04)]
)
def test_a_model_in_the_ideal_is_the_float_model_but_for_its_tables(name, largest):
    m = material()
    commands = drawn(name, m, IDEAL)
    picture = execute_ideal(commands, SIZE, SIZE).color[::-1, :, 0]
    assert np.abs(picture - expected(name, m)).max() <= largest


def test_specular_colours_the_result_and_the_gate_is_the_diffuse_pass_s():
    m, specular = material(), np.array([1.0, 0.5, 0.25])
    for name in ("banks", "ward"):
        white, colored = (
            on_octane(drawn(name, m, OCTANE)),
            on_octane(drawn(name, m, OCTANE, specular=specular)),
        )
        assert np.abs(colored - white * specular).max() <= 2.0 / 255.0
    gated = on_octane(drawn("blinn_phong", m, OCTANE, gated=True))
    gate = np.minimum(1.0, 4.0 * np.maximum(dot(m.normals, LIGHT), 0.0))[..., None]
    assert np.abs(gated - on_octane(drawn("blinn_phong", m, OCTANE)) * gate).max() <= 1.5 / 255.0


def test_the_copies_touch_the_polygon_s_pixels_alone():
    m, profile = material(), OCTANE
    left, right = Panel(0, 0, SIZE, SIZE), Panel(SIZE, 0, SIZE, SIZE)
    background = (0.2, 0.4, 0.6)
    for name in ("banks", "blinn_phong", "ward"):
        effect = getattr(pixel_textures, name)
        commands = [left.clear(background), right.clear(background)]
        for panel in (left, right):
            surface = surfaces.plane(1, 1, 0.5, 0.75)
            commands += effect(surface, m, orthographic_view(panel), Light(tuple(LIGHT)), profile)
        color = execute(commands, profile, 2 * SIZE, SIZE).framebuffer.color
        assert (color[:, :SIZE] == color[:, SIZE:]).all()
        inside = np.zeros((SIZE, SIZE), bool)
        inside[SIZE // 8 : -SIZE // 8, SIZE // 4 : -SIZE // 4] = True
        assert (color[:, :SIZE][~inside, :3] == (51, 102, 153)).all()
        assert (color[:, :SIZE][inside, :3] != (51, 102, 153)).any(axis=-1).mean() > 0.9


def test_each_effect_counts_its_copies():
    blunt = replace(material(), alpha_x=np.full((SIZE, SIZE), 0.5))
    counted = {}
    for name in ("banks", "blinn_phong", "root", "ward"):
        copies = [c for c in drawn(name, blunt, OCTANE) if isinstance(c, CopyPixels)]
        counted[name] = len(copies), sum(c.pixel_texture is not None for c in copies)
    assert counted == {"banks": (4, 2), "blinn_phong": (1, 1), "root": (1, 1), "ward": (3, 2)}
    # A large k_s / (4 pi ax ay) is taken back by one copy more.
    sharp = replace(blunt, alpha_y=np.full((SIZE, SIZE), 0.2))
    assert sum(isinstance(c, CopyPixels) for c in drawn("ward", sharp, OCTANE)) == 4


def test_a_large_factor_of_ward_s_model_is_taken_back():
    m = replace(material(), alpha_x=np.full((SIZE, SIZE), 0.2), alpha_y=np.full((SIZE, SIZE), 0.25))
    picture = on_octane(drawn("ward", m, OCTANE))[..., 0]
    error = picture - np.clip(expected("ward", m), 0.0, 1.0)
    # The factor, 0.3 to 1.6 here, multiplies what was rounded before, and above all m's codes of 8/255.
    # Measured: 2.5 codes.
    assert root_mean_square(error) * 255 <= 3.4


@pytest.mark.parametrize("name", ["banks", "blinn_phong", "ward"])
def test_copies_by_way_of_the_host_s_memory_draw_the_same_bits(name):
    m = material()
    commands = drawn(name, m, OCTANE)
    by_host = pixel_texture_copies.through_host(commands)
    assert not any(isinstance(c, CopyPixels) for c in by_host)
    assert (on_octane(by_host) == on_octane(commands)).all()
    wide = drawn(name, m, OCTANE, bits=12)
    floats = pixel_texture_copies.through_host(wide, type="FLOAT")
    assert (on_octane(floats, 12) == on_octane(wide, 12)).all()
    ideal = drawn(name, m, IDEAL)
    pictures = [execute_ideal(c, SIZE, SIZE).color for c in (ideal, pixel_texture_copies.through_host(ideal))]
    assert (pictures[0] == pictures[1]).all()


def test_banks_s_bracket_is_raised_to_its_exponent_by_one_copy_more():
    m, exponent = material(), 6.0
    commands = drawn("banks", m, OCTANE, exponent=exponent)
    assert sum(isinstance(c, CopyPixels) for c in commands) == 5
    true = brdfs.banks(LIGHT, VIEW, m.normals, m.tangents, m.k_s, exponent)
    error = on_octane(commands)[..., 0] - true
    # The bracket's codes, 0.52 off before, times the power's slope of up to 6.
    assert root_mean_square(error) * 255 <= 6 * BOUNDS["banks", 8][0]
    ideal = execute_ideal(drawn("banks", m, IDEAL, exponent=exponent), SIZE, SIZE).color[::-1, :, 0]
    assert np.abs(ideal - true).max() <= 6 * 5e-4


def test_what_one_color_matrix_cannot_hold_is_refused():
    m, light = material(), Light(tuple(LIGHT))
    view = orthographic_view(PANEL)
    with pytest.raises(ValueError, match="light vector changes"):
        pixel_textures.banks(surfaces.plane(), m, view, Light((0.0, 0.0, 2.0), point=True), OCTANE)
    with pytest.raises(ValueError, match="viewing vector changes"):
        pixel_textures.ward(surfaces.plane(), m, perspective_view(PANEL, (0.0, 0.0, 4.0)), light, OCTANE)
    with pytest.raises(ValueError, match="halfway vector changes"):
        pixel_textures.blinn_phong(surfaces.sphere(), m, view, light, OCTANE)


def test_a_turned_polygon_has_its_vectors_in_its_own_frame():
    surface = surfaces.plane(1, 1, 2.0, 2.0).rotated(rotation("y", 35.0))
    m = material()
    view = orthographic_view(PANEL)
    commands = pixel_textures.banks(surface, m, view, Light(tuple(LIGHT)), OCTANE, sampler=NEAREST)
    picture = execute(commands, OCTANE, SIZE, SIZE).framebuffer.color[::-1, :, 0] / 255.0
    local = [surface.to_local(v)[0] for v in (LIGHT, VIEW)]
    values = brdfs.banks(*local, m.normals, m.tangents, m.k_s)
    # Which texel a pixel shows: the square's corners are beyond the window.
    x = ((np.arange(SIZE) + 0.5) / SIZE * 2.0 - 1.0) / np.cos(np.radians(35.0))
    y = (np.arange(SIZE) + 0.5) / SIZE * 2.0 - 1.0
    column, row = (np.floor((c / 4.0 + 0.5) * SIZE).astype(int) for c in (x, y))
    shown = values[row[:, None], column[None, :]]
    close = np.abs(picture - shown) * 255.0 <= BOUNDS["banks", 8][1]
    assert close.mean() > 0.9  # a texel's edge may lie on either side of a pixel's centre


def test_machines_without_pixel_textures_are_told_so():
    with pytest.raises(UnsupportedState, match="GeForce 256"):
        validate(drawn("banks", material(), GEFORCE_256), GEFORCE_256, SIZE, SIZE)


def test_a_table_holds_its_function_at_both_ends_and_at_centres_between():
    at = positions(8)
    assert at[0] == 0.0
    assert at[-1] == 1.0
    assert (at[1:-1] == (np.arange(1, 7) + 0.5) / 8).all()
    table = sampled(brdfs.banks_r, 8, profile=IDEAL)
    assert (table.ideal[0][0, 0, :, 0] == np.sqrt(1.0 - at)).all()
    assert (
        sampled(brdfs.banks_r, 8, profile=OCTANE, bits=12).levels[0][0, 0, :, 0]
        == np.floor(np.sqrt(1.0 - at) * 4095 + 0.5)
    ).all()
    plane = sampled(lambda s, t: s * (1.0 - t), 4, 2, profile=IDEAL).ideal[0][0, ..., 0]
    assert (plane == [positions(4), np.zeros(4)]).all()


def test_the_diffuse_pass_adds_a_colour_s_part_and_an_ambient_one():
    m, color, ambient = material(), (0.5, 0.25, 0.1), (0.05, 0.1, 0.0)
    m = replace(
        m, normals=m.normals * np.where(np.arange(SIZE) % 4 == 0, -1.0, 1.0)[:, None]
    )  # some face away
    surface, view, light = surfaces.plane(), orthographic_view(PANEL), Light(tuple(LIGHT))
    expected = np.maximum(dot(m.normals, LIGHT), 0.0)[..., None] * color + ambient
    depth = pixel_texture_copies.polygon(
        "depth alone", surface, view, first=True, mask=pixel_texture_copies.ALPHA
    )
    for profile in (OCTANE, IDEAL):
        scene = surface, m, view, light, profile
        added = pixel_textures.diffuse(*scene, color=color, ambient=ambient, sampler=NEAREST)
        frame = (PANEL.clear((0.0, 0.0, 0.0)), depth, *added)
        if profile is OCTANE:
            picture, bound = on_octane(frame), 0.53 / 255.0  # a code and the table's index rounded
        else:
            picture, bound = execute_ideal(frame, SIZE, SIZE).color[::-1, :, :3], 1e-4
        assert np.abs(picture - expected).max() <= bound
