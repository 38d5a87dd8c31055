"""Commands that print reference information: keys of decks and results, starter decks, cases, version."""

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from extrados._build_info import VERSION
from extrados.cli.terminal import NOT_DONE, WRONG_DECK, err_console, out_console


def _kinds(begun: str) -> list[str]:
    """The kinds that begin so, for the shell that completes a word."""
    from extrados import kinds

    return [kind for there in kinds.TABLES.values() for kind in there if kind.startswith(begun)]


def _words(begun: str) -> list[str]:
    """The words of `explain` that begin with a text."""
    from extrados.decks import synonyms
    from extrados.decks.explain import facts

    tables = facts()
    known = [table.kind or table.section for table in tables]
    known += [f"{table.kind or table.section}.{name}" for table in tables for name in table.keys]
    known += [name.rsplit(".", 1)[-1] for table in tables for name in table.keys] + synonyms.words()
    return sorted({word for word in known if word.startswith(begun) and " " not in word})


def schema(results: Annotated[bool, typer.Option("--results", help="print the JSON Schema of summary.json instead")] = False) -> None:
    """Print the JSON Schema of decks, for editors, or of results."""
    if results:
        from extrados.results.explain import json_schema
    else:
        from extrados.decks.explain import json_schema

    print(json.dumps(json_schema(), indent=1))


def explain(
    words: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[WORD]",
            help="key, kind or section of a deck; technical term; or results, results.KIND, results.KIND.KEY",
            autocompletion=_words,
        ),
    ] = None,
    manual: Annotated[bool, typer.Option("--manual", help="print the whole reference manual of decks in Markdown")] = False,
    results: Annotated[bool, typer.Option("--results", help="print the whole reference manual of results in Markdown")] = False,
) -> None:
    """Explain a deck key, a kind, a result or a technical term: meaning, unit, default, bounds and source."""
    told: Any
    found: Any
    key = " ".join(words or [])
    if results or key.split(".")[0] == "results":
        from extrados.results import manual as told
        from extrados.results.explain import everything as found
    else:
        from extrados.decks import manual as told
        from extrados.decks.explain import facts as found

    if manual or results or not key:
        print(told.manual(found()))
        return
    try:
        print(told.explain(key, found()))
    except KeyError as error:
        err_console.say(error.args[0])
        raise typer.Exit(WRONG_DECK) from None


def new(
    kind: Annotated[
        str | None, typer.Argument(help="kind of analysis, structure or motion; default: list all kinds", autocompletion=_kinds)
    ] = None,
) -> None:
    """Print a commented starter deck that runs without changes."""
    if kind is None:
        from extrados import kinds
        from extrados.decks.explain import summary
        from extrados.decks.manual import first_sentence

        for section, there in kinds.TABLES.items():
            out_console.say(f"{section}:", "bold")
            for name in there:
                out_console.say(f"  {name:16} {first_sentence(summary(kinds.table(section, name)))}")
        return
    from extrados.decks.explain import starter

    try:
        print(starter(kind))
    except KeyError as error:
        err_console.say(error.args[0])
        raise typer.Exit(WRONG_DECK) from None


def cases(
    folder: Annotated[Path | None, typer.Argument(help="folder; default: ./cases if it exists, or the shipped cases")] = None,
) -> None:
    """List the decks below a folder with their titles."""
    from extrados.decks.reader import LARGEST
    from extrados.decks.toml import loads
    from extrados.schema import files
    from extrados.schema.places import CASES

    if folder is None:
        folder = here if (here := Path("cases")).is_dir() else CASES
    found = False
    for path in sorted(folder.rglob("*.toml")):
        if path.name.endswith(".expect.toml"):
            continue
        try:
            title = loads(files.read(path, LARGEST).text()).get("title", "")
        except ValueError:
            title = "(cannot be read)"
        out_console.say(f"{path}: {title}")
        found = True
    if not found:
        err_console.say(f"no decks below {folder}")
        raise typer.Exit(NOT_DONE)


def version() -> None:
    """Version, commit and compilers."""
    from extrados.running.provenance import provenance

    made = provenance()
    print(" ".join(filter(None, ("extrados", VERSION, made["commit"], f"({made['compiler']}, {made['build_type']})"))))
