"""The viewer's page, one HTML document with its style and script in it; and the module for a notebook.

The page fetches nothing. Everything that it shows comes by messages.
"""

import json
import secrets

from fixedpipe.effects.reports import viewing
from fixedpipe.effects.reports.style import PALETTE

# In this order: each script uses those before it.
SCRIPTS = ("link", "address", "model", "controls", "gestures", "panels", "bars", "window")
_PACKAGE = __package__


def script() -> str:
    """The shared scripts and the viewer's. They define ``fixedpipeView(root, connect, options)``."""
    return viewing.script(_PACKAGE, SCRIPTS)


def style() -> str:
    """The style sheet of the shared parts and the viewer, with the palette."""
    return PALETTE + viewing.style(_PACKAGE, "viewer.css")


def page(socket: str) -> tuple[str, str]:
    """(the document, its Content-Security-Policy). ``socket``: the WebSocket's path, from the root."""
    nonce = secrets.token_urlsafe(16)
    policy = "; ".join(
        (
            "default-src 'none'",
            f"script-src 'nonce-{nonce}'",
            "style-src 'unsafe-inline'",
            "connect-src 'self'",
            "img-src data: blob:",
            "base-uri 'none'",
            "form-action 'none'",
            "frame-ancestors 'none'",
        )
    )
    start = f'fixedpipeView(document.body, connectSocket("{socket}"), {{ isPage: true }});'
    text = (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>fixedpipe view</title>'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        '<link rel="icon" href="data:,">'
        f"<style>{style()}</style></head>\n<body>"
        "<noscript><p>This page draws by a script; allow scripts for this address.</p></noscript>"
        f'<script nonce="{nonce}">{script()}\n{start}</script></body></html>\n'
    )
    return text, policy


# The code that runs the script in a notebook's output. The style is in a shadow root, so that notebook and
# widget do not change each other's look. The state goes both ways; during a gesture, some times a second.
_WIDGET = """
const { fixedpipeView, connectModel } = globalThis;
const STATE_EVERY = 200; // milliseconds
export default {
  render({ model, el }) {
    const host = document.createElement("div"), root = host.attachShadow({ mode: "open" });
    const style = document.createElement("style");
    style.textContent = STYLE;
    root.append(style);
    el.append(host);
    let timer = 0, told = JSON.stringify(model.get("state"));
    const tell = (view) => {
      const text = JSON.stringify(view);
      if (text === told) return;
      told = text;
      model.set("state", view);
      model.save_changes();
    };
    const changed = ({ view }) => {
      clearTimeout(timer);
      if (view.id && view.machine) timer = setTimeout(() => tell(view), STATE_EVERY);
    };
    const leave = fixedpipeView(root, connectModel(model), { changed });
    const follow = () => {
      const text = JSON.stringify(model.get("state"));
      if (text === told) return;
      told = text;
      root.querySelector(".viewer").fixedpipe.set({ view: JSON.parse(text) });
    };
    model.on("change:state", follow);
    return () => {
      model.off("change:state", follow);
      leave();
    };
  },
};
"""


def module() -> str:
    """The module of a notebook's widget, with the same script and style."""
    style_text = (
        style().replace(":root", ":host").replace("html {", ":host {").replace("\nbody {", "\n.viewer {")
    )
    return f"{script()}\nconst STYLE = {json.dumps(style_text)};{_WIDGET}"
