"""States in words: the differences from the initial state, a line for each part."""

from dataclasses import MISSING, fields, is_dataclass
from types import NoneType

from fixedpipe.pipeline.description.equations import combiner_lines, environment_lines, shader_stage_equation
from fixedpipe.pipeline.description.words import ALWAYS_SHOWN, FIELD_WORDS, format_value
from fixedpipe.pipeline.enums import ConvolutionBorderMode
from fixedpipe.pipeline.messages import count
from fixedpipe.pipeline.pixel_transfer import ConvolutionFilter, SeparableFilter
from fixedpipe.pipeline.state import (
    ColorMask,
    ColorTable,
    RegisterCombiners,
    TexGen,
    TextureEnvironment,
    TextureShaderStage,
)


def _initial(field):
    if field.default is not MISSING:
        return field.default
    return field.default_factory() if field.default_factory is not MISSING else MISSING


def differences(value, initial=None):
    """Lines for the fields of a state that differ from ``initial``, or from its own defaults.

    Simple fields share the first line, which may be empty. Parts follow, indented.
    """
    simple, parts = [], []
    for field in fields(value):
        given = getattr(value, field.name)
        usual = _initial(field) if initial is None else getattr(initial, field.name)
        if given == usual and field.name not in ALWAYS_SHOWN.get(type(value), ()):
            continue
        word = FIELD_WORDS.get((type(value), field.name), field.name.replace("_", " "))
        if type(given) in _PARTS:
            parts += _PARTS[type(given)](word, given)
        elif isinstance(given, tuple) and any(is_dataclass(g) for g in given):
            parts += numbered_lines(word, given)
        elif field.name == "clip_planes":
            parts += [f"{word}{i} {format_value(plane)}" for i, plane in enumerate(given)]
        elif is_dataclass(given):
            parts += titled(word, differences(given, usual if is_dataclass(usual) else None))
        elif given is None:
            simple.append(f"{word} disabled")
        else:
            simple.append(f"{word} {format_value(given)}")
    return [", ".join(simple), *parts]


def numbered_lines(word, parts):
    """Lines for the states of a tuple, by number; None gives no line."""
    lines = []
    for i, part in enumerate(parts):
        lines += _NUMBERED.get(type(part), _numbered)(word, i, part)
    return lines


def _numbered(word, i, part):
    return titled(f"{word} {i}", differences(part))


def _generation(word, i, gen):
    return [] if gen == TexGen() else titled(f"{word}_{'STRQ'[i]}", differences(gen))


# Parts of a tuple that have their own form, instead of differences.
_NUMBERED = {
    NoneType: lambda word, i, part: [],
    TexGen: _generation,
    TextureShaderStage: lambda word, i, stage: [f"{word} {i}: {shader_stage_equation(i, stage)}"],
}


def titled(title, lines):
    """Lines under a title: the first beside it, the others indented."""
    first, *rest = lines
    return [f"{title}: {first}" if first else title, *("  " + line for line in rest)]


def mask_words(mask):
    """The components that a color mask writes, in words."""
    written = [f.name for f in fields(mask) if getattr(mask, f.name)]
    return "writes " + (", ".join(written) or "nothing")


def _table_line(word, table):
    """A colour table: all entries of a short one, the first and the last of a longer one."""
    bits = "" if table.bits is None else f" of {count(table.bits, 'bit')}"
    entries = table.entries
    shown = (
        format_value(entries)
        if len(entries) <= 4
        else f"{format_value(entries[0])} to {format_value(entries[-1])}"
    )
    return f"{word} enabled: {len(entries)} {table.base_format.name} entries{bits}, {shown}"


def _rows(word, kernel):
    return _filter_lines(word, kernel, [(f"row {j}", row) for j, row in enumerate(kernel.rows)])


def _row_and_column(word, kernel):
    return _filter_lines(word, kernel, [("row", kernel.row), ("column", kernel.column)])


def _filter_lines(word, kernel, lines):
    """A convolution filter: its border mode, then its rows from the bottom, or its row and column."""
    border = kernel.border_mode.name
    if kernel.border_mode is ConvolutionBorderMode.CONSTANT_BORDER:
        border += f" {format_value(kernel.border_color)}"
    title = f"{word} enabled: {kernel.base_format.name}, {border}"
    return [title, *(f"  {name} {format_value(weights)}" for name, weights in lines)]


# Parts of a state that have their own form, instead of differences.
_PARTS = {
    RegisterCombiners: lambda word, combiners: combiner_lines(combiners),
    TextureEnvironment: lambda word, environment: environment_lines(environment),
    ColorMask: lambda word, mask: [f"{word} {mask_words(mask)}"],
    ColorTable: lambda word, table: [_table_line(word, table)],
    ConvolutionFilter: _rows,
    SeparableFilter: _row_and_column,
}
