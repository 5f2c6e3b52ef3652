include(GoogleTest)

set(PELLUCID_MODELS "${PROJECT_SOURCE_DIR}/../shared/models" CACHE PATH
  "Folder of development models (static/, animated/, scenes/); tests that need a missing one are skipped")

# The mathematics of C, where it is a library of its own.
set(PELLUCID_LIBM "")
if(NOT MSVC)
  set(PELLUCID_LIBM m)
endif()

# A shader that one test program has compiled for a CPU driver is not compiled again by the others.
set(PELLUCID_SHADER_CACHE MESA_SHADER_CACHE_DIR=${PROJECT_BINARY_DIR}/shader_cache)

# pellucid_test(<name> SOURCES ... USES ... [SLOW <patterns> | QUICK <patterns>] [SHARDS <n>])
# Adds one GoogleTest program `<name>_test`. ctest labels its tests with the module (the name of their folder) and with
# their cost: `slow` where a pattern of SLOW matches or none of QUICK, else `quick`. Tests of more than about a second are
# slow: `ctest -L quick` stays below a minute.
# SHARDS n: ctest runs the program n times, each with its share of the tests, instead of once for every test. This is for
# programs that take longer to start (a Vulkan driver compiles shaders) than to test; all of their tests are slow.
# Tests find the development models by PELLUCID_MODELS.
function(pellucid_test name)
  cmake_parse_arguments(TEST "" "SHARDS" "SOURCES;USES;SLOW;QUICK" ${ARGN})
  add_executable(${name}_test ${TEST_SOURCES})
  target_link_libraries(${name}_test PRIVATE ${TEST_USES} pellucid_defaults GTest::gtest_main GTest::gmock)
  target_include_directories(${name}_test PRIVATE ${PROJECT_SOURCE_DIR}/tests ${PROJECT_SOURCE_DIR}/src)
  target_compile_definitions(${name}_test PRIVATE PELLUCID_MODELS="${PELLUCID_MODELS}")
  # Half of a build of the tests was GoogleTest's and JSON's headers and the optimisation of code that runs once. The
  # headers are compiled once, for the first program.
  pellucid_optimize(${name}_test -O1 -O0)
  get_property(compiled_headers GLOBAL PROPERTY PELLUCID_TEST_HEADERS)
  if(compiled_headers)
    target_precompile_headers(${name}_test REUSE_FROM ${compiled_headers})
  else()
    target_precompile_headers(${name}_test PRIVATE <gmock/gmock.h> <gtest/gtest.h>
      $<$<NOT:$<BOOL:${PELLUCID_CORE_ONLY}>>:<nlohmann/json.hpp$<ANGLE-R>>)
    set_property(GLOBAL PROPERTY PELLUCID_TEST_HEADERS ${name}_test)
  endif()

  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME module)
  if(NOT TEST_SHARDS)
    list(JOIN TEST_SLOW ":" slow)
    list(JOIN TEST_QUICK ":" quick)
    if(quick)
      pellucid_discover_tests(${name} ${module} quick "${quick}")
      pellucid_discover_tests(${name} ${module} slow "*-${quick}")
    elseif(slow)
      pellucid_discover_tests(${name} ${module} quick "*-${slow}")
      pellucid_discover_tests(${name} ${module} slow "${slow}")
    else()
      pellucid_discover_tests(${name} ${module} quick "*")
    endif()
    return()
  endif()
  # Each shard runs its tests in an order of its own: neighbours use the same shaders, and shards in step would compile
  # all of them twice.
  math(EXPR last "${TEST_SHARDS} - 1")
  foreach(shard RANGE ${last})
    add_test(NAME ${name}_test.${shard} COMMAND ${name}_test)
    set_tests_properties(${name}_test.${shard} PROPERTIES TIMEOUT 900 LABELS "${module};slow"
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${TEST_SHARDS};GTEST_SHARD_INDEX=${shard};GTEST_SHUFFLE=${shard};GTEST_RANDOM_SEED=${shard};${PELLUCID_SHADER_CACHE}")
  endforeach()
endfunction()

# Makes a ctest test of each GoogleTest test of program `<name>_test` that `filter` selects, with two labels.
function(pellucid_discover_tests name module cost filter)
  set(tests ${name}_${cost}_tests)
  gtest_discover_tests(${name}_test NO_PRETTY_VALUES DISCOVERY_TIMEOUT 60 TEST_FILTER "${filter}" TEST_LIST ${tests}
    PROPERTIES TIMEOUT 600 ENVIRONMENT "${PELLUCID_SHADER_CACHE}")
  # gtest_discover_tests() itself takes one label at the most.
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/${tests}_labels.cmake
    "foreach(test IN LISTS ${tests})\n"
    "  set_tests_properties(\"\${test}\" PROPERTIES LABELS \"${module};${cost}\")\n"
    "endforeach()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${CMAKE_CURRENT_BINARY_DIR}/${tests}_labels.cmake)
endfunction()

# pellucid_other_test(<name> COMMAND ...): a quick test that is no GoogleTest program.
function(pellucid_other_test name)
  add_test(NAME ${name} ${ARGN})
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME module)
  set_tests_properties(${name} PROPERTIES LABELS "${module};quick")
endfunction()
