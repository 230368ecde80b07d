"""The texture instructions of Direct3D 8's pixel shaders as texture shader stages."""

from typing import NamedTuple

from fixedpipe.pipeline.enums import DotProductMapping, Register, TextureShaderOperation, TextureTarget
from fixedpipe.pipeline.programs.texture_shader_rules import texture_shader_problems
from fixedpipe.pipeline.state import TextureShaderStage

_OP = TextureShaderOperation

_ACCESSES = {
    TextureTarget.TEXTURE_1D: _OP.TEXTURE_1D,
    TextureTarget.TEXTURE_2D: _OP.TEXTURE_2D,
    TextureTarget.TEXTURE_RECTANGLE: _OP.TEXTURE_RECTANGLE,
    TextureTarget.TEXTURE_3D: _OP.TEXTURE_3D,
    TextureTarget.TEXTURE_CUBE_MAP: _OP.TEXTURE_CUBE_MAP,
}
_2D, _RECTANGLE = TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_RECTANGLE
_3D, _CUBE_MAP = TextureTarget.TEXTURE_3D, TextureTarget.TEXTURE_CUBE_MAP
# The operation of a texture instruction, by the target of its unit; the first is the default.
TEXTURE_OPERATIONS = {
    "tex": {_2D: _OP.TEXTURE_2D} | _ACCESSES,
    "texcoord": {None: _OP.PASS_THROUGH},
    "texkill": {None: _OP.CULL_FRAGMENT},
    "texbem": {_2D: _OP.OFFSET_TEXTURE_2D, _RECTANGLE: _OP.OFFSET_TEXTURE_RECTANGLE},
    "texbeml": {_2D: _OP.OFFSET_TEXTURE_2D_SCALE, _RECTANGLE: _OP.OFFSET_TEXTURE_RECTANGLE_SCALE},
    "texreg2ar": {_2D: _OP.DEPENDENT_AR_TEXTURE_2D},
    "texreg2gb": {_2D: _OP.DEPENDENT_GB_TEXTURE_2D},
    "texm3x2pad": {None: _OP.DOT_PRODUCT},
    "texm3x2tex": {_2D: _OP.DOT_PRODUCT_TEXTURE_2D, _RECTANGLE: _OP.DOT_PRODUCT_TEXTURE_RECTANGLE},
    "texm3x2depth": {None: _OP.DOT_PRODUCT_DEPTH_REPLACE},
    "texm3x3pad": {None: _OP.DOT_PRODUCT},
    "texm3x3tex": {_CUBE_MAP: _OP.DOT_PRODUCT_TEXTURE_CUBE_MAP, _3D: _OP.DOT_PRODUCT_TEXTURE_3D},
    "texm3x3spec": {_CUBE_MAP: _OP.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP},
    "texm3x3vspec": {_CUBE_MAP: _OP.DOT_PRODUCT_REFLECT_CUBE_MAP},
    # The Xbox's own.  Source: PS_TEXTUREMODES_DOT_RFLCT_DIFF and PS_TEXTUREMODES_BRDF, as Direct3D names the
    # NV2A's modes, and Cxbx-Reloaded's names of the instructions.
    "texm3x3diff": {_CUBE_MAP: _OP.DOT_PRODUCT_DIFFUSE_CUBE_MAP},
    "texbrdf": {_3D: _OP.BRDF_TEXTURE_3D},
}
# Source: NV_texture_shader3, which came with the GeForce 4 Ti; no profile has its operations.
_OF_GEFORCE_4_TI = {
    "texreg2rgb": "DEPENDENT_RGB_TEXTURE_3D or _CUBE_MAP; use texreg2ar or texreg2gb of a 2D texture",
    "texdp3": "DOT_PRODUCT_PASS_THROUGH; compute the dot product with dp3, of texcoord's result",
    "texdp3tex": "DOT_PRODUCT_TEXTURE_1D; use texm3x2pad and texm3x2tex of a 2D texture",
    "texm3x3": "the product of a matrix as a color; look it up with texm3x3tex",
}
WITHOUT_RESULT = ("texkill", "texm3x2pad", "texm3x3pad", "texm3x2depth")
# The instructions that may follow a first row, and a second one.
AFTER_PAD = {
    "texm3x2pad": (("texm3x2tex", "texm3x2depth"),),
    "texm3x3pad": (("texm3x3pad",), ("texm3x3tex", "texm3x3spec", "texm3x3vspec", "texm3x3")),
}
_LAST_ROWS = {name for rows in AFTER_PAD.values() for name in rows[-1]}


class ConstantPlace(NamedTuple):
    """The place of constant register ``constant`` in the state.

    - ``stage``, ``register``: a register of general combiner ``stage``; with ``stage`` None, of the program
      (the final combiner reads it); with ``register`` None, the constant eye of texture shader stage
      ``stage``.
    - ``components``: the register's components that it fills: "rgba", or "rgb" or "a" where another constant
      fills the others.
    """

    constant: int
    stage: int | None
    register: Register | None
    components: str = "rgba"


def texture_stages(listing, targets, colors):
    """The stages of all units up to the last that an instruction names, or None, and the places of eyes."""
    by_unit, eyes = {instruction.destination[1]: instruction for instruction in listing.texture}, []
    _check_rows(by_unit)
    stages = []
    for unit in range(max(by_unit, default=-1) + 1):
        if unit not in by_unit:
            stages.append(TextureShaderStage())
            continue
        stage, eye = _texture_stage(by_unit[unit], targets.get(unit), colors)
        stages.append(stage)
        if eye is not None:
            eyes.append(ConstantPlace(eye, unit, None))
    for unit, sentence in texture_shader_problems(stages):
        raise by_unit[unit].token.error(sentence)
    return (tuple(stages) or None), eyes


def _check_rows(by_unit):
    """Refuse rows of a matrix that do not stand in consecutive units."""
    # texm3x3diff is a second row that also looks up; texture_shader_problems checks its place.
    by_unit = {
        unit: instruction._replace(name="texm3x3pad") if instruction.name == "texm3x3diff" else instruction
        for unit, instruction in by_unit.items()
    }
    for unit, instruction in sorted(by_unit.items()):
        name = instruction.name
        before = by_unit.get(unit - 1)
        if name in _LAST_ROWS:
            pad = "texm3x2pad" if name in AFTER_PAD["texm3x2pad"][-1] else "texm3x3pad"
            rows = len(AFTER_PAD[pad])
            given = [by_unit[k].name for k in range(unit - rows, unit) if k in by_unit]
            if given != [pad] * rows:
                raise instruction.token.error(
                    f"{name} without {'two ' if rows == 2 else ''}{pad} in the "
                    f"{'units' if rows == 2 else 'unit'} right before; write the other rows of the matrix "
                    "first."
                )
        if name in AFTER_PAD and (before is None or before.name != name):
            for row, allowed in enumerate(AFTER_PAD[name], 1):
                following = by_unit.get(unit + row)
                if following is None or following.name not in allowed:
                    raise instruction.token.error(
                        f"{name} t{unit} without {' or '.join(allowed)} of t{unit + row}; write the next "
                        "row of the matrix."
                    )


def _texture_stage(instruction, target, colors):
    """A stage, and the number of the constant that is its eye, or None."""
    name = instruction.name
    if name in _OF_GEFORCE_4_TI:
        raise instruction.token.error(
            f"{name} is an operation of the GeForce 4 Ti, which no profile is: {_OF_GEFORCE_4_TI[name]}."
        )
    operations = TEXTURE_OPERATIONS[name]
    if target is None or None in operations:
        operation = next(iter(operations.values()))
    elif target in operations:
        operation = operations[target]
    else:
        raise instruction.token.error(
            f"{name} of a {target.name}; it reads a {' or '.join(t.name for t in operations)}. Bind one of "
            "these."
        )
    given, eye = {}, None
    if instruction.sources:
        source = instruction.sources[0]
        mapping = _texel_mapping(name, source)
        if name.startswith("texm3x"):
            given["dot_product_mapping"] = mapping
        given["previous_texture_input"] = source.number
    if len(instruction.sources) == 2:
        source = instruction.sources[1]
        if source.letter != "c" or source.sign or source.modifier or source.selector:
            raise source.token.error(
                f"{source.token.text} where the eye of {name} belongs; it is a constant register, c0 for "
                "instance."
            )
        eye = source.number
        given["constant_eye"] = colors.get(eye, (0.0, 0.0, 0.0))[:3]
    return TextureShaderStage(operation, **given), eye


def _texel_mapping(name, source):
    if source.letter != "t":
        raise source.token.error(
            f"{source.token.text} as the source of {name}; it reads an earlier texture register, t0 to t2."
        )
    if source.sign or source.selector or source.modifier == "bias":
        raise source.token.error(
            f"{source.token.text} as the source of {name}; it takes a register as it is, or _bx2. Write "
            f"t{source.number}."
        )
    if source.modifier and not name.startswith("texm3x"):
        raise source.token.error(
            f"{source.token.text} as the source of {name}, which takes a register as it is; write "
            f"t{source.number}, and give the texture signed components where offsets are signed."
        )
    return DotProductMapping.EXPAND_NORMAL if source.modifier else DotProductMapping.UNSIGNED_IDENTITY
