"""The column engine: the machine's rules on int64 columns, every width a parameter, every clamp a switch.

The third engine (docs/numbers.md, section 13; docs/decisions, page 0007). At the native widths its bits are
the other two's; it alone draws at others, and it alone writes fragments that no primitive made
(``shade_and_write``). The arithmetic is in ``raster/wide*.py``; here states are read and columns brought
together.
"""

from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.pipeline.columns.combiners import Registers, arithmetic_of, combine, filled, without_combiners
from fixedpipe.pipeline.columns.texture_shader import run_stages
from fixedpipe.pipeline.columns.textures import LAMBDA_BITS, unit_samplers
from fixedpipe.pipeline.enums import (
    Clamp,
    ColorWeights,
    Face,
    FogArithmetic,
    FogMode,
    FrontFace,
    LightingArithmetic,
    LineRasterization,
    Register,
    ShadeModel,
    TextureTarget,
)
from fixedpipe.pipeline.framebuffers.framebuffer import SURFACE_WORDS
from fixedpipe.pipeline.native.pack import FARTHEST, depth_units, scissor_box
from fixedpipe.pipeline.profiles.profile import NATIVE_BITS, NATIVE_SUBPIXEL_BITS
from fixedpipe.pipeline.programs.combiner_rules import has_color_sum
from fixedpipe.pipeline.programs.future import units_along
from fixedpipe.pipeline.programs.texture_environment import environment_program
from fixedpipe.pipeline.vertices.arithmetic import keep_significant_bits
from fixedpipe.pipeline.vertices.fog import table
from fixedpipe.pipeline.vertices.strokes import whole_size
from fixedpipe.raster import codes as C
from fixedpipe.raster import rows
from fixedpipe.raster.columns import future, interpolate, per_fragment
from fixedpipe.raster.columns import numbers as wide
from fixedpipe.raster.primitives.vertices import W_LARGEST, W_SMALLEST

# Fragments shaded at a time: bounds the columns' memory, and changes no value.
_CHUNK = 1 << 15
_MANTISSA_BITS = 53
_BEYOND = 1 << 10  # how far a vertex colour reaches, in ones, whose clamp is off


@dataclass(frozen=True, eq=False)
class FragmentColumns:
    """Fragments as columns, in draw order; a column may be read only.

    x, y         int64 [k], device pixels, y down
    depth        int64 [k], words of the depth buffer; below 0: outside its limits, the fragment ends
    primary, secondary  int64 [k, 4], in units of the fragment's value of one (``fragment_bits``)
    fog          float64 [k], fog coordinates; None: fog is disabled
    coordinates  float64 [k, units, 4]: s, t, r, q of each texture unit, not divided
    lod          float64 [k, units], lambda without its bias, 1/256 at least apart; None: all is magnified
    divided      for each unit whether s, t and r are divided by q; None: where some fragment's q is not 1
    footprints   float64 [k, units, 3]: s and t along an anisotropic filter's footprint, and its ratio
    texel_alpha  int64 [k], bytes that replace the alpha of unit 0's texels; None: nothing does
    """

    x: np.ndarray
    y: np.ndarray
    depth: np.ndarray
    primary: np.ndarray
    secondary: np.ndarray
    fog: np.ndarray | None
    coordinates: np.ndarray
    lod: np.ndarray | None = None
    divided: tuple[bool, ...] | None = None
    footprints: np.ndarray | None = None
    texel_alpha: np.ndarray | None = None

    def part(self, where):
        """Some of the fragments."""

        def of(column):
            return None if column is None else column[where]

        return FragmentColumns(
            self.x[where],
            self.y[where],
            self.depth[where],
            self.primary[where],
            self.secondary[where],
            of(self.fog),
            self.coordinates[where],
            of(self.lod),
            self.divided,
            of(self.footprints),
            of(self.texel_alpha),
        )


def fragment_bits(profile, framebuffer):
    """How wide fragments' colours are: as the combiners; where a buffer is wider than the machine's usual
    one, as much wider.
    """
    if framebuffer.color_bits not in profile.color_bits:  # a pbuffer's bytes
        return profile.combiner_bits
    return profile.combiner_bits + framebuffer.color_bits - profile.color_bits[0]


# ------------------------------------------------------------------------------------- what needs it


def needs_columns(state, profile, framebuffer, textures):
    """Whether only the column engine draws a pass: a width or a clamp is not the native engines', or the
    state uses what they do not have.
    """
    if (
        not is_native(profile)
        or framebuffer.color_bits != NATIVE_BITS
        or fragment_bits(profile, framebuffer) != NATIVE_BITS
        or not framebuffer.is_bytes
    ):
        return True
    for unit in state.texture_units:  # a loop: every Draw asks
        if unit is None:
            continue
        if unit.color_table is not None:
            return True
        if unit.texture is not None and textures[unit.texture].bits != NATIVE_BITS:
            return True
    return has_future(profile) and uses_future(state)


def has_future(profile):
    """Whether a machine has any stage of the future board."""
    return (
        profile.combiner_lookup
        or profile.evaluate_before_filtering
        or profile.spherical_interpolation
        or len(profile.combiner_functions) > 1
    )


def uses_future(state):
    """Whether a pass asks for a stage of the future board."""
    combiners, units = state.register_combiners, state.texture_units
    stages = () if combiners is None else combiners.general
    return (
        state.evaluate_before_filtering
        or state.spherical_primary_color
        or state.spherical_secondary_color
        or any(unit is not None and unit.spherical_coordinates for unit in units)
        or any(s.lookup is not None or s.rgb.function or s.alpha.function for s in stages)
    )


def is_native(profile):
    """Whether a machine's combiners, filters and window coordinates are the native engines'."""
    return (
        profile.combiner_bits == profile.filter_fraction_bits == NATIVE_BITS
        and profile.combiner_range == 1.0
        and profile.subpixel_bits == NATIVE_SUBPIXEL_BITS
        and len(profile.clamps) == len(Clamp)
    )


# ------------------------------------------------------------------------------------------- shading


def _fog_register(fog, coordinates, profile, count, one):
    """The FOG register, int64 [4, count]."""
    if fog is None:
        return filled((0, 0, 0, one), count)
    color = wide.fixed(fog.color, one)[:3]
    if profile.fog_arithmetic == FogArithmetic.TABLE:
        at = np.clip(np.floor(coordinates * 4096.0), 0.0, 8192.0)
        factor = table(fog.mode)[np.where(np.isnan(at), 0.0, at).astype(np.int64)].astype(np.int64)
        factor = wide.convert(factor, 255, one)
    else:
        rising = fog.mode == FogMode.LINEAR and fog.start > fog.end
        numbers = int(fog.mode), float(fog.density), float(fog.start), float(fog.end)
        factor = wide.fog_factor(coordinates, wide.fog_thresholds(*numbers, one), rising)
    return np.concatenate([filled(color, count), factor[None]])


def shade(fragments, state, profile, bits, textures, samplers, made):
    """Colours of fragments, int64 [k, 4] in units of ``bits``: texture units, combiners, color sum, fog.

    ``made``: registers of texture units by number that a texture shader made.
    """
    if state.evaluate_before_filtering:
        return _shade_before_filtering(fragments, state, profile, bits, textures, samplers, made)
    return _shade(fragments, state, profile, bits, textures, samplers, made, None)


def _shade_before_filtering(fragments, state, profile, bits, textures, samplers, made):
    """Colours at each texel that unit 0's filter reads, and then filtered (section 20)."""
    along, first = units_along(state, textures), samplers[0]
    columns = (0, 1) if first.linear else (0,)
    rows = (0,) if first.texture.target == TextureTarget.TEXTURE_1D else columns
    layers = columns if first.texture.target == TextureTarget.TEXTURE_3D else (0,)

    def mixed(parts, fraction, width):
        return parts[0] if len(parts) == 1 else wide.lerp(*parts, fraction[:, None], width)

    def color(*tap):
        taps = dict.fromkeys(along, tap)
        return _shade(fragments, state, profile, bits, textures, samplers, made, taps)

    levels, width = [], profile.filter_fraction_bits
    for level in (0, 1) if first.between_levels else (0,):
        across, up, deep, between = first.fractions(fragments, level).T
        planes = [
            mixed([mixed([color(level, k, j, i) for i in columns], across, width) for j in rows], up, width)
            for k in layers
        ]
        levels.append(mixed(planes, deep, width))
    return mixed(levels, between, LAMBDA_BITS)


def _shade(fragments, state, profile, bits, textures, samplers, made, taps):
    count, one = len(fragments.x), wide.one_of(bits)
    registers = Registers(samplers, fragments, bits, taps)
    registers.update({Register.TEXTURE0 + unit: register for unit, register in made.items()})
    registers[Register.PRIMARY_COLOR] = fragments.primary.T.astype(np.int64)
    registers[Register.SECONDARY_COLOR] = fragments.secondary.T.astype(np.int64)
    registers[Register.FOG] = _fog_register(state.fog, fragments.fog, profile, count, one)
    program, environments = state.register_combiners, state.register_combiners is None
    if environments:
        program = environment_program(state, textures, profile, has_color_sum(state))
    a = arithmetic_of(profile, bits, environments)
    if program is None:
        return without_combiners(state, registers, count, a).T
    registers[Register.SPARE1] = filled((0, 0, 0, 0), count)
    nothing = np.zeros((3, count), np.int64)
    registers[Register.SPARE0] = np.concatenate([nothing, registers[Register.TEXTURE0][3:]])
    return combine(program, registers, count, a).T


# ------------------------------------------------------------------------------ per-fragment operations


class _Surface:
    """How a buffer keeps colours: masks of its components, and what blending reads back (section 10)."""

    def __init__(self, framebuffer):
        keep, pad, self.alpha = SURFACE_WORDS[framebuffer.color_format]
        self.plain = (keep, pad, self.alpha) == (0xFFFFFFFF, 0, C.SURFACE_ALPHA_STORED)
        self.keep, self.pad = (
            np.array([word >> shift & 255 for shift in (0, 8, 16, 24)], np.int64) for word in (keep, pad)
        )

    def stored(self, color):
        """Colours as the buffer keeps them."""
        if self.plain:
            return color
        if self.alpha == C.SURFACE_ALPHA_SEVEN_BITS:
            color = np.concatenate([color[:, :3], color[:, 3:] >> 1], axis=1)
        return (color & self.keep) | self.pad

    def padded(self, color):
        """What a logic operation leaves."""
        return color if self.plain else (color & self.keep) | self.pad

    def source(self, color):
        """What blending takes of a fragment."""
        return color if self.plain else color & (self.keep | np.array([0, 0, 0, 255]))

    def destination(self, color):
        """What blending takes of the buffer."""
        if self.alpha == C.SURFACE_ALPHA_STORED:
            return color
        alpha = np.full_like(color[:, 3:], 255)
        if self.alpha == C.SURFACE_ALPHA_SEVEN_BITS:
            seven = color[:, 3:] & 127
            alpha = (seven << 1) | (seven >> 6)
        return np.concatenate([color[:, :3], alpha], axis=1)


def _written(state, source, stored, surface, bits, clamps):
    """What blending or a logic operation makes of fragments and what is stored, before the color mask."""
    one, blending = wide.one_of(bits), state.blending
    if state.logic_op is not None:
        source = surface.stored(np.clip(source, 0, one))
        return surface.padded(per_fragment.logic(state.logic_op, source, np.clip(stored, 0, one), one))
    if blending is not None:
        constant = wide.fixed(blending.color, one)
        source = per_fragment.blend(
            blending.equation,
            (blending.source, blending.destination),
            surface.source(source),
            surface.destination(stored),
            constant,
            bits,
        )
    far = per_fragment.FAR
    return surface.stored(np.clip(source, *((0, one) if clamps else (-far, far))))


def write(fragments, color, state, profile, framebuffer):
    """Tests and writes in draw order: bool [k], which fragments passed. ``color``: int64 [k, 4] in the
    buffer's units.
    """
    bits, width = framebuffer.color_bits, framebuffer.width
    clamps = framebuffer.is_bytes or Clamp.BLENDING in profile.clamps
    surface = _Surface(framebuffer)
    stored = framebuffer.color.reshape(-1, 4)
    depth, stencil = framebuffer.depth.reshape(-1), framebuffer.stencil.reshape(-1)
    alive = fragments.depth >= 0
    if state.alpha_test is not None:
        reference = wide.fixed(state.alpha_test.reference, wide.one_of(bits))
        alive &= per_fragment.compare(state.alpha_test.function, color[:, 3], reference)
    mask = state.color_mask
    mask = np.array([mask.red, mask.green, mask.blue, mask.alpha])
    passed = np.zeros(len(alive), bool)
    living = np.flatnonzero(alive)
    pixel = fragments.y[living].astype(np.int64) * width + fragments.x[living]
    for once in per_fragment.in_order(pixel):
        at, here = pixel[once], living[once]
        closer = np.ones(len(at), bool)
        if state.depth_test is not None:
            old = depth[at].astype(np.int64)
            closer = per_fragment.compare(state.depth_test.function, fragments.depth[here], old)
        if state.stencil_test is not None:
            closer = _stencil(state.stencil_test, stencil, at, closer)
        at, here = at[closer], here[closer]
        passed[here] = True
        if state.depth_test is not None and state.depth_test.write:
            depth[at] = fragments.depth[here]
        if mask.any():
            old = stored[at].astype(np.int64)
            new = _written(state, color[here], old, surface, bits, clamps)
            stored[at] = np.where(mask, new, old)
    return passed


def _stencil(test, stencil, at, closer):
    """Stencil test and operations of fragments of distinct pixels; which pass both tests."""
    stored, reference = stencil[at].astype(np.int64), min(max(test.reference, 0), 255)
    agreed = per_fragment.compare(test.function, np.int64(reference & test.mask), stored & test.mask)
    results = [
        per_fragment.stencil_result(operation, stored, reference)
        for operation in (test.depth_pass, test.depth_fail, test.fail)
    ]
    new = np.where(agreed, np.where(closer, results[0], results[1]), results[2])
    stencil[at] = (stored & ~test.write_mask) | (new & test.write_mask)
    return agreed & closer


def shade_and_write(fragments, state, profile, framebuffer, textures):
    """Texture units, combiners, tests and writes of a FragmentColumns: bool [k], which passed all tests."""
    bits = fragment_bits(profile, framebuffer)
    samplers = unit_samplers(state, textures, profile)
    color, depth = np.empty((len(fragments.x), 4), np.int64), fragments.depth
    if state.texture_shader is not None:
        depth = np.empty(len(color), np.int64)
    for start in range(0, len(color), _CHUNK):
        part, registers = slice(start, start + _CHUNK), {}
        some = fragments.part(part)
        with np.errstate(all="ignore"):  # coordinates may be infinite, or no numbers
            if state.texture_shader is not None:
                registers, depth[part] = run_stages(some, state, profile, framebuffer, samplers, bits)
            shaded = shade(some, state, profile, bits, textures, samplers, registers)
        color[part] = wide.convert(shaded, wide.one_of(bits), wide.one_of(framebuffer.color_bits))
    return write(replace(fragments, depth=depth), color, state, profile, framebuffer)


# --------------------------------------------------------------------------------------------- Draws

FLOAT_DEPTHS = {-16: (12, 7, 0xFFFF), -24: (16, 127, 0xFEFFFF)}  # mantissa, bias, largest word


def fragment_colors(colors, state, profile, bits):
    """Vertex colours, float64 [n, 2, 8], in units of ``bits``: cut to the machine's mantissa, to nearest.

    Inferred: a mantissa grows with the width it is rounded to.
    """
    lighting = state.vertex.lighting
    exact = lighting is not None and profile.lighting == LightingArithmetic.EQUATIONS
    kept = _MANTISSA_BITS if exact else profile.color_mantissa_bits + max(bits - NATIVE_BITS, 0)
    limited = np.clip(np.nan_to_num(colors), -_BEYOND, _BEYOND)
    cut = keep_significant_bits(limited, min(kept, _MANTISSA_BITS))
    return np.floor(cut * np.float64(wide.one_of(bits)) + np.float64(0.5)).astype(np.int64)


def column_draw(primitives, covered, state, profile, framebuffer, textures):
    """Draw the fragments ``covered`` (triangle, x, y, int [k] each) of window primitives with float colours:
    bool [k], which passed all tests.
    """
    bits = fragment_bits(profile, framebuffer)
    draw = _Draw(primitives, state, profile, framebuffer, textures, bits)
    passed = np.zeros(len(covered.x), bool)
    for start in range(0, len(passed), _CHUNK):
        part = slice(start, start + _CHUNK)
        with np.errstate(all="ignore"):
            fragments = draw.fragments(covered.triangle[part], covered.x[part], covered.y[part])
        passed[part] = shade_and_write(fragments, state, profile, framebuffer, textures)
    return passed


class _Draw:
    """Primitives with what iteration needs of their state."""

    def __init__(self, primitives, state, profile, framebuffer, textures, bits):
        self.primitives, self.state, self.profile = primitives, state, profile
        self.framebuffer, self.bits = framebuffer, bits
        self.colors = fragment_colors(primitives.colors, state, profile, bits)
        self.depths = depth_units(state, framebuffer, primitives)
        self.units = unit_samplers(state, textures, profile)
        self.divided = tuple(primitives.projective[: len(self.units)])

    def fragments(self, triangle, px, py):
        """The FragmentColumns of pixels of rows ``triangle``."""
        p, state, profile = self.primitives, self.state, self.profile
        px, py = px.astype(np.int64), py.astype(np.int64)
        corners = p.triangles[triangle].astype(np.int64)
        vertices, provoking = corners[:, :3], corners[:, 3]
        x, y = p.x[vertices].astype(np.int64), p.y[vertices].astype(np.int64)
        kinds = p.strokes[triangle, rows.KIND] if len(p.strokes) else None
        area = interpolate.edge_functions(x, y, px, py, profile.subpixel_bits)[1]

        n, inverse_w = self._edges(x, y, kinds, px, py, True), p.inverse_w[vertices]
        e = interpolate.perspective_terms(n, inverse_w)
        b0, b2, _ = interpolate.full_weights(e)
        q0, q2 = interpolate.iteration_weights(e)
        back = self._back(kinds, triangle, area)
        primary, secondary = self._colors(vertices, provoking, back, e, q0, q2)
        if self.state.polygon.shade_model == ShadeModel.SMOOTH:
            corners = self.colors[vertices, back[:, None]]
            if state.spherical_primary_color:
                primary = self._turned(primary, corners[:, :, :3], b0, b2)
            if state.spherical_secondary_color:
                secondary = self._turned(secondary, corners[:, :, 4:7], b0, b2)
        fog = None
        if state.fog is not None:
            fog = interpolate.iterate(b0, b2, p.fog[vertices])

        def edges(px, py):
            return self._edges(x, y, kinds, px, py)

        coordinates, lod, footprints = self._coordinates(vertices, edges, inverse_w, (q0, q2, b0, b2), px, py)
        depth = self._depth(triangle, vertices, kinds, n, inverse_w, x, y, area)
        return FragmentColumns(
            px, py, depth, primary, secondary, fog, coordinates, lod, self.divided, footprints
        )

    def _edges(self, x, y, kinds, px, py, drawn=False):
        """(n0, n1, n2) of pixels; ``drawn``: of the fragments themselves, which in a wide line of diamonds
        take another pixel's.
        """
        line, bits = self.state.line, self.profile.subpixel_bits
        n, _ = interpolate.edge_functions(x, y, px, py, bits)
        if kinds is None or not (lines := kinds == C.PRIMITIVE_LINE).any():
            return n
        if self.profile.diamond_exit_lines:
            width = whole_size(line.width)
            if drawn and width > 1:
                px, py = interpolate.repeated_pixels(x, y, px, py, width, bits)
            along = interpolate.along_diamonds(x, y, px, py, width, bits)
        else:
            steps = line.rasterization == LineRasterization.STEPS
            along = interpolate.along_lines(x, y, px, py, steps, bits)
        return tuple(np.where(lines, a, b) for a, b in zip(along, n, strict=True))

    def _back(self, kinds, triangle, area):
        """Which fragments take the back colour, 0 or 1."""
        p = self.primitives
        if not p.two_side:
            facing = np.zeros(len(area), np.int64)
        else:  # with y down, a negative area is counter-clockwise
            counter_clockwise = self.state.polygon.front_face == FrontFace.CCW
            facing = ((area < 0) != counter_clockwise).astype(np.int64)
        if kinds is None:
            return facing
        return np.where(kinds == C.PRIMITIVE_TRIANGLE, facing, p.strokes[triangle, rows.BACK])

    def _colors(self, vertices, provoking, back, e, q0, q2):
        if self.state.polygon.shade_model == ShadeModel.FLAT:
            colors = self.colors[provoking, back]
        elif self.profile.color_weights == ColorWeights.EIGHT_BITS:
            corners = self.colors[vertices, back[:, None]]
            colors = interpolate.iterate_colors(q0, q2, corners, self.bits)
        else:
            corners = self.colors[vertices, back[:, None]]
            one, clamps = wide.one_of(self.bits), Clamp.VERTEX_COLOR in self.profile.clamps
            low, high = (0, one) if clamps else (-_BEYOND * one, _BEYOND * one)
            colors = interpolate.iterate_exact_colors(e, corners, low, high)
        return colors[:, :4], colors[:, 4:]

    def _turned(self, color, corners, b0, b2):
        """A colour whose red, green and blue are a unit vector that turns steadily (section 20)."""
        one, expanded = wide.one_of(self.bits), arithmetic_of(self.profile, self.bits).expanded
        vector = future.spherical(b0, b2, future.from_color(corners, one, expanded))
        return np.concatenate([future.to_color(vector, one, expanded), color[:, 3:]], axis=1)

    def _coordinates(self, vertices, edges, inverse_w, weights, px, py):
        """Coordinates of every unit, and lambda and footprints where some unit asks for them."""
        count, units = len(px), len(self.units)
        q0, q2, b0, b2 = weights
        coordinates, lod, footprints = np.zeros((count, units, 4)), np.zeros((count, units)), None
        for k, (given, unit) in enumerate(zip(self.state.texture_units, self.units, strict=True)):
            if given is None:
                continue
            corners = self.primitives.coordinates[vertices, k]
            coordinates[:, k] = interpolate.iterate_coordinates(q0, q2, corners)
            if given.spherical_coordinates:
                coordinates[:, k, :3] = future.spherical(b0, b2, corners[:, :, :3])
            if unit is None or not (unit.needs_lambda or unit.anisotropic or unit.probes):
                continue
            target, sizes = unit.texture.target, unit.sizes
            steps, plain, missing = interpolate.block_steps(
                edges, inverse_w, corners, self.divided[k], target, sizes, px, py
            )
            if unit.anisotropic or unit.probes:
                footprints = np.zeros((count, units, 3)) if footprints is None else footprints
                footprint, most = interpolate.anisotropy, float(unit.sampler.max_anisotropy)
                if unit.probes:
                    footprint, most = interpolate.probes, float(unit.sampler.max_probes)
                footprints[:, k], found = footprint(plain, sizes, missing, most)
            else:
                found = interpolate.level_of_detail(steps, missing, target)
            lod[:, k] = found / 256.0
        return coordinates, lod, footprints

    def _depth(self, triangle, vertices, kinds, n, inverse_w, x, y, area):
        """Words of the depth buffer, -1 where a fragment lies outside limits that end it (section 5)."""
        state, target = self.state, self.framebuffer
        limits = state.depth_clamp
        if state.depth_test is None and not (limits is not None and limits.cull):
            return np.zeros(len(triangle), np.int64)
        w = inverse_w if state.w_buffering else None
        z = interpolate.iterate_depth(n, w, self.depths[vertices])
        offset, slope = self._offset(triangle, vertices, kinds, x, y, area)
        z = z + (offset + slope * (z * z))
        farthest = FARTHEST[target.depth_format]
        low, high = 0.0, farthest
        if limits is not None:
            low, high = limits.minimum, farthest if limits.maximum is None else limits.maximum
        float_bits = FLOAT_DEPTHS.get(int(target.depth_format))
        words, inside = interpolate.depth_words(z, low, high, farthest, float_bits)
        if limits is not None and limits.cull:
            return np.where(inside, words, -1)
        return words

    def _offset(self, triangle, vertices, kinds, x, y, area):
        """What is added to every depth, and what times its square: of the polygon that a fragment is of."""
        polygon, p = self.state.polygon, self.primitives
        enabled = np.full(len(triangle), polygon.offset_fill)
        if kinds is not None:
            of_kind = np.array([polygon.offset_fill, polygon.offset_line, polygon.offset_point])
            source = p.strokes[triangle, rows.SOURCE : rows.SOURCE + 3].astype(np.int64)
            stroke = kinds != C.PRIMITIVE_TRIANGLE
            enabled = of_kind[kinds] & (~stroke | (source[:, 0] >= 0))
            vertices = np.where(stroke[:, None] & (source[:, :1] >= 0), source, vertices)
            x, y = p.x[vertices].astype(np.int64), p.y[vertices].astype(np.int64)
            area = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])
        if not enabled.any() or not (polygon.offset_factor or polygon.offset_units):
            return 0.0, 0.0
        values = p.inverse_w[vertices] if self.state.w_buffering else self.depths[vertices]
        steep = interpolate.depth_slope(x, y, area, values, polygon.offset_factor, self.profile.subpixel_bits)
        if self.state.w_buffering:
            slope = np.clip(steep, -(2.0**128), 2.0**128)
            return np.where(enabled, float(polygon.offset_units), 0.0), np.where(enabled, slope, 0.0)
        offset = np.clip(polygon.offset_units + steep, -(2.0**128), 2.0**128)
        if self.framebuffer.depth_format > 0:
            offset = np.trunc(np.clip(offset, -(2.0**30), 2.0**30))
        return np.where(enabled, offset, 0.0), 0.0


@dataclass(frozen=True, eq=False)
class Covered:
    """Pixels of primitives, int64 [k] each: per pixel in draw order."""

    triangle: np.ndarray
    x: np.ndarray
    y: np.ndarray


def covered_triangles(primitives, state, profile, framebuffer):
    """Coverage of triangles at any number of subpixel bits: a Covered, culled and scissored (section 3)."""
    box, polygon, p = scissor_box(state, framebuffer), state.polygon, primitives
    parts = []
    for number, row in enumerate(p.triangles[:, :3]):
        x, y, w = (column[row].tolist() for column in (p.x, p.y, p.inverse_w))
        area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
        front = (area < 0) == (polygon.front_face == FrontFace.CCW)
        culled = polygon.cull_face in (Face.FRONT_AND_BACK, Face.FRONT if front else Face.BACK)
        if area == 0 or culled or min(w) < W_SMALLEST or max(w) > W_LARGEST:
            continue
        px, py = interpolate.covered_pixels(x, y, box, profile.subpixel_bits)
        parts.append((np.full(len(px), number), px, py))
    if not parts:
        return Covered(*(np.zeros(0, np.int64) for _ in range(3)))
    return Covered(*(np.concatenate(column) for column in zip(*parts, strict=True)))
