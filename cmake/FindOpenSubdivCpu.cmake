# The part of OpenSubdiv without graphics cards, as target OpenSubdiv::osdCPU. Debian 12's own OpenSubdivConfig.cmake
# refuses to be found: it names static libraries that the package does not hold.
find_path(OpenSubdivCpu_INCLUDE_DIR opensubdiv/far/topologyRefiner.h)
find_library(OpenSubdivCpu_LIBRARY osdCPU)
mark_as_advanced(OpenSubdivCpu_INCLUDE_DIR OpenSubdivCpu_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenSubdivCpu REQUIRED_VARS OpenSubdivCpu_LIBRARY OpenSubdivCpu_INCLUDE_DIR)

if(OpenSubdivCpu_FOUND AND NOT TARGET OpenSubdiv::osdCPU)
  add_library(OpenSubdiv::osdCPU UNKNOWN IMPORTED)
  set_target_properties(OpenSubdiv::osdCPU PROPERTIES
    IMPORTED_LOCATION ${OpenSubdivCpu_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${OpenSubdivCpu_INCLUDE_DIR})
endif()
