"""report.toml: the template of an office. Language, title block, logo, colour, signatures, sections and their order."""

import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, field_validator

from extrados.results.store import StoreError
from extrados.schema import files
from extrados.schema.table import Table, key

#: Bytes of a template, and of a logo
LARGEST, LARGEST_LOGO = 20_000, 1_000_000
#: What the first bytes of a logo are
PICTURES = {".png": b"\x89PNG\r\n\x1a\n", ".jpg": b"\xff\xd8\xff", ".jpeg": b"\xff\xd8\xff"}
Section = Literal["answer", "building", "hazard", "analyses", "factors", "limits", "bibliography"]
SECTIONS: tuple[Section, ...] = ("answer", "building", "hazard", "analyses", "factors", "limits", "bibliography")
#: Entries of a title block, in their order, by the words of a deck
ENTRIES = {
    "project": "Project",
    "client": "Client",
    "office": "Office",
    "author": "Author",
    "reviewer": "Reviewer",
    "revision": "Revision",
    "date": "Date",
}
Text = Annotated[str, Field(max_length=200)]


class ReportTable(Table):
    """The keys of report.toml; entries of the title block that the deck does not give."""

    language: Literal["en", "it", "es", "fr", "de"] | None = key(None, "language of the report; default: language of the deck")
    project: Text = key("", "name or number of the project")
    client: Text = key("", "client")
    office: Text = key("", "office that issues the report")
    author: Text = key("", "author")
    reviewer: Text = key("", "reviewer")
    revision: Text = key("", "revision")
    date: Text = key("", "date of the report, in any form")
    fields: dict[Text, Text] = key({}, "further entries of the title block: label and text", max_length=12)
    signatures: list[Text] = key([], "labels of the fields for signatures; default: author and reviewer", max_length=6)
    logo: str | None = key(None, "PNG or JPEG file inside the template's folder", max_length=200)
    colour: str = key("#1f4e79", "colour of headings and rules: # and six hexadecimal digits", pattern=r"^#[0-9a-fA-F]{6}$")
    sections: list[Section] = key(
        list(SECTIONS), "sections that the report contains, in this order", min_length=1, max_length=len(SECTIONS)
    )
    figures: int = key(2, "number of figures of each analysis in the report; further figures are in the annex", ge=0, le=20)

    @field_validator("sections")
    @classmethod
    def _once(cls, value: list[Section]) -> list[Section]:
        if len(set(value)) < len(value):
            raise ValueError("each section once")
        return value


@dataclass(frozen=True)
class Template:
    """The checked table, and the logo's content with its ending."""

    table: ReportTable = field(default_factory=ReportTable)
    logo: bytes = b""
    suffix: str = ""


def read_template(path: Path) -> Template:
    """The template in a file; StoreError with every complaint."""
    try:
        data: dict[str, Any] = tomllib.loads(files.read(path, LARGEST).text())
        table = ReportTable.model_validate(data)
        if table.logo is None:
            return Template(table)
        if Path(table.logo).is_absolute():
            raise files.BadFile(f"{path}: `logo`: expected a file inside the template's folder, found the absolute path {table.logo}")
        suffix = Path(table.logo).suffix.lower()
        if suffix not in PICTURES:
            raise files.BadFile(f"{path}: `logo`: expected a name that ends in {', '.join(PICTURES)}, found {table.logo}")
        logo = files.read(table.logo, LARGEST_LOGO, path.resolve().parent).content
        if not logo.startswith(PICTURES[suffix]):
            raise files.BadFile(f"{path}: `logo`: the content of {table.logo} is not a {suffix[1:].upper()} picture")
        return Template(table, logo, suffix)
    except tomllib.TOMLDecodeError as error:
        raise StoreError(f"{path} is not valid TOML: {error}") from None
    except ValidationError as error:
        told = "; ".join(f"{'.'.join(map(str, one['loc'])) or 'template'}: {one['msg']}" for one in error.errors())
        raise StoreError(f"{path}: {told}") from None
    except (ValueError, RecursionError) as error:  # BadFile is one
        raise StoreError(str(error)) from None
