"""A row of a picture as lines, the machine's and the ideal's, by matplotlib."""

import io

import numpy as np

_NAMES = ("red", "green", "blue")


def row_png(machine, ideal, title):
    """The bytes of a PNG file.

    ``machine``, ``ideal``: float64 [w, 3], 1.0 = full intensity. Each component has its own axes; equal
    components, such as those of a grey row, share them.
    """
    import matplotlib

    shown = {}  # components of each axes, by the lines that they have
    for k, name in enumerate(_NAMES):
        key = machine[:, k].tobytes(), ideal[:, k].tobytes()
        shown.setdefault(key, (k, []))[1].append(name)
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=(9.0, 1.0 + 2.5 * len(shown)), dpi=110, layout="constrained")
        FigureCanvasAgg(figure)
        figure.suptitle(title, fontsize=9, wrap=True)
        every = figure.subplots(len(shown), squeeze=False, sharex=True)[:, 0]
        x = np.arange(len(machine))
        for axes, (k, names) in zip(every, shown.values(), strict=True):
            axes.step(x, 255 * machine[:, k], where="mid", color="tab:orange", label="machine")
            axes.plot(x, 255 * ideal[:, k], color="black", linewidth=0.8, label="ideal")
            axes.set_ylabel(f"{', '.join(names)}, 1/255", fontsize=8)
            axes.grid(alpha=0.3)
            axes.tick_params(labelsize=7)
        every[0].legend(fontsize=8)
        every[-1].set_xlabel("x, pixels from the left", fontsize=8)
        out = io.BytesIO()
        figure.savefig(out, format="png", metadata={"Software": None})
    return out.getvalue()
