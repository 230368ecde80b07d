"""The lighting unit's colours equal their specification before they become bytes, which hide a last bit."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import Face
from fixedpipe.pipeline.state import Light, Lighting, Material, Spot, VertexState
from fixedpipe.pipeline.vertices import lighting
from fixedpipe.pipeline.vertices.arithmetic import columns_of, filled_rows, invert_upper_left
from fixedpipe.pipeline.vertices.lighting_unit import light_vertices
from fixedpipe.pipeline.vertices.spot_registers import spot_of
from tests.reference import lighting_unit as reference
from tests.reference.spotlights import driver_spot

POWER_4 = (-0.421539, -1.70592, 2.28438, -0.170208, -0.855842, 1.68563)  # of a Specular capture
WHITE, BLACK = (1.0, 1.0, 1.0, 1.0), (0.0, 0.0, 0.0, 1.0)
NEAR = {
    "position": (0.3, 0.2, -2.0, 1.0),
    "constant_attenuation": 0.5,
    "linear_attenuation": 0.2,
    "ambient": (0.1, 0.2, 0.3, 1.0),
    "specular": (1.0, 0.7, 0.3, 1.0),
}
CONE = Spot((0.0, 0.0, -1.0, 0.0), (-0.932112, -3.097628, 3.165516))
LIGHTS = {
    "directional": Light(position=(0.6, 0.0, -0.8, 0.0), half_vector=(0.3, 0.0, -0.95), specular=WHITE),
    "point": Light(**NEAR),
    "spotlight": Light(spot=CONE, **NEAR),
    "OpenGL's spotlight": Light(spot_direction=(0.0, 0.0, 1.0), spot_cutoff=40.0, spot_exponent=3.0, **NEAR),
}


@pytest.mark.parametrize("light", LIGHTS)
def test_colours_are_the_specification_s_to_the_last_bit(light):
    rng = np.random.default_rng(7)
    positions = rng.uniform(-0.5, 0.5, (60, 3))
    normals = rng.uniform(-0.3, 0.3, (60, 3)) - (0.0, 0.0, 0.9)
    material = Material(diffuse=WHITE, specular=WHITE, specular_coefficients=POWER_4)
    lighting = Lighting(
        (LIGHTS[light],), material, separate_specular_color=True, viewer_direction=(0.0, 0.0, -1.0)
    )
    vertex = VertexState(lighting=lighting)
    inverse = invert_upper_left(vertex.modelview)
    white = np.ones((60, 4))
    mesh = Mesh(positions, normals=normals, colors=white, secondary_colors=white)
    got = light_vertices(vertex, mesh, clamped=False).T
    wanted = [
        reference.light_vertex(vertex, Face.FRONT, [inverse], (*p, 1.0), n, 1.0, WHITE, WHITE, None)
        for p, n in zip(positions.tolist(), normals.tolist(), strict=True)
    ]
    assert (got[:, 4] > 0).sum() > 10  # vertices with a highlight
    assert got.tolist() == wanted


@pytest.mark.parametrize("cutoff", [0.0, 1e-7, 1e-3, 1.0, 10.0, 44.0, 60.0, 89.9, 90.0])
def test_a_driver_s_registers_are_the_specification_s(cutoff):
    for exponent in (0.0, 1e-9, 0.3, 1.0, 2.5, 3.7, 20.0, 64.0, 127.9, 128.0):
        for direction in ((0.0, 0.0, -1.0), (0.3, -2.0, 7.0), (0.0, 0.0, 0.0)):
            light = Light(spot_direction=direction, spot_exponent=exponent, spot_cutoff=cutoff)
            spot = spot_of(light)
            assert ([*spot.axis], [*spot.coefficients]) == driver_spot(direction, exponent, cutoff)
    assert spot_of(Light()) is None
    assert spot_of(Light(spot=CONE)) is CONE


def cone(exponent, cutoff):
    """Cosines of angles from a spotlight's axis, and the light there: on the unit, by OpenGL's equations."""
    angles = np.radians(np.linspace(0.0, 90.0, 9001))
    light = Light(
        ambient=WHITE,
        diffuse=BLACK,
        specular=BLACK,
        position=(0.0, 0.0, 0.0, 1.0),
        spot_exponent=exponent,
        spot_cutoff=cutoff,
    )
    state = Lighting((light,), Material(ambient=WHITE, diffuse=BLACK), model_ambient=BLACK)
    vertex = VertexState(lighting=state)
    mesh = Mesh(np.stack([np.sin(angles), 0 * angles, -np.cos(angles)], 1))
    unit = light_vertices(vertex, mesh, clamped=False)[0]
    eye = filled_rows(len(angles), columns_of(mesh.positions, (0.0, 0.0, 0.0, 1.0)))
    normal = filled_rows(len(angles), columns_of(None, (0.0, 0.0, 1.0)))
    white = np.ones((len(angles), 4))
    return np.cos(angles), unit, lighting.light_vertices(vertex, eye, normal, white, clamped=False)[0]


@pytest.mark.parametrize(
    ("exponent", "wide", "middle", "narrow"),
    [
        (0.0, "0.001", "0.001", "0.001"),
        (1.0, "0.23", "0.10", "0.01"),
        (5.0, "0.06", "0.07", "0.03"),
        (20.0, "0.03", "0.03", "0.03"),
        (128.0, "0.03", "0.03", "0.02"),
    ],
)
def test_how_far_a_driver_s_cone_is_from_opengl_s(exponent, wide, middle, narrow):
    """As docs/numbers.md, N2.27, says. At the edge itself, within 1/50 of a degree, either may be dark."""
    for cutoff, stated in ((60.0, wide), (30.0, middle), (10.0, narrow)):
        cosine, unit, meant = cone(exponent, cutoff)
        angle = np.degrees(np.arccos(cosine))
        inside = angle < cutoff - 0.02
        digits = len(stated) - 2
        assert f"{np.abs(unit - meant)[inside].max():.{digits}f}" == stated
        if exponent:
            assert np.abs(unit - cosine ** (exponent + 1))[inside].max() < 0.045
        assert not unit[angle > cutoff + 0.02].any()


def test_a_driver_s_cone_may_end_before_the_cutoff():
    """As docs/numbers.md, N2.27, says."""
    cosine, unit, _ = cone(128.0, 60.0)
    assert f"{np.degrees(np.arccos(cosine[unit > 0].min())):.1f}" == "13.4"
    cosine, unit, _ = cone(1.0, 90.0)
    assert f"{np.abs(unit - cosine**2).max():.2f}" == "0.10"


def test_what_lies_behind_a_cone_s_edge_is_dark_though_the_numerator_is_positive():
    """(x + a)/c would light 90 degrees of this cone, which ends where x is 0, at 60."""
    cosine, unit, _ = cone(1.0, 60.0)
    assert spot_of(Light(spot_cutoff=60.0, spot_exponent=1.0)).coefficients[0] > 0.5
    assert unit[cosine > 0.501].all()
    assert not unit[cosine < 0.499].any()
