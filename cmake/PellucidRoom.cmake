# For scripts/sanitize --short: rooms that are linked but not tested there, built in a hurry and without sanitizers.
# Where PELLUCID_PLAIN_ARCHIVES names a folder, their libraries are taken from there and not built at all.
set(PELLUCID_PLAIN_ROOMS "" CACHE STRING "Rooms built without sanitizers and optimisation")
set(PELLUCID_PLAIN_ARCHIVES "" CACHE PATH "Libraries of another build that stand for the plain rooms")

# pellucid_room(<name> SOURCES ... USES <rooms or targets> PRIVATE_USES ...)
# One static library `pellucid_<name>`, alias `pellucid::<name>`, for the room src/<name>.
function(pellucid_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;USES;PRIVATE_USES" ${ARGN})
  if(PELLUCID_PLAIN_ARCHIVES AND name IN_LIST PELLUCID_PLAIN_ROOMS)
    add_library(pellucid_${name} STATIC IMPORTED GLOBAL)
    set_target_properties(pellucid_${name} PROPERTIES
      IMPORTED_LOCATION ${PELLUCID_PLAIN_ARCHIVES}/libpellucid_${name}.a)
    add_library(pellucid::${name} ALIAS pellucid_${name})
    target_include_directories(pellucid_${name} INTERFACE ${PROJECT_SOURCE_DIR}/include)
    target_link_libraries(pellucid_${name} INTERFACE ${ROOM_USES} ${ROOM_PRIVATE_USES})
    return()
  endif()
  add_library(pellucid_${name} STATIC ${ROOM_SOURCES})
  add_library(pellucid::${name} ALIAS pellucid_${name})
  set_target_properties(pellucid_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(pellucid_${name} PUBLIC cxx_std_20)
  target_include_directories(pellucid_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>
    PRIVATE ${CMAKE_CURRENT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(pellucid_${name}
    PUBLIC ${ROOM_USES}
    PRIVATE $<BUILD_INTERFACE:pellucid_defaults> ${ROOM_PRIVATE_USES})
  if(name IN_LIST PELLUCID_PLAIN_ROOMS)
    target_compile_options(pellucid_${name} PRIVATE -O0 -fno-sanitize=all)
  endif()
  set_property(GLOBAL APPEND PROPERTY PELLUCID_ROOMS pellucid_${name})
endfunction()

# pellucid_test(<name> SOURCES ... USES ...): one GoogleTest program `<name>_test`.
# A quarter of a build was GoogleTest and JSON headers and another the optimisation of code that runs once: the headers are
# compiled once, for the first program, and the tests' own code has -O1, under sanitizers -O0.
# Its tests may read files through PELLUCID_TEST_DATA (tests/data) and PELLUCID_MODELS
# (the optional folder of dev models; a test that needs it skips, and says so, where it is missing).
# SHARDS n: ctest runs the program n times, each with its share of the tests, instead of once for every test: for
# programs that take longer to start (a Vulkan driver compiles) than to test.
function(pellucid_test name)
  cmake_parse_arguments(TEST "" "SHARDS" "SOURCES;USES" ${ARGN})
  add_executable(${name}_test ${TEST_SOURCES})
  target_link_libraries(${name}_test PRIVATE ${TEST_USES} pellucid_defaults GTest::gtest_main GTest::gmock)
  target_include_directories(${name}_test PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(${name}_test PRIVATE
    PELLUCID_TEST_DATA="${PROJECT_SOURCE_DIR}/tests/data"
    PELLUCID_MODELS="${PELLUCID_MODELS}")
  # GCC 12 sees strings overflow that do not, depending on the length of the path in the macros above.
  target_compile_options(${name}_test PRIVATE $<$<CONFIG:Release>:-O1> $<$<CONFIG:RelWithDebInfo>:-O0>
    $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread>)
  get_property(compiled_headers GLOBAL PROPERTY PELLUCID_TEST_HEADERS)
  if(compiled_headers)
    target_precompile_headers(${name}_test REUSE_FROM ${compiled_headers})
  else()
    target_precompile_headers(${name}_test PRIVATE <gmock/gmock.h> <gtest/gtest.h> <nlohmann/json.hpp>)
    set_property(GLOBAL PROPERTY PELLUCID_TEST_HEADERS ${name}_test)
  endif()
  # What one program has compiled for a CPU driver no other has to.
  set(shader_cache MESA_SHADER_CACHE_DIR=${CMAKE_BINARY_DIR}/shader_cache)
  if(NOT TEST_SHARDS)
    gtest_discover_tests(${name}_test PROPERTIES TIMEOUT 600 ENVIRONMENT "${shader_cache}" DISCOVERY_TIMEOUT 60)
    return()
  endif()
  # Each in a sequence of its own: neighbours use the same shaders, and programs in step would compile all of them twice.
  math(EXPR last "${TEST_SHARDS} - 1")
  foreach(shard RANGE ${last})
    add_test(NAME ${name}_test.${shard} COMMAND ${name}_test)
    set_tests_properties(${name}_test.${shard} PROPERTIES TIMEOUT 900
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${TEST_SHARDS};GTEST_SHARD_INDEX=${shard};GTEST_SHUFFLE=${shard};GTEST_RANDOM_SEED=${shard};${shader_cache}")
  endforeach()
endfunction()

set(PELLUCID_MODELS "${PROJECT_SOURCE_DIR}/../shared/models" CACHE PATH
  "Folder of optional dev models (static/, animated/, scenes/)")
