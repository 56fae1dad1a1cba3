# A thin door to tools/install_packages.sh, CMake and the program. CMake holds the build; nothing is compiled here.

.PHONY: build victorious web install package test repository results quick demo demo-cluster serve bench check format tidy fuzz asan clean

# Ninja's progress: files done of all, seconds since the start.
NINJA_STATUS ?= [%f/%t %es] $(empty)
export NINJA_STATUS

# Installs the packages and configures; says how long the rest takes if the program that it makes is not there yet.
configure = ./tools/install_packages.sh $(2) && cmake --preset $(1) >/dev/null
say = @[ -e build/$(1) ] || echo "$(2), the first time; each line counts the files done and the seconds." >&2

build:
	$(call say,victorious-bench,make build: about 15 minutes on two cores)
	$(call configure,release)
	cmake --build --preset release --target victorious_page victorious victorious-bench victorious-experiment victorious_shared victorious_python

# The program and its page: all that the demo needs.
victorious:
	$(call say,victorious,make victorious: about 10 minutes on two cores)
	$(call configure,release)
	cmake --build --preset release --target victorious_page victorious

# The page alone, from web/.
web:
	./tools/install_packages.sh
	./tools/build_web.sh build/web

# Installs the program, its manual page and its completion for bash below PREFIX.
PREFIX ?= /usr/local
install: build
	cmake --build --preset release --target victorious_pages
	cmake --install build --prefix $(PREFIX)

# Debian packages, build/*_VERSION_ARCHITECTURE.deb: victorious (the programs), libvictorious0, libvictorious-dev, python3-victorious.
package: build
	cmake --build --preset release --target victorious_pages
	umask 022 && cpack --config build/CPackConfig.cmake -G DEB -B build

# An apt repository of them, build/repository, signed by the key SIGN_KEY of gpg if that is given.
repository: package
	SIGN_KEY='$(SIGN_KEY)' ./tools/make_repository.sh build build/repository

test:
	$(call say,serve_tests,make test: about 40 minutes on two cores)
	$(call configure,release,--test)
	cmake --build --preset release --target victorious_page all
	ctest --preset release
	@sed -nE 's/^\[  SKIPPED \] (.*) \(.* ms\)$$/SKIPPED: \1/p' build/Testing/Temporary/LastTest.log

# The unit tests of the folders that differ from origin/main, or from COMMIT, and what is checked without compiling.
quick:
	$(call configure,release,--test)
	./tools/quick.py $(COMMIT)

demo: victorious
	./tools/demo.sh build/victorious scenes/demo.json assets/models demo

# What the page shows, if it is not there.
demo/index.db demo/flight/video.telemetry.csv &:
	$(MAKE) demo

# The demo by four workers on two nodes of a Slurm cluster, with PostgreSQL, all on this machine; as root.
demo-cluster: victorious | demo/index.db
	./tools/install_packages.sh --cluster
	./tools/demo_cluster.sh build/victorious scenes/demo.json demo demo/cluster

# Serves the page on the demo's index, and opens it in a browser where there is one. PORT=9000: at another port.
serve: victorious | demo/index.db demo/flight/video.telemetry.csv
	./tools/serve.sh build/victorious --db demo/index.db --models demo/models $(if $(PORT),--listen 127.0.0.1:$(PORT))

# Measures the figures of docs/results.md that are stale, cheapest first. ROWS='boxes* roc' selects, LIMIT=600: seconds in all.
RESULT_TARGETS = victorious victorious_page victorious-bench victorious-experiment accuracy_tests geolocate_tests navigate_tests \
  box-peers draw_flight make-large-index make-stream
results:
	$(call configure,release,--test)
	cmake --build --preset release --target $(RESULT_TARGETS)
	./tools/results.py $(ROWS) $(if $(LIMIT),--limit $(LIMIT))

bench: build
	build/victorious bench

# What can be checked without compiling; clang-tidy on the files changed since origin/main.
check:
	./tools/check.sh

format:
	./tools/install_packages.sh --test
	git ls-files '*.h' '*.cc' | xargs clang-format-19 -i

tidy:
	$(call configure,tidy,--tidy)
	cmake --build --preset tidy

# The tests under the address and undefined-behaviour sanitizers.
asan:
	$(call configure,asan-ubsan,--test)
	cmake --build --preset asan-ubsan
	ctest --preset asan-ubsan

# Each fuzz target for FUZZ_SECONDS.
FUZZ_SECONDS ?= 600
fuzz:
	$(call configure,fuzz,--tidy)
	cmake --build --preset fuzz --target fuzz_targets
	./tools/fuzz.sh build-fuzz $(FUZZ_SECONDS)

clean:
	rm -rf build build-* demo
