"""A Draw by one kernel call has the arrays of the Draw that the vertex stage and later steps make in turn."""

import ctypes
import gc
import math
import weakref
from dataclasses import replace

import numpy as np
import pytest
from numba import types

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import ComparisonFunction, Register, TexGenMode, TextureFilter
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.native import state_records
from fixedpipe.pipeline.native.prepared_draw import Prepared
from fixedpipe.pipeline.native.state_records import StateRecord, StateRecords
from fixedpipe.pipeline.native.state_rows import StateRows
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.state import (
    CombinerInput,
    DepthTest,
    FinalCombiner,
    GeneralCombiner,
    PassState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    TexGen,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.vertices import stage
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import BANDS
from fixedpipe.raster.vector.arrays import PASS
from tests.support.random_frames import random_frame

SIZE = 64


@pytest.fixture
def by_one_call(monkeypatch):
    """Compares each Draw that one call makes with the one that the steps make.

    A list: for each Draw, whether one call made it.
    """
    found, targets, of, submitted = [], {}, StateRecords.of, StateRecord.submitted

    def noted(records, mesh, state, framebuffer, textures):
        record = of(records, mesh, state, framebuffer, textures)
        targets[record] = framebuffer
        return record

    def compared(record, mesh):
        made = submitted(record, mesh)
        found.append(made is not None)
        if made is not None:
            state, target, profile = record.state, targets[record], record._profile
            primitives = stage.process(mesh, state, profile, target.width, target.height)
            assert_same(made, Prepared.of(primitives, state, profile, target, record.textures))
        return made

    monkeypatch.setattr(StateRecords, "of", noted)
    monkeypatch.setattr(StateRecord, "submitted", compared)
    return found


def arrays_of(job):
    """Every array that a job names, in order, from its addresses and shapes."""
    entries, found = iter(job[R.JOB_ARRAYS :].tolist()), []

    def read(kind):
        if not isinstance(kind, types.Array):
            for member in kind:
                read(member)
            return
        address, shape = next(entries), [next(entries) for _ in range(kind.ndim)]
        dtype = np.dtype(str(kind.dtype))
        memory = (ctypes.c_char * (dtype.itemsize * math.prod(shape))).from_address(address)
        found.append(np.frombuffer(memory, dtype).reshape(shape))

    read(BANDS)
    read(PASS)
    return found


def assert_same(made, by_steps):
    assert (made.dropped, made.bound, made.area) == (by_steps.dropped, by_steps.bound, by_steps.area)
    if not made.area:
        return
    by_steps.fill_job()
    np.testing.assert_array_equal(made.job[: R.JOB_ARRAYS], by_steps.job[: R.JOB_ARRAYS])
    for got, expected in zip(arrays_of(made.job), arrays_of(by_steps.job), strict=True):
        np.testing.assert_array_equal(got, expected)


def test_of_random_frames(by_one_call):
    for seed in range(150):
        frame = random_frame(seed)
        Machine(frame.profile, frame.width, frame.height, frame.depth_bits).run(frame.commands)
    assert sum(by_one_call) > 50


def test_a_job_s_plan_lives_as_long_as_its_draw(monkeypatch):
    """A job names arrays by their addresses. Rows that several threads share may get another equal plan."""
    find, fill, plans, drawn = StateRows.filled_plan, Prepared.fill_job, [], []

    def replaced(rows, draw, units, derived):
        plans.append(weakref.ref(plan := find(rows, draw, units, derived)))
        del derived["rows"]
        return plan

    def filled(draw):
        fill(draw)
        if draw.job is not False:
            drawn.append((draw, plans[-1]))

    monkeypatch.setattr(StateRows, "filled_plan", replaced)
    monkeypatch.setattr(Prepared, "fill_job", filled)
    for seed in range(100):
        frame = random_frame(seed)
        Machine(frame.profile, frame.width, frame.height, frame.depth_bits).run(frame.commands)
    assert len(drawn) > 20
    assert all(plan() is not None for _, plan in drawn)


# --------------------------------------------------------------------------------------- chosen Draws

TEXELS = np.arange(256, dtype=np.uint8).reshape(8, 8, 4)
LOAD = TexImage(label="t", texture="t", image=texture_2d(TEXELS))
UNIT = TextureUnit("t", Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR))
DOUBLED = ((2.0, 0.0, 0.0, 0.0), (0.0, 2.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
PROJECTED = (*DOUBLED[:3], (0.0, 1.0, 0.0, 1.0))
NEARER = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, -0.5), (0.0, 0.0, 0.9, 0.6))
LINEAR = TexGen(TexGenMode.OBJECT_LINEAR, (0.5, 0.25, 0.0, 0.5))
STATES = {
    "no unit": (),
    "as given": (UNIT,),
    "the second alone": (None, UNIT),
    "by a matrix": (replace(UNIT, matrix=DOUBLED),),
    "q varies": (replace(UNIT, matrix=PROJECTED), UNIT),
    "generated": (replace(UNIT, gen=(LINEAR, LINEAR, TexGen(), TexGen())),),
}


def triangles(count, seed=0, sets=2, reach=0.9):
    random = np.random.default_rng(seed)
    positions = random.uniform(-reach, reach, (3 * count, 3))
    coordinates = tuple(random.uniform(0, 1, (3 * count, 2)) for _ in range(sets))
    return Mesh(positions, colors=random.uniform(0, 1, (3 * count, 4)), texture_coordinates=coordinates)


def drawn(*draws):
    machine = Machine(GEFORCE_256, SIZE, SIZE)
    machine.run((LOAD, *draws))
    return machine.framebuffer.color


@pytest.mark.parametrize("units", STATES.values(), ids=STATES)
def test_ways_to_coordinates(by_one_call, units):
    state = PassState(texture_units=units)
    draws = [Draw(label="d", mesh=triangles(n, n), state=state) for n in (1, 2, 200)]
    drawn(*draws)
    assert by_one_call == [True] * 3


def test_q_that_varies_in_one_mesh_alone(by_one_call):
    # The unit's row differs, so one call finds that its template is another mesh's.
    state = PassState(texture_units=(replace(UNIT, matrix=PROJECTED),))
    flat = triangles(5, 5)
    flat = Mesh(flat.positions, texture_coordinates=(flat.texture_coordinates[0] * (1, 0),))
    meshes = triangles(5), flat, triangles(6), flat
    drawn(*[Draw(label="d", mesh=mesh, state=state) for mesh in meshes])
    assert by_one_call == [True] * 4


def test_more_triangles_in_a_band_than_there_is_room_for_at_first(by_one_call):
    tall = np.tile([[-0.9, -0.9, 0.0], [0.9, -0.9, 0.0], [0.0, 0.9, 0.0]], (300, 1))
    drawn(Draw(label="d", mesh=Mesh(tall), state=PassState()))
    assert by_one_call == [True]


@pytest.mark.parametrize("units", STATES.values(), ids=STATES)
def test_clipped_meshes(by_one_call, units):
    state = PassState(texture_units=units, depth_test=DepthTest(ComparisonFunction.LEQUAL))
    near = VertexState(projection=NEARER)
    draws = [Draw(label="d", mesh=triangles(n, n, reach=40.0), state=state) for n in (1, 2, 90)]
    draws += [replace(draw, state=replace(state, vertex=near)) for draw in draws]
    drawn(*draws)
    assert by_one_call == [True] * 6


def test_a_mesh_that_is_clipped_away_or_has_no_usable_position(by_one_call):
    behind = Mesh(np.array([[0.0, 0.0, -3.0], [0.5, 0.0, -3.0], [0.0, 0.5, -3.0]]))
    huge = Mesh(np.array([[0.0, 0.0, 0.0], [1e308, 0.0, 0.0], [0.0, 1e308, 0.0]]))
    far = VertexState(projection=NEARER, modelview=DOUBLED)
    for mesh in (behind, huge):
        drawn(Draw(label="d", mesh=mesh, state=PassState(vertex=far)))
    assert len(by_one_call) == 2


@pytest.mark.parametrize("moved", [False, True], ids=["the same state", "a state of its kind"])
def test_a_texture_that_is_replaced_is_read_by_later_draws_alone(by_one_call, moved):
    draw = Draw(label="d", mesh=triangles(3), state=PassState(texture_units=(UNIT,)))
    other = replace(LOAD, image=texture_2d(255 - TEXELS))
    later = replace(draw, state=replace(draw.state, vertex=VertexState(modelview=DOUBLED))) if moved else draw
    commands = LOAD, draw, other, later
    before, found = drawn(draw, later), execute(commands, GEFORCE_256, SIZE, SIZE).framebuffer.color
    expected = execute(commands, GEFORCE_256, SIZE, SIZE, engine="portable").framebuffer.color
    np.testing.assert_array_equal(found, expected)
    assert (before != found).any()
    assert by_one_call == [True] * len(by_one_call)


NOTHING = CombinerInput()
PRODUCT = RGBPortion(
    CombinerInput(Register.CONSTANT_COLOR0),
    CombinerInput(Register.PRIMARY_COLOR),
    ab_output=Register.SPARE0,
    sum_output=Register.DISCARD,
)
FINAL = FinalCombiner(NOTHING, NOTHING, NOTHING, CombinerInput(Register.SPARE0))


def test_constant_colors_that_alternate_in_new_states(by_one_call):
    # Each record follows from the one before, whose plan has the other colour.
    colors = [(0.25, 0.5, 0.75, 1.0), (1.0, 0.0, 0.5, 1.0)]
    program = RegisterCombiners((GeneralCombiner(PRODUCT),), FINAL, constant_color0=colors[0])
    first = PassState(register_combiners=program)
    states = [
        replace(first, register_combiners=replace(program, constant_color0=colors[k % 2])) for k in range(6)
    ]
    states += [replace(first, vertex=VertexState(modelview=DOUBLED)), first]
    machine, mesh = Machine(GEFORCE_256, SIZE, SIZE), triangles(3)
    for state in states:
        commands = Clear(label="c", color=(0.0,) * 4), Draw(label="d", mesh=mesh, state=state)
        machine.run(commands)
        expected = execute(commands, GEFORCE_256, SIZE, SIZE, engine="portable").framebuffer.color
        np.testing.assert_array_equal(machine.framebuffer.color, expected)
    assert by_one_call == [True] * len(states)


def test_records_are_bounded(monkeypatch):
    monkeypatch.setattr(state_records, "_MOST", 8)
    machine = Machine(GEFORCE_256, SIZE, SIZE)
    state = PassState(texture_units=(UNIT, replace(UNIT, texture="other")))
    for number in range(40):
        moved = replace(state, vertex=VertexState(modelview=DOUBLED))
        loads = LOAD, replace(LOAD, image=texture_2d(TEXELS + np.uint8(number)))
        other = replace(loads[number % 2], texture="other")
        machine.run((LOAD, other, Draw(label="d", mesh=triangles(2), state=moved)))
        records = machine._records
        assert len(records._of_state) <= 8
        assert all(len(readers) <= 2 * 8 for _, readers in records._readers.values())


def test_no_record_keeps_a_replaced_texture_in_memory():
    machine, states = Machine(GEFORCE_256, SIZE, SIZE), [PassState(texture_units=(UNIT,))]
    states.append(replace(states[0], vertex=VertexState(modelview=DOUBLED)))
    mesh = triangles(2)
    for number, state in enumerate(states):
        load = replace(LOAD, image=texture_2d(TEXELS + np.uint8(number)))
        machine.run((load, Draw(label="d", mesh=mesh, state=state)))
        if number == 0:
            first = weakref.ref(machine.textures["t"])
        del load
    gc.collect()
    assert first() is None
