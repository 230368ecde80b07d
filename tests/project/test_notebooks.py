"""The notebooks of docs/examples: every cell runs, and shows what is saved, text and pixels alike."""

import base64
import io
import re

import nbformat
import numpy as np
import pytest
from PIL import Image

from tests import notebooks

ROOT = notebooks.ROOT
LARGEST = 300_000  # bytes of a file: what a forge shows at once, and a repository keeps for each change
each_notebook = pytest.mark.parametrize("path", notebooks.NOTEBOOKS, ids=lambda path: path.stem)


def saved(path):
    return nbformat.read(path, as_version=4)


def test_they_are_there():
    assert [path.stem for path in notebooks.NOTEBOOKS] == [
        "figure_varied",
        "from_equation_to_figure",
        "golden_tests",
        "heights_to_brdf",
        "program_of_2001",
        "where_a_ring_comes_from",
    ]


@each_notebook
def test_every_cell_shows_what_is_saved(path):
    kept = saved(path)
    sources = [cell.source for cell in kept.cells if cell.cell_type == "code"]
    found = notebooks.said(notebooks.executed(path))
    for source, before, now in zip(sources, notebooks.said(kept), found, strict=True):
        assert now == before, f"`make notebooks` saves what this cell shows now:\n{source}"


@each_notebook
def test_a_stranger_sees_all_of_it_without_running(path):
    kept = saved(path)
    nbformat.validate(kept)
    assert path.stat().st_size < LARGEST
    code = [cell for cell in kept.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    kinds = [kind for cell in notebooks.said(kept) for kind, _ in cell]
    assert "image/png" in kinds and "stderr" not in kinds


@each_notebook
def test_its_links_lead_somewhere(path):
    text = "\n".join(cell.source for cell in saved(path).cells if cell.cell_type == "markdown")
    for target in re.findall(r"\]\(([^)#\s]+)", text):
        assert target.startswith("http") or (path.parent / target).exists(), target


def shows(kind, data, name="a picture"):
    """A notebook with one cell, which shows that."""
    if kind == "stdout":
        output = nbformat.v4.new_output("stream", name="stdout", text=data)
    else:
        output = nbformat.v4.new_output("display_data", data={kind: data, "text/plain": name})
    return nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("", outputs=[output])])


def encoded(pixels, **how):
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG", **how)
    return base64.b64encode(file.getvalue()).decode()


def test_a_digit_and_a_pixel_are_seen_and_how_a_file_is_packed_is_not():
    assert notebooks.said(shows("stdout", "1.36\n")) != notebooks.said(shows("stdout", "1.37\n"))
    pixels = np.zeros((8, 8, 3), np.uint8)
    kept = notebooks.said(shows("image/png", encoded(pixels)))
    assert kept == notebooks.said(shows("image/png", encoded(pixels, compress_level=0)))
    pixels[3, 4, 1] = 1
    assert kept != notebooks.said(shows("image/png", encoded(pixels)))
    plots = [shows("image/png", encoded(p), "<Figure size 5x3 with 1 Axes>") for p in (pixels, pixels[1:])]
    assert notebooks.said(plots[0]) == notebooks.said(plots[1])


def test_what_is_said_while_kernels_compile_is_no_output():
    text = "fixedpipe compiles its kernels for this machine.\ncompiling kernel 3 of 7: _distance\n"
    told, silent = (nbformat.v4.new_output("stream", text=said) for said in (f"1\n{text}2\n", text))
    assert notebooks.is_said(told) and told.text == "1\n2\n"
    assert not notebooks.is_said(silent)
