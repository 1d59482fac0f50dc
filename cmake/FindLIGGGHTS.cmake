# Find the installed LIGGGHTS: headers, shared library, and its version.
#
#   LIGGGHTS_FOUND, LIGGGHTS_VERSION, target LIGGGHTS::LIGGGHTS (headers, library, generated style_*_model.h)
#
# Debian's libliggghts-dev lacks the style_*_model.h that LIGGGHTS' own build generates; they are lists of the model
# headers and are written here from what is installed.

find_path(LIGGGHTS_INCLUDE_DIR NAMES contact_models.h PATH_SUFFIXES liggghts)
find_library(LIGGGHTS_LIBRARY NAMES liggghts)

# no installed header tells the version; the library's file name does
if(LIGGGHTS_LIBRARY)
  file(REAL_PATH ${LIGGGHTS_LIBRARY} _library_file)
  string(REGEX MATCH "[0-9]+\\.[0-9]+(\\.[0-9]+)?$" LIGGGHTS_VERSION "${_library_file}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LIGGGHTS
  REQUIRED_VARS LIGGGHTS_LIBRARY LIGGGHTS_INCLUDE_DIR
  VERSION_VAR LIGGGHTS_VERSION
  REASON_FAILURE_MESSAGE "On Debian and Ubuntu: apt-get install libliggghts-dev liggghts")

if(LIGGGHTS_FOUND AND NOT TARGET LIGGGHTS::LIGGGHTS)
  set(_styles ${CMAKE_CURRENT_BINARY_DIR}/liggghts_styles)
  foreach(kind surface normal tangential cohesion rolling)
    string(TOUPPER ${kind} _macro)
    file(GLOB _headers RELATIVE ${LIGGGHTS_INCLUDE_DIR} ${LIGGGHTS_INCLUDE_DIR}/${kind}_model_*.h)
    set(_includes "")
    foreach(_header IN LISTS _headers)
      file(STRINGS ${LIGGGHTS_INCLUDE_DIR}/${_header} _entry REGEX "^${_macro}_MODEL\\(")
      if(_entry)
        string(APPEND _includes "#include \"${_header}\"\n")
      endif()
    endforeach()
    file(CONFIGURE OUTPUT ${_styles}/style_${kind}_model.h CONTENT "${_includes}")
  endforeach()

  add_library(LIGGGHTS::LIGGGHTS UNKNOWN IMPORTED)
  set_target_properties(LIGGGHTS::LIGGGHTS PROPERTIES
    IMPORTED_LOCATION ${LIGGGHTS_LIBRARY}
    INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${LIGGGHTS_INCLUDE_DIR}"
    INTERFACE_INCLUDE_DIRECTORIES "${LIGGGHTS_INCLUDE_DIR};${_styles}")
endif()
mark_as_advanced(LIGGGHTS_INCLUDE_DIR LIGGGHTS_LIBRARY)
