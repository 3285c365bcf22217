#!/bin/sh
# The wheel, as somebody gets it who installs mien and nothing else: built from the source
# distribution, installed without extras into an empty environment, and used from an empty folder.
#
#   .ci/empty_environment.sh [FOLDER]     FOLDER is kept; without one all is thrown away
#
# Prints times and sizes. Fails where something that must work does not, and where the want of an
# extra is not told in one line that names it.
set -eu
cd "$(dirname "$0")/.."
root=$PWD
if [ $# -gt 0 ]; then
    mkdir -p "$1"
    work=$(cd "$1" && pwd)
else
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
fi
# The first that runs: a name on PATH may be a shim for a version that is not installed.
python=${PYTHON:-$(for p in python3.12 python3.11 python3; do
    "$p" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 13))' 2>/dev/null && echo "$p" && break
done)}
began() { begin=$(date +%s.%N); }
told() { awk -v a="$begin" -v b="$(date +%s.%N)" -v t="$1" 'BEGIN {printf "%-58s %8.2f s\n", t, b - a}'; }

export UV_PYTHON_DOWNLOADS=never
uv=$root/.boot/bin/uv
[ -x "$uv" ] || { "$python" -m venv "$work/boot"; "$work/boot/bin/python" -m pip install -q uv; uv=$work/boot/bin/uv; }
began
"$uv" build --quiet --python "$python" --out-dir "$work/dist" .
told "source distribution, and the wheel out of it"
ls -l "$work/dist" | awk '/mien-/ {printf "%-58s %8.1f MB\n", $NF, $5 / 1e6}'

began
"$python" -m venv --without-pip "$work/empty"
"$uv" pip install --quiet --python "$work/empty/bin/python" "$work"/dist/mien-*.whl
told "installed without extras"
site=$("$work/empty/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
du -sm "$site/mien" "$site" | awk '{printf "%-58s %8d MB\n", (NR == 1 ? "mien itself" : "with all it needs"), $1}'

mkdir -p "$work/here" "$work/home"
cd "$work/here"
mien() { env -i PATH="$work/empty/bin:/usr/bin:/bin" HOME="$work/home" mien "$@"; }
for i in 1 2 3 4 5; do
    began
    mien --help >/dev/null
    told "mien --help, time $i (0.3 s asked of a quiet machine)"
done
began
mien doctor >doctor.txt || { cat doctor.txt; exit 1; }
told "mien doctor, compiling as it goes"
grep -q 'mediapipe==' doctor.txt || { echo "doctor does not tell how to get the networks"; exit 1; }
began
mien animate "$site/mien/data/sample.mp4" --capture snakes -c man --no-preview -o man.glb
told "the sample by its curves, into a GLB"
[ "$(head -c 4 man.glb)" = glTF ]

# Each extra: what wants it says so, in one line, and exits 1.
wants() {
    extra=$1
    shift
    status=0
    mien "$@" >out.txt 2>err.txt || status=$?
    if [ "$status" != 1 ] || [ "$(wc -l <err.txt)" != 1 ] || ! grep -q "mien\[$extra\]" err.txt; then
        echo "without the extra '$extra', 'mien $*' says (exit $status):"
        cat out.txt err.txt
        exit 1
    fi
    cat err.txt
}
wants landmarks capture "$site/mien/data/sample.mp4" -o take.mien
wants studio studio
wants batch batch "$site/mien/data/sample.mp4" -c man -o out
wants draco character check "$root/tests/compressed/draco.glb"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >scan.obj
wants scan scan points scan.obj --units mm
echo "all that must work works, and every extra is asked for by its name"
