// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

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

/// Value of an environment variable, empty when it is not set.
using EnvironmentReader = std::function<std::optional<std::string>(const std::string& name)>;

/// Where the network is, or what to do to get it.
struct ModelSearch {
  std::string path;     ///< of an existing file; empty when none was found
  std::string message;  ///< when none was found: where was looked and the command that helps
  explicit operator bool() const { return !path.empty(); }
};

/// Looks for the network. `configured` (config key detector.model) may be empty (the usual ones of kKnownModels, the
/// first that is there), the name of a known one, a bare file name or a path. A path is taken as it is; a file name is
/// looked for in RTD_MODEL_DIR and its folder `permissive`, then in the user's cache ($XDG_CACHE_HOME or
/// $HOME/.cache)/rtd-slam, then in rtd-slam/models of $XDG_DATA_DIRS (/usr/local/share, /usr/share).
ModelSearch find_model(const std::string& configured, const EnvironmentReader& environment);

/// Looks in the same places for the network that turns person boxes into pixels (kMaskModel). `use` (key
/// detector.masks) is auto, on or off; `configured` (key detector.mask_model) as above. Off finds nothing and has no
/// message. Throws ConfigError where it is not found, but `use` is on or `configured` names it.
ModelSearch find_mask_model(const std::string& use, const std::string& configured,
                            const EnvironmentReader& environment);

/// The folder of a service's data as systemd gives it (StateDirectory=); empty without STATE_DIRECTORY.
std::string state_folder(const EnvironmentReader& environment);

/// The environment of this process.
EnvironmentReader process_environment();

/// Where the library of ONNX Runtime is looked for, in this order: where `deploy/setup.sh --onnxruntime` puts it next
/// to this build, /usr/local/lib/rtd-slam, then the folders of the system's libraries.
std::vector<std::filesystem::path> onnxruntime_folders();

/// The path of ONNX Runtime's library: the value of RTD_ONNXRUNTIME as it is, else the first libonnxruntime.so or, of
/// one with a version (libonnxruntime.so.1.21), the newest in the first folder that has any. Empty: there is none.
std::string find_onnxruntime(const EnvironmentReader& environment, const std::vector<std::filesystem::path>& folders);

/// The same with the environment of this process and onnxruntime_folders().
std::string find_onnxruntime();

}  // namespace rtd::service
