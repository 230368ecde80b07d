"""Writes texture shader stages as the texture instructions of Direct3D 8's pixel shaders."""

from typing import NamedTuple

from fixedpipe.pipeline.enums import CullMode, DotProductMapping, TextureTarget
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.notations.pixel_shader_textures import AFTER_PAD, TEXTURE_OPERATIONS
from fixedpipe.pipeline.notations.pixel_shaders import TEXTURE
from fixedpipe.pipeline.state import TextureShaderStage

# {operation: (instruction, target that its unit must have bound, or None for the first)}.
_INSTRUCTIONS = {
    operation: (name, None if place == 0 else target)
    for name, operations in TEXTURE_OPERATIONS.items()
    if name in TEXTURE  # the Xbox has more
    for place, (target, operation) in enumerate(operations.items())
    if operation is not Operation.DOT_PRODUCT
}
_KEPT = (CullMode.GEQUAL,) * 4
_MAPPINGS = {DotProductMapping.UNSIGNED_IDENTITY: "", DotProductMapping.EXPAND_NORMAL: "_bx2"}
_WITH_EYE = "texm3x3spec"


class TextureInstructions(NamedTuple):
    """The instructions of texture shader stages.

    - ``lines``: the instructions; ``{N}`` stands for the eye of unit N.
    - ``names``: their names.
    - ``targets``: {unit: TextureTarget} that must be given beside them.
    - ``comments``: on state that the application sets.
    - ``eyes``: {unit: eye}.
    """

    lines: tuple[str, ...]
    names: frozenset[str]
    targets: dict[int, TextureTarget]
    comments: tuple[str, ...]
    eyes: dict[int, tuple[float, float, float]]


def texture_instructions(stages: tuple[TextureShaderStage, ...] | None) -> TextureInstructions:
    """The instructions of texture shader stages. Raises ValueError for a stage that has none."""
    lines, names, targets, comments, eyes = [], set(), {}, [], {}
    for unit, stage in enumerate(stages or ()):
        if stage.operation is Operation.NONE:
            continue
        name, target = _instruction(unit, stages)
        names.add(name)
        if target is not None:
            targets[unit] = target
        operands = [f"t{unit}"]
        if name.startswith(("texm3x", "texbem", "texreg")):
            operands.append(f"t{stage.previous_texture_input}{_mapping(unit, name, stage)}")
        if name == _WITH_EYE:
            operands.append(f"{{{unit}}}")
            eyes[unit] = stage.constant_eye
        if name.startswith("texbem"):
            comments += _matrix(unit, name, stage)
        lines.append(f"{name} {', '.join(operands)}")
    return TextureInstructions(tuple(lines), frozenset(names), targets, tuple(comments), eyes)


def _refusal(unit, stage, what):
    return ValueError(
        f"Texture shader stage {unit} is {stage.operation.name}{what}; ps.1.0 to ps.1.3 have no instruction "
        "for it. Write the stages as !!TS1.0 (--ts), or as words of the NV2A's registers (--nv2a)."
    )


def _instruction(unit, stages):
    stage = stages[unit]
    if stage.roughness is not None:
        raise _refusal(unit, stage, " filtered by roughness")
    if stage.operation is Operation.CULL_FRAGMENT and stage.cull_modes != _KEPT:
        modes = ", ".join(mode.name for mode in stage.cull_modes)
        raise _refusal(unit, stage, f" with the modes {modes}, where texkill has GEQUAL alone")
    if stage.operation is not Operation.DOT_PRODUCT:
        if stage.operation not in _INSTRUCTIONS:
            raise _refusal(unit, stage, "")
        return _INSTRUCTIONS[stage.operation]
    later = [following.operation for following in stages[unit + 1 :]]
    last = next((operation for operation in later if operation is not Operation.DOT_PRODUCT), None)
    for pad, rows in AFTER_PAD.items():
        if _INSTRUCTIONS.get(last, ("",))[0] in rows[-1]:
            return pad, None
    raise _refusal(
        unit, stage, f" before {'no last row' if last is None else last.name}, which ends no matrix of theirs"
    )


def _mapping(unit, name, stage):
    if not name.startswith("texm3x"):
        return ""
    if stage.dot_product_mapping not in _MAPPINGS:
        raise _refusal(unit, stage, f" of a texel mapped by {stage.dot_product_mapping.name}")
    return _MAPPINGS[stage.dot_product_mapping]


def _matrix(unit, name, stage):
    """The application's state for an offset texture, where it is not the initial state.

    Source: D3DTSS_BUMPENVMAT00 to 11, LSCALE and LOFFSET; NV_texture_shader's matrix is stored by columns.
    """
    initial = TextureShaderStage()
    given = (*stage.offset_texture_matrix, stage.offset_texture_scale, stage.offset_texture_bias)
    if given == (
        *initial.offset_texture_matrix,
        initial.offset_texture_scale,
        initial.offset_texture_bias,
    ):
        return
    words = (
        "BUMPENVMAT00",
        "BUMPENVMAT01",
        "BUMPENVMAT10",
        "BUMPENVMAT11",
        "BUMPENVLSCALE",
        "BUMPENVLOFFSET",
    )
    count = 6 if name == "texbeml" else 4
    states = ", ".join(f"{word} {value:g}" for word, value in zip(words[:count], given, strict=False))
    yield f"t{unit}, texture stage state of the application's: {states}"
