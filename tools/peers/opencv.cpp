// SPDX-License-Identifier: Apache-2.0
// OpenCV: warpPerspective, nearest and linear, BORDER_WRAP, one thread. Its pixels and texels have their centres at whole numbers.
#include <string.h>

#include <opencv2/imgproc.hpp>

#include "peer.hpp"

namespace spantex::peers {
namespace {

class opencv_peer final : public peer {
 public:
  opencv_peer() { cv::setNumThreads(1); }
  const char* name() const override { return "OpenCV"; }
  const char* version() const override { return CV_VERSION; }

  bool prepare(const task& t) override {
    if ((t.kind != sampling::nearest && t.kind != sampling::bilinear) || t.srgb || !is_in_front(t)) return false;
    const level& map = t.levels[0];
    map_ = cv::Mat(map.height, map.width, CV_8UC4, const_cast<uint8_t*>(map.rgba)).clone();
    frame_ = cv::Mat(t.height, t.width, CV_8UC4, cv::Scalar::all(0));
    const cv::Matx33d plane(t.matrix), to_indices(1, 0, -0.5, 0, 1, -0.5, 0, 0, 1), to_centres(1, 0, 0.5, 0, 1, 0.5, 0, 0, 1);
    map_from_frame_ = to_indices * plane * to_centres;
    flags_ = cv::WARP_INVERSE_MAP | (t.kind == sampling::nearest ? cv::INTER_NEAREST : cv::INTER_LINEAR);
    return true;
  }

  void draw() override { cv::warpPerspective(map_, frame_, map_from_frame_, frame_.size(), flags_, cv::BORDER_WRAP); }

  void read(uint8_t* rgba) const override { memcpy(rgba, frame_.data, frame_.total() * frame_.elemSize()); }

 private:
  cv::Mat map_, frame_;
  cv::Matx33d map_from_frame_;
  int flags_ = 0;
};

}  // namespace
}  // namespace spantex::peers

spantex::peers::peer* spantex_make_peer() { return new spantex::peers::opencv_peer; }
