"""Texture_2D_as_cubemap: Texture_cubemap's cubes with two-dimensional textures where cube maps are meant.

Source: src/tests/texture_2d_as_cubemap_tests.cpp of nxdk_pgraph_tests.
"""

from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.suites import texture_cubemap as cubes
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import DotProductMapping, Register
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import TextureShaderStage
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Texture_2D_as_cubemap"
OPEN = "the last bits of a dot product's sum, at texels' boundaries"


def _images(inputs):
    checkers = cubes.checkerboard(0xFF44FFFF, 0xFFAA9933, 2)
    normals = cubes.normal_map(inputs.path("cube_normals_object_space.png"))
    return [
        TexImage(label="normal map", texture="normals", image=texture_2d(normals)),
        TexImage(label="diffuse", texture="diffuse", image=texture_2d(cubes.radial_gradient(0xFFFFFF, True))),
        TexImage(label="checkerboard", texture="checkers", image=texture_2d(checkers)),
    ]


def _frame(inputs, background, register, units, stages, meshes):
    state = cubes.state_of(register, units, stages)
    draws = [Draw(label=f"cube {k}", mesh=mesh, state=state) for k, mesh in enumerate(meshes)]
    return Case(commands=(scenes.clear(background), *_images(inputs), *draws))


def _read(inputs):
    units = (None, None, None, cubes.unit("checkers", 3))
    stages = (TextureShaderStage(),) * 3 + (TextureShaderStage(Operation.TEXTURE_CUBE_MAP),)
    meshes = [cubes.cube(cubes.model_matrix(*place), [cubes.CORNERS] * 4) for place in cubes.CUBES]
    return _frame(inputs, 0xFE121212, Register.TEXTURE3, units, stages, meshes)


def _dotted(last, inputs, eyes=lambda model: np.ones((24, 3)), diffuse=False, background=0xFE131313):
    second = Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP if diffuse else Operation.DOT_PRODUCT
    stages = cubes.dots(last, DotProductMapping.EXPAND_NORMAL, (0.0, 0.0, -7.0), second)
    units = (
        cubes.unit("normals", 0),
        cubes.unit(None, 1),
        cubes.unit("diffuse" if diffuse else None, 2),
        cubes.unit("checkers", 3),
    )
    models = [cubes.model_matrix(*place) for place in cubes.CUBES]
    meshes = [cubes.cube(model, cubes.dot_coordinates(model, eyes(model))) for model in models]
    register = Register.TEXTURE2 if diffuse else Register.TEXTURE3
    return _frame(inputs, background, register, units, stages, meshes)


CASES = {
    "Cubemap_Bad2D": _read,
    "DotSTRCube_Bad2D": partial(_dotted, Operation.DOT_PRODUCT_TEXTURE_CUBE_MAP, eyes=cubes.eye_vectors),
    "DotSTR3D_Bad2D": partial(
        _dotted, Operation.DOT_PRODUCT_TEXTURE_3D, eyes=lambda model: np.zeros((24, 3)), background=0xFE141414
    ),
    "DotReflectSpec_Bad2D": partial(_dotted, Operation.DOT_PRODUCT_REFLECT_CUBE_MAP),
    "DotReflectSpecConst_Bad2D": partial(_dotted, Operation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP),
    "DotReflectDiffuse_Bad2D": partial(_dotted, Operation.DOT_PRODUCT_REFLECT_CUBE_MAP, diffuse=True),
}
