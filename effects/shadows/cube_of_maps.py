"""Z11: six shadow maps round a point light, because one map's field of view is too small.

Source: document 003, "limited field of view"; A-Z11 of the catalogue. Each map looks along one axis, 90
degrees wide. A receiver's point belongs to the map of its largest component, seen from the light. So it lies
in a pyramid between four planes, which clip both passes of the receiver, without the light and with it. Both
passes then have the same vertices and depths. Neighbours share a plane with negated coefficients, and cut a
triangle at the same points, so each pixel belongs to one map.

The maps are wider than 90 degrees by a border, so a filter at a pyramid's side finds texels on both sides.
"""

import math

import numpy as np

from fixedpipe.effects.geometry.matrices import eye_plane
from fixedpipe.effects.scenes.objects_and_lamps import Lamp
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("Z11", "six shadow maps round a point light, a cube's faces", "Limited field of view"),
)

# In the order of a cube map's faces.
FACES = ("+x", "-x", "+y", "-y", "+z", "-z")


def _axis_and_sign(face):
    if face not in FACES:
        raise ValueError(f"A cube has no face {face!r}; give one of {', '.join(FACES)}.")
    return "xyz".index(face[1]), 1.0 if face[0] == "+" else -1.0


def face_lamp(position, face, near, far, border=0.0):
    """The map's camera: a lamp at ``position`` that looks along an axis.

    ``border``: how much of the map's edge lies outside the 90 degrees on each side: two texels of 512 are 2 /
    512. Raises ValueError if it is not from 0 to below 1/2.
    """
    axis, sign = _axis_and_sign(face)
    if not 0.0 <= border < 0.5:
        raise ValueError(f"The map's border is {border} of its edge; give one from 0 up to below 1/2.")
    angle = math.degrees(2.0 * math.atan(1.0 / (1.0 - 2.0 * border)))
    target = tuple(float(p) + (sign if k == axis else 0.0) for k, p in enumerate(position))
    # Rounded up to a thousandth of a degree, so that it has the same bits everywhere; a right angle stays
    # one.
    angle = math.ceil(angle * 1000.0 - 1e-6) / 1000.0
    return Lamp(tuple(map(float, position)), target, near, far, field_of_view=angle)


def cube_lamps(scene, position, border=0.0, near=0.05):
    """The six maps' cameras, in the order of FACES; their far planes enclose the scene's box.

    ``near``: the planes' distance. Assumed: nothing in a room is nearer to its lamp than 0.05.
    """
    reach = [max(abs(e[k] - position[k]) for e in scene.bounds()) for k in range(3)]
    # A hundredth more, so that no wall is clipped.
    far = 1.01 * float(max(reach))
    return tuple(face_lamp(position, face, near, far, border) for face in FACES)


def face_planes(position, face, modelview):
    """The four clip planes, in eye coordinates, between the part that a face's map lights and those of its
    neighbours.

    ``modelview``: the viewer's.
    """
    axis, sign = _axis_and_sign(face)
    out = []
    for other in range(3):
        for side in (1.0, -1.0):
            if other != axis:
                plane = [0.0, 0.0, 0.0]
                plane[axis], plane[other] = sign, side
                distance = -(sign * position[axis] + side * position[other])
                out.append(eye_plane((*plane, distance), modelview))
    return tuple(out)


def face_of(vectors):
    """The number of the face, by FACES, that vectors [..., 3] from the light point to: int64 [...]."""
    axis = np.argmax(np.abs(vectors), axis=-1)
    negative = np.take_along_axis(np.asarray(vectors), axis[..., None], axis=-1)[..., 0] < 0.0
    return 2 * axis + negative
