"""P32: products made pass by pass in the framebuffer, which rounds each of them.

Source: Heidrich 2001 and Kautz, Seidel 2000, section 3.1: factors multiplied by blending (H03, K03; artefact
P32 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.studies.shared.strips import strip
from fixedpipe.effects.studies.study import BLUE, EXPECTED, GREEN, ORANGE, RED, Column, Study, Table
from fixedpipe.pipeline.commands import Clear, Draw
from fixedpipe.pipeline.enums import BlendFactor
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.profiles import INFINITE_REALITY
from fixedpipe.pipeline.state import Blending, PassState

DATA = study_data(__file__, "P32")

PRODUCTS = 8
# Quads of one colour each, and how many frames of them.
_ACROSS = 256
_ROWS = 16
_MULTIPLY = Blending(BlendFactor.DST_COLOR, BlendFactor.ZERO)
_STEP = 0.0011


def errors(least, profile, *, exact=True):
    """RMS error of the framebuffer for the products of 1 to PRODUCTS + 1 factors: float64 [PRODUCTS + 1].

    Each pass multiplies by random factors from ``least`` to 1. With ``exact`` the machine holds them exactly,
    such as bytes / 255; otherwise they are real numbers, which the vertex colours round. The first pass
    writes its factor unchanged, so a chain of n + 1 passes makes n products.
    """
    one = 2 ** profile.framebuffers.color_bits[0] - 1
    random = np.random.Generator(np.random.PCG64(32))
    differences = [[] for _ in range(PRODUCTS + 1)]
    machine = Machine(profile, _ACROSS, 8)
    for _ in range(_ROWS):
        product = np.ones((_ACROSS, 3))
        machine.run((Clear(label="one", color=(1.0, 1.0, 1.0, 1.0)),))
        for n in range(PRODUCTS + 1):
            factors = least + (1.0 - least) * random.random((_ACROSS, 3))
            factors = np.round(factors * one) / one if exact else factors
            state = PassState(blending=_MULTIPLY)
            machine.run((Draw(label="multiply", mesh=strip(_ACROSS, factors), state=state),))
            product = product * factors
            differences[n].append(machine.framebuffer.color[4, :, :3] / one - product)
    return np.array([root_mean_square(np.stack(d)) for d in differences])


def measure(profile):
    """The table, with a row for each number of products in the chain."""
    found = {
        "bytes .9 to 1": errors(0.9, profile),
        "bytes 0 to 1": errors(0.0, profile),
        "real .9 to 1": errors(0.9, profile, exact=False),
        "12 bits .9 to 1": errors(0.9, INFINITE_REALITY),
    }
    rows = tuple(
        (n, *(float(f[n]) for f in found.values()), _STEP * float(np.sqrt(n))) for n in range(PRODUCTS + 1)
    )
    columns = (
        Column("products", form="d"),
        *(Column(name, form=".5f") for name in found),
        Column(".0011 sqrt(n)", form=".5f"),
    )
    return Table(columns, rows)


def findings(table):
    """The growth of the error with the number of roundings."""
    rows = table.records()
    one, four, last = rows[1], rows[4], rows[-1]
    return (
        f"A product of bytes near 1 rounds by an RMS of {one['bytes .9 to 1']:.5f}. After 4 products it is "
        f"{four['bytes .9 to 1'] / one['bytes .9 to 1']:.2f} times that, after {last['products']} products "
        f"{last['bytes .9 to 1'] / one['bytes .9 to 1']:.2f} times. Factors from 0 to 1 shrink earlier "
        f"errors too: after {last['products']} products it is {last['bytes 0 to 1']:.5f}.",
        f"Factors that are no whole bytes round once more each: {four['real .9 to 1']:.5f} after 4 "
        "products. In a buffer of 12 bits, 4 products of bytes have "
        f"{four['bytes .9 to 1'] / four['12 bits .9 to 1']:.1f} times less error.",
    )


def checks(table):
    """The catalogue's law, with one rounding for each product."""
    rows = table.records()
    for n in range(1, 5):
        yield DATA.check(
            "RMS after {n} products of bytes near 1, of .0011 sqrt({n}): relative deviation",
            abs(rows[n]["bytes .9 to 1"] / rows[n][".0011 sqrt(n)"] - 1.0),
            Answer.MACHINE,
            n=n,
        )
    bits = rows[4]["bytes .9 to 1"] / rows[4]["12 bits .9 to 1"]
    yield DATA.check(
        "RMS in 8 bits over that in 12, of 16: relative deviation", abs(bits / 16.0 - 1.0), Answer.MACHINE
    )


def plot(axes, table):
    """The RMS by number of products."""
    (ax,) = axes
    n = table.column("products")
    styles = {
        "bytes .9 to 1": (BLUE, "o"),
        "bytes 0 to 1": (ORANGE, "s"),
        "real .9 to 1": (RED, "^"),
        "12 bits .9 to 1": (GREEN, "v"),
    }
    for name, (color, marker) in styles.items():
        ax.plot(n, table.column(name), color=color, marker=marker, label=name)
    ax.plot(n, table.column(".0011 sqrt(n)"), label="catalogue: .0011 sqrt(n)", **EXPECTED)
    ax.set_xlabel("products in the chain of passes")
    ax.set_ylabel("RMS of framebuffer - product (1 = full intensity)")
    ax.set_ylim(0.0, 0.0048)
    ax.legend(title="factors", loc="upper left", ncols=2)


STUDY = Study(
    **DATA.words,
    method=(
        f"Random factors multiplied into the framebuffer by blending, {_ACROSS * _ROWS} pixels of three "
        "components, beside the exact products; and in the InfiniteReality's 12 bits."
    ),
    machines=("GEFORCE_256", "OCTANE", "OPENGL_1_2", "GEFORCE_3", "NV2A"),
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
