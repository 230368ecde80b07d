"""A pixel's history as text for a terminal, by rich."""

from collections.abc import Iterator

from rich.console import Group
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from fixedpipe.pipeline.inspection.history import Fragment, PixelHistory, Quantity, Stage, Touched
from fixedpipe.pipeline.inspection.pixel import PixelValue


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


def held(value: PixelValue) -> str:
    """What a pixel holds, in words."""
    color = " ".join(str(code) for code in value.color)
    return f"color {color}, depth {value.depth}, stencil {value.stencil}"


def _fragment(number: int, count: int, fragment: Fragment) -> Table:
    title = (
        f"fragment {number + 1} of {count}: {fragment.fate}" if count > 1 else f"fragment: {fragment.fate}"
    )
    table = Table(title=title, title_justify="left", box=None, pad_edge=False, show_header=True)
    for heading, justify in (("", "left"), ("code", "right"), ("value", "right"), ("ideal", "right")):
        table.add_column(heading, justify=justify, overflow="fold")
    for stage in fragment.stages:
        _stage(table, stage)
    return table


def _stage(table: Table, stage: Stage) -> None:
    title = Text(stage.title, style="bold")
    if stage.says:
        title.append(f"   {stage.says}", style="italic default")
    if stage.verdict is not None:
        title.append("   passed" if stage.verdict else "   FAILED", style="green" if stage.verdict else "red")
    table.add_row(title)
    for quantities, mark in ((stage.read, "  "), (stage.made, "= ")):
        for quantity in quantities:
            table.add_row(Text(f"{mark}{quantity.name}"), *cells(quantity))
    for clamped in stage.clamped:
        table.add_row(
            Text(f"  clamped: {clamped.name}", style="yellow"),
            "",
            f"{clamped.before:.4g} to {clamped.after:.4g}",
        )


def cells(quantity: Quantity) -> tuple[str, str, str]:
    """A quantity's codes, values and ideal values as text; a value that is its code is not said twice."""
    codes = " ".join(str(code) for code in quantity.codes)
    plain = quantity.codes and quantity.one is None
    values = "" if plain else " ".join(_number(value) for value in quantity.values)
    return codes, values, " ".join(_number(value) for value in quantity.ideal)


def _number(value: float) -> str:
    return f"{value:.6g}"
