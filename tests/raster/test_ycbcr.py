"""Y, Cb and Cr become RGB after the texture units: kernel, columns and a pass against the specification."""

import numpy as np
import pytest

from fixedpipe.pipeline.columns.combiners import ycbcr_converted
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import Register, TextureFilter, TextureShaderOperation
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import (
    CombinerInput,
    FinalCombiner,
    PassState,
    RegisterCombiners,
    Sampler,
    TextureShaderStage,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.raster.portable.unit import convert_ycbcr
from tests.reference import texel_words

PLANE = 4  # where a register lies among others, which stay


def every_pair():
    """int16 [4, k]: every Y with every Cb and Cr of the ends and of a step of 5, and what is below 0."""
    some = np.unique([0, 1, 127, 128, 129, 254, 255, *range(0, 256, 5)])
    y, cb, cr = (g.ravel() for g in np.meshgrid(np.arange(-3, 256), some, some))
    below = np.array([[-255, -1, 0], [128, -7, 300 - 256], [90, 3, -200]])
    return np.concatenate([np.stack([y, cb, cr, y]), np.stack([*below, below[0]])], axis=1).astype(np.int16)


def test_the_kernel_and_the_columns_give_what_the_specification_has():
    given = every_pair()
    registers = np.concatenate([given + 1, given, given + 2])
    convert_ycbcr(registers, PLANE, given.shape[1])
    assert (registers[:4] == given + 1).all() and (registers[8:] == given + 2).all()
    found = registers[PLANE : PLANE + 4]
    assert (found == ycbcr_converted(given.astype(np.int64))).all()
    for at in range(0, given.shape[1], 7):
        texel = [max(int(component), 0) for component in given[:3, at]]
        expected = [*texel_words.texel_of_ycbcr(*texel)[:3], given[3, at]]
        assert found[:, at].tolist() == expected


@pytest.mark.parametrize("engine", ["portable", "columns"])
def test_a_stage_reads_what_the_combiners_see_converted(engine):
    """Stage 1 reads stage 0's red as it is, 60: so row 60 of the ramp, whose red is 60 as well."""
    ramp = np.zeros((256, 256, 3), np.uint8)
    ramp[..., 0], ramp[..., 1:] = np.arange(256)[:, None], (90, 200)
    nearest = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)
    units = TextureUnit("y", sampler=nearest), TextureUnit("ramp", sampler=nearest)
    stages = (
        TextureShaderStage(TextureShaderOperation.TEXTURE_2D),
        TextureShaderStage(TextureShaderOperation.DEPENDENT_AR_TEXTURE_2D, previous_texture_input=0),
    )
    seen = []
    for register in (Register.TEXTURE0, Register.TEXTURE1):
        final = FinalCombiner(a=CombinerInput(Register.ZERO), d=CombinerInput(register))
        state = PassState(
            texture_units=units,
            texture_shader=stages,
            register_combiners=RegisterCombiners(final=final),
            ycbcr_conversion=True,
        )
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, -1), (1, 1), (-1, 1)], float)
        mesh = Mesh(corners, texture_coordinates=(corners, corners))
        commands = (
            TexImage(label="y", texture="y", image=texture_2d(np.full((1, 1, 3), (60, 90, 200), np.uint8))),
            TexImage(label="ramp", texture="ramp", image=texture_2d(ramp)),
            Draw(label="square", mesh=mesh, state=state),
        )
        seen.append(execute(commands, NV2A, 2, 2, engine=engine).framebuffer.color[0, 0, :3].tolist())
    converted = texel_words.texel_of_ycbcr(60, 90, 200)[:3]
    assert seen == [converted, converted]
