"""What docs/program-instructions.md says of every construct, evaluated beside the machines."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import ComponentUsage, Mapping, Register, TextureFilter
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.register_combiner_words import ONE_INPUTS, UNUSED_ALPHA, UNUSED_RGB
from fixedpipe.pipeline.state import (
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    PassState,
    Sampler,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.validation.validate import validate_program
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.support.instructions import COMBINERS, GROUPS, evaluated, numbers_of

# Every byte for the machine that was measured; for others, which compute by the same code, bytes near the
# ends, around one half and between.
_ALL = np.arange(256)
_SOME = np.array([*range(0, 256, 5), 1, 2, 64, 126, 127, 128, 129, 192, 253, 254, 31, 77])
MEASURED = "NV2A"
_COLORS = np.array([40, 128, 255, 129]), np.array([10, 128, 255, 0])


def texels_of(machine):
    """Texels of two textures, [h, w, 4] each: odd multiples of bytes, so that each component has every pair
    of them, and no two components the same pair at one pixel.
    """
    values = _ALL if machine == COMBINERS[MEASURED] else _SOME
    across = np.stack([m * values + k for m, k in ((1, 0), (7, 31), (13, 5), (29, 3))], -1) % 256
    upwards = np.stack([m * values + k for m, k in ((1, 0), (11, 77), (3, 200), (37, 9))], -1) % 256
    shape = len(values), len(values), 4
    return np.broadcast_to(across, shape), np.broadcast_to(upwards[:, None], shape)


def drawn(combiners, machine):
    """The picture of a machine, as ``texels_of``: bytes, or the ideal's numbers, of which 255 are one."""
    names, texels = ("t0", "t1"), texels_of(machine)
    nearest = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)
    mesh = Mesh(
        np.array([[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]]),
        colors=np.tile(_COLORS[0] / 255, (3, 1)),
        secondary_colors=np.tile(_COLORS[1] / 255, (3, 1)),
        texture_coordinates=(np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]]),) * 2,
    )
    state = PassState(
        texture_units=tuple(TextureUnit(name, nearest) for name in names), register_combiners=combiners
    )
    commands = (
        Clear(label="clear", color=(0.0, 0.0, 0.0, 0.0)),
        *(
            TexImage(label=name, texture=name, image=texture_2d(image.astype(np.uint8)))
            for name, image in zip(names, texels, strict=True)
        ),
        Draw(label="all pairs", mesh=mesh, state=state),
    )
    size = len(texels[0])
    # The uppermost row comes first in a frame, and the lowest in a texture.
    if machine.arithmetic.exact:
        return 255 * execute_ideal(commands, size, size).color[::-1]
    return execute(commands, machine, size, size).framebuffer.color[::-1].astype(np.int64)


def value_of(row, machine):
    """What a row's formula says of ``texels_of`` in the machine's units."""
    numbers = numbers_of(machine)
    unit = numbers.one // 255
    a, b = (texels.astype(np.int64) * unit for texels in texels_of(machine))
    c, d = (np.broadcast_to(color * unit, a.shape) for color in _COLORS)
    operands = {"a": a, "b": b, "c": c, "d": d, "x": a - b}
    value = np.broadcast_to(evaluated(row.formula, numbers, **operands), a.shape)
    if row.alpha is None:
        return value
    alpha = np.broadcast_to(evaluated(row.alpha, numbers, **operands), a.shape)
    return np.concatenate([value[..., :3], alpha[..., 3:]], axis=-1)


def shown(value, numbers):
    """A register's value as the color that is written."""
    return evaluated("written(x)", numbers, x=value)


def negated(combiners):
    """The combiners with one more, which negates SPARE0."""
    given = CombinerInput(Register.SPARE0, Mapping.SIGNED_NEGATE)
    alpha = replace(given, usage=ComponentUsage.ALPHA)
    stage = GeneralCombiner(
        rgb=replace(UNUSED_RGB, a=given, b=ONE_INPUTS[ComponentUsage.RGB], ab_output=Register.SPARE0),
        alpha=replace(UNUSED_ALPHA, a=alpha, b=ONE_INPUTS[ComponentUsage.ALPHA], ab_output=Register.SPARE0),
    )
    final = FinalCombiner(
        a=CombinerInput(),
        b=CombinerInput(),
        c=CombinerInput(),
        d=CombinerInput(Register.SPARE0),
        g=CombinerInput(Register.SPARE0, usage=ComponentUsage.ALPHA),
    )
    return replace(combiners, general=(*combiners.general, stage), final=final)


def fits(combiners, machine):
    try:
        validate_program(None, combiners, machine)
    except UnsupportedState:
        return False
    return True


@pytest.mark.parametrize("machine", COMBINERS)
@pytest.mark.parametrize("group", GROUPS)
def test_a_formula_is_what_the_machine_computes(group, machine):
    profile = COMBINERS[machine]
    numbers = numbers_of(profile)
    for row in GROUPS[group].rows:
        own = profile.combiners.per_stage_constants
        combiners = parse_program(GROUPS[group].program(row), per_stage_constants=own).combiners
        if not fits(combiners, profile):
            continue
        value = value_of(row, profile)
        np.testing.assert_allclose(
            drawn(combiners, profile), shown(value, numbers), rtol=0, atol=1e-9, err_msg=row.construct
        )
        below = negated(combiners)
        if not row.shown and value.min() < 0 and fits(below, profile):
            np.testing.assert_allclose(
                drawn(below, profile),
                shown(-value, numbers),
                rtol=0,
                atol=1e-9,
                err_msg=f"-({row.construct})",
            )
