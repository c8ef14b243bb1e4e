# Finds OpenVDB (target OpenVDB::openvdb). Its find-module ships with the library and lies in a different place on every
# system; this file is the one place that knows. Sets ISOSHELL_OPENVDB_FOUND.

# A function, because the module sets variables such as BUILD_SHARED_LIBS that must not leak into our targets.
function(isoshell_find_openvdb)
  find_path(OpenVDB_CMAKE_DIR FindOpenVDB.cmake
    PATH_SUFFIXES lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB lib/cmake/OpenVDB lib64/cmake/OpenVDB)
  mark_as_advanced(OpenVDB_CMAKE_DIR)
  if(OpenVDB_CMAKE_DIR)
    list(APPEND CMAKE_MODULE_PATH ${OpenVDB_CMAKE_DIR})
  endif()
  if(NOT TARGET OpenVDB::openvdb)
    # Silent: the module prints notes about parts that we do not use.
    set(CMAKE_MESSAGE_LOG_LEVEL ERROR)
    find_package(OpenVDB 10 QUIET COMPONENTS openvdb)
  endif()
  if(TARGET OpenVDB::openvdb)
    set(CMAKE_MESSAGE_LOG_LEVEL STATUS)
    message(STATUS "OpenVDB ${OpenVDB_VERSION}")
    set(ISOSHELL_OPENVDB_FOUND TRUE PARENT_SCOPE)
  else()
    set(ISOSHELL_OPENVDB_FOUND FALSE PARENT_SCOPE)
  endif()
endfunction()
isoshell_find_openvdb()
