# How pages that need no server are declared: sources for the browser, joined to one text that is built
# into a program.

# mortise_page(<name> SOURCE page_source.cpp FOLDER folder MODULES a.mjs ...)
# Joins FOLDER/page.html with FOLDER/page.css and the modules, each after those that it imports. A module
# that FOLDER does not have is of common/pages/modules, for all pages. SOURCE, of the same CMakeLists.txt,
# gets the joined file's path as MORTISE_<NAME>, for MORTISE_EMBED_PAGE (common/pages/embedded_page.h).
function(mortise_page name)
  cmake_parse_arguments(ARG "" "SOURCE;FOLDER" "MODULES" ${ARGN})
  set(folder ${CMAKE_CURRENT_SOURCE_DIR}/${ARG_FOLDER})
  set(joiner ${CMAKE_SOURCE_DIR}/common/pages/join_page.cmake)
  set(joined ${CMAKE_CURRENT_BINARY_DIR}/${name}.html)
  set(modules "")
  foreach(module ${ARG_MODULES})
    if(EXISTS ${folder}/${module})
      list(APPEND modules ${folder}/${module})
    else()
      list(APPEND modules ${CMAKE_SOURCE_DIR}/common/pages/modules/${module})
    endif()
  endforeach()
  list(JOIN modules " " module_list)
  add_custom_command(
    OUTPUT ${joined}
    COMMAND ${CMAKE_COMMAND} -DFOLDER=${folder} -DOUTPUT=${joined} "-DMODULES=${module_list}" -P ${joiner}
    DEPENDS ${joiner} ${folder}/page.css ${folder}/page.html ${modules}
    VERBATIM)
  string(TOUPPER ${name} definition)
  mortise_embed(${ARG_SOURCE} MORTISE_${definition} ${joined})
endfunction()
