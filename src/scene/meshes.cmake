kiloband_library(kiloband_meshes
  SOURCES mesh_input.cpp mesh_text.cpp mesh_normals.cpp mesh_finish.cpp mesh_obj.cpp mesh_ply_header.cpp mesh_ply.cpp
          mesh_stl.cpp mesh_serialized.cpp mesh_inflate.cpp
  DEPENDS kiloband_base ZLIB::ZLIB)

# Debian's package names OpenCV's header folder without depending on it; CMake refuses folders that do not exist.
get_target_property(_oiio_includes OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
set(_oiio_existing "")
foreach(_folder IN LISTS _oiio_includes)
  if(EXISTS "${_folder}")
    list(APPEND _oiio_existing "${_folder}")
  endif()
endforeach()
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${_oiio_existing}")

kiloband_library(kiloband_images
  SOURCES image_format.cpp image_channels.cpp image_oiio.cpp negative_values.cpp spectral_image.cpp
  DEPENDS kiloband_base kiloband_film OpenImageIO::OpenImageIO)
