#include "victorious/track/appearance.h"

#include <algorithm>
#include <cstddef>

#include <opencv2/core.hpp>

#include "victorious/track/cell_features.h"

namespace victorious {
namespace {

constexpr double kTemplateArea_px = 1024;  // 64 cells: separates similar cars, yet tolerates small rotations
constexpr std::size_t kMaxTemplates = 24;
constexpr double kDuplicateNcc = 0.9;  // a template with at least this NCC to a stored one is redundant

double MaxNcc(const std::deque<cv::Mat>& templates, const cv::Mat& candidate) {
  double best = -1;
  for (const cv::Mat& one : templates) best = std::max(best, one.dot(candidate));
  return best;
}

}  // namespace

Appearance::Appearance(const ImagePyramid& image, const RotatedBox& box)
    : template_px_(CellAlignedSize(box.width, box.height, kTemplateArea_px)) {
  templates_.push_back(MakeTemplate(image, box));
}

// All channels, each minus its mean, as one vector of norm 1.
cv::Mat Appearance::MakeTemplate(const ImagePyramid& image, const RotatedBox& box) const {
  const cv::Mat cut = CropRotated(image, box, template_px_);
  CellFeatures channels = ComputeHogCells(cut);
  for (cv::Mat& colour : ComputeColourCells(cut)) channels.push_back(std::move(colour));
  cv::Mat candidate;
  for (const cv::Mat& channel : channels) {
    candidate.push_back(cv::Mat(channel - cv::mean(channel)[0]).reshape(1, static_cast<int>(channel.total())));
  }
  cv::normalize(candidate, candidate);
  return candidate;
}

double Appearance::NccScore(const ImagePyramid& image, const RotatedBox& box) const {
  return MaxNcc(templates_, MakeTemplate(image, box));
}

void Appearance::AddTemplate(const ImagePyramid& image, const RotatedBox& box) {
  const cv::Mat candidate = MakeTemplate(image, box);
  if (MaxNcc(templates_, candidate) >= kDuplicateNcc) return;
  templates_.push_back(candidate);
  if (templates_.size() > kMaxTemplates) templates_.erase(templates_.begin() + 1);
}

}  // namespace victorious
