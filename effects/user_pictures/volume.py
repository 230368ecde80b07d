"""A user's volume and its picture: densities of a 3D texture, and the lamp and the camera for all of its
surface.

Densities are bytes, and edges are powers of two. Values are spread over the bytes from the least to the
greatest. An edge that is no power of two, or longer than the machine's textures, is resampled. If there are
fewer voxels, each is a mean over its volume; if there are more, they are linear between voxels' centres.
"""

import numpy as np

from fixedpipe.effects.geometry.matrices import look_at, perspective
from fixedpipe.effects.geometry.vectors import cross, dot, normalize, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, View
from fixedpipe.effects.scenes.objects_and_lamps import lamp_around
from fixedpipe.effects.shadows.alpha_coded_shadows import BIAS, Coding
from fixedpipe.effects.shadows.lit_scene import map_edge
from fixedpipe.effects.volumes.slices import CORNER_BITS, Volume
from fixedpipe.effects.volumes.volume_rendering import Picture, method_of
from fixedpipe.pipeline.profiles import PROFILES

# Assumed: texels along an edge that a host of today has memory for several times over; 512 would be 512 MB.
LARGEST_EDGE = 256
_LARGEST = 1e30  # Assumed: no measured volume holds more


def _method_or_none(profile):
    try:
        return method_of(profile)
    except ValueError:
        return None


def machines_that_can():
    """Keys in ``fixedpipe.pipeline.profiles.PROFILES`` of the machines that can light a volume's slices."""
    return tuple(key for key, profile in PROFILES.items() if _method_or_none(profile))


def method_for(profile):
    """How a profile draws a volume. Raises ValueError, with the machines that can, where it cannot."""
    try:
        return method_of(profile)
    except ValueError as error:
        raise ValueError(f"{error} Give one of {', '.join(machines_that_can())}.") from error


def texture_edges(counts, largest):
    """The powers of two from 8 that a volume's edges are resampled to: the nearest above, or ``largest``."""
    return tuple(min(max(8, 1 << (int(n) - 1).bit_length()), largest) for n in counts)


def _weights(count, wanted):
    """For each of ``wanted`` voxels along an axis of ``count``: the first it reads, and their weights."""
    for k in range(wanted):
        if wanted >= count:
            place = min(max((k + 0.5) * count / wanted - 0.5, 0.0), count - 1.0)
            first = min(int(place), max(count - 2, 0))
            part = place - first
            yield first, ((1.0 - part), part)[: count - first]
        else:
            begin, end = k * count / wanted, (k + 1) * count / wanted
            first, last = int(begin), min(int(np.ceil(end)), count)
            shares = [min(end, i + 1.0) - max(begin, float(i)) for i in range(first, last)]
            yield first, tuple(share * wanted / count for share in shares)


def _blended(read, count, wanted):
    """Of ``count`` layers along an axis, which ``read`` gives by their numbers, ``wanted``: float32 each."""
    if wanted == count:
        yield from map(read, range(count))
        return
    for first, weights in _weights(count, wanted):
        out = np.float32(weights[0]) * read(first)
        for i, weight in enumerate(weights[1:], start=1):
            out += np.float32(weight) * read(first + i)
        yield out


def resampled(values, edges, unit=np.float32):
    """An array [layers, rows, columns] with ``edges`` voxels along these axes: float32.

    unit  (a layer [rows, columns]) -> the layer to resample, float32. Layers are taken one after the other,
          so that only a few of a large volume are floats at a time
    """
    out = np.empty(edges, np.float32)
    for k, layer in enumerate(_blended(lambda k: unit(values[k]), len(values), edges[0])):
        for edge in edges[1:]:
            layer = np.array(tuple(_blended(layer.__getitem__, len(layer), edge))).T
        out[k] = layer
    return out


def volume_of(values, name, profile, iso=None, spacing=(1.0, 1.0, 1.0)):
    """A ``Volume`` of a user's values for a machine.

    Parameters
    ----------
    values
        Numbers [layers, rows, columns], z, y and x.
    name
        For messages.
    iso
        The iso-surface's value; None: halfway between the least and the greatest.
    spacing
        Of voxels along x, y and z; the longest edge of the box becomes two world units.

    Raises ValueError for values that are no volume, or have no such surface.
    """
    values = np.asarray(values)
    if values.ndim != 3 or min(values.shape, default=0) < 2:
        shape = "x".join(map(str, values.shape[::-1]))
        raise ValueError(f"{name} has {shape or 'no'} voxels; a volume has three edges, of two or more.")
    if values.dtype.kind not in "biuf":
        raise ValueError(f"{name} holds values of type {values.dtype}; give numbers.")
    if not (len(spacing) == 3 and all(0.0 < s < np.inf for s in spacing)):
        raise ValueError(f"The voxels' spacing is {spacing}; give three positive numbers.")
    low, high = float(values.min()), float(values.max())
    if not max(abs(low), abs(high)) <= _LARGEST:
        raise ValueError(f"{name} holds NaN, infinity or numbers above {_LARGEST:g}; give smaller ones.")
    if low == high:
        raise ValueError(f"All of {name} is {low:g}; there is no surface in it.")
    wanted = (low + high) / 2.0 if iso is None else float(iso)
    fraction = (wanted - low) / (high - low)
    # Bytes of zero, or none but 255, would have no surface or nothing in front of it.
    if not 0.5 <= 255.0 * fraction <= 254.5:
        raise ValueError(
            f"The iso-surface's value is {wanted:g}; the values of {name} go from {low:g} to {high:g} in 255 "
            "steps, give one between."
        )

    def unit(layer):
        return ((layer.astype(np.float64) - low) / (high - low)).astype(np.float32)

    edges = texture_edges(values.shape, min(profile.textures.max_3d_texture_size, LARGEST_EDGE))
    density = resampled(values, edges, unit)
    density = np.floor(np.float32(255.0) * density + np.float32(0.5)).astype(np.uint8)
    if density.max() < np.ceil(255.0 * fraction):
        raise ValueError(
            f"Resampled to {'x'.join(map(str, density.shape[::-1]))} voxels, nothing of {name} reaches "
            f"{wanted:g}; give a lower value."
        )
    widest = max(spacing)
    extents = [n * (s / widest) for n, s in zip(values.shape[::-1], spacing, strict=True)]
    half = tuple(float(e / max(extents)) for e in extents)
    return Volume(name, density, half, fraction)


def bias_of(bits, slices, edge):
    """The map's bias in steps of depth: two steps of a byte, or as much as two slices or two of the map's
    ``edge`` texels if these are coarser.

    Both are no finer on a machine of 12 bits, whose steps are a sixteenth.
    """
    return BIAS * (2**bits - 1) / min(slices, edge, 255)


def picture_of(volume, eye, up, light, profile, size, slices, shadows):
    """A ``Picture`` of ``size`` by ``size`` pixels that shows all of a volume's surface.

    ``eye``, ``up``, ``light``: directions, three floats; the first to the viewer, the last to the lamp.
    Raises ValueError where the eye looks along ``up``, there is no surface, or a flat volume would fall
    through between the slices.
    """
    corners = volume.corners()
    center = corners.min(axis=0) * 0.5 + corners.max(axis=0) * 0.5
    toward = unit_vector(eye, "The direction to the eye")
    across = cross(unit_vector(up, "What is up"), toward)
    if dot(across, across) < 1e-6:
        raise ValueError(f"The eye looks along {up}, which is to be up; give another direction.")
    side = normalize(across)
    points = volume.brick_corners(volume.seen_bricks()[:, None] + CORNER_BITS).reshape(-1, 3) - center
    x, y, z = (dot(points, axis) for axis in (side, cross(toward, side), toward))
    # What is flat and seen aslant must be deeper along the view than slices are apart.
    step = float(z.max() - z.min()) / slices
    depths = 2.0 * np.array(volume.half_extents) / np.maximum(np.abs(toward), 1e-12)
    if depths.min() < step:
        raise ValueError(
            f"Slices are {step:.3g} units apart, and {volume.name} is {depths.min():.3g} deep where the eye "
            "looks through its thinnest edge: it would have holes. Give more slices, another direction to "
            "the eye, or another spacing."
        )
    # A field of view of 24 degrees, 0.2126 its half's tangent, and a margin round what is seen.
    distance = float((np.maximum(np.abs(x), np.abs(y)) * (1.04 / 0.2126) + z).max())
    position = tuple((center + distance * toward).tolist())
    # Slices come half a step nearer than the volume.
    depth = 0.05 * float(z.max() - z.min())
    projection = perspective(24.0, 1.0, distance - float(z.max()) - depth, distance - float(z.min()) + depth)
    modelview = look_at(position, tuple(center.tolist()), up)
    lamp = center + 4.0 * unit_vector(light, "The direction to the light")
    edge = map_edge(size, 1)
    bits = profile.framebuffers.color_bits[0]
    return Picture(
        volume,
        View(Panel(0, 0, size, size), modelview, projection, position, False),
        lamp_around(volume, tuple(lamp.tolist()), tuple(center.tolist()), infinite=True),
        slices,
        map_panel=Panel(0, 0, edge, edge) if shadows else None,
        coding=Coding(bits=bits, bias=bias_of(bits, slices, edge)),
        background=BACKGROUND,
    )
