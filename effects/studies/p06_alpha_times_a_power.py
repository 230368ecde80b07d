"""P6: alpha times 2^n, clamped, is zero or one.

H38 copies the window onto itself. This must turn every alpha above zero into one. The smallest of them is
1/(2^n - 1) (erratum E000.10; the paper says 1/2^n). So 2^n is more than enough, and 2^(n-1) is too little. If
the board cannot subtract, the copy must turn every alpha below one into zero. The largest of these is
1 - 1/(2^n - 1).

Source: Heidrich 2001, section 2.1 (artefact P6 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.passes.draws import at_pixel
from fixedpipe.effects.shadows.alpha_coded_shadows import scale_alpha
from fixedpipe.effects.studies.study import BLUE, GREEN, ORANGE, RED, Column, Study, Table
from fixedpipe.pipeline.commands import DrawPixels
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.pixel_transfer import PixelImage

DATA = study_data(__file__, "P6")

_WIDTH = 64


def copied(bits, exponent, profile, *, subtract=True):
    """Every alpha of a window of ``bits`` bits after the copy with a scale of 2^exponent: int64 [2^bits]."""
    rows = 2**bits // _WIDTH
    alphas = np.arange(2**bits).reshape(rows, _WIDTH) / (2.0**bits - 1.0)
    image = PixelImage(np.repeat(alphas[..., None], 4, axis=-1))
    commands = (
        DrawPixels(label="every alpha", image=image, position=at_pixel(0, 0)),
        scale_alpha(Panel(0, 0, _WIDTH, rows), exponent, subtract=subtract),
    )
    framebuffer = execute(commands, profile, _WIDTH, rows, color_bits=bits).framebuffer
    return framebuffer.color[::-1, :, 3].ravel().astype(np.int64)


def measure(profile):
    """The table, with a row for each width of the machine's colours and each scale."""
    rows, curves = [], {}
    for bits in profile.framebuffers.color_bits:
        one = 2**bits - 1
        for name, exponent, subtract in (
            ("2^(n-1)", bits - 1, True),
            ("2^n", bits, True),
            ("2^(n+1)", bits + 1, True),
            ("2^n, bias 1 - 2^n", bits, False),
        ):
            after = copied(bits, exponent, profile, subtract=subtract)
            binary = int(((after == 0) | (after == one)).sum())
            kept = after[1:] == one if subtract else after[:-1] == 0
            smallest = after[1] if subtract else after[-2]
            rows.append((bits, name, 2**bits, binary, int(kept.sum()), float(smallest / one)))
            curves[f"{bits} bits, {name}"] = after / one
    columns = (
        Column("bits", form="d"),
        Column("scale"),
        Column("alphas", form="d"),
        Column("zero or one after it", form="d"),
        Column("decided as they should be", form="d"),
        Column("nearest alpha becomes", form=".4f"),
    )
    return Table(columns, tuple(rows), curves)


def _row(table, bits, scale):
    (row,) = [r for r in table.records() if (r["bits"], r["scale"]) == (bits, scale)]
    return row


def findings(table):
    """That 2^n is enough, and 2^(n-1) is not."""
    out = []
    for bits in dict.fromkeys(table.column("bits")):
        half, whole, added = (_row(table, bits, s) for s in ("2^(n-1)", "2^n", "2^n, bias 1 - 2^n"))
        out.append(
            f"With {bits} bits, 2^n turns {whole['decided as they should be']} of {2**bits - 1} alphas "
            f"above zero into one. 2^(n-1) turns {half['decided as they should be']} of them into one, and "
            f"leaves the smallest at {half['nearest alpha becomes']:.4f}. With the bias, "
            f"{added['decided as they should be']} alphas below one become zero."
        )
    return tuple(out)


def checks(table):
    """The catalogue's numbers for every width."""
    for bits in dict.fromkeys(table.column("bits")):
        for scale in ("2^n", "2^(n+1)", "2^n, bias 1 - 2^n"):
            yield DATA.check(
                "{bits} bits, {scale}: alphas that are not decided",
                2**bits - 1 - _row(table, bits, scale)["decided as they should be"],
                Answer.MACHINE,
                bits=bits,
                scale=scale,
            )
        left = _row(table, bits, "2^(n-1)")["nearest alpha becomes"]
        yield DATA.check(
            "{bits} bits, 2^(n-1): the smallest alpha's distance from one half",
            abs(left - 0.5),
            Answer.MACHINE,
            at_most=1.0 / 2**bits,
            bits=bits,
        )


def plot(axes, table):
    """The smallest alphas after each scale."""
    (axis,) = axes
    bits = table.column("bits")[0]
    shown = (("2^(n-1)", RED, "o"), ("2^n", BLUE, "s"), ("2^(n+1)", GREEN, "x"))
    for name, color, marker in shown:
        values = table.curves[f"{bits} bits, {name}"][:8]
        axis.plot(np.arange(8), values, color=color, marker=marker, linestyle="none", label=f"times {name}")
    values = table.curves[f"{bits} bits, 2^n, bias 1 - 2^n"][-8:]
    label = "times 2^n, bias 1 - 2^n; from one"
    axis.plot(np.arange(-7, 1), values, color=ORANGE, marker="^", linestyle="none", label=label)
    axis.set_xlabel(f"alpha before the copy, in steps of 1/{2**bits - 1} from zero (right) or one (left)")
    axis.set_ylabel("alpha after it")
    axis.legend()


STUDY = Study(
    **DATA.words,
    machines=("OCTANE", "INFINITE_REALITY", "OPENGL_1_2_IMAGING", "OPENGL_1_2"),
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
