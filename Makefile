# Everything is built into the checkout: .venv, target/, dist/ and demo/.

PYTHON ?= python3.11
MESH ?=
UP ?=
AZIMUTH ?=
FIGURES ?=
LISTING ?=
MESHES ?=
BENCH ?=
PLATFORMS ?=
CHECKS ?=
DENY ?=
SECONDS ?= 3600

VENV := .venv
BIN := $(VENV)/bin
# Programs of Cargo's that few need, compiled when they are first used.
CARGO_TOOLS := .build/cargo/bin
NOTICES ?= THIRD_PARTY_LICENSES.txt
WHEEL_STAMP := dist/.wheel
EXTENSION_STAMP := dist/.extension
# On all processors.
PYTEST := $(BIN)/python -m pytest -n auto --dist worksteal

RUST_SOURCES := Cargo.toml Cargo.lock \
  $(shell find rust/system rust/spectral_tv/src rust/spectral_tv/Cargo.toml rust/python -name '*.rs' -o -name Cargo.toml)
PACKAGE_SOURCES := pyproject.toml LICENSE $(NOTICES) $(shell find python -name '*.py' -o -name '*.pyi')
ADDON_SOURCES := $(shell find addon -name '*.py' -o -name '*.toml')

.PHONY: demo test test-rust test-package test-extension test-bpy test-window fuzz fuzz-library \
  coverage deny notices lint extension docs bench bench-check pictures listing gallery release release-check \
  reproducible clean

demo: $(EXTENSION_STAMP)
	$(BIN)/python -m tools.demo $(if $(MESH),"$(MESH)") $(if $(UP),--up $(UP)) \
	  $(if $(AZIMUTH),--azimuth $(AZIMUTH))

test: lint test-rust $(EXTENSION_STAMP)
	$(PYTEST) tests

# The parts of that by themselves.
test-rust:
	cargo test --workspace --release --quiet

test-package: $(WHEEL_STAMP)
	$(PYTEST) tests --ignore tests/blender

test-extension: $(EXTENSION_STAMP)
	$(PYTEST) tests/blender

test-bpy: $(EXTENSION_STAMP)
	PYTHON=$(PYTHON) tools/test_bpy.sh

# Needs the chroot: tools/blender_chroot.sh.
test-window: $(EXTENSION_STAMP)
	BLENDER=blender tools/blender_chroot.sh run tests/window/run.sh

# A thousand cases for each property, new ones every time.
fuzz: $(WHEEL_STAMP)
	PROPTEST_CASES=1000 cargo test --release --quiet --package spectral-tv --features internals --test properties
	$(BIN)/python -m pytest tests/fuzz --hypothesis-profile=long

# Inputs that a fuzzer finds by the code they reach, for SECONDS. Needs a nightly compiler and
# cargo-fuzz. Nothing that it reaches is unsafe code of ours, for a sanitizer to watch.
fuzz-library:
	cargo +nightly fuzz run --fuzz-dir rust/fuzz --target-dir target/fuzz --sanitizer none \
	  entry_points -- -max_total_time=$(SECONDS) -timeout=60 -max_len=2048

# How much of the code the tests reach; what it needs is said there.
coverage: $(EXTENSION_STAMP)
	tools/coverage.sh

# Licences, sources and known flaws of the crates that are built in, or of what DENY names. The flaws
# need GitHub.
deny: $(CARGO_TOOLS)/cargo-deny
	$< --config rust/deny.toml check $(DENY)

# The licences of all that is built in, in one file, which wheels and zips take along: anew after a change of
# Cargo.lock, or of the compilers that build a release.
notices: $(CARGO_TOOLS)/cargo-about $(VENV)/.installed
	$(BIN)/python -m tools.release.notices $(NOTICES) $<

lint: $(WHEEL_STAMP)
	cargo fmt --all --check
	cargo fmt --manifest-path rust/fuzz/Cargo.toml --check
	cargo clippy --workspace --all-targets --quiet -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --quiet
	$(BIN)/ruff format --check .
	$(BIN)/ruff check --quiet .
	$(BIN)/python -m mypy
	$(BIN)/python tools/extension_names.py
	$(BIN)/python -m mypy.stubtest spectral_tv._native

extension: $(EXTENSION_STAMP)
	@ls dist/*.zip dist/*.whl

# The site, in .build/site, and screenshots of it. Notebooks and examples are run, links followed, and
# pages looked at in Chromium.
docs: $(EXTENSION_STAMP)
	$(BIN)/python tools/check_system.py chromium
	$(BIN)/python -m pip install --quiet --group docs
	rm -rf .build/site
	$(BIN)/sphinx-build -W --keep-going -E -q -j auto -c docs/site -d .build/doctrees . .build/site
	cargo doc --package spectral-tv --no-deps --quiet
	cp -r target/doc .build/site/rust
	$(BIN)/python -m tools.site.links .build/site
	$(BIN)/python -m tools.site.look .build/site .build/site_pictures
	$(PYTEST) tests/blender/test_docs.py tests/package/test_pages.py

bench: $(EXTENSION_STAMP)
	$(BIN)/python tools/check_system.py cholmod
	$(BIN)/python -m pip install --quiet --group bench
	$(BIN)/python -m tools.bench $(or $(MESH),--page docs/benchmarks.md) $(BENCH)

# Counts instructions and compares them with the stored run; BENCH=--store renews that.
bench-check: $(VENV)/.installed
	$(BIN)/python tools/check_system.py valgrind
	$(BIN)/python -m tools.bench.instructions $(BENCH)

pictures: $(EXTENSION_STAMP)
	$(BIN)/python -m tools.demo --cell 180 --output .build/pictures
	mkdir -p docs/pictures
	cp .build/pictures/creature.png docs/pictures/filters.png
	$(BIN)/python -m tools.demo.methods .build/pictures/creature.blend docs/pictures
	$(BIN)/python -m tools.demo.limbs_kept .build/pictures/creature.blend \
	  docs/pictures/limbs_kept.png
	$(BIN)/python -m tools.demo.deformations .build/pictures/creature.blend \
	  docs/pictures/deformations.png
	$(BIN)/python -m tools.demo.comparisons .build/pictures/creature.blend \
	  docs/pictures/comparisons.png
	$(BIN)/python -m tools.demo.recipes .build/pictures/creature.blend docs/pictures/recipes.png
	$(BIN)/python -m tools.gallery.pose_film docs/pictures/posing.webp
	$(BIN)/python -m tools.gallery.film docs/pictures/film.webp

# The icon and the pictures of the extension's page, in dist/listing; LISTING="icon --scale 0.3" makes one, or
# smaller ones.
listing: $(WHEEL_STAMP)
	$(BIN)/python -m tools.listing $(LISTING)

# Figures of the paper; FIGURES="clouds bands" makes some, MESHES=folder those of its meshes too.
gallery: $(WHEEL_STAMP)
	$(BIN)/python -m tools.gallery $(FIGURES) $(if $(MESHES),--meshes "$(MESHES)")

# Both need root on Debian 12. PLATFORMS are some of tools/release/build.sh's, CHECKS of check.sh's.
release:
	tools/release/build.sh $(PLATFORMS)

release-check: $(VENV)/.installed
	tools/release/check.sh $(CHECKS)

# Two builds of the last commit, which have to be the same.
reproducible:
	tools/release/reproducible.sh

clean:
	rm -rf $(VENV) target dist demo .build

$(VENV)/.installed: pyproject.toml tools/check_system.py
	$(PYTHON) tools/check_system.py
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade "pip>=25.1"
	$(BIN)/python -m pip install --quiet --group development
	touch $@

$(CARGO_TOOLS)/cargo-about: VERSION := 0.9.3
$(CARGO_TOOLS)/cargo-about: FEATURES := --features cli
$(CARGO_TOOLS)/cargo-deny: VERSION := 0.20.2
$(CARGO_TOOLS)/%:
	cargo install --quiet --locked --root .build/cargo $* --version $(VERSION) $(FEATURES)

# One wheel for every Linux that Blender supports; the checkout's environment uses the same.
$(WHEEL_STAMP): $(VENV)/.installed $(RUST_SOURCES) $(PACKAGE_SOURCES)
	rm -rf dist/*.whl
	PATH="$(CURDIR)/$(BIN):$$PATH" maturin build --release --locked --zig --compatibility manylinux_2_28 --out dist \
	  --interpreter $(BIN)/python
	$(BIN)/python -m pip install --quiet --force-reinstall --no-deps dist/*.whl
	touch $@

$(EXTENSION_STAMP): $(WHEEL_STAMP) $(ADDON_SOURCES) tools/extension.py
	$(BIN)/python tools/extension.py dist/*.whl
	touch $@
