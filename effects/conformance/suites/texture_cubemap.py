"""Texture_cubemap: two cubes under a cube map, looked up directly and through dot products with a normal map.

Source: src/tests/texture_cubemap_tests.cpp of nxdk_pgraph_tests, src/texture_generator.cpp of pbkitplusplus.
"""

import math
from dataclasses import replace
from functools import cache, partial, reduce
from itertools import product

import numpy as np
from PIL import Image

from fixedpipe.effects.conformance import host_matrices, scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import DotProductMapping, Face, FrontFace, Register
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import DepthTest, TextureShaderStage, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d, texture_cube_map

SUITE = "Texture_cubemap"
OPEN = "the last bits of a dot product's sum, at texels' boundaries"

MAPPINGS = {
    "0to1": DotProductMapping.UNSIGNED_IDENTITY,
    "-1to1D3D": DotProductMapping.EXPAND_NORMAL,
    "-1to1GL": DotProductMapping.SIGNED_ODD,
    "-1to1": DotProductMapping.SIGNED_IDENTITY,
    "HiLo_1": DotProductMapping.UNSIGNED_HILO,
    "HiLoHemi": DotProductMapping.SIGNED_HILO_HEMISPHERE,
}
_ROOT = "the hemisphere mapping's square root: its last bits on the chip are not known"
EXPLANATIONS = {
    "DotReflectConst_1_HiLoHemi": _ROOT,
    "DotReflectSpecConst_HiLoHemi": _ROOT,
    "DotSTRCube_HiLoHemi": _ROOT,
    "DotReflectSpec_1_-1to1": "one direction beside a texel edge",
}
SIZE = 64
# +x, -x, +y, -y, +z, -z: a checkerboard's colours (0xAABBGGRR), and the channels of a gradient (0xBBGGRR).
CHECKERS = (
    (0xFF7777FF, 0xFF222222),
    (0xFF553366, 0xFFDDDDDD),
    (0xFF55FF55, 0xFF222222),
    (0xFF33AAAA, 0xFFDDDDDD),
    (0xFFFF5555, 0xFF222222),
    (0xFFAAAA33, 0xFFDDDDDD),
)
CHANNELS = (0x0000FF, 0xFF00FF, 0x00FF00, 0x00FFFF, 0xFF0000, 0xFFFF00)
CORNERS = np.array(
    [
        [(-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)],
        [(1, -1, -1), (-1, -1, -1), (-1, 1, -1), (1, 1, -1)],
        [(1, -1, 1), (1, -1, -1), (1, 1, -1), (1, 1, 1)],
        [(-1, -1, -1), (-1, -1, 1), (-1, 1, 1), (-1, 1, -1)],
        [(-1, 1, 1), (1, 1, 1), (1, 1, -1), (-1, 1, -1)],
        [(-1, -1, -1), (1, -1, -1), (1, -1, 1), (-1, -1, 1)],
    ],
    np.float64,
).reshape(24, 3)
# Where each face lies in the normal map: its left and top edge; each is a quarter of it wide and high.
NORMAL_MAP = np.array(
    [
        (left + dx, top + dy)
        for left, top in (
            (0.25, 0.375),
            (0.75, 0.375),
            (0.5, 0.375),
            (0.0, 0.375),
            (0.25, 0.625),
            (0.25, 0.125),
        )
        for dx, dy in ((0.0, 0.0), (0.25, 0.0), (0.25, 0.25), (0.0, 0.25))
    ]
)
CUBES = ((-1.5, math.pi * 0.25), (1.5, math.pi * 1.25))  # x, rotation about the x axis


def model_matrix(x, angle):
    """A cube's place, for row vectors: turned by 45 degrees about y, by ``angle`` about x, then moved."""
    return host_matrices.turned(math.pi * 0.25, angle, (x, 0.0, 2.0))


def eye_to_window(depth_maximum=65535.0, near=1.0, far=200.0):
    """The XDK's default projection and viewport, for row vectors: pixels, depth units, all times w.

    Measured: 16 bits of depth (the weight of the matrices' third row in DotSTRCube_HiLoHemi).
    """
    scale = depth_maximum * far / (far - near)
    return np.array(
        [
            [scenes.XDK_SCALE, 0, 0, 0],
            [0, -scenes.XDK_SCALE, 0, 0],
            [WIDTH / 2, HEIGHT / 2, scale, 1],
            [0, 0, -scale * near, 0],
        ]
    )


def checkerboard(first, second, cell):
    """uint8 [SIZE, SIZE, 4]: squares of two colours 0xAABBGGRR, the first at texel (0, 0)."""
    at = np.arange(SIZE) // cell
    return _bytes(np.where((at[:, None] + at[None]) & 1, second, first))


def checkerboard_faces():
    """uint8 [6, SIZE, SIZE, 4]."""
    return np.stack([checkerboard(*colors, 4) for colors in CHECKERS])


def gradient_faces():
    """uint8 [6, SIZE, SIZE, 4]: brightness grows from the middle, fast at first, in a face's channels."""
    return np.stack([radial_gradient(mask) for mask in CHANNELS])


def _bytes(words):
    """0xAABBGGRR as RGBA bytes."""
    return np.stack([(words >> shift) & 255 for shift in (0, 8, 16, 24)], -1).astype(np.uint8)


def radial_gradient(mask, linear=False):
    """uint8 [SIZE, SIZE, 4]: brightness by distance from the middle, in the channels of 0xBBGGRR ``mask``."""
    single = np.float32
    middle = single(SIZE - 1) / single(2)
    offset = np.arange(SIZE, dtype=single) - middle
    distance = np.sqrt(offset[None] * offset[None] + offset[:, None] * offset[:, None])
    distance = distance / np.sqrt(middle * middle + middle * middle)
    quarter = single(0.25)
    rest = (distance - quarter) / (single(1) - quarter)
    light = np.where(distance < quarter, distance / quarter * single(0.5), single(0.5) + rest * single(0.5))
    ramp = np.arange(SIZE, dtype=single) / single(SIZE)
    if linear:
        light = distance
    colors = np.stack([ramp[None] * light, ramp[:, None] * light, single(0.75) * light], -1)
    values = (colors * single(255)).astype(np.uint8)
    if mask != 0xFFFFFF:
        values = np.repeat(values.max(-1)[..., None], 3, -1)
    out = np.full((SIZE, SIZE, 4), 255, np.uint8)
    for channel in range(3):
        out[..., channel] = values[..., channel] if mask >> (8 * channel) & 255 else 0
    return out


def noise_faces():
    """uint8 [6, SIZE, SIZE, 4]: neighbouring texels differ as much as they can."""
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    bits = np.stack([x % 2, y % 2, (x // 2 + y // 2) % 2], -1) * 255
    out = np.full((6, SIZE, SIZE, 4), 255, np.uint8)
    for face, seed in enumerate(CHANNELS):
        out[face, ..., :3] = bits ^ np.array([seed >> 16 & 255, seed >> 8 & 255, seed & 255])
    return out


@cache
def normal_map(path):
    """The object-space normal map, as bytes; its first row is at t = 0."""
    return np.array(Image.open(path).convert("RGBA"))


def cube(model, coordinates, q=None):
    """A cube's mesh as the vertex program leaves it, with the given texture coordinate sets."""
    clip = reduce(scenes.times, (np.c_[CORNERS, np.ones(24)], model, _view(), eye_to_window()))
    positions = np.c_[clip[:, :3] / clip[:, 3:], clip[:, 3]]
    return scenes.window_mesh(positions, texture_coordinates=tuple(scenes.single(c) for c in coordinates))


def _view():
    view = np.eye(4)
    view[3, 2] = scenes.XDK_EYE
    return view


def dot_coordinates(model, eyes):
    """Texture coordinates 0 to 3: the place in the normal map, then three rows of a matrix, with their q."""
    device = host_matrices.times(host_matrices.projection(), host_matrices.viewport(host_matrices.Z16))
    view = host_matrices.times(model, host_matrices.view(), wide=True)
    inverse = host_matrices.inverse(host_matrices.times(view, device, wide=True), wide=True)
    rows = [np.c_[np.tile(inverse[k, :3], (24, 1)), np.broadcast_to(eyes[..., k], 24)] for k in range(3)]
    return [NORMAL_MAP, *rows]


def state_of(register, units, stages):
    """Pass state of the suite: the given texture register, culled and depth tested."""
    return replace(
        scenes.DEFAULT,
        register_combiners=scenes.shows(register),
        polygon=replace(scenes.DEFAULT.polygon, cull_face=Face.BACK, front_face=FrontFace.CW),
        depth_test=DepthTest(),
        texture_units=units,
        texture_shader=stages,
    )


def dots(last, mapping, constant_eye=(0.0, 0.0, -1.0), second=Operation.DOT_PRODUCT):
    """Texture 0 as it is, and dot products with it on stages 1, 2 and (``last``) 3."""
    return (
        TextureShaderStage(Operation.TEXTURE_2D),
        TextureShaderStage(Operation.DOT_PRODUCT, dot_product_mapping=mapping),
        TextureShaderStage(second, dot_product_mapping=mapping),
        TextureShaderStage(last, dot_product_mapping=mapping, constant_eye=constant_eye),
    )


def unit(texture, number):
    """A texture unit with its own coordinate set and nearest filters."""
    return TextureUnit(texture, scenes.NEAREST, coordinates=number)


def eye_vectors(model):
    """float64 [24, 3]: from the eye to every corner, normalised."""
    away = scenes.times(np.c_[CORNERS, np.ones(24)], model)[:, :3] - (0.0, 0.0, -scenes.XDK_EYE)
    return away / np.linalg.norm(away, axis=1)[:, None]


def _read():
    units = (None, None, None, unit("cube", 3))
    images = [TexImage(label="cube map", texture="cube", image=texture_cube_map(checkerboard_faces()))]
    meshes = [cube(model_matrix(*place), [CORNERS] * 4) for place in CUBES]  # a cube map reads no q
    return Case(commands=_frame(0xFE121212, images, meshes, state_of(Register.TEXTURE3, units, None)))


def _dotted(kind, mapping, inputs, axis=None, explanation=""):
    # The programs' order decides what the cube map's memory holds where a program does not fill it itself.
    faces = {"DotSTR3D": noise_faces, "DotReflectConst": checkerboard_faces}.get(kind, gradient_faces)()
    normals = texture_2d(normal_map(inputs.path("cube_normals_object_space.png")))
    images = [
        TexImage(label="normal map", texture="normals", image=normals),
        TexImage(label="cube map", texture="cube", image=texture_cube_map(faces)),
        TexImage(label="diffuse cube map", texture="diffuse", image=texture_cube_map(checkerboard_faces())),
    ]
    last = {
        "DotSTRCube": Operation.DOT_PRODUCT_TEXTURE_CUBE_MAP,
        "DotSTR3D": Operation.DOT_PRODUCT_TEXTURE_3D,
        "DotReflectSpecConst": Operation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP,
        "DotReflectConst": Operation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP,
    }.get(kind, Operation.DOT_PRODUCT_REFLECT_CUBE_MAP)
    diffuse = kind == "DotReflectDiffuse"
    second = Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP if diffuse else Operation.DOT_PRODUCT
    eye = np.array((0.0, 0.0, -7.0)) if axis is None else np.eye(3)[axis]
    stages = dots(last, mapping, tuple(eye.tolist()), second)
    register = Register.TEXTURE2 if diffuse else Register.TEXTURE3
    units = (unit("normals", 0), unit(None, 1), unit("diffuse" if diffuse else None, 2), unit("cube", 3))
    meshes = []
    for place in CUBES:
        model = model_matrix(*place)
        eyes = np.ones((24, 3))
        if kind == "DotSTRCube":
            eyes = eye_vectors(model)
        elif kind == "DotSTR3D":
            eyes = np.zeros((24, 3))
        elif axis is not None and kind == "DotReflectSpec":
            eyes = np.tile(eye, (24, 1))
        meshes.append(cube(model, dot_coordinates(model, eyes)))
    background = 0xFE141414 if kind == "DotSTR3D" else 0xFE131313
    return Case(
        commands=_frame(background, images, meshes, state_of(register, units, stages)),
        explanation=explanation,
    )


def _frame(background, images, meshes, state):
    draws = [Draw(label=f"cube {k}", mesh=mesh, state=state) for k, mesh in enumerate(meshes)]
    return (scenes.clear(background), *images, *draws)


def _cases():
    # Each q but one that the earlier program had no name for; a cube map reads none.
    for q in ("", "_q-inf", "_q-1.0", "_q-0.0", "_q0.0", "_q1.0", "_qinf"):
        yield f"Cubemap{q}", _read
    for ending, mapping in MAPPINGS.items():
        for kind in ("DotSTRCube", "DotSTR3D", "DotReflectSpec", "DotReflectSpecConst", "DotReflectDiffuse"):
            name = f"{kind}_{ending}"
            yield name, partial(_dotted, kind, mapping, explanation=EXPLANATIONS.get(name, ""))
        for kind, axis in product(("DotReflectSpec", "DotReflectConst"), range(3)):
            name = f"{kind}_{axis}_{ending}"
            yield name, partial(_dotted, kind, mapping, axis=axis, explanation=EXPLANATIONS.get(name, ""))


CASES = dict(_cases())
