"""Texture shaders in the column engine (docs/numbers.md, section 12): every stage in order, on columns.

Stages read texels as bytes, whatever their texture's width.
"""

import numpy as np

from pipeline.enums import CullMode, TextureTarget
from pipeline.enums import TextureShaderOperation as Operation
from pipeline.pack import CONVENTIONAL, shader_stages
from raster import wide, wide_shader

_WITH_OFFSET = (
    Operation.OFFSET_TEXTURE_2D,
    Operation.OFFSET_TEXTURE_2D_SCALE,
    Operation.OFFSET_TEXTURE_RECTANGLE,
    Operation.OFFSET_TEXTURE_RECTANGLE_SCALE,
)
_WITH_SCALE = (Operation.OFFSET_TEXTURE_2D_SCALE, Operation.OFFSET_TEXTURE_RECTANGLE_SCALE)
_BYTE = 255


class ShaderStages:
    """The stages of a FragmentColumns, run.

    registers  texture unit to its register, int64 [4, k] in units of ``bits``
    depth      int64 [k]: the fragments' depth words, -1 where one was discarded
    """

    def __init__(self, fragments, state, profile, framebuffer, samplers, bits):
        self._fragments, self._samplers = fragments, samplers
        self._stages = shader_stages(state)
        self._bytes, self.registers = [], {}
        self._alive, self.depth = np.ones(len(fragments.x), bool), fragments.depth
        self._largest = float((1 << framebuffer.depth_bits) - 1)
        self._units = 1.0 if profile.depth_units_in_coordinates else self._largest
        one = wide.one_of(bits)
        for i in range(len(self._stages)):
            register, texel = self._run(i, bits)
            self._bytes.append(texel)
            self.registers[i] = wide.convert(texel, _BYTE, one).T if register is None else register
        self.depth = np.where(self._alive, self.depth, -1)

    def _run(self, i, bits):
        """(stage i's register, None where its bytes say all; its texel as bytes)."""
        stage, count = self._stages[i], len(self._fragments.x)
        operation, nothing = stage.operation, np.zeros((count, 4), np.int64)
        if operation == Operation.NONE:
            nothing[:, 3] = _BYTE  # Measured: disabled units
            return None, nothing
        if operation == Operation.PASS_THROUGH:
            return None, wide_shader.real_byte(self._coordinates(i))
        if operation == Operation.CULL_FRAGMENT:
            less = np.array([mode == CullMode.LESS for mode in stage.cull_modes])
            self._alive &= ((self._coordinates(i) < 0.0) == less).all(axis=1)
            return None, nothing
        if operation == Operation.DOT_PRODUCT_DEPTH_REPLACE:
            products = self._dot_product(i - 1), self._dot_product(i)
            self.depth, inside = wide_shader.replaced_depth(*products, self._units, self._largest)
            self._alive &= inside
            return None, nothing
        if operation == Operation.DOT_PRODUCT:
            return None, nothing
        sampler = self._samplers[i]
        foreign = operation == Operation.TEXTURE_CUBE_MAP
        foreign &= sampler.texture.target != TextureTarget.TEXTURE_CUBE_MAP
        if operation in CONVENTIONAL and not foreign:
            texel = sampler.texel(self._fragments)
        else:
            made = self._coordinates(i)[:, :3] if foreign else self._made(i)
            texel = sampler.made(made, self._fragments, operation, operation in _WITH_OFFSET)
        if operation in _WITH_SCALE:
            previous = self._bytes[stage.previous_texture_input]
            scale = stage.offset_texture_scale, stage.offset_texture_bias
            texel = wide_shader.scaled(sampler.as_bytes(texel), previous[:, 0], *scale)
            return None, texel
        return sampler.as_register(texel, self._fragments, bits), sampler.as_bytes(texel)

    def _coordinates(self, i):
        return self._fragments.coordinates[:, i]

    def _dot_product(self, i):
        stage = self._stages[i]
        vector = wide_shader.mapped(self._bytes[stage.previous_texture_input], stage.dot_product_mapping)
        return wide_shader.dot(tuple(self._coordinates(i)[:, :3].T), vector)

    def _made(self, i):
        """(s, t, r) float64 [k, 3] of an access whose coordinates a stage makes."""
        stage, none = self._stages[i], np.zeros(len(self._fragments.x))
        operation, previous = stage.operation, self._bytes[stage.previous_texture_input]
        if operation in _WITH_OFFSET:
            s, t = (self._coordinates(i)[:, axis] for axis in (0, 1))
            found = (*wide_shader.offset(s, t, previous, stage.offset_texture_matrix), none)
        elif operation == Operation.DEPENDENT_AR_TEXTURE_2D:
            found = previous[:, 3] / 255.0, previous[:, 0] / 255.0, none
        elif operation == Operation.DEPENDENT_GB_TEXTURE_2D:
            found = previous[:, 1] / 255.0, previous[:, 2] / 255.0, none
        elif operation == Operation.BRDF_TEXTURE_3D:
            eye, light = (wide_shader.words(self._bytes[k]) for k in (i - 2, i - 1))
            found = eye[0] / 65535.0, light[0] / 65535.0, (light[1] - eye[1]) / 65536.0
        elif operation in (Operation.DOT_PRODUCT_TEXTURE_2D, Operation.DOT_PRODUCT_TEXTURE_RECTANGLE):
            found = self._dot_product(i - 1), self._dot_product(i), none
        elif operation == Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP:
            found = tuple(self._dot_product(k) for k in (i - 1, i, i + 1))
        else:
            found = tuple(self._dot_product(k) for k in (i - 2, i - 1, i))
            if operation == Operation.DOT_PRODUCT_REFLECT_CUBE_MAP:
                eye = tuple(self._coordinates(k)[:, 3] for k in (i - 2, i - 1, i))
                found = wide_shader.reflected(found, eye)
            elif operation == Operation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP:
                found = wide_shader.reflected(found, tuple(float(e) for e in stage.constant_eye))
        return np.stack(np.broadcast_arrays(*found), axis=1).astype(np.float64)
