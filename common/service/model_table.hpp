// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

namespace rtd::service {

/// A network that `deploy/setup.sh` fetches. The scripts in deploy/ repeat names and files;
/// tests/unit/docs/lists_test.py compares them.
struct KnownModel {
  const char* name;     ///< of `--model`
  const char* file;     ///< that setup.sh makes of it
  const char* title;    ///< for people
  const char* licence;  ///< of the weights, as an SPDX identifier
  bool usual;           ///< used when nothing is configured, the first that is there; never one under the GPL
};

inline constexpr std::array<KnownModel, 3> kKnownModels = {{
    {"yolox-nano", "yolox_nano.onnx", "YOLOX-nano", "Apache-2.0", true},
    {"nanodet-g", "nanodet_g.onnx", "NanoDet-g", "Apache-2.0", true},
    {"yolov5-lite", "v5lite-s-raw-480x640.onnx", "YOLOv5-Lite s", "GPL-3.0", false},
}};

/// The network that makes pixels of the detector's person boxes; setup.sh brings it as well.
inline constexpr KnownModel kMaskModel = {"person-mask", "selfie_segmentation.onnx", "MediaPipe Selfie Segmentation",
                                          "Apache-2.0", true};

/// The network of the RTD-SLAM paper: what mode rtd-paper uses where it is there.
inline constexpr const char* kPaperModel = "yolov5-lite";

/// The names of all known detector networks: "yolox-nano, nanodet-g, yolov5-lite".
std::string known_model_names();

/// The known network, that for masks included, that a configured name or a path means; null for all others.
const KnownModel* find_known_model(const std::string& name_or_path);

/// "YOLOX-nano, Apache-2.0" by the name of the file; of others the name of the file and "licence not known".
std::string describe_model(const std::string& path);

}  // namespace rtd::service
