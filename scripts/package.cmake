# What is installed, and the Debian packages: cowgpu (the program), libcowgpu0 (the library) and libcowgpu-dev.
#   cmake --install build/release --prefix DIR          everything
#   (cd build/release && cpack)                         build/release/packages/*.deb
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# The library in two shared objects, which are its components: `moments` (meshes from arrays, bodies, moments), and `cowgpu`, all
# else on top, which needs Cairo, netCDF, PNG, METIS. The program has both inside.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/libcowgpu.cpp CONTENT "// Whole archives are all there is.\n")
function(cowgpu_component target name)
  add_library(${target} SHARED ${PROJECT_BINARY_DIR}/generated/libcowgpu.cpp)
  target_include_directories(${target} INTERFACE
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>          # <cowgpu/cowgpu.hpp>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/cowgpu>)  # "host/backend.hpp", as they include each other
  target_compile_features(${target} INTERFACE cxx_std_20)
  target_link_options(${target} PRIVATE LINKER:--no-undefined)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
endfunction()
cowgpu_component(libcowgpu_moments moments)
target_link_libraries(libcowgpu_moments PUBLIC Eigen3::Eigen PRIVATE cowgpu_moments cowgpu_engine)
set_target_properties(libcowgpu_moments PROPERTIES
  LINK_LIBRARY_OVERRIDE "WHOLE_ARCHIVE,cowgpu_moments,cowgpu_engine" OUTPUT_NAME cowgpu_moments)
# Archives that cowgpu_host needs come after the shared object, so that nothing of it is linked a second time.
cowgpu_component(libcowgpu cowgpu)
target_link_libraries(libcowgpu PRIVATE cowgpu_host PUBLIC libcowgpu_moments)
set_target_properties(libcowgpu PROPERTIES LINK_LIBRARY_OVERRIDE "WHOLE_ARCHIVE,cowgpu_host" OUTPUT_NAME cowgpu)

# Man page and completion, from the option table.
add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/generated/cowgpu.1 ${PROJECT_BINARY_DIR}/generated/cowgpu.bash
  COMMAND cowgpu man > ${PROJECT_BINARY_DIR}/generated/cowgpu.1
  COMMAND cowgpu completion > ${PROJECT_BINARY_DIR}/generated/cowgpu.bash
  DEPENDS cowgpu VERBATIM)
add_custom_target(cowgpu_manual ALL
  DEPENDS ${PROJECT_BINARY_DIR}/generated/cowgpu.1 ${PROJECT_BINARY_DIR}/generated/cowgpu.bash)

install(TARGETS cowgpu RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(FILES ${PROJECT_BINARY_DIR}/generated/cowgpu.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES ${PROJECT_BINARY_DIR}/generated/cowgpu.bash RENAME cowgpu
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/meshes ${PROJECT_SOURCE_DIR}/data/schemas
  DESTINATION ${CMAKE_INSTALL_DATADIR}/cowgpu COMPONENT program FILES_MATCHING PATTERN "*.md" PATTERN "*.json")

# The page of reports, where it was built.
install(FILES ${PROJECT_BINARY_DIR}/page/report.html DESTINATION ${CMAKE_INSTALL_DATADIR}/cowgpu/page
  COMPONENT program OPTIONAL)

install(TARGETS libcowgpu libcowgpu_moments EXPORT cowgpu-targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development)
# Headers of what a caller uses; those of single paths and of third libraries stay inside.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/host/include/cowgpu DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
foreach(folder "" geometry/ mesh/ mass/ map/ spectrum/ flow/ io/ physics/ paper/ plot/ report/ figures/ reproduce/ requests/)
  file(GLOB headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/host/${folder}*.hpp)
  list(FILTER headers EXCLUDE REGEX
    "/(closed_forms|counted|far_field|flush_denormals|gltf|gltf_document|netcdf|physics/polyhedron|quarter_turn|result_json|tinygltf|version)\\.hpp$")
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/cowgpu/host/${folder} COMPONENT development)
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/host/plan/legendre.hpp # held by a class of theirs
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/cowgpu/host/plan COMPONENT development)
install(EXPORT cowgpu-targets NAMESPACE cowgpu:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/cowgpu COMPONENT development)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/cowgpu-config.cmake CONTENT [[
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4)
include(${CMAKE_CURRENT_LIST_DIR}/cowgpu-targets.cmake)
# Components: moments, or cowgpu, which has all.
foreach(component ${cowgpu_FIND_COMPONENTS})
  if(TARGET cowgpu::${component})
    set(cowgpu_${component}_FOUND TRUE)
  elseif(cowgpu_FIND_REQUIRED_${component})
    set(cowgpu_FOUND FALSE)
    set(cowgpu_NOT_FOUND_MESSAGE "cowgpu has the components moments and cowgpu, and none that is called ${component}")
  endif()
endforeach()
]] @ONLY)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/generated/cowgpu-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/generated/cowgpu-config.cmake ${PROJECT_BINARY_DIR}/generated/cowgpu-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/cowgpu COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_COMPONENTS_ALL program library development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PACKAGE_CONTACT "The cowgpu authors <cowgpu@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME cowgpu)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "fonts-dejavu-core") # the letters of plots
# Opened at run time, so that the program explains itself without them.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libvulkan1, mesa-vulkan-drivers")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libcowgpu${PROJECT_VERSION_MAJOR})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "libvulkan1, mesa-vulkan-drivers")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/generated/triggers)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/triggers CONTENT "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libcowgpu-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "libcowgpu${PROJECT_VERSION_MAJOR} (= ${PROJECT_VERSION}), libeigen3-dev, nlohmann-json3-dev")
include(CPack)
