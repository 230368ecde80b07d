"""The accumulation buffer: signed integers, 2^(bits - 1) - 1 = 1.0, a component at a time."""

import math

from fixedpipe.pipeline.enums import AccumOperation
from tests.reference import coverage, fixed, per_fragment


def full_scale(bits):
    """1.0 in a component of so many bits, one of them its sign. Assumed: symmetric, as [-1, 1] is."""
    return 2 ** (bits - 1) - 1


def stored(value, full):
    """A result as the buffer keeps it. Assumed: to nearest, halves up; clamped (OpenGL leaves it open)."""
    if math.isinf(value):
        return full if value > 0 else -full
    return fixed.clamp(math.floor(value + 0.5), -full, full)


def accumulated(operation, a, c, value, one, full):
    """What a component a becomes; c: the read buffer's. Source: OpenGL 1.2.1 section 4.2.4."""
    loaded = stored(((c / one) * value) * full, full)
    return {
        AccumOperation.LOAD: loaded,
        AccumOperation.ACCUM: fixed.clamp(a + loaded, -full, full),
        AccumOperation.ADD: fixed.clamp(a + stored(value * full, full), -full, full),
        AccumOperation.MULT: stored(a * value, full),
        AccumOperation.RETURN: a,
    }[operation]


def returned(a, value, one, full):
    """A color component. Source: OpenGL 1.2.1 section 4.2.4 (clamped), 2.13.9 (to nearest)."""
    return math.floor(fixed.clamp((a / full) * value, 0.0, 1.0) * one + 0.5)


def accumulate(accumulation, read, written, command, size, one, bits):
    """An Accum on nested lists, top row first. Source: OpenGL 1.2.1 section 4.2.4."""
    full = full_scale(bits)
    columns, rows = coverage.scissor_rows_and_columns(command.scissor, *size)
    for py in rows:
        for px in columns:
            accumulation[py][px] = [
                accumulated(command.operation, a, c, command.value, one, full)
                for a, c in zip(accumulation[py][px], read[py][px], strict=True)
            ]
            if command.operation == AccumOperation.RETURN:
                color = [returned(a, command.value, one, full) for a in accumulation[py][px]]
                written[py][px] = per_fragment.masked_color(color, written[py][px], command.color_mask)


def clear(accumulation, color, scissor, size, bits):
    """Source: OpenGL 1.2.1 section 4.2.3."""
    full = full_scale(bits)
    columns, rows = coverage.scissor_rows_and_columns(scissor, *size)
    for py in rows:
        for px in columns:
            accumulation[py][px] = [stored(component * full, full) for component in color]
