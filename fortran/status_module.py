"""Write the Fortran module common_status from the one list in c/include/extrados_status.h."""

import re
import sys

header, out = sys.argv[1:]
entries = re.findall(r'ENTRY\((\d+), (\w+), "([^"]*)"\)', open(header, encoding="utf-8").read())
if not entries:
    sys.exit(f"{header}: no ENTRY lines found")
lines = [
    "!> Status codes, generated from c/include/extrados_status.h: edit that list.",
    "module common_status",
    "   use, intrinsic :: iso_c_binding, only : c_int",
    "   implicit none",
    "   public",
    *(f"   integer(c_int), parameter :: status_{name} = {code}_c_int  !! {text}" for code, name, text in entries),
    "end module common_status",
]
with open(out, "w", encoding="utf-8") as file:
    file.write("\n".join(lines) + "\n")
