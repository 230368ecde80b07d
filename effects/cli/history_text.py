"""A pixel's history as text for a terminal, by rich."""

from collections.abc import Iterator, Sequence

from rich.console import Group
from rich.text import Text

from fixedpipe.pipeline.inspection.history import Fragment, PixelHistory, Stage, Touched
from fixedpipe.pipeline.inspection.words import HEADINGS, causes, cells, held, marks_of, meant


def history_text(history: PixelHistory, brief: bool = False) -> Group:
    """The history in a form that rich's Console prints.

    ``brief``: show only two stages of every fragment: the one that adds most to the error, and then the
    first that clamps.
    """
    return Group(*_lines(history, brief))


def _lines(history: PixelHistory, brief: bool) -> Iterator[Text]:
    size, surface = f"{history.width}x{history.height}", ""
    if history.surface is not None:
        surface = f" of pbuffer {history.surface}"
    where = f"pixel ({history.x}, {history.y}){surface}, {size}, window y {history.window_y}"
    yield Text(f"{where}, on {history.profile}", style="bold")
    yield Text(
        f"{len(history.touched)} of {history.commands} commands touched it. In the end: {held(history.final)}"
    )
    if ideal := meant(history):
        yield Text(ideal)
    for touched in history.touched:
        yield Text()
        yield from _heading(touched, history.surface)
        for number, fragment in enumerate(touched.fragments):
            yield from _fragment(number, len(touched.fragments), fragment, brief)


def _heading(touched: Touched, surface: str | None) -> Iterator[Text]:
    yield Text(touched.heading(surface), style="bold cyan")
    if touched.before == touched.after:
        yield Text("  unchanged")
    else:
        yield Text(f"  before  {held(touched.before)}")
        yield Text(f"  after   {held(touched.after)}")


def fragment_text(fragment: Fragment, shown: Sequence[Stage]) -> Group:
    """Some of a fragment's stages."""
    return Group(*_stages(fragment, shown))


def _fragment(number: int, count: int, fragment: Fragment, brief: bool) -> Iterator[Text]:
    name = f"fragment {number + 1} of {count}" if count > 1 else "fragment"
    yield Text(f"  {name}: {fragment.fate}", style="bold")
    places = dict.fromkeys((fragment.worst, fragment.first_clamped)) if brief else range(len(fragment.stages))
    shown = [fragment.stages[place] for place in places if place is not None]
    if shown:
        yield from _stages(fragment, shown)


def _stages(fragment: Fragment, shown: Sequence[Stage]) -> Iterator[Text]:
    rows = [HEADINGS]
    rows += [row for stage in shown for row in _rows(stage)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(HEADINGS))]
    yield _row(HEADINGS, widths, "dim")
    for stage in shown:
        yield _title(stage, marks_of(fragment, fragment.stages.index(stage)))
        for row in _rows(stage):
            yield _row(row, widths, "dim" if row[0].startswith(_CAUSE) else "")
        for clamped in stage.clamped:
            change = f"{clamped.before:.4g} to {clamped.after:.4g}"
            yield Text(f"      clamped: {clamped.name}, {change}", style="yellow")


_CAUSE = " " * 8


def _rows(stage: Stage) -> Iterator[tuple[str, ...]]:
    """A stage's quantities and the causes of their errors, as columns."""
    for quantities, mark in ((stage.read, "  "), (stage.made, "= ")):
        for quantity in quantities:
            yield (f"    {mark}{quantity.name}", *cells(quantity))
            for cause, numbers in causes(quantity):
                yield (f"{_CAUSE}{cause}", "", "", "", numbers)


def _row(row: tuple[str, ...], widths: list[int], style: str) -> Text:
    first, *others = (text.rjust(width) for text, width in zip(row, widths, strict=True))
    return Text("  ".join([row[0].ljust(len(first)), *others]).rstrip(), style=style)


def _title(stage: Stage, marks: str) -> Text:
    title = Text(f"    {stage.title}", style="bold")
    if stage.says:
        title.append(f": {stage.says}", style="not bold italic")
    if stage.verdict is not None:
        word, style = ("passed", "green") if stage.verdict else ("FAILED", "red")
        title.append(f"  {word}", style=style)
    if marks:
        title.append(f"  <- {marks}", style="bold magenta")
    return title
