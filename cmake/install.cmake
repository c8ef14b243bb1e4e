# What `cmake --install` and the Debian package hold: headers, library, find_package(isoshell) files, the command.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(isoshell_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/isoshell)

install(TARGETS isoshell EXPORT isoshell ARCHIVE COMPONENT dev LIBRARY COMPONENT runtime
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/isoshell DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
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

if(PROJECT_IS_TOP_LEVEL)
  set(CPACK_GENERATOR DEB)
  set(CPACK_PACKAGE_CONTACT "the isoshell maintainers <maintainers@isoshell.invalid>")
  set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_DEB_COMPONENT_INSTALL ON)
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME isoshell)
  set(CPACK_DEBIAN_DEV_PACKAGE_NAME libisoshell-dev)
  # The library is static, and OpenVDB's CMake module asks for all that OpenVDB was built with.
  set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
      "libtbb-dev, libopenvdb-dev, libblosc-dev, libboost-iostreams-dev, libimath-dev, zlib1g-dev")
  include(CPack)
endif()
