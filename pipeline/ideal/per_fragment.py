"""Per-fragment operations (section 4.1) on real colours and depths: tests, blending, logic operations.

Fragments are processed one after the other, in draw order, because several may share a pixel.
"""

import numpy as np
from numba import float64, int64, types, uint8, void

from fixedpipe.pipeline.enums import BlendEquation, BlendFactor
from fixedpipe.pipeline.ideal.buffers import written_channels
from fixedpipe.pipeline.ideal.comparison import holds
from fixedpipe.raster import codes as C
from fixedpipe.raster.kernel import kernel, separate_loop

# A blend factor is base + sign * value. Each entry names the value's source, then color or alpha, base and
# sign.
_NOTHING, _SOURCE, _DESTINATION, _CONSTANT, _SATURATED = range(5)
_COLOR, _ALPHA = range(2)
_FACTORS = {
    BlendFactor.ZERO: (_NOTHING, _COLOR, 0.0, 1.0),
    BlendFactor.ONE: (_NOTHING, _COLOR, 1.0, 1.0),
    BlendFactor.SRC_COLOR: (_SOURCE, _COLOR, 0.0, 1.0),
    BlendFactor.ONE_MINUS_SRC_COLOR: (_SOURCE, _COLOR, 1.0, -1.0),
    BlendFactor.DST_COLOR: (_DESTINATION, _COLOR, 0.0, 1.0),
    BlendFactor.ONE_MINUS_DST_COLOR: (_DESTINATION, _COLOR, 1.0, -1.0),
    BlendFactor.SRC_ALPHA: (_SOURCE, _ALPHA, 0.0, 1.0),
    BlendFactor.ONE_MINUS_SRC_ALPHA: (_SOURCE, _ALPHA, 1.0, -1.0),
    BlendFactor.DST_ALPHA: (_DESTINATION, _ALPHA, 0.0, 1.0),
    BlendFactor.ONE_MINUS_DST_ALPHA: (_DESTINATION, _ALPHA, 1.0, -1.0),
    BlendFactor.SRC_ALPHA_SATURATE: (_SATURATED, _COLOR, 0.0, 1.0),
    BlendFactor.CONSTANT_COLOR: (_CONSTANT, _COLOR, 0.0, 1.0),
    BlendFactor.ONE_MINUS_CONSTANT_COLOR: (_CONSTANT, _COLOR, 1.0, -1.0),
    BlendFactor.CONSTANT_ALPHA: (_CONSTANT, _ALPHA, 0.0, 1.0),
    BlendFactor.ONE_MINUS_CONSTANT_ALPHA: (_CONSTANT, _ALPHA, 1.0, -1.0),
}
EQUATIONS = {
    BlendEquation.FUNC_ADD,
    BlendEquation.FUNC_SUBTRACT,
    BlendEquation.FUNC_REVERSE_SUBTRACT,
    BlendEquation.MIN,
    BlendEquation.MAX,
}

_FACTOR = types.Tuple((int64, int64, float64, float64))
_FOUR = types.UniTuple(float64, 4)
_MASK = types.UniTuple(int64, 4)
_PLACE = types.Tuple((int64[::1], float64[:, ::1], _MASK, float64[:, ::1]))  # pixels, colours; mask, buffer


@kernel
def _stencil_result(operation, stored, reference):
    """The result of a stencil operation, 8 bits. Source: section 4.1.4 and EXT_stencil_wrap."""
    if operation == C.STENCIL_ZERO:
        return 0
    if operation == C.STENCIL_REPLACE:
        return reference
    if operation == C.STENCIL_INCR:
        return min(stored + 1, 255)
    if operation == C.STENCIL_DECR:
        return max(stored - 1, 0)
    if operation == C.STENCIL_INVERT:
        return 255 - stored
    if operation == C.STENCIL_INCR_WRAP:
        return (stored + 1) & 255
    if operation == C.STENCIL_DECR_WRAP:
        return (stored - 1) & 255
    return stored  # STENCIL_KEEP


# The first number of a test says whether it is enabled. Then follow: for the alpha test its function and
# reference; for the depth test its function and whether it writes; for the stencil test its function,
# reference, masks and operations.
_ALPHA_TEST = types.Tuple((int64, int64, float64))
_DEPTH_TEST = types.UniTuple(int64, 3)
_STENCIL_TEST = types.UniTuple(int64, 8)
_TESTED = types.Tuple((int64[::1], float64[:, ::1], float64[::1]))  # pixels, colours, depths


@kernel(void(_TESTED, _ALPHA_TEST, _DEPTH_TEST, _STENCIL_TEST, float64[::1], uint8[::1], uint8[::1]))
def _test(fragments, alpha_test, depth_test, stencil_test, depth, stencil, alive):
    """Alpha, stencil and depth tests. They write stencil values and depths, and mark the
    fragments that pass.
    """
    separate_loop()
    pixel, color, z = fragments
    asks_alpha, alpha_function, least = alpha_test
    asks_depth, depth_function, writes = depth_test
    asks_stencil, stencil_function, reference, mask, write_mask, fail, depth_fail, depth_pass = stencil_test
    for i in range(len(pixel)):
        at, passed = pixel[i], True
        if asks_alpha:
            passed = holds(alpha_function, color[i, 3], least)
        if passed:
            if asks_depth:
                passed = holds(depth_function, z[i], depth[at])
            if asks_stencil:
                stored = int64(stencil[at])
                agreed = holds(stencil_function, reference & mask, stored & mask)
                operation = (depth_pass if passed else depth_fail) if agreed else fail
                new = _stencil_result(operation, stored, reference)
                stencil[at] = uint8((stored & ~write_mask) | (new & write_mask))
                passed = passed and agreed
            if passed and writes:
                depth[at] = z[i]
        alive[i] = passed


@kernel(void(_PLACE))
def _write_plain(place):
    """Write colours unchanged; the last fragment of a pixel remains."""
    separate_loop()
    pixel, source, mask, color = place
    for i in range(len(pixel)):
        for c in range(4):
            if mask[c]:
                color[pixel[i], c] = source[i, c]


@kernel
def _factor(factor, c, source, destination, constant):
    """A blend factor (tables 4.1 and 4.2) for component ``c``."""
    what, which, base, sign = factor
    k = 3 if which == _ALPHA else c
    if what == _NOTHING:
        return base
    if what == _SATURATED:
        if c == 3:
            return 1.0
        room = 1.0 - destination[3]
        return source[3] if source[3] <= room or np.isnan(source[3]) else room
    value = constant[k]
    if what == _SOURCE:
        value = source[k]
    elif what == _DESTINATION:
        value = destination[k]
    return base + sign * value


@kernel(void(_PLACE, int64, _FACTOR, _FACTOR, _FOUR))
def _write_blended(place, equation, of_source, of_destination, constant):
    """Blend and write colours (section 4.1.6), without a clamp of the result."""
    separate_loop()
    pixel, colors, mask, color = place
    for i in range(len(pixel)):
        at = pixel[i]
        source = colors[i, 0], colors[i, 1], colors[i, 2], colors[i, 3]
        destination = color[at, 0], color[at, 1], color[at, 2], color[at, 3]
        for c in range(4):
            s, d = source[c], destination[c]
            if equation == C.EQUATION_MIN:
                result = s if s <= d or np.isnan(s) else d
            elif equation == C.EQUATION_MAX:
                result = s if s >= d or np.isnan(s) else d
            else:  # FUNC_ADD, FUNC_SUBTRACT and FUNC_REVERSE_SUBTRACT
                s *= _factor(of_source, c, source, destination, constant)
                d *= _factor(of_destination, c, source, destination, constant)
                if equation == C.EQUATION_FUNC_SUBTRACT:
                    result = s - d
                elif equation == C.EQUATION_FUNC_REVERSE_SUBTRACT:
                    result = d - s
                else:  # EQUATION_FUNC_ADD
                    result = s + d
            if mask[c]:
                color[at, c] = result


@kernel
def _byte(value):
    """The byte nearest to a colour; a half rounds up."""
    return int64(np.floor(min(max(value, 0.0), 1.0) * 255.0 + 0.5))


@kernel(void(_PLACE, _MASK))
def _write_combined(place, minterms):
    """Apply a logic operation (table 4.3) to the bytes nearest to the colours, and write the result.

    Real numbers have no bits, hence the bytes. ``minterms``: 1 for each minterm of the operation.
    """
    separate_loop()
    pixel, source, mask, color = place
    both, first, second, neither = minterms
    for i in range(len(pixel)):
        for c in range(4):
            if mask[c]:
                s, d = _byte(source[i, c]), _byte(color[pixel[i], c])
                out = (s & d) * both | (s & ~d) * first
                out |= (~s & d) * second | (~s & ~d & 255) * neither
                color[pixel[i], c] = float64(out) / 255.0


def write_tested(state, buffers, pixel, source, z):
    """Test fragments on real numbers (alpha, stencil, depth), and write those that pass.

    ``pixel``: int64 [k]; ``source``: float64 [k, 4]; ``z``: float64 [k]. ``source`` or ``z`` may be empty if
    no test and no write needs it.
    """
    alpha, depth, test = state.alpha_test, state.depth_test, state.stencil_test
    if alpha is not None or depth is not None or test is not None:
        alive = np.empty(len(pixel), np.uint8)
        _test(
            (pixel, source, z),
            (0, 0, 0.0) if alpha is None else (1, int(alpha.function), float(alpha.reference)),
            (0, 0, 0) if depth is None else (1, int(depth.function), int(depth.write)),
            (0,) * 8 if test is None else _stencil(test),
            buffers.depth.reshape(-1),
            buffers.stencil.reshape(-1),
            alive,
        )
        if writes_color(state) and not alive.all():
            passed = alive.view(bool)
            pixel, source = pixel[passed], source[passed]
    _write_color(state, buffers, pixel, source)


def _stencil(test):
    operations = (int(operation) for operation in (test.fail, test.depth_fail, test.depth_pass))
    return (
        1,
        int(test.function),
        min(max(test.reference, 0), 255),
        int(test.mask),
        int(test.write_mask),
        *operations,
    )


def writes_color(state):
    """Whether a pass can change some component of the colours."""
    return bool(written_channels(state.color_mask).any())


def writes_depth(state):
    """Whether a pass writes the depth buffer."""
    return state.depth_test is not None and state.depth_test.write


def write(state, buffers, pixel, source, z):
    """Write fragments that have passed: depths, which a copy may read, and colours."""
    if writes_depth(state):
        buffers.depth.reshape(-1)[pixel] = z
    _write_color(state, buffers, pixel, source)


def _write_color(state, buffers, pixel, source):
    """Blend or apply the logic operation, then write through the color mask."""
    mask = tuple(written_channels(state.color_mask).astype(int).tolist())
    if not any(mask):
        return
    place = pixel, source, mask, buffers.color.reshape(-1, 4)
    if state.logic_op is not None:
        _write_combined(place, tuple(state.logic_op >> bit & 1 for bit in range(4)))
    elif state.blending is not None:
        blending = state.blending
        if blending.equation not in EQUATIONS:
            raise ValueError(f"The ideal machine has no blend equation {blending.equation.name}.")
        factors = _FACTORS[blending.source], _FACTORS[blending.destination]
        _write_blended(place, int(blending.equation), *factors, tuple(map(float, blending.color)))
    else:
        _write_plain(place)
