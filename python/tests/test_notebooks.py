"""The notebooks, executed from their first cell to their last as they stand."""

from __future__ import annotations

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient
from runs import MODELS, ROOT, program

NOTEBOOKS = sorted((ROOT / "python" / "notebooks").glob("*.ipynb"))
#: For a cell, s; a sweep takes a few.
PATIENCE = 120


def test_there_are_notebooks() -> None:
    assert len(NOTEBOOKS) == 2


@pytest.mark.needs_program
@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_a_notebook(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    notebook = nbformat.read(file, as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert not any(cell.outputs or cell.execution_count for cell in code), "outputs are not kept: clear them"
    monkeypatch.setenv("ISOLA_BIN", str(program().absolute()))
    monkeypatch.setenv("ISOLA_MODELS", str(MODELS))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    NotebookClient(notebook, timeout=PATIENCE, resources={"metadata": {"path": tmp_path}}).execute()
    outputs = [output for cell in code for output in cell.outputs]
    pictures = [output for output in outputs if "image/png" in output.get("data", {})]
    assert len(pictures) >= 3
    said = "".join(output.get("text", "") for output in outputs if output.get("name") == "stderr")
    assert "Warning" not in said, said
    # Of a sweep's progress the last line is left, whole.
    lines = [text for output in outputs if (text := output.get("data", {}).get("text/plain", "")).startswith("finished")]
    assert len(lines) == 1 and " branches in " in lines[0], lines
    # Below it stands what was found.
    found = "".join(output.get("text", "") for output in outputs if output.get("name") == "stdout")
    assert "main peak" in found and "Looked for: " in found
