"""Register combiners as text, in the ``!!RC1.0`` notation of NVIDIA's nvparse.

    !!RC1.0
    const0 = (0.5, 0.5, 0.5, 1);
    {
      rgb {
        spare0 = expand(tex0) . expand(col0);
        scale_by_two();
      }
    }
    out.rgb = lerp(fog.a, spare0, fog);
    out.a = tex0;

A program has, in this order: the header; at most one ``const0`` and one ``const1``; general combiners in
braces; the final combiner. A general combiner holds its own constants (NV_register_combiners2), then an
``rgb`` portion, an ``alpha`` portion, or both in either order. A portion holds one product or two (``*``, or
``.`` for a dot product, or a single register, times one). If there are two, ``sum()`` or ``mux()`` may
follow, and then one scale or bias. The final combiner holds ``final_product`` and ``clamp_color_sum()`` in
either order, then ``out.rgb`` and ``out.a`` in either order, at least one of them. Comments run from ``//``
or ``#`` to the end of the line, or between ``/*`` and ``*/``.

Everything that a program omits is zero:

- A missing portion discards its outputs.
- A missing second product reads zeros.
- A missing sum is discarded.
- A missing ``out.rgb`` or ``out.a`` is zero.
- A missing ``clamp_color_sum()`` leaves the sum unclamped.
- A program without a general combiner has one that does nothing.

A register alone is SIGNED_IDENTITY in a general combiner and UNSIGNED_IDENTITY in the final one. It takes the
components of its portion unless ``.rgb``, ``.a`` or ``.b`` says otherwise. ``one`` is ZERO through
UNSIGNED_INVERT, and minus one is ZERO through EXPAND_NORMAL.

Beyond nvparse: ``sum()`` and ``mux()`` may follow dot products, as NV_register_combiners allows since version
1.6; ``one`` may carry a component; white space and comments may precede the header; a missing constant is (0,
0, 0, 0), and not the value that an earlier program left. Narrower than nvparse: an output may only carry the
component that its portion writes, where nvparse ignores .a in an rgb and .b in an alpha portion.

Source: the grammar, tokens and validation of nvparse's rc1.0 parser, as distributed with OGRE 3D.
"""

import re
from typing import NamedTuple

from fixedpipe.pipeline.enums import CombinerBias, CombinerScale, ComponentUsage, Mapping, Register
from fixedpipe.pipeline.notations.program_sources import ProgramSources, lines_between
from fixedpipe.pipeline.notations.register_combiner_words import (
    BLACK,
    MAPPING_WORDS,
    MAPPINGS_OF_ONE,
    MAX_GENERAL_COMBINERS,
    ONE_INPUTS,
    REGISTER_NAMES,
    SCALES,
    UNUSED_ALPHA,
    UNUSED_RGB,
    UNUSED_STAGE,
    USAGE_SUFFIXES,
    ZERO_INPUTS,
)
from fixedpipe.pipeline.notations.tokens import ProgramTextError, Reader, scan
from fixedpipe.pipeline.programs.combiner_rules import combiner_problems
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)

_REGISTERS = {name: register for register, name in REGISTER_NAMES.items()}
_WITHOUT_COMPONENTS = ("final_product", "color_sum", "discard")
_NAMES_LIST = ", ".join(name for name in _REGISTERS if name not in _WITHOUT_COMPONENTS) + " and one"

_USAGES = {suffix[1:]: usage for usage, suffix in USAGE_SUFFIXES.items()}

_MAPPINGS = {words: mapping for mapping, words in MAPPING_WORDS.items()}
_FUNCTIONS = ("expand", "half_bias", "unsigned", "unsigned_invert")


class CombinerTextError(ProgramTextError):
    """A text that is no ``!!RC1.0`` program; ``line`` and ``column`` (from 1) give the place."""


# ------------------------------------------------------------------------------------------- tokens

_TOKEN = re.compile(
    r"""(?P<space> \s+ | //[^\n]* | \#[^\n]* | /\*.*?\*/ )
      | (?P<header> !![A-Za-z]*[0-9.]* )
      | (?P<number> [+-]?(?:[0-9]+\.[0-9]*|\.[0-9]+|[0-9]+) )
      | (?P<name> [A-Za-z_][A-Za-z0-9_]*(?:\.(?:rgb|a|b)(?![A-Za-z0-9_]))? )
      | (?P<mark> [{}();,.*+=-] )""",
    re.VERBOSE | re.DOTALL,
)


def _tokens(text, start):
    before = None
    for token in scan(text, _TOKEN, CombinerTextError, start):
        if before is not None and (before.kind, token.kind) == ("number", "name"):
            touching = (before.line, before.column + len(before.text)) == (token.line, token.column)
            if touching:
                raise before.error(
                    f"{before.found} and a letter right after the number; numbers are written without an "
                    "exponent, 0.001 for instance."
                )
        before = token
        yield token


# ------------------------------------------------------------------------------------------- parser


class _Term(NamedTuple):
    """One product of a portion: its output, its two inputs, and whether it is a dot product."""

    output: Register
    inputs: tuple[CombinerInput, CombinerInput]
    dot: bool


class _Parser(Reader):
    def __init__(self, text, start):
        super().__init__(_tokens(text, start))
        self.general_lines, self.final_tokens, self.unset = [], [], ()
        self.positions = {}  # the place of each field of the result, by the paths of combiner_problems

    def follows(self, *texts):
        return self.next.kind != "end" and self.next.text in texts

    def expect(self, mark, after):
        if not self.follows(mark):
            raise self.next.error(f"{self.next.found} where {mark!r} belongs, {after}; write {mark!r} there.")
        return self.take()

    # -------------------------------------------------------------------------------- whole program

    def program(self):
        self.header()
        constants = self.constants()
        stages = []
        while self.follows("{"):
            if len(stages) == MAX_GENERAL_COMBINERS:
                raise self.next.error(
                    f"a general combiner after {MAX_GENERAL_COMBINERS}; no machine has more. Split the "
                    "program into passes."
                )
            stages.append(self.stage(len(stages)))
        final, clamp = self.final()
        combiners = RegisterCombiners(
            general=tuple(stages) or (UNUSED_STAGE,),
            final=final,
            constant_color0=constants.get("const0", BLACK),
            constant_color1=constants.get("const1", BLACK),
            color_sum_clamp=clamp,
        )
        for path, sentence in combiner_problems(combiners):
            raise self.positions[path].error(ProgramSources().tell(sentence))
        return combiners

    def sources(self):
        """The ProgramSources of the program that was read."""
        lines = [token.line for token in self.final_tokens]
        final = lines_between(min(lines), max(lines))
        return ProgramSources((), tuple(self.general_lines) or ("",), final, self.unset)

    def header(self):
        token = self.take()
        if token.text != "!!RC1.0":
            raise token.error(f"{token.found} where the header belongs; begin the program with !!RC1.0.")

    def constants(self):
        """Any ``const0 = (r, g, b, a);`` at this place, by name."""
        given = {}
        while self.follows("const0", "const1"):
            name = self.take()
            if name.text in given:
                raise name.error(f"{name.text} is set twice; keep one of the two.")
            self.expect("=", f"after {name.text}")
            self.expect("(", "before the four components of a color")
            values = [self.number()]
            for _ in range(3):
                self.expect(",", "between the four components of a color")
                values.append(self.number())
            self.expect(")", "after the four components of a color")
            self.end_statement()
            given[name.text] = tuple(values)
        return given

    def number(self):
        token = self.take()
        if token.kind != "number":
            raise token.error(
                f"{token.found} where a number belongs; a color is four of them, (1, 0.5, 0, 1)."
            )
        return token.number()

    def end_statement(self):
        if self.follows("."):
            raise self.next.error(
                "found '.' here; components are written .rgb, .a or .b, and dot products belong to rgb "
                "portions. Write one of these, or end the statement with ';'."
            )
        self.expect(";", "at the end of a statement")

    def call(self):
        """``();`` after the name of an operation."""
        name = self.take()
        self.expect("(", f"after {name.text}")
        self.expect(")", f"after {name.text}(")
        self.end_statement()

    # ----------------------------------------------------------------------------- general combiner

    def stage(self, number):
        opening = self.take()
        constants = self.constants()
        portions = {}
        while self.follows("rgb", "alpha"):
            name = self.take()
            if name.text in portions:
                raise name.error(
                    f"general combiner {number} has a second {name.text} portion; it has one of each. Move "
                    "this one to a general combiner of its own."
                )
            portions[name.text] = self.portion(number, name.text)
        if not self.follows("}"):
            raise self.next.error(
                f"{self.next.found} in general combiner {number}; it holds const0 and const1, then rgb "
                f"{{ ... }} and alpha {{ ... }}. Put statements into a portion, and end it with '}}'."
            )
        self.take()
        if not portions:
            raise opening.error(
                f"general combiner {number} has no portion; give it rgb {{ ... }} or alpha {{ ... }}, or "
                "remove it."
            )
        self.general_lines.append(lines_between(opening.line, self.last.line))
        return GeneralCombiner(
            rgb=portions.get("rgb", UNUSED_RGB),
            alpha=portions.get("alpha", UNUSED_ALPHA),
            constant_color0=constants.get("const0"),
            constant_color1=constants.get("const1"),
        )

    def portion(self, number, name):
        path = ("general", number, name)
        usage = ComponentUsage.RGB if name == "rgb" else ComponentUsage.ALPHA
        self.expect("{", f"after {name}")
        terms, sum_output, mux = [], Register.DISCARD, False
        while not self.follows("}", *SCALES):
            output = self.output(usage)
            self.expect("=", f"after {output.text}")
            if self.follows("sum", "mux"):
                if len(terms) != 2:
                    raise self.next.error(
                        f"{self.next.text}() after {len(terms)} of the two products that it takes; write "
                        "two products before it, into discard if only their sum is wanted."
                    )
                mux = self.next.text == "mux"
                self.call()
                sum_output = self.register_of(output)
                self.positions[(*path, "sum_output")] = output
                break
            if len(terms) == 2:
                raise output.error(
                    "a third product in one portion; a general combiner computes two, and their sum() or "
                    "mux(). Move it to the next general combiner."
                )
            terms.append(self.term(output, path, "abcd"[2 * len(terms) :], usage))
        if not terms:
            raise self.next.error(
                f"{self.next.found} where the {name} portion's first product belongs; write one, spare0 = "
                "tex0 * col0; for instance."
            )
        scale, bias = CombinerScale.NONE, CombinerBias.NONE
        if self.follows(*SCALES):
            scale, bias = SCALES[self.next.text]
            self.call()
        if not self.follows("}"):
            raise self.next.error(
                f"{self.next.found} where the {name} portion ends; sum() or mux() and then one scale or "
                "bias come last. Put them in this order, and end with '}'."
            )
        self.take()
        return self.build_portion(name, usage, terms, (sum_output, mux), (scale, bias))

    @staticmethod
    def build_portion(name, usage, terms, sums, scaling):
        if len(terms) == 1:
            terms = [*terms, _Term(Register.DISCARD, (ZERO_INPUTS[usage], ZERO_INPUTS[usage]), False)]
        (ab_output, (a, b), ab_dot), (cd_output, (c, d), cd_dot) = terms
        dots = {"ab_dot_product": ab_dot, "cd_dot_product": cd_dot} if name == "rgb" else {}
        kind = RGBPortion if name == "rgb" else AlphaPortion
        return kind(
            a=a,
            b=b,
            c=c,
            d=d,
            ab_output=ab_output,
            cd_output=cd_output,
            sum_output=sums[0],
            mux_sum=sums[1],
            scale=scaling[0],
            bias=scaling[1],
            **dots,
        )

    def output(self, usage):
        """The register before ``=``; a component that it carries must be the portion's."""
        token = self.register_token("the register that a statement writes")
        register, _, component = token.text.partition(".")
        if register == "one":
            raise token.error("one is read only; write a color, texture or spare register, or discard.")
        if component and _USAGES[component] is not usage:
            portion, suffix = ("rgb", ".rgb") if usage is ComponentUsage.RGB else ("alpha", ".a")
            raise token.error(
                f"{token.text} as the output of the {portion} portion, which writes {suffix} only; write "
                f"{register}, or move the statement to the other portion."
            )
        return token

    def term(self, output, path, variables, usage):
        first = self.general_input((*path, variables[0]), usage)
        second, dot = ONE_INPUTS[usage], False
        if self.follows("*", "."):
            operator = self.take()
            dot = operator.text == "."
            if dot and usage is ComponentUsage.ALPHA:
                raise operator.error(
                    "a dot product in an alpha portion, which has products only; compute it in the rgb "
                    "portion and take its .b here in the next general combiner."
                )
            second = self.general_input((*path, variables[1]), usage)
        if not self.follows(";"):
            raise self.next.error(
                f"{self.next.found} after a product; a product is a, a * b or a . b, and two products make "
                "a sum(). End this one with ';'."
            )
        self.take()
        self.positions[(*path, "ab_output" if variables[0] == "a" else "cd_output")] = output
        return _Term(self.register_of(output), (first, second), dot)

    # ----------------------------------------------------------------------------- registers, inputs

    def register_token(self, what):
        before, token = self.last, self.take()
        name, _, component = token.text.partition(".")
        if token.kind != "name" or (name not in _REGISTERS and name != "one"):
            glued = before.text == "." and before.line == token.line and before.column == token.column - 1
            hint = " (a component is written .rgb, .a or .b)" if glued else ""
            raise token.error(f"{token.found} where {what} belongs{hint}; the registers are {_NAMES_LIST}.")
        if component and name in _WITHOUT_COMPONENTS:
            raise token.error(
                f"{token.text} has a component, but {name} has none to choose from; write {name}."
            )
        return token

    @staticmethod
    def register_of(token):
        return _REGISTERS[token.text.partition(".")[0]]

    def input_of(self, path, token, mapping, usage):
        name, _, component = token.text.partition(".")
        self.positions[path] = token
        chosen = _USAGES[component] if component else usage
        if name == "one":
            return CombinerInput(Register.ZERO, MAPPINGS_OF_ONE[mapping], chosen)
        return CombinerInput(_REGISTERS[name], mapping, chosen)

    def function(self):
        """(the name's token, the register's token) of the next mapping, ``name(register)``."""
        name = self.take()
        self.expect("(", f"after {name.text}")
        register = self.register_token(f"the register that {name.text} maps")
        self.expect(")", f"after {name.text}({register.text}")
        return name, register

    def general_input(self, path, usage):
        minus = self.take() if self.follows("-") else None
        sign = "-" if minus else ""
        if self.follows(*_FUNCTIONS):
            name, register = self.function()
            if minus and (sign, name.text) not in _MAPPINGS:
                raise minus.error(
                    f"a minus before {name.text}(); only a register, expand() and half_bias() can be "
                    "negated. Negate the other factor instead."
                )
            return self.input_of(path, register, _MAPPINGS[sign, name.text], usage)
        register = self.register_token(
            "a register, or expand(), half_bias(), unsigned() or unsigned_invert() of one,"
        )
        return self.input_of(path, register, _MAPPINGS[sign, ""], usage)

    def final_input(self, variable, usage=ComponentUsage.RGB):
        path = ("final", variable)
        if self.follows("-", "expand", "half_bias"):
            raise self.next.error(
                f"{self.next.found} in the final combiner, which takes a register, unsigned() or "
                "unsigned_invert() of one; compute it in a general combiner."
            )
        if self.follows(*_FUNCTIONS):
            name, register = self.function()
            return self.input_of(path, register, _MAPPINGS["", name.text], usage)
        register = self.register_token("a register, or unsigned() or unsigned_invert() of one,")
        return self.input_of(path, register, Mapping.UNSIGNED_IDENTITY, usage)

    # ------------------------------------------------------------------------------- final combiner

    _FINAL_STATEMENTS = ("final_product", "clamp_color_sum", "out.rgb", "out.a")

    def final(self):
        """The final combiner, and whether the color sum is clamped."""
        given = {}
        while self.next.kind != "end":
            token = self.next
            if token.text not in self._FINAL_STATEMENTS:
                raise token.error(self.misplaced(token))
            if token.text in given:
                raise token.error(f"{token.text} is set twice; keep one of the two.")
            if token.text in ("final_product", "clamp_color_sum") and (
                "out.rgb" in given or "out.a" in given
            ):
                raise token.error(
                    f"{token.text} after an output; it comes before out.rgb and out.a. Move it there."
                )
            self.final_tokens.append(token)
            given[token.text] = self.final_statement(token.text)
        if "out.rgb" not in given and "out.a" not in given:
            raise self.next.error(
                "the text ends without out.rgb or out.a; say what the final combiner gives."
            )
        self.unset = tuple(name for name in ("out.rgb", "out.a") if name not in given)
        zero = ZERO_INPUTS[ComponentUsage.RGB]
        a, b, c, d = self.without_color_sum_in_a(given.get("out.rgb", (zero, zero, zero, zero)))
        e, f = given.get("final_product", (zero, zero))
        if "final_product" not in given:
            for variable, value in zip("abcd", (a, b, c, d), strict=True):
                if value.register is Register.E_TIMES_F:
                    raise self.positions["final", variable].error(
                        "final_product is read but not set; write final_product = a * b; before the outputs."
                    )
        g = given.get("out.a", ZERO_INPUTS[ComponentUsage.ALPHA])
        return FinalCombiner(a, b, c, d, e, f, g), "clamp_color_sum" in given

    @staticmethod
    def misplaced(token):
        if token.text == "{":
            return (
                "a general combiner after the final combiner's statements; it comes before them. Move it up."
            )
        if token.text in ("const0", "const1"):
            return (
                f"{token.text} is set after a general combiner; constants come right after the header, or "
                "first inside a general combiner. Move it there."
            )
        return (
            f"{token.found} where a statement of the final combiner belongs; it has final_product, "
            "clamp_color_sum(), out.rgb and out.a. Put anything else into a general combiner, { rgb { ... "
            "} }."
        )

    def final_statement(self, name):
        if name == "clamp_color_sum":
            self.call()
            return True
        self.take()
        self.expect("=", f"after {name}")
        if name == "out.a":
            value = self.final_input("g", ComponentUsage.ALPHA)
        elif name == "out.rgb":
            value = self.out_rgb()
        else:
            e = self.final_input("e")
            self.expect("*", "between the two factors of final_product")
            value = e, self.final_input("f")
        self.end_statement()
        return value

    def lerp(self):
        self.take()
        self.expect("(", "after lerp")
        a = self.final_input("a")
        self.expect(",", "between the three arguments of lerp")
        b = self.final_input("b")
        self.expect(",", "between the three arguments of lerp")
        c = self.final_input("c")
        self.expect(")", "after the three arguments of lerp")
        return a, b, c

    def out_rgb(self):
        """Variables A, B, C, D of one of: a, a * b, a + d, a * b + d, lerp(a, b, c), with + d, d + lerp."""
        zero, one = ZERO_INPUTS[ComponentUsage.RGB], ONE_INPUTS[ComponentUsage.RGB]
        if self.follows("lerp"):
            a, b, c = self.lerp()
            return a, b, c, self.addend("d") if self.follows("+") else zero
        first = self.final_input("a")
        if self.follows("*"):
            self.take()
            b = self.final_input("b")
            return first, b, zero, self.addend("d") if self.follows("+") else zero
        if not self.follows("+"):
            self.positions["final", "d"] = self.positions["final", "a"]
            return zero, zero, zero, first
        self.take()
        if self.follows("lerp"):
            at = self.positions["final", "a"]
            a, b, c = self.lerp()
            self.positions["final", "d"] = at
            return a, b, c, first
        return first, one, zero, self.final_input("d")

    def addend(self, variable):
        self.take()
        return self.final_input(variable)

    def without_color_sum_in_a(self, inputs):
        """A and B exchanged where A reads color_sum, which only B, C and D may read, and C is zero.

        Source: nvparse's rc1.0_final.cpp.
        """
        a, b, c, d = inputs
        color_sum = Register.SPARE0_PLUS_SECONDARY_COLOR
        c_is_zero = (c.register, c.mapping) == (Register.ZERO, Mapping.UNSIGNED_IDENTITY)
        if a.register is not color_sum or b.register is color_sum or not c_is_zero:
            return inputs
        at_a, at_b = (self.positions.pop(("final", variable), None) for variable in "ab")
        self.positions["final", "b"], self.positions["final", "a"] = at_a, at_b
        return b, a, c, d


def parse(text: str, start: tuple[int, int] = (1, 1)) -> RegisterCombiners:
    """The register combiners of an ``!!RC1.0`` program.

    ``start`` is the line and column of the text's beginning, for errors.

    Raises CombinerTextError with line and column, both from 1, where the text is no program, and where
    NV_register_combiners forbids its combiners. ``fixedpipe.pipeline.validation`` checks a machine's numbers
    of general combiners, texture units and constants.
    """
    return parse_with_sources(text, start)[0]


def parse_with_sources(
    text: str, start: tuple[int, int] = (1, 1)
) -> tuple[RegisterCombiners, ProgramSources]:
    """The result of ``parse``, and the lines of its parts."""
    parser = _Parser(text, start)
    return parser.program(), parser.sources()
