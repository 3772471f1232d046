# Names the system's libraries of which lib/ has an older version in LD_PRELOAD. $here: the portable folder. They are told by the names of
# their files (libstdc++.so.6.0.30): the version that a link points to; libgcc_s, whose name has none, comes with libstdc++.
system_library() {
  for folder in /lib/x86_64-linux-gnu /usr/lib/x86_64-linux-gnu /lib64 /usr/lib64 /usr/lib; do
    if [ -e "$folder/$1" ]; then echo "$folder/$1"; return; fi
  done
}

is_newer() {  # FILE NAME: than the version that lib/versions has of it
  theirs=$(basename "$(readlink -f "$1")")
  ours=$(sed -n "s/^$2 //p" "$here/lib/versions")
  [ "$theirs" != "$ours" ] && [ "$(printf '%s\n' "$ours" "$theirs" | sort -V | tail -n 1)" = "$theirs" ]
}

preload=
for name in libstdc++.so.6 libz.so.1; do
  file=$(system_library "$name")
  if [ -n "$file" ] && is_newer "$file" "$name"; then
    preload="$preload${preload:+:}$file"
    gcc=$(system_library libgcc_s.so.1)
    if [ "$name" = libstdc++.so.6 ] && [ -n "$gcc" ]; then preload="$preload:$gcc"; fi
  fi
done
if [ -n "$preload" ]; then export LD_PRELOAD="$preload${LD_PRELOAD:+:$LD_PRELOAD}"; fi
