"""A user's BRDF, an object, a MERL table or a dense grid, on a mesh by factors; and what is refused."""

import io

import numpy as np
import pytest

from fixedpipe.effects.geometry.surfaces import sphere
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, row_of_panels
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.scattering import merl
from fixedpipe.effects.scattering.dense_brdf import DenseBRDF
from fixedpipe.effects.user_pictures import factored_brdf
from fixedpipe.effects.user_pictures.factored_brdf import Factorisation
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import PROFILES


class Shiny:
    """A matt colour below an isotropic highlight."""

    def at(self, lights, views):
        half = normalize(np.asarray(lights) + views)
        lobe = half[:, 2:] ** 16
        return np.array([0.3, 0.2, 0.1]) / np.pi + 0.2 * lobe * np.array([1.0, 0.9, 0.8])


def hemisphere(count, seed):
    found = normalize(np.random.default_rng(seed).normal(size=(6 * count, 3)))
    return found[found[:, 2] > 0.25][:count]


LIGHTS, VIEWS = hemisphere(800, 3), hemisphere(800, 4)


@pytest.fixture(scope="module")
def table():
    return merl.table(Shiny())


@pytest.fixture(scope="module")
def file(table, tmp_path_factory):
    path = tmp_path_factory.mktemp("merl") / "shiny.binary"
    path.write_bytes(merl.data(table))
    return path


def relative(found, true):
    return np.sqrt(((found - true) ** 2).mean() / (true**2).mean())


def test_a_measured_table_is_linear_between_its_cells(table):
    true = Shiny().at(LIGHTS, VIEWS)
    between = relative(merl.MeasuredBRDF(table).at(LIGHTS, VIEWS), true)
    nearest = relative(merl.looked_up(table, LIGHTS, VIEWS), true)
    assert 5.0 * between < nearest
    assert between < 0.001


def test_numbers_that_are_not_known_take_no_part(table):
    holes = table.copy()
    holes[:, ::2, ::3, ::2] = merl.BELOW
    assert relative(merl.MeasuredBRDF(holes).at(LIGHTS, VIEWS), Shiny().at(LIGHTS, VIEWS)) < 0.02
    nothing = merl.MeasuredBRDF(np.full_like(table, merl.BELOW))
    assert not nothing.at(LIGHTS, VIEWS).any()


@pytest.mark.parametrize("bad", (np.nan, np.inf))
def test_a_measured_table_is_finite(table, bad):
    spoilt = table.copy()
    spoilt[1, 2, 3, 4] = bad
    with pytest.raises(ValueError, match="NaN or infinity"):
        merl.MeasuredBRDF(spoilt)
    with pytest.raises(ValueError, match="shape"):
        merl.MeasuredBRDF(table[:, :2])


def test_the_way_with_the_smallest_error_is_taken(file):
    found = factored_brdf.factored(str(file), size=16)
    errors = {way: factored_brdf.factored(file, way, size=16).error for way in Factorisation}
    assert found.way is min(errors, key=errors.get)
    assert found.error == errors[found.way] < 0.1
    assert relative(found.factors.at(LIGHTS, VIEWS), Shiny().at(LIGHTS, VIEWS)) < 0.15


def test_ways_have_names(file):
    assert factored_brdf.factored(Shiny(), "homomorphic", size=8).way is Factorisation.HOMOMORPHIC
    assert factored_brdf.factored(Shiny(), "halfway", size=8, terms=1).way is Factorisation.HALFWAY
    with pytest.raises(ValueError, match="no way 'best'"):
        factored_brdf.factored(Shiny(), "best", size=8)


@pytest.mark.parametrize("machine", ("GEFORCE_256", "MULTITEXTURE", "OPENGL_1_2"))
def test_a_file_is_drawn_on_a_mesh(machine, file):
    (panel,) = row_of_panels(1, 48)
    view, light = orthographic_view(panel, 1.2), Light((0.0, 0.4, 1.0))
    profile = PROFILES[machine]
    frame = (
        panel.clear(BACKGROUND),
        *factored_brdf.commands(file, sphere(24, 13), view, light, profile, way=Factorisation.HALFWAY),
    )
    image = execute(frame, profile, 48, 48).framebuffer.color[::-1, :, :3] / 255.0
    # In the middle of the highlight, above the ball's own middle, and far below it.
    y = int(24 + 20 * normalize(np.array([0.0, 0.4, 2.0]))[1])
    bright, dull = image[y, 24], image[10, 24]
    up = np.array([[0.0, 0.0, 1.0]])
    assert np.abs(bright - 0.98 * np.pi * Shiny().at(up, up)[0]).max() < 0.08
    assert dull.max() < 0.5 * bright.max()
    assert dull[0] > 1.5 * dull[2]


def npz(**arrays):
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


def test_a_dense_grid_is_read_and_given(tmp_path):
    samples = np.full((4, 4, 4, 4, 3), 0.2)
    path = tmp_path / "even.npz"
    path.write_bytes(npz(samples=samples, other=np.zeros(2)))
    for given in (path, str(path), samples, DenseBRDF(samples)):
        found = factored_brdf.factored(given, Factorisation.DIRECTIONS, size=8, terms=1)
        assert found.error < 1e-6
        assert np.abs(found.factors.at(LIGHTS, VIEWS) - 0.2).max() < 1e-6


@pytest.mark.parametrize(
    ("contents", "says"),
    (
        (b"", "no MERL file"),
        (b"PK\x03\x04 not really", "damaged"),
        (b"\x5a\x00\x00\x00" * 8, "no MERL file"),
        (npz(brdf=np.zeros(3)), "no array `samples`"),
        (npz(samples=np.zeros((2, 2, 2, 3, 3))), "shape"),
        (npz(samples=np.zeros((0, 0, 0, 0, 3))), "shape"),
        (npz(samples=np.full((2, 2, 2, 2, 3), np.nan)), "finite"),
        (npz(samples=np.full((2, 2, 2, 2, 3), "a")), "finite"),
    ),
)
def test_other_files_are_refused_in_a_sentence(tmp_path, contents, says):
    path = tmp_path / "some.binary"
    path.write_bytes(contents)
    with pytest.raises(Refusal, match=says):
        factored_brdf.read(path)


def test_what_is_no_file_is_refused(tmp_path):
    with pytest.raises(Refusal, match="There is no file"):
        factored_brdf.read(tmp_path / "none.binary")
    with pytest.raises(Refusal, match="is no file"):
        factored_brdf.read(tmp_path)
    for given in (3.0, None, object()):
        with pytest.raises(ValueError, match="object with at"):
            factored_brdf.factored(given)
    with pytest.raises(ValueError, match="shape"):
        factored_brdf.factored(np.zeros((2, 2)))
    with pytest.raises(ValueError, match="finite"):
        factored_brdf.factored(np.full((2, 2, 2, 2, 3), np.inf))


def test_an_npz_file_that_cannot_be_unpacked_is_refused_in_a_sentence(tmp_path):
    path = tmp_path / "a.npz"
    np.savez_compressed(path, samples=np.arange(48.0).reshape(2, 2, 2, 2, 3))
    whole = path.read_bytes()
    central = whole.index(b"PK\1\2")
    encrypted, packed = bytearray(whole), bytearray(whole)
    for at in (6, central + 8):
        encrypted[at] |= 1
    packed[60:80] = bytes(20)
    for data, words in ((encrypted, "is an encrypted NPZ file"), (packed, "is a damaged NPZ file")):
        path.write_bytes(data)
        with pytest.raises(Refusal, match=words):
            factored_brdf.read(path)
    for samples, words in (
        (np.full((2, 2, 2, 2, 3), -0.9), "go down to -0.9"),
        (np.zeros((2, 2, 2, 2, 3)), "zero"),
    ):
        np.savez(path, samples=samples)
        with pytest.raises(Refusal, match=words):
            factored_brdf.read(path)
