"""The column engine: the machine's rules on int64 columns, every width a parameter, every clamp a switch.

It is the third engine (docs/numbers.md, section 13; docs/decisions/0007-column-engine.md). At the native
widths it draws the same bits as the other two, and at up to 12 bits the same as the portable engine. It alone
draws at other widths. It alone writes fragments that no primitive made (``shade_and_write``). The arithmetic
is in ``fixedpipe.raster.columns``; this package reads states and brings columns together.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.columns.interpolate import IteratedPrimitives
from fixedpipe.pipeline.columns.per_fragment import write
from fixedpipe.pipeline.columns.shade import shade
from fixedpipe.pipeline.columns.texture_shader import run_stages
from fixedpipe.pipeline.columns.textures import key_samplers, reads_as_columns, unit_samplers
from fixedpipe.pipeline.enums import Clamp
from fixedpipe.pipeline.framebuffers.widths import are_for_kernels, are_native, fragment_bits, widths_of
from fixedpipe.pipeline.profiles.profile import NATIVE_BITS, NATIVE_SUBPIXEL_BITS
from fixedpipe.raster.columns import numbers
from fixedpipe.raster.observer import unobserved

# Fragments shaded together. The number bounds the columns' memory and changes no value.
_CHUNK = 1 << 15


# ------------------------------------------------------------------------------------- what needs it


def needs_columns(state, profile, framebuffer, textures):
    """Whether only the column engine can draw a pass.

    The kernels lack some widths, cannot leave out a clamp, and do not have all state.
    """
    widths = widths_of(state, profile, framebuffer, textures)
    if not (has_kernels(profile) and are_for_kernels(widths)):
        return True
    if framebuffer.is_bytes != (framebuffer.color_bits == NATIVE_BITS):  # blending does not clamp
        return True
    if state.texture_shader is not None and not are_native(widths):
        return True
    for unit in state.texture_units:  # a loop is fast, and every Draw runs it
        if unit is not None and reads_as_columns(unit, textures):
            return True
    return has_future(profile) and uses_future(state)


def has_future(profile):
    """Whether a machine has a stage of the future board."""
    return (
        profile.combiners.combiner_lookup
        or profile.textures.evaluate_before_filtering
        or profile.primitives.spherical_interpolation
        or len(profile.combiners.combiner_functions) > 1
    )


def uses_future(state):
    """Whether a pass uses a stage of the future board."""
    combiners, units = state.register_combiners, state.texture_units
    stages = () if combiners is None else combiners.general
    return (
        state.evaluate_before_filtering
        or state.spherical_primary_color
        or state.spherical_secondary_color
        or any(unit is not None and unit.spherical_coordinates for unit in units)
        or any(s.lookup is not None or s.rgb.function or s.alpha.function for s in stages)
    )


def has_kernels(profile):
    """Whether the compiled engines have a machine's filters, clamps and window coordinates."""
    return (
        profile.arithmetic.filter_fraction_bits == NATIVE_BITS
        and profile.arithmetic.combiner_range == 1.0
        and profile.arithmetic.subpixel_bits == NATIVE_SUBPIXEL_BITS
        and len(profile.arithmetic.clamps) == len(Clamp)
    )


# ------------------------------------------------------------------------------ per-fragment operations


def shade_and_write(fragments, state, profile, framebuffer, textures, observe=unobserved, replaced=None):
    """Shade, test and write a FragmentColumns: bool [k], which fragments passed all tests.

    ``observe``: the observer. ``replaced``: a ReplacedStages, whose exact colours the fragments already have.
    """
    bits = fragment_bits(profile, framebuffer)
    samplers = unit_samplers(state, textures, profile, observe)
    filters = samplers if replaced is None else replaced.samplers(samplers)
    color, depth = np.empty((len(fragments.x), 4), np.int64), fragments.depth
    keys = key_samplers(state, textures, profile)
    if state.texture_shader is not None or keys:
        depth = fragments.depth.astype(np.int64)
    for start in range(0, len(color), _CHUNK):
        part, registers = slice(start, start + _CHUNK), {}
        some = fragments.part(part)
        observe("shaded", part=part, fragments=some, bits=bits)
        with np.errstate(all="ignore"):  # coordinates may be infinite or NaN
            if state.texture_shader is not None:
                registers, depth[part] = run_stages(
                    some, state, profile, framebuffer, samplers, bits, observe
                )
            for number, key in keys:
                ended = key.filtered(some)[:, 0] == 0
                depth[part] = np.where(ended, -1, depth[part])
                observe("color key", unit=number, ended=ended)
            given = some, state, profile, bits, textures, filters, registers
            shaded = shade(*given, observe=observe, replaced=replaced)
        if some.covered is not None:
            kind = numbers.REALS if shaded.dtype == np.float64 else numbers.INTEGERS
            share = kind.shared(some.covered * shaded[:, 3], len(profile.primitives.smoothing_samples))
            shaded = np.concatenate([shaded[:, :3], share[:, None]], axis=1)
        color[part] = in_buffer(shaded, numbers.one_of(bits), numbers.one_of(framebuffer.color_bits))
    return write(replace(fragments, depth=depth), color, state, profile, framebuffer, observe)


def in_buffer(color, one, buffer_one):
    """Fragments' colours in the buffer's units. Real numbers are rounded even if both units are equal."""
    if color.dtype == np.float64:
        return np.floor(color * (buffer_one / one) + 0.5).astype(np.int64)
    return numbers.convert(color, one, buffer_one)


# --------------------------------------------------------------------------------------------- Draws


def column_draw(
    primitives, covered, state, profile, framebuffer, textures, observe=unobserved, replaced=None
):
    """Draw fragments of window primitives with float colours: bool [k], which fragments passed all tests.

    ``covered``: the fragments' columns (triangle, x, y, covered), int [k] each; the last may be None.
    ``observe``: the observer; ``replaced``: a ReplacedStages.

    Raises ValueError for ``replaced`` in a pass that evaluates before filtering or has spherical colours.
    """
    bits, given = fragment_bits(profile, framebuffer), (primitives, state, profile, framebuffer, textures)
    draw, finer = IteratedPrimitives(*given, bits, observe), None
    if replaced is not None:
        turned = state.spherical_primary_color or state.spherical_secondary_color
        if state.evaluate_before_filtering or turned:
            raise ValueError(
                "No stage can be changed in a pass that evaluates combiners before filters or interpolates "
                "colours on the sphere; leave out evaluate_before_filtering, spherical_primary_color and "
                "spherical_secondary_color."
            )
        if replaced.has_exact_colors:
            finer = IteratedPrimitives(*given, bits, numbers=numbers.REALS)
    passed = np.zeros(len(covered.x), bool)
    for start in range(0, len(passed), _CHUNK):
        part = slice(start, start + _CHUNK)
        pixels = covered.triangle[part], covered.x[part], covered.y[part]
        with np.errstate(all="ignore"):
            fragments = draw.fragments(*pixels)
            if covered.covered is not None:
                fragments = replace(fragments, covered=covered.covered[part].astype(np.int64))
            if finer is not None:
                fragments = replaced.with_colors(fragments, finer.fragments(*pixels))
        passed[part] = shade_and_write(fragments, *given[1:], observe, replaced)
    return passed
