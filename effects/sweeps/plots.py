"""A sweep as a plot: a curve for each machine over one axis, or maps of colours over two."""

import io
import itertools

from fixedpipe.effects.refusal import Refusal

_MOST_CURVES = 12  # that a reader tells apart
UNITS = {"rms": "rms of (machine - ideal), 1/255", "largest": "largest |machine - ideal|, 1/255"}


def check_plot(sweep):
    """Raise Refusal if a sweep cannot be plotted: a study's, and one in which only the machine varies, or
    more than two axes.
    """
    varied = _varied(sweep)
    if sweep.kind == "study":
        raise Refusal(f"--plot shows figures and scripts; fixedpipe study {sweep.subject} plots the study.")
    if not 1 <= len(varied) <= 2:
        said = ", ".join(one.name for one in varied) or "nothing but the machine"
        raise Refusal(f"--plot shows what varies over one axis or two, and here {said}; leave it out.")


def _varied(sweep):
    return [one for one in sweep.axes if one.name != "machine" and len(one.values) > 1]


def plot(sweep, rows, column, form):
    """The bytes of a plot's file.

    sweep   the Sweep; rows: its rows
    column  a column of numbers, as rms
    form    "png", "svg" or "pdf"

    Raises Refusal for a column that has no numbers.
    """
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    rows = [row for row in rows if isinstance(row.get(column), int | float)]
    if not rows:
        raise Refusal(f"No row has a number under {column}, so nothing can be plotted.")
    varied, machines = _varied(sweep), list(dict.fromkeys(row["machine"] for row in rows))
    with rc_context({"svg.hashsalt": "fixedpipe", "font.size": 9}):
        across = 1 if len(varied) == 1 else min(len(machines), 4)
        down = 1 if len(varied) == 1 else -(-len(machines) // across)
        figure = Figure((6.4 if across == 1 else 3.6 * across, 4.2 if down == 1 else 3.2 * down))
        FigureCanvasAgg(figure)
        figure.set_layout_engine("constrained")
        draw = _curves if len(varied) == 1 else _maps
        draw(figure, (down, across), rows, varied, machines, column)
        figure.suptitle(f"{sweep.subject}: {UNITS.get(column, column)}")
        stream = io.BytesIO()
        # Without dates a plot of the same numbers has the same bytes.
        said = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}
        figure.savefig(stream, format=form, dpi=150, metadata=said[form])
    return stream.getvalue()


def _curves(figure, shape, rows, varied, machines, column):
    axes, (one,) = figure.subplots(), varied
    marks = itertools.cycle("osD^v")
    for machine, mark in zip(machines[:_MOST_CURVES], marks, strict=False):
        of = {row[one.name]: row[column] for row in rows if row["machine"] == machine}
        there = [value for value in one.values if value in of]
        axes.plot([_place(one, v) for v in there], [of[v] for v in there], marker=mark, ms=3.5, label=machine)
    if len(machines) > _MOST_CURVES:
        axes.set_title(f"the first {_MOST_CURVES} of {len(machines)} machines", fontsize=8)
    _scale(axes, "x", one)
    axes.set_ylabel(UNITS.get(column, column))
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7)


def _maps(figure, shape, rows, varied, machines, column):
    import numpy as np

    across, up = varied
    low, high = (pick(row[column] for row in rows) for pick in (min, max))
    places = figure.subplots(*shape, squeeze=False, sharex=True, sharey=True)
    for axes in places.ravel()[len(machines) :]:
        axes.set_visible(False)
    for axes, machine in zip(places.ravel(), machines, strict=False):
        of = {(row[up.name], row[across.name]): row[column] for row in rows if row["machine"] == machine}
        grid = np.array([[of.get((y, x), np.nan) for x in across.values] for y in up.values], float)
        drawn = axes.imshow(grid, origin="lower", aspect="auto", vmin=low, vmax=high, cmap="viridis")
        _ticks(axes.xaxis, across)
        _ticks(axes.yaxis, up)
        axes.set(title=machine, xlabel=across.name, ylabel=up.name)
    figure.colorbar(drawn, ax=places, label=UNITS.get(column, column))


def _is_numbers(one):
    return all(isinstance(value, int | float) for value in one.values)


def _place(one, value):
    return value if _is_numbers(one) else one.values.index(value)


def _scale(axes, side, one):
    axes.set_xlabel(one.name)
    if not _is_numbers(one):
        _ticks(axes.xaxis, one)
    elif len(one.values) <= 16:
        axes.set_xticks(one.values, [f"{value:g}" for value in one.values])


def _ticks(line, one):
    """A tick for a value, of many for some."""
    every = -(-len(one.values) // 8)
    places = range(0, len(one.values), every)
    line.set_ticks(list(places), [one.texts[n] for n in places], fontsize=7)
