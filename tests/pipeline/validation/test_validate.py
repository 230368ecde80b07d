"""What is refused, in which words, and what is accepted right beside it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

from fixedpipe.pipeline.commands import (
    Bitmap,
    Clear,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    Mesh,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    CombinerBias,
    CombinerScale,
    ComponentUsage,
    FogCoordinateSource,
    FogMode,
    InternalFormat,
    LightingArithmetic,
    LogicOperation,
    Mapping,
    PrimitiveType,
    Register,
    SecondaryColor,
    StencilOperation,
    TexGenMode,
    TextureCompareMode,
    TextureEnvironmentMode,
    TextureFilter,
    TextureTarget,
    VertexStage,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, NV2A
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.profiles.sections import SECTION_OF
from fixedpipe.pipeline.state import (
    IDENTITY,
    AlphaPortion,
    AlphaTest,
    Blending,
    ColorKey,
    CombinerInput,
    Composite,
    DepthClamp,
    DepthTest,
    FinalCombiner,
    Fog,
    FogRegisters,
    GeneralCombiner,
    Light,
    Lighting,
    LineState,
    Material,
    PassState,
    PointParameters,
    PointState,
    PolygonState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    Scissor,
    Spot,
    StencilTest,
    TexGen,
    TextureEnvironment,
    TextureUnit,
    VertexState,
    Viewport,
    WindowClip,
)
from fixedpipe.pipeline.textures.images import Texture, texture_1d, texture_2d, texture_cube_map
from fixedpipe.pipeline.validation.remembered import Remembered
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState, taken_by
from tests.support.combiner_strategies import register_combiners

NAN, INF = math.nan, math.inf
TRIANGLE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
MESH = Mesh(TRIANGLE, texture_coordinates=(TRIANGLE[:, :2],))
COMBINERS = RegisterCombiners()
MIPMAPPED = TexImage(label="store", texture="checker", image=texture_2d(np.zeros((4, 8, 3)), mipmaps=True))
CUBE = TexImage(label="store", texture="cube", image=texture_cube_map(np.zeros((6, 4, 4, 3))))
LINE = TexImage(label="store", texture="line", image=texture_1d(np.zeros((4, 3))))
LINEAR = Sampler(min_filter=TextureFilter.LINEAR)


def check(*commands, profile=GEFORCE_256, width=64, height=32, **others):
    validate(commands, profile, width, height, **others)


def draw(mesh=MESH, **fields):
    return Draw(label="pass", mesh=mesh, state=PassState(**fields))


def lit(light=None, **fields):
    return draw(vertex=VertexState(lighting=Lighting(lights=(light,) if light else (), **fields)))


def combined(**fields):
    return draw(register_combiners=replace(COMBINERS, **fields))


def general(**fields):
    return combined(general=(GeneralCombiner(rgb=RGBPortion(**fields)),))


def general_alpha(**fields):
    return combined(general=(GeneralCombiner(alpha=AlphaPortion(**fields)),))


def final(**fields):
    return combined(final=replace(FinalCombiner(), **fields))


def textured(texture="checker", mesh=MESH, **fields):
    unit = TextureUnit(texture, **fields)
    return MIPMAPPED, draw(mesh, texture_units=(unit,), register_combiners=COMBINERS)


def environment(mode, texture=MIPMAPPED, **fields):
    unit = TextureUnit(texture.texture, environment=TextureEnvironment(mode, **fields))
    return texture, draw(texture_units=(unit,))


def generated(*modes, mesh=MESH):
    gen = tuple(TexGen(mode) for mode in modes) + (TexGen(),) * (4 - len(modes))
    return textured(mesh=mesh, gen=gen)


def levels(*sizes, target=TextureTarget.TEXTURE_2D, faces=1, dtype=np.uint8):
    return Texture(target, InternalFormat.RGBA8, tuple(np.zeros((faces, h, w, 4), dtype) for w, h in sizes))


def store(image, texture="made"):
    return TexImage(label="store", texture=texture, image=image)


def without(**fields):
    """A GeForce 256 that lacks something."""
    return GEFORCE_256.changed(**fields)


ALPHA, BLUE, RGB = ComponentUsage.ALPHA, ComponentUsage.BLUE, ComponentUsage.RGB
PRODUCT = CombinerInput(Register.E_TIMES_F)
COLOR_SUM = CombinerInput(Register.SPARE0_PLUS_SECONDARY_COLOR)


def read(**fields):
    return ReadPixels(label="read", **{"name": "x", **fields})


def copy(**fields):
    return CopyTexImage(label="copy", **{"texture": "copied", **fields})


def sub(**fields):
    return CopyTexSubImage(label="part", **{"texture": "checker", "width": 1, "height": 1, **fields})


# Each: what is refused, words of the sentence, and an accepted neighbour of it.
REFUSED = {
    # commands
    "a command of no kind": (
        "draw it",
        ["Command 0:", "'draw it' is no command", "CopyTexSubImage"],
        Clear(label="x"),
    ),
    "an empty label": (Clear(label=" "), ["label is empty", "name"], Clear(label="clear")),
    "a label of another type": (Clear(label=3), ["label is 3", "string"], Clear(label="3")),
    "an empty texture name": (store(MIPMAPPED.image, ""), ["texture is empty"], MIPMAPPED),
    "a state of another type": (
        Draw(label="pass", mesh=MESH, state=None),
        ['Command 0, "pass":', "state is None", "give a value of type PassState"],
        draw(),
    ),
    "a mesh of another type": (
        Draw(label="pass", mesh=TRIANGLE, state=PassState()),
        ["mesh is", "give a value of type Mesh"],
        draw(),
    ),
    "a texture of another type": (store(TRIANGLE), ["image is", "give a value of type Texture"], MIPMAPPED),
    # types of fields
    "a string where an enum belongs": (
        draw(blending=Blending(source="ONE")),
        ["state.blending.source is the string 'ONE'", "BlendFactor.ONE"],
        draw(blending=Blending(source=BlendFactor.ONE)),
    ),
    "a number where an enum belongs": (
        draw(logic_op=6),
        ["state.logic_op is 6", "member of LogicOperation", "LogicOperation.CLEAR"],
        draw(logic_op=LogicOperation.XOR),
    ),
    "a number where a switch belongs": (
        draw(color_sum=1),
        ["state.color_sum is 1", "True or False"],
        draw(color_sum=True),
    ),
    "a float where an integer belongs": (
        draw(scissor=Scissor(0, 0, 4.5, 4)),
        ["state.scissor.width is 4.5", "integer"],
        draw(scissor=Scissor(0, 0, np.int32(4), 4)),
    ),
    "an integer beyond 32 bits": (
        draw(scissor=Scissor(2**31, 0, 4, 4)),
        ["state.scissor.x is 2147483648", "32 bits"],
        draw(scissor=Scissor(2**31 - 1, 0, 4, 4)),
    ),
    "a switch where a number belongs": (
        draw(alpha_test=AlphaTest(reference=True)),
        ["state.alpha_test.reference is True", "number"],
        draw(alpha_test=AlphaTest(reference=1)),
    ),
    "NaN where a number belongs": (
        draw(alpha_test=AlphaTest(reference=NAN)),
        ["state.alpha_test.reference is nan", "finite"],
        draw(alpha_test=AlphaTest(reference=np.float32(0.5))),
    ),
    "an integer no float can hold": (
        draw(alpha_test=AlphaTest(reference=10**400)),
        ["state.alpha_test.reference is 1000", "finite"],
        draw(alpha_test=AlphaTest(reference=10**40)),
    ),
    "a color of three": (
        Clear(label="clear", color=(0.0, 0.0, 0.0)),
        ["color has 3 elements", "give 4"],
        Clear(label="clear", color=(0, 0.0, 2.0, np.float64(-1))),
    ),
    "a color that is an array": (
        Clear(label="clear", color=np.zeros(4)),
        ["color is array(", "tuple of 4"],
        Clear(label="clear", color=(0.0, 0.0, 0.0, 0.0)),
    ),
    "an infinite matrix": (
        draw(vertex=VertexState(projection=((1.0, 0.0, 0.0, INF), *VertexState().projection[1:]))),
        ["state.vertex.projection[0][3] is inf", "finite"],
        draw(vertex=VertexState(projection=((1.0, 0.0, 0.0, 1e308), *VertexState().projection[1:]))),
    ),
    "a list of lights": (
        draw(vertex=VertexState(lighting=Lighting(lights=[Light()]))),
        ["state.vertex.lighting.lights is [Light", "give a tuple"],
        draw(vertex=VertexState(lighting=Lighting(lights=(Light(),)))),
    ),
    "a stage that is no stage": (
        combined(general=(RGBPortion(),)),
        ["state.register_combiners.general[0] is RGBPortion", "give a value of type GeneralCombiner"],
        combined(),
    ),
    # clearing
    "a clear depth beyond one": (
        Clear(label="c", depth=1.5),
        ["depth is 1.5", "0 (near) to 1"],
        Clear(label="c", depth=1.0),
    ),
    "a clear stencil of nine bits": (
        Clear(label="c", stencil=256),
        ["256", "0 to 255"],
        Clear(label="c", stencil=255),
    ),
    "a stencil clear mask of nine bits": (
        Clear(label="c", stencil_write_mask=-1),
        ["stencil_write_mask is -1", "0 to 255"],
        Clear(label="c", stencil_write_mask=0),
    ),
    "a scissor box of negative size": (
        Clear(label="c", scissor=Scissor(0, 0, 1, -1)),
        ["scissor box is 1x-1", "not negative"],
        Clear(label="c", scissor=Scissor(-5, -5, 1, 0)),
    ),
    # meshes
    "positions of one component": (
        draw(Mesh(TRIANGLE[:, :1])),
        ["positions has shape (3, 1)", "2 to 4"],
        draw(Mesh(TRIANGLE[:, :2])),
    ),
    "positions of no rows": (
        draw(Mesh(np.zeros(3))),
        ["positions has shape (3,)"],
        draw(Mesh(np.zeros((0, 3)))),
    ),
    "a NaN position": (
        draw(Mesh(np.where(TRIANGLE == 1, NAN, TRIANGLE))),
        ["positions of vertex 1 holds nan", "finite"],
        draw(Mesh(TRIANGLE * 1e300)),
    ),
    "an infinite color": (
        draw(Mesh(TRIANGLE, colors=TRIANGLE - INF)),
        ["colors of vertex 0 holds -inf", "finite"],
        draw(Mesh(TRIANGLE, colors=TRIANGLE - 5)),
    ),
    "a NaN coordinate": (
        draw(Mesh(TRIANGLE, texture_coordinates=(TRIANGLE, TRIANGLE * NAN))),
        ["texture coordinate set 1 of vertex 0 holds nan"],
        draw(Mesh(TRIANGLE, texture_coordinates=(TRIANGLE, TRIANGLE))),
    ),
    "a NaN fog coordinate": (
        draw(Mesh(TRIANGLE, fog_coordinates=[0, 0, NAN])),
        ["fog_coordinates of vertex 2 holds nan"],
        draw(Mesh(TRIANGLE, fog_coordinates=[0, 0, 1])),
    ),
    "an infinite fog coordinate through the fixed functions": (
        draw(Mesh(TRIANGLE, fog_coordinates=[0, INF, 0]), fog=Fog()),
        ["fog_coordinates of vertex 1 holds inf", "A vertex program's results alone may have others"],
        draw(Mesh(TRIANGLE, fog_coordinates=[0, 3e38, 0]), fog=Fog()),
    ),
    "fog coordinates in columns": (
        draw(Mesh(TRIANGLE, fog_coordinates=TRIANGLE)),
        ["fog_coordinates has shape (3, 3)", "[vertices]"],
        draw(Mesh(TRIANGLE, fog_coordinates=TRIANGLE[:, 0])),
    ),
    "normals of another length": (
        draw(Mesh(TRIANGLE, normals=TRIANGLE[:2])),
        ["normals has 2 vertices but positions has 3"],
        draw(Mesh(TRIANGLE, normals=TRIANGLE)),
    ),
    "secondary colors without blue": (
        draw(Mesh(TRIANGLE, secondary_colors=np.zeros((3, 2)))),
        ["secondary_colors has shape (3, 2)", "[vertices, 3 to 4]"],
        draw(Mesh(TRIANGLE, secondary_colors=TRIANGLE)),
    ),
    "a light's range without a lighting unit": (
        lit(Light(position=(0.0, 0.0, 1.0, 1.0), range=2.0)),
        ["light 0.range is 2.0", "OpenGL's equations", "profile with a lighting unit"],
        lit(Light(position=(0.0, 0.0, 1.0, 1.0))),
    ),
    "specular coefficients without a lighting unit": (
        lit(front=Material(specular_coefficients=(0.0,) * 6)),
        ["lighting.front.specular_coefficients", "OpenGL's equations"],
        lit(front=Material()),
    ),
    "a secondary colour that is not handed on, without a lighting unit": (
        draw(vertex=VertexState(secondary_color=SecondaryColor.DISABLED)),
        ["vertex.secondary_color", "OpenGL's equations"],
        draw(vertex=VertexState()),
    ),
    "a viewer's direction without a lighting unit": (
        lit(viewer_direction=(0.0, 0.0, -1.0)),
        ["lighting.viewer_direction is (0.0, 0.0, -1.0)"],
        lit(),
    ),
    "two sides of a program in the fixed-function stage": (
        draw(vertex=VertexState(two_side=True)),
        ["vertex.two_side is VERTEX_PROGRAM_TWO_SIDE", "FIXED_FUNCTION", "lighting.two_side"],
        draw(vertex=VertexState(two_side=True, stage=VertexStage.PROGRAM_RESULTS)),
    ),
    "an index beyond the vertices": (
        draw(Mesh(TRIANGLE, indices=[0, 1, 3])),
        ["index 2 of the mesh is vertex 3", "has 3 vertices", "0 to 2"],
        draw(Mesh(TRIANGLE, indices=[0, 1, 2, 0])),
    ),
    "a negative index": (
        draw(Mesh(TRIANGLE, indices=[0, -1, 2])),
        ["index 1 of the mesh is vertex -1"],
        draw(Mesh(TRIANGLE, indices=[])),
    ),
    "indices in rows": (
        draw(Mesh(TRIANGLE, indices=[[0, 1, 2]])),
        ["indices has shape (1, 3)", "one list"],
        draw(Mesh(TRIANGLE, indices=[0, 1, 2])),
    ),
    "counts that do not add up": (
        draw(Mesh(TRIANGLE, PrimitiveType.TRIANGLE_STRIP, indices=[0, 1, 2, 0], counts=(3,))),
        ["counts add up to 3", "draws 4 vertices"],
        draw(Mesh(TRIANGLE, PrimitiveType.TRIANGLE_STRIP, indices=[0, 1, 2, 0], counts=(1, 3, 0))),
    ),
    "a negative count": (
        draw(Mesh(TRIANGLE, PrimitiveType.POLYGON, counts=(4, -1))),
        ["counts is (4, -1)", "none negative"],
        draw(Mesh(TRIANGLE, PrimitiveType.POLYGON, counts=(3, 0))),
    ),
    "counts that are a number": (
        draw(Mesh(TRIANGLE, counts=3)),
        ["counts is 3", "tuple"],
        draw(Mesh(TRIANGLE, counts=(3,))),
    ),
    "a primitive by name": (
        draw(Mesh(TRIANGLE, "triangles")),
        ["primitive is the string 'triangles'", "PrimitiveType.TRIANGLES"],
        draw(Mesh(TRIANGLE)),
    ),
    # textures
    "a texture of no texels": (
        store(levels((1, 0))),
        ["level 0 of the texture is 1x0", "at least 1x1"],
        store(levels((1, 1))),
    ),
    "a texture without levels": (store(levels()), ["no level 0"], store(levels((2, 2)))),
    "texels of another type": (store(levels((2, 2), dtype=float)), ["not uint8"], store(levels((2, 2)))),
    "a level of the wrong size": (
        store(levels((8, 2), (4, 2))),
        ["level 1 of a 8x2 texture is 4x2", "takes 4x1", "mipmaps=True"],
        store(levels((8, 2), (4, 1))),
    ),
    "a level below 1x1": (store(levels((2, 1), (1, 1), (1, 1))), ["3 levels"], store(levels((2, 1), (1, 1)))),
    "a texture whose edges are no powers of two": (
        store(levels((48, 100))),
        ["48x100", "powers of two", "64x128, or pad it"],
        store(levels((64, 128))),
    ),
    "a texture too large": (
        store(levels((4096, 1))),
        ["4096x1", "GeForce 256", "2048x2048"],
        store(levels((2048, 1))),
    ),
    "a cube map too large": (
        store(levels((1024, 1024), target=TextureTarget.TEXTURE_CUBE_MAP, faces=6)),
        ["1024x1024", "cube map faces up to 512x512"],
        store(levels((512, 512), target=TextureTarget.TEXTURE_CUBE_MAP, faces=6)),
    ),
    "a cube map of one face": (
        store(levels((4, 4), target=TextureTarget.TEXTURE_CUBE_MAP)),
        ["TEXTURE_CUBE_MAP has 1 face;", "takes 6"],
        CUBE,
    ),
    "a cube map that is not square": (
        store(levels((4, 8), target=TextureTarget.TEXTURE_CUBE_MAP, faces=6)),
        ["faces are 4x8", "square"],
        CUBE,
    ),
    "a 1D texture of two rows": (
        store(levels((4, 2), target=TextureTarget.TEXTURE_1D)),
        ["1D texture is 2 texels high"],
        LINE,
    ),
    "ideal texels of another shape": (
        store(replace(levels((2, 2)), ideal=(np.zeros((1, 1, 1, 4)),))),
        ["ideal levels do not have its levels' shapes"],
        store(replace(levels((2, 2)), ideal=(np.zeros((1, 2, 2, 4)),))),
    ),
    "ideal texels that are NaN": (
        store(replace(levels((1, 1)), ideal=(np.full((1, 1, 1, 4), NAN),))),
        ["ideal levels hold NaN"],
        store(replace(levels((1, 1)), ideal=(np.zeros((1, 1, 1, 4)),))),
    ),
    "an internal format by name": (
        store(replace(levels((1, 1)), internal_format="rgba8")),
        ["internal_format is the string 'rgba8'", "InternalFormat.RGBA8"],
        store(levels((1, 1))),
    ),
    # texture units
    "a third texture unit": (
        (MIPMAPPED, draw(texture_units=(None, None, TextureUnit("checker")), register_combiners=COMBINERS)),
        ["GeForce 256 has 2 texture units; this pass has 3", "Split the pass"],
        (MIPMAPPED, draw(texture_units=(None, TextureUnit("checker")), register_combiners=COMBINERS)),
    ),
    "a texture environment that the machine lacks": (
        environment(TextureEnvironmentMode.NONE),
        ["texture unit 0's environment is NONE", "GeForce 256 has MODULATE, REPLACE"],
        environment(TextureEnvironmentMode.REPLACE),
    ),
    "an unknown texture": (
        textured("chequer"),
        ["no texture 'chequer' yet", "defined so far: 'checker'", "TexImage or CopyTexImage before"],
        textured("checker"),
    ),
    "a texture defined too late": (textured()[::-1], ["no texture 'checker' yet", "none"], textured()),
    "a texture without the mipmaps its filter wants": (
        (copy(width=16, height=16), textured("copied")[1]),
        ["minifies with NEAREST_MIPMAP_LINEAR", "'copied' (16x16) has 1 level of 5", "LINEAR or NEAREST"],
        (copy(width=16, height=16), textured("copied", sampler=LINEAR)[1]),
    ),
    "a mipmapped magnification filter": (
        textured(sampler=Sampler(mag_filter=TextureFilter.LINEAR_MIPMAP_LINEAR)),
        ["magnifies with LINEAR_MIPMAP_LINEAR", "NEAREST or LINEAR"],
        textured(sampler=Sampler(mag_filter=TextureFilter.NEAREST)),
    ),
    "a level-of-detail bias too large": (
        textured(lod_bias=-4.5),
        ["level-of-detail bias -4.5", "-4.0 to 4.0"],
        textured(lod_bias=-4.0),
    ),
    "a negative coordinate set": (textured(coordinates=-1), ["coordinate set -1", "from 0"], textured()),
    "a sphere map's r": (
        generated(*[TexGenMode.SPHERE_MAP] * 3),
        ["generates r by SPHERE_MAP", "makes s, t only"],
        generated(*[TexGenMode.SPHERE_MAP] * 2),
    ),
    "a reflection map's q": (
        generated(*[TexGenMode.REFLECTION_MAP] * 4),
        ["generates q by REFLECTION_MAP", "s, t, r only"],
        generated(*[TexGenMode.REFLECTION_MAP] * 3),
    ),
    "a normal map's q": (
        generated(TexGenMode.NONE, TexGenMode.NONE, TexGenMode.NONE, TexGenMode.NORMAL_MAP),
        ["generates q by NORMAL_MAP", "s, t, r only"],
        generated(*[TexGenMode.NORMAL_MAP] * 3, TexGenMode.EYE_LINEAR),
    ),
    # vertices
    "normals through a matrix whose determinant is not finite": (
        draw(vertex=VertexState(modelview=((1e200,) * 4,) * 4, lighting=Lighting(lights=(Light(),)))),
        ["modelview", "determinant nan", "scale the matrix down"],
        draw(vertex=VertexState(modelview=((0.0,) * 4,) * 4, lighting=Lighting(lights=(Light(),)))),
    ),
    "a viewport of negative size": (
        draw(vertex=VertexState(viewport=Viewport(width=-1))),
        ["viewport is -1x32", "not negative"],
        draw(vertex=VertexState(viewport=Viewport(width=0))),
    ),
    "a viewport too large": (
        draw(vertex=VertexState(viewport=Viewport(height=2049))),
        ["viewport is 64x2049", "2048x2048"],
        draw(vertex=VertexState(viewport=Viewport(x=-100, height=2048))),
    ),
    "a depth range beyond one": (
        draw(vertex=VertexState(viewport=Viewport(far=1.5))),
        ["depth range's far is 1.5", "0 to 1"],
        draw(vertex=VertexState(viewport=Viewport(near=1.0, far=0.0))),
    ),
    "seven clip planes": (
        draw(vertex=VertexState(clip_planes=((0.0, 0.0, 1.0, 0.0),) * 7)),
        ["GeForce 256 has 6 clip planes; this pass enables 7"],
        draw(vertex=VertexState(clip_planes=((0.0, 0.0, 1.0, 0.0),) * 6)),
    ),
    "nine lights": (
        draw(vertex=VertexState(lighting=Lighting(lights=(Light(),) * 9))),
        ["GeForce 256 has 8 lights; this pass enables 9", "second pass"],
        draw(vertex=VertexState(lighting=Lighting(lights=(Light(),) * 8))),
    ),
    "a shininess too large": (
        lit(front=Material(shininess=129.0)),
        ["front material's shininess is 129.0", "0 to 128"],
        lit(front=Material(shininess=128.0)),
    ),
    "a negative shininess": (
        lit(back=Material(shininess=-1.0)),
        ["back material's shininess is -1.0"],
        lit(back=Material(shininess=0.0)),
    ),
    "a spot exponent too large": (
        lit(Light(spot_exponent=200.0)),
        ["light 0's spot exponent is 200.0"],
        lit(Light(spot_exponent=128.0)),
    ),
    "a spot cutoff of 100 degrees": (
        lit(Light(spot_cutoff=100.0)),
        ["spot cutoff is 100.0 degrees", "0 to 90, or 180"],
        lit(Light(spot_cutoff=90.0)),
    ),
    "a negative attenuation": (
        lit(Light(linear_attenuation=-0.1)),
        ["attenuation is (1.0, -0.1, 0.0)"],
        lit(Light(linear_attenuation=0.1)),
    ),
    "a positional light without attenuation": (
        lit(Light(position=(0.0, 0.0, 1.0, 1.0), constant_attenuation=0.0)),
        ["attenuations are all zero", "divides by zero"],
        lit(Light(position=(0.0, 0.0, 1.0, 0.0), constant_attenuation=0.0)),
    ),
    # register combiners: the machine
    "three general combiners": (
        combined(general=(GeneralCombiner(),) * 3),
        [
            "GeForce 256 has 2 general combiners; this pass uses 3",
            "Split the pass or choose a profile with more",
        ],
        combined(general=(GeneralCombiner(),) * 2),
    ),
    "no general combiner": (
        combined(general=()),
        ["at least one general combiner", "GeneralCombiner()"],
        combined(),
    ),
    "per-stage constants": (
        combined(general=(GeneralCombiner(constant_color1=(0.0, 0.0, 0.0, 0.0)),)),
        ["general combiner 0 has its own constant colors", "two for all stages"],
        combined(constant_color1=(9.0, -1.0, 0.0, 0.0)),
    ),
    "the register of a third unit read": (
        general(a=CombinerInput(Register.TEXTURE2)),
        ["General combiner 0 names TEXTURE2", "has 2 texture units"],
        general(a=CombinerInput(Register.TEXTURE1)),
    ),
    "the register of a third unit written": (
        general(cd_output=Register.TEXTURE3),
        ["General combiner 0 names TEXTURE3"],
        general(cd_output=Register.TEXTURE0),
    ),
    "the register of a third unit in the final combiner": (
        final(d=CombinerInput(Register.TEXTURE2)),
        ["The final combiner names TEXTURE2"],
        final(d=CombinerInput(Register.TEXTURE1)),
    ),
    # register combiners: the extension
    "blue in an RGB portion": (
        general(b=CombinerInput(Register.SPARE0, usage=BLUE)),
        ["General combiner 0, RGB portion, variable B takes BLUE", "RGB or ALPHA"],
        general(b=CombinerInput(Register.SPARE0, usage=ALPHA)),
    ),
    "RGB in an alpha portion": (
        general_alpha(c=CombinerInput(Register.SPARE0, usage=RGB)),
        ["alpha portion, variable C takes RGB", "ALPHA or BLUE"],
        general_alpha(c=CombinerInput(Register.SPARE0, usage=BLUE)),
    ),
    "the fog factor in a general combiner": (
        general(a=CombinerInput(Register.FOG, usage=ALPHA)),
        ["variable A takes the ALPHA of FOG", "only in the final combiner"],
        general_alpha(a=CombinerInput(Register.FOG, usage=BLUE)),
    ),
    "DISCARD as an input": (
        general(d=CombinerInput(Register.DISCARD)),
        ["variable D reads DISCARD"],
        general(d=CombinerInput()),
    ),
    "E_TIMES_F in a general combiner": (
        general(a=PRODUCT),
        ["reads E_TIMES_F", "only in the final combiner"],
        final(a=PRODUCT),
    ),
    "the color sum in a general combiner": (
        general(a=COLOR_SUM),
        ["reads SPARE0_PLUS_SECONDARY_COLOR", "only in the final combiner"],
        final(b=COLOR_SUM),
    ),
    "a read-only output": (
        general(ab_output=Register.CONSTANT_COLOR0),
        ["AB output, writes CONSTANT_COLOR0", "read only"],
        general(ab_output=Register.PRIMARY_COLOR),
    ),
    "ZERO as an output": (
        general(cd_output=Register.ZERO),
        ["CD output, writes ZERO", "read only"],
        general(cd_output=Register.DISCARD),
    ),
    "a pseudo-register as an output": (
        general_alpha(sum_output=Register.E_TIMES_F),
        ["sum output, writes E_TIMES_F", "final combiner computes"],
        general_alpha(sum_output=Register.SPARE1),
    ),
    "two outputs to one register": (
        general(ab_output=Register.SPARE1, cd_output=Register.SPARE1),
        ["AB output and the CD output both write SPARE1", "different registers"],
        general(ab_output=Register.SPARE1, cd_output=Register.DISCARD, sum_output=Register.DISCARD),
    ),
    "the sum to the register of a product": (
        general_alpha(cd_output=Register.SPARE0),
        ["CD output and the sum output both write SPARE0"],
        general_alpha(cd_output=Register.SPARE1),
    ),
    "a bias with a scale of four": (
        general(scale=CombinerScale.SCALE_BY_FOUR, bias=CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF),
        ["BIAS_BY_NEGATIVE_ONE_HALF with SCALE_BY_FOUR", "SCALE_BY_TWO"],
        general(scale=CombinerScale.SCALE_BY_TWO, bias=CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF),
    ),
    "a bias with a scale of one half": (
        general_alpha(scale=CombinerScale.SCALE_BY_ONE_HALF, bias=CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF),
        ["alpha portion", "with SCALE_BY_ONE_HALF"],
        general_alpha(scale=CombinerScale.SCALE_BY_ONE_HALF),
    ),
    "a dot product in an alpha portion": (
        combined(general=(GeneralCombiner(alpha=RGBPortion(ab_dot_product=True)),)),
        ["general[0].alpha is RGBPortion", "give a value of type AlphaPortion"],
        general(ab_dot_product=True, cd_dot_product=True),
    ),
    "a signed mapping in the final combiner": (
        final(d=CombinerInput(Register.SPARE0, Mapping.SIGNED_IDENTITY)),
        ["variable D, is mapped by SIGNED_IDENTITY", "UNSIGNED_INVERT"],
        final(d=CombinerInput(Register.SPARE0, Mapping.UNSIGNED_INVERT)),
    ),
    "E_TIMES_F in E": (final(e=PRODUCT), ["variable E, reads E_TIMES_F", "B, C or D"], final(d=PRODUCT)),
    "the color sum in F": (final(f=COLOR_SUM), ["variable F, reads SPARE0_PLUS"], final(c=COLOR_SUM)),
    "E_TIMES_F in G": (
        final(g=replace(PRODUCT, usage=ALPHA)),
        ["variable G, reads E_TIMES_F"],
        final(c=PRODUCT),
    ),
    "the color sum in A": (
        final(a=COLOR_SUM),
        ["variable A, reads SPARE0_PLUS_SECONDARY_COLOR", "B, C and D"],
        final(d=COLOR_SUM),
    ),
    "alpha of the color sum": (
        final(b=replace(COLOR_SUM, usage=ALPHA)),
        ["takes ALPHA of SPARE0_PLUS", "RGB only"],
        final(b=COLOR_SUM),
    ),
    "blue in D": (
        final(d=CombinerInput(Register.SPARE0, usage=BLUE)),
        ["variable D, takes BLUE", "only G may"],
        final(g=CombinerInput(Register.SPARE0, usage=BLUE)),
    ),
    "RGB in G": (
        final(g=CombinerInput(Register.SPARE0)),
        ["variable G, takes RGB", "ALPHA or BLUE"],
        final(g=CombinerInput(usage=ALPHA)),
    ),
    "DISCARD in the final combiner": (
        final(c=CombinerInput(Register.DISCARD)),
        ["variable C, reads DISCARD"],
        final(c=CombinerInput()),
    ),
    # fog and fragments
    "a negative fog density": (
        draw(fog=Fog(density=-1.0)),
        ["fog density is -1.0"],
        draw(fog=Fog(density=0.0)),
    ),
    "a composite matrix that the machine has not": (
        draw(vertex=VertexState(composite=Composite())),
        ["no Composite", "projection matrix"],
        draw(),
    ),
    "registers of fog that the machine has not": (
        draw(fog=Fog(registers=FogRegisters())),
        ["no FogRegisters", "density"],
        draw(fog=Fog()),
    ),
    "a stencil mask of nine bits": (
        draw(stencil_test=StencilTest(mask=0x1FF)),
        ["stencil mask is 511", "0 to 255"],
        draw(stencil_test=StencilTest(mask=0xFF, reference=-7)),
    ),
    "a stencil write mask of 32 bits": (
        draw(stencil_test=StencilTest(write_mask=-1)),
        ["write_mask is -1"],
        draw(stencil_test=StencilTest(write_mask=0)),
    ),
    "a source factor of the source": (
        draw(blending=Blending(source=BlendFactor.SRC_COLOR)),
        ["does not take SRC_COLOR as its source blend factor", "DST_COLOR"],
        draw(blending=Blending(source=BlendFactor.DST_COLOR)),
    ),
    "a destination factor of the destination": (
        draw(blending=Blending(destination=BlendFactor.DST_COLOR)),
        ["does not take DST_COLOR as its destination blend factor", "SRC_COLOR"],
        draw(blending=Blending(destination=BlendFactor.SRC_COLOR)),
    ),
    "saturation of the destination": (
        draw(blending=Blending(destination=BlendFactor.SRC_ALPHA_SATURATE)),
        ["does not take SRC_ALPHA_SATURATE as its destination"],
        draw(blending=Blending(source=BlendFactor.SRC_ALPHA_SATURATE)),
    ),
    # rectangles
    "a read outside the framebuffer": (
        read(x=60, width=5, height=1),
        ["5x1 at (60, 0) reaches outside the framebuffer, which is 64x32"],
        read(x=60, width=4, height=1),
    ),
    "a read below the framebuffer": (read(y=-1, height=1), ["at (0, -1) reaches outside"], read(y=31)),
    "a read of negative size": (read(width=-1), ["-1x32", "not negative"], read(width=0)),
    "a read that begins outside": (read(x=65), ["-1x32"], read(x=63)),
    "an unknown format": (
        read(format="ABGR"),
        ["no format 'ABGR'", "LUMINANCE_ALPHA"],
        read(format="LUMINANCE_ALPHA"),
    ),
    "two reads of one name": (
        (read(), read()),
        ["Command 1", "already has the name 'x'"],
        (read(), read(name="y")),
    ),
    "a copy outside the framebuffer": (
        copy(y=1, width=32, height=32),
        ["32x32 at (0, 1) reaches outside the framebuffer"],
        copy(width=32, height=32),
    ),
    "a copy whose edges are no powers of two": (
        copy(x=1),
        ["63x32", "powers of two", "64x32"],
        copy(x=32),
    ),
    "a copy of no pixels": (copy(width=0), ["0x32", "at least 1x1"], copy(width=1)),
    "a partial copy into no texture": (sub(), ["no texture 'checker' yet"], (MIPMAPPED, sub())),
    "a partial copy outside the texture": (
        (MIPMAPPED, sub(x_offset=7, width=2)),
        ["2x1 at (7, 0) reaches outside level 0 of 'checker', which is 8x4"],
        (MIPMAPPED, sub(x_offset=6, width=2)),
    ),
    "a partial copy outside a level": (
        (MIPMAPPED, sub(level=1, y_offset=2)),
        ["outside level 1 of 'checker', which is 4x2"],
        (MIPMAPPED, sub(level=1, y_offset=1)),
    ),
    "a partial copy outside the framebuffer": (
        (MIPMAPPED, sub(x=64)),
        ["1x1 at (64, 0) reaches outside the framebuffer"],
        (MIPMAPPED, sub(x=63)),
    ),
    "a partial copy into a missing level": (
        (MIPMAPPED, sub(level=4)),
        ["level 4 of 'checker' does not exist", "0 to 3"],
        (MIPMAPPED, sub(level=3)),
    ),
    "a partial copy into a missing face": (
        (MIPMAPPED, sub(face=1)),
        ["face 1 of 'checker' does not exist", "face 0 only"],
        (CUBE, sub(texture="cube", face=5)),
    ),
    "a partial copy into a seventh face": (
        (CUBE, sub(texture="cube", face=6)),
        ["faces 0 to 5"],
        (CUBE, sub(texture="cube")),
    ),
    "a partial copy of two rows into a 1D texture": (
        (LINE, sub(texture="line", height=2)),
        ["1x2 at (0, 0) reaches outside level 0 of 'line'"],
        (LINE, sub(texture="line")),
    ),
    "a copy of two rows as a 1D texture": (
        copy(target=TextureTarget.TEXTURE_1D, width=4, height=2),
        ["a TEXTURE_1D has one row", "this rectangle has 2"],
        copy(target=TextureTarget.TEXTURE_1D, width=4, height=1),
    ),
    "a copy as a cube map": (
        copy(target=TextureTarget.TEXTURE_CUBE_MAP, width=4, height=4),
        ["CopyTexImage defines 1D and 2D textures", "CopyTexSubImage"],
        copy(width=4, height=4),
    ),
    "mipmaps generated from a smaller level": (
        (MIPMAPPED, sub(level=1, generate_mipmap=True)),
        ["generated from level 0, not from level 1"],
        (MIPMAPPED, sub(generate_mipmap=True)),
    ),
    "a level beyond those that were generated": (
        (copy(width=4, height=2, generate_mipmap=True), sub(texture="copied", level=3)),
        ["level 3 of 'copied' does not exist", "0 to 2"],
        (copy(width=4, height=2, generate_mipmap=True), sub(texture="copied", level=2)),
    ),
}


def as_tuple(commands):
    return commands if isinstance(commands, tuple) else (commands,)


@pytest.mark.parametrize(("refused", "words", "accepted"), REFUSED.values(), ids=REFUSED)
def test_it_is_refused_in_a_sentence_and_its_neighbour_is_accepted(refused, words, accepted):
    with pytest.raises(UnsupportedState) as caught:
        check(*as_tuple(refused))
    message = str(caught.value)
    assert all(word in message for word in words), message
    assert message.startswith("Command ") and message.endswith("."), message
    check(*as_tuple(accepted))


# What only another machine lacks: field and its value, a pass, words of the sentence.
LACKING = {
    "max_general_combiners": (0, combined(), "has no register combiners"),
    "max_texture_units": (
        1,
        general(b=CombinerInput(Register.TEXTURE1)),
        "has 1 texture unit, so that register",
    ),
    "power_of_two_textures": (True, store(levels((3, 3))), "4x4, or pad it"),
    "texture_borders": (frozenset({0}), store(replace(levels((3, 3)), border=1)), "has a border of 1"),
    "max_texture_size": (4, MIPMAPPED, "up to 4x4"),
    "max_cube_map_texture_size": (2, CUBE, "up to 2x2"),
    "color_key_operations": (
        frozenset(),
        textured(
            sampler=Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST), color_key=ColorKey((0.0,) * 4)
        ),
        "GeForce 256 has no color keys",
    ),
    "max_lod_bias": (0.0, textured(lod_bias=0.5), "takes 0.0 to 0.0. Set lod_bias"),
    "max_lights": (1, lit(Light(), back=Material(shininess=200.0)), "shininess is 200.0"),
    "max_shininess": (64.0, lit(front=Material(shininess=65.0)), "0 to 64.0"),
    "max_point_size": (2.0, draw(point=PointState(size=2.5)), "the point size is 2.5; .* from 0 to 2.0"),
    "max_line_width": (2.0, draw(line=LineState(width=2.5)), "the line width is 2.5; .* from 0 to 2.0"),
    "max_window_rectangles": (
        1,
        draw(window_clip=WindowClip((Scissor(0, 0, 1, 1),) * 2)),
        "has 2 rectangles; GeForce 256 takes 1 to 1",
    ),
    "point_sprite_units": (
        frozenset({1}),
        textured(coord_replace=True),
        "texture unit 0 has coord_replace; point sprites of GeForce 256 replace the coordinates of units: 1",
    ),
    "point_parameters": (
        False,
        draw(point=PointState(parameters=PointParameters())),
        "GeForce 256 has no point parameters",
    ),
    "max_clip_planes": (
        0,
        draw(vertex=VertexState(clip_planes=((0.0, 0.0, 0.0, 1.0),))),
        "has 0 clip planes",
    ),
    "stencil_bits": (
        0,
        draw(stencil_test=StencilTest()),
        "it tests the stencil buffer, and GeForce 256 has none",
    ),
    "texture_targets": (
        frozenset({TextureTarget.TEXTURE_2D}),
        CUBE,
        "no TEXTURE_CUBE_MAP; it has TEXTURE_2D",
    ),
    "internal_formats": (frozenset({InternalFormat.RGB8}), copy(), "does not store RGBA8; it stores RGB8"),
    "wrap_modes": (
        frozenset({WrapMode.CLAMP}),
        textured(sampler=Sampler(wrap_s=WrapMode.CLAMP)),
        "no REPEAT, which texture unit 0 asks for wrap_t; it has CLAMP",
    ),
    "texture_compare_modes": (
        frozenset({TextureCompareMode.NONE}),
        textured(sampler=Sampler(compare_mode=TextureCompareMode.COMPARE_R_TO_TEXTURE)),
        "no COMPARE_R_TO_TEXTURE, which texture unit 0 asks for compare_mode; it has NONE",
    ),
    "texgen_modes": (
        frozenset({TexGenMode.OBJECT_LINEAR}),
        generated(TexGenMode.EYE_LINEAR),
        "cannot generate s by EYE_LINEAR; it has OBJECT_LINEAR",
    ),
    "blend_equations": (
        frozenset({BlendEquation.FUNC_ADD}),
        draw(blending=Blending(equation=BlendEquation.MIN)),
        "no blend equation MIN; it has FUNC_ADD",
    ),
    "blend_factors_source": (
        frozenset({BlendFactor.ZERO}),
        draw(blending=Blending()),
        "does not take ONE as its source",
    ),
    "blend_factors_destination": (
        frozenset({BlendFactor.ONE}),
        draw(blending=Blending()),
        "ZERO as its destination",
    ),
    "stencil_operations": (
        frozenset({StencilOperation.KEEP}),
        draw(stencil_test=StencilTest(depth_fail=StencilOperation.INCR_WRAP)),
        "no stencil operation INCR_WRAP [(]depth_fail[)]; it has KEEP",
    ),
    "logic_op": (False, draw(logic_op=LogicOperation.XOR), "no logic operations"),
    "fog_coordinate": (
        False,
        draw(fog=Fog(coordinate_source=FogCoordinateSource.FOG_COORDINATE)),
        "no FOG_COORDINATE; use FRAGMENT_DEPTH",
    ),
    "smoothing_samples": ((), draw(polygon=PolygonState(smooth=True)), "no smooth lines and polygons"),
    "composite_matrix": (False, draw(vertex=VertexState(composite=Composite())), "has no Composite"),
    "vertex_weighting": (False, draw(vertex=VertexState(modelview1=IDENTITY)), "has no vertex weighting"),
    "fog_registers": (False, draw(fog=Fog(registers=FogRegisters())), "has no FogRegisters"),
    "separate_specular_color": (False, lit(separate_specular_color=True), "no SEPARATE_SPECULAR_COLOR"),
    "color_sum": (False, draw(color_sum=True), "no color sum of vertices' secondary colors"),
    "depth_clamp": (False, draw(depth_clamp=DepthClamp()), "no DEPTH_CLAMP; leave depth_clamp None"),
    "ycbcr_conversion": (False, draw(ycbcr_conversion=True), "InternalFormat.YCBCR"),
    "w_buffering": (False, draw(w_buffering=True), "no W buffering"),
}


def test_every_limit_set_and_switch_of_a_profile_is_checked():
    limits = {name for name, section in SECTION_OF.items() if section != "arithmetic"}
    with_tests_of_their_own = {
        "per_stage_constants",
        "max_viewport",
        "depth_bits",
        "surface_formats",
        "shared_depth",
    }
    with_tests_of_their_own |= {"texture_shader_operations", "dot_product_mappings", "combiner_flags"}
    with_tests_of_their_own |= {"blue_to_alpha", "final_alpha_from_blue"}  # test_drivers.py the latter
    with_tests_of_their_own |= {"foreign_texture_targets"}
    with_tests_of_their_own |= {
        "offset_scale_clamped"
    }  # what it lacks is not refused; test_texture_shader.py
    with_tests_of_their_own |= {"hilo_as_color"}  # test_signed_formats.py: it refuses nothing
    with_tests_of_their_own |= {"border_color_as_given"}  # test_borders.py: it refuses nothing
    with_tests_of_their_own |= {"roughness_lookups"}  # test_roughness.py
    with_tests_of_their_own |= {"max_anisotropy"}  # test_anisotropic.py
    with_tests_of_their_own |= {"depth_texture_modes", "depths_as_colors"}  # test_sampling.py
    with_tests_of_their_own |= {"depth_units_in_coordinates"}  # nothing lacks it
    with_tests_of_their_own |= {  # test_nv2a_textures.py
        "max_3d_texture_size",
        "signed_components",
        "cylinder_wrap",
        "perspective_hint",
    }
    with_tests_of_their_own |= {"max_pixel_map_table"}  # test_transfer.py
    with_tests_of_their_own |= {"shades_samples"}  # test_multisample.py: it refuses nothing
    with_tests_of_their_own |= {  # test_machines.py
        "max_probes",
        "exact_probes",
        "max_color_table_size",
        "max_convolution_size",
        "auxiliary_buffers",
        "accumulation_bits",
        "color_bits",
        "samples",
        "shadow_functions",
        "texture_environment_modes",
        "combine_functions",
        "combiner_functions",
        "line_stipple",
        "texture_environment_crossbar",
        "shadow_ambient",
        "texture_color_table",
        "color_matrix",
        "color_tables",
        "convolution",
        "histogram",
        "transfers_texture_queries",
        "pixel_texture",
        "pixel_texture_sgis",
        "impact_pixel_texture",
        "combiner_lookup",
        "evaluate_before_filtering",
        "spherical_interpolation",
    }
    assert set(LACKING) | with_tests_of_their_own == limits


@pytest.mark.parametrize("field", LACKING)
def test_a_machine_that_lacks_it_refuses_it(field):
    value, commands, words = LACKING[field]
    with pytest.raises(UnsupportedState, match=words):
        check(*as_tuple(commands), profile=without(**{field: value}))


def test_what_the_refusal_of_a_color_sum_names_adds_the_secondary_colors():
    first, second = np.array([[0.25, 0.5, 0.75]] * 3), np.array([[0.125, 0.75, 0.0]] * 3)
    both = Mesh(TRIANGLE, colors=first, secondary_colors=second)
    again = Mesh(TRIANGLE, colors=second)
    one = Blending(BlendFactor.ONE, BlendFactor.ONE)
    summed = execute((draw(both, color_sum=True),), GEFORCE_256, 8, 8).image()
    twice = execute(
        (draw(Mesh(TRIANGLE, colors=first)), draw(again, blending=one)), GEFORCE_256, 8, 8
    ).image()
    np.testing.assert_allclose(summed[..., :3].astype(int), twice[..., :3], atol=1)
    assert summed.any()


def test_vertex_weighting_takes_w_from_one_matrix_and_is_no_vertex_program_s():
    check(draw(vertex=VertexState(modelview1=IDENTITY)))
    other = (*IDENTITY[:3], (0.0, 0.0, 0.5, 1.0))
    with pytest.raises(UnsupportedState, match=r"last row of vertex.modelview is .* Give the same last row"):
        check(draw(vertex=VertexState(modelview1=other)))
    with pytest.raises(UnsupportedState, match=r"vertex.modelview1 is set, but the vertex stage is PROGRAM"):
        check(draw(vertex=VertexState(stage=VertexStage.PROGRAM_RESULTS, modelview1=IDENTITY)))


def test_normals_need_both_determinants_of_vertex_weighting():
    huge = ((1e200, 0.0, 0.0, 0.0), (0.0, 1e200, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    check(draw(vertex=VertexState(modelview1=huge)))
    with pytest.raises(UnsupportedState, match="has the determinant inf"):
        check(draw(vertex=VertexState(modelview1=huge, lighting=Lighting((Light(),)))))


@pytest.mark.parametrize("field", ["projection", "viewport"])
def test_a_composite_matrix_leaves_projection_and_viewport_alone(field):
    other = {"projection": ((2.0, 0.0, 0.0, 0.0), *VertexState().projection[1:]), "viewport": Viewport(x=1)}
    composite = Composite(offset=(0.5, 0.5, 0.0))
    check(draw(vertex=VertexState(composite=composite)), profile=NV2A)
    with pytest.raises(UnsupportedState, match=f"vertex.{field} is set beside vertex.composite"):
        check(draw(vertex=VertexState(composite=composite, **{field: other[field]})), profile=NV2A)


def test_a_machine_without_a_stencil_buffer_neither_clears_nor_reads_it():
    bare = without(stencil_bits=0)
    with pytest.raises(UnsupportedState, match="clears the stencil buffer"):
        check(Clear(label="c", stencil=0), profile=bare)
    with pytest.raises(UnsupportedState, match="reads the stencil buffer"):
        check(read(format="STENCIL_INDEX"), profile=bare)
    check(Clear(label="c", depth=1.0), read(format="DEPTH_COMPONENT"), profile=bare)


@pytest.mark.parametrize(
    ("width", "height", "depth_bits", "words"),
    [
        (0, 8, 24, "0x8; give at least 1x1"),
        (8, -1, 24, "8x-1; give at least"),
        (8.0, 8, 24, "width is 8.0; give an integer"),
        (2049, 8, 24, "up to 2048x2048. Draw it in tiles"),
        (8, 8, 32, "32 bits of depth; GeForce 256 has 16 or 24"),
    ],
)
def test_a_framebuffer_that_cannot_be_is_refused(width, height, depth_bits, words):
    with pytest.raises(UnsupportedState, match=words):
        validate((), GEFORCE_256, width, height, depth_bits)


def test_the_largest_framebuffer_is_accepted_at_both_depths():
    validate((), GEFORCE_256, 2048, 1, 16)
    validate((), GEFORCE_256, 1, 2048, 24)


def test_a_single_command_is_not_a_frame():
    with pytest.raises(UnsupportedState, match=r"this is one Clear\. Write \(command,\)"):
        validate(Clear(label="c"), GEFORCE_256, 8, 8)


@pytest.mark.parametrize(
    ("frame", "words"),
    [(Clear(label="c"), r"this is one Clear\. Write \(command,\)"), (None, r"this is None\. Give a tuple")],
)
def test_what_is_no_frame_is_refused_by_machine_and_ideal(frame, words):
    for run in (lambda: execute(frame, GEFORCE_256, 2, 2), lambda: execute_ideal(frame, 2, 2)):
        with pytest.raises(UnsupportedState, match=words):
            run()


@pytest.mark.parametrize("profile", ["GEFORCE_256", None, Profile])
def test_what_is_no_profile_makes_no_machine(profile):
    with pytest.raises(ValueError, match=r"machine's profile is .*; give a Profile"):
        Machine(profile, 2, 2)


@pytest.mark.parametrize("bits", [8.0, "8", True, [8]])
def test_color_bits_are_an_integer(bits):
    with pytest.raises(UnsupportedState, match=r"framebuffer's color_bits is .*; give an integer"):
        execute((), GEFORCE_256, 2, 2, color_bits=bits)


def test_rows_of_different_lengths_are_no_image_and_no_bitmap():
    with pytest.raises(ValueError, match="image's values have rows of different lengths"):
        PixelImage([[1.0], [1.0, 2.0]])
    with pytest.raises(ValueError, match="bitmap's bits have rows of different lengths"):
        Bitmap(label="b", bits=[[1], [1, 0]])


def test_a_refusal_is_a_value_error_that_names_the_commands_number_and_label():
    with pytest.raises(ValueError, match=r'^Command 2, "pass": '):
        check(Clear(label="c"), MIPMAPPED, combined(general=()))


def test_textures_of_an_earlier_frame_are_known_when_given():
    _, pass_ = textured()
    check(pass_, textures={"checker": MIPMAPPED.image})
    with pytest.raises(UnsupportedState, match="no texture 'checker'"):
        check(pass_, textures={})


def test_a_texture_may_lose_its_mipmaps_between_two_draws_of_one_unit():
    store_, pass_ = textured()
    with pytest.raises(UnsupportedState, match=r"Command 3.*1 level of 7"):
        check(store_, pass_, copy(texture="checker"), pass_)


def test_a_bad_mesh_is_refused_every_time():
    bad = draw(Mesh(TRIANGLE * NAN))
    for _ in range(2):
        with pytest.raises(UnsupportedState, match="vertex 0 holds nan"):
            check(bad)


def test_what_was_found_right_is_refused_where_it_is_not():
    """Findings are kept; they hold for these objects, this machine, these textures and this kind of mesh."""
    store_, pass_ = textured()
    check(store_, pass_)
    check(store_, pass_)
    refusals = [
        ({"commands": (pass_,)}, "no texture 'checker'"),
        ({"commands": (store_, copy(texture="checker"), pass_)}, "1 level of 7"),
        ({"commands": (store_, replace(pass_, mesh=Mesh(TRIANGLE * NAN)))}, "vertex 0 holds nan"),
        ({"commands": (store_, replace(pass_, mesh=None))}, "mesh is None"),
        ({"commands": (store_, replace(pass_, label=""))}, "label is empty"),
        ({"commands": (store_, replace(pass_, label=7))}, "label is 7"),
        ({"commands": (store_, pass_), "profile": GEFORCE_256.changed(max_texture_units=0)}, "0 texture"),
        ({"commands": (store_, pass_), "profile": GEFORCE_256.changed(max_texture_size=2)}, "up to 2x2"),
    ]
    for options, words in refusals * 2:
        with pytest.raises(UnsupportedState, match=words):
            check(*options["commands"], profile=options.get("profile", GEFORCE_256))


def test_equal_states_are_not_the_same_state():
    right = draw(depth_test=DepthTest(write=True))
    wrong = draw(depth_test=DepthTest(write=1))
    assert right == wrong
    clear, odd = Clear(label="c", stencil=1), Clear(label="c", stencil=True)
    assert clear == odd
    for command, twin, words in ((right, wrong, "write is 1;"), (clear, odd, "stencil is True")):
        check(command)
        with pytest.raises(UnsupportedState, match=words):
            check(command, twin)


def test_findings_on_more_states_than_are_kept_stay_right(monkeypatch):
    monkeypatch.setattr("fixedpipe.pipeline.validation.walk._taken", Remembered(1))
    good = [draw(depth_test=DepthTest(), fog=Fog(density=k / 8)) for k in range(40)]
    monkeypatch.setattr(taken_by(GEFORCE_256).states, "most", 8)
    for _ in range(2):
        check(*good)
        with pytest.raises(UnsupportedState, match=r"the fog density is -1\.0"):
            check(*good, draw(fog=Fog(density=-1.0)))
    assert len(taken_by(GEFORCE_256).states) <= 8


def test_leftover_vertices_are_opengls_business():
    for primitive in PrimitiveType:
        check(draw(Mesh(np.zeros((5, 3)), primitive)), draw(Mesh(TRIANGLE[:1], primitive)))


def test_a_full_pass_is_accepted():
    unit = TextureUnit("checker", lod_bias=1.0)
    state = PassState(
        vertex=VertexState(lighting=Lighting(lights=(Light(spot_cutoff=30.0),), two_side=True)),
        polygon=PolygonState(offset_fill=True, offset_factor=1.0),
        texture_units=(unit, unit),
        register_combiners=RegisterCombiners(general=(GeneralCombiner(), GeneralCombiner())),
        color_sum=True,
        fog=Fog(mode=FogMode.LINEAR, start=1.0, end=0.0),
        scissor=Scissor(0, 0, 8, 8),
        alpha_test=AlphaTest(),
        stencil_test=StencilTest(fail=StencilOperation.DECR_WRAP),
        depth_test=DepthTest(write=False),
        blending=Blending(BlendFactor.ONE, BlendFactor.ONE, BlendEquation.MAX),
    )
    check(Clear(label="c", stencil=3), MIPMAPPED, Draw(label="all", mesh=MESH, state=state), copy(), read())


def test_the_ideal_machine_takes_what_the_geforce_refuses():
    check(
        store(levels((48, 100)), "odd"),
        draw(
            texture_units=(None, None, None, TextureUnit("odd", sampler=LINEAR)),
            register_combiners=RegisterCombiners(
                general=(GeneralCombiner(constant_color0=(1.0, 1.0, 1.0, 1.0)),) * 8,
                final=FinalCombiner(d=CombinerInput(Register.TEXTURE3)),
            ),
        ),
        profile=IDEAL,
    )


def test_the_ideal_machine_has_no_buffer_for_a_vertex_program_s_depths():
    command = draw(vertex=VertexState(stage=VertexStage.PROGRAM_RESULTS))
    with pytest.raises(UnsupportedState, match="ideal has no such buffer: choose FIXED_FUNCTION"):
        check(command, profile=IDEAL)


@settings(max_examples=60)
@given(register_combiners(max_stages=2, units=2))
def test_every_state_that_the_extension_allows_is_accepted(combiners):
    check(draw(register_combiners=combiners))


@settings(max_examples=20)
@given(register_combiners(max_stages=8, units=4, per_stage_constants=True))
def test_every_wide_state_that_the_extension_allows_is_accepted_by_the_ideal_machine(combiners):
    check(draw(register_combiners=combiners), profile=IDEAL)


@pytest.mark.parametrize(
    ("arrays", "sentence"),
    [
        ({"positions": [[1.0, 2.0], [3.0]]}, "positions have rows of different lengths"),
        ({"positions": "abc"}, "positions are of type <U3; give numbers"),
        ({"positions": [[None, 0.0]]}, "positions are of type object; give numbers"),
        ({"positions": TRIANGLE * 1j}, "positions are of type complex128; give numbers"),
        ({"positions": TRIANGLE, "indices": [0, 1.5, 2]}, "indices are of type float64; give whole numbers"),
        ({"positions": TRIANGLE, "colors": [["red"]] * 3}, "colors are of type <U3; give numbers"),
        ({"positions": TRIANGLE, "texture_coordinates": ("st",)}, "texture_coordinates are of type <U2"),
    ],
)
def test_vertex_arrays_that_are_no_numbers_are_refused_when_the_mesh_is_made(arrays, sentence):
    with pytest.raises(ValueError, match=sentence):
        Mesh(**arrays)


def test_a_mesh_may_have_no_indices_in_its_list():
    assert Mesh(TRIANGLE, indices=[]).indices.shape == (0,)


@pytest.mark.parametrize(
    ("state", "words"),
    [
        (PassState(polygon=PolygonState(stipple=bytes(127))), "has 127 bytes; give 32 rows of 4"),
        (
            PassState(point=PointState(program_size=True)),
            "point.program_size takes no part .* FIXED_FUNCTION",
        ),
        (PassState(point=PointState(sprite=True)), "GeForce 256 has no point sprites"),
        (PassState(line=LineState(width=-1.0)), "the line width is -1.0"),
    ],
)
def test_points_lines_and_stipple(state, words):
    with pytest.raises(UnsupportedState, match=words):
        check(Draw(label="pass", mesh=MESH, state=state))


@pytest.mark.parametrize("name", ["point_sizes", "edge_flags", "fog_coordinates", "weights"])
def test_vertex_columns_have_one_value_for_each_vertex(name):
    with pytest.raises(UnsupportedState, match=f"{name} has 2 vertices but positions has 3"):
        check(draw(replace(MESH, **{name: np.ones(2, bool if name == "edge_flags" else float)})))


UNIT = GEFORCE_256.changed(lighting=LightingArithmetic.LIGHTING_UNIT)
CONE = Spot((0.0, 0.0, -1.0, 0.0), (0.0, 1.0, 0.0))


@pytest.mark.parametrize(
    ("light", "words"),
    [
        (Light(range=2.0), ["light 0 is directional", "no range"]),
        (Light(spot=CONE), ["light 0 is directional", "no spot"]),
        (
            Light(position=(0.0, 0.0, 1.0, 1.0), half_vector=(0.0, 0.0, 1.0)),
            ["light 0 is positional", "no half_vector"],
        ),
        (Light(spot_cutoff=30.0), ["light 0 is directional", "spot cutoff is 30.0", "cone's factor"]),
        (
            Light(position=(0.0, 0.0, 1.0, 1.0), spot_cutoff=30.0, spot=CONE),
            ["spot cutoff, 30.0 degrees", "leave the cutoff at 180, or the spot None"],
        ),
    ],
)
def test_a_lighting_unit_refuses_a_light_that_it_cannot_hold(light, words):
    with pytest.raises(UnsupportedState) as refused:
        check(lit(light), profile=UNIT)
    assert all(word in str(refused.value) for word in words), str(refused.value)


def test_a_lighting_unit_takes_what_equations_refuse():
    """No attenuation at all is defined there: 1/0 is infinity."""
    light = Light(position=(0.0, 0.0, 1.0, 1.0), constant_attenuation=0.0, range=1.0, spot=CONE)
    check(lit(light, viewer_direction=(0.0, 0.0, -1.0)), profile=UNIT)


def test_a_lighting_unit_takes_opengl_s_spotlights():
    check(lit(Light(position=(0.0, 0.0, 1.0, 1.0), spot_cutoff=30.0, spot_exponent=2.0)), profile=UNIT)
