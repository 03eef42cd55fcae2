# The page of `nearpose report`: apps/viewer bundled by npm's esbuild into one script and one style sheet, and those as an
# object file in the program. Where node or npm is missing, or npm reaches no registry, the program is built without.
set(NEARPOSE_REPORT AUTO CACHE STRING "Build `nearpose report`, which needs node and npm: AUTO (where they work), ON or OFF")
set_property(CACHE NEARPOSE_REPORT PROPERTY STRINGS AUTO ON OFF)

set(viewer_source ${CMAKE_CURRENT_SOURCE_DIR}/viewer)
set(viewer_build ${CMAKE_CURRENT_BINARY_DIR}/viewer)
set(viewer_files ${viewer_build}/viewer.js ${viewer_build}/viewer.css ${viewer_build}/viewer.policy)
file(MAKE_DIRECTORY ${viewer_build})
if(NEARPOSE_REPORT)
  find_program(NEARPOSE_NODE NAMES node nodejs)
  find_program(NEARPOSE_NPM npm)
endif()

# What an earlier attempt left empty is tried again after each configure.
foreach(file IN LISTS viewer_files)
  if(EXISTS ${file})
    file(SIZE ${file} size)
    if(size EQUAL 0)
      file(REMOVE ${file})
    endif()
  endif()
endforeach()

if(NEARPOSE_REPORT AND NEARPOSE_NODE AND NEARPOSE_NPM)
  file(GLOB viewer_sources CONFIGURE_DEPENDS ${viewer_source}/src/*.js ${viewer_source}/src/*.css)
  add_custom_command(OUTPUT ${viewer_files}
    COMMAND ${CMAKE_COMMAND} -DNODE=${NEARPOSE_NODE} -DNPM=${NEARPOSE_NPM} -DSOURCE=${viewer_source}
            -DBUILD=${viewer_build} -DREPORT=${NEARPOSE_REPORT} -P ${viewer_source}/bundle.cmake
    DEPENDS ${viewer_sources} ${viewer_source}/package.json ${viewer_source}/package-lock.json
            ${viewer_source}/build.mjs ${viewer_source}/bundle.cmake
    COMMENT "Bundling the viewer" VERBATIM)
else()
  if(NEARPOSE_REPORT STREQUAL "ON")
    message(FATAL_ERROR "NEARPOSE_REPORT is ON, but node or npm is missing (Debian: nodejs, npm)")
  elseif(NEARPOSE_REPORT)
    message(STATUS "the report is left out: node or npm is missing (Debian: nodejs, npm)")
  endif()
  foreach(file IN LISTS viewer_files)
    file(WRITE ${file} "")
  endforeach()
endif()

set(embedded_viewer ${CMAKE_CURRENT_BINARY_DIR}/embedded_viewer.S)
file(GENERATE OUTPUT ${embedded_viewer} CONTENT
"    .section .rodata
    .global nearpose_viewer_script_begin
    .global nearpose_viewer_script_end
    .global nearpose_viewer_style_begin
    .global nearpose_viewer_style_end
    .global nearpose_viewer_policy_begin
    .global nearpose_viewer_policy_end
nearpose_viewer_script_begin:
    .incbin \"${viewer_build}/viewer.js\"
nearpose_viewer_script_end:
    .byte 0
nearpose_viewer_style_begin:
    .incbin \"${viewer_build}/viewer.css\"
nearpose_viewer_style_end:
    .byte 0
nearpose_viewer_policy_begin:
    .incbin \"${viewer_build}/viewer.policy\"
nearpose_viewer_policy_end:
    .byte 0
    .section .note.GNU-stack,\"\",%progbits
")
set_source_files_properties(${embedded_viewer} PROPERTIES OBJECT_DEPENDS "${viewer_files}")
target_sources(nearpose_app_parts PRIVATE ${embedded_viewer})
