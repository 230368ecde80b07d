"""P12: which texel a coordinate of few bits reads.

The machine itself looks up each code in a texture of W texels, with NEAREST. On the Octane this is a pixel
texture, with 8 bits and with the 12 bits of its pixel groups. Texture shaders have a dependent lookup. For
other machines the host looks up the codes, as for dependent tests on the GeForce 256.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 3 (artefact P12 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.passes.draws import NEAREST, REPLACE, at_pixel, unit
from fixedpipe.effects.passes.software_pixel_texture import look_up
from fixedpipe.effects.passes.texture_shaders import ALPHA_RED_STAGE, TEXTURE_STAGE
from fixedpipe.effects.scattering.visibility_textures import codes
from fixedpipe.effects.studies.shared.strips import drawn, strip
from fixedpipe.effects.studies.study import BLUE, EXPECTED, GREEN, ORANGE, RED, Column, Study, Table
from fixedpipe.pipeline.commands import Draw, DrawPixels, TexImage
from fixedpipe.pipeline.enums import (
    InternalFormat,
    TextureEnvironmentMode,
    TextureFilter,
    TextureShaderOperation,
    WrapMode,
)
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.state import (
    PassState,
    PixelTexture,
    Sampler,
    TextureEnvironment,
)
from fixedpipe.pipeline.textures.images import texture_2d

DATA = study_data(__file__, "P12")

TEXELS = {8: (32, 64, 128, 256), 12: (256, 512, 1024, 2048)}
WRAPS = (WrapMode.REPEAT, WrapMode.CLAMP_TO_EDGE)
# Wrong texels of 256 with codes of the centres, REPEAT.  Source: the catalogue's, computed there.
EXPECTED_AT_256 = 1


def lower_codes(texels, size, bits):
    """The codes of the coordinates i / W, the texels' lower edges, rounded to the nearest."""
    one = (1 << bits) - 1
    return np.floor(one * np.asarray(texels) / size + 0.5).astype(np.int64)


# Of which place of its texel a coordinate is.
CODES = {"edge": lower_codes, "centre": codes}
# A window that keeps fewer bits than the codes have: where a pixel texture has its groups from.
NARROW = (8, 12, 512)


def _numbered(texels):
    """A texture whose texels hold their numbers: 256 G + R, where both are bytes."""
    number = np.arange(texels)
    image = np.zeros((1, texels, 4), np.uint8)
    image[0, :, 0], image[0, :, 1], image[0, :, 3] = number & 255, number >> 8, 255
    return texture_2d(image)


def _sampler(wrap):
    return Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST, wrap, wrap)


def _by_pixel_texture(stored, bits, window, table, wrap, profile):
    groups = np.zeros((1, len(stored), 3), np.uint8 if bits == 8 else np.float64)
    groups[0, :, 0] = stored if bits == 8 else stored / float((1 << bits) - 1)
    commands = (
        TexImage(label="load the texels' numbers", texture="numbers", image=table),
        DrawPixels(
            label="codes with a pixel texture",
            image=PixelImage(groups, "RGB"),
            state=PassState(texture_units=(unit("numbers", _sampler(wrap), environment=REPLACE),)),
            position=at_pixel(0, 0),
            pixel_texture=PixelTexture(),
        ),
    )
    # Groups have as many bits as the window's colours.
    return drawn(commands, profile, len(stored), 1, color_bits=window)[0]


def _by_dependent_lookup(stored, bits, window, table, wrap, profile):
    image = np.zeros((1, len(stored), 2), np.uint8)
    image[0, :, 1] = stored
    count = len(stored)
    middles = np.stack([(np.arange(count) + 0.5) / count, np.full(count, 0.5)], axis=-1)
    passes_on = TextureEnvironment(TextureEnvironmentMode.NONE)
    state = PassState(
        texture_units=(
            unit("codes", NEAREST, environment=passes_on),
            unit("numbers", _sampler(wrap), environment=REPLACE),
        ),
        texture_shader=(TEXTURE_STAGE, ALPHA_RED_STAGE),
    )
    codes_as_alpha = texture_2d(image, InternalFormat.LUMINANCE8_ALPHA8)
    commands = (
        TexImage(label="load the texels' numbers", texture="numbers", image=table),
        TexImage(label="load the codes", texture="codes", image=codes_as_alpha),
        Draw(label="a dependent lookup", mesh=strip(count, None, middles), state=state),
    )
    return drawn(commands, profile, count, 1)[0]


def _by_host(stored, bits, window, table, wrap, profile):
    pixels = np.full((1, len(stored), 4), 255, np.uint8)
    pixels[0, :, 0], pixels[0, :, 1] = stored, 0
    return look_up(pixels, table, TextureFilter.NEAREST, wrap)[0, :, :3] / 255.0


def way_of(profile):
    """A machine's way to look up: its name, the function, and how many bits codes may have."""
    if profile.pixels.pixel_texture:
        return "pixel texture", _by_pixel_texture, (8, 12)
    if TextureShaderOperation.DEPENDENT_AR_TEXTURE_2D in profile.texture_shaders.texture_shader_operations:
        return "dependent lookup", _by_dependent_lookup, (8,)
    return "the host", _by_host, (8,)


def found(place, texels, bits, wrap, profile, window=None):
    """The texel that each code leads to, in a window with the codes' bits or with ``window``: int64
    [texels].
    """
    stored = CODES[place](np.arange(texels), texels, bits)
    _, look, _ = way_of(profile)
    read = look(stored, bits, window or bits, _numbered(texels), wrap, profile)
    read = np.floor(255.0 * read + 0.5).astype(np.int64)
    return read[:, 0] + 256 * read[:, 1]


def measure(profile):
    """The table, with a row for each size, code and number of bits."""
    way, _, widths = way_of(profile)
    asked = [(bits, bits, texels, place) for bits in widths for texels in TEXELS[bits] for place in CODES]
    if 12 in widths:
        asked.append((*NARROW, "centre"))
    rows, curves = [], {}
    for window, bits, texels, place in asked:
        row = [way, bits, window, texels, place]
        for wrap in WRAPS:
            apart = found(place, texels, bits, wrap, profile, window) - np.arange(texels)
            row += [int((apart != 0).sum()), int(np.abs(apart).max())]
            curves[f"{window} {texels} {place} {wrap.name}"] = apart.astype(np.float64)
        rows.append(tuple(row))
    columns = (
        Column("looked up by"),
        Column("code", "bits", "d"),
        Column("window", "bits", "d"),
        Column("W", "texels", "d"),
        Column("code of"),
        Column("wrong, REPEAT", "texels", "d"),
        Column("worst, REPEAT", "texels", "d"),
        Column("wrong, clamped", "texels", "d"),
        Column("worst, clamped", "texels", "d"),
    )
    return Table(columns, tuple(rows), curves)


def _of(table, place, bits=8, window=None):
    asked = (place, bits, window or bits)
    return [r for r in table.records() if (r["code of"], r["code"], r["window"]) == asked]


def _wrong(rows):
    return sum(r["wrong, REPEAT"] + r["wrong, clamped"] for r in rows)


def findings(table):
    """The errors of each code, and what happens to the last texel."""
    lower, centre = (_of(table, place) for place in CODES)
    shares = [100.0 * r["wrong, clamped"] / r["W"] for r in lower]
    exact = [r["W"] for r in centre if not r["wrong, REPEAT"]]
    last = centre[-1]
    out = [
        f"The code of a texel's lower edge is i / W. It leads to the texel before for {min(shares):.0f} to "
        f"{max(shares):.0f} % of the texels, however few there are.",
        f"The code of a texel's centre is exact up to {max(exact, default=0)} texels in 8 bits. Of "
        f"{last['W']} texels, {last['wrong, REPEAT']} is wrong with REPEAT. Its code 255 is the coordinate "
        f"1, which begins again {last['worst, REPEAT']} texels away. With CLAMP_TO_EDGE "
        f"{last['wrong, clamped']} are wrong.",
    ]
    wide, narrow = _of(table, "centre", 12), _of(table, "centre", 12, 8)
    if wide:
        out.append(
            f"With 12 bits, {_wrong(wide)} texels of {wide[0]['W']} to {wide[-1]['W']} are wrong if the "
            "window has 12 bits too. In a window of 8 bits, the pixels that a pixel texture reads have 8. "
            f"Then {narrow[0]['wrong, clamped']} of {narrow[0]['W']} texels are wrong."
        )
    return tuple(out)


def checks(table):
    """The catalogue's numbers: exact up to 128 texels, one error at 256, and none with the clamp."""
    centre, lower = _of(table, "centre"), _of(table, "edge")
    last = centre[-1]
    return (
        DATA.check(
            "wrong texels of 32 to 128, centres' codes of 8 bits, both wraps",
            _wrong(r for r in centre if r["W"] <= 128),
            Answer.MACHINE,
        ),
        DATA.check(
            "wrong texels of 256, centres' codes, REPEAT, - 1: absolute",
            abs(last["wrong, REPEAT"] - EXPECTED_AT_256),
            Answer.MACHINE,
        ),
        DATA.check(
            "wrong texels of 256, centres' codes, CLAMP_TO_EDGE", last["wrong, clamped"], Answer.MACHINE
        ),
        DATA.check(
            "least share of texels that are wrong with the code of i / W, %",
            min(100.0 * r["wrong, clamped"] / r["W"] for r in lower),
            Answer.MACHINE,
        ),
        DATA.check(
            "wrong texels of 256 to 2048, centres' codes of 12 bits, both wraps",
            _wrong(_of(table, "centre", 12)),
            Answer.MACHINE,
        ),
        DATA.check(
            "wrong texels of 512, 12 bits in a window of 8, CLAMP_TO_EDGE, - 256: absolute",
            abs(_of(table, "centre", 12, 8)[0]["wrong, clamped"] - 256),
            Answer.MACHINE,
        ),
    )


def plot(axes, table):
    """Wrong texels by size, and the error of each of 256 texels."""
    by_size, by_texel = axes
    styles = (
        ("edge", "REPEAT", RED),
        ("edge", "clamped", ORANGE),
        ("centre", "REPEAT", BLUE),
        ("centre", "clamped", GREEN),
    )
    for place, wrap, color in styles:
        rows = _of(table, place)
        by_size.plot(
            [r["W"] for r in rows],
            [100.0 * r[f"wrong, {wrap}"] / r["W"] for r in rows],
            color=color,
            marker="o",
            linestyle="-" if wrap == "REPEAT" else "--",
            label=f"{place}'s code, {wrap}",
        )
    by_size.plot([256], [100.0 * EXPECTED_AT_256 / 256], label="catalogue, REPEAT", **EXPECTED)
    by_size.set_xscale("log", base=2)
    by_size.set_xlabel("texels, W; codes of 8 bits")
    by_size.set_ylabel("wrong texels, %")
    by_size.legend()
    for place, color in (("edge", ORANGE), ("centre", GREEN)):
        by_texel.plot(table.curves[f"8 256 {place} CLAMP_TO_EDGE"], color=color, label=f"{place}'s code")
    by_texel.set_xlabel("texel of 256, CLAMP_TO_EDGE")
    by_texel.set_ylabel("texel found - texel meant")
    by_texel.legend()


STUDY = Study(
    **DATA.words,
    machines=("OCTANE", "GEFORCE_3", "NV2A", "GEFORCE_256"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
