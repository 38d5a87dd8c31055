"""A document as one self-contained HTML page, which prints on A4."""

import base64
import re
from pathlib import Path

import jinja2

from extrados.show.document import Block, Document, Figure, Heading

TEMPLATE = """<!doctype html>
<html lang="{{ document.words.code }}"><head><meta charset="utf-8"><title>{{ document.title }}</title>
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<style>
@page{size:A4;margin:18mm 16mm}
body{font:15px/1.5 Georgia,serif;hyphens:manual;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}
h1,h2,h3{color:{{ document.colour }}}h1{font-size:1.6rem}h2{font-size:1.25rem;border-bottom:1px solid #ccc;margin-top:2.2rem}h3{font-size:1.05rem;margin-top:1.6rem}
p{white-space:pre-line}
p.answer{background:#f6f2ea;border-left:4px solid #8c7f66;padding:.7rem 1rem}
p.bad{background:#fbe9e7;border-left:4px solid #b3261e;padding:.7rem 1rem}
p.warn{background:#fff7e0;border-left:4px solid #d9a400;padding:.5rem 1rem}
figure{margin:1.2rem 0;break-inside:avoid}figure img{max-width:100%}figcaption{font-size:.85rem;color:#555}
table{border-collapse:collapse;font:13px/1.4 sans-serif}td,th{border-bottom:1px solid #ddd;padding:.15rem .7rem .15rem 0;text-align:left;vertical-align:top;overflow-wrap:break-word}td.long{overflow-wrap:anywhere;min-width:6em}table.block{width:100%}table.block td,table.block th{border:1px solid {{ document.colour }};padding:.2rem .5rem}.sign td{height:4.5rem}img.logo{float:right;max-height:4rem}
tr{break-inside:avoid}td.stands,td.holds{color:#3b7a57;font-weight:bold}td.collapses,td.cannot-stand,td.fails{color:#b3261e;font-weight:bold}td.open{color:#a86400;font-weight:bold}
nav ol{columns:2}nav a{color:inherit}
pre{background:#f7f7f7;padding:.7rem;overflow:auto;font-size:12px;white-space:pre-wrap}footer{margin-top:3rem;font-size:.8rem;color:#666}
@media print{body{font-size:10.5pt;margin:0;max-width:none;padding:0}h2,h3{break-after:avoid}.fresh{break-before:page}table{font-size:8.5pt}}
</style></head><body>
{% macro show(blocks) %}{% for kind, b, number in blocks %}
{% if kind == "Heading" %}<h{{ b.level + 1 }}{% if b.level == 1 %} id="part-{{ number }}"{% endif %}{% if b.fresh %} class="fresh"{% endif %}>{% if b.level == 1 %}{{ number }} {% endif %}{{ b.text }}</h{{ b.level + 1 }}>
{% elif kind == "Words" %}<p{% if b.look %} class="{{ b.look }}"{% endif %}{% if b.lang %} lang="{{ b.lang }}"{% endif %}>{{ b.text }}</p>
{% elif kind == "Table" %}<table>{% if b.head %}<tr>{% for cell in b.head %}<th>{{ cell }}</th>{% endfor %}</tr>{% endif %}
{% for row in b.rows %}<tr>{% for cell in row %}{% if loop.first %}<th>{{ cell }}</th>{% else %}<td{% if cell in looks %} class="{{ looks[cell]|replace(' ', '-') }}"{% elif long.search(cell) %} class="long"{% endif %}>{{ cell }}</td>{% endif %}{% endfor %}</tr>{% endfor %}</table>
{% elif kind == "Figure" %}<figure><img alt="{{ b.caption }}"{% if b.width < 1 %} style="max-width:{{ (100 * b.width)|round|int }}%"{% endif %} src="data:image/svg+xml;base64,{{ images[b.name] }}"><figcaption>{{ document.words("Figure") }} {{ number }}. {{ b.caption }}</figcaption></figure>
{% else %}<pre>{{ b.text }}</pre>{% endif %}{% endfor %}{% endmacro %}
{% if logo %}<img class="logo" alt="{{ document.words('Logo') }}" src="{{ logo }}">{% endif %}<h1>{{ document.title }}</h1>
<table class="block">{% for label, text in document.facts %}<tr><th>{{ label }}</th><td>{{ text }}</td></tr>{% endfor %}</table>
{{ show(opening) }}
{% if document.signatures %}<table class="block sign"><tr>{% for label, name in document.signatures %}<td>{{ label }}<br>{{ name }}</td>{% endfor %}</tr></table>{% endif %}
<nav><h2>{{ document.words("Contents") }}</h2><ol>{% for text in contents %}<li><a href="#part-{{ loop.index }}">{{ text }}</a></li>{% endfor %}</ol></nav>
{{ show(blocks) }}
<footer>{{ document.foot }}</footer>
</body></html>
"""
#: Words of verdicts that a table shows in their colour
LOOKS = ("stands", "collapses", "cannot stand", "open", "satisfied", "not satisfied", "holds", "fails")


def page(document: Document, folder: Path) -> str:
    """The page; pictures are folder/NAME.svg."""
    numbers = {"Heading": 0, "Figure": 0}
    opening, blocks = _numbered(document.opening, numbers), _numbered([*document.blocks, *document.annex], numbers)
    images = {
        b.name: base64.b64encode((folder / f"{b.name}.svg").read_bytes()).decode()
        for _, b, _ in (*opening, *blocks)
        if isinstance(b, Figure)
    }
    return (
        jinja2.Environment(autoescape=True)
        .from_string(TEMPLATE)
        .render(
            document=document,
            opening=opening,
            blocks=blocks,
            images=images,
            looks={document.words(look): look for look in LOOKS},
            long=re.compile(r"\S{28}"),
            logo=_logo(document, folder),
            contents=[b.text for _, b, _ in blocks if isinstance(b, Heading) and b.level == 1],
        )
    )


def _logo(document: Document, folder: Path) -> str:
    """The logo within the page."""
    if not document.logo:
        return ""
    kind = "png" if document.logo.endswith(".png") else "jpeg"
    return f"data:image/{kind};base64,{base64.b64encode((folder / document.logo).read_bytes()).decode()}"


def _numbered(blocks: list[Block], numbers: dict[str, int]) -> list[tuple[str, Block, int]]:
    """Kind, block and number of each; numbers: of the headings and figures before, which go on."""
    found = []
    for block in blocks:
        kind = type(block).__name__
        if (isinstance(block, Heading) and block.level == 1) or isinstance(block, Figure):
            numbers[kind] += 1
        found.append((kind, block, numbers.get(kind, 0)))
    return found
