# SPDX-License-Identifier: Apache-2.0
"""One HTML page that needs no network: figures are drawn twice, for a light and for a dark browser, and are part of the file."""
import base64
import html
import io

import matplotlib
from PIL import Image

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

PALETTES = {
    "light": {"back": "#ffffff", "ink": "#1b1f24", "grid": "#d7dbe0", "lines": ["#0b62c4", "#c4480b", "#13793c", "#8a3fa8", "#8c6d00", "#b0284a", "#41707c", "#5b5f66"]},
    "dark": {"back": "#14171b", "ink": "#e4e7eb", "grid": "#3a4048", "lines": ["#6cb2ff", "#ff9a5c", "#5fd08a", "#d49bf0", "#e6c34a", "#ff7f9d", "#7fc4d4", "#aeb4bd"]},
}

STYLE = """
:root{color-scheme:light dark;--back:#fff;--ink:#1b1f24;--dim:#59616b;--line:#d7dbe0}
@media(prefers-color-scheme:dark){:root{--back:#14171b;--ink:#e4e7eb;--dim:#a3abb5;--line:#3a4048}}
body{background:var(--back);color:var(--ink);font:15px/1.5 system-ui,sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem}
h1{font-size:1.6rem}h2{font-size:1.2rem;margin-top:2.5rem;border-top:1px solid var(--line);padding-top:1rem}
figure{margin:1rem 0}figure img{max-width:100%;height:auto}figcaption,.dim{color:var(--dim);font-size:.9rem}
.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.85rem;font-variant-numeric:tabular-nums}
td,th{padding:.2rem .6rem;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}td:first-child,th:first-child{text-align:left}
nav a{margin-right:1rem}a{color:inherit}
"""


DPI, COLOURS = 100, 240


def reduced(buffer):
    """The PNG with a palette: a third of the bytes, and lines look the same."""
    small = io.BytesIO()
    Image.open(buffer).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE).save(small, format="png", optimize=True)
    return small.getvalue()


def settings(palette):
    p = PALETTES[palette]
    return {"figure.facecolor": p["back"], "axes.facecolor": p["back"], "savefig.facecolor": p["back"], "text.color": p["ink"], "axes.labelcolor": p["ink"],
            "axes.edgecolor": p["ink"], "xtick.color": p["ink"], "ytick.color": p["ink"], "grid.color": p["grid"], "axes.grid": True, "grid.linewidth": 0.6,
            "axes.prop_cycle": plt.cycler(color=p["lines"]), "font.size": 9, "axes.titlesize": 10, "legend.frameon": False, "legend.fontsize": 8,
            "axes.spines.top": False, "axes.spines.right": False, "lines.markersize": 4, "axes.axisbelow": True, "figure.constrained_layout.use": True, "figure.constrained_layout.h_pad": 0.08}


class Page:
    def __init__(self, title):
        self.title, self.body, self.sections = title, [], []

    def section(self, title):
        name = f"s{len(self.sections)}"
        self.sections.append((name, title))
        self.body.append(f'<h2 id="{name}">{html.escape(title)}</h2>')

    def text(self, text):
        self.body.append(f"<p>{html.escape(text)}</p>")

    def figure(self, draw, caption):
        """draw() makes a matplotlib figure in the current style and returns it."""
        pictures = {}
        for palette in PALETTES:
            with plt.rc_context(settings(palette)):
                drawn, buffer = draw(), io.BytesIO()
                drawn.savefig(buffer, format="png", dpi=DPI, bbox_inches="tight")
                plt.close(drawn)
            pictures[palette] = "data:image/png;base64," + base64.b64encode(reduced(buffer)).decode()
        self.body.append(f'<figure><picture><source media="(prefers-color-scheme: dark)" srcset="{pictures["dark"]}"><img src="{pictures["light"]}" '
                         f'alt="{html.escape(caption)}"></picture><figcaption>{html.escape(caption)}</figcaption></figure>')

    def table(self, heading, rows, caption):
        cells = "".join(f"<th>{html.escape(str(h))}</th>" for h in heading)
        lines = "".join("<tr>" + "".join(f"<td>{html.escape(str(c))}</td>" for c in row) + "</tr>" for row in rows)
        self.body.append(f'<figure><figcaption>{html.escape(caption)}</figcaption><div class="wide"><table><tr>{cells}</tr>{lines}</table></div></figure>')

    def write(self, path):
        links = "".join(f'<a href="#{name}">{html.escape(title)}</a>' for name, title in self.sections)
        path.write_text(f'<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{html.escape(self.title)}</title>'
                        f"<style>{STYLE}</style><h1>{html.escape(self.title)}</h1><nav>{links}</nav>{''.join(self.body)}</html>\n", encoding="utf-8")
