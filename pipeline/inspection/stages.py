"""From what an observer received for one fragment to the fragment's stages: names, equations, codes and
values.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from fixedpipe.pipeline.description.equations import final_lines, portion_line, shader_stage_equation
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ComponentUsage,
    Mapping,
    MuxSelect,
    Register,
    ShadeModel,
)
from fixedpipe.pipeline.inspection import exact
from fixedpipe.pipeline.inspection.history import Clamped, Error, Fragment, Quantity, Stage
from fixedpipe.pipeline.inspection.ideal_numbers import ideal_numbers
from fixedpipe.pipeline.inspection.vertices import vertices_stage
from fixedpipe.pipeline.notations.register_combiner_words import REGISTER_NAMES, format_input
from fixedpipe.pipeline.programs.texture_shader_rules import reads_texture
from fixedpipe.pipeline.state import PassState
from fixedpipe.raster.columns import combine, numbers

_RGBA = "rgba"


class FragmentWitness:
    """An observer of one fragment, drawn by the machine or the ideal. It keeps what it receives, in order."""

    def __init__(self) -> None:
        self.told: list[tuple[str, dict[str, Any]]] = []

    def __call__(self, name: str, /, **columns: Any) -> None:
        """Keep a stage's columns.

        A dictionary of registers changes later, so it is copied; its arrays do not change. The ideal's file
        does.
        """
        if "registers" in columns:
            columns["registers"] = dict(columns["registers"])
        for changes in ("file", "computed"):
            if changes in columns:
                columns[changes] = columns[changes].copy()
        self.told.append((name, columns))


def fragment_of(
    observer: FragmentWitness, state: PassState | None, color_bits: int, ideal: FragmentWitness | None = None
) -> Fragment:
    """The Fragment that an observer saw.

    ``color_bits``: the width of the buffer that it was written to; ``ideal``: the ideal's observer of the
    same fragment.
    """
    reader = _Reader(state, color_bits, {} if ideal is None else ideal_numbers(ideal.told))
    stages = tuple(stage for told in observer.told for stage in reader.stages(*told))
    added = [max((_added(q) for q in stage.made), default=0.0) for stage in stages]
    worst = max(range(len(stages)), key=added.__getitem__, default=None)
    clamped = [place for place, stage in enumerate(stages) if stage.clamped]
    return Fragment(
        stages,
        reader.fate,
        worst if worst is not None and added[worst] > 0.0 else None,
        clamped[0] if clamped else None,
    )


def _added(quantity):
    """The error that a stage adds to one of its results: the largest component's."""
    if quantity.error is None or not quantity.error.added:
        return 0.0
    return max(abs(sum(parts)) for parts in zip(*quantity.error.added.values(), strict=True))


def _floats(column):
    return tuple(np.asarray(column, np.float64).ravel().tolist())


def _ints(column):
    return tuple(int(code) for code in np.asarray(column).ravel())


def _coded(name, column, one):
    """A Quantity of codes."""
    codes = _ints(column)
    return Quantity(name, tuple(code / one for code in codes), codes, one)


def _word(name, column):
    """A Quantity of whole numbers without a scale."""
    codes = _ints(column)
    return Quantity(name, tuple(map(float, codes)), codes)


def _real(name, column, ideal=()):
    return Quantity(name, _floats(column), ideal=ideal)


def _beside(quantity, ideal, exact=None, **steps):
    """A Quantity with the ideal's values, and with its Error if ``exact`` is given.

    ``exact``: the result of exact arithmetic on the machine's inputs. ``steps``: by the names of causes, the
    values from there to the machine's, each with one more cause. The last cause's value is the machine's, so
    it has None.
    """
    if not ideal or len(ideal) != len(quantity.values):
        return quantity
    error = None
    if exact is not None:
        machine, ideals, added = np.array(quantity.values), np.array(ideal), {}
        first = before = np.broadcast_to(np.ravel(exact), machine.shape)
        for cause, value in steps.items():
            after = machine if value is None else np.broadcast_to(np.ravel(value), machine.shape)
            added[cause], before = _floats(255.0 * (after - before)), after
        error = Error(_floats(255.0 * (machine - ideals)), _floats(255.0 * (first - ideals)), added)
    return replace(quantity, ideal=ideal, error=error)


class _Reader:
    """Makes Stages from what an observer received, and keeps what later stages need."""

    def __init__(self, state, color_bits, ideal):
        self.state, self.color_bits, self.ideal = state, color_bits, ideal
        self.buffer_one = numbers.one_of(color_bits)
        self.one, self.fate = self.buffer_one, "ended: outside the depth buffer's limits"
        self.texels, self.general, self.iterated, self.sampler = [], -1, None, None

    def stages(self, name, columns) -> Iterator[Stage]:
        """The Stages for one call of the observer: none, or one."""
        read = _READERS.get(name)
        made = None if read is None else read(self, **columns)
        return iter(() if made is None else (made,))

    # ------------------------------------------------------------------------------------ iteration

    def vertices(self, mesh, state, primitives, triangle):
        """The primitive's vertices."""
        return vertices_stage(mesh, state, primitives, triangle)

    def iteration(self, *, triangle, vertices, provoking, x, y, area, edges, inverse_w, **made_of):
        """The primitive, and the fragment's place in it."""
        smooth = self.state.polygon.shade_model == ShadeModel.SMOOTH
        self.iterated = (
            np.tensordot(np.ravel(made_of["full_weights"]), made_of["corners"][0], 1) if smooth else None
        )
        made = [
            _real("weights (24 significant bits)", made_of["weights"]),
            _real("weights", made_of["full_weights"], self.ideal.get("weights", ())),
        ]
        if made_of["fog"] is not None:
            made.append(_real("fog coordinate", made_of["fog"]))
        read = (
            _word("triangle", triangle),
            _word("vertices", vertices),
            _word("provoking vertex", provoking),
            _word("window x, 1/16 pixel", x),
            _word("window y, 1/16 pixel, downwards", y),
            _word("area, signed", area),
            _word("edge functions", edges),
            _real("1/w", inverse_w),
            _word("back face", made_of["back"]),
        )
        return Stage("iteration", "primitive and weights", "", read, tuple(made))

    def depth(self, iterated, offset, total, words):
        """Depth."""
        read = _real("iterated depth", iterated), _real("polygon offset", offset), _real("sum", total)
        return Stage("depth", "depth", "", read, (_word("depth word", words),))

    def shaded(self, part, fragments, bits):
        """The fragment as texture units and combiners receive it."""
        self.one = numbers.one_of(bits)
        made, iterated = [], self.iterated
        for k, name in enumerate(("primary color", "secondary color")):
            quantity = _coded(name, (fragments.primary, fragments.secondary)[k], self.one)
            full = quantity.values if iterated is None else iterated[4 * k : 4 * k + 4] / self.one
            made.append(_beside(quantity, self.ideal.get(name, ()), full, rounding=None))
        made.append(_word("depth word", fragments.depth))
        if fragments.fog is not None:
            made.append(_real("fog coordinate", fragments.fog))
        for unit, given in enumerate(self.state.texture_units):
            if given is not None:
                name, strq = f"texture coordinates {unit}", fragments.coordinates[:, unit]
                made.append(_real(f"{name} (s, t, r, q)", strq, self.ideal.get(name, ())))
        return Stage("fragment", "fragment", "", (), tuple(made))

    # ------------------------------------------------------------------------------------- textures

    def level_of_detail(self, unit, steps, sizes, missing, lod):
        """Lambda."""
        read = _real("derivatives to the right and down, of s, t, r", steps), _real("level 0's size", sizes)
        return Stage("lambda", f"texture unit {unit}, level of detail", "", read, (_real("lambda", lod),))

    def limited(self, unit, lod, limited):
        """Lambda after its bias and its limits."""
        made = (Quantity("lambda, biased and limited", (limited[0] / 256.0,), _ints(limited), 256),)
        return Stage("lambda", f"texture unit {unit}, lambda", "", (_real("lambda", lod),), made)

    def projected(self, unit, strq, made):
        """Coordinates over q."""
        read, title = (_real("coordinates (s, t, r, q)", strq),), f"texture unit {unit}, divided by q"
        return Stage(
            "projected", title, "times the reciprocal of q", read, (_real("(s, t, r) over q", made),)
        )

    def level(self, *, unit, level, linear, strq, size, places, face, reference):
        """A level that is about to be filtered."""
        read = [_real("coordinates", strq)]
        made = [_real("texels (s, t, r)", [p for p in places if p is not None])]
        if face is not None:
            made.append(_word("face", face))
        if reference is not None:
            read.append(_word("compared with", reference))
        says = f"{'x'.join(str(n) for n in size)} texels, {'LINEAR' if linear else 'NEAREST'}"
        title = f"texture unit {unit}, level {level}"
        return Stage("level", title, says, tuple(read), tuple(made))

    def filter(self, columns, rows, layers, fractions, bits):
        """The texels that each axis of a filter reads."""
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
        """The two levels that are blended."""
        made = _word("levels", (lower, upper)), _coded("fraction between levels", fraction, 256)
        return Stage("levels", f"texture unit {unit}, levels", "", (), made)

    def texture(self, unit, texel, one, register):
        """A unit's register."""
        read, self.texels = (*self.texels, _coded("filtered", texel, one)), []
        quantity, parts = _coded(f"tex{unit}", register, self.one), None
        if self.sampler is not None and self.sampler.number == unit and self.ideal:
            bits = self.one.bit_length()
            levels = self._real_texels(unit, self.sampler.texture)
            parts = exact.texture(self.sampler, self.sampled, levels, bits)
        causes = {}
        if parts is not None:
            cut, whole, full = parts
            causes = {"exact": full, "texels": whole, "filter fraction": cut, "rounding": None}
        made = _beside(quantity, self._ideal_texture(unit), **causes)
        return Stage("texture", f"texture unit {unit}", "", read, (made,), number=unit)

    def _real_texels(self, unit, own):
        """The real texels of the ideal's texture if its levels have the same sizes, else those of the
        machine's ``own``.
        """
        found = self.ideal.get(("levels", unit))
        if found is None or [level.shape for level in found] != [level.shape for level in own.levels]:
            return own.ideal
        return found

    def _ideal_texture(self, unit):
        return self.ideal.get(("register", Register.TEXTURE0 + unit), ())

    def was_sampled(self, sampler, fragments, bits):
        """A unit is about to be sampled at the fragment's own coordinates."""
        self.sampler, self.sampled = sampler, fragments

    def texture_shader(self, *, unit, stage, coordinates, texel, width, register, depth, alive, run):
        """A texture shader stage."""
        ideal, parts, causes = self._ideal_texture(unit), None, {}
        if ideal and reads_texture(self.state, unit):
            levels = self._real_texels(unit, run.units[unit].unit.texture)
            parts = exact.shader_texture(run, unit, levels, self.one.bit_length())
        if parts is not None:
            cut, whole, full, made = parts
            causes = {"exact": made, "coordinates": full, "texels": whole, "filter fraction": cut}
            causes["rounding"] = None
        says = shader_stage_equation(unit, stage)
        read = (_real(f"texture coordinates {unit} (s, t, r, q)", coordinates),)
        made = (
            _coded(f"texel {unit}", texel, numbers.one_of(width)),
            _beside(_coded(f"tex{unit}", register, self.one), ideal, **causes),
        )
        if not alive.all():
            self.fate = f"ended: texture shader stage {unit}"
        return Stage("texture shader", f"texture shader stage {unit}", says, read, made, number=unit)

    def color_key(self, unit, ended):
        """A color key that discards fragments."""
        if ended.any():
            self.fate = f"ended: color key of texture unit {unit}"
        made = (_word("equals the key", ended.astype(np.int64)),)
        return Stage("color key", f"texture unit {unit}, color key", "", (), made, number=unit)

    def dot_product(self, unit, of, own, vector, product):
        """A texture shader's dot product."""
        read = _real(f"(s{unit}, t{unit}, r{unit})", own[:3]), _real(f"vector of tex{of}", vector)
        made = (_real(f"dot{unit}", product),)
        return Stage("dot product", f"texture shader stage {unit}, dot product", "", read, made)

    def made_coordinates(self, unit, strq):
        """Coordinates that a texture shader stage made."""
        made = (_real("coordinates", strq),)
        return Stage("made coordinates", f"texture shader stage {unit}, coordinates", "", (), made)

    # ------------------------------------------------------------------------------------ combiners

    def program(self, program, environments):
        """The combiners' program, or the program for texture environments."""
        self.select = None if program is None else program.mux_select
        self.environments = environments

    def general_combiner(self, number, stage, registers):
        """A general combiner begins."""
        self.general = number

    def portion(self, **columns):
        """A portion's inputs and products: a Stage with its ``outputs``."""
        self.begun, self.chosen = columns, ()

    def mux(self, takes_cd, spare0):
        """The choice of a mux."""
        word = _word("takes CD", takes_cd)
        self.chosen = _coded("spare0.a", spare0, self.one), word

    def outputs(self, alpha, values):
        """A portion's outputs."""
        portion, read, mapped, ab, cd, a = (
            self.begun[name] for name in ("portion", "read", "mapped", "ab", "cd", "arithmetic")
        )
        given, made, clamped, key = [], [], [], (self.general, bool(alpha))
        components = ("a",) if alpha else _RGBA[:3]
        usage = ComponentUsage.ALPHA if alpha else ComponentUsage.RGB
        variables, used = (portion.a, portion.b, portion.c, portion.d), _used(portion, values)
        for name, variable, x, m in zip("ABCD", variables, read, mapped, strict=True):
            if name not in used:
                continue
            text = format_input(variable, usage, Mapping.SIGNED_IDENTITY)
            register, quantity = REGISTER_NAMES[variable.register], _coded(f"{name} = {text}", m, a.one)
            if _ints(x) != quantity.codes:
                given.append(_coded(register, x, a.one))
            given.append(_beside(quantity, self.ideal.get((*key, name), ())))
        products = [
            _beside(
                Quantity(name, tuple(n / a.one**2 for n in _ints(sum(p))), _ints(sum(p)), a.one**2),
                self.ideal.get((*key, name), ()),
            )
            for name, p in (("AB", ab), ("CD", cd))
            if name[0] in used
        ]
        for register, value in values:
            name = REGISTER_NAMES[register] + (".a" if alpha else ".rgb")
            whole = exact.unclamped(register, **self.begun)
            quantity, ideal = _coded(name, value, a.one), self.ideal.get((*key, register), ())
            full, mapped = (exact.portion_output(register, each, **self.begun) for each in (True, False))
            causes = {"mapping": mapped, "rounding": whole / a.one, "clamp": None}
            made.append(_beside(quantity, ideal, full, **causes))
            clamped += _clamps(REGISTER_NAMES[register], components, whole, value, a.one)
        title = f"general combiner {self.general}, {'alpha' if alpha else 'RGB'} portion"
        if self.environments:
            title = f"texture environments, combiner {self.general}, {'alpha' if alpha else 'RGB'}"
        selector = "spare0.a is even" if self.select is MuxSelect.LSB else "spare0.a < 1/2"
        line = portion_line("", portion, ".a" if alpha else "", selector)
        says = line[0].removeprefix(": ") if line else ""
        read = (*given, *products, *self.chosen)
        kind = "alpha portion" if alpha else "RGB portion"
        return Stage(kind, title, says, read, tuple(made), tuple(clamped), number=self.general)

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
            if variable.register == Register.ZERO and not m.any():
                continue
            text = format_input(variable, ComponentUsage.RGB, Mapping.UNSIGNED_IDENTITY)
            given.append(_coded(f"{name} = {text}", m, arithmetic.one))
        says = "; ".join(line.partition(": ")[2] for line in final_lines(final))
        free = combine.final_color(*mapped, replace(arithmetic, clamps_final=False))
        clamped = _clamps("color", _RGBA, free, color, arithmetic.one)
        full = exact.final_color(final, registers, arithmetic)
        quantity = _coded("color", color, arithmetic.one)
        causes = {"rounding": free / arithmetic.one, "clamp": None}
        made = _beside(quantity, self.ideal.get("color", ()), full, **causes)
        return Stage("final combiner", "final combiner", says, tuple(given), (made,), tuple(clamped))

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
        """Blending, of a fragment that passed."""
        if not len(result):
            return None
        b, one = self.state.blending, self.buffer_one
        source, destination, constant = colors
        read = [_coded("source", source, one), _coded("destination", destination, one)]
        factors = b.source, b.destination
        given = "".join(factor.name for factor in factors)
        if "CONSTANT" in given:
            read.append(_coded("constant", constant, one))
        uses = b.equation not in (BlendEquation.MIN, BlendEquation.MAX)
        says = b.equation.name + (
            f" of source x {_factor(factors[0])}, destination x {_factor(factors[1])}" if uses else ""
        )
        kept, ideal = np.clip(result, 0, one), self.ideal.get("blended", ())
        clamped = tuple(_clamps("blended", _RGBA, result, kept, one))
        full = exact.blended(b, colors, self.color_bits)
        made = _beside(_coded("blended", result, one), ideal, full, rounding=None)
        return Stage("blending", "blending", says, tuple(read), (made,), clamped)

    def fragments(self, which):
        """The fragment is still alive before the tests."""
        self.fate = "passed"

    def write(self, which, source, stored, result, mask):
        """The values that a fragment writes, if it passed."""
        if not len(which):
            return None
        one, on = self.buffer_one, "".join(c for c, m in zip(_RGBA, mask, strict=True) if m)
        made = _beside(_coded("written", np.where(mask, result, stored), one), self.ideal.get("written", ()))
        fragment = _beside(_coded("fragment", source, one), self.ideal.get("source", ()))
        read = fragment, _beside(_coded("stored", stored, one), self.ideal.get("stored", ()))
        self.fate = "written"
        return Stage("write", "color buffer", f"color mask {on}", read, (made,))


def _used(portion, values):
    """Which of a portion's variables an output needs: AB's, CD's, or all."""
    registers = [register for register, _ in values]
    zero = Register.ZERO
    sums = portion.sum_output in registers
    ab = sums and (portion.a.register, portion.b.register) != (zero, zero)
    cd = sums and (portion.c.register, portion.d.register) != (zero, zero)
    return ("AB" if ab or portion.ab_output in registers else "") + (
        "CD" if cd or portion.cd_output in registers else ""
    )


def _factor(factor):
    return BlendFactor(factor).name


def _clamps(name, components, before, after, one):
    """A Clamped for each component that differs."""
    before, after = np.broadcast_arrays(np.asarray(before), np.asarray(after))
    return [
        Clamped(f"{name}.{c}", int(b) / one, int(k) / one)
        for c, b, k in zip(components, before.ravel(), after.ravel(), strict=False)
        if b != k
    ]


_READERS = {
    "vertices": _Reader.vertices,
    "iteration": _Reader.iteration,
    "depth": _Reader.depth,
    "shaded": _Reader.shaded,
    "level of detail": _Reader.level_of_detail,
    "lambda": _Reader.limited,
    "level": _Reader.level,
    "filter": _Reader.filter,
    "texel": _Reader.texel,
    "levels": _Reader.mipmaps,
    "sampled": _Reader.was_sampled,
    "texture": _Reader.texture,
    "texture shader": _Reader.texture_shader,
    "dot product": _Reader.dot_product,
    "color key": _Reader.color_key,
    "made coordinates": _Reader.made_coordinates,
    "projected": _Reader.projected,
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
