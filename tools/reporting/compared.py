# SPDX-License-Identifier: Apache-2.0
"""docs/METHODS-COMPARED.md as a page with pictures: under each table a row of details for every scene in it, the reference first."""
import base64
import html
import io

import markdown
import numpy
from PIL import Image

from .page import STYLE

WIDE, HIGH = 160, 120  # of a detail, shown twice as large
DETAILS = """
.details{display:flex;flex-wrap:wrap;gap:.6rem;margin:.4rem 0 1.2rem}.details figure{margin:0}
.details img{width:320px;height:240px;image-rendering:pixelated;display:block}
@media(max-width:50rem){.details img{width:160px;height:120px}}
"""


def load(path):
    with Image.open(path) as picture:
        return numpy.asarray(picture.convert("RGB"), dtype=numpy.int16)


def place_of_most_error(reference, pictures):
    """Left and top of the detail in which the pictures, all together, are furthest from the reference; in steps of 20 pixels."""
    error = sum(((p - reference).astype(numpy.int64) ** 2).sum(axis=2) for p in pictures)
    total = numpy.pad(error.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    places = [(int(total[y + HIGH, x + WIDE] - total[y, x + WIDE] - total[y + HIGH, x] + total[y, x]), x, y)
              for y in range(0, error.shape[0] - HIGH + 1, 20) for x in range(0, error.shape[1] - WIDE + 1, 20)]
    return max(places)[1:]


def detail(picture, at, caption):
    x, y = at
    png = io.BytesIO()
    Image.fromarray(picture[y:y + HIGH, x:x + WIDE].astype(numpy.uint8)).save(png, format="png", optimize=True)
    label = html.escape(caption)
    return f'<figure><img alt="{label}" src="data:image/png;base64,{base64.b64encode(png.getvalue()).decode()}"><figcaption>{label}</figcaption></figure>'


def details_of(scene, reference, rows):
    """rows: captions and files."""
    truth = load(reference)
    pictures = [load(path) for _, path in rows]
    at = place_of_most_error(truth, pictures)
    shown = [detail(truth, at, "reference"), *(detail(p, at, caption) for p, (caption, _) in zip(pictures, rows))]
    return f'<p class="dim">{html.escape(scene)}: {WIDE}x{HIGH} pixels from ({at[0]}, {at[1]}), where the pictures err most, shown twice as large</p><div class="details">{"".join(shown)}</div>'


def write_page(document, sections, path):
    """sections: by a table's name, scene, reference and rows of details_of()."""
    text = document.read_text(encoding="utf-8")
    for name, scenes in sections.items():
        start = text.index(f"<!-- table {name} -->")
        end = text.index("<!-- end -->", start) + len("<!-- end -->")
        text = text[:end] + "\n\n" + "\n\n".join(details_of(*s) for s in scenes) + "\n\n" + text[end:]
    body = markdown.markdown(text, extensions=["tables", "fenced_code"])
    title = text.split("\n", 1)[0].lstrip("# ")
    path.write_text(f'<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{html.escape(title)}</title>'
                    f"<style>{STYLE}{DETAILS}</style>{body}</html>\n", encoding="utf-8")
