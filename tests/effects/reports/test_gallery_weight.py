"""The gallery of all figures stays small: 35 MB, and a first view of less than 1 MB."""

import subprocess
import sys

import numpy as np
import pytest

from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.reports.figure_files import PICTURES, files_of, write_figure, write_page, write_record
from fixedpipe.effects.reports.figure_record import MOST_PIXELS, record_of, render, size_in_gallery

# What the gallery of all figures may weigh, and what a reader loads first. Source: the project's own limits.
ALL, FIRST_VIEW = 35e6, 1e6
# Thumbnails that a window of 1400 x 900 pixels shows at most, and the bytes of one that is large.
# Measured: 24 cards of the made gallery's size; 22 kB, F000-5's.
CARDS, THUMBNAIL = 24, 22e3
# One of each kind: a diagram, shadows on machines of 8 and of 12 bits, a bumpy surface.
KINDS = ("F000-6", "F003-17", "K14")


def weight(folder, figures):
    """Bytes of a gallery's files."""
    ours, _ = files_of(folder, figures)
    return sum(path.stat().st_size for path in ours)


def test_no_figure_has_more_pixels_in_the_gallery_than_there_may_be():
    for figure in FIGURES.values():
        size = size_in_gallery(figure)
        width, height = figure.dimensions(size)
        assert width * height <= MOST_PIXELS, figure.id
        if size is None:
            continue
        larger = figure.dimensions(min(figure.size, size + 16))
        assert size == figure.size or np.prod(larger) > MOST_PIXELS, figure.id


def test_figures_of_each_kind_weigh_less_than_their_share(tmp_path):
    for name in KINDS:
        figure = FIGURES[name]
        rendered = render(figure, figure.machines, size_in_gallery(figure), 1, False, lambda text: None)
        write_figure(tmp_path, rendered)
    assert weight(tmp_path, KINDS) < len(KINDS) * ALL / len(FIGURES)


def test_the_first_view_is_less_than_a_megabyte(tmp_path):
    for figure in FIGURES.values():
        record = record_of(figure, figure.machines, figure.size, {}, False, [], [])
        write_record(tmp_path, {**record, "machines": [machine_of(name) for name in figure.machines]})
    (tmp_path / PICTURES).mkdir()
    write_page(tmp_path, tuple(FIGURES))
    index = (tmp_path / "index.html").read_text()
    assert all(f'"id":"{name}"' in index for name in FIGURES)
    assert len(index.encode()) + CARDS * THUMBNAIL < FIRST_VIEW


def machine_of(name):
    """What the page asks of a machine that drew a figure."""
    return {
        "profile": name,
        "name": name,
        "method": "a way",
        "same_bits_as": None,
        "checks": [],
        "pictures": {"machine": {"digest": "0" * 16}},
        "provenance": {"fixedpipe": "0"},
    }


@pytest.mark.slow
def test_the_gallery_of_all_figures_weighs_no_more_than_35_megabytes(tmp_path):
    out = tmp_path / "out"
    command = [sys.executable, "-m", "fixedpipe.effects.cli", "figures", "--out", str(out)]
    subprocess.run(command, check=True, capture_output=True)
    drawn = {path.stem for path in out.glob("*.json")}
    assert drawn == set(FIGURES)
    assert weight(out, tuple(FIGURES)) <= ALL
