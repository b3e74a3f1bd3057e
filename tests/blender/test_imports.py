"""Which files of the extension import which."""

import ast
from pathlib import Path

import pytest

ADDON = Path(__file__).resolve().parents[2] / "addon"
# Each may import of those before it.
LAYERS = ("native", "scene", "options", "job", "drawing", "command_line", "features")
FEATURES = {
    "bands", "deviation", "deformation", "segmentation", "attributes", "images", "maps", "recipes"
}  # fmt: skip
# Of the features, whose bands the others split and filter.
SHARED = "bands"
# What puts all together.
ABOVE = {"", "registration", "unavailable"}

pytestmark = pytest.mark.skipif(not ADDON.is_dir(), reason="there is no checkout")


def modules() -> dict[str, Path]:
    found = {}
    for path in ADDON.rglob("*.py"):
        parts = path.relative_to(ADDON).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def imports() -> dict[str, set[str]]:
    """By module, those of the extension that it imports."""
    known = modules()
    found: dict[str, set[str]] = {}
    for name, path in known.items():
        package = name if path.stem == "__init__" else name.rpartition(".")[0]
        found[name] = set()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level:
                above = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*filter(None, above), *filter(None, [node.module])])
                for each in node.names:
                    whole = f"{base}.{each.name}".lstrip(".")
                    found[name].add(whole if whole in known else base)
    return found


def layer(module: str) -> int:
    top = module.partition(".")[0]
    return LAYERS.index("features" if top in FEATURES else top)


def test_every_file_is_found():
    found = imports()
    assert "scene.results" in found["recipes.making"]
    assert {"bands", "images"} <= found["registration"]
    assert {module.partition(".")[0] for module in found} <= {*LAYERS, *FEATURES, *ABOVE}


def test_no_file_imports_one_that_imports_it():
    left = imports()
    while free := [
        module for module, needed in left.items() if not needed & left.keys() - {module}
    ]:
        for module in free:
            del left[module]
    assert not left, f"files that import one another are among {sorted(left)}"


def test_imports_point_one_way():
    wrong = []
    for module, needed in imports().items():
        if module in ABOVE:
            continue
        for other in needed - {""}:
            one, two = (each.partition(".")[0] for each in (module, other))
            is_up = two in ABOVE or layer(other) > layer(module)
            is_across = {one, two} <= FEATURES and two not in (one, SHARED)
            if is_up or is_across:
                wrong.append(f"{module} imports {other}")
    assert not wrong, "\n".join(sorted(wrong))


def named_at_start() -> set[str]:
    """The modules that the features' tables have read when the extension is enabled."""
    found = set()
    for package in (*FEATURES, "scene", "drawing", "job"):
        for node in ast.parse(modules()[package].read_text(encoding="utf-8")).body:
            tables = [
                each.id for each in getattr(node, "targets", ()) if isinstance(each, ast.Name)
            ]
            if {"FILES", "START", "LOADED"} & {*tables}:
                found |= {
                    f"{package}.{name.split('.')[0]}" for name in ast.literal_eval(node.value)
                }
    return found


def test_what_adds_itself_to_lists_of_others_is_read_at_start():
    """It would miss what they tell of otherwise."""
    adding = set()
    for name, path in modules().items():
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            call = node.value if isinstance(node, ast.Expr) else None
            if isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute):
                adding.add(name)
    assert {"bands.at_once", "bands.heights", "scene.naming"} <= adding
    assert adding <= named_at_start()
