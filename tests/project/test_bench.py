"""The measured scenes and the bookkeeping of ``python -m bench``. Nothing here measures a time."""

import ctypes
import importlib.util
import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from bench import __main__ as command_line
from bench import (
    figures,
    growth,
    largest_frame,
    measure,
    pictures,
    prefilter,
    processor,
    roofline,
    scattering,
)
from bench.meshes import torus
from bench.peers import llvmpipe, mesa, swiftshader
from bench.peers.mesa import PeerError
from bench.scenes import BUMP, CLEAR_COLOR, MODULATE, SCENES, bump
from bench.shadow import balls_on_floor, shadow_map
from fixedpipe.effects.figures import FIGURES
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.validation.validate import validate


@pytest.fixture(autouse=True)
def quiet(monkeypatch):
    """Nothing computes beside a test."""
    monkeypatch.setattr(processor.Disturbance, "share", lambda self: 0.02)


@pytest.mark.parametrize("name", SCENES)
def test_a_scenes_machine_can_draw_it(name):
    scene = SCENES[name]
    validate((*scene.textures(), *scene.frame(64, 1)), scene.profile, 64, 64)


def test_only_the_shadows_need_another_machine_than_the_geforce_256():
    assert {name for name, scene in SCENES.items() if scene.profile is not GEFORCE_256} == {"f2", "f3"}


def test_the_rates_that_scenes_aim_at():
    assert {name: scene.aim for name, scene in SCENES.items() if scene.aim} == {
        "a": 1000,
        "a2": 900,
        "b": 400,
        "b2": 400,
        "c": 240,
        "d": 200,
        "e2": 15,
        "h": 200,
    }


@pytest.mark.parametrize("name", SCENES)
def test_every_texture_unit_has_an_environment_for_the_peer(name):
    scene = SCENES[name]
    assert len(scene.environments) == len(scene.draw(64).state.texture_units)
    assert set(scene.environments) <= {"MODULATE", "DOT3"}


def test_the_bump_scenes_use_the_whole_machine():
    assert len(BUMP.general) == GEFORCE_256.combiners.max_general_combiners
    assert len(SCENES["c"].draw(64).state.texture_units) == GEFORCE_256.textures.max_texture_units
    assert len(MODULATE.general) == 1


def triangles_and_normals(mesh):
    triangles = mesh.positions[mesh.indices].reshape(-1, 3, 3)
    return triangles, np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


def test_the_torus_is_closed_and_has_80000_triangles_facing_outwards():
    triangles, normals = triangles_and_normals(torus())
    assert len(triangles) == 80_000
    # A closed surface with outward normals encloses a volume: 2 pi^2 R r^2 for a torus. Polygons of 200 edges
    # inscribed in the two circles each enclose sin(x)/x of it, x = 2 pi / 200: together 3.3e-4 less.
    volume = (triangles.mean(1) * normals).sum() / 6
    assert volume == pytest.approx(2 * np.pi**2 * 1.0 * 0.45**2, rel=4e-4)


def test_the_balls_are_closed_and_lie_within_the_map_that_shadows_them():
    triangles, normals = triangles_and_normals(balls_on_floor())
    assert len(triangles) == 10_442
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
    draw = SCENES["e"].draw(64)
    untested = replace(draw, state=replace(draw.state, depth_test=None))
    assert SCENES["e"].fragments(64) == replace(SCENES["e"], draw=lambda size: untested).fragments(64)


def test_scene_i_has_draws_of_some_9000_fragments_over_all_pixels_and_their_depths_first():
    scene = SCENES["i"]
    layer = scene.layer(scene.size)
    assert len(layer) == 121
    assert 8500 < scene.fragments(scene.size) / len(layer) < 9000
    assert scene.triangles(scene.size) == 242
    _, *draws = scene.frame(64, 2)
    depths, first, second = draws[:121], draws[121:242], draws[242:]
    assert first == second
    assert [draw.mesh for draw in depths] == [draw.mesh for draw in first]
    assert {len(draw.state.texture_units) for draw in depths} == {0}
    machine = Machine(scene.profile, 64, 64, threads=1)
    machine.run((*scene.textures(), *scene.frame(64, 1)))
    clear = np.rint(255 * np.array(CLEAR_COLOR))
    # Where the depth is equal, there is a fragment; where none was drawn before, there is none.
    drawn = (machine.framebuffer.color != clear).any(-1)
    machine.run(replace(scene, depth_first=False).frame(64, 1))
    assert drawn.mean() > 0.99
    assert (machine.framebuffer.color == clear).all()


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


def test_one_thread_is_measured_by_its_own_clock(monkeypatch):
    assert measure.clock_of(1) is measure.time.process_time
    assert measure.clock_of(2) is measure.time.perf_counter
    for threads in (1, 2):
        monkeypatch.setenv("LP_NUM_THREADS", mesa.environment(threads)["LP_NUM_THREADS"])
        assert mesa.own_threads() == threads


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
    with pytest.raises(PeerError, match=r"PyOpenGL is not installed.*libEGL\.so\.1 is missing"):
        llvmpipe.Llvmpipe(2)


@pytest.mark.usefixtures("nothing_installed")
def test_swiftshader_says_what_is_missing_too(monkeypatch, tmp_path):
    monkeypatch.setattr(swiftshader, "_DRIVER", tmp_path / "icd.json")
    lacking = r"PyOpenGL is not.*icd\.json is missing.*install chromium.*libvulkan\.so\.1.*install libvulkan1"
    with pytest.raises(PeerError, match=lacking):
        swiftshader.SwiftShader(2)


@pytest.mark.parametrize("party", [llvmpipe.Llvmpipe, swiftshader.SwiftShader])
def test_another_renderer_than_the_peer_is_refused(party):
    peer = object.__new__(party)
    with pytest.raises(PeerError, match=r"Mesa drew with softpipe; on Debian, libgl1-mesa-dri has"):
        peer._greet({"renderer": "softpipe", "version": "1"})
    peer._greet({"renderer": f"{party.device} (1)", "version": "2"})
    assert peer.description.split()[0] == party.name


def test_ratios_to_swiftshader_have_no_goals(monkeypatch, tmp_path):
    class Beside(swiftshader.SwiftShader):
        description = "swiftshader"

        def __init__(self, threads):
            pass

        def prepare(self, scene, size):
            pass

        def close(self):
            pass

    monkeypatch.setitem(command_line.PEERS, "swiftshader", Beside)
    monkeypatch.setattr(measure.Ours, "prepare", lambda self, scene, size: None)
    monkeypatch.setattr(command_line, "take_turns", lambda parties: [[1.0] for _ in parties])
    file = tmp_path / "rates.json"
    assert command_line.main(["a", "--peer", "swiftshader", "--json", str(file)]) == 0
    (row,) = json.loads(file.read_text())["scenes"]
    assert (row["ratio"], row["goal"]) == (1.0, None)


@pytest.mark.usefixtures("nothing_installed")
def test_ours_is_measured_where_the_peer_is_missing(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(measure.Ours, "prepare", lambda self, scene, size: None)
    monkeypatch.setattr(command_line, "take_turns", lambda parties: [[0.5] for _ in parties])
    file = tmp_path / "rates.json"
    status = command_line.main(["a", "g", "--peer", "llvmpipe", "--size", "1000", "--json", str(file)])
    assert status == 0
    shown = capsys.readouterr()
    assert shown.err.startswith("Without llvmpipe: PyOpenGL is not installed")
    assert [line.split()[:2] for line in shown.out.splitlines()[2:]] == [
        [],
        ["Scenes"],
        ["scene", "size"],
        ["a", "1000"],
        ["g", "1000"],
    ]
    found = json.loads(file.read_text())
    assert [(row["scene"], row["ours"], row["peer"]) for row in found.pop("scenes")] == [
        ("a", 16.0, None),
        ("g", 200.0, None),
    ]
    assert {name for name in found if name not in ("date", "commit", "processor", "versions")} == {
        "cpu", "threads", "peer", "others", "figures", "roofline", "growth", "scattering", "prefilter"
    }  # fmt: skip
    assert found == found | {
        "cpu": None,
        "threads": 2,
        "peer": None,
        "others": 0.02,
        "figures": [],
        "roofline": None,
        "growth": None,
        "scattering": None,
        "prefilter": None,
    }


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["a", "x1"], "there is no x1; the names are a, a2"),
        (["a", "cold", "--images", "."], "cold has no picture; with --images name scenes: a, a2"),
        (["growth", "--plot", "x.png"], "--plot draws what scattering measures; name it too"),
        (["--threads", "0"], "--threads is 0; give 1 or more"),
        (["--history", "h.jsonl", "--images", "."], "--history keeps what is measured, and --images"),
        (["history", "/no/such/file"], "No such file or directory"),
        (["tables", "/no/such/file"], "No such file or directory"),
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


# ------------------------------------------------------------------------------------------- figures


def test_the_many_passes_are_64_states_over_one_mesh_and_draw_next_to_nothing():
    commands = FIGURES["F004-4"].commands(GEFORCE_256, 512)
    machine = Machine(GEFORCE_256, 512, 512, threads=1)
    machine.run(command for command in commands if isinstance(command, TexImage))
    passes = figures.many_passes(commands, 0)
    assert len(passes) == 64
    assert len({draw.mesh for draw in passes}) == 1
    states = {draw.state for draw in (*passes, *figures.many_passes(commands, 1))}
    assert len(states) == 128
    # The state's own way to the framebuffer: both textures and both general combiners of the paper's pass.
    (own,) = {replace(s, register_combiners=None, scissor=None) for s in states}
    specular = [command for command in commands if isinstance(command, Draw)][1].state
    assert own == replace(specular, register_combiners=None, scissor=None)
    assert len(own.texture_units) == 2
    anew = figures.made_anew(passes)
    assert [draw.state for draw in anew] == [draw.state for draw in passes]
    assert {draw.mesh for draw in anew} == {draw.mesh for draw in passes}
    parts = [{id(draw.state.register_combiners.general[0]) for draw in draws} for draws in (anew, passes)]
    assert (len(parts[0]), len(parts[1]), len(parts[0] & parts[1])) == (64, 1, 0)
    # The sphere's front and its back, behind one pixel.
    assert machine.run(passes).fragments == 2 * 64


@pytest.mark.parametrize(
    ("value", "verdict"), [(24.96, "24.96      ≤ 25  s          reached     20%"), (26.0, "MISSED")]
)
def test_a_figure_is_printed_with_its_verdict(value, verdict, monkeypatch, capsys, tmp_path):
    measured = figures.Measured(value, {"best": 1.0}, 0.2)
    cold = replace(figures.FIGURES["cold"], measure=lambda threads: measured)
    monkeypatch.setitem(command_line.FIGURES, "cold", cold)
    assert command_line.main(["cold", "--json", str(tmp_path / "figures.json")]) == 0
    shown = capsys.readouterr().out
    assert verdict in shown
    assert "Disturbed, their turns differ by more than a tenth: cold (20%)." in shown
    (found,) = json.loads((tmp_path / "figures.json").read_text())["figures"]
    assert found == {
        "figure": "cold",
        "title": cold.title,
        "unit": "s",
        "measured": value,
        "goal": 25,
        "relation": "at most",
        "reached": value <= 25,
        "spread": 0.2,
        "details": {"best": 1.0},
    }


def test_what_this_machine_cannot_tell_is_said_and_left_out(monkeypatch, capsys, tmp_path):
    def refuse(threads):
        raise OSError("no /proc")

    memory = replace(figures.FIGURES["memory"], measure=refuse)
    monkeypatch.setitem(command_line.FIGURES, "memory", memory)
    assert command_line.main(["memory", "--json", str(tmp_path / "figures.json")]) == 0
    assert capsys.readouterr().err == "memory was not measured: no /proc\n"
    assert json.loads((tmp_path / "figures.json").read_text())["figures"] == []


def test_the_largest_frame_reads_textures_of_its_own_edge(monkeypatch):
    machines = []

    class Watched(Machine):
        def __post_init__(self):
            super().__post_init__()
            machines.append(self)

    monkeypatch.setattr(largest_frame, "Machine", Watched)
    largest_frame.draw(1, edge=1024)
    (machine,) = machines
    assert (machine.width, machine.height) == (1024, 1024)
    assert {(t.width, t.height) for t in machine.textures.values()} == {(1024, 1024)}
    assert len(machine.textures) == 2
    assert machine.framebuffer.color.any()
    assert largest_frame.EDGE == 2048


def test_the_peak_is_read_in_bytes(tmp_path):
    status = tmp_path / "status"
    status.write_text("VmPeak:\t 9 kB\nVmHWM:\t    2048 kB\nVmRSS:\t 7 kB\n")
    assert largest_frame.peak_resident_bytes(status) == 2048 * 1024
    status.write_text("VmPeak:\t 9 kB\n")
    with pytest.raises(OSError, match="has no VmHWM"):
        largest_frame.peak_resident_bytes(status)


# ------------------------------------------------------------------------------------------ roofline


def _bytes(name, size=64):
    moved = roofline.traffic(SCENES[name], size)
    return moved.color, moved.depth, moved.stencil, moved.texture


def test_a_fragment_moves_what_its_state_reads_and_writes():
    assert _bytes("a") == (4, 0, 0, 0)
    assert _bytes("b") == (4, 0, 0, 16)
    assert _bytes("c") == (4, 0, 0, 32)
    assert _bytes("d") == (8, 8, 0, 32)  # blending reads the colour, the test the depth
    assert _bytes("f3") == (4, 8, 0, 16)
    assert _bytes("g") == (0, 4, 2, 0)  # depth is compared, not written; no colour at all
    assert _bytes("h") == (4, 0, 0, 32)


def test_a_triangle_moves_what_its_fragments_do_and_its_vertices():
    scene = SCENES["e2"]
    fragments = scene.fragments(512) / 80_000
    moved = roofline.traffic(scene, 512)
    assert moved.texture == pytest.approx(16 * fragments)
    assert moved.depth == pytest.approx(8 * fragments)
    assert moved.clear == pytest.approx(9 * 512**2 / 80_000)
    # Three positions and two coordinates of eight bytes a vertex, three indices of eight bytes a triangle.
    assert moved.geometry == pytest.approx(5 * 8 * 201**2 / 80_000 + 3 * 8)
    assert moved.written == pytest.approx(moved.clear + moved.color)


def test_every_layer_takes_its_share_of_the_clear():
    assert roofline.traffic(SCENES["a"], 64).clear == 9 / 8
    assert roofline.traffic(SCENES["g"], 64).clear == 9 / 100


def test_the_bound_is_the_time_that_each_kind_of_access_takes():
    moved = roofline.Traffic(
        clear=1.0, color=4.0, depth=8.0, stencil=0.0, texture=16.0, geometry=1.0, written=5.0
    )
    assert moved.total == 30.0
    assert moved.bound(write=10.0, update=50.0) == pytest.approx(1 / (5 / 10 + 25 / 50))


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("access", roofline.ACCESSES)
def test_a_bandwidth_counts_every_byte_that_is_touched(access, threads, monkeypatch):
    touched = []
    touch, count = roofline.ACCESSES[access]
    monkeypatch.setitem(roofline.ACCESSES, access, (lambda a: (touch(a), touched.append(a.nbytes)), count))
    ticks = iter(range(1000))
    monkeypatch.setattr(roofline, "time", SimpleNamespace(perf_counter=lambda: float(next(ticks))))
    # A second to touch every array once, three seconds asked for: three times each.
    found = roofline.measure_bandwidth(access, 1 << 12, threads, seconds=3.0 / threads, times=1)
    assert sum(touched) == (1 + 3) << 12
    assert found.bytes == 1 << 12
    assert 0 < found.rate <= count * 3 << 12


def test_the_roofline_tells_every_scene_and_the_share_of_what_was_measured(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(
        roofline,
        "measure_bandwidth",
        lambda access, size, threads: roofline.Bandwidth(access, size, threads, 1e9 * threads),
    )
    monkeypatch.setattr(measure.Ours, "prepare", lambda self, scene, size: None)
    monkeypatch.setattr(command_line, "take_turns", lambda parties: [[0.5] for _ in parties])
    file = tmp_path / "roofline.json"
    assert command_line.main(["a", "roofline", "--size", "64", "--json", str(file)]) == 0
    found = json.loads(file.read_text())["roofline"]
    assert [(b["bytes"], b["access"], b["threads"]) for b in found["bandwidth"]] == [
        (size, access, threads)
        for size in (4 << 20, 256 << 20)
        for access in ("write", "read and write")
        for threads in (1, 2)
    ]
    assert [line["scene"] for line in found["scenes"]] == list(SCENES)
    first, second = found["scenes"][:2]
    # Colour, its eighth of the Clear, and eight numbers a vertex of the quad's four.
    assert first["cache_bound"] == round(2e9 / (4 + 9 / 8 + 4 * 8 * 8 / 64**2) / 1e6, 1)
    assert first["ours"] == pytest.approx(8 * 64**2 / 0.5 / 1e6, abs=1e-3)
    assert first["share_of_cache_bound"] == pytest.approx(first["ours"] / first["cache_bound"], abs=1e-4)
    assert (second["ours"], second["share_of_cache_bound"]) == (None, None)


# -------------------------------------------------------------------------------------------- growth


@pytest.mark.parametrize("name", growth.CURVES)
def test_a_curves_machine_can_draw_every_point(name):
    for _, scene, size in growth.CURVES[name].points():
        validate((*scene.textures(), *scene.frame(size, 1)), scene.profile, size, size)


def test_the_curves_run_from_the_smallest_to_the_largest():
    points = {name: list(curve.points()) for name, curve in growth.CURVES.items()}
    assert [number for number, _, _ in points["edge"]] == [256, 512, 1024, 2048, 4096]
    assert [number for number, _, _ in points["stages"]] == list(range(1, 9))
    triangles = [number for number, _, _ in points["triangles"]]
    assert (triangles[0], triangles[-1]) == (10**3, 10**6)
    assert triangles == sorted(triangles)
    assert triangles == [scene.triangles(size) for _, scene, size in points["triangles"]]


def test_stages_grow_by_the_second_of_scene_c():
    programs = [s.draw(64).state.register_combiners for _, s, _ in growth.CURVES["stages"].points()]
    assert [len(program.general) for program in programs] == list(range(1, 9))
    assert programs[1] == BUMP
    assert programs[7].general[:2] == BUMP.general
    assert set(programs[7].general[2:]) == {BUMP.general[1]}
    assert bump(1).general == BUMP.general[:1]


def test_a_point_is_the_median_of_its_frames(monkeypatch, capsys):
    prepared = []
    monkeypatch.setattr(measure.Ours, "prepare", lambda self, scene, size: prepared.append(size))
    monkeypatch.setattr(growth, "take_turns", lambda parties, **_: [[0.5, 2.0, 1.0]])
    (first, *_, last) = growth.measure(growth.CURVES["edge"], 2)
    assert prepared == [256, 512, 1024, 2048, 4096]
    assert first == growth.Point(256, 8 * 256**2 / 1e6, "Mfragments/s", 1000.0)
    assert last.number == 4096
    assert command_line.main(["growth"]) == 0
    assert "Growth: scene c, framebuffer edge in pixels" in capsys.readouterr().out


# ---------------------------------------------------------------------------------------- scattering


def test_table_1_is_timed_step_by_step(monkeypatch):
    ran = []

    def once(step, turns=0):
        ran.append(step())
        return 2.0

    monkeypatch.setattr(scattering, "seconds_of", once)
    monkeypatch.setattr(scattering, "DIRECTIONS", 8)
    found = list(scattering.measure(1, {"triangles": 8, "bricks": 128}))
    steps = ["S_i", "ellipses", "software", "GEFORCE_256", "GEFORCE_3", "OCTANE", "G400"]
    # The G400's signed bytes do not reach across 128 texels.
    assert [t.step for t in found] == steps + steps[:-1]
    assert len(ran) == len(found) and all(t.seconds == 2.0 for t in found)
    first = found[0]
    assert (first.paper, first.goal) == (27.0, 0.3)
    assert [t.paper for t in found if t.step == "OCTANE"] == [0.48, 2.1]
    assert [(t.field, t.goal) for t in found if t.step == "GEFORCE_256"] == [
        ("triangles", 0.02),
        ("bricks", None),
    ]


def test_the_paper_s_own_table_says_what_is_made_of_it():
    for name, (seen, ellipses, software, hardware) in scattering.PAPER.items():
        assert software / hardware > 5.0, name
        assert name != "bricks" or seen > 5.0 * ellipses
    small, large = scattering.PAPER["triangles"][3], scattering.PAPER["bricks"][3]
    slope = (large - small) / (128**2 - 32**2)
    assert slope == pytest.approx(1.055e-4, rel=1e-3)
    assert small - slope * 32**2 == pytest.approx(0.372, abs=1e-3)


def test_growth_has_every_number_and_is_drawn(monkeypatch, tmp_path):
    monkeypatch.setattr(scattering, "seconds_of", lambda step, turns=0: (step(), 0.5)[1])
    monkeypatch.setattr(scattering, "GROWTH", {"texels": (4, 8), "directions": (12,), "lookups": (1, 2)})
    monkeypatch.setattr(scattering, "DIRECTIONS", 12)
    found = list(scattering.growth())
    assert {(what, number) for what, number, _, _ in found} == {
        ("texels", 4), ("texels", 8), ("directions", 12), ("lookups", 1), ("lookups", 2),
    }  # fmt: skip
    scattering.plot(found, tmp_path / "growth.png")
    assert (tmp_path / "growth.png").read_bytes()[:4] == b"\x89PNG"


@pytest.fixture(scope="module", params=[llvmpipe.Llvmpipe, swiftshader.SwiftShader])
def peer(request):
    try:
        party = request.param(1)
    except PeerError as problem:
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
        # Where depth varies, the peer rounds two slopes, two products and two sums, half a unit each.
        assert found.depth <= (3 if scene.meshes else 0)
    # Of the silhouette's some 2000 pixels, those whose centre the snapping moves over an edge of 1/16 pixel.
    assert found.coverage <= 2000 / 16


@pytest.mark.parametrize("threads", [1, 3])
def test_swiftshader_draws_on_as_many_threads_as_asked_for(threads):
    try:
        party = swiftshader.SwiftShader(threads)
    except PeerError as problem:
        pytest.skip(str(problem))
    with party:
        party.prepare(SCENES["a"], 64)
        party.turn(1)
        tasks = Path(f"/proc/{party._process.pid}/task")
        names = [name.read_text() for name in tasks.glob("*/comm")]
    # It names those that draw so.
    assert sum(name.startswith("Thread<") for name in names) == threads


# ----------------------------------------------------------------------------------------- prefilter


def test_filters_are_timed_and_printed(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(prefilter, "MAPS", ((8, 1.0, None), (8, 100.0, 2.0)))
    file = tmp_path / "rates.json"
    assert command_line.main(["prefilter", "--threads", "1", "--json", str(file)]) == 0
    assert [line.split()[:2] for line in capsys.readouterr().out.splitlines()[-2:]] == [
        ["8", "1"],
        ["8", "100"],
    ]
    found = json.loads(file.read_text())["prefilter"]
    assert [(time["size"], time["exponent"], time["goal"]) for time in found] == [
        (8, 1.0, None),
        (8, 100.0, 2.0),
    ]
    assert all(time["seconds"] > 0.0 for time in found)
