"""The record of one study: its table, the content of its JSON file, and its plot."""


def measured(s, key, check):
    """The study's table and the content of its JSON file."""
    from fixedpipe.effects.refusal import refusals
    from fixedpipe.pipeline.golden.provenance import provenance
    from fixedpipe.pipeline.profiles import PROFILES

    profile = PROFILES[key] if key else None
    with refusals():
        table = s.measure(profile)
    checks = s.checks(table) if check else ()
    record = {
        "id": s.id,
        "title": s.title,
        "question": s.question,
        "method": s.method,
        "source": s.source,
        "techniques": list(s.techniques),
        "profile": key,
        "units": {column.name: column.unit for column in table.columns},
        "rows": table.records(),
        "findings": list(s.findings(table)),
        "checks": [c.record() for c in checks],
        "provenance": provenance(profile),
    }
    return table, record


def json_bytes(content):
    """A record, or a list of them, as the bytes of a JSON file."""
    from fixedpipe.effects.reports.rows import json_text

    return json_text(content).encode()


def plotted(s, table):
    """The study's plot as the bytes of a PNG file; None if matplotlib is not installed."""
    try:
        import matplotlib
    except ImportError:
        return None
    import io

    # The drawing library alone, without a window system and without what a user's settings change.
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update({"axes.grid": True, "grid.alpha": 0.3, "axes.axisbelow": True})
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=(4.5 + 3.5 * s.panels, 5.0), dpi=110, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots(1, s.panels, squeeze=False)[0]
        figure.suptitle(f"{s.id}: {s.title}")
        s.plot(tuple(axes), table)
        buffer = io.BytesIO()
        figure.savefig(buffer, format="png", metadata={"Software": None})
        return buffer.getvalue()
