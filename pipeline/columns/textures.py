"""How the column engine samples a texture unit. It reads the unit's state once; texels have any width."""

from copy import copy
from dataclasses import astuple

import numpy as np

from fixedpipe.pipeline.enums import (
    ColorKeyOperation,
    MagnificationThreshold,
    TextureCompareMode,
    TextureTarget,
)
from fixedpipe.pipeline.framebuffers.transfer_steps import ENTRY_COMPONENTS, table_entries
from fixedpipe.pipeline.profiles.profile import NATIVE_BITS
from fixedpipe.pipeline.programs.texture_shader_rules import killing_units
from fixedpipe.pipeline.textures.images import (
    BASE_FORMAT,
    COLORLESS_FORMATS,
    DEPTH_TEXELS,
    FORMATS_OF_WORDS,
    border_components,
    depth_texels,
    depth_texture_mode,
    register_components,
    with_signs,
)
from fixedpipe.pipeline.textures.sampled import face_modes, key_unit, sampled_texture
from fixedpipe.raster import codes as C
from fixedpipe.raster.columns import numbers, sample
from fixedpipe.raster.columns.interpolate import divide_by_q, times_reciprocal_of_q
from fixedpipe.raster.columns.numbers import INTEGERS, NOISE, REALS
from fixedpipe.raster.observer import unobserved
from fixedpipe.raster.pixels.transfer import texture_color_table

LAMBDA_BITS = 8


def _codes(level, one):
    """Real texels in units of ``one``. A texel that equals a code becomes exactly that code, without the
    division's error.
    """
    found = level * float(one)
    whole = np.rint(found)
    return np.where(np.abs(found - whole) < NOISE, whole, found)


def unit_samplers(state, textures, profile, observe=unobserved):
    """A UnitSampler for each texture unit; None for a unit that reads no texture. ``observe``:
    the observer.
    """
    return [
        None
        if unit is None or unit.texture is None
        else UnitSampler(number, unit, sampled_texture(unit, textures), profile, observe)
        for number, unit in enumerate(with_signs(state, textures).texture_units)
    ]


def key_samplers(state, textures, profile):
    """(number, UnitSampler) for each unit whose color key discards fragments. Its texel is 0
    where it does.
    """
    found = []
    for number in killing_units(state):
        unit, texture = key_unit(state.texture_units[number], textures)
        found.append((number, UnitSampler(number, unit, texture, profile)))
    return found


def reads_as_columns(unit, textures):
    """Whether only columns can sample a texture unit.

    They alone have color tables, color keys that discard fragments, and borders. For texels wider than bytes,
    the kernels have plain filters only.
    """
    key = unit.color_key
    if unit.color_table is not None or (key is not None and key.operation == ColorKeyOperation.KILL):
        return True
    if unit.texture is None:
        return False
    texture = textures[unit.texture]
    if texture.border or texture.bits == NATIVE_BITS:
        return texture.border > 0
    sampler = unit.sampler
    return (
        sampler.max_anisotropy > 1
        or sampler.max_probes > 1
        or sampler.compare_mode != TextureCompareMode.NONE
        or astuple(sampler.signed_components) != (False,) * 4
        or texture.internal_format in FORMATS_OF_WORDS
    )


class UnitSampler:
    """Texture unit ``number``, and how it makes its register (docs/numbers.md, sections 6 and 7).

    texture, sampler  the Texture and its Sampler
    sizes             the factors of s, t and r for level 0
    needs_lambda      whether filters differ between levels, or between magnification and minification
    """

    def __init__(self, number, unit, texture, profile, observe=unobserved):
        self._saw = observe
        self.number, self.unit, self.texture, self.sampler = number, unit, texture, unit.sampler
        self.fraction_bits = profile.arithmetic.filter_fraction_bits
        self.bits, self.one = texture.bits, numbers.one_of(texture.bits)
        width, height = float(texture.width), float(texture.height)
        self.sizes = {
            TextureTarget.TEXTURE_1D: (width, 0.0, 0.0),
            TextureTarget.TEXTURE_3D: (width, height, float(texture.depth)),
            TextureTarget.TEXTURE_RECTANGLE: (1.0, 1.0, 0.0),
        }.get(texture.target, (width, height, 0.0))
        s = self.sampler
        self.levels = texture.levels[: s.max_level - s.base_level + 1]
        self.anisotropic, self.probes = s.max_anisotropy > 1, s.max_probes > 1
        self.needs_lambda = s.min_filter != s.mag_filter
        opengl_c = profile.arithmetic.magnification_threshold == MagnificationThreshold.OPENGL_C
        self.threshold = 128 if opengl_c and s.magnifies_late else 0
        self.depth_scale = 1.0
        self.compares = s.compare_mode != TextureCompareMode.NONE
        if self.compares:
            self.words = DEPTH_TEXELS[texture.internal_format]
            self.depth_scale = (
                1.0 if profile.textures.depth_units_in_coordinates else float(self.words.largest)
            )
            base, failed = depth_texture_mode(s, profile), numbers.fixed(s.compare_fail_value, self.one)
            self.compared = [
                register_components(np.array([value], np.int64), base, self.one)
                for value in (self.one, failed)
            ]
        self.hilo = texture.internal_format in FORMATS_OF_WORDS
        self.colorless = texture.internal_format in COLORLESS_FORMATS and not profile.textures.hilo_as_color
        self.signed = self._signed()
        self.table = None
        if (given := unit.color_table) is not None:
            self.table = table_entries(given, profile), ENTRY_COMPONENTS[given.base_format]
        self.numbers, self.real_texels = INTEGERS, False
        if self.compares:
            depth = numbers.fixed(s.border_color[0], self.words.largest)
            self.border = depth_texels(depth[None, None])[0, 0].astype(np.int64)
        else:
            base, as_given = BASE_FORMAT[texture.internal_format], profile.textures.border_color_as_given
            border = numbers.fixed(s.border_color, self.one)
            self.border = border_components(border, base, self.one, as_given=as_given)

    def exactly(self, fraction_bits=None, levels=None):
        """The same unit in real numbers, unobserved. Lambda keeps its 8 fraction bits.

        fraction_bits  the bits of a filter's fractions; None: fractions are not rounded either
        levels         real texels in place of the texture's, which may lie outside [0, 1]. A depth
                       comparison's reference is then not rounded either

        Returns None if the unit has no real numbers: with a color table, or with real depths for a float
        format.
        """
        if self.table is not None or (levels is not None and self.compares and self.words.form is not None):
            return None
        unit = copy(self)
        unit.numbers, unit.fraction_bits, unit._saw = REALS, fraction_bits, unobserved
        if levels is not None:
            unit.levels = tuple(_codes(level, self.one) for level in levels[: len(self.levels)])
            unit.real_texels = True
            if self.compares:
                unit.border = np.full(4, np.clip(self.sampler.border_color[0], 0.0, 1.0) * self.one)
        return unit

    def _signed(self):
        flags = self.sampler.signed_components
        flags = [flags.red, flags.green, flags.blue, flags.alpha]
        if self.hilo:  # a word's sign is its high byte's
            flags = [False, flags[1], False, flags[3]]
        return np.array(flags) if any(flags) else None

    def _as_signed(self, texels):
        """Texels, with signed components read as two's complement."""
        if self.signed is None:
            return texels
        return np.where(self.signed & (texels >= 1 << (self.bits - 1)), texels - (1 << self.bits), texels)

    def register(self, fragments, bits, tap=None):
        """The unit's register, [4, k] in units of ``bits``: int64, or float64 in reals.

        ``tap``: take one texel of the filter, (level, layer, row, column), 0 or 1 each.
        """
        self._saw("sampled", sampler=self, fragments=fragments, bits=bits)
        return self.as_register(self.filtered(fragments, tap)[:, :4], fragments, bits)

    def looked_up(self, strq, fragments, bits):
        """The register at other coordinates, float64 [k, 4]: level 0, with the magnification filter."""
        return self.as_register(self.at_level_zero(strq, strq[:, 2]), fragments, bits)

    def at_level_zero(self, strq, r, lifted=True, flat=False):
        """Level 0 at coordinates that a stage made, float64 [k, 3 or 4], with the magnification filter: int64
        [k, 4].

        r       float64 [k], the reference of a depth comparison
        lifted  whether the bias of computed coordinates is added
        flat    whether s and t address a cube map's first face
        """
        compared = self._compared(strq, r)
        linear = self.sampler.mag_filter.is_linear
        return self._level(0, linear, strq, compared, lifted, flat=flat)

    def at_footprints(self, strq, r, lifted, footprint, lod):
        """As ``at_level_zero``, but with a footprint and a lambda.

        footprint  (along s, along t, probes), [k, 3]
        lod        lambda without bias, int64 [k], with 8 fraction bits
        """
        compared, lod = self._compared(strq, r), self._limited(lod)
        if self.probes:
            return self._assembled(footprint, strq, lifted, lod, compared)
        return self._levels(strq, lod, compared, lifted)

    def _compared(self, strq, r):
        """The reference that texels at such coordinates are compared with; None: no comparison."""
        if not self.compares:
            return None
        if self.sampler.compare_mode != TextureCompareMode.COMPARE_R_TO_TEXTURE:
            r = np.zeros(len(strq))
        return self._reference(r)

    def _reference(self, r):
        """The reference of a depth comparison, as words. With real texels it stays a real number."""
        if self.real_texels:
            return np.clip(r * (self.depth_scale / self.words.largest), 0.0, 1.0) * self.one
        return sample.depth_reference(r * self.depth_scale, self.words.form, self.words.largest)

    def _limited(self, lod):
        """Lambda after the unit's bias, between the sampler's limits."""
        lod = lod + int(256.0 * float(self.unit.lod_bias))  # truncated
        low, high = (int(256 * float(limit)) for limit in (self.sampler.min_lod, self.sampler.max_lod))
        return np.minimum(np.maximum(lod, low), high)

    def fractions(self, fragments, level):
        """The filter's fractions between columns, rows, layers and levels, int64 [k, 4].

        ``level``: 0 for the lower, 1 for the upper of the filter's levels.
        """
        return self.filtered(fragments, (level, 0, 0, 0))[:, 4:]

    @property
    def linear(self):
        """Whether a filter reads several texels in a level."""
        return self.sampler.mag_filter.is_linear or self.sampler.min_filter.is_linear

    @property
    def between_levels(self):
        """Whether the minification filter reads two levels."""
        return self.sampler.min_filter.mipmap == C.MIPMAP_LINEAR

    def as_register(self, texel, fragments, bits):
        """The unit's register from its texels, [4, k]."""
        if self.number == 0 and fragments.texel_alpha is not None:
            alpha = numbers.convert(fragments.texel_alpha.astype(np.int64), 255, self.one)
            texel = np.concatenate([texel[:, :3], alpha[:, None]], axis=1)
        if self.table is not None:
            texel = texture_color_table(texel, self.one, *self.table)
        if self.signed is not None:  # Measured: 732800 of 732800 pixels (Texture_signed_component_tests)
            texel = np.where(self.signed, 2 * texel, texel)
        if self.colorless:
            texel = np.zeros_like(texel)
        register = self.numbers.convert(texel, self.one, numbers.one_of(bits)).T
        self._saw("texture", unit=self.number, texel=texel, one=self.one, register=register)
        return register

    def filtered(self, fragments, tap=None):
        """The texel of each fragment, [k, 4] in the texture's units. With a ``tap``, [k, 8]: its fractions
        follow.
        """
        strq = fragments.coordinates[:, self.number]
        divided = bool((strq[:, 3] != 1.0).any())
        if fragments.divided is not None:
            divided = fragments.divided[self.number]
        divided = divided and self.texture.target != TextureTarget.TEXTURE_CUBE_MAP
        if divided:
            str_ = times_reciprocal_of_q(strq) if self.numbers.rounds else divide_by_q(strq)
            self._saw("projected", unit=self.number, strq=strq, made=str_)
            strq = np.concatenate([str_, np.ones((len(str_), 1))], axis=1)
        compared = None
        if self.compares:
            r = np.zeros(len(strq))
            if self.sampler.compare_mode == TextureCompareMode.COMPARE_R_TO_TEXTURE:
                r = strq[:, 2]
            compared = self._reference(r)
        lifted = divided and not self.numbers.rounds  # over the noise of float64's quotients
        lod = np.zeros(len(strq), np.int64)
        if (self.needs_lambda or self.anisotropic or self.probes) and fragments.lod is not None:
            lod = self._limited(np.floor(fragments.lod[:, self.number] * 256.0).astype(np.int64))
            self._saw("lambda", unit=self.number, lod=fragments.lod[:, self.number], limited=lod)
        elif self.needs_lambda:
            lod = np.full(len(strq), -1)  # magnified
        if fragments.footprints is None or not (self.anisotropic or self.probes):
            return self._levels(strq, lod, compared, lifted, tap=tap)
        filtered = self._assembled if self.probes else self._along
        return filtered(fragments.footprints[:, self.number], strq, lifted, lod, compared)

    def _assembled(self, footprint, str_, lifted, lod, compared):
        """The mean of a footprint's probes, truncated."""
        total, probes = np.zeros((len(str_), 4), self.numbers.dtype), footprint[:, 2]
        for probe in range(int(probes.max(initial=1.0))):
            used = probe < probes
            moved = str_.copy()
            distance = ((2.0 * probe + 1.0) - probes) / (2.0 * probes)
            moved[:, :2] += distance[:, None] * footprint[:, :2]
            texel = self._levels(moved, lod, compared, lifted)
            total += np.where(used[:, None], texel, 0)
        return self.numbers.shared(total, probes.astype(np.int64)[:, None])

    def _along(self, footprint, str_, lifted, lod, compared):
        """A texel with an anisotropic filter: pairs of texels along the footprint."""
        total = np.full((len(str_), 4), 128 if self.numbers.rounds else 0, self.numbers.dtype)
        for pair in range(int(np.ceil(float(self.sampler.max_anisotropy) * 0.5))):
            distance, weight = sample.taps(footprint[:, 2], pair)
            used = weight != 0  # the outermost pair takes the remaining weight, which may be less than 0
            for side in (1.0, -1.0):
                moved = str_.copy()
                moved[:, :2] += (side * distance)[:, None] * footprint[:, :2]
                texel = self._levels(moved, lod, compared, lifted)
                total += np.where(used[:, None], weight[:, None] * texel, 0)
        return self.numbers.shared(total, 256)

    def _levels(self, strq, lod, compared, lifted=False, tap=None):
        """The level that lambda selects, or a blend of two levels (section 7)."""
        s = self.sampler

        def level(number, linear, chosen):
            reference = None if compared is None else compared[chosen]
            self._saw("chosen", unit=self.number, chosen=chosen)
            return self._level(number, linear, strq[chosen], reference, lifted, tap and tap[1:])

        every = slice(None)
        magnifies_linear = s.mag_filter.is_linear
        if s.min_filter == s.mag_filter:
            return level(0, magnifies_linear, every)
        linear = s.min_filter.is_linear
        out = np.zeros((len(strq), 4 if tap is None else 8), self.numbers.dtype)
        magnified = lod <= self.threshold
        if magnified.any():
            out[magnified] = level(0, magnifies_linear, magnified)
        minified = ~magnified
        if not minified.any():
            return out
        if s.min_filter.mipmap == C.MIPMAP_NONE:
            out[minified] = level(0, linear, minified)
            return out
        last = len(self.levels) - 1
        lod = np.clip(lod, 0, 256 * last)
        nearest = s.min_filter.mipmap == C.MIPMAP_NEAREST
        lower = (lod + 127) >> 8 if nearest else lod >> 8
        upper = lower if nearest else np.minimum(lower + 1, last)
        fraction = (lod & 255)[:, None]
        pair = np.zeros((2, *out.shape), out.dtype)
        for number in range(last + 1):
            for side, wanted in enumerate((lower, upper)):
                chosen = minified & (wanted == number)
                if chosen.any() and not (nearest and side):
                    pair[side, chosen] = level(number, linear, chosen)
        if tap is not None:
            pair[..., 7:] = 0 if nearest else fraction
            out[minified] = pair[0 if nearest else tap[0], minified]
            return out
        blended = pair[0] if nearest else self.numbers.lerp(pair[0], pair[1], fraction, LAMBDA_BITS)
        self._saw("levels", unit=self.number, lower=lower, upper=upper, fraction=fraction, blended=minified)
        out[minified] = blended[minified]
        return out

    def _level(self, number, linear, strq, reference, lifted, tap=None, flat=False):
        image, s, target = self.levels[number], self.sampler, self.texture.target
        layers, height, width = image.shape[:3]
        size = tuple(n - 2 * b for n, b in zip((width, height, layers), self.texture.borders, strict=True))
        places, face = sample.positions(strq, target, lifted, size, flat)
        modes = s.wrap_s, s.wrap_t, s.wrap_r
        if target == TextureTarget.TEXTURE_CUBE_MAP:
            modes = face_modes(s, self.texture)
        self._saw(
            "level", unit=self.number, level=number, linear=linear, strq=strq, size=size, places=places,
            face=face, reference=reference,
        )  # fmt: skip
        read = None if self.signed is None else self._as_signed
        if reference is not None:
            read = sample.comparison(reference, s.compare_function, *self.compared)
        elif self.hilo and self.numbers.rounds:  # in real numbers, a word's bytes are filtered like the word
            return self._hilo(image, places, face, modes, linear, target)
        return sample.filter_level(
            image, places, face, modes, linear, target, self.border, self.fraction_bits, read, tap, self._saw,
            self.texture.border, self.numbers,
        )  # fmt: skip

    def _hilo(self, image, places, face, modes, linear, target):
        """Two words of 16 bits, filtered as words, as four bytes (section 12)."""

        def words(texels):
            texels = texels & 255
            pair = np.stack([texels[:, 3] << 8 | texels[:, 0], texels[:, 1] << 8 | texels[:, 2]], axis=1)
            if self.signed is not None:
                pair = np.where(self.signed[[3, 1]] & (pair >= 1 << 15), pair - (1 << 16), pair)
            return pair

        found = sample.filter_level(
            image, places, face, modes, linear, target, self.border, self.fraction_bits, words,
            observe=self._saw, beside=self.texture.border,
        )  # fmt: skip
        bytes_ = np.stack([found[:, 0], found[:, 1] >> 8, found[:, 1], found[:, 0] >> 8], axis=1) & 255
        return self._as_signed(bytes_)
