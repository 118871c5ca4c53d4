# Every third-party library, as an imported target without its own warnings.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
if(NOT mechanics_alone)
  find_package(VTK 9.1 REQUIRED
    COMPONENTS CommonCore CommonDataModel IOCore IOXML IOLegacy
    OPTIONAL_COMPONENTS FiltersCore FiltersGeometry FiltersSources IOImage RenderingFreeType RenderingOpenGL2)
endif()

find_path(UDUNITS2_INCLUDE udunits2.h REQUIRED)
find_library(UDUNITS2_LIBRARY udunits2 REQUIRED)
add_library(udunits2 INTERFACE)
target_include_directories(udunits2 SYSTEM INTERFACE ${UDUNITS2_INCLUDE})
target_link_libraries(udunits2 INTERFACE ${UDUNITS2_LIBRARY})

find_path(MD_INCLUDE sha256.h REQUIRED)
find_library(MD_LIBRARY md REQUIRED)
add_library(md INTERFACE)
target_include_directories(md SYSTEM INTERFACE ${MD_INCLUDE})
target_link_libraries(md INTERFACE ${MD_LIBRARY})

find_path(DEFLATE_INCLUDE libdeflate.h REQUIRED)
find_library(DEFLATE_LIBRARY deflate REQUIRED)
add_library(deflate INTERFACE)
target_include_directories(deflate SYSTEM INTERFACE ${DEFLATE_INCLUDE})
target_link_libraries(deflate INTERFACE ${DEFLATE_LIBRARY})

find_path(NANOFLANN_INCLUDE nanoflann.hpp REQUIRED)
add_library(nanoflann INTERFACE)
target_include_directories(nanoflann SYSTEM INTERFACE ${NANOFLANN_INCLUDE})

if(DEFINED FASCIA_WITH_CHOLMOD)
  message(WARNING "FASCIA_WITH_CHOLMOD does nothing: fascia factorises by itself; FASCIA_WITH_SUITESPARSE=OFF does without METIS and AMD")
  unset(FASCIA_WITH_CHOLMOD CACHE)
endif()
if(FASCIA_WITH_SUITESPARSE)
  find_path(AMD_INCLUDE amd.h PATH_SUFFIXES suitesparse REQUIRED)
  find_library(AMD_LIBRARY amd REQUIRED)
  find_path(METIS_INCLUDE metis.h REQUIRED)
  find_library(METIS_LIBRARY metis REQUIRED)
  add_library(elimination INTERFACE)
  target_include_directories(elimination SYSTEM INTERFACE ${AMD_INCLUDE} ${METIS_INCLUDE})
  target_link_libraries(elimination INTERFACE ${AMD_LIBRARY} ${METIS_LIBRARY})
endif()

# Said by --version.
set(FASCIA_DIRECT_SOLVER "supernodal Cholesky, ordered by METIS and AMD of SuiteSparse")
if(NOT FASCIA_WITH_SUITESPARSE)
  set(FASCIA_DIRECT_SOLVER "supernodal Cholesky, ordered by Eigen's AMD")
endif()
