"""The examples of the README's chapter "From Python", one after the other, as they stand."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from runs import MODELS, ROOT, program

import isola_hbm


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


def blocks(file: Path, chapter: str, language: str) -> list[str]:
    """Code of a chapter in a language."""
    (text,) = re.findall(rf"^## {chapter}$(.*?)^## ", file.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def test_the_first_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a newcomer types, as the README says it: commands, files and Python."""
    path = f"{program().absolute().parent}{os.pathsep}{os.environ['PATH']}"
    monkeypatch.setenv("PATH", path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.delenv("ISOLA_BIN", raising=False)
    readme = ROOT / "README.md"
    (commands,) = blocks(readme, "A first isola", "sh")
    subprocess.run(["sh", "-ec", commands], cwd=tmp_path, check=True, capture_output=True, timeout=300)
    assert (tmp_path / "runs" / "first" / "report.html").is_file()
    model, study = blocks(readme, "A first isola", "toml")
    assert (tmp_path / "first" / "model.toml").read_text("utf-8") == model
    assert (tmp_path / "first" / "study.toml").read_text("utf-8") == study
    loaded, made = blocks(readme, "From Python", "python")
    subprocess.run([sys.executable, "-c", f"{loaded}\n{made}"], cwd=tmp_path, check=True, timeout=300)
    assert "0.7/isola 1" in isola_hbm.load(tmp_path / "runs" / "python")
    assert (tmp_path / "response.png").stat().st_size > 1000
    # The table is that of the sweep.
    rows = [line for text in blocks(readme, "A first isola", "text") for line in text.splitlines() if " of 2" in line]
    summary = (tmp_path / "runs" / "first" / "summary.csv").read_text("utf-8")
    assert len(rows) == 3
    for row in rows:
        peak = float(re.findall(r"([\d.]+(?:e[-\d]+)?) at ", row)[-1])
        assert any(abs(float(number) / peak - 1) < 1e-4 for number in re.findall(r"\d\.\d+(?:e[-\d]+)?", summary)), row


@pytest.mark.parametrize("file", ["README.md", "python/README.md"])
def test_the_wheel_is_called_what_a_release_calls_it(file: str) -> None:
    (version,) = re.findall(r'^version = "(.*)"$', (ROOT / "python" / "pyproject.toml").read_text("utf-8"), re.MULTILINE)
    (glibc,) = re.findall(r"^glibc=(\S+)$", (ROOT / "deploy" / "release.sh").read_text("utf-8"), re.MULTILINE)
    named = re.findall(r"\S+\.whl", (ROOT / file).read_text("utf-8"))
    assert {name.strip("'\"") for name in named} == {f"isola_hbm-{version}-py3-none-manylinux_{glibc}_x86_64.whl"}


def test_python_of_the_first_page_stands_by_itself() -> None:
    for block in blocks(ROOT / "README.md", "From Python", "python"):
        for name in re.findall(r"\b(isola_hbm|Law|Model)\b[.(]", block):
            assert re.search(rf"^(from \w+ )?import .*\b{name}\b", block, re.MULTILINE), (name, block)


def test_a_model_of_your_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", f"{program().absolute().parent}{os.pathsep}{os.environ['PATH']}")
    chapter = "A model of your own"
    model, study = blocks(ROOT / "README.md", chapter, "toml")
    (commands,) = blocks(ROOT / "README.md", chapter, "sh")
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "model.toml").write_text(model, "utf-8")
    (tmp_path / "own" / "study.toml").write_text(study, "utf-8")
    done = subprocess.run(["sh", "-ec", commands], cwd=tmp_path, check=True, capture_output=True, text=True, timeout=300)
    assert "9.0808 rad/s" in done.stdout and "15.5737 rad/s" in done.stdout
    run = isola_hbm.load(tmp_path / "runs" / "own")
    assert list(run) == ["0.4/main", "0.7/main", "0.7/isola 1", "1/main", "1/isola 1"]
    peaks = run.summary["amplitude_max"]
    assert 11.5 < peaks["1/isola 1"] / peaks["1/main"] < 12.5
    born = run.events.query("kind == 'birth'").groupby("source")["forcing"].min()
    assert abs(born["computed"] - 0.455) < 1e-3 and abs(born["predicted"] - 0.453) < 1e-3
    for picture in ("own.png", "map.png"):
        assert (tmp_path / picture).stat().st_size > 1000
