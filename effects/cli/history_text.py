"""A pixel's history as text for a terminal, by rich."""

from collections.abc import Iterator

from rich.console import Group
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from fixedpipe.pipeline.inspection.history import Fragment, PixelHistory, Stage, Touched
from fixedpipe.pipeline.inspection.words import HEADINGS, causes, cells, held, marks_of


def history_text(history: PixelHistory) -> Group:
    """The whole history: what rich's Console prints."""
    return Group(*_lines(history))


def _lines(history) -> Iterator:
    where = (
        f"pixel ({history.x}, {history.y}) of {history.width}x{history.height}, window y {history.window_y}"
    )
    surface = "" if history.surface is None else f", pbuffer {history.surface}"
    yield Text(f"{where}{surface}, on {history.profile}", style="bold")
    yield Text(
        f"{len(history.touched)} of {history.commands} commands touched it; in the end {held(history.final)}"
    )
    for touched in history.touched:
        yield Text()
        yield _heading(touched)
        for number, fragment in enumerate(touched.fragments):
            yield Padding(_fragment(number, len(touched.fragments), fragment), (0, 0, 0, 2))


def _heading(touched: Touched) -> Text:
    sample = f", sample {touched.sample}" if touched.sample else ""
    text = Text(f"command {touched.number}, {touched.kind}{sample}: ", style="bold cyan")
    text.append(touched.label)
    change = f"\n  {held(touched.before)}\n  {held(touched.after)}" if touched.before != touched.after else ""
    text.append(change or "\n  unchanged", style="default")
    return text


def _fragment(number: int, count: int, fragment: Fragment) -> Table:
    title = (
        f"fragment {number + 1} of {count}: {fragment.fate}" if count > 1 else f"fragment: {fragment.fate}"
    )
    table = Table(title=title, title_justify="left", box=None, pad_edge=False, show_header=True)
    for heading in HEADINGS:
        table.add_column(heading, justify="right" if heading else "left", overflow="fold")
    for place, stage in enumerate(fragment.stages):
        _stage(table, stage, marks_of(fragment, place))
    return table


def _stage(table: Table, stage: Stage, marks: str) -> None:
    title = Text(stage.title, style="bold")
    if marks:
        title.append(f"   <- {marks}", style="bold magenta")
    if stage.says:
        title.append(f"   {stage.says}", style="italic default")
    if stage.verdict is not None:
        title.append("   passed" if stage.verdict else "   FAILED", style="green" if stage.verdict else "red")
    table.add_row(title)
    for quantities, mark in ((stage.read, "  "), (stage.made, "= ")):
        for quantity in quantities:
            table.add_row(Text(f"{mark}{quantity.name}"), *cells(quantity))
            for cause, numbers in causes(quantity):
                table.add_row(Text(f"      {cause}", style="dim"), "", "", "", Text(numbers, style="dim"))
    for clamped in stage.clamped:
        table.add_row(
            Text(f"  clamped: {clamped.name}", style="yellow"),
            "",
            f"{clamped.before:.4g} to {clamped.after:.4g}",
        )
