"""The licences of what is built in go along: of the crates of Cargo.lock, of Rust, of runtimes."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import tomllib
from functools import cache
from importlib.metadata import files
from pathlib import Path

import pytest
import spectral_tv

ROOT = Path(__file__).resolve().parents[2]
NOTICES = "THIRD_PARTY_LICENSES.txt"
BINDINGS = ROOT / "rust" / "python" / "Cargo.toml"
# Words of each licence, by how crates name it.
LICENCES = {
    "MIT": "Permission is hereby granted, free of charge",
    "Zlib": "This software is provided 'as-is', without any express or implied warranty",
    "BSD-2-Clause": "Redistribution and use in source and binary forms",
    "Unicode-3.0": "UNICODE LICENSE V3",
    "Apache-2.0": "Apache License Version 2.0, January 2004",
}
needs_cargo = pytest.mark.skipif(shutil.which("cargo") is None, reason="cargo knows the crates")


def cargo(*arguments: str) -> str:
    command = ["cargo", *arguments, "--locked", "--manifest-path", str(BINDINGS)]
    return subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT).stdout


@cache
def built_in() -> dict[tuple[str, str], str]:
    """Crates by name and version, with what each says of its licence: those of all our systems."""
    targets = tomllib.loads((ROOT / "rust" / "about.toml").read_text(encoding="utf-8"))["targets"]
    found = {}
    for target in targets:
        tree = ["tree", "--edges", "normal", "--target", target, "--prefix", "none"]
        for line in cargo(*tree, "--format", "{p}|{l}|").splitlines():
            package, licence = line.split("|")[:2]
            name, version = package.split()[:2]
            if not name.startswith("spectral-tv"):
                found[name, version.removeprefix("v")] = licence
    return found


@cache
def notices() -> list[tuple[set[tuple[str, str]], str]]:
    """Each text with the crates that it is for, its spaces made one."""
    return blocks(0)


@cache
def blocks(part: int) -> list[tuple[set[tuple[str, str]], str]]:
    """The same of a part: our crates, Rust's standard library, runtimes."""
    text = (ROOT / NOTICES).read_text(encoding="utf-8").split("#" * 80)[part]
    found = []
    for block in text.split("=" * 80)[1:]:
        head, licence = block.split("-" * 80)
        crates = {
            (name, version) for name, version in re.findall(r"^- (\S+) ([^\s,]+)", head, re.M)
        }
        found.append((crates, " ".join(licence.split())))
    return found


def texts_of(crate: tuple[str, str]) -> list[str]:
    return [text for crates, text in notices() if crate in crates]


@needs_cargo
def test_every_crate_is_named_with_the_text_of_a_licence_that_it_offers():
    assert len(built_in()) > 50
    for crate, offered in built_in().items():
        names = re.findall(r"[\w.-]+", offered)
        words = [words for name, words in LICENCES.items() if name in names]
        assert any(word in text for word in words for text in texts_of(crate)), (crate, offered)


@needs_cargo
def test_crates_that_name_who_has_the_copyright_are_named_with_that():
    packages = json.loads(cargo("metadata", "--format-version", "1"))["packages"]
    compared = 0
    for package in packages:
        crate = package["name"], package["version"]
        for file in Path(package["manifest_path"]).parent.glob("LICENSE-MIT*"):
            if crate in built_in():
                own = " ".join(file.read_text(encoding="utf-8").split())
                assert any(own in text for text in texts_of(crate)), crate
                compared += 1
    assert compared > 30


def test_all_crates_of_which_the_built_module_has_code_are_named():
    module = Path(spectral_tv._native.__file__).read_bytes()
    found = {name.decode() for name in re.findall(rb"([a-z][\w-]*)-\d+\.\d+\.\d+/src/", module)}
    assert {"rayon", "faer"} <= found
    # Rust on this machine may have other versions of its own crates.
    named = {name for part in (0, 1) for crates, _ in blocks(part) for name, _ in crates}
    assert found <= named


def test_rust_and_its_parts_have_their_notices():
    names = {name for crates, _ in blocks(1) for name, _ in crates}
    assert {"std", "core", "alloc", "compiler_builtins", "hashbrown", "gimli"} <= names
    texts = " ".join(text for _, text in blocks(1))
    assert "It is Copyright (c) The Rust Project Contributors" in texts
    assert "Copyright: 1991-2024 Unicode, Inc" in texts


@pytest.mark.parametrize(
    "words",
    [
        "Copyright (c) Zig contributors",
        "The LLVM Project is under the Apache License v2.0 with LLVM Exceptions",
        "This file contains the copying permission notices for various files in the GNU C Library",
        "musl as a whole is licensed under the following standard MIT license",
        "This license has been certified as open source. It has also been designated as GPL",
        "Upstream-Name: mingw-w64",
        "GCC is free software; you can redistribute it and/or modify it under",
        "GCC RUNTIME LIBRARY EXCEPTION Version 3.1, 31 March 2009",
    ],
)
def test_runtimes_that_are_linked_have_their_notices(words):
    assert any(words in text for _, text in blocks(2))


def test_no_crate_is_named_that_is_not_locked():
    lock = tomllib.loads((ROOT / "Cargo.lock").read_text(encoding="utf-8"))
    locked = {(package["name"], package["version"]) for package in lock["package"]}
    assert set().union(*(crates for crates, _ in notices())) <= locked


def test_the_installed_package_has_them():
    installed = {path.name: path for path in files("spectral-tv") or () if "licenses" in path.parts}
    for name in ("LICENSE", NOTICES):
        own = (ROOT / name).read_text(encoding="utf-8")
        assert installed[name].read_text(encoding="utf-8") == own
