"""Texture shaders in the column engine: the stages of a pass, one after the other, on fragments' columns."""

import numpy as np

from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.pipeline.programs.texture_shader_rules import CONVENTIONAL, shader_stages
from fixedpipe.pipeline.textures.depth_words import DEPTH_WORDS
from fixedpipe.raster import codes as C
from fixedpipe.raster.columns import numbers, texture_shader
from fixedpipe.raster.witness import nobody


def run_stages(fragments, state, profile, framebuffer, samplers, bits, saw=nobody):
    """Every unit's register, by its number, int64 [4, k] in units of ``bits``, and the fragments' depths,
    below 0 where a stage discarded them (docs/numbers.md, section 12).
    """
    run = _StageRun(fragments, state, profile, framebuffer, samplers, bits, saw)
    for i in range(len(run.stages)):
        run.stage(i)
    return run.registers, np.where(run.alive, run.depth, -1)


class _StageRun:
    """What stages have left so far: ``texels`` of each, 0..one of its ``widths``."""

    def __init__(self, fragments, state, profile, framebuffer, samplers, bits, saw):
        self._saw = saw
        self.fragments, self.samplers, self.bits = fragments, samplers, bits
        self.stages, self.real_bits = shader_stages(state), profile.arithmetic.texture_bits
        self.largest = DEPTH_WORDS[framebuffer.depth_format].largest
        self.depth_scale = 1.0 if profile.textures.depth_units_in_coordinates else float(self.largest)
        self.largest_scale = 1.0 if profile.texture_shaders.offset_scale_clamped else np.inf
        self.depth, self.alive = fragments.depth, np.ones(len(fragments.x), bool)
        self.registers, self.texels, self.widths = {}, [], []

    def stage(self, i):
        """Run stage i."""
        operation, count, width = self.stages[i].operation, len(self.alive), self.real_bits
        sampler, own = self.samplers[i], self.fragments.coordinates[:, i]
        texel = register = np.zeros((count, 4), np.int64)
        if operation == Operation.NONE:
            register = np.broadcast_to(np.array([0, 0, 0, numbers.one_of(self.bits)]), (count, 4))
        elif operation == Operation.PASS_THROUGH:
            texel = texture_shader.real_texel(own, width)
            register = numbers.convert(texel, numbers.one_of(width), numbers.one_of(self.bits))
        elif operation == Operation.CULL_FRAGMENT:
            self.alive &= texture_shader.kept(own, self.stages[i].cull_modes)
        elif operation == Operation.DOT_PRODUCT_DEPTH_REPLACE:
            dots = self.dot_product(i - 1), self.dot_product(i)
            self.depth, inside = texture_shader.replaced_depth(*dots, self.depth_scale, self.largest)
            self.alive &= inside
        elif operation != Operation.DOT_PRODUCT:
            width = sampler.bits
            texel = self._texel(i)
            register = sampler.as_register(texel, self.fragments, self.bits).T
            texel = texel & sampler.one
            if operation in C.OPERATIONS_WITH_SCALE:
                stage = self.stages[i]
                of = stage.previous_texture_input
                magnitude = self.texels[of][:, 0], self.widths[of]
                factors = stage.offset_texture_scale, stage.offset_texture_bias, self.largest_scale
                # Of the register alone: later stages read the texel.
                shown = texture_shader.scaled(texel, width, *magnitude, *factors)
                register = numbers.convert(shown, sampler.one, numbers.one_of(self.bits))
        self._saw(
            "texture shader", unit=i, stage=self.stages[i], coordinates=own, texel=texel, width=width,
            register=register.T, depth=self.depth, alive=self.alive.copy(),
        )  # fmt: skip
        self.registers[i] = np.ascontiguousarray(register.T)
        self.texels.append(texel)
        self.widths.append(width)

    def _texel(self, i):
        """A unit's filtered texel, its signed components below 0 where they are."""
        operation, sampler = self.stages[i].operation, self.samplers[i]
        own, target = self.fragments.coordinates[:, i], sampler.texture.target
        cube_map = target == TextureTarget.TEXTURE_CUBE_MAP
        if operation not in CONVENTIONAL:
            strq = self._made(i)
            self._saw("made coordinates", unit=i, strq=strq)
        elif operation == Operation.TEXTURE_CUBE_MAP and not cube_map:
            strq = own[:, :3]
        else:
            return sampler.filtered(self.fragments)
        if operation in C.OPERATIONS_OF_DIRECTIONS and not cube_map:
            strq = texture_shader.face_planes(strq)
        if self.stages[i].roughness is not None:
            return sampler.at_footprints(
                strq, own[:, 2], operation not in C.OPERATIONS_WITH_OFFSET, *self._rough(i)
            )
        flat = cube_map and operation == Operation.DOT_PRODUCT_TEXTURE_3D
        return sampler.at_level_zero(strq, own[:, 2], operation not in C.OPERATIONS_WITH_OFFSET, flat)

    def _rough(self, i):
        """Stage i's footprints and lambdas, of the pixel and of the roughness that it reads."""
        stage, sampler, coordinates = self.stages[i], self.samplers[i], self.fragments.coordinates
        of = stage.roughness
        found = texture_shader.deviations(self.texels[of], self.widths[of], stage.roughness_scale)
        if stage.operation in C.OPERATIONS_OF_TWO_DOT_PRODUCTS:
            jacobian = tuple(coordinates[:, k, c] for k in (i - 1, i) for c in (0, 1))
        else:
            a1, a2, a3, a4 = (float(a) for a in stage.offset_texture_matrix)
            jacobian = a1, a3, a2, a4
        sides, most = self.fragments.sides[:, i], (sampler.sampler.max_probes, sampler.sampler.exact_probes)
        return texture_shader.rough_footprint(sides, jacobian, found, sampler.sizes, *most)

    def _made(self, i):
        """Coordinates (s, t, r) that stage i makes, float64 [k, 3]."""
        stage, operation = self.stages[i], self.stages[i].operation
        nothing, previous = np.zeros(len(self.alive)), stage.previous_texture_input
        if operation == Operation.BRDF_TEXTURE_3D:
            made = texture_shader.brdf(self.texels[i - 2], self.texels[i - 1])
        elif operation in C.OPERATIONS_WITH_OFFSET:
            given, width = self.texels[previous], self.widths[previous]
            own = self.fragments.coordinates[:, i]
            made = (*texture_shader.offset(own, given, stage.offset_texture_matrix, width), nothing)
        elif operation in C.DEPENDENT_OPERATIONS:
            pair = (3, 0) if operation == Operation.DEPENDENT_AR_TEXTURE_2D else (1, 2)
            one = float(numbers.one_of(self.widths[previous]))
            made = (*(self.texels[previous][:, k] / one for k in pair), nothing)
        elif operation in C.OPERATIONS_OF_TWO_DOT_PRODUCTS:
            made = self.dot_product(i - 1), self.dot_product(i), nothing
        elif operation == Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP:
            made = tuple(self.dot_product(k) for k in (i - 1, i, i + 1))
        elif operation in C.OPERATIONS_OF_THREE_DOT_PRODUCTS:
            made = tuple(self.dot_product(k) for k in (i - 2, i - 1, i))
            if operation == Operation.DOT_PRODUCT_REFLECT_CUBE_MAP:
                eye = tuple(self.fragments.coordinates[:, k, 3] for k in (i - 2, i - 1, i))
                made = texture_shader.reflected(made, eye)
            elif operation == Operation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP:
                made = texture_shader.reflected(made, tuple(float(e) for e in stage.constant_eye))
        else:
            raise ValueError(f"{operation!r} makes no coordinates.")
        return np.stack(made, axis=1)

    def dot_product(self, i):
        """Unit i's dot product, float64 [k]."""
        previous, mapping = self.stages[i].previous_texture_input, self.stages[i].dot_product_mapping
        own = self.fragments.coordinates[:, i].T
        vector = texture_shader.vector(self.texels[previous], mapping, self.widths[previous])
        found = texture_shader.dot(own, vector)
        self._saw("dot product", unit=i, of=previous, own=own, vector=vector, product=found)
        return found
