# Compiler settings and the two functions that every folder uses.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
find_package(Threads REQUIRED)

add_library(thimble_options INTERFACE)
target_compile_options(thimble_options INTERFACE
  -Wall -Wextra -Wconversion -Wsign-conversion -Wshadow -Wformat-security -Werror -fvisibility=hidden)
# GCC 12 reports overlaps in std::string operator+ that cannot happen (GCC bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(thimble_options INTERFACE -Wno-restrict)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  target_compile_options(thimble_options INTERFACE -Wreserved-identifier)
endif()
target_include_directories(thimble_options INTERFACE ${CMAKE_SOURCE_DIR})
target_link_libraries(thimble_options INTERFACE Threads::Threads)
if(THIMBLE_SANITIZE)
  # For the folder, which comes before the target's own on the command line: those say what they do without, and the last
  # word counts.
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fsanitize=${THIMBLE_SANITIZE}>)
  target_compile_options(thimble_options INTERFACE -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(thimble_options INTERFACE -fsanitize=${THIMBLE_SANITIZE})
  # Sanitized programs are large, and there are a hundred; it takes half as long. Constants are kept
  # from being code, as ld.bfd does unasked.
  target_link_options(thimble_options INTERFACE -fuse-ld=gold LINKER:--rosegment)
  # The compilers tell of themselves in different ways.
  target_compile_definitions(thimble_options INTERFACE THIMBLE_UNDER_SANITIZER)
  # GCC cannot see through the sanitizers' instrumentation and reports what is not there.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(thimble_options INTERFACE -Wno-maybe-uninitialized -Wno-tsan)
  endif()
endif()
# What dpkg-buildflags asks of a package, and all symbols bound before main() (decision 0514). What looks into strings and copies wants optimised
# code, so the libraries have it and tests do not. Sanitizers look closer.
set(THIMBLE_FORTIFY)
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT THIMBLE_SANITIZE)
  target_compile_options(thimble_options INTERFACE -fstack-protector-strong -fstack-clash-protection)
  target_link_options(thimble_options INTERFACE LINKER:-z,relro LINKER:-z,now)
  # Whoever has another word for it in the environment has this one.
  set(THIMBLE_FORTIFY -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2)
endif()
if(THIMBLE_FUZZ)
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fsanitize=fuzzer-no-link>)
endif()

# Files compiled fourteen at a time: half of what one costs, and more in a test, is the reading of the same
# headers and the making of the same templates. ALONE are the files whose names in the unnamed
# namespace, or whose using-declarations, mean another thing than in another file of theirs.
option(THIMBLE_UNITY_PRODUCT "Compile several files of a library at once" OFF)
option(THIMBLE_UNITY_TESTS "Compile several files of a test program at once" ON)
function(thimble_unity target is_wanted alone)
  set_source_files_properties(${alone} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${is_wanted} UNITY_BUILD_BATCH_SIZE 14)
endfunction()

# thimble_library(<folder/with/slashes> [GLUE] SOURCES … [ALONE …] LINKS …): one static library per folder,
# named thimble_<folder_with_underscores>. Without SOURCES it is header-only. ALONE: see above. GLUE: it
# puts together what others reckon, mostly by large templates of third parties, which cost the
# compiler more than they ever cost a run: THIMBLE_GLUE_OPTIONS are for such folders alone.
set(THIMBLE_GLUE_OPTIONS "" CACHE STRING "Compiler options for folders that only put together")
function(thimble_library folder)
  cmake_parse_arguments(ARG "GLUE" "" "SOURCES;ALONE;LINKS;PRIVATE_LINKS" ${ARGN})
  string(REPLACE "/" "_" name ${folder})
  if(ARG_SOURCES OR ARG_ALONE)
    add_library(thimble_${name} STATIC ${ARG_SOURCES} ${ARG_ALONE})
    thimble_unity(thimble_${name} ${THIMBLE_UNITY_PRODUCT} "${ARG_ALONE}")
    if(ARG_GLUE)
      target_compile_options(thimble_${name} PRIVATE ${THIMBLE_GLUE_OPTIONS})
    endif()
    target_compile_options(thimble_${name} PRIVATE ${THIMBLE_FORTIFY})
    target_link_libraries(thimble_${name} PUBLIC thimble_options ${ARG_LINKS}
                          PRIVATE ${ARG_PRIVATE_LINKS})
  else()
    add_library(thimble_${name} INTERFACE)
    target_link_libraries(thimble_${name} INTERFACE thimble_options ${ARG_LINKS})
  endif()
endfunction()

# One entry of ctest for all cases of a program: a sanitizer makes the start of a process, of which there
# would be thousands, dearer than most cases. The release build gives each case a process of its own, and
# so does every build those with an ENVIRONMENT: threads of what is preloaded outlive a case there.
function(thimble_whole_program name label left_out)
  add_test(NAME ${name} COMMAND ${name} --gtest_brief=1 "--gtest_filter=-${left_out}")
  set_tests_properties(${name} PROPERTIES LABELS "${label}" TIMEOUT 1200)
endfunction()

# What most tests include is read once for all tests with the same options. The preset dev does without, so that a test
# that lacks an include is found.
option(THIMBLE_TEST_HEADERS_ONCE "Precompile what most tests include" ON)
function(thimble_test_headers target)
  if(NOT THIMBLE_TEST_HEADERS_ONCE)
    return()
  endif()
  string(MD5 options "${THIMBLE_TEST_OPTIONS}")
  set(headers thimble_test_headers_${options})
  if(NOT TARGET ${headers})
    file(GENERATE OUTPUT ${CMAKE_BINARY_DIR}/generated/${headers}.cpp CONTENT "")
    add_library(${headers} OBJECT ${CMAKE_BINARY_DIR}/generated/${headers}.cpp)
    target_compile_options(${headers} PRIVATE ${THIMBLE_TEST_OPTIONS})
    target_link_libraries(${headers} PRIVATE thimble_options GTest::gmock)
    target_precompile_headers(${headers} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:${CMAKE_SOURCE_DIR}/tests/support/test_headers.hpp>")
  endif()
  target_precompile_headers(${target} REUSE_FROM ${headers})
endfunction()

# thimble_test(<name> LABEL <tier> [THREADED] SOURCES … [ALONE …] LINKS … [RECKONING …]): one GoogleTest
# program, one ctest entry per test case (mostly one for all of them under a sanitizer). THREADED: more than one thread takes part, so ThreadSanitizer has
# something to see; with THIMBLE_ONLY_THREADED the others are left out. ENVIRONMENT: NAME=VALUE for
# its runs. RECKONING: GoogleTest's patterns of tests that reckon for long what shorter ones walk
# through, too; they are left out where a sanitizer makes them ten to sixty times as slow.
# THIMBLE_TEST_OPTIONS are for the code of tests alone; a folder whose tests reckon much appends -O1.
set(THIMBLE_TEST_TIMEOUT 300 CACHE STRING "Seconds after which a test case is ended")
set(THIMBLE_TEST_OPTIONS "" CACHE STRING "Compiler options for the code of tests")
function(thimble_test name)
  cmake_parse_arguments(ARG "THREADED" "LABEL;ENVIRONMENT" "SOURCES;ALONE;LINKS;RECKONING" ${ARGN})
  add_executable(${name} ${ARG_SOURCES} ${ARG_ALONE})
  thimble_unity(${name} ${THIMBLE_UNITY_TESTS} "${ARG_ALONE}")
  target_compile_options(${name} PRIVATE ${THIMBLE_TEST_OPTIONS})
  target_link_libraries(${name} PRIVATE thimble_options ${ARG_LINKS} GTest::gtest_main)
  thimble_test_headers(${name})
  if((ARG_LABEL STREQUAL "unit" AND NOT THIMBLE_UNIT_TESTS) OR (THIMBLE_ONLY_THREADED AND NOT ARG_THREADED))
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    return()
  endif()
  set(left_out)
  if(THIMBLE_SANITIZE)
    list(JOIN ARG_RECKONING ":" left_out)
  endif()
  if(THIMBLE_SANITIZE AND NOT ARG_ENVIRONMENT)
    thimble_whole_program(${name} "${ARG_LABEL}" "${left_out}")
    return()
  endif()
  set(suppressions)
  if(THIMBLE_SANITIZE STREQUAL "thread")
    # Not in ENVIRONMENT: gtest_discover_tests() keeps but the first of two.
    set(suppressions ENVIRONMENT_MODIFICATION
      "TSAN_OPTIONS=set:suppressions=${CMAKE_SOURCE_DIR}/tests/support/tsan_in_tests.supp")
  endif()
  # A program with a sanitizer takes a slow machine more than the usual 5 s to list its tests.
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 120 TEST_FILTER "-${left_out}"
    PROPERTIES LABELS "${ARG_LABEL}" TIMEOUT ${THIMBLE_TEST_TIMEOUT}
    ENVIRONMENT "${ARG_ENVIRONMENT}" ${suppressions})
endfunction()
