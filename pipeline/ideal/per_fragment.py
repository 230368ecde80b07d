"""Per-fragment operations (section 4.1) on real colours and depths: tests, blending, logic operations."""

import numpy as np

from fixedpipe.pipeline.enums import BlendEquation, BlendFactor, ComparisonFunction, StencilOperation
from fixedpipe.pipeline.ideal.buffers import written_channels
from fixedpipe.pipeline.ideal.result import to_bytes


def compare(function, a, b):
    """``a FUNC b``, bool, elementwise (section 4.1)."""
    return {
        ComparisonFunction.NEVER: lambda: np.zeros(np.broadcast(a, b).shape, bool),
        ComparisonFunction.LESS: lambda: a < b,
        ComparisonFunction.EQUAL: lambda: a == b,
        ComparisonFunction.LEQUAL: lambda: a <= b,
        ComparisonFunction.GREATER: lambda: a > b,
        ComparisonFunction.NOTEQUAL: lambda: a != b,
        ComparisonFunction.GEQUAL: lambda: a >= b,
        ComparisonFunction.ALWAYS: lambda: np.ones(np.broadcast(a, b).shape, bool),
    }[function]()


def _stencil_operation(operation, stored, reference):
    return {
        StencilOperation.KEEP: lambda: stored,
        StencilOperation.ZERO: lambda: np.zeros_like(stored),
        StencilOperation.REPLACE: lambda: np.full_like(stored, reference),
        StencilOperation.INCR: lambda: np.minimum(stored + 1, 255),
        StencilOperation.DECR: lambda: np.maximum(stored - 1, 0),
        StencilOperation.INVERT: lambda: 255 - stored,
        StencilOperation.INCR_WRAP: lambda: (stored + 1) & 255,
        StencilOperation.DECR_WRAP: lambda: (stored - 1) & 255,
    }[operation]()


def blend_factor(factor, source, destination, constant):
    """A factor of tables 4.1 and 4.2, float64 broadcastable to [k, 4], of unclamped colours."""
    one = np.ones((1, 4))

    def saturate():
        room = np.minimum(source[:, 3:], 1.0 - destination[:, 3:])
        return np.concatenate([room, room, room, np.ones_like(room)], axis=1)

    return {
        BlendFactor.ZERO: lambda: 0.0 * one,
        BlendFactor.ONE: lambda: one,
        BlendFactor.SRC_COLOR: lambda: source,
        BlendFactor.ONE_MINUS_SRC_COLOR: lambda: 1.0 - source,
        BlendFactor.DST_COLOR: lambda: destination,
        BlendFactor.ONE_MINUS_DST_COLOR: lambda: 1.0 - destination,
        BlendFactor.SRC_ALPHA: lambda: source[:, 3:],
        BlendFactor.ONE_MINUS_SRC_ALPHA: lambda: 1.0 - source[:, 3:],
        BlendFactor.DST_ALPHA: lambda: destination[:, 3:],
        BlendFactor.ONE_MINUS_DST_ALPHA: lambda: 1.0 - destination[:, 3:],
        BlendFactor.SRC_ALPHA_SATURATE: saturate,
        BlendFactor.CONSTANT_COLOR: lambda: constant,
        BlendFactor.ONE_MINUS_CONSTANT_COLOR: lambda: 1.0 - constant,
        BlendFactor.CONSTANT_ALPHA: lambda: constant[3:],
        BlendFactor.ONE_MINUS_CONSTANT_ALPHA: lambda: 1.0 - constant[3:],
    }[factor]()


def blend(blending, source, destination):
    """Section 4.1.6 on float64 [k, 4] colours, without a clamp of the result."""
    if blending.equation is BlendEquation.MIN:
        return np.minimum(source, destination)
    if blending.equation is BlendEquation.MAX:
        return np.maximum(source, destination)
    constant = np.array(blending.color, np.float64)
    s = source * blend_factor(blending.source, source, destination, constant)
    d = destination * blend_factor(blending.destination, source, destination, constant)
    if blending.equation is BlendEquation.FUNC_ADD:
        return s + d
    if blending.equation is BlendEquation.FUNC_SUBTRACT:
        return s - d
    if blending.equation is BlendEquation.FUNC_REVERSE_SUBTRACT:
        return d - s
    raise ValueError(f"The ideal machine has no blend equation {blending.equation.name}.")


def apply_logic_operation(operation, source, destination):
    """Table 4.3 on the bytes nearest to the colours: bits have no meaning in the real numbers."""
    s, d = to_bytes(source), to_bytes(destination)
    out = np.zeros_like(s)
    for bit, minterm in enumerate((s & d, s & ~d, ~s & d, ~s & ~d)):
        if operation >> bit & 1:
            out |= minterm
    return out / 255.0


def write_tested(state, buffers, pixel, source, z):
    """Alpha, stencil and depth test on reals, then the writes; each pixel occurs once."""
    if state.alpha_test is not None:
        keep = compare(state.alpha_test.function, source[:, 3], state.alpha_test.reference)
        pixel, source, z = pixel[keep], source[keep], z[keep]
    depth = buffers.depth.reshape(-1)
    closer = np.ones(len(pixel), bool)
    if state.depth_test is not None:
        closer = compare(state.depth_test.function, z, depth[pixel])
    passed = closer
    test = state.stencil_test
    if test is not None:
        stencil = buffers.stencil.reshape(-1)
        stored = stencil[pixel].astype(np.int64)
        reference = min(max(test.reference, 0), 255)
        agreed = compare(test.function, np.int64(reference & test.mask), stored & test.mask)
        new = np.where(
            agreed,
            np.where(
                closer,
                _stencil_operation(test.depth_pass, stored, reference),
                _stencil_operation(test.depth_fail, stored, reference),
            ),
            _stencil_operation(test.fail, stored, reference),
        )
        stencil[pixel] = (stored & ~test.write_mask) | (new & test.write_mask)
        passed = agreed & closer
    write(state, buffers, pixel[passed], source[passed], z[passed])


def writes_depth(state):
    """Whether a pass changes the depth buffer."""
    return state.depth_test is not None and state.depth_test.write


def write(state, buffers, pixel, source, z):
    """What fragments that passed leave: depths, which a copy may read, and colours."""
    if writes_depth(state):
        buffers.depth.reshape(-1)[pixel] = z
    _write_color(state, buffers, pixel, source)


def _write_color(state, buffers, pixel, source):
    """Blending or logic operation, then the color mask; each pixel occurs once."""
    color = buffers.color.reshape(-1, 4)
    destination = color[pixel]
    if state.logic_op is not None:
        source = apply_logic_operation(state.logic_op, source, destination)
    elif state.blending is not None:
        source = blend(state.blending, source, destination)
    color[pixel] = np.where(written_channels(state.color_mask), source, destination)
