"""K18: mip-mapped material textures against the lobes that they stand for."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.figures import FIGURES, Renderer
from fixedpipe.effects.figures.figure import DARK
from fixedpipe.effects.figures.kautz_seidel_2000 import k18_mipmapped_materials
from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.passes.encoding import vectors_of_texels
from fixedpipe.effects.reflectance import brdfs, material_textures
from fixedpipe.effects.texture_filtering import mipmapped_materials as mipmaps
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, IDEAL

FINE = mipmaps.half_vectors(32)


def frames(rows, columns, seed):
    random = np.random.Generator(np.random.PCG64(seed))
    normals = normalize(random.standard_normal((rows, columns, 3)) * 0.4 + np.array([0.0, 0.0, 1.5]))
    tangents = normalize(cross(random.standard_normal((rows, columns, 3)), normals))
    return normals, tangents, cross(normals, tangents)


def material(rows, columns, seed, least=0.25):
    random = np.random.Generator(np.random.PCG64(seed + 100))
    alphas = random.uniform(least, 1.0, (2, rows, columns))
    return material_textures.Material(
        *frames(rows, columns, seed), *alphas, random.uniform(0.1, 1.0, (rows, columns))
    )


@cache
def gold():
    return material_textures.gold(
        64,
        bumps=6,
        depth=1.0,
        alpha_x=0.3,
        alpha_y=0.5,
        spread=10.0,
        stroke_depth=0.2,
        k_s=(0.6, 1.0),
    )


@cache
def levels(name):
    return getattr(mipmaps, name)(gold())


@cache
def targets():
    return mipmaps.mean_lobes(gold(), FINE)


def errors(levels):
    """RMS over the hemisphere of each level's lobes against the mean lobes of what its texels cover."""
    return [
        root_mean_square(mipmaps.lobes(mipmaps.quadratic_form(level), FINE) - target)
        for level, target in zip(levels, targets(), strict=True)
    ]


# ---------------------------------------------------------------------------------------- Eq. 1 as a matrix


def test_eq_1_is_a_quadratic_form_of_the_halfway_vector():
    m = material(4, 8, 1)
    lobes = mipmaps.lobes(mipmaps.quadratic_form(mipmaps.vectors(m)[0]), FINE)
    expected = brdfs.anisotropic_blinn_phong(
        FINE,
        *(v[:, :, None, :] for v in (m.tangents, m.binormals)),
        *(v[:, :, None] for v in (m.alpha_x, m.alpha_y, m.k_s)),
    )
    assert np.allclose(lobes, expected, atol=1e-12)


def test_the_largest_eigenvector_is_lapacks():
    random = np.random.Generator(np.random.PCG64(2))
    form = np.concatenate([random.standard_normal((500, 6)) * 9.0, np.zeros((1, 6))])
    matrices = form[:, [[0, 3, 4], [3, 1, 5], [4, 5, 2]]]
    value, vector = mipmaps.largest_eigenvector(form)
    assert np.allclose(value, np.linalg.eigvalsh(matrices)[:, -1], atol=1e-12)
    assert np.allclose(np.einsum("nij,nj->ni", matrices, vector), value[:, None] * vector, atol=1e-11)
    assert (vector[:, 2] >= 0.0).all()


def test_a_form_gives_back_its_lobe_and_vectors_near_those_asked_for():
    level = mipmaps.vectors(material(8, 8, 3))[0]
    form = mipmaps.quadratic_form(level)
    back = mipmaps.from_form(form, level)
    assert np.allclose(mipmaps.quadratic_form(back), form, atol=1e-9)
    assert np.allclose(back.scaled_tangents, level.scaled_tangents, atol=1e-9)
    # Asked for in another direction of the plane, they are other vectors of the same lobe.
    other = mipmaps.from_form(form, replace(level, scaled_tangents=level.scaled_binormals))
    assert np.allclose(mipmaps.quadratic_form(other), form, atol=1e-9)
    assert (dot(other.scaled_tangents, level.scaled_binormals) > 0.0).all()


# -------------------------------------------------------------------------------------------- the two means


def test_without_a_clamp_the_mean_form_is_exact_and_averaged_vectors_are_not():
    m = replace(material(8, 16, 4), alpha_x=1.0, alpha_y=1.0)
    means = mipmaps.mean_lobes(m, FINE)
    for level, target in zip(mipmaps.mean_form(m), means, strict=True):
        assert np.allclose(mipmaps.lobes(mipmaps.quadratic_form(level), FINE), target, atol=1e-9)
    plain = mipmaps.lobes(mipmaps.quadratic_form(mipmaps.vectors(m)[-1]), FINE)
    assert root_mean_square(plain - means[-1]) > 0.05


def test_covariances_of_slopes_and_lobes_add():
    """Two texels that lean by +-15 degrees about b: alpha_x^2 grows by six times the normals' variance."""
    lean = np.radians(15.0)
    normals = np.array([[[np.sin(lean), 0.0, np.cos(lean)], [-np.sin(lean), 0.0, np.cos(lean)]]])
    binormals = np.array([[[0.0, 1.0, 0.0]] * 2])
    m = material_textures.Material(normals, cross(binormals, normals), binormals, 0.3, 0.4, 0.8)
    level = mipmaps.covariance_fit(m)[1]
    tangent, binormal = (np.sqrt(dot(v, v))[0, 0] for v in (level.scaled_tangents, level.scaled_binormals))
    along = np.sqrt((0.3 * np.cos(lean)) ** 2 + 6.0 * np.sin(lean) ** 2)
    assert 1.0 / tangent == pytest.approx(along, abs=1e-9)
    assert 1.0 / binormal == pytest.approx(0.4, abs=1e-9)
    # The volume k_s alpha_x alpha_y stays.
    assert level.k_s[0, 0] == pytest.approx(0.8 * 0.3 / along, abs=1e-9)


def test_where_all_texels_are_alike_every_level_is_level_0():
    m = material_textures.isotropic(8, 4, 0.5, 0.7)
    for name in ("vectors", "mean_form", "covariance_fit", "lobe_fit"):
        for level in getattr(mipmaps, name)(m):
            assert np.allclose(level.scaled_tangents, (2.0, 0.0, 0.0), atol=1e-9)
            assert np.allclose(level.scaled_binormals, (0.0, 2.0, 0.0), atol=1e-9)
            assert np.allclose(level.k_s, 0.7, atol=1e-9)


# --------------------------------------------------------------------------------------------------- the fit


def test_the_fit_is_nearest_then_the_covariance_then_the_mean_form_then_averaged_vectors():
    """Measured: RMS over the hemisphere at 1 x 1 texels 0.016, 0.024, 0.084 and 0.103 of a peak of one."""
    fit, covariance, form, plain = (
        errors(levels(name)) for name in ("lobe_fit", "covariance_fit", "mean_form", "vectors")
    )
    for k in range(1, 7):
        assert fit[k] < covariance[k] < form[k] < plain[k]
    assert fit[-1] < 0.75 * covariance[-1]
    assert covariance[-1] < 0.3 * form[-1]


def test_more_steps_or_halfway_vectors_do_not_better_the_fit():
    four, target = levels("lobe_fit"), targets()[4]
    many = mipmaps.lobe_fit(gold(), steps=12)
    assert np.allclose(errors(four), errors(many), rtol=0.02)
    begin = mipmaps.quadratic_form(levels("covariance_fit")[4])
    finest = mipmaps.lobes(mipmaps.fitted_form(begin, target, FINE, 16), FINE) - target
    assert errors(four)[4] < 1.02 * root_mean_square(finest)


def test_no_step_makes_a_texels_error_larger():
    half = mipmaps.half_vectors()
    target = mipmaps.mean_lobes(gold(), half)[2]
    form = mipmaps.quadratic_form(levels("vectors")[2])
    begin = mipmaps.total((mipmaps.lobes(form, half) - target) ** 2)
    for steps in (1, 3, 6):
        form = mipmaps.fitted_form(form, target, half, steps)
        end = mipmaps.total((mipmaps.lobes(form, half) - target) ** 2)
        assert (end <= begin).all()
        begin = end


@pytest.mark.parametrize("name", ["covariance_fit", "lobe_fit"])
def test_levels_can_be_stored_and_filtered(name):
    """Vectors stay within the storage, and between two texels they stand for the mean of their lobes."""
    for k, level in enumerate(levels(name)):
        for vectors in (level.scaled_tangents, level.scaled_binormals):
            assert np.sqrt(dot(vectors, vectors)).max() <= 4.0 + 1e-9
        assert (level.k_s >= 0.0).all()
        assert (level.k_s <= 1.0).all()
        assert (dot(level.scaled_tangents, levels("vectors")[k].scaled_tangents) > 0.0).all()
    level, target = levels(name)[3], targets()[3]
    between = mipmaps.Level(*((value + np.roll(value, -1, axis=1)) / 2 for value in vars(level).values()))
    wanted = (target + np.roll(target, -1, axis=1)) / 2
    error = root_mean_square(mipmaps.lobes(mipmaps.quadratic_form(between), FINE) - wanted)
    assert error < 2.0 * errors(levels(name))[3]
    assert error < 0.6 * errors(levels("vectors"))[3]


# --------------------------------------------------------------------------------------------- the textures


def test_textures_have_every_level():
    fit = levels("lobe_fit")
    for profile in (GEFORCE_256, IDEAL):
        commands, names = mipmaps.load(fit, "gold", profile)
        assert [c.texture for c in commands] == [names.normal, names.tangent, names.binormal]
        for command in commands:
            assert [level.shape for level in command.image.levels] == [
                (1, 64 >> k, 64 >> k, 4) for k in range(7)
            ]
    stored = vectors_of_texels(commands[1].image.ideal[5][0, ..., :3], IDEAL)
    assert np.allclose(4.0 * stored, fit[5].scaled_tangents, atol=1e-12)
    machine = mipmaps.load(fit, "gold", GEFORCE_256)[0][2].image.levels[5][0]
    assert (
        np.abs(4.0 * vectors_of_texels(machine[..., :3], GEFORCE_256) - fit[5].scaled_binormals).max() < 0.016
    )
    assert (machine[..., 3] == 4).all()


def test_edges_that_are_no_powers_of_two_are_refused():
    with pytest.raises(ValueError, match="6x4 texels; mip-maps need powers of two"):
        mipmaps.lobe_fit(material(4, 6, 5))


@pytest.mark.parametrize("exponent", [0.0, 200.0, float("nan")])
def test_an_exponent_that_cannot_be_stored_is_refused(exponent):
    with pytest.raises(ValueError, match="give a number from 1 to 128"):
        mipmaps.load((), "m", IDEAL, exponent)


# --------------------------------------------------------------------------------------------- the figure


@pytest.mark.slow
def test_anisotropic_filtering_needs_fitted_textures_too():
    """On a GeForce 3, eight probes along the view: less blur, so nearer to the reference with either."""
    figure = FIGURES["K18"]
    renderer = Renderer(GEFORCE_3, figure.method("GEFORCE_3"), execute, execute_ideal)
    found = {}
    for anisotropy in (1.0, 8.0):
        image = renderer.machine_window(figure, 256, **DARK, specular=(1.0, 1.0, 1.0), anisotropy=anisotropy)[
            ..., 0
        ]
        _, plain, fit, reference = (image[:128, 256 * k : 256 * (k + 1)] for k in range(4))
        found[anisotropy] = tuple(root_mean_square(part - reference) for part in (plain, fit))
    assert found[8.0][0] < found[1.0][0]
    assert found[8.0][1] < found[1.0][1]
    assert all(fit < plain for plain, fit in found.values())


def test_the_reference_is_the_closed_form_where_the_plane_is_flat():
    """Without bumps and strokes it is Eq. 1 of the halfway vector at each pixel's place."""
    p = FIGURES["K18"].values
    flat = k18_mipmapped_materials._gold(8, 1, 0.0, 0.3, 0.4, 0.0, 0.0, (1.0, 1.0))
    toward = tuple(normalize(np.array(p["light"])))
    diffuse, specular, covered = k18_mipmapped_materials.reference(
        32, 15.0, 38.0, 12.0, 40.0, 1.0, toward, **flat
    )
    assert 0.7 < (covered == 1.0).mean() < 0.95
    assert np.allclose(diffuse[covered == 1.0], toward[1], atol=1e-9)
    edge = ((np.arange(32) + 0.5) / 32 * 2.0 - 1.0) * np.tan(np.radians(19.0))
    pitch = np.radians(15.0)
    forward, above = (
        np.array([0.0, -np.sin(pitch), -np.cos(pitch)]),
        np.array([0, np.cos(pitch), -np.sin(pitch)]),
    )
    ray = forward + edge[:, None, None] * above + edge[None, :, None] * np.array([1.0, 0.0, 0.0])
    half = normalize(np.array(toward) - normalize(ray))
    expected = np.maximum(0.0, 1.0 - (half[..., 0] / 0.3) ** 2 - (half[..., 2] / 0.4) ** 2)
    assert np.abs(specular - expected)[covered == 1.0].max() < 0.02
