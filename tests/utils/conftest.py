# SPDX-License-Identifier: GPL-3.0-or-later
"""Options and fixtures of these tests: `--program` gives the program dd3imp."""

from pathlib import Path

import pytest


def pytest_addoption(parser):
    parser.addoption("--program", type=Path, help="the program dd3imp")


def pytest_configure(config):
    config.addinivalue_line("markers", "slow: run by tests/slow_utils.py alone")


@pytest.fixture(scope="session")
def program(request):
    """Return the path of the program."""
    path = request.config.getoption("--program")
    if path is None:
        pytest.skip("without --program")
    return path.resolve()


@pytest.fixture(autouse=True)
def in_folder(tmp_path, monkeypatch):
    """Work in the folder of the test."""
    monkeypatch.chdir(tmp_path)
