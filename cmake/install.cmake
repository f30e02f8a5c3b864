# What make install puts in place: the command with its manual pages and completions, the libraries with their headers, and a CMake package.
include(CMakePackageConfigHelpers)

install(TARGETS openclose RUNTIME DESTINATION bin)

# The command itself knows its options, so the pages cannot be out of date. Where it cannot run, because it is built for another machine, they are left out.
if(NOT CMAKE_CROSSCOMPILING)
  set(manual ${PROJECT_BINARY_DIR}/manual)
  add_custom_command(OUTPUT ${manual}/openclose.1
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${manual}
    COMMAND openclose manual --write ${manual}
    DEPENDS openclose VERBATIM)
  add_custom_target(openclose_manual ALL DEPENDS ${manual}/openclose.1)
  install(DIRECTORY ${manual}/ DESTINATION share/man/man1 FILES_MATCHING PATTERN "*.1")
  install(FILES ${manual}/completion.bash DESTINATION share/bash-completion/completions RENAME openclose)
  install(FILES ${manual}/completion.zsh DESTINATION share/zsh/site-functions RENAME _openclose)
  install(FILES ${manual}/completion.fish DESTINATION share/fish/vendor_completions.d RENAME openclose.fish)
endif()

install(FILES README.md CHANGELOG.md CITATION.cff LICENSE DESTINATION share/doc/openclose)
install(FILES docs/scene.schema.json DESTINATION share/openclose)

install(EXPORT openclose_targets NAMESPACE openclose:: DESTINATION lib/cmake/openclose)
configure_package_config_file(cmake/openclose-config.cmake.in ${PROJECT_BINARY_DIR}/openclose-config.cmake INSTALL_DESTINATION lib/cmake/openclose)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/openclose-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/openclose-config.cmake ${PROJECT_BINARY_DIR}/openclose-config-version.cmake DESTINATION lib/cmake/openclose)
