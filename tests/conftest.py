"""Shared by all tests: the folder of further ground motions, which are not part of the project."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def records() -> Path:
    """Real records that cannot be shipped; tests that need them skip where the folder is missing."""
    folder = Path(os.environ.get("EXTRADOS_RECORDS", ROOT.parent / "shared" / "records"))
    if not folder.is_dir():
        pytest.skip("the folder of further records is not here (EXTRADOS_RECORDS)")
    return folder
