"""Combiner: register combiners of constants and flat colours.

Source: src/tests/combiner_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from effects.conformance import scenes
from effects.conformance.case import Case
from pipeline.commands import Draw, Mesh
from pipeline.enums import (
    CombinerBias,
    CombinerScale,
    ComponentUsage,
    Mapping,
    MuxSelect,
    PrimitiveType,
    Register,
)
from pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)

SUITE = "Combiner"

ZERO = CombinerInput()
ONE = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
ZERO_ALPHA = CombinerInput(Register.ZERO, usage=ComponentUsage.ALPHA)
ONE_ALPHA = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, ComponentUsage.ALPHA)
CONSTANT0, CONSTANT1 = CombinerInput(Register.CONSTANT_COLOR0), CombinerInput(Register.CONSTANT_COLOR1)
R0, R1 = Register.SPARE0, Register.SPARE1
PRIMARY, SECONDARY = Register.PRIMARY_COLOR, Register.SECONDARY_COLOR
SUM = Register.SPARE0_PLUS_SECONDARY_COLOR
DISCARD = Register.DISCARD


def _alpha(register):
    return CombinerInput(register, usage=ComponentUsage.ALPHA)


def _blue(register):
    return CombinerInput(register, usage=ComponentUsage.BLUE)


def _constant(red, green, blue, alpha):
    """A constant as the programs make it: bytes that are cut, not rounded."""
    return tuple(np.floor(np.float32(c) * np.float32(255.0)) / 255.0 for c in (red, green, blue, alpha))


def _rgb(a=ZERO, b=ONE, c=ZERO, d=ONE, ab=DISCARD, cd=DISCARD, total=DISCARD, **rest):
    return RGBPortion(a, b, c, d, ab_output=ab, cd_output=cd, sum_output=total, **rest)


def _alpha_portion(a=ZERO_ALPHA, ab=DISCARD, **rest):
    """A times one."""
    return AlphaPortion(a, ONE_ALPHA, ab_output=ab, sum_output=DISCARD, **rest)


def _stage(rgb, alpha=None, constant0=(0, 0, 0, 0), constant1=(0, 0, 0, 0)):
    return GeneralCombiner(rgb, alpha or _alpha_portion(), _constant(*constant0), _constant(*constant1))


def _final(d=ZERO, g=ONE_ALPHA, **rest):
    return FinalCombiner(**{"a": ZERO, "b": ZERO, "c": ZERO, "d": d, "e": ZERO, "f": ZERO, "g": g, **rest})


def _shows(register):
    return _final(CombinerInput(register))


DEFAULT_STAGE = _stage(_rgb(CombinerInput(PRIMARY), ab=R0), _alpha_portion(_alpha(PRIMARY), R0))


def _program(stages, final, **rest):
    return replace(
        scenes.DEFAULT, register_combiners=RegisterCombiners(stages, final, color_sum_clamp=False, **rest)
    )


# ------------------------------------------------------------------------------------ geometry


def _world_quad(state, left, top, right, bottom, z, color=(0.0, 0.0, 0.0, 1.0)):
    """A quad in world coordinates, in the XDK's view."""
    corners = scenes.single(scenes.rectangle(left, top, right, bottom, z))
    mesh = Mesh(corners, PrimitiveType.QUADS, colors=scenes.single([color] * 4))
    return Draw(label="quad", mesh=mesh, state=replace(state, vertex=scenes.xdk_vertex()))


def _patch(k, state):
    """Patch k of six: four in a row, two below."""
    left, top = -2.75 + 1.4 * (k % 4), 1.75 - (3.4 / 3 + 0.4) * (k // 4)
    return _world_quad(state, left, top, left + 1.3, top - 3.4 / 3, 1.0)


def _box(state, left, top, right, bottom, color=(1.0, 1.0, 1.0, 0.0)):
    """A quad on the screen; the XDK's viewport offset, 17/32 pixel, snaps to half a pixel."""
    corners = scenes.rectangle(left + 0.5, top + 0.5, right + 0.5, bottom + 0.5)
    return scenes.quad("quad", corners, color, state)


def _halves(left, top, stage, register):
    """A box of 64 pixels: on the left the register opaque, on the right with its own alpha."""
    opaque, own = _shows(register), replace(_shows(register), g=_alpha(register))
    return (
        _box(_program((stage,), opaque), left, top, left + 32, top + 64),
        _box(_program((stage,), own), left + 32, top, left + 64, top + 64),
    )


# ----------------------------------------------------------------------------------------- cases


def _alpha_from_blue():
    commands = [*scenes.background()]
    factor = CombinerInput(PRIMARY)
    for row, output in enumerate(("ab", "cd")):
        for k, blue in enumerate((1.0, 0.75, 0.5, 0.25, 0.0)):
            rgb = _rgb(CONSTANT0, factor, CONSTANT0, factor, **{output: R0, f"{output}_blue_to_alpha": True})
            stage = _stage(rgb, constant0=(0.25, 0.5, blue, 0.0))
            commands += _halves(128 + 72 * k, 192 + 72 * row, stage, R0)
    return commands


def _color_alpha_independence():
    def quad(state):
        return _world_quad(state, -2.75, 1.75, 2.75, -1.75, 0.0, (0.1, 1.0, 0.1, 1.0))

    first = _stage(_rgb(CONSTANT0, ab=R0), _alpha_portion(_alpha(PRIMARY), R0))
    second = _stage(_rgb(CONSTANT0, ab=R0), _alpha_portion(_blue(R0), R1), constant0=(0.0, 0.0, 1.0, 1.0))
    return (
        scenes.clear(0xFF303030),
        quad(_program((DEFAULT_STAGE,), _shows(PRIMARY))),
        quad(_program((first, second), replace(_shows(R0), g=_alpha(R1)))),
    )


def _combiner_ops():
    half, no_bias = CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF, CombinerBias.NONE
    operations = (
        (200, 74, CombinerScale.NONE, no_bias),
        (200, 146, CombinerScale.NONE, half),
        (200, 218, CombinerScale.SCALE_BY_TWO, no_bias),
        (200, 290, CombinerScale.SCALE_BY_TWO, half),
        (200, 362, CombinerScale.SCALE_BY_FOUR, no_bias),
        (500, 74, CombinerScale.SCALE_BY_ONE_HALF, no_bias),
    )
    commands = [*scenes.background()]
    for left, top, scale, bias in operations:
        stage = _stage(
            _rgb(CONSTANT0, ab=R0, scale=scale, bias=bias),
            _alpha_portion(_blue(Register.CONSTANT_COLOR0), R0, scale=scale, bias=bias),
            constant0=(0.1, 0.25, 1.0, 0.5),
        )
        commands += _halves(left, top, stage, R0)
    return commands


def _flags():
    ones = _stage(_rgb(ONE, c=ONE, ab=SECONDARY, cd=R0))
    spare0 = _stage(_rgb(c=CONSTANT0, ab=SECONDARY, cd=R0), constant0=(0.75,) * 4)
    secondary = _stage(_rgb(c=CONSTANT0, ab=R0, cd=SECONDARY), constant0=(0.75,) * 4)
    halved, whole = _final(a=CONSTANT0, b=CombinerInput(SUM)), _final(a=ONE, b=CombinerInput(SUM))
    own = {"constant_color0": _constant(0.5, 0.5, 0.5, 0.5)}
    programs = (
        _program((ones,), halved, **own),
        replace(
            scenes.DEFAULT,
            register_combiners=RegisterCombiners((ones,), halved, color_sum_clamp=True, **own),
        ),
        _program((spare0,), whole),
        _program((spare0,), whole, invert_spare0=True),
        _program((secondary,), whole),
        _program((secondary,), whole, invert_secondary_color=True),
    )
    return (scenes.clear(0xFF303030), *(_patch(k, program) for k, program in enumerate(programs)))


def _independence():
    green = _stage(_rgb(CONSTANT0, ab=R0), constant0=(0.0, 1.0, 0.0, 1.0))
    red = _stage(_rgb(CONSTANT0, c=CombinerInput(R0), ab=R0, cd=R1), constant0=(1.0, 0.0, 0.0, 1.0))
    quarter = _stage(_rgb(CONSTANT0, ab=R0), constant0=(0.0, 0.0, 0.25, 0.0))
    blues = {"ab_blue_to_alpha": True, "cd_blue_to_alpha": True}
    three_quarters = _stage(
        _rgb(CONSTANT0, c=CombinerInput(R0), ab=R0, cd=R1, **blues), constant0=(0.0, 0.0, 0.75, 0.0)
    )
    alphas = _stage(_rgb(_alpha(R0), c=_alpha(R1), ab=R0, cd=R1))
    greys = (quarter, three_quarters, alphas)
    return (
        scenes.clear(0xFF303030),
        _patch(0, _program((green, red), _shows(R1))),
        _patch(2, _program(greys, _shows(R1))),
        _patch(4, _program(greys, _shows(R0))),
    )


def _mux():
    commands = [scenes.clear(0xFF303030)]
    selected = _stage(
        _rgb(CONSTANT0, c=CONSTANT1, total=PRIMARY, mux_sum=True),
        _alpha_portion(ONE_ALPHA, PRIMARY),
        (1.0, 0.0, 0.0, 1.0),
        (0.0, 0.0, 1.0, 1.0),
    )
    final = replace(_shows(PRIMARY), g=_alpha(PRIMARY))
    for k, alpha in enumerate((0x82, 0x82, 0x81, 0x81, 0x00, 0x00)):
        first = GeneralCombiner(
            _rgb(ONE, ab=R0), _alpha_portion(_alpha(Register.CONSTANT_COLOR0), R0), (0, 0, 0, alpha / 255)
        )
        select = MuxSelect.MSB if k % 2 else MuxSelect.LSB
        commands.append(_patch(k, _program((first, selected), final, mux_select=select)))
    return commands


def _special_inputs():
    product = _final(CombinerInput(Register.E_TIMES_F), e=CONSTANT0, f=CONSTANT1)
    own = {
        "constant_color0": _constant(1.0, 0.75, 0.5, 1.0),
        "constant_color1": _constant(0.5, 0.5, 0.5, 0.5),
    }
    terms = _stage(
        _rgb(CONSTANT0, c=CONSTANT1, ab=R0, cd=SECONDARY),
        constant0=(0.25, 0.5, 0.75, 0.0),
        constant1=(0.7, 0.5, 0.15, 0.5),
    )
    boxes = (
        (200, 74, _program((DEFAULT_STAGE,), product, **own)),
        (200, 170, _program((terms,), _shows(SUM))),
        (500, 170, _program((terms,), _shows(SUM), invert_spare0=True)),
        (200, 242, _program((terms,), _shows(SUM), invert_secondary_color=True)),
    )
    return (*scenes.background(), *(_box(p, x, y, x + 64, y + 64) for x, y, p in boxes))


def _unbound_tex_sampler():
    commands = [scenes.clear(0xFF6A6A6A)]
    for unit in range(4):
        register = Register.TEXTURE0 + unit
        for column, shown in enumerate((CombinerInput(Register(register)), _alpha(Register(register)))):
            left, top = 252 + 72 * column, 96 + 72 * unit
            commands.append(_box(_program((DEFAULT_STAGE,), _final(shown)), left, top, left + 64, top + 64))
    return commands


CASES = {
    "AlphaFromBlue": _alpha_from_blue,
    "ColorAlphaIndependence": _color_alpha_independence,
    "CombinerOps": _combiner_ops,
    "Flags": _flags,
    "Independence": _independence,
    "Mux": _mux,
    "SpecialInputs": _special_inputs,
    "UnboundTexSampler": _unbound_tex_sampler,
}


def names():
    """Every case of the suite."""
    return list(CASES)


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    return Case(commands=tuple(CASES[name]())) if name in CASES else None
