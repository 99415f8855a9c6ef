"""The guide's code, from top to bottom."""

from __future__ import annotations

import pathlib
import re
from typing import Any

import pytest

GUIDE = pathlib.Path(__file__).parents[2] / "docs" / "python.md"


def test_the_guide_runs(tmp_path: Any, monkeypatch: Any) -> None:
    if not GUIDE.exists():
        pytest.skip("the guide is not here")
    blocks = re.findall(r"^```python\n(.*?)^```", GUIDE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert len(blocks) > 8
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for number, block in enumerate(blocks, 1):
        exec(compile(block, f"{GUIDE.name}, block {number}", "exec"), names)
    pictures = sorted(path.name for path in tmp_path.glob("*.png"))
    assert pictures == ["python-cage.png", "python-cut.png", "python-drilled.png", "python-gyroid.png"]
    # Every picture that it shows is there.
    for picture in re.findall(r"\(images/([^)]*)\)", GUIDE.read_text(encoding="utf-8")):
        assert (GUIDE.parent / "images" / picture).exists(), picture
