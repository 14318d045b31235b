#!/usr/bin/env bash
# film.mk makes a film from frames, makes nothing twice, and notices what has changed: an option, a frame, a program.
# usage: film_test.sh MAKE PROGRAMS_DIR SOURCE_DIR WORK_DIR
set -euo pipefail
make=$1 programs=$2 source=$3 work=$4
rm -rf "$work" && mkdir -p "$work/bin" "$work/frames"
cd "$work"
# Copies, so that a program can be touched without touching the build.
for program in tet4d-mc dyntri-build tet4d-play tet4d-convert; do ln "$programs/$program" bin/ 2>/dev/null || cp "$programs/$program" bin/; done
cp "$source"/tests/data/dambreak/alpha_00{08,09,10}.nrrd frames/

film() {
  "$make" --no-print-directory -f "$source/scripts/pipelines/film.mk" TET4D_BIN=bin FRAMES_DIR=frames SIZE=64x36 COLUMNS=2 TILES=4 \
    TIMES=0f:2f:0.5f SLICE_TIMES=0f:2f:1f PLAY_FLAGS="--renderer cpu" "$@" out/contact-sheet.png out/slices/slices.pvd out/film.y4m
}
fail() { echo "film_test: $1" >&2; exit 1; }
newer() { [ "$1" -nt "$2" ] || fail "$1 was not made again $3"; }

film >log 2>&1 || { cat log; fail "the first run failed"; }
for file in out.t4h out.t4d out/contact-sheet.png out/frames/00000.png out/frames/00004.png out/film.y4m out/slices/slices.pvd \
  out/slices/slices_0002.vtp; do
  [ -s "$file" ] || fail "$file is missing"
done
[ ! -e out/frames/00005.png ] || fail "there are more pictures than times"

film >log 2>&1
[ ! -s log ] || { cat log; fail "a second run made something"; }

touch mark && sleep 0.05 && film ISO=0.4 >log 2>&1
newer out.t4h mark "for another isovalue" && newer out/contact-sheet.png mark "for another isovalue"
touch mark && sleep 0.05 && film ISO=0.4 TIMES=0f:1f:0.5f >log 2>&1
newer out/contact-sheet.png mark "for other times"
[ ! -e out/frames/00003.png ] || fail "pictures of the earlier film are left"
[ mark -nt out.t4h ] || fail "the hypermesh was made again for other times"
touch mark && sleep 0.05 && touch frames/alpha_0009.nrrd && film ISO=0.4 TIMES=0f:1f:0.5f >log 2>&1
newer out.t4h mark "for a changed frame"
touch mark && sleep 0.05 && cp --remove-destination "$programs/tet4d-play" bin/ && film ISO=0.4 TIMES=0f:1f:0.5f >log 2>&1
newer out/film.y4m mark "for a changed program"
[ mark -nt out.t4d ] || fail "the triangles were made again for a changed player"
echo "film_test: made, not made twice, made again when needed"
