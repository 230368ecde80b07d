"""Texture shader stages, one fragment at a time: docs/numbers.md section 12, at other widths section 13.

Texels are in units of 1/one, as ``fixed`` has it: 255, 2^n - 1, or REAL for real numbers.
"""

from fractions import Fraction
from math import floor, inf, isqrt, sqrt

from fixedpipe.pipeline.enums import CullMode, DotProductMapping, TextureTarget
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import TextureShaderStage
from tests.reference import fixed, interpolate, roughness, sample
from tests.reference.fixed import clamp, to_single

CONVENTIONAL = (
    Operation.TEXTURE_1D,
    Operation.TEXTURE_2D,
    Operation.TEXTURE_RECTANGLE,
    Operation.TEXTURE_CUBE_MAP,
    Operation.TEXTURE_3D,
)
WITH_OFFSET = (
    Operation.OFFSET_TEXTURE_2D,
    Operation.OFFSET_TEXTURE_2D_SCALE,
    Operation.OFFSET_TEXTURE_RECTANGLE,
    Operation.OFFSET_TEXTURE_RECTANGLE_SCALE,
)
WITHOUT_ACCESS = (
    Operation.NONE,
    Operation.PASS_THROUGH,
    Operation.CULL_FRAGMENT,
    Operation.DOT_PRODUCT,
    Operation.DOT_PRODUCT_DEPTH_REPLACE,
)
WITH_SCALE = (Operation.OFFSET_TEXTURE_2D_SCALE, Operation.OFFSET_TEXTURE_RECTANGLE_SCALE)


def signed(value, bits=8):
    """Two's complement. Source: NV_texture_shader (signed components)."""
    return value - (1 << bits) if value >= 1 << (bits - 1) else value


def width(one):
    """Bits of a texel. Source: docs/numbers.md section 12; Assumed: real numbers stand for bytes."""
    return 8 if one == 1 else one.bit_length()


def codes(texel, one):
    """What has signs, or is part of a word. Source: docs/numbers.md section 12."""
    return [255 * component for component in texel] if one == 1 else texel


def real_texel(value, one=255):
    """A texture shader's real number as a texel's component, four bits finer before it is cut.

    Measured: 98304 of 98304 bytes (BumpEnvMapLuminance); Assumed: as many bits finer at other widths.
    """
    value = clamp(value, 0.0, 1.0) if value == value else 0.0
    if one == 1:
        return Fraction(value)
    fraction = width(one) + 4
    return min(((floor(value * 2.0**fraction) + 1) * one) >> fraction, one)


def mapped(texel, mapping, one=255):
    """A texel as the vector of a dot product. Measured: 56909 pixels for each mapping (DotSTRCube); Assumed:
    other widths than 8, at which no texel holds words of 16 bits.
    """
    bits, half = width(one), fixed.half(one)
    if mapping in (DotProductMapping.UNSIGNED_IDENTITY, DotProductMapping.EXPAND_NORMAL):
        zero = 0 if mapping == DotProductMapping.UNSIGNED_IDENTITY else half
        return tuple((component - zero) / (one - zero) for component in texel[:3])
    red, green, blue, alpha = codes(texel, one)
    if mapping in (DotProductMapping.UNSIGNED_HILO, DotProductMapping.SIGNED_HILO_HEMISPHERE):
        high, low = alpha * 256 + red, green * 256 + blue
        if mapping == DotProductMapping.UNSIGNED_HILO:
            return high / 65535.0, low / 65535.0, 1.0
        x, y = signed(high, 16), signed(low, 16)  # Measured: the root, of whole numbers (HiLoHemi captures)
        if one == 1:
            x, y = x / 32767, y / 32767
            return x, y, sqrt(max(1 - x * x - y * y, 0))
        return x / 32767.0, y / 32767.0, isqrt(max(2**30 - x * x - y * y, 0)) / 32768.0
    rule = {
        DotProductMapping.SIGNED_ODD: lambda v: (2 * signed(v, bits) + 1) / ((1 << bits) - 1),
        DotProductMapping.SIGNED_IDENTITY: lambda v: signed(v, bits) / ((1 << bits - 1) - 1),
    }[mapping]
    return tuple(rule(component) for component in (red, green, blue))


def dot(a, b, one=255):
    """``a0 b0 + a1 b1 + a2 b2``, the second's singles. Source: docs/numbers.md section 12."""
    if one == 1:
        return sum(x * y for x, y in zip(a[:3], b, strict=True))
    return interpolate.product_sum(*zip(a[:3], (to_single(v) for v in b), strict=True))


def spherical(texel, one):
    """(theta, phi), words of 16 bits, of a texel that is a direction. Source: docs/numbers.md section 12."""
    red, green, blue, alpha = codes(texel, one)
    return alpha * 256 + red, green * 256 + blue


def reflected(normal, eye, one=255):
    """``2 n (n e) - e (n n)``. Source: NV_texture_shader section 3.8.13.1.18, times n n."""
    twice, square = 2 * dot(normal, eye, one), dot(normal, normal, one)
    return tuple(n * twice - e * square for n, e in zip(normal, eye, strict=True))


def kept(strq, modes):
    """Whether a CULL_FRAGMENT stage keeps the fragment. Measured: 296284 of 296284 (ClipPlane)."""
    return all((value < 0.0) == (mode == CullMode.LESS) for value, mode in zip(strq, modes, strict=True))


def scaled(texel, magnitude, stage, one=255, magnitude_one=255, largest=inf):
    """A texel times a magnitude, scaled and biased, a factor of ``largest`` at most.

    Measured: 98304 of 98304, with factors above 1 (BumpEnvMapLuminance); Source: NV_texture_shader
    revision 30 (1 at most; below 0 the result is 0 either way).
    """
    factor = magnitude / magnitude_one * stage.offset_texture_scale + stage.offset_texture_bias
    factor = min(factor, largest)
    return [*(real_texel(component * factor / one, one) for component in texel[:3]), texel[3]]


def offset(st, texel, matrix, one=255):
    """(s, t) moved by a texel's blue and green, terms cut as a coordinate's.

    Measured: 131072 of 131072 pixels (BumpEnvMap), 303394 of 303394 (BumpMap_G8B8_B_R90, on texels' edges).
    """
    bits, texel = width(one), codes(texel, one)
    ds, dt = (signed(component, bits) / (1 << bits - 1) for component in (texel[2], texel[1]))
    a1, a2, a3, a4 = matrix
    terms = ((st[0], a1 * ds, a3 * dt), (st[1], a2 * ds, a4 * dt))
    return tuple(sum(three) if one == 1 else interpolate.cut_sum(*three) for three in terms)


def as_bytes(texel, sampler):
    """A register as bytes, signed components not doubled. Source: docs/numbers.md section 12."""
    if sampler is None:
        return texel
    flags = sample.signed_flags(sampler)
    return [value // 2 % 256 if flag else value for value, flag in zip(texel, flags, strict=True)]


class Stages:
    """The stages of one fragment: ``run`` gives the units' texels, whether it lives, and its new depth.

    Source: NV_texture_shader section 3.8.13.1.
    """

    def __init__(self, state, units, weights, access, depth_max, profile, one=255):
        """``access(i, strq or None, operation)``: a unit's texel, at its own coordinates where None."""
        self.one = one
        given = state.texture_shader
        self.stages = (*given, *(TextureShaderStage(),) * (len(units) - len(given)))
        self.units, self.weights, self.access = units, weights, access
        self.depth_max = depth_max
        self.depth_scale = 1.0 if profile.textures.depth_units_in_coordinates else float(depth_max)
        self.largest_scale = 1.0 if profile.texture_shaders.offset_scale_clamped else inf
        self.samplers = [None if unit is None else unit.sampler for unit in state.texture_units]
        self.texels, self.bytes, self.alive, self.depth = [], [], True, None

    def coordinates(self, i):
        """(s, t, r, q) of unit i. Source: docs/numbers.md section 4."""
        found = sample.iterate_coordinates(self.units[i].coordinates, self.weights)
        return tuple(map(Fraction, found)) if self.one == 1 else found

    def dot_product(self, i):
        """Unit i's dot product. Source: NV_texture_shader section 3.8.13.1.14."""
        stage = self.stages[i]
        vector = mapped(self.bytes[stage.previous_texture_input], stage.dot_product_mapping, self.one)
        return dot(self.coordinates(i), vector, self.one)

    def made_coordinates(self, i):
        """(s, t, r) of an access that has made coordinates. Source: NV_texture_shader, table 3.C."""
        stage = self.stages[i]
        operation = stage.operation
        previous = self.bytes[stage.previous_texture_input]
        if operation in WITH_OFFSET:
            return (*offset(self.coordinates(i), previous, stage.offset_texture_matrix, self.one), 0.0)
        if operation == Operation.DEPENDENT_AR_TEXTURE_2D:
            return previous[3] / self.one, previous[0] / self.one, 0.0
        if operation == Operation.DEPENDENT_GB_TEXTURE_2D:
            return previous[1] / self.one, previous[2] / self.one, 0.0
        if operation == Operation.BRDF_TEXTURE_3D:
            eye, light = (spherical(self.bytes[k], self.one) for k in (i - 2, i - 1))
            return eye[0] / 65535.0, light[0] / 65535.0, (light[1] - eye[1]) / 65536.0
        if operation in (Operation.DOT_PRODUCT_TEXTURE_2D, Operation.DOT_PRODUCT_TEXTURE_RECTANGLE):
            return self.dot_product(i - 1), self.dot_product(i), 0.0
        if operation == Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP:
            return tuple(self.dot_product(k) for k in (i - 1, i, i + 1))
        normal = tuple(self.dot_product(k) for k in (i - 2, i - 1, i))
        if operation == Operation.DOT_PRODUCT_REFLECT_CUBE_MAP:
            return reflected(normal, tuple(self.coordinates(k)[3] for k in (i - 2, i - 1, i)), self.one)
        if operation == Operation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP:
            return reflected(normal, stage.constant_eye, self.one)
        return normal

    def rough(self, i):
        """How a lookup moves with the bumps' two components, s's pair and t's, and how far these deviate.

        Source: docs/numbers.md section 12.
        """
        stage = self.stages[i]
        a1, a2, a3, a4 = stage.offset_texture_matrix
        jacobian = (a1, a3), (a2, a4)
        if stage.operation == Operation.DOT_PRODUCT_TEXTURE_2D:
            jacobian = self.coordinates(i - 1)[:2], self.coordinates(i)[:2]
        return jacobian, roughness.deviations(self.bytes[stage.roughness], stage.roughness_scale)

    def replace_depth(self, i):
        """Source: NV_texture_shader section 3.8.13.1.21; Measured: floor, 65536 of 65536 (DotZW)."""
        numerator, denominator = self.dot_product(i - 1), self.dot_product(i)
        if self.one == 1:
            self.depth = numerator / denominator if denominator else inf
            self.alive &= 0 <= self.depth <= 1
            return
        z = numerator * interpolate.signed_reciprocal(denominator) * self.depth_scale
        self.alive &= 0.0 <= z <= self.depth_max
        self.depth = floor(z) if self.alive else 0

    def run(self):
        """Every stage in order. Source: NV_texture_shader, table 3.D (results of stages without a texel; a
        scaled stage's result is the texel before).
        """
        for i, stage in enumerate(self.stages):
            operation, texel = stage.operation, [0, 0, 0, 0]
            if operation == Operation.NONE or self.units[i] is None:
                texel = [0, 0, 0, self.one]  # Measured: disabled units
            elif operation in CONVENTIONAL:
                texel = self.access(i, None, operation)
            elif operation == Operation.PASS_THROUGH:
                texel = [real_texel(component, self.one) for component in self.coordinates(i)]
            elif operation == Operation.CULL_FRAGMENT:
                self.alive &= kept(self.coordinates(i), stage.cull_modes)
            elif operation == Operation.DOT_PRODUCT_DEPTH_REPLACE:
                self.replace_depth(i)
            elif operation != Operation.DOT_PRODUCT:
                rough = None if stage.roughness is None else self.rough(i)
                texel = self.access(i, self.made_coordinates(i), operation, rough)
            reads = operation not in WITHOUT_ACCESS
            self.bytes.append(as_bytes(texel, self.samplers[i] if reads else None))
            if operation in WITH_SCALE:  # of the register alone: later stages read the texel before
                magnitude = self.bytes[stage.previous_texture_input][0]
                texel = scaled(texel, magnitude, stage, self.one, self.one, self.largest_scale)
            self.texels.append(texel)
        return self.texels, self.alive, self.depth


def on_any_face(strq):
    """(s, t) of a cube map's access to a 2D texture. Measured: 113818 of 113818 (Texture_2D_as_cubemap)."""
    sc, tc, major = sample.face_components(strq, sample.cube_map_face(strq))
    return (sc / major, -tc / major) if major > 0.0 else (0.0, 0.0)


def sample_made(strq, texture, sampler, operation, profile):
    """A texel at made coordinates: the base level. Measured: a cube map read as a volume (DotSTR3D)."""
    cube_map = texture.target == TextureTarget.TEXTURE_CUBE_MAP
    if operation.name.endswith("CUBE_MAP") and not cube_map:
        strq = (*on_any_face(strq), 0.0)
    flat = cube_map and operation == Operation.DOT_PRODUCT_TEXTURE_3D
    offset = operation.name.startswith("OFFSET")
    strq = (*strq[:3], 1.0)
    base, filter_mode = sampler.base_level, sampler.mag_filter
    return sample.sample_level(
        None, strq, texture, sampler, profile, base, filter_mode, flat=flat, offset=offset
    )
