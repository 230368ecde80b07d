"""``fixedpipe shadows``: meshes good and bad, what each machine can draw, and that the picture is right."""

import builtins
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.acceptance.agreement import truth_of
from fixedpipe.effects.geometry import surfaces, triangle_meshes
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.user_pictures import inputs, mesh_shadows
from tests.effects.cli.test_cli import refusal_of, run

pytest.importorskip("plyfile")


def write_obj(path, surface):
    lines = ["v {!r} {!r} {!r}".format(*v) for v in surface.positions.tolist()]
    lines += ["f {} {} {}".format(*t) for t in (surface.triangles + 1).tolist()]
    path.write_text("\n".join(lines) + "\n")
    return path


def write_ply(path, vertices, faces):
    header = f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\n"
    header += "property float x\nproperty float y\nproperty float z\n"
    header += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [" ".join(map(str, v)) for v in vertices] + [" ".join(map(str, (len(f), *f))) for f in faces]
    path.write_text(header + "\n".join(rows) + "\n")
    return path


@pytest.fixture
def ring(tmp_path):
    return write_obj(tmp_path / "ring.obj", surfaces.torus(24, 12))


@pytest.fixture
def open_sphere(tmp_path):
    ball = surfaces.sphere(16, 8)
    return write_obj(tmp_path / "open.obj", replace(ball, triangles=ball.triangles[5:]))


def shadows(mesh, out, *more):
    return ("shadows", mesh, "--out", out, "--size", 64, *more)


def agreement_of(text):
    """The fraction that agrees and the pixels that nothing explains."""
    line = text.splitlines()[-1]
    return float(line.split()[3]) / 100.0, int(line.split()[-2])


@pytest.mark.parametrize(
    ("algorithm", "machine", "least"),
    [
        ("depth-map", "GEFORCE_3", 0.97),
        ("alpha-multitexture", "GEFORCE_256", 0.97),
        ("alpha-multitexture", "MULTITEXTURE", 0.97),
        ("alpha-single", "OPENGL_1_2", 0.97),
        ("z-pass", "OPENGL_1_2", 0.99),
        ("z-fail", "G400", 0.99),
    ],
)
def test_every_algorithm_throws_the_shadow_that_rays_throw(ring, tmp_path, algorithm, machine, least):
    out = tmp_path / "out.png"
    result = run(
        *shadows(ring, out, "--algorithm", algorithm, "--profile", machine, "--up", "z", "--size", 128)
    )
    assert result.exit_code == 0, result.output
    agreeing, other = agreement_of(result.stdout)
    assert agreeing >= least
    assert other <= 3
    picture = np.asarray(Image.open(out))
    assert picture.shape == (128, 128, 3)
    # The floor, lit and in shadow, the ring and the background: no flat picture.
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 50


def test_the_map_s_size_can_be_chosen(ring, tmp_path):
    common = shadows(ring, tmp_path / "out.png", "--algorithm", "depth-map", "--profile", "NV2A")
    coarse, fine = (agreement_of(run(*common, "--map-size", n).stdout)[0] for n in (16, 256))
    assert coarse < fine - 0.01


def test_a_ply_file_gives_the_picture_of_the_same_obj_file(tmp_path):
    surface = surfaces.torus(16, 8)
    ply = write_ply(tmp_path / "ring.ply", surface.positions.tolist(), surface.triangles.tolist())
    obj = write_obj(tmp_path / "ring.obj", surface)
    for mesh in (ply, obj):
        assert run(*shadows(mesh, tmp_path / f"{mesh.suffix[1:]}.png")).exit_code == 0
    # PLY files hold floats of 32 bits here and there: nearly the same.
    a, b = (np.asarray(Image.open(tmp_path / f"{k}.png")).astype(int) for k in ("ply", "obj"))
    assert (np.abs(a - b) > 2).mean() < 0.01


def test_what_a_machine_lacks_is_said_with_the_machines_that_have_it(ring, tmp_path):
    sentence = refusal_of(*shadows(ring, tmp_path / "o.png", "--algorithm", "depth-map"))
    assert "GEFORCE_256 cannot draw depth-map, which takes depth textures" in sentence
    assert "GEFORCE_3, NV2A, INFINITE_REALITY" in sentence
    one_unit = ("--algorithm", "alpha-multitexture", "--profile", "OPENGL_1_2")
    assert "two texture units" in refusal_of(*shadows(ring, tmp_path / "o.png", *one_unit))
    assert not (tmp_path / "o.png").exists()


@pytest.mark.parametrize("algorithm", ["z-pass", "z-fail"])
def test_an_open_mesh_has_no_shadow_volume_but_may_have_a_map(open_sphere, tmp_path, algorithm):
    sentence = refusal_of(*shadows(open_sphere, tmp_path / "out.png", "--algorithm", algorithm))
    assert "open.obj is not closed" in sentence
    assert "depth-map, alpha-multitexture, alpha-single" in sentence
    mapped = shadows(open_sphere, tmp_path / "out.png", "--algorithm", "alpha-multitexture")
    assert run(*mapped).exit_code == 0


def test_a_viewer_in_shadow_is_told_of_z_pass(tmp_path):
    board = write_obj(tmp_path / "board.obj", surfaces.box(4.0, 4.0, 0.4))
    behind = shadows(board, tmp_path / "out.png", "--light", "0,1.5,-3", "--algorithm")
    wrong, right = run(*behind, "z-pass"), run(*behind, "z-fail")
    assert "give --algorithm z-fail" in wrong.stderr and agreement_of(wrong.stdout)[0] < 0.5
    assert not right.stderr and agreement_of(right.stdout)[0] > 0.99


SQUARE = [[0, 0, 0], [1, 0, 0], [0, 0, 1]]


@pytest.mark.parametrize(
    ("vertices", "faces", "words"),
    [
        (SQUARE, [], "no faces"),
        ([[0, 0, 0], [1, 0, 0], ["nan", 0, 1]], [[0, 1, 2]], "no finite number"),
        ([[0, 0, 0], [1, 0, 0], [0, 0, "1e33"]], [[0, 1, 2]], "no finite number of at most 1e+30"),
        (SQUARE, [[0, 1, 7]], "7"),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]], "mesh.ply has no triangle with an area"),
        (SQUARE, [[0, 1, 2]], "0 high along y and 1 long, and would lie in the floor"),
    ],
)
def test_a_ply_file_that_cannot_be_used_is_refused(tmp_path, vertices, faces, words):
    mesh = write_ply(tmp_path / "mesh.ply", vertices, faces)
    more = ("--algorithm", "alpha-single")
    assert words in refusal_of(*shadows(mesh, tmp_path / "out.png", *more))
    assert not (tmp_path / "out.png").exists()


@pytest.mark.parametrize(
    "data", [b"", b"ply\nformat", b"\x00\x01\x02" * 50, b"ply\nformat ascii 1.0\nend_header\n"]
)
def test_bytes_that_are_no_ply_file_are_refused(tmp_path, data):
    (tmp_path / "mesh.ply").write_bytes(data)
    assert "mesh.ply" in refusal_of(*shadows(tmp_path / "mesh.ply", tmp_path / "out.png"))


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (("--light", "1,2"), "give three numbers"),
        (("--light", "1,inf,2"), "give three numbers"),
        (("--light", "1,-2,3"), "not above the floor"),
        (("--light", "0.1,0.3,0"), "not in front of the whole scene"),
        (("--algorithm", "ray-tracing"), "depth-map"),
        (("--profile", "VOODOO"), "GEFORCE_256"),
        (("--up", "w"), "'x', 'y', 'z'"),
        (("--map-size", "100", "--algorithm", "alpha-single"), "power of two"),
        (("--map-size", "65536", "--algorithm", "alpha-single"), "largest"),
        (("--map-size", "64"), "z-fail has no map"),
        (("--light", "1e5,1e5,0"), "farther than 3000"),
    ],
)
def test_an_option_that_cannot_be_used_is_refused(ring, tmp_path, more, words):
    assert words in refusal_of(*shadows(ring, tmp_path / "out.png", *more))
    assert not (tmp_path / "out.png").exists()


def test_what_is_no_mesh_is_refused(ring, tmp_path, monkeypatch):
    (tmp_path / "folder.ply").mkdir()
    for name, words in (
        ("missing.obj", "cannot be read"),
        ("mesh.stl", "give an OBJ or a PLY file"),
        ("folder.ply", "is no file"),
    ):
        assert words in refusal_of(*shadows(tmp_path / name, tmp_path / "out.png"))
    assert "out.png" in refusal_of(*shadows(ring, tmp_path / "new" / "out.jpg"))
    assert not (tmp_path / "new").exists()
    monkeypatch.setattr(inputs, "_LARGEST_MESH", 100)
    assert "Make it coarser" in refusal_of(*shadows(ring, tmp_path / "out.png"))
    monkeypatch.setattr(inputs, "_LARGEST_MESH", 1 << 20)
    monkeypatch.setattr(inputs, "_MOST_TRIANGLES", 10)
    assert "up to 10 are drawn" in refusal_of(*shadows(ring, tmp_path / "out.png"))


def test_without_plyfile_a_ply_file_is_refused_with_what_to_install(tmp_path, monkeypatch):
    mesh = write_ply(tmp_path / "mesh.ply", SQUARE, [[0, 1, 2]])
    real = builtins.__import__

    def without(name, *rest):
        if name == "plyfile":
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(Refusal, match=r"fixedpipe\[meshes\]"):
        inputs.read_mesh(str(mesh))


@pytest.mark.parametrize("up", mesh_shadows.AXES)
def test_a_mesh_stands_in_the_middle_of_the_floor_its_axis_up(up):
    surface = surfaces.box(1.0, 2.0, 3.0).moved(5.0, -7.0, 1.0)
    extent = dict(zip(mesh_shadows.AXES, (1.0, 2.0, 3.0), strict=True))[up]
    placed = mesh_shadows.stood_on_floor(surface, up)
    low, high = placed.positions.min(axis=0), placed.positions.max(axis=0)
    np.testing.assert_allclose(low[1], 0.0, atol=1e-12)
    np.testing.assert_allclose(high[1], extent * 2.4 / 3.0)
    np.testing.assert_allclose((low + high)[[0, 2]], 0.0, atol=1e-12)
    corners = placed.positions[placed.triangles]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (dot(outward, placed.normals[placed.triangles[:, 0]]) > 0.0).all()


@pytest.mark.parametrize("light", [(-3.5, 6.5, 3.5), (3.0, 4.0, -2.0), (0.0, 5.0, 0.1), (900.0, 900.0, 10.0)])
@pytest.mark.parametrize("toward", [mesh_shadows.TOWARD, (3.0, 2.0, -3.0), (-1.0, 9.0, 0.0)])
def test_the_shadow_is_on_the_floor_and_in_the_picture(light, toward):
    """By its vertices' shadows, and by what is seen in the lower corners."""
    surface = mesh_shadows.stood_on_floor(surfaces.torus(24, 12), "z")
    stage = mesh_shadows.stage(surface, light, toward=toward)
    assert stage.whole
    lamp, p = np.array(light), surface.positions
    shadow = lamp + (p - lamp) * (lamp[1] / (lamp[1] - p[:, 1]))[:, None]
    ground = stage.scene.objects[0].surface.positions
    assert (shadow.min(axis=0) >= ground.min(axis=0) - 1e-9).all()
    assert (shadow.max(axis=0) <= ground.max(axis=0) + 1e-9).all()
    view = stage.view(64)
    matrix = np.array(view.projection) @ np.array(view.modelview)

    def clip(points):
        return np.column_stack([points, np.ones(len(points))]) @ matrix.T

    for points in (shadow, p):
        x, y, z, w = clip(points).T
        assert (w > 0.0).all() and (np.abs([x, y, z]) <= w).all()
    z, w = clip(ground)[:, 2:].T
    assert (np.abs(z) <= w).all()  # neither plane clips the floor
    truth = truth_of(stage.scene, view, stage.lamp)
    assert (truth.shown.object[0, [0, -1]] == 0).all()


def test_a_lamp_below_the_top_has_a_shadow_that_no_floor_ends(ring, tmp_path):
    low = run(*shadows(ring, tmp_path / "out.png", "--up", "z", "--light", "0,1,-4"))
    assert "a higher lamp, --light, keeps it there" in low.stdout
    assert "a higher lamp" not in run(*shadows(ring, tmp_path / "out.png")).stdout


def test_the_view_turns_the_camera(ring, tmp_path):
    pictures = []
    for view in ("0.6,3.48,7.6", "-5,3,-5"):
        out = tmp_path / "out.png"
        result = run(*shadows(ring, out, "--view", view, "--up", "z"))
        assert agreement_of(result.stdout)[0] > 0.98
        pictures.append(out.read_bytes())
    assert pictures[0] != pictures[1]
    for view in ("0,1,0", "1,-1,0", "1,0,0"):
        sentence = refusal_of(*shadows(ring, tmp_path / "out.png", "--view", view))
        assert "direction to the eye is straight up, or not above the floor" in sentence


def test_a_mesh_wound_inside_out_is_turned():
    surface = surfaces.sphere(12, 6)
    inside_out = replace(surface, triangles=surface.triangles[:, ::-1], normals=-surface.normals)
    a, b = (mesh_shadows.stood_on_floor(s) for s in (surface, inside_out))
    assert (a.positions == b.positions).all() and (a.normals == b.normals).all()
    assert (a.triangles == b.triangles).all()


def test_both_sides_of_a_sheet_are_lit(tmp_path):
    """A board wound either way, lit on the side that is seen; and dark where the lamp is behind it."""
    board = [[0, 0, 0], [1, 0, 0], [1, 1, 0.2], [0, 1, 0.2]]
    means = []
    for faces, light in (
        ([[0, 1, 2, 3]], "0,6,6"),
        ([[3, 2, 1, 0]], "0,6,6"),
        ([[0, 1, 2, 3]], "0,6,-6"),
    ):
        mesh = write_ply(tmp_path / "board.ply", board, faces)
        more = ("--algorithm", "alpha-multitexture", "--light", light)
        assert run(*shadows(mesh, tmp_path / "out.png", *more)).exit_code == 0
        picture = np.asarray(Image.open(tmp_path / "out.png")).astype(int)
        orange = (
            picture[..., 0] > 1.5 * picture[..., 2]
        )  # the board's colour, in its light and in the ambient
        assert orange.sum() > 50
        means.append(picture[orange].mean())
    assert abs(means[0] - means[1]) < 1.0
    assert means[2] < 0.5 * means[0]


def test_sharp_edges_stay_sharp_and_smooth_ones_smooth():
    whole = surfaces.box()
    box = triangle_meshes.with_creases(triangle_meshes.from_triangles(whole.positions[whole.triangles]))
    assert {tuple(np.abs(n).round(12)) for n in box.normals.tolist()} == {(1, 0, 0), (0, 1, 0), (0, 0, 1)}
    ball = triangle_meshes.with_creases(surfaces.sphere(24, 12))
    assert (dot(ball.normals, ball.positions) > 0.99).all()
