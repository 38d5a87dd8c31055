"""The texts at the top of a deck."""

#: Key -> its meaning
WORDS = {
    "title": "subject of the deck in one line; the title of report and figures",
    "note": "explanations and assumptions, printed in the report",
    "project": "name or number of the project, in the title block of the report",
    "client": "client, in the title block of the report",
    "office": "office that issues the report, in its title block",
    "reviewer": "person who reviews the report, in its title block",
    "revision": "revision of the report, in its title block",
    "language": "language of the report: en, it, es, fr or de; default en",
    "author": "person responsible for the deck, in the title block of the report",
    "date": "date of the deck, shown in the title block of the report; free text in any date format",
}

#: Languages of reports by their codes
LANGUAGES = ("en", "it", "es", "fr", "de")
