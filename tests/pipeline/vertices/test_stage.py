"""The vertex stage equals its specification to the bit, and the specification equals OpenGL's equations."""

import math
import struct
import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import (
    ColorMaterialParameter,
    ColorSource,
    Face,
    FogArithmetic,
    FogCoordinateSource,
    FogGeneration,
    FogMode,
    LightingArithmetic,
    PrimitiveType,
    ProvokingVertex,
    SecondaryColor,
    TexGenMode,
    VertexStage,
    WindowOrigin,
)
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, NV2A
from fixedpipe.pipeline.state import (
    IDENTITY,
    ColorMaterial,
    ColorSources,
    Composite,
    DepthClamp,
    Fog,
    FogRegisters,
    Light,
    Lighting,
    Material,
    PassState,
    PolygonState,
    Spot,
    TexGen,
    TextureUnit,
    VertexState,
    Viewport,
)
from fixedpipe.pipeline.vertices.colors import color_byte, kept_color_bits
from fixedpipe.pipeline.vertices.lighting import cosine_of_degrees
from fixedpipe.pipeline.vertices.stage import process
from fixedpipe.raster.primitives import lighting_columns
from tests.reference import vertex as reference
from tests.support.strategies import POLYGONS

WIDTH, HEIGHT = 64, 48
PERSPECTIVE = ((1.5, 0.0, 0.0, 0.0), (0.0, 2.0, 0.0, 0.0), (0.0, 0.0, -1.25, -2.25), (0.0, 0.0, -1.0, 0.0))
TURNED = ((0.8, -0.6, 0.0, 0.1), (0.48, 0.64, -0.6, 0.2), (0.36, 0.48, 0.8, -3.0), (0.0, 0.0, 0.0, 1.0))
SQUASHED = ((2.0, 0.3, 0.0, 0.0), (0.0, 0.5, 0.0, 0.0), (0.1, 0.0, -1.5, -2.0), (0.0, 0.0, 0.0, 1.0))


# -------------------------------------------------------------------------------------- comparison


def pattern(value):
    """The bits of a float64; all NaNs are one."""
    return "nan" if math.isnan(value) else struct.pack("<d", value)


def comparable(x, y, z, inverse_w, colors, coordinates, fog):
    floats = [z, inverse_w, fog, *(c for unit in coordinates for c in unit)]
    return x, y, tuple(tuple(side) for side in colors), tuple(pattern(value) for value in floats)


def drawn(primitives):
    """Triangles of WindowPrimitives, vertex by vertex, in a form that compares bits."""
    columns = zip(
        primitives.x.tolist(),
        primitives.y.tolist(),
        primitives.z.tolist(),
        primitives.inverse_w.tolist(),
        primitives.colors.tolist(),
        primitives.coordinates.tolist(),
        primitives.fog.tolist(),
        strict=True,
    )
    vertices = [comparable(*column) for column in columns]
    return [
        ([vertices[v] for v in (a, b, c)], vertices[p][2]) for a, b, c, p in primitives.triangles.tolist()
    ]


def specified(assembled):
    return [
        ([comparable(*v) for v in vertices], tuple(tuple(side) for side in flat))
        for vertices, flat in assembled.triangles
    ]


def assert_equals_the_specification(mesh, state, profile=GEFORCE_256):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        primitives = process(mesh, state, profile, WIDTH, HEIGHT)
    expected = reference.process(mesh, state, profile, WIDTH, HEIGHT)
    assert drawn(primitives) == specified(expected)
    assert primitives.dropped == expected.dropped
    return primitives


# -------------------------------------------------------------------------------------- strategies

ordinary = st.one_of(st.floats(-3, 3, width=32), st.sampled_from([0.0, 0.5, 1.0, -1.0, 2.0]))
huge = st.one_of(
    ordinary,
    st.sampled_from([1e38, -1e38, 1e308, -1.7e308, 1e-308, -5e-324, -0.0, 8192.0, 1e5, -1e16]),
    st.floats(allow_nan=False, allow_infinity=False),
)
intensity = st.one_of(st.sampled_from([0.0, 1.0, 0.5]), st.floats(-0.25, 1.5))


def tuples(element, length):
    return st.tuples(*[element] * length)


def colors(element=intensity):
    return tuples(element, 4)


def arrays(element, rows, columns):
    return st.lists(st.lists(element, min_size=columns, max_size=columns), min_size=rows, max_size=rows).map(
        lambda values: np.array(values, dtype=np.float64).reshape(rows, columns)
    )


@st.composite
def meshes(draw, element=ordinary):
    n = draw(st.integers(3, 9))
    indices, counts = None, None
    if draw(st.booleans()):
        indices = draw(st.lists(st.integers(0, n - 1), min_size=3, max_size=10))
    if draw(st.booleans()):
        stream = n if indices is None else len(indices)
        cut = draw(st.integers(0, stream))
        counts = (cut, stream - cut)
    given_sets = draw(st.integers(0, 2))
    return Mesh(
        draw(arrays(element, n, draw(st.integers(2, 4)))),
        primitive=draw(st.sampled_from(POLYGONS)),
        indices=indices,
        counts=counts,
        colors=draw(st.none() | arrays(intensity, n, draw(st.integers(3, 4)))),
        secondary_colors=draw(st.none() | arrays(intensity, n, draw(st.integers(3, 4)))),
        back_colors=draw(st.none() | arrays(intensity, n, draw(st.integers(3, 4)))),
        back_secondary_colors=draw(st.none() | arrays(intensity, n, draw(st.integers(3, 4)))),
        normals=draw(st.none() | arrays(element, n, 3)),
        texture_coordinates=tuple(
            draw(arrays(element, n, draw(st.integers(1, 4)))) for _ in range(given_sets)
        ),
        fog_coordinates=draw(st.none() | st.lists(element, min_size=n, max_size=n)),
        weights=draw(st.none() | st.lists(element, min_size=n, max_size=n)),
    )


def fogs(element=ordinary):
    registers = st.builds(
        FogRegisters,
        bias=element,
        multiplier=element,
        generation=st.sampled_from(FogGeneration),
        plane=tuples(element, 4),
        absolute=st.booleans(),
    )
    return st.builds(
        Fog,
        mode=st.sampled_from(FogMode),
        density=st.floats(0.0, 4.0),
        start=st.floats(-3.0, -1.0),
        coordinate_source=st.sampled_from(FogCoordinateSource),
        registers=st.none() | registers,
    )


def matrices(element=ordinary):
    return st.one_of(
        st.sampled_from([IDENTITY, PERSPECTIVE, TURNED, SQUASHED]), tuples(tuples(element, 4), 4)
    )


materials = st.builds(
    Material,
    colors(),
    colors(),
    colors(),
    colors(),
    st.one_of(st.just(0.0), st.floats(0, 128), st.integers(0, 128)),
)
lights = st.builds(
    Light,
    ambient=colors(),
    diffuse=colors(),
    specular=colors(),
    position=st.tuples(ordinary, ordinary, ordinary, st.sampled_from([0.0, 1.0, 0.5, -2.0])),
    spot_direction=tuples(ordinary, 3),
    spot_exponent=st.sampled_from([0.0, 1.0, 2.5, 20.0]),
    spot_cutoff=st.sampled_from([180.0, 90.0, 60.0, 33.3, 0.0]),
    constant_attenuation=st.sampled_from([0.0, 1.0, 0.3]),
    linear_attenuation=st.sampled_from([0.0, 0.7]),
    quadratic_attenuation=st.sampled_from([0.0, 0.2]),
)
lightings = st.builds(
    Lighting,
    lights=st.lists(lights, max_size=3).map(tuple),
    front=materials,
    back=materials,
    model_ambient=colors(),
    local_viewer=st.booleans(),
    two_side=st.booleans(),
    separate_specular_color=st.booleans(),
    color_material=st.none()
    | st.builds(ColorMaterial, st.sampled_from(Face), st.sampled_from(ColorMaterialParameter)),
)
register = st.one_of(st.sampled_from([0.0, 1.0, 0.5, -0.7, 0.2, 1.9999]), st.floats(-4, 4, width=32))
unit_lights = st.builds(
    replace,
    lights,
    back_ambient=st.none() | colors(),
    back_specular=st.none() | colors(),
).flatmap(
    lambda light: st.builds(
        replace,
        st.just(light if light.position[3] else replace(light, spot_cutoff=180.0)),
        **(
            {"half_vector": st.none() | tuples(register, 3)}
            if light.position[3] == 0
            else {
                "range": st.none() | st.floats(0, 4, width=32),
                "spot": st.none() | st.builds(Spot, tuples(register, 4), tuples(register, 3))
                if light.spot_cutoff == 180
                else st.none(),
            }
        ),
    )
)
unit_materials = st.builds(replace, materials, specular_coefficients=st.none() | tuples(register, 6))
sources = st.none() | st.builds(ColorSources, *[st.sampled_from(ColorSource)] * 4)
unit_lightings = st.builds(
    replace,
    lightings,
    lights=st.lists(unit_lights, max_size=3).map(tuple),
    front=unit_materials,
    back=unit_materials,
    front_sources=sources,
    back_sources=sources,
    back_model_ambient=st.none() | colors(),
    viewer_direction=st.sampled_from([(0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.6, 0.0, -0.8)]),
)
UNIT = GEFORCE_256.changed(lighting=LightingArithmetic.LIGHTING_UNIT)
LINEAR = [TexGenMode.NONE, TexGenMode.OBJECT_LINEAR, TexGenMode.EYE_LINEAR]
VECTOR = [*LINEAR, TexGenMode.NORMAL_MAP, TexGenMode.REFLECTION_MAP]


def generators(modes, element=ordinary):
    return st.builds(TexGen, st.sampled_from(modes), tuples(element, 4))


def units(element=ordinary):
    sphere = [*VECTOR, TexGenMode.SPHERE_MAP]
    return st.none() | st.builds(
        TextureUnit,
        texture=st.just("any"),
        coordinates=st.integers(0, 1),
        gen=st.tuples(*(generators(modes, element) for modes in (sphere, sphere, VECTOR, LINEAR))),
        matrix=matrices(element),
    )


viewports = st.one_of(
    st.just(Viewport()),
    st.builds(
        Viewport,
        x=st.integers(-20, 40),
        y=st.integers(-20, 40),
        width=st.integers(1, 90),
        height=st.integers(1, 90),
        near=st.sampled_from([0.0, 0.25, 1.0]),
        far=st.sampled_from([1.0, 0.5, 0.0]),
    ),
)


def states(element=ordinary):
    return st.builds(
        PassState,
        vertex=st.builds(
            VertexState,
            modelview=matrices(element),
            projection=matrices(element),
            viewport=viewports,
            normalize=st.booleans(),
            rescale_normal=st.booleans(),
            lighting=st.none() | lightings,
            clip_planes=st.lists(tuples(element, 4), max_size=2).map(tuple),
            composite=st.none() | st.builds(Composite, matrices(element), tuples(element, 3)),
        ),
        polygon=st.builds(PolygonState, provoking_vertex=st.sampled_from(ProvokingVertex)),
        texture_units=st.lists(units(element), max_size=2).map(tuple),
        fog=st.none() | fogs(element),
    )


def has_inverse(matrix):
    m = [[float(x) for x in row[:3]] for row in matrix[:3]]
    c = [reference.cofactor(m, 0, j) for j in range(3)]
    determinant = (m[0][0] * c[0] + m[0][1] * c[1]) + m[0][2] * c[2]
    return determinant != 0 and math.isfinite(determinant)


# ------------------------------------------------------------------------- kernel equals specification


@settings(max_examples=200)
@given(meshes(), states())
def test_random_states_give_the_bits_of_the_specification(mesh, state):
    assume(has_inverse(state.vertex.modelview))
    assert_equals_the_specification(mesh, state)


@settings(max_examples=200)
@given(meshes(huge), states(huge))
def test_huge_and_tiny_numbers_give_the_bits_of_the_specification_and_no_warning(mesh, state):
    assume(has_inverse(state.vertex.modelview))
    assert_equals_the_specification(mesh, state)


@settings(max_examples=150)
@given(
    lightings.filter(lambda lighting: lighting.lights),
    arrays(ordinary, 3, 3),
    arrays(intensity, 3, 4),
    st.booleans(),
)
def test_random_lighting_gives_the_bits_of_the_specification(lighting, normals, vertex_colors, normalize):
    mesh = Mesh(
        [[-1.0, 0.5, 0.0], [1.0, 0.25, -1.0], [0.0, -0.5, 1.0]], normals=normals, colors=vertex_colors
    )
    vertex = VertexState(modelview=TURNED, projection=PERSPECTIVE, lighting=lighting, normalize=normalize)
    primitives = assert_equals_the_specification(mesh, PassState(vertex=vertex))
    assert len(primitives.triangles) == 1


@settings(max_examples=200)
@given(meshes(), states().filter(lambda state: state.fog is not None))
def test_table_fog_gives_the_bits_of_the_specification(mesh, state):
    assume(has_inverse(state.vertex.modelview))
    assert_equals_the_specification(mesh, state, GEFORCE_256.changed(fog_arithmetic=FogArithmetic.TABLE))


@settings(max_examples=150)
@given(meshes(st.floats(-4, 4, width=32)), states(), st.sampled_from([0, 3, 8192]))
def test_triangles_through_every_plane_give_the_bits_of_the_specification(mesh, state, guard_band):
    vertex = replace(state.vertex, modelview=TURNED, projection=PERSPECTIVE)
    profile = GEFORCE_256.changed(guard_band=guard_band)
    assert_equals_the_specification(mesh, replace(state, vertex=vertex), profile)


@settings(max_examples=200)
@given(
    unit_lightings,
    meshes(),
    st.sampled_from([IDENTITY, TURNED, SQUASHED]),
    st.booleans(),
    st.booleans(),
    st.sampled_from(SecondaryColor),
)
def test_the_lighting_unit_gives_the_bits_of_the_specification(
    lighting, mesh, modelview, normalize, rescale, secondary
):
    state = VertexState(
        modelview=modelview,
        normalize=normalize,
        rescale_normal=rescale,
        lighting=lighting,
        secondary_color=secondary,
    )
    assert_equals_the_specification(mesh, PassState(vertex=state), UNIT)


@settings(max_examples=100)
@given(unit_lightings, meshes(huge), matrices(huge))
def test_huge_and_tiny_numbers_in_the_lighting_unit_give_the_bits_of_the_specification(
    lighting, mesh, modelview
):
    assume(has_inverse(modelview))
    state = VertexState(modelview=modelview, lighting=lighting)
    assert_equals_the_specification(mesh, PassState(vertex=state), UNIT)


@settings(max_examples=100)
@given(meshes(), states(), matrices())
def test_vertex_weighting_gives_the_bits_of_the_specification(mesh, state, second):
    assume(has_inverse(state.vertex.modelview) and has_inverse(second))
    assert_equals_the_specification(mesh, replace(state, vertex=replace(state.vertex, modelview1=second)))


@settings(max_examples=100)
@given(unit_lightings, meshes(), matrices(), st.booleans(), st.booleans())
def test_vertex_weighting_in_the_lighting_unit_gives_the_bits_of_the_specification(
    lighting, mesh, second, normalize, rescale
):
    assume(has_inverse(second))
    vertex = VertexState(
        modelview=TURNED,
        modelview1=second,
        normalize=normalize,
        rescale_normal=rescale,
        lighting=lighting,
    )
    assert_equals_the_specification(mesh, PassState(vertex=vertex), UNIT)


@pytest.mark.parametrize("profile", [GEFORCE_256, UNIT], ids=["equations", "lighting unit"])
@pytest.mark.parametrize(("weight", "alone"), [(1.0, TURNED), (0.0, SQUASHED)])
def test_a_weight_of_one_or_zero_is_one_matrix_alone(profile, weight, alone):
    unit = TextureUnit("any", gen=(TexGen(TexGenMode.EYE_LINEAR, (1.0, 0.5, 2.0, 0.0)), *[TexGen()] * 3))
    positions = [[-0.3, 0.5, 0.0], [0.3, 0.25, 0.3], [0.1, -0.5, 0.1]]
    both = VertexState(
        modelview=TURNED, modelview1=SQUASHED, projection=PERSPECTIVE, lighting=Lighting((Light(),))
    )
    one = replace(both, modelview=alone, modelview1=None)
    results = []
    for vertex, weights in ((both, [weight] * 3), (one, None)):
        state = PassState(vertex=vertex, texture_units=(unit,))
        results.append(drawn(process(Mesh(positions, weights=weights), state, profile, WIDTH, HEIGHT)))
    assert results[0] == results[1]
    assert results[0]


def test_eye_coordinates_and_normals_are_weighted_sums():
    """Against NumPy's matrix products, by what texture coordinate generation shows of both: 1e-12 is far
    above float64's errors of sums of a few terms below 10, and far below any other weight.
    """
    rng = np.random.default_rng(4)
    positions, normals = rng.uniform(-1, 1, (9, 3)), rng.normal(size=(9, 3))
    weights = np.array([0.0, 1.0, 0.5, 0.25, 0.9, 1.5, -0.5, 1 / 3, 0.7])
    planes = [TexGen(TexGenMode.EYE_LINEAR, row) for row in IDENTITY]
    vector = (*[TexGen(TexGenMode.NORMAL_MAP)] * 3, TexGen())
    state = PassState(
        vertex=VertexState(modelview=TURNED, modelview1=SQUASHED, normalize=True, projection=PERSPECTIVE),
        texture_units=(TextureUnit("eye", gen=tuple(planes)), TextureUnit("normal", gen=vector)),
    )
    got = process(Mesh(positions, normals=normals, weights=weights), state, GEFORCE_256, WIDTH, HEIGHT)
    w = weights[:, None]
    eye, normal = 0.0, 0.0
    for share, matrix in ((w, np.array(TURNED)), (1 - w, np.array(SQUASHED))):
        eye = eye + share * (np.column_stack([positions, np.ones(9)]) @ matrix.T)
        normal = normal + share * (normals @ np.linalg.inv(matrix[:3, :3]))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    assert np.abs(got.coordinates[:9, 0] - eye).max() < 1e-12
    assert np.abs(got.coordinates[:9, 1, :3] - normal).max() < 1e-12
    clip = eye @ np.array(PERSPECTIVE).T
    assert got.inverse_w[:9] == pytest.approx(1 / clip[:, 3], rel=1e-12)


@settings(max_examples=200)
@given(meshes(st.floats(-4, 4, width=32)), tuples(st.floats(-40, 40), 3), st.sampled_from([0, 3, 8192]))
def test_composite_matrices_give_the_bits_of_the_specification(mesh, offset, guard_band):
    """What is seen lies on both sides of the screen's edges and of depth 0."""
    matrix = ((40.0, 3.0, 30.0, 60.0), (0.0, -40.0, 20.0, 50.0), (0.1, 0.0, 90.0, 9.0), (0.0, 0.0, 0.7, 2.0))
    state = PassState(vertex=VertexState(composite=Composite(matrix, offset)))
    assert_equals_the_specification(mesh, state, GEFORCE_256.changed(guard_band=guard_band))


def test_a_composite_matrix_is_applied_in_single_precision_toward_zero():
    third = ((1 / 3, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 5.0, 2.0**40), (0.0, 0.0, 0.0, 3.0))
    state = PassState(vertex=VertexState(composite=Composite(third, (0.5, 0.0, 0.0))))
    got = one_triangle([[90.0, 30.0, 0.0], [270.0, 30.0, 1.0], [90.0, 120.0, 0.0]], state)
    assert got.x.tolist() == [167, 487, 167]  # a reciprocal of 3 just below 1/3: 10.5 and 30.5 become less
    assert got.y.tolist() == [159, 159, 639]
    assert got.z.tolist() == [11184810 * 2.0**15] * 3  # of 2^40/3


@settings(max_examples=50)
@given(meshes(), st.booleans())
def test_program_results_give_the_bits_of_the_specification(mesh, two_side):
    """Positions are window coordinates and are not clipped, so only the colours are compared here."""
    state = PassState(vertex=VertexState(stage=VertexStage.PROGRAM_RESULTS, two_side=two_side))
    got = process(mesh, state, GEFORCE_256, WIDTH, HEIGHT)
    for i, colors in enumerate(got.colors.tolist()):
        vertex = reference.process_vertex(mesh, i, state, GEFORCE_256)
        assert colors == [reference.color_codes(side, False, GEFORCE_256) for side in vertex.colors]


def test_program_results_stay_wherever_they_are_and_whatever_w_is():
    """A triangle far outside the window, or through infinity; 1/w is clamped, and a zero has a sign."""
    state = PassState(vertex=VertexState(stage=VertexStage.PROGRAM_RESULTS))
    corners = np.array([(-900.0, 1.0, 0.5, 1.0), (900.0, 1.0, 0.5, 1.0), (1.0, 900.0, 0.5, 1.0)])
    for w, inverse in ((1, 1), (-2, -0.5), (0, 2.0**64), (-0.0, -(2.0**64)), (-1e30, -(2.0**-64))):
        corners[2, 3] = w
        kept = process(Mesh(corners), state, GEFORCE_256, WIDTH, HEIGHT)
        assert (kept.triangles[:, :3].tolist(), kept.dropped) == ([[0, 1, 2]], 0)
        assert kept.inverse_w.tolist() == [1.0, 1.0, inverse]
        plain = process(
            Mesh(corners), replace(state, perspective_correction=False), GEFORCE_256, WIDTH, HEIGHT
        )
        assert plain.inverse_w.tolist() == [1.0, 1.0, np.sign(inverse)]


def test_a_program_s_back_colours_are_taken_with_two_sides_and_are_opaque_black_if_absent():
    program = VertexState(stage=VertexStage.PROGRAM_RESULTS, two_side=True)
    mesh = Mesh(np.zeros((3, 2)), back_secondary_colors=np.ones((3, 4)))
    for state, expected in (
        (program, [[255] * 4 + [0] * 4, [0, 0, 0, 255] + [255] * 4]),
        (replace(program, two_side=False), [[255] * 4 + [0] * 4] * 2),
    ):
        got = process(mesh, PassState(vertex=state), GEFORCE_256, WIDTH, HEIGHT)
        assert got.colors[0].tolist() == expected


# --------------------------------------------------------------------------------- primitive assembly


@pytest.mark.parametrize(
    ("primitive", "n", "triangles", "first", "last"),
    [
        (PrimitiveType.TRIANGLES, 7, [(0, 1, 2), (3, 4, 5)], [0, 3], [2, 5]),
        (PrimitiveType.TRIANGLE_STRIP, 5, [(0, 1, 2), (2, 1, 3), (2, 3, 4)], [0, 1, 2], [2, 3, 4]),
        (PrimitiveType.TRIANGLE_FAN, 5, [(0, 1, 2), (0, 2, 3), (0, 3, 4)], [1, 2, 3], [2, 3, 4]),
        (PrimitiveType.QUADS, 9, [(0, 1, 2), (0, 2, 3), (4, 5, 6), (4, 6, 7)], [3, 3, 7, 7], [3, 3, 7, 7]),
        (
            PrimitiveType.QUAD_STRIP,
            7,
            [(0, 1, 2), (2, 1, 3), (2, 3, 4), (4, 3, 5)],
            [3, 3, 5, 5],
            [3, 3, 5, 5],
        ),
        (PrimitiveType.POLYGON, 5, [(0, 1, 2), (0, 2, 3), (0, 3, 4)], [0, 0, 0], [0, 0, 0]),
    ],
)
def test_primitives_split_as_the_chip_splits_them(primitive, n, triangles, first, last):
    positions = np.zeros((n, 2))
    for provoking, flat in ((ProvokingVertex.FIRST, first), (ProvokingVertex.LAST, last)):
        state = PassState(polygon=PolygonState(provoking_vertex=provoking))
        got = process(Mesh(positions, primitive), state, GEFORCE_256, WIDTH, HEIGHT).triangles.tolist()
        assert got == [[*corners, p] for corners, p in zip(triangles, flat, strict=True)]


def test_each_run_of_counts_is_a_primitive_of_its_own():
    mesh = Mesh(
        np.zeros((6, 2)), PrimitiveType.TRIANGLE_STRIP, indices=[5, 4, 3, 2, 1, 0, 1, 2], counts=(4, 1, 3)
    )
    got = process(mesh, PassState(), GEFORCE_256, WIDTH, HEIGHT).triangles.tolist()
    assert got == [[5, 4, 3, 3], [3, 4, 2, 2], [0, 1, 2, 2]]


@pytest.mark.parametrize("primitive", POLYGONS)
@pytest.mark.parametrize("n", range(3))
def test_incomplete_primitives_draw_nothing(primitive, n):
    got = process(Mesh(np.zeros((n, 3)), primitive), PassState(), GEFORCE_256, WIDTH, HEIGHT)
    assert got.triangles.shape == (0, 4)
    assert got.dropped == 0


def test_columns_have_the_types_that_rasterization_reads():
    mesh = Mesh([[0, 0], [1, 0], [0, 1]])
    got = process(mesh, PassState(texture_units=(None, TextureUnit("a"))), GEFORCE_256, WIDTH, HEIGHT)
    expected = {
        "x": ((3,), np.int32),
        "y": ((3,), np.int32),
        "z": ((3,), np.float64),
        "inverse_w": ((3,), np.float64),
        "colors": ((3, 2, 8), np.uint8),
        "coordinates": ((3, 2, 4), np.float64),
        "fog": ((3,), np.float64),
        "triangles": ((1, 4), np.int32),
    }
    for name, (shape, dtype) in expected.items():
        column = getattr(got, name)
        assert (column.shape, column.dtype) == (shape, dtype), name
        assert column.flags.c_contiguous, name
    assert got.colors[0].tolist() == [[255, 255, 255, 255, 0, 0, 0, 0]] * 2
    assert got.coordinates[0].tolist() == [[0, 0, 0, 1]] * 2


# --------------------------------------------------------------------------------------------- window


def one_triangle(positions, state=None, profile=GEFORCE_256, **arrays):
    return process(Mesh(positions, **arrays), state or PassState(), profile, WIDTH, HEIGHT)


def test_window_coordinates_are_truncated_toward_zero_with_y_down():
    """Here x = -1 is pixel 0; 512 (1 + x) and 384 (1 - y) are the values before truncation."""
    got = one_triangle([[-1.003, 1.003], [0.25, 0.5], [0.0, -1.0]])
    assert got.x.tolist() == [-1, 640, 512]  # 512 (1 - 1.003) = -1.536
    assert got.y.tolist() == [-1, 192, 768]  # 384 (1 - 1.003) = -1.152


def test_a_device_with_rows_from_below_truncates_toward_the_lower_edge():
    below = GEFORCE_256.changed(device_origin=WindowOrigin.LOWER_LEFT)
    positions = [[0.0, 0.001], [0.25, 0.5], [0.0, -1.0]]
    assert one_triangle(positions).y.tolist()[0] == 383  # trunc(384 * 0.999)
    assert one_triangle(positions, profile=below).y.tolist()[0] == 768 - 384  # 768 - trunc(384 * 1.001)


def test_the_viewport_and_depth_range_place_the_unit_cube():
    state = PassState(vertex=VertexState(viewport=Viewport(8, 4, 32, 16, near=0.25, far=0.75)))
    got = one_triangle([[-1, -1, -1], [1, 1, 1], [0, 0, 0]], state)
    assert got.x.tolist() == [8 * 16, 40 * 16, 24 * 16]
    assert got.y.tolist() == [(48 - 4) * 16, (48 - 20) * 16, (48 - 12) * 16]
    assert got.z.tolist() == [0.25, 0.75, 0.5]


def test_with_a_depth_clamp_depth_is_neither_clipped_nor_limited():
    mesh = Mesh(np.array([(-1.0, -1.0, -3.0), (1.0, -1.0, 0.5), (0.0, 1.0, 5.0)]))
    clamped = assert_equals_the_specification(mesh, PassState(depth_clamp=DepthClamp()))
    assert clamped.triangles[:, :3].tolist() == [[0, 1, 2]]
    assert clamped.z.tolist() == [-1.0, 0.75, 3.0]
    clipped = assert_equals_the_specification(mesh, PassState())
    assert len(clipped.triangles) > 1 and ((clipped.z[3:] >= 0.0) & (clipped.z[3:] <= 1.0)).all()
    endless = Mesh(np.array([(-0.1, -0.1, 1e308, 0.1), (0.1, -0.1, 0.0, 0.1), (0.0, 0.1, 0.0, 0.1)]))
    lost = assert_equals_the_specification(endless, PassState(depth_clamp=DepthClamp()))
    assert (len(lost.triangles), lost.dropped) == (0, 1)


def test_perspective_gives_the_inverse_of_the_distance():
    state = PassState(vertex=VertexState(projection=PERSPECTIVE))
    got = one_triangle([[0, 0, -2], [1, 0, -4], [0, 1, -8]], state)
    assert got.inverse_w.tolist() == [1 / 2, 1 / 4, 1 / 8]
    assert got.x.tolist() == [512, 512 + 192, 512]


# -------------------------------------------------------------------------------------------- colours


@pytest.mark.parametrize(
    ("value", "byte"),
    [
        (0.1, 25),
        (0.3, 76),
        (0.5, 128),
        (0.65, 166),
        (0.7, 178),
        (0.9, 229),
        (0.25, 64),
        (0.05, 13),
        (0.75, 191),
    ],
)
def test_vertex_colours_become_the_bytes_that_silicon_shows(value, byte):
    """Measured: NV2A, captures Point_params, Material_alpha, Stencil."""
    got = one_triangle(np.zeros((3, 2)), colors=np.full((3, 3), value))
    assert got.colors[0].tolist() == [[byte, byte, byte, 255, 0, 0, 0, 0]] * 2


@pytest.mark.parametrize(
    ("nz", "white", "grey"), [(0.70711, 180, 126), (0.31623, 81, 56), (0.97014, 247, 173), (1.0, 255, 179)]
)
def test_the_lighting_unit_gives_the_bytes_that_silicon_shows(nz, white, grey):
    """Measured: NV2A, captures Lighting_normals/Nz_*."""
    normals = np.tile([math.sqrt(1 - nz * nz), 0.0, nz], (3, 1))
    light = Light(diffuse=(1.0, 0.7, 0.0, 1.0))
    lighting = Lighting((light,), Material(diffuse=(1.0,) * 4), model_ambient=(0.0, 0.0, 0.0, 1.0))
    got = one_triangle(
        np.zeros((3, 2)), PassState(vertex=VertexState(lighting=lighting)), UNIT, normals=normals
    )
    assert got.colors[0, 0, :3].tolist() == [white, grey, 0]


def test_the_lighting_unit_s_light_ends_at_its_range():
    """Measured: NV2A, capture Lighting_range/Point: a vertex at the range is lit, one beyond it is not."""
    light = Light(position=(0.0, 0.0, 2.0, 1.0), range=2.0, ambient=(1.0,) * 4)
    lighting = Lighting((light,), model_ambient=(0.0, 0.0, 0.0, 1.0))
    state = PassState(vertex=VertexState(lighting=lighting))
    got = one_triangle([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, -0.5]], state, UNIT)
    assert (got.colors[:, 0, 0] > 0).tolist() == [True, False, False]


@pytest.mark.parametrize(
    ("nz", "white", "grey"), [(0.70711, 180, 126), (0.31623, 81, 56), (0.97014, 247, 173), (1.0, 255, 179)]
)
def test_lit_colours_become_the_bytes_that_silicon_shows(nz, white, grey):
    """Measured: NV2A, captures Lighting_normals/Nz_*; grey is a diffuse material of 0.7."""
    normals = np.tile([math.sqrt(1 - nz * nz), 0.0, nz], (3, 1))
    for diffuse, byte in ((1.0, white), (0.7, grey)):
        lighting = Lighting((Light(),), Material(diffuse=(diffuse,) * 4), model_ambient=(0.0, 0.0, 0.0, 1.0))
        state = PassState(vertex=VertexState(lighting=lighting))
        assert one_triangle(np.zeros((3, 2)), state, normals=normals).colors[0, 0, 0] == byte


def test_an_exact_machine_keeps_colours_as_they_are():
    got = one_triangle(np.zeros((3, 2)), profile=IDEAL, colors=np.full((3, 3), 1.7))
    assert got.colors.dtype == np.float64
    assert got.colors[0, 1].tolist() == [1.7, 1.7, 1.7, 1.0, 0.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize("lighting", [None, Lighting((Light(),))])
@pytest.mark.parametrize("depth_clamp", [None, DepthClamp()])  # the second is none of the kernel's
def test_colours_that_are_not_rounded_are_those_that_become_bytes(lighting, depth_clamp):
    random = np.random.default_rng(5)
    mesh = Mesh(
        random.uniform(-4, 4, (30, 3)),
        colors=random.uniform(0, 1, (30, 4)),
        normals=random.normal(size=(30, 3)),
    )
    vertex = VertexState(TURNED, PERSPECTIVE, lighting=lighting)
    state = PassState(vertex=vertex, depth_clamp=depth_clamp)
    rounded = process(mesh, state, GEFORCE_256, WIDTH, HEIGHT)
    got = process(mesh, state, GEFORCE_256, WIDTH, HEIGHT, rounded=False)
    assert len(got.x) > 30  # some are clipped
    assert (rounded.colors.dtype, got.colors.dtype) == (np.uint8, np.float64)
    bits = kept_color_bits(vertex, GEFORCE_256)
    np.testing.assert_array_equal(color_byte(got.colors, bits), rounded.colors)
    assert (got.colors * 255.0 % 1.0 > 0.0).any()
    exact = process(mesh, state, GEFORCE_256.changed(exact=True), WIDTH, HEIGHT)
    np.testing.assert_array_equal(got.colors, exact.colors)


# ------------------------------------------------------------------------------------------- lighting


def power(base, exponent):
    """The kernels' power of a column."""
    out = np.empty_like(base)
    lighting_columns.power(out, base, np.empty_like(base), float(exponent))
    return out


@settings(max_examples=300)
@given(st.floats(1e-4, 4), st.one_of(st.integers(0, 128), st.floats(0, 128)))
def test_the_power_is_within_1e_13_of_the_true_one_and_equals_the_specification(base, exponent):
    got = float(power(np.array([base]), exponent)[0])
    assert pattern(got) == pattern(reference.power(base, exponent))
    true = math.pow(base, exponent)
    if true > 1e-300:  # below, results lose bits of their own
        assert abs(got - true) <= 1e-13 * true


def test_the_power_has_the_values_that_lighting_needs_at_its_ends():
    base = np.array([0.0, 1.0, 0.25, 5e-324, 1e308])
    assert power(base, 1.0).tolist() == base.tolist()
    assert power(base, 0.5).tolist() == np.sqrt(base).tolist()
    assert power(base, 128).tolist() == [0.0, 1.0, 0.25**128, 0.0, math.inf]
    assert power(np.zeros(1), 0).tolist() == [1.0]


@pytest.mark.parametrize("angle", [*range(0, 91, 3), 22.5, 33.3, 89.99999])
def test_the_cosine_of_a_spot_cutoff_is_the_nearest_float(angle):
    got = cosine_of_degrees(angle)
    assert got == reference.cosine_of_degrees(angle)
    assert abs(got - math.cos(math.radians(angle))) < 3e-16  # radians() and cos() round once each


def test_the_cosine_is_exact_where_it_is_rational():
    assert [cosine_of_degrees(angle) for angle in (0, 60, 90)] == [1.0, 0.5, 0.0]


def lit(lighting, positions, normals, colors=None, **vertex):
    """Front and back colours, float64 [n, 7], of the lighting equation without rounding."""
    indices = [0, 0, 0]
    state = PassState(vertex=VertexState(lighting=lighting, **vertex))
    mesh = Mesh(positions, normals=normals, colors=colors, indices=indices)
    got = process(mesh, state, IDEAL, WIDTH, HEIGHT).colors
    return got[:, 0, :7], got[:, 1, :7]


def unit(v):
    return np.asarray(v, dtype=np.float64) / math.sqrt(sum(c * c for c in v))


SPHERE = np.array([unit(v) for v in np.random.default_rng(1).normal(size=(200, 3))])
BLACK = (0.0, 0.0, 0.0, 1.0)


def test_a_sphere_under_a_directional_light_follows_lamberts_and_blinns_laws():
    """Tolerance 1e-12: some thirty roundings of 2^-53, and n.h to the power 30 of one more."""
    light = Light(
        ambient=(0.1, 0.2, 0.3, 1.0),
        diffuse=(0.9, 0.8, 0.7, 1.0),
        specular=(0.5, 1.0, 0.25, 1.0),
        position=(1, 2, 2, 0),
    )
    material = Material(
        (0.5, 0.25, 1.0, 1.0), (0.3, 0.6, 0.9, 0.4), (1.0, 0.5, 0.25, 1.0), (0.01, 0.02, 0.03, 1.0), 30
    )
    front, _ = lit(Lighting((light,), material), SPHERE * 2 - [0, 0, 5], SPHERE)
    towards_light = unit((1, 2, 2))
    half = unit(towards_light + np.array([0.0, 0.0, 1.0]))
    for n, color in zip(SPHERE, front, strict=True):
        cosine = max(0.0, float(np.dot(n, towards_light)))
        highlight = max(0.0, float(np.dot(n, half))) ** 30 if cosine else 0.0
        for c in range(3):
            expected = (
                material.emission[c]
                + material.ambient[c] * (0.2 + light.ambient[c])
                + cosine * material.diffuse[c] * light.diffuse[c]
                + highlight * material.specular[c] * light.specular[c]
            )
            assert color[c] == pytest.approx(expected, abs=1e-12)
        assert color[3] == 0.4
        assert color[4:].tolist() == [0, 0, 0]


def test_a_point_light_weakens_with_distance():
    light = Light(
        position=(0.0, 0.0, 6.0, 2.0),
        constant_attenuation=0.5,
        linear_attenuation=0.25,
        quadratic_attenuation=0.125,
    )
    lighting = Lighting((light,), Material(diffuse=(1.0, 1.0, 1.0, 1.0)), model_ambient=BLACK)
    positions = [[0, 0, 1], [0, 4, 0]]  # 2 and 5 away from (0, 0, 3)
    front, _ = lit(lighting, positions, [[0, 0, 1], [0, 0, 1]])
    assert front[0, 0] == 1 / (0.5 + 0.5 + 0.5)
    assert front[1, 0] == pytest.approx(0.6 / (0.5 + 1.25 + 3.125), abs=1e-15)


def test_a_spotlight_lights_its_cone_alone():
    """The light is one above the plane; vertices lie at 0, 44.9, 45.1 and 180 degrees from its axis."""
    light = Light(position=(0, 0, 1, 1), spot_direction=(0, 0, -3), spot_exponent=2.0, spot_cutoff=45.0)
    lighting = Lighting((light,), Material(diffuse=(1.0, 1.0, 1.0, 1.0)), model_ambient=BLACK)
    inside, outside = math.tan(math.radians(44.9)), math.tan(math.radians(45.1))
    positions = [[0, 0, 0], [inside, 0, 0], [outside, 0, 0], [0, 0, 2]]
    front, _ = lit(lighting, positions, [[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, -1]])
    assert front[:, 0] == pytest.approx([1.0, math.cos(math.radians(44.9)) ** 3, 0.0, 0.0], abs=1e-15)


def test_a_local_viewer_sees_the_highlight_on_the_mirror_direction():
    """The highlight peaks where the normal halves the directions to the light, +z, and to the origin."""
    position = np.array([3.0, 0.0, -4.0])
    normal = unit(unit(-position) + np.array([0.0, 0.0, 1.0]))
    material = Material(specular=(1.0, 1.0, 1.0, 1.0), diffuse=BLACK, shininess=64)
    for local_viewer, expected in ((True, 1.0), (False, float(normal[2]) ** 64)):
        lighting = Lighting((Light(),), material, model_ambient=BLACK, local_viewer=local_viewer)
        front, _ = lit(lighting, [position], [normal])
        assert front[0, 0] == pytest.approx(expected, abs=1e-13)


def test_specular_light_does_not_reach_faces_turned_away_from_the_light():
    """The half vector is in front of the normal (1, 0, 0) in both cases, the second light is behind it."""
    material = Material(specular=(1.0, 1.0, 1.0, 1.0), shininess=1)
    for light_x, is_lit in ((-0.9, True), (-1.1, False)):
        light = Light(position=(light_x, 0.0, 1.0, 1.0), diffuse=BLACK)
        lighting = Lighting((light,), material, model_ambient=BLACK, local_viewer=True)
        front, _ = lit(lighting, [[-1.0, 0.0, 0.0]], [[1.0, 0.0, 0.0]])
        assert (front[0, 0] > 0.5) == is_lit
        assert (front[0, 0] == 0.0) != is_lit


def test_a_vertex_on_the_edge_of_the_cone_is_lit():
    """A cutoff of 0 leaves the axis alone."""
    light = Light(position=(0, 0, 1, 1), spot_cutoff=0.0)
    lighting = Lighting((light,), Material(diffuse=(1.0, 1.0, 1.0, 1.0)), model_ambient=BLACK)
    front, _ = lit(lighting, [[0, 0, 0], [0.01, 0, 0]], [[0, 0, 1], [0, 0, 1]])
    assert front[:, 0].tolist() == [1.0, 0.0]


def test_the_back_is_lit_with_the_negated_normal_and_the_back_material():
    front_material, back_material = Material(diffuse=(0.5, 0, 0, 0.25)), Material(diffuse=(0, 1.0, 0, 0.75))
    lighting = Lighting((Light(),), front_material, back_material, model_ambient=BLACK, two_side=True)
    front, back = lit(lighting, [[0, 0, 0], [0, 0, 0]], [[0, 0, 1], [0, 0.6, -0.8]])
    assert front.tolist() == [[0.5, 0, 0, 0.25, 0, 0, 0], [0, 0, 0, 0.25, 0, 0, 0]]
    assert back.tolist() == [[0, 0, 0, 0.75, 0, 0, 0], [0, 0.8, 0, 0.75, 0, 0, 0]]
    front, back = lit(replace(lighting, two_side=False), [[0, 0, 0]], [[0, 0, 1]])
    assert back.tolist() == front.tolist()


def test_separate_specular_color_goes_to_the_secondary_colour():
    material = Material(diffuse=(0.25, 0.25, 0.25, 1.0), specular=(0.5, 0.0, 1.0, 1.0), shininess=4)
    lighting = Lighting((Light(),), material, model_ambient=BLACK)
    front, _ = lit(lighting, [[0, 0, 0]], [[0, 0, 1]])
    assert front[0].tolist() == [0.75, 0.25, 1.25, 1, 0, 0, 0]
    front, _ = lit(replace(lighting, separate_specular_color=True), [[0, 0, 0]], [[0, 0, 1]])
    assert front[0].tolist() == [0.25, 0.25, 0.25, 1, 0.5, 0.0, 1.0]


@pytest.mark.parametrize(
    ("parameter", "expected"),
    [
        (ColorMaterialParameter.AMBIENT, 0.5 * 0.5 + 0.0625 + 0.125 + 0.03125),
        (ColorMaterialParameter.DIFFUSE, 0.25 * 0.5 + 0.5 + 0.125 + 0.03125),
        (ColorMaterialParameter.AMBIENT_AND_DIFFUSE, 0.5 * 0.5 + 0.5 + 0.125 + 0.03125),
        (ColorMaterialParameter.SPECULAR, 0.25 * 0.5 + 0.0625 + 0.5 + 0.03125),
        (ColorMaterialParameter.EMISSION, 0.25 * 0.5 + 0.0625 + 0.125 + 0.5),
    ],
)
@pytest.mark.parametrize("face", Face)
def test_color_material_replaces_the_parameter_on_its_face(parameter, expected, face):
    material = Material((0.25,) * 4, (0.0625,) * 4, (0.125,) * 4, (0.03125,) * 4, 1)
    lighting = Lighting(
        (Light(), Light(position=(0.0, 0.0, -1.0, 0.0))),
        material,
        material,
        model_ambient=(0.5,) * 4,
        two_side=True,
        color_material=ColorMaterial(face, parameter),
        local_viewer=True,
    )
    # Each face looks straight at one of the two lights, the viewer is on their axis in front: h is L for the
    # light on that side and 0 for the other, so the back has no highlight.
    front, back = lit(lighting, [[0.0, 0.0, -2.0]], [[0.0, 0.0, 1.0]], colors=[[0.5, 0.5, 0.5, 0.5]])
    untouched = 0.25 * 0.5 + 0.0625 + 0.125 + 0.03125
    assert front[0, 0] == (expected if face != Face.BACK else untouched)
    follows_alpha = parameter in (ColorMaterialParameter.DIFFUSE, ColorMaterialParameter.AMBIENT_AND_DIFFUSE)
    assert front[0, 3] == (0.5 if follows_alpha and face != Face.BACK else 0.0625)
    without_highlight = {ColorMaterialParameter.SPECULAR: 0.5}.get(parameter, 0.125)
    assert back[0, 0] == (expected - without_highlight if face != Face.FRONT else untouched - 0.125)


def test_normals_are_perpendicular_to_transformed_tangents():
    """The normal matrix is the inverse transpose; tolerance: a dozen roundings of numbers below 10."""
    state = PassState(
        vertex=VertexState(modelview=SQUASHED),
        texture_units=(TextureUnit("a", gen=(*[TexGen(TexGenMode.NORMAL_MAP)] * 3, TexGen())),),
    )
    mesh = Mesh(SPHERE, normals=SPHERE, indices=[0, 0, 0])
    eye_normals = process(mesh, state, GEFORCE_256, WIDTH, HEIGHT).coordinates[:, 0, :3]
    matrix = np.array(SQUASHED)[:3, :3]
    for n, eye_normal in zip(SPHERE, eye_normals, strict=True):
        for tangent in (np.cross(n, (1, 0, 0)), np.cross(n, (0, 1, 0))):
            assert np.dot(matrix @ tangent, eye_normal) == pytest.approx(0.0, abs=1e-14)


@pytest.mark.parametrize("switch", ["normalize", "rescale_normal"])
def test_normals_regain_unit_length_under_uniform_scaling(switch):
    scaled = tuple(tuple(4.0 * c if i < 3 else c for c in row) for i, row in enumerate(TURNED))
    state = PassState(
        vertex=VertexState(modelview=scaled, **{switch: True}),
        texture_units=(TextureUnit("a", gen=(*[TexGen(TexGenMode.NORMAL_MAP)] * 3, TexGen())),),
    )
    mesh = Mesh(SPHERE, normals=SPHERE, indices=[0, 0, 0])
    normals = process(mesh, state, GEFORCE_256, WIDTH, HEIGHT).coordinates[:, 0, :3]
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-14)


def test_only_states_that_read_normals_need_a_determinant_that_is_finite():
    large = tuple(tuple(1e200 * (i == j) for j in range(4)) for i in range(4))
    positions = [[-1, -1, 5], [1, -1, 7], [0, 1, 9]]
    one_triangle(positions, PassState(vertex=VertexState(modelview=large)))
    lighting = Lighting((Light(),))
    with pytest.raises(ValueError, match=r"has the determinant inf.*: scale the matrix down"):
        one_triangle(positions, PassState(vertex=VertexState(modelview=large, lighting=lighting)))


@pytest.mark.parametrize("profile", [GEFORCE_256, NV2A], ids=lambda p: p.name)
@pytest.mark.parametrize("switch", [{}, {"normalize": True}])
def test_a_matrix_without_an_inverse_turns_normals_itself(profile, switch):
    """Source: WineHQ dlls/d3d9/tests/visual.c, lighting_test, whose singular matrix is lit in full."""
    singular = ((1.0, 0.0, 1.0, 0.0), (0.0, 1.0, 0.0, 0.0), (1.0, 0.0, 1.0, -0.5), (0.0, 0.0, 0.0, 1.0))
    dark, facing = (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0)
    light = Light(ambient=dark, diffuse=(0.2, 1.0, 0.6, 1.0), specular=dark, position=facing)
    front = Material(ambient=dark, diffuse=(1.0, 1.0, 1.0, 1.0), specular=dark)
    lighting = Lighting((light,), model_ambient=dark, front=front)
    state = PassState(vertex=VertexState(modelview=singular, lighting=lighting, **switch))
    mesh = Mesh([[-1, -1, 5], [1, -1, 7], [0, 1, 9]], normals=[[0.0, 0.0, 1.0]] * 3)
    found = process(mesh, state, profile, WIDTH, HEIGHT).colors
    for i, sides in enumerate(found.tolist()):
        vertex = reference.process_vertex(mesh, i, state, profile)
        assert sides == [reference.color_codes(side, False, profile) for side in vertex.colors]
    # The normal is (1, 0, 1), as it is or normalised.
    shown = np.array([0.2, 1.0, 0.6]) * (np.sqrt(0.5) if switch else 1.0)
    np.testing.assert_allclose(found[:, 0, :3], np.tile(255 * shown, (3, 1)), atol=1.5)


# --------------------------------------------------------------------- texture and fog coordinates


def generated(positions, gen, normals=None, **vertex):
    state = PassState(vertex=VertexState(**vertex), texture_units=(TextureUnit("a", gen=gen),))
    mesh = Mesh(
        positions,
        normals=normals,
        indices=[0, 0, 0],
        texture_coordinates=(np.full((len(positions), 4), 7.0),),
    )
    return process(mesh, state, GEFORCE_256, WIDTH, HEIGHT).coordinates[:, 0]


def test_linear_generation_measures_planes_in_object_or_eye_coordinates():
    moved = ((1.0, 0.0, 0.0, 10.0), (0.0, 2.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    plane = (1.0, 10.0, 100.0, 1000.0)
    gen = (TexGen(TexGenMode.OBJECT_LINEAR, plane), TexGen(TexGenMode.EYE_LINEAR, plane), TexGen(), TexGen())
    assert generated([[1.0, 2.0, 3.0]], gen, modelview=moved).tolist() == [[1321.0, 1351.0, 7.0, 7.0]]


def test_reflection_vectors_obey_the_law_of_reflection():
    """The vectors u and r make opposite angles with n in one plane; tolerance: a dozen roundings."""
    gen = (*[TexGen(TexGenMode.REFLECTION_MAP)] * 3, TexGen())
    positions = SPHERE[::-1] * 3
    for u, n, (*r, q) in zip(SPHERE[::-1], SPHERE, generated(positions, gen, SPHERE).tolist(), strict=True):
        assert np.linalg.norm(r) == pytest.approx(1.0, abs=1e-14)
        assert np.dot(r, n) == pytest.approx(-np.dot(u, n), abs=1e-14)
        assert np.dot(r, np.cross(u, n)) == pytest.approx(0.0, abs=1e-14)
        assert q == 7.0


def test_a_sphere_map_shows_each_direction_at_the_normal_that_mirrors_it():
    """Looking along -z, (2s - 1, 2t - 1) is the normal's (x, y). Tolerance: the division by a small m."""
    gen = (TexGen(TexGenMode.SPHERE_MAP), TexGen(TexGenMode.SPHERE_MAP), TexGen(), TexGen())
    facing = SPHERE[SPHERE[:, 2] > 0.05]
    got = generated(np.tile([0.0, 0.0, -1.0], (len(facing), 1)), gen, facing)
    assert got[:, :2] * 2 - 1 == pytest.approx(facing[:, :2], abs=1e-13)
    straight_back = generated([[0.0, 0.0, -1.0]], gen, [[1.0, 0.0, 0.0]])
    assert straight_back[0, :2].tolist() == [0.5, 0.5]


@given(arrays(ordinary, 3, 3), arrays(ordinary, 3, 3), st.booleans())
def test_a_transform_unit_generates_maps_as_specified(positions, normals, sphere):
    mode = TexGenMode.SPHERE_MAP if sphere else TexGenMode.REFLECTION_MAP
    third = TexGen() if sphere else TexGen(mode)
    state = PassState(texture_units=(TextureUnit("any", gen=(TexGen(mode), TexGen(mode), third, TexGen())),))
    mesh = Mesh(positions, normals=normals)
    got = process(mesh, state, UNIT, WIDTH, HEIGHT).coordinates[:3, 0]
    expected = [reference.process_vertex(mesh, i, state, UNIT).coordinates[0] for i in range(3)]
    assert got.tolist() == expected


def test_a_transform_unit_reflects_in_24_bits():
    """Measured: Texgen_with_texture_matrix ReflectionMap_RotateX, SphereMap_Double; here a 3:4:5 triangle."""
    gen = (*[TexGen(TexGenMode.REFLECTION_MAP)] * 3, TexGen())
    state = PassState(texture_units=(TextureUnit("any", gen=gen),))
    mesh = Mesh([[3.0, 0.0, -4.0]] * 3, normals=np.zeros((3, 3)))
    x, y, z, _ = process(mesh, state, UNIT, WIDTH, HEIGHT).coordinates[0, 0]
    assert (x, y, z) == (np.float32(0.6) - 2.0**-23 * 0.5, 0.0, -np.float32(0.8) + 2.0**-24)


def test_the_texture_matrix_follows_generation():
    matrix = ((0.0, 2.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.5), (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 4.0))
    unit_state = TextureUnit(
        "a", gen=(TexGen(TexGenMode.OBJECT_LINEAR, (1.0, 0.0, 0.0, 0.0)), *[TexGen()] * 3)
    )
    state = PassState(texture_units=(None, replace(unit_state, matrix=matrix, coordinates=1)))
    sets = (np.zeros((3, 1)), [[9.0, 3.0]] * 3)
    got = one_triangle([[5.0, 0.0], [6.0, 0.0], [7.0, 0.0]], state, texture_coordinates=sets)
    assert got.coordinates[0].tolist() == [[0.0, 0.0, 0.0, 1.0], [6.0, 5.5, 0.0, 4.0]]


def test_the_fog_coordinate_is_the_eye_distance_or_the_vertexs_own():
    positions, own = [[0.0, 0.0, -0.5], [1.0, 0.0, 0.25], [0.0, 1.0, 0.0]], [4.0, 5.0, 6.0]
    for source, expected in (
        (FogCoordinateSource.FRAGMENT_DEPTH, [0.5, 0.25, 0.0]),
        (FogCoordinateSource.FOG_COORDINATE, own),
    ):
        got = one_triangle(positions, PassState(fog=Fog(coordinate_source=source)), fog_coordinates=own)
        assert got.fog.tolist() == expected
    assert one_triangle(positions, fog_coordinates=own).fog.tolist() == [0.0, 0.0, 0.0]


# ------------------------------------------------------------------------------------------- clipping


def test_attributes_of_clipped_vertices_are_those_of_their_place():
    """Coordinates are set to object coordinates, so projecting them again must land where the vertex is.

    Tolerance: half a subpixel step for the truncation, and the rounding of t.
    """
    state = PassState(vertex=VertexState(projection=PERSPECTIVE), texture_units=(TextureUnit("a"),))
    positions = np.random.default_rng(5).uniform(-4, 2, size=(300, 3))
    mesh = Mesh(positions, texture_coordinates=(positions,))
    got = process(mesh, state, GEFORCE_256, WIDTH, HEIGHT)
    clipped = np.unique(got.triangles[:, :3])
    clipped = clipped[clipped >= 300]
    assert len(clipped) > 100
    place = got.coordinates[clipped, 0]
    image = place @ np.array(PERSPECTIVE).T
    x = (image[:, 0] / image[:, 3] + 1) * WIDTH * 8
    assert np.abs(np.trunc(x) - got.x[clipped]).max() <= 1
    distance = (image[:, 2] + image[:, 3]) * (image[:, 3] - image[:, 2])
    assert distance.min() > -1e-12
    assert (np.abs(distance) < 1e-12).sum() > len(clipped) / 4
    assert got.inverse_w[clipped] == pytest.approx(1 / image[:, 3], rel=1e-9)


def test_triangles_that_share_a_clipped_edge_share_its_new_vertices():
    state = PassState(vertex=VertexState(projection=PERSPECTIVE))
    mesh = Mesh(
        [[-1.1, 0.3, -2.0], [0.7, -0.4, -3.0], [0.2, 0.1, 1.0], [1.3, 0.9, 2.0]], indices=[0, 1, 2, 2, 1, 3]
    )
    got = process(mesh, state, GEFORCE_256, WIDTH, HEIGHT)
    corners = [{(got.x[v], got.y[v], got.z[v]) for v in row[:3]} for row in got.triangles.tolist()]
    assert len(corners) == 3  # a quadrilateral and a triangle
    assert len((corners[0] | corners[1]) & corners[2]) == 2


def test_clipping_keeps_the_draw_order_and_the_provoking_vertex():
    near, far = [[-1, 0, -2], [1, 0, -2], [0, 1, 2]], [[-1, 0, -4], [1, 0, -4], [0, 1, -4]]
    shades = np.repeat(np.arange(12) / 15.0, 3).reshape(12, 3)
    mesh = Mesh([*far, *near, *far, *near], colors=shades)
    got = process(mesh, PassState(vertex=VertexState(projection=PERSPECTIVE)), GEFORCE_256, WIDTH, HEIGHT)
    assert got.triangles[:, 3].tolist() == [2, 5, 5, 8, 11, 11]
    assert got.colors[got.triangles[:, 3], 0, 0].tolist() == [17 * k for k in (2, 5, 5, 8, 11, 11)]


def test_triangles_off_the_screen_but_inside_the_guard_band_are_left_alone():
    positions = [[-200.0, 0.0], [200.0, 0.0], [0.0, 250.0]]
    got = one_triangle(positions)
    assert len(got.x) == 3
    assert got.x.tolist() == [-199 * 512, 201 * 512, 512]
    clipped = one_triangle([[-300.0, 0.0], [200.0, 0.0], [0.0, 250.0]])
    assert clipped.x[clipped.triangles[:, :3]].min() == -8192 * 16


def test_user_planes_cut_in_eye_coordinates():
    vertex = VertexState(modelview=TURNED, projection=PERSPECTIVE, clip_planes=((1.0, 0.0, 0.0, 0.0),))
    got = one_triangle(SPHERE[:198], PassState(vertex=vertex))
    used = got.x[np.unique(got.triangles[:, :3])]
    assert len(used) > 100
    assert used.min() in (
        511,
        512,
    )  # x_e = 0 is the middle column; a rounding error below it is truncated away


# --------------------------------------------------------------------------------- what cannot be drawn


def test_a_vertex_at_the_eye_is_clipped_away_not_dropped():
    """Its clip w is 0, but it lies outside the near plane."""
    state = PassState(vertex=VertexState(projection=PERSPECTIVE))
    got = one_triangle([[0.0, 0.0, 0.0], [1.0, 0.0, -3.0], [-1.0, 0.5, -3.0]], state)
    assert (len(got.triangles), got.dropped) == (2, 0)


def test_triangles_without_a_finite_window_position_are_dropped_and_counted():
    no_w = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0))
    assert one_triangle([[0, 0], [0, 0], [0, 0]], PassState(vertex=VertexState(projection=no_w))).dropped == 1
    large = tuple(tuple(1e300 * c for c in row) for row in IDENTITY)
    positions = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [1e9, 0, 0], [0, 1, 0]]
    got = one_triangle(positions, PassState(vertex=VertexState(modelview=large, projection=IDENTITY)))
    assert got.triangles.tolist() == [[0, 1, 2, 2]]
    assert got.dropped == 1


def test_an_infinite_clip_w_is_dropped_once_with_and_without_clipped_neighbours():
    infinite_w = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1e300))
    state = PassState(vertex=VertexState(projection=infinite_w))
    lost = [[0.0, 0.0, 0.0, 1e10], [1.0, 0.0, 0.0, 1e-300], [0.0, 1.0, 0.0, 1e-300]]
    crossing = [[0.0, 0.0, -2.0, 1e-300], [1.0, 0.0, 0.0, 1e-300], [0.0, 1.0, 0.0, 1e-300]]
    for positions, triangles in ((lost, 0), (lost + crossing, 2)):
        got = assert_equals_the_specification(Mesh(positions), state)
        assert (len(got.triangles), got.dropped) == (triangles, 1)


@pytest.mark.parametrize("axis", [0, 1])
def test_an_overflow_along_one_axis_of_a_clipped_edge_drops_the_triangle(axis):
    """The edge's t is 0 because its denominator overflows, and 0 times the overflowing difference is NaN.

    A framebuffer of one pixel without a guard band keeps every other number finite.
    """
    inside, outside = [0.0, 0.0, 0.0, 1.2e308], [0.0, 0.0, -1.7e308, 1e308]
    inside[axis], outside[axis] = 1e308, -1e308
    profile = GEFORCE_256.changed(guard_band=0)
    got = process(Mesh([inside, outside, inside]), PassState(), profile, 1, 1)
    assert (len(got.triangles), got.dropped) == (0, 1)
