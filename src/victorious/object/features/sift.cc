#include "victorious/object/features/sift.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>
#include <vector>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "victorious/geometry/angles.h"
#include "victorious/kernels/orientation.h"
#include "victorious/kernels/sift_descriptor.h"
#include "victorious/object/features/scale_space.h"
#include "victorious/object/features/searched_image.h"
#include "victorious/object/features/sift_keypoint.h"

namespace victorious {
namespace {

constexpr double kCellSigmas = 3;           // side of a descriptor's cell, in sigmas of the keypoint (Lowe 2004)
constexpr double kCandidateFraction = 0.5;  // of the contrast threshold, which the refined extremum has to reach
constexpr std::size_t kGrain = 32;          // keypoints per task
// Memory that is kept for the next images: that of so many images of so many pixels, some 70 bytes a pixel. Larger ones
// give it back.
constexpr std::size_t kMaxKept = 4;
constexpr std::size_t kMaxKeptPixels = 2U << 20U;

// A keypoint of one orientation: the refined extremum and the bin.
struct Oriented {
  std::uint32_t refined = 0;
  float bin = 0;
};

// Memory of one image, kept for the next.
struct Workspace {
  std::size_t pixels = 0;  // of the largest image so far
  ScaleSpace scale_space;
  std::vector<std::optional<RefinedExtremum>> fits;
  std::vector<RefinedExtremum> refined;
  std::vector<Orientations> orientations;
  std::vector<Oriented> oriented;
  std::vector<std::uint32_t> order;
};

// Workspaces that are not in use. Thread-safe.
class WorkspacePool {
 public:
  // The smallest that holds an image of so many pixels, else the largest, so that few grow.
  std::unique_ptr<Workspace> Take(std::size_t pixels) {
    const std::scoped_lock lock(mutex_);
    if (free_.empty()) return std::make_unique<Workspace>();
    const auto fitting = std::ranges::lower_bound(free_, pixels, {}, &Workspace::pixels);
    const auto taken = fitting == free_.end() ? std::prev(fitting) : fitting;
    std::unique_ptr<Workspace> workspace = std::move(*taken);
    free_.erase(taken);
    return workspace;
  }

  void Return(std::unique_ptr<Workspace> workspace) {
    const std::scoped_lock lock(mutex_);
    const auto place = std::ranges::upper_bound(free_, workspace->pixels, {}, &Workspace::pixels);
    free_.insert(place, std::move(workspace));
    if (free_.size() > kMaxKept) free_.erase(free_.begin());
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Workspace>> free_;  // by size
};

// The pool of all extractors that exist: a search has one for its frames, one for the features that are kept, and those
// of relit templates, and they seldom extract at the same time.
std::shared_ptr<WorkspacePool> SharedWorkspaces() {
  static constinit std::mutex mutex;
  static constinit std::weak_ptr<WorkspacePool> shared;
  const std::scoped_lock lock(mutex);
  std::shared_ptr<WorkspacePool> pool = shared.lock();
  if (!pool) shared = pool = std::make_shared<WorkspacePool>();
  return pool;
}

// Runs body(i) for all i below count, in any order and on any thread.
template <typename Body>
void ForEach(std::size_t count, const Body& body) {
  oneapi::tbb::this_task_arena::isolate([&] {  // else a waiting thread could start on another image
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
    });
  });
}

class Sift final : public FeatureExtractor {
 public:
  explicit Sift(const FeatureOptions& options) : options_(options) {}

  Expected<FeatureSet> Extract(const cv::Mat& grey) const override {
    FeatureSet features;
    features.image_width = grey.cols;
    features.image_height = grey.rows;
    VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat searched, MakeSearchedImage(grey, options_));
    if (searched.empty()) return features;
    std::unique_ptr<Workspace> workspace = workspaces_->Take(searched.total());
    workspace->pixels = std::max(workspace->pixels, searched.total());
    Detect(searched, *workspace);
    Orient(*workspace);
    KeepStrongest(*workspace);
    Describe(*workspace, features);
    if (searched.total() <= kMaxKeptPixels) workspaces_->Return(std::move(workspace));
    ScaleKeypoints(searched.size(), grey.size(), features);
    return features;
  }

 private:
  void Detect(const cv::Mat& grey, Workspace& work) const {
    work.scale_space.Build(grey, kCandidateFraction * options_.contrast_threshold / kOctaveLayers * 255);
    const auto& octaves = work.scale_space.octaves();
    const auto& extrema = work.scale_space.extrema();
    const RefineOptions refine{options_.contrast_threshold, options_.edge_threshold};
    work.fits.resize(extrema.size());
    ForEach(extrema.size(), [&](std::size_t i) {
      work.fits[i] = Refine(octaves[static_cast<std::size_t>(extrema[i].octave)], extrema[i], refine);
    });
    work.refined.clear();
    for (const auto& fit : work.fits) {
      if (fit) work.refined.push_back(*fit);
    }
    // Extrema that moved to the same pixel are one keypoint.
    const auto order = [](const RefinedExtremum& refined) { return refined.grid.Order(); };
    std::ranges::sort(work.refined, {}, order);
    const auto repeated = std::ranges::unique(work.refined, {}, &RefinedExtremum::grid);
    work.refined.erase(repeated.begin(), repeated.end());
  }

  void Orient(Workspace& work) const {
    work.orientations.resize(work.refined.size());
    ForEach(work.refined.size(), [&](std::size_t i) {
      const RefinedExtremum& refined = work.refined[i];
      std::array<std::int32_t, kernels::kOrientationBins> histogram;
      kernels::OrientationHistogram(LevelOf(work, refined), refined.grid.x, refined.grid.y, windows_.At(refined.layer),
                                    histogram);
      work.orientations[i] = FindPeaks(histogram);
    });
    work.oriented.clear();
    for (std::size_t i = 0; i < work.refined.size(); ++i) {
      for (std::size_t k = 0; k < work.orientations[i].count; ++k) {
        work.oriented.push_back({static_cast<std::uint32_t>(i), work.orientations[i].bin[k]});
      }
    }
  }

  // Keeps max_features keypoints of the highest contrast, in their order.
  void KeepStrongest(Workspace& work) const {
    const auto most = static_cast<std::size_t>(options_.max_features);
    if (most == 0 || work.oriented.size() <= most) return;
    work.order.resize(work.oriented.size());
    std::iota(work.order.begin(), work.order.end(), 0U);
    const auto key = [&](std::uint32_t i) { return std::pair(-work.refined[work.oriented[i].refined].contrast, i); };
    std::ranges::nth_element(work.order, work.order.begin() + static_cast<std::ptrdiff_t>(most), {}, key);
    work.order.resize(most);
    std::ranges::sort(work.order);
    for (std::size_t i = 0; i < most; ++i) work.oriented[i] = work.oriented[work.order[i]];
    work.oriented.resize(most);
  }

  void Describe(const Workspace& work, FeatureSet& features) const {
    features.keypoints.resize(work.oriented.size());
    features.descriptors.resize(work.oriented.size() * kDescriptorSize);
    ForEach(work.oriented.size(), [&](std::size_t i) {
      const RefinedExtremum& refined = work.refined[work.oriented[i].refined];
      const double angle = work.oriented[i].bin * (2 * kPi / kernels::kOrientationBins);
      const double sigma = refined.Sigma();
      const double octave_px = std::exp2(refined.grid.octave - 1);  // pixel of the octave in pixels of the image
      // A pixel i of an octave is the pixel i 2^octave of the doubled image, whose centre is at (that + 1/2) / 2.
      features.keypoints[i] = {static_cast<float>(refined.x * octave_px + 0.25),
                               static_cast<float>(refined.y * octave_px + 0.25), static_cast<float>(sigma * octave_px),
                               static_cast<float>(WrapAngle(angle))};
      const kernels::DescriptorGrid grid =
          kernels::MakeDescriptorGrid(refined.x, refined.y, kCellSigmas * sigma, std::cos(angle), std::sin(angle));
      std::span<std::uint8_t, kDescriptorSize> out(&features.descriptors[i * kDescriptorSize], kDescriptorSize);
      kernels::DescribeSift(LevelOf(work, refined), grid, out);
    });
  }

  static const kernels::LevelView& LevelOf(const Workspace& work, const RefinedExtremum& refined) {
    return work.scale_space
        .octaves()[static_cast<std::size_t>(refined.grid.octave)][static_cast<std::size_t>(refined.grid.layer)];
  }

  FeatureOptions options_;
  OrientationWindows windows_;
  std::shared_ptr<WorkspacePool> workspaces_ = SharedWorkspaces();
};

}  // namespace

std::unique_ptr<const FeatureExtractor> MakeSift(const FeatureOptions& options) {
  return std::make_unique<Sift>(options);
}

}  // namespace victorious
