"""Kernels given rows and columns that no state packs to stay inside their arrays."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, TextureFilter, VertexStage
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import DepthTest, PassState, Sampler, TextureUnit, VertexState
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import Segments
from fixedpipe.raster.portable.arrays import FogFactors
from fixedpipe.raster.portable.interpolate import iterate_fog_table
from tests import fuzz
from tests.hostile import Arrays, draws_of
from tests.support.processes import output_of
from tests.support.random_frames import Frame, random_frame
from tests.support.strategies import SHOW_TEXTURE


def run(frames, **environment):
    """The line that ``python -m tests.hostile`` prints; a crash would end that process, not this one."""
    return output_of("tests.hostile", "--frames", frames, **environment)


def test_spoilt_rows_crash_nothing():
    assert "no crash" in run(25)


@pytest.mark.slow
def test_spoilt_rows_lead_no_kernel_outside_its_arrays(tmp_path):
    assert "no crash" in run(150, NUMBA_BOUNDSCHECK="1", NUMBA_CACHE_DIR=str(tmp_path))


def one_draw():
    """Arrays of a textured Draw with combiners, and a framebuffer, of the first frame that has one."""
    for seed in range(200):
        for arrays, target in draws_of(random_frame(seed)):
            row = arrays["units"][0]
            plain = arrays["draw"][R.UNITS] and row[R.ENABLED] and row[R.TARGET] == 1
            if plain and arrays["draw"][R.STAGES] and arrays.draw(target) == (True, True):
                return arrays, target
    raise AssertionError


@pytest.mark.parametrize(
    ("name", "place", "value"),
    [
        ("draw", R.X0, -1),
        ("draw", R.X1, 1 << 40),
        ("draw", R.Y1, -(1 << 63)),
        ("draw", R.UNITS, 5),
        ("draw", R.STAGES, 9),
        ("draw", R.STROKES, 1),
        ("units", (0, R.LEVELS), 99),
        ("units", (0, R.ANISOTROPY), int(np.float64(1e300).view(np.int64))),
        ("units", (0, R.OPERATION), 19),
        ("units", (0, R.TARGET), 2),
        ("levels", (0, 0, 0), -1),
        ("levels", (0, 0, 1), 1 << 30),
        ("program", (0, 0, 0), 14),
        ("program", (0, 1, R.SUM_OUTPUT), 99),
        ("final", (6, 1), 3),
    ],
)
def test_rows_that_lead_outside_are_refused(name, place, value):
    arrays, target = one_draw()
    spoilt = arrays[name].copy()
    spoilt[place] = value
    assert not Arrays(arrays, **{name: spoilt}).draw(target)[0]


@pytest.mark.parametrize(
    ("name", "place", "value"),
    [
        ("plan", (0, 0), 11),
        ("plan", (0, 1), -1),
        ("plan", (0, 9), 1 << 20),
        ("pair_levels", (0, 0, 0), 1 << 30),
    ],
)
def test_jobs_that_lead_outside_are_refused(name, place, value):
    arrays, target = one_draw()
    spoilt = arrays[name].copy()
    spoilt[place] = value
    assert not Arrays(arrays, **{name: spoilt}).draw(target)[1]


def test_fog_coordinates_that_are_no_numbers_read_the_first_entry_of_the_table():
    out = np.full((1, 1), -1, np.int16)
    zero, triangles = np.zeros(1, np.int32), np.zeros((1, 4), np.int32)
    segments = Segments(np.array([0, 1], np.int32), zero, zero, 1)
    for coordinate in (np.nan, -np.inf, np.inf):  # the last two differ by what is no number
        table, fog = np.arange(8193.0), np.full(1, coordinate)
        floats = np.zeros((R.FLOAT_COLUMNS, 1))
        iterate_fog_table(segments, triangles, FogFactors(fog, table), floats, out, 0)
        assert out[0, 0] == 0


def test_long_lists_of_indices_narrow_textures_and_far_numbers():
    random = np.random.default_rng(0)
    filters = [
        Sampler(f, TextureFilter.LINEAR) for f in (TextureFilter.LINEAR, TextureFilter.LINEAR_MIPMAP_LINEAR)
    ]
    for size, sampler in zip(((1, 4096), (4096, 1)), filters, strict=True):
        image = texture_2d(random.integers(0, 256, (*size, 4), np.uint8), mipmaps=True)
        sets = random.choice([0.5, -3.0, 1e6, -1e38, 1e38], (40, 4))
        sets[:, 3] = 1.0
        corners = random.uniform(-5, 30, (40, 2))
        corners[::13] = random.choice([1e38, -1e38], (4, 2))
        mesh = Mesh(
            np.column_stack([corners, random.uniform(0, 2.0**24, 40), random.uniform(0.5, 2.0, 40)]),
            PrimitiveType.TRIANGLE_STRIP,
            indices=random.integers(0, 40, 4096),
            texture_coordinates=(sets,),
        )
        state = PassState(
            vertex=VertexState(stage=VertexStage.PROGRAM_RESULTS),
            texture_units=(TextureUnit("long", sampler),),
            register_combiners=SHOW_TEXTURE,
            depth_test=DepthTest(),
        )
        commands = (
            TexImage(label="long", texture="long", image=image),
            Draw(label="many", mesh=mesh, state=state),
        )
        frame = Frame(0, NV2A, 12, 5, 24, commands, small=True)
        fuzz.compare(frame, (fuzz.Way(), fuzz.Way("portable"), fuzz.Way(reference=True)))
