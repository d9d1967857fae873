# enamel_module(NAME n LAYER l SOURCES … [DEPS …] [LIBS …] [PRIVATE_LIBS …])
#   Library enamel_<n> with alias enamel::<n>. DEPS are enamel modules and may not lie on a higher layer (configure fails).
#   LIBS are third-party targets in the public interface, PRIVATE_LIBS those hidden in .cpp files.
# enamel_program(NAME target SOURCES … [DEPS …] [LIBS …])   a program: layer 5, may use everything.
# enamel_vector_loops(SOURCE …)   sources whose loops over pixels must vectorise.
# enamel_test(NAME n SOURCES … [DEPS …] [LIBS …] [LABELS …] [TIMEOUT s] [ARGS …])   a GoogleTest executable under ctest.

# enamel_assert_layer(<module> <layer> <dep> <dep layer>): the rule itself, apart so that its own test can call it.
function(enamel_assert_layer module layer dep dep_layer)
  if(dep_layer GREATER layer)
    message(FATAL_ERROR "enamel::${module} (layer ${layer}) may not depend on enamel::${dep} (layer ${dep_layer}): "
                        "dependencies go down. Move the shared part into a lower layer or invert it with an interface.")
  endif()
endfunction()

function(enamel_link_deps target layer)
  foreach(dep IN LISTS ARGN)
    if(NOT TARGET enamel_${dep})
      message(FATAL_ERROR "${target}: unknown module '${dep}' (declared later, misspelt, or switched off by an option)")
    endif()
    get_target_property(dep_layer enamel_${dep} ENAMEL_LAYER)
    enamel_assert_layer(${target} ${layer} ${dep} ${dep_layer})
    get_target_property(kind enamel_${target} TYPE)
    if(kind STREQUAL INTERFACE_LIBRARY)
      target_link_libraries(enamel_${target} INTERFACE enamel_${dep})
    else()
      target_link_libraries(enamel_${target} PUBLIC enamel_${dep})
    endif()
  endforeach()
endfunction()

# enamel_unity(<target>): compiles the target's sources in few batches, each header once a batch instead of once a file.
# A file that Highway includes again for each instruction set stays alone; so does, by CMake's rule, one with options of its own.
function(enamel_unity target)
  if(NOT ENAMEL_UNITY)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  set(batched 0)
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    set(text "")
    if(EXISTS ${source})
      file(STRINGS ${source} text REGEX "hwy/foreach_target\\.h" LIMIT_COUNT 1)
    endif()
    if(text)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    else()
      math(EXPR batched "${batched} + 1")
    endif()
  endforeach()
  # Batches of one size: 14 files are 7 and 7, not 12 and 2.
  math(EXPR batches "(${batched} + ${ENAMEL_UNITY_BATCH} - 1) / ${ENAMEL_UNITY_BATCH}")
  if(batches EQUAL 0)
    return()
  endif()
  math(EXPR size "(${batched} + ${batches} - 1) / ${batches}")
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${size})
endfunction()

function(enamel_module)
  cmake_parse_arguments(M "" "NAME;LAYER" "SOURCES;DEPS;LIBS;PRIVATE_LIBS" ${ARGN})
  if(NOT M_NAME OR NOT DEFINED M_LAYER)
    message(FATAL_ERROR "enamel_module needs NAME and LAYER")
  endif()
  if(M_SOURCES)
    add_library(enamel_${M_NAME} STATIC ${M_SOURCES})
    # Third-party headers are SYSTEM: their warnings are not ours to mend.
    target_link_libraries(enamel_${M_NAME} PUBLIC enamel_policy ${M_LIBS} PRIVATE ${M_PRIVATE_LIBS})
    enamel_unity(enamel_${M_NAME})
  else()
    add_library(enamel_${M_NAME} INTERFACE)
    target_link_libraries(enamel_${M_NAME} INTERFACE enamel_policy ${M_LIBS})
  endif()
  set_target_properties(enamel_${M_NAME} PROPERTIES ENAMEL_LAYER ${M_LAYER})
  add_library(enamel::${M_NAME} ALIAS enamel_${M_NAME})
  enamel_link_deps(${M_NAME} ${M_LAYER} ${M_DEPS})
endfunction()

function(enamel_program)
  cmake_parse_arguments(P "" "NAME" "SOURCES;DEPS;LIBS" ${ARGN})
  add_executable(${P_NAME} ${P_SOURCES})
  enamel_unity(${P_NAME})
  list(TRANSFORM P_DEPS PREPEND enamel::)
  target_link_libraries(${P_NAME} PRIVATE enamel_policy ${P_DEPS} ${P_LIBS})
  # Thin adapters over modules, with large headers: optimising them makes a first build longer and no run shorter.
  target_compile_options(${P_NAME} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# enamel_test_groups(<target> <label>…): the target tests_<label> builds every program that the tests of a label need.
function(enamel_test_groups target)
  foreach(label IN LISTS ARGN)
    if(NOT TARGET tests_${label})
      add_custom_target(tests_${label})
    endif()
    add_dependencies(tests_${label} ${target})
  endforeach()
endfunction()

function(enamel_test)
  cmake_parse_arguments(T "" "NAME;TIMEOUT" "SOURCES;DEPS;LIBS;LABELS;ARGS" ${ARGN})
  add_executable(test_${T_NAME} ${T_SOURCES})
  enamel_unity(test_${T_NAME})
  list(TRANSFORM T_DEPS PREPEND enamel::)
  target_link_libraries(test_${T_NAME} PRIVATE enamel_policy ${T_DEPS} ${T_LIBS} GTest::gmock GTest::gtest_main)
  target_compile_definitions(test_${T_NAME} PRIVATE ENAMEL_SOURCE_DIR="${CMAKE_SOURCE_DIR}" ENAMEL_BIN_DIR="${CMAKE_BINARY_DIR}/bin")
  add_test(NAME ${T_NAME} COMMAND test_${T_NAME} ${T_ARGS})
  if(NOT T_TIMEOUT)
    set(T_TIMEOUT 120)
  endif()
  if(ENAMEL_SANITIZE)
    math(EXPR T_TIMEOUT "${T_TIMEOUT} * 10")
  endif()
  # The folder is a label as well, so that `ctest -L flow` runs what lies in tests/unit/flow.
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME folder)
  set_tests_properties(${T_NAME} PROPERTIES LABELS "${T_LABELS};${folder}" TIMEOUT ${T_TIMEOUT})
  enamel_test_groups(test_${T_NAME} ${T_LABELS} ${folder})
  # Mesa keeps its own memory when it is unloaded; such leaks have no name left by which they could be told from ours.
  if("gui" IN_LIST T_LABELS AND ENAMEL_SANITIZE MATCHES "address")
    set_tests_properties(${T_NAME} PROPERTIES ENVIRONMENT "ASAN_OPTIONS=detect_leaks=0")
  endif()
endfunction()

# enamel_vector_loops(SOURCE …): lets loops with comparisons and square roots vectorise; neither flag changes a result.
# Per source, because a target's own options come before the policy's -fno-fast-math, which would reset them.
function(enamel_vector_loops)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "-fno-math-errno;-fno-trapping-math")
endfunction()
