# The Debian packages that cpack makes: isoshell (the commands), libisoshell-dev and, with ISOSHELL_PYTHON_DIR,
# python3-isoshell. scripts/packages.sh builds them.
set(CPACK_GENERATOR DEB)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGE_CONTACT "the isoshell maintainers <maintainers@isoshell.invalid>")
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL runtime dev)

# What every package says of itself below the project's own summary, which CPack puts first.
function(isoshell_package component name section text)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${text}" PARENT_SCOPE)
  set(doc ${CMAKE_INSTALL_DATADIR}/doc/${name})
  install(FILES ${PROJECT_SOURCE_DIR}/packaging/copyright DESTINATION ${doc} COMPONENT ${component})
  install(FILES ${PROJECT_BINARY_DIR}/packaging/changelog.Debian.gz DESTINATION ${doc} COMPONENT ${component})
endfunction()

# Debian's own changelog says which release this is; what changed is in CHANGELOG.md.
string(TIMESTAMP isoshell_date "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(${PROJECT_SOURCE_DIR}/packaging/changelog.in ${PROJECT_BINARY_DIR}/packaging/changelog.Debian @ONLY)
execute_process(COMMAND gzip -9nf ${PROJECT_BINARY_DIR}/packaging/changelog.Debian COMMAND_ERROR_IS_FATAL ANY)

set(isoshell_about "Any surface (a scan with holes, a triangle soup, points, a volume) becomes a\n\
mesh of nearly equilateral triangles, through sparse volumes.")
isoshell_package(runtime isoshell graphics
                 "${isoshell_about}\n.\nThis package holds the commands vdb_isomesh and vdb_meshinfo.")
isoshell_package(dev libisoshell-dev libdevel
                 "${isoshell_about}\n.\nThis package holds headers, the static library, and files for CMake\nand pkg-config.")
# The library is static, and OpenVDB's CMake module asks for all that OpenVDB was built with.
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
    "libtbb-dev, libopenvdb-dev, libblosc-dev, libboost-iostreams-dev, libimath-dev, zlib1g-dev")
if(ISOSHELL_HAS_DRACO)
  string(APPEND CPACK_DEBIAN_DEV_PACKAGE_DEPENDS ", libdraco-dev")
endif()
if(ISOSHELL_HAS_MESHOPT)
  string(APPEND CPACK_DEBIAN_DEV_PACKAGE_DEPENDS ", libmeshoptimizer-dev")
endif()
if(ISOSHELL_PYTHON_DIR)
  isoshell_package(python python3-isoshell python
                   "${isoshell_about}\n.\nThis package holds the module for this system's own Python 3, and\nthe command isoshell.")
  list(APPEND CPACK_COMPONENTS_ALL python)
  # A compiled module is for one version of Python.
  execute_process(COMMAND ${Python3_EXECUTABLE} -c "import sys; v = sys.version_info; \
print(f'python3 (>= {v[0]}.{v[1]}~), python3 (<< {v[0]}.{v[1] + 1}), python3-numpy')"
                  OUTPUT_VARIABLE CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS OUTPUT_STRIP_TRAILING_WHITESPACE
                  COMMAND_ERROR_IS_FATAL ANY)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_STRICT_PERMISSION ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/python/postinst
                                                ${PROJECT_SOURCE_DIR}/packaging/python/prerm)
endif()
include(CPack)
