# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# CPack's description of the five Debian packages.
set(RTD_PACKAGE_MAINTAINER "" CACHE STRING "Who builds the packages: Name <mail address>; default: DEBFULLNAME, DEBEMAIL")
set(maintainer "${RTD_PACKAGE_MAINTAINER}")
if(NOT maintainer AND DEFINED ENV{DEBFULLNAME} AND DEFINED ENV{DEBEMAIL})
  set(maintainer "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
elseif(NOT maintainer)
  set(maintainer "The RTD-SLAM Authors <rtd-slam@example.org>")
endif()

# The distribution is part of the version, e.g. "+deb12" behind the number: its libraries are those of no other.
cmake_host_system_information(RESULT distribution QUERY DISTRIB_INFO)
string(SUBSTRING "${distribution_ID}" 0 3 distribution_name)
set(package_version "${PROJECT_VERSION}+${distribution_name}${distribution_VERSION_ID}")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rtd-slam)
set(CPACK_PACKAGE_VERSION "${package_version}")
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_SET_DESTDIR ON)  # the units hold the path of the programs
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL rtd_slam rtd_viewer rtd_msgs rtd_python rtd_doc)
if(NOT TARGET rtd-viewer)
  list(REMOVE_ITEM CPACK_COMPONENTS_ALL rtd_viewer)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${maintainer}")
if(CMAKE_CROSSCOMPILING AND CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
endif()
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(folder "${CMAKE_CURRENT_SOURCE_DIR}")
set(same_version "rtd-slam (= ${package_version})")

set(CPACK_DEBIAN_RTD_SLAM_PACKAGE_NAME rtd-slam)
set(CPACK_DEBIAN_RTD_SLAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RTD_SLAM_PACKAGE_DEPENDS "systemd | systemd-standalone-sysusers")
set(CPACK_DEBIAN_RTD_SLAM_PACKAGE_SUGGESTS "rtd-slam-viewer, rtd-slam-doc")
set(CPACK_DEBIAN_RTD_SLAM_PACKAGE_CONTROL_EXTRA "${folder}/postinst;${folder}/prerm;${folder}/postrm;${folder}/conffiles")
set(CPACK_COMPONENT_RTD_SLAM_DESCRIPTION "RGB-D SLAM for scenes in which people move
RTD-SLAM gives a robot with a depth camera its pose, and a map, while people
and things move through its view. Camera, detector, filter of moving points
and SLAM are processes that exchange DDS topics, on one computer or several.
Any DDS or ROS 2 program can read the poses.")

set(CPACK_DEBIAN_RTD_VIEWER_PACKAGE_NAME rtd-slam-viewer)
set(CPACK_DEBIAN_RTD_VIEWER_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RTD_VIEWER_PACKAGE_DEPENDS "${same_version}, libjs-three")
set(CPACK_COMPONENT_RTD_VIEWER_DESCRIPTION "live view of RTD-SLAM in a browser or in Foxglove
Shows map, poses, images, removed points and the state of all services of
RTD-SLAM on a page that it serves itself, and by the Foxglove protocol.")

set(CPACK_DEBIAN_RTD_MSGS_PACKAGE_NAME rtd-msgs-dev)
set(CPACK_DEBIAN_RTD_MSGS_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_RTD_MSGS_PACKAGE_SECTION devel)
set(CPACK_COMPONENT_RTD_MSGS_DESCRIPTION "IDL of the topics of RTD-SLAM
The types of all topics of RTD-SLAM, and a CMake package that makes libraries
of them for Fast DDS and Cyclone DDS.")

set(CPACK_DEBIAN_RTD_PYTHON_PACKAGE_NAME python3-rtd-slam)
set(CPACK_DEBIAN_RTD_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_RTD_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_RTD_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy")
set(CPACK_DEBIAN_RTD_PYTHON_PACKAGE_SUGGESTS "rtd-slam, python3-pandas, python3-matplotlib")
set(CPACK_COMPONENT_RTD_PYTHON_DESCRIPTION "results of RTD-SLAM as NumPy arrays
Reads the folder of a run: poses, keyframes, events and the figures of each
frame. With rtd-slam installed it also starts runs, and gives their poses as
they come.")

set(CPACK_DEBIAN_RTD_DOC_PACKAGE_NAME rtd-slam-doc)
set(CPACK_DEBIAN_RTD_DOC_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_RTD_DOC_PACKAGE_SECTION doc)
set(CPACK_COMPONENT_RTD_DOC_DESCRIPTION "documentation of RTD-SLAM
How to install, run and watch RTD-SLAM, its topics and its theory, and what
has been measured.")

# Every package has its licence and a list of changes.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(copyright copyright COPYONLY)
find_program(RTD_GZIP gzip REQUIRED)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(package "${CPACK_DEBIAN_${upper}_PACKAGE_NAME}")
  set(changelog "${CMAKE_CURRENT_BINARY_DIR}/${package}/changelog")
  configure_file(changelog.in "${changelog}" @ONLY)
  execute_process(COMMAND "${RTD_GZIP}" -9nkf "${changelog}" COMMAND_ERROR_IS_FATAL ANY)
  install(FILES copyright "${changelog}.gz" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package}" COMPONENT ${component})
endforeach()

include(CPack)
