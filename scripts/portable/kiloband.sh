#!/bin/sh
# Starts bin/kiloband with the libraries of lib/. A driver that OpenCL loads into the program may need newer ones of the compiler's
# or zlib's: where the system has such, they are taken.
here=$(dirname "$(readlink -f "$0")")
. "$here/lib/newer_libraries.sh"
exec "$here/bin/kiloband" "$@"
