# Compiling takes its time for headers and templates, not for our own lines: a file that sees Eigen and fmt takes three seconds
# for them and one for itself. So what most files include is compiled once, and files are compiled several at a time.

# cowgpu_compile_together(TARGET FOLDER...): the sources in those folders of a target, in the order of their names, a few at a
# time. Names in their anonymous namespaces and `using namespace` meet there, so they are unique in a folder. A file that
# defines a macro (Highway's kernels do) is compiled alone.
function(cowgpu_compile_together target)
  if(NOT COWGPU_TOGETHER)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  list(SORT sources)
  foreach(source ${sources})
    get_filename_component(folder ${source} DIRECTORY)
    file(STRINGS ${source} macros REGEX "^#define")
    if(folder IN_LIST ARGN AND NOT macros)
      list(APPEND in_${folder} ${source})
    endif()
  endforeach()
  foreach(folder ${ARGN})
    list(LENGTH in_${folder} count)
    math(EXPR groups "(${count} + 6) / 7")
    set(index 0)
    foreach(source ${in_${folder}})
      math(EXPR group "${index} * ${groups} / ${count}")
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder}_${group})
      math(EXPR index "${index} + 1")
    endforeach()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

# cowgpu_precompile(TARGET HEADER) or cowgpu_precompile(TARGET REUSE_FROM OTHER), where both are compiled with the same options.
function(cowgpu_precompile target)
  if(ARGV1 STREQUAL "REUSE_FROM")
    target_precompile_headers(${target} ${ARGN})
  else()
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
  # Of precompiled headers GCC 12 forgets that they are the system's, and warns about std::string and Eigen in them.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-array-bounds
                                           -Wno-stringop-overflow -Wno-stringop-overread>)
endfunction()
