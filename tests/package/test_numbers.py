"""Every number that the package takes: what cannot be one is refused by the argument's name."""

from __future__ import annotations

import ast
import inspect
from pathlib import Path
from typing import get_type_hints

import numpy as np
import pytest
import spectral_tv
import trimesh

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.4, 1]])
TRIANGLES = np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])
MESH = spectral_tv.Mesh(VERTICES, TRIANGLES)
SPLIT = spectral_tv.decompose(MESH, steps=6)
TARGETS = VERTICES[:2] + 1
IMAGE = np.arange(16.0).reshape(4, 4)
DEFORMER = spectral_tv.Deformer(MESH, [0, 1])
POSER = spectral_tv.Poser(MESH, [0, 1])

# What every function and method is called with, but for the number in question.
CALLS = {
    "decompose": (MESH, "m1"),
    "estimate": (MESH, "m1"),
    "decompose_image": (IMAGE, "surface"),
    "decompose_sequence": ([MESH],),
    "accuracy": (MESH,),
    "eigenpairs": (MESH,),
    "folds": (MESH, np.zeros((4, 3))),
    "safe_displacement": (MESH, np.zeros((4, 3))),
    "caricature": ([MESH],),
    "cosegment": ([SPLIT],),
    "deform": (MESH, [0, 1], TARGETS),
    "pose": (MESH, [0, 1], TARGETS),
    "transfer": (MESH, MESH),
    "flow": (MESH, VERTICES, [0, 0.1]),
    "conformal_flow": (MESH,),
    "default_scales": ("lb",),
    "graded_times": (),
    "set_threads": (),
    "Mesh.__new__": (VERTICES, TRIANGLES),
    "Mesh.of": (trimesh.Trimesh(VERTICES, TRIANGLES, process=False),),
    "Deformer.__new__": (MESH, [0, 1]),
    "Deformer.start": (MESH, [0, 1]),
    "Deformer.solve": (TARGETS,),
    "Deformer.solve_sequence": ([TARGETS],),
    "Poser.__new__": (MESH, [0, 1]),
    "Poser.start": (MESH, [0, 1]),
    "Poser.set_parameters": (),
    "Poser.solve": (TARGETS,),
    "Poser.solve_sequence": ([TARGETS],),
    "Flow.band_edges": (),
    "Decomposition.band_edges": (),
    "Decomposition.bands": ([0, 1],),
    "Decomposition.filter": (np.ones(5),),
    "Decomposition.show": (),
}
# Where a number has no default.
REQUIRED = {
    "count": 2,
    "band": (1e-4, 1e-3),
    "time": 0.1,
    "finest": 0.1,
    "largest": 1.0,
}
INSTANCES = {
    "Mesh": spectral_tv.Mesh,
    "Deformer": DEFORMER,
    "Poser": POSER,
    "Flow": SPLIT.flow,
    "Decomposition": SPLIT,
}


def functions(tree):
    """All functions and methods of a stub by their full names."""
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            yield from ((f"{node.name}.{name}", method) for name, method in functions(node))
        elif isinstance(node, ast.FunctionDef):
            yield node.name, node


def annotated():
    """Function, argument and annotation of everything that users call."""
    stub = Path(spectral_tv.__file__).with_name("_native.pyi")
    for name, node in functions(ast.parse(stub.read_text(encoding="utf-8"))):
        function = getattr(spectral_tv, name.partition(".")[0], None)
        if isinstance(function, type) or inspect.isbuiltin(function):
            for argument in [*node.args.args, *node.args.kwonlyargs]:
                yield name, argument.arg, ast.unparse(argument.annotation or ast.Constant(""))
    for name in spectral_tv.__all__:
        function = getattr(spectral_tv, name)
        if inspect.isfunction(function):
            hints = get_type_hints(inspect.unwrap(function))
            for options in getattr(hints.pop("options", None), "__args__", ()):
                hints |= get_type_hints(options)
            for argument in inspect.signature(function).parameters:
                yield name, argument, inspect.formatannotation(hints[argument])


def number_arguments():
    """Function, argument and annotation of every number."""
    for name, argument, kind in annotated():
        is_number = ("int" in kind or "float" in kind) and "Callable" not in kind
        is_call = is_number and argument != "mesh" and "_" not in (name[0], argument[0])
        if is_call and name != "use_threads" and "Progress" not in kind and "Array" not in kind:
            yield name, argument, kind


ARGUMENTS = [*number_arguments()]


def call(name, **arguments):
    plain = name.replace("start_", "")
    required = {a: REQUIRED[a] for n, a, _ in ARGUMENTS if n == name and a in REQUIRED}
    owner, _, method = name.rpartition(".")
    if method == "__new__":
        function = getattr(spectral_tv, owner)
    else:
        function = getattr(INSTANCES[owner] if owner else spectral_tv, method)
    outcome = function(*CALLS[plain], **{**required, **arguments})
    if inspect.isgenerator(outcome):
        return next(outcome)
    return outcome.result() if isinstance(outcome, spectral_tv.Job) else outcome


def bad_values(kind):
    yield from ["3", [1, 2, 3], 1j, MESH]
    if "None" not in kind:
        yield None
    if "tuple" in kind:
        yield from [(1,), (np.nan, 1), (1, "a"), (10**400, 1), 3]
    elif "int" in kind:
        yield from [-1, 2**70, -(2**70), 10**5000, 1.5, np.nan]
    else:
        yield from [10**400, -(10**400), np.nan]


def test_the_stub_was_read():
    assert ("start_decompose", "steps", "int") in ARGUMENTS
    assert ("Deformer.solve", "tolerance", "float") in ARGUMENTS
    assert len(ARGUMENTS) > 50


@pytest.mark.parametrize(
    ("name", "argument", "kind"), ARGUMENTS, ids=[f"{name}-{a}" for name, a, _ in ARGUMENTS]
)
def test_what_is_no_such_number_is_refused_by_name(name, argument, kind):
    for value in bad_values(kind):
        with pytest.raises((spectral_tv.MeshError, TypeError)) as caught:
            call(name, **{argument: value})
        message = str(caught.value)
        assert argument.rstrip("s") in message, (value, message)
        assert len(message) < 250, message


@pytest.mark.parametrize(
    ("name", "argument", "value", "message"),
    [
        ("decompose", "steps", -1, "steps must be an integer from 0 to .*, not -1"),
        ("decompose", "steps", 2**40, "steps must be at most 1000000, not 1099511627776"),
        ("decompose", "tolerance", 2.0, "tolerance must be between 0 and 1, not 2"),
        ("decompose", "p", 4, "p must be 1, 2 or 3, not 4"),
        ("decompose", "eigenpairs", 0, "eigenpairs must be at least 1"),
        ("conformal_flow", "time", 1e300, "time must be positive and at most 1e100, not 1e300"),
        ("decompose_image", "height", 1e300, "height must be above 0 and at most 1e100"),
        ("graded_times", "largest", 1e300, "finest scale must be above 0 and below the largest"),
        ("caricature", "gain", 1e300, "gain must be finite and at most 1e100"),
        ("deform", "softness", 1e300, "softness must be a length"),
        ("pose", "stiffness", 1e300, "stiffness must be a number from 0 to 1e6"),
    ],
)
def test_numbers_out_of_range_are_refused(name, argument, value, message):
    with pytest.raises(spectral_tv.MeshError, match=message):
        call(name, **{argument: value})


@pytest.mark.parametrize("value", [np.int8(4), np.uint64(4), np.array(4)])
def test_any_integer_will_do(value):
    assert len(call("decompose", steps=value).times) == 5


def test_base_times_are_refused_by_name():
    for value in (-1.0, np.nan, np.inf, 1e300):
        with pytest.raises(spectral_tv.MeshError, match="base_time must be positive"):
            spectral_tv.decompose(MESH, "m3", base_time=value)


def test_gains_and_edges_beyond_all_use_are_refused():
    with pytest.raises(spectral_tv.MeshError, match=r"gains\[2\] is not finite, or beyond 1e100"):
        SPLIT.filter([1, 1, 1e300, 1, 1])
    for one in (SPLIT, SPLIT.flow):
        with pytest.raises(spectral_tv.MeshError, match="edges must be those of at most 1000000"):
            one.bands(np.linspace(0, 1, 10**7))


def test_progress_that_cannot_be_called_is_refused():
    with pytest.raises(TypeError, match="progress must be callable, not 3"):
        spectral_tv.decompose(MESH, steps=4, progress=3)
