"""Texture images: what a machine stores and draws of what calls define, whole, in part and by copies."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import CopyTexImage, HostStep, TexImage
from fixedpipe.pipeline.enums import InternalFormat, TextureTarget
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.opengl import tokens as GL
from fixedpipe.pipeline.opengl.context import Drawable
from fixedpipe.pipeline.opengl.texture_queries import level_parameter
from fixedpipe.pipeline.opengl.texturing import bound_object
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.textures.images import pyramid
from fixedpipe.pipeline.textures.words import compressed_texture
from tests.pipeline.opengl.drawn import context, counted, refusals

_FACES = range(GL.TEXTURE_CUBE_MAP_POSITIVE_X, GL.TEXTURE_CUBE_MAP_POSITIVE_X + 6)


class Screen:
    """A Context and its machine."""

    def __init__(self, profile="GEFORCE_3", width=8, height=8):
        self.gl = context(profile, width, height)
        self.machine = Machine(PROFILES[profile], width, height)

    def picture(self):
        """uint8 [h, w, 4] after the commands so far, bottom row first."""
        return self.machine.run(self.gl.take_commands()).image()[::-1]


def _nearest(gl, target=GL.TEXTURE_2D, number=1):
    gl.BindTexture(target, number)
    gl.TexParameteri(target, GL.TEXTURE_MIN_FILTER, GL.NEAREST)
    gl.TexParameteri(target, GL.TEXTURE_MAG_FILTER, GL.NEAREST)


def _quad(gl, target=GL.TEXTURE_2D, largest=1.0):
    """The bound texture over the whole window."""
    gl.TexEnvi(GL.TEXTURE_ENV, GL.TEXTURE_ENV_MODE, GL.REPLACE)
    gl.Enable(target)
    gl.Begin(GL.QUADS)
    for s, t in ((0, 0), (1, 0), (1, 1), (0, 1)):
        gl.TexCoord2f(s * largest, t * largest)
        gl.Vertex2f(2 * s - 1, 2 * t - 1)
    gl.End()


def _image(*shape, seed=0):
    return np.random.default_rng(seed).integers(0, 256, (*shape, 4), np.uint8)


def _define(gl, image, level=0, target=GL.TEXTURE_2D, internal=GL.RGBA):
    height, width = image.shape[:2]
    gl.TexImage2D(target, level, internal, width, height, 0, GL.RGBA, GL.UNSIGNED_BYTE, image)


def _stored(gl, target=GL.TEXTURE_2D):
    """The Texture that a machine would store."""
    texture = bound_object(gl, target)
    texture.settle()
    return texture.texture(texture.layout())


# ------------------------------------------------------------------------------------- whole and in parts


def test_a_texture_is_drawn_texel_by_texel():
    screen = Screen("GEFORCE_256")
    image = _image(8, 8)
    _nearest(screen.gl)
    _define(screen.gl, image)
    _quad(screen.gl)
    np.testing.assert_array_equal(screen.picture(), image)
    assert not refusals(screen.gl)


_BOXES = st.lists(st.tuples(*[st.tuples(st.integers(0, 3), st.integers(1, 4))] * 3), min_size=1, max_size=6)


@given(st.sampled_from((GL.TEXTURE_1D, GL.TEXTURE_2D, GL.TEXTURE_3D)), _BOXES, st.integers(0, 1))
@settings(max_examples=60)
def test_a_texture_in_parts_is_the_one_that_is_given_whole(target, boxes, border):
    """Also with a border, whose texels have the offset -1."""
    axes = {GL.TEXTURE_1D: 1, GL.TEXTURE_2D: 2, GL.TEXTURE_3D: 3}[target]
    shape = tuple([4 + 2 * border if axis < axes else 1 for axis in (2, 1, 0)])
    whole = _image(*shape)
    parts, gl = context(), context()
    sizes = shape[::-1][:axes]
    for each, image in ((gl, whole), (parts, np.zeros_like(whole))):
        define = getattr(each, f"TexImage{axes}D")
        define(target, 0, GL.RGBA, *sizes, border, GL.RGBA, GL.UNSIGNED_BYTE, image)
    replaced = np.zeros_like(whole)
    for box in boxes:
        begins = [first if axis < axes else 0 for axis, (first, _) in enumerate(box)]
        ends = [min(b + n, size) for b, (_, n), size in zip(begins, box, shape[::-1], strict=True)]
        where = tuple([slice(b, e) for b, e in zip(begins, ends, strict=True)][::-1])
        replaced[where] = whole[where]
        offsets = [begin - border for begin in begins[:axes]]
        edges = [e - b for b, e in zip(begins, ends, strict=True)][:axes]
        getattr(parts, f"TexSubImage{axes}D")(
            target, 0, *offsets, *edges, GL.RGBA, GL.UNSIGNED_BYTE, whole[where]
        )
    assert not refusals(parts)
    np.testing.assert_array_equal(_stored(parts, target).levels[0], replaced)
    np.testing.assert_array_equal(_stored(gl, target).levels[0], whole)
    assert _stored(parts, target).border == border


@given(st.permutations(range(4)), st.permutations(range(6)))
@settings(max_examples=20)
def test_levels_and_faces_may_come_in_any_order(levels, faces):
    images = {(f, k): _image(8 >> k, 8 >> k, seed=10 * f + k) for f in range(6) for k in range(4)}
    gl = context()
    for level, face in product(levels, faces):
        _define(gl, images[face, level], level, _FACES[face])
    texture = _stored(gl, GL.TEXTURE_CUBE_MAP)
    assert texture.target is TextureTarget.TEXTURE_CUBE_MAP
    for level in range(4):
        np.testing.assert_array_equal(texture.levels[level], [images[f, level] for f in range(6)])


def test_a_machine_gets_each_version_once_and_every_machine_its_own():
    gl = context()
    _nearest(gl)
    _define(gl, _image(4, 4))
    kinds = []
    for change in (None, None, "texels", None, "window", None):
        if change == "texels":
            gl.TexSubImage2D(GL.TEXTURE_2D, 0, 0, 0, 1, 1, GL.RGBA, GL.UNSIGNED_BYTE, bytes(4))
        elif change == "window":
            gl.drawable = Drawable(8, 8)
        _quad(gl)
        kinds.append([type(command).__name__ for command in gl.take_commands()])
    stores = ["TexImage", "Draw"]
    assert kinds == [stores, ["Draw"], stores, ["Draw"], stores, ["Draw"]]


def test_a_new_object_of_a_deleted_ones_number_is_stored_anew():
    screen = Screen()
    for seed in (1, 2):
        image = _image(8, 8, seed=seed)
        _nearest(screen.gl)
        _define(screen.gl, image)
        _quad(screen.gl)
        np.testing.assert_array_equal(screen.picture(), image)
        screen.gl.DeleteTextures(1, [1])
    assert not refusals(screen.gl)


def test_the_ideal_reads_texels_as_they_were_given():
    gl = context()
    _nearest(gl)
    given_ = np.random.default_rng(1).random((8, 8, 3)).astype(np.float32)
    gl.TexImage2D(GL.TEXTURE_2D, 0, GL.RGB5, 8, 8, 0, GL.RGB, GL.FLOAT, given_)
    gl.TexSubImage2D(GL.TEXTURE_2D, 0, 0, 0, 8, 1, GL.RGB, GL.UNSIGNED_BYTE, np.full((8, 3), 17, np.uint8))
    texture = _stored(gl)
    assert texture.internal_format is InternalFormat.RGB5
    expected = given_.astype(float)
    expected[0] = 17 / 255
    np.testing.assert_allclose(texture.ideal[0][0, ..., :3], expected)


# ----------------------------------------------------------------------------------------------- completeness


def _chain(gl, sizes, target=GL.TEXTURE_2D, **different):
    for level, (width, height) in sizes.items():
        internal = different.get("internal", {}).get(level, GL.RGBA)
        _define(gl, _image(height, width, seed=level), level, target, internal)


_WHOLE = {0: (8, 4), 1: (4, 2), 2: (2, 1), 3: (1, 1)}


def _without(*levels, **changed):
    return {k: v for k, v in (_WHOLE | changed.get("to", {})).items() if k not in levels}


@pytest.mark.parametrize(
    ("sizes", "parameters", "different", "complete"),
    [
        ({}, {}, {}, False),
        (_WHOLE, {}, {}, True),
        (_without(3), {}, {}, False),
        (_without(0), {}, {}, False),
        (_without(1), {}, {}, False),
        (_without(3), {"MIN_FILTER": GL.LINEAR}, {}, True),
        (_without(0), {"MIN_FILTER": GL.LINEAR}, {}, False),
        (_without(3), {"MAX_LEVEL": 2}, {}, True),
        (_without(3), {"MAX_LEVEL": 3}, {}, False),
        (_without(2, 3), {"MAX_LEVEL": 0}, {}, True),
        (_without(0), {"BASE_LEVEL": 1}, {}, True),
        (_without(0, 3), {"BASE_LEVEL": 1, "MAX_LEVEL": 2}, {}, True),
        (_WHOLE, {"BASE_LEVEL": 2, "MAX_LEVEL": 1}, {}, False),
        (_WHOLE, {"BASE_LEVEL": 2, "MAX_LEVEL": 1, "MIN_FILTER": GL.NEAREST}, {}, True),
        (_WHOLE, {"BASE_LEVEL": 4}, {}, False),
        (_without(to={2: (1, 1)}), {}, {}, False),
        (_without(to={2: (1, 1)}), {"MAX_LEVEL": 1}, {}, True),
        (_without(to={1: (8, 4)}), {"MIN_FILTER": GL.NEAREST}, {}, True),
        (_without(to={0: (16, 16)}), {"BASE_LEVEL": 1}, {}, True),
        (_WHOLE, {}, {"internal": {2: GL.RGB}}, False),
        (_WHOLE, {}, {"internal": {2: GL.RGBA4}}, False),
        (_WHOLE, {"MAX_LEVEL": 1}, {"internal": {2: GL.RGB}}, True),
    ],
)
def test_incomplete_textures_are_disabled(sizes, parameters, different, complete):
    """Section 3.8.5; and what is complete is what a machine takes."""
    gl = context("OPENGL_1_2")
    gl.BindTexture(GL.TEXTURE_2D, 1)
    for name, value in parameters.items():
        gl.TexParameteri(GL.TEXTURE_2D, getattr(GL, "TEXTURE_" + name), value)
    _chain(gl, sizes, **different)
    _quad(gl)
    units = gl.state().texture_units
    assert (len(units) == 1) == complete
    Machine(PROFILES["OPENGL_1_2"], 64, 64).run(gl.take_commands())
    assert not refusals(gl)


@pytest.mark.parametrize(
    ("missing", "change", "complete"),
    [(None, None, True), (3, None, False), (None, (2, (4, 4)), False), (None, (2, (8, 4)), False)],
)
def test_a_cube_map_needs_six_equal_faces(missing, change, complete):
    gl = context()
    _nearest(gl, GL.TEXTURE_CUBE_MAP)
    for face, target in enumerate(_FACES):
        size = change[1] if change is not None and change[0] == face else (8, 8)
        if face != missing:
            _define(gl, _image(*size[::-1]), target=target)
    gl.Enable(GL.TEXTURE_CUBE_MAP)
    assert (len(gl.state().texture_units) == 1) == complete


def test_the_base_level_is_what_is_sampled():
    screen = Screen()
    _chain(screen.gl, {0: (16, 16), 1: (8, 8), 2: (4, 4), 3: (2, 2), 4: (1, 1)})
    for parameter, value in ((GL.TEXTURE_MIN_FILTER, GL.NEAREST), (GL.TEXTURE_MAG_FILTER, GL.NEAREST)):
        screen.gl.TexParameteri(GL.TEXTURE_2D, parameter, value)
    for level, edge in ((1, 8), (2, 4), (0, 16)):
        screen.gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_BASE_LEVEL, level)
        _quad(screen.gl)
        picture, image = screen.picture(), _image(edge, edge, seed=level)
        places = np.arange(8) * edge // 8 if edge <= 8 else 2 * np.arange(8) + 1
        if edge <= 8:
            np.testing.assert_array_equal(picture, image[places][:, places])
    commands = [c for c in screen.gl.commands if isinstance(c, TexImage)]
    assert not commands  # one texture serves all base levels
    assert not refusals(screen.gl)


def test_levels_below_the_base_level_that_do_not_fit_are_left_out():
    screen = Screen()
    _nearest(screen.gl)
    _define(screen.gl, _image(16, 4), 0)
    _define(screen.gl, _image(8, 8, seed=5), 1)
    screen.gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_BASE_LEVEL, 1)
    _quad(screen.gl)
    np.testing.assert_array_equal(screen.picture(), _image(8, 8, seed=5))


# ------------------------------------------------------------------------------------------ automatic mipmaps


def test_smaller_levels_are_made_from_the_base_level_when_it_changes():
    gl, image = context(), _image(8, 4)
    gl.TexParameteri(GL.TEXTURE_2D, GL.GENERATE_MIPMAP, 1)
    _define(gl, image)
    for _ in range(2):
        for found, made in zip(_stored(gl).levels, pyramid(image[None]), strict=True):
            np.testing.assert_array_equal(found, made)
        image = image.copy()
        image[2:4, 1:3] = 7
        gl.TexSubImage2D(
            GL.TEXTURE_2D, 0, 1, 2, 2, 2, GL.RGBA, GL.UNSIGNED_BYTE, np.full((2, 2, 4), 7, np.uint8)
        )
    own = _image(4, 2, seed=9)
    _define(gl, own, 1)  # a level of the program's own stays until the base level changes
    np.testing.assert_array_equal(_stored(gl).levels[1][0], own)
    gl.Enable(GL.TEXTURE_2D)
    assert len(gl.state().texture_units) == 1


def test_smaller_levels_are_made_once_by_generate_mipmap():
    gl, image = context(), _image(8, 4)
    _define(gl, image)
    gl.GenerateMipmapEXT(GL.TEXTURE_2D)
    levels = pyramid(image[None])
    gl.TexSubImage2D(GL.TEXTURE_2D, 0, 0, 0, 1, 1, GL.RGBA, GL.UNSIGNED_BYTE, bytes(4))
    for found, made in zip(_stored(gl).levels[1:], levels[1:], strict=True):
        np.testing.assert_array_equal(found, made)
    assert not _stored(gl).levels[0][0, 0, 0].any()
    gl.GenerateMipmap(GL.TEXTURE_1D)  # it has no image: nothing happens
    assert gl.GetError() == 0
    gl.GenerateMipmap(GL.TEXTURE_CUBE_MAP)
    assert gl.GetError() == GL.INVALID_OPERATION
    gl.GenerateMipmap(GL.TEXTURE_RECTANGLE_NV)
    assert gl.GetError() == GL.INVALID_ENUM


def test_a_texture_that_cannot_be_halved_is_refused_its_mipmaps():
    gl = context("IDEAL")
    gl.TexParameteri(GL.TEXTURE_2D, GL.GENERATE_MIPMAP, 1)
    _define(gl, _image(6, 5))
    assert counted(gl, "refused") == [("glTexImage2D: mipmaps of 5x6 texels of RGBA8 are not made here", 1)]


# -------------------------------------------------------------------------------------------- sizes, borders


@pytest.mark.parametrize(
    ("profile", "call", "arguments", "kind"),
    [
        ("GEFORCE_256", "TexImage2D", (GL.TEXTURE_2D, 0, 4, 4096, 4, 0), GL.INVALID_VALUE),
        ("GEFORCE_256", "TexImage2D", (GL.TEXTURE_2D, 0, 4, 2048, 2048, 0), None),
        ("GEFORCE_256", "TexImage2D", (GL.TEXTURE_2D, 0, 4, 5, 4, 0), GL.INVALID_VALUE),
        ("IDEAL", "TexImage2D", (GL.TEXTURE_2D, 0, 4, 5, 4, 0), None),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_2D, 12, 4, 1, 1, 0), None),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_2D, 12, 4, 2, 1, 0), GL.INVALID_VALUE),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_2D, 13, 4, 1, 1, 0), GL.INVALID_VALUE),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_2D, -1, 4, 1, 1, 0), GL.INVALID_VALUE),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_2D, 0, 4, 4, 4, 2), GL.INVALID_VALUE),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_2D, 0, 4, 5, 4, 1), GL.INVALID_VALUE),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_2D, 0, 4, 2, 4, 1), GL.INVALID_VALUE),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_2D, 0, 4, 6, 6, 1), None),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_2D, 0, 77, 4, 4, 0), GL.INVALID_VALUE),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_1D, 0, 4, 4, 4, 0), GL.INVALID_ENUM),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_CUBE_MAP, 0, 4, 4, 4, 0), GL.INVALID_ENUM),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_CUBE_MAP_NEGATIVE_Z, 0, 4, 4, 8, 0), GL.INVALID_VALUE),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_RECTANGLE_NV, 0, 4, 5, 3, 0), None),
        ("GEFORCE_3", "TexImage2D", (GL.TEXTURE_RECTANGLE_NV, 1, 4, 4, 4, 0), GL.INVALID_VALUE),
        ("GEFORCE_3", "TexImage3D", (GL.TEXTURE_3D, 0, 4, 4, 4, 4, 0), None),
        ("GEFORCE_3", "TexImage3D", (GL.TEXTURE_3D, 0, 4, 4, 4, 1024, 0), GL.INVALID_VALUE),
        ("GEFORCE_3", "TexImage3D", (GL.TEXTURE_3D, 0, 4, 4, 4, 3, 0), GL.INVALID_VALUE),
        ("GEFORCE_3", "TexImage1D", (GL.TEXTURE_1D, 0, 4, 10, 1), None),
    ],
)
def test_sizes_as_the_machines_driver_has_them(profile, call, arguments, kind):
    gl = context(profile)
    getattr(gl, call)(*arguments, GL.RGBA, GL.UNSIGNED_BYTE, None)
    assert gl.error == (kind or 0)
    assert gl.tally.count("refused") == 0
    assert gl.tally.count("error") == (kind is not None)


def test_what_a_machine_has_not_is_refused_in_its_name():
    gl = context("GEFORCE_256")
    gl.TexImage3D(GL.TEXTURE_3D, 0, 4, 4, 4, 4, 0, GL.RGBA, GL.UNSIGNED_BYTE, None)
    assert counted(gl, "refused") == [("glTexImage3D: GeForce 256 has no GL_TEXTURE_3D", 1)]
    gl.Enable(GL.TEXTURE_3D)
    _nearest(gl)
    _define(gl, _image(4, 4))
    gl.Enable(GL.TEXTURE_2D)
    assert gl.state().texture_units[0].texture == "texture 1"  # as if 3D were not enabled


@pytest.mark.parametrize(("profile", "border", "edge"), [("GEFORCE_3", 1, 6), ("NV2A", 0, 4)])
def test_a_border_is_kept_where_the_machine_has_one(profile, border, edge):
    gl, image = context(profile), _image(6, 6)
    gl.TexImage2D(GL.TEXTURE_2D, 0, 4, 6, 6, 1, GL.RGBA, GL.UNSIGNED_BYTE, image)
    texture = _stored(gl)
    assert (texture.border, texture.levels[0].shape[1]) == (border, edge)
    inside = image if border else image[1:-1, 1:-1]
    np.testing.assert_array_equal(texture.levels[0][0], inside)
    assert gl.tally.count("refused") == (border == 0)


# ----------------------------------------------------------------------------------------------------- copies


def _painted(screen, image):
    """Fill the window with an image, which is drawn as a texture."""
    _nearest(screen.gl, number=100)
    _define(screen.gl, image)
    _quad(screen.gl)


def _shows(screen, expected):
    _quad(screen.gl)
    np.testing.assert_array_equal(screen.picture(), expected)
    assert not refusals(screen.gl)


def test_a_copied_texture_is_one_command_and_shows_the_framebuffer():
    screen, image = Screen(), _image(8, 8)
    _painted(screen, image)
    _nearest(screen.gl)
    screen.gl.CopyTexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 4, 2, 4, 4, 0)
    assert isinstance(screen.gl.commands[-1], CopyTexImage)
    part = image[2:6, 4:8]
    _shows(screen, part.repeat(2, 0).repeat(2, 1))


def test_copies_into_a_texture_of_the_clients():
    screen, image, own = Screen(), _image(8, 8), _image(8, 8, seed=3)
    _nearest(screen.gl)
    _define(screen.gl, own)
    _painted(screen, image)
    _nearest(screen.gl)
    screen.gl.CopyTexSubImage2D(GL.TEXTURE_2D, 0, 2, 3, 0, 0, 4, 4)
    own = own.copy()
    own[3:7, 2:6] = image[:4, :4]
    assert not any(isinstance(command, HostStep) for command in screen.gl.commands)
    _shows(screen, own)


def test_a_clients_image_goes_into_a_copied_texture():
    """The machine alone knows the copy, so that a HostStep reads it back."""
    screen, image = Screen(), _image(8, 8)
    _painted(screen, image)
    _nearest(screen.gl)
    screen.gl.CopyTexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 0, 0, 8, 8, 0)
    patch = _image(2, 3, seed=4)
    screen.gl.TexSubImage2D(GL.TEXTURE_2D, 0, 5, 1, 3, 2, GL.RGBA, GL.UNSIGNED_BYTE, patch)
    expected = image.copy()
    expected[1:3, 5:8] = patch
    _shows(screen, expected)
    screen.gl.CopyTexSubImage2D(GL.TEXTURE_2D, 0, 0, 0, 7, 7, 1, 1)
    expected[0, 0] = expected[7, 7]
    _shows(screen, expected)


@pytest.mark.parametrize("internal", [GL.RGBA8, GL.RGB5, GL.LUMINANCE, GL.INTENSITY, GL.ALPHA, GL.RGBA4])
def test_a_copy_is_read_back_and_stored_without_a_change(internal):
    """Twice the same picture: as it was copied, and put together again beside a level of the client's."""
    pictures = []
    for again in (False, True):
        screen = Screen()
        _painted(screen, _image(8, 8))
        _nearest(screen.gl)
        screen.gl.CopyTexImage2D(GL.TEXTURE_2D, 0, internal, 0, 0, 8, 8, 0)
        if again:
            _define(screen.gl, _image(4, 4), 1, internal=internal)
        _quad(screen.gl)
        assert again == any(isinstance(command, HostStep) for command in screen.gl.commands)
        pictures.append(screen.picture())
        assert not refusals(screen.gl)
    np.testing.assert_array_equal(*pictures)


def test_a_copied_level_leaves_the_others():
    screen, image, own = Screen(), _image(8, 8), _image(4, 4, seed=2)
    _painted(screen, image)
    _nearest(screen.gl)
    _define(screen.gl, own, 1)
    screen.gl.CopyTexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 0, 0, 8, 8, 0)
    _shows(screen, image)
    screen.gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_BASE_LEVEL, 1)
    _shows(screen, own.repeat(2, 0).repeat(2, 1))


def test_levels_are_copied_one_by_one():
    screen, image = Screen(), _image(8, 8)
    _painted(screen, image)
    screen.gl.BindTexture(GL.TEXTURE_2D, 1)
    for level, edge in enumerate((8, 4, 2, 1)):
        screen.gl.CopyTexImage2D(GL.TEXTURE_2D, level, GL.RGBA, 0, 0, edge, edge, 0)
    screen.gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_MIN_FILTER, GL.NEAREST_MIPMAP_NEAREST)
    screen.gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_MAG_FILTER, GL.NEAREST)
    for level, edge in enumerate((8, 4, 2, 1)):
        screen.gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_BASE_LEVEL, level)
        _shows(screen, image[:edge, :edge].repeat(8 // edge, 0).repeat(8 // edge, 1))


def test_mipmaps_of_copies_are_made_by_the_machine():
    screen, image = Screen(), _image(8, 8)
    _painted(screen, image)
    screen.gl.BindTexture(GL.TEXTURE_2D, 1)
    screen.gl.TexParameteri(GL.TEXTURE_2D, GL.GENERATE_MIPMAP, 1)
    screen.gl.CopyTexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 0, 0, 8, 8, 0)
    screen.gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_MAG_FILTER, GL.NEAREST)
    levels = pyramid(image[None])
    for patch in (False, True):
        if patch:  # a client's image makes the smaller levels anew as well
            image = image.copy()
            image[:4, :4] = 255
            white = np.full((4, 4, 4), 255, np.uint8)
            screen.gl.TexSubImage2D(GL.TEXTURE_2D, 0, 0, 0, 4, 4, GL.RGBA, GL.UNSIGNED_BYTE, white)
            levels = pyramid(image[None])
        for level in (1, 2, 0):
            screen.gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_BASE_LEVEL, level)
            times = 8 // levels[level].shape[1]
            _shows(screen, levels[level][0].repeat(times, 0).repeat(times, 1))
            _painted(screen, image)
            screen.gl.BindTexture(GL.TEXTURE_2D, 1)


def test_the_faces_of_a_cube_map_are_copied_one_by_one():
    screen, image = Screen(), _image(8, 8)
    _painted(screen, image)
    _nearest(screen.gl, GL.TEXTURE_CUBE_MAP, 2)
    for face, target in enumerate(_FACES):
        screen.gl.CopyTexImage2D(target, 0, GL.RGBA, face, 0, 1, 1, 0)
    gl = screen.gl
    gl.Disable(GL.TEXTURE_2D)
    gl.Enable(GL.TEXTURE_CUBE_MAP)
    gl.TexEnvi(GL.TEXTURE_ENV, GL.TEXTURE_ENV_MODE, GL.REPLACE)
    for face, direction in enumerate(np.concatenate([[s, -s] for s in np.eye(3)])):
        gl.TexCoord3f(*direction)
        gl.Rectf(-1, -1, 1, 1)
        np.testing.assert_array_equal(screen.picture(), np.broadcast_to(image[0, face], (8, 8, 4)))
    assert not refusals(gl)


def test_what_lies_outside_the_window_stays_as_it_is():
    screen, image, own = Screen(), _image(8, 8), _image(8, 8, seed=3)
    _nearest(screen.gl)
    _define(screen.gl, own)
    _painted(screen, image)
    _nearest(screen.gl)
    screen.gl.CopyTexSubImage2D(GL.TEXTURE_2D, 0, 0, 0, -2, 5, 8, 8)
    expected = own.copy()
    expected[:3, 2:8] = image[5:, :6]
    _shows(screen, expected)


def test_a_copy_is_known_to_the_windows_machine_alone():
    screen = Screen()
    _painted(screen, _image(8, 8))
    _nearest(screen.gl)
    screen.gl.CopyTexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 0, 0, 8, 8, 0)
    screen.gl.drawable = Drawable(8, 8)
    _quad(screen.gl)
    sentence = "glEnd: texture 1 was copied from another window's framebuffer"
    assert counted(screen.gl, "refused") == [(sentence, 1)]


def test_depths_are_copied():
    screen = Screen()
    gl = screen.gl
    gl.Enable(GL.DEPTH_TEST)
    gl.Clear(GL.DEPTH_BUFFER_BIT)
    gl.RasterPos3f(0, 0, 0)
    gl.Begin(GL.QUADS)
    for x, y in ((-1, -1), (0, -1), (0, 1), (-1, 1)):
        gl.Vertex3f(x, y, 0.0)
    gl.End()
    gl.Disable(GL.DEPTH_TEST)
    _nearest(gl)
    gl.CopyTexImage2D(GL.TEXTURE_2D, 0, GL.DEPTH_COMPONENT24, 0, 0, 8, 8, 0)
    gl.TexParameteri(GL.TEXTURE_2D, GL.DEPTH_TEXTURE_MODE, GL.LUMINANCE)
    _quad(gl)
    picture = screen.picture()
    assert (picture[0, 1, 0], picture[0, 6, 0]) == (127, 255)
    assert not refusals(gl)


def test_copies_that_opengl_refuses():
    gl = context()
    gl.CopyTexSubImage2D(GL.TEXTURE_2D, 0, 0, 0, 0, 0, 4, 4)
    gl.CopyTexImage2D(GL.TEXTURE_2D, 0, 3, 0, 0, 4, 4, 0)
    gl.CopyTexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 0, 0, 5, 4, 0)
    _define(gl, _image(4, 4))
    gl.CopyTexSubImage2D(GL.TEXTURE_2D, 0, 1, 0, 0, 0, 4, 4)
    gl.TexSubImage2D(GL.TEXTURE_2D, 0, -1, 0, 4, 4, GL.RGBA, GL.UNSIGNED_BYTE, bytes(64))
    kinds = [what.split(", ")[0].split(": ")[1] for what, _ in counted(gl, "error")]
    value = "GL_INVALID_VALUE"
    assert kinds == ["GL_INVALID_OPERATION", "GL_INVALID_ENUM", value, value, value]
    assert not gl.commands


def test_a_copied_frame_on_the_ideal_machine():
    """A HostStep there gets real numbers, and the texture keeps them."""
    gl = context("IDEAL", 8, 8)
    gl.ClearColor(1 / 3, 0.5, 1 / 7, 1)
    gl.Clear(GL.COLOR_BUFFER_BIT)
    _nearest(gl)
    gl.CopyTexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 0, 0, 8, 8, 0)
    gl.TexSubImage2D(GL.TEXTURE_2D, 0, 0, 0, 1, 1, GL.RGBA, GL.FLOAT, np.float32([0.1, 0.2, 0.3, 1]))
    _quad(gl)
    result = execute_ideal(gl.take_commands(), 8, 8)
    np.testing.assert_allclose(result.color[-1, 1], (1 / 3, 0.5, 1 / 7, 1), rtol=1e-12)
    np.testing.assert_allclose(result.color[-1, 0], np.float32([0.1, 0.2, 0.3, 1]), rtol=1e-12)


# ----------------------------------------------------------------------------- compressed images and palettes


@pytest.mark.parametrize(
    ("token", "stored"),
    [
        (GL.COMPRESSED_RGBA_S3TC_DXT1_EXT, InternalFormat.COMPRESSED_RGBA_S3TC_DXT1),
        (GL.COMPRESSED_RGBA_S3TC_DXT3_EXT, InternalFormat.COMPRESSED_RGBA_S3TC_DXT3),
        (GL.COMPRESSED_RGBA_S3TC_DXT5_EXT, InternalFormat.COMPRESSED_RGBA_S3TC_DXT5),
    ],
)
def test_compressed_images_are_their_blocks(token, stored):
    gl, size = context(), 8 if stored is InternalFormat.COMPRESSED_RGBA_S3TC_DXT1 else 16
    data = np.random.default_rng(0).integers(0, 256, 6 * size, np.uint8).tobytes()
    gl.CompressedTexImage2D(GL.TEXTURE_2D, 0, token, 8, 8, 0, 4 * size, data[: 4 * size])
    gl.CompressedTexImage2D(GL.TEXTURE_2D, 1, token, 4, 4, 0, size, data[4 * size : 5 * size])
    expected = compressed_texture(data, stored, 8, 8, 2)
    texture = _stored(gl)
    assert texture.internal_format is stored
    for found, made in zip(texture.levels, expected.levels, strict=True):
        np.testing.assert_array_equal(found, made)
    block = data[5 * size :]
    gl.CompressedTexSubImage2D(GL.TEXTURE_2D, 0, 4, 0, 4, 4, token, size, block)
    whole = compressed_texture(data[:size] + block + data[2 * size : 4 * size], stored, 8, 8)
    np.testing.assert_array_equal(_stored(gl).levels[0], whole.levels[0])
    assert not refusals(gl)


def test_compressed_images_without_alpha_are_opaque():
    gl = context()
    transparent = bytes((0, 0, 255, 255)) + b"\xff" * 4  # the first end is the smaller one: code 3 is nothing
    for token, alpha in ((GL.COMPRESSED_RGBA_S3TC_DXT1_EXT, 0), (GL.COMPRESSED_RGB_S3TC_DXT1_EXT, 255)):
        gl.CompressedTexImage2D(GL.TEXTURE_2D, 0, token, 4, 4, 0, 8, transparent)
        np.testing.assert_array_equal(_stored(gl).levels[0][0, 0, 0], (0, 0, 0, alpha))


def test_compressed_images_that_opengl_refuses():
    gl, token = context(), GL.COMPRESSED_RGBA_S3TC_DXT1_EXT
    gl.CompressedTexImage2D(GL.TEXTURE_2D, 0, token, 8, 8, 0, 31, bytes(31))
    gl.CompressedTexImage2D(GL.TEXTURE_2D, 0, token, 8, 8, 0, 32, bytes(32))
    gl.CompressedTexSubImage2D(GL.TEXTURE_2D, 0, 2, 0, 4, 4, token, 8, bytes(8))
    gl.CompressedTexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 8, 8, 0, 32, bytes(32))
    gl.CompressedTexImage2D(GL.TEXTURE_2D, 0, token, 8, 8, 0, 32, bytes(30))
    kinds = [what.split(", ")[0].split(": ")[1] for what, _ in counted(gl, "error")]
    assert kinds == ["GL_INVALID_VALUE", "GL_INVALID_OPERATION", "GL_INVALID_ENUM"]
    assert counted(gl, "refused") == [
        ("glCompressedTexImage2D: 30 bytes of memory are known, and its image takes 32", 1)
    ]


def test_palettes_give_indices_their_colours():
    screen = Screen()
    gl, indices = screen.gl, np.arange(64, dtype=np.uint8).reshape(8, 8)
    palettes = _image(16, seed=1), _image(64, seed=2)
    _nearest(gl)
    gl.TexImage2D(GL.TEXTURE_2D, 0, GL.COLOR_INDEX8_EXT, 8, 8, 0, GL.COLOR_INDEX, GL.UNSIGNED_BYTE, indices)
    gl.Enable(GL.TEXTURE_2D)
    assert not gl.state().texture_units  # without a palette it is incomplete
    gl.ColorTableEXT(GL.TEXTURE_2D, GL.RGBA, 16, GL.RGBA, GL.UNSIGNED_BYTE, palettes[0])
    _shows(screen, palettes[0][indices & 15])  # high bits of an index are ignored
    gl.ColorTableEXT(GL.SHARED_TEXTURE_PALETTE_EXT, GL.RGBA, 64, GL.RGBA, GL.UNSIGNED_BYTE, palettes[1])
    _shows(screen, palettes[0][indices & 15])
    gl.Enable(GL.SHARED_TEXTURE_PALETTE_EXT)
    _shows(screen, palettes[1][indices])
    gl.ColorSubTableEXT(GL.SHARED_TEXTURE_PALETTE_EXT, 3, 2, GL.RGBA, GL.UNSIGNED_BYTE, bytes(8))
    palettes[1][3:5] = 0
    _shows(screen, palettes[1][indices])
    gl.PushAttrib(GL.TEXTURE_BIT)
    gl.Disable(GL.SHARED_TEXTURE_PALETTE_EXT)
    _shows(screen, palettes[0][indices & 15])
    gl.PopAttrib()
    _shows(screen, palettes[1][indices])
    gl.Disable(GL.SHARED_TEXTURE_PALETTE_EXT)
    gl.TexSubImage2D(GL.TEXTURE_2D, 0, 0, 0, 1, 1, GL.COLOR_INDEX, GL.UNSIGNED_BYTE, b"\x05")
    indices[0, 0] = 5
    _shows(screen, palettes[0][indices & 15])


def test_a_palette_without_alpha_makes_an_opaque_texture():
    gl = context()
    gl.TexImage2D(GL.TEXTURE_2D, 0, GL.COLOR_INDEX8_EXT, 1, 1, 0, GL.COLOR_INDEX, GL.UNSIGNED_BYTE, b"\x01")
    gl.ColorTableEXT(GL.TEXTURE_2D, GL.RGB, 2, GL.RGBA, GL.UNSIGNED_BYTE, bytes((1, 2, 3, 4, 5, 6, 7, 8)))
    texture = _stored(gl)
    assert texture.internal_format is InternalFormat.RGB8
    assert texture.levels[0].ravel().tolist() == [5, 6, 7, 255]


# ---------------------------------------------------------------------------------------- proxies and queries


def test_a_proxy_says_whether_a_texture_would_fit():
    gl = context("GEFORCE_256")
    for width, expected in ((2048, 2048), (4096, 0), (5, 0), (64, 64)):
        gl.TexImage2D(GL.PROXY_TEXTURE_2D, 0, GL.RGB5, width, 4, 0, GL.RGB, GL.UNSIGNED_BYTE, None)
        assert level_parameter(gl, GL.PROXY_TEXTURE_2D, 0, GL.TEXTURE_WIDTH) == expected
    assert level_parameter(gl, GL.PROXY_TEXTURE_2D, 0, GL.TEXTURE_GREEN_SIZE) == 5
    assert not refusals(gl)
    assert not gl.shared.textures or not bound_object(gl, GL.TEXTURE_2D).images


@pytest.mark.parametrize(
    ("internal", "expected"),
    [
        (GL.RGBA, {"RED_SIZE": 8, "ALPHA_SIZE": 8, "LUMINANCE_SIZE": 0, "INTERNAL_FORMAT": GL.RGBA}),
        (3, {"RED_SIZE": 8, "ALPHA_SIZE": 0, "INTERNAL_FORMAT": 3}),
        (GL.RGB5_A1, {"RED_SIZE": 5, "ALPHA_SIZE": 1, "COMPRESSED": False}),
        (GL.LUMINANCE4_ALPHA4, {"LUMINANCE_SIZE": 4, "ALPHA_SIZE": 4, "RED_SIZE": 0}),
        (GL.INTENSITY8, {"INTENSITY_SIZE": 8, "LUMINANCE_SIZE": 0, "WIDTH": 4, "HEIGHT": 2, "BORDER": 0}),
    ],
)
def test_what_an_image_says_of_itself(internal, expected):
    gl = context()
    _define(gl, _image(2, 4), internal=internal)
    for name, value in expected.items():
        assert level_parameter(gl, GL.TEXTURE_2D, 0, getattr(GL, "TEXTURE_" + name)) == value
    assert level_parameter(gl, GL.TEXTURE_2D, 1, GL.TEXTURE_WIDTH) == 0
