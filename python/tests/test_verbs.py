"""Verbs of jobs that make several files, drawings, open surfaces, or none: as the program's `batch` has them."""

from __future__ import annotations

import json
from typing import Any, Dict, List

import pytest

import trisect


@pytest.fixture
def folder(tmp_path: Any) -> Any:
    """A block, a tool, a sheet that passes through, two bodies in one file, and what is open."""
    trisect.cuboid([0, 0, 0], [4, 2, 2]).save(tmp_path / "block.ply")
    trisect.cuboid([1, -1, -1], [2, 3, 3]).save(tmp_path / "tool.ply")
    corners = [[3, -1, -1], [3, 3, -1], [3, 3, 3], [3, -1, 3]]
    trisect.Mesh(corners, [[0, 1, 2, 3]]).save(tmp_path / "sheet.ply")
    pair = trisect.union(trisect.cuboid([0, 0, 0], [1, 1, 1]), trisect.cuboid([3, 0, 0], [5, 1, 1]))
    pair.save(tmp_path / "pair.ply")
    trisect.Mesh(pair.vertices, pair.faces[1:]).save(tmp_path / "open.ply")
    pair.with_groups(["left half", "right"], [0] * 12 + [1] * 12).save(tmp_path / "grouped.obj")
    (tmp_path / "broken.ply").write_text("ply\nformat ascii 1.0\n")
    return tmp_path


def run(folder: Any, verb: str, inputs: Any, output: Any = None, **options: Any) -> Dict[str, Any]:
    """The report of a job."""
    said = {key.replace("_", "-"): value for key, value in options.items()}
    job = {"id": "j", "verb": verb, "inputs": inputs if isinstance(inputs, list) else [inputs], "output": output, "options": said}
    report = trisect.run_job(job, folder)
    # As a file of reports has it.
    text = json.dumps(report, allow_nan=False)
    loaded: Dict[str, Any] = json.loads(text)
    return loaded


def files(report: Dict[str, Any]) -> List[str]:
    """Names of what was written."""
    return [output["file"] for output in report["outputs"]]


def test_section(folder: Any) -> None:
    report = run(folder, "section", "block.ply", "out/layers.json", heights="0.5:1:2.5")
    assert report["status"] == "done", report
    assert [(layer["name"], layer["height"], layer["area"], layer["polygons"], layer["holes"]) for layer in report["sections"]] == [
        ("z=0.5", 0.5, 8.0, 1, 0), ("z=1.5", 1.5, 8.0, 1, 0), ("z=2.5", 2.5, 0.0, 0, 0),
    ]  # fmt: skip
    drawn = json.loads((folder / "out" / "layers.json").read_text())
    assert [layer["area"] for layer in drawn["layers"]] == [8.0, 8.0, 0.0]
    assert report["outputs"] == [
        {"file": "out/layers.json", "format": "json", "bytes": (folder / "out" / "layers.json").stat().st_size}
    ]
    across = run(folder, "section", "block.ply", heights=[1, 3], axis="x")
    assert [layer["area"] for layer in across["sections"]] == [4.0, 4.0] and "outputs" not in across
    # Planes of all kinds: an axis, coefficients, three points.
    planes = ["x=1", "0,1,0,1", "0,0,1,1,0,1,0,1,1"]
    report = run(folder, "section", "block.ply", "a.svg", plane=planes)
    assert [layer["name"] for layer in report["sections"]][0] == "x=1"
    assert [layer["area"] for layer in report["sections"]] == [4.0, 8.0, 8.0], report
    assert (folder / "a.svg").read_text().startswith("<")
    for wrong in ({}, {"plane": "z=1", "heights": 1}, {"heights": "1:0:2"}, {"heights": 1, "axis": "w"}, {"plane": "up"}):
        assert run(folder, "section", "block.ply", **wrong)["error"]["kind"] == "usage", wrong
    assert run(folder, "section", "block.ply", "a.ply", heights=1)["error"]["kind"] == "usage"
    assert run(folder, "section", ["block.ply", "tool.ply"], heights=1)["error"]["kind"] == "usage"


def test_split(folder: Any) -> None:
    report = run(folder, "split", "pair.ply", "out/body.ply")
    assert files(report) == ["out/body-1.ply", "out/body-2.ply"], report
    assert [(part["part"], part["volume"]) for part in report["results"]] == [("1", 2.0), ("2", 1.0)]
    assert trisect.load(folder / "out" / "body-2.ply").volume == 1.0
    report = run(folder, "split", "block.ply", "cell.ply", by="tool.ply")
    assert [(part["part"], part["volume"]) for part in report["results"]] == [
        ("difference", 12.0), ("intersection", 4.0), ("reverse", 12.0),
    ]  # fmt: skip
    assert files(report) == ["cell-difference.ply", "cell-intersection.ply", "cell-reverse.ply"]
    report = run(folder, "split", "block.ply", by="tool.ply", explode=True)
    assert [(part["part"], part["volume"]) for part in report["results"]] == [
        ("difference-1", 8.0), ("difference-2", 4.0), ("intersection-1", 4.0), ("reverse-1", 12.0),
    ]  # fmt: skip
    report = run(folder, "split", "block.ply", sheet=["sheet.ply"])
    assert [part["volume"] for part in report["results"]] == [12.0, 4.0], report
    report = run(folder, "split", "grouped.obj", "half.ply", groups=True)
    assert [(part["part"], part["closed"]) for part in report["results"]] == [("1-left_half", True), ("2-right", True)], report
    assert files(report) == ["half-1-left_half.ply", "half-2-right.ply"]
    for wrong in ({"by": "tool.ply", "groups": True}, {"explode": True}, {"plane": "z=1"}):
        assert run(folder, "split", "block.ply", **wrong)["error"]["kind"] == "usage", wrong
    # What the input is mended by is for the others too.
    trisect.Mesh(trisect.load(folder / "tool.ply").vertices, trisect.load(folder / "tool.ply").faces[1:]).save(folder / "hole.ply")
    assert run(folder, "split", "block.ply", by="hole.ply")["error"]["operand"] == 2
    assert run(folder, "split", {"file": "block.ply", "fill-holes": True}, by="hole.ply")["status"] == "done"


def test_trim(folder: Any) -> None:
    report = run(folder, "trim", ["sheet.ply", "block.ply"], "in.ply", inside=True)
    assert report["status"] == "done", report
    assert (report["result"]["area"], report["result"]["closed"], report["result"]["volume"]) == (4.0, False, None)
    assert trisect.Mesh.load(folder / "in.ply").area == 4.0
    moved = {"file": "sheet.ply", "translate": [0, 1, 0], "rotate": [0, 0, 0]}
    assert run(folder, "trim", [moved, "block.ply"], outside=True)["result"]["area"] == 12.0
    for wrong in ({}, {"inside": True, "outside": True}):
        assert run(folder, "trim", ["sheet.ply", "block.ply"], **wrong)["error"]["kind"] == "usage", wrong
    assert run(folder, "trim", ["sheet.ply"], inside=True)["error"]["kind"] == "usage"
    assert run(folder, "trim", ["block.ply", "open.ply"], inside=True)["error"]["operand"] == 2


def test_check(folder: Any) -> None:
    report = run(folder, "check", ["block.ply", "pair.ply"])
    assert (report["status"], report["usable"]) == ("done", True), report
    assert [file["shells"] for file in report["files"]] == [1, 2] and report["files"][0]["self_crossings"]["count"] == 0
    report = run(folder, "check", ["block.ply", "open.ply", "broken.ply", "missing.ply"])
    assert (report["status"], report["usable"]) == ("failed", False)
    good, bare, broken, missing = report["files"]
    assert good["usable"] and good["format"] == "ply" and good["mending"]["turned"] == 0
    assert bare["error"]["kind"] == "unusable" and bare["error"]["remedy"] == "--closed-parts", bare["error"]
    assert bare["diagnosis"]["open_edges"]["count"] == 3 and bare["closed"] is False
    assert broken["error"]["kind"] == missing["error"]["kind"] == "unreadable"
    assert run(folder, "check", {"file": "open.ply", "closed-parts": True})["files"][0]["usable"]
    assert run(folder, "check", "block.ply", "out.ply")["error"]["kind"] == "usage"


def test_cut_at_several_planes(folder: Any) -> None:
    report = run(folder, "cut", "block.ply", "p.ply", plane=["x=1", "z=1"])
    assert files(report) == ["p-aa.ply", "p-ba.ply", "p-ab.ply", "p-bb.ply"], report
    assert [piece["volume"] for piece in report["results"]] == [6.0, 2.0, 6.0, 2.0]
    report = run(folder, "cut", "block.ply", "q.ply", plane="x=1", cap="lid")
    assert files(report) == ["q-above.ply", "q-below.ply"]
    report = run(folder, "cut", "block.ply", "r.ply", plane=["x=1", "z=1"], keep="below")
    assert files(report) == ["r.ply"] and report["results"][0]["volume"] == 2.0
    for wrong in ({}, {"plane": "z=1", "keep": "left"}, {"plane": "z=1", "cap": "lid#ff0000"}, {"plane": ["z=1"] * 13}):
        assert run(folder, "cut", "block.ply", **wrong)["error"]["kind"] == "usage", wrong


def test_all_combinations_at_once(folder: Any) -> None:
    report = run(folder, "combine", ["block.ply", "tool.ply"], "c.ply", all=True)
    assert files(report) == ["c-union.ply", "c-intersection.ply", "c-difference.ply", "c-reverse.ply"], report
    assert [result["volume"] for result in report["results"]] == [28.0, 4.0, 12.0, 12.0]
    assert report["result"]["certificate"]["closed"]


def test_options_belong_to_verbs(folder: Any) -> None:
    for verb, option in (("union", {"plane": "z=1"}), ("section", {"embed": True}), ("check", {"rule": "nonzero"}), ("convert", {"snap": 1})):
        report = run(folder, verb, "block.ply", **option)
        assert report["error"]["kind"] == "usage" and next(iter(option)) in report["error"]["message"], report
    # As on a command line, what is false is not said.
    assert run(folder, "union", ["block.ply", "tool.ply"], embed=False, snap=None)["status"] == "done"
    # An open surface is converted as it is.
    report = run(folder, "convert", "open.ply", "open.obj")
    assert report["status"] == "done" and report["input"]["triangles"] == 23, report


def test_a_model_may_be_a_trim(folder: Any) -> None:
    model = {"kind": "trim", "sheet": "sheet.ply", "inside": "block.ply"}
    trimmed = trisect.evaluate_model(model, folder=folder)
    assert isinstance(trimmed, trisect.Mesh) and trimmed.area == 4.0
