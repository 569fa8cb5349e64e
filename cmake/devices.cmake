# Modules for shader drivers, one for each API. The process that serves a shader loads one at run time. A module is
# built if the headers of its API are found. Without any, `--shader` says what to install.
find_package(PkgConfig REQUIRED)
add_custom_target(lostbits_devices)  # all modules that are built
foreach(device "opengl|egl opengl|libegl-dev libopengl-dev" "vulkan|vulkan|libvulkan-dev")
    string(REPLACE "|" ";" device "${device}")
    list(GET device 0 kind)
    list(GET device 1 libraries)
    list(GET device 2 packages)
    separate_arguments(libraries)
    pkg_check_modules(DEVICE_${kind} QUIET IMPORTED_TARGET ${libraries})
    if(NOT DEVICE_${kind}_FOUND)
        message(STATUS "${kind} was not found (Debian packages ${packages}): --shader will not work with it")
        continue()
    endif()
    file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/intersect/device/module_${kind}*.cpp)
    add_library(lostbits_${kind} MODULE ${sources})
    set_target_properties(lostbits_${kind} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden
        VISIBILITY_INLINES_HIDDEN ON LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
    target_include_directories(lostbits_${kind} PRIVATE ${PROJECT_SOURCE_DIR}/src)
    target_link_libraries(lostbits_${kind} PRIVATE PkgConfig::DEVICE_${kind} lostbits_warnings)
    install(TARGETS lostbits_${kind} LIBRARY DESTINATION lib/lostbits)
    add_dependencies(lostbits_devices lostbits_${kind})
endforeach()
