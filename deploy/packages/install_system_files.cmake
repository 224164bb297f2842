# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Runs at installation, when the prefix is known: units for systemd that start the programs of this prefix, the account,
# udev rules, and the settings, which are left alone where they exist.
set(prefix "${CMAKE_INSTALL_PREFIX}")
set(root "$ENV{DESTDIR}${prefix}")
set(etc "${root}/etc")
if(prefix MATCHES "^/usr(/local)?/?$")
  set(etc "$ENV{DESTDIR}/etc")
endif()

function(install_text source destination)
  file(READ "${source}" text)
  string(REPLACE "/usr/local/bin/" "${prefix}/bin/" text "${text}")
  string(REPLACE "/usr/local/share/doc/" "${prefix}/share/doc/" text "${text}")
  file(WRITE "${destination}" "${text}")
  file(CHMOD "${destination}" PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  message(STATUS "Installing: ${destination}")
endfunction()

set(units "${RTD_SYSTEM_FILES}/systemd")
file(GLOB files RELATIVE "${units}" "${units}/*.service" "${units}/*.target" "${units}/*.service.d/*.conf")
foreach(file IN LISTS files)
  install_text("${units}/${file}" "${root}/lib/systemd/system/${file}")
endforeach()
install_text("${units}/rtd-slam.sysusers" "${root}/lib/sysusers.d/rtd-slam.conf")
install_text("${RTD_SYSTEM_FILES}/udev/60-rtd-cameras.rules" "${root}/lib/udev/rules.d/60-rtd-cameras.rules")
if(NOT EXISTS "${etc}/rtd-slam/rtd-slam.conf")
  install_text("${units}/rtd-slam.conf" "${etc}/rtd-slam/rtd-slam.conf")
endif()
