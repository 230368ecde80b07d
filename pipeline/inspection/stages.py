"""From what a witness was told of one fragment to its stages: names, equations, codes and values."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from fixedpipe.pipeline.description.equations import final_lines, portion_line, shader_stage_equation
from fixedpipe.pipeline.enums import BlendEquation, BlendFactor, Mapping, MuxSelect
from fixedpipe.pipeline.inspection.history import Clamped, Fragment, Quantity, Stage
from fixedpipe.pipeline.notations.register_combiner_words import REGISTER_NAMES, format_input
from fixedpipe.pipeline.state import PassState
from fixedpipe.raster.columns import combine, numbers

_RGBA, _STRQ = "rgba", "strq"


class FragmentWitness:
    """A witness of the making of one fragment: what it was told, in order."""

    def __init__(self) -> None:
        self.told: list[tuple[str, dict[str, Any]]] = []

    def __call__(self, stage: str, /, **columns: Any) -> None:
        """Be told. Dictionaries of registers change later: their arrays do not."""
        if "registers" in columns:
            columns["registers"] = dict(columns["registers"])
        self.told.append((stage, columns))


def fragment_of(witness: FragmentWitness, state: PassState, color_bits: int) -> Fragment:
    """The Fragment that a witness saw; ``color_bits``: of the buffer that it was written to."""
    reader = _Reader(state, color_bits)
    stages = tuple(stage for told in witness.told for stage in reader.stages(*told))
    return Fragment(stages, reader.fate)


def _floats(column):
    return tuple(np.asarray(column, np.float64).ravel().tolist())


def _ints(column):
    return tuple(int(code) for code in np.asarray(column).ravel())


def _coded(name, column, one):
    """A Quantity of codes."""
    codes = _ints(column)
    return Quantity(name, tuple(code / one for code in codes), codes, one)


def _word(name, column):
    """A Quantity of whole numbers that are what they are."""
    codes = _ints(column)
    return Quantity(name, tuple(map(float, codes)), codes)


def _real(name, column):
    return Quantity(name, _floats(column))


class _Reader:
    """Turns what was told into Stages; remembers what later ones need."""

    def __init__(self, state, color_bits):
        self.state, self.buffer_one = state, numbers.one_of(color_bits)
        self.one, self.fate = self.buffer_one, "ended: outside the depth buffer's limits"
        self.texels, self.filters, self.levels, self.general = [], [], [], -1

    def stages(self, name, columns) -> Iterator[Stage]:
        """The Stages that one thing told makes: none, or one."""
        tell = _TELLERS.get(name)
        made = None if tell is None else tell(self, **columns)
        return iter(() if made is None else (made,))

    # ------------------------------------------------------------------------------------ iteration

    def iteration(
        self, triangle, vertices, provoking, x, y, area, edges, inverse_w, weights, full_weights, back,
        primary, secondary, fog,
    ):  # fmt: skip
        """The primitive, and the fragment's place in it."""
        made = [
            _real("weights (24 significant bits)", weights),
            _real("weights", full_weights),
            _word("primary color", primary),
            _word("secondary color", secondary),
        ]
        if fog is not None:
            made.append(_real("fog coordinate", fog))
        read = (
            _word("triangle", triangle),
            _word("vertices", vertices),
            _word("provoking vertex", provoking),
            _word("window x, 1/16 pixel", x),
            _word("window y, 1/16 pixel, downwards", y),
            _word("area, signed", area),
            _word("edge functions", edges),
            _real("1/w", inverse_w),
            _word("back face", back),
        )
        return Stage("iteration", "primitive and weights", "", read, tuple(made))

    def depth(self, iterated, offset, total, words):
        """Depth."""
        read = _real("iterated depth", iterated), _real("polygon offset", offset), _real("sum", total)
        return Stage("depth", "depth", "", read, (_word("depth word", words),))

    def shaded(self, part, fragments, bits):
        """The fragment as texture units and combiners see it."""
        self.one = numbers.one_of(bits)
        made = [
            _coded("primary color", fragments.primary, self.one),
            _coded("secondary color", fragments.secondary, self.one),
            _word("depth word", fragments.depth),
        ]
        if fragments.fog is not None:
            made.append(_real("fog coordinate", fragments.fog))
        for unit, given in enumerate(self.state.texture_units):
            if given is not None:
                made.append(_real(f"texture coordinates {unit} (s, t, r, q)", fragments.coordinates[:, unit]))
        return Stage("fragment", "fragment", "", (), tuple(made))

    # ------------------------------------------------------------------------------------- textures

    def level_of_detail(self, unit, steps, sizes, missing, lod):
        """Lambda."""
        read = _real("derivatives to the right and down, of s, t, r", steps), _real("level 0's size", sizes)
        return Stage("lambda", f"texture unit {unit}, level of detail", "", read, (_real("lambda", lod),))

    def limited(self, unit, lod, limited):
        """Lambda with bias, between its limits."""
        made = (Quantity("lambda, biased and limited", (limited[0] / 256.0,), _ints(limited), 256),)
        return Stage("lambda", f"texture unit {unit}, lambda", "", (_real("lambda", lod),), made)

    def level(self, unit, level, linear, strq, divided, size, places, face, reference):
        """A level that is about to be filtered."""
        self.levels.append(level)
        read = [_real("coordinates (s, t, r, q)", strq)]
        made = [_real("texels (s, t, r)", [p for p in places if p is not None])]
        if face is not None:
            made.append(_word("face", face))
        if reference is not None:
            read.append(_word("compared with", reference))
        says = f"{'x'.join(str(n) for n in size)} texels, {'LINEAR' if linear else 'NEAREST'}"
        title = f"texture unit {unit}, level {level}"
        return Stage("level", title, says + (", divided by q" if divided else ""), tuple(read), tuple(made))

    def filter(self, columns, rows, layers, fractions, bits):
        """Where each axis of a filter reads."""
        made = [
            _word(name, [index for index, _ in along])
            for name, along in zip(("columns", "rows", "layers"), (columns, rows, layers), strict=True)
        ]
        made += [
            _coded(f"fraction between {name}", fraction, 1 << bits)
            for name, fraction in zip(("columns", "rows", "layers"), fractions, strict=True)
            if fraction is not None
        ]
        return Stage("filter", "where the filter reads", "", (), tuple(made))

    def texel(self, layer, row, column, stored, texel):
        """A texel of a filter."""
        at = [_ints(place)[0] for place in (column, row, layer)]
        self.texels.append(_word("texel (column {}, row {}, layer {})".format(*at), stored))
        if not np.array_equal(stored, texel):
            self.texels.append(_word("as it is filtered", texel))

    def mipmaps(self, unit, lower, upper, fraction, blended):
        """Which levels are blended."""
        made = _word("levels", (lower, upper)), _coded("fraction between levels", fraction, 256)
        return Stage("levels", f"texture unit {unit}, levels", "", (), made)

    def texture(self, unit, texel, one, register):
        """What a unit's register receives."""
        read, self.texels = (*self.texels, _coded("filtered", texel, one)), []
        made = (_coded(f"tex{unit}", register, self.one),)
        return Stage("texture", f"texture unit {unit}", "", read, made)

    def texture_shader(self, unit, stage, coordinates, texel, width, register, depth, alive):
        """A texture shader stage."""
        says = shader_stage_equation(unit, stage)
        read = (_real(f"texture coordinates {unit} (s, t, r, q)", coordinates),)
        made = (
            _coded(f"texel {unit}", texel, numbers.one_of(width)),
            _coded(f"tex{unit}", register, self.one),
        )
        if not alive.all():
            self.fate = f"ended: texture shader stage {unit}"
        return Stage("texture shader", f"texture shader stage {unit}", says, read, made)

    def dot_product(self, unit, of, own, vector, product):
        """A texture shader's dot product."""
        read = _real(f"(s{unit}, t{unit}, r{unit})", own[:3]), _real(f"vector of tex{of}", vector)
        made = (_real(f"dot{unit}", product),)
        return Stage("dot product", f"texture shader stage {unit}, dot product", "", read, made)

    def made_coordinates(self, unit, strq):
        """Coordinates that a texture shader made."""
        made = (_real("coordinates", strq),)
        return Stage("made coordinates", f"texture shader stage {unit}, coordinates", "", (), made)

    # ------------------------------------------------------------------------------------ combiners

    def program(self, program, environments):
        """The combiners' program, or what stands for texture environments."""
        self.select = None if program is None else program.mux_select
        self.environments = environments

    def general_combiner(self, number, stage, registers):
        """A general combiner begins."""
        self.general = number

    def portion(self, alpha, portion, read, mapped, ab, cd, arithmetic):
        """A portion's inputs and products: a Stage with its ``outputs``."""
        self.begun = alpha, portion, read, mapped, ab, cd, arithmetic
        self.chosen = ()

    def mux(self, takes_cd, spare0):
        """What a mux took."""
        word = _word("takes CD", takes_cd)
        self.chosen = _coded("spare0.a", spare0, self.one), word

    def outputs(self, alpha, values):
        """A portion's outputs."""
        alpha, portion, read, mapped, ab, cd, a = self.begun
        components, usage = ("a",) if alpha else _RGBA[:3], None
        given = []
        variables = portion.a, portion.b, portion.c, portion.d
        for name, variable, x, m in zip("ABCD", variables, read, mapped, strict=True):
            usage = type(portion)().a.usage
            text = format_input(variable, usage, Mapping.SIGNED_IDENTITY)
            register = REGISTER_NAMES[variable.register]
            given += [_coded(register, x, a.one), _coded(f"{name} = {text}", m, a.one)]
        products = [
            Quantity(name, tuple(n / a.one**2 for n in _ints(sum(p))), _ints(sum(p)), a.one**2)
            for name, p in (("AB", ab), ("CD", cd))
        ]
        made, clamped = [], []
        free = replace(a, low=-combine.FAR, high=combine.FAR)
        for register, value in values:
            name = REGISTER_NAMES[register] + (".a" if alpha else ".rgb")
            made.append(_coded(name, value, a.one))
            whole = self._without_clamp(register, portion, ab, cd, free)
            if whole is not None:
                clamped += _clamps(REGISTER_NAMES[register], components, whole, value, a.one)
        title = f"general combiner {self.general}, {'alpha' if alpha else 'RGB'} portion"
        if self.environments:
            title = f"texture environments, combiner {self.general}, {'alpha' if alpha else 'RGB'}"
        selector = "spare0.a is even" if self.select is MuxSelect.LSB else "spare0.a < 1/2"
        line = portion_line("", portion, ".a" if alpha else "", selector)
        says = line[0].removeprefix(": ") if line else ""
        read = (*given, *products, *self.chosen)
        return Stage("combiner", title, says, read, tuple(made), tuple(clamped))

    def _without_clamp(self, register, portion, ab, cd, free):
        """What an output would be if nothing clamped it; None where a mux or a function makes it."""
        biased, outputs = bool(portion.bias), (portion.ab_output, portion.cd_output, portion.sum_output)
        products = dict(zip(outputs, (ab, cd, [*ab, *cd]), strict=True))[register]
        if products is not ab and products is not cd and (portion.function or portion.mux_sum):
            return None
        return combine.output(products, portion.scale, biased, free)

    def e_times_f(self, read, product):
        """The final combiner's product."""
        given = tuple(_coded(name, x, self.one) for name, x in zip("EF", read, strict=True))
        made = (_coded("final_product", product, self.one),)
        return Stage("combiner", "final combiner, E times F", "", given, made)

    def color_sum(self, whole, total):
        """The color sum."""
        clamped = tuple(_clamps("color_sum", _RGBA, whole, total, self.one))
        made = (_coded("color_sum", total, self.one),)
        return Stage("color sum", "color sum", "", (), made, clamped)

    def final_combiner(self, final, registers, mapped, color, arithmetic):
        """The final combiner."""
        given = []
        for name, m in zip("ABCDG", mapped, strict=True):
            variable = getattr(final, name.lower())
            text = format_input(variable, variable.usage, Mapping.UNSIGNED_IDENTITY)
            if variable.register in registers:
                register = _coded(
                    REGISTER_NAMES[variable.register], registers[variable.register], arithmetic.one
                )
                given.append(register)
            given.append(_coded(f"{name} = {text}", m, arithmetic.one))
        says = "; ".join(line.partition(": ")[2] for line in final_lines(final))
        made = (_coded("color", color, arithmetic.one),)
        clamped = []
        if arithmetic.clamps_final:
            free = combine.final_color(*mapped, replace(arithmetic, clamps_final=False))
            clamped = _clamps("color", _RGBA, free, color, arithmetic.one)
        return Stage("final combiner", "final combiner", says, tuple(given), made, tuple(clamped))

    def fog(self, before, fog, color):
        """Fog."""
        read = _coded("color", before, self.one), _coded("fog color and factor", fog, self.one)
        return Stage("fog", "fog", "f C + (1 - f) Cf", read, (_coded("color", color, self.one),))

    # -------------------------------------------------------------------------------- per fragment

    def alpha_test(self, alpha, reference, inside, passed):
        """The alpha test."""
        test = self.state.alpha_test
        read = _coded("alpha", alpha, self.buffer_one), _coded("reference", reference, self.buffer_one)
        verdict = bool(passed[0]) or not inside[0]
        if not verdict:
            self.fate = "ended: alpha test"
        says = f"alpha {test.function.name} reference"
        return Stage("test", "alpha test", says, read, (), (), verdict)

    def stencil_test(self, reference, stored, agreed, result, written):
        """The stencil test."""
        test, verdict = self.state.stencil_test, bool(agreed[0])
        read = _word("reference", reference), _word("stored", stored), _word("mask", test.mask)
        made = _word("result", result), _word("written", written)
        if not verdict:
            self.fate = "ended: stencil test"
        says = f"reference {test.function.name} stored, both masked"
        return Stage("test", "stencil test", says, read, made, (), verdict)

    def depth_test(self, depth, stored, passed):
        """The depth test."""
        verdict = bool(passed[0])
        self.fate = "passed" if verdict else "ended: depth test"
        says = f"depth {self.state.depth_test.function.name} stored"
        read = _word("depth", depth), _word("stored", stored)
        return Stage("test", "depth test", says, read, (), (), verdict)

    def blending(self, colors, result):
        """Blending."""
        b, one = self.state.blending, self.buffer_one
        source, destination, constant = colors
        read = [_coded("source", source, one), _coded("destination", destination, one)]
        factors = b.source, b.destination
        given = "".join(factor.name for factor in factors)
        if "CONSTANT" in given:
            read.append(_coded("constant", constant, one))
        uses = b.equation not in (BlendEquation.MIN, BlendEquation.MAX)
        says = f"{b.equation.name}" + (
            f" of source x {_factor(factors[0])}, destination x {_factor(factors[1])}" if uses else ""
        )
        kept = np.clip(result, 0, one)
        clamped = tuple(_clamps("blended", _RGBA, result, kept, one))
        return Stage("blending", "blending", says, tuple(read), (_coded("blended", result, one),), clamped)

    def fragments(self, which):
        """The fragment lives to be tested."""
        self.fate = "passed"

    def write(self, which, source, stored, result, mask):
        """What is written."""
        one, on = self.buffer_one, "".join(c for c, m in zip(_RGBA, mask, strict=True) if m)
        made = (_coded("written", np.where(mask, result, stored), one),)
        read = _coded("fragment", source, one), _coded("stored", stored, one)
        self.fate = "written"
        return Stage("write", "color buffer", f"color mask {on}", read, made)


def _factor(factor):
    return BlendFactor(factor).name


def _clamps(name, components, before, after, one):
    """Clamped for each component that differs."""
    before, after = np.broadcast_arrays(np.asarray(before), np.asarray(after))
    return [
        Clamped(f"{name}.{c}", int(b) / one, int(k) / one)
        for c, b, k in zip(components, before.ravel(), after.ravel(), strict=False)
        if b != k
    ]


_TELLERS = {
    "iteration": _Reader.iteration,
    "depth": _Reader.depth,
    "shaded": _Reader.shaded,
    "level of detail": _Reader.level_of_detail,
    "lambda": _Reader.limited,
    "level": _Reader.level,
    "filter": _Reader.filter,
    "texel": _Reader.texel,
    "levels": _Reader.mipmaps,
    "texture": _Reader.texture,
    "texture shader": _Reader.texture_shader,
    "dot product": _Reader.dot_product,
    "made coordinates": _Reader.made_coordinates,
    "program": _Reader.program,
    "general combiner": _Reader.general_combiner,
    "portion": _Reader.portion,
    "mux": _Reader.mux,
    "outputs": _Reader.outputs,
    "E times F": _Reader.e_times_f,
    "color sum": _Reader.color_sum,
    "final combiner": _Reader.final_combiner,
    "fog": _Reader.fog,
    "alpha test": _Reader.alpha_test,
    "fragments": _Reader.fragments,
    "stencil test": _Reader.stencil_test,
    "depth test": _Reader.depth_test,
    "blending": _Reader.blending,
    "write": _Reader.write,
}
