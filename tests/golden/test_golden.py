"""Figures keep their bits; a digest is accepted only with the specification's and a person's agreement."""

import json

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.figures.costs import SECONDS
from fixedpipe.pipeline.golden.digests import digest, from_text
from fixedpipe.pipeline.profiles import FUTURE
from tests import accept
from tests.support.sample import sampled_figures, slow_unless

# Each figure on each of its machines; those that draw it as another does take minutes together, and so do
# spheres of thousands of polygons, each with textures of its own. Long ones are drawn in turn.
SAMPLE = sampled_figures()
_LONG = 15  # seconds of a figure on all its machines with its checks


def is_quick(figure, method):
    return not accept.loads_for_each_polygon(figure, method) and (
        figure.id in SAMPLE or SECONDS.get(figure.id, 0.0) <= _LONG
    )


ACCEPTED = [
    pytest.param(f.id, machine, marks=slow_unless(machine == method.machines[0] and is_quick(f, method)))
    for f in FIGURES.values()
    for method in f.methods
    for machine in method.machines
]


@pytest.mark.parametrize(("figure_id", "machine"), ACCEPTED)
def test_a_figure_keeps_its_accepted_bits(figure_id, machine):
    figure = FIGURES[figure_id]
    color = accept.render(figure, machine)
    golden = from_text(accept.golden_path(figure_id, machine).read_text())
    assert accept.golden_of(figure, machine, color) == golden
    if (page := accept.page_picture(figure_id, machine)).is_file():
        assert accept.is_shown(page)
        np.testing.assert_array_equal(np.asarray(Image.open(page)), color[..., :3])


# Each figure on the first machine of each of its methods. Plain Python takes seconds for these; meshes of
# thousands of triangles, or copies of every pixel, take it minutes.
QUICK = ("F004-2", "GEFORCE_256"), ("F004-2", "OCTANE"), ("F004-3", "GEFORCE_256")
SPECIFIED = [
    pytest.param(f.id, method.machines[0], marks=slow_unless((f.id, method.machines[0]) in QUICK))
    for f in FIGURES.values()
    for method in f.methods
    if accept.is_specified(method.machines[0])
]


# Of a figure whose textures are as large as it is, on machines whose edges are powers of two; and of one that
# copies a rectangle of 32 x 32.
_SIZES = {"H32": 32, "H43": 32}


@pytest.mark.parametrize(("figure_id", "machine"), SPECIFIED)
def test_a_small_picture_of_a_figure_equals_the_specification(figure_id, machine):
    size = _SIZES.get(figure_id, 24)
    assert accept.differences_from_reference(FIGURES[figure_id], machine, size=size) == 0


def test_a_picture_of_a_wider_machine_is_held_against_the_ideal():
    figure = FIGURES["F004-2"]
    assert accept.error_from_ideal(figure, "FUTURE", size=24) <= accept.FROM_IDEAL / 2
    dimmer = FUTURE.changed(combiner_range=0.98)  # no register reaches one
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(accept, "PROFILES", {"FUTURE": dimmer})
        assert accept.error_from_ideal(figure, "FUTURE", size=24) > accept.FROM_IDEAL


def test_a_digest_depends_on_every_bit_and_on_the_shape():
    color = np.zeros((4, 6, 4), np.uint8)
    changed = color.copy()
    changed[3, 5, 3] = 1
    assert len({digest(color), digest(changed), digest(color.reshape(6, 4, 4))}) == 3
    assert digest(np.asfortranarray(changed)) == digest(changed)


def test_a_digest_of_anything_but_bytes_is_refused():
    with pytest.raises(ValueError, match="holds float64"):
        digest(np.zeros((1, 1, 4)))


@pytest.mark.parametrize("text", ["", "[]", '{"figure": "F004-2"}'])
def test_a_damaged_digest_file_is_refused_in_a_sentence(text):
    with pytest.raises(ValueError, match="not an accepted digest"):
        from_text(text)


@pytest.fixture
def elsewhere(monkeypatch, tmp_path):
    """Acceptance that writes to a temporary folder and renders pictures of 16 pixels."""
    for name in ("GOLDEN", "PICTURES", "PAGES"):
        monkeypatch.setattr(accept, name, tmp_path)
    monkeypatch.setattr(accept, "GOLDEN_SIZE", 16)
    monkeypatch.setattr(accept, "REFERENCE_SIZE", 8)
    return tmp_path


def test_a_digest_is_accepted_only_after_the_picture_was_looked_at(elsewhere, capsys):
    assert accept.main(["F004-2"]) == 1
    assert FIGURES["F004-2"].must_see in capsys.readouterr().out
    assert not (elsewhere / "F004-2-GEFORCE_256.json").exists()
    assert accept.main(["F004-2", "--looked"]) == 0
    assert json.loads((elsewhere / "F004-2-GEFORCE_256.json").read_text())["size"] == 16
    assert accept.main(["F004-2"]) == 0


def test_a_digest_is_refused_when_the_specification_disagrees(elsewhere, monkeypatch, capsys):
    run_reference = accept.run_reference

    def wrong_by_one_bit(*arguments):
        frame = run_reference(*arguments)
        frame.target.color[0][0][0] ^= 1
        return frame

    monkeypatch.setattr(accept, "run_reference", wrong_by_one_bit)
    assert accept.main(["F004-2", "--looked"]) == 1
    assert "1 values differ" in capsys.readouterr().err
    assert not (elsewhere / "F004-2-GEFORCE_256.json").exists()


def test_an_unknown_figure_is_refused_with_the_names_there_are(capsys):
    assert accept.main(["F004-9"]) == 2
    assert "F004-2" in capsys.readouterr().err
