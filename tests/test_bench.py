"""The measured scenes and the bookkeeping of ``python -m bench``. Nothing here measures a time."""

import ctypes
import importlib.util
import json
from dataclasses import replace

import numpy as np
import pytest

from bench import __main__ as command_line
from bench import measure, pictures
from bench.meshes import torus
from bench.peers import llvmpipe
from bench.scenes import BUMP, MODULATE, SCENES
from bench.shadow import balls_on_floor, shadow_map
from pipeline.profiles import GEFORCE_256
from pipeline.validate import validate


@pytest.mark.parametrize("name", SCENES)
def test_a_scenes_machine_can_draw_it(name):
    scene = SCENES[name]
    validate((*scene.textures(), *scene.frame(64, 1)), scene.profile, 64, 64)


def test_only_the_shadows_need_another_machine_than_the_geforce_256():
    assert {name for name, scene in SCENES.items() if scene.profile is not GEFORCE_256} == {"f2", "f3"}


# Issue "Faster than the chip it emulates": what is required of every scene, and the rates that it aims at.
def test_the_goals_are_the_issues():
    assert {name: (scene.goal, scene.aim) for name, scene in SCENES.items()} == {
        "a": (2.0, 1000),
        "a2": (1.5, 900),
        "b": (2.2, 400),
        "b2": (2.2, 400),
        "c": (1.8, 240),
        "d": (1.6, 200),
        "e": (None, None),
        "e2": (1.7, 15),
        "f2": (1.5, None),
        "f3": (1.5, None),
        "g": (2.0, None),
        "h": (2.0, 200),
    }


@pytest.mark.parametrize("name", SCENES)
def test_every_texture_unit_has_an_environment_for_the_peer(name):
    scene = SCENES[name]
    assert len(scene.environments) == len(scene.draw(64).state.texture_units)
    assert set(scene.environments) <= {"MODULATE", "DOT3"}


def test_the_bump_scenes_use_the_whole_machine():
    assert len(BUMP.general) == GEFORCE_256.max_general_combiners
    assert len(SCENES["c"].draw(64).state.texture_units) == GEFORCE_256.max_texture_units
    assert len(MODULATE.general) == 1


def test_the_torus_is_closed_and_has_80000_triangles_facing_outwards():
    mesh = torus()
    triangles = mesh.positions[mesh.indices].reshape(-1, 3, 3)
    assert len(triangles) == 80_000
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    # A closed surface with outward normals encloses a volume: 2 pi^2 R r^2 for a torus. Polygons of 200 edges
    # inscribed in the two circles each enclose sin(x)/x of it, x = 2 pi / 200: together 3.3e-4 less.
    volume = (triangles.mean(1) * normals).sum() / 6
    assert volume == pytest.approx(2 * np.pi**2 * 1.0 * 0.45**2, rel=4e-4)


def test_the_balls_are_closed_and_lie_within_the_map_that_shadows_them():
    mesh = balls_on_floor()
    triangles = mesh.positions[mesh.indices].reshape(-1, 3, 3)
    assert len(triangles) == 10_442
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    # The floor lies at height 0, where it adds nothing to the volume between it and the origin. Inscribed in
    # a sphere, 60 meridians and 30 parallels enclose 0.9 % less.
    volume = (triangles.mean(1) * normals).sum() / 6
    assert volume == pytest.approx(4 / 3 * np.pi * (0.5**3 + 0.35**3 + 0.45**3), rel=0.01)
    assert (normals * normals).sum(1).min() > 0  # no triangle is empty, at the poles either


BALL_CENTERS = ((-0.7, 0.3, 0.75), (0.65, -0.2, 0.5), (0.2, 0.9, 0.9))


def test_the_shadow_map_holds_three_discs_before_the_farthest_depth():
    words = np.ascontiguousarray(shadow_map(256).levels[0][0]).view("<u4")[..., 0]
    assert words.max() == 2**24 - 1
    # A sphere at distance l, of which z along the axis, is seen as an ellipse of this area, in units of the
    # focal length; the light sees 50 degrees. Source: I. Quilez, Sphere - projected size (2014).
    away = np.array(BALL_CENTERS) - (3.0, -2.0, 6.0)
    z, l2 = away @ np.array((-3.0, 2.0, -6.0)) / 7, (away * away).sum(1)
    r2 = np.array([0.5, 0.35, 0.45]) ** 2
    areas = np.pi * r2 / (z * z - r2) * np.sqrt((l2 - r2) / (z * z - r2))
    share = areas.sum() / (2 * np.tan(np.radians(25))) ** 2
    assert (words < 2**24 - 1).mean() == pytest.approx(share, rel=0.005)


def test_work_counts_fragments_of_all_layers_or_triangles():
    assert SCENES["a"].work(1024) == 8 * 1024**2
    assert SCENES["g"].work(512) == 100 * 512**2
    assert SCENES["e"].work(512) == 80_000


@pytest.mark.parametrize("name", [name for name, scene in SCENES.items() if scene.covers])
def test_a_scene_that_covers_the_screen_makes_one_fragment_for_every_pixel(name):
    scene = SCENES[name]
    assert scene.fragments(64) == 64**2
    assert replace(scene, covers=False).fragments(64) == 64**2


def test_fragments_are_counted_before_the_depth_test():
    # The floor fills the view, and the balls are drawn over it.
    assert 1.05 * 64**2 < SCENES["f2"].fragments(64) < 1.5 * 64**2
    assert SCENES["e2"].fragments(64) < SCENES["e"].fragments(64)


class _Scripted:
    """A party whose frames take the given seconds each, and that notes when it was asked."""

    def __init__(self, name, seconds, diary):
        self.name, self._seconds, self._diary = name, seconds, diary

    def turn(self, frames):
        self._diary.append((self.name, frames))
        return frames * self._seconds


def test_the_parties_take_turns_of_equal_length(monkeypatch):
    monkeypatch.setattr(measure, "REST_SECONDS", 0.0)
    diary = []
    parties = [_Scripted("ours", 0.5, diary), _Scripted("peer", 0.125, diary)]
    seconds = measure.take_turns(parties, turns=2, turn_seconds=1.0, warm_seconds=1.0)
    assert seconds == [[0.5, 0.5], [0.125, 0.125]]
    turn = [("ours", 1), ("ours", 2), ("peer", 1), ("peer", 8)]
    assert diary[-8:] == turn * 2


def test_rates_are_medians_and_the_ratio_is_ours_over_the_peers():
    row = measure.summarize(SCENES["e"], 512, 2, [[0.01, 0.02, 0.09], [0.01, 0.01, 0.5]])
    assert row.as_json() == {
        "scene": "e",
        "size": 512,
        "threads": 2,
        "unit": "Mtriangles/s",
        "ours": 4.0,
        "peer": 8.0,
        "ratio": 0.5,
        "goal": None,
        "aim": None,
        "spread": 1.0,
    }
    assert row.spread == pytest.approx(1.0)


def test_without_a_peer_the_row_has_neither_peer_nor_ratio():
    row = measure.summarize(SCENES["a"], 8, 1, [[0.25]]).as_json()
    assert row["peer"] is None
    assert row["ratio"] is None
    assert row["ours"] == 0.002  # 8 layers of 64 fragments in a quarter of a second


@pytest.fixture
def nothing_installed(monkeypatch):
    def refuse(name):
        raise OSError(name)

    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(ctypes, "CDLL", refuse)


@pytest.mark.usefixtures("nothing_installed")
def test_the_peer_says_what_is_missing():
    with pytest.raises(llvmpipe.PeerError, match=r"PyOpenGL is not installed.*libEGL\.so\.1 is missing"):
        llvmpipe.Llvmpipe(2)


@pytest.mark.usefixtures("nothing_installed")
def test_ours_is_measured_where_the_peer_is_missing(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(measure.Ours, "prepare", lambda self, scene, size: None)
    monkeypatch.setattr(command_line, "take_turns", lambda parties: [[0.5] for _ in parties])
    file = tmp_path / "rates.json"
    status = command_line.main(["a", "g", "--peer", "llvmpipe", "--size", "1000", "--json", str(file)])
    assert status == 0
    shown = capsys.readouterr()
    assert shown.err.startswith("Without llvmpipe: PyOpenGL is not installed")
    assert [line.split()[:2] for line in shown.out.splitlines()] == [
        ["scene", "size"],
        ["a", "1000"],
        ["g", "1000"],
    ]
    rows = json.loads(file.read_text())
    assert [(row["scene"], row["ours"], row["peer"]) for row in rows] == [
        ("a", 16.0, None),
        ("g", 200.0, None),
    ]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["a", "x1"], "there is no scene x1; the scenes are a, a2"),
        (["--threads", "0"], "--threads is 0; give 1 or more"),
        (["--size", "4096"], "--size is 4096; give 1 to 2048 pixels"),
        (["--json", "/no/such/folder/rates.json"], "/no/such/folder is not a folder that you may write to"),
    ],
)
def test_a_wrong_argument_is_a_sentence_and_exit_status_2(arguments, sentence, capsys):
    with pytest.raises(SystemExit) as exit_:
        command_line.main(arguments)
    assert exit_.value.code == 2
    assert sentence in capsys.readouterr().err


def _picture(color, depth, stencil):
    return {
        "color": np.array(color, np.uint8).reshape(1, -1, 4),
        "depth": np.array([depth], np.uint32),
        "stencil": np.array([stencil], np.uint8),
    }


def test_a_difference_counts_pixels_and_leaves_depth_out_where_only_one_party_drew():
    far = 2**24 - 1
    one = _picture([[0, 0, 9, 0], [255, 0, 0, 0]], [1000, 5], [0, 100])
    other = _picture([[0, 0, 4, 0], [0, 0, 0, 0]], [1002, far], [0, 98])
    found = pictures.difference(one, other, levels=5)
    assert found == pictures.Difference(color=255, beyond=1, depth=2, stencil=2, coverage=1, pixels=2)


def test_a_picture_is_as_expected_only_within_the_scenes_levels_and_share():
    one = pictures.Difference(color=99, beyond=1, depth=0, stencil=0, coverage=0, pixels=200)
    assert one.as_expected(SCENES["e"])
    assert not one.as_expected(SCENES["a"])
    assert not replace(one, beyond=2).as_expected(SCENES["e"])
    assert not replace(one, stencil=1).as_expected(SCENES["e"])


@pytest.fixture(scope="module")
def peer():
    try:
        party = llvmpipe.Llvmpipe(1)
    except llvmpipe.PeerError as problem:
        pytest.skip(str(problem))
    with party:
        yield party


@pytest.mark.parametrize("name", SCENES)
def test_ours_and_the_peers_picture_of_a_scene_agree(name, peer):
    scene = SCENES[name]
    # The smaller such a picture is, the more a snapped vertex shifts its textures.
    size = scene.size if scene.snapped else 64
    ours = measure.Ours(1)
    ours.prepare(scene, size)
    peer.prepare(scene, size)
    found = pictures.difference(ours.picture(), peer.picture(), scene.levels)
    assert found.as_expected(scene), found
    if not scene.snapped:
        assert found.depth == 0
    # Of the silhouette's some 2000 pixels, those whose centre the snapping moves over an edge of 1/16 pixel.
    assert found.coverage <= 2000 / 16
