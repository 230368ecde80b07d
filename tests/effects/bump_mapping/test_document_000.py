"""H41 to H44: Blinn's derivatives, Kilgard's passes and powers, a vertex program's vectors."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import blinn, two_pass_bumps, vertex_program_vectors
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors
from fixedpipe.effects.geometry.views import Light, orthographic_view, perspective_view, row_of_panels
from fixedpipe.effects.passes.encoding import vector_texels
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, IDEAL
from fixedpipe.pipeline.textures.images import texture_2d

SIZE = 16


def field(edge=16):
    return height_fields.smooth(height_fields.pebbles(edge, edge, 4, 3)) * 0.5


def test_at_texels_centres_blinns_normals_are_the_maps():
    heights = field()
    expected = height_fields.frames(*height_fields.slopes(heights))[0]
    np.testing.assert_allclose(blinn.normal_map(heights), expected, atol=1e-12)


def test_derivatives_are_those_of_a_smooth_field():
    place = (np.arange(256) + 0.5) / 256
    s, t = np.meshgrid(place, place)
    heights = 0.1 * np.sin(2.0 * np.pi * s) * np.cos(2.0 * np.pi * t)
    at = np.random.default_rng(1).random((2, 50))
    d_u, d_v = blinn.derivatives(heights, *at)
    u, v = 2.0 * np.pi * at
    np.testing.assert_allclose(d_u, 0.2 * np.pi * np.cos(u) * np.cos(v), atol=1e-3)
    np.testing.assert_allclose(d_v, -0.2 * np.pi * np.sin(u) * np.sin(v), atol=1e-3)


def test_steeper_where_the_surface_is_shorter():
    heights = field()
    (n,) = blinn.normals(heights, [0.3], [0.4])
    (stretched,) = blinn.normals(heights, [0.3], [0.4], (2.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    assert stretched[0] / stretched[2] == pytest.approx(0.5 * n[0] / n[2])
    assert stretched[1] / stretched[2] == pytest.approx(n[1] / n[2])


@pytest.mark.parametrize("exponent", [0, -1, 2.5])
def test_a_power_that_is_not_whole_is_refused(exponent):
    with pytest.raises(ValueError, match="exponent"):
        blinn.integer_power(np.ones(2), exponent)


def test_powers_by_squaring():
    x = np.linspace(0.0, 1.0, 9)
    for exponent in (1, 2, 3, 8, 13):
        np.testing.assert_allclose(blinn.integer_power(x, exponent), x**exponent, rtol=1e-12)


# ----------------------------------------------------------------------------------------- the passes


def drawn(profile, exponent, specular, color, normalized, light=(0.5, 0.3, 0.8)):
    """A flat square with a flat map: RGB of its middle, and what the equation says there."""
    (panel,) = row_of_panels(1, SIZE)
    view, surface, lamp = orthographic_view(panel), surfaces.plane(), Light(light)
    flat = np.broadcast_to((0.0, 0.0, 1.0), (4, 4, 3))
    vectors = light_vectors(surface, lamp), half_vectors(surface, view, lamp)
    commands = (
        panel.clear((0.0, 0.0, 0.0)),
        TexImage(label="load n", texture="n", image=texture_2d(vector_texels(flat, profile))),
        *two_pass_bumps.load_normalizers(256, profile, specular, exponent),
        *two_pass_bumps.lighting_passes(
            surface, vectors, "n", view, profile,
            color=color, ambient=(0.1, 0.0, 0.2), specular=specular, exponent=exponent, normalized=normalized,
        ),
    )  # fmt: skip
    if profile is IDEAL:
        found = execute_ideal(commands, SIZE, SIZE).color
    else:
        found = execute(commands, profile, SIZE, SIZE).framebuffer.color / 255.0
    n, (to_light, half) = np.array((0.0, 0.0, 1.0)), (v[0] for v in vectors)
    expected = blinn.radiance(
        n, to_light, half, 1.0, color=color, ambient=(0.1, 0.0, 0.2), specular=specular, exponent=exponent
    )
    return found[SIZE // 2, SIZE // 2, :3], expected


@pytest.mark.parametrize("normalized", [False, True])
@pytest.mark.parametrize("exponent", two_pass_bumps.EXPONENTS)
def test_the_passes_are_the_equation(exponent, normalized):
    found, expected = drawn(IDEAL, exponent, 0.4, (0.5, 0.4, 0.3), normalized)
    np.testing.assert_allclose(found, expected, atol=1e-4)
    found, expected = drawn(GEFORCE_3, exponent, 0.4, (0.5, 0.4, 0.3), normalized)
    # Half a step of n.h of a byte, times the exponent.
    np.testing.assert_allclose(found, expected, atol=(2.0 + 0.6 * exponent) / 255.0)


def test_light_from_below_the_surface_lights_nothing():
    found, _ = drawn(IDEAL, 8, 1.0, (1.0, 1.0, 1.0), True, light=(0.9, 0.0, -0.1))
    np.testing.assert_allclose(found, (0.1, 0.0, 0.2), atol=1e-6)


def test_sixteen_takes_a_third_combiner_which_a_geforce_256_has_not():
    with pytest.raises(ValueError, match="combiner"):
        drawn(GEFORCE_256, 16, 1.0, (1.0, 1.0, 1.0), True)
    drawn(GEFORCE_256, 8, 1.0, (1.0, 1.0, 1.0), True)


@pytest.mark.parametrize("exponent", [1, 3, 32])
def test_exponents_that_squaring_does_not_make_are_refused(exponent):
    with pytest.raises(ValueError, match="squaring makes 2, 4, 8 and 16"):
        two_pass_bumps.root(0.5, exponent)


@pytest.mark.parametrize("strength", [-0.1, 1.5, float("nan")])
def test_strengths_outside_are_refused(strength):
    with pytest.raises(ValueError, match="from 0 to 1"):
        two_pass_bumps.root(strength, 8)


# ------------------------------------------------------------------------------- the vertex program


@pytest.mark.parametrize("point", [False, True])
def test_a_vertex_programs_vectors_are_the_hosts(point):
    ring = surfaces.torus(12, 8)
    light = Light((0.4, 1.5, 2.0), point=point)
    (panel,) = row_of_panels(1, SIZE)
    for view in (orthographic_view(panel), perspective_view(panel, (1.0, 2.0, 4.0))):
        found = vertex_program_vectors.light_and_half_vectors(ring, view, light)
        expected = light_vectors(ring, light), half_vectors(ring, view, light)
        for a, b in zip(found, expected, strict=True):
            np.testing.assert_allclose(a, b, atol=2.0**-20)
            assert (a == a.astype(np.float32)).all()
            # The ring's frames have sines of 20 bits.
            np.testing.assert_allclose(dot(a, a), 1.0, atol=2.0**-18)


def test_a_mirrored_frame_keeps_its_binormal():
    square = surfaces.plane()
    mirrored = replace(square, binormals=-square.binormals)
    light, (panel,) = Light((0.2, 0.5, 0.8)), row_of_panels(1, SIZE)
    found, _ = vertex_program_vectors.light_and_half_vectors(mirrored, orthographic_view(panel), light)
    np.testing.assert_allclose(found[0], normalize(np.array((0.2, -0.5, 0.8))), atol=1e-6)
