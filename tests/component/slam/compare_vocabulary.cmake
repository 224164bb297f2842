# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Runs TRAIN and fails unless the file TRAINED is equal to EXPECTED.
execute_process(COMMAND "${TRAIN}" "${TRAINED}" COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND "${CMAKE_COMMAND}" -E compare_files "${EXPECTED}" "${TRAINED}" RESULT_VARIABLE different)
if(different)
  message(FATAL_ERROR "rtd-train-vocabulary makes another vocabulary than ${EXPECTED}. If the features or the rooms "
    "changed on purpose, copy ${TRAINED} there; maps and trajectories change with it.")
endif()
