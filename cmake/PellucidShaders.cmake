# Compiles the shaders below shaders/ to SPIR-V at build time and embeds them in the module `render`. Every .vert, .frag
# and .comp file there is found by itself and is known to the program by its path below shaders/.

# pellucid_shader_forms(<source> <form>...): a shader that is compiled in several forms. A form is SUFFIX:DEFINITION,...
# and is known as <source> with _SUFFIX before its extension; `plain` is the file as it is.
set(PELLUCID_SHADER_FORMS "")
macro(pellucid_shader_forms source)
  list(APPEND PELLUCID_SHADER_FORMS ${source})
  set(PELLUCID_SHADER_FORMS_${source} ${ARGN})
endmacro()

# One form for each number of attachments, 16 bytes of a pixel each.
macro(pellucid_shader_forms_by_attachments source least most)
  set(forms "")
  foreach(attachments RANGE ${least} ${most})
    list(APPEND forms ${attachments}:ATTACHMENTS=${attachments})
  endforeach()
  pellucid_shader_forms(${source} ${forms})
endmacro()

pellucid_shader_forms(scene/scene.vert plain layered:LAYERED)
pellucid_shader_forms(capture/count.frag plain marked:MARKED)

# Peeling: what a round finds in a layer, from the front or from both ends (2), with the depth test or without (SEARCH).
pellucid_shader_forms(capture/peeling/box_left.frag image: 1:SEARCH,SIDES=1 2:SEARCH,SIDES=2)
pellucid_shader_forms(capture/peeling/peel_depth.frag plain resumes:RESUMES)
pellucid_shader_forms(capture/peeling/peel_equal.frag pairs:PAIRS lists:LISTS arrays:ARRAYS chains:CHAINS)
pellucid_shader_forms(capture/peeling/peel_ends.frag pairs_1:PAIRS,SEARCH,SIDES=1 pairs_2:PAIRS,SEARCH,SIDES=2
  lists_2:LISTS,SEARCH,SIDES=2 arrays_2:ARRAYS,SEARCH,SIDES=2 chains_2:CHAINS,SEARCH,SIDES=2)
pellucid_shader_forms(capture/peeling/fold_layers.comp image:IMAGE pairs:PAIRS lists:LISTS arrays:ARRAYS chains:CHAINS
  pairs_1:PAIRS,SEARCH,SIDES=1 pairs_2:PAIRS,SEARCH,SIDES=2 lists_2:LISTS,SEARCH,SIDES=2 arrays_2:ARRAYS,SEARCH,SIDES=2
  chains_2:CHAINS,SEARCH,SIDES=2)
pellucid_shader_forms(capture/peeling/finish_layers.comp 1:SIDES=1 2:SIDES=2)

pellucid_shader_forms(capture/buffers/fill_ranges.frag plain marked:MARKED)
pellucid_shader_forms(capture/buffers/pairs.frag keys:KEYS colors:COLORS)
pellucid_shader_forms(capture/buffers/shares.frag keys:KEYS colors:COLORS)

pellucid_shader_forms(capture/k_buffers/nearest.frag keys:KEYS colors:COLORS)
pellucid_shader_forms(capture/k_buffers/halves.frag depths:DEPTHS ids:IDS)
pellucid_shader_forms(capture/k_buffers/max_first.frag plain interlock:INTERLOCK)
pellucid_shader_forms(capture/k_buffers/place_colors.frag plain halves:HALVES)
pellucid_shader_forms(capture/k_buffers/fold_places.comp plain layers:LAYERS measure:MEASURE)
pellucid_shader_forms_by_attachments(capture/k_buffers/ordered_core.frag 1 8)
pellucid_shader_forms_by_attachments(capture/k_buffers/ordered_slots.frag 1 8)

pellucid_shader_forms(capture/blending/finish_blended.comp plain marks:MARKS)
pellucid_shader_forms(capture/blending/moments.frag sums:SUMS colors:COLORS)
pellucid_shader_forms(capture/blending/stochastic.frag depths:DEPTHS colors:COLORS)
pellucid_shader_forms_by_attachments(capture/blending/ordered_window.frag 3 8)

# Sorting: classes of lists by their length (resolve/tiles.glsl), for every way of storing them.
pellucid_shader_forms(resolve/keys.comp plain words:WORDS layers:LAYERS)
set(list_forms "")
foreach(storage ranges lists arrays layers)
  string(TOUPPER ${storage} define)
  foreach(room 4 8 16)
    list(APPEND list_forms ${storage}_${room}:${define},ROOM=${room},RUNS=1)
  endforeach()
  list(APPEND list_forms ${storage}_runs:${define},ROOM=16,RUNS=8 ${storage}_long:${define},ROOM=32,LONG
    ${storage}_plain:${define},ROOM=128,PLAIN)
endforeach()
pellucid_shader_forms(resolve/lists.comp ${list_forms})
pellucid_shader_forms(resolve/classify.comp ranges:RANGES lists:LISTS arrays:ARRAYS layers:LAYERS)

# pellucid_shaders(<target>): compiles all of them, and generates the source with the table that shader_code() reads.
function(pellucid_shaders target)
  set(root ${PROJECT_SOURCE_DIR}/shaders)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/shaders)
  file(MAKE_DIRECTORY ${folder})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS RELATIVE ${root}
    ${root}/*.vert ${root}/*.frag ${root}/*.comp)
  list(SORT sources)
  set(arrays "")
  set(table "")
  set(names "")
  set(outputs "")
  foreach(source ${sources})
    set(forms plain)
    if(source IN_LIST PELLUCID_SHADER_FORMS)
      set(forms ${PELLUCID_SHADER_FORMS_${source}})
    endif()
    foreach(form ${forms})
      set(name ${source})
      set(definitions "")
      if(form MATCHES "^([^:]+):(.*)$")
        string(REPLACE "," ";" definitions "${CMAKE_MATCH_2}")
        string(REGEX REPLACE "\\.([a-z]+)$" "_${CMAKE_MATCH_1}.\\1" name ${source})
      endif()
      list(TRANSFORM definitions PREPEND "-D")
      string(MAKE_C_IDENTIFIER ${name} identifier)
      set(output ${folder}/${identifier}.inc)
      # SPIR-V of Vulkan 1.2: what Mesa 22 reads without trouble.
      add_custom_command(OUTPUT ${output}
        COMMAND ${Vulkan_GLSLC_EXECUTABLE} --target-env=vulkan1.2 -O -mfmt=c -I${root} -MD -MF ${output}.d ${definitions}
                -o ${output} ${root}/${source}
        DEPENDS ${root}/${source}
        DEPFILE ${output}.d
        COMMENT "Shader ${name}"
        VERBATIM)
      list(APPEND outputs ${output})
      string(APPEND arrays "constexpr std::uint32_t ${identifier}[] =\n#include \"${identifier}.inc\"\n;\n")
      string(APPEND table "    {\"${name}\", ${identifier}},\n")
      string(APPEND names "    \"${name}\",\n")
    endforeach()
  endforeach()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/shader_table.cpp.in ${folder}/shader_table.cpp @ONLY)
  set_source_files_properties(${folder}/shader_table.cpp PROPERTIES OBJECT_DEPENDS "${outputs}" SKIP_UNITY_BUILD_INCLUSION ON
    COMPILE_OPTIONS "$<${gnu_like}:-O0;-fno-sanitize=all>")
  target_sources(${target} PRIVATE ${folder}/shader_table.cpp)
  target_include_directories(${target} PRIVATE ${folder})
endfunction()
