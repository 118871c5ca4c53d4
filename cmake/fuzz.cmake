# Fuzz targets of libFuzzer, for a build of their own: clang++, FASCIA_FUZZ and FASCIA_SANITIZE=address,undefined.
option(FASCIA_FUZZ "Build the fuzz targets (needs clang)" OFF)

# fascia_fuzzer(NAME sources... LINK targets...)
function(fascia_fuzzer name)
  cmake_parse_arguments(ARG "" "" "LINK" ${ARGN})
  add_executable(${name} EXCLUDE_FROM_ALL ${ARG_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PRIVATE ${ARG_LINK})
  target_link_options(${name} PRIVATE -fsanitize=fuzzer)
endfunction()

if(FASCIA_FUZZ)
  # Coverage counters in the code under test alone, which they slow down; the fuzzer's main comes with each target.
  foreach(under_test fascia_scene fascia_io fascia_geometry)
    target_compile_options(${under_test} PRIVATE -fsanitize=fuzzer-no-link)
  endforeach()
  fascia_fuzzer(fuzz_scene fuzz_scene.cpp LINK fascia_scene)
  fascia_fuzzer(fuzz_gmsh fuzz_gmsh.cpp LINK fascia_io VTK::CommonDataModel)
endif()
