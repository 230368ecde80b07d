"""The measured scenes and the bookkeeping of ``python -m bench``. Nothing here measures a time."""

import ctypes
import importlib.util
import json
from dataclasses import replace

import numpy as np
import pytest

from bench import __main__ as command_line
from bench import measure, pictures
from bench.peers import llvmpipe
from bench.scenes import BUMP, MODULATE, SCENES, torus
from pipeline.profiles import GEFORCE_256
from pipeline.validate import validate


@pytest.mark.parametrize("name", SCENES)
def test_a_geforce_256_can_draw_every_scene(name):
    scene = SCENES[name]
    validate((*scene.textures(), *scene.frame(64, 1)), GEFORCE_256, 64, 64)


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


def test_work_counts_fragments_of_all_layers_or_triangles():
    assert SCENES["a"].work(1024) == 8 * 1024**2
    assert SCENES["g"].work(512) == 100 * 512**2
    assert SCENES["e"].work(512) == 80_000


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
        "goal": 0.5,
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
    # A torus needs its own size: the smaller it is, the more a snapped vertex shifts its minified texture.
    size = scene.size if scene.outside else 64
    ours = measure.Ours(1)
    ours.prepare(scene, size)
    peer.prepare(scene, size)
    found = pictures.difference(ours.picture(), peer.picture(), scene.levels)
    assert found.as_expected(scene), found
    if not scene.outside:
        assert found.depth == 0
    # Of the silhouette's some 2000 pixels, those whose centre the snapping moves over an edge of 1/16 pixel.
    assert found.coverage <= 2000 / 16
