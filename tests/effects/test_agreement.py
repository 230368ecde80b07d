"""Masks compared with rays: what is a difference, and of which kind."""

import numpy as np
import pytest

from fixedpipe.effects.acceptance import agreement, ray_caster
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.geometry import surfaces, views
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.scenes import objects_and_lamps, still_life

PANEL = views.Panel(0, 0, 128, 128)


@pytest.fixture(scope="module")
def truth():
    scene = still_life.still_life(24)
    lamp = objects_and_lamps.lamp_around(scene, still_life.LAMP_POSITIONS[0])
    return agreement.truth_of(scene, still_life.still_life_view(PANEL), lamp)


@pytest.fixture(scope="module")
def throwing():
    """What throws shadows alone, which is what a map holds."""
    return ray_caster.scene_caster(objects_and_lamps.Scene(still_life.still_life(24).throwing))


def length(vectors):
    return np.sqrt(dot(vectors, vectors))


def shifted(mask, x):
    return np.roll(mask, x, axis=1)


def test_the_truth_agrees_with_itself(truth):
    found = agreement.compare(truth.lit, truth)
    assert (found.agreeing, found.other, found.compared) == (1.0, 0, int(truth.shown.something.sum()))
    assert 0.2 < truth.lit[truth.shown.something].mean() < 0.9


def test_a_mask_one_pixel_off_differs_at_edges_only(truth):
    wrapped = np.arange(PANEL.width) > 0
    found = agreement.compare(shifted(truth.lit, 1), truth, where=wrapped)
    assert found.other == found.contact == found.grazing == 0
    assert found.shadow_edge > 50 and found.silhouette > 5
    assert found.silhouette + found.shadow_edge == round((1.0 - found.agreeing) * found.compared)


def test_a_mask_further_off_is_seen(truth):
    mask = shifted(truth.lit, 4)
    floor = (truth.shown.object == 0) & (shifted(truth.shown.object, 4) == 0) & (np.arange(PANEL.width) >= 4)
    assert agreement.compare(mask, truth, where=floor).other > 10
    assert agreement.compare(mask, truth, where=floor, edge_pixels=4).other == 0


@pytest.mark.parametrize("answer", [True, False])
def test_no_shadow_or_nothing_but_shadow_is_seen(truth, answer):
    found = agreement.compare(np.full_like(truth.lit, answer), truth, map_edge=256)
    assert found.other > 0.2 * (1.0 - found.agreeing) * found.compared


def test_a_coarse_shadow_map_differs_within_its_texels_and_its_bias(truth, throwing):
    """A map of exact distances, looked up as NEAREST does: what is wrong is its resolution and its bias."""
    edge, bias = 128, 0.3
    from_lamp = ray_caster.visible(throwing, truth.lamp.view(views.Panel(0, 0, edge, edge)))
    distances = np.where(from_lamp.something, length(from_lamp.points - truth.lamp.position), np.inf)
    s, t, _, q = (truth.shown.points @ row[:3] + row[3] for row in np.array(truth.lamp.texture_matrix))
    column, row = (np.clip(np.floor(c / q * edge).astype(int), 0, edge - 1) for c in (s, t))
    own = length(truth.shown.points - truth.lamp.position)

    def found(bias, **understood):
        mask = truth.shown.something & (own <= distances[row, column] + bias)
        return agreement.compare(mask, truth, edge_pixels=0, **understood)

    assert found(bias).agreeing > 0.95
    assert found(bias).other > 100
    assert found(bias, map_edge=edge, edge_texels=1.0).other > 30
    assert found(bias, contact=bias).other > 30
    assert found(bias, map_edge=edge, edge_texels=1.0, contact=bias).other <= 3
    # Too small a bias: surfaces shadow themselves, which is never understood.
    assert found(0.0, map_edge=edge, edge_texels=1.0).other > 1000


def test_a_shadow_from_nearer_than_the_bias_may_be_missing(truth):
    scene = objects_and_lamps.Scene(
        (
            objects_and_lamps.Object("floor", objects_and_lamps.floor(3.0, 3), (1.0, 1.0, 1.0), closed=False),
            objects_and_lamps.Object("box", surfaces.box(1.0, 0.1, 1.0).moved(0, 0.5, 0), (1.0, 1.0, 1.0)),
        )
    )
    lamp = objects_and_lamps.lamp_around(scene, (4.0, 9.0, 0.0))
    truth = agreement.truth_of(scene, still_life.still_life_view(PANEL), lamp)
    everything = truth.shown.something
    assert agreement.compare(everything, truth, contact=0.3).other > 20
    found = agreement.compare(everything, truth, contact=0.7)
    assert found.other == 0 and found.contact > 20
    # What is dark without anything in the way is no matter of a bias.
    assert agreement.compare(~everything, truth, contact=0.7).contact == 0


def test_where_leaves_pixels_out(truth):
    floor = truth.shown.object == 0
    found = agreement.compare(~truth.lit, truth, where=floor)
    assert (found.compared, found.agreeing) == (int(floor.sum()), 0.0)
    assert (found.kinds[~floor] == agreement.NOT_COMPARED).all()


def test_masks_of_another_size_are_refused(truth):
    with pytest.raises(ValueError, match="render both alike"):
        agreement.compare(truth.lit[:-1], truth)


ABOVE = objects_and_lamps.Lamp((0.0, 5.0, 0.0), (0.0, 0.0, 0.0), 1.0, 6.0, infinite=True, half_width=1.0)


@pytest.mark.parametrize(("pixels", "outline"), [(2.0, False), (10.0, True)])
def test_a_step_within_an_object_is_an_outline_where_it_is_deep(pixels, outline):
    """Two blocks of one object, seen from above, one higher by so many pixels' widths."""
    step = pixels * 2.0 / PANEL.width
    blocks = surfaces.joined(
        surfaces.box(1.0, 1.0, 1.5).moved(-0.5, -0.5, 0.0),
        surfaces.box(1.0, 1.0, 1.5).moved(0.5, step - 0.5, 0.0),
    )
    scene = objects_and_lamps.Scene((objects_and_lamps.Object("blocks", blocks, (1.0, 1.0, 1.0)),))
    truth = agreement.truth_of(scene, ABOVE.view(PANEL), ABOVE)
    found = agreement.silhouettes(truth) & truth.shown.something
    middle = PANEL.width // 2
    assert found[middle, middle - 1 : middle + 1].all() == outline
    assert not found[middle, 8 : middle - 1].any() and not found[middle, middle + 1 : -8].any()


@pytest.mark.parametrize(("texels", "excused"), [(1.0, True), (3.0, False)])
def test_a_shadow_beside_its_place_by_more_than_the_texels_allowed_is_a_fault(texels, excused):
    edge = 32
    scene = objects_and_lamps.Scene(
        (
            objects_and_lamps.Object("floor", objects_and_lamps.floor(2.0, 2), (1.0, 1.0, 1.0), closed=False),
            objects_and_lamps.Object(
                "plate", surfaces.box(0.7, 0.02, 0.7).moved(0.0, 1.0, 0.0), (1.0, 1.0, 1.0)
            ),
        )
    )
    lamp = objects_and_lamps.Lamp((0.6, 1.0, 0.0), (0.0, 0.0, 0.0), -4.0, 4.0, infinite=True, half_width=1.0)
    truth = agreement.truth_of(scene, ABOVE.view(PANEL), lamp)
    # Along z, where the map's texels are as long as on the floor.
    aside = truth.shown.points + np.array([0.0, 0.0, texels * 2.0 / edge])
    mask = ray_caster.lit_points(
        truth.caster, aside.reshape(-1, 3), truth.shown.normals.reshape(-1, 3), lamp
    ).reshape(truth.lit.shape)
    floor = (truth.shown.object == 0) & ~agreement.silhouettes(truth)
    found = agreement.compare(mask, truth, where=floor, edge_pixels=0, map_edge=edge, edge_texels=1.5)
    assert found.agreeing < 0.995
    assert (found.other == 0) == excused, str(found)


def test_checks_are_of_the_worst_panel_and_of_all_faults(truth):
    good, bad = (agreement.compare(m, truth) for m in (truth.lit, ~truth.lit))
    assert bad.other > 100
    for found in ((good, bad), (bad, good)):
        for checks in (agreement.volume_checks, agreement.map_checks):
            least, other = checks({Answer.MACHINE: found})
            assert (least.value, other.value) == (0.0, bad.other)
            assert not least.passed and not other.passed
            assert least.on is other.on is Answer.MACHINE
    assert all(c.passed for c in agreement.map_checks({Answer.IDEAL: (good, good)}, 1.0, 0))


def test_a_mask_is_lit_above_one_half():
    picture = np.array([[[0.0, 1.0, 1.0], [0.49, 0.0, 0.0], [0.51, 0.0, 0.0]]])
    assert agreement.lit_mask(picture).tolist() == [[False, False, True]]
