# Installs shell completion and the manual page, and sets up the Debian package: `cpack -G DEB` in the build folder.

# The program itself writes completion and the manual page, so they cannot fall behind its options.
set(shell_dir ${CMAKE_CURRENT_BINARY_DIR}/shell)
set(shell_files ${shell_dir}/lostbits.bash ${shell_dir}/_lostbits ${shell_dir}/lostbits.fish ${shell_dir}/lostbits.1)
add_custom_command(OUTPUT ${shell_files}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${shell_dir}
    COMMAND lostbits completion bash > ${shell_dir}/lostbits.bash
    COMMAND lostbits completion zsh > ${shell_dir}/_lostbits
    COMMAND lostbits completion fish > ${shell_dir}/lostbits.fish
    COMMAND lostbits manual > ${shell_dir}/lostbits.1
    DEPENDS lostbits VERBATIM)
add_custom_target(lostbits_shell ALL DEPENDS ${shell_files})
install(FILES ${shell_dir}/lostbits.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
    RENAME lostbits)
install(FILES ${shell_dir}/_lostbits DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
install(FILES ${shell_dir}/lostbits.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(FILES ${shell_dir}/lostbits.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME lostbits)
set(CPACK_PACKAGE_CONTACT "lostbits")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES TRUE)
set(CPACK_DEBIAN_COMPRESSION_TYPE zstd)
# Two packages, because the libraries that the plugins need are larger than everything else.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL Unspecified)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME lostbits)
set(CPACK_DEBIAN_UNSPECIFIED_FILE_NAME DEB-DEFAULT)
if(LOSTBITS_BUILD_PLUGINS)
    list(APPEND CPACK_COMPONENTS_ALL plugins)
    set(CPACK_DEBIAN_PLUGINS_PACKAGE_NAME lostbits-plugins)
    set(CPACK_DEBIAN_PLUGINS_FILE_NAME DEB-DEFAULT)
    set(CPACK_DEBIAN_PLUGINS_PACKAGE_DEPENDS lostbits)
    set(CPACK_COMPONENT_PLUGINS_DESCRIPTION "Ray tests of libraries, for `lostbits --plugin NAME`")
endif()
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# dpkg-shlibdeps finds the libraries that the program and its image module need. Pictures also need the font DejaVu
# Sans, on which no library depends.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_DEPENDS fonts-dejavu-core)
include(CPack)
