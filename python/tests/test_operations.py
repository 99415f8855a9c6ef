"""Operations, their settings, and meshes of other packages."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import trisect


def test_operators(pair: Any) -> None:
    a, b = pair
    assert [(a | b).volume, (a & b).volume, (a - b).volume, (a ^ b).volume] == [1.875, 0.125, 0.875, 1.75]
    assert bool(a & b) and not (a & b.translated([9, 9, 9]))
    arrays = (b.vertices, b.faces)
    assert (a - arrays).volume == 0.875 and (arrays - a).volume == 0.875
    assert a.union(b).volume == 1.875 and a.difference(b, b).volume == 0.875 and a.intersection(b).volume == 0.125


def test_many_operands(pair: Any) -> None:
    a, b = pair
    cubes = [a.translated([0.5 * i, 0, 0]) for i in range(5)]
    assert trisect.union(cubes).volume == trisect.union(*cubes).volume == 3.0
    assert trisect.union(cube for cube in cubes).volume == 3.0
    assert trisect.union(tuple(cubes)).volume == 3.0
    assert trisect.union(a).volume == 1.0
    assert trisect.union((a.vertices, a.faces)).volume == 1.0
    with pytest.raises(trisect.ArgumentError):
        trisect.union()
    with pytest.raises(TypeError):
        trisect.union(a, 7)


def test_expressions(pair: Any) -> None:
    a, b = pair
    assert trisect.combine("a - b", a, b) == a - b
    assert trisect.combine("body & box", body=a, box=b, threads=1).volume == 0.125
    assert trisect.combine("atleast(2, a, b, c)", a, b, a).volume == 1.0
    both, rest = trisect.combine(["x & y", "x - y"], x=a, y=b)
    assert both.volume + rest.volume == a.volume
    with pytest.raises(trisect.ArgumentError, match="character 5"):
        trisect.combine("a - nothing", a, b)
    with pytest.raises(trisect.ArgumentError, match="twice"):
        trisect.combine("a", a, a=b)


def test_settings_do_what_they_say(pair: Any) -> None:
    a, b = pair
    touching = a.translated([1, 0, 0])
    assert trisect.union(a, touching).components == 1
    assert trisect.union(a, touching, contact="separate").components == 2
    near = a.translated([1 + 1e-12, 0, 0])
    assert trisect.union(a, near).components == 2
    snapped = trisect.union(a, near, snap=1e-9)
    assert snapped.components == 1 and snapped.certificate.snapping is not None
    double = trisect.Solid(np.vstack([a.vertices, b.vertices]), np.vstack([a.faces, b.faces + 8]))
    assert double.self_crossings().count > 0 and not a.self_crossings()
    assert trisect.resolve(double, rule="even-odd").volume == 1.75
    assert trisect.union(double, rules=["even-odd"]).volume == 1.75
    embedded = trisect.resolve(double, embed="single")
    assert embedded.certificate.embedding is not None and embedded.certificate.embedding.left == 0
    marked = trisect.difference(a, b, cut_faces="cut", cut_uv=("planar", 2.0))
    assert "cut" in marked.groups.names and "TEXCOORD_0" in marked.attributes
    for wrong in [{"rule": "odd"}, {"contact": "x"}, {"embed": "x"}, {"cut_uv": ("x", 1.0)}, {"threads": 0}, {"memory": "much"},
                  {"memory": -1}, {"threads": 1.5}, {"deadline": -1.0}, {"deadline": float("nan")}]:
        with pytest.raises(trisect.ArgumentError):
            trisect.union(a, b, **wrong)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="known are"):
        trisect.union(a, b, engine="x")  # type: ignore[call-arg]


def test_cuts_and_sections(pair: Any, tmp_path: Any) -> None:
    block = trisect.cuboid([0, 0, 0], [2, 2, 3])
    for plane in ("z=1", ("z", 1), ((0, 0, 1), 1.0), (0, 0, 1, 1), np.array([0, 0, 2.0, 2])):
        above, below = trisect.cut(block, plane)
        assert (above.volume, below.volume) == (8.0, 4.0)
    above, _ = trisect.cut(block, "x=1", cap="lid")
    assert "lid" in above.groups.names and set(above.origins.operand) == {0, 1}
    for wrong in ("w=1", "z", "z=a", (1, 2), ((0, 0, 0), 1.0), None):
        with pytest.raises(trisect.ArgumentError):
            trisect.cut(block, wrong)  # type: ignore[arg-type]
    hollow = block - trisect.cuboid([0.5, 0.5, -1], [1.5, 1.5, 4])
    [layer] = trisect.sections(hollow, "z=1")
    assert layer.area == 3.0 and layer.perimeter == 12.0
    [[outline, hole]] = layer.shapes
    assert outline.shape == (4, 2) and hole.shape == (4, 2) and (layer.rings[0][0][:, 2] == 1).all()
    layers = trisect.sections(hollow, heights=np.linspace(0, 3, 4), side="above", drawing=tmp_path / "layers.svg")
    assert [section.area for section in layers] == [3.0, 3.0, 3.0, 0.0] and not layers[3]
    assert "<svg" in (tmp_path / "layers.svg").read_text()
    assert len(trisect.sections(hollow, ["z=1", ((1, 1, 0), 2.0)], drawing=tmp_path / "a.dxf")) == 2
    with pytest.raises(trisect.ArgumentError):
        trisect.sections(hollow)


def test_split_and_trim(pair: Any) -> None:
    a, _ = pair
    two = a | a.translated([3, 0, 0])
    assert [body.volume for body in trisect.split(two)] == [1.0, 1.0] and trisect.split(trisect.Solid.empty()) == []
    halves = trisect.split(a, by=trisect.cuboid([0.25, -1, -1], [0.75, 2, 2]))
    assert sorted(cell.volume for cell in halves) == [0.25, 0.25, 0.5]
    sheet = trisect.Mesh([[-2, -2, 0.5], [2, -2, 0.5], [2, 2, 0.5], [-2, 2, 0.5]], [[0, 1, 2, 3]])
    assert trisect.trim(sheet, a).area == 1.0 and trisect.trim(sheet, a, outside=True).area == 15.0


def test_check(cube: Any, pair: Any) -> None:
    corners, squares = cube
    fine = trisect.check((corners, squares))
    assert fine and fine.usable and fine.remedy is None and fine.solid is not None and not fine.self_crossings
    turned = trisect.check((corners, squares[:, ::-1]))
    assert not turned and turned.remedy == {"orient": True} and isinstance(turned.error, trisect.InsideOutError)
    assert turned.remedy is not None and trisect.Solid(corners, squares[:, ::-1], **turned.remedy).volume == 1.0
    sheet = trisect.check((corners, squares[:1]))
    assert not sheet and sheet.remedy is None and sheet.solid is None
    assert sheet.diagnosis.faults["open_edges"].count == 4 and "open edges" in str(sheet.diagnosis)


def test_models(tmp_path: Any, pair: Any, fixtures: Any) -> None:
    model = {"kind": "difference", "operands": [{"kind": "box", "size": [2, 2, 2]}, {"kind": "box", "size": [1, 1, 4]}]}
    assert trisect.evaluate_model(model).volume == 6.0
    pair[0].save(tmp_path / "cube.ply")
    (tmp_path / "model.json").write_text(json.dumps({"kind": "union", "operands": ["cube.ply", {"kind": "box", "low": [1, 0, 0], "high": [2, 1, 1]}]}))
    assert trisect.evaluate_model(tmp_path / "model.json").volume == 2.0
    with pytest.raises(trisect.ModelError) as raised:
        trisect.evaluate_model({"kind": "union", "operands": ["nothing"]})
    assert "nothing" in str(raised.value)
    with pytest.raises(FileNotFoundError):
        trisect.evaluate_model(tmp_path / "no.json")
    text = {"kind": "text", "text": "o", "font": "DejaVuSans-Latin.ttf", "size": 10, "depth": 2}
    assert trisect.evaluate_model(text, folder=fixtures / "fonts", tolerance=0.1).genus == 1


def test_meshes_of_trimesh(pair: Any) -> None:
    trimesh = pytest.importorskip("trimesh")
    a, _ = pair
    box = trimesh.creation.box()
    assert trisect.Solid(box).volume == 1.0 and (a - box).volume == 0.875 and (box - a).volume == 0.875
    assert trisect.Solid(trimesh.Scene([box])).volume == 1.0
    back = a.to_trimesh()
    assert back.is_watertight and back.volume == pytest.approx(1.0)
    textured = trimesh.Trimesh(box.vertices, box.faces, process=False)
    textured.visual = trimesh.visual.TextureVisuals(uv=box.vertices[:, :2])
    # There they count from the lower edge of a picture, here from the upper one.
    found = trisect.Solid(textured).attributes["TEXCOORD_0"].at_corners()
    assert found == pytest.approx([0, 1] + [1, -1] * box.vertices[box.faces][:, :, :2])
    uv = np.full((8, 2), np.nan)
    textured.visual = trimesh.visual.TextureVisuals(uv=uv)
    with pytest.warns(trisect.TrisectWarning, match="texture"):
        assert not trisect.Solid(textured).attributes


def test_meshes_of_pyvista(pair: Any) -> None:
    pyvista = pytest.importorskip("pyvista")
    a, _ = pair
    assert trisect.Solid(pyvista.Cube()).volume == pytest.approx(1.0)
    assert trisect.Solid(pyvista.Cylinder(resolution=12)).volume == pytest.approx(pyvista.Cylinder(resolution=12).triangulate().volume)
    assert (a - pyvista.Cube()).volume == pytest.approx(0.875)
    assert trisect.Solid(pyvista.ImageData(dimensions=(2, 2, 2))).volume == pytest.approx(1.0)
    assert a.to_pyvista().volume == pytest.approx(1.0)


def test_meshes_of_open3d(pair: Any) -> None:
    # It is large and wants libraries of the system: what it looks like will do where it is not.
    try:
        import open3d
    except ImportError:
        like = type("TriangleMesh", (), {"__module__": "open3d.geometry"})
        legacy = like()
        legacy.vertices, legacy.triangles = pair[0].vertices.tolist(), pair[0].faces.tolist()
        assert trisect.Solid(legacy) == pair[0]
        tensor = type("Tensor", (), {"numpy": lambda self: self.array})
        mesh = like()
        mesh.vertex, mesh.triangle = (type("Map", (), {})() for _ in range(2))
        mesh.vertex.positions, mesh.triangle.indices = tensor(), tensor()
        mesh.vertex.positions.array = pair[0].vertices.astype(np.float32)
        mesh.triangle.indices.array = pair[0].faces.astype(np.int64)
        assert trisect.Solid(mesh) == pair[0]
        return
    box = open3d.geometry.TriangleMesh.create_box()
    assert trisect.Solid(box).volume == 1.0
    assert trisect.Solid(open3d.t.geometry.TriangleMesh.from_legacy(box)).volume == 1.0
    assert pair[0].to_open3d().is_watertight()


def test_meshes_of_manifold3d(pair: Any) -> None:
    manifold3d = pytest.importorskip("manifold3d")
    assert trisect.Solid(manifold3d.Manifold.cube([1, 1, 1])).volume == 1.0
    assert (pair[0] - manifold3d.Manifold.cube([2, 2, 2], True)).is_empty


def test_meshes_of_meshio(pair: Any) -> None:
    like = type("Mesh", (), {})()
    like.points, like.cells_dict = pair[0].vertices, {"line": [[0, 1]], "triangle": pair[0].faces}
    assert trisect.Solid(like) == pair[0]
    like.cells_dict = {"tetra": [[0, 1, 2, 4]]}
    with pytest.raises(trisect.ArgumentError, match="tetra"):
        trisect.Solid(like)


def test_fields(pair: Any) -> None:
    a, b = pair
    points = np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 2.0], [0.5, 0.5, 1.0]])
    assert trisect.fields.signed_distance(a, points).tolist() == [0.5, -1.0, 0.0]
    assert trisect.fields.winding_number(a, points[:2]).tolist() == [1, 0]
    double = trisect.Solid(np.vstack([a.vertices, b.vertices]), np.vstack([a.faces, b.faces + 8]))
    assert trisect.fields.winding_number(double, [0.75, 0.75, 0.75]).tolist() == [2]
    measured = trisect.fields.SignedDistance(a).measure(points[1:2].astype(np.float32))
    assert measured.closest.tolist() == [[0.5, 0.5, 1.0]] and measured.gradient.tolist() == [[0, 0, -1]]
    assert measured.face[0] >= 0
    grid = trisect.fields.SignedDistance(a).grid(0.25)
    assert grid.values.shape == (11, 11, 11) and grid.values.max() == 0.5
    ball = trisect.fields.Field("r^2 - x^2 - y^2 - z^2", r=1.0)
    assert ball([[0, 0, 0], [2, 0, 0]]).tolist() == [1.0, -3.0]
    assert ball.solid([[-2] * 3, [2] * 3], tolerance=0.02).volume == pytest.approx(4.19, abs=0.1)
    made = ball.solid([[-2] * 3, [2] * 3], tolerance=0.02)
    report = made.extraction
    assert report is not None and report.tolerance == 0.02
    # Beside what is measured here: vertices and middles of faces from the unit sphere, faces from its normals.
    corners = made.vertices[made.faces]
    middles = corners.mean(axis=1)
    farthest = abs(np.linalg.norm(np.vstack([made.vertices, middles]), axis=1) - 1).max()
    assert 0.5 * farthest < report.deviation <= 0.02
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    cosines = (normals * middles).sum(axis=1) / np.linalg.norm(normals, axis=1) / np.linalg.norm(middles, axis=1)
    turned = np.degrees(np.arccos(np.clip(cosines, -1, 1)))
    assert 0.5 * np.percentile(turned, 90) < report.normal_deviation <= 5 and report.cells > report.divided_cells >= 0
    assert made.translated([1, 0, 0]).extraction is None and (made - a).extraction is None and a.extraction is None
    hollow = trisect.fields.Field("min(f(x,y,z), -f(2*x,2*y,2*z))", f=ball)
    assert hollow([[0, 0, 0], [0.75, 0, 0]]).tolist() == [-1.0, 0.4375]
    assert ball.grid([[0, 0, 0], [1, 1, 1]], 0.5).values.shape == (3, 3, 3)
    modelled = trisect.fields.Field.of_model({"kind": "sphere", "radius": 2})
    assert modelled([[0, 0, 0]])[0] > 0 > modelled([[3, 0, 0]])[0]
    blended = trisect.evaluate_model({"kind": "formula", "formula": "sphere(x, y, z, 2)", "bounds": [[-3] * 3, [3] * 3]}, tolerance=0.05)
    assert blended.extraction is not None and 0 < blended.extraction.deviation <= blended.extraction.tolerance == 0.05
    with pytest.raises(trisect.FormulaError) as raised:
        trisect.fields.Field("x +* y")
    assert raised.value.line == 1 and raised.value.column is not None
    for points_of_no_use in (np.zeros((2, 2)), "abc"):
        with pytest.raises(trisect.ArgumentError):
            trisect.fields.signed_distance(a, points_of_no_use)


def test_files(fixtures: Any, tmp_path: Any, pair: Any) -> None:
    a = trisect.load(fixtures / "solids" / "ballA.off")
    assert a.volume == pytest.approx(1401.105056)
    assert (str(fixtures / "solids" / "ballA.off") - a).is_empty
    cut = pair[0] - pair[1]
    for name in ("x.obj", "x.glb", "x.gltf", "x.stl", "x.ply", "x.off", "x.3mf"):
        cut.save(tmp_path / name)
        assert trisect.load(tmp_path / name).volume == cut.volume
    cut.save(tmp_path / "text.ply", ascii=True, single=True)
    assert (tmp_path / "text.ply").read_bytes().startswith(b"ply\nformat ascii")
    third = pair[0].scaled(1 / 3).translated([1e6, 0, 0])
    with pytest.warns(trisect.TrisectWarning, match="single precision|volume"):
        third.save(tmp_path / "third.stl")
    with pytest.raises(FileNotFoundError) as missing:
        trisect.load(tmp_path / "missing.stl")
    assert isinstance(missing.value, trisect.FileError) and missing.value.errno == 2
    (tmp_path / "broken.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n")
    with pytest.raises(trisect.FormatError) as broken:
        trisect.load(tmp_path / "broken.off")
    assert broken.value.format == "off" and broken.value.place
    with pytest.raises(trisect.FormatError):
        cut.save(tmp_path / "x.docx")
    with pytest.raises(trisect.FormatError):
        trisect.load(str(tmp_path / "x.glb") + "#nothing")
    grouped = cut.with_groups(["one", "two"], [0] * 12 + [1] * 12)
    grouped.save(tmp_path / "parts.glb")
    assert len(trisect.Mesh.load(str(tmp_path / "parts.glb") + "#one").faces) == 12
    plain, draco = (trisect.Mesh.load(fixtures / "formats" / name) for name in ("nested.glb", "nested-draco.glb"))
    assert len(draco.faces) == len(plain.faces) and draco.area == pytest.approx(plain.area, rel=1e-3)
