"""What is kept from state to state: it is what is found anew, and what is not looked at is right."""

from dataclasses import MISSING, fields, is_dataclass, replace
from itertools import product
from typing import get_args

import numpy as np
import pytest

from fixedpipe.pipeline import state as state_module
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import CombinerScale, ComponentUsage, Mapping, MuxSelect, Register, TexGenMode
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.native import pack_combiners
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.programs import combiner_rules
from fixedpipe.pipeline.state import (
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    PassState,
    RegisterCombiners,
    RGBPortion,
    TexGen,
    TextureUnit,
    VertexState,
    Viewport,
)
from fixedpipe.pipeline.validation.validate import _CHECKS
from fixedpipe.pipeline.validation.walk import UnsupportedState
from fixedpipe.pipeline.vertices import plan

CLASSES = [kind for kind in vars(state_module).values() if isinstance(kind, type) and is_dataclass(kind)]


@pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.__name__)
def test_what_a_field_is_by_default_is_right(kind):
    for field in fields(kind):
        if field.default is not MISSING and (field.default is not None or type(None) in get_args(field.type)):
            assert _CHECKS[field.type](field.default) is None, field.name


def test_a_value_that_equals_the_default_and_has_another_type_is_refused():
    draw = Draw(label="d", mesh=Mesh(np.zeros((3, 2))), state=PassState(color_sum=0))
    with pytest.raises(UnsupportedState, match="color_sum is 0; it is a switch"):
        Machine(NV2A, 4, 4).run((draw,))


# ------------------------------------------------------------------------------------- combiner programs

INPUTS = [
    CombinerInput(Register.TEXTURE1),
    CombinerInput(Register.TEXTURE0, mapping=Mapping.EXPAND_NORMAL, usage=ComponentUsage.ALPHA),
    CombinerInput(Register.DISCARD),
    CombinerInput(Register.E_TIMES_F, mapping=Mapping.UNSIGNED_INVERT),
]
PORTIONS = [
    RGBPortion(a=INPUTS[0], b=INPUTS[1], sum_output=Register.SPARE0),
    RGBPortion(a=INPUTS[2], ab_output=Register.FOG, scale=CombinerScale.SCALE_BY_TWO),
    RGBPortion(a=INPUTS[1], c=INPUTS[0], mux_sum=True, ab_output=Register.TEXTURE2),
]
GENERAL = [
    (GeneralCombiner(rgb=rgb, alpha=alpha), GeneralCombiner())[:count]
    for rgb, alpha, count in product(PORTIONS, PORTIONS, (1, 2))
]
FINAL = [FinalCombiner(a=INPUTS[0]), FinalCombiner(b=INPUTS[3], g=INPUTS[1]), FinalCombiner(e=INPUTS[2])]


@pytest.mark.parametrize(
    "find", [combiner_rules.combiner_problems, combiner_rules.registers_named, combiner_rules.textures_read]
)
def test_what_is_kept_for_stages_is_what_is_found_anew(find):
    found = set()
    for general, final in product(GENERAL, FINAL):
        program = RegisterCombiners(general=general, final=final)
        again = replace(program, constant_color0=(0.5, 0.0, 0.0, 1.0))
        assert find(program) == find(again) == find.__wrapped__(again)
        found.add(find(program))
    assert len(found) > 3


def test_kept_rows_of_stages_are_those_that_are_packed_anew():
    kept, found = pack_combiners._stage_rows, set()
    for general, final, half, select in product(GENERAL, FINAL, (128, 127.5), MuxSelect):
        program = RegisterCombiners(general=general, final=final, mux_select=select)
        for _ in range(2):
            rows, anew = kept(program, half, select, 8), kept.__wrapped__(program, half, select, 8)
            assert [a.tolist() for a in rows[:2]] == [a.tolist() for a in anew[:2]]
            assert rows[2:] == anew[2:]
        found.add(str([a.tolist() for a in rows[:2]]))
    assert len(found) > len(GENERAL) * len(FINAL)


def test_what_is_kept_goes_when_there_is_too_much_of_it(monkeypatch):
    monkeypatch.setattr(combiner_rules, "_MOST_KEPT", 3)
    looked_at = []
    find = combiner_rules.kept_for_stages(lambda program: looked_at.append(program) or program.general)
    programs = [RegisterCombiners(general=general) for general in GENERAL[:4]]
    for program in (*programs[:3], *programs[:3], programs[3], programs[0]):
        assert find(program) is program.general
    assert looked_at == [*programs, programs[0]]


# ------------------------------------------------------------------------------------------ vertex plans

MATRIX = ((1.0, 0.5, 0.0, 0.0), (0.0, 1.0, 0.0, 0.25), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
PLANE = TexGen(TexGenMode.EYE_LINEAR, (1.0, 2.0, 3.0, 4.0))
STATES = [
    PassState(),
    PassState(vertex=VertexState(modelview=MATRIX, viewport=Viewport(0, 0, 8, 8))),
    PassState(texture_units=(TextureUnit("t", matrix=MATRIX),)),
    PassState(texture_units=(TextureUnit("t"), TextureUnit("t", coordinates=1, matrix=MATRIX))),
    PassState(texture_units=(TextureUnit("t", gen=(PLANE, TexGen(), TexGen(), TexGen())),)),
    PassState(texture_units=(TextureUnit("t", coordinates=0, matrix=MATRIX), None, TextureUnit("t"))),
]


WIDTHS = ((), (2,), (4,), (2, 3))


def test_a_formula_that_another_mesh_left_is_the_one_that_is_made_anew():
    random = np.random.default_rng(3)
    seen = set()
    for state, components, widths in [*product(STATES, (2, 3, 4), WIDTHS)] * 2:
        sets = tuple(random.random((3, width)) for width in widths)
        mesh = Mesh(random.random((3, components)), texture_coordinates=sets)
        found = plan.plan_of(mesh, plan.mesh_columns(mesh), state, NV2A, 8, 8)
        anew = plan._formula((components, *widths), state, state.texture_units, NV2A, 8, 8)
        for name in ("sums", "coefficients", "results", "parameters", "clip"):
            np.testing.assert_array_equal(getattr(found, name), getattr(anew, name), err_msg=name)
        for name in ("rows", "units", "keeps_eye"):
            assert getattr(found, name) == getattr(anew, name), name
        assert len(found.given) == components + sum(widths[number] for number in anew.sets)
        seen.add(found.results.tobytes())
    assert len(seen) > len(STATES)
