"""The style of the reports' pages, light and dark, without files from elsewhere."""

_LIGHT = (
    "color-scheme: light; --ink: #1c1e21; --paper: #fbfaf8; --quiet: #62676e; --line: #dddad4; "
    "--bad: #b3261e; --good: #2c6e49; --faint: #b9b5ad; --raised: #f3f1ec; --mat: #e9e6e0; "
    "--veil: #fbfaf8d9; --focus: #2f6fb3; "
    "--gutter: #fbfaf8;"
)
_DARK = (
    "color-scheme: dark; --ink: #e4e2dd; --paper: #17181a; --quiet: #9da2a9; --line: #33363a; "
    "--bad: #f2938c; --good: #7fc49b; --faint: #5d6268; --raised: #202225; --mat: #2b2d31; "
    "--veil: #17181ad9; --focus: #7db3e8; "
    "--gutter: #34373c;"
)
# The colors, by what they are for. The system chooses light or dark, unless the root's data-theme does.
PALETTE = f"""
:root {{ {_LIGHT} }}
@media (prefers-color-scheme: dark) {{ :root:not([data-theme="light"]) {{ {_DARK} }} }}
:root[data-theme="dark"] {{ {_DARK} }}
@media print {{ :root:root:root {{ {_LIGHT} }} }}
"""

STYLE = f"""{PALETTE}
* {{ box-sizing: border-box; }}
body {{ margin: 0 auto; max-width: 88rem; padding: 2rem clamp(1rem, 4vw, 3rem) 4rem; background: var(--paper);
  color: var(--ink); font: 1rem/1.55 Georgia, "Times New Roman", serif; }}
h1 {{ font-size: 1.7rem; font-weight: normal; margin: 0 0 .2rem; }}
h2 {{ font-size: 1.25rem; font-weight: normal; margin: 0 0 .5rem; }}
h3 {{ font-size: 1rem; font-weight: normal; margin: 1.4rem 0 0; }}
h2 span, h3 span, .quiet, figcaption, th {{ color: var(--quiet); }}
section {{ border-top: 1px solid var(--line); margin-top: 2.5rem; padding-top: 1.5rem; }}
p {{ margin: .4rem 0; max-width: 48rem; }}
.pictures {{ display: grid; gap: 1rem; grid-template-columns: repeat(auto-fit, minmax(min(100%, 20rem), 1fr));
  margin: 1.2rem 0; }}
.row {{ grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); max-width: 64rem; }}
.row figure:first-child {{ grid-column: 1 / -1; }}
.small {{ grid-template-columns: repeat(auto-fit, minmax(min(100%, 15rem), 1fr)); max-width: 64rem; }}
figure {{ margin: 0; }}
img {{ display: block; max-width: 100%; height: auto; background: #808080; }}
figcaption, .quiet, table {{ font: .84rem/1.5 system-ui, sans-serif; }}
figcaption {{ padding-top: .35rem; }}
summary {{ cursor: pointer; font: .84rem/1.5 system-ui, sans-serif; margin: .6rem 0; }}
.table {{ overflow-x: auto; }}
table {{ border-collapse: collapse; width: 100%; min-width: 44rem; }}
th, td {{ border-bottom: 1px solid var(--line); padding: .3rem .9rem .3rem 0; text-align: left;
  vertical-align: top; }}
td.number {{ font-variant-numeric: tabular-nums; white-space: nowrap; }}
.ok {{ color: var(--good); }} .failed {{ color: var(--bad); font-weight: bold; }}
a {{ color: inherit; }}
"""
