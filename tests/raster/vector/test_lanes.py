"""Arithmetic of lanes that takes another way on some processors, over every operand."""

import numpy as np

from fixedpipe.raster.kernel import kernel
from fixedpipe.raster.vector.combine import divide_bytes
from fixedpipe.raster.vector.lanes import load_i16x16, load_i16x32, mixed_bytes, store, upper_half

BYTES = np.arange(256, dtype=np.int16)


@kernel("void(i2[::1],i2[::1],i2[::1],i2[::1])")
def mix_32(p, q, weight, out):
    for at in range(0, p.shape[0], 32):
        store(out, at, mixed_bytes(load_i16x32(p, at), load_i16x32(q, at), load_i16x32(weight, at)))


@kernel("void(i2[::1],i2[::1],i2[::1],i2[::1])")
def mix_16(p, q, weight, out):
    for at in range(0, p.shape[0], 16):
        store(out, at, mixed_bytes(load_i16x16(p, at), load_i16x16(q, at), load_i16x16(weight, at)))


@kernel("void(i2[::1],i2[::1],i2[::1])")
def divide(products, quotients, halves):
    for at in range(0, products.shape[0], 32):
        store(quotients, at, divide_bytes(load_i16x32(products, at)))
        store(halves, at, upper_half(load_i16x32(products, at), 257))


def test_mixed_bytes_are_rounded_to_nearest_for_all_bytes_and_weights():
    p, q = (a.ravel() for a in np.meshgrid(BYTES, BYTES))
    wide, out = (p.astype(np.int32), q.astype(np.int32)), np.empty_like(p)
    for weight in range(256):
        expected = (wide[0] * (256 - weight) + wide[1] * weight + 128) >> 8
        for mix in (mix_32, mix_16):
            mix(p, q, np.full_like(p, weight), out)
            assert (out == expected).all(), weight


def test_products_of_bytes_are_divided_by_255_and_halves_are_the_upper_ones():
    products = np.arange(65536, dtype=np.uint16)
    quotients, halves = np.empty(65536, np.int16), np.empty(65536, np.int16)
    divide(products.view(np.int16), quotients, halves)
    n = np.arange(255 * 255 + 1)
    assert (quotients[: len(n)] == (2 * n + 255) // 510).all()
    assert (halves.view(np.uint16) == (np.arange(65536) * 257) >> 16).all()
