#include "victorious/jobs/index/shape_decision.h"

#include <algorithm>
#include <optional>
#include <ranges>
#include <utility>
#include <vector>

#include "victorious/geometry/similarity.h"
#include "victorious/jobs/index/shape_detections.h"
#include "victorious/search/follow/looks_before.h"

namespace victorious {
namespace {

// The motion of the image as filmed, in that which is searched.
Similarity2 InSearched(Similarity2 motion, const FrameSizes& sizes) {
  motion.translation *= static_cast<double>(sizes.searched.width) / sizes.filmed.width;
  return motion;
}

// The nearest first, as far as the motion of the image is known.
std::vector<FrameBefore> FramesBefore(std::span<const FrameWork* const> held, const FrameWork& task) {
  std::vector<FrameBefore> before;
  Similarity2 then_from_now;
  std::optional<Similarity2> motion = task.now_from_before;
  for (const FrameWork* then : held | std::views::reverse) {
    if (!motion || then->motion_only) break;
    then_from_now = InSearched(*motion, task.sizes).Inverse() * then_from_now;
    before.push_back({.seen = &then->now, .then_from_now = then_from_now});
    motion = then->now_from_before;
  }
  return before;
}

// What the last search by shape left undecided and this frame shows again.
Expected<std::vector<ShapeMatch>> FindUndecided(const IndexPass& pass, std::span<const FrameWork* const> held,
                                                const FrameWork& task) {
  const auto reversed = held | std::views::reverse;
  const auto last =
      std::ranges::find_if(reversed, [](const FrameWork* one) { return one->motion_only || one->by_shape; });
  if (last == reversed.end() || (*last)->motion_only || (*last)->undecided.empty()) return std::vector<ShapeMatch>{};
  const FrameWork& then = **last;
  std::vector<const FollowedFrame*> since;
  for (const FrameWork* next : std::span(last.base(), held.end())) since.push_back(&next->now);
  since.push_back(&task.now);
  return FindFurtherOn(pass.recognizer, pass.extractor, pass.follow, then.now,
                       FullFrameResult{then.features, then.undecided}, since, *pass.shapes);
}

Status LookBeforeEach(const IndexPass& pass, std::span<const FrameWork* const> held, FrameWork& task) {
  std::vector<Detection> examined;
  for (const ShapeDetection& one : task.shape_detections) {
    if (one.is_examined) examined.push_back(one.detection);
  }
  if (examined.empty()) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<LooksBefore> looks,
                              LookBefore(pass.recognizer, pass.extractor, pass.follow, task.now, task.features,
                                         examined, FramesBefore(held, task), *pass.shapes));
  auto of_next = looks.begin();
  for (ShapeDetection& one : task.shape_detections) {
    if (one.is_examined) one.before = *of_next++;
  }
  return {};
}

}  // namespace

Status AddShapeDetections(const IndexPass& pass, std::span<const FrameWork* const> held, FrameWork& task) {
  if (!task.by_shape) return {};
  const DetectOptions& options = pass.options.recognize.detect;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ShapeMatch> again, FindUndecided(pass, held, task));
  VICTORIOUS_RETURN_IF_ERROR(AddMatches(*pass.shapes, again, options, task.features, task.shape_detections));
  VICTORIOUS_RETURN_IF_ERROR(LookBeforeEach(pass, held, task));
  task.undecided = KeepSignificant(options, task.shape_detections);
  JoinDetections(std::move(task.shape_detections), task.detections);
  return {};
}

}  // namespace victorious
