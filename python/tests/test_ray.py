"""Jobs and unions as tasks of Ray, on a cluster of this machine's processes."""

from __future__ import annotations

import json
from typing import Any, Iterator

import numpy as np
import pytest

import trisect

ray = pytest.importorskip("ray")


@pytest.fixture(scope="module")
def cluster() -> Iterator[None]:
    """Two workers."""
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    yield
    ray.shutdown()


def test_jobs_are_reported_once_though_workers_die(cluster: None, tmp_path: Any) -> None:
    import trisect.ray

    cube = trisect.cuboid([0, 0, 0], [1, 1, 1])
    cube.save(tmp_path / "cube.ply")
    jobs = [
        {"id": str(i), "verb": "union", "inputs": ["cube.ply", {"file": "cube.ply", "translate": [i / 32, 0, 0]}], "output": f"{i}.ply"}
        for i in range(20)
    ]
    jobs.append({"id": "no", "verb": "union", "inputs": ["nothing.ply"]})
    lines = "".join(json.dumps(job) + "\n" for job in jobs)
    (tmp_path / "jobs.jsonl").write_text(lines)
    summary = trisect.ray.batch(tmp_path / "jobs.jsonl", tmp_path / "reports.jsonl", in_flight=4)
    assert (summary.done, summary.failed) == (20, 1)
    reports = [json.loads(line) for line in (tmp_path / "reports.jsonl").read_text().splitlines()]
    assert sorted(report["id"] for report in reports) == sorted(str(job["id"]) for job in jobs)
    alone = cube | cube.translated([7 / 32, 0, 0])
    alone.save(tmp_path / "alone.ply")
    assert (tmp_path / "alone.ply").read_bytes() == (tmp_path / "7.ply").read_bytes()
    assert trisect.ray.batch(tmp_path / "jobs.jsonl", tmp_path / "reports.jsonl").skipped == 21
    # The folder as an address.
    pytest.importorskip("fsspec")
    assert trisect.ray.batch([{**jobs[0], "output": "there.ply"}], folder=tmp_path.as_uri()).done == 1
    assert (tmp_path / "there.ply").exists()


def test_a_tiled_union_is_the_union(cluster: None) -> None:
    import trisect.ray

    ball = trisect.icosphere(0.7, level=1)
    places = [(x, y, z) for x in range(4) for y in range(4) for z in range(3)]
    parts = [ball.rotated("z", 7 * i).translated(place) for i, place in enumerate(places)]
    tiled = trisect.ray.union(parts, tiles=(2, 2, 1))
    alone = trisect.union(parts)
    assert tiled.solid.volume == pytest.approx(alone.volume, rel=1e-12)
    assert tiled.solid.is_manifold == alone.is_manifold
    assert (tiled.solid.components, tiled.solid.genus) == (alone.components, alone.genus)
    assert (tiled.tiles, tiled.merges) == (4, 3) and tiled.moved > 0
    with pytest.raises(trisect.ArgumentError):
        trisect.ray.union(parts, tiles=(0, 1, 1))


@pytest.mark.parametrize("operation", ["union", "intersection", "difference"])
def test_slabs_of_a_large_pair_fit_together(cluster: None, operation: str) -> None:
    import trisect.ray

    a = trisect.icosphere(1.0, level=3)
    b = a.rotated([1, 2, 3], 40).translated([0.5, 0.1, 0.2])
    slabs = trisect.ray.combine_large(operation, a, b, slabs=4)
    alone = getattr(trisect, operation)(a, b)
    assert slabs.solid.volume == pytest.approx(alone.volume, rel=1e-12)
    assert slabs.solid.is_manifold and (slabs.solid.components, slabs.solid.genus) == (1, 0)
    assert slabs.tiles == 4 and np.isfinite(slabs.seconds)


def test_slabs_of_what_crosses_itself_are_resolved(cluster: None) -> None:
    import trisect.ray

    ball = trisect.icosphere(1.0, level=2)
    parts = [ball.rotated([1, 2, 3], 25 * i).translated([0.7 * i, 0.05 * i, 0]) for i in range(3)]
    faces = [part.faces + sum(len(other.vertices) for other in parts[:i]) for i, part in enumerate(parts)]
    crossing = trisect.Solid(np.vstack([part.vertices for part in parts]), np.vstack(faces))
    known = trisect.Solid(crossing.vertices, crossing.faces)
    assert known.self_crossings()
    other = ball.translated([0.4, 0.6, 0.1])
    for rule in ("positive", "even-odd"):
        alone = trisect.difference(crossing, other, rule=rule)
        for operand in (trisect.Solid(crossing.vertices, crossing.faces), known):
            slabs = trisect.ray.combine_large("difference", operand, other, slabs=5, rule=rule)
            assert slabs.solid.volume == pytest.approx(alone.volume, rel=1e-12), rule
            assert slabs.solid.components == alone.components


def test_parts_of_all_kinds_are_packed(cluster: None) -> None:
    import trisect.ray

    cube = trisect.cuboid([0, 0, 0], [1, 1, 1])
    heat = cube.translated([0.5, 0.5, 0.5]).with_attribute("_HEAT", np.arange(8.0).reshape(-1, 1))
    parts = [cube, heat, trisect.Solid.empty(), cube.translated([5, 0, 0]) | cube.translated([5.5, 0, 0])]
    tiled = trisect.ray.union(parts, tiles=(2, 1, 1))
    assert tiled.solid.volume == trisect.union(parts).volume == 1.875 + 1.5
    assert list(tiled.solid.attributes) == ["_HEAT"] and set(tiled.steps) == {"given out", "done", "here"}
