#include "victorious/object/model/model_metadata.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"

namespace victorious {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxJsonBytes = std::size_t{64} << 20;
constexpr int kMaxJsonDepth = 8;
constexpr std::size_t kMaxViews = 100'000;
constexpr std::size_t kMaxOutlineCorners = 100'000;
constexpr int kMaxImageSizePx = 1 << 20;
constexpr double kMaxCoordinatePx = 1e7;

// Reads members of a JSON object if they have the right type; records whether a member had a wrong type.
class Reader {
 public:
  explicit Reader(const json& object) : object_(object), ok_(object.is_object()) {}

  [[nodiscard]] bool ok() const { return ok_; }

  const json& Member(const char* key) {
    static const json kNothing;
    const auto it = ok_ ? object_.find(key) : object_.end();
    if (it != object_.end()) return *it;
    ok_ = false;
    return kNothing;
  }
  std::string Text(const char* key) {
    const json& value = Member(key);
    return Require(value.is_string()) ? value.get<std::string>() : std::string();
  }
  ModelKind Kind(const char* key) {
    const std::optional<ModelKind> kind = FromText(kModelKindTexts, Text(key));
    return Require(kind && kind != ModelKind::kCategory) ? *kind : ModelKind::kPhotos;
  }
  std::uint64_t Count(const char* key) {
    const json& value = Member(key);
    return Require(value.is_number_unsigned()) ? value.get<std::uint64_t>() : 0;
  }
  int Size(const char* key) {
    const std::uint64_t value = Count(key);
    return Require(value <= kMaxImageSizePx) ? static_cast<int>(value) : 0;
  }
  double Number(const char* key) {
    const json& value = Member(key);
    return Require(value.is_number()) ? value.get<double>() : 0.0;
  }
  std::optional<double> OptionalNumber(const char* key) {
    return Member(key).is_null() ? std::nullopt : std::optional(Number(key));
  }
  bool Require(bool condition) {
    ok_ = ok_ && condition;
    return ok_;
  }

 private:
  const json& object_;
  bool ok_;
};

json EncodeOutline(const Polygon& outline) {
  json corners = json::array();
  for (const Eigen::Vector2d& corner : outline) corners.push_back({corner.x(), corner.y()});
  return corners;
}

json EncodeView(const ModelView& view) {
  json angles;
  if (view.angles) angles = {{"azimuth_rad", view.angles->azimuth_rad}, {"off_nadir_rad", view.angles->off_nadir_rad}};
  return {{"source", view.source},
          {"width", view.width},
          {"height", view.height},
          {"first_feature", view.first_feature},
          {"feature_count", view.feature_count},
          {"outline", EncodeOutline(view.outline)},
          {"angles", std::move(angles)},
          {"neighbours", view.neighbours}};
}

json EncodeBox(const std::optional<Eigen::AlignedBox3d>& box) {
  if (!box) return {};
  const Eigen::Vector3d& least = box->min();
  const Eigen::Vector3d& most = box->max();
  return {{least.x(), least.y(), least.z()}, {most.x(), most.y(), most.z()}};
}

std::optional<Eigen::Vector3d> ParsePoint(const json& point) {
  if (!point.is_array() || point.size() != 3) return std::nullopt;
  if (!std::ranges::all_of(point, [](const json& number) { return number.is_number(); })) return std::nullopt;
  return Eigen::Vector3d(point[0].get<double>(), point[1].get<double>(), point[2].get<double>());
}

std::optional<Eigen::AlignedBox3d> ParseBox(const json& corners) {
  if (!corners.is_array() || corners.size() != 2) return std::nullopt;
  const auto least = ParsePoint(corners[0]);
  const auto most = ParsePoint(corners[1]);
  if (!least || !most) return std::nullopt;
  return Eigen::AlignedBox3d(*least, *most);
}

std::optional<Polygon> ParseOutline(const json& corners) {
  if (!corners.is_array() || corners.size() > kMaxOutlineCorners) return std::nullopt;
  Polygon outline;
  outline.reserve(corners.size());
  for (const json& corner : corners) {
    if (!corner.is_array() || corner.size() != 2 || !corner[0].is_number() || !corner[1].is_number())
      return std::nullopt;
    outline.emplace_back(corner[0].get<double>(), corner[1].get<double>());
  }
  return outline;
}

std::optional<ModelView> ParseView(const json& object) {
  Reader reader(object);
  ModelView view{.source = reader.Text("source"),
                 .width = reader.Size("width"),
                 .height = reader.Size("height"),
                 .first_feature = reader.Count("first_feature"),
                 .feature_count = reader.Count("feature_count")};
  std::optional<Polygon> outline = ParseOutline(reader.Member("outline"));
  if (!outline) return std::nullopt;
  view.outline = *std::move(outline);
  if (const json& angles = reader.Member("angles"); !angles.is_null()) {
    Reader angle_reader(angles);
    view.angles = ViewDirection{angle_reader.Number("azimuth_rad"), angle_reader.Number("off_nadir_rad")};
    reader.Require(angle_reader.ok());
  }
  if (const auto neighbours = object.find("neighbours");
      neighbours != object.end()) {  // not in models of version 0.1.0
    reader.Require(neighbours->is_array() && neighbours->size() <= kMaxViews &&
                   std::ranges::all_of(
                       *neighbours, [](const json& other) { return other.is_number_unsigned() && other < kMaxViews; }));
    if (reader.ok()) view.neighbours = neighbours->get<std::vector<std::uint32_t>>();
  }
  return reader.ok() ? std::optional(std::move(view)) : std::nullopt;
}

// Parses untrusted text: bounded in size and depth, without exceptions.
std::optional<json> ParseBoundedJson(std::string_view text) {
  bool too_deep = false;
  const json::parser_callback_t guard = [&](int depth, json::parse_event_t, json&) {
    too_deep = too_deep || depth > kMaxJsonDepth;
    return !too_deep;
  };
  if (text.size() > kMaxJsonBytes) return std::nullopt;
  json document = json::parse(text, guard, /*allow_exceptions=*/false);
  if (too_deep || document.is_discarded()) return std::nullopt;
  return document;
}

bool IsSane(double coordinate_px) { return std::abs(coordinate_px) <= kMaxCoordinatePx; }  // false for NaN

// The view's first fault; empty if there is none.
std::string FindFault(const ModelView& view) {
  if (view.width < 1 || view.height < 1 || view.width > kMaxImageSizePx || view.height > kMaxImageSizePx) {
    return fmt::format("an image of {} x {} px, expected 1 to {}", view.width, view.height, kMaxImageSizePx);
  }
  if ((!view.outline.empty() && view.outline.size() < 3) || view.outline.size() > kMaxOutlineCorners) {
    return fmt::format("an outline of {} corners, expected 0 or 3 to {}", view.outline.size(), kMaxOutlineCorners);
  }
  const auto outside = [](const Eigen::Vector2d& corner) { return !IsSane(corner.x()) || !IsSane(corner.y()); };
  if (std::ranges::any_of(view.outline, outside)) return "an outline with corners outside the valid pixel range";
  if (view.angles && !(std::isfinite(view.angles->azimuth_rad) && std::isfinite(view.angles->off_nadir_rad))) {
    return "view angles that are not finite";
  }
  return {};
}

}  // namespace

std::string EncodeMetadata(const ObjectModel& model) {
  json views = json::array();
  for (const ModelView& view : model.views) views.push_back(EncodeView(view));
  const json document = {{"name", model.name},
                         {"kind", ToText(model.kind)},
                         {"engine", model.engine},
                         {"options", model.options_json},
                         {"program_version", model.program_version},
                         {"length_m", model.length_m ? json(*model.length_m) : json()},
                         {"box_m", EncodeBox(model.box_m)},
                         {"views", std::move(views)}};
  return DumpJson(document);
}

Expected<ObjectModel> ParseMetadata(std::string_view text) {
  const std::unexpected<Error> fault = Fail(ErrorCode::kDataLoss, "damaged (invalid metadata)");
  const std::optional<json> document = ParseBoundedJson(text);
  if (!document) return fault;
  Reader reader(*document);
  ObjectModel model{.name = reader.Text("name"),
                    .kind = reader.Kind("kind"),
                    .engine = reader.Text("engine"),
                    .options_json = reader.Text("options"),
                    .program_version = reader.Text("program_version"),
                    .length_m = reader.OptionalNumber("length_m")};
  if (const auto box = document->find("box_m"); box != document->end() && !box->is_null()) {  // not in version 0.1.0
    model.box_m = ParseBox(*box);
    reader.Require(model.box_m.has_value());
  }
  const json& views = reader.Member("views");
  if (!reader.Require(views.is_array() && views.size() <= kMaxViews)) return fault;
  model.views.reserve(views.size());
  for (const json& object : views) {
    std::optional<ModelView> view = ParseView(object);
    if (!view) return fault;
    model.views.push_back(*std::move(view));
  }
  return model;
}

Status ValidateMetadata(const ObjectModel& model, std::size_t feature_count) {
  const auto fail = [&](std::string_view fault) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("model {}: {}", model.name, fault));
  };
  if (model.name.empty()) return fail("it has no name");
  if (model.length_m && !(*model.length_m > 0 && std::isfinite(*model.length_m)))
    return fail("its length must be above 0 m");
  const auto is_box = [](const Eigen::AlignedBox3d& box) {
    return box.min().allFinite() && box.max().allFinite() && (box.sizes().array() >= 0).all();
  };
  if (model.box_m && !is_box(*model.box_m)) return fail("its bounding box is invalid");
  if (model.views.empty() || model.views.size() > kMaxViews) {
    return fail(fmt::format("{} views, expected 1 to {}", model.views.size(), kMaxViews));
  }
  std::uint64_t next_feature = 0;
  for (std::size_t i = 0; i < model.views.size(); ++i) {
    const ModelView& view = model.views[i];
    if (const std::string fault = FindFault(view); !fault.empty()) return fail(fmt::format("view {} has {}", i, fault));
    if (view.first_feature != next_feature || view.feature_count > feature_count - next_feature) {
      return fail(fmt::format("view {} has features that are not contiguous with those of the preceding view", i));
    }
    next_feature += view.feature_count;
    const auto is_other_view = [&](std::uint32_t other) { return other < model.views.size() && other != i; };
    if (!std::ranges::all_of(view.neighbours, is_other_view)) {
      return fail(fmt::format("view {} has an invalid neighbour index", i));
    }
  }
  if (next_feature != feature_count) {
    return fail(fmt::format("its views have {} features, expected {}", next_feature, feature_count));
  }
  return {};
}

}  // namespace victorious
