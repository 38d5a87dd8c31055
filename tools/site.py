"""Build the documentation site into build/site/VERSION: the references, pages with pictures of their decks, a gallery, notebooks
that are executed, the dissertation's figures redrawn, Sphinx, and FORD for the Fortran. build/site/index.html lists the versions.

It requires the extra `docs` of pyproject.toml, installed first if it is missing. A warning is an error, and so is a link
that leads nowhere; nothing is loaded from the network, so that the site and its search work without one.
"""

import html
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from urllib.parse import unquote, urlsplit

import dissertation
import extras

ROOT = Path(__file__).resolve().parents[1]
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
VERSIONS = ROOT / "build" / "site"
SITE, GALLERY, PAGE = VERSIONS / VERSION, ROOT / "docs" / "_gallery", ROOT / "docs" / "gallery.md"
REDRAWN = dissertation.PLACE / "redrawn.md"
#: Width of a picture of the gallery, in pixels
THUMBNAIL = 900
#: Decks of the gallery by topic, each with its analysis and figure (default: the first); together they take about three minutes
SHOWN: dict[str, list[tuple[str, ...]]] = {
    "Arches": [
        ("arch/oppenheim", "tilt"),
        ("arch/readme", "rocking"),
        ("limit/oppenheim", "thrust"),
        ("limit/oppenheim", "supports"),
        ("limit/arch-120", "tilt"),
        ("limit/loads", "thrust"),
        ("limit/tied-arch", "sweep", "sweep-mechanisms"),
        ("limit/lintel", "tilt"),
        ("arch/oppenheim-domain", "failure-domain"),
        ("arch/figure-5-4", "failure-curves"),
        ("dem/oppenheim", "dem"),
        ("sla/stones-arch", "sla", "sla-cracks"),
    ],
    "Bridges": [
        ("bridge/road", "moving-load"),
        ("bridge/bridgemill", "moving-load"),
        ("bridge/viaduct", "moving-load"),
        ("bridge/viaduct", "tilt"),
        ("bridge/barlae", "moving-load"),
    ],
    "Vaults and churches": [
        ("limit/church", "tilt"),
        ("limit/church", "imperfections"),
        ("vault/vezelay-like", "tilt"),
        ("vault/flyers", "tilt"),
        ("vault/dejong-a", "tilt"),
        ("vault/settlement", "supports"),
        ("vault/colombier-sweep", "sweep"),
        ("sla/stones-vault", "sla", "sla-cracks"),
        ("strengthen/nave", "strengthen"),
        ("shell/barrel-spread", "pushover", "pushover-space"),
    ],
    "Free-standing blocks, columns and frames": [
        ("rocking/housner", "rocking"),
        ("rocking/stack", "rocking", "rocking-shapes"),
        ("rocking/tendon", "rocking"),
        ("rocking/frame", "tilt"),
        ("rocking/soft-base", "rocking", "rocking-base"),
        ("rocking/el-centro-block", "rocking-spectrum"),
        ("rocking/el-centro-block", "harmonic-map"),
        ("rocking/overturning-rectangle", "failure-domain"),
        ("rocking/resonance", "resonance"),
        ("solid/column", "tilt"),
        ("solid/dem-nonsmooth", "dem"),
    ],
    "Walls": [
        ("sla/yi-wall-1", "sla", "sla-cracks"),
        ("sla/j4d", "sla", "sla-cracks"),
        ("sla/pier", "sla", "sla-cracks"),
        ("limit/wall-lourenco", "tilt"),
        ("limit/wall-magenes", "tilt"),
        ("limit/panel", "tilt"),
        ("sla/stones-brickwork", "sla", "sla-cracks"),
        ("codes/facade", "local-mechanism"),
        ("strengthen/wall", "strengthen"),
        ("rocking/facade", "rocking"),
    ],
    "Buildings, domes and chimneys": [
        ("assess/facade", "assess"),
        ("shell/room", "pushover", "pushover-space"),
        ("building/flange-joint", "pushover", "pushover-space"),
        ("solid/cross-vault", "tilt"),
        ("solid/dome", "tilt"),
        ("solid/chimney", "tilt"),
        ("codes/triumphal-arch", "local-mechanism"),
    ],
    "Ground motions and probability": [
        ("motion/el-centro", "motion"),
        ("motion/compatible", "motion", "motion-spectra"),
        ("motion/generated", "motion"),
        ("fragility/annual-rate", "fragility"),
        ("fragility/cloud", "fragility", "fragility-cloud"),
    ],
}
FORD = """project: extrados
summary: The Fortran core
src_dir: {root}/fortran
css: {root}/docs/fortran.css
output_dir: {out}
predocmark: >
docmark: !
display: public
         private
source: false
graph: false
search: false
preprocess: false
parallel: 0
"""
#: Parts of the pages of FORD that load from the network, and parts that depend on them
FROM_AFAR = re.compile(
    r"<!-- Bootstrap -->.*?(?=<!-- Font Awesome)|<!-- MathJax -->.*?(?=<!-- Other scripts)|<script>\s*// Enable Bootstrap.*?</script>", re.S
)


def gallery() -> None:
    """docs/gallery.md, and its thumbnails, by running the cases."""
    from drawings import KEPT, draw
    from PIL import Image

    shutil.rmtree(GALLERY, ignore_errors=True)
    GALLERY.mkdir()
    count = sum(map(len, SHOWN.values()))
    lines = [
        "# Gallery",
        "",
        f"For readers who look for an example near to their own task: {count} input decks with known results. The build of this site ran",
        "each of them. A caption has the title, the conclusion, the deck, and the time of the analysis on the machine of the build.",
    ]
    for topic, rows in SHOWN.items():
        lines += ["", f"## {topic}", "", "````{container} gallery"]
        for case, analysis, *figure in rows:
            made = draw(case, analysis, *figure)
            thumbnail = GALLERY / f"{Path(made.file).stem}.png"
            with Image.open(KEPT / made.file) as drawn:
                drawn.thumbnail((THUMBNAIL, THUMBNAIL), Image.Resampling.LANCZOS)
                drawn.convert("RGB").quantize(64).save(thumbnail, optimize=True)
            deck = f"{{download}}`cases/{case}.toml <../cases/{case}.toml>`"
            lines += [
                f"```{{figure}} _gallery/{thumbnail.name}",
                f":alt: {json.dumps(made.caption, ensure_ascii=False)}",
                f":target: _images/{thumbnail.name}",
                f"**{made.title}.** {first_sentence(made.conclusion)} {deck}, `{analysis}`, {made.seconds:.2g} s",
                "```",
            ]
        lines.append("````")
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")


def first_sentence(text: str) -> str:
    """Of a conclusion, without parentheses, as text of Markdown."""
    found = re.split(r"(?<=[.;]) (?=[A-Za-z])|\n", re.sub(r" \([^)]*\)", "", text), maxsplit=1)[0].rstrip(";:. ")
    return re.sub(r"([*_`<\[{])", r"\\\1", found) + "."


def redrawn() -> None:
    """docs/dissertation/redrawn.md: the pictures that its pages name, by running their decks; slow cases are skipped."""
    from drawings import KEPT, draw

    slow: set[str] = set()
    lines = ["# Redrawn now", "", "Made by running the decks that the pages of the chapters name, as this site was built."]
    for figure, shows, by, *_ in dissertation.rows():
        for case, names in dissertation.redrawn_by(by):
            expected = (ROOT / "cases" / f"{case}.toml").with_suffix(".expect.toml")
            if names and tomllib.loads(expected.read_text(encoding="utf-8")).get("slow"):
                slow.add(case)
                continue
            for name in names:
                picture = KEPT / draw(case, "", name).file
                if f"## Fig. {figure}: {shows}" not in lines:
                    lines += ["", f"## Fig. {figure}: {shows}"]
                shown = os.path.relpath(picture, REDRAWN.parent)
                lines += ["", f"`cases/{case}.toml`:", "", f"![Fig. {figure}]({shown})"]
    if slow:
        left = ", ".join(f"`cases/{case}.toml`" for case in sorted(slow))
        lines += ["", "## Not drawn", "", f"Decks that take minutes: {left}."]
    REDRAWN.write_text("\n".join(lines) + "\n", encoding="utf-8")


def fortran() -> None:
    """The reference of the Fortran core, from its comments."""
    project = ROOT / "build" / "ford.md"
    project.write_text(FORD.format(root=ROOT, out=SITE / "fortran"), encoding="utf-8")
    subprocess.run([sys.executable, "-m", "ford", project], check=True, stdout=subprocess.DEVNULL)
    for page in (SITE / "fortran").rglob("*.html"):
        page.write_text(FROM_AFAR.sub("", page.read_text(encoding="utf-8")), encoding="utf-8")


def broken(site: Path) -> list[str]:
    """Broken links of a site's pages, and items that they would load from the network: each as "page: link"."""
    wrong: list[str] = []
    places: dict[Path, set[str]] = {}
    pages = {page: page.read_text(encoding="utf-8") for page in sorted(site.resolve().rglob("*.html"))}
    for page, text in pages.items():
        places[page] = set(re.findall(r'\b(?:id|name)="([^"]+)"', text))
    for page, text in pages.items():
        for tag, link in re.findall(r"""<(\w+)\b[^>]*?\b(?:href|src)=["']([^"']+)["']""", text):
            parts = urlsplit(html.unescape(link))
            if parts.scheme or parts.netloc:
                if tag != "a" and parts.scheme != "data":
                    wrong.append(f"{page.relative_to(site.resolve())}: {link} is loaded from the network")
                continue
            to = (page.parent / unquote(parts.path)).resolve() if parts.path else page
            to = to / "index.html" if to.is_dir() else to
            marks = {parts.fragment, unquote(parts.fragment)}  # a browser tries the one, then the other
            if not to.exists() or (not marks & {"", "top"} and to in places and not marks & places[to]):
                wrong.append(f"{page.relative_to(site.resolve())}: {link} leads nowhere")
    return wrong


def list_versions() -> None:
    """index.html above the versions: it opens the newest, and lists all that were built here."""
    there = sorted(
        (place.name for place in VERSIONS.iterdir() if (place / "index.html").exists()),
        key=lambda name: [int(part) for part in name.split(".")],
        reverse=True,
    )
    links = "".join(f'<li><a href="{name}/index.html">extrados {name}</a></li>' for name in there)
    page = (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><meta http-equiv="refresh" content="3; url={there[0]}/index.html">'
        f"<title>extrados</title><h1>extrados: versions of the documentation</h1><ul>{links}</ul></html>\n"
    )
    (VERSIONS / "index.html").write_text(page, encoding="utf-8")


def main() -> None:
    """The site; `--quick` skips the slow parts, the gallery and the Fortran reference."""
    extras.install("docs")
    (ROOT / "build").mkdir(exist_ok=True)
    quick = "--quick" in sys.argv
    if quick:
        os.environ["EXTRADOS_QUICK_DOCS"] = "yes"
        PAGE.write_text("# Gallery\n\nNot part of this quick build.\n", encoding="utf-8")
        REDRAWN.write_text("# Redrawn now\n\nNot part of this quick build.\n", encoding="utf-8")
    else:
        gallery()
        redrawn()
    shutil.rmtree(SITE, ignore_errors=True)
    subprocess.run([sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", ROOT / "docs", SITE], check=True)
    if not quick:
        fortran()
        if wrong := broken(SITE):
            sys.exit("\n".join(wrong[:40]))
    list_versions()
    print(f"Site: {SITE / 'index.html'}")


if __name__ == "__main__":
    main()
