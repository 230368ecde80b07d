"""Lambda by vectors has the bits of the portable kernel's."""

import numpy as np
import pytest

from fixedpipe.raster import rows
from fixedpipe.raster.arrays import Runs, State, Textures, Vertices
from fixedpipe.raster.portable.arrays import Combiners, Edges, FogFactors, Pass, Scratch
from fixedpipe.raster.portable.level_of_detail import level_of_detail as portable
from fixedpipe.raster.portable.sample import FAR, POWERS_OF_TWO, log2_q7
from fixedpipe.raster.vector.level_of_detail import NEAR, lambdas, level_of_detail, logarithms

BATCH, SLACK = 2048, 32
NO_LIMITS = {"MIN_LOD": -(1 << 21), "MAX_LOD": 1 << 21}


def unit_row(**entries):
    unit = np.zeros(rows.UNIT_SIZE, np.int64)
    for name, value in {"TARGET": 1, "LAYERS": 1, **NO_LIMITS, **entries}.items():
        unit[getattr(rows, name)] = value
    return unit


def lod_of(rho2):
    """LOD of two fragments for each squared scale factor, of which there are whole vectors."""
    logs, lod = np.zeros(rho2.size, np.int32), np.zeros(2 * rho2.size, np.int32)
    logarithms(rho2, rho2.size, logs, np.zeros_like(logs))
    lambdas(logs, 0, rho2.size, unit_row(), lod, 0, 0)
    return lod


def test_every_threshold_of_the_logarithm_is_met():
    mantissas = np.concatenate([POWERS_OF_TWO, 1 + np.arange(4096) / 4096])
    mantissas = np.concatenate([mantissas, np.nextafter(mantissas, 0), np.nextafter(mantissas, 2)])
    mantissas = np.concatenate([mantissas, 1 + np.random.default_rng(1).random(4096)])
    for scale in (1.0, 2.0**-40, 2.0**1000, 2.0**-1060):  # the last: subnormal numbers
        rho2 = mantissas * scale
        rho2 = np.concatenate([rho2, np.zeros(-rho2.size % 8 + 8)])
        lod = lod_of(rho2)
        expected = [log2_q7(value) if value else -FAR for value in rho2]
        assert (lod[::2] == expected).all() and (lod[1::2] == expected).all()


def test_no_threshold_but_one_lies_near_a_part_s_first_number():
    """So that a mantissa's own part tells whether a threshold is near; 1 is looked for by itself."""
    thresholds = np.array([int(power * 2**20) - 2**20 for power in POWERS_OF_TWO[1:]])
    beside = thresholds % 4096
    assert np.minimum(beside, 4096 - beside).min() > NEAR + 1


def test_the_smallest_number_of_lanes_holds_infinity_and_zero():
    rho2 = np.array([np.inf, 0.0, -0.0, 1.0, np.inf, 4.0, 0.25, np.inf])
    lod = lod_of(rho2)
    assert (lod[::2] == [FAR, -FAR, -FAR, 0, FAR, 256, -256, FAR]).all()


def random_runs(rng, triangles):
    """(starts, x, y, owner column) of a full batch's runs: mostly short ones, some long; often several in
    successive rows of one triangle, as if along its edges, or of its neighbour.
    """
    lengths, columns, lines, owners = [], [], [], []
    while sum(lengths) < BATCH:
        longest = rng.choice([1, 3, 16, 17, 64, 200, 1024])
        if lengths and rng.random() < 0.7:
            column, line = columns[-1] + rng.integers(-3, 4), lines[-1] + rng.choice([0, 1, 1, 1])
            length = max(lengths[-1] + rng.integers(-6, 7), 1)
            owner = owners[-1] if rng.random() < 0.7 else rng.integers(0, triangles)
        else:
            column, line = rng.integers(0, 1000, 2)
            length, owner = rng.integers(1, longest + 1), rng.integers(0, triangles)
        lengths.append(int(min(length, BATCH - sum(lengths))))
        columns.append(column), lines.append(line), owners.append(owner)
    owner = np.zeros(BATCH + SLACK, np.int32)
    owner[: len(owners)] = owners
    starts = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int32)
    return starts, np.array(columns, np.int32), np.array(lines, np.int32), owner


def random_scene(rng, kind):
    """(triangles, x, y, inverse_w, coordinates) of forty triangles."""
    corners = rng.integers(-3000, 20000, (2, 120)).astype(np.int32)
    if kind == "guard band":
        corners = rng.integers(-8192 * 16, 8192 * 16 + 1, (2, 120)).astype(np.int32)
    inverse_w = np.exp2(rng.uniform(-1, 1, 120))
    if kind == "affine":
        inverse_w[:] = 0.3
    coordinates = rng.uniform(-4, 4, (120, 2, 4))
    if kind == "hostile":
        special = [0.0, -0.0, 1e-310, 1e200, -1e300, np.inf, -np.inf, np.nan]
        coordinates = np.where(
            rng.random(coordinates.shape) < 0.1, rng.choice(special, coordinates.shape), coordinates
        )
        inverse_w = np.where(rng.random(120) < 0.1, rng.choice([0.0, 1e-300, 1e300, np.inf], 120), inverse_w)
    if kind == "exact":  # lambda on its thresholds
        corners = rng.integers(0, 64, (2, 120)).astype(np.int32) * 256
        inverse_w[:] = 1.0
        coordinates = rng.integers(-8, 9, (120, 2, 4)) / 8.0
    return np.arange(120, dtype=np.int32).reshape(40, 3), *corners.copy(), inverse_w, coordinates


def portable_lambda(runs, triangles, vertices, row, levels, ints):
    """The portable kernel's LOD into ``ints``, of unit 1."""
    draw, units = np.zeros(rows.DRAW_SIZE, np.int64), np.zeros((4, rows.UNIT_SIZE), np.int64)
    units[1], of_units = row, np.zeros((4, rows.MAX_LEVELS, 3), np.int32)
    of_units[1] = levels
    int16s, int32s, floats, words = (np.zeros((0, 0), t) for t in (np.int16, np.int32, np.float64, np.uint32))
    column = np.zeros(0)
    p = Pass(
        State(draw, column, int32s),
        Combiners(np.zeros((0, 0, 0), np.int32), int32s, int16s, np.zeros(0, np.int32)),
        triangles,
        int32s,
        vertices,
        np.zeros((0, 2, 8), np.int16),
        FogFactors(column, column),
        Textures((np.zeros(0, np.uint32),) * 4, of_units, units),
    )
    scratch = Scratch(
        edges=Edges(column, column, column),
        floats=floats,
        ints=ints,
        packed=words,
        registers=int16s,
        products=int32s,
        total=int32s,
        results=int16s,
        shaded=np.zeros(0, np.uint32),
        depth=np.zeros(0, np.int32),
        alive=np.zeros(0, np.uint8),
        lists=int32s,
        spans=np.zeros((0, 2), np.int64),
    )
    portable(p, 1, runs, scratch)


def assert_lambdas_agree(scene, spans, unit):
    """Both kernels' LOD of a batch's runs, which is returned."""
    (triangles, x, y, inverse_w, coordinates), (starts, run_x, run_y, owner) = scene, spans
    levels = np.zeros((rows.MAX_LEVELS, 3), np.int32)
    levels[0] = 0, 256, 64
    ints = np.full((2, rows.INT_COLUMNS, BATCH + SLACK), -9, np.int32)
    ints[:, rows.OWNER] = owner
    runs = Runs(starts, run_x, run_y, starts.size - 1)
    colors = np.zeros((len(x), 2, 8), np.uint8)
    vertices = Vertices(x, y, np.zeros(len(x)), inverse_w, colors, coordinates)
    portable_lambda(runs, triangles, vertices, unit, levels, ints[0])
    size = BATCH // 2 + 24
    room = np.full(size, 1 << 30, np.int32), np.full(size, 1 << 30, np.int32)
    level_of_detail(runs, triangles, vertices, 1, unit, levels, ints[1], room)
    assert (ints[0, :, : starts[-1]] == ints[1, :, : starts[-1]]).all()
    return ints[0, rows.LOD, : starts[-1]]


@pytest.mark.parametrize("target", [0, 1, 4])
@pytest.mark.parametrize("kind", ["ordinary", "affine", "exact", "guard band", "hostile"])
def test_every_fragment_has_the_lambda_of_the_portable_kernel(kind, target):
    rng = np.random.default_rng(5)
    for projective in (0, 1):
        for limits in (NO_LIMITS, {"MIN_LOD": -37, "MAX_LOD": 900, "LOD_BIAS": -21}):
            unit = unit_row(TARGET=target, LAYERS=16, PROJECTIVE=projective, **limits)
            scene = random_scene(rng, kind)
            lod = assert_lambdas_agree(scene, random_runs(rng, len(scene[0])), unit)
            if limits is NO_LIMITS and kind != "hostile":
                assert np.unique(lod).size > 4


def seen_from_inside(rng, kind):
    """A triangle around the pixels (0, 0) to (600, 600), whose coordinates give many lambdas."""
    corners = np.array([(-900, -700), (2600, -800), (100, 2900)]) + rng.integers(-99, 99, (3, 2))
    x, y = (16 * corners.T + rng.integers(0, 16, (2, 3))).astype(np.int32)
    inverse_w = np.exp2(rng.uniform(-2, 2, 3))
    coordinates = rng.uniform(-1, 1, (3, 2, 4)) * 10.0 ** rng.uniform(-2, 2)
    if kind == "horizon":  # through infinity: weights without bounds, where edge functions' sum is small
        inverse_w[rng.integers(3)] *= -rng.uniform(0.5, 1)
    if kind == "far away":  # rounded, as they are iterated, to more than a pixel's step
        coordinates = 2.0 ** rng.integers(38, 50) + rng.uniform(-1, 1, coordinates.shape)
    return np.array([[0, 1, 2]], np.int32), x, y, inverse_w, coordinates


@pytest.mark.parametrize("kind", ["floor", "horizon", "far away"])
def test_rows_of_a_triangle_have_the_lambda_of_the_portable_kernel(kind):
    found = set()
    for seed in range(150):
        rng = np.random.default_rng(seed)
        lengths = rng.integers(1, 600, 3)
        starts = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int32)
        places = rng.integers(0, 600, (2, 3)).astype(np.int32)
        spans = starts, *places, np.zeros(BATCH + SLACK, np.int32)
        lod = assert_lambdas_agree(seen_from_inside(rng, kind), spans, unit_row())
        found.update(lod.tolist())
    assert len(found) > (1000 if kind != "far away" else 20)


@pytest.mark.parametrize("k", [-299, -297, -150, 0, 150, 250])
@pytest.mark.parametrize("scale", [1.0, 2.0**-126, 2.0**-300, 2.0**-525, 2.0**120])
def test_numbers_near_the_ends_of_float64_have_the_lambda_of_the_portable_kernel(k, scale):
    x, y = (16 * np.array([(-900, 2600, 100), (-700, -800, 2900)])).astype(np.int32)
    coordinates = np.zeros((3, 2, 4))
    coordinates[:, :, 0], coordinates[:, :, 1] = [[2.1], [0.0], [0.9]], [[1.0], [0.0], [4.5]]
    scene = np.array([[0, 1, 2]], np.int32), x, y, np.array([1.0, 1.3, 0.8]) * 2.0**k, coordinates * scale
    for row in (10, 200, 400):
        spans = (np.array(part, np.int32) for part in ([0, 500], [10], [row]))
        assert_lambdas_agree(scene, (*spans, np.zeros(BATCH + SLACK, np.int32)), unit_row())
