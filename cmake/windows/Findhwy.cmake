# Highway's headers alone. Without its library there is no choice of instructions at run time: the baseline is compiled in.
add_library(hwy::hwy INTERFACE IMPORTED)
target_include_directories(hwy::hwy INTERFACE ${PELLUCID_WINDOWS_ROOT}/include)
target_compile_definitions(hwy::hwy INTERFACE HWY_COMPILE_ONLY_STATIC)
set(hwy_FOUND TRUE)
