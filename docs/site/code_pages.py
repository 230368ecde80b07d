"""A page for each file of code that the pages name: its text in colours, without the site's frame."""

import html
import os
import re
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).parents[2]
# A file of code as pages name it.
NAMED = re.compile(r"(?:raster|pipeline|effects|tests|docs|bench)/[\w/.-]+\.(?:py|pyi|c|toml|json)")
# Of Pygments, for light and for dark screens: those of the site's theme.
STYLES = {"light": "a11y-high-contrast-light", "dark": "a11y-high-contrast-dark"}
_FRAME = """\
body { margin: 1rem; font: 15px/1.5 sans-serif; background: #fff; color: #1f2328; }
a { color: #0a4bff; }
pre { font: 13px/1.4 monospace; overflow-x: auto; }
"""
_FRAME_OF_DARK = "body { background: #131416; color: #cfd0d0; } a { color: #5ca5ff; }\n"
_PAGE = """\
<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{path}</title><link rel="stylesheet" href="{style}"></head>
<body><p><a href="{home}">fixedpipe</a> · {path}</p>
{code}</body></html>
"""


def address(path):
    """Where the page of a file stands in the site; ``path``: in the repository."""
    return f"code/{path}.html"


def write(paths, out):
    """Write the pages of the files ``paths`` into the site's folder ``out``."""
    from pygments import highlight
    from pygments.formatters import HtmlFormatter
    from pygments.lexers import TextLexer, get_lexer_for_filename
    from pygments.util import ClassNotFound

    formatter = HtmlFormatter()
    light, dark = (HtmlFormatter(style=name).get_style_defs(".highlight") for name in STYLES.values())
    (out / "code").mkdir(parents=True, exist_ok=True)
    rules = f"{_FRAME}{light}\n@media (prefers-color-scheme: dark) {{\n{_FRAME_OF_DARK}{dark}\n}}\n"
    (out / "code" / "code.css").write_text(rules)
    for path in sorted(paths):
        try:
            lexer = get_lexer_for_filename(PurePosixPath(path).name)
        except ClassNotFound:
            lexer = TextLexer()
        page = out / address(path)
        page.parent.mkdir(parents=True, exist_ok=True)
        back = "../" * (len(PurePosixPath(path).parts))
        said = {
            "path": html.escape(path),
            "style": f"{'../' * (len(PurePosixPath(path).parts) - 1)}code.css",
            "home": f"{back}index.html",
            "code": highlight((ROOT / path).read_text(), lexer, formatter),
        }
        page.write_text(_PAGE.format_map(said))


def relative(page, path):
    """The address of a file's page from the page of a document, such as docs/papers/004."""
    return os.path.relpath(address(path), PurePosixPath(page).parent)
