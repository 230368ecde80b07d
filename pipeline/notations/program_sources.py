"""The lines of a program's parts in its text, and error messages in the text's own words."""

import re
from dataclasses import dataclass

from fixedpipe.pipeline.enums import Register
from fixedpipe.pipeline.notations.register_combiner_words import REGISTER_NAMES

# A pixel shader's registers. Constants have their own names, which differ from combiner to combiner.
PIXEL_SHADER_NAMES = {
    Register.PRIMARY_COLOR: "v0",
    Register.SECONDARY_COLOR: "v1",
    Register.SPARE0: "r0",
    Register.SPARE1: "r1",
    **{Register(Register.TEXTURE0 + unit): f"t{unit}" for unit in range(4)},
}


def is_pixel_shader(notations: tuple[str, ...]) -> bool:
    """Whether a program with these headers is Direct3D's: the application sets its targets and constants."""
    return any(re.match(r"x?ps\.", name) for name in notations)


@dataclass(frozen=True)
class ProgramSources:
    """The lines of a text that define each stage, "line 39: lrp + mul" for instance.

    - ``texture_shader``, ``general``: for each texture shader stage and general combiner; "" without a line.
    - ``final``: for the final combiner.
    - ``unset``: its outputs, "out.rgb" and "out.a", that the text does not set.
    """

    texture_shader: tuple[str, ...] = ()
    general: tuple[str, ...] = ()
    final: str = ""
    unset: tuple[str, ...] = ()

    def tell(self, sentence: str, notations: tuple[str, ...] = ("!!RC1.0",)) -> str:
        """A sentence about the state in the words of the text: its names of registers, and the lines."""
        own = REGISTER_NAMES
        if is_pixel_shader(notations):
            own = PIXEL_SHADER_NAMES
        for register, name in own.items():
            sentence = re.sub(rf"(?<![A-Z0-9_]){register.name}(?![A-Z0-9_])", name, sentence)
        for pattern, lines in (
            (r"([Gg]eneral combiner) (\d+)", self.general),
            (r"([Tt]exture shader stage) (\d+)", self.texture_shader),
        ):
            sentence = re.sub(pattern, lambda found, lines=lines: _placed(found, lines), sentence)
        most = re.search(r"has (\d+) general combiners?; this pass uses (\d+)", sentence)
        if most and int(most[1]) < len(self.general) and self.general[int(most[1])]:
            sentence += f" The first that is too many is {self.general[int(most[1])]}."
        return sentence


def _placed(found: re.Match[str], lines: tuple[str, ...]) -> str:
    number = int(found[2])
    return f"{found[0]} ({lines[number]})" if number < len(lines) and lines[number] else found[0]


def lines_between(first: int, last: int) -> str:
    """Lines as words."""
    return f"line {first}" if first == last else f"lines {first} to {last}"
