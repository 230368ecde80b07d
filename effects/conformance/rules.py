"""Open questions of the arithmetic, each with a rival rule, and the captures that can decide between them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.conformance.redraw import Comparison
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import Mapping, ProductRounding, Register
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.profiles.profile import Profile


@dataclass(frozen=True)
class Probe:
    """A program whose picture answers a question on any board with register combiners, with two stages at
    most.

    ``text``: !!RC1.0; ``primary``: the primary color's components, bytes. ``stands``: the red, green and blue
    by the profile's rule; ``otherwise``: by its rival.
    """

    text: str
    primary: int
    stands: int
    otherwise: tuple[int, ...]

    def __str__(self):
        return (
            f"with a primary color of {self.primary}/255 the program\n  {self.text}\n"
            f"draws {self.stands} as it stands, {' or '.join(map(str, self.otherwise))} otherwise"
        )


@dataclass(frozen=True)
class Rule:
    """An open question of the arithmetic, with the profile's rule and a rival.

    stands                   the profile's rule
    otherwise                the rival rule
    changed                  the machine with the rival rule; None: no profile has it, so fragments are
                             counted instead
    stage, concern, differs  count fragments of Draws whose combiners ``concern`` the rule. ``differs`` finds
                             those for which ``stage`` would give another number, from what the column
                             engine's observer receives
    probe                    the program to run if no capture decides
    """

    question: str
    stands: str
    otherwise: str
    changed: Profile | None = None
    stage: str = ""
    concern: Callable[[Any], bool] = lambda combiners: True
    differs: Callable[[dict[str, Any]], Any] = lambda columns: False
    probe: Probe | None = None


def _interpolates(combiners):
    """Whether the final combiner's A can be another value than zero or one."""
    return combiners.final.a.register != Register.ZERO


def _is_zero(combiners):
    """Whether both words of the final combiner are 0."""
    final = combiners.final
    inputs = final.a, final.b, final.c, final.d, final.e, final.f, final.g
    return all(
        given.register == Register.ZERO and given.mapping == Mapping.UNSIGNED_IDENTITY for given in inputs
    )


def _rounded(n):
    return (2 * n + 255) // 510


def _lerp_differs(columns):
    a, b, c, *_ = columns["mapped"]
    a = np.minimum(a, 255)
    joint, apart = _rounded(a * b + (255 - a) * c), _rounded(a * b) + _rounded((255 - a) * c)
    return (joint != apart).any(axis=0)


def _maps_half_bias(combiners):
    return any(
        given.mapping in (Mapping.HALF_BIAS_NORMAL, Mapping.HALF_BIAS_NEGATE)
        for stage in combiners.general
        for portion in (stage.rgb, stage.alpha)
        for given in (portion.a, portion.b, portion.c, portion.d)
    )


def _negative_differs(columns):
    """Whether a negative sum of products is no whole number of codes, so that its rounding can be seen."""
    total = sum([*columns["ab"], *columns["cd"]])
    return ((total < 0) & (_rounded(total) != -(-total // 255))).any(axis=0)


# 1/255 and 2/255 in every component.
_UNIT, _TWO_UNITS = (", ".join([f"{n / 255:.6f}"] * 4) for n in (1, 2))

RULES = {
    "expand-half": Rule(
        "What is one half to the mappings EXPAND_NORMAL and EXPAND_NEGATE?",
        "128: 2 x - 256",
        "127.5: 2 x - 255",
        NV2A.changed(expand_half=127.5),
        probe=Probe("!!RC1.0 { rgb { spare0 = expand(col0); } } out.rgb = spare0;", 200, 144, (145,)),
    ),
    "product-rounding": Rule(
        "Where is the sum of a general combiner's two products rounded?",
        "once, after the sum",
        "each product on its own",
        NV2A.changed(product_rounding=ProductRounding.PER_PRODUCT),
        probe=Probe(
            f"!!RC1.0 const0 = ({_UNIT}); {{ rgb {{ discard = const0 * col0; discard = const0 * col0; "
            "spare0 = sum(); } } out.rgb = spare0;",
            100,
            1,
            (0,),
        ),
    ),
    "round-before-scale": Rule(
        "Is a general combiner's sum rounded before it is scaled?",
        "rounded, then scaled",
        "scaled, then rounded",
        NV2A.changed(round_before_scale=False),
        probe=Probe(
            f"!!RC1.0 const0 = ({_UNIT}); {{ rgb {{ spare0 = const0 * col0; scale_by_four(); }} }} "
            "out.rgb = spare0;",
            100,
            0,
            (2,),
        ),
    ),
    "clamp-low": Rule(
        "What is the least value of a general combiner's output?",
        "-256",
        "-255",
        NV2A.changed(clamp_low=-255),
        probe=Probe(
            "!!RC1.0 const0 = (1, 1, 1, 1); "
            "{ rgb { spare0 = zero; bias_by_negative_one_half_scale_by_two(); } } "
            "{ rgb { discard = spare0 * -const0; discard = const0 * -const0; spare0 = sum(); "
            "scale_by_four(); } } "
            "out.rgb = spare0;",
            0,
            4,
            (0,),
        ),
    ),
    "half-bias": Rule(
        "What is one half to the mappings HALF_BIAS_NORMAL and HALF_BIAS_NEGATE?",
        "128: x - 128",
        "127.5, rounded somewhere",
        stage="portion",
        concern=_maps_half_bias,
        differs=lambda columns: np.ones(columns["mapped"][0].shape[1], bool),
        probe=Probe(
            "!!RC1.0 { rgb { spare0 = half_bias(col0); scale_by_four(); } } out.rgb = spare0;",
            150,
            88,
            (90, 92),
        ),
    ),
    "negative-products": Rule(
        "Is a negative sum of products rounded to nearest, or is its magnitude cut?",
        "to nearest",
        "its magnitude is cut",
        stage="portion",
        differs=_negative_differs,
        probe=Probe(
            f"!!RC1.0 const0 = ({_UNIT}); {{ rgb {{ spare0 = const0 * -col0; }} }} "
            "{ rgb { spare0 = -spare0; scale_by_four(); } } out.rgb = spare0;",
            200,
            4,
            (0,),
        ),
    ),
    "final-lerp": Rule(
        "Where is the final combiner's A B + (1 - A) C rounded?",
        "once, after the sum",
        "each product on its own",
        stage="final combiner",
        concern=_interpolates,
        differs=_lerp_differs,
        probe=Probe(
            f"!!RC1.0 const0 = ({_UNIT}); const1 = ({_TWO_UNITS}); {{ rgb {{ spare0 = zero; }} }} "
            "out.rgb = lerp(col0, const0, const1);",
            100,
            2,
            (1,),
        ),
    ),
    "final-words-zero": Rule(
        "What does the final combiner draw if both of its words are 0?",
        "black",
        "SPARE0, as some readers of dumps have it",
        stage="final combiner",
        concern=_is_zero,
        differs=lambda columns: np.ones(columns["mapped"][0].shape[1], bool),
        probe=Probe("!!RC1.0 { rgb { spare0 = col0; } } out.rgb = zero; out.a = zero.b;", 100, 0, (100,)),
    ),
    "color-bits": Rule(
        "How many significant bits of a float vertex colour become a byte?",
        "14",
        "24",
        NV2A.changed(color_mantissa_bits=24),
    ),
}


@dataclass(frozen=True)
class Distinction:
    """A case whose picture depends on a rule.

    ``pixels``: how many pixels the rival rule changes. ``as_it_stands``, ``otherwise``: how many of them the
    chip drew as the profile, and as the rival.
    """

    suite: str
    name: str
    pixels: int
    as_it_stands: int
    otherwise: int


def distinction(ours: Comparison, changed: Comparison) -> Distinction | None:
    """The Distinction of one capture by its two Comparisons, or None if no compared pixel distinguishes the
    rules.
    """
    if not (ours.covered and changed.covered):
        return None
    apart = (ours.ours != changed.ours).any(axis=2) & ours.compared
    pixels = int(apart.sum())
    if not pixels:
        return None
    stands, otherwise = (int((c.equal & apart).sum()) for c in (ours, changed))
    return Distinction(ours.suite, ours.name, pixels, stands, otherwise)


def fragments_that_differ(case: Case, rule: Rule) -> int:
    """How many fragments of a case would get another number in a stage by the rival rule.

    All fragments that its Draws shade count, whether visible afterwards or not. ``rule``: one whose rival no
    profile has.
    """
    drawn = (c.state.register_combiners for c in case.commands if isinstance(c, Draw))
    if not any(combiners is not None and rule.concern(combiners) for combiners in drawn):
        return 0
    found = 0

    def watch(stage, /, **columns):
        nonlocal found
        if stage == rule.stage:
            found += int(np.count_nonzero(rule.differs(columns)))

    machine = Machine(NV2A, WIDTH, HEIGHT, depth_bits=case.depth_bits, engine="columns", observer=watch)
    machine.run(case.commands)
    return found
