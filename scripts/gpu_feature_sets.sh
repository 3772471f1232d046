# Sourced by scripts that compile the kernels for devices that are not there: defines_of SET prints the defines of a specialised build.
# SET: diffuse (diffuse surfaces, area lights), textured (with conductors, dielectrics, plastics, bitmaps, environment map), all
# (every feature), unspecialised (the program that is compiled for no scene). Every feature is named in kernels/base/scene.clh.
defines_of() {
  case $1 in
    diffuse | textured | all)
      sed -nE 's/^#define (KB_HAS_\w+) 1$/\1/p' kernels/base/scene.clh | while read -r feature; do
        case $1.$feature in
          all.* | *.KB_HAS_DIFFUSE | *.KB_HAS_AREA_LIGHT) echo "-D$feature=1" ;;
          textured.*_CONDUCTOR | textured.*_DIELECTRIC | textured.*_PLASTIC | textured.*_BITMAP | textured.*_ENVMAP_LIGHT)
            echo "-D$feature=1" ;;
          *) echo "-D$feature=0" ;;
        esac
      done
      echo "-DKB_SPECIALISED -DKB_BVH_STACK=$([ "$1" = diffuse ] && echo 16 || echo 48)" ;;
    unspecialised) echo "-DKB_BVH_STACK=48" ;;
    *) echo "no feature set '$1'" >&2; return 1 ;;
  esac
}
