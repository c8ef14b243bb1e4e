# One target a room of src/ROOMS, an object library of all sources in its folder, and of all of them the library isoshell.
# The target `rooms` links each room as a library that may use only those of its row: the linker says what the includes
# do not, as a function that is declared in a public header and defined in a room which another may not know.

# How the sources of the library are compiled, whichever target they belong to.
function(isoshell_compile_as_library target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  # Static, and fit to be linked into a shared library, as a module of Python is. Nobody replaces a function of ours
  # there, so the compiler may go on inlining them.
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fno-semantic-interposition>)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                              $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
                             PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:isoshell_numerics> TBB::tbb
                                          $<BUILD_INTERFACE:NanoVDB::headers>
                                          $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>)
endfunction()

# Sources for which a library was not found are left out, and what stands for them in src/absent is taken.
function(isoshell_sources_of room result)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${room}/*.cpp)
  if(NOT ISOSHELL_HAS_DRACO)
    list(FILTER sources EXCLUDE REGEX codecs/gltf_draco)
  endif()
  if(NOT ISOSHELL_HAS_MESHOPT)
    list(FILTER sources EXCLUDE REGEX codecs/gltf_meshopt)
  endif()
  if(NOT ISOSHELL_VDB)
    list(FILTER sources EXCLUDE REGEX io/openvdb/)
  endif()
  foreach(library CUDA DRACO MESHOPT VDB)
    if(ISOSHELL_HAS_${library} OR (library STREQUAL "VDB" AND ISOSHELL_VDB))
      string(TOLOWER ${library} name)
      list(FILTER sources EXCLUDE REGEX absent/no_${name})
    endif()
  endforeach()
  set(${result} ${sources} PARENT_SCOPE)
endfunction()

function(isoshell_add_room room)
  isoshell_sources_of(${room} sources)
  if(NOT sources)
    return()
  endif()
  string(REPLACE "/" "_" name isoshell_${room})
  add_library(${name} OBJECT ${sources})
  isoshell_compile_as_library(${name})
  if(room STREQUAL "io/openvdb")  # OpenVDB's headers take seconds
    target_link_libraries(${name} PRIVATE OpenVDB::openvdb)
    if(ISOSHELL_PRECOMPILE)
      target_precompile_headers(${name} PRIVATE <openvdb/openvdb.h>)
    endif()
  elseif(room STREQUAL "io/gltf/codecs")
    foreach(library DRACO MESHOPT)
      if(ISOSHELL_HAS_${library})
        target_link_libraries(${name} PRIVATE ${ISOSHELL_${library}_TARGET})
      endif()
    endforeach()
  elseif(ISOSHELL_PRECOMPILE)
    target_precompile_headers(${name} REUSE_FROM isoshell_precompiled)
  endif()
  target_sources(isoshell PRIVATE $<TARGET_OBJECTS:${name}>)
endfunction()

# The one public header that is made: isoshell/version.h.
configure_file(${CMAKE_CURRENT_LIST_DIR}/version.h.in ${PROJECT_BINARY_DIR}/include/isoshell/version.h @ONLY)
add_library(isoshell ${PROJECT_BINARY_DIR}/isoshell.cpp)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/isoshell.cpp CONTENT "// The rooms are the library.\n")
add_library(isoshell::isoshell ALIAS isoshell)
isoshell_compile_as_library(isoshell)
if(ISOSHELL_PRECOMPILE)
  add_library(isoshell_precompiled OBJECT ${PROJECT_BINARY_DIR}/isoshell.cpp)
  isoshell_compile_as_library(isoshell_precompiled)
  target_precompile_headers(isoshell_precompiled PRIVATE <precompiled.h>)  # by no path, so that ccache knows it elsewhere
endif()
if(ISOSHELL_VDB)
  target_link_libraries(isoshell PRIVATE OpenVDB::openvdb)
  # For programs that include isoshell/openvdb.h: how OpenVDB is compiled against decides how its grids lie in memory.
  add_library(isoshell_openvdb INTERFACE)
  add_library(isoshell::openvdb ALIAS isoshell_openvdb)
  set_target_properties(isoshell_openvdb PROPERTIES EXPORT_NAME openvdb)
  target_link_libraries(isoshell_openvdb INTERFACE isoshell OpenVDB::openvdb)
endif()
foreach(library DRACO MESHOPT)
  if(ISOSHELL_HAS_${library})
    target_link_libraries(isoshell PRIVATE ${ISOSHELL_${library}_TARGET})
  endif()
endforeach()

set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/ROOMS)
file(STRINGS ${PROJECT_SOURCE_DIR}/src/ROOMS rows REGEX "^[a-z]")
foreach(row ${rows})
  string(REGEX MATCH "^[a-z_/]+" room ${row})
  isoshell_add_room(${room})
endforeach()
