# fascia_interface_tag(TARGET FILE NAME folders...): writes FILE below build/generated, which defines NAME: a digest of the
# headers in these folders, which a module shares with the library. It tells a module of another build.
function(fascia_interface_tag target file name)
  list(TRANSFORM ARGN REPLACE "(.+)" "${CMAKE_SOURCE_DIR}/\\1/*.hpp" OUTPUT_VARIABLE globs)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${globs})
  set(stamp ${CMAKE_BINARY_DIR}/generated/${target}.stamp)
  set(output ${CMAKE_BINARY_DIR}/generated/${file})
  add_custom_command(OUTPUT ${stamp} BYPRODUCTS ${output}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} -DNAME=${name} "-DGLOBS=${globs}" -P ${CMAKE_SOURCE_DIR}/cmake/write_tag.cmake
    COMMAND ${CMAKE_COMMAND} -E touch ${stamp}
    DEPENDS ${headers} ${CMAKE_SOURCE_DIR}/cmake/write_tag.cmake VERBATIM)
  add_custom_target(${target} DEPENDS ${stamp})
endfunction()
