// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/benchmark/published.hpp"

#include <algorithm>
#include <array>

namespace rtd::eval {
namespace {

using Figure = PublishedFigure;

// Sources, one a table. NGD: Zhang, Bujanca, Lujan, NGD-SLAM: Towards Real-Time Dynamic SLAM without GPU, IROS 2025,
// arXiv 2405.07392. DROID-W: Li, Zhu, Pollefeys, Barath, DROID-SLAM in the Wild, CVPR 2026, arXiv 2603.19076; it aligns
// all methods with Sim(3). Pi3MOS: Zhong et al., Dynamic Visual SLAM using a General 3D Prior, CVPR 2026, arXiv
// 2512.06868.
constexpr std::array kOrbSlam2Tum{Figure{"fr2_desk_with_person", 0.006},   Figure{"fr3_sitting_static", 0.008},
                                  Figure{"fr3_sitting_xyz", 0.010},        Figure{"fr3_sitting_rpy", 0.025},
                                  Figure{"fr3_sitting_halfsphere", 0.025}, Figure{"fr3_walking_static", 0.408},
                                  Figure{"fr3_walking_xyz", 0.722},        Figure{"fr3_walking_rpy", 0.805},
                                  Figure{"fr3_walking_halfsphere", 0.723}};
constexpr std::array kDsSlamTum{
    Figure{"fr3_walking_xyz", 0.025, 0.033, 0.826}, Figure{"fr3_walking_rpy", 0.444, 0.150, 3.004},
    Figure{"fr3_walking_halfsphere", 0.030, 0.030, 0.814}, Figure{"fr3_walking_static", 0.008, 0.010, 0.269}};
constexpr std::array kDynaSlamTum{
    Figure{"fr3_walking_xyz", 0.015, 0.021, 0.452}, Figure{"fr3_walking_rpy", 0.036, 0.045, 0.902},
    Figure{"fr3_walking_halfsphere", 0.027, 0.028, 0.737}, Figure{"fr3_walking_static", 0.007, 0.008, 0.258}};
constexpr std::array kNgdSlamTum{
    Figure{"fr3_walking_xyz", 0.015, 0.020, 0.470}, Figure{"fr3_walking_rpy", 0.034, 0.044, 0.889},
    Figure{"fr3_walking_halfsphere", 0.024, 0.025, 0.695}, Figure{"fr3_walking_static", 0.007, 0.009, 0.262}};
constexpr std::array kDroidWTum{Figure{"fr2_desk_with_person", 0.011},   Figure{"fr3_sitting_static", 0.005},
                                Figure{"fr3_sitting_xyz", 0.008},        Figure{"fr3_sitting_rpy", 0.021},
                                Figure{"fr3_sitting_halfsphere", 0.014}, Figure{"fr3_walking_static", 0.005},
                                Figure{"fr3_walking_xyz", 0.012},        Figure{"fr3_walking_rpy", 0.031},
                                Figure{"fr3_walking_halfsphere", 0.016}};
constexpr std::array kBestTum{Figure{"fr3_walking_xyz", 0.012}, Figure{"fr3_walking_static", 0.004},
                              Figure{"fr3_walking_rpy", 0.025}, Figure{"fr3_walking_halfsphere", 0.014}};

constexpr std::array kOrbSlam2Bonn{Figure{"balloon", 0.065},
                                   Figure{"balloon2", 0.230},
                                   Figure{"crowd", 0.049},
                                   Figure{"crowd2", 0.098},
                                   Figure{"person_tracking", 0.069},
                                   Figure{"person_tracking2", 0.079},
                                   Figure{"moving_nonobstructing_box", 0.032},
                                   Figure{"moving_nonobstructing_box2", 0.039},
                                   Figure{kMeanName, 0.0636}};
constexpr std::array kNgdSlamBonn{Figure{"crowd", 0.024},
                                  Figure{"crowd2", 0.025},
                                  Figure{"crowd3", 0.033},
                                  Figure{"moving_nonobstructing_box", 0.016},
                                  Figure{"moving_nonobstructing_box2", 0.036},
                                  Figure{"person_tracking", 0.046},
                                  Figure{"person_tracking2", 0.062},
                                  Figure{"synchronous", 0.028},
                                  Figure{"synchronous2", 0.009}};
constexpr std::array kDroidWBonn{Figure{"balloon", 0.026},
                                 Figure{"balloon2", 0.025},
                                 Figure{"crowd", 0.013},
                                 Figure{"crowd2", 0.018},
                                 Figure{"person_tracking", 0.033},
                                 Figure{"person_tracking2", 0.029},
                                 Figure{"moving_nonobstructing_box", 0.016},
                                 Figure{"moving_nonobstructing_box2", 0.023},
                                 Figure{kMeanName, 0.0230}};
constexpr std::array kPi3mosBonn{Figure{"balloon", 0.026}, Figure{"crowd", 0.013}, Figure{"person_tracking", 0.032},
                                 Figure{"moving_nonobstructing_box2", 0.019}, Figure{kMeanName, 0.0220}};

constexpr std::array<Figure, 0> kNotAtHand{};
constexpr auto kTum = Dataset::kTum, kBonn = Dataset::kBonn;
using Align = PublishedAlignment;
using Runs = PublishedHardware;

const std::array kMethods{
    PublishedMethod{kTum, "ORB-SLAM2", "in the DROID-W paper (arXiv 2603.19076), Table 2", Align::kSim3, Runs::kCpu,
                    kOrbSlam2Tum},
    PublishedMethod{kTum, "DS-SLAM", "quoted in the NGD-SLAM paper (arXiv 2405.07392), Table I", Align::kSe3,
                    Runs::kGpu, kDsSlamTum},
    PublishedMethod{kTum, "DynaSLAM", "quoted in the NGD-SLAM paper (arXiv 2405.07392), Table I", Align::kNotStated,
                    Runs::kGpu, kDynaSlamTum},
    PublishedMethod{kTum, "NGD-SLAM", "its paper (arXiv 2405.07392), Table I", Align::kNotStated, Runs::kCpu,
                    kNgdSlamTum},
    PublishedMethod{kTum, "DROID-W", "its paper (arXiv 2603.19076), Table 2; RGB only", Align::kSim3, Runs::kGpu,
                    kDroidWTum},
    PublishedMethod{kTum, "RTD-SLAM paper", "its Tables 2 to 5; the figures are not at hand", Align::kNotStated,
                    Runs::kNotStated, kNotAtHand},
    PublishedMethod{kTum, "best published",
                    "lowest ATE of any method: xyz DROID-W, static WildGS-SLAM (both in arXiv "
                    "2603.19076, Table 2), the others without a record of the method",
                    Align::kNotStated, Runs::kNotStated, kBestTum},
    PublishedMethod{kBonn, "ORB-SLAM2", "in the DROID-W paper (arXiv 2603.19076), Table 1", Align::kSim3, Runs::kCpu,
                    kOrbSlam2Bonn},
    PublishedMethod{kBonn, "NGD-SLAM", "its paper (arXiv 2405.07392), Table II", Align::kNotStated, Runs::kCpu,
                    kNgdSlamBonn},
    PublishedMethod{kBonn, "DROID-W", "its paper (arXiv 2603.19076), Table 1; RGB only", Align::kSim3, Runs::kGpu,
                    kDroidWBonn},
    PublishedMethod{kBonn, "Pi3MOS-SLAM", "its paper (arXiv 2512.06868); RGB only, so its scale is fitted",
                    Align::kSim3, Runs::kGpu, kPi3mosBonn},
};

constexpr std::array kBonnMean{"balloon",
                               "balloon2",
                               "crowd",
                               "crowd2",
                               "person_tracking",
                               "person_tracking2",
                               "moving_nonobstructing_box",
                               "moving_nonobstructing_box2"};

}  // namespace

std::vector<PublishedMethod> published_methods(Dataset dataset) {
  std::vector<PublishedMethod> methods;
  for (const PublishedMethod& method : kMethods) {
    if (method.dataset != dataset) continue;
    methods.push_back(method);
    methods.back().number = static_cast<int>(methods.size());
  }
  return methods;
}

const PublishedFigure* find_figure(const PublishedMethod& method, std::string_view sequence) {
  const auto found = std::ranges::find(method.figures, sequence, &PublishedFigure::sequence);
  return found == method.figures.end() ? nullptr : &*found;
}

std::span<const char* const> mean_sequences(Dataset dataset) {
  if (dataset == Dataset::kBonn) return kBonnMean;
  return {};
}

const char* to_string(PublishedAlignment alignment) {
  return alignment == Align::kSe3 ? "SE(3)" : alignment == Align::kSim3 ? "Sim(3)" : "-";
}

const char* to_string(PublishedHardware hardware) {
  return hardware == Runs::kCpu ? "CPU" : hardware == Runs::kGpu ? "GPU" : "-";
}

}  // namespace rtd::eval
