# kernels/ -> one C++ file with a table of byte arrays (never string literals: those have length limits and escapes).
# hr_embed_kernels(TARGET ROOT) regenerates it whenever a kernel file changes.
set(HR_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/embed_kernels_script.cmake)

function(hr_embed_kernels target root)
  file(GLOB_RECURSE kernel_files CONFIGURE_DEPENDS ${root}/*.cl ${root}/*.h ${root}/*.def)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/embedded_kernels.cpp)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DROOT=${root} -DOUTPUT=${output} -P ${HR_EMBED_SCRIPT}
    DEPENDS ${kernel_files} ${HR_EMBED_SCRIPT}
    COMMENT "Embedding kernels"
    VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()
