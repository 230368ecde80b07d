"""Texture shaders: the stages of a pass, one after the other, on fragments' columns.

A stage computes with a module of ``fixedpipe.raster.columns``: ``texture_shader`` has a machine's numbers,
``real_texture_shader`` the ideal's. Both have the same functions.
"""

from copy import copy
from dataclasses import astuple
from functools import cache

import numpy as np

from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.pipeline.programs.texture_shader_rules import CONVENTIONAL, shader_stages
from fixedpipe.pipeline.textures.depth_words import DEPTH_WORDS
from fixedpipe.raster import codes as C
from fixedpipe.raster.columns import real_texture_shader, texture_shader
from fixedpipe.raster.observer import unobserved


def run_stages(fragments, state, profile, framebuffer, samplers, bits, observe=unobserved):
    """Run a pass's texture shader (docs/numbers.md, section 12): the registers and the depths.

    The registers are every unit's by its number, int64 [4, k] in units of ``bits``. A depth is below 0 where
    a stage discarded the fragment.
    """
    largest = DEPTH_WORDS[framebuffer.depth_format].largest
    run = StageRun(
        shader_stages(state),
        len(fragments.x),
        lambda i: fragments.coordinates[:, i],
        lambda i: fragments.sides[:, i],
        [None if sampler is None else SampledUnit(sampler, fragments) for sampler in samplers],
        profile,
        bits,
        (1.0 if profile.textures.depth_units_in_coordinates else float(largest), largest),
        observe,
    )
    run.depth = fragments.depth
    run.all_stages()
    registers = {i: np.ascontiguousarray(register.T) for i, register in enumerate(run.registers)}
    return registers, np.where(run.alive, run.depth, -1)


class SampledUnit:
    """A texture unit at fragments, with the functions that StageRun calls: the texels of a UnitSampler."""

    def __init__(self, sampler, fragments):
        self.unit, self.fragments, self.sampler = sampler, fragments, sampler.sampler
        self.bits, self.sizes, self.target = sampler.bits, sampler.sizes, sampler.texture.target
        self.at_level_zero, self.at_footprints = sampler.at_level_zero, sampler.at_footprints
        self.signed = astuple(sampler.sampler.signed_components)

    def filtered(self):
        """The texel at the unit's own coordinates, [k, 4]."""
        return self.unit.filtered(self.fragments)

    def register(self, texel, bits):
        """The unit's register from a texel, [k, 4]."""
        return self.unit.as_register(texel, self.fragments, bits).T


class StageRun:
    """The stages of a texture shader, and their results so far: ``registers``, ``texels`` and ``widths``.

    A stage's texels are 0 to one of its width.

    stages      the pass's stages, one for every unit
    own         from a unit's number, its coordinates (s, t, r, q), float64 [k, 4]
    sides       from a unit's number, float64 [k, 4]: for a lookup filtered by roughness, the pixel's steps in
                texels to the right (s, t) and downwards
    units       for each unit a SampledUnit, or an object with its functions; None: the unit reads no texture
    bits        the registers' width
    depths      the factor of a replaced depth, and the largest depth
    arithmetic  ``texture_shader`` or ``real_texture_shader``
    """

    def __init__(
        self,
        stages,
        count,
        own,
        sides,
        units,
        profile,
        bits,
        depths,
        observe=unobserved,
        arithmetic=texture_shader,
    ):
        self._saw, self.arithmetic = observe, arithmetic
        self.stages, self.own, self.sides, self.units = stages, cache(own), sides, units
        self.bits, self.real_bits, self.depths = bits, profile.arithmetic.texture_bits, depths
        self.largest_scale = 1.0 if profile.texture_shaders.offset_scale_clamped else np.inf
        self.depth, self.alive = None, np.ones(count, bool)
        self.registers, self.texels, self.widths = [], [], []

    def in_reals(self):
        """The same run in real numbers, on the texels so far, unobserved."""
        run, widths = copy(self), zip(self.texels, self.widths, strict=True)
        run.arithmetic, run._saw = real_texture_shader, unobserved
        run.texels = [texel / self.arithmetic.one_of(width) for texel, width in widths]
        return run

    def with_unit(self, i, sampler):
        """The same run, unobserved, with another UnitSampler for unit i."""
        run = copy(self)
        run._saw, run.units = unobserved, list(self.units)
        run.units[i] = SampledUnit(sampler, self.units[i].fragments)
        return run

    def all_stages(self):
        """Run every stage."""
        for i in range(len(self.stages)):
            self.stage(i)

    def stage(self, i):
        """Run stage i."""
        stage, operation, own = self.stages[i], self.stages[i].operation, self.own
        unit, arithmetic, count, width = self.units[i], self.arithmetic, len(self.alive), self.real_bits
        texel = register = np.zeros((count, 4), arithmetic.DTYPE)
        if operation == Operation.NONE:
            register = np.broadcast_to(np.array([0, 0, 0, arithmetic.one_of(self.bits)]), (count, 4))
        elif operation == Operation.PASS_THROUGH:
            texel = arithmetic.real_texel(own(i), width)
            register = arithmetic.convert(texel, width, self.bits)
        elif operation == Operation.CULL_FRAGMENT:
            self.alive &= texture_shader.kept(own(i), stage.cull_modes)
        elif operation == Operation.DOT_PRODUCT_DEPTH_REPLACE:
            dots = self.dot_product(i - 1), self.dot_product(i)
            self.depth, inside = arithmetic.replaced_depth(*dots, *self.depths)
            self.alive &= inside
        elif operation != Operation.DOT_PRODUCT:
            width = unit.bits
            texel = self.texel(i)
            register = unit.register(texel, self.bits)
            texel = arithmetic.unsigned(texel, unit.signed, width)
            if operation in C.OPERATIONS_WITH_SCALE:
                of = stage.previous_texture_input
                magnitude = self.texels[of][:, 0], self.widths[of]
                factors = stage.offset_texture_scale, stage.offset_texture_bias, self.largest_scale
                # The scale applies to the register alone: later stages read the texel.
                shown = arithmetic.scaled(texel, width, *magnitude, *factors)
                register = arithmetic.convert(shown, width, self.bits)
        if self._saw is not unobserved:
            self._saw(
                "texture shader", unit=i, stage=stage, coordinates=own(i), texel=texel, width=width,
                register=register.T, depth=self.depth, alive=self.alive.copy(), run=self,
            )  # fmt: skip
        self.registers.append(register)
        self.texels.append(texel)
        self.widths.append(width)

    def texel(self, i):
        """A unit's filtered texel; a signed component may be below 0."""
        stage, operation, unit = self.stages[i], self.stages[i].operation, self.units[i]
        cube_map = unit.target == TextureTarget.TEXTURE_CUBE_MAP
        if operation not in CONVENTIONAL:
            strq = self.made(i)
            self._saw("made coordinates", unit=i, strq=strq)
        elif operation == Operation.TEXTURE_CUBE_MAP and not cube_map:
            strq = self.own(i)[:, :3]
        else:
            return unit.filtered()
        return self.looked_up(i, strq, () if stage.roughness is None else self.footprint(i))

    def looked_up(self, i, strq, footprint):
        """A unit's texel at coordinates [k, 3] that a stage made."""
        operation, unit, r = self.stages[i].operation, self.units[i], self.own(i)[:, 2]
        cube_map = unit.target == TextureTarget.TEXTURE_CUBE_MAP
        if operation in C.OPERATIONS_OF_DIRECTIONS and not cube_map:
            strq = texture_shader.face_planes(strq)
        lifted = operation not in C.OPERATIONS_WITH_OFFSET
        if footprint:
            return unit.at_footprints(strq, r, lifted, *footprint)
        return unit.at_level_zero(strq, r, lifted, cube_map and operation == Operation.DOT_PRODUCT_TEXTURE_3D)

    def footprint(self, i):
        """The footprint of the pixel and the roughness that stage i reads, as ``at_footprints`` takes it."""
        stage, unit = self.stages[i], self.units[i]
        of = stage.roughness
        found = self.arithmetic.deviations(self.texels[of], self.widths[of], stage.roughness_scale)
        if stage.operation in C.OPERATIONS_OF_TWO_DOT_PRODUCTS:
            jacobian = tuple(self.own(k)[:, c] for k in (i - 1, i) for c in (0, 1))
        else:
            a1, a2, a3, a4 = (float(a) for a in stage.offset_texture_matrix)
            jacobian = a1, a3, a2, a4
        most = unit.sampler.max_probes, unit.sampler.exact_probes
        return self.arithmetic.rough_footprint(self.sides(i), jacobian, found, unit.sizes, *most)

    def made(self, i):
        """Coordinates (s, t, r) that stage i makes, float64 [k, 3]."""
        stage, operation, arithmetic = self.stages[i], self.stages[i].operation, self.arithmetic
        nothing, previous = np.zeros(len(self.alive)), stage.previous_texture_input
        if operation == Operation.BRDF_TEXTURE_3D:
            (theta, phi), (light_theta, light_phi) = map(arithmetic.words, self.texels[i - 2 : i])
            made = theta / 65535.0, light_theta / 65535.0, (light_phi - phi) / 65536.0
        elif operation in C.OPERATIONS_WITH_OFFSET:
            given, width = self.texels[previous], self.widths[previous]
            made = (*arithmetic.offset(self.own(i), given, stage.offset_texture_matrix, width), nothing)
        elif operation in C.DEPENDENT_OPERATIONS:
            pair = (3, 0) if operation == Operation.DEPENDENT_AR_TEXTURE_2D else (1, 2)
            one = float(arithmetic.one_of(self.widths[previous]))
            made = (*(self.texels[previous][:, k] / one for k in pair), nothing)
        elif operation in C.OPERATIONS_OF_TWO_DOT_PRODUCTS:
            made = self.dot_product(i - 1), self.dot_product(i), nothing
        elif operation == Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP:
            made = tuple(self.dot_product(k) for k in (i - 1, i, i + 1))
        elif operation in C.OPERATIONS_OF_THREE_DOT_PRODUCTS:
            made = tuple(self.dot_product(k) for k in (i - 2, i - 1, i))
            if operation == Operation.DOT_PRODUCT_REFLECT_CUBE_MAP:
                eye = tuple(self.own(k)[:, 3] for k in (i - 2, i - 1, i))
                made = texture_shader.reflected(made, eye, arithmetic.dot)
            elif operation == Operation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP:
                eye = tuple(float(e) for e in stage.constant_eye)
                made = texture_shader.reflected(made, eye, arithmetic.dot)
        else:
            raise ValueError(f"{operation!r} makes no coordinates.")
        return np.stack(made, axis=1)

    def dot_product(self, i):
        """Unit i's dot product, float64 [k]."""
        previous, mapping = self.stages[i].previous_texture_input, self.stages[i].dot_product_mapping
        own = self.own(i).T
        vector = self.arithmetic.vector(self.texels[previous], mapping, self.widths[previous])
        found = self.arithmetic.dot(own, vector)
        self._saw("dot product", unit=i, of=previous, own=own, vector=vector, product=found)
        return found
