"""Height fields, photographs and materials of one's own in figures: drawn, or refused in a sentence."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.cli import main
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.geometry import surfaces, triangle_meshes
from fixedpipe.effects.reflectance import material_textures
from fixedpipe.effects.user_pictures import maps
from fixedpipe.effects.user_pictures.bumped_mesh import MATERIALS
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import OCTANE, PROFILES

BOTH = ["F003-1", "F003-2", "F003-8", "F003-9", "F004-6", "F004-7", "K02"]
WITH_MATERIAL = ["F004-2", "F004-5", "F004-8"]
OTHERS = [
    "F000-9",
    "F001-9",
    "F001-10",
    "F001-11",
    "F001-12",
    "F001-13",
    "F002-13",
    "F003-4",
    "G15",
    "G17",
    "H43",
    "K12",
    "K13",
    "K14",
    "K15",
    "K17",
    "K18",
    "S10",
    "S13",
    "S14",
    "S15",
    "S24",
    "Z05",
    "Z06",
]
PANORAMAS = ["F000-5", "H20", "H21", "H25", "H30", "H32"]

# One bump, off the middle so that no symmetry of a figure hides it.
BUMP = np.zeros((16, 16))
BUMP[4:8, 9:13] = ((1, 2, 2, 1), (2, 4, 4, 2), (2, 4, 4, 2), (1, 2, 2, 1))
HALF = np.zeros((8, 8, 3), np.uint8)
HALF[:, 4:] = (255, 200, 90)


def picture(figure, method, **changes):
    """What the first machine of a method draws at a small size: uint8 [32, w, 4], top row first."""
    profile = PROFILES[method.machines[0]]
    # Each triangle is loaded by itself.
    few = {"slices": 10, "stacks": 6} if "slices" in figure.parameters and profile is OCTANE else {}
    changes = {**few, **changes}
    drawn = execute(figure.commands(profile, 32, method, **changes), profile, *figure.dimensions(32))
    return drawn.image()


def scenes(*ids):
    return [pytest.param(FIGURES[i], m, id=f"{i} {m.name}") for i in ids for m in FIGURES[i].methods]


@pytest.mark.parametrize(
    ("name", "ids"),
    [
        ("height_field", BOTH + WITH_MATERIAL + OTHERS),
        ("photograph", BOTH + PANORAMAS),
        ("material", WITH_MATERIAL),
        ("mesh", ["S15"]),
    ],
)
def test_which_figures_show_what_is_ones_own(name, ids):
    assert {i for i, figure in FIGURES.items() if name in figure.parameters} == {*ids}


@pytest.mark.parametrize(("figure", "method"), scenes(*BOTH, *WITH_MATERIAL, *OTHERS))
def test_a_height_field_is_drawn_and_is_a_plane_at_scale_zero(figure, method):
    own, bumped = picture(figure, method), picture(figure, method, height_field=BUMP)
    assert (bumped != own).any()
    if figure.id == "K13":  # What is embossed is stored over the highest point, so there is one.
        return
    level = picture(figure, method, height_field=BUMP, height_scale=0.0)
    assert (bumped != level).any()
    np.testing.assert_array_equal(
        picture(figure, method, height_field=BUMP[::-1, ::2], height_scale=0.0), level
    )


@pytest.mark.parametrize(("figure", "method"), scenes(*BOTH, *PANORAMAS))
def test_a_photograph_is_drawn(figure, method):
    shown = picture(figure, method, photograph=HALF)
    assert (shown != picture(figure, method)).any()
    assert (shown != picture(figure, method, photograph=255 - HALF)).any()


@pytest.mark.parametrize(("figure", "method"), scenes(*WITH_MATERIAL))
def test_a_material_is_drawn(figure, method):
    own, gold = picture(figure, method), picture(figure, method, material="gold")
    assert (gold != own).any()
    assert (picture(figure, method, material="gold", height_field=BUMP) != gold).any()
    smooth = material_textures.isotropic(8, 4, 0.5)
    assert (picture(figure, method, material=smooth) != own).any()
    with pytest.raises(ValueError, match="height_field would be ignored: give one of them"):
        figure.commands(method.machines[0], 32, method, material=smooth, height_field=BUMP)


# A pyramid whose base is away from the viewer; its last face has texture coordinates without area.
PYRAMID = """
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
v 0 0 1
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vt 0.5 0.5
f 1/1 2/2 5/5
f 2/2 3/3 5/5
f 3/3 4/4 5/5
f 4/4 1/4 5/4
"""


@pytest.mark.parametrize(("figure", "method"), scenes("S15"))
def test_a_mesh_is_drawn(tmp_path, figure, method):
    (tmp_path / "pyramid.obj").write_text(PYRAMID)
    path = str(tmp_path / "pyramid.obj")
    surface = triangle_meshes.with_creases(triangle_meshes.read_obj(PYRAMID))
    own, shown, given = (picture(figure, method, mesh=mesh) for mesh in (None, path, surface))
    assert (shown != own).any()
    np.testing.assert_array_equal(shown, given)
    # The globe stays.
    np.testing.assert_array_equal(shown[:, :64], own[:, :64])


def test_what_is_no_mesh_is_refused(tmp_path):
    figure = FIGURES["S15"]
    (tmp_path / "empty.obj").write_text("v 0 0 0\n")
    for value, sentence in (
        ("nowhere.obj", "S15's mesh: nowhere.obj cannot be read"),
        ("pyramid.stl", "is no mesh; give an OBJ or a PLY file"),
        (str(tmp_path / "empty.obj"), "has no faces"),
        (7, "'7' is no mesh"),
    ):
        with pytest.raises(ValueError, match=sentence):
            figure.commands("GEFORCE_3", 32, mesh=value)
    parameter = figure.offer("mesh", figure.methods[0])
    assert parameter.kind.show(parameter.accept(surfaces.plane(), "")) == "a surface of 2 triangles"


def test_a_probe_of_high_dynamic_range_is_drawn(tmp_path):
    np.save(tmp_path / "probe.npy", np.linspace(0.0, 9.0, 8 * 16 * 3).reshape(8, 16, 3))
    figure = FIGURES["H33"]
    own, shown = (picture(figure, figure.methods[0], probe=p) for p in (None, tmp_path / "probe.npy"))
    assert (shown != own).any()
    with pytest.raises(ValueError, match="H33's probe: There is no file"):
        figure.commands("GEFORCE_256", 32, probe="no.exr")


def test_top_row_is_the_top_of_the_picture():
    ramp = np.linspace(1.0, 0.0, 16)[:, None] + np.zeros(16)
    grey = FIGURES["F003-4"].render("OPENGL_1_2", 16, height_field=ramp).image()[:, :16, 0]
    assert grey[0].min() > 200
    assert grey[-1].max() < 60
    assert (np.diff(grey.astype(int), axis=0) <= 0).all()
    colors = FIGURES["F003-2"].render(
        "GEFORCE_256", 32, photograph=np.stack([ramp, 0.0 * ramp, 1.0 - ramp], axis=-1)
    )
    # A column through the middle of the first panel's wall.
    red, _, blue, _ = colors.image()[:, 16].astype(int).T
    wall = red + blue > 60
    assert red[wall][0] > blue[wall][0]
    assert red[wall][-1] < blue[wall][-1]


def test_a_panorama_is_seen_in_its_directions():
    rows, columns = np.mgrid[0:90, 0:180]
    around = maps.photograph(np.stack([columns / 179.0, rows / 89.0, 0.0 * rows], axis=-1))
    seen = around.panorama(np.array([(0, 0, -1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)], float))
    np.testing.assert_allclose(seen[:3, 0], (0.5, 0.75, 0.25), atol=0.01)
    np.testing.assert_allclose(seen[[0, 3, 4], 1], (0.5, 0.0, 1.0), atol=0.01)


def test_files_arrays_and_pillow_give_the_same(tmp_path):
    image = Image.fromarray(HALF)
    image.save(tmp_path / "half.png")
    np.save(tmp_path / "half.npy", HALF / 255.0)
    given = (
        HALF,
        image,
        image.convert("P", palette=Image.Palette.ADAPTIVE),
        str(tmp_path / "half.png"),
        tmp_path / "half.npy",
    )
    for value in given:
        np.testing.assert_allclose(maps.photograph(value).colors, HALF[::-1] / 255.0, atol=1e-12)
        heights = maps.height_field(value).heights
        assert heights[:, :4].max() == 0.0
        assert heights[:, 4:].min() == pytest.approx(1.0)
    # What was taken is taken again.
    taken = maps.height_field(HALF)
    assert maps.height_field(taken) is taken
    assert repr(taken) == "HeightField(called='an array of shape (8, 8, 3), uint8')"


def test_a_repeated_field_joins_its_edges_and_one_that_is_not_keeps_them():
    ramp = maps.height_field(np.arange(64.0) + np.zeros((64, 1)))
    joined = ramp.fitted(64, 64, 1.0, repeated=True)
    assert abs(joined[:, 0] - joined[:, -1]).max() < 0.2
    kept = ramp.fitted(64, 64, 0.5, repeated=False)
    assert kept[:, 0].max() < 0.02
    assert kept[:, -1].min() > 0.48


def test_the_command_line_names_files_and_shows_what_was_given(tmp_path):
    figure = FIGURES["F004-8"]
    parameter = figure.offer("height_field", figure.methods[0])
    np.save(tmp_path / "bump.npy", BUMP)
    path = str(tmp_path / "bump.npy")
    assert parameter.kind.show(parameter.parse(path, "F004-8's height_field")) == path
    assert parameter.kind.show(parameter.parse("None", "")) == "None"
    assert parameter.kind.show(parameter.accept(BUMP, "")) == "an array of shape (16, 16), float64"
    material = figure.offer("material", figure.methods[0])
    assert material.kind.show(material.parse("Gold", "")) == "gold"
    assert material.kind.show(material_textures.isotropic(8, 4, 0.5)) == "a Material of 4 x 8 texels"


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("height_field", "nowhere.png", "F004-6's height_field: There is no file 'nowhere.png'. Give a PNG"),
        ("height_field", "sample:grovel", "Did you mean gravel"),
        ("height_field", np.ones((8, 8)), "Every value of the image is 1"),
        ("height_field", np.full((8, 8), np.nan), "NaN or infinity"),
        ("height_field", np.ma.masked_less(BUMP, 1.0), "masked values; fill them"),
        ("height_field", np.arange(8.0), "has shape \\(8,\\)"),
        ("height_field", np.zeros((0, 5)), "is empty"),
        ("height_field", np.arange(8.0)[None], "1 x 8 heights; give two rows and two columns"),
        ("height_field", BUMP * 1j, "complex128; give numbers"),
        ("height_field", [["a", "b"]], "give numbers"),
        ("height_field", [[1, 2], [3]], "The rows are not all of one length; give"),
        ("photograph", np.full((4, 4, 3), 64), "type int64, whose full brightness is not known; give uint8"),
        ("photograph", np.full((4, 4, 3), 64.0), "ranges over 64..64; give uint8"),
        ("photograph", np.full((4, 4), np.nan), "ranges over nan..nan"),
        ("photograph", np.zeros((4, 4, 5)), "has shape \\(4, 4, 5\\)"),
        ("photograph", np.zeros((0, 4)), "has shape \\(0, 4\\)"),
    ],
)
def test_what_is_no_picture_is_refused(name, value, sentence):
    with pytest.raises(ValueError, match=f"^F004-6's {name}: ") as refused:
        FIGURES["F004-6"].commands("GEFORCE_256", 32, **{name: value})
    refused.match(sentence)


@pytest.mark.parametrize(
    ("value", "sentence"),
    [
        ("gild", "There is no material 'gild'; give gold, steel, brushed, stone or plastic"),
        (3, "The material is of type int; give gold, steel"),
        (
            material_textures.isotropic(8, 6, 0.5),
            "The material has 6 rows and 8 columns of texels; textures have powers of two",
        ),
    ],
)
def test_what_is_no_material_is_refused(value, sentence):
    with pytest.raises(ValueError, match=f"^F004-8's material: {sentence}"):
        FIGURES["F004-8"].commands("GEFORCE_256", 32, material=value)


def test_a_named_material_has_the_values_of_bump():
    figure, steel = FIGURES["F004-5"], MATERIALS["steel"]
    method = figure.methods[0]
    by_hand = picture(
        figure,
        method,
        alpha_x=steel.alpha_x,
        alpha_y=steel.alpha_y,
        k_s=(steel.k_s, steel.k_s),
        diffuse=steel.diffuse,
        ambient=tuple(0.12 * c for c in steel.diffuse),
        specular=steel.specular,
    )
    np.testing.assert_array_equal(picture(figure, method, material="steel"), by_hand)
    # What is given beside it is not the material's.
    wide = picture(figure, method, material="steel", alpha_x=1.0)
    assert (wide != by_hand).any()
    assert (wide != picture(figure, method, alpha_x=1.0)).any()


def test_a_record_says_whose_height_field_was_drawn(tmp_path):
    np.save(tmp_path / "bump.npy", BUMP)
    path = str(tmp_path / "bump.npy")
    given = ["--set", f"height_field={path}", "--set", "material=gold", "--set", "alpha_x=0.3"]
    options = ["--profile", "GEFORCE_3", "--size", "16", "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(main, ["figures", "F004-8", *given, *options])
    assert result.exit_code == 0, result.output
    assert "height_field: A height field in the place of" in result.output
    assert "F004-8 itself has alpha_x=" in result.output
    (record,) = (tmp_path / "out").glob("F004-8+*.json")
    said = json.loads(record.read_text())["set"]
    assert said == {"height_field": path, "material": "gold", "alpha_x": 0.3}


def test_a_scale_of_no_height_field_is_refused():
    figure = FIGURES["K14"]
    for changes in ({"height_scale": 0.2}, {"height_scale": 0.2, "height_field": None}):
        with pytest.raises(
            ValueError, match=r"^K14's height_scale would be ignored: .* give height_field too"
        ):
            figure.render("GEFORCE_256", 16, **changes)
    done = CliRunner().invoke(main, ["passes", "K14", "--set", "height_scale=0.2"])
    assert done.exit_code == 2 and "would be ignored" in done.output


def test_what_is_ones_own_is_named_where_a_rendering_shows_itself():
    drawn = FIGURES["K14"].render("GEFORCE_256", 16, height_field=np.eye(64), height_scale=0.2)
    own = "height_field=HeightField(called='an array of shape (64, 64), float64'), height_scale=0.2"
    assert repr(drawn) == f"<K14 on GeForce 256, 16x16 pixels, {own}>"
