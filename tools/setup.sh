#!/usr/bin/env bash
# What `make` needs before it can build: the system's packages, and a virtual environment.
#
#   tools/setup.sh system        install what is missing of the packages below, with apt-get where there is one
#   tools/setup.sh test          the same with what only some tests need, if that is possible without a password
#   tools/setup.sh venv FOLDER   make the virtual environment, with what building the package needs
#
# PYTHON=... chooses the Python; NO_APT=1 leaves the system alone and only checks that a build can work.
set -euo pipefail

# libode and a compiler build the extension; Mesa draws, with a graphics card or without one.
PACKAGES=(gcc libc6-dev libode-dev libgl1 libegl1 libgl1-mesa-dri)
# Real windows are tested on a screen in memory, with a window manager and somebody at its keyboard and mouse.
TEST_PACKAGES=(xvfb jwm xdotool x11-xkb-utils)
LOWEST="3.11"

say() { printf '==> %s\n' "$*" >&2; }
fail() { printf 'osgode: %s\n' "$@" >&2; exit 1; }

is_new_enough() { # PYTHON
    "$1" -c "import sys; sys.exit(sys.version_info < tuple(map(int, '$LOWEST'.split('.'))))" 2>/dev/null
}

find_python() { # prints the path of the interpreter itself, not that of a shim or of another environment's link to it
    local candidate
    if [ -n "${PYTHON:-}" ]; then
        is_new_enough "$PYTHON" || fail "PYTHON=$PYTHON is not a Python $LOWEST or newer that runs here"
        set -- "$PYTHON"
    else
        set -- python3 python3.13 python3.12 python3.11 python3.14 python
    fi
    for candidate in "$@"; do
        if is_new_enough "$candidate"; then
            "$candidate" -c "import os, sys; print(os.path.realpath(sys.executable))"
            return
        fi
    done
    fail "no Python $LOWEST or newer was found: install one, or name it: make PYTHON=/path/to/python3 ..."
}

is_installed() { # PACKAGE
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

python_packages() { # PYTHON: prints what Debian splits off its own Pythons; others come whole
    local name
    if dpkg -S "$1" >/dev/null 2>&1; then
        name=$("$1" -c "import sys; print('python%d.%d' % sys.version_info[:2])")
        echo "$name-dev" "$name-venv"
    fi
}

check_without_apt() { # a compiler that finds ODE's headers is all that a build can't do without
    local compiler=${CC:-cc}
    if ! echo '#include <ode/ode.h>' | "$compiler" -E -x c - >/dev/null 2>&1; then
        fail "can't install packages on this system, and '$compiler' does not find ode/ode.h." \
            "Needed: a C compiler, the Open Dynamics Engine 0.16 with headers, Python $LOWEST with headers; to draw, OpenGL and EGL." \
            "Fedora: dnf install gcc ode-devel python3-devel mesa-libGL mesa-libEGL mesa-dri-drivers" \
            "Arch: pacman -S gcc ode python mesa"
    fi
}

find_missing() { # PACKAGE...: sets `missing` to those that aren't installed
    local package
    missing=()
    for package in "$@"; do
        is_installed "$package" || missing+=("$package")
    done
}

apt_install() { # PACKAGE...: as root, or by `as_root`
    # A mirror that can't be reached is no reason to stop: what is needed may be known already.
    "${as_root[@]}" apt-get update -qq || say "apt-get update failed; going on with the lists that are there"
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install -y --no-install-recommends -qq -o Dpkg::Use-Pty=0 "$@" >/dev/null
}

install_system() {
    local python by_hand
    local -a missing as_root=()
    python=$(find_python)
    if [ -n "${NO_APT:-}" ] || ! command -v apt-get >/dev/null; then
        check_without_apt
        return
    fi
    # shellcheck disable=SC2046 # several words are several packages
    find_missing "${PACKAGES[@]}" $(python_packages "$python")
    [ ${#missing[@]} -gt 0 ] || return 0

    by_hand="    apt-get install -y --no-install-recommends ${missing[*]}"
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || fail "missing: ${missing[*]}" "There is no sudo here; as root, run:" "$by_hand"
        as_root=(sudo)
    fi
    say "installing ${missing[*]}"
    apt_install "${missing[@]}" || fail "apt-get could not install what is missing; as root, run:" "$by_hand"
}

install_test() { # never fails: the tests say themselves what they lack
    local -a missing as_root=()
    if [ -n "${NO_APT:-}" ] || ! command -v apt-get >/dev/null; then
        return
    fi
    find_missing "${TEST_PACKAGES[@]}"
    [ ${#missing[@]} -gt 0 ] || return 0

    if [ "$(id -u)" -ne 0 ]; then
        as_root=(sudo -n)
        if ! "${as_root[@]}" true 2>/dev/null; then
            say "to test real windows too, run as root: apt-get install --no-install-recommends ${missing[*]}"
            return
        fi
    fi
    say "installing ${missing[*]}, to test real windows with"
    apt_install "${missing[@]}" || say "apt-get could not install ${missing[*]}; real windows will not be tested"
}

make_venv() { # FOLDER
    local python
    python=$(find_python)
    if ! is_new_enough "$1/bin/python" || ! "$1/bin/python" -m pip --version >/dev/null 2>&1; then
        say "making $1 with $python"
        "$python" -m venv --clear "$1" || fail "'$python -m venv' failed: does this Python have its venv and ensurepip modules?"
    fi
    # The extension is built in this environment, not in one that pip makes each time: quicker, and no downloads.
    "$1/bin/python" - >"$1/build-requires.txt" <<'END'
import tomllib
with open("pyproject.toml", "rb") as file:
    print(*tomllib.load(file)["build-system"]["requires"], sep="\n")
END
    "$1/bin/python" -m pip install --quiet --disable-pip-version-check -r "$1/build-requires.txt"
}

cd "$(dirname "$0")/.."
case "${1:-}" in
    system) install_system ;;
    test) install_test ;;
    venv) make_venv "${2:?a folder}" ;;
    *) fail "usage: tools/setup.sh system | test | venv FOLDER" ;;
esac
