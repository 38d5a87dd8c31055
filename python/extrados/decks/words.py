"""The texts at the top of a deck."""

#: Key -> its meaning
WORDS = {
    "title": "subject of the deck in one line; the title of report and figures",
    "note": "explanations and assumptions, printed in the report",
    "project": "name or number of the project, in the title block of the report",
    "author": "person responsible for the deck, in the title block of the report",
    "date": "date of the deck, in the title block of the report, in any form",
}
