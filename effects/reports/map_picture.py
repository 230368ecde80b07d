"""Maps of a frame as a picture with a legend, by matplotlib."""

import io

import numpy as np

_DOTS = 100  # an inch
_COLORS = "viridis"  # perceptual: equal steps look equal, and grey in print


def maps_png(maps, title, legend):
    """Maps below one another, by one scale: the bytes of a PNG file.

    ``maps``: (name, values) each, float64 [h, w] of any size, top row first, NaN where there is no value;
    ``legend``: the meaning of the values.
    """
    import matplotlib

    scales = [max(1, 512 // max(values.shape)) for _, values in maps]  # small ones are shown pixel by pixel
    heights = [scale * values.shape[0] for scale, (_, values) in zip(scales, maps, strict=True)]
    width = max(scale * values.shape[1] for scale, (_, values) in zip(scales, maps, strict=True))
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        size = (width + 240) / _DOTS, (sum(heights) + 90 * len(maps)) / _DOTS
        figure = Figure(figsize=size, dpi=_DOTS, layout="constrained")
        figure.suptitle(title, fontsize=9, wrap=True)
        colors = matplotlib.colormaps[_COLORS].with_extremes(bad="0.85")
        known = [values[~np.isnan(values)] for _, values in maps]
        bounds = min(v.min(initial=0.0) for v in known), max(v.max(initial=0.0) for v in known)
        every = figure.subplots(len(maps), squeeze=False, height_ratios=heights)[:, 0]
        for axes, (name, values) in zip(every, maps, strict=True):
            masked, (low, high) = np.ma.masked_invalid(values), bounds
            shown = axes.imshow(masked, cmap=colors, interpolation="nearest", vmin=low, vmax=high)
            axes.set_title(name, fontsize=8, loc="left", wrap=True)
            axes.tick_params(labelsize=7)
        bar = figure.colorbar(shown, ax=list(every), fraction=0.04, pad=0.02)
        bar.set_label(legend, fontsize=8)
        bar.ax.tick_params(labelsize=7)
        FigureCanvasAgg(figure)
        out = io.BytesIO()
        figure.savefig(out, format="png", metadata={"Software": None})
    return out.getvalue()
