"""Vertices by the kernel are those by NumPy's columns, bit for bit; so are primitives sorted in one pass."""

import gc
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bench.scenes import SCENES, torus
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import Face, PolygonMode, ProvokingVertex, TexGenMode, WindowOrigin
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.native import prepared_draw
from fixedpipe.pipeline.native.pack import pack
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, NV2A
from fixedpipe.pipeline.state import (
    IDENTITY,
    DepthClamp,
    Fog,
    Light,
    Lighting,
    PassState,
    PolygonState,
    Scissor,
    TexGen,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.vertices import plan, projection
from fixedpipe.pipeline.vertices.clip import clip, clip_planes
from fixedpipe.pipeline.vertices.primitives import WindowPrimitives
from fixedpipe.pipeline.vertices.stage import process, process_columns
from fixedpipe.raster.primitives.clip import MOST_VERTICES, clip_triangles, find_clipped
from fixedpipe.raster.primitives.vertices import single_depths
from tests.pipeline.vertices.test_stage import (
    HEIGHT,
    PERSPECTIVE,
    TURNED,
    WIDTH,
    arrays,
    fogs,
    generators,
    has_inverse,
    huge,
    lightings,
    matrices,
    ordinary,
    tuples,
    viewports,
)
from tests.support.strategies import POLYGONS


def bits(array):
    """An array as integers that are equal where its bits are; all NaNs are one."""
    if array.dtype != np.float64:
        return array
    return np.where(np.isnan(array), np.nan, array).view(np.int64)


def is_by_kernel(primitives):
    """Whether a kernel made them: who makes primitives column by column does not know them orderly."""
    return "known_orderly" in primitives.__dict__


def assert_equal_triangles(got, expected):
    """The same triangles, whatever places their vertices have."""
    assert (got.dropped, got.two_side, len(got.strokes)) == (expected.dropped, expected.two_side, 0)
    assert (got.inverse_w > 0).all()  # of vertices that no triangle names as well
    for name in ("x", "y", "z", "inverse_w", "colors", "coordinates", "fog"):
        a, b = getattr(got, name), getattr(expected, name)
        assert (a.dtype, a.shape[1:], a.flags.c_contiguous) == (b.dtype, b.shape[1:], True), name
        corners = slice(4) if name == "colors" else slice(3)
        a, b = bits(a)[got.triangles[:, corners]], bits(b)[expected.triangles[:, corners]]
        np.testing.assert_array_equal(a, b, err_msg=name)


def assert_equal(got, expected):
    for field in fields(WindowPrimitives):
        a, b = getattr(got, field.name), getattr(expected, field.name)
        if isinstance(b, np.ndarray):
            assert (a.dtype, a.shape, a.flags.c_contiguous) == (b.dtype, b.shape, True), field.name
            np.testing.assert_array_equal(bits(a), bits(b), err_msg=field.name)
        else:
            assert a == b, field.name
    assert got.constant_color == expected.constant_color
    assert got.projective == expected.projective
    assert got.orderly == expected.orderly


def both(mesh, state, profile=GEFORCE_256, width=WIDTH, height=HEIGHT):
    """Compare the two; True where the kernel took part."""
    got = process(mesh, state, profile, width, height)
    with np.errstate(all="ignore"):
        expected = process_columns(mesh, state, profile, width, height)
    assert not is_by_kernel(expected)
    assert_equal_triangles(got, expected)
    kept = plan.mesh_columns(mesh).triangles
    if got.triangles is kept.get(state.polygon.provoking_vertex):  # none of them is clipped
        assert got.constant_color == expected.constant_color
        assert got.projective == expected.projective
        assert got.orderly or not expected.orderly
    return is_by_kernel(got)


# ------------------------------------------------------------------------------ the kernel and the columns

coefficient = st.sampled_from([0.0, -0.0, 1.0, -1.0, 0.5, 3.0, 0.1])
linear_row = tuples(coefficient, 4)
W_ROWS = [(0.0, 0.0, 0.0, 1.0), (-0.0, 0.0, 0.0, 2.0), (0.0, 0.125, -0.125, 3.0)]
DEPTH_ROWS = [(0.0, 0.0, 0.03125, 0.0), (-0.0, 0.0, 0.0, 0.0), (0.0, 0.0, -0.03125, 0.5)]
# Matrices under which small positions stay inside every clipping plane, with all that may be left out.
modelviews = st.tuples(linear_row, linear_row, linear_row, st.sampled_from(W_ROWS[:2]))
projections = st.tuples(linear_row, linear_row, st.sampled_from(DEPTH_ROWS), st.sampled_from(W_ROWS))
small = st.sampled_from([0.0, -0.0, 0.25, -0.25, 0.1, -0.3, 5e-324])


@st.composite
def inside(draw, coordinate):
    """A mesh of small positions with anything for texture coordinates."""
    n = draw(st.integers(3, 9))
    positions = draw(arrays(small, n, draw(st.integers(2, 4))))
    if positions.shape[1] == 4:
        positions[:, 3] = np.abs(positions[:, 3]) + 1.0
    colors = draw(st.none() | arrays(st.floats(-0.25, 1.5), n, draw(st.integers(3, 4))))
    if colors is not None and draw(st.booleans()):
        colors[:] = colors[0]
    indices = draw(st.none() | st.lists(st.integers(0, n - 1), min_size=3, max_size=12))
    stream = n if indices is None else len(indices)
    cut = draw(st.integers(0, stream))
    return Mesh(
        positions,
        primitive=draw(st.sampled_from(POLYGONS)),
        indices=indices,
        counts=draw(st.sampled_from([None, (cut, stream - cut)])),
        colors=colors,
        secondary_colors=draw(st.none() | arrays(st.floats(0, 1), n, 3)),
        back_colors=draw(st.none() | arrays(st.floats(0, 1), n, 4)),
        normals=draw(st.none() | arrays(ordinary, n, 3)),
        texture_coordinates=tuple(
            draw(arrays(coordinate, n, draw(st.integers(1, 4)))) for _ in range(draw(st.integers(0, 2)))
        ),
        fog_coordinates=draw(st.none() | st.lists(ordinary, min_size=n, max_size=n)),
    )


LINEAR = [TexGenMode.NONE, TexGenMode.OBJECT_LINEAR, TexGenMode.EYE_LINEAR]
OF_NORMALS = [TexGenMode.NONE, TexGenMode.NORMAL_MAP, TexGenMode.REFLECTION_MAP]


def units(modes, element):
    plain = st.builds(TextureUnit, texture=st.just("any"), coordinates=st.integers(0, 2))
    generated = st.builds(
        TextureUnit,
        texture=st.just("any"),
        coordinates=st.integers(0, 2),
        gen=st.tuples(*[generators(modes, element)] * 3, generators(LINEAR, element)),
        matrix=st.just(IDENTITY) | matrices(element) | tuples(linear_row, 4),
    )
    return st.lists(st.none() | plain | generated, max_size=3).map(tuple)


def states(modes, element, lighting, fog):
    return st.builds(
        PassState,
        vertex=st.builds(
            VertexState,
            modelview=modelviews,
            projection=projections,
            viewport=viewports,
            normalize=st.booleans(),
            two_side=st.booleans() if lighting is None else st.just(False),
            lighting=st.none() if lighting is None else lighting,
        ),
        polygon=st.builds(PolygonState, provoking_vertex=st.sampled_from(ProvokingVertex)),
        texture_units=units(modes, element),
        fog=fog,
        perspective_correction=st.booleans(),
    )


machines = st.sampled_from(
    [GEFORCE_256, NV2A, IDEAL, GEFORCE_256.changed(device_origin=WindowOrigin.LOWER_LEFT, subpixel_bits=3)]
)


@settings(max_examples=300)
@given(inside(huge), states(LINEAR, huge, None, st.none()), machines)
def test_linear_vertices_of_the_kernel_equal_the_columns(mesh, state, profile):
    assert both(mesh, state, profile)


@settings(max_examples=150)
@given(inside(ordinary), states(OF_NORMALS, ordinary, st.none() | lightings, st.none() | fogs()))
def test_lit_fogged_and_reflecting_vertices_of_the_kernel_equal_the_columns(mesh, state):
    assume(has_inverse(state.vertex.modelview))
    assert both(mesh, state)


extreme_row = tuples(huge | coefficient, 4)


@settings(max_examples=300)
@given(inside(huge), tuples(extreme_row, 4))
def test_any_matrix_gives_the_bits_of_the_columns(mesh, rows):
    both(mesh, PassState(vertex=VertexState(projection=rows)))
    both(mesh, PassState(vertex=VertexState(modelview=rows, projection=PERSPECTIVE)))


def grid(n=33):
    """More vertices than one chunk, and not a multiple of it."""
    s, t = np.meshgrid(np.linspace(-0.5, 0.5, n), np.linspace(-0.5, 0.5, n))
    st = np.stack([s, t, 0 * s, 1.5 + t], -1).reshape(-1, 4)
    return Mesh(st, indices=np.arange(n * n // 3 * 3), texture_coordinates=(st, st[:, :2]))


def test_many_vertices_equal_the_columns_chunk_after_chunk():
    gen = (TexGen(), TexGen(TexGenMode.EYE_LINEAR, (0.5, 0.0, 1.0, -0.0)), TexGen(), TexGen())
    units = (TextureUnit("t", gen=gen, matrix=PERSPECTIVE), None, TextureUnit("t", coordinates=1))
    vertex = VertexState(TURNED, PERSPECTIVE)
    mesh = grid()
    assert len(mesh.positions) > 8 * plan.V.CHUNK
    assert both(mesh, PassState(vertex=vertex, texture_units=units))
    lit = replace(vertex, lighting=Lighting(lights=(Light(),)))
    assert both(mesh, PassState(vertex=lit, texture_units=units, fog=Fog()))


@pytest.mark.parametrize("name", sorted(SCENES))
def test_measured_scenes_are_the_kernels_and_equal_the_columns(name):
    draw = SCENES[name].draw(256)
    assert both(draw.mesh, draw.state, GEFORCE_256, 256, 256)


# One vertex of each of these is outside a plane, or has no usable window coordinates.
OUTSIDE = {
    "near": (0.0, 0.0, -1.5, 1.0),
    "far": (0.0, 0.0, 1.5, 1.0),
    "left": (-1e5, 0.0, 0.0, 1.0),
    "right": (1e5, 0.0, 0.0, 1.0),
    "below": (0.0, -1e5, 0.0, 1.0),
    "above": (0.0, 1e5, 0.0, 1.0),
    "behind": (0.0, 0.0, 0.0, -1.0),
    "w 0": (0.0, 0.0, 0.0, 0.0),
    "infinite 1/w": (0.0, 0.0, 0.0, 1e-310),
}


@pytest.mark.parametrize("place", [0, 127, 128, 500])
@pytest.mark.parametrize("name", OUTSIDE)
def test_one_vertex_outside_leaves_the_other_triangles_to_the_kernel(name, place):
    mesh = grid()
    positions = mesh.positions.copy()
    positions[place] = OUTSIDE[name]
    indices = np.arange(len(positions) - 2)[:, None] + (0, 2, 1)
    mesh = replace(mesh, positions=positions, indices=indices.ravel())
    lit = VertexState(lighting=Lighting(lights=(Light(),)))
    assert both(mesh, PassState(texture_units=(TextureUnit("t"),)))
    assert both(mesh, PassState(vertex=lit, fog=Fog(), texture_units=(TextureUnit("t", matrix=TURNED),)))
    assert both(replace(mesh, indices=indices[place - 1] if place else indices[0]), PassState())


@settings(max_examples=300)
@given(
    inside(ordinary),
    st.lists(st.sampled_from([*OUTSIDE.values(), *[(0.1, 0.2, 0.3, 1.0)] * 9]), min_size=9, max_size=9),
    st.booleans(),
    units(LINEAR, ordinary),
    st.sampled_from(ProvokingVertex),
)
def test_clipped_triangles_keep_their_places_between_the_others(
    mesh, positions, lit, texture_units, provoking
):
    positions = np.array(positions)[: len(mesh.positions)]
    positions[:, :2] += np.arange(len(positions))[:, None] / (16, -32)
    state = PassState(
        vertex=VertexState(lighting=Lighting(lights=(Light(),)) if lit else None),
        polygon=PolygonState(provoking_vertex=provoking),
        texture_units=texture_units,
    )
    both(replace(mesh, positions=positions), state)


# Clip coordinates around a frame of 64 x 32 pixels whose guard band is 16 pixels wide, and unusable ones.
near_planes = st.floats(-4, 4) | st.sampled_from([0.0, -0.0, 1.0, -1.0, 1.5, -1.5, 2.0, 4.0])
unusable = st.sampled_from(
    [np.nan, np.inf, -np.inf, 1e308, -1e308, 1.7e308, 1e-310, 5e-324, -5e-324, 2.0**-401, 2.0**401]
)
ws = near_planes | st.just(1.0) | st.floats(0.5, 2)
clip_vertices = st.tuples(near_planes, near_planes, near_planes, ws) | tuples(near_planes | unusable, 4)


@settings(max_examples=600)
@given(
    st.lists(clip_vertices, min_size=3, max_size=12),
    st.lists(tuples(st.integers(0, 11), 4), max_size=8),
    st.lists(tuples(ordinary | unusable, 12), min_size=3, max_size=3),
    st.sampled_from([GEFORCE_256, NV2A]),
    viewports,
)
def test_triangles_clipped_one_by_one_are_those_clipped_at_once(places, rows, others, profile, viewport):
    profile = profile.changed(guard_band=16)
    count = len(places)
    columns = [*np.array(places).T, *np.array(others)[:, :count]]
    rows = np.array(rows, np.int32).reshape(-1, 4) % count
    state = PassState(vertex=VertexState(viewport=viewport))
    half_size, center = projection.viewport_transform(viewport, WIDTH, HEIGHT)
    planes = clip_planes((), half_size, center, (WIDTH, HEIGHT), profile.arithmetic.guard_band, False)
    with np.errstate(all="ignore"):
        expected, clipped, origin, dropped = clip(rows, columns, count, planes)
        x, y, z, inverse_w = projection.window_coordinates(clipped[:4], viewport, half_size, center)
        drawable = (inverse_w > 0) & (inverse_w < np.inf) & np.isfinite(x) & np.isfinite(y) & np.isfinite(z)
        inside = drawable[:count] & np.all([plane(columns) >= 0 for plane in planes], axis=0)
    lost = np.unique(origin[~drawable[expected[:, :3]].all(axis=1)])
    expected = expected[~np.isin(origin, lost)]

    found, chosen = np.where(inside, 2.0, 0.0), np.empty(len(rows), np.int32)
    chosen = chosen[: find_clipped(rows, found, chosen)]
    assert chosen.tolist() == np.flatnonzero(~inside[rows[:, :3]].all(axis=1)).tolist()
    assert found.tolist() == np.where(inside, 2.0, 1.0).tolist()
    corners = np.ascontiguousarray(np.stack(columns, axis=1)[rows[chosen, :3].ravel()])
    most = MOST_VERTICES * len(chosen)
    window = np.empty(most, np.int32), np.empty(most, np.int32), np.empty(most), np.empty(most)
    values, triangles = np.empty((most, len(columns))), np.empty((len(rows) + most, 4), np.int32)
    parameters = plan._parameters(state, profile, WIDTH, HEIGHT)
    number, made, lost_here, unusual = clip_triangles(
        rows,
        chosen,
        corners,
        parameters,
        count,
        np.empty((2, MOST_VERTICES, len(columns))),
        (values, *window),
        triangles,
    )
    np.testing.assert_array_equal(triangles[:number], expected)
    np.testing.assert_array_equal(bits(values[:made].T), bits(np.array([c[count:] for c in clipped])))
    assert lost_here == dropped + len(lost)
    with np.errstate(all="ignore"):
        snapped = projection.snap(x[count:], WIDTH, profile)
    np.testing.assert_array_equal(window[0][:made], snapped.astype(np.int32))
    new = inverse_w[count:]
    usable = drawable[count:]
    np.testing.assert_array_equal(window[3][:made], np.where(usable, new, 1.0))
    assert bool(unusual) == bool((usable & ((new < 2.0**-400) | (new > 2.0**400))).any())


def test_a_w_that_cannot_be_drawn_is_dropped_as_before():
    positions = np.array([(0, 0, 0, 1), (1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 0, 1)], float)
    positions[0, 3] = 2.0**-401
    mesh = Mesh(positions, indices=(0, 1, 2, 1, 2, 3))
    primitives = process(mesh, PassState(), GEFORCE_256, 8, 8)
    assert is_by_kernel(primitives)
    assert not primitives.orderly
    assert execute([Draw(label="w", mesh=mesh, state=PassState())], GEFORCE_256, 8, 8).dropped == 1
    linear = PassState(perspective_correction=False)
    assert process(mesh, linear, GEFORCE_256, 8, 8).orderly


# ----------------------------------------------------------------------------- what is kept, and how long


def test_what_a_mesh_has_is_made_once_and_goes_with_it():
    gc.collect()
    mesh, units = grid(), (TextureUnit("t"),)
    first = process(mesh, PassState(texture_units=units), GEFORCE_256, 8, 8)
    second = process(mesh, PassState(texture_units=(*units, None)), GEFORCE_256, 8, 8)
    assert second.triangles is first.triangles
    assert second.colors is first.colors
    assert second.x is not first.x
    assert mesh in plan._of_mesh
    count = len(plan._of_mesh)
    del mesh
    gc.collect()
    assert len(plan._of_mesh) == count - 1


def test_plans_of_states_that_come_and_go_are_forgotten():
    mesh = grid()
    for k in range(200):
        state = PassState(vertex=VertexState(modelview=((1.0, 0.0, 0.0, k / 1000), *IDENTITY[1:])))
        assert both(mesh, state)
    assert len(plan.mesh_columns(mesh).plans) <= 32


def test_each_machine_and_framebuffer_has_its_own_plan():
    mesh, state = grid(), PassState()
    other = GEFORCE_256.changed(subpixel_bits=5)
    for _ in range(2):
        for size in (64, 32), (32, 64), (64, 64):
            for profile in (GEFORCE_256, other):
                assert both(mesh, state, profile, *size)


def test_states_share_a_plan_unless_they_differ_in_what_it_follows_from():
    mesh, state = grid(), PassState(texture_units=(TextureUnit("t", matrix=TURNED),))
    plans = plan.mesh_columns(mesh).plans
    for k in range(3):
        assert both(mesh, replace(state, scissor=Scissor(k, 0, 1, 1)))
    assert len(plans) == 1
    outlines = PolygonState(front_mode=PolygonMode.LINE, back_mode=PolygonMode.LINE)
    others = (
        ({"perspective_correction": False}, True),
        ({"fog": Fog()}, True),
        ({"polygon": PolygonState(provoking_vertex=ProvokingVertex.FIRST)}, True),
        ({"texture_units": (TextureUnit("t"),)}, True),
        ({"vertex": VertexState(TURNED, PERSPECTIVE)}, True),
        ({"depth_clamp": DepthClamp()}, False),
        ({"polygon": outlines}, False),
    )
    for number, (other, is_covered) in enumerate(others, 2):
        changed = replace(state, **other)
        got = process(mesh, changed, GEFORCE_256, WIDTH, HEIGHT)
        assert is_by_kernel(got) == is_covered
        assert len(plans) == number
        if is_covered:
            assert both(mesh, changed)


def test_threads_may_share_a_mesh():
    state = PassState(vertex=VertexState(TURNED, PERSPECTIVE), texture_units=(TextureUnit("t"),))
    expected = process_columns(torus(), state, GEFORCE_256, 64, 64)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        for _ in range(10):
            mesh = Mesh(
                torus().positions, indices=torus().indices, texture_coordinates=torus().texture_coordinates
            )
            with ThreadPoolExecutor(4) as pool:
                for got in pool.map(lambda _, m=mesh: process(m, state, GEFORCE_256, 64, 64), range(8)):
                    assert_equal(got, expected)
    finally:
        sys.setswitchinterval(interval)


# -------------------------------------------------------------------------------------- sorting into bands


def sorted_both_ways(primitives, state, width, height):
    """Each band's triangles as sorted in one pass and as sorted in two, and how many were dropped."""
    machine = Machine(GEFORCE_256, width, height)
    draw = pack(state, GEFORCE_256, machine.framebuffer, {}, primitives).draw
    results = []
    for known in (True, False):
        fresh = replace(primitives)
        fresh.knowing(orderly=known)
        order, ends, dropped = prepared_draw.sort_into_bands(fresh, draw, height)
        assert order.dtype == ends.dtype == np.int32
        results.append(([band.tolist() for band in np.split(order, ends)], ends.tolist(), dropped))
    return results


def window_triangles(points):
    n = len(points)
    return WindowPrimitives(
        x=np.ascontiguousarray(points[:, 0], np.int32),
        y=np.ascontiguousarray(points[:, 1], np.int32),
        z=np.zeros(n),
        inverse_w=np.ones(n),
        colors=np.zeros((n, 2, 8), np.uint8),
        coordinates=np.zeros((n, 0, 4)),
        fog=np.zeros(n),
        triangles=np.random.default_rng(n).integers(0, n, (n, 4)).astype(np.int32),
        dropped=0,
        two_side=False,
    )


@settings(max_examples=150)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([3, 40, 300, 1000]),
    st.sampled_from([4, 30, 400, 20000, 2**29]),
    st.sampled_from([None, *Face]),
    st.sampled_from([None, Scissor(0, 0, 0, 9), Scissor(5, 40, 50, 33), Scissor(-9, -9, 500, 500)]),
    st.sampled_from([1, 31, 33, 100, 600]),
)
def test_one_pass_sorts_as_two(seed, n, reach, cull, scissor, height):
    random = np.random.default_rng(seed)
    centers = random.integers(0, 16 * height, (n, 1))
    points = centers * (reach < 16 * height) + random.integers(-reach, reach, (n, 2))
    primitives = window_triangles(points)
    assert primitives.orderly
    state = PassState(polygon=PolygonState(cull_face=cull), scissor=scissor)
    fast, slow = sorted_both_ways(primitives, state, 64, height)
    assert fast == slow


def test_triangles_that_touch_every_band_are_sorted_too():
    primitives = window_triangles(np.array([(0, 0), (1000, 0), (0, 16 * 900), (1000, 16 * 900)] * 20))
    fast, slow = sorted_both_ways(primitives, PassState(), 64, 900)
    assert fast == slow
    assert (
        sum(map(len, fast[0])) > 2 * len(primitives.triangles) + 4 * 29
    )  # more than is allowed for at first


UNUSABLE = {
    "a negative index": lambda p: replace(p, triangles=p.triangles - 1),
    "an index too large": lambda p: replace(p, triangles=p.triangles + 1),
    "1/w 0": lambda p: replace(p, inverse_w=p.inverse_w * 0),
    "1/w too large": lambda p: replace(p, inverse_w=p.inverse_w * 2.0**401),
    "1/w not a number": lambda p: replace(p, inverse_w=p.inverse_w * np.nan),
    "positions too far apart": lambda p: replace(p, x=p.x - np.int32(2**30)),
    "positions too far down": lambda p: replace(p, y=p.y + np.int32(2**30)),
}


@pytest.mark.parametrize("name", UNUSABLE)
def test_what_is_not_orderly_is_never_sorted_in_one_pass(name):
    primitives = window_triangles(np.array([(0, 0), (64, 0), (0, 64), (64, 64)] * 10))
    primitives.triangles[:10] = np.arange(40).reshape(10, 4)
    known = replace(primitives).knowing(orderly=True, constant_color=True)
    assert not UNUSABLE[name](known).orderly
    assert primitives.orderly
    primitives.triangles[0, 3] = 40
    assert not primitives.orderly


def test_what_is_known_is_forgotten_with_the_columns_it_was_known_of():
    primitives = window_triangles(np.array([(0, 0), (64, 0), (0, 64)] * 30))
    assert primitives.constant_color
    colors = primitives.colors.copy()
    colors[-1, 1, 7] = 1
    assert not replace(primitives, colors=colors).constant_color
    coordinates = np.ones((90, 2, 4))
    coordinates[-1, 1, 3] = np.nan
    assert replace(primitives, coordinates=coordinates).projective == (False, True)


def test_depths_become_single_as_numpy_rounds_them():
    random = np.random.default_rng(4)
    patterns = random.integers(-(2**63), 2**63, 20000).view(np.float64)
    near = np.array([0.0, -0.0, 2.0**-126, 2.0**-127, 3.4028235e38, np.inf, -np.inf, np.nan, 1.0])
    depths = np.concatenate([patterns, near, -near, np.nextafter(near, 0), random.random(20000)])
    largest = float(np.finfo(np.float32).max)
    for scale in (1.0, 65535.0, 16777215.0):
        got = np.empty(len(depths))
        single_depths(depths, scale, got)
        with np.errstate(all="ignore"):
            single = np.fmin(np.fmax(depths * scale, -largest), largest).astype(np.float32).astype(float)
        expected = np.where(np.abs(single) < 2.0**-126, 0.0, single)
        np.testing.assert_array_equal(got.view(np.int64), expected.view(np.int64))
