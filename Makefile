# A thin door to tools/install_packages.sh, CMake and the program. CMake holds the build; nothing is compiled here.

.PHONY: build test demo bench format tidy fuzz asan clean

build:
	./tools/install_packages.sh
	cmake --preset release
	cmake --build --preset release --target victorious victorious-bench

test:
	./tools/install_packages.sh
	cmake --preset release
	cmake --build --preset release
	ctest --preset release

demo: build
	./tools/demo.sh build/victorious scenes/demo.json assets/models demo

bench: build
	build/victorious bench

asan:
	./tools/install_packages.sh
	cmake --preset asan-ubsan
	cmake --build --preset asan-ubsan
	ctest --preset asan-ubsan

format:
	./tools/install_packages.sh --tidy
	git ls-files '*.h' '*.cc' | xargs clang-format-19 -i

tidy:
	./tools/install_packages.sh --tidy
	cmake --preset tidy
	cmake --build --preset tidy

fuzz:
	./tools/install_packages.sh --tidy
	cmake --preset fuzz
	cmake --build --preset fuzz --target fuzz_targets
	./tools/fuzz.sh build-fuzz

clean:
	rm -rf build build-* demo
