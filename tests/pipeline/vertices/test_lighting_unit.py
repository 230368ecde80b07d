"""The lighting unit's colours equal their specification before they become bytes, which hide a last bit."""

import numpy as np
import pytest

from fixedpipe.pipeline.enums import Face
from fixedpipe.pipeline.state import Light, Lighting, Material, Spot, VertexState
from fixedpipe.pipeline.vertices.arithmetic import columns_of, invert_upper_left
from fixedpipe.pipeline.vertices.lighting_unit import light_vertices
from tests.reference import lighting_unit as reference

POWER_4 = (-0.421539, -1.70592, 2.28438, -0.170208, -0.855842, 1.68563)  # of a Specular capture
WHITE = (1.0, 1.0, 1.0, 1.0)
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
    given = columns_of(positions, (0.0, 0.0, 0.0, 1.0)), columns_of(normals, (0.0, 0.0, 1.0))
    front, _ = light_vertices(vertex, inverse, *given, columns_of(None, WHITE), columns_of(None, WHITE))
    got = np.stack([np.broadcast_to(column, 60) for column in front], axis=1)
    wanted = [
        reference.light_vertex(vertex, Face.FRONT, inverse, (*p, 1.0), n, WHITE, WHITE, None)
        for p, n in zip(positions.tolist(), normals.tolist(), strict=True)
    ]
    assert (got[:, 4] > 0).sum() > 10  # vertices with a highlight
    assert got.tolist() == wanted
