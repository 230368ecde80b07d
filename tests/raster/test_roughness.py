"""Lookups filtered by roughness: every engine equals the specification; a bumped plane mirrors a panorama."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    DotProductMapping,
    PrimitiveType,
    TextureEnvironmentMode,
    TextureFilter,
    VertexStage,
    WrapMode,
)
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.notations.texture_shaders import format_stages
from fixedpipe.pipeline.profiles import NV2A, SCHILLING, TEXRAM
from fixedpipe.pipeline.state import (
    PassState,
    Sampler,
    SignedComponents,
    TextureEnvironment,
    TextureShaderStage,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.support.run_reference import run_reference
from tests.support.strategies import seeds

WIDTH, HEIGHT = 16, 8
NONE = TextureEnvironment(TextureEnvironmentMode.NONE)
REPLACE = TextureEnvironment(TextureEnvironmentMode.REPLACE)
SIGNED = SignedComponents(True, True, True, True)
TRILINEAR = Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR)
STAGES = {
    "offset": (
        TextureShaderStage(Operation.TEXTURE_2D),
        TextureShaderStage(Operation.TEXTURE_2D),
        TextureShaderStage(Operation.OFFSET_TEXTURE_2D, roughness=1),
    ),
    "dot products": (
        TextureShaderStage(Operation.TEXTURE_2D),
        TextureShaderStage(Operation.TEXTURE_2D),
        TextureShaderStage(Operation.DOT_PRODUCT),
        TextureShaderStage(Operation.DOT_PRODUCT_TEXTURE_2D, roughness=1),
    ),
}


def random_frame(seed, kind):
    """A few random triangles whose last unit reads an environment through random bumps and roughness."""
    random = np.random.default_rng(seed)
    sizes = 1 << random.integers(0, 5, (3, 2))
    images = [
        TexImage(
            label=name,
            texture=name,
            image=texture_2d(random.integers(0, 256, (*size, 4), np.uint8), mipmaps=True),
        )
        for name, size in zip(("bumps", "roughness", "panorama"), sizes.tolist(), strict=True)
    ]
    filters = TextureFilter(int(random.integers(6))), TextureFilter(int(random.integers(2)))
    probes = {"max_probes": int(random.choice([1, 1, 2, 4, 8]))}
    if random.random() < 0.3:
        probes = {"max_probes": int(random.integers(2, 9)), "exact_probes": True}
    sampler = Sampler(
        *filters,
        *(WrapMode(int(m)) for m in random.choice([WrapMode.REPEAT, WrapMode.CLAMP_TO_EDGE], 2)),
        **probes,
        min_lod=float(random.choice([-1000.0, 0.5])),
    )
    signs = SIGNED if random.random() < 0.7 else SignedComponents()
    stages = tuple(
        replace(
            stage,
            offset_texture_matrix=tuple((random.uniform(-1, 1, 4) * random.choice([0.0, 0.1, 2.0])).tolist()),
            dot_product_mapping=DotProductMapping(
                int(random.choice(sorted(SCHILLING.texture_shaders.dot_product_mappings)))
            ),
            roughness_scale=float(random.choice([0.0, 0.01, 1.0])),
        )
        for stage in STAGES[kind]
    )
    names = ("bumps", "roughness", *(None,) * (len(stages) - 3), "panorama")
    units = tuple(
        TextureUnit(
            name,
            sampler
            if name == "panorama"
            else replace(TRILINEAR, signed_components=signs)
            if name == "bumps"
            else TRILINEAR,
            environment=REPLACE if name == "panorama" else NONE,
            coordinates=k,
        )
        for k, name in enumerate(names)
    )
    units = (*units[:-1], replace(units[-1], lod_bias=0.0))
    count = 9
    w = random.choice([1.0, 1.0, 2.0], count)
    positions = np.column_stack(
        [random.uniform(0, WIDTH, count), random.uniform(0, HEIGHT, count), np.zeros(count), w]
    )
    sets = tuple(
        random.uniform(-1, 1, (count, 4)) * random.choice([0.0, 0.1, 1.0, 4.0], 4) for _ in range(len(stages))
    )
    for coordinates in sets:
        coordinates[:, 3] = random.choice([1.0, 1.0, 2.0], count)
    state = PassState(
        vertex=VertexState(stage=VertexStage.PROGRAM_RESULTS), texture_units=units, texture_shader=stages
    )
    mesh = Mesh(positions, PrimitiveType.TRIANGLES, texture_coordinates=sets)
    return (*images, Draw(label="rough", mesh=mesh, state=state))


@pytest.mark.parametrize("kind", STAGES)
@given(seed=seeds, batch=st.sampled_from((16, 17, 256)))
def test_lookups_filtered_by_roughness_equal_the_specification(kind, seed, batch):
    commands = random_frame(seed, kind)
    expected = np.array(run_reference(commands, SCHILLING, WIDTH, HEIGHT, 24).target.color)
    for engine in (None, "portable", "columns"):
        got = execute(
            commands, SCHILLING, WIDTH, HEIGHT, depth_bits=24, threads=1, batch=batch, engine=engine
        )
        np.testing.assert_array_equal(got.framebuffer.color, expected, err_msg=str(engine))


# ------------------------------------------------------------------------------- a plane, and what it mirrors


def mirror(bumps, rough, panorama, scale=1.0, probes=8, filtered=True, jacobian=(0.25, 0.0, 0.0, 0.25)):
    """A square that reads a panorama through bumps (x, y, 1): signed bytes [r, c, 3], D as bytes [r, c, 3].

    ``jacobian``: s's derivatives by x and y, then t's. The lookup without bumps crosses the panorama once.
    """

    def opaque(texels):
        return texture_2d(np.concatenate([texels, np.full((*texels.shape[:2], 1), 255)], 2).astype(np.uint8))

    near = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)
    wide = near
    if filtered:
        wide = Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR, max_probes=probes)
    signed = replace(near, signed_components=SIGNED)
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    st_, ones = 0.5 * square + 0.5, np.ones((4, 1))
    rows = tuple(
        np.concatenate([np.tile(pair, (4, 1)), st_[:, k : k + 1], ones], axis=1)
        for k, pair in enumerate((jacobian[:2], jacobian[2:]))
    )
    units = (
        TextureUnit("bumps", signed, environment=NONE),
        TextureUnit("roughness", near, environment=NONE),
        TextureUnit(None, environment=NONE, coordinates=1),
        TextureUnit("panorama", wide, environment=REPLACE, coordinates=2),
    )
    reads = {"previous_texture_input": 0, "dot_product_mapping": DotProductMapping.SIGNED_IDENTITY}
    stages = (
        TextureShaderStage(Operation.TEXTURE_2D),
        TextureShaderStage(Operation.TEXTURE_2D),
        TextureShaderStage(Operation.DOT_PRODUCT, **reads),
        TextureShaderStage(
            Operation.DOT_PRODUCT_TEXTURE_2D,
            **reads,
            roughness=1 if filtered else None,
            roughness_scale=scale,
        ),
    )
    mesh = Mesh(square, PrimitiveType.QUADS, texture_coordinates=(st_, *rows))
    images = (
        ("bumps", opaque(bumps)),
        ("roughness", opaque(rough)),
        ("panorama", texture_2d(panorama, mipmaps=True)),
    )
    return (
        *(TexImage(label=name, texture=name, image=image) for name, image in images),
        Draw(label="mirror", mesh=mesh, state=PassState(texture_units=units, texture_shader=stages)),
    )


SMOOTH = np.tile(np.array([0, 128, 0]), (1, 1, 1))
FLAT = np.tile(np.array([0, 0, 127]), (1, 1, 1))


def stripes(across_s, side=64, width=4):
    """Stripes of so many texels, black and white, that follow each other along s or along t."""
    bands = np.broadcast_to((np.arange(side) // width % 2) * 255, (side, side))
    bands = bands if across_s else bands.T
    return np.stack([bands, bands, bands, np.full_like(bands, 255)], axis=2).astype(np.uint8)


def picture(commands, side=64, draw=execute):
    if draw is execute_ideal:
        return 255.0 * draw(commands, width=side, height=side).color[..., 0]
    return draw(commands, SCHILLING, side, side).framebuffer.color[..., 0].astype(float)


def test_without_roughness_a_bumped_plane_is_the_stage_without_the_field():
    """D = 0, a pixel a texel: the level is 0, one probe; so is what a stage without roughness reads."""
    random = np.random.default_rng(3)
    bumps = np.concatenate([random.integers(-100, 101, (8, 8, 2)), np.full((8, 8, 1), 127)], 2) & 255
    panorama = random.integers(0, 256, (64, 64, 4), np.uint8)
    given = mirror(bumps, SMOOTH, panorama)
    *images, draw = given
    panorama_unit = replace(
        draw.state.texture_units[3], sampler=Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR)
    )
    stages = (*draw.state.texture_shader[:3], replace(draw.state.texture_shader[3], roughness=None))
    plain = replace(
        draw,
        state=replace(
            draw.state, texture_units=(*draw.state.texture_units[:3], panorama_unit), texture_shader=stages
        ),
    )
    np.testing.assert_array_equal(picture(given), picture((*images, plain)))


@pytest.mark.parametrize("engine", [execute, execute_ideal])
def test_rough_along_one_axis_blurs_that_axis_alone(engine):
    """D = (d_1, 0, 0) moves lookups along s alone: stripes that follow each other along t stay, those along s
    go grey; one probe, at the longer axis's level, loses both.
    """
    rough = np.tile(np.array([255, 128, 0]), (1, 1, 1))
    contrast = {
        (across_s, probes): np.ptp(
            picture(mirror(FLAT, rough, stripes(across_s), 0.25, probes), draw=engine)[8:-8, 8:-8]
        )
        for across_s in (True, False)
        for probes in (1, 8)
    }
    assert contrast[False, 8] == 255
    assert contrast[True, 8] <= 8
    assert contrast[True, 1] <= 8 and contrast[False, 1] <= 8


def test_roughness_of_both_components_spreads_a_step_by_two_deviations():
    """A panorama's step along s through D with d_1 and d_2: beside a ramp as wide as two deviations of s."""
    side, scale, codes = 64, 0.4, np.array([128, 255, 160])
    panorama = np.zeros((side, side, 4), np.uint8)
    panorama[:, side // 2 :] = 255
    got = picture(mirror(FLAT, np.tile(codes, (1, 1, 1)), panorama, scale))[side // 2]
    d_1, d_2 = codes[0] / 255 * scale, (codes[1] - 128) / 127 * scale
    deviation = 0.25 * np.hypot(d_1, d_2) * side
    x = np.arange(side) + 0.5 - side / 2
    truth = 255 * np.clip(0.5 + x / (2 * deviation), 0, 1)
    inside = slice(side // 4, 3 * side // 4)
    assert np.abs(got - truth)[inside].mean() < 12
    assert np.abs(got - truth)[inside].max() < 40


def test_what_goes_with_no_roughness_is_refused():
    *images, draw = mirror(FLAT, SMOOTH, stripes(True))

    def refuse(words, profile=SCHILLING, at=3, sampler=None, **changes):
        stages, units = list(draw.state.texture_shader), list(draw.state.texture_units)
        stages[at] = replace(stages[at], **changes)
        if sampler is not None:
            units[at] = replace(units[at], sampler=sampler)
        state = replace(draw.state, texture_shader=tuple(stages), texture_units=tuple(units))
        with pytest.raises(UnsupportedState, match=words):
            validate((*images, replace(draw, state=state)), profile, WIDTH, HEIGHT)

    refuse("filters no lookup by roughness", NV2A)
    refuse("which no roughness filters", at=2, roughness=1)
    refuse("give it an earlier stage", roughness=2)
    refuse("give it an earlier stage", roughness=3)
    refuse("give it an earlier stage", roughness=-1)
    for scale in (float("nan"), float("inf"), -1.0):
        refuse("roughness_scale", roughness_scale=scale)
    refuse(
        "set max_probes to 1", roughness=None, sampler=Sampler(max_probes=8, min_filter=TextureFilter.LINEAR)
    )
    refuse("have no level of detail here", roughness=None)
    refuse("takes up to 8", sampler=Sampler(max_probes=16))
    assert not TEXRAM.texture_shaders.roughness_lookups


def test_the_notation_says_that_it_has_no_word_for_roughness():
    with pytest.raises(ValueError, match="stage 3 is filtered by roughness"):
        format_stages(mirror(FLAT, SMOOTH, stripes(True))[-1].state.texture_shader)
