"""Build the documentation site into build/site: the references, a gallery of cases run now, the dissertation's figures redrawn,
Sphinx, and FORD for the Fortran.

It requires the extra `docs` of pyproject.toml, installed first if it is missing. A warning is an error, and so is a link
that leads nowhere; nothing is loaded from the network, so that the site and its search work without one.
"""

import html
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
SITE, GALLERY, PAGE = ROOT / "build" / "site", ROOT / "docs" / "_gallery", ROOT / "docs" / "gallery.md"
REDRAWN = dissertation.PLACE / "redrawn.md"
#: Decks of the gallery, each with the analysis whose first figure is shown; together they take about a minute
SHOWN = [
    ("arch/oppenheim", "tilt"), ("arch/oppenheim-domain", "failure-domain"), ("arch/figure-5-4", "failure-curves"), ("vault/dejong-a", "tilt"),
    ("bridge/road", "moving-load"), ("limit/tied-arch", "tilt"), ("limit/settling-pier", "supports"), ("solid/corner", "tilt"),
    ("rocking/el-centro-block", "rocking-spectrum"), ("motion/el-centro", "motion"), ("dem/oppenheim", "dem"), ("codes/facade", "local-mechanism"),
]  # fmt: skip
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
    r"<!-- Bootstrap -->.*?(?=<!-- Font Awesome)|<!-- MathJax -->.*?(?=<!-- Other scripts)|<script>\s*// Enable Bootstrap.*?</script>",
    re.S,
)


def gallery() -> None:
    """docs/gallery.md, and its figures, by running the cases."""
    import extrados

    shutil.rmtree(GALLERY, ignore_errors=True)
    GALLERY.mkdir()
    lines = ["# Gallery", "", "Made by running these decks of `cases/`, each with its first figure."]
    for case, analysis in SHOWN:
        run = extrados.run(ROOT / "cases" / f"{case}.toml")
        drawn = run.plot(analysis)
        if not len(drawn):
            told = [f"{row['name']}: {row['status']} {row['reason']}" for row in run.analyses]
            sys.exit(f"cases/{case}.toml: {analysis} has no figure; {'; '.join(told)}")
        name = next(iter(drawn))
        picture = GALLERY / f"{case.replace('/', '-')}.png"
        drawn[name].savefig(picture, format="png")
        title = run.summary["deck"]["title"] or case
        lines += [
            "",
            f"## {title}",
            "",
            f"`cases/{case}.toml`, `{analysis}`: {drawn.captions[name]}",
            "",
            f"![{drawn.captions[name]}](_gallery/{picture.name})",
        ]
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")


def redrawn() -> None:
    """docs/dissertation/redrawn.md: the pictures that its pages name, by running their decks; slow cases are skipped."""
    import extrados

    runs: dict = {}
    slow: set[str] = set()
    lines = [
        "# Redrawn now",
        "",
        "Made by running the decks that the pages of the chapters name, as this site was built.",
    ]
    for figure, shows, by, *_ in dissertation.rows():
        for case, names in dissertation.redrawn_by(by):
            if not names:
                continue
            deck = ROOT / "cases" / f"{case}.toml"
            if tomllib.loads(deck.with_suffix(".expect.toml").read_text(encoding="utf-8")).get("slow"):
                slow.add(case)
                continue
            if case not in runs:
                run = extrados.run(deck)
                runs[case] = {
                    title: drawn[title] for row in run.analyses for drawn in [run.plot(row["name"])] for title in drawn
                }
            for name in names:
                if name not in runs[case]:
                    sys.exit(f"cases/{case}.toml draws no {name}, which docs/dissertation names for Fig. {figure}")
                picture = GALLERY / f"{case.replace('/', '-')}-{name}.png"
                runs[case][name].savefig(picture, format="png")
                if f"## Fig. {figure}: {shows}" not in lines:
                    lines += ["", f"## Fig. {figure}: {shows}"]
                lines += ["", f"`cases/{case}.toml`:", "", f"![Fig. {figure}](../_gallery/{picture.name})"]
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
            mark = unquote(parts.fragment)
            if not to.exists() or (mark not in ("", "top") and to in places and mark not in places[to]):
                wrong.append(f"{page.relative_to(site.resolve())}: {link} leads nowhere")
    return wrong


def main() -> None:
    """The site; `--quick` skips the slow parts, the gallery and the Fortran reference."""
    extras.install("docs")
    (ROOT / "build").mkdir(exist_ok=True)
    quick = "--quick" in sys.argv
    if quick:
        PAGE.write_text("# Gallery\n\nNot part of this quick build.\n", encoding="utf-8")
        REDRAWN.write_text("# Redrawn now\n\nNot part of this quick build.\n", encoding="utf-8")
    else:
        gallery()
        redrawn()
    shutil.rmtree(SITE, ignore_errors=True)
    subprocess.run(
        [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", ROOT / "docs", SITE], check=True
    )
    if not quick:
        fortran()
        if wrong := broken(SITE):
            sys.exit("\n".join(wrong[:40]))
    print(f"Site: {SITE / 'index.html'}")


if __name__ == "__main__":
    main()
