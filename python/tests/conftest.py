"""Runs that several tests read."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from fake import Coordinator
from runs import MODELS, isola


@pytest.fixture(scope="session")
def blade(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished run with contact, friction and two modes followed; not to be changed."""
    folder = tmp_path_factory.mktemp("blade") / "run"
    study = MODELS / "rotor67" / "study.toml"
    isola(
        "sweep", study, "--out", folder, "--amplitudes", "20,40", "--workers", 2, "--set", "harmonics.count=3"
    )
    return folder


@pytest.fixture(scope="session")
def damper(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished run with isolas at several levels; not to be changed."""
    folder = tmp_path_factory.mktemp("damper") / "run"
    study = MODELS / "nonlinear_damper" / "study.toml"
    isola("sweep", study, "--out", folder, "--amplitudes", "0.004:0.007:0.001", "--workers", 2)
    return folder


@pytest.fixture
def coordinator() -> Iterator[Coordinator]:
    """A coordinator of Python, whose run tests make up."""
    with Coordinator() as fake:
        yield fake


@pytest.fixture
def copy(damper: Path, tmp_path: Path) -> Path:
    """The run with isolas, to be damaged."""
    folder = tmp_path / "run"
    shutil.copytree(damper, folder)
    return folder
