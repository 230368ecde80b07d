"""A diagram's letters as text: where they stand, and how they are spelled."""

import numpy as np
import pytest

from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.reports.letters import labels_of, typeset, without_letters


@pytest.mark.parametrize(
    ("text", "runs"),
    [
        ("alpha", [["\u03b1", 0]]),
        ("-d_i", [["-d", 0], ["i", -1]]),
        ("r1 a", [["r", 0], ["1", -1], [" a", 0]]),
        ("su = n/|n| x pv", [["s", 0], ["u", -1], [" = n/|n| x p", 0], ["v", -1]]),
        ("shadow map", [["shadow map", 0]]),
        ("alphabet", [["alphabet", 0]]),
    ],
)
def test_greek_letters_and_indices_are_set(text, runs):
    assert typeset(text) == runs


def test_labels_stand_where_the_machine_draws_them():
    figure, size = FIGURES["F000-1"], 256
    key = figure.machines[0]
    method = figure.method(key)
    labels = labels_of(figure.commands(key, size), size)
    assert {"".join(text for text, _ in label["runs"]) for label in labels} >= {
        "\u03b1",
        "\u03b2",
        "\u03b8",
        "\u03b4",
        "n",
    }
    whole = figure.render(key, size).image()[..., :3].astype(int)
    bare = figure.render(key, size, method=without_letters(method)).image()[..., :3].astype(int)
    rows, columns = np.nonzero(np.abs(whole - bare).max(-1))
    assert len(rows)
    # Every pixel that the letters change is within a label's reach, and every label has such a pixel.
    near = np.zeros((len(labels), len(rows)), bool)
    for n, label in enumerate(labels):
        half = label["size"] * max(1, sum(len(text) for text, _ in label["runs"])) + 4
        near[n] = (abs(columns - label["x"]) <= 3 * half) & (abs(rows - label["y"]) <= label["size"])
    assert near.any(0).all() and near.any(1).all()


def test_a_figure_without_letters_and_one_that_copies_pictures_stay_as_they_are():
    spheres = FIGURES["F004-4"]
    assert not labels_of(spheres.commands("GEFORCE_256", 32), 32)
    graph = FIGURES["F000-11"]
    key = graph.machines[0]
    method, commands = graph.method(key), graph.commands(key, 64)
    assert labels_of(commands, 64) is None
    assert len(graph.commands(key, 64, without_letters(method))) == len(commands)
