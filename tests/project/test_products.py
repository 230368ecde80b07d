"""No bit depends on the processor's BLAS: it fuses and reorders sums, in another way on each processor."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# Their numbers are compared with bounds, or printed rounded: no picture is made of them.
JUDGES = ("effects/acceptance/", "effects/figures/", "effects/studies/")
# A use, and why it makes no other bits. Scenes of figures are compared between processors in test_figures.py.
ALLOWED = {
    "effects/scattering/harmonics.py": "a fit of spherical harmonics, which no machine draws",
    "effects/shadows/light_space.py": "how large a map's texels are on the screen, for checks",
    "pipeline/inspection/stages.py": "the inspector's words on a filter's weights",
    "pipeline/opengl/lists.py": "integers",
    "pipeline/validation/transfer.py": "whether each value of an image has to be looked at",
    "pipeline/vertices/assembly.py": "integers",
}
PRODUCTS = {"dot", "einsum", "inner", "matmul", "tensordot", "vdot"}
SOLVERS = {"cholesky", "det", "eig", "eigh", "inv", "lstsq", "pinv", "qr", "solve", "svd"}
FILES = [
    name
    for folder in ("pipeline", "effects")
    for path in sorted((ROOT / folder).rglob("*.py"))
    if not (name := path.relative_to(ROOT).as_posix()).startswith(JUDGES)
]


def products_in(text):
    """The lines on which NumPy multiplies matrices or solves systems."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
            yield node.lineno
        if isinstance(node, ast.Attribute):
            of = ast.unparse(node.value)
            if (of == "np" and node.attr in PRODUCTS) or (of == "np.linalg" and node.attr in SOLVERS):
                yield node.lineno
            if (
                of == "np.linalg"
                and node.attr == "norm"
                and "axis=" not in text.splitlines()[node.lineno - 1]
            ):
                yield node.lineno


@pytest.mark.parametrize("name", FILES)
def test_no_product_is_left_to_numpys_blas(name):
    found = list(products_in((ROOT / name).read_text()))
    assert bool(found) == (name in ALLOWED), f"{name}, lines {found}"


@pytest.mark.parametrize(
    "text", ["c = a @ b", "np.dot(a, b)", "x = np.linalg.inv(m)", "np.linalg.norm(v)", "f = np.einsum"]
)
def test_each_kind_of_product_is_found(text):
    assert list(products_in(text)) == [1]


def test_what_keeps_its_order_is_no_product():
    assert not list(products_in("dot(a, b)\nnp.linalg.norm(v, axis=1)\ng.dot\n"))
