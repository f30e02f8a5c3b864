# The front door. Needs nothing but make; what else is missing, the targets install. Settings: JOBS=2 (processes), PYTHON=/path/to/python3,
# PREFIX=/usr/local and DESTDIR (make install, make uninstall), BENCH=quick (make bench with fewer sizes, steps and repeats) or long (with more),
# FIGURE=3 (make reproduce: one figure), SEED=1 COUNT=20 PART=all METHODS='soft dem' (make stress), MINUTES=10 (make fuzz, each reader),
# ARM=arm64 or armhf (make arm).

JOBS ?= $(shell nproc)
export JOBS PYTHON

BUILD := build/release
OPENCLOSE := $(BUILD)/openclose
REFERENCE := $(BUILD)/analytical/openclose-reference
VERIFY := $(BUILD)/verification/openclose-verify
CONVERGENCE := $(BUILD)/verification/openclose-convergence
PAPER_RESULTS := results/paper
BENCH ?= full
PREFIX ?= /usr/local
SEED ?= 1
COUNT ?= 20
PART ?= all
MINUTES ?= 10
ARM ?= arm64
COMPARISON := $(PAPER_RESULTS)/comparison.csv
NULL_SOLVER := results/verify-null-solver.txt
SLOPE := paper/scenes/example_3_4.toml
FAILING_SLOPE := paper/scenes/example_3_4_post_failure.toml
WEDGE := paper/scenes/example_3_3_wedge.toml
QEMU_arm64 := qemu-aarch64
QEMU_armhf := qemu-arm
# Those of what computes; the preset of ctest has the same list.
ARM_TESTS := core geometry contact law linear model statics integrator limit_analysis
NOT_RANDOM := setarch --addr-no-randomize
VALGRIND := valgrind --quiet --error-exitcode=1 --leak-check=full --errors-for-leak-kinds=definite,indirect

.DEFAULT_GOAL := help
.PHONY: help build test verify examples handbook reproduce convergence stress regression bench bench-code bench-peers sanitize sanitize-threads memcheck compilers arm wasm fuzz mutants mutants-random clean verify-vtk verify-page verify-install verify-stops install uninstall packages clang-packages memcheck-packages arm-packages wasm-packages vtk-packages page-packages handbook-packages shell-packages stress-packages figure-packages bench-packages peer-packages

help: ## print the targets
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' $(firstword $(MAKEFILE_LIST)) | while read -r target text; do printf '  make %-14s %s\n' "$$target" "$$text"; done

build: packages ## install missing packages, configure and compile everything (build/release)
	@scripts/build release

test: packages ## build and run the unit tests
	@scripts/build release openclose_tests
	@ctest --preset release --parallel $(JOBS)

# The null solver comes first, so that the count of the real checks is the last line. The page is made of failed checks, too.
verify: build bench-code stress-packages ## build, run the unit tests and the verification against closed forms (results/verification.md); the exit status says pass or fail
	ctest --preset release --parallel $(JOBS)
	@"$${PYTHON:-python3}" -m unittest discover -q -s stress
	@mkdir -p results
	$(VERIFY) --null-solver >$(NULL_SOLVER) || { grep ' pass$$' $(NULL_SOLVER); tail -n 2 $(NULL_SOLVER); exit 1; }
	@tail -n 2 $(NULL_SOLVER) | head -n 1
	@scripts/find-python >/dev/null 2>&1 || echo 'verify: no python3 imports matplotlib, so results/verification.md is not made; results/verify.csv has all rows'
	$(VERIFY) --results results; status=$$?; \
	  if python=$$(scripts/find-python 2>/dev/null); then "$$python" verification/report.py --results results; fi; \
	  "$${PYTHON:-python3}" stress/stress.py --regression --jobs $(JOBS) --results results/regression || status=1; \
	  exit $$status

examples: build stress-packages ## run the eight examples of examples/ and compare their answers with theory, some seconds
	@"$${PYTHON:-python3}" examples/check.py $(OPENCLOSE)

# Read anew each time: whether the report of make verify is there decides about a chapter. A warning is an error.
handbook: handbook-packages ## make the handbook from the pages of docs/ and examples/ (build/handbook/docs/index.html); with results/verification.md if make verify has written it
	@/usr/bin/python3 -m sphinx -q -E -W --keep-going -b html -c docs . build/handbook
	@echo 'written to build/handbook/docs/index.html'

verify-vtk: build vtk-packages ## read the files for ParaView with VTK and compare them with the tables; installs python3-vtk9, which is large
	/usr/bin/python3 tests/vtk/read_back.py $(OPENCLOSE)

verify-stops: build stress-packages ## stop runs and searches by kill -9 and Ctrl-C at 50 random moments each and compare what went on with what was never stopped, some minutes
	/usr/bin/python3 tests/cli/interrupt.py $(OPENCLOSE)

verify-page: build page-packages ## click through the page of results in a headless browser and compare it with the tables; installs chromium, which is large
	/usr/bin/python3 tests/page/click_through.py $(OPENCLOSE)

verify-install: build shell-packages ## install into a folder of its own, use it as a person and as a program would, and remove it again
	/usr/bin/python3 tests/install/try_installation.py .

install: packages ## build and install the command, its manual pages and completions, libraries, headers and a CMake package (PREFIX=/usr/local)
	@scripts/build release openclose openclose_manual
	cmake --install $(BUILD) --prefix "$(PREFIX)" >/dev/null
	@echo "installed into $(DESTDIR)$(PREFIX); make uninstall removes it"

uninstall: ## remove what the last make install has put in place
	@cmake -DMANIFEST=$(BUILD)/install_manifest.txt -P cmake/uninstall.cmake

ifdef FIGURE
reproduce: figure-packages $(OPENCLOSE) $(REFERENCE)
	@python=$$(scripts/find-python) && "$$python" paper/reproduce.py --openclose $(OPENCLOSE) --reference $(REFERENCE) --results $(PAPER_RESULTS) --figure $(FIGURE)
else
reproduce: figure-packages $(COMPARISON) ## build, run the paper's examples, draw the figures and print the comparison (results/paper); FIGURE=3: only one of the ten figures
	$(if $(comparison_printed),,@"$${PYTHON:-python3}" paper/reproduce.py --print-only --results $(PAPER_RESULTS))
endif

# Drawn even where an order is out of its bounds: the picture shows why.
convergence: build figure-packages ## measure the orders of convergence against theory (results/convergence.csv) and draw them; the exit status says pass or fail
	@$(CONVERGENCE) --results results; status=$$?; \
	  python=$$(scripts/find-python) && "$$python" verification/draw_convergence.py results/convergence.csv results/convergence || exit 2; exit $$status

stress: build stress-packages ## random scenes from seeds, judged by rules that know nothing of the method (results/stress.csv), and what broke a reader once; exit status 1 for a false answer
	@"$${PYTHON:-python3}" -m unittest discover -q -s stress
	@ctest --preset release --quiet --tests-regex '^fuzz_'
	@python=$$(scripts/find-python 2>/dev/null || echo "$${PYTHON:-python3}"); "$$python" stress/stress.py --seed $(SEED) --count $(COUNT) --part $(PART) $(if $(METHODS),--methods $(METHODS)) --jobs $(JOBS)

regression: build stress-packages ## the fixed seeds of the random scenes, a minute or two (results/regression/stress.md); exit status 1 for a false answer
	@"$${PYTHON:-python3}" stress/stress.py --regression --jobs $(JOBS) --results results/regression

# What only `make bench` runs keeps up with what it measures.
bench-code: build
	@scripts/install-packages build bench
	@OPTIONS=-DOPENCLOSE_BENCH=ON scripts/build release openclose_bench

# Always anew: a time is of today. The test is of the rule that nothing wins with a large error.
bench: bench-packages ## run time beside error, cost by size, what skips save (results/bench.md); half an hour and more, BENCH=quick: some 20 minutes
	@OPTIONS=-DOPENCLOSE_BENCH=ON scripts/build release openclose openclose_reference openclose_bench
	@python=$$(scripts/find-python) && "$$python" -m unittest discover -q -s bench && "$$python" bench/bench.py --mode $(BENCH) --micro $(BUILD)/bench/openclose-bench

bench-peers: peer-packages ## the same with Box2D and Chipmunk on the slope of example 3.4, a wall and a pile
	@OPTIONS='-DOPENCLOSE_BENCH=ON -DOPENCLOSE_BENCH_PEERS=ON' scripts/build release openclose openclose_reference openclose_bench openclose_peers
	@python=$$(scripts/find-python) && "$$python" bench/bench.py --mode $(BENCH) --micro $(BUILD)/bench/openclose-bench --peers $(BUILD)/bench/openclose-peers

sanitize: packages clang-packages ## build with the address and undefined-behaviour sanitizers of g++ (with traps for numbers without a value) and of clang++, run the unit tests
	@scripts/build sanitize openclose_tests
	@ctest --preset sanitize --parallel $(JOBS)
	@scripts/build sanitize-clang openclose_tests
	@ctest --preset sanitize-clang --parallel $(JOBS)

# Its shadow memory wants addresses that are not drawn at random.
sanitize-threads: packages ## build with the thread sanitizer and run a failing slope and a factor of safety on two threads
	@scripts/build sanitize-threads openclose
	$(NOT_RANDOM) build/sanitize-threads/openclose run $(FAILING_SLOPE) --end 0.05 --set method.threads=2 --quiet -o build/sanitize-threads/run
	$(NOT_RANDOM) build/sanitize-threads/openclose fos $(SLOPE) --set method.threads=2 --quiet -o build/sanitize-threads/fos

memcheck: build memcheck-packages ## run a failing slope and a factor of safety under valgrind, some minutes; a finding is an error
	$(VALGRIND) $(OPENCLOSE) run $(FAILING_SLOPE) --end 0.01 --quiet -o build/memcheck/run
	$(VALGRIND) $(OPENCLOSE) fos $(WEDGE) --quiet -o build/memcheck/fos

compilers: build clang-packages ## build with clang++ too, warnings as errors, and compare the results of eleven scenes with those of g++ bit for bit
	@OPTIONS=-DCMAKE_COMPILE_WARNING_AS_ERROR=ON scripts/build clang
	@"$${PYTHON:-python3}" verification/compare_builds.py $(OPENCLOSE) build/clang/openclose

arm: build arm-packages ## build for ARM=arm64 or armhf with a cross compiler; run unit tests under qemu and compare the results of scenes with this machine's bit for bit
	@scripts/sysroot $(ARM)
	@scripts/build $(ARM) openclose $(ARM_TESTS:%=test_%)
	@ctest --preset $(ARM) --parallel $(JOBS)
	@"$${PYTHON:-python3}" verification/compare_builds.py $(OPENCLOSE) '$(QEMU_$(ARM)) -L build/sysroot-$(ARM) build/$(ARM)/openclose'

wasm: build wasm-packages ## build the command in WebAssembly (build/wasm/openclose.js) and compare the factors of safety that it finds under node with this machine's
	@scripts/build wasm openclose
	@"$${PYTHON:-python3}" verification/compare_builds.py $(OPENCLOSE) 'node build/wasm/openclose.js' --answers

fuzz: clang-packages packages ## attack the readers of scenes, records and checkpoints with libFuzzer for MINUTES each; a finding is kept in tests/fuzz/corpus
	@scripts/build fuzz fuzz_scene fuzz_record fuzz_checkpoint
	@scripts/fuzz $(MINUTES)

mutants: packages ## plant the faults of mutants/faults.toml one by one and report which check notices each (results/mutants.md); takes an hour or two
	"$${PYTHON:-python3}" mutants/run.py --results results

mutants-random: packages ## plant COUNT faults of one token at places drawn by SEED and report which checks notice (results/mutants-random.md); minutes each
	"$${PYTHON:-python3}" mutants/run.py --results results --random $(COUNT) --seed $(SEED)

clean: ## remove what these targets have made; other results stay
	rm -rf build $(PAPER_RESULTS) results/verify.csv results/verify_series.csv results/verify_cases.csv results/verification results/verification.md $(NULL_SOLVER) results/convergence results/convergence.csv
	rm -rf results/stress results/stress.csv results/stress.md results/regression
	rm -rf results/bench results/bench.csv results/bench.md results/bench_machine.json
	rm -f results/mutants.csv results/mutants.md results/mutants-random.csv results/mutants-random.md

packages:
	@scripts/install-packages build

clang-packages:
	@scripts/install-packages clang

memcheck-packages:
	@scripts/install-packages memcheck

arm-packages:
	@scripts/install-packages $(ARM)

wasm-packages:
	@scripts/install-packages wasm

vtk-packages:
	@scripts/install-packages build vtk

shell-packages:
	@scripts/install-packages build shells

page-packages:
	@scripts/install-packages build page

handbook-packages:
	@scripts/install-packages handbook

stress-packages:
	@scripts/install-packages stress

figure-packages:
	@scripts/install-packages build figures

bench-packages:
	@scripts/install-packages build figures bench

peer-packages:
	@scripts/install-packages build figures bench peers

# make only has to know that something is newer; what to compile, CMake knows. A binary that comes out untouched leaves the comparison as it is.
BUILD_FILES := CMakeLists.txt $(shell find cmake -type f)
$(OPENCLOSE): $(BUILD_FILES) $(shell find src -type f) | figure-packages
	@scripts/build release openclose

# After the other, because two builds in one folder at a time get into each other's way.
$(REFERENCE): $(BUILD_FILES) $(shell find analytical -type f) | figure-packages $(OPENCLOSE)
	@scripts/build release openclose_reference

# The script prints the comparison, so `reproduce` need not do it again.
$(COMPARISON): $(OPENCLOSE) $(REFERENCE) $(shell find paper python -type f -not -name '*.pyc')
	$(eval comparison_printed := yes)
	@python=$$(scripts/find-python) && "$$python" paper/reproduce.py --openclose $(OPENCLOSE) --reference $(REFERENCE) --results $(PAPER_RESULTS)
