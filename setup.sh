#!/usr/bin/env bash
# Makes sure that what Limber is built and run with is there. demo.sh and test.sh call it first;
# with everything present it changes nothing and takes a second.
set -euo pipefail

usage() {
  cat <<'TEXT'
Usage: ./setup.sh [--for demo|test] [--check]

Checks for the packages that Limber is built, run and tested with, and installs what is missing.

  --for demo   only what ./demo.sh needs: the compiler, the libraries, a Vulkan device
  --for test   that, and what ./test.sh needs (the default)
  --check      only say what is missing; exit code 1 if something is
  --help       this text

On Debian 12 and its relatives packages come through apt-get, as root or with sudo. Elsewhere the
libraries to install are named.
TEXT
}

top=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
validator_version=2.0.0-dev.3.10

groups=(build libraries pictures tests)   # in this order; a demo needs all but the last
declare -A packages=(
  [build]="cmake ninja-build g++ libc6-dev glslang-tools pkg-config"
  [libraries]="libeigen3-dev libtinygltf-dev nlohmann-json3-dev libcli11-dev libstb-dev libpng-dev
    libglm-dev libembree-dev libtbb-dev libglfw3-dev libvulkan-dev libvulkan-volk-dev
    libgtest-dev libbenchmark-dev"
  [pictures]="mesa-vulkan-drivers imagemagick"
  [tests]="git vulkan-validationlayers spirv-tools xvfb xauth xdotool clang-format clang-tidy
    shellcheck coinor-libipopt-dev libogre-1.12-dev"
)

say() { printf 'setup: %s\n' "$*"; }
fail() {
  printf 'setup: %s\n' "$*" >&2
  exit 1
}
have() { command -v "$1" > /dev/null 2>&1; }

is_installed() {
  # shellcheck disable=SC2016  # the format is dpkg-query's, not the shell's
  dpkg-query -W -f='${db:Status-Status}\n' "$1" 2> /dev/null | grep -qx installed
}

# Installs the packages "$@", as root or through sudo; where neither is possible says what to run.
install_packages() {
  local as_root=() log
  if [[ $(id -u) -ne 0 ]]; then
    if ! have sudo || ! { [[ -t 0 ]] || sudo -n true 2> /dev/null; }; then
      fail "this needs root; please run: sudo apt-get update && sudo apt-get install -y $*"
    fi
    as_root=(sudo)
  fi
  as_root+=(env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=120)
  say "installing with apt-get: $*"
  log=$(mktemp)
  if ! { "${as_root[@]}" update && "${as_root[@]}" install -y --no-install-recommends "$@"; } \
      > "$log" 2>&1; then
    tail -n 15 "$log" >&2
    rm -f "$log"
    fail "apt-get could not install them (see above)"
  fi
  rm -f "$log"
}

# Debian and its relatives: looks group by group, installs all that is missing at once.
setup_with_apt() {
  local purpose=$1 check_only=$2 group package missing wanted=()
  for group in "${groups[@]}"; do
    [[ $group == tests && $purpose == demo ]] && continue
    missing=()
    for package in ${packages[$group]}; do
      is_installed "$package" || missing+=("$package")
    done
    say "$group: ${missing[*]:+missing }${missing[*]:-all present}"
    wanted+=("${missing[@]}")
  done
  # Node comes from many places (distribution, vendor, version manager): the commands count.
  if [[ $purpose == test ]]; then
    have node || wanted+=(nodejs)
    have npm || wanted+=(npm)
  fi
  [[ ${#wanted[@]} -eq 0 ]] && return 0
  [[ $check_only -eq 1 ]] && return 1
  install_packages "${wanted[@]}"
}

# Elsewhere: no guess at package names beyond the libraries' own; CMake names what is still missing.
setup_by_hand() {
  local command_name absent=()
  for command_name in cmake ninja c++ glslangValidator; do
    have "$command_name" || absent+=("$command_name")
  done
  say "no apt-get here. Limber needs, under whatever names your system has for them:"
  say "  build: CMake >= 3.23, Ninja, a C++20 compiler (GCC 12, Clang 15), glslangValidator"
  say "  libraries: Eigen 3.4, tinygltf, nlohmann-json, CLI11, stb, libpng, GLM, Embree 3, GLFW 3,"
  say "    the Vulkan headers and volk"
  say "  to run: a Vulkan 1.1 device (Mesa lavapipe will do); ImageMagick for contact sheets"
  say "  to test: GoogleTest, Google Benchmark, Vulkan validation layers, spirv-val, Xvfb, xdotool, npm;"
  say "    Ipopt and OGRE 1.12 if you have them (what needs them is skipped without)"
  [[ ${#absent[@]} -eq 0 ]] || fail "these commands are missing: ${absent[*]}"
}

check_cmake() {
  local version
  version=$(cmake --version | sed -n '1s/[^0-9]*\([0-9.]*\).*/\1/p')
  if [[ $(printf '%s\n3.23\n' "$version" | sort -V | head -n 1) != 3.23 ]]; then
    fail "CMake $version is too old for the presets; 3.23 or newer is needed (pip install cmake)"
  fi
}

# The Khronos validator, which one test runs. Not having it skips that test; it is not an error.
setup_validator() {
  local folder=$top/tests/node_modules/gltf-validator
  [[ -f $top/tests/package.json ]] || return 0
  if [[ -f $folder/package.json ]] && grep -q "\"version\": \"$validator_version\"" \
      "$folder/package.json"; then
    say "glTF validator: present"
  elif ! have npm; then
    say "glTF validator: no npm, so its test will be skipped"
  elif (cd "$top/tests" && npm ci --silent --no-audit --no-fund) > /dev/null 2>&1; then
    say "glTF validator: installed into tests/node_modules"
  else
    say "glTF validator: npm could not fetch it, so its test will be skipped"
  fi
}

# Sets VK_ICD_FILENAMES to Mesa's software device unless the caller chose one or there is a GPU.
# (Meant for scripts that source this file.)
pin_software_vulkan() {
  [[ -z ${VK_ICD_FILENAMES:-}${VK_DRIVER_FILES:-} ]] || return 0
  compgen -G '/dev/dri/renderD*' > /dev/null && return 0
  local icd
  for icd in /usr/share/vulkan/icd.d/lvp_icd.*.json /etc/vulkan/icd.d/lvp_icd.*.json; do
    if [[ -f $icd ]]; then
      export VK_ICD_FILENAMES=$icd
      return 0
    fi
  done
}

setup_main() {
  local purpose=test check_only=0
  while [[ $# -gt 0 ]]; do
    case "$1" in
      --for=*) purpose=${1#*=} ;;
      --for)
        purpose=${2:-}
        [[ $# -gt 1 ]] && shift
        ;;
      --check) check_only=1 ;;
      -h | --help) usage; return 0 ;;
      *) usage >&2; return 2 ;;
    esac
    shift
  done
  if [[ $purpose != demo && $purpose != test ]]; then
    usage >&2
    return 2
  fi

  if have apt-get && have dpkg-query; then
    setup_with_apt "$purpose" "$check_only" || return 1
  else
    setup_by_hand
  fi
  check_cmake
  [[ $purpose == test && $check_only -eq 0 ]] && setup_validator
  return 0
}

if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
  setup_main "$@"
fi
