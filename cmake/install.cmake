# What `cmake --install` and the Debian package hold: headers, library, find_package(isoshell) files, the command.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(isoshell_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/isoshell)

install(TARGETS isoshell EXPORT isoshell ARCHIVE COMPONENT dev LIBRARY COMPONENT runtime
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(ISOSHELL_VDB)
  install(TARGETS isoshell_openvdb EXPORT isoshell)
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/isoshell ${PROJECT_BINARY_DIR}/include/isoshell DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
install(EXPORT isoshell NAMESPACE isoshell:: FILE isoshellTargets.cmake DESTINATION ${isoshell_cmake_dir} COMPONENT dev)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/isoshellConfig.cmake.in ${PROJECT_BINARY_DIR}/isoshellConfig.cmake
                              INSTALL_DESTINATION ${isoshell_cmake_dir})
# Below 1.0 every minor version may change the interface. From 1.0 on this is SameMajorVersion.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/isoshellConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/isoshellConfig.cmake ${PROJECT_BINARY_DIR}/isoshellConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/openvdb.cmake
        DESTINATION ${isoshell_cmake_dir} COMPONENT dev)
# One for each package, which may not hold the same file.
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR}-dev COMPONENT dev)

# For builds without CMake. The archive is static, so what it needs is part of --libs.
set(isoshell_pc_requires "tbb")
set(isoshell_pc_libs "")
if(ISOSHELL_VDB)
  set(isoshell_pc_requires "tbb blosc zlib")
  if(TARGET Imath::Imath)  # whose halves OpenVDB may be built with
    string(APPEND isoshell_pc_requires " Imath")
  endif()
  set(isoshell_pc_libs " -lopenvdb -lboost_iostreams")
endif()
if(ISOSHELL_HAS_DRACO)
  string(APPEND isoshell_pc_libs " -ldraco")
endif()
if(ISOSHELL_HAS_MESHOPT)
  string(APPEND isoshell_pc_libs " -lmeshoptimizer")
endif()
if(ISOSHELL_HAS_CUDA)
  list(GET CMAKE_CUDA_HOST_IMPLICIT_LINK_DIRECTORIES -1 isoshell_cuda_libdir)
  string(APPEND isoshell_pc_libs " -L${isoshell_cuda_libdir} -lcudart_static -ldl -lrt")
endif()
# From where the file lies, so that an installed folder may be moved.
file(RELATIVE_PATH isoshell_pc_prefix ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
string(REGEX REPLACE "/$" "" isoshell_pc_prefix "${isoshell_pc_prefix}")
file(RELATIVE_PATH isoshell_pc_libdir ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_LIBDIR})
file(RELATIVE_PATH isoshell_pc_includedir ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_INCLUDEDIR})
configure_file(${CMAKE_CURRENT_LIST_DIR}/isoshell.pc.in ${PROJECT_BINARY_DIR}/isoshell.pc @ONLY)
# What OpenVDB is compiled against with, for isoshell/openvdb.h.
if(ISOSHELL_VDB)
  get_target_property(isoshell_openvdb_definitions OpenVDB::openvdb INTERFACE_COMPILE_DEFINITIONS)
  set(isoshell_pc_openvdb_cflags "")
  foreach(definition ${isoshell_openvdb_definitions})
    string(APPEND isoshell_pc_openvdb_cflags " -D${definition}")
  endforeach()
  configure_file(${CMAKE_CURRENT_LIST_DIR}/isoshell-openvdb.pc.in ${PROJECT_BINARY_DIR}/isoshell-openvdb.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/isoshell-openvdb.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
endif()
install(FILES ${PROJECT_BINARY_DIR}/isoshell.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)

if(PROJECT_IS_TOP_LEVEL)
  include(${CMAKE_CURRENT_LIST_DIR}/packages.cmake)
endif()
