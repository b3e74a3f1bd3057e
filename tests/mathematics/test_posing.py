"""What is known of poses: rigid motions, mirror images, joints, and the way back."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from scipy.spatial.transform import Rotation
from shapes import cylinder_open, dumbbell, ends, grid, icosphere

TURN = Rotation.from_rotvec([0.3, 0.8, -0.5])
SHIFT = np.array([1.0, 2.0, 3.0])
BEND = Rotation.from_euler("x", 60, degrees=True)
# Half of its length.
NECK = 0.5


@pytest.fixture(scope="module")
def body():
    """Two balls joined by a neck, its low and its high end."""
    vertices, triangles = dumbbell(n_around=16, n_along=40)
    return spectral_tv.Mesh(vertices, triangles), *ends(vertices, 0.12)


def held_and_bent(mesh, low, high):
    """The low end stays, and the high one is turned about the middle of the neck."""
    rest = mesh.vertices
    return np.r_[low, high], np.vstack([rest[low], BEND.apply(rest[high])])


def rotations(posed):
    return Rotation.from_quat(np.roll(posed.rotations, -1, axis=1))


def angles(posed, other=None):
    """By how many degrees each vertex is turned, or against another rotation."""
    turned = rotations(posed)
    turned = turned if other is None else other.inv() * turned
    return np.degrees(turned.magnitude())


def diagonal(mesh):
    return np.linalg.norm(np.ptp(mesh.vertices, axis=0))


def handles_of(vertices):
    return np.concatenate(ends(vertices, 0.1))


SURFACES = {
    "closed": dumbbell(n_around=12, n_along=24),
    "open": cylinder_open(n_around=16, n_along=12),
    "flat": grid(9, 9),
    "not a manifold": (
        np.vstack([grid(7, 7)[0], [[0.5, 0.5, 1.0]]]),
        np.vstack([grid(7, 7)[1], [[24, 25, 49], [24, 31, 49], [24, 23, 49]]]),
    ),
    "needles": (grid(9, 9)[0] * [1, 1e-4, 1], grid(9, 9)[1]),
    "faces without area": (
        np.vstack([icosphere(2)[0], icosphere(2)[0][:2].mean(axis=0)]),
        np.vstack([icosphere(2)[1], [[0, 162, 1], [5, 5, 9]]]),
    ),
}


@pytest.mark.filterwarnings("ignore::spectral_tv.MeshWarning")
@pytest.mark.parametrize("free", [False, True], ids=["fixed", "free to turn"])
@pytest.mark.parametrize("name", SURFACES)
def test_a_rigid_motion_of_all_handles_moves_all_rigidly(name, free):
    vertices, triangles = SURFACES[name]
    mesh = spectral_tv.Mesh(vertices, triangles)
    is_flat = name in ("flat", "needles", "not a manifold")
    handles = np.arange(0, len(vertices), 5) if is_flat else handles_of(vertices)
    # Bodies whose centres are not on one line say how all is turned.
    bodies = np.arange(len(handles)) % 5 - 1 if free else None
    goal = TURN.apply(vertices) + SHIFT
    posed = spectral_tv.pose(mesh, handles, goal[handles], bodies=bodies)
    used = np.unique(triangles)
    size = diagonal(mesh)
    np.testing.assert_allclose(posed.vertices[used], goal[used], rtol=0, atol=1e-6 * size)
    if name != "needles":  # the turn about a line is in rounding there
        np.testing.assert_allclose(angles(posed, TURN)[used], 0, atol=1e-4)
    assert posed.energy < 1e-9 * size**2


def test_one_vertex_takes_everything_along_rigidly(body):
    mesh, *_ = body
    posed = spectral_tv.pose(mesh, [7], [mesh.vertices[7] + SHIFT])
    np.testing.assert_allclose(posed.vertices[7], mesh.vertices[7] + SHIFT, rtol=0, atol=1e-9)
    turned = rotations(posed)[7]
    expected = turned.apply(mesh.vertices - mesh.vertices[7]) + posed.vertices[7]
    np.testing.assert_allclose(posed.vertices, expected, rtol=0, atol=1e-6)
    np.testing.assert_allclose(angles(posed, turned), 0, atol=1e-4)


@pytest.mark.parametrize("shift", [0.0, 1e3], ids=["at its place", "far away"])
def test_at_rest_nothing_moves(body, shift):
    mesh, low, high = body
    away = spectral_tv.Mesh(mesh.vertices + shift, mesh.triangles)
    handles = np.r_[low, high]
    posed = spectral_tv.pose(away, handles, away.vertices[handles])
    np.testing.assert_allclose(posed.vertices, away.vertices, rtol=0, atol=1e-9)
    np.testing.assert_allclose(angles(posed), 0, atol=1e-6)
    assert posed.energy < 1e-12
    assert posed.decrement <= 1e-4


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_mirror_images_give_mirror_images(body, axis):
    mesh, low, high = body
    handles, targets = held_and_bent(mesh, low, high)
    targets = targets + np.where(np.arange(len(handles)) < len(low), 0, 1)[:, None] * [0.2, 0.1, 0]
    mirror = np.where(np.arange(3) == axis, -1.0, 1.0)
    image = spectral_tv.Mesh(mesh.vertices * mirror, mesh.triangles[:, ::-1])
    settings = {"tolerance": 1e-8}
    posed = spectral_tv.pose(mesh, handles, targets, **settings)
    mirrored = spectral_tv.pose(image, handles, targets * mirror, **settings)
    np.testing.assert_allclose(
        mirrored.vertices, posed.vertices * mirror, rtol=0, atol=1e-3 * diagonal(mesh)
    )
    # The axis of a rotation is mirrored as an axial vector is.
    expected = rotations(posed).as_rotvec() * -mirror
    found = rotations(mirrored).as_rotvec()
    np.testing.assert_allclose(found, expected, atol=0.02)


@pytest.mark.parametrize("is_free", [False, True], ids=["fixed", "free to turn"])
def test_two_balls_joined_by_a_neck_bend_in_the_neck_alone(body, is_free):
    mesh, low, high = body
    handles, targets = held_and_bent(mesh, low, high)
    bodies = np.repeat([-1, 0], [len(low), len(high)]) if is_free else None
    posed = spectral_tv.pose(mesh, handles, targets, bodies=bodies)
    height = mesh.vertices[:, 2]
    upper, lower = height > NECK + 0.2, height < -NECK - 0.2
    turned = rotations(posed)[upper].mean()
    assert np.degrees(turned.magnitude()) == pytest.approx(60, abs=5)
    assert np.abs(angles(posed, turned)[upper]).max() < 2
    assert angles(posed)[lower].max() < 2
    still = np.linalg.norm(posed.vertices - mesh.vertices, axis=1)[lower]
    assert still.max() < 0.02 * diagonal(mesh)
    # And the balls keep their shape.
    for part in (upper, lower):
        faces = mesh.triangles[part[mesh.triangles].all(axis=1)]
        edges = faces[:, [0, 1]]
        before, after = (
            np.linalg.norm(np.diff(shape[edges], axis=1)[:, 0], axis=1)
            for shape in (mesh.vertices, posed.vertices)
        )
        np.testing.assert_allclose(after, before, rtol=0.05)


def test_the_neck_turns_where_the_displacement_of_least_variation_stretches(body):
    mesh, low, high = body
    handles, targets = held_and_bent(mesh, low, high)
    edges = np.unique(np.sort(mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)

    def longest(shape):
        before, after = (
            np.linalg.norm(np.diff(points[edges], axis=1)[:, 0], axis=1)
            for points in (mesh.vertices, shape)
        )
        return (after / before).max()

    posed = longest(spectral_tv.pose(mesh, handles, targets).vertices)
    assert posed < 0.6 * longest(spectral_tv.deform(mesh, handles, targets).vertices)


def test_exact_handles_are_where_they_were_asked_to_be(body):
    mesh, low, high = body
    handles, targets = held_and_bent(mesh, low, high)
    for posed in (
        spectral_tv.pose(mesh, handles, targets),
        spectral_tv.Poser(mesh, handles).drag(targets),
    ):
        np.testing.assert_allclose(posed.vertices[handles], targets, rtol=0, atol=1e-9)


def test_a_free_body_is_rigid_and_its_centre_is_where_the_targets_have_theirs(body):
    mesh, low, high = body
    handles, targets = held_and_bent(mesh, low, high)
    bodies = np.repeat([-1, 7], [len(low), len(high)])
    posed = spectral_tv.pose(mesh, handles, targets, bodies=bodies)
    found, rest = posed.vertices[high], mesh.vertices[high]
    np.testing.assert_allclose(found.mean(axis=0), targets[len(low) :].mean(axis=0), atol=1e-9)
    turned = rotations(posed)[high]
    np.testing.assert_allclose(np.degrees((turned[0].inv() * turned).magnitude()), 0, atol=1e-5)
    np.testing.assert_allclose(
        turned[0].apply(rest - rest.mean(axis=0)), found - found.mean(axis=0), atol=1e-9
    )


def test_only_the_mean_of_the_targets_of_a_free_body_counts(body):
    mesh, low, high = body
    handles, targets = held_and_bent(mesh, low, high)
    bodies = np.repeat([-1, 0], [len(low), len(high)])
    others = targets.copy()
    others[len(low) :] = targets[len(low) :].mean(axis=0)
    one, other = (spectral_tv.pose(mesh, handles, t, bodies=bodies) for t in (targets, others))
    np.testing.assert_allclose(one.vertices, other.vertices, rtol=0, atol=1e-6)


def test_which_numbers_bodies_have_makes_no_difference(body):
    mesh, low, high = body
    handles, targets = held_and_bent(mesh, low, high)
    found = [
        spectral_tv.pose(
            mesh, handles, targets, bodies=np.repeat([low_one, high_one], [len(low), len(high)])
        )
        for low_one, high_one in ((0, 1), (3, 2**40))
    ]
    np.testing.assert_allclose(found[0].vertices, found[1].vertices, rtol=0, atol=1e-9)


def test_dragging_back_returns_to_rest(body):
    mesh, low, high = body
    handles = np.r_[low, high]
    poser = spectral_tv.Poser(mesh, handles)
    rest = mesh.vertices
    for share in [*np.linspace(0.1, 1, 10), *np.linspace(0.9, 0, 10)]:
        turn = Rotation.from_euler("x", 60 * share, degrees=True)
        posed = poser.drag(np.vstack([rest[low], turn.apply(rest[high])]))
        assert posed.iterations == 1
    for _ in range(10):
        posed = poser.drag(rest[handles])
    np.testing.assert_allclose(posed.vertices, rest, rtol=0, atol=2e-3 * diagonal(mesh))
    posed = poser.solve(rest[handles])
    np.testing.assert_allclose(posed.vertices, rest, rtol=0, atol=1e-4 * diagonal(mesh))
    np.testing.assert_allclose(angles(posed), 0, atol=0.1)


def test_drags_lead_to_what_one_jump_leads_to(body):
    mesh, low, high = body
    handles, targets = held_and_bent(mesh, low, high)
    expected = spectral_tv.pose(mesh, handles, targets, tolerance=1e-6)
    poser = spectral_tv.Poser(mesh, handles)
    rest = mesh.vertices
    for share in np.linspace(0.1, 1, 20):
        turn = Rotation.from_euler("x", 60 * share, degrees=True)
        poser.drag(np.vstack([rest[low], turn.apply(rest[high])]))
    for _ in range(10):
        dragged = poser.drag(targets)
    size = diagonal(mesh)
    np.testing.assert_allclose(dragged.vertices, expected.vertices, rtol=0, atol=0.01 * size)
    solved = poser.solve(targets, tolerance=1e-6)
    np.testing.assert_allclose(solved.vertices, expected.vertices, rtol=0, atol=2e-3 * size)
    assert solved.energy == pytest.approx(expected.energy, rel=1e-3)


@pytest.mark.parametrize("axis", ["x", "z"])
def test_a_half_turn_at_once_is_as_good_as_in_small_steps(body, axis):
    mesh, low, high = body
    rest = mesh.vertices

    def targets(degrees):
        turn = Rotation.from_euler(axis, degrees, degrees=True)
        return np.vstack([rest[low], turn.apply(rest[high])])

    handles = np.r_[low, high]
    steps = [targets(degrees) for degrees in np.linspace(10, 170, 17)]
    in_steps = spectral_tv.Poser(mesh, handles).solve_sequence(steps, tolerance=1e-4)[-1]
    at_once = spectral_tv.pose(mesh, handles, steps[-1], tolerance=1e-4)
    assert at_once.decrement <= 1e-4
    assert at_once.energy <= 1.02 * in_steps.energy


def test_a_sequence_gives_what_single_poses_give(body):
    mesh, low, high = body
    handles, targets = held_and_bent(mesh, low, high)
    rest = mesh.vertices[handles]
    sequence = [rest + share * (targets - rest) for share in (0.3, 0.6, 1.0)]
    single = spectral_tv.Poser(mesh, handles)
    for posed, goal in zip(
        spectral_tv.Poser(mesh, handles).solve_sequence(sequence), sequence, strict=True
    ):
        np.testing.assert_array_equal(posed.vertices, single.solve(goal).vertices)


def test_size_and_place_make_no_difference(body):
    mesh, low, high = body
    handles, targets = held_and_bent(mesh, low, high)
    expected = spectral_tv.pose(mesh, handles, targets, tolerance=1e-8)
    for size, shift in ((1e-6, 0), (1e6, 0), (1, 100)):
        moved = [size * x + shift for x in (mesh.vertices, targets, expected.vertices)]
        other = spectral_tv.Mesh(moved[0], mesh.triangles)
        posed = spectral_tv.pose(other, handles, moved[1], tolerance=1e-8)
        reach = size * diagonal(mesh)
        np.testing.assert_allclose(posed.vertices, moved[2], rtol=0, atol=1e-3 * reach)
        assert posed.energy / size**2 == pytest.approx(expected.energy, rel=1e-4)


def test_the_decrement_reaches_the_tolerance_and_the_energy_falls(body):
    mesh, low, high = body
    handles, targets = held_and_bent(mesh, low, high)
    energies = []
    for tolerance in (1e-1, 1e-3, 1e-6):
        posed = spectral_tv.pose(mesh, handles, targets, tolerance=tolerance)
        assert 0 <= posed.decrement <= tolerance
        energies.append(posed.energy)
    assert energies == sorted(energies, reverse=True)
    assert energies[1] == pytest.approx(energies[2], rel=1e-2)
    assert spectral_tv.Poser(mesh, handles).drag(targets).decrement is None


def test_parameters_do_what_they_are_named_after(body):
    mesh, low, high = body
    handles, targets = held_and_bent(mesh, low, high)

    def turning_faces(**settings):
        """How many vertices are neither turned with the one nor with the other ball."""
        turned = angles(spectral_tv.pose(mesh, handles, targets, **settings))
        return np.count_nonzero((turned > 5) & (turned < 55))

    assert turning_faces(joint_softness=0.2) <= turning_faces() < turning_faces(joint_softness=20)

    def leaning(**settings):
        """How far the lower ball goes, which can turn where it is, as the upper pole is pulled."""
        rest = mesh.vertices
        pole = high[rest[high, 2] > rest[:, 2].max() - 0.1]
        pulled = np.vstack([rest[low], rest[pole] + [1.5, 0, 0]])
        bodies = np.repeat([0, 1], [len(low), len(pole)])
        posed = spectral_tv.pose(mesh, np.r_[low, pole], pulled, bodies=bodies, **settings)
        lower = rest[:, 2] < -NECK
        return np.linalg.norm(posed.vertices - rest, axis=1)[lower].max()

    assert leaning(stillness=2) < leaning() < 0.5 * leaning(stillness=0)


def test_pieces_that_nothing_holds_go_with_the_nearest_surface(body):
    mesh, low, high = body
    eye, faces = icosphere(1, 0.15)
    count = len(mesh.vertices)
    top = mesh.vertices[:, 2].max()
    vertices = np.vstack([mesh.vertices, eye + np.array([0, 0, top + 0.2])])
    both = spectral_tv.Mesh(vertices, np.vstack([mesh.triangles, faces + count]))
    handles, targets = held_and_bent(both, low, high)
    posed = spectral_tv.pose(both, handles, targets)
    np.testing.assert_array_equal(posed.unconstrained, np.arange(count, len(vertices)))
    np.testing.assert_allclose(
        posed.vertices[count:], BEND.apply(vertices[count:]), rtol=0, atol=1e-6
    )
    np.testing.assert_allclose(angles(posed, BEND)[count:], 0, atol=1e-3)
    alone = spectral_tv.pose(mesh, handles, targets)
    assert len(alone.unconstrained) == 0


def test_components_that_are_held_are_posed_each_by_itself(body):
    mesh, low, high = body
    handles, targets = held_and_bent(mesh, low, high)
    count, shift = len(mesh.vertices), np.array([5.0, 0, 0])
    two = spectral_tv.Mesh(
        np.vstack([mesh.vertices, mesh.vertices + shift]),
        np.vstack([mesh.triangles, mesh.triangles + count]),
    )
    posed = spectral_tv.pose(
        two, np.r_[handles, handles + count], np.vstack([targets, targets + shift])
    )
    first, second = posed.vertices[:count], posed.vertices[count:] - shift
    np.testing.assert_allclose(second, first, rtol=0, atol=2e-3 * diagonal(two))
