"""What a test allows its picture: how much is enough, and what is refused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fixedpipe.pipeline.golden.allowances import allowance_of

PICTURE = np.zeros((4, 6, 3), np.uint8)
_SMALL = arrays(np.uint8, (3, 4, 2), elements=st.integers(250, 255))


@given(
    _SMALL,
    _SMALL,
    arrays(bool, (3, 4)).filter(lambda where: not where.all()),
    st.none() | st.tuples(st.integers(1, 5), st.integers(1, 6)),
)
def test_what_is_allowed_is_what_plain_loops_find(first, second, ignored, at_most):
    found = []
    for y in range(3):
        for x in range(4):
            apart = max(abs(int(a) - int(b)) for a, b in zip(first[y, x], second[y, x], strict=True))
            if apart and not ignored[y, x]:
                found.append(apart)
    largest, most = at_most or (0, 0)
    expected = len(found) <= most and all(apart <= largest for apart in found)
    assert allowance_of(first, at_most, ignored, "why").judge(first, second)[0] == expected


def test_boxes_are_half_open_and_count_from_the_top():
    found = allowance_of(PICTURE, None, [(0, 0, 2, 1), (5, 3, 6, 4)], "why")
    expected = np.ones((4, 6), bool)
    expected[0, :2] = expected[3, 5] = False
    assert np.array_equal(found.compared, expected)


def test_what_differs_and_why_it_is_allowed_is_told_on_one_line():
    now = PICTURE.copy()
    now[0, 0], now[3, 5] = 2, 9
    allowed = allowance_of(PICTURE, (2, 1), [(5, 3, 6, 4)], "lines\nare  rounded")
    assert allowed.judge(PICTURE, now) == (
        True,
        "1 pixel differs by at most 2, at (0, 0): (0, 0, 0), now (2, 2, 2); 1 pixel differs where they are "
        "ignored; reason: lines are rounded",
    )
    now[0, 1] = 3
    within, told = allowed.judge(PICTURE, now)
    assert (within, told.split("; ")[-1]) == (False, "1 may, by at most 2")


def test_nothing_said_allows_nothing():
    assert allowance_of(PICTURE, None, None, None) is None


@pytest.mark.parametrize(
    "at_most, ignore, reason, said",
    [
        (None, None, "why", "comes without an allowance"),
        ((1, 1), None, None, "needs a reason"),
        ((1, 1), None, " \n", "needs a reason"),
        ((1, 1), None, 5, "needs a reason"),
        (None, [(0, 0, 1, 1)], None, "needs a reason"),
        (3, None, "why", "two whole numbers"),
        ((1,), None, "why", "two whole numbers"),
        ((0, 5), None, "why", "two whole numbers"),
        ((5, 0), None, "why", "two whole numbers"),
        ((1.5, 5), None, "why", "two whole numbers"),
        ((True, 5), None, "why", "two whole numbers"),
        (None, [(0, 0, 7, 1)], "why", "has 6x4 pixels"),
        (None, [(0, 0, 1, 5)], "why", "has 6x4 pixels"),
        (None, [(2, 0, 2, 1)], "why", "is empty or not"),
        (None, [(-1, 0, 2, 1)], "why", "is empty or not"),
        (None, [(0, 0, 0.5, 1)], "why", "in pixels"),
        (None, [(0, 0, 2)], "why", "in pixels"),
        (None, [3], "why", "in pixels"),
        (None, 3, "why", "boxes"),
        (None, [(0, 0, 6, 4)], "why", "every pixel"),
        (None, np.ones((4, 6), bool), "why", "every pixel"),
        (None, np.zeros((6, 4), bool), "why", "of shape (6, 4)"),
    ],
)
def test_what_is_refused(at_most, ignore, reason, said):
    with pytest.raises(ValueError, match=said.replace("(", r"\(").replace(")", r"\)")):
        allowance_of(PICTURE, at_most, ignore, reason)
