// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tests/support/temporary_folder.hpp"

namespace rtd::eval::testing_support {

/// A folder of datasets with sequences of two frames whose images are empty files.
class DatasetFolder : public rtd::test::TemporaryFolder {
 public:
  /// In the layout of TUM and Bonn.
  void add_tum(const std::string& name) const { add(name, "rgb", "depth", "rgb.txt", "depth.txt"); }
  void add_openloris(const std::string& name) const {
    add(name, "color", "aligned_depth", "color.txt", "aligned_depth.txt");
    write(name + "/sensors.yaml",
          "%YAML:1.0\nd400_color_optical_frame:\n   fps: 30\n   width: 848\n   height: 480\n   model: pinhole\n"
          "   intrinsics: !!opencv-matrix\n      rows: 1\n      cols: 4\n      dt: d\n"
          "      data: [ 611.45, 433.2, 611.49, 249.47 ]\n");
    write(name + "/trans_matrix.yaml",
          "%YAML:1.0\ntrans_matrix:\n"
          "   -\n      parent_frame: base_link\n      child_frame: laser\n" +
              matrix("1., 0., 0., 0.2, 0., 1., 0., 0., 0., 0., 1., 0.3, 0., 0., 0., 1.") +
              "   -\n      parent_frame: d400_color_optical_frame\n      child_frame: laser\n" +
              matrix("1., 0., 0., 0.5, 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1."));
    write(name + "/groundtruth.txt",
          "scene: cafe\nseq: 1\nframe: gt_map base_link\n# timestamp\n1.0 1 0 0 0 0 0 1\n1.0 1 0 0 0 0 0 1\n"
          "2.0 2 0 0 0 0 1 0\n");
  }

 private:
  static std::string matrix(const std::string& values) {
    return "      matrix: !!opencv-matrix\n         rows: 4\n         cols: 4\n         dt: d\n         data: [ " +
           values + " ]\n";
  }
  void add(const std::string& name, const std::string& color, const std::string& depth, const std::string& color_list,
           const std::string& depth_list) const {
    for (const std::string& images : {color, depth}) {
      write(name + "/" + images + "/1.png", "");
      write(name + "/" + images + "/2.png", "");
    }
    write(name + "/" + color_list, "# images\n1.0 " + color + "/1.png\n2.0 " + color + "/2.png\n");
    write(name + "/" + depth_list, "1.0 " + depth + "/1.png\n2.0 " + depth + "/2.png\n");
    write(name + "/groundtruth.txt", "1.0 0 0 0 0 0 0 1\n2.0 1 0 0 0 0 0 1\n");
  }
};

}  // namespace rtd::eval::testing_support
