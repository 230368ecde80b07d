"""Volumes: their normals, slices and bricks, the engine block, rays through densities, and pictures."""

import hashlib
from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.acceptance import volume_caster
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import Panel, orthographic_view, perspective_view
from fixedpipe.effects.scenes.objects_and_lamps import Lamp
from fixedpipe.effects.shadows.alpha_coded_shadows import Coding
from fixedpipe.effects.user_pictures.volume import (
    method_for,
    picture_of,
    resampled,
    texture_edges,
    volume_of,
)
from fixedpipe.effects.volumes import slices, volume_rendering
from fixedpipe.effects.volumes.engine_block import engine_block
from fixedpipe.effects.volumes.slices import Volume, bricks, slice_mesh, stored_normals
from fixedpipe.effects.volumes.volume_rendering import (
    LEAST,
    Picture,
    Shading,
    combiners,
    imaging,
    method_of,
    power,
)
from fixedpipe.pipeline.enums import Register
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import (
    GEFORCE_3,
    IDEAL,
    INFINITE_REALITY,
    OCTANE,
    OPENGL_1_2_IMAGING,
    PROFILES,
)

# Measured: on the computer that drew the first picture.
ENGINE_DIGEST = "383db58905e6331cac98f7578e0d057d3c24767cfbc47cf5ccfa2f797f729973"
LAMP = Lamp((2.0, 3.0, 2.5), (0.0, 0.0, 0.0), 2.0, 6.5, infinite=True, half_width=1.6)


def ball(edge, radius=0.7):
    """A ball's density: uint8 [edge, edge, edge], one half at ``radius`` of the volume's half extent."""
    axis = (np.arange(edge) + 0.5) / edge * 2.0 - 1.0
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    away = (np.sqrt(x * x + y * y + z * z) - radius) * edge / 2.0
    return np.floor(255.0 * np.clip(0.5 - away / 4.0, 0.0, 1.0) + 0.5).astype(np.uint8)


BALL = Volume("ball", ball(32), (1.0, 1.0, 1.0))


def picture(size=48, shadows=True, bits=8, **more):
    panel = Panel(0, 0, size, size)
    view = perspective_view(panel, (1.5, 2.0, 6.0), field_of_view=20.0, radius=1.8)
    # The map's texels are large beside the ball, and so its bias: a step of depths is 1 / 57 of a unit.
    coding = Coding(bits=bits, bias=12.0 * 2 ** (bits - 8))
    map_panel = Panel(0, 0, 32, 32) if shadows else None
    return Picture(BALL, view, LAMP, 256, map_panel=map_panel, coding=coding, **more)


def drawn(method, what, profile):
    """RGB float64 [h, w, 3], bottom row first."""
    size = what.view.panel.width
    framebuffer = execute(method(what, profile), profile, size, size).framebuffer
    return framebuffer.color[::-1, :, :3] / (2.0**framebuffer.color_bits - 1.0)


# -------------------------------------------------------------------------------------------- the engine


def test_the_engine_block_has_the_same_bytes_everywhere():
    density = engine_block(32)
    assert density.shape == (32, 32, 64)
    assert density.dtype == np.uint8
    assert hashlib.sha256(density.tobytes()).hexdigest() == ENGINE_DIGEST


def test_the_engine_block_touches_no_face_of_its_box_and_has_bores():
    density = engine_block(128)
    for axis in range(3):
        assert density.take([0, -1], axis=axis).max() == 0
    # Through a bore's middle: open above, a piston below. Between two bores: metal.
    column, between = (density[64, :, int(128 * (1.0 + x))] for x in (-0.22, -0.03))
    assert column[112:].max() == 0
    assert column[60] == 255
    assert between[80] == 255


@pytest.mark.parametrize("rows", [0, 4, 48])
def test_the_engine_block_refuses_rows_that_are_no_power_of_two(rows):
    with pytest.raises(ValueError, match="power of two"):
        engine_block(rows)


# ------------------------------------------------------------------------------------ normals and volumes


def test_a_balls_normals_point_outward():
    stored = stored_normals(BALL.density)
    k, j, i = np.nonzero((BALL.density > 60) & (BALL.density < 200))
    outward = normalize(np.stack([i, j, k], axis=-1) + 0.5 - 16.0)
    found = (stored[k, j, i] - 127.5) / 127.5
    assert np.abs(np.sqrt(dot(found, found)) - 1.0).max() < 0.01
    assert dot(found, outward).min() > 0.99


def test_where_nothing_changes_the_normal_is_zero_and_beyond_a_volume_is_nothing():
    solid = np.full((4, 4, 4), 200, np.uint8)
    stored = stored_normals(solid, zero=128.0)
    assert (stored[1:3, 1:3, 1:3] == 128).all()
    assert stored[1, 1, 0].tolist() == [1, 128, 128]
    assert stored[1, 1, 3].tolist() == [255, 128, 128]


def test_spacing_turns_normals():
    x, _, z = np.meshgrid(*[np.arange(6)] * 3, indexing="ij")
    falling = (200 - 20 * x - 20 * z).astype(np.uint8).transpose(2, 1, 0)
    inner = stored_normals(falling, spacing=(1.0, 1.0, 2.0))[2, 2, 2]
    assert np.allclose((inner - 127.5) / 127.5, np.array([2.0, 0.0, 1.0]) / np.sqrt(5.0), atol=0.005)


def test_a_volumes_texture_has_normals_of_its_box():
    x, _, z = np.meshgrid(*[np.arange(6)] * 3, indexing="ij")
    falling = (200 - 20 * x - 20 * z).astype(np.uint8).transpose(2, 1, 0)
    texel = Volume("v", falling, (1.0, 1.0, 2.0)).texture(127.5).levels[0][2, 2, 2]
    assert np.allclose((texel[:3] - 127.5) / 127.5, np.array([2.0, 0.0, 1.0]) / np.sqrt(5.0), atol=0.005)
    assert texel[3] == 120


def test_the_halfway_vector_lies_between_the_lamp_and_the_eye():
    what = picture()
    light, eye = (
        np.array(v) / np.sqrt(dot(np.array(v), np.array(v))) for v in (LAMP.direction, what.view.eye)
    )
    assert np.allclose(what.light, light)
    assert np.allclose(what.eye, eye)
    assert np.allclose(what.half, (light + eye) / np.sqrt(dot(light + eye, light + eye)))


def test_what_is_as_dense_as_the_surface_is_solid():
    even = Volume("v", np.full((16, 16, 16), 51, np.uint8), (0.7, 0.7, 0.7), 51.0 / 255.0)
    for method, profile in ((imaging, OCTANE), (combiners, GEFORCE_3)):
        image = drawn(method, replace(picture(shadows=False), volume=even), profile)
        assert (image[24, 24] != image[0, 0]).any()


@pytest.mark.parametrize(
    ("density", "iso", "word"),
    [
        (np.zeros((4, 4), np.uint8), 0.5, "layers"),
        (np.zeros((4, 4, 4)), 0.5, "bytes"),
        (BALL.density, 1.0, "iso"),
    ],
)
def test_a_volume_that_is_none_is_refused(density, iso, word):
    with pytest.raises(ValueError, match=word):
        Volume("v", density, (1.0, 1.0, 1.0), iso)


def test_a_volume_without_a_surface_is_refused():
    with pytest.raises(ValueError, match="no surface"):
        Volume("v", np.full((8, 8, 8), 9, np.uint8), (1.0, 1.0, 1.0)).corners()


# ---------------------------------------------------------------------------------------- bricks, slices


def test_bricks_are_those_where_the_surface_is():
    density = np.zeros((64, 64, 64), np.uint8)
    density[20:25, 20:25, 20:25] = 255
    assert bricks(density, 128, 16).tolist() == [[1, 1, 1]]
    density[:] = 255
    # A solid volume is seen at its faces; what is a brick or more within is not.
    found = {tuple(b) for b in bricks(density, 128, 16).tolist()}
    assert found == {(x, y, z) for x, y, z in np.ndindex(4, 4, 4) if {x, y, z} & {0, 3}}


@pytest.mark.parametrize("make_view", [orthographic_view, lambda p: perspective_view(p, (2.0, 1.0, 5.0))])
def test_slices_fill_the_volume_and_their_coordinates_lie_on_their_rays(make_view):
    volume = Volume("v", np.full((32, 16, 16), 255, np.uint8), (0.5, 0.5, 1.0))
    view, count = make_view(Panel(0, 0, 8, 8)), 40
    mesh = slice_mesh(volume, view, count)
    (coordinates,) = mesh.texture_coordinates
    assert coordinates.min() >= -1e-12
    assert coordinates.max() <= 1.0 + 1e-12
    cut = (coordinates * 2.0 - 1.0) * volume.half_extents
    corners = cut.reshape(-1, 3, 3)
    side, up, back, _ = np.array(view.modelview)
    flat = np.stack([corners @ side[:3], corners @ up[:3]], axis=-1)
    a, b = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    area = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    assert area.min() >= -1e-12  # all turned to the eye
    depths = -(volume.corners() @ back[:3] + back[3])
    step = (depths.max() - depths.min()) / count
    assert area.sum() * step == pytest.approx(2.0, rel=0.01)
    assert len(np.unique(np.round(-(cut @ back[:3] + back[3]), 9))) == count
    # Drawn half a step nearer to the eye, at the same place in the window.
    clip = np.array(view.projection) @ np.array(view.modelview)

    def projected(points):
        out = np.concatenate([points, np.ones((len(points), 1))], axis=1) @ clip.T
        return out[:, :2] / out[:, 3:]

    assert np.allclose(projected(cut), projected(mesh.positions), atol=1e-12)
    assert np.allclose((mesh.positions - cut) @ back[:3], 0.5 * step)


def test_bricks_that_are_left_out_change_no_pixel(monkeypatch):
    seen = drawn(imaging, picture(), OCTANE)
    everything = Volume("ball", BALL.density, BALL.half_extents)
    monkeypatch.setattr(slices, "bricks", lambda density, iso: np.array(list(np.ndindex(2, 2, 2))))
    assert len(everything.seen_bricks()) == 8
    whole = drawn(imaging, replace(picture(), volume=everything), OCTANE)
    assert np.abs(seen - whole).max() <= 1.0 / 255.0


# --------------------------------------------------------------------------------------------------- rays


def test_rays_meet_a_ball_where_it_is():
    view = picture().view
    surface = volume_caster.visible(BALL, view)
    points, normals = surface.points[surface.seen], surface.normals[surface.seen]
    assert np.abs(np.sqrt(dot(points, points)) - 0.7).max() < 0.004
    assert dot(normals, normalize(points)).min() > 0.999
    lit = volume_caster.lit(BALL, surface, LAMP.direction)[surface.seen]
    # A ball throws no shadow on itself but where it is turned away.
    facing = dot(normalize(points), normalize(np.array(LAMP.direction)))
    assert lit[facing > 0.1].all()
    assert not lit[facing < -0.02].any()
    bright = volume_caster.lit(BALL, surface, LAMP.direction, 0.5)[surface.seen]
    assert bright[facing > 0.52].all()
    assert not bright[facing < 0.48].any()


def test_rays_know_that_voxels_may_be_flat():
    """The ball's voxels half as high: an ellipsoid."""
    flat = Volume("v", BALL.density, (1.0, 0.5, 1.0))
    surface = volume_caster.visible(flat, picture().view)
    points, normals = surface.points[surface.seen], surface.normals[surface.seen]
    round_again = points * np.array([1.0, 2.0, 1.0])
    assert len(points) > 200
    assert np.abs(np.sqrt(dot(round_again, round_again)) - 0.7).max() < 0.004
    assert dot(normals, normalize(round_again * np.array([1.0, 2.0, 1.0]))).min() > 0.998


def test_rays_are_stopped_by_what_lies_before_them():
    points = np.array([[0.0, -0.95, 0.0], [0.95, -0.95, 0.0], [0.0, 0.95, 0.0]])
    assert volume_caster.occluded(BALL, points, (0.0, 1.0, 0.0)).tolist() == [True, False, False]


# ----------------------------------------------------------------------------------------------- pictures


@pytest.mark.parametrize(
    ("method", "profile", "bound"),
    [
        (imaging, OCTANE, 0.012),
        (imaging, OPENGL_1_2_IMAGING, 0.012),
        (imaging, INFINITE_REALITY, 0.012),
        (combiners, GEFORCE_3, 0.014),
    ],
)
def test_a_ball_is_lit_by_phongs_model(method, profile, bound):
    what = picture(bits=profile.framebuffers.color_bits[0])
    surface = volume_caster.visible(BALL, what.view)
    s, n = what.shading, surface.normals
    fill, light, half = (np.maximum(dot(n, v), 0.0)[..., None] for v in (what.eye, what.light, what.half))
    expected = np.array(s.color) * (s.ambient + s.fill * fill)
    lamp = np.array(s.color) * s.diffuse * light + s.specular * half**s.exponent
    image = drawn(method, what, profile)
    inside = surface.seen & (dot(n, what.eye) > 0.3)
    for where, wanted in ((light[..., 0] > 0.2, expected + lamp), (light[..., 0] == 0.0, expected)):
        at = inside & where
        assert at.sum() > 15
        assert np.sqrt(((image - np.minimum(wanted, 1.0))[at] ** 2).mean()) < bound


@pytest.mark.parametrize("method", [imaging, combiners])
def test_the_ideal_draws_the_same_ball(method):
    what = picture(32, shading=Shading(mask=True))
    ideal = execute_ideal(method(what, IDEAL), 32, 32).color[::-1, :, 0] > 0.5
    surface = volume_caster.visible(BALL, what.view)
    lit = volume_caster.lit(BALL, surface, LAMP.direction, LEAST)
    assert (ideal != lit)[surface.seen].mean() < 0.03


def test_without_shadows_no_pixel_is_darker():
    plain, shadowed = (drawn(imaging, picture(shadows=on), OCTANE) for on in (False, True))
    assert (shadowed <= plain).all()
    assert (
        drawn(combiners, picture(), GEFORCE_3) <= drawn(combiners, picture(shadows=False), GEFORCE_3)
    ).all()


@pytest.mark.parametrize(("method", "profile"), [(imaging, OCTANE), (combiners, GEFORCE_3)])
def test_one_ball_throws_its_shadow_on_another(method, profile):
    """What is turned to the lamp, and is hidden from it, is dark: nine pixels in ten."""
    density = np.maximum(ball(32, 0.5), np.roll(ball(32, 0.3), (8, 9, 7), axis=(0, 1, 2)))
    two = Volume("two balls", density, BALL.half_extents)
    what = replace(picture(64, shading=Shading(mask=True)), volume=two, map_panel=Panel(0, 0, 64, 64))
    surface = volume_caster.visible(two, what.view)
    lit = volume_caster.lit(two, surface, LAMP.direction, LEAST)
    hidden = surface.seen & (dot(surface.normals, what.light) > 0.2) & ~lit
    assert hidden.sum() > 30
    white = drawn(method, what, profile)[..., 0] > 0.5
    assert (~white)[hidden].mean() > 0.9
    assert white[lit].mean() > 0.9


def test_combiners_raise_to_every_power():
    base = np.linspace(0.0, 1.0, 9)
    for exponent in range(1, 128):
        registers = {Register.SPARE1: base, Register.ZERO: np.ones(9)}  # an inverted zero is one
        for stage in volume_rendering._raised(exponent):
            rgb, read = stage.rgb, dict(registers)
            if rgb.ab_output is not Register.DISCARD:
                registers[rgb.ab_output] = read[rgb.a.register] * read[rgb.b.register]
            if rgb.cd_output is not Register.DISCARD:
                registers[rgb.cd_output] = read[rgb.c.register] * read[rgb.d.register]
        assert np.allclose(registers[Register.SPARE1], base**exponent)
        assert np.allclose(power(base, exponent), base**exponent)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"lamp": Lamp((2.0, 3.0, 2.5), (0.0, 0.0, 0.0), 2.0, 6.5)}, "infinite"),
        ({"slices": 0}, "slices"),
    ],
)
def test_a_picture_that_cannot_be_is_refused(changes, word):
    with pytest.raises(ValueError, match=word):
        replace(picture(), **changes)


@pytest.mark.parametrize("values", [{"exponent": 0}, {"exponent": 200}, {"color": (2.0, 0.0, 0.0)}])
def test_a_shading_that_cannot_be_is_refused(values):
    with pytest.raises(ValueError):
        Shading(**values)


def test_each_machine_has_its_method_or_says_why_not():
    with_matrix = {"OPENGL_1_2_IMAGING", "OCTANE", "INFINITE_REALITY", "IDEAL"}
    for name, profile in PROFILES.items():
        if name in with_matrix:
            assert method_of(profile) is imaging
        elif profile.combiners.max_general_combiners >= 8:
            assert method_of(profile) is combiners
        else:
            with pytest.raises(ValueError, match=r"cannot light slices .* GEFORCE_3, NV2A, OCTANE, "):
                method_for(profile)


def test_a_picture_of_any_volume_shows_all_of_it():
    volume = volume_of(ball(20, 0.9)[:, 3:17, :], "cut ball", OCTANE)
    what = picture_of(volume, (1.0, -2.0, 0.5), (0.0, 0.0, 1.0), (0.0, -1.0, 1.0), OCTANE, 48, 64, True)
    drawn_at = (drawn(imaging, what, OCTANE) != drawn(imaging, what, OCTANE)[0, 0]).any(axis=-1)
    rows, columns = np.nonzero(drawn_at)
    assert drawn_at.mean() > 0.3
    assert min(rows.min(), columns.min()) >= 1
    assert max(rows.max(), columns.max()) <= 46
    solid = Volume("v", np.full((16, 16, 16), 255, np.uint8), (1.0, 1.0, 1.0))
    what = picture_of(solid, (1.0, 1.0, 1.0), (0.0, 1.0, 0.0), (1.0, 2.0, 3.0), OCTANE, 64, 64, False)
    image = drawn(imaging, what, OCTANE)
    rows, columns = np.nonzero((image != image[0, 0]).any(axis=-1))
    assert 1 <= min(rows.min(), columns.min(), 63 - rows.max(), 63 - columns.max()) <= 3
    thin = replace(volume, half_extents=(1.0, 0.002, 1.0))
    with pytest.raises(ValueError, match="it would have holes"):
        picture_of(thin, (1.0, 1.0, 1.0), (0.0, 1.0, 0.0), (1.0, 1.0, 1.0), OCTANE, 48, 64, True)
    with pytest.raises(ValueError, match="looks along"):
        picture_of(volume, (0.0, 2.0, 0.0), (0.0, 1.0, 0.0), (1.0, 1.0, 1.0), OCTANE, 48, 64, True)


@pytest.mark.parametrize("profile", [OCTANE, INFINITE_REALITY, GEFORCE_3])
def test_a_picture_of_any_volume_has_no_specks_of_shadow(profile):
    """A ball throws no shadow on itself, whatever a step of depth is on a machine."""
    ways = (0.5, 0.5, 4.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), profile, 64, 256
    plain, shadowed = (
        drawn(method_of(profile), picture_of(BALL, *ways, on), profile) for on in (False, True)
    )
    # One pixel of the outline is darker.
    assert (shadowed < plain - 0.1).any(axis=-1).sum() <= 1


# ------------------------------------------------------------------------------------------- users' volumes


def test_edges_become_powers_of_two():
    assert texture_edges((110, 256, 300), 256) == (128, 256, 256)
    assert texture_edges((2, 8, 9), 256) == (8, 8, 16)


def test_resampling_keeps_means_and_ramps():
    values = np.random.default_rng(3).random((12, 7, 10)).astype(np.float32)
    assert np.array_equal(resampled(values, (12, 7, 10)), values)
    assert resampled(values, (4, 3, 4)).mean() == pytest.approx(values.mean(), rel=1e-5)
    ramp = np.arange(10, dtype=np.float32).reshape(1, 1, 10)
    assert np.allclose(resampled(ramp, (1, 1, 20))[0, 0, 1:-1], (np.arange(1, 19) + 0.5) / 2.0 - 0.5)
    assert np.allclose(resampled(ramp, (1, 1, 5)), np.arange(5) * 2.0 + 0.5)


def test_a_users_volume_keeps_its_surface_and_its_proportions():
    volume = volume_of(ball(16).astype(np.int32) * 100 - 4000, "v", OCTANE, 8750.0, (1.0, 1.0, 2.0))
    assert volume.density.shape == (16, 16, 16)
    assert np.array_equal(volume.density, ball(16))
    assert volume.half_extents == (0.5, 0.5, 1.0)
    assert volume_of(ball(16)[4:12], "v", OCTANE, None, (1.0, 0.5, 4.0)).half_extents == (0.5, 0.25, 1.0)
    assert volume.iso == 0.5


@pytest.mark.parametrize(
    ("values", "iso", "spacing", "word"),
    [
        (np.zeros((4, 4)), None, (1.0, 1.0, 1.0), "edges"),
        (np.zeros((4, 4, 1)), None, (1.0, 1.0, 1.0), "edges"),
        (np.zeros((4, 4, 4), complex), None, (1.0, 1.0, 1.0), "numbers"),
        (np.full((4, 4, 4), 7), None, (1.0, 1.0, 1.0), "All of"),
        (np.full((4, 4, 4), np.nan), None, (1.0, 1.0, 1.0), "NaN"),
        (np.array([[[0.0, 1e300]] * 2] * 2), None, (1.0, 1.0, 1.0), "NaN"),
        (BALL.density, 300.0, (1.0, 1.0, 1.0), "from 0 to 255"),
        (BALL.density, float("nan"), (1.0, 1.0, 1.0), "from 0 to 255"),
        (BALL.density, 0.1, (1.0, 1.0, 1.0), "steps"),
        (BALL.density, None, (1.0, -1.0, 1.0), "spacing"),
        (BALL.density, None, (1.0, float("nan"), 1.0), "spacing"),
        (np.pad(np.ones((1, 1, 1)), 20), None, (1.0, 1.0, 1.0), "64x64x64 voxels, nothing of v"),
    ],
)
def test_what_is_no_volume_is_refused(values, iso, spacing, word):
    with pytest.raises(ValueError, match=word):
        volume_of(values, "v", OCTANE, iso, spacing)
