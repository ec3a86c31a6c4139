# Finds the header for drivers from outside the tree: target thimble::plugin.
if(NOT TARGET thimble::plugin)
  get_filename_component(_thimble_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
  add_library(thimble::plugin INTERFACE IMPORTED)
  set_target_properties(thimble::plugin PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${_thimble_prefix}/include")
  unset(_thimble_prefix)
endif()
