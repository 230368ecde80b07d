"""docs/arithmetic-for-emulators.md, made of the rules and their vectors: ``python -m tests.arithmetic``."""

import textwrap
from itertools import groupby
from pathlib import Path

from fixedpipe.effects.arithmetic.rules import RULES
from fixedpipe.effects.conformance.rules import RULES as QUESTIONS
from tests.documents import WIDTH, table
from tests.support.arithmetic import DEFINITIONS, IN_WORDS

PAGE = Path(__file__).parents[1] / "docs" / "arithmetic-for-emulators.md"
SHOWN = 3  # vectors of a rule

_HEAD = """\
# The NV2A's arithmetic, for authors of emulators

After this page you can test an emulator of the NV2A, the Xbox's graphics chip, function by function. The page
has {rules} rules of the chip's arithmetic. Each rule has its formula, its evidence and test vectors.

1. Export the vectors, by the first command below. Each rule has a file of its own.
2. For each rule that your emulator computes, call your function with the inputs of every case.
3. Compare the result with `expected`, bit by bit.

[The judge](code-for-emulators.md#the-judge) does steps 2 and 3 for a program that answers questions on
standard input. [Code for emulators](code-for-emulators.md) has the same rules as C and as GLSL, to paste.

    fixedpipe golden export DIR --rules                 # DIR/rules/ID.json for each rule, {count} vectors
    fixedpipe golden export DIR --rules --cases 5000    # edge cases, then 5000 random cases of each rule
    fixedpipe golden export DIR                         # random states and whole frames: golden-images.md

[Silicon](silicon.md) says what the captures of a real chip are, and how many pixels agree.
[Numbers](numbers.md) has every rule with its order of operations. `make arithmetic` makes this page, and a
test fails if it is stale.

## The files

A file is a JSON object with a case on each line. So a program without a JSON library can read it too:
[examples/read_rules.c](examples/read_rules.c) reads seven rules.

| field | what it is |
|---|---|
| `format` | 1 |
| `rule`, `stage` | the id, which names the file, and the part of the chip |
| `numbers` | the rule of [numbers.md](numbers.md) |
| `formula` | an expression of the inputs' names in Python's notation, or a sentence |
| `evidence` | how the rule is known; begins with Measured, Inferred, Source or Assumed |
| `captures` | captures that show the rule, as SUITE or SUITE/CASE of nxdk_pgraph_tests; empty if none does |
| `open` | if it is in doubt: its question in `fixedpipe conformance --discriminates`; else empty |
| `inputs`, `output` | the kind of each input, by name, and of the result |
| `cases` | inputs by name, and `expected`, the result: edge cases first, then random ones from `--seed` |

| kind | how it is written |
|---|---|
| `int` | a whole number |
| `single`, `double` | bits of IEEE 754's single and double precision: `0x3f800000`; `NaN`, of any bits |
| `bytes` | two hexadecimal digits for each byte |
| `name` | OpenGL's name without GL_, or the chip's |
| `int[4]` | a list of four integers |

The functions that draw compute every vector; none is typed. `tests/effects/test_arithmetic.py` reads all
vectors back from their files. It compares them with the executable specification in `tests/reference/`,
which shares no code with those functions. If the formula is an expression, it compares them with the
formula too. For each rule it checks that a vector with a wrong last bit is noticed. `index.json` has every
file's SHA-256.

**How far you can trust a rule.** The first word of its evidence says that:

- *Measured*: the named captures were drawn through this function. Every pixel agrees, except those that
  [silicon.md](silicon.md) lists. This says nothing about inputs that no capture has.
- *Source*: a specification or envytools' model says so, and no capture contradicts it.
- *Inferred* and *Assumed*: no capture shows it. If the rule names a question,
  [silicon.md](silicon.md#questions-that-no-capture-answers) has the program that would answer it.

"""
_WORDS = """\
## Words of the formulas

Numbers are exact unless a formula cuts them. An expression that has a number with a decimal point is computed
in double precision, in the order in which it is written.

"""
_LEFT_OUT = """\
## What is not here

Some parts of the chip have no rule here. Their results depend on more than a function's inputs, or there is
no evidence that a vector could carry:

- which pixels of lines, points, smooth and multisampled primitives are drawn (N11, N19), and clipping;
- the level of detail of a 2x2 block, mipmaps' levels, layers, anisotropic footprints (N7.6 to N7.12);
- lighting as a whole (N2.15 to N2.18), generated texture coordinates, point parameters. The products, sums,
  reciprocals and roots of the lighting unit are here;
- matrices times vectors (N2.1, N2.6), and what a triangle through w = 0 becomes;
- how a polygon offset is rounded to a fixed depth format (N5.4);
- BRDF lookups, shadow comparisons, colour keys, HILO filters (N12.10, N12.13 to N12.17);
- dithering: the chip has none in its colour buffer (N10.6). That of DXT1 is in the rule `dxt1`;
- the 2D engine, clears, and what surfaces share in memory;
- the order of a fragment's tests, writes and masks. Whole frames show it.

The evidence comes from one NV2A, and from the programs of these captures. Nothing here was compared with a
GeForce.
"""


def _code(text):
    return f"`{text}`".replace("|", r"\|")


def _plain(text):
    return text.replace("|", r"\|").replace("*", r"\*")


def _shown(value):
    return "[" + ", ".join(map(str, value)) + "]" if isinstance(value, list) else str(value)


def _vectors(rule):
    """A few cases in a cell: an edge, a middle one, and the last, which is random where the rule draws."""
    cases = list(rule.cases(1, 0))
    picked = [cases[len(cases) // 3], cases[2 * len(cases) // 3], cases[-1]][-SHOWN:]
    lines = []
    for case in picked:
        given = ", ".join(f"{name} {_shown(case[name])}" for name in rule.inputs)
        lines.append(_code(f"{given}: {_shown(case['expected'])}"))
    return "<br>".join(dict.fromkeys(lines))


def _proof(rule):
    parts = [_plain(rule.evidence)]
    if rule.open:
        stands, otherwise = QUESTIONS[rule.open].stands, QUESTIONS[rule.open].otherwise
        parts.append(f"Question {_code(rule.open)}: {_plain(stands)}; or {_plain(otherwise)}")
    return "<br>".join(parts)


def _stage(name, rules):
    rows = []
    for rule in rules:
        formula = _plain(rule.formula) if rule.in_words else _code(rule.formula)
        number = f"[{rule.numbers}](numbers.md#{rule.numbers})"
        captures = ", ".join(rule.captures).replace("_", r"\_") or "none"
        rows.append((_code(rule.id), number, formula, _vectors(rule), _proof(rule), captures))
    head = ("rule", "numbers", "formula", "vectors: inputs, and what is expected", "evidence", "captures")
    return f"## {name}\n\n{table(head, rows)}\n"


def _words():
    rows = [(_code(f"{name}({of})"), _code(text)) for name, (of, text) in DEFINITIONS.items()]
    rows += [(_code(name), text) for name, text in IN_WORDS.items()]
    return _WORDS + table(("", "is"), rows) + "\n"


def _wrapped(text):
    """Its paragraphs in lines of the pages' width; tables, lists and code as they stand."""
    parts = text.split("\n\n")
    plain = [not part.startswith(("|", "-", "1.", "#", " ")) for part in parts]
    return "\n\n".join(
        textwrap.fill(part, WIDTH, break_on_hyphens=False, break_long_words=False) if wraps else part
        for part, wraps in zip(parts, plain, strict=True)
    )


def page():
    """The whole page as text."""
    count = sum(1 for rule in RULES.values() for _ in rule.cases(256, 0))
    head = _wrapped(_HEAD.format(rules=len(RULES), count=f"{count:,}"))
    stages = [_stage(name, rules) for name, rules in groupby(RULES.values(), lambda rule: rule.stage)]
    return head + _words() + "".join(stages) + _wrapped(_LEFT_OUT)


if __name__ == "__main__":
    PAGE.write_text(page())
