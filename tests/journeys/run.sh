#!/usr/bin/env bash
# Journeys through the window in Chromium. It is taken from the variable CHROMIUM or the path; where it is missing and apt is
# there, Debian's package is installed. Where it is not available, that is said loudly; with JOURNEYS=required it is a failure.
#   tests/journeys/run.sh PYTHON
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
python=${1:-python3}
found() { [ -n "${CHROMIUM:-}" ] || command -v chromium chromium-browser google-chrome google-chrome-stable chrome >/dev/null; }
if ! found && command -v apt-get >/dev/null; then
    as_root=(); [ "$(id -u)" = 0 ] || as_root=(sudo -n)
    echo "journeys: Chromium is missing: installing Debian's package"
    { timeout 120 "${as_root[@]}" apt-get update -q && DEBIAN_FRONTEND=noninteractive \
        timeout 300 "${as_root[@]}" apt-get install -q -y --no-install-recommends chromium; } >journeys-apt.log 2>&1 || tail -n 5 journeys-apt.log
    rm -f journeys-apt.log
fi
if ! found; then
    printf '\n%s\n%s\n%s\n\n' "**************** JOURNEYS OF THE WINDOW WERE NOT MADE ****************" \
        "There is no Chromium, and it could not be installed. The page was NOT tried in a browser." \
        "Install chromium, or name it: CHROMIUM=/path/to/chromium make journeys"
    [ "${JOURNEYS:-}" != required ]; exit
fi
PYTHONPATH=src:tests OMP_NUM_THREADS=1 "$python" -m pytest -q -p no:cacheprovider -n 2 --dist worksteal tests/journeys/journeys.py
