#!/usr/bin/env bash
# Build the toolchain that the C twins are measured with: GCC 12.2, binutils 2.40, newlib 3.3 and the GNU simulator of
# gdb 13.1, for bfin-elf, from the source packages of Debian 12.
#
#   benchmarks/toolchain/build.sh PREFIX      then: export PATH=PREFIX/bin:$PATH
#
# On Debian 12. Installs the source packages and what builds them first, for which it must be root; where all of them
# are there already, it need not. Takes about ten minutes on two cores, 3 GB in the temporary folder while it runs, and
# 250 MB in PREFIX. What each program prints goes to PREFIX/build.log.
set -Eeuo pipefail

packages=(
  gcc-12-source binutils-source gdb-source newlib-source
  build-essential bison flex texinfo xz-utils libgmp-dev libmpfr-dev libmpc-dev
)
target=bfin-elf
common=(--target=$target --disable-nls --disable-werror)
no_docs=MAKEINFO=true # the manuals take long, and Debian leaves GCC's out

if [ $# -ne 1 ] || [ "${1#-}" != "$1" ]; then
  echo "usage: $0 PREFIX" >&2
  exit 2
fi
mkdir -p "$1"
prefix=$(cd "$1" && pwd)
common+=(--prefix="$prefix")
export PATH="$prefix/bin:$PATH"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
make=(make -j"$(nproc)" "$no_docs")

say() { echo "$(date +%T) $*" >&3; }

install_packages() {
  dpkg -s "${packages[@]}" > /dev/null 2>&1 && return
  apt-get update
  apt-get install -y --no-install-recommends "${packages[@]}"
}

unpack() {
  cd "$work"
  tar xf /usr/src/binutils/binutils-2.40.tar.xz
  tar xf /usr/src/gcc-12/gcc-12.2.0-dfsg.tar.xz
  tar xf /usr/src/newlib/newlib-3.3.0.tar.xz # as newlib-salsa
  tar xf /usr/src/gdb.tar.xz                 # as gdb
}

# Enter an empty folder and configure a source tree there.
configure() {
  local tree=$1
  shift
  mkdir "$work/build-$tree"
  cd "$work/build-$tree"
  "../$tree/configure" "${common[@]}" "$@"
}

build_binutils() {
  configure binutils-2.40 --disable-gdb --disable-sim --disable-gprof --disable-gprofng --disable-gold
  "${make[@]}"
  "${make[@]}" install
}

build_gcc() {
  configure gcc-12.2.0 --enable-languages=c --with-newlib --disable-shared --disable-threads --disable-multilib \
    --disable-bootstrap --disable-lto --disable-plugin --disable-gcov --disable-libssp --disable-libquadmath
  "${make[@]}" all-gcc CFLAGS=-O1 CXXFLAGS=-O1 # of the compiler itself; its code is the same, built in less time
  touch gcc/s-tm-texi                          # a step that compares with the manual, which is not there
  make "$no_docs" install-gcc
  "${make[@]}" all-target-libgcc
  make "$no_docs" install-target-libgcc
}

build_newlib() {
  configure newlib-salsa --disable-multilib CFLAGS_FOR_TARGET="-g -O2"
  "${make[@]}"
  make "$no_docs" install
}

build_simulator() {
  configure gdb --enable-sim --disable-gdb --disable-gdbserver --disable-binutils --disable-gas --disable-ld \
    --disable-gprof --disable-gprofng
  "${make[@]}" all-sim
  make "$no_docs" install-sim
}

# A program must compile, run and be counted.
try_out() {
  cd "$work"
  echo 'int main(void) { return 42; }' > try.c
  "$target-gcc" -mcpu=bf561 -msim -O2 try.c -o try
  local status=0
  "$target-run" try || status=$?
  [ $status -eq 42 ]
}

exec 3>&1 > "$prefix/build.log" 2>&1
trap 'say "failed; see $prefix/build.log"; rm -rf "$work"' ERR
for step in install_packages unpack build_binutils build_gcc build_newlib build_simulator try_out; do
  say "$step"
  $step
done
say "done: $("$target-gcc" --version | head -1), $("$target-run" --version | head -1)"
