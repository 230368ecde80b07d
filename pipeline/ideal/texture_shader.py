"""Texture shaders in real numbers: docs/numbers.md, section 12, without its roundings. The caller samples.

A stage's texel is float64 [k, 4], 1.0 = one. Where an operation reads its two's complement, or words of 16
bits, the number is the texel times 2**bits - 1: of a texture of floats it need not be whole. EXPAND_NORMAL
is 2 x - 1, as NV_texture_shader writes it.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.pipeline.enums import CullMode, DotProductMapping
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.ideal.signs import signed, signed_flags
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.programs.texture_shader_rules import CONVENTIONAL, WITHOUT_TEXTURE, shader_stages
from fixedpipe.pipeline.textures.sampled import sampled_texture
from fixedpipe.raster import codes as C

_PAIRS = {Operation.DEPENDENT_AR_TEXTURE_2D: (3, 0), Operation.DEPENDENT_GB_TEXTURE_2D: (1, 2)}
_OPAQUE_BLACK = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Outcome:
    """What the stages of k fragments leave.

    registers  of each texture unit, float64 [k, 4]
    alive      bool [k]: not discarded
    depth      float64 [k], in [0, 1]: the depth that replaces the fragments'; or None
    """

    registers: list[np.ndarray]
    alive: np.ndarray
    depth: np.ndarray | None


def run_stages(state, textures, count, own, conventional, made, register, change):
    """The Outcome of a pass's texture shader for ``count`` fragments.

    own(i)
        Unit i's coordinates (s, t, r, q), float64 [k, 4].
    conventional(i, unit, texture)
        Its texel at these.
    made(i, unit, texture, str_, r, lifted, axes)
        Its texel at coordinates that were made, float64 [k, 3]; ``r`` is what a comparison compares;
        ``lifted``: on a boundary between texels the upper one is nearest; ``axes``: of the ellipse that a
        lookup covers, in texture coordinates, float64 [2, k, 2], or None.
    register(texel, unit, internal_format)
        What its register receives of a texel.
    change(i)
        How unit i's coordinates change to the right and upwards, float64 [2, k, 4].
    """
    run = _Stages(shader_stages(state), count, own)
    for i, stage in enumerate(run.stages):
        unit, texel, seen, bits = (
            state.texture_units[i],
            np.zeros((count, 4)),
            None,
            IDEAL.arithmetic.texture_bits,
        )
        match stage.operation:
            case Operation.NONE:
                seen = np.broadcast_to(np.array(_OPAQUE_BLACK), (count, 4))
            case Operation.PASS_THROUGH:
                # The clamp is the operation's.  Source: NV_texture_shader, section 3.8.13.1.6.
                coordinates = own(i)
                texel = np.where(coordinates > 0.0, np.minimum(coordinates, 1.0), 0.0)
            case Operation.CULL_FRAGMENT:
                kept = np.array([mode is CullMode.LESS for mode in stage.cull_modes])
                run.alive &= ((own(i) < 0.0) == kept).all(axis=1)
            case Operation.DOT_PRODUCT_DEPTH_REPLACE:
                run.replace_depth(i)
            case Operation.DOT_PRODUCT:
                pass
            case operation:
                texture = sampled_texture(unit, textures)
                bits = texture.bits
                if operation in CONVENTIONAL:
                    texel = conventional(i, unit, texture)
                else:
                    texel = made(
                        i,
                        unit,
                        texture,
                        run.coordinates(i),
                        own(i)[:, 2],
                        operation not in C.OPERATIONS_WITH_OFFSET,
                        None if stage.roughness is None else run.axes(i, texture, change),
                    )
                # What is scaled is the register alone: later stages read the texel.
                scales = operation in C.OPERATIONS_WITH_SCALE
                seen = run.scaled(i, texel) if scales else register(texel, unit, texture.internal_format)
        run.registers.append(texel if seen is None else seen)
        run.keep(texel, bits, None if stage.operation in WITHOUT_TEXTURE else unit)
    return Outcome(run.registers, run.alive, run.depth)


class _Stages:
    """What the stages have left so far: ``texels`` of each, the signed ones as unsigned numbers."""

    def __init__(self, stages, count, own):
        self.stages, self.own = stages, own
        self.alive, self.depth = np.ones(count, bool), None
        self.registers, self.texels, self.bits = [], [], []

    def keep(self, texel, bits, unit):
        """A stage's texel for later stages: two's complement where its components are signed."""
        if unit is not None and any(flags := signed_flags(unit.sampler)):
            unsigned = texel + 2.0**bits / (2.0**bits - 1.0)
            texel = np.where(np.array(flags) & (texel < 0.0), unsigned, texel)
        self.texels.append(texel)
        self.bits.append(bits)

    def number(self, i, component):
        """A component of stage i's texel as a number of 0 to 2**bits - 1, float64 [k]."""
        return self.texels[i][:, component] * (2.0 ** self.bits[i] - 1.0)

    def words(self, i):
        """Stage i's texel as two words of 16 bits: alpha and red, green and blue."""
        red, green, blue, alpha = (self.number(i, k) for k in range(4))
        return 256.0 * alpha + red, 256.0 * green + blue

    def vector(self, i, mapping):
        """(x, y, z) that a dot product reads of stage i's texel, float64 [k] each."""
        if mapping in (DotProductMapping.UNSIGNED_HILO, DotProductMapping.SIGNED_HILO_HEMISPHERE):
            high, low = self.words(i)
            if mapping is DotProductMapping.UNSIGNED_HILO:
                return high / 65535.0, low / 65535.0, 1.0
            x, y = signed(high, 16) / 32767.0, signed(low, 16) / 32767.0
            return x, y, np.sqrt(np.maximum(0.0, (1.0 - x * x) - y * y))
        rgb, bits = self.texels[i][:, :3].T, self.bits[i]
        one = 2.0**bits - 1.0
        if mapping is DotProductMapping.SIGNED_ODD:
            return (2.0 * signed(rgb * one, bits) + 1.0) / one
        if mapping is DotProductMapping.SIGNED_IDENTITY:
            return signed(rgb * one, bits) / (2.0 ** (bits - 1) - 1.0)
        if mapping is DotProductMapping.EXPAND_NORMAL:
            return 2.0 * rgb - 1.0
        if mapping is DotProductMapping.UNSIGNED_IDENTITY:
            return rgb
        raise ValueError(f"The ideal machine has no dot product mapping {mapping.name}.")

    def dot_product(self, i):
        """Unit i's dot product, float64 [k]."""
        stage, own = self.stages[i], self.own(i)
        return _dot(own.T, self.vector(stage.previous_texture_input, stage.dot_product_mapping))

    def replace_depth(self, i):
        """Source: NV_texture_shader, section 3.8.13.1.21."""
        depth = self.dot_product(i - 1) / self.dot_product(i)
        inside = (depth >= 0.0) & (depth <= 1.0)  # false where it is not a number
        self.alive &= inside
        self.depth = np.where(inside, depth, 0.0)

    def scaled(self, i, texel):
        """Stage i's texel, its colours times the previous texel's magnitude; the factor's clamp is the
        operation's.  Source: NV_texture_shader, section 3.8.13.1.9.
        """
        stage = self.stages[i]
        magnitude = self.texels[stage.previous_texture_input][:, :1]
        factor = np.clip(magnitude * stage.offset_texture_scale + stage.offset_texture_bias, 0.0, 1.0)
        return np.concatenate([np.clip(texel[:, :3] * factor, 0.0, 1.0), texel[:, 3:]], axis=1)

    def axes(self, i, texture, change):
        """The axes, longer first, of what pixel and roughness cover of stage i's lookup, in texture
        coordinates, float64 [2, k, 2] (docs/numbers.md, section 12).
        """
        stage, size = self.stages[i], np.array([texture.width, texture.height], np.float64)
        of, scale = stage.roughness, 2.0 * stage.roughness_scale
        half = 2.0 ** (self.bits[of] - 1)
        d1, d3 = (self.texels[of][:, k] * scale for k in (0, 2))
        d2 = (self.number(of, 1) - half) / (half - 1.0) * scale
        if stage.operation in C.OPERATIONS_OF_TWO_DOT_PRODUCTS:
            sides = np.stack([change(k)[:, :, 2] for k in (i - 1, i)], axis=-1)
            u, v = (np.stack([self.own(k)[:, c] for k in (i - 1, i)], axis=-1) for c in (0, 1))
        else:
            sides = change(i)[:, :, :2]
            u, v = np.array(stage.offset_texture_matrix).reshape(2, 1, 2)
        rough = np.stack([d1[:, None] * u, d2[:, None] * u + d3[:, None] * v])
        sides = np.concatenate([sides, rough]) * size
        sides = np.where(np.isfinite(sides), sides, 0.0)
        a, b, c = ((sides[..., j] * sides[..., k]).sum(axis=0) for j, k in ((0, 0), (0, 1), (1, 1)))
        half, middle = 0.5 * (a - c), 0.5 * (a + c)
        root = np.hypot(half, b)
        axis = np.where(
            half[:, None] >= 0.0,
            np.stack([half + root, b], axis=1),
            np.stack([b, root - half], axis=1),
        )
        length = np.hypot(axis[:, 0], axis[:, 1])[:, None]
        axis = np.where(length > 0.0, axis / np.where(length > 0.0, length, 1.0), np.array([1.0, 0.0]))
        across = np.stack([-axis[:, 1], axis[:, 0]], axis=1)
        longer, shorter = np.sqrt(middle + root), np.sqrt(np.maximum(middle - root, 0.0))
        return np.stack([axis * longer[:, None], across * shorter[:, None]]) / size

    def coordinates(self, i):
        """The (s, t, r) that stage i makes, float64 [k, 3]."""
        stage, operation = self.stages[i], self.stages[i].operation
        previous, nothing = stage.previous_texture_input, np.zeros(len(self.alive))
        if operation in C.OPERATIONS_WITH_OFFSET:
            # In units of half a range.  Measured: BumpEnvMap captures (docs/numbers.md, section 12).
            ds, dt = (
                signed(self.number(previous, k), self.bits[previous]) / 2.0 ** (self.bits[previous] - 1)
                for k in (2, 1)
            )
            a1, a2, a3, a4 = stage.offset_texture_matrix
            own = self.own(i)
            made = own[:, 0] + a1 * ds + a3 * dt, own[:, 1] + a2 * ds + a4 * dt, nothing
        elif operation in _PAIRS:
            made = (*(self.texels[previous][:, k] for k in _PAIRS[operation]), nothing)
        elif operation is Operation.BRDF_TEXTURE_3D:
            (eye_theta, eye_phi), (light_theta, light_phi) = self.words(i - 2), self.words(i - 1)
            made = eye_theta / 65535.0, light_theta / 65535.0, (light_phi - eye_phi) / 65536.0
        elif operation in C.OPERATIONS_OF_TWO_DOT_PRODUCTS:
            made = self.dot_product(i - 1), self.dot_product(i), nothing
        elif operation is Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP:
            made = tuple(self.dot_product(k) for k in (i - 1, i, i + 1))
        elif operation in C.OPERATIONS_OF_THREE_DOT_PRODUCTS:
            made = tuple(self.dot_product(k) for k in (i - 2, i - 1, i))
            if operation in C.OPERATIONS_REFLECTING:
                eye = stage.constant_eye
                if operation is Operation.DOT_PRODUCT_REFLECT_CUBE_MAP:
                    eye = tuple(self.own(k)[:, 3] for k in (i - 2, i - 1, i))
                made = _reflected(made, eye)
        else:
            raise ValueError(f"The ideal machine makes no coordinates for {operation.name}.")
        return np.stack(made, axis=1)


def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _reflected(normal, eye):
    """``2 n (n e) - e (n n)``: the reflection vector times the square of the normal's length."""
    twice, square = 2.0 * _dot(normal, eye), _dot(normal, normal)
    return tuple(n * twice - e * square for n, e in zip(normal, eye, strict=True))
