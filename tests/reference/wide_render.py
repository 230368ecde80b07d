"""A draw call at any width, one fragment at a time: triangles, 2D textures at level 0, register combiners,
alpha test, depth test and blending. docs/numbers.md, section 13.
"""

from dataclasses import dataclass
from math import floor

from fixedpipe.pipeline.enums import Clamp, Register, TextureFilter
from tests.reference import combine, coverage, depth, fixed, interpolate, per_fragment, sample, shadow, wide


@dataclass
class Widths:
    """Bits of a machine's combiners, buffer and filter fractions."""

    combiner: int
    buffer: int
    fraction: int


def color(component, bits, mantissa):
    """A vertex colour's component. Source: OpenGL 1.2.1 section 2.13.9; Inferred: the mantissa."""
    kept = fixed.keep_significant_bits(component, mantissa + max(bits - 8, 0))
    return floor((2**bits - 1) * kept + 0.5)


def constant(component, bits):
    """A constant's component. Source: OpenGL 1.2.1 section 2.13.9."""
    return floor((2**bits - 1) * fixed.clamp(component, 0.0, 1.0) + 0.5)


def texel(texture, sampler, s, t, fraction_bits):
    """A filtered texel of the base level, in the texture's units. Source: docs/numbers.md, section 6."""
    rows = texture.levels[sampler.base_level][0]
    sizes, linear = (len(rows[0]), len(rows)), sampler.mag_filter == TextureFilter.LINEAR
    axes = []
    for value, mode, size in zip((s, t), (sampler.wrap_s, sampler.wrap_t), sizes, strict=True):
        place = sample.wrap_coordinate(value * float(size), mode, size)
        if not linear:
            axes.append(([sample.wrap_index(floor(place), mode, size, linear=False)] * 2, 0))
            continue
        position = floor((place - 0.5) * 2.0**fraction_bits)
        i, fraction = position >> fraction_bits, position & (2**fraction_bits - 1)
        axes.append(([sample.wrap_index(k, mode, size, linear=True) for k in (i, i + 1)], fraction))
    (columns, across), (lines, up) = axes
    filtered = [
        [
            wide.filtered(rows[j][columns[0]][k], rows[j][columns[1]][k], across, fraction_bits)
            for k in range(4)
        ]
        for j in lines
    ]
    return [wide.filtered(p, q, up, fraction_bits) for p, q in zip(*filtered, strict=True)]


def general_combiner(registers, stage, machine, select):
    """The registers after one general combiner. Source: as combine.general_combiner."""
    written = {register: list(value) for register, value in registers.items()}
    for portion, components in ((stage.rgb, (0, 1, 2)), (stage.alpha, (3,))):
        products = {}
        for k in components:
            a, b, c, d = (
                wide.map_input(registers[v.register][combine.used_component(v.usage, k)], v.mapping, machine)
                for v in (portion.a, portion.b, portion.c, portion.d)
            )
            products[k] = [a * b], [c * d]
        for half, dot in ((0, "ab_dot_product"), (1, "cd_dot_product")):
            if getattr(portion, dot, False):
                every = [products[k][half][0] for k in components]
                for k in components:
                    products[k] = (every, products[k][1]) if half == 0 else (products[k][0], every)
        for k in components:
            ab, cd = products[k]
            both = ab + cd
            if portion.mux_sum:
                both = cd if wide.mux_takes_cd(registers[Register.SPARE0][3], select, machine) else ab
            outputs = portion.ab_output, portion.cd_output, portion.sum_output
            for register, terms in zip(outputs, (ab, cd, both), strict=True):
                if register != Register.DISCARD:
                    value = wide.combiner_output(terms, portion.scale, portion.bias, machine)
                    written[register][k] = value
    return written


def combined(combiners, registers, machine, bits, clamps):
    """A fragment's colour from its registers. Source: as combine.combine."""
    one = machine.one
    for stage in combiners.general:
        own = (
            stage.constant_color0 or combiners.constant_color0,
            stage.constant_color1 or combiners.constant_color1,
        )
        registers[Register.CONSTANT_COLOR0], registers[Register.CONSTANT_COLOR1] = (
            [constant(c, bits) for c in color] for color in own
        )
        registers = general_combiner(registers, stage, machine, combiners.mux_select)
    own = combiners.constant_color0, combiners.constant_color1
    registers[Register.CONSTANT_COLOR0], registers[Register.CONSTANT_COLOR1] = (
        [constant(c, bits) for c in color] for color in own
    )

    def mapped(x, mapping):
        """Unsigned mappings. Source: as combine.map_final_input."""
        if not machine.mapping:
            return one - x if mapping else x
        return one - fixed.clamp(x, 0, one) if mapping else max(0, x)

    def read(variable, k):
        """Source: as combine.read_final_component."""
        value = registers[variable.register][combine.used_component(variable.usage, k)]
        return mapped(value, int(variable.mapping))

    final, total = combiners.final, []
    spare0, secondary = registers[Register.SPARE0], registers[Register.SECONDARY_COLOR]
    for k in range(3):
        value = mapped(spare0[k], 0) + mapped(secondary[k], 0)
        total.append(min(one, value) if combiners.color_sum_clamp and Clamp.COLOR_SUM in clamps else value)
    product = [wide.nearest(read(final.e, k) * read(final.f, k), one) for k in range(3)]
    registers[Register.E_TIMES_F] = [*product, 0]
    registers[Register.SPARE0_PLUS_SECONDARY_COLOR] = [*total, 0]
    rgb = [
        wide.final_component(*(read(v, k) for v in (final.a, final.b, final.c, final.d)), machine)
        for k in range(3)
    ]
    alpha = read(final.g, 3)
    return [*rgb, fixed.clamp(alpha, 0, one) if machine.final_combiner else alpha]


def draw(target, primitives, state, textures, profile, widths):
    """Draw triangles into a Target whose colours are in the buffer's units. ``primitives``: columns as lists,
    colours as floats; ``textures``: with levels as lists and ``bits``.

    Source: docs/numbers.md, sections 3 to 10 and 13.
    """
    bits, clamps = widths.combiner, profile.arithmetic.clamps
    machine = wide.Machine(
        2**bits - 1,
        profile.arithmetic.combiner_range,
        profile.arithmetic.expand_half,
        profile.arithmetic.clamp_low,
        profile.arithmetic.product_rounding,
        profile.arithmetic.round_before_scale,
        Clamp.MAPPING in clamps,
        Clamp.GENERAL_COMBINER in clamps,
        Clamp.FINAL_COMBINER in clamps,
    )
    for *vertices, _ in primitives.triangles:
        triangle = coverage.make_triangle(*((primitives.x[v], primitives.y[v]) for v in vertices))
        inverse_w = tuple(primitives.inverse_w[v] for v in vertices)
        colors = [
            [color(c, bits, profile.arithmetic.color_mantissa_bits) for c in primitives.colors[v][0]]
            for v in vertices
        ]
        depths = depth.vertex_depths(primitives, vertices, state, target.depth_bits, False)
        for px, py in coverage.fragments(triangle, range(target.width), range(target.height)):
            n = coverage.edge_values(triangle, px, py)
            weights = interpolate.weights(n, inverse_w)
            w0, w2 = floor(2.0**bits * weights.q0), floor(2.0**bits * weights.q2)
            shares = w0, 2**bits - w0 - w2, w2
            iterated = [wide.color(shares, [c[k] for c in colors], bits) for k in range(8)]
            texels = []
            for i, unit in enumerate(state.texture_units):
                texture, unit = shadow.as_colors(
                    textures[unit.texture], unit, state.register_combiners, profile
                )
                corners = [primitives.coordinates[v][i] for v in vertices]
                s, t, *_ = sample.iterate_coordinates(corners, weights)
                found = texel(texture, unit.sampler, s, t, widths.fraction)
                texels.append([wide.converted(c, 2**texture.bits - 1, machine.one) for c in found])
            texels += [[0, 0, 0, machine.one]] * (4 - len(texels))
            registers = combine.initial_registers(iterated[:4], iterated[4:], texels, [0, 0, 0, machine.one])
            shaded = combined(state.register_combiners, registers, machine, bits, clamps)
            one = 2**widths.buffer - 1
            source = [wide.converted(c, machine.one, one) for c in shaded]
            z = depth.word(depth.kept(depth.iterate(n, depths)), target.depth_bits, None)
            write(target, px, py, source, z, state, widths.buffer, Clamp.BLENDING in clamps)


def write(target, px, py, source, z, state, bits, clamped):
    """Alpha and depth test, blending. Source: as per_fragment.write_fragment."""
    test, one, far = state.alpha_test, 2**bits - 1, wide.FAR_COLOR
    if test and not per_fragment.compare(test.function, source[3], constant(test.reference, bits)):
        return
    if state.depth_test is not None:
        if not per_fragment.compare(state.depth_test.function, z, target.depth[py][px]):
            return
        if state.depth_test.write:
            target.depth[py][px] = z
    if (blending := state.blending) is not None:
        stored, own = target.color[py][px], [constant(c, bits) for c in blending.color]
        factors = [
            [wide.blend_factor(f, k, source, stored, own, one) for k in range(4)]
            for f in (blending.source, blending.destination)
        ]
        source = [
            wide.blend_component(
                blending.equation, source[k], stored[k], factors[0][k], factors[1][k], bits, clamps=clamped
            )
            for k in range(4)
        ]
    target.color[py][px] = [fixed.clamp(c, *((0, one) if clamped else (-far, far))) for c in source]
