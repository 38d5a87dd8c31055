"""`python -m extrados.cli`."""

from extrados.cli import main

main()
