"""Run all benchmarks, or those named: python -m tests.bench [arch ...]."""

import importlib
import pkgutil
import sys

import tests.bench as here

names = [m.name for m in pkgutil.iter_modules(here.__path__) if m.name.startswith("bench_")]
wanted = [n for n in names if not sys.argv[1:] or n.removeprefix("bench_") in sys.argv[1:]]
for name in wanted:
    importlib.import_module(f"tests.bench.{name}").main()
