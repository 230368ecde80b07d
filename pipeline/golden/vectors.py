"""Test vectors for other renderers: random states with their inputs and the pixels that a machine gives.

A case is plain data: numbers, strings, lists. Everything random comes from its seed by SHA-256, so a seed
makes the same case with any version of Python and NumPy. Cases of single stages draw points of one pixel,
whose colours and texels are the stage's inputs. Frames have triangles on sixteenths of a pixel in a window of
64 by 64, where window and clip coordinates are exact.
"""

import hashlib
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    CombinerBias,
    CombinerScale,
    ComparisonFunction,
    ComponentUsage,
    Mapping,
    MuxSelect,
    PrimitiveType,
    Register,
    StencilOperation,
    TextureFilter,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.notations.nv2a_registers import format_registers
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.state import (
    AlphaPortion,
    AlphaTest,
    Blending,
    CombinerInput,
    DepthTest,
    FinalCombiner,
    GeneralCombiner,
    PassState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    StencilTest,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.validation.validate import validate, validate_program
from fixedpipe.pipeline.validation.walk import UnsupportedState

STAGES = ("combiners", "blending", "sampling")
POINTS = 16  # inputs in a stage's case
WINDOW = 64  # pixels along an edge of a frame
_SUBPIXELS = 16

_READ = (
    Register.ZERO,
    Register.CONSTANT_COLOR0,
    Register.CONSTANT_COLOR1,
    Register.PRIMARY_COLOR,
    Register.SECONDARY_COLOR,
    Register.SPARE0,
    Register.SPARE1,
)
_WRITTEN = _READ[3:]
_SCALES = (
    *((scale, CombinerBias.NONE) for scale in CombinerScale),
    (CombinerScale.NONE, CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF),
    (CombinerScale.SCALE_BY_TWO, CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF),
)


class Chance:
    """Numbers from a seed: SHA-256 of the seed and a counter."""

    def __init__(self, *seed: str | int):
        self._seed, self._count = ":".join(map(str, seed)), 0

    def below(self, count: int) -> int:
        """A whole number from 0 to count - 1.

        If count is no power of two, the first numbers are more likely, by less than 2**-48.
        """
        data = hashlib.sha256(f"{self._seed}:{self._count}".encode()).digest()
        self._count += 1
        return int.from_bytes(data[:8], "big") % count

    def one_of(self, choices: Any) -> Any:
        """One element of a sequence, or one member of an enumeration."""
        choices = tuple(choices)
        return choices[self.below(len(choices))]

    def byte(self) -> int:
        """0 to 255; half of the time one near which arithmetic changes."""
        return self.one_of((0, 1, 2, 126, 127, 128, 129, 254, 255)) if self.below(2) else self.below(256)

    def color(self) -> list[int]:
        """Four bytes."""
        return [self.byte() for _ in range(4)]


def stage_case(stage: str, profile: Profile, seed: int) -> dict[str, Any]:
    """A case of a single stage: its state, ``inputs`` and ``expected``, POINTS of each.

    Raises ValueError for an unknown stage, or for a machine without it.
    """
    if stage not in STAGES:
        raise ValueError(f"There are no vectors of {stage!r}; there are: {', '.join(STAGES)}.")
    return {"seed": seed, **_MAKERS[stage](profile, Chance(stage, seed))}


# -------------------------------------------------------------------------------------------------- points


def _points(colors, **arrays):
    """A mesh of points, one in each pixel of a row."""
    x = (2.0 * np.arange(POINTS) + 1.0) / POINTS - 1.0
    positions = np.stack([x, np.zeros(POINTS)], axis=1)
    return Mesh(positions, PrimitiveType.POINTS, colors=np.array(colors) / 255.0, **arrays)


def _row_of(profile, *commands):
    image = execute(commands, profile, POINTS, 1).image()
    return image[0].tolist()


# -------------------------------------------------------------------------------------------------- combiners


def _combiners(profile, chance):
    units = min(4, profile.textures.max_texture_units)
    combiners = _program(profile, units, chance)
    names = [f"tex{unit}" for unit in range(units)]
    inputs: dict[str, list[list[int]]] = {
        name: [chance.color() for _ in range(POINTS)] for name in (*names, "col0", "col1")
    }
    nearest = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)
    s = (np.arange(POINTS) + 0.5) / POINTS
    coordinates = np.stack([s, np.full(POINTS, 0.5)], axis=1)
    mesh = _points(
        inputs["col0"],
        secondary_colors=np.array(inputs["col1"]) / 255.0,
        texture_coordinates=(coordinates,) * units,
    )
    state = PassState(
        texture_units=tuple(TextureUnit(name, nearest) for name in names), register_combiners=combiners
    )
    textures = [
        TexImage(label=name, texture=name, image=texture_2d(np.array([inputs[name]], np.uint8)))
        for name in names
    ]
    clear = Clear(label="clear", color=(0.0, 0.0, 0.0, 0.0))
    expected = _row_of(profile, clear, *textures, Draw(label="points", mesh=mesh, state=state))
    words = [line.split(" = ") for line in format_registers(combiners).splitlines()]
    return {"registers": dict(words), "inputs": inputs, "expected": expected}


def _program(profile, units, chance):
    """Register combiners that the machine has."""
    if not profile.combiners.max_general_combiners:
        raise ValueError(
            f"The {profile.name} has no register combiners, so it has no vectors of them. Choose a machine "
            "that has them."
        )
    registers = tuple(Register(Register.TEXTURE0 + unit) for unit in range(units))
    own = profile.combiners.per_stage_constants
    while True:
        general = tuple(_general(registers, own, chance) for _ in range(1 + chance.below(3)))
        general = general[: profile.combiners.max_general_combiners]
        combiners = RegisterCombiners(
            general=general,
            final=_final(registers, chance),
            constant_color0=_real(chance.color()),
            constant_color1=_real(chance.color()),
            mux_select=MuxSelect.MSB,
        )
        try:
            validate_program(None, combiners, profile)
        except UnsupportedState:
            continue
        return combiners


def _real(color):
    return tuple(component / 255.0 for component in color)


def _general(registers, own, chance):
    constants = {}
    if own:
        constants = {f"constant_color{n}": _real(chance.color()) for n in (0, 1) if chance.below(2)}
    rgb, alpha = (_portion(kind, registers, chance) for kind in (RGBPortion, AlphaPortion))
    return GeneralCombiner(rgb=rgb, alpha=alpha, **constants)


def _portion(kind, registers, chance):
    plain = ComponentUsage.RGB if kind is RGBPortion else ComponentUsage.BLUE
    readable, writable = (*_READ, *registers), list((*_WRITTEN, *registers))
    inputs = [
        CombinerInput(
            chance.one_of(readable), chance.one_of(Mapping), chance.one_of((plain, ComponentUsage.ALPHA))
        )
        for _ in "abcd"
    ]
    outputs = []
    for _ in range(3):
        kept = chance.below(2)
        outputs.append(writable.pop(chance.below(len(writable))) if kept else Register.DISCARD)
    scale, bias = chance.one_of(_SCALES)
    dots = {}
    if kind is RGBPortion:
        dots = {"ab_dot_product": not chance.below(3), "cd_dot_product": not chance.below(3)}
        if any(dots.values()):  # the extension has no sum of dot products
            outputs[2] = Register.DISCARD
    ab, cd, total = outputs
    return kind(
        *inputs,
        ab_output=ab,
        cd_output=cd,
        sum_output=total,
        scale=scale,
        bias=bias,
        mux_sum=not chance.below(4),
        **dots,
    )


def _final(registers, chance):
    def read(*more):
        register = chance.one_of((*_READ, *registers, *more))
        mapping = chance.one_of((Mapping.UNSIGNED_IDENTITY, Mapping.UNSIGNED_INVERT))
        whole = register in (Register.E_TIMES_F, Register.SPARE0_PLUS_SECONDARY_COLOR)
        usages = (ComponentUsage.RGB,) if whole else (ComponentUsage.RGB, ComponentUsage.ALPHA)
        return CombinerInput(register, mapping, chance.one_of(usages))

    product, total = Register.E_TIMES_F, Register.SPARE0_PLUS_SECONDARY_COLOR
    a, e, f = read(product), read(), read()
    b, c, d = (read(product, total) for _ in "bcd")
    g = replace(read(), usage=chance.one_of((ComponentUsage.BLUE, ComponentUsage.ALPHA)))
    return FinalCombiner(a, b, c, d, e, f, g)


# --------------------------------------------------------------------------------------------------- blending


def _blending(profile, chance):
    blending = _blend_state(profile, chance)
    fragments, stored = ([chance.color() for _ in range(POINTS)] for _ in range(2))
    commands = (
        Clear(label="clear", color=(0.0, 0.0, 0.0, 0.0)),
        Draw(label="stored", mesh=_points(stored), state=PassState()),
        Draw(label="blended", mesh=_points(fragments), state=PassState(blending=blending)),
    )
    return {
        **_said_of(blending),
        "inputs": {"fragment": fragments, "stored": stored},
        "expected": _row_of(profile, *commands),
    }


def _blend_state(profile, chance):
    """Blending that the machine has."""
    while True:
        blending = Blending(
            chance.one_of(BlendFactor),
            chance.one_of(BlendFactor),
            chance.one_of(BlendEquation),
            _real(chance.color()),
        )
        draw = Draw(label="draw", mesh=_points([[0] * 4] * POINTS), state=PassState(blending=blending))
        try:
            validate((draw,), profile, POINTS, 1)
        except UnsupportedState:
            continue
        return blending


def _said_of(blending):
    return {
        "equation": blending.equation.name,
        "source": blending.source.name,
        "destination": blending.destination.name,
        "constant": [round(255 * component) for component in blending.color],
    }


# --------------------------------------------------------------------------------------------------- sampling


def _sampling(profile, chance):
    width, height = (1 << chance.below(4) for _ in range(2))
    texels = [[chance.color() for _ in range(width)] for _ in range(height)]
    choice = chance.one_of((TextureFilter.NEAREST, TextureFilter.LINEAR))
    wraps = [chance.one_of((WrapMode.REPEAT, WrapMode.CLAMP_TO_EDGE)) for _ in range(2)]
    # Exact in single precision, on both sides of the image.
    coordinates = [[(chance.below(3 << 12) - (1 << 12)) / 4096.0 for _ in range(2)] for _ in range(POINTS)]
    sampler = Sampler(choice, choice, *wraps)
    mesh = _points([[255] * 4] * POINTS, texture_coordinates=(np.array(coordinates),))
    image = texture_2d(np.array(texels[::-1], np.uint8))  # A picture's top row is first.
    commands = (
        Clear(label="clear", color=(0.0, 0.0, 0.0, 0.0)),
        TexImage(label="texture", texture="texture", image=image),
        Draw(label="sampled", mesh=mesh, state=PassState(texture_units=(TextureUnit("texture", sampler),))),
    )
    return {
        "width": width,
        "height": height,
        "texels": texels,
        "filter": choice.name,
        "wrap": [wrap.name for wrap in wraps],
        "inputs": {"st": coordinates},
        "expected": _row_of(profile, *commands),
    }


_MAKERS = {"combiners": _combiners, "blending": _blending, "sampling": _sampling}


# ---------------------------------------------------------------------------------------------------- frames


def frame_case(profile: Profile, seed: int) -> tuple[dict[str, Any], Framebuffer]:
    """A small frame as plain data, and the framebuffer after it."""
    chance, said = Chance("frame", seed), []
    color, depth, stencil = chance.color(), chance.one_of((255, 256, 128)) / 256.0, chance.below(256)
    size = 1 << (1 + chance.below(3))
    texels = [[chance.color() for _ in range(size)] for _ in range(size)]
    commands: list[Any] = [
        Clear(label="clear", color=_real(color), depth=depth, stencil=stencil),
        TexImage(label="texels", texture="0", image=texture_2d(np.array(texels[::-1], np.uint8))),
    ]
    for number in range(1 + chance.below(4)):
        mesh, vertices = _triangles(chance)
        state, told = _state(profile, chance)
        commands.append(Draw(label=f"draw {number}", mesh=mesh, state=state))
        said.append({"vertices": vertices, **told})
    result = execute(tuple(commands), profile, WINDOW, WINDOW)
    case = {
        "seed": seed,
        "width": WINDOW,
        "height": WINDOW,
        "clear": {"color": color, "depth": depth, "stencil": stencil},
        "texture": {"width": size, "height": size, "texels": texels},
        "draws": said,
    }
    return case, result.framebuffer


def _triangles(chance):
    count = 3 * (1 + chance.below(5))
    window = [[chance.below(WINDOW * _SUBPIXELS) / _SUBPIXELS for _ in range(2)] for _ in range(count)]
    depths = [chance.below(257) / 256.0 for _ in range(count)]
    w = [chance.one_of((0.5, 1.0, 1.0, 2.0)) for _ in range(count)]
    colors, st = ([chance.color() for _ in range(count)], [])
    for _ in range(count):
        st.append([(chance.below(4 << 8) - (1 << 8)) / 256.0 for _ in range(2)])
    ndc = np.column_stack(
        [2.0 * np.array(window) / WINDOW - 1.0, 2.0 * np.array(depths) - 1.0, np.ones(count)]
    )
    mesh = Mesh(
        ndc * np.array(w)[:, None],
        PrimitiveType.TRIANGLES,
        colors=np.array(colors) / 255.0,
        texture_coordinates=(np.array(st),),
    )
    vertices = [
        {"window": [*xy, z], "w": w_, "color": color, "st": coordinates}
        for xy, z, w_, color, coordinates in zip(window, depths, w, colors, st, strict=True)
    ]
    return mesh, vertices


def _state(profile, chance):
    """A state, and the same state as plain data."""
    told: dict[str, Any] = {}
    given: dict[str, Any] = {}
    if chance.below(2):
        choice = chance.one_of((TextureFilter.NEAREST, TextureFilter.LINEAR))
        wrap = chance.one_of((WrapMode.REPEAT, WrapMode.CLAMP_TO_EDGE))
        given["texture_units"] = (TextureUnit("0", Sampler(choice, choice, wrap, wrap)),)
        told["texture"] = {"environment": "MODULATE", "filter": choice.name, "wrap": wrap.name}
    if chance.below(2):
        test = AlphaTest(chance.one_of(ComparisonFunction), chance.byte() / 255.0)
        given["alpha_test"] = test
        told["alpha_test"] = {"function": test.function.name, "reference": round(255 * test.reference)}
    if chance.below(2):
        depth = DepthTest(chance.one_of(ComparisonFunction), bool(chance.below(2)))
        given["depth_test"] = depth
        told["depth_test"] = {"function": depth.function.name, "write": depth.write}
    if chance.below(2):
        stencil = StencilTest(
            chance.one_of(ComparisonFunction),
            chance.below(256),
            255,
            *(
                chance.one_of((StencilOperation.KEEP, StencilOperation.REPLACE, StencilOperation.INCR))
                for _ in "sdp"
            ),
        )
        given["stencil_test"] = stencil
        told["stencil_test"] = {
            "function": stencil.function.name,
            "reference": stencil.reference,
            "fail": stencil.fail.name,
            "depth_fail": stencil.depth_fail.name,
            "depth_pass": stencil.depth_pass.name,
        }
    if chance.below(2):
        given["blending"] = _blend_state(profile, chance)
        told["blending"] = _said_of(given["blending"])
    return PassState(**given), told


def raw_planes(framebuffer: Framebuffer) -> dict[str, bytes]:
    """A framebuffer's bytes {"rgba", "depth" (32-bit words, low byte first), "stencil"}, top row first."""
    planes: dict[str, NDArray[Any]] = {
        "rgba": framebuffer.image(),
        "depth": framebuffer.depth.astype("<u4"),
        "stencil": framebuffer.stencil.astype(np.uint8),
    }
    return {name: np.ascontiguousarray(plane).tobytes() for name, plane in planes.items()}
