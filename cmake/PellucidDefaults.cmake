# Settings that all targets share.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 99)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

if(PROJECT_IS_TOP_LEVEL)
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
  set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
  set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
  endif()
endif()

# Without these two freedoms ccache keeps nothing that has a precompiled header. A launcher of the user's own stays.
if(PELLUCID_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(PELLUCID_CCACHE_PROGRAM ccache)
  mark_as_advanced(PELLUCID_CCACHE_PROGRAM)
  if(PELLUCID_CCACHE_PROGRAM)
    set(through_ccache ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${PELLUCID_CCACHE_PROGRAM})
    set(CMAKE_C_COMPILER_LAUNCHER ${through_ccache})
    set(CMAKE_CXX_COMPILER_LAUNCHER ${through_ccache})
  endif()
endif()

# Warnings and the floating-point contract of pellucid's own targets.
set(gnu_like $<CXX_COMPILER_ID:GNU,Clang,AppleClang>)
set(is_cxx $<COMPILE_LANGUAGE:CXX>)
set(is_gcc_12 $<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>)
set(warn $<BOOL:${PELLUCID_WARNINGS}>)
add_library(pellucid_defaults INTERFACE)
target_compile_options(pellucid_defaults INTERFACE
  "$<$<AND:${warn},${gnu_like}>:-Wall;-Wextra;-Wshadow;-Wpedantic>"
  "$<$<AND:${warn},${gnu_like},${is_cxx}>:-Wconversion;-Wsign-conversion;-Wnon-virtual-dtor;-Wold-style-cast>"
  # GCC 12 sees strings and arrays overflow that do not. Which ones depends on inlining, and even on the length of the
  # path of the checkout, so that a list of places would never end. The sanitizers watch over real ones.
  "$<$<AND:${warn},${is_gcc_12}>:-Wno-array-bounds;-Wno-restrict;-Wno-stringop-overflow;-Wno-stringop-overread;-Wno-free-nonheap-object>"
  # No fused multiply-add that the source does not ask for: the same bytes on every machine.
  $<${gnu_like}:-ffp-contract=off>
  $<$<CXX_COMPILER_ID:MSVC>:/fp:precise>
  # So that ccache sees through precompiled headers.
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess>)
target_compile_definitions(pellucid_defaults INTERFACE
  $<$<NOT:$<BOOL:${PELLUCID_TBB}>>:PELLUCID_SERIAL>)

# pellucid_optimize(<target> <level for Release> <level for RelWithDebInfo>): another level of optimisation than the build
# type's, for code that is not hot and takes long to compile.
function(pellucid_optimize target release debuggable)
  target_compile_options(${target} PRIVATE
    $<$<AND:${gnu_like},$<CONFIG:Release>>:${release}>
    $<$<AND:${gnu_like},$<CONFIG:RelWithDebInfo>>:${debuggable}>)
endfunction()
