# Compiler policy shared by every target through enamel_module / enamel_program / enamel_test.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

find_package(Threads REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(tl-expected REQUIRED)
find_package(PkgConfig REQUIRED)
if(NOT ENAMEL_PROBE_ONLY)
  find_package(Eigen3 REQUIRED)
  find_package(OpenCV REQUIRED COMPONENTS core imgproc imgcodecs features2d calib3d flann)
  find_package(hwy REQUIRED)
endif()

set(ENAMEL_SANITIZE "" CACHE STRING "value of -fsanitize=, empty for none")

# Same bits from g++ and clang, at any optimisation level: no fused multiply-add, no reassociation. Not in enamel_policy,
# whose options come after a module's own and would reset those of enamel_vector_loops.
add_compile_options(-ffp-contract=off -fno-fast-math)

add_library(enamel_policy INTERFACE)
target_include_directories(enamel_policy INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(enamel_policy INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast -Wnon-virtual-dtor -Werror)
# g++ 12 sees an overlap in "literal" + std::to_string(n) that is not there (GCC bug 105651).
target_compile_options(enamel_policy INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
# In a batch every file but the first counts as a header, where a member of a type without linkage would be a mistake.
if(ENAMEL_UNITY)
  target_compile_options(enamel_policy INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
target_link_libraries(enamel_policy INTERFACE Threads::Threads)

if(ENAMEL_SANITIZE)
  add_compile_options(-fsanitize=${ENAMEL_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${ENAMEL_SANITIZE})
  # g++ reports false positives from inlined library code under the sanitizers.
  target_compile_options(enamel_policy INTERFACE
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow -Wno-tsan>
    # Instrumented loops do not vectorise, which clang would report.
    $<$<CXX_COMPILER_ID:Clang>:-Wno-pass-failed>)
endif()
