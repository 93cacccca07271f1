"""The examples of the README's chapter "From Python", one after the other, as they stand."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from runs import MODELS, ROOT, program


def test_the_examples_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ISOLA_BIN", str(program().absolute()))
    text = (ROOT / "python" / "README.md").read_text("utf-8")
    (chapter,) = re.findall(r"^## From Python$(.*?)^## ", text, re.MULTILINE | re.DOTALL)
    examples = re.findall(r"^```python\n(.*?)^```$", chapter, re.MULTILINE | re.DOTALL)
    assert len(examples) >= 6
    shutil.copytree(MODELS / "nonlinear_damper", tmp_path / "models" / "nonlinear_damper")
    monkeypatch.setenv("MPLBACKEND", "Agg")
    command = [sys.executable, "-W", "error::UserWarning", "-c", "\n".join(examples)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "response.pdf").stat().st_size > 1000
    assert (tmp_path / "models" / "mine" / "model.toml").is_file()
    assert (tmp_path / "runs" / "mine" / "run.sqlite").is_file()
