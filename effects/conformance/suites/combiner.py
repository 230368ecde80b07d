"""Combiner: register combiners of constants and flat colours.

Source: src/tests/combiner_tests.cpp of nxdk_pgraph_tests, in several versions: SpecularR0SumFlags replaced
Flags. Not included, though the machine could draw them: SignedToUnsignedMapping and
SignedPassThroughPipeline, which read signed textures.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    CombinerBias,
    CombinerScale,
    ComponentUsage,
    Mapping,
    MuxSelect,
    PrimitiveType,
    Register,
)
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d

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


def _texture_destination():
    """On the left of each pair a stage writes a texture register, on the right it discards the result."""
    tex0, tex1 = Register.TEXTURE0, Register.TEXTURE1
    green, half = (0.0, 1.0, 0.0, 1.0), _alpha(Register.CONSTANT_COLOR0)
    reads0, reads1 = (_stage(_rgb(CombinerInput(r), ab=R0)) for r in (tex0, tex1))
    reads_alpha = _stage(_rgb(_alpha(tex0), ab=R0))
    rest = replace(half, mapping=Mapping.UNSIGNED_INVERT)
    adds_blue = _stage(
        _rgb(CONSTANT0, c=ONE, d=CombinerInput(tex0), total=R0), constant0=(0.0, 0.0, 0.5, 0.0)
    )

    def stages(destination):
        writes = _stage(_rgb(CONSTANT0, ab=destination), constant0=green)
        blends = _stage(
            _rgb(CombinerInput(tex0), half, CONSTANT0, half, total=destination),
            constant0=(0.0, 1.0, 0.0, 0.5),
        )
        mixes = _stage(
            _rgb(CombinerInput(tex0), half, CombinerInput(R0), rest, total=destination),
            constant0=(0.0, 0.0, 0.0, 0.5),
        )
        alpha = _stage(_rgb(CONSTANT0), _alpha_portion(half, destination), (0.0, 0.0, 0.0, 0.25))
        scratch = tex1 if destination == tex0 else DISCARD
        yellow = _stage(_rgb(CONSTANT0, ab=scratch), constant0=(1.0, 1.0, 0.0, 1.0))
        return (
            ((writes, reads0), R0),
            ((blends, reads0), R0),
            ((_stage(_rgb(CONSTANT0, ab=R0), constant0=green), mixes, adds_blue), R0),
            ((writes,), tex0),
            ((alpha, reads_alpha), R0),
            ((yellow, reads1), R0),
        )

    board = scenes.checkerboard(0xFFFF0000, 0xFF000011, 8, 64)
    units = (TextureUnit("checkerboard", scenes.NEAREST),)
    yield from scenes.background(0xFF001100, 0xFF001111)
    yield TexImage(label="red and blue", texture="checkerboard", image=texture_2d(board))
    for left, destination in ((350, tex0), (440, DISCARD)):
        for row, (program, shown) in enumerate(stages(destination)):
            top = 98 + 50 * row
            corners = scenes.rectangle(left + 0.5, top + 0.5, left + 50.5, top + 22.5)
            mesh = scenes.window_mesh(corners, texture_coordinates=(scenes.UNIT_SQUARE,))
            state = replace(_program(program, _shows(shown)), texture_units=units)
            yield Draw(label="quad", mesh=mesh, state=state)


def _unbound_tex_sampler():
    commands = [scenes.clear(0xFF6A6A6A)]
    for unit in range(4):
        register = Register.TEXTURE0 + unit
        for column, shown in enumerate((CombinerInput(Register(register)), _alpha(Register(register)))):
            left, top = 252 + 72 * column, 96 + 72 * unit
            commands.append(_box(_program((DEFAULT_STAGE,), _final(shown)), left, top, left + 64, top + 64))
    return commands


# Output operations of a general combiner.
HALF = CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF
IDENTITY, LEFT_1, LEFT_2 = {}, {"scale": CombinerScale.SCALE_BY_TWO}, {"scale": CombinerScale.SCALE_BY_FOUR}
RIGHT_1, BIAS = {"scale": CombinerScale.SCALE_BY_ONE_HALF}, {"bias": HALF}
LEFT_1_BIAS = LEFT_1 | BIAS


def _grey(value):
    return (value, value, value, 1.0)


def _split(x, row, program, *expected):
    """A box whose left half a program draws; the right one has the colour that the test's author expected."""
    left, top = x, 25 + 25 * row
    shown = _stage(_rgb(CONSTANT0, ab=R0), constant0=(*(expected * 3)[:3], 1.0))
    return (
        _box(program, left, top, left + 23, top + 16),
        _box(_program((shown,), _shows(R0)), left + 23, top, left + 46, top + 16),
    )


def _specular_r0_sum_flags():
    # The row; SPARE0, whether negated; SECONDARY; whether each is inverted; A, D; expected, and if clamped.
    rows = (
        (2, 1.0, False, 1.0, False, False, 0.5, 0.0, 1.0, 0.5),
        (3, 0.75, False, 0.75, False, False, 0.5, 0.0, 0.75, 0.5),
        (6, 0.75, False, 0.25, True, False, 0.5, 0.0, 0.25, 0.25),
        (7, 0.25, False, 0.75, False, True, 0.5, 0.0, 0.25, 0.25),
        (8, 0.75, False, 0.75, True, True, 0.5, 0.0, 0.25, 0.25),
        (9, 0.25, False, 0.25, True, True, 0.5, 0.0, 0.75, 0.5),
        (12, 0.3, True, 0.5, False, False, 1.0, 0.0, 0.5, 0.5),
        (13, 0.5, True, 0.2, False, False, 1.0, 0.5, 0.7, 0.7),
        (14, 0.5, True, 0.0, False, False, 1.0, 0.5, 0.5, 0.5),
        (15, 0.3, True, 0.0, True, False, 0.5, 0.0, 0.5, 0.5),
    )
    commands = [scenes.clear(0xFF331133)]
    for row, r0, negated, v1, invert_r0, invert_v1, a, d, *expected in rows:
        first = replace(CONSTANT0, mapping=Mapping.SIGNED_NEGATE) if negated else CONSTANT0
        stage = _stage(_rgb(first, c=CONSTANT1, ab=R0, cd=SECONDARY), None, _grey(r0), _grey(v1))
        for clamp, x in ((False, 260), (True, 400)):
            combiners = RegisterCombiners(
                (stage,),
                _final(CONSTANT1, a=CONSTANT0, b=CombinerInput(SUM)),
                constant_color0=_constant(*_grey(a)),
                constant_color1=_constant(*_grey(d)),
                color_sum_clamp=clamp,
                invert_spare0=invert_r0,
                invert_secondary_color=invert_v1,
            )
            program = replace(scenes.DEFAULT, register_combiners=combiners)
            commands += _split(x, row, program, expected[clamp])
    return commands


def _specular_r0_sum():
    operations = (  # the operation on both terms, SPARE0 before and after
        (LEFT_1, 0.25, 0.5, lambda x: 2 * x),
        (LEFT_2, 0.25, 1.0, lambda x: 4 * x),
        (RIGHT_1, 0.5, 0.25, lambda x: x / 2),
        (BIAS, 0.75, 0.25, lambda x: x - np.float32(0.5)),
        (LEFT_1_BIAS, 0.75, 0.5, lambda x: (x - np.float32(0.5)) * 2),
    )
    commands = [scenes.clear(0xFF333322)]
    for top, secondary in ((2, (0.0, 0.0, 0.0)), (9, (0.1, 0.5, 0.8))):
        for row, (operation, value, after, operated) in enumerate(operations, top):
            first = _stage(_rgb(CONSTANT0, ab=R0), constant0=_grey(value))
            rgb = _rgb(CombinerInput(R0), c=CONSTANT1, ab=R0, cd=SECONDARY, **operation)
            stages = (first, _stage(rgb, constant1=(*secondary, 1.0)))
            added = np.clip(operated(np.array(secondary, np.float32)), np.float32(0), np.float32(1))
            expected = np.minimum(np.float32(after) + added, np.float32(1)).tolist()
            commands += _split(260, row, _program(stages, _shows(R0)), after)
            commands += _split(380, row, _program(stages, _shows(SUM)), *expected)
    return commands


def _input_mappings():
    mappings = (  # and what a value becomes
        (Mapping.UNSIGNED_IDENTITY, lambda x: max(0.0, x)),
        (Mapping.UNSIGNED_INVERT, lambda x: 1.0 - max(0.0, x)),
        (Mapping.EXPAND_NORMAL, lambda x: 2.0 * max(0.0, x) - 1.0),
        (Mapping.EXPAND_NEGATE, lambda x: 1.0 - 2.0 * max(0.0, x)),
        (Mapping.HALF_BIAS_NORMAL, lambda x: max(0.0, x) - 0.5),
        (Mapping.HALF_BIAS_NEGATE, lambda x: 0.5 - max(0.0, x)),
        (Mapping.SIGNED_IDENTITY, lambda x: x),
        (Mapping.SIGNED_NEGATE, lambda x: -x),
    )
    commands = [scenes.clear(0xFF113333)]
    for row, (mapping, mapped) in enumerate(mappings, 3):
        for x, value in ((240, 0.7), (400, -0.4)):
            given = replace(CONSTANT0, mapping=Mapping.SIGNED_NEGATE) if value < 0 else CONSTANT0
            first = _stage(_rgb(given, ab=R1), constant0=_grey(abs(value)))
            rgb = _rgb(CombinerInput(R1, mapping), CONSTANT0, CONSTANT1, total=R0)
            program = _program((first, _stage(rgb, None, _grey(0.5), _grey(0.5))), _shows(R0))
            commands += _split(x, row, program, float(np.float32(mapped(value) * 0.5 + 0.5)))
    return commands


def _shift_clamping():
    sums = (  # row, column, each term, operation, expected
        (2, 0, 0.75, IDENTITY, 1.0),
        (2, 1, 0.75, RIGHT_1, 0.75),
        (2, 2, 0.75, BIAS, 1.0),
        (2, 3, 0.75, LEFT_1, 1.0),
        (2, 4, 0.75, LEFT_2, 1.0),
        (4, 0, 0.625, BIAS, 0.75),
        (4, 1, 0.625, LEFT_1_BIAS, 1.0),
        (4, 2, 0.375, LEFT_1_BIAS, 0.5),
        (4, 3, 0.25, LEFT_1_BIAS, 0.0),
        (4, 4, 0.125, LEFT_1_BIAS, 0.0),
    )
    saturated = ((0.6, LEFT_1), (0.8, LEFT_1), (0.3, LEFT_2), (0.6, LEFT_2))
    commands = [scenes.clear(0xFF222222)]
    for row, column, value, operation, expected in sums:
        rgb = _rgb(CONSTANT0, c=CONSTANT1, total=R0, **operation)
        stage = _stage(rgb, None, _grey(value), _grey(value))
        commands += _split(260 + 70 * column, row, _program((stage,), _shows(R0)), expected)
    for column, (value, operation) in enumerate(saturated):
        stage = _stage(_rgb(CONSTANT0, ab=R0, **operation), constant0=_grey(value))
        commands += _split(260 + 70 * column, 7, _program((stage,), _shows(R0)), 1.0)
    return commands


def _signed_combiner_ops():
    boxes = (
        (230, 80, 0.125, IDENTITY),
        (230, 152, 0.125, LEFT_1),
        (230, 224, 0.125, LEFT_2),
        (540, 80, 0.125, RIGHT_1),
        (540, 152, 0.125, BIAS),
        (540, 224, 0.375, LEFT_2),
    )
    commands = [*scenes.background(0xFF001100, 0xFF001111)]
    for left, top, value, operation in boxes:
        negated, signed = Mapping.SIGNED_NEGATE, Mapping.SIGNED_IDENTITY
        first = _stage(
            _rgb(replace(CONSTANT0, mapping=negated), ab=R1, **operation),
            _alpha_portion(replace(_alpha(Register.CONSTANT_COLOR0), mapping=negated), R1, **operation),
            (value,) * 4,
        )
        second = _stage(
            _rgb(CONSTANT1, c=CombinerInput(R1, signed), total=R0),
            AlphaPortion(
                _alpha(Register.CONSTANT_COLOR1),
                ONE_ALPHA,
                replace(_alpha(R1), mapping=signed),
                ONE_ALPHA,
                sum_output=R0,
            ),
            constant1=(0.75,) * 4,
        )
        right = left + 36
        commands += (
            _box(_program((first, second), _shows(R0)), left, top, right, top + 36),
            _box(_program((first, second), _final(_alpha(R0))), right + 4, top, right + 22, top + 36),
        )
    return commands


COMMANDS = {
    "AlphaFromBlue": _alpha_from_blue,
    "ColorAlphaIndependence": _color_alpha_independence,
    "CombinerOps": _combiner_ops,
    "Flags": _flags,
    "Independence": _independence,
    "InputMappings": _input_mappings,
    "Mux": _mux,
    "ShiftClamping": _shift_clamping,
    "SignedCombinerOps": _signed_combiner_ops,
    "SpecialInputs": _special_inputs,
    "SpecularR0Sum": _specular_r0_sum,
    "SpecularR0SumFlags": _specular_r0_sum_flags,
    "TextureDestination": _texture_destination,
    "UnboundTexSampler": _unbound_tex_sampler,
}


CASES = {name: partial(Case.of, commands) for name, commands in COMMANDS.items()}
