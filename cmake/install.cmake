# Installs in components, of which cmake/debian.cmake makes packages: fascia, dev, picture, cuda.
include(GNUInstallDirs)
set(FASCIA_LEVELS "" CACHE STRING
  "Builds of the library beside this one, of which the loader picks by processor, for example x86-64-v3;x86-64-v4")
set(private ${CMAKE_INSTALL_LIBDIR}/fascia)

file(RELATIVE_PATH to_private ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR}/fascia)
set_target_properties(fascia PROPERTIES INSTALL_RPATH "$ORIGIN/${to_private}")
install(TARGETS fascia RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT fascia)
install(TARGETS libfascia libfascia-app fascia-tools LIBRARY DESTINATION ${private} COMPONENT fascia)
set_target_properties(libfascia-app fascia-tools PROPERTIES INSTALL_RPATH "$ORIGIN")
if(TARGET fascia-picture)
  install(TARGETS fascia-picture RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT picture)
endif()
if(TARGET fascia-cuda)
  set_target_properties(fascia-cuda PROPERTIES INSTALL_RPATH "$ORIGIN")
  install(TARGETS fascia-cuda LIBRARY DESTINATION ${private} COMPONENT cuda)
endif()

# Builds the library again for newer processors: the dynamic loader looks into glibc-hwcaps before the folder itself.
include(ExternalProject)
foreach(level IN LISTS FASCIA_LEVELS)
  ExternalProject_Add(libfascia-${level}
    SOURCE_DIR ${CMAKE_SOURCE_DIR} BINARY_DIR ${CMAKE_BINARY_DIR}/${level} PREFIX ${CMAKE_BINARY_DIR}/${level}/made
    CMAKE_ARGS -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE} -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}
      -DCMAKE_C_COMPILER=${CMAKE_C_COMPILER} -DFASCIA_LEVEL=${level} -DFASCIA_TESTS=OFF -DFASCIA_CUDA=OFF -DFASCIA_PRECOMPILE=${FASCIA_PRECOMPILE}
      -DFASCIA_WITH_SUITESPARSE=${FASCIA_WITH_SUITESPARSE}
    BUILD_COMMAND ${CMAKE_COMMAND} --build <BINARY_DIR> --target libfascia libfascia-app fascia-tools
    INSTALL_COMMAND ${CMAKE_COMMAND} -E make_directory <BINARY_DIR>/stripped
    COMMAND ${CMAKE_STRIP} --strip-unneeded -o <BINARY_DIR>/stripped/libfascia.so <BINARY_DIR>/libfascia.so
    COMMAND ${CMAKE_STRIP} --strip-unneeded -o <BINARY_DIR>/stripped/libfascia-app.so <BINARY_DIR>/libfascia-app.so
    COMMAND ${CMAKE_STRIP} --strip-unneeded -o <BINARY_DIR>/stripped/fascia-tools.so <BINARY_DIR>/fascia-tools.so
    BUILD_ALWAYS ON USES_TERMINAL_BUILD ON)  # one after the other
  set(stripped ${CMAKE_BINARY_DIR}/${level}/stripped)
  install(FILES ${stripped}/libfascia.so ${stripped}/libfascia-app.so ${stripped}/fascia-tools.so
    DESTINATION ${private}/glibc-hwcaps/${level} COMPONENT fascia)
endforeach()

# For programs that embed the library: fascia/*.hpp with the headers that these include (checked by
# tests/architecture), and what find_package(fascia) reads.
set(FASCIA_PUBLIC_HEADERS
  fascia/backend.hpp fascia/rows.hpp fascia/scene.hpp fascia/scene_file.hpp fascia/simulate.hpp fascia/stepper.hpp
  assembly/specification/actions.hpp assembly/specification/body.hpp assembly/specification/domain.hpp
  assembly/specification/errors.hpp assembly/specification/fibres.hpp assembly/specification/region.hpp assembly/specification/results.hpp
  assembly/specification/scene.hpp assembly/specification/schedule.hpp assembly/specification/solver.hpp
  core/base/errors.hpp core/base/portability.hpp
  core/geometry/mesh.hpp core/geometry/mid_nodes.hpp core/geometry/point_table.hpp
  core/linear/cg.hpp core/math/mat3.hpp core/math/vec3.hpp core/math/wrench.hpp
  core/physics/active_stress.hpp core/physics/law.hpp core/physics/law_constants.hpp core/physics/viscosity.hpp core/run/run_status.hpp core/tangent/linear_settings.hpp)
foreach(header IN LISTS FASCIA_PUBLIC_HEADERS)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${CMAKE_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fascia/${folder} COMPONENT dev)
endforeach()
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/fascia)
file(RELATIVE_PATH to_prefix ${CMAKE_INSTALL_PREFIX}/${package} ${CMAKE_INSTALL_PREFIX})
configure_file(${CMAKE_SOURCE_DIR}/cmake/fascia-config.cmake.in ${CMAKE_BINARY_DIR}/fascia-config.cmake @ONLY)
include(CMakePackageConfigHelpers)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/fascia-config-version.cmake COMPATIBILITY ExactVersion)
install(FILES ${CMAKE_BINARY_DIR}/fascia-config.cmake ${CMAKE_BINARY_DIR}/fascia-config-version.cmake
  DESTINATION ${package} COMPONENT dev)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libfascia-dev COMPONENT dev)

set(shared ${CMAKE_INSTALL_DATADIR}/fascia)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/scenes ${CMAKE_SOURCE_DIR}/schemas DESTINATION ${shared} COMPONENT fascia)
install(FILES ${CMAKE_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT fascia)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/docs/manual DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs COMPONENT fascia)
install(FILES ${CMAKE_SOURCE_DIR}/docs/accuracy.md ${CMAKE_SOURCE_DIR}/docs/manual.md
  ${CMAKE_SOURCE_DIR}/docs/scene-reference.md ${CMAKE_SOURCE_DIR}/docs/validation.md
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs COMPONENT fascia)

# Pages that the program itself describes, where help2man is installed; its completion always.
add_custom_command(OUTPUT fascia.bash DEPENDS fascia VERBATIM
  COMMAND sh -c "\"$0\" completion bash >fascia.bash" $<TARGET_FILE:fascia>)
set(described ${CMAKE_CURRENT_BINARY_DIR}/fascia.bash)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fascia.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  RENAME fascia COMPONENT fascia)
find_program(HELP2MAN help2man)
if(HELP2MAN)
  foreach(program fascia fascia-picture)
    if(TARGET ${program})
      add_custom_command(OUTPUT ${program}.1.gz
        COMMAND ${CMAKE_COMMAND} -E chdir $<TARGET_FILE_DIR:${program}>  # help2man wants no spaces in the program's name
                ${HELP2MAN} --no-info --section 1 --version-string ${PROJECT_VERSION}
                --include ${CMAKE_SOURCE_DIR}/docs/man/${program}.h2m --output ${CMAKE_CURRENT_BINARY_DIR}/${program}.1 ./${program}
        COMMAND gzip -9nf ${program}.1
        DEPENDS ${program} ${CMAKE_SOURCE_DIR}/docs/man/${program}.h2m VERBATIM)
      list(APPEND described ${CMAKE_CURRENT_BINARY_DIR}/${program}.1.gz)
    endif()
  endforeach()
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fascia.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT fascia)
  if(TARGET fascia-picture)
    install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fascia-picture.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT picture)
  endif()
endif()
add_custom_target(fascia_described ALL DEPENDS ${described})

# For ./run: what it may build beside the program when a scene asks for it.
set(optional_parts "")
foreach(part fascia-tools fascia-cuda fascia-picture)
  if(TARGET ${part})
    list(APPEND optional_parts ${part})
  endif()
endforeach()
set(FASCIA_OPTIONAL_PARTS "${optional_parts}" CACHE INTERNAL "Targets that the program uses where they are there")

include(debian)
