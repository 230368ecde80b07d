"""The first view of the gallery of all figures is less than 1 MB."""

from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.reports.figure_files import PICTURES, write_page, write_record
from fixedpipe.effects.reports.figure_record import record_of

# What a reader loads first. Source: the project's own limit.
FIRST_VIEW = 1e6
# Thumbnails that a window of 1400 x 900 pixels shows at most, and the bytes of one that is large.
# Measured: 24 cards of the made gallery's size; 22 kB, F000-5's.
CARDS, THUMBNAIL = 24, 22e3


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
