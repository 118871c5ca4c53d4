# Packages for Debian: cpack -G DEB in the build folder; cmake/package.sh does all of it.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME fascia)
set(CPACK_PACKAGE_CONTACT "The fascia authors <fascia@users.noreply.github.com>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR})

# fascia_package(COMPONENT PACKAGE DEPENDS depends SUMMARY line TEXT lines): the package of a component.
set(CPACK_COMPONENTS_ALL "")
macro(fascia_package component package depends summary text)
  set(package ${package})  # for configure_file
  string(TOUPPER ${component} upper)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package})
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}")
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${summary}\n${text}")
  # Debian wants two files of each package: who may use it, and what is new.
  file(READ ${CMAKE_SOURCE_DIR}/LICENSE license)
  file(WRITE ${CMAKE_BINARY_DIR}/debian/${package}/copyright "${license}")
  configure_file(${CMAKE_SOURCE_DIR}/cmake/changelog.in ${CMAKE_BINARY_DIR}/debian/${package}/changelog @ONLY)
  execute_process(COMMAND gzip -9nf ${CMAKE_BINARY_DIR}/debian/${package}/changelog)
  install(FILES ${CMAKE_BINARY_DIR}/debian/${package}/copyright ${CMAKE_BINARY_DIR}/debian/${package}/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
endmacro()

fascia_package(fascia fascia ""
  "Simulator of connective tissue and the organs that it ties together"
  "Meshless bodies on frames, finite elements and shells, coupled through shared\nframes; statics, dynamics and modes of scenes that are described in TOML files.")
set(CPACK_DEBIAN_FASCIA_PACKAGE_RECOMMENDS "fascia-picture, bash-completion")
fascia_package(dev libfascia-dev "fascia (= ${PROJECT_VERSION})"
  "Headers of the simulator fascia"
  "For C++ programs that build a model, step it and drive it themselves:\nfind_package(fascia) of CMake, and an example.")
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
if(TARGET fascia-picture)
  fascia_package(picture fascia-picture "fascia (= ${PROJECT_VERSION})"
    "Pictures of fascia's results"
    "Renders what the simulator fascia has written, for scenes that ask for a\npicture, or by hand.")
  set(CPACK_DEBIAN_PICTURE_PACKAGE_RECOMMENDS "xvfb, xauth")
endif()
if(TARGET fascia-cuda)
  fascia_package(cuda fascia-cuda "fascia (= ${PROJECT_VERSION})"
    "GPU backend of the simulator fascia"
    "A module that the simulator loads where a scene is large enough for an NVIDIA\nGPU, of compute capability 8.0 or later, or asks for it.")
endif()
include(CPack)
