"""Texture shaders as text, in the ``!!TS1.0`` notation of NVIDIA's nvparse.

    !!TS1.0
    texture_2d();
    dot_product_reflect_cube_map_eye_from_qs_1of3(expand(tex0));
    dot_product_reflect_cube_map_eye_from_qs_2of3(expand(tex0));
    dot_product_reflect_cube_map_eye_from_qs_3of3(expand(tex0));

A program has the header and one to four instructions, each ended by ``;``: the first for texture unit 0, the
next for unit 1, and so on. ``tex0`` to ``tex2`` are the results of earlier units; ``expand()`` is
EXPAND_NORMAL of a dot product's. An operation over several units has an instruction for each, ``_1of2`` and
``_2of2``, or ``_1of3`` to ``_3of3``, in this order and without another between them. Comments run from ``//``
or ``#`` to the end of the line, or between ``/*`` and ``*/``.

    nop()  texture_1d()  texture_2d()  texture_rectangle()  texture_3d()  texture_cube_map()  pass_through()
    cull_fragment(c, c, c, c)                               each GEQUAL_TO_ZERO or LESS_THAN_ZERO: s, t, r, q
    offset_2d(texN, a1, a2, a3, a4)                         offset_rectangle: the same
    offset_2d_scale(texN, a1, a2, a3, a4, scale, bias)      offset_rectangle_scale: the same
    dependent_ar(texN)  dependent_gb(texN)
    dot_product_2d_1of2(texN) ...  _rectangle_  _depth_replace_  _3d_1of3 ...  _cube_map_
    dot_product_reflect_cube_map_eye_from_qs_1of3(texN) ...
    dot_product_reflect_cube_map_const_eye_1of3(texN, x, y, z), _2of3(texN), _3of3(texN)
    dot_product_cube_map_and_reflect_cube_map_eye_from_qs_1of3(texN) ...
    and _const_eye_1of3(texN, x, y, z) ...

Where nvparse's own translation is wrong, this one follows the notation's meaning. ``dot_product_3d_3of3``
reads a 3D texture (nvparse sets DOT_PRODUCT_TEXTURE_2D). The eye of ``_const_eye_1of3`` becomes CONST_EYE
(nvparse sets the zeros of ``_3of3``). Beyond nvparse: white space and comments may precede the header. Stages
that NV_texture_shader calls inconsistent are refused; nvparse leaves them to the driver.

Source: the grammar, tokens and validation of nvparse's ts1.0 parser, as distributed with OGRE 3D;
NV_texture_shader, NV_texture_shader2.
"""

import re
from collections.abc import Sequence
from decimal import Decimal
from math import isfinite
from typing import NamedTuple

from fixedpipe.pipeline.enums import CullMode, DotProductMapping, TextureShaderOperation
from fixedpipe.pipeline.notations.program_sources import ProgramSources
from fixedpipe.pipeline.notations.tokens import ProgramTextError, Reader, scan
from fixedpipe.pipeline.programs.texture_shader_rules import texture_shader_problems
from fixedpipe.pipeline.state import TextureShaderStage

# Source: nvparse's ts1.0_inst.h (TSP_NUM_TEXTURE_UNITS).
MAX_STAGES = 4

_OP = TextureShaderOperation
_SIMPLE = {
    "nop": _OP.NONE,
    "texture_1d": _OP.TEXTURE_1D,
    "texture_2d": _OP.TEXTURE_2D,
    "texture_rectangle": _OP.TEXTURE_RECTANGLE,
    "texture_3d": _OP.TEXTURE_3D,
    "texture_cube_map": _OP.TEXTURE_CUBE_MAP,
    "pass_through": _OP.PASS_THROUGH,
}
_DEPENDENT = {"dependent_ar": _OP.DEPENDENT_AR_TEXTURE_2D, "dependent_gb": _OP.DEPENDENT_GB_TEXTURE_2D}
_OFFSET = {
    "offset_2d": _OP.OFFSET_TEXTURE_2D,
    "offset_2d_scale": _OP.OFFSET_TEXTURE_2D_SCALE,
    "offset_rectangle": _OP.OFFSET_TEXTURE_RECTANGLE,
    "offset_rectangle_scale": _OP.OFFSET_TEXTURE_RECTANGLE_SCALE,
}
# Operations over several units, and the operation of each unit.
_DOT = _OP.DOT_PRODUCT
_DIFFUSE, _REFLECT = _OP.DOT_PRODUCT_DIFFUSE_CUBE_MAP, _OP.DOT_PRODUCT_REFLECT_CUBE_MAP
_REFLECT_CONST = _OP.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP
_GROUPS = {
    "dot_product_2d": (_DOT, _OP.DOT_PRODUCT_TEXTURE_2D),
    "dot_product_rectangle": (_DOT, _OP.DOT_PRODUCT_TEXTURE_RECTANGLE),
    "dot_product_depth_replace": (_DOT, _OP.DOT_PRODUCT_DEPTH_REPLACE),
    "dot_product_3d": (_DOT, _DOT, _OP.DOT_PRODUCT_TEXTURE_3D),
    "dot_product_cube_map": (_DOT, _DOT, _OP.DOT_PRODUCT_TEXTURE_CUBE_MAP),
    "dot_product_reflect_cube_map_eye_from_qs": (_DOT, _DOT, _REFLECT),
    "dot_product_reflect_cube_map_const_eye": (_DOT, _DOT, _REFLECT_CONST),
    "dot_product_cube_map_and_reflect_cube_map_eye_from_qs": (_DOT, _DIFFUSE, _REFLECT),
    "dot_product_cube_map_and_reflect_cube_map_const_eye": (_DOT, _DIFFUSE, _REFLECT_CONST),
}
_WITH_EYE = ("dot_product_reflect_cube_map_const_eye", "dot_product_cube_map_and_reflect_cube_map_const_eye")


class _Part(NamedTuple):
    """One instruction of a group: the group, the instruction's number (from 0), and its operation."""

    group: str
    number: int
    operation: TextureShaderOperation


_PARTS = {
    f"{group}_{number + 1}of{len(operations)}": _Part(group, number, operation)
    for group, operations in _GROUPS.items()
    for number, operation in enumerate(operations)
}
_CONDITIONS = {"GEQUAL_TO_ZERO": CullMode.GEQUAL, "LESS_THAN_ZERO": CullMode.LESS}
_CONDITION_WORDS = {mode: word for word, mode in _CONDITIONS.items()}
_MAPPINGS = {False: DotProductMapping.UNSIGNED_IDENTITY, True: DotProductMapping.EXPAND_NORMAL}

INSTRUCTION_NAMES = (*_SIMPLE, "cull_fragment", *_OFFSET, *_DEPENDENT, *_PARTS)


class TextureShaderTextError(ProgramTextError):
    """A text that is no ``!!TS1.0`` program; ``line`` and ``column`` (from 1) give the place."""


_TOKEN = re.compile(
    r"""(?P<space> \s+ | //[^\n]* | \#[^\n]* | /\*.*?\*/ )
      | (?P<header> !![A-Za-z]*[0-9.]* )
      | (?P<number> [+-]?(?:[0-9]+\.[0-9]*|\.[0-9]+|[0-9]+)(?![A-Za-z0-9_.]) )
      | (?P<name> [A-Za-z_][A-Za-z0-9_]* )
      | (?P<mark> [();,] )""",
    re.VERBOSE | re.DOTALL,
)


class _Parser(Reader):
    def __init__(self, text, start):
        super().__init__(scan(text, _TOKEN, TextureShaderTextError, start))
        self.lines = []

    def expect(self, mark, after):
        if self.next.text != mark:
            raise self.next.error(f"{self.next.found} where {mark!r} belongs, {after}; write {mark!r} there.")
        return self.take()

    def program(self):
        header = self.take()
        if header.text != "!!TS1.0":
            raise header.error(f"{header.found} where the header belongs; begin the program with !!TS1.0.")
        names, stages = [], []
        while self.next.kind != "end":
            name = self.take()
            if name.text not in INSTRUCTION_NAMES:
                raise name.error(f"{name.found} where an instruction belongs; {_suggestion(name.text)}")
            if len(stages) == MAX_STAGES:
                raise name.error(
                    f"a {MAX_STAGES + 1}th instruction; there are {MAX_STAGES} texture units. Split the "
                    "program into passes."
                )
            names.append(name)
            self.lines.append(f"line {name.line}")
            stages.append(self.instruction(name, len(stages)))
            self.expect(";", f"after {name.text}(...)")
        if not stages:
            raise self.next.error("the text ends without an instruction; write texture_2d(); for instance.")
        _check_order(names)
        stages = _with_eyes(names, stages)
        for number, sentence in texture_shader_problems(stages):
            raise names[number].error(sentence)
        return stages

    def instruction(self, name, number):
        """A stage; it holds the eye of a ``_const_eye_1of3`` until ``_with_eyes``."""
        self.expect("(", f"after {name.text}")
        given = {}
        if name.text in _SIMPLE:
            operation = _SIMPLE[name.text]
        elif name.text == "cull_fragment":
            operation, modes = _OP.CULL_FRAGMENT, [self.condition()]
            for _ in range(3):
                self.comma(name)
                modes.append(self.condition())
            given["cull_modes"] = tuple(modes)
        elif name.text in _OFFSET:
            operation = _OFFSET[name.text]
            given["previous_texture_input"] = self.previous(number)
            given["offset_texture_matrix"] = tuple(self.numbers(name, 4))
            if name.text.endswith("scale"):
                given["offset_texture_scale"], given["offset_texture_bias"] = self.numbers(name, 2)
        elif name.text in _DEPENDENT:
            operation = _DEPENDENT[name.text]
            given["previous_texture_input"] = self.previous(number)
        else:
            part = _PARTS[name.text]
            operation = part.operation
            given["previous_texture_input"], given["dot_product_mapping"] = self.mapped_previous(number)
            if part.group in _WITH_EYE and part.number == 0:
                given["constant_eye"] = tuple(self.numbers(name, 3))
        self.expect(")", f"after the arguments of {name.text}")
        return TextureShaderStage(operation, **given)

    def comma(self, name):
        self.expect(",", f"between the arguments of {name.text}")

    def condition(self):
        token = self.take()
        if token.text not in _CONDITIONS:
            raise token.error(f"{token.found} where a condition belongs; it is {' or '.join(_CONDITIONS)}.")
        return _CONDITIONS[token.text]

    def numbers(self, name, count):
        values = []
        for _ in range(count):
            self.comma(name)
            token = self.take()
            if token.kind != "number":
                raise token.error(
                    f"{token.found} where a number belongs; write 0.5 or -1, without an exponent."
                )
            values.append(token.number())
        return values

    def previous(self, number):
        token = self.take()
        if token.text not in ("tex0", "tex1", "tex2"):
            raise token.error(
                f"{token.found} where the result of an earlier unit belongs; it is tex0, tex1 or tex2."
            )
        unit = int(token.text[3])
        if unit >= number:
            reason = f"give one below tex{number}" if number else "begin with a texture"
            raise token.error(
                f"{token.text} in the instruction of unit {number}, which reads earlier units only; {reason}."
            )
        return unit

    def mapped_previous(self, number):
        expanded = self.next.text == "expand"
        if expanded:
            self.take()
            self.expect("(", "after expand")
        unit = self.previous(number)
        if expanded:
            self.expect(")", "after the argument of expand")
        return unit, _MAPPINGS[expanded]


def _suggestion(word):
    same = [name for name in INSTRUCTION_NAMES if word and name.startswith(word)]
    if same:
        return f"write {same[0]}() if that is meant."
    return (
        "instructions are nop(), texture_2d() and the like, cull_fragment(), pass_through(), offset_2d() "
        "and the like, dependent_ar(), dependent_gb() and dot_product_..._1of2() and the like."
    )


def _check_order(names):
    """Refuse a group of instructions that is not whole and in order.

    Source: nvparse's ts1.0_inst_list.cpp (Validate).
    """
    awaited = None
    for name in names:
        part = _PARTS.get(name.text)
        if awaited is not None and name.text != awaited:
            raise name.error(f"{name.text}() where {awaited}() belongs; write that instruction next.")
        if part is None:
            continue
        length = len(_GROUPS[part.group])
        if awaited is None and part.number:
            raise name.error(
                f"{name.text}() without {part.group}_{part.number}of{length}() right before it; write that "
                "instruction first."
            )
        following = part.number + 2
        awaited = f"{part.group}_{following}of{length}" if following <= length else None
    if awaited is not None:
        raise names[-1].error(f"{names[-1].text}() without {awaited}() right after it; add that instruction.")


def _with_eyes(names, stages):
    """The stages with each constant eye moved to the reflection, where CONST_EYE is state."""
    eye, moved = None, []
    initial = TextureShaderStage().constant_eye
    for name, stage in zip(names, stages, strict=True):
        part = _PARTS.get(name.text)
        if part is not None and part.group in _WITH_EYE:
            given = {
                f: getattr(stage, f) for f in ("operation", "previous_texture_input", "dot_product_mapping")
            }
            eye = stage.constant_eye if part.number == 0 else eye
            stage = TextureShaderStage(**given, constant_eye=eye if part.number == 2 else initial)
        moved.append(stage)
    return tuple(moved)


def parse(text: str, start: tuple[int, int] = (1, 1)) -> tuple[TextureShaderStage, ...]:
    """The stages of a ``!!TS1.0`` program, one for each instruction, the first for unit 0.

    ``start`` is the line and column of the text's beginning, for errors. Raises TextureShaderTextError with
    line and column, both from 1, where the text is no program, and where NV_texture_shader forbids its
    stages. ``fixedpipe.pipeline.validation`` checks a machine's operations.
    """
    return parse_with_sources(text, start)[0]


def parse_with_sources(
    text: str, start: tuple[int, int] = (1, 1)
) -> tuple[tuple[TextureShaderStage, ...], ProgramSources]:
    """The result of ``parse``, and the lines of its parts."""
    parser = _Parser(text, start)
    return parser.program(), ProgramSources(texture_shader=tuple(parser.lines))


# ---------------------------------------------------------------------------------------- formatting

_SIMPLE_WORDS = {operation: word for word, operation in {**_SIMPLE, **_DEPENDENT, **_OFFSET}.items()}
_GROUP_OF = {operations: group for group, operations in _GROUPS.items()}


def _number(value):
    if not isfinite(value):
        raise ValueError(
            f"A texture shader has the number {value}; a program holds finite numbers. Give one."
        )
    # Decimal writes the shortest digits that read back as the same float, and never an exponent.
    return format(Decimal(repr(float(value))), "f").removesuffix(".0")


def _previous(number, stage):
    if stage.dot_product_mapping not in _MAPPINGS.values():
        raise ValueError(
            f"Texture shader stage {number} maps by {stage.dot_product_mapping.name}; the notation has "
            "UNSIGNED_IDENTITY and EXPAND_NORMAL. Choose one of the two."
        )
    word = f"tex{stage.previous_texture_input}"
    return f"expand({word})" if stage.dot_product_mapping is DotProductMapping.EXPAND_NORMAL else word


def _group_at(number, stages):
    """The group whose first instruction belongs to stage ``number``."""
    for length in (2, 3):
        group = _GROUP_OF.get(tuple(stage.operation for stage in stages[number : number + length]))
        if group:
            return group
    raise ValueError(
        f"The notation has no operation that begins with texture shader stage {number} "
        f"({stages[number].operation.name}); choose another, or keep the stages as state."
    )


def format_stages(stages: Sequence[TextureShaderStage]) -> str:
    """The canonical ``!!TS1.0`` program of texture shader stages; ``parse`` reads it back as equal ones.

    Fields that their operations do not read come back as the initial ones. Raises ValueError with a sentence
    for ``stages`` that no program can express.
    """
    if not 1 <= len(stages) <= MAX_STAGES:
        raise ValueError(f"A program has 1 to {MAX_STAGES} instructions; there are {len(stages)} stages.")
    for _, sentence in texture_shader_problems(stages):
        raise ValueError(sentence)
    for i, stage in enumerate(stages):
        if stage.roughness is not None:
            raise ValueError(
                f"Texture shader stage {i} is filtered by roughness, for which the notation has no word; "
                "keep the stages as state."
            )
    lines, number = ["!!TS1.0"], 0
    while number < len(stages):
        stage = stages[number]
        operation = stage.operation
        if operation in _SIMPLE_WORDS:
            arguments = []
            if operation in _OFFSET.values() or operation in _DEPENDENT.values():
                arguments.append(f"tex{stage.previous_texture_input}")
            if operation in _OFFSET.values():
                arguments += map(_number, stage.offset_texture_matrix)
            if operation.name.endswith("SCALE"):
                arguments += map(_number, (stage.offset_texture_scale, stage.offset_texture_bias))
            lines.append(f"{_SIMPLE_WORDS[operation]}({', '.join(arguments)});")
            number += 1
        elif operation is _OP.CULL_FRAGMENT:
            lines.append(f"cull_fragment({', '.join(_CONDITION_WORDS[mode] for mode in stage.cull_modes)});")
            number += 1
        else:
            group = _group_at(number, stages)
            length = len(_GROUPS[group])
            for k in range(length):
                arguments = [_previous(number + k, stages[number + k])]
                if group in _WITH_EYE and k == 0:
                    arguments += map(_number, stages[number + 2].constant_eye)
                lines.append(f"{group}_{k + 1}of{length}({', '.join(arguments)});")
            number += length
    return "\n".join(lines) + "\n"
