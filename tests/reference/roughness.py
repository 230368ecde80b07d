"""Lookups filtered by roughness, one fragment at a time: docs/numbers.md section 12."""

from functools import partial
from math import inf, sqrt, trunc

from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from tests.reference import coverage, interpolate, sample


def deviations(texel, scale):
    """d_1, d_2 and d_3 of a texel's bytes, doubled: a side is two deviations.

    Source: Schilling 1997, section 8 (D); Assumed: the bytes' coding, and that two deviations are a side.
    """
    doubled = 2.0 * scale
    return texel[0] / 255.0 * doubled, (texel[1] - 128.0) / 127.0 * doubled, texel[2] / 255.0 * doubled


def undisplaced(triangles, i, operation, at):
    """(s, t) that a lookup has at a pixel without bumps, or None.

    Assumed: not those with bumps, whose differences between pixels roughness stands for already.
    """
    triangle = triangles[i]
    e = interpolate.perspective_terms(coverage.edge_values(triangle.edges, *at), triangle.inverse_w)
    d = interpolate.denominator(e)
    if d <= 0.0:
        return None
    b0, b2 = e[0] * (1.0 / d), e[2] * (1.0 / d)
    own = sample.exact_coordinates(triangle.coordinates, b0, b2)
    if operation == Operation.OFFSET_TEXTURE_2D:
        return own[:2]
    return sample.exact_coordinates(triangles[i - 1].coordinates, b0, b2)[2], own[2]


def footprint(triangles, i, operation, pixel, jacobian, d, texture, sampler):
    """(along s, along t, probes, lambda) of a fragment's lookup.

    Source: Schilling 1997, section 8 (roughness read anisotropically); the sum of pixel and roughness is
    Assumed (decision 0020), as the axes of the ellipse.
    """
    nothing = 0.0, 0.0, 1, sample.LARGEST_LAMBDA
    x, y = pixel[0] & ~1, pixel[1] & ~1
    points = [undisplaced(triangles, i, operation, at) for at in ((x, y), (x + 1, y), (x, y + 1))]
    if None in points:
        return nothing
    width, height = sample.texel_scales(texture, sampler.base_level)[:2]
    (su, sv), (tu, tv) = jacobian
    d1, d2, d3 = d
    sides = [((s - points[0][0]) * width, (t - points[0][1]) * height) for s, t in points[1:]]
    sides.append(((su * d1) * width, (tu * d1) * height))
    sides.append(((su * d2 + sv * d3) * width, (tu * d2 + tv * d3) * height))
    a = b = c = 0.0
    for s, t in sides:
        a, b, c = a + s * s, b + s * t, c + t * t
    half, middle = 0.5 * (a - c), 0.5 * (a + c)
    root = sqrt(half * half + b * b)
    longer, shorter = middle + root, max(middle - root, 0.0)
    if not longer < inf:
        return nothing
    axis = (half + root, b) if half >= 0.0 else (b, root - half)
    length = sqrt(axis[0] * axis[0] + axis[1] * axis[1])
    axis = (axis[0] / length, axis[1] / length) if length > 0.0 else (1.0, 0.0)
    probes, rho2 = 1, longer
    if sampler.max_probes > 1:
        probes, rho2 = sample.probes_of(longer, shorter, sampler.max_probes, sampler.exact_probes)
    along = axis[0] * sqrt(longer) / width, axis[1] * sqrt(longer) / height
    return *along, probes, sample.lambda_of(rho2)


def sample_rough(st, found, texture, unit, operation, profile):
    """A texel at made coordinates, over a ``footprint``. Source: docs/numbers.md sections 7 and 12."""
    along_s, along_t, probes, lod = found
    sampler, total = unit.sampler, [0] * 4
    lod = sample.limited(lod + trunc(256.0 * unit.lod_bias), sampler)
    for k in range(probes):
        distance = (2 * k + 1 - probes) / (2 * probes)
        moved = st
        if sampler.max_probes > 1:
            moved = st[0] + distance * along_s, st[1] + distance * along_t
        offset = operation == Operation.OFFSET_TEXTURE_2D
        level = partial(
            sample.sample_level, None, (*moved, 0.0, 1.0), texture, sampler, profile, offset=offset
        )
        texel = sample.filter_levels(level, lod, texture, sampler, profile)
        total = [a + c for a, c in zip(total, texel, strict=True)]
    return [a // probes for a in total]
