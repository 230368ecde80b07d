"""What the notations' parsers make of a text as plain dicts, beside the second reading's."""

from dataclasses import fields, is_dataclass
from enum import Enum

from fixedpipe.pipeline.enums import CombinerBias, CombinerScale, ComponentUsage, Mapping, Register
from fixedpipe.pipeline.notations import pixel_shaders, register_combiners, texture_shaders
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
    TextureShaderStage,
)
from tests.support import notation_states

_WORDS = {"scale": CombinerScale, "bias": CombinerBias}
# What a text in these notations has no word for, and its state then has.
_SILENT = {
    "RGBPortion": {"ab_blue_to_alpha": False, "cd_blue_to_alpha": False, "function": "NONE"},
    "AlphaPortion": {"function": "NONE"},
    "GeneralCombiner": {"lookup": None},
    "RegisterCombiners": {"mux_select": "MSB", "invert_spare0": False, "invert_secondary_color": False},
}


def _plain(value):
    if isinstance(value, CombinerInput):
        assert value.meaning.name == "PLAIN"
        return value.register.name, value.mapping.name, value.usage.name
    if is_dataclass(value):
        found = {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
        for name, silent in _SILENT.get(type(value).__name__, {}).items():
            assert found.pop(name) == silent
        return found
    if isinstance(value, Enum):
        return value.name
    colors = isinstance(value, tuple) and all(isinstance(component, float) for component in value)
    return [_plain(part) for part in value] if isinstance(value, tuple) and not colors else value


def combiners_again(text):
    """The combiners' state by the second reading of a text alone."""

    def variable(given):
        register, mapping, usage = given
        return CombinerInput(Register[register], Mapping[mapping], ComponentUsage[usage])

    def state(kind, given):
        """``kind`` from its dict, names as the enumerations' members."""
        outputs = {name: Register[value] for name, value in given.items() if name.endswith("_output")}
        words = {name: kinds[given[name]] for name, kinds in _WORDS.items() if name in given}
        inputs = {name: variable(value) for name, value in given.items() if len(name) == 1}
        return kind(**given | outputs | words | inputs)

    given = notation_states.register_combiners(text)
    general = tuple(
        GeneralCombiner(
            **stage | {"rgb": state(RGBPortion, stage["rgb"]), "alpha": state(AlphaPortion, stage["alpha"])}
        )
        for stage in given["general"]
    )
    return RegisterCombiners(**given | {"general": general, "final": state(FinalCombiner, given["final"])})


def _combiners(text):
    return _plain(register_combiners.parse(text))


def _stages(text):
    """Of each stage the operation, and what differs from the initial values."""
    initial = TextureShaderStage()
    names = [field.name for field in fields(TextureShaderStage)]
    return [
        {
            name: _enum(getattr(stage, name))
            for name in names
            if name == "operation" or getattr(stage, name) != getattr(initial, name)
        }
        for stage in texture_shaders.parse(text)
    ]


def _enum(value):
    if isinstance(value, tuple) and isinstance(value[0], Enum):
        return tuple(part.name for part in value)
    return value.name if isinstance(value, Enum) else value


def _stages_again(text):
    initial = TextureShaderStage()
    return [
        {
            name: value
            for name, value in stage.items()
            if name == "operation" or value != _enum(getattr(initial, name))
        }
        for stage in notation_states.texture_shaders(text)
    ]


def _shader(text):
    listing = pixel_shaders.read(text)
    pairs = []
    for i in listing.arithmetic:
        instruction = {
            "name": i.name,
            "scale": i.scale,
            "saturate": i.saturate,
            "register": "".join(map(str, i.destination)),
            "mask": "".join(i.mask),
            "sources": list(map(_source, i.sources)),
        }
        if i.paired:
            pairs[-1].append(instruction)
        else:
            pairs.append([instruction])
    texture = [
        {"name": i.name, "unit": i.unit, "sources": list(map(_source, i.sources))} for i in listing.texture
    ]
    return {"version": listing.version, "constants": listing.constants, "texture": texture, "pairs": pairs}


def _source(source):
    register = "".join(map(str, source.register))
    return {
        "sign": source.sign,
        "register": register,
        "modifier": source.modifier,
        "selector": source.selector,
    }


# By header: what a parser reads, and what the grammar does.
READINGS = {
    "!!RC1.0": (_combiners, notation_states.register_combiners),
    "!!TS1.0": (_stages, _stages_again),
    "ps": (_shader, notation_states.pixel_shader),
}
