# Warnings, tuning, caching and sanitizers of every target: link to fascia_flags.
include(native)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

# Objects go into libfascia.so; nobody replaces its functions at load time, so that calls within it need no detour.
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

# Compilations are taken from ccache where it is installed: see ccache.in for what makes them independent of the folder.
find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  configure_file(${CMAKE_SOURCE_DIR}/cmake/ccache.in ${CMAKE_BINARY_DIR}/tools/ccache @ONLY)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_BINARY_DIR}/tools/ccache)
  set(CMAKE_CUDA_COMPILER_LAUNCHER ${CMAKE_BINARY_DIR}/tools/ccache)
endif()

# fascia_plain_flags: for what starts on any processor; fascia_flags: tuned.
add_library(fascia_plain_flags INTERFACE)
add_library(fascia_flags INTERFACE)
target_link_libraries(fascia_flags INTERFACE fascia_plain_flags)
target_include_directories(fascia_plain_flags INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(fascia_plain_flags INTERFACE
  $<$<COMPILE_LANGUAGE:C,CXX>:-Wall;-Wextra;-Wpedantic;-Wconversion;-Wshadow;-fno-semantic-interposition>
  # No path of this folder in what is built: two builds in two folders are equal.
  $<$<COMPILE_LANGUAGE:C,CXX>:-ffile-prefix-map=${CMAKE_SOURCE_DIR}/=>
  $<$<COMPILE_LANGUAGE:CUDA>:--expt-relaxed-constexpr;--extended-lambda;-Xcompiler=-Wall,-Wextra,-Wshadow>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 warns inside its own headers: AVX-512 (bug 105593), std::string (bugs 105329, 105651).
  target_compile_options(fascia_plain_flags INTERFACE $<$<COMPILE_LANGUAGE:C,CXX>:-Wno-psabi;-Wno-maybe-uninitialized;-Wno-restrict;-Wno-stringop-overflow>)
  # The compiler collects its garbage from 500 MB on, not from 128: a twelfth of its time, where each of its processes has
  # the memory.
  cmake_host_system_information(RESULT megabytes QUERY TOTAL_PHYSICAL_MEMORY)
  cmake_host_system_information(RESULT processors QUERY NUMBER_OF_LOGICAL_CORES)
  math(EXPR megabytes "${megabytes} / (${processors} + 2)")
  if(megabytes GREATER 1000)
    target_compile_options(fascia_plain_flags INTERFACE "$<$<COMPILE_LANGUAGE:C,CXX>:SHELL:--param ggc-min-heapsize=500000>")
  endif()
endif()
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  # Part of -Wconversion there, not of g++'s. Reserved names cost clang-tidy much more time.
  target_compile_options(fascia_plain_flags INTERFACE -Wno-sign-conversion -Wreserved-identifier -Wreserved-macro-identifier)
endif()
# Not for nvcc's host pass, whose front end does not know every instruction that the host compiler does.
if(FASCIA_LEVEL)
  set(FASCIA_TUNING ${FASCIA_LEVEL})
  set(tuning -march=${FASCIA_LEVEL})
elseif(FASCIA_NATIVE)
  native_flags(tuning)
  string(REGEX REPLACE "^-march=([^;]+).*" "native (\\1)" FASCIA_TUNING "${tuning}")
else()
  set(FASCIA_TUNING x86-64)
  set(tuning "")
endif()
target_compile_options(fascia_flags INTERFACE "$<$<COMPILE_LANGUAGE:C,CXX>:${tuning}>")
processor_checks(FASCIA_PROCESSOR_CHECKS "${tuning}")
if(FASCIA_SANITIZE)
  target_compile_options(fascia_plain_flags INTERFACE -fsanitize=${FASCIA_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(fascia_plain_flags INTERFACE -fsanitize=${FASCIA_SANITIZE})
endif()
find_package(Threads REQUIRED)
target_link_libraries(fascia_plain_flags INTERFACE Threads::Threads)

# Where there is no compiler cache, headers that most files of a library include are read once for all of them.
set(precompile ON)
if(CCACHE)
  set(precompile OFF)
endif()
option(FASCIA_PRECOMPILE "Precompile headers of the library: faster without a compiler cache, in the way of one" ${precompile})

if(FASCIA_PRECOMPILE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 forgets that what it precompiled are system headers, inside which it warns (bugs 105329, 105651).
  target_compile_options(fascia_plain_flags INTERFACE $<$<COMPILE_LANGUAGE:C,CXX>:-Wno-array-bounds;-Wno-stringop-overread>)
endif()

# Compiles the files of a target in batches of up to eight of one folder: the headers of scenes, JSON and VTK take longer
# to read than the files themselves. For the program; in the library, whose files take longer to optimise than to read, one
# that changes is compiled alone. cmake/tidy.sh looks at each file by itself all the same. Each function has a section of
# its own: of a batch a test program keeps what it reaches, and stays the same bit for bit where the rest changes.
function(fascia_compile_in_batches target)
  get_target_property(sources ${target} SOURCES)
  get_target_property(base ${target} SOURCE_DIR)
  set(folders "")
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${base} NORMALIZE)
    if(source MATCHES "^${CMAKE_BINARY_DIR}/")
      continue()
    endif()
    cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${CMAKE_SOURCE_DIR} OUTPUT_VARIABLE folder)
    cmake_path(GET folder PARENT_PATH folder)
    string(MAKE_C_IDENTIFIER ${folder} folder)
    list(APPEND folders ${folder})
    list(APPEND files_of_${folder} ${source})
  endforeach()
  list(REMOVE_DUPLICATES folders)
  foreach(folder IN LISTS folders)
    list(LENGTH files_of_${folder} files)
    math(EXPR batches "(${files} + 7) / 8")
    set(place 0)
    foreach(source IN LISTS files_of_${folder})
      math(EXPR batch "${place} * ${batches} / ${files}")
      set_property(SOURCE ${source} TARGET_DIRECTORY ${target} PROPERTY UNITY_GROUP ${folder}_${batch})
      math(EXPR place "${place} + 1")
    endforeach()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  target_compile_options(${target} PRIVATE -ffunction-sections -fdata-sections)
endfunction()

# Adds a library of the project: fascia_library(NAME sources... LINK targets... [PRECOMPILE headers...]), or
# PRECOMPILED_FOR another one that has the same flags and precompiles what both read.
function(fascia_library name)
  cmake_parse_arguments(ARG "" "PRECOMPILED_FOR" "LINK;PRECOMPILE" ${ARGN})
  add_library(${name} STATIC ${ARG_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PUBLIC fascia_flags ${ARG_LINK})
  if(FASCIA_PRECOMPILE AND ARG_PRECOMPILED_FOR)
    target_precompile_headers(${name} REUSE_FROM ${ARG_PRECOMPILED_FOR})
  elseif(FASCIA_PRECOMPILE AND ARG_PRECOMPILE)
    list(TRANSFORM ARG_PRECOMPILE PREPEND ${CMAKE_SOURCE_DIR}/ REGEX "^[^<]")
    target_precompile_headers(${name} PRIVATE ${ARG_PRECOMPILE})
  endif()
endfunction()
