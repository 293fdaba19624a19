# hr_record_commit(TARGET): adds a generated file that defines what host/base/build_info.hpp declares. It is made anew
# when HEAD moves; git itself is not needed.
set(HR_COMMIT_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/commit_script.cmake)

function(hr_record_commit target)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/build_info.cpp)
  set(watched "")
  if(EXISTS ${CMAKE_SOURCE_DIR}/.git/logs/HEAD)
    set(watched ${CMAKE_SOURCE_DIR}/.git/logs/HEAD)
  endif()
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DROOT=${CMAKE_SOURCE_DIR} -DVERSION=${PROJECT_VERSION} -DOUTPUT=${output}
            -P ${HR_COMMIT_SCRIPT}
    DEPENDS ${HR_COMMIT_SCRIPT} ${watched}
    COMMENT "Recording the commit"
    VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()
