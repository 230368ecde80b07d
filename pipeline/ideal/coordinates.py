"""Where fragments read textures: divided by q, on the face of a cube, made by a texture shader, or turned
along an arc from vertex to vertex.
"""

from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.pipeline.ideal.weights import change_of, iterate, iterate_as_machines
from fixedpipe.raster.columns.interpolate import on_face
from fixedpipe.raster.floats import TAU


@dataclass(frozen=True, eq=False)
class TextureCoordinates:
    """Where fragments read a texture image.

    position  float64 [k, 2], or [k, 3] in a volume, 1.0 = the whole image; the others that follow likewise
    face      int64 [k], 0 unless a cube map
    slip      float64 [k, 2], by how much the machines' coordinates lie beside ``position``, their bias aside
    bias      float64 [k, 1], texels that the machines add to coordinates that they divided: TAU or 0
    dx, dy    float64 [k, 2], derivatives of ``position`` per pixel
    """

    position: np.ndarray
    face: np.ndarray
    slip: np.ndarray
    bias: np.ndarray
    dx: np.ndarray
    dy: np.ndarray


def place(target, weights, corners, nearest=True, changing=True):
    """TextureCoordinates of fragments whose triangles have s, t, r, q ``corners``, float64 [k, 3, 4].

    Not ``nearest``: no nearest filter reads them; slip is 0. Not ``changing``: nothing asks how they change;
    dx and dy are 0. Either is a third of the work.
    """
    strq = iterate(weights.perspective, corners)
    none = np.broadcast_to(0.0, strq.shape)
    dx, dy = (change_of(weights.dx, corners), change_of(weights.dy, corners)) if changing else (none, none)
    if target is TextureTarget.TEXTURE_CUBE_MAP:
        on_cube = project_on_cube(strq[:, :3], dx[:, :3], dy[:, :3])
        if not nearest:
            return on_cube
        machine, _ = iterate_as_machines(weights, corners)
        return replace(on_cube, slip=_place_on_face(machine[:, :3], on_cube.face) - on_cube.position)
    q = np.where(strq[:, 3:] == 0.0, 1.0, strq[:, 3:])
    axes = _axes(target)
    position = strq[:, :axes] / q
    divided = (corners[:, :, 3] != 1.0).any(axis=1)[:, None]
    slip = none[:, :axes]
    if nearest:
        machine, unit = iterate_as_machines(weights, corners)
        slip = machine[:, :axes] / np.where(machine[:, 3:] == 0.0, 1.0, machine[:, 3:]) - position
        # Undivided coordinates lie at least a unit off an exact boundary, or on it but for the noise of
        # float64.
        slip = np.where(~divided & (np.abs(slip) < unit[:, :axes] / 2), 0.0, slip)
    return TextureCoordinates(
        position,
        np.zeros(len(position), np.int64),
        slip,
        np.where(divided, TAU, 0.0),
        (dx[:, :axes] - position * dx[:, 3:]) / q if changing else none[:, :axes],
        (dy[:, :axes] - position * dy[:, 3:]) / q if changing else none[:, :axes],
    )


def _axes(target):
    """How many texture coordinates place a texel of an image that is no cube map's."""
    return 3 if target is TextureTarget.TEXTURE_3D else 2


def _on_face(vector, face):
    """sc and tc, float64 [k, 2], and |ma|, float64 [k, 1], of vectors [k, 3] on their faces [k]."""
    sc, tc, major = on_face(vector, face)
    return np.stack([sc, tc], axis=1), np.abs(major)[:, None]


def _place_on_face(direction, face):
    """Places, float64 [k, 2], of directions [k, 3] on given faces; 0 where the major axis is.

    Source: EXT_texture_cube_map, section 3.8.6; docs/numbers.md, section 6 (the 0).
    """
    sc_tc, magnitude = _on_face(direction, face)
    ratio = sc_tc / np.where(magnitude == 0.0, 1.0, magnitude)
    return np.where(magnitude == 0.0, 0.0, (ratio + 1.0) * 0.5)


def project_on_cube(direction, dx, dy):
    """TextureCoordinates of directions [k, 3] with their derivatives: the face of the largest magnitude, x
    before y before z. Source: EXT_texture_cube_map, section 3.8.6.
    """
    rows = np.arange(len(direction))
    axis = np.argmax(np.abs(direction), axis=1)
    major = direction[rows, axis]
    face = 2 * axis + (major < 0.0)
    magnitude = np.where(major == 0.0, 1.0, np.abs(major))[:, None]
    sign = np.where(major < 0.0, -1.0, 1.0)[:, None]

    ratio = _on_face(direction, face)[0] / magnitude

    def derivative(step):
        return 0.5 * (_on_face(step, face)[0] - ratio * sign * step[rows, axis][:, None]) / magnitude

    return TextureCoordinates(
        _place_on_face(direction, face),
        face,
        np.zeros((len(rows), 2)),
        np.full((len(rows), 1), TAU),
        derivative(dx),
        derivative(dy),
    )


def turned_place(target, weights, corners):
    """Where unit vectors that turn steadily read a texture: what changes of a TextureCoordinates."""
    turned = spherical(weights.perspective, corners[:, :, :3])
    none = np.zeros((len(turned), 3))
    if target is TextureTarget.TEXTURE_CUBE_MAP:
        on_cube = project_on_cube(turned, none, none)
        return {"position": on_cube.position, "face": on_cube.face, "slip": on_cube.slip}
    axes = _axes(target)
    return {"position": turned[:, :axes], "slip": none[:, :axes]}


def spherical(weights, corners):
    """Unit vectors [k, 3] between those of corners [k, 3, 3]: the arc from vertex 0 to 1, then from there to
    2. Source: docs/numbers.md, section 20; Shoemake 1985.
    """
    v0, v1, v2 = (corners[:, i] / np.linalg.norm(corners[:, i], axis=1, keepdims=True) for i in range(3))
    edge = _arc(v0, v1, weights[:, 1] / np.maximum(weights[:, 0] + weights[:, 1], TAU))
    return _arc(edge, v2, weights[:, 2])


def _arc(a, b, t):
    angle = np.arccos(np.clip((a * b).sum(axis=1), -1.0, 1.0))
    sine = np.sin(angle)
    straight = sine < TAU
    divisor = np.where(straight, 1.0, sine)
    first = np.where(straight, 1.0 - t, np.sin((1.0 - t) * angle) / divisor)
    second = np.where(straight, t, np.sin(t * angle) / divisor)
    return first[:, None] * a + second[:, None] * b


def made_place(texture, str_, lifted=True):
    """TextureCoordinates that were computed, [k, 3]: with the machines' lift."""
    none = np.zeros_like(str_)
    if texture.target is TextureTarget.TEXTURE_CUBE_MAP:
        return project_on_cube(str_, none, none)
    axes = _axes(texture.target)
    few, lift = none[:, :axes], np.full((len(str_), 1), TAU if lifted else 0.0)
    return TextureCoordinates(str_[:, :axes], np.zeros(len(str_), np.int64), few, lift, few, few)


def still_place(strq, target):
    """TextureCoordinates at s, t, r float64 [k, 4] that do not change from pixel to pixel."""
    none = np.zeros((len(strq), 3))
    if target is TextureTarget.TEXTURE_CUBE_MAP:
        return project_on_cube(strq[:, :3], none, none)
    axes, face = _axes(target), np.zeros(len(strq), np.int64)
    none = none[:, :axes]
    return TextureCoordinates(strq[:, :axes], face, none, none[:, :1], none, none)


def reference_of(strq):
    """What depth texels are compared with: r over q, float64 [k]."""
    return strq[:, 2] / np.where(strq[:, 3] == 0.0, 1.0, strq[:, 3])
