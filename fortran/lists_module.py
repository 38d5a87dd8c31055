"""Write a Fortran module of named numbers from the lists of c/include: common_status or common_lists."""

import re
import sys

header, out = sys.argv[1:]
text = open(header, encoding="utf-8").read()
module = "common_status" if header.endswith("status.h") else "common_lists"
lines = [
    f"!> Named numbers, generated from c/include/{re.split(r'[/]', header)[-1]}: edit that list.",
    f"module {module}",
    "   use, intrinsic :: iso_c_binding, only : c_int",
    "   implicit none",
    "   public",
]
found = 0
for name, body in re.findall(r"^#define EXTRADOS_(\w+)_LIST\(ENTRY\) \\\n((?:.*\\\n)*.*\n)", text, re.M):
    entries = re.findall(r'ENTRY\((\d+), (\w+), "([^"]*)"\)', body)
    if not entries or len(entries) != body.count("ENTRY("):
        sys.exit(f'{header}: {name} holds a line that is not an ENTRY(number, name, "word")')
    if len({code for code, *_ in entries}) != len(entries):
        sys.exit(f"{header}: {name} gives a number twice")
    found += len(entries)
    lines += [f"   integer(c_int), parameter :: {name.lower()}_{entry} = {code}_c_int  !! {word}" for code, entry, word in entries]
    lines += [f"   integer, parameter :: {name.lower()}_count = {len(entries)}"]
if not found:
    sys.exit(f"{header}: no list found")
with open(out, "w", encoding="utf-8") as file:
    file.write("\n".join([*lines, f"end module {module}"]) + "\n")
