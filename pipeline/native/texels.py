"""Textures in the form that kernels read; each is packed once, and its texels are kept while it lives."""

import weakref
from functools import cached_property

import numpy as np

from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.pipeline.profiles.profile import NATIVE_BITS
from fixedpipe.raster import rows as R
from fixedpipe.raster.vector.sample import row_pairs

NO_TEXELS = np.zeros(1, np.uint32)
NO_LEVELS = np.ones((1, R.MAX_LEVELS, 3), np.int32)


class Texels:
    """A texture in the form that kernels read.

    ``levels`` is int32 [1, MAX_LEVELS, 3]: where each level begins in ``packed``, its width and height.
    """

    def __init__(self, texture, signed):
        self.levels, offset = np.ones((1, R.MAX_LEVELS, 3), np.int32), 0
        for k, level in enumerate(texture.levels):
            self.levels[0, k] = offset, level.shape[2], level.shape[1]
            offset += level[..., 0].size
        self._images, self._signed = texture.levels, signed
        self._wide = texture.bits != NATIVE_BITS
        self._volume = texture.target == TextureTarget.TEXTURE_3D

    @cached_property
    def packed(self):
        """The words of all texels, level after level; the texture's own memory where it has this form.

        A wider texel has two words (``fixedpipe.raster.portable.texels``): all first words come before all
        second.
        """
        if self._wide:
            words = [np.ascontiguousarray(image).view(np.uint32) for image in self._images]
            return np.concatenate([image[..., k].ravel() for k in (0, 1) for image in words])
        images = [np.ascontiguousarray(image).view(np.uint32).ravel() for image in self._images]
        if len(images) == 1 and not self._signed:
            return np.asarray(_Unlocked(images[0]))
        return np.concatenate(images) ^ np.uint32(self._signed)

    @cached_property
    def pairs(self):
        """The texels as row pairs (``fixedpipe.raster.vector.sample``) and levels; none for a volume."""
        if self._volume:
            return NO_TEXELS, NO_LEVELS
        pairs, levels = row_pairs(self.packed, self.levels[0], len(self._images), len(self._images[0]))
        if len(self._images) > 1 or self._signed:
            self.__dict__.pop("packed", None)  # usually only one form is needed
        return pairs, levels[None]


class _Unlocked:
    """An array's memory as writable, because kernels take only writable arrays; they write to no texel."""

    def __init__(self, array):
        self._array = array
        place, _ = array.__array_interface__["data"]
        self.__array_interface__ = {**array.__array_interface__, "data": (place, False)}


_packed_textures = weakref.WeakKeyDictionary()


def texels_of(texture, signed):
    """The Texels of a texture. ``signed``: the bits to invert in every texel.

    Filters then see s + 128 for a signed byte s.
    """
    found = _packed_textures.get(texture)
    if found is None:
        found = _packed_textures.setdefault(texture, {})
    if signed not in found:
        found[signed] = Texels(texture, signed)
    return found[signed]
