"""Surfaces of other libraries go in, and come out in kind."""

from __future__ import annotations

import subprocess
import sys

import meshio
import numpy as np
import open3d
import pytest
import pyvista
import spectral_tv
import trimesh
from shapes import icosphere

VERTICES, TRIANGLES = icosphere(2)
VALUES = {"height": VERTICES[:, 2], "place": VERTICES}


def of_open3d():
    made = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(VERTICES), open3d.utility.Vector3iVector(TRIANGLES)
    )
    made.compute_vertex_normals()
    return made


SURFACES = {
    "trimesh": lambda: trimesh.Trimesh(VERTICES, TRIANGLES, process=False),
    "meshio": lambda: meshio.Mesh(VERTICES, [("triangle", TRIANGLES)], {"old": VERTICES[:, 0]}),
    "pyvista": lambda: pyvista.PolyData.from_regular_faces(VERTICES, TRIANGLES),
    "open3d": of_open3d,
    "open3d tensors": lambda: open3d.t.geometry.TriangleMesh.from_legacy(of_open3d()),
}
KEPT = {
    "trimesh": lambda made, name: made.vertex_attributes[name],
    "meshio": lambda made, name: made.point_data[name],
    "pyvista": lambda made, name: made.point_data[name],
    "open3d tensors": lambda made, name: made.vertex[name].numpy(),
}


@pytest.mark.parametrize("library", SURFACES)
def test_a_surface_is_taken_as_it_is(library):
    mesh = spectral_tv.Mesh.of(SURFACES[library]())
    np.testing.assert_allclose(mesh.vertices, VERTICES, atol=1e-7)
    np.testing.assert_array_equal(mesh.triangles, TRIANGLES)


@pytest.mark.parametrize("library", SURFACES)
def test_a_result_comes_back_in_kind(library):
    surface = SURFACES[library]()
    moved = 2 * VERTICES + 1
    made = spectral_tv.in_kind(surface, moved)
    assert type(made) is type(surface)
    np.testing.assert_allclose(spectral_tv.Mesh.of(made).vertices, moved, atol=1e-6)
    np.testing.assert_array_equal(spectral_tv.Mesh.of(made).triangles, TRIANGLES)
    np.testing.assert_allclose(spectral_tv.Mesh.of(surface).vertices, VERTICES, atol=1e-7)


@pytest.mark.parametrize("library", KEPT)
def test_attributes_come_along(library):
    surface = SURFACES[library]()
    made = spectral_tv.in_kind(surface, VERTICES, VALUES)
    for name, values in VALUES.items():
        np.testing.assert_allclose(np.squeeze(KEPT[library](made, name)), values, atol=1e-7)
    with pytest.raises(KeyError):
        KEPT[library](surface, "height")


def test_attributes_that_there_are_stay():
    made = spectral_tv.in_kind(SURFACES["meshio"](), VERTICES, VALUES)
    np.testing.assert_array_equal(made.point_data["old"], VERTICES[:, 0])


def test_normals_are_those_of_the_new_shape():
    flat = VERTICES * [1, 1, 0.01]
    made = spectral_tv.in_kind(of_open3d(), flat)
    top = VERTICES[:, 2].argmax()
    assert np.asarray(made.vertex_normals)[top] @ [0, 0, 1] > 0.99


def test_welded_results_reach_every_vertex_of_the_surface():
    corners = TRIANGLES.ravel()
    loose = trimesh.Trimesh(
        VERTICES[corners], np.arange(len(corners)).reshape(-1, 3), process=False
    )
    mesh = spectral_tv.Mesh.of(loose, weld=0.0)
    assert len(mesh.vertices) == len(VERTICES)
    made = spectral_tv.in_kind(loose, 2 * mesh.vertices[mesh.weld_map])
    np.testing.assert_array_equal(made.vertices, 2 * VERTICES[corners])
    with pytest.raises(spectral_tv.MeshError, match=rf"{len(corners)} values.*not {len(VERTICES)}"):
        spectral_tv.in_kind(loose, mesh.vertices)


def test_polygons_are_split_and_what_takes_no_part_is_told():
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [2, 0.5]], dtype=float)
    cells = [("quad", [[0, 1, 2, 3]]), ("triangle", [[1, 4, 2]]), ("line", [[0, 1], [1, 2]])]
    with pytest.warns(spectral_tv.MeshWarning, match="2 cells of the type line"):
        mesh = spectral_tv.Mesh.of(meshio.Mesh(points, cells))
    assert mesh.area == pytest.approx(1.5)
    grid = pyvista.Plane(i_resolution=3, j_resolution=2)  # of quads
    mesh = spectral_tv.Mesh.of(grid)
    assert mesh.area == pytest.approx(1)
    assert len(mesh.vertices) == grid.n_points
    lines = pyvista.Line() + pyvista.Plane()
    with pytest.warns(spectral_tv.MeshWarning, match="1 lines"):
        spectral_tv.Mesh.of(lines.extract_surface(algorithm=None))


@pytest.mark.parametrize(
    ("surface", "message"),
    [
        (trimesh.Scene, "scene.to_mesh()"),
        (lambda: pyvista.ImageData(dimensions=(2, 2, 2)), "extract_surface"),
        (lambda: meshio.Mesh(np.eye(4, 3), [("tetra", [[0, 1, 2, 3]])]), "surface of its volume"),
        (lambda: "bunny.obj", "trimesh.Trimesh"),
    ],
)
def test_other_objects_are_refused_with_advice(surface, message):
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.Mesh.of(surface())


def test_a_class_without_attributes_says_so():
    with pytest.raises(spectral_tv.MeshError, match=r"from_legacy"):
        spectral_tv.in_kind(of_open3d(), VERTICES, VALUES)


def test_no_library_is_imported_for_it():
    code = (
        "import sys, spectral_tv\n"
        "assert not {'trimesh', 'meshio', 'pyvista', 'open3d'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
