"""Lights, materials, normals and clip planes, and the VertexState made from them (OpenGL 1.2.1 chapter 2).

If a machine cannot have a light, the machine refuses it, and not this module. A draw is left out if its
lights, materials, matrices or clip planes have an infinity or a NaN.
"""

from dataclasses import replace
from functools import reduce
from itertools import chain
from math import inf, isfinite
from operator import add, mul
from typing import Any

from fixedpipe.pipeline.enums import ColorMaterialParameter
from fixedpipe.pipeline.opengl import driver, tokens
from fixedpipe.pipeline.opengl.capabilities import capability
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.fragments import FACES, member, words
from fixedpipe.pipeline.opengl.matrices import times_inverse_modelview, top
from fixedpipe.pipeline.opengl.outcomes import GLError, LeftOut
from fixedpipe.pipeline.opengl.parameters import register_parameters
from fixedpipe.pipeline.opengl.values import declare, section
from fixedpipe.pipeline.state import ColorMaterial, Light, Lighting, Material, VertexState

# How many lights and clip planes a context stores, for any machine.
LIGHTS = CLIP_PLANES = 8
# The largest spot exponent and shininess (tables 2.7 and 2.8).
_LARGEST_EXPONENT = 128.0

_LIGHTING, _TRANSFORM = tokens.LIGHTING_BIT, tokens.TRANSFORM_BIT
_BLACK, _WHITE = (0.0, 0.0, 0.0, 1.0), (1.0, 1.0, 1.0, 1.0)

COLOR_MATERIAL_PARAMETERS = words(ColorMaterialParameter)
# The material's colours that follow the current colour, by the parameter of ColorMaterial.
TRACKED = {
    tokens.AMBIENT_AND_DIFFUSE: ("ambient", "diffuse"),
    tokens.AMBIENT: ("ambient",),
    tokens.DIFFUSE: ("diffuse",),
    tokens.SPECULAR: ("specular",),
    tokens.EMISSION: ("emission",),
}
_MATERIALS = {
    tokens.FRONT: ("material front",),
    tokens.BACK: ("material back",),
    tokens.FRONT_AND_BACK: ("material front", "material back"),
}
LIGHT_COLORS = {tokens.AMBIENT: "ambient", tokens.DIFFUSE: "diffuse", tokens.SPECULAR: "specular"}
LIGHT_NUMBERS = {
    tokens.SPOT_EXPONENT: "spot_exponent",
    tokens.SPOT_CUTOFF: "spot_cutoff",
    tokens.CONSTANT_ATTENUATION: "constant_attenuation",
    tokens.LINEAR_ATTENUATION: "linear_attenuation",
    tokens.QUADRATIC_ATTENUATION: "quadratic_attenuation",
}


def _settle_at_change(gl, _enabled):
    settle_materials(gl)


capability(tokens.LIGHTING, _LIGHTING)
capability(tokens.COLOR_MATERIAL, _LIGHTING, notify=_settle_at_change)
capability(tokens.NORMALIZE, _TRANSFORM)
capability(tokens.RESCALE_NORMAL, _TRANSFORM)
capability(tokens.VERTEX_WEIGHTING_EXT, _TRANSFORM)
for _i in range(LIGHTS):
    capability(tokens.LIGHT0 + _i, _LIGHTING)
    _color = _BLACK if _i else _WHITE
    declare(("light", _i), Light(diffuse=_color, specular=_color), _LIGHTING)
for _i in range(CLIP_PLANES):
    capability(tokens.CLIP_PLANE0 + _i, _TRANSFORM)
    declare(("clip_plane", _i), (0.0, 0.0, 0.0, 0.0), _TRANSFORM)
declare("material front", Material(), _LIGHTING)
declare("material back", Material(), _LIGHTING)
declare("color_material", (tokens.FRONT_AND_BACK, tokens.AMBIENT_AND_DIFFUSE), _LIGHTING)
declare("model_ambient", (0.2, 0.2, 0.2, 1.0), _LIGHTING)
declare("local_viewer", False, _LIGHTING)
declare("two_side", False, _LIGHTING)
declare("color_control", tokens.SINGLE_COLOR, _LIGHTING)


# --------------------------------------------------------------------------------------------- sections


@section("modelview top", "modelview")
def _modelview_top(gl, stack):
    return _finite(stack[-1], "the modelview matrix")


@section("projection top", "projection")
def _projection_top(gl, stack):
    return _finite(stack[-1], "the projection matrix")


@section("modelview1 section", "modelview1", ("enabled", tokens.VERTEX_WEIGHTING_EXT))
def _modelview1(gl, stack, enabled):
    return _finite(stack[-1], "the second modelview matrix") if enabled else None


def _finite(matrix, what):
    if not all(map(isfinite, chain.from_iterable(matrix))):
        raise LeftOut(f"{what} has a number that is infinite or no number")
    return matrix


@section(
    "lights",
    ("enabled", tokens.LIGHTING),
    *[("enabled", tokens.LIGHT0 + i) for i in range(LIGHTS)],
    *[("light", i) for i in range(LIGHTS)],
)
def _lights(gl, lighting, *inputs):
    if not lighting:
        return ()
    enabled, lights = inputs[:LIGHTS], inputs[LIGHTS:]
    lit = [light for on, light in zip(enabled, lights, strict=True) if on]
    for light in lit:
        if not _is_finite_light(light):
            raise LeftOut("a light has a number that is infinite or no number")
    return tuple([driver.light(gl.profile, light) for light in lit])


def _is_finite_light(light):
    numbers = [getattr(light, name) for name in LIGHT_NUMBERS.values()]
    vectors = light.ambient, light.diffuse, light.specular, light.position, light.spot_direction
    return all(map(isfinite, chain(numbers, *vectors)))


@section(
    "lighting",
    ("enabled", tokens.LIGHTING),
    "lights",
    "material front",
    "material back",
    ("enabled", tokens.COLOR_MATERIAL),
    "color_material",
    "model_ambient",
    "local_viewer",
    "two_side",
    "color_control",
)
def _lighting(gl, enabled, lights, front, back, tracking, tracked, ambient, local, two_side, control):
    if not enabled:
        return None
    numbers = chain.from_iterable(
        [*m.ambient, *m.diffuse, *m.specular, *m.emission, m.shininess] for m in (front, back)
    )
    if not all(map(isfinite, chain(numbers, ambient))):
        raise LeftOut("a material has a number that is infinite or no number")
    face, parameter = tracked
    if tracking:
        # Colours that follow the vertices' colours are not read. They must not make states differ.
        unread = {name: getattr(Material(), name) for name in TRACKED[parameter]}
        front, back = [
            replace(material, **unread) if key in _MATERIALS[face] else material
            for key, material in (("material front", front), ("material back", back))
        ]
    return Lighting(
        lights=lights,
        front=front,
        back=back,
        model_ambient=ambient,
        local_viewer=local,
        two_side=two_side,
        separate_specular_color=control == tokens.SEPARATE_SPECULAR_COLOR,
        color_material=(
            ColorMaterial(FACES[face], COLOR_MATERIAL_PARAMETERS[parameter]) if tracking else None
        ),
    )


@section(
    "clip planes",
    *[("enabled", tokens.CLIP_PLANE0 + i) for i in range(CLIP_PLANES)],
    *[("clip_plane", i) for i in range(CLIP_PLANES)],
)
def _clip_planes(gl, *inputs):
    enabled, planes = inputs[:CLIP_PLANES], inputs[CLIP_PLANES:]
    used = tuple([plane for on, plane in zip(enabled, planes, strict=True) if on])
    if not all(map(isfinite, chain(*used))):
        raise LeftOut("a clip plane has a number that is infinite or no number")
    return used


@section(
    "vertex",
    "modelview top",
    "projection top",
    "viewport section",
    "lighting",
    "clip planes",
    ("enabled", tokens.NORMALIZE),
    ("enabled", tokens.RESCALE_NORMAL),
    "modelview1 section",
    ("enabled", tokens.REGISTER_COMBINERS_NV),
    "programs",
)
def _vertex(
    gl,
    modelview,
    projection,
    viewport,
    lighting,
    planes,
    normalize,
    rescale,
    modelview1,
    combiners,
    _programs,
):
    return VertexState(
        modelview=modelview,
        projection=projection,
        viewport=viewport,
        normalize=normalize,
        rescale_normal=rescale,
        lighting=lighting,
        clip_planes=planes,
        modelview1=modelview1,
        secondary_color=driver.secondary_color(gl.profile, lighting, combiners),
    )


@section(
    "color_sum",
    ("enabled", tokens.COLOR_SUM),
    ("enabled", tokens.LIGHTING),
    ("enabled", tokens.VERTEX_PROGRAM_NV),
)
def _color_sum(gl, enabled, lighting, programmed):
    # EXT_secondary_color: with lighting, the colour control decides instead. A separate specular colour is
    # added because the state's lighting says so; with a single colour, the sum adds 0. A vertex program takes
    # the lighting's place.
    return enabled and (programmed or not lighting)


# --------------------------------------------------------------------------------------------- materials


def settle_materials(gl) -> None:
    """Set the material's colours that follow the current colour to its present value (section 2.13.3).

    While they follow it, draws read them from the vertices. Call this before a query of them, or before they
    stop following.
    """
    if not gl.values[("enabled", tokens.COLOR_MATERIAL)]:
        return
    face, parameter = gl.values["color_material"]
    for key in _MATERIALS[face]:
        colors = dict.fromkeys(TRACKED[parameter], gl.current.color)
        gl.values.set(key, replace(gl.values[key], **colors))


def _follows(gl, key, name):
    """Whether a material's colour follows the current colour now."""
    if not gl.values[("enabled", tokens.COLOR_MATERIAL)]:
        return False
    face, parameter = gl.values["color_material"]
    return key in _MATERIALS[face] and name in TRACKED[parameter]


@entry("ColorMaterial")
def color_material(gl, face, parameter):
    """Set which colours follow the current colour if COLOR_MATERIAL is enabled."""
    member(_MATERIALS, face)
    member(TRACKED, parameter)
    settle_materials(gl)
    gl.values.set("color_material", (face, parameter))


def _material(gl, face, name, given):
    keys = member(_MATERIALS, face)
    if name == tokens.SHININESS:
        shininess = given.number()
        if shininess < 0 or shininess > _LARGEST_EXPONENT:
            raise GLError(tokens.INVALID_VALUE, f"a shininess of {shininess}")
        changes: dict[str, Any] = {"shininess": shininess}
    elif name == tokens.COLOR_INDEXES:
        given.vector_of(3)  # only colour index mode uses them
        return
    else:
        changes = dict.fromkeys(member(TRACKED, name), given.color())
    if gl.begun:
        gl.begun_materials = gl.begun_materials or [(0, *_both(gl))]
    for key in keys:
        # Section 2.13.3: a colour that follows the current one still follows it after this call.
        kept = {name: value for name, value in changes.items() if not _follows(gl, key, name)}
        gl.values.set(key, replace(gl.values[key], **kept))
    if gl.begun:
        gl.begun_materials.append((len(gl.begun), *_both(gl)))


def _both(gl):
    return gl.values["material front"], gl.values["material back"]


register_parameters("Material", _material, inside=True)


# ------------------------------------------------------------------------------------------------ lights


def light_number(light: int) -> int:
    """The number of a light from LIGHTi. Raises GLError."""
    number = light - tokens.LIGHT0
    if not 0 <= number < LIGHTS:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(light)} is no light")
    return number


def _light(gl, light, name, given):
    key = "light", light_number(light)
    if name in LIGHT_COLORS:
        change: dict[str, Any] = {LIGHT_COLORS[name]: given.color()}
    elif name == tokens.POSITION:
        change = {"position": _in_eye_coordinates(gl, given.vector_of(4))}
    elif name == tokens.SPOT_DIRECTION:
        change = {"spot_direction": _in_eye_coordinates(gl, given.vector_of(3))}
    else:
        number = given.number()
        attribute = member(LIGHT_NUMBERS, name)
        largest = {tokens.SPOT_EXPONENT: _LARGEST_EXPONENT, tokens.SPOT_CUTOFF: 90.0}.get(name, inf)
        no_spot = name == tokens.SPOT_CUTOFF and number == 180
        if (number < 0 or number > largest) and not no_spot:
            raise GLError(tokens.INVALID_VALUE, f"{tokens.name_of(name)} {number}")
        change = {attribute: number}
    gl.values.set(key, replace(gl.values[key], **change))


def _in_eye_coordinates(gl, vector):
    """The upper left part of the modelview matrix times a vector of three or four components."""
    rows = top(gl, "modelview")[: len(vector)]
    return tuple(
        [reduce(add, map(mul, row, vector), 0.0) for row in rows]
    )  # ``map`` ends with the shorter one


register_parameters("Light", _light)


def _light_model(gl, name, given):
    if name == tokens.LIGHT_MODEL_AMBIENT:
        gl.values.set("model_ambient", given.color())
    elif name == tokens.LIGHT_MODEL_LOCAL_VIEWER:
        gl.values.set("local_viewer", given.number() != 0)
    elif name == tokens.LIGHT_MODEL_TWO_SIDE:
        gl.values.set("two_side", given.number() != 0)
    elif name == tokens.LIGHT_MODEL_COLOR_CONTROL:
        control = given.token()
        if control not in (tokens.SINGLE_COLOR, tokens.SEPARATE_SPECULAR_COLOR):
            raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(control)} is no colour control")
        gl.values.set("color_control", control)
    else:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is no parameter of the lighting model")


register_parameters("LightModel", _light_model)


# ------------------------------------------------------------------------------------------- clip planes


def clip_plane_number(plane: int) -> int:
    """The number of a clip plane from CLIP_PLANEi. Raises GLError."""
    number = plane - tokens.CLIP_PLANE0
    if not 0 <= number < CLIP_PLANES:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(plane)} is no clip plane")
    return number


@entry("ClipPlane", capture=lambda gl, plane, equation: (plane, tuple(map(float, equation))))
def clip_plane(gl, plane, equation):
    """Set a clip plane. The present inverse modelview matrix takes it to eye coordinates (section 2.11)."""
    number = clip_plane_number(plane)
    gl.values.set(("clip_plane", number), times_inverse_modelview(gl, equation))
