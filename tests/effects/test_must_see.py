"""Each sentence of a figure's must-see names checks that fail where it is untrue."""

import pytest

from fixedpipe.effects.acceptance.must_see import is_named, sentences
from fixedpipe.effects.figures import FIGURES

# Sentences that no check holds yet: the figure, and the sentence's number from 1.
NOT_SHOWN: set[tuple[str, int]] = set()


def test_a_paragraph_is_cut_where_a_sentence_ends():
    assert sentences("Eq. 4 at left. A ball, cf. Fig. 2, and a box! Then (two) lamps.") == [
        "Eq. 4 at left.",
        "A ball, cf. Fig. 2, and a box!",
        "Then (two) lamps.",
    ]


@pytest.mark.parametrize(
    ("check", "name", "is_its"),
    [
        ("grooves of 45 degrees", "grooves of {flank:g} degrees", True),
        ("grooves of 45 degrees", "grooves of 45 degrees", True),
        ("grooves of 45 degrees", "grooves of 45", False),
        ("a (b) c", "a (b) {which}", True),
    ],
)
def test_a_check_is_named_by_its_words(check, name, is_its):
    assert is_named(check, name) is is_its


@pytest.mark.parametrize("figure", list(FIGURES.values()), ids=lambda figure: figure.id)
def test_each_sentence_has_its_checks(figure):
    # A figure that names no check for any sentence shows none of them.
    shown_by = figure.shown_by or ((),) * len(sentences(figure.must_see))
    assert len(shown_by) == len(sentences(figure.must_see))
    without = {(figure.id, number) for number, names in enumerate(shown_by, 1) if not names}
    assert without == {place for place in NOT_SHOWN if place[0] == figure.id}
