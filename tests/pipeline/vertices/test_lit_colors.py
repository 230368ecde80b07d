"""Lit colours equal their specification before they are rounded to bytes, NaN in the same places.

More vertices than a kernel's chunk holds, and numbers that are huge, infinite or NaN.
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import Face, SecondaryColor
from fixedpipe.pipeline.state import Light, Lighting, Material, VertexState
from fixedpipe.pipeline.vertices import chip_floats, lighting, lighting_unit
from fixedpipe.raster.primitives import chip_floats as numbers
from fixedpipe.raster.primitives.lighting_columns import CHUNK
from tests.pipeline.vertices.test_stage import (
    TURNED,
    has_inverse,
    huge,
    lightings,
    matrices,
    meshes,
    ordinary,
    unit_lightings,
)
from tests.reference import lighting_unit as unit_reference
from tests.reference import vertex as reference

special = st.one_of(ordinary, st.sampled_from([math.inf, -math.inf, math.nan, 1e308, -1e200, 1e-300, -0.0]))


def sides_of(state):
    return (Face.FRONT, Face.BACK) if state.two_side else (Face.FRONT,)


def row(array, i, defaults):
    given = () if array is None else array[i].tolist()
    return [*given, *defaults[len(given) :]]


@settings(max_examples=200)
@given(
    unit_lightings,
    meshes() | meshes(huge),
    matrices() | matrices(huge) | st.just(TURNED),
    st.none() | matrices(),
    st.tuples(st.booleans(), st.booleans()),
    st.sampled_from(SecondaryColor),
)
def test_the_lighting_unit_s_colours_are_the_specification_s(
    state, mesh, modelview, second, normals, secondary
):
    assume(has_inverse(modelview) and (second is None or has_inverse(second)))
    vertex = VertexState(
        modelview=modelview,
        modelview1=second,
        normalize=normals[0],
        rescale_normal=normals[1],
        lighting=state,
        secondary_color=secondary,
    )
    got = lighting_unit.light_vertices(vertex, mesh, clamped=False).T.tolist()
    for i, columns in enumerate(got):
        position, normal = row(mesh.positions, i, [0.0, 0.0, 0.0, 1.0]), row(mesh.normals, i, [0.0, 0.0, 1.0])
        given_colors = row(mesh.colors, i, [1.0] * 4) + row(mesh.secondary_colors, i, [0.0] * 4)
        weight = 1.0 if mesh.weights is None else float(mesh.weights[i])
        wanted = []
        for side in reference.unit_colors(vertex, position, normal, given_colors, weight)[
            : len(columns) // 8
        ]:
            wanted += unit_reference.secondary_output(side, secondary)
        assert columns == [float(c) for c in wanted]


@settings(max_examples=200)
@given(lightings, st.lists(st.tuples(*[special] * 7), min_size=1, max_size=3), st.booleans())
def test_the_equations_colours_are_the_specification_s_from_any_coordinates(state, vertices, colored):
    eye, normal = (np.ascontiguousarray(np.array(vertices).T[rows]) for rows in (slice(4), slice(4, 7)))
    colors = np.random.default_rng(len(vertices)).uniform(-0.2, 1.2, (len(vertices), 4 if colored else 0))
    got = lighting.light_vertices(VertexState(lighting=state), eye, normal, colors, clamped=False)
    wanted = []
    for i, numbers_of in enumerate(vertices):
        place = [*numbers_of[:4]], [*numbers_of[4:]], row(colors, i, [1.0] * 4)
        sides = [reference.light_vertex(state, side, *place) for side in sides_of(state)]
        wanted.append([c for side in sides for c in side])
    np.testing.assert_array_equal(got, np.array(wanted).T)


@pytest.mark.parametrize("unit", [False, True], ids=["equations", "lighting unit"])
@pytest.mark.parametrize("count", [1, CHUNK - 1, CHUNK, CHUNK + 1, 3 * CHUNK + 5])
def test_a_vertex_s_colours_are_the_same_in_every_chunk(unit, count):
    random = np.random.default_rng(count)
    mesh = Mesh(random.normal(size=(count, 3)), normals=random.normal(size=(count, 3)))
    lights = Light(position=(0.3, 0.4, -2.0, 1.0), linear_attenuation=0.2), Light(spot_cutoff=180.0)
    state = Lighting(lights, Material(specular=(1.0,) * 4, shininess=6.0), local_viewer=True, two_side=True)
    vertex = VertexState(lighting=state, normalize=True)

    def lit(chosen):
        part = Mesh(mesh.positions[chosen], normals=mesh.normals[chosen])
        if unit:
            return lighting_unit.light_vertices(vertex, part, clamped=True)
        _, normals, colors, _, weights = lighting_unit.arrays_of(part)
        normal = lighting.eye_normals(vertex, len(chosen), normals, weights)
        eye = np.array([*part.positions.T, np.ones(len(chosen))])
        return lighting.light_vertices(vertex, eye, normal, colors, clamped=True)

    whole, order = lit(np.arange(count)), np.arange(count)[::-1]
    np.testing.assert_array_equal(lit(order), whole[:, order])
    assert count < CHUNK - 1 or len(np.unique(whole[0])) > 20


singles = st.one_of(
    st.sampled_from([0.0, 1.0, -1.0, 2.0, math.inf, -math.inf, math.nan, 2.0**-126, -(2.0**127)]),
    st.floats(width=32),
    st.floats(-4, 4, width=32),
)


@settings(max_examples=300)
@given(st.tuples(*[singles] * 4))
def test_a_kernel_s_numbers_are_the_columns(values):
    with np.errstate(all="ignore"):
        values = [float(chip_floats.single(v)) for v in values]
        a = values[0]
        for bits in (chip_floats.LIGHTING_BITS, chip_floats.TRANSFORM_BITS):
            cut = [float(chip_floats.truncated(v, bits)) for v in values]
            for got, wanted in (
                (numbers.product(cut[0], cut[1], bits), chip_floats.product(cut[0], cut[1], bits)),
                (numbers.total2(cut[0], cut[1], bits, 0), chip_floats.total(cut[:2], bits, 0)),
                (numbers.total3(*cut[:3], bits), chip_floats.total(cut[:3], bits)),
                (numbers.total4(*cut, bits), chip_floats.total(cut, bits)),
            ):
                np.testing.assert_array_equal(got, wanted)
        short = [float(chip_floats.to_lighting(v)) for v in values[:3]]
        assert np.array_equal([numbers.to_lighting(v) for v in values[:3]], short, equal_nan=True)
        if np.isfinite(short).all():
            for name in ("multiply_add", "add_product"):
                got = getattr(numbers, f"finite_{name}")(*short)
                assert got == getattr(chip_floats, name)(*short, chip_floats.LIGHTING_BITS)
        for name, value in (
            ("transform_reciprocal", a),
            ("transform_inverse_root", a),
            ("lighting_reciprocal", short[0]),
        ):
            np.testing.assert_array_equal(getattr(numbers, name)(value), getattr(chip_floats, name)(value))


def test_every_seed_s_reciprocals_and_roots_are_the_columns():
    """Each of the 64 seeds of either parity, at its ends and in its middle."""
    places = np.arange(64)[:, None] * 2.0**-6 + np.array([0, 2.0**-23, 2.0**-7, 2.0**-6 - 2.0**-23])
    for value in (1 + places.reshape(-1)).tolist() + (2 + 2 * places.reshape(-1)).tolist():
        for name in ("transform_reciprocal", "transform_inverse_root"):
            assert getattr(numbers, name)(value) == getattr(chip_floats, name)(value)
        short = float(chip_floats.to_lighting(value))
        assert numbers.lighting_reciprocal(short) == chip_floats.lighting_reciprocal(short)
