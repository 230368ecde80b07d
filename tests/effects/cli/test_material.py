"""``fixedpipe material``: any reflectance on a mesh, under lights or in an environment, or one sentence."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.environment_maps import environments
from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND
from fixedpipe.effects.reflectance.brdfs import BRDFS
from fixedpipe.effects.scattering import merl
from fixedpipe.effects.user_pictures import factored_brdf, shown_material
from fixedpipe.effects.user_pictures.drawing import drawn
from fixedpipe.effects.user_pictures.factored_brdf import Factorisation
from fixedpipe.pipeline.profiles import PROFILES
from tests.effects.cli.test_cli import refusal_of, run

SIZE = 96


def quickly(brdf, way=Factorisation.HALFWAY, terms=2):
    """Factors with maps of half the size."""
    return factored_brdf.factored(brdf, way, size=16, terms=terms)


@pytest.fixture(scope="module")
def ward():
    return shown_material.reflectance("ward", {"alpha_x": "0.4", "alpha_y": "0.6"})


@pytest.fixture(scope="module")
def found(ward):
    return quickly(ward, terms=3)


def rays(size):
    """World directions through all pixels, top row first, of the command's camera."""
    forward = normalize(-np.array(shown_material.EYE))
    right = normalize(cross(forward, np.array([0.0, 1.0, 0.0])))
    up, reach = cross(right, forward), math.tan(math.radians(shown_material.FIELD_OF_VIEW) / 2)
    place = reach * (2.0 * (np.arange(size) + 0.5) / size - 1.0)
    x, y = np.meshgrid(place, place[::-1])
    return normalize(forward + x[..., None] * right + y[..., None] * up)


def sphere_by_rays(brdf, lighting, size):
    """What a ball of radius one sends back at every pixel, [k, 3], and the pixels, bool [size, size]."""
    toward, eye = rays(size), np.array(shown_material.EYE)
    b = dot(toward, np.broadcast_to(eye, toward.shape))
    under = b * b - (eye @ eye - 1.0)
    # Thirty degrees from the outline, nearer to which factors' maps are cut off (``LOWEST_OF_HIGHLIGHTS``).
    hit = under > 0.25
    normals = eye + (-b - np.sqrt(np.maximum(under, 0.0)))[..., None] * toward
    normals, views = normalize(normals[hit]), -toward[hit]
    # The frame of latitude and longitude, tangents to the east.
    tangents = normalize(cross(np.broadcast_to([0.0, 1.0, 0.0], normals.shape), normals))
    frame = tangents, cross(normals, tangents), normals

    def local(vectors):
        return np.stack([dot(vectors, axis) for axis in frame], axis=-1)

    out = np.zeros(normals.shape)
    for light, color in zip(lighting.directions, lighting.colors, strict=True):
        towards, seen = local(np.broadcast_to(light, normals.shape)), local(views)
        lit = towards[:, 2] > 1e-3
        out[lit] += math.pi * brdf.at(towards[lit], seen[lit]) * towards[lit, 2:] * color
    return np.clip(out, 0.0, 1.0), hit


def relative(found, true):
    return float(np.sqrt(((found - true) ** 2).mean() / (true**2).mean()))


@pytest.mark.parametrize(
    "lighting",
    (
        shown_material.directional([(-1.0, 1.0, 1.0)]),
        shown_material.directional([(-1.0, 1.0, 1.0), (1.0, 0.2, 0.7), (0.0, -1.0, 0.5)], 0.5),
        shown_material.environment("room", 8),
    ),
    ids=("a light", "three lights", "a room"),
)
def test_the_ideal_is_the_model_at_every_pixel_of_a_ball(ward, found, lighting):
    sphere = shown_material.mesh("sphere")
    ideal = PROFILES["IDEAL"]
    frame = shown_material.commands(found, sphere, lighting, ideal, SIZE, SIZE)
    picture = drawn(frame, ideal, SIZE, SIZE).color[..., :3]
    true, hit = sphere_by_rays(ward, lighting, SIZE)
    assert hit.mean() > 0.4
    by_factors, _ = sphere_by_rays(found.factors, lighting, SIZE)
    # The products are those of the factors at every pixel, but for vectors between vertices ...
    assert relative(picture[hit], by_factors) < 0.04
    # ... and so about as far from the model as factors are; lights may meet them where they are worse.
    assert relative(picture[hit], true) < 1.25 * found.error


@pytest.mark.parametrize("name", ("ward", "phong"))
def test_ideal_draws_the_reflectance_itself(name):
    """Phong's factors are far from it: 0.83 of the reflectance."""
    brdf = shown_material.reflectance(name, {"phong": {"exponent": "20"}}.get(name))
    lighting = shown_material.directional([(-1.0, 1.0, 1.0), (1.0, 0.2, 0.7)], 0.5)
    sphere = shown_material.mesh("sphere")
    picture = shown_material.meant(brdf, sphere, lighting, SIZE, SIZE)
    true, hit = sphere_by_rays(brdf, lighting, SIZE)
    # The ball is of 9,216 triangles, so a normal between vertices is up to 0.001 off, and a highlight of
    # exponent 20 up to twenty times as much.
    assert relative(picture.color[..., :3][hit], true) < 0.02
    assert (picture.image == np.rint(255 * picture.color)).all()
    found = quickly(brdf)
    frame = shown_material.commands(found, sphere, lighting, PROFILES["IDEAL"], SIZE, SIZE)
    by_factors = drawn(frame, PROFILES["IDEAL"], SIZE, SIZE).color[..., :3]
    assert (relative(by_factors[hit], true) > 0.5) == (name == "phong")


def test_ideal_draws_the_environment_and_the_colour_as_machines_do(ward, found):
    lighting, color = shown_material.environment("room", 5), (1.0, 0.8, 0.4)
    ideal, torus = PROFILES["IDEAL"], shown_material.mesh("torus")
    frame = shown_material.commands(found, torus, lighting, ideal, SIZE, SIZE, color=color)
    by_factors = np.clip(drawn(frame, ideal, SIZE, SIZE).color[..., :3], 0.0, 1.0)
    picture = shown_material.meant(ward, torus, lighting, SIZE, SIZE, color=color).color[..., :3]
    # As far apart as the factors are from the reflectance.
    assert np.abs(picture - by_factors).mean() < found.error * by_factors.mean()
    np.testing.assert_array_equal(picture[:8], by_factors[:8])  # nothing but the room


def test_factors_of_another_material_are_told(tmp_path):
    def said(*arguments):
        return run("material", *arguments, "--size", 16, "--out", tmp_path / "a.png").stderr

    assert "shows another material. --profile IDEAL draws the reflectance itself" in said(
        "phong", "--set", "exponent=20"
    )
    assert "another material" not in said("blinn_phong", "--set", "exponent=20")
    assert "another material" not in said("phong", "--set", "exponent=20", "--profile", "IDEAL")
    refused = refusal_of("material", "phong", "--profile", "IDEAL", "--terms", 3, "--out", tmp_path / "a.png")
    assert "without factors" in refused


@pytest.mark.parametrize("key", PROFILES)
@pytest.mark.parametrize("way", (Factorisation.HALFWAY, Factorisation.HOMOMORPHIC))
def test_every_machine_draws_about_what_the_ideal_does(key, way, ward):
    found = quickly(ward, way)
    lighting = shown_material.directional([(-1.0, 1.0, 1.0), (1.0, 0.2, 0.7)], 0.6)
    profile = PROFILES[key]
    shown_material.check_machine(profile)
    pictures = []
    for each in (profile, PROFILES["IDEAL"]):
        frame = shown_material.commands(
            found, shown_material.mesh("sphere"), lighting, each, SIZE, SIZE, color=(1.0, 0.8, 0.4)
        )
        pictures.append(drawn(frame, each, SIZE, SIZE).color[..., :3])
    away = np.abs(pictures[0] - np.clip(pictures[1], 0.0, 1.0))
    assert away.mean() < 0.01, away.mean()
    assert np.abs(pictures[0][0, 0] - BACKGROUND).max() < 0.01


def test_the_environment_stands_behind(found):
    profile, lighting = PROFILES["GEFORCE_256"], shown_material.environment("room", 3)
    frame = shown_material.commands(found, shown_material.mesh("torus"), lighting, profile, SIZE, SIZE)
    picture = drawn(frame, profile, SIZE, SIZE).color[..., :3]
    room = environments.room(rays(SIZE))
    corner = np.abs(picture - room)[:12, :12]
    assert np.median(corner) < 0.01
    assert lighting.behind(np.array([0.0, 1.0, 0.0])).max() <= 1.0


def test_lights_that_face_away_add_nothing_and_two_halves_are_one(found):
    profile = PROFILES["IDEAL"]
    one, two = (
        shown_material.directional([(0.0, 0.0, 1.0)] * count, exposure)
        for count, exposure in ((1, 0.5), (2, 0.25))
    )
    pictures = [
        drawn(
            shown_material.commands(found, shown_material.mesh("plane"), each, profile, 48, 48),
            profile,
            48,
            48,
        ).color
        for each in (one, two)
    ]
    assert np.abs(pictures[0] - pictures[1]).max() < 1e-6
    dark = shown_material.directional([(0.0, 0.0, -1.0)])
    frame = shown_material.commands(found, shown_material.mesh("plane"), dark, profile, 48, 48)
    assert np.abs(drawn(frame, profile, 48, 48).color[24, 24, :3]).max() < 1e-9


def test_any_number_of_threads_gives_the_same_bytes(tmp_path):
    command = ("material", "ward", "--terms", 1, "--mesh", "teapot", "--environment", "room", "--lights", 3)
    pictures = []
    for threads in (1, 2):
        out = tmp_path / f"{threads}.png"
        result = run(*command, "--size", 64, "--threads", threads, "--out", out)
        assert result.exit_code == 0, result.output
        pictures.append(out.read_bytes())
    assert pictures[0] == pictures[1]


def test_it_says_how_it_was_drawn_and_how_well(tmp_path):
    out = tmp_path / "a.png"
    result = run("material", "lambert", "--light", "0,0,1", "--light", "1,0,1", "--size", 48, "--out", out)
    assert result.exit_code == 0, result.output
    assert "lambert: " in result.stdout and "RMS error of the factors" in result.stdout
    assert "2 lights, exposure 1; register combiners, cube maps; 7 passes" in result.stdout
    assert np.asarray(Image.open(out)).shape[:2] == (48, 48)
    error = float(result.stdout.partition("factors ")[2].split()[0])
    assert error < 1e-3


def test_a_way_is_taken_and_too_large_an_error_is_refused(tmp_path, monkeypatch):
    taken, out = [], tmp_path / "a.png"

    def factored(brdf, way=None, terms=2):
        taken.append((way, terms))
        return factored_brdf.Factored(SimpleNamespace(terms=terms), way, 0.5)

    monkeypatch.setattr(factored_brdf, "factored", factored)
    asked = ("material", "phong", "--set", "exponent=20", "--way", "halfway", "--terms", 1, "--out", out)
    sentence = refusal_of(*asked, "--error-at-most", 0.1)
    assert taken == [(Factorisation.HALFWAY, 1)]
    assert ": more than 0.1. Give more --terms, another" in sentence and not out.exists()


def test_files_are_drawn(tmp_path):
    class Matt:
        def at(self, lights, views):
            return np.full(np.shape(lights), 0.5 / math.pi) * (1.0, 0.5, 0.25)

    table, grid, mesh = (tmp_path / name for name in ("matt.binary", "matt.npz", "square.obj"))
    table.write_bytes(merl.data(merl.table(Matt())))
    np.savez(grid, samples=np.broadcast_to(Matt().at(np.zeros((1, 3)), None)[0], (4, 4, 4, 4, 3)))
    mesh.write_text("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n")
    for file in (table, grid):
        out = tmp_path / "a.png"
        result = run(
            "material", file, "--terms", 1, "--mesh", mesh, "--light", "0,0,1", "--size", 32, "--out", out
        )
        assert result.exit_code == 0, result.output
        assert np.abs(np.asarray(Image.open(out))[16, 16, :3] - (127.5, 63.75, 31.9)).max() <= 3


def test_a_panorama_lights_and_stands_behind(tmp_path):
    sky, out = tmp_path / "sky.npy", tmp_path / "a.png"
    values = np.zeros((128, 256, 3))
    values[:64] = 4.0
    np.save(sky, values)
    result = run(
        "material",
        "lambert",
        "--terms",
        1,
        "--environment",
        sky,
        "--exposure",
        0.2,
        "--size",
        48,
        "--out",
        out,
    )
    assert result.exit_code == 0, result.output
    picture = np.asarray(Image.open(out)).astype(int)
    # The camera looks down a little, so that the horizon is in the upper part; light comes from above.
    assert abs(int(picture[1, 2, 0]) - 204) <= 2 and picture[46, 2, 0] == 0
    assert picture[12, 24, 0] > picture[36, 24, 0] + 40


def test_the_list_has_every_model_and_parameter():
    result = run("material", "--list")
    assert result.exit_code == 0
    for name, row in BRDFS.items():
        assert f"{name}: {row.title}" in result.stdout
    assert "alpha_x=0.2, from 0.05 to 1" in result.stdout
    assert "coefficients=-0.9,-0.6,0.95" in result.stdout
    assert "--list prints a list" in refusal_of("material", "--list", "--size", 3)


@pytest.mark.parametrize(
    ("arguments", "says"),
    (
        ((), "No reflectance is given"),
        (("wrad",), "Did you mean ward?"),
        (("none.binary",), "There is no file 'none.binary'"),
        (("ward", "--set", "alpha_x"), "give NAME=VALUE"),
        (("ward", "--set", "alpha_x=1", "--set", "alpha_x=1"), "twice"),
        (("ward", "--set", "alpha=1"), "Ward has no parameter 'alpha'"),
        (("lambert", "--set", "alpha=1"), "It has none."),
        (("ward", "--set", "alpha_x=0"), "from 0.05 to 1"),
        (("ward", "--set", "alpha_x=nan"), "from 0.05 to 1"),
        (("ward", "--set", "alpha_x=1,1"), "give a number"),
        (("lafortune", "--set", "coefficients=1"), "give 3 numbers"),
        (("ward", "--way", "halfwy"), "Did you mean halfway?"),
        (("ward", "--way", "homomorphic", "--terms", 2), "A homomorphic product has no terms"),
        (("ward", "--way", "halfway", "--profile", "IDEAL"), "--way would be ignored"),
        (("ward", "--mesh", "cone"), "There is no mesh 'cone'"),
        (("ward", "--mesh", "none.obj"), "none.obj cannot be read"),
        (("ward", "--color", "1,2,1"), "from 0 to 1"),
        (("ward", "--color", "0,0,0"), "not all zero"),
        (("ward", "--color", "red"), "three numbers"),
        (("ward", "--light", "0,0,0"), "not all zero"),
        (("ward", "--light", "nan,0,0"), "three numbers"),
        (("ward", "--lights", 3), "--lights would be ignored"),
        (("ward", "--environment", "room", "--light", "1,1,1"), "--light would be ignored"),
        (("ward", "--environment", "none.hdr"), "There is no file 'none.hdr'"),
        (("ward", "--exposure", 0), "give a positive number"),
        (("ward", "--exposure", "nan"), "give a positive number"),
        (("ward", "--exposure", "inf"), "give a positive number"),
        (("ward", "--profile", "VOODOO"), "There is no profile"),
        (("ward", "--size", 100000), "100000"),
    ),
)
def test_what_cannot_be_drawn_is_a_sentence_and_no_file(arguments, says, tmp_path):
    out = tmp_path / "a.png"
    assert says in refusal_of("material", *arguments, "--out", out)
    assert not out.exists()


def test_damaged_files_are_sentences(tmp_path):
    out, bad = tmp_path / "a.png", tmp_path / "bad.binary"
    for contents in (b"", b"\x00" * 100, b"PK\x03\x04"):
        bad.write_bytes(contents)
        assert "Give a MERL table" in refusal_of("material", bad, "--out", out)
    assert "leave --set out" in refusal_of("material", bad, "--set", "a=1", "--out", out)
    black = tmp_path / "black.npy"
    np.save(black, np.zeros((4, 8, 3)))
    assert "black" in refusal_of("material", "ward", "--environment", black, "--out", out)
    assert "--out" in refusal_of("material", "ward")
    assert not out.exists()


def test_a_machine_that_cannot_is_told_which_can():
    small = PROFILES["OPENGL_1_2"]
    small = small.changed(name="Small board", max_texture_size=2)
    with pytest.raises(ValueError, match=r"The Small board cannot draw.*OPENGL_1_2.*GEFORCE_256"):
        shown_material.check_machine(small)
    lighting = shown_material.directional([(0.0, 0.0, 1.0)] * 2)
    with pytest.raises(ValueError, match="at most 2x2; give a smaller --size"):
        shown_material.check_picture(lighting, small, 16, 16)
    with pytest.raises(ValueError, match="give 1 to 64"):
        shown_material.environment("room", 65)
    red = replace(lighting, colors=np.array([[1.0, 0.0, 0.0]] * 2))
    with pytest.raises(ValueError, match="nothing of the colour"):
        shown_material.check_picture(red, PROFILES["IDEAL"], 16, 16, (0.0, 1.0, 0.0))
