# Shaders become SPIR-V at build time and are embedded: name in the program, source below shaders/, definitions.
# A shader that is compiled in several forms is listed once for each.
set(PELLUCID_SHADERS
  "interface/scene.vert|interface/scene.vert|"
  "interface/layered.vert|interface/layered.vert|"
  "budget/survey.frag|budget/survey.frag|"
  "budget/importance.comp|budget/importance.comp|"
  "budget/level.comp|budget/level.comp|"
  "budget/sum_groups.comp|budget/sum_groups.comp|"
  "budget/scan_groups.comp|budget/scan_groups.comp|"
  "budget/places.comp|budget/places.comp|"
  "budget/keys.frag|budget/keys.frag|"
  "budget/depths.frag|budget/depths.frag|"
  "budget/ids.frag|budget/ids.frag|"
  "budget/max_first.frag|budget/max_first.frag|"
  "budget/max_first_interlock.frag|budget/max_first.frag|INTERLOCK"
  "budget/sort_slots.comp|budget/sort_slots.comp|"
  "budget/colors.frag|budget/colors.frag|"
  "budget/colors_halves.frag|budget/colors.frag|HALVES"
  "budget/resolve.comp|budget/resolve.comp|"
  "budget/resolve_layers.comp|budget/resolve.comp|LAYERS"
  "budget/resolve_measure.comp|budget/resolve.comp|MEASURE"
  "budget/blocks.frag|budget/blocks.frag|"
  "budget/blocks.comp|budget/blocks.comp|"
  "capture/blend.frag|capture/blend.frag|"
  "capture/weighted.frag|capture/weighted.frag|"
  "capture/moments.frag|capture/moments.frag|"
  "capture/moment_colors.frag|capture/moment_colors.frag|"
  "capture/sample_depths.frag|capture/sample_depths.frag|"
  "capture/sample_colors.frag|capture/sample_colors.frag|"
  "resolve/sums.comp|resolve/sums.comp|"
  "capture/layer_nodes.frag|capture/layer_nodes.frag|ATTACHMENTS=3"
  "resolve/layer_nodes.comp|resolve/layer_nodes.comp|"
  "resolve/ordered_window.comp|resolve/ordered_window.comp|"
  "resolve/blended.comp|resolve/blended.comp|"
  "resolve/blended_marks.comp|resolve/blended.comp|MARKS"
  "capture/reserve_marked.comp|capture/reserve_marked.comp|"
  "capture/touching_triangles.comp|capture/touching_triangles.comp|"
  "capture/box_image.frag|capture/box_left.frag|"
  "capture/box_1.frag|capture/box_left.frag|SEARCH SIDES=1"
  "capture/box_2.frag|capture/box_left.frag|SEARCH SIDES=2"
  "capture/bounds.frag|capture/bounds.frag|"
  "capture/clear_keys.comp|capture/clear_keys.comp|"
  "capture/depth_bins.frag|capture/depth_bins.frag|"
  "capture/divide_bins.comp|capture/divide_bins.comp|"
  "capture/nearest_colors.frag|capture/nearest_colors.frag|"
  "capture/nearest_keys.frag|capture/nearest_keys.frag|"
  "capture/pair_colors.frag|capture/pair_colors.frag|"
  "capture/pair_keys.frag|capture/pair_keys.frag|"
  "capture/route_layers.frag|capture/route_layers.frag|"
  "capture/shaded.frag|capture/shaded.frag|"
  "capture/share_colors.frag|capture/share_colors.frag|"
  "capture/share_keys.frag|capture/share_keys.frag|"
  "resolve/shares.comp|resolve/shares.comp|"
  "capture/interlock_slots.frag|capture/interlock_slots.frag|"
  "resolve/keys.comp|resolve/keys.comp|"
  "resolve/slots_buffer.comp|resolve/keys.comp|WORDS"
  "resolve/slots_layers.comp|resolve/keys.comp|LAYERS"
  "capture/clear_bounds.comp|capture/clear_bounds.comp|"
  "capture/count.frag|capture/count.frag|"
  "capture/count_marked.frag|capture/count.frag|MARKED"
  "capture/fill_arrays.frag|capture/fill_arrays.frag|"
  "capture/fill_lists.frag|capture/fill_lists.frag|"
  "capture/fill_ranges.frag|capture/fill_ranges.frag|"
  "capture/fill_marked.frag|capture/fill_ranges.frag|MARKED"
  "capture/opaque.frag|capture/opaque.frag|"
  "capture/offsets.comp|capture/offsets.comp|"
  "capture/peel_depth.frag|capture/peel_depth.frag|"
  "capture/peel_depth_resumes.frag|capture/peel_depth.frag|RESUMES"
  "capture/peel_image.frag|capture/peel_image.frag|"
  "resolve/clear_tiles.comp|resolve/clear_tiles.comp|"
  "resolve/finish_layers_1.comp|resolve/finish_layers.comp|SIDES=1"
  "resolve/finish_layers_2.comp|resolve/finish_layers.comp|SIDES=2"
  "resolve/layers_image.comp|resolve/layers.comp|IMAGE"
  # Front to back without depth test.
  "capture/peel_pairs_1.frag|capture/peel_ends.frag|PAIRS SEARCH SIDES=1"
  "resolve/layers_pairs_1.comp|resolve/layers.comp|PAIRS SEARCH SIDES=1")
# What a round finds in a layer: with the depth test, and from both ends without it.
foreach(storage pairs lists arrays chains)
  string(TOUPPER ${storage} define)
  list(APPEND PELLUCID_SHADERS
    "capture/peel_${storage}.frag|capture/peel_equal.frag|${define}"
    "resolve/layers_${storage}.comp|resolve/layers.comp|${define}"
    "capture/peel_${storage}_2.frag|capture/peel_ends.frag|${define} SEARCH SIDES=2"
    "resolve/layers_${storage}_2.comp|resolve/layers.comp|${define} SEARCH SIDES=2")
endforeach()
foreach(attachments RANGE 1 8)
  list(APPEND PELLUCID_SHADERS
    "budget/ordered_core_${attachments}.frag|budget/ordered_core.frag|ATTACHMENTS=${attachments}"
    "capture/ordered_slots_${attachments}.frag|capture/ordered_slots.frag|ATTACHMENTS=${attachments}")
endforeach()
foreach(attachments RANGE 3 8)
  list(APPEND PELLUCID_SHADERS
    "capture/ordered_window_${attachments}.frag|capture/ordered_window.frag|ATTACHMENTS=${attachments}")
endforeach()
foreach(storage ranges lists arrays layers)
  string(TOUPPER ${storage} define)
  list(APPEND PELLUCID_SHADERS "resolve/classify_${storage}.comp|resolve/classify.comp|${define}")
  foreach(room 4 8 16)
    list(APPEND PELLUCID_SHADERS "resolve/${storage}_${room}.comp|resolve/lists.comp|${define} ROOM=${room} RUNS=1")
  endforeach()
  list(APPEND PELLUCID_SHADERS "resolve/${storage}_runs.comp|resolve/lists.comp|${define} ROOM=16 RUNS=8")
  list(APPEND PELLUCID_SHADERS "resolve/${storage}_long.comp|resolve/lists.comp|${define} ROOM=32 LONG")
  list(APPEND PELLUCID_SHADERS "resolve/${storage}_plain.comp|resolve/lists.comp|${define} ROOM=128 PLAIN")
endforeach()

# pellucid_shaders(<target>): compile all of them, and one generated source with the table that shader_code() reads.
function(pellucid_shaders target)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/shaders)
  file(MAKE_DIRECTORY ${folder})
  set(arrays "")
  set(table "")
  set(names "")
  set(outputs "")
  foreach(entry ${PELLUCID_SHADERS})
    string(REPLACE "|" ";" parts "${entry}")
    list(GET parts 0 name)
    list(GET parts 1 source)
    list(GET parts 2 definitions)
    separate_arguments(definitions)
    list(TRANSFORM definitions PREPEND "-D")
    string(MAKE_C_IDENTIFIER ${name} identifier)
    set(output ${folder}/${identifier}.inc)
    # SPIR-V of Vulkan 1.2: what Mesa 22 reads without trouble.
    add_custom_command(OUTPUT ${output}
      COMMAND ${Vulkan_GLSLC_EXECUTABLE} --target-env=vulkan1.2 -O -mfmt=c -MD -MF ${output}.d ${definitions}
              -o ${output} ${PROJECT_SOURCE_DIR}/shaders/${source}
      DEPENDS ${PROJECT_SOURCE_DIR}/shaders/${source}
      DEPFILE ${output}.d
      COMMENT "Shader ${name}"
      VERBATIM)
    list(APPEND outputs ${output})
    string(APPEND arrays "constexpr std::uint32_t ${identifier}[] =\n#include \"${identifier}.inc\"\n;\n")
    string(APPEND table "    {\"${name}\", ${identifier}},\n")
    string(APPEND names "    \"${name}\",\n")
  endforeach()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/shader_table.cpp.in ${folder}/shader_table.cpp @ONLY)
  set_source_files_properties(${folder}/shader_table.cpp PROPERTIES OBJECT_DEPENDS "${outputs}" SKIP_UNITY_BUILD_INCLUSION ON
    COMPILE_OPTIONS "$<${gnu_like}:-O0;-fno-sanitize=all>")
  target_sources(${target} PRIVATE ${folder}/shader_table.cpp)
  target_include_directories(${target} PRIVATE ${folder})
endfunction()
