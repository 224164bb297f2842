// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/cli/front.hpp"

int main(int argc, char** argv) {
  return rtd::launcher::front(argc, argv);
}
