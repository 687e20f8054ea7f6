# SPDX-License-Identifier: MIT
# The front door. `make help` lists the targets; every target first installs the Debian packages it lacks.

BUILD   ?= build
JOBS    ?= $(shell nproc)
PREFIX  ?= /usr/local
SUDO    := $(shell [ "$$(id -u)" = 0 ] || echo sudo)

# What the program is built from, and what only the tests and the extras need.
PACKAGES       := g++ cmake ninja-build flex bison pkg-config libpng-dev zlib1g-dev libfmt-dev libsleef-dev \
                  librandom123-dev libopenexr-dev libhwy-dev libopenmpi-dev openmpi-bin
TEST_PACKAGES  := libgtest-dev libgmock-dev nlohmann-json3-dev libboost-dev man-db groff-base python3 valgrind
BENCH_PACKAGES := libbenchmark-dev libembree-dev povray
LINT_PACKAGES  := clang clang-tidy clang-format libclang-rt-14-dev

BENCH_CMAKE := cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release -DRAYSHADE_TESTS=OFF -DRAYSHADE_BENCH=ON

.DEFAULT_GOAL := help
.PHONY: help run build check check-long asan tsan stress bench bench-fas bench-scenes bench-accuracy bench-paper bench-skip \
        check-clusters install package lint format fuzz clean \
        packages test-packages bench-packages lint-packages

help: ## list the targets
	@echo "rayshade: a ray tracer for Rayshade 4.0 scenes"
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 20

# $(call need,PACKAGES): installs those that are missing, and asks for no password where nothing is.
define need
	@missing=""; for p in $(1); do \
	  dpkg-query -W -f '$${Status}' $$p 2>/dev/null | grep -q 'install ok installed' || missing="$$missing $$p"; done; \
	if [ -n "$$missing" ]; then echo "installing:$$missing"; \
	  $(SUDO) apt-get update -q && $(SUDO) env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $$missing; fi
endef

packages:
	$(call need,$(PACKAGES))
test-packages:
	$(call need,$(PACKAGES) $(TEST_PACKAGES))
bench-packages:
	$(call need,$(PACKAGES) $(BENCH_PACKAGES))
lint-packages:
	$(call need,$(PACKAGES) $(TEST_PACKAGES) $(filter-out povray,$(BENCH_PACKAGES)) $(LINT_PACKAGES))

build: packages ## build the programs into build/bin
	cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release -DRAYSHADE_TESTS=OFF -DCMAKE_INSTALL_PREFIX=$(PREFIX)
	cmake --build $(BUILD) -j $(JOBS)

run: build ## build, render a scene to a PNG and say where it is
	cd scenes && $(abspath $(BUILD))/bin/rayshade -O $(CURDIR)/hero.png hero.ray
	@echo; echo "The picture is $(CURDIR)/hero.png"

check: test-packages ## build everything and run all tests
	cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release -DRAYSHADE_TESTS=ON -DCMAKE_INSTALL_PREFIX=$(PREFIX)
	cmake --build $(BUILD) -j $(JOBS)
	ctest --test-dir $(BUILD) -j $(JOBS) -LE 'long|slurm|mpich' --output-on-failure

check-long: test-packages ## the tests that take longer, too
	cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release -DRAYSHADE_TESTS=ON
	cmake --build $(BUILD) -j $(JOBS)
	ctest --test-dir $(BUILD) -j $(JOBS) -LE 'slurm|mpich' --output-on-failure

check-clusters: test-packages ## pafas under MPICH and in a Slurm of one node
	$(call need,mpich libmpich-dev slurm-wlm munge)
	cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release -DRAYSHADE_TESTS=ON
	cmake --build $(BUILD) -j $(JOBS)
	$(SUDO) ctest --test-dir $(BUILD) -L 'slurm|mpich' --output-on-failure

asan: test-packages ## the tests under the address and undefined-behaviour sanitizers
	cmake --preset asan && cmake --build --preset asan -j $(JOBS)
	ctest --test-dir build-asan -j $(JOBS) -LE 'long|timing|slurm|mpich' --output-on-failure

tsan: test-packages ## the tests under the thread sanitizer
	cmake --preset tsan && cmake --build --preset tsan -j $(JOBS)
	ctest --test-dir build-tsan -j $(JOBS) -LE 'long|timing|slurm|mpich' --output-on-failure

# WRITE=--write also puts the tables into docs/accuracy.md; RAYSHADE_STRESS=0.1 in the environment makes a tenth of the rays.
stress: test-packages ## scales, leaks, self-intersection, the truth of single rays: the long tests, with tables
	cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release -DRAYSHADE_TESTS=ON
	cmake --build $(BUILD) -j $(JOBS) --target stress_test
	bench/run-stress $(BUILD) $(WRITE)

# WRITE=--write also puts the tables of bench-fas and bench-scenes into docs/performance.md.
bench: bench-packages ## run the benchmarks (speed as ratios within one run)
	$(BENCH_CMAKE)
	cmake --build $(BUILD) -j $(JOBS)
	bench/run $(BUILD)

bench-fas: bench-packages ## replay the rays of the procedural databases: trees, hierarchy, Embree
	$(BENCH_CMAKE)
	cmake --build $(BUILD) -j $(JOBS) --target fas_bench rayshade spd
	bench/run-fas $(BUILD) $(WRITE)

bench-scenes: bench-packages ## time the procedural databases as whole programs: rayshade, POV-Ray
	$(BENCH_CMAKE)
	cmake --build $(BUILD) -j $(JOBS) --target rayshade spd compare_pictures
	bench/run-scenes $(BUILD) $(WRITE)

# WRITE=--write puts the table into docs/accuracy.md, the plot into docs/ and all rows into bench/accuracy/figures.csv.
bench-accuracy: bench-packages ## run time against error: both schemes of sampling, POV-Ray
	$(call need,python3 librsvg2-bin)
	$(BENCH_CMAKE)
	cmake --build $(BUILD) -j $(JOBS) --target rayshade spd picture_errors
	bench/run-accuracy $(BUILD) $(WRITE)

bench-paper: bench-packages ## the tables of the paper: speed-up, memory, samples, on up to 16 ranks
	$(call need,python3)
	$(BENCH_CMAKE)
	cmake --build $(BUILD) -j $(JOBS) --target rayshade pafas spd
	bench/run-paper $(BUILD) $(WRITE)

# WRITE=--write puts the tables into docs/accuracy.md.
bench-skip: packages ## what a scene spends on features that it does not use, in instructions
	$(call need,python3 valgrind)
	cmake -S . -B build-skip -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS=-g -DRAYSHADE_TESTS=OFF
	cmake --build build-skip -j $(JOBS) --target rayshade
	bench/run-skip build-skip $(WRITE)

install: build ## install programs, scenes, manuals and completion under PREFIX
	$(SUDO) cmake --install $(BUILD) --prefix $(PREFIX)

package: packages ## build a Debian package in build/ and check it
	$(call need,dpkg-dev file lintian)
	cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release -DRAYSHADE_TESTS=OFF -DCMAKE_INSTALL_PREFIX=/usr
	cmake --build $(BUILD) -j $(JOBS)
	rm -f $(BUILD)/*.deb
	cd $(BUILD) && cpack -G DEB
	lintian --allow-root --fail-on error,warning $(BUILD)/*.deb
	@ls -l $(BUILD)/*.deb

lint: lint-packages ## a second compiler, clang-format and clang-tidy
	clang-format --dry-run -Werror $$(git ls-files '*.cpp' '*.h')
	cmake -S . -B build-lint -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_BUILD_TYPE=Release \
	  -DRAYSHADE_TESTS=ON -DRAYSHADE_BENCH=ON
	cmake --build build-lint -j $(JOBS)
	run-clang-tidy -p build-lint -quiet -j $(JOBS) '$(CURDIR)/(fas|rayshade|pafas|scenes|tests|bench)/.*'

format: lint-packages ## format all sources
	clang-format -i $$(git ls-files '*.cpp' '*.h')

fuzz: lint-packages ## fuzz the language for ten minutes
	cmake -S . -B build-fuzz -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DRAYSHADE_FUZZ=ON -DCMAKE_BUILD_TYPE=Release
	cmake --build build-fuzz -j $(JOBS) --target parse_fuzz
	mkdir -p build-fuzz/corpus
	build-fuzz/bin/parse_fuzz -max_total_time=600 -timeout=10 -rss_limit_mb=2048 build-fuzz/corpus tests/fuzz/corpus

clean: ## remove what was built
	rm -rf $(BUILD) build-* hero.png
