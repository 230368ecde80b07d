"""The byte that stands for a pixel shader's constant, beside fractions: every byte, every tie, neighbours."""

from fractions import Fraction
from math import floor, inf, nextafter

import numpy as np
import pytest

from fixedpipe.pipeline.framebuffers.framebuffer import color_codes
from fixedpipe.pipeline.notations.pixel_shader_combiners import Part, reading, stored, worst_step
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.raster.columns.numbers import fixed

# What is half-way between two bytes: as a magnitude, or by c + 128/255; and by c/2 + 128/255.
TIES = {1: [n / 510 for n in range(-509, 510, 2)], 2: [n / 255 for n in range(-255, 256, 2)]}


def byte(number):
    """byte(c) of docs/numbers.md, of an exact number."""
    return min(255, max(0, floor(255 * number + Fraction(1, 2))))


def written(value):
    """What a float64 is written as, exactly: a byte's fraction, or the fewest digits that read back."""
    nearest = Fraction(round(255 * value), 255)
    return nearest if float(nearest) == value else Fraction(repr(value))


def neighbours(value):
    """A number, what is beside it in float64 and in float32, and in decimals of 3 to 15 digits."""
    found = {value, nextafter(value, inf), nextafter(value, -inf)}
    single = np.float32(value)
    found |= {
        float(x) for x in (single, np.nextafter(single, np.float32(9)), np.nextafter(single, -np.float32(9)))
    }
    for digits in (3, 6, 12, 15):
        near, step = round(value, digits), 10.0**-digits
        found |= {near, round(near - step, digits), round(near + step, digits)}
    return [x for x in found if -1 <= x <= 1]


NUMBERS = sorted({x for n in range(-510, 511) for x in neighbours(n / 510)})


def test_numbers_are_what_they_are_meant_to_be():
    assert {n / 255 for n in range(-255, 256)} <= set(NUMBERS)
    assert set(TIES[1]) | set(TIES[2]) <= set(NUMBERS)
    assert len(NUMBERS) > 12_000


def codes(colors):
    """Bytes of colors on the machines' two engines, which have to be the same."""
    found = [color_codes(color) for color in colors]
    assert fixed(colors, 255).tolist() == found
    return np.array(found)


def test_a_magnitude_is_the_byte_nearest_to_it_and_halves_go_up():
    groups = np.resize(np.abs(NUMBERS), (-(-len(NUMBERS) // 4), 4)).tolist()
    found = codes([stored(color) for color in groups])
    assert found.tolist() == [[byte(written(c)) for c in color] for color in groups]
    negative = codes([stored([-c for c in color]) for color in groups])
    assert (negative == found).all()


@pytest.mark.parametrize("factor", [1, 2])
def test_a_color_of_both_signs_is_the_byte_nearest_to_what_is_mapped_and_halves_go_up(factor):
    """Beside a component that asks for the factor, and one of the other sign."""
    beside = (0.25, -0.25) if factor == 1 else (1.0, -1.0)
    inside = [c for c in NUMBERS if c and (factor == 2 or -128 <= 255 * written(c) <= 127)]
    colors = [(c, beside[c > 0], 0.0, 1.0) for c in inside]
    assert all(reading(color) == factor for color in colors)
    found = codes([stored(color) for color in colors])[:, 0]
    half = Fraction(128, 255)
    assert found.tolist() == [byte(written(c) / factor + half) for c in inside]
    for color, code in zip(colors, found.tolist(), strict=True):
        step, number = factor * (code - 128), 255 * written(color[0])
        assert abs(step - number) <= Fraction(factor, 2) or color[0] > Fraction(254, 255)
        worst = worst_step(color)
        if abs(step - number) > Fraction(1, 2):
            assert worst is not None
        if worst is not None and worst[0] == 0:
            assert worst[1] == step


def test_ties_go_up():
    """-1 in even steps is -254/255, as 1 is 254/255; k/255 of odd k is read as the step above."""
    for k in range(-255, 256, 2):
        color = (k / 255, 1.0, -1.0, 1.0)
        assert 2 * (color_codes(stored(color))[0] - 128) == min(k + 1, 254)
    for text, step in (("-1", -254), ("-0.6", -152), ("-0.2", -50), ("0.2", 52), ("0.6", 154), ("1", 254)):
        program = parse_program(f"ps.1.1\ndef c0, {text}, 1, -1, 1\nadd r0, v0, c0\n")
        assert 2 * (color_codes(program.combiners.general[0].constant_color0)[0] - 128) == step
    for text, code in (("0.1", 26), ("0.3", 77), ("0.5", 128), ("0.7", 179), ("0.9", 230)):
        program = parse_program(f"ps.1.1\ndef c0, {text}, 0, 0, {text}\nmul r0, v0, c0\n")
        assert color_codes(program.combiners.general[0].constant_color0)[::3] == [code, code]


def test_a_float32_is_its_own_decimal():
    """7/10 is a tie; the float32 nearest to it is below, and so is its byte."""
    single = float(np.float32(0.7))
    assert color_codes(stored((0.7, single, 0.0, single))) == [179, 178, 0, 178]
    assert color_codes(Part(0, True).stored((-0.7, -single, 0.5, -single))) == [179, 178, 0, 178]


def test_what_is_stored_is_the_number_itself_but_beside_a_tie():
    """The ideal reads it: it is off by no more than the last bit, and where the engines agree not at all."""
    for c in NUMBERS:
        kept = stored((abs(c), 0.0, 0.0, 0.0))[0]
        assert abs(kept - abs(c)) <= np.spacing(abs(c))
