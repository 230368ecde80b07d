"""210 pixel transfers beside what SGI's OpenGL Sample Implementation 1.2.1 gave for them.

The data lie in the folder `shared` (`foreign/imaging/pixel-path.json.gz`), not here. They were chosen among
transfers on which both agree, after faults of that implementation that its own specification contradicts
were put aside: the test is a net under what works, not evidence for it.
"""

import gzip
import json

import numpy as np
import pytest

from fixedpipe.pipeline.commands import DrawPixels, GetTexImage, ReadPixels, TexImage
from fixedpipe.pipeline.enums import BaseFormat, ConvolutionBorderMode, InternalFormat, TextureTarget
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.pixel_transfer import (
    ConvolutionFilter,
    Histogram,
    Minmax,
    PixelImage,
    PixelMaps,
    PixelTransfer,
    SeparableFilter,
)
from fixedpipe.pipeline.profiles import OPENGL_1_2_IMAGING
from fixedpipe.pipeline.state import ColorTable, RasterPosition

SIZE = 64
CASES = 210
LOWER_LEFT = RasterPosition(position=(0.0, 0.0, 0.0, 1.0), window=True)
DTYPES = {
    "UNSIGNED_BYTE": np.uint8,
    "UNSIGNED_SHORT": np.uint16,
    "UNSIGNED_INT": np.uint32,
    "FLOAT": np.float32,
}
# As what GetTexImage gave an internal format's components.
QUERIED = {
    "ALPHA8": "ALPHA",
    "LUMINANCE8": "LUMINANCE",
    "LUMINANCE8_ALPHA8": "LUMINANCE_ALPHA",
    "INTENSITY8": "RED",
    "RGB8": "RGB",
    "RGBA8": "RGBA",
}
# The file's short names of a PixelTransfer's fields.
NUMBERS = {
    "scale": "scale",
    "bias": "bias",
    "pcs": "post_convolution_scale",
    "pcb": "post_convolution_bias",
    "matrix": "color_matrix",
    "pms": "post_color_matrix_scale",
    "pmb": "post_color_matrix_bias",
}
TABLES = {
    "ct0": "color_table",
    "ct1": "post_convolution_color_table",
    "ct2": "post_color_matrix_color_table",
}
FILTERS = {"c1": "convolution_1d", "c2": "convolution_2d", "sep": "separable_2d"}
# Extremes and pixels read as floats are single precision there, and products of the data about 1.
SINGLE = {"rtol": 2e-6, "atol": 2e-6}


def numbers(value):
    """Nested lists as tuples, of what single precision holds: that implementation kept no more."""
    return tuple(map(numbers, value)) if isinstance(value, list) else float(np.float32(value))


def filter_of(given):
    border = ConvolutionBorderMode[given["border"]], numbers(given["border_color"])
    rest = BaseFormat[given["format"]], *border
    if "row" in given:
        return SeparableFilter(numbers(given["row"]), numbers(given["column"]), *rest)
    return ConvolutionFilter(numbers(given["rows"]), *rest)


def transfer_of(given):
    """The PixelTransfer that a case of the file describes."""
    fields = {name: numbers(given[short]) for short, name in NUMBERS.items() if short in given}
    for short, name in TABLES.items():
        if short in given:
            table = given[short]
            fields[name] = ColorTable(numbers(table["entries"]), BaseFormat[table["format"]])
    for short, name in FILTERS.items():
        if short in given:
            fields[name] = filter_of(given[short])
    if "maps" in given:
        fields["maps"] = PixelMaps(**{name: numbers(table) for name, table in given["maps"].items()})
    if table := given.get("hist"):
        fields["histogram"] = Histogram("h", table["width"], BaseFormat[table["format"]], table["sink"])
    if table := given.get("mm"):
        fields["minmax"] = Minmax("m", BaseFormat[table["format"]], table["sink"])
    return PixelTransfer(map_color=given.get("map_color", False), **fields)


def run(*commands):
    return execute(commands, OPENGL_1_2_IMAGING, SIZE, SIZE, threads=1)


def found_by(case):
    """What the machine gives for a case: its pixels, or None where a sink took them, and the Result."""
    transfer = transfer_of(case["transfer"])
    if case["op"] == "ReadPixels":  # of bytes that are drawn before
        values = np.array(case["values"], np.uint8)
        read = ReadPixels(
            label="read",
            name="r",
            format=case["format"],
            type=case["type"],
            width=values.shape[1],
            height=values.shape[0],
            transfer=transfer,
        )
        result = run(DrawPixels(label="draw", image=PixelImage(values), position=LOWER_LEFT), read)
        return result.pixels.get("r"), result
    image = PixelImage(np.array(case["values"], DTYPES[case["type"]]), case["format"])
    if case["op"] == "DrawPixels":
        result = run(DrawPixels(label="draw", image=image, position=LOWER_LEFT, transfer=transfer))
        return result.image()[::-1], result
    result = run(
        TexImage(
            label="load",
            texture="t",
            pixels=image,
            target=TextureTarget[f"TEXTURE_{case['op'][-2:]}"],
            internal_format=InternalFormat[case["internal"]],
            transfer=transfer,
        ),
        GetTexImage(label="query", name="q", texture="t", format=QUERIED[case["internal"]]),
    )
    return result.pixels["q"], result


def is_as_expected(case, expected):
    pixels, result = found_by(case)
    equal = True
    if "pixels" in expected:
        meant = np.array(expected["pixels"])
        if case["op"] == "DrawPixels":  # the rectangle that was drawn
            pixels = pixels[: meant.shape[0], : meant.shape[1]]
        pixels = pixels.reshape(meant.shape)
        floats = case["op"] == "ReadPixels" and case["type"] == "FLOAT"
        equal &= np.allclose(pixels, meant, **SINGLE) if floats else bool((pixels == meant).all())
    if "hist" in expected:
        equal &= result.histograms["h"].counts.tolist() == expected["hist"]
    if "mm" in expected:
        equal &= np.allclose(result.minmaxes["m"].extremes, expected["mm"], **SINGLE)
    return equal


@pytest.mark.needs_shared
def test_210_pixel_transfers_are_as_the_sample_implementation_s(shared):
    path = shared / "foreign" / "imaging" / "pixel-path.json.gz"
    if not path.exists():
        pytest.skip(f"the folder `shared` has no {path.relative_to(shared)}")
    with gzip.open(path, "rt") as file:
        cases = json.load(file)
    assert len(cases) == CASES
    failed = [number for number, it in enumerate(cases) if not is_as_expected(it["case"], it["expected"])]
    assert not failed
