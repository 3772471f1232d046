#!/usr/bin/env bash
# Says how large the archive is; refuses one above the 48 MB that docs/portable.md promises. usage: check_size.sh FILE
set -euo pipefail

bytes=$(stat -c %s "$1")
echo "$1: $bytes bytes"
[ "$bytes" -le 48000000 ] || { echo "check_size: more than 48 MB" >&2; exit 1; }
