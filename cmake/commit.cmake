# Writes OUTPUT, the commit of SOURCE as a function, unless it holds it already: cmake -DSOURCE=.. -DOUTPUT=.. -P commit.cmake
set(failed TRUE)
if(EXISTS ${SOURCE}/.git)  # not that of a folder around it
  execute_process(COMMAND git -C ${SOURCE} describe --always --abbrev=12 --dirty=-changed --match=
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed ERROR_QUIET)
endif()
if(failed)
  set(commit "")
endif()
file(WRITE ${OUTPUT}.new "#include \"app/version.hpp\"\n\nconst char* fascia::app::commit() { return \"${commit}\"; }\n")
file(COPY_FILE ${OUTPUT}.new ${OUTPUT} ONLY_IF_DIFFERENT)
