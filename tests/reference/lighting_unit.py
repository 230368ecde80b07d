"""The lighting unit, one vertex at a time: exact fractions, cut where the unit cuts them.

A number is a Fraction, or one of the floats infinity and NaN.
"""

import math
import struct
from fractions import Fraction

from fixedpipe.pipeline.enums import ColorMaterialParameter, ColorSource, Face, SecondaryColor
from fixedpipe.pipeline.state import ColorSources
from tests.reference.spotlights import driver_spot

LIGHTING, TRANSFORM = 14, 24  # significant bits
SMALLEST, LIMIT = Fraction(1, 2**126), Fraction(2**128)
INFINITY, NAN = math.inf, math.nan

# Which of a material's colours are the vertex's. Source: OpenGL 1.2.1 section 2.13.3.
TRACKED = {
    ColorMaterialParameter.AMBIENT: ["ambient"],
    ColorMaterialParameter.DIFFUSE: ["diffuse"],
    ColorMaterialParameter.AMBIENT_AND_DIFFUSE: ["ambient", "diffuse"],
    ColorMaterialParameter.SPECULAR: ["specular"],
    ColorMaterialParameter.EMISSION: ["emission"],
}


# ----------------------------------------------------------------------------------------------- numbers


def special(x):
    """Whether x is no Fraction. Source: IEEE 754's values that are not finite."""
    return isinstance(x, float)


def exponent(x):
    """Of x = m 2^e with 1 <= |m| < 2. Source: the binary representation."""
    e = abs(x.numerator).bit_length() - x.denominator.bit_length()
    return e if abs(x) >= Fraction(2) ** e else e - 1


def multiple(x, unit):
    """X cut, toward zero, to a multiple of unit. Source: rounding toward zero."""
    return math.trunc(x / unit) * unit


def cut(x, bits):
    """X cut to significant bits, within single precision's range. Source: envytools (xf_sum, lt_mul)."""
    if special(x) or x == 0:
        return x
    x = multiple(x, Fraction(2) ** (exponent(x) - bits + 1))
    if abs(x) < SMALLEST:
        return Fraction(0)
    largest = (2 - Fraction(2) ** (1 - bits)) * 2**127
    return x if abs(x) < LIMIT else (largest if x > 0 else -largest)


def single(x):
    """The nearest single-precision number; a denormal one is 0. Source: IEEE 754."""
    try:
        value = struct.unpack("<f", struct.pack("<f", float(x)))[0]
    except OverflowError:
        value = math.copysign(INFINITY, x)
    if not math.isfinite(value):
        return value
    return Fraction(value) if abs(value) >= SMALLEST else Fraction(0)


def to_lighting(x):
    """A transform unit's number in 14 bits. Source: envytools (xf_s2lt)."""
    if special(x) and math.isnan(x):
        return x
    try:
        bits = struct.unpack("<I", struct.pack("<f", float(x)))[0]
    except OverflowError:
        return math.copysign(INFINITY, x)
    if bits >> 10 & 255 != 255:
        bits += 512
    value = struct.unpack("<f", struct.pack("<I", bits >> 10 << 10))[0]
    return value if not math.isfinite(value) else Fraction(value)


def product(a, b, bits):
    """Source: envytools (pgraph_celsius_lt_mul, fp32_mul)."""
    if special(a) or special(b):
        if any(special(x) and math.isnan(x) for x in (a, b)):
            return NAN
        return Fraction(0) if a == 0 or b == 0 else INFINITY
    return cut(a * b, bits)


def total(terms, bits, guard=5):
    """Source: envytools (pgraph_celsius_lt_add3, _lts_add without guard bits, xf_sum)."""
    if any(special(x) for x in terms):
        infinite = {x for x in terms if special(x)}
        return INFINITY if len(infinite) == 1 and not any(math.isnan(x) for x in infinite) else NAN
    if all(x == 0 for x in terms):
        return Fraction(0)
    unit = Fraction(2) ** (max(exponent(x) for x in terms if x != 0) - (bits - 1) - guard)
    return cut(sum(multiple(x, unit) for x in terms), bits)


def bound(x):
    """The least e with |x| < 2^e. Source: the binary representation."""
    return exponent(x) + 1


def multiply_add(a, b, c, bits):
    """Measured: a loses what it would shift out before it is multiplied, or c (Specular, Lighting_control,
    Lighting_spotlight captures).
    """
    if any(special(x) for x in (a, b, c)):
        return total((product(a, b, bits), c), bits, 0)
    if a * b != 0 and c != 0:
        lower = bound(c) + 1 - (bound(a) + bound(b))
        if lower > 0:
            a = multiple(a, Fraction(2) ** (bound(a) - bits + lower))
        else:
            c = multiple(c, Fraction(2) ** (bound(c) - bits - lower))
    return cut(a * b + c, bits)


def add_product(a, b, c, bits):
    """Measured: an adder with one bit more takes the whole product (Specular, Specular_back captures)."""
    if any(special(x) for x in (a, b, c)):
        return total((product(a, b, bits), c), bits, 0)
    return total((a * b, c), bits, 1)


def limits(x, value):
    """1/0, 1/infinity and 1/NaN, else ``value`` with x's sign. Source: envytools (xf_rcp, lt_rcp)."""
    if special(x):
        return NAN if math.isnan(x) else Fraction(0)
    if x == 0:
        return INFINITY
    value = value if value >= SMALLEST else Fraction(0)
    return -value if x < 0 else value


def mantissa(x, bits):
    """|x| = m 2^e: m as an integer of ``bits`` bits, and e. Source: the binary representation."""
    if special(x) or x == 0:
        return 2 ** (bits - 1), 0
    e = exponent(x)
    return math.trunc(abs(x) / Fraction(2) ** (e - bits + 1)), e


def lighting_reciprocal(x):
    """Source: envytools (pgraph_celsius_lt_rcp, xf_rcp_lut_v1)."""
    m, e = mantissa(x, LIGHTING)
    place = (m >> 7) % 64
    seed = math.floor(Fraction(128) / (1 + (place + Fraction(1, 2)) / 64))
    value = ((2**21 - seed * m) * seed) // 2**14
    return limits(x, Fraction(value) / 2**13 / Fraction(2) ** e)


def transform_reciprocal(x):
    """Source: envytools (xf_rcp, xf_rcp_lut_v2)."""
    m, e = mantissa(x, TRANSFORM)
    place = (m >> 17) % 64
    seed = math.floor(Fraction(128) / (1 + (place + Fraction(1, 2)) / 64) + Fraction(1, 2))
    better = ((2**31 - seed * m) * seed) // 2**24
    best = ((2**37 - better * m) * better) // 2**25
    return limits(x, Fraction(2**24 if m == 2**23 else best) / 2**24 / Fraction(2) ** e)


def transform_inverse_root(x):
    """Source: envytools (xf_rsq, xf_rsq_lut_v2)."""
    m, e = mantissa(x, TRANSFORM)
    place, odd = (m >> 17) % 64, e % 2
    middle = (1 + (place + Fraction(1, 2)) / 64) * 2**odd
    seed = min(127, max(s for s in range(129) if (s - Fraction(1, 2)) ** 2 * middle <= 2**14))
    square = m * 2**odd
    better = ((3 * 2**37 - seed * seed * square) * seed) // 2**32
    best = ((3 * 2**49 - better * better * square) * better) // 2**39
    return limits(abs(x), Fraction(best) / 2**24 / Fraction(2) ** ((e - odd) // 2))


def lighting_inverse_root(x):
    """Measured: sizes of points (Point_params Detailed_FF), whose root is the table's, rounded down."""
    m, e = mantissa(x, LIGHTING)
    place, odd = (m >> 7) % 64, e % 2
    middle = (1 + (place + Fraction(1, 2)) / 64) * 2**odd
    seed = max(s for s in range(129) if s * s * middle <= 2**14)
    return limits(abs(x), Fraction(seed) / 2**7 / Fraction(2) ** ((e - odd) // 2))


def times(a, b):
    """Source: envytools (pgraph_celsius_lt_mul)."""
    return product(a, b, LIGHTING)


def plus(*terms):
    """Source: envytools (pgraph_celsius_lt_add3)."""
    return total(terms, LIGHTING)


def plus_scalar(a, b):
    """Source: envytools (pgraph_celsius_lts_add)."""
    return total((a, b), LIGHTING, 0)


def dot(a, b):
    """Source: envytools (pgraph_celsius_lt_dp)."""
    return plus(*(times(x, y) for x, y in zip(a, b, strict=True)))


def transform_dot(a, b):
    """Source: envytools (pgraph_celsius_xfrm_dp3, _dp4)."""
    return total([product(x, y, TRANSFORM) for x, y in zip(a, b, strict=True)], TRANSFORM)


def register(values):
    """Source: envytools (pgraph_celsius_convert_light_v)."""
    return [to_lighting(single(value)) for value in values]


# ---------------------------------------------------------------------------------------------- geometry


def unit_vector(v):
    """Unit vector, length, its square. Source: envytools (pgraph_celsius_xfrm_vnorm)."""
    square = transform_dot(v, v)
    root = transform_inverse_root(square)
    return [product(c, root, TRANSFORM) for c in v], product(square, root, TRANSFORM), square


def negative(x):
    """Source: a flipped sign bit."""
    return -x


def difference(a, b):
    """Source: envytools (pgraph_celsius_xfrm_vsuba)."""
    return [total((x, negative(y)), TRANSFORM) for x, y in zip(a, b, strict=True)]


def both_weighted(first, second, weight):
    """First times weight plus second times 1 - weight, of three components. Source: envytools
    (pgraph_celsius_xf_full: vsuba, vmula, vadda).
    """
    w = single(weight)
    rest = total((Fraction(1), negative(w)), TRANSFORM)
    return [
        total((product(a, w, TRANSFORM), product(b, rest, TRANSFORM)), TRANSFORM)
        for a, b in zip(first[:3], second[:3], strict=True)
    ]


def eye_coordinates(vertex, position, weight):
    """Source: envytools (pgraph_celsius_xf_full), whose w is the first matrix's."""
    position = [single(c) for c in position]
    eye = [transform_dot(position, [single(m) for m in row]) for row in vertex.modelview]
    if vertex.modelview1 is not None:
        second = [transform_dot(position, [single(m) for m in row]) for row in vertex.modelview1]
        eye[:3] = both_weighted(eye, second, weight)
    return eye


def normal_by(inverse, normal, rescaled):
    """Source: envytools (pgraph_celsius_xf_full); rescaling: OpenGL 1.2.1 section 2.10.3."""
    normal = [transform_dot(normal, [single(inverse[row][j]) for row in range(3)]) for j in range(3)]
    if rescaled:
        third = [single(c) for c in inverse[2]]
        factor = transform_inverse_root(transform_dot(third, third))
        normal = [product(c, factor, TRANSFORM) for c in normal]
    return normal


def geometry(vertex, inverses, position, normal, weight):
    """Normal and unit vector to the viewer in 14 bits, the point in eye coordinates in 24.

    Source: envytools (pgraph_celsius_xf_full).
    """
    eye = eye_coordinates(vertex, position, weight)
    given = [single(c) for c in normal]
    normal = normal_by(inverses[0], given, vertex.rescale_normal)
    if vertex.modelview1 is not None:
        normal = both_weighted(normal, normal_by(inverses[1], given, vertex.rescale_normal), weight)
    if vertex.normalize:
        normal = unit_vector(normal)[0]
    reciprocal = transform_reciprocal(eye[3])
    point = [product(c, reciprocal, TRANSFORM) for c in eye[:3]]
    viewer = register(vertex.lighting.viewer_direction)
    if vertex.lighting.local_viewer:
        viewer = [to_lighting(c) for c in unit_vector(difference([Fraction(0)] * 3, point))[0]]
    return [to_lighting(c) for c in normal], viewer, point


# ------------------------------------------------------------------------------------------------ lights


def normalized(v):
    """In float64, as OpenGL's vertex stage does it. Source: OpenGL 1.2.1 section 2.13.1."""
    v = [float(c) for c in v]
    size = math.sqrt((v[0] * v[0] + v[1] * v[1]) + v[2] * v[2])
    return v if size == 0 else [c / size for c in v]


def below_zero(x):
    """A NaN is not. Source: the sign bit decides, and a NaN's is clear."""
    return x < 0


def highlight(light, material, lighting, normal, viewer, direction, power):
    """The specular factor, a number or a numerator and a reciprocal, 0 where there is none.

    Source: envytools (pgraph_celsius_lt_full); Measured: the sums (Specular, Lighting_control captures).
    """
    coefficients = material.specular_coefficients
    if light.position[3] == 0 and not lighting.local_viewer:
        half = light.half_vector
        if half is None:
            towards = normalized(light.position[:3])
            half = normalized([c + float(e) for c, e in zip(towards, lighting.viewer_direction, strict=True)])
        x = dot(normal, register(half))
        if coefficients is None:
            shine = to_lighting(single(power(float(x) if x > 0 else 0.0, material.shininess)))
            return Fraction(0) if below_zero(x) else shine
        a, b, c = register(coefficients[:3])
        above = plus_scalar(x, a)
        under = multiply_add(x, b, c, LIGHTING)
        return Fraction(0) if below_zero(above) else (above, lighting_reciprocal(under))
    half = [plus(e, d) for e, d in zip(viewer, direction, strict=True)]
    square, x = dot(half, half), dot(normal, half)
    if coefficients is None:
        size = math.sqrt(float(square)) if square != 0 else 1.0
        cosine = (float(x) if x > 0 else 0.0) / size
        shine = to_lighting(single(power(cosine, material.shininess)))
        return Fraction(0) if below_zero(x) else shine
    a, b, c = register(coefficients[3:])
    xx = times(x, x)
    above = multiply_add(square, a, xx, LIGHTING)
    under = multiply_add(square, c, times(xx, b), LIGHTING)
    return Fraction(0) if below_zero(x) or below_zero(above) else (above, lighting_reciprocal(under))


def strengths(light, material, lighting, normal, viewer, point, power):
    """How much of the ambient, diffuse and specular colour. Source: envytools (pgraph_celsius_lt_full).

    Measured: the spotlight (Lighting_spotlight captures); Inferred: dark below zero (nouveau's cones).
    """
    strength, dark = Fraction(1), False
    if light.position[3] == 0:
        position = light.position[:3]
        direction = register(normalized(position) if light.half_vector is None else position)
    else:
        place = [single(float(c) / float(light.position[3])) for c in light.position[:3]]
        vector, distance, square = unit_vector(difference(place, point))
        direction = [to_lighting(c) for c in vector]
        distance, square = to_lighting(distance), to_lighting(square)
        factors = (light.constant_attenuation, light.linear_attenuation, light.quadratic_attenuation)
        strength = lighting_reciprocal(dot((Fraction(1), distance, square), register(factors)))
        if light.range is not None:
            dark = below_zero(plus_scalar(negative(distance), *register([light.range])))
        spot = None if light.spot is None else (light.spot.axis, light.spot.coefficients)
        if light.spot_cutoff != 180:
            spot = driver_spot(light.spot_direction, light.spot_exponent, light.spot_cutoff)
        if spot is not None:
            x = transform_dot([*vector, Fraction(1)], [single(c) for c in spot[0]])
            x = to_lighting(x)
            x = x if special(x) and math.isnan(x) else min(x, Fraction(1))
            a, b, c = register(spot[1])
            above, under = plus_scalar(x, a), multiply_add(b, x, c, LIGHTING)
            strength = times(times(strength, above), lighting_reciprocal(under))
            dark = dark or above <= 0 or below_zero(x)
        strength = Fraction(0) if dark else strength
    facing = dot(normal, direction)
    dark = dark or below_zero(facing)
    diffuse = times(strength, Fraction(0) if dark else facing)
    shine = Fraction(0) if dark else highlight(light, material, lighting, normal, viewer, direction, power)
    specular = strength
    for factor in shine if isinstance(shine, tuple) else (shine,):
        specular = times(specular, factor)
    return {"ambient": strength, "diffuse": diffuse, "specular": specular}


# ----------------------------------------------------------------------------------------------- colours


def sources_of(lighting, side):
    """Where a material's colours come from. Source: NV097_SET_COLOR_MATERIAL; OpenGL 1.2.1 section 2.13.3."""
    given = lighting.front_sources if side == Face.FRONT else lighting.back_sources
    tracking = lighting.color_material
    if given is not None:
        return given
    if tracking is None or tracking.face not in (side, Face.FRONT_AND_BACK):
        return ColorSources()
    return ColorSources(**{name: ColorSource.PRIMARY for name in TRACKED[tracking.parameter]})


def start(lighting, material, side, follows):
    """The primary color before any light. Source: envytools (pgraph_celsius_lt_full: lm_e, lm_a)."""
    scene = lighting.model_ambient
    if side == Face.BACK and lighting.back_model_ambient is not None:
        scene = lighting.back_model_ambient
    emission, ambient = follows["emission"], follows["ambient"]
    if ambient is None:
        own = [float(m) * float(s) for m, s in zip(material.ambient[:3], scene[:3], strict=True)]
        if emission is None:
            return register([float(e) + o for e, o in zip(material.emission[:3], own, strict=True)])
        if (lighting.front_sources if side == Face.FRONT else lighting.back_sources) is not None:
            factors = register(material.emission[:3])  # Measured: Material_color_source, 15 of 15 captures
            own = register(own)
            return [add_product(e, f, o, LIGHTING) for e, f, o in zip(emission, factors, own, strict=True)]
        return [plus(o, e) for o, e in zip(register(own), emission, strict=True)]
    emission = register(material.emission[:3]) if emission is None else emission
    scene = register(scene[:3])
    return [add_product(a, s, e, LIGHTING) for e, a, s in zip(emission, ambient, scene, strict=True)]


def light_color(light, name, side, material):
    """A light's register: its color, times the material's. Source: what a driver loads there."""
    color = getattr(light, name)
    if side == Face.BACK and getattr(light, f"back_{name}") is not None:
        color = getattr(light, f"back_{name}")
    if material is None:
        return register([float(c) for c in color[:3]])
    own = getattr(material, name)[:3]
    return register([float(c) * float(m) for c, m in zip(color[:3], own, strict=True)])


def light_vertex(vertex, side, inverses, position, normal, weight, color, secondary, power):
    """Eight components of one face, not clamped. ``power``: the specification's, for exponents; ``inverses``:
    of the modelview matrices.

    Source: envytools (pgraph_celsius_lt_full); Measured: the secondary color (Specular captures).
    """
    lighting = vertex.lighting
    material = lighting.front if side == Face.FRONT else lighting.back
    sources = sources_of(lighting, side)
    own = [None, register(color[:3]), register(secondary[:3])]
    follows = {n: own[getattr(sources, n)] for n in ("emission", "ambient", "diffuse", "specular")}
    primary, shine = start(lighting, material, side, follows), [Fraction(0)] * 3
    separate = lighting.separate_specular_color
    folded = not separate or vertex.secondary_color == SecondaryColor.DISABLED
    if lighting.lights:
        eye_normal, viewer, point = geometry(vertex, inverses, position, normal, weight)
        if side == Face.BACK:
            eye_normal = [negative(c) for c in eye_normal]
    for light in lighting.lights:
        amounts = strengths(light, material, lighting, eye_normal, viewer, point, power)
        for name in ("ambient", "diffuse", "specular"):
            values = light_color(light, name, side, None if follows[name] else material)
            factors = [(amounts[name], value) for value in values]
            if follows[name]:
                factors = [(times(*f), v) for f, v in zip(factors, follows[name], strict=True)]
            if name == "specular" and not folded:
                shine = [add_product(*f, s, LIGHTING) for f, s in zip(factors, shine, strict=True)]
            else:
                primary = [add_product(*f, p, LIGHTING) for f, p in zip(factors, primary, strict=True)]
    alpha = (to_lighting(single(material.diffuse[3])), color[3], secondary[3])[sources.diffuse]
    result = [*primary, alpha, *(shine if separate else secondary[:3]), secondary[3]]
    return [1.0 if special(c) and math.isnan(c) else float(c) for c in result]


def secondary_output(colors, output):
    """Eight components with the secondary color handed on. Measured: Specular captures."""
    if output == SecondaryColor.FROM_VERTEX:
        return colors
    return [*colors[:7], 1.0] if output == SecondaryColor.OPAQUE else [*colors[:4], 0.0, 0.0, 0.0, 1.0]
