# Compilers and runners of exported code. What does not install is named in one line and left out:
# code that it would have run is then reported as not checked, and the next call tries it again.
.PHONY: toolchains toolchain-osl toolchain-mitsuba lock-toolchains

TOOLCHAINS := requirements-toolchains.lock
# command:package of Debian, then its libraries that have no command
TOOLCHAIN_COMMANDS := gcc:gcc g++:g++ node:nodejs glslangValidator:glslang-tools chromium:chromium
TOOLCHAIN_LIBRARIES := libvulkan1 mesa-vulkan-drivers
PIP_TOOLCHAIN := .venv/bin/pip install --quiet --disable-pip-version-check --no-deps --require-hashes

# Python packages all at once; only where that fails, each for itself, so that one does not cost the
# rest. What is in the environment already is not installed again.
.venv/.toolchains: .venv/.ready $(TOOLCHAINS) toolchains.mk
	@touch $@; \
	left_out() { echo "toolchains: left out: $$1" >&2; rm -f $@; }; \
	$(PIP_TOOLCHAIN) -r $(TOOLCHAINS) 2>/dev/null || \
	for name in $$(sed -n 's/^\([A-Za-z0-9._-]*\)==.*/\1/p' $(TOOLCHAINS)); do \
	    awk -v head="$$name==" 'index($$0, head) == 1 {on = 1} on {print} on && !/\\$$/ {on = 0}' \
	        $(TOOLCHAINS) > .venv/.toolchain && \
	    $(PIP_TOOLCHAIN) -r .venv/.toolchain >/dev/null 2>&1 || \
	    left_out "$$name did not install from the package index"; \
	done; \
	rm -f .venv/.toolchain; \
	wanted=; \
	for pair in $(TOOLCHAIN_COMMANDS); do \
	    command -v "$${pair%%:*}" >/dev/null || wanted="$$wanted $${pair##*:}"; \
	done; \
	if command -v dpkg-query >/dev/null; then \
	    for package in $(TOOLCHAIN_LIBRARIES); do \
	        dpkg-query -W -f '$${Status}' "$$package" 2>/dev/null | grep -q 'ok installed' || \
	        wanted="$$wanted $$package"; \
	    done; \
	fi; \
	if [ -z "$$wanted" ]; then exit 0; fi; \
	if [ "$$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then \
	    left_out "$${wanted# } (installing needs root and apt-get)"; exit 0; \
	fi; \
	timeout 120 apt-get update -qq >/dev/null 2>&1; \
	for package in $$wanted; do \
	    DEBIAN_FRONTEND=noninteractive timeout 180 apt-get install -y -qq \
	        --no-install-recommends "$$package" >/dev/null 2>&1 || \
	    left_out "$$package did not install from Debian"; \
	done

toolchains: .venv/.toolchains  ## install compilers and runners of exported code, where possible

.venv/.toolchain-osl: .venv/.ready requirements-osl.lock
	@if $(PIP_TOOLCHAIN) -r requirements-osl.lock; then touch $@; \
	else echo "toolchains: left out: bpy did not install from the package index" >&2; fi

toolchain-osl: .venv/.toolchain-osl  ## install Blender's OSL compiler and renderer (1 GB)

.venv/.toolchain-mitsuba: .venv/.ready requirements-mitsuba.lock
	@if $(PIP_TOOLCHAIN) -r requirements-mitsuba.lock; then touch $@; \
	else echo "toolchains: left out: mitsuba did not install from the package index" >&2; fi

toolchain-mitsuba: .venv/.toolchain-mitsuba  ## install Mitsuba 3, a judge of the phase function (0.2 GB)

lock-toolchains: setup  ## resolve the locked toolchains anew
	for name in toolchains osl mitsuba; do \
	    .venv/bin/uv pip compile --quiet --universal --generate-hashes --no-annotate --no-header \
	        --no-emit-index-url --no-emit-find-links --python-version 3.11 --no-deps \
	        -c requirements.lock requirements-$$name.in -o requirements-$$name.lock || exit 1; \
	done
