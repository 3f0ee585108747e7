"""What documents show runs: the examples of both READMEs, the examples, the notebooks."""

import runpy
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted((ROOT / "python" / "notebooks").glob("*.ipynb"))


def blocks(document: Path) -> list[str]:
    parts = document.read_text(encoding="utf-8").split("```python\n")[1:]
    return [part.split("```")[0] for part in parts]


@pytest.mark.parametrize("document", [ROOT / "README.md", ROOT / "python" / "README.md"], ids=str)
def test_code_of_documents_runs(document: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    codes = blocks(document)
    assert codes
    for code in codes:
        exec(compile(code, str(document), "exec"), {})
    assert capsys.readouterr().out.startswith("solved ")


@pytest.mark.parametrize("name", ["trunk", "own_solver"])
def test_examples_run(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(ROOT / "python" / "examples" / f"{name}.py"), run_name="__main__")
    told = capsys.readouterr().out
    assert {"trunk": "Result: solved", "own_solver": "trust-constr"}[name] in told


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run(path: Path) -> None:
    kept = nbformat.read(path, as_version=4)
    run = nbformat.from_dict({**kept, "cells": [{**cell, **({"outputs": []} if "outputs" in cell else {})} for cell in kept.cells]})
    NotebookClient(run, timeout=600, startup_timeout=600, resources={"metadata": {"path": str(path.parent)}}).execute()

    def outputs(notebook: nbformat.NotebookNode) -> list[list[str]]:
        cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
        return [sorted({output.output_type for output in cell.outputs if output.get("name") != "stderr"}) for cell in cells]

    # The saved ones are those of this code; a kernel may split what is printed into several messages, and warns of what a busy machine does.
    assert outputs(run) == outputs(kept) and sum(map(len, outputs(run))) > 2
