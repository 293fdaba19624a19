# What holds for every target: ccache, sanitizers, and the warnings our own code is clean under.
# Never -march=native or the like: a build must run on any machine of its architecture.
find_program(HR_CCACHE ccache)
if(HR_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_C_COMPILER_LAUNCHER ${HR_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${HR_CCACHE})
endif()

# Position-independent code would otherwise not inline our own exported functions.
add_compile_options(-fno-semantic-interposition)

if(HR_SANITIZE)
  add_compile_options(-fsanitize=${HR_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=${HR_SANITIZE})
endif()

# hr_warnings(TARGET): for code of our own.
function(hr_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion $<$<BOOL:${HR_WERROR}>:-Werror>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)  # false for "literal" + std::string (GCC bug 105329)
  endif()
endfunction()
