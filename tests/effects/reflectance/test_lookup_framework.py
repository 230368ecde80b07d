"""The framework of the paper's figure 1: tables, and each stage on each machine against float evaluation."""

import numpy as np
import pytest

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import unit_vector
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.effects.reflectance import lookup_framework
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, OCTANE

SIZE = 64
LIGHT, EYE = (0.55, 0.35, 0.75), np.array([0.0, 0.0, 1.0])
PANEL = Panel(0, 0, SIZE, SIZE)


def reference(textures):
    """Every stage in float64 at the texels, in ``lookup_framework.STAGES``' order."""
    minus_s, t, u, eighth = textures.parameters(unit_vector(LIGHT, "The light"), EYE)
    f, g = lookup_framework.exponential(minus_s, t), lookup_framework.root_of_power(u, eighth)
    return dict(zip(lookup_framework.STAGES, (minus_s, t, u, eighth, f, g, f * g), strict=True))


def drawn(profile, stage, textures):
    light, view = Light(LIGHT), orthographic_view(PANEL)
    return (
        PANEL.clear((0.0, 0.0, 0.0)),
        *lookup_framework.load_tables(profile),
        *lookup_framework.by_pixel_textures(surfaces.plane(), textures, view, light, profile, stage=stage),
    )


@pytest.mark.parametrize("stage", lookup_framework.STAGES)
def test_each_stage_on_the_octane_is_the_float_evaluation(stage):
    textures = lookup_framework.woven_domes(SIZE, bumps=2)
    expected = reference(textures)[stage]
    result = execute(drawn(OCTANE, stage, textures), OCTANE, SIZE, SIZE)
    picture = result.framebuffer.color[::-1, :, 0] / 255.0
    assert result.undefined == 0
    # A parameter is rounded once; G's derivative of u is v/2, of v/8 less; F's of -s is 1/t.
    codes = 0.51 if stage in lookup_framework.STAGES[:4] else 4.0
    assert np.abs(picture - expected).max() <= codes / 255.0
    ideal = execute_ideal(drawn(IDEAL, stage, textures), SIZE, SIZE).color[::-1, :, 0]
    assert np.abs(ideal - expected).max() <= 2e-3


def test_the_functions_are_the_figure_s():
    s, t = np.meshgrid(np.linspace(0.0, 1.0, 9), np.linspace(0.0625, 1.0, 16))
    assert lookup_framework.exponential(s, t) == pytest.approx(np.exp(-s / t), abs=1e-15)
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 9), np.linspace(0.0, 8.0, 9))
    assert lookup_framework.root_of_power(u, v / 8.0) == pytest.approx(np.sqrt(u**v), abs=1e-15)
    assert lookup_framework.exponential(0.0, 0.0) == 1.0
    assert lookup_framework.exponential(0.1, 0.0) == 0.0


@pytest.mark.parametrize("stage", lookup_framework.STAGES)
def test_each_stage_by_the_host_is_the_float_evaluation(stage):
    textures = lookup_framework.woven_domes(SIZE, bumps=2)
    expected, view = reference(textures)[stage], orthographic_view(PANEL)

    def commands(profile):
        passes = lookup_framework.by_host(surfaces.plane(), view, Light(LIGHT), profile, stage=stage)
        return (PANEL.clear((0.0, 0.0, 0.0)), *lookup_framework.load_textures(textures, profile), *passes)

    # Vectors of bytes: 255 reads as 254/255, so that a dot product of two may be 2 % low; G's derivative of u
    # is up to v/2 = 4 where u is near one.
    codes = 3.0 if stage in lookup_framework.STAGES[:4] else 8.0
    picture = execute(commands(GEFORCE_256), GEFORCE_256, SIZE, SIZE).framebuffer.color[::-1, :, 0] / 255.0
    assert np.abs(picture - expected).max() <= codes / 255.0
    ideal = execute_ideal(commands(IDEAL), SIZE, SIZE).color[::-1, :, 0]
    assert np.abs(ideal - expected).max() <= (1e-12 if stage in lookup_framework.STAGES[:4] else 2e-3)


def test_the_exponent_of_the_woven_domes_grows_from_left_to_right():
    eighths = lookup_framework.woven_domes(16).eighths
    assert (np.diff(eighths, axis=1) > 0.0).all()
    assert (np.diff(eighths, axis=0) == 0.0).all()
